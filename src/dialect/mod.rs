//! Dialects: how one family of controls spells a program, and how its text is read back.
//!
//! A dialect is a value. Its reader and its writer live in one folder because they are inverses and change together.
//! A *motion* is a dialect's own name for a form of curve: `poly` and `spl` are both polynomial blocks.
//!
//! | module | what |
//! |---|---|
//! | [`arc`] | G2 and G3 with I J K |
//! | [`assemble`] | moves read one by one become a program |
//! | [`block`] | lines, numbers and words that all dialects share |
//! | `counting` | from where places count: shifts, planes, work offsets |
//! | [`frame`] | the fixed lines round a program, read back |
//! | [`modal`] | what a writer remembers between blocks |
//! | [`parts`] | a program with the machine's lines round it, subprograms too |
//! | [`stated`] | work offset, and how exactly the control runs |
//! | [`sinumerik`] | POLY, BSPLINE, ASPLINE, CSPLINE |
//! | [`heidenhain`] | SPL |
//! | [`iso`] | Mazak G06.1, G06.2 |

mod alike;
pub mod arc;
pub mod assemble;
pub mod block;
mod counting;
pub mod frame;
pub mod heidenhain;
pub mod iso;
pub mod modal;
mod outline;
pub mod parts;
pub mod sinumerik;
pub mod stated;

use crate::diagnostic::{Diagnostics, Warned};
use crate::geom::arc::Plane;
use crate::ir::{Decimals, ThroughKind};
use crate::machine::Machine;
use crate::pass::check::Legal;
use crate::source::SourceId;
use stated::Stated;
use std::ops::Range;

/// How a family of controls is written to and read.
#[allow(clippy::struct_excessive_bools, reason = "each is a fact of the control")]
pub struct Dialect {
    /// Its name.
    pub name: &'static str,
    /// What it is, in one line.
    pub about: &'static str,
    /// Its motions; `auto` prefers the earlier at equal numbers of blocks.
    pub motions: &'static [Motion],
    /// What its B-splines take; none where it has none.
    pub nurbs: Option<NurbsRules>,
    /// What a program may be called, in words, and whether a name is that.
    pub naming: (&'static str, fn(&str) -> bool),
    /// Whether a program is kept in a file of its name, so that the name is not only a remark.
    pub file_names: bool,
    /// How parameters of a program are spelled.
    pub parameter: Parameter,
    /// What every program takes for granted, so that no line round it may say otherwise.
    pub granted: &'static [Granted],
    /// Whether a number without a point may count least increments: X30 as 0.030 mm.
    pub least_increments: bool,
    /// Whether what is called may stand within the program, between labels.
    pub passes_labels: bool,
    /// The word of a work offset line that replaces the whole shift before it, also of axes that it does not name.
    pub replaces_shift: Option<&'static str>,
    /// Words that make no work offset by themselves: they add to the one before, or depend on where the tool is.
    pub adds_shift: &'static [&'static str],
    /// What its words would make of the lines of a machine file, where that is wrong.
    pub lines: fn(&Machine) -> Diagnostics,
    /// The words by which a move counts in machine coordinates, or goes to a fixed place.
    pub in_machine: &'static [&'static str],
    /// The words that end the length of a tool.
    pub ends_length: &'static [&'static str],
    /// Whether F can be inverse time.
    pub inverse_time: bool,
    /// How lines go round past 360 degrees on an axis that wraps.
    pub round: Round,
    /// What its arcs take.
    pub arcs: Arcs,
    /// The words of the three components of the tool's direction.
    pub direction: [&'static str; 3],
    /// The words of how the tool turns between two directions, in their plane or with the rotary axes evenly, where it has some.
    pub turn: Option<[&'static str; 2]>,
    /// Whether a straight block that states the tool's direction states all of X Y Z too.
    pub directed_places: bool,
    /// What the control has for how fast axes outside F may be, where those that F counts hardly move.
    pub free_axes: Option<&'static str>,
    /// Whether it has words for the curve of a second point of the tool.
    pub second_curve: bool,
    /// Spells a legal program.
    pub write: fn(&Legal, &Machine) -> String,
    /// Reads a program.
    pub read: fn(&str, SourceId, &Machine) -> Result<Warned<Reading>, Diagnostics>,
}

impl std::fmt::Debug for Dialect {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name)
    }
}

/// How lines go round past 360 degrees on an axis that wraps, in steps below 180.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Round {
    /// The place within 0 to 360, in a word that asks for the short way: `A=DC(5)`.
    Shortest,
    /// The step: `IA+12`.
    Step,
    /// The place within 0 to 360: the control takes the short way.
    Place,
}

/// Something that every program takes for granted.
pub struct Granted {
    /// What.
    pub what: &'static str,
    /// The words that say so.
    pub right: &'static [&'static str],
    /// The words that say otherwise.
    pub wrong: &'static [&'static str],
}

/// How parameters of a program are spelled.
pub struct Parameter {
    /// The letter before its number.
    pub letter: char,
    /// The line that sets it: `{n}` is its number, `{value}` its value.
    pub assign: &'static str,
    /// What stands behind an address instead of a value.
    pub word: fn(u32) -> String,
}

/// What a reader makes of a text.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// The program.
    pub decimals: Decimals,
    /// Whether the whole header of the machine file stands before it.
    pub header: bool,
    /// Whether the whole footer stands after it.
    pub footer: bool,
    /// The first block whose number is not the one that the machine file gives it.
    pub misnumbered: Option<Range<usize>>,
    /// What it states beside its moves.
    pub stated: Box<Stated>,
}

/// A dialect's own name for a form of curve.
#[derive(Debug, PartialEq, Eq)]
pub struct Motion {
    /// Its name.
    pub name: &'static str,
    /// The form.
    pub form: Form,
    /// What it is, in one line.
    pub about: &'static str,
    /// The option that the control needs for it; empty for none.
    pub needs: &'static str,
}

/// What the B-splines of a dialect take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NurbsRules {
    /// The least and the greatest degree that is written.
    pub degrees: (usize, usize),
    /// The greatest weight.
    pub greatest_weight: f64,
    /// Whether the first weight is 1 because there is no place to write it.
    pub starts_with_one: bool,
}

/// What the arcs of a dialect take.
#[derive(Clone, Copy)]
pub struct Arcs {
    /// What it has for an arc of a kind on a machine; where it has nothing, lines.
    pub word: fn(ArcKind, &Machine) -> Option<ArcWord>,
    /// The most whole turns of one block.
    pub most_turns: u32,
    /// Whether it has words that choose the plane of an arc.
    pub planes: bool,
    /// Whether an arc can stand beside the words of the tool's direction.
    pub directed: bool,
}

/// What matters of an arc to the words that a control has for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ArcKind {
    /// The plane of the machine that it lies in or goes along, where there is one.
    pub plane: Option<Plane>,
    /// Whether it leaves its plane as a helix.
    pub helix: bool,
    /// Whether it is more than a whole turn.
    pub turns: bool,
}

/// What a block says about an arc beside its end; see [`ArcBy`](crate::ir::ArcBy).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArcWord {
    /// Its centre, and whole turns before the way to its end.
    Center,
    /// A place on the way. A whole turn becomes two halves.
    Way,
    /// Its centre and how far it turns.
    Turn,
}

/// The forms that a curve can take on a control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Straight lines.
    Lines,
    /// Polynomial blocks.
    Polynomial {
        /// Whether a block states its own start through its coefficients, as SPL does, so that they must close on
        /// the block before exactly.
        closing: bool,
    },
    /// B-splines.
    Nurbs,
    /// The control's own curve through points.
    Through(ThroughKind),
}

/// All dialects.
pub const DIALECTS: &[Dialect] = &[sinumerik::DIALECT, heidenhain::DIALECT, iso::MAZAK];

/// Names that no file has on the computers through which programs go: those of their devices, in capitals or not.
fn is_device(name: &str) -> bool {
    let name = name.to_ascii_uppercase();
    let numbered = |device: &str| {
        name.strip_prefix(device).is_some_and(|number| matches!(number.as_bytes(), [b'1'..=b'9']))
    };
    ["CON", "PRN", "AUX", "NUL"].contains(&name.as_str()) || numbered("COM") || numbered("LPT")
}

/// The dialect of a name.
pub fn find(name: &str) -> Option<&'static Dialect> {
    DIALECTS.iter().find(|dialect| dialect.name == name)
}

impl Dialect {
    /// The motion of a name.
    pub fn motion(&self, name: &str) -> Option<&'static Motion> {
        self.motions.iter().find(|motion| motion.name == name)
    }

    /// The motion of a form, the first of its kind.
    pub fn motion_of(&self, form: Form) -> Option<&'static Motion> {
        self.motions.iter().find(|motion| motion.form == form)
    }

    /// The names of its motions, for a message.
    pub fn motion_names(&self) -> String {
        self.motions.iter().map(|motion| motion.name).collect::<Vec<_>>().join(", ")
    }
}
