//! The instances of a file, by number, each read when it is asked for.

use super::text::{Parameter, Record, Value, instance};
use crate::diagnostic::Diagnostics;
use crate::front::curves::spline::Number;
use crate::front::curves::{Point, fail};
use crate::source::{SourceId, Span};
use std::collections::BTreeMap;
use std::ops::Range;

/// A file.
pub(super) struct Model<'t> {
    text: &'t str,
    id: SourceId,
    /// Where each instance stands, its semicolon included.
    index: BTreeMap<u64, Range<usize>>,
    /// Their numbers in the order of the file, with the keyword; of a complex one it is empty.
    pub(super) order: Vec<(u64, &'t str)>,
}

/// An instance that was read.
pub(super) struct Instance<'t> {
    pub(super) number: u64,
    pub(super) records: Vec<Record<'t>>,
    id: SourceId,
    end: usize,
    /// Where its number stands.
    pub(super) span: Span,
}

pub(super) type Read<T> = Result<T, Diagnostics>;

/// How many bytes of blanks and comments a text begins with.
fn blanks(text: &str) -> usize {
    let mut at = 0;
    loop {
        at = text.len() - text[at..].trim_start().len();
        match text[at..].strip_prefix("/*").and_then(|rest| rest.find("*/")) {
            Some(i) => at += i + 4,
            None => return at,
        }
    }
}

impl<'t> Model<'t> {
    /// Finds the instances of a file.
    ///
    /// # Errors
    /// It is none after ISO 10303-21, or a part of it is missing.
    pub(super) fn of(text: &'t str, id: SourceId) -> Read<Model<'t>> {
        let mark = text.len() - text.trim_start_matches('\u{feff}').len();
        let start = mark + blanks(&text[mark..]);
        if !text[start..].starts_with("ISO-10303-21") {
            let span = Span::new(id, start..start);
            return Err(fail("step-header", "this file does not begin with ISO-10303-21", span));
        }
        let mut model = Model { text, id, index: BTreeMap::new(), order: Vec::new() };
        let (bytes, mut from, mut at) = (text.as_bytes(), 0, 0);
        let mut ended = false;
        while at < bytes.len() {
            match bytes[at] {
                b'\'' => {
                    // Two quotes in a text are read as two texts in a row, which comes to the same.
                    let close = memchr::memchr(b'\'', &bytes[at + 1..]);
                    at += close.map_or(bytes.len() - at, |i| i + 2);
                }
                b'/' if bytes.get(at + 1) == Some(&b'*') => {
                    let close = text[at + 2..].find("*/");
                    at += close.map_or(bytes.len() - at, |i| i + 4);
                }
                b';' => {
                    at += 1;
                    ended |= model.statement(from..at)?;
                    from = at;
                }
                _ => at += 1,
            }
        }
        if !ended {
            let end = text.trim_end().len();
            let message = "the file ends before END-ISO-10303-21: a part of it is missing";
            return Err(fail("file-truncated", message, Span::new(id, end..end)));
        }
        Ok(model)
    }

    /// Takes one statement; whether it is the last.
    fn statement(&mut self, range: Range<usize>) -> Read<bool> {
        let from = range.start + blanks(&self.text[range.clone()]);
        let statement = &self.text[from..range.end];
        let Some(rest) = statement.strip_prefix('#') else {
            return Ok(statement.starts_with("END-ISO-10303-21"));
        };
        let digits = rest.bytes().take_while(u8::is_ascii_digit).count();
        let span = Span::new(self.id, from..from + 1 + digits);
        let (Ok(number), Some((_, behind))) = (rest[..digits].parse(), rest[digits..].split_once('=')) else {
            return Err(fail("instance-unreadable", "this is no instance: a number and = begin one", span));
        };
        let behind = behind.trim_start();
        let letters = behind.bytes().take_while(|b| b.is_ascii_alphanumeric() || *b == b'_').count();
        if self.index.insert(number, from..range.end).is_some() {
            return Err(fail("instance-twice", format!("#{number} stands twice"), span));
        }
        self.order.push((number, &behind[..letters]));
        Ok(false)
    }

    /// The text of an instance.
    pub(super) fn text(&self, number: u64) -> &'t str {
        self.index.get(&number).map_or("", |range| &self.text[range.clone()])
    }

    /// Where the number of an instance stands.
    pub(super) fn span(&self, number: u64) -> Span {
        let range = self.index.get(&number).cloned().unwrap_or(0..0);
        let digits =
            self.text[range.clone()].bytes().take_while(|b| *b == b'#' || b.is_ascii_digit()).count();
        Span::new(self.id, range.start..range.start + digits)
    }

    /// Reads an instance.
    ///
    /// # Errors
    /// There is none of that number, or its text is not readable.
    pub(super) fn get(&self, number: u64, from: Span) -> Read<Instance<'t>> {
        let Some(range) = self.index.get(&number) else {
            return Err(fail("reference-unknown", format!("there is no instance #{number}"), from));
        };
        match instance(&self.text[range.clone()]) {
            Ok((_, (number, records))) => {
                Ok(Instance { number, records, id: self.id, end: range.end, span: self.span(number) })
            }
            Err(error) => {
                let left = match error {
                    nom::Err::Error(error) | nom::Err::Failure(error) => error.input.len(),
                    nom::Err::Incomplete(_) => range.len(),
                };
                let at = range.end - left;
                let end = self.text[at..range.end].chars().next().map_or(at, |c| at + c.len_utf8());
                let message = format!("#{number} is not readable here");
                Err(fail("instance-unreadable", message, Span::new(self.id, at..end)))
            }
        }
    }

    /// The instance that a parameter names.
    pub(super) fn follow(&self, instance: &Instance<'_>, parameter: &Parameter<'_>) -> Read<Instance<'t>> {
        let Value::Reference(number) = parameter.value else {
            return Err(instance.wrong(parameter, "the number of an instance"));
        };
        self.get(number, instance.place(parameter))
    }

    /// The three coordinates of a CARTESIAN_POINT or a DIRECTION.
    pub(super) fn triple(&self, instance: &Instance<'_>, parameter: &Parameter<'_>) -> Read<Point> {
        let own = self.follow(instance, parameter)?;
        if !own.is("CARTESIAN_POINT") && !own.is("DIRECTION") {
            let message = format!("#{} is no point or direction", own.number);
            return Err(fail("kind-differs", message, instance.place(parameter)));
        }
        let list = own.list(own.parameter(0, 1)?)?;
        let [x, y, z] = list else {
            let message =
                format!("#{} has {} coordinates; places in space have three", own.number, list.len());
            return Err(fail("point-incomplete", message, own.span));
        };
        Ok([own.number(x)?.0, own.number(y)?.0, own.number(z)?.0])
    }

    /// What a VERTEX_POINT or the point itself is.
    pub(super) fn vertex(&self, instance: &Instance<'_>, parameter: &Parameter<'_>) -> Read<Point> {
        let own = self.follow(instance, parameter)?;
        if own.is("VERTEX_POINT") {
            self.triple(&own, own.parameter(0, 1)?)
        } else {
            self.triple(instance, parameter)
        }
    }
}

impl<'t> Instance<'t> {
    /// Whether one of its records has this keyword.
    pub(super) fn is(&self, keyword: &str) -> bool {
        self.record(keyword).is_some()
    }

    pub(super) fn record(&self, keyword: &str) -> Option<&Record<'t>> {
        self.records.iter().find(|record| record.keyword == keyword)
    }

    /// The keyword of a simple instance.
    pub(super) fn keyword(&self) -> &'t str {
        if let [record] = &self.records[..] { record.keyword } else { "" }
    }

    /// Where a parameter stands.
    pub(super) fn place(&self, parameter: &Parameter<'_>) -> Span {
        let (from, to) = parameter.left;
        Span::new(self.id, self.end.saturating_sub(from)..self.end.saturating_sub(to))
    }

    fn wrong(&self, parameter: &Parameter<'_>, wanted: &str) -> Diagnostics {
        fail("parameter-kind", format!("#{}: {wanted} is wanted here", self.number), self.place(parameter))
    }

    /// A parameter of one of its records.
    pub(super) fn parameter(&self, record: usize, i: usize) -> Read<&Parameter<'t>> {
        let found = self.records.get(record).and_then(|record| record.parameters.get(i));
        found.ok_or_else(|| {
            let message = format!("#{} has too few parameters", self.number);
            fail("entity-truncated", message, self.span)
        })
    }

    /// A parameter of the record with a keyword.
    pub(super) fn of(&self, keyword: &str, i: usize) -> Read<&Parameter<'t>> {
        let at = self.records.iter().position(|record| record.keyword == keyword);
        self.parameter(at.unwrap_or(usize::MAX), i)
    }

    pub(super) fn list<'p>(&self, parameter: &'p Parameter<'t>) -> Read<&'p [Parameter<'t>]> {
        if let Value::List(list) = &parameter.value { Ok(list) } else { Err(self.wrong(parameter, "a list")) }
    }

    /// A finite number.
    pub(super) fn number(&self, parameter: &Parameter<'_>) -> Read<Number> {
        if let Value::Number(x) = parameter.value
            && x.is_finite()
        {
            return Ok((x, self.place(parameter)));
        }
        Err(self.wrong(parameter, "a finite number"))
    }

    /// A truth value.
    pub(super) fn truth(&self, parameter: &Parameter<'_>) -> Read<bool> {
        if let Value::Word(word @ ("T" | "F")) = parameter.value {
            return Ok(word == "T");
        }
        Err(self.wrong(parameter, ".T. or .F."))
    }

    /// All numbers of instances that it names.
    pub(super) fn references(&self) -> Vec<u64> {
        fn visit(parameters: &[Parameter<'_>], out: &mut Vec<u64>) {
            for parameter in parameters {
                match &parameter.value {
                    Value::Reference(number) => out.push(*number),
                    Value::List(list) => visit(list, out),
                    Value::Typed(record) => visit(&record.parameters, out),
                    Value::Number(_) | Value::Text(_) | Value::Word(_) | Value::Omitted | Value::Derived => {}
                }
            }
        }
        let mut out = Vec::new();
        self.records.iter().for_each(|record| visit(&record.parameters, &mut out));
        out
    }
}
