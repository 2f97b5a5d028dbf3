//! G codes and M functions within a block.

use super::fixed::{motion, plane};
use super::{Block, Motion, Reader};
use crate::decimal::Decimal;
use crate::diagnostic::Diagnostic;
use crate::geom::arc::Plane;
use crate::machine::RotaryFeed;
use std::ops::Range;

/// Codes that state what the IR assumes anyway; in tenths.
const STATE_CODES: &[i64] = &[150, 210, 400, 490, 670, 690, 800, 900, 940, 970, 980];

/// Codes under which the same words are another path, and what they mean; in tenths.
const REFUSED_CODES: &[(i64, &str)] = &[
    (40, "a dwell is not read"),
    (200, "inches are not read"),
    (280, "the home position is the machine's own"),
    (410, "cutter radius compensation is not read"),
    (420, "cutter radius compensation is not read"),
    (434, "tool centre point control is not read"),
    (435, "tool centre point control is not read"),
    (530, "machine coordinates are not read"),
    (612, "modal spline interpolation makes curves of lines, which only the control knows"),
    (680, "a turned coordinate system is not read"),
    (910, "incremental positions are not read"),
    (930, "inverse time feed is not read"),
    (950, "feed a revolution is not read"),
];

impl Reader<'_> {
    pub(super) fn m_function(&mut self, value: Decimal, range: Range<usize>) {
        let diagnostic = Diagnostic::error("m-function", format!("M{value} is not read here"));
        let hint = if matches!(value.units(0), Some(2 | 30)) {
            "the program ends with the footer of the machine file, line by line and in its order"
        } else {
            "M functions are read where they are whole lines of the machine file"
        };
        self.assembler.diagnostics.push(diagnostic.at(self.assembler.span(range), "").hint(hint));
    }

    /// A G code.
    pub(super) fn code(&mut self, value: Decimal, range: Range<usize>, block: &mut Block) {
        let Some(tenths) = value.units(1) else { return self.code_unknown(None, value, range) };
        if self.conflicts(tenths, &range, block) {
            return;
        }
        if let Some(motion) = motion(tenths, self.assembler.machine.dialect) {
            if block.motion.is_some_and(|other| other != motion) {
                return self.error("codes-conflict", "two codes of motion in one block", range);
            }
            block.motion = Some(motion);
            return;
        }
        if let Some(plane) = plane(tenths) {
            if plane == Plane::Xy || self.assembler.machine.arc_planes {
                block.plane = Some(plane);
            } else {
                self.length_elsewhere(plane, "[arcs] planes = true says that it does not", range);
            }
            return;
        }
        match tenths {
            50 | 51 => block.high_speed = Some((tenths, range)),
            430 => block.offset = Some(range),
            540 | 550 | 560 | 570 | 580 | 590 => {
                self.assembler.work_offset(&format!("G{value}"), range, false);
            }
            930 | 940 if self.assembler.machine.rotary_feed == RotaryFeed::InverseTime => {
                self.counts_time(tenths == 930);
            }
            490 if self.assembler.leads_tip() => {
                let message = "G49 ends leading the tip, with the lines of the machine file";
                self.error("tip-control", message, range);
            }
            // Where it may move Z, it does so while the next call of the length is due, too.
            490 if self.offset_tool.is_some()
                || (self.offset_due.is_some() && self.assembler.machine.frame.length_end_moves) =>
            {
                let message = "G49 ends the length of the tool, with the lines of the machine file";
                self.error("tool-offset", message, range);
            }
            // Some controls then have no motion at all, and some G0 or G1 by a parameter.
            800 => {
                self.flush();
                self.motion = Motion::None;
            }
            690 if self.assembler.is_tilted() => {
                let message = "G69 ends the tilted plane, with the lines of the machine file";
                self.error("plane", message, range);
            }
            _ if self.runs(tenths, &range, false) || STATE_CODES.contains(&tenths) => {}
            _ => self.code_unknown(Some(tenths), value, range),
        }
    }

    fn code_unknown(&mut self, tenths: Option<i64>, value: Decimal, range: Range<usize>) {
        match REFUSED_CODES.iter().find(|(code, _)| Some(*code) == tenths) {
            Some((_, why)) => self.error("code-refused", format!("G{value}: {why}"), range),
            None => self.error("word-unknown", format!("`G{value}` is not understood"), range),
        }
    }
}
