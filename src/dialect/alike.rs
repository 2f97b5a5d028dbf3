//! Whether two bodies are the same but for where their axes count from, so that one text serves both.

use crate::decimal::Decimal;
use crate::ir::{ArcBy, Circle, Located, Shift, Step, Units, Written, WrittenPoints};
use crate::units::MAX_AXES;

type Read = Step<Decimal, Written>;

/// A body, and where its axes count from.
type Body<'p> = (&'p [Located<Decimal, Written>], &'p [Shift<Decimal>]);

/// Whether two bodies are alike.
pub(super) fn bodies(a: Body, b: Body, digits: [u8; MAX_AXES]) -> bool {
    let mut by = [0i64; MAX_AXES];
    for (shifts, sign) in [(a.1, -1), (b.1, 1)] {
        for shift in shifts {
            by[shift.axis] += sign * shift.to.units(digits[shift.axis]).unwrap_or_default();
        }
    }
    let by = By { by, digits };
    a.0.len() == b.0.len() && a.0.iter().zip(b.0).all(|(a, b)| by.steps(&a.step, &b.step))
}

/// How far the second of two things is moved from the first.
struct By {
    by: Units,
    digits: [u8; MAX_AXES],
}

impl By {
    fn steps(&self, a: &Read, b: &Read) -> bool {
        match (a, b) {
            (Step::Rapid(a), Step::Rapid(b)) => {
                let units = |axis: usize, to: Decimal| to.units(self.digits[axis]).unwrap_or_default();
                a.len() == b.len()
                    && a.iter()
                        .zip(b)
                        .all(|((i, a), (j, b))| i == j && units(*i, *a) + self.by[*i] == units(*j, *b))
            }
            (Step::Cut(a), Step::Cut(b)) => {
                (a.feed, a.role) == (b.feed, b.role) && self.curves(&a.curve, &b.curve)
            }
            (
                Step::Comment(_)
                | Step::Tool(_)
                | Step::Spindle(_)
                | Step::Coolant
                | Step::Home(_)
                | Step::Shift(_)
                | Step::Auxiliary(_)
                | Step::Rapid(_)
                | Step::Cut(_),
                _,
            ) => a == b,
        }
    }

    fn curves(&self, a: &Written, b: &Written) -> bool {
        match (a, b) {
            (Written::Lines(a), Written::Lines(b)) => self.points(a, b),
            (Written::Through(a_kind, a), Written::Through(b_kind, b)) => {
                a_kind == b_kind && self.points(a, b)
            }
            (Written::Polynomial(a), Written::Polynomial(b)) => {
                self.units(&a.start, &b.start)
                    && a.blocks.len() == b.blocks.len()
                    && a.blocks.iter().zip(&b.blocks).all(|(a, b)| {
                        (a.pl, a.coefficients) == (b.pl, b.coefficients) && self.units(&a.end, &b.end)
                    })
            }
            (Written::Nurbs(a), Written::Nurbs(b)) => {
                (a.degree, &a.knots, a.knot_digits, &a.weights)
                    == (b.degree, &b.knots, b.knot_digits, &b.weights)
                    && a.points.len() == b.points.len()
                    && a.points.iter().zip(&b.points).all(|(a, b)| self.units(a, b))
            }
            (Written::Arc(a), Written::Arc(b)) => {
                let circle = |a: Circle, b: Circle| {
                    let [u, v, _] = a.plane.axes();
                    (a.plane, a.sense) == (b.plane, b.sense)
                        && [a.center[0] + self.by[u], a.center[1] + self.by[v]] == b.center
                };
                self.units(&a.start, &b.start)
                    && self.units(&a.end, &b.end)
                    && match (a.by, b.by) {
                        (ArcBy::Center(a, turns), ArcBy::Center(b, other)) => circle(a, b) && turns == other,
                        (ArcBy::Way(a), ArcBy::Way(b)) => self.units(&a, &b),
                        (ArcBy::Turn(a, by), ArcBy::Turn(b, other)) => circle(a, b) && by == other,
                        (ArcBy::Center(..) | ArcBy::Way(_) | ArcBy::Turn(..), _) => false,
                    }
            }
            (
                Written::Lines(_)
                | Written::Arc(_)
                | Written::Through(..)
                | Written::Polynomial(_)
                | Written::Nurbs(_),
                _,
            ) => false,
        }
    }

    fn points(&self, a: &WrittenPoints, b: &WrittenPoints) -> bool {
        a.stride == b.stride
            && self.units(&a.start, &b.start)
            && a.count() == b.count()
            && a.points().zip(b.points()).all(|(a, b)| self.units(&a, &b))
    }

    fn units(&self, a: &Units, b: &Units) -> bool {
        a.iter().zip(b).zip(&self.by).all(|((a, b), by)| a + by == *b)
    }
}
