//! Arcs that are straight, and arcs whose centre no control can be told.
//!
//! A bulge of 10⁻⁶ on a chord of 30 mm is an arc of radius 7.5 km, 1.5·10⁻⁵ mm beside its chord. Drawings have such arcs where
//! somebody's rounding left them. What the arc is from its chord,
//!
//! ```text
//! s = R (1 − cos(δ/2))
//! ```
//!
//! counts in the bound of the proof where the chord is taken for it.

use super::conic::{Conic, dot, unit};
use super::{Path, Point, position};
use crate::geom::bezier::Bezier;
use crate::geom::elementary::{cos, sin, tan};

/// A chord is taken where the arc is no farther from it, mm: half a unit of the fourth decimal, the last that controls read.
const FLAT: f64 = 5.0e-5;

/// And where the arc turns no more, radians: lines that meet at half of it have no corner to a control.
const LEVEL: f64 = 1.0e-4;

/// The greatest radius of an arc, mm: the last place of five digits that a control takes for a centre.
const GREATEST_RADIUS: f64 = 99_999.0;

/// A path as what can be run of it, and how far that may be from what is stated, mm.
pub(super) fn straightened(path: Path) -> (Path, f64) {
    let Path::Conic(conic) = path else { return (path, 0.0) };
    let radius = dot(&conic.u, &conic.u).max(dot(&conic.v, &conic.v)).sqrt();
    let turn = conic.to - conic.from;
    // 1 − cos(δ/2) = 2 sin²(δ/4)
    let quarter = sin(0.25 * turn.min(1.0));
    let sagitta = 2.0 * radius * quarter * quarter;
    if turn <= LEVEL && sagitta <= FLAT {
        return (Path::Lines(vec![conic.start, conic.end], Vec::new()), sagitta + conic.apart());
    }
    let apart = conic.apart();
    if radius <= GREATEST_RADIUS {
        return (Path::Conic(conic), apart);
    }
    let piece = shallow(&conic, turn);
    (Path::Pieces(piece.map_or_else(|| conic.mapped(&position).pieces(), |piece| vec![piece])), apart)
}

/// A part of a circle that turns by less than 1 radian, as a rational quadratic that its centre has no share in: of a centre a
/// thousand kilometres away the last digits are micrometres. With the middle M of a chord of length c, and d from the centre to
/// it, of length 1,
///
/// ```text
/// P_1 = M + d (c/2) tan(δ/2)          weight cos(δ/2)
/// ```
fn shallow(conic: &Conic, turn: f64) -> Option<Bezier> {
    let (uu, vv) = (dot(&conic.u, &conic.u), dot(&conic.v, &conic.v));
    let round = (uu - vv).abs() <= 1e-9 * uu && dot(&conic.u, &conic.v).abs() <= 1e-9 * uu;
    if !round || 1.0 < turn {
        return None;
    }
    let middle = conic.from + 0.5 * turn;
    let out = unit(&Conic::place(&[0.0; 3], &conic.u, &conic.v, middle))?;
    let (p, q) = (&conic.start, &conic.end);
    let chord: Point = std::array::from_fn(|i| q[i] - p[i]);
    let high = 0.5 * dot(&chord, &chord).sqrt() * tan(0.5 * turn);
    let top: Point = std::array::from_fn(|i| p[i].midpoint(q[i]) + high * out[i]);
    let mut piece = Bezier::new(&[position(p), position(&top), position(q)]);
    piece.weights[1] = cos(0.5 * turn);
    Some(piece)
}
