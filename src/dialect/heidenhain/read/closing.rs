//! SPL states its start through its coefficients: whether that is where the tool is.

use super::{Reader, magnitude, signed, start_tolerance};
use crate::decimal::Decimal;
use crate::diagnostic::Diagnostic;
use crate::source::Span;
use std::ops::Range;

impl Reader<'_, '_> {
    pub(super) fn coefficients_missing(
        &mut self,
        axis: usize,
        k: &[Option<Decimal>; 3],
        range: Range<usize>,
    ) {
        let name = self.assembler.machine.axes.name(axis);
        let missing: Vec<String> =
            (0..3).rev().filter(|i| k[*i].is_none()).map(|i| format!("K{}{name}", i + 1)).collect();
        let span = self.assembler.span(range);
        let verb = if missing.len() == 1 { "is" } else { "are" };
        self.assembler.diagnostics.push(
            Diagnostic::error("coefficients-missing", format!("{} {verb} missing", missing.join(", ")))
                .at(span, "")
                .hint("in SPL every coordinate has K3, K2 and K1, zeros too"),
        );
    }

    /// Whether a block starts where the tool is, axis by axis: stated by the coefficients, and the tool's place.
    pub(super) fn closes(
        &mut self,
        axes: &[(usize, Decimal, Decimal)],
        head: Range<usize>,
        span: Span,
    ) -> bool {
        let mut worst = Decimal::ZERO;
        let (mut stated_at, mut tool_at) = (String::new(), String::new());
        for (axis, stated, tool) in axes {
            let Some(gap) = stated.minus(*tool).and_then(magnitude) else {
                self.assembler.error("coefficient-range", "the numbers of this block are too large", head);
                return false;
            };
            if gap.compare(worst).is_gt() {
                worst = gap;
            }
            if gap.compare(start_tolerance()).is_gt() {
                let name = self.assembler.machine.axes.name(*axis);
                for (text, value) in [(&mut stated_at, stated), (&mut tool_at, tool)] {
                    text.extend([" ", name.as_str(), &signed(*value)]);
                }
            }
        }
        if worst.compare(start_tolerance()).is_gt() {
            let head = self.assembler.span(head);
            self.assembler.diagnostics.push(
                Diagnostic::error("start-mismatch", "spline does not start where the tool is")
                    .at(head, format!("starts at{stated_at}, the tool is at{tool_at}: {worst} apart"))
                    .hint(format!("the control accepts {} mm", start_tolerance())),
            );
            return false;
        }
        if !worst.is_zero() && self.gap.is_none_or(|(known, _)| known.compare(worst).is_lt()) {
            self.gap = Some((worst, span));
        }
        true
    }
}
