//! What a track looks like: its projections, the rotary axes against X, control polygons and block ends.

use super::thin::thinned;
use super::{Figure, Series, Style};
use crate::geom::elementary::{acos, cos, sin};
use crate::geom::logcurve::LogCurve;
use crate::simulate::partition::{Parametric, Piece, difference};
use crate::simulate::shape::Shape;
use crate::simulate::track::{Event, Track};
use crate::units::{DEGREES, Kind, MAX_AXES, Position};

/// The most points that curves are drawn by, and the fewest of each.
const MOST_POINTS: usize = 2_000_000;
const FEWEST: usize = 8;

/// The most block ends and control points that are drawn.
const MOST_DOTS: usize = 2_000;

/// In how many parts a curved piece is looked at.
const PARTS: usize = 64;

/// A curve is drawn by lines that turn by no more than 3 degrees: where the curve has a radius of 300 on the drawing,
/// they leave it by 300 (1 − cos 1.5°) = 0.1.
const TURN: f64 = 3.0 / DEGREES;

/// In how many equal parts of its parameter a piece is drawn: all its turns within [`TURN`], up to `most`.
fn parts(piece: &Piece<Shape>, most: usize) -> usize {
    if piece.curve.is_line() {
        return 1;
    }
    let at = |k: usize| piece.curve.at(piece.from + (piece.to - piece.from) * k as f64 / PARTS as f64);
    let metric = &piece.surface;
    let mut turn = 0.0f64;
    let mut last: Option<Position> = None;
    for k in 0..PARTS {
        let chord = difference(&at(k + 1), &at(k));
        if let Some(before) = last.replace(chord) {
            let cosine = metric.dot(&before, &chord) / (metric.norm(&before) * metric.norm(&chord));
            if cosine.is_finite() {
                turn = turn.max(acos(cosine.clamp(-1.0, 1.0)));
            }
        }
    }
    ((PARTS as f64 * turn / TURN).ceil() as usize).clamp(FEWEST, 1024).min(most)
}

/// Positions along a track; a gap between runs is a position of NaN.
pub fn samples(track: &Track) -> Vec<Position> {
    let most = (MOST_POINTS / track.pieces.len().max(1)).max(FEWEST);
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
            let count = parts(piece, most);
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
        figure.add("path", Style::Line, thinned(&points(path)));
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

/// The least and the greatest of one coordinate.
fn extent(path: &[Position], axis: usize) -> [f64; 2] {
    let finite = path.iter().map(|p| p[axis]).filter(|x| x.is_finite());
    finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
}

/// `X 0 to 30`.
fn told((name, [low, high]): &(String, [f64; 2])) -> String {
    // Adding zero takes the sign off a negative zero.
    let number = |x: f64| ((x * 1e3).round() / 1e3 + 0.0).to_string();
    format!("{name} {} to {}", number(*low), number(*high))
}

/// The edges of the box from the least to the greatest X, Y and Z, so that one sees what lies where.
fn frame([x, y, z]: [&[f64; 2]; 3]) -> Option<Vec<[f64; 2]>> {
    let mut edges = Vec::new();
    for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        edges.extend([[x[0], y[i], z[j]], [x[1], y[i], z[j]]]);
        edges.extend([[x[i], y[0], z[j]], [x[i], y[1], z[j]]]);
        edges.extend([[x[i], y[j], z[0]], [x[i], y[j], z[1]]]);
    }
    let known = edges.iter().flatten().all(|x| x.is_finite());
    let lines = edges.chunks(2).flat_map(|edge| [spatial(edge[0]), spatial(edge[1]), [f64::NAN; 2]]);
    known.then(|| lines.collect())
}

/// What is too much for figures: what [`figures`] leave out.
pub fn left_out(track: &Track) -> Vec<String> {
    let corners: usize = track.polygons.iter().map(Vec::len).sum();
    let mut told = Vec::new();
    if MOST_DOTS < corners {
        told.push(format!(
            "control polygons are not drawn: they have {corners} points, and {MOST_DOTS} can be seen"
        ));
    }
    if MOST_DOTS < track.pieces.len() {
        let blocks = track.pieces.len();
        told.push(format!("block ends are not drawn: there are {blocks}, and {MOST_DOTS} can be seen"));
    }
    told
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
    if let (Some(figure), [x, y, z]) = (figures.iter_mut().find(|figure| figure.id == "spatial"), &linear[..])
    {
        let [x, y, z] = [x, y, z].map(|i| (axes.name(*i).to_string(), extent(&path, *i)));
        figure.series.splice(
            0..0,
            frame([&x.1, &y.1, &z.1]).map(|points| Series {
                name: format!("{}, {}, {}", told(&x), told(&y), told(&z)),
                style: Style::Thin,
                points,
            }),
        );
    }
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
            // Seen on the cutter A turns too.
            let turn = (end[3] - start[3]).abs() / DEGREES;
            let most = (MOST_POINTS / track.pieces.len().max(1)).max(FEWEST);
            let count = ((turn / TURN).ceil() as usize).max(PARTS).min(most);
            let at =
                |k: usize| piece.curve.at(piece.from + (piece.to - piece.from) * k as f64 / count as f64);
            flutes.extend((0..=count).map(at));
        }
        let mut figure = on_cutter.figure(track, &flutes, false);
        let ends = extent(&flutes, 0);
        let ring = |x: f64| (0..=120).map(move |i| [x, 0.0, 0.0, 3.0 * f64::from(i), 0.0, 0.0]);
        let rings = ring(ends[0]).map(|p| (on_cutter.of)(&p)).chain([[f64::NAN; 2]]);
        let points = rings.chain(ring(ends[1]).map(|p| (on_cutter.of)(&p))).collect();
        figure.series.push(Series { name: "its ends".to_owned(), style: Style::Thin, points });
        figures.push(figure);
    }
    figures.retain(|figure| !figure.is_empty());
    figures
}
