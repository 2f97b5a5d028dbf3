//! Arcs by their axis, `CIRCLE` with six, seven and eleven numbers and `MOVARC`, and what all arcs have in common.
//!
//! Which way round a circle goes belongs to the system: `CIRCLE/…,0,0,1` is counter-clockwise in Creo and SolidWorks CAM
//! and clockwise in NX. Straight lines that meet arcs without a corner know better than any table, so each arc between
//! such neighbours votes, and where most votes of a file contradict its system a warning says so.

use super::motion::Pending;
use super::points::{Reading, Ring};
use super::reader::{Reader, Said};
use super::statement::Placed;
use super::words::{ByAxis, Hand, Meaning, Words};
use crate::diagnostic::Diagnostic;
use crate::geom::arc::{Arc, Frame, Sense};
use crate::source::Span;

/// Below this an arc's start, end, centre and radius are one circle, mm: the last place of three decimals and rounding.
const MISFIT_WARNED: f64 = 0.002;

/// Above this they are none, mm: what controls accept.
pub(super) const MISFIT_REFUSED: f64 = 0.01;

/// A chord shorter than this is that of a full circle whose end was rounded, mm: one in the fifth decimal, and what the difference
/// of two coordinates up to 100 m is off by in floats, 3e-11 mm.
pub(super) const FULL_CHORD: f64 = 1.0e-5 + 1.0e-10;

/// An arc that is shorter than three decimals tell and turns by less than this, radians, may as well be a whole turn.
const UNCLEAR_TURN: f64 = 1.0e-3;

/// How far an axis may be from X, Y or Z: as far as six decimals say nothing.
pub(super) const AXIS_SLACK: f64 = 1.0e-6;

/// How far the end of a stated sweep may be from that of its arc, beside what both ends of it are off their circle, mm.
const SWEEP_SLACK: f64 = 0.01;

/// So many lines that contradict are more than those of one cusp.
const FEW_VOTES: usize = 3;

/// cos of the corner below which a line and an arc run into each other.
const TANGENT: f64 = 0.99;

/// A circle that waits for its end.
#[derive(Clone, Debug)]
pub(super) struct Circle {
    /// mm.
    pub(super) center: [f64; 3],
    pub(super) frame: Frame,
    pub(super) sense: Sense,
    /// The radius stated, mm.
    pub(super) radius: Option<f64>,
    /// The sweep stated, radians, where it is.
    pub(super) sweep: Option<f64>,
    /// The statement whose axis its sense follows from, so that neighbours may vote on it.
    pub(super) by_axis: Option<ByAxis>,
    /// Whole turns before its end is met for the last time, `TIMES`.
    pub(super) turns: u32,
    /// The start tangent stated, where it is.
    pub(super) tangent: Option<[f64; 3]>,
    /// Whether it ends where it meets a line a second time.
    pub(super) second: bool,
    pub(super) span: Span,
}

/// The direction in which an arc was left, and where.
#[derive(Clone, Debug)]
pub(super) struct Left {
    tangent: [f64; 2],
    frame: Frame,
    by: ByAxis,
    at: [f64; 3],
    /// Its circle, where points behind it may be of the arc.
    pub(super) ring: Option<(Ring, Reading)>,
}

/// How many arcs go the way that their neighbours say, and how many do not.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Votes {
    /// Of each statement.
    senses: [Sides; 3],
    /// Lines that end on the circle of the arc before them: how many, and the first.
    pub(super) lines: Option<(usize, Span)>,
}

/// How many arcs of one statement go the way that their neighbours say, and how many do not.
#[derive(Clone, Copy, Debug, Default)]
struct Sides {
    agree: usize,
    contradict: usize,
    first: Option<Span>,
}

/// Whether a vector is a direction, which files write with length 1.
pub(super) fn is_unit(vector: [f64; 3]) -> bool {
    let length = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
    0.5 < length && length < 2.0
}

/// The frame of the plane that an axis is square to, and whether its w points along it.
pub(super) fn frame_about(axis: [f64; 3]) -> Option<(Frame, bool)> {
    Some(axis).filter(|axis| is_unit(*axis)).and_then(|axis| Frame::about(axis, AXIS_SLACK))
}

pub(super) fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] - b[i])
}

pub(super) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

impl Circle {
    /// Of `cx,cy,cz,i,j,k[,r]` in units of `scale` mm; none where the axis is no direction.
    pub(super) fn from_numbers(
        numbers: &[f64],
        by: ByAxis,
        words: &Words,
        scale: f64,
        span: Span,
    ) -> Option<Circle> {
        let &[cx, cy, cz, i, j, k, ref others @ ..] = numbers else { return None };
        let (frame, along) = frame_about([i, j, k])?;
        let sense = match (along, words.hand(by).0) {
            (true, Hand::Right) | (false, Hand::Left) => Sense::CounterClockwise,
            (true, Hand::Left) | (false, Hand::Right) => Sense::Clockwise,
        };
        Some(Circle {
            center: [cx, cy, cz].map(|x| x * scale),
            frame,
            sense,
            radius: others.first().map(|r| r * scale),
            sweep: None,
            by_axis: Some(by),
            turns: 0,
            tangent: None,
            second: false,
            span,
        })
    }
}

impl Reader<'_> {
    /// The circle of a centre, an axis and perhaps a radius; none where the axis is no direction.
    fn circle_of(&mut self, numbers: &[f64], by: ByAxis, said: &Said<'_>) -> Option<Circle> {
        let circle = Circle::from_numbers(numbers, by, &self.words, self.scale, said.span);
        if circle.is_none() {
            let message = "the axis of this arc is no direction";
            self.refuse_arc(Diagnostic::error("arc-plane", message).at(said.span, ""));
        }
        circle
    }

    fn wait(&mut self, circle: Circle) {
        if matches!(self.pending, Some(Pending::Refused)) {
            // Where it starts is not known any more.
            return;
        }
        if self.rapid {
            let message = "an arc at rapid is not compiled";
            return self.refuse_arc(Diagnostic::refusal("rapid-arc", message).at(circle.span, ""));
        }
        self.pending = Some(Pending::Circle(circle));
    }

    /// Says why an arc is none: what stands for its end is passed over, since one report is enough.
    pub(super) fn refuse_arc(&mut self, diagnostic: Diagnostic) {
        self.push(diagnostic);
        self.rapid = false;
        self.pending = Some(Pending::Refused);
    }

    /// Whether an arc stands where each point is a hole.
    pub(super) fn arc_in_cycle(&mut self, span: Span) -> bool {
        let within = self.cycle.is_some();
        if within && !matches!(self.pending, Some(Pending::Refused)) {
            let message = "an arc within a cycle: CYCLE/OFF has to stand before it";
            self.refuse_arc(Diagnostic::error("arc-in-cycle", message).at(span, ""));
        }
        within
    }

    /// What a statement other than a point does to an arc that waits for one: nothing, or it is an error, since the arc
    /// would be lost, or would start elsewhere.
    pub(super) fn between(&mut self, meaning: Meaning, span: Span) {
        if meaning == Meaning::Goto {
            return;
        }
        self.close_arc();
        match meaning {
            // They move nothing, and leave the units and the frame as they are. A frame is looked at where it changes.
            Meaning::Comment
            | Meaning::LeftOut
            | Meaning::Refused
            | Meaning::Partno
            | Meaning::Insert
            | Meaning::Path
            | Meaning::PathEnd
            | Meaning::Mode
            | Meaning::Stop
            | Meaning::Opstop
            | Meaning::Cutter
            | Meaning::Tldata
            | Meaning::Toolno
            | Meaning::Spindl
            | Meaning::Fedrat
            | Meaning::Coolnt
            | Meaning::Delay
            | Meaning::Cutcom
            | Meaning::Multax
            | Meaning::Tlaxis
            | Meaning::Frame
            | Meaning::Goto => {}
            Meaning::Rapid => {
                if let Some(Pending::Circle(_) | Pending::Tangent(..)) = self.pending {
                    let message = "RAPID stands within an arc: an arc at rapid is not compiled";
                    self.refuse_arc(Diagnostic::refusal("rapid-arc", message).at(span, ""));
                }
            }
            // The last tangent counts, and TLON takes it.
            Meaning::Indirv | Meaning::Tlon => {
                if let Some(Pending::Circle(_)) = self.pending {
                    self.break_off(span);
                }
            }
            Meaning::End
            | Meaning::Units
            | Meaning::Loadtl
            | Meaning::Load
            | Meaning::From
            | Meaning::Gohome
            | Meaning::Godlta
            | Meaning::Circle
            | Meaning::Movarc
            | Meaning::NurbsSiemens
            | Meaning::Nurbs
            | Meaning::Knot
            | Meaning::Cntrl
            | Meaning::Movnrb
            | Meaning::Cycle => self.break_off(span),
        }
    }

    /// An arc that waits for its point gets none: something else stands at `span`.
    pub(super) fn break_off(&mut self, span: Span) {
        let (id, message, first) = match &self.pending {
            Some(Pending::Circle(circle)) => {
                ("arc-end-missing", "this circle has no end: no GOTO follows", circle.span)
            }
            Some(Pending::Tangent(_, first)) => ("tangent-alone", "no TLON follows this INDIRV", *first),
            Some(Pending::Points(_) | Pending::Left(_) | Pending::Refused) | None => return,
        };
        let mut diagnostic = Diagnostic::error(id, message).at(first, "");
        if span != first {
            diagnostic = diagnostic.and_at(span, "this stands before one");
        }
        self.refuse_arc(diagnostic);
    }

    /// `CIRCLE/cx,cy,cz,i,j,k[,r[,t,f,d,e]][,TIMES,n]`
    pub(super) fn circle(&mut self, said: &Said<'_>) {
        if self.arc_in_cycle(said.span) {
            return;
        }
        let Some((numbers, turns)) = numbered(said) else {
            let message = "CIRCLE has six numbers, seven with its radius, or eleven, and perhaps TIMES with a whole number";
            return self.refuse_arc(Diagnostic::error("arc-numbers", message).at(said.span, ""));
        };
        let by = by_count(&numbers);
        if let Some(circle) = self.circle_of(&numbers, by, said) {
            self.wait(Circle { turns, ..circle });
        }
    }

    /// `MOVARC/cx,cy,cz,nx,ny,nz,r,ANGLE,sweep-degrees`
    pub(super) fn movarc(&mut self, said: &Said<'_>) {
        if self.arc_in_cycle(said.span) {
            return;
        }
        let numbers: Vec<f64> =
            said.arguments().iter().filter_map(|placed| placed.argument.number()).collect();
        let [cx, cy, cz, nx, ny, nz, r, degrees] = numbers[..] else {
            let message = "MOVARC has a centre, an axis, a radius, ANGLE and degrees";
            return self.refuse_arc(Diagnostic::error("arc-numbers", message).at(said.span, ""));
        };
        if !(said.has("ANGLE") && 0.0 < degrees && degrees < 360_000.0) {
            let message = "MOVARC has ANGLE and degrees greater than zero";
            return self.refuse_arc(Diagnostic::error("arc-numbers", message).at(said.span, ""));
        }
        if let Some(circle) = self.circle_of(&[cx, cy, cz, nx, ny, nz, r], ByAxis::Movarc, said) {
            let sweep = Some(degrees / crate::units::DEGREES);
            self.wait(Circle { sweep, ..circle });
        }
    }

    /// An arc from where the tool is; where it is none, what follows is read as if it had been.
    pub(super) fn arc_to(&mut self, circle: &Circle, end: [f64; 3], span: Span) {
        if self.follow(circle, end, span).is_none() {
            self.program.position = Some(end);
        }
    }

    fn follow(&mut self, circle: &Circle, end: [f64; 3], span: Span) -> Option<()> {
        let whole = Span { start: circle.span.start, ..span };
        let Some(start) = self.program.position.filter(|_| self.program.has_moved()) else {
            self.error("start-unknown", "an arc from a place that no move went to", whole);
            return None;
        };
        let feed = self.feed;
        let feed = self.per_minute(feed, whole)?;
        let ([su, sv, sw], [eu, ev, height]) = (circle.frame.local(start), circle.frame.local(end));
        let chord = ((eu - su) * (eu - su) + (ev - sv) * (ev - sv)).sqrt();
        let mut end = end;
        if chord < FULL_CHORD {
            // Over the start, in a tilted plane to the last bit too where it does not rise.
            end = match circle.frame.plane() {
                Some(_) => circle.frame.global([su, sv, height]),
                None => {
                    let [.., rise] = circle.frame.axes().map(|axis| axis.map(|x| x * (height - sw)));
                    std::array::from_fn(|i| start[i] + rise[i])
                }
            };
        }
        let [u, v, _] = circle.frame.local(circle.center);
        if self.program.stood() != self.program.axis() {
            self.turning_arc(span);
            return None;
        }
        let (start, place) = (self.program.place(&start), self.program.place(&end));
        let mut arc = match Arc::new(circle.frame, circle.sense, start, place, [u, v]) {
            Ok(arc) => arc,
            Err(error) => {
                self.error("arc", error.to_string(), whole);
                return None;
            }
        };
        let stated = circle.radius.map_or(0.0, |r| (r - arc.radius()).abs());
        let misfit = arc.misfit().max(stated);
        if MISFIT_REFUSED < misfit {
            let message = format!("start, end, centre and radius are {misfit:.4} mm away from one circle");
            self.error("arc-misfit", message, whole);
            return None;
        }
        if MISFIT_WARNED < misfit {
            let message = format!("start, end, centre and radius are {misfit:.4} mm away from one circle");
            self.push(Diagnostic::warning("arc-misfit", message).at(whole, ""));
        }
        if !self.holds_tangent(circle, &arc, whole) {
            return None;
        }
        if let Some(by) = circle.by_axis {
            self.entered(&arc, by, whole);
        }
        let round = chord < FULL_CHORD;
        if circle.sweep.is_none() && !round && !self.goes_round(&arc, chord, whole) {
            return None;
        }
        let turns = match circle.sweep {
            // Over its start a tilted arc begins and ends in places that rounding keeps apart: once round it is one turn.
            None if round && arc.sweep().abs() < std::f64::consts::PI => f64::from(circle.turns) + 1.0,
            None => f64::from(circle.turns),
            Some(sweep) => {
                let turns = ((sweep - arc.sweep().abs()) / (2.0 * std::f64::consts::PI)).round();
                let rest = sweep - arc.sweep().abs() - turns * 2.0 * std::f64::consts::PI;
                if SWEEP_SLACK + 2.0 * misfit < (rest * arc.radius()).abs() {
                    let message = "the sweep of this arc does not lead to its end";
                    self.error("arc-sweep", message, whole);
                    return None;
                }
                turns
            }
        };
        arc = arc.with_turns(turns.max(0.0) as u32);
        self.program.arc(arc, feed, whole);
        self.pending = circle.by_axis.map(|by| {
            let (tangent, frame) = (arc.tangent(1.0), circle.frame);
            Pending::Left(Left { tangent, frame, by, at: end, ring: None })
        });
        Some(())
    }

    /// Whether an arc is not almost a whole turn: where its end is over its start but for rounding, the file may mean a turn, or a
    /// plunge where it rises and next to nothing where it does not.
    fn goes_round(&mut self, arc: &Arc, chord: f64, span: Span) -> bool {
        if std::f64::consts::PI < arc.sweep().abs() || MISFIT_REFUSED < chord {
            return true;
        }
        if chord < arc.rise().abs() {
            let message = format!(
                "this arc ends {chord:.5} mm beside its start and {:.4} mm above or below it: whether that is a whole turn of a helix or a plunge it does not say",
                arc.rise().abs()
            );
            self.push(
                Diagnostic::refusal("arc-turn", message)
                    .at(span, "")
                    .hint("with its end over its start, to 0.00001 mm, an arc is a whole turn; a GOTO without a CIRCLE is a plunge"),
            );
            return false;
        }
        if chord < MISFIT_WARNED && arc.sweep().abs() < UNCLEAR_TURN {
            let message = format!(
                "this arc ends {chord:.5} mm beside its start: whether that is a whole turn of radius {:.3} or next to nothing it does not say",
                arc.radius()
            );
            self.push(
                Diagnostic::refusal("arc-turn", message)
                    .at(span, "")
                    .hint("with its end at its start, to 0.00001 mm, an arc is a whole turn; a GOTO without a CIRCLE is a step"),
            );
            return false;
        }
        if chord < MISFIT_WARNED && MISFIT_REFUSED < arc.radius() {
            let message = format!("this arc is {chord:.5} mm long, not a whole turn");
            self.push(Diagnostic::warning("arc-turn", message).at(span, ""));
        }
        true
    }

    /// An arc in which the tool turns: how its direction goes along the arc no page says.
    pub(super) fn turning_arc(&mut self, span: Span) {
        let message =
            "an arc in which the tool turns is not compiled: how it turns along the arc no page says";
        self.push(
            Diagnostic::refusal("arc-axis", message)
                .at(span, "")
                .hint("points on the arc say it, a GOTO with six numbers each"),
        );
    }

    /// A line before an arc votes on its sense.
    fn entered(&mut self, arc: &Arc, by: ByAxis, span: Span) {
        if let (Some(from), Some(at)) = (self.program.before, self.program.position) {
            let tangent = arc.tangent(0.0);
            self.votes.count((by, arc.frame()), tangent, from, at, span);
        }
    }

    /// A line after an arc votes on its sense.
    pub(super) fn left(&mut self, left: &Left, to: [f64; 3], at: Span) {
        let span = Span::new(self.source, 0..0);
        self.votes.count((left.by, left.frame), left.tangent, left.at, to, span);
        if let Some((ring, reading)) = left.ring.as_ref().filter(|_| !self.rapid) {
            self.passes_ring(ring, *reading, to, at);
        }
    }

    /// Whether the file contradicts the sense that its system has.
    pub(super) fn vote(&mut self) {
        self.lines_on_circles();
        for by in ByAxis::ALL {
            self.sense(by);
        }
    }

    /// The same of one statement: an error, unless the shop's own table says so.
    fn sense(&mut self, by: ByAxis) {
        let Sides { agree, contradict, first } = self.votes.senses[by as usize];
        // One line beside an arc may be that of a cusp.
        if contradict <= agree || contradict < 2 {
            return;
        }
        let message = format!(
            "arcs go the other way round than {contradict} of the {} lines that run into them",
            agree + contradict
        );
        let (own, other) = match self.words.hand(by) {
            (Hand::Right, _) => ("right-hand", "left-hand"),
            (Hand::Left, _) => ("left-hand", "right-hand"),
        };
        let key = by.key();
        let diagnostic = if self.words.hand(by).1 {
            Diagnostic::warning("arc-sense", message)
                .hint(format!("{key} = \"{own}\" in the table of --words says so"))
        } else {
            // A cusp has two lines beside it.
            let severity = if contradict < FEW_VOTES { Diagnostic::warning } else { Diagnostic::error };
            severity("arc-sense", message)
                .hint(format!(
                    "`{}` reads them otherwise than this file writes them; {key} = \"{other}\" in a table for --words turns them",
                    self.system.name
                ))
                .hint(format!("{key} = \"{own}\" there says that they are right"))
        };
        self.push(match first {
            Some(span) => diagnostic.at(span, "first here"),
            None => diagnostic,
        });
    }
}

/// The numbers of a CIRCLE, and how many whole turns it makes before its end is met for the last time.
fn numbered(said: &Said<'_>) -> Option<(Vec<f64>, u32)> {
    let is_times =
        |placed: &&Placed<'_>| placed.argument.word().is_some_and(|word| word.eq_ignore_ascii_case("TIMES"));
    let arguments = said.arguments();
    let count = arguments.iter().take_while(|placed| !is_times(placed)).count();
    let numbers: Option<Vec<f64>> =
        arguments[..count].iter().map(|placed| placed.argument.number()).collect();
    let times = match &arguments[count..] {
        [] => 1.0,
        [_, times] => times.argument.number()?,
        [..] => return None,
    };
    let fits = [6, 7, 11].contains(&count) && times.fract() == 0.0 && (1.0..1000.0).contains(&times);
    fits.then_some((numbers?, times as u32 - 1))
}

/// Which statement a CIRCLE of so many numbers is.
pub(super) fn by_count(numbers: &[f64]) -> ByAxis {
    if numbers.len() == 11 { ByAxis::Eleven } else { ByAxis::Circle }
}

impl Votes {
    /// A line from `from` to `to` beside an arc with this tangent.
    fn count(
        &mut self,
        (by, frame): (ByAxis, Frame),
        tangent: [f64; 2],
        from: [f64; 3],
        to: [f64; 3],
        span: Span,
    ) {
        let sides = &mut self.senses[by as usize];
        let [u, v, _] = frame.local(minus(to, from));
        let line = [u, v];
        let length = (line[0] * line[0] + line[1] * line[1]).sqrt();
        let cos = (line[0] * tangent[0] + line[1] * tangent[1]) / length;
        if TANGENT < cos {
            sides.agree += 1;
        } else if cos < -TANGENT {
            sides.contradict += 1;
            sides.first = sides.first.or(Some(span).filter(|span| span.end != 0));
        }
    }
}
