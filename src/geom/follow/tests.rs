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

fn lines(points: &[(f64, f64)]) -> Vec<Bezier> {
    points.windows(2).map(|ends| Bezier::line(at(ends[0].0, ends[0].1), at(ends[1].0, ends[1].1))).collect()
}

fn parted(p: &[Bezier], c: &[Bezier], tolerance: f64) -> Vec<([usize; 2], f64)> {
    let rule = Rule { tolerance, direction: None, turn: f64::INFINITY };
    let all = Stream::new(p.iter().copied(), c.iter().copied(), rule);
    all.filter(|m| !(m.distance <= tolerance)).map(|m| (m.at, m.distance)).collect()
}

#[test]
fn a_path_meets_itself_exactly_and_its_parts_to_rounding() {
    let path = [quarter(0), quarter(1), Bezier::line(at(-10., 0.), at(-20., 5.))];
    let rule = Rule { tolerance: 1e-3, direction: None, turn: f64::INFINITY };
    let all: Vec<Meeting> = Stream::new(path.iter().copied(), path.iter().copied(), rule).collect();
    assert_eq!(all.len(), 3);
    assert!(all.iter().all(|m| m.alike && m.distance == 0.0));
    let halves: Vec<Bezier> =
        path.iter().flat_map(|piece| [piece.segment(0.0, 0.3), piece.segment(0.3, 1.0)]).collect();
    let all: Vec<Meeting> = Stream::new(halves.iter().copied(), path.iter().copied(), rule).collect();
    // 256 ulps of 20 mm, twice: the bound and what was found.
    assert!(all.iter().all(|m| m.distance < 1.2e-12), "{all:?}");
    assert_eq!(all.last().map(|m| m.at), Some([5, 2]));
}

#[test]
fn a_moved_point_parts_two_lines_at_that_point_alone() {
    let own = lines(&[(0., 0.), (10., 0.), (20., 0.), (30., 0.), (40., 0.), (50., 0.)]);
    let moved = lines(&[(0., 0.), (10., 0.), (20., 2.), (30., 0.), (40., 0.), (50., 0.)]);
    let found = parted(&own, &moved, 0.01);
    assert!(found.iter().all(|([i, j], _)| [1, 2].contains(i) && [1, 2].contains(j)), "{found:?}");
    let farthest = found.iter().map(|(_, d)| *d).fold(0.0, f64::max);
    assert!((2.0..2.1).contains(&farthest), "{farthest}");
    // A point that is left out of a straight line is none.
    let fewer = lines(&[(0., 0.), (20., 0.), (50., 0.)]);
    assert!(parted(&own, &fewer, 1e-9).is_empty());
    // Joints that neither shares with the other: together again on a piece.
    let other = lines(&[(0., 0.), (13., 0.), (21., 2.), (27., 0.), (35., 0.), (50., 0.)]);
    let found = parted(&own, &other, 0.01);
    assert!(!found.is_empty() && found.iter().all(|([_, j], _)| [1, 2].contains(j)), "{found:?}");
}

#[test]
fn a_part_run_twice_is_a_difference() {
    let once = lines(&[(0., 0.), (10., 0.), (10., 5.), (0., 5.)]);
    let twice = lines(&[(0., 0.), (10., 0.), (0., 0.), (10., 0.), (10., 5.), (0., 5.)]);
    for (p, c) in [(&once, &twice), (&twice, &once)] {
        let farthest = parted(p, c, 0.01).iter().map(|(_, d)| *d).fold(0.0, f64::max);
        // Half the way back at least, whatever the map.
        assert!(5.0 <= farthest, "{farthest}");
    }
    // An end that is missing, and one that is too much.
    assert!(!parted(&once[..2], &once, 0.01).is_empty());
    assert!(!parted(&once, &once[..2], 0.01).is_empty());
}

#[test]
fn a_way_back_along_the_same_line_is_a_difference() {
    let straight = lines(&[(0., 0.), (20., 0.), (30., 0.)]);
    let back = lines(&[(0., 0.), (10., 0.), (6., 0.), (20., 0.), (30., 0.)]);
    for (p, c) in [(&straight, &back), (&back, &straight)] {
        // Whoever waits half way is 2 mm off, and no map does better.
        let farthest = parted(p, c, 1.0).iter().map(|(_, d)| *d).fold(0.0, f64::max);
        assert!(2.0 <= farthest, "{farthest}");
        assert!(!parted(p, c, 1.9).is_empty());
    }
}
