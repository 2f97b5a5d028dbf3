//! Every path takes the form of the motion that was chosen, exactly: basis change, degree elevation, knot insertion.

use crate::decimal::{round_units, units_to_f64};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::dialect::Form;
use crate::geom::bezier::Bezier;
use crate::geom::nurbs::Nurbs;
use crate::ir::{Curve, Cut, Located, Polyline, Program, Role, Step};
use crate::machine::Machine;
use crate::units::{Axes, Kind, Position};

/// Direction changes below this are none: a fit's joints agree to some 1e-12, and over spans of some metres the joint
/// of a double knot moves by no more than 1e-6 mm.
const SMOOTH: f64 = 1.0e-9;

/// The program with every path in `form`. Approaches stay lines.
///
/// # Errors
/// A curve cannot take the form.
pub fn convert(
    program: Program<f64, Curve>,
    form: Form,
    machine: &Machine,
) -> Result<Program<f64, Curve>, Diagnostics> {
    let axes = program.axes;
    let mut steps = Vec::with_capacity(program.steps.len());
    for Located { step, span } in program.steps {
        let step = match step {
            Step::Cut(Cut { feed, role: Role::Path, curve }) => {
                let curve = to_form(curve, form, &axes, machine)
                    .map_err(|message| Diagnostic::refusal("form-out-of-reach", message).at(span, ""))?;
                Step::Cut(Cut { feed, role: Role::Path, curve })
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

fn to_form(curve: Curve, form: Form, axes: &Axes, machine: &Machine) -> Result<Curve, String> {
    match (curve, form) {
        (curve @ Curve::Lines(_), Form::Lines) | (curve @ Curve::Arc(_), _) => Ok(curve),
        (curve @ Curve::Polynomial(_), Form::Polynomial { .. }) => Ok(curve),
        (Curve::Through(_, line), Form::Through(kind)) | (Curve::Lines(line), Form::Through(kind)) => {
            Ok(Curve::Through(kind, line))
        }
        (Curve::Lines(line), Form::Polynomial { .. }) => Ok(Curve::Polynomial(segments(&line))),
        (Curve::Lines(line), Form::Nurbs) => spline(segments(&line), false, axes, machine).map(Curve::Nurbs),
        (Curve::Polynomial(pieces), Form::Nurbs) => spline(pieces, true, axes, machine).map(Curve::Nurbs),
        (Curve::Nurbs(nurbs), Form::Nurbs) => Ok(Curve::Nurbs(nurbs)),
        (Curve::Nurbs(nurbs), Form::Polynomial { .. }) if nurbs.is_polynomial() => {
            Ok(Curve::Polynomial(nurbs.beziers().map(|(piece, _)| piece).collect()))
        }
        (Curve::Polynomial(_) | Curve::Nurbs(_) | Curve::Through(..) | Curve::Logarithmic(_), _) => {
            Err("this curve has no exact form as the motion that was asked for".to_owned())
        }
    }
}

/// Each segment as a straight piece.
fn segments(line: &Polyline) -> Vec<Bezier> {
    let mut from = line.start;
    line.points()
        .map(|to| {
            let piece = Bezier::line(from, to);
            from = to;
            piece
        })
        .collect()
}

/// One cubic B-spline through pieces, its knots in decimals.
///
/// Where two pieces meet in one direction the spans are made as long as their end derivatives, so that the derivative
/// is continuous and the joint needs a double knot only; at corners, and between lines, whose points are asked for as
/// they are, it is triple. Only ratios of knots count: the
/// first span is as long as its path in mm, and everything is scaled up where a span would be shorter than 1. Knots
/// are then chosen on the control's decimals, and the knots that bring the spline to the least number of blocks are
/// inserted there, so that rounding moves none of them.
fn spline(pieces: Vec<Bezier>, may_be_smooth: bool, axes: &Axes, machine: &Machine) -> Result<Nurbs, String> {
    if pieces.iter().any(|piece| 3 < piece.degree) {
        return Err("pieces of degree 4 and 5 have no cubic form".to_owned());
    }
    let pieces: Vec<Bezier> = pieces.into_iter().map(|piece| piece.raised_to(3)).collect();
    let difference = |p: &Position, q: &Position| -> Position { std::array::from_fn(|i| q[i] - p[i]) };
    let size = |d: &Position| d.iter().map(|x| x * x).sum::<f64>().sqrt();
    let first = pieces.first().ok_or("there is no piece")?;
    let mut lengths = vec![path_length(first, axes).max(1.0)];
    let mut smooth = Vec::new();
    for pair in pieces.windows(2) {
        let before = difference(&pair[0].points[2], &pair[0].points[3]);
        let after = difference(&pair[1].points[0], &pair[1].points[1]);
        let (b, a) = (size(&before), size(&after));
        let turn: Position = std::array::from_fn(|i| after[i] / a - before[i] / b);
        let last = lengths[lengths.len() - 1];
        if may_be_smooth && 0.0 < a && 0.0 < b && size(&turn) < SMOOTH {
            lengths.push(last * a / b);
            smooth.push(true);
        } else {
            lengths.push(path_length(&pair[1], axes).max(1.0));
            smooth.push(false);
        }
    }
    let shortest = lengths.iter().copied().fold(f64::INFINITY, f64::min);
    let scale = if shortest < 1.0 { 1.0 / shortest } else { 1.0 };
    let digits = machine.digits.knot;
    let on_grid = |t: f64| round_units(t, digits).map(|units| units_to_f64(units, digits));
    let (mut t, mut last) = (0.0, 0.0);
    for length in &mut lengths {
        t += *length * scale;
        let knot = on_grid(t).ok_or("the spline is too long for its knots")?;
        *length = knot - last;
        last = knot;
    }
    let mut spline = Nurbs::joined(&pieces, &lengths, &smooth).map_err(|error| error.to_string())?;
    while spline.points().len() <= machine.spline.bspline_min_blocks {
        let widest = spline.knots().windows(2).max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])));
        let middle = widest.and_then(|pair| {
            on_grid(0.5 * (pair[0] + pair[1])).filter(|middle| pair[0] < *middle && *middle < pair[1])
        });
        spline = spline.with_knot(middle.ok_or("the knots have too few decimals for so many blocks")?);
    }
    // Sums of decimals are not decimals to the last bit; the grid makes them so.
    let knots: Option<Vec<f64>> = spline.knots().iter().map(|t| on_grid(*t)).collect();
    Nurbs::new(
        3,
        knots.ok_or("the spline is too long for its knots")?,
        spline.points().to_vec(),
        spline.weights().to_vec(),
    )
    .map_err(|error| error.to_string())
}

/// About the length of the linear axes' path, mm: that of the control polygon.
fn path_length(piece: &Bezier, axes: &Axes) -> f64 {
    let linear: Vec<usize> = (0..axes.count()).filter(|i| axes.kind(*i) == Kind::Linear).collect();
    piece
        .control_points()
        .windows(2)
        .map(|pair| {
            linear
                .iter()
                .map(|i| (pair[1][*i] - pair[0][*i]) * (pair[1][*i] - pair[0][*i]))
                .sum::<f64>()
                .sqrt()
        })
        .sum()
}
