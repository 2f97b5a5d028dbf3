//! The text of one instance becomes keywords and parameters. `grammar/step.ebnf` has the rules.

use nom::branch::alt;
use nom::bytes::complete::{is_not, tag, take_until, take_while, take_while1};
use nom::character::complete::{char, digit1, multispace1};
use nom::combinator::{cut, map, opt, recognize, value};
use nom::error::{Error, ErrorKind};
use nom::multi::{many0_count, many1, separated_list0};
use nom::sequence::{delimited, preceded};
use nom::{Err, IResult, Parser};

/// How deep lists may stand in each other; control points of surfaces have two.
const DEEPEST: usize = 8;

/// One parameter, and how much of the instance's text is left before and behind it.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter<'t> {
    /// What it is.
    pub value: Value<'t>,
    /// Bytes to the end of the text where it begins, and where it ends.
    pub(super) left: (usize, usize),
}

/// What a parameter is.
#[derive(Clone, Debug, PartialEq)]
pub enum Value<'t> {
    /// `1.5E-3`
    Number(f64),
    /// `'text'`, as it stands between its quotes.
    Text(&'t str),
    /// `.T.`
    Word(&'t str),
    /// `#12`
    Reference(u64),
    /// `(a,b)`
    List(Vec<Parameter<'t>>),
    /// `PARAMETER_VALUE(0.5)`
    Typed(Record<'t>),
    /// `$`
    Omitted,
    /// `*`
    Derived,
}

/// `KEYWORD(parameters)`
#[derive(Clone, Debug, PartialEq)]
pub struct Record<'t> {
    /// Its keyword.
    pub keyword: &'t str,
    /// What stands in its parentheses.
    pub parameters: Vec<Parameter<'t>>,
}

type Found<'t, T> = IResult<&'t str, T>;

/// `blanks = { blank | comment }`
fn blanks(input: &str) -> Found<'_, ()> {
    value((), many0_count(alt((multispace1, comment)))).parse(input)
}

/// `comment = "/*", { character - "*" }, "*/"`, in which a star may stand alone too.
fn comment(input: &str) -> Found<'_, &str> {
    delimited(tag("/*"), take_until("*/"), tag("*/")).parse(input)
}

/// A sign with blanks round it.
fn sign<'t>(c: char) -> impl Parser<&'t str, Output = char, Error = Error<&'t str>> {
    delimited(blanks, char(c), blanks)
}

/// `instance = blanks, reference, blanks, "=", blanks, ( record | complex ), blanks, ";"`
///
/// # Errors
/// The text begins with no instance.
pub fn instance(input: &str) -> Found<'_, (u64, Vec<Record<'_>>)> {
    let (input, ()) = blanks(input)?;
    let (input, number) = reference(input)?;
    let (input, _) = sign('=').parse(input)?;
    let (input, records) = alt((map(|input| record(input, 0), |one| vec![one]), complex)).parse(input)?;
    let (input, _) = preceded(blanks, char(';')).parse(input)?;
    Ok((input, (number, records)))
}

/// `complex = "(", blanks, record, { blanks, record }, blanks, ")"`
fn complex(input: &str) -> Found<'_, Vec<Record<'_>>> {
    delimited(sign('('), many1(delimited(blanks, |input| record(input, 0), blanks)), char(')')).parse(input)
}

/// `record = keyword, blanks, list`
fn record(input: &str, depth: usize) -> Found<'_, Record<'_>> {
    let (input, keyword) = keyword(input)?;
    let (input, ()) = blanks(input)?;
    let (input, parameters) = list(input, depth)?;
    Ok((input, Record { keyword, parameters }))
}

/// `keyword = [ "!" ], letter, { letter | digit | "_" }`
fn keyword(input: &str) -> Found<'_, &str> {
    let first = |input| take_while1(|c: char| c.is_ascii_alphabetic())(input);
    recognize((opt(char('!')), first, take_while(|c: char| c.is_ascii_alphanumeric() || c == '_')))
        .parse(input)
}

/// `list = "(", blanks, [ parameter, blanks, { ",", blanks, parameter, blanks } ], ")"`
fn list(input: &str, depth: usize) -> Found<'_, Vec<Parameter<'_>>> {
    if DEEPEST < depth {
        return Err(Err::Failure(Error::new(input, ErrorKind::TooLarge)));
    }
    let (input, _) = (char('('), blanks).parse(input)?;
    let (input, all) = separated_list0(sign(','), |input| parameter(input, depth)).parse(input)?;
    // Nothing else begins like this, so what is wrong is wrong here.
    let (input, _) = cut((blanks, char(')'))).parse(input)?;
    Ok((input, all))
}

/// `parameter = record | list | number | text | enumeration | reference | "$" | "*"`
fn parameter(input: &str, depth: usize) -> Found<'_, Parameter<'_>> {
    let left = input.len();
    let (input, value) = alt((
        map(number, Value::Number),
        map(reference, Value::Reference),
        map(text, Value::Text),
        map(enumeration, Value::Word),
        map(|input| list(input, depth + 1), Value::List),
        map(|input| record(input, depth + 1), Value::Typed),
        value(Value::Omitted, char('$')),
        value(Value::Derived, char('*')),
    ))
    .parse(input)?;
    Ok((input, Parameter { value, left: (left, input.len()) }))
}

/// `number = [ "+" | "-" ], digits, [ ".", [ digits ], [ exponent ] ]`
fn number(input: &str) -> Found<'_, f64> {
    let sign = |input| opt(alt((char('+'), char('-')))).parse(input);
    let (rest, written) =
        recognize((sign, digit1, opt((char('.'), opt(digit1), opt(exponent))))).parse(input)?;
    match written.parse() {
        Ok(x) => Ok((rest, x)),
        Err(_) => Err(Err::Error(Error::new(input, ErrorKind::Float))),
    }
}

/// `exponent = "E", [ "+" | "-" ], digits`, of which the letter may be small.
fn exponent(input: &str) -> Found<'_, &str> {
    recognize((alt((char('E'), char('e'))), opt(alt((char('+'), char('-')))), digit1)).parse(input)
}

/// `text = "'", { character - "'" | "''" }, "'"`
fn text(input: &str) -> Found<'_, &str> {
    let inner = recognize(many0_count(alt((is_not("'"), tag("''")))));
    delimited(char('\''), inner, char('\'')).parse(input)
}

/// `enumeration = ".", letter, { letter | digit | "_" }, "."`
fn enumeration(input: &str) -> Found<'_, &str> {
    delimited(char('.'), take_while1(|c: char| c.is_ascii_alphanumeric() || c == '_'), char('.')).parse(input)
}

/// `reference = "#", digits`
fn reference(input: &str) -> Found<'_, u64> {
    let (rest, digits) = preceded(char('#'), digit1).parse(input)?;
    match digits.parse() {
        Ok(number) => Ok((rest, number)),
        Err(_) => Err(Err::Error(Error::new(input, ErrorKind::Digit))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_of_every_kind() {
        let text = " #7 = ( A ( ) /* both */ B('it''s; fine',$,*,.T.,#3,(1,-2.E+1),LENGTH_MEASURE(2.54)) ) ;";
        let (rest, (number, records)) = instance(text).unwrap();
        assert_eq!((rest, number, records.len()), ("", 7, 2));
        let values: Vec<&Value<'_>> = records[1].parameters.iter().map(|p| &p.value).collect();
        assert_eq!(*values[0], Value::Text("it''s; fine"));
        assert_eq!((values[1], values[2], values[3]), (&Value::Omitted, &Value::Derived, &Value::Word("T")));
        let Value::List(list) = values[5] else { panic!("{:?}", values[5]) };
        assert_eq!(list[1].value, Value::Number(-20.0));
        let Value::Typed(record) = values[6] else { panic!("{:?}", values[6]) };
        assert_eq!(record.keyword, "LENGTH_MEASURE");
        for bad in
            ["#1=A(1,);", "#1=A(1", "#1=A(1)", "#x=A();", "#1=(A(1)B);", "#99999999999999999999999=A();"]
        {
            assert!(instance(bad).is_err(), "{bad}");
        }
        assert!(instance(&format!("#1=A({}{});", "(".repeat(5000), ")".repeat(5000))).is_err());
    }
}
