//! What holds and where the tool is, block by block, and the rules about both.

use super::words::{Block, Dialect, Motion, State, Word};
use super::{Job, Rule, Violation};
use std::collections::{BTreeMap, BTreeSet};

/// What stays in force until it is replaced.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Modal {
    pub(super) motion: Option<Motion>,
    pub(super) feed: Option<f64>,
    pub(super) tool: Option<f64>,
    /// Whether the tool was changed since it was called.
    pub(super) changed: bool,
    pub(super) length: Option<f64>,
    pub(super) speed: Option<f64>,
    pub(super) turns: bool,
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
    fn effective(&self, length: bool) -> Modal {
        let curve = matches!(self.motion, Some(Motion::Poly | Motion::Bspline | Motion::Through));
        let run = matches!(self.motion, Some(Motion::Bspline | Motion::Through));
        let through = self.motion == Some(Motion::Through);
        let mut modal = self.clone();
        modal.length = modal.length.filter(|_| length);
        modal.feed = modal.feed.filter(|_| self.motion != Some(Motion::Rapid));
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
    /// Where the tool is before.
    pub(super) from: BTreeMap<char, f64>,
    pub(super) targets: BTreeMap<char, f64>,
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

/// What a program does.
pub(super) struct Run {
    pub(super) moves: Vec<Move>,
    pub(super) violations: Vec<Violation>,
}

/// Where between approach and retraction the tool is.
#[derive(Clone, Copy, PartialEq)]
enum Phase {
    Away,
    Approached,
    Cutting,
}

/// How far the text has come.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Progress {
    Running,
    /// M30, M2.
    Finished,
    /// The last line.
    Closed,
}

struct Control<'a> {
    job: &'a Job,
    /// Every axis that the program ever moves.
    axes: BTreeSet<char>,
    modal: Modal,
    at: BTreeMap<char, f64>,
    phase: Phase,
    section: usize,
    /// Whether this section has moved already.
    begun: bool,
    stopped: bool,
    opened: Option<String>,
    progress: Progress,
    line: usize,
    run: Run,
}

/// Runs a program.
pub(super) fn run(job: &Job, blocks: &[Block]) -> Run {
    let mut control = Control {
        job,
        axes: blocks.iter().flat_map(|block| block.targets.keys().copied()).collect(),
        modal: Modal::default(),
        at: BTreeMap::new(),
        phase: Phase::Away,
        section: 0,
        begun: false,
        stopped: false,
        opened: None,
        progress: Progress::Running,
        line: 0,
        run: Run { moves: Vec::new(), violations: Vec::new() },
    };
    for block in blocks {
        control.block(block);
    }
    control.end();
    control.run
}

impl Control<'_> {
    fn violation(&mut self, rule: Rule, what: impl Into<String>) {
        self.run.violations.push(Violation { line: self.line, rule, what: what.into() });
    }

    fn require(&mut self, holds: bool, rule: Rule, what: &str) {
        if !holds {
            self.violation(rule, what);
        }
    }

    fn is_clear(&self) -> bool {
        let (axis, clear) = self.job.retract;
        // The same decimal, read twice by the same rule.
        self.at.get(&axis) == Some(&clear)
    }

    fn block(&mut self, block: &Block) {
        self.line = block.line;
        for fault in &block.faults {
            self.violation(Rule::Word, format!("`{fault}` is not understood"));
        }
        let closes = matches!(block.words.as_slice(), [Word::Close(_)]);
        let over = if closes { Progress::Closed } else { Progress::Finished };
        self.require(self.progress < over, Rule::End, "the program has ended before");
        if block.remark {
            self.require(self.phase == Phase::Away, Rule::Order, "the section before ends at the workpiece");
            self.section += 1;
            self.begun = false;
        }
        for word in &block.words {
            self.word(word);
        }
        self.modal.feed = block.feed.or(self.modal.feed);
        self.modal.motion = block.motion.or(self.modal.motion);
        let knot = block.knot.is_some() && self.modal.motion == Some(Motion::Nurbs);
        if !block.targets.is_empty() || !block.factors.is_empty() || knot {
            self.step(block);
        } else {
            let stray = block.knot.is_some() || block.weight.is_some() || block.order.is_some();
            self.require(!stray, Rule::Word, "a number of splines belongs to none");
        }
    }

    fn word(&mut self, word: &Word) {
        match word {
            Word::State(state) => drop(self.modal.states.insert(*state)),
            Word::Other(state) => {
                self.modal.states.remove(state);
                self.violation(Rule::Header, format!("{state:?} is left"));
            }
            Word::Incremental => self.violation(Rule::Incremental, "positions are incremental"),
            Word::Tool(tool) => {
                self.modal.tool = Some(*tool);
                self.modal.changed = false;
            }
            Word::Change => {
                self.require(self.modal.tool.is_some(), Rule::Tool, "no tool is called for the change");
                self.modal.changed = self.modal.tool.is_some();
            }
            Word::Length(length) => self.modal.length = Some(*length),
            Word::NoLength => self.modal.length = None,
            Word::Speed(speed) => {
                self.require(self.job.spindle, Rule::Spindle, "nobody asked for a speed");
                self.modal.speed = Some(*speed);
            }
            Word::Turn => {
                self.require(self.job.spindle, Rule::Spindle, "nobody asked for the spindle");
                self.modal.turns = true;
                self.stopped = false;
            }
            Word::Stop => {
                self.require(self.phase == Phase::Away, Rule::End, "the spindle stops at the workpiece");
                self.modal.turns = false;
                self.stopped = true;
            }
            Word::Upath(on) => {
                self.require(self.job.upath, Rule::Upath, "the control has neither UPATH nor SPATH");
                self.modal.upath = Some(*on);
            }
            Word::SplinePath(axes) => self.modal.spline_path = Some(axes.clone()),
            Word::Group(axes) => self.modal.group = Some(axes.clone()),
            Word::Ends(start, word) => self.modal.ends[usize::from(!start)] = Some(word.clone()),
            Word::Degree(degree) => self.modal.degree = Some(*degree),
            Word::Open(name) => self.opened = Some(name.clone()),
            Word::Finish => {
                self.require(self.stopped, Rule::End, "the spindle was not stopped");
                let retracted = self.phase == Phase::Away && self.is_clear();
                self.require(retracted, Rule::End, "the tool is not retracted");
                self.progress = Progress::Finished;
            }
            Word::Close(name) => {
                let finished = self.progress == Progress::Finished;
                self.require(finished, Rule::End, "no M30 or M2 stands before the last line");
                let same = self.opened.as_ref() == Some(name);
                self.require(same, Rule::End, "the last line is not that of the first");
                self.progress = Progress::Closed;
            }
        }
    }

    fn end(&mut self) {
        let (last, what) = match self.job.dialect {
            Dialect::Sinumerik => (Progress::Finished, "there is no M30 or M2"),
            Dialect::Heidenhain => (Progress::Closed, "there is no END PGM"),
            Dialect::Mazak => (Progress::Closed, "there is no closing %"),
        };
        self.require(self.progress == last, Rule::End, what);
    }

    /// A block that moves.
    fn step(&mut self, block: &Block) {
        match self.modal.motion {
            None => self.violation(Rule::Word, "no motion is in force"),
            Some(Motion::Rapid) => self.rapid(&block.targets),
            Some(motion) => self.at_feed(motion, &block.targets),
        }
        self.holds(&block.targets);
        self.run.moves.push(Move {
            line: block.line,
            section: self.section,
            opens: block.motion.is_some(),
            from: self.at.clone(),
            targets: block.targets.clone(),
            factors: block.factors.clone(),
            knot: block.knot,
            weight: block.weight,
            order: block.order,
            modal: self.modal.effective(self.needs_length(&block.targets)),
        });
        self.at.extend(&block.targets);
        self.begun = true;
        let is = |motions: &[Motion]| self.modal.motion.is_some_and(|motion| motions.contains(&motion));
        let fits = (block.factors.is_empty() || is(&[Motion::Poly, Motion::Spl]))
            && (block.knot.is_none() || is(&[Motion::Poly, Motion::Bspline, Motion::Nurbs]))
            && (block.weight.is_none() || is(&[Motion::Bspline, Motion::Nurbs]))
            && (block.order.is_none() || is(&[Motion::Nurbs]));
        self.require(fits, Rule::Word, "a number of splines belongs to none");
    }

    fn feeds(&self) -> bool {
        self.modal.motion.is_some_and(|motion| motion != Motion::Rapid)
    }

    /// With G43 the length may come with the first move of Z; the others take it from the tool call, or from D before.
    fn needs_length(&self, targets: &BTreeMap<char, f64>) -> bool {
        self.feeds() || self.job.dialect != Dialect::Mazak || targets.contains_key(&'Z')
    }

    /// What must hold before any move, and before a move at feed.
    fn holds(&mut self, targets: &BTreeMap<char, f64>) {
        let header: &[State] = match self.job.dialect {
            Dialect::Sinumerik | Dialect::Mazak => {
                &[State::Plane, State::Millimetres, State::Absolute, State::FeedPerMinute]
            }
            // Klartext is absolute and in mm a minute where no word says otherwise, and its plane is the tool call's.
            Dialect::Heidenhain => &[State::Millimetres],
        };
        for state in header {
            if !self.modal.states.contains(state) {
                self.violation(Rule::Header, format!("{state:?} is not stated"));
            }
        }
        self.require(
            self.modal.tool.is_some() && self.modal.changed,
            Rule::Tool,
            "no tool is in the spindle",
        );
        if self.needs_length(targets) {
            self.require(self.modal.length.is_some(), Rule::Tool, "no tool length counts");
        }
        // D is the number of a cutting edge; H is that of the tool here.
        if self.job.dialect == Dialect::Mazak && self.modal.length.is_some() {
            self.require(self.modal.length == self.modal.tool, Rule::Tool, "the length is another tool's");
        }
        if !self.feeds() {
            return;
        }
        self.require(self.modal.states.contains(&State::NoRadius), Rule::Header, "NoRadius is not stated");
        self.require(
            self.modal.feed.is_some_and(|feed| 0.0 < feed),
            Rule::Feed,
            "no feed is in force for this move",
        );
        let turns = self.modal.turns && self.modal.speed.is_some_and(|speed| 0.0 < speed);
        self.require(turns || !self.job.spindle, Rule::Spindle, "the spindle does not turn");
        let unknown: String = self.axes.iter().filter(|axis| !self.at.contains_key(axis)).collect();
        if !unknown.is_empty() {
            self.violation(Rule::Position, format!("nobody knows where {unknown} is"));
        }
    }

    /// One axis, to the clear position or from there.
    fn rapid(&mut self, targets: &BTreeMap<char, f64>) {
        let (axis, clear) = self.job.retract;
        let retracts = targets.len() == 1 && targets.contains_key(&axis);
        self.require(targets.len() == 1, Rule::Clear, "more than one axis moves at rapid");
        if let Some(to) = targets.get(&axis) {
            self.require(*to == clear, Rule::Clear, "a rapid ends short of the clear position");
        } else {
            self.require(self.is_clear(), Rule::Clear, "a rapid before the tool is clear");
        }
        self.require(self.begun || retracts, Rule::Clear, "a section does not begin with the retraction");
        match self.phase {
            Phase::Away => {}
            Phase::Approached => self.violation(Rule::Order, "the approach leads to no path"),
            Phase::Cutting => {
                self.require(retracts, Rule::Order, "the path is not followed by the retraction");
            }
        }
        self.phase = Phase::Away;
    }

    /// The approach moves the retract axis alone and straight; what follows is the path.
    fn at_feed(&mut self, motion: Motion, targets: &BTreeMap<char, f64>) {
        self.require(self.begun, Rule::Clear, "a section does not begin with the retraction");
        self.phase = match self.phase {
            Phase::Away => {
                let (axis, _) = self.job.retract;
                let approaches = motion == Motion::Line && targets.len() == 1 && targets.contains_key(&axis);
                self.require(approaches, Rule::Order, "the path begins without an approach");
                if approaches { Phase::Approached } else { Phase::Cutting }
            }
            Phase::Approached | Phase::Cutting => Phase::Cutting,
        };
    }
}
