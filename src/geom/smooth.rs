//! Runs of many points become C2 cubic B-splines, corners kept.
//!
//! 1. **Corners.** The run is simplified within the tolerance (Douglas and Peucker). A corner is where the simplified path turns
//!    by more than the corner's angle, and the run too, seen from a few tolerances on either side: noise turns the points of
//!    a run but not its simplified path, and an arc turns that but not what is seen from near.
//! 2. **A spline from corner to corner**, by least squares on the chord lengths, its ends exact; a point's parameter
//!    moves to its foot from trial to trial (Hoschek 1988). It begins with one span; every
//!    span that is too far from a point is halved, until all hold. A long line among short ones gets points of its own, so
//!    that the spline has no room to swing beside it.
//! 3. **One curve.** Splines are put together with triple knots at the corners.
//!
//! Where halving a span would leave it fewer than `LEAST` points the run is broken at its farthest point. How far the result is from the polyline
//! is proved on the text that is read back.

use super::bezier::Bezier;
use super::elementary::cos;
use super::follow::foot;
use super::nurbs::Nurbs;
use crate::units::{MAX_AXES, Position};

/// How runs of points become splines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fitting {
    /// How far a point may be from the spline, mm.
    pub tolerance: f64,
    /// A turn above this is a corner, degrees.
    pub corner: f64,
}

/// A turn above this is a corner, degrees, where nobody says otherwise. Seen from [`REACH`] tolerances on either side an arc
/// of radius R turns by REACH δ/R, so that arcs of more than 18 tolerances are no corners.
pub const CORNER: f64 = 25.0;

/// So many tolerances on either side of a corner the path is straight, or nearly. Noise of half the tolerance turns what is
/// seen from there by at most 2 · 2/16 = ¼ radian, and mostly by far less.
const REACH: f64 = 8.0;

/// A span is not halved below so many points.
const LEAST: usize = 4;

/// A line longer than so many middling ones gets points of its own.
const LONG: f64 = 8.0;

/// The farthest point is sought among at most so many, which bounds the work.
const BLOCK: usize = 2048;

/// A point's parameter moves on only where the spline is within so many tolerances of it: farther off, its foot is anywhere.
const GRASP: f64 = 16.0;

/// So many points on either side of a corner may be the corner itself.
const ABOUT: usize = 16;

/// A run that no spline follows is broken at its farthest points at most so often, one part within another.
const DEPTH: usize = 8;

/// How often spans are halved.
const ROUNDS: usize = 40;

fn distance(a: &Position, b: &Position) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum::<f64>().sqrt()
}

/// A B-spline through the first and the last point and within the tolerance of all; none where it would save nothing.
pub fn spline(points: &[Position], fitting: Fitting) -> Option<Nurbs> {
    let Fitting { tolerance, corner } = fitting;
    if points.len() < LEAST + 1 {
        return None;
    }
    let corners = corners(points, tolerance, corner);
    let (mut pieces, mut knots, mut control) = (0, Vec::new(), Vec::new());
    let mut t = 0.0;
    // Runs that are still to be made, the first one last.
    let mut stack: Vec<(usize, usize, usize)> = corners.windows(2).rev().map(|p| (p[0], p[1], 0)).collect();
    while let Some((first, last, depth)) = stack.pop() {
        let run = &points[first..=last];
        let Run { inner, points, length } = match smooth(run, tolerance) {
            Ok(run) => run,
            Err(breaks) if depth < DEPTH && !breaks.is_empty() => {
                let ends = std::iter::once(0).chain(breaks.iter().copied());
                let parts = ends.zip(breaks.iter().copied().chain([last - first]));
                let parts: Vec<_> = parts.map(|(a, b)| (first + a, first + b, depth + 1)).collect();
                stack.extend(parts.into_iter().rev());
                continue;
            }
            Err(_) => lines(run),
        };
        if length == 0.0 {
            continue;
        }
        if knots.is_empty() {
            knots.extend([t; 4]);
            control.push(points[0]);
        } else {
            knots.extend([t; 3]);
        }
        knots.extend(inner.iter().map(|own| t + own));
        control.extend_from_slice(&points[1..]);
        pieces += inner.len() + 1;
        t += length;
    }
    knots.extend([t; 4]);
    // No fewer blocks than lines: then lines it is.
    if pieces + 3 >= points.len() {
        return None;
    }
    let weights = vec![1.0; control.len()];
    Nurbs::new(3, knots, control, weights).ok()
}

/// One run between corners: its inner knots from 0, its control points, its length.
struct Run {
    inner: Vec<f64>,
    points: Vec<Position>,
    length: f64,
}

/// A run as it is: a straight cubic a line, triple knots.
fn lines(run: &[Position]) -> Run {
    let (mut inner, mut points, mut t) = (Vec::new(), vec![run[0]], 0.0);
    for pair in run.windows(2) {
        let length = distance(&pair[0], &pair[1]);
        if length == 0.0 {
            continue;
        }
        if 0.0 < t {
            inner.extend([t; 3]);
        }
        t += length;
        points.extend_from_slice(&Bezier::line(pair[0], pair[1]).raised_to(3).control_points()[1..]);
    }
    Run { inner, points, length: t }
}

/// Where a run has corners, its first and last point included.
fn corners(points: &[Position], tolerance: f64, corner: f64) -> Vec<usize> {
    let kept = simplified(points, tolerance);
    let least = cos(corner / crate::units::DEGREES);
    let mut corners = vec![0];
    for triple in kept.windows(3) {
        let [a, b, c] = [0, 1, 2].map(|k| points[triple[k]]);
        let (before, after) = (distance(&a, &b), distance(&b, &c));
        if before.min(after) < REACH * tolerance {
            continue;
        }
        let reach = REACH * tolerance;
        let away = |i: &usize| reach <= distance(&points[*i], &b);
        let near = [
            (triple[0]..triple[1]).rev().find(away).unwrap_or(triple[0]),
            (triple[1] + 1..triple[2]).find(away).unwrap_or(triple[2]),
        ];
        if cosine(&a, &b, &c) < least && cosine(&points[near[0]], &b, &points[near[1]]) < least {
            corners.push(sharpest(points, near, triple[1]));
        }
    }
    corners.push(points.len() - 1);
    corners
}

/// Of the points about a corner the one from which lines to both ends of its surroundings leave least over, in squares: noise
/// makes the simplified path turn a point too early or too late.
fn sharpest(points: &[Position], [first, last]: [usize; 2], corner: usize) -> usize {
    let left_over = |at: usize| {
        let (before, after) =
            (Bezier::line(points[first], points[at]), Bezier::line(points[at], points[last]));
        (first + 1..last)
            .map(|i| {
                let line = if i < at { &before } else { &after };
                let off = distance(&points[i], &line.eval(foot(line, &points[i], 0.5, 0.0, 1.0)));
                off * off
            })
            .sum::<f64>()
    };
    let about = (first + 1).max(corner.saturating_sub(ABOUT))..last.min(corner + ABOUT + 1);
    about
        .map(|i| (left_over(i), i))
        .fold((f64::INFINITY, corner), |least, own| if own.0 < least.0 { own } else { least })
        .1
}

/// The cosine of the turn at b on the way from a to c.
fn cosine(a: &Position, b: &Position, c: &Position) -> f64 {
    let turn: f64 = (0..MAX_AXES).map(|i| (b[i] - a[i]) * (c[i] - b[i])).sum();
    turn / (distance(a, b) * distance(b, c))
}

/// The points that are kept when those within `tolerance` of the lines between kept ones are left out.
fn simplified(points: &[Position], tolerance: f64) -> Vec<usize> {
    let mut keep = vec![false; points.len()];
    (keep[0], keep[points.len() - 1]) = (true, true);
    let mut stack: Vec<(usize, usize)> = (0..points.len() - 1)
        .step_by(BLOCK)
        .map(|first| (first, (first + BLOCK).min(points.len() - 1)))
        .collect();
    let seams: Vec<usize> = stack.iter().skip(1).map(|(first, _)| *first).collect();
    for seam in &seams {
        keep[*seam] = true;
    }
    while let Some((first, last)) = stack.pop() {
        let line = Bezier::line(points[first], points[last]);
        let length = distance(&points[first], &points[last]);
        let off = |i: usize| {
            if length == 0.0 {
                return distance(&points[i], &points[first]);
            }
            let along: f64 = (0..MAX_AXES)
                .map(|k| (points[i][k] - points[first][k]) * (points[last][k] - points[first][k]))
                .sum();
            let share = (along / (length * length)).clamp(0.0, 1.0);
            distance(&points[i], &line.eval(share))
        };
        let far = (first + 1..last)
            .map(|i| (off(i), i))
            .fold((0.0, first), |most, own| if most.0 < own.0 { own } else { most });
        if tolerance < far.0 {
            keep[far.1] = true;
            stack.push((first, far.1));
            stack.push((far.1, last));
        }
    }
    // A seam is no place of the path's own: it stays only where both sides turn about it.
    for seam in seams {
        let before = (0..seam).rev().find(|i| keep[*i]).unwrap_or(0);
        let after = (seam + 1..points.len()).find(|i| keep[*i]).unwrap_or(points.len() - 1);
        let line = Bezier::line(points[before], points[after]);
        let t = foot(&line, &points[seam], 0.5, 0.0, 1.0);
        keep[seam] = tolerance < distance(&points[seam], &line.eval(t));
    }
    (0..points.len()).filter(|i| keep[*i]).collect()
}

/// The least-squares spline of a run. Where points are too few for the tolerance: the farthest of them, where the run is better
/// broken.
fn smooth(run: &[Position], tolerance: f64) -> Result<Run, Vec<usize>> {
    let Parameters { mut at, places, of } = parameters(run).ok_or_else(Vec::new)?;
    let length = at[at.len() - 1];
    if run.len() == 2 {
        return Ok(lines(run));
    }
    let mut breaks = vec![0.0, length];
    for _ in 0..ROUNDS {
        let Trial { points, far, count } =
            trial(&mut at, &places, &breaks, tolerance).ok_or_else(Vec::new)?;
        if far.iter().all(Option::is_none) {
            let (breaks, points) = fewer(&mut at, &places, &breaks, points, tolerance);
            return Ok(Run { inner: breaks[1..breaks.len() - 1].to_vec(), points, length });
        }
        let few = |i: &usize| far[*i].is_some() && count[*i] < 2 * LEAST;
        if (0..far.len()).any(|i| few(&i)) {
            let mut breaks: Vec<usize> =
                (0..far.len()).filter(few).filter_map(|i| Some(of[far[i]?.1])).collect();
            breaks.dedup();
            breaks.retain(|at| 0 < *at && at + 1 < run.len());
            return Err(breaks);
        }
        let mut finer = vec![0.0];
        for (i, far) in far.iter().enumerate() {
            if far.is_some() {
                finer.push(0.5 * (breaks[i] + breaks[i + 1]));
            }
            finer.push(breaks[i + 1]);
        }
        breaks = finer;
    }
    Err(Vec::new())
}

/// Halving overshoots by up to two. Fewer spans in the same proportions are sought by bisection between half as many and
/// all: the break i of k stands where the spans so far count i/k of all.
fn fewer(
    at: &mut [f64],
    places: &[Position],
    breaks: &[f64],
    points: Vec<Position>,
    tolerance: f64,
) -> (Vec<f64>, Vec<Position>) {
    let all = breaks.len() - 1;
    let (mut low, mut high) = (all / 2, all);
    let mut best = (breaks.to_vec(), points);
    let mut own = at.to_vec();
    while low + 1 < high {
        let k = low.midpoint(high);
        let spread: Vec<f64> = (0..=k)
            .map(|i| {
                let x = i as f64 * all as f64 / k as f64;
                let j = (x as usize).min(all - 1);
                breaks[j] + (x - j as f64) * (breaks[j + 1] - breaks[j])
            })
            .collect();
        own.copy_from_slice(at);
        match trial(&mut own, places, &spread, tolerance) {
            Some(found) if found.far.iter().all(Option::is_none) => {
                best = (spread, found.points);
                high = k;
                at.copy_from_slice(&own);
            }
            _ => low = k,
        }
    }
    best
}

/// A spline on some breaks.
struct Trial {
    /// Its control points.
    points: Vec<Position>,
    /// For each span the square of the distance of the farthest point, where that is too far, and which one.
    far: Vec<Option<(f64, usize)>>,
    /// How many points each span has.
    count: Vec<usize>,
}

/// The least-squares spline on some breaks. Chord lengths of noisy points drift from the length of the path by far more than
/// the noise, so each point's parameter moves on to the foot of the point, by one of Newton's steps and in order, for this
/// measure and for the next trial.
fn trial(at: &mut [f64], places: &[Position], breaks: &[f64], tolerance: f64) -> Option<Trial> {
    let points = solve(at, places, breaks)?;
    let (mut far, mut count) = (vec![None; breaks.len() - 1], vec![0usize; breaks.len() - 1]);
    let (mut span, mut before, last) = (0, 0.0, at.len() - 1);
    let length = at[last];
    for (i, place) in places.iter().enumerate() {
        let t = at[i];
        while span + 2 < breaks.len() && breaks[span + 1] < t {
            span += 1;
        }
        count[span] += 1;
        let (b, slope) = basis(breaks, span, t);
        let (mut r, mut d) = ([0.0; MAX_AXES], [0.0; MAX_AXES]);
        for axis in 0..MAX_AXES {
            let sum = |b: &[f64; 4]| (0..4).map(|k| b[k] * points[span + k][axis]).sum::<f64>();
            (r[axis], d[axis]) = (sum(&b) - place[axis], sum(&slope));
        }
        let dot = |a: &Position, b: &Position| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut step = -dot(&r, &d) / dot(&d, &d);
        if i == 0 || i == last || GRASP * GRASP * tolerance * tolerance < dot(&r, &r) || !step.is_finite() {
            step = 0.0;
        }
        let own = (t + step).clamp(before, length);
        let off: Position = std::array::from_fn(|axis| r[axis] + (own - t) * d[axis]);
        let off = dot(&off, &off);
        if tolerance * tolerance < off && far[span].is_none_or(|(most, _)| most < off) {
            far[span] = Some((off, i));
        }
        at[i] = own;
        before = own;
    }
    Some(Trial { points, far, count })
}

/// Places to lead a spline along.
struct Parameters {
    /// Where on it each place is.
    at: Vec<f64>,
    /// The points, and points put on long lines.
    places: Vec<Position>,
    /// Which point each is, or which comes after it.
    of: Vec<usize>,
}

/// The places of a run at their chord lengths.
fn parameters(run: &[Position]) -> Option<Parameters> {
    let mut lengths: Vec<f64> = run.windows(2).map(|pair| distance(&pair[0], &pair[1])).collect();
    let own = lengths.clone();
    lengths.sort_unstable_by(f64::total_cmp);
    let middling = lengths[lengths.len() / 2];
    if !(0.0 < middling) {
        return None;
    }
    let (mut at, mut places, mut of) = (vec![0.0], vec![run[0]], vec![0]);
    let mut t = 0.0;
    for (i, (pair, length)) in run.windows(2).zip(own).enumerate() {
        if length == 0.0 {
            continue;
        }
        let parts = (length / (LONG * middling)).ceil().clamp(1.0, 1000.0) as usize;
        for part in 1..=parts {
            let share = part as f64 / parts as f64;
            at.push(t + share * length);
            places.push(std::array::from_fn(|axis| pair[0][axis] + share * (pair[1][axis] - pair[0][axis])));
            of.push(i + 1);
        }
        t += length;
    }
    Some(Parameters { at, places, of })
}

/// The four cubic B-splines that are not zero on a span, and their derivatives; simple inner knots and four-fold ends, by Cox
/// and de Boor.
fn basis(breaks: &[f64], span: usize, t: f64) -> ([f64; 4], [f64; 4]) {
    let last = breaks.len() - 1;
    let knot = |i: isize| breaks[i.clamp(0, last as isize) as usize];
    let s = span as isize;
    let (mut b, mut slope) = ([1.0, 0.0, 0.0, 0.0], [0.0; 4]);
    for k in 1..4isize {
        let mut saved = 0.0;
        slope = [0.0; 4];
        for r in 0..k {
            let (right, left) = (knot(s + r + 1), knot(s + r + 1 - k));
            let share = b[r as usize] / (right - left);
            b[r as usize] = saved + (right - t) * share;
            saved = (t - left) * share;
            slope[r as usize] -= k as f64 * share;
            slope[r as usize + 1] += k as f64 * share;
        }
        b[k as usize] = saved;
    }
    (b, slope)
}

/// Control points of the least squares, the first and the last at the first and the last place. The normal equations
/// have a band of seven, so that time and memory are linear.
fn solve(at: &[f64], places: &[Position], breaks: &[f64]) -> Option<Vec<Position>> {
    let n = breaks.len() + 2;
    let mut band = vec![[0.0f64; 4]; n];
    let mut right = vec![[0.0f64; MAX_AXES]; n];
    let mut span = 0;
    for (t, place) in at.iter().zip(places) {
        while span + 2 < breaks.len() && breaks[span + 1] < *t {
            span += 1;
        }
        let (b, _) = basis(breaks, span, *t);
        for i in 0..4 {
            for j in i..4 {
                band[span + i][j - i] += b[i] * b[j];
            }
            for axis in 0..MAX_AXES {
                right[span + i][axis] += b[i] * place[axis];
            }
        }
    }
    // A little stiffness, for spans whose points leave a control point free.
    let trace = 1.0e-9 * band.iter().map(|row| row[0]).sum::<f64>() / n as f64;
    let ends = [(0, places[0]), (n - 1, places[places.len() - 1])];
    for row in &mut band {
        row[0] += trace;
    }
    for (fixed, place) in ends {
        for other in fixed.saturating_sub(3)..(fixed + 4).min(n) {
            let (low, high) = (other.min(fixed), other.max(fixed));
            let a = band[low][high - low];
            if other != fixed {
                for axis in 0..MAX_AXES {
                    right[other][axis] -= a * place[axis];
                }
                band[low][high - low] = 0.0;
            }
        }
        band[fixed][0] = 1.0;
        right[fixed] = place;
    }
    // Cholesky's L·D·Lᵀ within the band.
    for i in 0..n {
        let d = band[i][0];
        if !(0.0 < d) {
            return None;
        }
        let row = band[i];
        for j in 1..4.min(n - i) {
            let share = row[j] / d;
            for k in j..4.min(n - i) {
                band[i + j][k - j] -= share * row[k];
            }
            for axis in 0..MAX_AXES {
                right[i + j][axis] -= share * right[i][axis];
            }
        }
    }
    for i in (0..n).rev() {
        for axis in 0..MAX_AXES {
            let known: f64 = (1..4.min(n - i)).map(|j| band[i][j] * right[i + j][axis]).sum();
            right[i][axis] = (right[i][axis] - known) / band[i][0];
        }
    }
    Some(right)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::elementary::sin;

    fn within(tolerance: f64) -> Fitting {
        Fitting { tolerance, corner: CORNER }
    }

    fn wave(spacing: f64, noise: f64) -> Vec<Position> {
        let mut seed = 1u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        (0..=(60.0 / spacing) as usize)
            .map(|i| {
                let x = spacing * i as f64;
                [x + noise * random(), 5.0 * sin(0.3 * x) + noise * random(), 0.0, 0.0, 0.0, 0.0]
            })
            .collect()
    }

    #[test]
    fn dense_points_take_ten_times_fewer_blocks() {
        // Both coordinates are off by at most a third of the tolerance, together by less than half of it.
        for (spacing, noise) in [(0.01, 0.0), (0.1, 0.0), (0.01, 0.0035), (0.1, 0.0035)] {
            let points = wave(spacing, noise);
            let fitted = spline(&points, within(0.01)).unwrap();
            assert!(
                10 * (fitted.points().len() - 1) < points.len(),
                "{} of {}",
                fitted.points().len(),
                points.len()
            );
            let total = fitted.knots()[fitted.knots().len() - 1];
            for i in 0..=2000 {
                let p = fitted.eval(total * f64::from(i) / 2000.0);
                // Tolerance and noise; the curve's slope is below 2, so that its distance is at most that in Y.
                let off = (p[1] - 5.0 * sin(0.3 * p[0])).abs();
                assert!(off < 0.02 + 2.0 * noise, "{off} at {} ({spacing}, {noise})", p[0]);
            }
        }
    }

    #[test]
    fn corners_stay_where_they_are() {
        // A zigzag of 20 mm legs, a point each 0.2 mm.
        let corner = |k: i32| [10.0 * f64::from(k), if k % 2 == 0 { 0.0 } else { 17.0 }, 0.0, 0.0, 0.0, 0.0];
        let mut points = vec![corner(0)];
        for k in 0..6 {
            let (a, b) = (corner(k), corner(k + 1));
            points.extend((1..=100).map(|i| {
                let share = f64::from(i) / 100.0;
                std::array::from_fn::<f64, MAX_AXES, _>(|axis| a[axis] + share * (b[axis] - a[axis]))
            }));
        }
        let fitted = spline(&points, within(0.005)).unwrap();
        for k in 0..=6 {
            let kept = fitted.points().iter().any(|p| distance(p, &corner(k)) < 1.0e-12);
            assert!(kept, "corner {k} is gone");
        }
        assert_eq!(fitted.points().len(), 6 * 3 + 1);
    }

    #[test]
    fn few_points_stay_lines() {
        assert!(spline(&wave(0.1, 0.0)[..4], within(0.01)).is_none());
    }
}
