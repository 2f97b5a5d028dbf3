//! What the lines of a machine file say to an ISO control, read word by word.
//!
//! Three words of such lines may move an axis by themselves, and a line is refused where they would:
//!
//! | word | what it may do | where it may stand |
//! |---|---|---|
//! | `G43 H`, alone | moves Z by the length of the tool | last in `tool` or `tool_spindle`; it is written into the first block of Z |
//! | `G49`, `G43 H0` | moves Z back by that length, where a parameter says so | `length_end` and `tip_control_end`, at the park place |
//! | `G28`, `G30` | goes home by way of the place that stands there | under `G91`, by way of no place |

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::machine::Machine;
use crate::machine::line::{Word, words};
use crate::machine::template::Template;

/// What is wrong with some lines, and the way out.
type Wrong = (String, &'static str);

/// The register of a tool's length that these lines call, as what stands behind H: `{register}`, `2{register}`. None where they call none.
pub(super) fn register(lines: &[Template]) -> Result<Option<Template>, Wrong> {
    let mut register = None;
    for (i, line) in lines.iter().enumerate() {
        let all = words(&line.0);
        let is = |code: &str| all.iter().any(|word| word.is(code));
        if is("G44") {
            return Err((
                format!("`{}` takes the length of the tool the other way", line.0),
                "the length is called by G43",
            ));
        }
        if is("G43.4") || is("G43.5") {
            let hint = "put it under tip_control";
            return Err((format!("`{}` begins tool centre point control with every tool", line.0), hint));
        }
        let length = all.iter().find(|word| word.address == "H");
        let Some(length) = length.filter(|_| is("G43")) else {
            if is("G43") || length.is_some() {
                return Err((
                    format!("`{}` calls a length by G43 or by H alone", line.0),
                    "write G43 H{register}",
                ));
            }
            continue;
        };
        if let Some(other) = all.iter().find(|word| !word.is("G43") && word.address != "H") {
            let message = format!("`{}{}` stands beside the call of the length", other.address, other.text());
            return Err((
                message,
                "give G43 H{register} a line of its own: it is written into the first block of Z",
            ));
        }
        if !length.has("tool") && !length.has("register") {
            let message = format!("H{} is the length of one tool, whatever tool is called", length.text());
            return Err((message, "write H{register}, or H2{register} where registers are numbered so"));
        }
        if i + 1 != lines.len() || i == 0 {
            let message = format!("`{}` does not stand behind the lines that call the tool", line.0);
            return Err((message, "put it last: it is written into the first block of Z"));
        }
        register = Some(Template(length.text()));
    }
    Ok(register)
}

/// Whether a line ends the length of a tool.
fn ends_length(line: &Template, machine: &Machine) -> bool {
    let all = words(&line.0);
    let zero = |word: &Word| word.address == "H" && word.number() == Some(0.0);
    all.iter().any(|word| machine.dialect.ends_length.iter().any(|code| word.is(code)))
        || (all.iter().any(|word| word.is("G43")) && all.iter().any(zero))
}

/// What is wrong with the lines of a machine file.
pub(super) fn check(machine: &Machine) -> Diagnostics {
    let frame = &machine.frame;
    let mut diagnostics = Diagnostics::new();
    let mut wrong =
        |id, message: String, hint: &str| diagnostics.push(Diagnostic::error(id, message).hint(hint));
    for (key, lines) in frame.lists() {
        let calls = key == "tool" || key == "tool_spindle";
        if calls && let Err((message, hint)) = register(lines) {
            wrong("length-call", format!("in {key} {message}"), hint);
        }
        let own = key == "length_end" || key == "tip_control_end";
        for line in lines {
            let all = words(&line.0);
            let is = |code: &str| all.iter().any(|word| word.is(code));
            if frame.length_end_moves && !own && ends_length(line, machine) {
                let message = format!(
                    "`{}` in {key} may move Z by the length of the tool, wherever the tool is",
                    line.0
                );
                let hint = "leave it out, the next G43 replaces the length: length_end ends it where [axis.X] home and [axis.Y] home \
                            are stated; length_end_moves = false says that it moves nothing";
                wrong("length-end", message, hint);
            } else if !calls && (is("G43") || is("G44")) {
                let message = format!("`{}` in {key} may move Z by the length of the tool", line.0);
                wrong(
                    "length-call",
                    message,
                    "put G43 H{register} last under tool: it is written into the first block of Z",
                );
            }
        }
        through_the_work(key, lines, machine, &mut wrong);
    }
    diagnostics
}

/// `G28 Z0.` under G90 goes home by way of Z 0 of the work.
fn through_the_work(
    key: &str,
    lines: &[Template],
    machine: &Machine,
    wrong: &mut impl FnMut(&'static str, String, &str),
) {
    let mut incremental = false;
    for line in lines {
        let all = words(&line.0);
        for word in &all {
            incremental = word.is("G91") || (incremental && !word.is("G90"));
        }
        if !all.iter().any(|word| word.is("G28") || word.is("G30")) {
            continue;
        }
        if !incremental {
            let message = format!("`{}` in {key} goes home by way of that place of the work", line.0);
            wrong("home-way", message, "write G91 in the line, and G90 in the next");
        }
        let away = |axis: &crate::units::Axis| machine.limits(*axis).home.is_some_and(|home| home != 0.0);
        let moves = |word: &Word| {
            let letter = "XYZABCUVW".contains(&word.address) && !word.address.is_empty();
            letter && word.number().is_some_and(|number| number != 0.0)
        };
        let filled = all.iter().any(|word| word.has("home")) && machine.declared.iter().any(away);
        if filled || all.iter().any(moves) {
            let message = format!("`{}` in {key} moves by a way before it goes home", line.0);
            wrong(
                "home-way",
                message,
                "write `G91 G28 Z0.`, or `G53 {home}`: behind G28 the number is a way, not a place",
            );
        }
    }
}
