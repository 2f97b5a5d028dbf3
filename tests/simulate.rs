//! The table of `docs/simulation.md`: curves with the paper's kind of difficulty, at 6 m/min and 1 ms.

mod runs;

use crate::support::{bless, fail_on, folder};
use splinepost::geom::elementary::{cos, sin};
use splinepost::geom::logcurve::{Cutter, Hand, Law as Angle, LogCurve};
use splinepost::geom::nurbs::Nurbs;
use splinepost::simulate::partition::{Cycle, Cycles, Law, Method, Parametric, Piece, Weights};
use splinepost::simulate::shape::Shape;
use splinepost::units::{DEGREES, Position};
use std::f64::consts::TAU;
use std::fmt::Write as _;

/// F = 6 m/min, mm/s.
const FEED: f64 = 100.0;

/// T = 1 ms.
const CYCLE: f64 = 1e-3;

const XYZ: Weights = Weights([1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);

/// A plane curve by its value and its first derivative.
type Plane = fn(f64) -> [[f64; 2]; 2];

/// A curve of the table, one of the plane or a shape.
#[derive(Clone)]
enum Any {
    Plane(Plane),
    Shape(Shape),
}

impl Parametric for Any {
    fn at(&self, u: f64) -> Position {
        self.jet(u)[0]
    }

    /// The second derivative by central differences: it is for the column of radii only.
    fn jet(&self, u: f64) -> [Position; 3] {
        match self {
            Any::Plane(curve) => {
                let flat = |[x, y]: [f64; 2]| [x, y, 0.0, 0.0, 0.0, 0.0];
                let [c, rate] = curve(u);
                let h = 1e-5;
                let ([_, before], [_, after]) = (curve(u - h), curve(u + h));
                [flat(c), flat(rate), flat([0, 1].map(|i| (after[i] - before[i]) / (2.0 * h)))]
            }
            Any::Shape(shape) => shape.jet(u),
        }
    }
}

fn ellipse(u: f64) -> [[f64; 2]; 2] {
    [[20.0 * cos(u), 5.1 * sin(u)], [-20.0 * sin(u), 5.1 * cos(u)]]
}

fn lissajous(u: f64) -> [[f64; 2]; 2] {
    [[30.0 * cos(u), 30.0 * sin(2.0 * u)], [-30.0 * sin(u), 60.0 * cos(2.0 * u)]]
}

/// x = a cos u/(1 + sin²u), y = x sin u.
fn lemniscate(u: f64) -> [[f64; 2]; 2] {
    let (a, s, c) = (4.0, sin(u), cos(u));
    let d = 1.0 + s * s;
    let (x, x1) = (a * c / d, -a * s / d - 2.0 * a * s * c * c / (d * d));
    [[x, x * s], [x1, x1 * s + x * c]]
}

/// x = r(cos u + u sin u), y = r(sin u − u cos u); its cusp is at u = 0.
fn involute(u: f64) -> [[f64; 2]; 2] {
    let (s, c) = (sin(u), cos(u));
    [[10.0 * (c + u * s), 10.0 * (s - u * c)], [10.0 * u * c, 10.0 * u * s]]
}

/// One curve of the table.
struct Entry {
    name: &'static str,
    what: &'static str,
    pieces: Vec<Piece<Any>>,
}

fn plane(name: &'static str, what: &'static str, curve: Plane, from: f64, to: f64) -> Entry {
    let piece = Piece { curve: Any::Plane(curve), from, to, feed: FEED, counts: XYZ, surface: XYZ };
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
    let curve = Any::Shape(Shape::Logarithmic(Box::new(curve)));
    let pieces = vec![Piece { curve, from: 0.0, to: 30.0, feed: FEED, counts, surface }];
    Entry { name: "logarithmic", what: "the paper's cutter, D1 = 10, a degree of A as a mm", pieces }
}

fn nurbs() -> Entry {
    let points = [(0., 0.), (10., 18.), (25., 20.), (32., -12.), (50., -14.), (56., 12.), (70., 4.)];
    let points = points.iter().map(|(x, y)| [*x, *y, 0.2 * x, 0.0, 0.0, 0.0]).collect();
    let knots = vec![0., 0., 0., 0., 1., 2., 3., 4., 4., 4., 4.];
    let weights = vec![1.0, 0.4, 2.5, 0.7, 3.0, 0.5, 1.0];
    let spline = Nurbs::new(3, knots, points, weights).expect("a spline");
    let piece =
        |shape| Piece { curve: Any::Shape(shape), from: 0.0, to: 1.0, feed: FEED, counts: XYZ, surface: XYZ };
    let pieces = spline.beziers().map(|(bezier, _)| piece(Shape::bezier(&bezier))).collect();
    Entry { name: "NURBS", what: "cubic, seven points, weights 0.4 to 3", pieces }
}

fn entries() -> Vec<Entry> {
    vec![
        plane("ellipse", "20 cos u, 5.1 sin u", ellipse, 0.0, TAU),
        plane("Lissajous", "30 cos u, 30 sin 2u", lissajous, 0.0, TAU),
        plane("lemniscate", "Bernoulli's, a = 4", lemniscate, 0.0, TAU),
        plane("involute", "of a circle of 10, u from 0.5 to 6", involute, 0.5, 6.0),
        cutter(),
        nurbs(),
    ]
}

/// The smallest radius of curvature ‖c′‖³/√(‖c′‖²‖c″‖² − (c′·c″)²) at ten thousand places of each piece.
fn radius(pieces: &[Piece<Any>]) -> f64 {
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
fn worst(pieces: &[Piece<Any>], method: Method, tolerance: f64) -> (f64, f64, usize) {
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
