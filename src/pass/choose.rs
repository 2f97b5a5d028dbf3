//! Motions for a program, where `auto` leaves it open, the best first: the one with the fewest blocks that this machine
//! takes. Where its path cannot be proved the next is tried. At equal numbers the dialect's own order decides; through-point motions are never chosen,
//! since only the control knows their shape, and a path that is made of lines anyway is written as lines: a straight
//! one, and odd-even steps where the input asks for them.

use super::{convert, interpolate, place, settle};
use crate::diagnostic::{Diagnostic, Diagnostics, Warned};
use crate::dialect::{Form, Motion};
use crate::ir::{Curve, Cut, Described, Intent, Method, Passed, Role};
use crate::machine::{Machine, RotaryFeed};
use crate::units::Axis;

/// The motions for an intent, the best first. `fitted` is what splines are made of where runs of lines are to become some.
///
/// # Errors
/// No motion of the machine can hold the tolerance.
pub fn choose(
    intent: &Intent,
    fitted: Option<&Intent>,
    machine: &Machine,
    tolerance: f64,
) -> Result<Warned<Vec<&'static Motion>>, Diagnostics> {
    let mut warnings = Diagnostics::new();
    let source = fitted.unwrap_or(intent);
    // Where nothing is left to choose, a million points are not counted.
    if paths(source).next().is_none()
        && let Some(motion) = machine.dialect.motion_of(Form::Lines)
    {
        return Ok(Warned { value: vec![motion], warnings });
    }
    let blocked = machine.axes_without_spline(&moving_axes(source));
    let straight = paths(source).all(|curve| match curve {
        Curve::Logarithmic(log) => log.method == Method::OddEven || log.curve.is_straight(),
        Curve::Lines(_) | Curve::Arc(_) => true,
        Curve::Polynomial(_) | Curve::Nurbs(_) | Curve::Through(..) | Curve::Formula(_) => false,
    });
    let winds = place::winds(intent, machine);
    let turns = intent.logarithmic().any(|(log, ..)| log.curve.k() != 0.0);
    let timed = turns && machine.rotary_feed == RotaryFeed::InverseTime;
    // What splines do while the tip is led only second curves say.
    let led = intent.program.axes.direction().is_some() && !machine.orientation.second_curve;
    let mut found: Vec<(usize, &'static Motion)> = Vec::new();
    let mut errors = Diagnostics::new();
    for motion in machine.dialect.motions {
        let allowed = match motion.form {
            Form::Lines => true,
            Form::Polynomial { .. } | Form::Nurbs => {
                blocked.is_empty() && !straight && winds.is_none() && !timed && !led
            }
            Form::Through(_) => false,
        };
        if !allowed {
            continue;
        }
        let of = if motion.form == Form::Lines { intent } else { source };
        match blocks(of, motion.form, machine, tolerance) {
            Ok(n) => found.push((n, motion)),
            Err(error) => errors.extend(error),
        }
    }
    if found.is_empty() {
        return Err(errors);
    }
    // Stable: the dialect's order stays among equals.
    found.sort_by_key(|(count, _)| *count);
    if let Some(axis) = winds.filter(|_| !straight && blocked.is_empty()) {
        let message = format!(
            "written as lines: {axis} turns by more than 360 degrees, and on machine `{}` it wraps there",
            machine.name
        );
        warnings.push(
            Diagnostic::warning("spline-wraps", message)
                .hint(format!("set [axis.{axis}] kind = \"linear\" if the axis counts on")),
        );
    }
    if !straight && led {
        let message = format!(
            "written as lines: splines of machine `{}` do not go with a tip that is led",
            machine.name
        );
        warnings.push(Diagnostic::warning("spline-direction", message));
    } else if !blocked.is_empty() && !straight {
        let names: Vec<&str> = blocked.iter().map(Axis::as_str).collect();
        let names = names.join(", ");
        let allowed: Vec<String> =
            machine.spline.axes.iter().chain(&blocked).map(|axis| format!("\"{axis}\"")).collect();
        warnings.push(
            Diagnostic::warning(
                "spline-axes",
                format!("written as lines: machine `{}` does not let splines move {names}", machine.name),
            )
            .hint(format!(
                "where the control's splines do move {names}, say so {}",
                machine.to_state(&format!("[spline] axes = [{}]", allowed.join(", ")))
            )),
        );
    }
    Ok(Warned { value: found.into_iter().map(|(_, motion)| motion).collect(), warnings })
}

fn paths(intent: &Intent) -> impl Iterator<Item = &Curve> {
    let cuts = intent.program.steps.iter().filter_map(|located| located.step.cut());
    cuts.filter(|cut| cut.takes_motion()).map(|cut| &cut.curve)
}

/// The axes that paths move.
fn moving_axes(intent: &Intent) -> Vec<Axis> {
    let axes = &intent.program.axes;
    let moves = |i: usize| {
        paths(intent).any(|curve| match curve {
            Curve::Logarithmic(log) => {
                let c = &log.curve;
                [true, c.y_slope() != 0.0, c.z_slope() != 0.0, c.k() != 0.0].get(i).copied().unwrap_or(false)
            }
            Curve::Lines(line) | Curve::Through(_, line) => line.points().any(|p| p[i] != line.start[i]),
            Curve::Arc(arc) => {
                let (low, high) = arc.range();
                low[i] != high[i]
            }
            Curve::Polynomial(pieces) | Curve::Formula(Described { pieces, .. }) => {
                pieces.iter().any(|piece| piece.control_points().iter().any(|p| p[i] != piece.points[0][i]))
            }
            Curve::Nurbs(nurbs) => nurbs.points().iter().any(|p| p[i] != nurbs.points()[0][i]),
        })
    };
    (0..axes.count()).filter(|i| moves(*i)).map(|i| axes.name(i)).collect()
}

/// How many blocks the paths take in a form.
fn blocks(intent: &Intent, form: Form, machine: &Machine, tolerance: f64) -> Result<usize, Diagnostics> {
    let settled = settle::settle(intent.clone(), form, false, tolerance)?;
    // Steps are counted without being kept: there may be millions.
    let mut counted = 0;
    let mut rest = settled;
    rest.program.steps.retain(|located| {
        let Some(Cut { role: Role::Path, curve: Curve::Logarithmic(log), .. }) = located.step.cut() else {
            return true;
        };
        let steps = log.method == Method::OddEven && form == Form::Lines;
        if steps {
            counted += settle::steps(log).map_or(0, Iterator::count);
        }
        !steps
    });
    let program = interpolate::interpolate(&rest, form, machine, (tolerance, tolerance), true)?;
    Ok(counted + count(&convert::convert(program, form, machine, false)?))
}

/// How many blocks the paths of a converted program take, lines as asked among them.
fn count(program: &Passed<'_>) -> usize {
    let cuts = program.steps.iter().filter_map(|located| located.step.cut());
    cuts.filter(|cut| cut.role != Role::Approach)
        .map(|cut| match &*cut.curve {
            Curve::Lines(line) | Curve::Through(_, line) => line.count(),
            Curve::Polynomial(pieces) => pieces.len(),
            Curve::Arc(_) => 1,
            Curve::Nurbs(nurbs) => nurbs.points().len() - 1,
            Curve::Logarithmic(_) | Curve::Formula(_) => 0,
        })
        .sum()
}
