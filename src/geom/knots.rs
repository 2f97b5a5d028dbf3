//! Exact changes of a B-spline's knots and degree, all by its blossom.
//!
//! On one span a spline of degree p is a polynomial, and its blossom f(u₁ … u_p) is the one function that is symmetric,
//! affine in each argument and f(t … t) = P(t). Control points are values of it at consecutive knots,
//!
//! ```text
//! P_i = f(t_{i+1} … t_{i+p})
//! ```
//!
//! on any span between t_i and t_{i+p+1}. So the control points on other knots are blossom values at those, and the
//! control points of the same curve one degree higher are values of
//!
//! ```text
//! F(u_1 … u_{p+1}) = 1/(p+1) Σ_j f(u_1 … without u_j … u_{p+1})
//! ```
//!
//! (Ramshaw, *Blossoming: a connect-the-dots approach to splines*, 1987). Everything in homogeneous coordinates.

use super::bezier::MAX_PIECE_DEGREE;
use super::nurbs::{Homogeneous, Nurbs, NurbsError};
use crate::units::{MAX_AXES, Position};

/// Arguments of a blossom.
type Arguments = [f64; MAX_PIECE_DEGREE + 1];

/// Knots and homogeneous control points that need not be clamped.
struct Raw<'a> {
    degree: usize,
    knots: &'a [f64],
    points: &'a [Homogeneous],
}

impl Raw<'_> {
    /// f(u₁ … u_p) on the span that starts at knot `span`, by de Boor's scheme.
    fn blossom(&self, span: usize, u: &[f64]) -> Homogeneous {
        let p = self.degree;
        let mut d = [[0.0; MAX_AXES + 1]; MAX_PIECE_DEGREE + 1];
        d[..=p].copy_from_slice(&self.points[span - p..=span]);
        for r in 1..=p {
            for j in (r..=p).rev() {
                let (low, high) = (self.knots[span - p + j], self.knots[span + 1 + j - r]);
                let alpha = (u[r - 1] - low) / (high - low);
                for c in 0..=MAX_AXES {
                    d[j][c] = (1.0 - alpha) * d[j - 1][c] + alpha * d[j][c];
                }
            }
        }
        d[p]
    }

    /// A span of positive length between `from` and `to` that the curve is defined on.
    fn span_between(&self, from: f64, to: f64) -> usize {
        let (p, n) = (self.degree, self.points.len());
        let first = (p..n).find(|&s| self.knots[s] < self.knots[s + 1] && from <= self.knots[s]);
        let within = first.filter(|&s| self.knots[s + 1] <= to);
        // Callers ask between knots of the curve, where there is one.
        within.or(first).unwrap_or(n - 1)
    }

    /// f at consecutive knots of another knot vector between `from` and `to`: a control point where these are its own.
    fn control_point(&self, u: &[f64], (from, to): (f64, f64)) -> Homogeneous {
        let p = self.degree;
        let first = self.knots.partition_point(|t| *t < u[0]);
        let last = self.knots.partition_point(|t| *t <= u[0]);
        for i in first.max(1)..last {
            if i - 1 < self.points.len() && self.knots.get(i..i + p) == Some(u) {
                return self.points[i - 1];
            }
        }
        self.blossom(self.span_between(from, to), u)
    }
}

impl Nurbs {
    /// A spline of these knots, points and weights, which need not be clamped: it is the curve on t_p ≤ t ≤ t_{n+1}.
    ///
    /// Knots outside are replaced by repeated ends. An inner knot that stands p + 1 times is a break, which is taken
    /// where both of its control points are one place, and stands p times then.
    ///
    /// # Errors
    /// See [`NurbsError`].
    pub fn clamped(
        degree: usize,
        knots: Vec<f64>,
        points: Vec<Position>,
        weights: Vec<f64>,
    ) -> Result<Nurbs, NurbsError> {
        let (p, n) = (degree, points.len());
        if p == 0 || MAX_PIECE_DEGREE < p {
            return Err(NurbsError::Degree(p));
        }
        if n <= p || knots.len() != n + p + 1 || weights.len() != n {
            return Err(NurbsError::Counts { points: n, degree: p, knots: knots.len() });
        }
        let in_order =
            |i: usize| knots[i - 1] <= knots[i] && knots[i].is_finite() && knots[i - 1].is_finite();
        if let Some(i) = (1..knots.len()).find(|&i| !in_order(i)) {
            return Err(NurbsError::Decreases(i));
        }
        if let Some(i) = weights.iter().position(|w| !(0.0 < *w && w.is_finite())) {
            return Err(NurbsError::Weight(i));
        }
        let (from, to) = (knots[p], knots[n]);
        if !(from < to) {
            return Err(NurbsError::NotClamped(p + 1));
        }
        let (mut knots, mut points, mut weights) = (knots, points, weights);
        // Breaks: t_i … t_{i+p} equal and inside.
        let mut i = p + 1;
        while i < points.len() {
            if knots[i] == knots[i + p] && from < knots[i] && knots[i] < to {
                if knots[i] == knots[i + p + 1] {
                    return Err(NurbsError::TooOften(i));
                }
                if points[i - 1] != points[i] {
                    return Err(NurbsError::Breaks(i));
                }
                let scale = weights[i - 1] / weights[i];
                for w in &mut weights[i..] {
                    *w *= scale;
                }
                points.remove(i);
                weights.remove(i);
                knots.remove(i);
            }
            i += 1;
        }
        let n = points.len();
        if knots[0] == from && knots[n + p] == to {
            return Nurbs::new(p, knots, points, weights);
        }
        let homogeneous: Vec<Homogeneous> =
            points.iter().zip(&weights).map(|(point, w)| lift(point, *w)).collect();
        let raw = Raw { degree: p, knots: &knots, points: &homogeneous };
        let mut ends = vec![from; p + 1];
        ends.extend(knots.iter().copied().filter(|t| from < *t && *t < to));
        ends.extend(std::iter::repeat_n(to, p + 1));
        let polynomial = weights.iter().all(|w| *w == weights[0]).then_some(weights[0]);
        let count = ends.len() - p - 1;
        let lifted: Vec<Homogeneous> =
            (0..count).map(|i| raw.control_point(&ends[i + 1..=i + p], (ends[i], ends[i + p + 1]))).collect();
        from_homogeneous(p, ends, &lifted, polynomial)
    }

    /// The same curve one degree higher; each knot stands once more.
    ///
    /// # Errors
    /// The degree is [`MAX_PIECE_DEGREE`] already.
    pub fn elevated(&self) -> Result<Nurbs, NurbsError> {
        let p = self.degree();
        let mut knots = Vec::with_capacity(2 * self.knots().len());
        for (i, t) in self.knots().iter().enumerate() {
            if i == 0 || self.knots()[i - 1] < *t {
                knots.push(*t);
            }
            knots.push(*t);
        }
        if MAX_PIECE_DEGREE <= p {
            return Err(NurbsError::Degree(p + 1));
        }
        let homogeneous: Vec<Homogeneous> =
            self.points().iter().zip(self.weights()).map(|(point, w)| lift(point, *w)).collect();
        let raw = Raw { degree: p, knots: self.knots(), points: &homogeneous };
        let count = knots.len() - p - 2;
        let lifted: Vec<Homogeneous> = (0..count)
            .map(|i| {
                let span = raw.span_between(knots[i], knots[i + p + 2]);
                let mut sum = [0.0; MAX_AXES + 1];
                for without in 0..=p {
                    let mut u: Arguments = [0.0; MAX_PIECE_DEGREE + 1];
                    let others = (0..=p).filter(|j| *j != without);
                    for (u, j) in u.iter_mut().zip(others) {
                        *u = knots[i + 1 + j];
                    }
                    let value = raw.blossom(span, &u[..p]);
                    for c in 0..=MAX_AXES {
                        sum[c] += value[c];
                    }
                }
                sum.map(|x| x / (p + 1) as f64)
            })
            .collect();
        let polynomial = self.is_polynomial().then(|| self.weights()[0]);
        let mut raised = from_homogeneous(p + 1, knots, &lifted, polynomial)?;
        raised.keep_ends(self);
        Ok(raised)
    }
}

impl Nurbs {
    /// The same curve without one of its knots at `t`, and how far the curve moves at most, mm; none where `t` is no inner
    /// knot.
    ///
    /// The control points whose support holds `t` are blossom values of the span before it and of the span behind it.
    /// Where the curve is smooth enough they agree; of those whose knots stand on both sides of `t` the middle is taken,
    /// the others stay. How far the curve moves is told by its control points once the knot is put back.
    fn without_knot(&self, t: f64) -> Option<(Nurbs, f64)> {
        let p = self.degree();
        let (first, last) = (self.knots()[0], self.knots()[self.knots().len() - 1]);
        let at = self.knots().partition_point(|k| *k < t);
        let behind = self.knots().partition_point(|k| *k <= t);
        if !(first < t && t < last) || at == behind {
            return None;
        }
        let mut knots = self.knots().to_vec();
        knots.remove(at);
        // The points whose support holds t: those before keep their place, those behind move up.
        let (low, high) = (at - p - 1, behind - 1);
        let homogeneous: Vec<Homogeneous> = (low..=(high + 1).min(self.points().len() - 1))
            .map(|i| lift(&self.points()[i], self.weights()[i]))
            .collect();
        let window = &self.knots()[low..(high + p + 3).min(self.knots().len())];
        let raw = Raw { degree: p, knots: window, points: &homogeneous };
        let (span_before, span_behind) = (at - 1 - low, behind - 1 - low);
        let (mut points, mut weights) = (self.points().to_vec(), self.weights().to_vec());
        points.remove(at - 1);
        weights.remove(at - 1);
        for i in low..high.min(points.len()) {
            let u = &knots[i + 1..=i + p];
            if !(u[0] < t && t < u[p - 1]) {
                continue;
            }
            let (a, b) = (raw.blossom(span_before, u), raw.blossom(span_behind, u));
            if !self.is_polynomial() {
                weights[i] = 0.5 * (a[MAX_AXES] + b[MAX_AXES]);
            }
            let place = |axis: usize| 0.5 * (a[axis] / a[MAX_AXES] + b[axis] / b[MAX_AXES]);
            points[i] = std::array::from_fn(place);
        }
        let spline = Nurbs::new(p, knots, points, weights).ok()?;
        let again = spline.with_knot(t);
        let near = low.saturating_sub(1)..(high + 2).min(self.points().len());
        let mut moved = 0.0f64;
        for i in near.clone() {
            let (p, q) = (&again.points()[i], &self.points()[i]);
            moved = moved.max(p.iter().zip(q).map(|(x, y)| (x - y) * (x - y)).sum::<f64>().sqrt());
        }
        if !self.is_polynomial() {
            // A weight that is off by a share e moves the curve by at most 2e of the polygon's size.
            let off = |i: usize| (again.weights()[i] / self.weights()[i] - 1.0).abs();
            moved += 2.0
                * near.map(off).fold(0.0, f64::max)
                * size(&self.points()[low..=high.min(self.points().len() - 1)]);
        }
        Some((spline, moved))
    }

    /// The same curve without the knots that it can do without, moved by no more than `slack` mm for any.
    #[must_use]
    pub fn without_needless_knots(&self, slack: f64) -> Nurbs {
        let mut spline = self.clone();
        let mut inner: Vec<f64> = self.knots().to_vec();
        inner.dedup();
        for t in inner {
            while let Some((simpler, moved)) = spline.without_knot(t) {
                if !(moved <= slack) {
                    break;
                }
                spline = simpler;
            }
        }
        spline
    }
}

/// The size of a polygon, mm.
fn size(points: &[Position]) -> f64 {
    (0..MAX_AXES).fold(0.0, |most: f64, axis| {
        let range = points
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |r, p| (r.0.min(p[axis]), r.1.max(p[axis])));
        most.max(range.1 - range.0)
    })
}

/// (w P, w).
fn lift(point: &Position, w: f64) -> Homogeneous {
    let mut h = [w; MAX_AXES + 1];
    for axis in 0..MAX_AXES {
        h[axis] *= point[axis];
    }
    h
}

/// A spline from homogeneous points; `polynomial` is the weight that all share, so that rounding does not part them.
fn from_homogeneous(
    degree: usize,
    knots: Vec<f64>,
    lifted: &[Homogeneous],
    polynomial: Option<f64>,
) -> Result<Nurbs, NurbsError> {
    let points = lifted.iter().map(|h| std::array::from_fn(|axis| h[axis] / h[MAX_AXES])).collect();
    let weights = lifted.iter().map(|h| polynomial.unwrap_or(h[MAX_AXES])).collect();
    Nurbs::new(degree, knots, points, weights)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn at(x: f64, y: f64) -> Position {
        [x, y, 0.0, 0.0, 0.0, 0.0]
    }

    #[test]
    fn an_unclamped_curve_is_clamped_where_it_is_defined() {
        // A uniform quadratic on 2 ≤ t ≤ 4 over knots 0 … 6: at t = 2 it is the middle of P0 P1.
        let points = vec![at(0., 0.), at(2., 4.), at(6., 4.), at(8., 0.)];
        let clamped = Nurbs::clamped(2, (0..7).map(f64::from).collect(), points, vec![1.0; 4]).unwrap();
        assert_eq!(clamped.knots(), [2., 2., 2., 3., 4., 4., 4.]);
        assert_eq!(clamped.points()[0], at(1., 2.));
        assert_eq!(clamped.points()[3], at(7., 2.));
        // At the middle knot the uniform quadratic is the middle of P1 P2.
        assert_eq!(clamped.eval(3.0), at(4., 4.));
    }

    #[test]
    fn a_break_is_taken_where_its_points_are_one() {
        let knots = vec![0., 0., 1., 1., 2., 2.];
        let points = |x: f64| vec![at(0., 0.), at(1., 0.), at(x, 0.), at(1., 5.)];
        let joined = Nurbs::clamped(1, knots.clone(), points(1.0), vec![1., 1., 2., 2.]).unwrap();
        assert_eq!((joined.knots().len(), joined.weights()), (5, &[1., 1., 1.][..]));
        assert_eq!(Nurbs::clamped(1, knots, points(2.0), vec![1.0; 4]), Err(NurbsError::Breaks(2)));
    }

    #[test]
    fn knots_that_were_inserted_are_taken_out_again() {
        let points: Vec<Position> =
            [(0., 0.), (1., 5.), (4., -2.), (7., 3.), (9., 0.), (12., 4.)].map(|(x, y)| at(x, y)).to_vec();
        for (p, knots) in [
            (3, vec![0., 0., 0., 0., 1., 2.5, 4., 4., 4., 4.]),
            (2, vec![0., 0., 0., 1., 2., 3.5, 4., 4., 4.]),
            (3, vec![0., 0., 0., 0., 2., 2., 4., 4., 4., 4.]),
        ] {
            for weights in [vec![1.0; 6], vec![1., 2., 0.5, 1., 3., 1.]] {
                let curve = Nurbs::new(p, knots.clone(), points.clone(), weights).unwrap();
                let finer = [0.6, 0.6, 1.0, 2.2, 3.4].iter().fold(curve.clone(), |c, t| c.with_knot(*t));
                // Some ten roundings at 12·3, magnified by at most 14³, the ratio of spans at 3.4: 2e-10.
                let back = finer.without_needless_knots(1.0e-9);
                assert_eq!(back.knots(), curve.knots());
                for (a, b) in back.points().iter().zip(curve.points()) {
                    assert_relative_eq!(a[1], b[1], epsilon = 1e-9);
                }
            }
        }
    }

    #[test]
    fn elevation_leaves_the_curve_alone() {
        let points = vec![at(0., 0.), at(1., 5.), at(4., -2.), at(7., 3.), at(9., 0.)];
        let knots = vec![0., 0., 0., 1., 1.5, 4., 4., 4.];
        let curve = Nurbs::new(2, knots, points, vec![1., 2., 0.5, 1., 3.]).unwrap();
        let raised = curve.elevated().unwrap().elevated().unwrap();
        assert_eq!((raised.degree(), raised.knots().len()), (4, 5 + 3 + 3 + 5));
        for i in 0..=40 {
            let t = 0.1 * f64::from(i);
            for axis in 0..2 {
                // Some twenty roundings of numbers below 30.
                assert_relative_eq!(raised.eval(t)[axis], curve.eval(t)[axis], epsilon = 1e-13);
            }
        }
    }
}
