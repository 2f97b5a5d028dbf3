//! Straight moves that were asked as such.
//!
//! # The bound
//!
//! A line that was asked from p₀ to p₁ and the block that stands for it from q₀ to q₁ are run along evenly, each coordinate
//! of both being affine in the share s. So their difference is affine too, and its length is convex:
//!
//! ```text
//! |p(s) − q(s)| = |(1 − s)(p₀ − q₀) + s (p₁ − q₁)| ≤ max(|p₀ − q₀|, |p₁ − q₁|)
//! ```
//!
//! The greatest distance is at an end. It is that of all coordinates together, rotary ones at their radius, and the start of the
//! run is one of the ends: a bound of the coordinates one by one would be too small by up to √n.
//!
//! # The tool's direction
//!
//! It turns evenly on a great circle, by θ, and there distances are not convex: between the meridians of two places on the
//! equator, as far apart as those, it is less wherever else. Let one great circle go over into the other, its ends along the
//! shortest ways, which are at most e long. What moves across to it at share s is a Jacobi field of the unit sphere, at most
//!
//! ```text
//! e (sin((1 − s)θ) + sin(sθ)) / sin θ = e cos((½ − s)θ) / cos ½θ ≤ e / cos ½θ
//! ```
//!
//! and all the circles on the way turn by θ + 2e at most, so that the directions are apart by e / cos(½θ + e) at most.

use super::{Cursor, Found};
use crate::decimal::units_to_f64;
use crate::diagnostic::Diagnostics;
use crate::geom::deviation::Bound;
use crate::geom::direction;
use crate::geom::elementary::cos;
use crate::ir::{Decimals, Polyline, Written, WrittenPoints, padded};
use crate::units::{DEGREES, Kind, MAX_AXES, Position};

/// The angle between two directions that turn evenly, each by at most `turn`, and are at most `ends` apart at both ends, radians.
fn apart_between(ends: f64, turn: f64) -> f64 {
    let half = 0.5 * turn + ends;
    if half < std::f64::consts::FRAC_PI_2 { ends / cos(half) } else { f64::INFINITY }
}

impl Cursor<'_> {
    /// How many mm a unit of each coordinate counts: 1 of a linear axis, the arc at the radius of a rotary one, nothing of a
    /// direction, whose components are no place.
    fn scales(&self) -> [f64; MAX_AXES] {
        let axes = &self.decimals.program.axes;
        std::array::from_fn(|i| match axes.as_slice().get(i).map(|(_, kind)| kind) {
            Some(Kind::Linear) => 1.0,
            Some(Kind::Rotary) => self.radius / DEGREES,
            Some(Kind::Direction) | None => 0.0,
        })
    }

    /// A place with its rotary axes in mm, as they count.
    pub(super) fn in_mm(&self, place: &Position) -> Position {
        let axes = &self.decimals.program.axes;
        let mut scaled = *place;
        for (x, (_, kind)) in scaled.iter_mut().zip(axes.as_slice()) {
            match kind {
                Kind::Rotary => *x *= self.radius / DEGREES,
                Kind::Linear | Kind::Direction => {}
            }
        }
        scaled
    }

    /// The distance of two places, mm: all coordinates together.
    pub(super) fn apart(&self, p: &Position, q: &Position) -> f64 {
        let scales = self.scales();
        (0..MAX_AXES).map(|i| scales[i] * (p[i] - q[i])).map(|d| d * d).sum::<f64>().sqrt()
    }

    /// The greatest difference in a rotary axis, radians.
    pub(super) fn rotary_apart(&self, p: &Position, q: &Position) -> f64 {
        let axes = &self.decimals.program.axes;
        let rotary = (0..axes.count()).filter(|i| axes.kind(*i) == Kind::Rotary);
        rotary.map(|i| (p[i] - q[i]).abs() / DEGREES).fold(0.0, f64::max)
    }

    /// The first line of a run starts where that was asked, to a unit of the last decimal: the text does not say it, and the
    /// way from another place is another line. How far off it starts.
    pub(super) fn starts_at(&self, asked: &Position, points: &WrittenPoints) -> Result<Bound, Diagnostics> {
        let axes = self.decimals.program.axes;
        let before = self.before(points);
        for axis in 0..axes.direction().unwrap_or(axes.count()) {
            let known = self.units(axis, asked[axis]).is_some_and(|units| (units - before[axis]).abs() <= 1);
            if !known {
                let (name, at) = (axes.name(axis), self.decimals.position(&before)[axis]);
                let message = format!(
                    "this straight move was asked to start at {name} {}, and {name} is at {at}",
                    asked[axis]
                );
                return Err(self.differs("start-differs", message));
            }
        }
        let before = self.decimals.position(&before);
        Ok(Bound { mm: self.apart(&before, asked), rad: self.rotary_apart(&before, asked) })
    }

    /// Straight moves that were asked as such: every point is met exactly, as rounded.
    pub(super) fn lines(&mut self, asked: &Polyline, written: &Written) -> Result<Found, Diagnostics> {
        let Written::Lines(points) = written else {
            return Err(self.differs("step-differs", "here a straight move was asked".to_owned()));
        };
        let Decimals { digits, program, .. } = self.decimals;
        let (axes, scales) = (program.axes, self.scales());
        let Bound { mm: start, mut rad } = self.starts_at(&asked.start, points)?;
        let mut worst = start * start;
        let linear: Vec<usize> = (0..axes.count()).filter(|i| axes.kind(*i) == Kind::Linear).collect();
        // The directions at the end of the line before, as read and as asked, and how far they are apart.
        let mut turned = axes.direction().map(|first| {
            let read = self.decimals.position(&self.before(points));
            (first, read, asked.start, direction::between(&read, &asked.start, first))
        });
        // No more points were met than there are.
        let mut found = points.units[self.within * points.stride..].chunks_exact(points.stride);
        let (mut from, mut length) = (&asked.start[..asked.stride], 0.0);
        // A line from nowhere leads somewhere, wherever that is.
        let nowhere = self.within == 0 && self.unreached.contains_key(&self.at);
        let before = self.before(points);
        let (mut rests, mut last) = (0, (!nowhere).then_some(&before[..points.stride]));
        for point in asked.values.chunks_exact(asked.stride) {
            let Some(units) = found.next() else {
                return Err(self.differs("less-than-asked", "a straight move is missing here".to_owned()));
            };
            rests += usize::from(last == Some(units));
            last = Some(units);
            let mut squares = 0.0;
            for (axis, x) in point.iter().enumerate() {
                let read = units.get(axis).copied().unwrap_or_default();
                if self.units(axis, *x) != Some(read) {
                    let name = axes.name(axis);
                    return Err(self.differs("point-differs", format!("{name} was asked to be {x}")));
                }
                let off = scales[axis] * (units_to_f64(read, digits[axis]) - x);
                squares += off * off;
                if axes.kind(axis) == Kind::Rotary {
                    rad = rad.max((units_to_f64(read, digits[axis]) - x).abs() / DEGREES);
                }
            }
            worst = worst.max(squares);
            if let Some((first, read_before, asked_before, ends_before)) = &mut turned {
                let (read, point) = (self.decimals.position(&padded(units)), padded(point));
                let apart = |p: &Position, q: &Position| direction::between(p, q, *first);
                let here = apart(&read, &point);
                let ends = ends_before.max(here);
                let turn = apart(read_before, &read).max(apart(asked_before, &point));
                rad = rad.max(apart_between(ends, turn));
                (*read_before, *asked_before, *ends_before) = (read, point, here);
            }
            length +=
                linear.iter().map(|i| (point[*i] - from[*i]) * (point[*i] - from[*i])).sum::<f64>().sqrt();
            from = point;
            self.within += 1;
        }
        let count = asked.count();
        self.leave(points);
        Ok(Found {
            deviation: Bound { mm: worst.sqrt(), rad },
            path_blocks: count,
            cutting_length: length,
            rests,
            ..Found::new()
        })
    }
}
