//! Few cubics, or few lines, within a tolerance of any curve.
//!
//! All coordinates are fitted together, so that the fit may run along the curve at its own pace. A cubic takes ends and
//! tangents of the curve, and its two tangent lengths are spent where the greatest error is least: through the curve at
//! p = (1 ± c)/2 with c = 0.32541 (see [`fit`](super::fit)), which gives an error h⁶ in the plane. In space two lengths
//! cannot meet both normal directions at two places; there they are taken by least squares.
//!
//! Pieces are made as long as the tolerance allows, from one corner of the curve to the next; what the last one leaves over
//! is shared among all. Then fewer are tried with joints beside the curve (`relax`). How near is measured at places here, and
//! proved on the text that is read back.

use super::bezier::Bezier;
use super::chain::{Chain, Window, distance};
use super::fit::{FitError, MAX_PIECES};
use super::relax;
use crate::units::Position;

/// Root of c² = 4(1 − c²)³/27.
const C: f64 = 0.325_411_344_339_772_1;

/// Where the distance of a cubic is measured: in the plane the error has its extremes near p = ½ and (1 ± 0.635)/2, in
/// space anywhere.
const MEASURED: [f64; 21] = [
    0.04, 0.08, 0.12, 0.15, 0.18, 0.21, 0.25, 0.3, 0.36, 0.43, 0.5, 0.57, 0.64, 0.7, 0.75, 0.79, 0.82, 0.85,
    0.88, 0.92, 0.96,
];

/// Places between measured ones may be farther off; this share of the tolerance is aimed at.
const AIM: f64 = 0.97;

/// What is proved is not farther off between places; what is left of the tolerance here is for the rounding of its numbers.
const PROVED: f64 = 0.985;

/// A piece shorter than this share of the curve's parameter is not tried.
const SHORTEST: f64 = 1.0e-9;

/// Tangents across the curve by less than this, squared sines, are straight ahead: 1e-6 of the length.
const STRAIGHT: f64 = 1.0e-12;

/// Of a piece this many times farther off than the tolerance a better one is sought.
const REACH: f64 = 6.0;

/// The least change of a tangent length that is tried, of the curve's length.
const LEAST_STEP: f64 = 5.0e-4;

/// So many cubics at once are tried with one fewer: enough for one in twenty to be gained, and the time stays in proportion.
const RUN: usize = 24;

/// A piece that is shorter than this share of the curve leaves some of it out.
const SHORT: f64 = 0.9;

fn dot(a: &Position, b: &Position) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Cubics nowhere farther than about `tolerance` from the curve, one tangent at each joint, with its corners.
///
/// # Errors
/// The tolerance is out of reach.
pub fn cubics(chain: &Chain, tolerance: f64) -> Result<Vec<Bezier>, FitError> {
    let fit = |from: f64, to: f64| cubic(chain, from, to, AIM * tolerance);
    let mut pieces = Vec::new();
    let mut from = 0.0;
    for corner in chain.corners() {
        // A straight piece needs no fit.
        if let Some(line) = chain.line(from, corner) {
            pieces.push(line);
            from = corner;
            continue;
        }
        let fitted = levelled(from, corner, AIM * tolerance, 6.0, &fit).ok_or(FitError { tolerance })?;
        for run in fitted.chunks(RUN) {
            let ends: Vec<f64> = [from].into_iter().chain(run.iter().map(|(end, _)| *end)).collect();
            from = ends[run.len()];
            match relax::fewer(chain, &ends, PROVED * tolerance) {
                Some(fewer) => pieces.extend(fewer),
                None => pieces.extend(run.iter().map(|(_, piece)| *piece)),
            }
        }
    }
    Ok(pieces)
}

/// The points after the first of lines nowhere farther than about `tolerance` from the curve, ends on it.
///
/// # Errors
/// The tolerance is out of reach.
pub fn chords(chain: &Chain, tolerance: f64) -> Result<Vec<Position>, FitError> {
    chords_with(chain, tolerance, |_| 0.0)
}

/// The same where a control leaves a chord by so many mm `more`.
///
/// # Errors
/// As above.
pub fn chords_with(
    chain: &Chain,
    tolerance: f64,
    more: impl Fn(&Bezier) -> f64,
) -> Result<Vec<Position>, FitError> {
    let chord = |from: f64, to: f64| {
        let line = Bezier::line(chain.eval(from), chain.eval(to));
        let window = Window::new(chain, from, to);
        // The curve's own places are measured too: a chord may pass by a bulge that it does not point at.
        (window.off_line(&line) + more(&line), line)
    };
    let mut points = Vec::new();
    let mut from = 0.0;
    for corner in chain.corners() {
        let lines = levelled(from, corner, AIM * tolerance, 2.0, &chord).ok_or(FitError { tolerance })?;
        points.extend(lines.iter().map(|(_, line)| line.end()));
        from = corner;
    }
    Ok(points)
}

/// Pieces between two corners with their ends, as few as are found and about equally good.
///
/// Pieces as long as may be from the start leave a short one at the end. With joints b_i made from the start and r_i made
/// from the end, every joint may lie between both; b_i + (r_i − b_i) i/n shares what is left over among all.
fn levelled(
    from: f64,
    to: f64,
    tolerance: f64,
    order: f64,
    fit: &impl Fn(f64, f64) -> (f64, Bezier),
) -> Option<Vec<(f64, Bezier)>> {
    let forward = greedy(from, to, tolerance, order, fit)?;
    let n = forward.len();
    if n == 1 {
        return Some(forward);
    }
    let mirrored = |a: f64, b: f64| fit(from + (to - b), from + (to - a));
    let backward = greedy(from, to, tolerance, order, &mirrored).filter(|ends| ends.len() == n);
    let Some(backward) = backward else { return Some(forward) };
    let mut level = Vec::with_capacity(n);
    let mut at = from;
    for i in 1..=n {
        let (ahead, behind) =
            (forward[i - 1].0, if i < n { from + (to - backward[n - i - 1].0) } else { to });
        let end = if i < n { ahead + (behind - ahead) * i as f64 / n as f64 } else { to };
        if !(at < end) {
            return Some(forward);
        }
        let (error, piece) = fit(at, end);
        if tolerance < error {
            return Some(forward);
        }
        level.push((end, piece));
        at = end;
    }
    Some(level)
}

/// Each piece as long as the tolerance allows, with its end.
fn greedy(
    from: f64,
    to: f64,
    tolerance: f64,
    order: f64,
    fit: &impl Fn(f64, f64) -> (f64, Bezier),
) -> Option<Vec<(f64, Bezier)>> {
    let mut pieces = Vec::new();
    let mut at = from;
    let mut step = to - from;
    while at < to {
        if MAX_PIECES <= pieces.len() {
            return None;
        }
        let (end, _, piece) = longest(at, to, step, tolerance, order, fit)?;
        pieces.push((end, piece));
        step = 1.2 * (end - at);
        at = end;
    }
    Some(pieces)
}

/// The longest piece from `at` found by the rate at which errors grow, tried first with `step`.
fn longest(
    at: f64,
    to: f64,
    step: f64,
    tolerance: f64,
    order: f64,
    fit: &impl Fn(f64, f64) -> (f64, Bezier),
) -> Option<(f64, f64, Bezier)> {
    let mut best: Option<(f64, f64, Bezier)> = None;
    // No end from here on is good enough.
    let mut refused = f64::INFINITY;
    let mut h = step.min(to - at);
    for _ in 0..40 {
        let end = if to - at <= h * (1.0 + 1.0e-12) { to } else { at + h };
        let (error, piece) = fit(at, end);
        let held = error <= tolerance;
        if held {
            if best.is_none_or(|(known, ..)| known < end) {
                best = Some((end, error, piece));
            }
            if end == to {
                return best;
            }
        } else {
            refused = refused.min(end);
        }
        let low = best.map_or(at, |(known, ..)| known);
        if refused - low <= 2.0e-3 * (refused - at) && best.is_some() {
            return best;
        }
        let ratio = (tolerance / error.max(1.0e-30)).clamp(1.0e-12, 1.0e12);
        let growth = root(ratio, order).clamp(0.1, 4.0);
        h = (end - at) * if held { 1.001 * growth } else { 0.995 * growth };
        // Between what holds and what does not.
        let (least, greatest) = (low - at, refused.min(to) - at);
        if h <= least || greatest <= h {
            h = if refused < f64::INFINITY { 0.5 * (least + greatest) } else { greatest };
        }
        if h <= SHORTEST * to.max(1.0) {
            break;
        }
    }
    best
}

/// x^(1/order) for orders 2 and 6.
fn root(x: f64, order: f64) -> f64 {
    let square = x.sqrt();
    if order < 3.0 { square } else { super::elementary::cbrt(square) }
}

/// The cubic between two places with the curve's tangents, and its greatest measured distance.
fn cubic(chain: &Chain, from: f64, to: f64, tolerance: f64) -> (f64, Bezier) {
    let window = Window::new(chain, from, to);
    let (p0, p3) = (chain.eval(from), chain.eval(to));
    let (t0, t1) = (chain.tangent_behind(from), chain.tangent_before(to));
    let length = window.length();
    let make = |a: f64, b: f64| {
        let p1 = std::array::from_fn(|i| p0[i] + a * t0[i]);
        let p2 = std::array::from_fn(|i| p3[i] - b * t1[i]);
        Bezier::new(&[p0, p1, p2, p3])
    };
    let mut best = (f64::INFINITY, length / 3.0, length / 3.0);
    // At u = v = h/3 the equations are singular to leading order, so that lopsided starts are tried too; very lopsided
    // ones for cusps, where one length vanishes.
    for lopsided in [0.0, 0.12, -0.12, 0.85, -0.85] {
        let (a, b) = lengths(&window, length, &make, (t0, t1), lopsided);
        let error = measured(&window, &make(a, b), best.0);
        if error < best.0 {
            best = (error, a, b);
        }
    }
    // Through two places is best for short pieces. Where a long one nearly holds, the least greatest distance is sought.
    if tolerance < best.0 && best.0 < REACH * tolerance {
        let mut step = 0.08 * length;
        while tolerance < best.0 && LEAST_STEP * length < step {
            let around = [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (1.0, -1.0), (-1.0, 1.0)];
            let better = around.into_iter().find_map(|(x, y)| {
                let (a, b) = (best.1 + step * x, best.2 + step * y);
                let error =
                    if 0.0 < a.min(b) { measured(&window, &make(a, b), best.0) } else { f64::INFINITY };
                (error < best.0).then_some((error, a, b))
            });
            match better {
                Some(next) => best = next,
                None => step *= 0.5,
            }
        }
    }
    (best.0, make(best.1, best.2))
}

/// The greatest distance of a piece from the curve at [`MEASURED`]; no more is looked at once it exceeds `most`. A piece
/// that is much shorter than the curve does not run along all of it.
fn measured(window: &Window<'_>, piece: &Bezier, most: f64) -> f64 {
    let mut error = 0.0f64;
    // The extremes are likely where the error of a short piece has them.
    for p in [0.5, 0.18, 0.82].into_iter().chain(MEASURED) {
        error = error.max(off(window, piece, p));
        if most <= error {
            return f64::INFINITY;
        }
    }
    let mut last = piece.start();
    let length: f64 = MEASURED
        .iter()
        .map(|p| distance(&std::mem::replace(&mut last, piece.eval(*p)), &piece.eval(*p)))
        .sum();
    if length + distance(&last, &piece.end()) < SHORT * window.length() { f64::INFINITY } else { error }
}

/// The distance of a place of a piece from the curve.
fn off(window: &Window<'_>, piece: &Bezier, p: f64) -> f64 {
    let point = piece.eval(p);
    distance(&point, &window.nearest(&point, p).0)
}

/// The tangent lengths that lead through the curve at p = (1 ± c)/2, by the Levenberg–Marquardt method.
fn lengths(
    window: &Window<'_>,
    length: f64,
    make: &impl Fn(f64, f64) -> Bezier,
    (t0, t1): (Position, Position),
    lopsided: f64,
) -> (f64, f64) {
    let places = [0.5 * (1.0 - C), 0.5 * (1.0 + C)];
    // Residuals normal to the curve, and their change with both lengths: sums for the normal equations.
    let normal = |a: f64, b: f64| {
        let piece = make(a, b);
        let (mut jj, mut jr, mut rr) = ([0.0; 3], [0.0; 2], 0.0);
        for p in places {
            let q = 1.0 - p;
            let point = piece.eval(p);
            let (near, along) = window.nearest(&point, p);
            let speed = dot(&along, &along);
            let across = |v: &Position| -> Position {
                let share = if 0.0 < speed { dot(v, &along) / speed } else { 0.0 };
                std::array::from_fn(|i| v[i] - share * along[i])
            };
            let r = across(&std::array::from_fn(|i| point[i] - near[i]));
            let ja = across(&t0.map(|x| 3.0 * p * q * q * x));
            let jb = across(&t1.map(|x| -3.0 * p * p * q * x));
            jj = [jj[0] + dot(&ja, &ja), jj[1] + dot(&ja, &jb), jj[2] + dot(&jb, &jb)];
            jr = [jr[0] + dot(&ja, &r), jr[1] + dot(&jb, &r)];
            rr += dot(&r, &r);
        }
        (jj, jr, rr)
    };
    let (mut a, mut b) = (length / 3.0 * (1.0 + lopsided), length / 3.0 * (1.0 - lopsided));
    let (mut jj, mut jr, mut rr) = normal(a, b);
    let mut damping = 1.0e-4;
    for _ in 0..40 {
        // Along a straight part no length makes a difference, and rounding alone would choose one.
        if jj[0] + jj[2] < STRAIGHT {
            break;
        }
        let trace = damping * (jj[0] + jj[2]) + f64::MIN_POSITIVE;
        let (m00, m11) = (jj[0] + trace, jj[2] + trace);
        let determinant = m00 * m11 - jj[1] * jj[1];
        let da = -(m11 * jr[0] - jj[1] * jr[1]) / determinant;
        let db = -(m00 * jr[1] - jj[1] * jr[0]) / determinant;
        let (next_a, next_b) = (a + da, b + db);
        let within = |x: f64| 1.0e-6 * length < x && x < 1.2 * length;
        let allowed = within(next_a) && within(next_b) && next_a + next_b < 1.6 * length;
        let found = if allowed { Some(normal(next_a, next_b)) } else { None };
        match found {
            Some(next) if next.2 < rr => {
                let gain = rr - next.2;
                (a, b) = (next_a, next_b);
                let small = gain <= 1.0e-9 * rr;
                (jj, jr, rr) = next;
                damping *= 0.1;
                if small || rr <= 1.0e-30 * length * length {
                    break;
                }
            }
            _ => {
                damping *= 8.0;
                if 1.0e6 < damping {
                    break;
                }
            }
        }
    }
    (a, b)
}

#[cfg(test)]
mod tests;
