//! Arcs by their start tangent: `INDIRV` with `TLON`, as CATIA and Mastercam write them.
//!
//! The arc starts where the tool is and ends where the ray from the centre to the second point of `LINE` meets the circle;
//! the sense is that of the tangent. So the tangent has to be one: where it is none, the tool is not where the arc begins,
//! or what stands in the file is no arc, and any sense would be a guess.

use super::arcs::{Circle, MISFIT_REFUSED, cross, frame_about, is_unit, minus};
use super::motion::Pending;
use super::reader::{Reader, Said};
use super::statement::{Argument, Placed, Statement};
use crate::diagnostic::Diagnostic;
use crate::geom::arc::{Arc, Frame, Plane, Sense};
use crate::geom::direction;
use crate::source::Span;
use crate::units::DEGREES;

/// How far a stated tangent may be off the circle's, degrees. Two decimals of a unit vector leave open
/// asin(√2 · 0.005) = 0.4 degrees, a start that is 0.01 mm off its circle 0.57 degrees at R = 1 mm; both are less.
const TANGENT_WARNED: f64 = 1.0;

/// Beyond this the tangent and the circle do not belong together, degrees: a start that is 0.01 mm off its circle, as far
/// as one may be, turns the tangent of R = 0.12 mm by as much, and no cutter's path is smaller.
const TANGENT_REFUSED: f64 = 5.0;

impl Reader<'_> {
    /// `INDIRV/tx,ty,tz`
    pub(super) fn indirv(&mut self, said: &Said<'_>) {
        if self.arc_in_cycle(said.span) || matches!(self.pending, Some(Pending::Refused)) {
            return;
        }
        match said.statement.numbers().as_deref() {
            Some(&[x, y, z]) if is_unit([x, y, z]) => {
                self.pending = Some(Pending::Tangent([x, y, z], said.span));
            }
            Some(&[_, _, _]) => {
                let message = "INDIRV is no direction: a unit vector is one";
                self.refuse_arc(Diagnostic::error("tangent", message).at(said.span, ""));
            }
            _ => {
                let message = "INDIRV takes three numbers";
                self.refuse_arc(Diagnostic::error("arguments", message).at(said.span, ""));
            }
        }
    }

    /// `TLON,GOFWD/(CIRCLE/…),ON,[2,INTOF,](LINE/…)` or with a cylinder and a plane.
    pub(super) fn tlon(&mut self, said: &Said<'_>) {
        if self.arc_in_cycle(said.span) {
            return;
        }
        let tangent = match self.pending.take() {
            Some(Pending::Tangent(tangent, _)) => tangent,
            // Of an arc that was refused, or of one behind it: where it starts is not known any more.
            Some(Pending::Refused) => return self.pending = Some(Pending::Refused),
            Some(Pending::Circle(_) | Pending::Points(_) | Pending::Left(_)) | None => {
                let message = "TLON without an INDIRV before it";
                return self.refuse_arc(Diagnostic::error("tangent-missing", message).at(said.span, ""));
            }
        };
        match self.tangent_arc(tangent, said) {
            Ok((circle, end)) => self.arc_to(&circle, end, said.span),
            Err(diagnostic) => self.refuse_arc(*diagnostic),
        }
    }

    /// The circle of a TLON, and where on it the arc ends.
    fn tangent_arc(
        &mut self,
        tangent: [f64; 3],
        said: &Said<'_>,
    ) -> Result<(Circle, [f64; 3]), Box<Diagnostic>> {
        let error = |id, message: &str| Box::new(Diagnostic::error(id, message).at(said.span, ""));
        let refusal = |id, message: &str| Box::new(Diagnostic::refusal(id, message).at(said.span, ""));
        let unread = || error("tlon", "this arc cannot be read");
        let second = second(said)?;
        let groups: Vec<&Statement<'_>> =
            said.arguments().iter().filter_map(|placed| placed.argument.group()).collect();
        let &[curve, to] = &groups[..] else { return Err(unread()) };
        let Some(start) = self.program.position else {
            return Err(error("start-unknown", "an arc from a place that is not known"));
        };
        let numbers = curve.numbers().unwrap_or_default();
        let (center, axis, radius, toward) = if curve.major.eq_ignore_ascii_case("CIRCLE") {
            let (&[cx, cy, cz, r], Some(&[_, _, _, ex, ey, ez])) =
                (&numbers[..], to.numbers().as_deref().map(<&[f64; 6]>::try_from).and_then(Result::ok))
            else {
                return Err(unread());
            };
            ([cx, cy, cz], None, r, [ex, ey, ez])
        } else if curve.major.eq_ignore_ascii_case("CYLNDR") {
            let (&[cx, cy, cz, u, v, w, r], Some(e)) = (&numbers[..], last_point(&to.arguments)) else {
                return Err(unread());
            };
            ([cx, cy, cz], Some([u, v, w]), r, e)
        } else {
            return Err(unread());
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
                return Err(Box::new(self.turning(said.span)));
            }
            // Its plane is that of the centre, the start and the tangent there.
            None => Frame::about(about, super::arcs::AXIS_SLACK).map(|(frame, _)| frame).filter(|frame| {
                let [.., height] = frame.local(minus(toward, center));
                height.abs() < MISFIT_REFUSED
            }),
        };
        let Some(frame) = frame else {
            return Err(refusal("arc-plane", "where the axis of this arc points it does not say"));
        };
        let [.., turn] = frame.local(about);
        let sense = if 0.0 < turn { Sense::CounterClockwise } else { Sense::Clockwise };
        let [ray_u, ray_v, _] = frame.local(minus(toward, center));
        let length = (ray_u * ray_u + ray_v * ray_v).sqrt();
        let radius = radius * self.scale;
        if !(0.0 < length && 0.0 < radius) {
            return Err(unread());
        }
        let ([u, v, _], [.., w]) = (frame.local(center), frame.local(toward));
        let end = frame.global([u + radius * ray_u / length, v + radius * ray_v / length, w]);
        if self.rapid {
            return Err(refusal("rapid-arc", "an arc at rapid is not compiled"));
        }
        let circle = Circle {
            center,
            frame,
            sense,
            radius: Some(radius),
            sweep: None,
            by_axis: None,
            turns: 0,
            tangent: Some(tangent),
            second,
            span: said.span,
        };
        Ok((circle, end))
    }

    /// Holds a stated start tangent, and `2,INTOF`, against the arc that they make; whether it is one.
    pub(super) fn holds_tangent(&mut self, circle: &Circle, arc: &Arc, span: Span) -> bool {
        let Some(tangent) = circle.tangent else { return true };
        let [u, v] = arc.tangent(0.0);
        // A helix goes up with its tangent; whether INDIRV does no page says.
        let slope = arc.rise() / (arc.radius() * arc.sweep().abs());
        let stated = arc.frame().local(tangent);
        let off = direction::angle(&stated, &[u, v, 0.0]).min(direction::angle(&stated, &[u, v, slope]));
        let off = off * DEGREES;
        if TANGENT_WARNED < off {
            let message = format!("INDIRV is {off:.1} degrees off the tangent of this arc where the tool is");
            if TANGENT_REFUSED < off {
                self.push(Diagnostic::error("tangent", message).at(span, ""));
                return false;
            }
            self.push(Diagnostic::warning("tangent", message).at(span, ""));
        }
        // The line goes through the centre, so that the first place where a path meets it is at most half a turn away.
        let half = std::f64::consts::PI + MISFIT_REFUSED / arc.radius();
        if circle.second && arc.sweep().abs() <= half {
            let message = "2,INTOF: this end is the first place where the arc meets the line, not the second";
            self.push(Diagnostic::error("tlon", message).at(span, ""));
            return false;
        }
        if !circle.second && arc.is_full() {
            let message =
                "a whole turn without 2,INTOF: the line is met before, and no page says what ends it";
            self.push(Diagnostic::warning("tlon", message).at(span, "read as a whole turn"));
        }
        true
    }
}

/// Whether a TLON ends where it meets its line a second time: its words are `GOFWD`, `ON`, and `2,INTOF` where it does.
fn second(said: &Said<'_>) -> Result<bool, Box<Diagnostic>> {
    let other = |placed: &Placed<'_>| {
        let place = said.place(placed);
        let message = "of TLON only GOFWD, ON and 1 or 2,INTOF are compiled: anything else is another path";
        Err(Box::new(Diagnostic::refusal("tlon", message).at(place, "")))
    };
    let mut which = None;
    let mut stage = 0;
    for placed in said.arguments() {
        let is = |word: &str| placed.argument.word().is_some_and(|known| known.eq_ignore_ascii_case(word));
        stage = match (stage, &placed.argument) {
            (0, Argument::Word(_)) if is("GOFWD") => 1,
            (1, Argument::Group(_)) => 2,
            (2, Argument::Word(_)) if is("ON") => 3,
            (3, Argument::Number(n)) if *n == 1.0 || *n == 2.0 => {
                which = Some(*n);
                4
            }
            (3 | 4, Argument::Word(_)) if is("INTOF") => 5,
            (3 | 5, Argument::Group(_)) => 6,
            _ => return other(placed),
        };
    }
    if stage != 6 {
        let message = "TLON has GOFWD, a circle, ON and a line";
        return Err(Box::new(Diagnostic::error("tlon", message).at(said.span, "")));
    }
    Ok(which == Some(2.0))
}

/// The last `(POINT/x,y,z)` among arguments.
fn last_point(arguments: &[Placed<'_>]) -> Option<[f64; 3]> {
    arguments.iter().rev().find_map(|placed| {
        let group = placed.argument.group().filter(|group| group.major.eq_ignore_ascii_case("POINT"))?;
        group.numbers()?.try_into().ok()
    })
}
