//! Runs of many points become C2 cubic B-splines, corners kept.
//!
//! 1. **Corners.** The run is simplified within the tolerance (Douglas and Peucker). A corner is where the simplified path turns
//!    by more than the corner's angle, and the run too, seen from a few tolerances on either side: noise turns the points of
//!    a run but not its simplified path, and an arc turns that but not what is seen from near.
//! 2. **A spline from corner to corner**, by least squares on the chord lengths, its ends exact; a point's parameter
//!    moves to its foot from trial to trial (Hoschek 1988). It begins with one span; every
//!    span that is too far from a point is halved, until all hold. A long line among short ones gets points of its own, so
//!    that the spline has no room to swing beside it.
//! 3. **The proof.** Points near a spline say nothing of what it does between them, least of all where they are few. So what
//!    comes of a run is bounded against the run's lines ([`follow`](super::follow)); lines that it is too far from are kept, and
//!    what stands between them is made anew, each part for itself.
//! 4. **One curve** of what follows each other: splines are put together with triple knots, at the corners and about a few lines that
//!    were kept; many lines in a row stay lines of their own.
//!
//! Where halving a span would leave it fewer than `LEAST` points the run is broken at its farthest point.

mod corners;
mod parts;
mod squares;

use super::bezier::Bezier;
use super::follow::{follow, parted};
use super::nurbs::Nurbs;
use crate::units::{MAX_AXES, Position};
use squares::{basis, solve};

pub use parts::{Part, parts};

/// How runs of points become splines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fitting {
    /// How far the spline may be from the lines, both run in order, mm.
    pub tolerance: f64,
    /// A turn above this is a corner, degrees.
    pub corner: f64,
}

/// A turn above this is a corner, degrees, where nobody says otherwise. Seen from 8 tolerances δ on either side an arc
/// of radius R turns by 8 δ/R, so that arcs of more than 18 tolerances are no corners.
pub const CORNER: f64 = 25.0;

/// A span is not halved below so many points, so that there are more of them than control points.
const LEAST: usize = 2;

/// Fewer points than this are no run.
const RUN: usize = 5;

/// The shares of the tolerance that a point may be from the spline, one after the other: the way between the points takes some
/// too, and where that is too much, another spline may still hold.
const SHARES: [f64; 2] = [0.8, 0.4];

/// A line longer than so many middling ones gets points of its own.
const LONG: f64 = 8.0;

/// A point's parameter moves on only where the spline is within so many tolerances of it: farther off, its foot is anywhere.
const GRASP: f64 = 4.0;

/// The fewest spans are sought to within one in so many.
const NEAR_ENOUGH: usize = 64;

/// How often unlucky spans are halved while fewer are sought.
const MENDED: usize = 4;

/// How often spans are halved.
const ROUNDS: usize = 40;

fn distance(a: &Position, b: &Position) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum::<f64>().sqrt()
}

/// One run between corners: its inner knots from 0, its control points, its length.
struct Run {
    inner: Vec<f64>,
    points: Vec<Position>,
    length: f64,
}

impl Run {
    /// Its pieces.
    fn pieces(&self) -> Vec<Bezier> {
        let mut knots = vec![0.0; 4];
        knots.extend_from_slice(&self.inner);
        knots.extend([self.length; 4]);
        let weights = vec![1.0; self.points.len()];
        let spline = Nurbs::new(3, knots, self.points.clone(), weights);
        spline.map_or(Vec::new(), |spline| spline.beziers().map(|(piece, _)| piece).collect())
    }
}

/// What becomes of a run.
enum Made {
    /// A spline within the tolerance of the lines.
    Smooth(Run),
    /// It is better broken at these points.
    Broken(Vec<usize>),
    /// A spline would be too far from these lines, counted from 0.
    Far(Vec<usize>),
}

/// A spline in place of the lines between a run's points, proved to be within the tolerance of them; or why there is none.
fn made(run: &[Position], tolerance: f64) -> Made {
    let all = || (0..run.len() - 1).collect();
    let moves = |pair: &&[Position]| pair[0] != pair[1];
    // A line of no length is no piece: the spline has been there already.
    let kept: Vec<usize> = (0..run.len() - 1).filter(|i| moves(&&run[*i..*i + 2])).collect();
    let lines: Vec<Bezier> = kept.iter().map(|i| Bezier::line(run[*i], run[*i + 1])).collect();
    let mut best: Option<Vec<usize>> = None;
    for share in SHARES {
        let spline = match smooth(run, share * tolerance) {
            Ok(spline) => spline,
            // With less of the tolerance it is broken elsewhere at most.
            Err(breaks) => return best.map_or(Made::Broken(breaks), Made::Far),
        };
        let pieces = spline.pieces();
        if follow(&pieces, &lines, tolerance).is_ok_and(|found| found.distance <= tolerance) {
            return Made::Smooth(spline);
        }
        let far: Vec<usize> = parted(&pieces, &lines, tolerance).into_iter().map(|i| kept[i]).collect();
        if best.as_ref().is_none_or(|best| far.len() < best.len()) {
            best = Some(far);
        }
    }
    // Two bounds of one thing may differ: then nothing says where the spline is too far.
    Made::Far(best.filter(|far| !far.is_empty()).unwrap_or_else(all))
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
        let found = trial(&mut at, &places, &breaks, tolerance).ok_or_else(Vec::new)?;
        if found.far.iter().all(Option::is_none) {
            let (breaks, points) = fewer(&mut at, &places, &breaks, found.points, tolerance);
            return Ok(Run { inner: breaks[1..breaks.len() - 1].to_vec(), points, length });
        }
        let Some(finer) = halved(&breaks, &found) else {
            let few = |i: &usize| found.count[*i] < 2 * LEAST;
            let farthest = |i: usize| Some(of[found.far[i]?.1]);
            let mut breaks: Vec<usize> = (0..found.far.len()).filter(few).filter_map(farthest).collect();
            breaks.dedup();
            breaks.retain(|at| 0 < *at && at + 1 < run.len());
            return Err(breaks);
        };
        breaks = finer;
    }
    Err(Vec::new())
}

/// Halving overshoots by up to two. Fewer spans in the same proportions are sought by bisection between half as many and
/// all: the break i of k stands where the spans so far count i/k of all. Of thousands of spans a few are unlucky, and those
/// are halved.
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
    while low + 1 + all / NEAR_ENOUGH < high {
        let k = low.midpoint(high);
        let mut spread: Vec<f64> = (0..=k)
            .map(|i| {
                let x = i as f64 * all as f64 / k as f64;
                let j = (x as usize).min(all - 1);
                breaks[j] + (x - j as f64) * (breaks[j + 1] - breaks[j])
            })
            .collect();
        own.copy_from_slice(at);
        let mut found = None;
        for _ in 0..MENDED {
            let Some(next) = trial(&mut own, places, &spread, tolerance) else { break };
            if next.far.iter().all(Option::is_none) {
                found = Some(next.points);
                break;
            }
            let Some(finer) = halved(&spread, &next) else { break };
            if best.0.len() <= finer.len() {
                break;
            }
            spread = finer;
        }
        match found {
            Some(points) => {
                best = (spread, points);
                high = k;
                at.copy_from_slice(&own);
            }
            None => low = k,
        }
    }
    best
}

/// The breaks with those spans halved that are too far from a point; none where one of them has too few points for that.
fn halved(breaks: &[f64], trial: &Trial) -> Option<Vec<f64>> {
    let mut finer = vec![0.0];
    for (i, far) in trial.far.iter().enumerate() {
        if far.is_some() {
            if trial.count[i] < 2 * LEAST {
                return None;
            }
            finer.push(0.5 * (breaks[i] + breaks[i + 1]));
        }
        finer.push(breaks[i + 1]);
    }
    Some(finer)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::elementary::sin;

    /// The spline of a run that becomes one.
    fn spline(points: &[Position], fitting: Fitting) -> Option<Nurbs> {
        match &parts(points, fitting)?[..] {
            [Part::Spline(spline, last)] if *last + 1 == points.len() => Some(spline.clone()),
            _ => None,
        }
    }

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
        // Both coordinates are off by at most 0.0028, together by less than half of what a point may be off, 0.008.
        for (spacing, noise) in [(0.01, 0.0), (0.1, 0.0), (0.01, 0.0028), (0.1, 0.0028)] {
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
