//! Settles what the input leaves open, so that the intent is one exact path.

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::dialect::Form;
use crate::geom::fit::{self, FitError};
use crate::geom::oddeven::{MAX_POINTS, OddEven, StepError, largest_step};
use crate::ir::{Curve, Intent, Logarithmic, Method, Step};

/// The greatest Δl taken where the input names none.
pub const MAX_STEP: f64 = 0.2;

/// The intent with method and Δl of every logarithmic curve decided for an output of `form`.
///
/// `auto` means odd-even steps for lines and the curve itself for splines. Where nobody `asked` for lines and the path is
/// straight, it means the curve itself too: one line is the whole of it.
///
/// # Errors
/// The Δl that would hold the tolerance makes too many points.
pub fn settle(mut intent: Intent, form: Form, asked: bool, tolerance: f64) -> Result<Intent, Diagnostics> {
    // Flutes differ in their index only, so one search serves them all.
    let mut found: Option<(Logarithmic, f64)> = None;
    let mut points = 0.0;
    for located in &mut intent.program.steps {
        let Step::Cut(cut) = &mut located.step else { continue };
        let Curve::Logarithmic(log) = &mut cut.curve else { continue };
        log.method = match log.method {
            Method::Auto if form == Form::Lines && (asked || !log.curve.is_straight()) => Method::OddEven,
            Method::Auto => Method::Direct,
            method @ (Method::OddEven | Method::Direct) => method,
        };
        if log.method != Method::OddEven {
            continue;
        }
        let too_many = |error: &StepError| {
            Diagnostic::refusal("points-too-many", format!("holding {tolerance} mm with lines: {error}"))
                .at(located.span, "")
                .hint("allow a larger tolerance, state a larger dl, or let a spline motion do it")
        };
        if log.dl.is_none() {
            let mut key = log.clone();
            key.curve = key.curve.base();
            let dl = match &found {
                Some((known, dl)) if *known == key => *dl,
                _ => step(log, tolerance).map_err(|error| too_many(&error))?,
            };
            found = Some((key, dl));
            log.dl = Some(dl);
        }
        points += steps(log).map_err(|error| too_many(&error))?.most_points();
        if MAX_POINTS < points {
            return Err(too_many(&StepError::TooManyPoints { points }).into());
        }
    }
    Ok(intent)
}

/// The largest Δl that holds the tolerance, mm: at most the Δl that was asked for, or else [`MAX_STEP`].
///
/// # Errors
/// It makes too many points.
pub fn step(log: &Logarithmic, tolerance: f64) -> Result<f64, StepError> {
    largest_step(&log.curve, tolerance, log.dl.unwrap_or(MAX_STEP), log.overrun)
}

/// The odd-even steps of a settled curve.
///
/// # Errors
/// Δl is not one that the front end or [`settle`] lets through.
pub fn steps(log: &Logarithmic) -> Result<OddEven, StepError> {
    OddEven::new(log.curve, log.dl.unwrap_or(MAX_STEP), log.overrun)
}

/// The points (X, A in radians) after the first that a control is to lead its own spline through: of odd-even steps the
/// even ones, which are a hundred times nearer to the curve than the odd ones, and the last; otherwise points of the
/// curve so near that lines between them would hold the tolerance.
///
/// # Errors
/// The tolerance is out of reach.
pub fn through_points(log: &Logarithmic, tolerance: f64) -> Result<Vec<(f64, f64)>, FitError> {
    match log.method {
        Method::OddEven => {
            let all: Vec<(f64, f64)> = steps(log).map_err(|_| FitError { tolerance })?.collect();
            let last = all.len() - 1;
            Ok(all
                .into_iter()
                .enumerate()
                .filter(|(i, _)| i % 2 == 1 || *i == last)
                .map(|(_, point)| point)
                .collect())
        }
        Method::Auto | Method::Direct => {
            let xs = fit::chords(&log.curve, tolerance)?;
            Ok(xs.into_iter().skip(1).map(|x| (x, log.curve.angle(x))).collect())
        }
    }
}
