//! A machine that runs programs from their text alone and says what a careful machinist would not let pass.
//!
//! It shares no code with the crate's writers and readers. What it cannot read is a fault too, so that nothing slips by
//! unread. It asks where the tool is, what holds and what comes next; the shape of curves is the oracle's matter.
//!
//! | module | what |
//! |---|---|
//! | [`words`] | the blocks of the three dialects, as one kind of block |
//! | [`run`] | what holds and where the tool is, block by block |
//! | [`curves`] | what spline and polynomial blocks must carry |
//! | [`restart`] | every section alone |
//! | [`damaged`] | programs with one fault, and the rule that finds it |

mod curves;
mod damaged;
mod restart;
mod run;
mod words;

use crate::support::{folder, machine};
use splinepost::machine::Machine;
use std::collections::BTreeSet;
use std::fmt;
use std::fs;
use words::Dialect;

/// What must hold. The names are what a report shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Rule {
    /// Every word is known, stands once in its block, and means one thing.
    Word,
    /// Plane, millimetres, absolute positions, feed a minute and no radius compensation are stated before they count.
    Header,
    /// Nothing is incremental.
    Incremental,
    /// A move at feed finds every axis that the program ever moves where the program has put it.
    Position,
    /// The spindle turns before a move at feed; where no speed was asked for, none is written.
    Spindle,
    /// The tool is in and its length counts before a move that approaches.
    Tool,
    /// A feed is in force before a move at feed.
    Feed,
    /// A section begins with a rapid to the clear position; every rapid moves one axis, and from there.
    Clear,
    /// Approach, path, retraction, in this order.
    Order,
    /// No spline block moves a modulo axis over 0 or 360 degrees.
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
}

impl Rule {
    const ALL: [Rule; 17] = [
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
    ];

    /// Whether programs of this dialect can break it.
    fn applies(self, dialect: Dialect) -> bool {
        match self {
            Rule::Upath | Rule::SplinePath | Rule::Pl => dialect == Dialect::Sinumerik,
            Rule::Nurbs => dialect == Dialect::Mazak,
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
            | Rule::End => true,
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
struct Job {
    dialect: Dialect,
    /// Whether a speed was asked for; a program without one leaves the spindle to the operator.
    spindle: bool,
    /// The axis that moves first in each section, and where it is clear.
    retract: (char, f64),
    /// Axes that wrap at 360 degrees.
    modulo: Vec<char>,
    /// Whether the control has UPATH.
    upath: bool,
}

/// Everything that a program breaks, in the order of its lines.
fn check(job: &Job, text: &str) -> Vec<Violation> {
    let blocks = words::read(job.dialect, text);
    let run = run::run(job, &blocks);
    let mut violations = run.violations;
    violations.extend(curves::check(job, &run.moves));
    violations.extend(restart::check(job, &blocks, &run.moves));
    violations.sort();
    violations
}

/// A golden program: its place under `fixtures/compile`, what it is for, its text.
struct Golden {
    name: String,
    job: Job,
    text: String,
}

/// Reads `<case>/<machine>.<extension>`.
fn golden(name: &str) -> Golden {
    let path = folder("fixtures/compile").join(name);
    let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{name}: {error}"));
    let stem = path.file_stem().expect("a file").to_string_lossy().into_owned();
    let case = path.parent().expect("a case");
    let machine = match fs::read_to_string(case.join(format!("{stem}.machine.toml"))) {
        Ok(text) => machine(&text),
        Err(_) => Machine::built_in(&stem).expect("a machine file or a built-in machine"),
    };
    let input = fs::read_to_string(case.join("input.toml")).expect("input.toml");
    let input: toml::Table = input.parse().expect("TOML");
    let process = input["process"].as_table().expect("[process]");
    let retract = process["retract"].as_table().expect("retract");
    let axis = retract["axis"].as_str().expect("an axis");
    let modulo = machine.axes.as_slice().iter().filter(|(axis, _)| machine.limits(*axis).modulo);
    let job = Job {
        dialect: Dialect::named(machine.dialect.name).expect("a dialect that is read here"),
        spindle: process.contains_key("spindle"),
        retract: (letter(axis), retract["to"].as_float().expect("a position")),
        modulo: modulo.map(|(axis, _)| letter(axis.as_str())).collect(),
        upath: machine.spline.shared_parameter,
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
    for case in fs::read_dir(folder("fixtures/compile")).expect("fixtures/compile").flatten() {
        for file in fs::read_dir(case.path()).expect("a case").flatten() {
            let is_program = file.path().extension().is_some_and(|extension| extension != "toml");
            if is_program {
                names.push(format!(
                    "{}/{}",
                    case.file_name().to_string_lossy(),
                    file.file_name().to_string_lossy()
                ));
            }
        }
    }
    names.sort();
    names.iter().map(|name| golden(name)).collect()
}

/// Golden programs that break a rule, with the rule and what the report says; nothing else is excused, and an entry
/// that no longer holds fails.
///
/// Mazak: the header cancels the tool's length (G49), and `G43 H` stands in the first section only. Whoever restarts
/// at a later section, with the lines before the first, moves Z without the length.
const KNOWN: &[(&str, Rule, &str)] = &[];

#[test]
fn golden_programs_break_no_rule() {
    let mut wrong = Vec::new();
    let mut excused = BTreeSet::new();
    let mut dialects = BTreeSet::new();
    for Golden { name, job, text } in goldens() {
        dialects.insert(job.dialect);
        for violation in check(&job, &text) {
            let known = KNOWN.iter().position(|(file, rule, what)| {
                *file == name && *rule == violation.rule && *what == violation.what
            });
            match known {
                Some(at) => drop(excused.insert(at)),
                None => wrong.push(format!("{name}:{violation}")),
            }
        }
    }
    for (at, (name, rule, what)) in KNOWN.iter().enumerate() {
        if !excused.contains(&at) {
            wrong.push(format!("{name} no longer breaks {rule:?} ({what}): take it off the list"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert_eq!(dialects.len(), splinepost::dialect::DIALECTS.len(), "a dialect has no golden program");
}
