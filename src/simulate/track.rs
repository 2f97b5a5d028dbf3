//! A program as pieces to run: which curve, at which feed, counted how, said where.
//!
//! A *run* is a chain of pieces that join end to start and that F counts in the same axes; between two runs the axes
//! stand. A rapid, a tool call, a start elsewhere ends a run; a remark does not.
//!
//! | | the feed counts |
//! |---|---|
//! | an input | the linear axes, of a cutter's path what its feed is said to be along |
//! | a program, `rotary = "free"` | the linear axes |
//! | `rotary = "degrees-as-mm"` | all axes, a degree as a millimetre |
//! | `rotary = "surface"` | all axes, rotary ones at the cutter's greatest radius |
//! | `rotary = "inverse-time"` | time, where a block has its own |
//! | a piece that moves none of these | the rotary axes, in degrees/min |
//!
//! The chord error of a cutter's path counts A at the cutter's greatest radius, of a job with a radius at that; of other
//! paths it counts what F does.

use super::partition::{Parametric, Piece, Weights};
use super::shape::{Shape, Way};
use crate::decimal::Decimal;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::geom::arc::Arc;
use crate::geom::bezier::Bezier;
use crate::geom::logcurve::Measure;
use crate::geom::rotation::Rotation;
use crate::ir::{
    Auxiliary, Curve, Cut, Decimals, Described, Logarithmic, Method, Polyline, Program, Step, Written,
    WrittenPoints,
};
use crate::machine::{Machine, RotaryFeed};
use crate::pass::settle;
use crate::source::{LineColumn, Sources, Span};
use crate::units::{Axes, DEGREES, Kind, MAX_AXES, Position};
use crate::verify::{to_arc, to_nurbs};
use std::ops::Range;

/// Where a piece was said.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// The step's text.
    pub span: Span,
    /// The line of the block, from 1; 0 where the step as a whole is meant.
    pub line: u32,
}

/// One thing that the machine does.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// It runs these pieces without a stop.
    Run(Range<usize>),
    /// It moves axes at rapid: each by how far, where that is known.
    Rapid(Vec<(usize, Option<f64>)>),
    /// It waits, s.
    Dwell(f64),
}

/// What a feed counts: how much a mm of each linear axis and a degree of each rotary one.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Counted {
    /// The linear axes, and a degree as so many millimetres.
    Path(f64),
    /// The first axis alone.
    First,
    /// The rotary axes alone.
    Degrees,
}

/// A program as pieces to run.
#[derive(Clone, Debug)]
pub struct Track {
    /// The coordinates.
    pub axes: Axes,
    /// What happens, in order.
    pub events: Vec<Event>,
    /// All pieces.
    pub pieces: Vec<Piece<Shape>>,
    /// Where each piece was said.
    pub places: Vec<Place>,
    /// The points that the control leads a spline of its own through were joined by lines.
    pub through: bool,
    /// F counts rotary axes at a radius that is not known; a degree counted as a millimetre.
    pub radius_unknown: bool,
    /// Control polygons, where they are asked for.
    pub polygons: Vec<Vec<Position>>,
}

/// How a program is to be run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Setting<'m> {
    /// What F counts in a program.
    pub machine: Option<&'m Machine>,
    /// mm/min, instead of every feed of the program.
    pub feed: Option<f64>,
    /// mm, for odd-even steps whose Δl the input leaves open.
    pub tolerance: f64,
    /// The radius at which rotary axes count in chord errors, mm, where the input states one.
    pub radius: Option<f64>,
    /// Whether control polygons are kept.
    pub polygons: bool,
}

impl Track {
    /// The track of what was asked.
    ///
    /// # Errors
    /// A path has no feed, or steps cannot be made.
    pub fn of_program(program: &Program<f64, Curve>, setting: &Setting) -> Result<Track, Diagnostics> {
        let mut builder = Builder::new(program.axes, *setting);
        for located in &program.steps {
            builder.place = Place { span: located.span, line: 0 };
            match &located.step {
                Step::Cut(Cut { feed, curve, .. }) => {
                    builder.feed(*feed)?;
                    builder.curve(curve)?;
                }
                Step::Rapid(targets) => builder.rapid(targets.iter().copied()),
                Step::Home(axis) => builder.home(*axis),
                Step::Auxiliary(Auxiliary::Dwell(seconds)) => builder.dwell(*seconds),
                Step::Auxiliary(Auxiliary::Plane(angles)) => builder.plane(Some(*angles)),
                Step::Auxiliary(Auxiliary::PlaneEnd) => builder.plane(None),
                Step::Tool(_) | Step::Spindle(_) | Step::Coolant | Step::Auxiliary(_) => builder.stand(),
                Step::Comment(_) | Step::Shift(_) => {}
            }
        }
        builder.finish()
    }

    /// The track of a program as a control reads it.
    ///
    /// # Errors
    /// A path has no feed.
    pub fn of_decimals(decimals: &Decimals, setting: &Setting) -> Result<Track, Diagnostics> {
        let mut builder = Builder::new(decimals.program.axes, *setting);
        builder.counted = builder.counted_by_machine();
        for located in &decimals.program.steps {
            builder.place = Place { span: located.span, line: 0 };
            match &located.step {
                Step::Cut(Cut { feed, curve, .. }) => {
                    let timed = matches!(curve, Written::Lines(points) if !points.rates.is_empty());
                    // Under inverse time every line has its own F.
                    if feed.is_some() || setting.feed.is_some() || !timed {
                        builder.feed(feed.map(Decimal::to_f64))?;
                    }
                    builder.written(decimals, curve)?;
                }
                Step::Rapid(targets) => builder.rapid(targets.iter().map(|(axis, to)| (*axis, to.to_f64()))),
                Step::Home(axis) => builder.home(*axis),
                Step::Auxiliary(Auxiliary::Dwell(seconds)) => builder.dwell(seconds.to_f64()),
                Step::Auxiliary(Auxiliary::Plane(angles)) => builder.plane(Some(angles.map(Decimal::to_f64))),
                Step::Auxiliary(Auxiliary::PlaneEnd) => builder.plane(None),
                Step::Tool(_) | Step::Spindle(_) | Step::Coolant | Step::Auxiliary(_) => builder.stand(),
                Step::Comment(_) | Step::Shift(_) => {}
            }
        }
        builder.finish()
    }
}

impl Track {
    /// Finds the line of every place that has none yet.
    pub fn find_lines(&mut self, sources: &Sources) {
        let mut known: Option<(Span, u32)> = None;
        for place in self.places.iter_mut().filter(|place| place.line == 0) {
            let line = match known {
                Some((span, line)) if span == place.span => line,
                _ => sources
                    .get(place.span.source)
                    .map_or(0, |source| LineColumn::of(&source.text, place.span.start as usize).line as u32),
            };
            known = Some((place.span, line));
            place.line = line;
        }
    }
}

struct Builder<'m> {
    track: Track,
    setting: Setting<'m>,
    place: Place,
    /// mm/s.
    feed: f64,
    /// What that is a speed of.
    counted: Counted,
    position: [Option<f64>; MAX_AXES],
    /// The plane in which places count, where one is tilted.
    plane: Option<Rotation>,
    /// The first piece of the run that is open.
    open: usize,
}

impl<'m> Builder<'m> {
    fn new(axes: Axes, setting: Setting<'m>) -> Builder<'m> {
        let track = Track {
            axes,
            events: Vec::new(),
            pieces: Vec::new(),
            places: Vec::new(),
            through: false,
            radius_unknown: false,
            polygons: Vec::new(),
        };
        let place = Place { span: Span::new(crate::source::SourceId::INPUT, 0..0), line: 0 };
        Builder {
            track,
            setting,
            place,
            feed: 0.0,
            counted: Counted::Path(0.0),
            position: [None; MAX_AXES],
            plane: None,
            open: 0,
        }
    }

    fn finish(mut self) -> Result<Track, Diagnostics> {
        self.stand();
        if self.track.pieces.is_empty() {
            return Err(Diagnostic::error("path-missing", "there is no path at feed to simulate").into());
        }
        Ok(self.track)
    }

    /// The axes come to a stand.
    fn stand(&mut self) {
        let end = self.track.pieces.len();
        if self.open < end {
            self.track.events.push(Event::Run(self.open..end));
        }
        self.open = end;
    }

    fn feed(&mut self, own: Option<f64>) -> Result<(), Diagnostics> {
        match self.setting.feed.or(own) {
            Some(feed) if 0.0 < feed && feed.is_finite() => {
                self.feed = feed / 60.0;
                Ok(())
            }
            Some(_) => Err(Diagnostic::error("feed-range", "the feed must be greater than zero")
                .at(self.place.span, "")
                .into()),
            None => Err(Diagnostic::error("feed-missing", "this path has no feed")
                .at(self.place.span, "")
                .hint("say one: --feed 200")
                .into()),
        }
    }

    /// An axis goes to its clear position, which nobody knows in the coordinates of the work.
    fn home(&mut self, axis: usize) {
        self.stand();
        self.position[axis] = None;
        self.track.events.push(Event::Rapid(vec![(axis, None)]));
    }

    /// Places count in another plane: where the axes are in it nobody knows.
    fn plane(&mut self, angles: Option<[f64; 3]>) {
        self.stand();
        self.position = [None; MAX_AXES];
        let order = self.setting.machine.map(|machine| machine.orientation.plane_order);
        self.plane = order.zip(angles).map(|(order, angles)| Rotation::of(order, angles));
    }

    /// A place of a tilted plane in the coordinates of the work.
    fn in_work(&self, p: &Position) -> Position {
        let Some(plane) = &self.plane else { return *p };
        let [x, y, z] = plane.out([p[0], p[1], p[2]]);
        let mut place = *p;
        (place[0], place[1], place[2]) = (x, y, z);
        place
    }

    fn dwell(&mut self, seconds: f64) {
        self.stand();
        self.track.events.push(Event::Dwell(seconds));
    }

    fn rapid(&mut self, targets: impl Iterator<Item = (usize, f64)>) {
        self.stand();
        let mut moves = Vec::new();
        for (axis, to) in targets {
            moves.push((axis, self.position[axis].map(|from| (to - from).abs())));
            self.position[axis] = Some(to);
        }
        self.track.events.push(Event::Rapid(moves));
    }

    /// What F counts on the machine.
    fn counted_by_machine(&mut self) -> Counted {
        match self.setting.machine.map(|machine| machine.rotary_feed) {
            None | Some(RotaryFeed::Free | RotaryFeed::InverseTime) => Counted::Path(0.0),
            Some(RotaryFeed::DegreesAsMm) => Counted::Path(1.0),
            Some(RotaryFeed::Surface) => {
                self.track.radius_unknown = self.setting.radius.is_none();
                Counted::Path(self.setting.radius.unwrap_or(DEGREES) / DEGREES)
            }
        }
    }

    /// What F counts on a piece that moves by `reach` in each axis.
    fn counts(&self, reach: &Position) -> Weights {
        let (linear, degree) = match self.counted {
            Counted::Path(degree) => (1.0, degree),
            Counted::First => (0.0, 0.0),
            Counted::Degrees => (0.0, 1.0),
        };
        let mut own = [0.0; MAX_AXES];
        let mut rest = [0.0; MAX_AXES];
        for (i, (_, kind)) in self.track.axes.as_slice().iter().enumerate() {
            match kind {
                Kind::Linear => own[i] = linear,
                Kind::Rotary => (own[i], rest[i]) = (degree, 1.0),
                Kind::Direction => {}
            }
        }
        if self.counted == Counted::First {
            own[0] = 1.0;
        }
        let moves = (0..MAX_AXES).any(|i| own[i] != 0.0 && reach[i] != 0.0);
        Weights(if moves { own } else { rest })
    }

    /// Adds a piece; `reach` is how far each axis goes on it, `radius` that of a cutter, mm.
    fn piece(&mut self, curve: Shape, reach: &Position, radius: Option<f64>, line: u32) {
        if reach.iter().all(|x| *x == 0.0) {
            return;
        }
        let counts = self.counts(reach);
        let mut surface = counts;
        if let Some(radius) = radius.or(self.setting.radius) {
            for (i, (_, kind)) in self.track.axes.as_slice().iter().enumerate() {
                if *kind == Kind::Rotary {
                    surface.0[i] = radius / DEGREES;
                }
            }
        }
        let (from, to) = curve.range();
        let start = curve.at(from);
        let joins = (0..self.track.axes.count()).all(|i| {
            // A joint is met to within the roundings of an evaluation.
            self.position[i].is_some_and(|at| (at - start[i]).abs() <= 1e-9 * (1.0 + start[i].abs()))
        });
        let same = self.track.pieces.last().is_some_and(|last| last.counts == counts);
        if !(joins && same) {
            self.stand();
        }
        let end = curve.at(to);
        for i in 0..self.track.axes.count() {
            self.position[i] = Some(end[i]);
        }
        self.track.pieces.push(Piece { curve, from, to, feed: self.feed, counts, surface });
        self.track.places.push(Place { line, ..self.place });
    }

    fn line(&mut self, from: &Position, to: &Position, line: u32) {
        let (from, to) = (self.in_work(from), self.in_work(to));
        let reach = std::array::from_fn(|i| to[i] - from[i]);
        self.piece(Shape::line(from, to), &reach, None, line);
    }

    fn lines(&mut self, polyline: &Polyline) {
        let mut from = polyline.start;
        for point in polyline.points() {
            self.line(&from, &point, 0);
            from = point;
        }
    }

    fn bezier(&mut self, piece: &Bezier, line: u32) {
        let piece = piece.mapped(|point| self.in_work(point));
        let points = piece.control_points();
        let reach =
            std::array::from_fn(|i| points.iter().map(|p| (p[i] - points[0][i]).abs()).fold(0.0, f64::max));
        self.piece(Shape::bezier(&piece), &reach, None, line);
    }

    fn polygon(&mut self, points: &[Position]) {
        if self.setting.polygons {
            let points = points.iter().map(|point| self.in_work(point)).collect();
            self.track.polygons.push(points);
        }
    }

    fn arc(&mut self, arc: &Arc, line: u32) {
        let arc = self.plane.map_or(*arc, |plane| arc.turned(&plane, 0.0));
        let (low, high) = arc.range();
        self.piece(Shape::Arc(Box::new(arc)), &std::array::from_fn(|i| high[i] - low[i]), None, line);
    }

    fn curve(&mut self, curve: &Curve) -> Result<(), Diagnostics> {
        match curve {
            Curve::Arc(arc) => self.arc(arc, 0),
            Curve::Lines(polyline) => self.lines(polyline),
            Curve::Through(_, polyline) => {
                self.track.through = true;
                self.lines(polyline);
            }
            Curve::Polynomial(pieces) => {
                for piece in pieces {
                    self.polygon(piece.control_points());
                    self.bezier(piece, 0);
                }
            }
            Curve::Nurbs(nurbs) => {
                self.polygon(nurbs.points());
                nurbs.beziers().for_each(|(piece, _)| self.bezier(&piece, 0));
            }
            Curve::Formula(Described { formula, pieces, .. }) => {
                let start = formula.at(formula.range().0);
                let points = || pieces.iter().flat_map(Bezier::control_points);
                let reach =
                    std::array::from_fn(|i| points().map(|p| (p[i] - start[i]).abs()).fold(0.0, f64::max));
                self.piece(Shape::Formula(formula.clone()), &reach, None, 0);
            }
            Curve::Logarithmic(log) => self.logarithmic(log)?,
        }
        Ok(())
    }

    /// The curve itself, or its odd-even steps where these were asked for.
    fn logarithmic(&mut self, log: &Logarithmic) -> Result<(), Diagnostics> {
        let radius = Some(log.curve.max_radius());
        let before = std::mem::replace(
            &mut self.counted,
            match log.along {
                Measure::Path => Counted::Path(0.0),
                Measure::PathAndDegrees => Counted::Path(1.0),
                Measure::Edge => Counted::Path(log.curve.max_radius() / DEGREES),
                Measure::X => Counted::First,
                Measure::A => Counted::Degrees,
            },
        );
        match log.method {
            Method::Auto | Method::Direct => {
                let (from, to) = (log.curve.position(log.curve.start()), log.curve.position(log.curve.end()));
                let reach = std::array::from_fn(|i| to[i] - from[i]);
                let way = if log.back { Way::Back } else { Way::Forth };
                self.piece(Shape::Logarithmic(Box::new(log.curve), way), &reach, radius, 0);
            }
            Method::OddEven => {
                let refused =
                    |error: &dyn std::fmt::Display| Diagnostic::refusal("points-too-many", error.to_string());
                let dl = match log.dl {
                    Some(dl) => dl,
                    None => settle::step(log, self.setting.tolerance)
                        .map_err(|error| refused(&error).at(self.place.span, ""))?,
                };
                let steps = settle::steps(&Logarithmic { dl: Some(dl), ..log.clone() })
                    .map_err(|error| refused(&error).at(self.place.span, ""))?;
                let mut points = vec![log.curve.position(log.curve.start())];
                points.extend(steps.map(|(x, a)| log.curve.position_with(x, a)));
                if log.back {
                    points.reverse();
                }
                for pair in points.windows(2) {
                    let [from, to] = [pair[0], pair[1]];
                    let reach = std::array::from_fn(|i| to[i] - from[i]);
                    self.piece(Shape::line(from, to), &reach, radius, 0);
                }
            }
        }
        self.counted = before;
        Ok(())
    }

    fn written(&mut self, decimals: &Decimals, curve: &Written) -> Result<(), Diagnostics> {
        match curve {
            Written::Lines(points) => self.written_lines(decimals, points)?,
            Written::Arc(written) => {
                // A reader lets no unsound arc through.
                if let Some(arc) = to_arc(decimals, written) {
                    self.arc(&arc, written.line);
                }
            }
            Written::Through(_, points) => {
                self.track.through = true;
                self.written_lines(decimals, points)?;
            }
            Written::Polynomial(polynomial) => {
                let mut start = polynomial.start;
                for block in &polynomial.blocks {
                    let piece = block.to_bezier(&decimals.digits, &start);
                    self.polygon(piece.control_points());
                    self.bezier(&piece, block.line);
                    start = block.end;
                }
            }
            Written::Nurbs(nurbs) => {
                // A reader lets no unsound spline through.
                if let Ok(spline) = to_nurbs(decimals, nurbs) {
                    self.polygon(spline.points());
                    for (i, (piece, _)) in spline.beziers().enumerate() {
                        // Span i ends with the block of control point i + 1; the last spans close with the last block.
                        let line = nurbs.lines.get(i + 1).or(nurbs.lines.last()).copied().unwrap_or(0);
                        self.bezier(&piece, line);
                    }
                }
            }
        }
        Ok(())
    }

    fn written_lines(&mut self, decimals: &Decimals, points: &WrittenPoints) -> Result<(), Diagnostics> {
        let mut from = decimals.position(&points.start);
        for (i, point) in points.points().enumerate() {
            let to = decimals.position(&point);
            if let Some(rate) = points.rates.get(i).filter(|_| self.setting.feed.is_none()) {
                // F times a minute is the whole way.
                let by = std::array::from_fn(|i| to[i] - from[i]);
                let length = self.counts(&by).norm(&by);
                if 0.0 < length {
                    self.feed(Some(rate.to_f64() * length))?;
                }
            }
            self.line(&from, &to, points.lines.get(i).copied().unwrap_or(0));
            from = to;
        }
        Ok(())
    }
}
