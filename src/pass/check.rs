//! What is left fits the machine: the only place where a [`Legal`] program is made, and writers take nothing else.

use crate::decimal::Decimal;
use crate::diagnostic::{Diagnostic, Diagnostics, Warned};
use crate::dialect::{ArcKind, ArcWord, Form};
use crate::geom::bezier::Bezier;
use crate::ir::{ArcBy, COEFFICIENTS, Circle, Decimals, PolynomialBlock, Step, ToolCall, Units, Written};
use crate::machine::Machine;
use crate::pass::{limits, range};
use crate::units::{Axes, Axis, DEGREES, MAX_AXES, Position};

/// A program in decimals that one machine takes.
#[derive(Clone, Debug, PartialEq)]
pub struct Legal(Decimals);

impl Legal {
    /// The program.
    pub fn decimals(&self) -> &Decimals {
        &self.0
    }
}

/// What is wrong with a tool whose length is that of another register than its own.
fn register(call: ToolCall, machine: &Machine) -> Option<Diagnostic> {
    if call.is_own() || machine.has_registers() {
        return None;
    }
    let message = format!(
        "{call}: the lines of machine `{}` take the length of tool {} alone",
        machine.name, call.number
    );
    Some(
        Diagnostic::refusal("tool-register", message)
            .hint("where the control has such registers, put {register} for the number into the lines of [program] that take the length: tool = [\"T{tool} M6\", \"G43 H{register}\"]")
            .hint("tool_register = \"left-out\" in a table for --words takes the tool's own length instead"),
    )
}

/// The greatest change of direction at which a control neither stops nor slows, degrees (Heidenhain's figure).
const SMOOTH_JOINT: f64 = 0.1;

/// Checks a program against a machine.
///
/// # Errors
/// The name is not one for this control; a curve has a form that the dialect has no word for; a
/// coordinate is out of range; a rotary axis would wrap.
pub fn check(decimals: Decimals, machine: &Machine) -> Result<Warned<Legal>, Diagnostics> {
    let mut found = Diagnostics::new();
    if let Some(diagnostic) = name(&decimals.program.name, machine) {
        found.push(diagnostic);
    }
    let mut worst_joint = 0.0f64;
    let mut coefficient_digits = 0;
    let mut splines_move: Vec<Axis> = Vec::new();
    for located in &decimals.program.steps {
        if let Step::Auxiliary(auxiliary) = &located.step
            && machine.frame.auxiliary(auxiliary).is_empty()
        {
            let message = format!("machine `{}` has no lines for {}", machine.name, auxiliary.key());
            found.push(
                Diagnostic::refusal("auxiliary-missing", message)
                    .at(located.span, "")
                    .hint(format!("state them in a machine file: [program] {} = [...]", auxiliary.key())),
            );
        }
        if let Step::Tool(call) = &located.step
            && let Some(diagnostic) = register(*call, machine)
        {
            found.push(diagnostic.at(located.span, ""));
        }
        let Some(cut) = located.step.cut() else { continue };
        match form(&decimals, &cut.curve, machine) {
            Ok(needed) => coefficient_digits = coefficient_digits.max(needed),
            Err(refused) => found.push(refused.at(located.span, "")),
        }
        let moved: Vec<usize> = match &cut.curve {
            Written::Lines(_) | Written::Arc(_) => Vec::new(),
            Written::Polynomial(_) | Written::Nurbs(_) | Written::Through(..) => moving(&cut.curve),
        };
        for axis in moved {
            let name = machine.axes.name(axis);
            if !machine.splines_move(name) && !splines_move.contains(&name) {
                splines_move.push(name);
            }
        }
        worst_joint = worst_joint.max(joint_angle(&decimals, &cut.curve));
    }
    found.extend(range::positions(&decimals, machine));
    found.extend(limits::check(&decimals, machine));
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
    if CLOSING_SIGNIFICANT < coefficient_digits {
        let message = format!(
            "a coefficient has {coefficient_digits} digits when it is written so that every block starts exactly where \
             the one before ended; the control keeps {CLOSING_SIGNIFICANT}"
        );
        found.push(Diagnostic::warning("coefficient-digits", message));
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

/// How many digits a control keeps of a coefficient of blocks that state their start through them (Heidenhain SPL).
const CLOSING_SIGNIFICANT: usize = 9;

/// How many axes such a block moves (Heidenhain SPL: two to five).
const CLOSING_AXES: usize = 5;

/// How many digits the closing coefficients of a curve have, or why the dialect cannot write it: none of its motions
/// has the form, or a block has no such coefficients.
fn form(decimals: &Decimals, curve: &Written, machine: &Machine) -> Result<usize, Diagnostic> {
    let dialect = machine.dialect;
    let (found, what) = match curve {
        Written::Lines(_) => (dialect.motion_of(Form::Lines), "straight lines"),
        Written::Arc(arc) => {
            let taken = match arc.by {
                ArcBy::Center(Circle { plane, .. }, turns) => {
                    let [.., w] = plane.axes();
                    let helix = arc.start[w] != arc.end[w];
                    (dialect.arcs.word)(ArcKind { plane: Some(plane), helix, turns: turns != 0 }, machine)
                        .is_some()
                }
                ArcBy::Way(_) => {
                    let flat = ArcKind { plane: None, helix: false, turns: false };
                    (dialect.arcs.word)(flat, machine) == Some(ArcWord::Way)
                }
                ArcBy::Turn(Circle { plane, .. }, _) => {
                    let helix = ArcKind { plane: Some(plane), helix: true, turns: true };
                    (dialect.arcs.word)(helix, machine) == Some(ArcWord::Turn)
                }
            };
            (dialect.motion_of(Form::Lines).filter(|_| taken), "arcs of this kind")
        }
        Written::Polynomial(_) => {
            let polynomial =
                dialect.motions.iter().find(|motion| matches!(motion.form, Form::Polynomial { .. }));
            (polynomial, "polynomial blocks")
        }
        Written::Nurbs(_) => (dialect.motion_of(Form::Nurbs), "B-splines"),
        Written::Through(kind, _) => {
            (dialect.motion_of(Form::Through(*kind)), "splines through points of this kind")
        }
    };
    let Some(motion) = found else {
        let message =
            format!("{} has no word for {what}; its motions are {}", dialect.name, dialect.motion_names());
        return Err(Diagnostic::error("form-not-in-dialect", message));
    };
    if let (Written::Polynomial(polynomial), Form::Polynomial { closing: false }) = (curve, motion.form) {
        let most = machine.spline.poly_words;
        let mut start = &polynomial.start;
        for block in &polynomial.blocks {
            let words = words(block, start, decimals.program.axes);
            if most < words {
                let message = format!(
                    "a polynomial block has {words} numbers, more than the {most} of the machine file"
                );
                return Err(Diagnostic::refusal("words-too-many", message)
                    .hint("[spline] poly_words says how many a block may have; --motion linear needs none"));
            }
            start = &block.end;
        }
    }
    let (Written::Polynomial(polynomial), Form::Polynomial { closing: true }) = (curve, motion.form) else {
        return Ok(0);
    };
    let mut digits = 0;
    let mut start = polynomial.start;
    for block in &polynomial.blocks {
        let mut moved = 0;
        for (i, start) in start.iter().enumerate().take(decimals.program.axes.count()) {
            let Some(k) = closing_coefficients(block, i, *start, decimals.digits[i]) else {
                let message = format!("{} writes cubics over a parameter of length 1 only", motion.name);
                return Err(Diagnostic::error("form-not-in-dialect", message));
            };
            digits = k.iter().fold(digits, |digits, k| digits.max(significant_digits(*k)));
            moved += usize::from(k.iter().any(|k| !k.is_zero()));
        }
        if CLOSING_AXES < moved {
            let message = format!("{} moves at most {CLOSING_AXES} axes at once", motion.name);
            return Err(Diagnostic::error("axes-too-many", message));
        }
        start = block.end;
    }
    Ok(digits)
}

/// How many numbers a polynomial block takes: the end and the coefficients of each axis that it moves, a second point's among
/// them, and those of its denominator. A direction is D = H - P, so that H takes the coefficients of both.
fn words(block: &PolynomialBlock, start: &Units, axes: Axes) -> usize {
    let used = |coefficients: &[Decimal; COEFFICIENTS]| {
        COEFFICIENTS - coefficients.iter().rev().take_while(|a| a.is_zero()).count()
    };
    let own = |i: usize| used(&block.coefficients[i]);
    let first = axes.direction();
    let turns = first.is_some_and(|first| (first..first + 3).any(|i| 0 < own(i) || block.end[i] != start[i]));
    let mut words = block.denominator.map_or(0, |denominator| 1 + used(&denominator.coefficients));
    for i in 0..axes.count() {
        let second = first.filter(|first| *first <= i);
        words += match second {
            Some(first) if turns => 1 + own(i).max(own(i - first)),
            Some(_) => 0,
            None if 0 < own(i) || block.end[i] != start[i] => 1 + own(i),
            None => 0,
        };
    }
    words
}

/// The digits of a number from the first that is not zero to the last.
fn significant_digits(value: Decimal) -> usize {
    // In units of its own last decimal every decimal is whole.
    let mut units = value.units(value.digits()).unwrap_or_default().unsigned_abs();
    while units != 0 && units.is_multiple_of(10) {
        units /= 10;
    }
    std::iter::successors(Some(units), |units| Some(units / 10)).take_while(|units| *units != 0).count()
}

/// K3, K2, K1 of one axis of a block that states its start through its coefficients: f = K3 t³ + K2 t² + K1 t + end, t
/// from 1 to 0.
///
/// ```text
/// K3 = −a₃          K2 = a₂ + 3a₃          K1 = start − end − K2 − K3
/// ```
///
/// None where the block is no cubic over a parameter of length 1, or where a number is too large to be held.
pub fn closing_coefficients(
    block: &PolynomialBlock,
    axis: usize,
    start: i64,
    digits: u8,
) -> Option<[Decimal; 3]> {
    let [a2, a3, a4, a5] = block.coefficients[axis];
    if block.denominator.is_some() || block.pl != Decimal::new(1, 0) || !a4.is_zero() || !a5.is_zero() {
        return None;
    }
    let k3 = a3.times(-1)?;
    let k2 = a3.times(3)?.plus(a2)?;
    let k1 =
        Decimal::new(start, digits).minus(Decimal::new(block.end[axis], digits))?.minus(k2)?.minus(k3)?;
    Some([k3, k2, k1])
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
        Written::Arc(arc) => {
            let mut moved = differ(&arc.start, &mut [arc.end.as_slice()].into_iter());
            match arc.by {
                ArcBy::Center(circle, _) | ArcBy::Turn(circle, _) => {
                    let [u, v, _] = circle.plane.axes();
                    (moved[u], moved[v]) = (true, true);
                }
                ArcBy::Way(way) => {
                    for i in 0..3 {
                        moved[i] |= way[i] != arc.start[i];
                    }
                }
            }
            moved
        }
        Written::Nurbs(nurbs) => {
            differ(&nurbs.points[0], &mut nurbs.points.iter().map(<[i64; MAX_AXES]>::as_slice))
        }
        Written::Polynomial(polynomial) => {
            let mut moved =
                differ(&polynomial.start, &mut polynomial.blocks.iter().map(|block| block.end.as_slice()));
            for block in &polynomial.blocks {
                for (i, (moved, coefficients)) in moved.iter_mut().zip(&block.coefficients).enumerate() {
                    *moved |= coefficients.iter().any(|a| !a.is_zero());
                    *moved |= block.denominator.is_some_and(|denominator| denominator.divides[i]);
                }
            }
            moved
        }
    };
    (0..MAX_AXES).filter(|i| moved[*i]).collect()
}

/// The greatest change of direction between the pieces of a spline, degrees; mm and degrees count alike, as the axes of
/// the control do.
fn joint_angle(decimals: &Decimals, curve: &Written) -> f64 {
    let direction = |from: &Position, to: &Position| -> Position { std::array::from_fn(|i| to[i] - from[i]) };
    let dot = |a: &Position, b: &Position| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let (mut worst, mut last) = (0.0f64, None::<Bezier>);
    if matches!(curve, Written::Lines(_) | Written::Arc(_) | Written::Through(..)) {
        return worst;
    }
    limits::each_piece(decimals, curve, |piece| {
        if let Some(last) = last {
            let before = direction(&last.points[last.degree - 1], &last.points[last.degree]);
            let after = direction(&piece.points[0], &piece.points[1]);
            let (a, b) = (dot(&before, &before).sqrt(), dot(&after, &after).sqrt());
            if 0.0 < a && 0.0 < b {
                // The angle between unit vectors u and v is 2 asin(|u − v|/2), exact for small ones.
                let between: Position = std::array::from_fn(|i| after[i] / b - before[i] / a);
                let half = 0.5 * dot(&between, &between).sqrt();
                let angle =
                    2.0 * crate::geom::elementary::atan(half / (1.0 - half * half).max(1.0e-300).sqrt());
                worst = worst.max(angle * DEGREES);
            }
        }
        last = Some(*piece);
    });
    worst
}
