//! Sinumerik: `N170 G1 Z0 F200`, blanks or none between the words.

use super::{Block, Flow, Motion, State, Target, Value, Word, axes, axis, number, split, value};

pub(super) fn read(text: &str) -> Vec<Block> {
    text.lines().enumerate().map(|(at, line)| block(at + 1, line)).collect()
}

fn block(line: usize, text: &str) -> Block {
    let (code, remark) = text.split_once(';').map_or((text, None), |(code, remark)| (code, Some(remark)));
    let mut block = Block { line, ..Block::default() };
    let words = words(code);
    let numbers = |word: &&str| split(word).0 == "N";
    if words.iter().all(numbers) {
        block.remark(remark.unwrap_or_default());
        return block;
    }
    let mut said = words.iter().copied().skip_while(numbers);
    let first = said.next().expect("not all are numbers");
    if first == "CALL" {
        match (said.next(), said.next(), said.next(), said.next(), said.next()) {
            (Some("BLOCK"), Some(from), Some("TO"), Some(to), None) => {
                block.flow = Some(Flow::Call(from.to_owned(), Some(to.to_owned())));
            }
            _ => block.fault(code),
        }
        return block;
    }
    for word in std::iter::once(first).chain(said) {
        self::word(&mut block, word);
    }
    // With an axis TRANS shifts, alone it ends all shifts.
    if words.contains(&"TRANS") {
        block.shifts();
    } else if block.targets.values().any(|target| matches!(target, Target::To(Value::Parameter(_)))) {
        block.fault(code);
    }
    block
}

/// The words, where blanks may be left out behind a number or a bracket: an address of one letter with its number, or a
/// name with what is assigned to it or stands in its brackets.
pub(in super::super) fn words(code: &str) -> Vec<&str> {
    let mut words = Vec::new();
    let mut rest = code.trim();
    while let Some(first) = rest.chars().next() {
        let length = length(rest).max(first.len_utf8());
        words.push(&rest[..length]);
        rest = rest[length..].trim_start();
    }
    words
}

/// How many bytes the first word has.
fn length(text: &str) -> usize {
    let run = |from: usize, of: fn(char) -> bool| {
        text[from..].find(|c: char| !of(c)).map_or(text.len(), |length| from + length)
    };
    let bracket = |from: usize, close: char| text[from..].find(close).map_or(text.len(), |at| from + at + 1);
    let figure = |c: char| c.is_ascii_digit() || "+-.".contains(c);
    let letters = run(0, |c| c.is_ascii_alphabetic());
    let mut at =
        if letters == 1 { run(1, figure) } else { run(0, |c| c.is_ascii_alphanumeric() || c == '_') };
    if text[at..].starts_with('[') {
        at = bracket(at, ']');
    }
    match text[at..].chars().next() {
        Some('(') => bracket(at, ')'),
        Some(':') => at + 1,
        Some('=') => {
            // R1, DC(37.5), (30,1,2) or 37.5
            let name = run(at + 1, |c| c.is_ascii_alphabetic());
            if text[name..].starts_with('(') { bracket(name, ')') } else { run(name, figure) }
        }
        _ => at,
    }
}

fn word(block: &mut Block, word: &str) {
    let other = match word {
        "G0" => return block.motion(Motion::Rapid, word),
        "G1" => return block.motion(Motion::Line, word),
        "POLY" => return block.motion(Motion::Poly, word),
        "BSPLINE" => return block.motion(Motion::Bspline, word),
        "ASPLINE" | "CSPLINE" => return block.motion(Motion::Through, word),
        "TRAFOOF" | "TRANS" | "MCALL" | "G54" | "G64" | "COMPOF" | "CYCLE800()" | "FGROUP()" => return,
        "SUPA" => return block.machine = true,
        "G17" => Word::State(State::Plane),
        "G18" | "G19" => Word::Other(State::Plane),
        // Under G71 F stays in the unit that the machine is set to.
        "G710" => Word::State(State::Millimetres),
        "G70" | "G71" | "G700" => Word::Other(State::Millimetres),
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
        "M8" => Word::Coolant(true),
        "M9" => Word::Coolant(false),
        "M30" | "M2" => Word::Finish,
        "UPATH" => Word::Upath(true),
        "SPATH" => Word::Upath(false),
        "BAUTO" | "BNAT" | "BTAN" => Word::Ends(true, word.to_owned()),
        "EAUTO" | "ENAT" | "ETAN" => Word::Ends(false, word.to_owned()),
        _ => return valued(block, word),
    };
    block.words.push(other);
}

/// A word with a value.
fn valued(block: &mut Block, word: &str) {
    let list = |start: &str| word.strip_prefix(start).and_then(|rest| rest.strip_suffix(')')).and_then(axes);
    if let Some(group) = list("FGROUP(") {
        return block.words.push(Word::Group(group));
    }
    if let Some(group) = list("SPLINEPATH(1,") {
        return block.words.push(Word::SplinePath(group));
    }
    if let Some(label) = word.strip_suffix(':') {
        return block.flow = Some(Flow::Label(label.to_owned()));
    }
    if let Some((address, text)) = word.split_once('=') {
        let inner = |start: &str| text.strip_prefix(start).and_then(|rest| rest.strip_suffix(')'));
        match (address, axis(address)) {
            ("PL", _) => block.once(|block| &mut block.knot, word, text),
            ("PW", _) => block.once(|block| &mut block.weight, word, text),
            ("SD", _) => block.with(Word::Degree, word, text),
            ("F", _) => block.feed(word, value('R', text)),
            (_, Some(axis)) => {
                let target = match (inner("IC("), inner("DC(")) {
                    (Some(by), _) => number(by).map(Target::By),
                    (None, Some(to)) => number(to).map(Target::Short),
                    (None, None) => value('R', text).map(Target::To),
                };
                block.target(axis, word, target);
            }
            _ if address.starts_with('R') => match (value('R', address), number(text)) {
                (Some(Value::Parameter(of)), Some(number)) if block.assign.is_none() => {
                    block.assign = Some((of, number));
                }
                _ => block.fault(word),
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
                        (0, value) => block.target(axis, word, value.map(Value::Number).map(Target::To)),
                        (_, Some(value)) => drop(block.factors.insert((axis, at + 1), value)),
                        (_, None) => block.fault(word),
                    }
                }
            }
        }
        return;
    }
    let (address, text) = split(word);
    match (address, axis(address)) {
        ("N", _) if number(text).is_some() => {}
        ("T", _) => block.with(Word::Tool, word, text),
        ("D", _) => block.with(Word::Length, word, text),
        ("S", _) => block.with(Word::Speed, word, text),
        ("F", _) => block.feed(word, number(text).map(Value::Number)),
        (_, Some(axis)) => block.target(axis, word, number(text).map(Value::Number).map(Target::To)),
        (_, None) => block.fault(word),
    }
}
