//! The table of `docs/simulation.md`: curves with the paper's kind of difficulty, at 6 m/min and 1 ms.

mod runs;

use crate::support::{bless, fail_on, folder};
use splinepost::geom::expr::curve::Formula;
use splinepost::geom::expr::parse::parse;
use splinepost::geom::logcurve::{Cutter, Hand, Law as Angle, LogCurve};
use splinepost::geom::nurbs::Nurbs;
use splinepost::simulate::partition::{Cycle, Cycles, Law, Method, Parametric, Piece, Weights};
use splinepost::simulate::shape::{Shape, Way};
use splinepost::units::DEGREES;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::sync::Arc;

/// F = 6 m/min, mm/s.
const FEED: f64 = 100.0;

/// T = 1 ms.
const CYCLE: f64 = 1e-3;

const XYZ: Weights = Weights([1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);

/// One curve of the table.
struct Entry {
    name: &'static str,
    what: &'static str,
    pieces: Vec<Piece<Shape>>,
}

fn plane(name: &'static str, what: &'static str, [x, y]: [&str; 2], from: f64, to: f64) -> Entry {
    let axes = [x, y].map(|text| parse(text, &[]).expect("an expression")).to_vec();
    let formula = Formula::new(axes, from, to).expect("a smooth curve");
    let piece =
        Piece { curve: Shape::Formula(Arc::new(formula)), from, to, feed: FEED, counts: XYZ, surface: XYZ };
    Entry { name, what, pieces: vec![piece] }
}

/// The paper's cutter with every degree of A counted as a millimetre, measured at its surface.
fn cutter() -> Entry {
    let cutter = Cutter {
        d1: 10.0,
        s: 30.0,
        c: 5.0,
        r: 8.0,
        length: 30.0,
        hand: Hand::Right,
        law: Angle::ConstantHelix,
    };
    let curve = LogCurve::new(cutter, 0.0).expect("a cutter");
    let counts = Weights([1.0, 1.0, 1.0, 1.0, 0.0, 0.0]);
    let surface = Weights([1.0, 1.0, 1.0, curve.max_radius() / DEGREES, 0.0, 0.0]);
    let curve = Shape::Logarithmic(Box::new(curve), Way::Forth);
    let pieces = vec![Piece { curve, from: 0.0, to: 30.0, feed: FEED, counts, surface }];
    Entry { name: "logarithmic", what: "the paper's cutter, D1 = 10, a degree of A as a mm", pieces }
}

fn nurbs() -> Entry {
    let points = [(0., 0.), (10., 18.), (25., 20.), (32., -12.), (50., -14.), (56., 12.), (70., 4.)];
    let points = points.iter().map(|(x, y)| [*x, *y, 0.2 * x, 0.0, 0.0, 0.0]).collect();
    let knots = vec![0., 0., 0., 0., 1., 2., 3., 4., 4., 4., 4.];
    let weights = vec![1.0, 0.4, 2.5, 0.7, 3.0, 0.5, 1.0];
    let spline = Nurbs::new(3, knots, points, weights).expect("a spline");
    let piece = |shape| Piece { curve: shape, from: 0.0, to: 1.0, feed: FEED, counts: XYZ, surface: XYZ };
    let pieces = spline.beziers().map(|(bezier, _)| piece(Shape::bezier(&bezier))).collect();
    Entry { name: "NURBS", what: "cubic, seven points, weights 0.4 to 3", pieces }
}

fn entries() -> Vec<Entry> {
    vec![
        plane("ellipse", "20 cos u, 5.1 sin u", ["20*cos(u)", "5.1*sin(u)"], 0.0, TAU),
        plane("Lissajous", "30 cos u, 30 sin 2u", ["30*cos(u)", "30*sin(2*u)"], 0.0, TAU),
        plane(
            "lemniscate",
            "Bernoulli's, a = 4",
            ["4*cos(u)/(1 + sin(u)^2)", "4*sin(u)*cos(u)/(1 + sin(u)^2)"],
            0.0,
            TAU,
        ),
        plane(
            "involute",
            "of a circle of 10, u from 0.5 to 6",
            ["10*(cos(u) + u*sin(u))", "10*(sin(u) - u*cos(u))"],
            0.5,
            6.0,
        ),
        cutter(),
        nurbs(),
    ]
}

/// The smallest radius of curvature ‖c′‖³/√(‖c′‖²‖c″‖² − (c′·c″)²) at ten thousand places of each piece.
fn radius(pieces: &[Piece<Shape>]) -> f64 {
    let mut least = f64::INFINITY;
    for piece in pieces {
        for i in 0..=10_000 {
            let u = piece.from + (piece.to - piece.from) * f64::from(i) / 1e4;
            let [_, rate, second] = piece.curve.jet(u);
            let w = &piece.surface;
            let (v, a, va) = (w.dot(&rate, &rate), w.dot(&second, &second), w.dot(&rate, &second));
            least = least.min(v * v.sqrt() / (v * a - va * va).max(0.0).sqrt());
        }
    }
    least
}

/// The greatest feed error and chord error, and how many cycles there are.
fn worst(pieces: &[Piece<Shape>], method: Method, tolerance: f64) -> (f64, f64, usize) {
    let cycles: Vec<Cycle> = Cycles::new(pieces, Law { method, cycle: CYCLE, tolerance }).collect();
    let feed = cycles.iter().map(|c| c.feed_error.abs()).fold(0.0, f64::max);
    (feed, cycles.iter().map(|c| c.chord_error).fold(0.0, f64::max), cycles.len())
}

#[test]
fn curves_hold_the_papers_figures() {
    let mut wrong = Vec::new();
    let mut table = String::from(
        "| curve | | least radius, mm | cycles | Taylor: feed error | secant: feed error | bisection: feed error \
         | secant to 1e-12 | chord error, m |\n|---|---|---|---|---|---|---|---|---|\n",
    );
    for Entry { name, what, pieces } in entries() {
        let radius = radius(&pieces);
        assert!(1.25 <= radius, "{name} has a radius of {radius}: a chord of 0.1 mm is no match for it");
        let (taylor, ..) = worst(&pieces, Method::Taylor, 1e-8);
        let (secant, chord, cycles) = worst(&pieces, Method::Secant, 1e-8);
        let (bisection, other, _) = worst(&pieces, Method::Bisection, 1e-8);
        let (fine, ..) = worst(&pieces, Method::Secant, 1e-12);
        assert!(secant <= 1e-8 && bisection <= 1e-8, "{name}: {secant:e}, {bisection:e}");
        assert!(fine <= 1e-12, "{name}: {fine:e}");
        assert!(chord.max(other) <= 1e-3, "{name}: {chord} mm");
        assert!(10.0 * secant < taylor, "{name}: Taylor's step is as good, {taylor:e}");
        let _ = writeln!(
            table,
            "| {name} | {what} | {radius:.2} | {cycles} | {taylor:.1e} | {secant:.1e} | {bisection:.1e} \
             | {fine:.1e} | {:.1e} |",
            chord * 1e-3
        );
    }
    between_marks("docs/simulation.md", "curves", &table, &mut wrong);
    fail_on(&wrong);
}

/// Compares what stands between `<!-- NAME -->` and `<!-- end -->` of a page, or writes it where that is asked for.
fn between_marks(page: &str, name: &str, text: &str, wrong: &mut Vec<String>) {
    let path = folder(page);
    let whole = std::fs::read_to_string(&path).expect("the page");
    let mark = format!("<!-- {name} -->\n");
    let start = whole.find(&mark).expect("a mark") + mark.len();
    let end = start + whole[start..].find("<!-- end -->").expect("its end");
    if &whole[start..end] == text {
        return;
    }
    if bless() {
        std::fs::write(&path, format!("{}{text}{}", &whole[..start], &whole[end..])).expect("written");
    } else {
        wrong.push(format!("{page}: the table `{name}` is not what is measured now:\n{text}"));
    }
}
