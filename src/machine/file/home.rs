//! Where axes retract to, and by which lines.

use super::Reader;
use crate::diagnostic::Diagnostic;
use crate::dialect::Dialect;
use crate::machine::Frame;
use crate::machine::line::{Word, words};
use crate::units::Axis;

impl Reader {
    /// The axis that the lines of `home` name themselves, as `G91 G28 Z0.` does; none where one is filled in.
    pub(super) fn home_axis(&mut self, frame: &Frame, dialect: &Dialect) -> Option<Axis> {
        let all: Vec<Word> = frame.home.iter().flat_map(|line| words(&line.0)).collect();
        if all.is_empty() {
            return None;
        }
        let fixed = |word: &Word| dialect.in_machine.iter().any(|code| word.is(code));
        if !all.iter().any(fixed) {
            let message = "home goes to a place of the work, which is clear of nothing: a retraction counts in machine coordinates";
            let error = Diagnostic::error("home-coordinates", message);
            self.diagnostics.push(error.hint(format!("write {} beside it", dialect.in_machine[0])));
            return None;
        }
        if all.iter().any(|word| word.has("home")) {
            return None;
        }
        let declared = self.declared?;
        let axis = |word: &Word| {
            let axis = Axis::new(&word.address).filter(|axis| declared.index_of(*axis).is_some())?;
            word.number().map(|_| axis)
        };
        let named: Vec<Axis> = all.iter().filter_map(axis).collect();
        let [axis] = named[..] else {
            let axes = if named.is_empty() { "no axis" } else { "several axes" };
            let message = format!("home names {axes}, so that no program knows which one it retracts");
            let error = Diagnostic::error("home-axis", message);
            self.diagnostics.push(error.hint("write {home} where the axis and its home stand, or one axis"));
            return None;
        };
        Some(axis)
    }
}
