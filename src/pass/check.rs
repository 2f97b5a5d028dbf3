//! What is left fits the machine: the only place where a [`Legal`] program is made, and writers take nothing else.

use crate::diagnostic::{Diagnostic, Diagnostics, Warned};
use crate::geom::bezier::Bezier;
use crate::ir::{Decimals, Step, Units, Written};
use crate::machine::Machine;
use crate::pass::limits;
use crate::units::{Axis, DEGREES, Kind, MAX_AXES, Position};

/// A program in decimals that one machine takes.
#[derive(Clone, Debug, PartialEq)]
pub struct Legal(Decimals);

impl Legal {
    /// The program.
    pub fn decimals(&self) -> &Decimals {
        &self.0
    }
}

/// The greatest change of direction at which a control neither stops nor slows, degrees (Heidenhain's figure).
const SMOOTH_JOINT: f64 = 0.1;

/// The greatest coordinate, mm or degrees, of the narrowest control (Heidenhain: ±99 999.9999).
const GREATEST: f64 = 99_999.999_9;

/// Checks a program against a machine.
///
/// # Errors
/// The name is not one for this control; a coordinate is out of range; a rotary axis would wrap.
pub fn check(decimals: Decimals, machine: &Machine) -> Result<Warned<Legal>, Diagnostics> {
    let mut found = Diagnostics::new();
    if let Some(diagnostic) = name(&decimals.program.name, machine) {
        found.push(diagnostic);
    }
    let mut reach = Reach::new();
    let mut worst_joint = 0.0f64;
    let mut splines_move: Vec<Axis> = Vec::new();
    for located in &decimals.program.steps {
        match &located.step {
            Step::Rapid(targets) => {
                for (axis, to) in targets {
                    reach.take(*axis, to.to_f64());
                }
            }
            Step::Cut(cut) => {
                reach.curve(&decimals, &cut.curve);
                let moved: Vec<usize> = match &cut.curve {
                    Written::Lines(_) => Vec::new(),
                    Written::Polynomial(_) | Written::Nurbs(_) | Written::Through(..) => moving(&cut.curve),
                };
                for axis in moved {
                    let name = machine.axes.name(axis);
                    if !machine.spline.axes.contains(&name) && !splines_move.contains(&name) {
                        splines_move.push(name);
                    }
                }
                worst_joint = worst_joint.max(joint_angle(&decimals, &cut.curve));
            }
            Step::Comment(_) | Step::Tool(_) | Step::Spindle(_) => {}
        }
    }
    reach.report(&decimals, machine, &mut found);
    found.extend(limits::speeds(&decimals, machine));
    if !splines_move.is_empty() {
        let names: Vec<&str> = splines_move.iter().map(Axis::as_str).collect();
        let names = names.join(", ");
        found.push(
            Diagnostic::warning(
                "spline-axes",
                format!("the program moves {names} in spline blocks, which machine `{}` does not list", machine.name),
            )
            .hint("try it on the control first; a machine file with [spline] axes = [...] says that it is allowed"),
        );
    }
    if SMOOTH_JOINT < worst_joint {
        found.push(
            Diagnostic::warning("corner", format!("spline blocks meet at up to {worst_joint:.2} degrees"))
                .hint("above 0.1 degrees a control stops or slows down between blocks"),
        );
    }
    let warnings = found.into_result()?;
    Ok(Warned { value: Legal(decimals), warnings })
}

/// What is wrong with a program's name on this control.
pub fn name(name: &str, machine: &Machine) -> Option<Diagnostic> {
    let (rule, allowed) = machine.dialect.naming;
    (!allowed(name)).then(|| {
        Diagnostic::error("name-not-allowed", format!("`{name}` cannot be a program's name on this control"))
            .hint(format!("a name is {rule}"))
    })
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
            Written::Polynomial(polynomial) => {
                let mut start = polynomial.start;
                for block in &polynomial.blocks {
                    // The control points enclose the block.
                    for position in block.to_bezier(&decimals.digits, &start).control_points() {
                        for (axis, x) in position.iter().enumerate().take(axes) {
                            self.take(axis, *x);
                        }
                    }
                    start = block.end;
                }
            }
            Written::Nurbs(nurbs) => nurbs.points.iter().for_each(point),
        }
    }

    fn report(&self, decimals: &Decimals, machine: &Machine, found: &mut Diagnostics) {
        for (i, (axis, kind)) in decimals.program.axes.as_slice().iter().enumerate() {
            let (low, high) = self.0[i];
            if low < -GREATEST || GREATEST < high {
                let far = if low < -GREATEST { low } else { high };
                found.push(Diagnostic::error(
                    "position-range",
                    format!("{axis} goes to {far}, beyond ±99999.9999"),
                ));
            }
            let limits = machine.limits(*axis);
            let (least, most) =
                (limits.min.unwrap_or(f64::NEG_INFINITY), limits.max.unwrap_or(f64::INFINITY));
            if low < least || most < high {
                let message = format!(
                    "{axis} goes from {low:.4} to {high:.4}, beyond the {least} to {most} of machine `{}`",
                    machine.name
                );
                found.push(Diagnostic::refusal("axis-range", message));
            }
            if *kind == Kind::Rotary && (low < 0.0 || 360.0 < high) {
                let range = format!("{axis} runs from {low:.3} to {high:.3} degrees, outside 0 to 360");
                found.push(if limits.modulo {
                    Diagnostic::refusal("rotary-wraps", format!("{range}, and machine `{}` wraps there", machine.name))
                        .hint(format!("set [axis.{axis}] kind = \"linear\" if the axis counts on"))
                        .hint("or shift the flutes with `index`, so that each stays within 0 to 360")
                } else {
                    Diagnostic::warning("rotary-range", range).hint(format!(
                        "machine `{}` says [axis.{axis}] kind = \"linear\": it counts on and never takes the short way round",
                        machine.name
                    ))
                });
            }
        }
    }
}

/// The axes that a curve moves.
pub fn moving(curve: &Written) -> Vec<usize> {
    let differ = |start: &Units, points: &mut dyn Iterator<Item = &[i64]>| {
        let mut moved = [false; MAX_AXES];
        for point in points {
            for (i, units) in point.iter().enumerate() {
                moved[i] |= *units != start[i];
            }
        }
        moved
    };
    let moved = match curve {
        Written::Lines(line) | Written::Through(_, line) => {
            differ(&line.start, &mut line.units.chunks_exact(line.stride))
        }
        Written::Nurbs(nurbs) => {
            differ(&nurbs.points[0], &mut nurbs.points.iter().map(<[i64; MAX_AXES]>::as_slice))
        }
        Written::Polynomial(polynomial) => {
            let mut moved =
                differ(&polynomial.start, &mut polynomial.blocks.iter().map(|block| block.end.as_slice()));
            for block in &polynomial.blocks {
                for (moved, coefficients) in moved.iter_mut().zip(&block.coefficients) {
                    *moved |= coefficients.iter().any(|a| !a.is_zero());
                }
            }
            moved
        }
    };
    (0..MAX_AXES).filter(|i| moved[*i]).collect()
}

/// The greatest change of direction between polynomial blocks, degrees.
fn joint_angle(decimals: &Decimals, curve: &Written) -> f64 {
    let Written::Polynomial(polynomial) = curve else { return 0.0 };
    let direction = |from: &Position, to: &Position| -> Position { std::array::from_fn(|i| to[i] - from[i]) };
    let dot = |a: &Position, b: &Position| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let (mut worst, mut start, mut last) = (0.0f64, polynomial.start, None::<Bezier>);
    for block in &polynomial.blocks {
        let piece = block.to_bezier(&decimals.digits, &start);
        if let Some(last) = last {
            let before = direction(&last.points[last.degree - 1], &last.points[last.degree]);
            let after = direction(&piece.points[0], &piece.points[1]);
            let (a, b) = (dot(&before, &before).sqrt(), dot(&after, &after).sqrt());
            if 0.0 < a && 0.0 < b {
                // 2 asin(|u − v|/2) keeps small angles exact; atan of the half-angle's sine and cosine is the same.
                let between: Position = std::array::from_fn(|i| after[i] / b - before[i] / a);
                let half = 0.5 * dot(&between, &between).sqrt();
                let angle =
                    2.0 * crate::geom::elementary::atan(half / (1.0 - half * half).max(1.0e-300).sqrt());
                worst = worst.max(angle * DEGREES);
            }
        }
        last = Some(piece);
        start = block.end;
    }
    worst
}
