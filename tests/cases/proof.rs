//! Stated bounds, lengths and times, and programs that compile refused to itself: `fixtures/cases/proof`.

use crate::support::{folder, machine, no_number, sources_in, told};
use splinepost::geom::elementary::{cos, exp, sin};
use splinepost::ir::Method;
use splinepost::machine::Machine;
use splinepost::source::SourceId;
use splinepost::{Options, Output, compile, front};
use std::fmt::Write as _;

/// Half a circle of radius 5.
const HALF_CIRCLE: f64 = 5.0 * std::f64::consts::PI;

/// The sum of 2·10⁶ chords at equal parameters of the piece with the weights 1, 200, 1, from the definition of a rational
/// piece alone, in Python floats; the longest chord leaves out less than 1e-9 mm.
const SHARP: f64 = 14.112_357_928;

fn compiled(name: &str, machine: &Machine, options: &Options) -> Result<Output, String> {
    let folder = folder("fixtures/cases/proof");
    let text = std::fs::read_to_string(folder.join(name)).expect(name);
    let sources = sources_in(name, &text, &folder);
    let source = sources.get(SourceId::INPUT).expect("an input");
    let language = front::detect(source).unwrap_or_else(|_| panic!("{name}: no language"));
    compile(&sources, language, machine, options).map_err(|f| f.diagnostics.render(&sources, false))
}

/// Compiles a case on every built-in machine, each as `auto` chooses: within its tolerance, of this length, without `inf`.
fn everywhere(name: &str, length: f64, slack: f64) {
    for built_in in ["sinumerik", "heidenhain", "mazak"] {
        let machine = Machine::built_in(built_in).expect("a machine");
        let output = compiled(name, &machine, &Options::default())
            .unwrap_or_else(|told| panic!("{name} on {built_in}: {told}"));
        let report = output.report.as_ref().expect("a proof");
        assert!(report.deviation.mm <= output.tolerance, "{name} on {built_in}: {:?}", report.deviation);
        let found = report.cutting_length;
        assert!((found - length).abs() <= slack, "{name} on {built_in}: {found} mm, not {length}");
        // One path at 1000 mm/min, also by the F of the program.
        let [least, most] = output.setup.path_minutes.expect("a time");
        assert_eq!(least.to_bits(), most.to_bits());
        assert!((least - length / 1000.0).abs() <= slack / 1000.0, "{name} on {built_in}: {least} min");
        // A fit is some parts in a thousand longer or shorter than its curve.
        assert!((report.minutes / least - 1.0).abs() < 2.0e-3, "{name} on {built_in}: {}", report.minutes);
        for text in [&output.text, &told(&output)] {
            assert_eq!(no_number(text), None, "{name} on {built_in}: {text}");
        }
    }
}

#[test]
fn lengths_of_rational_curves_are_integrals() {
    everywhere("rational-weight-length.toml", SHARP, 1.0e-8);
    // The weights 3, 1, 1, 3, whose denominator is a quadratic without a middle weight.
    everywhere("rational-third.toml", HALF_CIRCLE, 1.0e-9);
    // Its weights are stated in eleven digits.
    everywhere("step-rational-third.toml", HALF_CIRCLE, 1.0e-8);
    // Two straight legs, whose control points are stacked four deep.
    let legs = 43.5 + (17.2f64 * 17.2 + 45.5 * 45.5).sqrt();
    everywhere("spline-stacked-points.toml", legs, 1.0e-9);
}

#[test]
fn a_rotary_axis_beside_a_rational_curve_does_not_change_its_length() {
    for built_in in ["sinumerik", "heidenhain", "mazak"] {
        let machine = Machine::built_in(built_in).expect("a machine");
        let output = compiled("rational-weight-length-a.toml", &machine, &Options::default())
            .unwrap_or_else(|told| panic!("{built_in}: {told}"));
        let found = output.report.as_ref().expect("a proof").cutting_length;
        assert!((found - SHARP).abs() < 1.0e-8, "{built_in}: {found}");
        assert_eq!(no_number(&told(&output)), None, "{built_in}");
        assert_eq!(no_number(&output.text), None, "{built_in}");
    }
}

#[test]
fn moves_of_rotary_axes_alone_take_time() {
    // 360 degrees at 1000 degrees a minute.
    for built_in in ["sinumerik", "heidenhain", "mazak"] {
        let machine = Machine::built_in(built_in).expect("a machine");
        let output = compiled("rotary-only.toml", &machine, &Options::default())
            .unwrap_or_else(|told| panic!("{built_in}: {told}"));
        assert_eq!(output.setup.path_minutes, Some([0.36, 0.36]), "{built_in}");
        let minutes = output.report.as_ref().expect("a proof").minutes;
        assert!((minutes - 0.36).abs() < 1.0e-12, "{built_in}: {minutes}");
        assert!(output.text.contains("TIME: 1 PATH OF 0.36 MIN"), "{built_in}: {}", output.text);
    }
}

fn own_machine(name: &str) -> Machine {
    let path = folder("fixtures/cases/proof").join(format!("{name}.machine.toml"));
    machine(&std::fs::read_to_string(path).expect(name))
}

#[test]
fn own_programs_are_not_refused() {
    // Odd-even steps as splines, run to D1: a knot that was inserted ends a piece inside a step.
    let mazak = own_machine("refused-5-353");
    let options = Options {
        motion: mazak.dialect.motion("g06.2"),
        method: Some(Method::OddEven),
        tolerance: Some(0.000_190_157_553_768_795_84),
        ..Options::default()
    };
    let output = compiled("refused-5-353.toml", &mazak, &options).unwrap_or_else(|told| panic!("{told}"));
    assert_eq!(output.report.expect("a proof").path_blocks, 11664);

    // A flute of constant lead as one line: half a unit of X is R dA/dX = 44 times as much at equal X.
    let heidenhain = own_machine("refused-5-36");
    let tolerance = 0.000_165_894_486_143_054_42;
    let options = Options { method: Some(Method::Direct), tolerance: Some(tolerance), ..Options::default() };
    let output = compiled("refused-5-36.toml", &heidenhain, &options).unwrap_or_else(|told| panic!("{told}"));
    let report = output.report.expect("a proof");
    // At the end half a unit of every axis: √3 · 5e-5 mm, and 5e-5 degrees at the radius of 30.5 mm, 2.7e-5 mm.
    assert!(report.deviation.mm < 9.1e-5, "{:?}", report.deviation);
    // Three flutes of 142.48… mm · √(1 + tan² 11.747…° (1 + sin² 8°)).
    assert!((report.cutting_length - 436.762_6).abs() < 1.0e-3, "{}", report.cutting_length);
}

#[test]
fn auto_goes_on_to_a_motion_that_proves() {
    let heidenhain = own_machine("refused-job7-8");
    let options = Options { tolerance: Some(0.000_540_334_227_356_541_1), ..Options::default() };
    let output =
        compiled("refused-job7-8.toml", &heidenhain, &options).unwrap_or_else(|told| panic!("{told}"));
    assert_eq!(output.motion.name, "linear");
    let passed: Vec<_> = output.warnings.0.iter().filter(|d| d.id == "motion-passed-over").collect();
    assert_eq!(passed.len(), 1, "{:?}", output.warnings);
    assert!(
        passed[0].message.starts_with("written as `linear`: as `spl` the program deviates"),
        "{passed:?}"
    );
    // The entity: the first curve of the input.
    assert_eq!(passed[0].span.map(|span| span.source), Some(SourceId::INPUT));
    // A motion that was asked for is the only one, and its refusal shows the entity too.
    let asked = Options { motion: heidenhain.dialect.motion("spl"), ..options };
    let refused = compiled("refused-job7-8.toml", &heidenhain, &asked).expect_err("spl is not proved");
    assert!(refused.contains("deviation-too-large") && refused.contains("requested here"), "{refused}");
}

#[test]
fn a_ramp_that_ends_beside_its_circle_is_written() {
    // A whole turn whose end is 1 um farther out than its start: half of that is its distance from the mean circle.
    for built_in in ["sinumerik", "heidenhain", "mazak"] {
        let machine = Machine::built_in(built_in).expect("a machine");
        let output = compiled("helix-ramp-off-circle.cls", &machine, &Options::default())
            .unwrap_or_else(|told| panic!("{built_in}: {told}"));
        let deviation = output.report.as_ref().expect("a proof").deviation.mm;
        assert!((4.9e-4..=1.0e-3).contains(&deviation), "{built_in}: {deviation}");
        // Less is allowed than the turn is off, but more than its radius is: lines on a Heidenhain too.
        let closer = Options { tolerance: Some(6.0e-4), ..Options::default() };
        let output = compiled("helix-ramp-off-circle.cls", &machine, &closer)
            .unwrap_or_else(|told| panic!("{built_in}: {told}"));
        assert!(output.report.expect("a proof").deviation.mm <= 6.0e-4, "{built_in}");
    }
}

#[test]
fn a_spline_of_one_span_may_repeat_its_first_point() {
    // The weight of a first point needs a block of its own, which repeats the point. Without more blocks than it needs the
    // spline has one span.
    let machine = machine("extends = \"sinumerik\"\n[spline]\nbspline_min_blocks = 0\n");
    let job = "name = \"ONE\"\n[process]\nfeed = 500\nretract = { axis = \"Z\", to = 50 }\n[[curve]]\nkind = \"nurbs\"\n\
               axes = [\"X\", \"Y\"]\nat = { Z = 0 }\ndegree = 3\nknots = [0, 0, 0, 0, 1, 1, 1, 1]\n\
               points = [[0, 0], [5, 10], [15, 10], [20, 0]]\nweights = [2, 1, 1, 2]\n";
    let sources = crate::support::sources(job);
    let options = Options { motion: machine.dialect.motion("bspline"), ..Options::default() };
    let language = front::detect(sources.get(SourceId::INPUT).expect("an input")).expect("a job");
    let output = compile(&sources, language, &machine, &options)
        .unwrap_or_else(|f| panic!("{}", f.diagnostics.render(&sources, false)));
    // The same program with its first point as a block of its own, as other writers do.
    let first = output.text.lines().find(|line| line.contains("BSPLINE")).expect("a spline");
    let repeated = first.split("BSPLINE").next().expect("a number").trim().to_owned();
    assert!(!repeated.is_empty(), "{first}");
    let text = output.text.replacen(
        first,
        &format!("{} BSPLINE SD=3 X0 Y0 PL=0 PW=1\n{}", repeated, first.replace("BSPLINE SD=3 ", "")),
        1,
    );
    let reading = (machine.dialect.read)(&text, SourceId::PROGRAM, &output.machine);
    let again = (machine.dialect.read)(&output.text, SourceId::PROGRAM, &output.machine);
    let curves = |reading: Result<splinepost::diagnostic::Warned<splinepost::dialect::Reading>, _>| {
        let steps = reading.unwrap_or_else(|e: splinepost::diagnostic::Diagnostics| panic!("{e:?}\n{text}"));
        let steps = steps.value.decimals.program.steps;
        let nurbs = steps.iter().find_map(|located| match &located.step.cut()?.curve {
            splinepost::ir::Written::Nurbs(nurbs) => Some((nurbs.points.clone(), nurbs.knots.clone())),
            splinepost::ir::Written::Lines(_)
            | splinepost::ir::Written::Arc(_)
            | splinepost::ir::Written::Polynomial(_)
            | splinepost::ir::Written::Through(..) => None,
        });
        nurbs.expect("a spline")
    };
    let (points, knots) = curves(again);
    assert_eq!(points.len(), 4, "one span");
    assert_eq!(curves(reading), (points, knots));
}

#[test]
fn chords_that_go_round_a_fold_follow_it() {
    // Lines of 1e-4 mm and more round a fold whose legs are as near to one another as the tolerance.
    let heidenhain = own_machine("slow-job-linear");
    let tolerance = 0.000_352_411_314_744_253_96;
    let options = Options {
        motion: heidenhain.dialect.motion("linear"),
        tolerance: Some(tolerance),
        ..Options::default()
    };
    let output =
        compiled("slow-job-linear.toml", &heidenhain, &options).unwrap_or_else(|told| panic!("{told}"));
    let deviation = output.report.expect("a proof").deviation.mm;
    // The chords take what rounding leaves of the tolerance: at least half of it.
    assert!((0.5 * tolerance..=tolerance).contains(&deviation), "{deviation}");
}

#[test]
fn a_cutter_run_out_to_its_apex_is_written() {
    // A radius of 0.017 mm: so near to the apex a chord is off by thousands of times what many are.
    let sinumerik = own_machine("slow-cutter-apex");
    let tolerance = 0.000_673_115_714_725_779_7;
    let options = Options { method: Some(Method::Direct), tolerance: Some(tolerance), ..Options::default() };
    let output =
        compiled("slow-cutter-apex.toml", &sinumerik, &options).unwrap_or_else(|told| panic!("{told}"));
    assert!(output.report.expect("a proof").deviation.mm <= tolerance);
}

/// Directions a hair from the pole, where C turns by any angle and the tool by next to none.
#[test]
fn a_control_that_turns_evenly_passes_the_pole() {
    let mut state = 0x9e37_79b9_u32;
    let mut random = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1u32 << 24)
    };
    let mut text = "UNITS/MM\nMULTAX/ON\nLOADTL/1\nSPINDL/500,RPM,CLW\nFEDRAT/100,MMPM\nRAPID\n\
                    GOTO/0,0,50,0,0,1\nGOTO/0,0,0,0,0,1\n"
        .to_owned();
    for k in 1..=60 {
        // From 1e-7, which rounding hides, to 0.03.
        let tilt = 1.0e-7 * exp(12.6 * random());
        let turn = std::f64::consts::TAU * random();
        let (i, j) = (tilt * cos(turn), tilt * sin(turn));
        let up = (1.0 - i * i - j * j).sqrt();
        writeln!(text, "GOTO/{k},0,0,{i:.7},{j:.7},{up:.7}").expect("a string");
    }
    text += "RAPID\nGOTO/60,0,50,0,0,1\nFINI\n";
    let homes = "[axis.X]\nhome = 0\n[axis.Y]\nhome = 0\n[axis.Z]\nhome = 0\n";
    for built_in in ["heidenhain", "mazak"] {
        let machine = machine(&format!("extends = \"{built_in}\"\n{homes}[orientation]\nturn = \"tilt\"\n"));
        let options = Options { motion: machine.dialect.motion("linear"), ..Options::default() };
        let output =
            super::compiled(&text, &machine, &options).unwrap_or_else(|e| panic!("{built_in}: {e:?}"));
        let deviation = output.report.expect("a proof").deviation;
        assert!(deviation.mm <= output.tolerance, "{built_in}: {deviation:?}");
    }
}

#[test]
fn a_last_step_below_the_decimals_is_no_move_more() {
    // The last of two legs is 2.8e-5 mm, less than half a unit of four decimals on either axis.
    let text = "name = \"STEP\"\n[process]\nfeed = 100.0\nretract = { axis = \"Z\", to = 50.0 }\n[[curve]]\nkind = \"nurbs\"\n\
                axes = [\"X\", \"Y\"]\nat = { Z = 0.0 }\ndegree = 1\nknots = [0, 0, 1.5, 2.3, 2.3]\n\
                points = [[0.0, 0.0], [0.0, 7.3], [0.00002, 7.30002]]\n";
    for built_in in ["sinumerik", "heidenhain", "mazak"] {
        for digits in [2, 4] {
            let keys = format!("extends = \"{built_in}\"\nname = \"few\"\n[digits]\nlinear = {digits}\n");
            let machine = machine(&keys);
            let tolerance = Some(if digits == 2 { 0.02 } else { 0.001 });
            let options =
                Options { motion: machine.dialect.motion("linear"), tolerance, ..Options::default() };
            let output = super::compiled(text, &machine, &options)
                .unwrap_or_else(|e| panic!("{built_in} {digits}: {e:?}"));
            assert_eq!(output.report.expect("a proof").path_blocks, 2, "{built_in}: {}", output.text);
        }
    }
}
