//! What CL data means, by closed forms.

use super::{intent_as, program};
use splinepost::ir::{Curve, Intent, Step};
use splinepost::machine::Machine;
use splinepost::source::{Source, Sources};
use splinepost::{Options, compile, front};

const START: &str = "LOADTL/1\nSPINDL/500,CLW\nFEDRAT/100,MMPM\nRAPID\nGOTO/0,0,10\nGOTO/0,0,0\n";

fn intent(system: &str, body: &str) -> Intent {
    intent_as(system, &format!("{START}{body}\nFINI\n"), false)
        .unwrap_or_else(|errors| panic!("{body}: {errors:?}"))
}

/// The curves of the cuts.
fn curves(intent: &Intent) -> Vec<&Curve> {
    intent.program.steps.iter().filter_map(|located| Some(&located.step.cut()?.curve)).collect()
}

/// One arc in the spellings of all systems is one arc.
#[test]
fn all_spellings_of_an_arc_are_one() {
    let spelled = [
        ("creo", "CIRCLE/5,0,0,0,0,1,5\nGOTO/5,5,0"),
        ("creo", "CIRCLE / 5.0, 0.0, 0.0,  $\n0.0, 0.0, 1.0,  5.0\nGOTO/5,5,0"),
        ("solidworks", "CIRCLE/5,0,0,0,0,1\nGOTO/5,5,0"),
        ("nx", "CIRCLE/5,0,0,0,0,-1,5,.06,.5,10,0\nGOTO/5,5,0"),
        ("fusion", "MOVARC/5,0,0,0,0,1,5,ANGLE,270\nGOTO/5,5,0"),
        ("catia", "INDIRV/0,-1,0\nTLON,GOFWD/(CIRCLE/5,0,0,5),ON,(LINE/5,0,0,5,9,0)"),
        (
            "catia",
            "INDIRV/0,-1,0\nTLON,GOFWD/(CYLNDR/5,0,0,0,0,1,5),ON,(PLANE/PERPTO,(PLANE/(POINT/5,0,0),PERPTO,\
             (VECTOR/0,0,1)),(POINT/5,0,0),(POINT/5,5,0))",
        ),
    ];
    let reference = intent("creo", spelled[0].1);
    let [_, Curve::Arc(arc)] = curves(&reference)[..] else { panic!("{reference:?}") };
    // Three quarters of a circle about (5, 0), counter-clockwise.
    assert!((arc.sweep() - 1.5 * std::f64::consts::PI).abs() < 1e-12 && arc.center() == [5.0, 0.0]);
    for (system, text) in spelled {
        let found = intent(system, text);
        let [_, Curve::Arc(other)] = curves(&found)[..] else { panic!("{system}: {found:?}") };
        assert!(
            (other.sweep() - arc.sweep()).abs() < 1e-12 && other.end() == arc.end(),
            "{system}: {other:?}"
        );
    }
}

#[test]
fn a_sweep_of_several_turns_is_several_turns() {
    let found = intent("fusion", "MOVARC/5,0,0,0,0,1,5,ANGLE,810\nGOTO/5,-5,-9");
    let arcs: Vec<_> = curves(&found)
        .into_iter()
        .filter_map(|curve| match curve {
            Curve::Arc(arc) => Some(arc),
            Curve::Lines(_)
            | Curve::Polynomial(_)
            | Curve::Nurbs(_)
            | Curve::Formula(_)
            | Curve::Through(..)
            | Curve::Logarithmic(_) => None,
        })
        .collect();
    let [arc] = arcs[..] else { panic!("{arcs:?}") };
    assert_eq!(arc.turns(), 2.25);
    // 810° = 2 turns and a quarter over 9 mm: 4 mm a turn. Each part starts and ends over the start, to the last bit.
    let parts = arc.by_turns(1);
    let heights: Vec<f64> = parts.iter().map(|arc| arc.end()[2]).collect();
    assert_eq!(heights, [-4.0, -8.0, -9.0]);
    assert!(parts[0].is_full() && parts[1].is_full() && !parts[2].is_full());
    assert_eq!(parts[1].start()[..2], parts[1].end()[..2]);
}

#[test]
fn an_end_that_was_rounded_makes_no_other_turn() {
    for end in ["GOTO/0,0.000001,0", "GOTO/0,-0.000001,0", "GOTO/0,0,0"] {
        let found = intent("creo", &format!("CIRCLE/5,0,0,0,0,1,5\n{end}"));
        let [_, Curve::Arc(arc)] = curves(&found)[..] else { panic!("{found:?}") };
        assert!(arc.is_full(), "{end}");
    }
    // An arc shorter than the control's decimals is a line there, not a turn.
    let text = format!(
        "PARTNO TINY\n{START}GOTO/10,0,0\nCIRCLE/9.97,0,0,0,0,1,0.03\nGOTO/9.99999994,0.00006,0\nGOTO/0,9,0\nFINI\n"
    );
    for dialect in splinepost::dialect::DIALECTS {
        let machine = crate::support::five(dialect.name);
        let output = program("creo", &text, &machine).unwrap_or_else(|e| panic!("{}: {e:?}", dialect.name));
        assert!(output.report.expect("a proof").deviation.mm < 2e-4, "{}", dialect.name);
    }
}

/// Lines beside arcs know which way round they go.
#[test]
fn a_file_that_contradicts_its_system_is_told() {
    let mut lines = vec!["GOTO/10,0,0\n".to_owned()];
    for i in 0..4 {
        // To the right along y = 10 i, then a half turn to the left, up to y = 10 i + 10, and back.
        let y = 10 * i;
        let (half, end) = (y + 5, y + 10);
        lines.push(format!("GOTO/0,{y},0\nGOTO/10,{y},0\nCIRCLE/10,{half},0,0,0,1,5\nGOTO/10,{end},0\n"));
    }
    let body = lines.concat();
    assert!(intent("creo", &body).warnings.0.is_empty());
    let errors = intent_as("nx", &format!("{START}{body}\nFINI\n"), false).expect_err("the other way round");
    assert_eq!(errors.0.len(), 1);
    assert_eq!(errors.0[0].id, "arc-sense");
    assert!(errors.0[0].hints[0].contains("circle = \"right-hand\""), "{errors:?}");
}

#[test]
fn a_shops_words_are_read() {
    let text =
        format!("{START}MYFEED/250\nGOTO/1,0,0\nCYCLE/DRILL,3.0,1.5\nGOTO/5,5,0\nCYCLE/OFF\nFROBNI/1\n");
    let table = "extends = \"catia\"\n[words]\nMYFEED = \"fedrat\"\nFROBNI = \"left-out\"\n[cycles]\nDRILL = [\"DEPTH\", \"CLEAR\"]\n";
    let mut sources = Sources::new(Source::new("input.cl", text));
    let id = sources.push(Source::new("shop.toml", table));
    sources.words = Some(id);
    let machine = Machine::built_in("mazak").expect("mazak");
    let language = front::find("catia").expect("catia");
    let output =
        compile(&sources, language, &machine, &Options::default()).unwrap_or_else(|f| panic!("{f:?}"));
    // 3 deep, from 1.5 above.
    assert!(
        output.text.contains("G0 G43 H1 X1. Y0. Z1.5\nX5. Y5.\nG1 Z-3. F250.\nG0 Z1.5\n"),
        "{}",
        output.text
    );
    assert!(
        output.text.contains("G1 X1. Y0. Z0. F250.") || output.text.contains("X1. F250."),
        "{}",
        output.text
    );
    sources.words = Some(sources.push(Source::new("bad.toml", "[words]\nA = \"fedrad\"\n")));
    let failure = compile(&sources, language, &machine, &Options::default()).expect_err("a wrong table");
    assert!(failure.diagnostics.render(&sources, false).contains("bad.toml:2"), "{failure:?}");
}

#[test]
fn a_rapid_is_one_shot_and_the_feed_returns() {
    let found = intent("iso", "RAPID\nGOTO/1,0,0\nGOTO/2,0,0\nGOTO/3,0,0");
    let steps: Vec<bool> =
        found.program.steps.iter().map(|located| matches!(located.step, Step::Rapid(_))).collect();
    assert_eq!(steps.iter().filter(|rapid| **rapid).count(), 2);
    let Some(Curve::Lines(line)) = curves(&found).last().copied() else { panic!() };
    // Each point knows its line of the file.
    assert_eq!((line.count(), &line.lines[..]), (2, &[9, 10][..]));
}

/// Every number of an arc block, changed in its last place but one, is found.
#[test]
fn a_damaged_arc_is_refused() {
    let text = format!("PARTNO ARC\n{START}CIRCLE/5,0,0,0,0,1,5\nGOTO/5,5,0\nGOTO/9,9,9\nFINI\n");
    for dialect in splinepost::dialect::DIALECTS {
        let machine = crate::support::five(dialect.name);
        let output = program("creo", &text, &machine).unwrap_or_else(|e| panic!("{}: {e:?}", dialect.name));
        let is_arc = |line: &str| line.contains(" I5") || line.contains("CC ") || line.contains(" C X");
        let arcs: Vec<&str> = output.text.lines().filter(|line| is_arc(line)).collect();
        assert_eq!(arcs.len(), if dialect.name == "heidenhain" { 2 } else { 1 }, "{}", output.text);
        let mut tried = 0;
        for arc in arcs {
            for (from, to) in [
                ("X5", "X5.01"),
                ("X+5", "X+5.01"),
                ("Y5", "Y5.01"),
                ("Y+5", "Y+5.01"),
                ("Y+0", "Y+0.01"),
                ("I5", "I5.01"),
                ("J0", "J0.01"),
                ("G3", "G2"),
                ("DR+", "DR-"),
                ("I5", "J5"),
                ("G17", "G18"),
            ] {
                if !arc.contains(from) {
                    continue;
                }
                tried += 1;
                let damaged = output.text.replacen(arc, &arc.replacen(from, to, 1), 1);
                let mut sources = Sources::new(Source::new("input.cl", text.clone()));
                let id = sources.push(Source::new("program", damaged));
                let language = front::find("creo").expect("creo");
                let verified =
                    splinepost::verify_program(&sources, language, id, &machine, &Options::default());
                assert!(verified.is_err(), "{}: {arc} with {to} for {from}", dialect.name);
            }
        }
        assert!(4 < tried, "{}: {tried}", dialect.name);
    }
}

/// Each block of a program leads to the statement that it came from.
#[test]
fn the_map_leads_from_blocks_to_lines() {
    let text = format!(
        "PARTNO MAP\n{START}GOTO/10,0,0\nCIRCLE/10,5,0,0,0,1,5\nGOTO/10,10,-1\nGOTO/0,10,-1\nDELAY/1.5\nRAPID\nGOTO/0,0,9\nFINI\n"
    );
    for dialect in splinepost::dialect::DIALECTS {
        let machine = crate::support::five(dialect.name);
        let sources = Sources::new(Source::new("map.ncl", text.clone()));
        let language = front::find("creo").expect("creo");
        let output =
            compile(&sources, language, &machine, &Options::default()).unwrap_or_else(|f| panic!("{f:?}"));
        let machine = machine.with_axes(&output.intent.program.axes).expect("X Y Z");
        let reading = (dialect.read)(&output.text, splinepost::source::SourceId::PROGRAM, &machine)
            .expect("it reads")
            .value;
        let report = output.report.as_ref().expect("a proof");
        let map = splinepost::map::json(&output.intent, report, &reading, &output.text, &sources);
        let map: serde_json::Value = serde_json::from_str(&map).expect("JSON");
        assert_eq!((map["program"].as_str(), map["input"].as_str()), (Some("MAP"), Some("map.ncl")));
        let lines: Vec<&str> = output.text.lines().collect();
        let mut seen = Vec::new();
        for entry in map["blocks"].as_array().expect("blocks") {
            let number = |value: &serde_json::Value| value.as_u64().expect("a number") as usize;
            let (line, from) = (number(&entry["line"]), number(&entry["from"][0]));
            seen.push((lines[line - 1], from, number(&entry["from"][1])));
        }
        // The end of the line before the arc, the last line, the dwell and the rapid.
        let find =
            |from: usize| seen.iter().filter(move |(_, first, _)| *first == from).map(|(line, ..)| *line);
        assert!(find(8).all(|line| line.contains("X10") || line.contains("X+10")), "{seen:?}");
        assert_eq!(find(8).count(), 1);
        // The helix: one block.
        assert_eq!(find(9).count(), 1, "{seen:?}");
        assert!(seen.iter().any(|(_, first, last)| (*first, *last) == (9, 10)), "{seen:?}");
        assert!(find(11).all(|line| line.contains("X0") || line.contains("X+0")), "{seen:?}");
        assert!(find(12).any(|line| line.contains("1.5") || line.contains("CYCL")), "{seen:?}");
        // The rapid, and Z to its home behind it.
        assert!(find(14).next().is_some_and(|line| line.contains("Z9") || line.contains("Z+9")), "{seen:?}");
    }
}

/// A control that counts an axis the other way sees a mirror image: the other sense, and the other sign in I J K.
#[test]
fn arcs_on_an_axis_that_counts_the_other_way() {
    let text = format!("PARTNO ARC\n{START}CIRCLE/5,0,0,0,0,1,5\nGOTO/5,5,0\nGOTO/9,9,9\nFINI\n");
    for (name, word, other) in [
        ("sinumerik", "G3 X5 Y5 I5 J0", "G2 X-5 Y5 I-5 J0"),
        ("mazak", "G3 X5. Y5. I5. J0.", "G2 X-5. Y5. I-5. J0."),
        ("heidenhain", "C X+5 Y+5 DR+", "C X-5 Y+5 DR-"),
    ] {
        let file = format!("extends = \"{name}\"\n[axis.X]\nsign = -1\n");
        for (machine, word) in [(crate::support::five(name), word), (crate::support::machine(&file), other)] {
            let output = program("creo", &text, &machine).unwrap_or_else(|e| panic!("{name}: {e:?}"));
            assert!(output.text.contains(word), "{word}\n{}", output.text);
        }
    }
}

/// Where the frame changes the tool is at home when the program stops, and is called again unless another one is.
#[test]
fn a_changed_frame_stops_with_the_tool_at_home() {
    let frame = "MSYS/0,0,20,1,0,0,0,-1,0\n";
    let body = |next: &str| {
        let text = format!(
            "UNITS/MM\nMSYS/0,0,0,1,0,0,0,1,0\nLOAD/TOOL,1\nSPINDL/RPM,900,CLW\nCOOLNT/ON\nFEDRAT/MMPM,200\nRAPID\nGOTO/0,0,9\n\
             GOTO/0,0,-1\n{frame}{next}RAPID\nGOTO/0,0,9\nGOTO/0,0,-2\nFINI\n"
        );
        splinepost::dump::intent(&intent_as("nx", &text, false).expect("it reads"))
    };
    let again = body("");
    assert!(again.contains("home Z\nstop\ntool 1\nspindle 900\ncoolant\nrapid X 0 Y 0 Z 9\n"), "{again}");
    let other = body("LOAD/TOOL,2\nSPINDL/ON\nCOOLNT/ON\n");
    assert!(other.contains("home Z\nstop\ntool 2\nspindle 900\ncoolant\nrapid X 0"), "{other}");
    assert_eq!((again.matches("tool 1").count(), other.matches("tool 1").count()), (2, 1));
}
