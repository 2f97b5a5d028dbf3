//! CIP: an arc by its end and a place on the way, which stand in I1 J1 K1.

use super::{Block, Reader};
use crate::decimal::Decimal;
use crate::dialect::arc;
use crate::geom::arc::Plane;
use crate::ir::{ArcBy, WrittenArc, through};
use crate::source::Span;
use std::ops::Range;

/// The words of the place on the way, in the order of X Y Z.
const WAY: [&str; 3] = ["I1", "J1", "K1"];

impl Reader<'_> {
    /// A coordinate of the place on the way.
    pub(super) fn way(&mut self, name: &str, value: Decimal, range: Range<usize>, block: &mut Block) {
        let axis = WAY.iter().position(|known| *known == name);
        let Some(axis) = axis.filter(|i| self.assembler.axis(["X", "Y", "Z"][*i]) == Some(*i)) else {
            let message = format!("AC(…) is read in I1 J1 K1 of CIP only, not in {name}");
            return self.assembler.error("word-unknown", message, range);
        };
        if block.way[axis].is_some() {
            return self.assembler.error("axis-twice", format!("{name} stands twice in this block"), range);
        }
        block.way[axis] = self.assembler.units(axis, value, range);
    }

    /// A block of CIP. Its three places have to lie in X Y, Z X or Y Z: other planes have no place in what is read.
    pub(super) fn arc_by(&mut self, block: &Block, line: u32, span: Span) {
        let whole = span.start as usize..span.end as usize;
        let [Some(x), Some(y), Some(z)] = block.way else {
            let message = "CIP states a place on the way in I1=AC(…), J1=AC(…) and K1=AC(…)";
            return self.assembler.error("arc-way", message, whole);
        };
        let end = self.assembler.target(block.named());
        let start = self.assembler.start(&end, span);
        let mut way = start;
        (way[0], way[1], way[2]) = (x, y, z);
        let planes = [Plane::Xy, Plane::Zx, Plane::Yz];
        let flat = planes.into_iter().filter(|plane| {
            let [.., w] = plane.axes();
            start[w] == way[w] && start[w] == end[w]
        });
        let circles = flat.filter_map(|plane| {
            through(plane, &self.assembler.digits, &start, &way, &end).map(|(sense, _)| (plane, sense))
        });
        let Some((plane, sense)) = { circles }.next() else {
            let message = "these three places make no arc in X Y, Z X or Y Z";
            return self.assembler.error("arc-plane", message, whole);
        };
        let arc = WrittenArc { plane, sense, start, end, by: ArcBy::Way(way), line };
        arc::add(&mut self.assembler, arc, &end, span);
    }
}
