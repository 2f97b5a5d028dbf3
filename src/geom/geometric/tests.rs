//! How few, and how near.

use super::super::follow::follow;
use super::*;

fn at(x: f64, y: f64) -> Position {
    [x, y, 0.0, 0.0, 0.0, 0.0]
}

/// A circle of radius 10 as four rational quadratics.
fn circle() -> Vec<Bezier> {
    let corners = [at(10., 0.), at(10., 10.), at(0., 10.), at(-10., 10.), at(-10., 0.)];
    let below = [at(-10., 0.), at(-10., -10.), at(0., -10.), at(10., -10.), at(10., 0.)];
    let arcs = [&corners[0..3], &corners[2..5], &below[0..3], &below[2..5]];
    arcs.map(|points| {
        let mut arc = Bezier::new(points);
        arc.weights[1] = 0.5f64.sqrt();
        arc
    })
    .to_vec()
}

#[test]
fn a_circle_takes_no_more_cubics_than_its_best_ones() {
    let chain = Chain::new(&circle()).unwrap();
    // The error of an arc of angle θ is (4/27 sin⁶(θ/4)/cos²(θ/4) at best levelled to 0.105892/0.148148 of it) R: for
    // 8 arcs 4.24e-6·R·0.7148 = 3.0e-5 mm, for 6 arcs 1.7e-4 mm, for 7 6.7e-5 mm.
    let pieces = cubics(&chain, 1.0e-4).unwrap();
    assert_eq!(pieces.len(), 7);
    let found = follow(&pieces, chain.pieces(), 1.0e-4).unwrap();
    assert!(found.distance < 1.0e-4, "{found:?}");
    for (before, after) in pieces.iter().zip(&pieces[1..]) {
        assert_eq!(before.end(), after.start());
        let d = |p: &Position, q: &Position| std::array::from_fn::<f64, 6, _>(|i| q[i] - p[i]);
        let (a, b) = (d(&before.points[2], &before.points[3]), d(&after.points[0], &after.points[1]));
        let sine = (a[0] * b[1] - a[1] * b[0]) / (dot(&a, &a) * dot(&b, &b)).sqrt();
        assert!(sine.abs() < 1.0e-8, "{sine}");
    }
}

#[test]
fn errors_fall_with_the_sixth_power() {
    let chain = Chain::new(&circle()).unwrap();
    let count = |tolerance: f64| cubics(&chain, tolerance).unwrap().len() as f64;
    // 10⁶ in the tolerance are 10 in the number.
    let rate = count(1.0e-9) / count(1.0e-3);
    assert!((8.0..12.5).contains(&rate), "{rate}");
}

#[test]
fn chords_hold_the_tolerance() {
    let chain = Chain::new(&circle()).unwrap();
    let points = chords(&chain, 1.0e-3).unwrap();
    // The sagitta R(1 − cos(π/n)) is 1e-3 at n = 222.1; the last is left over and all share it.
    assert!((222..=230).contains(&points.len()), "{}", points.len());
    let mut from = at(10., 0.);
    let path: Vec<Bezier> =
        points.iter().map(|to| Bezier::line(std::mem::replace(&mut from, *to), *to)).collect();
    assert!(follow(&path, chain.pieces(), 1.0e-3).unwrap().distance < 1.0e-3);
}

#[test]
fn corners_are_kept() {
    let points = [at(0., 0.), at(10., 0.), at(10., 5.), at(3., 5.)];
    let lines: Vec<Bezier> = points.windows(2).map(|w| Bezier::line(w[0], w[1])).collect();
    let pieces = cubics(&Chain::new(&lines).unwrap(), 1.0e-3).unwrap();
    assert_eq!(pieces.iter().map(Bezier::end).collect::<Vec<_>>(), points[1..]);
}

#[test]
fn a_space_curve_is_followed() {
    // A quintic in three coordinates with a bend and a twist.
    let quintic = Bezier::new(&[
        [0., 0., 0., 0., 0., 0.],
        [10., 5., 1., 0., 0., 0.],
        [20., -8., 9., 0., 0., 0.],
        [25., 14., -6., 0., 0., 0.],
        [40., 2., 3., 0., 0., 0.],
        [50., 0., 5., 0., 0., 0.],
    ]);
    let chain = Chain::new(&[quintic]).unwrap();
    for (tolerance, most) in [(1.0e-2, 8), (1.0e-3, 12), (1.0e-5, 30)] {
        let pieces = cubics(&chain, tolerance).unwrap();
        let found = follow(&pieces, chain.pieces(), tolerance).unwrap();
        assert!(found.distance < tolerance && pieces.len() <= most, "{} {found:?}", pieces.len());
    }
}
