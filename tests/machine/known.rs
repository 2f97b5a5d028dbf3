//! What golden programs are known to break, with the reason. The list only shrinks: an entry that nothing breaks fails.

use super::words::Dialect;
use super::{Golden, Job, Rule, Violation, check, goldens};

/// A rule that programs of a dialect break, and how the report begins.
const KNOWN: &[(Dialect, Rule, &str)] = &[
    // G43.5 stands in the block of its first move.
    (Dialect::Mazak, Rule::Length, "tip control is called without a move"),
    // The tool is upright again before a program of five axes ends.
    (Dialect::Sinumerik, Rule::Upright, "the tool is left tilted by its direction"),
    (Dialect::Heidenhain, Rule::Upright, "the tool is left tilted by its direction"),
    (Dialect::Mazak, Rule::Upright, "the tool is left tilted by its direction"),
];

fn is(entry: &(Dialect, Rule, &str), job: &Job, violation: &Violation) -> bool {
    let (dialect, rule, what) = entry;
    *dialect == job.dialect && *rule == violation.rule && violation.what.starts_with(what)
}

/// The violations that are not known.
pub(super) fn without(job: &Job, mut violations: Vec<Violation>) -> Vec<Violation> {
    violations.retain(|violation| !KNOWN.iter().any(|entry| is(entry, job, violation)));
    violations
}

#[test]
fn what_is_known_is_broken() {
    let all: Vec<(Job, Vec<Violation>)> =
        goldens().into_iter().map(|Golden { job, text, .. }| (job.clone(), check(&job, &text))).collect();
    for entry in KNOWN {
        let broken =
            all.iter().any(|(job, violations)| violations.iter().any(|violation| is(entry, job, violation)));
        assert!(broken, "nothing breaks this any more: take it out: {entry:?}");
    }
}
