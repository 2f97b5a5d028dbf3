//! Where a cut begins, the tool has to be.
//!
//! A path of lines whose first place is its start is one from nowhere: the input says where the tool goes, not where it comes
//! from. Where no move has brought it there, that first line is a move of its own, which brings it; what follows may then
//! become a spline, which begins where the tool is. A curve from nowhere is none: which one it is depends on its start.

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::ir::{Auxiliary, Curve, Cut, Intent, Located, Role, Step};
use crate::units::MAX_AXES;

/// Puts the line that brings the tool to the start of a path into a cut of its own.
///
/// # Errors
/// A curve starts where no move has brought the tool.
pub(super) fn reach(intent: &mut Intent) -> Result<(), Diagnostics> {
    let axes = intent.program.axes;
    // A direction is stated with each path that needs one.
    let count = axes.direction().unwrap_or(axes.count());
    let mut brought = [false; MAX_AXES];
    let mut all = Vec::with_capacity(intent.program.steps.len() + 1);
    for located in std::mem::take(&mut intent.program.steps) {
        let span = located.span;
        match located.step {
            Step::Cut(Cut { feed, role, curve }) => {
                let missing = (0..count).find(|axis| !brought[*axis]);
                brought = [true; MAX_AXES];
                match (curve, missing) {
                    (Curve::Lines(line), Some(_))
                        if line.points().next() == Some(line.start) && 1 < line.count() =>
                    {
                        let (first, rest) = (line.part(0, 1), line.part(1, line.count()));
                        let cut = |role, line| Step::Cut(Cut { feed, role, curve: Curve::Lines(line) });
                        all.push(Located { step: cut(Role::Approach, first), span });
                        all.push(Located { step: cut(role, rest), span });
                    }
                    // Those of a cutter follow approaches that it makes itself.
                    (curve @ (Curve::Lines(_) | Curve::Logarithmic(_)), _) | (curve, None) => {
                        all.push(Located { step: Step::Cut(Cut { feed, role, curve }), span });
                    }
                    (
                        Curve::Arc(_)
                        | Curve::Polynomial(_)
                        | Curve::Nurbs(_)
                        | Curve::Through(..)
                        | Curve::Formula(_),
                        Some(axis),
                    ) => {
                        let name = axes.name(axis);
                        let message = format!("this curve starts where no move before has brought {name}");
                        return Err(Diagnostic::error("start-unreached", message)
                            .at(span, "")
                            .hint("a move to its start has to stand before it, behind the tool call or the retraction")
                            .into());
                    }
                }
                continue;
            }
            Step::Home(axis) => brought[axis] = false,
            Step::Tool(_)
            | Step::Auxiliary(
                Auxiliary::TipControl
                | Auxiliary::TipControlEnd
                | Auxiliary::LengthEnd
                | Auxiliary::Plane(_)
                | Auxiliary::PlaneEnd,
            ) => brought = [false; MAX_AXES],
            Step::Rapid(ref targets) => targets.iter().for_each(|(axis, _)| brought[*axis] = true),
            Step::Comment(_) | Step::Spindle(_) | Step::Coolant | Step::Shift(_) | Step::Auxiliary(_) => {}
        }
        all.push(located);
    }
    intent.program.steps = all;
    Ok(())
}
