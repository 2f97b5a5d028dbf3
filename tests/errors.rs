//! `fixtures/errors/<name>.toml`: a bad input, and beside it in `<name>.stderr` what a user is told.

use crate::support::{compare, fail_on, folder};
use splinepost::machine::Machine;
use splinepost::source::{Source, Sources};
use splinepost::{Options, compile, front};
use std::fs;

#[test]
fn bad_inputs_are_told_of() {
    let mut wrong = Vec::new();
    let machine = Machine::built_in("sinumerik").expect("a machine");
    let mut paths: Vec<_> = fs::read_dir(folder("fixtures/errors"))
        .expect("fixtures/errors")
        .flatten()
        .map(|e| e.path())
        .collect();
    paths.sort();
    let mut cases = 0;
    for path in &paths {
        if path.extension().is_some_and(|e| e == "stderr") {
            if !path.with_extension("toml").exists() {
                wrong.push(format!("{} has no input", path.display()));
            }
            continue;
        }
        cases += 1;
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        let source = Source::new(name, fs::read_to_string(path).expect("UTF-8"));
        let language = front::detect(&source).expect("a language");
        let mut sources = Sources::new(source);
        match compile(&sources, language, &machine, &Options::default()) {
            Ok(_) => wrong.push(format!("{} compiles", path.display())),
            Err(failure) => {
                sources.program = failure.program;
                compare(
                    &path.with_extension("stderr"),
                    &failure.diagnostics.render(&sources, false),
                    &mut wrong,
                );
            }
        }
    }
    assert!(0 < cases, "there is no case");
    fail_on(&wrong);
}
