//! Curves in floats: shapes that can be evaluated exactly.

use super::{Located, Step, padded};
use crate::geom::arc::Arc;
use crate::geom::bezier::Bezier;
use crate::geom::direction;
use crate::geom::expr::curve::Formula;
use crate::geom::logcurve::{LogCurve, Measure};
use crate::geom::nurbs::Nurbs;
use crate::units::Position;

/// Gives rapids and cuts other coordinates beside X Y Z: `rapid` those of a rapid, `place` those of each place of `stride`
/// numbers. A curve of which that is not known stays as it is.
pub fn map_along(
    steps: &mut [Located<f64, Curve>],
    stride: usize,
    rapid: impl Fn(&mut Vec<(usize, f64)>),
    place: impl Fn(&Position) -> Position,
) {
    for located in steps {
        match &mut located.step {
            Step::Rapid(targets) => rapid(targets),
            Step::Cut(cut) => {
                if let Some(curve) = cut.curve.mapped_along(stride, &place) {
                    cut.curve = curve;
                }
            }
            Step::Comment(_)
            | Step::Tool(_)
            | Step::Spindle(_)
            | Step::Coolant
            | Step::Home(_)
            | Step::Shift(_)
            | Step::Auxiliary(_) => {}
        }
    }
}

/// A shape that can be evaluated exactly.
#[derive(Clone, Debug, PartialEq)]
pub enum Curve {
    /// Straight lines.
    Lines(Polyline),
    /// An arc or a helix.
    Arc(Arc),
    /// Polynomial pieces, joined end to start.
    Polynomial(Vec<Bezier>),
    /// A B-spline, rational where its weights differ.
    Nurbs(Nurbs),
    /// The control's own curve through points: known at the points only.
    Through(ThroughKind, Polyline),
    /// The path of a conical cutter's flute.
    Logarithmic(Logarithmic),
    /// Coordinates as expressions in a parameter.
    Formula(Described),
}

/// A curve by expressions, and the pieces that stand for it wherever pieces are needed.
#[derive(Clone, Debug, PartialEq)]
pub struct Described {
    /// The expressions.
    pub formula: std::sync::Arc<Formula>,
    /// Quintic pieces.
    pub pieces: Vec<Bezier>,
    /// How far they are from it at most, mm or degrees, each axis.
    pub bound: Position,
}

impl Curve {
    /// The pieces that it is made of, end to start; none of a logarithmic curve or an arc, nor of one that only the control
    /// knows.
    pub fn pieces(&self) -> Vec<Bezier> {
        match self {
            Curve::Lines(line) => {
                let mut from = line.start;
                line.points().map(|to| Bezier::line(std::mem::replace(&mut from, to), to)).collect()
            }
            Curve::Polynomial(pieces) | Curve::Formula(Described { pieces, .. }) => pieces.clone(),
            Curve::Nurbs(nurbs) => nurbs.beziers().map(|(piece, _)| piece).collect(),
            Curve::Arc(_) | Curve::Through(..) | Curve::Logarithmic(_) => Vec::new(),
        }
    }

    /// Where it starts and ends; none of a logarithmic curve, whose places are those of a machine's axes, and of one without any.
    pub fn ends(&self) -> Option<(Position, Position)> {
        match self {
            Curve::Lines(line) | Curve::Through(_, line) => {
                Some((line.start, padded(line.values.chunks_exact(line.stride).next_back()?)))
            }
            Curve::Arc(arc) => Some((arc.start(), arc.end())),
            Curve::Nurbs(nurbs) => Some((*nurbs.points().first()?, *nurbs.points().last()?)),
            Curve::Polynomial(pieces) | Curve::Formula(Described { pieces, .. }) => {
                Some((pieces.first().map(Bezier::start)?, pieces.last().map(Bezier::end)?))
            }
            Curve::Logarithmic(_) => None,
        }
    }

    /// The same curve with every place mapped to one of `stride` numbers, each of them affine in the place; none of a curve that
    /// such a map does not keep what it is.
    pub fn mapped(&self, stride: usize, map: impl Fn(&Position) -> Position) -> Option<Curve> {
        Some(match self {
            Curve::Lines(line) => Curve::Lines(line.mapped(stride, map)),
            Curve::Nurbs(nurbs) => Curve::Nurbs(nurbs.mapped(map)),
            Curve::Polynomial(pieces) => {
                Curve::Polynomial(pieces.iter().map(|piece| piece.mapped(&map)).collect())
            }
            Curve::Arc(_) | Curve::Through(..) | Curve::Logarithmic(_) | Curve::Formula(_) => return None,
        })
    }

    /// The same curve with other coordinates beside X Y Z, which `map` must leave alone; none of a curve of which that is not known.
    pub fn mapped_along(&self, stride: usize, map: impl Fn(&Position) -> Position) -> Option<Curve> {
        if let Curve::Arc(arc) = self {
            return Some(Curve::Arc(arc.mapped_along(map)));
        }
        self.mapped(stride, map)
    }

    /// The greatest angle between the direction of the tool, in coordinates from `first` on, and an axis of length 1, radians;
    /// none of a curve that no input has in five axes. Between control points a direction is a sum of theirs, and in a cone
    /// about the axis that holds those.
    pub fn strays(&self, first: usize, axis: &[f64; 3]) -> Option<f64> {
        let of = |points: &mut dyn Iterator<Item = Position>| {
            points
                .map(|p| direction::angle(&[p[first], p[first + 1], p[first + 2]], axis))
                .fold(0.0, f64::max)
        };
        Some(match self {
            Curve::Lines(line) => of(&mut std::iter::once(line.start).chain(line.points())),
            Curve::Arc(arc) => of(&mut [arc.start(), arc.end()].into_iter()),
            Curve::Nurbs(nurbs) => of(&mut nurbs.points().iter().copied()),
            Curve::Polynomial(pieces) => of(&mut pieces.iter().flat_map(Bezier::control_points).copied()),
            Curve::Through(..) | Curve::Logarithmic(_) | Curve::Formula(_) => return None,
        })
    }

    /// A coordinate that no place of it exceeds; −∞ of a logarithmic curve.
    pub fn greatest(&self, axis: usize) -> f64 {
        let of = |points: &mut dyn Iterator<Item = Position>| {
            points.map(|point| point[axis]).fold(f64::NEG_INFINITY, f64::max)
        };
        match self {
            Curve::Lines(line) | Curve::Through(_, line) => {
                of(&mut std::iter::once(line.start).chain(line.points()))
            }
            Curve::Arc(arc) => arc.range().1[axis],
            Curve::Nurbs(nurbs) => of(&mut nurbs.points().iter().copied()),
            Curve::Polynomial(pieces) | Curve::Formula(Described { pieces, .. }) => {
                of(&mut pieces.iter().flat_map(Bezier::control_points).copied())
            }
            Curve::Logarithmic(_) => f64::NEG_INFINITY,
        }
    }
}

/// A logarithmic curve and how it is to be followed.
#[derive(Clone, Debug, PartialEq)]
pub struct Logarithmic {
    /// The curve.
    pub curve: LogCurve,
    /// How.
    pub method: Method,
    /// The instruction step Δl of odd-even steps; none: the largest ≤ 0.2 that holds the tolerance.
    pub dl: Option<f64>,
    /// Whole cycles until X reaches or passes the end.
    pub overrun: bool,
    /// Whether it is run from its end to its start.
    pub back: bool,
    /// What its feed is a speed of.
    pub along: Measure,
}

/// How a logarithmic curve is followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Odd-even for lines along a curve, direct for splines and for what is straight anyway.
    Auto,
    /// The paper's steps: the intent is the polyline through those points.
    OddEven,
    /// The curve itself is the intent.
    Direct,
}

/// Which curve a control makes of points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ThroughKind {
    /// Sinumerik ASPLINE.
    Akima,
    /// Sinumerik CSPLINE.
    Cubic,
    /// Mazak G06.1, fine spline interpolation.
    Fine,
}

/// A start and points, in one flat block of numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Polyline {
    /// Where it starts.
    pub start: Position,
    /// How many numbers a point has.
    pub stride: usize,
    /// The points after the start.
    pub values: Vec<f64>,
    /// How often a minute each line could be made, where that is its feed; otherwise empty.
    pub rates: Vec<f64>,
    /// The line of the input that each point came from; empty where the points were made.
    pub lines: Vec<u32>,
}

impl Polyline {
    /// A polyline of no points yet.
    pub fn new(start: Position, stride: usize) -> Polyline {
        Polyline { start, stride, values: Vec::new(), rates: Vec::new(), lines: Vec::new() }
    }

    /// The same line from its end to its start.
    #[must_use]
    pub fn reversed(&self) -> Polyline {
        let mut points: Vec<Position> = std::iter::once(self.start).chain(self.points()).collect();
        points.reverse();
        let mut line = Polyline::new(points[0], self.stride);
        points[1..].iter().for_each(|point| line.push(point));
        line.rates = self.rates.iter().rev().copied().collect();
        line
    }

    /// The same line with every place mapped to one of `stride` numbers.
    #[must_use]
    pub fn mapped(&self, stride: usize, map: impl Fn(&Position) -> Position) -> Polyline {
        let mut line = Polyline::new(map(&self.start), stride);
        self.points().for_each(|point| line.push(&map(&point)));
        line.rates.clone_from(&self.rates);
        line.lines.clone_from(&self.lines);
        line
    }

    /// The lines behind the first `from` up to the one that is number `to`: from one of its points to another, the start
    /// being number 0.
    #[must_use]
    pub fn part(&self, from: usize, to: usize) -> Polyline {
        fn of<T: Clone>(all: &[T], from: usize, to: usize) -> Vec<T> {
            let to = to.min(all.len());
            all[from.min(to)..to].to_vec()
        }
        let start = match from.checked_sub(1).and_then(|last| self.values.chunks_exact(self.stride).nth(last))
        {
            Some(point) => padded(point),
            None => self.start,
        };
        Polyline {
            start,
            stride: self.stride,
            values: of(&self.values, from * self.stride, to * self.stride),
            rates: of(&self.rates, from, to),
            lines: of(&self.lines, from, to),
        }
    }

    /// Adds a point.
    pub fn push(&mut self, point: &Position) {
        self.values.extend_from_slice(&point[..self.stride]);
    }

    /// How many points there are after the start.
    pub fn count(&self) -> usize {
        self.values.len() / self.stride
    }

    /// The points after the start.
    pub fn points(&self) -> impl Iterator<Item = Position> + '_ {
        self.values.chunks_exact(self.stride).map(padded)
    }
}
