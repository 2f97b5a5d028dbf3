//! Reads a Sinumerik program, in two layers: blocks as written, then what they mean.
//!
//! A word that is not understood is an error at its place.

mod arcs;
mod orientation;
mod path;
mod spline;
mod state;

use super::words::{Word, address, word};
use super::write::SECOND;
use crate::decimal::Decimal;
use crate::diagnostic::{Diagnostic, Diagnostics, Warned};
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
use crate::pass::check::moving;
use crate::source::{SourceId, Span};
use crate::units::{Kind, MAX_AXES};
use path::{denominator_fault, linear_in_parameter};
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

/// Codes that state what the IR assumes anyway. Another work offset than G54, or smoothing, is another path.
const STATE_CODES: [&str; 11] =
    ["G40", "G54", "G60", "G64", "G601", "G71", "G90", "G94", "SOFT", "COMPOF", "TRAFOOF"];

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
    run: Option<Run>,
}

/// Reads a program.
pub(super) fn read(text: &str, source: SourceId, machine: &Machine) -> Result<Warned<Reading>, Diagnostics> {
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
        run: None,
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
        if !is_move || !reader.is_cutting() || frame.is_in_doubt() {
            let steps_before = reader.run.is_some();
            if steps_before && frame.may_begin(body) {
                reader.flush();
            }
            if frame.meet(body, span, line.range(), &mut reader.assembler) == Met::Fixed {
                // Lines of the machine file that lead the tip also say how the tool turns.
                reader.second &= !reader.assembler.begins_tip_control();
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
    let warned = reader.assembler.finish()?;
    let reading = Reading { decimals: warned.value, header, footer, misnumbered: numbering.misnumbered() };
    Ok(Warned { value: reading, warnings: warned.warnings })
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
                Ok((after, word)) => {
                    let range = at..at + (rest.len() - after.len());
                    self.word(word, range, &mut block);
                    rest = after.trim_ascii_start();
                }
                Err(_) => {
                    let length = rest.find([' ', '\t', ';']).unwrap_or(rest.len());
                    self.assembler.error("word-unreadable", "this word cannot be read", at..at + length);
                    return;
                }
            }
        }
        if block.starts_spline {
            self.flush();
        }
        if let Some(feed) = block.feed {
            self.set_feed(feed, span);
        }
        if !self.directed(&mut block, span) {
            return;
        }
        self.moved(&block, line, span);
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
                let axes = self.assembler.machine.axes;
                let linear =
                    |name: &str| self.assembler.axis(name).is_some_and(|i| axes.kind(i) == Kind::Linear);
                if !arguments.trim().is_empty() && !arguments.split(',').map(str::trim).all(linear) {
                    self.assembler.error("fgroup", "only linear axes are read in FGROUP", range);
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
        match (name, whole) {
            ("G", Some(0)) => self.set_motion(Motion::Rapid),
            ("G", Some(1)) => self.set_motion(Motion::Line),
            ("G", Some(2)) => self.set_motion(Motion::Arc(Sense::Clockwise)),
            ("G", Some(3)) => self.set_motion(Motion::Arc(Sense::CounterClockwise)),
            ("G", Some(17)) => self.plane = Plane::Xy,
            ("G", Some(18)) => self.take_plane(Plane::Zx, range),
            ("G", Some(19)) => self.take_plane(Plane::Yz, range),
            ("TURN", _) => self.turn(value, range, block),
            ("I", _) => block.center[0] = Some(value),
            ("J", _) => block.center[1] = Some(value),
            ("K", _) => block.center[2] = Some(value),
            ("G", Some(code)) if STATE_CODES.contains(&format!("G{code}").as_str()) => {}
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
            ("SD", Some(degree @ 2..=3)) => self.degree = degree as usize,
            ("SD", _) => self.assembler.error("degree-range", "SD is 2 or 3", range),
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
        let Some(curve) = curve else { return };
        self.path_reference(&curve, span);
        self.assembler.curve(curve, &end, span);
    }

    /// A curve that moves a rotary axis needs UPATH, where the machine has it, so that all axes follow one parameter;
    /// a spline also needs a SPLINEPATH with every axis that it moves. Where the machine has no UPATH, rotary axes
    /// follow the arc length, which is the same only while the linear axes are linear in the parameter.
    fn path_reference(&mut self, curve: &Written, span: Span) {
        let axes = self.assembler.machine.axes;
        let moved = moving(curve);
        let (rotary, linear): (Vec<usize>, Vec<usize>) =
            moved.iter().partition(|i| axes.kind(**i) == Kind::Rotary);
        if rotary.is_empty() {
            return;
        }
        let spline = matches!(curve, Written::Nurbs(_) | Written::Through(..));
        if spline && !moved.iter().all(|i| self.splinepath.contains(i)) {
            let diagnostic =
                Diagnostic::error("splinepath-missing", "SPLINEPATH does not name every axis of this spline");
            self.assembler
                .diagnostics
                .push(diagnostic.at(span, "").hint("without it the spline has the first three axes only"));
        }
        let shared = self.assembler.machine.spline.shared_parameter;
        let by_arc_length =
            if shared { !self.upath } else { !linear_in_parameter(&self.assembler.empty(), curve, &linear) };
        if by_arc_length {
            let message = "without UPATH the rotary axes follow the arc length here, which is another curve";
            self.assembler.diagnostics.push(Diagnostic::error("arc-length", message).at(span, ""));
        }
    }
}

#[cfg(test)]
mod tests;
