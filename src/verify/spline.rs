//! Splines that were asked for as such, in pieces of the same number and order.
//!
//! A polynomial piece and the one that was written for it are run at the same share of their parameters. Their difference
//! is a polynomial whose control points are the differences of theirs, once both have the same degree, and a Bezier curve
//! stays within its control points:
//!
//! ```text
//! sup |p(t) − q(t)| ≤ max |P_i − Q_i|
//! ```
//!
//! Of rational pieces p = n/d and q = m/e, coordinate by coordinate, with Bernstein coefficients of the numerator:
//!
//! ```text
//! |p − q| = |n e − m d| / (d e) ≤ max |n e − m d| / (min d · min e)
//! ```

use super::{Cursor, Found};
use crate::diagnostic::Diagnostics;
use crate::geom::bezier::Bezier;
use crate::geom::deviation::Bound;
use crate::ir::Written;
use crate::units::Kind;

impl Cursor<'_> {
    /// A spline in pieces; a run of polynomial blocks may hold several.
    pub(super) fn spline(&mut self, asked: &[Bezier], written: &Written) -> Result<Found, Diagnostics> {
        let (pieces, blocks, rest) = match written {
            Written::Polynomial(polynomial) => {
                let blocks = polynomial.blocks.get(self.within..).unwrap_or_default();
                let before = self.within.checked_sub(1).and_then(|last| polynomial.blocks.get(last));
                let mut start = before.map_or(polynomial.start, |block| block.end);
                let piece = |block: &crate::ir::PolynomialBlock| {
                    let piece = block.to_bezier(&self.decimals.digits, &start);
                    start = block.end;
                    piece
                };
                let pieces: Vec<Bezier> = blocks.iter().take(asked.len()).map(piece).collect();
                (pieces, asked.len(), blocks.len() - asked.len().min(blocks.len()))
            }
            Written::Nurbs(nurbs) => (self.pieces(written)?, nurbs.points.len().saturating_sub(1), 0),
            Written::Lines(_) | Written::Arc(_) | Written::Through(..) => {
                return Err(self.differs("step-differs", "here a spline was asked".to_owned()));
            }
        };
        if pieces.len() != asked.len() {
            let message = format!("a spline of {} pieces was asked, not of {}", asked.len(), pieces.len());
            return Err(self.differs("pieces-differ", message));
        }
        let kinds = self.decimals.program.axes;
        if kinds.as_slice().iter().any(|(_, kind)| *kind != Kind::Linear) {
            let message = "splines that turn an axis cannot be compared yet".to_owned();
            return Err(self.differs("not-comparable", message));
        }
        let axes = kinds.count();
        let mut found = Found { path_blocks: blocks, ..Found::new() };
        for (asked, read) in asked.iter().zip(&pieces) {
            let mm = distance(asked, read, axes);
            found.deviation = found.deviation.max(Bound { mm, rad: 0.0 });
            found.cutting_length += length(asked, axes);
        }
        if rest == 0 {
            self.advance();
        } else {
            self.within += asked.len();
        }
        Ok(found)
    }
}

/// How far two pieces are from each other at the same parameter, mm, with some ulps for the proof's own rounding.
fn distance(asked: &Bezier, read: &Bezier, axes: usize) -> f64 {
    let size =
        |piece: &Bezier| piece.control_points().iter().flatten().fold(1.0f64, |size, x| size.max(x.abs()));
    let mm = if asked.is_polynomial() && read.is_polynomial() {
        let degree = asked.degree.max(read.degree);
        let (p, q) = (asked.raised_to(degree), read.raised_to(degree));
        let pairs = p.control_points().iter().zip(q.control_points());
        pairs
            .map(|(p, q)| (0..axes).map(|i| (p[i] - q[i]) * (p[i] - q[i])).sum::<f64>())
            .fold(0.0, f64::max)
            .sqrt()
    } else {
        let (d, e) = (asked.denominator(), read.denominator());
        let least = d.min() * e.min();
        let axis = |i: usize| {
            let (n, m) = (asked.numerator(i).times(&e), read.numerator(i).times(&d));
            n.combined(1.0, &m, -1.0).max_abs() / least
        };
        (0..axes).map(|i| axis(i) * axis(i)).sum::<f64>().sqrt()
    };
    mm + 256.0 * f64::EPSILON * size(asked).max(size(read))
}

/// The length of a path, mm, as that of sixteen chords a piece: a figure for the summary.
fn length(piece: &Bezier, axes: usize) -> f64 {
    let chord = |i: u32| {
        let (from, to) = (piece.eval(f64::from(i) / 16.0), piece.eval(f64::from(i + 1) / 16.0));
        (0..axes).map(|axis| (to[axis] - from[axis]) * (to[axis] - from[axis])).sum::<f64>().sqrt()
    };
    (0..16).map(chord).sum()
}
