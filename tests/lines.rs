//! Runs of short lines as splines: `--fit`.

use crate::support::{machine, sources};
use splinepost::diagnostic::Diagnostics;
use splinepost::dialect::{DIALECTS, Form};
use splinepost::verify::Status;
use splinepost::{Options, Output, compile, front};
use std::fmt::Write as _;

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

/// Numbers from −1 to 1.
fn random() -> impl FnMut() -> f64 {
    let mut seed = 11u64;
    move || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// Points each `spacing` mm on the lines between corners, the corners among them, each coordinate off by up to `noise`.
fn sampled(corners: &[[f64; 2]], spacing: f64, noise: f64) -> Vec<[f64; 3]> {
    let mut random = random();
    let mut points = vec![[corners[0][0], corners[0][1], 0.0]];
    for pair in corners.windows(2) {
        let d = [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]];
        let n = ((d[0] * d[0] + d[1] * d[1]).sqrt() / spacing).round() as usize;
        points.extend((1..=n).map(|k| {
            let share = k as f64 / n as f64;
            [pair[0][0] + share * d[0], pair[0][1] + share * d[1], 0.0]
        }));
    }
    for point in &mut points[1..] {
        *point = point.map(|x| x + noise * random());
    }
    points
}

/// CL data of one run at one feed.
fn cl_data(points: &[[f64; 3]]) -> String {
    let mut text = format!(
        "PARTNO RUN\nUNITS/MM\nLOADTL/1\nSPINDL/RPM,9000,CLW\nRAPID\nGOTO/{:.5},{:.5},{:.5}\nFEDRAT/400.0,MMPM\n",
        points[0][0], points[0][1], points[0][2]
    );
    for point in &points[1..] {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "GOTO/{:.5},{:.5},{:.5}", point[0], point[1], point[2]);
    }
    text.push_str("FINI\n");
    text
}

fn fitted_cl_data(text: &str, dialect: &str, tolerance: f64, corner: Option<f64>) -> Output {
    let machine = machine(&format!("extends = \"{dialect}\"\n"));
    let options = Options { fit: true, corner, tolerance: Some(tolerance), ..Options::default() };
    let language = front::find("apt").expect("CL data");
    compile(&sources(text), language, &machine, &options).unwrap_or_else(|e| panic!("{:?}", e.diagnostics))
}

#[test]
fn noise_moves_no_corner_of_a_zigzag_or_a_pocket() {
    let zigzag: Vec<[f64; 2]> =
        (0..=6).map(|k| [10.0 * f64::from(k), if k % 2 == 0 { 0.0 } else { 17.0 }]).collect();
    let pocket: Vec<[f64; 2]> = (0..4)
        .flat_map(|k| {
            let o = 2.0 * f64::from(k);
            [[o, o], [30.0 - o, o], [30.0 - o, 20.0 - o], [o, 20.0 - o], [o, o + 2.0]]
        })
        .collect();
    // An end of a ring is the start of the next one.
    let pocket: Vec<[f64; 2]> = pocket.iter().copied().filter(|p| p[0] + 2.0 > p[1] || p[1] > 8.0).collect();
    // 0.0028 in each coordinate is 0.0049 in all, half the tolerance.
    for corners in [zigzag, pocket] {
        for (spacing, noise) in [(1.0, 0.0028), (0.1, 0.0), (0.1, 0.0028), (0.01, 0.0), (0.01, 0.0028)] {
            let points = sampled(&corners, spacing, noise);
            let output = fitted_cl_data(&cl_data(&points), "sinumerik", 0.01, None);
            let splined = output.report.as_ref().and_then(|report| report.splined.clone()).expect("splines");
            let inner = corners
                .windows(3)
                .filter(|w| {
                    let [a, b, c] = [w[0], w[1], w[2]];
                    ((b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])).abs() > 1.0e-9
                })
                .count();
            assert_eq!(splined.corners, inner, "{spacing} {noise}");
            assert_eq!(
                splined.blocks,
                inner + 1,
                "a block for each line: {spacing} {noise}\n{}",
                output.text
            );
            assert!(
                splined.from_points <= splined.from_lines + 1.0e-9,
                "{spacing} {noise}: {} and {}",
                splined.from_points,
                splined.from_lines
            );
        }
    }
}

#[test]
fn what_was_gained_is_told_both_ways() {
    let points = helix(0.1, 0.0028);
    for dialect in DIALECTS {
        let output = fitted_cl_data(&cl_data(&points), dialect.name, 0.01, None);
        let report = output.report.as_ref().expect("a report");
        let splined = report.splined.as_ref().expect("splines");
        // The first point is where the rapid ends.
        assert_eq!((splined.steps.len(), splined.lines, splined.corners), (1, points.len() - 1, 0));
        assert_eq!(splined.blocks, report.path_blocks);
        // Of 700 points with noise some are as far off as half of it, and none is farther than the lines are.
        assert!((0.0025..=0.01).contains(&splined.from_points), "{}", splined.from_points);
        assert!(splined.from_points <= splined.from_lines + 1.0e-9);
        // Three points in a row, 0.1 apart, the middle one off by 0.0056 to one side: a circle of radius 0.9. The helix of
        // radius 10 and slope 0.05 has the curvature 0.1/(1 + 0.05²), and its spline no more than a fifth above.
        assert!((0.3..2.0).contains(&splined.curvature_before), "{}", splined.curvature_before);
        assert!((0.09..0.12).contains(&splined.curvature_after), "{}", splined.curvature_after);
        let summary = splinepost::summary::Summary::new(
            &output.intent,
            &machine(&format!("extends = \"{}\"\n", dialect.name)),
            Some(output.motion.name),
            &output.text,
            Some(report),
            output.tolerance,
            output.setup.clone(),
        );
        assert!(summary.render().contains("1 run of 699 lines in"), "{}", summary.render());
        for key in ["spline_from_lines_mm", "points_from_spline_mm", "curvature_before", "curvature_after"] {
            assert!(summary.to_json().contains(key), "{key}");
        }
    }
}

#[test]
fn runs_end_at_rapids_feeds_and_tools() {
    let points = helix(0.1, 0.0);
    let line = |p: &[f64; 3]| format!("GOTO/{:.5},{:.5},{:.5}\n", p[0], p[1], p[2]);
    let rows = |range: std::ops::Range<usize>| points[range].iter().map(line).collect::<String>();
    for (between, comes_back) in [
        ("FEDRAT/300.0,MMPM\n", false),
        ("RAPID\nGOTO/0.0,0.0,60.0\n", true),
        ("RAPID\nGOTO/0.0,0.0,60.0\nLOADTL/2\nSPINDL/RPM,9000,CLW\n", true),
    ] {
        let back = if comes_back {
            format!("RAPID\n{}FEDRAT/400.0,MMPM\n", line(&points[300]))
        } else {
            String::new()
        };
        let text = format!(
            "PARTNO RUN\nUNITS/MM\nLOADTL/1\nSPINDL/RPM,9000,CLW\nRAPID\n{}FEDRAT/400.0,MMPM\n{}{between}{back}{}FINI\n",
            line(&points[0]),
            rows(1..301),
            rows(301..600)
        );
        let output = fitted_cl_data(&text, "heidenhain", 0.01, None);
        let splined = output.report.and_then(|report| report.splined).expect("splines");
        assert_eq!((splined.steps.len(), splined.lines), (2, 599), "{between}");
    }
}

#[test]
fn a_corner_is_what_the_user_says() {
    // A polygon of forty sides, each turn 9 degrees.
    let corners: Vec<[f64; 2]> = {
        let (s, mut d, mut p) = (0.0787, [5.0, 0.0], [0.0, 0.0]);
        let (cos, sin) = ((1.0 - s * s) / (1.0 + s * s), 2.0 * s / (1.0 + s * s));
        std::iter::once(p)
            .chain((0..40).map(|_| {
                p = [p[0] + d[0], p[1] + d[1]];
                d = [d[0] * cos - d[1] * sin, d[0] * sin + d[1] * cos];
                p
            }))
            .collect()
    };
    let text = cl_data(&sampled(&corners, 0.1, 0.0));
    // A turn of 9 degrees is rounded within 0.1 mm over some 5 mm.
    let count = |corner| {
        let output = fitted_cl_data(&text, "sinumerik", 0.1, corner);
        output.report.and_then(|report| report.splined).map(|splined| splined.corners)
    };
    assert_eq!(count(Some(5.0)), Some(39));
    assert_eq!(count(None), Some(0));
}

/// Waves near ends and corners: a line, a quarter circle, a line, a corner, and a quarter circle again.
#[test]
fn splines_do_not_wave_at_ends_or_corners() {
    use splinepost::geom::smooth::{CORNER, Fitting, Part, parts};
    let mut points: Vec<[f64; 6]> = Vec::new();
    let step = 0.1;
    let place = |x: f64, y: f64| [x, y, 0.0, 0.0, 0.0, 0.0];
    points.extend((0..100).map(|k| place(step * f64::from(k), 0.0)));
    // A quarter of radius 5 in eighty steps, so that it ends in the direction of the next line.
    let arc = |points: &mut Vec<[f64; 6]>, center: [f64; 2], r: [f64; 2]| {
        use splinepost::geom::elementary::{cos, sin};
        let at = |k: i32| {
            let angle = f64::from(k) * std::f64::consts::FRAC_PI_2 / 80.0;
            let (cos, sin) = (cos(angle), sin(angle));
            [center[0] + r[0] * cos - r[1] * sin, center[1] + r[0] * sin + r[1] * cos]
        };
        points.extend((0..80).map(|k| place(at(k)[0], at(k)[1])));
        at(80)
    };
    let end = arc(&mut points, [10.0, 5.0], [0.0, -5.0]);
    points.extend((0..=100).map(|k| place(end[0], end[1] + step * f64::from(k))));
    let corner = points[points.len() - 1];
    arc(&mut points, [corner[0], corner[1] - 5.0], [0.0, 5.0]);
    for (tolerance, noise) in [(0.01, 0.0), (0.001, 0.0), (0.01, 0.0035), (0.001, 0.00035)] {
        let mut random = random();
        let mut own = points.clone();
        for p in &mut own {
            *p = place(p[0] + noise * random(), p[1] + noise * random());
        }
        let parts = parts(&own, Fitting { tolerance, corner: CORNER }).expect("splines");
        let [Part::Spline(fitted, _)] = &parts[..] else { panic!("{tolerance} {noise}: {parts:?}") };
        // Signed curvature along the spline: lines have none, arcs 0.2. That of a C2 cubic is continuous and about linear in
        // each span, and swings beside a step by no more than 2 − √3 of it, the ratio in which what a knot does to the
        // next one fades in least squares.
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for (piece, _) in fitted.beziers() {
            for k in 0..=20 {
                let [_, d, dd] = piece.derivatives(f64::from(k) / 20.0);
                let speed = (d[0] * d[0] + d[1] * d[1]).sqrt();
                let curvature = (d[0] * dd[1] - d[1] * dd[0]) / (speed * speed * speed);
                (least, most) = (f64::min(least, curvature), f64::max(most, curvature));
            }
        }
        println!("{tolerance} {noise}: {} pieces, {least:.4} to {most:.4}", fitted.beziers().count());
        let swing = 0.2 * (2.0 - 3.0f64.sqrt());
        assert!(-swing < least && most < 0.2 + swing, "{tolerance} {noise}: {least} to {most}");
    }
}
