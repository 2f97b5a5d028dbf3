//! The intermediate representation: what the machine is to do, explicit, absolute, metric, free of modes.
//!
//! A [`Program`] is a list of [`Step`]s over two kinds of number and two kinds of curve:
//!
//! | | numbers | curves |
//! |---|---|---|
//! | [`Intent`] and what the passes make of it | `f64` | [`Curve`]: shapes that can be evaluated exactly |
//! | [`Decimals`], what a control reads | [`Decimal`] | [`Written`]: the same shapes in decimals |
//!
//! Every cut carries its feed and every move its whole end point. Modes exist only in text.
//! A [`Step::Comment`] starts a section: writers forget all modal state there, so that a program can be restarted.

mod arc;
mod curve;
mod passed;

pub use arc::{ArcBy, Circle, WrittenArc, sweep, turned_end};
pub use curve::{Curve, Described, Logarithmic, Method, Polyline, ThroughKind, map_along};
pub use passed::Passed;

use crate::decimal::{Decimal, units_to_f64};
use crate::diagnostic::Diagnostics;
use crate::geom::bezier::Bezier;
use crate::geom::deviation::Bound;
use crate::source::Span;
use crate::units::{Axes, DEGREES, MAX_AXES, Position};
use std::borrow::Borrow;
use std::fmt;

/// A program: a name, its coordinates, its steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Program<N, C> {
    /// The program's name.
    pub name: String,
    /// The program's number, where the control wants one; 0: nobody chose one.
    pub number: u32,
    /// The coordinates of every position.
    pub axes: Axes,
    /// What happens, in order.
    pub steps: Vec<Located<N, C>>,
}

impl<N, C> Program<N, C> {
    /// Whether positions count in tilted planes somewhere.
    pub fn has_planes(&self) -> bool {
        self.steps.iter().any(|located| matches!(located.step, Step::Auxiliary(Auxiliary::Plane(_))))
    }
}

/// A step and the text that it came from.
#[derive(Clone, Debug, PartialEq)]
pub struct Located<N, C> {
    /// What happens.
    pub step: Step<N, C>,
    /// Where it was said.
    pub span: Span,
}

/// One thing that happens.
#[derive(Clone, Debug, PartialEq)]
pub enum Step<N, C> {
    /// A remark for the reader, and the start of a section.
    Comment(String),
    /// A tool is called.
    Tool(ToolCall),
    /// The spindle turns clockwise, rev/min.
    Spindle(N),
    /// The coolant flows.
    Coolant,
    /// An axis (index into the program's axes) retracts at rapid to its clear position in machine coordinates. Where
    /// that is in the coordinates of the work nobody knows: the next rapid names the axis again.
    Home(usize),
    /// From here on the text counts these axes from other places: a work offset. Positions here stay as they are. None:
    /// every axis counts from the work's own zero again.
    Shift(Vec<Shift<N>>),
    /// Something is switched, or time passes.
    Auxiliary(Auxiliary<N>),
    /// Rapid traverse of the axes named (index into the program's axes, end position).
    Rapid(Vec<(usize, N)>),
    /// A path at feed.
    Cut(Cut<N, C>),
}

impl<N, C> Step<N, C> {
    /// The path, where the step is one.
    pub fn cut(&self) -> Option<&Cut<N, C>> {
        match self {
            Step::Cut(cut) => Some(cut),
            Step::Comment(_)
            | Step::Tool(_)
            | Step::Spindle(_)
            | Step::Coolant
            | Step::Home(_)
            | Step::Shift(_)
            | Step::Auxiliary(_)
            | Step::Rapid(_) => None,
        }
    }
}

/// A tool, and the register that its length is taken from: H of `G43 H12`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ToolCall {
    /// The tool's number.
    pub number: u32,
    register: u32,
}

impl ToolCall {
    /// A tool with its own length: the register has the number of the tool, where the control has such registers at all.
    pub fn own(number: u32) -> ToolCall {
        ToolCall { number, register: number }
    }

    /// The same tool with the length of another register.
    #[must_use]
    pub fn with_register(self, register: u32) -> ToolCall {
        ToolCall { register, ..self }
    }

    /// The register of its length.
    pub fn register(self) -> u32 {
        self.register
    }

    /// Whether its length is that of its own number.
    pub fn is_own(self) -> bool {
        self.register == self.number
    }
}

impl fmt::Display for ToolCall {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "tool {}", self.number)?;
        if self.is_own() { Ok(()) } else { write!(f, " with the length of register {}", self.register) }
    }
}

/// Something that is switched between moves, or time that passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Auxiliary<N> {
    /// The coolant stops.
    CoolantStop,
    /// The spindle stops.
    SpindleStop,
    /// The program stops until the operator goes on: M0.
    Stop,
    /// As before, where the operator asked for it: M1.
    OptionalStop,
    /// So many seconds pass.
    Dwell(N),
    /// From here on the tip of the tool is led and the tool's direction is stated: TRAORI, M128, G43.5.
    TipControl,
    /// That ends.
    TipControlEnd,
    /// The length of the tool does not count from here on.
    LengthEnd,
    /// From here on positions count in a plane that is tilted by three angles, degrees, in the order of the machine file,
    /// and the tool stands square to it. Where the axes are in it nobody knows.
    Plane([N; 3]),
    /// That ends.
    PlaneEnd,
}

impl<N> Auxiliary<N> {
    /// Its key in a machine file.
    pub fn key(&self) -> &'static str {
        match self {
            Auxiliary::CoolantStop => "coolant_stop",
            Auxiliary::SpindleStop => "spindle_stop",
            Auxiliary::Stop => "stop",
            Auxiliary::OptionalStop => "optional_stop",
            Auxiliary::Dwell(_) => "dwell",
            Auxiliary::TipControl => "tip_control",
            Auxiliary::TipControlEnd => "tip_control_end",
            Auxiliary::LengthEnd => "length_end",
            Auxiliary::Plane(_) => "plane",
            Auxiliary::PlaneEnd => "plane_end",
        }
    }

    /// The same with another kind of number for seconds and for angles; none where these have none.
    pub fn try_map<M>(
        self,
        seconds: impl Fn(N) -> Option<M>,
        angle: impl Fn(N) -> Option<M>,
    ) -> Option<Auxiliary<M>> {
        Some(match self {
            Auxiliary::CoolantStop => Auxiliary::CoolantStop,
            Auxiliary::SpindleStop => Auxiliary::SpindleStop,
            Auxiliary::Stop => Auxiliary::Stop,
            Auxiliary::OptionalStop => Auxiliary::OptionalStop,
            Auxiliary::Dwell(time) => Auxiliary::Dwell(seconds(time)?),
            Auxiliary::TipControl => Auxiliary::TipControl,
            Auxiliary::TipControlEnd => Auxiliary::TipControlEnd,
            Auxiliary::LengthEnd => Auxiliary::LengthEnd,
            Auxiliary::Plane([first, second, third]) => {
                Auxiliary::Plane([angle(first)?, angle(second)?, angle(third)?])
            }
            Auxiliary::PlaneEnd => Auxiliary::PlaneEnd,
        })
    }
}

/// Where the text counts an axis from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shift<N> {
    /// Index into the program's axes.
    pub axis: usize,
    /// The place, mm or degrees.
    pub to: N,
    /// Whether the place is a parameter of the program, which an operator may change: a correction after measuring.
    pub parameter: bool,
}

/// A path at feed.
#[derive(Clone, Debug, PartialEq)]
pub struct Cut<N, C> {
    /// In an intent the speed of what the path is measured along, mm/min or degrees/min; in a program F, a minute. None
    /// where the input does not say, and then no program is written.
    pub feed: Option<N>,
    /// Whether a motion that was asked for is used here; an approach stays straight lines.
    pub role: Role,
    /// The path.
    pub curve: C,
}

/// What a cut is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// It shapes the work.
    Path,
    /// It brings the tool to the work or away.
    Approach,
    /// It shapes the work in the form that was asked for: lines stay lines, unless they are to become splines.
    AsAsked,
}

impl<C: Borrow<Curve>> Cut<f64, C> {
    /// Whether the motion is used here: on every path, and on splines that were made of lines as asked.
    pub fn takes_motion(&self) -> bool {
        match (self.role, self.curve.borrow()) {
            (Role::Path, _) => true,
            (Role::Approach, _) | (Role::AsAsked, Curve::Lines(_) | Curve::Arc(_)) => false,
            (
                Role::AsAsked,
                Curve::Polynomial(_)
                | Curve::Nurbs(_)
                | Curve::Through(..)
                | Curve::Logarithmic(_)
                | Curve::Formula(_),
            ) => true,
        }
    }
}

/// What was asked: a program, and how exactly.
#[derive(Clone, Debug, PartialEq)]
pub struct Intent {
    /// The program.
    pub program: Program<f64, Curve>,
    /// The tolerance of the input, mm, and where it stands.
    pub tolerance: Option<(f64, Span)>,
    /// Where the program's name stands in the input.
    pub name_span: Option<Span>,
    /// The radius at which rotary axes count, mm, where the input states one.
    pub radius: Option<f64>,
    /// What rounding the angles of tilted planes cost: how far the tool's direction is from the one asked for, radians, and an
    /// arc that is square to it from the arc asked for, mm.
    pub tilt_error: Bound,
    /// How far paths may be from what the input states, mm: a whole turn whose angles are stated a hair beside one, an arc that
    /// is as good as straight.
    pub input_error: f64,
    /// What to know about it.
    pub warnings: Diagnostics,
}

impl Intent {
    /// Whether a program can be made of it: every cut has its feed, and a tool is called.
    pub fn is_complete(&self) -> bool {
        let fed = |step: &Step<f64, Curve>| match step {
            Step::Cut(cut) => cut.feed.is_some(),
            Step::Comment(_)
            | Step::Tool(_)
            | Step::Spindle(_)
            | Step::Coolant
            | Step::Home(_)
            | Step::Shift(_)
            | Step::Auxiliary(_)
            | Step::Rapid(_) => true,
        };
        let steps = &self.program.steps;
        steps.iter().all(|located| fed(&located.step))
            && steps.iter().any(|located| matches!(located.step, Step::Tool(_)))
    }

    /// The radius at which rotary axes count, mm: the cutter's greatest, or the one that the input states. Where nobody says,
    /// a degree counts as a millimetre.
    pub fn radius(&self) -> f64 {
        let own = self.logarithmic().map(|(log, ..)| log.curve.max_radius()).fold(0.0, f64::max);
        self.radius.unwrap_or(if own == 0.0 { DEGREES } else { own })
    }

    /// Its logarithmic paths with their feeds, and where each was asked for.
    pub fn logarithmic(&self) -> impl Iterator<Item = (&Logarithmic, Option<f64>, Span)> {
        self.program.steps.iter().filter_map(|located| match located.step.cut()? {
            Cut { feed, curve: Curve::Logarithmic(log), .. } => Some((log, *feed, located.span)),
            Cut {
                curve:
                    Curve::Lines(_)
                    | Curve::Arc(_)
                    | Curve::Polynomial(_)
                    | Curve::Nurbs(_)
                    | Curve::Formula(_)
                    | Curve::Through(..),
                ..
            } => None,
        })
    }
}

/// Some coordinates as a place that has them all, the others zero.
#[inline]
pub(crate) fn padded<N: Copy + Default>(coordinates: &[N]) -> [N; MAX_AXES] {
    let mut place = [N::default(); MAX_AXES];
    place[..coordinates.len()].copy_from_slice(coordinates);
    place
}

/// A position in units of each axis' last decimal.
pub type Units = [i64; MAX_AXES];

/// A program as a control reads it.
#[derive(Clone, Debug, PartialEq)]
pub struct Decimals {
    /// The program.
    pub program: Program<Decimal, Written>,
    /// How many decimals each axis has.
    pub digits: [u8; MAX_AXES],
    /// The axes that a text names nowhere, though it has a path that starts somewhere in them.
    pub unnamed: [bool; MAX_AXES],
    /// What to set up, in remarks before the first step.
    pub setup: Vec<String>,
}

impl Decimals {
    /// A position in mm and degrees.
    pub fn position(&self, units: &Units) -> Position {
        std::array::from_fn(|i| units_to_f64(units[i], self.digits[i]))
    }
}

/// A shape in decimals.
#[derive(Clone, Debug, PartialEq)]
pub enum Written {
    /// Straight lines.
    Lines(WrittenPoints),
    /// An arc or a helix.
    Arc(WrittenArc),
    /// Polynomial blocks.
    Polynomial(WrittenPolynomial),
    /// A B-spline.
    Nurbs(WrittenNurbs),
    /// The control's own curve through points.
    Through(ThroughKind, WrittenPoints),
}

/// A start and points, in units of each axis' last decimal.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenPoints {
    /// Where it starts.
    pub start: Units,
    /// How many numbers a point has.
    pub stride: usize,
    /// The points after the start.
    pub units: Vec<i64>,
    /// The line of the text that each point came from; empty where there is no text yet.
    pub lines: Vec<u32>,
    /// F of each line under inverse time, 1/min; otherwise empty.
    pub rates: Vec<Decimal>,
}

impl WrittenPoints {
    /// How many points there are after the start.
    pub fn count(&self) -> usize {
        self.units.len() / self.stride
    }

    /// The points after the start.
    pub fn points(&self) -> impl Iterator<Item = Units> + '_ {
        self.units.chunks_exact(self.stride).map(padded)
    }
}

/// Polynomial blocks, joined end to start.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenPolynomial {
    /// Where it starts.
    pub start: Units,
    /// The blocks.
    pub blocks: Vec<PolynomialBlock>,
}

/// How many coefficients a block can have beside its ends: a₂ … a₅.
pub const COEFFICIENTS: usize = 4;

/// f(p) = a₀ + a₁p + a₂p² + … for 0 ≤ p ≤ PL; a₀ is the start and a₁ follows from the end:
///
/// ```text
/// a₁ = (end − a₀ − a₂ PL² − … − a₅ PL⁵) / PL
/// ```
///
/// With a denominator D(p) = 1 + d₁p + d₂p² + … a coordinate is N(p)/D(p), and N(PL) = end · D(PL):
///
/// ```text
/// d₁ = (D(PL) − 1 − d₂ PL² − …) / PL          a₁ = (end · D(PL) − a₀ − a₂ PL² − …) / PL
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PolynomialBlock {
    /// The parameter's length.
    pub pl: Decimal,
    /// The end.
    pub end: Units,
    /// a₂ … a₅ for each axis.
    pub coefficients: [[Decimal; COEFFICIENTS]; MAX_AXES],
    /// The denominator of a rational block.
    pub denominator: Option<Denominator>,
    /// The line of the text that it came from, or 0.
    pub line: u32,
}

/// The denominator of a rational block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Denominator {
    /// D(PL).
    pub end: Decimal,
    /// d₂ … d₅.
    pub coefficients: [Decimal; COEFFICIENTS],
    /// The axes whose coordinates it divides; others rest.
    pub divides: [bool; MAX_AXES],
}

/// a₁ … of a polynomial with this constant, this value at `length` and these a₂ …, as Bezier ordinates.
fn ordinates(first: f64, last: f64, rest: &[Decimal], length: f64) -> [f64; 6] {
    let degree = rest.len() + 1;
    let mut a = [first, 0.0, 0.0, 0.0, 0.0, 0.0];
    let (mut power, mut linear) = (length, last - first);
    for (k, coefficient) in rest.iter().enumerate() {
        power *= length;
        a[k + 2] = coefficient.to_f64();
        linear -= a[k + 2] * power;
    }
    a[1] = linear / length;
    let mut ordinates = Bezier::ordinates(&a[..=degree], length);
    ordinates[degree] = last;
    ordinates
}

/// The least weight that divides a control point without loss, as a share of the greatest.
const LEAST_WEIGHT: f64 = 1.0e-3;

/// Whether all weights are above zero, and none is next to it.
fn sound(weights: &[f64]) -> bool {
    let greatest = weights.iter().copied().fold(0.0, f64::max);
    weights.iter().all(|w| LEAST_WEIGHT * greatest < *w)
}

impl PolynomialBlock {
    /// Whether it moves nothing from `start`.
    pub fn rests(&self, start: &Units) -> bool {
        let zero = |coefficients: &[Decimal; COEFFICIENTS]| coefficients.iter().all(|a| a.is_zero());
        self.end == *start && self.coefficients.iter().all(zero)
    }

    /// The block as a Bezier piece from `start`.
    pub fn to_bezier(&self, digits: &[u8; MAX_AXES], start: &Units) -> Bezier {
        let used = |coefficients: &[Decimal; COEFFICIENTS]| {
            COEFFICIENTS - coefficients.iter().rev().take_while(|a| a.is_zero()).count()
        };
        let below = self.denominator.map_or(0, |denominator| used(&denominator.coefficients));
        let mut count = self.coefficients.iter().map(used).max().unwrap_or(0).max(below);
        let length = self.pl.to_f64();
        let mut weights = [1.0; COEFFICIENTS + 2];
        if let Some(denominator) = &self.denominator {
            let end = denominator.end.to_f64();
            let of = |count| ordinates(1.0, end, &denominator.coefficients[..count], length);
            weights = of(count);
            // A denominator above zero can have a weight that is none, as 1, 0, 1 of half a circle. In a higher degree, which
            // is the same polynomial, its weights come nearer to its values.
            while count < COEFFICIENTS && !sound(&weights[..count + 2]) {
                count += 1;
                weights = of(count);
            }
        }
        let degree = 1 + count;
        let mut piece = Bezier::new(&[[0.0; MAX_AXES]; 6][..=degree]);
        piece.weights = weights;
        for axis in 0..MAX_AXES {
            let (first, last) =
                (units_to_f64(start[axis], digits[axis]), units_to_f64(self.end[axis], digits[axis]));
            if self.denominator.is_some_and(|denominator| !denominator.divides[axis]) {
                piece.points.iter_mut().for_each(|point| point[axis] = first);
                continue;
            }
            let whole = last * piece.weights[degree];
            let numerator = ordinates(first, whole, &self.coefficients[axis][..count], length);
            for i in 0..=degree {
                piece.points[i][axis] = numerator[i] / piece.weights[i];
            }
            piece.points[degree][axis] = last;
        }
        piece
    }
}

/// A B-spline in decimals.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenNurbs {
    /// Its degree.
    pub degree: usize,
    /// The whole clamped knot vector in units of 10^−`knot_digits`.
    pub knots: Vec<i64>,
    /// How many decimals a knot has.
    pub knot_digits: u8,
    /// The control points, the first one included.
    pub points: Vec<Units>,
    /// A weight for each control point, where they differ.
    pub weights: Option<Vec<Decimal>>,
    /// The line of the text that each point came from; empty where there is no text yet.
    pub lines: Vec<u32>,
}
