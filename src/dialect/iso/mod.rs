//! ISO controls: Mazak Matrix and Smooth.
//!
//! Sources: Mitsubishi *M700V Programming Manual* 6.15 (Mazak's sibling text), Fanuc *15i/150i-MA Operator's Manual*
//! B-63324EN/03 4.17; what is Mazak's own and how sure it is stands in `docs/dialects/mazak.md`. Another control of this
//! family is another [`Dialect`] with its own table of motions over the same reader and writer: a motion that is not in
//! its table is not read.
//!
//! # How its curves differ from ours
//!
//! **G06.2.** One might expect a degree. P is the *order*, degree + 1, and 4 where it is missing. One might expect a
//! knot vector. There is a knot K on each block, and after the last control point `order` blocks of K alone. For
//! n + 1 control points P_0 … P_n of order p the knots t_0 … t_{n+p} are simply the K in the order of the text:
//!
//! ```text
//! block of P_i      K = t_i             i = 0 … n          t_i is the *first* knot of the support of N_i
//! closing block j   K = t_{n+1+j}       j = 0 … p−1
//!
//! P(t) = Σ N_{i,p}(t) w_i P_i / Σ N_{i,p}(t) w_i           t_{p−1} ≤ t ≤ t_{n+1}
//! ```
//!
//! The first p and the last p knots are equal, so that the curve starts at P_0 and ends at P_n. The first block states
//! P_0, which must be where the tool stands, and names every axis that the curve moves. The reference curve (0,0) (10,0)
//! (30,24) (60,0) (90,−24) (110,0) (120,0) on knots 0⁴ 30 60 90 120⁴:
//!
//! ```text
//! G1 X0. Y0. F1000.
//! G06.2 P4 K0. X0. Y0.
//! K0. X10. Y0.
//! K0. X30. Y24.
//! K0. X60. Y0.
//! K30. X90. Y-24.
//! K60. X110. Y0.
//! K90. X120. Y0.
//! K120.
//! K120.
//! K120.
//! K120.
//! ```
//!
//! Some files spell the degree, as P3 with four closing blocks. The closing blocks decide: as many as P are the order,
//! one more is the degree, and a warning says so.
//!
//! **G06.1** goes through points: the block with the word holds the first point after where the tool stands, the others
//! hold points alone. Its shape is the control's. The same word is another thing on a Fanuc 15i, where the first block
//! holds a tangent.
//!
//! **Five axes.** Behind G43.5 the tip is led, and I J K of a rapid or a straight move are no centre but the direction of the
//! tool towards the spindle. All three stand in every block.
//!
//! # Modal words
//!
//! | word | modal |
//! |---|---|
//! | G0 G1 G06.1 G06.2 | yes, one group; G06.2 is written for each curve all the same |
//! | X Y Z A | a word left out stays; within G06.2 every moving axis stands on every block |
//! | F | yes |
//! | P | of its curve |
//! | K, R; I J K of arcs and of the tool's direction | never |

mod lines;
mod read;
mod write;

use super::{ArcWord, Arcs, Dialect, Form, Granted, Motion, NurbsRules, Parameter, Round};
use crate::geom::arc::Plane;
use crate::ir::{ThroughKind, ToolCall};
use crate::machine::Machine;
use crate::machine::template::Template;

/// Mazak.
pub const MAZAK: Dialect = Dialect {
    name: "mazak",
    about: "Mazak Matrix and Smooth, EIA/ISO",
    motions: &[
        Motion {
            name: "g06.2",
            form: Form::Nurbs,
            about: "G06.2: control points, knots and weights",
            needs: "nurbs interpolation",
        },
        Motion { name: "linear", form: Form::Lines, about: "G1", needs: "" },
        Motion {
            name: "g06.1",
            form: Form::Through(ThroughKind::Fine),
            about: "G06.1: fine spline through points",
            needs: "fine spline interpolation",
        },
    ],
    nurbs: Some(NurbsRules { degrees: (1, 3), greatest_weight: 99.9999, starts_with_one: false }),
    naming: ("1 to 32 printable characters, no parentheses and no %", is_name),
    file_names: false,
    parameter: Parameter { letter: '#', assign: "#{n}={value}", word: |n| format!("#{n}") },
    granted: &[
        Granted { what: "coordinates are absolute", right: &["G90"], wrong: &["G91"] },
        Granted { what: "coordinates are in mm", right: &["G21"], wrong: &["G20"] },
        Granted { what: "F is per minute", right: &["G94"], wrong: &["G93", "G95"] },
        Granted { what: "the plane is XY", right: &["G17"], wrong: &["G18", "G19"] },
        Granted { what: "the path is that of the tool's centre", right: &["G40"], wrong: &["G41", "G42"] },
        Granted { what: "coordinates are not turned", right: &["G69"], wrong: &["G68"] },
        Granted { what: "coordinates are not scaled", right: &["G50"], wrong: &["G51"] },
        Granted { what: "coordinates are not mirrored", right: &["G50.1"], wrong: &["G51.1"] },
        // Type 1 of tool centre point control takes places of the rotary axes, and the writer has none.
        Granted {
            what: "I J K are the direction of the tool where its tip is led",
            right: &["G43.5"],
            wrong: &["G43.4"],
        },
    ],
    least_increments: true,
    passes_labels: false,
    replaces_shift: None,
    adds_shift: &["G91", "G92", "G51", "G51.1", "G68"],
    lines: lines::check,
    in_machine: &["G53", "G28", "G30"],
    ends_length: &["G49"],
    inverse_time: true,
    round: Round::Place,
    arcs: Arcs {
        // G18 and G19 turn the plane of arcs; the length of the tool stays along Z, as G43 took it.
        word: |kind, machine| match kind.plane {
            Some(Plane::Xy) => Some(ArcWord::Center),
            Some(Plane::Zx | Plane::Yz) => machine.arc_planes.then_some(ArcWord::Center),
            None => None,
        },
        most_turns: 1,
        planes: true,
        // I J K are the direction of the tool, and the centre of an arc.
        directed: false,
    },
    direction: ["I", "J", "K"],
    turn: None,
    directed_places: false,
    free_axes: None,
    second_curve: false,
    write: write::write,
    read: read::read,
};

/// The name stands in a comment: a parenthesis would end it, and % the tape.
fn is_name(name: &str) -> bool {
    let fits = |b: u8| (b' '..=b'~').contains(&b) && !matches!(b, b'(' | b')' | b'%');
    (1..=32).contains(&name.len()) && name.trim() == name && name.bytes().all(fits)
}

/// Whether a line of the text is a block, which can have a number. Comments, the program's number and % are none.
fn is_block(line: &str) -> bool {
    !line.starts_with(['(', '%', 'O'])
}

/// A machine without the lines that call the length of a tool, and what stands behind H in them.
///
/// Without an axis G43 moves Z by the offset on some controls, so that it is written into the first block of Z.
struct Offset {
    machine: Machine,
    /// In `tool`.
    tool: Option<Template>,
    /// In `tool_spindle`.
    tool_spindle: Option<Template>,
}

impl Offset {
    fn new(machine: &Machine) -> Offset {
        let mut machine = machine.filled();
        // What is wrong with them a machine file was refused for.
        let take = |lines: &mut Vec<Template>| {
            let register = lines::register(lines).ok().flatten();
            if register.is_some() {
                lines.pop();
            }
            register
        };
        let (tool, tool_spindle) = (take(&mut machine.frame.tool), take(&mut machine.frame.tool_spindle));
        Offset { machine, tool, tool_spindle }
    }
}

/// What stands behind H for the length of a tool.
fn register(template: &Template, call: ToolCall) -> String {
    template.fill(&[("tool", &call.number.to_string()), ("register", &call.register().to_string())])
}
