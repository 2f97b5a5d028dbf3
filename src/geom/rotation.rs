//! Rotations of space, and the three angles by which controls state them.
//!
//! A rotation takes coordinates of a turned frame to those of the frame it was turned from: p = R p′. Its columns are the
//! axes X′ Y′ Z′.
//!
//! # Angles
//!
//! A control turns about one axis after the other, each about the axes as turned so far: R = Rᵢ(a) Rⱼ(b) Rₖ(c). With three
//! different axes, ε = 1 where i j k is x y z or follows from it in turn, and −1 otherwise,
//!
//! ```text
//! Rᵢₖ = ε sin b      Rⱼₖ = −ε sin a cos b      Rₖₖ = cos a cos b      Rᵢⱼ = −ε cos b sin c      Rᵢᵢ = cos b cos c
//! ```
//!
//! and with the first axis once more in the third place, k the one that is left,
//!
//! ```text
//! Rᵢᵢ = cos b        Rⱼᵢ = sin a sin b         Rₖᵢ = −ε cos a sin b   Rᵢⱼ = sin b sin c         Rᵢₖ = ε sin b cos c
//! ```
//!
//! Turning about the axes of the frame where it started, in the order k j i, is the same rotation.

use super::elementary::{atan2, cos, sin};
use crate::units::DEGREES;

/// About which axes a control turns, one after the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Order([usize; 3]);

impl Order {
    /// An order by its letters: `xyz`, `zxz`. Two that follow each other are never the same.
    pub fn new(letters: &str) -> Option<Order> {
        let bytes: [u8; 3] = letters.as_bytes().try_into().ok()?;
        let axes = bytes.map(|byte| usize::from(byte.wrapping_sub(b'x')));
        let turns = axes.iter().all(|axis| *axis < 3) && axes[0] != axes[1] && axes[1] != axes[2];
        turns.then_some(Order(axes))
    }

    /// The two axes that are turned about first, the one that is left, and ε.
    fn frame(self) -> ([usize; 3], f64) {
        let [i, j, _] = self.0;
        let k = 3 - i - j;
        ([i, j, k], if (i + 1) % 3 == j { 1.0 } else { -1.0 })
    }

    /// Whether the first axis stands in the third place too.
    fn repeats(self) -> bool {
        self.0[0] == self.0[2]
    }
}

/// A rotation: its columns are the turned axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotation(pub [[f64; 3]; 3]);

/// Below this the sine of the second angle says nothing of the third, which then is 0.
const SINGULAR: f64 = 1.0e-12;

/// cos and sin of an angle in degrees, exact where it is a multiple of 90.
fn turn(degrees: f64) -> (f64, f64) {
    let quarter = (degrees / 90.0).round();
    let rest = (degrees - 90.0 * quarter) / DEGREES;
    let (c, s) = (cos(rest), sin(rest));
    match (quarter as i64).rem_euclid(4) {
        0 => (c, s),
        1 => (-s, c),
        2 => (-c, -s),
        _ => (s, -c),
    }
}

/// atan2 in degrees, never −180 nor −0.
fn degrees(y: f64, x: f64) -> f64 {
    let angle = atan2(y, x) * DEGREES;
    if angle <= -180.0 { 180.0 } else { angle + 0.0 }
}

impl Rotation {
    /// No rotation.
    pub const NONE: Rotation = Rotation([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);

    /// A rotation about an axis, degrees.
    pub fn about(axis: usize, angle: f64) -> Rotation {
        let (c, s) = turn(angle);
        let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut rows = Rotation::NONE.0;
        rows[j][j] = c;
        rows[j][k] = -s;
        rows[k][j] = s;
        rows[k][k] = c;
        Rotation(rows)
    }

    /// The rotation of three angles in degrees: Rᵢ(a) Rⱼ(b) Rₖ(c).
    pub fn of(order: Order, angles: [f64; 3]) -> Rotation {
        let [first, second, third] = [0, 1, 2].map(|n| Rotation::about(order.0[n], angles[n]));
        first.then(&second).then(&third)
    }

    /// The rotation whose Z′ is a direction of any length and whose X′ is level, at a right angle to Z. Y′ points up; along Z
    /// nothing is turned.
    ///
    /// Seen from where the tool comes, a wall of the work stands upright.
    pub fn level(direction: [f64; 3]) -> Rotation {
        let [x, y, z] = direction;
        let flat = (x * x + y * y).sqrt();
        let about_z = if flat == 0.0 { 0.0 } else { degrees(x, -y) };
        Rotation::about(2, about_z).then(&Rotation::about(0, degrees(flat, z)))
    }

    /// This rotation, and in its frame another one: the product of both.
    #[must_use]
    pub fn then(&self, other: &Rotation) -> Rotation {
        let element = |i: usize, j: usize| (0..3).map(|k| self.0[i][k] * other.0[k][j]).sum::<f64>();
        Rotation(std::array::from_fn(|i| std::array::from_fn(|j| element(i, j))))
    }

    /// The angle θ of the rotation that takes this one to another, radians, 0 ≤ θ ≤ π.
    ///
    /// It is the turn of R₁ᵀR₂, whose trace is 1 + 2 cos θ, so that with the sum of the squares of all differences
    ///
    /// ```text
    /// ‖R₁ − R₂‖² = 2 tr(1 − R₁ᵀR₂) = 4 (1 − cos θ) = 8 sin² θ/2
    /// ```
    ///
    /// A cosine says nothing of angles below 1e-8; the differences do.
    pub fn angle_to(&self, other: &Rotation) -> f64 {
        let columns = self.0.iter().flatten().zip(other.0.iter().flatten());
        let squares: f64 = columns.map(|(a, b)| (a - b) * (a - b)).sum();
        2.0 * atan2(squares.sqrt(), (8.0 - squares).max(0.0).sqrt())
    }

    /// The angles of this rotation in degrees, each above −180 and at most 180. Where the second one leaves the third open,
    /// that is 0.
    pub fn angles(&self, order: Order) -> [f64; 3] {
        let r = &self.0;
        let ([i, j, k], sign) = order.frame();
        let (sine, angles) = if order.repeats() {
            let sine = (r[i][j] * r[i][j] + r[i][k] * r[i][k]).sqrt();
            let (a, c) = (degrees(r[j][i], -sign * r[k][i]), degrees(r[i][j], sign * r[i][k]));
            (sine, [a, degrees(sine, r[i][i]), c])
        } else {
            let cosine = (r[i][i] * r[i][i] + r[i][j] * r[i][j]).sqrt();
            let (a, c) = (degrees(-sign * r[j][k], r[k][k]), degrees(-sign * r[i][j], r[i][i]));
            (cosine, [a, degrees(sign * r[i][k], cosine), c])
        };
        if SINGULAR < sine { angles } else { [degrees(sign * r[k][j], r[j][j]), angles[1], 0.0] }
    }

    /// The rotation back: Rᵀ.
    #[must_use]
    pub fn inverse(&self) -> Rotation {
        Rotation(std::array::from_fn(|i| std::array::from_fn(|j| self.0[j][i])))
    }

    /// The turned axis Z′.
    pub fn axis(&self) -> [f64; 3] {
        [self.0[0][2], self.0[1][2], self.0[2][2]]
    }

    /// A vector of the turned frame in the frame it was turned from: R p′.
    pub fn out(&self, p: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|i| (0..3).map(|j| self.0[i][j] * p[j]).sum())
    }

    /// A vector in the turned frame: Rᵀ p.
    pub fn into_frame(&self, p: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|i| (0..3).map(|j| self.0[j][i] * p[j]).sum())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Every order that turns in three steps.
    fn orders() -> Vec<Order> {
        let letters = ["x", "y", "z"];
        let all = letters.iter().flat_map(|a| letters.iter().map(move |b| format!("{a}{b}")));
        all.flat_map(|two| letters.iter().map(move |c| format!("{two}{c}")))
            .filter_map(|three| Order::new(&three))
            .collect()
    }

    fn apart(a: &Rotation, b: &Rotation) -> f64 {
        (0..9).map(|n| (a.0[n / 3][n % 3] - b.0[n / 3][n % 3]).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn the_angle_between_rotations_is_that_of_the_turn_from_one_to_the_other() {
        let order = Order::new("zxz").unwrap();
        let own = Rotation::of(order, [31.0, 47.0, -112.0]);
        assert_eq!(own.angle_to(&own), 0.0);
        for axis in 0..3 {
            for degrees in [1.0e-9, 1.0e-4, 0.009, 0.5, 30.0, 90.0, 179.0, -0.009, -120.0] {
                let other = own.then(&Rotation::about(axis, degrees));
                // Each element rounds some three times, by less than 2.2e-16 each; near half a turn cos θ/2 is 1/115, and errors
                // count so much more.
                let error = (own.angle_to(&other) - degrees.abs() / DEGREES).abs();
                assert!(error < 115.0 * 9.0 * 2.2e-16 * 3.0, "{axis} {degrees}: {error:e}");
                assert!(error < 1.0e-14 || 90.0 < degrees.abs(), "{axis} {degrees}: {error:e}");
                assert_eq!(own.angle_to(&other), other.angle_to(&own));
            }
        }
    }

    #[test]
    fn an_order_is_three_letters_that_turn() {
        assert_eq!(orders().len(), 12);
        for wrong in ["", "xy", "xxz", "xzz", "abc", "xyzx", "XYZ"] {
            assert_eq!(Order::new(wrong), None, "{wrong}");
        }
    }

    /// A quarter turn each, by hand: Heidenhain's SPA+45 SPB+0 SPC+90 is 90 about Z and then 45 about the new X.
    #[test]
    fn turns_follow_the_turned_axes() {
        let r = Rotation::of(Order::new("zyx").unwrap(), [90.0, 0.0, 90.0]);
        // X′ lies along Y, Y′ points up, Z′ lies along X.
        assert_eq!(r.0, [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        assert_eq!(r.axis(), [1.0, 0.0, 0.0]);
        assert_eq!(Rotation::level([2.0, 0.0, 0.0]), r);
        assert_eq!(r.out([1.0, 2.0, 3.0]), [3.0, 1.0, 2.0]);
        assert_eq!(r.into_frame([3.0, 1.0, 2.0]), [1.0, 2.0, 3.0]);
    }

    #[test]
    fn walls_stand_upright() {
        for (direction, x, y) in [
            ([0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
            ([0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
            ([0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
            ([-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]),
            ([0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]),
        ] {
            let r = Rotation::level(direction);
            assert_eq!(r.axis(), direction);
            assert_eq!((r.out([1.0, 0.0, 0.0]), r.out([0.0, 1.0, 0.0])), (x, y), "{direction:?}");
        }
    }

    #[test]
    fn where_two_turns_are_about_one_axis_the_third_is_none() {
        for order in orders() {
            let middle = if order.repeats() { 0.0 } else { 90.0 };
            for turned in [middle, middle - 180.0] {
                let r = Rotation::of(order, [25.0, turned, 40.0]);
                let angles = r.angles(order);
                assert_eq!(angles[2], 0.0, "{order:?}");
                assert!(apart(&Rotation::of(order, angles), &r) < 1e-14, "{order:?} {angles:?}");
            }
        }
    }

    proptest! {
        /// Each of the formulas is off by some roundings of numbers up to 1; a second angle that leaves the third open takes
        /// half of the digits.
        #[test]
        fn angles_make_their_rotation(
            axes in 0usize..12, a in -180.0..180.0f64, b in -180.0..180.0f64, c in -180.0..180.0f64,
        ) {
            let order = orders()[axes];
            let r = Rotation::of(order, [a, b, c]);
            let angles = r.angles(order);
            prop_assert!(angles.iter().all(|angle| -180.0 < *angle && *angle <= 180.0));
            prop_assert!(apart(&Rotation::of(order, angles), &r) < 1e-11, "{order:?} {angles:?}");
            // It keeps lengths, and out and in undo each other.
            let p = [0.3, -1.7, 2.2];
            let back = r.into_frame(r.out(p));
            prop_assert!((0..3).all(|i| (back[i] - p[i]).abs() < 1e-14));
        }

        #[test]
        fn a_level_frame_has_its_axis(x in -1.0..1.0f64, y in -1.0..1.0f64, z in -1.0..1.0f64) {
            let length = (x * x + y * y + z * z).sqrt();
            prop_assume!(1e-3 < length);
            let r = Rotation::level([x, y, z]);
            let axis = r.axis();
            prop_assert!((0..3).all(|i| (axis[i] * length - [x, y, z][i]).abs() < 1e-14));
            prop_assert!(r.0[2][0] == 0.0 && 0.0 <= r.0[2][1]);
        }
    }
}
