//! What a proof finds.

use super::Splined;
use crate::geom::deviation::Bound;
use crate::geom::follow::Map;
use crate::setup::Setup;

/// How sure the deviation is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Status {
    /// An upper bound everywhere.
    Proved,
    /// Seen at many places, and no bound between them.
    Sampled,
    /// Known at the points only: between them the control decides.
    PointsOnly,
}

impl Status {
    /// In one word.
    pub fn word(self) -> &'static str {
        match self {
            Status::Proved => "proved",
            Status::Sampled => "sampled",
            Status::PointsOnly => "points-only",
        }
    }
}

/// What was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// The deviation of the program's paths from the intent.
    pub deviation: Bound,
    /// How sure that is.
    pub status: Status,
    /// Where the intent is odd-even steps: their distance from the ideal curve.
    pub from_ideal: Option<Bound>,
    /// The map that the deviation of curves holds for, where it needed one of its own.
    pub map: Option<Map>,
    /// Blocks that cut.
    pub path_blocks: usize,
    /// How many blocks each step of the intent became; a remark none.
    pub blocks: Vec<u32>,
    /// Runs of lines that were written as splines; none where there are none.
    pub splined: Option<Splined>,
    /// The paths' length, mm.
    pub cutting_length: f64,
    /// How long the paths take at their F, minutes: without approaches, rapids and acceleration.
    pub minutes: f64,
    /// How far the speed is from the one asked for inside a block, as a share of it.
    pub feed_error: f64,
    /// How many blocks lead to where the tool is already, because a point was asked twice or a step is below the last decimal.
    pub rests: usize,
    /// What to know at the machine.
    pub setup: Setup,
}
