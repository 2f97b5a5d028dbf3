//! Machine files: what one machine takes, as data.
//!
//! A machine file is TOML; the built-ins have the same form and are embedded. A file may say
//! `extends = "sinumerik"` and then states only what differs. What a control's manual leaves open is a key here,
//! never a constant in the code. `splinepost machines --show NAME` prints a built-in with its comments: the best
//! start for a file of one's own.

mod file;
mod keys;
pub mod template;

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::dialect::{Dialect, Motion};
use crate::source::SourceId;
use crate::units::{Axes, Axis, Kind, MAX_AXES};
pub use keys::{KEYS, schema};
use std::collections::BTreeMap;
use template::Template;

/// The machines that are built in, with their files.
pub const BUILT_IN: &[(&str, &str)] = &[
    ("sinumerik", include_str!("sinumerik.toml")),
    ("sinumerik-840d", include_str!("sinumerik-840d.toml")),
    ("heidenhain", include_str!("heidenhain.toml")),
    ("mazak", include_str!("mazak.toml")),
];

/// The file of a built-in machine.
pub fn built_in(name: &str) -> Option<&'static str> {
    BUILT_IN.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}

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
    /// Its axes.
    pub axes: Axes,
    /// What each axis can do, where the file says.
    pub limits: BTreeMap<Axis, AxisLimits>,
    /// Decimals.
    pub digits: Digits,
    /// Spelling.
    pub text: Text,
    /// How F counts rotary axes.
    pub rotary_feed: RotaryFeed,
    /// How long the control takes to make a block ready, ms.
    pub block_time: Option<f64>,
    /// What its splines take.
    pub spline: Spline,
    /// The lines round a program.
    pub frame: Frame,
}

/// How F counts rotary axes in a block that moves linear ones too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RotaryFeed {
    /// F is the speed along the path of the linear axes; rotary ones go along.
    Free,
    /// F is the speed along the path of all axes, a degree counted as a millimetre.
    DegreesAsMm,
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
    /// The greatest acceleration, mm/s² or degrees/s².
    pub max_acceleration: Option<f64>,
    /// The greatest step in speed at the joint of two blocks, mm/min or degrees/min.
    pub max_step: Option<f64>,
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
pub struct Text {
    /// `X30.` instead of `X30`.
    pub point_always: bool,
    /// `X+30` instead of `X30`.
    pub sign_always: bool,
    /// The first block number.
    pub number_start: u32,
    /// What it grows by; 0 for none at all.
    pub number_step: u32,
    /// The usual extension of a program file.
    pub extension: String,
}

/// What splines a machine takes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Spline {
    /// Which axes spline blocks may move.
    pub axes: Vec<Axis>,
    /// The greatest degree of polynomial blocks.
    pub poly_degree: usize,
    /// Whether all axes of a spline block share one parameter on the control.
    pub shared_parameter: bool,
    /// The fewest blocks a B-spline may have.
    pub bspline_min_blocks: usize,
    /// The word for the start condition of through-point splines.
    pub begin: String,
    /// The word for their end condition.
    pub end: String,
}

/// The lines round a program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Before the first step.
    pub header: Vec<Template>,
    /// A tool call.
    pub tool: Vec<Template>,
    /// The spindle's start.
    pub spindle: Vec<Template>,
    /// A tool call and the spindle's start in one, where a control wants them so; empty: one after the other.
    pub tool_spindle: Vec<Template>,
    /// After the last step.
    pub footer: Vec<Template>,
}

impl Machine {
    /// A built-in machine.
    pub fn built_in(name: &str) -> Option<Machine> {
        // A test reads every built-in, so that an error cannot hide here.
        built_in(name).and_then(|text| Machine::parse(text, SourceId::INPUT).ok())
    }

    /// Reads a machine file.
    ///
    /// # Errors
    /// It is not TOML, has unknown keys or values that no machine can have, or extends a machine that is not built in.
    pub fn parse(text: &str, source: SourceId) -> Result<Machine, Diagnostics> {
        file::parse(text, source)
    }

    /// What an axis can do; nothing is known of one that the file does not speak of.
    pub fn limits(&self, axis: Axis) -> AxisLimits {
        self.limits.get(&axis).copied().unwrap_or_default()
    }

    /// The decimals of each of the program's axes.
    pub fn axis_digits(&self) -> [u8; MAX_AXES] {
        let mut digits = [0; MAX_AXES];
        for (i, (_, kind)) in self.axes.as_slice().iter().enumerate() {
            digits[i] = match kind {
                Kind::Linear | Kind::Direction => self.digits.linear,
                Kind::Rotary => self.digits.rotary,
            };
        }
        digits
    }

    /// The machine with these axes only, in this order; the program names no others, so they rest.
    ///
    /// # Errors
    /// The machine lacks one of them, or counts it as another kind.
    pub fn with_axes(&self, axes: &Axes) -> Result<Machine, Diagnostics> {
        for (axis, kind) in axes.as_slice() {
            let own = self.axes.index_of(*axis).map(|i| self.axes.kind(i));
            if own != Some(*kind) {
                let what = match kind {
                    Kind::Linear => "linear",
                    Kind::Rotary => "rotary",
                    Kind::Direction => "direction",
                };
                return Err(Diagnostic::error(
                    "axis-missing",
                    format!("machine `{}` has no {what} axis {axis}", self.name),
                )
                .hint("name it under [axes] in the machine file")
                .into());
            }
        }
        Ok(Machine { axes: *axes, ..self.clone() })
    }

    /// The axes that spline blocks may not move, of those given.
    pub fn axes_without_spline(&self, moving: &[Axis]) -> Vec<Axis> {
        moving.iter().copied().filter(|axis| !self.spline.axes.contains(axis)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_built_in_reads() {
        for (name, text) in BUILT_IN {
            let machine = Machine::parse(text, SourceId::INPUT).unwrap_or_else(|e| panic!("{name}: {e:?}"));
            assert_eq!(machine.name, *name);
        }
    }

    #[test]
    fn a_file_states_only_what_differs() {
        let text = "extends = \"mazak\"\nname = \"mine\"\n[spline]\naxes = [\"X\", \"Y\", \"Z\", \"A\"]\n";
        let machine = Machine::parse(text, SourceId::INPUT).unwrap();
        assert_eq!((machine.name.as_str(), machine.spline.axes.len(), machine.digits.linear), ("mine", 4, 4));
    }

    #[test]
    fn wrong_values_are_reported_together() {
        let text =
            "extends = \"sinumerik\"\nmotion = \"spl\"\n[digits]\nlinear = 12\n[spline]\npoly_degree = 9\n";
        let ids: Vec<&str> =
            Machine::parse(text, SourceId::INPUT).unwrap_err().0.iter().map(|d| d.id).collect();
        assert_eq!(ids, ["motion-unknown", "digits-range", "degree-range"]);
        assert_eq!(
            Machine::parse("extends = \"fanuk\"", SourceId::INPUT).unwrap_err().0[0].id,
            "machine-unknown"
        );
        assert!(Machine::parse("", SourceId::INPUT).unwrap_err().has_errors());
    }
}
