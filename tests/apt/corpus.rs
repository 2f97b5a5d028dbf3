//! Real files of CAM systems, where they are there: the folder that `SPLINEPOST_CORPUS` names, or `../shared/corpus`.

use crate::support::folder;
use splinepost::diagnostic::Severity;
use splinepost::source::{Source, SourceId, Sources};
use splinepost::verify::Status;
use splinepost::{Options, compile, front};
use std::path::PathBuf;

/// Each file, and why it is refused where it is.
const FILES: &[(&str, Option<&str>)] = &[
    ("catia/demo1.aptsource", Some("turning")), // TOOLNO/1,TURN
    ("catia/demo2.aptsource", Some("cycle")),   // CYCLE/TAP: the spindle must follow the feed
    ("catia/demo4.aptsource", None),
    ("catia/demo5.aptsource", Some("turning")),
    ("creo/bohren_1.ncl.8", None),
    ("creo/profilfraesen_2.ncl.1", None),
    ("creo/schruppen_1.ncl.1", None),
];

fn corpus() -> Option<PathBuf> {
    let named = std::env::var_os("SPLINEPOST_CORPUS").map(PathBuf::from);
    named.or_else(|| Some(folder("../shared/corpus"))).filter(|path| path.is_dir())
}

#[test]
fn real_files_compile_and_verify_or_say_why_not() {
    let Some(corpus) = corpus() else {
        eprintln!("skipped: no corpus of CL data; SPLINEPOST_CORPUS names a folder with one");
        return;
    };
    for (name, refused) in FILES {
        let bytes = std::fs::read(corpus.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"));
        for dialect in splinepost::dialect::DIALECTS {
            let machine = crate::support::five(dialect.name);
            let sources = Sources::new(Source::decode(*name, bytes.clone()));
            let language =
                front::detect(sources.get(SourceId::INPUT).expect("the input")).expect("a language");
            assert_eq!(language.name, "apt", "{name}");
            match (compile(&sources, language, &machine, &Options::default()), refused) {
                (Ok(output), None) => {
                    let report = output.report.expect("a proof");
                    assert_eq!(report.status, Status::Proved, "{name}");
                    assert!(report.deviation.mm <= output.tolerance, "{name}: {:?}", report.deviation);
                }
                (Err(failure), Some(id)) => {
                    let stops = failure.diagnostics.0.iter().filter(|d| Severity::Refusal <= d.severity);
                    let ids: Vec<&str> = stops.map(|d| d.id).collect();
                    assert_eq!(ids, [*id], "{name}: {:?}", failure.diagnostics);
                }
                (Ok(_), Some(id)) => panic!("{name} compiles for {} in spite of {id}", dialect.name),
                (Err(failure), None) => {
                    panic!("{name} for {}:\n{}", dialect.name, failure.diagnostics.render(&sources, false))
                }
            }
        }
    }
}
