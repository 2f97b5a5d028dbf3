//! Where a run of points has corners, and where it has noise only.

use super::super::bezier::Bezier;
use super::super::elementary::cos;
use super::super::follow::foot;
use super::distance;
use crate::units::{DEGREES, MAX_AXES, Position};

/// So many tolerances on either side of a corner the path is straight, or nearly. Noise of half the tolerance turns what is
/// seen from there by at most 2 · 2/16 = ¼ radian, and mostly by far less.
const REACH: f64 = 8.0;

/// The farthest point is sought among at most so many, which bounds the work.
const BLOCK: usize = 2048;

/// So many points on either side of a corner may be the corner itself.
const ABOUT: usize = 16;

/// Where a run has corners, its first and last point included.
pub(super) fn of(points: &[Position], tolerance: f64, corner: f64) -> Vec<usize> {
    let kept = simplified(points, tolerance);
    let least = cos(corner / DEGREES);
    let reach = REACH * tolerance;
    let mut corners = vec![0];
    for k in 1..kept.len() - 1 {
        let away = |from: usize| move |i: &usize| reach <= distance(&points[*i], &points[from]);
        // Two vertices of the simplified path may stand for one corner: the next ones are those beyond reach.
        let at = kept[k];
        let before = kept[..k].iter().copied().rev().find(away(at));
        let after = kept[k + 1..].iter().copied().find(away(at));
        let (Some(before), Some(after)) = (before, after) else { continue };
        let near = |at: usize| {
            let back = (before..at).rev().find(away(at)).unwrap_or(before);
            [back, (at + 1..after).find(away(at)).unwrap_or(after)]
        };
        // A vertex may stand beside its corner, which is looked for first.
        let corner = sharpest(points, near(at), at);
        let turns = |[i, j]: [usize; 2]| cosine(&points[i], &points[corner], &points[j]) < least;
        if !(turns([before, after]) && turns(near(corner))) {
            continue;
        }
        let last = corners[corners.len() - 1];
        if last < corner && (corners.len() == 1 || reach <= distance(&points[last], &points[corner])) {
            corners.push(corner);
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
