//! What happens along a path, cycle by cycle: feed, acceleration, curvature, feed error and chord error, over the way.
//!
//! A path of an hour has millions of cycles. Where there are more than fit a picture, each column keeps the least and the
//! greatest of its cycles, so that no peak is lost.

use super::{Figure, Style};
use crate::diagnostic::Diagnostics;
use crate::simulate::partition::{Parametric, Piece, difference};
use crate::simulate::report::Summary;
use crate::simulate::shape::Shape;
use crate::simulate::track::Track;
use crate::simulate::{Options, Row, simulate};
use crate::units::{Kind, MAX_AXES, Position};

/// The most cycles that are drawn one by one.
const MOST: u64 = 4_000;

/// A joint where the velocity steps by more than this share of the feed is a corner: a turn of 3°, or 5 % of F.
const CORNER: f64 = 0.05;

/// The corners of a track: whether the velocity steps at the start of each piece.
fn corners(track: &Track) -> Vec<bool> {
    let velocity = |piece: &Piece<Shape>, u: f64| {
        let rate = piece.curve.jet(u)[1];
        let speed = piece.feed / piece.counts.norm(&rate) * (piece.to - piece.from).signum();
        rate.map(|x| x * speed)
    };
    let step = |w: &[Piece<Shape>]| {
        let (before, after) = (velocity(&w[0], w[0].to), velocity(&w[1], w[1].from));
        CORNER * w[0].feed.max(w[1].feed) < w[1].counts.norm(&difference(&after, &before))
    };
    std::iter::once(false).chain(track.pieces.windows(2).map(step)).collect()
}

/// A line over the way, or its least and greatest column by column.
struct Profile {
    /// How many values make a column.
    width: u64,
    points: Vec<[f64; 2]>,
    /// The open column: how many values, the least and the greatest point, in the order in which they came.
    open: Option<(u64, [f64; 2], [f64; 2])>,
}

impl Profile {
    fn new(width: u64) -> Profile {
        Profile { width, points: Vec::new(), open: None }
    }

    fn value(&mut self, way: f64, y: f64) {
        let own = [way, y];
        let (count, least, greatest) = self.open.unwrap_or((0, own, own));
        let least = if y < least[1] { own } else { least };
        let greatest = if greatest[1] < y { own } else { greatest };
        self.open = Some((count + 1, least, greatest));
        if self.width <= count + 1 {
            self.close();
        }
    }

    fn close(&mut self) {
        if let Some((_, a, b)) = self.open.take() {
            let (first, second) = if a[0] <= b[0] { (a, b) } else { (b, a) };
            self.points.push(first);
            if first != second {
                self.points.push(second);
            }
        }
    }

    /// The line breaks here.
    fn gap(&mut self) {
        self.close();
        self.points.push([f64::NAN; 2]);
    }

    fn finish(mut self) -> Vec<[f64; 2]> {
        self.close();
        self.points
    }
}

/// κ = √(‖c′‖²‖c″‖² − (c′·c″)²)/‖c′‖³ at the surface, 1/mm; none where the curve stands still by its parameter.
fn curvature(piece: &Piece<Shape>, u: f64) -> Option<f64> {
    let [_, rate, second] = piece.curve.jet(u);
    let metric = &piece.surface;
    let (v, a, va) = (metric.dot(&rate, &rate), metric.dot(&second, &second), metric.dot(&rate, &second));
    let bend = (v * a - va * va).max(0.0).sqrt() / (v * v.sqrt());
    bend.is_finite().then_some(bend)
}

struct Collector<'t> {
    track: &'t Track,
    way: f64,
    feed: Profile,
    curvature: Profile,
    feed_error: Profile,
    chord_error: Profile,
    accelerations: Vec<Profile>,
    /// The last two positions of the run, the later first, and the piece of each.
    last: [Option<(Position, usize)>; 2],
    cycle: f64,
    /// Which pieces start at a corner; without limits speed steps there at no acceleration, which would hide all the rest.
    corners: Option<Vec<bool>>,
}

impl Collector<'_> {
    fn row(&mut self, row: &Row) {
        let piece = &self.track.pieces[row.piece];
        if row.time == 0.0 {
            // A run starts.
            for profile in [&mut self.feed, &mut self.curvature, &mut self.feed_error, &mut self.chord_error]
            {
                profile.gap();
            }
            self.accelerations.iter_mut().for_each(Profile::gap);
            self.last = [Some((row.at, row.piece)), None];
            return;
        }
        self.way += row.chord;
        self.feed.value(self.way, row.chord / row.time * 60.0);
        self.feed_error.value(self.way, row.feed_error.abs());
        self.chord_error.value(self.way, row.chord_error);
        let u = piece.from + (piece.to - piece.from) * (row.u - row.piece as f64);
        if let Some(bend) = curvature(piece, u) {
            self.curvature.value(self.way, bend);
        }
        // The rest of a cycle is no whole one.
        if row.time == self.cycle || (row.time - self.cycle).abs() <= 1e-9 * self.cycle {
            if let [Some((one, _)), Some((two, first))] = self.last {
                let joints = first + 1..row.piece + 1;
                let corner =
                    self.corners.as_ref().is_some_and(|corners| corners[joints].iter().any(|corner| *corner));
                for (i, profile) in self.accelerations.iter_mut().enumerate().filter(|_| !corner) {
                    let change = (row.at[i] - one[i]) - (one[i] - two[i]);
                    // What the roundings of three places can do is no change: half of it in each, twice in the middle.
                    let noise = 4.0 * f64::EPSILON * row.at[i].abs().max(one[i].abs()).max(two[i].abs());
                    let change = if change.abs() <= noise { 0.0 } else { change };
                    profile.value(self.way, change / (self.cycle * self.cycle));
                }
            }
            self.last = [Some((row.at, row.piece)), self.last[0]];
        } else {
            self.last = [None, None];
        }
    }
}

/// Runs a track and draws what happens along it.
///
/// # Errors
/// As [`simulate`].
pub fn figures(track: &Track, options: &Options) -> Result<(Vec<Figure>, Summary), Diagnostics> {
    let axes = track.axes;
    let count = simulate_count(track, options)?;
    let width = count.div_ceil(MOST).max(1);
    let new = || Profile::new(width);
    let mut collector = Collector {
        track,
        way: 0.0,
        feed: new(),
        curvature: new(),
        feed_error: new(),
        chord_error: new(),
        accelerations: (0..axes.count().min(MAX_AXES)).map(|_| new()).collect(),
        last: [None; 2],
        cycle: options.law.cycle,
        corners: (!options.limits.any()).then(|| corners(track)),
    };
    let summary = simulate(track, options, &mut |row| collector.row(row))?;
    let way = "way in what F counts, mm";
    let single = |id, title: &str, label: &str, name: &str, profile: Profile| {
        let mut figure = Figure::new(id, title, [way, label]);
        figure.add(name, Style::Line, profile.finish());
        figure
    };
    let mut figures = vec![single("feed", "Feed", "mm/min", "feed", collector.feed)];
    let without = if options.limits.any() { "" } else { ", corners left out" };
    let titled = |id, kind: &str, unit: &str| {
        Figure::new(id, format!("Acceleration of the {kind} axes{without}"), [way, unit])
    };
    let mut linear = titled("acceleration", "linear", "mm/s²");
    let mut rotary = titled("acceleration-rotary", "rotary", "degrees/s²");
    for (i, profile) in collector.accelerations.into_iter().enumerate() {
        let figure = match axes.kind(i) {
            Kind::Linear | Kind::Direction => &mut linear,
            Kind::Rotary => &mut rotary,
        };
        figure.add(axes.name(i).to_string(), Style::Line, profile.finish());
    }
    figures.extend([linear, rotary]);
    figures.push(single("curvature", curvature_of(track), "1/mm", "curvature", collector.curvature));
    figures.push(single(
        "feed-error",
        "Feed error: |chord - asked|/asked",
        "relative",
        "feed error",
        collector.feed_error,
    ));
    figures.push(single(
        "chord-error",
        "Chord error: the curve from the chord of a cycle",
        "m",
        "chord error",
        collector.chord_error,
    ));
    figures.retain(|figure| !figure.is_empty());
    Ok((figures, summary))
}

/// What a curvature is one of.
fn curvature_of(track: &Track) -> &'static str {
    let rotary: Vec<usize> =
        (0..track.axes.count()).filter(|i| track.axes.kind(*i) == Kind::Rotary).collect();
    if rotary.is_empty() {
        "Curvature"
    } else if track.pieces.iter().any(|piece| rotary.iter().any(|i| piece.surface.0[*i] != 0.0)) {
        "Curvature, rotary axes counted at the surface"
    } else {
        "Curvature in the linear axes"
    }
}

/// How many cycles there are.
fn simulate_count(track: &Track, options: &Options) -> Result<u64, Diagnostics> {
    // The spline estimate of the summary is not needed for counting.
    let options = Options { block_time: None, ..*options };
    simulate(track, &options, &mut |_| {}).map(|summary| summary.cycles)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_keep_their_peaks() {
        let mut profile = Profile::new(10);
        for i in 0..100 {
            profile.value(f64::from(i), if i == 37 { 5.0 } else { 1.0 });
        }
        let points = profile.finish();
        assert_eq!(points.len(), 11);
        assert!(points.contains(&[37.0, 5.0]));
    }
}
