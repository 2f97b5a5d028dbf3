//! NC programs as inputs: round all dialects and back, and what cannot go.

use crate::support::{folder, machine};
use splinepost::diagnostic::Diagnostics;
use splinepost::geom::bezier::Bezier;
use splinepost::geom::follow::follow;
use splinepost::ir::Curve;
use splinepost::machine::Machine;
use splinepost::source::{Source, Sources};
use splinepost::verify::Status;
use splinepost::{Options, Output, compile, front, recompile, translate};

fn program(text: &str, from: &Machine, to: &Machine, motion: Option<&str>) -> Result<Output, Diagnostics> {
    let motion = motion.and_then(|name| to.dialect.motion(name));
    let options = Options { motion, ..Options::default() };
    let sources = Sources::new(Source::new("part.nc", text));
    recompile(&sources, from, to, &options).map_err(|failure| failure.diagnostics)
}

fn first(input: &str, language: &str, machine: &Machine, motion: Option<&str>) -> Output {
    let options =
        Options { motion: motion.and_then(|name| machine.dialect.motion(name)), ..Options::default() };
    let sources = Sources::new(Source::new("input", input));
    compile(&sources, front::find(language).expect("a language"), machine, &options)
        .unwrap_or_else(|failure| panic!("{:?}", failure.diagnostics))
}

fn built_in(name: &str) -> Machine {
    machine(&format!("extends = \"{name}\"\nname = \"{name}\"\n"))
}

/// A cubic spline that turns in space.
const SPLINE: &str = "name = \"ROUND\"\n[process]\nfeed = 1000\nspindle = 3000\nretract = { axis = \"Z\", to = 50 }\n\
    [[curve]]\nkind = \"nurbs\"\naxes = [\"X\", \"Y\", \"Z\"]\ndegree = 3\nknots = [0, 0, 0, 0, 10, 20, 35, 45, 60, 60, 60, 60]\n\
    points = [[0, 0, 1], [10, 5, 2], [20, -5, 3], [30, 8, 2], [40, 1, 1], [55, 0, 0], [60, 3, 1], [72, 4, 2]]\n";

#[test]
fn a_cubic_goes_round_all_dialects() {
    let [sinumerik, heidenhain, mazak] = ["sinumerik", "heidenhain", "mazak"].map(built_in);
    let start = first(SPLINE, "job", &sinumerik, Some("poly"));
    let mut text = start.text.clone();
    let mut from = &sinumerik;
    for (to, motion) in
        [(&sinumerik, "bspline"), (&heidenhain, "spl"), (&mazak, "g06.2"), (&sinumerik, "poly")]
    {
        let output = program(&text, from, to, Some(motion)).unwrap_or_else(|e| panic!("{motion}: {e:?}"));
        let report = output.report.as_ref().expect("a report");
        assert_eq!(report.status, Status::Proved);
        // Half a unit of four decimals in three axes, and as much again where knots are taken out.
        assert!(report.deviation.mm < 3.0e-4, "{motion}: {}", report.deviation.mm);
        assert!(!output.warnings.0.iter().any(|d| d.id == "curve-fitted"), "{motion}");
        if ["bspline", "g06.2"].contains(&motion) {
            // Eight control points: joined with a single knot at each joint; and the approach.
            assert_eq!(report.path_blocks, 8, "{}", output.text);
        } else {
            assert_eq!(report.path_blocks, 6, "{}", output.text);
        }
        (text, from) = (output.text, to);
    }
    assert!(start.text.contains("CURVE") == text.contains("CURVE"), "remarks stay: {text}");
    // Back where it began: four roundings by half a unit of four decimals at most, in three axes, and as much again where
    // knots were taken out.
    let pieces = |text: &str| -> Vec<Bezier> {
        let sources = Sources::new(Source::new("round.mpf", text));
        let intent = translate::parse(&sources, &sinumerik, &sinumerik).unwrap_or_else(|e| panic!("{e:?}"));
        let cuts = intent.program.steps.iter().filter_map(|located| located.step.cut());
        cuts.filter(|cut| matches!(cut.curve, Curve::Polynomial(_)))
            .flat_map(|cut| cut.curve.pieces())
            .collect()
    };
    let (began, ended) = (pieces(&start.text), pieces(&text));
    assert_eq!((began.len(), ended.len()), (5, 5));
    let apart = follow(&ended, &began, 1.0e-3).expect("a bound");
    assert!(apart.distance < 8.0 * 1.0e-4, "{}", apart.distance);
    println!("round trip: {:.2e} mm", apart.distance);
}

#[test]
fn every_golden_program_of_cl_data_can_be_asked_of_every_machine() {
    let [sinumerik, heidenhain, mazak] = ["sinumerik", "heidenhain", "mazak"].map(built_in);
    let (mut count, mut five, mut planes) = (0, 0, 0);
    for (name, text) in crate::apt::inputs() {
        let language = front::find("apt").expect("CL data");
        let sources = Sources::new(Source::new("input.cl", text.as_str()));
        for from in [&sinumerik, &heidenhain, &mazak] {
            let Ok(asked) = compile(&sources, language, from, &Options::default()) else { continue };
            planes += usize::from(asked.intent.program.has_planes());
            five += usize::from(asked.intent.program.axes.direction().is_some());
            for to in [&sinumerik, &heidenhain, &mazak] {
                let output = match program(&asked.text, from, to, None) {
                    Ok(output) => output,
                    Err(errors) => {
                        // Words that a machine has no line for, and points that its decimals do not hold.
                        let ids: Vec<&str> = errors.0.iter().map(|d| d.id).collect();
                        panic!("{name}: {} to {}: {ids:?} {errors:?}", from.name, to.name);
                    }
                };
                let report = output.report.expect("a report");
                assert!(report.deviation.mm <= output.tolerance, "{name}");
                if from.name == to.name && asked.intent.program.has_planes() {
                    assert_eq!(output.text, asked.text, "{name}: {}", from.name);
                }
                count += 1;
            }
        }
    }
    assert!(9 < count && 5 < five && 2 < planes, "{count} {five} {planes}");
}

#[test]
fn what_only_its_machine_knows_is_refused() {
    let heidenhain = machine("extends = \"heidenhain\"\n[spline]\naxes = [\"X\", \"Y\", \"Z\", \"A\"]\n");
    let mill = std::fs::read_to_string(folder("fixtures/compile/conical-mill/input.toml")).expect("the mill");
    let output = first(&mill, "cutter", &heidenhain, None);
    let errors = program(&output.text, &heidenhain, &built_in("sinumerik"), None).expect_err("A counts in F");
    assert_eq!(errors.0[0].id, "feed-counts-rotary");
    let damaged = output.text.replacen("SPL X", "SPL Q", 1);
    assert!(program(&damaged, &heidenhain, &built_in("sinumerik"), None).is_err());
    assert!(program("", &heidenhain, &built_in("sinumerik"), None).is_err());
}

#[test]
fn a_flute_goes_where_f_counts_the_path_alone() {
    let sinumerik = built_in("sinumerik");
    let mill = std::fs::read_to_string(folder("fixtures/compile/conical-mill/input.toml")).expect("the mill");
    let output = first(&mill, "cutter", &sinumerik, None);
    let again =
        program(&output.text, &sinumerik, &sinumerik, Some("poly")).unwrap_or_else(|e| panic!("{e:?}"));
    // Four flutes, and four approaches, which are lines like others here.
    assert_eq!(again.report.expect("a report").path_blocks, 8);
}

#[test]
fn a_machine_that_turns_the_tool_otherwise_is_warned_of() {
    let sinumerik = built_in("sinumerik");
    let even = machine("extends = \"heidenhain\"\nname = \"even\"\n[orientation]\nturn = \"tilt\"\n");
    let path = folder("fixtures/apt/nx-five-axes/sinumerik.mpf");
    let text = std::fs::read_to_string(path).expect("the program");
    let warned = |to: &Machine| {
        let output = program(&text, &sinumerik, to, None).unwrap_or_else(|e| panic!("{e:?}"));
        output.warnings.0.iter().any(|warning| warning.id == "turn-differs")
    };
    assert!(warned(&even) && !warned(&built_in("heidenhain")));
}

#[test]
fn a_program_without_a_number_gets_one_where_one_is_wanted() {
    let mazak = built_in("mazak");
    for name in ["sinumerik", "heidenhain", "mazak"] {
        let from = built_in(name);
        let start = first(SPLINE, "job", &from, None);
        let output = program(&start.text, &from, &mazak, None).unwrap_or_else(|e| panic!("{name}: {e:?}"));
        assert_eq!(output.text.lines().nth(1), Some("O0001"), "{name}");
    }
    // Its own stays.
    let start = first(&SPLINE.replacen("name", "number = 4711\nname", 1), "job", &mazak, None);
    let output = program(&start.text, &mazak, &mazak, None).unwrap_or_else(|e| panic!("{e:?}"));
    assert_eq!(output.text.lines().nth(1), Some("O4711"));
}

/// Two tools, each with a rapid to its place and a cut from there.
const TOOLS: &str = "UNITS/MM\nLOADTL/1\nSPINDL/900,CLW\nFEDRAT/200,MMPM\nRAPID\nGOTO/0,0,10\nGOTO/0,0,-1\nGOTO/20,0,-1\nRAPID\n\
    GOTO/20,0,30\nLOADTL/2\nSPINDL/900,CLW\nRAPID\nGOTO/50,0,7\nGOTO/65,5,7\nRAPID\nGOTO/65,5,30\nFINI\n";

/// Behind its home nobody knows where Z is until a word says it: no cut, and no other program, may assume a place.
#[test]
fn what_a_program_does_not_say_is_not_made_up() {
    for (name, down, refused) in [
        ("sinumerik", "Z7", "place-unknown"),
        ("heidenhain", "L Z+7 R0 FMAX", "place-unknown"),
        ("mazak", "G43 H2 Z7.", "tool-offset-missing"),
    ] {
        let own = built_in(name);
        let text = first(TOOLS, "apt", &own, None).text;
        assert!(program(&text, &own, &own, None).is_ok());
        let bare: String =
            text.split_inclusive('\n').filter(|line| !line.trim_end().ends_with(down)).collect();
        assert_eq!(bare.lines().count() + 1, text.lines().count(), "{text}");
        let errors = program(&bare, &own, &own, None).map(|output| output.text).expect_err("no place");
        assert_eq!(errors.0[0].id, refused, "{name}: {errors:?}");
        // Nor is a feed.
        let feedless: String =
            text.split_inclusive('\n').map(|line| line.replace(" F200.", "").replace(" F200", "")).collect();
        let errors = program(&feedless, &own, &own, None).map(|output| output.text).expect_err("no feed");
        assert_eq!(errors.0[0].id, "feed-missing", "{name}: {errors:?}");
    }
    let mazak = built_in("mazak");
    let text = first(TOOLS, "apt", &mazak, None).text;
    let ended = text.replace("G1 X65.", "G1 G49 X65.");
    assert_ne!(ended, text);
    let errors = program(&ended, &mazak, &mazak, None).map(|output| output.text).expect_err("no length");
    assert_eq!(errors.0[0].id, "tool-offset");
}
