//! Numbers as a control reads them: an integer and a count of decimals.
//!
//! A machine file says how many decimals an address takes, [`Decimal::round`] rounds once, and from then on
//! joints, closure and modality are decided on integers. Rounding is that of the correctly rounded text of the
//! float (ties to even), so `round(x, n)` has the digits that `format!("{x:.n$}")` prints, without the text and
//! without its negative zero.

use crate::units::{Axes, DEGREES, Kind, MAX_AXES};
use std::cmp::Ordering;

/// The greatest number of decimals.
pub const MAX_DIGITS: u8 = 18;

/// 10⁰ … 10¹⁸ as integers.
const POWERS: [i64; 19] = {
    let mut powers = [1i64; 19];
    let mut i = 1;
    while i < 19 {
        powers[i] = powers[i - 1] * 10;
        i += 1;
    }
    powers
};

/// The same as floats, exactly: 10¹⁸ < 2⁵³·2¹⁸ and 5¹⁸ < 2⁵³.
const FLOAT_POWERS: [f64; 19] = {
    let mut powers = [1.0; 19];
    let mut i = 0;
    while i < 19 {
        powers[i] = POWERS[i] as f64;
        i += 1;
    }
    powers
};

/// 10^`digits` as an integer.
pub fn power_of_ten(digits: u8) -> i64 {
    POWERS[usize::from(digits.min(MAX_DIGITS))]
}

/// 10^`digits` as a float, exactly.
#[inline]
fn float_power_of_ten(digits: u8) -> f64 {
    FLOAT_POWERS[usize::from(digits.min(MAX_DIGITS))]
}

/// Rounds `x` to `digits` decimals and gives it in units of the last one; none where it is not finite or too large.
///
/// With s = 10^digits the product x·s is wanted exactly. Unless its leading part lies in the middle of two integers, the
/// nearest integer to that is the one; there the error of the product says which of the two it is.
#[inline]
pub fn round_units(x: f64, digits: u8) -> Option<i64> {
    // Adding 1.5·2⁵² pushes the fraction out of the mantissa, ties to even, and leaves the integer in its last bits.
    const SHIFT: f64 = 6_755_399_441_055_744.0;
    let s = float_power_of_ten(digits);
    let product = x * s;
    // Also false for NaN. Below 2⁵¹ a quarter is representable, so that ties can be seen and `SHIFT` works.
    if !(product.abs() < 2_251_799_813_685_248.0) {
        return None;
    }
    let shifted = product + SHIFT;
    let units = shifted.to_bits() as i64 - SHIFT.to_bits() as i64;
    let rest = product - (shifted - SHIFT); // exact
    if rest.abs() != 0.5 {
        return Some(units);
    }
    // `units` is the even neighbour; the true value may lie on the other side of the middle.
    let error = product_error(x, s, product);
    let beyond = if rest < 0.0 { error < 0.0 } else { 0.0 < error };
    Some(if !beyond {
        units
    } else if rest < 0.0 {
        units - 1
    } else {
        units + 1
    })
}

/// x·s − `product`, the error of the rounded product.
///
/// x is split in two halves of 26 and 27 bits; for s < 2²⁶ (seven decimals) both products are exact, and so is the error of
/// their sum; above that the error is carried by a fused multiply-add.
fn product_error(x: f64, s: f64, product: f64) -> f64 {
    if s < 67_108_864.0 {
        // Veltkamp's split: `high` has 26 bits.
        let c = 134_217_729.0 * x;
        let high = c - (c - x);
        let low = x - high;
        if c.is_finite() {
            return (high * s - product) + low * s;
        }
    }
    x.mul_add(s, -product)
}

/// Where an axis counts from: a place, and its rounding. Positions are rounded from there, so that what is alike but for
/// its place is alike in every digit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Origin {
    /// The place, mm or degrees.
    pub at: f64,
    /// The place in units of the last decimal.
    pub units: i64,
}

impl Origin {
    /// A position, rounded from here, in units of the last decimal.
    #[inline]
    pub fn round(&self, x: f64, digits: u8) -> Option<i64> {
        round_units(x - self.at, digits)?.checked_add(self.units)
    }
}

/// The float nearest to `units` / 10^`digits`.
///
/// One correctly rounded division of two exact numbers while |units| ≤ 2⁵³; larger integers are rounded first.
#[inline]
pub fn units_to_f64(units: i64, digits: u8) -> f64 {
    units as f64 / float_power_of_ten(digits)
}

/// What one unit of the last decimal in every axis makes together, mm, rotary axes counted at `radius` mm.
pub fn unit_at_surface(axes: &Axes, digits: &[u8; MAX_AXES], radius: f64) -> f64 {
    let mm = |i: usize| {
        let unit = 1.0 / power_of_ten(digits[i]) as f64;
        match axes.kind(i) {
            Kind::Linear | Kind::Direction => unit,
            Kind::Rotary => unit / DEGREES * radius,
        }
    };
    (0..axes.count()).map(|i| mm(i) * mm(i)).sum::<f64>().sqrt()
}

/// A decimal number, normalised: the last digit is not zero unless `digits` is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub struct Decimal {
    units: i64,
    digits: u8,
}

impl Decimal {
    /// Zero.
    pub const ZERO: Decimal = Decimal { units: 0, digits: 0 };

    /// `units` / 10^`digits`, normalised.
    pub fn new(mut units: i64, mut digits: u8) -> Decimal {
        while 0 < digits && units % 10 == 0 {
            units /= 10;
            digits -= 1;
        }
        Decimal { units, digits }
    }

    /// `x` rounded to `digits` decimals; none where it is not finite or too large.
    pub fn round(x: f64, digits: u8) -> Option<Decimal> {
        round_units(x, digits).map(|units| Decimal::new(units, digits))
    }

    /// How many decimals it needs.
    pub fn digits(self) -> u8 {
        self.digits
    }

    /// The number in units of 10^−`digits`; none where it has more decimals than that or is too large.
    pub fn units(self, digits: u8) -> Option<i64> {
        let more = digits.checked_sub(self.digits)?;
        self.units.checked_mul(power_of_ten(more))
    }

    /// The nearest float.
    pub fn to_f64(self) -> f64 {
        units_to_f64(self.units, self.digits)
    }

    /// The sum, exactly; none on overflow.
    pub fn plus(self, other: Decimal) -> Option<Decimal> {
        let digits = self.digits.max(other.digits);
        Some(Decimal::new(self.units(digits)?.checked_add(other.units(digits)?)?, digits))
    }

    /// The difference, exactly; none on overflow.
    pub fn minus(self, other: Decimal) -> Option<Decimal> {
        self.plus(other.times(-1)?)
    }

    /// The product with a small integer, exactly; none on overflow.
    pub fn times(self, factor: i64) -> Option<Decimal> {
        Some(Decimal::new(self.units.checked_mul(factor)?, self.digits))
    }

    /// Whether it is zero.
    pub fn is_zero(self) -> bool {
        self.units == 0
    }

    /// Compares by value.
    pub fn compare(self, other: Decimal) -> Ordering {
        let digits = self.digits.max(other.digits);
        match (self.units(digits), other.units(digits)) {
            (Some(a), Some(b)) => a.cmp(&b),
            // Only where one of them is beyond 10⁹ with many decimals on the other side; floats are far apart there.
            _ => self.to_f64().total_cmp(&other.to_f64()),
        }
    }
}

/// How a control wants a number spelled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Spelling {
    /// `X30.` instead of `X30`.
    pub point_always: bool,
    /// `X+30` instead of `X30`.
    pub sign_always: bool,
    /// `X0.5` instead of `X.5`.
    pub leading_zero: bool,
}

impl Spelling {
    /// `30`, `-0.5`.
    pub const PLAIN: Spelling = Spelling { point_always: false, sign_always: false, leading_zero: true };
}

/// Writes `units` / 10^`digits` without trailing zeros; zero has no sign unless signs are always written.
pub fn write_units(out: &mut Vec<u8>, units: i64, digits: u8, spelling: Spelling) {
    if units < 0 {
        out.push(b'-');
    } else if spelling.sign_always {
        out.push(b'+');
    }
    let mut buffer = itoa::Buffer::new();
    let text = buffer.format(units.unsigned_abs()).as_bytes();
    let decimals = usize::from(digits);
    let (whole, mut fraction) = text.split_at(text.len().saturating_sub(decimals));
    while let [rest @ .., b'0'] = fraction {
        fraction = rest;
    }
    if whole.is_empty() && (fraction.is_empty() || spelling.leading_zero) {
        out.push(b'0');
    }
    out.extend_from_slice(whole);
    if !fraction.is_empty() {
        out.push(b'.');
        // What is below a tenth has zeros behind the point.
        out.extend(std::iter::repeat_n(b'0', decimals.saturating_sub(text.len())));
        out.extend_from_slice(fraction);
    } else if spelling.point_always {
        out.push(b'.');
    }
}

impl Decimal {
    /// Writes the number in a control's spelling.
    pub fn write(self, out: &mut Vec<u8>, spelling: Spelling) {
        write_units(out, self.units, self.digits, spelling);
    }
}

impl std::fmt::Display for Decimal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut out = Vec::new();
        self.write(&mut out, Spelling::PLAIN);
        f.write_str(std::str::from_utf8(&out).unwrap_or_default())
    }
}

/// Why a number could not be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NumberError {
    /// There is no digit.
    #[error("a number is missing")]
    Missing,
    /// More digits than any control takes.
    #[error("the number has too many digits")]
    TooLong,
}

/// Reads `[sign] digits [. digits]` at the start of `text` and gives it with the length read.
///
/// A comma is a decimal point where `comma` says so. No exponent: that is spelled differently on every control.
///
/// # Errors
/// There is no digit, or there are more than a decimal holds.
#[inline]
pub fn read_decimal(text: &[u8], comma: bool) -> Result<(Decimal, usize), NumberError> {
    let scanned = scan(text, comma);
    if scanned.count == 0 {
        return Err(NumberError::Missing);
    }
    let (mut units, mut digits) = (scanned.mantissa, scanned.fraction);
    if MOST_EXACT < scanned.count {
        // Zeros before a number and behind a fraction cost nothing.
        (units, digits) = significant(&text[..scanned.length]).ok_or(NumberError::TooLong)?;
    }
    let units = units as i64; // below 10¹⁸: at most 18 digits
    let signed = if scanned.negative { -units } else { units };
    Ok((Decimal::new(signed, digits as u8), scanned.length))
}

/// `[sign] digits [. digits]` at the start of a text, as far as it goes.
#[derive(Clone, Copy, Debug)]
pub struct Scanned {
    /// Whether the sign is a minus.
    pub negative: bool,
    /// All digits as one number. It holds as long as `count` is at most [`MOST_EXACT`].
    pub mantissa: u64,
    /// How many digits there are; without one there is no number.
    pub count: usize,
    /// How many of them stand behind the point.
    pub fraction: usize,
    /// How many bytes were read.
    pub length: usize,
}

/// So many digits are below 10¹⁸ whatever they are.
pub const MOST_EXACT: usize = 18;

/// Scans `[sign] digits [. digits]`; a comma is a decimal point where `comma` says so.
#[inline]
pub fn scan(text: &[u8], comma: bool) -> Scanned {
    let negative = text.first() == Some(&b'-');
    let sign = usize::from(matches!(text.first(), Some(b'-' | b'+')));
    let (whole, mut mantissa) = digits(&text[sign..], 0);
    let (mut length, mut fraction) = (sign + whole, 0);
    let point = text.get(length);
    if point == Some(&b'.') || (comma && point == Some(&b',')) {
        (fraction, mantissa) = digits(&text[length + 1..], mantissa);
        length += 1 + fraction;
    }
    Scanned { negative, mantissa, count: whole + fraction, fraction, length }
}

/// How many digits a text begins with, and the number that they are behind those of `number`; it holds as long as these are
/// at most [`MOST_EXACT`].
#[inline]
pub fn digits(text: &[u8], mut number: u64) -> (usize, u64) {
    for (count, byte) in text.iter().enumerate() {
        let digit = byte.wrapping_sub(b'0');
        if 9 < digit {
            return (count, number);
        }
        number = number.wrapping_mul(10).wrapping_add(u64::from(digit));
    }
    (text.len(), number)
}

/// The digits of a number that matter, and how many of them stand behind the point; none where these are too many.
#[cold]
fn significant(number: &[u8]) -> Option<(u64, usize)> {
    let point = number.iter().position(|byte| matches!(byte, b'.' | b',')).unwrap_or(number.len());
    let (whole, fraction) = (&number[..point], number.get(point + 1..).unwrap_or_default());
    let zeros = fraction.iter().rev().take_while(|byte| **byte == b'0').count();
    let fraction = &fraction[..fraction.len() - zeros];
    let digits = || whole.iter().chain(fraction).filter(|byte| byte.is_ascii_digit());
    let leading = digits().take_while(|byte| **byte == b'0').count();
    let fits = digits().count() - leading <= MOST_EXACT && fraction.len() <= usize::from(MAX_DIGITS);
    fits.then(|| {
        let value = digits().fold(0u64, |value, byte| value * 10 + u64::from(byte - b'0'));
        (value, fraction.len())
    })
}

/// A bound in three figures, none of which is below it.
pub fn at_most(bound: f64) -> String {
    let text = format!("{bound:.2e}");
    if text.parse().is_ok_and(|told: f64| bound <= told) || !bound.is_finite() {
        return text;
    }
    let (figures, power) = text.split_once('e').unwrap_or((&text, "0"));
    let hundredths = figures.replace('.', "").parse::<u32>().unwrap_or_default() + 1;
    let power: i32 = power.parse().unwrap_or_default();
    let (hundredths, power) = if hundredths == 1000 { (100, power + 1) } else { (hundredths, power) };
    format!("{}.{:02}e{power}", hundredths / 100, hundredths % 100)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn text(x: f64, digits: u8) -> String {
        let mut out = Vec::new();
        write_units(&mut out, round_units(x, digits).unwrap(), digits, Spelling::PLAIN);
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn what_is_told_of_a_bound_is_not_below_it() {
        let told = [
            (4.123_106e-3, "4.13e-3"),
            (4.12e-3, "4.12e-3"),
            (9.991e-4, "1.00e-3"),
            (1.0, "1.00e0"),
            (0.0, "0.00e0"),
            (123.4, "1.24e2"),
            (f64::INFINITY, "inf"),
        ];
        for (bound, text) in told {
            assert_eq!(at_most(bound), text);
        }
        let mut bound = 1.0e-12;
        while bound < 1.0e3 {
            assert!(bound <= at_most(bound).parse::<f64>().unwrap(), "{bound}");
            bound *= 1.003_7;
        }
    }

    #[test]
    fn no_negative_zero_and_no_trailing_zeros() {
        assert_eq!(text(-0.000_000_1, 6), "0");
        assert_eq!(text(30.0, 6), "30");
        assert_eq!(text(-0.05, 4), "-0.05");
        assert_eq!(text(100.0, 0), "100");
    }

    #[test]
    fn ties_follow_the_exact_value_of_the_float() {
        assert_eq!(text(0.5, 0), "0");
        assert_eq!(text(1.5, 0), "2");
        // 1.005 is 1.00499999999999989…, 2.675 is 2.67499999999999982…
        assert_eq!(text(1.005, 2), "1");
        assert_eq!(text(2.675, 2), "2.67");
        assert!(round_units(f64::NAN, 3).is_none() && round_units(1e16, 0).is_none());
    }

    #[test]
    fn spelling_of_points_and_signs() {
        let mut out = Vec::new();
        write_units(
            &mut out,
            300_000,
            4,
            Spelling { point_always: true, sign_always: true, leading_zero: true },
        );
        out.push(b' ');
        write_units(&mut out, 0, 4, Spelling { point_always: true, sign_always: false, leading_zero: true });
        assert_eq!(out, b"+30. 0.");
    }

    #[test]
    fn numbers_are_read_exactly() {
        assert_eq!(read_decimal(b"-.50X", false), Ok((Decimal::new(-5, 1), 4)));
        assert_eq!(read_decimal(b"49.", false), Ok((Decimal::new(49, 0), 3)));
        assert_eq!(read_decimal(b"1,25", true), Ok((Decimal::new(125, 2), 4)));
        assert_eq!(read_decimal(b"-", false), Err(NumberError::Missing));
        assert_eq!(read_decimal(b"1234567890123456789012", false), Err(NumberError::TooLong));
        let zeros = b"1.0000000000000000000000000";
        assert_eq!(read_decimal(zeros, false), Ok((Decimal::new(1, 0), zeros.len())));
    }

    #[test]
    fn digits_that_do_not_matter_do_not_count() {
        assert_eq!(read_decimal(b"000000000000000000000012.5", false), Ok((Decimal::new(125, 1), 26)));
        assert_eq!(read_decimal(b"0.000000000000000001", false), Ok((Decimal::new(1, 18), 20)));
        assert_eq!(read_decimal(b"0.0000000000000000001", false), Err(NumberError::TooLong));
        assert_eq!(
            read_decimal(b"999999999999999999", false),
            Ok((Decimal::new(999_999_999_999_999_999, 0), 18))
        );
        assert_eq!(read_decimal(b"1000000000000000000", false), Err(NumberError::TooLong));
        assert_eq!(read_decimal(b"0,00000000000000000000", true), Ok((Decimal::ZERO, 22)));
        assert_eq!(read_decimal(b"+.", false), Err(NumberError::Missing));
    }

    proptest! {
        #[test]
        fn rounds_as_the_standard_library_prints(x in -1e5f64..1e5, digits in 0u8..=9) {
            let printed: f64 = format!("{x:.0$}", usize::from(digits)).parse().unwrap();
            let ours: f64 = text(x, digits).parse().unwrap();
            prop_assert_eq!(printed, ours);
        }

        #[test]
        fn rounds_near_ties_as_the_standard_library_prints(n in -100_000_000i64..100_000_000, digits in 0u8..=9, ulps in -2i64..=2) {
            let middle = (n as f64 + 0.5) / power_of_ten(digits) as f64;
            let x = f64::from_bits((middle.to_bits() as i64 + ulps) as u64);
            let printed: f64 = format!("{x:.0$}", usize::from(digits)).parse().unwrap();
            prop_assert_eq!(printed, text(x, digits).parse::<f64>().unwrap());
        }

        /// Any bytes, read one by one.
        #[test]
        fn a_number_is_what_its_bytes_say(text in "[+-]?[0-9]{0,12}[.,]?[0-9]{0,12}[A-Z ]?[0-9]{0,3}", comma: bool) {
            let bytes = text.as_bytes();
            let (mut at, mut value, mut count, mut fraction) = (0, 0u128, 0, 0);
            let mut point = false;
            if matches!(bytes.first(), Some(b'+' | b'-')) {
                at = 1;
            }
            while let Some(byte) = bytes.get(at) {
                if byte.is_ascii_digit() {
                    value = value * 10 + u128::from(byte - b'0');
                    count += 1;
                    fraction += usize::from(point);
                } else if !point && (*byte == b'.' || (comma && *byte == b',')) {
                    point = true;
                } else {
                    break;
                }
                at += 1;
            }
            let scanned = scan(bytes, comma);
            prop_assert_eq!((scanned.length, scanned.count, scanned.fraction), (at, count, fraction));
            prop_assert_eq!(scanned.negative, bytes.first() == Some(&b'-'));
            if count <= MOST_EXACT {
                prop_assert_eq!(u128::from(scanned.mantissa), value);
            }
        }

        /// Every spelling, against the digits as the standard library prints them.
        #[test]
        fn numbers_are_spelled_digit_by_digit(
            units in proptest::prop_oneof![proptest::num::i64::ANY, -2_000i64..2_000, -99_999_999i64..99_999_999],
            digits in 0u8..=18, point_always: bool, sign_always: bool, leading_zero: bool,
        ) {
            let spelling = Spelling { point_always, sign_always, leading_zero };
            let all = format!("{:0width$}", units.unsigned_abs(), width = usize::from(digits) + 1);
            let (whole, fraction) = all.split_at(all.len() - usize::from(digits));
            let fraction = fraction.trim_end_matches('0');
            let sign = if units < 0 { "-" } else if sign_always { "+" } else { "" };
            let whole = if whole == "0" && !leading_zero && !fraction.is_empty() { "" } else { whole };
            let point = if fraction.is_empty() && !point_always { "" } else { "." };
            let mut out = b"X".to_vec();
            write_units(&mut out, units, digits, spelling);
            prop_assert_eq!(String::from_utf8(out).unwrap(), format!("X{sign}{whole}{point}{fraction}"));
        }

        #[test]
        fn what_is_written_reads_back(units in -1_000_000_000_000i64..1_000_000_000_000, digits in 0u8..=9) {
            let mut out = Vec::new();
            write_units(&mut out, units, digits, Spelling::PLAIN);
            let (read, length) = read_decimal(&out, false).unwrap();
            prop_assert_eq!((read.units(digits), length), (Some(units), out.len()));
        }
    }
}
