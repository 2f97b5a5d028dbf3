//! `fixtures/errors/<name>.toml`: a bad input, perhaps with a bad curve file that it names, and beside it in
//! `<name>.stderr` what a user is told.

use crate::support::{compare, fail_on, folder, sources_in};
use splinepost::machine::Machine;
use splinepost::source::Source;
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
        if front::curves::format_of(&path.display().to_string()).is_some() {
            if !path.with_extension("toml").exists() {
                wrong.push(format!("{} is named by no input", path.display()));
            }
            continue;
        }
        cases += 1;
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        let text = fs::read_to_string(path).expect("UTF-8");
        let language = front::detect(&Source::new(name.as_str(), text.as_str())).expect("a language");
        let mut sources = sources_in(&name, &text, path.parent().expect("a folder"));
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
