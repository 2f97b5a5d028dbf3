//! Paths of a cutter's flute, in every form that they are written in.

use super::{Cursor, Found, Ideal, Status};
use crate::decimal::{Decimal, unit_at_surface};
use crate::diagnostic::Diagnostics;
use crate::geom::bernstein::Bernstein;
use crate::geom::bezier::Bezier;
use crate::geom::deviation::{Bound, Metric, OrderError, log_chord, log_piece, segment_piece};
use crate::geom::length::{length, of_derivative};
use crate::geom::logcurve::LogCurve;
use crate::geom::oddeven::{OddEven, polyline_deviation};
use crate::ir::{Logarithmic, Method, Written, WrittenPoints};
use crate::machine::RotaryFeed;
use crate::pass::settle::{steps, through_points};
use crate::pass::stretch::{Stretch, rate, stretch_of, stretches};
use crate::units::{DEGREES, Position};

impl<'p> Cursor<'p> {
    /// Meets the path of a flute, stretch by stretch.
    pub(super) fn logarithmic(
        &mut self,
        log: &Logarithmic,
        feed: Option<f64>,
        tolerance: f64,
        ideal: &mut Ideal,
    ) -> Result<Found, Diagnostics> {
        let curve = &log.curve;
        let written = &self.written()?.curve;
        let whole = matches!(written, Written::Through(..));
        let stretches = stretches(log, feed, whole, self.machine);
        let length = curve.end() - curve.start();
        let mut found = Found {
            feed_error: stretches.iter().map(|stretch| stretch.error).fold(0.0, f64::max),
            cutting_length: length * curve.length_per_x(),
            ..Found::new()
        };
        if log.method != Method::OddEven {
            match written {
                Written::Lines(_) => self.chords((log, feed), &stretches, &mut found, tolerance)?,
                Written::Arc(_) => return Err(self.arc_here()),
                Written::Polynomial(_) | Written::Nurbs(_) => {
                    let (pieces, feeds) = self.path_pieces(log, curve.end(), &mut found)?;
                    let half = self.half_of_x();
                    for (piece, feed) in pieces.iter().zip(&feeds) {
                        let reaches = piece.start()[0].max(piece.end()[0]);
                        self.piece_feed(feed, &stretches[stretch_of(&stretches, reaches - half)])?;
                    }
                    let at_equal_x = whole_path(curve, &pieces, false);
                    let bound = match at_equal_x {
                        Ok(bound) if bound.mm <= tolerance => Ok(bound),
                        Ok(bound) => Ok(whole_path(curve, &pieces, true)
                            .ok()
                            .filter(|nearest| nearest.mm < bound.mm)
                            .unwrap_or(bound)),
                        Err(error) => whole_path(curve, &pieces, true).map_err(|_| error),
                    };
                    found.deviation = bound.map_err(|(i, error)| {
                        self.differs("order-differs", format!("in piece {}: {error}", i + 1))
                    })?;
                }
                Written::Through(_, points) => {
                    self.through(log, &stretches, points, tolerance, &mut found)?;
                }
            }
            return Ok(found);
        }
        let asked = steps(log).map_err(|error| self.differs("not-comparable", error.to_string()))?;
        // An overrun runs on to the last step.
        let end =
            if log.overrun { asked.clone().last().map_or(curve.end(), |(x, _)| x) } else { curve.end() };
        let key = Logarithmic { curve: curve.base(), ..log.clone() };
        let from_ideal = match ideal.0.take() {
            Some((known, bound)) if known == key => bound,
            _ => polyline_deviation(curve, asked.clone()),
        };
        ideal.0 = Some((key, from_ideal));
        found.from_ideal = Some(from_ideal);
        match written {
            Written::Lines(_) => {
                let start = (curve.start(), curve.angle(curve.start()));
                let stretch = |x: f64| stretch_of(&stretches, x);
                if log.back {
                    let mut points: Vec<(f64, f64)> = std::iter::once(start).chain(asked).collect();
                    points.reverse();
                    let steps = points.windows(2).map(|pair| (pair[1], stretch(pair[0].0)));
                    self.odd_even_lines((log, feed), points[0], steps, &stretches, &mut found)?;
                } else {
                    let steps = asked.map(|point| (point, stretch(point.0)));
                    self.odd_even_lines((log, feed), start, steps, &stretches, &mut found)?;
                }
            }
            Written::Arc(_) => return Err(self.arc_here()),
            Written::Polynomial(_) | Written::Nurbs(_) => {
                let (pieces, feeds) = self.path_pieces(log, end, &mut found)?;
                self.odd_even_pieces(curve, asked, (&pieces, &feeds), &stretches, &mut found)?;
            }
            Written::Through(_, points) => self.through(log, &stretches, points, tolerance, &mut found)?,
        }
        found.cutting_length = (end - curve.start()) * curve.length_per_x();
        Ok(found)
    }

    /// Checks F of a stretch.
    fn stretch_feed(&self, read: Option<Decimal>, stretch: &Stretch) -> Result<(), Diagnostics> {
        self.same_feed(read, stretch.feed)
    }

    /// Whether lines of this path have their time as F.
    fn is_timed(&self, log: &Logarithmic) -> bool {
        self.machine.rotary_feed == RotaryFeed::InverseTime && log.curve.k() != 0.0
    }

    /// Checks F of the line that was met last, which is to take the time of the way between two X at a feed. X is known
    /// to `unit` mm at both ends. How long it takes, minutes.
    fn line_time(
        &self,
        run: &WrittenPoints,
        (log, feed): (&Logarithmic, Option<f64>),
        (from, to): (f64, f64),
        unit: f64,
    ) -> Result<f64, Diagnostics> {
        let Some(feed) = feed else { return Ok(0.0) };
        let asked = rate(log, feed, from, to);
        let last = 1.0 / crate::decimal::power_of_ten(self.machine.digits.feed) as f64;
        // Half a unit of F with the noise of a float, and what the ends' rounding makes of the way.
        let allowed = 0.500_000_1 * last + asked * 2.0 * unit / (to - from).abs();
        let read = self.within.checked_sub(1).and_then(|at| run.rates.get(at)).map(|rate| rate.to_f64());
        match read.filter(|read| (read - asked).abs() <= allowed) {
            Some(read) => Ok(1.0 / read),
            None => {
                let message = format!("F of this line is not the {asked:.3} that its time asks for");
                Err(self.differs("feed-differs", message))
            }
        }
    }

    /// The pieces of a path from where the cursor stands to where X = `end` is reached, in the order of X, and the F of each.
    fn path_pieces(
        &mut self,
        log: &Logarithmic,
        end: f64,
        found: &mut Found,
    ) -> Result<(Vec<Bezier>, Vec<PieceFeed>), Diagnostics> {
        let half = self.half_of_x();
        let mut all: Vec<Bezier> = Vec::new();
        let mut feeds = Vec::new();
        loop {
            let cut = self.written()?;
            let pieces = self.pieces(&cut.curve)?;
            if pieces.is_empty() {
                return Err(self.differs("less-than-asked", "the path ends before its end".to_owned()));
            }
            found.path_blocks += blocks(&cut.curve, pieces.len());
            for piece in &pieces {
                feeds.push(PieceFeed { feed: cut.feed, at: self.at });
                found.minutes += self.minutes(&log.curve, piece, cut.feed);
            }
            all.extend(pieces);
            self.advance();
            let reached = all.last().map_or(0.0, |piece| piece.end()[0]);
            if if log.back { reached <= log.curve.start() + half } else { end - half <= reached } {
                break;
            }
        }
        if log.back {
            all = all.iter().rev().map(Bezier::reversed).collect();
            feeds.reverse();
        }
        Ok((all, feeds))
    }

    /// Half a unit of X: the most that rounding takes from the end of a path.
    fn half_of_x(&self) -> f64 {
        0.5 / crate::decimal::power_of_ten(self.decimals.digits[0]) as f64 + 1.0e-12
    }

    /// Checks F of a piece that lies behind.
    fn piece_feed(&mut self, piece: &PieceFeed, stretch: &Stretch) -> Result<(), Diagnostics> {
        if self.stretch_feed(piece.feed, stretch).is_ok() {
            return Ok(());
        }
        // Told where the piece stands.
        (self.at, self.within) = (piece.at, 0);
        self.stretch_feed(piece.feed, stretch)
    }

    /// How long a piece takes, minutes. At the surface A counts at the radius there, which is linear in X, so that what F counts
    /// of a polynomial piece is the length of a vector of polynomials.
    fn minutes(&self, curve: &LogCurve, piece: &Bezier, feed: Option<Decimal>) -> f64 {
        let Some(feed) = feed.map(Decimal::to_f64) else { return 0.0 };
        let scaled = |degree: f64| length(piece, &[1.0, 1.0, 1.0, degree, 0.0, 0.0]).mm / feed;
        match self.machine.rotary_feed {
            RotaryFeed::Free | RotaryFeed::InverseTime => scaled(0.0),
            RotaryFeed::DegreesAsMm => scaled(1.0),
            RotaryFeed::Surface if piece.is_polynomial() => {
                let slope = curve.radius(1.0) - curve.radius(0.0);
                let radius = piece.numerator(0).scaled(slope / piece.weights[0], curve.radius(0.0));
                let [dx, dy, dz, da]: [Bernstein; 4] = std::array::from_fn(|axis| {
                    piece.numerator(axis).derivative().scaled(1.0 / piece.weights[0], 0.0)
                });
                of_derivative(&[dx, dy, dz, da.times(&radius).scaled(1.0 / DEGREES, 0.0)]).mm / feed
            }
            // Nothing here writes such pieces; those of others take A at the greatest radius of each sixteenth.
            RotaryFeed::Surface => (0..16)
                .map(|i| {
                    let part = piece.segment(f64::from(i) / 16.0, f64::from(i + 1) / 16.0);
                    let radius = curve.radius(part.start()[0]).max(curve.radius(part.end()[0]));
                    length(&part, &[1.0, 1.0, 1.0, radius / DEGREES, 0.0, 0.0]).mm / feed
                })
                .sum(),
        }
    }

    /// The line from one position to another in minutes.
    #[inline]
    fn line_minutes(&self, curve: &LogCurve, from: &Position, to: &Position, feed: Option<Decimal>) -> f64 {
        let Some(feed) = feed.map(Decimal::to_f64) else { return 0.0 };
        let [dx, dy, dz, da]: [f64; 4] = std::array::from_fn(|axis| to[axis] - from[axis]);
        let turn = match self.machine.rotary_feed {
            RotaryFeed::Free | RotaryFeed::InverseTime => 0.0,
            RotaryFeed::DegreesAsMm => da,
            RotaryFeed::Surface => da / DEGREES * curve.radius(0.5 * (from[0] + to[0])),
        };
        (dx * dx + dy * dy + dz * dz + turn * turn).sqrt() / feed
    }

    /// The run of lines that comes next, with F of a stretch.
    fn lines_of(&self, stretch: &Stretch) -> Result<(&'p WrittenPoints, Option<Decimal>), Diagnostics> {
        let cut = self.written()?;
        self.stretch_feed(cut.feed, stretch)?;
        match &cut.curve {
            Written::Lines(points) => Ok((points, cut.feed)),
            Written::Arc(_) | Written::Polynomial(_) | Written::Nurbs(_) | Written::Through(..) => {
                Err(self.differs("step-differs", "here straight moves were asked".to_owned()))
            }
        }
    }

    /// Odd-even steps written as lines: the same polyline, every coordinate of every point rounded, nothing else.
    ///
    /// Run at the same pace, two segments differ by ΔX, ΔY, ΔZ and ΔA that are linear between the ends, and the arc is
    /// R·ΔA with R linear too; so the distance is bounded by the greater of each at the two ends, taken together.
    fn odd_even_lines(
        &mut self,
        (log, asked_feed): (&Logarithmic, Option<f64>),
        start: (f64, f64),
        steps: impl Iterator<Item = ((f64, f64), usize)>,
        stretches: &[Stretch],
        found: &mut Found,
    ) -> Result<(), Diagnostics> {
        let (curve, timed) = (&log.curve, self.is_timed(log));
        let Some(mut run) = self.lines_run()? else {
            return Err(self.differs("step-differs", "here straight moves were asked".to_owned()));
        };
        let mut from = self.decimals.position(&self.before(run));
        let mut last = End::of(curve, &from, start.0, start.1);
        let (mut at, mut feed) = (usize::MAX, None);
        let mut x_before = start.0;
        found.deviation = found.deviation.max(last.segment(&last));
        for ((x, a), stretch) in steps {
            if stretch != at {
                if at != usize::MAX {
                    self.leave(run);
                }
                if timed {
                    run = self.lines_run()?.unwrap_or(run);
                } else {
                    (run, feed) = self.lines_of(&stretches[stretch])?;
                }
                at = stretch;
            }
            let Some(units) = self.next_point(run) else {
                return Err(
                    self.differs("less-than-asked", "points are missing at the end of a path".to_owned())
                );
            };
            let asked = curve.position_with(x, a);
            for axis in 0..4 {
                if self.units(axis, asked[axis]) != Some(units[axis]) {
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
            let to = self.decimals.position(&units);
            let end = End::of(curve, &to, x, a);
            found.deviation = found.deviation.max(last.segment(&end));
            found.path_blocks += 1;
            found.minutes += if timed {
                self.line_time(run, (log, asked_feed), (x_before, x), 0.0)?
            } else {
                self.line_minutes(curve, &from, &to, feed)
            };
            x_before = x;
            (last, from) = (end, to);
        }
        self.leave(run);
        Ok(())
    }

    /// The run of lines that comes next, whatever its feed.
    fn lines_run(&self) -> Result<Option<&'p WrittenPoints>, Diagnostics> {
        Ok(match &self.written()?.curve {
            Written::Lines(points) => Some(points),
            Written::Arc(_) | Written::Polynomial(_) | Written::Nurbs(_) | Written::Through(..) => None,
        })
    }

    /// Odd-even steps written as pieces: each piece runs along one segment, in order, at the F of the stretch that its step
    /// belongs to. Where knots were inserted a piece may end inside a step, so that its own X does not say which that is.
    fn odd_even_pieces(
        &mut self,
        curve: &LogCurve,
        steps: OddEven,
        (pieces, feeds): (&[Bezier], &[PieceFeed]),
        stretches: &[Stretch],
        found: &mut Found,
    ) -> Result<(), Diagnostics> {
        let metric_kinds: Vec<_> =
            self.decimals.program.axes.as_slice().iter().map(|(_, kind)| *kind).collect();
        let far = steps.clone().last().map_or(0.0, |(x, _)| curve.metric_radius(x));
        let radius = curve.max_radius().max(far);
        let metric = Metric::new(&metric_kinds, radius);
        // Two roundings of a position, at the radius.
        let slack = 1.0e-9 + unit_at_surface(&self.decimals.program.axes, &self.decimals.digits, radius);
        let mut from = curve.position(curve.start());
        let mut rest = pieces.iter().zip(feeds);
        if let Some(first) = pieces.first() {
            found.deviation = found.deviation.max(metric.distance(&first.start(), &from));
        }
        for (x, a) in steps {
            let to = curve.position_with(x, a);
            let stretch = &stretches[stretch_of(stretches, x)];
            // How far along the segment the path has come; all its pieces together run in order.
            let mut reached = f64::NEG_INFINITY;
            // Pieces belong to this segment until one ends at its end.
            loop {
                let Some((piece, feed)) = rest.next() else {
                    return Err(
                        self.differs("less-than-asked", "pieces are missing at the end of a path".to_owned())
                    );
                };
                self.piece_feed(feed, stretch)?;
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
        (log, asked_feed): (&Logarithmic, Option<f64>),
        stretches: &[Stretch],
        found: &mut Found,
        tolerance: f64,
    ) -> Result<(), Diagnostics> {
        let (curve, timed) = (&log.curve, self.is_timed(log));
        let Some(mut run) = self.lines_run()? else { return Ok(()) };
        let mut from = self.decimals.position(&self.before(run));
        // At equal X, and with each point at the place of the curve that is nearest to it: where A turns fast, half a unit
        // of X is a long way. Along a path the nearest places wait rather than run back.
        let off_cone = |p: &Position, x: f64| {
            let asked = curve.position_with(x, 0.0);
            let (dx, dy, dz) = (p[0] - x, p[1] - asked[1], p[2] - asked[2]);
            (dx * dx + dy * dy + dz * dz).sqrt()
        };
        let mut near = curve.nearest_x(&from);
        let (first, first_near) = (from[0], near);
        let mut nearest = Bound::ZERO;
        let radians = |p: &Position| (p[3] - curve.index) / DEGREES;
        let half = self.half_of_x();
        let done = |x: f64| if log.back { x <= curve.start() + half } else { curve.end() - half <= x };
        while !done(from[0]) {
            if run.count() <= self.within {
                self.leave(run);
                match self.lines_run()? {
                    Some(next) => run = next,
                    None => {
                        return Err(
                            self.differs("less-than-asked", "the path ends before its end".to_owned())
                        );
                    }
                }
            }
            let feed = self.written()?.feed;
            let Some(units) = self.next_point(run) else {
                return Err(self.differs("less-than-asked", "the path ends before its end".to_owned()));
            };
            let to = self.decimals.position(&units);
            let (low, high) = if log.back { (&to, &from) } else { (&from, &to) };
            let refused = if high[0] < low[0] {
                Some(("order-differs", OrderError::RunsBack.to_string()))
            } else {
                None
            };
            // The distance from the cone is greatest at an end, since both are linear in X.
            let bound = |[x_from, x_to]: [f64; 2]| {
                let (x_low, x_high) = if log.back { (x_to, x_from) } else { (x_from, x_to) };
                let chord = log_chord(curve, (x_low, radians(low)), (x_high, radians(high)));
                let off = off_cone(&from, x_from).max(off_cone(&to, x_to));
                Bound { mm: (chord.mm * chord.mm + off * off).sqrt(), rad: chord.rad }
            };
            let next = curve.nearest_x(&to);
            let next = if log.back { next.min(near) } else { next.max(near) };
            nearest = nearest.max(bound([near, next]));
            near = next;
            let bound = bound([from[0], to[0]]);
            let off = bound.mm.min(nearest.mm);
            let refused = refused.or_else(|| {
                (100.0 * tolerance.max(1.0e-4) < off)
                    .then(|| ("point-differs", format!("this line is {off:.4} mm from the curve")))
            });
            if let Some((id, message)) = refused {
                self.within -= 1;
                return Err(self.differs(id, message));
            }
            found.deviation = found.deviation.max(bound);
            found.path_blocks += 1;
            found.minutes += if timed {
                self.line_time(run, (log, asked_feed), (low[0], high[0]), half)?
            } else {
                self.stretch_feed(feed, &stretches[stretch_of(stretches, high[0] - half)])?;
                self.line_minutes(curve, &from, &to, feed)
            };
            from = to;
        }
        let order = |first: f64, last: f64| if log.back { (last, first) } else { (first, last) };
        let (start, end) = order(first, from[0]);
        add(&mut found.deviation, missed(curve, start, end));
        let (start, end) = order(first_near, near);
        add(&mut nearest, missed(curve, start, end));
        if tolerance < found.deviation.mm && nearest.mm < found.deviation.mm {
            found.deviation = nearest;
        }
        self.leave(run);
        Ok(())
    }

    /// The control's own spline: its points are those that were asked for, and nothing is known between them.
    fn through(
        &mut self,
        log: &Logarithmic,
        stretches: &[Stretch],
        points: &WrittenPoints,
        tolerance: f64,
        found: &mut Found,
    ) -> Result<(), Diagnostics> {
        found.status = Status::PointsOnly;
        let feed = self.written()?.feed;
        self.stretch_feed(feed, &stretches[0])?;
        let asked = through_points(log, tolerance)
            .map_err(|error| self.differs("not-comparable", error.to_string()))?;
        if asked.len() != points.count() {
            let message = format!("the spline has {} points, not {}", points.count(), asked.len());
            return Err(self.differs("points-differ", message));
        }
        let first = (log.curve.start(), log.curve.angle(log.curve.start()));
        let mut asked: Vec<(f64, f64)> = std::iter::once(first).chain(asked).collect();
        if log.back {
            asked.reverse();
        }
        let start = self.decimals.position(&points.start);
        let read = std::iter::once(start).chain(points.points().map(|units| self.decimals.position(&units)));
        let mut from = start;
        for (read, (x, a)) in read.zip(asked) {
            found.deviation = found.deviation.max(surface_distance(&log.curve, &read, x, a));
            found.minutes += self.line_minutes(&log.curve, &from, &read, feed);
            from = read;
        }
        found.path_blocks = points.count();
        self.advance();
        Ok(())
    }
}

/// The F that a piece has in the text, and the step that it belongs to.
struct PieceFeed {
    feed: Option<Decimal>,
    at: usize,
}

/// The bound for all pieces of a path, or the number of the first that has none: at equal X; or with each transition at the
/// `nearest` place of the curve, where A turns so fast that half a unit of X is a long way.
fn whole_path(curve: &LogCurve, pieces: &[Bezier], nearest: bool) -> Result<Bound, (usize, OrderError)> {
    let at = |p: &Position| if nearest { curve.nearest_x(p) } else { p[0] };
    let mut bound = Bound::ZERO;
    for (i, piece) in pieces.iter().enumerate() {
        let ahead = [piece.start(), piece.end()].map(|p| at(&p) - p[0]);
        bound = bound.max(log_piece(curve, piece, ahead).map_err(|error| (i, error))?);
    }
    if let (Some(first), Some(last)) = (pieces.first(), pieces.last()) {
        add(&mut bound, missed(curve, at(&first.start()), at(&last.end())));
    }
    Ok(bound)
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

fn add(bound: &mut Bound, more: Bound) {
    bound.mm += more.mm;
    bound.rad += more.rad;
}

/// What a late start or an early end costs: how far the curve runs between where it was asked to end and where the path
/// does.
fn missed(curve: &LogCurve, start: f64, end: f64) -> Bound {
    let (mm, rad) = [(start, curve.start()), (end, curve.end())]
        .map(|(read, asked)| curve.run_bound(read, asked))
        .into_iter()
        .fold((0.0, 0.0), |most: (f64, f64), run| (most.0.max(run.0), most.1.max(run.1)));
    Bound { mm, rad }
}

/// How many blocks a curve of so many pieces takes.
fn blocks(written: &Written, pieces: usize) -> usize {
    match written {
        Written::Nurbs(nurbs) => nurbs.points.len() - 1,
        Written::Lines(_) | Written::Arc(_) | Written::Polynomial(_) | Written::Through(..) => pieces,
    }
}
