//! What the axes do between the blocks: how far, how fast and which way they go, and where sections stand.
//!
//! Curves are evaluated here at dense points by the formulas of the controls' manuals, whose letters they keep.

use super::curves::{powers, runs};
use super::state::{Move, Start};
use super::words::{Dialect, Motion};
use super::{Counts, Job, NOISE, Rule, Violation, is_rotary};
use std::collections::{BTreeMap, BTreeSet};

/// Into how many parts a polynomial piece is cut.
const PARTS: usize = 32;

/// Remarks have three decimals and positions four: two of each, half a unit off.
const ROUNDING: f64 = 2.0 * (0.000_5 + 0.000_05) + NOISE;

/// Speeds are greatest at an end most often, and a chord tells only their mean: the first and the last are short.
const END: f64 = 1.0e-3;

/// From 0 to 1.
fn grid() -> Vec<f64> {
    let inner = (1..PARTS).map(|i| i as f64 / PARTS as f64);
    [0.0, END].into_iter().chain(inner).chain([1.0 - END, 1.0]).collect()
}

type Point = BTreeMap<char, f64>;

/// Blocks that move at feed, and the points that they run through in a straight line or nearly so.
struct Track<'a> {
    step: &'a Move,
    points: Vec<Point>,
}

pub(super) fn check(job: &Job, moves: &[Move], starts: &[Start]) -> Vec<Violation> {
    let mut violations = Vec::new();
    let tracks = tracks(moves);
    range(job, moves, &tracks, &mut violations);
    for track in &tracks {
        speed(job, track, &mut violations);
    }
    turn(&tracks, &mut violations);
    index(job, starts, &mut violations);
    violations
}

fn tracks(moves: &[Move]) -> Vec<Track<'_>> {
    let mut tracks = Vec::new();
    for run in runs(moves) {
        match run[0].modal.motion {
            Some(Motion::Line | Motion::Through | Motion::Poly | Motion::Spl) => {
                tracks.extend(run.iter().map(|step| Track { step, points: points(step) }));
            }
            Some(Motion::Bspline | Motion::Nurbs) => {
                tracks.push(Track { step: &run[0], points: spline(run) });
            }
            Some(Motion::Rapid) | None => {}
        }
    }
    tracks
}

/// Of a block that needs no other: its ends, or a polynomial. Of a spline through points only those are known.
fn points(step: &Move) -> Vec<Point> {
    let polynomial = matches!(step.modal.motion, Some(Motion::Poly | Motion::Spl));
    let grid = if polynomial { grid() } else { vec![0.0, 1.0] };
    let curves: Vec<(char, Vec<f64>)> = step
        .targets
        .iter()
        .filter_map(|(axis, to)| {
            let from = *step.from.get(axis)?;
            let c = match step.modal.motion {
                Some(Motion::Line) => vec![from, step.by[axis]],
                Some(Motion::Poly | Motion::Spl) => powers(step, *axis, from, *to),
                _ => vec![from, to - from],
            };
            Some((*axis, c))
        })
        .collect();
    let at = |u: f64| {
        // SPL runs from 1 to 0.
        let u = if step.modal.motion == Some(Motion::Spl) { 1.0 - u } else { u };
        curves.iter().map(|(axis, c)| (*axis, c.iter().rev().fold(0.0, |sum, c| sum * u + c))).collect()
    };
    grid.into_iter().map(at).collect()
}

/// Control points, weights and knots of a run, evaluated in every span.
fn spline(run: &[Move]) -> Vec<Point> {
    let sinumerik = run[0].modal.motion == Some(Motion::Bspline);
    let mut control: Vec<(Point, f64)> = Vec::new();
    let mut at: Point = run[0].targets.keys().filter_map(|a| Some((*a, *run[0].from.get(a)?))).collect();
    if sinumerik {
        control.push((at.clone(), 1.0));
    }
    for step in run.iter().filter(|step| !step.targets.is_empty()) {
        at.extend(&step.targets);
        control.push((at.clone(), step.weight.unwrap_or(1.0)));
    }
    let (degree, knots) = if sinumerik {
        // t[2] = 0, t[j+2] = t[j+1] + PL_j; both ends are met.
        let mut knots = vec![0.0; 3];
        for step in run {
            knots.push(knots[knots.len() - 1] + step.knot.unwrap_or_default());
        }
        knots.extend([knots[knots.len() - 1]; 2]);
        (3, knots)
    } else {
        let order = run[0].order.unwrap_or(4.0) as usize;
        (order.saturating_sub(1), run.iter().filter_map(|step| step.knot).collect())
    };
    // Where the numbers do not fit another rule speaks.
    if knots.len() != control.len() + degree + 1 || degree == 0 {
        return control.into_iter().map(|(point, _)| point).collect();
    }
    let mut points = Vec::new();
    for span in degree..control.len() {
        let (low, high) = (knots[span], knots[span + 1]);
        if high <= low {
            continue;
        }
        points.extend(grid().iter().map(|u| de_boor(&control, &knots, degree, span, low + (high - low) * u)));
    }
    points
}

/// d_i <- (1-a) d_(i-1) + a d_i with a = (t - t_i)/(t_(i+p-r+1) - t_i), in homogeneous coordinates.
fn de_boor(control: &[(Point, f64)], knots: &[f64], p: usize, span: usize, t: f64) -> Point {
    let mut d: Vec<(Point, f64)> = control[span - p..=span]
        .iter()
        .map(|(point, w)| (point.iter().map(|(axis, x)| (*axis, x * w)).collect(), *w))
        .collect();
    for r in 1..=p {
        for j in (r..=p).rev() {
            let i = span - p + j;
            let a = (t - knots[i]) / (knots[i + p - r + 1] - knots[i]);
            let mix = |before: f64, after: f64| (1.0 - a) * before + a * after;
            let (before, w) = d[j - 1].clone();
            for (axis, x) in &mut d[j].0 {
                *x = mix(before.get(axis).copied().unwrap_or_default(), *x);
            }
            d[j].1 = mix(w, d[j].1);
        }
    }
    let (point, w) = &d[p];
    point.iter().map(|(axis, x)| (*axis, x / w)).collect()
}

/// No axis leaves what the machine file allows, where it is counted from the work's own zero. One that wraps has no end.
fn range(job: &Job, moves: &[Move], tracks: &[Track], violations: &mut Vec<Violation>) {
    let mut reach = |step: &Move, axis: char, at: f64| {
        let Some(limits) = job.limits.get(&axis).filter(|_| !job.modulo.contains(&axis)) else { return };
        let at = at + step.modal.zeros.get(&axis).map_or(0.0, |zero| zero.at);
        if at < limits.min - NOISE || limits.max + NOISE < at {
            violations.push(step.violation(Rule::Range, format!("{axis} goes to {at:.4}")));
        }
    };
    for step in moves.iter().filter(|step| step.modal.motion == Some(Motion::Rapid)) {
        step.targets.iter().for_each(|(axis, to)| reach(step, *axis, *to));
    }
    for track in tracks {
        let axes: BTreeSet<char> = track.points.iter().flat_map(|point| point.keys().copied()).collect();
        for axis in axes {
            let all = || track.points.iter().filter_map(|point| point.get(&axis).copied());
            reach(track.step, axis, all().fold(f64::INFINITY, f64::min));
            reach(track.step, axis, all().fold(f64::NEG_INFINITY, f64::max));
        }
    }
}

/// The axes whose way F is the speed of.
fn counted(job: &Job, step: &Move) -> impl Fn(char) -> bool {
    let group = match job.dialect {
        // FGROUP says it; without, the geometry axes count.
        Dialect::Sinumerik => Some(step.modal.group.clone().unwrap_or_else(|| vec!['X', 'Y', 'Z'])),
        Dialect::Heidenhain | Dialect::Mazak => None,
    };
    // At a surface nobody knows here a degree counts for nothing, and axes come out too fast rather than too slow.
    let degrees = job.counts == Counts::DegreesAsMm;
    move |axis| match &group {
        Some(group) => group.contains(&axis),
        None => degrees || !is_rotary(axis),
    }
}

/// No axis is faster than the machine file allows: F dx/dL on each part of a curve.
fn speed(job: &Job, track: &Track, violations: &mut Vec<Violation>) {
    let step = track.step;
    let counted = counted(job, step);
    let turns = step.targets.keys().find(|axis| is_rotary(**axis));
    if let Some(axis) = turns.filter(|axis| counted(**axis) != (job.counts == Counts::DegreesAsMm)) {
        violations
            .push(step.violation(Rule::Feed, format!("F does not count {axis} as the machine file says")));
    }
    if let Some(axis) = turns.filter(|_| job.counts == Counts::Time && !step.modal.timed) {
        violations.push(step.violation(Rule::Feed, format!("{axis} moves without a time")));
    }
    let Some(feed) = step.modal.feed else { return };
    let mut most: BTreeMap<char, f64> = BTreeMap::new();
    for pair in track.points.windows(2) {
        let delta = |axis: char| Some((pair[1].get(&axis)? - pair[0].get(&axis)?).abs());
        let way = pair[1].keys().filter(|axis| counted(**axis)).filter_map(|axis| delta(*axis));
        let way = way.map(|delta| delta * delta).sum::<f64>().sqrt();
        for axis in pair[1].keys() {
            let delta = delta(*axis).unwrap_or_default();
            if step.modal.timed {
                // Parts of one block add up.
                *most.entry(*axis).or_default() += feed * delta;
                continue;
            }
            // Where nothing moves that F counts, it is the speed of what does.
            let share = if NOISE < way { delta / way } else { f64::from(NOISE < delta) };
            let most = most.entry(*axis).or_default();
            *most = most.max(feed * share);
        }
    }
    for (axis, speed) in most {
        if job.limits.get(&axis).is_some_and(|limits| limits.speed * (1.0 + NOISE) < speed) {
            violations.push(step.violation(Rule::Speed, format!("{axis} moves at {speed:.1}")));
        }
    }
}

/// Within a path a rotary axis does not turn back: a flute winds one way.
fn turn(tracks: &[Track], violations: &mut Vec<Violation>) {
    let mut ways: BTreeMap<(usize, char), f64> = BTreeMap::new();
    for track in tracks.iter().filter(|track| track.step.path) {
        let mut back = BTreeSet::new();
        for pair in track.points.windows(2) {
            for (axis, to) in pair[1].iter().filter(|(axis, _)| is_rotary(**axis)) {
                let by = to - pair[0].get(axis).unwrap_or(to);
                if by.abs() <= NOISE {
                    continue;
                }
                let way = ways.entry((track.step.section, *axis)).or_insert(by);
                if *way * by < 0.0 {
                    back.insert(*axis);
                }
            }
        }
        violations
            .extend(back.iter().map(|axis| track.step.violation(Rule::Turn, format!("{axis} turns back"))));
    }
}

/// Sections begin as far apart as their remarks say: `FLUTE 2 OF 4, A 88, ROUGH 1 OF 2, Z 0.5`.
fn index(job: &Job, starts: &[Start], violations: &mut Vec<Violation>) {
    let said: Vec<BTreeMap<char, f64>> = starts.iter().map(|start| places(&start.remark)).collect();
    let axes: BTreeSet<char> = said.iter().flat_map(|said| said.keys().copied()).collect();
    for axis in axes {
        let sign = if job.reversed.contains(&axis) { -1.0 } else { 1.0 };
        let offset = |i: usize| {
            let stated: f64 = said[i].get(&axis).copied().unwrap_or_default();
            Some(starts[i].at.get(&axis)? - sign * stated)
        };
        for (i, start) in starts.iter().enumerate() {
            let (Some(first), Some(own)) = (offset(0), offset(i)) else { continue };
            let apart = own - first;
            let turn = if is_rotary(axis) { 360.0 * (apart / 360.0).round() } else { 0.0 };
            if ROUNDING < (apart - turn).abs() {
                let what = format!("the path begins {:.4} from where {axis} should be", apart - turn);
                violations.push(Violation { line: start.line, rule: Rule::Index, what });
            }
        }
    }
}

/// An axis and a number, between commas.
fn places(remark: &str) -> BTreeMap<char, f64> {
    let place = |part: &str| {
        let (axis, number) = part.trim().split_once(' ')?;
        let mut letters = axis.chars();
        let axis = letters.next().filter(|axis| "XYZABCUVW".contains(*axis) && letters.next().is_none())?;
        Some((axis, number.parse().ok()?))
    };
    remark.split(',').filter_map(place).collect()
}
