//! Reads a Sinumerik program, in two layers: blocks as written, then what they mean.
//!
//! A word that is not understood is an error at its place.

mod arcs;
mod fixed;
mod orientation;
mod path;
mod spline;
mod state;

use super::words::{Word, address, word};
use super::write::SECOND;
use crate::decimal::Decimal;
use crate::diagnostic::{Diagnostics, Warned};
use crate::dialect::Reading;
use crate::dialect::arc;
use crate::dialect::assemble::Assembler;
use crate::dialect::block::{Lines, MAX_DIAGNOSTICS, Numbering, block_number};
use crate::dialect::frame::{Frame, Met};
use crate::geom::arc::{Plane, Sense};
use crate::ir::{
    COEFFICIENTS, Denominator, PolynomialBlock, Step, ThroughKind, Units, Written, WrittenPoints,
    WrittenPolynomial,
};
use crate::machine::Machine;
use crate::source::{SourceId, Span};
use crate::units::{Kind, MAX_AXES};
use fixed::{DEGREE, PLANE, TRANS, parted};
use path::denominator_fault;
use std::ops::Range;

/// G group 1.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Motion {
    None,
    Rapid,
    Line,
    Arc(Sense),
    ArcBy,
    Poly,
    Bspline,
    Through(ThroughKind),
}

/// a₂ … a₅ of each axis.
type Coefficients = [[Decimal; COEFFICIENTS]; MAX_AXES];

/// What one block says.
struct Block {
    named: [(usize, i64); MAX_AXES],
    count: usize,
    /// Those of PO[X] and so on; few blocks have any.
    coefficients: Option<Box<Coefficients>>,
    has_polynomial: bool,
    /// The axes that PO[…] names.
    divides: [bool; MAX_AXES],
    /// The end and the coefficients of PO[].
    denominator: Option<(Decimal, [Decimal; COEFFICIENTS])>,
    pl: Option<Decimal>,
    pw: Option<Decimal>,
    /// I J K.
    center: [Option<Decimal>; 3],
    /// A3 B3 C3.
    direction: [Option<Decimal>; 3],
    /// XH YH ZH, and the coefficients of PO[XH] and so on.
    second: [Option<(Decimal, [Decimal; COEFFICIENTS])>; 3],
    /// I1 J1 K1, as places.
    way: [Option<i64>; 3],
    /// TURN.
    turns: Option<u32>,
    feed: Option<Decimal>,
    starts_spline: bool,
    /// The word of motion.
    motion: Option<Motion>,
    /// Of which kinds a block has words, of those that it has one of.
    kinds: u16,
}

impl Block {
    fn named(&self) -> &[(usize, i64)] {
        &self.named[..self.count]
    }

    fn coefficients(&self) -> &Coefficients {
        const NONE: Coefficients = [[Decimal::ZERO; COEFFICIENTS]; MAX_AXES];
        self.coefficients.as_deref().unwrap_or(&NONE)
    }

    fn coefficients_mut(&mut self) -> &mut Coefficients {
        self.coefficients.get_or_insert_default()
    }
}

/// A spline in the making.
struct Run {
    motion: Motion,
    start: Units,
    points: Vec<Units>,
    lines: Vec<u32>,
    pl: Vec<Decimal>,
    pw: Vec<Option<Decimal>>,
    missing_pl: bool,
    blocks: Vec<PolynomialBlock>,
    degree: usize,
    span: Span,
}

struct Reader<'m> {
    assembler: Assembler<'m>,
    motion: Motion,
    degree: usize,
    upath: bool,
    /// The axes that SPLINEPATH named last.
    splinepath: Vec<usize>,
    /// Whether a second curve leads the tool's direction, ORICURVE.
    second: bool,
    /// G17, G18 or G19.
    plane: Plane,
    /// Whether D calls the length of a tool; none before any D.
    length: Option<bool>,
    run: Option<Run>,
    /// Remarks behind words of the spline in the making.
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
        motion: Motion::None,
        degree: 3,
        upath: false,
        splinepath: Vec::new(),
        second: false,
        plane: Plane::Xy,
        length: None,
        run: None,
        remarks: Vec::new(),
    };
    for line in lines {
        let indent = line.text.len() - line.text.trim_ascii_start().len();
        let mut body = &line.text[indent..];
        let mut start = line.start + indent;
        if body.is_empty() {
            continue;
        }
        let number = body.strip_prefix('N').and_then(block_number);
        if let Some((_, digits)) = number {
            let rest = body[1 + digits..].trim_ascii_start();
            start += body.len() - rest.len();
            body = rest;
        }
        if number.is_some() || machine.text.number_comments || !body.starts_with(';') {
            numbering.meet(number.map(|(number, _)| number), line.range());
        }
        if line.structure {
            reader.flush();
            reader.section();
            continue;
        }
        let span = Span::new(source, line.range());
        // A block of one axis letter and a digit is a move; only others can be lines of the frame.
        let is_move = frame.header_complete()
            && reader.assembler.letter(body.as_bytes().first().copied().unwrap_or(0)).is_some();
        if !is_move || !reader.is_cutting() || frame.is_ending() {
            let (code, remark) = match parted(body) {
                (code, remark) if !code.is_empty() && frame.parts_remarks() => (code, remark),
                _ => (body, ""),
            };
            let steps_before = reader.run.is_some();
            if steps_before && frame.may_begin(code) {
                reader.flush();
            }
            if frame.meet(code, span, line.range(), &mut reader.assembler) == Met::Fixed {
                reader.fixed(code, &frame, span);
                // Lines of the machine file that lead the tip also say how the tool turns.
                reader.second &= !reader.assembler.begins_tip_control();
                if !remark.is_empty()
                    && frame.meet(remark, span, line.range(), &mut reader.assembler) == Met::Other
                {
                    reader.remark(remark, span);
                }
                continue;
            }
        }
        if let Some(comment) = body.strip_prefix(';') {
            reader.flush();
            reader.section();
            reader.assembler.step(Step::Comment(comment.trim().to_owned()), span);
            continue;
        }
        reader.block(body, start, line.number, span);
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

impl Reader<'_> {
    fn is_cutting(&self) -> bool {
        self.motion != Motion::None
    }

    /// A section starts: what its curves need must be said in it, so that it can be restarted.
    fn section(&mut self) {
        self.upath = false;
        self.splinepath.clear();
    }

    /// One block: its words up to a remark, then the move that they make.
    fn block(&mut self, code: &str, start: usize, line: u32, span: Span) {
        let mut block = Block {
            named: [(0, 0); MAX_AXES],
            count: 0,
            coefficients: None,
            has_polynomial: false,
            divides: [false; MAX_AXES],
            denominator: None,
            pl: None,
            pw: None,
            center: [None; 3],
            direction: [None; 3],
            second: [None; 3],
            way: [None; 3],
            turns: None,
            feed: None,
            starts_spline: false,
            motion: None,
            kinds: 0,
        };
        let mut rest = code.trim_ascii_start();
        while !rest.is_empty() && !rest.starts_with(';') {
            let at = start + (code.len() - rest.len());
            // Most words are addresses, and go no way round through a `Word`.
            if let Ok((after, (name, value))) = address(rest) {
                self.addressed(name, value, at..at + (rest.len() - after.len()), &mut block);
                rest = after.trim_ascii_start();
                continue;
            }
            match word(rest) {
                // `X=IC(10)`: a name, and then what is no value.
                Ok((after, word))
                    if !(matches!(word, Word::Keyword(_)) && after.trim_ascii_start().starts_with('=')) =>
                {
                    let range = at..at + (rest.len() - after.len());
                    self.word(word, range, &mut block);
                    rest = after.trim_ascii_start();
                }
                Ok(_) | Err(_) => return self.unreadable(rest, at),
            }
        }
        if block.starts_spline {
            self.flush();
        } else if block.kinds & DEGREE != 0 && self.run.as_ref().is_some_and(|run| run.degree != self.degree)
        {
            let message = "SD stands in the first block of a spline";
            self.assembler.error("spline-word", message, span.start as usize..span.end as usize);
        }
        if let Some(feed) = block.feed {
            self.set_feed(feed, span);
        }
        if !self.directed(&mut block, span) {
            return self.remark(rest, span);
        }
        if block.kinds & TRANS != 0 {
            return self.ends_shift(&block, span);
        }
        if self.has_length(&block, span) {
            self.moved(&block, line, span);
        }
        self.remark(rest, span);
    }

    /// A remark behind the words of a block, which ends no spline.
    fn remark(&mut self, text: &str, span: Span) {
        let text = text.trim_start_matches(';').trim();
        if text.is_empty() {
            return;
        }
        if self.run.is_some() {
            self.remarks.push((text.to_owned(), span));
        } else {
            self.assembler.step(Step::Comment(text.to_owned()), span);
        }
    }

    /// A name and a number.
    #[inline]
    fn addressed(&mut self, name: &str, value: Decimal, range: Range<usize>, block: &mut Block) {
        let axis = match name.as_bytes() {
            [letter] => self.assembler.letter(*letter),
            _ => self.assembler.axis(name),
        };
        let Some(axis) = axis else { return self.address(name, value, range, block) };
        if let Some(units) = self.assembler.units(axis, value, range.clone()) {
            self.name_axis(block, axis, units, range);
        }
    }

    fn word(&mut self, word: Word<'_>, range: Range<usize>, block: &mut Block) {
        match word {
            Word::Address(name, value) => self.addressed(name, value, range, block),
            Word::FeedParameter(number) => {
                if let Some(value) = self.assembler.parameter(number, range.clone()) {
                    self.address("F", value, range, block);
                }
            }
            Word::Shortest(name, value) => self.shortest(name, value, range, block),
            Word::Way(name, value) => self.way(name, value, range, block),
            Word::Polynomial(name, values) => {
                if COEFFICIENTS + 1 < values.len() {
                    return self.assembler.error(
                        "degree-too-high",
                        "a polynomial has an end and at most four coefficients",
                        range,
                    );
                }
                if name.is_empty() {
                    let mut coefficients = [Decimal::ZERO; COEFFICIENTS];
                    coefficients[..values.len() - 1].copy_from_slice(&values[1..]);
                    if block.denominator.replace((values[0], coefficients)).is_some() {
                        self.assembler.error("axis-twice", "PO[] stands twice in this block", range);
                    }
                    block.has_polynomial = true;
                    return;
                }
                if SECOND.contains(&name) {
                    block.has_polynomial = true;
                    return self.second_point(name, &values, range, block);
                }
                let Some(axis) = self.assembler.axis(name) else {
                    return self.assembler.error(
                        "axis-unknown",
                        format!("{name} is not an axis of this machine"),
                        range,
                    );
                };
                if let Some(units) = self.assembler.units(axis, values[0], range.clone()) {
                    self.name_axis(block, axis, units, range);
                    for (own, a) in block.coefficients_mut()[axis].iter_mut().zip(&values[1..]) {
                        *own = self.assembler.coefficient(axis, *a);
                    }
                    block.has_polynomial = true;
                    block.divides[axis] = true;
                }
            }
            Word::Call("SPLINEPATH", arguments) => {
                let mut parts = arguments.split(',').map(str::trim);
                let first = parts.next() == Some("1");
                let axes: Option<Vec<usize>> = parts.map(|axis| self.assembler.axis(axis)).collect();
                match axes.filter(|_| first) {
                    Some(axes) => self.splinepath = axes,
                    None => self.assembler.error(
                        "splinepath",
                        "SPLINEPATH takes 1 and axes of this machine",
                        range,
                    ),
                }
            }
            Word::Call("FGROUP", arguments) => {
                // Feed and synchronisation are those of the geometry axes; another group means another path.
                if !arguments.trim().is_empty() && !self.is_path_group(arguments, false) {
                    let axes = self.assembler.machine.axes;
                    let linear =
                        |name: &str| self.assembler.axis(name).is_some_and(|i| axes.kind(i) == Kind::Linear);
                    let id = if arguments.split(',').map(str::trim).all(linear) {
                        "fgroup-axes"
                    } else {
                        "fgroup"
                    };
                    let names = self.assembler.machine.linear_names();
                    let message = format!("FGROUP names other axes than {names}, so that F is another speed");
                    self.assembler.error(id, message, range);
                }
            }
            Word::Call(name, _) => {
                self.assembler.error("word-unknown", format!("`{name}(…)` is not understood"), range);
            }
            Word::Keyword(keyword) => self.keyword(keyword, range, block),
        }
    }

    fn name_axis(&mut self, block: &mut Block, axis: usize, units: i64, range: Range<usize>) {
        if block.named().iter().any(|(other, _)| *other == axis) {
            let name = self.assembler.machine.axes.name(axis);
            return self.assembler.error("axis-twice", format!("{name} stands twice in this block"), range);
        }
        block.named[block.count] = (axis, units);
        block.count += 1;
    }

    fn set_motion(&mut self, motion: Motion) {
        if self.motion != motion {
            self.flush();
        }
        self.motion = motion;
    }

    fn address(&mut self, name: &str, value: Decimal, range: Range<usize>, block: &mut Block) {
        let whole = value.units(0);
        if name != "G" {
            self.once(name, &range, block);
        }
        match (name, whole) {
            ("G", Some(0)) => self.motion_word(Motion::Rapid, &range, block),
            ("G", Some(1)) => self.motion_word(Motion::Line, &range, block),
            ("G", Some(2)) => self.motion_word(Motion::Arc(Sense::Clockwise), &range, block),
            ("G", Some(3)) => self.motion_word(Motion::Arc(Sense::CounterClockwise), &range, block),
            ("G", Some(17..=19)) if block.kinds & PLANE != 0 => {
                self.assembler.error("codes-conflict", "two planes in one block", range);
            }
            ("G", Some(code @ 17..=19)) => {
                block.kinds |= PLANE;
                match code {
                    17 => self.plane = Plane::Xy,
                    18 => self.take_plane(Plane::Zx, range),
                    _ => self.take_plane(Plane::Yz, range),
                }
            }
            ("TURN", _) => self.turn(value, range, block),
            ("I", _) => block.center[0] = Some(value),
            ("J", _) => block.center[1] = Some(value),
            ("K", _) => block.center[2] = Some(value),
            ("G", Some(code)) if self.state_code(code, &range) => {}
            ("M", Some(_)) => self.m_function(value, range),
            ("F", _) => {
                if value.compare(Decimal::ZERO).is_le() {
                    self.assembler.error("feed-range", "the feed must be greater than zero", range);
                } else {
                    block.feed = Some(value);
                }
            }
            ("A3", _) => block.direction[0] = Some(value),
            ("B3", _) => block.direction[1] = Some(value),
            ("C3", _) => block.direction[2] = Some(value),
            ("XH" | "YH" | "ZH", _) => self.second_point(name, &[value], range, block),
            ("PL", _) => block.pl = Some(value),
            ("PW", _) => block.pw = Some(value),
            ("SD", Some(degree @ 2..=3)) => {
                self.degree = degree as usize;
                block.kinds |= DEGREE;
            }
            ("SD", _) => self.assembler.error("degree-range", "SD is 2 or 3", range),
            ("A" | "B" | "C" | "U" | "V" | "W" | "X" | "Y" | "Z", _) => {
                self.assembler.axis_unknown(name, range);
            }
            _ => self.assembler.error("word-unknown", format!("`{name}{value}` is not understood"), range),
        }
    }

    /// The move that a block makes.
    fn moved(&mut self, block: &Block, line: u32, span: Span) {
        let whole = || span.start as usize..span.end as usize;
        if block.has_polynomial && self.motion != Motion::Poly {
            return self.assembler.error(
                "po-without-poly",
                "PO[…] stands in a block that is not POLY",
                whole(),
            );
        }
        let spline = matches!(self.motion, Motion::Bspline);
        if (block.pl.is_some() && !spline && self.motion != Motion::Poly) || (block.pw.is_some() && !spline) {
            return self.assembler.error("spline-word", "PL and PW belong to spline blocks", whole());
        }
        let arc = matches!(self.motion, Motion::Arc(_));
        if !arc && block.center.iter().any(Option::is_some) {
            return self.assembler.error("arc-word", "I J K belong to G2 and G3", whole());
        }
        if !arc && block.turns.is_some() {
            return self.assembler.error("arc-word", "TURN belongs to G2 and G3", whole());
        }
        let by = self.motion == Motion::ArcBy;
        if !by && block.way.iter().any(Option::is_some) {
            return self.assembler.error("arc-word", "I1 J1 K1 belong to CIP", whole());
        }
        let bare = block.center.iter().all(Option::is_none) && block.way.iter().all(Option::is_none);
        if block.count == 0 && !block.has_polynomial && bare {
            if block.pl.is_some() || block.pw.is_some() {
                self.assembler.error("spline-word", "a spline block without an axis", whole());
            }
            return;
        }
        match self.motion {
            Motion::None => {
                self.assembler.error("motion-missing", "a move before any G0, G1, POLY or spline", whole());
            }
            Motion::Rapid => self.assembler.rapid(block.named(), span),
            Motion::Line => self.assembler.line(block.named(), line, span),
            Motion::Arc(sense) => {
                let (plane, offsets, turns) = (self.plane, block.center, block.turns.unwrap_or(0));
                let said = arc::Said { plane, sense, named: block.named(), offsets, turns, line, span };
                arc::read(&mut self.assembler, &said);
            }
            Motion::ArcBy => self.arc_by(block, line, span),
            Motion::Poly | Motion::Bspline | Motion::Through(_) => self.spline_block(block, line, span),
        }
    }

    fn spline_block(&mut self, block: &Block, line: u32, span: Span) {
        let target = self.assembler.target(block.named());
        if self.run.is_none() {
            let start = self.assembler.start(block.named(), &target, span);
            self.run = Some(Run {
                motion: self.motion,
                start,
                points: Vec::new(),
                lines: Vec::new(),
                pl: Vec::new(),
                pw: Vec::new(),
                missing_pl: false,
                blocks: Vec::new(),
                degree: self.degree,
                span,
            });
        }
        for (axis, units) in block.named() {
            self.assembler.position[*axis] = Some(*units);
        }
        let Some(run) = &mut self.run else { return };
        run.span.end = span.end;
        run.lines.push(line);
        if self.motion == Motion::Poly {
            let pl = block.pl.unwrap_or(Decimal::new(1, 0));
            if pl.compare(Decimal::ZERO).is_le() {
                return self.assembler.error(
                    "pl-range",
                    "PL of a POLY block must be greater than zero",
                    span.start as usize..span.end as usize,
                );
            }
            let denominator = block.denominator.map(|(end, coefficients)| Denominator {
                end,
                coefficients,
                divides: block.divides,
            });
            let coefficients = *block.coefficients();
            let start = run.blocks.last().map_or(run.start, |last| last.end);
            let own = PolynomialBlock { pl, end: target, coefficients, denominator, line };
            if let Some((id, message)) = denominator_fault(&self.assembler, &own, &start, block.named()) {
                return self.assembler.error(id, message, span.start as usize..span.end as usize);
            }
            run.blocks.push(own);
        } else {
            run.points.push(target);
            run.missing_pl |= block.pl.is_none();
            run.pl.push(block.pl.unwrap_or(Decimal::ZERO));
            run.pw.push(block.pw);
        }
    }

    /// Ends a spline: it becomes a cut.
    fn flush(&mut self) {
        let Some(run) = self.run.take() else { return };
        let span = run.span;
        let end =
            run.points.last().copied().or(run.blocks.last().map(|block| block.end)).unwrap_or(run.start);
        let curve = match run.motion {
            Motion::Poly => {
                Some(Written::Polynomial(WrittenPolynomial { start: run.start, blocks: run.blocks }))
            }
            Motion::Bspline => self.bspline(run).map(Written::Nurbs),
            Motion::Through(kind) => {
                let stride = self.assembler.machine.axes.count();
                let units = run.points.iter().flat_map(|point| point[..stride].to_vec()).collect();
                Some(Written::Through(
                    kind,
                    WrittenPoints { start: run.start, stride, units, lines: run.lines, rates: Vec::new() },
                ))
            }
            Motion::None | Motion::Rapid | Motion::Line | Motion::Arc(_) | Motion::ArcBy => None,
        };
        if let Some(curve) = curve {
            self.path_reference(&curve, span);
            self.assembler.curve(curve, &end, span);
        }
        for (text, span) in std::mem::take(&mut self.remarks) {
            self.assembler.step(Step::Comment(text), span);
        }
    }
}

#[cfg(test)]
mod tests;
