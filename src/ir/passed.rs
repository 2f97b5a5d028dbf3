//! Programs on their way through the passes.

use super::{Curve, Cut, Program, Step};
use std::borrow::Cow;

/// A program of which some curves are still the intent's own: a million points that no pass changes are not copied.
pub type Passed<'i> = Program<f64, Cow<'i, Curve>>;

impl Step<f64, Curve> {
    /// The same step, its curve that of this one.
    pub fn borrowed(&self) -> Step<f64, Cow<'_, Curve>> {
        match self {
            Step::Comment(text) => Step::Comment(text.clone()),
            Step::Tool(call) => Step::Tool(*call),
            Step::Spindle(rpm) => Step::Spindle(*rpm),
            Step::Coolant => Step::Coolant,
            Step::Home(axis) => Step::Home(*axis),
            Step::Shift(shifts) => Step::Shift(shifts.clone()),
            Step::Auxiliary(auxiliary) => Step::Auxiliary(*auxiliary),
            Step::Rapid(targets) => Step::Rapid(targets.clone()),
            Step::Cut(Cut { feed, role, curve }) => {
                Step::Cut(Cut { feed: *feed, role: *role, curve: Cow::Borrowed(curve) })
            }
        }
    }
}
