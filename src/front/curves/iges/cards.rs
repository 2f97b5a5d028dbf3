//! Sections, directory and parameters of a file.

use super::super::spline::Number;
use super::super::{Unit, fail};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::{SourceId, Span};
use std::collections::BTreeMap;
use std::ops::Range;

/// The text of several lines as one, and where each of its bytes stands.
#[derive(Default)]
struct Joined {
    text: String,
    /// Where each line starts in `text`, and where in the file.
    starts: Vec<(usize, usize)>,
}

impl Joined {
    fn add(&mut self, line: &str, at: usize) {
        self.starts.push((self.text.len(), at));
        self.text.push_str(line);
    }

    /// Where a range stands in the file; of one that crosses lines the part in its first.
    fn place(&self, range: Range<usize>) -> Range<usize> {
        let i = self.starts.partition_point(|(own, _)| *own <= range.start).saturating_sub(1);
        let Some((own, at)) = self.starts.get(i) else { return 0..0 };
        let end = self.starts.get(i + 1).map_or(range.end, |(next, _)| range.end.min(*next));
        at + range.start - own..at + end.max(range.start) - own
    }
}

/// One parameter.
#[derive(Clone, Debug)]
pub(super) struct Parameter {
    /// Its text without blanks round it; empty where it is left out. Of a text in Hollerith form what stands behind nH.
    pub(super) text: String,
    pub(super) span: Span,
}

/// An entry of the directory.
pub(super) struct Entry {
    /// Its number.
    pub(super) number: usize,
    pub(super) kind: i64,
    pub(super) form: i64,
    /// The number of its transformation, or 0.
    pub(super) matrix: usize,
    /// Whether it is blanked.
    pub(super) blanked: bool,
    /// Whether it depends on another entity.
    pub(super) depends: bool,
    /// The lines of its parameters: the first, and how many.
    parameters: (usize, usize),
    /// Where its kind stands.
    pub(super) span: Span,
}

/// A file.
pub(super) struct Cards {
    id: SourceId,
    /// The length of its unit.
    pub(super) unit: Unit,
    /// Whether coordinates are those of a model at another scale, and where that stands.
    pub(super) scale: Option<(f64, Span)>,
    /// Places nearer than this are one, in units of the file; 0 where it does not say.
    pub(super) resolution: f64,
    /// The directory, in order.
    pub(super) entries: Vec<Entry>,
    /// The lines of parameters, with their places.
    data: BTreeMap<usize, (String, usize)>,
    delimiters: (u8, u8),
}

/// The unit flag, the name that stands for it, and its length, mm.
const UNITS: &[(i64, &str, f64)] = &[
    (1, "IN", 25.4),
    (1, "INCH", 25.4),
    (2, "MM", 1.0),
    (4, "FT", 304.8),
    (5, "MI", 1_609_344.0),
    (6, "M", 1000.0),
    (7, "KM", 1.0e6),
    (8, "MIL", 0.0254),
    (9, "UM", 0.001),
    (10, "CM", 10.0),
    (11, "UIN", 25.4e-6),
];

/// Columns `range`, from 0, of a line.
fn columns(line: &str, range: Range<usize>) -> &str {
    let end = range.end.min(line.len());
    line.get(range.start.min(end)..end).unwrap_or_default()
}

impl Cards {
    /// Reads the sections of a file.
    ///
    /// # Errors
    /// It is not in the fixed ASCII form, or a part of it is missing.
    pub(super) fn of(text: &str, id: SourceId) -> Result<Cards, Diagnostics> {
        let mut global = Joined::default();
        let mut directory: Vec<(String, usize)> = Vec::new();
        let mut data = BTreeMap::new();
        let (mut at, mut last) = (0, 'S');
        for raw in text.split_inclusive('\n') {
            let (start, line) = (at, raw.trim_end());
            at += raw.len();
            let span = Span::new(id, start..start + line.len());
            if line.is_empty() {
                continue;
            }
            // A letter that is not ASCII is one column, whatever it takes in bytes.
            let ascii: String = line.chars().map(|c| if c.is_ascii() { c } else { '?' }).collect();
            let section = ascii.chars().nth(72).unwrap_or(' ');
            let order = "SGDPT";
            let (Some(place), Some(before)) = (order.find(section), order.find(last)) else {
                let message = "this is no line of an IGES file: its column 73 names no section";
                let error = Diagnostic::error("section-unknown", message).at(span, "");
                return Err(error.hint("lines are 80 columns; the compressed form is not read").into());
            };
            if place < before {
                return Err(fail("section-order", format!("section {section} stands behind {last}"), span));
            }
            last = section;
            let number = ascii[73..].trim().parse().unwrap_or(0usize);
            match section {
                'G' => global.add(columns(&ascii, 0..72), start),
                'D' => directory.push((ascii, start)),
                'P' => {
                    data.insert(number, (columns(&ascii, 0..64).to_owned(), start));
                }
                _ => {}
            }
        }
        if last != 'T' {
            let end = text.trim_end().len();
            let message = "the file ends before its section T: a part of it is missing";
            return Err(fail("file-truncated", message, Span::new(id, end..end)));
        }
        let mut cards = Cards {
            id,
            unit: Unit::Unknown("this file does not say its units".to_owned(), None),
            scale: None,
            resolution: 0.0,
            entries: Vec::new(),
            data,
            delimiters: (b',', b';'),
        };
        cards.global(&global)?;
        let mut lines = directory.chunks_exact(2);
        for pair in &mut lines {
            cards.entry(&pair[0], &pair[1])?;
        }
        if let [(line, start)] = lines.remainder() {
            let message = "the last entry of the directory has one line instead of two";
            return Err(fail("file-truncated", message, Span::new(id, *start..start + line.len())));
        }
        Ok(cards)
    }

    /// Delimiters, units and resolution.
    fn global(&mut self, joined: &Joined) -> Result<(), Diagnostics> {
        // The delimiters stand first, in Hollerith form: 1H,,1H;, where they are not the usual ones.
        let bytes = joined.text.as_bytes();
        let first = bytes.strip_prefix(b"1H").and_then(|rest| rest.first().copied());
        self.delimiters.0 = first.unwrap_or(b',');
        let rest = if first.is_some() { 4 } else { 1 };
        let second =
            bytes.get(rest..).and_then(|rest| rest.strip_prefix(b"1H")).and_then(|rest| rest.first());
        self.delimiters.1 = second.copied().unwrap_or(b';');
        let all = self.split(joined)?;
        let field = |i: usize| all.get(i - 1).filter(|parameter| !parameter.text.is_empty());
        if let Some(scale) = field(13) {
            let (x, span) = number(scale)?;
            self.scale = Some((x, span)).filter(|_| x != 1.0);
        }
        if let Some(resolution) = field(19) {
            self.resolution = number(resolution)?.0.max(0.0);
        }
        let name = field(15).map(|parameter| parameter.text.trim().to_uppercase());
        let flag = match field(14) {
            // The standard's own default.
            None => 1,
            Some(flag) => number(flag)?.0 as i64,
        };
        let known = UNITS.iter().find(|(number, own, _)| match flag {
            3 => name.as_deref() == Some(*own),
            flag => *number == flag,
        });
        self.unit = match known {
            Some((.., mm)) => Unit::Stated(*mm),
            None => {
                let span = field(if flag == 3 { 15 } else { 14 }).map(|parameter| parameter.span);
                Unit::Unknown(format!("unit {flag} of this file is none that is known"), span)
            }
        };
        Ok(())
    }

    /// One entry of the directory.
    fn entry(&mut self, first: &(String, usize), second: &(String, usize)) -> Result<(), Diagnostics> {
        let field = |line: &(String, usize), i: usize| -> Result<i64, Diagnostics> {
            let text = columns(&line.0, 8 * i..8 * i + 8);
            let digits = if i == 9 { text.trim_start_matches('D') } else { text };
            if digits.trim().is_empty() {
                return Ok(0);
            }
            let span = Span::new(self.id, line.1 + 8 * i..line.1 + 8 * i + text.len());
            let message = "a field of the directory is no whole number";
            digits.trim().parse().map_err(|_| fail("number-unreadable", message, span))
        };
        let size = |x: i64| usize::try_from(x).unwrap_or(0);
        let number = columns(&first.0, 73..80).trim().parse().unwrap_or(0);
        let status = columns(&first.0, 64..72).replace(' ', "0");
        let text = columns(&first.0, 0..8);
        let from = first.1 + text.len() - text.trim_start().len();
        self.entries.push(Entry {
            number,
            kind: field(first, 0)?,
            form: field(second, 4)?,
            matrix: size(field(first, 6)?),
            blanked: status.get(0..2) == Some("01"),
            depends: matches!(status.get(2..4), Some("01" | "03")),
            parameters: (size(field(first, 1)?), size(field(second, 3)?)),
            span: Span::new(self.id, from..first.1 + text.trim_end().len()),
        });
        Ok(())
    }

    /// The entry of a number.
    pub(super) fn find(&self, number: usize) -> Option<&Entry> {
        // Numbers rise through the directory.
        let i = self.entries.binary_search_by_key(&number, |entry| entry.number).ok()?;
        self.entries.get(i)
    }

    /// The parameters of an entry, without the kind that stands first.
    pub(super) fn parameters(&self, entry: &Entry) -> Result<Vec<Parameter>, Diagnostics> {
        let mut joined = Joined::default();
        let (first, count) = entry.parameters;
        for (number, (line, at)) in self.data.range(first..first.saturating_add(count.max(1))) {
            if *number < first + joined.starts.len() {
                continue;
            }
            joined.add(line, *at);
        }
        if joined.starts.len() < count.max(1) {
            let message = format!("{} has parameters in {count} lines; some of them are missing", entry.kind);
            return Err(fail("record-truncated", message, entry.span));
        }
        let mut all = self.split(&joined)?;
        let kind = if all.is_empty() { None } else { Some(all.remove(0)) };
        match kind {
            Some(kind) if kind.text == entry.kind.to_string() => Ok(all),
            _ => {
                let message = format!("the parameters of {} begin with another kind", entry.kind);
                Err(fail("directory-differs", message, entry.span))
            }
        }
    }

    /// Parameters up to the end of the record.
    fn split(&self, joined: &Joined) -> Result<Vec<Parameter>, Diagnostics> {
        let (between, end) = self.delimiters;
        let bytes = joined.text.as_bytes();
        let mut all = Vec::new();
        let mut at = 0;
        loop {
            while bytes.get(at) == Some(&b' ') {
                at += 1;
            }
            let from = at;
            let digits = bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
            let mut text = None;
            if 0 < digits && bytes.get(from + digits) == Some(&b'H') {
                // A text may hold delimiters; its length says where it ends.
                let length: usize = joined.text[from..from + digits].parse().unwrap_or(usize::MAX);
                let start = from + digits + 1;
                let Some(held) = start.checked_add(length).and_then(|stop| joined.text.get(start..stop))
                else {
                    let span = Span::new(self.id, joined.place(from..start));
                    return Err(fail("record-truncated", "a text is longer than its record", span));
                };
                text = Some(held.to_owned());
                at = start + length;
            }
            let stop = bytes[at..].iter().position(|b| *b == between || *b == end).map(|i| at + i);
            let Some(stop) = stop else {
                let span = Span::new(self.id, joined.place(from..joined.text.len().max(from)));
                let message = "a record has no end: a part of the file is missing";
                return Err(fail("record-truncated", message, span));
            };
            let raw = joined.text[from..stop].trim_end();
            let span = Span::new(self.id, joined.place(from..from + raw.len()));
            all.push(Parameter { text: text.unwrap_or_else(|| raw.to_owned()), span });
            at = stop + 1;
            if bytes[stop] == end {
                return Ok(all);
            }
        }
    }
}

/// A parameter as a finite number; 0 where it is left out. Exponents are written with E or D.
pub(super) fn number(parameter: &Parameter) -> Result<Number, Diagnostics> {
    if parameter.text.is_empty() {
        return Ok((0.0, parameter.span));
    }
    let text = parameter.text.replace(['D', 'd'], "E");
    match text.parse::<f64>() {
        Ok(x) if x.is_finite() => Ok((x, parameter.span)),
        _ => {
            let short: String = parameter.text.chars().take(24).collect();
            Err(fail("number-unreadable", format!("`{short}` is no finite number"), parameter.span))
        }
    }
}
