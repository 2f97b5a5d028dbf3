//! Polynomials on \[0, 1\] in Bernstein form, whose coefficients bound them.
//!
//! ```text
//! f(t) = Σ C(n,i) tⁱ (1−t)ⁿ⁻ⁱ c_i          min c_i ≤ f(t) ≤ max c_i
//! ```
//!
//! Of degree at most [`MAX_DEGREE`], on a fixed array: a rational quintic's derivative against the logarithm needs 14.

/// The greatest degree.
pub const MAX_DEGREE: usize = 16;

/// A polynomial of degree n with n + 1 Bernstein coefficients.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bernstein {
    degree: usize,
    c: [f64; MAX_DEGREE + 1],
}

/// Pascal's triangle; whole numbers below 2⁵³.
const BINOMIALS: [[f64; MAX_DEGREE + 1]; MAX_DEGREE + 1] = {
    let mut rows = [[0.0; MAX_DEGREE + 1]; MAX_DEGREE + 1];
    let mut n = 0;
    while n <= MAX_DEGREE {
        rows[n][0] = 1.0;
        let mut i = 1;
        while i <= n {
            rows[n][i] = rows[n - 1][i - 1] + rows[n - 1][i];
            i += 1;
        }
        n += 1;
    }
    rows
};

/// C(n, i) as a float, n at most [`MAX_DEGREE`]; exact.
pub fn binomial(n: usize, i: usize) -> f64 {
    BINOMIALS[n][i]
}

impl Bernstein {
    /// The polynomial with these coefficients, 1 to [`MAX_DEGREE`] + 1 of them.
    pub fn new(coefficients: &[f64]) -> Bernstein {
        let mut c = [0.0; MAX_DEGREE + 1];
        c[..coefficients.len()].copy_from_slice(coefficients);
        Bernstein { degree: coefficients.len() - 1, c }
    }

    /// n.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// The coefficients.
    pub fn coefficients(&self) -> &[f64] {
        &self.c[..=self.degree]
    }

    /// A lower bound on \[0, 1\].
    pub fn min(&self) -> f64 {
        self.coefficients().iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// An upper bound on \[0, 1\].
    pub fn max(&self) -> f64 {
        self.coefficients().iter().copied().fold(f64::NEG_INFINITY, f64::max)
    }

    /// An upper bound of |f| on \[0, 1\].
    pub fn max_abs(&self) -> f64 {
        self.coefficients().iter().fold(0.0, |most, c| f64::max(most, c.abs()))
    }

    /// f(0).
    pub fn start(&self) -> f64 {
        self.c[0]
    }

    /// f(1).
    pub fn end(&self) -> f64 {
        self.c[self.degree]
    }

    /// f/t, or f/(1 − t), where that is a polynomial: f(0), or f(1), is 0, and n is not.
    ///
    /// ```text
    /// f/t: n/(i+1) c_{i+1}          f/(1 − t): n/(n−i) c_i
    /// ```
    #[must_use]
    pub fn without_root(&self, at_end: bool) -> Bernstein {
        let n = self.degree;
        let mut result = Bernstein { degree: n - 1, c: [0.0; MAX_DEGREE + 1] };
        for i in 0..n {
            result.c[i] = if at_end {
                n as f64 / (n - i) as f64 * self.c[i]
            } else {
                n as f64 / (i + 1) as f64 * self.c[i + 1]
            };
        }
        result
    }

    /// f′, of degree n − 1 (a constant stays a constant zero): n (c_{i+1} − c_i).
    #[must_use]
    pub fn derivative(&self) -> Bernstein {
        if self.degree == 0 {
            return Bernstein::new(&[0.0]);
        }
        let mut result = Bernstein { degree: self.degree - 1, c: [0.0; MAX_DEGREE + 1] };
        for i in 0..self.degree {
            result.c[i] = self.degree as f64 * (self.c[i + 1] - self.c[i]);
        }
        result
    }

    /// f·g, of degree m + n: c_k = Σ C(m,i) C(n,k−i) a_i b_{k−i} / C(m+n,k).
    #[must_use]
    pub fn times(&self, other: &Bernstein) -> Bernstein {
        let (m, n) = (self.degree, other.degree);
        let mut result = Bernstein { degree: m + n, c: [0.0; MAX_DEGREE + 1] };
        for i in 0..=m {
            let a = self.c[i] * binomial(m, i);
            for j in 0..=n {
                result.c[i + j] += a * other.c[j] * binomial(n, j);
            }
        }
        for k in 0..=m + n {
            result.c[k] /= binomial(m + n, k);
        }
        result
    }

    /// The same polynomial with one more coefficient.
    #[must_use]
    pub fn elevated(&self) -> Bernstein {
        let n = self.degree;
        let mut result = Bernstein { degree: n + 1, c: self.c };
        for i in 1..=n {
            let share = i as f64 / (n + 1) as f64;
            result.c[i] = share * self.c[i - 1] + (1.0 - share) * self.c[i];
        }
        result.c[n + 1] = self.c[n];
        result
    }

    /// x·f + y·g, both raised to the same degree.
    #[must_use]
    pub fn combined(&self, x: f64, other: &Bernstein, y: f64) -> Bernstein {
        let (mut f, mut g) = (*self, *other);
        while f.degree < g.degree {
            f = f.elevated();
        }
        while g.degree < f.degree {
            g = g.elevated();
        }
        for i in 0..=f.degree {
            f.c[i] = x * f.c[i] + y * g.c[i];
        }
        f
    }

    /// x·f + y.
    #[must_use]
    pub fn scaled(&self, x: f64, y: f64) -> Bernstein {
        let mut f = *self;
        for c in &mut f.c[..=self.degree] {
            *c = x * *c + y;
        }
        f
    }

    /// The two halves, each on \[0, 1\] again, by de Casteljau's scheme.
    pub fn halves(&self) -> (Bernstein, Bernstein) {
        let n = self.degree;
        let (mut left, mut right) = (*self, *self);
        for k in 1..=n {
            for i in 0..=n - k {
                right.c[i] = 0.5 * (right.c[i] + right.c[i + 1]);
            }
            left.c[k] = right.c[0];
        }
        (left, right)
    }

    /// Bounds of f on \[0, 1\], after `depth` halvings; the error falls by four with each.
    pub fn range(&self, depth: u32) -> (f64, f64) {
        if depth == 0 || self.degree < 2 {
            return (self.min(), self.max());
        }
        let (left, right) = self.halves();
        let ((a, b), (c, d)) = (left.range(depth - 1), right.range(depth - 1));
        (a.min(c), b.max(d))
    }

    /// f(t).
    pub fn eval(&self, t: f64) -> f64 {
        let mut c = self.c;
        for k in 1..=self.degree {
            for i in 0..=self.degree - k {
                c[i] = (1.0 - t) * c[i] + t * c[i + 1];
            }
        }
        c[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn partition_of_unity_and_known_binomials() {
        assert_eq!(Bernstein::new(&[1.0; 6]).eval(0.37), 1.0);
        assert_eq!((binomial(14, 7), binomial(5, 0), binomial(5, 5)), (3432.0, 1.0, 1.0));
    }

    #[test]
    fn product_derivative_and_halves_agree_with_values() {
        let f = Bernstein::new(&[1.0, -2.0, 0.5, 3.0]);
        let g = Bernstein::new(&[0.25, 4.0, -1.0]);
        let (left, right) = f.halves();
        for i in 0..=16 {
            let t = f64::from(i) / 16.0;
            // A few roundings of numbers below 20.
            assert_relative_eq!(f.times(&g).eval(t), f.eval(t) * g.eval(t), epsilon = 1e-14);
            assert_relative_eq!(
                f.combined(2.0, &g, -1.0).eval(t),
                2.0 * f.eval(t) - g.eval(t),
                epsilon = 1e-14
            );
            assert_relative_eq!(left.eval(t), f.eval(0.5 * t), epsilon = 1e-14);
            assert_relative_eq!(right.eval(t), f.eval(0.5 + 0.5 * t), epsilon = 1e-14);
        }
        // (f·g)′ = f′g + fg′
        let product = f.times(&g).derivative();
        let leibniz = f.derivative().times(&g).combined(1.0, &f.times(&g.derivative()), 1.0);
        assert_relative_eq!(product.eval(0.3), leibniz.eval(0.3), epsilon = 1e-13);
    }

    #[test]
    fn ranges_close_in_on_the_extremes() {
        // 4t(1−t) has its greatest value 1 at ½; its coefficients say 2.
        let f = Bernstein::new(&[0.0, 2.0, 0.0]);
        assert_eq!((f.max(), f.range(8)), (2.0, (0.0, 1.0)));
    }

    #[test]
    fn coefficients_bound_the_values() {
        let f = Bernstein::new(&[0.0, 2.0, -1.0, 0.5]);
        for i in 0..=64 {
            let value = f.eval(f64::from(i) / 64.0);
            assert!(f.min() <= value && value <= f.max());
        }
    }
}
