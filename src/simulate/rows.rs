//! Cycles as CSV and JSON: `n,t,u,X,Y,Z,A_deg,chord,feed_error,chord_error` in s, mm, degrees, relative and m, only the
//! axes there are, in full precision.

use super::Row;
use crate::geom::direction;
use crate::units::{Axes, Kind};

/// How rows are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Comma-separated, below a header.
    Csv,
    /// One array, an object a line.
    Json,
}

/// Writes rows one by one.
pub struct Writer {
    format: Format,
    names: Vec<String>,
    axes: usize,
    /// The first component of the tool's direction, which is told at length 1.
    direction: Option<usize>,
    buffer: zmij::Buffer,
    first: bool,
}

impl Writer {
    /// A writer for these coordinates.
    pub fn new(axes: &Axes, format: Format) -> Writer {
        let mut names: Vec<String> = vec!["n".into(), "t".into(), "u".into()];
        for (name, kind) in axes.as_slice() {
            names.push(match kind {
                Kind::Linear | Kind::Direction => name.to_string(),
                Kind::Rotary => format!("{name}_deg"),
            });
        }
        names.extend(["chord", "feed_error", "chord_error"].map(str::to_owned));
        let direction = axes.direction();
        Writer { format, names, axes: axes.count(), direction, buffer: zmij::Buffer::new(), first: true }
    }

    /// What stands before the rows.
    pub fn header(&self) -> String {
        match self.format {
            Format::Csv => self.names.join(",") + "\n",
            Format::Json => "[".to_owned(),
        }
    }

    /// What stands behind them.
    pub fn footer(&self) -> &'static str {
        match self.format {
            Format::Csv => "",
            Format::Json => "\n]\n",
        }
    }

    /// Adds one row to a text.
    pub fn row(&mut self, row: &Row, text: &mut String) {
        let at = self.direction.map_or(row.at, |first| direction::unit(&row.at, first));
        let values = [row.t, row.u].into_iter().chain(at[..self.axes].iter().copied()).chain([
            row.chord,
            row.feed_error,
            row.chord_error,
        ]);
        let mut whole = itoa::Buffer::new();
        match self.format {
            Format::Csv => {
                text.push_str(whole.format(row.n));
                for value in values {
                    text.push(',');
                    // Adding zero takes the sign off a negative zero.
                    text.push_str(self.buffer.format(value + 0.0));
                }
                text.push('\n');
            }
            Format::Json => {
                text.push_str(if self.first { "\n{\"n\":" } else { ",\n{\"n\":" });
                text.push_str(whole.format(row.n));
                for (name, value) in self.names[1..].iter().zip(values) {
                    text.push_str(",\"");
                    text.push_str(name);
                    text.push_str("\":");
                    text.push_str(self.buffer.format(value + 0.0));
                }
                text.push('}');
            }
        }
        self.first = false;
    }
}
