//! Parts of circles and ellipses, anywhere in space.
//!
//! ```text
//! P(θ) = c + u cos θ + v sin θ          from ≤ θ ≤ to,  0 < to − from ≤ 2π
//! ```
//!
//! with u and v the half axes. An affine map takes it to another one of c, u and v mapped, so nothing is lost by any
//! transformation. As a rational quadratic, a part that turns by δ < π about the angle m in its middle is
//!
//! ```text
//! P_0 = P(m − δ/2)     P_1 = c + (u cos m + v sin m)/cos(δ/2)     P_2 = P(m + δ/2)          weights 1, cos(δ/2), 1
//! ```
//!
//! (Piegl and Tiller, *The NURBS Book*, 7.3), which no affine map changes.

use super::Point;
use super::turn::Turn;
use crate::geom::arc::{Arc, Plane, Sense};
use crate::geom::bezier::Bezier;
use crate::geom::elementary::{cos, sin};
use crate::units::{MAX_AXES, Position};

/// 2π.
pub(super) const TURN: f64 = 2.0 * std::f64::consts::PI;

/// Half axes are equal and square to each other, and parallel to a plane of the machine, within this share of their length:
/// what a few roundings leave.
const ROUND: f64 = 1.0e-12;

/// A part of an ellipse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conic<P = Point> {
    /// c.
    pub center: P,
    /// u.
    pub u: P,
    /// v.
    pub v: P,
    /// The angle at which it starts.
    pub from: f64,
    /// The angle at which it ends, which is greater.
    pub to: f64,
    /// What `to` may differ from the angle that is stated, where a whole turn was made of it.
    pub error: f64,
    /// Where it starts.
    pub start: P,
    /// Where it ends; where it starts, for a whole turn.
    pub end: P,
}

fn at<const N: usize>(center: &[f64; N], u: &[f64; N], v: &[f64; N], angle: f64, out: f64) -> [f64; N] {
    let (c, s) = (cos(angle) / out, sin(angle) / out);
    std::array::from_fn(|i| center[i] + c * u[i] + s * v[i])
}

/// a · b.
pub(super) fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// a × b.
pub(super) fn cross(a: &Point, b: &Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// a in its own direction, of length 1; none where it has no direction.
pub(super) fn unit(a: &Point) -> Option<Point> {
    let size = dot(a, a).sqrt();
    (0.0 < size && size.is_finite()).then(|| a.map(|x| x / size))
}

impl Conic {
    /// The part that starts at an angle.
    pub(super) fn new(center: Point, u: Point, v: Point, from: f64, turn: Turn) -> Conic {
        let start = at(&center, &u, &v, from, 1.0);
        let to = from + turn.by;
        // A whole turn ends where it starts to the last bit.
        let end = if turn.is_whole() { start } else { at(&center, &u, &v, to, 1.0) };
        Conic { center, u, v, from, to, error: turn.error, start, end }
    }

    /// The place at an angle.
    pub(super) fn place(center: &Point, u: &Point, v: &Point, angle: f64) -> Point {
        at(center, u, v, angle, 1.0)
    }

    /// Whether it is a whole turn: no other part is within some roundings of one.
    fn is_whole(&self) -> bool {
        TURN - 1e-9 <= self.to - self.from
    }

    /// The same part with its ends at these places, which are very near to them; a whole turn has the first of them.
    pub(super) fn with_ends(self, start: Point, end: Point) -> Conic {
        Conic { start, end: if self.is_whole() { start } else { end }, ..self }
    }

    /// How far its end may be from the stated one: what [`Conic::error`] makes of the greater half axis a,
    ///
    /// ```text
    /// a² = (u² + v² + √((u² − v²)² + 4(u·v)²))/2
    /// ```
    pub(super) fn apart(&self) -> f64 {
        let (uu, vv, uv) = (dot(&self.u, &self.u), dot(&self.v, &self.v), dot(&self.u, &self.v));
        let greater = 0.5 * (uu + vv + ((uu - vv) * (uu - vv) + 4.0 * uv * uv).sqrt());
        self.error * greater.sqrt()
    }

    /// The angle at which a place lies, where half axes are square to each other.
    pub(super) fn angle(center: &Point, u: &Point, v: &Point, place: &Point) -> f64 {
        let d: Point = std::array::from_fn(|i| place[i] - center[i]);
        crate::geom::elementary::atan2(dot(&d, v) / dot(v, v), dot(&d, u) / dot(u, u))
    }

    /// How far the ends are from the places at their angles.
    pub(super) fn misfit(&self) -> f64 {
        let gap = |angle, place: &Point| {
            let on = at(&self.center, &self.u, &self.v, angle, 1.0);
            on.iter().zip(place).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()))
        };
        gap(self.from, &self.start).max(gap(self.to, &self.end))
    }

    /// The same part from its end to its start: P(−θ) with −v for v.
    pub(super) fn reversed(self) -> Conic {
        let Conic { v, from, to, start, end, .. } = self;
        Conic { v: v.map(|x| -x), from: -to, to: -from, start: end, end: start, ..self }
    }

    /// Itself under an affine map of places.
    pub fn mapped<const N: usize>(&self, map: &impl Fn(&Point) -> [f64; N]) -> Conic<[f64; N]> {
        let center = map(&self.center);
        let axis = |axis: &Point| {
            let tip = map(&std::array::from_fn(|i| self.center[i] + axis[i]));
            std::array::from_fn(|i| tip[i] - center[i])
        };
        Conic {
            center,
            u: axis(&self.u),
            v: axis(&self.v),
            from: self.from,
            to: self.to,
            error: self.error,
            start: map(&self.start),
            end: map(&self.end),
        }
    }

    /// Whether it has a length: ends that are one place are so after a whole turn only.
    pub(super) fn moves(&self) -> bool {
        self.start != self.end || 1.0 < self.to - self.from
    }
}

impl Conic<Position> {
    /// As an arc of the machine, where it is a circle in a plane of the first three axes.
    pub fn arc(&self) -> Option<Arc> {
        let (u, v) = (&self.u, &self.v);
        let square = dot(u, u);
        let round = (dot(v, v) - square).abs() <= ROUND * square && dot(u, v).abs() <= ROUND * square;
        let plane = [Plane::Xy, Plane::Zx, Plane::Yz].into_iter().find(|plane| {
            let [.., w] = plane.axes();
            (0..MAX_AXES)
                .filter(|i| *i == w || 2 < *i)
                .all(|i| u[i].abs().max(v[i].abs()) <= ROUND * square.sqrt() && self.start[i] == self.end[i])
        })?;
        let [a, b, _] = plane.axes();
        let turns = u[a] * v[b] - u[b] * v[a];
        let sense = if 0.0 < turns { Sense::CounterClockwise } else { Sense::Clockwise };
        let center = [self.center[a], self.center[b]];
        let arc = Arc::new(plane, sense, self.start, self.end, center).ok().filter(|_| round)?;
        // The ends say where it turns; where they are so near to each other that they do not, the angles do.
        ((arc.sweep().abs() - (self.to - self.from)).abs() <= 1e-6).then_some(arc)
    }

    /// As rational quadratics, each turning by a quarter at most.
    pub fn pieces(&self) -> Vec<Bezier> {
        let count = ((self.to - self.from) / (0.25 * TURN) - 1e-9).ceil().max(1.0);
        let delta = (self.to - self.from) / count;
        let half = cos(0.5 * delta);
        let place = |angle: f64, out: f64| at(&self.center, &self.u, &self.v, angle, out);
        let mut from = self.start;
        (0..count as usize)
            .map(|i| {
                let middle = self.from + (i as f64 + 0.5) * delta;
                let last = i + 1 == count as usize;
                let to = if last { self.end } else { place(middle + 0.5 * delta, 1.0) };
                let mut piece = Bezier::new(&[std::mem::replace(&mut from, to), place(middle, half), to]);
                piece.weights[1] = half;
                piece
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn placed(conic: &Conic) -> Conic<Position> {
        conic.mapped(&|p: &Point| [p[0], p[1], p[2], 0.0, 0.0, 0.0])
    }

    fn turn(by: f64) -> Turn {
        Turn { by, error: 0.0 }
    }

    #[test]
    fn what_a_whole_turn_may_be_off_is_that_of_the_greater_axis() {
        let turn = Turn { by: TURN, error: 1e-6 };
        let round = Conic::new([0.0; 3], [3.0, 0.0, 0.0], [0.0, 5.0, 0.0], 0.0, turn);
        // One rounding of a product.
        assert!((round.apart() - 5e-6).abs() < 1e-20);
        assert_eq!(round.start, round.end);
        // Half axes that are not square to each other: the ellipse of 3 and 5 under a shear has those of the shear.
        let shear = round.mapped(&|p: &Point| [p[0] + p[1], p[1], p[2]]);
        // The greatest singular value of [3 5; 0 5]: its squares add up to 59 and multiply to 225.
        let greatest = 0.5 * (59.0 + (59.0f64 * 59.0 - 900.0).sqrt());
        assert!((shear.apart() - 1e-6 * greatest.sqrt()).abs() < 1e-19);
        assert_eq!(round.with_ends([1.0; 3], [2.0; 3]).end, [1.0; 3]);
    }

    #[test]
    fn pieces_lie_on_the_ellipse_in_order() {
        let conic = Conic::new([1.0, 2.0, 3.0], [4.0, 0.0, 1.0], [0.0, 2.0, 0.0], 0.3, turn(4.7));
        for conic in [conic, conic.reversed()] {
            let pieces = placed(&conic).pieces();
            assert_eq!(pieces.len(), 3);
            assert_eq!(pieces[0].start()[..3], conic.start);
            assert_eq!(pieces[2].end()[..3], conic.end);
            for k in 0..=30 {
                let p = pieces[k / 11].eval(f64::from(u8::try_from(k % 11).unwrap()) / 10.0);
                // u = (4, 0, 1) of length² 17 and v = (0, 2, 0) are square to each other.
                let d = [p[0] - 1.0, p[1] - 2.0, p[2] - 3.0];
                let (a, b) = ((4.0 * d[0] + d[2]) / 17.0, d[1] / 2.0);
                assert!((a * a + b * b - 1.0).abs() < 1e-14, "{k}");
            }
        }
        assert!(placed(&conic).arc().is_none());
    }

    #[test]
    fn circles_are_arcs_in_planes_of_the_machine() {
        let quarter = Conic::new([0.0; 3], [5.0, 0.0, 0.0], [0.0, 5.0, 0.0], 0.0, turn(0.25 * TURN));
        let arc = placed(&quarter).arc().unwrap();
        assert_eq!((arc.plane(), arc.sense()), (Some(Plane::Xy), Sense::CounterClockwise));
        assert!((arc.sweep() - 0.25 * TURN).abs() < 1e-15);
        let back = placed(&quarter.reversed()).arc().unwrap();
        assert_eq!((back.sense(), back.start()), (Sense::Clockwise, arc.end()));
        let full = Conic::new([0.0; 3], [5.0, 0.0, 0.0], [0.0, 0.0, 5.0], 1.0, Turn::WHOLE);
        let full = placed(&full).arc().unwrap();
        // From X to Z about Y is clockwise in the plane Z X.
        assert_eq!((full.plane(), full.sense(), full.is_full()), (Some(Plane::Zx), Sense::Clockwise, true));
        let tilted = Conic::new([0.0; 3], [5.0, 0.0, 0.0], [0.0, 4.0, 3.0], 0.0, turn(1.0));
        assert!(placed(&tilted).arc().is_none());
    }
}
