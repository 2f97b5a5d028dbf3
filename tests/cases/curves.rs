//! Curve files: each of `fixtures/cases/curves` and `fixtures/cases/inserts` has its right length and reach, or its refusal.
//!
//! Lengths are closed forms where there is one, E being the complete elliptic integral of the second kind, and otherwise
//! integrals of the speed that a program apart from this project made of the raw numbers of the file: de Boor's recursion in
//! 25 digits, Gauss' rule on eighths of the spans.

use crate::support::{compiled_from, folder, sources_in};
use splinepost::diagnostic::Severity;
use splinepost::front::curves::{FileCurve, Path, format_of, read};
use splinepost::geom::bezier::Bezier;
use splinepost::machine::{BUILT_IN, Machine};
use splinepost::simulate::partition::Parametric;
use splinepost::simulate::track::{Setting, Track};
use splinepost::source::{Source, SourceId};

/// What becomes of a file.
enum Answer {
    /// The length of its paths, mm, where X and Y go, and the ids of what is told.
    Path(f64, [[f64; 2]; 2], &'static [&'static str]),
    /// The ids of errors.
    Refused(&'static [&'static str]),
}

use Answer::{Path as Runs, Refused};

const TURN: f64 = 2.0 * std::f64::consts::PI;

/// The files by name, with the answer.
const CASES: &[(&str, Answer)] = &[
    // An ellipse of half axes 15 and 7.5, 4 · 15 E(3/4), and one of 12.75 and 6.375 upright.
    ("ellipse-2pi-up", Runs(72.663_361_7, [[5.0, 35.0], [12.5, 27.5]], &[])),
    ("ellipse-2pi-11digits", Runs(61.763_857_4, [[91.191_351, 103.941_351], [40.081_357, 65.581_357]], &[])),
    ("step-circle-2pi-up", Runs(10.0 * TURN, [[-10.0, 10.0], [-10.0, 10.0]], &[])),
    // An outline of 60 by 40 with two holes of radius 3 at (15, 20) and (45, 20), and one of them alone.
    ("insert-holes", Runs(200.0 + 6.0 * TURN, [[0.0, 60.0], [0.0, 40.0]], &[])),
    ("insert-only", Runs(3.0 * TURN, [[12.0, 18.0], [17.0, 23.0]], &[])),
    ("spline-closed-flag-open", Runs(118.299_968, [[0.0, 66.157], [0.0, 21.429]], &["curve-open"])),
    // 30 and 20.
    ("bulge-nearly-straight", Runs(50.0, [[0.0, 30.0], [0.0, 20.0]], &[])),
    // 2π 1.4.
    ("arc-0-360", Runs(1.4 * TURN, [[18.6, 21.4], [8.6, 11.4]], &[])),
    // A quarter of radius 10.
    ("arc-mirrored", Runs(2.5 * TURN, [[0.0; 2]; 2], &[])),
    // Two sides of 40, two of 20, four quarters of radius 5.
    ("bulge-corner", Runs(120.0 + 5.0 * TURN, [[0.0, 50.0], [0.0, 30.0]], &[])),
    // R = c (1 + b²)/4b turns by 4 atan b: b = 0.4 and 0.7 on chords of 30, and two sides of 20.
    ("bulge-mirrored", Runs(112.103_27, [[-30.0, 0.0], [-6.0, 30.5]], &[])),
    // b = 2.5 and 1.8 on chords of 10, √125 between.
    ("bulge-over-1", Runs(70.754_741_6, [[0.0; 2]; 2], &[])),
    ("fold-fit", Runs(10.198_039 + 20.0, [[0.0, 20.0], [0.0, 2.0]], &[])),
    ("iges100-full", Runs(10.0 * TURN, [[-10.0, 10.0], [-10.0, 10.0]], &[])),
    ("iges100-full-minus", Runs(10.0 * TURN, [[-10.0, 10.0], [-10.0, 10.0]], &[])),
    ("iges126-full", Runs(35.262_066_9, [[0.0, 30.0], [0.0; 2]], &[])),
    ("iges126-inch", Runs(895.656_5, [[0.0, 762.0], [0.0; 2]], &[])),
    ("iges126-last-knot-plus1", Runs(35.262_066_9, [[0.0, 30.0], [0.0; 2]], &[])),
    // A quarter of radius 10.
    ("iges126-rational", Runs(2.5 * TURN, [[0.0, 10.0], [0.0, 10.0]], &[])),
    ("iges126-subset", Runs(13.298_999_6, [[6.093_75, 18.281_25], [2.5, 5.0]], &[])),
    ("iges126-unitname-only", Runs(35.262_066_9, [[0.0, 30.0], [0.0; 2]], &[])),
    // 1.226 inches.
    ("inch-measurement0", Runs(31.140_4, [[0.0, 5.740_4], [0.0, 25.4]], &[])),
    ("insunits0-measurement1", Runs(10.0, [[0.0, 10.0], [0.0, 0.0]], &[])),
    // The lines between the points that the CAD system made of its spline.
    ("polyline-fit-spline", Runs(52.088_396_8, [[0.0, 40.0], [0.0, 15.0]], &[])),
    ("spline-closed-clamped", Runs(64.146_287_6, [[0.0; 2]; 2], &[])),
    ("spline-closed-wrapped", Runs(86.282_625_8, [[0.0; 2]; 2], &[])),
    ("spline-fit-and-control", Runs(35.946_278_6, [[0.0, 30.0], [0.0; 2]], &[])),
    ("spline-kink-mult3", Runs(57.792_591_8, [[0.0, 40.0], [0.0; 2]], &["corner"])),
    ("spline-mult4-same", Runs(57.792_591_8, [[0.0, 40.0], [0.0; 2]], &["corner"])),
    ("step-trim-own-ends", Runs(35.262_066_9, [[0.0, 30.0], [0.0; 2]], &[])),
    ("step-trimmed-by-params", Runs(13.298_999_6, [[6.093_75, 18.281_25], [2.5, 5.0]], &[])),
    // The same from the places at t = 0.5 and 1.5.
    ("step-trim-inside", Runs(13.298_999_6, [[6.093_75, 18.281_25], [2.5, 5.0]], &[])),
    // x²/15² + y²/7² = 1 about (10, 20), from (4.25, −6.71) to (11.31, 4.60).
    ("iges-occt-ellipse-arc-104", Runs(19.773_315_5, [[14.254_933, 25.0], [13.287_53, 24.598_906]], &[])),
    ("iges-occt-full-ellipse-degree6", Refused(&["degree-range"])),
    ("spline-fit-only", Refused(&["spline-fit-points"])),
    ("iges126-on-surface", Refused(&["curve-missing"])),
    ("iges126-no-range", Refused(&["entity-truncated"])),
    ("iges126-reversed-range", Refused(&["range-outside"])),
    ("no-units", Refused(&["units-unknown"])),
    ("spline-mult4-jump", Refused(&["curve-breaks"])),
];

/// Drawings of blocks in blocks, scaled, mirrored, turned, tilted and in arrays, made at random: the length of their
/// curves and the box round them, as ezdxf 1.4.5 decomposes them and flattens what it finds to 1e-7 mm.
const INSERTS: &[(&str, f64, [f64; 3], [f64; 3])] = &[
    ("00", 1177.908415, [-64.01397, -84.07451, -98.09944], [64.90735, 17.1754, 57.89365]),
    ("01", 1330.793285, [-105.61462, -98.83963, -39.22163], [8.80507, 71.8507, 84.46751]),
    ("02", 2828.899699, [-97.60349, -29.40527, -66.182], [-1.70176, 157.20561, 67.63002]),
    ("03", 410.444177, [-6.10254, -67.20078, -21.78124], [29.69096, 13.72734, 51.86513]),
    ("04", 1144.896861, [-116.40099, -82.02936, -143.05978], [28.80875, 59.15114, 100.11857]),
    ("05", 2995.105464, [-128.10101, -67.40168, -129.06628], [68.18568, 77.68252, 86.68852]),
    ("06", 715.989146, [-61.99738, -63.57604, -33.00811], [32.78749, 37.63192, 18.08939]),
    ("07", 4171.253201, [-108.26129, -2.08689, -49.36168], [50.3768, 120.93965, 101.77951]),
    ("08", 709.173972, [-27.03529, -93.31394, -49.09207], [54.21774, 22.88854, 76.23238]),
    ("09", 416.741727, [-78.7171, -3.29961, -79.40412], [17.84296, 99.46368, 82.82989]),
    ("10", 5096.063710, [-58.15245, -99.99031, -125.51505], [113.6229, 143.70643, 165.49938]),
    ("11", 1340.524950, [-66.56261, -12.80861, -9.13503], [108.87565, 154.39446, 60.3389]),
    ("12", 3717.864977, [-72.33634, -132.30971, -58.70199], [29.35109, 46.9671, 52.87268]),
    ("13", 631.452272, [-134.91679, -71.56931, -28.89546], [10.87325, 118.68122, 11.83902]),
    ("14", 421.964966, [-32.01629, -49.22103, -63.47537], [103.12011, 62.32456, 76.81001]),
    ("15", 712.662067, [-74.43683, -17.44169, -30.04072], [16.84863, 75.94849, 20.00311]),
    ("16", 19086.025568, [-8.33413, -68.31324, -47.96901], [97.83906, 60.38901, -3.26833]),
    ("17", 2327.008965, [-38.20164, -155.96282, -37.50467], [137.32725, 6.54447, 15.0703]),
    ("18", 1417.401900, [-16.28319, -63.96773, -37.40491], [71.60722, 244.54321, 31.40525]),
    ("19", 9156.649129, [-45.54926, -83.75085, -20.94632], [86.57362, 74.21574, 39.86852]),
];

#[test]
fn curve_files_on_every_machine() {
    let here = folder("fixtures/cases/curves");
    let mut wrong = Vec::new();
    for (case, answer) in CASES {
        let text = std::fs::read_to_string(here.join(format!("{case}.toml"))).expect("a job");
        let sources = sources_in("job.toml", &text, &here);
        for (name, _) in BUILT_IN {
            let machine = Machine::built_in(name).expect("a machine");
            let said = match (answer, compiled_from(&sources, &machine, None)) {
                (Refused(ids), Err(errors)) => {
                    let found: Vec<&str> =
                        errors.0.iter().filter(|d| d.severity == Severity::Error).map(|d| d.id).collect();
                    (found != *ids).then(|| format!("{found:?}"))
                }
                (Runs(length, bounds, ids), Ok(output)) => {
                    let report = output.report.as_ref().expect("a proof");
                    let told: Vec<&str> = output
                        .warnings
                        .0
                        .iter()
                        .filter(|d| d.severity == Severity::Warning)
                        .map(|d| d.id)
                        .collect();
                    let [x, y] = reach(&output.text, &output.machine);
                    // Lengths of the written path are summed from chords to 1e-4 of themselves; nine digits stand here.
                    let long = (report.cutting_length - length).abs() <= 1e-4 * length;
                    // What is not said of a bound is not compared.
                    let apart = |found: [f64; 2], right: [f64; 2]| {
                        right != [0.0; 2]
                            && (found[0] - right[0]).abs().max((found[1] - right[1]).abs()) > 2e-3
                    };
                    let off = !long || apart(x, bounds[0]) || apart(y, bounds[1]) || told != *ids;
                    off.then(|| format!("{} mm, {x:?}, {y:?}, {told:?}", report.cutting_length))
                }
                (Refused(_), Ok(output)) => Some(format!("compiles: {}", output.text)),
                (Runs(..), Err(errors)) => Some(format!("{errors:?}")),
            };
            wrong.extend(said.map(|said| format!("{case} on {name}: {said}")));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let files = std::fs::read_dir(&here).expect("cases").flatten();
    let jobs =
        files.filter(|file| file.path().extension().is_some_and(|extension| extension == "toml")).count();
    assert_eq!(jobs, CASES.len(), "each case has its answer");
}

/// The least and the greatest X and Y of the moves at feed of a program.
fn reach(text: &str, machine: &Machine) -> [[f64; 2]; 2] {
    let reading =
        (machine.dialect.read)(text, SourceId::PROGRAM, machine).unwrap_or_else(|e| panic!("{e:?}"));
    let setting = Setting { machine: Some(machine), tolerance: 0.001, ..Setting::default() };
    let track = Track::of_decimals(&reading.value.decimals, &setting).expect("a track");
    let mut reach = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    for piece in &track.pieces {
        for k in 0..=200 {
            let p = piece.curve.at(piece.from + (piece.to - piece.from) * f64::from(k) / 200.0);
            for (i, [low, high]) in reach.iter_mut().enumerate() {
                (*low, *high) = (low.min(p[i]), high.max(p[i]));
            }
        }
    }
    reach
}

/// The curves of a drawing of the folder.
fn drawing(name: &str, text: &str) -> Vec<FileCurve> {
    let format = format_of(name).expect("a format");
    let found = read(&Source::new(name, text), SourceId::INPUT, format, None);
    found.unwrap_or_else(|e| panic!("{name}: {e:?}")).curves
}

/// Places along a path, many in a row.
fn places(path: &Path) -> Vec<[f64; 3]> {
    let place = |p: &[f64; 3]| [p[0], p[1], p[2], 0.0, 0.0, 0.0];
    let pieces: Vec<Bezier> = match path {
        Path::Lines(points, _) => return points.clone(),
        Path::Conic(conic) => conic.mapped(&place).pieces(),
        Path::Pieces(pieces) => pieces.clone(),
        Path::Nurbs(nurbs) => nurbs.beziers().map(|(piece, _)| piece).collect(),
    };
    let at = |piece: &Bezier, k: u32| piece.eval(f64::from(k) / 2000.0);
    let mut places = Vec::new();
    for piece in &pieces {
        places.extend((0..=2000).map(|k| at(piece, k)).map(|p| [p[0], p[1], p[2]]));
    }
    places
}

#[test]
fn blocks_are_where_they_are_inserted() {
    for (case, length, low, high) in INSERTS {
        let text = std::fs::read_to_string(folder(&format!("fixtures/cases/inserts/{case}.dxf")))
            .expect("a drawing");
        let (mut found, mut least, mut most) = (0.0, [f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for curve in drawing("c.dxf", &text) {
            let places = places(&curve.path);
            for pair in places.windows(2) {
                found +=
                    (0..3).map(|i| (pair[1][i] - pair[0][i]) * (pair[1][i] - pair[0][i])).sum::<f64>().sqrt();
            }
            for p in places {
                for i in 0..3 {
                    (least[i], most[i]) = (least[i].min(p[i]), most[i].max(p[i]));
                }
            }
        }
        // Chords of 2000 parts of a quarter are 1e-7 of it short, and those of ezdxf, 1e-7 mm high on radii of up to 30 mm, 1e-7.
        assert!((found - length).abs() < 1e-5 * length, "{case}: {found} is not {length}");
        for i in 0..3 {
            assert!(
                (least[i] - low[i]).abs() < 1e-3 && (most[i] - high[i]).abs() < 1e-3,
                "{case}: {least:?} {most:?}"
            );
        }
    }
}
