//! A run of points beside the spline that was made of it.
//!
//! The points are run along the spline. Of each the distance from one place of the spline is taken, near that of the point
//! before it: never less than its distance from the whole, so that the greatest is an upper bound.
//!
//! Curvature of points is that of the circle through three that follow each other, 4 · area / (a b c); of a piece
//! √(|c′|²|c″|² − (c′·c″)²) / |c′|³, at nine places. Corners, where the tangent turns, have none and are counted.

use super::bezier::Bezier;
use super::follow::foot;
use crate::units::Position;

/// In so many parts the curvature of a piece is looked at.
const PLACES: usize = 8;

/// Sine of the angle from which two pieces meet at a corner, half a degree: rounded coefficients turn a tangent by less.
const CORNER: f64 = 8.7e-3;

/// A run of points and its spline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Likeness {
    /// An upper bound on the distance of any point from the spline, mm.
    pub farthest: f64,
    /// Greatest curvature of the points, corners left out, 1/mm.
    pub before: f64,
    /// Greatest curvature of the spline, 1/mm.
    pub after: f64,
    /// How many corners the spline has.
    pub corners: usize,
}

fn minus(a: &Position, b: &Position) -> Position {
    std::array::from_fn(|i| a[i] - b[i])
}

fn dot(a: &Position, b: &Position) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn distance(a: &Position, b: &Position) -> f64 {
    dot(&minus(a, b), &minus(a, b)).sqrt()
}

/// |u|²|v|² − (u·v)², the square of the area that u and v span.
fn area2(u: &Position, v: &Position) -> f64 {
    (dot(u, u) * dot(v, v) - dot(u, v) * dot(u, v)).max(0.0)
}

/// Compares points with the pieces that were made of them, both in order.
pub fn compare(points: &[Position], pieces: &[Bezier]) -> Likeness {
    let corners: Vec<bool> = pieces.windows(2).map(|pair| turns(&pair[0], &pair[1])).collect();
    let after = pieces.iter().map(curvature).fold(0.0, f64::max);
    let mut likeness =
        Likeness { farthest: 0.0, before: 0.0, after, corners: corners.iter().filter(|c| **c).count() };
    let (mut at, mut t) = (0, 0.0);
    let mut last: [Option<Position>; 2] = [None, None];
    let mut last_at_corner = false;
    for point in points {
        if pieces.is_empty() {
            break;
        }
        let way = last[1].map_or(0.0, |before| distance(&before, point));
        let off;
        (at, t, off) = next_place(pieces, (at, t), point, way);
        likeness.farthest = likeness.farthest.max(off);
        if last[1].is_some_and(|before| distance(&before, point) == 0.0) {
            continue;
        }
        if let [Some(a), Some(b)] = last
            && !last_at_corner
        {
            let (u, v, w) = (minus(&b, &a), minus(point, &b), minus(point, &a));
            let k = 2.0 * area2(&u, &v).sqrt() / (dot(&u, &u) * dot(&v, &v) * dot(&w, &w)).sqrt();
            if k.is_finite() {
                likeness.before = likeness.before.max(k);
            }
        }
        let near = |t: f64, end: f64| (t - end).abs() < 1.0e-6;
        last_at_corner = (near(t, 1.0) && corners.get(at) == Some(&true))
            || (near(t, 0.0) && 0 < at && corners.get(at - 1) == Some(&true));
        last = [last[1], Some(*point)];
    }
    likeness
}

/// The place of the spline nearest to `point` about a known place, or `way` mm farther, and its distance. The piece before is
/// looked at too, since noise may lead points back, and the piece behind, which may go back beside this one.
fn next_place(pieces: &[Bezier], (at, t): (usize, f64), point: &Position, way: f64) -> (usize, f64, f64) {
    let mut best = (at, t, f64::INFINITY);
    // Two pieces in a row that are no nearer end the search.
    let mut worse = 0;
    for (i, piece) in pieces.iter().enumerate().skip(at.saturating_sub(1)) {
        let polygon: f64 =
            piece.control_points().windows(2).map(|pair| distance(&pair[0], &pair[1])).sum::<f64>();
        let guesses = match i.cmp(&at) {
            std::cmp::Ordering::Less => [1.0, 1.0],
            std::cmp::Ordering::Equal => [t, (t + way / polygon.max(f64::MIN_POSITIVE)).min(1.0)],
            std::cmp::Ordering::Greater => [0.0, 0.5],
        };
        let mut nearer = false;
        for guess in guesses {
            let t = foot(piece, point, guess, 0.0, 1.0);
            let off = distance(&piece.eval(t), point);
            if off < best.2 {
                best = (i, t, off);
                nearer = true;
            }
        }
        worse = if nearer || i <= at { 0 } else { worse + 1 };
        if 1 < worse || (at < i && best.0 <= i && best.1 < 1.0) {
            break;
        }
    }
    best
}

/// Whether two pieces meet at a corner.
fn turns(before: &Bezier, after: &Bezier) -> bool {
    let ([_, u, _], [_, v, _]) = (before.derivatives(1.0), after.derivatives(0.0));
    let sizes = (dot(&u, &u) * dot(&v, &v)).sqrt();
    0.0 < sizes && (dot(&u, &v) < 0.0 || CORNER < area2(&u, &v).sqrt() / sizes)
}

/// The greatest curvature of a piece at [`PLACES`] + 1 places.
fn curvature(piece: &Bezier) -> f64 {
    let at = |k: usize| {
        let [_, d, dd] = piece.derivatives(k as f64 / PLACES as f64);
        let speed2 = dot(&d, &d);
        area2(&d, &dd).sqrt() / (speed2 * speed2.sqrt())
    };
    (0..=PLACES).map(at).filter(|k| k.is_finite()).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A quarter circle of radius 10 from (10, 0), as the usual cubic.
    fn quarter() -> Bezier {
        let h = 10.0 * 4.0 / 3.0 * (2.0f64.sqrt() - 1.0);
        let place = |x: f64, y: f64| [x, y, 0.0, 0.0, 0.0, 0.0];
        Bezier::new(&[place(10.0, 0.0), place(10.0, h), place(h, 10.0), place(0.0, 10.0)])
    }

    #[test]
    fn points_of_a_circle_have_its_curvature_on_both_sides() {
        let points: Vec<Position> = (0..=90)
            .map(|k| {
                let a = f64::from(k) / crate::units::DEGREES;
                let (sin, cos) = (crate::geom::elementary::sin(a), crate::geom::elementary::cos(a));
                [10.0 * cos, 10.0 * sin, 0.0, 0.0, 0.0, 0.0]
            })
            .collect();
        let found = compare(&points, &[quarter()]);
        approx::assert_relative_eq!(found.before, 0.1, max_relative = 1e-9);
        // The cubic is off by 2.73e-4 of the radius, its curvature by 1.7 percent at most.
        assert!(found.farthest < 2.74e-3 && 2.5e-3 < found.farthest, "{}", found.farthest);
        assert!((0.1..0.102).contains(&found.after), "{}", found.after);
        assert_eq!(found.corners, 0);
    }

    #[test]
    fn a_point_beside_the_spline_is_as_far_as_it_is() {
        let place = |x: f64, y: f64| -> Position { [x, y, 0.0, 0.0, 0.0, 0.0] };
        let pieces =
            [Bezier::line(place(0.0, 0.0), place(5.0, 0.0)), Bezier::line(place(5.0, 0.0), place(5.0, 5.0))];
        let points = [place(0.0, 0.0), place(2.0, 0.25), place(5.0, 0.0), place(5.0, 5.0)];
        let found = compare(&points, &pieces);
        assert_eq!((found.farthest, found.corners, found.after), (0.25, 1, 0.0));
        // The corner itself has no curvature; at (2, 0.25) three points make a triangle of area 0.625.
        let sides = (4.0f64 + 0.0625).sqrt() * (9.0f64 + 0.0625).sqrt() * 5.0;
        approx::assert_relative_eq!(found.before, 4.0 * 0.625 / sides, max_relative = 1e-12);
    }
}
