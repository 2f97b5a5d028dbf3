//! Pictures: figures as data, drawn to SVG, bound in one HTML page.
//!
//! | module | what |
//! |---|---|
//! | [`draw`] | one figure to SVG |
//! | [`page`] | figures to one SVG sheet or one self-contained HTML page |
//! | [`paths`] | what a track looks like: projections, polygons, block ends |
//! | [`profiles`] | what happens along it: feed, acceleration, curvature, errors |
//! | [`deviation`] | how far one track is from another, place by place |
//! | [`paper`] | figures 3 to 5 of the paper of the odd-even steps |
//!
//! A picture shows samples. What is proved is what `verify` proves.

pub mod deviation;
pub mod draw;
pub mod page;
pub mod paper;
pub mod paths;
pub mod profiles;
mod thin;

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Style {
    /// A line through its points; a point that is not a number breaks it.
    Line,
    /// A thin grey line.
    Thin,
    /// A dot a point.
    Dots,
}

/// Points that belong together.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// What they are.
    pub name: String,
    /// How they are drawn.
    pub style: Style,
    /// The points.
    pub points: Vec<[f64; 2]>,
}

/// One picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Its anchor in a page.
    pub id: &'static str,
    /// What it shows.
    pub title: String,
    /// The names of its axes, with units.
    pub labels: [String; 2],
    /// Whether both axes have one scale.
    pub equal: bool,
    /// What is drawn, the first below.
    pub series: Vec<Series>,
}

impl Figure {
    /// A figure with nothing in it yet.
    pub fn new(id: &'static str, title: impl Into<String>, labels: [&str; 2]) -> Figure {
        Figure {
            id,
            title: title.into(),
            labels: labels.map(str::to_owned),
            equal: false,
            series: Vec::new(),
        }
    }

    /// Adds a series, if it has points.
    pub fn add(&mut self, name: impl Into<String>, style: Style, points: Vec<[f64; 2]>) {
        if points.iter().any(|p| p[0].is_finite() && p[1].is_finite()) {
            self.series.push(Series { name: name.into(), style, points });
        }
    }

    /// Whether there is anything to draw.
    pub fn is_empty(&self) -> bool {
        self.series.is_empty()
    }
}
