//! Two paths at feed, each of any blocks, beside each other.
//!
//! Both are run along together ([`Stream`]), and every part of the one has a bound on its distance from the part of the other
//! that it meets. Where a bound is greater than the tolerance they part; the places behind one another where they do are told as
//! one.
//!
//! F is compared where the paths meet (`diff/pace.rs`), as a number, wherever both machines measure the path by the same length. Where one counts
//! degrees and the other does not, or a line has its own time, the time of the whole path is compared.

use super::pace::{Differs, Paces};
use super::side::{Part, Shape, Side};
use super::walk::{Farthest, Walk};
use crate::diagnostic::Diagnostic;
use crate::geom::bezier::Bezier;
use crate::geom::deviation::{Bound, Metric};
use crate::geom::direction;
use crate::geom::follow::{Meeting, Rule, Stream};
use crate::machine::{RotaryFeed, Turn};
use crate::pass::stretch::{counted_length, linear_length, rotary_length};
use crate::source::Span;
use crate::units::{DEGREES, Kind, MAX_AXES, Position};
use crate::verify::Status;

/// Two paths take the same time where their times differ by no more than this share.
const TIME: f64 = 1.0e-3;

/// A path, its parts as they count.
pub(super) struct Run<'s, 'a> {
    side: &'s Side<'a>,
    pub(super) parts: &'s [Part<'a>],
    /// The first piece of each part.
    first: Vec<usize>,
}

impl<'s, 'a> Run<'s, 'a> {
    fn new(side: &'s Side<'a>, parts: &'s [Part<'a>]) -> Run<'s, 'a> {
        let count = |sum: &mut usize, part: &Part<'_>| {
            let first = *sum;
            *sum += part.count();
            Some(first)
        };
        let first = parts.iter().scan(0, count).collect();
        Run { side, parts, first }
    }

    /// The number of the part that a piece belongs to.
    pub(super) fn part_of(&self, piece: usize) -> usize {
        // The first part begins at 0, so that there is one.
        self.first.partition_point(|first| *first <= piece).saturating_sub(1)
    }

    /// The first piece of a part.
    pub(super) fn first_of(&self, part: usize) -> usize {
        self.first[part]
    }

    /// The part that a piece belongs to, and which of its pieces it is.
    pub(super) fn find(&self, piece: usize) -> (&'s Part<'a>, usize) {
        let at = self.part_of(piece);
        (&self.parts[at], piece - self.first[at])
    }

    fn place(&self, piece: usize) -> Span {
        let (part, piece) = self.find(piece);
        self.side.place(part, piece)
    }

    /// The pieces in mm as they count; directions start with length 1.
    fn pieces(&self, metric: &'s Metric) -> impl Iterator<Item = Bezier> + 's {
        let turning = self.side.axes.direction();
        self.parts.iter().flat_map(move |part| {
            let size = turning.map(|first| (first, direction::length(&part.ends()[0], first)));
            let straight = !matches!(part.shape, Shape::Pieces(..));
            part.pieces().map(move |mut piece| {
                match size {
                    Some((first, _)) if straight => {
                        piece.points[..2].iter_mut().for_each(|p| *p = direction::unit(p, first));
                    }
                    Some((first, size)) => piece
                        .points
                        .iter_mut()
                        .for_each(|p| p[first..first + 3].iter_mut().for_each(|x| *x /= size)),
                    None => {}
                }
                metric.scaled(&piece)
            })
        })
    }

    /// The greatest distance of its control points from zero, mm.
    fn reach(&self) -> f64 {
        let size = |p: &Position| p.iter().map(|x| x * x).sum::<f64>().sqrt();
        let of = |piece: Bezier| piece.control_points().iter().map(size).fold(0.0, f64::max);
        self.parts.iter().flat_map(|part| part.pieces().map(of)).fold(0.0, f64::max)
    }

    /// Whether it turns a rotary axis.
    fn turns(&self) -> bool {
        let axes = self.side.axes;
        let rotary: Vec<usize> = (0..axes.count()).filter(|i| axes.kind(*i) == Kind::Rotary).collect();
        let turns = |piece: Bezier| {
            let points = piece.control_points();
            rotary.iter().any(|i| points.iter().any(|p| p[*i] != points[0][*i]))
        };
        !rotary.is_empty() && self.parts.iter().any(|part| part.pieces().any(turns))
    }

    fn is_timed(&self) -> bool {
        self.parts.iter().any(|part| part.rate(0).is_some())
    }

    /// How long it takes, minutes; none where it has no F.
    fn minutes(&self, radius: f64) -> Option<f64> {
        let mut sum = 0.0;
        for part in self.parts {
            for (i, piece) in part.pieces().enumerate() {
                sum += match part.rate(i) {
                    Some(rate) => 1.0 / rate,
                    None => self.counted(&piece, radius) / part.feed?,
                };
            }
        }
        Some(sum)
    }

    /// The length of a piece as F counts it.
    fn counted(&self, piece: &Bezier, radius: f64) -> f64 {
        let axes = &self.side.axes;
        match self.side.machine.filter(|_| self.side.digits.is_some()) {
            Some(machine) => counted_length(piece, axes, machine, radius),
            None => match linear_length(piece, axes) {
                // Nothing but rotary axes moves: F is theirs.
                0.0 => rotary_length(piece, axes),
                linear => linear,
            },
        }
    }

    /// How F counts rotary axes; an input asks for a speed along the linear ones.
    fn measure(&self) -> RotaryFeed {
        match self.side.machine.filter(|_| self.side.digits.is_some()) {
            Some(machine) => machine.rotary_feed,
            None => RotaryFeed::Free,
        }
    }

    /// How far the tool's direction may be from that of a chord between two directions on a straight block, radians, and
    /// whether that is known by places only.
    fn between(&self, piece: usize) -> (f64, bool) {
        let Some(first) = self.side.axes.direction() else { return (0.0, false) };
        let (part, piece) = self.find(piece);
        let Some([from, to]) = part.chord(piece) else { return (0.0, false) };
        let theta = direction::between(&from, &to, first);
        let pace = direction::pace(theta).unwrap_or(f64::INFINITY);
        if self.side.machine.is_some_and(|machine| machine.orientation.turn == Turn::Tilt) {
            let of = |p: &[f64; MAX_AXES]| [p[first], p[first + 1], p[first + 2]];
            return (pace + direction::tilt_departure(&of(&from), &of(&to)), theta != 0.0);
        }
        (pace, false)
    }
}

/// Where two paths part: the first pieces, and the farthest.
struct Parting {
    first: [usize; 2],
    farthest: Farthest,
}

impl<'a> Walk<'_, 'a> {
    /// Compares two paths.
    pub(super) fn paths(&mut self, a: &[Part<'a>], b: &[Part<'a>]) {
        let (a, b) = (Run::new(self.a, a), Run::new(self.b, b));
        let axes = self.a.axes;
        let metric = self.metric.clone();
        let first = axes.direction();
        let rule = Rule {
            tolerance: self.tolerance,
            direction: first.map(|first| (first, metric.reach())),
            turn: if first.is_some() { self.turn } else { f64::INFINITY },
        };
        let timed = (a.measure() != b.measure() && (a.turns() || b.turns())) || a.is_timed() != b.is_timed();
        let mut farthest = Farthest::default();
        let mut parting: Option<Parting> = None;
        let mut paces = Paces::new([&a, &b], self.feed_digits(), self.tolerance);
        let same_turn = turn_of(self.a) == turn_of(self.b);
        let stream = Stream::new(a.pieces(&metric), b.pieces(&metric), rule);
        // Planes that differ a little move what is far from zero.
        let tilted = if self.tilt == 0.0 { 0.0 } else { self.tilt * a.reach().max(b.reach()) };
        for meeting in stream {
            let [i, j] = meeting.at;
            let mut bound = self.bound(&a, &b, &meeting, &metric, same_turn);
            bound.mm += tilted;
            if bound.mm <= self.tolerance && bound.rad <= rule.turn {
                if let Some(parting) = parting.take() {
                    self.part(&a, &b, &parting);
                }
                if !timed && let Some(differs) = paces.meet(&meeting) {
                    self.feeds(&a, &b, &differs);
                }
            } else {
                let known = parting.get_or_insert(Parting { first: [i, j], farthest: Farthest::default() });
                known.farthest.take(bound, [i, j]);
                paces.part();
            }
            farthest.take(bound, [i, j]);
        }
        self.found.take(&farthest, || [a.place(farthest.at[0]), b.place(farthest.at[1])]);
        if let Some(differs) = paces.end() {
            self.feeds(&a, &b, &differs);
        }
        if let Some(parting) = parting {
            self.part(&a, &b, &parting);
        }
        if timed || paces.uneven {
            self.times(&a, &b);
        }
        self.found.paths += 1;
        let length = |part: &Part<'_>| part.pieces().map(|piece| linear_length(&piece, &axes)).sum::<f64>();
        self.found.length += a.parts.iter().map(length).sum::<f64>();
    }

    /// How far two parts are from each other, with all that their pieces stand for.
    fn bound(&mut self, a: &Run, b: &Run, meeting: &Meeting, metric: &Metric, same_turn: bool) -> Bound {
        let [i, j] = meeting.at;
        let whole = meeting.part == [[0.0, 1.0]; 2];
        let straight = |run: &Run, piece: usize| !matches!(run.find(piece).0.shape, Shape::Pieces(..));
        let mut rad = meeting.turn;
        // Two controls that turn alike between two directions turn alike; which pieces stand for that is of no account.
        let alike = whole && same_turn && straight(a, i) == straight(b, j);
        if self.a.axes.direction().is_some() && !alike {
            for (run, piece) in [(a, i), (b, j)] {
                let (more, sampled) = run.between(piece);
                rad += more;
                if sampled {
                    self.found.status = self.found.status.max(Status::Sampled);
                }
            }
        }
        if meeting.alike {
            return Bound { mm: 0.0, rad };
        }
        let rotary = metric.rotary().iter().enumerate().filter(|(_, rotary)| **rotary);
        rad = rotary.fold(rad, |most, (axis, _)| most.max(meeting.axes[axis] / self.radius));
        Bound { mm: meeting.distance + a.find(i).0.slack + b.find(j).0.slack, rad }
    }

    /// Tells where F differs.
    fn feeds(&mut self, a: &Run, b: &Run, differs: &Differs) {
        let [i, j] = differs.at;
        self.feeds_differ(|| [a.place(i), b.place(j)], differs.feeds);
    }

    /// Tells where two paths part.
    fn part(&mut self, a: &Run, b: &Run, parting: &Parting) {
        let [i, j] = parting.first;
        let Bound { mm, rad } = parting.farthest.bound;
        let (tolerance, turn) = (self.tolerance, self.turn * DEGREES);
        let message = if tolerance < mm || self.a.axes.direction().is_none() {
            format!("the paths are up to {mm:.3e} mm apart, more than the tolerance of {tolerance} mm")
        } else {
            let angle = rad * DEGREES;
            format!("the tool's directions are up to {angle:.4} degrees apart, more than {turn}")
        };
        let [far_i, far_j] = parting.farthest.at;
        self.found.differs(|| {
            let (place_a, place_b) = (a.place(i), b.place(j));
            let (far_a, far_b) = (a.place(far_i), b.place(far_j));
            let here = if (far_a, far_b) == (place_a, place_b) { "" } else { "they part here" };
            let mut diagnostic =
                Diagnostic::refusal("path-differs", message).at(place_a, here).and_at(place_b, "");
            for (near, far) in [(place_a, far_a), (place_b, far_b)] {
                if near != far {
                    diagnostic = diagnostic.and_at(far, "farthest apart here");
                }
            }
            diagnostic
        });
    }

    pub(super) fn feeds_differ(&mut self, places: impl FnOnce() -> [Span; 2], feeds: [Option<f64>; 2]) {
        let spelled = |feed: Option<f64>| feed.map_or("no feed".to_owned(), |feed| format!("F {feed}"));
        self.found.differs(|| {
            let [own, other] = feeds.map(spelled);
            let message = format!("the feeds differ: {own} in the first program, {other} in the second");
            let [a, b] = places();
            Diagnostic::refusal("feed-differs", message).at(a, own).and_at(b, other)
        });
    }

    /// Compares how long two paths take.
    fn times(&mut self, a: &Run, b: &Run) {
        self.found.timed += 1;
        let (own, other) = (a.minutes(self.radius), b.minutes(self.radius));
        let spelled =
            |time: Option<f64>| time.map_or("an unknown time".to_owned(), |t| format!("{t:.4} min"));
        let same = match (own, other) {
            (Some(own), Some(other)) => (own - other).abs() <= TIME * own.max(other),
            (None, None) => true,
            (Some(_), None) | (None, Some(_)) => false,
        };
        if !same {
            let (own, other) = (spelled(own), spelled(other));
            self.found.differs(|| {
                let message = format!("the paths take {own} in the first program and {other} in the second");
                Diagnostic::refusal("time-differs", message).at(a.place(0), own).and_at(b.place(0), other)
            });
        }
    }
}

fn turn_of(side: &Side) -> Option<Turn> {
    side.machine.map(|machine| machine.orientation.turn)
}
