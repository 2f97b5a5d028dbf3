//! Conversions against an oracle in exact rational arithmetic that shares no code with the crate.
//!
//! | module | what |
//! |---|---|
//! | [`rational`] | polynomials and B-splines from their definitions |
//! | [`text`] | the curves of a program, exactly as its text says |

mod rational;
mod text;

use crate::support::{compiled, machine};
use num_rational::BigRational;
use num_traits::{One, Zero};
use proptest::prelude::*;
use rational::{Q, Span, abs, q, spans};
use splinepost::Output;
use splinepost::machine::Machine;
use splinepost::verify::Status;
use text::{Paths, paths};

/// A B-spline of decimals: points in thousandths, knots whole, weights in hundredths.
#[derive(Clone, Debug)]
struct Input {
    degree: usize,
    axes: String,
    knots: Vec<i64>,
    points: Vec<Vec<i64>>,
    weights: Option<Vec<i64>>,
}

impl Input {
    fn toml(&self) -> String {
        let thousandths =
            |x: &i64| format!("{}{}.{:03}", if *x < 0 { "-" } else { "" }, x.abs() / 1000, x.abs() % 1000);
        let row = |p: &Vec<i64>| format!("[{}]", p.iter().map(thousandths).collect::<Vec<_>>().join(", "));
        let axes: Vec<String> = self.axes.chars().map(|axis| format!("\"{axis}\"")).collect();
        let points: Vec<String> = self.points.iter().map(row).collect();
        let weights = self.weights.as_ref().map_or(String::new(), |weights| {
            let all: Vec<String> = weights.iter().map(|w| format!("{}.{:02}", w / 100, w % 100)).collect();
            format!("weights = [{}]\n", all.join(", "))
        });
        format!(
            "name = \"EXACT\"\n[process]\nfeed = 1000\nretract = {{ axis = \"Z\", to = 900 }}\n[[curve]]\nkind = \"nurbs\"\n\
             axes = [{}]\nat = {{ {} }}\ndegree = {}\nknots = {:?}\npoints = [{}]\n{weights}",
            axes.join(", "),
            if self.axes.contains('Z') { "" } else { "Z = 1" },
            self.degree,
            self.knots,
            points.join(", "),
        )
    }

    /// The coordinates of the program: Z is always one.
    fn program_axes(&self) -> String {
        "XYZUVW".chars().filter(|axis| *axis == 'Z' || self.axes.contains(*axis)).collect()
    }

    fn spans(&self) -> Vec<Span> {
        let columns = self.program_axes();
        let point = |p: &Vec<i64>| -> Vec<Q> {
            let of = |axis: char| match self.axes.chars().position(|own| own == axis) {
                Some(i) => q(p[i], 1000),
                None => q(1, 1),
            };
            columns.chars().map(of).collect()
        };
        let points: Vec<Vec<Q>> = self.points.iter().map(point).collect();
        let knots: Vec<Q> = self.knots.iter().map(|t| q(*t, 1)).collect();
        let weights: Vec<Q> = match &self.weights {
            Some(weights) => weights.iter().map(|w| q(*w, 100)).collect(),
            None => vec![Q::one(); points.len()],
        };
        spans(self.degree, &knots, &points, &weights)
    }

    /// The greatest coordinate and the greatest distance of two control points in one, mm.
    fn size(&self) -> (Q, Q) {
        let all = self.points.iter().flatten().map(|x| x.abs()).max().unwrap_or(0).max(1000);
        let range = |i: usize| {
            let column = || self.points.iter().map(|p| p[i]);
            column().max().unwrap_or(0) - column().min().unwrap_or(0)
        };
        let widest = (0..self.axes.len()).map(range).max().unwrap_or(0);
        (q(all, 1000), q(widest, 1000))
    }
}

/// B-splines of degrees 1 to `degree` in 2 to 6 coordinates, inner knots up to degree-fold.
fn inputs(degree: usize, rational: bool) -> impl Strategy<Value = Input> {
    (1..=degree, 2..=6usize, 1..5usize).prop_flat_map(move |(p, axes, inner)| {
        let knots = prop::collection::vec((1..4i64, 1..=p), inner - 1);
        (Just(p), Just(axes), knots, 1..4i64).prop_flat_map(move |(p, axes, inner, last)| {
            let mut knots = vec![0i64; p + 1];
            for (step, times) in &inner {
                let next = knots[knots.len() - 1] + step;
                knots.extend(std::iter::repeat_n(next, *times));
            }
            let end = knots[knots.len() - 1] + last;
            knots.extend(std::iter::repeat_n(end, p + 1));
            let n = knots.len() - p - 1;
            let points = prop::collection::vec(prop::collection::vec(-80_000..80_000i64, axes), n);
            // 0.01 to 100, both included, about evenly in the logarithm.
            let weight = (0..=20u32).prop_map(|k| [1, 2, 3, 5, 8][k as usize % 5] * 10i64.pow(k / 5));
            let weights = prop::collection::vec(weight, n);
            (points, weights).prop_map(move |(points, weights)| Input {
                degree: p,
                axes: "XYZUVW".chars().take(axes).collect(),
                knots: knots.clone(),
                points,
                weights: rational.then_some(weights),
            })
        })
    })
}

fn machine_of(name: &str) -> Machine {
    let all = "[\"X\", \"Y\", \"Z\", \"U\", \"V\", \"W\"]";
    machine(&format!(
        "extends = \"{name}\"\nname = \"{name}\"\n[axes]\nlinear = {all}\nrotary = []\n[spline]\naxes = {all}\npoly_words = 100\n"
    ))
}

fn compile(input: &Input, name: &str, motion: &str) -> (Output, Paths) {
    let machine = machine_of(name);
    let text = input.toml();
    let output = compiled(&text, &machine, machine.dialect.motion(motion))
        .unwrap_or_else(|e| panic!("{name} {motion}: {e:?}\n{text}"));
    let report = output.report.as_ref().expect("a report");
    assert!(report.status == Status::Proved && report.deviation.mm <= output.tolerance);
    let paths = paths(machine.dialect.name, &output.text, &input.program_axes());
    (output, paths)
}

/// The same, or none where the curve has to be fitted and its weights are so far apart (beyond 1:100) that it all but turns
/// on the spot: the tolerance may be out of reach there, or its true length beyond the digits of the knots, and then the answer is no.
fn compile_if_tame(input: &Input, name: &str, motion: &str) -> Option<(Output, Paths)> {
    let weights = input.weights.as_deref().unwrap_or(&[1]);
    let (least, most) = (weights.iter().min()?, weights.iter().max()?);
    if most <= &(100 * least) {
        return Some(compile(input, name, motion));
    }
    let machine = machine_of(name);
    match compiled(&input.toml(), &machine, machine.dialect.motion(motion)) {
        Ok(_) => Some(compile(input, name, motion)),
        Err(errors) => {
            let ids: Vec<&str> = errors.0.iter().map(|d| d.id).collect();
            assert!(
                ids.iter().all(|id| {
                    ["deviation-too-large", "tolerance-out-of-reach", "form-out-of-reach"].contains(id)
                }),
                "{errors:?}"
            );
            None
        }
    }
}

fn is_fitted(output: &Output) -> bool {
    output.warnings.0.iter().any(|d| d.id == "curve-fitted")
}

/// Whether a coefficient that is printed is the exact one to a unit of its last digit. Those of a block have `decimals`,
/// trailing zeros left out; one that is too large for so many in a float, 2⁵¹ of them, has fewer.
fn is_exact(printed: Option<&String>, exact: &Q, decimals: usize) -> bool {
    let own = printed.map_or_else(Q::zero, |x| rational::decimal(x).expect("a number"));
    let unit = num_traits::pow(q(1, 10), decimals);
    let held = abs(exact) < &unit * q(1 << 51, 1);
    let unit =
        if held { unit } else { num_traits::pow(q(1, 10), printed.map_or(0, |x| rational::decimals(x))) };
    abs(&(own - exact)) <= unit
}

/// Every coefficient that is printed is the exact one to a unit of its last digit.
fn poly_is_exact(input: &Input, paths: &Paths) -> Result<(), TestCaseError> {
    let micron = q(1, 1_000_000);
    let columns = input.program_axes();
    let asked = input.spans();
    prop_assert_eq!(paths.blocks.len(), asked.len());
    for (block, span) in paths.blocks.iter().zip(&asked) {
        let lists = block.axes.values().map(|list| &list[1..]).chain(block.denominator.as_deref());
        let decimals = lists.flatten().map(|x| rational::decimals(x)).max().unwrap_or(0);
        // The start weight is made 1.
        let scale = Q::one() / span.denominator.coefficient(0);
        let below = span.denominator.scaled(&scale);
        if let Some(printed) = &block.denominator {
            prop_assert!(is_exact(printed.first(), &below.at(&Q::one()), decimals), "{:?}", printed);
            for k in 2..=5 {
                prop_assert!(
                    is_exact(printed.get(k - 1), &below.coefficient(k), decimals),
                    "d{} {:?}",
                    k,
                    printed
                );
            }
        }
        for (i, axis) in columns.chars().enumerate() {
            let Some(printed) = block.axes.get(&axis) else { continue };
            let exact = span.numerators[i].scaled(&scale);
            let end = span.at(&Q::one())[i].clone();
            prop_assert!(abs(&(rational::decimal(&printed[0]).expect("an end") - end)) <= micron.clone());
            for k in 2..=5 {
                prop_assert!(
                    is_exact(printed.get(k - 1), &exact.coefficient(k), decimals),
                    "a{} {:?}",
                    k,
                    printed
                );
            }
        }
    }
    Ok(())
}

/// Both at k/16 of each span: no farther apart than `allowed`.
fn same_spans(read: &[Span], asked: &[Span], allowed: &Q) -> Result<(), TestCaseError> {
    prop_assert_eq!(read.len(), asked.len());
    for (a, b) in read.iter().zip(asked) {
        for k in 0..=16 {
            let s = q(k, 16);
            for (x, y) in a.at(&s).iter().zip(b.at(&s)) {
                prop_assert!(abs(&(x - &y)) <= allowed.clone(), "{} and {}, apart {}", x, y, x - &y);
            }
        }
    }
    Ok(())
}

/// The one spline that was read and the one asked for, span by span; knots are inserted where a control wants more blocks,
/// and then each span that was read is a part of one asked for, found by its share of all knots.
fn same_curve(paths: &Paths, input: &Input, allowed: &Q) -> Result<(), TestCaseError> {
    let asked = input.spans();
    prop_assert_eq!(paths.splines.len(), 1);
    if paths.spans.len() == asked.len() {
        return same_spans(&paths.spans, &asked, allowed);
    }
    prop_assert!(asked.len() < paths.spans.len());
    let shares = |mut knots: Vec<Q>| -> Vec<Q> {
        knots.dedup();
        let (first, last) = (knots[0].clone(), knots[knots.len() - 1].clone());
        knots.iter().map(|t| (t - &first) / (&last - &first)).collect()
    };
    let own = shares(paths.splines[0].knots.clone());
    let theirs = shares(input.knots.iter().map(|t| q(*t, 1)).collect());
    prop_assert_eq!(own.len(), paths.spans.len() + 1);
    for (span, ends) in paths.spans.iter().zip(own.windows(2)) {
        let middle = (&ends[0] + &ends[1]) / q(2, 1);
        let j = theirs.partition_point(|t| *t <= middle) - 1;
        let width = &theirs[j + 1] - &theirs[j];
        for k in 0..=16 {
            let s = q(k, 16);
            let share = &ends[0] + (&ends[1] - &ends[0]) * &s;
            let place = asked[j].at(&((share - &theirs[j]) / &width));
            for (x, y) in span.at(&s).iter().zip(&place) {
                prop_assert!(abs(&(x - y)) <= allowed.clone(), "{} and {}, apart {}", x, y, x - y);
            }
        }
    }
    Ok(())
}

proptest! {
    // Exact arithmetic takes its time.
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    #[test]
    fn poly_blocks_are_exact(input in inputs(5, false)) {
        let (output, paths) = compile(&input, "sinumerik", "poly");
        prop_assert!(!is_fitted(&output));
        poly_is_exact(&input, &paths)?;
    }

    #[test]
    fn rational_poly_blocks_are_exact_in_the_geometry_axes(input in inputs(5, true)) {
        let Some((output, paths)) = compile_if_tame(&input, "sinumerik", "poly") else {
            // What is exact needs no fit, whatever its weights are.
            prop_assert!(3 < input.axes.len());
            return Ok(());
        };
        let geometry = input.axes.len() <= 3;
        let rational = input.weights.as_ref().is_some_and(|w| w.iter().any(|x| *x != w[0]));
        // Beyond X Y Z, and where twelve decimals of a coefficient are too few, a fit is made and said.
        prop_assert!(geometry || !rational || is_fitted(&output));
        if !is_fitted(&output) {
            poly_is_exact(&input, &paths)?;
        }
    }

    #[test]
    fn splines_of_degree_three_are_exact(input in inputs(3, false)) {
        // Half a unit of the control points by the convex hull, and as much again for points between knots.
        for (name, motion, allowed) in [
            ("sinumerik", "bspline", q(1, 1_000_000)),
            ("mazak", "g06.2", q(1, 10_000)),
        ] {
            let (output, paths) = compile(&input, name, motion);
            prop_assert!(!is_fitted(&output));
            same_curve(&paths, &input, &allowed)?;
        }
        if input.axes.len() <= 5 {
            // Both ends by half a unit, the control points with them, and K1, K2 by half of 1e-8 to 1e-4.
            let (output, paths) = compile(&input, "heidenhain", "spl");
            prop_assert!(!is_fitted(&output));
            same_spans(&paths.spans, &input.spans(), &q(2, 10_000))?;
        }
    }

    #[test]
    fn rational_splines_are_exact_or_fitted(input in inputs(3, true)) {
        for (name, motion, unit) in [("sinumerik", "bspline", q(1, 1_000_000)), ("mazak", "g06.2", q(1, 10_000))] {
            let Some((output, paths)) = compile_if_tame(&input, name, motion) else { continue };
            if is_fitted(&output) {
                continue;
            }
            // A weight that is off by the share e moves a point by at most 2e of the polygon's size.
            let least = paths.splines[0].weights.iter().min().expect("a weight").clone();
            let share = q(1, 20_000) / least;
            let allowed = unit + q(4, 1) * share * input.size().1;
            same_curve(&paths, &input, &allowed)?;
        }
    }
}

/// The control points of cubic spans, as a job of Bezier curves in full precision.
fn job_of(spans: &[Span]) -> String {
    let mut points = Vec::new();
    for (i, span) in spans.iter().enumerate() {
        let ordinate = |axis: usize, k: usize| {
            let a = |j: usize| span.numerators[axis].coefficient(j);
            let value = match k {
                0 => a(0),
                1 => a(0) + a(1) / q(3, 1),
                2 => a(0) + q(2, 3) * a(1) + a(2) / q(3, 1),
                _ => a(0) + a(1) + a(2) + a(3),
            };
            float(&value)
        };
        for k in usize::from(i != 0)..=3 {
            points.push(format!("[{}, {}, {}]", ordinate(0, k), ordinate(1, k), ordinate(2, k)));
        }
    }
    format!(
        "name = \"EXACT\"\n[process]\nfeed = 1000\nretract = {{ axis = \"Z\", to = 900 }}\n[[curve]]\nkind = \"bezier\"\n\
         axes = [\"X\", \"Y\", \"Z\"]\ndegree = 3\npoints = [{}]\n",
        points.join(", ")
    )
}

/// The nearest float of a number below 1e6.
fn float(x: &BigRational) -> f64 {
    let scaled = x * num_traits::pow(q(10, 1), 15);
    scaled.round().to_integer().to_string().parse::<f64>().expect("a number") / 1e15
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 30, ..ProptestConfig::default() })]

    /// NURBS → POLY → BSPLINE → SPL → G06.2 → POLY.
    #[test]
    fn a_round_trip_ends_where_it_began(
        rows in prop::collection::vec((-4000..4000i64, -4000..4000i64, -4000..4000i64), 9..14),
    ) {
        // Control points that go on in X, so that no joint stands still.
        let points: Vec<Vec<i64>> = rows.iter().enumerate()
            .map(|(i, (x, y, z))| vec![20_000 * i as i64 + x, 5 * y, z + 20_000]).collect();
        let n = points.len() as i64;
        let mut knots = vec![0, 0, 0];
        knots.extend((0..=n - 3).map(|t| 10 * t));
        knots.extend([10 * (n - 3); 3]);
        let input = Input { degree: 3, axes: "XYZ".to_owned(), knots, points, weights: None };
        let (_, first) = compile(&input, "sinumerik", "poly");
        poly_is_exact(&input, &first)?;
        let mut spans = first.spans.clone();
        for (name, motion) in [("sinumerik", "bspline"), ("heidenhain", "spl"), ("mazak", "g06.2"), ("sinumerik", "poly")] {
            let machine = machine_of(name);
            let text = job_of(&spans);
            let output = compiled(&text, &machine, machine.dialect.motion(motion))
                .unwrap_or_else(|e| panic!("{name} {motion}: {e:?}\n{text}"));
            prop_assert!(!is_fitted(&output));
            let next = paths(machine.dialect.name, &output.text, "XYZ");
            if let [spline] = &next.splines[..] {
                // The fewest knots: a single one at each joint, as at the start.
                prop_assert_eq!(spline.points.len(), input.points.len(), "{}", output.text);
            }
            spans = next.spans;
        }
        // Four roundings: 6, 4, 4 and 6 decimals, each of control points by half a unit; joints are smoothed by half a unit
        // too, and where a span is cut in control points is told by ratios of spans up to 3 to either side.
        same_spans(&spans, &input.spans(), &q(20, 10_000))?;
    }
}

/// The full circle of radius 10.
fn circle() -> String {
    std::fs::read_to_string(crate::support::folder("fixtures/compile/circle/input.toml")).expect("the circle")
}

/// max |x² + y² − 100 d²| over the denominator's least square: a bound on |r² − 100|, exactly.
fn off_circle(spans: &[Span], parts: i64) -> Q {
    let hundred = q(-100, 1);
    spans.iter().fold(Q::zero(), |most, span| {
        let d = &span.denominator;
        let [x, y] = [0, 1].map(|i| span.numerators[i].times(&span.numerators[i]));
        let implicit = x.plus(&y).plus(&d.times(d).scaled(&hundred));
        // Denominators here are convex and symmetric: no less than half the start's.
        let least = (0..=64).map(|k| d.at(&q(k, 64))).min().expect("values") * q(9, 10);
        most.max(implicit.bound(parts) / (&least * &least))
    })
}

#[test]
fn a_circle_reaches_each_dialect() {
    let of = |name: &str, motion: &str, tolerance: Option<f64>| {
        let machine = Machine::built_in(name).expect("a machine");
        let options = splinepost::Options {
            motion: machine.dialect.motion(motion),
            tolerance,
            ..splinepost::Options::default()
        };
        let sources = crate::support::sources(&circle());
        let language = splinepost::front::find("job").expect("jobs");
        let output = splinepost::compile(&sources, language, &machine, &options).expect("it compiles");
        let paths = paths(machine.dialect.name, &output.text, "XYZ");
        (output, paths)
    };
    // |r − R| = |r² − R²|/(r + R), R = 10.
    let radius = |spans: &[Span], parts| float(&(off_circle(spans, parts) / q(19, 1)));
    let (output, poly) = of("sinumerik", "poly", None);
    assert!(!is_fitted(&output) && poly.blocks.iter().all(|block| block.denominator.is_some()));
    // Coefficients in 6 decimals, five of them about X, Y and the denominator times 10.
    assert!(radius(&poly.spans, 4) < 2.0e-5, "{:e}", radius(&poly.spans, 4));
    let (output, g062) = of("mazak", "g06.2", None);
    assert!(!is_fitted(&output));
    // R99.7104 and R70.5059: their ratio is √½ to 1e-8.
    assert!(radius(&g062.spans, 4) < 1.0e-6, "{:e}", radius(&g062.spans, 4));
    let (output, spl) = of("heidenhain", "spl", Some(1.0e-4));
    assert!(spl.spans.len() <= 8, "{}", spl.spans.len());
    assert!(radius(&spl.spans, 16) < 1.0e-4, "{:e}", radius(&spl.spans, 16));
    println!(
        "SPL: {} blocks, {:e} mm; bound {:e}",
        spl.spans.len(),
        radius(&spl.spans, 16),
        output.report.expect("a report").deviation.mm
    );
}
