//! The first layer: words as written. Each function carries the name of its rule in `grammar/mazak.ebnf`, which has the
//! words that mean something here; letters and names without a meaning are taken too, to be refused by name.

use crate::decimal::{Decimal, read_decimal};
use nom::branch::alt;
use nom::bytes::complete::{tag, take_while, take_while1};
use nom::character::complete::{char, digit1, space0};
use nom::combinator::{map_res, recognize};
use nom::error::{Error, ErrorKind};
use nom::sequence::{delimited, preceded, terminated};
use nom::{IResult, Parser};

/// One word of a block.
#[derive(Debug, PartialEq)]
pub(super) enum Word<'t> {
    /// `X30.`
    Address(u8, Decimal),
    /// `X1=30.`
    Assignment(&'t str, Decimal),
    /// `F#101`
    FeedParameter(u32),
    /// `(FLUTE 1)`
    Remark(&'t str),
}

/// `word = address | remark | feed_parameter | assignment`
pub(super) fn word(input: &str) -> IResult<&str, Word<'_>> {
    let address = address.map(|(letter, value)| Word::Address(letter, value));
    alt((address, remark, feed_parameter, assignment)).parse(input)
}

/// `feed_parameter = "F#", digits`
fn feed_parameter(input: &str) -> IResult<&str, Word<'_>> {
    preceded(tag("F#"), map_res(digit1, str::parse)).map(Word::FeedParameter).parse(input)
}

/// `address = ( axis_letter | "F" | "I" | "J" | "K" | "P" | "R" ), number | "O", { "0" }, digit - "0", { digit } | code`, or another
/// letter; no `=` follows, since `X1=10.` is axis X1
#[inline]
pub(super) fn address(input: &str) -> IResult<&str, (u8, Decimal)> {
    let failed = || nom::Err::Error(Error::new(input, ErrorKind::Alpha));
    let letter = input.bytes().next().filter(u8::is_ascii_uppercase).ok_or_else(failed)?;
    let (rest, value) = number(&input[1..])?;
    if rest.trim_ascii_start().starts_with('=') {
        return Err(failed());
    }
    Ok((rest, (letter, value)))
}

/// `number = [ sign ], ( digits, [ ".", [ digits ] ] | ".", digits )`
#[inline]
fn number(input: &str) -> IResult<&str, Decimal> {
    let failed = |_| nom::Err::Error(Error::new(input, ErrorKind::Digit));
    let (value, length) = read_decimal(input.as_bytes(), false).map_err(failed)?;
    Ok((&input[length..], value))
}

/// `remark = "(", { character - ")" }, ")"`
fn remark(input: &str) -> IResult<&str, Word<'_>> {
    delimited(char('('), take_while(|c: char| c != ')'), char(')')).map(Word::Remark).parse(input)
}

/// `assignment = axis, { blank }, "=", { blank }, number`, or another name
fn assignment(input: &str) -> IResult<&str, Word<'_>> {
    (terminated(name, (space0, char('='), space0)), number)
        .map(|(name, value)| Word::Assignment(name, value))
        .parse(input)
}

/// A name: a capital letter, then letters and digits.
fn name(input: &str) -> IResult<&str, &str> {
    recognize((
        take_while1(|c: char| c.is_ascii_uppercase()),
        take_while(|c: char| c.is_ascii_alphanumeric()),
    ))
    .parse(input)
}
