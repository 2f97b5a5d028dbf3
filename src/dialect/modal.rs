//! What a writer remembers between blocks, so that words which still hold are not written again.
//!
//! All of it is forgotten at the start of a section, so that a program can be restarted there.

use crate::decimal::{Decimal, Spelling, write_units};
use crate::ir::{Cut, Program, Step, Units, Written};
use crate::machine::Machine;
use crate::machine::template::Template;
use crate::units::MAX_AXES;

/// A program text in the making, and the modal state behind it.
pub struct Modal<'m> {
    /// The text so far.
    pub out: Vec<u8>,
    /// The machine.
    pub machine: &'m Machine,
    /// How numbers are spelled.
    pub spelling: Spelling,
    digits: [u8; MAX_AXES],
    /// Where each axis is known to be, in units of its last decimal.
    pub position: [Option<i64>; MAX_AXES],
    /// The motion word in force.
    pub motion: Option<&'static str>,
    /// The feed in force.
    pub feed: Option<Decimal>,
    number: u32,
}

impl<'m> Modal<'m> {
    /// An empty text for a program of about `size` bytes.
    pub fn new(machine: &'m Machine, size: usize) -> Modal<'m> {
        Modal {
            out: Vec::with_capacity(size),
            machine,
            spelling: Spelling {
                point_always: machine.text.point_always,
                sign_always: machine.text.sign_always,
            },
            digits: machine.axis_digits(),
            position: [None; MAX_AXES],
            motion: None,
            feed: None,
            number: machine.text.number_start,
        }
    }

    /// Forgets everything that a control would remember.
    pub fn forget(&mut self) {
        self.position = [None; MAX_AXES];
        self.motion = None;
        self.feed = None;
    }

    /// Writes text.
    pub fn text(&mut self, text: &str) {
        self.out.extend_from_slice(text.as_bytes());
    }

    /// Starts a block with its number, where the machine numbers its blocks.
    pub fn begin(&mut self, prefix: &str) {
        let step = self.machine.text.number_step;
        if step != 0 {
            self.text(prefix);
            self.text(itoa::Buffer::new().format(self.number));
            self.out.push(b' ');
            self.number = self.number.wrapping_add(step);
        }
    }

    /// Ends a block.
    pub fn end(&mut self) {
        if self.out.last() == Some(&b' ') {
            self.out.pop();
        }
        self.out.push(b'\n');
    }

    /// The motion word, where it is not in force.
    pub fn motion(&mut self, word: &'static str) {
        if self.motion != Some(word) {
            self.text(word);
            self.out.push(b' ');
            self.motion = Some(word);
        }
    }

    /// F, where another is in force. A number that is never negative has no sign.
    pub fn feed(&mut self, feed: Option<Decimal>) {
        if let Some(value) = feed
            && self.feed != feed
        {
            self.out.push(b'F');
            value.write(&mut self.out, Spelling { sign_always: false, ..self.spelling });
            self.out.push(b' ');
            self.feed = feed;
        }
    }

    /// An axis word. `=` separates a name of more than one letter from its value.
    #[inline]
    pub fn axis(&mut self, i: usize, units: i64) {
        let name = self.machine.axes.name(i);
        self.text(name.as_str());
        if 1 < name.as_str().len() {
            self.out.push(b'=');
        }
        write_units(&mut self.out, units, self.digits[i], self.spelling);
        self.out.push(b' ');
    }

    /// The words of the axes named, moved or not.
    pub fn axes(&mut self, named: &[usize], point: &Units) {
        for i in named {
            self.axis(*i, point[*i]);
        }
    }

    /// The words of the axes that a straight move moves; the first where it moves none, since a block needs one.
    #[inline]
    pub fn moved_axes(&mut self, point: &Units, count: usize) {
        let mut moved = false;
        for i in 0..count {
            if self.position[i] != Some(point[i]) {
                self.axis(i, point[i]);
                moved = true;
            }
        }
        if !moved {
            self.axis(0, point[0]);
        }
    }

    /// The words of a rapid.
    pub fn targets(&mut self, targets: &[(usize, Decimal)]) {
        for (axis, to) in targets {
            let units = to.units(self.digits[*axis]).unwrap_or_default();
            self.axis(*axis, units);
            self.position[*axis] = Some(units);
        }
    }

    /// Takes a point as reached.
    pub fn reached(&mut self, point: &Units) {
        for i in 0..self.machine.axes.count() {
            self.position[i] = Some(point[i]);
        }
    }
}

/// One part of a program's text.
pub enum Part<'p> {
    /// A fixed line of the machine file, filled in.
    Fixed(String),
    /// The lines of a tool call are written; in one with the spindle's start, or alone.
    Tool(u32, ToolLines),
    /// The lines of the spindle's start are written.
    Spindle,
    /// A remark: a section starts.
    Comment(&'p str),
    /// Rapid traverse.
    Rapid(&'p [(usize, Decimal)]),
    /// A path at feed.
    Cut(&'p Cut<Decimal, Written>),
}

/// How a tool call was written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ToolLines {
    /// By the lines of `tool`.
    Alone,
    /// By the lines of `tool_spindle`.
    WithSpindle,
}

/// A program with the machine's lines round it, part by part: what every writer walks.
pub fn parts<'p>(program: &'p Program<Decimal, Written>, machine: &Machine) -> Vec<Part<'p>> {
    let frame = &machine.frame;
    let fill = |lines: &[Template], values: &[(&str, &str)]| -> Vec<Part<'p>> {
        lines.iter().map(|line| Part::Fixed(line.fill(values))).collect()
    };
    let mut parts = fill(&frame.header, &[("name", &program.name)]);
    let mut steps = program.steps.iter().map(|located| &located.step).peekable();
    while let Some(step) = steps.next() {
        match step {
            Step::Tool(number) => {
                let tool = number.to_string();
                match steps.peek() {
                    Some(Step::Spindle(rpm)) if !frame.tool_spindle.is_empty() => {
                        parts
                            .extend(fill(&frame.tool_spindle, &[("tool", &tool), ("rpm", &rpm.to_string())]));
                        parts.push(Part::Tool(*number, ToolLines::WithSpindle));
                        steps.next();
                    }
                    _ => {
                        parts.extend(fill(&frame.tool, &[("tool", &tool)]));
                        parts.push(Part::Tool(*number, ToolLines::Alone));
                    }
                }
            }
            Step::Spindle(rpm) => {
                parts.extend(fill(&frame.spindle, &[("rpm", &rpm.to_string())]));
                parts.push(Part::Spindle);
            }
            Step::Comment(text) => parts.push(Part::Comment(text)),
            Step::Rapid(targets) => parts.push(Part::Rapid(targets)),
            Step::Cut(cut) => parts.push(Part::Cut(cut)),
        }
    }
    parts.extend(fill(&frame.footer, &[("name", &program.name)]));
    parts
}
