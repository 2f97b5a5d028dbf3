//! Where on a B-spline a place lies.
//!
//! An edge is cut out of its curve by places. A stretch whose control points all lie to one side of the place, in some
//! coordinate, does not meet it; what is left is halved until it is as small as places may be apart. Stretches in a row are
//! one meeting, whose parameter is that of the least distance.

use super::{Point, point};
use crate::geom::bezier::Bezier;
use crate::geom::nurbs::Nurbs;

/// How often a span is halved at most; a curve that stands still is as small as it gets.
const MOST_HALVES: u32 = 40;

/// The most stretches that are looked at.
const MOST: usize = 10_000;

/// The parameters at which a curve passes a place no farther than `near` from it; none where there are too many to tell.
pub(super) fn parameters(nurbs: &Nurbs, place: &Point, near: f64) -> Option<Vec<f64>> {
    let mut meetings: Vec<[f64; 2]> = Vec::new();
    let mut at = nurbs.knots()[0];
    for (piece, length) in nurbs.beziers() {
        meet(&piece, [at, at + length], (place, near), MOST_HALVES, &mut meetings);
        at += length;
        if MOST < meetings.len() {
            return None;
        }
    }
    let range = at - nurbs.knots()[0];
    let mut merged: Vec<[f64; 2]> = Vec::new();
    for [from, to] in meetings {
        match merged.last_mut() {
            Some(last) if from <= last[1] + 1e-12 * range => last[1] = to,
            _ => merged.push([from, to]),
        }
    }
    let nearest = merged.into_iter().map(|[from, to]| least(nurbs, place, from, to));
    Some(nearest.filter(|t| distance(nurbs, place, *t) <= near * near).collect())
}

/// Adds the stretches of a piece that may meet a place.
fn meet(
    piece: &Bezier,
    [from, to]: [f64; 2],
    (place, near): (&Point, f64),
    halves: u32,
    out: &mut Vec<[f64; 2]>,
) {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for p in piece.control_points() {
        for i in 0..3 {
            (low[i], high[i]) = (low[i].min(p[i]), high[i].max(p[i]));
        }
    }
    if (0..3).any(|i| place[i] < low[i] - near || high[i] + near < place[i]) || MOST < out.len() {
        return;
    }
    if halves == 0 || (0..3).all(|i| high[i] - low[i] <= near) {
        out.push([from, to]);
        return;
    }
    let middle = from.midpoint(to);
    meet(&piece.segment(0.0, 0.5), [from, middle], (place, near), halves - 1, out);
    meet(&piece.segment(0.5, 1.0), [middle, to], (place, near), halves - 1, out);
}

/// The square of the distance at a parameter.
fn distance(nurbs: &Nurbs, place: &Point, t: f64) -> f64 {
    point(&nurbs.eval(t)).iter().zip(place).map(|(x, y)| (x - y) * (x - y)).sum()
}

/// The parameter of the least distance between two, which lie as near as places may be apart: by thirds.
fn least(nurbs: &Nurbs, place: &Point, mut from: f64, mut to: f64) -> f64 {
    let (first, last) = (from, to);
    for _ in 0..80 {
        let third = (to - from) / 3.0;
        if distance(nurbs, place, from + third) <= distance(nurbs, place, to - third) {
            to -= third;
        } else {
            from += third;
        }
    }
    // An end that is as near is meant.
    let found = from.midpoint(to);
    let own = distance(nurbs, place, found);
    [first, last].into_iter().find(|end| distance(nurbs, place, *end) <= own).unwrap_or(found)
}

#[cfg(test)]
mod tests {
    use super::super::position;
    use super::*;

    #[test]
    fn a_place_is_found_as_often_as_the_curve_passes_it() {
        // A cubic that crosses itself on the line of symmetry x = 5.
        let points = [[0., 0., 0.], [20., 10., 0.], [-10., 10., 0.], [10., 0., 0.]];
        let knots = vec![0., 0., 0., 0., 2., 2., 2., 2.];
        let nurbs = Nurbs::new(3, knots, points.iter().map(position).collect(), vec![1.0; 4]).unwrap();
        let at = |t: f64| point(&nurbs.eval(t));
        for t in [0.0, 0.3, 1.0, 1.9, 2.0] {
            let found = parameters(&nurbs, &at(t), 1e-3).unwrap();
            assert!(found.len() == 1 && (found[0] - t).abs() < 1e-6, "{t}: {found:?}");
        }
        // x = 60 s(1−s)² − 30 s²(1−s) + 10 s³ is 5 at s = ½ and where s² − s + 1/10 = 0: s = ½ ± √0.15.
        let s = 0.5 - 0.15f64.sqrt();
        let found = parameters(&nurbs, &at(2.0 * s), 1e-3).unwrap();
        assert_eq!(found.len(), 2);
        assert!((found[0] - 2.0 * s).abs() < 1e-6 && (found[1] - 2.0 * (1.0 - s)).abs() < 1e-6, "{found:?}");
        assert!(parameters(&nurbs, &[5.0, 9.0, 0.0], 1e-3).unwrap().is_empty());
    }
}
