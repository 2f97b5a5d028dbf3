//! What a line of the machine file leaves in force, and words that state what is so anyway.
//!
//! `G0 SUPA Z0 D0` retracts, and leaves G0 and D0 behind: the block after it is a rapid without the length of the tool, though it
//! says neither. So the machine's own lines are read as far as they change what later words mean; what they change in a way that
//! nobody can say is taken for unknown.

use super::super::words::{Word, word};
use super::{Block, Motion, Reader};
use crate::decimal::Decimal;
use crate::diagnostic::Diagnostic;
use crate::dialect::frame::Frame;
use crate::geom::arc::Plane;
use crate::machine::RotaryFeed;
use crate::source::Span;
use crate::units::Kind;
use std::ops::Range;

/// Words of how exactly the control runs, and what it starts with.
const RUNNING: &[(&str, &str)] =
    &[("G60", "G64"), ("G64", "G64"), ("G601", "G601"), ("SOFT", "BRISK"), ("COMPOF", "COMPOF")];

/// Words of which a block has one.
const ONCE: [&str; 10] = ["F", "I", "J", "K", "PL", "PW", "SD", "A3", "B3", "C3"];
/// Behind them: G17 to G19.
pub(super) const PLANE: u16 = 1 << 10;
/// SD.
pub(super) const DEGREE: u16 = 1 << 11;
/// TRANS.
pub(super) const TRANS: u16 = 1 << 12;

/// The motion words that are names.
const CURVES: &[&str] = &["CIP", "POLY", "BSPLINE", "ASPLINE", "CSPLINE"];

/// The code of a settable work offset.
fn is_work_offset(code: i64) -> bool {
    matches!(code, 54..=57 | 500 | 505..=599)
}

/// The words of a line before its remark, and the remark with its mark; a `;` within quotes is none.
pub(super) fn parted(line: &str) -> (&str, &str) {
    let mut quoted = false;
    for (at, byte) in line.bytes().enumerate() {
        match byte {
            b'"' => quoted = !quoted,
            b';' if !quoted => return (line[..at].trim_ascii_end(), &line[at..]),
            _ => {}
        }
    }
    (line, "")
}

impl Reader<'_> {
    /// A line of the machine file.
    pub(super) fn fixed(&mut self, line: &str, frame: &Frame<'_>, span: Span) {
        let range = span.start as usize..span.end as usize;
        let (code, _) = parted(line);
        let mut words = Vec::new();
        let mut rest = code;
        while !rest.is_empty() {
            match word(rest) {
                Ok((after, found)) => {
                    words.push(found);
                    rest = after.trim_ascii_start();
                }
                Err(_) => rest = rest.find([' ', '\t']).map_or("", |at| rest[at..].trim_ascii_start()),
            }
        }
        // G4 F2 lasts 2 s.
        let dwells = words.contains(&Word::Address("G", Decimal::new(4, 0)));
        for word in &words {
            match *word {
                Word::Address("G", value) => {
                    if let Some(code) = value.units(0) {
                        self.leaves(code, &range);
                    }
                }
                Word::Address("D", value) => self.length = Some(!value.is_zero()),
                Word::Address("F", _) | Word::FeedParameter(_) if !dwells => {
                    self.flush();
                    self.assembler.lose_feed();
                }
                Word::Address(name, _)
                | Word::Shortest(name, _)
                | Word::Way(name, _)
                | Word::Polynomial(name, _) => {
                    let axis = self.assembler.axis(name).filter(|_| !dwells && !frame.counts());
                    if let Some(axis) = axis {
                        self.assembler.lose(axis);
                    }
                }
                Word::Keyword("UPATH") => self.upath = true,
                Word::Keyword("SPATH") => self.upath = false,
                Word::Keyword("TRANS") if !frame.counts() => self.assembler.shift(Vec::new(), true, span),
                Word::Keyword(name) if CURVES.contains(&name) => {
                    self.flush();
                    // Such a line has no end of a curve, so that nobody goes on with it.
                    self.motion = Motion::None;
                }
                Word::Keyword(name) => {
                    self.runs(name, &range, true);
                }
                Word::Call("FGROUP", arguments) => {
                    if !arguments.trim().is_empty() && !self.is_path_group(arguments, true) {
                        let message =
                            "FGROUP names other axes than F counts by [feed] rotary of the machine file";
                        self.assembler.error("fgroup-axes", message, range.clone());
                    }
                }
                Word::FeedParameter(_) | Word::Call(..) => {}
            }
        }
    }

    /// What a code of the machine's own leaves in force.
    fn leaves(&mut self, code: i64, range: &Range<usize>) {
        match code {
            0 | 1 => self.set_motion(if code == 0 { Motion::Rapid } else { Motion::Line }),
            2 | 3 => self.set_motion(Motion::None),
            17 => self.plane = Plane::Xy,
            18 => self.plane = Plane::Zx,
            19 => self.plane = Plane::Yz,
            _ if is_work_offset(code) => self.assembler.work_offset(&format!("G{code}"), range.clone(), true),
            _ => {
                self.runs(&format!("G{code}"), range, true);
            }
        }
    }

    /// Whether F counts the linear axes of the program by this group, all and no others; in the machine's own lines also the rotary
    /// ones, where its file says so.
    pub(super) fn is_path_group(&self, arguments: &str, fixed: bool) -> bool {
        let axes = self.assembler.machine.axes;
        let rotary = fixed && self.assembler.machine.rotary_feed != RotaryFeed::Free;
        let named: Vec<_> = arguments.split(',').map(|name| self.assembler.axis(name.trim())).collect();
        let counted = |i: &usize| named.contains(&Some(*i)) == (axes.kind(*i) == Kind::Linear);
        named.iter().all(Option::is_some)
            && (0..axes.count()).all(|i| counted(&i) || (rotary && axes.kind(i) == Kind::Rotary))
    }

    /// A word of how exactly the control runs; whether it is one.
    pub(super) fn runs(&mut self, word: &str, range: &Range<usize>, fixed: bool) -> bool {
        let Some((_, usual)) = RUNNING.iter().find(|(known, _)| *known == word) else { return false };
        let span = self.assembler.span(range.clone());
        self.assembler.stated.runs(usual, word, span, fixed);
        true
    }

    /// A G code that is no motion; whether it is known.
    pub(super) fn state_code(&mut self, code: i64, range: &Range<usize>) -> bool {
        if (54..=57).contains(&code) {
            self.assembler.work_offset(&format!("G{code}"), range.clone(), false);
            return true;
        }
        matches!(code, 40 | 71 | 710 | 90 | 94) || self.runs(&format!("G{code}"), range, false)
    }

    /// A block has one word of each kind: of two, the control takes one, or neither.
    pub(super) fn once(&mut self, name: &str, range: &Range<usize>, block: &mut Block) {
        let Some(kind) = ONCE.iter().position(|known| *known == name) else { return };
        if block.kinds & (1 << kind) != 0 {
            let message = format!("{name} stands twice in this block");
            return self.assembler.error("word-twice", message, range.clone());
        }
        block.kinds |= 1 << kind;
    }

    /// The motion word of a block.
    pub(super) fn motion_word(&mut self, motion: Motion, range: &Range<usize>, block: &mut Block) {
        if block.motion.is_some_and(|other| other != motion) {
            return self.assembler.error("codes-conflict", "two words of motion in one block", range.clone());
        }
        block.motion = Some(motion);
        self.set_motion(motion);
    }

    /// TRANS alone ends the work offset.
    pub(super) fn ends_shift(&mut self, block: &Block, span: Span) {
        let alone = block.count == 0 && block.kinds == TRANS && block.motion.is_none();
        if alone {
            self.flush();
            return self.assembler.shift(Vec::new(), true, span);
        }
        let message =
            "TRANS is read alone, where it ends all shifts, and as the machine file's lines of a work offset";
        self.assembler.error("shift-alone", message, span.start as usize..span.end as usize);
    }

    /// Whether Z may move: not behind D0, where it would count without the length of the tool.
    pub(super) fn has_length(&mut self, block: &Block, span: Span) -> bool {
        let z = self.assembler.letter(b'Z');
        if self.length != Some(false) || !block.named().iter().any(|(axis, _)| Some(*axis) == z) {
            return true;
        }
        self.assembler.diagnostics.push(
            Diagnostic::error("tool-length", "Z moves without the length of the tool, which D0 ended")
                .at(span, "")
                .hint("call the tool again before it, with the lines of the machine file"),
        );
        self.length = None;
        false
    }
}
