//! Whether a tool is in the spindle, the spindle turns and the coolant flows where something is cut.
//!
//! A tool change stops the spindle on most machines, and a speed before it is that of the tool before it: a file that does not
//! say it again is written as it stands, with a warning. Coolant that flows is to flow for the next tool too, until the file ends
//! it; `pass::place` stops it for the change.

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::ir::{Curve, Step, ToolCall};
use crate::source::Span;

/// What became of the spindle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Spindle {
    /// Nothing was said of it.
    #[default]
    Unsaid,
    /// It was started, rev/min.
    Turns(f64),
    /// It was stopped.
    Stopped,
    /// A tool was called.
    Called,
}

/// What became of the coolant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Coolant {
    /// It is off, or was never on.
    #[default]
    Off,
    /// It was started.
    Flows,
}

/// What is new since the last move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum New {
    Tool,
    Frame,
}

/// What runs, and what is to be said of it.
#[derive(Debug, Default)]
pub(super) struct Running {
    tool: Option<ToolCall>,
    spindle: Spindle,
    coolant: Coolant,
    /// Whether it was told that the spindle stands.
    told: bool,
    new: Option<New>,
    /// Whether anything has moved.
    begun: bool,
    /// What there is to say.
    pub(super) diagnostics: Diagnostics,
}

impl Running {
    /// The spindle starts or stops.
    pub(super) fn spindle(&mut self, spindle: Spindle) {
        self.spindle = spindle;
        self.told = false;
    }

    /// The coolant starts or stops.
    pub(super) fn coolant(&mut self, coolant: Coolant) {
        self.coolant = coolant;
    }

    /// A tool is called.
    pub(super) fn tool(&mut self, call: ToolCall) {
        self.tool = Some(call);
        self.new = Some(New::Tool);
        self.spindle(Spindle::Called);
    }

    /// The call of the tool once more, and what has to be said behind it.
    pub(super) fn again(&self) -> Vec<Step<f64, Curve>> {
        let spindle = match self.spindle {
            Spindle::Turns(rpm) => Some(Step::Spindle(rpm)),
            Spindle::Unsaid | Spindle::Stopped | Spindle::Called => None,
        };
        let coolant = (self.coolant == Coolant::Flows).then_some(Step::Coolant);
        self.tool.map(Step::Tool).into_iter().chain(spindle).chain(coolant).collect()
    }

    /// Whether no tool was called.
    pub(super) fn has_no_tool(&self) -> bool {
        self.tool.is_none()
    }

    /// Positions count in another frame from here on.
    pub(super) fn reframed(&mut self) {
        self.new = Some(New::Frame);
    }

    /// Goes somewhere at rapid.
    pub(super) fn rapid(&mut self, span: Span) {
        self.begins(span);
        self.new = None;
    }

    /// The first move of all: without a tool no length holds, and nothing goes home.
    fn begins(&mut self, span: Span) {
        if !self.begun && self.tool.is_none() {
            let message = "the file moves and calls no tool before: the length that the control has holds, and Z goes home nowhere";
            self.diagnostics.push(
                Diagnostic::warning("tool-missing", message)
                    .at(span, "")
                    .hint("LOADTL calls one; see that the way to the first place is clear"),
            );
        }
        self.begun = true;
    }

    /// Cuts, at `span`.
    pub(super) fn cuts(&mut self, span: Span) {
        self.begins(span);
        let new = self.new.take();
        if self.tool.is_some_and(|call| call.number == 0) {
            self.tool = None;
            let message = "tool 0 is an empty spindle, and cuts here";
            self.diagnostics.push(Diagnostic::error("tool-zero", message).at(span, ""));
        } else if let Some(new) = new {
            self.diagnostics.push(
                first_cut(new, self.tool).at(span, "").hint("RAPID before it, to a place above the work"),
            );
        }
        let tool = self.tool.map_or(String::new(), |call| format!("tool {} cuts here, and ", call.number));
        let message = match self.spindle {
            Spindle::Turns(_) => None,
            Spindle::Unsaid => Some(format!("{tool}nothing started the spindle before")),
            Spindle::Called => Some(format!("{tool}nothing started the spindle since it was called")),
            Spindle::Stopped => Some(format!("{tool}the spindle was stopped before")),
        };
        if let Some(message) = message.filter(|_| !self.told) {
            self.told = true;
            self.diagnostics.push(
                Diagnostic::warning("spindle-missing", message)
                    .at(span, "")
                    .hint("SPINDL behind the tool call starts it; a tool change stops it"),
            );
        }
    }
}

/// What is said of a first move that cuts.
fn first_cut(new: New, tool: Option<ToolCall>) -> Diagnostic {
    match new {
        New::Tool => {
            let tool = tool.map_or(0, |call| call.number);
            let message = format!(
                "tool {tool} begins with a cut: from its home it goes over where that starts, and down at its feed"
            );
            Diagnostic::warning("cut-first", message)
        }
        New::Frame => {
            let message =
                "the first move in another frame cuts, and where the tool is in that frame nobody knows";
            Diagnostic::error("frame-cut", message)
        }
    }
}
