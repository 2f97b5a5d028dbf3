//! Runs of lines become splines, where that is asked for.
//!
//! A run is a path of lines at one feed: a rapid, another feed or tool, an arc or a remark begins a new one. The intent stays
//! the lines: what was made of them is compared with them in the end. A run that no spline follows somewhere becomes several
//! cuts, splines and the lines that stay, in its order.

use crate::geom::bezier::Bezier;
use crate::geom::smooth::{self, Fitting, Part};
use crate::ir::{Curve, Cut, Intent, Located, Polyline, Program, Role, Step};
use crate::machine::Machine;
use crate::pass::approximate::Frame;
use crate::pass::stretch::of_curve;
use crate::units::Position;

/// The intent with each path of lines that is long enough as C2 cubic B-splines, corners kept, within the tolerance of its
/// lines; where no spline is, and in approaches, lines stay. So does a run whose lines have times of their own.
pub fn fit(intent: &Intent, machine: &Machine, fitting: Fitting) -> Intent {
    let frame = Frame { axes: &intent.program.axes, machine, radius: intent.radius() };
    let mut steps = Vec::with_capacity(intent.program.steps.len());
    for located in &intent.program.steps {
        let of_lines = match &located.step {
            Step::Cut(cut @ Cut { role: Role::Path | Role::AsAsked, curve: Curve::Lines(line), .. })
                if line.rates.is_empty() =>
            {
                run(cut, line, &frame, fitting)
            }
            Step::Cut(_)
            | Step::Comment(_)
            | Step::Tool(_)
            | Step::Spindle(_)
            | Step::Coolant
            | Step::Home(_)
            | Step::Shift(_)
            | Step::Auxiliary(_)
            | Step::Rapid(_) => None,
        };
        match of_lines {
            Some(cuts) => {
                let span = located.span;
                steps.extend(cuts.into_iter().map(|cut| Located { step: Step::Cut(cut), span }));
            }
            None => steps.push(located.clone()),
        }
    }
    let Program { name, number, axes, .. } = &intent.program;
    let program = Program { name: name.clone(), number: *number, axes: *axes, steps };
    let Intent { tolerance, name_span, radius, tilt_error, input_error, .. } = *intent;
    Intent {
        program,
        tolerance,
        name_span,
        radius,
        tilt_error,
        input_error,
        warnings: intent.warnings.clone(),
    }
}

/// A run as cuts, at the F that the lines would have; none where all of it stays lines.
fn run(
    cut: &Cut<f64, Curve>,
    line: &Polyline,
    frame: &Frame<'_>,
    fitting: Fitting,
) -> Option<Vec<Cut<f64, Curve>>> {
    let metric = frame.metric(fitting.tolerance);
    let scaled = |p: &Position| metric.scaled(&Bezier::line(*p, *p)).start();
    let unscaled = |p: &Position| metric.unscaled(&Bezier::line(*p, *p)).start();
    let points: Vec<Position> =
        std::iter::once(line.start).chain(line.points()).map(|p| scaled(&p)).collect();
    let parts = smooth::parts(&points, fitting)?;
    let counted = |feed| of_curve(&cut.curve, feed, frame.axes, frame.machine, frame.radius).0;
    let feed = if cut.role == Role::AsAsked { cut.feed } else { cut.feed.map(counted) };
    let mut from = 0;
    let cuts = parts.into_iter().map(|part| {
        let last = part.last();
        let curve = match part {
            Part::Lines(last) => Curve::Lines(line.part(from, last)),
            Part::Spline(spline, _) => {
                let mut spline = spline.mapped(unscaled);
                if let Some(first) = frame.axes.direction() {
                    // The second curve runs so far from the tip.
                    let long = |p: &Position| {
                        let mut p = *p;
                        p[first..first + 3].iter_mut().for_each(|x| *x *= frame.machine.orientation.length);
                        p
                    };
                    spline = spline.mapped(long);
                }
                Curve::Nurbs(spline)
            }
        };
        from = last;
        // What was asked in lines keeps its F, whatever those have become.
        Cut { feed, role: Role::AsAsked, curve }
    });
    Some(cuts.collect())
}
