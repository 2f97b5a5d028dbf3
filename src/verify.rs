//! The proof: a program is read back and compared with what was asked, step by step, in order.
//!
//! Tools, spindle, feeds, rapids and their order are compared exactly; paths by the bounds of
//! [`geom::deviation`](crate::geom::deviation), each with its map φ:
//!
//! | asked | written | compared | status |
//! |---|---|---|---|
//! | odd-even steps | lines | point by point, φ the identity on each segment | proved |
//! | odd-even steps | polynomial blocks, B-splines | piece by piece along its segment, φ the projection | proved |
//! | logarithmic curve | lines, polynomial blocks, B-splines | at equal X, φ = X | proved |
//! | either | the control's own spline through points | the points only | points-only |
//!
//! Where a path starts late or ends early by some rounding, the rest of the curve is missed by no more than that times
//! the curve's own speed, which is added to the bound.
//!
//! What the control adds (G642, COMPCAD, cycle 32, G61.1) is not covered.

use crate::decimal::{Decimal, round_units};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::dialect::Reading;
use crate::geom::bezier::Bezier;
use crate::geom::deviation::{Bound, Metric, OrderError, log_chord, log_piece, segment_piece};
use crate::geom::logcurve::LogCurve;
use crate::geom::nurbs::{Nurbs, NurbsError};
use crate::geom::oddeven::OddEven;
use crate::ir::{
    Curve, Cut, Decimals, Intent, Located, Logarithmic, Method, Polyline, Role, Step, Units, Written,
    WrittenPoints,
};
use crate::machine::Machine;
use crate::pass::settle::through_points;
use crate::source::{SourceId, Span};
use crate::units::{DEGREES, Position};

/// How sure the deviation is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Status {
    /// An upper bound everywhere.
    Proved,
    /// Known at the points only: between them the control decides.
    PointsOnly,
}

impl Status {
    /// In one word.
    pub fn word(self) -> &'static str {
        match self {
            Status::Proved => "proved",
            Status::PointsOnly => "points-only",
        }
    }
}

/// What was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// The deviation of the program's paths from the intent.
    pub deviation: Bound,
    /// How sure that is.
    pub status: Status,
    /// Where the intent is odd-even steps: their distance from the ideal curve.
    pub from_ideal: Option<Bound>,
    /// Blocks that cut.
    pub path_blocks: usize,
    /// The paths' length, mm.
    pub cutting_length: f64,
}

/// The distance of odd-even steps from the curve, the same for every flute of a cutter.
struct Ideal(Option<(LogCurve, f64, Bound)>);

/// Compares what was read with what was asked, in `text`, within `tolerance` mm. The intent must be settled.
///
/// # Errors
/// The program does something else, or the same with a greater deviation.
pub fn verify(
    intent: &Intent,
    reading: &Reading,
    text: &str,
    id: SourceId,
    machine: &Machine,
    tolerance: f64,
) -> Result<Report, Diagnostics> {
    let decimals = &reading.decimals;
    let mut report = Report {
        deviation: Bound::ZERO,
        status: Status::Proved,
        from_ideal: None,
        path_blocks: 0,
        cutting_length: 0.0,
    };
    if decimals.program.axes != intent.program.axes {
        return Err(Diagnostic::refusal("axes-differ", "the program has other axes than the input").into());
    }
    for (complete, id, what) in
        [(reading.header, "header-differs", "start"), (reading.footer, "footer-differs", "end")]
    {
        if !complete {
            let message = format!("the program does not {what} with the lines of the machine file");
            return Err(Diagnostic::refusal(id, message).into());
        }
    }
    if decimals.program.name != intent.program.name {
        let message =
            format!("the program is called `{}`, not `{}`", decimals.program.name, intent.program.name);
        return Err(Diagnostic::refusal("name-differs", message).into());
    }
    if let Some(range) = &reading.misnumbered {
        let diagnostic = Diagnostic::refusal(
            "block-number-differs",
            "the blocks are not numbered as the machine file says",
        );
        return Err(diagnostic.at(Span::new(id, range.clone()), "first here").into());
    }
    let mut cursor = Cursor { decimals, text, id, at: 0, within: 0, rate_digits: machine.digits.feed };
    let mut ideal = Ideal(None);
    for located in &intent.program.steps {
        match &located.step {
            Step::Comment(comment) => cursor.comment(comment)?,
            Step::Tool(number) => {
                cursor
                    .meet(&format!("tool {number}"), |step| matches!(step, Step::Tool(n) if n == number))?;
            }
            Step::Spindle(rpm) => {
                let rounded = Decimal::round(*rpm, machine.digits.feed);
                cursor.meet(
                    &format!("the spindle at {rpm} rev/min"),
                    |step| matches!(step, Step::Spindle(read) if Some(*read) == rounded),
                )?;
            }
            Step::Rapid(targets) => {
                let names: Vec<String> = targets
                    .iter()
                    .map(|(axis, to)| format!("{} {to}", intent.program.axes.name(*axis)))
                    .collect();
                cursor.meet(&format!("a rapid to {}", names.join(" ")), |step| {
                    matches!(step, Step::Rapid(read) if read.len() == targets.len()
                    && read.iter().zip(targets).all(|((i, to), (j, asked))| {
                        i == j && round_units(*asked, decimals.digits[*i]) == to.units(decimals.digits[*i])
                    }))
                })?;
            }
            Step::Cut(Cut { feed, role, curve }) => {
                let found = cursor.cut(curve, *feed, tolerance, &mut ideal)?;
                report.deviation = report.deviation.max(found.deviation);
                report.status = report.status.max(found.status);
                if let Some(from_ideal) = found.from_ideal {
                    report.from_ideal =
                        Some(report.from_ideal.map_or(from_ideal, |known| known.max(from_ideal)));
                }
                if *role == Role::Path {
                    report.path_blocks += found.path_blocks;
                    report.cutting_length += found.cutting_length;
                }
            }
        }
    }
    cursor.skip_comments();
    if let Some(left) = cursor.step() {
        let diagnostic = Diagnostic::refusal("more-than-asked", "the program goes on after what was asked");
        return Err(diagnostic.at(cursor.place(left), "").into());
    }
    if !(report.deviation.mm <= tolerance) {
        return Err(Diagnostic::refusal(
            "deviation-too-large",
            format!(
                "the program deviates by up to {:.3e} mm, more than the tolerance of {tolerance} mm",
                report.deviation.mm
            ),
        )
        .into());
    }
    Ok(report)
}

/// Where in the program the comparison stands: a step, and in a run of lines the points already met.
struct Cursor<'p> {
    decimals: &'p Decimals,
    text: &'p str,
    id: SourceId,
    at: usize,
    within: usize,
    /// How many decimals feeds have.
    rate_digits: u8,
}

/// What one cut was found to be.
struct Found {
    deviation: Bound,
    status: Status,
    from_ideal: Option<Bound>,
    path_blocks: usize,
    cutting_length: f64,
}

type ReadStep = Located<Decimal, Written>;

impl<'p> Cursor<'p> {
    fn step(&self) -> Option<&'p ReadStep> {
        self.decimals.program.steps.get(self.at)
    }

    fn skip_comments(&mut self) {
        while matches!(self.step(), Some(Located { step: Step::Comment(_), .. })) {
            self.at += 1;
        }
    }

    /// Meets a remark; others may stand before it.
    fn comment(&mut self, asked: &str) -> Result<(), Diagnostics> {
        while let Some(Located { step: Step::Comment(read), .. }) = self.step() {
            self.at += 1;
            if read == asked {
                return Ok(());
            }
        }
        Err(self.differs("comment-differs", format!("here the remark `{asked}` was asked")))
    }

    fn advance(&mut self) {
        self.at += 1;
        self.within = 0;
    }

    /// The place of the step, or of the point that comes next in a run of lines.
    fn place(&self, located: &ReadStep) -> Span {
        match &located.step {
            Step::Cut(Cut { curve: Written::Lines(line), .. }) => match line.lines.get(self.within) {
                Some(number) => self.line(*number),
                None => located.span,
            },
            Step::Cut(_) | Step::Comment(_) | Step::Tool(_) | Step::Spindle(_) | Step::Rapid(_) => {
                located.span
            }
        }
    }

    /// The place of a line of the text, counted from 1.
    fn line(&self, number: u32) -> Span {
        let mut start = 0;
        for (i, line) in self.text.split_inclusive('\n').enumerate() {
            if i + 1 == number as usize {
                return Span::new(self.id, start..start + line.trim_end().len());
            }
            start += line.len();
        }
        Span::new(self.id, start..start)
    }

    fn differs(&self, id: &'static str, message: String) -> Diagnostics {
        let diagnostic = Diagnostic::refusal(id, message);
        match self.step() {
            Some(located) => diagnostic.at(self.place(located), "").into(),
            None => diagnostic.into(),
        }
    }

    /// Meets a step that is no path.
    fn meet(&mut self, what: &str, is: impl Fn(&Step<Decimal, Written>) -> bool) -> Result<(), Diagnostics> {
        self.skip_comments();
        match self.step() {
            None => Err(self.differs("less-than-asked", format!("the program ends where {what} was asked"))),
            Some(located) if is(&located.step) && self.within == 0 => {
                self.advance();
                Ok(())
            }
            Some(_) if self.within != 0 => {
                Err(self.differs("more-than-asked", format!("a move more, where {what} was asked")))
            }
            Some(_) => Err(self.differs("step-differs", format!("here {what} was asked"))),
        }
    }

    /// Meets a path.
    fn cut(
        &mut self,
        curve: &Curve,
        feed: Option<f64>,
        tolerance: f64,
        ideal: &mut Ideal,
    ) -> Result<Found, Diagnostics> {
        self.skip_comments();
        let Some(Located { step: Step::Cut(cut), .. }) = self.step() else {
            return Err(self.differs("step-differs", "here a path was asked".to_owned()));
        };
        let same_feed = match (feed, cut.feed) {
            (Some(asked), Some(read)) => Decimal::round(asked, self.rate_digits) == Some(read),
            (None, None) => true,
            (Some(_), None) | (None, Some(_)) => false,
        };
        if !same_feed {
            let asked = feed.map_or("none".to_owned(), |feed| feed.to_string());
            return Err(
                self.differs("feed-differs", format!("the feed differs from the {asked} that was asked"))
            );
        }
        match curve {
            Curve::Lines(line) => self.lines(line, &cut.curve),
            Curve::Logarithmic(log) => self.logarithmic(log, &cut.curve, tolerance, ideal),
            Curve::Polynomial(_) | Curve::Nurbs(_) | Curve::Through(..) => {
                Err(self.differs("not-comparable", "this form of input cannot be compared yet".to_owned()))
            }
        }
    }

    /// Straight moves that were asked as such: every point is met exactly, as rounded.
    fn lines(&mut self, asked: &Polyline, written: &Written) -> Result<Found, Diagnostics> {
        let Written::Lines(points) = written else {
            return Err(self.differs("step-differs", "here a straight move was asked".to_owned()));
        };
        let mut worst = 0.0f64;
        for point in asked.points() {
            let Some(units) = self.next_point(points) else {
                return Err(self.differs("less-than-asked", "a straight move is missing here".to_owned()));
            };
            for axis in 0..asked.stride {
                if round_units(point[axis], self.decimals.digits[axis]) != Some(units[axis]) {
                    let name = self.decimals.program.axes.name(axis);
                    self.within -= 1;
                    return Err(
                        self.differs("point-differs", format!("{name} was asked to be {}", point[axis]))
                    );
                }
            }
            let read = self.decimals.position(&units);
            worst = (0..asked.stride).fold(worst, |worst, i| worst.max((read[i] - point[i]).abs()));
        }
        let count = asked.count();
        self.leave(points);
        Ok(Found {
            deviation: Bound { mm: worst, rad: 0.0 },
            status: Status::Proved,
            from_ideal: None,
            path_blocks: count,
            cutting_length: 0.0,
        })
    }

    /// The next point of a run.
    #[inline]
    fn next_point(&mut self, points: &WrittenPoints) -> Option<Units> {
        let chunk = points.units.get(self.within * points.stride..(self.within + 1) * points.stride)?;
        let mut units = [0; crate::units::MAX_AXES];
        units[..chunk.len()].copy_from_slice(chunk);
        self.within += 1;
        Some(units)
    }

    /// Goes on to the next step where a run was met whole.
    fn leave(&mut self, points: &WrittenPoints) {
        if points.count() <= self.within {
            self.advance();
        }
    }

    /// Where the tool stands before the next point of a run.
    fn before(&self, points: &WrittenPoints) -> Units {
        match self.within.checked_sub(1) {
            None => points.start,
            Some(last) => {
                let mut units = points.start;
                units[..points.stride]
                    .copy_from_slice(&points.units[last * points.stride..(last + 1) * points.stride]);
                units
            }
        }
    }

    fn logarithmic(
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
            let key = curve.with_index(0.0);
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
                found.path_blocks = match written {
                    Written::Nurbs(nurbs) => nurbs.points.len() - 1,
                    Written::Lines(_) | Written::Polynomial(_) | Written::Through(..) => pieces.len(),
                };
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
                found.path_blocks += 1;
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
            let (dy, dz) = (p[1] - p[0] * curve.y_slope(), p[2] - p[0] * curve.z_slope());
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

    /// The pieces that a curve in decimals means.
    fn pieces(&self, written: &Written) -> Result<Vec<Bezier>, Diagnostics> {
        match written {
            Written::Polynomial(polynomial) => {
                let mut start = polynomial.start;
                let piece = |block: &crate::ir::PolynomialBlock| {
                    let piece = block.to_bezier(&self.decimals.digits, &start);
                    start = block.end;
                    piece
                };
                Ok(polynomial.blocks.iter().map(piece).collect())
            }
            Written::Nurbs(nurbs) => {
                let spline = to_nurbs(self.decimals, nurbs)
                    .map_err(|error| self.differs("spline-unsound", error.to_string()))?;
                Ok(spline.beziers().map(|(piece, _)| piece).collect())
            }
            Written::Lines(_) | Written::Through(..) => Ok(Vec::new()),
        }
    }
}

/// Compares a program with what would be written for the same meaning, line by line and word by word: a doubled or
/// moved line may mean nothing to the path, and still show that somebody changed the program.
///
/// # Errors
/// A line has other words.
pub fn same_form(text: &str, written: &str, id: SourceId) -> Result<(), Diagnostics> {
    let mut start = 0;
    let mut expected = written.lines();
    let differs = |range: std::ops::Range<usize>, line: Option<&str>| {
        let message = "the program means what was asked, but this line is not as it would be written";
        let diagnostic = Diagnostic::refusal("form-differs", message).at(Span::new(id, range), "");
        Err(match line {
            Some(line) => diagnostic.hint(format!("here `{line}` would stand")),
            None => diagnostic,
        }
        .into())
    };
    for line in text.split_inclusive('\n') {
        let range = start..start + line.trim_end().len();
        start += line.len();
        let words = line.trim_start_matches('\u{feff}').split_whitespace();
        match expected.next() {
            Some(own) if own.split_whitespace().eq(words) => {}
            own => return differs(range, own),
        }
    }
    match expected.next() {
        Some(own) => differs(text.len()..text.len(), Some(own)),
        None => Ok(()),
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

/// The B-spline that decimals mean.
///
/// # Errors
/// See [`NurbsError`].
pub fn to_nurbs(decimals: &Decimals, nurbs: &crate::ir::WrittenNurbs) -> Result<Nurbs, NurbsError> {
    let knots = nurbs.knots.iter().map(|t| crate::decimal::units_to_f64(*t, nurbs.knot_digits)).collect();
    let points: Vec<Position> = nurbs.points.iter().map(|units| decimals.position(units)).collect();
    let weights = match &nurbs.weights {
        None => vec![1.0; points.len()],
        Some(weights) => weights.iter().map(|w| w.to_f64()).collect(),
    };
    Nurbs::new(nurbs.degree, knots, points, weights)
}
