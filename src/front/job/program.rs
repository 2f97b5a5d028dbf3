//! The program round the curves: how the tool gets to each and away.
//!
//! Curves that meet are one section, so that a program can be restarted there:
//!
//! | step | move |
//! |---|---|
//! | retract | the retract axis to clear air, at rapid, alone |
//! | position | the other axes to the start of the first curve, one at a time |
//! | approach | the retract axis to the start, at feed |
//! | path | the curves, in order |
//! | retract | the retract axis to clear air, at rapid |
//!
//! Before the tool change and after the last section the retract axis goes home in machine coordinates.

use super::{Job, MEET, Placed, parse};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::front::clear::{Reach, Retraction, Side};
use crate::geom::bezier::Bezier;
use crate::geom::deviation::Bound;
use crate::ir::{Curve, Cut, Described, Intent, Located, Polyline, Program, Role, Step, ToolCall};
use crate::source::{SourceId, Sources};
use crate::units::Position;

/// Gaps below this look as if the curves were meant to meet, mm or degrees.
const SMALL_GAP: f64 = 0.05;

/// Reads a job file as what a program is to be made of.
///
/// # Errors
/// As [`parse`]; also where feed or retract is missing, or where the retract position is not clear of the curves.
pub fn parse_program(sources: &Sources, id: SourceId) -> Result<Intent, Diagnostics> {
    let job = parse(sources, id)?;
    let mut found = Diagnostics::new();
    let mut missing = |id, what: &str, line: &str| {
        found.push(
            Diagnostic::error(id, format!("a program needs {what}"))
                .at(job.process.span, "")
                .hint(format!("add under [process]: {line}")),
        );
    };
    if job.process.feed.is_none() {
        missing("feed-missing", "a feed", "feed = 1000.0");
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

/// The greatest distance of two positions in one coordinate.
fn gap(p: &Position, q: &Position) -> f64 {
    p.iter().zip(q).fold(0.0, |most, (a, b)| f64::max(most, (a - b).abs()))
}

impl Job {
    /// Where the sections begin: the first curve, and each that does not start where the one before ended.
    fn sections(&self) -> Vec<&[Placed]> {
        self.curves.chunk_by(|before, after| gap(&before.end, &after.start) <= MEET).collect()
    }

    /// Where an axis is along the curves. Those that rest where it is clear were warned of.
    fn reach(&self, i: usize) -> Reach {
        let mut cut = Reach::NONE;
        for placed in self.curves.iter().filter(|placed| !placed.rests) {
            let mut take = |point: &Position| cut.take(point[i]);
            take(&placed.start);
            match &placed.curve {
                Curve::Lines(line) | Curve::Through(_, line) => line.points().for_each(|point| take(&point)),
                Curve::Polynomial(pieces) => {
                    pieces.iter().flat_map(Bezier::control_points).for_each(take);
                }
                Curve::Formula(Described { pieces, bound, .. }) => {
                    for point in pieces.iter().flat_map(Bezier::control_points) {
                        cut.take(point[i] - bound[i]);
                        cut.take(point[i] + bound[i]);
                    }
                }
                Curve::Nurbs(nurbs) => nurbs.points().iter().for_each(take),
                Curve::Arc(arc) => {
                    let (low, high) = arc.range();
                    take(&low);
                    take(&high);
                }
                // No job has these.
                Curve::Logarithmic(_) => {}
            }
        }
        cut
    }

    /// What is wrong with the retract position: it is not clear of the curves, or the way to it is not.
    fn retract_not_clear(&self) -> Option<Diagnostic> {
        let (axis, to) = self.process.retract?;
        let i = self.axes.index_of(axis)?;
        let cut = self.reach(i);
        let retraction = Retraction { axis, to, span: self.process.span };
        if axis.as_str().starts_with('Z') {
            return retraction.not_clear(cut, Side::Greater, "Z grows away from the work");
        }
        let side = retraction.side(cut);
        let known = retraction.not_clear(cut, side, "the curves do not reach it");
        known.or_else(|| {
            self.sections().into_iter().filter(|section| section.iter().any(|placed| !placed.rests)).find_map(
                |section| {
                    let (first, last) = (&section[0], &section[section.len() - 1]);
                    // A formula's pieces are off by their bound.
                    let off = MEET + first.error.max(last.error);
                    retraction.through(cut, [first.start[i], last.end[i]], off, first.span)
                },
            )
        })
    }

    /// The program, without the moves that feed and retract would allow where those are missing.
    pub fn intent(&self) -> Intent {
        let mut steps = Vec::new();
        let first = self.curves.first().map_or(self.process.span, |placed| placed.span);
        let mut add = |step: Step<f64, Curve>, span| steps.push(Located { step, span });
        let home = self.process.retract.and_then(|(axis, _)| self.axes.index_of(axis));
        if let Some(axis) = home {
            add(Step::Home(axis), first);
            add(Step::Tool(ToolCall::own(self.process.tool)), first);
        }
        if let Some(rpm) = self.process.spindle {
            add(Step::Spindle(rpm), first);
        }
        if self.process.coolant {
            add(Step::Coolant, first);
        }
        let mut warnings = self.warnings.clone();
        let mut number = 1;
        let mut last: Option<&Placed> = None;
        for section in self.sections() {
            let (count, all) = (section.len(), self.curves.len());
            let start = &section[0];
            if let Some(last) = last
                && gap(&last.end, &start.start) < SMALL_GAP
                // Gaps between the curves of a file are told of where it is read.
                && start.span.source == self.process.span.source
            {
                let message = format!(
                    "curves {} and {number} are {:.2e} apart, and so the tool retracts between them",
                    number - 1,
                    gap(&last.end, &start.start)
                );
                warnings.push(
                    Diagnostic::warning("gap-small", message)
                        .at(start.span, "")
                        .hint(format!("curves are joined where they are no farther apart than {MEET:e}")),
                );
            }
            let name = if count == 1 {
                format!("CURVE {number} OF {all}")
            } else {
                format!("CURVES {number} TO {} OF {all}", number + count - 1)
            };
            self.section(section, name, &mut add);
            number += count;
            last = section.last();
        }
        if let Some(axis) = home {
            add(Step::Home(axis), first);
        }
        Intent {
            program: Program { name: self.name.clone(), number: self.number, axes: self.axes, steps },
            tolerance: self.tolerance,
            name_span: self.name_span,
            radius: self.radius,
            tilt_error: Bound::ZERO,
            input_error: self.curves.iter().map(|placed| placed.error).fold(0.0, f64::max),
            warnings,
        }
    }

    /// Curves that meet.
    fn section(
        &self,
        section: &[Placed],
        name: String,
        add: &mut impl FnMut(Step<f64, Curve>, crate::source::Span),
    ) {
        let Placed { start, span, .. } = section[0];
        let feed = self.process.feed;
        let retract = self.process.retract.and_then(|(axis, to)| Some((self.axes.index_of(axis)?, to)));
        add(Step::Comment(name), span);
        if let Some((axis, to)) = retract {
            add(Step::Rapid(vec![(axis, to)]), span);
            for other in (0..self.axes.count()).filter(|other| *other != axis) {
                add(Step::Rapid(vec![(other, start[other])]), span);
            }
            if start[axis] != to {
                let mut clear: Position = start;
                clear[axis] = to;
                let mut approach = Polyline::new(clear, self.axes.count());
                approach.push(&start);
                add(Step::Cut(Cut { feed, role: Role::Approach, curve: Curve::Lines(approach) }), span);
            }
        }
        for placed in section {
            add(Step::Cut(Cut { feed, role: Role::Path, curve: placed.curve.clone() }), placed.span);
        }
        if let Some((axis, to)) = retract {
            add(Step::Rapid(vec![(axis, to)]), span);
        }
    }
}
