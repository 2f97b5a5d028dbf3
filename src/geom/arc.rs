//! Arcs and helices whose axis is X, Y or Z.
//!
//! In a plane with the right-handed axes u, v, w an arc of centre c and radius R runs from the angle α through the sweep σ,
//! and w goes along evenly:
//!
//! ```text
//! u = c_u + R cos(α + tσ)     v = c_v + R sin(α + tσ)     w = w0 + t (w1 − w0)     0 ≤ t ≤ 1,  0 < |σ| ≤ 2π
//! ```
//!
//! # From start, end and centre
//!
//! Three rounded places rarely lie on one circle: |s − c| and |e − c| differ. The centre is then moved to the nearest
//! place that is as far from the one as from the other, along the chord d = e − s:
//!
//! ```text
//! c′ = c + d · (m − c)·d / |d|²          m = (s + e)/2
//! ```
//!
//! The chord of an almost full circle is so short that c′ may lie far away; then c stays, the radius is the mean, and
//! the ends are missed by half the difference. [`Arc::misfit`] says how far all this is from what was stated.
//!
//! # Deviation
//!
//! A control that is given start, end and centre c₂ runs radii between |s₂ − c₂| and |e₂ − c₂|. At equal t, by the triangle
//! inequality,
//!
//! ```text
//! |p − p₂| ≤ |c − c₂| + max(|R − |s₂ − c₂||, |R − |e₂ − c₂||) + R max(|α − α₂|, |α + σ − α₂ − σ₂|) + max(|w0 − w0₂|, |w1 − w1₂|)
//! ```

use super::elementary;
use crate::units::{MAX_AXES, Position};

/// 2π.
const TURN: f64 = 2.0 * std::f64::consts::PI;

/// The plane of an arc, and its right-handed axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plane {
    /// X Y, about Z.
    Xy,
    /// Z X, about Y.
    Zx,
    /// Y Z, about X.
    Yz,
}

impl Plane {
    /// Which coordinates are u, v and w.
    pub fn axes(self) -> [usize; 3] {
        match self {
            Plane::Xy => [0, 1, 2],
            Plane::Zx => [2, 0, 1],
            Plane::Yz => [1, 2, 0],
        }
    }
}

/// Which way round, seen against w.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sense {
    /// Clockwise: G2.
    Clockwise,
    /// Counter-clockwise: G3.
    CounterClockwise,
}

impl Sense {
    /// The other one.
    #[must_use]
    pub fn reversed(self) -> Sense {
        match self {
            Sense::Clockwise => Sense::CounterClockwise,
            Sense::CounterClockwise => Sense::Clockwise,
        }
    }
}

/// An arc or one turn of a helix at most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    plane: Plane,
    sense: Sense,
    start: Position,
    end: Position,
    center: [f64; 2],
    radius: f64,
    angle: f64,
    sweep: f64,
    misfit: f64,
}

/// What is wrong with an arc.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ArcError {
    /// A coordinate is not finite.
    #[error("the arc has a coordinate that is no number")]
    NotFinite,
    /// Start or end lie on the centre.
    #[error("the arc has no radius: it starts or ends at its centre")]
    NoRadius,
}

/// atan2(y, x), in radians between −π and π.
fn direction(y: f64, x: f64) -> f64 {
    let half = std::f64::consts::FRAC_PI_2;
    if x.abs() < y.abs() {
        return half.copysign(y) - elementary::atan(x / y);
    }
    if x == 0.0 {
        return 0.0;
    }
    let angle = elementary::atan(y / x);
    if 0.0 < x { angle } else { angle + (2.0 * half).copysign(y) }
}

/// `start`, turned by `sweep` radians about `center`, counter-clockwise being positive; the other axes as `end` has them.
pub fn turned(plane: Plane, start: Position, end: Position, center: [f64; 2], sweep: f64) -> Position {
    let [u, v, _] = plane.axes();
    let (x, y) = (start[u] - center[0], start[v] - center[1]);
    let (cos, sin) = (elementary::cos(sweep), elementary::sin(sweep));
    let mut place = end;
    place[u] = center[0] + x * cos - y * sin;
    place[v] = center[1] + x * sin + y * cos;
    place
}

impl Arc {
    /// The arc from `start` to `end` about `center` (u, v). A start that is the end in u and v is a full turn.
    ///
    /// # Errors
    /// See [`ArcError`].
    pub fn new(
        plane: Plane,
        sense: Sense,
        start: Position,
        end: Position,
        center: [f64; 2],
    ) -> Result<Arc, ArcError> {
        if !start.iter().chain(&end).chain(&center).all(|x| x.is_finite()) {
            return Err(ArcError::NotFinite);
        }
        let [u, v, _] = plane.axes();
        let (s, e) = ([start[u], start[v]], [end[u], end[v]]);
        let size =
            |a: [f64; 2], b: [f64; 2]| ((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1])).sqrt();
        let (rs, re) = (size(s, center), size(e, center));
        if rs == 0.0 || re == 0.0 || !rs.is_finite() || !re.is_finite() {
            return Err(ArcError::NoRadius);
        }
        let chord = [e[0] - s[0], e[1] - s[1]];
        let square = chord[0] * chord[0] + chord[1] * chord[1];
        let mut moved = center;
        if 0.0 < square {
            let along =
                (0.5 * (s[0] + e[0]) - center[0]) * chord[0] + (0.5 * (s[1] + e[1]) - center[1]) * chord[1];
            let k = along / square;
            moved = [center[0] + k * chord[0], center[1] + k * chord[1]];
        }
        // As far as the radii differ, or the chord is too short to say anything about the centre.
        let far = size(moved, center);
        let center_kept = (rs - re).abs() < far;
        let (place, radius, misfit) = if center_kept {
            (center, 0.5 * (rs + re), 0.5 * (rs - re).abs())
        } else {
            (moved, size(s, moved), far)
        };
        let angle = direction(s[1] - place[1], s[0] - place[0]);
        let last = direction(e[1] - place[1], e[0] - place[0]);
        let mut sweep = match sense {
            Sense::CounterClockwise => last - angle,
            Sense::Clockwise => angle - last,
        };
        if sweep <= 0.0 {
            sweep += TURN;
        }
        if s == e {
            sweep = TURN;
        }
        let sweep = match sense {
            Sense::CounterClockwise => sweep,
            Sense::Clockwise => -sweep,
        };
        Ok(Arc { plane, sense, start, end, center: place, radius, angle, sweep, misfit })
    }

    /// The same arc with other coordinates beside X Y Z, which `map` must leave alone.
    #[must_use]
    pub fn mapped_along(mut self, map: impl Fn(&Position) -> Position) -> Arc {
        (self.start, self.end) = (map(&self.start), map(&self.end));
        self
    }

    /// Its plane.
    pub fn plane(&self) -> Plane {
        self.plane
    }

    /// Which way round.
    pub fn sense(&self) -> Sense {
        self.sense
    }

    /// Where it starts.
    pub fn start(&self) -> Position {
        self.start
    }

    /// Where it ends.
    pub fn end(&self) -> Position {
        self.end
    }

    /// Its centre (u, v).
    pub fn center(&self) -> [f64; 2] {
        self.center
    }

    /// Its radius, mm.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// How far it turns, radians; counter-clockwise is positive.
    pub fn sweep(&self) -> f64 {
        self.sweep
    }

    /// Whether it is a whole turn.
    pub fn is_full(&self) -> bool {
        let [u, v, _] = self.plane.axes();
        self.start[u] == self.end[u] && self.start[v] == self.end[v]
    }

    /// Whether it leaves its plane.
    pub fn is_helix(&self) -> bool {
        let [.., w] = self.plane.axes();
        self.start[w] != self.end[w]
    }

    /// How far the stated start, end and centre are from lying on one circle, mm.
    pub fn misfit(&self) -> f64 {
        self.misfit
    }

    /// The length of the path, mm.
    pub fn length(&self) -> f64 {
        let [.., w] = self.plane.axes();
        let (round, along) = (self.radius * self.sweep, self.end[w] - self.start[w]);
        (round * round + along * along).sqrt()
    }

    /// The place at 0 ≤ t ≤ 1.
    pub fn eval(&self, t: f64) -> Position {
        let [u, v, _] = self.plane.axes();
        let mut place: Position = std::array::from_fn(|i| self.start[i] + t * (self.end[i] - self.start[i]));
        let angle = self.angle + t * self.sweep;
        place[u] = self.center[0] + self.radius * elementary::cos(angle);
        place[v] = self.center[1] + self.radius * elementary::sin(angle);
        place
    }

    /// The place and its first two derivatives by t at 0 ≤ t ≤ 1.
    pub fn jet(&self, t: f64) -> [Position; 3] {
        let [u, v, _] = self.plane.axes();
        let mut rate: Position = std::array::from_fn(|i| self.end[i] - self.start[i]);
        let mut second = [0.0; MAX_AXES];
        let angle = self.angle + t * self.sweep;
        let (across, up) = (self.radius * elementary::cos(angle), self.radius * elementary::sin(angle));
        (rate[u], rate[v]) = (-self.sweep * up, self.sweep * across);
        (second[u], second[v]) = (-self.sweep * self.sweep * across, -self.sweep * self.sweep * up);
        [self.eval(t), rate, second]
    }

    /// The direction in u and v at 0 ≤ t ≤ 1, of length 1.
    pub fn tangent(&self, t: f64) -> [f64; 2] {
        let angle = self.angle + t * self.sweep;
        let sign = self.sweep.signum();
        [-sign * elementary::sin(angle), sign * elementary::cos(angle)]
    }

    /// The least and the greatest of each coordinate.
    pub fn range(&self) -> (Position, Position) {
        let mut low: Position = std::array::from_fn(|i| self.start[i].min(self.end[i]));
        let mut high: Position = std::array::from_fn(|i| self.start[i].max(self.end[i]));
        let [u, v, _] = self.plane.axes();
        let (from, to) = (self.angle.min(self.angle + self.sweep), self.angle.max(self.angle + self.sweep));
        let quarter = std::f64::consts::FRAC_PI_2;
        // Every quarter turn between −π − 2π and π + 2π that the arc passes.
        for k in -6i32..=6 {
            let at = f64::from(k) * quarter;
            if from <= at && at <= to {
                match k.rem_euclid(4) {
                    0 => high[u] = high[u].max(self.center[0] + self.radius),
                    1 => high[v] = high[v].max(self.center[1] + self.radius),
                    2 => low[u] = low[u].min(self.center[0] - self.radius),
                    _ => low[v] = low[v].min(self.center[1] - self.radius),
                }
            }
        }
        (low, high)
    }

    /// Its first and its second half.
    pub fn halves(&self) -> [Arc; 2] {
        let (middle, sweep) = (self.eval(0.5), 0.5 * self.sweep);
        [
            Arc { end: middle, sweep, ..*self },
            Arc { start: middle, angle: self.angle + sweep, sweep, ..*self },
        ]
    }

    /// How far a control that is given `start`, `end` and `center` may be from this arc, mm: the bound above, with some
    /// ulps for its own rounding. Infinite where that is no arc, or one the other way round.
    pub fn deviation(
        &self,
        plane: Plane,
        sense: Sense,
        start: Position,
        end: Position,
        center: [f64; 2],
    ) -> f64 {
        if plane != self.plane || sense != self.sense {
            return f64::INFINITY;
        }
        let Ok(other) = Arc::new(plane, sense, start, end, center) else { return f64::INFINITY };
        // The sweep of `other` is about its own centre, not the stated one.
        self.bound(&start, &end, center, other.sweep) + 2.0 * other.misfit
    }

    /// The same where the control is given `start`, `center`, how far to turn, radians, counter-clockwise being positive,
    /// and where the other axes end; and where it ends. Infinite where it turns the other way.
    pub fn deviation_turned(
        &self,
        plane: Plane,
        start: Position,
        end: Position,
        center: [f64; 2],
        sweep: f64,
    ) -> (f64, Position) {
        let end = turned(plane, start, end, center, sweep);
        let alike = plane == self.plane && 0.0 < sweep * self.sweep;
        (if alike { self.bound(&start, &end, center, sweep) } else { f64::INFINITY }, end)
    }

    /// The bound above for a control that turns by `sweep` about `center`.
    fn bound(&self, start: &Position, end: &Position, center: [f64; 2], sweep: f64) -> f64 {
        let [u, v, w] = self.plane.axes();
        let size = |x: f64, y: f64| (x * x + y * y).sqrt();
        let apart = size(self.center[0] - center[0], self.center[1] - center[1]);
        let radius = |p: &Position| (self.radius - size(p[u] - center[0], p[v] - center[1])).abs();
        // Angles about the stated centre, which is what the control has.
        let about = |p: &Position| direction(p[v] - center[1], p[u] - center[0]);
        let nearest = |x: f64| {
            let turns = (x / TURN).round();
            (x - turns * TURN).abs()
        };
        let first = nearest(about(start) - self.angle);
        // The sweeps are compared without whole turns taken away: a full circle is no standstill.
        let last = first + (sweep - self.sweep).abs();
        let along = (start[w] - self.start[w]).abs().max((end[w] - self.end[w]).abs());
        let rest = (0..MAX_AXES).filter(|i| ![u, v, w].contains(i)).fold(0.0f64, |worst, i| {
            worst.max((start[i] - self.start[i]).abs()).max((end[i] - self.end[i]).abs())
        });
        let bound = apart + radius(start).max(radius(end)) + self.radius * last + along + rest;
        let scale = self.radius + self.center[0].abs() + self.center[1].abs();
        bound + 64.0 * f64::EPSILON * scale
    }
}

#[cfg(test)]
mod tests {
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
        let zx =
            Arc::new(Plane::Zx, Sense::CounterClockwise, at(0.0, 0.0, 5.0), at(5.0, 0.0, 0.0), [0.0, 0.0]);
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
            assert!(
                Arc::new(Plane::Xy, Sense::Clockwise, at(5.0, 0.0, 0.0), at(0.0, 5.0, 0.0), bad).is_err()
            );
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
            let bound = asked.deviation(Plane::Xy, Sense::CounterClockwise, start, end, center);
            let written = arc(Sense::CounterClockwise, start, end, center);
            let seen = (0..=100).fold(0.0f64, |worst, i| {
                let (p, q) = (asked.eval(f64::from(i) / 100.0), written.eval(f64::from(i) / 100.0));
                worst.max(p.iter().zip(&q).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt())
            });
            assert!(seen <= bound, "{seen} {bound}");
            assert!(bound < 6.0 * seen + 1e-12, "{seen} {bound}");
        }
        let wrong = |plane, sense| asked.deviation(plane, sense, asked.start(), asked.end(), asked.center());
        assert_eq!(wrong(Plane::Xy, Sense::Clockwise), f64::INFINITY);
        assert_eq!(wrong(Plane::Yz, Sense::CounterClockwise), f64::INFINITY);
        // A standstill is no full circle, and a full circle no standstill.
        let full = arc(Sense::Clockwise, at(5.0, 0.0, 0.0), at(5.0, 0.0, 0.0), [0.0, 0.0]);
        let little =
            full.deviation(Plane::Xy, Sense::Clockwise, at(5.0, 0.0, 0.0), at(5.0, -0.0001, 0.0), [0.0, 0.0]);
        assert!(30.0 < little, "{little}");
    }
}
