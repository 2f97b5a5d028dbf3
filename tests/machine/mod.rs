//! A machine that runs programs from their text alone and says what a careful machinist would not let pass.
//!
//! It shares no code with the crate's writers and readers. What it cannot read is a fault too, so that nothing slips by
//! unread. It asks where the tool is, what holds and what comes next; whether curves have the right shape is the oracle's
//! matter.
//!
//! | module | what |
//! |---|---|
//! | [`words`] | the blocks of the three dialects, as one kind of block |
//! | [`calls`] | subprograms, put where they are called |
//! | [`run`], [`state`] | what holds and where the tool is, block by block |
//! | [`curves`] | what spline and polynomial blocks must carry |
//! | [`motion`] | how far, how fast and which way the axes go |
//! | [`restart`] | every section alone |
//! | [`frame`] | start and end of every program, and what stands round its paths, by the table of its control |
//! | [`known`] | what the programs are known to break |
//! | [`damaged`] | programs with one fault, and the rule that finds it |

mod calls;
mod curves;
mod damaged;
mod frame;
mod known;
mod motion;
mod restart;
mod run;
mod state;
mod words;

use crate::support::{folder, machine};
use splinepost::machine::{AxisLimits, Machine, RotaryFeed};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::fs;
use words::Dialect;

/// What must hold. The names are what a report shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Rule {
    /// Every word is known, stands once in its block, and means one thing.
    Word,
    /// What another program may have left is stated before it counts, by the table of the control: plane, unit, feed mode and
    /// so on; and it is as every program takes it to be at a tool change and at the end.
    Header,
    /// Nothing is incremental, but Heidenhain's lines round an axis that wraps.
    Incremental,
    /// A move at feed finds every axis that the program ever moves where the program has put it.
    Position,
    /// The spindle turns before a move at feed; where no speed was asked for, none is written.
    Spindle,
    /// The tool is in and its length counts before a move that approaches.
    Tool,
    /// A feed is in force before a move at feed, and counts the axes that the machine file says.
    Feed,
    /// A section begins with a rapid to the clear position; every rapid moves one axis, and from there.
    Clear,
    /// Approach, path, retraction, in this order, and every section has them; only then the way back at feed.
    Order,
    /// A modulo axis stays between 0 and 360 degrees in a spline block, as the text counts it, and turns by less than
    /// half a turn in a line; the short way is asked for where there is one.
    Modulo,
    /// Sinumerik: UPATH before curve blocks that move an axis outside FGROUP.
    Upath,
    /// Sinumerik: SPLINEPATH names every axis of a spline run.
    SplinePath,
    /// Sinumerik: PL on every BSPLINE block, 0 on the first and the last.
    Pl,
    /// Mazak: every G06.2 block has its K, every control point all axes, and the curve closes with K alone.
    Nurbs,
    /// Heidenhain: K3 K2 K1 for every axis of SPL, and a start where the tool is.
    Spl,
    /// Each section makes the same moves when only the lines before the first section precede it.
    Restart,
    /// Retraction, M5, M30 or M2, and the closing line; nothing behind.
    End,
    /// The axis that retracts is home in machine coordinates before the tool change and at the end, without a length.
    Home,
    /// Every axis has a stated zero; each section states the work offsets that any section states, and all are taken back
    /// before the end.
    Offset,
    /// A parameter has one value before it counts, and counts for something.
    Parameter,
    /// Every call finds its subprogram and every subprogram its return and a call.
    Call,
    /// Where coolant was asked for it flows on the path and is off at the end; where not, it never flows.
    Coolant,
    /// Paths begin as far apart as the remarks of their sections say.
    Index,
    /// Within a path a rotary axis does not turn back.
    Turn,
    /// No axis leaves its range.
    Range,
    /// No axis is faster at feed than it can be.
    Speed,
    /// No tilt, tip control, direction, cycle, way of counting F or turn past 360 degrees is left on the way home, at a tool
    /// change or at the end.
    Left,
    /// No axis is named that the machine has not.
    Axis,
    /// A length begins in a block of its axis, and ends where the control may move by it.
    Length,
    /// The tool stands upright at the end.
    Upright,
    /// Where a direction is stated, all of it is, and all of the place where the control wants that.
    Direction,
    /// Remarks have letters that the control takes.
    Remark,
}

impl Rule {
    const ALL: [Rule; 32] = [
        Rule::Word,
        Rule::Header,
        Rule::Incremental,
        Rule::Position,
        Rule::Spindle,
        Rule::Tool,
        Rule::Feed,
        Rule::Clear,
        Rule::Order,
        Rule::Modulo,
        Rule::Upath,
        Rule::SplinePath,
        Rule::Pl,
        Rule::Nurbs,
        Rule::Spl,
        Rule::Restart,
        Rule::End,
        Rule::Home,
        Rule::Offset,
        Rule::Parameter,
        Rule::Call,
        Rule::Coolant,
        Rule::Index,
        Rule::Turn,
        Rule::Range,
        Rule::Speed,
        Rule::Left,
        Rule::Axis,
        Rule::Length,
        Rule::Upright,
        Rule::Direction,
        Rule::Remark,
    ];

    /// Whether programs of this dialect can break it.
    fn applies(self, dialect: Dialect) -> bool {
        match self {
            Rule::Upath | Rule::SplinePath | Rule::Pl => dialect == Dialect::Sinumerik,
            Rule::Nurbs => dialect == Dialect::Mazak,
            // The length comes with the tool call, and nothing ends it.
            Rule::Length => dialect != Dialect::Heidenhain,
            Rule::Spl => dialect == Dialect::Heidenhain,
            Rule::Word
            | Rule::Header
            | Rule::Incremental
            | Rule::Position
            | Rule::Spindle
            | Rule::Tool
            | Rule::Feed
            | Rule::Clear
            | Rule::Order
            | Rule::Modulo
            | Rule::Restart
            | Rule::End
            | Rule::Home
            | Rule::Offset
            | Rule::Parameter
            | Rule::Call
            | Rule::Coolant
            | Rule::Index
            | Rule::Turn
            | Rule::Range
            | Rule::Speed
            | Rule::Left
            | Rule::Axis
            | Rule::Upright
            | Rule::Direction
            | Rule::Remark => true,
        }
    }
}

/// Where a program breaks a rule.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Violation {
    /// Counted from 1.
    line: usize,
    rule: Rule,
    what: String,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {:?}: {}", self.line, self.rule, self.what)
    }
}

/// What the text does not say itself: what was asked for, and what the machine is.
#[derive(Clone, Debug)]
#[allow(clippy::struct_excessive_bools, reason = "each is asked for, or not, by itself")]
struct Job {
    dialect: Dialect,
    /// Whether a speed was asked for; a program without one leaves the spindle to the operator.
    spindle: bool,
    coolant: bool,
    /// The axis that moves first in each section, and where it is clear.
    retract: (char, f64),
    /// Where that axis is clear in machine coordinates.
    home: Option<f64>,
    /// Axes that wrap at 360 degrees.
    modulo: Vec<char>,
    /// Axes that the text counts the other way.
    reversed: Vec<char>,
    limits: BTreeMap<char, Limits>,
    counts: Counts,
    /// Whether the control has UPATH.
    upath: bool,
    /// The axes that the machine file declares, and where each is clear in machine coordinates.
    axes: Vec<char>,
    homes: BTreeMap<char, f64>,
    /// The axis that retracts, where it has such a place.
    home_axis: Option<char>,
    /// Whether the machine file has lines that tilt a plane.
    tilts: bool,
    /// Whether the program is made of sections, as those of cutters and jobs are.
    sections: bool,
}

/// What an axis can do, as the control counts it; infinite where the machine file does not say.
#[derive(Clone, Copy, Debug)]
struct Limits {
    min: f64,
    max: f64,
    /// At feed, a minute.
    speed: f64,
}

/// What F counts of a block that moves linear and rotary axes.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Counts {
    Linear,
    DegreesAsMm,
    Surface,
    /// Lines have their time as F, in 1/min.
    Time,
}

/// Floating-point noise. Numbers stay below 1e4, so that an operation costs at most 1e4 · 2⁻⁵³ ≈ 1e-12, and none here
/// takes more than a hundred; taken up by a power of ten, and still a thousandth of what a program can write.
const NOISE: f64 = 1.0e-9;

/// Whether an axis turns.
fn is_rotary(axis: char) -> bool {
    "ABC".contains(axis)
}

/// Everything that a program breaks, in the order of its lines.
fn check(job: &Job, text: &str) -> Vec<Violation> {
    let mut violations = frame::check(job, text);
    if job.sections {
        // The others are asked more exactly of sections.
        violations.retain(|violation| frame::OWN.contains(&violation.rule));
        violations.extend(sections(job, text));
    }
    violations.sort();
    // What a subprogram breaks it breaks in every call.
    violations.dedup();
    violations
}

/// What the sections of a cutter or a job break.
fn sections(job: &Job, text: &str) -> Vec<Violation> {
    let (blocks, mut violations) = calls::expand(&words::read(job.dialect, text));
    let run = run::run(job, &blocks);
    violations.extend(run.violations);
    violations.extend(motion::check(job, &run.moves, &run.starts));
    violations.extend(curves::check(job, &run.moves));
    violations.extend(restart::check(job, &blocks, &run.moves));
    violations
}

/// A golden program: its place under `fixtures/compile`, or behind `apt/` and `curves/`; what it is for; its text.
struct Golden {
    name: String,
    job: Job,
    text: String,
}

/// Where golden programs stand: what their names begin with, and the folder.
const FOLDERS: [(&str, &str); 3] =
    [("", "fixtures/compile"), ("apt/", "fixtures/apt"), ("curves/", "fixtures/curves")];

/// The programs that have sections are those under `fixtures/compile`.
fn place(name: &str) -> (std::path::PathBuf, bool) {
    let (start, under) = FOLDERS.into_iter().rfind(|(start, _)| name.starts_with(start)).expect("a folder");
    (folder(under).join(&name[start.len()..]), start.is_empty())
}

/// Reads `<case>/<machine>.<extension>`.
fn golden(name: &str) -> Golden {
    let (path, sections) = place(name);
    let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{name}: {error}"));
    let stem = path.file_stem().expect("a file").to_string_lossy().into_owned();
    let case = path.parent().expect("a case");
    let machine = match fs::read_to_string(case.join(format!("{stem}.machine.toml"))) {
        Ok(text) => machine(&text),
        Err(_) => Machine::built_in(&stem).expect("a machine file or a built-in machine"),
    };
    // CL data and curve files retract along Z, and have no `[process]` that says where.
    let input = fs::read_to_string(case.join("input.toml")).unwrap_or_default();
    let input: toml::Table = input.parse().expect("TOML");
    let process = input.get("process").and_then(toml::Value::as_table).cloned().unwrap_or_default();
    let retract = process.get("retract").and_then(toml::Value::as_table);
    let axis = retract.map_or("Z", |retract| retract["axis"].as_str().expect("an axis"));
    let clear = retract.map_or(0.0, |retract| retract["to"].as_float().expect("a position"));
    let axes =
        || machine.axes.as_slice().iter().map(|(axis, _)| (letter(axis.as_str()), machine.limits(*axis)));
    let limits = |limits: AxisLimits| Limits {
        min: limits.min.unwrap_or(f64::NEG_INFINITY),
        max: limits.max.unwrap_or(f64::INFINITY),
        speed: limits.max_speed.unwrap_or(f64::INFINITY),
    };
    let retract = (letter(axis), clear);
    let homes: BTreeMap<char, f64> = axes().filter_map(|(axis, limits)| Some((axis, limits.home?))).collect();
    let job = Job {
        dialect: Dialect::named(machine.dialect.name).expect("a dialect that is read here"),
        spindle: process.contains_key("spindle"),
        coolant: process.get("coolant").is_some_and(|coolant| coolant.as_bool() == Some(true)),
        retract,
        home: homes.get(&retract.0).copied(),
        modulo: axes().filter(|(_, limits)| limits.modulo).map(|(axis, _)| axis).collect(),
        reversed: axes().filter(|(_, limits)| limits.reversed).map(|(axis, _)| axis).collect(),
        limits: axes().map(|(axis, of)| (axis, limits(of))).collect(),
        counts: match machine.rotary_feed {
            RotaryFeed::Free => Counts::Linear,
            RotaryFeed::DegreesAsMm => Counts::DegreesAsMm,
            RotaryFeed::Surface => Counts::Surface,
            RotaryFeed::InverseTime => Counts::Time,
        },
        upath: machine.spline.shared_parameter,
        axes: axes().map(|(axis, _)| axis).collect(),
        home_axis: Some(retract.0).filter(|axis| homes.contains_key(axis)),
        homes,
        tilts: !machine.frame.plane.is_empty(),
        sections,
    };
    Golden { name: name.to_owned(), job, text }
}

/// The letter of an axis; here all have one.
fn letter(name: &str) -> char {
    let mut letters = name.chars();
    let letter = letters.next().expect("a letter");
    assert_eq!(letters.next(), None, "{name}");
    letter
}

/// All golden programs.
fn goldens() -> Vec<Golden> {
    let mut names = Vec::new();
    for (start, under) in FOLDERS {
        for case in fs::read_dir(folder(under)).expect(under).flatten() {
            for file in fs::read_dir(case.path()).expect("a case").flatten() {
                let name = file.file_name().to_string_lossy().into_owned();
                if crate::support::is_program(&file.path()) && !name.starts_with("input.") {
                    names.push(format!("{start}{}/{name}", case.file_name().to_string_lossy()));
                }
            }
        }
    }
    names.sort();
    names.iter().map(|name| golden(name)).collect()
}

#[test]
fn golden_programs_break_no_rule() {
    let mut wrong = Vec::new();
    let mut seen = BTreeSet::new();
    for Golden { name, job, text } in goldens() {
        seen.insert((job.dialect, job.sections));
        let violations = known::without(&job, check(&job, &text));
        wrong.extend(violations.iter().map(|violation| format!("{name}:{violation}")));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert_eq!(seen.len(), 2 * splinepost::dialect::DIALECTS.len(), "a dialect has no golden program");
}
