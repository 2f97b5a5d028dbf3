//! Logarithmic curves become steps, points or pieces, each straight from the intent; other curves what
//! [`approximate`](super::approximate) makes of them.

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::dialect::Form;
use crate::geom::bezier::Bezier;
use crate::geom::fit::{self, FitError};
use crate::geom::logcurve::LogCurve;
use crate::ir::{Curve, Cut, Intent, Located, Logarithmic, Method, Passed, Polyline, Program, Role, Step};
use crate::machine::{Machine, RotaryFeed};
use crate::pass::approximate::{Frame, approximate};
use crate::pass::arcs;
use crate::pass::settle::{steps, through_points};
use crate::pass::stretch::{Stretch, of_curve, rate, stretch_of, stretches};
use crate::source::Span;
use crate::units::DEGREES;
use std::borrow::Cow;

/// The program with every logarithmic curve followed within `tolerance` mm, in shapes that `form` can be made of.
/// Points for the control's own spline follow from the tolerance `asked`, which rounding does not narrow. Other curves are
/// left as they are where the form takes them exactly and `exact` says that it may. Curves that stay are the intent's own.
///
/// # Errors
/// The tolerance is out of reach.
pub fn interpolate<'i>(
    intent: &'i Intent,
    form: Form,
    machine: &Machine,
    (tolerance, asked): (f64, f64),
    exact: bool,
) -> Result<Passed<'i>, Diagnostics> {
    let mut steps = Vec::with_capacity(intent.program.steps.len());
    // Flutes and passes are one curve, indexed and shifted: it is fitted once.
    let modulo = machine.axes.as_slice().iter().any(|(axis, _)| machine.limits(*axis).modulo);
    let mut fits = Fits { machine, tolerance, known: Vec::new() };
    for located in &intent.program.steps {
        match &located.step {
            Step::Cut(Cut { feed, role, curve: Curve::Logarithmic(log) }) => {
                let refused = |error| out_of_reach(error, located.span);
                let mut cuts = Vec::new();
                let whole = matches!(form, Form::Through(_));
                let stretches = stretches(log, *feed, whole, machine);
                if let Some(degree) = piece_degree(log, form, machine) {
                    for stretch in &stretches {
                        let pieces = fits.pieces(&stretch.path, degree).map_err(refused)?;
                        cuts.push((stretch.feed, Curve::Polynomial(placed(pieces, &stretch.path))));
                    }
                } else {
                    cuts = points(log, &stretches, form, modulo, (tolerance, asked)).map_err(refused)?;
                }
                if machine.rotary_feed == RotaryFeed::InverseTime && log.curve.k() != 0.0 {
                    if form != Form::Lines {
                        let message = "under inverse time only lines can move a rotary axis";
                        return Err(Diagnostic::refusal("inverse-time-lines", message)
                            .at(located.span, "")
                            .into());
                    }
                    timed(log, *feed, &mut cuts);
                }
                if log.back {
                    cuts = cuts.into_iter().rev().map(|(feed, curve)| (feed, reversed(curve))).collect();
                }
                steps.extend(cuts.into_iter().map(|(feed, curve)| Located {
                    step: Step::Cut(Cut { feed, role: *role, curve: Cow::Owned(curve) }),
                    span: located.span,
                }));
            }
            Step::Cut(Cut { feed, role, curve: Curve::Arc(arc) }) => {
                let axes = &intent.program.axes;
                let curves = match arcs::word(arc, machine) {
                    Some(word) => {
                        arcs::blocks(arc, word, machine).into_iter().map(Curve::Arc).collect::<Vec<Curve>>()
                    }
                    None => vec![Curve::Lines(arcs::lines(arc, axes.count(), tolerance))],
                };
                steps.extend(curves.into_iter().map(|curve| Located {
                    step: Step::Cut(Cut { feed: *feed, role: *role, curve: Cow::Owned(curve) }),
                    span: located.span,
                }));
            }
            Step::Cut(cut) if cut.takes_motion() => {
                let Cut { feed, role, curve } = cut;
                let axes = &intent.program.axes;
                // What was asked in lines keeps its F, whatever those have become.
                let counted = |feed| of_curve(curve, feed, axes, machine, intent.radius()).0;
                let feed = if *role == Role::AsAsked { *feed } else { feed.map(counted) };
                let tolerance = if matches!(form, Form::Through(_)) { asked } else { tolerance };
                let frame = Frame { axes: &intent.program.axes, machine, radius: intent.radius() };
                let curve = approximate(curve, form, &frame, tolerance, exact)
                    .map_err(|diagnostic| diagnostic.at(located.span, ""))?;
                let step = Step::Cut(Cut { feed, role: *role, curve: Cow::Owned(curve) });
                steps.push(Located { step, span: located.span });
            }
            step @ (Step::Comment(_)
            | Step::Tool(_)
            | Step::Spindle(_)
            | Step::Coolant
            | Step::Home(_)
            | Step::Shift(_)
            | Step::Auxiliary(_)
            | Step::Rapid(_)
            | Step::Cut(_)) => steps.push(Located { step: step.borrowed(), span: located.span }),
        }
    }
    let Program { name, number, axes, .. } = &intent.program;
    Ok(Program { name: name.clone(), number: *number, axes: *axes, steps })
}

/// Gives every line its own F, the time that its way is to take.
fn timed(log: &Logarithmic, feed: Option<f64>, cuts: &mut [(Option<f64>, Curve)]) {
    let Some(feed) = feed else { return };
    for (_, curve) in cuts {
        let Curve::Lines(line) = curve else { continue };
        let xs: Vec<f64> =
            std::iter::once(line.start[0]).chain(line.points().map(|point| point[0])).collect();
        line.rates = xs.windows(2).map(|pair| rate(log, feed, pair[0], pair[1])).collect();
    }
}

/// A path run the other way.
fn reversed(curve: Curve) -> Curve {
    match curve {
        Curve::Lines(line) => Curve::Lines(line.reversed()),
        Curve::Through(kind, line) => Curve::Through(kind, line.reversed()),
        Curve::Polynomial(pieces) => Curve::Polynomial(pieces.iter().rev().map(Bezier::reversed).collect()),
        // `interpolate` makes none of these.
        Curve::Arc(_) | Curve::Nurbs(_) | Curve::Formula(_) | Curve::Logarithmic(_) => curve,
    }
}

/// Pieces of curves that were fitted already.
struct Fits<'m> {
    machine: &'m Machine,
    tolerance: f64,
    /// Stretches of paths that are neither indexed nor shifted.
    known: Vec<(Logarithmic, Vec<Bezier>)>,
}

impl Fits<'_> {
    fn pieces(&mut self, stretch: &Logarithmic, degree: usize) -> Result<&[Bezier], FitError> {
        let base = Logarithmic { curve: stretch.curve.base(), ..stretch.clone() };
        let known = &mut self.known;
        if let Some(at) = known.iter().position(|(other, _)| *other == base) {
            return Ok(&known[at].1);
        }
        let shared = self.machine.spline.shared_parameter;
        let pieces = pieces(&base, degree, shared, self.tolerance)?;
        known.push((base, pieces));
        Ok(known.last().map_or(&[], |(_, pieces)| pieces))
    }
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

/// One path as points, those that the control leads its own spline through or the ends of lines, with F of each stretch.
fn points(
    log: &Logarithmic,
    stretches: &[Stretch],
    form: Form,
    modulo: bool,
    (tolerance, asked): (f64, f64),
) -> Result<Vec<(Option<f64>, Curve)>, FitError> {
    match (form, log.method) {
        (Form::Through(kind), _) => {
            let line = polyline(log, log.curve.start(), through_points(log, asked)?.into_iter());
            Ok(vec![(stretches[0].feed, Curve::Through(kind, line))])
        }
        (Form::Lines | Form::Polynomial { .. } | Form::Nurbs, Method::OddEven) => {
            let mut lines: Vec<(Option<f64>, Polyline)> = Vec::new();
            let mut last = log.curve.position(log.curve.start());
            let mut at = usize::MAX;
            for (x, a) in steps(log).map_err(|_| FitError { tolerance })? {
                let stretch = stretch_of(stretches, x);
                if stretch != at {
                    at = stretch;
                    lines.push((stretches[at].feed, Polyline::new(last, 4)));
                }
                last = log.curve.position_with(x, a);
                if let Some((_, line)) = lines.last_mut() {
                    line.push(&last);
                }
            }
            Ok(lines.into_iter().map(|(feed, line)| (feed, Curve::Lines(line))).collect())
        }
        (Form::Lines | Form::Polynomial { .. } | Form::Nurbs, Method::Auto | Method::Direct) => stretches
            .iter()
            .map(|Stretch { path, feed, .. }| {
                let mut xs = fit::chords(&path.curve, tolerance)?;
                if modulo {
                    xs = in_steps(&path.curve, &xs);
                }
                let points = xs.into_iter().skip(1).map(|x| (x, path.curve.angle(x)));
                Ok((*feed, Curve::Lines(polyline(path, path.curve.start(), points))))
            })
            .collect(),
    }
}

/// The most degrees that a line turns an axis that wraps: well below the 180 at which both ways are as long.
const MOST_STEP: f64 = 120.0;

/// The same X with others between them, so that no line turns A by more than [`MOST_STEP`].
fn in_steps(curve: &LogCurve, xs: &[f64]) -> Vec<f64> {
    let mut all = vec![curve.start()];
    for pair in xs.windows(2) {
        let turn = (curve.angle(pair[1]) - curve.angle(pair[0])).abs() * DEGREES;
        let n = (turn / MOST_STEP) as u32 + 1;
        all.extend((1..n).map(|i| pair[0] + (pair[1] - pair[0]) * f64::from(i) / f64::from(n)));
        all.push(pair[1]);
    }
    all
}

fn polyline(log: &Logarithmic, start: f64, points: impl Iterator<Item = (f64, f64)>) -> Polyline {
    let mut line = Polyline::new(log.curve.position(start), 4);
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
        let line = Bezier::line(log.curve.position(log.curve.start()), log.curve.position(log.curve.end()));
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
