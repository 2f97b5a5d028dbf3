//! The words of Klartext blocks as written, one parser for each rule of `grammar/heidenhain.ebnf`.

use crate::decimal::{Decimal, MAX_DIGITS, power_of_ten, read_decimal};
use crate::geom::arc::Sense;
use nom::branch::alt;
use nom::bytes::complete::{tag, take_while1};
use nom::character::complete::{char, digit1, one_of, space0};
use nom::combinator::{map_res, opt, recognize, value};
use nom::error::{Error, ErrorKind};
use nom::sequence::{pair, preceded};
use nom::{IResult, Parser};

/// Decimals of a coefficient behind this one are cut: 10⁻¹² mm, where a control keeps nine digits and CAM systems print
/// zeros as 1.78E-015.
const COEFFICIENT_DIGITS: u8 = 12;

/// One word of a block.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Word<'t> {
    /// `X+30`
    Coordinate(u8, Decimal),
    /// `IA+12`
    Step(u8, Decimal),
    /// `IPA+360`
    Turn(Decimal),
    /// `FQ1`
    FeedParameter(u32),
    /// `K3X-4.688E-002`: which K, its axis, and its value where it can be held
    Coefficient(usize, u8, Option<Decimal>),
    /// `TX+0.1`: which component of the tool's direction
    Direction(usize, Decimal),
    /// `F200`
    Feed(Decimal),
    /// `FMAX`
    Rapid,
    /// `R0`
    Uncompensated,
    /// `DR+`, counter-clockwise
    Rotation(Sense),
    /// Anything else.
    Other(&'t str),
}

/// `word = coordinate | coefficient | direction | feed | feed_parameter | rapid | step | turn | compensation | rotation`, or [`other`]
#[inline]
pub(super) fn word(input: &str) -> IResult<&str, Word<'_>> {
    alt((
        coordinate.map(|(letter, value)| Word::Coordinate(letter, value)),
        coefficient,
        direction,
        feed,
        feed_parameter,
        rapid,
        step,
        turn,
        compensation,
        rotation,
        other,
    ))
    .parse(input)
}

/// `direction = "T", ( "X" | "Y" | "Z" ), number`
fn direction(input: &str) -> IResult<&str, Word<'_>> {
    let (rest, letter) = preceded(char('T'), one_of("XYZ")).parse(input)?;
    let (rest, value) = number(rest)?;
    Ok((rest, Word::Direction(letter as usize - 'X' as usize, value)))
}

/// `feed_parameter = "FQ", digits`
fn feed_parameter(input: &str) -> IResult<&str, Word<'_>> {
    preceded(tag("FQ"), map_res(digit1, str::parse)).map(Word::FeedParameter).parse(input)
}

/// `turn = "IPA", number`
fn turn(input: &str) -> IResult<&str, Word<'_>> {
    preceded(tag("IPA"), number).map(Word::Turn).parse(input)
}

/// `step = "I", ( wrapping_axis | "Z" ), number`, or another axis
fn step(input: &str) -> IResult<&str, Word<'_>> {
    preceded(char('I'), (axis, number)).map(|(letter, value)| Word::Step(letter, value)).parse(input)
}

fn failed(input: &str) -> nom::Err<Error<&str>> {
    nom::Err::Error(Error::new(input, ErrorKind::Fail))
}

/// `axis = "X" | "Y" | "Z" | "U" | "V" | "W" | "A" | "B" | "C"`
#[inline]
fn axis(input: &str) -> IResult<&str, u8> {
    match input.as_bytes().first() {
        // The letter is ASCII, so that the rest begins at 1.
        Some(&letter @ (b'U'..=b'Z' | b'A'..=b'C')) => Ok((&input[1..], letter)),
        _ => Err(failed(input)),
    }
}

/// `number = [ "+" | "-" ], ( digits, [ mark, [ digits ] ] | mark, digits )` with `mark = "." | ","`
#[inline]
fn number(input: &str) -> IResult<&str, Decimal> {
    let (value, length) = read_decimal(input.as_bytes(), true).map_err(|_| failed(input))?;
    Ok((&input[length..], value))
}

/// `coordinate = axis, number`
#[inline]
pub(super) fn coordinate(input: &str) -> IResult<&str, (u8, Decimal)> {
    let (rest, letter) = axis(input)?;
    let (rest, value) = number(rest)?;
    Ok((rest, (letter, value)))
}

/// `coefficient = "K", ( "3" | "2" | "1" ), axis, number, [ exponent ]`
fn coefficient(input: &str) -> IResult<&str, Word<'_>> {
    let (rest, (which, letter)) = (preceded(char('K'), one_of("321")), axis).parse(input)?;
    let (rest, (value, exponent)) = (number, opt(exponent)).parse(rest)?;
    let power = which as usize - '0' as usize;
    Ok((rest, Word::Coefficient(power, letter, scaled(value, exponent.unwrap_or(0)))))
}

/// `exponent = { blank }, "E", [ "+" | "-" ], digits`
fn exponent(input: &str) -> IResult<&str, i32> {
    let sign_and_digits = recognize(pair(opt(one_of("+-")), digit1));
    let (rest, digits) = preceded((space0, char('E')), sign_and_digits).parse(input)?;
    let exponent = digits.parse().map_err(|_| failed(input))?;
    Ok((rest, exponent))
}

/// value · 10^exponent, where it can be held; decimals beyond [`COEFFICIENT_DIGITS`] are cut.
fn scaled(value: Decimal, exponent: i32) -> Option<Decimal> {
    if value.is_zero() {
        return Some(value);
    }
    let units = value.units(value.digits())?;
    let digits = i32::from(value.digits()).checked_sub(exponent)?;
    match u8::try_from(digits) {
        Ok(digits) => Some(cut(units, digits, COEFFICIENT_DIGITS)),
        Err(_) if digits < -i32::from(MAX_DIGITS) => None,
        // Between −18 and −1 here, or above 255 and nothing but zeros.
        Err(_) if digits < 0 => {
            units.checked_mul(power_of_ten(digits.unsigned_abs() as u8)).map(|units| Decimal::new(units, 0))
        }
        Err(_) => Some(Decimal::ZERO),
    }
}

/// `units` / 10^`digits` with at most `most` decimals; the others are cut.
pub(super) fn cut(units: i64, digits: u8, most: u8) -> Decimal {
    match digits.saturating_sub(most) {
        0 => Decimal::new(units, digits),
        beyond if MAX_DIGITS < beyond => Decimal::ZERO,
        beyond => Decimal::new(units / power_of_ten(beyond), most),
    }
}

/// `feed = "F", number`
fn feed(input: &str) -> IResult<&str, Word<'_>> {
    preceded(char('F'), number).map(Word::Feed).parse(input)
}

/// `rapid = "F", { blank }, "MAX"`
fn rapid(input: &str) -> IResult<&str, Word<'_>> {
    value(Word::Rapid, (char('F'), space0, tag("MAX"))).parse(input)
}

/// `compensation = "R0"`
fn compensation(input: &str) -> IResult<&str, Word<'_>> {
    value(Word::Uncompensated, tag("R0")).parse(input)
}

/// `rotation = "DR", ( "+" | "-" )`
fn rotation(input: &str) -> IResult<&str, Word<'_>> {
    let (rest, sign) = preceded(tag("DR"), one_of("+-")).parse(input)?;
    let sense = if sign == '+' { Sense::CounterClockwise } else { Sense::Clockwise };
    Ok((rest, Word::Rotation(sense)))
}

/// What is no word of the grammar, up to a blank or a comment: it is refused by name.
fn other(input: &str) -> IResult<&str, Word<'_>> {
    take_while1(|c: char| !c.is_whitespace() && c != ';').map(Word::Other).parse(input)
}

/// Whether a line begins with a coefficient, as `K3X`, and so belongs to the SPL before it.
pub(super) fn is_continuation(line: &str) -> bool {
    preceded((space0::<_, Error<&str>>, char('K'), one_of("321")), axis).parse(line).is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn k(text: &str) -> Option<Decimal> {
        match word(text) {
            Ok(("", Word::Coefficient(3, b'X', value))) => value,
            other => panic!("{text}: {other:?}"),
        }
    }

    #[test]
    fn exponents_have_many_spellings() {
        for text in [
            "K3X-4.688E-002",
            "K3X-4,688E-2",
            "K3X-4.688 E-02",
            "K3X-46.88E-3",
            "K3X-.04688",
            "K3X-0.0004688 E2",
        ] {
            assert_eq!(k(text), Some(Decimal::new(-4688, 5)), "{text}");
        }
        for text in ["K3X+1.2750 E2", "K3X1.275E+2", "K3X+127.5", "K3X127,5E+000"] {
            assert_eq!(k(text), Some(Decimal::new(1275, 1)), "{text}");
        }
    }

    #[test]
    fn the_smallest_are_cut_and_the_largest_refused() {
        assert_eq!(k("K3X+1.78000E-015"), Some(Decimal::ZERO));
        assert_eq!(k("K3X+1.23456789E-010"), Some(Decimal::new(123, 12)));
        assert_eq!(k("K3X-9.9E-255"), Some(Decimal::ZERO));
        assert_eq!(k("K3X+0.000E+255"), Some(Decimal::ZERO));
        assert_eq!(k("K3X+1E+18"), Some(Decimal::new(1_000_000_000_000_000_000, 0)));
        assert_eq!(k("K3X+1E+19"), None);
        assert_eq!(k("K3X+1E+255"), None);
    }

    #[test]
    fn words_end_where_the_next_begins() {
        assert_eq!(word("X+1,5Y2"), Ok(("Y2", Word::Coordinate(b'X', Decimal::new(15, 1)))));
        assert_eq!(word("F MAX M3"), Ok((" M3", Word::Rapid)));
        assert_eq!(word("FMAX"), Ok(("", Word::Rapid)));
        assert_eq!(word("F200.5;"), Ok((";", Word::Feed(Decimal::new(2005, 1)))));
        for text in ["RL", "M3", "FAUTO", "X+Q1", "K4X+1", "K3X", "E2", "x+1", "X+", "K3X+1.5E+99999999999"] {
            let first = word(text);
            assert!(matches!(first, Ok(("", Word::Other(_)) | ("E+99999999999", _))), "{text}: {first:?}");
        }
        assert_eq!(word("µ;x"), Ok((";x", Word::Other("µ"))));
    }

    #[test]
    fn lines_of_coefficients_continue_a_block() {
        assert!(is_continuation("  K3X+0") && is_continuation("K1Y-7") && is_continuation("\tK2A"));
        assert!(
            !is_continuation("27 SPL")
                && !is_continuation("K4X+0")
                && !is_continuation("KIY")
                && !is_continuation("")
        );
    }
}
