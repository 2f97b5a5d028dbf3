//! Reads a program of an ISO control, in two layers: blocks as written, then what they mean.
//!
//! A word that is not understood is an error at its place. What a number without a decimal point is, the machine file says: X30 is
//! 30 mm on one control and 0.030 mm on another. A remark behind the words of a block is read as coming after it. No remark ends a
//! spline; where one stands inside a spline, it is read as coming after it.

mod codes;
mod fixed;
mod nurbs;
mod tool;
mod words;

use super::{Offset, is_block};
use crate::decimal::Decimal;
use crate::diagnostic::{Diagnostic, Diagnostics, Warned};
use crate::dialect::Reading;
use crate::dialect::arc;
use crate::dialect::assemble::Assembler;
use crate::dialect::block::{Lines, MAX_DIAGNOSTICS, Numbering, block_number};
use crate::dialect::frame::{Frame, Met};
use crate::geom::arc::{Plane, Sense};
use crate::ir::{Step, ThroughKind, Units, Written, WrittenPoints};
use crate::machine::Machine;
use crate::machine::template::Template;
use crate::source::{SourceId, Span};
use crate::units::{Axis, MAX_AXES};
use nurbs::NurbsRun;
use std::ops::Range;
use words::{Word, address, word};

/// G group 1.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Motion {
    None,
    Rapid,
    Line,
    Arc(Sense),
    Nurbs,
    Through,
}

/// A value and where it stands.
type Placed = (Decimal, Range<usize>);

/// What one block says.
#[derive(Default)]
struct Block {
    named: [(usize, i64); MAX_AXES],
    /// Where each named axis stands in the text.
    places: [usize; MAX_AXES],
    count: usize,
    motion: Option<Motion>,
    feed: Option<Placed>,
    i: Option<Placed>,
    j: Option<Placed>,
    k: Option<Placed>,
    r: Option<Placed>,
    p: Option<Placed>,
    q: Option<Placed>,
    h: Option<Placed>,
    /// G05 or G05.1, in tenths.
    high_speed: Option<(i64, Range<usize>)>,
    /// G43.
    offset: Option<Range<usize>>,
    plane: Option<Plane>,
    /// The code of each group that a block has one of, in tenths; 0 for none.
    codes: [i64; 9],
}

impl Block {
    fn named(&self) -> &[(usize, i64)] {
        &self.named[..self.count]
    }
}

/// A spline in the making.
enum Run {
    Nurbs(NurbsRun),
    Through { start: Units, units: Vec<i64>, lines: Vec<u32>, span: Span },
}

#[allow(clippy::struct_excessive_bools, reason = "each is about another word")]
struct Reader<'m> {
    assembler: Assembler<'m>,
    motion: Motion,
    run: Option<Run>,
    /// Remarks within the spline in the making.
    remarks: Vec<(String, Span)>,
    z: Option<usize>,
    /// The register whose length is still to be called.
    offset_due: Option<u32>,
    /// The register whose length was called.
    offset_tool: Option<u32>,
    /// The register whose length this section may call again, once.
    offset_again: Option<u32>,
    /// How the register of a length is written behind H.
    offset_call: Option<Template>,
    /// Whether a second % ended the text.
    ended: bool,
    /// Whether a line was read.
    begun: bool,
    warned_left_out: bool,
    /// G17, G18 or G19.
    plane: Plane,
}

/// Reads a program.
pub(super) fn read(text: &str, source: SourceId, machine: &Machine) -> Result<Warned<Reading>, Diagnostics> {
    let offset = Offset::new(machine);
    let machine: &Machine = &offset.machine;
    let mut frame = Frame::new(machine);
    let lines = Lines::new(text, machine);
    let mut numbering = Numbering::new(machine, &lines);
    let mut reader = Reader {
        assembler: Assembler::new(machine, source, text),
        motion: Motion::None,
        run: None,
        remarks: Vec::new(),
        z: Axis::new("Z").and_then(|z| machine.axes.index_of(z)),
        offset_due: None,
        offset_tool: None,
        offset_again: None,
        offset_call: None,
        ended: false,
        begun: false,
        warned_left_out: false,
        plane: Plane::Xy,
    };
    for line in lines {
        let mut body = line.text.trim_ascii_start();
        if body.is_empty() {
            continue;
        }
        let number = body.strip_prefix('N').and_then(block_number);
        if let Some((_, digits)) = number {
            body = body[1 + digits..].trim_ascii_start();
        }
        if number.is_some() || is_block(body) || (machine.text.number_comments && body.starts_with('(')) {
            numbering.meet(number.map(|(number, _)| number), line.range());
        }
        if line.structure {
            reader.flush();
            continue;
        }
        if reader.ended {
            let message = "text behind the % that ends the program";
            reader.error("text-after-end", message, line.range());
            break;
        }
        let start = line.start + line.text.len() - body.len();
        let span = Span::new(source, line.range());
        // A line that begins with an axis is a move, and by far the most are; only others can be lines of the frame.
        let first = body.bytes().next().unwrap_or(b' ');
        let is_move = frame.header_complete()
            && reader.motion != Motion::None
            && reader.assembler.letter(first).is_some();
        if !is_move || frame.is_ending() {
            let (code, remark) = if frame.parts_remarks() { parted(body) } else { (body, "") };
            if reader.run.is_some() && frame.may_begin(code) {
                reader.flush();
            }
            if frame.meet(code, span, line.range(), &mut reader.assembler) == Met::Fixed {
                reader.fixed(code, &frame, span);
                reader.tool_line(code, &offset, line.range());
                reader.home_line(code);
                if reader.assembler.begins_tip_control() {
                    // Its lines hold the length of the tool.
                    reader.offset_due = None;
                }
                if !remark.is_empty()
                    && frame.meet(remark, span, line.range(), &mut reader.assembler) == Met::Other
                {
                    let start = line.start + line.text.len() - remark.len();
                    reader.block(remark, start, line.number, span);
                }
                reader.begun = true;
                continue;
            }
        }
        reader.block(body.strip_suffix(';').unwrap_or(body), start, line.number, span);
        reader.begun = true;
        if MAX_DIAGNOSTICS < reader.assembler.diagnostics.0.len() {
            break;
        }
    }
    reader.flush();
    frame.finish(text.len(), &mut reader.assembler);
    let (header, footer) = (frame.start_complete(), frame.footer_complete());
    let Warned { value: (decimals, stated), warnings } = reader.assembler.finish()?;
    let misnumbered = numbering.misnumbered();
    let reading = Reading { decimals, header, footer, misnumbered, stated: Box::new(stated) };
    Ok(Warned { value: reading, warnings })
}

/// The words of a block, and the remarks behind them.
fn parted(line: &str) -> (&str, &str) {
    match line.find('(') {
        Some(at) if 0 < at && line.ends_with(')') => (line[..at].trim_ascii_end(), &line[at..]),
        Some(_) | None => (line, ""),
    }
}

impl Reader<'_> {
    fn error(&mut self, id: &'static str, message: impl Into<String>, range: Range<usize>) {
        self.assembler.error(id, message, range);
    }

    /// One block: its words, then what they do together.
    fn block(&mut self, code: &str, start: usize, line: u32, span: Span) {
        let mut block = Block::default();
        let (mut remarks, mut words) = (Vec::new(), false);
        let mut rest = code;
        if rest == "%" {
            self.ended = self.begun;
            return;
        }
        while !rest.is_empty() {
            let at = start + (code.len() - rest.len());
            // Most words are addresses, and go no way round through a `Word`.
            if let Ok((after, (letter, value))) = address(rest) {
                let range = at..at + (rest.len() - after.len());
                words = true;
                self.addressed(letter, value, &rest[..range.len()], range, &mut block);
                rest = after.trim_ascii_start();
                continue;
            }
            let Ok((after, word)) = word(rest) else { return self.unreadable(rest, at) };
            let range = at..at + (rest.len() - after.len());
            words |= !matches!(word, Word::Remark(_));
            match word {
                Word::Remark(text) => remarks.push(text.trim()),
                Word::Address(letter, value) => {
                    self.addressed(letter, value, &rest[..range.len()], range, &mut block);
                }
                Word::FeedParameter(number) => {
                    if let Some(value) = self.assembler.parameter(number, range.clone()) {
                        self.address(b'F', value, range, &mut block);
                    }
                }
                Word::Assignment(name, value) => match self.assembler.axis(name) {
                    Some(axis) => {
                        let value = self.length(b'X', value, &rest[..range.len()], &range);
                        self.axis(&mut block, axis, value, range);
                    }
                    None => {
                        self.assembler.axis_unknown(name, range);
                    }
                },
            }
            rest = after.trim_ascii_start();
        }
        if words {
            self.act(block, line, span);
        }
        for text in remarks {
            let text = text.to_owned();
            if self.run.is_some() {
                self.remarks.push((text, span));
            } else {
                self.remark(text, span);
            }
        }
    }

    /// A length or an angle as it counts: without a point it may be in least increments.
    #[inline]
    fn length(&mut self, letter: u8, value: Decimal, digits: &str, range: &Range<usize>) -> Decimal {
        if value.is_zero() || digits.as_bytes().contains(&b'.') {
            value
        } else {
            self.without_point(letter, value, range)
        }
    }

    #[cold]
    fn without_point(&mut self, letter: u8, value: Decimal, range: &Range<usize>) -> Decimal {
        let Some(one) = self.assembler.machine.text.without_point else {
            let word = format!("{}{value}", char::from(letter));
            let message = format!(
                "`{word}` has no point: it is {value} on one control and a thousandth of that on another"
            );
            let diagnostic =
                Diagnostic::error("point-missing", message).at(self.assembler.span(range.clone()), "");
            self.assembler.diagnostics.push(diagnostic.hint(format!(
                "write `{word}.`, or say in the machine file what 1 is: [text] without_point = 1.0 or 0.001"
            )));
            return value;
        };
        let scaled = value.units(0).and_then(|count| one.times(count));
        if scaled.is_none() {
            self.error("number-range", "this number is out of range", range.clone());
        }
        scaled.unwrap_or(value)
    }

    /// A letter and a number, and both as they stand.
    #[inline]
    fn addressed(&mut self, letter: u8, value: Decimal, word: &str, range: Range<usize>, block: &mut Block) {
        match self.assembler.letter(letter) {
            Some(axis) => {
                let value = self.length(letter, value, word, &range);
                self.axis(block, axis, value, range);
            }
            None if matches!(letter, b'I' | b'J' | b'K') => {
                let value = self.length(letter, value, word, &range);
                self.address(letter, value, range, block);
            }
            None => self.address(letter, value, range, block),
        }
    }

    /// A remark starts a section.
    fn remark(&mut self, text: String, span: Span) {
        self.assembler.step(Step::Comment(text), span);
        self.offset_again = self.offset_tool;
    }

    /// An axis that wraps takes the short way to its place.
    fn short_way(&mut self, block: &mut Block) {
        for at in 0..block.count {
            let (axis, units) = block.named[at];
            if !self.assembler.wraps(axis) || self.assembler.position[axis].is_none() {
                continue;
            }
            match self.assembler.nearest(axis, units) {
                Some(nearest) => block.named[at].1 = nearest,
                None => {
                    let name = self.assembler.machine.axes.name(axis);
                    let message = format!("{name} turns by 180 degrees here, and both ways are as long");
                    self.error("short-way", message, block.places[at]..block.places[at] + 1);
                }
            }
        }
    }

    fn unreadable(&mut self, rest: &str, at: usize) {
        let length = rest.find([' ', '\t']).unwrap_or(rest.len());
        let (id, message) = match rest.bytes().next() {
            Some(b'/') => ("block-skip", "whether a block behind / runs is decided at the machine"),
            Some(b'(') => ("remark-open", "this remark has no end"),
            _ => ("word-unreadable", "this word cannot be read"),
        };
        self.error(id, message, at..at + length);
    }

    #[inline]
    fn axis(&mut self, block: &mut Block, axis: usize, value: Decimal, range: Range<usize>) {
        let at = range.start;
        let Some(units) = self.assembler.units(axis, value, range.clone()) else { return };
        if block.named().iter().any(|(other, _)| *other == axis) {
            let name = self.assembler.machine.axes.name(axis);
            return self.error("axis-twice", format!("{name} stands twice in this block"), range);
        }
        // There are no more axes than places, and none comes here twice.
        block.named[block.count] = (axis, units);
        block.places[block.count] = at;
        block.count += 1;
    }

    fn address(&mut self, letter: u8, value: Decimal, range: Range<usize>, block: &mut Block) {
        let slot = match letter {
            b'G' => return self.code(value, range, block),
            b'F' => &mut block.feed,
            b'I' => &mut block.i,
            b'J' => &mut block.j,
            b'K' => &mut block.k,
            b'R' => &mut block.r,
            b'P' => &mut block.p,
            b'Q' => &mut block.q,
            b'H' => &mut block.h,
            // The program's number; its name stands in the header.
            b'O' if self.assembler.number != 0 || self.assembler.has_steps() => {
                return self.error("program-start", format!("another program starts here: O{value}"), range);
            }
            b'O' if value.units(0).is_some_and(|number| 0 < number) => {
                if self.assembler.name.is_empty() {
                    self.assembler.name = format!("O{value}");
                }
                if self.assembler.number == 0 {
                    let number = value.units(0).and_then(|number| u32::try_from(number).ok());
                    self.assembler.number = number.filter(|number| *number <= 9999).unwrap_or(0);
                }
                return;
            }
            b'M' => return self.m_function(value, range),
            b'U'..=b'Z' | b'A'..=b'C' => {
                return self.assembler.axis_unknown(&char::from(letter).to_string(), range);
            }
            _ => {
                return self.error(
                    "word-unknown",
                    format!("`{}{value}` is not understood", char::from(letter)),
                    range,
                );
            }
        };
        if slot.is_some() {
            return self.error(
                "word-twice",
                format!("{} stands twice in this block", char::from(letter)),
                range,
            );
        }
        *slot = Some((value, range));
    }

    /// What the words of a block do together.
    fn act(&mut self, mut block: Block, line: u32, span: Span) {
        let whole = || span.start as usize..span.end as usize;
        if let Some(motion) = block.motion {
            // G06.2 begins a curve each time; the others stay in force.
            if motion != self.motion || motion == Motion::Nurbs {
                self.flush();
            }
            self.motion = motion;
        }
        if let Some(plane) = block.plane {
            self.flush();
            self.plane = plane;
        }
        if let Some((code, range)) = block.high_speed.take() {
            self.high_speed(code, &mut block, range);
        }
        if block.offset.is_some() {
            // It ends a spline, and the remarks that waited for that end start their sections.
            self.flush();
        }
        if block.offset.is_some() || block.h.is_some() || self.offset_due.is_some() {
            self.length_offset(&mut block, whole());
        }
        let mut rate = None;
        if let Some((feed, range)) = block.feed.take() {
            if self.assembler.inverse {
                rate = Some(feed);
            } else {
                self.set_feed(feed, range);
            }
        }
        if self.assembler.inverse && block.count != 0 && self.motion != Motion::Rapid {
            if self.motion != Motion::Line {
                return self.error("inverse-time", "under G93 only straight moves are read", whole());
            }
            if rate.is_none_or(|rate| rate.compare(Decimal::ZERO).is_le()) {
                return self.error("feed-missing", "under G93 every block has an F above zero", whole());
            }
        }
        if let Some((_, range)) = block.q.take() {
            self.error("word-unknown", "Q is read with G05.1 only", range);
        }
        if !self.directed(&mut block, whole()) {
            return;
        }
        let arc = matches!(self.motion, Motion::Arc(_));
        for (name, word) in [("I", &block.i), ("J", &block.j)] {
            if let (Some((_, range)), false) = (word, arc) {
                self.error("arc-word", format!("{name} belongs to G2 and G3"), range.clone());
            }
        }
        if self.motion == Motion::Nurbs {
            return self.nurbs_block(&block, line, span);
        }
        let center = [block.i.take(), block.j.take(), block.k.take_if(|_| arc)];
        let offsets = center.map(|word| word.map(|(value, _)| value));
        if let (true, Some((_, range))) = (arc, &block.r) {
            let message = "an arc by its radius is not read; its centre in I J K is";
            return self.error("arc-center", message, range.clone());
        }
        for (name, word) in [("K", block.k.take()), ("R", block.r.take()), ("P", block.p.take())] {
            if let Some((_, range)) = word {
                self.error("spline-word", format!("{name} belongs to G06.2"), range);
            }
        }
        if block.count == 0 && !(arc && offsets.iter().any(Option::is_some)) {
            return;
        }
        match self.motion {
            // Once, and not where a code of motion before it was refused.
            Motion::None if self.assembler.diagnostics.has_errors() => {}
            Motion::None => self.error("motion-missing", "a move before any G0, G1 or spline", whole()),
            Motion::Rapid => self.assembler.rapid(block.named(), span),
            Motion::Line => {
                self.short_way(&mut block);
                self.assembler.rate = rate;
                self.assembler.line(block.named(), line, span);
            }
            Motion::Arc(sense) => {
                let (plane, turns) = (self.plane, 0);
                let said = arc::Said { plane, sense, named: block.named(), offsets, turns, line, span };
                arc::read(&mut self.assembler, &said);
            }
            Motion::Through => self.through_block(&block, line, span),
            Motion::Nurbs => {} // met above
        }
    }

    /// How fast the control runs, not where:
    /// `high_speed = "G", { "0" }, "5", { blank }, "P", ( "0" | "1" | "2" | "10000" )
    ///     | "G", { "0" }, "5.1", { blank }, "Q", ( "0" | "1" )`, also with words between and beside them
    fn high_speed(&mut self, code: i64, block: &mut Block, range: Range<usize>) {
        let whole = |word: Option<Placed>| word.and_then(|(value, _)| value.units(0));
        let how = if code == 50 {
            whole(block.p.take()).filter(|how| matches!(how, 0 | 1 | 2 | 10_000))
        } else {
            whole(block.q.take()).filter(|how| matches!(how, 0 | 1))
        };
        if let Some(how) = how {
            self.high_speed_runs(code, how, &range, false);
        } else {
            self.error("code-refused", "only G05 P0, P1, P2, P10000 and G05.1 Q0, Q1 are read", range);
        }
    }

    fn set_feed(&mut self, feed: Decimal, range: Range<usize>) {
        if feed.compare(Decimal::ZERO).is_le() {
            return self.error("feed-range", "the feed must be greater than zero", range);
        }
        if self.assembler.feed != Some(feed) {
            if matches!(&self.run, Some(Run::Nurbs(run)) if 0 < run.closing) {
                self.flush();
            }
            if self.run.is_some() {
                return self.error("feed-in-spline", "a spline has one feed, that of its first block", range);
            }
            self.assembler.feed = Some(feed);
        }
    }

    fn through_block(&mut self, block: &Block, line: u32, span: Span) {
        let target = self.assembler.target(block.named());
        let start =
            if self.run.is_none() { self.assembler.start(block.named(), &target, span) } else { target };
        for (axis, units) in block.named() {
            self.assembler.position[*axis] = Some(*units);
        }
        let stride = self.assembler.machine.axes.count();
        let run = self.run.get_or_insert_with(|| Run::Through {
            start,
            units: Vec::new(),
            lines: Vec::new(),
            span,
        });
        if let Run::Through { units, lines, span: whole, .. } = run {
            units.extend_from_slice(&target[..stride]);
            lines.push(line);
            whole.end = span.end;
        }
    }

    /// Ends a spline: it becomes a cut. Remarks within it come after it.
    fn flush(&mut self) {
        match self.run.take() {
            None => {}
            Some(Run::Through { start, units, lines, span }) => {
                let stride = self.assembler.machine.axes.count();
                let mut end = start;
                if let Some(last) = units.chunks_exact(stride).next_back() {
                    end[..stride].copy_from_slice(last);
                }
                let points = WrittenPoints { start, stride, units, lines, rates: Vec::new() };
                self.assembler.curve(Written::Through(ThroughKind::Fine, points), &end, span);
            }
            Some(Run::Nurbs(run)) => {
                let (end, span) = (run.points.last().copied().unwrap_or(run.start), run.span);
                if let Some(nurbs) = self.nurbs(run) {
                    self.assembler.curve(Written::Nurbs(nurbs), &end, span);
                }
            }
        }
        for (text, span) in std::mem::take(&mut self.remarks) {
            self.remark(text, span);
        }
    }
}

#[cfg(test)]
mod tests;
