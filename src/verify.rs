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
//! | an arc | arcs, or lines | by its implicit form or its three places, φ the angle | proved |
//! | either | the control's own spline through points | the points only | points-only |
//! | lines | lines | point by point | proved |
//! | any other curve | lines, polynomial blocks, B-splines | at equal parameters, or by a rising map of its own | proved |
//!
//! Beside that, whatever the tolerance: every path starts where a block has brought the tool (`reached`), no cut becomes a
//! point or a point a cut (`lengths`), and the remarks at which an operator restarts stand where they were asked
//! (`sections`).
//!
//! Where a path starts late or ends early by some rounding, the rest of the curve is missed by no more than that times
//! the curve's own speed, which is added to the bound.
//!
//! What the control adds (G642, COMPCAD, cycle 32, G61.1) is not covered.

mod arcs;
mod curve;
mod form;
mod lengths;
mod lines;
mod logarithmic;
mod reached;
mod report;
mod sections;
mod splined;

pub use arcs::{spelled_auxiliary, to_arc};

use crate::decimal::{Decimal, Origin, round_units};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::dialect::Reading;
use crate::geom::bezier::Bezier;
use crate::geom::deviation::Bound;
use crate::geom::follow::Map;
use crate::geom::nurbs::{Nurbs, NurbsError};
use crate::ir::{
    Curve, Cut, Decimals, Intent, Located, Logarithmic, Role, Shift, Step, Units, Written, WrittenPoints,
};
use crate::machine::Machine;
use crate::pass::stretch::{amount, of_curve};
use crate::setup::Setup;
use crate::source::{SourceId, Span};
use crate::units::{Axes, DEGREES, MAX_AXES, Position};

use reached::Unreached;
use sections::Sections;

pub use form::same_form;
pub(crate) use lengths::contours;
pub use report::{Report, Status};
pub use splined::Splined;

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
        deviation: Bound { rad: intent.tilt_error.rad, ..Bound::ZERO },
        status: Status::Proved,
        from_ideal: None,
        map: None,
        path_blocks: 0,
        blocks: Vec::with_capacity(intent.program.steps.len()),
        splined: None,
        cutting_length: 0.0,
        minutes: 0.0,
        feed_error: 0.0,
        rests: 0,
        setup: Setup::default(),
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
    if machine.has_name() && decimals.program.name != intent.program.name {
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
    if decimals.program.number != intent.program.number && machine.has_number() {
        let message =
            format!("the program's number is {}, not {}", decimals.program.number, intent.program.number);
        return Err(Diagnostic::refusal("number-differs", message).into());
    }
    let origin = [Origin::default(); MAX_AXES];
    report.setup = Setup::new(intent, decimals, machine);
    let asked = report.setup.remarks(machine);
    let leading = decimals.setup.get(asked.len()..).unwrap_or_default();
    let radius = intent.radius();
    contours(intent, machine, tolerance)?;
    let mut cursor = Cursor {
        decimals,
        unreached: reached::unreached(decimals),
        sections: Sections::of(intent, machine),
        machine,
        text,
        id,
        at: 0,
        within: 0,
        leading,
        origin,
        radius,
        map: None,
        gap: 0.0,
    };
    let mut ideal = Ideal(None);
    for located in &intent.program.steps {
        report.blocks.push(u32::from(!matches!(located.step, Step::Comment(_))));
        match &located.step {
            Step::Comment(comment) => {
                for line in crate::machine::remark::wrapped(comment, machine) {
                    cursor.section(&line)?;
                }
            }
            Step::Coolant => cursor.meet("the coolant", |step| matches!(step, Step::Coolant))?,
            Step::Home(axis) => {
                let what = format!("{} to its home", intent.program.axes.name(*axis));
                cursor.meet(&what, |step| matches!(step, Step::Home(read) if read == axis))?;
            }
            Step::Shift(shifts) => cursor.shift(shifts)?,
            Step::Tool(call) => {
                cursor.meet(&call.to_string(), |step| matches!(step, Step::Tool(read) if read == call))?;
            }
            Step::Spindle(rpm) => {
                let rounded = Decimal::round(*rpm, machine.digits.feed);
                cursor.meet(
                    &format!("the spindle at {rpm} rev/min"),
                    |step| matches!(step, Step::Spindle(read) if Some(*read) == rounded),
                )?;
            }
            Step::Auxiliary(auxiliary) => cursor.auxiliary(auxiliary, machine.digits)?,
            Step::Rapid(targets) => {
                let origin = cursor.origin;
                let names: Vec<String> = targets
                    .iter()
                    .map(|(axis, to)| format!("{} {to}", intent.program.axes.name(*axis)))
                    .collect();
                cursor.meet(&format!("a rapid to {}", names.join(" ")), |step| {
                    matches!(step, Step::Rapid(read) if read.len() == targets.len()
                    && read.iter().zip(targets).all(|((i, to), (j, asked))| {
                        i == j && origin[*i].round(*asked, decimals.digits[*i]) == to.units(decimals.digits[*i])
                    }))
                })?;
            }
            Step::Cut(Cut { feed, role, curve }) => {
                cursor.skip_remarks()?;
                let (at, within) = (cursor.at, cursor.within);
                let gap = std::mem::take(&mut cursor.gap);
                cursor.begins_where_the_tool_is(curve)?;
                let mut found = cursor
                    .cut(curve, (*feed, *role), tolerance, &mut ideal)
                    .map_err(|refused| of_entity(refused, located.span))?;
                // The path before ends that far from where this one starts; a turn takes it along.
                found.deviation.mm += gap + intent.input_error;
                if let Curve::Arc(_) = curve {
                    found.deviation.mm += intent.tilt_error.mm;
                }
                if cursor.gap != 0.0 {
                    cursor.gap += gap;
                }
                if let Some(diagnostic) = too_far(found.deviation, tolerance, machine, &intent.program.axes) {
                    // Looked up only now: finding a line reads the text.
                    (cursor.at, cursor.within) = (at, within);
                    let diagnostic = match cursor.step() {
                        Some(step) => diagnostic.at(cursor.place(step), ""),
                        None => diagnostic,
                    };
                    return Err(of_entity(diagnostic.into(), located.span));
                }
                report.deviation = report.deviation.max(found.deviation);
                if let Some(run) = found.splined {
                    let all = report.splined.get_or_insert_default();
                    all.add(report.blocks.len().saturating_sub(1), &run);
                }
                report.status = report.status.max(found.status);
                if let Some(last) = report.blocks.last_mut() {
                    *last = u32::try_from(found.path_blocks).unwrap_or(u32::MAX);
                }
                if let Some(from_ideal) = found.from_ideal {
                    report.from_ideal =
                        Some(report.from_ideal.map_or(from_ideal, |known| known.max(from_ideal)));
                }
                report.map = cursor.map;
                report.rests += found.rests;
                if *role != Role::Approach {
                    report.path_blocks += found.path_blocks;
                    report.cutting_length += found.cutting_length;
                    report.minutes += found.minutes;
                    report.feed_error = report.feed_error.max(found.feed_error);
                }
            }
        }
    }
    cursor.skip_remarks()?;
    if let Some(left) = cursor.step() {
        let diagnostic = Diagnostic::refusal("more-than-asked", "the program goes on after what was asked");
        return Err(diagnostic.at(cursor.place(left), "").into());
    }
    if decimals.setup.get(..asked.len()) != Some(&asked[..]) || !cursor.leading.is_empty() {
        let message = "the remarks that say what to set up are not those of this program";
        let wrong = decimals.setup.iter().find(|remark| !asked.contains(remark));
        let start = wrong.and_then(|remark| text.find(remark.as_str()));
        let place = match (start, wrong) {
            (Some(start), Some(remark)) => Span::new(id, start..start + remark.len()),
            _ => decimals.program.steps.first().map_or(Span::new(id, 0..0), |located| located.span),
        };
        return Err(Diagnostic::refusal("setup-differs", message).at(place, "").into());
    }
    Ok(report)
}

/// What is wrong with the path of one entity of the input, which is shown too.
fn of_entity(mut refused: Diagnostics, entity: Span) -> Diagnostics {
    for diagnostic in &mut refused.0 {
        let others = &mut diagnostic.others.get_or_insert_default().0;
        others.push((entity, "requested here".to_owned()));
    }
    refused
}

/// What is said of a path that is too far from what was asked, in places or in the tool's direction.
fn too_far(deviation: Bound, tolerance: f64, machine: &Machine, axes: &Axes) -> Option<Diagnostic> {
    if !(deviation.mm <= tolerance) {
        let message = format!(
            "the program deviates by up to {:.3e} mm, more than the tolerance of {tolerance} mm",
            deviation.mm
        );
        return Some(Diagnostic::refusal("deviation-too-large", message));
    }
    let (angle, allowed) = (deviation.rad * DEGREES, machine.orientation.tolerance);
    (axes.direction().is_some() && !(angle <= allowed)).then(|| {
        let message = format!(
            "the tool is turned by up to {angle:.4} degrees from where it should be, more than {allowed}"
        );
        Diagnostic::refusal("direction-too-far", message)
            .hint("[orientation] tolerance of the machine file says how far it may be")
    })
}

/// Where in the program the comparison stands: a step, and in a run of lines the points already met.
struct Cursor<'p> {
    decimals: &'p Decimals,
    /// Where a cut begins without a block that brought the tool there.
    unreached: Unreached,
    /// The remarks that start a section.
    sections: Sections,
    machine: &'p Machine,
    text: &'p str,
    id: SourceId,
    at: usize,
    within: usize,
    /// Remarks of the program right behind those that say what to set up: nothing in a text tells them apart.
    leading: &'p [String],
    /// Where each axis counts from, which is where it is rounded from.
    origin: [Origin; MAX_AXES],
    /// The radius at which rotary axes count, mm.
    radius: f64,
    /// The map that the bounds hold for so far.
    map: Option<Map>,
    /// How far from its end the last path really ends, mm: a turn by an angle leads to no place in decimals.
    gap: f64,
}

/// What one cut was found to be.
struct Found {
    deviation: Bound,
    status: Status,
    from_ideal: Option<Bound>,
    path_blocks: usize,
    cutting_length: f64,
    minutes: f64,
    feed_error: f64,
    /// How many lines lead to where the tool is already.
    rests: usize,
    splined: Option<splined::Run>,
}

impl Found {
    fn new() -> Found {
        Found {
            deviation: Bound::ZERO,
            status: Status::Proved,
            from_ideal: None,
            path_blocks: 0,
            cutting_length: 0.0,
            minutes: 0.0,
            feed_error: 0.0,
            rests: 0,
            splined: None,
        }
    }
}

type ReadStep = Located<Decimal, Written>;

impl<'p> Cursor<'p> {
    fn step(&self) -> Option<&'p ReadStep> {
        self.decimals.program.steps.get(self.at)
    }

    /// A position in units of an axis' last decimal, rounded as the text counts it.
    #[inline]
    fn units(&self, axis: usize, x: f64) -> Option<i64> {
        self.origin[axis].round(x, self.decimals.digits[axis])
    }

    /// Meets a work offset.
    fn shift(&mut self, asked: &[Shift<f64>]) -> Result<(), Diagnostics> {
        let digits = self.decimals.digits;
        let names: Vec<String> = asked
            .iter()
            .map(|shift| format!("{} {}", self.decimals.program.axes.name(shift.axis), shift.to))
            .collect();
        self.meet(&format!("a work offset of {}", names.join(" ")), |step| {
            let Step::Shift(read) = step else { return false };
            read.len() == asked.len()
                && read.iter().zip(asked).all(|(read, asked)| {
                    (read.axis, read.parameter) == (asked.axis, asked.parameter)
                        && read.to.units(digits[read.axis]) == round_units(asked.to, digits[read.axis])
                })
        })?;
        for shift in asked {
            let units = round_units(shift.to, digits[shift.axis]).unwrap_or_default();
            self.origin[shift.axis] = Origin { at: shift.to, units };
        }
        Ok(())
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
            Step::Cut(_)
            | Step::Comment(_)
            | Step::Tool(_)
            | Step::Spindle(_)
            | Step::Coolant
            | Step::Home(_)
            | Step::Shift(_)
            | Step::Auxiliary(_)
            | Step::Rapid(_) => located.span,
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
        self.skip_remarks()?;
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
        (feed, role): (Option<f64>, Role),
        tolerance: f64,
        ideal: &mut Ideal,
    ) -> Result<Found, Diagnostics> {
        let cut = self.written()?;
        let axes = self.decimals.program.axes;
        let counted = |feed: f64| of_curve(curve, feed, &axes, self.machine, self.radius);
        let (asked, feed_error) = match (curve, feed.filter(|_| role == Role::Path)) {
            (Curve::Logarithmic(_), _) | (_, None) => (feed, 0.0),
            (_, Some(feed)) => (Some(counted(feed).0), counted(feed).1),
        };
        if !matches!(curve, Curve::Logarithmic(_)) {
            self.same_feed(cut.feed, asked)?;
        }
        let (machine, radius) = (self.machine, self.radius);
        let timed = |found: Found| match feed {
            Some(feed) => Found { minutes: amount(curve, &axes, machine, radius) / feed, ..found },
            None => found,
        };
        match (curve, &cut.curve) {
            (Curve::Lines(line), written) if self.is_mixed(line, written) => {
                let found = self.mixed(line, [feed, asked], tolerance)?;
                Ok(Found { feed_error, ..found })
            }
            (Curve::Lines(line), written @ Written::Lines(_)) => self.lines(line, written).map(timed),
            (Curve::Arc(arc), _) => self.arc(arc, tolerance).map(timed),
            (Curve::Logarithmic(log), _) => self.logarithmic(log, feed, tolerance, ideal),
            (Curve::Formula(described), written) => {
                let (machine, radius) = (self.machine, self.radius);
                let feed = cut.feed;
                let mut found =
                    self.curve(&curve::Asked { curve, machine, radius, tolerance, feed }, written)?;
                let more = self.stand_in(&described.bound);
                found.deviation.mm += more.mm;
                found.deviation.rad += more.rad;
                Ok(Found { feed_error, ..found })
            }
            (Curve::Lines(_) | Curve::Polynomial(_) | Curve::Nurbs(_) | Curve::Through(..), written) => {
                let (machine, radius) = (self.machine, self.radius);
                let feed = cut.feed;
                let found = self.curve(&curve::Asked { curve, machine, radius, tolerance, feed }, written)?;
                Ok(Found { feed_error, ..found })
            }
        }
    }

    /// The path that comes next.
    fn written(&self) -> Result<&'p Cut<Decimal, Written>, Diagnostics> {
        match self.step().and_then(|located| located.step.cut()) {
            Some(cut) => Ok(cut),
            None => Err(self.differs("step-differs", "here a path was asked".to_owned())),
        }
    }

    /// Compares F with what it has to be.
    fn same_feed(&self, read: Option<Decimal>, asked: Option<f64>) -> Result<(), Diagnostics> {
        let rounded = asked.map(|asked| Decimal::round(asked, self.machine.digits.feed));
        if rounded == read.map(Some) {
            return Ok(());
        }
        let asked = asked.map_or("none".to_owned(), |feed| feed.to_string());
        Err(self.differs("feed-differs", format!("the feed differs from the {asked} that was asked")))
    }

    /// The next point of a run.
    #[inline]
    fn next_point(&mut self, points: &WrittenPoints) -> Option<Units> {
        let chunk = points.units.get(self.within * points.stride..(self.within + 1) * points.stride)?;
        let mut units = [0; MAX_AXES];
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
            Written::Lines(_) | Written::Arc(_) | Written::Through(..) => Ok(Vec::new()),
        }
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
    use crate::units::{Axes, MAX_AXES};

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
        let program = Program { name: String::new(), number: 0, axes: Axes::xyza(), steps: Vec::new() };
        let decimals =
            Decimals { program, digits: [6; MAX_AXES], unnamed: [false; MAX_AXES], setup: Vec::new() };
        let spline = to_nurbs(&decimals, &nurbs).unwrap();
        let lengths: Vec<f64> = spline.beziers().map(|(_, length)| length).collect();
        assert_eq!(lengths, [far as f64, 1.0, 1.0, 1.0]);
        let beyond = WrittenNurbs { knots: nurbs.knots.iter().map(|t| t * 10).collect(), ..nurbs };
        assert!(to_nurbs(&decimals, &beyond).is_err(), "a float cannot subtract these");
    }
}
