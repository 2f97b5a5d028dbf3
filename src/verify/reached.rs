//! Whether the tool is where a path begins.
//!
//! A path is proved from its start on, so that its start must be known: a block before it has brought every axis there. What
//! brings an axis is a rapid or a path that ends in it. What makes it unknown again is its retraction, which leads to a place in
//! machine coordinates; a tool call and the end of a length, which may move the machine as they like; and every change of what
//! places count from, a tilted plane and the control of the tool's tip. This is told from the blocks that were read alone,
//! whatever a pass meant.
//!
//! One block needs no start: a straight move that was asked from nowhere, to its end. It brings the tool, and names the axes that
//! nothing has brought.

use super::Cursor;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::ir::{Auxiliary, Curve, Decimals, Step, Units, Written};
use crate::units::MAX_AXES;
use std::collections::BTreeMap;

/// The axes that no block has brought where a cut begins, by the number of its step; of those where there are some.
pub(super) type Unreached = BTreeMap<usize, [bool; MAX_AXES]>;

/// Where a curve starts and ends.
fn ends(curve: &Written) -> Option<(Units, Units)> {
    match curve {
        Written::Lines(points) | Written::Through(_, points) => Some((points.start, points.points().last()?)),
        Written::Arc(arc) => Some((arc.start, arc.end)),
        Written::Polynomial(polynomial) => Some((polynomial.start, polynomial.blocks.last()?.end)),
        Written::Nurbs(nurbs) => Some((*nurbs.points.first()?, *nurbs.points.last()?)),
    }
}

/// Where each cut of a program begins without a block that brought all axes there.
pub(super) fn unreached(decimals: &Decimals) -> Unreached {
    // A direction is stated with each path that needs one.
    let axes = &decimals.program.axes;
    let count = axes.direction().unwrap_or(axes.count());
    let mut at: [Option<i64>; MAX_AXES] = [None; MAX_AXES];
    let mut all = Unreached::new();
    for (number, located) in decimals.program.steps.iter().enumerate() {
        match &located.step {
            Step::Home(axis) => at[*axis] = None,
            Step::Tool(_) => at = [None; MAX_AXES],
            Step::Auxiliary(auxiliary) => match auxiliary {
                Auxiliary::TipControl
                | Auxiliary::TipControlEnd
                | Auxiliary::LengthEnd
                | Auxiliary::Plane(_)
                | Auxiliary::PlaneEnd => at = [None; MAX_AXES],
                Auxiliary::CoolantStop
                | Auxiliary::SpindleStop
                | Auxiliary::Stop
                | Auxiliary::OptionalStop
                | Auxiliary::Dwell(_) => {}
            },
            Step::Rapid(targets) => {
                for (axis, to) in targets {
                    at[*axis] = to.units(decimals.digits[*axis]);
                }
            }
            Step::Cut(cut) => {
                let Some((start, end)) = ends(&cut.curve) else { continue };
                // A control accepts a start that is off by a unit of the last decimal; how far it is off is in the bound.
                let is_there = |axis: usize| at[axis].is_some_and(|at| at.abs_diff(start[axis]) <= 1);
                let missing = std::array::from_fn(|axis| axis < count && !is_there(axis));
                if missing.contains(&true) {
                    all.insert(number, missing);
                }
                (0..count).for_each(|axis| at[axis] = Some(end[axis]));
            }
            // A work offset changes what the text counts from, and no place.
            Step::Comment(_) | Step::Spindle(_) | Step::Coolant | Step::Shift(_) => {}
        }
    }
    all
}

impl Cursor<'_> {
    /// Holds the start of the path that comes next.
    pub(super) fn begins_where_the_tool_is(&self, asked: &Curve) -> Result<(), Diagnostics> {
        let Some(missing) = self.unreached.get(&self.at).filter(|_| self.within == 0) else { return Ok(()) };
        let axes = &self.decimals.program.axes;
        let count = axes.direction().unwrap_or(axes.count());
        let from_nowhere = match asked {
            Curve::Lines(line) => {
                line.points().next().is_some_and(|first| first[..count] == line.start[..count])
            }
            Curve::Arc(_)
            | Curve::Polynomial(_)
            | Curve::Nurbs(_)
            | Curve::Through(..)
            | Curve::Logarithmic(_)
            | Curve::Formula(_) => false,
        };
        let is_line = self
            .step()
            .and_then(|located| located.step.cut())
            .is_some_and(|cut| matches!(cut.curve, Written::Lines(_)));
        let brings = |axis: usize| is_line && from_nowhere && !self.decimals.unnamed[axis];
        let Some(axis) = (0..count).find(|axis| missing[*axis] && !brings(*axis)) else { return Ok(()) };
        let name = axes.name(axis);
        let message = format!("this path starts where no block before has brought {name}");
        let diagnostic = Diagnostic::refusal("start-unreached", message).hint(format!(
            "a move that names {name} has to stand before it, behind its retraction, the tool call or the change of the plane"
        ));
        Err(match self.step() {
            Some(step) => diagnostic.at(self.place(step), "").into(),
            None => diagnostic.into(),
        })
    }
}
