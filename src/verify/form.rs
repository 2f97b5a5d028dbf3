//! The form of a program beside its meaning.

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::{SourceId, Span};

/// Compares a program with what would be written for the same meaning, line by line and word by word: a doubled or
/// moved line may mean nothing to the path, and still show that somebody changed the program.
///
/// # Errors
/// A line has other words.
pub fn same_form(text: &str, written: &str, id: SourceId) -> Result<(), Diagnostics> {
    let mut start = 0;
    let mut expected = written.lines();
    let differs = |range: std::ops::Range<usize>, line: Option<&str>| {
        let message = "the program means what was asked, but this line is not as it would be written";
        let diagnostic = Diagnostic::refusal("form-differs", message).at(Span::new(id, range), "");
        Err(match line {
            Some(line) => diagnostic.hint(format!("here `{line}` would stand")),
            None => diagnostic,
        }
        .into())
    };
    for line in text.split_inclusive('\n') {
        let range = start..start + line.trim_end().len();
        start += line.len();
        let words = line.trim_start_matches('\u{feff}').split_whitespace();
        match expected.next() {
            Some(own) if own.split_whitespace().eq(words) => {}
            own => return differs(range, own),
        }
    }
    match expected.next() {
        Some(own) => differs(text.len()..text.len(), Some(own)),
        None => Ok(()),
    }
}
