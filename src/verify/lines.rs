//! Straight moves that were asked as such.

use super::{Cursor, Found};
use crate::diagnostic::Diagnostics;
use crate::geom::deviation::Bound;
use crate::geom::direction;
use crate::ir::{Polyline, Written};
use crate::units::Kind;

impl Cursor<'_> {
    /// Straight moves that were asked as such: every point is met exactly, as rounded.
    pub(super) fn lines(&mut self, asked: &Polyline, written: &Written) -> Result<Found, Diagnostics> {
        let Written::Lines(points) = written else {
            return Err(self.differs("step-differs", "here a straight move was asked".to_owned()));
        };
        let (mut worst, mut turned) = (0.0f64, 0.0f64);
        let axes = self.decimals.program.axes;
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
