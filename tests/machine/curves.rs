//! What spline and polynomial blocks must carry.

use super::state::Move;
use super::words::{Dialect, Motion};
use super::{Job, NOISE, Rule, Violation};
use std::collections::BTreeSet;

/// How far from the tool a Heidenhain control lets an SPL block start, mm and degrees: 1 µm by its manual.
const CLOSING: f64 = 0.001;

/// The rules of each block, then those of whole runs.
pub(super) fn check(job: &Job, moves: &[Move]) -> Vec<Violation> {
    let mut violations = Vec::new();
    for step in moves {
        match step.modal.motion {
            Some(Motion::Spl) => spl(step, &mut violations),
            Some(Motion::Poly) => upath(job, step, &mut violations),
            Some(Motion::Bspline | Motion::Through) if job.dialect == Dialect::Sinumerik => {
                upath(job, step, &mut violations);
                spline_path(step, &mut violations);
            }
            Some(Motion::Rapid | Motion::Line | Motion::Bspline | Motion::Through | Motion::Nurbs) | None => {
            }
        }
        modulo(job, step, &mut violations);
    }
    for run in runs(moves) {
        match run[0].modal.motion {
            Some(Motion::Bspline) => bspline(run, &mut violations),
            Some(Motion::Nurbs) => nurbs(run, &mut violations),
            Some(Motion::Rapid | Motion::Line | Motion::Poly | Motion::Through | Motion::Spl) | None => {}
        }
    }
    violations
}

/// Blocks of one motion; each spline word begins a run.
pub(super) fn runs(moves: &[Move]) -> impl Iterator<Item = &[Move]> {
    moves.chunk_by(|a, b| a.modal.motion == b.modal.motion && !b.opens)
}

/// A + K1 + K2 + K3 is where the tool is; two to five axes.
fn spl(step: &Move, violations: &mut Vec<Violation>) {
    let named: BTreeSet<char> =
        step.targets.keys().copied().chain(step.factors.keys().map(|(axis, _)| *axis)).collect();
    if !(2..=5).contains(&named.len()) {
        violations.push(step.violation(Rule::Spl, "SPL takes two to five axes"));
    }
    for axis in named {
        let factor = |power| step.factors.get(&(axis, power));
        let (Some(end), Some(k1), Some(k2), Some(k3)) =
            (step.targets.get(&axis), factor(1), factor(2), factor(3))
        else {
            violations.push(step.violation(Rule::Spl, format!("{axis} has not all of its end, K3, K2, K1")));
            continue;
        };
        // Where the tool is nobody knows, another rule speaks.
        let Some(from) = step.from.get(&axis) else { continue };
        let gap = (end + k1 + k2 + k3 - from).abs();
        if CLOSING < gap {
            violations.push(step.violation(Rule::Spl, format!("{axis} starts {gap:.6} from the tool")));
        }
    }
}

/// An axis outside FGROUP follows the parameter only under UPATH. Without, it follows the arc length, which is the
/// parameter only where the others are linear in it.
fn upath(job: &Job, step: &Move, violations: &mut Vec<Violation>) {
    let geometry = vec!['X', 'Y', 'Z'];
    let group = step.modal.group.as_ref().unwrap_or(&geometry);
    let bends = |axis: char| step.factors.keys().any(|(bent, _)| *bent == axis);
    let moves = |axis: char, to: &f64| {
        bends(axis) || step.from.get(&axis).is_none_or(|from| NOISE < (from - to).abs())
    };
    if !step.targets.iter().any(|(axis, to)| !group.contains(axis) && moves(*axis, to)) {
        return;
    }
    if job.upath && step.modal.upath != Some(true) {
        violations.push(step.violation(Rule::Upath, "UPATH is not in force"));
    }
    if !job.upath && group.iter().any(|axis| bends(*axis)) {
        violations
            .push(step.violation(Rule::Upath, "without UPATH the path must be straight in its parameter"));
    }
}

/// SPLINEPATH names every axis of the block; without one the spline group is X Y Z, the first three axes of the channel.
fn spline_path(step: &Move, violations: &mut Vec<Violation>) {
    let named = step.modal.spline_path.as_deref().unwrap_or(&['X', 'Y', 'Z']);
    let left: String = step.targets.keys().filter(|axis| !named.contains(axis)).collect();
    if !left.is_empty() {
        violations.push(step.violation(Rule::SplinePath, format!("SPLINEPATH does not name {left}")));
    }
}

/// PL is not modal: a block without leaves the knots to the control. Both ends of a clamped cubic have PL=0.
fn bspline(run: &[Move], violations: &mut Vec<Violation>) {
    for step in run {
        if !step.knot.is_some_and(|pl| 0.0 <= pl) {
            violations.push(step.violation(Rule::Pl, "a BSPLINE block has no PL, or one below 0"));
        }
        if step.modal.degree != Some(3.0) {
            violations.push(step.violation(Rule::Pl, "the degree is not 3"));
        }
    }
    for end in [&run[0], &run[run.len() - 1]] {
        if end.knot.is_some_and(|pl| pl != 0.0) {
            violations.push(end.violation(Rule::Pl, "the first and the last PL are 0"));
        }
    }
}

/// n+1 control points and n+1+order knots that never fall, both ends `order`-fold; the first point is where the tool is.
fn nurbs(run: &[Move], violations: &mut Vec<Violation>) {
    let first = &run[0];
    let mut wrong = |step: &Move, what: &str| violations.push(step.violation(Rule::Nurbs, what));
    if !first.opens {
        wrong(first, "a knot or control point follows no G06.2");
    }
    let mut knots = Vec::new();
    let mut closing = 0;
    for step in run {
        match step.knot {
            None => wrong(step, "a block has no K"),
            Some(knot) if knots.last().is_some_and(|before| knot < *before) => wrong(step, "K falls"),
            Some(knot) => knots.push(knot),
        }
        if step.targets.is_empty() {
            closing += 1;
        } else if 0 < closing {
            wrong(step, "a control point follows a K alone");
        } else if !step.targets.keys().eq(first.targets.keys()) {
            wrong(step, "a control point has not the axes of the first");
        }
    }
    let order = first.order.unwrap_or(4.0) as usize;
    let same = |knots: &[f64]| knots.iter().all(|knot| *knot == knots[0]);
    let last = &run[run.len() - 1];
    if closing != order {
        wrong(last, "the blocks with K alone are not as many as P");
    }
    // Where a K is missing or falls, that has been said.
    if knots.len() == run.len()
        && (knots.len() < 2 * order || !same(&knots[..order]) || !same(&knots[knots.len() - order..]))
    {
        wrong(last, "an end of the knots is not as manifold as P");
    }
    // Both are printed with the same decimals. Where the tool is nobody knows, another rule speaks.
    let away = |axis: &char, to: &f64| first.from.get(axis).is_some_and(|from| NOISE < (from - to).abs());
    if first.targets.iter().any(|(axis, to)| away(axis, to)) {
        wrong(first, "the first control point is not where the tool is");
    }
}

/// A spline block stays between 0 and 360 of a modulo axis, as the text counts it. A curve stays within the hull of its
/// control points, so that this is on the safe side; of a spline through points only the points are known.
fn modulo(job: &Job, step: &Move, violations: &mut Vec<Violation>) {
    if matches!(step.modal.motion, Some(Motion::Rapid | Motion::Line) | None) {
        return;
    }
    for axis in &job.modulo {
        let (Some(from), Some(to)) = (step.from.get(axis), step.targets.get(axis)) else { continue };
        let mut hull = vec![*from, *to];
        hull.extend(bernstein(&powers(step, *axis, *from, *to)));
        let (low, high) =
            hull.iter().fold((*from, *from), |(low, high), value| (low.min(*value), high.max(*value)));
        if low < -NOISE || 360.0 + NOISE < high {
            violations.push(step.violation(Rule::Modulo, format!("{axis} leaves 0 to 360")));
        }
    }
}

/// c0 + c1 u + c2 u² + … with u from 0 to 1, of a polynomial block; nothing of others.
pub(super) fn powers(step: &Move, axis: char, from: f64, to: f64) -> Vec<f64> {
    let factor = |power: usize| step.factors.get(&(axis, power)).copied().unwrap_or_default();
    match step.modal.motion {
        // A + K1 t + K2 t² + K3 t³ with t from 1 to 0.
        Some(Motion::Spl) => vec![to, factor(1), factor(2), factor(3)],
        // a0 + a1 p + … with p = u PL, a0 the start, and a1 from the end.
        Some(Motion::Poly) => {
            let pl = step.knot.unwrap_or(1.0);
            let mut scale = pl;
            let mut c = vec![from, 0.0];
            for power in 2..=5 {
                scale *= pl;
                c.push(factor(power) * scale);
            }
            c[1] = to - from - c[2..].iter().sum::<f64>();
            c
        }
        Some(Motion::Rapid | Motion::Line | Motion::Bspline | Motion::Through | Motion::Nurbs) | None => {
            Vec::new()
        }
    }
}

/// The control points bi = Σ C(i,j)/C(n,j) cj, j = 0 … i, of a polynomial of degree n.
fn bernstein(c: &[f64]) -> Vec<f64> {
    let n = c.len().saturating_sub(1);
    let choose =
        |n: usize, k: usize| (0..k).fold(1.0, |product, i| product * (n - i) as f64 / (i + 1) as f64);
    let point = |i: usize| (0..=i).map(|j| choose(i, j) / choose(n, j) * c[j]).sum();
    (0..c.len()).map(point).collect()
}
