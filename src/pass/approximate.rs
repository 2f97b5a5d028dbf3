//! Curves that a form cannot take exactly are fitted, straight from the intent.
//!
//! | form | takes exactly | otherwise |
//! |---|---|---|
//! | POLY | pieces up to the machine's degree; rational ones where only X, Y and Z move | cubics |
//! | SPL | polynomial pieces up to degree 3 | cubics |
//! | BSPLINE, G06.2 | degree up to 3, weights within the control's range and decimals | cubics |
//! | lines | lines | as few chords as the tolerance allows |
//! | points for the control's own spline | lines | the ends of such chords |
//!
//! Where rounding alone would break the tolerance the exact form is given up too: a fit has no weights to round.

use super::convert::spline;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::dialect::Form;
use crate::geom::bezier::Bezier;
use crate::geom::chain::Chain;
use crate::geom::deviation::Metric;
use crate::geom::direction;
use crate::geom::fit::FitError;
use crate::geom::geometric;
use crate::ir::{Curve, Cut, Intent, Polyline, Role, Step};
use crate::machine::{Machine, Turn};
use crate::units::{Axes, DEGREES, Kind, Position};

/// Where a curve is.
pub struct Frame<'a> {
    /// The program's coordinates.
    pub axes: &'a Axes,
    /// The machine.
    pub machine: &'a Machine,
    /// The radius at which rotary axes count, mm.
    pub radius: f64,
}

impl Frame<'_> {
    /// The distance that a tolerance of so many mm holds; the tool's direction holds its own at the same time.
    pub fn metric(&self, tolerance: f64) -> Metric {
        let kinds: Vec<Kind> = self.axes.as_slice().iter().map(|(_, kind)| *kind).collect();
        Metric::with_direction(&kinds, self.radius, tolerance * DEGREES / self.machine.orientation.tolerance)
    }
}

/// The axes whose control points are not all one.
fn moving(pieces: &[Bezier]) -> Vec<usize> {
    let first = pieces.first().map(Bezier::start).unwrap_or_default();
    let moves =
        |axis: &usize| pieces.iter().flat_map(Bezier::control_points).any(|p| p[*axis] != first[*axis]);
    (0..first.len()).filter(moves).collect()
}

/// The most numbers of a polynomial block that is one of these pieces: of each axis its end and what follows of its degree, and
/// as many of a denominator.
fn words(pieces: &[Bezier], axes: &Axes) -> usize {
    let moved = moving(pieces);
    let second = axes.direction().is_some_and(|first| moved.iter().any(|i| first <= *i));
    let places = moved.iter().filter(|i| axes.direction().is_none_or(|first| **i < first)).count();
    let named = places + if second { 3 } else { 0 };
    let of = |piece: &Bezier| (named + usize::from(!piece.is_polynomial())) * piece.degree;
    pieces.iter().map(of).max().unwrap_or(0)
}

/// Whether a form takes a curve exactly; if not, why.
///
/// # Errors
/// The reason, as part of a sentence.
pub fn exact(curve: &Curve, form: Form, frame: &Frame<'_>) -> Result<(), String> {
    let straight =
        matches!(curve, Curve::Lines(_) | Curve::Arc(_) | Curve::Through(..) | Curve::Logarithmic(_));
    if straight {
        return Ok(());
    }
    if matches!(curve, Curve::Formula(_)) {
        return Err("it is made of expressions".to_owned());
    }
    let pieces = curve.pieces();
    let degree = pieces.iter().map(|piece| piece.degree).max().unwrap_or(0);
    let rational = pieces.iter().any(|piece| !piece.is_polynomial());
    let axes = frame.axes;
    let above = |most: usize| format!("its degree is {degree}, and {most} is the most here");
    match form {
        Form::Lines | Form::Through(_) => Err("it is no line".to_owned()),
        Form::Polynomial { closing: true } if rational => Err("these blocks have no weights".to_owned()),
        Form::Polynomial { closing: true } if 3 < degree => Err(above(3)),
        Form::Polynomial { closing: true } => Ok(()),
        Form::Polynomial { closing: false } if frame.machine.spline.poly_degree < degree => {
            Err(above(frame.machine.spline.poly_degree))
        }
        Form::Polynomial { closing: false }
            if frame.machine.spline.poly_words < words(&pieces, frame.axes) =>
        {
            let (words, most) = (words(&pieces, frame.axes), frame.machine.spline.poly_words);
            Err(format!("its blocks would have up to {words} numbers, and {most} is the most here"))
        }
        Form::Polynomial { closing: false } => {
            let geometry = |i: &usize| ["X", "Y", "Z"].contains(&axes.name(*i).as_str());
            match moving(&pieces).into_iter().find(|i| !geometry(i)) {
                Some(i) if rational => {
                    Err(format!("a denominator divides X, Y and Z only, not {}", axes.name(i)))
                }
                _ => Ok(()),
            }
        }
        Form::Nurbs => match curve {
            Curve::Nurbs(nurbs) => spline::adapted(nurbs.clone(), frame.machine).map(|_| ()),
            Curve::Polynomial(_)
            | Curve::Formula(_)
            | Curve::Lines(_)
            | Curve::Arc(_)
            | Curve::Through(..)
            | Curve::Logarithmic(_) => spline::joined(pieces, true, axes, frame.machine).map(|_| ()),
        },
    }
}

/// A curve in a shape that `form` takes exactly: itself where that is one and `may_be_exact`, otherwise a fit within
/// `tolerance` mm.
///
/// # Errors
/// The tolerance is out of reach, or the machine's splines cannot move these axes together.
pub fn approximate(
    curve: &Curve,
    form: Form,
    frame: &Frame<'_>,
    tolerance: f64,
    may_be_exact: bool,
) -> Result<Curve, Diagnostic> {
    if matches!(curve, Curve::Lines(_) | Curve::Arc(_) | Curve::Through(..) | Curve::Logarithmic(_)) {
        return Ok(curve.clone());
    }
    let spline = matches!(form, Form::Polynomial { .. } | Form::Nurbs);
    let pieces = curve.pieces();
    if spline && !frame.machine.spline.shared_parameter {
        let rotary = moving(&pieces).into_iter().find(|i| frame.axes.kind(*i) == Kind::Rotary);
        if let Some(axis) = rotary {
            let name = frame.axes.name(axis);
            let message = format!("without UPATH {name} follows the arc length, which makes another curve");
            return Err(Diagnostic::refusal("arc-length", message).hint("lines move all axes together"));
        }
    }
    let first = frame.axes.direction().filter(|_| !pieces.is_empty());
    let turns = first.is_some_and(|first| moving(&pieces).iter().any(|i| first <= *i));
    // What splines do while the tip is led only second curves say; splines through points have none.
    let through = matches!(form, Form::Through(_));
    let led = first.is_some() && !frame.machine.orientation.second_curve;
    if (spline && led) || (through && (led || turns)) {
        let message = format!("splines of machine `{}` do not go with a tip that is led", frame.machine.name);
        return Err(Diagnostic::refusal("spline-direction", message).hint("--motion linear does"));
    }
    if spline && may_be_exact && exact(curve, form, frame).is_ok() {
        return Ok(curve.clone());
    }
    let out_of_reach = |error: FitError| {
        Diagnostic::refusal("tolerance-out-of-reach", error.to_string()).hint("allow a larger tolerance")
    };
    // Of a direction only the angle counts: it is followed at length 1.
    let length = first.map_or(1.0, |first| direction::length(&pieces[0].start(), first));
    let pieces = direction::scaled(&pieces, first, 1.0 / length);
    let metric = frame.metric(tolerance);
    let scaled: Vec<Bezier> = pieces.iter().map(|piece| metric.scaled(piece)).collect();
    let Some(chain) = Chain::new(&scaled) else {
        return Err(Diagnostic::refusal("curve-empty", "this curve has no length"));
    };
    if spline {
        let mut cubics = geometric::cubics(&chain, tolerance).map_err(out_of_reach)?;
        for piece in &mut cubics {
            *piece = metric.unscaled(piece);
        }
        return Ok(Curve::Polynomial(direction::scaled(&cubics, first.filter(|_| turns), length)));
    }
    // Where the rotary axes go evenly they leave the plane between two directions, next to Z by most: lines are shorter there.
    let tilts = frame.machine.orientation.turn == Turn::Tilt;
    let departure = |line: &Bezier| match first.filter(|_| tilts) {
        Some(first) => {
            let of = |place: &Position| [place[first], place[first + 1], place[first + 2]];
            metric.reach() * direction::tilt_departure(&of(&line.start()), &of(&line.end()))
        }
        None => 0.0,
    };
    let chords = geometric::chords_with(&chain, tolerance, departure).map_err(out_of_reach)?;
    let place = |point: &Position| {
        let place = metric.unscaled(&Bezier::line(*point, *point)).start();
        first.map_or(place, |first| direction::unit(&place, first))
    };
    let start = pieces[0].start();
    let start = first.map_or(start, |first| direction::unit(&start, first));
    let mut line = Polyline::new(start, frame.axes.count());
    for point in &chords {
        line.push(&place(point));
    }
    Ok(Curve::Lines(line))
}

/// Whether any curve of an intent could be written exactly, so that it makes a difference whether it is.
pub fn may_be_exact(intent: &Intent) -> bool {
    let cuts = || intent.program.steps.iter().filter_map(|located| located.step.cut());
    cuts().any(|cut| cut.role == Role::Path && matches!(cut.curve, Curve::Polynomial(_) | Curve::Nurbs(_)))
}

/// A note for each curve that is not written exactly, with the reason.
pub fn notes(intent: &Intent, form: Form, machine: &Machine, exact_was_tried: bool) -> Diagnostics {
    let mut notes = Diagnostics::new();
    if matches!(form, Form::Lines | Form::Through(_)) {
        return notes;
    }
    let frame = Frame { axes: &intent.program.axes, machine, radius: intent.radius() };
    for located in &intent.program.steps {
        let Step::Cut(Cut { role: Role::Path, curve, .. }) = &located.step else { continue };
        if matches!(curve, Curve::Lines(_) | Curve::Arc(_) | Curve::Through(..) | Curve::Logarithmic(_)) {
            continue;
        }
        let reason = match exact(curve, form, &frame) {
            Err(reason) => reason,
            Ok(()) if exact_was_tried => "rounding its numbers would break the tolerance".to_owned(),
            Ok(()) => continue,
        };
        let message = format!("this curve is fitted by cubics: {reason}");
        notes.push(Diagnostic::note("curve-fitted", message).at(located.span, ""));
    }
    notes
}
