//! The blocks of the three dialects, read into one kind of block. Nothing is held here: what is modal is `run`'s matter.

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

/// One block.
#[derive(Clone, Debug, Default)]
pub(super) struct Block {
    /// Of its first line, from 1.
    pub(super) line: usize,
    /// A remark alone: a section begins.
    pub(super) remark: bool,
    /// In the order of the text.
    pub(super) words: Vec<Word>,
    pub(super) motion: Option<Motion>,
    pub(super) targets: BTreeMap<char, f64>,
    /// The factor of each power: a2 … of PO, K1 K2 K3 of SPL.
    pub(super) factors: BTreeMap<(char, usize), f64>,
    pub(super) feed: Option<f64>,
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
        self.words.is_empty() && self.motion.is_none() && self.faults.is_empty() && !self.moves_or_knots()
    }

    fn moves_or_knots(&self) -> bool {
        !self.targets.is_empty() || !self.factors.is_empty() || self.knot.is_some() || self.feed.is_some()
    }

    fn fault(&mut self, word: &str) {
        self.faults.push(word.to_owned());
    }

    /// Puts a number where there is none yet.
    fn once(&mut self, place: fn(&mut Block) -> &mut Option<f64>, word: &str, value: &str) {
        match number(value) {
            Some(value) if place(self).is_none() => *place(self) = Some(value),
            _ => self.fault(word),
        }
    }

    fn target(&mut self, axis: char, word: &str, value: &str) {
        match number(value) {
            Some(value) if !self.targets.contains_key(&axis) => drop(self.targets.insert(axis, value)),
            _ => self.fault(word),
        }
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

/// The number of Heidenhain's K: one digit before the point, and an exponent from ten on.
fn factor(text: &str) -> Option<f64> {
    let (mantissa, power) = text.split_once('E').unwrap_or((text, "0"));
    let mantissa_fits = number(mantissa).is_some_and(|mantissa| mantissa.abs() < 10.0);
    let power_fits = power.parse().is_ok_and(|power: i32| power.abs() <= 255);
    text.parse().ok().filter(|_| mantissa_fits && power_fits)
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
        Dialect::Sinumerik => sinumerik(text),
        Dialect::Heidenhain => heidenhain(text),
        Dialect::Mazak => mazak(text),
    };
    blocks.into_iter().filter(|block| block.remark || !block.says_nothing()).collect()
}

// ---- Sinumerik ----

fn sinumerik(text: &str) -> Vec<Block> {
    let read = |(at, line): (usize, &str)| {
        let (code, remark) = line.split_once(';').map_or((line, false), |(code, _)| (code, true));
        let mut block = Block { line: at + 1, ..Block::default() };
        block.remark = remark && code.trim().is_empty();
        for word in code.split_whitespace() {
            sinumerik_word(&mut block, word);
        }
        // With an axis TRANS shifts; alone it ends a shift.
        if code.contains("TRANS") && !block.targets.is_empty() {
            block.targets.clear();
            block.fault("TRANS with an axis");
        }
        block
    };
    text.lines().enumerate().map(read).collect()
}

fn sinumerik_word(block: &mut Block, word: &str) {
    let other = match word {
        "G0" => return block.motion(Motion::Rapid, word),
        "G1" => return block.motion(Motion::Line, word),
        "POLY" => return block.motion(Motion::Poly, word),
        "BSPLINE" => return block.motion(Motion::Bspline, word),
        "ASPLINE" | "CSPLINE" => return block.motion(Motion::Through, word),
        "TRAFOOF" | "TRANS" | "G54" | "G64" | "COMPOF" => return,
        "G17" => Word::State(State::Plane),
        "G18" | "G19" => Word::Other(State::Plane),
        "G71" => Word::State(State::Millimetres),
        "G70" => Word::Other(State::Millimetres),
        "G90" => Word::State(State::Absolute),
        "G91" => Word::Incremental,
        "G94" => Word::State(State::FeedPerMinute),
        "G93" | "G95" => Word::Other(State::FeedPerMinute),
        "G40" => Word::State(State::NoRadius),
        "G41" | "G42" => Word::Other(State::NoRadius),
        "D0" => Word::NoLength,
        "M3" | "M4" => Word::Turn,
        "M5" => Word::Stop,
        "M6" => Word::Change,
        "M30" | "M2" => Word::Finish,
        "UPATH" => Word::Upath(true),
        "SPATH" => Word::Upath(false),
        "BAUTO" | "BNAT" | "BTAN" => Word::Ends(true, word.to_owned()),
        "EAUTO" | "ENAT" | "ETAN" => Word::Ends(false, word.to_owned()),
        _ => return sinumerik_value(block, word),
    };
    block.words.push(other);
}

/// A word with a value.
fn sinumerik_value(block: &mut Block, word: &str) {
    let list = |start: &str| word.strip_prefix(start).and_then(|rest| rest.strip_suffix(')')).and_then(axes);
    if let Some(group) = list("FGROUP(") {
        return block.words.push(Word::Group(group));
    }
    if let Some(group) = list("SPLINEPATH(1,") {
        return block.words.push(Word::SplinePath(group));
    }
    if let Some((address, value)) = word.split_once('=') {
        let inner = |start: &str| value.strip_prefix(start).and_then(|rest| rest.strip_suffix(')'));
        match (address, axis(address)) {
            ("PL", _) => block.once(|block| &mut block.knot, word, value),
            ("PW", _) => block.once(|block| &mut block.weight, word, value),
            ("SD", _) => block.with(Word::Degree, word, value),
            (_, Some(axis)) => match inner("IC(") {
                Some(by) => {
                    block.words.push(Word::Incremental);
                    block.target(axis, word, by);
                }
                None => block.target(axis, word, value),
            },
            (_, None) => {
                let name = address.strip_prefix("PO[").and_then(|rest| rest.strip_suffix(']'));
                if let (Some(""), Some(list)) = (name, inner("(")) {
                    // The denominator of the geometry axes: its end, then d2, d3, … The end is above zero.
                    let values: Vec<Option<f64>> = list.split(',').map(number).collect();
                    if !values.iter().all(Option::is_some) || values[0].is_none_or(|end| end <= 0.0) {
                        block.fault(word);
                    }
                    return;
                }
                let (Some(axis), Some(list)) = (name.and_then(axis), inner("(")) else {
                    return block.fault(word);
                };
                for (at, value) in list.split(',').enumerate() {
                    // The end, then a2, a3, …
                    match (at, number(value)) {
                        (0, _) => block.target(axis, word, value),
                        (_, Some(value)) => drop(block.factors.insert((axis, at + 1), value)),
                        (_, None) => block.fault(word),
                    }
                }
            }
        }
        return;
    }
    let (address, value) = split(word);
    match (address, axis(address)) {
        ("N", _) if number(value).is_some() => {}
        ("T", _) => block.with(Word::Tool, word, value),
        ("D", _) => block.with(Word::Length, word, value),
        ("S", _) => block.with(Word::Speed, word, value),
        ("F", _) => block.once(|block| &mut block.feed, word, value),
        (_, Some(axis)) => block.target(axis, word, value),
        (_, None) => block.fault(word),
    }
}

// ---- Heidenhain ----

fn heidenhain(text: &str) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut open: Option<(usize, String)> = None;
    for (at, line) in text.lines().enumerate() {
        let (start, mut whole) = open.take().unwrap_or((at + 1, String::new()));
        match line.trim_end().strip_suffix('~') {
            Some(part) => {
                whole.push_str(part);
                open = Some((start, whole));
            }
            None => blocks.push(klartext(start, &(whole + line))),
        }
    }
    if let Some((line, text)) = open {
        blocks.push(Block { line, faults: vec![text], ..Block::default() });
    }
    blocks
}

/// Lines that end what another program may have left, and leave nothing themselves.
fn cancels(words: &[&str]) -> bool {
    match words {
        ["M127" | "M129"] | ["PLANE", "RESET", "STAY"] => true,
        ["CYCL", "DEF", "7.0", "DATUM", "SHIFT"] => true,
        ["CYCL", "DEF", part, shift] if part.starts_with("7.") => {
            let (address, value) = split(shift);
            axis(address).is_some() && number(value) == Some(0.0)
        }
        ["CYCL", "DEF", "8.0", "MIRROR", "IMAGE"] | ["CYCL", "DEF", "8.1"] => true,
        ["CYCL", "DEF", "10.0", "ROTATION"] | ["CYCL", "DEF", "10.1", "ROT+0"] => true,
        ["CYCL", "DEF", "11.0", "SCALING"] | ["CYCL", "DEF", "11.1", "SCL", "1"] => true,
        ["CYCL", "DEF", "32.0", "TOLERANCE"] | ["CYCL", "DEF", "32.1"] => true,
        _ => false,
    }
}

fn klartext(line: usize, text: &str) -> Block {
    let (code, remark) = text.split_once(';').map_or((text, false), |(code, _)| (code, true));
    let mut block = Block { line, ..Block::default() };
    let mut words: Vec<&str> = code.split_whitespace().collect();
    if words.first().is_some_and(|word| word.bytes().all(|b| b.is_ascii_digit())) {
        words.remove(0);
    }
    match words.as_slice() {
        [] => block.remark = remark,
        ["*", ..] => block.remark = true,
        ["BEGIN", "PGM", name, unit] => {
            block.words.push(Word::Open((*name).to_owned()));
            let (mm, state) = (*unit == "MM", State::Millimetres);
            block.words.push(if mm { Word::State(state) } else { Word::Other(state) });
        }
        ["END", "PGM", name, "MM" | "INCH"] => block.words.push(Word::Close((*name).to_owned())),
        ["TOOL", "CALL", call @ ..] => tool_call(&mut block, call),
        ["L", words @ ..] => {
            let motion = if words.contains(&"FMAX") { Motion::Rapid } else { Motion::Line };
            block.motion(motion, "L");
            moves(&mut block, words);
        }
        ["SPL", words @ ..] => {
            block.motion(Motion::Spl, "SPL");
            moves(&mut block, words);
        }
        ["M3" | "M4"] => block.words.push(Word::Turn),
        ["M5"] => block.words.push(Word::Stop),
        ["M30" | "M2"] => block.words.push(Word::Finish),
        words if cancels(words) => {}
        words => block.fault(&words.join(" ")),
    }
    block
}

/// `1 Z S3000`: with a number the tool comes in and its length counts.
fn tool_call(block: &mut Block, words: &[&str]) {
    for word in words {
        match (*word, word.strip_prefix('S')) {
            ("Z", _) => block.words.push(Word::State(State::Plane)),
            ("X" | "Y", _) => block.words.push(Word::Other(State::Plane)),
            (_, Some(speed)) => block.with(Word::Speed, word, speed),
            (tool, None) => {
                block.with(Word::Tool, word, tool);
                block.words.push(Word::Change);
                block.with(Word::Length, word, tool);
            }
        }
    }
}

/// The words of `L` and `SPL`.
fn moves(block: &mut Block, words: &[&str]) {
    let spline = block.motion == Some(Motion::Spl);
    for word in words {
        let (address, value) = split(word);
        match (*word, address) {
            ("FMAX", _) if !spline => {}
            ("R0", _) if !spline => block.words.push(Word::State(State::NoRadius)),
            ("RL" | "RR", _) => block.words.push(Word::Other(State::NoRadius)),
            (_, "F") => block.once(|block| &mut block.feed, word, value),
            // K3X-1.5E+1
            (_, "K") if spline && value.is_char_boundary(2) && 2 < value.len() => {
                let (power, axis) = (value[..1].parse().unwrap_or(0), axis(&value[1..2]));
                match (axis, factor(&value[2..])) {
                    (Some(axis), Some(factor))
                        if (1..=3).contains(&power) && !block.factors.contains_key(&(axis, power)) =>
                    {
                        block.factors.insert((axis, power), factor);
                    }
                    _ => block.fault(word),
                }
            }
            _ => match (axis(address), address.strip_prefix('I').and_then(axis)) {
                (Some(axis), _) => block.target(axis, word, value),
                (None, Some(axis)) => {
                    block.words.push(Word::Incremental);
                    block.target(axis, word, value);
                }
                (None, None) => block.fault(word),
            },
        }
    }
}

// ---- Mazak ----

fn mazak(text: &str) -> Vec<Block> {
    let read = |(at, line): (usize, &str)| {
        let (code, remark) = line.split_once('(').map_or((line, false), |(code, _)| (code, true));
        let mut block = Block { line: at + 1, ..Block::default() };
        block.remark = remark && code.trim().is_empty();
        if code.trim() == "%" {
            let name = "%".to_owned();
            block.words.push(if at == 0 { Word::Open(name) } else { Word::Close(name) });
            return block;
        }
        let mut rest = code.trim();
        let mut offset = None;
        while let Some(address) = rest.chars().next() {
            let length = 1 + rest[address.len_utf8()..]
                .find(|c: char| !(c.is_ascii_digit() || "+-.".contains(c)))
                .unwrap_or(rest.len() - address.len_utf8());
            let (word, tail) = rest.split_at(if address.is_ascii() { length } else { rest.len() });
            rest = tail.trim_start();
            match word.strip_prefix('H') {
                Some(value) => offset = number(value),
                None => mazak_word(&mut block, word),
            }
        }
        // The offset's number is G43's.
        match (block.words.iter_mut().find(|word| matches!(word, Word::Length(_))), offset) {
            (Some(length), Some(offset)) => *length = Word::Length(offset),
            (None, None) => {}
            (Some(_), None) | (None, Some(_)) => block.fault("G43 without H, or H without G43"),
        }
        block
    };
    text.lines().enumerate().map(read).collect()
}

fn mazak_word(block: &mut Block, word: &str) {
    let (address, value) = split(word);
    let Some(figure) = number(value) else { return block.fault(word) };
    // X30 may be 0.003 mm on a control that is set to least increments.
    let pointed = value.contains('.');
    match (address, axis(address)) {
        ("G", _) => mazak_code(block, word, (10.0 * figure).round() as i32),
        ("M", _) if !pointed => match figure as i32 {
            3 | 4 => block.words.push(Word::Turn),
            5 => block.words.push(Word::Stop),
            6 => block.words.push(Word::Change),
            2 | 30 => block.words.push(Word::Finish),
            _ => block.fault(word),
        },
        ("O" | "N", _) if !pointed => {}
        ("T", _) if !pointed => block.words.push(Word::Tool(figure)),
        ("S", _) if !pointed => block.words.push(Word::Speed(figure)),
        ("P", _) if !pointed => block.once(|block| &mut block.order, word, value),
        ("F", _) if pointed => block.once(|block| &mut block.feed, word, value),
        ("K", _) if pointed => block.once(|block| &mut block.knot, word, value),
        ("R", _) if pointed => block.once(|block| &mut block.weight, word, value),
        (_, Some(axis)) if pointed => block.target(axis, word, value),
        _ => block.fault(word),
    }
}

/// A G code, by ten times its number.
fn mazak_code(block: &mut Block, word: &str, code: i32) {
    let other = match code {
        0 => return block.motion(Motion::Rapid, word),
        10 => return block.motion(Motion::Line, word),
        61 => return block.motion(Motion::Through, word),
        62 => return block.motion(Motion::Nurbs, word),
        540 | 640 | 690 | 800 => return,
        170 => Word::State(State::Plane),
        180 | 190 => Word::Other(State::Plane),
        200 => Word::Other(State::Millimetres),
        210 => Word::State(State::Millimetres),
        400 => Word::State(State::NoRadius),
        410 | 420 => Word::Other(State::NoRadius),
        // Its number is that of H in the same block.
        430 => Word::Length(0.0),
        490 => Word::NoLength,
        900 => Word::State(State::Absolute),
        910 => Word::Incremental,
        930 | 950 => Word::Other(State::FeedPerMinute),
        940 => Word::State(State::FeedPerMinute),
        _ => return block.fault(word),
    };
    block.words.push(other);
}
