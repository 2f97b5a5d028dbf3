//! What a track looks like: its projections, the rotary axes against X, control polygons and block ends.

use super::{Figure, Style};
use crate::geom::elementary::{cos, sin};
use crate::geom::logcurve::LogCurve;
use crate::simulate::partition::Parametric;
use crate::simulate::track::{Event, Track};
use crate::units::{DEGREES, Kind, MAX_AXES, Position};

/// The most points of a path that are drawn.
const MOST_POINTS: usize = 20_000;

/// The most block ends and control points that are drawn.
const MOST_DOTS: usize = 2_000;

/// Samples of a curved piece.
const SAMPLES: usize = 64;

/// Positions along a track; a gap between runs is a position of NaN.
pub fn samples(track: &Track) -> Vec<Position> {
    let each = (MOST_POINTS / track.pieces.len().max(1)).clamp(1, SAMPLES);
    // Where even the ends are too many, every so many pieces.
    let stride = track.pieces.len().div_ceil(MOST_POINTS).max(1);
    let mut points = Vec::new();
    for event in &track.events {
        let Event::Run(range) = event else { continue };
        if !points.is_empty() {
            points.push([f64::NAN; MAX_AXES]);
        }
        for i in range.clone() {
            let piece = &track.pieces[i];
            if i == range.start {
                points.push(piece.curve.at(piece.from));
            }
            let count = if piece.curve.is_line() { 1 } else { each };
            if (i - range.start) % stride != 0 && i + 1 != range.end {
                continue;
            }
            for k in 1..=count {
                points.push(piece.curve.at(piece.from + (piece.to - piece.from) * k as f64 / count as f64));
            }
        }
    }
    points
}

/// Two coordinates of a position.
type Look = Box<dyn Fn(&Position) -> [f64; 2]>;

/// A way of looking: the anchor, the title, the labels, two coordinates of a position.
struct View {
    id: &'static str,
    title: String,
    labels: [String; 2],
    equal: bool,
    of: Look,
}

impl View {
    fn figure(&self, track: &Track, path: &[Position], blocks: bool) -> Figure {
        let mut figure = Figure::new(self.id, self.title.clone(), [&self.labels[0], &self.labels[1]]);
        figure.equal = self.equal;
        let points = |positions: &[Position]| positions.iter().map(|p| (self.of)(p)).collect::<Vec<_>>();
        figure.add("path", Style::Line, points(path));
        if blocks {
            let corners: usize = track.polygons.iter().map(Vec::len).sum();
            if corners <= MOST_DOTS {
                let mut polygons = Vec::new();
                for polygon in &track.polygons {
                    polygons.extend(points(polygon));
                    polygons.push([f64::NAN; 2]);
                }
                figure.add("control polygons", Style::Thin, polygons);
            }
            if track.pieces.len() <= MOST_DOTS {
                let ends: Vec<Position> = track.pieces.iter().map(|piece| piece.curve.at(piece.to)).collect();
                figure.add("block ends", Style::Dots, points(&ends));
            }
        }
        figure
    }
}

/// The view from above one corner: orthographic, along (1, 1, −1).
fn spatial(p: [f64; 3]) -> [f64; 2] {
    // √½, √⅔ and √⅙.
    let (a, b, c) = (std::f64::consts::FRAC_1_SQRT_2, 0.816_496_580_927_726, 0.408_248_290_463_863);
    [(p[0] - p[1]) * a, p[2] * b + (p[0] + p[1]) * c]
}

/// All figures of a path. `cutter` is the flute's curve where there is one: its path is also shown on the cutter.
pub fn figures(track: &Track, cutter: Option<&LogCurve>) -> Vec<Figure> {
    let path = samples(track);
    let axes = track.axes;
    let linear: Vec<usize> = (0..axes.count()).filter(|i| axes.kind(*i) == Kind::Linear).take(3).collect();
    let rotary: Vec<usize> = (0..axes.count()).filter(|i| axes.kind(*i) == Kind::Rotary).collect();
    let mut views = Vec::new();
    for (id, a, b) in [("xy", 0, 1), ("xz", 0, 2), ("yz", 1, 2)] {
        let (Some(i), Some(j)) = (linear.get(a).copied(), linear.get(b).copied()) else { continue };
        views.push(View {
            id,
            title: format!("Path in {}{}", axes.name(i), axes.name(j)),
            labels: [format!("{}, mm", axes.name(i)), format!("{}, mm", axes.name(j))],
            equal: true,
            of: Box::new(move |p| [p[i], p[j]]),
        });
    }
    if let [x, y, z] = linear[..] {
        views.push(View {
            id: "spatial",
            title: format!(
                "Path in 3D, seen along (1, 1, -1) of {}{}{}",
                axes.name(x),
                axes.name(y),
                axes.name(z)
            ),
            labels: [
                format!("({} - {})/√2, mm", axes.name(x), axes.name(y)),
                format!("(2{} + {} + {})/√6, mm", axes.name(z), axes.name(x), axes.name(y)),
            ],
            equal: true,
            of: Box::new(move |p| spatial([p[x], p[y], p[z]])),
        });
    }
    if let (Some(x), [_, ..]) = (linear.first().copied(), &rotary[..]) {
        for (n, i) in rotary.iter().copied().enumerate() {
            views.push(View {
                id: ["rotary", "rotary-2", "rotary-3", "rotary-4", "rotary-5", "rotary-6"][n],
                title: format!("{} against {}", axes.name(i), axes.name(x)),
                labels: [format!("{}, mm", axes.name(x)), format!("{}, degrees", axes.name(i))],
                equal: false,
                of: Box::new(move |p| [p[x], p[i]]),
            });
        }
    }
    let mut figures: Vec<Figure> = views.iter().map(|view| view.figure(track, &path, true)).collect();
    if let Some(curve) = cutter.copied() {
        let on_cutter = View {
            id: "cutter",
            title: "The flutes on the cutter, seen along (1, 1, -1)".to_owned(),
            labels: ["(X - R cos A)/√2, mm".to_owned(), "(2 R sin A + X + R cos A)/√6, mm".to_owned()],
            equal: true,
            of: Box::new(move |p| {
                let (r, a) = (curve.radius(p[0]), p[3] / DEGREES);
                spatial([p[0], r * cos(a), r * sin(a)])
            }),
        };
        // Approaches are no part of the cutter.
        let mut flutes: Vec<Position> = Vec::new();
        for piece in &track.pieces {
            let (start, end) = (piece.curve.at(piece.from), piece.curve.at(piece.to));
            if start[0] == end[0] {
                flutes.push([f64::NAN; MAX_AXES]);
                continue;
            }
            let at =
                |k: usize| piece.curve.at(piece.from + (piece.to - piece.from) * k as f64 / SAMPLES as f64);
            flutes.extend((0..=SAMPLES).map(at));
        }
        if flutes.len() <= 4 * MOST_POINTS {
            figures.push(on_cutter.figure(track, &flutes, false));
        }
    }
    figures.retain(|figure| !figure.is_empty());
    figures
}
