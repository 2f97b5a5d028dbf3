//! CL data: from the text of a CAM system to programs that are proved.
//!
//! | module | what it holds |
//! |---|---|
//! | `golden` | `fixtures/apt/<case>/`: an input and every machine's program, side by side, as bytes |
//! | `statements` | every statement of the language: read, warned or refused |
//! | `arcs` | arcs and helices of every plane, evaluated from the text; damaged ones |
//! | `circles` | what stands behind a circle, between it and its end, and beside a start tangent |
//! | `meaning` | arcs, cycles, feeds and units by their closed forms |
//! | `orientation` | five axes: tip and direction, second curves, damage |
//! | `planes` | 3+2 axes: tilted planes, counted back from the text; damage |
//! | `splines` | the NURBS forms of CATIA, NX and Creo |
//! | `bad` | input that is none, and what is told |
//! | `corpus` | real files of CAM systems, where they are there |

mod arcs;
mod bad;
mod circles;
mod corpus;
mod golden;
mod meaning;
mod orientation;
mod planes;
mod splines;
mod statements;

use crate::support::{folder, machine};
use splinepost::diagnostic::Diagnostics;
use splinepost::ir::Intent;
use splinepost::machine::Machine;
use splinepost::source::{Source, SourceId, Sources};
use splinepost::{Options, Output, compile, front, verify_program};
use std::fs;
use std::path::PathBuf;

/// Proves a program against CL data.
fn verified(input: &str, text: &str, machine: &Machine) -> Result<(), Diagnostics> {
    let mut sources = Sources::new(Source::new("input.cl", input));
    let id = sources.push(Source::new("program", text));
    let language = front::detect(sources.get(SourceId::INPUT).expect("the input")).expect("a language");
    verify_program(&sources, language, id, machine, &Options::default()).map(|_| ())
}

/// The inputs under `fixtures/apt`, by their paths.
fn cases() -> Vec<PathBuf> {
    let mut cases: Vec<PathBuf> = fs::read_dir(folder("fixtures/apt"))
        .expect("fixtures/apt")
        .flatten()
        .map(|entry| entry.path())
        .collect();
    cases.sort();
    cases
}

/// The input of a case.
fn input(case: &std::path::Path) -> PathBuf {
    let mut inputs = fs::read_dir(case)
        .expect("a case")
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| path.file_stem().is_some_and(|stem| stem == "input"))
        .filter(|path| path.extension().is_some_and(|extension| extension != "stderr"));
    let input = inputs.next().unwrap_or_else(|| panic!("{} has no input", case.display()));
    assert!(inputs.next().is_none(), "{} has two inputs", case.display());
    input
}

/// The inputs under `fixtures/apt` and their texts.
pub(crate) fn inputs() -> Vec<(String, String)> {
    cases()
        .iter()
        .map(|case| {
            let source = Source::decode(case.display().to_string(), fs::read(input(case)).expect("an input"));
            (source.name, source.text)
        })
        .collect()
}

/// A text with its `$` gone: lines that go on are one.
pub(crate) fn joined(text: &str) -> String {
    let mut out = String::new();
    let mut pointed = false;
    for line in text.lines() {
        let remark = line.trim_start().starts_with("$$");
        pointed = (remark && line.trim_start()[2..].trim_start().starts_with("->")) || (pointed && !remark);
        match line.split_once('$').filter(|_| !remark || pointed) {
            Some((code, _)) if !remark => out.push_str(code),
            Some(_) if line.trim_end().ends_with('$') => out.push_str(line.trim_end().trim_end_matches('$')),
            _ => {
                out.push_str(line);
                out.push('\n');
                pointed = false;
            }
        }
    }
    out
}

/// What CL data asks for.
fn intent_as(language: &str, text: &str, lenient: bool) -> Result<Intent, Diagnostics> {
    let mut sources = Sources::new(Source::new("input.cl", text));
    sources.lenient = lenient;
    (front::find(language).expect("a language").parse)(&sources)
}

/// The program of CL data.
fn program(language: &str, text: &str, machine: &Machine) -> Result<Output, Diagnostics> {
    let sources = Sources::new(Source::new("input.cl", text));
    let language = front::find(language).expect("a language");
    compile(&sources, language, machine, &Options::default()).map_err(|failure| failure.diagnostics)
}
