//! Time partition: in every cycle the next point of a curve is the one whose chord from the current point is F·T.
//!
//! Source: *A real-time high-precision interpolation algorithm for general-typed parametric curves in CNC machine tools*
//! (2010). With p the current point and c(u) the curve, the target is the first root beyond u₀ of
//!
//! ```text
//! g(u) = ‖c(u) − p‖ − F·T
//! ```
//!
//! First a neighbourhood interval that holds it is found, then bisection or the secant method closes in until the relative
//! feed error |g|/(F·T) is as small as asked. The first-order Taylor step u₀ + F·T/‖c′(u₀)‖, which both replace, is here
//! for comparison.
//!
//! The chord is that of the axes that F counts, so a distance has a weight an axis ([`Weights`]).
//!
//! **Chord error**: the distance between a chord and the curve above it, measured at the middle of the parameter. Over a
//! cycle the curve is a parabola to third order, which is farthest from its chord there; where a cycle runs over a joint
//! of two pieces, the joint and the middle of each part are looked at.

use crate::units::{MAX_AXES, Position};

/// A curve c(u) with its first two derivatives.
pub trait Parametric {
    /// c(u).
    fn at(&self, u: f64) -> Position;

    /// c(u), c′(u), c″(u).
    fn jet(&self, u: f64) -> [Position; 3];
}

/// How much each axis counts in a distance: √Σ(wᵢ Δᵢ)².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights(pub [f64; MAX_AXES]);

impl Weights {
    /// √Σ(wᵢ vᵢ)².
    #[inline]
    pub fn norm(&self, v: &Position) -> f64 {
        self.dot(v, v).sqrt()
    }

    /// The distance of two positions.
    #[inline]
    pub fn distance(&self, a: &Position, b: &Position) -> f64 {
        self.norm(&difference(b, a))
    }

    /// Σ wᵢ² aᵢ bᵢ.
    #[inline]
    pub fn dot(&self, a: &Position, b: &Position) -> f64 {
        let mut sum = 0.0;
        for i in 0..MAX_AXES {
            sum += self.0[i] * a[i] * (self.0[i] * b[i]);
        }
        sum
    }

    /// The distance of a point from the straight line between two others.
    pub fn from_chord(&self, point: &Position, from: &Position, to: &Position) -> f64 {
        let (chord, own) = (difference(to, from), difference(point, from));
        let square = self.dot(&chord, &chord);
        if square == 0.0 {
            return self.norm(&own);
        }
        let share = (self.dot(&own, &chord) / square).clamp(0.0, 1.0);
        self.norm(&std::array::from_fn(|i| own[i] - share * chord[i]))
    }
}

/// a − b.
#[inline]
pub fn difference(a: &Position, b: &Position) -> Position {
    std::array::from_fn(|i| a[i] - b[i])
}

/// How the target of a cycle is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// The interval is halved.
    Bisection,
    /// The root of the straight line through the last two values; an interval that holds the root is kept.
    Secant,
    /// One first-order Taylor step, without correction.
    Taylor,
}

/// The law that every cycle follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Law {
    /// How the target is found.
    pub method: Method,
    /// T, s.
    pub cycle: f64,
    /// The relative feed error below which a target is taken.
    pub tolerance: f64,
}

/// More halvings than a float has bits are of no use.
const MOST_STEPS: u32 = 100;

/// The root of a function that grows from below zero at `low`, up to `end`; none where it stays below zero. `guess` is
/// where it is expected; the search for an interval goes on from there in steps that double.
///
/// `excess` gives the function's value; a value within ±`enough` is taken.
pub fn root(
    mut excess: impl FnMut(f64) -> f64,
    (start, value): (f64, f64),
    end: f64,
    guess: f64,
    enough: f64,
    method: Method,
) -> Option<f64> {
    let (mut low, mut below) = (start, value);
    let mut high = if start < guess && guess < end { guess } else { end };
    let mut above = excess(high);
    // The neighbourhood interval.
    while above < -enough {
        if end <= high {
            return None;
        }
        (low, below) = (high, above);
        high = (start + 2.0 * (high - start)).min(end);
        above = excess(high);
    }
    if above <= enough {
        return Some(high);
    }
    let (mut last, mut last_value) = (low, below);
    let (mut now, mut now_value) = (high, above);
    for _ in 0..MOST_STEPS {
        let middle = 0.5 * (low + high);
        let next = match method {
            Method::Bisection | Method::Taylor => middle,
            Method::Secant => {
                let next = now - now_value * (now - last) / (now_value - last_value);
                // Outside the interval, or where both values are one, the interval is halved.
                if low < next && next < high { next } else { middle }
            }
        };
        let value = excess(next);
        if value.abs() <= enough || next <= low || high <= next {
            return Some(next);
        }
        if value < 0.0 {
            low = next;
        } else {
            high = next;
        }
        (last, last_value) = (now, now_value);
        (now, now_value) = (next, value);
    }
    Some(now)
}

/// A curve run from one parameter to another at one feed.
#[derive(Clone, Debug)]
pub struct Piece<C> {
    /// The curve.
    pub curve: C,
    /// Its first parameter.
    pub from: f64,
    /// Its last parameter.
    pub to: f64,
    /// F, mm/s (degrees/s where no linear axis moves).
    pub feed: f64,
    /// What F counts.
    pub counts: Weights,
    /// What the chord error is measured in.
    pub surface: Weights,
}

/// One cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cycle {
    /// The piece that it ends on.
    pub piece: usize,
    /// The parameter there.
    pub u: f64,
    /// Its end.
    pub at: Position,
    /// How long it takes, s: T, or less for the last.
    pub time: f64,
    /// The chord that the feed asks for.
    pub asked: f64,
    /// The chord.
    pub chord: f64,
    /// (chord − asked)/asked.
    pub feed_error: f64,
    /// How far the curve is from the chord.
    pub chord_error: f64,
}

/// The cycles of pieces that join end to start.
#[derive(Clone, Debug)]
pub struct Cycles<'p, C> {
    pieces: &'p [Piece<C>],
    law: Law,
    piece: usize,
    u: f64,
    at: Position,
    /// The last three steps of u on this piece, the latest first, at no feed error; zero where there was none.
    steps: [f64; 3],
}

impl<'p, C: Parametric> Cycles<'p, C> {
    /// From the first point of the first piece to the last of the last.
    pub fn new(pieces: &'p [Piece<C>], law: Law) -> Cycles<'p, C> {
        let (u, at) =
            pieces.first().map_or((0.0, [0.0; MAX_AXES]), |first| (first.from, first.curve.at(first.from)));
        Cycles { pieces, law, piece: 0, u, at, steps: [0.0; 3] }
    }

    /// Where the next cycle starts.
    pub fn at(&self) -> &Position {
        &self.at
    }

    /// The target on piece `i` from parameter `u` and where it is, none where it lies beyond.
    fn target(&self, i: usize, u: f64, asked: f64) -> Option<(f64, Position)> {
        let piece = &self.pieces[i];
        let chord = |at: &Position| piece.counts.distance(&self.at, at);
        let begun = if i == self.piece { 0.0 } else { chord(&piece.curve.at(u)) };
        let taylor = || u + (asked - begun) / piece.counts.norm(&piece.curve.jet(u)[1]);
        if asked <= begun {
            // The joint itself is as far as asked, or farther by what rounding makes.
            return Some((u, piece.curve.at(u)));
        }
        if self.law.method == Method::Taylor {
            return Some(taylor()).filter(|next| *next < piece.to).map(|next| (next, piece.curve.at(next)));
        }
        let guess = if i == self.piece { self.expected().map(|step| u + step) } else { None };
        // Where the curve was looked at last; that is the target when one is found.
        let mut seen = (u, self.at);
        let excess = |u: f64| {
            seen = (u, piece.curve.at(u));
            chord(&seen.1) - asked
        };
        let enough = self.law.tolerance * asked;
        let guess = guess.unwrap_or_else(taylor);
        let next = root(excess, (u, begun - asked), piece.to, guess, enough, self.law.method)?;
        // Where the end is the target as well, nothing is left behind it.
        if next < piece.to && piece.to - next <= 2.0 * self.law.tolerance * (next - u) {
            let end = piece.curve.at(piece.to);
            if (chord(&end) - asked).abs() <= enough {
                return Some((piece.to, end));
            }
        }
        Some(if seen.0 == next { seen } else { (next, piece.curve.at(next)) })
    }

    /// The next step of u: the steps before, continued by a parabola, or by what there is of them; none on the first cycle.
    fn expected(&self) -> Option<f64> {
        let [one, two, three] = self.steps;
        let step = match self.steps {
            [0.0, ..] => return None,
            [_, 0.0, _] => one,
            [_, _, 0.0] => 2.0 * one - two,
            _ => 3.0 * (one - two) + three,
        };
        (0.0 < one).then_some(step.max(0.5 * one))
    }
}

/// The greatest distance of the curve between two places, each a piece and its parameter, from the chord between them.
pub fn chord_error<C: Parametric>(
    pieces: &[Piece<C>],
    first: (usize, f64, &Position),
    last: (usize, f64, &Position),
) -> f64 {
    let mut worst = 0.0f64;
    for i in first.0..=last.0 {
        let piece = &pieces[i];
        let from = if i == first.0 { first.1 } else { piece.from };
        let to = if i == last.0 { last.1 } else { piece.to };
        let middle = piece.curve.at(0.5 * (from + to));
        worst = worst.max(piece.surface.from_chord(&middle, first.2, last.2));
        if i != last.0 {
            worst = worst.max(piece.surface.from_chord(&piece.curve.at(to), first.2, last.2));
        }
    }
    worst
}

impl<C: Parametric> Iterator for Cycles<'_, C> {
    type Item = Cycle;

    #[inline]
    fn next(&mut self) -> Option<Cycle> {
        let current = self.pieces.get(self.piece)?;
        let asked = current.feed * self.law.cycle;
        let mut i = self.piece;
        let mut u = self.u;
        let (i, next) = loop {
            if let Some(next) = self.target(i, u, asked) {
                break (i, Some(next));
            }
            match self.pieces.get(i + 1) {
                Some(piece) => {
                    i += 1;
                    u = piece.from;
                }
                None => break (i, None),
            }
        };
        let piece = &self.pieces[i];
        let (u, at) = next.unwrap_or_else(|| (piece.to, piece.curve.at(piece.to)));
        let chord = piece.counts.distance(&self.at, &at);
        let chord_error = chord_error(self.pieces, (self.piece, self.u, &self.at), (i, u, &at));
        // The last cycle is as short as what is left.
        let (time, wanted) = match next {
            Some(_) => (self.law.cycle, asked),
            None => (chord / current.feed, chord),
        };
        let feed_error = if wanted == 0.0 { 0.0 } else { (chord - wanted) / wanted };
        if i == self.piece && 0.0 < chord {
            // As long as they would be at no feed error, so that errors of one cycle do not grow from guess to guess.
            self.steps = [(u - self.u) * (wanted / chord), self.steps[0], self.steps[1]];
        } else {
            self.steps = [0.0; 3];
        }
        (self.piece, self.u, self.at) = (i, u, at);
        if next.is_none() || (i + 1 == self.pieces.len() && piece.to <= u) {
            self.piece = self.pieces.len();
        }
        if next.is_none() && chord == 0.0 {
            return None;
        }
        Some(Cycle { piece: i, u, at, time, asked: wanted, chord, feed_error, chord_error })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::elementary::{cos, sin};
    use approx::assert_relative_eq;

    /// A circle of radius `.0` about the origin, by its angle.
    struct Circle(f64);

    impl Parametric for Circle {
        fn at(&self, u: f64) -> Position {
            [self.0 * cos(u), self.0 * sin(u), 0.0, 0.0, 0.0, 0.0]
        }

        fn jet(&self, u: f64) -> [Position; 3] {
            let [x, y, ..] = self.at(u);
            let flat = |x, y| [x, y, 0.0, 0.0, 0.0, 0.0];
            [flat(x, y), flat(-y, x), flat(-x, -y)]
        }
    }

    const XYZ: Weights = Weights([1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);

    fn piece<C>(curve: C, to: f64) -> Piece<C> {
        Piece { curve, from: 0.0, to, feed: 100.0, counts: XYZ, surface: XYZ }
    }

    fn law(method: Method) -> Law {
        Law { method, cycle: 1e-3, tolerance: 1e-12 }
    }

    #[test]
    fn chords_of_a_circle_have_their_closed_form() {
        // A chord of 0.1 on a circle of radius R spans 2 asin(0.05/R); its sagitta is R − √(R² − 0.05²).
        let r = 5.0f64;
        let pieces = [piece(Circle(r), 3.0)];
        let angle = 2.0 * crate::geom::elementary::atan(0.05 / (r * r - 0.0025).sqrt());
        let sagitta = r - (r * r - 0.0025).sqrt();
        for method in [Method::Bisection, Method::Secant] {
            let cycles: Vec<Cycle> = Cycles::new(&pieces, law(method)).collect();
            assert_eq!(cycles.len(), (3.0 / angle) as usize + 1);
            let (last, full) = cycles.split_last().unwrap();
            for (i, cycle) in full.iter().enumerate() {
                // Each target is right to 1e-12 of a step, and the errors add up.
                assert_relative_eq!(cycle.u, angle * (i + 1) as f64, epsilon = 1e-11);
                assert!(cycle.feed_error.abs() <= 1e-12, "{cycle:?}");
                // The difference of two numbers near 5.
                assert_relative_eq!(cycle.chord_error, sagitta, epsilon = 1e-14);
            }
            assert_eq!((last.u, last.feed_error), (3.0, 0.0));
            assert_relative_eq!(last.time, last.chord / 100.0);
        }
    }

    #[test]
    fn a_taylor_step_on_a_circle_misses_by_its_arc() {
        // It goes an arc of F·T instead of a chord: the chord is 2R sin(F·T/2R), (F·T)²/(24R²) too short.
        let pieces = [piece(Circle(5.0), 3.0)];
        let first = Cycles::new(&pieces, law(Method::Taylor)).next().unwrap();
        assert_relative_eq!(first.feed_error, -0.01 / (24.0 * 25.0), max_relative = 1e-4);
    }

    #[test]
    fn a_corner_is_run_over_by_one_chord() {
        let line = |from: [f64; 2], to: [f64; 2]| {
            let at = |p: [f64; 2]| [p[0], p[1], 0.0, 0.0, 0.0, 0.0];
            super::super::shape::Shape::line(at(from), at(to))
        };
        let pieces = [
            Piece { to: 1.0, ..piece(line([0.0, 0.0], [0.25, 0.0]), 1.0) },
            Piece { to: 1.0, ..piece(line([0.25, 0.0], [0.25, 1.0]), 1.0) },
        ];
        let cycles: Vec<Cycle> = Cycles::new(&pieces, law(Method::Secant)).collect();
        // From (0.2, 0) to (0.25, y) with 0.05² + y² = 0.1².
        let over = cycles[2];
        assert_relative_eq!(over.at[1], 0.0075f64.sqrt(), epsilon = 1e-12);
        // The corner is 0.05·y/0.1 away from the chord.
        assert_relative_eq!(over.chord_error, 0.5 * 0.0075f64.sqrt(), epsilon = 1e-12);
        assert!(cycles.iter().all(|c| c.feed_error.abs() <= 1e-12));
    }

    #[test]
    fn a_curve_that_ends_on_a_cycle_has_no_rest() {
        let line = super::super::shape::Shape::line([0.0; 6], [1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let pieces = [piece(line, 1.0)];
        let cycles: Vec<Cycle> = Cycles::new(&pieces, law(Method::Secant)).collect();
        assert_eq!(cycles.len(), 10);
        assert_relative_eq!(cycles.iter().map(|c| c.time).sum::<f64>(), 0.01, max_relative = 1e-12);
    }
}
