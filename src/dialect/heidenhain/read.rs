//! Reads Klartext, in two layers: blocks as written, in words, then what they mean.
//!
//! A block goes on in the next line where its line ends with `~`; listings print SPL without it, so that there a line
//! that begins with K3, K2 or K1 belongs to the block too. A word that is not understood is an error at its place.
//!
//! # How SPL closes
//!
//! A + K1 + K2 + K3 is where the block starts, and the control accepts it within 1 µm of where the tool is. The start
//! and the end of a block in the IR are places where the tool is, so a difference δ = tool − (A + K1 + K2 + K3) has to
//! go somewhere: a₂ = K2 + 3 K3 and a₃ = −K3 stay as the text has them, and δ (1 − s) is added along the block,
//!
//! ```text
//! f(s) = K3 t³ + K2 t² + K1 t + A + δ t          t = 1 − s
//! ```
//!
//! which is as if K1 were K1 + δ: at most 1 µm, at the start, and nothing at the end. What is written here always has
//! δ = 0; elsewhere a warning names the greatest.

mod arcs;
mod closing;
mod fixed;
mod refused;

use super::words::{Word, coordinate, cut, is_continuation, word};
use crate::decimal::{Decimal, Spelling};
use crate::diagnostic::{Diagnostic, Diagnostics, Warned};
use crate::dialect::Reading;
use crate::dialect::assemble::Assembler;
use crate::dialect::block::{Line, Lines, MAX_DIAGNOSTICS, Numbering, block_number};
use crate::dialect::frame::{Frame, Met};
use crate::geom::arc::Sense;
use crate::ir::{COEFFICIENTS, PolynomialBlock, Step, Written, WrittenPolynomial};
use crate::machine::Machine;
use crate::source::{SourceId, Span};
use crate::units::MAX_AXES;
use std::iter::Peekable;
use std::ops::Range;

/// How far from the tool a block may start, mm or degrees: iTNC 530 60642x-04 p.541.
fn start_tolerance() -> Decimal {
    Decimal::new(1, 3)
}

/// Whether a coefficient is zero in the eight decimals that a control keeps.
fn is_zero_in_text(k: Decimal) -> bool {
    magnitude(k).is_some_and(|k| k.compare(Decimal::new(5, 9)).is_lt())
}

fn magnitude(value: Decimal) -> Option<Decimal> {
    if value.compare(Decimal::ZERO).is_lt() { value.times(-1) } else { Some(value) }
}

/// A coordinate as Klartext spells it: `+28.928`.
fn signed(value: Decimal) -> String {
    let mut out = Vec::new();
    value.write(&mut out, Spelling { point_always: false, sign_always: true, leading_zero: true });
    String::from_utf8(out).unwrap_or_default()
}

/// The coefficients of a block.
#[derive(Default)]
struct Coefficients {
    /// K1, K2, K3 of each axis.
    values: [[Option<Decimal>; 3]; MAX_AXES],
    /// Where the first of them stands.
    places: [(usize, usize); MAX_AXES],
}

/// What one block says, L or SPL.
struct Block {
    named: [(usize, i64); MAX_AXES],
    /// Where each of them stands.
    places: [(usize, usize); MAX_AXES],
    count: usize,
    /// Few blocks have any.
    coefficients: Option<Box<Coefficients>>,
    feed: Option<Decimal>,
    rapid: bool,
    /// TX TY TZ.
    direction: [Option<Decimal>; 3],
    spline: bool,
    /// DR of C and CP.
    rotation: Option<Sense>,
    /// Whether it is CP.
    polar: bool,
    /// IPA of CP, degrees.
    turn: Option<Decimal>,
    /// IZ of CP, in units of the last decimal.
    rise: Option<i64>,
}

impl Block {
    fn new(spline: bool) -> Block {
        Block {
            named: [(0, 0); MAX_AXES],
            places: [(0, 0); MAX_AXES],
            count: 0,
            coefficients: None,
            feed: None,
            rapid: false,
            direction: [None; 3],
            spline,
            rotation: None,
            polar: false,
            turn: None,
            rise: None,
        }
    }

    fn named(&self) -> &[(usize, i64)] {
        // `count` grows only while another axis was found, and there are at most `MAX_AXES`.
        &self.named[..self.count]
    }
}

/// SPL blocks in the making: they become one cut.
struct Run {
    polynomial: WrittenPolynomial,
    span: Span,
}

struct Reader<'t, 'm> {
    assembler: Assembler<'m>,
    lines: Peekable<Lines<'t>>,
    run: Option<Run>,
    /// The greatest difference between a block's start and the tool, and the block.
    gap: Option<(Decimal, Span)>,
    /// The first line that goes on without `~`.
    unmarked: Option<Span>,
    /// The centre that CC stated, in X and Y.
    center: Option<[i64; 2]>,
    /// Whether X and Y stand where a CP left them, which is no place in decimals.
    loose: [bool; 2],
    /// Which axes a block named absolutely since a line of the machine file changed from where they count.
    stated: [bool; MAX_AXES],
    /// Remarks behind words of the block in the making.
    remarks: Vec<(String, Span)>,
}

/// Reads a program.
pub(super) fn read(text: &str, source: SourceId, machine: &Machine) -> Result<Warned<Reading>, Diagnostics> {
    let machine = &machine.filled();
    let mut frame = Frame::new(machine);
    let lines = Lines::new(text, machine);
    let mut numbering = Numbering::new(machine, &lines);
    let mut reader = Reader {
        assembler: Assembler::new(machine, source, text),
        lines: lines.peekable(),
        run: None,
        gap: None,
        unmarked: None,
        center: None,
        loose: [false; 2],
        stated: [false; MAX_AXES],
        remarks: Vec::new(),
    };
    // Whether the line before, one of the fixed ones, goes on here: then there is no number.
    let mut goes_on = false;
    while let Some(line) = reader.lines.next() {
        let mut body = line.text.trim_ascii_start();
        if body.is_empty() {
            continue;
        }
        if goes_on {
            body = line.text;
        } else {
            let number = block_number(body);
            if let Some((_, digits)) = number {
                body = body[digits..].trim_ascii_start();
            }
            if number.is_some() || machine.text.number_comments || !body.starts_with(';') {
                numbering.meet(number.map(|(number, _)| number), line.range());
            }
        }
        if line.structure {
            reader.flush();
            continue;
        }
        let start = line.start + line.text.len() - body.len();
        let keyword = keyword(body);
        if keyword != "SPL" {
            reader.flush();
        }
        let span = Span::new(source, line.range());
        let (code, remark) = match body.split_once(';') {
            Some((code, _)) if frame.parts_remarks() && !code.is_empty() && !goes_on => {
                (code.trim_ascii_end(), &body[code.len() + 1..])
            }
            Some(_) | None => (body, ""),
        };
        goes_on = frame.meet(code, span, line.range(), &mut reader.assembler) == Met::Fixed;
        if goes_on {
            reader.fixed(code, &frame);
            reader.remark(remark, span);
            reader.tell_remarks();
            goes_on = ends_marked(body);
            continue;
        }
        match keyword {
            "L" | "LN" | "SPL" | "CC" | "C" | "CP" => reader.block(keyword, body, start, &line, span),
            _ => match body.strip_prefix(';').or_else(|| body.strip_prefix('*')) {
                Some(comment) => reader.assembler.step(Step::Comment(comment.trim().to_owned()), span),
                None => reader.unknown(body, start),
            },
        }
        if MAX_DIAGNOSTICS < reader.assembler.diagnostics.0.len() {
            break;
        }
    }
    reader.flush();
    reader.warn();
    frame.finish(text.len(), &mut reader.assembler);
    let (header, footer) = (frame.start_complete(), frame.footer_complete());
    let Warned { value: (decimals, stated), warnings } = reader.assembler.finish()?;
    let misnumbered = numbering.misnumbered();
    let reading = Reading { decimals, header, footer, misnumbered, stated: Box::new(stated) };
    Ok(Warned { value: reading, warnings })
}

/// Whether a line goes on in the next: it ends with `~`.
#[inline]
fn ends_marked(line: &str) -> bool {
    line.as_bytes().last() == Some(&b'~')
}

/// The capital letters at the start of a block, which say what it is.
#[inline]
fn keyword(body: &str) -> &str {
    let length = body.bytes().take_while(u8::is_ascii_uppercase).count();
    &body[..length] // ASCII so far
}

impl<'t> Reader<'t, '_> {
    /// One block and the lines that continue it: its words, then what they mean.
    ///
    /// `block = "L", [ blank, words ], { "~", end_of_line, words }
    ///     | "SPL", [ blank, words ], { "~", end_of_line, words | end_of_line, { blank }, coefficient, words }
    ///     | ( "LN" | "CC" | "C" | "CP" ), [ blank, words ], { "~", end_of_line, words }`
    fn block(&mut self, keyword: &str, body: &'t str, start: usize, first: &Line<'t>, mut span: Span) {
        let mut block = Block::new(keyword == "SPL");
        block.polar = keyword == "CP";
        let known = self.assembler.diagnostics.0.len();
        let marks = body.bytes().rev().take_while(|byte| matches!(byte, b'~' | b' ')).count();
        let head = start..start + body.len() - marks;
        let mut text = &body[keyword.len()..];
        let mut at = start + keyword.len();
        loop {
            let goes_on = self.words(text, at, &mut block);
            if !goes_on {
                if !(block.spline && self.lines.peek().is_some_and(|next| is_continuation(next.text))) {
                    break;
                }
                self.unmarked = self.unmarked.or(Some(self.assembler.span(at..at + text.len())));
            }
            let Some(next) = self.lines.next() else {
                let end = at + text.len();
                self.assembler.error(
                    "block-unfinished",
                    "the text ends where this block goes on",
                    end - 1..end,
                );
                break;
            };
            if next.text.trim_ascii_start().starts_with(';') {
                let message = "a remark stands between the lines of one block";
                self.assembler.error("remark-within", message, next.range());
            }
            (text, at) = (next.text, next.start);
            span.end = Span::new(span.source, next.range()).end;
        }
        if known == self.assembler.diagnostics.0.len() {
            match keyword {
                "CC" => self.center(&block, head),
                "CP" => self.helix(&block, first.number, head, span),
                _ if !self.is_exact(&block, keyword == "C", head.clone()) => {}
                "C" => self.arc(&block, first.number, head, span),
                "LN" => {
                    if let Some(named) = self.assembler.direction(block.direction, head.clone()) {
                        if (0..3).any(|i| block.named().iter().all(|(axis, _)| *axis != i)) {
                            let message = "LN states X, Y and Z in every block, and one is missing here";
                            return self.assembler.error("place-incomplete", message, head);
                        }
                        for (axis, units) in named {
                            block.named[block.count] = (axis, units);
                            block.count += 1;
                        }
                        self.meant(&block, first.number, head, span);
                    }
                }
                _ if block.direction.iter().any(Option::is_some) => {
                    self.assembler.error("direction", "TX TY TZ belong to LN", head);
                }
                _ => self.meant(&block, first.number, head, span),
            }
        }
        if keyword != "CC" {
            // Whatever is wrong with a block, the next one starts from its end.
            for (axis, units) in block.named() {
                self.assembler.position[*axis] = Some(*units);
                self.stated[*axis] = true;
            }
        }
        if self.run.is_none() {
            self.tell_remarks();
        }
    }

    /// `words = { { blank }, word }, { blank }, [ remark ]`; whether the block goes on in the next line, with `~`.
    #[inline]
    fn words(&mut self, text: &'t str, start: usize, block: &mut Block) -> bool {
        let goes_on = ends_marked(text);
        let code = if goes_on { &text[..text.len() - 1] } else { text };
        let mut rest = code.trim_ascii_start();
        while !rest.is_empty() && !rest.starts_with(';') {
            let at = start + (code.len() - rest.len());
            // Most words are coordinates, and go no way round through a `Word`.
            if let Ok((after, (letter, value))) = coordinate(rest) {
                self.coordinate(letter, value, at..at + (rest.len() - after.len()), block);
                rest = after.trim_ascii_start();
                continue;
            }
            match word(rest) {
                Ok((after, word)) => {
                    self.word(&word, at..at + (rest.len() - after.len()), block);
                    rest = after.trim_ascii_start();
                }
                // `other` takes whatever is no blank and no comment.
                Err(_) => break,
            }
        }
        if let Some(remark) = rest.strip_prefix(';') {
            let end = start + code.len();
            let span = self.assembler.span(end - rest.len()..end);
            self.remark(remark, span);
        }
        goes_on
    }

    #[inline]
    fn coordinate(&mut self, letter: u8, value: Decimal, range: Range<usize>, block: &mut Block) {
        let Some(axis) = self.assembler.letter(letter) else { return self.axis_unknown(letter, range) };
        if let Some(units) = self.assembler.units(axis, value, range.clone()) {
            self.name_axis(block, (axis, letter), units, range);
        }
    }

    fn word(&mut self, word: &Word<'_>, range: Range<usize>, block: &mut Block) {
        match *word {
            Word::Coordinate(letter, value) => self.coordinate(letter, value, range, block),
            Word::Step(letter, value) => self.step(letter, value, range, block),
            Word::Turn(value) => self.turn(value, range, block),
            Word::FeedParameter(_) if block.feed.is_some() || block.rapid => {
                self.assembler.error("feed-twice", "a block has one feed", range);
            }
            Word::FeedParameter(number) => {
                if let Some(value) = self.assembler.parameter(number, range.clone()) {
                    self.word(&Word::Feed(value), range, block);
                }
            }
            Word::Direction(i, value) => {
                if block.direction[i].replace(value).is_some() {
                    let message = "a component of the direction stands twice in this block";
                    self.assembler.error("axis-twice", message, range);
                }
            }
            Word::Coefficient(power, letter, value) => self.coefficient(power, letter, value, range, block),
            Word::Feed(_) | Word::Rapid if block.feed.is_some() || block.rapid => {
                self.assembler.error("feed-twice", "a block has one feed", range);
            }
            Word::Feed(value) if value.compare(Decimal::ZERO).is_le() => {
                self.assembler.error("feed-range", "the feed must be greater than zero", range);
            }
            Word::Feed(value) => block.feed = Some(value),
            Word::Rapid if block.spline => {
                self.assembler.error("rapid-spline", "SPL does not move at rapid traverse", range);
            }
            Word::Rapid => block.rapid = true,
            Word::Uncompensated => {}
            Word::Rotation(sense) => {
                if block.rotation.replace(sense).is_some() {
                    self.assembler.error("word-twice", "DR stands twice in this block", range);
                }
            }
            Word::Other(text) => self.other(text, range),
        }
    }

    /// A block names where an axis goes, once.
    #[inline]
    fn name_axis(&mut self, block: &mut Block, (axis, letter): (usize, u8), units: i64, range: Range<usize>) {
        if block.named().iter().any(|(other, _)| *other == axis) {
            let message = format!("{} stands twice in this block", char::from(letter));
            return self.assembler.error("axis-twice", message, range);
        }
        block.named[block.count] = (axis, units);
        block.places[block.count] = (range.start, range.end);
        block.count += 1;
    }

    fn coefficient(
        &mut self,
        power: usize,
        letter: u8,
        value: Option<Decimal>,
        range: Range<usize>,
        block: &mut Block,
    ) {
        let Some(axis) = self.assembler.letter(letter) else { return self.axis_unknown(letter, range) };
        let name = char::from(letter);
        if !block.spline {
            return self.assembler.error(
                "spline-word",
                format!("K{power}{name} belongs to SPL blocks"),
                range,
            );
        }
        let Some(value) = value else {
            return self.assembler.error("coefficient-range", format!("K{power}{name} is too large"), range);
        };
        // The grammar has K1, K2 and K3 only.
        let coefficients = block.coefficients.get_or_insert_default();
        let place = &mut coefficients.values[axis][power - 1];
        if place.is_some() {
            return self.assembler.error(
                "coefficient-twice",
                format!("K{power}{name} stands twice in this block"),
                range,
            );
        }
        *place = Some(self.assembler.coefficient(axis, value));
        if coefficients.places[axis] == (0, 0) {
            coefficients.places[axis] = (range.start, range.end);
        }
    }

    /// The move that a block makes.
    #[inline]
    fn meant(&mut self, block: &Block, line: u32, head: Range<usize>, span: Span) {
        if block.feed.is_some() && block.feed != self.assembler.feed {
            // A run has one feed.
            self.flush();
            self.assembler.feed = block.feed;
        }
        if block.rotation.is_some() {
            return self.assembler.error("rotation", "DR belongs to C and CP", head);
        }
        match (block.spline, block.rapid) {
            (true, _) => self.spline(block, line, head, span),
            (false, _) if block.count == 0 => {}
            (false, true) => self.assembler.rapid(block.named(), span),
            (false, false) => self.assembler.line(block.named(), line, span),
        }
    }

    /// An SPL block: its coefficients are checked against its coordinates and against where the tool is.
    fn spline(&mut self, block: &Block, line: u32, head: Range<usize>, span: Span) {
        let mut coefficients = [[Decimal::ZERO; COEFFICIENTS]; MAX_AXES];
        let mut apart = Vec::new();
        let mut moved = false;
        let none = Coefficients::default();
        let said = block.coefficients.as_deref().unwrap_or(&none);
        for (axis, k) in said.values.iter().enumerate() {
            let named = block.named().iter().position(|(other, _)| *other == axis);
            let &[Some(k1), Some(k2), Some(k3)] = k else {
                if named.is_some() || k.iter().any(Option::is_some) {
                    let (start, end) = named.map_or(said.places[axis], |n| block.places[n]);
                    self.coefficients_missing(axis, k, start..end);
                    return;
                }
                continue;
            };
            moved = true;
            let Some(n) = named else {
                // Published programs print three zeros, some of them as 1.78E-015, for an axis that stands still.
                if [k1, k2, k3].iter().all(|k| is_zero_in_text(*k)) {
                    continue;
                }
                let (start, end) = said.places[axis];
                let name = self.assembler.machine.axes.name(axis);
                let message = format!("the coefficients move {name}, but the block gives it no end");
                return self.assembler.error("coordinate-missing", message, start..end);
            };
            let end = Decimal::new(block.named[n].1, self.assembler.digits[axis]);
            let sums = || {
                let stated = end.plus(k1)?.plus(k2)?.plus(k3)?;
                Some((stated, k3.times(3)?.plus(k2)?, k3.times(-1)?))
            };
            let Some((stated, a2, a3)) = sums() else {
                let (start, end) = block.places[n];
                return self.assembler.error(
                    "coefficient-range",
                    "the numbers of this axis are too large",
                    start..end,
                );
            };
            coefficients[axis][0] = a2;
            coefficients[axis][1] = a3;
            match self.assembler.position[axis] {
                // Where the text does not say, the block does.
                None => {
                    let digits = self.assembler.digits[axis];
                    let units = stated.units(stated.digits());
                    self.assembler.position[axis] =
                        units.and_then(|units| cut(units, stated.digits(), digits).units(digits));
                }
                Some(tool) => apart.push((axis, stated, Decimal::new(tool, self.assembler.digits[axis]))),
            }
        }
        if !moved {
            return self.assembler.error("spline-empty", "SPL names no axis", head);
        }
        if !self.closes(&apart, head, span) {
            return;
        }
        let end = self.assembler.target(block.named());
        if self.run.is_none() {
            let start = self.assembler.start(block.named(), &end, span);
            self.run = Some(Run { polynomial: WrittenPolynomial { start, blocks: Vec::new() }, span });
        }
        if let Some(run) = &mut self.run {
            run.polynomial.blocks.push(PolynomialBlock {
                pl: Decimal::new(1, 0),
                end,
                coefficients,
                denominator: None,
                line,
            });
            run.span.end = span.end;
        }
    }

    /// Ends a run of SPL blocks: it becomes a cut.
    #[inline]
    fn flush(&mut self) {
        if let Some(Run { polynomial, span }) = self.run.take() {
            let end = polynomial.blocks.last().map_or(polynomial.start, |block| block.end);
            self.assembler.curve(Written::Polynomial(polynomial), &end, span);
            self.tell_remarks();
        }
    }

    /// Warns, once each, of what a control may take otherwise.
    fn warn(&mut self) {
        if let Some(span) = self.unmarked {
            self.assembler.diagnostics.push(
                Diagnostic::warning(
                    "continuation-unmarked",
                    "an SPL block goes on without `~`, as listings print it",
                )
                .at(span, "goes on in the next line")
                .hint("a control wants `~` at the end of this line"),
            );
        }
        if let Some((gap, span)) = self.gap {
            let message = format!("SPL blocks start up to {gap} mm or degrees from where the tool is");
            self.assembler.diagnostics.push(
                Diagnostic::warning("start-gap", message).at(span, "the greatest difference").hint(format!(
                    "the control accepts {}; here the difference fades out along the block",
                    start_tolerance()
                )),
            );
        }
    }
}

#[cfg(test)]
mod tests;
