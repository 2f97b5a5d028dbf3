//! Straight moves that were asked as such.

use super::{Cursor, Found};
use crate::diagnostic::Diagnostics;
use crate::geom::deviation::Bound;
use crate::geom::direction;
use crate::ir::{Polyline, Written, WrittenPoints};
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
        let axes = self.decimals.program.axes;
        self.starts_at(&asked.start, points)?;
        let linear: Vec<usize> = (0..axes.count()).filter(|i| axes.kind(*i) == Kind::Linear).collect();
        let (mut from, mut length) = (asked.start, 0.0);
        for point in asked.points() {
            let Some(units) = self.next_point(points) else {
                return Err(self.differs("less-than-asked", "a straight move is missing here".to_owned()));
            };
            for axis in 0..asked.stride {
                if self.units(axis, point[axis]) != Some(units[axis]) {
                    let name = self.decimals.program.axes.name(axis);
                    self.within -= 1;
                    return Err(
                        self.differs("point-differs", format!("{name} was asked to be {}", point[axis]))
                    );
                }
            }
            let read = self.decimals.position(&units);
            let places = axes.direction().unwrap_or(asked.stride);
            worst = (0..places).fold(worst, |worst, i| worst.max((read[i] - point[i]).abs()));
            if let Some(first) = axes.direction() {
                turned = turned.max(direction::between(&read, &point, first));
            }
            length +=
                linear.iter().map(|i| (point[*i] - from[*i]) * (point[*i] - from[*i])).sum::<f64>().sqrt();
            from = point;
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
