//! What expressions are evaluated in: floats, or intervals of them.

use crate::geom::elementary;
use std::ops::{Add, Mul, Neg, Sub};

/// Why an expression has no value, or no derivative.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Fault {
    /// Something over 0.
    #[error("this divides by zero")]
    DivisionByZero,
    /// √x, x < 0.
    #[error("this is the root of a negative number")]
    RootOfNegative,
    /// √x or ∛x at 0.
    #[error("the root of zero has no derivative")]
    RootOfZero,
    /// ln x, x ≤ 0.
    #[error("this is the logarithm of a number that is not positive")]
    LogarithmOfNonPositive,
    /// xʳ or x^f, x ≤ 0.
    #[error("this is a fractional power of a number that is not positive")]
    PowerOfNonPositive,
    /// tan x at π/2 + kπ.
    #[error("the tangent has a pole here")]
    PoleOfTangent,
    /// asin x or acos x beyond ±1.
    #[error("this is the arc sine or cosine of a number beyond 1")]
    ArcBeyondOne,
    /// asin x or acos x at ±1.
    #[error("the arc sine or cosine of 1 has no derivative")]
    ArcOfOne,
    /// |x| at 0.
    #[error("the absolute value of zero has no derivative: a kink")]
    Kink,
    /// atan2(y, x) at y = 0, x < 0.
    #[error("the angle jumps here, from -pi to pi")]
    AngleJumps,
    /// atan2(0, 0).
    #[error("this is the angle of no direction")]
    AngleOfNothing,
    /// The value is too large for a float.
    #[error("this is too large a number")]
    Overflow,
}

/// A number that expressions can be evaluated in.
pub trait Number:
    Copy + std::fmt::Debug + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// A float.
    fn of(x: f64) -> Self;

    /// x².
    #[must_use]
    fn square(self) -> Self;

    /// x/y.
    ///
    /// # Errors
    /// y is or may be 0.
    fn over(self, other: Self) -> Result<Self, Fault>;

    /// √x.
    ///
    /// # Errors
    /// x is or may be negative.
    fn sqrt(self) -> Result<Self, Fault>;

    /// ∛x.
    #[must_use]
    fn cbrt(self) -> Self;

    /// eˣ.
    #[must_use]
    fn exp(self) -> Self;

    /// ln x.
    ///
    /// # Errors
    /// x is or may not be positive.
    fn ln(self) -> Result<Self, Fault>;

    /// sin x.
    #[must_use]
    fn sin(self) -> Self;

    /// cos x.
    #[must_use]
    fn cos(self) -> Self;

    /// tan x.
    ///
    /// # Errors
    /// x is or may be a pole.
    fn tan(self) -> Result<Self, Fault>;

    /// arcsin x.
    ///
    /// # Errors
    /// |x| is or may be beyond 1.
    fn asin(self) -> Result<Self, Fault>;

    /// arccos x.
    ///
    /// # Errors
    /// |x| is or may be beyond 1.
    fn acos(self) -> Result<Self, Fault>;

    /// arctan x.
    #[must_use]
    fn atan(self) -> Self;

    /// The angle of (x, self).
    ///
    /// # Errors
    /// It is or may be on the cut or at the origin.
    fn atan2(self, x: Self) -> Result<Self, Fault>;

    /// sinh x.
    #[must_use]
    fn sinh(self) -> Self;

    /// cosh x.
    #[must_use]
    fn cosh(self) -> Self;

    /// tanh x.
    #[must_use]
    fn tanh(self) -> Self;

    /// xʳ.
    ///
    /// # Errors
    /// x is or may not be positive.
    fn pow(self, exponent: f64) -> Result<Self, Fault>;

    /// 1 or −1.
    ///
    /// # Errors
    /// x is or may be 0.
    fn sign(self) -> Result<f64, Fault>;

    /// Whether it is or may be 0.
    fn is_zero(self) -> bool;

    /// Whether it is bounded.
    fn is_finite(self) -> bool;
}

impl Number for f64 {
    fn of(x: f64) -> f64 {
        x
    }

    fn square(self) -> f64 {
        self * self
    }

    fn over(self, other: f64) -> Result<f64, Fault> {
        if other == 0.0 { Err(Fault::DivisionByZero) } else { Ok(self / other) }
    }

    fn sqrt(self) -> Result<f64, Fault> {
        if self < 0.0 { Err(Fault::RootOfNegative) } else { Ok(f64::sqrt(self)) }
    }

    fn cbrt(self) -> f64 {
        elementary::cbrt(self)
    }

    fn exp(self) -> f64 {
        elementary::exp(self)
    }

    fn ln(self) -> Result<f64, Fault> {
        if self <= 0.0 { Err(Fault::LogarithmOfNonPositive) } else { Ok(elementary::ln(self)) }
    }

    fn sin(self) -> f64 {
        elementary::sin(self)
    }

    fn cos(self) -> f64 {
        elementary::cos(self)
    }

    fn tan(self) -> Result<f64, Fault> {
        Ok(elementary::tan(self))
    }

    fn asin(self) -> Result<f64, Fault> {
        if 1.0 < self.abs() { Err(Fault::ArcBeyondOne) } else { Ok(elementary::asin(self)) }
    }

    fn acos(self) -> Result<f64, Fault> {
        if 1.0 < self.abs() { Err(Fault::ArcBeyondOne) } else { Ok(elementary::acos(self)) }
    }

    fn atan(self) -> f64 {
        elementary::atan(self)
    }

    fn atan2(self, x: f64) -> Result<f64, Fault> {
        if self == 0.0 && x == 0.0 { Err(Fault::AngleOfNothing) } else { Ok(elementary::atan2(self, x)) }
    }

    fn sinh(self) -> f64 {
        elementary::sinh(self)
    }

    fn cosh(self) -> f64 {
        elementary::cosh(self)
    }

    fn tanh(self) -> f64 {
        elementary::tanh(self)
    }

    fn pow(self, exponent: f64) -> Result<f64, Fault> {
        if self <= 0.0 { Err(Fault::PowerOfNonPositive) } else { Ok(elementary::pow(self, exponent)) }
    }

    fn sign(self) -> Result<f64, Fault> {
        match self.partial_cmp(&0.0) {
            Some(std::cmp::Ordering::Greater) => Ok(1.0),
            Some(std::cmp::Ordering::Less) => Ok(-1.0),
            Some(std::cmp::Ordering::Equal) | None => Err(Fault::Kink),
        }
    }

    fn is_zero(self) -> bool {
        self == 0.0
    }

    fn is_finite(self) -> bool {
        f64::is_finite(self)
    }
}
