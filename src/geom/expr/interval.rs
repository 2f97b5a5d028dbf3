//! Intervals, rounded outward: whatever the reals do, the result holds it.
//!
//! A sum, product or quotient of floats is rounded to the nearest, so the next float below and above hold the true value.
//! The functions of `libm` are right to less than two units of the last place; four are allowed.

use super::number::{Fault, Number};
use crate::geom::elementary::{acos, asin, atan, atan2, cbrt, cos, cosh, exp, ln, pow, sin, sinh, tan, tanh};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::ops::{Add, Mul, Neg, Sub};

/// All reals from `low` to `high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The least.
    pub low: f64,
    /// The greatest.
    pub high: f64,
}

/// Beyond this an argument of sin and cos has lost its phase.
const FAR: f64 = 1e8;

impl Interval {
    /// From `low` to `high`.
    pub fn new(low: f64, high: f64) -> Interval {
        Interval { low, high }
    }

    /// One number.
    pub fn point(x: f64) -> Interval {
        Interval { low: x, high: x }
    }

    /// Whether it holds a number.
    pub fn contains(&self, x: f64) -> bool {
        self.low <= x && x <= self.high
    }

    /// The greatest |x|.
    pub fn magnitude(&self) -> f64 {
        self.low.abs().max(self.high.abs())
    }

    /// The least |x|.
    pub fn mignitude(&self) -> f64 {
        if self.contains(0.0) { 0.0 } else { self.low.abs().min(self.high.abs()) }
    }

    /// Results rounded to the nearest, widened by a float on each side.
    fn rounded(low: f64, high: f64) -> Interval {
        if low.is_nan() || high.is_nan() {
            return Interval { low: f64::NEG_INFINITY, high: f64::INFINITY };
        }
        Interval { low: low.next_down(), high: high.next_up() }
    }

    /// Results of `libm`, widened by four floats on each side.
    fn library(low: f64, high: f64) -> Interval {
        let mut wide = Interval { low, high };
        for _ in 0..4 {
            wide = Interval::rounded(wide.low, wide.high);
        }
        wide
    }

    /// A function that grows with its argument.
    fn rising(self, f: impl Fn(f64) -> f64) -> Interval {
        Interval::library(f(self.low), f(self.high))
    }

    /// Within bounds that the function never leaves.
    fn within(self, low: f64, high: f64) -> Interval {
        Interval { low: self.low.max(low), high: self.high.min(high) }
    }

    /// Whether a place `phase` + kτ may lie in it.
    fn meets(&self, phase: f64) -> bool {
        // More than the roundings of k τ + phase.
        let slack = 1e-14 * (1.0 + self.magnitude());
        let k = ((self.low - slack - phase) / TAU).ceil();
        k * TAU + phase <= self.high + slack
    }
}

impl Add for Interval {
    type Output = Interval;

    fn add(self, other: Interval) -> Interval {
        Interval::rounded(self.low + other.low, self.high + other.high)
    }
}

impl Sub for Interval {
    type Output = Interval;

    fn sub(self, other: Interval) -> Interval {
        Interval::rounded(self.low - other.high, self.high - other.low)
    }
}

impl Mul for Interval {
    type Output = Interval;

    fn mul(self, other: Interval) -> Interval {
        // 0·∞ is 0 here: a bound that is not known times nothing.
        let product = |a: f64, b: f64| if a == 0.0 || b == 0.0 { 0.0 } else { a * b };
        let all = [
            product(self.low, other.low),
            product(self.low, other.high),
            product(self.high, other.low),
            product(self.high, other.high),
        ];
        let low = all.iter().copied().fold(f64::INFINITY, f64::min);
        Interval::rounded(low, all.iter().copied().fold(f64::NEG_INFINITY, f64::max))
    }
}

impl Neg for Interval {
    type Output = Interval;

    fn neg(self) -> Interval {
        Interval { low: -self.high, high: -self.low }
    }
}

impl Number for Interval {
    fn of(x: f64) -> Interval {
        Interval::point(x)
    }

    fn square(self) -> Interval {
        let (least, most) = (self.mignitude(), self.magnitude());
        Interval::rounded(least * least, most * most).within(0.0, f64::INFINITY)
    }

    fn over(self, other: Interval) -> Result<Interval, Fault> {
        if other.contains(0.0) {
            return Err(Fault::DivisionByZero);
        }
        let all =
            [self.low / other.low, self.low / other.high, self.high / other.low, self.high / other.high];
        let low = all.iter().copied().fold(f64::INFINITY, f64::min);
        Ok(Interval::rounded(low, all.iter().copied().fold(f64::NEG_INFINITY, f64::max)))
    }

    fn sqrt(self) -> Result<Interval, Fault> {
        if self.low < 0.0 {
            return Err(Fault::RootOfNegative);
        }
        Ok(Interval::rounded(self.low.sqrt(), self.high.sqrt()).within(0.0, f64::INFINITY))
    }

    fn cbrt(self) -> Interval {
        self.rising(cbrt)
    }

    fn exp(self) -> Interval {
        self.rising(exp).within(0.0, f64::INFINITY)
    }

    fn ln(self) -> Result<Interval, Fault> {
        if self.low <= 0.0 {
            return Err(Fault::LogarithmOfNonPositive);
        }
        Ok(self.rising(ln))
    }

    fn sin(self) -> Interval {
        if !(self.magnitude() < FAR) {
            return Interval::new(-1.0, 1.0);
        }
        let (a, b) = (sin(self.low), sin(self.high));
        let mut range = Interval::library(a.min(b), a.max(b)).within(-1.0, 1.0);
        if self.meets(FRAC_PI_2) {
            range.high = 1.0;
        }
        if self.meets(-FRAC_PI_2) {
            range.low = -1.0;
        }
        range
    }

    fn cos(self) -> Interval {
        if !(self.magnitude() < FAR) {
            return Interval::new(-1.0, 1.0);
        }
        let (a, b) = (cos(self.low), cos(self.high));
        let mut range = Interval::library(a.min(b), a.max(b)).within(-1.0, 1.0);
        if self.meets(0.0) {
            range.high = 1.0;
        }
        if self.meets(PI) {
            range.low = -1.0;
        }
        range
    }

    fn tan(self) -> Result<Interval, Fault> {
        if !(self.magnitude() < FAR) || self.meets(FRAC_PI_2) || self.meets(-FRAC_PI_2) {
            return Err(Fault::PoleOfTangent);
        }
        Ok(self.rising(tan))
    }

    fn asin(self) -> Result<Interval, Fault> {
        if 1.0 < self.magnitude() {
            return Err(Fault::ArcBeyondOne);
        }
        Ok(self.rising(asin))
    }

    fn acos(self) -> Result<Interval, Fault> {
        if 1.0 < self.magnitude() {
            return Err(Fault::ArcBeyondOne);
        }
        Ok(Interval::library(acos(self.high), acos(self.low)))
    }

    fn atan(self) -> Interval {
        self.rising(atan)
    }

    fn atan2(self, x: Interval) -> Result<Interval, Fault> {
        if self.contains(0.0) && x.low <= 0.0 {
            return Err(if x.contains(0.0) { Fault::AngleOfNothing } else { Fault::AngleJumps });
        }
        // Without the origin and the cut inside, the angle is greatest and least at a corner.
        let corners = [
            atan2(self.low, x.low),
            atan2(self.low, x.high),
            atan2(self.high, x.low),
            atan2(self.high, x.high),
        ];
        let low = corners.iter().copied().fold(f64::INFINITY, f64::min);
        Ok(Interval::library(low, corners.iter().copied().fold(f64::NEG_INFINITY, f64::max)))
    }

    fn sinh(self) -> Interval {
        self.rising(sinh)
    }

    fn cosh(self) -> Interval {
        Interval::library(cosh(self.mignitude()), cosh(self.magnitude())).within(1.0, f64::INFINITY)
    }

    fn tanh(self) -> Interval {
        self.rising(tanh).within(-1.0, 1.0)
    }

    fn pow(self, exponent: f64) -> Result<Interval, Fault> {
        if self.low <= 0.0 {
            return Err(Fault::PowerOfNonPositive);
        }
        let (a, b) = (pow(self.low, exponent), pow(self.high, exponent));
        Ok(Interval::library(a.min(b), a.max(b)).within(0.0, f64::INFINITY))
    }

    fn sign(self) -> Result<f64, Fault> {
        if self.contains(0.0) {
            return Err(Fault::Kink);
        }
        Ok(if 0.0 < self.low { 1.0 } else { -1.0 })
    }

    fn is_zero(self) -> bool {
        self.contains(0.0)
    }

    fn is_finite(self) -> bool {
        self.low.is_finite() && self.high.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extremes_inside_are_found() {
        let sine = Interval::new(1.0, 2.0).sin();
        assert_eq!(sine.high, 1.0);
        assert!(sine.low <= sin(1.0) && sin(1.0) - 1e-15 < sine.low);
        assert_eq!(Interval::new(0.0, 7.0).sin(), Interval::new(-1.0, 1.0));
        assert_eq!(Interval::new(3.0, 3.2).cos().low, -1.0);
        assert_eq!(Interval::new(-100.6, -100.5).cos().high, 1.0);
        assert_eq!(Interval::new(-2.0, 1.0).square().low, 0.0);
        assert_eq!(Interval::new(-2.0, 1.0).cosh().low, 1.0);
    }

    #[test]
    fn faults_are_found_where_they_may_be() {
        let around = Interval::new(-1.0, 1.0);
        assert_eq!(Interval::point(1.0).over(around), Err(Fault::DivisionByZero));
        assert_eq!(around.sqrt(), Err(Fault::RootOfNegative));
        assert_eq!(around.ln(), Err(Fault::LogarithmOfNonPositive));
        assert_eq!(Interval::new(1.5, 1.6).tan(), Err(Fault::PoleOfTangent));
        assert!(Interval::new(1.6, 4.7).tan().is_ok());
        assert_eq!(Interval::new(0.0, 1.1).asin(), Err(Fault::ArcBeyondOne));
        assert_eq!(around.sign(), Err(Fault::Kink));
        assert_eq!(around.atan2(Interval::new(-2.0, -1.0)), Err(Fault::AngleJumps));
        assert_eq!(around.atan2(around), Err(Fault::AngleOfNothing));
        assert!(around.atan2(Interval::new(1.0, 2.0)).is_ok());
    }
}
