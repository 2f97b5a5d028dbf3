//! The program round the paths: which pass comes when, and how the tool gets there and away.
//!
//! Every pass over a flute is a section of its own, so that a program can be restarted there:
//!
//! | step | move |
//! |---|---|
//! | correct | the work offset that a correction is |
//! | retract | the retract axis to clear air, at rapid, alone |
//! | position | the other linear axes to the start of the path, one at a time, at rapid |
//! | index | A to the flute, at rapid |
//! | approach | the retract axis to the start of the path, at feed |
//! | path | the flute, with what it runs before and behind |
//! | retract | the retract axis to clear air, at rapid |
//! | return | the other linear axes to the start of the path, where that is asked for at feed |
//!
//! Before the tool change and after the last section the retract axis goes home in machine coordinates.

use super::{CutterJob, Infeed, Order, Process, parse};
use crate::decimal::Decimal;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::front::clear::{Reach, Retraction, Side};
use crate::geom::deviation::Bound;
use crate::geom::logcurve::Measure;
use crate::ir::{Curve, Cut, Intent, Located, Logarithmic, Polyline, Program, Role, Shift, Step, ToolCall};
use crate::source::{Source, SourceId};
use crate::units::{Axes, Kind, Position};

/// Reads a cutter file as what a program is to be made of.
///
/// # Errors
/// As [`parse`]; also where feed or retract is missing, or where the retract position is not clear of the work.
pub fn parse_program(source: &Source, id: SourceId) -> Result<Intent, Diagnostics> {
    let job = parse(source, id)?;
    let mut found = Diagnostics::new();
    let mut missing = |id, what: &str, line: &str| {
        found.push(
            Diagnostic::error(id, format!("a program needs {what}"))
                .at(job.process.span, "")
                .hint(format!("add under [process]: {line}")),
        );
    };
    if job.process.feed.is_none() {
        missing("feed-missing", "a feed", "feed = 200.0");
    }
    if job.process.retract.is_none() {
        let line = "retract = { axis = \"Z\", to = 50.0 }";
        missing("retract-missing", "a place in clear air to retract to", line);
    }
    if let Some(diagnostic) = job.retract_not_clear() {
        found.push(diagnostic);
    }
    found.into_result()?;
    Ok(job.intent())
}

/// The index of Z among X Y Z A.
const Z: usize = 2;

/// The greatest X that a flute may reach: an overrun ends within two steps of the end.
fn flute_end(flute: &Logarithmic) -> f64 {
    let more = if flute.overrun { 2.0 * flute.dl.unwrap_or(crate::pass::settle::MAX_STEP) } else { 0.0 };
    flute.curve.end() + more
}

/// One pass: how far the path is shifted, and what it is called.
struct Pass {
    shift: [f64; 2],
    name: String,
}

impl CutterJob {
    /// Rough passes, the finishing pass, spark-out.
    fn passes(&self) -> Vec<Pass> {
        let Process { infeed, spark_out, .. } = self.process;
        let correction = self.correction();
        let mut passes = Vec::new();
        if let Some(Infeed { axis, step, passes: rough }) = infeed {
            let name = Axes::xyza().name(axis);
            for i in 1..=rough {
                let left = step * f64::from(rough + 1 - i);
                let mut shift = correction;
                shift[axis - 1] += left;
                let stock = Decimal::round(left, 4).unwrap_or_default();
                passes.push(Pass { shift, name: format!(", ROUGH {i} OF {rough}, {name} {stock}") });
            }
        }
        let alone = passes.is_empty() && spark_out == 0;
        let name = if alone { String::new() } else { ", FINISH".to_owned() };
        passes.push(Pass { shift: correction, name });
        passes.extend(
            (1..=spark_out)
                .map(|i| Pass { shift: correction, name: format!(", SPARK-OUT {i} OF {spark_out}") }),
        );
        passes
    }

    /// On which side of the path it is clear along an axis, and how that is known.
    fn clear_side(&self, axis: usize) -> (Side, &'static str) {
        match self.process.infeed.filter(|infeed| infeed.axis == axis) {
            Some(infeed) if infeed.step < 0.0 => {
                (Side::Less, "the sign of infeed step says on which side of the finished path the stock is")
            }
            Some(_) => (
                Side::Greater,
                "the sign of infeed step says on which side of the finished path the stock is",
            ),
            None if axis == Z => (
                Side::Greater,
                "Z grows away from the work; an infeed in Z with sign = -1 says that the stock is on the other side",
            ),
            None => (
                Side::Greater,
                "Y grows away from the cutter's axis; an infeed in Y with sign = -1 says that the stock is on the other side",
            ),
        }
    }

    /// What is wrong with the retract position: it is not clear of the path where the correction is zero. With a correction it
    /// is as clear ([`CutterJob::clear`]).
    fn retract_not_clear(&self) -> Option<Diagnostic> {
        let (axis, to) = self.process.retract?;
        let correction = self.correction();
        let mut cut = Reach::NONE;
        for flute in &self.flutes {
            for pass in self.passes() {
                let shift = [pass.shift[0] - correction[0], pass.shift[1] - correction[1]];
                let curve = flute.curve.with_shift(shift);
                for x in [curve.start(), flute_end(flute)] {
                    cut.take(curve.position(x)[axis]);
                }
            }
        }
        let (side, why) = self.clear_side(axis);
        Retraction { axis: Axes::xyza().name(axis), to, span: self.process.span }.not_clear(cut, side, why)
    }

    /// Which axis retracts, and where to with the correction as it stands.
    ///
    /// The parameter shifts the retraction with the path, and may be set to zero at the machine: one that leads away from the
    /// work is added, so that the tool is never nearer to the work than the position that was asked for, whatever from
    /// zero to its value the parameter is.
    fn clear(&self) -> Option<(usize, f64)> {
        let (axis, to) = self.process.retract?;
        let shift = match self.process.correction {
            Some((other, value)) if other == axis => value,
            Some(_) | None => 0.0,
        };
        let away = match self.clear_side(axis).0 {
            Side::Greater => shift.max(0.0),
            Side::Less => shift.min(0.0),
        };
        Some((axis, to + away))
    }

    /// The program, without the moves that feed and retract would allow where those are missing.
    pub fn intent(&self) -> Intent {
        let mut steps = Vec::new();
        let mut add = |step: Step<f64, Curve>| steps.push(Located { step, span: self.span });
        let home = self.process.retract.map(|(axis, _)| axis);
        if let Some(axis) = home {
            add(Step::Home(axis));
            add(Step::Tool(ToolCall::own(self.process.tool)));
        }
        if let Some(rpm) = self.process.spindle {
            add(Step::Spindle(rpm));
        }
        if self.process.coolant {
            add(Step::Coolant);
        }
        let passes = self.passes();
        match self.process.order {
            Order::Flute => {
                for flute in 0..self.flutes.len() {
                    for pass in &passes {
                        self.section(flute, pass, &mut add);
                    }
                }
            }
            Order::Pass => {
                for pass in &passes {
                    for flute in 0..self.flutes.len() {
                        self.section(flute, pass, &mut add);
                    }
                }
            }
        }
        if let Some(axis) = home {
            if let Some((axis, _)) = self.process.correction {
                add(Step::Shift(vec![Shift { axis, to: 0.0, parameter: false }]));
            }
            add(Step::Home(axis));
        }
        Intent {
            program: Program { name: self.name.clone(), number: self.number, axes: Axes::xyza(), steps },
            tolerance: self.tolerance,
            name_span: self.name_span,
            radius: None,
            tilt_error: Bound::ZERO,
            input_error: 0.0,
            warnings: Diagnostics::new(),
        }
    }

    /// How far the correction shifts all paths in Y and Z, mm.
    fn correction(&self) -> [f64; 2] {
        let mut shift = [0.0; 2];
        if let Some((axis, value)) = self.process.correction {
            shift[axis - 1] = value;
        }
        shift
    }

    /// One pass over one flute.
    fn section(&self, flute: usize, pass: &Pass, add: &mut impl FnMut(Step<f64, Curve>)) {
        let axes = Axes::xyza();
        let Process { feed, approach_feed, return_feed, correction, .. } = self.process;
        let log = &self.flutes[flute];
        let path = Logarithmic { curve: log.curve.with_shift(pass.shift), ..log.clone() };
        let angle = Decimal::round(path.curve.index, 4).unwrap_or_default();
        add(Step::Comment(format!("FLUTE {} OF {}, A {angle}{}", flute + 1, self.flutes.len(), pass.name)));
        let Some((clear_axis, clear)) = self.clear() else {
            add(Step::Cut(Cut { feed, role: Role::Path, curve: Curve::Logarithmic(path) }));
            return;
        };
        if let Some((axis, to)) = correction {
            add(Step::Shift(vec![Shift { axis, to, parameter: true }]));
        }
        let (first, last) = if path.back {
            (path.curve.end(), path.curve.start())
        } else {
            (path.curve.start(), path.curve.end())
        };
        let (start, end) = (path.curve.position(first), path.curve.position(last));
        let others = || (0..axes.count()).filter(move |other| *other != clear_axis);
        let above = |mut position: Position| {
            position[clear_axis] = clear;
            position
        };
        add(Step::Rapid(vec![(clear_axis, clear)]));
        for other in others() {
            add(Step::Rapid(vec![(other, start[other])]));
        }
        // What the feed of the path makes along X Y Z where it begins.
        let rate = |measure| path.curve.rate(measure, first);
        let usual = feed.map(|feed| feed * (rate(Measure::Path) / rate(path.along)));
        let straight = |feed: Option<f64>, line: Polyline| {
            Step::Cut(Cut { feed, role: Role::Approach, curve: Curve::Lines(line) })
        };
        let mut approach = Polyline::new(above(start), axes.count());
        approach.push(&start);
        add(straight(approach_feed.or(usual), approach));
        add(Step::Cut(Cut { feed, role: Role::Path, curve: Curve::Logarithmic(path) }));
        add(Step::Rapid(vec![(clear_axis, clear)]));
        if return_feed.is_some() {
            let mut at = above(end);
            let mut back = Polyline::new(at, axes.count());
            for other in
                others().filter(|other| axes.kind(*other) == Kind::Linear && start[*other] != end[*other])
            {
                at[other] = start[other];
                back.push(&at);
            }
            add(straight(return_feed, back));
        }
    }
}
