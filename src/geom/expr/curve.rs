//! A curve whose coordinates are expressions in u, checked over the whole of its range.
//!
//! [`Formula::new`] walks the range in intervals: a part on which every coordinate and its first derivative is bounded, and
//! ‖c′‖ is not zero, is sound; others are halved until they are, or so short that the fault is at a place. So a curve
//! that exists is defined, smooth and moving everywhere.

use super::interval::Interval;
use super::jet::Jet;
use super::{Expression, Failing};
use crate::geom::bezier::Bezier;
use crate::units::{MAX_AXES, Position};

/// The most parts that are looked at.
const MOST_PARTS: usize = 1 << 16;

/// A part this share of the range is a place.
const PLACE: f64 = 1e-9;

/// A curve by one expression an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Formula {
    axes: Vec<Expression>,
    from: f64,
    to: f64,
}

/// What is wrong with a curve.
#[derive(Clone, Debug, PartialEq)]
pub enum FormulaError {
    /// An axis has no value or no derivative.
    Fails {
        /// Which axis.
        axis: usize,
        /// What, and where in its expression.
        failing: Failing,
        /// At which parameter.
        u: f64,
    },
    /// No axis moves.
    Stands {
        /// At which parameter.
        u: f64,
    },
    /// The range is empty or not finite.
    Range,
    /// The range could not be looked through.
    TooHard,
}

impl std::fmt::Display for FormulaError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            FormulaError::Fails { failing, u, .. } => write!(f, "{} at u = {}", failing.fault, place(*u)),
            FormulaError::Stands { u } => write!(f, "the curve stands still at u = {}", place(*u)),
            FormulaError::Range => f.write_str("the range of u must run from one number to another"),
            FormulaError::TooHard => f.write_str("the range of u is too wide to be looked through"),
        }
    }
}

/// A parameter in seven figures.
fn place(u: f64) -> String {
    let seven: f64 = format!("{u:.6e}").parse().unwrap_or(u);
    if seven == 0.0 || (1e-4..1e9).contains(&seven.abs()) {
        (seven + 0.0).to_string()
    } else {
        format!("{seven:e}")
    }
}

impl Formula {
    /// The curve of up to [`MAX_AXES`] coordinates on from … to, which may fall.
    ///
    /// # Errors
    /// See [`FormulaError`].
    pub fn new(axes: Vec<Expression>, from: f64, to: f64) -> Result<Formula, FormulaError> {
        if !(from.is_finite() && to.is_finite() && from != to) || MAX_AXES < axes.len() {
            return Err(FormulaError::Range);
        }
        let formula = Formula { axes, from, to };
        formula.look_through()?;
        Ok(formula)
    }

    /// Its first and its last parameter.
    pub fn range(&self) -> (f64, f64) {
        (self.from, self.to)
    }

    /// The expression of each coordinate.
    pub fn axes(&self) -> &[Expression] {
        &self.axes
    }

    /// How many coordinates it has.
    pub fn count(&self) -> usize {
        self.axes.len()
    }

    /// Value and N − 1 derivatives of each axis, over their factorials, over an interval of u.
    ///
    /// # Errors
    /// An axis may have no value or no derivative there.
    pub fn bounds<const N: usize>(&self, u: Interval) -> Result<Vec<Jet<Interval, N>>, (usize, Failing)> {
        self.axes.iter().enumerate().map(|(i, axis)| axis.jet(u).map_err(|failing| (i, failing))).collect()
    }

    /// Value and N − 1 derivatives over their factorials at u; where there are none, which [`Formula::new`] excludes on the
    /// range, NaN.
    pub fn jet<const N: usize>(&self, u: f64) -> [Position; N] {
        let mut jet = [[0.0; MAX_AXES]; N];
        for (i, axis) in self.axes.iter().enumerate() {
            let own = axis.jet::<f64, N>(u).map_or([f64::NAN; N], |own| own.0);
            for k in 0..N {
                jet[k][i] = own[k];
            }
        }
        jet
    }

    /// c(u).
    pub fn at(&self, u: f64) -> Position {
        self.jet::<1>(u)[0]
    }

    fn look_through(&self) -> Result<(), FormulaError> {
        let width = (self.to - self.from).abs();
        let mut parts = vec![(self.from.min(self.to), self.from.max(self.to))];
        let mut looked = 0;
        while let Some((low, high)) = parts.pop() {
            looked += 1;
            if MOST_PARTS < looked {
                return Err(FormulaError::TooHard);
            }
            let middle = low.midpoint(high);
            let found = self.bounds::<2>(Interval::new(low, high));
            if let Ok(jets) = &found
                && jets.iter().any(|jet| !jet.0[1].contains(0.0))
            {
                continue;
            }
            if PLACE * width < high - low && low < middle && middle < high {
                parts.push((middle, high));
                parts.push((low, middle));
                continue;
            }
            // A fault that the place itself has is told before one that only its surroundings may have.
            let u = [low, high, middle].into_iter().find(|u| self.fault_at(*u).is_some()).unwrap_or(middle);
            let fault = self.fault_at(u);
            // Nearer to zero than a part is wide, it is zero.
            let u = if u.abs() <= PLACE * width { 0.0 } else { u };
            return Err(match (fault, found) {
                (Some((axis, failing)), _) | (None, Err((axis, failing))) => {
                    FormulaError::Fails { axis, failing, u }
                }
                (None, Ok(_)) => FormulaError::Stands { u },
            });
        }
        Ok(())
    }

    /// What is wrong at one parameter.
    fn fault_at(&self, u: f64) -> Option<(usize, Failing)> {
        let fault = |(i, axis): (usize, &Expression)| axis.jet::<f64, 2>(u).err().map(|failing| (i, failing));
        self.axes.iter().enumerate().find_map(fault)
    }

    /// The same curve in other coordinates: axis i becomes `columns[i]`, the others of `rest` stay where it says.
    #[must_use]
    pub fn placed(&self, columns: &[usize], rest: &[f64]) -> Formula {
        let mut axes: Vec<Expression> = rest.iter().map(|x| Expression::number(*x)).collect();
        for (axis, to) in self.axes.iter().zip(columns) {
            axes[*to] = axis.clone();
        }
        Formula { axes, ..*self }
    }

    /// Quintic pieces that share ends, first and second derivatives with the curve, and for each axis a bound of how far
    /// they are from it, no more than `target` each before rounding. On a part of width h that is
    ///
    /// ```text
    /// |c⁽⁶⁾|/6! · (u − u₀)³(u₁ − u)³ ≤ max|a₆| h⁶/64          and 64 ε max|c| for the roundings of the pieces
    /// ```
    ///
    /// with the sixth Taylor coefficient a₆ bounded in intervals.
    ///
    /// # Errors
    /// There would be too many.
    pub fn pieces(&self, target: f64) -> Result<(Vec<Bezier>, Position), FormulaError> {
        let mut parts = vec![(self.from, self.to)];
        let mut pieces = Vec::new();
        let mut bound = [0.0f64; MAX_AXES];
        let mut looked = 0;
        while let Some((from, to)) = parts.pop() {
            looked += 1;
            if MOST_PARTS < looked {
                return Err(FormulaError::TooHard);
            }
            let error = self.quintic_error(from, to);
            let close = error.filter(|error| error.iter().all(|x| x[0] <= target));
            let Some(error) = close else {
                let middle = from.midpoint(to);
                parts.push((middle, to));
                parts.push((from, middle));
                continue;
            };
            for axis in 0..MAX_AXES {
                bound[axis] = bound[axis].max(error[axis][0] + error[axis][1]);
            }
            pieces.push(self.quintic(from, to));
        }
        // Neighbours share their joint to the bit.
        for i in 1..pieces.len() {
            pieces[i].points[0] = pieces[i - 1].end();
        }
        Ok((pieces, bound))
    }

    /// For each axis how far the quintic is from the curve, and the allowance for its roundings; none where the part is too
    /// wide to be bounded.
    fn quintic_error(&self, from: f64, to: f64) -> Option<[[f64; 2]; MAX_AXES]> {
        let jets = self.bounds::<7>(Interval::new(from.min(to), from.max(to))).ok()?;
        let half = 0.5 * (to - from);
        let cube = half * half * half;
        let mut error = [[0.0; 2]; MAX_AXES];
        for (i, jet) in jets.iter().enumerate() {
            error[i] = [cube * cube * jet.0[6].magnitude(), 64.0 * f64::EPSILON * jet.0[0].magnitude()];
        }
        Some(error)
    }

    /// P₁ = P₀ + hc′/5 and P₂ = P₀ + 2hc′/5 + h²c″/20, and the same from the end.
    fn quintic(&self, from: f64, to: f64) -> Bezier {
        let h = to - from;
        let (start, end) = (self.jet::<3>(from), self.jet::<3>(to));
        let side = |jet: &[Position; 3], h: f64| {
            let one: Position = std::array::from_fn(|i| jet[0][i] + h * jet[1][i] / 5.0);
            // The third coefficient is c″/2.
            let two =
                std::array::from_fn(|i| jet[0][i] + 2.0 * h * jet[1][i] / 5.0 + h * h * jet[2][i] / 10.0);
            (one, two)
        };
        let ((one, two), (four, three)) = (side(&start, h), side(&end, -h));
        Bezier::new(&[start[0], one, two, three, four, end[0]])
    }
}
