//! How far one track is from another, place by place, both run in order.
//!
//! From the place before, the nearest place on the reference is found by Gauss and Newton's steps
//!
//! ```text
//! u ← u + (p − c(u))·c′(u)/‖c′(u)‖²
//! ```
//!
//! and on into the next piece where that leaves the current one. Distances are those at the surface. What a picture shows
//! are these places; the bound everywhere is `verify`'s.

use super::thin::thinned;
use super::{Figure, Style};
use crate::geom::logcurve::LogCurve;
use crate::simulate::partition::{Parametric, Piece, Weights, difference};
use crate::simulate::shape::Shape;
use crate::simulate::track::{Event, Track};
use crate::units::{DEGREES, Position};
use std::ops::Range;

/// Places on a curved piece that are compared, and on a straight one.
const PLACES: [usize; 2] = [64, 8];

/// The most places in all, and the fewest on a piece: of a line beside a curve the ends lie on it, and the middle is farthest.
const MOST_PLACES: usize = 200_000;
const FEWEST: usize = 4;

/// A place is at the end of its piece where so little of it is left, mm: what numbers in decimals are apart.
const END: f64 = 1.0e-3;

/// Why two tracks cannot be compared place by place.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unlike {
    /// They move other axes.
    #[error("one moves {0}, the other {1}")]
    Axes(String, String),
    /// They do not have the same paths.
    #[error("the one has {0} paths between its rapids, the other {1}")]
    Runs(usize, usize),
    /// A path of the reference has nothing in it.
    #[error("one of its paths has no length")]
    Empty,
}

fn runs(track: &Track) -> Vec<Range<usize>> {
    let run = |event: &Event| match event {
        Event::Run(range) => Some(range.clone()),
        Event::Rapid(_) | Event::Dwell(_) => None,
    };
    track.events.iter().filter_map(run).collect()
}

/// What a distance at `p` is measured in: on a cutter A counts at the radius there.
fn surface(piece: &Piece<Shape>, p: &Position, cutter: Option<&LogCurve>) -> Weights {
    let mut surface = piece.surface;
    if let Some(curve) = cutter {
        surface.0[3] = curve.metric_radius(p[0]) / DEGREES;
    }
    surface
}

/// The nearest place to `p` at or behind (`piece`, `u`): its piece, parameter and distance.
fn nearest(
    pieces: &[Piece<Shape>],
    mut piece: usize,
    mut u: f64,
    p: &Position,
    cutter: Option<&LogCurve>,
) -> (usize, f64, f64) {
    let mut best = (piece, u, f64::INFINITY);
    loop {
        let own = &pieces[piece];
        let surface = surface(own, p, cutter);
        for _ in 0..20 {
            let [c, rate, _] = own.curve.jet(u);
            let square = surface.dot(&rate, &rate);
            let step = surface.dot(&difference(p, &c), &rate) / square;
            let next = if step.is_finite() {
                (u + step).clamp(own.from.min(own.to), own.from.max(own.to))
            } else {
                u
            };
            if next == u {
                break;
            }
            u = next;
        }
        let distance = surface.distance(p, &own.curve.at(u));
        if distance <= best.2 {
            best = (piece, u, distance);
        }
        // At its end the next piece may be nearer.
        match pieces.get(piece + 1) {
            Some(next) if surface.distance(&own.curve.at(u), &own.curve.at(own.to)) <= END => {
                piece += 1;
                u = next.from;
            }
            _ => return best,
        }
    }
}

/// The deviation of each place of `track` from `reference` over the way, mm. `cutter` is the curve of X Y Z A whose radius counts.
///
/// # Errors
/// They do not have the same axes or the same runs.
pub fn deviation(
    track: &Track,
    reference: &Track,
    cutter: Option<&LogCurve>,
) -> Result<Vec<[f64; 2]>, Unlike> {
    let (own, others) = (runs(track), runs(reference));
    if track.axes != reference.axes {
        let names = |track: &Track| {
            let names: Vec<String> = track.axes.as_slice().iter().map(|(axis, _)| axis.to_string()).collect();
            names.join(" ")
        };
        return Err(Unlike::Axes(names(track), names(reference)));
    }
    if own.len() != others.len() {
        return Err(Unlike::Runs(own.len(), others.len()));
    }
    let total: usize = track.pieces.len().max(1);
    let places = PLACES.map(|n| n.min(MOST_PLACES / total).max(FEWEST));
    let mut points: Vec<[f64; 2]> = Vec::new();
    let mut way = 0.0;
    for (range, other) in own.into_iter().zip(others) {
        if !points.is_empty() {
            points.push([f64::NAN; 2]);
        }
        let pieces = &reference.pieces[other];
        let (mut at, mut u) = (0, pieces.first().ok_or(Unlike::Empty)?.from);
        let mut last: Option<Position> = None;
        for piece in &track.pieces[range] {
            let count = if piece.curve.is_line() { places[1] } else { places[0] };
            for k in 0..=count {
                let p = piece.curve.at(piece.from + (piece.to - piece.from) * k as f64 / count as f64);
                way += last.map_or(0.0, |last| piece.counts.distance(&last, &p));
                last = Some(p);
                let (i, next, distance) = nearest(pieces, at, u, &p, cutter);
                (at, u) = (i, next);
                points.push([way, distance]);
            }
        }
    }
    Ok(points)
}

/// The figure of it.
///
/// # Errors
/// As [`deviation`].
pub fn figure(track: &Track, reference: &Track, cutter: Option<&LogCurve>) -> Result<Figure, Unlike> {
    let points = deviation(track, reference, cutter)?;
    let mut figure = Figure::new(
        "deviation",
        "Deviation from what was asked, at the surface",
        ["way in what F counts, mm", "mm"],
    );
    figure.add("deviation", Style::Line, thinned(&points));
    if figure.is_empty() { Err(Unlike::Empty) } else { Ok(figure) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::partition::Weights;
    use crate::units::Axes;

    fn track(points: &[[f64; 2]]) -> Track {
        let at = |p: [f64; 2]| [p[0], p[1], 0.0, 0.0, 0.0, 0.0];
        let counts = Weights([1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
        let line = |w: &[[f64; 2]]| Piece {
            curve: Shape::line(at(w[0]), at(w[1])),
            from: 0.0,
            to: 1.0,
            feed: 1.0,
            counts,
            surface: counts,
        };
        Track {
            axes: Axes::xyza(),
            events: vec![Event::Run(0..points.len() - 1)],
            pieces: points.windows(2).map(line).collect(),
            places: Vec::new(),
            through: false,
            radius_unknown: false,
            polygons: Vec::new(),
        }
    }

    #[test]
    fn a_dent_is_as_deep_as_it_is() {
        let straight = track(&[[0.0, 0.0], [4.0, 0.0], [10.0, 0.0]]);
        let dented = track(&[[0.0, 0.0], [5.0, 0.25], [10.0, 0.0]]);
        let found = deviation(&dented, &straight, None).unwrap();
        let most = found.iter().map(|p| p[1]).fold(0.0, f64::max);
        assert_eq!(most, 0.25);
        assert_eq!(
            deviation(&straight, &straight, None).unwrap().iter().map(|p| p[1]).fold(0.0, f64::max),
            0.0
        );
    }

    #[test]
    fn a_pass_more_is_no_picture() {
        let one = track(&[[0.0, 0.0], [4.0, 0.0]]);
        let mut two = one.clone();
        two.events.push(Event::Run(0..1));
        assert_eq!(deviation(&two, &one, None), Err(Unlike::Runs(2, 1)));
        two.axes = Axes::with_direction();
        assert!(matches!(deviation(&two, &one, None), Err(Unlike::Axes(..))));
    }
}
