//! What holds for every spline: changes of form leave the curve alone.
//!
//! Expected values come from the basis functions by their recursion,
//!
//! ```text
//! N_{i,0} = 1 on t_i ≤ t < t_{i+1}, otherwise 0
//! N_{i,k} = (t − t_i)/(t_{i+k} − t_i) N_{i,k−1} + (t_{i+k+1} − t)/(t_{i+k+1} − t_{i+1}) N_{i+1,k−1}
//! ```
//!
//! which the crate itself does not use: it has blossoms only.

use super::bezier::{Bezier, MAX_PIECE_DEGREE};
use super::nurbs::Nurbs;
use crate::units::Position;
use proptest::prelude::*;

/// The greatest coordinate.
const SIZE: f64 = 100.0;

/// Roundings of mixtures with shares within 0 … 1, weights in and out: some ten for each of five steps, on both sides.
const MIXED: f64 = 100.0 * f64::EPSILON * SIZE;

/// Knots that need not be clamped, with points and weights.
#[derive(Clone, Debug)]
struct Spline {
    degree: usize,
    knots: Vec<f64>,
    points: Vec<Position>,
    weights: Vec<f64>,
}

impl Spline {
    fn range(&self) -> (f64, f64) {
        (self.knots[self.degree], self.knots[self.points.len()])
    }

    /// N_{0,p}(t) … N_{n,p}(t).
    fn basis(&self, t: f64) -> Vec<f64> {
        let spans = (self.degree..self.points.len()).filter(|j| self.knots[*j] < self.knots[j + 1]);
        let span = spans.filter(|j| self.knots[*j] <= t).max().expect("within the range");
        let mut basis: Vec<f64> = (0..self.knots.len() - 1).map(|i| f64::from(u8::from(i == span))).collect();
        for k in 1..=self.degree {
            let share = |i: usize, part: f64| {
                let width = self.knots[i + k] - self.knots[i];
                if 0.0 < width { part / width } else { 0.0 }
            };
            basis = (0..basis.len() - 1)
                .map(|i| {
                    share(i, t - self.knots[i]) * basis[i]
                        + share(i + 1, self.knots[i + k + 1] - t) * basis[i + 1]
                })
                .collect();
        }
        basis
    }

    fn eval(&self, t: f64) -> Position {
        let basis = self.basis(t);
        let sum =
            |of: &dyn Fn(usize) -> f64| -> f64 { basis.iter().enumerate().map(|(i, b)| b * of(i)).sum() };
        let below = sum(&|i| self.weights[i]);
        std::array::from_fn(|axis| sum(&|i| self.weights[i] * self.points[i][axis]) / below)
    }

    fn nurbs(&self) -> Nurbs {
        Nurbs::new(self.degree, self.knots.clone(), self.points.clone(), self.weights.clone()).unwrap()
    }

    /// The ratio of the greatest weight and the least, and the shortest span.
    fn ratio_and_span(&self) -> (f64, f64) {
        let (least, most) =
            self.weights.iter().fold((f64::INFINITY, 0.0f64), |(a, b), w| (a.min(*w), b.max(*w)));
        let spans = self.knots.windows(2).map(|pair| pair[1] - pair[0]);
        (most / least, spans.filter(|span| 0.0 < *span).fold(f64::INFINITY, f64::min))
    }

    /// How far the curve moves where a parameter or a knot is off by some four roundings: |P′| is at most p times the ratio of
    /// the weights times the polygon's size over the shortest span (Floater, *Derivatives of rational Bezier curves*, 1992).
    fn drift(&self) -> f64 {
        let (ratio, shortest) = self.ratio_and_span();
        // Six coordinates: the size is at most 2·√6 of the greatest.
        let speed = self.degree as f64 * ratio * 5.0 * SIZE / shortest;
        4.0 * f64::EPSILON * self.range().1.abs().max(1.0) * speed
    }

    /// Roundings of blossoms that are asked for outside their span: each step may magnify them by 1 + 2A, A the ratio of the
    /// widest support and the shortest span, and weights by their ratio.
    fn magnified(&self) -> f64 {
        let (ratio, shortest) = self.ratio_and_span();
        let supports = self.knots.windows((2 * self.degree + 2).min(self.knots.len()));
        let widest = supports.map(|knots| knots[knots.len() - 1] - knots[0]).fold(0.0, f64::max);
        let step = 1.0 + 2.0 * widest / shortest;
        (0..self.degree).fold(MIXED * ratio, |error, _| error * step)
    }
}

fn points(n: usize, axes: usize) -> impl Strategy<Value = Vec<Position>> {
    let ordinates = prop::collection::vec(-SIZE..SIZE, axes);
    let point = ordinates.prop_map(|own| std::array::from_fn(|i| own.get(i).copied().unwrap_or(0.0)));
    prop::collection::vec(point, n)
}

/// All alike in one case of four.
fn weights(n: usize, choice: &'static [f64]) -> impl Strategy<Value = Vec<f64>> {
    prop_oneof![
        1 => Just(vec![1.0; n]),
        3 => prop::collection::vec(prop::sample::select(choice), n),
    ]
}

const FAR: &[f64] = &[0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0];
const NEAR: &[f64] = &[0.3, 1.0, 3.0];

fn with_points(degree: usize, knots: Vec<f64>, choice: &'static [f64]) -> impl Strategy<Value = Spline> {
    let n = knots.len() - degree - 1;
    (2..=6usize)
        .prop_flat_map(move |axes| (points(n, axes), weights(n, choice)))
        .prop_map(move |(points, weights)| Spline { degree, knots: knots.clone(), points, weights })
}

/// Values `first` + steps, each as often as it says.
fn repeated(first: f64, steps: &[(f64, usize)]) -> Vec<f64> {
    let mut at = first;
    let runs = steps.iter().flat_map(|(step, times)| {
        at += step;
        std::iter::repeat_n(at, *times)
    });
    runs.collect()
}

/// Clamped splines of degree 1 to `degree`, inner knots up to p-fold.
fn clamped(degree: usize, choice: &'static [f64]) -> impl Strategy<Value = Spline> {
    (1..=degree)
        .prop_flat_map(|p| (Just(p), prop::collection::vec((0.5..2.0f64, 1..=p), 0..4), 0.5..2.0f64))
        .prop_flat_map(move |(p, mut steps, last)| {
            steps.insert(0, (0.0, p + 1));
            steps.push((last, p + 1));
            with_points(p, repeated(0.0, &steps), choice)
        })
}

/// Splines that are clamped nowhere, or partly, knots up to p-fold.
fn unclamped() -> impl Strategy<Value = Spline> {
    (1..=MAX_PIECE_DEGREE)
        .prop_flat_map(|p| (Just(p), prop::collection::vec((0.5..2.0f64, 1..=p), 2 * p + 2..2 * p + 6)))
        .prop_flat_map(|(p, steps)| with_points(p, repeated(-3.0, &steps), NEAR))
}

/// Closed splines: the first p points come again, and the first spans with them.
fn periodic() -> impl Strategy<Value = Spline> {
    (1..=MAX_PIECE_DEGREE)
        .prop_flat_map(|p| (Just(p), prop::collection::vec(0.5..2.0f64, p + 2..p + 6)))
        .prop_flat_map(|(p, spans)| {
            let n = spans.len();
            // Knots t_{-p} … t_{n+p}, the range is t_0 … t_n.
            let steps: Vec<(f64, usize)> = (0..n + 2 * p).map(|i| (spans[(i + n - p) % n], 1)).collect();
            let mut knots = vec![0.0];
            knots.extend(repeated(0.0, &steps));
            with_points(p, knots, NEAR).prop_map(move |mut spline| {
                for i in 0..p {
                    spline.points[n + i] = spline.points[i];
                    spline.weights[n + i] = spline.weights[i];
                }
                spline
            })
        })
}

fn near(a: &Position, b: &Position, allowed: f64) -> Result<(), TestCaseError> {
    for (x, y) in a.iter().zip(b) {
        prop_assert!((x - y).abs() <= allowed, "{} and {}, apart {:e}, allowed {:e}", x, y, x - y, allowed);
    }
    Ok(())
}

/// The same curve at 41 places.
fn same(found: &Nurbs, spline: &Spline, allowed: f64) -> Result<(), TestCaseError> {
    let (from, to) = spline.range();
    for i in 0..=40 {
        let t = if i == 40 { to } else { from + (to - from) * f64::from(i) / 40.0 };
        near(&found.eval(t), &spline.eval(t), allowed)?;
    }
    Ok(())
}

proptest! {
    #[test]
    fn basis_functions_add_up_to_one(spline in clamped(MAX_PIECE_DEGREE, FAR), share in 0.0..=1.0f64) {
        let (from, to) = spline.range();
        let t = from + (to - from) * share;
        prop_assert!((spline.basis(t).iter().sum::<f64>() - 1.0).abs() <= MIXED / SIZE);
        // So a spline whose points are one place stays there, whatever its weights.
        let place = spline.points[0];
        near(&spline.nurbs().mapped(|_| place).eval(t), &place, MIXED)?;
    }

    #[test]
    fn values_are_those_of_the_basis_functions(spline in clamped(MAX_PIECE_DEGREE, FAR)) {
        // A share and 1 − share round apart, as if the parameter did; weights make the curve fast there.
        same(&spline.nurbs(), &spline, MIXED + spline.drift())?;
    }

    #[test]
    fn knot_insertion_leaves_the_curve_alone(
        spline in clamped(MAX_PIECE_DEGREE, FAR),
        share in 0.01..0.99f64,
    ) {
        let (from, to) = spline.range();
        let t = from + (to - from) * share;
        let mut finer = spline.nurbs();
        // Up to p-fold, where the curve's own point is a control point.
        for _ in 0..spline.degree {
            finer = finer.with_knot(t);
        }
        prop_assert_eq!(finer.points().len(), spline.points.len() + spline.degree);
        let allowed = 2.0 * MIXED + spline.drift();
        same(&finer, &spline, allowed)?;
        let at = finer.knots().partition_point(|k| *k < t);
        near(&finer.points()[at - 1], &spline.eval(t), allowed)?;
    }

    #[test]
    fn elevation_leaves_the_curve_alone(spline in clamped(MAX_PIECE_DEGREE - 1, NEAR)) {
        let raised = spline.nurbs().elevated().unwrap();
        prop_assert_eq!(raised.degree(), spline.degree + 1);
        same(&raised, &spline, spline.magnified())?;
    }

    #[test]
    fn pieces_are_the_curve_and_join_back_to_it(spline in clamped(MAX_PIECE_DEGREE, FAR)) {
        let allowed = 2.0 * MIXED + spline.drift();
        let nurbs = spline.nurbs();
        let (pieces, lengths): (Vec<Bezier>, Vec<f64>) = nurbs.beziers().unzip();
        let mut joints = spline.knots.clone();
        joints.dedup();
        prop_assert_eq!(pieces.len(), joints.len() - 1);
        for (piece, ends) in pieces.iter().zip(joints.windows(2)) {
            for k in 0..=8 {
                let s = f64::from(k) / 8.0;
                // The oracle takes a joint from the right, which is the same place.
                near(&piece.eval(s), &spline.eval(ends[0] + (ends[1] - ends[0]) * s), allowed)?;
            }
        }
        // Knots less than p-fold have one tangent in homogeneous coordinates.
        let times = |t: f64| spline.knots.iter().filter(|k| **k == t).count();
        let smooth: Vec<bool> = joints[1..pieces.len()].iter().map(|t| times(*t) < spline.degree).collect();
        let back = Nurbs::joined(&pieces, &lengths, &smooth).unwrap();
        let dropped = smooth.iter().filter(|smooth| **smooth).count();
        prop_assert_eq!(back.points().len(), spline.degree * pieces.len() + 1 - dropped);
        // Spans are added up again, so that knots differ by roundings.
        same(&back, &spline, allowed)?;
    }

    #[test]
    fn clamping_leaves_the_curve_alone(spline in prop_oneof![unclamped(), periodic()]) {
        let own = spline.clone();
        let found = Nurbs::clamped(own.degree, own.knots, own.points, own.weights).unwrap();
        let (from, to) = spline.range();
        let p = spline.degree;
        prop_assert!(found.knots()[..=p].iter().all(|t| *t == from));
        prop_assert!(found.knots()[found.points().len()..].iter().all(|t| *t == to));
        same(&found, &spline, spline.magnified())?;
    }

    #[test]
    fn a_closed_curve_is_still_closed_when_clamped(spline in periodic()) {
        let allowed = spline.magnified();
        let found = Nurbs::clamped(spline.degree, spline.knots, spline.points, spline.weights).unwrap();
        near(&found.points()[0], &found.points()[found.points().len() - 1], allowed)?;
    }

    #[test]
    fn a_piece_split_and_raised_is_the_same_piece(
        (points, weights) in (2..=MAX_PIECE_DEGREE + 1).prop_flat_map(|n| (points(n, 6), weights(n, FAR))),
        at in 0.05..0.95f64,
    ) {
        let degree = points.len() - 1;
        let mut piece = Bezier::new(&points);
        piece.weights[..=degree].copy_from_slice(&weights);
        let knots = repeated(0.0, &[(0.0, degree + 1), (1.0, degree + 1)]);
        let spline = Spline { degree, knots, points, weights };
        let parts = [piece.segment(0.0, at), piece.segment(at, 1.0)];
        let raised = piece.raised_to(MAX_PIECE_DEGREE);
        prop_assert_eq!(raised.degree, MAX_PIECE_DEGREE);
        let allowed = 2.0 * MIXED + spline.drift();
        for k in 0..=16 {
            let s = f64::from(k) / 16.0;
            near(&raised.eval(s), &spline.eval(s), allowed)?;
            near(&parts[0].eval(s), &spline.eval(at * s), allowed)?;
            near(&parts[1].eval(s), &spline.eval(at + (1.0 - at) * s), allowed)?;
        }
        near(&parts[0].end(), &parts[1].start(), MIXED)?;
        prop_assert_eq!(parts[0].start(), piece.start());
        prop_assert_eq!(parts[1].end(), piece.end());
    }
}
