//! Words and blocks that are not read, and why.

use super::{Reader, ends_marked};
use crate::diagnostic::Diagnostic;
use std::ops::Range;

impl<'t> Reader<'t, '_> {
    pub(super) fn axis_unknown(&mut self, letter: u8, range: Range<usize>) {
        self.assembler.axis_unknown(&char::from(letter).to_string(), range);
    }

    /// A word that is not understood, and why.
    pub(super) fn other(&mut self, text: &str, range: Range<usize>) {
        let bytes = text.as_bytes();
        let digits = |from: usize| from < bytes.len() && bytes[from..].iter().all(u8::is_ascii_digit);
        let (id, message) = if text == "RL" || text == "RR" {
            ("compensation", format!("radius compensation {text} is not read: the path would be another one"))
        } else if let [b'N', b'X'..=b'Z', ..] = bytes {
            (
                "compensation",
                "normals of the surface compensate the radius: the path would be another one".to_owned(),
            )
        } else if bytes.first() == Some(&b'M') && digits(1) {
            ("m-function", format!("{text} is not read in a block of moves"))
        } else if bytes.contains(&b'Q') {
            ("parameter", format!("Q parameters are read as feeds only, not as in `{text}`"))
        } else if bytes.first() == Some(&b'I') {
            (
                "incremental",
                format!("steps are read of axes that wrap at 360 degrees only, not as in `{text}`"),
            )
        } else {
            ("word-unknown", format!("`{text}` is not understood"))
        };
        let span = self.assembler.span(range);
        let mut diagnostic = Diagnostic::error(id, message).at(span, "");
        if id == "m-function" {
            diagnostic =
                diagnostic.hint("M functions are read where they are whole lines of the machine file");
        }
        self.assembler.diagnostics.push(diagnostic);
    }

    /// A block of a kind that is not read, with the lines that continue it.
    pub(super) fn unknown(&mut self, body: &'t str, start: usize) {
        let length = body.find([' ', '\t']).unwrap_or(body.len());
        let word = &body[..length];
        let message = if word.is_empty() {
            "this block has no word that is understood".to_owned()
        } else {
            format!("`{word}` blocks are not read")
        };
        let span = self.assembler.span(start..start + length);
        self.assembler.diagnostics.push(
            Diagnostic::error("block-unknown", message)
                .at(span, "")
                .hint("L, LN, C, CC, CP, SPL, comments and the lines of the machine file are read"),
        );
        let mut goes_on = ends_marked(body);
        while goes_on && let Some(next) = self.lines.next() {
            goes_on = ends_marked(next.text);
        }
    }
}
