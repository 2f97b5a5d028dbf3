//! Klartext: `L X+30 Y+0 F200`, a line that ends in `~` goes on in the next.

use super::{Block, Flow, Motion, State, Target, Value, Word, axis, number, split, value};
use std::collections::BTreeMap;

pub(super) fn read(text: &str) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut lines = joined(text);
    for (line, text) in &mut lines {
        blocks.push(klartext(line, &text));
    }
    if let Some((line, text)) = lines.open {
        blocks.push(Block { line, faults: vec![text], ..Block::default() });
    }
    blocks
}

/// The lines of a text with what goes on in the next; what goes on nowhere is left.
pub(in super::super) fn joined(text: &str) -> Joined<'_> {
    Joined { lines: text.lines().enumerate(), open: None }
}

pub(in super::super) struct Joined<'t> {
    lines: std::iter::Enumerate<std::str::Lines<'t>>,
    open: Option<(usize, String)>,
}

impl Iterator for Joined<'_> {
    type Item = (usize, String);

    fn next(&mut self) -> Option<(usize, String)> {
        for (at, line) in self.lines.by_ref() {
            let (start, mut whole) = self.open.take().unwrap_or((at + 1, String::new()));
            match line.trim_end().strip_suffix('~') {
                Some(part) => {
                    whole.push_str(part);
                    self.open = Some((start, whole));
                }
                None => return Some((start, whole + line)),
            }
        }
        None
    }
}

/// Lines that end what another program may have left, and leave nothing themselves.
fn cancels(words: &[&str]) -> bool {
    matches!(
        words,
        ["M127" | "M129"]
            | ["L", "M94", "A" | "B" | "C"]
            | ["PLANE", "RESET", "STAY"]
            | ["CYCL", "DEF", "8.0", "MIRROR", "IMAGE"]
            | ["CYCL", "DEF", "8.1"]
            | ["CYCL", "DEF", "10.0", "ROTATION"]
            | ["CYCL", "DEF", "10.1", "ROT+0"]
            | ["CYCL", "DEF", "11.0", "SCALING"]
            | ["CYCL", "DEF", "11.1", "SCL", "1"]
            | ["CYCL", "DEF", "32.0", "TOLERANCE"]
            | ["CYCL", "DEF", "32.1"]
    )
}

/// `7.2 Z+Q1`, behind `CYCL DEF`.
fn datum(block: &mut Block, part: &str, shift: &str) {
    let (address, text) = shift.split_at(1.min(shift.len()));
    match (part[2..].parse(), axis(address), value('Q', text)) {
        (Ok(part), Some(axis), Some(value)) => {
            block.part = Some(part);
            block.shift = Some(BTreeMap::from([(axis, value)]));
        }
        _ => block.fault(shift),
    }
}

/// `Q1` and `+200` of `FN 0: Q1=+200`.
fn assign(block: &mut Block, name: &str, to: &str) {
    match (value('Q', name), number(to)) {
        (Some(Value::Parameter(of)), Some(number)) => block.assign = Some((of, number)),
        _ => block.fault(name),
    }
}

fn klartext(line: usize, text: &str) -> Block {
    let (code, remark) = text.split_once(';').map_or((text, ""), |(code, remark)| (code, remark));
    let mut block = Block { line, ..Block::default() };
    let mut words: Vec<&str> = code.split_whitespace().collect();
    if words.first().is_some_and(|word| word.bytes().all(|b| b.is_ascii_digit())) {
        words.remove(0);
    }
    match words.as_slice() {
        [] => block.remark(remark),
        ["*", "-", text @ ..] => block.remark(&text.join(" ")),
        ["BEGIN", "PGM", name, unit] => {
            block.words.push(Word::Open((*name).to_owned()));
            let (mm, state) = (*unit == "MM", State::Millimetres);
            block.words.push(if mm { Word::State(state) } else { Word::Other(state) });
        }
        ["END", "PGM", name, "MM" | "INCH"] => block.words.push(Word::Close((*name).to_owned())),
        ["TOOL", "CALL", call @ ..] => tool_call(&mut block, call),
        words if cancels(words) => {}
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
        ["M8"] => block.words.push(Word::Coolant(true)),
        ["M9"] => block.words.push(Word::Coolant(false)),
        ["CYCL", "DEF", "7.0", "DATUM", "SHIFT"] => block.part = Some(0),
        ["CYCL", "DEF", part, shift] if part.starts_with("7.") && shift.is_ascii() => {
            datum(&mut block, part, shift);
        }
        ["FN", "0:", assignment] => match assignment.split_once('=') {
            Some((name, to)) => assign(&mut block, name, to),
            None => block.fault(assignment),
        },
        ["CALL", "LBL", label] => block.flow = Some(Flow::Call((*label).to_owned(), None)),
        ["LBL", "0"] => block.flow = Some(Flow::Return),
        ["LBL", label] => block.flow = Some(Flow::Label((*label).to_owned())),
        ["M5"] => block.words.push(Word::Stop),
        ["M30" | "M2"] => block.words.push(Word::Finish),
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
        let (address, text) = split(word);
        match (*word, address) {
            ("FMAX", _) if !spline => {}
            ("M91", _) if !spline => block.machine = true,
            ("R0", _) if !spline => block.words.push(Word::State(State::NoRadius)),
            ("RL" | "RR", _) => block.words.push(Word::Other(State::NoRadius)),
            (_, "F") => block.feed(word, number(text).map(Value::Number)),
            (_, "FQ") => block.feed(word, value('Q', &word[1..])),
            // K3X-1.5E+1
            (_, "K") if spline && text.is_char_boundary(2) && 2 < text.len() => {
                let (power, axis) = (text[..1].parse().unwrap_or(0), axis(&text[1..2]));
                match (axis, factor(&text[2..])) {
                    (Some(axis), Some(factor))
                        if (1..=3).contains(&power) && !block.factors.contains_key(&(axis, power)) =>
                    {
                        block.factors.insert((axis, power), factor);
                    }
                    _ => block.fault(word),
                }
            }
            _ => match (axis(address), address.strip_prefix('I').and_then(axis)) {
                (Some(axis), _) => {
                    block.target(axis, word, number(text).map(Value::Number).map(Target::To));
                }
                (None, Some(axis)) => block.target(axis, word, number(text).map(Target::By)),
                (None, None) => block.fault(word),
            },
        }
    }
}

/// The number of Heidenhain's K: one digit before the point, and an exponent from ten on.
fn factor(text: &str) -> Option<f64> {
    let (mantissa, power) = text.split_once('E').unwrap_or((text, "0"));
    let mantissa_fits = number(mantissa).is_some_and(|mantissa| mantissa.abs() < 10.0);
    let power_fits = power.parse().is_ok_and(|power: i32| power.abs() <= 255);
    text.parse().ok().filter(|_| mantissa_fits && power_fits)
}
