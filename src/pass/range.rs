//! How far each axis goes, against what the machine file allows, and axes that wrap at 360 degrees.

use super::limits::each_piece;
use crate::decimal::Decimal;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::ir::{Decimals, Shift, Step, Units, Written};
use crate::machine::Machine;
use crate::source::Span;
use crate::units::{Kind, MAX_AXES};
use crate::verify::to_arc;

/// The greatest coordinate, mm or degrees, of the narrowest control (Heidenhain: ±99 999.9999).
const GREATEST: f64 = 99_999.999_9;

/// How often a piece is halved before its control points are taken for its range: the error is below a 4000th.
const HALVINGS: u32 = 6;

/// The least and the greatest position of every axis; of one that never moves the least is greater than the greatest.
pub fn extents(decimals: &Decimals) -> [(f64, f64); MAX_AXES] {
    let mut reach = Reach::new();
    for located in &decimals.program.steps {
        reach.step(decimals, &located.step);
    }
    reach.0
}

/// The same as the text counts it: from the work offsets in force, and the control's own way round.
pub fn counted_extents(decimals: &Decimals, machine: &Machine) -> [(f64, f64); MAX_AXES] {
    let mut zero = [0.0; MAX_AXES];
    let mut all = Reach::new();
    let reversed = machine.reversed();
    for located in &decimals.program.steps {
        if let Step::Shift(shifts) = &located.step {
            for shift in shifts {
                zero[shift.axis] = shift.to.to_f64();
            }
        }
        let mut reach = Reach::new();
        reach.step(decimals, &located.step);
        for (axis, (low, high)) in reach.0.into_iter().enumerate().filter(|(_, (low, high))| low <= high) {
            let (low, high) = turned((low - zero[axis], high - zero[axis]), reversed[axis]);
            all.take(axis, low);
            all.take(axis, high);
        }
    }
    all.0
}

/// A range as an axis that counts the other way has it.
fn turned((low, high): (f64, f64), reversed: bool) -> (f64, f64) {
    if reversed { (0.0 - high, 0.0 - low) } else { (low, high) }
}

/// What is wrong with the places that a program goes to.
pub(super) fn positions(decimals: &Decimals, machine: &Machine) -> Diagnostics {
    let mut found = Diagnostics::new();
    let extents = extents(decimals);
    // What X is in a tilted plane says nothing of the machine's own X.
    let tilted = decimals.program.has_planes();
    for (i, (axis, kind)) in decimals.program.axes.as_slice().iter().enumerate() {
        let (low, high) = extents[i];
        if low < -GREATEST || GREATEST < high {
            let far = if low < -GREATEST { low } else { high };
            let message = format!("{axis} goes to {far}, beyond ±99999.9999");
            found.push(placed(
                Diagnostic::error("position-range", message),
                decimals,
                i,
                (-GREATEST, GREATEST),
            ));
        }
        let limits = machine.limits(*axis);
        if tilted && *kind == Kind::Linear {
            continue;
        }
        if limits.modulo {
            found.extend(wraps(decimals, machine, i).map(Diagnostics::from).unwrap_or_default());
            continue;
        }
        // The limits are the control's own figures.
        let stated = (limits.min.unwrap_or(f64::NEG_INFINITY), limits.max.unwrap_or(f64::INFINITY));
        let (least, most) = turned(stated, limits.reversed);
        if low < least || most < high {
            let range = match (limits.min, limits.max) {
                (Some(min), Some(max)) => format!("{min} to {max}"),
                (Some(min), None) => format!("least {min}"),
                (None, Some(max)) => format!("greatest {max}"),
                (None, None) => String::new(),
            };
            let message = format!(
                "{axis} goes from {:.4} to {:.4}, beyond the {range} of machine `{}`",
                turned((low, high), limits.reversed).0,
                turned((low, high), limits.reversed).1,
                machine.name
            );
            found.push(placed(Diagnostic::refusal("axis-range", message), decimals, i, (least, most)));
        }
        if *kind == Kind::Rotary && (low < 0.0 || 360.0 < high) {
            let range = format!("{axis} runs from {low:.3} to {high:.3} degrees, outside 0 to 360");
            found.push(Diagnostic::warning("rotary-range", range).hint(format!(
                "machine `{}` says [axis.{axis}] kind = \"linear\": it counts on and never takes the short way round",
                machine.name
            )));
        }
    }
    found
}

/// The diagnostic at the first block that leaves a range, with the place where it does.
fn placed(diagnostic: Diagnostic, decimals: &Decimals, axis: usize, (least, most): (f64, f64)) -> Diagnostic {
    let outside = |(low, high): (f64, f64)| low < least || most < high;
    let first = decimals.program.steps.iter().find(|located| {
        let mut reach = Reach::new();
        reach.step(decimals, &located.step);
        outside(reach.0[axis])
    });
    let Some(located) = first else { return diagnostic };
    let mut place = None;
    if let Some(cut) = located.step.cut() {
        each_piece(decimals, &cut.curve, |piece| {
            // The range is that of the whole piece; the first of some places on it says about where it is left.
            let places = (0..=PLACES).map(|i| piece.eval(f64::from(i) / f64::from(PLACES)));
            place = place.or_else(|| places.into_iter().find(|at| outside((at[axis], at[axis]))));
        });
    }
    let name = decimals.program.axes.name(0);
    let label =
        place.map_or_else(String::new, |at| format!("it leaves the range at about {name} {:.3}", at[0]));
    diagnostic.at(located.span, &label)
}

/// How many places of a piece are looked at to say where it leaves a range.
const PLACES: u32 = 64;

/// The first move of a modulo axis that the control would not make as it is meant, as its text counts it.
fn wraps(decimals: &Decimals, machine: &Machine, axis: usize) -> Option<Diagnostic> {
    let name = machine.axes.name(axis);
    let digits = decimals.digits[axis];
    let mut zero = 0.0;
    let refuse = |what: String, span: Span| {
        Diagnostic::refusal(
            "rotary-wraps",
            format!("{what}, and {name} of machine `{}` wraps at 360 degrees", machine.name),
        )
        .at(span, "")
    };
    for located in &decimals.program.steps {
        let outside = |low: f64, high: f64| low - zero < 0.0 || 360.0 < high - zero;
        match &located.step {
            Step::Shift(shifts) => {
                for Shift { to, .. } in shifts.iter().filter(|shift| shift.axis == axis) {
                    zero = to.to_f64();
                }
            }
            Step::Rapid(targets) => {
                let far = targets.iter().find(|(i, to)| *i == axis && outside(to.to_f64(), to.to_f64()));
                if let Some((_, to)) = far {
                    return Some(refuse(
                        format!("a rapid goes to {name} {}", to.to_f64() - zero),
                        located.span,
                    ));
                }
            }
            Step::Cut(cut) => match &cut.curve {
                Written::Lines(line) => {
                    let mut from = line.start[axis];
                    for point in line.units.chunks_exact(line.stride) {
                        let step = Decimal::new(point[axis] - from, digits).to_f64();
                        if 180.0 <= step.abs() {
                            let what =
                                format!("a line turns {name} by {step} degrees, which is no step below 180");
                            return Some(refuse(what, located.span));
                        }
                        from = point[axis];
                    }
                }
                // It turns no axis.
                Written::Arc(_) => {}
                curve @ (Written::Polynomial(_) | Written::Nurbs(_) | Written::Through(..)) => {
                    let mut reach = Reach::new();
                    reach.curve(decimals, curve);
                    let (low, high) = reach.0[axis];
                    if outside(low, high) {
                        let what =
                            format!("a spline runs from {name} {:.3} to {:.3}", low - zero, high - zero);
                        return Some(
                            refuse(what, located.span)
                                .hint(format!("set [axis.{name}] kind = \"linear\" if the axis counts on"))
                                .hint("lines can pass 360 degrees: --motion linear"),
                        );
                    }
                }
            },
            Step::Comment(_)
            | Step::Tool(_)
            | Step::Spindle(_)
            | Step::Coolant
            | Step::Home(_)
            | Step::Auxiliary(_) => {}
        }
    }
    None
}

/// The least and the greatest of every axis.
struct Reach([(f64, f64); MAX_AXES]);

impl Reach {
    fn new() -> Reach {
        Reach([(f64::INFINITY, f64::NEG_INFINITY); MAX_AXES])
    }

    fn take(&mut self, axis: usize, x: f64) {
        self.0[axis] = (self.0[axis].0.min(x), self.0[axis].1.max(x));
    }

    fn step(&mut self, decimals: &Decimals, step: &Step<Decimal, Written>) {
        match step {
            Step::Rapid(targets) => targets.iter().for_each(|(axis, to)| self.take(*axis, to.to_f64())),
            Step::Cut(cut) => self.curve(decimals, &cut.curve),
            Step::Comment(_)
            | Step::Tool(_)
            | Step::Spindle(_)
            | Step::Coolant
            | Step::Home(_)
            | Step::Shift(_)
            | Step::Auxiliary(_) => {}
        }
    }

    fn curve(&mut self, decimals: &Decimals, curve: &Written) {
        let axes = decimals.program.axes.count();
        let mut point = |units: &Units| {
            let position = decimals.position(units);
            for (axis, x) in position.iter().enumerate().take(axes) {
                self.take(axis, *x);
            }
        };
        match curve {
            Written::Lines(line) | Written::Through(_, line) => {
                let (mut low, mut high) = (line.start, line.start);
                for chunk in line.units.chunks_exact(line.stride) {
                    for (i, units) in chunk.iter().enumerate() {
                        low[i] = low[i].min(*units);
                        high[i] = high[i].max(*units);
                    }
                }
                point(&low);
                point(&high);
            }
            Written::Arc(arc) => {
                if let Some(arc) = to_arc(decimals, arc) {
                    let (low, high) = arc.range();
                    for axis in 0..axes {
                        self.take(axis, low[axis]);
                        self.take(axis, high[axis]);
                    }
                }
            }
            Written::Polynomial(_) | Written::Nurbs(_) => each_piece(decimals, curve, |piece| {
                for axis in 0..axes {
                    // A rational piece lies within its control points; a polynomial one is looked at more closely.
                    let (low, high) = if piece.is_polynomial() {
                        piece.numerator(axis).range(HALVINGS)
                    } else {
                        let all = piece.control_points().iter().map(|p| p[axis]);
                        all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
                            (low.min(x), high.max(x))
                        })
                    };
                    self.take(axis, low);
                    self.take(axis, high);
                }
            }),
        }
    }
}
