//! Small inputs, `fixtures/cases/`, and what becomes of them, each with its right value.
//!
//! | module | what it holds |
//! |---|---|
//! | `bounds` | what is stated of lines, against the distance that is there |
//! | `cl` | CL data: what its statements mean, as it stands in the program of every machine |
//! | `clear` | retractions, which are clear of all that is cut, or refused |
//! | `curves` | curve files: how long their paths are, or why they are refused |
//! | `damaged` | the remarks at which an operator restarts a program, each with every fault |
//! | `generated` | random inputs on random machines, none of which compile refuses by its own proof |
//! | `left` | what a program leaves behind on the control, at tool changes and at its end, and what its remarks are made of |
//! | `lines` | the lines of machine files: read word by word, and where a word of theirs may move an axis |
//! | `nc` | programs of other posts and written by hand: read right, or refused |
//! | `proof` | lengths, times and bounds, and programs that were refused by their own proof |
//! | `starts` | where paths begin, and cuts without length |

mod bounds;
mod cl;
mod clear;
mod curves;
mod damaged;
mod generated;
mod left;
mod lines;
mod nc;
mod proof;
mod starts;

use splinepost::diagnostic::Diagnostics;
use splinepost::machine::Machine;
use splinepost::source::{Source, SourceId, Sources};
use splinepost::verify::{Report, verify};
use splinepost::{Options, Output, compile, front};

/// The text of a case.
fn case(name: &str) -> String {
    let path = crate::support::folder("fixtures/cases").join(name);
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// Compiles an input of any language.
fn compiled(text: &str, machine: &Machine, options: &Options) -> Result<Output, Diagnostics> {
    let sources = Sources::new(Source::new("input", text));
    let language = front::detect(sources.get(SourceId::INPUT).expect("an input"))?;
    compile(&sources, language, machine, options).map_err(|failure| failure.diagnostics)
}

/// Proves a text by its meaning alone: its form may be another.
fn proved(output: &Output, text: &str) -> Result<Report, Diagnostics> {
    let reading = (output.machine.dialect.read)(text, SourceId::INPUT, &output.machine)?;
    verify(&output.intent, &reading.value, text, SourceId::INPUT, &output.machine, output.tolerance)
}
