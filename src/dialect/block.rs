//! Lines of a program, their numbers, and the fixed lines round it: what all readers share.

use super::assemble::Assembler;
use crate::decimal::read_decimal;
use crate::ir::Step;
use crate::machine::Machine;
use crate::machine::template::Template;
use crate::source::Span;
use std::ops::Range;

/// A reader stops after so many things to tell: the rest follows from the first.
pub const MAX_DIAGNOSTICS: usize = 10;

/// One line of a text.
#[derive(Clone, Copy, Debug)]
pub struct Line<'t> {
    /// Its number, from 1.
    pub number: u32,
    /// Where it starts in the text.
    pub start: usize,
    /// The line without its end and without blanks behind.
    pub text: &'t str,
}

impl Line<'_> {
    /// The bytes of the whole line.
    pub fn range(&self) -> Range<usize> {
        self.start..self.start + self.text.len()
    }
}

/// The lines of a text.
pub struct Lines<'t> {
    text: &'t str,
    at: usize,
    number: u32,
}

impl<'t> Lines<'t> {
    /// From the beginning; a byte-order mark is passed over.
    pub fn new(text: &'t str) -> Lines<'t> {
        Lines { text, at: if text.starts_with('\u{feff}') { 3 } else { 0 }, number: 0 }
    }
}

impl<'t> Iterator for Lines<'t> {
    type Item = Line<'t>;

    #[inline]
    fn next(&mut self) -> Option<Line<'t>> {
        if self.text.len() <= self.at {
            return None;
        }
        let rest = &self.text[self.at..];
        let length = rest.find('\n').unwrap_or(rest.len());
        let line = Line { number: self.number + 1, start: self.at, text: rest[..length].trim_ascii_end() };
        self.number += 1;
        self.at += length + 1;
        Some(line)
    }
}

/// Checks block numbers against the machine file.
pub struct Numbering {
    expected: u64,
    step: u64,
    /// The first block that has another number, or none where it should have one.
    pub misnumbered: Option<Range<usize>>,
}

impl Numbering {
    /// As the machine numbers its blocks.
    pub fn new(machine: &Machine) -> Numbering {
        let text = &machine.text;
        Numbering { expected: text.number_start.into(), step: text.number_step.into(), misnumbered: None }
    }

    /// Meets a block with this number, or without one.
    pub fn meet(&mut self, number: Option<u64>, range: Range<usize>) {
        let expected = (0 < self.step).then_some(self.expected);
        if number != expected && self.misnumbered.is_none() {
            self.misnumbered = Some(range);
        }
        self.expected = self.expected.wrapping_add(self.step);
    }
}

/// The digits at the start of `text` as a block number, and how long they are.
#[inline]
pub fn block_number(text: &str) -> Option<(u64, usize)> {
    let digits = text.bytes().take_while(u8::is_ascii_digit).count();
    text[..digits].parse().ok().map(|number| (number, digits))
}

/// Where a reader stands among the fixed lines of the machine file.
pub struct Frame<'m> {
    machine: &'m Machine,
    header: usize,
    footer: usize,
    /// The template lines that must follow, once the first of a tool call or a spindle's start was met.
    pending: Vec<&'m Template>,
    started: bool,
    name: Option<String>,
}

/// What a line is.
#[derive(Debug, PartialEq, Eq)]
pub enum Met {
    /// One of the fixed lines.
    Fixed,
    /// Something else: a block to be read.
    Other,
}

impl<'m> Frame<'m> {
    /// At the start of a program.
    pub fn new(machine: &'m Machine) -> Frame<'m> {
        Frame { machine, header: 0, footer: 0, pending: Vec::new(), started: false, name: None }
    }

    /// Whether the whole header was met.
    pub fn header_complete(&self) -> bool {
        self.header == self.machine.frame.header.len()
    }

    /// Whether the whole footer was met.
    pub fn footer_complete(&self) -> bool {
        self.footer == self.machine.frame.footer.len()
    }

    /// Whether a line could be one of the fixed lines that come after the header, so that a spline before it has ended.
    pub fn may_begin(&self, text: &str) -> bool {
        let frame = &self.machine.frame;
        let first = text.as_bytes().first();
        [&frame.tool_spindle, &frame.tool, &frame.spindle, &frame.footer].into_iter().any(|lines| {
            lines.first().is_some_and(|template| {
                template.0.as_bytes().first() == first && template.matched(text).is_some()
            })
        })
    }

    /// Meets a line, without its block number.
    pub fn meet(
        &mut self,
        text: &str,
        span: Span,
        range: Range<usize>,
        assembler: &mut Assembler<'m>,
    ) -> Met {
        let frame = &self.machine.frame;
        if let Some(template) = self.pending.first().copied() {
            self.pending.remove(0);
            if self.take(template, text, span, false, assembler) {
                return Met::Fixed;
            }
            assembler.error("frame-line", format!("here the machine file has `{}`", template.0), range);
            self.pending.clear();
            return Met::Fixed;
        }
        if !self.started && self.header < frame.header.len() {
            let template = &frame.header[self.header];
            if self.take(template, text, span, true, assembler) {
                self.header += 1;
                return Met::Fixed;
            }
            if 0 < self.header {
                assembler.error(
                    "header-differs",
                    format!("here the machine file has `{}`", template.0),
                    range,
                );
                self.header = frame.header.len();
                return Met::Fixed;
            }
        }
        self.started = true;
        if 0 < self.footer {
            match frame.footer.get(self.footer) {
                Some(template) if self.take(template, text, span, true, assembler) => self.footer += 1,
                Some(template) => {
                    assembler.error(
                        "footer-differs",
                        format!("here the machine file has `{}`", template.0),
                        range,
                    );
                }
                None => assembler.error("text-after-end", "text after the end of the program", range),
            }
            return Met::Fixed;
        }
        // Blocks of moves are by far the most, and none of these lines begins like one; a byte decides.
        let first = text.as_bytes().first().copied();
        for lines in [&frame.tool_spindle, &frame.tool, &frame.spindle] {
            if let Some(template) = lines.first()
                && template.0.as_bytes().first().copied() == first
                && self.take(template, text, span, true, assembler)
            {
                self.pending = lines[1..].iter().collect();
                return Met::Fixed;
            }
        }
        if let Some(template) = frame.footer.first()
            && template.0.as_bytes().first().copied() == first
            && self.take(template, text, span, true, assembler)
        {
            self.footer = 1;
            return Met::Fixed;
        }
        Met::Other
    }

    /// Takes a line that is a template filled in: its tool and spindle become steps, its name the program's.
    fn take(
        &mut self,
        template: &Template,
        text: &str,
        span: Span,
        first: bool,
        assembler: &mut Assembler<'m>,
    ) -> bool {
        let Some(values) = template.matched(text) else { return false };
        for (variable, value) in values {
            match variable.as_str() {
                "name" => {
                    if self.name.as_deref().is_some_and(|known| known != value) {
                        return false;
                    }
                    value.clone_into(&mut assembler.name);
                    self.name = Some(value.to_owned());
                }
                "tool" => {
                    let Ok(number) = value.parse::<u32>() else { return false };
                    // A line that follows, as `G43 H{tool}`, names the same tool or is another line.
                    if first {
                        assembler.step(Step::Tool(number), span);
                    } else if assembler.tool() != Some(number) {
                        return false;
                    }
                }
                _ => match read_decimal(value.as_bytes(), false) {
                    Ok((rpm, length)) if length == value.len() => assembler.step(Step::Spindle(rpm), span),
                    _ => return false,
                },
            }
        }
        true
    }
}

/// About how many bytes a program takes, so that a large one is written without moving it about.
pub fn expected_size(decimals: &crate::ir::Decimals) -> usize {
    use crate::ir::Written;
    let axes = decimals.program.axes.count();
    let steps = decimals.program.steps.iter().map(|located| match &located.step {
        Step::Cut(cut) => match &cut.curve {
            Written::Lines(points) | Written::Through(_, points) => points.count() * (10 + 11 * axes),
            Written::Polynomial(polynomial) => polynomial.blocks.len() * (20 + 60 * axes),
            Written::Nurbs(nurbs) => nurbs.points.len() * (30 + 14 * axes),
        },
        Step::Comment(_) | Step::Tool(_) | Step::Spindle(_) | Step::Rapid(_) => 40,
    });
    500 + steps.sum::<usize>()
}
