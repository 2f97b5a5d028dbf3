//! What no input asks for, the retraction and the way between paths, is clear of all that is cut.
//!
//! A tool goes to the retract position and from there to the next path at rapid, and from there to its start at feed.
//! So the position lies beyond everything that is cut, on the side where the tool is and the work is not:
//!
//! | axis | that side |
//! |---|---|
//! | Z | the greater: the tool stands above the work |
//! | Y of a cutter | the greater: Y grows away from the cutter's axis |
//! | Y and Z with an infeed | where the stock is, as the sign of the infeed says |
//! | another axis of a job | either, where the curves begin and end on it: the tool lies in the work across its own axis |

use crate::decimal::Decimal;
use crate::diagnostic::Diagnostic;
use crate::source::Span;
use crate::units::Axis;

/// The least distance of a retraction from what is cut, mm. Each of the two may be off in the program by half its last decimal,
/// and the path by the tolerance too: microns together, where a machine file does not ask for less.
const CLEARANCE: f64 = 0.01;

/// On which side of what is cut it is clear.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// At greater coordinates.
    Greater,
    /// At lesser coordinates.
    Less,
}

/// Where an axis is while the tool cuts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Reach {
    pub(super) least: f64,
    pub(super) greatest: f64,
}

impl Reach {
    /// Nowhere yet.
    pub(super) const NONE: Reach = Reach { least: f64::INFINITY, greatest: f64::NEG_INFINITY };

    /// Takes a coordinate in.
    pub(super) fn take(&mut self, x: f64) {
        *self = Reach { least: self.least.min(x), greatest: self.greatest.max(x) };
    }

    /// Where the side begins.
    pub(super) fn edge(&self, side: Side) -> f64 {
        match side {
            Side::Greater => self.greatest,
            Side::Less => self.least,
        }
    }
}

/// Which axis goes where, and where that stands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Retraction {
    pub(super) axis: Axis,
    pub(super) to: f64,
    pub(super) span: Span,
}

impl Retraction {
    /// What is wrong with a retraction from what is cut to a side. `why` says how the side is known.
    pub(super) fn not_clear(&self, cut: Reach, side: Side, why: &str) -> Option<Diagnostic> {
        let Retraction { axis, to, span } = *self;
        if !(cut.least <= cut.greatest) {
            return None;
        }
        let (clear, beyond) = match side {
            Side::Greater => (to - cut.greatest, to < cut.least),
            Side::Less => (cut.least - to, cut.greatest < to),
        };
        if CLEARANCE <= clear {
            return None;
        }
        let from_to = format!("{axis} {} to {}", shown(cut.least), shown(cut.greatest));
        let (id, message) = if beyond {
            ("retract-through-work", format!("{axis} {to} is on the other side of what is cut, {from_to}"))
        } else {
            ("retract-not-clear", format!("{axis} {to} is not clear of what is cut, {from_to}"))
        };
        let word = match side {
            Side::Greater => "above",
            Side::Less => "below",
        };
        let edge = shown(cut.edge(side));
        Some(
            Diagnostic::error(id, message)
                .at(span, "")
                .hint(format!("retract to a position well {word} {axis} {edge}: {why}")),
        )
    }

    /// The side of what is cut on which the retraction lies, where either may be clear.
    pub(super) fn side(&self, cut: Reach) -> Side {
        if self.to - cut.greatest < cut.least - self.to { Side::Less } else { Side::Greater }
    }

    /// What is wrong with a retraction across the tool's axis, where a path begins or ends: what is cut lies on the way.
    pub(super) fn through(&self, cut: Reach, ends: [f64; 2], off: f64, span: Span) -> Option<Diagnostic> {
        let Retraction { axis, to, .. } = *self;
        let edge = cut.edge(self.side(cut));
        let inside = ends.into_iter().find(|end| off < (edge - end).abs())?;
        let (inside, edge) = (shown(inside), shown(edge));
        let message = format!(
            "between {axis} {inside}, an end of this path, and {axis} {to} is what is cut, up to {axis} {edge}"
        );
        Some(Diagnostic::error("retract-through-work", message).at(span, "").hint(format!(
            "retract along Z, the axis of the tool, or begin and end each path at {axis} {edge}"
        )))
    }
}

/// A coordinate as a message shows it.
fn shown(x: f64) -> String {
    Decimal::round(x, 4).unwrap_or_default().to_string()
}
