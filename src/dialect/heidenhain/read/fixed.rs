//! What a line of the machine file leaves in force: a feed, a place, a centre; and remarks behind words.
//!
//! Every move says what it is, so that no such line leaves a motion behind. What else it changes is taken for unknown until a block
//! states it again.

use super::Reader;
use crate::dialect::frame::Frame;
use crate::ir::Step;
use crate::source::Span;

/// Words behind which steps and centres count from a place that no page states.
const FRAMES: [&str; 4] = ["CYCL DEF", "TOOL CALL", "PLANE", "M91"];

impl Reader<'_, '_> {
    /// A line of the machine file.
    pub(super) fn fixed(&mut self, line: &str, frame: &Frame<'_>) {
        let code = line.split(';').next().unwrap_or_default();
        if FRAMES.iter().any(|words| code.contains(words)) {
            self.center = None;
            self.stated = Default::default();
        }
        // M128 F1000 is the speed of the axes that follow the tool, and not of the path.
        let follows = code.contains("M128") || code.contains("TCPM");
        let dwells = code.contains("CYCL DEF 9.");
        let moves = code.starts_with("L ") || code.starts_with("LN ");
        for word in code.split_ascii_whitespace().skip(1) {
            let Some((letter, value)) = word.split_at_checked(1) else { continue };
            let has_number =
                value.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.' | 'Q'));
            if letter == "F" && has_number && !follows && !dwells {
                self.flush();
                self.assembler.lose_feed();
            }
            let axis = letter.bytes().next().and_then(|letter| self.assembler.letter(letter));
            if let Some(axis) = axis.filter(|_| moves && has_number && !frame.counts()) {
                self.assembler.lose(axis);
            }
        }
    }

    /// A remark behind the words of a line.
    pub(super) fn remark(&mut self, text: &str, span: Span) {
        let text = text.trim();
        if !text.is_empty() {
            self.remarks.push((text.to_owned(), span));
        }
    }

    /// Remarks behind words come after what the words do, and behind a spline that they stand in.
    pub(super) fn tell_remarks(&mut self) {
        for (text, span) in std::mem::take(&mut self.remarks) {
            self.assembler.step(Step::Comment(text), span);
        }
    }
}
