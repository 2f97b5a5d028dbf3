//! The length of the tool, G43, and its direction where the tip is led.

use super::{Block, Motion, Reader};
use crate::diagnostic::Diagnostic;
use crate::dialect::arc;
use crate::dialect::iso::{Offset, register};
use crate::geom::arc::Plane;
use crate::ir::ToolCall;
use crate::machine::template::Template;
use std::ops::Range;

impl Reader<'_> {
    /// Where a fixed line calls a tool, the offset that was taken out of the machine's lines must follow.
    pub(super) fn tool_line(&mut self, body: &str, offset: &Offset, range: Range<usize>) {
        let machine = self.assembler.machine;
        let frame = &machine.frame;
        let is = |lines: &[Template]| lines.first().is_some_and(|line| line.matched(body).is_some());
        for (lines, due) in [(&frame.tool, &offset.tool), (&frame.tool_spindle, &offset.tool_spindle)] {
            match (is(lines), due) {
                (false, _) => {}
                (true, Some(called)) => {
                    self.offset_due = self.assembler.tool().map(ToolCall::register);
                    self.offset_call = Some(called.clone());
                    self.offset_tool = None;
                }
                // The length comes with the tool.
                (true, None) => self.takes_length(range.clone()),
            }
        }
        if is(&frame.tip_control) {
            self.takes_length(range);
        }
    }

    /// A retraction in machine coordinates may end the length of the tool, and other lines do, so that it is called again before
    /// the next move of Z.
    pub(super) fn home_line(&mut self, body: &str) {
        let frame = &self.assembler.machine.frame;
        let mut firsts = frame.home.first().into_iter().chain(frame.length_end.first());
        if firsts.any(|template| template.matched(body).is_some()) && !self.assembler.leads_tip() {
            self.offset_due = self.offset_due.or(self.offset_tool.take());
        }
    }

    /// The length of a tool is taken here: along Z in G17, and nobody knows along which axis in another plane.
    pub(super) fn takes_length(&mut self, range: Range<usize>) {
        if self.plane != Plane::Xy {
            self.length_elsewhere(self.plane, "put G17 before it", range);
        }
    }

    /// What is wrong where a plane may turn the length of the tool.
    pub(super) fn length_elsewhere(&mut self, plane: Plane, hint: &str, range: Range<usize>) {
        let word = arc::plane_word(plane);
        let message = format!("in {word} the control may take the tool's length along another axis");
        let diagnostic = Diagnostic::error("arc-plane", message).at(self.assembler.span(range), "");
        self.assembler.diagnostics.push(diagnostic.hint(hint));
    }

    /// Where the tip is led, I J K of a rapid or a straight move are the tool's direction; false where that is wrong.
    pub(super) fn directed(&mut self, block: &mut Block, whole: Range<usize>) -> bool {
        let straight = matches!(self.motion, Motion::Rapid | Motion::Line);
        let stated = block.i.is_some() || block.j.is_some() || block.k.is_some();
        if !straight || !stated || self.assembler.machine.axes.direction().is_none() {
            return true;
        }
        let words = [block.i.take(), block.j.take(), block.k.take()];
        let Some(named) = self.assembler.direction(words.map(|word| word.map(|(value, _)| value)), whole)
        else {
            return false;
        };
        for (axis, units) in named {
            block.named[block.count] = (axis, units);
            block.count += 1;
        }
        true
    }

    /// `length_offset = "G", { "0" }, "43", { blank }, "H", number`, after a tool call whose lines in the machine file end
    /// with it; also with words between
    pub(super) fn length_offset(&mut self, block: &mut Block, whole: Range<usize>) {
        let (offset, number) = (block.offset.take(), block.h.take());
        // Due after a tool call; after that each section may call it again.
        match (offset, number, self.offset_due.or(self.offset_again)) {
            (Some(_), Some((h, range)), Some(due)) => {
                // `2{register}` filled in is H212 for register 12.
                let call = self.offset_call.clone().unwrap_or(Template("{register}".to_owned()));
                let written = h.units(0).map(|h| h.to_string()).unwrap_or_default();
                let values = call.matched(&written).unwrap_or_default();
                let register = values.first().and_then(|(_, value)| value.parse::<u32>().ok());
                let free = call.variables().any(|name| name == "register");
                let takes = match register {
                    Some(register) if register == due || free => {
                        self.assembler.takes_register(register, self.assembler.span(range.clone()))
                    }
                    Some(_) | None => false,
                };
                if !takes {
                    let message = format!("the length of register {due} is due here, not that of H{h}");
                    self.error("tool-offset", message, range);
                }
                self.offset_due = None;
                self.offset_again = None;
                self.offset_tool = self.assembler.tool().map(ToolCall::register);
                self.takes_length(whole);
            }
            (Some(range), _, _) => {
                self.error("tool-offset", "G43 H is read after a tool call that asks for it", range);
            }
            (None, Some((_, range)), _) => self.error("word-unknown", "H is read with G43 only", range),
            (None, None, _) => {
                let Some(h) = self.offset_due else { return };
                let moves = match self.motion {
                    Motion::None => false,
                    Motion::Rapid => block.named().iter().any(|(axis, _)| Some(*axis) == self.z),
                    Motion::Line | Motion::Arc(_) | Motion::Nurbs | Motion::Through => 0 < block.count,
                };
                if moves {
                    self.offset_due = None;
                    let call = self.assembler.tool().unwrap_or(ToolCall::own(h));
                    let template = self.offset_call.clone().unwrap_or(Template("{register}".to_owned()));
                    let register = register(&template, call);
                    let message = format!("tool {} moves before its `G43 H{register}`", call.number);
                    self.error("tool-offset-missing", message, whole);
                }
            }
        }
    }
}
