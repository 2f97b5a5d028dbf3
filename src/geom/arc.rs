//! Arcs and helices about any axis.
//!
//! In a plane with the right-handed axes u, v, w an arc of centre c and radius R runs from the angle α through the sweep σ,
//! and w goes along evenly:
//!
//! ```text
//! u = c_u + R cos(α + tσ)     v = c_v + R sin(α + tσ)     w = w0 + t (w1 − w0)     0 ≤ t ≤ 1
//! ```
//!
//! More than a whole turn is a helix of several. In X Y, Z X and Y Z the axes are coordinates, picked and never multiplied;
//! any other plane has a [`Frame`].
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

mod bound;
mod frame;

pub use frame::{Frame, Plane, Sense};

use super::elementary;
use super::rotation::Rotation;
use crate::units::{MAX_AXES, Position};
use frame::direction;

/// 2π.
const TURN: f64 = 2.0 * std::f64::consts::PI;

/// An arc or a helix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    frame: Frame,
    sense: Sense,
    start: Position,
    end: Position,
    /// u and v.
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
    /// The arc from `start` to `end` about `center` (u, v of the frame). A start that is the end in u and v is a full turn.
    ///
    /// # Errors
    /// See [`ArcError`].
    pub fn new(
        frame: impl Into<Frame>,
        sense: Sense,
        start: Position,
        end: Position,
        center: [f64; 2],
    ) -> Result<Arc, ArcError> {
        let frame = frame.into();
        if !start.iter().chain(&end).chain(&center).all(|x| x.is_finite()) {
            return Err(ArcError::NotFinite);
        }
        let place = |p: &Position| {
            let [u, v, _] = frame.local([p[0], p[1], p[2]]);
            [u, v]
        };
        let (s, e) = (place(&start), place(&end));
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
        Ok(Arc { frame, sense, start, end, center: place, radius, angle, sweep, misfit })
    }

    /// The same arc after so many whole turns of the same pitch.
    #[must_use]
    pub fn with_turns(mut self, turns: u32) -> Arc {
        self.sweep += self.sweep.signum() * f64::from(turns) * TURN;
        self
    }

    /// The same arc with other coordinates beside X Y Z, which `map` must leave alone.
    #[must_use]
    pub fn mapped_along(mut self, map: impl Fn(&Position) -> Position) -> Arc {
        (self.start, self.end) = (map(&self.start), map(&self.end));
        self
    }

    /// The same arc turned: the rotation of each of its places in X Y Z. Where its axis is within `slack`
    /// radians of one of that frame it is an arc of that plane, and its places are off by up to `slack` times its radius.
    #[must_use]
    pub fn turned(&self, rotation: &Rotation, slack: f64) -> Arc {
        let out = |p: [f64; 3]| rotation.out(p);
        let place = |p: &Position| {
            let [x, y, z] = out([p[0], p[1], p[2]]);
            let mut place = *p;
            (place[0], place[1], place[2]) = (x, y, z);
            place
        };
        let [.., axis] = self.frame.axes();
        let Some((frame, along)) = Frame::about(out(axis), slack) else { return *self };
        let [u, v, _] = frame.local(out(self.middle()));
        let (start, mut end) = (place(&self.start), place(&self.end));
        if let Some(plane) = frame.plane()
            && self.is_full()
        {
            // Ends over each other stay so.
            plane.axes()[..2].iter().for_each(|i| end[*i] = start[*i]);
        }
        let sense = if along { self.sense } else { self.sense.reversed() };
        let [su, sv, _] = frame.local([start[0], start[1], start[2]]);
        let (angle, sweep) = (direction(sv - v, su - u), if along { self.sweep } else { -self.sweep });
        Arc { frame, sense, start, end, center: [u, v], angle, sweep, ..*self }
    }

    /// u, v and w of a place.
    fn local(&self, p: &Position) -> [f64; 3] {
        self.frame.local([p[0], p[1], p[2]])
    }

    /// The axes of its plane.
    pub fn frame(&self) -> Frame {
        self.frame
    }

    /// The plane of the machine that it lies in or goes along, where there is one.
    pub fn plane(&self) -> Option<Plane> {
        self.frame.plane()
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

    /// Its centre in X Y Z, at the height of its start.
    pub fn middle(&self) -> [f64; 3] {
        let [.., w] = self.local(&self.start);
        self.frame.global([self.center[0], self.center[1], w])
    }

    /// Its radius, mm.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// How far it turns, radians; counter-clockwise is positive.
    pub fn sweep(&self) -> f64 {
        self.sweep
    }

    /// How many turns that is.
    pub fn turns(&self) -> f64 {
        self.sweep.abs() / TURN
    }

    /// Whether it ends over its start: a whole turn, or several.
    pub fn is_full(&self) -> bool {
        match self.frame.plane() {
            Some(plane) => {
                let [u, v, _] = plane.axes();
                self.start[u] == self.end[u] && self.start[v] == self.end[v]
            }
            None => {
                let turns = self.turns();
                0.5 < turns && (turns - turns.round()).abs() < 1.0e-12 * turns
            }
        }
    }

    /// How far it goes along w, mm.
    pub fn rise(&self) -> f64 {
        let ([.., from], [.., to]) = (self.local(&self.start), self.local(&self.end));
        to - from
    }

    /// How far the stated start, end and centre are from lying on one circle, mm.
    pub fn misfit(&self) -> f64 {
        self.misfit
    }

    /// The length of the path, mm.
    pub fn length(&self) -> f64 {
        let (round, along) = (self.radius * self.sweep, self.rise());
        (round * round + along * along).sqrt()
    }

    /// The place at 0 ≤ t ≤ 1.
    pub fn eval(&self, t: f64) -> Position {
        let angle = self.angle + t * self.sweep;
        let u = self.center[0] + self.radius * elementary::cos(angle);
        let v = self.center[1] + self.radius * elementary::sin(angle);
        self.with_local(std::array::from_fn(|i| self.start[i] + t * (self.end[i] - self.start[i])), u, v)
    }

    /// A place with other u and v.
    fn with_local(&self, mut place: Position, u: f64, v: f64) -> Position {
        if let Some(plane) = self.frame.plane() {
            let [i, j, _] = plane.axes();
            (place[i], place[j]) = (u, v);
        } else {
            let [.., w] = self.local(&place);
            place[..3].copy_from_slice(&self.frame.global([u, v, w]));
        }
        place
    }

    /// The place and its first two derivatives by t at 0 ≤ t ≤ 1.
    pub fn jet(&self, t: f64) -> [Position; 3] {
        let rate: Position = std::array::from_fn(|i| self.end[i] - self.start[i]);
        let angle = self.angle + t * self.sweep;
        let (across, up) = (self.radius * elementary::cos(angle), self.radius * elementary::sin(angle));
        let square = -self.sweep * self.sweep;
        [
            self.eval(t),
            self.with_local(rate, -self.sweep * up, self.sweep * across),
            self.with_local([0.0; MAX_AXES], square * across, square * up),
        ]
    }

    /// The direction in u and v at 0 ≤ t ≤ 1, of length 1.
    pub fn tangent(&self, t: f64) -> [f64; 2] {
        let angle = self.angle + t * self.sweep;
        let sign = self.sweep.signum();
        [-sign * elementary::sin(angle), sign * elementary::cos(angle)]
    }

    /// The least and the greatest of each coordinate; of a helix in a tilted plane a little more.
    pub fn range(&self) -> (Position, Position) {
        let mut low: Position = std::array::from_fn(|i| self.start[i].min(self.end[i]));
        let mut high: Position = std::array::from_fn(|i| self.start[i].max(self.end[i]));
        let (from, to) = (self.angle.min(self.angle + self.sweep), self.angle.max(self.angle + self.sweep));
        let [u, v, w] = self.frame.axes();
        let center = self.middle();
        let rise = self.rise();
        for i in 0..3 {
            let reach = self.radius * (u[i] * u[i] + v[i] * v[i]).sqrt();
            if reach == 0.0 {
                continue;
            }
            // R (u cos θ + v sin θ) is greatest at the angle of (u, v), and least half a turn further.
            let most = direction(v[i], u[i]);
            let passes = |angle: f64| {
                from <= angle + TURN * ((from - angle) / TURN).ceil()
                    && angle + TURN * ((from - angle) / TURN).ceil() <= to
            };
            let along = rise * w[i];
            // Where a rise goes along with it, each of both takes its greatest and its least.
            let ends = [self.start[i], self.end[i] - along];
            let (mut least, mut greatest) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
            if passes(most) {
                greatest = greatest.max(center[i] + reach);
            }
            if passes(most + 0.5 * TURN) {
                least = least.min(center[i] - reach);
            }
            low[i] = low[i].min(least + along.min(0.0));
            high[i] = high[i].max(greatest + along.max(0.0));
        }
        (low, high)
    }

    /// The part from one share of it to another, 0 ≤ `from` < `to` ≤ 1.
    #[must_use]
    pub fn part(&self, from: f64, to: f64) -> Arc {
        let start = if from == 0.0 { self.start } else { self.eval(from) };
        let end = if to == 1.0 { self.end } else { self.eval(to) };
        let (angle, sweep) = (self.angle + from * self.sweep, (to - from) * self.sweep);
        Arc { start, end, angle, sweep, ..*self }
    }

    /// The place over or under the start at a share of the rise.
    fn over(&self, share: f64) -> Position {
        if share == 0.0 {
            return self.start;
        }
        let [u, v, _] = self.local(&self.start);
        self.with_local(std::array::from_fn(|i| self.start[i] + share * (self.end[i] - self.start[i])), u, v)
    }

    /// Parts of `most` whole turns each, which end over their start exactly, and one of the rest.
    pub fn by_turns(&self, most: u32) -> Vec<Arc> {
        let (turns, most) = (self.turns(), f64::from(most));
        // What is above a number of whole turns by rounding only is none.
        let count = (turns / most - 1.0e-9).ceil().max(1.0);
        let whole = self.sweep.signum() * most * TURN;
        let mut parts = Vec::with_capacity(count as usize);
        for i in 0..count as u32 {
            let i = f64::from(i);
            let last = i + 1.0 == count;
            parts.push(Arc {
                start: self.over(i * most / turns),
                end: if last { self.end } else { self.over((i + 1.0) * most / turns) },
                sweep: if last { self.sweep - i * whole } else { whole },
                ..*self
            });
        }
        parts
    }
}

#[cfg(test)]
mod tests;
