//! Directions of the tool: three coordinates whose length means nothing.
//!
//! # Between two directions
//!
//! A straight block is compared as the chord between its two directions. A control turns in the same plane, evenly: at the
//! share s by sθ, where the chord is at φ with
//!
//! ```text
//! tan φ = s sin θ / (1 − s + s cos θ)          |φ − sθ| ≤ 0.02 θ³          0 ≤ θ ≤ 1
//! ```
//!
//! φ − sθ is −s(1 − s)(1 − 2s) θ³/6 to leading order, at most 0.016 θ³; a test holds the bound over the range.

use super::bezier::Bezier;
use super::elementary::{atan, atan2, cos, sin};
use crate::units::{DEGREES, Position};

/// The components of a direction, from `first` on.
fn components(p: &Position, first: usize) -> [f64; 3] {
    [p[first], p[first + 1], p[first + 2]]
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// The length of the direction in a position; 1 where it has none.
pub fn length(p: &Position, first: usize) -> f64 {
    let d = components(p, first);
    let length = dot(&d, &d).sqrt();
    if 0.0 < length && length.is_finite() { length } else { 1.0 }
}

/// A position with its direction at length 1.
pub fn unit(p: &Position, first: usize) -> Position {
    let length = length(p, first);
    let mut place = *p;
    place[first..first + 3].iter_mut().for_each(|x| *x /= length);
    place
}

/// Pieces with their directions so many times as long.
pub fn scaled(pieces: &[Bezier], first: Option<usize>, by: f64) -> Vec<Bezier> {
    let mut pieces = pieces.to_vec();
    if let Some(first) = first.filter(|_| by != 1.0) {
        for piece in &mut pieces {
            for point in &mut piece.points[..=piece.degree] {
                point[first..first + 3].iter_mut().for_each(|x| *x *= by);
            }
        }
    }
    pieces
}

/// The angle between two vectors, radians: 2 atan(|a − b| / |a + b|) of the unit vectors. Of one without a length 0.
pub fn angle(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    let (size_a, size_b) = (dot(a, a).sqrt(), dot(b, b).sqrt());
    if !(0.0 < size_a && 0.0 < size_b) {
        return 0.0;
    }
    let less: [f64; 3] = std::array::from_fn(|i| a[i] / size_a - b[i] / size_b);
    let more: [f64; 3] = std::array::from_fn(|i| a[i] / size_a + b[i] / size_b);
    2.0 * atan2(dot(&less, &less).sqrt(), dot(&more, &more).sqrt())
}

/// The angle between the directions of two positions, radians.
pub fn between(p: &Position, q: &Position, first: usize) -> f64 {
    angle(&components(p, first), &components(q, first))
}

/// The greatest angle between two vectors whose cross product is at most `cross` long and whose lengths have at least the
/// product `least`, radians, where they are less than a right angle apart; none where nothing can be said.
pub fn apart(cross: f64, least: f64) -> Option<f64> {
    let share = cross / least;
    if !(0.0..1.0).contains(&share) {
        return None;
    }
    // asin x = atan(x / √(1 − x²))
    Some(atan(share / ((1.0 - share) * (1.0 + share)).sqrt()))
}

/// How far an even turn may be ahead of its chord where both turn by `theta`, radians; none beyond 1 radian.
pub fn pace(theta: f64) -> Option<f64> {
    (theta <= 1.0).then_some(0.02 * theta * theta * theta)
}

/// How many places of a turn are looked at.
const PLACES: u32 = 16;

/// How far a control that turns its rotary axes evenly, C about Z and a tilt against Z, leaves the great circle between two
/// directions, radians, seen at some places. Next to Z the turn about it is large and the way is far from the great circle.
pub fn tilt_departure(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    let polar = |d: &[f64; 3]| {
        let size = dot(d, d).sqrt();
        let tilt = angle(d, &[0.0, 0.0, size]);
        let flat = (d[0] * d[0] + d[1] * d[1]).sqrt();
        let turn = if flat <= 1.0e-12 * size { None } else { Some(atan2(d[1], d[0])) };
        (tilt, turn)
    };
    let ((tilt_a, turn_a), (tilt_b, turn_b)) = (polar(a), polar(b));
    // An upright tool has any turn: C stays where it is or will be.
    let (turn_a, turn_b) = match (turn_a, turn_b) {
        (Some(a), Some(b)) => (a, b),
        (Some(a), None) => (a, a),
        (None, Some(b)) => (b, b),
        (None, None) => (0.0, 0.0),
    };
    let whole = 2.0 * std::f64::consts::PI;
    let by = turn_b - turn_a - whole * ((turn_b - turn_a) / whole).round();
    let theta = angle(a, b);
    let (size_a, size_b) = (dot(a, a).sqrt(), dot(b, b).sqrt());
    let mut worst = 0.0f64;
    for i in 1..PLACES {
        let s = f64::from(i) / f64::from(PLACES);
        let (tilt, turn) = (tilt_a + s * (tilt_b - tilt_a), turn_a + s * by);
        let own = [sin(tilt) * cos(turn), sin(tilt) * sin(turn), cos(tilt)];
        let (p, q) = (sin((1.0 - s) * theta), sin(s * theta));
        let even: [f64; 3] = std::array::from_fn(|k| p * a[k] / size_a + q * b[k] / size_b);
        worst = worst.max(angle(&own, &even));
    }
    worst
}

/// The angle of a direction to Z, degrees.
pub fn tilt(d: &[f64; 3]) -> f64 {
    angle(d, &[0.0, 0.0, 1.0]) * DEGREES
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_of_known_vectors() {
        for (a, b, degrees) in [
            ([1.0, 0.0, 0.0], [0.0, 2.0, 0.0], 90.0),
            ([0.0, 0.0, 3.0], [0.0, 0.0, -1.0], 180.0),
            ([1.0, 1.0, 0.0], [5.0, 0.0, 0.0], 45.0),
            ([0.0, 1.0, 1.0], [0.0, 2.0, 2.0], 0.0),
        ] {
            approx::assert_relative_eq!(angle(&a, &b) * DEGREES, degrees, epsilon = 1e-12);
        }
    }

    #[test]
    fn the_pace_of_a_chord_is_bounded() {
        for i in 1..=100 {
            let theta = f64::from(i) / 100.0;
            for k in 0..=200 {
                let s = f64::from(k) / 200.0;
                let phi = atan(s * sin(theta) / (1.0 - s + s * cos(theta)));
                assert!((phi - s * theta).abs() <= pace(theta).unwrap(), "{theta} {s}");
            }
        }
        assert_eq!(pace(1.5), None);
    }

    #[test]
    fn the_bound_of_the_angle_is_reached() {
        let (p, c) = ([0.3, -0.1, 2.0], [0.1, 0.2, 1.0]);
        let cross: [f64; 3] =
            std::array::from_fn(|i| p[(i + 1) % 3] * c[(i + 2) % 3] - p[(i + 2) % 3] * c[(i + 1) % 3]);
        let least = (dot(&p, &p) * dot(&c, &c)).sqrt();
        let bound = apart(dot(&cross, &cross).sqrt(), least).unwrap();
        approx::assert_relative_eq!(bound, angle(&p, &c), max_relative = 1e-12);
        assert_eq!(apart(1.0, 1.0), None);
        assert_eq!(apart(0.1, -1.0), None);
    }

    #[test]
    fn even_rotary_axes_leave_the_great_circle() {
        // At equal tilt of 90 degrees both are the equator; at equal tilt t a quarter turn of C stays on its circle of
        // latitude, while the great circle rises to tan t' = tan t cos 45 in its middle.
        assert!(tilt_departure(&[1.0, 0.0, 0.0], &[0.0, 1.0, 0.0]) < 1e-12);
        let t = 0.5f64;
        let (a, b) = ([sin(t), 0.0, cos(t)], [0.0, sin(t), cos(t)]);
        let expected = t - atan(sin(t) / cos(t) * (0.5f64).sqrt());
        approx::assert_relative_eq!(tilt_departure(&a, &b), expected, max_relative = 1e-9);
        // From upright C stands where it will be.
        assert!(tilt_departure(&[0.0, 0.0, 1.0], &b) < 1e-12);
    }
}
