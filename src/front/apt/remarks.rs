//! Remarks: carried over as text that every control takes, and read where they carry the frame of the positions.

use super::reader::Reader;
use super::statement::number;
use super::words::Meaning;
use crate::diagnostic::Diagnostic;
use crate::machine::remark::ACCENTS;
use crate::source::Span;

/// Where a matrix of CATIA stands: after `$$*CATIA0` come a name and three rows.
#[derive(Default)]
pub(super) struct Matrix {
    /// How many remarks are still to come.
    left: usize,
    name: String,
    rows: Vec<String>,
}

/// Text that every control takes as a remark: printable ASCII without parentheses, one blank at a time. Letters with
/// accents lose them.
pub(super) fn plain(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '(' | '{' => out.push('['),
            ')' | '}' => out.push(']'),
            // A `~` at its end would join a block with the next.
            '~' => out.push('-'),
            // It would end a tape.
            '%' => out.push_str("pct"),
            ' '..='~' => out.push(c),
            _ if c.is_whitespace() => out.push(' '),
            _ => match ACCENTS.iter().find(|(letters, _)| letters.contains(c)) {
                Some((_, letter)) => out.push_str(letter),
                None => out.push('?'),
            },
        }
    }
    let mut plain = String::with_capacity(out.len());
    for word in out.split_ascii_whitespace() {
        if !plain.is_empty() {
            plain.push(' ');
        }
        plain.push_str(word);
    }
    plain
}

impl Reader<'_> {
    /// One remark, without `$$`.
    pub(super) fn remark(&mut self, text: &str, span: Span) {
        let text = text.trim();
        if let Some(matrix) = &mut self.matrix {
            matrix.left -= 1;
            if matrix.left == 3 {
                text.clone_into(&mut matrix.name);
            } else {
                matrix.rows.push(text.to_owned());
            }
            if matrix.left == 0 {
                let rows =
                    self.matrix.take().map_or(String::new(), |m| format!("{} {}", m.name, m.rows.join(", ")));
                self.frame("CATIA0", &rows, span);
            }
            return;
        }
        if text.eq_ignore_ascii_case("*CATIA0") {
            self.matrix = Some(Matrix { left: 4, ..Matrix::default() });
            return;
        }
        if let Some(pointed) = text.strip_prefix("->") {
            let (word, values) = pointed.split_once('/').unwrap_or((pointed, ""));
            if word.trim().eq_ignore_ascii_case("CSYS") {
                return self.frame("CSYS", values, span);
            }
            if word.trim().eq_ignore_ascii_case("CUTTER")
                && self.words.meaning("CUTTER") == Some(Meaning::Cutter)
            {
                self.diameter = number(values.trim()).ok().map(|(_, d)| d * self.scale);
                self.dirty_tool = true;
            }
            if word.trim().eq_ignore_ascii_case("FEATNO") {
                self.end_operation("FEATNO", span);
            }
            let text = format!("{} {}", word.trim(), values.trim());
            return self.carry(&text, span);
        }
        if text.to_ascii_uppercase().starts_with("OPERATION NAME") {
            self.end_operation("another operation", span);
        }
        self.carry(text, span);
    }

    /// A remark of the program; rulers of dashes say nothing.
    pub(super) fn carry(&mut self, text: &str, span: Span) {
        let text = plain(text);
        let text = text.trim_start_matches('*').trim_start();
        if text.bytes().any(|b| b.is_ascii_alphanumeric()) {
            self.program.comment(text, span);
        }
    }

    /// The frame that the positions after it stand in: written down, and a stop where it changes between moves.
    pub(super) fn frame(&mut self, word: &str, values: &str, span: Span) {
        // Numbers without the zeros that fill them up.
        let short = |value: &str| match number(value.trim()) {
            Ok(("", x)) => format!("{}", x + 0.0),
            _ => value.trim().to_owned(),
        };
        let values: Vec<String> = values
            .split(',')
            .map(|part| part.split_ascii_whitespace().map(short).collect::<Vec<_>>().join(" "))
            .collect();
        let text = plain(&format!("FRAME {word} {}", values.join(" ")));
        // Files state TRNTYP and CSYS in turn before each operation: each is compared with itself.
        if self.frames.get(word) == Some(&text) {
            return;
        }
        self.break_off(span);
        self.program.comment(&text, span);
        let first = self.frames.insert(word.to_owned(), text).is_none();
        // Under TRNTYP/WORLD positions stay in the frame of the work, whatever CSYS says of the operation.
        let world = self.frames.get("TRNTYP").is_some_and(|text| text.starts_with("FRAME TRNTYP WORLD"));
        if word == "CSYS" && world && !first {
            return;
        }
        self.initial = None;
        if self.program.has_moved() {
            if self.tool.is_none() {
                let message = "the frame changes here, and no tool was called that could be brought away before the program stops";
                return self.error("frame-tool", message, span);
            }
            self.program.reframed(span);
            self.diagnostics.push(
                Diagnostic::warning("frame-changes", "the frame of the positions changes here")
                    .at(span, "")
                    .hint("the tool is brought away and the program stops there, so that the work offset can be set; no position is transformed")
                    .hint("where the control takes a new offset with its word only, state that under [program] stop: [\"M0\", \"G54\"]"),
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::plain;

    #[test]
    fn remarks_are_taken_by_every_control() {
        assert_eq!(plain("  Généré (par)\tCATIA ~ 10° "), "Genere [par] CATIA - 10deg");
        assert_eq!(plain("Größe 中\u{7}"), "Groesse ??");
    }
}
