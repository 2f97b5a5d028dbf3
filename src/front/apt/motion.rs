//! Points, increments, rapids and the tool axis.

use super::arcs::{Circle, Left, is_unit};
use super::points::Points;
use super::program::UPRIGHT;
use super::reader::{Reader, Said};
use super::technology::Feed;
use crate::diagnostic::Diagnostic;
use crate::geom::direction;
use crate::source::Span;

/// How far two tool axes may be apart and still be taken for one on an arc, radians: six decimals say no more.
const AXIS_SLACK: f64 = 2.0e-6;

/// What waits for the next point.
#[derive(Clone, Debug)]
pub(super) enum Pending {
    /// A circle waits for its end.
    Circle(Circle),
    /// A circle has a point, and waits for more.
    Points(Points),
    /// A start tangent waits for its arc, INDIRV, and where it stands.
    Tangent([f64; 3], Span),
    /// An arc was left in this direction: a straight line after it may tell whether its sense was right.
    Left(Left),
    /// An arc was refused: the point that it waited for is passed over, since one report is enough.
    Refused,
}

/// Whether a tool axis, of whatever length, is one on an arc with that of length 1.
pub(super) fn is_along(axis: &[f64; 3], other: [f64; 3]) -> bool {
    is_unit(other) && direction::angle(axis, &other) <= AXIS_SLACK
}

impl Reader<'_> {
    /// A point in mm, where its coordinates are numbers that a machine may have.
    fn point(&mut self, numbers: &[f64], span: Span) -> Option<[f64; 3]> {
        let point = [numbers[0] * self.scale, numbers[1] * self.scale, numbers[2] * self.scale];
        self.unit_taken |= !self.units_stated;
        if point.iter().all(|x| x.abs() < 1.0e9) {
            return Some(point);
        }
        self.error("number-range", "a coordinate is beyond any machine", span);
        None
    }

    /// `GOTO/x,y,z[,i,j,k]`
    #[inline]
    pub(super) fn goto(&mut self, numbers: &[f64], line: u32, span: Span) {
        if numbers.len() == 6 {
            if !self.set_axis([numbers[3], numbers[4], numbers[5]], span) {
                return self.lose(numbers);
            }
        } else if self.axis_stale
            && numbers.len() == 3
            && AXIS_SLACK < direction::angle(&self.program.axis(), &UPRIGHT)
        {
            self.stale_axis(span);
            return self.lose(numbers);
        } else if numbers.len() != 3 {
            let message =
                format!("a point has three numbers, or six with a tool axis, not {}", numbers.len());
            self.error("goto-numbers", message, span);
            return self.lose(numbers);
        }
        let Some(point) = self.point(numbers, span) else { return self.lose(&[]) };
        if self.dirty_tool {
            self.meets_tool(span);
        }
        if self.cycle.is_some() && self.hole(point, span) {
            return;
        }
        if self.pending.is_some() && self.met(point, span) {
            return;
        }
        if self.rapid {
            self.rapid = false;
            return self.program.rapid(&point, span);
        }
        let feed = match self.feed {
            Some(Feed::PerMinute(mm)) => mm,
            feed => match self.per_minute(feed, span) {
                Some(mm) => mm,
                None => return,
            },
        };
        self.program.line(&point, feed, line, span);
    }

    /// Meets a point where something waits for one; whether it was of an arc.
    fn met(&mut self, point: [f64; 3], span: Span) -> bool {
        match self.pending.take() {
            Some(Pending::Circle(circle)) => {
                self.circle_meets(circle, point, span);
                return true;
            }
            Some(Pending::Points(points)) => {
                if self.points_meet(points, point, span) {
                    return true;
                }
            }
            Some(Pending::Tangent(..)) => {
                self.error("tangent-alone", "INDIRV stands before a point, not before TLON", span);
            }
            Some(Pending::Refused) => {
                self.rapid = false;
                self.program.position = Some(point);
                return true;
            }
            left => self.pending = left,
        }
        // What an arc before it left behind.
        if let Some(Pending::Left(left)) = self.pending.take() {
            self.left(&left, point, span);
        }
        false
    }

    /// A point was refused: what follows is read as if the tool were there, since one report is enough.
    fn lose(&mut self, numbers: &[f64]) {
        self.close_arc();
        self.pending = None;
        self.rapid = false;
        if let &[x, y, z, ..] = numbers {
            let point = [x, y, z].map(|x| x * self.scale);
            self.program.position = Some(point).filter(|point| point.iter().all(|x| x.is_finite()));
        }
    }

    /// What waits at the end of the file.
    pub(super) fn end_pending(&mut self) {
        self.close_arc();
        match &self.pending {
            Some(Pending::Circle(circle)) => self.break_off(circle.span),
            Some(Pending::Tangent(_, span)) => self.break_off(*span),
            Some(Pending::Points(_) | Pending::Left(_) | Pending::Refused) | None => {}
        }
    }

    /// Takes a tool axis; whether it is a direction.
    pub(super) fn set_axis(&mut self, axis: [f64; 3], span: Span) -> bool {
        self.axis_stale = false;
        if !is_unit(axis) {
            self.error("tool-axis", "the tool axis is no direction", span);
            return false;
        }
        let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
        let axis = axis.map(|x| x / length);
        if axis != self.program.axis() {
            match &self.pending {
                Some(Pending::Circle(_) | Pending::Points(_)) if is_along(&self.program.axis(), axis) => {
                    return true;
                }
                Some(Pending::Circle(_)) => {
                    self.turning_arc(span);
                    self.pending = Some(Pending::Refused);
                    return false;
                }
                Some(Pending::Points(_)) => self.close_arc(),
                Some(Pending::Tangent(..) | Pending::Left(_) | Pending::Refused) | None => {}
            }
            self.program.turn(axis);
        }
        true
    }

    /// `MULTAX[/ON|OFF]`: whether points carry an axis; each point shows it anyway.
    pub(super) fn multax(&mut self, said: &Said<'_>) {
        if !said.is_bare() && (said.arguments().len() != 1 || (!said.has("ON") && !said.has("OFF"))) {
            self.error("arguments", "MULTAX is ON or OFF", said.span);
        }
        self.axis_stale |= said.has("OFF");
    }

    /// Whether a tilt still holds behind MULTAX/OFF or another tool no page says.
    fn stale_axis(&mut self, span: Span) {
        let message =
            "a point without a tool axis, behind MULTAX/OFF or another tool, while the tool is tilted";
        self.axis_stale = false;
        self.push(
            Diagnostic::error("tool-axis-stale", message)
                .at(span, "")
                .hint("TLAXIS/0,0,1 or six numbers before it say where the tool points"),
        );
    }

    /// `TLAXIS/i,j,k`
    pub(super) fn tlaxis(&mut self, said: &Said<'_>) {
        match said.statement.numbers().as_deref() {
            Some(&[i, j, k]) => {
                self.set_axis([i, j, k], said.span);
            }
            _ => self.error("arguments", "TLAXIS takes three numbers", said.span),
        }
    }

    /// `FROM/x,y,z[,i,j,k]`: where the tool is. It moves nothing.
    pub(super) fn from(&mut self, said: &Said<'_>) {
        match said.statement.numbers() {
            Some(numbers) if numbers.len() == 3 || numbers.len() == 6 => {
                if numbers.len() == 6 && !self.set_axis([numbers[3], numbers[4], numbers[5]], said.span) {
                    return;
                }
                let Some(point) = self.point(&numbers, said.span) else { return };
                if self.program.has_moved() {
                    let message = "FROM stands behind the first move; the tool is where the moves left it";
                    self.push(Diagnostic::warning("from-late", message).at(said.span, ""));
                    return;
                }
                self.home = Some(point);
                self.program.position = Some(point);
                let axis = self.program.axis();
                self.program.stand(axis);
            }
            _ => self.error("arguments", "FROM takes three or six numbers", said.span),
        }
    }

    /// `GOHOME[/x,y,z]`, at rapid: to the point, or to that of FROM.
    pub(super) fn gohome(&mut self, said: &Said<'_>) {
        let point = match said.statement.numbers().as_deref() {
            Some([]) => self.home,
            Some(numbers) if numbers.len() == 3 || numbers.len() == 6 => {
                if let Some(&[i, j, k]) = numbers.get(3..)
                    && !self.set_axis([i, j, k], said.span)
                {
                    return;
                }
                self.point(numbers, said.span)
            }
            _ => return self.error("arguments", "GOHOME takes three numbers or none", said.span),
        };
        self.rapid = false;
        self.end_cycle("GOHOME", said.span);
        match point {
            Some(point) => self.program.rapid(&point, said.span),
            None => self.error(
                "home-unknown",
                "GOHOME without a point, and no FROM said where home is",
                said.span,
            ),
        }
    }

    /// `GODLTA/dx,dy,dz | GODLTA/d`, the latter along the tool axis.
    pub(super) fn godlta(&mut self, said: &Said<'_>) {
        if self.cycle.is_some() {
            let message =
                "an increment in a cycle: whether it counts from the hole or from above it no page says";
            return self.refuse("cycle-increment", message, said.span);
        }
        let Some(from) = self.program.position else {
            return self.error("start-unknown", "an increment from a place that is not known", said.span);
        };
        let by = match said.statement.numbers().as_deref() {
            Some(&[d]) => self.program.axis().map(|x| x * d),
            Some(&[x, y, z]) => [x, y, z],
            _ => return self.error("arguments", "GODLTA takes one or three numbers", said.span),
        };
        // `goto` takes units of the file.
        let to: Vec<f64> = (0..3).map(|i| from[i] / self.scale + by[i]).collect();
        self.goto(&to, said.record.line, said.span);
    }
}
