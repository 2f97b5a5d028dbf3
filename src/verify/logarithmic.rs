//! Paths of a cutter's flute, in every form that they are written in.

use super::{Cursor, Found, Ideal, Status};
use crate::diagnostic::Diagnostics;
use crate::geom::bezier::Bezier;
use crate::geom::deviation::{Bound, Metric, OrderError, log_chord, log_piece, segment_piece};
use crate::geom::logcurve::LogCurve;
use crate::geom::oddeven::OddEven;
use crate::ir::{Logarithmic, Method, Written, WrittenPoints};
use crate::pass::settle::through_points;
use crate::units::{DEGREES, Position};

impl Cursor<'_> {
    /// Meets the path of a flute.
    pub(super) fn logarithmic(
        &mut self,
        log: &Logarithmic,
        written: &Written,
        tolerance: f64,
        ideal: &mut Ideal,
    ) -> Result<Found, Diagnostics> {
        let curve = &log.curve;
        let mut found = Found {
            deviation: Bound::ZERO,
            status: Status::Proved,
            from_ideal: None,
            path_blocks: 0,
            cutting_length: curve.end() * curve.length_per_x(),
        };
        if log.method == Method::OddEven {
            let dl = log.dl.unwrap_or(crate::pass::settle::MAX_STEP);
            let steps = OddEven::new(*curve, dl, log.overrun)
                .map_err(|error| self.differs("not-comparable", error.to_string()))?;
            let key = curve.base();
            let known =
                ideal.0.filter(|(curve, step, _)| *curve == key && *step == dl).map(|(_, _, bound)| bound);
            let from_ideal =
                known.unwrap_or_else(|| crate::geom::oddeven::polyline_deviation(curve, steps.clone()));
            ideal.0 = Some((key, dl, from_ideal));
            found.from_ideal = Some(from_ideal);
            match written {
                Written::Lines(points) => self.odd_even_lines(curve, steps, points, &mut found)?,
                Written::Polynomial(_) | Written::Nurbs(_) => {
                    let pieces = self.pieces(written)?;
                    self.odd_even_pieces(curve, steps, &pieces, &mut found)?;
                    found.path_blocks = blocks(written, pieces.len());
                    self.advance();
                }
                Written::Through(_, points) => self.through(log, points, tolerance, &mut found)?,
            }
            if log.overrun {
                // The path runs on to the last step.
                let last = OddEven::new(*curve, dl, true).ok().and_then(Iterator::last);
                found.cutting_length = last.map_or(0.0, |(x, _)| x) * curve.length_per_x();
            }
            return Ok(found);
        }
        match written {
            Written::Lines(points) => self.chords(curve, points, &mut found, tolerance)?,
            Written::Polynomial(_) | Written::Nurbs(_) => {
                let pieces = self.pieces(written)?;
                let (Some(first), Some(last)) = (pieces.first(), pieces.last()) else {
                    return Err(self.differs("less-than-asked", "a path without blocks".to_owned()));
                };
                found.path_blocks = blocks(written, pieces.len());
                for (i, piece) in pieces.iter().enumerate() {
                    let bound = log_piece(curve, piece).map_err(|error| {
                        self.differs("order-differs", format!("in piece {}: {error}", i + 1))
                    })?;
                    found.deviation = found.deviation.max(bound);
                }
                ends(curve, first.start()[0], last.end()[0], &mut found);
                self.advance();
            }
            Written::Through(_, points) => self.through(log, points, tolerance, &mut found)?,
        }
        Ok(found)
    }

    /// Odd-even steps written as lines: the same polyline, its points rounded. Two segments run at the same pace are
    /// farthest apart at an end, so the points decide.
    fn odd_even_lines(
        &mut self,
        curve: &LogCurve,
        steps: OddEven,
        points: &WrittenPoints,
        found: &mut Found,
    ) -> Result<(), Diagnostics> {
        let start = self.decimals.position(&self.before(points));
        found.deviation = found.deviation.max(surface_distance(curve, &start, 0.0, 0.0));
        for (x, a) in steps {
            let half_unit = 0.5 * self.resolution(curve.radius(x));
            let Some(units) = self.next_point(points) else {
                return Err(
                    self.differs("less-than-asked", "points are missing at the end of a path".to_owned())
                );
            };
            let bound = surface_distance(curve, &self.decimals.position(&units), x, a);
            // These points are asked for as they are: half a unit is rounding, more is another point. The constant
            // leaves room for the last bits of a sum of a million steps.
            if 1.01 * half_unit < bound.mm {
                self.within -= 1;
                let message = format!("this point is {:.2e} mm from the step that was asked", bound.mm);
                return Err(self.differs("point-differs", message));
            }
            found.deviation = found.deviation.max(bound);
            found.path_blocks += 1;
        }
        self.leave(points);
        Ok(())
    }

    /// Odd-even steps written as pieces: each piece runs along one segment, in order.
    fn odd_even_pieces(
        &self,
        curve: &LogCurve,
        steps: OddEven,
        pieces: &[Bezier],
        found: &mut Found,
    ) -> Result<(), Diagnostics> {
        let metric_kinds: Vec<_> =
            self.decimals.program.axes.as_slice().iter().map(|(_, kind)| *kind).collect();
        let metric = Metric::new(&metric_kinds, curve.max_radius());
        // Two roundings of a position, at the radius.
        let slack = 1.0e-9 + self.resolution(curve.max_radius());
        let mut from = curve.position(0.0);
        let mut rest = pieces.iter().peekable();
        if let Some(first) = pieces.first() {
            found.deviation = found.deviation.max(metric.distance(&first.start(), &from));
        }
        for (x, a) in steps {
            let to = curve.position_with(x, a);
            // Pieces belong to this segment until one ends at its end.
            loop {
                let Some(piece) = rest.next() else {
                    return Err(
                        self.differs("less-than-asked", "pieces are missing at the end of a path".to_owned())
                    );
                };
                let bound = segment_piece(&metric, (&from, &to), piece, slack)
                    .map_err(|error| self.differs("order-differs", error.to_string()))?;
                found.deviation = found.deviation.max(bound);
                let end = metric.distance(&piece.end(), &to);
                if end.mm <= slack {
                    found.deviation = found.deviation.max(end);
                    break;
                }
            }
            from = to;
        }
        if rest.next().is_some() {
            return Err(self.differs("more-than-asked", "the path goes on after its end".to_owned()));
        }
        Ok(())
    }

    /// One unit of the last decimal in every axis, mm at `radius`.
    fn resolution(&self, radius: f64) -> f64 {
        let unit = |axis: usize| 1.0 / crate::decimal::power_of_ten(self.decimals.digits[axis]) as f64;
        let arc = unit(3) / DEGREES * radius;
        (unit(0) * unit(0) + unit(1) * unit(1) + unit(2) * unit(2) + arc * arc).sqrt()
    }

    /// The curve written as lines: chords at equal X, to the end.
    fn chords(
        &mut self,
        curve: &LogCurve,
        points: &WrittenPoints,
        found: &mut Found,
        tolerance: f64,
    ) -> Result<(), Diagnostics> {
        let mut from = self.decimals.position(&self.before(points));
        let first = from[0];
        let off_cone = |p: &Position| {
            let asked = curve.position_with(p[0], 0.0);
            let (dy, dz) = (p[1] - asked[1], p[2] - asked[2]);
            (dy * dy + dz * dz).sqrt()
        };
        let radians = |p: &Position| (p[3] - curve.index) / DEGREES;
        // Half a unit of X is the most that rounding takes from the end.
        let end = curve.end() - 0.5 / crate::decimal::power_of_ten(self.decimals.digits[0]) as f64;
        while from[0] < end - 1.0e-12 {
            let Some(units) = self.next_point(points) else {
                return Err(self.differs("less-than-asked", "the path ends before its end".to_owned()));
            };
            let to = self.decimals.position(&units);
            if to[0] < from[0] {
                self.within -= 1;
                return Err(self.differs("order-differs", OrderError::RunsBack.to_string()));
            }
            let chord = log_chord(curve, (from[0], radians(&from)), (to[0], radians(&to)));
            // The distance from the cone is greatest at an end, since both are linear in X.
            let off = off_cone(&from).max(off_cone(&to));
            let bound = Bound { mm: (chord.mm * chord.mm + off * off).sqrt(), rad: chord.rad };
            if 100.0 * tolerance.max(1.0e-4) < bound.mm {
                self.within -= 1;
                return Err(
                    self.differs("point-differs", format!("this line is {:.4} mm from the curve", bound.mm))
                );
            }
            found.deviation = found.deviation.max(bound);
            found.path_blocks += 1;
            from = to;
        }
        ends(curve, first, from[0], found);
        self.leave(points);
        Ok(())
    }

    /// The control's own spline: its points are those that were asked for, and nothing is known between them.
    fn through(
        &mut self,
        log: &Logarithmic,
        points: &WrittenPoints,
        tolerance: f64,
        found: &mut Found,
    ) -> Result<(), Diagnostics> {
        found.status = Status::PointsOnly;
        let asked = through_points(log, tolerance)
            .map_err(|error| self.differs("not-comparable", error.to_string()))?;
        if asked.len() != points.count() {
            let message = format!("the spline has {} points, not {}", points.count(), asked.len());
            return Err(self.differs("points-differ", message));
        }
        let start = self.decimals.position(&points.start);
        let read = std::iter::once(start).chain(points.points().map(|units| self.decimals.position(&units)));
        for (read, (x, a)) in read.zip(std::iter::once((0.0, 0.0)).chain(asked)) {
            found.deviation = found.deviation.max(surface_distance(&log.curve, &read, x, a));
        }
        found.path_blocks = points.count();
        self.advance();
        Ok(())
    }
}

/// The distance at the surface between a position and (x, a) on the cone, a in radians without the index.
#[inline]
fn surface_distance(curve: &LogCurve, read: &Position, x: f64, a: f64) -> Bound {
    let asked = curve.position_with(x, a);
    let turn = (read[3] - asked[3]) / DEGREES;
    let arc = turn * curve.radius(x.max(read[0])).max(curve.radius(x.min(read[0])));
    let (dx, dy, dz) = (read[0] - asked[0], read[1] - asked[1], read[2] - asked[2]);
    Bound { mm: (dx * dx + dy * dy + dz * dz + arc * arc).sqrt(), rad: turn.abs() }
}

/// Adds what a late start or an early end costs.
fn ends(curve: &LogCurve, start: f64, end: f64, found: &mut Found) {
    let missed = start.abs().max((end - curve.end()).abs());
    found.deviation.mm += missed * curve.speed_bound();
    found.deviation.rad += missed * curve.slope(0.0).abs().max(curve.slope(curve.end()).abs());
}

/// How many blocks a curve of so many pieces takes.
fn blocks(written: &Written, pieces: usize) -> usize {
    match written {
        Written::Nurbs(nurbs) => nurbs.points.len() - 1,
        Written::Lines(_) | Written::Polynomial(_) | Written::Through(..) => pieces,
    }
}
