//! What a program states beside its moves, and what another machine's program would have of it.

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::dialect::stated::Stated;
use crate::machine::Machine;

/// The work offset that programs count from where nothing else is said.
const USUAL_OFFSET: &str = "G54";

/// Refuses words of how exactly the control runs: the other control has others, and its program would run without.
///
/// # Errors
/// There is one.
pub(super) fn is_translated(stated: &Stated) -> Result<(), Diagnostics> {
    let mut errors = Diagnostics::new();
    for running in &stated.running {
        let message = format!(
            "`{}` says how exactly the control runs, and the other machine's program would not",
            running.word
        );
        errors.push(Diagnostic::error("running-lost", message).at(running.span, "").hint(
            "leave it out here, and state what the other control has for it in the header of its machine file",
        ));
    }
    if errors.0.is_empty() { Ok(()) } else { Err(errors) }
}

/// Whether the lines of the machine `to` state the work offset that a program has of its own.
///
/// # Errors
/// They state another one, or none.
pub(super) fn keeps_offset(stated: &Stated, to: &Machine) -> Result<(), Diagnostics> {
    let Some(offset) = stated.offset.as_ref().filter(|offset| !offset.fixed) else { return Ok(()) };
    let words = to.frame.header.iter().flat_map(|line| line.0.split_ascii_whitespace());
    let own: Vec<&str> = words.filter(|word| *word == offset.word).collect();
    // A control without such words has its preset.
    let has_words = to.dialect.replaces_shift.is_some() || to.dialect.least_increments;
    if !own.is_empty() || (offset.word == USUAL_OFFSET && !has_words) {
        return Ok(());
    }
    let message = format!(
        "the program counts from {}, and the lines of machine `{}` do not say so",
        offset.word, to.name
    );
    Err(Diagnostic::error("work-offset", message)
        .at(offset.span, "")
        .hint(format!("put {} into [program] header of that machine file", offset.word))
        .into())
}
