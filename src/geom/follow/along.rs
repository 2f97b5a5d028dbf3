//! Two paths, run along together: which part of the one belongs to which part of the other.

use super::{PLACES, distance, foot};
use crate::geom::bezier::Bezier;
use crate::units::Position;

/// So many times a stretch is halved.
const MAX_HALVES: usize = 24;

/// A piece, and how far it has been run.
#[derive(Clone, Debug)]
pub(super) struct Stand {
    pub(super) piece: Bezier,
    pub(super) t: f64,
    /// Lengths of the piece up to t = k/[`PLACES`].
    lengths: [f64; PLACES + 1],
}

/// Whether a piece is straight and run evenly.
pub(super) fn is_straight(piece: &Bezier) -> bool {
    piece.degree == 1 && piece.is_polynomial()
}

impl Stand {
    /// At the start of a piece.
    pub(super) fn new(piece: &Bezier) -> Stand {
        let mut lengths = [0.0; PLACES + 1];
        if is_straight(piece) {
            let whole = distance(&piece.start(), &piece.end());
            for (k, length) in lengths.iter_mut().enumerate() {
                *length = whole * k as f64 / PLACES as f64;
            }
        } else {
            let mut last = piece.start();
            for k in 1..=PLACES {
                let next = if k == PLACES { piece.end() } else { piece.eval(k as f64 / PLACES as f64) };
                lengths[k] = lengths[k - 1] + distance(&last, &next);
                last = next;
            }
        }
        Stand { piece: *piece, t: 0.0, lengths }
    }

    /// The length up to t.
    pub(super) fn length(&self, t: f64) -> f64 {
        let x = t * PLACES as f64;
        let k = (x as usize).min(PLACES - 1);
        self.lengths[k] + (x - k as f64) * (self.lengths[k + 1] - self.lengths[k])
    }

    /// What is left of the piece.
    pub(super) fn rest(&self) -> f64 {
        self.lengths[PLACES] - self.length(self.t)
    }

    /// Where the piece will be `more` farther on. Near a fold a piece hardly moves in most of a sixteenth, and its other leg is
    /// as near: where the way is shorter than the sixteenth it ends in, the next stretch is measured alone, halved until it is
    /// no longer than four such ways.
    fn ahead(&self, more: f64) -> f64 {
        let wanted = self.length(self.t) + more;
        let k = self.lengths[1..].partition_point(|s| *s < wanted);
        if k == PLACES || is_straight(&self.piece) || self.lengths[k + 1] - self.lengths[k] <= more {
            return self.at_length(wanted);
        }
        let mut to = (self.t + 2.0 / PLACES as f64).min(1.0);
        for _ in 0..MAX_HALVES {
            let stretch = Stand::new(&self.part(to));
            if stretch.rest() <= 4.0 * more {
                return self.t + (to - self.t) * stretch.at_length(more);
            }
            to = self.t.midpoint(to);
        }
        to
    }

    /// Where the piece has a length, by those of its sixteenths; its end where it is shorter.
    fn at_length(&self, wanted: f64) -> f64 {
        let k = self.lengths[1..].partition_point(|s| *s < wanted);
        if k == PLACES {
            return 1.0;
        }
        let step = self.lengths[k + 1] - self.lengths[k];
        let share = if 0.0 < step { (wanted - self.lengths[k]) / step } else { 0.0 };
        (k as f64 + share) / PLACES as f64
    }

    /// The place that is nearest to `q` where `more` farther on it is to be looked for; none at the end of the piece.
    fn nearest(&self, q: &Position, more: f64, close: f64) -> Option<f64> {
        let t = foot(&self.piece, q, self.ahead(more), self.t, 1.0);
        // Where a piece stands at its end Newton's method creeps towards it.
        if distance(q, &self.piece.end()) <= distance(q, &self.piece.eval(t)) {
            return None;
        }
        (close < self.length(1.0) - self.length(t)).then_some(t)
    }

    /// The part from here to `t`.
    pub(super) fn part(&self, t: f64) -> Bezier {
        self.piece.segment(self.t, t)
    }
}

/// How far both go next: up to the nearer joint of the two, and the place of the other that is nearest to it.
pub(super) fn together(own: &Stand, other: &Stand, tolerance: f64) -> (f64, f64) {
    let close = 1.0e-3 * tolerance;
    let (left_p, left_c) = (own.rest(), other.rest());
    let slack = 4.0 * tolerance;
    let mut to_p = 1.0;
    if left_c <= 1.5 * left_p + slack {
        to_p = own.nearest(&other.piece.end(), left_c, close).unwrap_or(1.0);
    }
    let mut to_c = 1.0;
    if left_p <= 1.5 * left_c + slack {
        to_c = other.nearest(&own.piece.end(), left_p, close).unwrap_or(1.0);
    }
    // Each joint before the other's: they belong together.
    if to_p < 1.0 && to_c < 1.0 { (1.0, 1.0) } else { (to_p, to_c) }
}
