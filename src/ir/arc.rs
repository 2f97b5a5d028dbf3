//! Arcs in decimals: what a block says, and the circle that it means.

use super::Units;
use crate::decimal::{Decimal, power_of_ten, round_units, units_to_f64};
use crate::geom::arc::{Arc, Frame, Plane, Sense, turned};
use crate::units::{DEGREES, MAX_AXES, Position};

/// An arc or a helix.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenArc {
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
    /// Its centre, G2 and G3 with I J K, C about CC; and how many whole turns it makes before the way to its end, TURN.
    Center(Circle, u32),
    /// A place on the way, in any plane: CIP.
    Way(Units),
    /// Its centre, and how far it turns, degrees, instead of its end in the plane: CP about CC. The end is the place
    /// nearest to where that leads.
    Turn(Circle, Decimal),
}

/// A plane of the machine, a sense, and a centre in the plane's first and second axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    /// The plane.
    pub plane: Plane,
    /// Which way round.
    pub sense: Sense,
    /// The centre.
    pub center: [i64; 2],
}

impl Circle {
    /// The centre, mm.
    pub fn place(&self, digits: &[u8; MAX_AXES]) -> [f64; 2] {
        let [u, v, _] = self.plane.axes();
        [units_to_f64(self.center[0], digits[u]), units_to_f64(self.center[1], digits[v])]
    }

    /// By how much the radii to the start and to the end of an arc differ, mm: | |s − c| − |e − c| |, which is what controls look
    /// at before they run one.
    pub fn misfit(&self, digits: &[u8; MAX_AXES], (start, end): (&Units, &Units)) -> f64 {
        let [u, v, _] = self.plane.axes();
        let [x, y] = self.place(digits);
        let radius = |p: &Units| {
            let (a, b) = (units_to_f64(p[u], digits[u]) - x, units_to_f64(p[v], digits[v]) - y);
            (a * a + b * b).sqrt()
        };
        (radius(start) - radius(end)).abs()
    }

    /// The most that [`Circle::misfit`] is where start, end and centre lie on one circle but for their rounding, mm.
    ///
    /// Each of the three is off by half a unit in both axes of the plane, so by ρ = √(h_u² + h_v²) at most. The start moves its
    /// own radius by ρ, the end its own, the centre both: 4ρ. A centre that is counted from the start is off by that of the start
    /// too, which leaves the radius of the start its own ρ alone, and that of the end three: 4ρ again. Some of the last place of a
    /// float is added.
    pub fn rounding(&self, digits: &[u8; MAX_AXES]) -> f64 {
        let [u, v, _] = self.plane.axes();
        let half = |i: usize| 0.5 * units_to_f64(1, digits[i]);
        4.0 * (half(u) * half(u) + half(v) * half(v)).sqrt() * (1.0 + 1.0e-6)
    }
}

impl WrittenArc {
    /// The arc that it means; none where it has no radius, or where its three places lie on a line.
    pub fn arc(&self, digits: &[u8; MAX_AXES]) -> Option<Arc> {
        let place =
            |units: &Units| -> Position { std::array::from_fn(|i| units_to_f64(units[i], digits[i])) };
        let (start, end) = (place(&self.start), place(&self.end));
        match self.by {
            ArcBy::Center(circle, turns) => {
                let arc = Arc::new(circle.plane, circle.sense, start, end, circle.place(digits)).ok()?;
                Some(arc.with_turns(turns))
            }
            ArcBy::Turn(circle, degrees) => {
                let arc = Arc::new(circle.plane, circle.sense, start, end, circle.place(digits)).ok()?;
                // The end that is nearest to where the angle leads may be a little before it or behind.
                let more = sweep(circle.sense, degrees).abs() / arc.sweep().abs() * arc.turns() - arc.turns();
                Some(arc.with_turns(more.round().max(0.0) as u32))
            }
            ArcBy::Way(way) => by_way(*digits, &self.start, &way, &self.end),
        }
    }
}

/// The arc from `start` by `way` to `end`; none where they lie on a line.
fn by_way(digits: [u8; MAX_AXES], start: &Units, way: &Units, end: &Units) -> Option<Arc> {
    let place = |units: &Units| -> Position { std::array::from_fn(|i| units_to_f64(units[i], digits[i])) };
    let flat = Plane::ALL.into_iter().find(|plane| {
        let [.., w] = plane.axes();
        start[w] == way[w] && start[w] == end[w]
    });
    if let Some(plane) = flat {
        let (sense, center) = through(plane, digits, start, way, end)?;
        return Arc::new(plane, sense, place(start), place(end), center).ok();
    }
    let (normal, center) = in_space(digits, start, way, end)?;
    // A plane that is no plane of the machine has an axis of its own.
    let (frame, _) = Frame::about(normal, 0.0)?;
    let [u, v, _] = frame.local(center);
    Arc::new(frame, Sense::CounterClockwise, place(start), place(end), [u, v]).ok()
}

/// The ways from `s` to `p` and to `e` along these axes, in units of the smallest decimal of them, and that.
///
/// None where they are too large for products of four of them: ways up to 2·10⁵ mm with six decimals make 10³⁴.
fn ways<const N: usize>(
    axes: [usize; N],
    digits: [u8; MAX_AXES],
    s: &Units,
    p: &Units,
    e: &Units,
) -> Option<([i128; N], [i128; N], u8)> {
    let most = axes.iter().map(|i| digits[*i]).max()?;
    let scaled = |to: &Units, axis: usize| {
        let way = i128::from(to[axis]) - i128::from(s[axis]);
        way.checked_mul(i128::from(power_of_ten(most - digits[axis]))).filter(|way| way.abs() < 1 << 61)
    };
    let (mut b, mut c) = ([0; N], [0; N]);
    for (k, axis) in axes.into_iter().enumerate() {
        (b[k], c[k]) = (scaled(p, axis)?, scaled(e, axis)?);
    }
    Some((b, c, most))
}

/// The sense and the centre, mm, of the arc from `s` by `p` to `e` in a plane of the machine; none where they lie on a line.
///
/// With b = p − s, c = e − s and b × c = b_u c_v − b_v c_u, which is positive counter-clockwise, the centre is
///
/// ```text
/// s + ( c_v b² − b_v c²,  b_u c² − c_u b² ) / (2 b × c)
/// ```
///
/// Differences of decimals are whole numbers, so that all but the last division is exact; none too where they are too large
/// for that.
fn through(
    plane: Plane,
    digits: [u8; MAX_AXES],
    s: &Units,
    p: &Units,
    e: &Units,
) -> Option<(Sense, [f64; 2])> {
    let [u, v, _] = plane.axes();
    let (b, c, most) = ways([u, v], digits, s, p, e)?;
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

/// The axis about which the arc from `s` by `p` to `e` goes counter-clockwise, of any length, and its centre, mm, in X Y Z;
/// none where they lie on a line.
///
/// With b = p − s, c = e − s and n = b × c, along which the arc is counter-clockwise, the centre is
///
/// ```text
/// s + ( c² n × b + b² c × n ) / (2 n²)
/// ```
///
/// b, c, their squares and n are whole numbers. What is rounded behind them costs some ε R (|b| + |c|)/|b − c|, so that where
/// p and e are the nearest of the three the same is done from e.
fn in_space(digits: [u8; MAX_AXES], s: &Units, p: &Units, e: &Units) -> Option<([f64; 3], [f64; 3])> {
    let (mut b, mut c, most) = ways([0, 1, 2], digits, s, p, e)?;
    // Below 2⁶¹ each, so that neither a difference of two products nor a sum of three squares is too large.
    let n = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
    if n == [0; 3] {
        return None;
    }
    let square = |a: [i128; 3]| a.iter().map(|x| x * x).sum::<i128>();
    let across = std::array::from_fn(|i| b[i] - c[i]);
    let mut from = s;
    if square(across) < square(b).min(square(c)) {
        // s − e and p − e, whose product is n too.
        (from, b, c) = (e, c.map(|x| -x), across);
    }
    let unit = power_of_ten(most) as f64;
    // In mm and mm².
    let length = |a: [i128; 3], by: f64| a.map(|x| x as f64 / by);
    let (b2, c2) = (square(b) as f64 / (unit * unit), square(c) as f64 / (unit * unit));
    let (b, c, n) = (length(b, unit), length(c, unit), length(n, unit * unit));
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let (first, second) = (cross(n, b), cross(c, n));
    let n2 = n.iter().map(|x| x * x).sum::<f64>();
    let center = std::array::from_fn(|i| {
        units_to_f64(from[i], digits[i]) + (c2 * first[i] + b2 * second[i]) / (2.0 * n2)
    });
    Some((n, center))
}

/// Radians, counter-clockwise being positive.
pub fn sweep(sense: Sense, degrees: Decimal) -> f64 {
    let sweep = degrees.to_f64() / DEGREES;
    match sense {
        Sense::CounterClockwise => sweep,
        Sense::Clockwise => -sweep,
    }
}

/// The place in decimals nearest to where a turn about a centre leads; the other axes as `end` has them.
pub fn turned_end(
    digits: &[u8; MAX_AXES],
    (start, end): (&Units, &Units),
    circle: &Circle,
    degrees: Decimal,
) -> Option<Units> {
    let [u, v, _] = circle.plane.axes();
    let place = |units: &Units| -> Position { std::array::from_fn(|i| units_to_f64(units[i], digits[i])) };
    let by = sweep(circle.sense, degrees);
    let to = turned(circle.plane, place(start), place(end), circle.place(digits), by);
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
        let found = through(Plane::Xy, DIGITS, &s, &p, &e);
        assert_eq!(found, Some((Sense::CounterClockwise, [5.0, 0.0])));
        assert_eq!(through(Plane::Xy, DIGITS, &e, &p, &s).map(|found| found.0), Some(Sense::Clockwise));
        assert_eq!(through(Plane::Xy, DIGITS, &s, &at(5.0, 0.0, 1.0), &e), None);
        // In Z X an arc from Z to X is counter-clockwise about Y; the axes may differ in their decimals.
        let mut digits = DIGITS;
        digits[2] = 3;
        let (s, p, e) = ([0, 0, 5_000, 0, 0, 0], [3_000_000, 0, 4_000, 0, 0, 0], [5_000_000, 0, 0, 0, 0, 0]);
        assert_eq!(through(Plane::Zx, digits, &s, &p, &e), Some((Sense::CounterClockwise, [0.0, 0.0])));
        // Larger than any machine: no overflow.
        let far = [i64::MAX / 2, i64::MAX / 3, 0, 0, 0, 0];
        assert_eq!(through(Plane::Xy, DIGITS, &[i64::MIN / 2; 6], &far, &[0; 6]), None);
        assert_eq!(in_space(DIGITS, &[i64::MIN / 2; 6], &far, &[0; 6]), None);
    }

    #[test]
    fn three_places_in_space_make_a_circle() {
        // Of the 3-4-5 triangle: u = (3, 0, 4)/5 and v = Y, so that w = (−4, 0, 3)/5, about (1, 2, 3) with R 5.
        let (s, p, e) = (at(4.0, 2.0, 7.0), at(1.0, 7.0, 3.0), at(-2.0, 2.0, -1.0));
        let (normal, center) = in_space(DIGITS, &s, &p, &e).unwrap();
        assert_eq!(center, [1.0, 2.0, 3.0]);
        // Twice the area of the triangle, 50, along w.
        assert_eq!(normal, [-40.0, 0.0, 30.0]);
        let arc = by_way(DIGITS, &s, &p, &e).unwrap();
        assert!((arc.radius() - 5.0).abs() < 1e-14 && (arc.sweep() - std::f64::consts::PI).abs() < 1e-15);
        let quarter = arc.eval(0.5);
        assert!((quarter[0] - 1.0).abs() < 1e-14 && (quarter[1] - 7.0).abs() < 1e-14, "{quarter:?}");
        assert!(by_way(DIGITS, &s, &at(1.0, 2.0, 3.0), &e).is_none(), "on a line");
        // Another place of the same circle, next to its end: (−24, 7)/25 of R, which lies in whole decimals.
        let (normal, center) = in_space(DIGITS, &s, &at(-1.88, 3.4, -0.84), &e).unwrap();
        assert!(
            normal[0] < 0.0 && (0..3).all(|i| (center[i] - [1.0, 2.0, 3.0][i]).abs() < 1e-14),
            "{center:?}"
        );
    }

    #[test]
    fn turns_lead_to_the_nearest_place() {
        let circle = Circle { plane: Plane::Xy, sense: Sense::CounterClockwise, center: [0, 0] };
        let ends = (&[50_000, 0, 0, 0, 0, 0], &[0, 0, -7, 0, 0, 0]);
        let to = |degrees| turned_end(&[4; MAX_AXES], ends, &circle, Decimal::new(degrees, 1));
        assert_eq!(to(900), Some([0, 50_000, -7, 0, 0, 0]));
        assert_eq!(to(3600), Some([50_000, 0, -7, 0, 0, 0]));
        assert_eq!(to(300), Some([43_301, 25_000, -7, 0, 0, 0]));
        // Two turns and a quarter: the arc that is meant turns by so much.
        let by = ArcBy::Turn(circle, Decimal::new(8100, 1));
        let arc = WrittenArc { start: *ends.0, end: to(8100).unwrap(), by, line: 0 };
        assert!((arc.arc(&[4; MAX_AXES]).unwrap().turns() - 2.25).abs() < 1e-12);
    }
}
