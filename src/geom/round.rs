//! Arcs and helices as rational quadratic pieces, for where pieces are needed.
//!
//! An arc of half angle h < π/2 is one piece: its ends, the place where its tangents meet, and the weights 1, cos h, 1. With
//! x = 2t − 1 and k = tan(h/2) it is at the angle 2 atan(kx) from its middle, and a coordinate that goes from −d/2 to d/2 is at
//!
//! ```text
//! d/2 · x (1 + k²) / (1 + k²x²)          where it should be at    d/2 · 2 atan(kx) / h
//! ```
//!
//! Their difference is d/2 · 2/3 k² x (1 − x²) to leading order, at most 0.065 h² · d/2; a test holds 0.07 over the range.

use super::arc::Arc;
use super::bezier::Bezier;
use super::elementary::{cbrt, cos};
use crate::units::MAX_AXES;
use std::f64::consts::FRAC_PI_2;

/// How many coordinates a place in space has.
const SPACE: usize = 3;

/// The bound above.
const ALONG: f64 = 0.07;

/// How exactly other coordinates go along, in their unit.
const EXACT: f64 = 1.0e-7;

/// The most pieces of one arc.
const MOST: f64 = 4096.0;

/// The pieces of an arc, and how far they are from it at most: in its plane by what start, end and centre are from lying on one
/// circle, and in other coordinates.
pub fn pieces(arc: &Arc) -> (Vec<Bezier>, [f64; 2]) {
    let frame = arc.frame();
    let (start, end) = (arc.start(), arc.end());
    // What goes along with the turn: the rise of a helix, and coordinates beside X Y Z.
    let beside = (SPACE..MAX_AXES).map(|i| (end[i] - start[i]) * (end[i] - start[i])).sum::<f64>();
    let (sweep, along) = (arc.sweep().abs(), (arc.rise() * arc.rise() + beside).sqrt());
    // 0.07 (σ/2n)² · d/2n is EXACT.
    let fine = cbrt(ALONG * sweep * sweep * along / (8.0 * EXACT));
    let count = (sweep / FRAC_PI_2).max(fine).ceil().clamp(1.0, MOST);
    let h = 0.5 * sweep / count;
    let w = cos(h);
    let center = arc.center();
    let at = |k: f64| arc.eval(k / count);
    let mut pieces = Vec::with_capacity(count as usize);
    for k in 0..count as usize {
        let k = k as f64;
        let from = if k == 0.0 { start } else { at(k) };
        let to = if k + 1.0 == count { end } else { at(k + 1.0) };
        let mut middle = at(k + 0.5);
        let [u, v, height] = frame.local([middle[0], middle[1], middle[2]]);
        let [u, v] = [center[0] + (u - center[0]) / w, center[1] + (v - center[1]) / w];
        middle[..SPACE].copy_from_slice(&frame.global([u, v, height]));
        let mut piece = Bezier::new(&[from, middle, to]);
        piece.weights[1] = w;
        pieces.push(piece);
    }
    (pieces, [arc.misfit(), ALONG * h * h * 0.5 * along / count])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::arc::{Plane, Sense};
    use crate::geom::elementary::{atan, tan};
    use crate::geom::rotation::Rotation;

    #[test]
    fn other_coordinates_go_along_within_the_bound() {
        for i in 1..=100 {
            let h = f64::from(i) / 100.0 * 0.5 * FRAC_PI_2;
            let k = tan(0.5 * h);
            for j in 0..=100 {
                let x = f64::from(j) / 100.0;
                let off = x * (1.0 + k * k) / (1.0 + k * k * x * x) - 2.0 * atan(k * x) / h;
                assert!(off.abs() <= ALONG * h * h, "h {h} x {x}: {off}");
            }
        }
    }

    #[test]
    fn pieces_lie_on_an_arc_about_any_axis() {
        let start = [10.0, 0.0, 1.0, 0.0, 0.0, 0.0];
        let end = [0.0, 10.0, 4.0, 5.0, 0.0, 0.0];
        let flat =
            Arc::new(Plane::Xy, Sense::CounterClockwise, start, end, [0.0, 0.0]).unwrap().with_turns(2);
        // Turned by the 3-4-5 triangle about X: exact but for roundings of 10 mm.
        let r = [[1.0, 0.0, 0.0], [0.0, 0.8, -0.6], [0.0, 0.6, 0.8]];
        let arc = flat.turned(&Rotation(r), 0.0);
        assert_eq!(arc.plane(), None);
        let (found, bounds) = pieces(&arc);
        let (expected, flat_bounds) = pieces(&flat);
        assert_eq!((found.len(), bounds[1]), (expected.len(), flat_bounds[1]));
        for (piece, flat) in found.iter().zip(&expected) {
            for t in [0.0, 0.25, 0.5, 0.9, 1.0] {
                let (p, q) = (piece.eval(t), flat.eval(t));
                for i in 0..3 {
                    let turned = (0..3).map(|j| r[i][j] * q[j]).sum::<f64>();
                    assert!((p[i] - turned).abs() < 1e-13, "{p:?} {q:?}");
                }
                assert!((p[3] - q[3]).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn pieces_lie_on_their_arc() {
        let start = [10.0, 0.0, 1.0, 0.0, 0.0, 0.0];
        for (end, sense) in [
            ([0.0, 10.0, 1.0, 0.0, 0.0, 0.0], Sense::CounterClockwise),
            ([0.0, 10.0, 4.0, 0.0, 0.0, 0.0], Sense::Clockwise),
            ([10.0, 0.0, 6.0, 0.0, 0.0, 0.0], Sense::CounterClockwise),
        ] {
            let arc = Arc::new(Plane::Xy, sense, start, end, [0.0, 0.0]).unwrap();
            let (pieces, [misfit, along]) = pieces(&arc);
            assert_eq!(misfit, 0.0);
            assert!(along <= 1.0001 * EXACT, "{along}");
            let count = pieces.len() as f64;
            for (k, piece) in pieces.iter().enumerate() {
                for t in [0.0, 0.25, 0.5, 0.9, 1.0] {
                    let p = piece.eval(t);
                    // Sixteen digits of 10 mm.
                    assert!(((p[0] * p[0] + p[1] * p[1]).sqrt() - 10.0).abs() < 1e-14, "{p:?}");
                }
                let (middle, on) = (piece.eval(0.5), arc.eval((k as f64 + 0.5) / count));
                assert!((0..3).all(|i| (middle[i] - on[i]).abs() < 1e-14), "{middle:?} {on:?}");
            }
        }
    }
}
