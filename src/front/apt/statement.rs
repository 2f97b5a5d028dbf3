//! The second layer: the text of a record becomes a major word and arguments. `grammar/apt.ebnf` has the rules.
//!
//! ```text
//! SPINDL/ 2546.4790,RPM,CLW              a word, numbers and words
//! TOOLNO/1,20.0,3.0,,120.0               an argument may be empty
//! TLON,GOFWD/(CIRCLE/0,0,0,5),ON,…       a group is a statement in parentheses
//! N0,XT= 10.0,YT= 0.0,DK= 0.0,W= 1.0;    assignments
//! ```
//!
//! Blanks may stand anywhere but in numbers. A number may have the exponents E and D.

use super::records::MAX_RECORD;
use crate::decimal::{self, MOST_EXACT};
use nom::IResult;
use nom::bytes::complete::take_while;
use nom::character::complete::char;
use nom::error::{Error, ErrorKind};
use nom::sequence::delimited;
use nom::{Err, Parser};
use std::ops::Range;

/// How deep groups may stand in each other; the deepest seen is four (`TLON` with a cylinder).
const MAX_DEPTH: usize = 12;

/// One argument and where it stands in the record's text.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Placed<'r> {
    /// What it is.
    pub(super) argument: Argument<'r>,
    /// Where.
    pub(super) range: Range<usize>,
}

/// One argument.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Argument<'r> {
    /// Nothing between two commas.
    Empty,
    /// `-.625000`
    Number(f64),
    /// `RPM`, `1STPECK`
    Word(&'r str),
    /// `'text'`
    Quoted(&'r str),
    /// `XT= 10.0`
    Assigned(&'r str, f64),
    /// `AXIS=VAR`; AXIS=0,0,1 is an assignment of a number and two numbers after it.
    AssignedWord(&'r str, &'r str),
    /// `(CIRCLE/0,0,0,5)`
    Group(Statement<'r>),
}

impl<'r> Argument<'r> {
    /// Its number, where it is one.
    pub(super) fn number(&self) -> Option<f64> {
        if let Argument::Number(x) = self { Some(*x) } else { None }
    }

    /// Its word, where it is one.
    pub(super) fn word(&self) -> Option<&'r str> {
        if let Argument::Word(word) = self { Some(word) } else { None }
    }

    /// Its group, where it is one.
    pub(super) fn group(&self) -> Option<&Statement<'r>> {
        if let Argument::Group(group) = self { Some(group) } else { None }
    }

    /// Its number, where it is an assignment to `name`.
    pub(super) fn assigned(&self, name: &str) -> Option<f64> {
        match self {
            Argument::Assigned(known, value) if known.eq_ignore_ascii_case(name) => Some(*value),
            Argument::Empty
            | Argument::Number(_)
            | Argument::Word(_)
            | Argument::Quoted(_)
            | Argument::Assigned(..)
            | Argument::AssignedWord(..)
            | Argument::Group(_) => None,
        }
    }
}

/// A major word and its arguments.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Statement<'r> {
    /// The word as written, without blanks round it; empty where a group has none.
    pub(super) major: &'r str,
    /// The arguments.
    pub(super) arguments: Vec<Placed<'r>>,
}

/// Where in a record's text a statement stops making sense.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Unreadable {
    /// Bytes from its start.
    pub(super) at: usize,
}

/// Reads the text of a record.
pub(super) fn parse(text: &str) -> Result<Statement<'_>, Unreadable> {
    let parser = Text { whole: text };
    match parser.statement(text, 0) {
        Ok((rest, statement)) => {
            let rest = rest.trim_ascii_start();
            let rest = rest.strip_prefix(';').unwrap_or(rest).trim_ascii_start();
            if rest.is_empty() { Ok(statement) } else { Err(Unreadable { at: text.len() - rest.len() }) }
        }
        Err(Err::Error(error) | Err::Failure(error)) => {
            Err(Unreadable { at: text.len() - error.input.len() })
        }
        Err(Err::Incomplete(_)) => Err(Unreadable { at: text.len() }),
    }
}

/// A line that is `GOTO/` and one to six numbers, the statement of which there are millions.
pub(super) struct Goto {
    numbers: [f64; 6],
    count: usize,
    /// Where it stands in the text, without the blanks round it.
    pub(super) place: Range<usize>,
    /// Where its line ends.
    pub(super) end: usize,
}

impl Goto {
    /// The numbers.
    pub(super) fn numbers(&self) -> &[f64] {
        &self.numbers[..self.count]
    }
}

/// The first line of a text, where it is `GOTO/` and numbers.
#[inline]
pub(super) fn goto(text: &str) -> Option<Goto> {
    let statement = past_blanks(text);
    if !statement.as_bytes().get(..4)?.eq_ignore_ascii_case(b"GOTO") {
        return None;
    }
    let mut rest = past_blanks(&statement[4..]).strip_prefix('/')?;
    let (mut numbers, mut count) = ([0.0; 6], 0);
    loop {
        let (after, value) = number(past_blanks(rest)).ok()?;
        *numbers.get_mut(count)? = value;
        count += 1;
        rest = past_blanks(after);
        match rest.as_bytes().first() {
            Some(b',') => rest = &rest[1..],
            None | Some(b'\n') => {
                let place = text.len() - statement.len()..text.len() - after.len();
                let fits = place.len() <= MAX_RECORD;
                return fits.then(|| Goto { numbers, count, place, end: text.len() - rest.len() });
            }
            Some(_) => return None,
        }
    }
}

/// What stands behind the blanks at the start of a text, in the same line.
#[inline]
fn past_blanks(text: &str) -> &str {
    let is_blank = |byte: &u8| *byte != b'\n' && byte.is_ascii_whitespace();
    &text[text.bytes().take_while(is_blank).count()..]
}

fn fail<T>(at: &str) -> IResult<&str, T> {
    Err(Err::Error(Error::new(at, ErrorKind::Verify)))
}

/// `number = [ sign ], ( digits, [ ".", [ digits ] ] | ".", digits ), [ exponent ]`
#[inline]
pub(super) fn number(input: &str) -> IResult<&str, f64> {
    let bytes = input.as_bytes();
    let scanned = decimal::scan(bytes, false);
    // The library also reads `inf` and `nan`; a CL number has digits.
    if scanned.count == 0 {
        return fail(input);
    }
    // A short decimal is the quotient of two floats that are exact, and a quotient is rounded once: the nearest float.
    let ends = !matches!(bytes.get(scanned.length), Some(b'E' | b'e' | b'D' | b'd'));
    if ends && scanned.count <= MOST_EXACT && scanned.mantissa < 1 << 53 {
        let value = decimal::units_to_f64(scanned.mantissa as i64, scanned.fraction as u8);
        return Ok((&input[scanned.length..], if scanned.negative { -value } else { value }));
    }
    long_number(input)
}

/// A number of more digits than a float holds, or with an exponent.
#[cold]
fn long_number(input: &str) -> IResult<&str, f64> {
    let bytes = input.as_bytes();
    let Ok((value, length)) = fast_float2::parse_partial::<f64, _>(bytes) else { return fail(input) };
    if matches!(bytes.get(length), Some(b'D' | b'd')) {
        return number_d(input, length);
    }
    Ok((&input[length..], value))
}

/// Whether a number ends here: before a separator or the end.
fn is_separated(rest: &str) -> bool {
    matches!(rest.trim_ascii_start().as_bytes().first(), None | Some(b',' | b'/' | b')' | b';'))
}

/// A number whose exponent is spelled with D, as Fortran does.
fn number_d(input: &str, mantissa: usize) -> IResult<&str, f64> {
    let after = &input.as_bytes()[mantissa + 1..];
    let sign = usize::from(matches!(after.first(), Some(b'+' | b'-')));
    let digits = after[sign..].iter().take_while(|b| b.is_ascii_digit()).count();
    if digits == 0 {
        return fail(&input[mantissa..]);
    }
    let end = mantissa + 1 + sign + digits;
    let text = input[..end].replacen(['D', 'd'], "E", 1);
    match fast_float2::parse::<f64, _>(&text) {
        Ok(value) => Ok((&input[end..], value)),
        Err(_) => fail(input),
    }
}

/// `word = { digit }, letter, { letter | digit | "_" }`, and whatever else stands up to a separator
fn word(input: &str) -> IResult<&str, &str> {
    let end = input.find([',', '/', '=', '(', ')', ';', '\'', '$']).unwrap_or(input.len());
    let word = input[..end].trim_ascii_end();
    if word.is_empty() || word.bytes().any(|b| b.is_ascii_control() && b != b'\t') {
        return fail(input);
    }
    Ok((&input[word.len()..], word))
}

/// `quoted = "'", { character - "'" }, "'"`
fn quoted(input: &str) -> IResult<&str, &str> {
    delimited(char('\''), take_while(|c| c != '\''), char('\'')).parse(input)
}

/// `major = letter, { letter | digit | "_" | "-" | blank }`; blanks at its end are not part of it
fn major(input: &str) -> IResult<&str, &str> {
    if !input.starts_with(|c: char| c.is_ascii_alphabetic()) {
        return fail(input);
    }
    let in_word = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '-' | ' ' | '\t');
    let (rest, word) = take_while(in_word).parse(input)?;
    Ok((rest, word.trim_ascii_end()))
}

struct Text<'r> {
    whole: &'r str,
}

impl<'r> Text<'r> {
    fn at(&self, rest: &str) -> usize {
        self.whole.len() - rest.len()
    }

    /// `statement = major, { blank }, [ ( "/" | "," ), { blank }, arguments | group ]`
    fn statement(&self, input: &'r str, depth: usize) -> IResult<&'r str, Statement<'r>> {
        let (rest, major) = major(input)?;
        let rest = rest.trim_ascii_start();
        if let Some(after) = rest.strip_prefix(['/', ',']) {
            let (rest, arguments) = self.arguments(after, depth)?;
            return Ok((rest, Statement { major, arguments }));
        }
        if rest.starts_with('(') {
            let (after, argument) = self.group(rest, depth)?;
            let range = self.at(rest)..self.at(after);
            return Ok((after, Statement { major, arguments: vec![Placed { argument, range }] }));
        }
        Ok((rest, Statement { major, arguments: Vec::new() }))
    }

    /// `arguments = [ argument ], { { blank }, ( "," | "/" ), { blank }, [ argument ] }`; nothing at all is no argument
    fn arguments(&self, input: &'r str, depth: usize) -> IResult<&'r str, Vec<Placed<'r>>> {
        let mut arguments = Vec::with_capacity(4);
        let mut rest = input.trim_ascii_start();
        if rest.is_empty() {
            return Ok((rest, arguments));
        }
        loop {
            let (after, placed) = self.argument(rest, depth)?;
            arguments.push(placed);
            rest = after.trim_ascii_start();
            match rest.strip_prefix([',', '/']) {
                Some(after) => rest = after.trim_ascii_start(),
                None => return Ok((rest, arguments)),
            }
        }
    }

    /// `argument = number | assignment | quoted | group`
    fn argument(&self, input: &'r str, depth: usize) -> IResult<&'r str, Placed<'r>> {
        let placed = |rest: &'r str, argument| {
            let range = self.at(input)..self.at(rest);
            Ok((rest, Placed { argument, range }))
        };
        match input.as_bytes().first() {
            None | Some(b',' | b'/' | b')' | b';') => placed(input, Argument::Empty),
            Some(b'(') => {
                let (rest, argument) = self.group(input, depth)?;
                placed(rest, argument)
            }
            Some(b'\'') => {
                let (rest, text) = quoted(input)?;
                placed(rest, Argument::Quoted(text))
            }
            Some(_) => {
                if let Ok((rest, value)) = number(input) {
                    // `1STPECK` begins with a digit and is a word.
                    if is_separated(rest) {
                        return placed(rest, Argument::Number(value));
                    }
                    let next = rest.trim_ascii_start().as_bytes().first();
                    if matches!(next, Some(b'.' | b'+' | b'-' | b'0'..=b'9')) {
                        return fail(rest);
                    }
                }
                self.assignment(input)
            }
        }
    }

    /// `assignment = word, [ { blank }, "=", { blank }, ( number | word ) ]`
    fn assignment(&self, input: &'r str) -> IResult<&'r str, Placed<'r>> {
        let (rest, name) = word(input)?;
        let Some(value) = rest.trim_ascii_start().strip_prefix('=') else {
            let range = self.at(input)..self.at(rest);
            return Ok((rest, Placed { argument: Argument::Word(name), range }));
        };
        let value = value.trim_ascii_start();
        let (rest, argument) = match number(value) {
            Ok((rest, x)) if is_separated(rest) => (rest, Argument::Assigned(name, x)),
            Ok(_) | Err(_) => {
                let (rest, text) = word(value)?;
                (rest, Argument::AssignedWord(name, text))
            }
        };
        let range = self.at(input)..self.at(rest);
        Ok((rest, Placed { argument, range }))
    }

    /// `group = "(", { blank }, ( statement | arguments ), { blank }, ")"`
    fn group(&self, input: &'r str, depth: usize) -> IResult<&'r str, Argument<'r>> {
        if MAX_DEPTH <= depth {
            return fail(input);
        }
        let (rest, _) = char('(')(input)?;
        let rest = rest.trim_ascii_start();
        // `D=3,F=100` has no major word; `CIRCLE/…` has.
        let named = major(rest).is_ok_and(|(after, _)| !after.starts_with(['=', ',', '.']));
        let (rest, statement) = if named {
            self.statement(rest, depth + 1)?
        } else {
            let (rest, arguments) = self.arguments(rest, depth + 1)?;
            (rest, Statement { major: "", arguments })
        };
        let (rest, _) = char(')')(rest.trim_ascii_start())?;
        Ok((rest, Argument::Group(statement)))
    }
}

impl Statement<'_> {
    /// The numbers where every argument is one.
    pub(super) fn numbers(&self) -> Option<Vec<f64>> {
        self.arguments.iter().map(|placed| placed.argument.number()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::Argument::*;
    use super::*;

    /// The arguments without their places.
    fn plain<'r>(statement: &Statement<'r>) -> Vec<Argument<'r>> {
        statement.arguments.iter().map(|placed| placed.argument.clone()).collect()
    }

    fn read(text: &str) -> (String, Vec<Argument<'_>>) {
        let statement = parse(text).unwrap_or_else(|error| panic!("{text} at {}", error.at));
        (statement.major.to_owned(), plain(&statement))
    }

    #[test]
    fn numbers_as_cam_systems_write_them() {
        for (text, value) in [
            ("25.", 25.0),
            (".625", 0.625),
            ("-.625000", -0.625),
            ("+1", 1.0),
            ("0", 0.0),
            (".5773503E+00", 0.577_350_3),
            ("-0.00000", 0.0),
            ("1.5D2", 150.0),
            ("2d-1", 0.2),
            ("1E5", 1.0e5),
        ] {
            let (rest, read) = number(text).unwrap();
            assert_eq!((rest, read), ("", value), "{text}");
        }
        for text in ["", "-", ".", "+.", "nan", "inf", "-inf", "E5", "infinity"] {
            assert!(number(text).is_err(), "{text}");
        }
    }

    #[test]
    fn statements_of_every_shape() {
        assert_eq!(read("RAPID"), ("RAPID".into(), vec![]));
        assert_eq!(read("RAPID /"), ("RAPID".into(), vec![]));
        assert_eq!(
            read("SPINDL/  500.0000,SFM,CCLW"),
            ("SPINDL".into(), vec![Number(500.0), Word("SFM"), Word("CCLW")])
        );
        assert_eq!(
            read("TOOLNO/1,20.0,,120"),
            ("TOOLNO".into(), vec![Number(1.0), Number(20.0), Empty, Number(120.0)])
        );
        assert_eq!(read("SYN/'A','B C'"), ("SYN".into(), vec![Quoted("A"), Quoted("B C")]));
        assert_eq!(
            read("CYCLE / DEEP, 1STPECK, .5"),
            ("CYCLE".into(), vec![Word("DEEP"), Word("1STPECK"), Number(0.5)])
        );
        assert_eq!(read("END-OF-PATH"), ("END-OF-PATH".into(), vec![]));
        let (major, arguments) = read("BEGIN NURBS_SIEMENS (D=3,F=100.0,AXIS=VAR,LENGTH= 55.0);");
        assert_eq!(major, "BEGIN NURBS_SIEMENS");
        let [Group(header)] = &arguments[..] else { panic!("{arguments:?}") };
        assert_eq!(
            plain(header),
            [Assigned("D", 3.0), Assigned("F", 100.0), AssignedWord("AXIS", "VAR"), Assigned("LENGTH", 55.0)]
        );
    }

    #[test]
    fn groups_stand_in_groups() {
        let text = "TLON,GOFWD/ (CYLNDR/1,2,3,0,0,1,5),ON,(PLANE/PERPTO,(POINT/1,2,3))";
        let (major, arguments) = read(text);
        assert_eq!((major.as_str(), arguments.len()), ("TLON", 4));
        let Group(plane) = &arguments[3] else { panic!() };
        assert_eq!((plane.major, plane.arguments.len()), ("PLANE", 2));
        let Group(point) = &plane.arguments[1].argument else { panic!() };
        assert_eq!((point.major, point.numbers().unwrap()), ("POINT", vec![1.0, 2.0, 3.0]));
        let deep = format!("A{}{}", "(A".repeat(200_000), ")".repeat(200_000));
        assert!(parse(&deep).is_err());
    }

    #[test]
    fn what_makes_no_sense_has_a_place() {
        for (text, at) in [
            ("/1", 0),
            ("GOTO/1 2", 6),
            ("GOTO/1,2)", 8),
            ("A/(B/1", 6),
            ("A/'b", 4),
            ("A=1", 1),
            ("\u{0}\u{1}", 0),
            ("A/1.2.3", 5),
        ] {
            assert_eq!(parse(text).unwrap_err().at, at, "{text}");
        }
    }

    #[test]
    fn a_goto_is_read_at_once() {
        for (text, numbers, place, end) in [
            ("GOTO  /   17.0,    0.0, -2.5", &[17.0, 0.0, -2.5][..], 0..28, 28),
            (" \tgoto/1,2,3,0,0,1 \r\nGOTO/4", &[1.0, 2.0, 3.0, 0.0, 0.0, 1.0], 2..18, 20),
            ("GOTO/1E1\n\n", &[10.0], 0..8, 8),
        ] {
            let read = goto(text).unwrap();
            assert_eq!((read.numbers(), &read.place, read.end), (numbers, &place, end), "{text}");
            // As the way that all statements go.
            assert_eq!(parse(&text[place]).unwrap().numbers().unwrap(), numbers, "{text}");
        }
        let long = format!("GOTO/1,{}2,3", " ".repeat(MAX_RECORD));
        for text in [
            "GOTO/1,2,3,4,5,6,7",
            "GOTO",
            "GOTO/",
            "GOTO/1,,2",
            "GOTO/1,\n2",
            "GOTO/1,2,3 $$ R",
            "GOTO/1,$",
            "\nGOTO/1",
            "GOHOME/1",
            "GOTO/1;",
            "GOTO/nan",
            "Ä",
            &long,
        ] {
            assert!(goto(text).is_none(), "{text}");
        }
    }
}
