//! Where the tip of a tilted tool is led from: what stands between its call and its first move, and behind its last.
//!
//! The input retracts Z before each tool is called. Behind the call the lines of the machine file lead the tip, the tool turns with
//! its tip at safe height, and goes to where its first move begins along its own axis. Behind its last move it goes up to
//! safe height the same way, before the tip is let go.
//!
//! No retraction stands between the call of a tool and its first move: on some controls it would end the length of the tool.

use super::Z;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::geom::direction;
use crate::ir::{Auxiliary, Curve, Cut, Intent, Located, Polyline, Role, Step};
use crate::machine::Machine;
use crate::source::Span;
use crate::units::{Axes, MAX_AXES, Position};

/// The least height of the tool's direction at which the tool goes to the work along its own axis; below it goes straight
/// down and up: a tilt of 60 degrees.
const STEEP: f64 = 0.5;

/// Directions this near to opposite, radians, have no plane to turn in: some 0.01 degrees.
const OPPOSITE: f64 = 2.0e-4;

struct Walk {
    axes: Axes,
    first: usize,
    safe: f64,
    stated: bool,
    /// The greatest Z of all cuts.
    cut: f64,
    all: Vec<Located<f64, Curve>>,
    led: bool,
    called: bool,
    /// Where the tip is, and the tool's direction.
    at: Option<Position>,
}

/// Leads the tip in an intent of five axes.
///
/// # Errors
/// A tool's length is not known, there is no safe height, or the tool turns by 180 degrees.
pub(super) fn lead(intent: &mut Intent, machine: &Machine) -> Result<(), Diagnostics> {
    let axes = intent.program.axes;
    let Some(first) = axes.direction() else { return Ok(()) };
    if let Some(located) = intent.program.steps.first() {
        super::park::parks_before(machine, located.span)?;
    }
    let steps = std::mem::take(&mut intent.program.steps);
    let stated = machine.orientation.safe_height;
    is_clear(&steps, stated)?;
    let mut walk = Walk {
        axes,
        first,
        safe: stated.unwrap_or_else(|| highest(&steps)),
        stated: stated.is_some(),
        cut: highest_cut(&steps),
        all: Vec::with_capacity(steps.len() + 8),
        led: false,
        called: false,
        at: None,
    };
    let last = steps.last().map(|located| located.span);
    for located in steps {
        walk.step(located)?;
    }
    if let Some(span) = last.filter(|_| walk.led) {
        walk.let_go(span)?;
    }
    intent.program.steps = walk.all;
    Ok(())
}

impl Walk {
    fn push(&mut self, step: Step<f64, Curve>, span: Span) {
        self.all.push(Located { step, span });
    }

    fn step(&mut self, located: Located<f64, Curve>) -> Result<(), Diagnostics> {
        let span = located.span;
        match &located.step {
            Step::Home(_) | Step::Tool(_) => {
                if self.led {
                    self.let_go(span)?;
                }
                self.called |= matches!(located.step, Step::Tool(_));
            }
            Step::Rapid(targets) => {
                let mut place = self.at.unwrap_or([0.0; MAX_AXES]);
                for (axis, to) in targets {
                    place[*axis] = *to;
                }
                self.take_up(&place, None, span)?;
                self.turns(&place, span)?;
            }
            Step::Cut(cut) => {
                if let Some((start, end)) = cut.curve.ends() {
                    self.take_up(&start, Some(cut), span)?;
                    if let Curve::Lines(line) = &cut.curve {
                        self.turns(&line.start, span)?;
                        for point in line.points() {
                            self.turns(&point, span)?;
                        }
                    }
                    self.at = Some(end);
                }
            }
            Step::Comment(_) | Step::Spindle(_) | Step::Coolant | Step::Shift(_) | Step::Auxiliary(_) => {}
        }
        self.all.push(located);
        Ok(())
    }

    /// Takes a place as reached; the tool must not turn by 180 degrees on the way.
    fn turns(&mut self, place: &Position, span: Span) -> Result<(), Diagnostics> {
        let turn = self.at.map_or(0.0, |at| direction::between(&at, place, self.first));
        self.at = Some(*place);
        if turn <= std::f64::consts::PI - OPPOSITE {
            return Ok(());
        }
        let message = "the tool turns by 180 degrees here, and every plane is as good as another";
        Err(Diagnostic::refusal("direction-opposite", message)
            .at(span, "")
            .hint("a move between says which way it turns")
            .into())
    }

    /// Leads the tip from here on, where it is not led: the tool turns at safe height and goes to `place`, at rapid where a rapid
    /// follows, otherwise at the feed of the cut that begins there.
    fn take_up(
        &mut self,
        place: &Position,
        cut: Option<&Cut<f64, Curve>>,
        span: Span,
    ) -> Result<(), Diagnostics> {
        if self.led {
            return Ok(());
        }
        if !self.called {
            let message =
                "the tip of a tilted tool is to be led, and no tool is called: its length is not known";
            return Err(Diagnostic::error("tool-missing", message).at(span, "").into());
        }
        self.led = true;
        let above = self.above(place, span)?;
        let steep = direction::unit(place, self.first)[self.first + 2] < STEEP;
        if above == *place && !self.stated && (cut.is_some() || (steep && place[Z] <= self.cut)) {
            let message = "the first move of this tool is as low as a cut, and nothing says where the tool may turn before";
            return Err(Diagnostic::refusal("safe-height", message)
                .at(span, "")
                .hint(
                    "state [orientation] safe_height in the machine file, or begin with a rapid in clear air",
                )
                .into());
        }
        self.push(Step::Auxiliary(Auxiliary::TipControl), span);
        if above != *place || cut.is_some() {
            self.rapid(&above, span);
        }
        if let Some(cut) = cut.filter(|_| above != *place) {
            let mut line = Polyline::new(above, self.axes.count());
            line.push(place);
            let down = Cut { feed: cut.feed, role: Role::Approach, curve: Curve::Lines(line) };
            self.push(Step::Cut(down), span);
        }
        self.at = Some(*place);
        Ok(())
    }

    /// Lets the tip go: a tool that is tilted goes to safe height first.
    fn let_go(&mut self, span: Span) -> Result<(), Diagnostics> {
        if let Some(at) = self.at {
            let above = self.above(&at, span)?;
            let unit = direction::unit(&at, self.first);
            let upright =
                unit[self.first] == 0.0 && unit[self.first + 1] == 0.0 && 0.0 < unit[self.first + 2];
            if above != at && !upright {
                self.rapid(&above, span);
            }
        }
        self.push(Step::Auxiliary(Auxiliary::TipControlEnd), span);
        self.led = false;
        Ok(())
    }

    fn rapid(&mut self, place: &Position, span: Span) {
        let unit = direction::unit(place, self.first);
        let targets = (0..self.axes.count()).map(|i| (i, unit[i])).collect();
        self.push(Step::Rapid(targets), span);
    }

    /// The place at safe height from which the tool goes to a place, and to which it comes back.
    fn above(&self, place: &Position, span: Span) -> Result<Position, Diagnostics> {
        let mut above = *place;
        if self.safe <= place[Z] {
            return Ok(above);
        }
        let unit = direction::unit(place, self.first);
        let up = unit[self.first + 2];
        if up <= 0.0 {
            let message =
                "the tool does not point up here, so that no way to safe height is known to be clear";
            return Err(Diagnostic::refusal("safe-height", message)
                .at(span, "")
                .hint("rapids of the input have to bring it there; [orientation] safe_height says how high that is")
                .into());
        }
        if STEEP <= up {
            let along = (self.safe - place[Z]) / up;
            for i in 0..Z {
                above[i] += along * unit[self.first + i];
            }
        }
        above[Z] = self.safe;
        Ok(above)
    }
}

/// Whether what is stated as safe height lies above all that is cut.
///
/// # Errors
/// It does not, so that the tool would come to the work at rapid, from wherever it is.
fn is_clear(steps: &[Located<f64, Curve>], stated: Option<f64>) -> Result<(), Diagnostics> {
    let Some(height) = stated else { return Ok(()) };
    for located in steps {
        let z = highest_cut(std::slice::from_ref(located));
        if height < z {
            let message = format!("safe_height is {height} mm, and here the tool cuts at Z {z}");
            return Err(Diagnostic::refusal("safe-height", message)
                .at(located.span, "")
                .hint("state [orientation] safe_height above all cuts")
                .into());
        }
    }
    Ok(())
}

/// The greatest Z that a cut leads to.
fn highest_cut(steps: &[Located<f64, Curve>]) -> f64 {
    let to = |curve: &Curve| match curve {
        // Where it begins the move before has brought the tool.
        Curve::Lines(line) => line.points().map(|point| point[Z]).fold(f64::NEG_INFINITY, f64::max),
        Curve::Arc(_)
        | Curve::Polynomial(_)
        | Curve::Nurbs(_)
        | Curve::Formula(_)
        | Curve::Through(..)
        | Curve::Logarithmic(_) => curve.greatest(Z),
    };
    let cuts = steps.iter().filter_map(|located| located.step.cut());
    cuts.map(|cut| to(&cut.curve)).fold(f64::NEG_INFINITY, f64::max)
}

/// The greatest Z that the tip goes to.
fn highest(steps: &[Located<f64, Curve>]) -> f64 {
    let mut highest = f64::NEG_INFINITY;
    let mut take = |z: f64| highest = highest.max(z);
    for located in steps {
        match &located.step {
            Step::Rapid(targets) => {
                for (_, z) in targets.iter().filter(|(axis, _)| *axis == Z) {
                    take(*z);
                }
            }
            Step::Cut(cut) => take(cut.curve.greatest(Z)),
            Step::Comment(_)
            | Step::Tool(_)
            | Step::Spindle(_)
            | Step::Coolant
            | Step::Home(_)
            | Step::Shift(_)
            | Step::Auxiliary(_) => {}
        }
    }
    highest
}
