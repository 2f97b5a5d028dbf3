//! Arcs against what was written: by the implicit form, as [`geom::arc`](crate::geom::arc) derives it; and switches.

use super::{Cursor, Found};
use crate::decimal::{Decimal, units_to_f64};
use crate::diagnostic::Diagnostics;
use crate::geom::arc::Arc;
use crate::geom::deviation::Bound;
use crate::geom::direction;
use crate::geom::elementary::atan2;
use crate::ir::{ArcBy, Auxiliary, Decimals, Step, Written, WrittenArc, WrittenPoints, sweep};
use crate::machine::Digits;
use crate::pass::arcs::sagitta;
use crate::units::{MAX_AXES, Position};

/// How much less than an arc may be turned where lines reach its end, radians: places in decimals say little about the angles
/// of a small one.
const NEARLY: f64 = 1.0;

/// The arc that decimals mean; none where it has no radius.
pub fn to_arc(decimals: &Decimals, arc: &WrittenArc) -> Option<Arc> {
    arc.arc(&decimals.digits)
}

/// The distance of two places of which each coordinate is in mm.
fn distance(p: &Position, q: &Position) -> f64 {
    p.iter().zip(q).map(|(p, q)| (p - q) * (p - q)).sum::<f64>().sqrt()
}

/// A block, or a run of lines, against the part of an arc that it is to be.
struct Part {
    bound: Bound,
    /// Which share of the whole arc is met behind it.
    to: f64,
    blocks: usize,
    /// How long what was written is, mm, or whether it has a length at all, and how far it turns, radians.
    length: f64,
    turned: f64,
}

impl Cursor<'_> {
    /// An arc: the blocks that it was cut into, each an arc or lines that stand for one. How it was cut the text says: each
    /// block is held against the part that turns as far, so that any cut is as good.
    pub(super) fn arc(&mut self, asked: &Arc, tolerance: f64) -> Result<Found, Diagnostics> {
        let feed = self.written()?.feed;
        let (mut bound, mut blocks, mut from) = (Bound::ZERO, 0, 0.0);
        let (mut length, mut turned) = (0.0, 0.0);
        while from < 1.0 {
            let cut = match self.step().and_then(|located| located.step.cut()) {
                Some(cut) => cut,
                None if 0.0 < from => return Err(self.arc_unfinished()),
                None => self.written()?,
            };
            if cut.feed != feed {
                return Err(self.differs("feed-differs", "the feed changes in an arc".to_owned()));
            }
            // The block before ends that far from where this one starts; a turn takes it along.
            let gap = std::mem::take(&mut self.gap);
            let mut part = match &cut.curve {
                Written::Arc(arc) => self.arc_block(asked, from, arc, tolerance)?,
                Written::Lines(points) => self.arc_of_lines(asked, from, points, tolerance)?,
                Written::Polynomial(_) | Written::Nurbs(_) | Written::Through(..) => {
                    return Err(self.differs("step-differs", "here an arc was asked".to_owned()));
                }
            };
            part.bound.mm += gap;
            if self.gap != 0.0 {
                self.gap += gap;
            }
            bound = bound.max(part.bound);
            blocks += part.blocks;
            (length, turned) = (length + part.length, turned + part.turned);
            from = part.to;
            if !(bound.mm <= tolerance) {
                // That is told of the arc, not that another block is missing.
                break;
            }
        }
        if bound.mm <= tolerance {
            self.arc_has_length(asked, length, turned)?;
        }
        Ok(Found { deviation: bound, path_blocks: blocks, cutting_length: asked.length(), ..Found::new() })
    }

    fn arc_unfinished(&self) -> Diagnostics {
        self.differs("less-than-asked", "the end of an arc is missing here".to_owned())
    }

    /// Where a block that turns by `sweep` radians ends, as a share of the arc; at its end where less than the tolerance
    /// is left, or where it goes on behind it.
    fn share(asked: &Arc, from: f64, sweep: f64, tolerance: f64) -> f64 {
        let to = from + sweep.abs() / asked.sweep().abs();
        if (1.0 - to) * asked.length() <= tolerance { 1.0 } else { to }
    }

    /// One block against its part of the arc.
    fn arc_block(
        &mut self,
        asked: &Arc,
        from: f64,
        arc: &WrittenArc,
        tolerance: f64,
    ) -> Result<Part, Diagnostics> {
        let digits = &self.decimals.digits;
        let (mut start, mut end) = (self.decimals.position(&arc.start), self.decimals.position(&arc.end));
        let differs =
            |cursor: &Self| cursor.differs("arc-differs", "this arc has another plane or sense".to_owned());
        let Some(meant) = to_arc(self.decimals, arc) else { return Err(differs(self)) };
        let to = Self::share(asked, from, meant.sweep(), tolerance);
        let part = asked.part(from, to);
        let mut rad = self.rotary_apart(&start, &part.start()).max(self.rotary_apart(&end, &part.end()));
        // Rotary axes go along as mm, as they count; the direction of the tool is no place.
        let in_mm = |p: &Position| self.in_mm(p);
        let part = part.mapped_along(in_mm);
        (start, end) = (in_mm(&start), in_mm(&end));
        let directed = self.decimals.program.axes.direction();
        if let Some(first) = directed {
            for (p, on) in [(&mut start, part.start()), (&mut end, part.end())] {
                rad = rad.max(direction::between(p, &on, first));
                p[first..].copy_from_slice(&on[first..]);
            }
        }
        let mm = match arc.by {
            ArcBy::Center(circle, turns) => {
                part.deviation((circle.plane, circle.sense), start, end, circle.place(digits), turns)
            }
            ArcBy::Way(_) => {
                // `start` and `end` are those of the part, but for their places.
                let along = |p: &Position| {
                    let mut place = in_mm(p);
                    if let Some(first) = directed {
                        place[first..].copy_from_slice(&start[first..]);
                    }
                    place
                };
                part.apart(&meant.mapped_along(along))
            }
            ArcBy::Turn(circle, degrees) => {
                let sweep = sweep(circle.sense, degrees);
                let (mm, end) = part.deviation_turned(circle.plane, start, end, circle.place(digits), sweep);
                self.gap = distance(&end, &part.end());
                mm
            }
        };
        if mm == f64::INFINITY {
            return Err(differs(self));
        }
        self.advance();
        Ok(Part {
            bound: Bound { mm, rad },
            to,
            blocks: 1,
            length: meant.length(),
            turned: meant.sweep().abs(),
        })
    }

    /// Lines that stand for an arc, one after the other up to its end, or to that of their run. Each ends where it should at
    /// its share of the arc, but for what is found; between, a chord leaves the arc by its sagitta.
    fn arc_of_lines(
        &mut self,
        asked: &Arc,
        from: f64,
        points: &WrittenPoints,
        tolerance: f64,
    ) -> Result<Part, Diagnostics> {
        let rest = asked.part(from, 1.0);
        let end = rest.end();
        let (mut worst, mut rad);
        if from == 0.0 {
            Bound { mm: worst, rad } = self.starts_at(&rest.start(), points)?;
        } else {
            let before = self.decimals.position(&self.before(points));
            (worst, rad) = (self.apart(&before, &rest.start()), self.rotary_apart(&before, &rest.start()));
        }
        // The lines may run on into others of the same feed, so that the end of the arc is looked for.
        let slack =
            0.5 * (0..3).map(|i| units_to_f64(1, self.decimals.digits[i])).fold(0.0, f64::max) * 1.0001;
        let near = |p: &Position| (0..3).all(|i| (p[i] - end[i]).abs() <= slack);
        let all = || {
            let rest = points.units[self.within * points.stride..].chunks_exact(points.stride);
            rest.map(|chunk| {
                let mut units = [0; MAX_AXES];
                units[..chunk.len()].copy_from_slice(chunk);
                self.decimals.position(&units)
            })
        };
        // It may pass its end before it gets there: what was turned about the axis tells.
        let about = |p: &Position| {
            let [u, v, _] = rest.frame().local([p[0], p[1], p[2]]);
            [u - rest.center()[0], v - rest.center()[1]]
        };
        let least = rest.sweep().abs() - NEARLY;
        let (mut turned, mut before, mut count, mut met) = (0.0, about(&rest.start()), 0, false);
        for p in all() {
            let at = about(&p);
            turned += rest.sweep().signum()
                * atan2(before[0] * at[1] - before[1] * at[0], before[0] * at[0] + before[1] * at[1]);
            before = at;
            count += 1;
            met = near(&p) && least <= turned;
            if met {
                break;
            }
        }
        let to = match turned {
            _ if met => 1.0,
            // The run ends before the arc does: another block goes on.
            turned if 0.0 < turned => Self::share(asked, from, turned, tolerance),
            _ => return Err(self.arc_unfinished()),
        };
        let part = asked.part(from, to);
        let directed = self.decimals.program.axes.direction();
        let (mut length, mut last) = (0.0, self.decimals.position(&self.before(points)));
        for (i, p) in all().take(count).enumerate() {
            length += self.apart(&p, &last);
            last = p;
            let on = part.eval((i + 1) as f64 / count as f64);
            if let Some(first) = directed {
                rad = rad.max(direction::between(&p, &on, first));
            }
            worst = worst.max(self.apart(&p, &on));
            rad = rad.max(self.rotary_apart(&p, &on));
        }
        let mm = worst + sagitta(part.radius(), part.sweep().abs() / count as f64);
        self.within += count;
        self.leave(points);
        Ok(Part { bound: Bound { mm, rad }, to, blocks: count, length, turned })
    }

    /// What is wrong where an arc stands and another curve was asked.
    pub(super) fn arc_here(&self) -> Diagnostics {
        self.differs("step-differs", "here is an arc, where another path was asked".to_owned())
    }

    /// Meets a switch, or a dwell in seconds.
    pub(super) fn auxiliary(&mut self, asked: &Auxiliary<f64>, digits: Digits) -> Result<(), Diagnostics> {
        let what = spelled_auxiliary(asked);
        let rounded = asked
            .try_map(|seconds| Decimal::round(seconds, digits.feed), |x| Decimal::round(x, digits.rotary));
        self.meet(&what, |step| matches!(step, Step::Auxiliary(read) if Some(*read) == rounded))
    }
}

/// A switch or a dwell in words.
pub fn spelled_auxiliary(auxiliary: &Auxiliary<f64>) -> String {
    match auxiliary {
        Auxiliary::CoolantStop => "the end of the coolant".to_owned(),
        Auxiliary::SpindleStop => "the spindle's stop".to_owned(),
        Auxiliary::Stop => "a stop of the program".to_owned(),
        Auxiliary::OptionalStop => "an optional stop".to_owned(),
        Auxiliary::Dwell(seconds) => format!("a dwell of {seconds} s"),
        Auxiliary::TipControl => "that the tip is led".to_owned(),
        Auxiliary::TipControlEnd => "the end of leading the tip".to_owned(),
        Auxiliary::LengthEnd => "the end of the tool's length".to_owned(),
        Auxiliary::Plane([first, second, third]) => {
            format!("a plane tilted by {first}, {second} and {third} degrees")
        }
        Auxiliary::PlaneEnd => "the end of the tilted plane".to_owned(),
    }
}
