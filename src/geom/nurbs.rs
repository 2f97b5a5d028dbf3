//! B-splines: knots that are in order by construction, exact insertion, pieces to spline and back.
//!
//! A spline of degree p with control points P_0 … P_n has knots t_0 … t_{n+p+1}, never falling, the first and the last
//! p + 1 equal (clamped), inner ones at most p-fold, so that the curve holds together:
//!
//! ```text
//! P(t) = Σ N_{i,p}(t) w_i P_i / Σ N_{i,p}(t) w_i          t_p ≤ t ≤ t_{n+1}
//! ```
//!
//! Everything is computed in homogeneous coordinates (w_i P_i, w_i).

use super::bezier::{Bezier, MAX_PIECE_DEGREE};
use crate::units::{MAX_AXES, Position};

/// What is wrong with a spline.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NurbsError {
    /// Degree 0, or above [`MAX_PIECE_DEGREE`].
    #[error("degree {0} is not between 1 and 5")]
    Degree(usize),
    /// Not as many knots as points + degree + 1, or fewer points than degree + 1.
    #[error("{points} control points of degree {degree} need {} knots, not {knots}", points + degree + 1)]
    Counts {
        /// How many control points.
        points: usize,
        /// Of which degree.
        degree: usize,
        /// How many knots.
        knots: usize,
    },
    /// A knot is less than the one before, or not finite.
    #[error("knot {0} is less than the one before it")]
    Decreases(usize),
    /// The first or the last degree + 1 knots are not equal.
    #[error("the first and the last {0} knots must be equal")]
    NotClamped(usize),
    /// An inner knot stands more than degree times: the curve would fall apart there.
    #[error("knot {0} is repeated more often than the degree")]
    TooOften(usize),
    /// An inner knot stands degree + 1 times, and the control points there are two places.
    #[error("the curve breaks at knot {0}")]
    Breaks(usize),
    /// A weight is not positive.
    #[error("weight {0} is not greater than zero")]
    Weight(usize),
}

/// A clamped B-spline.
#[derive(Clone, Debug, PartialEq)]
pub struct Nurbs {
    degree: usize,
    knots: Vec<f64>,
    points: Vec<Position>,
    weights: Vec<f64>,
}

/// (w P, w).
pub(super) type Homogeneous = [f64; MAX_AXES + 1];

impl Nurbs {
    /// A spline of these knots, points and weights (one a point; all 1 for a polynomial spline).
    ///
    /// # Errors
    /// See [`NurbsError`].
    pub fn new(
        degree: usize,
        knots: Vec<f64>,
        points: Vec<Position>,
        weights: Vec<f64>,
    ) -> Result<Nurbs, NurbsError> {
        let n = points.len();
        if degree == 0 || MAX_PIECE_DEGREE < degree {
            return Err(NurbsError::Degree(degree));
        }
        if n <= degree || knots.len() != n + degree + 1 || weights.len() != n {
            return Err(NurbsError::Counts { points: n, degree, knots: knots.len() });
        }
        if let Some(i) = (1..knots.len()).find(|&i| !(knots[i - 1] <= knots[i] && knots[i].is_finite())) {
            return Err(NurbsError::Decreases(i));
        }
        if knots[0] != knots[degree] || knots[n] != knots[n + degree] {
            return Err(NurbsError::NotClamped(degree + 1));
        }
        if let Some(i) = (1..n).find(|&i| knots[i] == knots[i + degree]) {
            return Err(NurbsError::TooOften(i));
        }
        if let Some(i) = weights.iter().position(|w| !(0.0 < *w && w.is_finite())) {
            return Err(NurbsError::Weight(i));
        }
        Ok(Nurbs { degree, knots, points, weights })
    }

    /// p.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// t_0 … t_{n+p+1}.
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// P_0 … P_n.
    pub fn points(&self) -> &[Position] {
        &self.points
    }

    /// w_0 … w_n.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// The spline of other points on the same knots and weights: each point mapped by an affine map, and so the curve.
    #[must_use]
    pub fn mapped(&self, map: impl Fn(&Position) -> Position) -> Nurbs {
        Nurbs { points: self.points.iter().map(map).collect(), ..self.clone() }
    }

    /// Takes over the ends of the curve that this one is another form of, to the last bit.
    pub(super) fn keep_ends(&mut self, of: &Nurbs) {
        let last = self.points.len() - 1;
        self.points[0] = of.points[0];
        self.points[last] = of.points[of.points.len() - 1];
    }

    /// Whether all weights are equal.
    pub fn is_polynomial(&self) -> bool {
        self.weights.iter().all(|w| *w == self.weights[0])
    }

    fn homogeneous(&self, i: usize) -> Homogeneous {
        let mut h = [self.weights[i]; MAX_AXES + 1];
        for axis in 0..MAX_AXES {
            h[axis] *= self.points[i][axis];
        }
        h
    }

    /// The control points of the piece on t_span ≤ t ≤ t_{span+1} between `from` and `to`: the blossom with i
    /// arguments `to` and p − i arguments `from`, by de Boor's scheme.
    fn blossom(&self, span: usize, from: f64, to: f64, i: usize) -> Homogeneous {
        let p = self.degree;
        let mut d = [[0.0; MAX_AXES + 1]; MAX_PIECE_DEGREE + 1];
        for (j, d) in d.iter_mut().enumerate().take(p + 1) {
            *d = self.homogeneous(span - p + j);
        }
        for r in 1..=p {
            let u = if r <= i { to } else { from };
            for j in (r..=p).rev() {
                let (low, high) = (self.knots[span - p + j], self.knots[span + 1 + j - r]);
                let alpha = (u - low) / (high - low);
                for c in 0..=MAX_AXES {
                    d[j][c] = (1.0 - alpha) * d[j - 1][c] + alpha * d[j][c];
                }
            }
        }
        d[p]
    }

    /// Bezier pieces, one a span of positive length, with the spans' lengths.
    pub fn beziers(&self) -> impl Iterator<Item = (Bezier, f64)> + '_ {
        let p = self.degree;
        (p..self.points.len()).filter(|&span| self.knots[span] < self.knots[span + 1]).map(move |span| {
            let (from, to) = (self.knots[span], self.knots[span + 1]);
            let mut piece = Bezier::new(&vec![[0.0; MAX_AXES]; p + 1]);
            for i in 0..=p {
                let h = self.blossom(span, from, to, i);
                piece.weights[i] = h[MAX_AXES];
                for axis in 0..MAX_AXES {
                    piece.points[i][axis] = h[axis] / h[MAX_AXES];
                }
            }
            if self.is_polynomial() {
                // The sums of one weight differ in the last bit; it cancels, so it is taken out.
                piece.weights = [1.0; MAX_PIECE_DEGREE + 1];
            }
            (piece, to - from)
        })
    }

    /// The same curve with one more knot at `t`, strictly inside the range and not yet p-fold (Boehm's algorithm):
    ///
    /// ```text
    /// Q_i = α_i P_i + (1 − α_i) P_{i−1}          α_i = (t − t_i)/(t_{i+p} − t_i), within 0 … 1
    /// ```
    #[must_use]
    pub fn with_knot(&self, t: f64) -> Nurbs {
        let p = self.degree;
        // The last span that starts at or before t.
        let span = self.knots.partition_point(|k| *k <= t) - 1;
        let mut knots = self.knots.clone();
        knots.insert(span + 1, t);
        let (mut points, mut weights) = (Vec::new(), Vec::new());
        for i in 0..=self.points.len() {
            let alpha = if i + p <= span {
                1.0
            } else if span < i {
                0.0
            } else {
                (t - self.knots[i]) / (self.knots[i + p] - self.knots[i])
            };
            if alpha == 1.0 || alpha == 0.0 {
                let kept = if alpha == 1.0 { i } else { i - 1 };
                points.push(self.points[kept]);
                weights.push(self.weights[kept]);
                continue;
            }
            let (before, after) = (self.homogeneous(i - 1), self.homogeneous(i));
            let mixed: Homogeneous = std::array::from_fn(|c| (1.0 - alpha) * before[c] + alpha * after[c]);
            weights.push(mixed[MAX_AXES]);
            points.push(std::array::from_fn(|axis| mixed[axis] / mixed[MAX_AXES]));
        }
        if self.is_polynomial() {
            weights.fill(self.weights[0]);
        }
        Nurbs { degree: p, knots, points, weights }
    }

    /// P(t).
    pub fn eval(&self, t: f64) -> Position {
        let n = self.points.len();
        let t = t.clamp(self.knots[self.degree], self.knots[n]);
        // At the end the last span of positive length counts; inside, the span to the right.
        let span = if t < self.knots[n] {
            self.knots.partition_point(|k| *k <= t) - 1
        } else {
            self.knots.partition_point(|k| *k < t) - 1
        };
        let h = self.blossom(span, t, t, 0);
        std::array::from_fn(|axis| h[axis] / h[MAX_AXES])
    }

    /// One spline through polynomial pieces of one degree that meet end to start, piece i on a span of `lengths[i]`.
    ///
    /// Where `smooth[i]` says that pieces i and i + 1 also share their derivative on those spans, the joint gets a
    /// (p−1)-fold knot and its point drops out; elsewhere a p-fold one.
    ///
    /// # Errors
    /// Degrees differ, a length is not positive, or there is no piece.
    pub fn joined(pieces: &[Bezier], lengths: &[f64], smooth: &[bool]) -> Result<Nurbs, NurbsError> {
        let degree = pieces.first().map_or(0, |piece| piece.degree);
        if pieces.iter().any(|piece| piece.degree != degree) {
            return Err(NurbsError::Degree(degree));
        }
        let (mut knots, mut points, mut weights) = (vec![0.0; degree + 1], Vec::new(), Vec::new());
        let mut t = 0.0;
        for (i, piece) in pieces.iter().enumerate() {
            let last = i + 1 == pieces.len();
            t += lengths[i];
            let drop = !last && smooth[i] && 1 < degree;
            let first = usize::from(i != 0);
            let end = if drop { degree } else { degree + 1 };
            points.extend_from_slice(&piece.points[first..end]);
            weights.extend_from_slice(&piece.weights[first..end]);
            let multiplicity = if last { degree + 1 } else { degree - usize::from(drop) };
            knots.extend(std::iter::repeat_n(t, multiplicity));
        }
        Nurbs::new(degree, knots, points, weights)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn at(x: f64, y: f64) -> Position {
        [x, y, 0.0, 0.0, 0.0, 0.0]
    }

    /// The reference curve: x(t) = t.
    fn reference() -> Nurbs {
        let points = [(0., 0.), (10., 0.), (30., 24.), (60., 0.), (90., -24.), (110., 0.), (120., 0.)];
        let knots = vec![0., 0., 0., 0., 30., 60., 90., 120., 120., 120., 120.];
        Nurbs::new(3, knots, points.iter().map(|p| at(p.0, p.1)).collect(), vec![1.0; 7]).unwrap()
    }

    #[test]
    fn the_reference_curve_has_its_published_values() {
        let y = [0.0, 6.25, 14.0, 10.75, 0.0, -10.75, -14.0, -6.25, 0.0];
        for (i, y) in y.iter().enumerate() {
            let p = reference().eval(15.0 * i as f64);
            assert_relative_eq!(p[0], 15.0 * i as f64, epsilon = 1e-13);
            assert_relative_eq!(p[1], *y, epsilon = 1e-13);
        }
    }

    #[test]
    fn pieces_join_back_to_the_same_curve() {
        let (pieces, lengths): (Vec<_>, Vec<_>) = reference().beziers().unzip();
        assert_eq!(pieces.len(), 4);
        let back = Nurbs::joined(&pieces, &lengths, &[true; 3]).unwrap();
        assert_eq!(back.points().len(), 4 + 2 * 3);
        for i in 0..=24 {
            let t = 5.0 * f64::from(i);
            assert_relative_eq!(back.eval(t)[1], reference().eval(t)[1], epsilon = 1e-13);
        }
    }

    #[test]
    fn each_error_can_be_provoked() {
        let make = |knots: &[f64], weights: &[f64]| {
            let points = vec![at(0., 0.), at(1., 1.), at(2., 0.), at(3., 1.)];
            Nurbs::new(2, knots.to_vec(), points, weights.to_vec()).unwrap_err()
        };
        assert!(matches!(make(&[0., 0., 0., 1.], &[1.; 4]), NurbsError::Counts { .. }));
        assert_eq!(make(&[0., 0., 0., 2., 1., 1., 1.], &[1.; 4]), NurbsError::Decreases(4));
        assert_eq!(make(&[0., 0., 0., 0.5, 1., 1., 2.], &[1.; 4]), NurbsError::NotClamped(3));
        assert_eq!(make(&[0., 0., 0., 0., 1., 1., 1.], &[1.; 4]), NurbsError::TooOften(1));
        assert_eq!(make(&[0., 0., 0., 0.5, 1., 1., 1.], &[1., 0., 1., 1.]), NurbsError::Weight(1));
        assert_eq!(Nurbs::new(6, vec![], vec![], vec![]).unwrap_err(), NurbsError::Degree(6));
    }
}
