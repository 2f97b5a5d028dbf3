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
//! | lines | lines | point by point | proved |
//! | any other curve | lines, polynomial blocks, B-splines | at equal parameters, or by a rising map of its own | proved |
//!
//! Where a path starts late or ends early by some rounding, the rest of the curve is missed by no more than that times
//! the curve's own speed, which is added to the bound.
//!
//! What the control adds (G642, COMPCAD, cycle 32, G61.1) is not covered.

mod curve;
mod logarithmic;

use crate::decimal::{Decimal, round_units};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::dialect::Reading;
use crate::geom::bezier::Bezier;
use crate::geom::deviation::Bound;
use crate::geom::follow::Map;
use crate::geom::nurbs::{Nurbs, NurbsError};
use crate::ir::{
    Curve, Cut, Decimals, Intent, Located, Logarithmic, Polyline, Role, Step, Units, Written, WrittenPoints,
};
use crate::machine::Machine;
use crate::source::{SourceId, Span};
use crate::units::{Axes, Kind, Position};

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
    /// The map that the deviation of curves holds for, where it needed one of its own.
    pub map: Option<Map>,
    /// Blocks that cut.
    pub path_blocks: usize,
    /// The paths' length, mm.
    pub cutting_length: f64,
}

/// The distance of odd-even steps from the curve, the same for every flute of a cutter.
struct Ideal(Option<(Logarithmic, Bound)>);

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
        map: None,
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
    let rate_digits = machine.digits.feed;
    let radius = intent.radius();
    let mut cursor = Cursor { decimals, text, id, at: 0, within: 0, rate_digits, machine, radius, map: None };
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
                cursor.skip_comments();
                let (at, within) = (cursor.at, cursor.within);
                let found = cursor.cut(curve, *feed, tolerance, &mut ideal)?;
                if !(found.deviation.mm <= tolerance) {
                    let message = format!(
                        "the program deviates by up to {:.3e} mm, more than the tolerance of {tolerance} mm",
                        found.deviation.mm
                    );
                    let diagnostic = Diagnostic::refusal("deviation-too-large", message);
                    // Looked up only now: finding a line reads the text.
                    (cursor.at, cursor.within) = (at, within);
                    return Err(match cursor.step() {
                        Some(step) => diagnostic.at(cursor.place(step), "").into(),
                        None => diagnostic.into(),
                    });
                }
                report.deviation = report.deviation.max(found.deviation);
                report.status = report.status.max(found.status);
                if let Some(from_ideal) = found.from_ideal {
                    report.from_ideal =
                        Some(report.from_ideal.map_or(from_ideal, |known| known.max(from_ideal)));
                }
                report.map = cursor.map;
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
    machine: &'p Machine,
    /// The radius at which rotary axes count, mm.
    radius: f64,
    /// The map that the bounds hold for so far.
    map: Option<Map>,
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
            Step::Cut(Cut { curve: Written::Polynomial(polynomial), .. }) => {
                match polynomial.blocks.get(self.within).filter(|block| block.line != 0) {
                    Some(block) => self.line(block.line),
                    None => located.span,
                }
            }
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

    /// Meets a path; remarks before it are behind.
    fn cut(
        &mut self,
        curve: &Curve,
        feed: Option<f64>,
        tolerance: f64,
        ideal: &mut Ideal,
    ) -> Result<Found, Diagnostics> {
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
        match (curve, &cut.curve) {
            (Curve::Lines(line), written @ Written::Lines(_)) => self.lines(line, written),
            (Curve::Logarithmic(log), written) => self.logarithmic(log, written, tolerance, ideal),
            (Curve::Formula(described), written) => {
                let (machine, radius) = (self.machine, self.radius);
                let mut found = self.curve(&curve::Asked { curve, machine, radius, tolerance }, written)?;
                let more = self.stand_in(&described.bound);
                found.deviation.mm += more.mm;
                found.deviation.rad += more.rad;
                Ok(found)
            }
            (Curve::Lines(_) | Curve::Polynomial(_) | Curve::Nurbs(_) | Curve::Through(..), written) => {
                let (machine, radius) = (self.machine, self.radius);
                self.curve(&curve::Asked { curve, machine, radius, tolerance }, written)
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
        let axes = self.decimals.program.axes;
        let linear = |i: &usize| axes.kind(*i) == Kind::Linear;
        let (mut from, mut length) = (asked.start, 0.0);
        for to in asked.points() {
            length += (0..asked.stride)
                .filter(linear)
                .map(|i| (to[i] - from[i]) * (to[i] - from[i]))
                .sum::<f64>()
                .sqrt();
            from = to;
        }
        let count = asked.count();
        self.leave(points);
        Ok(Found {
            deviation: Bound { mm: worst, rad: 0.0 },
            status: Status::Proved,
            from_ideal: None,
            path_blocks: count,
            cutting_length: length,
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

/// The length of a piece in the linear axes, mm, by Simpson's rule on eight parts.
pub fn length(piece: &Bezier, axes: &Axes) -> f64 {
    let speed = |t: f64| {
        let [_, d, _] = piece.derivatives(t);
        let linear = (0..axes.count()).filter(|i| axes.kind(*i) == Kind::Linear);
        linear.map(|i| d[i] * d[i]).sum::<f64>().sqrt()
    };
    let parts = if piece.degree == 1 { 1 } else { 8 };
    let h = 1.0 / f64::from(parts);
    let part = |k: u32| {
        let t = f64::from(k) * h;
        speed(t) + 4.0 * speed(t + 0.5 * h) + speed(t + h)
    };
    (0..parts).map(part).sum::<f64>() * h / 6.0
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

/// The B-spline that decimals mean.
///
/// # Errors
/// See [`NurbsError`].
pub fn to_nurbs(decimals: &Decimals, nurbs: &crate::ir::WrittenNurbs) -> Result<Nurbs, NurbsError> {
    // Only ratios of knots count, so they are taken in units of their last decimal: whole numbers, which a float holds and
    // subtracts exactly up to 2⁵³. A difference of decimals that were divided first would not be exact.
    let first = nurbs.knots.first().copied().unwrap_or(0);
    let exact = |t: &i64| t.checked_sub(first).filter(|t| *t < 1 << 53).map_or(f64::NAN, |t| t as f64);
    let knots = nurbs.knots.iter().map(exact).collect();
    let points: Vec<Position> = nurbs.points.iter().map(|units| decimals.position(units)).collect();
    let weights = match &nurbs.weights {
        None => vec![1.0; points.len()],
        Some(weights) => weights.iter().map(|w| w.to_f64()).collect(),
    };
    Nurbs::new(nurbs.degree, knots, points, weights)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::{Program, WrittenNurbs};
    use crate::units::MAX_AXES;

    #[test]
    fn small_spans_behind_a_large_one_stay_exact() {
        // PL = 3000000000, then three of 0.000001: in units of the last decimal 3·10¹⁵ and 1.
        let far = 3_000_000_000_000_000;
        let knots = vec![0, 0, 0, 0, far, far + 1, far + 2, far + 3, far + 3, far + 3, far + 3];
        let nurbs = WrittenNurbs {
            degree: 3,
            knots,
            knot_digits: 6,
            points: (0..7).map(|i| [i, 0, 0, 0, 0, 0]).collect(),
            weights: None,
            lines: Vec::new(),
        };
        let program = Program { name: String::new(), axes: Axes::xyza(), steps: Vec::new() };
        let decimals = Decimals { program, digits: [6; MAX_AXES] };
        let spline = to_nurbs(&decimals, &nurbs).unwrap();
        let lengths: Vec<f64> = spline.beziers().map(|(_, length)| length).collect();
        assert_eq!(lengths, [far as f64, 1.0, 1.0, 1.0]);
        let beyond = WrittenNurbs { knots: nurbs.knots.iter().map(|t| t * 10).collect(), ..nurbs };
        assert!(to_nurbs(&decimals, &beyond).is_err(), "a float cannot subtract these");
    }
}
