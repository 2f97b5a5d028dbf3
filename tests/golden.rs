//! `fixtures/compile/<case>/`: an input and the program of every machine, side by side, compared as bytes; and
//! `fixtures/curves/<case>/`, where the input names a curve file with arcs.
//!
//! The machines are the default one of each dialect and every `<name>.machine.toml` in the folder; the outputs are
//! called after them. A missing or a stray file fails.

use crate::support::{
    compare, compiled, compiled_from, fail_on, folder, machine, no_number, sources_in, told,
};
use splinepost::machine::Machine;
use std::collections::BTreeSet;
use std::fs;

#[test]
fn every_case_has_its_programs() {
    let mut wrong = Vec::new();
    let mut cases = 0;
    let under = |name: &str| fs::read_dir(folder(name)).unwrap_or_else(|e| panic!("{name}: {e}"));
    for case in under("fixtures/compile").chain(under("fixtures/curves")).flatten() {
        cases += 1;
        let case = case.path();
        let input = fs::read_to_string(case.join("input.toml")).expect("input.toml");
        let mut machines: Vec<(String, Machine)> = splinepost::dialect::DIALECTS
            .iter()
            .map(|dialect| {
                (dialect.name.to_owned(), Machine::built_in(dialect.name).expect("a default machine"))
            })
            .collect();
        let names: Vec<String> = fs::read_dir(&case)
            .expect("a case")
            .flatten()
            .map(|e| e.file_name().to_string_lossy().into_owned())
            .collect();
        for name in names.iter().filter_map(|name| name.strip_suffix(".machine.toml")) {
            let text = fs::read_to_string(case.join(format!("{name}.machine.toml"))).expect("a machine file");
            machines.push((name.to_owned(), machine(&text)));
        }
        let sources = sources_in("input.toml", &input, &case);
        let mut known: BTreeSet<String> = sources.paths().map(ToOwned::to_owned).collect();
        for (name, machine) in &machines {
            let file = format!("{name}.{}", machine.text.extension.to_lowercase());
            match compiled_from(&sources, machine, None) {
                Ok(output) => {
                    compare(&case.join(&file), &output.text, &mut wrong);
                    for text in [&output.text, &told(&output)] {
                        assert_eq!(no_number(text), None, "{file}: {text}");
                    }
                }
                Err(error) => wrong.push(format!("{}/{file}: {error:?}", case.display())),
            }
            known.insert(file);
            known.insert(format!("{name}.machine.toml"));
        }
        for name in names.iter().filter(|name| !known.contains(*name)) {
            wrong.push(format!("{}/{name} belongs to no machine", case.display()));
        }
    }
    assert!(0 < cases, "there is no case");
    fail_on(&wrong);
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    let input = fs::read_to_string(folder("fixtures/compile/conical-mill/input.toml")).expect("input.toml");
    for dialect in splinepost::dialect::DIALECTS {
        let machine = Machine::built_in(dialect.name).expect("a default machine");
        for motion in dialect.motions {
            let text = || compiled(&input, &machine, Some(motion)).expect("it compiles").text;
            assert_eq!(text(), text(), "{} {}", dialect.name, motion.name);
        }
    }
}
