//! Curves in the form that is quickest to evaluate, millions of times a second.
//!
//! A Bezier piece is taken in powers of t, by Horner's scheme:
//!
//! ```text
//! c(t) = a₀ + t (a₁ + t (a₂ + …))          rational: each axis over the same sum for the weights
//! ```
//!
//! On 0 ≤ t ≤ 1 and up to degree 5 that loses a few bits at most, and the proof of a program does not rest on it.

use super::partition::Parametric;
use crate::geom::arc;
use crate::geom::bernstein::{Bernstein, binomial};
use crate::geom::bezier::{Bezier, MAX_PIECE_DEGREE};
use crate::geom::expr::curve::Formula;
use crate::geom::logcurve::LogCurve;
use crate::units::{DEGREES, MAX_AXES, Position};
use std::sync::Arc;

/// Coefficients aₖ of tᵏ for each axis.
type Powers = [Position; MAX_PIECE_DEGREE + 1];

/// A curve on one piece.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// From the first position by the second, 0 ≤ t ≤ 1.
    Line(Position, Position),
    /// A polynomial, 0 ≤ t ≤ 1.
    Polynomial(Box<Polynomial>),
    /// A rational piece, 0 ≤ t ≤ 1.
    Rational(Box<Rational>),
    /// An arc or a helix, 0 ≤ t ≤ 1.
    Arc(Box<arc::Arc>),
    /// A cutter's flute, by X, from its start to its end or back.
    Logarithmic(Box<LogCurve>, Way),
    /// Coordinates as expressions in u.
    Formula(Arc<Formula>),
}

/// Which way a flute is run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// u is X.
    Forth,
    /// u grows while X falls from the end to the start: X = start + end − u.
    Back,
}

impl Way {
    /// X at u.
    fn x(self, curve: &LogCurve, u: f64) -> f64 {
        match self {
            Way::Forth => u,
            Way::Back => curve.start() + curve.end() - u,
        }
    }
}

/// A polynomial in powers of t.
#[derive(Clone, Debug, PartialEq)]
pub struct Polynomial {
    degree: usize,
    a: Powers,
}

/// A rational piece: numerators and the denominator in powers of t.
#[derive(Clone, Debug, PartialEq)]
pub struct Rational {
    above: Polynomial,
    below: [f64; MAX_PIECE_DEGREE + 1],
}

/// aₖ = C(m,k) Σ(i=0..k) (−1)^(k−i) C(k,i) cᵢ, from Bernstein coefficients.
fn powers(f: &Bernstein) -> [f64; MAX_PIECE_DEGREE + 1] {
    let c = f.coefficients();
    let m = c.len() - 1;
    let mut a = [0.0; MAX_PIECE_DEGREE + 1];
    for k in 0..=m {
        let mut sum = 0.0;
        for i in 0..=k {
            let sign = if (k - i) % 2 == 0 { 1.0 } else { -1.0 };
            sum += sign * binomial(k, i) * c[i];
        }
        a[k] = binomial(m, k) * sum;
    }
    a
}

impl Polynomial {
    fn new(piece: &Bezier) -> Polynomial {
        let mut a = [[0.0; MAX_AXES]; MAX_PIECE_DEGREE + 1];
        for axis in 0..MAX_AXES {
            for (k, value) in powers(&piece.numerator(axis)).into_iter().enumerate() {
                a[k][axis] = value;
            }
        }
        Polynomial { degree: piece.degree, a }
    }

    #[inline]
    fn at(&self, t: f64) -> Position {
        let mut sum = self.a[self.degree];
        for k in (0..self.degree).rev() {
            for i in 0..MAX_AXES {
                sum[i] = sum[i] * t + self.a[k][i];
            }
        }
        sum
    }

    fn jet(&self, t: f64) -> [Position; 3] {
        let [mut c, mut rate, mut second] = [[0.0; MAX_AXES]; 3];
        for k in (0..=self.degree).rev() {
            for i in 0..MAX_AXES {
                second[i] = second[i] * t + 2.0 * rate[i];
                rate[i] = rate[i] * t + c[i];
                c[i] = c[i] * t + self.a[k][i];
            }
        }
        [c, rate, second]
    }
}

impl Rational {
    /// w, w′, w″.
    fn weight(&self, t: f64) -> [f64; 3] {
        let [mut w, mut rate, mut second] = [0.0; 3];
        for k in (0..=self.above.degree).rev() {
            second = second * t + 2.0 * rate;
            rate = rate * t + w;
            w = w * t + self.below[k];
        }
        [w, rate, second]
    }
}

impl Shape {
    /// The piece by its control points again; none of what is no such piece.
    pub fn piece(&self) -> Option<Bezier> {
        let (above, below) = match self {
            Shape::Polynomial(polynomial) => (&**polynomial, None),
            Shape::Rational(rational) => (&rational.above, Some(&rational.below)),
            Shape::Line(..) | Shape::Arc(_) | Shape::Logarithmic(..) | Shape::Formula(_) => return None,
        };
        let m = above.degree;
        let mut piece = Bezier::new(&[[0.0; MAX_AXES]; MAX_PIECE_DEGREE + 1][..=m]);
        if let Some(below) = below {
            piece.weights = Bezier::ordinates(&below[..=m], 1.0);
        }
        for axis in 0..MAX_AXES {
            let a: [f64; MAX_PIECE_DEGREE + 1] = std::array::from_fn(|k| above.a[k][axis]);
            let ordinates = Bezier::ordinates(&a[..=m], 1.0);
            for i in 0..=m {
                piece.points[i][axis] = ordinates[i] / piece.weights[i];
            }
        }
        Some(piece)
    }

    /// The straight line between two positions.
    pub fn line(from: Position, to: Position) -> Shape {
        Shape::Line(from, super::partition::difference(&to, &from))
    }

    /// A Bezier piece.
    pub fn bezier(piece: &Bezier) -> Shape {
        let above = Polynomial::new(piece);
        if piece.degree == 1 && piece.is_polynomial() {
            return Shape::line(piece.start(), piece.end());
        }
        if piece.is_polynomial() {
            let w = piece.weights[0];
            let mut polynomial = above;
            polynomial.a.iter_mut().flatten().for_each(|a| *a /= w);
            return Shape::Polynomial(Box::new(polynomial));
        }
        Shape::Rational(Box::new(Rational { above, below: powers(&piece.denominator()) }))
    }

    /// Whether it is a straight line.
    pub fn is_line(&self) -> bool {
        matches!(self, Shape::Line(..))
    }

    /// The range of its parameter.
    pub fn range(&self) -> (f64, f64) {
        match self {
            Shape::Line(..) | Shape::Polynomial(_) | Shape::Rational(_) | Shape::Arc(_) => (0.0, 1.0),
            Shape::Logarithmic(curve, _) => (curve.start(), curve.end()),
            Shape::Formula(formula) => formula.range(),
        }
    }
}

impl Parametric for Shape {
    #[inline]
    fn at(&self, u: f64) -> Position {
        match self {
            Shape::Line(from, by) => std::array::from_fn(|i| from[i] + u * by[i]),
            Shape::Polynomial(polynomial) => polynomial.at(u),
            Shape::Rational(rational) => {
                let w = rational.weight(u)[0];
                rational.above.at(u).map(|x| x / w)
            }
            Shape::Arc(arc) => arc.eval(u),
            Shape::Logarithmic(curve, way) => curve.position(way.x(curve, u)),
            Shape::Formula(formula) => formula.at(u),
        }
    }

    fn jet(&self, u: f64) -> [Position; 3] {
        match self {
            Shape::Line(_, by) => [self.at(u), *by, [0.0; MAX_AXES]],
            Shape::Polynomial(polynomial) => polynomial.jet(u),
            Shape::Rational(rational) => {
                // (N/w)′ = (N′ − w′c)/w          (N/w)″ = (N″ − 2w′c′ − w″c)/w
                let [w, w1, w2] = rational.weight(u);
                let [n, n1, n2] = rational.above.jet(u);
                let c = n.map(|x| x / w);
                let rate: Position = std::array::from_fn(|i| (n1[i] - w1 * c[i]) / w);
                let second = std::array::from_fn(|i| (n2[i] - 2.0 * w1 * rate[i] - w2 * c[i]) / w);
                [c, rate, second]
            }
            Shape::Arc(arc) => arc.jet(u),
            Shape::Logarithmic(curve, way) => {
                // A′ = k/q          A″ = −kβ/q²
                let x = way.x(curve, u);
                let slope = curve.slope(x);
                let bend = -slope * curve.beta() / (1.0 + curve.beta() * x);
                let forth = [1.0, curve.y_slope(), curve.z_slope(), slope * DEGREES, 0.0, 0.0];
                let rate = match way {
                    Way::Forth => forth,
                    Way::Back => forth.map(|x| -x),
                };
                [curve.position(x), rate, [0.0, 0.0, 0.0, bend * DEGREES, 0.0, 0.0]]
            }
            Shape::Formula(formula) => {
                // The third coefficient of a series is c″/2.
                let [c, rate, half] = formula.jet::<3>(u);
                [c, rate, half.map(|x| 2.0 * x)]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::logcurve::{Cutter, Hand, Law};
    use approx::assert_relative_eq;

    fn shapes() -> Vec<(Shape, Option<Bezier>)> {
        let at = |x: f64, y: f64| [x, y, 0.5 * x, 0.0, 0.0, 0.0];
        let quintic =
            Bezier::new(&[at(0., 0.), at(5., 9.), at(9., -4.), at(11., 3.), at(15., 0.), at(20., 7.)]);
        let mut rational = Bezier::new(&[at(0., 0.), at(5., 9.), at(9., -4.), at(11., 3.)]);
        rational.weights[..4].copy_from_slice(&[1.0, 0.3, 2.5, 0.8]);
        let line = Bezier::line(at(1., 2.), at(4., -2.));
        let cutter = Cutter {
            d1: 10.0,
            s: 30.0,
            c: 5.0,
            r: 8.0,
            length: 30.0,
            hand: Hand::Right,
            law: Law::ConstantHelix,
        };
        let mut all: Vec<(Shape, Option<Bezier>)> =
            [quintic, rational, line].into_iter().map(|piece| (Shape::bezier(&piece), Some(piece))).collect();
        let flute = LogCurve::new(cutter, 0.0).unwrap();
        for way in [Way::Forth, Way::Back] {
            all.push((Shape::Logarithmic(Box::new(flute), way), None));
        }
        let end = [-3.0, 8.0, 5.0, 0.0, 0.0, 0.0];
        let sense = arc::Sense::CounterClockwise;
        let helix = arc::Arc::new(arc::Plane::Xy, sense, at(5., 0.), end, [0.0, 0.0]).unwrap();
        all.push((Shape::Arc(Box::new(helix)), None));
        all
    }

    #[test]
    fn pieces_are_where_their_bezier_form_is() {
        for (shape, piece) in shapes() {
            let Some(piece) = piece else { continue };
            for i in 0..=16 {
                let t = f64::from(i) / 16.0;
                for axis in 0..3 {
                    // Some ten roundings of sums of binomials below 10·20.
                    assert_relative_eq!(shape.at(t)[axis], piece.eval(t)[axis], epsilon = 1e-12);
                }
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_the_values() {
        for (shape, _) in shapes() {
            let (from, to) = shape.range();
            let h = 1e-4 * (to - from);
            for i in 1..16 {
                let u = from + (to - from) * f64::from(i) / 16.0;
                let [c, rate, second] = shape.jet(u);
                let (before, after) = (shape.at(u - h), shape.at(u + h));
                for axis in 0..4 {
                    assert_eq!(c[axis], shape.jet(u)[0][axis]);
                    // Central differences are right to h² times the next derivatives, below 1e5 on t and rounding/h².
                    let width = to - from;
                    let (first, bend) = (
                        (after[axis] - before[axis]) / (2.0 * h),
                        (after[axis] - 2.0 * c[axis] + before[axis]) / (h * h),
                    );
                    assert_relative_eq!(rate[axis] * width, first * width, epsilon = 1e-3);
                    assert_relative_eq!(second[axis] * width * width, bend * width * width, epsilon = 1e-2);
                }
            }
        }
    }
}
