//! What a run leaves: the moves, each with all that holds there.

use super::words::{Motion, State};
use super::{Rule, Violation};
use std::collections::{BTreeMap, BTreeSet};

/// Which length of a tool counts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Length {
    /// That of the program before, or none.
    #[default]
    Unknown,
    Cancelled,
    Of(f64),
}

impl Length {
    pub(super) fn counts(self) -> bool {
        matches!(self, Length::Of(_))
    }
}

/// From where an axis is counted, and whether a parameter says so.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Zero {
    pub(super) at: f64,
    pub(super) parameter: bool,
}

/// What stays in force until it is replaced.
#[derive(Clone, Debug, Default, PartialEq)]
#[allow(clippy::struct_excessive_bools, reason = "each is something that a control holds by itself")]
pub(super) struct Modal {
    pub(super) motion: Option<Motion>,
    pub(super) feed: Option<f64>,
    /// Whether F is inverse time.
    pub(super) timed: bool,
    pub(super) tool: Option<f64>,
    /// Whether the tool was changed since it was called.
    pub(super) changed: bool,
    pub(super) length: Length,
    pub(super) speed: Option<f64>,
    pub(super) turns: bool,
    pub(super) coolant: bool,
    /// The work offset, of the axes for which one is stated.
    pub(super) zeros: BTreeMap<char, Zero>,
    pub(super) upath: Option<bool>,
    pub(super) spline_path: Option<Vec<char>>,
    pub(super) group: Option<Vec<char>>,
    /// At the start and at the end of splines through points.
    pub(super) ends: [Option<String>; 2],
    pub(super) degree: Option<f64>,
    pub(super) states: BTreeSet<State>,
}

impl Modal {
    /// What matters to its motion; whether the tool's length does, the control knows.
    pub(super) fn effective(&self, length: bool) -> Modal {
        let curve = matches!(self.motion, Some(Motion::Poly | Motion::Bspline | Motion::Through));
        let run = matches!(self.motion, Some(Motion::Bspline | Motion::Through));
        let through = self.motion == Some(Motion::Through);
        let mut modal = self.clone();
        if !length {
            modal.length = Length::Unknown;
        }
        modal.feed = modal.feed.filter(|_| self.motion != Some(Motion::Rapid));
        modal.timed &= self.motion != Some(Motion::Rapid);
        modal.upath = modal.upath.filter(|_| curve);
        modal.spline_path = modal.spline_path.filter(|_| run);
        modal.ends = modal.ends.map(|word| word.filter(|_| through));
        modal.degree = modal.degree.filter(|_| self.motion == Some(Motion::Bspline));
        modal
    }
}

/// One block that moves, or that holds a knot.
#[derive(Clone, Debug)]
pub(super) struct Move {
    pub(super) line: usize,
    pub(super) section: usize,
    /// Whether the block names its motion.
    pub(super) opens: bool,
    /// Where the tool is before, as the text counts now.
    pub(super) from: BTreeMap<char, f64>,
    /// Where the text says that it goes; an axis that wraps is back between 0 and 360 behind it.
    pub(super) targets: BTreeMap<char, f64>,
    /// How far the axes of a straight move go.
    pub(super) by: BTreeMap<char, f64>,
    /// Whether it belongs to the path, and not to what leads there or back.
    pub(super) path: bool,
    pub(super) factors: BTreeMap<(char, usize), f64>,
    pub(super) knot: Option<f64>,
    pub(super) weight: Option<f64>,
    pub(super) order: Option<f64>,
    /// As far as it matters to this move.
    pub(super) modal: Modal,
}

impl Move {
    pub(super) fn violation(&self, rule: Rule, what: impl Into<String>) -> Violation {
        Violation { line: self.line, rule, what: what.into() }
    }
}

/// The remark of a section and where its path begins, from the work's own zero.
#[derive(Clone, Debug)]
pub(super) struct Start {
    pub(super) line: usize,
    pub(super) remark: String,
    pub(super) at: BTreeMap<char, f64>,
}

/// What a program does.
pub(super) struct Run {
    pub(super) moves: Vec<Move>,
    pub(super) starts: Vec<Start>,
    pub(super) violations: Vec<Violation>,
}
