//! Where paths begin, and cuts without length.

use super::{case, compiled, proved};
use crate::support::machine;
use splinepost::Options;
use splinepost::dialect::{DIALECTS, Reading};
use splinepost::ir::{Intent, Role, Step, Written};
use splinepost::source::SourceId;
use splinepost::summary::Summary;
use splinepost::verify::verify;
use std::collections::BTreeSet;

#[test]
fn a_spline_begins_where_a_block_has_brought_the_tool() {
    let text = case("cl/fit-first-move-cuts.cls");
    for dialect in DIALECTS {
        let machine = machine(&format!("extends = \"{}\"\n", dialect.name));
        let options = Options { fit: true, tolerance: Some(0.01), ..Options::default() };
        let output =
            compiled(&text, &machine, &options).unwrap_or_else(|e| panic!("{}: {e:?}", dialect.name));
        let report = output.report.as_ref().expect("a proof");
        assert!(report.splined.is_some(), "{}: splines\n{}", dialect.name, output.text);
        let remark = |line: &&str| line.contains(';') || line.contains('(') && !line.contains("PO[");
        let lines: Vec<&str> = output.text.lines().filter(|line| !remark(line)).collect();
        let spline = ["SPL ", "BSPLINE", "PO[", "G06.2"];
        let first = lines.iter().position(|line| spline.iter().any(|word| line.contains(word)));
        let first = first.expect("a spline");
        // The tool comes over the start at rapid, and down to it at the feed of the cut, in blocks of their own.
        let has =
            |words: [&str; 2]| lines[..first].iter().position(|line| words.iter().all(|w| line.contains(w)));
        let over = has(["X", "100"]).expect("X is brought");
        let down = has(["Z", "-10"]).unwrap_or_else(|| panic!("Z is brought\n{}", output.text));
        assert!(over < down && lines[down].contains("F2500"), "{}", output.text);
        // Without it nothing says where the spline begins.
        let less: Vec<&str> = output.text.lines().filter(|line| *line != lines[down]).collect();
        assert!(proved(&output, &(less.join("\n") + "\n")).is_err(), "{}", output.text);
    }
}

/// A curve behind a tool call starts where the tool was before, and the tool is not there any more.
#[test]
fn a_tool_call_leaves_no_axis_where_it_was() {
    let text = "PARTNO/ARC\nUNITS/MM\nLOADTL/1\nSPINDL/8000,RPM,CLW\nRAPID\nGOTO/0,0,50\nRAPID\nGOTO/0,0,2\n\
                FEDRAT/600.0,MMPM\nGOTO/0,0,-1\nGOTO/10,0,-1\nLOADTL/2\nSPINDL/8000,RPM,CLW\nGOTO/20,0,-1\n\
                GOTO/30,5,-1\nRAPID\nGOTO/30,5,50\nFINI\n";
    for dialect in DIALECTS {
        let machine = machine(&format!("extends = \"{}\"\n", dialect.name));
        let output = compiled(text, &machine, &Options::default()).unwrap_or_else(|e| panic!("{e:?}"));
        let lines: Vec<&str> = output.text.lines().collect();
        let called = lines.iter().rposition(|line| line.contains("8000")).expect("the second tool");
        // X and Y are named behind the call although the tool had been there.
        let named = |word: &str| lines[called..].iter().position(|line| line.contains(word));
        let rapid = named("X").zip(named("Y")).expect("X and Y are named");
        let down =
            lines[called..].iter().position(|line| line.contains('Z') && line.contains("-1")).expect("Z");
        assert!(rapid.0 <= down && rapid.1 <= down, "{}", output.text);
        // Dropping the rapid behind the call is refused.
        let mut less = lines.clone();
        less.remove(called + rapid.0);
        assert!(proved(&output, &(less.join("\n") + "\n")).is_err(), "{}", output.text);
    }
}

/// One block a point, so that each has its line in `--map`; its switches are kept.
#[test]
fn a_point_that_is_asked_twice_is_counted_and_no_error() {
    let text = "PARTNO/TWICE\nUNITS/MM\nLOADTL/1\nSPINDL/8000,RPM,CLW\nRAPID\nGOTO/0,0,50\nRAPID\nGOTO/0,0,2\n\
                FEDRAT/600.0,MMPM\nGOTO/0,0,-1\nGOTO/10,0,-1\nGOTO/10,0,-1\nCOOLNT/ON\nGOTO/10,0,-1\n\
                FEDRAT/900.0,MMPM\nGOTO/10,0,-1\nGOTO/10.000001,0,-1\nGOTO/20,0,-1\nRAPID\nGOTO/20,0,50\nFINI\n";
    for dialect in DIALECTS {
        let machine =
            machine(&format!("extends = \"{}\"\nname = \"four\"\n[digits]\nlinear = 4\n", dialect.name));
        for fit in [false, true] {
            let options = Options { fit, ..Options::default() };
            let output = compiled(text, &machine, &options).unwrap_or_else(|e| panic!("{e:?}"));
            let report = output.report.as_ref().expect("a proof");
            // Twice at F600, once behind the coolant, once at F900, and a step of 1e-6 mm: the first is a move.
            assert_eq!(report.rests, 4, "{}\n{}", dialect.name, output.text);
            assert!(output.text.contains("F900") && output.text.contains("M8"), "{}", output.text);
            let setup = output.setup.clone();
            let summary =
                Summary::new(&output.intent, &output.machine, None, &output.text, Some(report), 0.001, setup);
            let told = "4 points of the input stand where the tool is already";
            assert!(summary.render().contains(told), "{}", summary.render());
        }
    }
}

/// Within a tolerance of 0.01 mm a circle of 4 µm and a point are the same; a cut that is none is refused all the same.
#[test]
fn a_small_circle_is_no_point() {
    let (r, w) = (0.004, std::f64::consts::FRAC_1_SQRT_2);
    let job = format!(
        "name = \"SMALL\"\ntolerance = 0.02\n[process]\nfeed = 100.0\nretract = {{ axis = \"Z\", to = 50.0 }}\n[[curve]]\n\
         kind = \"nurbs\"\naxes = [\"X\", \"Y\"]\nat = {{ Z = 0.0 }}\ndegree = 2\nknots = [0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4]\n\
         points = [[{r}, 0], [{r}, {r}], [0, {r}], [-{r}, {r}], [-{r}, 0], [-{r}, -{r}], [0, -{r}], [{r}, -{r}], [{r}, 0]]\n\
         weights = [1, {w}, 1, {w}, 1, {w}, 1, {w}, 1]\n"
    );
    let machine = machine("extends = \"mazak\"\n");
    let options = Options { motion: machine.dialect.motion("linear"), ..Options::default() };
    let output = compiled(&job, &machine, &options).unwrap_or_else(|e| panic!("{e:?}"));
    let lines: Vec<&str> = output.text.lines().collect();
    let down = lines.iter().position(|line| line.starts_with("G1 Z0.")).expect("the approach");
    let up = lines.iter().rposition(|line| line.starts_with("G0 Z50.")).expect("the retraction");
    assert!(down + 2 < up, "{}", output.text);
    // The path as one block that leads to where the tool is.
    let mut point = lines[..=down].to_vec();
    point.push("X0.004");
    point.extend(&lines[up..]);
    let refused = proved(&output, &(point.join("\n") + "\n")).expect_err("a point");
    assert_eq!(refused.0[0].id, "cut-without-length", "{refused:?}");
}

/// A curve of which next to nothing is left is no contour: a turn whose ends were taken for each other becomes one.
#[test]
fn a_contour_that_leads_nowhere_is_refused() {
    let job = |size: f64| {
        format!(
            "name = \"POINT\"\n[process]\nfeed = 100.0\nretract = {{ axis = \"Z\", to = 50.0 }}\n[[curve]]\nkind = \"bezier\"\n\
             axes = [\"X\", \"Y\"]\nat = {{ Z = -1.0 }}\npoints = [[5, 0], [5, {size}], [5, {}], [5, {}]]\n",
            2.0 * size,
            3.0 * size
        )
    };
    for dialect in DIALECTS {
        let machine = machine(&format!("extends = \"{}\"\n[digits]\nlinear = 4\n", dialect.name));
        let refused = compiled(&job(1.0e-7), &machine, &Options::default()).expect_err("a point");
        assert_eq!(refused.0[0].id, "path-without-length", "{}: {refused:?}", dialect.name);
        // Rounding hides √3 · 1e-4 at most.
        compiled(&job(1.0e-4), &machine, &Options::default()).unwrap_or_else(|e| panic!("{e:?}"));
    }
}

/// Whether a step is a rapid of one axis alone.
fn is_rapid_of<N, C>(step: &Step<N, C>, axis: usize) -> bool {
    matches!(step, Step::Rapid(targets) if matches!(&targets[..], [(only, _)] if *only == axis))
}

/// What the passes make always leads to the start of a path. Where that is taken out of the input's steps and of the program's alike,
/// so that both agree, the path is refused all the same, in every form.
#[test]
fn every_kind_of_cut_needs_its_start() {
    let cutter = crate::support::input("D1 = 10\nS = 30\nC = 5\nr = 8\nlength = 10", "");
    let job = "name = \"PART\"\n[process]\nfeed = 100.0\nretract = { axis = \"Z\", to = 50.0 }\n[[curve]]\nkind = \"bezier\"\n\
               axes = [\"X\", \"Y\"]\nat = { Z = -1.0 }\npoints = [[5, 0], [5, 4], [8, 8], [12, 8]]\n";
    let mut kinds = BTreeSet::new();
    for dialect in DIALECTS {
        let machine = machine(&format!(
            "extends = \"{}\"\nname = \"plain\"\n[spline]\naxes = [\"X\", \"Y\", \"Z\", \"A\"]\n",
            dialect.name
        ));
        for (input, motion) in dialect.motions.iter().flat_map(|motion| [(&*cutter, motion), (job, motion)]) {
            let options = Options { motion: Some(motion), ..Options::default() };
            let output =
                compiled(input, &machine, &options).unwrap_or_else(|e| panic!("{}: {e:?}", motion.name));
            let read = || {
                (machine.dialect.read)(&output.text, SourceId::INPUT, &output.machine)
                    .expect("it reads")
                    .value
            };
            let check = |intent: &Intent, reading: &Reading| {
                verify(intent, reading, &output.text, SourceId::INPUT, &output.machine, output.tolerance)
            };
            check(&output.intent, &read()).expect("the sound program is proved");
            let is_curve = |curve: &Written| !matches!(curve, Written::Lines(_));
            let curve = read()
                .decimals
                .program
                .steps
                .iter()
                .any(|l| l.step.cut().is_some_and(|c| is_curve(&c.curve)));
            // Without the rapids of an axis, and without the approach, where the path is a step of its own behind it.
            for axis in [Some(0), Some(1), Some(2), None] {
                let (mut intent, mut reading) = (output.intent.clone(), read());
                match axis {
                    Some(axis) => {
                        intent.program.steps.retain(|l| !is_rapid_of(&l.step, axis));
                        reading.decimals.program.steps.retain(|l| !is_rapid_of(&l.step, axis));
                    }
                    None if curve => {
                        intent
                            .program
                            .steps
                            .retain(|l| l.step.cut().is_none_or(|cut| cut.role != Role::Approach));
                        reading
                            .decimals
                            .program
                            .steps
                            .retain(|l| l.step.cut().is_none_or(|c| is_curve(&c.curve)));
                    }
                    None => continue,
                }
                let refused = check(&intent, &reading).expect_err("nothing brings an axis");
                assert_eq!(refused.0[0].id, "start-unreached", "{} {axis:?}: {refused:?}", motion.name);
                kinds.insert((dialect.name, motion.name, axis));
            }
        }
    }
    // Lines of each dialect in three ways, and seven motions of curves in four.
    assert!(3 * 3 + 7 * 4 <= kinds.len(), "{kinds:?}");
}
