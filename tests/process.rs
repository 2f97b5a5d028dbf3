//! What stands round the paths: axes that wrap, limits, directions, feeds.
#![allow(
    clippy::disallowed_methods,
    reason = "expected values come from functions that the crate does not use"
)]

use crate::support::{compiled, input, machine, machines};
use splinepost::diagnostic::Diagnostics;
use splinepost::dialect::{DIALECTS, Form};
use splinepost::machine::Machine;
use splinepost::verify::Status;

const PAPER: &str = "D1 = 10\nS = 30\nC = 5\nr = 8\nlength = 30\nflutes = 4";

fn ids(errors: &Diagnostics) -> Vec<&'static str> {
    errors.0.iter().map(|d| d.id).collect()
}

fn with(machine: &Machine, keys: &str) -> Machine {
    let name = machine.dialect.name;
    self::machine(&format!(
        "extends = \"{name}\"\nname = \"{name}\"\n[spline]\naxes = [\"X\", \"Y\", \"Z\", \"A\"]\n{keys}"
    ))
}

/// Every number behind A in the moves of a program; work offsets are none.
fn angles(text: &str) -> Vec<f64> {
    let offsets = ["TRANS", "CYCL DEF", "G52"];
    let moves = text.lines().filter(|line| !offsets.iter().any(|word| line.contains(word)));
    let number = |word: &str| {
        let value =
            word.strip_prefix("A=DC(").and_then(|rest| rest.strip_suffix(')')).or(word.strip_prefix('A'));
        value?.parse().ok()
    };
    moves.flat_map(str::split_whitespace).filter_map(number).collect()
}

/// 270° + 159° passes 360°, S = 60 over 200 mm turns several times: right on an axis that wraps, or refused with the
/// reason; and right on one that counts on.
#[test]
fn turns_past_360_degrees_are_right_or_refused() {
    let cutters = [
        ("the paper's", PAPER, false),
        ("left hand", "D1 = 10\nS = 30\nC = 5\nr = 8\nlength = 30\nflutes = 4\nhand = \"left\"", false),
        ("several turns", "D1 = 10\nS = 60\nC = 2\nr = 8\nlength = 200\nflutes = 2", true),
        ("a cylinder of several turns", "D1 = 10\nS = 45\nC = 0\nr = 8\nlength = 100", true),
    ];
    let mut refused = 0;
    for machine in machines() {
        for kind in ["linear", "modulo"] {
            let machine = with(&machine, &format!("[axis.A]\nkind = \"{kind}\"\n"));
            for (name, cutter, winds) in cutters {
                let motions = machine.dialect.motions.iter().map(Some).chain([None]);
                for motion in motions {
                    let what = format!("{name}, {}, {kind}, {:?}", machine.name, motion.map(|m| m.name));
                    let result = compiled(&input(cutter, "tolerance = 0.01"), &machine, motion);
                    let lines = motion.is_none_or(|motion| motion.form == Form::Lines);
                    match result {
                        Ok(output) => {
                            let status = output.report.expect("a report").status;
                            let through = matches!(output.motion.form, Form::Through(_));
                            assert_eq!(status == Status::PointsOnly, through, "{what}");
                            if kind == "modulo" {
                                assert!(!winds || lines, "{what} is no spline");
                                let outside =
                                    angles(&output.text).into_iter().find(|a| !(0.0..=360.0).contains(a));
                                assert_eq!(outside, None, "{what}");
                            }
                        }
                        Err(errors) => {
                            assert!(kind == "modulo" && winds && !lines, "{what}: {errors:?}");
                            assert_eq!(ids(&errors), ["rotary-wraps"], "{what}");
                            refused += 1;
                        }
                    }
                }
            }
        }
    }
    assert!(0 < refused);
}

/// a = (F/c)² |A″|, greatest at X = 0 where A″ = 2 a₂/30² of the block POLY … PO[A]=(159.540524,-51.998729,…) over
/// 30 mm; F = 200 mm/min, c² = 1 + tan²C (1 + sin²r).
#[test]
fn an_acceleration_that_the_axis_lacks_is_refused() {
    let (tan_c, sin_r) = ((5.0f64).to_radians().tan(), (8.0f64).to_radians().sin());
    let c2 = 1.0 + tan_c * tan_c * (1.0 + sin_r * sin_r);
    let found = (200.0f64 / 60.0).powi(2) / c2 * 2.0 * 51.998_729 / 900.0;
    let sinumerik = Machine::built_in("sinumerik").expect("built in");
    let limited = |most: f64| with(&sinumerik, &format!("[axis.A]\nmax_acceleration = {most}\n"));
    let compile = |most: f64| compiled(&input(PAPER, ""), &limited(most), None);
    // The bound is never too low, and on a 32nd of the path no more than a tenth too high.
    assert!(ids(&compile(0.999 * found).expect_err("too fast")).contains(&"axis-acceleration"));
    assert!(compile(1.1 * found).is_ok());
}

/// From D1 or to D1 the flute is the same, and so is its proof.
#[test]
fn a_path_may_be_run_from_either_end() {
    for machine in machines() {
        for motion in machine.dialect.motions {
            let text = |travel: &str| {
                let input = input(PAPER, "").replace(
                    "[process]",
                    &format!("[process]\ntravel = \"{travel}\"\nrun_in = 1.5\nrun_out = 0.5"),
                );
                compiled(&input, &machine, Some(motion)).unwrap_or_else(|e| panic!("{}: {e:?}", motion.name))
            };
            let (from, to) = (text("from-D1"), text("to-D1"));
            let figures = [&from, &to].map(|output| {
                let report = output.report.as_ref().expect("a report");
                let x = output.setup.axes[0].range.expect("X moves");
                (report.path_blocks, x)
            });
            assert_eq!(figures[0].0, figures[1].0, "{}", motion.name);
            assert_eq!(figures.map(|f| f.1), [[-1.5, 30.5], [-0.5, 31.5]], "{}", motion.name);
        }
    }
}

/// Along the edge the speed is c/√(c² + tan²S) of that along X Y Z, along X 1/c, and along A 1/|dA/dX|.
#[test]
fn feeds_are_along_what_was_asked() {
    let minutes = |along: &str, feed: f64| {
        let input =
            input(PAPER, "").replace("feed = 200", &format!("feed = {feed}\nfeed_along = \"{along}\""));
        DIALECTS
            .iter()
            .map(move |dialect| {
                let machine = with(&Machine::built_in(dialect.name).expect("built in"), "");
                compiled(&input, &machine, None).expect("it compiles").report.expect("a report").minutes
            })
            .collect::<Vec<f64>>()
    };
    let (s, c, r) = ((30.0f64).to_radians(), (5.0f64).to_radians(), (8.0f64).to_radians());
    let path = (1.0 + c.tan().powi(2) * (1.0 + r.sin().powi(2))).sqrt();
    let turn = (s.tan() / c.tan() * (1.0 + 60.0 * c.tan() / 10.0).ln()).to_degrees();
    let flutes = 4.0;
    for (along, feed, asked) in [
        ("path", 200.0, flutes * 30.0 * path / 200.0),
        ("edge", 200.0, flutes * 30.0 * (path * path + s.tan().powi(2)).sqrt() / 200.0),
        ("X", 200.0, flutes * 30.0 / 200.0),
        ("A", 720.0, flutes * turn / 720.0),
    ] {
        for minutes in minutes(along, feed) {
            // F is rounded to 0.001 of some hundreds, positions to 0.0001 of some millimetres.
            approx::assert_relative_eq!(minutes, asked, max_relative = 1.0e-4);
        }
    }
}

/// Under inverse time every line has its time: the whole is what was asked, from either end and by either method.
#[test]
fn lines_in_inverse_time_take_what_was_asked() {
    let machine = machine("extends = \"mazak\"\n[feed]\nrotary = \"inverse-time\"\n");
    for interpolation in ["", "method = \"direct\"", "method = \"odd-even\"\ndl = 1.0\ntolerance = 0.01"] {
        for travel in ["from-D1", "to-D1"] {
            let input = input(PAPER, interpolation)
                .replace("[process]", &format!("[process]\ntravel = \"{travel}\""));
            let output =
                compiled(&input, &machine, None).unwrap_or_else(|e| panic!("{interpolation}: {e:?}"));
            let report = output.report.expect("a report");
            let asked = report.cutting_length / 200.0;
            // F is rounded to 0.001 of some hundreds; Simpson's rule is right to some 1e-8 on lines of a millimetre.
            approx::assert_relative_eq!(report.minutes, asked, max_relative = 1.0e-5);
            let lines = output
                .text
                .lines()
                .skip_while(|line| !line.contains("G93"))
                .take_while(|line| !line.contains("G0"));
            assert!(lines.clone().all(|line| line.contains(" F")), "{interpolation}");
            assert!(0 < lines.count());
        }
    }
    let spline = machine.dialect.motion("g06.2");
    assert_eq!(
        ids(&compiled(&input(PAPER, ""), &machine, spline).expect_err("no time")),
        ["inverse-time-lines"]
    );
}

/// A control that counts A the other way, and calls its axes otherwise, makes the same path.
#[test]
fn axes_have_other_names_and_signs() {
    for dialect in DIALECTS {
        let header = if dialect.name == "heidenhain" {
            "BEGIN PGM {name} MM"
        } else if dialect.name == "mazak" {
            "({name})"
        } else {
            "; {name}"
        };
        let names =
            if dialect.name == "heidenhain" { "\"U\", \"V\", \"W\"" } else { "\"X1\", \"Y1\", \"Z1\"" };
        let file = format!(
            "extends = \"{0}\"\nname = \"other\"\n[axes]\nlinear = [{names}]\nrotary = [\"C\"]\ncutter = [{names}, \"C\"]\n\
             [axis.C]\nsign = -1\n[spline]\naxes = [{names}, \"C\"]\n[program]\nheader = [\"{header}\"]\n",
            dialect.name
        );
        let other = machine(&file);
        let usual = with(&Machine::built_in(dialect.name).expect("built in"), "");
        for motion in dialect.motions {
            let [other, usual] = [&other, &usual].map(|machine| {
                compiled(&input(PAPER, ""), machine, Some(motion))
                    .unwrap_or_else(|e| panic!("{}: {e:?}", motion.name))
            });
            let report = [&other, &usual].map(|output| output.report.clone().expect("a report"));
            assert_eq!(report[0].deviation, report[1].deviation, "{}", motion.name);
            assert!(other.text.contains("C-270") || other.text.contains("C=-270"), "{}", motion.name);
        }
    }
}
