//! What each word means, as data: `words/*.toml`, one table a CAM system, and one that a shop gives with `--words`.
//!
//! ```toml
//! extends = "catia"
//! [words]
//! SWITCH = "left-out"        # one of the meanings below
//! MYFEED = "fedrat"          # another name for FEDRAT
//! [cycles]
//! DRILL = ["DEPTH", "CLEAR"] # the order of numbers that have no word before them
//! ```

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::{SourceId, Span};
use crate::tables::{self, Key, nearest};
use serde::Deserialize;
use std::collections::{BTreeMap, HashMap};
use toml::Spanned;

/// The keys of a word table.
pub const KEYS: &[Key] = &[
    Key::value("extends"),
    Key::value("circle"),
    Key::value("circle_eleven"),
    Key::value("movarc"),
    Key::value("circle_points"),
    Key::value("cycle_heights"),
    Key::value("fedto"),
    Key::value("cycle_rapid"),
    Key::value("spindle_range"),
    Key::value("tool_register"),
    Key::value("tools"),
    Key::value("words"),
    Key::value("cycles"),
];

#[derive(Deserialize)]
struct File {
    extends: Option<Spanned<String>>,
    circle: Option<Spanned<String>>,
    circle_eleven: Option<Spanned<String>>,
    movarc: Option<Spanned<String>>,
    circle_points: Option<Spanned<String>>,
    cycle_heights: Option<Spanned<String>>,
    fedto: Option<Spanned<String>>,
    cycle_rapid: Option<Spanned<String>>,
    spindle_range: Option<Spanned<String>>,
    tool_register: Option<Spanned<String>>,
    tools: Option<BTreeMap<String, Spanned<u32>>>,
    words: Option<BTreeMap<String, Spanned<String>>>,
    cycles: Option<BTreeMap<String, Spanned<Vec<String>>>>,
}

/// What a word means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Meaning {
    /// Carried over as a remark.
    Comment,
    /// Left out, with one warning.
    LeftOut,
    /// Refused: it changes what the machine does.
    Refused,
    /// The program's name.
    Partno,
    /// Text for the NC program as it stands.
    Insert,
    /// mm or inches.
    Units,
    /// Milling or turning.
    Mode,
    /// The end.
    End,
    /// M0.
    Stop,
    /// M1.
    Opstop,
    /// NX: a path and its tool.
    Path,
    /// Its end.
    PathEnd,
    /// The cutter's shape.
    Cutter,
    /// NX: the tool's shape.
    Tldata,
    /// A tool's number and more, before its call.
    Toolno,
    /// A tool call.
    Loadtl,
    /// LOAD/TOOL or LOAD/WIRE.
    Load,
    /// Spindle.
    Spindl,
    /// Feed.
    Fedrat,
    /// Coolant.
    Coolnt,
    /// Dwell.
    Delay,
    /// Cutter compensation.
    Cutcom,
    /// The frame that positions are given in.
    Frame,
    /// Whether points carry a tool axis.
    Multax,
    /// The tool axis.
    Tlaxis,
    /// The next motion is a rapid.
    Rapid,
    /// Where the tool is.
    From,
    /// Back to where it began.
    Gohome,
    /// By increments.
    Godlta,
    /// To a point.
    Goto,
    /// A circle, to the end that follows.
    Circle,
    /// A circle with its sweep.
    Movarc,
    /// The start tangent of an arc.
    Indirv,
    /// An arc by its start tangent.
    Tlon,
    /// A spline of CATIA.
    NurbsSiemens,
    /// A spline of NX.
    Nurbs,
    /// Its knots.
    Knot,
    /// Its control points.
    Cntrl,
    /// A spline of Creo.
    Movnrb,
    /// A drilling cycle.
    Cycle,
}

impl Meaning {
    /// Whether the tool goes somewhere where this is said. A GOTO looks for itself.
    pub(super) fn cuts_or_goes(self) -> bool {
        self.moves()
            && !matches!(
                self,
                Meaning::Loadtl | Meaning::Load | Meaning::Goto | Meaning::Godlta | Meaning::Cycle
            )
    }

    /// Whether the tool moves, or is another one, where this is said.
    pub(super) fn moves(self) -> bool {
        matches!(
            self,
            Meaning::Loadtl
                | Meaning::Load
                | Meaning::Gohome
                | Meaning::Godlta
                | Meaning::Goto
                | Meaning::Circle
                | Meaning::Movarc
                | Meaning::Tlon
                | Meaning::NurbsSiemens
                | Meaning::Nurbs
                | Meaning::Movnrb
                | Meaning::Cycle
        )
    }
}

/// The meanings by the names that tables use.
const MEANINGS: &[(&str, Meaning)] = &[
    ("comment", Meaning::Comment),
    ("left-out", Meaning::LeftOut),
    ("refused", Meaning::Refused),
    ("partno", Meaning::Partno),
    ("insert", Meaning::Insert),
    ("units", Meaning::Units),
    ("mode", Meaning::Mode),
    ("end", Meaning::End),
    ("stop", Meaning::Stop),
    ("opstop", Meaning::Opstop),
    ("path", Meaning::Path),
    ("path-end", Meaning::PathEnd),
    ("cutter", Meaning::Cutter),
    ("tldata", Meaning::Tldata),
    ("toolno", Meaning::Toolno),
    ("loadtl", Meaning::Loadtl),
    ("load", Meaning::Load),
    ("spindl", Meaning::Spindl),
    ("fedrat", Meaning::Fedrat),
    ("coolnt", Meaning::Coolnt),
    ("delay", Meaning::Delay),
    ("cutcom", Meaning::Cutcom),
    ("frame", Meaning::Frame),
    ("multax", Meaning::Multax),
    ("tlaxis", Meaning::Tlaxis),
    ("rapid", Meaning::Rapid),
    ("from", Meaning::From),
    ("gohome", Meaning::Gohome),
    ("godlta", Meaning::Godlta),
    ("goto", Meaning::Goto),
    ("circle", Meaning::Circle),
    ("movarc", Meaning::Movarc),
    ("indirv", Meaning::Indirv),
    ("tlon", Meaning::Tlon),
    ("nurbs-siemens", Meaning::NurbsSiemens),
    ("nurbs", Meaning::Nurbs),
    ("knot", Meaning::Knot),
    ("cntrl", Meaning::Cntrl),
    ("movnrb", Meaning::Movnrb),
    ("cycle", Meaning::Cycle),
];

/// The tables that are built in.
const TABLES: &[(&str, &str)] = &[
    ("iso", include_str!("words/iso.toml")),
    ("catia", include_str!("words/catia.toml")),
    ("nx", include_str!("words/nx.toml")),
    ("creo", include_str!("words/creo.toml")),
    ("solidworks", include_str!("words/solidworks.toml")),
    ("fusion", include_str!("words/fusion.toml")),
];

/// The sense of a circle about its axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Hand {
    /// Counter-clockwise, seen against the axis.
    Right,
    /// Clockwise.
    Left,
}

/// What the points are that follow a circle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ArcPoints {
    /// The first is its end.
    End,
    /// Those that go on along it are on the arc, and the last of them is its end.
    Along,
    /// The same, with a warning where it matters, since lines would look so too.
    Likely,
    /// Nobody knows: where it matters the file is refused.
    Unsure,
}

/// What follows circles, by the names that tables use.
const ARC_POINTS: &[(&str, ArcPoints)] = &[
    ("end", ArcPoints::End),
    ("along", ArcPoints::Along),
    ("likely", ArcPoints::Likely),
    ("unsure", ArcPoints::Unsure),
];

/// The statements that state an arc by its axis, each with a sense of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ByAxis {
    /// CIRCLE with six or seven numbers.
    Circle,
    /// CIRCLE with eleven numbers.
    Eleven,
    /// MOVARC.
    Movarc,
}

impl ByAxis {
    /// All of them.
    pub(super) const ALL: [ByAxis; 3] = [ByAxis::Circle, ByAxis::Eleven, ByAxis::Movarc];

    /// Its key in a table.
    pub(super) fn key(self) -> &'static str {
        match self {
            ByAxis::Circle => "circle",
            ByAxis::Eleven => "circle_eleven",
            ByAxis::Movarc => "movarc",
        }
    }
}

/// What the heights of a cycle count from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CycleHeights {
    /// The point is the top of the hole, and all counts from it.
    Top,
    /// The point is the bottom of the hole, and the clearance is a place on Z: Autodesk's "Common ISO 4343 APT".
    Iso4343,
    /// The point is the top, and the clearance counts from the bottom: Autodesk's "Generative Machining APT".
    Generative,
    /// One of these two, and nobody knows which.
    Unsure,
}

/// What RAPID within a cycle is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CycleRapid {
    /// Nothing: the point behind it is a hole.
    Hole,
    /// The end of the cycle.
    Off,
}

/// What ADJUST and OSETNO of a tool call are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Register {
    /// The register of the tool's length.
    Length,
    /// Nothing: the length is the tool's own.
    LeftOut,
}

/// The senses of arcs, by the names that tables use.
const HANDS: &[(&str, Hand)] = &[("right-hand", Hand::Right), ("left-hand", Hand::Left)];

/// Which FEDTO lies below the point, by the names that tables use.
const FEDTO: &[(&str, f64)] = &[("positive", 1.0), ("negative", -1.0)];

/// What the heights of cycles count from, by the names that tables use.
const HEIGHTS: &[(&str, CycleHeights)] = &[
    ("top", CycleHeights::Top),
    ("iso-4343", CycleHeights::Iso4343),
    ("generative", CycleHeights::Generative),
    ("unsure", CycleHeights::Unsure),
];

/// What RAPID within a cycle is, by the names that tables use.
const CYCLE_RAPID: &[(&str, CycleRapid)] = &[("hole", CycleRapid::Hole), ("off", CycleRapid::Off)];

/// What ADJUST is, by the names that tables use.
const REGISTERS: &[(&str, Register)] = &[("length", Register::Length), ("left-out", Register::LeftOut)];

/// The value that a key names; where it names none, that is reported.
fn chosen<T: Copy>(
    value: Option<&Spanned<String>>,
    names: &[(&'static str, T)],
    what: &str,
    unknown: &impl Fn(&Spanned<String>, &[&'static str], &str) -> Diagnostic,
    found: &mut Diagnostics,
) -> Option<T> {
    let value = value?;
    let known = names.iter().find(|(name, _)| name == value.get_ref()).map(|(_, known)| *known);
    if known.is_none() {
        let names: Vec<&'static str> = names.iter().map(|(name, _)| *name).collect();
        found.push(unknown(value, &names, what));
    }
    known
}

/// A word table, with all that it extends.
#[derive(Clone, Debug)]
pub(super) struct Words {
    meanings: HashMap<String, Meaning>,
    cycles: BTreeMap<String, Vec<String>>,
    /// The sense of each statement of an arc, and whether a table for --words states it.
    hands: [(Hand, bool); 3],
    /// The sign of a FEDTO below the point.
    pub(super) fedto: f64,
    /// What the heights of cycles count from.
    pub(super) heights: CycleHeights,
    /// What RAPID within a cycle is, where that is stated.
    pub(super) cycle_rapid: Option<CycleRapid>,
    /// Whether RANGE of SPINDL is left out.
    pub(super) range_left_out: bool,
    /// The numbers of tools by their names in TOOL PATH, in capitals.
    pub(super) tools: BTreeMap<String, u32>,
    /// What the points are that follow CIRCLE.
    pub(super) points: ArcPoints,
    /// What ADJUST and OSETNO are.
    pub(super) register: Register,
}

impl Words {
    /// A table that is built in.
    pub(super) fn built_in(name: &str) -> Words {
        let mut words = Words {
            meanings: HashMap::new(),
            cycles: BTreeMap::new(),
            hands: [(Hand::Right, false), (Hand::Left, false), (Hand::Right, false)],
            fedto: 1.0,
            heights: CycleHeights::Top,
            cycle_rapid: None,
            range_left_out: false,
            tools: BTreeMap::new(),
            points: ArcPoints::Unsure,
            register: Register::Length,
        };
        // A test reads every table, so that an error cannot hide here.
        let _ = words.add_built_in(name);
        words
    }

    fn add_built_in(&mut self, name: &str) -> Result<(), Diagnostics> {
        match TABLES.iter().find(|(known, _)| *known == name) {
            Some((_, text)) => self.extend(text, SourceId::INPUT, false),
            None => Ok(()),
        }
    }

    /// Adds a table of a shop: what it states replaces what was there.
    ///
    /// # Errors
    /// It is no TOML, or has a meaning that does not exist.
    pub(super) fn add(&mut self, text: &str, source: SourceId) -> Result<(), Diagnostics> {
        self.extend(text, source, true)
    }

    fn extend(&mut self, text: &str, source: SourceId, own: bool) -> Result<(), Diagnostics> {
        let file: File = tables::read(text, source, KEYS)?;
        let mut found = Diagnostics::new();
        let unknown = |spanned: &Spanned<String>, names: &[&'static str], what: &str| {
            let value = spanned.get_ref();
            let diagnostic = Diagnostic::error("word-unknown", format!("`{value}` is not {what}"))
                .at(Span::new(source, spanned.span()), "");
            match nearest(value, names.iter().copied()) {
                Some(meant) => diagnostic.hint(format!("did you mean `{meant}`?")),
                None => diagnostic.hint(format!("known are {}", names.join(", "))),
            }
        };
        if let Some(extends) = &file.extends {
            let names: Vec<&str> = TABLES.iter().map(|(name, _)| *name).collect();
            if names.contains(&extends.get_ref().as_str()) {
                self.add_built_in(extends.get_ref())?;
            } else {
                found.push(unknown(extends, &names, "a word table"));
            }
        }
        for (by, hand) in ByAxis::ALL.into_iter().zip([&file.circle, &file.circle_eleven, &file.movarc]) {
            if let Some(hand) = chosen(hand.as_ref(), HANDS, "a sense of circles", &unknown, &mut found) {
                self.hands[by as usize] = (hand, own);
            }
        }
        let register = chosen(file.tool_register.as_ref(), REGISTERS, "what ADJUST is", &unknown, &mut found);
        self.register = register.unwrap_or(self.register);
        let what = "what the points behind a circle are";
        let points = chosen(file.circle_points.as_ref(), ARC_POINTS, what, &unknown, &mut found);
        self.points = points.unwrap_or(self.points);
        let what = "what the heights of a cycle count from";
        let heights = chosen(file.cycle_heights.as_ref(), HEIGHTS, what, &unknown, &mut found);
        self.heights = heights.unwrap_or(self.heights);
        let what = "the sign of FEDTO";
        self.fedto = chosen(file.fedto.as_ref(), FEDTO, what, &unknown, &mut found).unwrap_or(self.fedto);
        let what = "what RAPID within a cycle is";
        self.cycle_rapid =
            chosen(file.cycle_rapid.as_ref(), CYCLE_RAPID, what, &unknown, &mut found).or(self.cycle_rapid);
        let range =
            chosen(file.spindle_range.as_ref(), &[("left-out", true)], "what RANGE is", &unknown, &mut found);
        self.range_left_out |= range.unwrap_or(false);
        for (name, number) in file.tools.unwrap_or_default() {
            self.tools.insert(name.trim().to_ascii_uppercase(), number.into_inner());
        }
        for (word, meaning) in file.words.unwrap_or_default() {
            match MEANINGS.iter().find(|(name, _)| name == meaning.get_ref()) {
                Some((_, known)) => {
                    self.meanings.insert(word.to_ascii_uppercase(), *known);
                }
                None => {
                    let names: Vec<&str> = MEANINGS.iter().map(|(name, _)| *name).collect();
                    found.push(unknown(&meaning, &names, "a meaning of words"));
                }
            }
        }
        for (kind, order) in file.cycles.unwrap_or_default() {
            let order = order.into_inner().into_iter().map(|word| word.to_ascii_uppercase()).collect();
            self.cycles.insert(kind.to_ascii_uppercase(), order);
        }
        found.into_result().map(|_| ())
    }

    /// The sense of a statement of an arc, and whether the shop stated it.
    pub(super) fn hand(&self, by: ByAxis) -> (Hand, bool) {
        self.hands[by as usize]
    }

    /// What a major word means.
    pub(super) fn meaning(&self, word: &str) -> Option<Meaning> {
        // Blanks within `TOOL PATH` count once.
        let mut key = String::with_capacity(word.len());
        for part in word.split_ascii_whitespace() {
            if !key.is_empty() {
                key.push(' ');
            }
            key.push_str(part);
        }
        key.make_ascii_uppercase();
        self.meanings.get(&key).copied()
    }

    /// The word that was probably meant.
    pub(super) fn nearest(&self, word: &str) -> Option<&str> {
        let mut known: Vec<&str> = self.meanings.keys().map(String::as_str).collect();
        known.sort_unstable();
        nearest(&word.to_ascii_uppercase(), known.iter().copied())
            .and_then(|found| known.iter().copied().find(|k| *k == found))
    }

    /// The order of a cycle's numbers that have no word before them.
    pub(super) fn cycle(&self, kind: &str) -> &[String] {
        self.cycles.get(&kind.to_ascii_uppercase()).map_or(&[], Vec::as_slice)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_table_reads() {
        for (name, text) in TABLES {
            let mut words = Words::built_in("iso");
            words.add(text, SourceId::INPUT).unwrap_or_else(|error| panic!("{name}: {error:?}"));
            assert_eq!(words.meaning("goto"), Some(Meaning::Goto));
            assert_eq!(words.meaning("Tool   Path"), Some(Meaning::Path));
        }
        assert_eq!(Words::built_in("nx").hand(ByAxis::Circle), (Hand::Left, false));
        for (name, _) in TABLES {
            // In every system that writes eleven numbers.
            assert_eq!(Words::built_in(name).hand(ByAxis::Eleven).0, Hand::Left, "{name}");
        }
        assert_eq!(Words::built_in("fusion").cycle("drill"), ["DEPTH", "CLEAR"]);
    }

    #[test]
    fn a_shop_extends_a_table() {
        let mut words = Words::built_in("catia");
        words.add("[words]\nmyfeed = \"fedrat\"\nSWITCH = \"refused\"", SourceId::INPUT).unwrap();
        assert_eq!(words.meaning("MYFEED"), Some(Meaning::Fedrat));
        assert_eq!(words.meaning("SWITCH"), Some(Meaning::Refused));
        assert_eq!(words.meaning("GOTO"), Some(Meaning::Goto));
        let errors = words.add("[words]\nA = \"fedrad\"\nB = 5", SourceId::INPUT).unwrap_err();
        assert_eq!(errors.0[0].id, "value-kind");
        let errors = words.add("[words]\nA = \"fedrad\"", SourceId::INPUT).unwrap_err();
        assert_eq!(
            (errors.0[0].id, errors.0[0].hints[0].as_str()),
            ("word-unknown", "did you mean `fedrat`?")
        );
        assert_eq!(words.nearest("GOTTO"), Some("GOTO"));
    }
}
