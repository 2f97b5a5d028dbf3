//! One of two programs, as what it makes the machine do: switches, rapids and paths, in order.
//!
//! A path is all that stands at feed between two other steps, whatever its blocks are: where one post writes lines and
//! another a spline, where F changes on the way, where a block ends, is for the comparison to say.

use crate::decimal::Decimal;
use crate::diagnostic::Diagnostic;
use crate::geom::arc::{Arc, turned};
use crate::geom::bezier::Bezier;
use crate::geom::round;
use crate::ir::{
    ArcBy, Auxiliary, Curve, Cut, Decimals, Intent, Located, Polyline, Program, Shift, Step, ThroughKind,
    Written, WrittenNurbs, WrittenPoints, sweep,
};
use crate::machine::Machine;
use crate::source::{SourceId, Span};
use crate::translate;
use crate::units::{Axes, DEGREES, Kind, MAX_AXES, Position};
use crate::verify::{spelled_auxiliary, to_arc, to_nurbs};

/// A program that was read, or an intent, and what it needs beside it.
pub(super) struct Side<'a> {
    /// The axes that it moves.
    pub(super) axes: Axes,
    /// The machine, where there is one: how it counts F, how it turns between two directions.
    pub(super) machine: Option<&'a Machine>,
    /// The decimals of F, and of each axis of [`Side::axes`]; an intent has numbers as they are.
    pub(super) digits: Option<(u8, [u8; MAX_AXES])>,
    text: &'a str,
    id: SourceId,
    pub(super) items: Vec<Item<'a>>,
}

/// One thing that a program does.
pub(super) enum Item<'a> {
    /// Something that is no move: tool, spindle, coolant, home, dwell, stop; or a work offset that an operator may change.
    Switch(Step<f64, ()>, Span),
    /// A rapid, and where it leads to in each axis, as far as the program says that.
    Rapid([Option<f64>; MAX_AXES], Span),
    /// A path at feed.
    Path(Vec<Part<'a>>),
    /// A spline that only the control knows, and its points.
    Points(ThroughKind, Part<'a>),
}

/// A part of a path: what one cut of the program is.
pub(super) struct Part<'a> {
    pub(super) shape: Shape<'a>,
    pub(super) span: Span,
    /// F, or the speed that was asked.
    pub(super) feed: Option<f64>,
    /// How far the pieces are from what they stand for at most, mm.
    pub(super) slack: f64,
    /// The part's axes in the order of the side's.
    order: Vec<usize>,
}

/// What a part is made of.
pub(super) enum Shape<'a> {
    /// Lines in decimals.
    Units(&'a Decimals, &'a WrittenPoints),
    /// Lines.
    Line(&'a Polyline),
    /// Pieces, and the line of the text of each; none where all stand in one place.
    Pieces(Vec<Bezier>, Vec<u32>),
}

impl Part<'_> {
    /// How many pieces it has.
    pub(super) fn count(&self) -> usize {
        match &self.shape {
            Shape::Units(_, points) => points.count(),
            Shape::Line(line) => line.count(),
            Shape::Pieces(pieces, _) => pieces.len(),
        }
    }

    /// Its pieces, in the order of the axes.
    pub(super) fn pieces(&self) -> Box<dyn Iterator<Item = Bezier> + '_> {
        let placed = |p: &Position| self.placed(p);
        match &self.shape {
            Shape::Units(decimals, points) => {
                let mut from = placed(&decimals.position(&points.start));
                let rest = points.start;
                Box::new(points.points().map(move |units| {
                    // Axes beyond the stride stay where they are.
                    let mut whole = rest;
                    whole[..points.stride].copy_from_slice(&units[..points.stride]);
                    let to = placed(&decimals.position(&whole));
                    Bezier::line(std::mem::replace(&mut from, to), to)
                }))
            }
            Shape::Line(line) => {
                let mut from = placed(&line.start);
                Box::new(line.points().map(move |p| {
                    let to = placed(&p);
                    Bezier::line(std::mem::replace(&mut from, to), to)
                }))
            }
            Shape::Pieces(pieces, _) => Box::new(pieces.iter().map(move |piece| piece.mapped(placed))),
        }
    }

    /// Where it starts and where it ends.
    pub(super) fn ends(&self) -> [Position; 2] {
        let ends = match &self.shape {
            Shape::Units(decimals, points) => {
                let mut end = points.start;
                if let Some(last) = points.units.chunks_exact(points.stride).next_back() {
                    end[..points.stride].copy_from_slice(last);
                }
                [decimals.position(&points.start), decimals.position(&end)]
            }
            Shape::Line(line) => {
                let mut end = line.start;
                if let Some(last) = line.values.chunks_exact(line.stride).next_back() {
                    end[..line.stride].copy_from_slice(last);
                }
                [line.start, end]
            }
            Shape::Pieces(pieces, _) => {
                let end = |piece: Option<&Bezier>, place: fn(&Bezier) -> Position| {
                    piece.map(place).unwrap_or_default()
                };
                [end(pieces.first(), Bezier::start), end(pieces.last(), Bezier::end)]
            }
        };
        ends.map(|p| self.placed(&p))
    }

    /// The ends of a line; none of a piece of another curve.
    pub(super) fn chord(&self, piece: usize) -> Option<[Position; 2]> {
        let [before, after] = [piece.checked_sub(1), Some(piece)];
        let at = |index: Option<usize>| match (&self.shape, index) {
            (Shape::Units(decimals, points), Some(index)) => {
                let mut place = points.start;
                let from = index * points.stride;
                place[..points.stride].copy_from_slice(points.units.get(from..from + points.stride)?);
                Some(decimals.position(&place))
            }
            (Shape::Units(decimals, points), None) => Some(decimals.position(&points.start)),
            (Shape::Line(line), Some(index)) => {
                let mut place = line.start;
                let from = index * line.stride;
                place[..line.stride].copy_from_slice(line.values.get(from..from + line.stride)?);
                Some(place)
            }
            (Shape::Line(line), None) => Some(line.start),
            (Shape::Pieces(..), _) => None,
        };
        Some([self.placed(&at(before)?), self.placed(&at(after)?)])
    }

    fn placed(&self, p: &Position) -> Position {
        std::array::from_fn(|i| self.order.get(i).map_or(0.0, |own| p[*own]))
    }

    /// How often a minute line `piece` could be made, where that is its F.
    pub(super) fn rate(&self, piece: usize) -> Option<f64> {
        match &self.shape {
            Shape::Units(_, points) => points.rates.get(piece).map(|rate| rate.to_f64()),
            Shape::Line(line) => line.rates.get(piece).copied(),
            Shape::Pieces(..) => None,
        }
    }

    /// The line of the text that a piece stands in, where that is known.
    fn line(&self, piece: usize) -> Option<u32> {
        let lines = match &self.shape {
            Shape::Units(_, points) => &points.lines,
            Shape::Line(line) => &line.lines,
            Shape::Pieces(_, lines) => lines,
        };
        lines.get(piece).copied().filter(|line| *line != 0)
    }
}

/// What is wrong with a curve of the program.
fn unsound(span: Span, message: impl Into<String>) -> Diagnostic {
    Diagnostic::error("spline-unsound", message.into()).at(span, "")
}

/// The line of each piece of a B-spline: that of the last control point that bends it.
fn lines_of(nurbs: &WrittenNurbs) -> Vec<u32> {
    let spans = (nurbs.degree..nurbs.points.len()).filter(|k| nurbs.knots[*k] < nurbs.knots[*k + 1]);
    spans.filter_map(|k| nurbs.lines.get(k).copied()).collect()
}

impl<'a> Side<'a> {
    /// A program that was read for a machine, whose rotary axes count at `radius` mm.
    ///
    /// # Errors
    /// It has a spline or an arc that is none.
    pub(super) fn of_program(
        decimals: &'a Decimals,
        machine: &'a Machine,
        (text, id): (&'a str, SourceId),
        radius: f64,
    ) -> Result<Side<'a>, Diagnostic> {
        let own = decimals.program.axes;
        let order = translate::moved_axes(decimals);
        let mut digits = [0; MAX_AXES];
        order.iter().enumerate().for_each(|(i, own)| digits[i] = decimals.digits[*own]);
        let shape = |written: &'a Written, span: Span| -> Result<Shaped<'a>, Diagnostic> {
            Ok(match written {
                Written::Lines(points) => Shaped::Path(Shape::Units(decimals, points), 0.0),
                Written::Through(kind, points) => Shaped::Points(*kind, Shape::Units(decimals, points)),
                Written::Arc(arc) => {
                    let found = to_arc(decimals, arc);
                    let found = found.ok_or_else(|| unsound(span, "this arc has no radius"))?;
                    let (shape, mut slack) = round(&found, arc.line, radius);
                    if let ArcBy::Turn(circle, degrees) = arc.by {
                        // It ends where the angle leads, which is no place in decimals.
                        let angle = sweep(circle.sense, degrees);
                        let center = circle.place(&decimals.digits);
                        let end = turned(circle.plane, found.start(), found.end(), center, angle);
                        slack += distance(&end, &found.end());
                    }
                    Shaped::Path(shape, slack)
                }
                Written::Polynomial(polynomial) => {
                    let mut start = polynomial.start;
                    let piece = |block: &crate::ir::PolynomialBlock| {
                        let piece = block.to_bezier(&decimals.digits, &start);
                        start = block.end;
                        piece
                    };
                    let pieces = polynomial.blocks.iter().map(piece).collect();
                    let lines = polynomial.blocks.iter().map(|block| block.line).collect();
                    Shaped::Path(Shape::Pieces(pieces, lines), 0.0)
                }
                Written::Nurbs(nurbs) => {
                    let spline = to_nurbs(decimals, nurbs).map_err(|e| unsound(span, e.to_string()))?;
                    let pieces = spline.beziers().map(|(piece, _)| piece).collect();
                    Shaped::Path(Shape::Pieces(pieces, lines_of(nurbs)), 0.0)
                }
            })
        };
        let items = items(&decimals.program, &order, Decimal::to_f64, shape)?;
        let axes = chosen(&own, &order);
        let digits = Some((machine.digits.feed, digits));
        Ok(Side { axes, machine: Some(machine), digits, text, id, items })
    }

    /// What an input asks for; `machine` is that of the program it is compared with.
    ///
    /// # Errors
    /// It asks for a cutter's path, which is compared with a program another way.
    pub(super) fn of_intent(
        intent: &'a Intent,
        machine: Option<&'a Machine>,
        (text, id): (&'a str, SourceId),
        radius: f64,
    ) -> Result<Side<'a>, Diagnostic> {
        let axes = intent.program.axes;
        let order: Vec<usize> = (0..axes.count()).collect();
        let shape = |curve: &'a Curve, span: Span| -> Result<Shaped<'a>, Diagnostic> {
            Ok(match curve {
                Curve::Lines(line) => Shaped::Path(Shape::Line(line), 0.0),
                Curve::Through(kind, line) => Shaped::Points(*kind, Shape::Line(line)),
                Curve::Arc(arc) => {
                    let (shape, slack) = round(arc, 0, radius);
                    Shaped::Path(shape, slack)
                }
                Curve::Polynomial(_) | Curve::Nurbs(_) => {
                    Shaped::Path(Shape::Pieces(curve.pieces(), Vec::new()), 0.0)
                }
                Curve::Formula(described) => {
                    let square = |i: usize| {
                        let scale = if axes.kind(i) == Kind::Rotary { radius / DEGREES } else { 1.0 };
                        described.bound[i] * scale * described.bound[i] * scale
                    };
                    let slack = (0..axes.count()).map(square).sum::<f64>().sqrt();
                    Shaped::Path(Shape::Pieces(curve.pieces(), Vec::new()), slack)
                }
                Curve::Logarithmic(_) => {
                    return Err(Diagnostic::error("input-cutter", "a cutter has no program yet")
                        .at(span, "")
                        .hint("`verify PROGRAM --against` this input proves a program against it"));
                }
            })
        };
        let items = items(&intent.program, &order, |x| x, shape)?;
        Ok(Side { axes, machine, digits: None, text, id, items })
    }

    /// The place of a piece of a path.
    pub(super) fn place(&self, part: &Part<'_>, piece: usize) -> Span {
        let Some(line) = part.line(piece) else { return part.span };
        let text = self.text.as_bytes();
        let start = match line {
            1 => 0,
            _ => memchr::memchr_iter(b'\n', text).nth(line as usize - 2).map_or(text.len(), |at| at + 1),
        };
        let rest = &self.text[start..];
        let line = rest.split('\n').next().unwrap_or_default();
        Span::new(self.id, start..start + line.trim_end().len())
    }

    /// Where a step stands; a path where it begins.
    pub(super) fn place_of(&self, item: &Item<'_>) -> Span {
        match item {
            Item::Switch(_, span) | Item::Rapid(_, span) => *span,
            Item::Path(parts) => parts.first().map_or(self.end(), |part| self.place(part, 0)),
            Item::Points(_, part) => self.place(part, 0),
        }
    }

    /// A step in words.
    pub(super) fn spelled(&self, item: &Item<'_>) -> String {
        let name = |axis: usize| self.axes.name(axis);
        match item {
            Item::Switch(step, _) => match step {
                Step::Tool(call) => call.to_string(),
                Step::Spindle(rpm) => format!("the spindle at {rpm} rev/min"),
                Step::Coolant => "the coolant".to_owned(),
                Step::Home(axis) => format!("{} to its home", name(*axis)),
                Step::Shift(shifts) => {
                    let names: Vec<String> =
                        shifts.iter().map(|s| format!("{} {}", name(s.axis), s.to)).collect();
                    format!("a work offset of {} that is a parameter", names.join(" "))
                }
                Step::Auxiliary(auxiliary) => spelled_auxiliary(auxiliary),
                Step::Comment(_) | Step::Rapid(_) | Step::Cut(_) => "a step".to_owned(),
            },
            Item::Rapid(to, _) => {
                let known =
                    to.iter().enumerate().filter_map(|(axis, to)| Some(format!("{} {}", name(axis), (*to)?)));
                format!("a rapid to {}", known.collect::<Vec<_>>().join(" "))
            }
            Item::Path(_) => "a path at feed".to_owned(),
            Item::Points(..) => "a spline of the control's own".to_owned(),
        }
    }

    /// The end of the text.
    pub(super) fn end(&self) -> Span {
        let end = self.text.trim_end().len();
        let start = self.text[..end].rfind('\n').map_or(0, |at| at + 1);
        Span::new(self.id, start..end)
    }

    /// What is wrong where it moves an axis that the other does not, or counts it in another way.
    pub(super) fn has_other_axes(&self, other: &Side<'_>) -> Option<Diagnostic> {
        let (axis, kind) = self.axes.as_slice().iter().enumerate().find_map(|(i, (axis, kind))| {
            let known = other.axes.index_of(*axis).map(|i| other.axes.kind(i));
            (known != Some(*kind)).then_some((i, known))
        })?;
        let name = self.axes.name(axis);
        let message = match kind {
            None => format!("{name} moves in one of the programs only"),
            Some(_) => format!("{name} is a linear axis in one of the programs and turns in the other"),
        };
        let moves = |item: &&Item<'_>| match item {
            Item::Switch(..) => false,
            Item::Rapid(to, _) => to[axis].is_some(),
            Item::Path(_) | Item::Points(..) => true,
        };
        let diagnostic = Diagnostic::refusal("axes-differ", message);
        Some(match self.items.iter().find(moves) {
            Some(item) => diagnostic.at(self.place_of(item), format!("{name} moves here")),
            None => diagnostic,
        })
    }

    /// The same with the axes in the order of the other, which has the same.
    pub(super) fn ordered(mut self, axes: &Axes) -> Side<'a> {
        let order: Vec<usize> =
            axes.as_slice().iter().filter_map(|(axis, _)| self.axes.index_of(*axis)).collect();
        for item in &mut self.items {
            match item {
                Item::Switch(Step::Home(axis), _) => {
                    *axis = axes.index_of(self.axes.name(*axis)).unwrap_or(*axis);
                }
                Item::Switch(Step::Shift(shifts), _) => shifts
                    .iter_mut()
                    .for_each(|s| s.axis = axes.index_of(self.axes.name(s.axis)).unwrap_or(s.axis)),
                Item::Switch(..) => {}
                Item::Rapid(to, _) => *to = std::array::from_fn(|i| order.get(i).and_then(|own| to[*own])),
                Item::Path(parts) => parts.iter_mut().for_each(|part| part.reorder(&order)),
                Item::Points(_, part) => part.reorder(&order),
            }
        }
        if let Some((_, digits)) = &mut self.digits {
            let old = *digits;
            order.iter().enumerate().for_each(|(i, own)| digits[i] = old[*own]);
        }
        self.axes = *axes;
        self
    }
}

impl Part<'_> {
    fn reorder(&mut self, order: &[usize]) {
        self.order = order.iter().map(|own| self.order[*own]).collect();
    }
}

fn distance(p: &Position, q: &Position) -> f64 {
    p.iter().zip(q).map(|(p, q)| (p - q) * (p - q)).sum::<f64>().sqrt()
}

/// Some of the axes, in order.
fn chosen(axes: &Axes, order: &[usize]) -> Axes {
    let own: Vec<_> = order.iter().map(|i| axes.as_slice()[*i]).collect();
    // A program that moves something has an axis, and none twice.
    Axes::new(&own).unwrap_or(*axes)
}

/// An arc as pieces, and how far they are from it, mm.
fn round<'a>(arc: &Arc, line: u32, radius: f64) -> (Shape<'a>, f64) {
    let (pieces, [misfit, along]) = round::pieces(arc);
    let lines = vec![line; pieces.len()];
    (Shape::Pieces(pieces, lines), misfit + along * (radius / DEGREES).max(1.0))
}

/// What a cut is.
enum Shaped<'a> {
    Path(Shape<'a>, f64),
    Points(ThroughKind, Shape<'a>),
}

/// The steps of a program as items: parts of a path stand together, remarks and plain work offsets are left out, and so are
/// rapids to where the tool is.
fn items<'a, N: Copy + 'a, C: 'a>(
    program: &'a Program<N, C>,
    order: &[usize],
    number: impl Fn(N) -> f64,
    shape: impl Fn(&'a C, Span) -> Result<Shaped<'a>, Diagnostic>,
) -> Result<Vec<Item<'a>>, Diagnostic> {
    let mut items: Vec<Item<'a>> = Vec::new();
    let mut at: [Option<f64>; MAX_AXES] = [None; MAX_AXES];
    let index = |axis: usize| order.iter().position(|own| *own == axis);
    for Located { step, span } in &program.steps {
        let span = *span;
        let mut switch = |step| items.push(Item::Switch(step, span));
        match step {
            Step::Comment(_) => {}
            Step::Tool(call) => switch(Step::Tool(*call)),
            Step::Spindle(rpm) => switch(Step::Spindle(number(*rpm))),
            Step::Coolant => switch(Step::Coolant),
            Step::Auxiliary(auxiliary) => {
                let plain = |x| Some(number(x));
                if let Some(auxiliary) = auxiliary.try_map(plain, plain) {
                    switch(Step::Auxiliary(auxiliary));
                }
                if let Auxiliary::Plane(_) | Auxiliary::PlaneEnd = auxiliary {
                    at = [None; MAX_AXES];
                }
            }
            Step::Home(axis) => {
                // An axis that nothing else moves has a home too, and is there before and after.
                if let Some(axis) = index(*axis) {
                    at[axis] = None;
                    switch(Step::Home(axis));
                }
            }
            Step::Shift(shifts) => {
                let parameters = shifts.iter().filter(|shift| shift.parameter).filter_map(|shift| {
                    Some(Shift { axis: index(shift.axis)?, to: number(shift.to), parameter: true })
                });
                let parameters: Vec<_> = parameters.collect();
                if !parameters.is_empty() {
                    switch(Step::Shift(parameters));
                }
            }
            Step::Rapid(targets) => {
                let before = at;
                for (axis, to) in targets {
                    if let Some(axis) = index(*axis) {
                        at[axis] = Some(number(*to));
                    }
                }
                if at != before {
                    items.push(Item::Rapid(at, span));
                }
            }
            Step::Cut(Cut { feed, curve, .. }) => {
                let feed = feed.map(&number);
                let part = |shape, slack| Part { shape, span, feed, slack, order: order.to_vec() };
                let (kind, part) = match shape(curve, span)? {
                    Shaped::Path(shape, slack) => (None, part(shape, slack)),
                    Shaped::Points(kind, shape) => (Some(kind), part(shape, 0.0)),
                };
                let [_, end] = part.ends();
                at = std::array::from_fn(|i| (i < order.len()).then_some(end[i]));
                match (kind, items.last_mut()) {
                    (Some(kind), _) => items.push(Item::Points(kind, part)),
                    (None, Some(Item::Path(parts))) => parts.push(part),
                    (None, _) => items.push(Item::Path(vec![part])),
                }
            }
        }
    }
    Ok(items)
}
