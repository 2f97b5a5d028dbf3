//! What a line of the machine file looks like from outside: most lines of a program are none, and are told apart by it at once.

use crate::machine::template::Template;

/// What a line of the machine file begins and ends with, whatever is filled in.
#[derive(Clone)]
pub(super) struct Outline {
    /// The last byte, where it has one: mostly it decides.
    last: Option<u8>,
    start: String,
    end: String,
}

impl Outline {
    pub(super) fn new(template: &Template) -> Outline {
        let (start, end) = template.outline();
        Outline { last: end.bytes().next_back(), start: start.to_owned(), end: end.to_owned() }
    }

    /// Whether a line that begins with this byte may be it.
    pub(super) fn may_begin_with(&self, byte: u8) -> bool {
        self.start.bytes().next().is_none_or(|first| first == byte)
    }

    #[inline]
    pub(super) fn fits(&self, line: &str) -> bool {
        (self.last.is_none() || self.last == line.bytes().next_back())
            && line.starts_with(self.start.as_str())
            && line.ends_with(self.end.as_str())
    }
}

/// Whether a line begins as a template does.
pub(super) fn begins_alike(template: &Template, text: &str) -> bool {
    let first = template.0.as_bytes().first();
    first == Some(&b'{') || first == text.as_bytes().first()
}
