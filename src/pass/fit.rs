//! Runs of lines become splines, where that is asked for.
//!
//! A run is a path of lines at one feed: a rapid, another feed or tool, an arc or a remark begins a new one. The intent stays
//! the lines: what was made of them is compared with them in the end.

use crate::geom::bezier::Bezier;
use crate::geom::smooth::{self, Fitting};
use crate::ir::{Curve, Cut, Intent, Role, Step};
use crate::machine::Machine;
use crate::pass::approximate::Frame;
use crate::units::Position;

/// The intent with each path of lines that is long enough as one C2 cubic B-spline, corners kept, within the tolerance of
/// its points. Approaches stay lines.
pub fn fit(intent: &Intent, machine: &Machine, fitting: Fitting) -> Intent {
    let mut fitted = intent.clone();
    let frame = Frame { axes: &intent.program.axes, machine, radius: intent.radius() };
    let metric = frame.metric(fitting.tolerance);
    let scaled = |p: &Position| metric.scaled(&Bezier::line(*p, *p)).start();
    let unscaled = |p: &Position| metric.unscaled(&Bezier::line(*p, *p)).start();
    for located in &mut fitted.program.steps {
        let Step::Cut(Cut { role: Role::Path | Role::AsAsked, curve, .. }) = &mut located.step else {
            continue;
        };
        let Curve::Lines(line) = curve else { continue };
        let points: Vec<Position> =
            std::iter::once(line.start).chain(line.points()).map(|p| scaled(&p)).collect();
        if let Some(spline) = smooth::spline(&points, fitting) {
            let mut spline = spline.mapped(unscaled);
            if let Some(first) = frame.axes.direction() {
                // The second curve runs so far from the tip.
                let long = |p: &Position| {
                    let mut p = *p;
                    p[first..first + 3].iter_mut().for_each(|x| *x *= machine.orientation.length);
                    p
                };
                spline = spline.mapped(long);
            }
            *curve = Curve::Nurbs(spline);
        }
    }
    fitted
}
