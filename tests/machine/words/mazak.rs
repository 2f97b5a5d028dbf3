//! Mazak EIA/ISO: `G1 X30. F200.`.

use super::{Block, Flow, Motion, State, Target, Value, Word, axis, number, split, value};

pub(super) fn read(text: &str) -> Vec<Block> {
    text.lines().enumerate().map(|(at, line)| block(at, line)).collect()
}

fn block(at: usize, text: &str) -> Block {
    let (code, remark) = text.split_once('(').map_or((text, ""), |(code, remark)| (code, remark));
    let mut block = Block { line: at + 1, ..Block::default() };
    let code = code.trim();
    if code.is_empty() {
        block.remark(remark.trim_end_matches(')'));
        return block;
    }
    if code == "%" {
        let name = "%".to_owned();
        block.words.push(if at == 0 { Word::Open(name) } else { Word::Close(name) });
        return block;
    }
    if let Some((name, to)) = code.split_once('=') {
        match (value('#', name), number(to).filter(|_| to.contains('.'))) {
            (Some(Value::Parameter(of)), Some(number)) => block.assign = Some((of, number)),
            _ => block.fault(code),
        }
        return block;
    }
    let words = words(code);
    match words.as_slice() {
        ["M98", label] if label.starts_with('P') => {
            block.flow = Some(Flow::Call(label[1..].to_owned(), None));
            return block;
        }
        ["M99"] => {
            block.flow = Some(Flow::Return);
            return block;
        }
        // The first is the program's own number.
        [label] if label.starts_with('O') && 1 < at => {
            block.flow = Some(Flow::Label(label[1..].to_owned()));
            return block;
        }
        _ => {}
    }
    let mut offset = None;
    for word in &words {
        match word.strip_prefix('H') {
            Some(value) => offset = number(value),
            None => self::word(&mut block, word),
        }
    }
    // The offset's number is G43's.
    match (block.words.iter_mut().find(|word| matches!(word, Word::Length(_))), offset) {
        (Some(length), Some(offset)) => *length = Word::Length(offset),
        (None, None) => {}
        (Some(_), None) | (None, Some(_)) => block.fault("G43 without H, or H without G43"),
    }
    if words.contains(&"G52") {
        block.shifts();
    } else if block.targets.values().any(|target| matches!(target, Target::To(Value::Parameter(_)))) {
        block.fault(code);
    }
    block
}

pub(in super::super) fn words(code: &str) -> Vec<&str> {
    let mut words = Vec::new();
    let mut rest = code;
    while let Some(address) = rest.chars().next() {
        let length = rest[address.len_utf8()..]
            .find(|c: char| !(c.is_ascii_digit() || "+-.#".contains(c)))
            .map_or(rest.len(), |length| address.len_utf8() + length);
        let (word, tail) = rest.split_at(length);
        words.push(word);
        rest = tail.trim_start();
    }
    words
}

fn word(block: &mut Block, word: &str) {
    let (address, text) = split(word);
    let held = value('#', text);
    if let (Some(Value::Parameter(_)), "F") = (held, address) {
        return block.feed(word, held);
    }
    if let (Some(value @ Value::Parameter(_)), Some(axis)) = (held, axis(address)) {
        return block.target(axis, word, Some(Target::To(value)));
    }
    let Some(figure) = number(text) else { return block.fault(word) };
    // X30 may be 0.003 mm on a control that is set to least increments.
    let pointed = text.contains('.');
    match (address, axis(address)) {
        ("G", _) => code(block, word, (10.0 * figure).round() as i32),
        ("M", _) if !pointed => match figure as i32 {
            3 | 4 => block.words.push(Word::Turn),
            5 => block.words.push(Word::Stop),
            8 => block.words.push(Word::Coolant(true)),
            9 => block.words.push(Word::Coolant(false)),
            6 => block.words.push(Word::Change),
            2 | 30 => block.words.push(Word::Finish),
            _ => block.fault(word),
        },
        ("O" | "N", _) if !pointed => {}
        ("T", _) if !pointed => block.words.push(Word::Tool(figure)),
        ("S", _) if !pointed => block.words.push(Word::Speed(figure)),
        ("P", _) if !pointed => block.once(|block| &mut block.order, word, text),
        ("F", _) if pointed => block.feed(word, held),
        ("K", _) if pointed => block.once(|block| &mut block.knot, word, text),
        ("R", _) if pointed => block.once(|block| &mut block.weight, word, text),
        (_, Some(axis)) if pointed => block.target(axis, word, held.map(Target::To)),
        _ => block.fault(word),
    }
}

/// A G code, by ten times its number.
fn code(block: &mut Block, word: &str, code: i32) {
    let other = match code {
        0 => return block.motion(Motion::Rapid, word),
        10 => return block.motion(Motion::Line, word),
        61 => return block.motion(Motion::Through, word),
        62 => return block.motion(Motion::Nurbs, word),
        520 | 540 | 640 | 690 | 800 => return,
        530 => return block.machine = true,
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
        930 => Word::Timed(true),
        940 => {
            block.words.push(Word::Timed(false));
            Word::State(State::FeedPerMinute)
        }
        950 => Word::Other(State::FeedPerMinute),
        _ => return block.fault(word),
    };
    block.words.push(other);
}
