//! B-splines as a control takes them: its degrees, its weights, its decimals.
//!
//! Knots and weights are free to be scaled: t → a t + b and w → c w leave the curve as it is. Both are scaled so that
//! rounding costs least, and knots are chosen on the control's decimals here, so that writing them rounds nothing.

use crate::decimal::{power_of_ten, round_units, units_to_f64};
use crate::dialect::NurbsRules;
use crate::geom::bezier::Bezier;
use crate::geom::nurbs::Nurbs;
use crate::machine::Machine;
use crate::units::{Axes, Kind, MAX_AXES};

/// Direction changes below this are none: a fit's joints agree to some 1e-12, and over spans of some metres the joint
/// of a double knot moves by no more than 1e-6 mm.
const SMOOTH: f64 = 1.0e-9;

/// The greatest knot that is written.
const GREATEST_KNOT: f64 = 90_000.0;

/// The least distance of two knots that is written, where they are not scaled.
const LEAST_SPAN: f64 = 1.0e-3;

/// How many scales are tried for the weights.
const SCALES: i64 = 4000;

/// The rules of the machine's dialect.
fn rules(machine: &Machine) -> Result<NurbsRules, String> {
    machine.dialect.nurbs.ok_or_else(|| format!("{} has no B-splines", machine.dialect.name))
}

/// A piece in homogeneous coordinates, (w P, w), its weights multiplied by `scale`.
fn lifted(piece: &Bezier, i: usize, scale: f64) -> [f64; MAX_AXES + 1] {
    let w = scale * piece.weights[i];
    let mut h = [w; MAX_AXES + 1];
    for axis in 0..MAX_AXES {
        h[axis] *= piece.points[i][axis];
    }
    h
}

/// One cubic B-spline through pieces, its knots in decimals.
///
/// Where two pieces meet in one direction the spans are made as long as their end derivatives, so that the derivative
/// is continuous and the joint needs a double knot only; at corners, and between lines, whose points are asked for as
/// they are, it is triple. Pieces that were read from decimals meet smoothly but for rounding: a control point that a₁,
/// a₂ and a₃ make is off by up to three half units of the last decimal, and so two units are allowed. Then every knot is taken out that the pieces can do without: a joint of a curve that is
/// smoother yet needs a single knot, one inside a single polynomial none. Only ratios of knots count: the
/// first span is as long as its path in mm, and everything is scaled up where a span would be shorter than 1. Knots
/// are then chosen on the control's decimals, and the knots that bring the spline to the least number of blocks are
/// inserted there, so that rounding moves none of them.
///
/// # Errors
/// The control cannot take it.
pub fn joined(
    pieces: Vec<Bezier>,
    may_be_smooth: bool,
    axes: &Axes,
    machine: &Machine,
) -> Result<Nurbs, String> {
    let rules = rules(machine)?;
    if pieces.iter().any(|piece| rules.degrees.1 < piece.degree) {
        return Err("pieces of degree 4 and 5 have no cubic form".to_owned());
    }
    let mut pieces: Vec<Bezier> = pieces.into_iter().map(|piece| piece.raised_to(3)).collect();
    let size = |d: &[f64; MAX_AXES + 1]| d.iter().map(|x| x * x).sum::<f64>().sqrt();
    let first = pieces.first().ok_or("there is no piece")?;
    let mut lengths = vec![path_length(first, axes).max(1.0)];
    let mut smooth = Vec::new();
    for i in 1..pieces.len() {
        let (before, after) = (pieces[i - 1], &mut pieces[i]);
        // Both have one weight at their joint.
        let scale = before.weights[3] / after.weights[0];
        for w in &mut after.weights[..4] {
            *w *= scale;
        }
        let end = [lifted(&before, 2, 1.0), lifted(&before, 3, 1.0)];
        let start = [lifted(after, 0, 1.0), lifted(after, 1, 1.0)];
        let leaves: [f64; MAX_AXES + 1] = std::array::from_fn(|c| start[1][c] - start[0][c]);
        let arrives: [f64; MAX_AXES + 1] = std::array::from_fn(|c| end[1][c] - end[0][c]);
        let (b, a) = (size(&arrives), size(&leaves));
        let turn: [f64; MAX_AXES + 1] = std::array::from_fn(|c| leaves[c] / a - arrives[c] / b);
        let last = lengths[lengths.len() - 1];
        if may_be_smooth
            && 0.0 < a
            && 0.0 < b
            && size(&turn) < SMOOTH.max(4.0 * resolution(machine) / a.min(b))
        {
            lengths.push(last * a / b);
            smooth.push(true);
        } else {
            lengths.push(path_length(after, axes).max(1.0));
            smooth.push(false);
        }
    }
    let shortest = lengths.iter().copied().fold(f64::INFINITY, f64::min);
    let scale = if shortest < 1.0 { 1.0 / shortest } else { 1.0 };
    let (mut t, mut last) = (0.0, 0.0);
    for length in &mut lengths {
        t += *length * scale;
        let knot = on_grid(t, machine).ok_or("the spline is too long for its knots")?;
        *length = knot - last;
        last = knot;
    }
    let mut spline = Nurbs::joined(&pieces, &lengths, &smooth).map_err(|error| error.to_string())?;
    if may_be_smooth {
        spline = spline.without_needless_knots(4.0 * resolution(machine));
    }
    finished(spline, rules, machine)
}

/// A B-spline in the degree, weights and knots that the control takes.
///
/// # Errors
/// The control cannot take it.
pub fn adapted(nurbs: Nurbs, machine: &Machine) -> Result<Nurbs, String> {
    let rules = rules(machine)?;
    let (least, most) = rules.degrees;
    let mut spline = nurbs;
    if most < spline.degree() {
        return Err(format!("its degree is {}; {most} is the most here", spline.degree()));
    }
    while spline.degree() < least {
        spline = spline.elevated().map_err(|error| error.to_string())?;
    }
    let knots = scaled_knots(spline.knots(), machine)?;
    let spline = Nurbs::new(spline.degree(), knots, spline.points().to_vec(), spline.weights().to_vec())
        .map_err(|error| format!("with {} decimals of its knots {error}", machine.digits.knot))?;
    finished(spline, rules, machine)
}

/// Knots from 0 on the control's decimals: as they are where they fit, otherwise as large as may be, by a power of ten.
fn scaled_knots(knots: &[f64], machine: &Machine) -> Result<Vec<f64>, String> {
    let (first, last) = (knots[0], knots[knots.len() - 1]);
    let total = last - first;
    let shortest = knots
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .filter(|span| 0.0 < *span)
        .fold(f64::INFINITY, f64::min);
    let fits = |t: &f64| {
        let own = t - first;
        // A decimal differs from its float by rounding only.
        on_grid(own, machine)
            .is_some_and(|grid| (grid - own).abs() <= 4.0 * f64::EPSILON * own.abs().max(1.0))
    };
    let mut scale = 1.0;
    if !(LEAST_SPAN <= shortest && total <= GREATEST_KNOT && knots.iter().all(fits)) {
        while total * scale * 10.0 <= GREATEST_KNOT {
            scale *= 10.0;
        }
        while GREATEST_KNOT < total * scale {
            scale /= 10.0;
        }
    }
    let mut scaled = Vec::with_capacity(knots.len());
    for (i, t) in knots.iter().enumerate() {
        let knot = on_grid((t - first) * scale, machine).ok_or("its knots are too large")?;
        // Two knots must not fall together.
        if 0 < i && knots[i - 1] < *t && scaled.last() == Some(&knot) {
            return Err(format!("its knots need more than {} decimals", machine.digits.knot));
        }
        scaled.push(knot);
    }
    Ok(scaled)
}

/// The spline with the fewest blocks at least, its weights scaled, and all knots decimals to the last bit.
fn finished(mut spline: Nurbs, rules: NurbsRules, machine: &Machine) -> Result<Nurbs, String> {
    while spline.points().len() <= machine.spline.bspline_min_blocks {
        let widest = spline.knots().windows(2).max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])));
        let middle = widest.and_then(|pair| {
            on_grid(0.5 * (pair[0] + pair[1]), machine)
                .filter(|middle| pair[0] < *middle && *middle < pair[1])
        });
        spline = spline.with_knot(middle.ok_or("the knots have too few decimals for so many blocks")?);
    }
    let weights = scaled_weights(&spline, rules, machine)?;
    // Sums of decimals are not decimals to the last bit; the grid makes them so.
    let knots: Option<Vec<f64>> = spline.knots().iter().map(|t| on_grid(*t, machine)).collect();
    let knots = knots.ok_or("the spline is too long for its knots")?;
    Nurbs::new(spline.degree(), knots, spline.points().to_vec(), weights).map_err(|error| error.to_string())
}

/// Weights scaled so that rounding costs least: the greatest relative error of any is the least of [`SCALES`] scales.
fn scaled_weights(spline: &Nurbs, rules: NurbsRules, machine: &Machine) -> Result<Vec<f64>, String> {
    let weights = spline.weights();
    if spline.is_polynomial() {
        return Ok(vec![1.0; weights.len()]);
    }
    let unit = 1.0 / power_of_ten(machine.digits.weight) as f64;
    let greatest = weights.iter().copied().fold(0.0, f64::max);
    let least = weights.iter().copied().fold(f64::INFINITY, f64::min);
    let cost = |scale: f64| {
        weights.iter().fold(0.0, |most, w| {
            let rounded = round_units(w * scale, machine.digits.weight);
            let units = rounded.map_or(0.0, |units| units as f64 * unit);
            f64::max(most, (units / (w * scale) - 1.0).abs())
        })
    };
    let scale = if rules.starts_with_one {
        1.0 / weights[0]
    } else {
        let most = (rules.greatest_weight / unit) as i64;
        let largest = (0..SCALES).map(|k| (most - k) as f64 * unit / greatest);
        let candidates = [1.0, 1.0 / greatest].into_iter().chain(largest);
        let allowed = candidates.filter(|scale| greatest * scale <= rules.greatest_weight + 0.5 * unit);
        // The first of equals: as they are, where that costs nothing.
        allowed.fold((f64::INFINITY, 1.0), |best, s| if cost(s) < best.0 { (cost(s), s) } else { best }).1
    };
    if rules.greatest_weight + 0.5 * unit < greatest * scale || least * scale < 10.0 * unit {
        return Err(format!(
            "its weights go from {:.3e} to {:.3e}; here they are at least {:.0e} and at most {}",
            least * scale,
            greatest * scale,
            10.0 * unit,
            rules.greatest_weight
        ));
    }
    Ok(weights.iter().map(|w| w * scale).collect())
}

fn on_grid(t: f64, machine: &Machine) -> Option<f64> {
    let digits = machine.digits.knot;
    round_units(t, digits).map(|units| units_to_f64(units, digits))
}

/// Half a unit of the axes' last decimal: what rounding makes of a control point.
fn resolution(machine: &Machine) -> f64 {
    let digits = machine.axis_digits();
    let least = digits[..machine.axes.count()].iter().copied().min().unwrap_or(0);
    0.5 / power_of_ten(least) as f64
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
