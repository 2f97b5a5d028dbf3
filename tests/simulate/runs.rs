//! Times against their closed forms, limits at every cycle, and `splinepost simulate` as a user meets it.

use crate::support::{CUTTERS, compiled, folder, input, machine};
use approx::assert_relative_eq;
use splinepost::geom::bezier::Bezier;
use splinepost::geom::elementary::atan;
use splinepost::machine::Machine;
use splinepost::simulate::limits::{Limits, trapezoid};
use splinepost::simulate::partition::{Cycles, Law, Method, Piece, Weights};
use splinepost::simulate::report::Summary;
use splinepost::simulate::shape::Shape;
use splinepost::simulate::track::{Setting, Track};
use splinepost::simulate::{Options, Row, simulate};
use splinepost::source::SourceId;
use splinepost::units::Position;
use std::process::{Command, Output};

const CYCLE: f64 = 1e-3;

const LAW: Law = Law { method: Method::Secant, cycle: CYCLE, tolerance: 1e-8 };

/// A machine that has limits on every axis.
const LIMITED: &str = "extends = \"sinumerik\"\n\
    [axis.X]\nmax_speed = 9000\nmax_acceleration = 2000\nmax_step = 60\n\
    [axis.Y]\nmax_speed = 9000\nmax_acceleration = 2000\nmax_step = 60\n\
    [axis.Z]\nmax_speed = 6000\nmax_acceleration = 1000\nmax_step = 30\n\
    [axis.A]\nmax_speed = 14400\nmax_acceleration = 1500\nmax_step = 120\n";

/// Runs a program for a machine.
fn run(text: &str, machine: &Machine, feed: Option<f64>) -> (Vec<Row>, Summary) {
    let reading = (machine.dialect.read)(text, SourceId::INPUT, machine).unwrap_or_else(|e| panic!("{e:?}"));
    let setting = Setting { machine: Some(machine), feed, tolerance: 0.001, ..Setting::default() };
    let track = Track::of_decimals(&reading.value.decimals, &setting).unwrap_or_else(|e| panic!("{e:?}"));
    let limits = Limits::of(machine, &track.axes, CYCLE);
    let options = Options { law: LAW, limits, block_time: machine.block_time, tolerance: 0.001 };
    let mut rows = Vec::new();
    let summary = simulate(&track, &options, &mut |row| rows.push(*row)).unwrap_or_else(|e| panic!("{e:?}"));
    (rows, summary)
}

#[test]
fn a_line_takes_its_length_over_its_feed() {
    let program = "G0 X0 Y0 Z0 A0\nG1 X30 Y40 F6000\n";
    let (rows, summary) = run(program, &machine("extends = \"sinumerik\"\n"), None);
    assert_relative_eq!(summary.feed_time, 0.5, max_relative = 1e-12);
    assert_eq!((summary.cycles, rows.len(), summary.rapids_without_time), (500, 501, 1));
}

#[test]
fn a_full_trapezoid_takes_its_time_and_so_do_rapids() {
    // X at 90 mm/s, of the limits a thousandth is kept in hand: 50/90 + 90/1998 s. Z at rapid to 30 mm:
    // 30/100 + 100/1000 s; the first rapid starts who knows where.
    let program = "G0 X0 Y0 Z0 A0\nG0 Z30\nG1 X50 F5400\n";
    let (_, summary) = run(program, &machine(LIMITED), None);
    assert_relative_eq!(summary.feed_time, 50.0 / 90.0 + 90.0 / 1998.0, max_relative = 1e-12);
    assert_relative_eq!(summary.rapid_time, trapezoid(30.0, 100.0, 1000.0), max_relative = 1e-12);
    assert_relative_eq!(summary.rapid_time, 0.4, max_relative = 1e-12);
    assert_eq!(summary.rapids_without_time, 1);
    assert_relative_eq!(summary.time, summary.feed_time + summary.rapid_time);
}

/// A quarter of a circle of 20 mm as a rational quadratic: weights 1, √½, 1.
fn quarter() -> [Piece<Shape>; 1] {
    let at = |x: f64, y: f64| [x, y, 0.0, 0.0, 0.0, 0.0];
    let mut arc = Bezier::new(&[at(20.0, 0.0), at(20.0, 20.0), at(0.0, 20.0)]);
    arc.weights[1] = 0.5f64.sqrt();
    let counts = Weights([1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
    [Piece { curve: Shape::bezier(&arc), from: 0.0, to: 1.0, feed: 100.0, counts, surface: counts }]
}

#[test]
fn an_arc_takes_as_long_as_its_chords() {
    // Each cycle turns by 2 asin(F·T/2R), the last chord by what is left of a right angle.
    let (r, half) = (20.0f64, 0.05);
    let turn = 2.0 * atan(half / (r * r - half * half).sqrt());
    let right = std::f64::consts::FRAC_PI_2;
    let full = (right / turn).floor();
    let rest = right - full * turn;
    let last = 2.0 * r * splinepost::geom::elementary::sin(0.5 * rest) / 100.0;
    let cycles: Vec<_> = Cycles::new(&quarter(), LAW).collect();
    assert_eq!(cycles.len(), full as usize + 1);
    // A target is right to 1e-8 of a chord, and 314 of them add up.
    assert_relative_eq!(
        cycles.iter().map(|c| c.time).sum::<f64>(),
        full * CYCLE + last,
        epsilon = 1e-3 * 1e-8 * 314.0
    );
}

#[test]
fn an_arc_within_limits_takes_its_length_over_its_feed() {
    let mut limits = Limits::NONE;
    limits.speed[0] = 200.0;
    let time: f64 =
        splinepost::simulate::planned::Planned::new(&quarter(), &limits, LAW).map(|c| c.time).sum();
    assert_relative_eq!(time, std::f64::consts::FRAC_PI_2 * 20.0 / 100.0, max_relative = 1e-10);
}

/// Positions at equal times, one list a run, with the piece of each.
fn runs(rows: &[Row]) -> Vec<Vec<(usize, Position)>> {
    let mut runs: Vec<Vec<(usize, Position)>> = Vec::new();
    for row in rows {
        if row.time == 0.0 {
            // They stood before.
            runs.push(vec![(row.piece, row.at)]);
        }
        if let Some(run) = runs.last_mut() {
            run.push((row.piece, row.at));
        }
    }
    for run in &mut runs {
        // They stand behind.
        let last = run[run.len() - 1];
        run.extend([last; 2]);
    }
    runs
}

#[test]
fn limits_hold_at_every_cycle_of_every_motion() {
    // The compiler would refuse what is too fast for an axis, so it compiles for a machine without limits.
    let (machine, free) = (machine(LIMITED), machine("extends = \"sinumerik\"\n"));
    let limits = Limits::of(&machine, &machine.axes, CYCLE);
    let mut near = 0.0f64;
    for (name, cutter) in CUTTERS {
        for motion in ["poly", "bspline", "linear", "aspline"] {
            let asked = free.dialect.motion(motion);
            let output = compiled(&input(cutter, "tolerance = 0.01"), &free, asked);
            let output = output.unwrap_or_else(|e| panic!("{name} {motion}: {e:?}"));
            let (rows, _) = run(&output.text, &machine, Some(6000.0));
            for points in runs(&rows) {
                for w in points.windows(3) {
                    let joint = w[0].0 != w[2].0;
                    for axis in 0..4 {
                        let before = (w[1].1[axis] - w[0].1[axis]) / CYCLE;
                        let after = (w[2].1[axis] - w[1].1[axis]) / CYCLE;
                        let step = if joint { limits.step[axis] } else { 0.0 };
                        let allowed = limits.acceleration[axis] * CYCLE + step;
                        let change = (after - before).abs();
                        assert!(after.abs() <= limits.speed[axis], "{name} {motion}: axis {axis} at {after}");
                        assert!(change <= allowed, "{name} {motion}: axis {axis} by {change}");
                        near = near.max(change / (limits.acceleration[axis] * CYCLE));
                    }
                }
            }
        }
    }
    assert!(0.99 < near, "the limits were never met, only {near}");
}

fn splinepost(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_splinepost"))
        .args(arguments)
        .current_dir(folder(""))
        .output()
        .expect("it runs")
}

fn out(output: &Output) -> String {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout.clone()).expect("UTF-8")
}

#[test]
fn rows_have_the_header_and_the_same_bytes() {
    let arguments =
        ["simulate", "fixtures/compile/conical-mill/input.toml", "--feed", "6000", "--cycle", "2ms"];
    let text = out(&splinepost(&arguments));
    assert_eq!(text.lines().next(), Some("n,t,u,X,Y,Z,A_deg,chord,feed_error,chord_error"));
    assert_eq!(text, out(&splinepost(&arguments)));
    // 6 m/min and 2 ms.
    let second: Vec<f64> =
        text.lines().nth(2).expect("a row").split(',').map(|x| x.parse().expect("a number")).collect();
    assert_relative_eq!(second[7], 0.2, max_relative = 1e-8);
    let json = out(&splinepost(&[&arguments[..], &["--format", "json"]].concat()));
    let rows: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(rows.as_array().expect("an array").len() + 1, text.lines().count());
    assert_eq!(rows[1]["A_deg"], 0.0);
}

#[test]
fn methods_differ_as_the_paper_says() {
    let error = |method: &str| {
        let arguments =
            ["--message-format", "json", "simulate", "fixtures/compile/conical-mill/mazak-g062.eia"];
        let machine = "fixtures/compile/conical-mill/mazak-g062.machine.toml";
        let more = ["--to", machine, "--feed", "6000", "--method", method];
        let output = splinepost(&[&arguments[..], &more].concat());
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        let summary: serde_json::Value =
            serde_json::from_str(told.lines().last().expect("a line")).expect("JSON");
        summary["simulation"]["feed_error"]["value"].as_f64().expect("a number")
    };
    assert!(error("secant") <= 1e-8 && error("bisection") <= 1e-8);
    assert!(1e-6 < error("taylor"));
}

#[test]
fn a_starved_control_is_told_with_a_way_out() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("slow.toml");
    std::fs::write(&path, "extends = \"sinumerik\"\n[feed]\nblock_time = 6\n").expect("written");
    let program = "fixtures/compile/odd-even-steps/sinumerik-linear.mpf";
    let output = splinepost(&["simulate", program, "--to", path.to_str().expect("UTF-8"), "--feed", "6000"]);
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    // The sixteen steps behind the plunge are short, which are the last before the retract.
    let text = std::fs::read_to_string(program).expect("the program");
    let plunge = 1 + text.lines().position(|line| line.contains(" G1 Z0")).expect("a plunge");
    let lines = format!("lines {} to {}", plunge + 1, plunge + 16);
    for words in
        ["control's 6 ms a block", &lines, "of the feed", "--fit", "1 cubic block of", "at full feed"]
    {
        assert!(told.contains(words), "{words} is not in\n{told}");
    }
}

#[test]
fn what_cannot_be_run_is_told() {
    let dir = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| {
        let path = dir.path().join(name);
        std::fs::write(&path, text).expect("written");
        path.display().to_string()
    };
    let no_feed = write("a.toml", "[cutter]\nD1 = 10\nS = 30\nC = 5\nr = 8\nlength = 30\n");
    let empty = write("b.mpf", "G0 X1\n");
    let mill = "fixtures/compile/conical-mill/input.toml";
    let cases: &[(&[&str], &str, i32)] = &[
        (&[&no_feed], "feed-missing", 2),
        (&[&empty, "--to", "sinumerik"], "path-missing", 2),
        (&[mill, "--cycle", "0.000001ms", "--feed", "0.001"], "cycles-too-many", 1),
        (&[mill, "--cycle", "0"], "time greater than zero", 2),
        (&[mill, "--cycle", "1h"], "time greater than zero", 2),
        (&[mill, "--feed", "-3"], "", 2),
        (&[mill, "--method", "newton"], "bisection", 2),
        (&["none.mpf", "--to", "sinumerik"], "file-unreadable", 2),
    ];
    for (arguments, word, code) in cases {
        let output = splinepost(&[&["simulate"], *arguments].concat());
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(*code), "{arguments:?}: {told}");
        assert!(told.contains(word) && output.stdout.is_empty(), "{arguments:?}: {told}");
    }
    // Flutes alone are enough where a feed is said.
    out(&splinepost(&["simulate", &no_feed, "--feed", "6000"]));
}

#[test]
fn a_job_of_expressions_is_run_as_it_is() {
    let job = "fixtures/compile/lissajous/input.toml";
    let output = splinepost(&["--message-format", "json", "simulate", job]);
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    let summary: serde_json::Value =
        serde_json::from_str(told.lines().last().expect("a line")).expect("JSON");
    let worst = |name: &str| summary["simulation"][name]["value"].as_f64().expect("a number");
    // The figures of the paper; the radius of curvature is 3.58 mm at least.
    assert!(worst("feed_error") <= 1e-8 && worst("chord_error") <= 1e-6);
    assert!(0.01 / (8.0 * 3.7) * 1e-3 < worst("chord_error"));
    // Its last point is its start again, one turn of A later.
    let text = out(&output);
    let last: Vec<f64> =
        text.lines().last().expect("a row").split(',').map(|x| x.parse().expect("a number")).collect();
    assert_relative_eq!(last[3], 30.0, epsilon = 1e-12);
    assert_relative_eq!(last[6], 360.0, epsilon = 1e-12);
}

#[test]
fn points_of_expressions_are_told_with_their_bound() {
    let job = "fixtures/compile/lissajous/input.toml";
    let coarse = splinepost(&["interpolate", job, "--tolerance", "0.1", "--format", "csv"]);
    let told = String::from_utf8_lossy(&coarse.stderr).into_owned();
    assert!(out(&coarse).starts_with("n,curve,X,Y,Z,A_deg\n0,1,30.0,0.0,-2.0,0.0\n"));
    assert!(told.contains("proved"), "{told}");
    let json = out(&splinepost(&["interpolate", job, "--method", "direct", "--format", "json"]));
    let points: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert!(points["deviation"].as_f64().expect("a number") <= 1e-3);
    let refused = splinepost(&["interpolate", job, "--method", "odd-even"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("method-of-cutters-only"));
}

#[test]
fn a_program_that_carries_the_remarks_of_its_cl_data_is_run_as_a_program() {
    for (program, machine) in
        [("sinumerik.mpf", "sinumerik"), ("heidenhain.h", "heidenhain"), ("mazak.eia", "mazak")]
    {
        let program = format!("fixtures/apt/catia-arcs/{program}");
        let output = splinepost(&["simulate", &program, "--to", machine]);
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(0), "{told}");
        // Its A is never moved, so that nothing depends on where it stands.
        assert!(!told.contains("start-unknown"), "{told}");
    }
}

#[test]
fn every_golden_program_is_run_as_it_stands() {
    let mut run = 0;
    for case in std::fs::read_dir(folder("fixtures/compile")).expect("fixtures/compile").flatten() {
        for file in std::fs::read_dir(case.path()).expect("a case").flatten() {
            let path = file.path();
            let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
            // Inputs and the curve files that they name are no programs.
            let inputs = ["toml", "dxf", "igs", "stp"];
            if path.extension().is_some_and(|extension| inputs.iter().any(|known| extension == *known)) {
                continue;
            }
            let own = path.with_file_name(format!("{name}.machine.toml"));
            let machine = if own.exists() { own.display().to_string() } else { name };
            let program = path.display().to_string();
            let output = splinepost(&["simulate", &program, "--to", &machine, "--cycle", "10ms"]);
            let told = String::from_utf8_lossy(&output.stderr).into_owned();
            assert_eq!(output.status.code(), Some(0), "{program}: {told}");
            run += 1;
        }
    }
    assert!(0 < run, "there is no program");
}
