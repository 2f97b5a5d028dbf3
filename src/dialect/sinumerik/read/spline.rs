//! BSPLINE: the knot vector from the distances PL.

use super::{Reader, Run};
use crate::decimal::{Decimal, power_of_ten};
use crate::diagnostic::Diagnostic;
use crate::ir::WrittenNurbs;
use crate::verify::to_nurbs;

impl Reader<'_> {
    /// The knot vector from the distances: t₂ = 0, t_{j+2} = t_{j+1} + PL_j.
    pub(super) fn bspline(&mut self, run: Run) -> Option<WrittenNurbs> {
        let whole = run.span.start as usize..run.span.end as usize;
        let Run { mut points, mut lines, mut pl, mut pw, degree, .. } = run;
        points.insert(0, run.start);
        lines.insert(0, lines.first().copied().unwrap_or(0));
        // A first block that repeats the first point has an empty support; its weight is that of the point.
        let mut first_weight = None;
        if degree + 2 <= points.len()
            && points[0] == points[1]
            && pl[0].is_zero()
            && pl[1].is_zero()
            && degree == 3
        {
            points.remove(0);
            lines.remove(0);
            pl.remove(0);
            first_weight = pw.remove(0);
        }
        let n = points.len();
        if n <= degree {
            self.assembler.error(
                "spline-too-short",
                format!("a B-spline of degree {degree} needs at least {degree} blocks"),
                whole,
            );
            return None;
        }
        let knot_digits =
            pl.iter().map(|d| d.digits()).max().unwrap_or(0).max(self.assembler.machine.digits.knot);
        let mut knots = vec![0i64; 3];
        if run.missing_pl {
            if pl.iter().any(|d| !d.is_zero()) {
                self.assembler.error("pl-missing", "PL stands on some blocks of this spline only", whole);
                return None;
            }
            self.assembler.diagnostics.push(
                Diagnostic::warning(
                    "knots-unknown",
                    "without PL the control chooses the knots; uniform ones are taken here",
                )
                .at(run.span, ""),
            );
            let spans = n - degree;
            knots = vec![0; degree + 1];
            knots.extend((1..spans).map(|i| i as i64 * power_of_ten(knot_digits)));
            knots.extend(std::iter::repeat_n(spans as i64 * power_of_ten(knot_digits), degree + 1));
        } else {
            for (distance, line) in pl.iter().zip(&lines[1..]) {
                let units = distance.units(knot_digits).filter(|units| 0 <= *units);
                let next = units.and_then(|units| knots[knots.len() - 1].checked_add(units));
                let Some(next) = next else {
                    self.assembler.error(
                        "pl-range",
                        format!("PL={distance} in line {line} is no knot distance"),
                        whole,
                    );
                    return None;
                };
                knots.push(next);
            }
            let last = knots[knots.len() - 1];
            while knots.len() < n + degree + 1 {
                knots.push(last);
            }
        }
        let weights = if pw.iter().all(Option::is_none) && first_weight.is_none() {
            None
        } else {
            let one = Decimal::new(1, 0);
            Some(
                std::iter::once(first_weight.unwrap_or(one))
                    .chain(pw.iter().map(|w| w.unwrap_or(one)))
                    .collect(),
            )
        };
        let nurbs = WrittenNurbs { degree, knots, knot_digits, points, weights, lines };
        if let Err(error) = to_nurbs(&self.assembler.empty(), &nurbs) {
            self.assembler.error("spline-unsound", error.to_string(), whole);
            return None;
        }
        Some(nurbs)
    }
}
