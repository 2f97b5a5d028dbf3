//! The only transcendental functions of the project, the same bits on every platform.
//!
//! The standard library's `sin` or `ln` is the platform's and differs in the last bit, so golden files would too.
//! All functions here come from `libm`, in pure Rust. `sqrt` is exact by IEEE 754 and needs no help.

/// tan x, x in radians.
pub fn tan(x: f64) -> f64 {
    libm::tan(x)
}

/// sin x, x in radians.
pub fn sin(x: f64) -> f64 {
    libm::sin(x)
}

/// cos x, x in radians.
pub fn cos(x: f64) -> f64 {
    libm::cos(x)
}

/// arctan x, in radians.
pub fn atan(x: f64) -> f64 {
    libm::atan(x)
}

/// ln(1 + x) without loss for small x.
pub fn ln_1p(x: f64) -> f64 {
    libm::log1p(x)
}

/// eˣ − 1 without loss for small x.
pub fn exp_m1(x: f64) -> f64 {
    libm::expm1(x)
}

/// ∛x.
pub fn cbrt(x: f64) -> f64 {
    libm::cbrt(x)
}

/// ln(1 + x)/x, continued by 1 at 0.
pub fn ln_1p_over(x: f64) -> f64 {
    // Below 2⁻⁵⁴ the series 1 − x/2 + … is 1 to the last bit.
    if x.abs() < 5.0e-17 { 1.0 } else { ln_1p(x) / x }
}

/// arcsin x, in radians.
pub fn asin(x: f64) -> f64 {
    libm::asin(x)
}

/// arccos x, in radians.
pub fn acos(x: f64) -> f64 {
    libm::acos(x)
}

/// The angle of (x, y), in radians.
pub fn atan2(y: f64, x: f64) -> f64 {
    libm::atan2(y, x)
}

/// eˣ.
pub fn exp(x: f64) -> f64 {
    libm::exp(x)
}

/// ln x.
pub fn ln(x: f64) -> f64 {
    libm::log(x)
}

/// sinh x.
pub fn sinh(x: f64) -> f64 {
    libm::sinh(x)
}

/// cosh x.
pub fn cosh(x: f64) -> f64 {
    libm::cosh(x)
}

/// tanh x.
pub fn tanh(x: f64) -> f64 {
    libm::tanh(x)
}

/// xʸ.
pub fn pow(x: f64, y: f64) -> f64 {
    libm::pow(x, y)
}
