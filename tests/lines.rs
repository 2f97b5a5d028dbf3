//! Runs of short lines as splines: `--fit`.

use crate::support::{machine, sources};
use splinepost::diagnostic::Diagnostics;
use splinepost::dialect::{DIALECTS, Form};
use splinepost::verify::Status;
use splinepost::{Options, Output, compile, front};

/// A job of one run in X, Y and Z.
fn job(points: &[[f64; 3]]) -> String {
    let rows: Vec<String> =
        points.iter().map(|p| format!("[{:.5}, {:.5}, {:.5}]", p[0], p[1], p[2])).collect();
    format!(
        "name = \"RUN\"\ntolerance = 0.01\n[process]\nfeed = 1000.0\nretract = {{ axis = \"Z\", to = 50.0 }}\n\
         [[curve]]\nkind = \"points\"\naxes = [\"X\", \"Y\", \"Z\"]\npoints = [{}]\n",
        rows.join(", ")
    )
}

fn fitted(text: &str, dialect: &str, motion: Option<&str>) -> Result<Output, Diagnostics> {
    let machine = machine(&format!("extends = \"{dialect}\"\n"));
    let motion = motion.and_then(|name| machine.dialect.motion(name));
    let options = Options { motion, fit: true, ..Options::default() };
    let language = front::find("job").expect("jobs");
    compile(&sources(text), language, &machine, &options).map_err(|failure| failure.diagnostics)
}

/// A helix of radius 10 that rises, in steps of `spacing` mm, noise in each coordinate.
fn helix(spacing: f64, noise: f64) -> Vec<[f64; 3]> {
    let mut seed = 7u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        noise * ((seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0)
    };
    // A circle by turning (x, y) step by step, so that no platform's sine comes in: (1 − s², 2s)/(1 + s²).
    let s = 0.5 * spacing / 10.0;
    let (cos, sin) = ((1.0 - s * s) / (1.0 + s * s), 2.0 * s / (1.0 + s * s));
    let (mut x, mut y) = (10.0, 0.0);
    (0..(70.0 / spacing) as usize)
        .map(|i| {
            (x, y) = (x * cos - y * sin, x * sin + y * cos);
            [x + random(), y + random(), 0.05 * spacing * i as f64 + random()]
        })
        .collect()
}

#[test]
fn dense_points_take_ten_times_fewer_blocks_in_every_dialect() {
    // Three coordinates of 0.0028 are at most 0.0049 together, half the tolerance.
    for (spacing, noise) in [(0.1, 0.0), (0.1, 0.0028), (0.01, 0.0), (0.01, 0.0028)] {
        let points = helix(spacing, noise);
        let text = job(&points);
        for dialect in DIALECTS {
            let splines = dialect
                .motions
                .iter()
                .filter(|motion| matches!(motion.form, Form::Polynomial { .. } | Form::Nurbs));
            for motion in splines.map(|motion| Some(motion.name)).chain([None]) {
                let output = fitted(&text, dialect.name, motion)
                    .unwrap_or_else(|e| panic!("{} {motion:?} {spacing} {noise}: {e:?}", dialect.name));
                let report = output.report.expect("a report");
                assert!(report.status == Status::Proved && report.deviation.mm <= 0.01);
                assert!(
                    10 * report.path_blocks <= points.len(),
                    "{} {motion:?}: {} blocks of {}",
                    dialect.name,
                    report.path_blocks,
                    points.len()
                );
                assert!(output.motion.form != Form::Lines);
            }
        }
    }
}

#[test]
fn every_corner_of_a_pocket_is_kept() {
    let mut points = Vec::new();
    for row in 0..8 {
        let along = (0..=100).map(|i| 0.2 * f64::from(i));
        let xs: Vec<f64> = if row % 2 == 0 { along.collect() } else { along.rev().collect() };
        points.extend(xs.into_iter().map(|x| [x, 2.0 * f64::from(row), 0.0]));
    }
    let output = fitted(&job(&points), "sinumerik", Some("poly")).expect("it compiles");
    assert!(output.report.expect("a report").path_blocks <= 15, "{}", output.text);
    // Each corner is the end of a block: all words of its place stand in the text, in order.
    let mut rest = output.text.as_str();
    for row in 0..8 {
        let x = if row % 2 == 0 { "X20" } else { "X0" };
        let at = rest.find(&format!("{x} PL=1")).unwrap_or_else(|| panic!("row {row}: {}", output.text));
        rest = &rest[at + 1..];
    }
}

#[test]
fn lines_stay_lines_unless_asked() {
    let text = job(&helix(0.1, 0.0));
    let sinumerik = machine("extends = \"sinumerik\"\n");
    let output = crate::support::compiled(&text, &sinumerik, None).expect("it compiles");
    assert_eq!(output.motion.form, Form::Lines);
}
