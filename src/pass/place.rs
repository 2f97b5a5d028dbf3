//! Work offsets: where an axis wraps at 360 degrees, or where sections are to be alike, the text counts each flute from
//! a place of its own.
//!
//! A flute at index 270 that turns by 159 degrees ends at 429. An axis that wraps has no 429; counted from 270 the flute
//! runs from 0 to 159, and so does every other. Where the cutter turns by more than a whole turn, no offset helps: the
//! flute is counted from where it starts, and lines go round in steps.

mod coolant;
mod named;
mod park;
mod plane;
mod reach;
mod tip;
mod whole;

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::ir::{Auxiliary, Curve, Cut, Intent, Located, Logarithmic, Polyline, Role, Shift, Step};
use crate::machine::{Machine, PlaneApproach};
use crate::units::{Axes, Axis, DEGREES, Kind};

/// The axis that retracts before a tool turns: the third.
const Z: usize = 2;

/// The intent as this machine counts it: its axes' names, its homes, its work offsets.
///
/// # Errors
/// The machine lacks an axis, or has no lines for a work offset that is needed.
pub fn place(mut intent: Intent, machine: &Machine) -> Result<Intent, Diagnostics> {
    let is_cutter = intent.logarithmic().next().is_some();
    if is_cutter {
        let kinds = intent.program.axes;
        let named: Vec<_> =
            machine.cutter_axes.iter().enumerate().map(|(i, axis)| (*axis, kinds.kind(i))).collect();
        match Axes::new(&named) {
            Some(axes) => intent.program.axes = axes,
            None => {
                let message = format!("machine `{}` names an axis of the cutter twice", machine.name);
                return Err(Diagnostic::error("cutter-axes", message).into());
            }
        }
    }
    named::number(&mut intent, machine);
    named::name(&mut intent, machine);
    coolant::round_changes(&mut intent, machine);
    let machine = directions(&mut intent, machine)?;
    homes(&mut intent, &machine)?;
    if intent.program.axes.direction().is_none() {
        over_the_work(&mut intent, machine.orientation.plane_approach);
    }
    position_at_home(&mut intent);
    shifts(&mut intent, &machine)?;
    whole::places(&mut intent, &machine)?;
    reach::reach(&mut intent)?;
    named::remarks(&mut intent, &machine);
    park::park(&mut intent, &machine);
    Ok(intent)
}

/// Settles how the tool is turned: not at all, in planes, or with its tip led; the machine as that wants it.
fn directions(intent: &mut Intent, machine: &Machine) -> Result<Machine, Diagnostics> {
    // A program that was written before leads it already.
    let led = |located: &Located<f64, Curve>| located.step == Step::Auxiliary(Auxiliary::TipControl);
    if intent.program.steps.iter().any(led) {
        return machine.with_axes(&intent.program.axes);
    }
    plane::upright(intent, machine);
    let note = plane::tilt(intent, machine)?;
    let told = |mut errors: Diagnostics| {
        errors.0.extend(note.clone());
        errors
    };
    let machine = machine.with_axes(&intent.program.axes).map_err(told)?;
    tip::lead(intent, &machine).map_err(told)?;
    intent.warnings.0.extend(note);
    Ok(machine)
}

/// Leaves out retractions to a home that the machine file does not state.
///
/// # Errors
/// A tool begins with a cut, and nothing says where it is clear before.
fn homes(intent: &mut Intent, machine: &Machine) -> Result<(), Diagnostics> {
    let three = intent.program.axes.direction().is_none();
    let mut nowhere = false;
    for located in &intent.program.steps {
        match &located.step {
            Step::Home(axis) => nowhere = !machine.retracts(*axis),
            Step::Rapid(_) => nowhere = false,
            Step::Cut(_) if nowhere && three => {
                let message = "the first move of this tool cuts, and the machine file states no place in Z from which it could come";
                return Err(Diagnostic::refusal("home-missing", message)
                    .at(located.span, "")
                    .hint("[axis.Z] home of the machine file, or a rapid before the cut")
                    .into());
            }
            Step::Cut(_) => nowhere = false,
            Step::Comment(_)
            | Step::Tool(_)
            | Step::Spindle(_)
            | Step::Coolant
            | Step::Shift(_)
            | Step::Auxiliary(_) => {}
        }
    }
    let dropped = |step: &_| matches!(step, Step::Home(axis) if !machine.retracts(*axis));
    intent.program.steps.retain(|located| !dropped(&located.step));
    Ok(())
}

/// From its home the tool goes over the work before it goes down. A rapid that brings an axis from its home brings the others
/// first. Where a cut comes instead, the others go to its start at rapid, and the axis comes down to it at the feed of the cut:
/// it starts wherever home is. To a tilted plane the machine may want all axes at once.
fn over_the_work(intent: &mut Intent, approach: PlaneApproach) {
    let (count, steps) = (intent.program.axes.count(), &mut intent.program.steps);
    let mut home = None;
    let mut together = false;
    let mut all = Vec::with_capacity(steps.len());
    for mut located in std::mem::take(steps) {
        match &mut located.step {
            Step::Home(axis) => home = Some(*axis),
            Step::Rapid(targets) => {
                if let Some(axis) = home.take_if(|home| targets.iter().any(|(axis, _)| axis == home))
                    && !together
                {
                    let (down, over): (Vec<_>, Vec<_>) =
                        targets.iter().partition(|(named, _)| *named == axis);
                    if !over.is_empty() {
                        all.push(Located { step: Step::Rapid(over), span: located.span });
                    }
                    *targets = down;
                }
            }
            Step::Cut(cut) => {
                let span = located.span;
                // Where the line does not say where it starts, it is at its first place.
                let unsaid =
                    matches!(&cut.curve, Curve::Lines(line) if line.points().next() == Some(line.start));
                if let (Some(axis), Some((start, _))) = (home.take(), cut.curve.ends()) {
                    let targets = (0..count).filter(|i| *i != axis).map(|i| (i, start[i])).collect();
                    all.push(Located { step: Step::Rapid(targets), span });
                    if !unsaid {
                        let mut line = Polyline::new(start, count);
                        line.push(&start);
                        let down = Cut { feed: cut.feed, role: Role::Approach, curve: Curve::Lines(line) };
                        all.push(Located { step: Step::Cut(down), span });
                    }
                }
            }
            Step::Auxiliary(Auxiliary::Plane(angles)) => {
                together = approach == PlaneApproach::Together && *angles != [0.0; 3];
            }
            Step::Auxiliary(Auxiliary::PlaneEnd) => together = false,
            Step::Comment(_)
            | Step::Tool(_)
            | Step::Spindle(_)
            | Step::Coolant
            | Step::Shift(_)
            | Step::Auxiliary(_) => {}
        }
        all.push(located);
    }
    *steps = all;
}

/// From its home the tool goes over the work before it goes down: the rapids of the linear axes that the first section
/// makes in clear air are made once more before it.
fn position_at_home(intent: &mut Intent) {
    let axes = intent.program.axes;
    let steps = &mut intent.program.steps;
    let Some(first) = steps.iter().position(|located| matches!(located.step, Step::Comment(_))) else {
        return;
    };
    // The axis that is at home where the section starts: nothing brought it back to the work, and nothing was cut.
    let home = steps[..first].iter().fold(None, |home, located| match &located.step {
        Step::Home(axis) => Some(*axis),
        Step::Rapid(targets) => home.filter(|home| targets.iter().all(|(axis, _)| axis != home)),
        Step::Cut(_) | Step::Auxiliary(Auxiliary::Plane(_)) => None,
        Step::Comment(_)
        | Step::Tool(_)
        | Step::Spindle(_)
        | Step::Coolant
        | Step::Shift(_)
        | Step::Auxiliary(_) => home,
    });
    let Some(home) = home else { return };
    // Where the section itself goes over the work first, there is nothing to do before it.
    let next = steps[first..].iter().find_map(|located| match &located.step {
        Step::Rapid(targets) => Some(targets.iter().any(|(axis, _)| *axis == home)),
        Step::Cut(_) => Some(false),
        Step::Comment(_)
        | Step::Tool(_)
        | Step::Spindle(_)
        | Step::Coolant
        | Step::Home(_)
        | Step::Shift(_)
        | Step::Auxiliary(_) => None,
    });
    if next != Some(true) {
        return;
    }
    let moves = steps[first..].iter().take_while(|located| located.step.cut().is_none());
    let over: Vec<Located<f64, Curve>> = moves
        .filter(|located| match &located.step {
            Step::Rapid(targets) => {
                targets.iter().all(|(axis, _)| *axis != home && axes.kind(*axis) == Kind::Linear)
            }
            Step::Comment(_)
            | Step::Tool(_)
            | Step::Spindle(_)
            | Step::Coolant
            | Step::Home(_)
            | Step::Shift(_)
            | Step::Auxiliary(_)
            | Step::Cut(_) => false,
        })
        .cloned()
        .collect();
    // A program that was written before has them already.
    let same = |(a, b): (&Located<f64, Curve>, &Located<f64, Curve>)| a.step == b.step;
    let made =
        first.checked_sub(over.len()).is_some_and(|from| steps[from..first].iter().zip(&over).all(same));
    if !made {
        steps.splice(first..first, over);
    }
}

/// The first rotary axis, the one that a flute turns.
fn turning(intent: &Intent) -> Option<usize> {
    intent.program.axes.as_slice().iter().position(|(_, kind)| *kind == Kind::Rotary)
}

/// Degrees that A runs through on a path, with its index: least, greatest, and where it is run from.
fn turn(log: &Logarithmic) -> (f64, f64, f64) {
    let at = |x: f64| log.curve.index + log.curve.angle(x) * DEGREES;
    // An overrun goes on by two steps at most.
    let more = if log.overrun { 2.0 * log.dl.unwrap_or(super::settle::MAX_STEP) } else { 0.0 };
    let (start, end) = (at(log.curve.start()), at(log.curve.end() + more));
    (start.min(end), start.max(end), if log.back { end } else { start })
}

/// The rotary axis that wraps at 360 degrees and turns farther than that on a path, so that no spline can run it.
pub fn winds(intent: &Intent, machine: &Machine) -> Option<Axis> {
    let axis = machine.axes.name(turning(intent)?);
    let far = |(low, high, _): (f64, f64, f64)| MOST_TURN < high - low;
    let winds = machine.limits(axis).modulo && intent.logarithmic().any(|(log, ..)| far(turn(log)));
    winds.then_some(axis)
}

/// The most degrees that fit between 0 and 360 wherever a path starts within a degree.
const MOST_TURN: f64 = 359.0;

fn shifts(intent: &mut Intent, machine: &Machine) -> Result<(), Diagnostics> {
    let Some(axis) = turning(intent) else { return Ok(()) };
    let modulo = machine.limits(machine.axes.name(axis)).modulo;
    let outside = intent.logarithmic().any(|(log, ..)| {
        let (low, high, _) = turn(log);
        low < 0.0 || 360.0 < high
    });
    let wanted = (modulo && outside) || (machine.frame.subprograms && intent.logarithmic().next().is_some());
    let corrected = intent.program.steps.iter().any(|located| matches!(located.step, Step::Shift(_)));
    if (wanted || corrected) && machine.frame.shift.is_empty() {
        let message = format!("machine `{}` has no lines for a work offset", machine.name);
        return Err(Diagnostic::error("shift-missing", message)
            .hint("state them under [program]: shift = [\"TRANS {words}\"] or what the control calls it")
            .into());
    }
    if !wanted {
        return Ok(());
    }
    let mut steps: Vec<Located<f64, Curve>> = Vec::with_capacity(intent.program.steps.len() + 8);
    let mut rest = std::mem::take(&mut intent.program.steps).into_iter().peekable();
    // From a remark to the next one is a section; behind the last path nothing is shifted any more.
    let mut section: Vec<Located<f64, Curve>> = Vec::new();
    while let Some(located) = rest.next() {
        section.push(located);
        let ends = rest.peek().is_none_or(|next| match next.step {
            Step::Comment(_) | Step::Home(_) => true,
            Step::Shift(_) => section.iter().any(|located| located.step.cut().is_some()),
            Step::Tool(_)
            | Step::Spindle(_)
            | Step::Coolant
            | Step::Auxiliary(_)
            | Step::Rapid(_)
            | Step::Cut(_) => false,
        });
        if ends {
            if let Some(to) = offset(&section) {
                count_from(&mut section, Shift { axis, to, parameter: false });
            }
            steps.append(&mut section);
        }
    }
    unshift(&mut steps, axis);
    intent.program.steps = steps;
    Ok(())
}

/// From where a section counts its rotary axis.
fn offset(section: &[Located<f64, Curve>]) -> Option<f64> {
    let path = section.iter().find_map(|located| match located.step.cut() {
        Some(Cut { curve: Curve::Logarithmic(log), .. }) => Some(log),
        Some(_) | None => None,
    })?;
    let ((low, high, start), index) = (turn(path), path.curve.index);
    // Whole degrees beside the index, so that the offset can be read.
    let least = if high - low <= MOST_TURN { low } else { start };
    Some(index + (least - index).floor())
}

/// Puts a work offset at the head of a section, behind its remark.
fn count_from(section: &mut Vec<Located<f64, Curve>>, shift: Shift<f64>) {
    let remarks = section.iter().take_while(|located| matches!(located.step, Step::Comment(_))).count();
    if let Some(Located { step: Step::Shift(shifts), .. }) = section.get_mut(remarks) {
        shifts.insert(0, shift);
    } else {
        let span = section[0].span;
        section.insert(remarks, Located { step: Step::Shift(vec![shift]), span });
    }
}

/// Behind the last path the axis counts from the work's own zero again.
fn unshift(steps: &mut Vec<Located<f64, Curve>>, axis: usize) {
    let Some(last) = steps.iter().rposition(|located| located.step.cut().is_some()) else { return };
    let retracted =
        steps[last..].iter().take_while(|located| matches!(located.step, Step::Cut(_) | Step::Rapid(_)));
    let at = last + retracted.count();
    let zero = Shift { axis, to: 0.0, parameter: false };
    if let Some(Located { step: Step::Shift(shifts), .. }) = steps.get_mut(at) {
        shifts.insert(0, zero);
    } else {
        let span = steps[last].span;
        steps.insert(at, Located { step: Step::Shift(vec![zero]), span });
    }
}
