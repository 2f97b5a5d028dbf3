//! How few cubics a fit takes, against the best there are.
//!
//! For standard curves the number n of cubics is at most ⌈1.5 n₀⌉ + 1, n₀ the number of best cubics on free ends: each
//! interval's cubic is sought among all, with no tangents and no joints asked for, so that its greatest distance is
//! least, and intervals are made as long as the tolerance allows.

#![allow(
    clippy::disallowed_methods,
    reason = "the curves and the best cubics share no code with the crate; nothing here goes into a golden file"
)]

use splinepost::geom::bezier::Bezier;
use splinepost::geom::chain::Chain;
use splinepost::geom::follow::follow;
use splinepost::geom::geometric::cubics;
use splinepost::units::Position;
use std::f64::consts::PI;

/// A curve in the plane and its derivative.
struct Standard {
    name: &'static str,
    at: fn(f64) -> [f64; 2],
    to: f64,
}

fn clothoid(u: f64) -> [f64; 2] {
    // ∫ cos(s²/2), ∫ sin(s²/2) by Simpson's rule on 64 parts: right to 1e-12 for u ≤ 4.
    let n = 64;
    let h = u / f64::from(n);
    let sum = |f: fn(f64) -> f64| {
        (0..n)
            .map(|k| {
                let s = f64::from(k) * h;
                f(0.5 * s * s) + 4.0 * f(0.5 * (s + 0.5 * h).powi(2)) + f(0.5 * (s + h).powi(2))
            })
            .sum::<f64>()
            * h
            / 6.0
    };
    [10.0 * sum(f64::cos), 10.0 * sum(f64::sin)]
}

const CURVES: &[Standard] = &[
    Standard { name: "circle", at: |u| [10.0 * u.cos(), 10.0 * u.sin()], to: 2.0 * PI },
    Standard { name: "ellipse", at: |u| [20.0 * u.cos(), 8.0 * u.sin()], to: 2.0 * PI },
    Standard {
        name: "butterfly",
        at: |u| {
            let r = 5.0 * (u.cos().exp() - 2.0 * (4.0 * u).cos() + (u / 12.0).sin().powi(5));
            [r * u.sin(), r * u.cos()]
        },
        to: 2.0 * PI,
    },
    Standard {
        name: "involute",
        at: |u| [5.0 * (u.cos() + u * u.sin()), 5.0 * (u.sin() - u * u.cos())],
        to: 5.0,
    },
    Standard { name: "clothoid", at: clothoid, to: 4.0 },
    Standard { name: "sine", at: |u| [5.0 * u, 5.0 * u.sin()], to: 4.0 * PI },
];

/// The curve as quintics with its ends and two derivatives, by differences: 400 of them, within 1e-8 mm.
fn chain(curve: &Standard) -> Vec<Bezier> {
    let n = 400;
    let h = curve.to / f64::from(n);
    let place = |p: [f64; 2]| -> Position { [p[0], p[1], 0.0, 0.0, 0.0, 0.0] };
    let jet = |u: f64| {
        let e = 1.0e-3;
        let f = |k: f64| (curve.at)(u + k * e);
        let [a, b, c, d, m] = [f(-2.0), f(-1.0), f(1.0), f(2.0), f(0.0)];
        let first: [f64; 2] = std::array::from_fn(|i| (a[i] - 8.0 * b[i] + 8.0 * c[i] - d[i]) / (12.0 * e));
        let second: [f64; 2] = std::array::from_fn(|i| {
            (-a[i] + 16.0 * b[i] - 30.0 * m[i] + 16.0 * c[i] - d[i]) / (12.0 * e * e)
        });
        (m, first, second)
    };
    (0..n)
        .map(|k| {
            let (p, dp, ddp) = jet(f64::from(k) * h);
            let (q, dq, ddq) = jet(f64::from(k + 1) * h);
            let point = |c: [f64; 3], from: [f64; 2], d: [f64; 2], dd: [f64; 2]| {
                place(std::array::from_fn(|i| c[0] * from[i] + c[1] * h * d[i] + c[2] * h * h * dd[i]))
            };
            Bezier::new(&[
                place(p),
                point([1.0, 0.2, 0.0], p, dp, ddp),
                point([1.0, 0.4, 0.05], p, dp, ddp),
                point([1.0, -0.4, 0.05], q, dq, ddq),
                point([1.0, -0.2, 0.0], q, dq, ddq),
                place(q),
            ])
        })
        .collect()
}

/// The curve's place at a float of pieces, and its unit normal.
struct Target<'c> {
    chain: &'c Chain,
}

impl Target<'_> {
    /// The signed distance of `q` from the curve near u, normal to it, by Newton's method; and the normal.
    fn off(&self, q: [f64; 2], mut u: f64) -> (f64, [f64; 2]) {
        let mut normal = [0.0; 2];
        let mut off = 0.0;
        for _ in 0..8 {
            let u_in = u.clamp(0.0, self.chain.end());
            let (i, t) = self.chain.at(u_in);
            let [p, d, dd] = self.chain.pieces()[i].derivatives(t);
            let r = [q[0] - p[0], q[1] - p[1]];
            let speed = d[0] * d[0] + d[1] * d[1];
            let size = speed.sqrt();
            normal = [-d[1] / size, d[0] / size];
            off = r[0] * normal[0] + r[1] * normal[1];
            let step = (r[0] * d[0] + r[1] * d[1]) / (speed - (r[0] * dd[0] + r[1] * dd[1]));
            if !step.is_finite() || step.abs() < 1.0e-12 {
                break;
            }
            u = u_in + step.clamp(-0.5, 0.5);
        }
        (off, normal)
    }
}

const PLACES: usize = 41;

/// The least greatest distance of any cubic from the curve between two values of u, its ends where they like: Gauss and
/// Newton's steps on all eight coordinates, with weights after Lawson that rise where the distance is greatest. What is
/// found is no less than the least there is, which is on the side of the test only by some percent.
fn best(target: &Target<'_>, from: f64, to: f64) -> f64 {
    let chain = target.chain;
    let mut points = [[0.0f64; 2]; 4];
    let (a, b) = (chain.eval(from), chain.eval(to));
    let (ta, tb) = (chain.tangent_behind(from), chain.tangent_before(to));
    let length: f64 = (0..32)
        .map(|k| {
            let at = |k: i32| chain.eval(from + (to - from) * f64::from(k) / 32.0);
            let (p, q) = (at(k), at(k + 1));
            ((p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2)).sqrt()
        })
        .sum();
    for i in 0..2 {
        points[0][i] = a[i];
        points[1][i] = a[i] + ta[i] * length / 3.0;
        points[2][i] = b[i] - tb[i] * length / 3.0;
        points[3][i] = b[i];
    }
    let places: Vec<f64> =
        (0..PLACES).map(|k| 0.5 - 0.5 * (PI * k as f64 / (PLACES - 1) as f64).cos()).collect();
    let basis = |t: f64| {
        let s = 1.0 - t;
        [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t]
    };
    let mut weights = [1.0; PLACES];
    let mut least = f64::INFINITY;
    for round in 0..60 {
        // 8 unknowns: normal equations with a little damping, since the pace along the curve is free.
        let mut m = [[0.0f64; 9]; 8];
        let mut offs = [0.0f64; PLACES];
        for (k, t) in places.iter().enumerate() {
            let b = basis(*t);
            let q: [f64; 2] = std::array::from_fn(|i| (0..4).map(|j| b[j] * points[j][i]).sum());
            let (off, normal) = target.off(q, from + (to - from) * t);
            offs[k] = off;
            let row: [f64; 8] = std::array::from_fn(|c| b[c / 2] * normal[c % 2]);
            for i in 0..8 {
                for j in 0..8 {
                    m[i][j] += weights[k] * row[i] * row[j];
                }
                m[i][8] -= weights[k] * row[i] * off;
            }
        }
        let worst = offs.iter().fold(0.0f64, |most, x| most.max(x.abs()));
        least = least.min(worst);
        let trace: f64 = (0..8).map(|i| m[i][i]).sum();
        for (i, row) in m.iter_mut().enumerate() {
            row[i] += 1.0e-9 * trace;
        }
        for (c, x) in solve(m).iter().enumerate() {
            points[c / 2][c % 2] += x;
        }
        if 6 < round {
            let sum: f64 = weights.iter().zip(&offs).map(|(w, x)| w * x.abs()).sum();
            for (w, x) in weights.iter_mut().zip(&offs) {
                *w = (*w * x.abs() / sum * PLACES as f64).max(1.0e-6);
            }
        }
    }
    least
}

/// Gauss's elimination with pivots.
fn solve(mut m: [[f64; 9]; 8]) -> [f64; 8] {
    for i in 0..8 {
        let pivot = (i..8).max_by(|a, b| m[*a][i].abs().total_cmp(&m[*b][i].abs())).expect("rows");
        m.swap(i, pivot);
        for r in i + 1..8 {
            let share = m[r][i] / m[i][i];
            for c in i..9 {
                m[r][c] -= share * m[i][c];
            }
        }
    }
    let mut x = [0.0; 8];
    for i in (0..8).rev() {
        x[i] = (m[i][8] - (i + 1..8).map(|c| m[i][c] * x[c]).sum::<f64>()) / m[i][i];
    }
    x
}

/// How many best cubics the curve needs.
fn fewest(chain: &Chain, tolerance: f64) -> usize {
    let target = Target { chain };
    let (mut at, mut n) = (0.0, 0);
    while at < chain.end() {
        n += 1;
        if best(&target, at, chain.end()) <= tolerance {
            return n;
        }
        let (mut low, mut high) = (at, chain.end());
        // From a short interval upwards, so that no accident of a long one is taken for an answer.
        let mut step = 4.0f64;
        while at + step < chain.end() && best(&target, at, at + step) <= tolerance {
            low = at + step;
            step *= 1.6;
        }
        high = high.min(at + step);
        for _ in 0..12 {
            let middle = 0.5 * (low + high);
            if best(&target, at, middle) <= tolerance {
                low = middle;
            } else {
                high = middle;
            }
        }
        assert!(at < low, "no interval at {at}");
        at = low;
    }
    n
}

#[test]
fn fits_are_close_to_the_best_there_are() {
    let mut wrong = Vec::new();
    for curve in CURVES {
        let pieces = chain(curve);
        let chain = Chain::new(&pieces).expect("a curve");
        for tolerance in [1.0e-3, 1.0e-5] {
            let fitted = cubics(&chain, tolerance).expect("a fit");
            let found = follow(&fitted, &pieces, tolerance).expect("a bound");
            let (n, n0) = (fitted.len(), fewest(&chain, tolerance));
            println!("{} at {tolerance:e}: n = {n}, n0 = {n0}, bound {:.3e} mm", curve.name, found.distance);
            let most = (1.5 * n0 as f64).ceil() as usize + 1;
            if !(n <= most && found.distance <= tolerance) {
                wrong.push(format!(
                    "{} at {tolerance:e}: {n}, best {n0}, bound {:e}",
                    curve.name, found.distance
                ));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
