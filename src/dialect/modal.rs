//! What a writer remembers between blocks, so that words which still hold are not written again.
//!
//! All of it is forgotten at the start of a section, so that a program can be restarted there.

use super::Round;
use crate::decimal::{Decimal, Spelling, power_of_ten, write_units};
use crate::ir::{Shift, Units, WrittenPoints};
use crate::machine::{Machine, RotaryFeed};
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
    /// What stands before the value of each axis.
    names: [Vec<u8>; MAX_AXES],
    /// The first component of the tool's direction, in five axes.
    pub direction: Option<usize>,
    /// Where the text counts each axis from, in units of its last decimal.
    shift: Units,
    /// Which axes the control counts the other way.
    reversed: [bool; MAX_AXES],
    /// Which axes go round past 360 degrees in the lines that are written.
    round: [bool; MAX_AXES],
    /// Which axes went round in steps, so that the control may count them beyond 360 degrees.
    pub wound: [bool; MAX_AXES],
    /// Each feed that is a parameter, and its number.
    feeds: Vec<(Decimal, u32)>,
    /// Where each axis is known to be, in units of its last decimal.
    pub position: [Option<i64>; MAX_AXES],
    /// The motion word in force.
    pub motion: Option<&'static str>,
    /// The feed in force.
    pub feed: Option<Decimal>,
    /// Whether F is known to be inverse time.
    inverse: Option<bool>,
    number: u32,
}

/// The name of an axis, with `=` where a value cannot follow it directly.
fn name(machine: &Machine, i: usize) -> Vec<u8> {
    if let Some(component) = machine.axes.direction().and_then(|first| i.checked_sub(first)) {
        return machine.dialect.direction[component].as_bytes().to_vec();
    }
    match machine.axes.name(i).as_bytes() {
        letter @ [_] => letter.to_vec(),
        name => [name, b"="].concat(),
    }
}

impl<'m> Modal<'m> {
    /// An empty text for a program of about `size` bytes.
    pub fn new(machine: &'m Machine, size: usize) -> Modal<'m> {
        Modal {
            out: Vec::with_capacity(size),
            machine,
            spelling: machine.text.spelling(),
            digits: machine.axis_digits(),
            names: std::array::from_fn(
                |i| if i < machine.axes.count() { name(machine, i) } else { Vec::new() },
            ),
            direction: machine.axes.direction(),
            shift: [0; MAX_AXES],
            reversed: machine.reversed(),
            round: [false; MAX_AXES],
            wound: [false; MAX_AXES],
            feeds: Vec::new(),
            position: [None; MAX_AXES],
            motion: None,
            feed: None,
            inverse: None,
            number: machine.text.number_start,
        }
    }

    /// Forgets everything that a control would remember.
    pub fn forget(&mut self) {
        self.position = [None; MAX_AXES];
        self.motion = None;
        self.feed = None;
        self.inverse = None;
    }

    /// Writes text.
    #[inline]
    pub fn text(&mut self, text: &str) {
        self.out.extend_from_slice(text.as_bytes());
    }

    /// Starts a block with its number, where the machine numbers its blocks.
    #[inline]
    pub fn begin(&mut self, prefix: &str) {
        let step = self.machine.text.number_step;
        if step != 0 {
            self.text(prefix);
            self.text(itoa::Buffer::new().format(self.number));
            self.gap();
            self.number = self.number.wrapping_add(step);
        }
    }

    /// Ends a block.
    #[inline]
    pub fn end(&mut self) {
        if self.out.last() == Some(&b' ') {
            self.out.pop();
        }
        self.end_line();
    }

    /// Ends a line.
    #[inline]
    pub fn end_line(&mut self) {
        self.text(self.machine.text.line_end.text());
    }

    /// Ends a word. Where blocks have no blanks, a number ends where a letter begins.
    #[inline]
    pub fn gap(&mut self) {
        if self.machine.text.spaces || !self.out.last().is_some_and(|b| b.is_ascii_digit() || *b == b'.') {
            self.out.push(b' ');
        }
    }

    /// The motion word, where it is not in force.
    pub fn motion(&mut self, word: &'static str) {
        if self.motion != Some(word) {
            self.text(word);
            self.gap();
            self.motion = Some(word);
        }
    }

    /// G93 or G94, where F counts inverse time on this machine and the other holds.
    pub fn inverse(&mut self, on: bool) {
        if self.machine.rotary_feed == RotaryFeed::InverseTime && self.inverse != Some(on) {
            self.text(if on { "G93" } else { "G94" });
            self.gap();
            self.inverse = Some(on);
            self.feed = None;
        }
    }

    /// Whether F is inverse time: no more than a run of lines is left so.
    pub fn is_timed(&self) -> bool {
        self.inverse == Some(true)
    }

    /// F of one line under inverse time.
    pub fn rate(&mut self, rate: Decimal) {
        self.out.push(b'F');
        rate.write(&mut self.out, Spelling { sign_always: false, ..self.spelling });
        self.gap();
    }

    /// F, where another is in force: a number, which is never negative and has no sign, or the parameter that holds it.
    pub fn feed(&mut self, feed: Option<Decimal>) {
        if let Some(value) = feed
            && self.feed != feed
        {
            self.out.push(b'F');
            match self.feeds.iter().find(|(known, _)| *known == value) {
                Some((_, number)) => {
                    let word = (self.machine.dialect.parameter.word)(*number);
                    self.text(&word);
                }
                None => value.write(&mut self.out, Spelling { sign_always: false, ..self.spelling }),
            }
            self.gap();
            self.feed = feed;
        }
    }

    /// Takes feeds as parameters from here on.
    pub fn parameters(&mut self, feeds: &[(Decimal, u32)]) {
        self.feeds = feeds.to_vec();
    }

    /// Counts these axes from other places from here on, and the others as before.
    pub fn shift(&mut self, shifts: &[Shift<Decimal>]) {
        for Shift { axis, to, .. } in shifts {
            self.shift[*axis] = to.units(self.digits[*axis]).unwrap_or_default();
        }
    }

    /// The number that stands in the text for a position.
    #[inline]
    pub fn counted(&self, i: usize, units: i64) -> i64 {
        let units = units - self.shift[i];
        if self.reversed[i] { -units } else { units }
    }

    /// The number that stands in the text for a coefficient of axis `i`.
    pub fn coefficient(&self, i: usize, a: Decimal) -> Decimal {
        if self.reversed[i] { a.times(-1).unwrap_or(a) } else { a }
    }

    /// A run of lines starts: axes that wrap, and leave 0 to 360 degrees in it, go round.
    pub fn lines(&mut self, points: &WrittenPoints) {
        for i in 0..points.stride {
            self.round[i] = self.goes_round(points, i);
        }
    }

    /// Whether an axis wraps, and leaves 0 to 360 degrees in a run of lines.
    pub fn goes_round(&self, points: &WrittenPoints, i: usize) -> bool {
        if !self.machine.limits(self.machine.axes.name(i)).modulo {
            return false;
        }
        let turn = 360 * power_of_ten(self.digits[i]);
        let outside = |units: i64| !(0..turn).contains(&(units - self.shift[i]));
        outside(points.start[i]) || points.points().any(|point| outside(point[i]))
    }

    /// A run of lines has ended.
    pub fn lines_end(&mut self) {
        self.round = [false; MAX_AXES];
    }

    /// The word of an axis that goes round.
    fn round_word(&mut self, i: usize, units: i64) {
        let turn = 360 * power_of_ten(self.digits[i]);
        let place = self.counted(i, units).rem_euclid(turn);
        let name = self.machine.axes.name(i);
        match self.machine.dialect.round {
            Round::Shortest => {
                self.text(name.as_str());
                self.text("=DC(");
                write_units(&mut self.out, place, self.digits[i], self.spelling);
                self.text(")");
            }
            Round::Step => {
                let step = units - self.position[i].unwrap_or(units);
                let step = if self.reversed[i] { -step } else { step };
                self.text("I");
                self.axis_name(i);
                write_units(&mut self.out, step, self.digits[i], self.spelling);
                self.wound[i] = true;
            }
            Round::Place => {
                self.axis_name(i);
                write_units(&mut self.out, place, self.digits[i], self.spelling);
            }
        }
        self.gap();
    }

    /// An axis word. `=` separates a name of more than one letter from its value.
    #[inline]
    pub fn axis(&mut self, i: usize, units: i64) {
        if self.round[i] {
            return self.round_word(i, units);
        }
        let counted = self.counted(i, units);
        self.axis_name(i);
        write_units(&mut self.out, counted, self.digits[i], self.spelling);
        self.gap();
    }

    /// The name of an axis, with `=` where a value cannot follow it directly.
    #[inline]
    pub fn axis_name(&mut self, i: usize) {
        match self.names[i].as_slice() {
            [letter] => self.out.push(*letter),
            name => self.out.extend_from_slice(name),
        }
    }

    /// The words of the axes named, moved or not.
    pub fn axes(&mut self, named: &[usize], point: &Units) {
        for i in named {
            self.axis(*i, point[*i]);
        }
    }

    /// The words of the axes that a straight move moves; the first where it moves none, since a block needs one. The tool's
    /// direction is never modal.
    #[inline]
    pub fn moved_axes(&mut self, point: &[i64]) {
        let places = self.direction.unwrap_or(point.len());
        let mut moved = false;
        for (i, units) in point.iter().enumerate().take(places) {
            if self.position[i] != Some(*units) {
                self.axis(i, *units);
                moved = true;
            }
        }
        if !moved {
            self.axis(0, point[0]);
        }
        for (i, units) in point.iter().enumerate().skip(places) {
            self.axis(i, *units);
        }
    }

    /// The words of the tool's direction, where it is led: they are never modal.
    pub fn directions(&mut self, point: &Units) {
        if let Some(first) = self.direction {
            (first..first + 3).for_each(|i| self.axis(i, point[i]));
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

    /// Takes an axis to be nowhere known.
    pub fn lose(&mut self, axis: usize) {
        self.position[axis] = None;
    }

    /// Takes a point as reached.
    #[inline]
    pub fn reached(&mut self, point: &[i64]) {
        for (known, units) in self.position.iter_mut().zip(point).take(self.machine.axes.count()) {
            *known = Some(*units);
        }
    }
}
