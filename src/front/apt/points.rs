//! Points on an arc before its end, as Creo writes them.
//!
//! ```text
//! GOTO / 30.0, 0.0, 0.0                 the start
//! CIRCLE / 30.0, 10.0, 0.0, 0.0, 0.0, 1.0, 10.0
//! GOTO / 37.071068, 2.928932, 0.0       on the arc
//! GOTO / 40.0, 10.0, 0.0                its end: the last one
//! ```
//!
//! PTC's help ("CL Output for Circular Interpolation") says that the points behind a CIRCLE are on the arc and that the last
//! one is its end, and it does not say what tells a straight move behind it from one more of them. So a point is of the
//! arc where it is on the circle, goes on in its sense by at most half a turn and up to a whole one in all, and rises with
//! it. A line that happens to do all of this, such as the one that closes a half moon, looks the same, and real files have
//! such lines.
//!
//! How many points an arc has is a parameter of an operation: at least so many, or as many as hold a tolerance. So an
//! operation in which one arc has its end alone, far from its chord, writes none before the end of any other. That is
//! looked for before the file is read; where no arc says it, points so dense that lines would do are of the arc, and others
//! are refused.

use super::arcs::{Circle, FULL_CHORD, MISFIT_REFUSED};
use super::motion::Pending;
use super::reader::Reader;
use super::records::{Kind, Records};
use super::statement::{self, Goto};
use super::technology::unit_scale;
use super::words::{ArcPoints, Meaning, Words};
use crate::diagnostic::Diagnostic;
use crate::geom::arc::{Frame, Sense};
use crate::geom::elementary;
use crate::source::Span;
use std::f64::consts::{PI, TAU};

/// Half a turn, and what rounding adds to it, radians: no arc needs fewer points, where it has them.
const HALF: f64 = PI + 1.0e-6;

/// How far rounding brings a point from its circle, mm: that of three decimals and more.
const ROUNDED: f64 = 0.001;

/// What to state where a file does not say which of its points are on arcs.
const HINT: &str = "circle_points = \"end\" in a table for --words ends every circle at its first point, \"along\" takes those that lie on it";

/// A circle from its start, as far as points follow it.
#[derive(Clone, Debug)]
pub(super) struct Ring {
    frame: Frame,
    sense: Sense,
    /// u and v, mm.
    center: [f64; 2],
    /// mm, that of the start.
    radius: f64,
    /// u and v of the last point beside the centre, mm.
    last: [f64; 2],
    /// w of the start, mm.
    base: f64,
    /// What was turned up to each point, radians, and what it rose, mm.
    places: Vec<(f64, f64)>,
    /// The greatest step, radians.
    widest: f64,
    /// How far the chord of a step behind the first is from the arc, at most, mm.
    sagitta: f64,
}

/// From one point on a circle to the next.
struct Step {
    /// radians
    turn: f64,
    last: [f64; 2],
    rise: f64,
    /// How far the point is from the circle, mm.
    beside: f64,
}

/// An arc whose points are being read.
#[derive(Clone, Debug)]
pub(super) struct Points {
    circle: Circle,
    ring: Ring,
    end: [f64; 3],
    /// Of the last point.
    span: Span,
    /// Whether its points were listed in one statement, so that the last one is beyond doubt.
    listed: bool,
}

impl Ring {
    fn new(circle: &Circle, start: [f64; 3]) -> Ring {
        let ([u, v, _], [su, sv, base]) = (circle.frame.local(circle.center), circle.frame.local(start));
        let last = [su - u, sv - v];
        let radius = (last[0] * last[0] + last[1] * last[1]).sqrt();
        let (frame, sense) = (circle.frame, circle.sense);
        let places = Vec::new();
        Ring { frame, sense, center: [u, v], radius, last, base, places, widest: 0.0, sagitta: 0.0 }
    }

    /// The step to a point that goes on along the circle, up to a whole turn in all.
    fn step(&self, point: [f64; 3]) -> Option<Step> {
        let [u, v, w] = self.frame.local(point);
        let ([x, y], [x0, y0]) = ([u - self.center[0], v - self.center[1]], self.last);
        let beside = ((x * x + y * y).sqrt() - self.radius).abs();
        if !beside.le(&MISFIT_REFUSED) {
            return None;
        }
        let (turned, risen) = self.places.last().copied().unwrap_or((0.0, 0.0));
        let rise = w - self.base;
        let chord = ((x - x0) * (x - x0) + (y - y0) * (y - y0)).sqrt();
        let turn = if chord < FULL_CHORD {
            // Behind a point straight up or down; from the start round once.
            if turned == 0.0 { TAU } else { return None }
        } else {
            let forward = match self.sense {
                Sense::CounterClockwise => x0 * y - y0 * x,
                Sense::Clockwise => y0 * x - x0 * y,
            };
            let turn = elementary::atan2(forward, x0 * x + y0 * y);
            if turn <= 0.0 { turn + TAU } else { turn }
        };
        if TAU + FULL_CHORD / self.radius < turned + turn {
            return None;
        }
        // As it rose up to here.
        if turned != 0.0 && MISFIT_REFUSED < (rise - risen * ((turned + turn) / turned)).abs() {
            return None;
        }
        Some(Step { turn, last: [x, y], rise, beside })
    }

    /// How far the chord of a step is from the arc, mm.
    fn sagitta(&self, turn: f64) -> f64 {
        self.radius * (1.0 - elementary::cos(0.5 * turn))
    }

    fn take(&mut self, step: &Step) {
        let (turned, _) = self.places.last().copied().unwrap_or((0.0, 0.0));
        if turned != 0.0 {
            self.sagitta = self.sagitta.max(self.sagitta(step.turn));
        }
        self.widest = self.widest.max(step.turn);
        self.places.push((turned + step.turn, step.rise));
        self.last = step.last;
    }

    /// The step to a point that may be one more of the arc.
    fn goes_on(&self, point: [f64; 3]) -> Option<Step> {
        self.step(point).filter(|step| step.turn <= HALF && self.widest <= HALF)
    }

    /// Whether its end is its only point, and far from its chord. Round once, or along a helix, an arc has one point in
    /// PTC's own samples, whatever others have.
    fn is_single(&self) -> bool {
        let &[(turned, rise)] = &self.places[..] else { return false };
        turned <= HALF && rise.abs() < MISFIT_REFUSED && MISFIT_REFUSED < self.sagitta(turned)
    }

    /// Whether lines instead of its points would be another path.
    fn matters(&self) -> bool {
        MISFIT_REFUSED < self.sagitta
    }

    /// What is turned in all, radians.
    fn turned(&self) -> f64 {
        self.places.last().map_or(0.0, |(turned, _)| *turned)
    }

    /// How far a point is from rising evenly, at most, mm.
    fn uneven(&self) -> f64 {
        let (whole, top) = self.places.last().copied().unwrap_or((1.0, 0.0));
        self.places.iter().map(|(turned, rise)| (rise - top * (turned / whole)).abs()).fold(0.0, f64::max)
    }
}

/// The numbers of a line that has nothing else, and how many they are.
fn listed(text: &str) -> Option<Goto> {
    let first = text.as_bytes().first()?;
    let begins = first.is_ascii_digit() || matches!(first, b'+' | b'-' | b'.');
    begins.then(|| statement::goto(&format!("GOTO/{text}"))).flatten()
}

impl Reader<'_> {
    /// What the points behind a circle are.
    fn reading(&self, circle: &Circle) -> Reading {
        match self.words.points {
            ArcPoints::End => Reading::End,
            ArcPoints::Along => Reading::Along,
            ArcPoints::Unsure => Reading::Unsure,
            ArcPoints::Likely => self.survey.reading(circle.span.start as usize),
        }
    }

    /// The first point behind a circle.
    pub(super) fn circle_meets(&mut self, circle: Circle, point: [f64; 3], span: Span) {
        let start = self
            .program
            .position
            .filter(|_| circle.sweep.is_none() && circle.by_axis.is_some() && circle.turns == 0);
        let mut ring = start.map(|start| Ring::new(&circle, start));
        let step = ring.as_ref().and_then(|ring| ring.step(point));
        let (Some(mut ring), Some(step)) = (ring.take(), step) else {
            return self.arc_to(&circle, point, span);
        };
        ring.take(&step);
        let reading = self.reading(&circle);
        let points = Points { circle, ring, end: point, span, listed: false };
        match reading {
            Reading::End => self.arc_to(&points.circle, point, span),
            Reading::Unsure => self.end_points(points),
            Reading::Alone | Reading::Along | Reading::Likely | Reading::Mixed => {
                self.pending = Some(Pending::Points(points));
            }
        }
    }

    /// One more point behind a circle: whether it is of the arc. Where it is not, the arc is over.
    pub(super) fn points_meet(&mut self, mut points: Points, point: [f64; 3], span: Span) -> bool {
        let reading = self.reading(&points.circle);
        let alone = points.listed || reading == Reading::Alone;
        // A short line that leaves the circle along its tangent is near it too, and moves nothing where it stays a line.
        let fits = |step: &Step| {
            reading == Reading::Along
                || step.beside <= ROUNDED
                || MISFIT_REFUSED < points.ring.sagitta(step.turn)
        };
        let step = points.ring.goes_on(point).filter(|step| !alone && fits(step));
        let Some(step) = step else {
            self.end_points(points);
            return false;
        };
        points.ring.take(&step);
        (points.end, points.span) = (point, span);
        self.pending = Some(Pending::Points(points));
        true
    }

    /// A line of numbers alone, as PTC's help prints the points of an arc; whether it is one.
    pub(super) fn listed_point(&mut self, text: &str, span: Span) -> bool {
        let Some(listed) = listed(text) else { return false };
        let numbers = listed.numbers();
        let Some(Pending::Points(points)) = &mut self.pending else { return false };
        let (point, turns) = match *numbers {
            [x, y, z] => (Some([x, y, z]), false),
            [x, y, z, i, j, k] => {
                (Some([x, y, z]), !super::motion::is_along(&self.program.axis(), [i, j, k]))
            }
            _ => (None, false),
        };
        let point = point.filter(|_| !turns).map(|point| point.map(|x| x * self.scale));
        match point.and_then(|point| points.ring.step(point)) {
            Some(step) => {
                points.ring.take(&step);
                points.end = point.unwrap_or(points.end);
                (points.span, points.listed) = (span, true);
            }
            None => {
                let message = "this point does not go on along the circle before it";
                self.refuse_arc(Diagnostic::error("arc-points", message).at(span, ""));
            }
        }
        true
    }

    /// The arc is over, where its points were being read.
    pub(super) fn close_arc(&mut self) {
        if matches!(self.pending, Some(Pending::Points(_)))
            && let Some(Pending::Points(points)) = self.pending.take()
        {
            self.end_points(points);
        }
    }

    /// An arc with all of its points.
    fn end_points(&mut self, points: Points) {
        let Points { mut circle, ring, end, span, listed } = points;
        let whole = Span { start: circle.span.start, ..span };
        let reading = self.reading(&circle);
        if 1 < ring.places.len() {
            circle.sweep = Some(ring.turned());
            if MISFIT_REFUSED < ring.uneven() {
                let message = "the points of this arc do not rise evenly with it";
                self.push(Diagnostic::error("arc-points", message).at(whole, ""));
                self.program.position = Some(end);
                return;
            }
            if ring.matters() && !listed {
                self.several(&ring, reading, whole);
            }
        }
        self.arc_to(&circle, end, span);
        if let Some(Pending::Left(left)) = &mut self.pending
            && !listed
        {
            left.ring = Some((ring, reading));
        }
    }

    /// Says that an arc was taken to have points before its end.
    fn several(&mut self, ring: &Ring, reading: Reading, span: Span) {
        let count = ring.places.len();
        match reading {
            Reading::End | Reading::Alone | Reading::Along | Reading::Unsure => {}
            Reading::Likely => {
                let message = format!(
                    "{count} points behind this circle are on it, on its arc or lines behind it: no arc of the file shows which"
                );
                self.push(Diagnostic::error("arc-points", message).at(span, "").hint(HINT));
            }
            Reading::Mixed => {
                let message = format!(
                    "{count} points behind this circle are on it, on its arc or behind it: arcs of another operation have their end alone"
                );
                self.push(Diagnostic::error("arc-points", message).at(span, "").hint(HINT));
            }
        }
    }

    /// A line at feed behind an arc: whether it may have been one more point of it.
    pub(super) fn passes_ring(&mut self, ring: &Ring, reading: Reading, to: [f64; 3], span: Span) {
        let Some(step) = ring.step(to).filter(|step| MISFIT_REFUSED < ring.sagitta(step.turn)) else {
            return;
        };
        if reading == Reading::Along {
            let message = "this point goes on along the arc before it, and something stands between them";
            self.push(
                Diagnostic::error("arc-points", message)
                    .at(span, "")
                    .hint("the points of an arc follow each other: move what stands between them"),
            );
        } else if reading == Reading::Unsure && step.turn.max(ring.widest) <= HALF {
            let message =
                "this point is on the circle before it: the end of that arc, or of a line behind it";
            self.push(Diagnostic::error("arc-points", message).at(span, "").hint(HINT));
        } else {
            let (count, _) = self.votes.lines.get_or_insert((0, span));
            *count += 1;
        }
    }

    /// Lines behind arcs that may have been points of them, told once.
    pub(super) fn lines_on_circles(&mut self) {
        if let Some((count, span)) = self.votes.lines {
            let message = format!(
                "{count} of the lines behind arcs end on the circle of their arc, and are taken for lines"
            );
            self.push(Diagnostic::warning("arc-points", message).at(span, "the first").hint(HINT));
        }
    }
}

/// What the points behind a circle are, in its operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reading {
    /// The first is the end: the system writes no others.
    End,
    /// The first is the end: so it is elsewhere in the operation.
    Alone,
    /// All that go on along the circle are on the arc: so it was stated.
    Along,
    /// The same, and nothing in the file speaks against it.
    Likely,
    /// The same in this operation, and elsewhere in the file not.
    Mixed,
    /// Nobody knows.
    Unsure,
}

/// What the arcs of a file show of their points, by operations.
#[derive(Debug, Default)]
pub(super) struct Survey {
    /// Where each operation begins, and whether an arc of it has its end alone.
    operations: Vec<(usize, bool)>,
}

impl Survey {
    /// Looks at all circles of a text, where its system may write points before their end.
    pub(super) fn of(text: &str, words: &Words, scale: f64) -> Survey {
        let mut survey = Survey { operations: vec![(0, false)] };
        if words.points != ArcPoints::Likely {
            return survey;
        }
        let (mut scale, mut position, mut ring) = (scale, None, None::<Ring>);
        for record in Records::new(text) {
            let numbers = match record.kind {
                Kind::Code => statement::goto(&record.text),
                Kind::Remark | Kind::TooLong => None,
            };
            if let Some(&[x, y, z] | &[x, y, z, ..]) = numbers.as_ref().map(Goto::numbers) {
                let point = [x, y, z].map(|x| x * scale);
                let step = ring.as_ref().and_then(|ring| match ring.places[..] {
                    [] => ring.step(point),
                    _ => ring.goes_on(point),
                });
                match (&mut ring, step) {
                    (Some(ring), Some(step)) => ring.take(&step),
                    (Some(_), None) => survey.settle(ring.take()),
                    (None, _) => {}
                }
                position = Some(point);
                continue;
            }
            if record.kind == Kind::Code
                && let Some(listed) = listed(&record.text)
            {
                // The points of one statement: they say nothing of others.
                let point = listed.numbers().first_chunk().map(|point: &[f64; 3]| point.map(|x| x * scale));
                (ring, position) = (None, point);
                continue;
            }
            survey.settle(ring.take());
            if record.kind == Kind::Remark {
                let word = record.text.trim().strip_prefix("->").map_or("", str::trim_start);
                if word.get(..6).is_some_and(|word| word.eq_ignore_ascii_case("FEATNO")) {
                    survey.operations.push((record.range.start, false));
                }
                continue;
            }
            let Ok(said) = statement::parse(&record.text) else { continue };
            match words.meaning(said.major) {
                Some(Meaning::Units) => {
                    let word = said.arguments.first().and_then(|placed| placed.argument.word());
                    scale = word.and_then(unit_scale).unwrap_or(scale);
                }
                Some(Meaning::Circle) => {
                    let numbers = said.numbers().unwrap_or_default();
                    let span = Span::new(crate::source::SourceId::INPUT, record.range.clone());
                    ring =
                        Circle::from_numbers(&numbers, super::arcs::by_count(&numbers), words, scale, span)
                            .and_then(|circle| Some(Ring::new(&circle, position?)));
                }
                Some(
                    Meaning::From
                    | Meaning::Gohome
                    | Meaning::Godlta
                    | Meaning::Goto
                    | Meaning::Tlon
                    | Meaning::Movarc
                    | Meaning::Movnrb,
                ) => position = None,
                Some(_) | None => {}
            }
        }
        survey.settle(ring);
        survey
    }

    fn settle(&mut self, ring: Option<Ring>) {
        if let (Some(ring), Some((_, alone))) = (ring, self.operations.last_mut()) {
            *alone |= ring.is_single();
        }
    }

    /// What the points behind a circle at `at` are.
    fn reading(&self, at: usize) -> Reading {
        let operation = self.operations.partition_point(|(start, _)| *start <= at);
        if operation.checked_sub(1).and_then(|i| self.operations.get(i)).is_some_and(|(_, alone)| *alone) {
            Reading::Alone
        } else if self.operations.iter().any(|(_, alone)| *alone) {
            Reading::Mixed
        } else {
            Reading::Likely
        }
    }
}
