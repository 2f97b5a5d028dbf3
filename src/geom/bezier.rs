//! One piece of a curve: a Bezier curve of degree 1 to 5 in Rⁿ, rational where its weights differ.
//!
//! ```text
//! P(t) = Σ C(m,i) tⁱ (1−t)ᵐ⁻ⁱ w_i P_i / Σ C(m,i) tⁱ (1−t)ᵐ⁻ⁱ w_i          0 ≤ t ≤ 1
//! ```

use super::bernstein::{Bernstein, binomial};
use crate::units::{MAX_AXES, Position};

/// The greatest degree of a piece: Sinumerik's quintic POLY.
pub const MAX_PIECE_DEGREE: usize = 5;

/// A Bezier curve. Points and weights beyond the degree are not looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bezier {
    /// m, from 1 to [`MAX_PIECE_DEGREE`].
    pub degree: usize,
    /// P_0 … P_m.
    pub points: [Position; MAX_PIECE_DEGREE + 1],
    /// w_0 … w_m, all positive; all 1 for a polynomial piece.
    pub weights: [f64; MAX_PIECE_DEGREE + 1],
}

impl Bezier {
    /// A polynomial piece with these control points, two to six of them.
    pub fn new(points: &[Position]) -> Bezier {
        let mut piece = Bezier {
            degree: points.len() - 1,
            points: [[0.0; MAX_AXES]; MAX_PIECE_DEGREE + 1],
            weights: [1.0; MAX_PIECE_DEGREE + 1],
        };
        piece.points[..points.len()].copy_from_slice(points);
        piece
    }

    /// The straight piece from `from` to `to`.
    pub fn line(from: Position, to: Position) -> Bezier {
        Bezier::new(&[from, to])
    }

    /// The piece with every control point mapped, its weights as they are: the same piece in other coordinates, where the map is
    /// affine.
    #[must_use]
    pub fn mapped(mut self, map: impl Fn(&Position) -> Position) -> Bezier {
        self.points.iter_mut().for_each(|point| *point = map(point));
        self
    }

    /// P_0.
    pub fn start(&self) -> Position {
        self.points[0]
    }

    /// P_m.
    pub fn end(&self) -> Position {
        self.points[self.degree]
    }

    /// P_0 … P_m.
    pub fn control_points(&self) -> &[Position] {
        &self.points[..=self.degree]
    }

    /// The same piece from its end to its start.
    #[must_use]
    pub fn reversed(&self) -> Bezier {
        let mut piece = *self;
        piece.points[..=self.degree].reverse();
        piece.weights[..=self.degree].reverse();
        piece
    }

    /// Whether all weights are equal, so that the denominator can be left out.
    pub fn is_polynomial(&self) -> bool {
        self.weights[..=self.degree].iter().all(|w| *w == self.weights[0])
    }

    /// The numerator of one coordinate: Bernstein coefficients w_i P_i.
    pub fn numerator(&self, axis: usize) -> Bernstein {
        let mut c = [0.0; MAX_PIECE_DEGREE + 1];
        for (i, c) in c.iter_mut().enumerate() {
            *c = self.weights[i] * self.points[i][axis];
        }
        Bernstein::new(&c[..=self.degree])
    }

    /// The denominator: Bernstein coefficients w_i.
    pub fn denominator(&self) -> Bernstein {
        Bernstein::new(&self.weights[..=self.degree])
    }

    /// P(t).
    pub fn eval(&self, t: f64) -> Position {
        let w = self.denominator().eval(t);
        std::array::from_fn(|axis| self.numerator(axis).eval(t) / w)
    }

    /// P(t), P′(t) and P″(t):
    ///
    /// ```text
    /// P′ = (N′ − w′P)/w          P″ = (N″ − 2w′P′ − w″P)/w
    /// ```
    pub fn derivatives(&self, t: f64) -> [Position; 3] {
        let m = self.degree;
        let polynomial = self.is_polynomial();
        let jet = |c: &mut [f64; MAX_PIECE_DEGREE + 1]| -> [f64; 3] {
            // De Casteljau's scheme down to the last three points, which hold both derivatives.
            for k in 1..m.max(2) - 1 {
                for i in 0..=m - k {
                    c[i] = (1.0 - t) * c[i] + t * c[i + 1];
                }
            }
            if m == 1 {
                return [(1.0 - t) * c[0] + t * c[1], c[1] - c[0], 0.0];
            }
            let (a, b) = ((1.0 - t) * c[0] + t * c[1], (1.0 - t) * c[1] + t * c[2]);
            let second = (m * (m - 1)) as f64 * (c[0] - 2.0 * c[1] + c[2]);
            [(1.0 - t) * a + t * b, m as f64 * (b - a), second]
        };
        let [w, w1, w2] = if polynomial { [1.0, 0.0, 0.0] } else { jet(&mut self.weights.clone()) };
        let mut result = [[0.0; MAX_AXES]; 3];
        for axis in 0..MAX_AXES {
            let mut c = [0.0; MAX_PIECE_DEGREE + 1];
            let mut zero = true;
            for i in 0..=m {
                c[i] = if polynomial { self.points[i][axis] } else { self.weights[i] * self.points[i][axis] };
                zero &= c[i] == 0.0;
            }
            if zero {
                continue;
            }
            let [n, n1, n2] = jet(&mut c);
            let p = n / w;
            let p1 = (n1 - w1 * p) / w;
            result[0][axis] = p;
            result[1][axis] = p1;
            result[2][axis] = (n2 - 2.0 * w1 * p1 - w2 * p) / w;
        }
        result
    }

    /// The part between `from` and `to` on 0 ≤ t ≤ 1 again.
    #[must_use]
    pub fn segment(&self, from: f64, to: f64) -> Bezier {
        let head = if to == 1.0 { *self } else { self.cut(to, false) };
        if from == 0.0 {
            return head;
        }
        if to == 0.0 { head } else { head.cut((from / to).min(1.0), true) }
    }

    /// The part before t, or the one behind it, by de Casteljau's scheme in homogeneous coordinates.
    fn cut(&self, t: f64, behind: bool) -> Bezier {
        let m = self.degree;
        let mut h = [[0.0; MAX_AXES + 1]; MAX_PIECE_DEGREE + 1];
        for i in 0..=m {
            for axis in 0..MAX_AXES {
                h[i][axis] = self.weights[i] * self.points[i][axis];
            }
            h[i][MAX_AXES] = self.weights[i];
        }
        let mut kept = h;
        for k in 1..=m {
            for i in 0..=m - k {
                for c in 0..=MAX_AXES {
                    h[i][c] = (1.0 - t) * h[i][c] + t * h[i + 1][c];
                }
            }
            if behind {
                kept[m - k] = h[m - k];
            } else {
                kept[k] = h[0];
            }
        }
        let polynomial = self.is_polynomial();
        let mut part = *self;
        for i in 0..=m {
            part.weights[i] = if polynomial { self.weights[0] } else { kept[i][MAX_AXES] };
            for axis in 0..MAX_AXES {
                part.points[i][axis] = kept[i][axis] / part.weights[i];
            }
        }
        // Ends that stay are kept to the last bit.
        if behind {
            part.points[m] = self.points[m];
        } else {
            part.points[0] = self.points[0];
        }
        part
    }

    /// The same curve with one more control point.
    ///
    /// ```text
    /// Q_i = (i/(m+1)) P_{i−1} + (1 − i/(m+1)) P_i          in homogeneous coordinates
    /// ```
    #[must_use]
    pub fn elevated(&self) -> Bezier {
        let weights = self.denominator().elevated();
        let mut piece = Bezier { degree: self.degree + 1, ..*self };
        for (i, w) in weights.coefficients().iter().enumerate() {
            piece.weights[i] = *w;
        }
        for axis in 0..MAX_AXES {
            for (i, c) in self.numerator(axis).elevated().coefficients().iter().enumerate() {
                piece.points[i][axis] = c / piece.weights[i];
            }
        }
        piece
    }

    /// The same curve with degree `degree`, which must not be below its own.
    #[must_use]
    pub fn raised_to(&self, degree: usize) -> Bezier {
        let mut piece = *self;
        while piece.degree < degree {
            piece = piece.elevated();
        }
        piece
    }

    /// Coefficients a_0 … a_m of one coordinate of a polynomial piece in powers of p = t L, 0 ≤ p ≤ L:
    ///
    /// ```text
    /// a_k = C(m,k)/Lᵏ · Σ(i=0..k) (−1)^(k−i) C(k,i) P_i
    /// ```
    pub fn power_basis(&self, axis: usize, length: f64) -> [f64; MAX_PIECE_DEGREE + 1] {
        let mut a = [0.0; MAX_PIECE_DEGREE + 1];
        let mut scale = 1.0;
        for (k, a) in a.iter_mut().enumerate().take(self.degree + 1) {
            let mut sum = 0.0;
            for i in 0..=k {
                let sign = if (k - i) % 2 == 0 { 1.0 } else { -1.0 };
                sum += sign * binomial(k, i) * self.points[i][axis];
            }
            *a = binomial(self.degree, k) * sum * scale;
            scale /= length;
        }
        a
    }

    /// The Bezier ordinates of a_0 + a_1 p + … on 0 ≤ p ≤ L, the inverse of [`Bezier::power_basis`]:
    ///
    /// ```text
    /// P_i = Σ(k=0..i) C(i,k)/C(m,k) a_k Lᵏ
    /// ```
    pub fn ordinates(a: &[f64], length: f64) -> [f64; MAX_PIECE_DEGREE + 1] {
        let m = a.len() - 1;
        let mut b = [0.0; MAX_PIECE_DEGREE + 1];
        for (i, b) in b.iter_mut().enumerate().take(m + 1) {
            let mut power = 1.0;
            for (k, a) in a.iter().enumerate().take(i + 1) {
                *b += binomial(i, k) / binomial(m, k) * a * power;
                power *= length;
            }
        }
        b
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn at(x: f64, y: f64) -> Position {
        [x, y, 0.0, 0.0, 0.0, 0.0]
    }

    #[test]
    fn a_rational_quadratic_is_a_quarter_circle() {
        let mut arc = Bezier::new(&[at(10.0, 0.0), at(10.0, 10.0), at(0.0, 10.0)]);
        arc.weights[1] = 0.5f64.sqrt();
        for piece in [arc, arc.raised_to(3), arc.raised_to(5)] {
            for i in 0..=8 {
                let p = piece.eval(f64::from(i) / 8.0);
                // Three roundings of numbers near 10.
                assert_relative_eq!((p[0] * p[0] + p[1] * p[1]).sqrt(), 10.0, epsilon = 1e-14);
            }
        }
    }

    #[test]
    fn power_basis_and_back() {
        let piece = Bezier::new(&[at(0.0, 0.0), at(10.0, 0.0), at(20.0, 12.0), at(30.0, 14.0)]);
        // The first block of the reference curve: PO[X]=(30) PO[Y]=(14,0.36,-0.022) PL=10.
        let y = piece.power_basis(1, 10.0);
        assert_relative_eq!(y[2], 0.36, epsilon = 1e-14);
        assert_relative_eq!(y[3], -0.022, epsilon = 1e-15);
        let x = piece.power_basis(0, 10.0);
        assert_eq!(&x[..4], &[0.0, 3.0, 0.0, 0.0]);
        let back = Bezier::ordinates(&y[..4], 10.0);
        for (i, b) in back.iter().enumerate().take(4) {
            assert_relative_eq!(*b, piece.points[i][1], epsilon = 1e-13);
        }
    }
}
