//! Work offsets: where an axis wraps at 360 degrees, or where sections are to be alike, the text counts each flute from
//! a place of its own.
//!
//! A flute at index 270 that turns by 159 degrees ends at 429. An axis that wraps has no 429; counted from 270 the flute
//! runs from 0 to 159, and so does every other. Where the cutter turns by more than a whole turn, no offset helps: the
//! flute is counted from where it starts, and lines go round in steps.

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::geom::bezier::Bezier;
use crate::geom::direction;
use crate::ir::{Auxiliary, Curve, Cut, Described, Intent, Located, Logarithmic, Shift, Step};
use crate::machine::Machine;
use crate::units::{Axes, Axis, DEGREES, Kind, MAX_AXES, Position};

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
    let machine = machine.with_axes(&intent.program.axes)?;
    lead_tip(&mut intent, &machine);
    homes(&mut intent, &machine);
    position_at_home(&mut intent);
    shifts(&mut intent, &machine)?;
    Ok(intent)
}

/// The cosine of the greatest tilt at which the tool goes to the work along its own axis; beyond it goes down.
const STEEP: f64 = 0.5;

/// In five axes the tip is led from the first move of each tool on. Z retracts before each tool is called; behind it the tool
/// turns with its tip at safe height, and goes to where the first move begins along its own axis.
///
/// No retraction stands between the call of a tool and its first move: on some controls it would end the length of the tool.
fn lead_tip(intent: &mut Intent, machine: &Machine) {
    let axes = intent.program.axes;
    let Some(first) = axes.direction() else { return };
    let steps = std::mem::take(&mut intent.program.steps);
    let safe = machine.orientation.safe_height.unwrap_or_else(|| highest(&steps));
    let mut led = false;
    let mut all: Vec<Located<f64, Curve>> = Vec::with_capacity(steps.len() + 8);
    let switch = |auxiliary| Step::Auxiliary(auxiliary);
    let mut last = None;
    for located in steps {
        let span = located.span;
        last = Some(span);
        let target = match &located.step {
            Step::Tool(_) => {
                if led {
                    all.push(Located { step: switch(Auxiliary::TipControlEnd), span });
                }
                all.push(Located { step: Step::Home(Z), span });
                led = false;
                None
            }
            Step::Rapid(targets) if !led => {
                let mut place = [0.0; MAX_AXES];
                for (axis, to) in targets {
                    place[*axis] = *to;
                }
                Some((place, true))
            }
            Step::Cut(cut) if !led => start_of(&cut.curve).map(|place| (place, false)),
            Step::Rapid(_)
            | Step::Cut(_)
            | Step::Comment(_)
            | Step::Spindle(_)
            | Step::Coolant
            | Step::Home(_)
            | Step::Shift(_)
            | Step::Auxiliary(_) => None,
        };
        if let Some((place, rapid)) = target {
            led = true;
            all.push(Located { step: switch(Auxiliary::TipControl), span });
            let above = above(&place, first, safe);
            if above != place || !rapid {
                let targets = (0..axes.count()).map(|i| (i, above[i])).collect();
                all.push(Located { step: Step::Rapid(targets), span });
            }
        }
        all.push(located);
    }
    if let Some(span) = last.filter(|_| led) {
        all.extend([switch(Auxiliary::TipControlEnd), Step::Home(Z)].map(|step| Located { step, span }));
    }
    intent.program.steps = all;
}

/// The axis that retracts before the tool turns: the third.
const Z: usize = 2;

/// The place at safe height from which the tool goes to its first place along its own axis, or straight down where it is
/// tilted by more than 60 degrees.
fn above(place: &Position, first: usize, safe: f64) -> Position {
    let unit = direction::unit(place, first);
    let mut above = *place;
    if safe <= place[Z] {
        return above;
    }
    let up = unit[first + 2];
    if STEEP <= up {
        let along = (safe - place[Z]) / up;
        for i in 0..Z {
            above[i] += along * unit[first + i];
        }
    }
    above[Z] = safe;
    above
}

/// Where a curve starts; none of one that has no place of its own.
fn start_of(curve: &Curve) -> Option<Position> {
    match curve {
        Curve::Lines(line) | Curve::Through(_, line) => Some(line.start),
        Curve::Arc(arc) => Some(arc.start()),
        Curve::Nurbs(nurbs) => nurbs.points().first().copied(),
        Curve::Polynomial(pieces) | Curve::Formula(Described { pieces, .. }) => {
            pieces.first().map(Bezier::start)
        }
        Curve::Logarithmic(_) => None,
    }
}

/// The greatest Z that the tip goes to.
fn highest(steps: &[Located<f64, Curve>]) -> f64 {
    let mut highest = f64::NEG_INFINITY;
    let mut take = |z: f64| highest = highest.max(z);
    for located in steps {
        match &located.step {
            Step::Rapid(targets) => {
                targets.iter().filter(|(axis, _)| *axis == Z).for_each(|(_, z)| take(*z));
            }
            Step::Cut(cut) => {
                if let Some(start) = start_of(&cut.curve) {
                    take(start[Z]);
                }
                match &cut.curve {
                    Curve::Lines(line) => line.points().for_each(|p| take(p[Z])),
                    Curve::Arc(arc) => take(arc.range().1[Z]),
                    Curve::Nurbs(nurbs) => nurbs.points().iter().for_each(|p| take(p[Z])),
                    Curve::Through(..) | Curve::Polynomial(_) | Curve::Formula(_) | Curve::Logarithmic(_) => {
                    }
                }
            }
            Step::Comment(_)
            | Step::Tool(_)
            | Step::Spindle(_)
            | Step::Coolant
            | Step::Home(_)
            | Step::Shift(_)
            | Step::Auxiliary(_) => {}
        }
    }
    highest
}

/// Leaves out retractions to a home that the machine file does not state.
fn homes(intent: &mut Intent, machine: &Machine) {
    intent.program.steps.retain(|located| match located.step {
        Step::Home(axis) => machine.home(axis).is_some() && !machine.frame.home.is_empty(),
        Step::Comment(_)
        | Step::Tool(_)
        | Step::Spindle(_)
        | Step::Coolant
        | Step::Shift(_)
        | Step::Auxiliary(_)
        | Step::Rapid(_)
        | Step::Cut(_) => true,
    });
}

/// From its home the tool goes over the work before it goes down: the rapids of the linear axes that the first section
/// makes in clear air are made once more before it.
fn position_at_home(intent: &mut Intent) {
    let axes = intent.program.axes;
    let steps = &mut intent.program.steps;
    let home = steps.iter().find_map(|located| match located.step {
        Step::Home(axis) => Some(axis),
        Step::Comment(_)
        | Step::Tool(_)
        | Step::Spindle(_)
        | Step::Coolant
        | Step::Shift(_)
        | Step::Auxiliary(_)
        | Step::Rapid(_)
        | Step::Cut(_) => None,
    });
    let Some(home) = home else { return };
    let Some(first) = steps.iter().position(|located| matches!(located.step, Step::Comment(_))) else {
        return;
    };
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
