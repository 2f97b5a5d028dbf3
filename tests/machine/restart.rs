//! Every section alone, as an operator restarts: the lines before the first section, then this one.
//!
//! Nothing else is in force then, and no axis is anywhere. The moves must be those of the whole program, so that each
//! modal word that matters has to stand in the section again.

use super::run::run;
use super::state::Move;
use super::words::{Block, Motion};
use super::{Job, Rule, Violation};

/// Compares each section alone with the whole program.
pub(super) fn check(job: &Job, blocks: &[Block], whole: &[Move]) -> Vec<Violation> {
    let sections = sections(blocks);
    // Nothing of what stands before the first section is a section: it is run before each of them.
    let first = 1.min(sections.len());
    let (before, moving) = sections.split_at(first);
    let before: Vec<Block> = before.concat();
    let mut violations = Vec::new();
    for (section, blocks) in (first..).zip(moving) {
        let expected: Vec<&Move> = whole.iter().filter(|step| step.section == section).collect();
        let program = [before.as_slice(), blocks.as_slice()].concat();
        let mut alone = run(job, &program).moves;
        alone.retain(|step| step.section == first);
        let found = expected.iter().zip(&alone).find_map(|(expected, alone)| {
            Some(expected.violation(Rule::Restart, difference(expected, alone)?))
        });
        let named = expected.first().filter(|step| !step.opens);
        let found = found.or_else(|| {
            Some(named?.violation(Rule::Restart, "the section does not begin with a word of motion"))
        });
        let missing = || {
            let step = expected.first().filter(|_| expected.len() != alone.len())?;
            Some(step.violation(Rule::Restart, "there are other moves"))
        };
        violations.extend(found.or_else(missing));
    }
    violations
}

/// What stands before the first section, and from each of their remarks to the next.
fn sections(blocks: &[Block]) -> Vec<Vec<Block>> {
    let mut sections = vec![Vec::new()];
    for block in blocks {
        if block.section.is_some() {
            sections.push(Vec::new());
        }
        sections.last_mut().expect("one is there from the start").push(block.clone());
    }
    sections
}

/// Whether it does not matter where a move comes from.
fn place_is_free(step: &Move) -> bool {
    step.modal.motion == Some(Motion::Rapid)
}

/// The first thing in which a move differs.
fn difference(expected: &Move, alone: &Move) -> Option<String> {
    let (was, is) = (&expected.modal, &alone.modal);
    let modal: [(&str, bool); 13] = [
        ("motion", was.motion == is.motion),
        ("feed", was.feed == is.feed),
        ("kind of feed", was.timed == is.timed),
        ("tool", (was.tool, was.changed) == (is.tool, is.changed)),
        ("tool length", was.length == is.length),
        ("spindle", (was.speed, was.turns) == (is.speed, is.turns)),
        ("coolant", was.coolant == is.coolant),
        ("work offset", was.zeros == is.zeros),
        ("UPATH", was.upath == is.upath),
        ("SPLINEPATH", was.spline_path == is.spline_path),
        ("FGROUP", was.group == is.group),
        ("end condition", was.ends == is.ends),
        ("degree", was.degree == is.degree),
    ];
    if let Some((what, _)) = modal.iter().find(|(_, same)| !same) {
        return Some(format!("the {what} is not written again"));
    }
    if was.states != is.states {
        let lost: Vec<String> =
            was.states.symmetric_difference(&is.states).map(|state| format!("{state:?}")).collect();
        return Some(format!("{} is not written again", lost.join(", ")));
    }
    assert_eq!(was, is, "something modal is not compared");
    // A rapid moves one axis and says where to; where it comes from does not matter.
    let place = place_is_free(expected) || expected.from == alone.from;
    if !place {
        return Some("an axis is not positioned again".to_owned());
    }
    let same = expected.line == alone.line
        && expected.opens == alone.opens
        && expected.targets == alone.targets
        && (place_is_free(expected) || expected.by == alone.by)
        && expected.factors == alone.factors
        && (expected.knot, expected.weight, expected.order) == (alone.knot, alone.weight, alone.order);
    (!same).then(|| "there are other moves".to_owned())
}
