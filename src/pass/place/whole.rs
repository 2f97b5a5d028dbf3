//! Rapids under tool centre point control, for controls whose straight blocks state X Y Z beside the tool's direction.

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::ir::{Auxiliary, Intent, Step};
use crate::machine::Machine;

/// X, Y and Z.
const PLACES: usize = 3;

/// Names X, Y and Z in every rapid of a program that states the tool's direction, where the control wants them so.
///
/// # Errors
/// A rapid leaves an axis out, and where that axis is nobody knows.
pub(super) fn places(intent: &mut Intent, machine: &Machine) -> Result<(), Diagnostics> {
    let axes = intent.program.axes;
    let Some(first) = axes.direction().filter(|_| machine.dialect.directed_places) else { return Ok(()) };
    let mut at = [None; PLACES];
    for located in &mut intent.program.steps {
        match &mut located.step {
            Step::Rapid(targets) => {
                for (axis, to) in targets.iter().filter(|(axis, _)| *axis < PLACES) {
                    at[*axis] = Some(*to);
                }
                if !targets.iter().any(|(axis, _)| first <= *axis) {
                    continue;
                }
                let mut whole = Vec::with_capacity(axes.count());
                for (axis, place) in at.iter().enumerate() {
                    let Some(place) = place else {
                        let name = axes.name(axis);
                        let message =
                            format!("a rapid states the tool's direction, and nothing says where {name} is");
                        return Err(Diagnostic::refusal("place-unknown", message)
                            .at(located.span, "")
                            .hint(
                                "on this control such a block states X, Y and Z: name all three in the input",
                            )
                            .into());
                    };
                    whole.push((axis, *place));
                }
                whole.extend(targets.iter().filter(|(axis, _)| PLACES <= *axis));
                *targets = whole;
            }
            Step::Cut(cut) => {
                if let Some((_, end)) = cut.curve.ends() {
                    (0..PLACES).for_each(|axis| at[axis] = Some(end[axis]));
                }
            }
            Step::Home(axis) => {
                if let Some(place) = at.get_mut(*axis) {
                    *place = None;
                }
            }
            Step::Auxiliary(Auxiliary::Plane(_) | Auxiliary::PlaneEnd) => at = [None; PLACES],
            Step::Auxiliary(_)
            | Step::Comment(_)
            | Step::Tool(_)
            | Step::Spindle(_)
            | Step::Coolant
            | Step::Shift(_) => {}
        }
    }
    Ok(())
}
