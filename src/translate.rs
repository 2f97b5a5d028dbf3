//! NC programs as inputs: what one machine's program does is asked of another machine.
//!
//! A reading is explicit and absolute already, so that little is left to do:
//!
//! | in the program | asked |
//! |---|---|
//! | lines, arcs | as they are: lines stay lines, unless they are to become splines |
//! | polynomial blocks, B-splines | the curves that their decimals mean |
//! | the control's own splines through points | the same points, for a control with the same spline |
//! | tools, spindle, coolant, stops, rapids, remarks | the same |
//! | work offsets that the text counts from | nothing: positions are those of the work's own zero |
//! | the lines and remarks round the program | nothing: they are the other machine's affair |
//! | a work offset of the program's own | the same, where the other machine's lines state it; refused elsewhere |
//! | words of how exactly the control runs: G61.1, G5 P2 | refused: another control has others |
//!
//! Axes that the program never moves are left out, X, Y and Z excepted. F is taken as the speed along the linear axes; where
//! the machine counts rotary axes in it, a program that turns one is refused. A program that leads the tool's tip has its lines
//! for it, so that nothing is added on the way to safe height and back.

mod planes;
mod stated;

use crate::decimal::Decimal;
use crate::diagnostic::{Diagnostic, Diagnostics, Warned};
use crate::dialect::Reading;
use crate::dialect::frame::with_named_axes;
use crate::geom::deviation::Bound;
use crate::ir::{
    ArcBy, Curve, Cut, Decimals, Intent, Located, Polyline, Program, Role, Step, Written, WrittenPoints,
};
use crate::machine::{Machine, RotaryFeed};
use crate::setup::own_remarks;
use crate::source::{SourceId, Span};
use crate::units::{Axes, Axis, Kind, MAX_AXES, Position};
use crate::verify::{to_arc, to_nurbs};

/// The machine as a program for it wants it: with the axes that its header names, and with a direction of the tool where it
/// leads the tip.
pub fn machine_of(text: &str, machine: &Machine) -> Machine {
    let machine = machine.clone().for_program(text);
    with_named_axes(text, &machine).unwrap_or(machine)
}

/// Whether a program is whole; what to know of one that is.
///
/// # Errors
/// It has no move, or no end.
pub fn is_whole(reading: &Reading, machine: &Machine) -> Result<Diagnostics, Diagnostics> {
    let mut warnings = Diagnostics::new();
    let steps = &reading.decimals.program.steps;
    if !reading.header {
        let message = format!("the program does not start with the lines of machine `{}`", machine.name);
        warnings.push(
            Diagnostic::warning("header-differs", message)
                .hint("what other lines set is not asked of the other machine"),
        );
    }
    let end = steps.last().map_or(Span::new(SourceId::INPUT, 0..0), |located| located.span);
    if !steps.iter().any(|located| matches!(located.step, Step::Rapid(_) | Step::Cut(_))) {
        return Err(Diagnostic::error("moves-missing", "the program has no move").at(end, "").into());
    }
    if !reading.footer {
        let message = format!("the program does not end with the lines of machine `{}`", machine.name);
        return Err(Diagnostic::error("footer-differs", message)
            .at(end, "the last that was read")
            .hint("it may have been cut off")
            .into());
    }
    Ok(warnings)
}

/// What a program for `machine` asks for.
///
/// # Errors
/// It has no move or no end, turns an axis at a feed that cannot be told, has a spline that is none, or an operator's
/// parameters.
pub fn intent(reading: Warned<Reading>, machine: &Machine) -> Result<Intent, Diagnostics> {
    let Warned { value: reading, mut warnings } = reading;
    let decimals = &reading.decimals;
    let steps = &decimals.program.steps;
    warnings.extend(is_whole(&reading, machine)?);
    stated::is_translated(&reading.stated)?;
    let own = decimals.program.axes;
    let moved = moved_axes(decimals);
    let space = |i: &usize| ["X", "Y", "Z"].contains(&own.name(*i).as_str());
    let kept: Vec<usize> = (0..own.count()).filter(|i| moved.contains(i) || space(i)).collect();
    let own: Vec<(Axis, Kind)> =
        kept.iter().map(|i| (decimals.program.axes.name(*i), decimals.program.axes.kind(*i))).collect();
    let Some(axes) = Axes::new(&own) else {
        return Err(Diagnostic::error("path-missing", "the program moves no axis").into());
    };
    let translation = Translation { decimals, machine, kept };
    let mut asked = Vec::with_capacity(steps.len());
    if let Some(first) = steps.first() {
        asked.extend(
            own_remarks(&decimals.setup)
                .iter()
                .map(|remark| Located { step: Step::Comment(remark.clone()), span: first.span }),
        );
    }
    for located in steps {
        if let Some(step) = translation.step(located)? {
            asked.push(Located { step, span: located.span });
        }
    }
    let Program { name, number, .. } = &decimals.program;
    let number = *number;
    let mut program = Program { name: name.clone(), number, axes, steps: asked };
    planes::count_back(&mut program, machine.orientation.plane_order)?;
    Ok(Intent {
        program,
        tolerance: None,
        name_span: None,
        radius: None,
        tilt_error: Bound::ZERO,
        input_error: 0.0,
        warnings,
    })
}

/// Which axes a program moves, in order; where it leads the tip of the tool, all of them.
pub fn moved_axes(decimals: &Decimals) -> Vec<usize> {
    let axes = decimals.program.axes;
    let mut used = [axes.direction().is_some(); MAX_AXES];
    for located in &decimals.program.steps {
        match &located.step {
            Step::Rapid(targets) => targets.iter().for_each(|(axis, _)| used[*axis] = true),
            Step::Cut(cut) => {
                let moves = moved(&cut.curve);
                (0..MAX_AXES).for_each(|i| used[i] |= moves[i]);
            }
            Step::Comment(_)
            | Step::Tool(_)
            | Step::Spindle(_)
            | Step::Coolant
            | Step::Home(_)
            | Step::Shift(_)
            | Step::Auxiliary(_) => {}
        }
    }
    (0..axes.count()).filter(|i| used[*i]).collect()
}

/// Which axes a path moves.
pub(crate) fn moved(written: &Written) -> [bool; MAX_AXES] {
    let mut moves = [false; MAX_AXES];
    let mut see = |start: &[i64; MAX_AXES], other: &[i64; MAX_AXES]| {
        (0..MAX_AXES).for_each(|i| moves[i] |= start[i] != other[i]);
    };
    match written {
        Written::Lines(line) | Written::Through(_, line) => {
            line.points().for_each(|point| {
                // Axes beyond the stride stay where they are.
                let mut whole = line.start;
                whole[..line.stride].copy_from_slice(&point[..line.stride]);
                see(&line.start, &whole);
            });
        }
        Written::Arc(arc) => {
            see(&arc.start, &arc.end);
            match arc.by {
                ArcBy::Way(way) => see(&arc.start, &way),
                ArcBy::Center(circle, _) | ArcBy::Turn(circle, _) => {
                    circle.plane.axes()[..2].iter().for_each(|i| moves[*i] = true);
                }
            }
        }
        Written::Polynomial(polynomial) => {
            polynomial.blocks.iter().for_each(|block| see(&polynomial.start, &block.end));
            for block in &polynomial.blocks {
                for (axis, coefficients) in block.coefficients.iter().enumerate() {
                    moves[axis] |= coefficients.iter().any(|a| !a.is_zero());
                }
            }
        }
        Written::Nurbs(nurbs) => nurbs.points.iter().for_each(|point| see(&nurbs.points[0], point)),
    }
    moves
}

struct Translation<'a> {
    decimals: &'a Decimals,
    machine: &'a Machine,
    /// The axes that are kept, in order.
    kept: Vec<usize>,
}

impl Translation<'_> {
    fn place(&self, position: &Position) -> Position {
        std::array::from_fn(|i| self.kept.get(i).map_or(0.0, |axis| position[*axis]))
    }

    /// The new index of an axis.
    fn index(&self, axis: usize) -> Option<usize> {
        self.kept.iter().position(|kept| *kept == axis)
    }

    fn step(&self, located: &Located<Decimal, Written>) -> Result<Option<Step<f64, Curve>>, Diagnostics> {
        Ok(Some(match &located.step {
            Step::Comment(text) => Step::Comment(text.clone()),
            Step::Tool(call) => Step::Tool(*call),
            Step::Spindle(rpm) => Step::Spindle(rpm.to_f64()),
            Step::Coolant => Step::Coolant,
            Step::Home(axis) => return Ok(self.index(*axis).map(Step::Home)),
            Step::Shift(shifts) => {
                if shifts.iter().any(|shift| shift.parameter) {
                    let message = "parameters that an operator may change have no place in another program";
                    return Err(Diagnostic::error("parameter-translated", message)
                        .at(located.span, "")
                        .into());
                }
                return Ok(None);
            }
            Step::Auxiliary(auxiliary) => {
                let number = |x: Decimal| Some(x.to_f64());
                return Ok(auxiliary.try_map(number, number).map(Step::Auxiliary));
            }
            Step::Rapid(targets) => {
                let targets = targets.iter().filter_map(|(axis, to)| Some((self.index(*axis)?, to.to_f64())));
                Step::Rapid(targets.collect())
            }
            Step::Cut(Cut { feed, curve, .. }) => {
                self.feed_is_told(curve, located.span)?;
                let timed = matches!(curve, Written::Lines(points) if !points.rates.is_empty());
                if feed.is_none() && !timed {
                    let message = "no F was stated before this cut";
                    return Err(Diagnostic::error("feed-missing", message).at(located.span, "").into());
                }
                let feed = feed.map(Decimal::to_f64);
                let (role, curve) = self.curve(curve, located.span)?;
                Step::Cut(Cut { feed, role, curve })
            }
        }))
    }

    /// Refuses a turning axis whose part in F is not known.
    fn feed_is_told(&self, curve: &Written, span: Span) -> Result<(), Diagnostics> {
        let axes = self.decimals.program.axes;
        let moves = moved(curve);
        let turns = (0..axes.count()).find(|i| moves[*i] && axes.kind(*i) == Kind::Rotary);
        match (turns, self.machine.rotary_feed) {
            (None, _) | (Some(_), RotaryFeed::Free) => Ok(()),
            (Some(axis), RotaryFeed::DegreesAsMm | RotaryFeed::Surface | RotaryFeed::InverseTime) => {
                let name = axes.name(axis);
                let message =
                    format!("F counts {name} here, and the other machine would count it another way");
                Err(Diagnostic::error("feed-counts-rotary", message)
                    .at(span, "")
                    .hint("compile the input that this program was made from")
                    .into())
            }
        }
    }

    fn curve(&self, written: &Written, span: Span) -> Result<(Role, Curve), Diagnostics> {
        let unsound = |message: String| Diagnostic::error("spline-unsound", message).at(span, "");
        Ok(match written {
            Written::Lines(points) => (Role::AsAsked, Curve::Lines(self.line(points))),
            Written::Through(kind, points) => (Role::Path, Curve::Through(*kind, self.line(points))),
            Written::Arc(arc) => {
                let found = to_arc(self.decimals, arc);
                let arc = found.ok_or_else(|| unsound("this arc has no radius".to_owned()))?;
                (Role::AsAsked, Curve::Arc(arc))
            }
            Written::Polynomial(polynomial) => {
                let mut start = polynomial.start;
                let piece = |block: &crate::ir::PolynomialBlock| {
                    let piece = block.to_bezier(&self.decimals.digits, &start);
                    start = block.end;
                    piece.mapped(|point| self.place(point))
                };
                (Role::Path, Curve::Polynomial(polynomial.blocks.iter().map(piece).collect()))
            }
            Written::Nurbs(nurbs) => {
                let spline = to_nurbs(self.decimals, nurbs).map_err(|error| unsound(error.to_string()))?;
                (Role::Path, Curve::Nurbs(spline.mapped(|point| self.place(point))))
            }
        })
    }

    fn line(&self, points: &WrittenPoints) -> Polyline {
        let mut line = Polyline::new(self.place(&self.decimals.position(&points.start)), self.kept.len());
        for point in points.points() {
            let mut whole = points.start;
            whole[..points.stride].copy_from_slice(&point[..points.stride]);
            line.push(&self.place(&self.decimals.position(&whole)));
        }
        line.lines.clone_from(&points.lines);
        line
    }
}

/// The warning where the other machine turns the tool between two directions in another way: the ends of blocks are the
/// same then, and what is between is not.
pub fn turns_otherwise(intent: &Intent, from: &Machine, to: &Machine) -> Diagnostics {
    let mut warnings = Diagnostics::new();
    if intent.program.axes.direction().is_some() && from.orientation.turn != to.orientation.turn {
        let message = format!(
            "machines `{}` and `{}` turn the tool between two directions in different ways: only the directions at the ends of straight blocks are the same",
            from.name, to.name
        );
        warnings.push(
            Diagnostic::warning("turn-differs", message)
                .hint("`diff` of both programs says how far they are apart; [orientation] turn says how a machine turns"),
        );
    }
    warnings
}

/// Reads the input as a program for `machine`, which becomes one for `to`.
///
/// # Errors
/// The machine cannot read it, or see [`intent`].
pub fn parse(
    sources: &crate::source::Sources,
    machine: &Machine,
    to: &Machine,
) -> Result<Intent, Diagnostics> {
    let text = sources.get(SourceId::INPUT).map_or("", |source| source.text.as_str());
    let machine = machine_of(text, machine);
    let reading = (machine.dialect.read)(text, SourceId::INPUT, &machine)?;
    stated::keeps_offset(&reading.value.stated, to)?;
    intent(reading, &machine)
}
