//! A curve whose coordinates are expressions in u, checked over the whole of its range.
//!
//! [`Formula::new`] walks the range in intervals: a part on which every coordinate and its first derivative is bounded, and
//! ‖c′‖ is not zero, is sound; others are halved until they are, or so short that the fault is at a place. So a curve
//! that exists is defined, smooth and moving everywhere.

use super::interval::Interval;
use super::jet::Jet;
use super::number::Fault;
use super::{Expression, Failing};
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
            FormulaError::Fails { failing, u, .. } => write!(f, "{} at u = {u}", failing.fault),
            FormulaError::Stands { u } => write!(f, "the curve stands still at u = {u}"),
            FormulaError::Range => f.write_str("the range of u must run from one number to another"),
            FormulaError::TooHard => f.write_str("the range of u is too wide to be looked through"),
        }
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
            return Err(match (self.fault_at(u), found) {
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

    /// An upper bound, for each axis, of how far the Hermite cubic through ends and end derivatives is from the curve on
    /// this part: h⁴/384 · max|c⁗| = h⁴/16 · max|a₄|.
    ///
    /// # Errors
    /// The part is too wide to be bounded.
    pub fn cubic_error(&self, from: f64, to: f64) -> Result<Position, (usize, Fault)> {
        let h = to - from;
        let square = h * h;
        let jets = self
            .bounds::<5>(Interval::new(from.min(to), from.max(to)))
            .map_err(|(axis, failing)| (axis, failing.fault))?;
        let mut error = [0.0; MAX_AXES];
        for (i, jet) in jets.iter().enumerate() {
            error[i] = square * square / 16.0 * jet.0[4].magnitude();
        }
        Ok(error)
    }
}
