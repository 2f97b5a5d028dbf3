//! A run of points as splines and lines, in order.

use super::super::bezier::Bezier;
use super::super::follow::follow;
use super::super::nurbs::Nurbs;
use super::{Fitting, Made, RUN, Run, corners, lines, made};
use crate::units::Position;

/// A part of a run, from where the part before ends.
#[derive(Clone, Debug, PartialEq)]
pub enum Part {
    /// A B-spline in place of all lines to this point.
    Spline(Nurbs, usize),
    /// Lines to this point.
    Lines(usize),
}

impl Part {
    /// The point where it ends.
    pub fn last(&self) -> usize {
        match self {
            Part::Spline(_, last) | Part::Lines(last) => *last,
        }
    }
}

/// A run that was broken more often, one part within another, stays lines.
const DEPTH: usize = 8;

/// A stretch of a run, up to a point: as a spline, or as lines.
struct Stretch {
    first: usize,
    last: usize,
    smooth: Option<Run>,
}

/// The run in parts, at least one of them a spline within the tolerance of its lines; none where splines would save nothing.
pub fn parts(points: &[Position], fitting: Fitting) -> Option<Vec<Part>> {
    if points.len() < RUN || !points.iter().flatten().all(|x| x.is_finite()) {
        return None;
    }
    let parts = joined(points, stretches(points, fitting), fitting.tolerance);
    parts.iter().any(|part| matches!(part, Part::Spline(..))).then_some(parts)
}

/// The run from corner to corner, broken on where no spline follows it.
fn stretches(points: &[Position], Fitting { tolerance, corner }: Fitting) -> Vec<Stretch> {
    let corners = corners::of(points, super::SHARES[0] * tolerance, corner);
    let mut found: Vec<Stretch> = Vec::new();
    // Stretches that are still to be made, the first one last.
    let mut stack: Vec<(usize, usize, usize)> = corners.windows(2).rev().map(|p| (p[0], p[1], 0)).collect();
    while let Some((first, last, depth)) = stack.pop() {
        let straight = Stretch { first, last, smooth: None };
        if last < first + 2 || depth == DEPTH {
            found.push(straight);
            continue;
        }
        let ends: Vec<usize> = match made(&points[first..=last], tolerance) {
            Made::Smooth(run) => {
                found.push(Stretch { smooth: Some(run), ..straight });
                continue;
            }
            Made::Broken(breaks) => breaks.into_iter().map(|at| first + at).collect(),
            // Both ends of each line, so that it becomes a stretch of its own.
            Made::Far(far) => {
                let mut ends: Vec<usize> = far.iter().flat_map(|at| [first + at, first + at + 1]).collect();
                ends.dedup();
                ends
            }
        };
        let mut ends: Vec<usize> = ends.into_iter().filter(|at| first < *at && *at < last).collect();
        if ends.is_empty() {
            found.push(straight);
            continue;
        }
        ends.insert(0, first);
        ends.push(last);
        stack.extend(ends.windows(2).rev().map(|pair| (pair[0], pair[1], depth + 1)));
    }
    found
}

/// Stretches that follow each other as one spline with triple knots, where that has fewer blocks than lines. As many lines in a row
/// as would be a run end a spline; fewer are straight spans of it.
fn joined(points: &[Position], stretches: Vec<Stretch>, tolerance: f64) -> Vec<Part> {
    let mut parts: Vec<Part> = Vec::new();
    let mut group: Vec<Stretch> = Vec::new();
    let mut rest = stretches.into_iter().peekable();
    while let Some(stretch) = rest.next() {
        let mut kept = Vec::new();
        if stretch.smooth.is_none() {
            kept.push(stretch);
            while let Some(next) = rest.next_if(|next| next.smooth.is_none()) {
                kept.push(next);
            }
        } else {
            group.push(stretch);
        }
        let count: usize = kept.iter().map(|stretch| stretch.last - stretch.first).sum();
        if count < RUN {
            group.extend(kept);
            continue;
        }
        close(points, std::mem::take(&mut group), tolerance, &mut parts);
        if let Some(last) = kept.last() {
            add_lines(last.last, &mut parts);
        }
    }
    close(points, group, tolerance, &mut parts);
    parts
}

/// Lines up to a point, behind those that are there.
fn add_lines(last: usize, parts: &mut Vec<Part>) {
    match parts.last_mut() {
        Some(Part::Lines(known)) => *known = last,
        Some(Part::Spline(..)) | None => parts.push(Part::Lines(last)),
    }
}

/// Ends a group of stretches.
fn close(points: &[Position], group: Vec<Stretch>, tolerance: f64, parts: &mut Vec<Part>) {
    let (Some(first), Some(last)) = (group.first(), group.last()) else { return };
    let (first, last, count) = (first.first, last.last, group.len());
    let (mut spans, mut knots, mut control) = (0, Vec::new(), Vec::new());
    let mut t = 0.0;
    for stretch in group {
        let run = stretch.smooth.unwrap_or_else(|| lines(&points[stretch.first..=stretch.last]));
        if run.length == 0.0 {
            continue;
        }
        if knots.is_empty() {
            knots.extend([t; 4]);
            control.push(run.points[0]);
        } else {
            knots.extend([t; 3]);
        }
        knots.extend(run.inner.iter().map(|own| t + own));
        control.extend_from_slice(&run.points[1..]);
        spans += run.inner.len() + 1;
        t += run.length;
    }
    knots.extend([t; 4]);
    let weights = vec![1.0; control.len()];
    let moves = |pair: &&[Position]| pair[0] != pair[1];
    // No fewer blocks than lines: then lines it is. Nor may both part where stretches meet.
    let holds = |spline: &Nurbs| {
        let pieces: Vec<Bezier> = spline.beziers().map(|(piece, _)| piece).collect();
        let lines = points[first..=last].windows(2).filter(moves).map(|pair| Bezier::line(pair[0], pair[1]));
        let lines: Vec<Bezier> = lines.collect();
        follow(&pieces, &lines, tolerance).is_ok_and(|found| found.distance <= tolerance)
    };
    let saves = spans + 3 < last - first + 1;
    let alone = count == 1;
    // Points that repeat the last place are lines that go nowhere: the spline ends at the first of them.
    let repeats = points[first..=last].iter().rev().take_while(|p| **p == points[last]).count();
    let end = last + 1 - repeats;
    match Nurbs::new(3, knots, control, weights) {
        Ok(spline) if saves && (alone || holds(&spline)) => {
            parts.push(Part::Spline(spline, end));
            if end < last {
                add_lines(last, parts);
            }
        }
        Ok(_) | Err(_) => add_lines(last, parts),
    }
}
