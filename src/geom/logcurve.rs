//! The path of a conical cutter: X, Y, Z and A together, A logarithmic in X.
//!
//! A mill with constant rake and spiral angle is ground with the work turning under the wheel
//! (Jiang and Chen, *Design on Odd-even Steps Third Order Approach Interpolation Algorithm for Logarithmic Curve*):
//!
//! ```text
//! Y = X tan C      Z = X tan C sin r      A = a ln(1 + bX)      a = tan S / tan C      b = 2 tan C / D1      (1) (2) (4)
//! ```
//!
//! a grows without bound as C → 0. With k = ab = 2 tan S / D1 the same curve is
//!
//! ```text
//! A = k X · ln(1 + bX)/(bX)          dA/dX = k/(1 + bX)
//! ```
//!
//! which is finite for a cylinder (C = 0: A = kX), for a straight flute (S = 0: A = 0) and for a reverse taper
//! (C < 0), legal while 1 + bX > 0. A flute of constant lead has A = kX on any cone; the two laws differ only in
//! the β of A = k X · ln(1 + βX)/(βX): β = b for constant helix, β = 0 for constant lead.
//!
//! **Distance at the cutter's surface**, in mm, between two positions of equal X is √((R ΔA)² + ΔY² + ΔZ²) with
//! R = D1/2 + X tan C and ΔA in radians.
//!
//! Towards a tip R shrinks to nothing, and so would the distance; there A counts at a twentieth of the greatest radius
//! ([`LogCurve::metric_radius`]).
//!
//! The path is that of the contact point. The wheel's radius and profile are not modelled.

use super::elementary::{atan, cos, exp_m1, ln_1p, ln_1p_over, sin, tan};
use crate::units::{DEGREES, Position};

/// Which way A turns as X grows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hand {
    /// A grows where S > 0.
    Right,
    /// A falls where S > 0.
    Left,
}

/// How A follows X.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// The helix angle is S at every X: the paper's logarithmic curve.
    ConstantHelix,
    /// A is linear in X, with the lead that S gives at D1.
    ConstantLead,
}

/// A conical cutter as its drawing states it. Angles in degrees, lengths in millimetres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cutter {
    /// End diameter, at X = 0.
    pub d1: f64,
    /// Spiral angle, in the paper's axial sense.
    pub s: f64,
    /// Angle of the cone to its axis: the diameter grows by 2 tan C per mm.
    pub c: f64,
    /// Rake.
    pub r: f64,
    /// Travel along X.
    pub length: f64,
    /// Which way A turns.
    pub hand: Hand,
    /// How A follows X.
    pub law: Law,
}

/// What is wrong with a cutter.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum CutterError {
    /// A value is NaN or infinite.
    #[error("{0} is not a finite number")]
    NotFinite(&'static str),
    /// D1 or length is zero or negative.
    #[error("{0} must be greater than zero")]
    NotPositive(&'static str),
    /// S, C or r reaches a right angle.
    #[error("{0} must lie between -90 and 90 degrees")]
    RightAngle(&'static str),
    /// 1 + bX reaches zero before the end.
    #[error("the taper reaches diameter zero at X = {at:.4}, before the end")]
    Vanishes {
        /// Where the diameter is zero, mm.
        at: f64,
    },
}

/// What is counted of a path: what a feed is a speed of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// mm along X Y Z.
    Path,
    /// mm along the cutting edge: X Y Z and the arc at the cutter's surface.
    Edge,
    /// mm along X.
    X,
    /// Degrees of A.
    A,
    /// The path of X Y Z and A together, a degree counted as a millimetre.
    PathAndDegrees,
}

/// A curve A(X) with Y and Z, from X = [`LogCurve::start`] to [`LogCurve::end`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogCurve {
    /// The angle at X = 0, degrees.
    pub index: f64,
    /// How far the whole path is shifted in Y and Z, mm: a rough pass leaves stock.
    pub shift: [f64; 2],
    cutter: Cutter,
    /// Where it starts and ends in X, mm.
    range: [f64; 2],
    /// k = 2 tan S / D1, with the sign of the hand, rad/mm.
    k: f64,
    /// b = 2 tan C / D1, 1/mm.
    b: f64,
    /// β: b for constant helix, 0 for constant lead, 1/mm.
    beta: f64,
    tan_c: f64,
    z_slope: f64,
}

impl LogCurve {
    /// The path of one flute, indexed by `index` degrees.
    ///
    /// # Errors
    /// A value that is not finite, a diameter or length not above zero, an angle of 90° or more, a reverse taper
    /// that comes to a point before its end.
    pub fn new(cutter: Cutter, index: f64) -> Result<LogCurve, CutterError> {
        let Cutter { d1, s, c, r, length, hand, law } = cutter;
        for (name, value) in [("D1", d1), ("S", s), ("C", c), ("r", r), ("length", length), ("index", index)]
        {
            if !value.is_finite() {
                return Err(CutterError::NotFinite(name));
            }
        }
        for (name, value) in [("D1", d1), ("length", length)] {
            if value <= 0.0 {
                return Err(CutterError::NotPositive(name));
            }
        }
        for (name, value) in [("S", s), ("C", c), ("r", r)] {
            if 90.0 <= value.abs() {
                return Err(CutterError::RightAngle(name));
            }
        }
        let tan_c = tan(c / DEGREES);
        let b = 2.0 * tan_c / d1;
        if 1.0 + b * length <= 0.0 {
            return Err(CutterError::Vanishes { at: -1.0 / b });
        }
        let turn = match hand {
            Hand::Right => 1.0,
            Hand::Left => -1.0,
        };
        let beta = match law {
            Law::ConstantHelix => b,
            Law::ConstantLead => 0.0,
        };
        let k = turn * 2.0 * tan(s / DEGREES) / d1;
        let (range, z_slope) = ([0.0, length], tan_c * sin(r / DEGREES));
        Ok(LogCurve { index, shift: [0.0; 2], cutter, range, k, b, beta, tan_c, z_slope })
    }

    /// The same curve between two other X, where `from` < `to`: extended beyond its cutter, or a part of it.
    ///
    /// # Errors
    /// The cutter comes to a point between them.
    pub fn with_range(&self, from: f64, to: f64) -> Result<LogCurve, CutterError> {
        // 1 + bX is linear, so that it is least at an end.
        if (1.0 + self.b * from).min(1.0 + self.b * to) <= 0.0 {
            return Err(CutterError::Vanishes { at: -1.0 / self.b });
        }
        Ok(LogCurve { range: [from, to], ..*self })
    }

    /// The cutter that this is a flute of.
    pub fn cutter(&self) -> &Cutter {
        &self.cutter
    }

    /// The least X, mm.
    pub fn start(&self) -> f64 {
        self.range[0]
    }

    /// The greatest X, mm.
    pub fn end(&self) -> f64 {
        self.range[1]
    }

    /// The same curve on a flute indexed by `index` degrees.
    #[must_use]
    pub fn with_index(&self, index: f64) -> LogCurve {
        LogCurve { index, ..*self }
    }

    /// The same curve shifted by `shift` in Y and Z, mm.
    #[must_use]
    pub fn with_shift(&self, shift: [f64; 2]) -> LogCurve {
        LogCurve { shift, ..*self }
    }

    /// The curve that all flutes and passes share: neither indexed nor shifted.
    #[must_use]
    pub fn base(&self) -> LogCurve {
        LogCurve { index: 0.0, shift: [0.0; 2], ..*self }
    }

    /// k = ab = 2 tan S / D1, rad/mm, with the sign of the hand: dA/dX at X = 0.
    pub fn k(&self) -> f64 {
        self.k
    }

    /// The β of the angle's law, 1/mm.
    pub fn beta(&self) -> f64 {
        self.beta
    }

    /// Whether A is linear in X, so that the whole path is one straight line.
    pub fn is_straight(&self) -> bool {
        self.k == 0.0 || self.beta == 0.0
    }

    /// A at X, in radians, without the index.
    pub fn angle(&self, x: f64) -> f64 {
        self.k * x * ln_1p_over(self.beta * x)
    }

    /// dA/dX at X, rad/mm.
    pub fn slope(&self, x: f64) -> f64 {
        self.k / (1.0 + self.beta * x)
    }

    /// dY/dX = tan C.
    pub fn y_slope(&self) -> f64 {
        self.tan_c
    }

    /// dZ/dX = tan C sin r.
    pub fn z_slope(&self) -> f64 {
        self.z_slope
    }

    /// The cutter's radius at X, mm.
    pub fn radius(&self, x: f64) -> f64 {
        0.5 * self.cutter.d1 + x * self.tan_c
    }

    /// The radius at which A counts, mm: that of the cutter, but no less than a twentieth of the greatest. Towards a tip
    /// the surface shrinks to nothing, and the distance at the surface alone would let A do anything there.
    pub fn metric_radius(&self, x: f64) -> f64 {
        self.radius(x).max(0.05 * self.max_radius())
    }

    /// The greatest radius between start and end, mm.
    pub fn max_radius(&self) -> f64 {
        self.radius(self.start()).max(self.radius(self.end()))
    }

    /// X Y Z in mm and A in degrees, A given in radians without the index.
    pub fn position_with(&self, x: f64, a: f64) -> Position {
        let [y, z] = self.shift;
        [x, y + x * self.tan_c, z + x * self.z_slope, self.index + a * DEGREES, 0.0, 0.0]
    }

    /// X Y Z in mm and A in degrees.
    pub fn position(&self, x: f64) -> Position {
        self.position_with(x, self.angle(x))
    }

    /// X of about the nearest place of the curve to a position, between start and end. With e the error in A at equal X and
    /// m = dA/dX, a step s along the tangent leaves c² s² + R² (e − m s)², which is least at
    ///
    /// ```text
    /// s = R² m e / (c² + R² m²)
    /// ```
    pub fn nearest_x(&self, p: &Position) -> f64 {
        let x = p[0].clamp(self.start(), self.end());
        let e = (p[3] - self.index) / DEGREES - self.angle(x);
        let (c, turn) = (self.length_per_x(), self.metric_radius(x) * self.slope(x));
        let s = self.metric_radius(x) * turn * e / (c * c + turn * turn);
        (x + s).clamp(self.start(), self.end())
    }

    /// Path of X Y Z per mm of X.
    pub fn length_per_x(&self) -> f64 {
        (1.0 + self.tan_c * self.tan_c + self.z_slope * self.z_slope).sqrt()
    }

    /// How much of a measure passes per mm of X.
    pub fn rate(&self, measure: Measure, x: f64) -> f64 {
        let c = self.length_per_x();
        let beside = |a: f64| (c * c + a * a).sqrt();
        match measure {
            Measure::Path => c,
            Measure::Edge => beside(self.radius(x) * self.slope(x)),
            Measure::X => 1.0,
            Measure::A => (self.slope(x) * DEGREES).abs(),
            Measure::PathAndDegrees => beside(self.slope(x) * DEGREES),
        }
    }

    /// How much of a measure passes from start to end: ∫ rate dX by Simpson's rule on 128 intervals equal in ln q. The
    /// integrand is smooth and changes by a few percent an interval, so the rule is right to some 1e-8.
    pub fn amount(&self, measure: Measure) -> f64 {
        let rate = |x: f64| self.rate(measure, x);
        let breaks: Vec<f64> = self.breaks(128, 1000.0).collect();
        breaks
            .windows(2)
            .map(|w| (w[1] - w[0]) / 6.0 * (rate(w[0]) + 4.0 * rate(0.5 * (w[0] + w[1])) + rate(w[1])))
            .sum()
    }

    /// Upper bounds of how far the curve runs between two X, mm at the surface and radians. dA/dX and R are monotone, so
    /// each is greatest at one of the two.
    pub fn run_bound(&self, from: f64, to: f64) -> (f64, f64) {
        let slope = self.slope(from).abs().max(self.slope(to).abs());
        let turn = slope * self.metric_radius(from).max(self.metric_radius(to));
        let speed = (self.length_per_x() * self.length_per_x() + turn * turn).sqrt();
        let run = (to - from).abs();
        (run * speed, run * slope)
    }

    /// Points start = x₀ < … < xₙ = end that share a fit of order `order` out evenly.
    ///
    /// With q = 1 + βX the curve looks alike between q and ρq for every q: pieces of equal ratio have equal error in
    /// A. At the surface it grows with R ∝ q, so an error ∝ hᵐ is the same in every piece when the joints are equally
    /// spaced in q^(1/m).
    pub fn breaks(&self, n: usize, order: f64) -> impl Iterator<Item = f64> + use<> {
        let (beta, start, end) = (self.beta, self.start(), self.end());
        // Counted from the start, q/q₀ = 1 + β′(X − x₀) with β′ = β/q₀.
        let (beta, length) = (beta / (1.0 + beta * start), end - start);
        let last = ln_1p(beta * length) / order; // ln of (q/q₀)^(1/m) at the end
        let reach = exp_m1(last);
        (0..=n).map(move |i| {
            let share = i as f64 / n as f64;
            if i == 0 {
                start
            } else if i == n {
                end
            } else if reach == 0.0 {
                start + share * length
            } else {
                start + exp_m1(order * ln_1p(share * reach)) / beta
            }
        })
    }

    /// The lead at X, mm for one turn: 2π/|dA/dX|; infinite for a straight flute.
    pub fn lead(&self, x: f64) -> f64 {
        2.0 * std::f64::consts::PI / self.slope(x).abs()
    }

    /// The helix angle at X along the cone's axis, degrees: atan(R dA/dX).
    pub fn helix_axial(&self, x: f64) -> f64 {
        atan(self.radius(x) * self.slope(x).abs()) * DEGREES
    }

    /// The helix angle at X along the cone's generatrix, degrees: atan(R dA/dX cos C).
    pub fn helix_generatrix(&self, x: f64) -> f64 {
        atan(self.radius(x) * self.slope(x).abs() * cos(self.cutter.c / DEGREES)) * DEGREES
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// The paper's cutter: D1 = 10, S = 30°, C = 5°, r = 8°, 30 mm.
    pub(crate) fn paper() -> Cutter {
        Cutter { d1: 10.0, s: 30.0, c: 5.0, r: 8.0, length: 30.0, hand: Hand::Right, law: Law::ConstantHelix }
    }

    #[test]
    fn angle_is_the_papers_equation_4() {
        let curve = LogCurve::new(paper(), 0.0).unwrap();
        let (a, b) = (tan(30.0 / DEGREES) / tan(5.0 / DEGREES), 2.0 * tan(5.0 / DEGREES) / 10.0);
        // Both sides are a few roundings from the true value.
        assert_relative_eq!(curve.angle(28.4736), a * ln_1p(b * 28.4736), max_relative = 4e-16);
    }

    #[test]
    fn cylinder_and_straight_flute_are_limits() {
        let cylinder = LogCurve::new(Cutter { c: 0.0, ..paper() }, 0.0).unwrap();
        assert_relative_eq!(
            cylinder.angle(30.0),
            30.0 * 2.0 * tan(30.0 / DEGREES) / 10.0,
            max_relative = 4e-16
        );
        // ln(1+ε)/ε = 1 − ε/2, and ε = bX is 1e-8 of a cone angle of 1e-8 rad times 6.
        let nearly = LogCurve::new(Cutter { c: 1e-8, ..paper() }, 0.0).unwrap();
        assert_relative_eq!(nearly.angle(30.0), cylinder.angle(30.0), max_relative = 1e-9);
        assert_eq!(LogCurve::new(Cutter { s: 0.0, ..paper() }, 0.0).unwrap().angle(30.0), 0.0);
    }

    #[test]
    fn a_point_before_the_end_is_refused() {
        let error = LogCurve::new(Cutter { c: -45.0, ..paper() }, 0.0).unwrap_err();
        assert!(matches!(error, CutterError::Vanishes { at } if (at - 5.0).abs() < 1e-9));
    }

    #[test]
    fn breaks_run_from_zero_to_the_end() {
        for c in [5.0, -5.0, 0.0] {
            let curve = LogCurve::new(Cutter { c, ..paper() }, 0.0).unwrap();
            let breaks: Vec<f64> = curve.breaks(7, 6.0).collect();
            assert_eq!((breaks[0], breaks[7]), (0.0, 30.0));
            assert!(breaks.windows(2).all(|w| w[0] < w[1]), "{breaks:?}");
        }
    }

    #[test]
    fn length_with_degrees_has_its_closed_form() {
        // ∫√(c² + K²/q²) dq/b = [√(c²q² + K²) − K arsinh(K/(cq))]/b with K = 180k/π.
        let curve = LogCurve::new(paper(), 0.0).unwrap();
        let (c, k, b) = (curve.length_per_x(), curve.k() * DEGREES, curve.beta());
        let arsinh = |x: f64| ln_1p(x + (1.0 + x * x).sqrt() - 1.0);
        let whole = |q: f64| ((c * q * c * q + k * k).sqrt() - k * arsinh(k / (c * q))) / b;
        assert_relative_eq!(
            curve.amount(Measure::PathAndDegrees),
            whole(1.0 + 30.0 * b) - whole(1.0),
            max_relative = 1e-8
        );
        let straight = LogCurve::new(Cutter { s: 0.0, ..paper() }, 0.0).unwrap();
        assert_relative_eq!(
            straight.amount(Measure::PathAndDegrees),
            30.0 * straight.length_per_x(),
            max_relative = 1e-12
        );
    }

    #[test]
    fn lead_grows_with_the_diameter() {
        let curve = LogCurve::new(paper(), 0.0).unwrap();
        // lead = π D / tan S
        let d2 = 10.0 + 60.0 * tan(5.0 / DEGREES);
        assert_relative_eq!(
            curve.lead(30.0),
            std::f64::consts::PI * d2 / tan(30.0 / DEGREES),
            max_relative = 1e-14
        );
        assert_relative_eq!(curve.helix_axial(30.0), 30.0, max_relative = 1e-14);
    }
}
