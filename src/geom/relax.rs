//! One cubic fewer: joints that leave the curve.
//!
//! Cubics whose joints lie on the curve, with its tangents, spend a third of their freedom on that. Where a curve bends much
//! within a tolerance, as small petals do at 1e-3 mm, it is worth more elsewhere. Here a joint J may lie anywhere, and its
//! tangent point anywhere, as long as both cubics share them:
//!
//! ```text
//! J = (1 − λ) L + λ R          L the control point before J, R the one behind, 0 < λ < 1
//! ```
//!
//! The unknowns are L, R and λ of each joint and the two outer tangent lengths; ends and outer tangents stay. The
//! greatest distance from the curve is made small by least squares over places whose weights rise where the distance is
//! great (Lawson, *Contributions to the theory of linear least maximum approximation*, 1961), each step by Gauss, Newton,
//! Levenberg and Marquardt on a band matrix, a joint beside its neighbours. Only distances normal to the curve count, so that
//! all may slide along it. What is found is taken once [`follow`] proves it.

use super::bezier::Bezier;
use super::chain::{Chain, Window};
use super::follow::follow;
use crate::units::{MAX_AXES, Position};

/// Where distances of each cubic are measured, joints included.
const MEASURED: [f64; 14] = [0.0, 0.05, 0.12, 0.2, 0.28, 0.36, 0.45, 0.55, 0.64, 0.72, 0.8, 0.88, 0.95, 1.0];

/// Steps of one fit; most of those that reach their tolerance do so within 100.
const ROUNDS: usize = 120;

/// Steps with equal weights, until the path lies along the curve.
const EQUAL: usize = 12;

/// By then a fit that comes to something is no farther off than this many tolerances.
const HOPEFUL: (usize, f64) = (40, 4.0);

/// The least weight, of a mean of 1: a place near the curve may not be forgotten, or the path swings there.
const LEAST_WEIGHT: f64 = 1.0e-2;

/// The share by which the diagonal is raised at first.
const FIRST_DAMPING: f64 = 1.0e-3;

/// Both tangent lengths of a joint are no less than this share of their sum.
const LEAST_SHARE: f64 = 0.05;

fn dot(a: &Position, b: &Position) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// As few cubics as are found within `tolerance` mm of the curve between the first and the last of `ends`, which has such a
/// fit with these joints; none where no fewer are found.
pub(super) fn fewer(chain: &Chain, ends: &[f64], tolerance: f64) -> Option<Vec<Bezier>> {
    let n = ends.len() - 1;
    let mut found = None;
    // A single cubic has no joint to gain by.
    for m in (2..n).rev() {
        let joint = |i: usize| {
            let at = (i * n) as f64 / m as f64;
            let k = (at as usize).min(n - 1);
            ends[k] + (ends[k + 1] - ends[k]) * (at - k as f64)
        };
        match Path::new(chain, &(0..=m).map(joint).collect::<Vec<_>>()).fitted(tolerance) {
            Some(cubics) => found = Some(cubics),
            None => break,
        }
    }
    found
}

/// Cubics along a part of a curve.
struct Path<'c> {
    window: Window<'c>,
    /// The part of the curve.
    curve: Vec<Bezier>,
    start: (Position, Position),
    end: (Position, Position),
    /// The coordinates that move.
    axes: Vec<usize>,
    /// Where each cubic starts, and how long it is, as shares of the length.
    shares: Vec<(f64, f64)>,
    /// First tangent length; L, R, λ of each joint; last tangent length.
    x: Vec<f64>,
}

/// A place's distance from the curve as a vector, and the curve's direction there.
type Off = (Position, Position);

impl<'c> Path<'c> {
    /// Cubics with joints on the curve at these `ends`, their tangent lengths a third of their lengths.
    fn new(chain: &'c Chain, ends: &[f64]) -> Path<'c> {
        let n = ends.len() - 1;
        let (from, to) = (ends[0], ends[n]);
        let curve: Vec<Bezier> = (from.floor() as usize..to.ceil() as usize)
            .map(|i| {
                let local = |u: f64| (u - i as f64).clamp(0.0, 1.0);
                chain.pieces()[i].segment(local(from), local(to))
            })
            .collect();
        let moves = |axis: &usize| {
            let first = curve[0].start()[*axis];
            curve.iter().any(|piece| piece.control_points().iter().any(|point| point[*axis] != first))
        };
        let axes: Vec<usize> = (0..MAX_AXES).filter(moves).collect();
        let lengths: Vec<f64> =
            ends.windows(2).map(|pair| Window::new(chain, pair[0], pair[1]).length()).collect();
        let total: f64 = lengths.iter().sum();
        let mut x = vec![lengths[0] / 3.0];
        for j in 1..n {
            let (place, tangent) = (chain.eval(ends[j]), chain.tangent_before(ends[j]));
            let (a, b) = (lengths[j - 1] / 3.0, lengths[j] / 3.0);
            x.extend(axes.iter().map(|axis| place[*axis] - a * tangent[*axis]));
            x.extend(axes.iter().map(|axis| place[*axis] + b * tangent[*axis]));
            x.push(a / (a + b));
        }
        x.push(lengths[n - 1] / 3.0);
        let mut at = 0.0;
        let shares = lengths.iter().map(|length| {
            let share = (at, length / total);
            at += share.1;
            share
        });
        Path {
            window: Window::new(chain, from, to),
            start: (chain.eval(from), chain.tangent_behind(from)),
            end: (chain.eval(to), chain.tangent_before(to)),
            shares: shares.collect(),
            curve,
            axes,
            x,
        }
    }

    /// How many unknowns a joint has.
    fn each(&self) -> usize {
        2 * self.axes.len() + 1
    }

    /// L, R and λ of a joint, the first of which is 0.
    fn joint(&self, x: &[f64], j: usize) -> (Position, Position, f64) {
        let own = &x[1 + j * self.each()..];
        let (mut before, mut behind) = (self.start.0, self.start.0);
        for (k, axis) in self.axes.iter().enumerate() {
            before[*axis] = own[k];
            behind[*axis] = own[self.axes.len() + k];
        }
        (before, behind, own[2 * self.axes.len()])
    }

    fn cubics(&self, x: &[f64]) -> Vec<Bezier> {
        let n = self.shares.len();
        let along = |(place, tangent): (Position, Position), length: f64| -> Position {
            std::array::from_fn(|i| place[i] + length * tangent[i])
        };
        let mut at = (self.start.0, along(self.start, x[0]));
        let mut cubics = Vec::with_capacity(n);
        for j in 0..n - 1 {
            let (before, behind, share) = self.joint(x, j);
            let place = std::array::from_fn(|i| (1.0 - share) * before[i] + share * behind[i]);
            cubics.push(Bezier::new(&[at.0, at.1, before, place]));
            at = (place, behind);
        }
        cubics.push(Bezier::new(&[at.0, at.1, along(self.end, -x[x.len() - 1]), self.end.0]));
        cubics
    }

    /// How far each place is off.
    fn offs(&self, x: &[f64]) -> Vec<Off> {
        let mut offs = Vec::with_capacity(self.shares.len() * MEASURED.len());
        for (piece, (at, share)) in self.cubics(x).iter().zip(&self.shares) {
            for t in MEASURED {
                let place = piece.eval(t);
                let (near, derivative) = self.window.nearest(&place, at + t * share);
                let speed = dot(&derivative, &derivative).sqrt();
                let along = if 0.0 < speed { derivative.map(|d| d / speed) } else { [0.0; MAX_AXES] };
                offs.push((std::array::from_fn(|i| place[i] - near[i]), along));
            }
        }
        offs
    }

    /// How a place of cubic `i` moves with the unknowns it depends on.
    fn moves(&self, i: usize, t: f64, moves: &mut Vec<(usize, Position)>) {
        let s = 1.0 - t;
        let b = [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t];
        let (n, m) = (self.shares.len(), self.axes.len());
        // Those of the joint whose place has the factor `at`, L and R the factors of their own.
        let mut joint = |j: usize, at: f64, own: (f64, f64)| {
            let first = 1 + j * self.each();
            let (before, behind, share) = self.joint(&self.x, j);
            for (k, axis) in self.axes.iter().enumerate() {
                let mut unit = [0.0; MAX_AXES];
                unit[*axis] = at * (1.0 - share) + own.0;
                moves.push((first + k, unit));
                unit[*axis] = at * share + own.1;
                moves.push((first + m + k, unit));
            }
            moves.push((first + 2 * m, std::array::from_fn(|c| at * (behind[c] - before[c]))));
        };
        if 0 < i {
            joint(i - 1, b[0], (0.0, b[1]));
        }
        if i + 1 < n {
            joint(i, b[3], (b[2], 0.0));
        }
        if i == 0 {
            moves.push((0, self.start.1.map(|d| b[1] * d)));
        }
        if i + 1 == n {
            moves.push((self.x.len() - 1, self.end.1.map(|d| -b[2] * d)));
        }
    }

    /// The normal equations: their matrix and right side.
    fn normal(&self, offs: &[Off], weights: &[f64]) -> (Band, Vec<f64>) {
        let mut matrix = Band::new(self.x.len(), 2 * self.each());
        let mut right = vec![0.0; self.x.len()];
        let mut moves = Vec::new();
        for (k, ((off, along), weight)) in offs.iter().zip(weights).enumerate() {
            moves.clear();
            self.moves(k / MEASURED.len(), MEASURED[k % MEASURED.len()], &mut moves);
            for (_, v) in &mut moves {
                let share = dot(v, along);
                *v = std::array::from_fn(|i| v[i] - share * along[i]);
            }
            for (r, v) in &moves {
                right[*r] -= weight * dot(v, off);
                for (c, u) in moves.iter().filter(|(c, _)| c <= r) {
                    *matrix.entry(*r, *c) += weight * dot(v, u);
                }
            }
        }
        (matrix, right)
    }

    /// Whether no tangent length vanishes.
    fn is_regular(&self, x: &[f64]) -> bool {
        let joints = self.shares.len() - 1;
        0.0 < x[0].min(x[x.len() - 1])
            && (0..joints).all(|j| (LEAST_SHARE..=1.0 - LEAST_SHARE).contains(&self.joint(x, j).2))
    }

    /// Cubics that are proved to be within the tolerance.
    fn fitted(mut self, tolerance: f64) -> Option<Vec<Bezier>> {
        let mut offs = self.offs(&self.x);
        let mut weights = vec![1.0; offs.len()];
        let mut damping = FIRST_DAMPING;
        let sum = |offs: &[Off], weights: &[f64]| -> f64 {
            offs.iter().zip(weights).map(|((off, _), w)| w * dot(off, off)).sum()
        };
        let mut least = f64::INFINITY;
        for round in 0..ROUNDS {
            let sizes: Vec<f64> = offs.iter().map(|(off, _)| dot(off, off).sqrt()).collect();
            let worst = sizes.iter().fold(0.0f64, |most, x| most.max(*x));
            least = least.min(worst);
            if worst <= tolerance {
                let cubics = self.cubics(&self.x);
                if follow(&cubics, &self.curve, tolerance).is_ok_and(|found| found.distance <= tolerance) {
                    return Some(cubics);
                }
            }
            if round == HOPEFUL.0 && HOPEFUL.1 * tolerance < least {
                return None;
            }
            if EQUAL <= round && 0.0 < worst {
                let mean = weights.iter().zip(&sizes).map(|(w, x)| w * x).sum::<f64>() / sizes.len() as f64;
                for (w, x) in weights.iter_mut().zip(&sizes) {
                    *w = (*w * x / mean).max(LEAST_WEIGHT);
                }
            }
            let (matrix, right) = self.normal(&offs, &weights);
            let now = sum(&offs, &weights);
            let mut stepped = false;
            for _ in 0..8 {
                let step = matrix.damped(damping).solved(&right)?;
                let next: Vec<f64> = self.x.iter().zip(&step).map(|(x, dx)| x + dx).collect();
                if self.is_regular(&next) {
                    let found = self.offs(&next);
                    if sum(&found, &weights) < now {
                        (self.x, offs) = (next, found);
                        stepped = true;
                        break;
                    }
                }
                damping *= 5.0;
            }
            // Where no step leads down, other weights will find one.
            damping = if stepped { (0.3 * damping).max(1.0e-9) } else { FIRST_DAMPING };
        }
        None
    }
}

/// A symmetric matrix that is zero beyond `half` from its diagonal: of row i the columns i − half … i.
#[derive(Clone)]
struct Band {
    half: usize,
    rows: Vec<f64>,
}

impl Band {
    fn new(n: usize, half: usize) -> Band {
        Band { half, rows: vec![0.0; n * (half + 1)] }
    }

    /// Row `i`, column `j` ≤ i.
    fn entry(&mut self, i: usize, j: usize) -> &mut f64 {
        &mut self.rows[i * (self.half + 1) + self.half + j - i]
    }

    fn get(&self, i: usize, j: usize) -> f64 {
        self.rows[i * (self.half + 1) + self.half + j - i]
    }

    /// Its diagonal raised by the share `damping`, and by a little where it vanishes: along a straight part nothing tells
    /// where a joint lies.
    fn damped(&self, damping: f64) -> Band {
        let mut matrix = self.clone();
        let n = self.rows.len() / (self.half + 1);
        let mean = (0..n).map(|i| self.get(i, i)).sum::<f64>() / n as f64;
        for i in 0..n {
            *matrix.entry(i, i) += damping * self.get(i, i) + 1.0e-9 * mean;
        }
        matrix
    }

    /// x of M x = b by Cholesky's M = L Lᵀ; none where M is not positive.
    fn solved(mut self, b: &[f64]) -> Option<Vec<f64>> {
        let n = b.len();
        let first = |i: usize| i.saturating_sub(self.half);
        let bands: Vec<usize> = (0..n).map(first).collect();
        let mut x = b.to_vec();
        for i in 0..n {
            for j in bands[i]..=i {
                let known: f64 = (bands[i]..j)
                    .map(|k| if bands[j] <= k { self.get(i, k) * self.get(j, k) } else { 0.0 })
                    .sum();
                let value = self.get(i, j) - known;
                if i == j && !(0.0 < value) {
                    return None;
                }
                *self.entry(i, j) = if i == j { value.sqrt() } else { value / self.get(j, j) };
            }
            let known: f64 = (bands[i]..i).map(|k| self.get(i, k) * x[k]).sum();
            x[i] = (x[i] - known) / self.get(i, i);
        }
        for i in (0..n).rev() {
            x[i] /= self.get(i, i);
            for k in bands[i]..i {
                x[k] -= self.get(i, k) * x[i];
            }
        }
        Some(x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn a_band_matrix_is_solved() {
        // 4 1 0 / 1 3 1 / 0 1 2 times 1 2 3.
        let mut matrix = Band::new(3, 1);
        for (i, j, value) in [(0, 0, 4.0), (1, 0, 1.0), (1, 1, 3.0), (2, 1, 1.0), (2, 2, 2.0)] {
            *matrix.entry(i, j) = value;
        }
        let x = matrix.solved(&[6.0, 10.0, 8.0]).unwrap();
        for (x, expected) in x.iter().zip([1.0, 2.0, 3.0]) {
            // Some ten roundings of numbers below 10.
            assert_relative_eq!(*x, expected, epsilon = 1e-14);
        }
        // Nothing stands on the diagonal.
        assert_eq!(Band::new(1, 1).solved(&[1.0]), None);
    }
}
