//! Two programs' steps, walked side by side.
//!
//! Where they differ, the next steps that both have are looked for, so that one step more in the one is told as that, and not as
//! all that follows.

use super::side::{Item, Part, Side};
use crate::decimal::power_of_ten;
use crate::diagnostic::Diagnostic;
use crate::geom::deviation::{Bound, Metric};
use crate::geom::rotation::Rotation;
use crate::ir::{Auxiliary, Step};
use crate::source::Span;
use crate::units::{DEGREES, Kind, MAX_AXES, Position};
use crate::verify::Status;

/// So many differences are told.
const MOST_TOLD: usize = 5;

/// How far a step that both have is looked for where they differ.
const LOOK: usize = 64;

/// How many steps behind such a one say whether both go on alike.
const CONFIRM: usize = 4;

/// What counts as the same.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    /// mm.
    pub(super) tolerance: f64,
    /// The greatest angle between directions of the tool, radians.
    pub(super) turn: f64,
    /// The radius at which rotary axes count, mm.
    pub(super) radius: f64,
}

/// What a walk found.
pub(super) struct Found {
    pub(super) told: Vec<Diagnostic>,
    pub(super) differences: usize,
    pub(super) deviation: Bound,
    /// Where that is, in both.
    pub(super) worst: Option<[Span; 2]>,
    pub(super) status: Status,
    pub(super) paths: usize,
    pub(super) rapids: usize,
    pub(super) switches: usize,
    /// Paths whose times were compared instead of F.
    pub(super) timed: usize,
    /// mm.
    pub(super) length: f64,
    /// The greatest angle between tilted planes, radians, where there are some.
    pub(super) planes: Option<f64>,
}

impl Found {
    pub(super) fn new() -> Found {
        Found {
            told: Vec::new(),
            differences: 0,
            deviation: Bound::ZERO,
            worst: None,
            status: Status::Proved,
            paths: 0,
            rapids: 0,
            switches: 0,
            timed: 0,
            length: 0.0,
            planes: None,
        }
    }

    pub(super) fn is_same(&self) -> bool {
        self.differences == 0
    }

    /// Notes a difference. Only the first are told: finding a line reads the text.
    pub(super) fn differs(&mut self, diagnostic: impl FnOnce() -> Diagnostic) {
        self.differences += 1;
        if self.told.len() < MOST_TOLD {
            self.told.push(diagnostic());
        }
    }

    /// Notes a difference that is told before all others.
    pub(super) fn differs_first(&mut self, diagnostic: Diagnostic) {
        self.differences += 1;
        self.told.insert(0, diagnostic);
        self.told.truncate(MOST_TOLD);
    }

    /// Takes what was found of one path.
    pub(super) fn take(&mut self, path: &Farthest, places: impl FnOnce() -> [Span; 2]) {
        if farther(self.deviation, path.bound) {
            self.worst = Some(places());
        }
        self.deviation = self.deviation.max(path.bound);
    }

    /// The same with the programs named the other way round.
    pub(super) fn swapped(mut self) -> Found {
        self.worst = self.worst.map(|[a, b]| [b, a]);
        self
    }
}

/// Whether the second bound is the greater one: in distance, and in angle where there is none.
fn farther(known: Bound, bound: Bound) -> bool {
    known.mm < bound.mm || (known.mm == 0.0 && known.rad < bound.rad)
}

/// The greatest bound of a path, and the pieces that it belongs to.
#[derive(Clone, Copy)]
pub(super) struct Farthest {
    pub(super) bound: Bound,
    pub(super) at: [usize; 2],
}

impl Default for Farthest {
    fn default() -> Farthest {
        Farthest { bound: Bound::ZERO, at: [0; 2] }
    }
}

impl Farthest {
    pub(super) fn take(&mut self, bound: Bound, at: [usize; 2]) {
        if farther(self.bound, bound) {
            self.at = at;
        }
        self.bound = self.bound.max(bound);
    }
}

/// Two programs, walked side by side.
pub(super) struct Walk<'s, 'a> {
    pub(super) a: &'s Side<'a>,
    pub(super) b: &'s Side<'a>,
    pub(super) tolerance: f64,
    pub(super) turn: f64,
    pub(super) radius: f64,
    pub(super) metric: Metric,
    /// The angle between the tilted planes in which both count here, radians: what it moves, as a share of a place's distance
    /// from zero, is no more.
    pub(super) tilt: f64,
    pub(super) found: Found,
}

impl<'s, 'a> Walk<'s, 'a> {
    pub(super) fn new(a: &'s Side<'a>, b: &'s Side<'a>, scale: Scale) -> Walk<'s, 'a> {
        let Scale { tolerance, turn, radius } = scale;
        let kinds: Vec<Kind> = a.axes.as_slice().iter().map(|(_, kind)| *kind).collect();
        let turn = if 0.0 < turn { turn } else { tolerance / DEGREES };
        let metric = Metric::with_direction(&kinds, radius, tolerance / turn);
        Walk { a, b, tolerance, turn, radius, metric, tilt: 0.0, found: Found::new() }
    }

    pub(super) fn run(mut self) -> Found {
        let (mut i, mut j) = (0, 0);
        loop {
            let (own, other) = (self.a.items.get(i), self.b.items.get(j));
            let (Some(own), Some(other)) = (own, other) else { break };
            let (skip_a, skip_b) = if self.alike(own, other) { (1, 1) } else { self.together(i, j) };
            if (skip_a, skip_b) == (1, 1) {
                self.pair(own, other);
            } else {
                self.apart(&self.a.items[i..i + skip_a], &self.b.items[j..j + skip_b], [i, j]);
            }
            (i, j) = (i + skip_a, j + skip_b);
        }
        if i < self.a.items.len() || j < self.b.items.len() {
            self.apart(&self.a.items[i..], &self.b.items[j..], [i, j]);
        }
        self.found
    }

    pub(super) fn feed_digits(&self) -> [Option<u8>; 2] {
        [self.a, self.b].map(|side| side.digits.map(|(feed, _)| feed))
    }

    fn axis_digits(&self, axis: usize) -> [Option<u8>; 2] {
        [self.a, self.b].map(|side| side.digits.map(|(_, axes)| axes[axis]))
    }

    /// Whether two steps are the same, or two paths begin or end alike.
    fn alike(&self, own: &Item, other: &Item) -> bool {
        match (own, other) {
            (Item::Switch(own, _), Item::Switch(other, _)) => self.same_switch(own, other),
            (Item::Rapid(own, _), Item::Rapid(other, _)) => {
                (0..MAX_AXES).all(|axis| match (own[axis], other[axis]) {
                    (Some(own_at), Some(other_at)) => {
                        same_number(own_at, other_at, self.axis_digits(axis))
                            || (self.tilt != 0.0 && self.same_tilted(own, axis, own_at - other_at))
                    }
                    (None, None) => true,
                    (Some(_), None) | (None, Some(_)) => false,
                })
            }
            (Item::Path(own), Item::Path(other)) => {
                let near = |p: Option<[Position; 2]>, q: Option<[Position; 2]>, end: usize| {
                    p.zip(q).is_some_and(|(p, q)| self.distance(&p[end], &q[end]) <= 4.0 * self.tolerance)
                };
                near(own.first().map(Part::ends), other.first().map(Part::ends), 0)
                    || near(own.last().map(Part::ends), other.last().map(Part::ends), 1)
            }
            (Item::Points(own, _), Item::Points(other, _)) => own == other,
            (Item::Switch(..) | Item::Rapid(..) | Item::Path(_) | Item::Points(..), _) => false,
        }
    }

    /// Whether a difference in an axis is what two planes that differ a little make of it.
    fn same_tilted(&self, place: &[Option<f64>; MAX_AXES], axis: usize, difference: f64) -> bool {
        let far = place.iter().flatten().map(|x| x * x).sum::<f64>().sqrt();
        let units = self.axis_digits(axis).into_iter().flatten();
        let rounding: f64 = units.map(|digits| 0.5 / power_of_ten(digits) as f64).sum();
        difference.abs() <= self.tilt * far + rounding
    }

    fn distance(&self, p: &Position, q: &Position) -> f64 {
        self.metric.distance(p, q).mm
    }

    /// The angle between two tilted planes, radians: by how much the one is turned from the other, about whatever axis. No
    /// place is moved by more than this times its distance from zero.
    fn between_planes(&self, own: [f64; 3], other: [f64; 3]) -> Option<f64> {
        let plane =
            |side: &Side<'a>, angles| Some(Rotation::of(side.machine?.orientation.plane_order, angles));
        Some(plane(self.a, own)?.angle_to(&plane(self.b, other)?))
    }

    fn same_switch(&self, own: &Step<f64, ()>, other: &Step<f64, ()>) -> bool {
        let digits = self.feed_digits();
        match (own, other) {
            (Step::Spindle(own), Step::Spindle(other))
            | (Step::Auxiliary(Auxiliary::Dwell(own)), Step::Auxiliary(Auxiliary::Dwell(other))) => {
                same_number(*own, *other, digits)
            }
            (Step::Auxiliary(Auxiliary::Plane(own)), Step::Auxiliary(Auxiliary::Plane(other))) => {
                self.between_planes(*own, *other).is_some_and(|angle| angle <= self.turn)
            }
            (own, other) => own == other,
        }
    }

    /// How many steps of each stand before both go on alike; one of each where they never do.
    fn together(&self, i: usize, j: usize) -> (usize, usize) {
        let score = |a: usize, b: usize| {
            let alike = |n: usize| match (self.a.items.get(i + a + n), self.b.items.get(j + b + n)) {
                (Some(own), Some(other)) => self.alike(own, other),
                (None, None) => true,
                (Some(_), None) | (None, Some(_)) => false,
            };
            (0..CONFIRM).filter(|n| alike(*n)).count()
        };
        let (left_a, left_b) = (self.a.items.len() - i, self.b.items.len() - j);
        let mut best = (score(1, 1), (1, 1));
        for sum in 1..=2 * LOOK {
            for a in sum.saturating_sub(LOOK)..=sum.min(LOOK) {
                let b = sum - a;
                if left_a < a || left_b < b || best.0 == CONFIRM {
                    continue;
                }
                let found = score(a, b);
                if best.0 < found {
                    best = (found, (a, b));
                }
            }
        }
        best.1
    }

    /// Compares two steps that belong together.
    fn pair(&mut self, own: &Item<'a>, other: &Item<'a>) {
        match (own, other) {
            (Item::Path(own), Item::Path(other)) => self.paths(own, other),
            (Item::Points(kind, own), Item::Points(other_kind, other)) if kind == other_kind => {
                self.points(own, other);
            }
            _ if self.alike(own, other) => match own {
                Item::Rapid(..) => self.found.rapids += 1,
                Item::Switch(step, _) => {
                    self.found.switches += 1;
                    self.tilted(step, other);
                }
                Item::Path(_) | Item::Points(..) => {}
            },
            _ => {
                let (a, b) = (self.a, self.b);
                self.found.differs(|| {
                    let (this, that) = (a.spelled(own), b.spelled(other));
                    let message = format!("the programs differ: {this} in the first, {that} in the second");
                    Diagnostic::refusal("step-differs", message)
                        .at(a.place_of(own), this)
                        .and_at(b.place_of(other), that)
                });
            }
        }
    }

    /// Notes how far the planes are from each other in which both count from here on.
    fn tilted(&mut self, own: &Step<f64, ()>, other: &Item<'a>) {
        match (own, other) {
            (
                Step::Auxiliary(Auxiliary::Plane(own)),
                Item::Switch(Step::Auxiliary(Auxiliary::Plane(other)), _),
            ) => {
                self.tilt = self.between_planes(*own, *other).unwrap_or(0.0);
                self.found.planes = Some(self.found.planes.map_or(self.tilt, |most| most.max(self.tilt)));
            }
            (Step::Auxiliary(Auxiliary::PlaneEnd), _) => self.tilt = 0.0,
            _ => {}
        }
    }

    /// Tells of steps that stand in one program only, or of others in their place.
    fn apart(&mut self, own: &[Item<'a>], other: &[Item<'a>], at: [usize; 2]) {
        let (a, b) = (self.a, self.b);
        let spelled = |side: &Side<'a>, items: &[Item<'a>]| match items {
            [] => "nothing".to_owned(),
            [one] => side.spelled(one),
            [first, rest @ ..] => format!("{} and {} more", side.spelled(first), counted(rest.len(), "step")),
        };
        let here = |side: &Side<'a>, items: &[Item<'a>], at: usize| match items.first().or(side.items.get(at))
        {
            Some(item) => side.place_of(item),
            None => side.end(),
        };
        self.found.differs(|| {
            let (this, that) = (spelled(a, own), spelled(b, other));
            let (place_a, place_b) = (here(a, own, at[0]), here(b, other, at[1]));
            match (own, other) {
                (_, []) => Diagnostic::refusal("step-missing", format!("the second program lacks {this}"))
                    .at(place_a, this)
                    .and_at(place_b, "it goes on here"),
                ([], _) => Diagnostic::refusal("step-missing", format!("the first program lacks {that}"))
                    .at(place_b, that)
                    .and_at(place_a, "it goes on here"),
                _ => {
                    let message = format!("the programs differ: {this} in the first, {that} in the second");
                    Diagnostic::refusal("step-differs", message).at(place_a, this).and_at(place_b, that)
                }
            }
        });
    }

    /// Compares the points of two splines that only their controls know.
    fn points(&mut self, own: &Part<'a>, other: &Part<'a>) {
        self.found.status = self.found.status.max(Status::PointsOnly);
        self.found.paths += 1;
        let (first, second) = (self.a, self.b);
        let places = |i: usize| [first.place(own, i), second.place(other, i)];
        let mut told = None;
        let mut worst = Vec::new();
        for (i, (p, q)) in own.pieces().zip(other.pieces()).enumerate() {
            let bound = self.metric.distance(&p.end(), &q.end());
            if told.is_none() && !(bound.mm <= self.tolerance) {
                told = Some((i, format!("this point of the spline is {:.3e} mm from the other's", bound.mm)));
            }
            worst.push(bound);
        }
        if own.count() != other.count() {
            let (a, b) = (counted(own.count(), "point"), counted(other.count(), "point"));
            told = Some((0, format!("the splines have {a} and {b}")));
        }
        if let Some((i, message)) = told {
            self.found.differs(|| {
                let [a, b] = places(i);
                Diagnostic::refusal("points-differ", message).at(a, "").and_at(b, "")
            });
        }
        let mut farthest = Farthest::default();
        worst.into_iter().enumerate().for_each(|(i, bound)| farthest.take(bound, [i, i]));
        self.found.take(&farthest, || places(farthest.at[0]));
        if own.feed.zip(other.feed).is_some_and(|(a, b)| !same_number(a, b, self.feed_digits())) {
            self.feeds_differ(|| places(0), [own.feed, other.feed]);
        }
    }
}

/// Whether two numbers are the same in the decimals of both; an input's are those of the other.
pub(super) fn same_number(a: f64, b: f64, digits: [Option<u8>; 2]) -> bool {
    if a == b {
        return true;
    }
    let coarser = match digits {
        [Some(own), Some(other)] if own == other => return false,
        [Some(own), Some(other)] => own.min(other),
        [Some(digits), None] | [None, Some(digits)] => digits,
        [None, None] => return false,
    };
    // Half a unit of the coarser, and what a float of these numbers is off.
    let half = 0.5 / power_of_ten(coarser) as f64;
    (a - b).abs() <= half + 4.0 * f64::EPSILON * a.abs().max(b.abs())
}

/// `1 step`, `2 steps`.
pub(super) fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}
