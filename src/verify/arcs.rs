//! Arcs against what was written: by the implicit form, as [`geom::arc`](crate::geom::arc) derives it; and switches.

use super::{Cursor, Found};
use crate::decimal::{Decimal, units_to_f64};
use crate::diagnostic::Diagnostics;
use crate::geom::arc::Arc;
use crate::geom::deviation::Bound;
use crate::geom::direction;
use crate::ir::{ArcBy, Auxiliary, Decimals, Step, Written, WrittenArc, WrittenPoints, sweep};
use crate::machine::Digits;
use crate::pass::arcs::sagitta;
use crate::units::{MAX_AXES, Position};

/// The arc that decimals mean; none where it has no radius.
pub fn to_arc(decimals: &Decimals, arc: &WrittenArc) -> Option<Arc> {
    let (start, end) = (decimals.position(&arc.start), decimals.position(&arc.end));
    Arc::new(arc.plane, arc.sense, start, end, arc.center(&decimals.digits)?).ok()
}

fn distance(p: &Position, q: &Position) -> f64 {
    p.iter().zip(q).map(|(p, q)| (p - q) * (p - q)).sum::<f64>().sqrt()
}

impl Cursor<'_> {
    /// An arc, or the lines that stand for it.
    pub(super) fn arc(&mut self, asked: &Arc, written: &Written) -> Result<Found, Diagnostics> {
        match written {
            Written::Arc(WrittenArc { by: ArcBy::Way(_), .. }) if asked.is_full() => {
                let feed = self.written()?.feed;
                let mut worst = 0.0f64;
                for half in asked.halves() {
                    let cut = self.written()?;
                    let Written::Arc(arc) = &cut.curve else {
                        return Err(self.differs("step-differs", "here half a circle was asked".to_owned()));
                    };
                    if cut.feed != feed {
                        return Err(self.differs("feed-differs", "the feed changes in a circle".to_owned()));
                    }
                    worst = worst.max(self.arc_block(&half, arc)?);
                }
                Ok(found(asked, worst, 2))
            }
            Written::Arc(arc) => {
                let mm = self.arc_block(asked, arc)?;
                Ok(found(asked, mm, 1))
            }
            Written::Lines(points) => self.arc_of_lines(asked, points),
            Written::Polynomial(_) | Written::Nurbs(_) | Written::Through(..) => {
                Err(self.differs("step-differs", "here an arc was asked".to_owned()))
            }
        }
    }

    /// One block against the arc that it is to be, mm.
    fn arc_block(&mut self, asked: &Arc, arc: &WrittenArc) -> Result<f64, Diagnostics> {
        let (start, end) = (self.decimals.position(&arc.start), self.decimals.position(&arc.end));
        let mm = match (arc.center(&self.decimals.digits), arc.by) {
            (None, _) => f64::INFINITY,
            (Some(center), ArcBy::Center(_) | ArcBy::Way(_)) => {
                asked.deviation(arc.plane, arc.sense, start, end, center)
            }
            (Some(center), ArcBy::Turn(_, degrees)) => {
                let sweep = sweep(arc.sense, degrees);
                let (mm, end) = asked.deviation_turned(arc.plane, start, end, center, sweep);
                self.gap = distance(&end, &asked.end());
                mm
            }
        };
        if mm == f64::INFINITY {
            return Err(self.differs("arc-differs", "this arc has another plane or sense".to_owned()));
        }
        self.advance();
        Ok(mm)
    }

    /// Lines that stand for an arc, one after the other up to its end. Each ends where it should at its share of the
    /// arc, but for what is found; between, a chord leaves the arc by its sagitta.
    fn arc_of_lines(&mut self, asked: &Arc, points: &WrittenPoints) -> Result<Found, Diagnostics> {
        let end = asked.end();
        if self.gap == 0.0 {
            self.starts_at(&asked.start(), points)?;
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
        // A whole turn ends where it starts, so that its first lines do not count.
        let least = if asked.is_full() { 2 } else { 0 };
        let Some(last) = all().enumerate().skip(least).find(|(_, p)| near(p)).map(|(last, _)| last) else {
            return Err(self.differs("less-than-asked", "the end of an arc is missing here".to_owned()));
        };
        let count = last + 1;
        let turning = self.decimals.program.axes.direction();
        let (mut worst, mut turned) = (0.0f64, 0.0f64);
        for (i, mut p) in all().take(count).enumerate() {
            let on = asked.eval((i + 1) as f64 / count as f64);
            if let Some(first) = turning {
                turned = turned.max(direction::between(&p, &on, first));
                p[first..].copy_from_slice(&on[first..]);
            }
            worst = worst.max(distance(&p, &on));
        }
        let mm = worst + sagitta(asked.radius(), asked.sweep().abs() / count as f64);
        self.within += count;
        self.leave(points);
        let found = found(asked, mm, count);
        Ok(Found { deviation: Bound { mm, rad: turned }, ..found })
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

fn found(asked: &Arc, mm: f64, blocks: usize) -> Found {
    Found {
        deviation: Bound { mm, rad: 0.0 },
        path_blocks: blocks,
        cutting_length: asked.length(),
        ..Found::new()
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
        Auxiliary::Plane([first, second, third]) => {
            format!("a plane tilted by {first}, {second} and {third} degrees")
        }
        Auxiliary::PlaneEnd => "the end of the tilted plane".to_owned(),
    }
}
