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
//! Three places are one circle, which no control can run otherwise. Of two arcs p and q in space, with radii A, A₂ to their
//! starts and B, B₂ a quarter turn further, the difference d = p − q at equal shares t is known wherever it is looked at, and
//! between two shares 1/N apart it leaves the line between by at most
//!
//! ```text
//! max |d″| / (8 N²)          |d″| ≤ σ² (√(|A − A₂|² + |B − B₂|²) + R₂ |σ − σ₂|) + |σ² − σ₂²| R₂
//! ```
//!
//! since p″ = −σ² (cos σt A + sin σt B). Of a flat arc the places say little about the centre, and d is small all the same.

use super::{Arc, Plane, Sense, TURN, direction, turned};
use crate::geom::elementary;
use crate::units::{MAX_AXES, Position};

/// The most that an arc turns between two places that are looked at, radians.
const STRETCH: f64 = 0.125;

/// At how many shares of an arc its distance from another is looked at, at least.
const STRETCHES: f64 = 16.0;

fn norm(a: [f64; 3]) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// How far two places are apart in what goes along with X Y Z. Those coordinates run evenly along both arcs, so that this is
/// greatest at an end; rotary ones are to be mm here, as they count.
fn others(p: &Position, q: &Position) -> f64 {
    (3..MAX_AXES).map(|i| (p[i] - q[i]) * (p[i] - q[i])).sum::<f64>().sqrt()
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
        let rest = others(start, &self.start).max(others(end, &self.end));
        let bound = apart + radius(start).max(radius(end)) + self.radius * last + along + rest;
        let scale = self.radius + self.center[0].abs() + self.center[1].abs();
        bound + 64.0 * f64::EPSILON * (scale + self.radius * self.sweep.abs())
    }

    /// The radius to the start and that a quarter turn further, in X Y Z.
    fn radii(&self) -> [[f64; 3]; 2] {
        let (cos, sin) = (elementary::cos(self.angle), elementary::sin(self.angle));
        let (sign, r) = (self.sweep.signum(), self.radius);
        let out = |u: f64, v: f64| self.frame.global([u, v, 0.0]);
        [out(r * cos, r * sin), out(-sign * r * sin, sign * r * cos)]
    }

    /// How far `other` is from this arc at most, mm, at equal shares of both: the second bound above, with some ulps for the
    /// rounding of three places' circle and its own. Their planes may differ.
    pub fn apart(&self, other: &Arc) -> f64 {
        let ([a, b], [a2, b2]) = (self.radii(), other.radii());
        let less = |p: [f64; 3], q: [f64; 3]| norm(std::array::from_fn(|i| p[i] - q[i]));
        let (sweep, sweep2, r2) = (self.sweep.abs(), other.sweep.abs(), other.radius);
        let radial =
            (less(a, a2) * less(a, a2) + less(b, b2) * less(b, b2)).sqrt() + r2 * (sweep - sweep2).abs();
        let second = sweep * sweep * radial + (sweep * sweep - sweep2 * sweep2).abs() * r2;
        let count = (sweep / STRETCH).ceil().max(STRETCHES);
        let mut worst = 0.0f64;
        for k in 0..=count as u32 {
            let t = f64::from(k) / count;
            let (p, q) = (self.eval(t), other.eval(t));
            worst = worst.max(less([p[0], p[1], p[2]], [q[0], q[1], q[2]]));
        }
        let rest = others(&self.start, &other.start).max(others(&self.end, &other.end));
        let scale = self.radius + r2 + norm(self.middle()) + norm(other.middle());
        let between = second / (8.0 * count * count);
        worst + between + 2.0 * other.misfit + rest + 256.0 * f64::EPSILON * scale
    }
}
