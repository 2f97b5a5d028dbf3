//! The blocks of the three dialects, read into one kind of block. Nothing is held here: what is modal is `run`'s matter.

mod heidenhain;
mod mazak;
mod sinumerik;

pub(super) use heidenhain::joined as heidenhain_lines;
pub(super) use mazak::words as mazak_words;
pub(super) use sinumerik::words as sinumerik_words;
use std::collections::BTreeMap;

/// How a program is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Dialect {
    Sinumerik,
    Heidenhain,
    Mazak,
}

impl Dialect {
    pub(super) const ALL: [Dialect; 3] = [Dialect::Sinumerik, Dialect::Heidenhain, Dialect::Mazak];

    pub(super) fn named(name: &str) -> Option<Dialect> {
        match name {
            "sinumerik" => Some(Dialect::Sinumerik),
            "heidenhain" => Some(Dialect::Heidenhain),
            "mazak" => Some(Dialect::Mazak),
            _ => None,
        }
    }
}

/// How a block moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Motion {
    Rapid,
    Line,
    /// POLY.
    Poly,
    /// BSPLINE.
    Bspline,
    /// ASPLINE, CSPLINE, G06.1.
    Through,
    /// SPL.
    Spl,
    /// G06.2.
    Nurbs,
}

/// What must be stated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum State {
    Plane,
    Millimetres,
    Absolute,
    FeedPerMinute,
    NoRadius,
}

/// A word that does not move anything.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Word {
    /// As it must be.
    State(State),
    /// Something else of the same group.
    Other(State),
    /// G91.
    Incremental,
    Tool(f64),
    /// M6.
    Change,
    /// D, H with G43, TOOL CALL.
    Length(f64),
    NoLength,
    Speed(f64),
    /// M3, M4.
    Turn,
    /// M5.
    Stop,
    /// M8, or M9.
    Coolant(bool),
    /// Whether F is inverse time.
    Timed(bool),
    /// UPATH, or SPATH.
    Upath(bool),
    SplinePath(Vec<char>),
    /// FGROUP.
    Group(Vec<char>),
    /// BAUTO, EAUTO and their like: whether it is of the start, and the word.
    Ends(bool, String),
    /// SD.
    Degree(f64),
    /// The line that opens a program, with its name.
    Open(String),
    /// M30, M2.
    Finish,
    /// The line that closes it.
    Close(String),
}

/// A number, or the parameter that holds it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Value {
    Number(f64),
    Parameter(u32),
}

/// Where an axis goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Target {
    /// The plain word.
    To(Value),
    /// DC: the short way round.
    Short(f64),
    /// IC, IA: from where it is.
    By(f64),
}

/// What is not run in the order of the lines.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Flow {
    /// From a label to the next return, or to another label.
    Call(String, Option<String>),
    Label(String),
    Return,
}

/// One block.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Block {
    /// Of its first line, from 1.
    pub(super) line: usize,
    /// The remark that begins a section: FLUTE and what follows. Other remarks are for the reader.
    pub(super) section: Option<String>,
    /// In the order of the text.
    pub(super) words: Vec<Word>,
    pub(super) motion: Option<Motion>,
    pub(super) targets: BTreeMap<char, Target>,
    /// Whether the targets are those of the machine: SUPA, M91, G53.
    pub(super) machine: bool,
    /// From where axes are counted: TRANS, CYCL DEF 7, G52.
    pub(super) shift: Option<BTreeMap<char, Value>>,
    /// Heidenhain: the part of cycle 7.
    pub(super) part: Option<usize>,
    /// A parameter and its number.
    pub(super) assign: Option<(u32, f64)>,
    pub(super) flow: Option<Flow>,
    /// The factor of each power: a2 … of PO, K1 K2 K3 of SPL.
    pub(super) factors: BTreeMap<(char, usize), f64>,
    pub(super) feed: Option<Value>,
    /// PL, K.
    pub(super) knot: Option<f64>,
    /// PW, R.
    pub(super) weight: Option<f64>,
    /// P of G06.2.
    pub(super) order: Option<f64>,
    /// What was not understood.
    pub(super) faults: Vec<String>,
}

impl Block {
    fn says_nothing(&self) -> bool {
        let nothing = Block { line: self.line, ..Block::default() };
        *self == nothing
    }

    fn fault(&mut self, word: &str) {
        self.faults.push(word.to_owned());
    }

    /// Keeps a remark, where it begins a section.
    fn remark(&mut self, text: &str) {
        self.section = Some(text.trim().to_owned())
            .filter(|text| text.starts_with("FLUTE") || text.starts_with("CURVE"));
    }

    /// Puts a number where there is none yet.
    fn once(&mut self, place: fn(&mut Block) -> &mut Option<f64>, word: &str, value: &str) {
        match number(value) {
            Some(value) if place(self).is_none() => *place(self) = Some(value),
            _ => self.fault(word),
        }
    }

    fn feed(&mut self, word: &str, value: Option<Value>) {
        match value {
            Some(value) if self.feed.is_none() => self.feed = Some(value),
            _ => self.fault(word),
        }
    }

    fn target(&mut self, axis: char, word: &str, target: Option<Target>) {
        match target {
            Some(target) if !self.targets.contains_key(&axis) => drop(self.targets.insert(axis, target)),
            _ => self.fault(word),
        }
    }

    /// What a word of a work offset turns its targets into.
    fn shifts(&mut self) {
        let mut shift = BTreeMap::new();
        for (axis, target) in std::mem::take(&mut self.targets) {
            match target {
                Target::To(value) => drop(shift.insert(axis, value)),
                Target::Short(_) | Target::By(_) => self.fault("an offset by a way"),
            }
        }
        self.shift = Some(shift);
    }

    fn motion(&mut self, motion: Motion, word: &str) {
        if self.motion.replace(motion).is_some() {
            self.fault(word);
        }
    }

    /// A word with one number.
    fn with(&mut self, make: fn(f64) -> Word, word: &str, value: &str) {
        match number(value) {
            Some(value) => self.words.push(make(value)),
            None => self.fault(word),
        }
    }
}

/// A plain number, without an exponent: Sinumerik spells that another way, and none is needed there.
fn number(text: &str) -> Option<f64> {
    let plain = text.bytes().all(|b| b.is_ascii_digit() || b"+-.".contains(&b));
    text.parse().ok().filter(|_| plain)
}

/// A number, or a parameter: R1, Q1, #101.
fn value(parameter: char, text: &str) -> Option<Value> {
    let bare = text.strip_prefix('+').unwrap_or(text);
    match bare.strip_prefix(parameter) {
        Some(of) => of.parse().ok().map(Value::Parameter),
        None => number(text).map(Value::Number),
    }
}

/// The letter, if it is that of an axis.
fn axis(name: &str) -> Option<char> {
    let letter = name.chars().next().filter(|letter| "XYZABCUVW".contains(*letter))?;
    (name.len() == 1).then_some(letter)
}

/// The axes of `X,Y,Z`.
fn axes(list: &str) -> Option<Vec<char>> {
    list.split(',').map(axis).collect()
}

/// The address and the rest.
fn split(word: &str) -> (&str, &str) {
    word.split_at(word.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(word.len()))
}

/// The blocks of a program; empty lines are left out.
pub(super) fn read(dialect: Dialect, text: &str) -> Vec<Block> {
    let blocks = match dialect {
        Dialect::Sinumerik => sinumerik::read(text),
        Dialect::Heidenhain => heidenhain::read(text),
        Dialect::Mazak => mazak::read(text),
    };
    blocks.into_iter().filter(|block| !block.says_nothing()).collect()
}
