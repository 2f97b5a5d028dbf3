//! Arcs by their closed forms, and the bounds against many places.

use super::*;
use approx::assert_relative_eq;

fn at(x: f64, y: f64, z: f64) -> Position {
    [x, y, z, 0.0, 0.0, 0.0]
}

fn arc(sense: Sense, start: Position, end: Position, center: [f64; 2]) -> Arc {
    Arc::new(Plane::Xy, sense, start, end, center).unwrap()
}

#[test]
fn directions_of_every_octant() {
    for k in -15..=16 {
        let angle = f64::from(k) * std::f64::consts::PI / 16.0;
        let found = direction(elementary::sin(angle), elementary::cos(angle));
        assert!((found - angle).abs() < 1e-15 || (found - angle).abs() > 6.0, "{k}: {found}");
    }
}

#[test]
fn quarters_turns_and_helices() {
    let quarter = arc(Sense::CounterClockwise, at(5.0, 0.0, 1.0), at(0.0, 5.0, 3.0), [0.0, 0.0]);
    assert_relative_eq!(quarter.sweep(), std::f64::consts::FRAC_PI_2);
    let middle = quarter.eval(0.5);
    assert_relative_eq!(middle[0], 12.5f64.sqrt(), epsilon = 1e-14);
    assert_eq!(middle[2], 2.0);
    let other = arc(Sense::Clockwise, at(5.0, 0.0, 1.0), at(0.0, 5.0, 1.0), [0.0, 0.0]);
    assert_relative_eq!(other.sweep(), -1.5 * std::f64::consts::PI);
    assert_relative_eq!(other.length(), 7.5 * std::f64::consts::PI);
    let full = arc(Sense::Clockwise, at(5.0, 0.0, 0.0), at(5.0, 0.0, -2.0), [0.0, 0.0]);
    assert!(full.is_full());
    assert_eq!(full.sweep(), -TURN);
    let (low, high) = full.range();
    assert_eq!((low[0], high[0], low[1], high[1], low[2]), (-5.0, 5.0, -5.0, 5.0, -2.0));
    let (low, high) = quarter.range();
    assert_eq!((low[0], high[0], low[1], high[1]), (0.0, 5.0, 0.0, 5.0));
    // In the plane Z X an arc from Z to X is counter-clockwise about Y.
    let zx = Arc::new(Plane::Zx, Sense::CounterClockwise, at(0.0, 0.0, 5.0), at(5.0, 0.0, 0.0), [0.0, 0.0]);
    assert_relative_eq!(zx.unwrap().sweep(), std::f64::consts::FRAC_PI_2);
}

#[test]
fn a_centre_beside_the_middle_is_moved() {
    let rounded = arc(Sense::CounterClockwise, at(5.0001, 0.0, 0.0), at(0.0, 5.0, 0.0), [0.0, 0.0]);
    let [u, v] = rounded.center();
    let radius = |p: Position| ((p[0] - u) * (p[0] - u) + (p[1] - v) * (p[1] - v)).sqrt();
    assert_relative_eq!(radius(rounded.start()), radius(rounded.end()), epsilon = 1e-14);
    assert!(rounded.misfit() < 1e-4, "{}", rounded.misfit());
    // Ends 1e-4 apart say nothing about the centre.
    let almost = arc(Sense::CounterClockwise, at(5.0, 0.0, 0.0), at(5.0001, -0.0001, 0.0), [0.0, 0.0]);
    assert_eq!(almost.center(), [0.0, 0.0]);
    assert!(6.0 < almost.sweep());
    for bad in [[5.0, 0.0], [f64::NAN, 0.0]] {
        assert!(Arc::new(Plane::Xy, Sense::Clockwise, at(5.0, 0.0, 0.0), at(0.0, 5.0, 0.0), bad).is_err());
    }
}

/// The bound against a hundred points of the path that the numbers mean, at equal shares of their sweeps.
#[test]
fn the_bound_holds_what_it_says() {
    let asked = arc(Sense::CounterClockwise, at(5.0, 0.0, 0.0), at(-3.0, 4.0, -1.0), [0.0, 0.0]);
    for (start, end, center) in [
        (at(5.0, 0.0, 0.0), at(-3.0, 4.0, -1.0), [0.0, 0.0]),
        (at(5.001, 0.0, 0.0), at(-3.0, 4.001, -1.0), [0.0005, -0.0005]),
        (at(5.0, 0.002, 0.001), at(-3.001, 4.0, -1.002), [0.001, 0.001]),
    ] {
        let bound = asked.deviation((Plane::Xy, Sense::CounterClockwise), start, end, center, 0);
        let written = arc(Sense::CounterClockwise, start, end, center);
        let seen = (0..=100).fold(0.0f64, |worst, i| {
            let (p, q) = (asked.eval(f64::from(i) / 100.0), written.eval(f64::from(i) / 100.0));
            worst.max(p.iter().zip(&q).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt())
        });
        assert!(seen <= bound, "{seen} {bound}");
        assert!(bound < 6.0 * seen + 1e-12, "{seen} {bound}");
    }
    let wrong = |plane, sense| asked.deviation((plane, sense), asked.start(), asked.end(), asked.center(), 0);
    assert_eq!(wrong(Plane::Xy, Sense::Clockwise), f64::INFINITY);
    assert_eq!(wrong(Plane::Yz, Sense::CounterClockwise), f64::INFINITY);
    // A standstill is no full circle, and a full circle no standstill.
    let full = arc(Sense::Clockwise, at(5.0, 0.0, 0.0), at(5.0, 0.0, 0.0), [0.0, 0.0]);
    let little = full.deviation(
        (Plane::Xy, Sense::Clockwise),
        at(5.0, 0.0, 0.0),
        at(5.0, -0.0001, 0.0),
        [0.0, 0.0],
        0,
    );
    assert!(30.0 < little, "{little}");
}
