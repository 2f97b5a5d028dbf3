//! Two paths of any length, followed piece by piece as they come, with the place of every bound.
//!
//! [`follow`](super::follow) bounds two paths as a whole. Here each part of the one that meets a part of the other has a bound of its
//! own, so that it can be said where they part; and only as many pieces are held as are looked at.
//!
//! Where they part, both are searched for the next joint that they share, followed by another one, or else for a joint of the
//! one on a piece of the other: there they go on together. The stretch before it is run along as a path of its own. Without
//! such a joint both go on as they would.

use super::along::{Stand, is_straight, together};
use super::{Bounds, ROUNDING, distance, foot, interval, tamed};
use crate::geom::bezier::Bezier;
use crate::units::{MAX_AXES, Position};
use std::collections::VecDeque;

/// How many pieces of each path are searched for a joint that both share.
const LOOK: usize = 256;

/// The same where a joint of the one is looked for inside the pieces of the other.
const NEAR: usize = 48;

/// How often such a joint is looked for in vain.
const SEARCHES: usize = 200;

/// A part of each path, and how far they are from each other.
#[derive(Clone, Copy, Debug)]
pub struct Meeting {
    /// Which piece of each it belongs to.
    pub at: [usize; 2],
    /// From where to where of its piece each part goes.
    pub part: [[f64; 2]; 2],
    /// How long the longer of them is, mm.
    pub length: f64,
    /// An upper bound on the distance, mm.
    pub distance: f64,
    /// An upper bound on the difference in each coordinate.
    pub axes: Position,
    /// An upper bound on the angle between the directions of the tool, radians.
    pub turn: f64,
    /// Whether both are the same, number by number: all bounds are zero then.
    pub alike: bool,
}

/// How both are compared.
#[derive(Clone, Copy, Debug)]
pub struct Rule {
    /// They have parted beyond this distance, mm.
    pub tolerance: f64,
    /// The first component of the tool's direction, and how many mm one of length 1 counts.
    pub direction: Option<(usize, f64)>,
    /// They have parted beyond this angle between directions, radians.
    pub turn: f64,
}

/// A path and the pieces that were looked at.
struct Ahead<I> {
    rest: std::iter::Enumerate<I>,
    held: Held,
    stand: Option<Stand>,
    /// Where it ends, and which piece that was, once nothing is left.
    last: (usize, Position),
}

impl<I: Iterator<Item = Bezier>> Ahead<I> {
    fn new(pieces: I) -> Ahead<I> {
        Ahead { rest: pieces.enumerate(), held: VecDeque::new(), stand: None, last: (0, [0.0; MAX_AXES]) }
    }

    /// Holds at least `count` pieces, where there are as many.
    fn hold(&mut self, count: usize) {
        while self.held.len() < count {
            let Some((at, piece)) = self.rest.next() else { return };
            let tame = tamed(std::slice::from_ref(&piece));
            let count = tame.len() as f64;
            for (k, part) in tame.iter().enumerate() {
                // Parts of a wild piece are halves of halves; where each of them begins is of no account.
                let of = [k as f64 / count, (k + 1) as f64 / count];
                self.held.push_back((at, *part, of));
            }
        }
    }

    /// Cuts a piece that is held in two.
    fn cut(&mut self, index: usize, t: f64) {
        let Some((at, piece, [from, to])) = self.held.get(index).copied() else { return };
        let stands = if index == 0 { self.stand.as_ref().map_or(0.0, |stand| stand.t) } else { 0.0 };
        let middle = from + t * (to - from);
        let first = piece.segment(0.0, t);
        self.held[index] = (at, first, [from, middle]);
        self.held.insert(index + 1, (at, piece.segment(t, 1.0), [middle, to]));
        if index == 0 && self.stand.is_some() {
            let mut stand = Stand::new(&first);
            stand.t = (stands / t).min(1.0);
            self.stand = Some(stand);
        }
    }

    /// Stands on the next piece.
    fn ready(&mut self) {
        self.hold(1);
        if self.stand.is_none() {
            self.stand = self.held.front().map(|(_, piece, _)| Stand::new(piece));
        }
    }

    /// Which piece it stands on, or stood on last.
    fn at(&self) -> usize {
        self.held.front().map_or(self.last.0, |(at, ..)| *at)
    }

    /// From where to where of the whole piece a part goes.
    fn share(&self, from: f64, to: f64) -> [f64; 2] {
        let [a, b] = self.held.front().map_or([1.0, 1.0], |(.., of)| *of);
        [a + from * (b - a), a + to * (b - a)]
    }

    /// Goes on to `t` of the piece; at 1 the next begins.
    fn go(&mut self, t: f64) {
        if t < 1.0 {
            if let Some(stand) = &mut self.stand {
                stand.t = t;
            }
            return;
        }
        self.stand = None;
        if let Some((at, piece, _)) = self.held.pop_front() {
            self.last = (at, piece.end());
        }
    }
}

/// Pairs of numbers below `count`, those of the smallest sum first, and of these the most alike.
fn pairs(count: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..2 * count).flat_map(|sum| {
        let half = sum / 2;
        (0..=half).flat_map(move |k| {
            let (less, more) = (half - k, sum - half + k);
            std::iter::once((less, more)).chain((less != more).then_some((more, less)))
        })
    })
}

/// Where inside piece `b` of the one path piece `a` of the other ends, where its next joint stands on that piece or one of
/// those behind it too.
/// `run` is how far its first piece has been run: no path goes back.
fn meets(p: &Held, a: usize, (c, run): (&Held, f64), b: usize, rule: &Rule) -> Option<f64> {
    let tolerance = rule.tolerance;
    let on = |q: &Position, piece: &Bezier, low: f64| {
        // Most pieces are far away, which their control points show.
        let points = piece.control_points();
        let far = (0..q.len()).any(|i| {
            points.iter().all(|p| p[i] + tolerance < q[i]) || points.iter().all(|p| q[i] < p[i] - tolerance)
        });
        if far {
            return None;
        }
        let u = foot(piece, q, low.max(0.5), low, 1.0);
        (distance(&piece.eval(u), q) <= tolerance).then_some(u)
    };
    let ((_, own, _), (_, other, _)) = (p.get(a)?, c.get(b)?);
    let low = if b == 0 { run } else { 0.0 };
    let u = on(&own.end(), other, low).filter(|u| low < *u && *u < 1.0)?;
    let (_, next, _) = p.get(a + 1)?;
    let follows = on(&next.end(), other, u).is_some()
        || c.iter().skip(b + 1).take(BEHIND).any(|(_, piece, _)| on(&next.end(), piece, 0.0).is_some());
    follows.then_some(u)
}

/// Pieces that were looked at: which piece of the path each belongs to, and from where to where of it.
type Held = VecDeque<(usize, Bezier, [f64; 2])>;

/// How many pieces behind are looked at for the next joint.
const BEHIND: usize = 8;

/// The meetings of two paths, in order.
pub struct Stream<P, C> {
    p: Ahead<P>,
    c: Ahead<C>,
    rule: Rule,
    bounds: Bounds,
    /// How many pieces of each belong to a stretch that ends where both share a joint.
    stretch: Option<(usize, usize)>,
    searches: usize,
}

impl<P: Iterator<Item = Bezier>, C: Iterator<Item = Bezier>> Stream<P, C> {
    /// Follows both, in mm as they count.
    pub fn new(p: P, c: C, rule: Rule) -> Stream<P, C> {
        let mut bounds = Bounds::new(&[], &[], rule.direction, rule.tolerance);
        bounds.used = (0..MAX_AXES).collect();
        Stream { p: Ahead::new(p), c: Ahead::new(c), rule, bounds, stretch: None, searches: SEARCHES }
    }

    /// Bounds one part against the other.
    fn bound(&mut self, p: &Bezier, c: &Bezier) -> (f64, Position, f64) {
        let greatest = |piece: &Bezier| {
            piece.control_points().iter().flatten().fold(0.0, |most: f64, x| most.max(x.abs()))
        };
        let finite = |piece: &Bezier| {
            piece.weights[..=piece.degree].iter().all(|w| 0.0 < *w && w.is_finite())
                && piece.control_points().iter().flatten().all(|x| x.is_finite())
        };
        if !(finite(p) && finite(c)) {
            return (f64::INFINITY, [f64::INFINITY; MAX_AXES], f64::INFINITY);
        }
        let bounds = &mut self.bounds;
        bounds.noise = bounds.noise.max(ROUNDING * greatest(p).max(greatest(c)));
        if self.rule.direction.is_none() && is_straight(p) && is_straight(c) {
            // Both at equal shares of their parts: the distance is convex, and greatest at an end.
            let ends = [(p.start(), c.start()), (p.end(), c.end())];
            let most = ends.iter().map(|(p, c)| distance(p, c)).fold(0.0, f64::max);
            let axes = std::array::from_fn(|i| {
                ends.iter().map(|(p, c)| (p[i] - c[i]).abs()).fold(0.0, f64::max) + bounds.noise
            });
            return (most + bounds.noise, axes, 0.0);
        }
        (bounds.distance, bounds.axes, bounds.turned) = (0.0, [0.0; MAX_AXES], 0.0);
        // What was seen elsewhere says how close a look is worth while, up to the tolerance.
        bounds.seen = bounds.seen.min(self.rule.tolerance);
        bounds.seen_turned = bounds.seen_turned.min(self.rule.turn);
        bounds.left = 4096;
        interval(p, c, bounds);
        let opposite = std::f64::consts::FRAC_PI_2 <= bounds.seen_turned;
        let turn = if opposite { f64::INFINITY } else { bounds.turned };
        // How long a direction is means nothing: the tip alone has a distance.
        let tip = self.rule.direction.map_or(f64::INFINITY, |(first, _)| {
            bounds.axes[..first].iter().map(|x| x * x).sum::<f64>().sqrt()
        });
        (bounds.distance.min(tip), bounds.axes, turn)
    }

    fn meeting(&self, part: [[f64; 2]; 2], length: f64, found: (f64, Position, f64)) -> Meeting {
        let (distance, axes, turn) = found;
        Meeting { at: [self.p.at(), self.c.at()], part, length, distance, axes, turn, alike: false }
    }

    /// Whether both have parted.
    pub fn parted(&self, meeting: &Meeting) -> bool {
        !(meeting.distance <= self.rule.tolerance && meeting.turn <= self.rule.turn)
    }

    /// How many pieces of each there are up to the next place where both are together again.
    fn joint(&mut self) -> Option<(usize, usize)> {
        if self.searches == 0 {
            return None;
        }
        self.p.hold(LOOK + 1);
        self.c.hold(LOOK + 1);
        let (p, c) = (&self.p.held, &self.c.held);
        let run = |stand: &Option<Stand>| stand.as_ref().map_or(0.0, |stand| stand.t);
        let (run_p, run_c) = (run(&self.p.stand), run(&self.c.stand));
        let near = |a: usize, b: usize| match (p.get(a), c.get(b)) {
            (Some((_, p, _)), Some((_, c, _))) => distance(&p.end(), &c.end()) <= self.rule.tolerance,
            (None, None) => true,
            (Some(_), None) | (None, Some(_)) => false,
        };
        let shared =
            |(a, b): &(usize, usize)| *a < p.len() && *b < c.len() && near(*a, *b) && near(a + 1, b + 1);
        for (a, b) in pairs(NEAR) {
            if shared(&(a, b)) {
                return Some((a + 1, b + 1));
            }
            // A joint of the one inside a piece of the other, and the next one too, or inside one of the pieces behind it.
            if let Some(u) = meets(p, a, (c, run_c), b, &self.rule) {
                self.c.cut(b, u);
                return Some((a + 1, b + 1));
            }
            if let Some(t) = meets(c, b, (p, run_p), a, &self.rule) {
                self.p.cut(a, t);
                return Some((a + 1, b + 1));
            }
        }
        if let Some((a, b)) = pairs(LOOK).find(shared) {
            return Some((a + 1, b + 1));
        }
        self.searches -= 1;
        None
    }

    /// Goes on, both of them.
    fn go(&mut self, to_p: f64, to_c: f64) {
        self.p.go(to_p);
        self.c.go(to_c);
        self.done(usize::from(to_p == 1.0), usize::from(to_c == 1.0));
    }

    /// So many pieces of a stretch are done.
    fn done(&mut self, p: usize, c: usize) {
        let left = self.stretch.map(|(of_p, of_c)| (of_p.saturating_sub(p), of_c.saturating_sub(c)));
        self.stretch = left.filter(|left| *left != (0, 0));
    }

    /// One waits where it is for the other.
    fn wait(&mut self, p_waits: bool) -> Option<Meeting> {
        let (last_p, last_c) = (self.p.last.1, self.c.last.1);
        let waiting = |at: Position| Bezier::line(at, at);
        let (p, c) = match (&self.p.stand, &self.c.stand, p_waits) {
            (Some(own), _, false) => (own.part(1.0), waiting(last_c)),
            (_, Some(other), true) => (waiting(last_p), other.part(1.0)),
            (None, _, false) | (_, None, true) => return None,
        };
        let from = |stand: &Option<Stand>| stand.as_ref().map_or(1.0, |stand| stand.t);
        let part = if p_waits {
            [[1.0, 1.0], self.c.share(from(&self.c.stand), 1.0)]
        } else {
            [self.p.share(from(&self.p.stand), 1.0), [1.0, 1.0]]
        };
        let found = self.bound(&p, &c);
        let moves = if p_waits { &self.c.stand } else { &self.p.stand };
        let length = moves.as_ref().map_or(0.0, Stand::rest);
        let mut meeting = self.meeting(part, length, found);
        // Who waits stands at the end of the piece before.
        if p_waits {
            meeting.at[0] = self.p.last.0;
            self.c.go(1.0);
            self.done(0, 1);
        } else {
            meeting.at[1] = self.c.last.0;
            self.p.go(1.0);
            self.done(1, 0);
        }
        Some(meeting)
    }
}

impl<P: Iterator<Item = Bezier>, C: Iterator<Item = Bezier>> Iterator for Stream<P, C> {
    type Item = Meeting;

    fn next(&mut self) -> Option<Meeting> {
        self.p.ready();
        self.c.ready();
        // Inside a stretch each ends where the stretch does.
        let ended = self.stretch.map_or([false; 2], |(p, c)| [p == 0, c == 0]);
        let (own, other) = match (&self.p.stand, &self.c.stand) {
            (None, None) => return None,
            (Some(_), None) => return self.wait(false),
            (None, Some(_)) => return self.wait(true),
            (Some(_), Some(_)) if ended[0] => return self.wait(true),
            (Some(_), Some(_)) if ended[1] => return self.wait(false),
            (Some(own), Some(other)) => (own, other),
        };
        let whole = own.t == 0.0 && other.t == 0.0;
        if whole && own.piece == other.piece {
            let part = [self.p.share(0.0, 1.0), self.c.share(0.0, 1.0)];
            let meeting =
                Meeting { alike: true, ..self.meeting(part, own.rest(), (0.0, [0.0; MAX_AXES], 0.0)) };
            self.go(1.0, 1.0);
            return Some(meeting);
        }
        let (to_p, to_c) = together(own, other, self.rule.tolerance);
        let (p, c) = (own.part(to_p), other.part(to_c));
        let part = [self.p.share(own.t, to_p), self.c.share(other.t, to_c)];
        let run = |stand: &Stand, to: f64| stand.length(to) - stand.length(stand.t);
        let length = run(own, to_p).max(run(other, to_c));
        let found = self.bound(&p, &c);
        let meeting = self.meeting(part, length, found);
        if self.parted(&meeting)
            && self.stretch.is_none()
            && let Some(stretch) = self.joint()
        {
            // The same again, with both ends known.
            self.stretch = Some(stretch);
            return self.next();
        }
        self.go(to_p, to_c);
        Some(meeting)
    }
}
