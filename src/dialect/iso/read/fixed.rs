//! What a line of the machine file leaves in force, and words that state what is so anyway.
//!
//! `G0 G53 Z0.` retracts and leaves G0 behind: the block after it is a rapid, though it says nothing. So the machine's own lines are
//! read as far as they change what later words mean; what they change in a way that nobody can say is taken for unknown.

use super::words::{Word, word};
use super::{Block, Motion, Reader};
use crate::decimal::Decimal;
use crate::dialect::frame::Frame;
use crate::dialect::{Dialect, Form};
use crate::geom::arc::{Plane, Sense};
use crate::ir::ThroughKind;
use crate::machine::RotaryFeed;
use crate::source::Span;
use std::ops::Range;

/// Codes of how exactly the control runs, in tenths, and what it starts with.
const RUNNING: &[(i64, &str)] = &[(610, "G64"), (611, "G64"), (640, "G64")];

/// G groups of which a block has one code: the plane, G90, G94, G21, G40, G43, G54, G64, G69.
const GROUPS: [&[i64]; 9] = [
    &[170, 180, 190],
    &[900, 910],
    &[930, 940, 950],
    &[200, 210],
    &[400, 410, 420],
    &[430, 440, 490],
    &[540, 550, 560, 570, 580, 590],
    &[610, 611, 640],
    &[680, 690],
];

/// A plane by its code in tenths.
pub(super) fn plane(tenths: i64) -> Option<Plane> {
    match tenths {
        170 => Some(Plane::Xy),
        180 => Some(Plane::Zx),
        190 => Some(Plane::Yz),
        _ => None,
    }
}

impl Reader<'_> {
    /// A line of the machine file, without remarks.
    pub(super) fn fixed(&mut self, code: &str, frame: &Frame<'_>, span: Span) {
        let range = span.start as usize..span.end as usize;
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
        let codes = words.iter().filter_map(|word| match word {
            Word::Address(b'G', value) => value.units(1),
            Word::Address(..) | Word::Assignment(..) | Word::FeedParameter(_) | Word::Remark(_) => None,
        });
        let codes: Vec<i64> = codes.collect();
        // G4 X2. lasts 2 s.
        let dwells = codes.contains(&40);
        let value = |letter: u8| {
            words.iter().find_map(|word| match word {
                Word::Address(own, value) if *own == letter => value.units(0),
                Word::Address(..) | Word::Assignment(..) | Word::FeedParameter(_) | Word::Remark(_) => None,
            })
        };
        for (tenths, letter) in [(50, b'P'), (51, b'Q')] {
            if let (true, Some(how)) = (codes.contains(&tenths), value(letter)) {
                self.high_speed_runs(tenths, how, &range, true);
            }
        }
        for tenths in codes {
            self.leaves(tenths, &range);
        }
        for word in &words {
            let axis = match word {
                Word::Address(b'F', _) | Word::FeedParameter(_) if !dwells => {
                    self.flush();
                    self.assembler.lose_feed();
                    continue;
                }
                Word::Address(letter, _) => self.assembler.letter(*letter),
                Word::Assignment(name, _) => self.assembler.axis(name),
                Word::FeedParameter(_) | Word::Remark(_) => None,
            };
            if let Some(axis) = axis.filter(|_| !dwells && !frame.counts()) {
                self.assembler.lose(axis);
            }
        }
    }

    /// What a code of the machine's own leaves in force.
    fn leaves(&mut self, tenths: i64, range: &Range<usize>) {
        if let Some(motion) = motion(tenths, self.assembler.machine.dialect) {
            self.flush();
            // A curve has no end in such a line, so that nobody goes on with it.
            self.motion = if matches!(motion, Motion::Rapid | Motion::Line) { motion } else { Motion::None };
        } else if tenths == 800 {
            self.flush();
            self.motion = Motion::None;
        } else if let Some(plane) = plane(tenths) {
            self.plane = plane;
        } else if matches!(tenths, 540 | 550 | 560 | 570 | 580 | 590) {
            self.assembler.work_offset(&format!("G{}", tenths / 10), range.clone(), true);
        } else if matches!(tenths, 930 | 940) {
            if self.assembler.machine.rotary_feed == RotaryFeed::InverseTime {
                self.counts_time(tenths == 930);
            }
        } else {
            self.runs(tenths, range, true);
        }
    }

    /// G93 or G94. A change of what F counts leaves none in force.
    pub(super) fn counts_time(&mut self, inverse: bool) {
        self.flush();
        if self.assembler.inverse != inverse {
            self.assembler.lose_feed();
        }
        self.assembler.inverse = inverse;
    }

    /// G61, G61.1 or G64: how exactly the control runs; whether it is one of them.
    pub(super) fn runs(&mut self, tenths: i64, range: &Range<usize>, fixed: bool) -> bool {
        let Some((_, usual)) = RUNNING.iter().find(|(code, _)| *code == tenths) else { return false };
        let word = format!("G{}", Decimal::new(tenths, 1));
        let span = self.assembler.span(range.clone());
        self.assembler.stated.runs(usual, &word, span, fixed);
        true
    }

    /// G5 P and G5.1 Q.
    pub(super) fn high_speed_runs(&mut self, tenths: i64, how: i64, range: &Range<usize>, fixed: bool) {
        let (usual, word) =
            if tenths == 50 { ("G5 P0", format!("G5 P{how}")) } else { ("G5.1 Q0", format!("G5.1 Q{how}")) };
        let span = self.assembler.span(range.clone());
        self.assembler.stated.runs(usual, &word, span, fixed);
    }

    /// Whether a block has another code of the same group already: which of both holds controls say in different ways.
    pub(super) fn conflicts(&mut self, tenths: i64, range: &Range<usize>, block: &mut Block) -> bool {
        let Some(group) = GROUPS.iter().position(|codes| codes.contains(&tenths)) else { return false };
        let known = &mut block.codes[group];
        if *known != 0 && *known != tenths {
            self.error("codes-conflict", "two codes of one group in one block", range.clone());
            return true;
        }
        *known = tenths;
        false
    }
}

/// A code of motion, in tenths, where the dialect has it.
pub(super) fn motion(tenths: i64, dialect: &Dialect) -> Option<Motion> {
    let has = |form| dialect.motion_of(form).is_some();
    match tenths {
        0 => Some(Motion::Rapid),
        10 => Some(Motion::Line),
        20 => Some(Motion::Arc(Sense::Clockwise)),
        30 => Some(Motion::Arc(Sense::CounterClockwise)),
        62 if has(Form::Nurbs) => Some(Motion::Nurbs),
        61 if has(Form::Through(ThroughKind::Fine)) => Some(Motion::Through),
        _ => None,
    }
}
