//! Sinumerik 840D, 840D sl, ONE.
//!
//! Sources: Siemens *NC Programming* 12.2019 and *Job Planning* 07.2010; details and their certainty in
//! `docs/dialects/sinumerik.md`.
//!
//! # How its curves differ from ours
//!
//! **POLY.** One might expect a polynomial block to state all its coefficients. It states the end and a₂, a₃ (to a₅):
//!
//! ```text
//! f(p) = a₀ + a₁p + a₂p² + a₃p³ + a₄p⁴ + a₅p⁵        0 ≤ p ≤ PL
//! a₀ = where the block before ended       a₁ = (xe − a₀ − a₂PL² − a₃PL³ − a₄PL⁴ − a₅PL⁵)/PL, by the control
//! ```
//!
//! so rounding can open no gap; it turns the start tangent a little. An axis given as a plain word is linear in p.
//!
//! A denominator `PO[]=(De,d₂,d₃)` divides X, Y and Z, D(p) = 1 + d₁p + d₂p² + … with D(PL) = De. The end stays the true
//! position, so that N(PL) = xe De. The manual's quarter circle, X = (10 − 10p²)/(1 + p²), Y = 20p/(1 + p²):
//!
//! ```text
//! N10 POLY X10 Y0 F100
//! N20 PO[X]=(0,-10) PO[Y]=(10) PO[]=(2,1)
//! ```
//!
//! **BSPLINE.** One might expect a knot vector. There is a distance `PL` on each block instead, and the first control
//! point is where the block before ended. With knots t_0 … t_{n+3} of a clamped cubic of points P_0 … P_{n−1},
//! block j (j = 1 … n−1) carries
//!
//! ```text
//! PL_j = t_{j+2} − t_{j+1}
//! ```
//!
//! the *middle* knot of the three that belong to P_j; the first and the last block carry PL=0. PL is not modal: it
//! stands on every block, zeros included. The reference curve (0,0) (10,0) (30,24) (60,0) (90,−24) (110,0) (120,0) on
//! knots 0⁴ 30 60 90 120⁴:
//!
//! ```text
//! N10 G1 X0 Y0 F1000
//! N20 BSPLINE SD=3 X10 Y0 PL=0
//! N30 X30 Y24 PL=30
//! N40 X60 Y0 PL=30
//! N50 X90 Y-24 PL=30
//! N60 X110 Y0 PL=30
//! N70 X120 Y0 PL=0
//! ```
//!
//! **Axes outside FGROUP**, as a rotary A beside the path X Y Z, follow the *arc length* of the path unless `UPATH`
//! makes them follow the *parameter*. So `UPATH` stands before each run of POLY or spline blocks that moves one, and
//! `SPLINEPATH(1,…)` names every axis of a spline run.
//!
//! **Five axes.** One might expect the direction of the tool to be given as angles. TRAORI leads the tip, and `A3= B3= C3=`
//! are a vector towards the spindle whose length means nothing; components that are left out count as zero, so that all
//! three stand in every block. Under ORICURVE the direction is that from the tip to a second point `XH= YH= ZH=`, which runs
//! on a curve of its own with the knots and weights of the tip's: with D = H − P, both are one curve in six coordinates, and
//!
//! ```text
//! H_i = P_i + D_i                 BSPLINE: control points
//! PO[XH]=(P + D, a₂ + a₂′, …)     POLY: ends and coefficients
//! ```
//!
//! A second curve starts where the last block left H, so that a straight block that moves nothing states it first:
//!
//! ```text
//! N10 ORICURVE
//! N20 G1 X0 Y0 Z0 XH=0 YH=0 ZH=100 F800
//! N30 BSPLINE SD=3 X10 Y0 Z0 XH=10 YH=3 ZH=100 PL=0
//! ```
//!
//! # Modal words
//!
//! | word | modal |
//! |---|---|
//! | G0 G1 POLY BSPLINE ASPLINE CSPLINE | yes, one group |
//! | X Y Z A | a word left out stays |
//! | F, SD, UPATH, SPLINEPATH | yes |
//! | ORIVECT ORIAXES ORICURVE | yes, one group |
//! | G17 G18 G19 | yes; the plane of arcs |
//! | PL, PW, PO[…], I J K, TURN, I1 J1 K1, A3 B3 C3, XH YH ZH | never |

mod read;
mod words;
mod write;

use super::{ArcWord, Arcs, Dialect, Form, Granted, Motion, NurbsRules, Parameter, Round, is_device};
use crate::diagnostic::Diagnostics;
use crate::geom::arc::Plane;
use crate::ir::ThroughKind;
use crate::machine::Machine;

/// The dialect.
pub const DIALECT: Dialect = Dialect {
    name: "sinumerik",
    about: "Siemens Sinumerik 840D, 840D sl, ONE",
    motions: &[
        Motion {
            name: "poly",
            form: Form::Polynomial { closing: false },
            about: "POLY: polynomial blocks",
            needs: "polynomial interpolation",
        },
        Motion {
            name: "bspline",
            form: Form::Nurbs,
            about: "BSPLINE: control points and knot distances",
            needs: "spline interpolation",
        },
        Motion { name: "linear", form: Form::Lines, about: "G1", needs: "" },
        Motion {
            name: "aspline",
            form: Form::Through(ThroughKind::Akima),
            about: "ASPLINE: Akima spline through points",
            needs: "spline interpolation",
        },
        Motion {
            name: "cspline",
            form: Form::Through(ThroughKind::Cubic),
            about: "CSPLINE: cubic spline through points",
            needs: "spline interpolation",
        },
    ],
    // SD=2 is read in two ways, so that it is never written; PW is 0 to 3, and the first point has no block.
    nurbs: Some(NurbsRules { degrees: (3, 3), greatest_weight: 3.0, starts_with_one: true }),
    naming: (
        "1 to 24 letters, digits and underscores, the first two letters or an underscore and a letter; not that of a device (CON, COM1) or of a cycle (CYCLE800), nor in the control's own form (_N_, _MPF)",
        is_name,
    ),
    file_names: true,
    parameter: Parameter { letter: 'R', assign: "R{n}={value}", word: |n| format!("=R{n}") },
    granted: &[
        Granted { what: "coordinates are absolute", right: &["G90"], wrong: &["G91"] },
        Granted { what: "coordinates are in mm", right: &["G71", "G710"], wrong: &["G70", "G700"] },
        Granted { what: "F is per minute", right: &["G94"], wrong: &["G93", "G95", "G96", "G97"] },
        Granted { what: "the plane is XY", right: &["G17"], wrong: &["G18", "G19"] },
        Granted { what: "the path is that of the tool's centre", right: &["G40"], wrong: &["G41", "G42"] },
    ],
    least_increments: false,
    passes_labels: true,
    replaces_shift: Some("TRANS"),
    adds_shift: &["ATRANS", "ROT", "AROT", "SCALE", "ASCALE", "MIRROR", "AMIRROR", "G58", "G59", "G91"],
    lines: |_| Diagnostics::new(),
    in_machine: &["SUPA", "G53", "G153", "G74", "G75"],
    ends_length: &["D0"],
    inverse_time: false,
    round: Round::Shortest,
    arcs: Arcs {
        // In G18 and G19 the control takes the tool's length along Y and X, unless setting data 42940 says otherwise. CIP needs
        // no plane; it has no helices.
        word: |kind, machine| match kind.plane {
            Some(Plane::Xy) => Some(ArcWord::Center),
            Some(Plane::Zx | Plane::Yz) if takes_planes(machine) => Some(ArcWord::Center),
            Some(Plane::Zx | Plane::Yz) | None => (!kind.helix).then_some(ArcWord::Way),
        },
        // TURN= is 0 to 999.
        most_turns: 999,
        planes: true,
        directed: true,
    },
    direction: ["A3=", "B3=", "C3="],
    turn: Some(["ORIVECT", "ORIAXES"]),
    directed_places: false,
    free_axes: Some("MD22430"),
    second_curve: true,
    write: write::write,
    read: read::read,
};

/// Whether G18 and G19 are written and read: where the machine file says that they leave the tool's length where it is, and no
/// tip is led.
fn takes_planes(machine: &Machine) -> bool {
    machine.arc_planes && machine.axes.direction().is_none()
}

/// *NC Programming* 12.19 p.42. A program of a cycle's name would be what its own call finds; `_N_` and `_MPF` are what the
/// control puts round a name.
fn is_name(name: &str) -> bool {
    let capitals = name.to_ascii_uppercase();
    let cycle =
        capitals.strip_prefix("CYCLE").is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()));
    let internal = capitals.starts_with("_N_") || capitals.ends_with("_MPF") || capitals.ends_with("_SPF");
    if is_device(name) || cycle || internal {
        return false;
    }
    let bytes = name.as_bytes();
    let letter = |i: usize| bytes.get(i).is_some_and(u8::is_ascii_alphabetic);
    bytes.len() <= 24
        && bytes.iter().all(|b| b.is_ascii_alphanumeric() || *b == b'_')
        && ((letter(0) && letter(1)) || (bytes.first() == Some(&b'_') && letter(1)))
}
