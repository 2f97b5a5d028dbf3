//! Straight moves that were asked as such.

use super::{Cursor, Found};
use crate::decimal::units_to_f64;
use crate::diagnostic::Diagnostics;
use crate::geom::deviation::Bound;
use crate::geom::direction;
use crate::ir::{Decimals, Polyline, Written, WrittenPoints, padded};
use crate::units::{Kind, Position};

impl Cursor<'_> {
    /// The first line of a run starts where that was asked, to a unit of the last decimal: the text does not say it, and the
    /// way from another place is another line.
    pub(super) fn starts_at(&self, asked: &Position, points: &WrittenPoints) -> Result<(), Diagnostics> {
        let axes = self.decimals.program.axes;
        let before = self.before(points);
        for axis in 0..axes.direction().unwrap_or(axes.count()) {
            let known = self.units(axis, asked[axis]).is_some_and(|units| (units - before[axis]).abs() <= 1);
            if !known {
                let (name, at) = (axes.name(axis), self.decimals.position(&before)[axis]);
                let message = format!(
                    "this straight move was asked to start at {name} {}, and {name} is at {at}",
                    asked[axis]
                );
                return Err(self.differs("start-differs", message));
            }
        }
        Ok(())
    }

    /// Straight moves that were asked as such: every point is met exactly, as rounded.
    pub(super) fn lines(&mut self, asked: &Polyline, written: &Written) -> Result<Found, Diagnostics> {
        let Written::Lines(points) = written else {
            return Err(self.differs("step-differs", "here a straight move was asked".to_owned()));
        };
        let (mut worst, mut turned) = (0.0f64, 0.0f64);
        let Decimals { digits, program, .. } = self.decimals;
        let axes = program.axes;
        self.starts_at(&asked.start, points)?;
        let linear: Vec<usize> = (0..axes.count()).filter(|i| axes.kind(*i) == Kind::Linear).collect();
        let places = axes.direction().unwrap_or(asked.stride);
        // No more points were met than there are.
        let mut found = points.units[self.within * points.stride..].chunks_exact(points.stride);
        let (mut from, mut length) = (&asked.start[..asked.stride], 0.0);
        for point in asked.values.chunks_exact(asked.stride) {
            let Some(units) = found.next() else {
                return Err(self.differs("less-than-asked", "a straight move is missing here".to_owned()));
            };
            for (axis, x) in point.iter().enumerate() {
                let read = units.get(axis).copied().unwrap_or_default();
                if self.units(axis, *x) != Some(read) {
                    let name = axes.name(axis);
                    return Err(self.differs("point-differs", format!("{name} was asked to be {x}")));
                }
                if axis < places {
                    worst = worst.max((units_to_f64(read, digits[axis]) - x).abs());
                }
            }
            if let Some(first) = axes.direction() {
                let (read, point) = (self.decimals.position(&padded(units)), padded(point));
                turned = turned.max(direction::between(&read, &point, first));
            }
            length +=
                linear.iter().map(|i| (point[*i] - from[*i]) * (point[*i] - from[*i])).sum::<f64>().sqrt();
            from = point;
            self.within += 1;
        }
        let count = asked.count();
        self.leave(points);
        Ok(Found {
            deviation: Bound { mm: worst, rad: turned },
            path_blocks: count,
            cutting_length: length,
            ..Found::new()
        })
    }
}
