//! Where the length of a tool is ended: at the end of the program, at a place clear of the work.
//!
//! On some controls the word that ends a length moves Z by it, or does not, as a parameter says (Mazak: G49). So it is
//! written only where both are safe: Z is at its home, and X and Y have been brought to the place that the machine file
//! states, clear of the work. Where it states none the word is not written at all, unless the machine file says that it moves
//! nothing. Between tools it is not needed: the next call replaces the length.

use super::Z;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::ir::{Auxiliary, Curve, Intent, Located, Step};
use crate::machine::Machine;
use crate::source::Span;

/// Ends the length of the last tool, where that is safe. A program that was written for another machine may have ended it there.
pub(super) fn park(intent: &mut Intent, machine: &Machine) {
    let steps = &mut intent.program.steps;
    unpark(steps);
    let frame = &machine.frame;
    if frame.length_end.is_empty() || !machine.calls_length() || intent.program.axes.direction().is_some() {
        return;
    }
    let park = machine.park().filter(|_| frame.length_end_moves);
    if park.is_none() && frame.length_end_moves {
        return;
    }
    let moves = |located: &Located<f64, Curve>| match located.step {
        Step::Home(_) | Step::Rapid(_) | Step::Cut(_) => true,
        Step::Comment(_)
        | Step::Tool(_)
        | Step::Spindle(_)
        | Step::Coolant
        | Step::Shift(_)
        | Step::Auxiliary(_) => false,
    };
    let Some(last) = steps.iter().rposition(moves).filter(|at| steps[*at].step == Step::Home(Z)) else {
        return;
    };
    let span = steps[last].span;
    let over = park.into_iter().flat_map(|[_, x, y]| [Step::Home(x), Step::Home(y)]);
    let ended = over.chain([Step::Auxiliary(Auxiliary::LengthEnd)]).map(|step| Located { step, span });
    let ended: Vec<Located<f64, Curve>> = ended.collect();
    // Behind the plane that a tilted tool is turned upright by: in it the tool would turn at another height.
    let plane = |located: &&Located<f64, Curve>| {
        matches!(located.step, Step::Auxiliary(Auxiliary::Plane(_) | Auxiliary::PlaneEnd))
    };
    let behind = last + 1 + steps[last + 1..].iter().take_while(plane).count();
    steps.splice(behind..behind, ended);
}

/// Takes out every end of a length, and the way to the park place before it.
fn unpark(steps: &mut Vec<Located<f64, Curve>>) {
    let ends = |located: &Located<f64, Curve>| located.step == Step::Auxiliary(Auxiliary::LengthEnd);
    while let Some(at) = steps.iter().position(ends) {
        let away = |located: &&Located<f64, Curve>| matches!(located.step, Step::Home(axis) if axis != Z);
        let homes = steps[..at].iter().rev().take_while(away).count();
        steps.drain(at - homes..=at);
    }
}

/// Where ending tool centre point control may move Z, its lines go to the park place before.
///
/// # Errors
/// They do not, or the machine file states no such place.
pub(super) fn parks_before(machine: &Machine, span: Span) -> Result<(), Diagnostics> {
    let frame = &machine.frame;
    let ends = frame.tip_control_end.iter().position(|line| {
        let words = crate::machine::line::words(&line.0);
        words.iter().any(|word| machine.dialect.ends_length.iter().any(|code| word.is(code)))
    });
    let Some(at) = ends.filter(|_| frame.length_end_moves) else { return Ok(()) };
    let line = &frame.tip_control_end[at].0;
    if !frame.tip_control_end[..at].iter().any(|line| line.variables().any(|name| name == "home")) {
        let message = format!(
            "`{line}` of tip_control_end may move Z by the length of the tool, and no line goes home before it"
        );
        return Err(Diagnostic::refusal("park-missing", message)
            .at(span, "")
            .hint("begin tip_control_end with `G0 G53 {home}`; length_end_moves = false says that it moves nothing")
            .into());
    }
    if machine.park().is_none() {
        let message = format!(
            "`{line}`, which ends tool centre point control, may move Z by the length of the tool, and the machine file states no park place for it"
        );
        return Err(Diagnostic::refusal("park-missing", message)
            .at(span, "")
            .hint("state [axis.X] home and [axis.Y] home beside [axis.Z] home, in machine coordinates and clear of the work")
            .hint("[program] length_end_moves = false says that it moves nothing")
            .into());
    }
    Ok(())
}
