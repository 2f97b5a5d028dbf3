//! What a machine file says, as types.

use super::template::Template;
use crate::decimal::{Decimal, Spelling};
use crate::dialect::{Dialect, Motion};
use crate::geom::rotation::Order;
use crate::ir::Auxiliary;
use crate::units::{Axes, Axis};
use serde::Serialize;
use std::collections::BTreeMap;

/// One machine.
#[derive(Clone, Debug)]
pub struct Machine {
    /// Its name.
    pub name: String,
    /// What it is, in one line.
    pub about: String,
    /// How it is written to.
    pub dialect: &'static Dialect,
    /// The motion for cutting pieces; none for `auto`.
    pub motion: Option<&'static Motion>,
    /// mm, where neither the command line nor the input says.
    pub tolerance: f64,
    /// The axes of a program on it.
    pub axes: Axes,
    /// All axes that it has, whether a program moves them or not.
    pub declared: Vec<Axis>,
    /// Which of them are X, Y, Z and A of a cutter.
    pub cutter_axes: [Axis; 4],
    /// What each axis can do, where the file says.
    pub limits: BTreeMap<Axis, AxisLimits>,
    /// Decimals.
    pub digits: Digits,
    /// Spelling.
    pub text: Text,
    /// How F counts rotary axes.
    pub rotary_feed: RotaryFeed,
    /// How far the speed inside a block may be from the one asked for, as a share.
    pub feed_error: f64,
    /// Whether feeds are parameters.
    pub feed_parameter: bool,
    /// How long the control takes to make a block ready, ms.
    pub block_time: Option<f64>,
    /// Which parameters a program may use.
    pub parameters: Parameters,
    /// What its splines take.
    pub spline: Spline,
    /// Whether arcs may choose another plane than X Y, in which the length of the tool stays along Z.
    pub arc_planes: bool,
    /// How the direction of the tool is stated and turned.
    pub orientation: Orientation,
    /// The lines round a program.
    pub frame: Frame,
}

/// How the direction of the tool is stated in five axes, and how the control turns it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orientation {
    /// Decimals of a component.
    pub digits: u8,
    /// How far the direction may be from the one that was asked for, degrees.
    pub tolerance: f64,
    /// How the control turns the tool between two directions.
    pub turn: Turn,
    /// Whether spline blocks take a second curve of a point of the tool, XH YH ZH.
    pub second_curve: bool,
    /// How far that point is from the tip where the input does not say, mm.
    pub length: f64,
    /// Whether arcs are arcs while the tip is led, where the tool keeps its direction.
    pub arcs: bool,
    /// The height of the tip, mm, at which the tool may turn before it goes to the work; none: the greatest Z of the
    /// program.
    pub safe_height: Option<f64>,
    /// About which axes the angles of a tilted plane turn.
    pub plane_order: Order,
    /// How the tool comes to a tilted plane from its home.
    pub plane_approach: PlaneApproach,
}

/// How the tool comes from its home to the first place of a tilted plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum PlaneApproach {
    /// X and Y of the plane first, then Z along the tool: where the table tilts, X and Y are level and Z waits at home.
    Over,
    /// X, Y and Z at once: where the head tilts, X and Y of the plane would take the machine's Z down before the tool has
    /// come out to its side.
    Together,
}

/// How a control turns the tool from one direction to another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// In the plane of both, evenly: the great circle.
    GreatCircle,
    /// Both rotary axes go evenly: C about Z and a tilt against Z, as in AC and BC heads and tables.
    Tilt,
}

/// How F counts rotary axes in a block that moves linear ones too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RotaryFeed {
    /// F is the speed along the path of the linear axes; rotary ones go along.
    Free,
    /// F is the speed along the path of all axes, a degree counted as a millimetre.
    DegreesAsMm,
    /// F is the speed along the path of all axes, rotary ones counted in mm at the cutter's surface.
    Surface,
    /// Lines have their time as F, in 1/min; other blocks move linear axes only.
    InverseTime,
}

/// What one axis can do.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisLimits {
    /// Whether a rotary axis wraps at 360° instead of counting on.
    pub modulo: bool,
    /// The least position, mm or degrees.
    pub min: Option<f64>,
    /// The greatest position, mm or degrees.
    pub max: Option<f64>,
    /// The greatest speed at feed, mm/min or degrees/min.
    pub max_speed: Option<f64>,
    /// The greatest acceleration at feed, mm/s² or degrees/s².
    pub max_acceleration: Option<f64>,
    /// The greatest step in speed at the joint of two blocks, mm/min or degrees/min.
    pub max_step: Option<f64>,
    /// Where it is clear in machine coordinates, mm.
    pub home: Option<f64>,
    /// Its decimals, where they are not those of its kind.
    pub digits: Option<u8>,
    /// Whether the control counts the other way.
    pub reversed: bool,
    /// What moves with it.
    pub moves: Moves,
}

/// What moves with an axis. Programs say how the wheel moves relative to the work, either way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Moves {
    /// The wheel.
    #[default]
    Wheel,
    /// The work.
    Work,
}

/// How many decimals an address takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Digits {
    /// Linear axes.
    pub linear: u8,
    /// Rotary axes.
    pub rotary: u8,
    /// Feed and spindle speed.
    pub feed: u8,
    /// PL of BSPLINE, K of G06.2.
    pub knot: u8,
    /// PW, R.
    pub weight: u8,
}

/// How text is spelled.
#[derive(Clone, Debug, PartialEq, Eq)]
#[allow(clippy::struct_excessive_bools, reason = "each is a key of the machine file")]
pub struct Text {
    /// `X30.` instead of `X30`.
    pub point_always: bool,
    /// `X+30` instead of `X30`.
    pub sign_always: bool,
    /// `X0.5` instead of `X.5`.
    pub leading_zero: bool,
    /// What 1 without a point is, mm or degrees, on a control that may count least increments; none: nobody said.
    pub without_point: Option<Decimal>,
    /// `G1 X30` instead of `G1X30`.
    pub spaces: bool,
    /// The first block number.
    pub number_start: u32,
    /// What it grows by; 0 for none at all.
    pub number_step: u32,
    /// Whether comments have numbers too.
    pub number_comments: bool,
    /// What ends a line.
    pub line_end: LineEnd,
    /// The most characters of a comment.
    pub comment_length: usize,
    /// The signs that a comment may have beside capitals, digits and blanks.
    pub comment_signs: String,
    /// Whether comments may have small letters.
    pub comment_lower: bool,
    /// The usual extension of a program file.
    pub extension: String,
}

impl Text {
    /// How numbers are spelled.
    pub fn spelling(&self) -> Spelling {
        Spelling {
            point_always: self.point_always,
            sign_always: self.sign_always,
            leading_zero: self.leading_zero,
        }
    }
}

/// What ends a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineEnd {
    /// A line feed.
    Lf,
    /// A carriage return and a line feed.
    CrLf,
}

impl LineEnd {
    /// The characters.
    #[inline]
    pub fn text(self) -> &'static str {
        match self {
            LineEnd::Lf => "\n",
            LineEnd::CrLf => "\r\n",
        }
    }
}

/// Which parameters a program may use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parameters {
    /// The number of the first.
    pub first: u32,
    /// The number of the last.
    pub last: u32,
}

/// Where the first control point of a Sinumerik B-spline stands. Both are the same curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FirstPoint {
    /// In the block before: where the tool is.
    Before,
    /// There and in a block of its own, as CATIA states it.
    Repeated,
}

/// What splines a machine takes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Spline {
    /// Which axes spline blocks may move.
    pub axes: Vec<Axis>,
    /// The greatest degree of polynomial blocks.
    pub poly_degree: usize,
    /// The most numbers of a polynomial block: ends and coefficients together.
    pub poly_words: usize,
    /// Whether all axes of a spline block share one parameter on the control.
    pub shared_parameter: bool,
    /// The fewest blocks a B-spline may have.
    pub bspline_min_blocks: usize,
    /// Where the first control point of a B-spline stands.
    pub first_point: FirstPoint,
    /// The word for the start condition of through-point splines.
    pub begin: String,
    /// The word for their end condition.
    pub end: String,
}

/// The lines round a program.
#[derive(Clone, Debug, PartialEq, Eq)]
#[allow(
    clippy::struct_excessive_bools,
    reason = "each is a key of the machine file, or says what its lines do"
)]
pub struct Frame {
    /// Before the first step.
    pub header: Vec<Template>,
    /// Whether comments behind the header say what to set up.
    pub setup: bool,
    /// Behind the first retraction.
    pub start: Vec<Template>,
    /// The retraction of an axis in machine coordinates.
    pub home: Vec<Template>,
    /// The axis that these lines name themselves; none where any is filled in.
    pub home_axis: Option<Axis>,
    /// A tool call.
    pub tool: Vec<Template>,
    /// The spindle's start.
    pub spindle: Vec<Template>,
    /// A tool call and the spindle's start in one, where a control wants them so; empty: one after the other.
    pub tool_spindle: Vec<Template>,
    /// The coolant's start.
    pub coolant: Vec<Template>,
    /// Its end, between moves.
    pub coolant_stop: Vec<Template>,
    /// The spindle's stop, between moves.
    pub spindle_stop: Vec<Template>,
    /// A stop of the program.
    pub stop: Vec<Template>,
    /// A stop where the operator asked for it.
    pub optional_stop: Vec<Template>,
    /// A dwell.
    pub dwell: Vec<Template>,
    /// What leads the tip of the tool in five axes.
    pub tip_control: Vec<Template>,
    /// What ends that.
    pub tip_control_end: Vec<Template>,
    /// Whether these lines go to the park place first.
    pub tip_end_parks: bool,
    /// What ends the length of a tool, at the park place.
    pub length_end: Vec<Template>,
    /// Whether that may move an axis by the length.
    pub length_end_moves: bool,
    /// What tilts the plane in which positions count, and turns the tool square to it.
    pub plane: Vec<Template>,
    /// What ends that.
    pub plane_end: Vec<Template>,
    /// A work offset.
    pub shift: Vec<Template>,
    /// Behind lines that went round in steps, where an axis wraps.
    pub unwind: Vec<Template>,
    /// After the last step.
    pub footer: Vec<Template>,
    /// Whether sections that are alike but for a work offset are written once and called.
    pub subprograms: bool,
    /// The call of a subprogram.
    pub call: Template,
    /// The first line of a subprogram.
    pub begin: Template,
    /// The last line of a subprogram.
    pub end: Template,
    /// The last lines of the text, behind subprograms.
    pub close: Vec<Template>,
}

impl Frame {
    /// All lists of lines, by their keys.
    pub fn lists(&self) -> [(&'static str, &[Template]); 21] {
        [
            ("header", &self.header),
            ("start", &self.start),
            ("home", &self.home),
            ("tool", &self.tool),
            ("spindle", &self.spindle),
            ("tool_spindle", &self.tool_spindle),
            ("coolant", &self.coolant),
            ("coolant_stop", &self.coolant_stop),
            ("spindle_stop", &self.spindle_stop),
            ("stop", &self.stop),
            ("optional_stop", &self.optional_stop),
            ("dwell", &self.dwell),
            ("tip_control", &self.tip_control),
            ("tip_control_end", &self.tip_control_end),
            ("length_end", &self.length_end),
            ("plane", &self.plane),
            ("plane_end", &self.plane_end),
            ("shift", &self.shift),
            ("unwind", &self.unwind),
            ("footer", &self.footer),
            ("close", &self.close),
        ]
    }

    /// The lines of a switch or a dwell.
    pub fn auxiliary<N>(&self, auxiliary: &Auxiliary<N>) -> &[Template] {
        match auxiliary {
            Auxiliary::CoolantStop => &self.coolant_stop,
            Auxiliary::SpindleStop => &self.spindle_stop,
            Auxiliary::Stop => &self.stop,
            Auxiliary::OptionalStop => &self.optional_stop,
            Auxiliary::Dwell(_) => &self.dwell,
            Auxiliary::TipControl => &self.tip_control,
            Auxiliary::TipControlEnd => &self.tip_control_end,
            Auxiliary::LengthEnd => &self.length_end,
            Auxiliary::Plane(_) => &self.plane,
            Auxiliary::PlaneEnd => &self.plane_end,
        }
    }
}
