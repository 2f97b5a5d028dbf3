//! Taylor series: a value and its derivatives, found exactly by rules, not by differences.
//!
//! A jet holds aₖ = f⁽ᵏ⁾(u)/k! for k < N. Every operation has a rule for the coefficients of its result (Moore 1966;
//! Griewank and Walther, *Evaluating Derivatives*, ch. 13); b is the result, a the argument, and the rules follow from the
//! differential equation that each function satisfies:
//!
//! ```text
//! product   bₖ = Σ aⱼ cₖ₋ⱼ                             quotient  bₖ = (aₖ − Σ(j<k) bⱼ cₖ₋ⱼ)/c₀
//! √a        bₖ = (aₖ − Σ(0<j<k) bⱼ bₖ₋ⱼ)/(2b₀)         eᵃ        bₖ = Σ j aⱼ bₖ₋ⱼ/k
//! ln a      bₖ = (aₖ − Σ(0<j<k) j bⱼ aₖ₋ⱼ/k)/a₀        aʳ        bₖ = Σ (rj − (k−j)) aⱼ bₖ₋ⱼ/(k a₀)
//! sin, cos  sₖ = Σ j aⱼ cₖ₋ⱼ/k    cₖ = −Σ j aⱼ sₖ₋ⱼ/k
//! b′ = a′w  bₖ = Σ j aⱼ wₖ₋ⱼ/k                         (tan: w = 1 + b², tanh: w = 1 − b²)
//! b′ = a′/w bₖ = (k aₖ − Σ(0<j<k) j bⱼ wₖ₋ⱼ)/(k w₀)    (atan: w = 1 + a², asin: w = √(1 − a²))
//! ```
//!
//! In intervals the same rules bound the derivatives over a whole range of u.

use super::number::{Fault, Number};

/// aₖ = f⁽ᵏ⁾/k! for k < N, N ≥ 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet<T, const N: usize>(pub [T; N]);

impl<T: Number, const N: usize> Jet<T, N> {
    /// A number that does not change.
    pub fn constant(x: f64) -> Jet<T, N> {
        let mut a = [T::of(0.0); N];
        a[0] = T::of(x);
        Jet(a)
    }

    /// The parameter itself.
    pub fn parameter(u: T) -> Jet<T, N> {
        let mut a = [T::of(0.0); N];
        a[0] = u;
        if 1 < N {
            a[1] = T::of(1.0);
        }
        Jet(a)
    }

    fn map(self, f: impl Fn(T) -> T) -> Jet<T, N> {
        Jet(self.0.map(f))
    }

    /// a + c.
    #[must_use]
    pub fn plus(self, other: Jet<T, N>) -> Jet<T, N> {
        Jet(std::array::from_fn(|k| self.0[k] + other.0[k]))
    }

    /// a − c.
    #[must_use]
    pub fn minus(self, other: Jet<T, N>) -> Jet<T, N> {
        Jet(std::array::from_fn(|k| self.0[k] - other.0[k]))
    }

    /// −a.
    #[must_use]
    pub fn negative(self) -> Jet<T, N> {
        self.map(|x| -x)
    }

    /// x a.
    #[must_use]
    pub fn scaled(self, x: f64) -> Jet<T, N> {
        self.map(|a| a * T::of(x))
    }

    /// a c.
    #[must_use]
    pub fn times(self, other: Jet<T, N>) -> Jet<T, N> {
        let mut b = [T::of(0.0); N];
        for k in 0..N {
            b[k] = self.0[0] * other.0[k];
            for j in 1..=k {
                b[k] = b[k] + self.0[j] * other.0[k - j];
            }
        }
        Jet(b)
    }

    /// a²: each product of two different coefficients once, doubled.
    #[must_use]
    pub fn square(self) -> Jet<T, N> {
        let mut b = [T::of(0.0); N];
        for k in 0..N {
            for j in 0..k.div_ceil(2) {
                b[k] = b[k] + T::of(2.0) * self.0[j] * self.0[k - j];
            }
            if k % 2 == 0 {
                b[k] = b[k] + self.0[k / 2].square();
            }
        }
        Jet(b)
    }

    /// a/c.
    ///
    /// # Errors
    /// c is 0.
    pub fn over(self, other: Jet<T, N>) -> Result<Jet<T, N>, Fault> {
        let mut b = [T::of(0.0); N];
        for k in 0..N {
            let mut rest = self.0[k];
            for j in 0..k {
                rest = rest - b[j] * other.0[k - j];
            }
            b[k] = rest.over(other.0[0])?;
        }
        Ok(Jet(b))
    }

    /// aⁿ by squaring.
    ///
    /// # Errors
    /// n < 0 and a is 0.
    pub fn whole_power(self, n: i32) -> Result<Jet<T, N>, Fault> {
        let mut result = None;
        let mut square = self;
        let mut rest = n.unsigned_abs();
        while rest != 0 {
            if rest % 2 == 1 {
                result = Some(match result {
                    None => square,
                    Some(known) => square.times(known),
                });
            }
            rest /= 2;
            if rest != 0 {
                square = square.square();
            }
        }
        let result = result.unwrap_or(Jet::constant(1.0));
        if n < 0 { Jet::constant(1.0).over(result) } else { Ok(result) }
    }

    /// A value whose derivatives are not asked for, N = 1.
    fn bare(value: T) -> Jet<T, N> {
        Jet([value; N])
    }

    /// Σ(0<j≤most) j aⱼ wₖ₋ⱼ/k.
    fn weighted(a: &[T; N], w: &[T; N], k: usize, most: usize) -> Result<T, Fault> {
        let mut sum = T::of(0.0);
        for j in 1..=most {
            sum = sum + T::of(j as f64) * a[j] * w[k - j];
        }
        sum.over(T::of(k as f64))
    }

    /// b′ = a′/w: all coefficients but the first. `at_zero` is what w₀ = 0 means.
    fn divided(value: T, inner: &Jet<T, N>, w: &Jet<T, N>, at_zero: Fault) -> Result<Jet<T, N>, Fault> {
        let mut b = [T::of(0.0); N];
        b[0] = value;
        if 1 < N && w.0[0].is_zero() {
            return Err(at_zero);
        }
        for k in 1..N {
            let rest = inner.0[k] - Jet::weighted(&b, &w.0, k, k - 1)?;
            b[k] = rest.over(w.0[0])?;
        }
        Ok(Jet(b))
    }

    /// √a.
    ///
    /// # Errors
    /// a is negative, or 0 where derivatives are asked for.
    pub fn sqrt(self) -> Result<Jet<T, N>, Fault> {
        let mut b = [T::of(0.0); N];
        b[0] = self.0[0].sqrt()?;
        if 1 < N && self.0[0].is_zero() {
            return Err(Fault::RootOfZero);
        }
        for k in 1..N {
            let mut rest = self.0[k];
            for j in 1..k {
                rest = rest - b[j] * b[k - j];
            }
            b[k] = rest.over(T::of(2.0) * b[0])?;
        }
        Ok(Jet(b))
    }

    /// aʳ below its value b₀.
    fn real_power(self, value: T, r: f64) -> Result<Jet<T, N>, Fault> {
        let mut b = [T::of(0.0); N];
        b[0] = value;
        for k in 1..N {
            let mut sum = T::of(0.0);
            for j in 1..=k {
                let weight = T::of(r) * T::of(j as f64) - T::of((k - j) as f64);
                sum = sum + weight * self.0[j] * b[k - j];
            }
            b[k] = sum.over(T::of(k as f64) * self.0[0])?;
        }
        Ok(Jet(b))
    }

    /// ∛a.
    ///
    /// # Errors
    /// a is 0 where derivatives are asked for.
    pub fn cbrt(self) -> Result<Jet<T, N>, Fault> {
        let value = self.0[0].cbrt();
        if 1 < N && self.0[0].is_zero() {
            return Err(Fault::RootOfZero);
        }
        // b² below stands for a^(2/3): b′ = a′/(3b²), which no rounding of 1/3 enters.
        let mut b: Jet<T, N> = Jet::constant(0.0);
        b.0[0] = value;
        for k in 1..N {
            let w = b.square().scaled(3.0);
            let rest = self.0[k] - Jet::weighted(&b.0, &w.0, k, k - 1)?;
            b.0[k] = rest.over(w.0[0])?;
        }
        Ok(b)
    }

    /// aʳ.
    ///
    /// # Errors
    /// a is not positive.
    pub fn power(self, r: f64) -> Result<Jet<T, N>, Fault> {
        self.real_power(self.0[0].pow(r)?, r)
    }

    /// eᵃ.
    ///
    /// # Errors
    /// The result is too large.
    pub fn exp(self) -> Result<Jet<T, N>, Fault> {
        let mut b: Jet<T, N> = Jet::constant(0.0);
        b.0[0] = self.0[0].exp();
        for k in 1..N {
            b.0[k] = Jet::weighted(&self.0, &b.0, k, k)?;
        }
        Ok(b)
    }

    /// ln a.
    ///
    /// # Errors
    /// a is not positive.
    pub fn ln(self) -> Result<Jet<T, N>, Fault> {
        Jet::divided(self.0[0].ln()?, &self, &self, Fault::LogarithmOfNonPositive)
    }

    /// sin a and cos a.
    ///
    /// # Errors
    /// None that a finite argument meets.
    pub fn sin_cos(self) -> Result<(Jet<T, N>, Jet<T, N>), Fault> {
        let (mut s, mut c): (Jet<T, N>, Jet<T, N>) = (Jet::constant(0.0), Jet::constant(0.0));
        (s.0[0], c.0[0]) = (self.0[0].sin(), self.0[0].cos());
        for k in 1..N {
            s.0[k] = Jet::weighted(&self.0, &c.0, k, k)?;
            c.0[k] = -Jet::weighted(&self.0, &s.0, k, k)?;
        }
        Ok((s, c))
    }

    /// sinh a and cosh a.
    ///
    /// # Errors
    /// None that a finite argument meets.
    pub fn sinh_cosh(self) -> Result<(Jet<T, N>, Jet<T, N>), Fault> {
        let (mut s, mut c): (Jet<T, N>, Jet<T, N>) = (Jet::constant(0.0), Jet::constant(0.0));
        (s.0[0], c.0[0]) = (self.0[0].sinh(), self.0[0].cosh());
        for k in 1..N {
            s.0[k] = Jet::weighted(&self.0, &c.0, k, k)?;
            c.0[k] = Jet::weighted(&self.0, &s.0, k, k)?;
        }
        Ok((s, c))
    }

    /// b′ = a′ (1 ± b²).
    fn riccati(self, value: T, sign: f64) -> Result<Jet<T, N>, Fault> {
        let mut b: Jet<T, N> = Jet::constant(0.0);
        b.0[0] = value;
        for k in 1..N {
            let w = Jet::constant(1.0).plus(b.square().scaled(sign));
            b.0[k] = Jet::weighted(&self.0, &w.0, k, k)?;
        }
        Ok(b)
    }

    /// tan a.
    ///
    /// # Errors
    /// a is a pole.
    pub fn tan(self) -> Result<Jet<T, N>, Fault> {
        self.riccati(self.0[0].tan()?, 1.0)
    }

    /// tanh a.
    ///
    /// # Errors
    /// None that a finite argument meets.
    pub fn tanh(self) -> Result<Jet<T, N>, Fault> {
        self.riccati(self.0[0].tanh(), -1.0)
    }

    /// arctan a.
    ///
    /// # Errors
    /// None that a finite argument meets.
    pub fn atan(self) -> Result<Jet<T, N>, Fault> {
        let w = Jet::constant(1.0).plus(self.square());
        Jet::divided(self.0[0].atan(), &self, &w, Fault::DivisionByZero)
    }

    /// arcsin a.
    ///
    /// # Errors
    /// |a| is beyond 1, or 1 where derivatives are asked for.
    pub fn asin(self) -> Result<Jet<T, N>, Fault> {
        self.arc(self.0[0].asin()?, 1.0)
    }

    /// arccos a.
    ///
    /// # Errors
    /// |a| is beyond 1, or 1 where derivatives are asked for.
    pub fn acos(self) -> Result<Jet<T, N>, Fault> {
        self.arc(self.0[0].acos()?, -1.0)
    }

    /// b′ = ±a′/√(1 − a²).
    fn arc(self, value: T, sign: f64) -> Result<Jet<T, N>, Fault> {
        if N == 1 {
            return Ok(Jet::bare(value));
        }
        let w = Jet::constant(1.0).minus(self.square()).sqrt().map_err(|_| Fault::ArcOfOne)?;
        Jet::divided(value, &self.scaled(sign), &w, Fault::ArcOfOne)
    }

    /// The angle of (x, self): b′ = (x y′ − y x′)/(x² + y²).
    ///
    /// # Errors
    /// On the cut, or at the origin.
    pub fn atan2(self, x: Jet<T, N>) -> Result<Jet<T, N>, Fault> {
        let value = self.0[0].atan2(x.0[0])?;
        if N == 1 {
            return Ok(Jet::bare(value));
        }
        let w = x.square().plus(self.square());
        // Coefficient k − 1 of x y′ − y x′ is Σ j (xₖ₋ⱼ yⱼ − yₖ₋ⱼ xⱼ); that of b′ w is Σ j bⱼ wₖ₋ⱼ.
        let mut b = [T::of(0.0); N];
        b[0] = value;
        for k in 1..N {
            let turn = Jet::weighted(&self.0, &x.0, k, k)? - Jet::weighted(&x.0, &self.0, k, k)?;
            let rest = turn - Jet::weighted(&b, &w.0, k, k - 1)?;
            b[k] = rest.over(w.0[0]).map_err(|_| Fault::AngleOfNothing)?;
        }
        Ok(Jet(b))
    }

    /// |a|.
    ///
    /// # Errors
    /// a is 0 where derivatives are asked for.
    pub fn abs(self) -> Result<Jet<T, N>, Fault> {
        match self.0[0].sign() {
            Ok(sign) => Ok(self.scaled(sign)),
            Err(fault) if 1 < N => Err(fault),
            // √a² is |a|, also over an interval with 0 in it.
            Err(_) => Ok(Jet::bare(self.0[0].square().sqrt()?)),
        }
    }

    /// Whether every coefficient is bounded.
    pub fn is_finite(&self) -> bool {
        self.0.iter().all(|a| a.is_finite())
    }
}
