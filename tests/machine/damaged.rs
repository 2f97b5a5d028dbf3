//! Golden programs with one fault each, and the rules that must find it: these and no others.
//!
//! Some lines name two rules, where one fault breaks both; a line without rules is no fault, and holds a rule back from
//! asking too much. Every rule has a fault of its own in every dialect in which it applies.

mod heidenhain;
mod mazak;
mod sinumerik;

use super::words::Dialect;
use super::{Golden, Job, Limits, Rule, Violation, check, golden, known};
use std::collections::BTreeSet;

/// One change. A pattern stands where no letter, digit or point touches it; occurrences are counted from 1.
enum Edit {
    /// The line goes.
    Drop(&'static str, usize),
    /// Another text stands in its place.
    Put(&'static str, usize, &'static str),
    /// A line before its line.
    Before(&'static str, usize, &'static str),
    /// A line after its line.
    After(&'static str, usize, &'static str),
    /// Its line and the next change places.
    Down(&'static str, usize),
    /// Not the program but the machine: this axis wraps.
    Wraps(char),
    /// Nor here: this axis has a least and a greatest position, and a greatest speed.
    Limit(char, [f64; 3]),
}

/// The file, what is done to it, and the rules that it then breaks, in their order.
type Fault = (&'static str, &'static [Edit], &'static [Rule]);

/// Where an occurrence begins.
fn place(text: &str, pattern: &str, occurrence: usize) -> usize {
    let touches = |c: Option<char>| c.is_some_and(|c| c.is_ascii_alphanumeric() || c == '.');
    let free = |at: usize| {
        let (before, rest) = text.split_at(at);
        !touches(before.chars().next_back()) && !touches(rest[pattern.len()..].chars().next())
    };
    let mut found = text.match_indices(pattern).map(|(at, _)| at).filter(|at| free(*at));
    found
        .nth(occurrence - 1)
        .unwrap_or_else(|| panic!("no occurrence {occurrence} of `{pattern}` in\n{text}"))
}

/// The text before, of and after the line at a place.
fn line_at(text: &str, at: usize) -> (&str, &str, &str) {
    let start = text[..at].rfind('\n').map_or(0, |end| end + 1);
    let end = text[at..].find('\n').map_or(text.len(), |length| at + length + 1);
    (&text[..start], &text[start..end], &text[end..])
}

fn apply(edit: &Edit, job: &mut Job, text: &str) -> String {
    let split = |pattern: &str, occurrence: usize| line_at(text, place(text, pattern, occurrence));
    match edit {
        Edit::Drop(pattern, occurrence) => {
            let (before, _, after) = split(pattern, *occurrence);
            format!("{before}{after}")
        }
        Edit::Put(pattern, occurrence, other) => {
            let at = place(text, pattern, *occurrence);
            format!("{}{other}{}", &text[..at], &text[at + pattern.len()..])
        }
        Edit::Before(pattern, occurrence, added) => {
            let (before, line, after) = split(pattern, *occurrence);
            format!("{before}{added}\n{line}{after}")
        }
        Edit::After(pattern, occurrence, added) => {
            let (before, line, after) = split(pattern, *occurrence);
            format!("{before}{line}{added}\n{after}")
        }
        Edit::Down(pattern, occurrence) => {
            let (before, line, after) = split(pattern, *occurrence);
            let (next, rest) = after.split_once('\n').expect("a next line");
            format!("{before}{next}\n{line}{rest}")
        }
        Edit::Wraps(axis) => {
            job.modulo.push(*axis);
            text.to_owned()
        }
        Edit::Limit(axis, [min, max, speed]) => {
            job.limits.insert(*axis, Limits { min: *min, max: *max, speed: *speed });
            text.to_owned()
        }
    }
}

fn damaged(file: &str, edits: &[Edit]) -> Vec<Violation> {
    let Golden { mut job, text, .. } = golden(file);
    assert_eq!(known::without(&job, check(&job, &text)), [], "{file}");
    let text = edits.iter().fold(text, |text, edit| apply(edit, &mut job, &text));
    known::without(&job, check(&job, &text))
}

/// All faults, with the dialect of their files.
fn faults() -> impl Iterator<Item = (Dialect, &'static Fault)> {
    let of = |dialect, faults: &'static [Fault]| faults.iter().map(move |fault| (dialect, fault));
    of(Dialect::Sinumerik, sinumerik::FAULTS)
        .chain(of(Dialect::Heidenhain, heidenhain::FAULTS))
        .chain(of(Dialect::Mazak, mazak::FAULTS))
}

#[test]
fn every_fault_breaks_its_rule() {
    let mut wrong = Vec::new();
    for (at, (dialect, (file, edits, rules))) in faults().enumerate() {
        assert_eq!(golden(file).job.dialect, dialect, "{file}");
        let violations = damaged(file, edits);
        let broken: BTreeSet<Rule> = violations.iter().map(|violation| violation.rule).collect();
        if !broken.iter().eq(rules.iter()) {
            let mut shown = BTreeSet::new();
            let each = violations.iter().filter(|violation| shown.insert((violation.rule, &violation.what)));
            let found: Vec<String> = each.map(|violation| format!("\n  {violation}")).collect();
            wrong.push(format!("fault {at}, {file}: {rules:?} expected, found:{}", found.concat()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_rule_has_a_fault_of_its_own_in_every_dialect() {
    for dialect in Dialect::ALL {
        for rule in Rule::ALL {
            let own = faults().any(|(of, (_, _, rules))| of == dialect && *rules == [rule]);
            assert_eq!(own, rule.applies(dialect), "{dialect:?}: {rule:?}");
        }
    }
}

/// The line counts from 1, as an editor shows it; of a block of several lines it is the first.
#[test]
fn a_report_names_the_line() {
    for (file, edits, expected) in [
        (
            "conical-mill/sinumerik.mpf",
            [Edit::Put("Z0 F200", 1, "Z0")],
            "32: Feed: no feed is in force for this move",
        ),
        (
            "cylinder/heidenhain-spl.h",
            [Edit::Put("A+137.8322", 1, "A+137.9")],
            "39: Spl: A starts 0.067800 from the tool",
        ),
        (
            "long-cone/mazak-g062.eia",
            [Edit::Drop("K5.8426", 4)],
            "37: Nurbs: the blocks with K alone are not as many as P",
        ),
    ] {
        let reports: Vec<String> = damaged(file, &edits).iter().map(Violation::to_string).collect();
        assert!(reports.iter().any(|report| report == expected), "{file}: {reports:?}");
    }
}
