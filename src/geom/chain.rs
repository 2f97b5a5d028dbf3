//! A curve of many pieces as one function of u: piece i on i ≤ u ≤ i + 1.

use super::bezier::Bezier;
use super::follow::{foot, tamed};
use crate::units::{MAX_AXES, Position};

/// Joints whose directions differ by less than this are smooth: sin of the angle, some 2e-5 degrees.
const SMOOTH: f64 = 4.0e-7;

/// Pieces that meet end to start.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    pieces: Vec<Bezier>,
}

fn unit(d: &Position) -> Option<Position> {
    let size = d.iter().map(|x| x * x).sum::<f64>().sqrt();
    (0.0 < size && size.is_finite()).then(|| d.map(|x| x / size))
}

fn minus(a: &Position, b: &Position) -> Position {
    std::array::from_fn(|i| a[i] - b[i])
}

/// The distance of two positions.
pub(super) fn distance(a: &Position, b: &Position) -> f64 {
    minus(a, b).iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// The direction in which a piece leaves its start: towards the first control point that is another place.
fn leaves(piece: &Bezier) -> Option<Position> {
    let points = piece.control_points();
    points[1..].iter().find_map(|point| unit(&minus(point, &points[0])))
}

impl Chain {
    /// The curve of these pieces, those without length left out; none where nothing is left.
    pub fn new(pieces: &[Bezier]) -> Option<Chain> {
        let mut pieces = tamed(pieces).into_owned();
        pieces.retain(|piece| leaves(piece).is_some());
        (!pieces.is_empty()).then_some(Chain { pieces })
    }

    /// The pieces.
    pub fn pieces(&self) -> &[Bezier] {
        &self.pieces
    }

    /// The greatest u.
    pub fn end(&self) -> f64 {
        self.pieces.len() as f64
    }

    /// The only piece between two joints, where there is one and it is straight.
    pub(super) fn line(&self, from: f64, to: f64) -> Option<Bezier> {
        let (i, _) = self.at(from);
        let piece = self.pieces[i];
        (to - from == 1.0 && piece.degree == 1).then(|| Bezier::line(piece.start(), piece.end()))
    }

    /// The piece at u and the parameter on it; at a joint the piece behind it.
    pub fn at(&self, u: f64) -> (usize, f64) {
        let i = (u.max(0.0) as usize).min(self.pieces.len() - 1);
        (i, (u - i as f64).clamp(0.0, 1.0))
    }

    /// c(u).
    pub fn eval(&self, u: f64) -> Position {
        let (i, t) = self.at(u);
        if t == 1.0 { self.pieces[i].end() } else { self.pieces[i].eval(t) }
    }

    /// The unit tangent behind u.
    pub fn tangent_behind(&self, u: f64) -> Position {
        let (i, t) = self.at(u);
        leaves(&self.pieces[i].segment(t.min(1.0 - 1.0e-9), 1.0)).unwrap_or([0.0; MAX_AXES])
    }

    /// The unit tangent before u.
    pub fn tangent_before(&self, u: f64) -> Position {
        let (mut i, mut t) = self.at(u);
        if t == 0.0 && 0 < i {
            (i, t) = (i - 1, 1.0);
        }
        let head = self.pieces[i].segment(0.0, t.max(1.0e-9)).reversed();
        leaves(&head).map_or([0.0; MAX_AXES], |d| d.map(|x| -x))
    }

    /// Where the curve turns a corner, and its end.
    pub fn corners(&self) -> Vec<f64> {
        let turns = |i: usize| {
            let before = self.tangent_before(i as f64);
            let after = leaves(&self.pieces[i]).unwrap_or([0.0; MAX_AXES]);
            SMOOTH < distance(&before, &after)
        };
        let inner = (1..self.pieces.len()).filter(|i| turns(*i)).map(|i| i as f64);
        inner.chain([self.end()]).collect()
    }
}

/// A part of a chain, with places along it to look for nearest ones.
pub(super) struct Window<'c> {
    chain: &'c Chain,
    u: Vec<f64>,
    places: Vec<Position>,
    lengths: Vec<f64>,
}

/// How many places a window has at least, and on each piece.
const PLACES: (usize, usize) = (24, 4);

impl<'c> Window<'c> {
    /// The part between two values of u.
    pub(super) fn new(chain: &'c Chain, from: f64, to: f64) -> Window<'c> {
        let pieces = (to.ceil() - from.floor()) as usize;
        let each = PLACES.1.max(PLACES.0.div_ceil(pieces));
        let mut u = vec![from];
        for i in from.floor() as usize..to.ceil() as usize {
            let (low, high) = (from.max(i as f64), to.min((i + 1) as f64));
            u.extend((1..=each).map(|k| low + (high - low) * k as f64 / each as f64));
        }
        let places: Vec<Position> = u.iter().map(|u| chain.eval(*u)).collect();
        let mut lengths = vec![0.0];
        for pair in places.windows(2) {
            lengths.push(lengths[lengths.len() - 1] + distance(&pair[0], &pair[1]));
        }
        Window { chain, u, places, lengths }
    }

    /// About its length.
    pub(super) fn length(&self) -> f64 {
        self.lengths[self.lengths.len() - 1]
    }

    /// How far its places are from a line, each from the nearest place of that.
    pub(super) fn off_line(&self, line: &Bezier) -> f64 {
        self.places.iter().fold(0.0, |most, place| {
            f64::max(most, distance(place, &line.eval(foot(line, place, 0.5, 0.0, 1.0))))
        })
    }

    /// The place nearest to `q` near the share `guess` of the length: where, the place and the derivative there.
    pub(super) fn nearest(&self, q: &Position, guess: f64) -> (Position, Position) {
        let wanted = guess * self.length();
        let last = self.u.len() - 1;
        let mut k = self.lengths.partition_point(|s| *s < wanted).min(last);
        let off = |k: usize| distance(&self.places[k], q);
        let mut best = off(k);
        loop {
            let better =
                [k.wrapping_sub(1), k + 1].into_iter().filter(|k| *k <= last).find(|k| off(*k) < best);
            match better {
                Some(next) => (k, best) = (next, off(next)),
                None => break,
            }
        }
        // The nearest place lies in one of the two intervals beside the nearest of those kept, each on one piece.
        let mut found: Option<(f64, Position, Position)> = None;
        for (low, high) in [(k.wrapping_sub(1), k), (k, k + 1)] {
            if last < low || last < high {
                continue;
            }
            let middle = 0.5 * (self.u[low] + self.u[high]);
            let (i, _) = self.chain.at(middle);
            let piece = &self.chain.pieces[i];
            let local = |u: f64| (u - i as f64).clamp(0.0, 1.0);
            let t = foot(piece, q, local(self.u[k]), local(self.u[low]), local(self.u[high]));
            let [p, p1, _] = piece.derivatives(t);
            let d = distance(&p, q);
            if found.is_none_or(|(known, ..)| d < known) {
                found = Some((d, p, p1));
            }
        }
        found.map_or((self.places[k], [0.0; MAX_AXES]), |(_, p, p1)| (p, p1))
    }
}
