//! Runs of lines that were written as splines: what was gained, and what it cost, both ways.

use super::curve::{Asked, SHARE};
use super::{Cursor, Found};
use crate::diagnostic::Diagnostics;
use crate::geom::runs::Likeness;
use crate::ir::{Curve, Cut, Polyline, Units, Written};
use crate::pass::stretch::{amount_of_lines, linear_length};
use crate::units::Kind;

/// One run.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    /// How many lines were asked for.
    pub(super) lines: usize,
    /// How many blocks were written.
    pub(super) blocks: usize,
    /// An upper bound on the distance of the spline from the lines, both run in order, mm.
    pub(super) from_lines: f64,
    /// Its points, curvature and corners.
    pub(super) likeness: Likeness,
}

/// All runs of lines that were written as splines.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Splined {
    /// Which steps of the intent they are.
    pub steps: Vec<usize>,
    /// How many lines were asked for.
    pub lines: usize,
    /// How many blocks were written.
    pub blocks: usize,
    /// How many corners were kept.
    pub corners: usize,
    /// An upper bound on the distance of the splines from the lines, mm.
    pub from_lines: f64,
    /// An upper bound on the distance of the points from the splines, mm.
    pub from_points: f64,
    /// Greatest curvature of the points, by the circle through three, corners left out, 1/mm.
    pub curvature_before: f64,
    /// Greatest curvature of the splines, at nine places of each block, 1/mm.
    pub curvature_after: f64,
}

impl Run {
    /// Both as one.
    fn with(self, other: &Run) -> Run {
        let (own, more) = (self.likeness, other.likeness);
        Run {
            lines: self.lines + other.lines,
            blocks: self.blocks + other.blocks,
            from_lines: self.from_lines.max(other.from_lines),
            likeness: Likeness {
                farthest: own.farthest.max(more.farthest),
                before: own.before.max(more.before),
                after: own.after.max(more.after),
                corners: own.corners + more.corners,
            },
        }
    }
}

impl Cursor<'_> {
    /// Whether a run of lines was written as lines and splines in turn, and `written` is the first of them.
    pub(super) fn is_mixed(&self, line: &Polyline, written: &Written) -> bool {
        match written {
            Written::Lines(points) => {
                let next =
                    self.decimals.program.steps.get(self.at + 1).and_then(|located| located.step.cut());
                let spline =
                    |cut: &Cut<_, Written>| matches!(cut.curve, Written::Polynomial(_) | Written::Nurbs(_));
                points.count() - self.within < line.count() && next.is_some_and(spline)
            }
            Written::Polynomial(_) | Written::Nurbs(_) => self.ends_within(line, 0, written).is_some(),
            Written::Arc(_) | Written::Through(..) => false,
        }
    }

    /// Behind which of the lines from number `from` on a spline ends, where that is before the last.
    ///
    /// Its end is a point of the run, rounded, after a way most like its own. Which one is taken proves nothing: what is found
    /// of both parts does.
    fn ends_within(&self, line: &Polyline, from: usize, written: &Written) -> Option<usize> {
        let axes = &self.decimals.program.axes;
        let long = |piece: &_| linear_length(piece, axes);
        // How long the way to each end of a block is, and where that is.
        let ends: Vec<(f64, Units)> = match written {
            Written::Polynomial(polynomial) => {
                let pieces = self.pieces(written).ok()?;
                let blocks = pieces.iter().zip(&polynomial.blocks).skip(self.within);
                let mut along = 0.0;
                blocks
                    .map(|(piece, block)| {
                        along += long(piece);
                        (along, block.end)
                    })
                    .collect()
            }
            Written::Nurbs(nurbs) => {
                let along = self.pieces(written).ok()?.iter().map(long).sum();
                vec![(along, *nurbs.points.last()?)]
            }
            Written::Lines(_) | Written::Arc(_) | Written::Through(..) => return None,
        };
        let (length, end) = ends.last()?;
        let places = axes.direction().unwrap_or(axes.count());
        let is_at = |units: &Units, place: &[f64]| {
            (0..places).all(|axis| self.units(axis, place[axis]) == Some(units[axis]))
        };
        let linear: Vec<usize> = (0..places).filter(|i| axes.kind(*i) == Kind::Linear).collect();
        let (mut best, mut along): (Option<(f64, usize)>, f64) = (None, 0.0);
        let points = line.values.chunks_exact(line.stride);
        let start = match from.checked_sub(1) {
            Some(last) => points.clone().nth(last)?,
            None => &line.start[..line.stride],
        };
        let mut before = start;
        for (i, point) in points.enumerate().skip(from) {
            let square = |axis: &usize| (point[*axis] - before[*axis]) * (point[*axis] - before[*axis]);
            along += linear.iter().map(square).sum::<f64>().sqrt();
            before = point;
            let off = (along - length).abs();
            if off <= SHARE * length && best.is_none_or(|(known, _)| off < known) && is_at(end, point) {
                best = Some((off, i + 1));
            }
        }
        let (off, last) = best?;
        // A spline that goes on behind the run ends it somewhere on its way.
        let whole = ends.iter().filter(|(_, units)| is_at(units, before)).map(|(way, _)| (along - way).abs());
        let whole = whole.fold(f64::INFINITY, f64::min);
        (last < line.count() && !(whole < off)).then_some(last)
    }

    /// Meets a run of lines that was written as lines and splines in turn: the lines that stayed as such, each spline as what
    /// stands for the lines of the run from its start to its end. `feeds` are the speed that was asked for and F.
    pub(super) fn mixed(
        &mut self,
        line: &Polyline,
        [speed, feed]: [Option<f64>; 2],
        tolerance: f64,
    ) -> Result<Found, Diagnostics> {
        let (mut all, mut from) = (Found::new(), 0);
        while from < line.count() {
            let cut = self.written()?;
            self.same_feed(cut.feed, feed)?;
            let found = match &cut.curve {
                written @ Written::Lines(points) => {
                    let count = (points.count() - self.within).clamp(1, line.count() - from);
                    let part = line.part(from, from + count);
                    from += count;
                    let found = self.lines(&part, written)?;
                    let axes = &self.decimals.program.axes;
                    let amount = amount_of_lines(&part, axes, self.machine, self.radius);
                    let minutes = speed.map_or(0.0, |speed| amount / speed);
                    Found { minutes, ..found }
                }
                written @ (Written::Polynomial(_) | Written::Nurbs(_)) => {
                    let last = self.ends_within(line, from, written).unwrap_or(line.count());
                    let curve = &Curve::Lines(line.part(from, last));
                    from = last;
                    let (machine, radius) = (self.machine, self.radius);
                    self.curve(&Asked { curve, machine, radius, tolerance, feed: cut.feed }, written)?
                }
                Written::Arc(_) | Written::Through(..) => {
                    return Err(self.differs("step-differs", "here a straight move was asked".to_owned()));
                }
            };
            all.deviation = all.deviation.max(found.deviation);
            all.status = all.status.max(found.status);
            all.path_blocks += found.path_blocks;
            all.cutting_length += found.cutting_length;
            all.minutes += found.minutes;
            all.rests += found.rests;
            all.splined = match (all.splined, found.splined) {
                (Some(own), Some(more)) => Some(own.with(&more)),
                (own, more) => own.or(more),
            };
        }
        Ok(all)
    }
}

impl Splined {
    pub(super) fn add(&mut self, step: usize, run: &Run) {
        self.steps.push(step);
        self.lines += run.lines;
        self.blocks += run.blocks;
        self.corners += run.likeness.corners;
        self.from_lines = self.from_lines.max(run.from_lines);
        self.from_points = self.from_points.max(run.likeness.farthest);
        self.curvature_before = self.curvature_before.max(run.likeness.before);
        self.curvature_after = self.curvature_after.max(run.likeness.after);
    }
}
