//! From where places count: shifts, tilted planes, transformations and work offsets, and which of them go together.

use super::assemble::Assembler;
use super::stated::WorkOffset;
use crate::decimal::Decimal;
use crate::diagnostic::Diagnostic;
use crate::ir::{Shift, Step};
use crate::source::Span;
use crate::units::MAX_AXES;

impl Assembler<'_> {
    /// Counts axes from other places from here on.
    ///
    /// What a shift means within a tilted plane depends on which came first, and no page says it for every control.
    pub fn shift(&mut self, mut shifts: Vec<Shift<Decimal>>, replaces: bool, span: Span) {
        if replaces {
            // What the line does not name counts from the work's own zero again.
            let others =
                |axis: &usize| self.shift[*axis] != 0 && shifts.iter().all(|shift| shift.axis != *axis);
            let others: Vec<usize> = (0..MAX_AXES).filter(others).collect();
            shifts.extend(others.iter().map(|axis| Shift {
                axis: *axis,
                to: Decimal::ZERO,
                parameter: false,
            }));
        }
        if shifts.is_empty() {
            return;
        }
        if self.tilted && shifts.iter().any(|shift| !shift.to.is_zero()) {
            self.shift_elsewhere("a work offset within a tilted plane is not read", span);
        }
        for Shift { axis, to, .. } in &shifts {
            self.shift[*axis] = to.units(self.digits[*axis]).unwrap_or_default();
        }
        self.step(Step::Shift(shifts), span);
    }

    /// Whether a tilted plane is in force.
    pub fn is_tilted(&self) -> bool {
        self.tilted
    }

    pub(super) fn is_shifted(&self) -> bool {
        self.shift != [0; MAX_AXES]
    }

    pub(super) fn shift_elsewhere(&mut self, message: &str, span: Span) {
        self.diagnostics.push(Diagnostic::error("offset-tilted", message).at(span, "").hint(
            "end the work offset before the plane, and state the places in the plane's own coordinates",
        ));
    }

    /// A transformation may end the shift before it, where a control has one word for all of it.
    pub(super) fn changes_frames(&mut self, span: Span) {
        if self.is_shifted() && self.machine.dialect.replaces_shift.is_some() {
            self.diagnostics.push(
                Diagnostic::error("offset-transformed", "the control may end the work offset here")
                    .at(span, "")
                    .hint("end it before the tool's tip is led, or state it behind"),
            );
        }
    }

    /// Whether anything moved so far, or was switched.
    pub fn has_steps(&self) -> bool {
        self.run.is_some() || self.steps.iter().any(|located| !matches!(located.step, Step::Comment(_)))
    }

    fn has_moved(&self) -> bool {
        let moves = |step: &_| matches!(step, Step::Rapid(_) | Step::Cut(_));
        self.run.is_some() || self.steps.iter().any(|located| moves(&located.step))
    }

    /// Meets a work offset, G54. One place of the work has one; the machine's own lines may choose another.
    pub fn work_offset(&mut self, word: &str, range: std::ops::Range<usize>, fixed: bool) {
        let known = self.stated.offset.as_ref().map(|offset| offset.word == word);
        if known == Some(true) {
            return;
        }
        if !fixed && (known == Some(false) || self.has_moved()) {
            let message = format!("{word}: another work offset is another place");
            return self.error("code-refused", message, range);
        }
        self.stated.offset = Some(WorkOffset { word: word.to_owned(), span: self.span(range), fixed });
    }
}
