//! How far a control may be from an arc.
//!
//! # By start, end and centre
//!
//! A control that is given start, end and centre c₂ runs radii between |s₂ − c₂| and |e₂ − c₂|. At equal t, by the triangle
//! inequality,
//!
//! ```text
//! |p − p₂| ≤ |c − c₂| + max(|R − |s₂ − c₂||, |R − |e₂ − c₂||) + R max(|α − α₂|, |α + σ − α₂ − σ₂|) + max(|w0 − w0₂|, |w1 − w1₂|)
//! ```
//!
//! # By a place on the way
//!
//! Three places are one circle, which no control can run otherwise. Of two arcs p and q in space, with their centres c and
//! c₂, radii A, A₂ to their starts and B, B₂ a quarter turn further, the difference at equal shares is
//!
//! ```text
//! p − q = (c − c₂) + cos x (A − A₂) + sin x (B − B₂) + t (h − h₂)          x = tσ
//! ```
//!
//! but for R₂ |σ − σ₂|, by which the second one is ahead or behind. Its first three terms are a part of an ellipse; cut into
//! stretches 2δ, each lies in the triangle of its ends and of D + (cos m A + sin m B)/cos δ, m its middle, as a conic of
//! positive weights does. The places that are stated need not say much about the centre for this to be small.

use super::{Arc, Plane, Sense, TURN, direction, turned};
use crate::geom::elementary;
use crate::units::{MAX_AXES, Position};

/// The most that a stretch turns whose triangle is taken, radians.
const STRETCH: f64 = 0.25;

/// The fewest stretches of an arc.
const STRETCHES: f64 = 16.0;

fn norm(a: [f64; 3]) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}

impl Arc {
    /// How far a control that is given `start`, `end`, `center` and `turns` whole turns before the way to the end may be from
    /// this arc, mm: the bound above, with some ulps for its own rounding. Infinite where that is no arc, or one in another
    /// plane or the other way round.
    pub fn deviation(
        &self,
        (plane, sense): (Plane, Sense),
        start: Position,
        end: Position,
        center: [f64; 2],
        turns: u32,
    ) -> f64 {
        if Some(plane) != self.frame.plane() || sense != self.sense {
            return f64::INFINITY;
        }
        let Ok(other) = Arc::new(plane, sense, start, end, center) else { return f64::INFINITY };
        let other = other.with_turns(turns);
        // The sweep of `other` is about its own centre, not the stated one.
        self.bound(plane, (&start, &end), center, other.sweep) + 2.0 * other.misfit
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
        let alike = Some(plane) == self.frame.plane() && 0.0 < sweep * self.sweep;
        (if alike { self.bound(plane, (&start, &end), center, sweep) } else { f64::INFINITY }, end)
    }

    /// The bound above for a control that turns by `sweep` about `center`.
    fn bound(&self, plane: Plane, (start, end): (&Position, &Position), center: [f64; 2], sweep: f64) -> f64 {
        let [u, v, w] = plane.axes();
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
        bound + 64.0 * f64::EPSILON * (scale + self.radius * self.sweep.abs())
    }

    /// Centre, the radius to the start, that a quarter turn further, and the rise, in X Y Z.
    fn parts(&self) -> [[f64; 3]; 4] {
        let (cos, sin) = (elementary::cos(self.angle), elementary::sin(self.angle));
        let sign = self.sweep.signum();
        let at = |u: f64, v: f64, w: f64| self.frame.global([u, v, w]);
        let r = self.radius;
        [
            self.middle(),
            at(r * cos, r * sin, 0.0),
            at(-sign * r * sin, sign * r * cos, 0.0),
            at(0.0, 0.0, self.rise()),
        ]
    }

    /// How far `other` is from this arc at most, mm, at equal shares of both: the second bound above, with some ulps for the
    /// rounding of three places' circle and its own. Their planes may differ.
    pub fn apart(&self, other: &Arc) -> f64 {
        let (own, others) = (self.parts(), other.parts());
        let [d, a, b, h]: [[f64; 3]; 4] =
            std::array::from_fn(|k| std::array::from_fn(|i| own[k][i] - others[k][i]));
        let sweep = self.sweep.abs();
        let count = (sweep / STRETCH).ceil().max(STRETCHES);
        let delta = 0.5 * sweep / count;
        let place = |x: f64, share: f64, by: f64| -> [f64; 3] {
            let (cos, sin) = (elementary::cos(x) / by, elementary::sin(x) / by);
            std::array::from_fn(|i: usize| -> f64 { d[i] + cos * a[i] + sin * b[i] + share * h[i] })
        };
        let mut worst = 0.0f64;
        for k in 0..count as usize {
            let (from, to) = (k as f64 / count, (k + 1) as f64 / count);
            let middle = 0.5 * (from + to) * sweep;
            // The rise goes on within a stretch too, so that each corner has both of its ends.
            for share in [from, to] {
                worst = worst.max(norm(place(from * sweep, share, 1.0)));
                worst = worst.max(norm(place(middle, share, elementary::cos(delta))));
                worst = worst.max(norm(place(to * sweep, share, 1.0)));
            }
        }
        let rest = (3..MAX_AXES).fold(0.0f64, |worst, i| {
            worst.max((self.start[i] - other.start[i]).abs()).max((self.end[i] - other.end[i]).abs())
        });
        let ahead = other.radius * (sweep - other.sweep.abs()).abs();
        let scale = self.radius + other.radius + norm(own[0]) + norm(others[0]);
        worst + ahead + 2.0 * other.misfit + rest + 256.0 * f64::EPSILON * scale
    }
}
