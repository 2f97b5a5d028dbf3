//! Nothing panics: readers and front ends on texts that nobody meant to write.

use crate::support::{compiled, input, machines};
use proptest::prelude::*;
use splinepost::machine::Machine;
use splinepost::source::{Source, SourceId, Sources};
use splinepost::{Options, compile, front};

/// What numbers should not be, and words where none belong.
const EXTREMES: [&str; 16] = [
    "99999999999999999",
    "999999999",
    "00000000000000000000001",
    "0.000000000000000001",
    "-",
    "1e308",
    "nan",
    "inf",
    "EX-30",
    "E+255",
    "E-255",
    "PL=",
    "K3X",
    "G06.2",
    "[[",
    "\u{fffd}",
];

/// A text with some bytes changed, dropped or doubled.
pub(crate) fn mutated(text: &str, edits: &[(usize, u8, u8)]) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for (place, kind, byte) in edits {
        if bytes.is_empty() {
            break;
        }
        let at = place % bytes.len();
        match kind % 6 {
            5 => {
                let extreme = EXTREMES[usize::from(*byte) % EXTREMES.len()];
                bytes.splice(at..at, extreme.bytes());
            }
            0 => bytes[at] = *byte,
            1 => {
                bytes.remove(at);
            }
            2 => bytes.insert(at, *byte),
            3 => bytes.truncate(at),
            _ => {
                let end = (at + usize::from(*byte)).min(bytes.len());
                let copy = bytes[at..end].to_vec();
                bytes.splice(at..at, copy);
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

pub(crate) fn edits() -> impl Strategy<Value = Vec<(usize, u8, u8)>> {
    // Bytes that mean something are more trying than others.
    let byte = prop_oneof![
        4 => prop::sample::select(b"0123456789.,-+=()[]{}\"'~;%/#\n\r\t XYZAFGKNPRSLCE".to_vec()),
        1 => any::<u8>(),
    ];
    prop::collection::vec((any::<usize>(), any::<u8>(), byte), 1..6)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn readers_survive_any_text(edits in edits()) {
        for machine in machines() {
            for motion in machine.dialect.motions {
                let program = compiled(&input("D1 = 10\nS = 30\nC = 5\nr = 8\nlength = 2", ""), &machine, Some(motion)).unwrap().text;
                let text = mutated(&program, &edits);
                let _ = (machine.dialect.read)(&text, SourceId::INPUT, &machine);
                let _ = (machine.dialect.read)(&mutated("", &edits), SourceId::INPUT, &machine);
            }
        }
    }

    #[test]
    fn cutter_files_survive_any_text(edits in edits()) {
        let text = mutated(&input("D1 = 10\nS = 30\nC = 5\nr = 8\nlength = 2\nflutes = 2", "dl = 0.2\ntolerance = 0.01"), &edits);
        let sources = Sources::new(Source::new("t", text));
        let machine = Machine::built_in("sinumerik").unwrap();
        let language = front::find("cutter").unwrap();
        if let Err(failure) = compile(&sources, language, &machine, &Options::default()) {
            // What is told can be drawn.
            let drawn = failure.diagnostics.render(&sources, false);
            prop_assert!(failure.diagnostics.0.is_empty() || drawn.contains("error"));
            prop_assert!(!failure.diagnostics.0.is_empty(), "a failure without a word");
        }
    }

    #[test]
    fn machine_files_survive_any_text(edits in edits()) {
        for (_, text) in splinepost::machine::BUILT_IN {
            if let Err(errors) = Machine::parse(&mutated(text, &edits), SourceId::INPUT) {
                prop_assert!(errors.has_errors());
            }
        }
    }
}
