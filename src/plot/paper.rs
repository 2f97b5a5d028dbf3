//! Figures 3 to 5 of *Design on Odd-even Steps Third Order Approach Interpolation Algorithm for Logarithmic Curve*: the
//! interpolated points beside the theoretical curve, whole, and its start and end magnified; and how far they are from it.

use super::{Figure, Style};
use crate::geom::logcurve::LogCurve;
use crate::points::{Row, Table};

/// How many points the magnified figures show.
const SHOWN: usize = 7;

/// Points of the theoretical curve in a figure.
const SAMPLES: u32 = 400;

fn figure(id: &'static str, title: &str, curve: &LogCurve, rows: &[Row]) -> Option<Figure> {
    let (first, last) = (rows.first()?, rows.last()?);
    let mut figure = Figure::new(id, title, ["X, mm", "A, radians"]);
    let at = |i: u32| first.x + (last.x - first.x) * f64::from(i) / f64::from(SAMPLES);
    figure.add(
        "theoretical curve",
        Style::Line,
        (0..=SAMPLES).map(|i| [at(i), curve.angle(at(i))]).collect(),
    );
    figure.add("interpolated points", Style::Dots, rows.iter().map(|row| [row.x, row.a_rad]).collect());
    Some(figure)
}

/// The figures of a flute's points.
pub fn figures(table: &Table, curve: &LogCurve) -> Vec<Figure> {
    let rows = &table.points;
    let shown = SHOWN.min(rows.len());
    let mut figures: Vec<Figure> = [
        figure("trace", "Figure 3: interpolated points and the theoretical curve", curve, rows),
        figure("trace-start", "Figure 4: its start, magnified", curve, &rows[..shown]),
        figure("trace-end", "Figure 5: its end, magnified", curve, &rows[rows.len() - shown..]),
    ]
    .into_iter()
    .flatten()
    .collect();
    let mut errors =
        Figure::new("steps", "Error of the points: theoretical A less interpolated A", ["X, mm", "radians"]);
    let every = |odd: usize| {
        rows.iter().filter(|row| row.n % 2 == odd).map(|row| [row.x, row.er_pa_rad]).collect::<Vec<_>>()
    };
    if table.dl.is_some() {
        errors.add("odd points", Style::Dots, every(1));
        errors.add("even points", Style::Dots, every(0));
    } else {
        errors.add("points", Style::Dots, rows.iter().map(|row| [row.x, row.er_pa_rad]).collect());
    }
    if !errors.is_empty() {
        figures.push(errors);
    }
    figures
}
