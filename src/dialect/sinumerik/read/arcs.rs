//! CIP: an arc by its end and a place on the way, which stand in I1 J1 K1. TURN, and the planes of G2 and G3.

use super::{Block, Reader};
use crate::decimal::Decimal;
use crate::diagnostic::Diagnostic;
use crate::dialect::arc;
use crate::dialect::sinumerik::takes_planes;
use crate::geom::arc::Plane;
use crate::ir::{ArcBy, Written, WrittenArc};
use crate::source::Span;
use crate::verify::to_arc;
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

    /// TURN: whole turns before the way to the end.
    pub(super) fn turn(&mut self, value: Decimal, range: Range<usize>, block: &mut Block) {
        let most = self.assembler.machine.dialect.arcs.most_turns;
        let turns = value.units(0).and_then(|turns| u32::try_from(turns).ok()).filter(|turns| *turns <= most);
        match turns {
            None => {
                let message = format!("TURN is a whole number up to {most}");
                self.assembler.error("arc-turns", message, range);
            }
            Some(_) if block.turns.is_some() => {
                self.assembler.error("axis-twice", "TURN stands twice in this block", range);
            }
            Some(turns) => block.turns = Some(turns),
        }
    }

    /// G18 and G19, where they leave the length of the tool where it is.
    pub(super) fn take_plane(&mut self, plane: Plane, range: Range<usize>) {
        if takes_planes(self.assembler.machine) {
            self.plane = plane;
            return;
        }
        let message = format!(
            "in {} the control may take the tool's length along another axis: no machine file says that it does not",
            arc::plane_word(plane)
        );
        let span = self.assembler.span(range);
        self.assembler.diagnostics.push(
            Diagnostic::error("arc-plane", message)
                .at(span, "")
                .hint("[arcs] planes = true says so, and that no tip is led there"),
        );
    }

    /// A block of CIP. Its three places make a circle in any plane.
    pub(super) fn arc_by(&mut self, block: &Block, line: u32, span: Span) {
        let whole = span.start as usize..span.end as usize;
        let [Some(x), Some(y), Some(z)] = block.way else {
            let message = "CIP states a place on the way in I1=AC(…), J1=AC(…) and K1=AC(…)";
            return self.assembler.error("arc-way", message, whole);
        };
        if !arc::is_placed(&mut self.assembler, &[0, 1, 2], &[], 2, span) {
            return;
        }
        let end = self.assembler.target(block.named());
        let start = self.assembler.start(block.named(), &end, span);
        let mut way = start;
        (way[0], way[1], way[2]) = (x, y, z);
        let arc = WrittenArc { start, end, by: ArcBy::Way(way), line };
        if to_arc(&self.assembler.empty(), &arc).is_none() {
            let message = "these three places make no arc";
            return self.assembler.error("arc-plane", message, whole);
        }
        self.assembler.curve(Written::Arc(arc), &end, span);
    }
}
