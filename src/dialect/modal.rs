//! What a writer remembers between blocks, so that words which still hold are not written again.
//!
//! All of it is forgotten at the start of a section, so that a program can be restarted there.

use crate::decimal::Decimal;
use crate::ir::{Step, Units};
use crate::machine::Machine;
use crate::machine::template::Template;
use crate::units::MAX_AXES;

/// A program text in the making, and the modal state behind it.
pub struct Modal<'m> {
    /// The text so far.
    pub out: Vec<u8>,
    /// The machine.
    pub machine: &'m Machine,
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

    /// The number of the next block, as text; empty where the machine has none.
    pub fn take_number(&mut self) -> Option<u32> {
        if self.machine.text.number_step == 0 {
            return None;
        }
        let number = self.number;
        self.number = self.number.wrapping_add(self.machine.text.number_step);
        Some(number)
    }

    /// Ends a block.
    pub fn end(&mut self) {
        if self.out.last() == Some(&b' ') {
            self.out.pop();
        }
        self.out.push(b'\n');
    }

    /// Whether a point at `point` moves axis `i`.
    pub fn moves(&self, i: usize, point: &Units) -> bool {
        self.position[i] != Some(point[i])
    }

    /// Takes a point as reached.
    pub fn reached(&mut self, point: &Units) {
        for i in 0..self.machine.axes.count() {
            self.position[i] = Some(point[i]);
        }
    }

    /// The lines of a tool call or a spindle's start, and how many steps they cover.
    pub fn frame_lines<C>(
        &self,
        step: &Step<Decimal, C>,
        next: Option<&Step<Decimal, C>>,
    ) -> (Vec<String>, usize) {
        let frame = &self.machine.frame;
        let fill = |lines: &[Template], tool: &str, rpm: &str| {
            lines.iter().map(|line| line.fill(&[("tool", tool), ("rpm", rpm)])).collect()
        };
        match (step, next) {
            (Step::Tool(tool), Some(Step::Spindle(rpm))) if !frame.tool_spindle.is_empty() => {
                (fill(&frame.tool_spindle, &tool.to_string(), &rpm.to_string()), 2)
            }
            (Step::Tool(tool), _) => (fill(&frame.tool, &tool.to_string(), ""), 1),
            (Step::Spindle(rpm), _) => (fill(&frame.spindle, "", &rpm.to_string()), 1),
            (Step::Comment(_) | Step::Rapid(_) | Step::Cut(_), _) => (Vec::new(), 1),
        }
    }
}
