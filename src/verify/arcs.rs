//! Arcs against what was written: by the implicit form, as [`geom::arc`](crate::geom::arc) derives it; and switches.

use super::{Cursor, Found};
use crate::decimal::{Decimal, units_to_f64};
use crate::diagnostic::Diagnostics;
use crate::geom::arc::Arc;
use crate::geom::deviation::Bound;
use crate::ir::{Auxiliary, Decimals, Step, Written, WrittenArc, WrittenPoints};
use crate::pass::arcs::sagitta;
use crate::units::{MAX_AXES, Position};

/// The centre of an arc in decimals, mm.
fn center(decimals: &Decimals, arc: &WrittenArc) -> [f64; 2] {
    let [u, v, _] = arc.plane.axes();
    [units_to_f64(arc.center[0], decimals.digits[u]), units_to_f64(arc.center[1], decimals.digits[v])]
}

/// The arc that decimals mean; none where it has no radius.
pub fn to_arc(decimals: &Decimals, arc: &WrittenArc) -> Option<Arc> {
    let (start, end) = (decimals.position(&arc.start), decimals.position(&arc.end));
    Arc::new(arc.plane, arc.sense, start, end, center(decimals, arc)).ok()
}

fn distance(p: &Position, q: &Position) -> f64 {
    p.iter().zip(q).map(|(p, q)| (p - q) * (p - q)).sum::<f64>().sqrt()
}

impl Cursor<'_> {
    /// An arc, or the lines that stand for it.
    pub(super) fn arc(&mut self, asked: &Arc, written: &Written) -> Result<Found, Diagnostics> {
        match written {
            Written::Arc(arc) => {
                let (start, end) = (self.decimals.position(&arc.start), self.decimals.position(&arc.end));
                let mm = asked.deviation(arc.plane, arc.sense, start, end, center(self.decimals, arc));
                if mm == f64::INFINITY {
                    return Err(self.differs("arc-differs", "this arc has another plane or sense".to_owned()));
                }
                self.advance();
                Ok(found(asked, mm, 1))
            }
            Written::Lines(points) => self.arc_of_lines(asked, points),
            Written::Polynomial(_) | Written::Nurbs(_) | Written::Through(..) => {
                Err(self.differs("step-differs", "here an arc was asked".to_owned()))
            }
        }
    }

    /// Lines that stand for an arc, one after the other up to its end. Each ends where it should at its share of the
    /// arc, but for what is found; between, a chord leaves the arc by its sagitta.
    fn arc_of_lines(&mut self, asked: &Arc, points: &WrittenPoints) -> Result<Found, Diagnostics> {
        let end = asked.end();
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
        let worst = all().take(count).enumerate().fold(0.0f64, |worst, (i, p)| {
            worst.max(distance(&p, &asked.eval((i + 1) as f64 / count as f64)))
        });
        let mm = worst + sagitta(asked.radius(), asked.sweep().abs() / count as f64);
        self.within += count;
        self.leave(points);
        Ok(found(asked, mm, count))
    }

    /// What is wrong where an arc stands and another curve was asked.
    pub(super) fn arc_here(&self) -> Diagnostics {
        self.differs("step-differs", "here is an arc, where another path was asked".to_owned())
    }

    /// Meets a switch, or a dwell in seconds.
    pub(super) fn auxiliary(&mut self, asked: &Auxiliary<f64>, digits: u8) -> Result<(), Diagnostics> {
        let what = match asked {
            Auxiliary::CoolantStop => "the end of the coolant".to_owned(),
            Auxiliary::SpindleStop => "the spindle's stop".to_owned(),
            Auxiliary::Stop => "a stop of the program".to_owned(),
            Auxiliary::OptionalStop => "an optional stop".to_owned(),
            Auxiliary::Dwell(seconds) => format!("a dwell of {seconds} s"),
        };
        let rounded = asked.try_map(|seconds| Decimal::round(seconds, digits));
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
