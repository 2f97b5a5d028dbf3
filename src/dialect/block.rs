//! Lines of a program and their numbers: what all readers share.

use crate::decimal::{MOST_EXACT, digits};
use crate::machine::Machine;
use crate::machine::template::Template;
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
    /// Whether it calls, begins or ends a subprogram, and so does nothing itself.
    pub structure: bool,
}

impl Line<'_> {
    /// The bytes of the whole line.
    pub fn range(&self) -> Range<usize> {
        self.start..self.start + self.text.len()
    }
}

/// The lines of a text in the order in which a control comes to them: a subprogram's where it is called.
///
/// A labelled section that stands before the end of the program runs when it is passed too, and again where it is called. Behind
/// the end of the program only calls come to it.
pub struct Lines<'t> {
    text: &'t str,
    at: usize,
    number: u32,
    calls: Option<Calls<'t>>,
}

/// The subprograms of a text.
struct Calls<'t> {
    call: &'t Template,
    end: &'t Template,
    /// Whether a section is no subprogram, but a part of the program with a label.
    passed: bool,
    bodies: Vec<Body>,
    /// Where to go on, and the line that stands there; none while no subprogram runs.
    back: Option<(usize, u32)>,
    /// How many bytes of calls are still followed.
    left: usize,
}

/// A subprogram: its label, where it begins, the line that stands there, where it ends, and whether that is behind the program's
/// end.
struct Body {
    label: String,
    start: usize,
    number: u32,
    end: usize,
    behind: bool,
}

/// As many bytes of calls are followed: a text of calls alone must not run for ever.
const MAX_CALLED: usize = 1 << 31;

impl<'t> Lines<'t> {
    /// From the beginning; a byte-order mark is passed over.
    pub fn new(text: &'t str, machine: &'t Machine) -> Lines<'t> {
        let at = if text.starts_with('\u{feff}') { 3 } else { 0 };
        let call = &machine.frame.call;
        let fixed = call.0.split('{').next().unwrap_or_default();
        let mut lines = Lines { text, at, number: 0, calls: None };
        if !fixed.is_empty() && text.contains(fixed) {
            let bodies = lines.bodies(&machine.frame.begin, &machine.frame.end);
            (lines.at, lines.number) = (at, 0);
            let end = &machine.frame.end;
            let passed = machine.dialect.passes_labels;
            lines.calls = Some(Calls { call, end, passed, bodies, back: None, left: MAX_CALLED });
        }
        lines
    }

    /// Whether a subprogram is called anywhere.
    pub fn has_calls(&self) -> bool {
        self.calls.as_ref().is_some_and(|calls| !calls.bodies.is_empty())
    }

    /// The subprograms of the text.
    fn bodies(&mut self, begin: &Template, end: &Template) -> Vec<Body> {
        let mut bodies: Vec<Body> = Vec::new();
        let mut open: Option<Body> = None;
        let mut behind = false;
        while let Some(line) = self.line() {
            let code = unnumbered(line.text);
            behind |= ends_program(code);
            if let Some(body) = open.take() {
                if filled(end, code).is_some_and(|found| found.is_empty() || found == body.label) {
                    bodies.push(Body { end: self.at, behind: body.behind && behind, ..body });
                } else {
                    open = Some(body);
                }
            } else if let Some(label) = filled(begin, code) {
                let label = label.to_owned();
                open = Some(Body { label, start: line.start, number: line.number, end: 0, behind });
            }
        }
        // Which of two alike would run nobody knows.
        let labels: Vec<String> = bodies.iter().map(|body| body.label.clone()).collect();
        let once = |body: &Body| labels.iter().filter(|label| **label == body.label).count() == 1;
        bodies.retain(once);
        bodies
    }

    #[inline]
    fn line(&mut self) -> Option<Line<'t>> {
        if self.text.len() <= self.at {
            return None;
        }
        let rest = &self.text[self.at..];
        let length = memchr::memchr(b'\n', rest.as_bytes()).unwrap_or(rest.len());
        let text = rest[..length].trim_ascii_end();
        let line = Line { number: self.number + 1, start: self.at, text, structure: false };
        self.number += 1;
        self.at += length + 1;
        Some(line)
    }
}

/// Whether a line ends the program: M30, M2 or END PGM stands in it, and not in a remark.
fn ends_program(code: &str) -> bool {
    let code = code.split([';', '(']).next().unwrap_or_default();
    let mut words = code.split_ascii_whitespace();
    code.starts_with("END PGM") || words.any(|word| matches!(word, "M30" | "M2" | "M02"))
}

/// A line without its block number.
fn unnumbered(line: &str) -> &str {
    let line = line.trim_ascii_start();
    let digits = line.strip_prefix('N').unwrap_or(line);
    let rest = digits.trim_start_matches(|c: char| c.is_ascii_digit());
    if rest.len() == digits.len() { line } else { rest.trim_ascii_start() }
}

/// What is filled in where a line is this template: a label, or nothing.
fn filled<'l>(template: &Template, line: &'l str) -> Option<&'l str> {
    template.matched(line).map(|values| values.first().map_or("", |(_, label)| *label))
}

impl<'t> Iterator for Lines<'t> {
    type Item = Line<'t>;

    #[inline]
    fn next(&mut self) -> Option<Line<'t>> {
        if self.calls.is_none() {
            return self.line();
        }
        self.next_called()
    }
}

impl<'t> Lines<'t> {
    /// The next line of a text with subprograms.
    fn next_called(&mut self) -> Option<Line<'t>> {
        let main = |calls: &Calls| calls.back.is_none();
        // In the text's own order subprograms behind the end are passed over.
        if let Some(calls) = self.calls.as_ref().filter(|calls| main(calls))
            && let Some(body) = calls.bodies.iter().find(|body| body.behind && body.start == self.at)
        {
            let (from, end) = (self.at, body.end);
            self.number += self.text[from..end.min(self.text.len())].matches('\n').count() as u32;
            self.at = end;
            return self.next_called();
        }
        let line = self.line()?;
        let (at, number) = (self.at, self.number);
        let Some(calls) = &mut self.calls else { return Some(line) };
        let code = unnumbered(line.text);
        if let Some(back) = calls.back {
            if !calls.bodies.iter().any(|body| body.end == at) || filled(calls.end, code).is_none() {
                let begins = calls.bodies.iter().any(|body| body.start == line.start);
                return Some(Line { structure: begins, ..line });
            }
            calls.back = None;
            (self.at, self.number) = back;
            return Some(Line { structure: true, ..line });
        }
        if let Some(called) = filled(calls.call, code)
            && let Some(body) = calls.bodies.iter().find(|body| body.label == called)
            && let Some(left) = calls.left.checked_sub(body.end - body.start)
        {
            calls.left = left;
            calls.back = Some((at, number));
            (self.at, self.number) = (body.start, body.number - 1);
            return Some(Line { structure: true, ..line });
        }
        // The marks of a section that is passed do nothing.
        let marks =
            calls.passed && calls.bodies.iter().any(|body| body.start == line.start || body.end == at);
        Some(Line { structure: marks, ..line })
    }
}

/// Checks block numbers against the machine file.
pub struct Numbering {
    expected: u64,
    step: u64,
    /// Blocks that the reader comes to in another order than that of the text, where there are subprograms.
    met: Option<Vec<(Range<usize>, Option<u64>)>>,
    misnumbered: Option<Range<usize>>,
}

impl Numbering {
    /// As the machine numbers its blocks.
    pub fn new(machine: &Machine, lines: &Lines) -> Numbering {
        let text = &machine.text;
        Numbering {
            expected: text.number_start.into(),
            step: text.number_step.into(),
            met: lines.has_calls().then(Vec::new),
            misnumbered: None,
        }
    }

    /// Meets a block with this number, or without one.
    #[inline]
    pub fn meet(&mut self, number: Option<u64>, range: Range<usize>) {
        match &mut self.met {
            Some(met) => met.push((range, number)),
            None => self.next(number, range),
        }
    }

    #[inline]
    fn next(&mut self, number: Option<u64>, range: Range<usize>) {
        let expected = (0 < self.step).then_some(self.expected);
        if number != expected && self.misnumbered.is_none() {
            self.misnumbered = Some(range);
        }
        self.expected = self.expected.wrapping_add(self.step);
    }

    /// The first block that has another number, or none where it should have one.
    pub fn misnumbered(mut self) -> Option<Range<usize>> {
        if let Some(mut met) = self.met.take() {
            met.sort_by_key(|(range, _)| range.start);
            met.dedup_by_key(|(range, _)| range.start);
            for (range, number) in met {
                self.next(number, range);
            }
        }
        self.misnumbered
    }
}

/// The digits at the start of `text` as a block number, and how long they are.
#[inline]
pub fn block_number(text: &str) -> Option<(u64, usize)> {
    let (count, mut number) = digits(text.as_bytes(), 0);
    if MOST_EXACT < count {
        number = text[..count].parse().ok()?;
    }
    (0 < count).then_some((number, count))
}

/// About how many bytes a program takes, so that a large one is written without moving it about.
pub fn expected_size(decimals: &crate::ir::Decimals) -> usize {
    use crate::ir::Written;
    let axes = decimals.program.axes.count();
    let steps = decimals.program.steps.iter().map(|located| match located.step.cut().map(|cut| &cut.curve) {
        Some(Written::Lines(points) | Written::Through(_, points)) => points.count() * (10 + 11 * axes),
        Some(Written::Arc(_)) => 80,
        Some(Written::Polynomial(polynomial)) => polynomial.blocks.len() * (20 + 60 * axes),
        Some(Written::Nurbs(nurbs)) => nurbs.points.len() * (30 + 14 * axes),
        None => 40,
    });
    500 + steps.sum::<usize>()
}
