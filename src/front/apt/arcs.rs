//! Arcs in all their spellings: `CIRCLE` with six, seven and eleven numbers, `MOVARC`, `INDIRV` with `TLON`.
//!
//! Which way round a circle goes belongs to the system: `CIRCLE/…,0,0,1` is counter-clockwise in Creo and SolidWorks CAM
//! and clockwise in NX. Straight lines that meet arcs without a corner know better than any table, so each arc between
//! such neighbours votes, and where most votes of a file contradict its system a warning says so.

use super::motion::Pending;
use super::reader::{Reader, Said};
use super::statement::{Placed, Statement};
use super::words::Hand;
use crate::diagnostic::Diagnostic;
use crate::geom::arc::{Arc, Frame, Plane, Sense};
use crate::source::Span;

/// Below this an arc's start, end, centre and radius are one circle, mm: the last place of three decimals and rounding.
const MISFIT_WARNED: f64 = 0.002;

/// Above this they are none, mm: what controls accept.
const MISFIT_REFUSED: f64 = 0.01;

/// A chord shorter than this is that of a full circle whose end was rounded, mm.
const FULL_CHORD: f64 = 1.0e-5;

/// How far an axis may be from X, Y or Z: as far as six decimals say nothing.
const AXIS_SLACK: f64 = 1.0e-6;

/// cos of the corner below which a line and an arc run into each other.
const TANGENT: f64 = 0.99;

/// A circle that waits for its end.
#[derive(Clone, Debug)]
pub(super) struct Circle {
    /// mm.
    center: [f64; 3],
    frame: Frame,
    sense: Sense,
    /// The radius stated, mm.
    radius: Option<f64>,
    /// The sweep stated, radians, where it is.
    sweep: Option<f64>,
    /// Whether its sense follows from an axis, so that neighbours may vote on it.
    by_axis: bool,
    pub(super) span: Span,
}

/// The direction in which an arc was left, and where.
#[derive(Clone, Debug)]
pub(super) struct Left {
    tangent: [f64; 2],
    frame: Frame,
    at: [f64; 3],
}

/// How many arcs go the way that their neighbours say, and how many do not.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Votes {
    agree: usize,
    contradict: usize,
    first: Option<Span>,
}

/// The frame of the plane that an axis is square to, and whether its w points along it.
fn frame_about(axis: [f64; 3]) -> Option<(Frame, bool)> {
    let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
    if !(0.5 < length && length < 2.0) {
        return None;
    }
    Frame::about(axis, AXIS_SLACK)
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] - b[i])
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

impl Reader<'_> {
    /// The circle of a centre and an axis; none where that is no direction.
    fn circle_of(&mut self, center: [f64; 3], axis: [f64; 3], hand: Hand, said: &Said<'_>) -> Option<Circle> {
        let Some((frame, along)) = frame_about(axis) else {
            self.error("arc-plane", "the axis of this arc is no direction", said.span);
            return None;
        };
        let sense = match (along, hand) {
            (true, Hand::Right) | (false, Hand::Left) => Sense::CounterClockwise,
            (true, Hand::Left) | (false, Hand::Right) => Sense::Clockwise,
        };
        let center = center.map(|x| x * self.scale);
        Some(Circle { center, frame, sense, radius: None, sweep: None, by_axis: true, span: said.span })
    }

    fn wait(&mut self, circle: Circle) {
        if self.rapid {
            self.refuse("rapid-arc", "an arc at rapid is not compiled", circle.span);
        }
        self.pending = Some(Pending::Circle(circle));
    }

    /// `CIRCLE/cx,cy,cz,i,j,k[,r[,t,f,d,e]]`
    pub(super) fn circle(&mut self, said: &Said<'_>) {
        let numbers = said.statement.numbers().unwrap_or_default();
        if ![6, 7, 11].contains(&numbers.len()) {
            let message = "CIRCLE has six numbers, seven with its radius, or eleven";
            return self.error("arc-numbers", message, said.span);
        }
        let hand = self.words.circle;
        let (center, axis) = ([numbers[0], numbers[1], numbers[2]], [numbers[3], numbers[4], numbers[5]]);
        if let Some(circle) = self.circle_of(center, axis, hand, said) {
            let radius = numbers.get(6).map(|r| r * self.scale);
            self.wait(Circle { radius, ..circle });
        }
    }

    /// `MOVARC/cx,cy,cz,nx,ny,nz,r,ANGLE,sweep-degrees`
    pub(super) fn movarc(&mut self, said: &Said<'_>) {
        let numbers: Vec<f64> =
            said.arguments().iter().filter_map(|placed| placed.argument.number()).collect();
        let [cx, cy, cz, nx, ny, nz, r, degrees] = numbers[..] else {
            let message = "MOVARC has a centre, an axis, a radius, ANGLE and degrees";
            return self.error("arc-numbers", message, said.span);
        };
        if !(said.has("ANGLE") && 0.0 < degrees && degrees < 360_000.0) {
            return self.error("arc-numbers", "MOVARC has ANGLE and degrees greater than zero", said.span);
        }
        if let Some(circle) = self.circle_of([cx, cy, cz], [nx, ny, nz], Hand::Right, said) {
            let sweep = Some(degrees / crate::units::DEGREES);
            self.wait(Circle { radius: Some(r * self.scale), sweep, ..circle });
        }
    }

    /// `INDIRV/tx,ty,tz`
    pub(super) fn indirv(&mut self, said: &Said<'_>) {
        match said.statement.numbers().as_deref() {
            Some(&[x, y, z]) => self.pending = Some(Pending::Tangent([x, y, z])),
            _ => self.error("arguments", "INDIRV takes three numbers", said.span),
        }
    }

    /// `TLON,GOFWD/(CIRCLE/…),ON,[2,INTOF,](LINE/…)` or with a cylinder and a plane.
    pub(super) fn tlon(&mut self, said: &Said<'_>) {
        let Some(Pending::Tangent(tangent)) = self.pending.take() else {
            return self.error("tangent-missing", "TLON without an INDIRV before it", said.span);
        };
        let groups: Vec<&Statement<'_>> =
            said.arguments().iter().filter_map(|placed| placed.argument.group()).collect();
        let unread = |reader: &mut Self| reader.error("tlon", "this arc cannot be read", said.span);
        let &[curve, to] = &groups[..] else { return unread(self) };
        let Some(start) = self.program.position else {
            return self.error("start-unknown", "an arc from a place that is not known", said.span);
        };
        let numbers = curve.numbers().unwrap_or_default();
        let (center, axis, radius, toward) = if curve.major.eq_ignore_ascii_case("CIRCLE") {
            let (&[cx, cy, cz, r], Some(&[_, _, _, ex, ey, ez])) =
                (&numbers[..], to.numbers().as_deref().map(<&[f64; 6]>::try_from).and_then(Result::ok))
            else {
                return unread(self);
            };
            ([cx, cy, cz], None, r, [ex, ey, ez])
        } else if curve.major.eq_ignore_ascii_case("CYLNDR") {
            let (&[cx, cy, cz, u, v, w, r], Some(e)) = (&numbers[..], last_point(&to.arguments)) else {
                return unread(self);
            };
            ([cx, cy, cz], Some([u, v, w]), r, e)
        } else {
            return unread(self);
        };
        let (center, toward) = (center.map(|x| x * self.scale), toward.map(|x| x * self.scale));
        let flat = |i: usize| {
            (start[i] - center[i]).abs() < MISFIT_REFUSED && (toward[i] - center[i]).abs() < MISFIT_REFUSED
        };
        // Where the arc goes counter-clockwise about it, (s − c) × t points along the axis.
        let about = cross(minus(start, center), tangent);
        let frame = match axis {
            Some(axis) => frame_about(axis).map(|(frame, _)| frame),
            None if flat(2) => Some(Plane::Xy.into()),
            None if flat(1) => {
                // A circle without an axis lies in X Y; in X Z it is that of a lathe.
                return self.turned(said.span);
            }
            // Its plane is that of the centre, the start and the tangent there.
            None => Frame::about(about, AXIS_SLACK).map(|(frame, _)| frame).filter(|frame| {
                let [.., height] = frame.local(minus(toward, center));
                height.abs() < MISFIT_REFUSED
            }),
        };
        let Some(frame) = frame else {
            return self.refuse("arc-plane", "where the axis of this arc points it does not say", said.span);
        };
        let [.., turn] = frame.local(about);
        let sense = if 0.0 < turn { Sense::CounterClockwise } else { Sense::Clockwise };
        let [ray_u, ray_v, _] = frame.local(minus(toward, center));
        let length = (ray_u * ray_u + ray_v * ray_v).sqrt();
        let radius = radius * self.scale;
        if !(0.0 < length && 0.0 < radius) {
            return unread(self);
        }
        let ([u, v, _], [.., w]) = (frame.local(center), frame.local(toward));
        let end = frame.global([u + radius * ray_u / length, v + radius * ray_v / length, w]);
        let circle = Circle {
            center,
            frame,
            sense,
            radius: Some(radius),
            sweep: None,
            by_axis: false,
            span: said.span,
        };
        if self.rapid {
            return self.refuse("rapid-arc", "an arc at rapid is not compiled", said.span);
        }
        self.arc_to(&circle, end, said.span);
    }

    /// An arc from where the tool is.
    pub(super) fn arc_to(&mut self, circle: &Circle, end: [f64; 3], span: Span) {
        let whole = Span { start: circle.span.start, ..span };
        let Some(start) = self.program.position.filter(|_| self.program.has_moved()) else {
            return self.error("start-unknown", "an arc from a place that no move went to", whole);
        };
        let feed = self.feed;
        let Some(feed) = self.per_minute(feed, whole) else { return };
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
            return self.turning_arc(span);
        }
        let (start, place) = (self.program.place(&start), self.program.place(&end));
        let mut arc = match Arc::new(circle.frame, circle.sense, start, place, [u, v]) {
            Ok(arc) => arc,
            Err(error) => return self.error("arc", error.to_string(), whole),
        };
        let stated = circle.radius.map_or(0.0, |r| (r - arc.radius()).abs());
        let misfit = arc.misfit().max(stated);
        if MISFIT_REFUSED < misfit {
            let message = format!("start, end, centre and radius are {misfit:.4} mm away from one circle");
            return self.error("arc-misfit", message, whole);
        }
        if MISFIT_WARNED < misfit {
            let message = format!("start, end, centre and radius are {misfit:.4} mm away from one circle");
            self.push(Diagnostic::warning("arc-misfit", message).at(whole, ""));
        }
        if circle.by_axis {
            self.entered(&arc, whole);
        }
        let turns = match circle.sweep {
            None => 0.0,
            Some(sweep) => {
                let turns = ((sweep - arc.sweep().abs()) / (2.0 * std::f64::consts::PI)).round();
                let rest = sweep - arc.sweep().abs() - turns * 2.0 * std::f64::consts::PI;
                if 0.01 < (rest * arc.radius()).abs() {
                    let message = "the sweep of this arc does not lead to its end";
                    return self.error("arc-sweep", message, whole);
                }
                turns
            }
        };
        arc = arc.with_turns(turns.max(0.0) as u32);
        self.program.arc(arc, feed, whole);
        let left = Left { tangent: arc.tangent(1.0), frame: circle.frame, at: end };
        self.pending = circle.by_axis.then_some(Pending::Left(left));
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
    fn entered(&mut self, arc: &Arc, span: Span) {
        if let (Some(from), Some(at)) = (self.program.before, self.program.position) {
            let tangent = arc.tangent(0.0);
            self.votes.count(arc.frame(), tangent, from, at, span);
        }
    }

    /// A line after an arc votes on its sense.
    pub(super) fn left(&mut self, left: &Left, to: [f64; 3]) {
        let span = Span::new(self.source, 0..0);
        self.votes.count(left.frame, left.tangent, left.at, to, span);
    }

    /// Whether the file contradicts the sense that its system has.
    pub(super) fn vote(&mut self) {
        let Votes { agree, contradict, first } = self.votes;
        if agree < contradict && 3 <= contradict {
            let message = format!(
                "{contradict} of {} arcs go the other way round than the lines beside them",
                agree + contradict
            );
            let other = match self.words.circle {
                Hand::Right => "left-hand",
                Hand::Left => "right-hand",
            };
            let mut diagnostic = Diagnostic::warning("arc-sense", message).hint(format!(
                "`{}` reads CIRCLE otherwise than this file writes it; circle = \"{other}\" in a table for --words turns it",
                self.system.name
            ));
            if let Some(span) = first {
                diagnostic = diagnostic.at(span, "first here");
            }
            self.push(diagnostic);
        }
    }
}

impl Votes {
    /// A line from `from` to `to` beside an arc with this tangent.
    fn count(&mut self, frame: Frame, tangent: [f64; 2], from: [f64; 3], to: [f64; 3], span: Span) {
        let [u, v, _] = frame.local(minus(to, from));
        let line = [u, v];
        let length = (line[0] * line[0] + line[1] * line[1]).sqrt();
        let cos = (line[0] * tangent[0] + line[1] * tangent[1]) / length;
        if TANGENT < cos {
            self.agree += 1;
        } else if cos < -TANGENT {
            self.contradict += 1;
            self.first = self.first.or(Some(span).filter(|span| span.end != 0));
        }
    }
}

/// The last `(POINT/x,y,z)` among arguments.
fn last_point(arguments: &[Placed<'_>]) -> Option<[f64; 3]> {
    arguments.iter().rev().find_map(|placed| {
        let group = placed.argument.group().filter(|group| group.major.eq_ignore_ascii_case("POINT"))?;
        group.numbers()?.try_into().ok()
    })
}
