//! Points of any other curve: as few as hold the tolerance when straight lines join them, with the proof that they do.

use crate::geom::bezier::Bezier;
use crate::geom::chain::Chain;
use crate::geom::deviation::{Metric, OrderError};
use crate::geom::fit::FitError;
use crate::geom::follow::follow;
use crate::geom::geometric;
use crate::ir::{Curve, Cut, Intent, Role, Step};
use crate::pass::arcs;
use crate::units::{Axes, Kind, MAX_AXES, Position};
use std::fmt::Write as _;

/// The points of an intent's curves.
#[derive(Clone, Debug, PartialEq)]
pub struct Points {
    /// The coordinates.
    pub axes: Axes,
    /// Each point with the number of its curve, from 1; a curve's first point is its start.
    pub points: Vec<(usize, Position)>,
    /// An upper bound of how far lines between them are from the curves, mm.
    pub deviation: f64,
}

/// Why there are no points.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PointsError {
    /// The tolerance is out of reach.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// The lines are not in the order of the curve.
    #[error(transparent)]
    Order(#[from] OrderError),
    /// Nothing but the control knows the curve.
    #[error("there is no curve whose points could be told")]
    Nothing,
}

impl Points {
    /// Points of every curve that shapes the work, within `tolerance` mm.
    ///
    /// # Errors
    /// See [`PointsError`].
    pub fn new(intent: &Intent, tolerance: f64) -> Result<Points, PointsError> {
        let axes = intent.program.axes;
        let kinds: Vec<Kind> = axes.as_slice().iter().map(|(_, kind)| *kind).collect();
        let metric = Metric::new(&kinds, intent.radius());
        let (mut points, mut deviation, mut number) = (Vec::new(), 0.0f64, 0);
        for located in &intent.program.steps {
            let Step::Cut(Cut { role: Role::Path, curve, .. }) = &located.step else { continue };
            if let Curve::Arc(arc) = curve {
                number += 1;
                // The bound counts what is across and what is along, some 1.6 times the sagitta.
                let line = arcs::lines(arc, intent.program.axes.count(), 0.6 * tolerance);
                points.extend(std::iter::once(line.start).chain(line.points()).map(|p| (number, p)));
                let turned = arc.sweep().abs() / line.count() as f64;
                deviation = deviation.max(arcs::sagitta(arc.radius(), turned));
                continue;
            }
            let scaled: Vec<Bezier> = curve.pieces().iter().map(|piece| metric.scaled(piece)).collect();
            let Some(chain) = Chain::new(&scaled) else { continue };
            number += 1;
            // What pieces stand for is this far from them.
            let apart = match curve {
                Curve::Formula(described) => metric.distance(&[0.0; MAX_AXES], &described.bound).mm,
                Curve::Lines(_)
                | Curve::Arc(_)
                | Curve::Polynomial(_)
                | Curve::Nurbs(_)
                | Curve::Through(..)
                | Curve::Logarithmic(_) => 0.0,
            };
            let mut from = scaled[0].start();
            let mut lines = Vec::new();
            let place = |point: &Position| metric.unscaled(&Bezier::line(*point, *point)).start();
            points.push((number, place(&from)));
            for to in geometric::chords(&chain, tolerance)? {
                lines.push(Bezier::line(from, to));
                points.push((number, place(&to)));
                from = to;
            }
            deviation = deviation.max(apart + follow(&lines, &scaled, tolerance)?.distance);
        }
        if points.is_empty() {
            return Err(PointsError::Nothing);
        }
        Ok(Points { axes, points, deviation: deviation + intent.input_error })
    }

    /// `n`, `curve` and the axes, rotary ones with their unit.
    fn names(&self) -> Vec<String> {
        let axis = |(name, kind): &(crate::units::Axis, Kind)| match kind {
            Kind::Linear | Kind::Direction => name.to_string(),
            Kind::Rotary => format!("{name}_deg"),
        };
        ["n", "curve"].iter().map(ToString::to_string).chain(self.axes.as_slice().iter().map(axis)).collect()
    }

    /// Comma-separated, in full precision.
    pub fn to_csv(&self) -> String {
        let mut text = self.names().join(",") + "\n";
        let mut buffer = zmij::Buffer::new();
        for (n, (curve, point)) in self.points.iter().enumerate() {
            let _ = write!(text, "{n},{curve}");
            for value in &point[..self.axes.count()] {
                text.push(',');
                // Adding zero takes the sign off a negative zero.
                text.push_str(buffer.format(value + 0.0));
            }
            text.push('\n');
        }
        text
    }

    /// JSON, in full precision.
    pub fn to_json(&self) -> String {
        let names = self.names();
        let row = |(n, (curve, point)): (usize, &(usize, Position))| {
            let mut row = serde_json::Map::new();
            row.insert("n".to_owned(), n.into());
            row.insert("curve".to_owned(), (*curve).into());
            for (name, value) in names[2..].iter().zip(point) {
                row.insert(name.clone(), (value + 0.0).into());
            }
            serde_json::Value::Object(row)
        };
        let points: Vec<serde_json::Value> = self.points.iter().enumerate().map(row).collect();
        let whole = serde_json::json!({ "points": points, "deviation": self.deviation });
        serde_json::to_string_pretty(&whole).unwrap_or_default() + "\n"
    }

    /// Four decimals, for people.
    pub fn to_text(&self) -> String {
        let mut text = String::from("   Nos.  curve");
        for name in &self.names()[2..] {
            let _ = write!(text, " {name:>11}");
        }
        text.push('\n');
        for (n, (curve, point)) in self.points.iter().enumerate() {
            let _ = write!(text, "{n:>7} {curve:>6}");
            for value in &point[..self.axes.count()] {
                // What rounds to zero at four decimals has no sign.
                let shown = if value.abs() < 0.000_05 { 0.0 } else { *value };
                let _ = write!(text, " {shown:>11.4}");
            }
            text.push('\n');
        }
        text
    }

    /// How many, and how near.
    pub fn summary(&self) -> String {
        let curves = self.points.last().map_or(0, |(curve, _)| *curve);
        let lines = self.points.len() - curves;
        format!("{lines} lines on {curves} curves, nowhere farther than {:.3e} mm, proved\n", self.deviation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::front::job;
    use crate::source::{Source, SourceId, Sources};

    #[test]
    fn a_circle_has_the_points_that_its_sagitta_asks_for() {
        let text = "[[curve]]\nkind = \"expression\"\nu = [0, \"2*pi\"]\nX = \"10*cos(u)\"\nY = \"10*sin(u)\"\n\
                    [process]\nfeed = 100\nretract = { axis = \"Z\", to = 50 }\n";
        let intent = job::parse_program(&Sources::new(Source::new("t", text)), SourceId::INPUT)
            .unwrap_or_else(|e| panic!("{e:?}"));
        let points = Points::new(&intent, 0.001).unwrap();
        // R(1 − cos(π/n)) ≤ 0.001 for n ≥ π √(R/0.002) = 222.1; the search aims a little below the tolerance.
        assert!((223..=232).contains(&(points.points.len() - 1)), "{}", points.points.len());
        assert!(points.deviation <= 0.001 && 0.0009 < points.deviation, "{}", points.deviation);
        assert!(points.to_csv().starts_with("n,curve,X,Y,Z\n0,1,10.0,0.0,"));
    }
}
