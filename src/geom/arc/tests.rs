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

/// A frame whose axis is (2, −1, 2)/3.
fn tilted() -> Frame {
    let (frame, along) = Frame::about([2.0, -1.0, 2.0], 1e-6).unwrap();
    assert!(along && frame.plane().is_none());
    frame
}

fn placed(frame: Frame, u: f64, v: f64, w: f64) -> Position {
    let [x, y, z] = frame.global([u, v, w]);
    at(x, y, z)
}

#[test]
fn frames_are_right_handed_and_orthonormal() {
    for axis in [[2.0, -1.0, 2.0], [0.0, 0.6, 0.8], [1e-3, -1.0, 0.0], [1.0, 1.0, 1.0], [-3.0, 1.0, 2e-3]] {
        let (frame, along) = Frame::about(axis, 1e-6).unwrap();
        let [u, v, w] = frame.axes();
        let dot = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        let length = dot(axis, axis).sqrt();
        // Some roundings of numbers up to 1.
        for (a, b, one) in [(u, u, 1.0), (v, v, 1.0), (w, w, 1.0), (u, v, 0.0), (v, w, 0.0), (w, u, 0.0)] {
            assert!((dot(a, b) - one).abs() < 1e-15, "{axis:?} {a:?} {b:?}");
        }
        let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        assert!(dot(cross, w) > 0.999 && along && (dot(w, axis) - length).abs() < 1e-15 * length);
        let back = frame.local(frame.global([1.0, 2.0, 3.0]));
        assert!([1.0, 2.0, 3.0].iter().zip(back).all(|(x, y)| (x - y).abs() < 4e-15), "{back:?}");
    }
    let near = |axis| Frame::about(axis, 1e-6).map(|(frame, along)| (frame.plane(), along));
    assert_eq!(near([0.0, 0.0, -1.0]), Some((Some(Plane::Xy), false)));
    assert_eq!(near([0.0, 5.0, 4e-6]), Some((Some(Plane::Zx), true)));
    assert_eq!(near([0.0, 1.0, 4e-6]), Some((None, true)));
    assert_eq!(near([0.0; 3]), None);
    assert_eq!(near([f64::NAN, 0.0, 1.0]), None);
}

/// In a tilted plane everything is as in X Y, seen in its own axes.
#[test]
fn a_tilted_arc_is_one_of_its_frame() {
    let frame = tilted();
    let (start, end) = (placed(frame, 5.0, 0.0, 1.0), placed(frame, 0.0, 5.0, 3.0));
    let helix = Arc::new(frame, Sense::CounterClockwise, start, end, [0.0, 0.0]).unwrap().with_turns(2);
    let flat = arc(Sense::CounterClockwise, at(5.0, 0.0, 1.0), at(0.0, 5.0, 3.0), [0.0, 0.0]).with_turns(2);
    assert_relative_eq!(helix.sweep(), 4.5 * std::f64::consts::PI, epsilon = 1e-14);
    assert_relative_eq!(helix.length(), flat.length(), epsilon = 1e-13);
    for i in 0..=50 {
        let t = f64::from(i) / 50.0;
        for (p, q) in helix.jet(t).iter().zip(flat.jet(t)) {
            let local = frame.local([p[0], p[1], p[2]]);
            // The second derivative has the size R σ², some 1000 mm.
            assert!((0..3).all(|k| (local[k] - q[k]).abs() < 2e-12), "{local:?} {q:?}");
        }
    }
    let (low, high) = helix.range();
    for i in 0..=2000 {
        let p = helix.eval(f64::from(i) / 2000.0);
        assert!((0..3).all(|k| low[k] - 1e-12 <= p[k] && p[k] <= high[k] + 1e-12), "{p:?} {low:?} {high:?}");
    }
    // Of a circle the range is tight: R times the share of each axis in the plane.
    let circle = Arc::new(frame, Sense::Clockwise, start, start, [0.0, 0.0]).unwrap();
    assert!(circle.is_full() && circle.part(0.0, 0.5).turns() == 0.5);
    let (low, high) = circle.range();
    let [.., w] = frame.axes();
    for k in 0..3 {
        assert_relative_eq!(high[k] - low[k], 10.0 * (1.0 - w[k] * w[k]).sqrt(), epsilon = 1e-12);
    }
}

#[test]
fn parts_meet_and_make_the_whole() {
    for frame in [tilted(), Plane::Zx.into()] {
        let (start, end) = (placed(frame, 5.0, 0.0, 1.0), placed(frame, 0.0, 5.0, 10.0));
        let whole = Arc::new(frame, Sense::Clockwise, start, end, [0.0, 0.0]).unwrap().with_turns(3);
        let parts = whole.by_turns(2);
        assert_eq!((parts.len(), parts[0].turns()), (2, 2.0));
        assert_relative_eq!(parts[1].turns(), 1.75, epsilon = 1e-15);
        assert_eq!((parts[0].start(), parts[1].end()), (start, end));
        assert_eq!(parts[0].end(), parts[1].start());
        assert!(parts[0].is_full() && !parts[1].is_full());
        let (first, second) = (parts[0].eval(0.9), whole.eval(1.8 / 3.75));
        assert!((0..3).all(|i| (first[i] - second[i]).abs() < 1e-13), "{first:?} {second:?}");
        let (part, middle) = (whole.part(0.25, 0.75), whole.eval(0.5));
        assert!((0..3).all(|i| (part.eval(0.5)[i] - middle[i]).abs() < 1e-13));
        assert_relative_eq!(part.turns(), 1.875);
        assert_relative_eq!(part.rise(), 4.5, epsilon = 1e-14);
    }
}

/// Turned into the frame of its plane, an arc is one of X Y; each place of it is the place turned.
#[test]
fn a_turned_arc_runs_through_turned_places() {
    let frame = tilted();
    let [u, v, w] = frame.axes();
    let (start, end) = (placed(frame, 5.0, 1.0, 2.0), placed(frame, 1.0, 5.0, 3.0));
    for (rotation, plane) in [
        ([u, v, w], Some(Plane::Xy)),
        ([u, v.map(|x| -x), w.map(|x| -x)], Some(Plane::Xy)),
        ([v, w, u], Some(Plane::Zx)),
        ([[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, 1.0]], None),
    ] {
        for end in [end, placed(frame, 5.0, 1.0, 4.0)] {
            let own = Arc::new(frame, Sense::Clockwise, start, end, [1.0, 1.0]).unwrap();
            let turned = own.turned(&Rotation(rotation), 1e-12);
            assert_eq!(turned.plane(), plane);
            assert_eq!(turned.is_full(), own.is_full());
            assert_eq!(turned.turns(), own.turns());
            for i in 0..=20 {
                let (p, q) = (own.eval(f64::from(i) / 20.0), turned.eval(f64::from(i) / 20.0));
                for (k, row) in rotation.iter().enumerate() {
                    let x: f64 = (0..3).map(|j| row[j] * p[j]).sum();
                    assert!((x - q[k]).abs() < 1e-14 * 10.0, "{i} {k}: {x} {}", q[k]);
                }
            }
        }
    }
}

/// The bound between two arcs in space against many places at equal shares.
#[test]
fn arcs_in_space_are_no_farther_apart_than_the_bound() {
    let frame = tilted();
    let center = frame.global([0.0, 0.0, 1.0]);
    let by = |axis: [f64; 3], start: Position, end: Position, center: [f64; 3], sense: Sense| {
        let (frame, _) = Frame::about(axis, 0.0).unwrap();
        let [u, v, _] = frame.local(center);
        Arc::new(frame, sense, start, end, [u, v]).unwrap()
    };
    let (start, end) = (placed(frame, 5.0, 0.0, 1.0), placed(frame, -4.0, 3.0, 1.0));
    let asked = by(frame.axes()[2], start, end, center, Sense::CounterClockwise);
    let moved = |p: Position, d: [f64; 3]| at(p[0] + d[0], p[1] + d[1], p[2] + d[2]);
    for (axis, first, last, by_center) in [
        ([2.0, -1.0, 2.0], [0.0; 3], [0.0; 3], [0.0; 3]),
        ([2.001, -1.0, 2.0], [1e-3, 0.0, -1e-3], [0.0, 2e-3, 0.0], [5e-4, 0.0, 1e-3]),
        ([2.0, -0.99, 2.01], [0.0, 1e-3, 0.0], [1e-3, 0.0, 0.0], [0.0, -1e-3, 0.0]),
        ([2.0, -1.0, 2.0], [0.0; 3], [0.0, 0.0, 0.5], [0.0; 3]),
    ] {
        let around: [f64; 3] = std::array::from_fn(|i| center[i] + by_center[i]);
        let other = by(axis, moved(start, first), moved(end, last), around, Sense::CounterClockwise);
        let seen = (0..=400).fold(0.0f64, |worst, i| {
            let (p, q) = (asked.eval(f64::from(i) / 400.0), other.eval(f64::from(i) / 400.0));
            worst.max(p.iter().zip(&q).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt())
        });
        let bound = asked.apart(&other);
        assert!(seen <= bound, "{seen} {bound}");
        // Ends that do not fit the centre are counted in full.
        assert!(bound <= 1.1 * seen + 2.0 * other.misfit() + 1e-11, "{seen} {bound}");
    }
    // The other way round, or about the other side, is another arc.
    let back = by(frame.axes()[2], start, end, center, Sense::Clockwise);
    assert!(9.0 < asked.apart(&back), "{}", asked.apart(&back));
    // A flat arc of which nobody knows the centre well: 1000 mm away give or take 1 mm, and the arc the same to 0.02 mm.
    let flat = |radius: f64| {
        let ends = [at(-10.0, 0.0, 0.0), at(10.0, 0.0, 0.0)];
        let depth = (radius * radius - 100.0).sqrt();
        by([0.0, 0.6, 0.8], ends[0], ends[1], [0.0, -0.8 * depth, 0.6 * depth], Sense::Clockwise)
    };
    let apart = flat(1000.0).apart(&flat(1001.0));
    // The sagitta is 50/R, up to 1/R³: it differs by 5e-5.
    assert!((4.9e-5..6e-5).contains(&apart), "{apart}");
}
