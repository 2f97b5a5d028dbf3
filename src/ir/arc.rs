//! Arcs in decimals: what a block says, and the circle that it means.

use super::Units;
use crate::decimal::{Decimal, power_of_ten, round_units, units_to_f64};
use crate::geom::arc::{Plane, Sense, turned};
use crate::units::{DEGREES, MAX_AXES, Position};

/// An arc, or one turn of a helix at most.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenArc {
    /// Its plane.
    pub plane: Plane,
    /// Which way round.
    pub sense: Sense,
    /// Where it starts.
    pub start: Units,
    /// Where it ends; where it starts, in the plane, for a whole turn.
    pub end: Units,
    /// What else the block says.
    pub by: ArcBy,
    /// The line of the text that it came from, or 0.
    pub line: u32,
}

/// What a block says about an arc beside its start and its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ArcBy {
    /// Its centre, in the plane's first and second axis: G2 and G3 with I J K, C about CC.
    Center([i64; 2]),
    /// A place on the way: CIP.
    Way(Units),
    /// Its centre, and how far it turns, degrees, instead of its end in the plane: CP about CC. The end is the place
    /// nearest to where that leads.
    Turn([i64; 2], Decimal),
}

impl WrittenArc {
    /// The centre, mm; none where a place on the way does not say it, or says another sense.
    pub fn center(&self, digits: &[u8; MAX_AXES]) -> Option<[f64; 2]> {
        let [u, v, _] = self.plane.axes();
        match self.by {
            ArcBy::Center(center) | ArcBy::Turn(center, _) => {
                Some([units_to_f64(center[0], digits[u]), units_to_f64(center[1], digits[v])])
            }
            ArcBy::Way(way) => {
                let (sense, center) = through(self.plane, digits, &self.start, &way, &self.end)?;
                (sense == self.sense).then_some(center)
            }
        }
    }
}

/// The sense and the centre, mm, of the arc from `s` by `p` to `e`; none where they lie on a line.
///
/// With b = p − s, c = e − s and b × c = b_u c_v − b_v c_u, which is positive counter-clockwise, the centre is
///
/// ```text
/// s + ( c_v b² − b_v c²,  b_u c² − c_u b² ) / (2 b × c)
/// ```
///
/// Differences of decimals are whole numbers, so that all but the last division is exact; none too where they are too large
/// for that.
pub fn through(
    plane: Plane,
    digits: &[u8; MAX_AXES],
    s: &Units,
    p: &Units,
    e: &Units,
) -> Option<(Sense, [f64; 2])> {
    let [u, v, _] = plane.axes();
    // In units of the smaller decimal of both. Ways up to 2·10⁵ mm with six decimals make products of 10³⁴.
    let most = digits[u].max(digits[v]);
    let scaled = |to: &Units, axis: usize| {
        let way = i128::from(to[axis]) - i128::from(s[axis]);
        way.checked_mul(i128::from(power_of_ten(most - digits[axis])))
    };
    let (b, c) = ([scaled(p, u)?, scaled(p, v)?], [scaled(e, u)?, scaled(e, v)?]);
    let times = i128::checked_mul;
    let square = |a: [i128; 2]| times(a[0], a[0])?.checked_add(times(a[1], a[1])?);
    let cross = times(b[0], c[1])?.checked_sub(times(b[1], c[0])?)?;
    if cross == 0 {
        return None;
    }
    let (b2, c2) = (square(b)?, square(c)?);
    let across =
        [times(c[1], b2)?.checked_sub(times(b[1], c2)?)?, times(b[0], c2)?.checked_sub(times(c[0], b2)?)?];
    let unit = power_of_ten(most) as f64;
    let start = [units_to_f64(s[u], digits[u]), units_to_f64(s[v], digits[v])];
    let center = [0, 1].map(|i| start[i] + across[i] as f64 / (2.0 * cross as f64) / unit);
    Some((if 0 < cross { Sense::CounterClockwise } else { Sense::Clockwise }, center))
}

/// Radians, counter-clockwise being positive.
pub fn sweep(sense: Sense, degrees: Decimal) -> f64 {
    let sweep = degrees.to_f64() / DEGREES;
    match sense {
        Sense::CounterClockwise => sweep,
        Sense::Clockwise => -sweep,
    }
}

/// The place in decimals nearest to where a turn about `center` leads; the other axes as `end` has them.
pub fn turned_end(
    plane: Plane,
    digits: &[u8; MAX_AXES],
    (start, end): (&Units, &Units),
    center: [i64; 2],
    sweep: f64,
) -> Option<Units> {
    let [u, v, _] = plane.axes();
    let place = |units: &Units| -> Position { std::array::from_fn(|i| units_to_f64(units[i], digits[i])) };
    let about = [units_to_f64(center[0], digits[u]), units_to_f64(center[1], digits[v])];
    let to = turned(plane, place(start), place(end), about, sweep);
    let mut units = *end;
    units[u] = round_units(to[u], digits[u])?;
    units[v] = round_units(to[v], digits[v])?;
    Some(units)
}

#[cfg(test)]
mod tests {
    use super::*;

    const DIGITS: [u8; MAX_AXES] = [6; MAX_AXES];

    fn at(x: f64, y: f64, z: f64) -> Units {
        [x, y, z, 0.0, 0.0, 0.0].map(|x| round_units(x, 6).unwrap())
    }

    #[test]
    fn three_places_make_a_circle() {
        let (s, p, e) = (at(10.0, 0.0, 1.0), at(5.0, 5.0, 1.0), at(0.0, 0.0, 1.0));
        let found = through(Plane::Xy, &DIGITS, &s, &p, &e);
        assert_eq!(found, Some((Sense::CounterClockwise, [5.0, 0.0])));
        assert_eq!(through(Plane::Xy, &DIGITS, &e, &p, &s).map(|found| found.0), Some(Sense::Clockwise));
        assert_eq!(through(Plane::Xy, &DIGITS, &s, &at(5.0, 0.0, 1.0), &e), None);
        // In Z X an arc from Z to X is counter-clockwise about Y; the axes may differ in their decimals.
        let mut digits = DIGITS;
        digits[2] = 3;
        let (s, p, e) = ([0, 0, 5_000, 0, 0, 0], [3_000_000, 0, 4_000, 0, 0, 0], [5_000_000, 0, 0, 0, 0, 0]);
        assert_eq!(through(Plane::Zx, &digits, &s, &p, &e), Some((Sense::CounterClockwise, [0.0, 0.0])));
        // Larger than any machine: no overflow.
        let far = [i64::MAX / 2, i64::MAX / 3, 0, 0, 0, 0];
        assert_eq!(through(Plane::Xy, &DIGITS, &[i64::MIN / 2; 6], &far, &[0; 6]), None);
    }

    #[test]
    fn turns_lead_to_the_nearest_place() {
        let to = |degrees| {
            let sweep = sweep(Sense::CounterClockwise, Decimal::new(degrees, 1));
            turned_end(
                Plane::Xy,
                &[4; MAX_AXES],
                (&[50_000, 0, 0, 0, 0, 0], &[0, 0, -7, 0, 0, 0]),
                [0, 0],
                sweep,
            )
        };
        assert_eq!(to(900), Some([0, 50_000, -7, 0, 0, 0]));
        assert_eq!(to(3600), Some([50_000, 0, -7, 0, 0, 0]));
        assert_eq!(to(300), Some([43_301, 25_000, -7, 0, 0, 0]));
    }
}
