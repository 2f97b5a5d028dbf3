//! Moves read one by one become a program: straight moves of one feed are gathered into one run.
//!
//! The position is unknown until an axis was named. A cut that starts where some axis is unknown (a fragment without
//! its approach) starts, for that axis, where it ends, and a warning says so.

use super::stated::Stated;
use crate::decimal::{Decimal, power_of_ten};
use crate::diagnostic::{Diagnostic, Diagnostics, Warned};
use crate::ir::{
    Auxiliary, Cut, Decimals, Located, Program, Role, Step, ToolCall, Units, Written, WrittenPoints,
};
use crate::machine::Machine;
use crate::source::{SourceId, Span};
use crate::units::{Axis, Kind, MAX_AXES};
use std::collections::BTreeMap;

/// A run of so many lines most likely goes on to the end of the text.
const LONG_RUN: usize = 1 << 16;

/// A line has at least so many bytes: an axis, a digit and its end.
const LEAST_LINE: usize = 3;

/// About how many more lines follow `count` of them in a text of so many bytes, so that a large program is read without
/// moving it about.
fn expected(count: usize, run: Span, size: usize) -> usize {
    let (read, left) = (run.end.saturating_sub(run.start) as usize, size.saturating_sub(run.end as usize));
    (count * left / read.max(1)).min(left / LEAST_LINE)
}

/// A program in the making.
pub struct Assembler<'m> {
    /// The machine.
    pub machine: &'m Machine,
    /// Which text is read.
    pub source: SourceId,
    /// How many bytes it has.
    size: usize,
    /// How many decimals each axis has.
    pub digits: [u8; MAX_AXES],
    /// Where each axis is, in units of its last decimal.
    pub position: [Option<i64>; MAX_AXES],
    /// The feed in force.
    pub feed: Option<Decimal>,
    /// Whether F is inverse time.
    pub inverse: bool,
    /// F of the line that comes next, under inverse time.
    pub rate: Option<Decimal>,
    /// What is wrong or strange.
    pub diagnostics: Diagnostics,
    /// The program's name.
    pub name: String,
    /// Its number.
    pub number: u32,
    /// The parameters that were set.
    pub parameters: BTreeMap<u32, Decimal>,
    /// What it states beside its moves.
    pub stated: Stated,
    /// Where the text counts each axis from, in units of its last decimal.
    pub(super) shift: Units,
    reversed: [bool; MAX_AXES],
    modulo: [bool; MAX_AXES],
    /// The single-letter axes by letter, so that a million words are not compared with names.
    letters: [Option<u8>; 26],
    pub(super) steps: Vec<Located<Decimal, Written>>,
    pub(super) run: Option<(WrittenPoints, Span)>,
    run_feed: Option<Decimal>,
    led: bool,
    /// The tool that was called last, and whether a line named the register of its length.
    tool: Option<(ToolCall, bool)>,
    /// Whether a tilted plane is in force.
    pub(super) tilted: bool,
    /// Which axes the cuts so far name.
    named: [bool; MAX_AXES],
    /// The first cut from a position that was not known in these axes.
    unknown: Option<([bool; MAX_AXES], Span)>,
    /// The first cut in which each axis is nowhere known and not named.
    missing: [Option<Span>; MAX_AXES],
    /// How many arcs end beside their circle by more than rounding, and by how much and where the worst of them, mm.
    misfits: Option<(usize, f64, Span)>,
}

impl<'m> Assembler<'m> {
    /// An empty program.
    pub fn new(machine: &'m Machine, source: SourceId, text: &str) -> Assembler<'m> {
        let mut letters = [None; 26];
        for (i, (axis, _)) in machine.axes.as_slice().iter().enumerate() {
            if let [letter] = axis.as_str().as_bytes() {
                letters[usize::from(letter - b'A')] = Some(i as u8);
            }
        }
        Assembler {
            machine,
            source,
            size: text.len(),
            digits: machine.axis_digits(),
            position: [None; MAX_AXES],
            feed: None,
            inverse: false,
            rate: None,
            diagnostics: Diagnostics::new(),
            name: String::new(),
            number: 0,
            parameters: BTreeMap::new(),
            stated: Stated::default(),
            shift: [0; MAX_AXES],
            reversed: machine.reversed(),
            modulo: std::array::from_fn(|i| {
                i < machine.axes.count() && machine.limits(machine.axes.name(i)).modulo
            }),
            letters,
            steps: Vec::new(),
            run: None,
            run_feed: None,
            led: false,
            tool: None,
            tilted: false,
            named: [false; MAX_AXES],
            unknown: None,
            missing: [None; MAX_AXES],
            misfits: None,
        }
    }

    /// The place of bytes `range` of the text.
    pub fn span(&self, range: std::ops::Range<usize>) -> Span {
        Span::new(self.source, range)
    }

    /// Says that something is wrong.
    pub fn error(&mut self, id: &'static str, message: impl Into<String>, range: std::ops::Range<usize>) {
        let span = self.span(range);
        self.diagnostics.push(Diagnostic::error(id, message).at(span, ""));
    }

    /// Says that a word names an axis that the machine file does not.
    pub fn axis_unknown(&mut self, name: &str, range: std::ops::Range<usize>) {
        let span = self.span(range);
        self.diagnostics.push(
            Diagnostic::error("axis-unknown", format!("{name} is not an axis of this machine"))
                .at(span, "")
                .hint("where the machine has it, name it under [axes] linear or rotary of the machine file"),
        );
    }

    /// Which axis a single letter names.
    #[inline]
    pub fn letter(&self, letter: u8) -> Option<usize> {
        if !letter.is_ascii_uppercase() {
            return None;
        }
        self.letters[usize::from(letter - b'A')].map(usize::from)
    }

    /// Which axis a name of any length names.
    pub fn axis(&self, name: &str) -> Option<usize> {
        let axes = self.machine.axes;
        Axis::new(name).and_then(|axis| axes.index_of(axis)).filter(|i| axes.kind(*i) != Kind::Direction)
    }

    /// The components of a direction as a block names them, behind the axes of the block.
    pub fn direction(
        &mut self,
        components: [Option<Decimal>; 3],
        range: std::ops::Range<usize>,
    ) -> Option<[(usize, i64); 3]> {
        let Some(first) = self.machine.axes.direction() else {
            let message = "this program leads no tip, so that no block states the tool's direction";
            self.error("direction", message, range);
            return None;
        };
        let mut named = [(0, 0); 3];
        for (i, component) in components.into_iter().enumerate() {
            let Some(component) = component else {
                let message = "the direction of the tool has three components, and each is written";
                self.error("direction-incomplete", message, range);
                return None;
            };
            named[i] = (first + i, self.units(first + i, component, range.clone())?);
        }
        if named.iter().all(|(_, units)| *units == 0) {
            self.error("direction", "the direction of the tool has no length", range);
            return None;
        }
        Some(named)
    }

    /// A position in units of the axis' last decimal, counted from the work's own zero; where it has more decimals, an
    /// error.
    #[inline]
    pub fn units(&mut self, axis: usize, value: Decimal, range: std::ops::Range<usize>) -> Option<i64> {
        let counted = value.units(self.digits[axis]);
        let turned = |units: i64| if self.reversed[axis] { units.checked_neg() } else { Some(units) };
        let units = counted.and_then(turned).and_then(|units| units.checked_add(self.shift[axis]));
        if units.is_none() {
            self.too_many_digits(axis, value, range);
        }
        units
    }

    #[cold]
    fn too_many_digits(&mut self, axis: usize, value: Decimal, range: std::ops::Range<usize>) {
        let (name, digits) = (self.machine.axes.name(axis), self.digits[axis]);
        let message = format!(
            "{name} {value} has more decimals than the {digits} that the machine file gives this axis"
        );
        self.error("digits-too-many", message, range);
    }

    /// The number that stands in the text for a position.
    pub fn counted(&self, axis: usize, units: i64) -> Option<Decimal> {
        let counted = units.checked_sub(self.shift[axis])?;
        let counted = if self.reversed[axis] { counted.checked_neg()? } else { counted };
        Some(Decimal::new(counted, self.digits[axis]))
    }

    /// The place nearest to where an axis is that is `units` but for whole turns: the short way round. None where
    /// nobody knows where the axis is, or where both ways are as long.
    pub fn nearest(&self, axis: usize, units: i64) -> Option<i64> {
        let turn = 360 * power_of_ten(self.digits[axis]);
        let from = self.position[axis]?;
        let step = units.checked_sub(from)?.rem_euclid(turn);
        match (2 * step).cmp(&turn) {
            std::cmp::Ordering::Less => from.checked_add(step),
            std::cmp::Ordering::Equal => None,
            std::cmp::Ordering::Greater => from.checked_add(step - turn),
        }
    }

    /// Whether an axis wraps at 360 degrees.
    pub fn wraps(&self, axis: usize) -> bool {
        self.modulo[axis]
    }

    /// A coefficient of an axis, as it counts here.
    pub fn coefficient(&self, axis: usize, a: Decimal) -> Decimal {
        if self.reversed[axis] { a.times(-1).unwrap_or(a) } else { a }
    }

    /// The value of a parameter; where nobody set it, an error.
    pub fn parameter(&mut self, number: u32, range: std::ops::Range<usize>) -> Option<Decimal> {
        let value = self.parameters.get(&number).copied();
        if value.is_none() {
            let letter = self.machine.dialect.parameter.letter;
            self.error("parameter-unset", format!("nothing sets {letter}{number} before"), range);
        }
        value
    }

    /// Forgets where an axis is: a line of the machine file moves it, or counts it from elsewhere.
    pub fn lose(&mut self, axis: usize) {
        self.position[axis] = None;
    }

    /// Forgets the feed: a line of the machine file has another, and a move that needs one states it again.
    pub fn lose_feed(&mut self) {
        self.flush();
        self.feed = None;
    }

    /// Adds a retraction in machine coordinates.
    pub fn home(&mut self, axis: usize, span: Span) {
        self.position[axis] = None;
        self.step(Step::Home(axis), span);
    }

    /// The position where all axes are known; unknown ones from `fallback`. There is a warning in the end where a cut names
    /// such an axis: others stand wherever they are.
    pub fn start(&mut self, named: &[(usize, i64)], fallback: &Units, span: Span) -> Units {
        let count = self.machine.axes.count();
        // A direction is stated or not in force.
        for i in 0..self.machine.axes.direction().unwrap_or(count) {
            if self.position[i].is_none() && !named.iter().any(|(axis, _)| *axis == i) {
                self.missing[i] = self.missing[i].or(Some(span));
            }
        }
        if self.unknown.is_none() && self.position[..count].contains(&None) {
            self.unknown = Some((self.position.map(|place| place.is_none()), span));
        }
        std::array::from_fn(|i| if i < count { self.position[i].unwrap_or(fallback[i]) } else { 0 })
    }

    /// The end of a move that names some axes.
    #[inline]
    pub fn target(&mut self, named: &[(usize, i64)]) -> Units {
        let mut target = [0; MAX_AXES];
        for (i, position) in self.position.iter().enumerate() {
            target[i] = position.unwrap_or(0);
        }
        for (axis, units) in named {
            target[*axis] = *units;
            self.named[*axis] = true;
        }
        target
    }

    /// A program without steps, to evaluate a curve in.
    pub fn empty(&self) -> Decimals {
        let program = Program { name: String::new(), number: 0, axes: self.machine.axes, steps: Vec::new() };
        Decimals { program, digits: self.digits, unnamed: [false; MAX_AXES], setup: Vec::new() }
    }

    /// The tool that was called last.
    pub fn tool(&self) -> Option<ToolCall> {
        self.tool.map(|(call, _)| call)
    }

    /// Whether this tool was called last.
    pub fn has_tool(&self, number: u32) -> bool {
        self.tool().is_some_and(|call| call.number == number)
    }

    /// Takes the length of the tool that was called last from a register: the first line that names one says which it is.
    /// False where another line did, or no tool was called.
    pub fn takes_register(&mut self, register: u32, span: Span) -> bool {
        let Some((call, known)) = &mut self.tool else { return false };
        if *known {
            return call.register() == register;
        }
        *call = call.with_register(register);
        *known = true;
        let call = *call;
        let called = self.steps.iter_mut().rev().find(|located| matches!(located.step, Step::Tool(_)));
        if let Some(located) = called {
            located.step = Step::Tool(call);
            if !call.is_own() {
                // What is told of it is told where it stands.
                located.span = span;
            }
        }
        true
    }

    /// Whether Z, X and Y are at their homes in machine coordinates.
    pub fn is_parked(&self) -> bool {
        let Some(axes) = self.machine.park().filter(|_| self.run.is_none()) else { return false };
        let moves = |located: &&Located<Decimal, Written>| match located.step {
            Step::Rapid(_) | Step::Cut(_) => false,
            Step::Comment(_)
            | Step::Tool(_)
            | Step::Spindle(_)
            | Step::Coolant
            | Step::Home(_)
            | Step::Shift(_)
            | Step::Auxiliary(_) => true,
        };
        let since = || self.steps.iter().rev().take_while(moves);
        axes.iter().all(|axis| since().any(|located| located.step == Step::Home(*axis)))
    }

    /// Whether the last step is that the tip is led from here on.
    pub fn begins_tip_control(&self) -> bool {
        self.run.is_none()
            && self
                .steps
                .last()
                .is_some_and(|last| matches!(last.step, Step::Auxiliary(Auxiliary::TipControl)))
    }

    fn arrive(&mut self, point: &Units) {
        for i in 0..self.machine.axes.count() {
            self.position[i] = Some(point[i]);
        }
    }

    fn flush(&mut self) {
        if let Some((points, span)) = self.run.take() {
            let cut = Cut { feed: self.run_feed, role: Role::Path, curve: Written::Lines(points) };
            self.steps.push(Located { step: Step::Cut(cut), span });
        }
    }

    /// Whether more than remarks and retractions has come.
    pub fn has_begun(&self) -> bool {
        self.run.is_some()
            || self.steps.iter().any(|located| !matches!(located.step, Step::Comment(_) | Step::Home(_)))
    }

    /// Ends a run of lines: one that follows is another cut.
    pub fn end_run(&mut self) {
        self.flush();
    }

    /// Whether the tip of the tool is led.
    pub fn leads_tip(&self) -> bool {
        self.led
    }

    /// Adds a step that is no move.
    pub fn step(&mut self, step: Step<Decimal, Written>, span: Span) {
        match &step {
            Step::Tool(call) => self.tool = Some((*call, false)),
            Step::Auxiliary(Auxiliary::TipControl) => {
                self.led = true;
                self.changes_frames(span);
            }
            Step::Auxiliary(Auxiliary::TipControlEnd) => {
                self.led = false;
                self.changes_frames(span);
                if self.machine.frame.tip_end_parks {
                    self.position = [None; MAX_AXES];
                }
            }
            Step::Auxiliary(Auxiliary::Plane(_) | Auxiliary::PlaneEnd) => {
                self.position = [None; MAX_AXES];
                self.tilted = !matches!(step, Step::Auxiliary(Auxiliary::PlaneEnd));
                if self.is_shifted() {
                    self.shift_elsewhere("a tilted plane beside a work offset is not read", span);
                }
            }
            Step::Auxiliary(_)
            | Step::Comment(_)
            | Step::Spindle(_)
            | Step::Coolant
            | Step::Home(_)
            | Step::Shift(_)
            | Step::Rapid(_)
            | Step::Cut(_) => {}
        }
        self.flush();
        self.steps.push(Located { step, span });
    }

    /// Adds a rapid of the axes named.
    pub fn rapid(&mut self, named: &[(usize, i64)], span: Span) {
        let targets =
            named.iter().map(|(axis, units)| (*axis, Decimal::new(*units, self.digits[*axis]))).collect();
        for (axis, units) in named {
            self.position[*axis] = Some(*units);
        }
        self.step(Step::Rapid(targets), span);
    }

    /// Adds a straight move of the axes named.
    #[inline]
    pub fn line(&mut self, named: &[(usize, i64)], line: u32, span: Span) {
        let stride = self.machine.axes.count();
        let target = self.target(named);
        let feed = if self.inverse { None } else { self.feed };
        let timed = self.run.as_ref().map(|(points, _)| !points.rates.is_empty());
        if timed.is_some_and(|timed| timed != self.inverse || self.run_feed != feed) {
            self.flush();
        }
        if self.run.is_none() {
            let start = self.start(named, &target, span);
            self.run_feed = feed;
            self.run = Some((
                WrittenPoints { start, stride, units: Vec::new(), lines: Vec::new(), rates: Vec::new() },
                span,
            ));
        }
        if let Some((points, whole)) = &mut self.run {
            if points.lines.len() == LONG_RUN {
                let more = expected(LONG_RUN, *whole, self.size);
                points.lines.reserve(more);
                points.units.reserve(more * stride);
            }
            points.units.extend_from_slice(&target[..stride]);
            points.lines.push(line);
            if self.inverse {
                points.rates.extend(self.rate);
            }
            whole.end = span.end;
        }
        self.arrive(&target);
    }

    /// Adds a curve that ends at `end`.
    pub fn curve(&mut self, curve: Written, end: &Units, span: Span) {
        let cut = Cut { feed: self.feed, role: Role::Path, curve };
        self.arrive(end);
        self.step(Step::Cut(cut), span);
    }

    /// Remembers an arc whose radii differ by so much, mm: there is one warning for all of them.
    pub fn misfits(&mut self, misfit: f64, span: Span) {
        let (count, worst, at) = self.misfits.unwrap_or((0, 0.0, span));
        let (worst, at) = if worst < misfit { (misfit, span) } else { (worst, at) };
        self.misfits = Some((count + 1, worst, at));
    }

    /// Refuses cuts in which an axis of the program is nowhere known: at its home, or before anything named it. Where it is then
    /// only the machine knows, and no other program could go there. Which axes cuts start in and nothing names at all.
    fn nowhere(&mut self) -> [bool; MAX_AXES] {
        let mut named = self.named;
        for located in &self.steps {
            if let Step::Rapid(targets) = &located.step {
                for (axis, _) in targets {
                    named[*axis] = true;
                }
            }
        }
        let first = (0..MAX_AXES).filter(|i| named[*i]).filter_map(|i| Some((self.missing[i]?, i)));
        if let Some((span, axis)) = first.min_by_key(|(span, _)| span.start) {
            let message =
                format!("where {} is in this cut the text does not say", self.machine.axes.name(axis));
            self.diagnostics.push(
                Diagnostic::error("place-unknown", message)
                    .at(span, "")
                    .hint("nothing named it yet, or it went to its home: a rapid before says where it is"),
            );
        }
        std::array::from_fn(|i| self.missing[i].is_some() && !named[i])
    }

    /// The program, or what is wrong with it.
    ///
    /// # Errors
    /// The diagnostics hold one.
    pub fn finish(mut self) -> Result<Warned<(Decimals, Stated)>, Diagnostics> {
        self.flush();
        let unnamed = self.nowhere();
        if let Some((unknown, span)) = self.unknown
            && (0..MAX_AXES).any(|i| unknown[i] && self.named[i])
        {
            self.diagnostics.push(
                Diagnostic::warning(
                    "start-unknown",
                    "the first cut starts at a position that the text does not say",
                )
                .at(span, "starts from an unknown position"),
            );
        }
        if let Some((count, worst, span)) = self.misfits {
            let arcs = if count == 1 { "an arc ends".to_owned() } else { format!("{count} arcs end") };
            let message = format!(
                "{arcs} beside its circle by more than rounding: radii to start and end differ by up to {worst:.4} mm"
            );
            let message =
                if count == 1 { message } else { message.replacen("its circle", "their circles", 1) };
            self.diagnostics.push(
                Diagnostic::warning("arc-misfit", message)
                    .at(span, "the worst")
                    .hint("a control stops here if its limit is less, or runs a circle of its own choice"),
            );
        }
        let warnings = self.diagnostics.into_result()?;
        let mut steps = self.steps;
        // Remarks before the first step say what to set up; others are sections.
        let remarks = steps.iter().take_while(|located| matches!(located.step, Step::Comment(_))).count();
        let first = if self.machine.frame.setup { remarks } else { 0 };
        let setup = steps.drain(..first).filter_map(|located| match located.step {
            Step::Comment(text) => Some(text),
            Step::Tool(_)
            | Step::Spindle(_)
            | Step::Coolant
            | Step::Home(_)
            | Step::Shift(_)
            | Step::Auxiliary(_)
            | Step::Rapid(_)
            | Step::Cut(_) => None,
        });
        let setup = setup.collect();
        let Assembler { name, number, machine, digits, stated, .. } = self;
        let program = Program { name, number, axes: machine.axes, steps };
        Ok(Warned { value: (Decimals { program, digits, unnamed, setup }, stated), warnings })
    }
}
