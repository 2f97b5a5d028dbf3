//! A rational block: numerators and denominator over PL = 1, the start weight made 1.
//!
//! With D(p) = 1 + d₁p + … and N = a₀ + a₁p + … a rounding of d_k by δ moves the coordinate X = N/D by at most |X| δ/D, and one
//! of a_k by δ/D. So coefficients take the decimals for which
//!
//! ```text
//! Σ ½·10⁻ᵈ (1 + |X|) / min D ≤ a tenth of the tolerance
//! ```
//!
//! X being the greatest coordinate of the block.

use super::{MAX_COEFFICIENT_DIGITS, Quantiser, Unwritable, coefficient};
use crate::decimal::{Decimal, power_of_ten};
use crate::geom::bezier::Bezier;
use crate::ir::{COEFFICIENTS, Denominator, PolynomialBlock, Units};
use crate::units::MAX_AXES;

/// The block of a rational piece that ends at `end`.
pub(super) fn block(
    quantiser: &Quantiser<'_>,
    piece: &Bezier,
    end: &Units,
) -> Result<PolynomialBlock, Unwritable> {
    let m = piece.degree;
    let mut weights = [[0.0; MAX_AXES]; 6];
    let mut lifted = [[0.0; MAX_AXES]; 6];
    let mut least = f64::INFINITY;
    let mut greatest = 0.0f64;
    for i in 0..=m {
        let w = piece.weights[i] / piece.weights[0];
        least = least.min(w);
        weights[i][0] = w;
        for axis in 0..MAX_AXES {
            lifted[i][axis] = w * piece.points[i][axis];
            greatest = greatest.max(piece.points[i][axis].abs());
        }
    }
    let share = 0.1 * quantiser.tolerance * least / (1.0 + greatest);
    let fits = |digits: &u8| 0.5 * COEFFICIENTS as f64 / power_of_ten(*digits) as f64 <= share;
    let digits = (0..MAX_COEFFICIENT_DIGITS).find(fits).unwrap_or(MAX_COEFFICIENT_DIGITS);
    let rounded = |a: &[f64]| -> Result<[Decimal; COEFFICIENTS], Unwritable> {
        let mut rounded = [Decimal::ZERO; COEFFICIENTS];
        for (to, a) in rounded.iter_mut().zip(&a[2..]).take(m.saturating_sub(1)) {
            *to = coefficient(*a, digits).ok_or(Unwritable)?;
        }
        Ok(rounded)
    };
    let numerators = Bezier::new(&lifted[..=m]);
    let below = Bezier::new(&weights[..=m]);
    let mut coefficients = [[Decimal::ZERO; COEFFICIENTS]; MAX_AXES];
    let mut divides = [false; MAX_AXES];
    for axis in 0..quantiser.machine.axes.count() {
        // An axis that rests is left out: its numerator would be a multiple of the denominator.
        divides[axis] = piece.control_points().iter().any(|point| point[axis] != piece.points[0][axis]);
        if divides[axis] {
            coefficients[axis] = rounded(&numerators.power_basis(axis, 1.0))?;
        }
    }
    let denominator = Denominator {
        end: coefficient(weights[m][0], digits).ok_or(Unwritable)?,
        coefficients: rounded(&below.power_basis(0, 1.0))?,
        divides,
    };
    Ok(PolynomialBlock {
        pl: Decimal::new(1, 0),
        end: *end,
        coefficients,
        denominator: Some(denominator),
        line: 0,
    })
}
