//! Every path takes the form of the motion that was chosen, exactly: basis change, degree elevation, knot insertion.
//!
//! | from | to polynomial blocks | to a B-spline |
//! |---|---|---|
//! | lines | a straight block each | straight spans, triple knots |
//! | pieces | as they are | one spline, with as few knots as their joints allow ([`spline::joined`]) |
//! | B-spline | a block a span (Bezier extraction) | itself, its degree raised where the control wants that ([`spline::adapted`]) |
//!
//! What has no exact form was fitted before, straight from the intent ([`approximate`](super::approximate)).

pub mod spline;

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::dialect::Form;
use crate::ir::{Curve, Cut, Located, Passed, Program, Step};
use crate::machine::Machine;
use crate::units::Axes;
use std::borrow::Cow;

/// The program with every path in `form`. Approaches stay lines, and where the motion was not `asked` for so do paths of
/// lines.
///
/// # Errors
/// A curve cannot take the form.
pub fn convert<'c>(
    program: Passed<'c>,
    form: Form,
    machine: &Machine,
    asked: bool,
) -> Result<Passed<'c>, Diagnostics> {
    let axes = program.axes;
    let mut steps = Vec::with_capacity(program.steps.len());
    for Located { step, span } in program.steps {
        let step = match step {
            Step::Cut(cut) if cut.takes_motion() && !stays(&cut.curve, form, asked) => {
                let Cut { feed, role, curve } = cut;
                let curve = to_form(curve.into_owned(), form, &axes, machine)
                    .map_err(|message| Diagnostic::refusal("form-out-of-reach", message).at(span, ""))?;
                Step::Cut(Cut { feed, role, curve: Cow::Owned(curve) })
            }
            step @ (Step::Comment(_)
            | Step::Tool(_)
            | Step::Spindle(_)
            | Step::Coolant
            | Step::Home(_)
            | Step::Shift(_)
            | Step::Auxiliary(_)
            | Step::Rapid(_)
            | Step::Cut(_)) => step,
        };
        steps.push(Located { step, span });
    }
    Ok(Program { steps, ..program })
}

/// Whether a curve has the form already, or is to stay lines.
fn stays(curve: &Curve, form: Form, asked: bool) -> bool {
    match (curve, form) {
        (Curve::Lines(_), form) => !asked || form == Form::Lines,
        (Curve::Arc(_), _) | (Curve::Polynomial(_), Form::Polynomial { .. }) => true,
        (
            Curve::Polynomial(_)
            | Curve::Nurbs(_)
            | Curve::Through(..)
            | Curve::Logarithmic(_)
            | Curve::Formula(_),
            _,
        ) => false,
    }
}

fn to_form(curve: Curve, form: Form, axes: &Axes, machine: &Machine) -> Result<Curve, String> {
    match (curve, form) {
        (Curve::Through(_, line), Form::Through(kind)) | (Curve::Lines(line), Form::Through(kind)) => {
            Ok(Curve::Through(kind, line))
        }
        (curve @ Curve::Lines(_), Form::Polynomial { .. }) => Ok(Curve::Polynomial(curve.pieces())),
        (curve @ Curve::Lines(_), Form::Nurbs) => {
            spline::joined(curve.pieces(), false, axes, machine).map(Curve::Nurbs)
        }
        (Curve::Polynomial(pieces), Form::Nurbs) => {
            spline::joined(pieces, true, axes, machine).map(Curve::Nurbs)
        }
        (Curve::Nurbs(nurbs), Form::Nurbs) => spline::adapted(nurbs, machine).map(Curve::Nurbs),
        (curve @ Curve::Nurbs(_), Form::Polynomial { .. }) => Ok(Curve::Polynomial(curve.pieces())),
        (
            Curve::Lines(_)
            | Curve::Arc(_)
            | Curve::Polynomial(_)
            | Curve::Nurbs(_)
            | Curve::Through(..)
            | Curve::Logarithmic(_)
            | Curve::Formula(_),
            _,
        ) => Err("this curve has no exact form as the motion that was asked for".to_owned()),
    }
}
