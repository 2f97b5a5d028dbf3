//! Heidenhain Klartext with SPL: iTNC 530, TNC 426/430.
//!
//! Sources: Heidenhain *iTNC 530 conversational programming* 60642x-04 pp.539-541 and 340 49x-03/-06/-08, *TNC 426/430*
//! 280 476 p.173; details and their certainty in `docs/dialects/heidenhain.md`.
//!
//! # How its curves differ from ours
//!
//! One might expect a polynomial block to start from where the tool is and to say how it goes on from there. An SPL
//! block runs backwards: t falls from 1 at the start to 0 at the end, the constant term is the *end*, and the start is
//! in the coefficients.
//!
//! ```text
//! A(t) = K3 t³ + K2 t² + K1 t + A        t from 1 (start) to 0 (end), each axis its own K3 K2 K1, all on one t
//! A(0) = A                               the end, as programmed
//! A(1) = A + K1 + K2 + K3                the start: where the tool is, to 1 µm, or the control refuses the block
//! ```
//!
//! With our s = 1 − t, f(s) = a₀ + a₁s + a₂s² + a₃s³, the change of basis is exact in decimals both ways:
//!
//! ```text
//! K3 = −a₃        K2 = a₂ + 3a₃        K1 = start − end − K2 − K3  (= −a₁ − 2a₂ − 3a₃)
//! a₃ = −K3        a₂ = K2 + 3 K3       a₁ = end − start − a₂ − a₃
//! ```
//!
//! The pass that rounds makes A + K1 + K2 + K3 equal the end of the block before *in decimal*, so what is written here
//! always closes exactly. Programs of others close to within the 1 µm; the reader says how it takes that up.
//!
//! The reference curve (0,0) (10,0) (30,24) (60,0) (90,−24) (110,0) (120,0) on knots 0⁴ 30 60 90 120⁴, a block a span
//! (a control shows the continued lines as one block); in the middle of the blocks y is 6.25, 10.75, −10.75, −6.25:
//!
//! ```text
//! 1 L X+0 Y+0 F1000
//! 2 SPL X+30 Y+14 ~
//!   K3X+0 K2X+0 K1X-3.0E+1 ~
//!   K3Y+2.2E+1 K2Y-3.0E+1 K1Y-6
//! 3 SPL X+60 Y+0 ~
//!   K3X+0 K2X+0 K1X-3.0E+1 ~
//!   K3Y-1.0E+1 K2Y+0 K1Y+2.4E+1
//! 4 SPL X+90 Y-14 ~
//!   K3X+0 K2X+0 K1X-3.0E+1 ~
//!   K3Y-1.0E+1 K2Y+3.0E+1 K1Y-6
//! 5 SPL X+120 Y+0 ~
//!   K3X+0 K2X+0 K1X-3.0E+1 ~
//!   K3Y+2.2E+1 K2Y-3.6E+1 K1Y+0
//! ```
//!
//! A K has nine digits, one of them before the point; from ten on it needs an exponent.
//!
//! **Five axes.** Under M128 the tip is led, and `LN X… Y… Z… TX… TY… TZ…` states the direction of the tool towards the spindle,
//! of length 1. What SPL does under M128 no page says, so that splines that turn the tool become LN blocks.
//!
//! # Modal words
//!
//! | word | modal |
//! |---|---|
//! | L, LN, SPL | never: every block says what it is |
//! | TX TY TZ | never: all three stand in every LN block |
//! | X Y Z A | a coordinate left out stays |
//! | F, R0 | yes |
//! | FMAX | never: the F before it holds again in the next block |
//! | K3 K2 K1 | never: all three stand beside every coordinate of SPL |

mod read;
mod words;
mod write;

use super::{ArcWord, Arcs, Dialect, Form, Granted, Motion, Parameter, Round, is_device};
use crate::diagnostic::Diagnostics;
use crate::geom::arc::Plane;

/// The dialect.
pub const DIALECT: Dialect = Dialect {
    name: "heidenhain",
    about: "Heidenhain iTNC 530, TNC 426/430 in Klartext",
    motions: &[
        Motion {
            name: "spl",
            form: Form::Polynomial { closing: true },
            about: "SPL: cubic polynomial blocks",
            needs: "spline interpolation, option 2",
        },
        Motion { name: "linear", form: Form::Lines, about: "L", needs: "" },
    ],
    nurbs: None,
    naming: ("1 to 24 letters, digits, underscores and hyphens; not that of a device (CON, COM1)", is_name),
    file_names: true,
    parameter: Parameter { letter: 'Q', assign: "FN 0: Q{n}={value}", word: |n| format!("Q{n}") },
    granted: &[
        Granted { what: "coordinates are in mm", right: &["MM"], wrong: &["INCH"] },
        Granted { what: "F is per minute", right: &["M137"], wrong: &["M136"] },
        Granted { what: "the path is that of the tool's centre", right: &["R0"], wrong: &["RL", "RR"] },
        Granted { what: "rotary axes go as programmed", right: &["M127"], wrong: &["M126"] },
    ],
    least_increments: false,
    passes_labels: true,
    replaces_shift: None,
    adds_shift: &[],
    lines: |_| Diagnostics::new(),
    in_machine: &["M91", "M92", "M140"],
    ends_length: &[],
    inverse_time: false,
    round: Round::Step,
    arcs: Arcs {
        // C and CP lie in the working plane, square to the tool.
        word: |kind, _| match kind.plane {
            Some(Plane::Xy) => Some(if kind.helix || kind.turns { ArcWord::Turn } else { ArcWord::Center }),
            Some(Plane::Zx | Plane::Yz) | None => None,
        },
        // IPA is −5400 to 5400 degrees (TNC 426/430 280 476 p.154).
        most_turns: 15,
        planes: false,
        directed: true,
    },
    direction: ["TX", "TY", "TZ"],
    turn: None,
    directed_places: true,
    free_axes: None,
    second_curve: false,
    write: write::write,
    read: read::read,
};

/// A file name that every version takes: the controls allow a few signs more.
fn is_name(name: &str) -> bool {
    !is_device(name)
        && (1..=24).contains(&name.len())
        && name.bytes().all(|b| b.is_ascii_alphanumeric() || matches!(b, b'_' | b'-'))
}
