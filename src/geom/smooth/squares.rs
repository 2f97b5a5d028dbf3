//! Least squares with cubic B-splines on simple knots.

use crate::units::{MAX_AXES, Position};

/// The four cubic B-splines that are not zero on a span, and their derivatives; simple inner knots and four-fold ends, by Cox
/// and de Boor.
pub(super) fn basis(breaks: &[f64], span: usize, t: f64) -> ([f64; 4], [f64; 4]) {
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
pub(super) fn solve(at: &[f64], places: &[Position], breaks: &[f64]) -> Option<Vec<Position>> {
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
