//! The words of a Sinumerik block, as written. Each function carries the name of its rule in `grammar/sinumerik.ebnf`, which
//! has the words that mean something here; letters and names without a meaning are taken too, to be refused by name.

use crate::decimal::{Decimal, read_decimal};
use nom::branch::alt;
use nom::bytes::complete::{tag, take_while, take_while1};
use nom::character::complete::{char, digit1, space0};
use nom::combinator::{map_res, opt, recognize};
use nom::error::{Error, ErrorKind};
use nom::multi::separated_list1;
use nom::sequence::{delimited, preceded, terminated};
use nom::{IResult, Parser};

/// One word of a block.
#[derive(Debug, PartialEq)]
pub(super) enum Word<'t> {
    /// `X30`, `X1=10`, `PL=30`
    Address(&'t str, Decimal),
    /// `F=R1`
    FeedParameter(u32),
    /// `A=DC(5)`
    Shortest(&'t str, Decimal),
    /// `I1=AC(5)`
    Way(&'t str, Decimal),
    /// `PO[X]=(30,0.36,-0.022)`, `X=PO(30,0.36)`; the denominator `PO[]=(2,1)` has no name
    Polynomial(&'t str, Vec<Decimal>),
    /// `SPLINEPATH(1,X,Y)`
    Call(&'t str, &'t str),
    /// `BSPLINE`
    Keyword(&'t str),
}

/// `word = address | polynomial | feed_parameter | shortest | way | assignment | call | keyword`
#[inline]
pub(super) fn word(input: &str) -> IResult<&str, Word<'_>> {
    let address = address.map(|(name, value)| Word::Address(name, value));
    alt((address, polynomial, feed_parameter, shortest, way, assignment, call, keyword)).parse(input)
}

/// `feed_parameter = "F", equals, "R", digits`
fn feed_parameter(input: &str) -> IResult<&str, Word<'_>> {
    preceded((char('F'), space0, char('='), space0, char('R')), map_res(digit1, str::parse))
        .map(Word::FeedParameter)
        .parse(input)
}

/// `shortest = wrapping_axis, equals, "DC(", item, ")"`, or another axis
fn shortest(input: &str) -> IResult<&str, Word<'_>> {
    let value = delimited((tag("DC("), space0), number, (space0, char(')')));
    (terminated(name, (space0, char('='), space0)), value)
        .map(|(axis, value)| Word::Shortest(axis, value))
        .parse(input)
}

/// `way = ( "I1" | "J1" | "K1" ), equals, "AC(", item, ")"`, or another name
fn way(input: &str) -> IResult<&str, Word<'_>> {
    let value = delimited((tag("AC("), space0), number, (space0, char(')')));
    (terminated(name, (space0, char('='), space0)), value)
        .map(|(name, value)| Word::Way(name, value))
        .parse(input)
}

/// `address = ( axis_letter | "F" | "I" | "J" | "K" ), number | code`, or another letter; no `=` follows, since `X1=10` is axis X1
#[inline]
pub(super) fn address(input: &str) -> IResult<&str, (&str, Decimal)> {
    let failed = || Err(nom::Err::Error(Error::new(input, ErrorKind::Alpha)));
    let bytes = input.as_bytes();
    if !bytes.first().is_some_and(u8::is_ascii_alphabetic) {
        return failed();
    }
    let (rest, value) = number(&input[1..])?;
    if rest.trim_ascii_start().starts_with('=') {
        return failed();
    }
    Ok((rest, (&input[..1], value)))
}

/// `number = [ sign ], ( digits, [ ".", [ digits ] ] | ".", digits ), [ exponent ]`
#[inline]
fn number(input: &str) -> IResult<&str, Decimal> {
    let failed = || nom::Err::Error(Error::new(input, ErrorKind::Digit));
    let (value, length) = read_decimal(input.as_bytes(), false).map_err(|_| failed())?;
    let rest = &input[length..];
    if !rest.starts_with("EX") {
        return Ok((rest, value));
    }
    let (rest, exponent) = exponent(rest)?;
    scaled(value, exponent).map(|value| (rest, value)).ok_or_else(failed)
}

/// `exponent = "EX", [ "-" ], digits`
#[cold]
fn exponent(input: &str) -> IResult<&str, i32> {
    preceded(tag("EX"), map_res(recognize((opt(char('-')), digit1)), str::parse)).parse(input)
}

/// value · 10^exponent, where it can be held.
fn scaled(mut value: Decimal, exponent: i32) -> Option<Decimal> {
    for _ in 0..exponent.clamp(0, 30) {
        value = value.times(10)?;
    }
    for _ in 0..(-exponent).clamp(0, 30) {
        let digits = value.digits() + 1;
        value = Decimal::new(value.units(digits - 1)?, digits);
        if crate::decimal::MAX_DIGITS < digits {
            return None;
        }
    }
    Some(value)
}

/// A name: a letter or `_`, then letters, digits and `_`.
fn name(input: &str) -> IResult<&str, &str> {
    recognize((
        take_while1(|c: char| c.is_ascii_alphabetic() || c == '_'),
        take_while(|c: char| c.is_ascii_alphanumeric() || c == '_'),
    ))
    .parse(input)
}

/// `list = "(", item, 4 * [ ",", item ], ")"` with `item = { blank }, number, { blank }`; or more of them
fn list(input: &str) -> IResult<&str, Vec<Decimal>> {
    let item = delimited(space0, number, space0);
    delimited(char('('), separated_list1(char(','), item), char(')')).parse(input)
}

/// `polynomial = "PO[", [ axis | second ], "]", equals, list | ( axis | second ), equals, "PO", list`, or another name; without an axis it is the
/// denominator
fn polynomial(input: &str) -> IResult<&str, Word<'_>> {
    let old =
        (delimited(tag("PO["), alt((name, tag(""))), char(']')), preceded((space0, char('='), space0), list));
    let new = (terminated(name, (space0, char('='), space0, tag("PO"))), list);
    alt((old, new)).map(|(axis, values)| Word::Polynomial(axis, values)).parse(input)
}

/// `assignment = ( axis | "F" | "I" | "J" | "K" | "PL" | "PW" | component | second ), equals, number | "SD", equals, ( "2" | "3" )
///     | "TURN", equals, digits`, or another name or value
fn assignment(input: &str) -> IResult<&str, Word<'_>> {
    let (rest, (name, value)) = (terminated(name, (space0, char('='), space0)), number).parse(input)?;
    Ok((rest, Word::Address(name, value)))
}

/// `call = "SPLINEPATH(", { blank }, "1", { comma, axis }, { blank }, ")"
///      | "FGROUP(", { blank }, [ linear_axis, { comma, linear_axis }, { blank } ], ")"`, or another name or arguments
fn call(input: &str) -> IResult<&str, Word<'_>> {
    let arguments = delimited(char('('), take_while(|c: char| !matches!(c, ')' | ';')), char(')'));
    (name, arguments).map(|(name, arguments)| Word::Call(name, arguments)).parse(input)
}

/// `keyword = motion | path_reference | end_condition | orientation | "COMPOF" | "SOFT" | "TRAFOOF" | "TRANS"`, or another name
fn keyword(input: &str) -> IResult<&str, Word<'_>> {
    name.map(Word::Keyword).parse(input)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one(text: &str) -> Word<'_> {
        let (rest, word) = word(text).unwrap_or_else(|e| panic!("{text}: {e}"));
        assert_eq!(rest, "", "{text}");
        word
    }

    #[test]
    fn each_kind_of_word() {
        let n = |units, digits| Decimal::new(units, digits);
        assert_eq!(one("X-.25"), Word::Address("X", n(-25, 2)));
        assert_eq!(one("X1=10"), Word::Address("X1", n(10, 0)));
        assert_eq!(one("X=10."), Word::Address("X", n(10, 0)));
        assert_eq!(one("PL=2.78157"), Word::Address("PL", n(278_157, 5)));
        assert_eq!(
            one("PO[X]=(30, 0.36,-0.022)"),
            Word::Polynomial("X", vec![n(30, 0), n(36, 2), n(-22, 3)])
        );
        assert_eq!(one("X=PO(30,1)"), Word::Polynomial("X", vec![n(30, 0), n(1, 0)]));
        assert_eq!(one("SPLINEPATH(1,X,Y)"), Word::Call("SPLINEPATH", "1,X,Y"));
        assert_eq!(one("BSPLINE"), Word::Keyword("BSPLINE"));
        assert_eq!(one("X=-.1EX-3"), Word::Address("X", n(-1, 4)));
    }

    #[test]
    fn what_is_no_word_is_refused() {
        for text in ["=3", "(3)", "[", "\u{e4}"] {
            assert!(word(text).is_err(), "{text}");
        }
    }
}
