//! The parts of a program's text, in their order: what every writer walks.
//!
//! Fixed lines of the machine file stand between the moves. Sections that are alike but for their work offset are one
//! subprogram, where the machine file asks for it: the body of a section is what follows its work offset.

use super::alike;
use super::modal::Modal;
use crate::decimal::{Decimal, Spelling};
use crate::ir::{Auxiliary, Cut, Decimals, Located, Shift, Step, ToolCall, Written};
use crate::machine::Machine;
use crate::machine::template::Template;

/// One part of a program's text.
pub enum Part<'p> {
    /// A fixed line of the machine file, filled in.
    Fixed(String),
    /// The lines of a tool call are written; in one with the spindle's start, or alone.
    Tool(ToolCall, ToolLines),
    /// The lines of the spindle's start are written.
    Spindle,
    /// The lines that retract an axis in machine coordinates are written.
    Home(usize),
    /// The lines that lead the tip of the tool, or end that, are written.
    TipControl(bool),
    /// The lines that end the length of the tool are written.
    LengthEnd,
    /// The lines of a tilted plane, or of its end, are written: nothing is in force.
    Plane,
    /// The lines of a work offset are written.
    Shift(&'p [Shift<Decimal>]),
    /// A remark that is no section: what to set up.
    Remark(&'p str),
    /// A remark: a section starts.
    Comment(&'p str),
    /// The body of a section starts or has ended where it may be called: nothing is in force.
    Body,
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

type Steps<'p> = &'p [Located<Decimal, Written>];

/// A program with the machine's lines round it, part by part, and the parameters that its feeds are.
pub fn parts<'p>(decimals: &'p Decimals, machine: &Machine) -> (Vec<Part<'p>>, Vec<(Decimal, u32)>) {
    let program = &decimals.program;
    let machine = &machine.filled();
    let frame = &machine.frame;
    let number = format!("{:04}", program.number);
    let linear = machine.linear_names();
    let values = [("name", program.name.as_str()), ("number", &number), ("linear", &linear)];
    let assigned = Assigned::of(decimals, machine);
    let corrections = assigned.corrections.iter().map(|(axis, _, number)| (*axis, *number)).collect();
    let mut walk = Walk {
        decimals,
        machine,
        parts: Vec::new(),
        bodies: Vec::new(),
        corrections,
        tool: ToolCall::own(0),
        start: Some(&frame.start),
    };
    walk.fill(&frame.header, &values);
    walk.parts.extend(decimals.setup.iter().map(|remark| Part::Remark(remark)));
    walk.assign(&assigned);
    walk.steps(&program.steps);
    walk.start();
    walk.fill(&frame.footer, &values);
    walk.subprograms();
    walk.fill(&frame.close, &values);
    (walk.parts, assigned.feeds)
}

/// The parameters of a program: corrections first, then each feed, where feeds are parameters.
pub struct Assigned {
    /// The axis that a correction shifts, its value and its number.
    pub corrections: Vec<(usize, Decimal, u32)>,
    /// A feed and its number.
    pub feeds: Vec<(Decimal, u32)>,
}

impl Assigned {
    /// Those of a program, as long as the machine has numbers for feeds.
    pub fn of(decimals: &Decimals, machine: &Machine) -> Assigned {
        let mut assigned = Assigned { corrections: Vec::new(), feeds: Vec::new() };
        let mut number = machine.parameters.first;
        let steps = &decimals.program.steps;
        for located in steps {
            let Step::Shift(shifts) = &located.step else { continue };
            for shift in shifts.iter().filter(|shift| shift.parameter) {
                if assigned.corrections.iter().all(|(axis, ..)| *axis != shift.axis) {
                    assigned.corrections.push((shift.axis, shift.to, number));
                    number += 1;
                }
            }
        }
        if machine.feed_parameter {
            for feed in steps.iter().filter_map(|located| located.step.cut()?.feed) {
                let known = assigned.feeds.iter().any(|(known, _)| *known == feed);
                if !known && number <= machine.parameters.last {
                    assigned.feeds.push((feed, number));
                    number += 1;
                }
            }
        }
        assigned
    }
}

struct Walk<'p, 'm> {
    decimals: &'p Decimals,
    machine: &'m Machine,
    parts: Vec<Part<'p>>,
    /// Bodies that are called: the first of each kind.
    bodies: Vec<Body<'p>>,
    /// The parameter of each axis that has a correction.
    corrections: Vec<(usize, u32)>,
    /// The tool that was called last.
    tool: ToolCall,
    /// The lines behind the first retraction, where they are still to come.
    start: Option<&'m [Template]>,
}

/// The body of a section, and where its axes count from.
struct Body<'p> {
    steps: Steps<'p>,
    shifts: &'p [Shift<Decimal>],
}

impl<'p> Walk<'p, '_> {
    fn fill(&mut self, lines: &[Template], values: &[(&str, &str)]) {
        self.parts.extend(lines.iter().map(|line| Part::Fixed(line.fill(values))));
    }

    /// Sets the parameters.
    fn assign(&mut self, assigned: &Assigned) {
        let pattern = Template(self.machine.dialect.parameter.assign.to_owned());
        let corrections = assigned.corrections.iter().map(|(_, value, number)| (value, number));
        for (value, number) in corrections.chain(assigned.feeds.iter().map(|(value, number)| (value, number)))
        {
            let (n, value) = (number.to_string(), spelled(*value, self.machine));
            self.parts.push(Part::Fixed(pattern.fill(&[("n", &n), ("value", &value)])));
        }
    }

    fn steps(&mut self, steps: Steps<'p>) {
        let frame = &self.machine.frame;
        let mut rest = steps;
        while let Some((located, after)) = rest.split_first() {
            rest = after;
            // What may turn axes waits until the tool is home; where none goes there, it comes before all else.
            match located.step {
                Step::Comment(_) | Step::Home(_) => {}
                Step::Tool(_)
                | Step::Spindle(_)
                | Step::Coolant
                | Step::Shift(_)
                | Step::Auxiliary(_)
                | Step::Rapid(_)
                | Step::Cut(_) => self.start(),
            }
            match &located.step {
                Step::Tool(call) => {
                    self.tool = *call;
                    let (tool, register) = (call.number.to_string(), call.register().to_string());
                    let tool = [("tool", tool.as_str()), ("register", register.as_str())];
                    match rest.first().map(|next| &next.step) {
                        Some(Step::Spindle(rpm)) if !frame.tool_spindle.is_empty() => {
                            let rpm = rpm.to_string();
                            self.fill(&frame.tool_spindle, &[tool[0], tool[1], ("rpm", &rpm)]);
                            self.parts.push(Part::Tool(*call, ToolLines::WithSpindle));
                            rest = &rest[1..];
                        }
                        _ => {
                            self.fill(&frame.tool, &tool);
                            self.parts.push(Part::Tool(*call, ToolLines::Alone));
                        }
                    }
                }
                Step::Spindle(rpm) => {
                    self.fill(&frame.spindle, &[("rpm", &rpm.to_string())]);
                    self.parts.push(Part::Spindle);
                }
                Step::Coolant => self.fill(&frame.coolant, &[]),
                Step::Auxiliary(auxiliary) => {
                    let mut values = vec![
                        ("tool", self.tool.number.to_string()),
                        ("register", self.tool.register().to_string()),
                    ];
                    let part = match auxiliary {
                        Auxiliary::CoolantStop
                        | Auxiliary::SpindleStop
                        | Auxiliary::Stop
                        | Auxiliary::OptionalStop => None,
                        Auxiliary::LengthEnd => Some(Part::LengthEnd),
                        Auxiliary::Dwell(seconds) => {
                            values.push(("seconds", unsigned(*seconds, self.machine)));
                            None
                        }
                        Auxiliary::TipControl => Some(Part::TipControl(true)),
                        Auxiliary::TipControlEnd => Some(Part::TipControl(false)),
                        Auxiliary::Plane(angles) => {
                            let spelled = angles.map(|angle| spelled(angle, self.machine));
                            values.extend(["first", "second", "third"].into_iter().zip(spelled));
                            Some(Part::Plane)
                        }
                        Auxiliary::PlaneEnd => Some(Part::Plane),
                    };
                    let values: Vec<(&str, &str)> =
                        values.iter().map(|(name, value)| (*name, value.as_str())).collect();
                    self.fill(frame.auxiliary(auxiliary), &values);
                    self.parts.extend(part);
                }
                Step::Home(axis) => {
                    let word = home_word(*axis, self.machine);
                    self.fill(&frame.home, &[("home", &word)]);
                    self.parts.push(Part::Home(*axis));
                }
                Step::Shift(shifts) => {
                    self.shift(shifts);
                    let ends = |located: &Located<Decimal, Written>| match located.step {
                        Step::Comment(_) | Step::Shift(_) | Step::Home(_) => true,
                        Step::Tool(_)
                        | Step::Spindle(_)
                        | Step::Coolant
                        | Step::Auxiliary(_)
                        | Step::Rapid(_)
                        | Step::Cut(_) => false,
                    };
                    let length = rest.iter().position(ends).unwrap_or(rest.len());
                    let cuts = rest[..length].iter().any(|located| located.step.cut().is_some());
                    if frame.subprograms && cuts {
                        let (body, after) = rest.split_at(length);
                        rest = after;
                        self.call(Body { steps: body, shifts });
                    }
                }
                Step::Comment(text) => self.parts.push(Part::Comment(text)),
                Step::Rapid(targets) => self.parts.push(Part::Rapid(targets)),
                Step::Cut(cut) => self.parts.push(Part::Cut(cut)),
            }
        }
    }

    /// The lines behind the first retraction, once.
    fn start(&mut self) {
        if let Some(lines) = self.start.take() {
            self.fill(lines, &[]);
        }
    }

    /// The lines of a work offset.
    fn shift(&mut self, shifts: &'p [Shift<Decimal>]) {
        let word = |shift: &Shift<Decimal>| {
            let number = self.corrections.iter().find(|(axis, _)| shift.parameter && *axis == shift.axis);
            match number {
                Some((_, number)) => {
                    let sign = if self.machine.text.sign_always { "+" } else { "" };
                    let word = (self.machine.dialect.parameter.word)(*number);
                    format!("{}{sign}{word}", self.machine.axes.name(shift.axis))
                }
                None => axis_word(shift.axis, shift.to, self.machine),
            }
        };
        let words: Vec<String> = shifts.iter().map(word).collect();
        for line in &self.machine.frame.shift {
            if line.variables().any(|variable| variable == "i") {
                for (i, word) in words.iter().enumerate() {
                    let i = (i + 1).to_string();
                    self.parts.push(Part::Fixed(line.fill(&[("i", &i), ("words", word)])));
                }
            } else {
                self.parts.push(Part::Fixed(line.fill(&[("words", &words.join(" "))])));
            }
        }
        self.parts.push(Part::Shift(shifts));
    }

    /// The call of a body, which is kept where none is like it.
    fn call(&mut self, body: Body<'p>) {
        let digits = self.decimals.digits;
        let known = self
            .bodies
            .iter()
            .position(|other| alike::bodies((other.steps, other.shifts), (body.steps, body.shifts), digits));
        let label = known.unwrap_or_else(|| {
            self.bodies.push(body);
            self.bodies.len() - 1
        });
        let label = (label + 1).to_string();
        self.parts.push(Part::Fixed(self.machine.frame.call.fill(&[("label", &label)])));
        self.parts.push(Part::Body);
    }

    /// The bodies that are called.
    fn subprograms(&mut self) {
        for (i, body) in std::mem::take(&mut self.bodies).into_iter().enumerate() {
            let label = (i + 1).to_string();
            self.parts.push(Part::Fixed(self.machine.frame.begin.fill(&[("label", &label)])));
            self.parts.push(Part::Body);
            // Its numbers are counted from where its first caller counts.
            self.parts.push(Part::Shift(body.shifts));
            self.steps(body.steps);
            self.parts.push(Part::Fixed(self.machine.frame.end.fill(&[("label", &label)])));
        }
    }
}

/// A number as the machine spells it.
pub fn spelled(value: Decimal, machine: &Machine) -> String {
    let mut out = Vec::new();
    value.write(&mut out, machine.text.spelling());
    String::from_utf8(out).unwrap_or_default()
}

/// A number that is never negative: it has no sign.
fn unsigned(value: Decimal, machine: &Machine) -> String {
    let mut out = Vec::new();
    value.write(&mut out, Spelling { sign_always: false, ..machine.text.spelling() });
    String::from_utf8(out).unwrap_or_default()
}

/// An axis word outside the moves: it says where the text counts from, and so is not shifted itself.
fn axis_word(axis: usize, to: Decimal, machine: &Machine) -> String {
    let mut modal = Modal::new(machine, 16);
    modal.axis(axis, to.units(machine.axis_digits()[axis]).unwrap_or_default());
    String::from_utf8(modal.out).unwrap_or_default().trim_end().to_owned()
}

/// An axis and its home, as the control counts it.
pub fn home_word(axis: usize, machine: &Machine) -> String {
    let home = machine.home(axis).unwrap_or_default();
    let mut modal = Modal::new(machine, 16);
    modal.axis_name(axis);
    home.write(&mut modal.out, modal.spelling);
    String::from_utf8(modal.out).unwrap_or_default()
}
