//! How long a piece is, as an integral with an error bound.
//!
//! With N and D the numerator and the denominator of a piece its derivative is v/D², v = N′D − ND′, so that
//!
//! ```text
//! L = ∫ |v| / D² dt
//! ```
//!
//! # By Gauss's rule
//!
//! On a part of the piece, −1 ≤ z ≤ 1, v and D are written in powers of z. In the disc |z| ≤ r they stay near v₀ and d₀:
//!
//! ```text
//! |v(z) − v₀| ≤ S = Σ(k ≥ 1) |v_k| rᵏ          |D(z) − d₀| ≤ T = Σ(k ≥ 1) |d_k| rᵏ
//! ```
//!
//! Where S ≤ 0.4 |v₀|, v·v has no zero in the disc, since |v·v − v₀·v₀| ≤ 2 |v₀| S + S² < |v₀|²; and D has none where
//! T ≤ d₀/2. So f = √(v·v)/D² is analytic there and |f| ≤ M = (|v₀| + S)/(d₀ − T)². The Bernstein ellipse with ρ lies in the disc of
//! r = (ρ + 1/ρ)/2, and f = Σ a_k T_k(z) has |a_k| ≤ 2 M ρ⁻ᵏ. A rule of n points errs in the even k ≥ 2n only, by no more
//! than 2 + 2/(k² − 1) ≤ 32/15 each:
//!
//! ```text
//! |error| ≤ 64/15 · M ρ⁻²ⁿ / (1 − ρ⁻²)          n = 10, ρ = 4
//! ```
//!
//! Since f ≥ 0.6 |v₀|/(1.5 d₀)² in the part, that is less than 1e-10 of the part's own length.
//!
//! # Between chord and polygon
//!
//! A piece that stands somewhere, as where control points fall together, has no such disc there. Its parts are then halved
//! until the control polygon, which is no shorter than the piece while all weights are positive (no plane meets the piece
//! more often than the polygon), is no longer than the chord but for `CLOSE` of the whole.

use super::bernstein::{Bernstein, binomial};
use super::bezier::{Bezier, MAX_PIECE_DEGREE};
use crate::units::{MAX_AXES, Position};

/// A length, and how far it can be from the true one, both mm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Length {
    /// The length.
    pub mm: f64,
    /// No more than this from the true one, but for the rounding of floats.
    pub error: f64,
}

/// N′D − ND′ of a rational quintic has degree 9.
const COEFFICIENTS: usize = 2 * MAX_PIECE_DEGREE;

/// r for ρ = 4.
const RADIUS: f64 = 2.125;

/// 64/15 · 4⁻²⁰ / (1 − 4⁻²).
const GAUSS_ERROR: f64 = 64.0 / 15.0 * 9.094_947_017_729_283e-13 / (1.0 - 1.0 / 16.0);

/// Gauss's rule of ten points: place and weight, each on both sides of 0 (Abramowitz and Stegun, table 25.4).
const GAUSS: [(f64, f64); 5] = [
    (0.148_874_338_981_631_21, 0.295_524_224_714_752_87),
    (0.433_395_394_129_247_2, 0.269_266_719_309_996_36),
    (0.679_409_568_299_024_4, 0.219_086_362_515_982_04),
    (0.865_063_366_688_984_5, 0.149_451_349_150_580_6),
    (0.973_906_528_517_171_7, 0.066_671_344_308_688_14),
];

/// How near polygon and chord must be, as a share of the whole polygon.
const CLOSE: f64 = 1.0e-13;

/// Halving stops here: at a place where a piece stands, the part is then shorter than any float tells.
const MAX_DEPTH: u32 = 48;

/// And here: each further part is taken as it is, with its error.
const MAX_PARTS: usize = 4096;

/// A polynomial in powers of z.
type Powers = [f64; COEFFICIENTS];

/// The powers of z, t = (1 + z)/2: the k-th is C(n,k) 2⁻ᵏ times the k-th difference of the coefficients in the middle.
fn centred(f: &Bernstein) -> Powers {
    let n = f.degree();
    let mut differences = [0.0; COEFFICIENTS];
    differences[..=n].copy_from_slice(f.coefficients());
    let mut powers = [0.0; COEFFICIENTS];
    for k in 0..=n {
        let middle = (0..=n - k).map(|i| binomial(n - k, i) * differences[i]).sum::<f64>();
        // 2⁻ⁿ⁺ᵏ of the mean and 2⁻ᵏ of z: exact powers of two.
        powers[k] = binomial(n, k) * middle / f64::from(1u32 << n);
        for i in 0..n - k {
            differences[i] = differences[i + 1] - differences[i];
        }
    }
    powers
}

/// f((z + s)/2), s = ±1: the half of f on that side.
fn half(f: &Powers, s: f64) -> Powers {
    let mut g = *f;
    let mut scale = 1.0;
    for c in &mut g {
        *c *= scale;
        scale *= 0.5;
    }
    for i in 0..COEFFICIENTS - 1 {
        for j in (i..COEFFICIENTS - 1).rev() {
            g[j] += s * g[j + 1];
        }
    }
    g
}

/// A part of a piece: v and D in powers of z, and where on the piece it lies.
#[derive(Clone, Copy)]
struct Part {
    v: [Powers; MAX_AXES],
    d: Powers,
    from: f64,
    depth: u32,
}

impl Part {
    /// All of a piece whose coordinates are in mm.
    fn whole(piece: &Bezier) -> Part {
        let greatest = piece.weights[..=piece.degree].iter().copied().fold(0.0, f64::max);
        let mut piece = *piece;
        let start = piece.start();
        for point in &mut piece.points[..=piece.degree] {
            for (x, from) in point.iter_mut().zip(&start) {
                *x -= from;
            }
        }
        piece.weights.iter_mut().for_each(|w| *w /= greatest);
        let polynomial = piece.is_polynomial();
        let d = if polynomial { Bernstein::new(&[1.0]) } else { piece.denominator() };
        let v = std::array::from_fn(|axis| {
            if piece.control_points().iter().all(|p| p[axis] == 0.0) {
                return [0.0; COEFFICIENTS];
            }
            let n = piece.numerator(axis);
            if polynomial {
                return centred(&n.derivative());
            }
            centred(&n.derivative().times(&d).combined(1.0, &n.times(&d.derivative()), -1.0))
        });
        Part { v, d: centred(&d), from: 0.0, depth: 0 }
    }

    /// How wide it is, as a share of the piece.
    fn width(&self) -> f64 {
        1.0 / (1u64 << self.depth) as f64
    }

    fn halves(&self) -> [Part; 2] {
        [(-1.0, 0.0), (1.0, 0.5)].map(|(side, share)| Part {
            v: self.v.map(|v| half(&v, side)),
            d: half(&self.d, side),
            from: self.from + share * self.width(),
            depth: self.depth + 1,
        })
    }

    /// The length by Gauss's rule; none where no disc is free of zeros.
    fn gauss(&self) -> Option<Length> {
        let (mut s, mut t, mut power) = (0.0, 0.0, 1.0);
        for k in 1..COEFFICIENTS {
            power *= RADIUS;
            s += power * self.v.iter().map(|v| v[k] * v[k]).sum::<f64>().sqrt();
            t += power * self.d[k].abs();
        }
        let v0 = self.v.iter().map(|v| v[0] * v[0]).sum::<f64>().sqrt();
        let d0 = self.d[0];
        if !(0.0 < v0 && s <= 0.4 * v0 && t <= 0.5 * d0) {
            return None;
        }
        let value = |f: &Powers, z: f64| f.iter().rev().fold(0.0, |sum, c| sum * z + c);
        let rate = |z: f64| {
            let d = value(&self.d, z);
            self.v.iter().map(|v| value(v, z)).map(|v| v * v).sum::<f64>().sqrt() / (d * d)
        };
        let sum: f64 = GAUSS.iter().map(|(z, w)| w * (rate(*z) + rate(-z))).sum();
        // dt = width/2 · dz.
        let h = 0.5 * self.width();
        let most = (v0 + s) / ((d0 - t) * (d0 - t));
        Some(Length { mm: h * sum, error: h * GAUSS_ERROR * most })
    }
}

/// The polygon of a piece, and its chord.
fn polygon_and_chord(piece: &Bezier) -> (f64, f64) {
    let way =
        |p: &Position, q: &Position| p.iter().zip(q).map(|(p, q)| (q - p) * (q - p)).sum::<f64>().sqrt();
    let polygon = piece.control_points().windows(2).map(|pair| way(&pair[0], &pair[1])).sum();
    (polygon, way(&piece.start(), &piece.end()))
}

/// The length of a piece with positive weights, each coordinate times `scale`: 1 for mm, 0 for what does not count.
pub fn length(piece: &Bezier, scale: &Position) -> Length {
    let piece =
        piece.mapped(|p| std::array::from_fn(|i| if scale[i] == 0.0 { 0.0 } else { scale[i] * p[i] }));
    let (polygon, chord) = polygon_and_chord(&piece);
    if piece.degree == 1 {
        return Length { mm: chord, error: 0.0 };
    }
    if polygon == 0.0 {
        return Length::default();
    }
    integrate(&Part::whole(&piece), CLOSE * polygon, |part| {
        polygon_and_chord(&piece.segment(part.from, part.from + part.width()))
    })
}

/// ∫ |v| dt over 0 ≤ t ≤ 1 of a vector of polynomials, each of degree 9 at most: the length of a piece whose derivative v is.
pub fn of_derivative(v: &[Bernstein]) -> Length {
    let most = v.iter().map(|v| v.max_abs() * v.max_abs()).sum::<f64>().sqrt();
    if most == 0.0 {
        return Length::default();
    }
    let mut d = [0.0; COEFFICIENTS];
    d[0] = 1.0;
    let v = std::array::from_fn(|axis| v.get(axis).map_or([0.0; COEFFICIENTS], centred));
    integrate(&Part { v, d, from: 0.0, depth: 0 }, CLOSE * most, |part| {
        // Between nothing and the sum of all coefficients, |z| ≤ 1.
        let sum = |v: &Powers| v.iter().map(|c| c.abs()).sum::<f64>();
        let most = part.v.iter().map(|v| sum(v) * sum(v)).sum::<f64>().sqrt();
        (most * part.width(), 0.0)
    })
}

/// The sum of all parts: by Gauss's rule, or between the two bounds, from above and below, that are within `close` mm.
fn integrate(whole: &Part, close: f64, bounds: impl Fn(&Part) -> (f64, f64)) -> Length {
    let mut sum = Length::default();
    let mut take = |part: Length| {
        sum.mm += part.mm;
        sum.error += part.error;
    };
    let mut parts = 0;
    let mut stack = vec![*whole];
    while let Some(part) = stack.pop() {
        parts += 1;
        if let Some(length) = part.gauss() {
            take(length);
            continue;
        }
        let (most, least) = bounds(&part);
        if most - least <= close || part.depth == MAX_DEPTH || MAX_PARTS < parts {
            take(Length { mm: 0.5 * (most + least), error: 0.5 * (most - least).abs() });
            continue;
        }
        let [first, last] = part.halves();
        stack.push(last);
        stack.push(first);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    fn piece(points: &[[f64; 2]], weights: &[f64]) -> Bezier {
        let points: Vec<Position> = points.iter().map(|[x, y]| [*x, *y, 0.0, 0.0, 0.0, 0.0]).collect();
        let mut piece = Bezier::new(&points);
        piece.weights[..weights.len()].copy_from_slice(weights);
        piece
    }

    const PLANE: Position = [1.0, 1.0, 0.0, 0.0, 0.0, 0.0];

    fn check(piece: &Bezier, expected: f64) {
        let length = length(piece, &PLANE);
        // Some ten roundings of numbers as large as the result, and the digits that an expected value has.
        let rounding = 1.0e-13 * expected.max(1.0);
        assert!((length.mm - expected).abs() <= length.error + rounding, "{length:?} {expected}");
        assert!(length.error <= 1.0e-10 * expected, "{length:?}");
    }

    #[test]
    fn circles_have_their_arcs() {
        let root = 0.5f64.sqrt();
        let quarter = piece(&[[10.0, 0.0], [10.0, 10.0], [0.0, 10.0]], &[1.0, root, 1.0]);
        let expected = 10.0 * std::f64::consts::FRAC_PI_2;
        check(&quarter, expected);
        check(&quarter.raised_to(3), expected);
        check(&quarter.raised_to(5), expected);
        // Half a circle of radius 5 with the weights 3, 1, 1, 3: its denominator is a quadratic without a middle weight.
        let half = piece(&[[5.0, 7.5], [5.0, 17.5], [15.0, 17.5], [15.0, 7.5]], &[3.0, 1.0, 1.0, 3.0]);
        check(&half, 5.0 * std::f64::consts::PI);
    }

    #[test]
    fn a_parabola_has_its_closed_form() {
        // y = x² from 0 to 1: √5/2 + asinh(2)/4.
        let parabola = piece(&[[0.0, 0.0], [0.5, 0.0], [1.0, 1.0]], &[]);
        check(&parabola, 1.478_942_857_544_597_4);
        check(&parabola.raised_to(4), 1.478_942_857_544_597_4);
    }

    #[test]
    fn a_piece_that_stands_somewhere_has_its_length() {
        // X = 10 (1 − (1 − t)³), straight on and slower and slower: the last three control points are one.
        check(&piece(&[[0.0, 0.0], [10.0, 0.0], [10.0, 0.0], [10.0, 0.0]], &[]), 10.0);
        // The cusp y³ = x² of (t², t³) from t = −1 to 1: two branches of (13√13 − 8)/27 each.
        let branch = (13.0 * 13.0f64.sqrt() - 8.0) / 27.0;
        let cusp = piece(&[[1.0, -1.0], [-1.0 / 3.0, 1.0], [-1.0 / 3.0, -1.0], [1.0, 1.0]], &[]);
        check(&cusp, 2.0 * branch);
        // There and back on a line: X = 4 t (1 − t) · 5.
        check(&piece(&[[0.0, 0.0], [10.0, 0.0], [0.0, 0.0]], &[]), 10.0);
        check(&piece(&[[3.0, 3.0], [3.0, 3.0], [3.0, 3.0]], &[]), 0.0);
    }

    #[test]
    fn great_weights_do_not_hide_the_way() {
        // Through the weights 1, 200, 1 the piece runs close along its polygon.
        let sharp = piece(&[[0.0, 0.0], [5.0, 5.0], [10.0, 0.0]], &[1.0, 200.0, 1.0]);
        let (chords, polygon) = (chord_sum(&sharp), 200.0f64.sqrt());
        let found = length(&sharp, &PLANE);
        assert!(chords <= found.mm + found.error && found.mm - found.error <= polygon, "{found:?} {chords}");
        // A chord of h leaves out h³κ²/24; with 2·10⁶ places of equal t none of them is longer than 1.5e-3 mm.
        assert!(found.mm - chords < 1.0e-8, "{found:?} {chords}");
        assert!(found.error < 1.0e-9);
    }

    /// The sum of two million chords, from the definition of the curve.
    fn chord_sum(piece: &Bezier) -> f64 {
        let w = piece.weights[1];
        let at = |t: f64| {
            let (a, b, c) = ((1.0 - t) * (1.0 - t), 2.0 * w * t * (1.0 - t), t * t);
            [(5.0 * b + 10.0 * c) / (a + b + c), 5.0 * b / (a + b + c)]
        };
        let n = 2_000_000;
        let mut sum = 0.0;
        let mut before = at(0.0);
        for i in 1..=n {
            let here = at(f64::from(i) / f64::from(n));
            let (x, y) = (here[0] - before[0], here[1] - before[1]);
            sum += (x * x + y * y).sqrt();
            before = here;
        }
        sum
    }
}
