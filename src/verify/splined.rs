//! Runs of lines that were written as splines: what was gained, and what it cost, both ways.

use crate::geom::runs::Likeness;

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
