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

/// What a reader of curves and the shape of a path are warned of; what machines are warned of has tests of its own.
const OF_CURVES: &[&str] = &[
    "corner",
    "curve-open",
    "curves-apart",
    "curves-branch",
    "edges-of-faces",
    "entity-left-out",
    "layers-alike",
];

const TURN: f64 = 2.0 * std::f64::consts::PI;

/// The files by name, with the answer.
const CASES: &[(&str, Answer)] = &[
    // An ellipse of half axes 15 and 7.5, 4 · 15 E(3/4), and one of 12.75 and 6.375 upright.
    ("ellipse-2pi-up", Runs(72.663_361_7, [[5.0, 35.0], [2.5, 17.5]], &[])),
    ("ellipse-2pi-11digits", Runs(61.763_857_4, [[91.191_351, 103.941_351], [40.081_357, 65.581_357]], &[])),
    ("step-circle-2pi-up", Runs(10.0 * TURN, [[-10.0, 10.0], [-10.0, 10.0]], &[])),
    // An outline of 60 by 40 with two holes of radius 3 at (15, 20) and (45, 20), and one of them alone.
    ("insert-holes", Runs(200.0 + 6.0 * TURN, [[0.0, 60.0], [0.0, 40.0]], &[])),
    ("insert-only", Runs(3.0 * TURN, [[12.0, 18.0], [17.0, 23.0]], &[])),
    (
        "spline-closed-flag-open",
        Runs(118.299_968, [[0.0, 66.153_846], [-0.625, 24.615_385]], &["curve-open"]),
    ),
    // 30 and 20.
    ("bulge-nearly-straight", Runs(50.0, [[0.0, 30.0], [0.0, 20.0]], &[])),
    // 2π 1.4.
    ("arc-0-360", Runs(1.4 * TURN, [[18.6, 21.4], [8.6, 11.4]], &[])),
    // A quarter of radius 10.
    ("arc-mirrored", Runs(2.5 * TURN, [[0.0; 2]; 2], &[])),
    // Two sides of 40, two of 20, four quarters of radius 5.
    ("bulge-corner", Runs(120.0 + 5.0 * TURN, [[0.0, 50.0], [0.0, 30.0]], &[])),
    // R = c (1 + b²)/4b turns by 4 atan b: b = 0.4 and 0.7 on chords of 30, and two sides of 20.
    ("bulge-mirrored", Runs(112.103_27, [[-30.0, 0.0], [-6.0, 20.0]], &[])),
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

/// Drawings of blocks in blocks, scaled, mirrored, turned, tilted and in arrays, made at random: the length of their curves and
/// the box round them, by the places of each entity that ezdxf 1.4.5 states and the matrices that it makes of each INSERT, one
/// after the other. What its `recursive_decompose` makes of them is no witness: it states a block within a block as an INSERT
/// again, which cannot be skew, so that blocks in blocks of different scales are elsewhere.
const INSERTS: &[(&str, f64, [f64; 3], [f64; 3])] = &[
    ("00", 1177.89848, [-64.014, -57.5927, -98.0994], [65.8934, 34.1329, 57.8936]),
    ("01", 1349.72649, [-118.8353, -116.7269, -39.2216], [8.8051, 60.0642, 84.4673]),
    ("02", 2522.93395, [-105.7609, -29.4053, -66.182], [-1.7018, 144.7783, 67.63]),
    ("03", 413.12911, [-1.5877, -67.2008, -21.7812], [29.691, 13.7273, 51.8651]),
    ("04", 1160.21287, [-115.3102, -77.7686, -147.3254], [28.8067, 60.211, 100.1186]),
    ("05", 3022.26533, [-132.3942, -76.4339, -129.0663], [68.692, 101.1274, 86.6885]),
    ("06", 2357.49509, [-92.5616, -67.9745, -33.0081], [32.7875, 37.6319, 18.0894]),
    ("07", 2825.88010, [-71.19, -12.2109, -53.0723], [43.0743, 110.6945, 101.7795]),
    ("08", 733.60169, [-14.8778, -94.5161, -49.0921], [55.1028, 90.297, 76.2324]),
    ("09", 420.87935, [-75.0122, -3.2996, -79.4041], [17.9418, 100.5937, 82.8298]),
    ("10", 5629.81245, [-58.1519, -97.5491, -206.0133], [113.4129, 142.2495, 184.8236]),
    ("11", 1475.38153, [-48.9829, -12.8085, -9.1348], [174.9086, 147.1387, 60.3389]),
    ("12", 3717.75148, [-81.1827, -133.3782, -58.702], [29.3511, 46.9671, 52.8727]),
    ("13", 657.82977, [-130.9235, -76.1363, -28.8955], [10.5903, 134.0614, 11.839]),
    ("14", 431.61749, [-31.8439, -48.9974, -63.4754], [107.1583, 62.5647, 76.6966]),
    ("15", 623.82498, [-67.6548, -8.5569, -30.0407], [27.4823, 51.5235, 20.0031]),
    ("16", 16581.93737, [-21.5503, -143.5364, -58.2879], [272.3144, 60.3886, -3.2683]),
    ("17", 2326.75596, [-51.6868, -155.9607, -37.5047], [137.3269, 11.4687, 15.0703]),
    ("18", 1135.64642, [-16.2832, -12.6352, -41.3203], [107.9861, 92.9386, 31.4053]),
    ("19", 9349.79825, [-47.1206, -87.3783, -20.9463], [137.4513, 92.4611, 75.9324]),
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
                    let told: Vec<&str> =
                        output.warnings.0.iter().map(|d| d.id).filter(|id| OF_CURVES.contains(id)).collect();
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
        // Chords of 2000 parts of a turn are (π/2000)²/6 of it short: 4e-7. The box is rounded to 1e-4 mm.
        assert!((found - length).abs() < 1e-5 * length, "{case}: {found} is not {length}");
        for i in 0..3 {
            assert!(
                (least[i] - low[i]).abs() < 1e-3 && (most[i] - high[i]).abs() < 1e-3,
                "{case}: {least:?} {most:?}"
            );
        }
    }
}
