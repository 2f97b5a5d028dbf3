//! Coolant round a tool change: what flows when a tool is called stops before the tool goes home, and flows again before it moves
//! to the work. Otherwise it runs out over the changer, or a tool cuts dry on a control that ends it by itself.
//!
//! Where the input says what is to be between the call and the first move, that is what is done.

use crate::ir::{Auxiliary, Curve, Intent, Located, Step};
use crate::machine::Machine;

/// Stops the coolant before tool changes, and starts it again behind them.
pub(super) fn round_changes(intent: &mut Intent, machine: &Machine) {
    let stops = !machine.frame.coolant_stop.is_empty();
    let steps = std::mem::take(&mut intent.program.steps);
    let mut all: Vec<Located<f64, Curve>> = Vec::with_capacity(steps.len() + 8);
    // Whether it flows, and whether it is to flow again with the next move.
    let (mut flows, mut due) = (false, false);
    // Behind the last move and the switches that belong to it.
    let mut behind = 0;
    // Where it was started, as long as nothing has moved since.
    let mut started = None;
    for located in steps {
        let span = located.span;
        match &located.step {
            Step::Coolant => {
                (flows, due) = (true, false);
                started = Some(all.len());
            }
            Step::Auxiliary(Auxiliary::CoolantStop) => (flows, due) = (false, false),
            Step::Tool(_) if flows => {
                if let Some(at) = started {
                    all.remove(at);
                    started = None;
                    behind = behind.min(all.len());
                } else if stops {
                    all.insert(behind, Located { step: Step::Auxiliary(Auxiliary::CoolantStop), span });
                }
                (flows, due) = (false, true);
            }
            Step::Rapid(_) | Step::Cut(_) => {
                if due {
                    all.push(Located { step: Step::Coolant, span });
                    (flows, due) = (true, false);
                }
                started = None;
            }
            Step::Tool(_)
            | Step::Comment(_)
            | Step::Spindle(_)
            | Step::Home(_)
            | Step::Shift(_)
            | Step::Auxiliary(_) => {}
        }
        let moves = match &located.step {
            // The plane and the tip are let go before the tool goes home.
            Step::Rapid(_) | Step::Cut(_) | Step::Coolant | Step::Auxiliary(_) => true,
            Step::Tool(_) | Step::Comment(_) | Step::Spindle(_) | Step::Home(_) | Step::Shift(_) => false,
        };
        all.push(located);
        if moves {
            behind = all.len();
        }
    }
    intent.program.steps = all;
}
