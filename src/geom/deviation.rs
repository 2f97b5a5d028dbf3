//! The proof: upper bounds on the distance between a written path and the curve that was asked for.
//!
//! **Deviation** of a path p from a curve c is the greatest distance when both are run in order, from start to end,
//! each at its own pace: for a monotone map φ between their parameters, sup over t of ‖p(t) − c(φ(t))‖. Any φ gives
//! an upper bound, so each function states its φ. What is computed here is a bound for every t, not the greatest of
//! some samples.
//!
//! # A piece against the logarithmic curve
//!
//! φ is X: p(t) = (X(t), Y(t), Z(t), A(t)) is compared with c at the same X, which is in order while X′ ≥ 0.
//! The error in A is f(t) = A(t) − k X ln(1+βX)/(βX). It has no simple bound, but its derivative has, because the
//! logarithm's is rational:
//!
//! ```text
//! f′ = A′ − k X′/(1 + βX) = g/(1 + βX)          g = A′(1 + βX) − k X′, a polynomial
//! ```
//!
//! g is bounded by its Bernstein coefficients, 1 + βX from below by its own, and on an interval of width h
//!
//! ```text
//! |f| ≤ max(|f(t₀)|, |f(t₁)|) + h/2 · max|g| / min(1 + βX)
//! ```
//!
//! Intervals are halved until the bound is within a fiftieth of the greatest value seen. For a rational piece
//! X = N_X/D and so on, the same with
//!
//! ```text
//! f′ = [(N_A′ D − N_A D′)(D + βN_X) − k (N_X′ D − N_X D′) D] / [D² (D + βN_X)]
//! ```
//!
//! ΔY = Y − X tan C and ΔZ are polynomials over D, bounded by their coefficients.
//!
//! # A chord against the logarithmic curve
//!
//! On a straight piece f″ = kβ/(1+βX)² has one sign, so f lies between its chord and its chord less h²/8 · max|f″|.
//!
//! # Rounding
//!
//! Every bound is raised by 64 ε (ε = 2.2e-16) of the greatest angle met, index included, at the radius, by 64 ε of the
//! greatest products in g, and ΔY and ΔZ by 64 ε of the greatest coordinate: the functions round some 20 times, each by at
//! most ε/2 of a number no greater than that, and `libm`'s logarithm is within one ε.

use super::bernstein::Bernstein;
use super::bezier::Bezier;
use super::logcurve::LogCurve;
use crate::units::{DEGREES, Kind, Position};

/// Allowance for rounding, relative to the greatest number that takes part.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Halving stops here: an interval of 2⁻¹⁶ whose bound is still loose is taken as it is.
const MAX_DEPTH: u32 = 16;

/// And here: after so many intervals each further one is taken as it is, which is still a bound.
const MAX_SPANS: usize = 4096;

/// An upper bound on a deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// At the cutter's surface, mm; for other paths the distance in space.
    pub mm: f64,
    /// In the rotary axis, or between the directions of the tool, radians.
    pub rad: f64,
}

impl Bound {
    /// No deviation.
    pub const ZERO: Bound = Bound { mm: 0.0, rad: 0.0 };

    /// The greater of both, each for itself.
    #[must_use]
    pub fn max(self, other: Bound) -> Bound {
        Bound { mm: self.mm.max(other.mm), rad: self.rad.max(other.rad) }
    }
}

/// A path that is not run in the order of the curve.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum OrderError {
    /// X falls somewhere on the piece.
    #[error("the path runs back in X")]
    RunsBack,
    /// 1 + βX is not positive on the piece: the cutter ends before.
    #[error("the path leaves the cutter")]
    LeavesCutter,
    /// A number of the path is not finite.
    #[error("the path has a number that is not finite")]
    NotFinite,
}

/// The bound for a straight piece in (X, A), A in radians without the index, X rising; Y and Z on the cone exactly.
pub fn log_chord(curve: &LogCurve, (x0, a0): (f64, f64), (x1, a1): (f64, f64)) -> Bound {
    let (k, beta) = (curve.k(), curve.beta());
    let (f0, f1) = (a0 - curve.angle(x0), a1 - curve.angle(x1));
    let q = (1.0 + beta * x0).min(1.0 + beta * x1);
    if q <= 0.0 {
        return Bound { mm: f64::INFINITY, rad: f64::INFINITY };
    }
    let bend = (k * beta).abs() / (q * q);
    let sag = (x1 - x0) * (x1 - x0) * 0.125 * bend;
    let (low, high) = if 0.0 <= k * beta {
        (f0.min(f1) - sag, f0.max(f1)) // f″ ≥ 0: convex, below its chord
    } else {
        (f0.min(f1), f0.max(f1) + sag)
    };
    let rad = low.abs().max(high.abs()) + ROUNDING * a0.abs().max(a1.abs());
    Bound { mm: rad * curve.metric_radius(x0).max(curve.metric_radius(x1)), rad }
}

/// What is needed of a piece on one interval of t.
#[derive(Clone, Copy)]
struct Span {
    x: Bernstein,
    a: Bernstein,
    /// N_Y − tan C N_X and its like for Z.
    y: Bernstein,
    z: Bernstein,
    d: Bernstein,
    /// D + βN_X.
    q: Bernstein,
    /// The numerator of f′.
    g: Bernstein,
    /// The numerator of X′.
    forward: Bernstein,
}

impl Span {
    fn halves(&self) -> (Span, Span) {
        let (x, a, y, z) = (self.x.halves(), self.a.halves(), self.y.halves(), self.z.halves());
        let (d, q, g, forward) = (self.d.halves(), self.q.halves(), self.g.halves(), self.forward.halves());
        (
            Span { x: x.0, a: a.0, y: y.0, z: z.0, d: d.0, q: q.0, g: g.0, forward: forward.0 },
            Span { x: x.1, a: a.1, y: y.1, z: z.1, d: d.1, q: q.1, g: g.1, forward: forward.1 },
        )
    }
}

/// The bound for a piece in X Y Z (mm) and A (degrees) against the curve at X + s, s going evenly from the one to the other
/// of `ahead`, mm. With 0 and 0 that is at equal X.
///
/// # Errors
/// The piece runs back in X, or leaves the cutter.
pub fn log_piece(curve: &LogCurve, piece: &Bezier, ahead: [f64; 2]) -> Result<Bound, OrderError> {
    let (k, beta) = (curve.k(), curve.beta());
    let d = if piece.is_polynomial() { Bernstein::new(&[piece.weights[0]]) } else { piece.denominator() };
    // X + s, times the weight.
    let x = match ahead {
        [0.0, 0.0] => piece.numerator(0),
        _ => piece.numerator(0).combined(1.0, &Bernstein::new(&ahead).times(&d), 1.0),
    };
    let apart = ahead[0].abs().max(ahead[1].abs());
    // (A_deg − index) in radians, times the weight.
    let mut angle = *piece;
    for point in &mut angle.points {
        point[3] = (point[3] - curve.index) / DEGREES;
    }
    let a = angle.numerator(3);
    let quotient_rule =
        |n: &Bernstein| n.derivative().times(&d).combined(1.0, &n.times(&d.derivative()), -1.0);
    let forward = quotient_rule(&x);
    let q = d.combined(1.0, &x, beta);
    let g = quotient_rule(&a).times(&q).combined(1.0, &forward.times(&d), -k);
    let off = |axis: usize, slope: f64, shift: f64| {
        piece.numerator(axis).combined(1.0, &x, -slope).combined(1.0, &d, -shift)
    };
    let y = off(1, curve.y_slope(), curve.shift[0]);
    let z = off(2, curve.z_slope(), curve.shift[1]);
    let greatest = angle.control_points().iter().fold(0.0, |most: f64, p| most.max(p[3].abs()));
    let backward_noise = -ROUNDING * forward.max_abs();
    // g is a difference of two products, and each of them rounds.
    let g_noise =
        ROUNDING * (quotient_rule(&a).max_abs() * q.max_abs() + k.abs() * forward.max_abs() * d.max_abs());

    // `min` and `max` of floats pass over NaN, so that it has to be met here.
    let all = [&x, &a, &y, &z, &d, &q, &g, &forward];
    if !all.iter().all(|f| f.coefficients().iter().all(|c| c.is_finite())) {
        return Err(OrderError::NotFinite);
    }
    // A − index, Y − X tan C − shift and so on are differences, and each of their terms rounds.
    let greatest = greatest + (curve.index / DEGREES).abs();
    let (y_noise, z_noise) = (ROUNDING * terms(piece, 1), ROUNDING * terms(piece, 2));
    let mut bound = Bound::ZERO;
    let mut seen: f64 = 0.0;
    let mut spans = 0;
    let mut stack = vec![(Span { x, a, y, z, d, q, g, forward }, 0u32)];
    while let Some((span, depth)) = stack.pop() {
        let (d_min, q_min) = (span.d.min(), span.q.min());
        let width = 1.0 / f64::from(1u32 << depth);
        spans += 1;
        let settled = depth == MAX_DEPTH || MAX_SPANS < spans;
        if d_min <= 0.0 || q_min <= 0.0 {
            if settled {
                return Err(OrderError::LeavesCutter);
            }
        } else {
            let at = |x: f64, a: f64, d: f64| {
                let rad = (a / d - curve.angle(x / d)).abs();
                (rad, rad * curve.metric_radius(x / d))
            };
            let first = at(span.x.start(), span.a.start(), span.d.start());
            let last = at(span.x.end(), span.a.end(), span.d.end());
            let ends = first.0.max(last.0);
            let rad = ends
                + 0.5 * width * (span.g.max_abs() + g_noise) / (d_min * d_min * q_min)
                + ROUNDING * greatest;
            // N_X/D lies between the extremes of w_i X_i / D.
            let (x_min, x_max) = (span.x.min(), span.x.max());
            let d_max = span.d.max();
            let x_most = if 0.0 <= x_max { x_max / d_min } else { x_max / d_max };
            let x_least = if x_min <= 0.0 { x_min / d_min } else { x_min / d_max };
            let radius = curve.metric_radius(x_most).max(curve.metric_radius(x_least));
            let (dy, dz) = ((span.y.max_abs() + y_noise) / d_min, (span.z.max_abs() + z_noise) / d_min);
            let along = apart * apart + dy * dy + dz * dz;
            let mm = (rad * radius * rad * radius + along).sqrt();
            seen = seen.max(first.1).max(last.1);
            let tight = mm <= 1.02 * (seen * seen + along).sqrt() + 1.0e-9;
            let in_order = backward_noise <= span.forward.min();
            if (tight && in_order) || settled {
                if !in_order {
                    return Err(OrderError::RunsBack);
                }
                bound = bound.max(Bound { mm, rad });
                continue;
            }
        }
        let (left, right) = span.halves();
        stack.push((right, depth + 1));
        stack.push((left, depth + 1));
    }
    Ok(bound)
}

/// The greatest number that takes part in a piece's distance from the cone along one axis: coordinate and X, weighted.
fn terms(piece: &Bezier, axis: usize) -> f64 {
    piece.numerator(axis).max_abs() + piece.numerator(0).max_abs()
}

/// How the distance of two positions is measured: mm for a linear axis, the arc at `radius` for a rotary one. A direction
/// is no place: its components count nothing, or where a path is followed as so many mm.
#[derive(Clone, Debug, PartialEq)]
pub struct Metric {
    /// For each axis: 1 for a linear one, R/57.3 for a rotary one at radius R, mm for a component of a direction.
    scale: Vec<f64>,
    rotary: Vec<bool>,
    direction: Vec<bool>,
}

impl Metric {
    /// Distance with rotary axes counted at `radius` mm.
    pub fn new(kinds: &[Kind], radius: f64) -> Metric {
        Metric::with_direction(kinds, radius, 0.0)
    }

    /// The same with a component of a direction of length 1 counted as `reach` mm: that of a point so far from the tip.
    pub fn with_direction(kinds: &[Kind], radius: f64, reach: f64) -> Metric {
        let scale = |kind: &Kind| match kind {
            Kind::Linear => 1.0,
            Kind::Direction => reach,
            Kind::Rotary => radius / DEGREES,
        };
        let rotary = kinds.iter().map(|kind| matches!(kind, Kind::Rotary)).collect();
        let direction = kinds.iter().map(|kind| matches!(kind, Kind::Direction)).collect();
        Metric { scale: kinds.iter().map(scale).collect(), rotary, direction }
    }

    /// How many mm a component of a direction of length 1 counts; 0 where there is none.
    pub fn reach(&self) -> f64 {
        self.scale.iter().zip(&self.direction).find(|(_, is)| **is).map_or(0.0, |(scale, _)| *scale)
    }

    /// The distance of two positions.
    pub fn distance(&self, p: &Position, q: &Position) -> Bound {
        let (mut sum, mut rad) = (0.0, 0.0f64);
        for (i, scale) in self.scale.iter().enumerate() {
            let d = (p[i] - q[i]) * scale;
            sum += d * d;
            if self.rotary[i] {
                rad = rad.max((p[i] - q[i]).abs() / DEGREES);
            }
        }
        Bound { mm: f64::sqrt(sum), rad }
    }

    /// A piece with every coordinate in mm as it counts.
    pub fn scaled(&self, piece: &Bezier) -> Bezier {
        self.each(piece, |x, scale| x * scale)
    }

    /// The inverse of [`Metric::scaled`].
    pub fn unscaled(&self, piece: &Bezier) -> Bezier {
        self.each(piece, |x, scale| x / scale)
    }

    fn each(&self, piece: &Bezier, map: impl Fn(f64, f64) -> f64) -> Bezier {
        let mut piece = *piece;
        for point in &mut piece.points {
            for (x, scale) in point.iter_mut().zip(&self.scale) {
                // A linear axis stays as it is to the last bit.
                if *scale != 1.0 {
                    *x = map(*x, *scale);
                }
            }
        }
        piece
    }

    /// Which axes are rotary.
    pub fn rotary(&self) -> &[bool] {
        &self.rotary
    }

    fn scaled_difference(&self, p: &Position, q: &Position) -> Position {
        let mut d = [0.0; crate::units::MAX_AXES];
        for (i, scale) in self.scale.iter().enumerate() {
            d[i] = (p[i] - q[i]) * scale;
        }
        d
    }
}

/// The bound for a piece against the straight segment from `from` to `to`; φ is the projection onto the segment,
/// which rises because that of the control points does. By the convex hull no point of the piece is farther from
/// its projection than a control point from its own.
///
/// `reached` is how far along the segment the pieces before have come; each piece takes it on.
///
/// # Errors
/// The control points run back along the segment by more than `slack` mm, or are not finite.
pub fn segment_piece(
    metric: &Metric,
    (from, to): (&Position, &Position),
    piece: &Bezier,
    slack: f64,
    reached: &mut f64,
) -> Result<Bound, OrderError> {
    let along = metric.scaled_difference(to, from);
    let dot = |a: &Position, b: &Position| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let length = dot(&along, &along).sqrt();
    let mut bound = Bound::ZERO;
    for point in piece.control_points() {
        let d = metric.scaled_difference(point, from);
        let s = if length == 0.0 { 0.0 } else { dot(&d, &along) / length };
        if !s.is_finite() {
            return Err(OrderError::NotFinite);
        }
        if s < *reached - slack {
            return Err(OrderError::RunsBack);
        }
        // Running back within the slack costs what it runs back.
        let back = f64::max(*reached - s, 0.0);
        *reached = reached.max(s);
        let share = if length == 0.0 { 0.0 } else { (s / length).clamp(0.0, 1.0) };
        let foot: Position = std::array::from_fn(|i| from[i] + share * (to[i] - from[i]));
        let distance = metric.distance(point, &foot);
        bound = bound.max(Bound { mm: distance.mm + back, rad: distance.rad });
    }
    Ok(bound)
}

#[cfg(test)]
mod tests {
    use super::super::logcurve::tests::paper;
    use super::super::logcurve::{Cutter, LogCurve};
    use super::*;

    fn reached_nothing() -> f64 {
        f64::NEG_INFINITY
    }

    /// The greatest distance at 4001 values of t, straight from the definition.
    fn sampled(curve: &LogCurve, piece: &Bezier) -> f64 {
        (0..=4000).fold(0.0, |most, i| {
            let p = piece.eval(f64::from(i) / 4000.0);
            let c = curve.position(p[0]);
            let turn = curve.radius(p[0]) * (p[3] - c[3]) / DEGREES;
            let (dy, dz) = (p[1] - c[1], p[2] - c[2]);
            f64::max(most, (turn * turn + dy * dy + dz * dz).sqrt())
        })
    }

    #[test]
    fn bounds_are_above_samples_and_not_far_above() {
        for (c, index, weights) in
            [(5.0, 0.0, [1.0; 4]), (-5.0, 90.0, [1.0, 1.2, 0.9, 1.0]), (0.0, 7.0, [1.0; 4])]
        {
            let curve = LogCurve::new(Cutter { c, ..paper() }, index).unwrap();
            let at = |share: f64, a: f64| {
                let mut p = curve.position(30.0 * share);
                p[3] += a;
                p
            };
            let mut piece = Bezier::new(&[at(0.0, 0.0), at(0.33, 0.01), at(0.67, -0.2), at(1.0, 0.003)]);
            piece.weights[..4].copy_from_slice(&weights);
            let bound = log_piece(&curve, &piece, [0.0; 2]).unwrap();
            let seen = sampled(&curve, &piece);
            assert!(seen <= bound.mm && bound.mm <= 1.05 * seen + 1e-8, "{seen} {bound:?}");
        }
    }

    #[test]
    fn a_chord_of_the_curve_is_bounded_by_its_sagitta() {
        let curve = LogCurve::new(paper(), 0.0).unwrap();
        let (x0, x1) = (4.0, 5.0);
        let bound = log_chord(&curve, (x0, curve.angle(x0)), (x1, curve.angle(x1)));
        let piece = Bezier::line(curve.position(x0), curve.position(x1));
        let seen = sampled(&curve, &piece);
        assert!(seen <= bound.mm && bound.mm <= 1.1 * seen, "{seen} {bound:?}");
    }

    #[test]
    fn running_back_is_seen() {
        let curve = LogCurve::new(paper(), 0.0).unwrap();
        let piece = Bezier::new(&[
            curve.position(0.0),
            curve.position(30.0),
            curve.position(-5.0),
            curve.position(30.0),
        ]);
        // X′ ∝ 30, −35, 35 in Bernstein form: 30 − 130t + 135t² is −1.3 at t = 0.48.
        assert_eq!(log_piece(&curve, &piece, [0.0; 2]), Err(OrderError::RunsBack));
        let metric = Metric::new(&[Kind::Linear], 1.0);
        let line = Bezier::line(curve.position(30.0), curve.position(0.0));
        let ends = (&curve.position(0.0), &curve.position(30.0));
        assert_eq!(
            segment_piece(&metric, ends, &line, 1e-9, &mut reached_nothing()),
            Err(OrderError::RunsBack)
        );
    }

    #[test]
    fn pieces_that_creep_back_are_seen_together() {
        let metric = Metric::new(&[Kind::Linear], 1.0);
        let at = |x: f64| [x, 0.0, 0.0, 0.0, 0.0, 0.0];
        let (slack, mut reached) = (1.0e-3, f64::NEG_INFINITY);
        // Each piece goes back by half the slack: the first may, the third may not.
        let results: Vec<bool> = [(0.0, 5.0), (5.0, 4.9995), (4.9995, 4.999), (4.999, 4.9985)]
            .map(|(from, to)| {
                let piece = Bezier::line(at(from), at(to));
                segment_piece(&metric, (&at(0.0), &at(10.0)), &piece, slack, &mut reached).is_ok()
            })
            .to_vec();
        assert_eq!(results, [true, true, true, false]);
    }

    #[test]
    fn a_number_that_is_none_is_no_proof() {
        let curve = LogCurve::new(paper(), 0.0).unwrap();
        let mut piece = Bezier::line(curve.position(0.0), curve.position(30.0));
        piece.points[1][3] = f64::NAN;
        assert_eq!(log_piece(&curve, &piece, [0.0; 2]), Err(OrderError::NotFinite));
        let metric = Metric::new(&[Kind::Linear; 4], 1.0);
        let ends = (&curve.position(0.0), &curve.position(30.0));
        let result = segment_piece(&metric, ends, &piece, 1e-9, &mut reached_nothing());
        assert_eq!(result, Err(OrderError::NotFinite));
    }
}
