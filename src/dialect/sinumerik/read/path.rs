//! What a curve's path is on the control: which axes share its parameter, and what a denominator divides.

use super::Reader;
use crate::decimal::power_of_ten;
use crate::diagnostic::Diagnostic;
use crate::dialect::assemble::Assembler;
use crate::ir::{Decimals, PolynomialBlock, Units, Written};
use crate::pass::check::moving;
use crate::source::Span;
use crate::units::Kind;
use crate::verify::to_nurbs;

/// The geometry axes: PO[] divides their coordinates and no others.
const GEOMETRY: [&str; 3] = ["X", "Y", "Z"];

/// What is wrong with the denominator of a block that starts at `start`.
pub(super) fn denominator_fault(
    assembler: &Assembler<'_>,
    block: &PolynomialBlock,
    start: &Units,
    named: &[(usize, i64)],
) -> Option<(&'static str, String)> {
    let denominator = block.denominator?;
    let axes = assembler.machine.axes;
    for (axis, end) in named {
        let name = axes.name(*axis);
        if !denominator.divides[*axis] && *end != start[*axis] {
            let message = format!("{name} moves beside PO[] without a PO[{name}]");
            return Some(("denominator-axis", message));
        }
        let geometry = axes.kind(*axis) == Kind::Linear && GEOMETRY.contains(&name.as_str());
        if denominator.divides[*axis] && !geometry {
            return Some(("denominator-axis", format!("PO[] divides X, Y and Z; {name} is none of them")));
        }
    }
    let piece = block.to_bezier(&assembler.digits, start);
    let positive = piece.weights[..=piece.degree].iter().all(|w| 0.0 < *w && w.is_finite());
    (!positive).then(|| ("denominator-range", "the denominator PO[] is not above zero everywhere".to_owned()))
}

/// Whether the axes given are linear in the parameter on every span, to two units of the last decimal. Then their path
/// is straight there and its length is the parameter. What the control makes of points is its own affair.
fn linear_in_parameter(decimals: &Decimals, curve: &Written, axes: &[usize]) -> bool {
    match curve {
        Written::Lines(_) | Written::Arc(_) | Written::Through(..) => true,
        Written::Polynomial(polynomial) => polynomial.blocks.iter().all(|block| {
            block.denominator.is_none()
                && axes.iter().all(|i| block.coefficients[*i].iter().all(|a| a.is_zero()))
        }),
        Written::Nurbs(nurbs) => to_nurbs(decimals, nurbs).is_ok_and(|spline| {
            spline.beziers().all(|(piece, _)| {
                let (first, last, m) = (piece.start(), piece.end(), piece.degree);
                axes.iter().all(|&axis| {
                    let slack = 2.0 / power_of_ten(decimals.digits[axis]) as f64;
                    (1..m).all(|i| {
                        let share = i as f64 / m as f64;
                        (piece.points[i][axis] - first[axis] - share * (last[axis] - first[axis])).abs()
                            <= slack
                    })
                })
            })
        }),
    }
}

impl Reader<'_> {
    /// A curve that moves a rotary axis needs UPATH, where the machine has it, so that all axes follow one parameter;
    /// a spline also needs a SPLINEPATH with every axis that it moves. Where the machine has no UPATH, rotary axes
    /// follow the arc length, which is the same only while the linear axes are linear in the parameter.
    pub(super) fn path_reference(&mut self, curve: &Written, span: Span) {
        let axes = self.assembler.machine.axes;
        let moved = moving(curve);
        let (rotary, linear): (Vec<usize>, Vec<usize>) =
            moved.iter().partition(|i| axes.kind(**i) == Kind::Rotary);
        if rotary.is_empty() {
            return;
        }
        let spline = matches!(curve, Written::Nurbs(_) | Written::Through(..));
        if spline && !moved.iter().all(|i| self.splinepath.contains(i)) {
            let diagnostic =
                Diagnostic::error("splinepath-missing", "SPLINEPATH does not name every axis of this spline");
            self.assembler
                .diagnostics
                .push(diagnostic.at(span, "").hint("without it the spline has the first three axes only"));
        }
        let shared = self.assembler.machine.spline.shared_parameter;
        let by_arc_length =
            if shared { !self.upath } else { !linear_in_parameter(&self.assembler.empty(), curve, &linear) };
        if by_arc_length {
            let message = "without UPATH the rotary axes follow the arc length here, which is another curve";
            self.assembler.diagnostics.push(Diagnostic::error("arc-length", message).at(span, ""));
        }
    }
}
