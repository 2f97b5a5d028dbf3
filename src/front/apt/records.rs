//! The first layer: a text becomes records, each a statement's code or a remark, with the place of every byte.
//!
//! ```text
//! GOTO/1.0, 2.0, 3.0                one line, borrowed
//! CIRCLE/ 0.0, 0.0, 0.0,  $         what follows `$` is not read; the next line goes on, with nothing between,
//!  0.0, 0.0, 1.0, 5.0               so that a `$` may stand within a number
//! $$ OPERATION NAME : ROUGH         a remark, to the end of its line
//! $$-> CSYS / 1.0, 0.0,  $          a remark of this kind goes on behind `$`, in lines that have no `$$`
//!   0.0, 0.0
//! PPRINT COSTS 5 $ A PIECE          free text: `$` is a letter unless nothing follows it
//! ```

use crate::source::{SourceId, Span};
use std::borrow::Cow;
use std::ops::Range;

/// The most bytes that one statement may have. Longer ones are no CL data, and their parts are not worth the memory.
pub(super) const MAX_RECORD: usize = 1 << 20;

/// What a record is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A statement.
    Code,
    /// A remark: what stands behind `$$`.
    Remark,
    /// Longer than [`MAX_RECORD`]; its text is empty.
    TooLong,
}

/// One statement or remark.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Record<'t> {
    /// What it is.
    pub(super) kind: Kind,
    /// Its first line, from 1.
    pub(super) line: u32,
    /// Its bytes in the text, all of its lines.
    pub(super) range: Range<usize>,
    /// Its text without `$$`, without `$` and what follows that, without blanks round it.
    pub(super) text: Cow<'t, str>,
    /// Where the parts of a joined text come from: (offset in `text`, offset in the source), in order.
    joints: Vec<(usize, usize)>,
}

impl<'t> Record<'t> {
    /// A record that is a part of the text, which starts there.
    #[inline]
    fn borrowed(kind: Kind, line: u32, (start, text): (usize, &'t str)) -> Record<'t> {
        let range = start..start + text.len();
        let (kind, text) = if MAX_RECORD < text.len() { (Kind::TooLong, "") } else { (kind, text) };
        Record { kind, line, range, text: Cow::Borrowed(text), joints: Vec::new() }
    }

    /// Where bytes `range` of the record's text stand in the source.
    pub(super) fn place(&self, source: SourceId, range: Range<usize>) -> Span {
        let end = range.end.max(range.start);
        let start = self.offset(range.start);
        // The last byte, not one beyond: that may stand in another line.
        let end = if end == range.start { start } else { self.offset(end - 1) + 1 };
        Span::new(source, start..end.max(start))
    }

    fn offset(&self, at: usize) -> usize {
        let after = self.joints.partition_point(|(offset, _)| *offset <= at);
        match after.checked_sub(1).and_then(|i| self.joints.get(i)) {
            Some((offset, source)) => source + (at - offset),
            None => self.range.start + at,
        }
    }

    /// The whole of it.
    pub(super) fn span(&self, source: SourceId) -> Span {
        Span::new(source, self.range.clone())
    }
}

/// The records of a text.
pub(super) struct Records<'t> {
    text: &'t str,
    at: usize,
    line: u32,
    remark: Option<Record<'t>>,
}

/// Statements whose text goes to the end of the line.
const FREE_TEXT: [&str; 6] = ["PARTNO", "PPRINT", "INSERT", "TPRINT", "REMARK", "TOOL PATH"];

/// Whether a statement is free text, by its first word.
pub(super) fn is_free_text(code: &str) -> bool {
    let code = code.trim_ascii_start().as_bytes();
    FREE_TEXT.iter().any(|word| {
        code.get(..word.len()).is_some_and(|start| start.eq_ignore_ascii_case(word.as_bytes()))
            && !code.get(word.len()).is_some_and(u8::is_ascii_alphanumeric)
    })
}

impl<'t> Records<'t> {
    /// From the beginning; a byte-order mark is passed over.
    pub(super) fn new(text: &'t str) -> Records<'t> {
        Records { text, at: if text.starts_with('\u{feff}') { 3 } else { 0 }, line: 1, remark: None }
    }

    /// The rest of the line at `from`: where it ends, and where the next one starts.
    fn line_end(&self, from: usize) -> (usize, usize) {
        match memchr::memchr(b'\n', &self.text.as_bytes()[from..]) {
            Some(length) => (from + length, from + length + 1),
            None => (self.text.len(), self.text.len()),
        }
    }

    fn next_line(&mut self, start: usize) {
        self.at = start;
        self.line = self.line.saturating_add(1);
    }

    /// What stands between the blanks of one line or a part of it, and where it starts.
    fn trimmed(&self, start: usize, end: usize) -> Option<(usize, &'t str)> {
        let text = self.text[start..end].trim_ascii_start();
        let trimmed = text.trim_ascii_end();
        (!trimmed.is_empty()).then_some((end - text.len(), trimmed))
    }

    /// What is left of the text; nothing while a remark waits.
    #[inline]
    pub(super) fn rest(&self) -> &'t str {
        if self.remark.is_some() { "" } else { self.text.get(self.at..).unwrap_or_default() }
    }

    /// Passes over the first line of that, which ends there; gives its number and where it starts.
    #[inline]
    pub(super) fn pass(&mut self, end: usize) -> (u32, usize) {
        let (line, start) = (self.line, self.at);
        self.next_line(start + end + 1);
        (line, start)
    }

    /// A record of one line or a part of it.
    fn borrowed(&self, kind: Kind, start: usize, end: usize) -> Option<Record<'t>> {
        self.trimmed(start, end).map(|trimmed| Record::borrowed(kind, self.line, trimmed))
    }

    /// A record that has a `$` in its first line, at `dollar`.
    fn with_dollar(&mut self, dollar: usize) -> Option<Record<'t>> {
        let start = self.at;
        let (end, next) = self.line_end(dollar);
        let rest = &self.text[dollar..end];
        if is_free_text(&self.text[start..dollar]) {
            // Text, unless the line ends with it.
            let line = self.text[start..end].trim_ascii_end();
            if !line.ends_with('$') || line.ends_with("$$") {
                let record = self.borrowed(Kind::Code, start, end);
                self.next_line(next);
                return record;
            }
            let last = start + line.len() - 1;
            return Some(self.joined(Kind::Code, start, last, next));
        }
        if let Some(remark) = rest.strip_prefix("$$") {
            let code = self.borrowed(Kind::Code, start, dollar);
            let pointed = remark.trim_ascii_start().starts_with("->");
            let line = remark.trim_ascii_end();
            let remark = if pointed && line.ends_with('$') {
                Some(self.joined(Kind::Remark, dollar + 2, dollar + 2 + line.len() - 1, next))
            } else {
                let remark = self.borrowed(Kind::Remark, dollar + 2, end);
                self.next_line(next);
                remark
            };
            return match code {
                Some(code) => {
                    self.remark = remark;
                    Some(code)
                }
                None => remark,
            };
        }
        Some(self.joined(Kind::Code, start, dollar, next))
    }

    /// A record that goes on in the line at `next`: its first part is `start..end`.
    fn joined(&mut self, kind: Kind, start: usize, end: usize, next: usize) -> Record<'t> {
        let line = self.line;
        let indent = self.text[start..end].len() - self.text[start..end].trim_ascii_start().len();
        let start = start + indent;
        let mut text = self.text[start.min(end)..end].to_owned();
        let mut joints = vec![(0, start)];
        let (mut last, mut too_long) = (end, false);
        self.next_line(next);
        while self.at < self.text.len() {
            let from = self.at;
            let (end, next) = self.line_end(from);
            let part = &self.text[from..end];
            let dollar = memchr::memchr(b'$', part.as_bytes());
            let part = &part[..dollar.unwrap_or(part.len())];
            too_long |= MAX_RECORD < text.len() + part.len();
            if !too_long {
                joints.push((text.len(), from));
                text.push_str(part);
            }
            last = from + part.trim_ascii_end().len();
            // A remark behind the last part begins a record of its own.
            if dollar.is_some_and(|at| self.text[from + at..].starts_with("$$")) {
                self.at = from + part.len();
                break;
            }
            self.next_line(next);
            if dollar.is_none() {
                break;
            }
        }
        text.truncate(text.trim_ascii_end().len());
        if too_long {
            text.clear();
        }
        let kind = if too_long { Kind::TooLong } else { kind };
        Record { kind, line, range: start..last.max(start), text: Cow::Owned(text), joints }
    }
}

impl<'t> Iterator for Records<'t> {
    type Item = Record<'t>;

    #[inline]
    fn next(&mut self) -> Option<Record<'t>> {
        if self.remark.is_some() {
            return self.remark.take();
        }
        while self.at < self.text.len() {
            let start = self.at;
            let found = memchr::memchr2(b'\n', b'$', &self.text.as_bytes()[start..]);
            let end = found.map_or(self.text.len(), |length| start + length);
            if self.text.as_bytes().get(end) == Some(&b'$') {
                let record = self.with_dollar(end);
                if record.is_some() {
                    return record;
                }
                continue;
            }
            let line = self.line;
            self.next_line(end + 1);
            if let Some(trimmed) = self.trimmed(start, end) {
                return Some(Record::borrowed(Kind::Code, line, trimmed));
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn records(text: &str) -> Vec<(Kind, u32, String)> {
        Records::new(text).map(|r| (r.kind, r.line, r.text.into_owned())).collect()
    }

    fn code(line: u32, text: &str) -> (Kind, u32, String) {
        (Kind::Code, line, text.to_owned())
    }

    fn remark(line: u32, text: &str) -> (Kind, u32, String) {
        (Kind::Remark, line, text.to_owned())
    }

    #[test]
    fn lines_of_every_kind() {
        let text = "\u{feff}GOTO  / 1.,2.,3.\r\n\r\n$$ A REMARK\r\nRAPID $$ AND ONE BEHIND\nFINI";
        assert_eq!(
            records(text),
            [
                code(1, "GOTO  / 1.,2.,3."),
                remark(3, "A REMARK"),
                code(4, "RAPID"),
                remark(4, "AND ONE BEHIND"),
                code(5, "FINI")
            ]
        );
        assert!(records("").is_empty() && records("\n  \n\t").is_empty() && records("$$").is_empty());
    }

    #[test]
    fn a_dollar_joins_lines_with_nothing_between() {
        // The break of the third seed's Fig. 3 stands in a number; what follows `$` is not read.
        assert_eq!(records("AXIS= 1.0$ 17\n0000)\nEND"), [code(1, "AXIS= 1.00000)"), code(3, "END")]);
        assert_eq!(records("A,$\nB,$\nC $$ R\nD"), [code(1, "A,B,C"), remark(3, "R"), code(4, "D")]);
        assert_eq!(records("A,$"), [code(1, "A,")]);
    }

    #[test]
    fn a_pointed_remark_goes_on_without_dollars() {
        let text = "$$-> CSYS / 1.0, 0.0,  $\n   0.0, 1.0\nGOTO/1,2,3\n$$ COSTS 5$\nFINI";
        assert_eq!(
            records(text),
            [
                remark(1, "-> CSYS / 1.0, 0.0,     0.0, 1.0"),
                code(3, "GOTO/1,2,3"),
                remark(4, "COSTS 5$"),
                code(5, "FINI")
            ]
        );
    }

    #[test]
    fn free_text_keeps_its_dollars() {
        assert_eq!(
            records("PPRINT 5 $ A PIECE $$ EACH\npartno/ x $\n y\nFINI"),
            [code(1, "PPRINT 5 $ A PIECE $$ EACH"), code(2, "partno/ x  y"), code(4, "FINI")]
        );
        assert!(!is_free_text("INSERTX") && is_free_text(" Insert") && is_free_text("TOOL PATH/A"));
    }

    #[test]
    fn every_byte_of_a_joined_record_has_its_place() {
        let text = "GOTO/1.0,$\n  2.5,$\n3\n";
        let record = Records::new(text).next().unwrap();
        assert_eq!(record.text, "GOTO/1.0,  2.5,3");
        for (found, meant) in [("GOTO", 0), ("1.0", 5), ("2.5", 13), ("3", 19)] {
            let at = record.text.find(found).unwrap();
            let span = record.place(SourceId::INPUT, at..at + found.len());
            assert_eq!((span.start as usize, span.end as usize), (meant, meant + found.len()), "{found}");
        }
        assert_eq!(record.range, 0..20);
    }

    #[test]
    fn a_record_longer_than_any_statement_is_not_kept() {
        let long = "1,".repeat(MAX_RECORD);
        for text in [format!("GOTO/{long}\nFINI"), format!("GOTO/1,$\n{long}$\n{long}\nFINI")] {
            let all: Vec<Record<'_>> = Records::new(&text).collect();
            assert_eq!((all.len(), all[0].kind, all[0].text.len()), (2, Kind::TooLong, 0));
        }
    }
}
