//! Curve files: DXF, IGES and STEP as input of jobs.
//!
//! | module | what |
//! |---|---|
//! | `writers` | B-splines as files of each format |
//! | `shapes` | every kind of curve, by closed forms |
//! | `bad` | what is wrong with a file, and what is said of it |
//! | `order` | curves end to end |
//! | `command` | from the command line |

mod bad;
mod command;
mod order;
mod shapes;
mod writers;

use crate::support::{compiled_from, folder, sources_with};
use proptest::prelude::*;
use splinepost::diagnostic::Diagnostics;
use splinepost::front::curves::{FileCurve, Found, Path, format_of, read};
use splinepost::geom::nurbs::Nurbs;
use splinepost::machine::Machine;
use splinepost::source::{Source, SourceId};
use std::fs;
use writers::{WRITERS, dxf, iges, step};

/// Feed and retract, for a job that names a file.
const PROCESS: &str = "[process]\nfeed = 1000\nretract = { axis = \"Z\", to = 50.0 }\n";

/// Reads a text as a file of this name.
fn found(name: &str, text: &str) -> Result<Found, Diagnostics> {
    let format = format_of(name).expect("a format");
    read(&Source::new(name, text), SourceId::INPUT, format, None)
}

/// The curves of a text.
fn curves(name: &str, text: &str) -> Vec<FileCurve> {
    found(name, text).unwrap_or_else(|e| panic!("{name}: {e:?}\n{text}")).curves
}

/// Every curve file of the golden inputs, with its name.
pub(crate) fn fixtures() -> Vec<(String, String)> {
    let mut all = Vec::new();
    for under in ["fixtures/compile", "fixtures/curves"] {
        for case in fs::read_dir(folder(under)).expect("a folder").flatten() {
            for file in fs::read_dir(case.path()).expect("a case").flatten() {
                let name = file.path().display().to_string();
                if format_of(&name).is_some() {
                    all.push((name, fs::read_to_string(file.path()).expect("UTF-8")));
                }
            }
        }
    }
    all.sort();
    all
}

fn position([x, y, z]: [f64; 3]) -> [f64; 6] {
    [x, y, z, 0.0, 0.0, 0.0]
}

/// A weighted cubic with a double knot.
fn sample() -> Nurbs {
    let points =
        [[0., 0., 0.], [10., 15., 0.], [25., 15., 0.], [35., 0., 0.], [50., -10., 0.], [60., 5., 0.]];
    let knots = vec![0., 0., 0., 0., 1., 1., 2., 2., 2., 2.];
    Nurbs::new(3, knots, points.map(position).to_vec(), vec![1., 0.8, 1.25, 1., 0.5, 1.]).expect("a spline")
}

#[test]
fn one_curve_in_three_formats_makes_one_program() {
    for dialect in splinepost::dialect::DIALECTS {
        let machine = Machine::built_in(dialect.name).expect("a machine");
        for motion in dialect.motions.iter().map(Some).chain([None]) {
            let program = |file: &str, text: &str| {
                let job = format!("{PROCESS}[[curve]]\nfile = \"{file}\"\nat = {{ Z = -1 }}\n");
                let sources = sources_with(&job, &[(file, text)]);
                compiled_from(&sources, &machine, motion).unwrap_or_else(|e| panic!("{file}: {e:?}")).text
            };
            let first = program("c.dxf", &dxf(&[sample()]));
            assert!(first.contains("60"), "{first}");
            assert_eq!(first, program("c.igs", &iges(&[sample()])), "{}", dialect.name);
            assert_eq!(first, program("c.stp", &step(&[sample()])), "{}", dialect.name);
        }
    }
}

/// A B-spline of degree 1 to 5 with repeated knots, weights from 0.01 to 100.
fn spline() -> impl Strategy<Value = Nurbs> {
    let knots = prop::collection::vec((1u32..1000, 1usize..3), 0..6);
    (1usize..=5, knots, any::<bool>()).prop_flat_map(|(degree, inner, rational)| {
        let mut knots = vec![0.0; degree + 1];
        let mut t = 0.0;
        for (step, times) in inner {
            t += f64::from(step) / 7.0;
            knots.extend(std::iter::repeat_n(t, times.min(degree)));
        }
        knots.extend(std::iter::repeat_n(t + 1.0 / 3.0, degree + 1));
        let count = knots.len() - degree - 1;
        let points = prop::collection::vec(prop::array::uniform3(-1000.0f64..1000.0), count);
        let weights = prop::collection::vec(0.01f64..100.0, count);
        (points, weights).prop_map(move |(points, weights)| {
            let weights = if rational { weights } else { vec![1.0; count] };
            let points = points.into_iter().map(position).collect();
            Nurbs::new(degree, knots.clone(), points, weights).expect("a spline")
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, ..ProptestConfig::default() })]

    /// No number is lost on the way through a file.
    #[test]
    fn splines_are_read_as_they_were_written(splines in prop::collection::vec(spline(), 1..4)) {
        for (name, write) in WRITERS {
            let text = write(&splines);
            let read = curves(name, &text);
            prop_assert_eq!(read.len(), splines.len());
            for (read, written) in read.iter().zip(&splines) {
                let Path::Nurbs(read) = &read.path else { panic!("{:?}", read.path) };
                prop_assert_eq!(read, written, "{}", name);
            }
        }
    }
}

#[test]
fn units_are_those_of_the_file() {
    for (name, write) in WRITERS {
        let end = |text: &str| curves(name, text)[0].path.end()[0];
        let mm = write(&[sample()]);
        let inch = mm
            .replace("$INSUNITS\n 70\n4", "$INSUNITS\n 70\n1")
            .replace("1.,2,2HMM", "1.,1,2HIN")
            .replace("SI_UNIT(.MILLI.,.METRE.)", "CONVERSION_BASED_UNIT('INCH',#903)");
        assert_ne!(mm, inch, "{name}");
        assert_eq!(end(&mm), 60.0);
        assert_eq!(end(&inch), 60.0 * 25.4, "{name}");
    }
}
