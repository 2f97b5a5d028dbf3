//! What each control remembers from one program to the next, and where it may not: the table of start and end.
//!
//! A mode is *off* where it is as every program takes it to be. Which words put it there, which take it away, and where it
//! must be off is data, so that a control is a table.

use super::super::words::Dialect;

/// Before what a mode is to be stated, since another program may have left it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Before {
    /// Any move, the retraction in machine coordinates too.
    Retraction,
    /// The first move that counts from the work.
    Move,
    /// Nothing: it stays within what turns it on.
    Nothing,
}

/// Where a mode must be off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Off {
    /// On the way home in machine coordinates.
    Home,
    /// Where a tool is changed.
    Tool,
    /// At the end of the program.
    End,
}

/// Something that stays in force. Patterns are words of the text; with a star behind, how they begin.
pub(super) struct Mode {
    pub(super) what: &'static str,
    pub(super) off: &'static [&'static str],
    pub(super) on: &'static [&'static str],
    pub(super) before: Before,
    pub(super) must: &'static [Off],
    /// Only where the machine file has lines that tilt a plane.
    pub(super) tilting: bool,
}

/// How a block moves, as far as it matters here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Motion {
    Rapid,
    Feed,
}

/// One control.
pub(super) struct Table {
    pub(super) modes: &'static [Mode],
    /// Words that change nothing that is held here.
    pub(super) free: &'static [&'static str],
    /// Words of motion.
    pub(super) motions: &'static [(&'static str, Motion)],
    /// The word that makes the places of a block those of the machine.
    pub(super) machine: &'static str,
    pub(super) spindle: (&'static [&'static str], &'static [&'static str]),
    pub(super) coolant: (&'static [&'static str], &'static [&'static str]),
    pub(super) change: &'static [&'static str],
    pub(super) finish: &'static [&'static str],
    /// What ends the length of a tool, and whether that may move an axis.
    pub(super) length_end: &'static [&'static str],
    pub(super) length_end_moves: bool,
    /// The words of the tool's direction.
    pub(super) direction: [&'static str; 3],
    /// The mode in which they stand, by its name.
    pub(super) tip: &'static str,
    /// Other addresses of numbers in a block that moves.
    pub(super) numbers: &'static [&'static str],
}

use Before::{Move, Nothing, Retraction};
use Off::{End, Home, Tool};

const fn mode(
    what: &'static str,
    off: &'static [&'static str],
    on: &'static [&'static str],
    before: Before,
    must: &'static [Off],
) -> Mode {
    Mode { what, off, on, before, must, tilting: false }
}

/// The table of a dialect.
pub(super) fn table(dialect: Dialect) -> &'static Table {
    match dialect {
        Dialect::Sinumerik => &SINUMERIK,
        Dialect::Heidenhain => &HEIDENHAIN,
        Dialect::Mazak => &MAZAK,
    }
}

/// Sinumerik 840D sl and ONE. G71 takes lengths in mm and leaves F in the unit of the basic system; G710 states both.
static SINUMERIK: Table = Table {
    modes: &[
        mode("plane", &["G17"], &["G18", "G19"], Move, &[Tool, End]),
        mode("unit of F", &["G710"], &["G70", "G71", "G700"], Retraction, &[Home, Tool, End]),
        mode("positions", &["G90"], &["G91"], Retraction, &[Home, Tool, End]),
        mode("feed", &["G94"], &["G93", "G95"], Move, &[Tool, End]),
        mode("radius", &["G40"], &["G41", "G42"], Retraction, &[Home, Tool, End]),
        mode("modal call", &["MCALL"], &["MCALL *"], Retraction, &[Home, Tool, End]),
        mode(
            "tip control",
            &["TRAFOOF"],
            &["TRAORI", "TRANSMIT", "TRACYL(*"],
            Retraction,
            &[Home, Tool, End],
        ),
        mode("programmed frame", &["TRANS"], &["ROT", "MIRROR", "SCALE"], Retraction, &[]),
        Mode {
            what: "tilted plane",
            off: &["CYCLE800()"],
            on: &["CYCLE800(*"],
            before: Move,
            must: &[Tool, End],
            tilting: true,
        },
        mode("work offset", &["G54", "G55", "G56", "G57", "G505"], &["G500", "G53"], Move, &[]),
        mode("exact stop", &["G64"], &["G9", "G60"], Move, &[End]),
        mode("compressor", &["COMPOF"], &["COMPON", "COMPCURV", "COMPCAD"], Move, &[End]),
        mode("way of F", &["FGROUP(*"], &["FGROUP()"], Move, &[]),
        mode("second curve", &["ORIVECT", "ORIAXES"], &["ORICURVE"], Nothing, &[Home, Tool, End]),
    ],
    free: &[
        "N*",
        "ORIWKS",
        "UPATH",
        "SPATH",
        "SPLINEPATH(*",
        "SD=*",
        "PL=*",
        "PW=*",
        "PO[*",
        "BAUTO",
        "BNAT",
        "BTAN",
        "EAUTO",
        "ENAT",
        "ETAN",
        "M0",
        "M1",
        "G4",
        "TURN=*",
        "I1=*",
        "J1=*",
        "K1=*",
        "XH=*",
        "YH=*",
        "ZH=*",
        "R*",
        "T*",
        "CALL",
        "BLOCK",
        "TO",
        "FLUTE*",
    ],
    motions: &[
        ("G0", Motion::Rapid),
        ("G1", Motion::Feed),
        ("G2", Motion::Feed),
        ("G3", Motion::Feed),
        ("CIP", Motion::Feed),
        ("POLY", Motion::Feed),
        ("BSPLINE", Motion::Feed),
        ("ASPLINE", Motion::Feed),
        ("CSPLINE", Motion::Feed),
    ],
    machine: "SUPA",
    spindle: (&["M3", "M4"], &["M5"]),
    coolant: (&["M7", "M8"], &["M9"]),
    change: &["M6"],
    finish: &["M30", "M2"],
    length_end: &["D0"],
    length_end_moves: false,
    direction: ["A3", "B3", "C3"],
    tip: "tip control",
    numbers: &["I", "J", "K", "S", "D", "F"],
};

/// Heidenhain iTNC 530 and TNC 426/430. A line is a word, but for moves and tool calls.
static HEIDENHAIN: Table = Table {
    modes: &[
        mode("unit of F", &["BEGIN PGM MM"], &["BEGIN PGM INCH"], Retraction, &[End]),
        mode(
            "tip control",
            &["M129", "FUNCTION RESET TCPM"],
            &["M128*", "FUNCTION TCPM*"],
            Retraction,
            &[Home, Tool, End],
        ),
        Mode {
            what: "tilted plane",
            off: &["PLANE RESET STAY", "PLANE RESET TURN*", "PLANE RESET MOVE*"],
            on: &["PLANE SPATIAL*"],
            before: Retraction,
            must: &[Tool, End],
            tilting: true,
        },
        mode("mirror", &["CYCL DEF 8.1"], &["CYCL DEF 8.1 *"], Retraction, &[End]),
        mode("rotation", &["CYCL DEF 10.1 ROT+0"], &["CYCL DEF 10.1*"], Retraction, &[End]),
        mode("scale", &["CYCL DEF 11.1 SCL 1"], &["CYCL DEF 11.1*"], Retraction, &[End]),
        mode("tolerance", &["CYCL DEF 32.1"], &["CYCL DEF 32.1 *"], Move, &[End]),
        mode("short way", &["M127"], &["M126"], Move, &[End]),
    ],
    free: &[
        "R0",
        "DR+",
        "DR-",
        "M0",
        "M1",
        "FN 0:*",
        "LBL*",
        "CALL LBL*",
        "A",
        "B",
        "CYCL DEF 8.0 MIRROR IMAGE",
        "CYCL DEF 10.0 ROTATION",
        "CYCL DEF 11.0 SCALING",
        "CYCL DEF 32.0 TOLERANCE",
        "CYCL DEF 9*",
        "END PGM*",
    ],
    motions: &[
        ("FMAX", Motion::Rapid),
        ("L", Motion::Feed),
        ("LN", Motion::Feed),
        ("SPL", Motion::Feed),
        ("C", Motion::Feed),
        ("CP", Motion::Feed),
        ("CC", Motion::Feed),
    ],
    machine: "M91",
    spindle: (&["M3", "M4"], &["M5"]),
    coolant: (&["M7", "M8"], &["M9"]),
    change: &["TOOL"],
    finish: &["M30", "M2"],
    length_end: &[],
    length_end_moves: false,
    direction: ["TX", "TY", "TZ"],
    tip: "tip control",
    numbers: &["F", "IPA", "S", "K"],
};

/// Mazak Matrix and Smooth. A parameter says whether G49 moves Z by the length, so that it is taken to do so.
static MAZAK: Table = Table {
    modes: &[
        mode("plane", &["G17"], &["G18", "G19"], Move, &[Tool, End]),
        mode("unit of F", &["G21"], &["G20"], Move, &[Home, Tool, End]),
        mode("positions", &["G90"], &["G91"], Retraction, &[Tool, End]),
        mode("feed", &["G94"], &["G93", "G95"], Move, &[Tool, End]),
        mode("radius", &["G40"], &["G41", "G42"], Retraction, &[Home, Tool, End]),
        mode("cycle", &["G80"], &["G81", "G82", "G83", "G84", "G85"], Retraction, &[Home, Tool, End]),
        mode("exact stop", &["G64"], &["G61", "G61.1", "G61.2"], Move, &[End]),
        Mode {
            what: "tilted plane",
            off: &["G69"],
            on: &["G68", "G68.2"],
            before: Retraction,
            must: &[Tool, End],
            tilting: false,
        },
        mode("tip control", &["G49"], &["G43.4", "G43.5"], Nothing, &[Tool, End]),
        mode("work offset", &["G54", "G55", "G56", "G57", "G58", "G59", "G54.1"], &[], Move, &[]),
    ],
    free: &["%", "M0", "M1", "M98", "M99", "O*", "N*", "T*", "G43", "G52", "G53.1", "#*", "G4"],
    motions: &[
        ("G0", Motion::Rapid),
        ("G1", Motion::Feed),
        ("G2", Motion::Feed),
        ("G3", Motion::Feed),
        ("G06.2", Motion::Feed),
        ("G06.1", Motion::Feed),
    ],
    machine: "G53",
    spindle: (&["M3", "M4"], &["M5"]),
    coolant: (&["M7", "M8"], &["M9"]),
    change: &["M6"],
    finish: &["M30", "M2"],
    length_end: &["G49"],
    length_end_moves: true,
    direction: ["I", "J", "K"],
    tip: "tip control",
    numbers: &["I", "J", "K", "S", "H", "F", "P", "R"],
};
