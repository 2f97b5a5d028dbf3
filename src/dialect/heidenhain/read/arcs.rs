//! Arcs: `CC X+10 Y+0` states the centre, `C X+15 Y+5 DR+` goes round it.

use super::{Block, Reader};
use crate::dialect::arc;
use crate::geom::arc::Plane;
use crate::ir::WrittenArc;
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
        if block.feed.is_some() {
            self.assembler.feed = block.feed;
        }
        let end = self.assembler.target(block.named());
        let start = self.assembler.start(&end, span);
        let sense = arc::counted_sense(self.assembler.machine, Plane::Xy, sense);
        let arc = WrittenArc { plane: Plane::Xy, sense, start, end, center, line };
        arc::add(&mut self.assembler, arc, &end, span);
    }
}
