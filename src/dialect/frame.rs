//! The fixed lines round a program: a reader meets them line by line, against the machine file.

use super::assemble::Assembler;
use super::outline::{Outline, begins_alike};
use super::parts::home_word;
use crate::decimal::{Decimal, read_decimal};
use crate::diagnostic::Diagnostic;
use crate::ir::{Auxiliary, Shift, Step, ToolCall};
use crate::machine::Machine;
use crate::machine::template::Template;
use crate::source::Span;
use crate::units::{Axes, Axis, Kind};
use std::ops::Range;

/// Where a reader stands among the fixed lines of the machine file.
#[allow(clippy::struct_excessive_bools, reason = "each is about another line")]
pub struct Frame<'m> {
    machine: &'m Machine,
    header: usize,
    /// The footer and the closing lines.
    end: Vec<&'m Template>,
    ended: usize,
    /// Lines of the end that may also be switches before it.
    doubtful: Vec<(Auxiliary<Decimal>, Span)>,
    /// The template lines that must follow, once the first of several was met, and where that stands.
    pending: Vec<&'m Template>,
    begun: Option<Span>,
    shifting: Option<Shifting>,
    /// Whether the last line said from where axes count, or set a parameter: its axes are no places.
    counts: bool,
    /// Whether remarks stand behind words in lines of the machine file.
    remarks: bool,
    assign: Template,
    /// What the lines that may stand behind the header begin and end with, by the first byte of a line.
    outlines: Vec<Vec<Outline>>,
    started: bool,
    /// Whether the lines behind the first retraction are still to come.
    start_due: bool,
    name: Option<String>,
}

/// A work offset in the making: which of its lines comes next, and what was said.
struct Shifting {
    line: usize,
    shifts: Vec<Shift<Decimal>>,
    span: Span,
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
        let machine_frame = &machine.frame;
        let mut frame = Frame {
            machine,
            header: 0,
            end: machine_frame.footer.iter().chain(&machine_frame.close).collect(),
            ended: 0,
            doubtful: Vec::new(),
            pending: Vec::new(),
            begun: None,
            shifting: None,
            counts: false,
            remarks: false,
            assign: Template(machine.dialect.parameter.assign.to_owned()),
            outlines: Vec::new(),
            started: false,
            start_due: !machine_frame.start.is_empty(),
            name: None,
        };
        frame.remarks = frame.has_remarks();
        let firsts = frame.lists().into_iter().filter_map(<[Template]>::first);
        let all = firsts.chain(frame.end.first().copied()).chain([&frame.assign]);
        let outlines: Vec<Outline> = all.map(Outline::new).collect();
        let beginning = |byte: u8| {
            let fitting = outlines.iter().filter(|outline| outline.may_begin_with(byte));
            fitting.cloned().collect()
        };
        frame.outlines = (0..=u8::MAX).map(beginning).collect();
        frame
    }

    /// Whether the whole header was met.
    pub fn header_complete(&self) -> bool {
        self.header == self.machine.frame.header.len()
    }

    /// Whether all that stands before the first tool was met: the header, and the lines behind the first retraction.
    pub fn start_complete(&self) -> bool {
        self.header_complete() && !self.start_due
    }

    /// Whether the last line said from where axes count, or set a parameter: its axes are no places.
    pub fn counts(&self) -> bool {
        self.counts
    }

    /// Whether the end of the program has begun, so that every line belongs to it.
    pub fn is_ending(&self) -> bool {
        0 < self.ended
    }

    /// Whether a remark behind the words of a block is a line of its own: not where the machine file has such lines.
    pub fn parts_remarks(&self) -> bool {
        !self.remarks
    }

    /// Whether remarks stand behind words in lines of the machine file.
    fn has_remarks(&self) -> bool {
        let marks: &[char] = if self.machine.dialect.least_increments { &['('] } else { &[';'] };
        let header = &self.machine.frame.header;
        let lines = self.lists().into_iter().flatten().chain(header).chain(self.end.iter().copied());
        lines.into_iter().any(|line| line.0.find(marks).is_some_and(|at| 0 < at))
    }

    /// Whether the whole footer was met, and what closes the text.
    pub fn footer_complete(&self) -> bool {
        self.ended == self.end.len()
    }

    /// The lists of lines that may stand anywhere behind the header.
    fn lists(&self) -> [&'m [Template]; 18] {
        let frame = &self.machine.frame;
        [
            &frame.tool_spindle,
            &frame.tool,
            &frame.spindle,
            &frame.coolant,
            &frame.home,
            &frame.coolant_stop,
            &frame.spindle_stop,
            &frame.stop,
            &frame.optional_stop,
            &frame.dwell,
            &frame.tip_control,
            &frame.tip_control_end,
            &frame.length_end,
            &frame.plane,
            &frame.plane_end,
            &frame.start,
            &frame.unwind,
            &frame.shift,
        ]
    }

    /// Whether a line could be one of the fixed lines that come after the header, so that a spline before it has ended.
    pub fn may_begin(&self, text: &str) -> bool {
        let ends = self.end.first().copied();
        let mut lines = self.lists().into_iter().filter_map(<[Template]>::first).chain(ends);
        lines.any(|template| begins_alike(template, text) && template.matched(text).is_some())
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
        self.counts = false;
        let here = |template: &Template| format!("here the machine file has `{}`", template.0);
        if let Some(template) = self.pending.first().copied() {
            self.pending.remove(0);
            if !self.take(template, text, span, false, assembler) {
                let diagnostic = Diagnostic::error("frame-line", here(template)).at(span, "");
                assembler.diagnostics.push(match self.begun {
                    Some(begun) => diagnostic.and_at(begun, "behind this line"),
                    None => diagnostic,
                });
                self.pending.clear();
            }
            return Met::Fixed;
        }
        if let Some(shifting) = self.shifting.take() {
            match self.shift(shifting, text, assembler) {
                Ok(true) => {
                    self.counts = true;
                    return Met::Fixed;
                }
                Ok(false) => {}
                Err(template) => {
                    assembler.error("frame-line", here(template), range);
                    return Met::Fixed;
                }
            }
        }
        if !self.started && self.header < frame.header.len() {
            let template = &frame.header[self.header];
            if self.take(template, text, span, true, assembler) {
                self.header += 1;
                return Met::Fixed;
            }
            if 0 < self.header {
                assembler.error("header-differs", here(template), range);
                self.header = frame.header.len();
                return Met::Fixed;
            }
        }
        self.started = true;
        // They may be those that end a plane, and come before anything else.
        if self.start_due
            && !assembler.has_begun()
            && let Some((template, rest)) = frame.start.split_first()
            && template.matched(text).is_some()
        {
            self.start_due = false;
            self.pending = rest.iter().collect();
            return Met::Fixed;
        }
        if 0 < self.ended {
            match self.end.get(self.ended).copied() {
                Some(template) if self.take(template, text, span, true, assembler) => {
                    self.doubt(text, span);
                    self.ended += 1;
                    return Met::Fixed;
                }
                // It was no end: what stands there stood for itself.
                _ if self.is_in_doubt() => self.believe(assembler),
                Some(template) => {
                    assembler.error("footer-differs", here(template), range);
                    return Met::Fixed;
                }
                None => {
                    assembler.error("text-after-end", "text after the end of the program", range);
                    return Met::Fixed;
                }
            }
        }
        // Blocks of moves are by far the most, and hardly one of these lines begins and ends like one.
        let first = text.bytes().next().unwrap_or_default();
        if !self.outlines[usize::from(first)].iter().any(|outline| outline.fits(text)) {
            return Met::Other;
        }
        if let Some(template) = self.end.first().copied()
            && begins_alike(template, text)
            && self.switch(text).is_some()
            && self.take(template, text, span, true, assembler)
        {
            self.doubt(text, span);
            self.ended = 1;
            return Met::Fixed;
        }
        if assembler.leads_tip()
            && let Some(template) = frame.tip_control_end.first()
            && self.take(template, text, span, true, assembler)
        {
            // Its lines may begin as those of a retraction do.
            assembler.step(Step::Auxiliary(Auxiliary::TipControlEnd), span);
            self.pending = frame.tip_control_end[1..].iter().collect();
            self.begun = Some(span);
            return Met::Fixed;
        }
        for lines in &self.lists()[..17] {
            let is = |list: &Vec<Template>| std::ptr::eq(list.as_slice(), *lines);
            // What ends tool centre point control may be what ends a length, G49: it was met where the tip is led.
            if is(&frame.tip_control_end) && frame.tip_control_end.last() == frame.length_end.last() {
                continue;
            }
            let ends_length = is(&frame.length_end) && !lines.is_empty();
            if let Some(template) = lines.first()
                && begins_alike(template, text)
                // Elsewhere it may move the tool, and is no line of the machine file.
                && (!ends_length || !frame.length_end_moves || assembler.is_parked())
                && self.take(template, text, span, true, assembler)
            {
                if is(&frame.home) && !lines.is_empty() {
                    if let Some(axis) = frame.home_axis.and_then(|axis| self.machine.axes.index_of(axis)) {
                        assembler.home(axis, span);
                    }
                } else if let Some(switch) = self.switch(text) {
                    assembler.step(Step::Auxiliary(switch), span);
                }
                self.pending = lines[1..].iter().collect();
                self.begun = Some(span);
                return Met::Fixed;
            }
        }
        if let Some(template) = frame.shift.first()
            && begins_alike(template, text)
        {
            let shifting = Shifting { line: 0, shifts: Vec::new(), span };
            if self.shift(shifting, text, assembler) == Ok(true) {
                self.counts = true;
                return Met::Fixed;
            }
        }
        if begins_alike(&self.assign, text) && self.assigned(text, assembler) {
            self.counts = true;
            return Met::Fixed;
        }
        if let Some(template) = self.end.first().copied()
            && begins_alike(template, text)
            && self.take(template, text, span, true, assembler)
        {
            self.ended = 1;
            return Met::Fixed;
        }
        Met::Other
    }

    /// The text has ended: what was begun must be whole.
    pub fn finish(&mut self, end: usize, assembler: &mut Assembler<'m>) {
        let mut missing = self.pending.first().copied();
        if let Some(shifting) = self.shifting.take() {
            // No line is like this, so that the last of several lines is met.
            missing = missing.or(self.shift(shifting, "", assembler).err());
        }
        if let Some(template) = missing {
            let message = format!("the text ends where the machine file has `{}`", template.0);
            assembler.error("frame-line", message, end..end);
        }
    }

    /// Which switch a line is.
    fn switch(&self, text: &str) -> Option<Auxiliary<Decimal>> {
        let all = [
            Auxiliary::CoolantStop,
            Auxiliary::SpindleStop,
            Auxiliary::Stop,
            Auxiliary::OptionalStop,
            Auxiliary::LengthEnd,
            Auxiliary::TipControl,
            Auxiliary::TipControlEnd,
            Auxiliary::PlaneEnd,
        ];
        all.into_iter().find(|switch| {
            let first = self.machine.frame.auxiliary(switch).first();
            first.is_some_and(|template| begins_alike(template, text) && template.matched(text).is_some())
        })
    }

    /// Notes that a line of the end may also be a switch before it, as M5.
    fn doubt(&mut self, text: &str, span: Span) {
        if self.doubtful.len() == self.ended
            && let Some(switch) = self.switch(text)
        {
            self.doubtful.push((switch, span));
        }
    }

    /// Whether all that was met of the end may also be switches before it.
    pub fn is_in_doubt(&self) -> bool {
        0 < self.ended && self.doubtful.len() == self.ended
    }

    /// Takes what was met of the end as switches.
    fn believe(&mut self, assembler: &mut Assembler<'m>) {
        for (switch, span) in std::mem::take(&mut self.doubtful) {
            assembler.step(Step::Auxiliary(switch), span);
        }
        self.ended = 0;
    }

    /// Takes a line that is a template filled in: its tool, spindle and home become steps, its name the program's.
    fn take(
        &mut self,
        template: &Template,
        text: &str,
        span: Span,
        first: bool,
        assembler: &mut Assembler<'m>,
    ) -> bool {
        let Some(values) = template.matched(text) else { return false };
        let mut angles = [None; 3];
        for (variable, value) in values {
            match variable.as_str() {
                "first" | "second" | "third" => {
                    let Some(angle) = whole_decimal(value) else { return false };
                    // A number that no writer makes would be another plane than the one that is compared.
                    if angle.units(self.machine.digits.rotary).is_none() {
                        return false;
                    }
                    angles[["first", "second", "third"].iter().position(|n| *n == variable).unwrap_or(0)] =
                        Some(angle);
                }
                "name" => {
                    if self.name.as_deref().is_some_and(|known| known != value) {
                        return false;
                    }
                    value.clone_into(&mut assembler.name);
                    self.name = Some(value.to_owned());
                }
                "number" => match value.parse() {
                    Ok(number) if value.len() == 4 => assembler.number = number,
                    _ => return false,
                },
                "linear" => {
                    if value != self.machine.linear_names() {
                        return false;
                    }
                }
                "tool" => {
                    let Ok(number) = value.parse::<u32>() else { return false };
                    let frame = &self.machine.frame;
                    if [&frame.tip_control, &frame.plane].iter().any(|lines| lines.first() == Some(template))
                    {
                        // The length of the tool that leads its tip, or stands square to a plane.
                        if !assembler.has_tool(number) {
                            let message = format!("tool {number} was not called before it is tilted");
                            assembler.error("tool-offset", message, span.start as usize..span.end as usize);
                        }
                    } else if first {
                        assembler.step(Step::Tool(ToolCall::own(number)), span);
                    } else if !assembler.has_tool(number) {
                        // A line that follows, as `G43 H{tool}`, names the same tool or is another line.
                        return false;
                    }
                }
                "axis" => {
                    if assembler.axis(value).is_none() {
                        return false;
                    }
                    // What follows counts from there.
                    assembler.end_run();
                }
                "register" => {
                    let Ok(register) = value.parse::<u32>() else { return false };
                    if !assembler.takes_register(register, span) {
                        let message = format!("the tool does not have the length of register {register}");
                        assembler.error("tool-offset", message, span.start as usize..span.end as usize);
                    }
                }
                "home" => {
                    let axes = 0..self.machine.axes.count();
                    let known = |i: &usize| self.machine.home(*i).is_some();
                    let Some(axis) = axes.filter(known).find(|i| home_word(*i, self.machine) == value) else {
                        return false;
                    };
                    assembler.home(axis, span);
                }
                "seconds" => match whole_decimal(value) {
                    Some(seconds) if !seconds.compare(Decimal::ZERO).is_lt() => {
                        assembler.step(Step::Auxiliary(Auxiliary::Dwell(seconds)), span);
                    }
                    Some(_) | None => return false,
                },
                // A speed has no sign: that would be the other way round.
                _ => match read_decimal(value.as_bytes(), false) {
                    Ok((rpm, length)) if length == value.len() && !rpm.compare(Decimal::ZERO).is_lt() => {
                        assembler.step(Step::Spindle(rpm), span);
                    }
                    _ => return false,
                },
            }
        }
        if let [Some(first), Some(second), Some(third)] = angles {
            assembler.step(Step::Auxiliary(Auxiliary::Plane([first, second, third])), span);
        }
        if !self.machine.frame.coolant.is_empty() && self.machine.frame.coolant.first() == Some(template) {
            assembler.step(Step::Coolant, span);
        }
        true
    }

    /// Meets a line of a work offset. False: the line before was its last. An error names the line that is missing.
    fn shift(
        &mut self,
        mut shifting: Shifting,
        text: &str,
        assembler: &mut Assembler<'m>,
    ) -> Result<bool, &'m Template> {
        let lines = &self.machine.frame.shift;
        let Some(template) = lines.get(shifting.line) else { return Ok(false) };
        let repeated = template.variables().any(|variable| variable == "i");
        let said = template.matched(text).and_then(|values| {
            let mut shifts = Vec::new();
            for (variable, value) in values {
                match variable.as_str() {
                    "i" => (value == (shifting.shifts.len() + 1).to_string()).then_some(())?,
                    _ => shifts = words(value, assembler)?,
                }
            }
            Some(shifts)
        });
        let ends = shifting.line + 1 == lines.len();
        match said {
            Some(shifts) => {
                shifting.shifts.extend(shifts);
                if repeated {
                    self.shifting = Some(shifting);
                } else if ends {
                    assembler.shift(shifting.shifts, self.replaces(), shifting.span);
                } else {
                    shifting.line += 1;
                    self.shifting = Some(shifting);
                }
                Ok(true)
            }
            // Behind the last of the lines that stand once for each axis comes something else.
            None if repeated && ends && !shifting.shifts.is_empty() => {
                assembler.shift(shifting.shifts, self.replaces(), shifting.span);
                Ok(false)
            }
            None => Err(template),
        }
    }

    /// Whether a work offset of these lines replaces the whole shift before it.
    fn replaces(&self) -> bool {
        let first = self.machine.frame.shift.first().and_then(|line| line.0.split_ascii_whitespace().next());
        self.machine.dialect.replaces_shift.is_some_and(|word| first == Some(word))
    }

    /// Meets a line that sets a parameter.
    fn assigned(&self, text: &str, assembler: &mut Assembler<'m>) -> bool {
        let Some(values) = self.assign.matched(text) else { return false };
        let value =
            |name: &str| values.iter().find(|(variable, _)| variable == name).map(|(_, value)| *value);
        let number = value("n").and_then(|n| n.parse::<u32>().ok());
        let value = value("value").and_then(|value| whole_decimal(value.trim_ascii()));
        let (Some(number), Some(value)) = (number, value) else { return false };
        assembler.parameters.insert(number, value);
        true
    }
}

fn whole_decimal(text: &str) -> Option<Decimal> {
    read_decimal(text.as_bytes(), false)
        .ok()
        .filter(|(_, length)| *length == text.len())
        .map(|(value, _)| value)
}

/// `A90 Z=R1`: where axes count from, by number or parameter.
fn words(text: &str, assembler: &Assembler) -> Option<Vec<Shift<Decimal>>> {
    let machine = assembler.machine;
    text.split_ascii_whitespace()
        .map(|word| {
            let (name, value) = word.split_once('=').or_else(|| word.split_at_checked(1))?;
            let axis = assembler.axis(name)?;
            let letter = machine.dialect.parameter.letter;
            let parameter = value.trim_start_matches('+').strip_prefix(letter);
            let to = match parameter {
                Some(number) => *assembler.parameters.get(&number.parse().ok()?)?,
                None => {
                    let value = whole_decimal(value)?;
                    if machine.reversed()[axis] { value.times(-1)? } else { value }
                }
            };
            to.units(assembler.digits[axis])?;
            Some(Shift { axis, to, parameter: parameter.is_some() })
        })
        .collect()
}

/// The machine with the axes that a program tells of, where its header names the linear ones (`{linear}`): those, and all
/// that are not linear. Who has the input knows them; a program alone may have fewer than its machine.
pub fn with_named_axes(text: &str, machine: &Machine) -> Option<Machine> {
    let named = |line: &&Template| line.variables().any(|variable| variable == "linear");
    let template = machine.frame.header.iter().find(named)?;
    let value = text.lines().take(MOST_HEADER).find_map(|line| {
        let line = line.trim();
        let numbered =
            line.strip_prefix('N').map(|rest| rest.trim_start_matches(|c: char| c.is_ascii_digit()));
        let values = template.matched(numbered.unwrap_or(line).trim_start())?;
        values.into_iter().find(|(variable, _)| variable == "linear").map(|(_, value)| value)
    })?;
    let names: Vec<&str> = value.split(',').collect();
    let known = |(axis, kind): &&(Axis, Kind)| *kind != Kind::Linear || names.contains(&axis.as_str());
    let axes: Vec<(Axis, Kind)> = machine.axes.as_slice().iter().filter(known).copied().collect();
    machine.with_axes(&Axes::new(&axes)?).ok()
}

/// A header is not longer.
const MOST_HEADER: usize = 1000;
