//! The direction of the tool along splines, and how splines meet.
//!
//! A second curve H(u) beside the tip P(u) states the direction D(u) = H(u) − P(u). LENGTH is how long D should be; it is
//! so along the curve, not at its control points.

use super::reader::Reader;
use crate::diagnostic::Diagnostic;
use crate::geom::direction;
use crate::geom::nurbs::Nurbs;
use crate::source::Span;
use crate::units::{DEGREES, Position};

/// A second curve: its distance from the first one at each control point.
pub(super) struct Second {
    pub(super) directions: Vec<[f64; 3]>,
    /// mm.
    pub(super) length: f64,
}

/// How far LENGTH may be from the distance of the two curves, mm: files with five decimals miss it by some 0.002.
const LENGTH_SLACK: f64 = 0.01;

/// The greatest angle at which a control neither stops nor slows down, degrees (Heidenhain's figure).
const SMOOTH: f64 = 0.1;

/// How far the tool may be turned at the start of a spline, degrees: what five decimals at 50 mm leave open is 1e-5.
const TURNED: f64 = 0.01;

/// At how many places of each piece a distance is looked at.
const PLACES: u32 = 8;

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// The angle between two vectors, degrees.
fn angle(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    direction::angle(a, b) * DEGREES
}

fn tip(p: &Position) -> [f64; 3] {
    [p[0], p[1], p[2]]
}

fn along(p: &Position) -> [f64; 3] {
    [p[3], p[4], p[5]]
}

impl Reader<'_> {
    /// Whether a spline of one direction keeps that of the tool. Where nothing moved yet, it is the tool's.
    pub(super) fn keeps_axis(&mut self, axis: [f64; 3], span: Span) -> bool {
        if dot(&axis, &axis) == 0.0 {
            self.error("tool-axis", "the tool axis is no direction", span);
            return false;
        }
        let turned = angle(&axis, &self.program.stood());
        if TURNED < turned && self.program.has_moved() {
            let message = format!("the tool is turned by {turned:.3} degrees where this spline starts");
            self.push(
                Diagnostic::error("spline-axis", message)
                    .at(span, "")
                    .hint("a move before it turns the tool, a GOTO with six numbers"),
            );
            return false;
        }
        // As near as that the direction stays the one that was stated.
        angle(&axis, &self.program.axis()) <= TURNED || self.set_axis(axis, span)
    }

    /// Checks a second curve: where it starts, and how far it is from the tip.
    pub(super) fn second_curve(&mut self, nurbs: &Nurbs, length: f64, span: Span) {
        self.program.tilt();
        let turned = angle(&along(&nurbs.points()[0]), &self.program.stood());
        if TURNED < turned {
            let message = format!("the tool is turned by {turned:.3} degrees where this spline starts");
            self.push(
                Diagnostic::error("spline-axis", message)
                    .at(span, "")
                    .hint("a move before it turns the tool, a GOTO with six numbers"),
            );
        }
        let mut worst = (0.0f64, length);
        for (piece, _) in nurbs.beziers() {
            for i in 0..=PLACES {
                let d = along(&piece.eval(f64::from(i) / f64::from(PLACES)));
                let size = dot(&d, &d).sqrt();
                if worst.0 < (size - length).abs() {
                    worst = ((size - length).abs(), size);
                }
            }
        }
        if 0.5 * length < worst.0 {
            let message = format!("the second curve is {:.4} mm from the tip, not {length}", worst.1);
            self.push(Diagnostic::error("spline-length", message).at(span, ""));
        } else if LENGTH_SLACK < worst.0 {
            let message =
                format!("the second curve is {:.4} mm from the tip somewhere, not {length}", worst.1);
            self.push(Diagnostic::warning("spline-length", message).at(span, ""));
        }
    }

    /// Meets the start of a spline: the angle to the one before, where that ended there.
    pub(super) fn meets(&mut self, nurbs: &Nurbs, span: Span) {
        let ends = |piece: &crate::geom::bezier::Bezier| {
            let [_, rate, _] = piece.derivatives(1.0);
            (tip(&piece.end()), tip(&rate))
        };
        let first = nurbs.beziers().next();
        if let (Some((at, before)), Some((piece, _))) = (self.spline_end, first) {
            let [start, after, _] = piece.derivatives(0.0);
            let turn = angle(&before, &tip(&after));
            if tip(&start) == at && self.joint.is_none_or(|(known, _)| known < turn) {
                self.joint = Some((turn, span));
            }
        }
        self.spline_end = nurbs.beziers().last().map(|(piece, _)| ends(&piece));
    }

    /// Warns where splines meet at an angle.
    pub(super) fn joints(&mut self) {
        if let Some((turn, span)) = self.joint.filter(|(turn, _)| SMOOTH < *turn) {
            let message = format!("splines of this file meet at up to {turn:.2} degrees");
            self.push(
                Diagnostic::warning("spline-corner", message)
                    .at(span, "the greatest angle is where this one starts")
                    .hint("above 0.1 degrees a control stops or slows down between blocks"),
            );
        }
    }
}
