//! Lines as words, for the table of start and end, in the order in which a control comes to them.

use super::super::words::{Dialect, heidenhain_lines, mazak_words, sinumerik_words};

/// What a line says.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Said {
    /// Counted from 1.
    pub(super) line: usize,
    pub(super) words: Vec<String>,
    pub(super) remark: Option<String>,
}

/// Klartext that moves, or calls a tool: these lines are split into words, others are one.
const SPLIT: [&str; 7] = ["L", "LN", "SPL", "C", "CP", "CC", "TOOL"];

/// The lines of a program as it runs: subprograms stand where they are called.
pub(super) fn read(dialect: Dialect, text: &str) -> Vec<Said> {
    let all: Vec<Said> = match dialect {
        Dialect::Sinumerik => text.lines().enumerate().map(|(at, line)| sinumerik(at + 1, line)).collect(),
        Dialect::Heidenhain => heidenhain_lines(text).map(|(at, line)| heidenhain(at, &line)).collect(),
        Dialect::Mazak => text.lines().enumerate().map(|(at, line)| mazak(at + 1, line)).collect(),
    };
    let says = |said: &Said| !said.words.is_empty() || said.remark.is_some();
    expand(&all.into_iter().filter(says).collect::<Vec<Said>>())
}

fn owned(words: &[&str]) -> Vec<String> {
    words.iter().map(|word| (*word).to_owned()).collect()
}

fn sinumerik(line: usize, text: &str) -> Said {
    let (code, remark) = text.split_once(';').map_or((text, None), |(code, text)| (code, Some(text)));
    let mut words = owned(&sinumerik_words(code));
    words.retain(|word| !(word.starts_with('N') && word[1..].bytes().all(|b| b.is_ascii_digit())));
    if words.iter().any(|word| word == "TRANS") && words.len() == 1 {
        words = vec!["TRANS".to_owned()];
    }
    Said { line, words, remark: remark.map(|text| text.trim().to_owned()) }
}

fn mazak(line: usize, text: &str) -> Said {
    let (code, remark) = text.split_once('(').map_or((text, None), |(code, text)| (code, Some(text)));
    let code = code.trim();
    // A parameter is set, or the tape begins or ends.
    let words = if code.contains('=') || code == "%" { vec![code] } else { mazak_words(code) };
    Said { line, words: owned(&words), remark: remark.map(|text| text.trim_end_matches(')').to_owned()) }
}

fn heidenhain(line: usize, text: &str) -> Said {
    let (code, remark) = text.split_once(';').map_or((text, None), |(code, text)| (code, Some(text)));
    let mut words: Vec<&str> = code.split_whitespace().collect();
    if words.first().is_some_and(|word| word.bytes().all(|b| b.is_ascii_digit())) {
        words.remove(0);
    }
    let words = match words.as_slice() {
        [] => Vec::new(),
        ["BEGIN", "PGM", _, unit] => vec![format!("BEGIN PGM {unit}")],
        [first, ..] if SPLIT.contains(first) => owned(&words),
        _ => vec![words.join(" ")],
    };
    Said { line, words, remark: remark.map(|text| text.trim().to_owned()) }
}

/// Where a body begins and ends that a line calls.
fn called(said: &Said) -> Option<(String, String)> {
    let words: Vec<&str> = said.words.iter().map(String::as_str).collect();
    match words.as_slice() {
        // REPEAT may not find labels behind M30.
        ["CALL", "BLOCK", from, "TO", to] => Some((format!("{from}:"), format!("{to}:"))),
        ["M98", label] => Some((format!("O{}", label.strip_prefix('P')?), "M99".to_owned())),
        [line] => Some((format!("LBL {}", line.strip_prefix("CALL LBL ")?), "LBL 0".to_owned())),
        _ => None,
    }
}

/// Every call becomes the lines between its labels. Whether labels and calls are whole is another rule's matter.
fn expand(all: &[Said]) -> Vec<Said> {
    let is = |said: &Said, word: &str| said.words.first().is_some_and(|first| first == word);
    let ends = |said: &&Said| said.words.iter().any(|word| word == "M30" || word == "M2");
    let finish = all.iter().position(|said| ends(&said)).map_or(all.len(), |at| at + 1);
    let (main, behind) = all.split_at(finish);
    let mut run = Vec::new();
    for said in main {
        run.push(said.clone());
        let Some((from, to)) = called(said) else { continue };
        let body = behind.iter().skip_while(|said| !is(said, &from)).skip(1);
        run.extend(body.take_while(|said| !is(said, &to)).cloned());
    }
    let closing =
        behind.iter().filter(|said| is(said, "%") || said.words.iter().any(|w| w.starts_with("END PGM")));
    run.extend(closing.cloned());
    run
}
