//! Which tool is in the spindle, by its number, its name and its diameter, where a file states them beside each other.
//!
//! NX names the tool of each path in `TOOL PATH/op,TOOL,name`, and its number stands in `LOAD/TOOL,n`, if anywhere; CUTTER and TLDATA
//! state its shape. A path with another name or another diameter than those that the number had before is one of another tool,
//! and no tool was called for it: it would be cut with the wrong one.

use super::reader::{Reader, Said};
use crate::diagnostic::Diagnostic;
use crate::ir::ToolCall;
use crate::source::Span;

/// How far the diameters of one tool may be apart, mm: the last of its decimals.
const SAME_DIAMETER: f64 = 1.0e-6;

/// A tool as a file has described it where it first moved.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Known {
    name: Option<String>,
    /// mm
    diameter: Option<f64>,
}

impl Reader<'_> {
    /// An operation is over: its cycle ends, and no other takes it up again.
    pub(super) fn end_operation(&mut self, what: &str, span: Span) {
        self.end_cycle(what, span);
        (self.cycle, self.last_cycle) = (None, None);
    }

    /// `op,TOOL,name` of TOOL PATH: a table of tools may have the number of that name.
    pub(super) fn path(&mut self, text: &str, span: Span) {
        let mut parts = text.split(',').map(str::trim);
        let named = parts.by_ref().any(|part| part.eq_ignore_ascii_case("TOOL"));
        let name = parts.next().filter(|name| named && !name.is_empty());
        self.path_tool = name.map(str::to_ascii_uppercase);
        self.dirty_tool = true;
        let number = self.path_tool.as_ref().and_then(|name| self.words.tools.get(name)).copied();
        if let Some(number) = number
            && self.tool.is_none_or(|call| call.number != number)
        {
            self.change(ToolCall::own(number), span);
        }
    }

    /// Whether the table of tools has another number for the tool of this path than the file calls.
    pub(super) fn contradicts_table(&mut self, call: ToolCall, said: &Said<'_>) -> bool {
        let Some(name) = &self.path_tool else { return false };
        let Some(number) = self.words.tools.get(name).copied().filter(|number| *number != call.number) else {
            return false;
        };
        let message =
            format!("`{name}` is tool {number} in [tools] of --words, and tool {} here", call.number);
        self.error("tool-name", message, said.span);
        true
    }

    /// The tool moves for the first time since it, its name or its diameter was stated: it has to be what its number was before.
    pub(super) fn meets_tool(&mut self, span: Span) {
        self.dirty_tool = false;
        let Some(call) = self.tool else { return };
        let here = Known { name: self.path_tool.clone(), diameter: self.diameter };
        let Some(known) = self.known_tools.get_mut(&call.number) else {
            self.known_tools.insert(call.number, here);
            return;
        };
        let renamed = known.name.is_some() && here.name.is_some() && known.name != here.name;
        let other = |(own, other): (f64, f64)| SAME_DIAMETER < (own - other).abs();
        let resized = known.diameter.zip(here.diameter).is_some_and(other);
        let text = |known: &Known| match (&known.name, known.diameter) {
            (Some(name), _) if renamed => format!("`{name}`"),
            (_, diameter) => format!("{} mm in diameter", diameter.unwrap_or_default()),
        };
        let message = format!(
            "tool {} was {} before, and {} moves here without a call of its own",
            call.number,
            text(known),
            text(&here)
        );
        if known.name.is_none() {
            known.name.clone_from(&here.name);
        }
        known.diameter = known.diameter.or(here.diameter);
        if renamed {
            let name = here.name.unwrap_or_default();
            self.push(
                Diagnostic::error("tool-name", message)
                    .at(span, "")
                    .hint("LOAD/TOOL before it calls the tool by a number of its own")
                    .hint(format!("[tools] in a table for --words has the numbers of names: \"{name}\" = 2")),
            );
        } else if resized {
            self.push(
                Diagnostic::error("tool-diameter", message)
                    .at(span, "")
                    .hint("a tool call before it says which tool that is; CUTTER = \"comment\" in a table for --words takes no diameter from it"),
            );
        }
    }
}
