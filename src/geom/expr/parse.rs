//! Text to expression.
//!
//! ```text
//! expression = term, { ( "+" | "-" ), term } ;
//! term = factor, { ( "*" | "/" ), factor } ;
//! factor = ( "+" | "-" ), factor | power ;
//! power = atom, [ "^", factor ] ;
//! atom = number | name, "(", expression, [ ",", expression ], ")" | name | "(", expression, ")" ;
//! ```
//!
//! So −u^2 is −(u²), 2^3^2 is 2⁹, and u^-2 is u⁻². Nothing is multiplied without a `*`.

use super::{Expression, FUNCTIONS, Op};
use nom::branch::alt;
use nom::bytes::complete::take_while;
use nom::character::complete::{char, digit1, one_of, satisfy};
use nom::combinator::{opt, recognize};
use nom::{IResult, Parser};
use std::ops::Range;

/// The deepest nesting of an expression.
const DEEPEST: usize = 64;

/// The most operations of an expression.
const LONGEST: usize = 2000;

/// The greatest whole exponent that is multiplied out.
const GREATEST_POWER: f64 = 64.0;

/// What is wrong with a text.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Wrong {
    /// Something else was expected.
    #[error("expected {0}")]
    Expected(&'static str),
    /// A name that is neither the parameter nor a constant.
    #[error("`{0}` is neither the parameter u nor a constant")]
    UnknownName(String),
    /// A name that is no function.
    #[error("`{0}` is not a function")]
    UnknownFunction(String),
    /// A function without its arguments.
    #[error("`{0}` is a function: its argument follows in brackets")]
    FunctionAlone(String),
    /// Too few or too many arguments.
    #[error("`{0}` takes {1}")]
    Arguments(String, &'static str),
    /// Too many brackets in brackets.
    #[error("the expression is nested too deep")]
    TooDeep,
    /// Too many operations.
    #[error("the expression is too long")]
    TooLong,
    /// A number beyond what a float holds.
    #[error("this number is too large")]
    NumberTooLarge,
}

/// What is wrong with a text, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ParseError {
    /// What.
    pub wrong: Wrong,
    /// Its bytes.
    pub span: Range<usize>,
}

/// A text as an expression in `u`, with named constants beside pi and e.
///
/// # Errors
/// See [`Wrong`].
pub fn parse(text: &str, constants: &[(String, f64)]) -> Result<Expression, ParseError> {
    let mut parser = Reader { text, at: 0, constants, ops: Vec::new() };
    parser.expression(0)?;
    parser.blanks();
    if parser.at < text.len() {
        return Err(parser.expected("an operator: + - * / ^"));
    }
    Ok(Expression { ops: parser.ops, text: text.to_owned() })
}

/// Whether a name can be a constant's: a letter, then letters, digits and `_`; not `u`, pi, e or a function.
pub fn is_constant_name(name: &str) -> bool {
    let known = ["u", "pi", "e", "atan2"];
    matches!(identifier(name), Ok(("", _)))
        && !known.contains(&name)
        && !FUNCTIONS.iter().any(|(function, _)| *function == name)
}

/// number = digits, [ ".", [ digits ] ], [ exponent ] | ".", digits, [ exponent ] ;
fn number(text: &str) -> IResult<&str, &str> {
    let exponent = || opt((one_of("eE"), opt(one_of("+-")), digit1));
    alt((
        recognize((digit1, opt((char('.'), opt(digit1))), exponent())),
        recognize((char('.'), digit1, exponent())),
    ))
    .parse(text)
}

/// name = letter, { letter | digit | "_" } ;
fn identifier(text: &str) -> IResult<&str, &str> {
    recognize((
        satisfy(|c| c.is_ascii_alphabetic()),
        take_while(|c: char| c.is_ascii_alphanumeric() || c == '_'),
    ))
    .parse(text)
}

struct Reader<'t> {
    text: &'t str,
    at: usize,
    constants: &'t [(String, f64)],
    ops: Vec<(Op, Range<usize>)>,
}

impl<'t> Reader<'t> {
    fn blanks(&mut self) {
        let rest = &self.text[self.at..];
        self.at = self.text.len() - rest.trim_start().len();
    }

    fn rest(&mut self) -> &'t str {
        self.blanks();
        &self.text[self.at..]
    }

    /// The next character, if it is one of these.
    fn take(&mut self, some: &str) -> Option<char> {
        let next = self.rest().chars().next().filter(|c| some.contains(*c))?;
        self.at += next.len_utf8();
        Some(next)
    }

    fn expected(&mut self, what: &'static str) -> ParseError {
        let rest = self.rest();
        let length = rest.chars().next().map_or(0, char::len_utf8);
        ParseError { wrong: Wrong::Expected(what), span: self.at..self.at + length }
    }

    fn push(&mut self, op: Op, span: Range<usize>) -> Result<usize, ParseError> {
        if LONGEST <= self.ops.len() {
            return Err(ParseError { wrong: Wrong::TooLong, span });
        }
        self.ops.push((op, span));
        Ok(self.ops.len() - 1)
    }

    /// Where an operation starts.
    fn start(&self, op: usize) -> usize {
        self.ops[op].1.start
    }

    fn expression(&mut self, depth: usize) -> Result<usize, ParseError> {
        let mut left = self.term(depth)?;
        while let Some(sign) = self.take("+-") {
            let right = self.term(depth)?;
            let op = if sign == '+' { Op::Plus(left, right) } else { Op::Minus(left, right) };
            left = self.push(op, self.start(left)..self.at)?;
        }
        Ok(left)
    }

    fn term(&mut self, depth: usize) -> Result<usize, ParseError> {
        let mut left = self.factor(depth)?;
        while let Some(sign) = self.take("*/") {
            let right = self.factor(depth)?;
            let op = if sign == '*' { Op::Times(left, right) } else { Op::Over(left, right) };
            left = self.push(op, self.start(left)..self.at)?;
        }
        Ok(left)
    }

    fn factor(&mut self, depth: usize) -> Result<usize, ParseError> {
        self.blanks();
        let start = self.at;
        if DEEPEST < depth {
            return Err(ParseError { wrong: Wrong::TooDeep, span: start..start });
        }
        match self.take("+-") {
            Some('-') => {
                let of = self.factor(depth + 1)?;
                self.push(Op::Negative(of), start..self.at)
            }
            Some(_) => self.factor(depth + 1),
            None => self.power(depth),
        }
    }

    fn power(&mut self, depth: usize) -> Result<usize, ParseError> {
        let base = self.atom(depth)?;
        if self.take("^").is_none() {
            return Ok(base);
        }
        let before = self.ops.len();
        let exponent = self.factor(depth + 1)?;
        let span = self.start(base)..self.at;
        // An exponent without u is a number, and its operations are not needed any more.
        let own = Expression { ops: shifted(&self.ops[before..], before), text: String::new() };
        if !own.depends()
            && let Ok(value) = own.at(0.0)
        {
            self.ops.truncate(before);
            let whole = value.fract() == 0.0 && value.abs() <= GREATEST_POWER;
            let op = if whole { Op::WholePower(base, value as i32) } else { Op::RealPower(base, value) };
            return self.push(op, span);
        }
        self.push(Op::Power(base, exponent), span)
    }

    fn atom(&mut self, depth: usize) -> Result<usize, ParseError> {
        let rest = self.rest();
        let start = self.at;
        if let Ok((_, digits)) = number(rest) {
            self.at += digits.len();
            let value: f64 = digits.parse().unwrap_or(f64::INFINITY);
            if !value.is_finite() {
                return Err(ParseError { wrong: Wrong::NumberTooLarge, span: start..self.at });
            }
            return self.push(Op::Number(value), start..self.at);
        }
        if let Ok((_, name)) = identifier(rest) {
            self.at += name.len();
            return self.name(name, start, depth);
        }
        if self.take("(").is_some() {
            let inner = self.expression(depth + 1)?;
            if self.take(")").is_none() {
                return Err(self.expected("a closing bracket"));
            }
            return Ok(inner);
        }
        Err(self.expected("a number, u, a constant, a function or a bracket"))
    }

    /// A name that was just read: a function's with its arguments, or a number's.
    fn name(&mut self, name: &str, start: usize, depth: usize) -> Result<usize, ParseError> {
        let span = start..self.at;
        let wrong = |wrong: Wrong| Err(ParseError { wrong, span: span.clone() });
        let function = FUNCTIONS.iter().find(|(known, _)| *known == name).map(|(_, function)| *function);
        if self.take("(").is_none() {
            let value = match name {
                "u" => return self.push(Op::Parameter, span),
                "pi" => Some(std::f64::consts::PI),
                "e" => Some(std::f64::consts::E),
                _ => self.constants.iter().find(|(known, _)| known == name).map(|(_, value)| *value),
            };
            return match value {
                Some(value) => self.push(Op::Number(value), span),
                None if function.is_some() || name == "atan2" => wrong(Wrong::FunctionAlone(name.to_owned())),
                None => wrong(Wrong::UnknownName(name.to_owned())),
            };
        }
        if function.is_none() && name != "atan2" {
            return wrong(Wrong::UnknownFunction(name.to_owned()));
        }
        let first = self.expression(depth + 1)?;
        let second = match self.take(",") {
            Some(_) => Some(self.expression(depth + 1)?),
            None => None,
        };
        if self.take(")").is_none() {
            return Err(self.expected("a closing bracket"));
        }
        match (function, second) {
            (Some(function), None) => self.push(Op::Call(function, first), start..self.at),
            (None, Some(second)) => self.push(Op::Atan2(first, second), start..self.at),
            (Some(_), Some(_)) => wrong(Wrong::Arguments(name.to_owned(), "one argument")),
            (None, None) => wrong(Wrong::Arguments(name.to_owned(), "two arguments, y and x")),
        }
    }
}

/// The last operations of a list as a list of their own.
fn shifted(ops: &[(Op, Range<usize>)], by: usize) -> Vec<(Op, Range<usize>)> {
    let shift = |op: Op| match op {
        Op::Number(_) | Op::Parameter => op,
        Op::Negative(a) => Op::Negative(a - by),
        Op::Plus(a, b) => Op::Plus(a - by, b - by),
        Op::Minus(a, b) => Op::Minus(a - by, b - by),
        Op::Times(a, b) => Op::Times(a - by, b - by),
        Op::Over(a, b) => Op::Over(a - by, b - by),
        Op::WholePower(a, n) => Op::WholePower(a - by, n),
        Op::RealPower(a, r) => Op::RealPower(a - by, r),
        Op::Power(a, b) => Op::Power(a - by, b - by),
        Op::Call(function, a) => Op::Call(function, a - by),
        Op::Atan2(a, b) => Op::Atan2(a - by, b - by),
    };
    ops.iter().map(|(op, span)| (shift(*op), span.clone())).collect()
}
