//! Paths of a cutter's flute, in every form that they are written in.

use super::{Cursor, Found, Ideal, Status};
use crate::decimal::{round_units, unit_at_surface};
use crate::diagnostic::Diagnostics;
use crate::geom::bezier::Bezier;
use crate::geom::deviation::{Bound, Metric, OrderError, log_chord, log_piece, segment_piece};
use crate::geom::logcurve::LogCurve;
use crate::geom::oddeven::{OddEven, polyline_deviation};
use crate::ir::{Logarithmic, Method, Written, WrittenPoints};
use crate::pass::settle::{steps, through_points};
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
            let asked = steps(log).map_err(|error| self.differs("not-comparable", error.to_string()))?;
            // An overrun runs on to the last step.
            let overrun_end = if log.overrun { asked.clone().last().map(|(x, _)| x) } else { None };
            let key = Logarithmic { curve: curve.base(), ..log.clone() };
            let from_ideal = match ideal.0.take() {
                Some((known, bound)) if known == key => bound,
                _ => polyline_deviation(curve, asked.clone()),
            };
            ideal.0 = Some((key, from_ideal));
            found.from_ideal = Some(from_ideal);
            match written {
                Written::Lines(points) => self.odd_even_lines(curve, asked, points, &mut found)?,
                Written::Polynomial(_) | Written::Nurbs(_) => {
                    let pieces = self.pieces(written)?;
                    self.odd_even_pieces(curve, asked, &pieces, &mut found)?;
                    found.path_blocks = blocks(written, pieces.len());
                    self.advance();
                }
                Written::Through(_, points) => self.through(log, points, tolerance, &mut found)?,
            }
            if let Some(end) = overrun_end {
                found.cutting_length = end * curve.length_per_x();
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

    /// Odd-even steps written as lines: the same polyline, every coordinate of every point rounded, nothing else.
    ///
    /// Run at the same pace, two segments differ by ΔX, ΔY, ΔZ and ΔA that are linear between the ends, and the arc is
    /// R·ΔA with R linear too; so the distance is bounded by the greater of each at the two ends, taken together.
    fn odd_even_lines(
        &mut self,
        curve: &LogCurve,
        steps: OddEven,
        points: &WrittenPoints,
        found: &mut Found,
    ) -> Result<(), Diagnostics> {
        let start = self.decimals.position(&self.before(points));
        let mut last = End::of(curve, &start, 0.0, 0.0);
        found.deviation = found.deviation.max(last.segment(&last));
        for (x, a) in steps {
            let Some(units) = self.next_point(points) else {
                return Err(
                    self.differs("less-than-asked", "points are missing at the end of a path".to_owned())
                );
            };
            let asked = curve.position_with(x, a);
            for axis in 0..4 {
                if round_units(asked[axis], self.decimals.digits[axis]) != Some(units[axis]) {
                    self.within -= 1;
                    let name = self.decimals.program.axes.name(axis);
                    let message = format!("{name} of this step was asked to be {}", asked[axis]);
                    let mut refused = self.differs("point-differs", message);
                    for diagnostic in &mut refused.0 {
                        diagnostic.hints.push(
                            "where the input states no dl, it follows from the tolerance: verify with the --tolerance \
                             that the program was compiled with"
                                .to_owned(),
                        );
                    }
                    return Err(refused);
                }
            }
            let end = End::of(curve, &self.decimals.position(&units), x, a);
            found.deviation = found.deviation.max(last.segment(&end));
            found.path_blocks += 1;
            last = end;
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
        let far = steps.clone().last().map_or(0.0, |(x, _)| curve.metric_radius(x));
        let radius = curve.max_radius().max(far);
        let metric = Metric::new(&metric_kinds, radius);
        // Two roundings of a position, at the radius.
        let slack = 1.0e-9 + unit_at_surface(&self.decimals.program.axes, &self.decimals.digits, radius);
        let mut from = curve.position(0.0);
        let mut rest = pieces.iter().peekable();
        if let Some(first) = pieces.first() {
            found.deviation = found.deviation.max(metric.distance(&first.start(), &from));
        }
        for (x, a) in steps {
            let to = curve.position_with(x, a);
            // How far along the segment the path has come; all its pieces together run in order.
            let mut reached = f64::NEG_INFINITY;
            // Pieces belong to this segment until one ends at its end.
            loop {
                let Some(piece) = rest.next() else {
                    return Err(
                        self.differs("less-than-asked", "pieces are missing at the end of a path".to_owned())
                    );
                };
                let bound = segment_piece(&metric, (&from, &to), piece, slack, &mut reached)
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

/// How far the end of a written segment is from the end of the segment that was asked.
#[derive(Clone, Copy)]
struct End {
    linear: f64,
    turn: f64,
    radius: f64,
}

impl End {
    #[inline]
    fn of(curve: &LogCurve, read: &Position, x: f64, a: f64) -> End {
        let asked = curve.position_with(x, a);
        let (dx, dy, dz) = (read[0] - asked[0], read[1] - asked[1], read[2] - asked[2]);
        End {
            linear: (dx * dx + dy * dy + dz * dz).sqrt(),
            turn: ((read[3] - asked[3]) / DEGREES).abs(),
            radius: curve.metric_radius(x).max(curve.metric_radius(read[0])),
        }
    }

    /// The bound for the segment between two ends.
    #[inline]
    fn segment(&self, other: &End) -> Bound {
        let (linear, rad) = (self.linear.max(other.linear), self.turn.max(other.turn));
        let arc = self.radius.max(other.radius) * rad;
        Bound { mm: (linear * linear + arc * arc).sqrt(), rad }
    }
}

/// The distance at the surface between a position and (x, a) on the cone, a in radians without the index.
fn surface_distance(curve: &LogCurve, read: &Position, x: f64, a: f64) -> Bound {
    let end = End::of(curve, read, x, a);
    end.segment(&end)
}

/// Adds what a late start or an early end costs: how far the curve runs between where it was asked to end and where the
/// path does.
fn ends(curve: &LogCurve, start: f64, end: f64, found: &mut Found) {
    let (mm, rad) = [(start, 0.0), (end, curve.end())]
        .map(|(read, asked)| curve.run_bound(read, asked))
        .into_iter()
        .fold((0.0, 0.0), |most: (f64, f64), run| (most.0.max(run.0), most.1.max(run.1)));
    found.deviation.mm += mm;
    found.deviation.rad += rad;
}

/// How many blocks a curve of so many pieces takes.
fn blocks(written: &Written, pieces: usize) -> usize {
    match written {
        Written::Nurbs(nurbs) => nurbs.points.len() - 1,
        Written::Lines(_) | Written::Polynomial(_) | Written::Through(..) => pieces,
    }
}
