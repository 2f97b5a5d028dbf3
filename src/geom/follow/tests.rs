//! Paths whose distance is known.

use super::*;

fn at(x: f64, y: f64) -> Position {
    [x, y, 0.0, 0.0, 0.0, 0.0]
}

/// A quarter of a circle of radius 10 about the origin, from angle `quarter`·90°.
fn quarter(quarter: usize) -> Bezier {
    let turn = |x: f64, y: f64| match quarter % 4 {
        0 => at(x, y),
        1 => at(-y, x),
        2 => at(-x, -y),
        _ => at(y, -x),
    };
    let mut arc = Bezier::new(&[turn(10., 0.), turn(10., 10.), turn(0., 10.)]);
    arc.weights[1] = 0.5f64.sqrt();
    arc
}

fn cubic(quarter_of: usize, k: f64) -> Bezier {
    let arc = quarter(quarter_of);
    let towards = |p: &Position, q: &Position| std::array::from_fn(|i| p[i] + k * (q[i] - p[i]));
    let [p0, p1, p2] = [0, 1, 2].map(|i| arc.points[i]);
    Bezier::new(&[p0, towards(&p0, &p1), towards(&p2, &p1), p2])
}

#[test]
fn the_cubic_quarter_circle_has_its_known_radius_error() {
    // k = 4/3 (√2 − 1): from 0 to +2.7253e-4 of the radius.
    let k = 4.0 / 3.0 * (2.0f64.sqrt() - 1.0);
    let path: Vec<Bezier> = (0..4).map(|i| cubic(i, k)).collect();
    let curve: Vec<Bezier> = (0..4).map(quarter).collect();
    let found = follow(&path, &curve, 1e-4).unwrap();
    assert_eq!(found.map, Map::Nearest);
    assert!((2.7253e-3..2.79e-3).contains(&found.distance), "{found:?}");
    // At equal parameters they are much farther apart.
    let equal = follow(&path, &curve, 1.0).unwrap();
    assert_eq!(equal.map, Map::Parameter);
    let apart = (0..=100).map(|i| f64::from(i) / 100.0);
    let apart = apart.fold(0.0, |most, t| f64::max(most, distance(&path[0].eval(t), &curve[0].eval(t))));
    assert!(0.05 < apart && apart <= equal.distance, "{apart} {equal:?}");
}

#[test]
fn parts_of_one_curve_follow_it_to_rounding() {
    let curve: Vec<Bezier> = (0..4).map(quarter).collect();
    let cuts = [0.0, 0.13, 0.5, 0.81, 1.0];
    let parts: Vec<Bezier> =
        curve.iter().flat_map(|arc| cuts.windows(2).map(|w| arc.segment(w[0], w[1]))).collect();
    for (a, b) in [(&parts, &curve), (&curve, &parts)] {
        let found = follow(a, b, 1e-6).unwrap();
        assert!(found.distance < 1e-8, "{found:?}");
    }
    let raised: Vec<Bezier> = curve.iter().map(|arc| arc.raised_to(5)).collect();
    let found = follow(&raised, &curve, 1e-6).unwrap();
    assert!(found.map == Map::Parameter && found.distance < 1e-11, "{found:?}");
}

#[test]
fn a_dropped_or_doubled_piece_is_far() {
    let curve: Vec<Bezier> = (0..4).map(quarter).collect();
    let without: Vec<Bezier> = [0, 1, 3].into_iter().map(quarter).collect();
    let twice: Vec<Bezier> = (0..8).map(quarter).collect();
    let back: Vec<Bezier> = curve.iter().rev().map(Bezier::reversed).collect();
    for wrong in [&without, &twice, &back] {
        assert!(1.0 < follow(wrong, &curve, 1e-3).unwrap().distance);
    }
}

#[test]
fn chords_of_a_circle_are_off_by_their_sagitta() {
    let curve: Vec<Bezier> = (0..4).map(quarter).collect();
    let places: Vec<Position> =
        curve.iter().flat_map(|arc| (0..16).map(|i| arc.eval(f64::from(i) / 16.0))).collect();
    let line = |i: usize| Bezier::line(places[i], places[(i + 1) % 64]);
    let path: Vec<Bezier> = (0..64).map(line).collect();
    let sag = (0..64).fold(0.0, |most, i| {
        let half = 0.5 * distance(&places[i], &places[(i + 1) % 64]);
        f64::max(most, 10.0 - (100.0 - half * half).sqrt())
    });
    let found = follow(&path, &curve, 1e-3).unwrap();
    assert!(sag <= found.distance && found.distance < 1.03 * sag + 2e-6, "{sag} {found:?}");
}
