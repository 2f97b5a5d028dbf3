//! Arcs: `CC X+10 Y+0` states the centre, `C X+15 Y+5 DR+` goes round it, and so does the helix `CP IPA+270 IZ-3 DR+`, by an
//! angle in degrees; and words that count from where an axis is.

use super::{Block, Reader, signed};
use crate::decimal::Decimal;
use crate::dialect::arc;
use crate::geom::arc::{Plane, Sense};
use crate::ir::{ArcBy, Circle, WrittenArc, turned_end};
use crate::source::Span;
use std::ops::Range;

impl Reader<'_, '_> {
    /// CC: the centre of the arcs that follow, in X and Y.
    pub(super) fn center(&mut self, block: &Block, head: Range<usize>) {
        let value = |axis| block.named().iter().find(|(named, _)| *named == axis).map(|(_, units)| *units);
        let words = block.feed.is_some() || block.rapid || block.rotation.is_some();
        match (value(0), value(1)) {
            (Some(x), Some(y)) if block.count == 2 && !words => self.center = Some([x, y]),
            _ => self.assembler.error("arc-center", "CC states a centre in X and Y", head),
        }
    }

    /// C: an arc about the centre that CC stated.
    pub(super) fn arc(&mut self, block: &Block, line: u32, head: Range<usize>, span: Span) {
        let Some(sense) = block.rotation else {
            return self.assembler.error("rotation-missing", "C states its rotation, DR+ or DR-", head);
        };
        let Some(center) = self.center else {
            return self.assembler.error("arc-center", "C without a CC before it", head);
        };
        if block.rapid || block.named().iter().any(|(axis, _)| 1 < *axis) || block.count == 0 {
            return self.assembler.error("arc-end", "C ends in X and Y and does not move at rapid", head);
        }
        if !arc::is_placed(&mut self.assembler, &[0, 1], &[], 2, span) {
            return;
        }
        if block.feed.is_some() {
            self.assembler.feed = block.feed;
        }
        let end = self.assembler.target(block.named());
        let start = self.assembler.start(block.named(), &end, span);
        let sense = arc::counted_sense(self.assembler.machine, Plane::Xy, sense);
        let by = ArcBy::Center(Circle { plane: Plane::Xy, sense, center }, 0);
        let arc = WrittenArc { start, end, by, line };
        arc::add(&mut self.assembler, arc, &end, span);
    }

    /// A step of an axis that goes round past 360 degrees.
    pub(super) fn step(&mut self, letter: u8, value: Decimal, range: Range<usize>, block: &mut Block) {
        let Some(axis) = self.assembler.letter(letter) else { return self.axis_unknown(letter, range) };
        if block.polar {
            return self.rise(axis, value, range, block);
        }
        let text = format!("I{}{}", char::from(letter), signed(value));
        if axis == 2 && !self.assembler.wraps(axis) {
            return self.assembler.error("arc-word", format!("`{text}` belongs to CP"), range);
        }
        if !self.assembler.wraps(axis) {
            return self.other(&text, range);
        }
        if block.spline {
            let message = format!("SPL says where it ends, not by how much it goes on, as in `{text}`");
            return self.assembler.error("spline-step", message, range);
        }
        if !self.stated[axis] {
            let message =
                format!("`{text}` goes on from a place that was stated before a tool, a shift or a plane");
            return self.assembler.error("step-unknown", message, range);
        }
        let value = self.assembler.coefficient(axis, value);
        let to = value
            .units(self.assembler.digits[axis])
            .and_then(|step| self.assembler.position[axis]?.checked_add(step));
        let Some(units) = to else {
            let message =
                format!("`{text}` goes on from a place that the text does not say, or has too many decimals");
            return self.assembler.error("step-unknown", message, range);
        };
        self.name_axis(block, (axis, letter), units, range);
    }

    /// IPA: how far a CP turns.
    pub(super) fn turn(&mut self, value: Decimal, range: Range<usize>, block: &mut Block) {
        if !block.polar || block.turn.is_some() {
            return self.assembler.error("arc-word", "IPA belongs to CP, once", range);
        }
        block.turn = Some(value);
    }

    /// IZ: how far a CP rises.
    pub(super) fn rise(&mut self, axis: usize, value: Decimal, range: Range<usize>, block: &mut Block) {
        if axis != 2 || block.rise.is_some() {
            return self.assembler.error("arc-word", "CP rises along Z, once: IZ", range);
        }
        block.rise = self.assembler.coefficient(axis, value).units(self.assembler.digits[axis]);
        if block.rise.is_none() {
            let message = format!("IZ {value} has more decimals than the machine file gives this axis");
            self.assembler.error("digits-too-many", message, range);
        }
    }

    /// CP: a helix about the centre that CC stated, by an angle.
    pub(super) fn helix(&mut self, block: &Block, line: u32, head: Range<usize>, span: Span) {
        let (Some(sense), Some(turn)) = (block.rotation, block.turn) else {
            return self.assembler.error("helix", "CP states IPA and DR", head);
        };
        let Some(center) = self.center else {
            return self.assembler.error("arc-center", "CP without a CC before it", head);
        };
        if block.rapid || block.count != 0 {
            return self.assembler.error("helix", "CP ends by IPA and IZ and does not move at rapid", head);
        }
        let forth = if sense == Sense::CounterClockwise { Some(turn) } else { turn.times(-1) };
        let most = Decimal::new(360 * i64::from(self.assembler.machine.dialect.arcs.most_turns), 0);
        let Some(degrees) = forth.filter(|d| d.compare(Decimal::ZERO).is_gt() && d.compare(most).is_le())
        else {
            let message = format!("IPA has the sign of DR, and turns by {most} degrees at most");
            return self.assembler.error("helix", message, head);
        };
        if !arc::is_placed(&mut self.assembler, &[0, 1, 2], &[], 2, span) {
            return;
        }
        if block.feed.is_some() {
            self.assembler.feed = block.feed;
        }
        let mut end = self.assembler.target(&[]);
        let start = self.assembler.start(&[], &end, span);
        let sense = arc::counted_sense(self.assembler.machine, Plane::Xy, sense);
        let digits = self.assembler.digits;
        let Some(height) = start[2].checked_add(block.rise.unwrap_or(0)) else {
            return self.assembler.error("number-range", "IZ is out of range", head);
        };
        end[2] = height;
        let circle = Circle { plane: Plane::Xy, sense, center };
        let Some(end) = turned_end(&digits, (&start, &end), &circle, degrees) else {
            return self.assembler.error("number-range", "the end of this helix is out of range", head);
        };
        let by = ArcBy::Turn(circle, degrees);
        arc::add(&mut self.assembler, WrittenArc { start, end, by, line }, &end, span);
        self.loose = [true; 2];
    }

    /// Whether a block starts from a place in decimals, or is a straight move or a spline to one in X and Y. An arc may not
    /// start elsewhere: a whole circle whose end is not quite its start is next to nothing on the control.
    pub(super) fn is_exact(&mut self, block: &Block, arc: bool, head: Range<usize>) -> bool {
        let before = self.loose;
        if before == [false; 2] {
            return true;
        }
        for (axis, _) in block.named() {
            if let Some(loose) = self.loose.get_mut(*axis) {
                *loose = false;
            }
        }
        let loose = if arc { before } else { self.loose };
        let exact = block.rapid || block.count == 0 || loose == [false; 2];
        if !exact {
            let message =
                "behind CP a straight move names X and Y first: an angle leads to no place in decimals";
            self.assembler.error("helix-end", message, head);
        }
        exact
    }
}
