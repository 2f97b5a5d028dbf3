//! The table of interpolated points, as the paper's Table 1.
//!
//! Each row compares a point's A with the theoretical A at the same X, PA = a ln(1 + bX); ErPA = PA − A. In the paper's
//! words, MaxErPAo is the greatest |ErPA| at odd points, MaxErPAe at even points.
//! [`curves`] has the points of any other curve.

pub mod curves;

use crate::geom::logcurve::LogCurve;
use crate::geom::oddeven::StepError;
use crate::ir::{Logarithmic, Method};
use crate::pass::settle;
use crate::units::DEGREES;
use serde::Serialize;
use std::fmt::Write as _;

/// One point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Its number; 0 is the start.
    pub n: usize,
    /// mm.
    #[serde(rename = "X")]
    pub x: f64,
    /// mm.
    #[serde(rename = "Y")]
    pub y: f64,
    /// mm.
    #[serde(rename = "Z")]
    pub z: f64,
    /// Interpolated A, radians.
    #[serde(rename = "A_rad")]
    pub a_rad: f64,
    /// Theoretical A at this X, radians.
    #[serde(rename = "PA_rad")]
    pub pa_rad: f64,
    /// PA − A, radians.
    #[serde(rename = "ErPA_rad")]
    pub er_pa_rad: f64,
    /// Interpolated A with the flute's index, degrees.
    #[serde(rename = "A_deg")]
    pub a_deg: f64,
}

/// The points of a flute.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Table {
    /// The points, the start first.
    pub points: Vec<Row>,
    /// How many there are after the start.
    pub count: usize,
    /// Δl, where odd-even steps were made.
    pub dl: Option<f64>,
    /// The greatest |ErPA|, radians.
    #[serde(rename = "MaxErPA")]
    pub max: f64,
    /// The same at odd points.
    #[serde(rename = "MaxErPAo")]
    pub max_odd: f64,
    /// The same at even points.
    #[serde(rename = "MaxErPAe")]
    pub max_even: f64,
}

/// Why there is no table.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum TableError {
    /// The steps cannot be made.
    #[error(transparent)]
    Steps(#[from] StepError),
    /// The tolerance is out of reach.
    #[error(transparent)]
    Fit(#[from] crate::geom::fit::FitError),
}

impl Table {
    /// The points of a flute: odd-even steps, or with the direct method points of the curve whose chords hold the
    /// tolerance.
    ///
    /// # Errors
    /// The tolerance makes too many points.
    pub fn new(flute: &Logarithmic, tolerance: f64) -> Result<Table, TableError> {
        let mut flute = flute.clone();
        let points: Vec<(f64, f64)> = if flute.method == Method::Direct {
            flute.dl = None;
            settle::through_points(&flute, tolerance)?
        } else {
            let dl = flute.dl.map_or_else(|| settle::step(&flute, tolerance), Ok)?;
            flute.dl = Some(dl);
            settle::steps(&flute)?.collect()
        };
        let mut table = Table {
            points: Vec::with_capacity(points.len() + 1),
            count: points.len(),
            dl: flute.dl,
            max: 0.0,
            max_odd: 0.0,
            max_even: 0.0,
        };
        for (n, (x, a)) in std::iter::once((flute.curve.start(), flute.curve.angle(flute.curve.start())))
            .chain(points)
            .enumerate()
        {
            let row = row(&flute.curve, n, x, a);
            let error = row.er_pa_rad.abs();
            table.max = table.max.max(error);
            if n % 2 == 1 {
                table.max_odd = table.max_odd.max(error);
            } else {
                table.max_even = table.max_even.max(error);
            }
            table.points.push(row);
        }
        Ok(table)
    }

    /// Comma-separated, in full precision.
    pub fn to_csv(&self) -> String {
        let mut text = String::from("n,X,Y,Z,A_rad,PA_rad,ErPA_rad,A_deg\n");
        let mut buffer = zmij::Buffer::new();
        for row in &self.points {
            let _ = write!(text, "{}", row.n);
            for value in [row.x, row.y, row.z, row.a_rad, row.pa_rad, row.er_pa_rad, row.a_deg] {
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
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }

    /// As the paper prints it: four decimals, the error in units of 1e-4.
    pub fn to_text(&self) -> String {
        let mut text = String::from("   Nos.           X           A          PA  ErPA(x1e-4)\n");
        for row in &self.points {
            let _ = writeln!(
                text,
                "{:>7} {:>11.4} {:>11.4} {:>11.4} {:>12.4}",
                row.n,
                row.x,
                row.a_rad + 0.0,
                row.pa_rad + 0.0,
                tidy(row.er_pa_rad * 1.0e4)
            );
        }
        for (name, value) in [("MaxErPA", self.max), ("MaxErPAo", self.max_odd), ("MaxErPAe", self.max_even)]
        {
            let _ = writeln!(text, "{name:<8}{:>48.5}", value * 1.0e4);
        }
        text
    }

    /// The greatest errors, for standard error.
    pub fn summary(&self) -> String {
        let dl = self.dl.map_or(String::new(), |dl| format!(", dl = {dl}"));
        let last = self.points.last().map_or(0.0, |row| row.x);
        format!(
            "{} points{dl}, last X {last:.4}\nMaxErPA = {:.4e}  MaxErPAo = {:.4e}  MaxErPAe = {:.4e} rad\n",
            self.count, self.max, self.max_odd, self.max_even
        )
    }
}

/// What rounds to zero at four decimals has no sign.
fn tidy(x: f64) -> f64 {
    if x.abs() < 0.000_05 { 0.0 } else { x }
}

fn row(curve: &LogCurve, n: usize, x: f64, a: f64) -> Row {
    let position = curve.position_with(x, a);
    let pa = curve.angle(x);
    Row {
        n,
        x,
        y: position[1],
        z: position[2],
        a_rad: a,
        pa_rad: pa,
        er_pa_rad: pa - a,
        a_deg: curve.index + a * DEGREES,
    }
}
