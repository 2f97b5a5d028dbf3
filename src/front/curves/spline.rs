//! B-splines as files state them.

use super::{Point, position};
use crate::diagnostic::Diagnostic;
use crate::geom::nurbs::{Nurbs, NurbsError};
use crate::source::Span;

/// Parameters that differ by less than this share of the range are one: files print them with 15 digits or fewer.
const SAME: f64 = 1.0e-9;

/// A number and where it stands.
pub(super) type Number = (f64, Span);

/// A B-spline as a file states it.
pub(super) struct Stated {
    /// What the file calls it.
    pub(super) kind: &'static str,
    /// Where it stands.
    pub(super) span: Span,
    /// Its degree.
    pub(super) degree: Number,
    /// All knots.
    pub(super) knots: Vec<Number>,
    /// One a point, or none.
    pub(super) weights: Vec<Number>,
    /// Its control points.
    pub(super) points: Vec<Point>,
    /// The parameters at which it starts and ends, where it is a part only.
    pub(super) range: Option<[f64; 2]>,
}

impl Stated {
    /// The B-spline.
    ///
    /// # Errors
    /// It is none, or its degree is above 5.
    pub(super) fn nurbs(self) -> Result<Nurbs, Diagnostic> {
        let Stated { kind, span, degree, knots, weights, points, range } = self;
        let count = points.len();
        let fail = |id, message: String, at: Span| Diagnostic::error(id, message).at(at, "");
        let whole = degree.0 as usize;
        if !(1.0..=5.0).contains(&degree.0) || whole as f64 != degree.0 {
            let message = format!("{kind} has degree {}; curves of degree 1 to 5 are read", degree.0);
            return Err(fail("degree-range", message, degree.1)
                .hint("have the CAD system approximate it by a cubic spline"));
        }
        if !weights.is_empty() && weights.len() != count {
            let message = format!("{kind} has {} weights for {count} control points", weights.len());
            return Err(fail("weight-count", message, span));
        }
        let places: Vec<Span> = knots.iter().map(|knot| knot.1).collect();
        let values = knots.iter().map(|knot| knot.0).collect();
        let ratios =
            if weights.is_empty() { vec![1.0; count] } else { weights.iter().map(|w| w.0).collect() };
        let points = points.iter().map(position).collect();
        let nurbs = Nurbs::clamped(whole, values, points, ratios).map_err(|error| {
            let knot = |i: usize| places.get(i).copied().unwrap_or(span);
            let (id, at) = match error {
                NurbsError::Degree(_) => ("degree-range", degree.1),
                NurbsError::Counts { .. } => ("knot-count", span),
                NurbsError::Decreases(i) => ("knots-decrease", knot(i)),
                NurbsError::NotClamped(_) => ("knots-empty", knot(0)),
                NurbsError::TooOften(i) => ("knot-too-often", knot(i)),
                NurbsError::Breaks(i) => ("curve-breaks", knot(i)),
                NurbsError::Weight(i) => ("weight-range", weights.get(i).map_or(span, |w| w.1)),
            };
            let message = match error {
                NurbsError::NotClamped(_) => format!("the knots of {kind} leave no range for its parameter"),
                NurbsError::Weight(i) => {
                    let weight = weights.get(i).map_or(0.0, |w| w.0);
                    format!("{kind} has the weight {weight}; weights are greater than zero")
                }
                NurbsError::Degree(_)
                | NurbsError::Counts { .. }
                | NurbsError::Decreases(_)
                | NurbsError::TooOften(_)
                | NurbsError::Breaks(_) => format!("{kind}: {error}"),
            };
            fail(id, message, at)
        })?;
        match range {
            None => Ok(nurbs),
            Some([from, to]) => part(&nurbs, from, to).ok_or_else(|| {
                let knots = nurbs.knots();
                let message = format!(
                    "{kind} runs from {from} to {to}, and its knots from {} to {}",
                    knots[0],
                    knots[knots.len() - 1]
                );
                fail("range-outside", message, span)
            }),
        }
    }
}

/// The same curve from its end to its start, on knots that run the other way.
pub(super) fn reversed(nurbs: &Nurbs) -> Nurbs {
    let (first, last) = (nurbs.knots()[0], nurbs.knots()[nurbs.knots().len() - 1]);
    // Ends are kept to the last bit, so that the clamped knots stay equal.
    let turn = |t: &f64| {
        if *t == first {
            last
        } else if *t == last {
            first
        } else {
            first + (last - t)
        }
    };
    let back = Nurbs::new(
        nurbs.degree(),
        nurbs.knots().iter().rev().map(turn).collect(),
        nurbs.points().iter().rev().copied().collect(),
        nurbs.weights().iter().rev().copied().collect(),
    );
    back.unwrap_or_else(|_| nurbs.clone())
}

/// The part of a curve between two parameters, by knot insertion; none where they lie outside or are one.
///
/// With knots from and to p-fold, t_s … t_{s+p−1} and t_e … t_{e+p−1}, the part has the points P_{s−1} … P_{e−1}.
pub(super) fn part(nurbs: &Nurbs, from: f64, to: f64) -> Option<Nurbs> {
    let p = nurbs.degree();
    let (first, last) = (nurbs.knots()[0], nurbs.knots()[nurbs.knots().len() - 1]);
    let near = SAME * (last - first);
    // A knot that is meant is taken.
    let meant = |t: f64| nurbs.knots().iter().copied().find(|k| (k - t).abs() <= near).unwrap_or(t);
    let (from, to) = (meant(from), meant(to));
    if !(first <= from && from < to && to <= last) {
        return None;
    }
    if from == first && to == last {
        return Some(nurbs.clone());
    }
    let mut whole = nurbs.clone();
    for t in [from, to] {
        if first < t && t < last {
            while whole.knots().iter().filter(|k| **k == t).count() < p {
                whole = whole.with_knot(t);
            }
        }
    }
    let knots = whole.knots();
    let start = if from == first { 1 } else { knots.partition_point(|k| *k < from) };
    let end = knots.partition_point(|k| *k < to);
    let mut own = vec![from];
    own.extend_from_slice(&knots[start..end + p]);
    own.push(to);
    let (points, weights) = (&whole.points()[start - 1..end], &whole.weights()[start - 1..end]);
    Nurbs::new(p, own, points.to_vec(), weights.to_vec()).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Nurbs {
        let points = [(0., 0.), (10., 5.), (30., 24.), (60., 0.), (90., -24.), (110., 0.)];
        let points = points.iter().map(|(x, y)| position(&[*x, *y, 1.0])).collect();
        let knots = vec![0., 0., 0., 0., 30., 30., 90., 90., 90., 90.];
        Nurbs::new(3, knots, points, vec![1.0, 2.0, 0.5, 1.0, 3.0, 1.0]).unwrap()
    }

    #[test]
    fn a_part_is_the_same_curve() {
        let whole = sample();
        for (from, to) in [(0.0, 45.0), (10.0, 80.0), (30.0, 90.0), (30.000_000_001, 60.0), (0.0, 90.0)] {
            let part = part(&whole, from, to).unwrap();
            for i in 0..=20 {
                let t = from + (to - from) * f64::from(i) / 20.0;
                for axis in 0..3 {
                    // Some twenty roundings of numbers near 110, and a knot that was meant 1e-9 beside.
                    assert!((part.eval(t)[axis] - whole.eval(t)[axis]).abs() < 1e-8, "{from} {to} {t}");
                }
            }
        }
        assert!(part(&whole, -1.0, 20.0).is_none() && part(&whole, 50.0, 50.0).is_none());
        assert!(part(&whole, f64::NAN, 20.0).is_none());
    }

    #[test]
    fn backwards_is_the_same_curve() {
        let (whole, back) = (sample(), reversed(&sample()));
        for i in 0..=20 {
            let t = 4.5 * f64::from(i);
            for axis in 0..3 {
                assert!((whole.eval(t)[axis] - back.eval(90.0 - t)[axis]).abs() < 1e-12);
            }
        }
    }
}
