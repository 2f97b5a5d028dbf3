//! `fixtures/apt/<case>/`: CL data written by the project, and beside it the program of every dialect's default machine, or of
//! the `<dialect>.machine.toml` there.

use super::{cases, input};
use crate::support::{compare, fail_on, no_number, told};
use splinepost::machine::Machine;
use splinepost::source::{Source, SourceId, Sources};
use splinepost::verify::Status;
use splinepost::{Options, compile, front, verify_program};
use std::collections::BTreeSet;
use std::fs;

#[test]
fn every_case_has_its_programs() {
    let mut wrong = Vec::new();
    for case in cases() {
        let path = input(&case);
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        let mut known = BTreeSet::from([name.clone(), "input.stderr".to_owned()]);
        for (i, dialect) in splinepost::dialect::DIALECTS.iter().enumerate() {
            // A machine file beside the input stands in for the default one.
            let own = format!("{}.machine.toml", dialect.name);
            let machine = match fs::read_to_string(case.join(&own)) {
                Ok(text) => crate::support::machine(&text),
                Err(_) => Machine::built_in(dialect.name).expect("a default machine"),
            };
            known.insert(own);
            let mut sources = Sources::new(Source::decode(name.clone(), fs::read(&path).expect("an input")));
            let language =
                front::detect(sources.get(SourceId::INPUT).expect("the input")).expect("a language");
            assert_eq!(language.name, "apt", "{}", path.display());
            let file = format!("{}.{}", dialect.name, machine.text.extension.to_lowercase());
            known.insert(file.clone());
            let output = match compile(&sources, language, &machine, &Options::default()) {
                Ok(output) => output,
                Err(failure) => {
                    sources.program = failure.program;
                    wrong.push(failure.diagnostics.render(&sources, false));
                    continue;
                }
            };
            compare(&case.join(&file), &output.text, &mut wrong);
            for text in [&output.text, &told(&output)] {
                assert_eq!(no_number(text), None, "{file}: {text}");
            }
            let report = output.report.expect("a proof");
            assert_eq!(report.status, Status::Proved, "{file}");
            assert!(report.deviation.mm <= output.tolerance, "{file}: {:?}", report.deviation);
            if i == 0 {
                compare(
                    &case.join("input.stderr"),
                    &output.intent.warnings.render(&sources, false),
                    &mut wrong,
                );
            }
            // The same parser serves `verify`.
            let id = sources.push(Source::new("program", output.text));
            if let Err(errors) = verify_program(&sources, language, id, &machine, &Options::default()) {
                wrong.push(format!("{}/{file}\n{}", case.display(), errors.render(&sources, false)));
            }
        }
        for entry in fs::read_dir(&case).expect("a case").flatten() {
            let name = entry.file_name().to_string_lossy().into_owned();
            if !known.contains(&name) {
                wrong.push(format!("{}/{name} belongs to no machine", case.display()));
            }
        }
    }
    assert!(5 < cases().len(), "there are no cases");
    fail_on(&wrong);
}
