//! What holds and where the tool is, block by block, and the rules about both.

use super::state::{Length, Modal, Move, Run, Start, Zero};
use super::words::{Block, Dialect, Motion, State, Target, Value, Word};
use super::{Counts, Job, NOISE, Rule, Violation};
use std::collections::{BTreeMap, BTreeSet};

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

/// What one section has done.
#[derive(Default)]
struct Section {
    remark: String,
    line: usize,
    /// Whether it has moved already.
    begun: bool,
    /// Whether its path has been run.
    cut: bool,
    /// The axes that it has stated an offset of, before it moved.
    shifted: BTreeSet<char>,
}

struct Control<'a> {
    job: &'a Job,
    /// Every axis that the program ever moves.
    axes: BTreeSet<char>,
    modal: Modal,
    /// From the work's own zero.
    at: BTreeMap<char, f64>,
    /// Whether the axis that retracts is in its home.
    home: bool,
    phase: Phase,
    sections: usize,
    section: Section,
    /// Line and shifted axes of every section that moved.
    shifted: Vec<(usize, BTreeSet<char>)>,
    parameters: BTreeMap<u32, Parameter>,
    /// Heidenhain: the last part of cycle 7.
    part: Option<usize>,
    stopped: bool,
    opened: Option<String>,
    progress: Progress,
    line: usize,
    run: Run,
}

struct Parameter {
    line: usize,
    value: f64,
    used: bool,
}

/// Runs a program.
pub(super) fn run(job: &Job, blocks: &[Block]) -> Run {
    let mut control = Control {
        job,
        axes: blocks.iter().flat_map(|block| block.targets.keys().copied()).collect(),
        home: false,
        modal: Modal::default(),
        at: BTreeMap::new(),
        phase: Phase::Away,
        sections: 0,
        section: Section::default(),
        shifted: Vec::new(),
        parameters: BTreeMap::new(),
        part: None,
        stopped: false,
        opened: None,
        progress: Progress::Running,
        line: 0,
        run: Run { moves: Vec::new(), starts: Vec::new(), violations: Vec::new() },
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
        self.home || self.counted(axis).is_some_and(|at| (at - clear).abs() < NOISE)
    }

    /// The zero of an axis; where none is stated, another rule speaks.
    fn zero(&self, axis: char) -> f64 {
        self.modal.zeros.get(&axis).map_or(0.0, |zero| zero.at)
    }

    /// Where an axis is, as the text counts now; one that wraps between 0 and 360, both included.
    fn counted(&self, axis: char) -> Option<f64> {
        let at = self.at.get(&axis)? - self.zero(axis);
        let inside = (-NOISE..=360.0 + NOISE).contains(&at);
        Some(if inside || !self.job.modulo.contains(&axis) { at } else { at.rem_euclid(360.0) })
    }

    /// The number of a value.
    fn resolve(&mut self, value: Value) -> Option<f64> {
        let parameter = match value {
            Value::Number(number) => return Some(number),
            Value::Parameter(of) => self.parameters.get_mut(&of),
        };
        let found = parameter.map(|parameter| {
            parameter.used = true;
            parameter.value
        });
        self.require(found.is_some(), Rule::Parameter, "a parameter has no value yet");
        found
    }

    fn block(&mut self, block: &Block) {
        self.line = block.line;
        for fault in &block.faults {
            self.violation(Rule::Word, format!("`{fault}` is not understood"));
        }
        let closes = matches!(block.words.as_slice(), [Word::Close(_)]);
        let over = if closes { Progress::Closed } else { Progress::Finished };
        self.require(self.progress < over, Rule::End, "the program has ended before");
        if let Some(remark) = &block.section {
            self.leave();
            self.sections += 1;
            self.section = Section { remark: remark.clone(), line: block.line, ..Section::default() };
        }
        if let Some((of, value)) = block.assign {
            let parameter = Parameter { line: block.line, value, used: false };
            let known = self.parameters.insert(of, parameter).is_some();
            self.require(!known, Rule::Parameter, "a parameter has a value already");
        }
        for word in &block.words {
            self.word(word);
        }
        self.shift(block);
        self.modal.motion = block.motion.or(self.modal.motion);
        if let Some(feed) = block.feed {
            self.modal.feed = self.resolve(feed);
        } else if self.modal.timed && self.feeds() {
            // Under inverse time F stands in every block.
            self.modal.feed = None;
        }
        if block.machine {
            return self.go_home(block);
        }
        let knot = block.knot.is_some() && self.modal.motion == Some(Motion::Nurbs);
        if !block.targets.is_empty() || !block.factors.is_empty() || knot {
            self.step(block);
        } else {
            let stray = block.knot.is_some() || block.weight.is_some() || block.order.is_some();
            self.require(!stray, Rule::Word, "a number of splines belongs to none");
        }
    }

    /// A section ends, by the next or with the program.
    fn leave(&mut self) {
        self.require(self.phase == Phase::Away, Rule::Order, "the section before ends at the workpiece");
        let section = std::mem::take(&mut self.section);
        if self.sections == 0 {
            return;
        }
        if !section.cut {
            let what = "a section has no path".to_owned();
            self.run.violations.push(Violation { line: section.line, rule: Rule::Order, what });
        }
        self.shifted.push((section.line, section.shifted));
    }

    /// A work offset. TRANS puts all axes back that it does not name; the others leave them.
    fn shift(&mut self, block: &Block) {
        let follows = match (block.part, self.part) {
            (None, before) => before != Some(0),
            (Some(0), _) => true,
            (Some(part), before) => before.is_some_and(|before| part == before + 1),
        };
        self.require(follows, Rule::Word, "the parts of cycle 7 do not follow each other");
        self.part = block.part;
        let Some(shift) = &block.shift else { return };
        if self.job.dialect == Dialect::Sinumerik {
            let zero = Zero { at: 0.0, parameter: false };
            self.modal.zeros = "XYZABCUVW".chars().map(|axis| (axis, zero)).collect();
        }
        self.require(
            self.phase == Phase::Away,
            Rule::Offset,
            "the zero moves while the tool is at the workpiece",
        );
        for (axis, value) in shift {
            let Some(at) = self.resolve(*value) else { continue };
            let parameter = matches!(value, Value::Parameter(_));
            self.modal.zeros.insert(*axis, Zero { at, parameter });
            if !self.section.begun {
                self.section.shifted.insert(*axis);
            }
        }
    }

    /// The axis that retracts goes home, in machine coordinates. Where that is from the work's zero nobody knows.
    fn go_home(&mut self, block: &Block) {
        let (axis, _) = self.job.retract;
        // The axis that retracts goes first; where it is home others may go to theirs.
        let is_home = block.targets.iter().all(|(to, target)| match target {
            Target::To(Value::Number(at)) => {
                (*to == axis || self.home) && self.job.homes.get(to).is_some_and(|home| home == at)
            }
            Target::To(Value::Parameter(_)) | Target::Short(_) | Target::By(_) => false,
        });
        let is_home = is_home && block.targets.len() == 1;
        self.require(is_home, Rule::Home, "this is not the home of the axis that retracts");
        self.require(self.modal.motion == Some(Motion::Rapid), Rule::Home, "the way home is not a rapid");
        // M91 leaves the length out by itself; whether G53 does no manual says, and it is called again behind it.
        let free = self.modal.length == Length::Cancelled || self.job.dialect != Dialect::Sinumerik;
        self.require(free, Rule::Home, "the tool's length may count on the way home");
        if self.job.dialect == Dialect::Mazak {
            self.modal.length = Length::Unknown;
        }
        self.require(self.phase != Phase::Cutting, Rule::Order, "the path is not followed by the retraction");
        self.states();
        self.phase = Phase::Away;
        for axis in block.targets.keys() {
            self.at.remove(axis);
        }
        self.home = is_home;
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
                let home = self.home || self.job.home.is_none();
                self.require(home, Rule::Home, "the tool is changed away from home");
                self.modal.changed = self.modal.tool.is_some();
            }
            Word::Length(length) => self.modal.length = Length::Of(*length),
            Word::NoLength => {
                self.require(self.phase == Phase::Away, Rule::Tool, "the length goes at the workpiece");
                self.modal.length = Length::Cancelled;
            }
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
            Word::Timed(timed) => {
                if *timed && self.job.counts != Counts::Time {
                    self.modal.states.remove(&State::FeedPerMinute);
                    self.violation(Rule::Header, "FeedPerMinute is left");
                }
                // What holds under the one means nothing under the other.
                if self.modal.timed != *timed {
                    self.modal.feed = None;
                }
                self.modal.timed = *timed;
            }
            Word::Coolant(on) => {
                self.require(self.job.coolant || !on, Rule::Coolant, "nobody asked for coolant");
                self.modal.coolant = *on;
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
                self.require(
                    self.home || self.job.home.is_none(),
                    Rule::Home,
                    "the program ends away from home",
                );
                self.require(!self.modal.coolant, Rule::Coolant, "the coolant is not off at the end");
                let back = self.modal.zeros.values().all(|zero| zero.at == 0.0 && !zero.parameter);
                self.require(back, Rule::Offset, "the work offset is not taken back");
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
        if self.phase == Phase::Away {
            self.leave();
        }
        let any: BTreeSet<char> = self.shifted.iter().flat_map(|(_, axes)| axes.iter().copied()).collect();
        for (line, axes) in std::mem::take(&mut self.shifted) {
            let left: String = any.difference(&axes).collect();
            if !left.is_empty() {
                let what = format!("the section does not state from where {left} is counted");
                self.run.violations.push(Violation { line, rule: Rule::Offset, what });
            }
        }
        for parameter in self.parameters.values().filter(|parameter| !parameter.used) {
            let what = "a parameter counts for nothing".to_owned();
            self.run.violations.push(Violation { line: parameter.line, rule: Rule::Parameter, what });
        }
    }

    /// How far an axis goes on a straight way, and where its number is then.
    fn way(&mut self, axis: char, target: Target) -> Option<(f64, f64)> {
        let wraps = self.job.modulo.contains(&axis);
        let from = self.counted(axis);
        let straight = matches!(self.modal.motion, Some(Motion::Line | Motion::Rapid));
        // The short way, -180 to 180.
        let short = |to: f64| from.map(|from| (to - from + 180.0).rem_euclid(360.0) - 180.0);
        match target {
            Target::To(value) => {
                let to = self.resolve(value)?;
                let by = if wraps && straight && self.job.dialect == Dialect::Mazak {
                    short(to)
                } else {
                    from.map(|from| to - from)
                };
                // A roll-over axis of Mazak takes any number, the others those of one turn.
                let fits = !wraps || self.job.dialect == Dialect::Mazak || (0.0..=360.0).contains(&to);
                self.require(
                    fits || !straight,
                    Rule::Modulo,
                    "there is no such number on an axis that wraps",
                );
                self.half_a_turn(axis, by.filter(|_| wraps && straight));
                Some((to, by.unwrap_or(0.0)))
            }
            Target::Short(to) => {
                let fits = wraps && (0.0..=360.0).contains(&to);
                self.require(fits, Rule::Modulo, "the short way to where there is none");
                self.half_a_turn(axis, short(to));
                Some((to, short(to).unwrap_or(0.0)))
            }
            Target::By(by) => {
                let line = self.modal.motion == Some(Motion::Line);
                let fits = wraps && line && self.job.dialect == Dialect::Heidenhain;
                self.require(fits, Rule::Incremental, "positions are incremental");
                self.require(from.is_some(), Rule::Position, "an increment from nowhere");
                self.half_a_turn(axis, Some(by));
                Some((from? + by, by))
            }
        }
    }

    /// Half a turn has no short way, and no path turns that far in one line.
    fn half_a_turn(&mut self, axis: char, by: Option<f64>) {
        let far = self.feeds() && by.is_some_and(|by| 180.0 - NOISE <= by.abs());
        self.require(!far, Rule::Modulo, &format!("{axis} turns by half a turn or more in one line"));
    }

    /// A block that moves.
    fn step(&mut self, block: &Block) {
        let mut targets = BTreeMap::new();
        let mut by = BTreeMap::new();
        for (axis, target) in &block.targets {
            if let Some((to, way)) = self.way(*axis, *target) {
                targets.insert(*axis, to);
                by.insert(*axis, way);
            }
        }
        if targets.is_empty() && !block.targets.is_empty() {
            return;
        }
        match self.modal.motion {
            None => self.violation(Rule::Word, "no motion is in force"),
            Some(Motion::Rapid) => self.rapid(&targets),
            Some(motion) => self.at_feed(motion, &targets),
        }
        self.holds(&targets);
        self.run.moves.push(Move {
            line: block.line,
            section: self.sections,
            opens: block.motion.is_some(),
            from: self.at.keys().filter_map(|axis| Some((*axis, self.counted(*axis)?))).collect(),
            targets: targets.clone(),
            by,
            path: self.phase == Phase::Cutting,
            factors: block.factors.clone(),
            knot: block.knot,
            weight: block.weight,
            order: block.order,
            modal: self.modal.effective(self.needs_length(&targets)),
        });
        for (axis, to) in targets {
            self.at.insert(axis, self.zero(axis) + to);
            self.home &= axis != self.job.retract.0;
        }
        self.section.begun = true;
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

    /// What the header states.
    fn states(&mut self) {
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
    }

    /// What must hold before any move, and before a move at feed.
    fn holds(&mut self, targets: &BTreeMap<char, f64>) {
        self.states();
        let left: String = targets.keys().filter(|axis| !self.modal.zeros.contains_key(axis)).collect();
        if !left.is_empty() {
            self.violation(Rule::Offset, format!("an offset of {left} may be left from another program"));
        }
        self.require(
            self.modal.tool.is_some() && self.modal.changed,
            Rule::Tool,
            "no tool is in the spindle",
        );
        if self.needs_length(targets) {
            self.require(self.modal.length.counts(), Rule::Tool, "no tool length counts");
        }
        // D is the number of a cutting edge; H is that of the tool here.
        if let (Dialect::Mazak, Length::Of(length)) = (self.job.dialect, self.modal.length) {
            self.require(Some(length) == self.modal.tool, Rule::Tool, "the length is another tool's");
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
            self.require((to - clear).abs() < NOISE, Rule::Clear, "a rapid ends short of the clear position");
        } else {
            self.require(self.is_clear(), Rule::Clear, "a rapid before the tool is clear");
        }
        // Before the first section, from its home, the tool goes over the work.
        let over = self.sections == 0 && self.home;
        if retracts && self.home && !over {
            let linear =
                self.axes.iter().filter(|axis| **axis != self.job.retract.0 && !"ABC".contains(**axis));
            let placed = linear.copied().all(|axis| self.at.contains_key(&axis));
            self.require(placed, Rule::Clear, "the tool goes down from home before it is over the work");
        }
        self.require(
            self.section.begun || retracts || over,
            Rule::Clear,
            "a section does not begin with the retraction",
        );
        match self.phase {
            Phase::Away => {}
            Phase::Approached => self.violation(Rule::Order, "the approach leads to no path"),
            Phase::Cutting => {
                self.require(retracts, Rule::Order, "the path is not followed by the retraction");
            }
        }
        self.phase = Phase::Away;
    }

    /// The approach moves the retract axis alone and straight; what follows is the path. Behind the path and clear of the
    /// work the linear axes may go back one by one.
    fn at_feed(&mut self, motion: Motion, targets: &BTreeMap<char, f64>) {
        self.require(self.section.begun, Rule::Clear, "a section does not begin with the retraction");
        let (axis, _) = self.job.retract;
        let alone = motion == Motion::Line && targets.len() == 1;
        self.phase = match self.phase {
            Phase::Away if alone && targets.contains_key(&axis) => {
                self.require(!self.section.cut, Rule::Order, "a section has one path");
                Phase::Approached
            }
            Phase::Away => {
                let linear = targets.keys().all(|axis| "XYZUVW".contains(*axis));
                let back = alone && linear && self.section.cut && self.is_clear();
                self.require(back, Rule::Order, "the path begins without an approach");
                if back { Phase::Away } else { Phase::Cutting }
            }
            Phase::Approached => Phase::Cutting,
            Phase::Cutting => return,
        };
        if self.phase == Phase::Cutting {
            let first = !std::mem::replace(&mut self.section.cut, true);
            let flows = self.modal.coolant || !self.job.coolant;
            self.require(flows, Rule::Coolant, "the coolant does not flow");
            if first {
                let Section { remark, line, .. } = &self.section;
                self.run.starts.push(Start { line: *line, remark: remark.clone(), at: self.at.clone() });
            }
        }
    }
}
