//! Upper bounds on the deviation of one path from another, both made of Bezier pieces, rational or not.
//!
//! The map φ between their parameters is built first, then proved: on each interval the path is one piece p(t), the
//! curve one piece c(u), and u = φ(t) a polynomial of degree 1 to 3 that rises, so that
//!
//! ```text
//! p(t) − c(φ(t)) = [N(t) E(φ(t)) − M(φ(t)) D(t)] / [D(t) E(φ(t))]          p = N/D,  c = M/E
//! ```
//!
//! is a quotient of polynomials. The numerator's Bernstein coefficients, taken as vectors, bound its length; those of D and
//! of E∘φ bound the denominator from below. φ does not have to be the best map: any φ that rises from start to end
//! gives an upper bound.
//!
//! # Which φ
//!
//! First the same parameter, piece by piece, where both have equally many: what an exact conversion makes. Otherwise both are
//! run along together. At each joint of either the nearest place of the other one is looked for, near where the lengths
//! say that it should be; between such places φ is the cubic with the slopes (p′·c′)/(c′·c′) at its ends, flattened
//! where it would fall. Intervals are halved until the bound is within 2 % (and 2 thousandths of the tolerance) of the
//! greatest distance seen.
//!
//! # Directions
//!
//! Where three coordinates are a direction of the tool, only its angle counts, and
//!
//! ```text
//! sin ∠(D_p, D_c) = |D_p × D_c| / (|D_p| |D_c|)
//! ```
//!
//! The cross product is a polynomial; its coefficients, taken as vectors, bound it from above, and the components of those of
//! D_p and D_c∘φ along one direction each bound the lengths from below.
//!
//! # Rounding
//!
//! Every bound is raised by 256 ε (ε = 2.2e-16) of the greatest coordinate: a piece is cut by at most some thirty de
//! Casteljau steps, each within ε/2 of no greater a number, and the products round some 60 times more.

mod along;
mod stream;

pub use stream::{Meeting, Rule, Stream};

use super::bernstein::{Bernstein, MAX_DEGREE};
use super::bezier::Bezier;
use super::deviation::OrderError;
use super::direction;
use crate::units::{MAX_AXES, Position};
use along::{Stand, together};
use std::borrow::Cow;

/// Allowance for rounding, relative to the greatest coordinate.
const ROUNDING: f64 = 256.0 * f64::EPSILON;

/// Halving stops here, and the bound is taken as it is.
const MAX_DEPTH: u32 = 12;

/// How many places of a piece its length is measured at.
const PLACES: usize = 16;

/// What was found of two paths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Followed {
    /// An upper bound on the distance.
    pub distance: f64,
    /// An upper bound on the difference in each coordinate.
    pub axes: [f64; MAX_AXES],
    /// An upper bound on the angle between the directions of the tool, radians; 0 where there are none.
    pub turn: f64,
    /// Which map it holds for.
    pub map: Map,
}

/// The monotone map φ of a bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Map {
    /// The same parameter on each piece.
    Parameter,
    /// Nearest places, joined by rising cubics.
    Nearest,
}

impl Map {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Map::Parameter => "at equal parameters",
            Map::Nearest => "along the path, by a rising map of its own",
        }
    }
}

fn dot(a: &Position, b: &Position) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn minus(a: &Position, b: &Position) -> Position {
    std::array::from_fn(|i| a[i] - b[i])
}

fn distance(a: &Position, b: &Position) -> f64 {
    let d = minus(a, b);
    dot(&d, &d).sqrt()
}

/// The bound for `path` against `curve`, both run from start to end; `tolerance` says how close a look is worth while.
///
/// # Errors
/// A number is not finite, or a path has no piece.
pub fn follow(path: &[Bezier], curve: &[Bezier], tolerance: f64) -> Result<Followed, OrderError> {
    follow_turning(path, curve, None, tolerance)
}

/// The same where three coordinates from `first` on are a direction, at length 1 where the path starts and scaled by `reach`:
/// the angle between the directions is bounded too.
///
/// # Errors
/// As above.
pub fn follow_turning(
    path: &[Bezier],
    curve: &[Bezier],
    direction: Option<(usize, f64)>,
    tolerance: f64,
) -> Result<Followed, OrderError> {
    let finite = |piece: &Bezier| {
        let weights = &piece.weights[..=piece.degree];
        weights.iter().all(|w| 0.0 < *w && w.is_finite())
            && piece.control_points().iter().flatten().all(|x| x.is_finite())
    };
    if path.is_empty() || curve.is_empty() || !path.iter().chain(curve).all(finite) {
        return Err(OrderError::NotFinite);
    }
    let (path, curve) = (&*moving(path), &*moving(curve));
    if path.len() == curve.len() {
        let mut bounds = Bounds::new(path, curve, direction, tolerance);
        if path.iter().zip(curve).all(|(p, c)| at_equal_parameters(p, c, &mut bounds)) {
            return Ok(bounds.found(Map::Parameter));
        }
    }
    let mut bounds = Bounds::new(path, curve, direction, tolerance);
    along(&tamed(path), &tamed(curve), &mut bounds, |_, _| {});
    Ok(bounds.found(Map::Nearest))
}

/// Which pieces of `curve` cannot be said to be within `tolerance` of `path`, both run along together as in [`follow`], in
/// order; both without weights.
pub fn parted(path: &[Bezier], curve: &[Bezier], tolerance: f64) -> Vec<usize> {
    let mut bounds = Bounds::new(path, curve, None, tolerance);
    let mut far = Vec::new();
    along(path, curve, &mut bounds, |bounds, at| {
        if !(bounds.distance <= tolerance) {
            far.push(at);
        }
        // Each interval has a bound of its own, and what was seen elsewhere makes none looser.
        bounds.distance = 0.0;
        bounds.seen = bounds.seen.min(tolerance);
    });
    far.dedup();
    far
}

/// Bounds a piece against a piece with φ the identity; false where that is not within the tolerance.
fn at_equal_parameters(p: &Bezier, c: &Bezier, bounds: &mut Bounds) -> bool {
    let same = Bernstein::new(&[0.0, 1.0]);
    let mut stack = vec![(*p, *c, 0)];
    while let Some((p, c, depth)) = stack.pop() {
        bounds.look(&p, &c);
        if !(bounds.seen <= bounds.tolerance) {
            return false;
        }
        let (most, axes) = difference(bounds, &p, &c, &same);
        let turn = bounds.turn(&p, &c, &same);
        if bounds.is_tight(most, turn) || depth == MAX_DEPTH || bounds.left == 0 {
            bounds.take(most, &axes, turn);
            if !(bounds.distance <= bounds.tolerance) {
                return false;
            }
            continue;
        }
        bounds.left -= 1;
        stack.push((p.segment(0.5, 1.0), c.segment(0.5, 1.0), depth + 1));
        stack.push((p.segment(0.0, 0.5), c.segment(0.0, 0.5), depth + 1));
    }
    true
}

/// The pieces that move; all where none does. One that stands where it is takes no part in a path.
fn moving(pieces: &[Bezier]) -> Cow<'_, [Bezier]> {
    let moves = |piece: &Bezier| piece.control_points().iter().any(|point| *point != piece.points[0]);
    if pieces.iter().all(moves) || !pieces.iter().any(moves) {
        return Cow::Borrowed(pieces);
    }
    Cow::Owned(pieces.iter().copied().filter(moves).collect())
}

/// The greatest ratio of two weights of a piece that is run along as it is.
const TAME: f64 = 3.0;

/// The same path, its pieces halved where weights differ much: there most of the way is run in a small part of the
/// parameter, and nearest places are hard to find.
pub(super) fn tamed(pieces: &[Bezier]) -> Cow<'_, [Bezier]> {
    let wild = |piece: &Bezier| {
        let weights = &piece.weights[..=piece.degree];
        let greatest = weights.iter().copied().fold(0.0, f64::max);
        weights.iter().any(|w| w * TAME < greatest)
    };
    if !pieces.iter().any(wild) {
        return Cow::Borrowed(pieces);
    }
    let mut tame = Vec::with_capacity(pieces.len());
    for piece in pieces {
        let mut stack = vec![(*piece, 0)];
        while let Some((piece, depth)) = stack.pop() {
            if depth == MAX_DEPTH || !wild(&piece) {
                tame.push(piece);
                continue;
            }
            stack.push((piece.segment(0.5, 1.0), depth + 1));
            stack.push((piece.segment(0.0, 0.5), depth + 1));
        }
    }
    Cow::Owned(tame)
}

/// The greatest bounds so far.
struct Bounds {
    distance: f64,
    axes: [f64; MAX_AXES],
    /// The greatest distance that was seen at a place.
    seen: f64,
    tolerance: f64,
    noise: f64,
    /// Coordinates that any point has.
    used: Vec<usize>,
    /// The first component of a direction, and how many mm one of length 1 counts.
    direction: Option<(usize, f64)>,
    /// The greatest angle that is bounded, and the greatest that was seen, radians.
    turned: f64,
    seen_turned: f64,
    /// How many intervals may still be halved.
    left: usize,
}

impl Bounds {
    fn new(path: &[Bezier], curve: &[Bezier], direction: Option<(usize, f64)>, tolerance: f64) -> Bounds {
        let all = || path.iter().chain(curve).flat_map(Bezier::control_points);
        let greatest = |axis: usize| all().fold(0.0, |most, p| f64::max(most, p[axis].abs()));
        let used: Vec<usize> = (0..MAX_AXES).filter(|axis| greatest(*axis) != 0.0).collect();
        let noise = ROUNDING * used.iter().map(|axis| greatest(*axis)).fold(0.0, f64::max);
        let left = 4096 + 64 * (path.len() + curve.len());
        Bounds {
            distance: 0.0,
            axes: [0.0; MAX_AXES],
            seen: 0.0,
            tolerance,
            noise,
            used,
            direction,
            turned: 0.0,
            seen_turned: 0.0,
            left,
        }
    }

    /// Looks at the ends of an interval.
    fn look(&mut self, p: &Bezier, c: &Bezier) {
        for (p, c) in [(p.start(), c.start()), (p.end(), c.end())] {
            self.seen = self.seen.max(distance(&p, &c));
            if let Some((first, _)) = self.direction {
                self.seen_turned = self.seen_turned.max(direction::between(&p, &c, first));
            }
        }
    }

    /// The bound on the angle between the directions at equal t, radians.
    fn turn(&self, p: &Bezier, c: &Bezier, phi: &Bernstein) -> f64 {
        let Some((first, _)) = self.direction else { return 0.0 };
        // The components of N(t) × M(φ(t)); weights divide both factors and leave the angle alone.
        let n = [0, 1, 2].map(|i| p.numerator(first + i));
        let m = [0, 1, 2].map(|i| compose(&c.numerator(first + i), phi));
        let mut squares = [0.0; MAX_DEGREE + 1];
        for (i, j) in [(0, 1), (1, 2), (2, 0)] {
            let cross = n[i].times(&m[j]).combined(1.0, &n[j].times(&m[i]), -1.0);
            for (square, x) in squares.iter_mut().zip(cross.coefficients()) {
                *square += x * x;
            }
        }
        let cross = squares.iter().copied().fold(0.0, f64::max).sqrt();
        // Lengths from below, along one direction each.
        let least = |d: &[Bernstein; 3]| {
            let ends = |f: &Bernstein| f.coefficients()[0] + f.coefficients()[f.degree()];
            let mean = [ends(&d[0]), ends(&d[1]), ends(&d[2])];
            let size = mean.iter().map(|x| x * x).sum::<f64>().sqrt();
            (0..=d[0].degree())
                .map(|k| (0..3).map(|i| d[i].coefficients()[k] * mean[i]).sum::<f64>() / size)
                .fold(f64::INFINITY, f64::min)
        };
        let (p_least, m_least) = (least(&n), least(&m));
        if !(0.0 < p_least && 0.0 < m_least) {
            return f64::INFINITY;
        }
        direction::apart(cross, p_least * m_least).map_or(f64::INFINITY, |angle| angle + ROUNDING)
    }

    fn take(&mut self, distance: f64, axes: &[f64; MAX_AXES], turn: f64) {
        self.turned = self.turned.max(turn);
        self.distance = self.distance.max(distance);
        for (most, axis) in self.axes.iter_mut().zip(axes) {
            *most = most.max(*axis);
        }
    }

    /// Whether a bound is as close to what was seen as is worth while.
    fn is_tight(&self, most: f64, turn: f64) -> bool {
        let turned = self.direction.is_none_or(|(_, reach)| {
            turn * reach <= 1.02 * self.seen_turned * reach + 2.0e-2 * self.tolerance + 2.0 * self.noise
        });
        turned && most <= 1.02 * self.seen + 2.0e-3 * self.tolerance + 2.0 * self.noise
    }

    fn found(&self, map: Map) -> Followed {
        // A sine does not tell an angle from its supplement.
        let opposite = std::f64::consts::FRAC_PI_2 <= self.seen_turned;
        let turn = if opposite { f64::INFINITY } else { self.turned };
        Followed { distance: self.distance, axes: self.axes, turn, map }
    }
}

/// The bound for p(t) − c(φ(t)) on 0 ≤ t ≤ 1, in all and in each coordinate.
fn difference(bounds: &Bounds, p: &Bezier, c: &Bezier, phi: &Bernstein) -> (f64, [f64; MAX_AXES]) {
    // Coordinates are taken from the start of p, so that little is lost in the products.
    let origin = p.start();
    let shifted = |piece: &Bezier, axis: usize| {
        let mut own = *piece;
        for point in &mut own.points[..=piece.degree] {
            point[axis] -= origin[axis];
        }
        own.numerator(axis)
    };
    let rational = !(p.is_polynomial() && c.is_polynomial());
    let below = rational.then(|| (p.denominator(), compose(&c.denominator(), phi)));
    let least = match &below {
        Some((d, e)) => d.min() * e.min(),
        None => p.weights[0] * c.weights[0],
    };
    if !(0.0 < least) {
        return (f64::INFINITY, [f64::INFINITY; MAX_AXES]);
    }
    let mut axes = [0.0; MAX_AXES];
    let mut squares = [0.0; MAX_DEGREE + 1];
    for &axis in &bounds.used {
        let (n, m) = (shifted(p, axis), compose(&shifted(c, axis), phi));
        let f = match &below {
            Some((d, e)) => n.times(e).combined(1.0, &m.times(d), -1.0),
            None => n.combined(c.weights[0], &m, -p.weights[0]),
        };
        for (square, x) in squares.iter_mut().zip(f.coefficients()) {
            *square += x * x;
        }
        axes[axis] = f.max_abs() / least + bounds.noise;
    }
    // All coordinates have one degree, so that their coefficients together are the control points of the difference.
    let most = squares.iter().copied().fold(0.0, f64::max).sqrt();
    (most / least + bounds.noise, axes)
}

/// f∘φ by de Casteljau's scheme in polynomials: f_i ← (1 − φ) f_i + φ f_{i+1}.
fn compose(f: &Bernstein, phi: &Bernstein) -> Bernstein {
    let m = f.degree();
    if phi.coefficients() == [0.0, 1.0] {
        return *f;
    }
    let rest = phi.scaled(-1.0, 1.0);
    let mut q: Vec<Bernstein> = f.coefficients().iter().map(|c| Bernstein::new(&[*c])).collect();
    for r in 1..=m {
        for i in 0..=m - r {
            q[i] = rest.times(&q[i]).combined(1.0, &phi.times(&q[i + 1]), 1.0);
        }
    }
    q[0]
}

/// φ with the slopes of nearest places at both ends, of the greatest degree that the products leave room for.
fn rising(p: &Bezier, c: &Bezier, turning: bool) -> Bernstein {
    let linear = Bernstein::new(&[0.0, 1.0]);
    let slope = |t: f64| {
        let ([_, p1, _], [_, c1, _]) = (p.derivatives(t), c.derivatives(t));
        dot(&p1, &c1) / dot(&c1, &c1)
    };
    let rational = !(p.is_polynomial() && c.is_polynomial());
    let room = if rational || turning { MAX_DEGREE - p.degree } else { MAX_DEGREE };
    let (first, last) = (slope(0.0).clamp(0.0, 3.0), slope(1.0).clamp(0.0, 3.0));
    if !(first.is_finite() && last.is_finite()) {
        return linear;
    }
    if 3 * c.degree <= room {
        let (a, b) = (first / 3.0, 1.0 - last / 3.0);
        // Coefficients that rise make a polynomial that rises.
        let (a, b) = if a <= b { (a, b) } else { (0.5 * (a + b), 0.5 * (a + b)) };
        return Bernstein::new(&[0.0, a, b, 1.0]);
    }
    if 2 * c.degree <= room {
        return Bernstein::new(&[0.0, (0.25 * (first + 2.0 - last)).clamp(0.0, 1.0), 1.0]);
    }
    linear
}

/// The place of `piece` between `low` and `high` that is nearest to `q`, near `guess`, by Newton's method.
pub(super) fn foot(piece: &Bezier, q: &Position, guess: f64, low: f64, high: f64) -> f64 {
    let mut t = guess.clamp(low, high);
    for _ in 0..12 {
        let [p, p1, p2] = piece.derivatives(t);
        let d = minus(&p, q);
        let (g, speed) = (dot(&d, &p1), dot(&p1, &p1));
        let h = speed + dot(&d, &p2);
        // Where the curvature misleads, a step along the tangent.
        let step = if 0.1 * speed < h { g / h } else { g / speed };
        if !step.is_finite() {
            break;
        }
        let next = (t - step).clamp(low, high);
        let moved = (next - t).abs();
        t = next;
        if moved <= 1.0e-15 {
            break;
        }
    }
    t
}

/// Bounds one interval: p and c as they are there.
fn interval(p: &Bezier, c: &Bezier, bounds: &mut Bounds) {
    let mut stack = vec![(*p, *c, 0)];
    while let Some((p, c, depth)) = stack.pop() {
        bounds.look(&p, &c);
        let phi = rising(&p, &c, bounds.direction.is_some());
        let (mut most, mut axes) = difference(bounds, &p, &c, &phi);
        let turn = bounds.turn(&p, &c, &phi);
        // Where c stands at an end nearest places have no slope there.
        if bounds.direction.is_none()
            && stands(&c)
            && let Some(other) = projected(bounds, &p, &c)
            && other.0 < most
        {
            (most, axes) = other;
        }
        if bounds.is_tight(most, turn) || depth == MAX_DEPTH || bounds.left == 0 {
            bounds.take(most, &axes, turn);
            continue;
        }
        bounds.left -= 1;
        let u = foot(&c, &p.eval(0.5), phi.eval(0.5), 0.0, 1.0);
        stack.push((p.segment(0.5, 1.0), c.segment(u, 1.0), depth + 1));
        stack.push((p.segment(0.0, 0.5), c.segment(0.0, u), depth + 1));
    }
}

/// Whether a piece stands at its start or end: two control points there are one, to rounding.
fn stands(piece: &Bezier) -> bool {
    let (points, m) = (piece.control_points(), piece.degree);
    let whole = distance(&points[0], &points[m]);
    1 < m && distance(&points[0], &points[1]).min(distance(&points[m - 1], &points[m])) <= 1.0e-9 * whole
}

/// The bound for a straight p against c where φ is the inverse of c's projection onto p, in all and in each coordinate; none
/// where that does not rise. It does where that of the control points does, and by the convex hull no point of c is farther
/// from its foot than a control point from its own. Where the first foot is not p's start c waits while p comes there, and
/// at the end likewise.
fn projected(bounds: &Bounds, p: &Bezier, c: &Bezier) -> Option<(f64, [f64; MAX_AXES])> {
    let (from, to) = (p.start(), p.end());
    let way = minus(&to, &from);
    let square = dot(&way, &way);
    if p.degree != 1 || !p.is_polynomial() || !(0.0 < square) {
        return None;
    }
    let (mut most, mut axes, mut reached) = (0.0f64, [0.0f64; MAX_AXES], 0.0f64);
    let mut meet = |point: &Position, foot: &Position| {
        most = most.max(distance(point, foot));
        for (axis, (p, q)) in axes.iter_mut().zip(point.iter().zip(foot)) {
            *axis = axis.max((p - q).abs());
        }
    };
    for point in c.control_points() {
        let s = (dot(&minus(point, &from), &way) / square).clamp(0.0, 1.0);
        if s < reached {
            return None;
        }
        reached = s;
        meet(point, &std::array::from_fn(|i| from[i] + s * way[i]));
    }
    meet(&c.start(), &from);
    meet(&c.end(), &to);
    Some((most + bounds.noise, axes.map(|axis| axis + bounds.noise)))
}

/// One of the two paths, and where it has been run to.
struct Runner<'a> {
    pieces: &'a [Bezier],
    /// Which piece it stands on.
    at: usize,
    stand: Option<Stand>,
}

impl<'a> Runner<'a> {
    fn new(pieces: &'a [Bezier]) -> Runner<'a> {
        Runner { pieces, at: 0, stand: pieces.first().map(Stand::new) }
    }

    /// Takes the part up to `t`; at 1 the next piece begins.
    fn take(&mut self, t: f64) -> Option<Bezier> {
        let stand = self.stand.as_mut()?;
        let part = stand.part(t);
        stand.t = t;
        if t == 1.0 {
            self.at += 1;
            self.stand = self.pieces.get(self.at).map(Stand::new);
        }
        Some(part)
    }
}

/// Runs along both and bounds every interval; `met` is told the piece of `curve` that it belongs to.
fn along(path: &[Bezier], curve: &[Bezier], bounds: &mut Bounds, mut met: impl FnMut(&mut Bounds, usize)) {
    let (mut p, mut c) = (Runner::new(path), Runner::new(curve));
    loop {
        let at = c.at;
        let (to_p, to_c) = match (&p.stand, &c.stand) {
            (None, None) => return,
            // One has ended: it waits where it is for the other.
            (Some(_), None) => {
                let end = curve[curve.len() - 1].end();
                if let Some(part) = p.take(1.0) {
                    interval(&part, &Bezier::line(end, end), bounds);
                    met(bounds, at.min(curve.len() - 1));
                }
                continue;
            }
            (None, Some(_)) => {
                let end = path[path.len() - 1].end();
                if let Some(part) = c.take(1.0) {
                    interval(&Bezier::line(end, end), &part, bounds);
                    met(bounds, at);
                }
                continue;
            }
            (Some(own), Some(other)) => together(own, other, bounds.tolerance),
        };
        if let (Some(part), Some(other)) = (p.take(to_p), c.take(to_c)) {
            interval(&part, &other, bounds);
            met(bounds, at);
        }
    }
}

#[cfg(test)]
mod tests;
