//! Two programs beside each other: do they make the same motion?
//!
//! Each is read by its own machine's reader, or by its language where it is an input, and becomes a list of switches, rapids and paths
//! (`diff/side.rs`). The lists are walked side by side:
//!
//! | | compared |
//! |---|---|
//! | tools, spindle, coolant, stops, dwells, homes, an operator's parameters, their order | exactly |
//! | rapids | where each leads to, exactly; one that moves nothing is none |
//! | paths at feed, of any blocks: lines, arcs, polynomials, B-splines | by a bound on their distance, both run in order |
//! | F | exactly where the paths meet; by the time of the path where the machines measure it differently |
//! | the control's own splines | their points, and that both are of one kind |
//! | remarks, block numbers, names, work offsets, subprograms, the lines round a program | not: they are no motion |
//!
//! Numbers of machines with different decimals are the same where the coarser one would have rounded to it.
//!
//! The bound is that of [`geom::follow`](crate::geom::follow), the one that verification uses; what differs is that no intent says
//! which block belongs to which, so that both are run along together. Where a bound is greater than the tolerance the
//! paths part; that a better map of the one to the other would hold it is possible where a path runs along itself within some
//! tolerances, and is not looked for. The answer does not depend on which program is named first: two programs are the same when either
//! order shows it.

mod path;
mod report;
mod side;

pub use report::{Figures, Place};

use crate::diagnostic::{Diagnostic, Diagnostics, Warned};
use crate::dialect::{DIALECTS, Reading};
use crate::front::Language;
use crate::geom::deviation::{Bound, Metric};
use crate::ir::{Auxiliary, Intent, Step};
use crate::machine::Machine;
use crate::pass;
use crate::source::{SourceId, Sources, Span};
use crate::translate;
use crate::units::{DEGREES, Kind, MAX_AXES, Position};
use crate::verify::Status;
use side::{Item, Part, Side};

/// How a text is read.
#[derive(Clone, Debug)]
pub enum Origin {
    /// As an NC program for a machine.
    Program(Box<Machine>),
    /// As an input in a language.
    Input(&'static Language),
}

/// What the command line may say beside both programs.
#[derive(Clone, Copy, Debug, Default)]
pub struct Options {
    /// mm; none: what both say together, since each may be so far from what was asked.
    pub tolerance: Option<f64>,
    /// The radius at which rotary axes count, mm; none: a degree counts as a millimetre.
    pub radius: Option<f64>,
}

/// What was found.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// The figures.
    pub figures: Figures,
    /// The first places where the programs differ.
    pub differences: Diagnostics,
    /// What to know.
    pub warnings: Diagnostics,
}

/// So many differences are told.
const MOST_TOLD: usize = 5;

/// How far a step that both have is looked for where they differ.
const LOOK: usize = 64;

/// How many steps behind such a one say whether both go on alike.
const CONFIRM: usize = 4;

/// The built-in machine whose program a text is: the only one whose header, words and end it has.
///
/// # Errors
/// It is no program of a built-in machine, or of several.
pub fn detect(sources: &Sources) -> Result<Machine, Diagnostics> {
    let text = sources.get(SourceId::INPUT).map_or("", |source| source.text.as_str());
    let fits = |machine: &Machine| {
        let machine = translate::machine_of(text, machine);
        (machine.dialect.read)(text, SourceId::INPUT, &machine)
            .is_ok_and(|reading| reading.value.header && reading.value.footer)
    };
    let mut fitting = DIALECTS.iter().filter_map(|dialect| Machine::built_in(dialect.name)).filter(fits);
    match (fitting.next(), fitting.next()) {
        (Some(machine), None) => Ok(machine),
        _ => {
            let first = text.find('\n').unwrap_or(text.len()).min(80);
            Err(Diagnostic::error("machine-missing", "no built-in machine alone writes such a program")
                .at(Span::new(SourceId::INPUT, 0..first), "")
                .hint("say with --from which machine it is for, or --from-a and --from-b where they differ; a language of inputs is as good")
                .into())
        }
    }
}

/// A text that was read.
enum Read {
    Program(Box<Machine>, Box<Reading>),
    Input(Box<Intent>),
}

fn read(sources: &Sources, origin: &Origin) -> Result<Warned<Read>, Diagnostics> {
    match origin {
        Origin::Program(machine) => {
            let text = sources.get(SourceId::INPUT).map_or("", |source| source.text.as_str());
            let machine = translate::machine_of(text, machine);
            let Warned { value, mut warnings } = (machine.dialect.read)(text, SourceId::INPUT, &machine)?;
            warnings.extend(translate::is_whole(&value, &machine)?);
            Ok(Warned { value: Read::Program(Box::new(machine), Box::new(value)), warnings })
        }
        Origin::Input(language) => {
            let mut intent = (language.parse)(sources)?;
            let warnings = std::mem::take(&mut intent.warnings);
            Ok(Warned { value: Read::Input(Box::new(intent)), warnings })
        }
    }
}

/// The same, behind `count` other texts.
fn behind(mut diagnostics: Diagnostics, count: usize) -> Diagnostics {
    let moved = |span: &mut Span| span.source = span.source.behind(count);
    for diagnostic in &mut diagnostics.0 {
        diagnostic.span.iter_mut().for_each(moved);
        diagnostic.others.iter_mut().for_each(|(span, _)| moved(span));
    }
    diagnostics
}

/// Compares two programs. Places in the second text count on behind those of the first: [`Sources::joined`].
///
/// # Errors
/// One of them cannot be read, or is no whole program.
pub fn compare(
    [a, b]: [&Sources; 2],
    [from_a, from_b]: [&Origin; 2],
    options: &Options,
) -> Result<Comparison, Diagnostics> {
    let count = a.count();
    // What is wrong with either is told.
    let (first, second) = match (read(a, from_a), read(b, from_b).map_err(|errors| behind(errors, count))) {
        (Ok(first), Ok(second)) => (first, second),
        (Err(mut errors), Err(more)) => {
            errors.extend(more);
            return Err(errors);
        }
        (Err(errors), Ok(_)) | (Ok(_), Err(errors)) => return Err(errors),
    };
    let mut warnings = first.warnings;
    warnings.extend(behind(second.warnings, count));
    let (mut first, mut second) = (first.value, second.value);
    second.shift(count);
    // An input goes where the other's machine does: to its homes, with its axes' names.
    place(&mut first, &second)?;
    place(&mut second, &first)?;
    let tolerance = options.tolerance.unwrap_or(first.tolerance() + second.tolerance());
    let radius = options.radius.or(first.radius()).or(second.radius()).unwrap_or(DEGREES);
    let turn = first.turn().max(second.turn());
    let rule = Scale { tolerance, turn, radius };
    let text = |sources: &Sources| sources.get(SourceId::INPUT).map_or(String::new(), |s| s.text.clone());
    let (text_a, text_b) = (text(a), text(b));
    let own = side(&first, &second, (&text_a, SourceId::INPUT), radius)?;
    let other = side(&second, &first, (&text_b, SourceId::INPUT.behind(count)), radius)?;
    let found = if let Some(diagnostic) = own.has_other_axes(&other).or(other.has_other_axes(&own)) {
        let mut found = Found::new();
        found.differs(diagnostic);
        found
    } else {
        let other = other.ordered(&own.axes);
        let found = Walk::new(&own, &other, rule).run();
        // A map that runs the other way may be better.
        let back = if found.is_same() { None } else { Some(Walk::new(&other, &own, rule).run()) };
        back.filter(Found::is_same).map_or(found, Found::swapped)
    };
    let names = [a, b].map(|sources| sources.get(SourceId::INPUT).map_or(String::new(), |s| s.name.clone()));
    let figures = Figures::new(&found, names, [from_a, from_b], tolerance, own.axes.direction().is_some());
    let mut differences = Diagnostics(found.told);
    if differences.0.len() < found.differences {
        let more = found.differences - differences.0.len();
        let message = format!("the programs differ in {more} more places");
        differences.push(Diagnostic::refusal("more-differences", message));
    }
    Ok(Comparison { figures, differences, warnings })
}

/// What counts as the same.
#[derive(Clone, Copy, Debug)]
struct Scale {
    /// mm.
    tolerance: f64,
    /// The greatest angle between directions of the tool, radians.
    turn: f64,
    /// The radius at which rotary axes count, mm.
    radius: f64,
}

impl Read {
    fn machine(&self) -> Option<&Machine> {
        match self {
            Read::Program(machine, _) => Some(machine),
            Read::Input(_) => None,
        }
    }

    fn tolerance(&self) -> f64 {
        match self {
            Read::Program(machine, _) => machine.tolerance,
            Read::Input(intent) => intent.tolerance.map_or(0.001, |(tolerance, _)| tolerance),
        }
    }

    fn radius(&self) -> Option<f64> {
        match self {
            Read::Program(..) => None,
            Read::Input(intent) => intent.radius,
        }
    }

    /// How far the tool's direction may be off, radians.
    fn turn(&self) -> f64 {
        self.machine().map_or(0.0, |machine| machine.orientation.tolerance / DEGREES)
    }

    /// Its steps stand in a text with so many before it.
    fn shift(&mut self, count: usize) {
        let moved = |span: &mut Span| span.source = span.source.behind(count);
        match self {
            Read::Program(_, reading) => {
                reading.decimals.program.steps.iter_mut().for_each(|located| moved(&mut located.span));
            }
            Read::Input(intent) => {
                intent.program.steps.iter_mut().for_each(|located| moved(&mut located.span));
            }
        }
    }
}

/// An input as the machine of the other program counts it.
fn place(read: &mut Read, other: &Read) -> Result<(), Diagnostics> {
    if let (Read::Input(intent), Some(machine)) = (read, other.machine()) {
        **intent = pass::place::place((**intent).clone(), machine)?;
    }
    Ok(())
}

fn side<'a>(
    read: &'a Read,
    other: &'a Read,
    text: (&'a str, SourceId),
    radius: f64,
) -> Result<Side<'a>, Diagnostics> {
    Ok(match read {
        Read::Program(machine, reading) => Side::of_program(&reading.decimals, machine, text, radius)?,
        Read::Input(intent) => Side::of_intent(intent, other.machine(), text, radius)?,
    })
}

/// What a walk found.
struct Found {
    told: Vec<Diagnostic>,
    differences: usize,
    deviation: Bound,
    /// Where that is, in both.
    worst: Option<[Span; 2]>,
    status: Status,
    paths: usize,
    rapids: usize,
    switches: usize,
    /// Paths whose times were compared instead of F.
    timed: usize,
    /// mm.
    length: f64,
}

impl Found {
    fn new() -> Found {
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
        }
    }

    fn is_same(&self) -> bool {
        self.differences == 0
    }

    fn differs(&mut self, diagnostic: Diagnostic) {
        self.differences += 1;
        if self.told.len() < MOST_TOLD {
            self.told.push(diagnostic);
        }
    }

    fn take(&mut self, bound: Bound, places: impl FnOnce() -> [Span; 2]) {
        if self.deviation.mm < bound.mm || (self.deviation.mm == 0.0 && self.deviation.rad < bound.rad) {
            self.worst = Some(places());
        }
        self.deviation = self.deviation.max(bound);
    }

    /// The same with the programs named the other way round.
    fn swapped(mut self) -> Found {
        self.worst = self.worst.map(|[a, b]| [b, a]);
        self
    }
}

/// Two programs, walked side by side.
struct Walk<'s, 'a> {
    a: &'s Side<'a>,
    b: &'s Side<'a>,
    tolerance: f64,
    turn: f64,
    radius: f64,
    metric: Metric,
    found: Found,
}

impl<'s, 'a> Walk<'s, 'a> {
    fn new(a: &'s Side<'a>, b: &'s Side<'a>, scale: Scale) -> Walk<'s, 'a> {
        let Scale { tolerance, turn, radius } = scale;
        let kinds: Vec<Kind> = a.axes.as_slice().iter().map(|(_, kind)| *kind).collect();
        let turn = if 0.0 < turn { turn } else { tolerance / DEGREES };
        let metric = Metric::with_direction(&kinds, radius, tolerance / turn);
        Walk { a, b, tolerance, turn, radius, metric, found: Found::new() }
    }

    fn run(mut self) -> Found {
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

    /// Whether two numbers are the same in the decimals of both; an input's are those of the other.
    fn same_number(&self, a: f64, b: f64, digits: [Option<u8>; 2]) -> bool {
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
        let half = 0.5 / crate::decimal::power_of_ten(coarser) as f64;
        (a - b).abs() <= half + 4.0 * f64::EPSILON * a.abs().max(b.abs())
    }

    fn feed_digits(&self) -> [Option<u8>; 2] {
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
                    (Some(own), Some(other)) => self.same_number(own, other, self.axis_digits(axis)),
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

    fn distance(&self, p: &Position, q: &Position) -> f64 {
        self.metric.distance(p, q).mm
    }

    fn same_switch(&self, own: &Step<f64, ()>, other: &Step<f64, ()>) -> bool {
        let digits = self.feed_digits();
        match (own, other) {
            (Step::Spindle(own), Step::Spindle(other))
            | (Step::Auxiliary(Auxiliary::Dwell(own)), Step::Auxiliary(Auxiliary::Dwell(other))) => {
                self.same_number(*own, *other, digits)
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
                Item::Switch(..) => self.found.switches += 1,
                Item::Path(_) | Item::Points(..) => {}
            },
            _ => {
                let [this, that] = [(self.a, own), (self.b, other)].map(|(side, item)| side.spelled(item));
                let message = format!("the programs differ: {this} in the first, {that} in the second");
                let diagnostic = Diagnostic::refusal("step-differs", message)
                    .at(self.a.place_of(own), this)
                    .and_at(self.b.place_of(other), that);
                self.found.differs(diagnostic);
            }
        }
    }

    /// Tells of steps that stand in one program only, or of others in their place.
    fn apart(&mut self, own: &[Item<'a>], other: &[Item<'a>], at: [usize; 2]) {
        let spelled = |side: &Side<'a>, items: &[Item<'a>]| match items {
            [] => "nothing".to_owned(),
            [one] => side.spelled(one),
            [first, rest @ ..] => format!("{} and {} more", side.spelled(first), counted(rest.len(), "step")),
        };
        let (this, that) = (spelled(self.a, own), spelled(self.b, other));
        let here = |side: &Side<'a>, items: &[Item<'a>], at: usize| match items.first().or(side.items.get(at)) {
            Some(item) => side.place_of(item),
            None => side.end(),
        };
        let (place_a, place_b) = (here(self.a, own, at[0]), here(self.b, other, at[1]));
        let diagnostic = match (own, other) {
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
        };
        self.found.differs(diagnostic);
    }

    /// Compares the points of two splines that only their controls know.
    fn points(&mut self, own: &Part<'a>, other: &Part<'a>) {
        self.found.status = self.found.status.max(Status::PointsOnly);
        self.found.paths += 1;
        let places = |i: usize| [self.a.place(own, i), self.b.place(other, i)];
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
            let [a, b] = places(i);
            self.found.differs(Diagnostic::refusal("points-differ", message).at(a, "").and_at(b, ""));
        }
        for (i, bound) in worst.into_iter().enumerate() {
            self.found.take(bound, || [self.a.place(own, i), self.b.place(other, i)]);
        }
        if own.feed.zip(other.feed).is_some_and(|(a, b)| !self.same_number(a, b, self.feed_digits())) {
            self.feeds_differ([self.a.place(own, 0), self.b.place(other, 0)], [own.feed, other.feed]);
        }
    }
}

/// `1 step`, `2 steps`.
fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}
