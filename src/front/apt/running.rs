//! Whether the spindle turns and the coolant flows where a tool cuts. A tool change stops both on most machines, and what was
//! on before it holds for the tool before it: a file that does not say them again is written as it stands, with a warning.

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::Span;

/// What became of the spindle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Spindle {
    /// Nothing was said of it.
    #[default]
    Unsaid,
    /// It was started.
    Turns,
    /// It was stopped.
    Stopped,
    /// A tool was called.
    Called(u32),
}

/// What became of the coolant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Coolant {
    /// It is off, or was never on.
    #[default]
    Off,
    /// It was started.
    Flows,
    /// It was on, and a tool was called.
    Called(u32),
}

/// What runs, and what is to be said of it.
#[derive(Debug, Default)]
pub(super) struct Running {
    spindle: Spindle,
    coolant: Coolant,
    /// Whether it was told that the spindle stands.
    told: bool,
    /// What there is to know.
    pub(super) warnings: Diagnostics,
}

impl Running {
    /// The spindle starts or stops.
    pub(super) fn spindle(&mut self, spindle: Spindle) {
        self.spindle = spindle;
        self.told = false;
    }

    /// The coolant starts or stops.
    pub(super) fn coolant(&mut self, coolant: Coolant) {
        self.coolant = coolant;
    }

    /// A tool is called.
    pub(super) fn tool(&mut self, number: u32) {
        self.spindle(Spindle::Called(number));
        if self.coolant != Coolant::Off {
            self.coolant = Coolant::Called(number);
        }
    }

    /// Cuts, at `span`: warns once of a spindle that stands, and of coolant that another tool had.
    pub(super) fn cuts(&mut self, span: Span) {
        if self.spindle != Spindle::Turns && !self.told {
            self.told = true;
            let message = match self.spindle {
                Spindle::Called(tool) => {
                    format!("tool {tool} cuts here, and nothing started the spindle since it was called")
                }
                Spindle::Stopped => "the spindle was stopped before this cut".to_owned(),
                Spindle::Turns | Spindle::Unsaid => "nothing started the spindle before this cut".to_owned(),
            };
            self.warnings.push(
                Diagnostic::warning("spindle-missing", message)
                    .at(span, "")
                    .hint("SPINDL behind the tool call starts it; a tool change stops the spindle"),
            );
        }
        if let Coolant::Called(tool) = self.coolant {
            self.coolant = Coolant::Off;
            let message =
                format!("tool {tool} cuts here without coolant, which was on before the tool was called");
            self.warnings.push(Diagnostic::warning("coolant-missing", message).at(span, "").hint(
                "COOLNT/ON behind the tool call starts it; COOLNT/OFF before says that it is to be off",
            ));
        }
    }
}
