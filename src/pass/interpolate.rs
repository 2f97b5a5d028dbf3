//! Logarithmic curves become steps, points or pieces, each straight from the intent; other curves what
//! [`approximate`](super::approximate) makes of them.

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::dialect::Form;
use crate::geom::bezier::Bezier;
use crate::geom::fit::{self, FitError};
use crate::ir::{Curve, Cut, Intent, Located, Logarithmic, Method, Polyline, Program, Role, Step};
use crate::machine::Machine;
use crate::pass::approximate::{Frame, approximate};
use crate::pass::settle::{steps, through_points};
use crate::source::Span;

/// The program with every logarithmic curve followed within `tolerance` mm, in shapes that `form` can be made of.
/// Points for the control's own spline follow from the tolerance `asked`, which rounding does not narrow. Other curves are
/// left as they are where the form takes them exactly and `exact` says that it may.
///
/// # Errors
/// The tolerance is out of reach.
pub fn interpolate(
    intent: &Intent,
    form: Form,
    machine: &Machine,
    tolerance: f64,
    asked: f64,
    exact: bool,
) -> Result<Program<f64, Curve>, Diagnostics> {
    let mut steps = Vec::with_capacity(intent.program.steps.len());
    // Flutes and passes are one curve, indexed and shifted: it is fitted once.
    let mut fitted: Option<(Logarithmic, Vec<Bezier>)> = None;
    for located in &intent.program.steps {
        let step = match &located.step {
            Step::Cut(Cut { feed, role, curve: Curve::Logarithmic(log) }) => {
                let refused = |error| out_of_reach(error, located.span);
                let curve = match piece_degree(log, form, machine) {
                    Some(degree) => {
                        let base = Logarithmic { curve: log.curve.base(), ..log.clone() };
                        let known = fitted.take().filter(|(known, _)| *known == base);
                        let (_, pieces) = fitted.insert(match known {
                            Some(known) => known,
                            None => {
                                let shared = machine.spline.shared_parameter;
                                let pieces = pieces(&base, degree, shared, tolerance).map_err(refused)?;
                                (base, pieces)
                            }
                        });
                        Curve::Polynomial(placed(pieces, log))
                    }
                    None => points(log, form, tolerance, asked).map_err(refused)?,
                };
                Step::Cut(Cut { feed: *feed, role: *role, curve })
            }
            Step::Cut(Cut { feed, role: Role::Path, curve }) => {
                let tolerance = if matches!(form, Form::Through(_)) { asked } else { tolerance };
                let frame = Frame { axes: &intent.program.axes, machine, radius: intent.radius() };
                let curve = approximate(curve, form, &frame, tolerance, exact)
                    .map_err(|diagnostic| diagnostic.at(located.span, ""))?;
                Step::Cut(Cut { feed: *feed, role: Role::Path, curve })
            }
            step @ (Step::Comment(_) | Step::Tool(_) | Step::Spindle(_) | Step::Rapid(_) | Step::Cut(_)) => {
                step.clone()
            }
        };
        steps.push(Located { step, span: located.span });
    }
    Ok(Program { name: intent.program.name.clone(), axes: intent.program.axes, steps })
}

/// What is said where a tolerance cannot be reached.
fn out_of_reach(error: FitError, span: Span) -> Diagnostic {
    Diagnostic::refusal("tolerance-out-of-reach", error.to_string())
        .at(span, "")
        .hint("allow a larger tolerance")
}

/// The degree of the pieces that a curve is to be made of; none where it is made of points.
fn piece_degree(log: &Logarithmic, form: Form, machine: &Machine) -> Option<usize> {
    match (log.method, form) {
        (Method::OddEven, _) | (_, Form::Lines | Form::Through(_)) => None,
        (Method::Auto | Method::Direct, Form::Polynomial { closing: false }) => {
            Some(machine.spline.poly_degree)
        }
        (Method::Auto | Method::Direct, Form::Polynomial { closing: true } | Form::Nurbs) => Some(3),
    }
}

/// One curve as points: those that the control leads its own spline through, or the ends of lines.
fn points(log: &Logarithmic, form: Form, tolerance: f64, asked: f64) -> Result<Curve, FitError> {
    match (form, log.method) {
        (Form::Through(kind), _) => {
            Ok(Curve::Through(kind, polyline(log, through_points(log, asked)?.into_iter())))
        }
        (Form::Lines | Form::Polynomial { .. } | Form::Nurbs, Method::OddEven) => {
            Ok(Curve::Lines(polyline(log, steps(log).map_err(|_| FitError { tolerance })?)))
        }
        (Form::Lines | Form::Polynomial { .. } | Form::Nurbs, Method::Auto | Method::Direct) => {
            let xs = fit::chords(&log.curve, tolerance)?;
            Ok(Curve::Lines(polyline(log, xs.into_iter().skip(1).map(|x| (x, log.curve.angle(x))))))
        }
    }
}

fn polyline(log: &Logarithmic, points: impl Iterator<Item = (f64, f64)>) -> Polyline {
    let mut line = Polyline::new(log.curve.position(0.0), 4);
    for (x, a) in points {
        line.push(&log.curve.position_with(x, a));
    }
    line
}

/// Pieces of the base curve on its flute and pass.
fn placed(pieces: &[Bezier], log: &Logarithmic) -> Vec<Bezier> {
    let [y, z] = log.curve.shift;
    let place = |piece: &Bezier| {
        let mut piece = *piece;
        for point in &mut piece.points[..=piece.degree] {
            point[1] += y;
            point[2] += z;
            point[3] += log.curve.index;
        }
        piece
    };
    pieces.iter().map(place).collect()
}

/// The fewest pieces: X linear in the parameter where that needs no more of them, since such blocks mean the same
/// whether the control lets A follow the parameter or the arc length.
fn pieces(log: &Logarithmic, degree: usize, shared: bool, tolerance: f64) -> Result<Vec<Bezier>, FitError> {
    if log.curve.is_straight() {
        let line = Bezier::line(log.curve.position(0.0), log.curve.position(log.curve.end()));
        return Ok(vec![line]);
    }
    let linear = fit::linear_in_x(&log.curve, degree, tolerance);
    if !shared {
        return linear;
    }
    let along = fit::along_itself(&log.curve, tolerance)?;
    match linear {
        Ok(linear) if linear.len() <= along.len() => Ok(linear),
        _ => Ok(along),
    }
}
