//! What a program is called and what its remarks say: a number where the control wants one, letters that it takes.

use crate::diagnostic::Diagnostic;
use crate::ir::{Intent, Step};
use crate::machine::Machine;
use crate::machine::remark::taken;
use crate::machine::template::Template;

/// The number of a program that nobody chose one for.
const NUMBER: u32 = 1;

/// Gives the program a number, where the control wants one and nobody chose it. On the control it replaces the program that has
/// this number.
pub(super) fn number(intent: &mut Intent, machine: &Machine) {
    if intent.program.number != 0 || !machine.has_number() {
        return;
    }
    intent.program.number = NUMBER;
    intent.warnings.push(
        Diagnostic::warning(
            "number-unchosen",
            format!("nobody chose the program's number, and it is O{NUMBER:04}: on the control it takes the place of another of this number"),
        )
        .hint("--number 1234 chooses one, and so does number = 1234 at the head of a cutter file or a job"),
    );
}

/// Writes the name in letters that the control takes, where it stands in remarks alone.
pub(super) fn name(intent: &mut Intent, machine: &Machine) {
    let frame = &machine.frame;
    let mut lines = frame.header.iter().chain(&frame.footer).chain(&frame.close);
    let code =
        |line: &Template| !line.0.starts_with(['(', ';']) && line.variables().any(|name| name == "name");
    if !lines.any(code) && !machine.dialect.file_names {
        intent.program.name = taken(&intent.program.name, &machine.text);
    }
}

/// Writes the remarks in letters that the control takes.
pub(super) fn remarks(intent: &mut Intent, machine: &Machine) {
    for located in &mut intent.program.steps {
        if let Step::Comment(text) = &mut located.step {
            *text = taken(text, &machine.text);
        }
    }
}
