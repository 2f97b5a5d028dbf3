//! Few pieces within a tolerance of the logarithmic curve.
//!
//! Three families, all with exact ends and tangents that meet at the joints:
//!
//! | function | pieces | error | for |
//! |---|---|---|---|
//! | [`chords`] | straight, ends on the curve | h² | lines |
//! | [`linear_in_x`] | cubic or quintic, X (with Y, Z) linear in the parameter | h⁴, h⁶ | axes that may not share a parameter |
//! | [`along_itself`] | cubic, X and A fitted together | h⁶ | axes on one parameter |
//!
//! A plane curve may run along itself as it likes: X(p) need not be linear. A cubic with both end tangents given has
//! the two tangent lengths left, and they buy two orders of accuracy (de Boor, Höllig, Sabin, *High accuracy
//! geometric Hermite interpolation*, 1987). Here they are spent where the error's greatest value is least: an error
//! with double zeros at both ends and two more inside is, to leading order, a multiple of (1 − y²)²(y² − c²) on
//! −1 ≤ y ≤ 1. Its three extremes are equal where c² = 4(1 − c²)³/27, c = 0.32541…, so the fit passes through the
//! curve at p = (1 ± c)/2. A quintic linear in X has two coefficients left and uses the same two places.

use super::bezier::Bezier;
use super::deviation::{Bound, log_chord, log_piece};
use super::elementary::{cbrt, exp_m1, ln_1p};
use super::logcurve::LogCurve;
use crate::units::Position;

/// Root of c² = 4(1 − c²)³/27.
const C: f64 = 0.325_411_344_339_772_1;

/// A fit of more pieces than this is given up.
pub const MAX_PIECES: usize = 1_000_000;

/// A fit that has no bound at all by this many pieces is given up.
const MAX_BLIND: usize = 1024;

/// A guess is at most so many times the one before.
const MAX_GROWTH: f64 = 16.0;

/// The tolerance cannot be reached: rounding or [`MAX_PIECES`] stand before it.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the tolerance of {tolerance} mm cannot be reached")]
pub struct FitError {
    /// What was asked, mm.
    pub tolerance: f64,
}

/// Cubics whose X and A are fitted together, nowhere farther than `tolerance` mm from the curve at the surface.
///
/// # Errors
/// The tolerance is out of reach.
pub fn along_itself(curve: &LogCurve, tolerance: f64) -> Result<Vec<Bezier>, FitError> {
    fewest(curve, tolerance, 6.0, |x0, x1| cubic(curve, x0, x1))
}

/// Pieces of degree 3 or 5 with X linear in the parameter, nowhere farther than `tolerance` mm from the curve at the
/// surface.
///
/// # Errors
/// The tolerance is out of reach.
pub fn linear_in_x(curve: &LogCurve, degree: usize, tolerance: f64) -> Result<Vec<Bezier>, FitError> {
    if degree < 5 {
        fewest(curve, tolerance, 4.0, |x0, x1| hermite(curve, x0, x1))
    } else {
        fewest(curve, tolerance, 6.0, |x0, x1| quintic(curve, x0, x1))
    }
}

/// X of the points of a polyline on the curve, nowhere farther than `tolerance` mm from it at the surface; from start to
/// end, both included.
///
/// # Errors
/// The tolerance is out of reach.
pub fn chords(curve: &LogCurve, tolerance: f64) -> Result<Vec<f64>, FitError> {
    if curve.is_straight() {
        return Ok(vec![curve.start(), curve.end()]);
    }
    let chord = |x0, x1| {
        let bound = log_chord(curve, (x0, curve.angle(x0)), (x1, curve.angle(x1)));
        Some((bound, [x0, x1]))
    };
    let pieces = fewest_pieces(curve, tolerance, 2.0, chord)?;
    Ok(std::iter::once(curve.start()).chain(pieces.into_iter().map(|[_, x1]| x1)).collect())
}

fn fewest(
    curve: &LogCurve,
    tolerance: f64,
    order: f64,
    piece: impl Fn(f64, f64) -> Bezier,
) -> Result<Vec<Bezier>, FitError> {
    fewest_pieces(curve, tolerance, order, |x0, x1| {
        let piece = piece(x0, x1);
        log_piece(curve, &piece, [0.0; 2]).ok().map(|bound| (bound, piece))
    })
}

/// The fewest pieces on the breaks of [`LogCurve::breaks`] whose bounds all hold. The error falls with n^−order, so
/// the next n is guessed from the last error, and the least that holds, one less than which does not, is looked for below it.
fn fewest_pieces<P>(
    curve: &LogCurve,
    tolerance: f64,
    order: f64,
    piece: impl Fn(f64, f64) -> Option<(Bound, P)>,
) -> Result<Vec<P>, FitError> {
    // The pieces and their bound; infinite where a piece has none.
    let fit = |n: usize| {
        let breaks: Vec<f64> = curve.breaks(n, order).collect();
        let mut pieces = Vec::with_capacity(n);
        let mut worst = 0.0f64;
        for pair in breaks.windows(2) {
            match piece(pair[0], pair[1]) {
                Some((bound, piece)) => {
                    worst = worst.max(bound.mm);
                    pieces.push(piece);
                }
                None => worst = f64::INFINITY,
            }
        }
        (worst, pieces)
    };
    // So many pieces hold, and so many do not.
    let (mut n, mut short) = (1, 0);
    let (mut worst, mut pieces) = fit(n);
    let mut stalled = 0;
    while !(worst <= tolerance) {
        let ratio = (worst / tolerance).min(1.0e30);
        let growth = match order as u32 {
            2 => ratio.sqrt(),
            4 => ratio.sqrt().sqrt(),
            _ => cbrt(ratio.sqrt()),
        };
        short = n;
        // Of a few pieces the error tells little of that of many.
        let growth = if growth.is_finite() { growth.min(MAX_GROWTH) } else { 2.0 };
        n = ((0.95 * n as f64 * growth) as usize).max(n + 1);
        if MAX_PIECES < n || (worst == f64::INFINITY && MAX_BLIND < n) {
            return Err(FitError { tolerance });
        }
        let last = worst;
        (worst, pieces) = fit(n);
        // Rounding sets a floor: where more and more pieces gain nothing, no number of them will do.
        stalled = if last.is_finite() && last <= worst { stalled + 1 } else { 0 };
        if 8 < stalled {
            return Err(FitError { tolerance });
        }
    }
    // One less is tried first, since most guesses are right; then by halves between what holds and what does not.
    let mut tried = n - 1;
    while short < tried {
        let (worst, fewer) = fit(tried);
        if worst <= tolerance {
            (n, pieces) = (tried, fewer);
        } else {
            short = tried;
        }
        tried = short.midpoint(n);
    }
    Ok(pieces)
}

/// A piece from ordinates of X and A (radians), Y and Z on the cone.
fn piece(curve: &LogCurve, ordinates: &[(f64, f64)]) -> Bezier {
    let points: Vec<Position> = ordinates.iter().map(|&(x, a)| curve.position_with(x, a)).collect();
    let mut piece = Bezier::new(&points);
    // The ends are the curve's own to the last bit, so that neighbours share them.
    piece.points[0] = curve.position(ordinates[0].0);
    piece.points[piece.degree] = curve.position(ordinates[piece.degree].0);
    piece
}

/// The cubic with X linear and the curve's ends and slopes.
fn hermite(curve: &LogCurve, x0: f64, x1: f64) -> Bezier {
    let h = (x1 - x0) / 3.0;
    let (a0, a1) = (curve.angle(x0), curve.angle(x1));
    let inner = [(x0 + h, a0 + h * curve.slope(x0)), (x1 - h, a1 - h * curve.slope(x1))];
    piece(curve, &[(x0, a0), inner[0], inner[1], (x1, a1)])
}

/// The quintic with X linear, the curve's ends and slopes, through the curve at p = (1 ± c)/2.
fn quintic(curve: &LogCurve, x0: f64, x1: f64) -> Bezier {
    let base = hermite(curve, x0, x1).raised_to(5);
    let h = x1 - x0;
    // Ordinates 2 and 3 move by (d2, d3); basis 10 p²(1−p)³ and 10 p³(1−p)².
    let error = |p: f64| {
        let value = base.eval(p);
        curve.position(x0 + p * h)[3] - value[3]
    };
    let (p, q) = (0.5 * (1.0 - C), 0.5 * (1.0 + C));
    let (inner, outer) = (10.0 * p * p * q * q * q, 10.0 * p * p * p * q * q);
    let (e1, e2) = (error(p), error(q));
    let determinant = inner * inner - outer * outer;
    let mut result = base;
    result.points[2][3] += (e1 * inner - e2 * outer) / determinant;
    result.points[3][3] += (e2 * inner - e1 * outer) / determinant;
    result
}

/// The cubic with the curve's ends and tangents, through the curve at p = (1 ± c)/2; where that does not settle in
/// order, the cubic linear in X.
///
/// The unknowns are the lengths u and v of the end tangents in X. The equations have no solution near u = v = h/3:
/// to leading order every cubic through a parabola's ends and tangents runs along it, and the pair that also meets
/// the next orders is lopsided, by about 0.38 ln(q₁/q₀) either way. Newton's method from there takes four steps.
fn cubic(curve: &LogCurve, x0: f64, x1: f64) -> Bezier {
    let h = x1 - x0;
    let (a0, a1) = (curve.angle(x0), curve.angle(x1));
    let (s0, s1) = (curve.slope(x0), curve.slope(x1));
    let ordinates = |u: f64, v: f64| [(x0, a0), (x0 + u, a0 + s0 * u), (x1 - v, a1 - s1 * v), (x1, a1)];
    let beta = curve.beta();
    let ratio = ln_1p(beta * h / (1.0 + beta * x0));
    let third = |share: f64| (h / 3.0) * (1.0 + exp_m1(share * ratio));
    let (mut u, mut v) = (third(-0.38), third(0.37));
    for _ in 0..12 {
        let points = ordinates(u, v);
        let mut f = [0.0; 2];
        let mut j = [[0.0; 2]; 2];
        for (row, p) in [0.5 * (1.0 - C), 0.5 * (1.0 + C)].into_iter().enumerate() {
            let r = 1.0 - p;
            let b = [r * r * r, 3.0 * p * r * r, 3.0 * p * p * r, p * p * p];
            let sum = |of: fn(&(f64, f64)) -> f64| {
                points.iter().zip(b).map(|(point, b)| b * of(point)).sum::<f64>()
            };
            let (x, a) = (sum(|point| point.0), sum(|point| point.1));
            let slope = curve.slope(x);
            f[row] = a - curve.angle(x);
            j[row] = [b[1] * (s0 - slope), b[2] * (slope - s1)];
        }
        let determinant = j[0][0] * j[1][1] - j[0][1] * j[1][0];
        let du = (f[0] * j[1][1] - f[1] * j[0][1]) / determinant;
        let dv = (f[1] * j[0][0] - f[0] * j[1][0]) / determinant;
        u -= du;
        v -= dv;
        if du.abs() + dv.abs() <= 1.0e-9 * h {
            break;
        }
    }
    // Also false for NaN, which a straight path gives: there the determinant is zero.
    if !(0.0 < u && 0.0 < v && u + v < h) {
        return hermite(curve, x0, x1);
    }
    let fitted = piece(curve, &ordinates(u, v));
    let plain = hermite(curve, x0, x1);
    let mm = |piece: &Bezier| log_piece(curve, piece, [0.0; 2]).map_or(f64::INFINITY, |bound| bound.mm);
    if mm(&plain) <= mm(&fitted) { plain } else { fitted }
}

#[cfg(test)]
mod tests {
    use super::super::logcurve::tests::paper;
    use super::super::logcurve::{Cutter, LogCurve};
    use super::*;

    fn worst(curve: &LogCurve, pieces: &[Bezier]) -> f64 {
        pieces.iter().map(|piece| log_piece(curve, piece, [0.0; 2]).unwrap().mm).fold(0.0, f64::max)
    }

    #[test]
    fn c_levels_the_three_extremes() {
        // (1 − y²)²(y² − c²) is −c² at 0 and 4(1 − c²)³/27 at y² = (1 + 2c²)/3.
        let c2 = C * C;
        approx::assert_relative_eq!(
            c2,
            4.0 * (1.0 - c2) * (1.0 - c2) * (1.0 - c2) / 27.0,
            max_relative = 1e-14
        );
    }

    #[test]
    fn the_papers_cutter_takes_one_cubic() {
        let curve = LogCurve::new(paper(), 0.0).unwrap();
        let pieces = along_itself(&curve, 2e-4).unwrap();
        assert_eq!(pieces.len(), 1);
        // An independent calculation gives 1.32e-7 mm with exact tangents (5e-8 with free ones).
        assert!(worst(&curve, &pieces) < 1.4e-7, "{}", worst(&curve, &pieces));
    }

    #[test]
    fn errors_fall_at_their_order() {
        // From n to 2n pieces the error falls by 2ᵐ; the fits are near their asymptotics on the longer cutter.
        let curve = LogCurve::new(Cutter { length: 200.0, ..paper() }, 0.0).unwrap();
        let error = |n: usize, order: f64, fit: &dyn Fn(f64, f64) -> Bezier| {
            let breaks: Vec<f64> = curve.breaks(n, order).collect();
            let pieces: Vec<Bezier> = breaks.windows(2).map(|pair| fit(pair[0], pair[1])).collect();
            worst(&curve, &pieces)
        };
        let cubic_rate =
            error(2, 6.0, &|a, b| cubic(&curve, a, b)) / error(4, 6.0, &|a, b| cubic(&curve, a, b));
        assert!((45.0..90.0).contains(&cubic_rate), "{cubic_rate}");
        let quintic_rate =
            error(4, 6.0, &|a, b| quintic(&curve, a, b)) / error(8, 6.0, &|a, b| quintic(&curve, a, b));
        assert!((45.0..90.0).contains(&quintic_rate), "{quintic_rate}");
        let hermite_rate =
            error(8, 4.0, &|a, b| hermite(&curve, a, b)) / error(16, 4.0, &|a, b| hermite(&curve, a, b));
        assert!((13.0..19.0).contains(&hermite_rate), "{hermite_rate}");
    }

    #[test]
    fn joints_meet_with_one_tangent() {
        let curve = LogCurve::new(Cutter { length: 200.0, ..paper() }, 90.0).unwrap();
        for pieces in [along_itself(&curve, 1e-7).unwrap(), linear_in_x(&curve, 5, 1e-6).unwrap()] {
            assert!(1 < pieces.len());
            for pair in pieces.windows(2) {
                assert_eq!(pair[0].end(), pair[1].start());
                let slope = |p: Position, q: Position| (q[3] - p[3]) / (q[0] - p[0]);
                let m = pair[0].degree;
                let before = slope(pair[0].points[m - 1], pair[0].points[m]);
                let after = slope(pair[1].points[0], pair[1].points[1]);
                approx::assert_relative_eq!(before, after, max_relative = 1e-9);
            }
        }
    }

    #[test]
    fn straight_paths_take_one_piece() {
        for cutter in [Cutter { c: 0.0, ..paper() }, Cutter { s: 0.0, ..paper() }] {
            let curve = LogCurve::new(cutter, 0.0).unwrap();
            assert_eq!(along_itself(&curve, 1e-6).unwrap().len(), 1);
            assert_eq!(linear_in_x(&curve, 3, 1e-6).unwrap().len(), 1);
            assert_eq!(chords(&curve, 1e-6).unwrap(), vec![0.0, 30.0]);
        }
    }

    /// Run out to 0.017 mm before its apex the curve turns ever faster, and the error of a few chords tells little of that of
    /// many: the guesses go far past the least.
    #[test]
    fn the_least_is_found_in_few_trials() {
        let cutter = Cutter { d1: 0.4, s: 20.7, c: 4.46, r: 8.0, length: 50.0, ..paper() };
        let curve = LogCurve::new(cutter, 0.0).unwrap().with_range(-2.346, 50.0).unwrap();
        let tried = std::cell::Cell::new(0);
        let pieces = fewest_pieces(&curve, 6.7e-4, 2.0, |x0, x1| {
            tried.set(tried.get() + 1);
            Some((log_chord(&curve, (x0, curve.angle(x0)), (x1, curve.angle(x1))), ()))
        });
        let (count, tried) = (pieces.unwrap().len(), tried.get());
        // With c pieces the last guess is below 16 c and those before together a fifteenth of it; one less is as many, and the
        // halves are 16 c in all down to c, and c for each of log2(16 c) = 13 more.
        assert!(tried < (16 + 2 + 16 + 16 + 13) * count, "{count} pieces took {tried}");
    }

    #[test]
    fn chords_hold_their_tolerance_with_no_point_to_spare() {
        let curve = LogCurve::new(paper(), 0.0).unwrap();
        let xs = chords(&curve, 1e-3).unwrap();
        let bound = |xs: &[f64]| {
            xs.windows(2).fold(0.0, |most: f64, w| {
                most.max(log_chord(&curve, (w[0], curve.angle(w[0])), (w[1], curve.angle(w[1]))).mm)
            })
        };
        assert!(bound(&xs) <= 1e-3);
        let fewer: Vec<f64> = curve.breaks(xs.len() - 2, 2.0).collect();
        assert!(1e-3 < bound(&fewer));
    }
}
