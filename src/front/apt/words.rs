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
    Key::value("circle_points"),
    Key::value("words"),
    Key::value("cycles"),
];

#[derive(Deserialize)]
struct File {
    extends: Option<Spanned<String>>,
    circle: Option<Spanned<String>>,
    circle_points: Option<Spanned<String>>,
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

/// A word table, with all that it extends.
#[derive(Clone, Debug)]
pub(super) struct Words {
    meanings: HashMap<String, Meaning>,
    cycles: BTreeMap<String, Vec<String>>,
    /// The sense of CIRCLE.
    pub(super) circle: Hand,
    /// What the points are that follow CIRCLE.
    pub(super) points: ArcPoints,
}

impl Words {
    /// A table that is built in.
    pub(super) fn built_in(name: &str) -> Words {
        let mut words = Words {
            meanings: HashMap::new(),
            cycles: BTreeMap::new(),
            circle: Hand::Right,
            points: ArcPoints::Unsure,
        };
        // A test reads every table, so that an error cannot hide here.
        let _ = words.add_built_in(name);
        words
    }

    fn add_built_in(&mut self, name: &str) -> Result<(), Diagnostics> {
        match TABLES.iter().find(|(known, _)| *known == name) {
            Some((_, text)) => self.add(text, SourceId::INPUT),
            None => Ok(()),
        }
    }

    /// Adds a table: what it states replaces what was there.
    ///
    /// # Errors
    /// It is no TOML, or has a meaning that does not exist.
    pub(super) fn add(&mut self, text: &str, source: SourceId) -> Result<(), Diagnostics> {
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
        if let Some(circle) = &file.circle {
            match circle.get_ref().as_str() {
                "right-hand" => self.circle = Hand::Right,
                "left-hand" => self.circle = Hand::Left,
                _ => found.push(unknown(circle, &["right-hand", "left-hand"], "a sense of circles")),
            }
        }
        if let Some(points) = &file.circle_points {
            match ARC_POINTS.iter().find(|(name, _)| name == points.get_ref()) {
                Some((_, known)) => self.points = *known,
                None => {
                    let names: Vec<&str> = ARC_POINTS.iter().map(|(name, _)| *name).collect();
                    found.push(unknown(points, &names, "what the points behind a circle are"));
                }
            }
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
        assert_eq!(Words::built_in("nx").circle, Hand::Left);
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
