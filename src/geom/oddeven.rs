//! Odd-even third-order steps along the logarithmic curve (Jiang and Chen).
//!
//! A cycle is one odd and one even step of length Δl in the paper's mixed measure of mm and radians, from (X0, A0)
//! on or near the curve. With q = 1 + βX0, k = ab and h = √(q² + k²) the odd step goes along the tangent,
//! tan θ = k/q:
//!
//! ```text
//! ΔX10 = q Δl / h          ΔA10 = k Δl / h                                                                    (8) (9)
//! ```
//!
//! The even step corrects by the third-order Taylor approach. As printed, (14) and (15) divide by a = k/β; with
//! w = ΔA10/a = β Δl / h and s = sin θ = k/h they read
//!
//! ```text
//! ΔX21 = ΔX10 · [3 − 2w²s²(3 − 8w)] / [3 − 2ws²(3 − 4w)]
//! ΔA21 = ΔA10 · [3 − 2w(3 − 4w)]    / [3 − 2ws²(3 − 4w)]
//! ```
//!
//! which stays finite for S = 0 (k = 0) and for a cylinder (β = 0, hence w = 0: the even step repeats the odd one).
//! Y and Z follow X. The formulas lose their meaning where w is no longer small; [`OddEven::new`] refuses
//! |w| ≥ 3/8.

use super::deviation::{Bound, log_chord};
use super::logcurve::LogCurve;

/// Above this many points a spec is a mistake: 2·10⁷ points are a gigabyte of program.
pub const MAX_POINTS: f64 = 2.0e7;

/// Why a step length cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum StepError {
    /// Δl is NaN, infinite, zero or negative.
    #[error("the step must be greater than zero")]
    NotPositive,
    /// |w| ≥ 3/8: 3 − 8w or its like is no longer positive.
    #[error("the step is too large for the third-order formulas; below {limit:.4} they hold")]
    TooLarge {
        /// The Δl at which they fail.
        limit: f64,
    },
    /// More than [`MAX_POINTS`] points.
    #[error("the path would take {points:.1e} points")]
    TooManyPoints {
        /// About how many.
        points: f64,
    },
}

/// The points of one flute after the first, (X, A) with A in radians: odd, even, odd, even, …
///
/// The last point is at X = end exactly, with the exact A there; with `overrun` the paper's rule holds instead:
/// whole cycles until X reaches or passes the end.
#[derive(Clone, Debug)]
pub struct OddEven {
    curve: LogCurve,
    dl: f64,
    overrun: bool,
    x: f64,
    a: f64,
    /// The even step that follows, once its odd step was made.
    even: Option<(f64, f64)>,
    done: bool,
}

impl OddEven {
    /// Steps of length `dl` along `curve`, from its start.
    ///
    /// # Errors
    /// A step that is not positive, too large for the formulas, or so small that the points are beyond counting.
    pub fn new(curve: LogCurve, dl: f64, overrun: bool) -> Result<OddEven, StepError> {
        if !(0.0 < dl && dl.is_finite()) {
            return Err(StepError::NotPositive);
        }
        // w = β Δl / h is greatest where q is least. An odd step may still be made there, one Δl beyond the end
        // under overrun; q is then less by at most |w| q.
        let (q0, q1) = (1.0 + curve.beta() * curve.start(), 1.0 + curve.beta() * curve.end());
        let q = f64::min(q0, q1);
        let h = (q * q + curve.k() * curve.k()).sqrt();
        let limit = if curve.beta() == 0.0 { f64::INFINITY } else { 0.375 * h / curve.beta().abs() };
        if limit <= dl {
            return Err(StepError::TooLarge { limit });
        }
        let points = most_points(&curve, dl);
        if MAX_POINTS < points {
            return Err(StepError::TooManyPoints { points });
        }
        let (x, a) = (curve.start(), curve.angle(curve.start()));
        Ok(OddEven { curve, dl, overrun, x, a, even: None, done: false })
    }

    /// Not fewer points than there will be.
    pub fn most_points(&self) -> f64 {
        most_points(&self.curve, self.dl) + 2.0
    }

    /// The odd step and the even step from X, as ((ΔX10, ΔA10), (ΔX21, ΔA21)).
    fn odd_and_even(&self) -> ((f64, f64), (f64, f64)) {
        let (k, beta) = (self.curve.k(), self.curve.beta());
        let q = 1.0 + beta * self.x;
        let h = (q * q + k * k).sqrt();
        let unit = self.dl / h;
        let (dx10, da10) = (q * unit, k * unit);
        let w = beta * unit;
        let s2 = (k / h) * (k / h);
        let scale = 1.0 / (3.0 - 2.0 * w * s2 * (3.0 - 4.0 * w));
        let dx21 = dx10 * (3.0 - 2.0 * w * w * s2 * (3.0 - 8.0 * w)) * scale;
        let da21 = da10 * (3.0 - 2.0 * w * (3.0 - 4.0 * w)) * scale;
        ((dx10, da10), (dx21, da21))
    }
}

/// The arc length ∫√(1 + A′²) dX in the mixed measure, from above, in steps.
fn most_points(curve: &LogCurve, dl: f64) -> f64 {
    let slope = curve.slope(curve.start()).abs().max(curve.slope(curve.end()).abs());
    (curve.end() - curve.start()) * (1.0 + slope * slope).sqrt() / dl
}

impl Iterator for OddEven {
    type Item = (f64, f64);

    #[inline]
    fn next(&mut self) -> Option<(f64, f64)> {
        if self.done {
            return None;
        }
        let end = self.curve.end();
        let (dx, da) = if let Some(step) = self.even.take() {
            step
        } else {
            let (odd, even) = self.odd_and_even();
            self.even = Some(even);
            odd
        };
        let (x, a) = (self.x + dx, self.a + da);
        if self.overrun {
            // A cycle is whole when no even step is left to do.
            self.done = self.even.is_none() && end <= x;
        } else if end - 1.0e-3 * self.dl <= x {
            // Clipped: a last step of less than a thousandth of Δl is not worth a block, so the point before it
            // moves to the end instead.
            self.done = true;
            let a = self.curve.angle(end);
            (self.x, self.a) = (end, a);
            return Some((end, a));
        }
        (self.x, self.a) = (x, a);
        Some((x, a))
    }
}

/// The bound on the distance between the polyline through the steps and the curve.
pub fn polyline_deviation(curve: &LogCurve, steps: OddEven) -> Bound {
    let mut from = (curve.start(), curve.angle(curve.start()));
    let mut bound = Bound::ZERO;
    for to in steps {
        bound = bound.max(log_chord(curve, from, to));
        from = to;
    }
    bound
}

/// The largest Δl ≤ `most` whose polyline stays within `tolerance` mm of the curve at the surface, to four digits.
///
/// The error of an odd step is ½|A''|ΔX² to first order, so it falls with Δl²; from that guess the answer is
/// bracketed and bisected on what [`polyline_deviation`] measures.
///
/// # Errors
/// The step that would hold the tolerance makes too many points.
pub fn largest_step(curve: &LogCurve, tolerance: f64, most: f64, overrun: bool) -> Result<f64, StepError> {
    let holds = |dl: f64| -> Result<bool, StepError> {
        match OddEven::new(*curve, dl, overrun) {
            Ok(steps) => Ok(polyline_deviation(curve, steps).mm <= tolerance),
            Err(StepError::TooLarge { .. }) => Ok(false),
            Err(error) => Err(error),
        }
    };
    if holds(most)? {
        return Ok(most);
    }
    // The greatest ½|kβ| q/(q² + k²) · D1/2 over the curve, times Δl², is about the error at the surface: q/(q² + k²)
    // is greatest at q = |k| or at an end.
    let (k, beta) = (curve.k(), curve.beta());
    let (q_start, q_end) = (1.0 + beta * curve.start(), 1.0 + beta * curve.end());
    let share = |q: f64| q / (q * q + k * k);
    let mut worst = share(q_start).max(share(q_end));
    if q_start.min(q_end) < k.abs() && k.abs() < q_start.max(q_end) {
        worst = worst.max(share(k.abs()));
    }
    let guess = (tolerance / (0.25 * (k * beta).abs() * worst * curve.cutter().d1)).sqrt();
    let (mut low, mut high) = (guess.min(most) * 0.9, most);
    while !holds(low)? {
        high = low;
        low *= 0.7;
    }
    for factor in [1.05, 1.1, 1.2] {
        if low * factor < high && !holds(low * factor)? {
            high = low * factor;
        }
    }
    while 1.0e-4 * low < high - low {
        let middle = 0.5 * (low + high);
        if holds(middle)? {
            low = middle;
        } else {
            high = middle;
        }
    }
    let short = four_digits_down(low);
    Ok(if holds(short)? { short } else { low })
}

/// `x` > 0 cut off after four significant digits, so that it can be named.
fn four_digits_down(x: f64) -> f64 {
    let mut scale = 1.0;
    while x * scale < 1000.0 {
        scale *= 10.0;
    }
    (x * scale).floor() / scale
}

#[cfg(test)]
mod tests {
    use super::super::logcurve::tests::paper;
    use super::super::logcurve::{Cutter, LogCurve};
    use super::*;
    use crate::geom::elementary::{sin, tan};
    use crate::units::DEGREES;
    use approx::assert_relative_eq;

    fn steps(cutter: Cutter, dl: f64, overrun: bool) -> Vec<(f64, f64)> {
        OddEven::new(LogCurve::new(cutter, 0.0).unwrap(), dl, overrun).unwrap().collect()
    }

    #[test]
    fn agrees_with_the_formulas_as_printed() {
        let (a, b) = (tan(30.0 / DEGREES) / tan(5.0 / DEGREES), 2.0 * tan(5.0 / DEGREES) / 10.0);
        let points = steps(paper(), 0.2, true);
        let (mut x, mut angle) = (0.0, 0.0);
        for pair in points.chunks(2) {
            let q: f64 = 1.0 + b * x;
            let h = (q * q + a * b * a * b).sqrt();
            let (dx, da) = (q * 0.2 / h, a * b * 0.2 / h);
            let s2 = (a * b / h) * (a * b / h);
            let lower = 3.0 * a * a - 2.0 * da * s2 * (3.0 * a - 4.0 * da);
            let x21 = dx * (3.0 * a * a * a - 2.0 * da * da * s2 * (3.0 * a - 8.0 * da)) / (a * lower);
            let a21 = da * (3.0 * a * a - 2.0 * da * (3.0 * a - 4.0 * da)) / lower;
            // 152 steps of a few roundings each: 1e-13 is ten times their sum.
            assert_relative_eq!(pair[0].0, x + dx, epsilon = 1e-13);
            assert_relative_eq!(pair[0].1, angle + da, epsilon = 1e-13);
            (x, angle) = (x + dx + x21, angle + da + a21);
            assert_relative_eq!(pair[1].0, x, epsilon = 1e-13);
            assert_relative_eq!(pair[1].1, angle, epsilon = 1e-13);
        }
    }

    #[test]
    fn every_step_has_its_length() {
        // |P1P2| = Δl holds to third order only: (15) drops terms of fourth order in w.
        let points = steps(paper(), 0.2, true);
        let mut from = (0.0, 0.0);
        for to in points {
            let (dx, da): (f64, f64) = (to.0 - from.0, to.1 - from.1);
            assert_relative_eq!((dx * dx + da * da).sqrt(), 0.2, max_relative = 1e-7);
            from = to;
        }
    }

    #[test]
    fn ends_exactly_unless_it_may_overrun() {
        let curve = LogCurve::new(paper(), 0.0).unwrap();
        assert_eq!(steps(paper(), 0.2, false).last(), Some(&(30.0, curve.angle(30.0))));
        let past = *steps(paper(), 0.2, true).last().unwrap();
        assert!(30.0 < past.0 && past.0 < 30.4);
    }

    #[test]
    fn cylinder_and_straight_flute_are_exact_lines() {
        for cutter in [Cutter { c: 0.0, ..paper() }, Cutter { s: 0.0, ..paper() }] {
            let curve = LogCurve::new(cutter, 0.0).unwrap();
            for (x, a) in steps(cutter, 0.2, false) {
                assert_relative_eq!(a, curve.angle(x), epsilon = 1e-13);
            }
        }
    }

    #[test]
    fn rake_and_hand_do_not_disturb_the_steps() {
        let left = steps(Cutter { hand: super::super::logcurve::Hand::Left, r: 0.0, ..paper() }, 0.2, false);
        for (l, r) in left.iter().zip(steps(paper(), 0.2, false)) {
            assert_eq!((l.0, l.1), (r.0, -r.1));
        }
        assert!(sin(0.1) > 0.0);
    }

    #[test]
    fn a_step_beyond_the_formulas_is_refused() {
        let curve = LogCurve::new(paper(), 0.0).unwrap();
        let Err(StepError::TooLarge { limit }) = OddEven::new(curve, 1.0e3, false) else {
            panic!("accepted")
        };
        // 3/8 · h / b with h = √(1 + k²)
        assert_relative_eq!(
            limit,
            0.375 * (1.0 + curve.k() * curve.k()).sqrt() / curve.beta(),
            max_relative = 1e-14
        );
        assert_eq!(OddEven::new(curve, 0.0, false).unwrap_err(), StepError::NotPositive);
        assert!(matches!(OddEven::new(curve, 1e-9, false), Err(StepError::TooManyPoints { .. })));
    }

    #[test]
    fn the_largest_step_holds_and_a_larger_one_does_not() {
        for cutter in
            [paper(), Cutter { c: -5.0, d1: 12.0, length: 20.0, ..paper() }, Cutter { s: 60.0, ..paper() }]
        {
            let curve = LogCurve::new(cutter, 0.0).unwrap();
            let dl = largest_step(&curve, 5e-5, 0.2, false).unwrap();
            let deviation = |dl| polyline_deviation(&curve, OddEven::new(curve, dl, false).unwrap()).mm;
            assert!(deviation(dl) <= 5e-5 && 5e-5 < deviation(dl * 1.01), "{dl}");
        }
    }
}
