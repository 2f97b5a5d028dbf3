//! As how many cubic blocks a chain of lines would do.
//!
//! From point i to point j a cubic with the chain's tangents at both ends (through the neighbours, a parabola by chord
//! length) is compared with all points between, each at the parameter of its chord length and a few steps of Newton's
//! nearer. The farthest j within the tolerance is found by doubling and halving. It is an estimate: a fit that also
//! chooses the lengths of its tangents needs fewer. No program is made from it.

use super::partition::{Parametric, Weights, difference};
use super::shape::Shape;
use crate::geom::bezier::Bezier;
use crate::units::Position;

/// How many cubic blocks lead through `points` within `tolerance`, all axes counted alike.
pub fn cubics(points: &[Position], tolerance: f64) -> usize {
    let last = points.len().saturating_sub(1);
    let mut at = 0;
    let mut count = 0;
    while at < last {
        let mut good = at + 1;
        let mut bad = last + 1;
        let mut step = 2;
        while at + step < bad {
            if fits(points, at, at + step, tolerance) {
                good = at + step;
                step *= 2;
            } else {
                bad = at + step;
            }
        }
        if bad == last + 1 && good < last && fits(points, at, last, tolerance) {
            good = last;
        }
        while good + 1 < bad && good < last {
            let middle = good.midpoint(bad);
            if middle <= last && fits(points, at, middle, tolerance) {
                good = middle;
            } else {
                bad = middle;
            }
        }
        at = good;
        count += 1;
    }
    count
}

const ALL: Weights = Weights([1.0; 6]);

/// The unit tangent at a point of a chain: of the parabola through its neighbours by chord length.
fn tangent(points: &[Position], i: usize) -> Position {
    let (before, after) = (i.saturating_sub(1), (i + 1).min(points.len() - 1));
    let unit = |v: Position| {
        let length = ALL.norm(&v);
        v.map(|x| if length == 0.0 { 0.0 } else { x / length })
    };
    if before == i || after == i {
        // At an end: the chord's direction, mirrored about it the tangent next door.
        let (near, chord) = if before == i {
            (1.min(points.len() - 1), difference(&points[after], &points[i]))
        } else {
            (before, difference(&points[i], &points[before]))
        };
        if near == 0 || near + 1 >= points.len() {
            return unit(chord);
        }
        let (e, t) = (unit(chord), tangent(points, near));
        let along = ALL.dot(&e, &t);
        return std::array::from_fn(|k| 2.0 * along * e[k] - t[k]);
    }
    let (one, other) = (difference(&points[i], &points[before]), difference(&points[after], &points[i]));
    let (h, k) = (ALL.norm(&one), ALL.norm(&other));
    if h == 0.0 || k == 0.0 {
        return unit(difference(&points[after], &points[before]));
    }
    unit(std::array::from_fn(|a| one[a] * k / h + other[a] * h / k))
}

fn fits(points: &[Position], i: usize, j: usize, tolerance: f64) -> bool {
    let mut way = vec![0.0];
    for w in points[i..=j].windows(2) {
        way.push(way[way.len() - 1] + ALL.distance(&w[0], &w[1]));
    }
    let length = way[way.len() - 1];
    if length == 0.0 {
        return true;
    }
    let (start, end) = (points[i], points[j]);
    let (leave, arrive) = (tangent(points, i), tangent(points, j));
    let reach = length / 3.0;
    let curve = Shape::bezier(&Bezier::new(&[
        start,
        std::array::from_fn(|a| start[a] + reach * leave[a]),
        std::array::from_fn(|a| end[a] - reach * arrive[a]),
        end,
    ]));
    (1..j - i).all(|n| {
        let point = &points[i + n];
        let mut t = way[n] / length;
        for _ in 0..3 {
            let [c, rate, _] = curve.jet(t);
            let square = ALL.dot(&rate, &rate);
            if square == 0.0 {
                break;
            }
            t = (t + ALL.dot(&difference(point, &c), &rate) / square).clamp(0.0, 1.0);
        }
        ALL.distance(point, &curve.at(t)) <= tolerance
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::elementary::{cos, sin};

    #[test]
    fn a_finely_divided_circle_is_a_few_cubics() {
        // Run by its length a cubic through both ends and tangents of an arc φ misses it by R φ⁴/384: with 10 mm and
        // 0.001 mm φ is 0.4427, and 2π/φ = 14.2. Points stand at whole half degrees, so a block is at most half a degree short.
        let points: Vec<Position> = (0..=720)
            .map(|i| f64::from(i) * std::f64::consts::PI / 360.0)
            .map(|a| [10.0 * cos(a), 10.0 * sin(a), 0.0, 0.0, 0.0, 0.0])
            .collect();
        let count = cubics(&points, 1e-3);
        assert_eq!(count, 15);
    }

    #[test]
    fn corners_stay() {
        let points: Vec<Position> =
            (0..9).map(|i| [f64::from(i), if i % 2 == 0 { 0.0 } else { 1.0 }, 0.0, 0.0, 0.0, 0.0]).collect();
        assert_eq!(cubics(&points, 1e-3), 8);
        assert_eq!((cubics(&points[..1], 1e-3), cubics(&[], 1e-3)), (0, 0));
    }
}
