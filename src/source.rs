//! Named texts and places in them.

use std::collections::BTreeMap;
use std::fmt;

/// Which text of a [`Sources`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct SourceId(u32);

impl SourceId {
    /// The program that a compilation wrote and read back; it is no file yet.
    pub const PROGRAM: SourceId = SourceId(u32::MAX);
    /// The input: the first text.
    pub const INPUT: SourceId = SourceId(0);

    /// The same text where `count` others stand before its own.
    #[must_use]
    pub fn behind(self, count: usize) -> SourceId {
        if self == SourceId::PROGRAM { self } else { SourceId(self.0.saturating_add(count as u32)) }
    }
}

/// A range of bytes in one text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Span {
    /// Which text.
    pub source: SourceId,
    /// The first byte.
    pub start: u32,
    /// One beyond the last byte.
    pub end: u32,
}

impl Span {
    /// Bytes `start..end` of `source`.
    pub fn new(source: SourceId, range: std::ops::Range<usize>) -> Span {
        let clamp = |at: usize| u32::try_from(at).unwrap_or(u32::MAX);
        Span { source, start: clamp(range.start), end: clamp(range.end) }
    }
}

/// A named text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// How messages call it: a path, `<stdin>`, `machine sinumerik`.
    pub name: String,
    /// Its text.
    pub text: String,
    /// How its bytes were read.
    pub encoding: Encoding,
}

/// How the bytes of a text were read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Encoding {
    /// As UTF-8.
    #[default]
    Utf8,
    /// As Windows-1252, which holds Latin-1: they are not UTF-8.
    Windows1252,
}

impl Source {
    /// A named text.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Source {
        Source { name: name.into(), text: text.into(), encoding: Encoding::Utf8 }
    }

    /// Bytes as a named text: UTF-8, or else Windows-1252.
    pub fn decode(name: impl Into<String>, bytes: Vec<u8>) -> Source {
        match String::from_utf8(bytes) {
            Ok(text) => Source::new(name, text),
            Err(error) => {
                let (text, _) = encoding_rs::WINDOWS_1252.decode_without_bom_handling(error.as_bytes());
                Source { encoding: Encoding::Windows1252, ..Source::new(name, text) }
            }
        }
    }
}

/// The input and what it names. The library reads no files; whoever calls it loads them.
#[derive(Clone, Debug, Default)]
pub struct Sources {
    files: Vec<Source>,
    /// What became of the files that the input names, by the names that it has for them.
    named: BTreeMap<String, Result<SourceId, String>>,
    /// The text behind [`SourceId::PROGRAM`], where a failed compilation left one.
    pub program: Option<Source>,
    /// The table of words that CL data is read with, beside the built-in ones.
    pub words: Option<SourceId>,
    /// Whether words of the input that are not understood are left out with a warning.
    pub lenient: bool,
    /// mm in the unit of CL data that state none, where that was told.
    pub units: Option<f64>,
}

impl Sources {
    /// The input alone.
    pub fn new(input: Source) -> Sources {
        Sources { files: vec![input], ..Sources::default() }
    }

    /// How many texts there are beside the program.
    pub fn count(&self) -> usize {
        self.files.len()
    }

    /// The texts of both, those of `other` behind: their ids count on ([`SourceId::behind`]). The names that the inputs have
    /// for files are left out.
    #[must_use]
    pub fn joined(mut self, other: Sources) -> Sources {
        self.files.extend(other.files);
        Sources { files: self.files, ..Sources::default() }
    }

    /// Adds a text.
    pub fn push(&mut self, source: Source) -> SourceId {
        self.files.push(source);
        SourceId(self.files.len() as u32 - 1)
    }

    /// Adds a file that the input names so, or why it could not be read.
    pub fn name(&mut self, name: &str, loaded: Result<Source, String>) {
        let loaded = loaded.map(|source| self.push(source));
        self.named.insert(name.to_owned(), loaded);
    }

    /// What became of the file that the input names so; none where nobody looked for it.
    pub fn named(&self, name: &str) -> Option<Result<SourceId, &str>> {
        self.named.get(name).map(|loaded| loaded.as_ref().copied().map_err(String::as_str))
    }

    /// The paths of all texts beside the program.
    pub fn paths(&self) -> impl Iterator<Item = &str> {
        self.files.iter().map(|source| source.name.as_str())
    }

    /// The text behind an id.
    pub fn get(&self, id: SourceId) -> Option<&Source> {
        if id == SourceId::PROGRAM { self.program.as_ref() } else { self.files.get(id.0 as usize) }
    }
}

/// A line and a column, both from 1; columns count characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LineColumn {
    /// From 1.
    pub line: usize,
    /// From 1, in characters.
    pub column: usize,
}

impl LineColumn {
    /// Where byte `at` of `text` stands.
    pub fn of(text: &str, at: usize) -> LineColumn {
        let mut at = at.min(text.len());
        while !text.is_char_boundary(at) {
            at -= 1;
        }
        let before = &text[..at];
        let start = before.rfind('\n').map_or(0, |i| i + 1);
        LineColumn {
            line: before.bytes().filter(|b| *b == b'\n').count() + 1,
            column: before[start..].chars().count() + 1,
        }
    }
}

impl fmt::Display for LineColumn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.line, self.column)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_count_characters() {
        let text = "a\n\"Δl\" = 1\n";
        assert_eq!(LineColumn::of(text, text.find('=').unwrap()), LineColumn { line: 2, column: 6 });
        assert_eq!(LineColumn::of(text, 999), LineColumn { line: 3, column: 1 });
    }
}
