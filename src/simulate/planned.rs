//! Cycles that keep limits: the target of a cycle is as far along the path as the feed profile says.
//!
//! Where limits are to hold exactly the way is that of the path, not of chords: with s(t) the profile, cycle k ends at
//! s(kT), so an axis' change of speed from cycle to cycle is a mean of its acceleration and no greater. The place is the
//! root of the length of c from the start of its cell, found by the same methods as a chord. What a chord is shorter than
//! the way, (F·T)²/(24R²), then stands as feed error.

use super::limits::Limits;
use super::partition::{Cycle, Law, Method, Parametric, Piece, chord_error, root};
use super::profile::{Cell, Profile, length};
use super::shape::Shape;
use crate::units::{MAX_AXES, Position};

/// The finest relative error of a length that is asked of a root: limits are to hold to the last but a few bits.
const FINE: f64 = 1e-11;

/// The cycles of a run within limits.
#[derive(Clone, Debug)]
pub struct Planned<'p> {
    pieces: &'p [Piece<Shape>],
    profile: Profile,
    law: Law,
    /// Cycles made.
    count: u64,
    /// The current cell, when it is entered, s, and how long its start is along the run.
    cell: usize,
    entered: f64,
    behind: f64,
    /// Where the tool is: parameter, position, along the run.
    u: f64,
    at: Position,
    way: f64,
    done: bool,
}

impl<'p> Planned<'p> {
    /// From the first point of the first piece to the last of the last.
    pub fn new(pieces: &'p [Piece<Shape>], limits: &Limits, law: Law) -> Planned<'p> {
        let profile = Profile::new(pieces, limits, law.cycle);
        let (u, at) = pieces.first().map_or((0.0, [0.0; MAX_AXES]), |p| (p.from, p.curve.at(p.from)));
        let done = profile.cells.is_empty();
        Planned { pieces, profile, law, count: 0, cell: 0, entered: 0.0, behind: 0.0, u, at, way: 0.0, done }
    }

    /// Its profile.
    pub fn profile(&self) -> &Profile {
        &self.profile
    }

    /// The parameter that is `way` behind the start of a cell.
    fn parameter(&self, cell: &Cell, way: f64, within: bool) -> f64 {
        if cell.length <= way {
            return cell.to;
        }
        let piece = &self.pieces[cell.piece];
        if let Shape::Line(..) = piece.curve {
            return cell.from + way / cell.length * (cell.to - cell.from);
        }
        // From where the tool is, if that is in this cell.
        let from = if within { self.u } else { cell.from };
        let begun = if within { length(&piece.curve, &piece.counts, cell.from, from) } else { 0.0 };
        if way <= begun {
            return from;
        }
        let guess = from + (way - begun) / piece.counts.norm(&piece.curve.jet(from)[1]);
        if self.law.method == Method::Taylor {
            return guess.min(cell.to);
        }
        let missing = |u: f64| length(&piece.curve, &piece.counts, cell.from, u) - way;
        let enough = self.law.tolerance.min(FINE) * (way - begun);
        root(missing, (from, begun - way), cell.to, guess, enough, self.law.method).unwrap_or(cell.to)
    }
}

impl Iterator for Planned<'_> {
    type Item = Cycle;

    fn next(&mut self) -> Option<Cycle> {
        if self.done {
            return None;
        }
        let now = self.count as f64 * self.law.cycle;
        let mut next = (self.count + 1) as f64 * self.law.cycle;
        let first = self.cell;
        let last = self.profile.cells.len() - 1;
        while self.cell < last {
            let cell = &self.profile.cells[self.cell];
            let time = cell.time();
            if next < self.entered + time {
                break;
            }
            self.entered += time;
            self.behind += cell.length;
            self.cell += 1;
        }
        let cell = self.profile.cells[self.cell];
        // A rest that is no more than rounding is no cycle.
        let end = self.entered + cell.time();
        let (u, way) = if self.cell == last && end <= next + 1e-9 * self.law.cycle {
            self.done = true;
            next = end;
            (cell.to, self.behind + cell.length)
        } else {
            let way = cell.way(next - self.entered);
            (self.parameter(&cell, way, first == self.cell), self.behind + way)
        };
        let from = self.profile.cells[first].piece;
        let piece = &self.pieces[cell.piece];
        let at = piece.curve.at(u);
        let asked = way - self.way;
        let chord = piece.counts.distance(&self.at, &at);
        let chord_error = chord_error(self.pieces, (from, self.u, &self.at), (cell.piece, u, &at));
        (self.count, self.u, self.at, self.way) = (self.count + 1, u, at, way);
        let feed_error = if asked == 0.0 { 0.0 } else { (chord - asked) / asked };
        let time = next - now;
        Some(Cycle { piece: cell.piece, u, at, time, asked, chord, feed_error, chord_error })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::bezier::Bezier;
    use crate::simulate::partition::Weights;
    use proptest::prelude::*;

    const XYZ: Weights = Weights([1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);

    fn piece(curve: Shape, feed: f64) -> Piece<Shape> {
        Piece { curve, from: 0.0, to: 1.0, feed, counts: XYZ, surface: XYZ }
    }

    /// The greatest excess of an axis' change of speed over what is allowed, per axis' acceleration: below zero where all
    /// is well. Standing before and after counts.
    fn excess(pieces: &[Piece<Shape>], limits: &Limits, cycle: f64) -> (f64, f64) {
        let law = Law { method: Method::Secant, cycle, tolerance: 1e-8 };
        let planned = Planned::new(pieces, limits, law);
        let start = planned.at;
        let mut points = vec![(0usize, start); 2];
        points.extend(planned.map(|c| (c.piece, c.at)));
        let (_, end) = points[points.len() - 1];
        points.extend([(pieces.len() - 1, end); 2]);
        let (mut faster, mut harder) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
        for w in points.windows(3) {
            // Whether a joint falls into the two cycles.
            let joint = w[0].0 != w[2].0;
            for axis in 0..4 {
                let (before, after) =
                    ((w[1].1[axis] - w[0].1[axis]) / cycle, (w[2].1[axis] - w[1].1[axis]) / cycle);
                let allowed = limits.acceleration[axis] * cycle + if joint { limits.step[axis] } else { 0.0 };
                faster = faster.max(after.abs() / limits.speed[axis] - 1.0);
                harder = harder.max((after - before).abs() / allowed - 1.0);
            }
        }
        (faster, harder)
    }

    fn limits(acceleration: f64, step: f64, speed: f64) -> Limits {
        let mut limits = Limits::NONE;
        for axis in 0..4 {
            limits.acceleration[axis] = acceleration;
            limits.step[axis] = step;
            limits.speed[axis] = speed;
        }
        limits
    }

    #[test]
    fn a_trapezoid_takes_its_time() {
        // 50 mm at 100 mm/s and 1000 mm/s² less a thousandth: 0.5 + 100/999 s.
        let pieces = [piece(Shape::line([0.0; 6], [50.0, 0.0, 0.0, 0.0, 0.0, 0.0]), 100.0)];
        let law = Law { method: Method::Secant, cycle: 1e-3, tolerance: 1e-8 };
        let time: f64 = Planned::new(&pieces, &limits(1000.0, 1.0, 1e3), law).map(|c| c.time).sum();
        assert!((time - (0.5 + 100.0 / 999.0)).abs() < 1e-12, "{time}");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(96))]
        #[test]
        fn limits_are_never_exceeded(
            points in prop::collection::vec(prop::array::uniform4(-30.0f64..30.0), 4..12),
            acceleration in 50.0f64..5000.0,
            step in 0.5f64..50.0,
            feed in 1.0f64..300.0,
            speed in 1.0f64..200.0,
            scale in 0.01f64..1.0,
        ) {
            let at = |p: &[f64; 4]| [scale * p[0], scale * p[1], scale * p[2], scale * p[3], 0.0, 0.0];
            let mut pieces = Vec::new();
            for (i, w) in points.windows(4).enumerate() {
                // Lines and cubics in turn, joined with corners.
                if i % 2 == 0 {
                    pieces.push(piece(Shape::bezier(&Bezier::new(&[at(&w[0]), at(&w[2]), at(&w[3]), at(&w[1])])), feed));
                } else {
                    pieces.push(piece(Shape::line(at(&w[0]), at(&w[1])), feed));
                }
            }
            let (faster, harder) = excess(&pieces, &limits(acceleration, step, speed), 1e-3);
            prop_assert!(faster <= 0.0 && harder <= 0.0, "{faster:e} {harder:e}");
        }
    }
}
