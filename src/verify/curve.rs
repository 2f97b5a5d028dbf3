//! Paths of any other curve, in every form that they are written in.
//!
//! What was asked and what was read are both made of pieces, and [`follow`] bounds the distance of the one from the
//! other. Curves that meet may stand in one run of blocks: where one of them ends is where a block ends at its end,
//! rounded, about as far along as the curve is long.

use super::splined::Run;
use super::{Cursor, Found, Status, to_nurbs};
use crate::decimal::Decimal;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::dialect::Form;
use crate::geom::bezier::Bezier;
use crate::geom::deviation::{Bound, Metric};
use crate::geom::direction;
use crate::geom::follow::follow_turning;
use crate::geom::nurbs::Nurbs;
use crate::geom::runs;
use crate::ir::{Curve, Polyline, Units, Written, WrittenPoints};
use crate::machine::{Machine, Turn};
use crate::pass::approximate::{Frame, approximate};
use crate::pass::stretch::{counted_length, linear_length};
use crate::units::{Axes, DEGREES, Kind, MAX_AXES, Position};

/// A block may end a curve from this share of its length on, and up to as much more.
pub(super) const SHARE: f64 = 0.5;

/// What the proof of a curve needs beside it.
pub(super) struct Asked<'a> {
    pub(super) curve: &'a Curve,
    pub(super) machine: &'a Machine,
    /// The radius at which rotary axes count, mm.
    pub(super) radius: f64,
    pub(super) tolerance: f64,
    /// F in the text.
    pub(super) feed: Option<Decimal>,
}

/// The pieces of `curve`, cut where the knots of `path` stand at the same share of the whole, to 1e-9 of it; none where a
/// knot of `curve` has none in `path`.
fn cut_like(curve: &Nurbs, path: &Nurbs) -> Option<Vec<Bezier>> {
    let ends = |nurbs: &Nurbs| -> Vec<f64> {
        let total: f64 = nurbs.beziers().map(|(_, length)| length).sum();
        let mut along = 0.0;
        nurbs
            .beziers()
            .map(|(_, length)| {
                along += length / total;
                along
            })
            .collect()
    };
    let (own, other) = (ends(curve), ends(path));
    let mut pieces = Vec::with_capacity(other.len());
    let (mut start, mut next) = (0.0, 0);
    for ((piece, _), end) in curve.beziers().zip(&own) {
        let mut from = 0.0;
        while *other.get(next)? < end - 1.0e-9 {
            let to = (other[next] - start) / (end - start);
            pieces.push(piece.segment(from, to));
            from = to;
            next += 1;
        }
        if 1.0e-9 < (other[next] - end).abs() {
            return None;
        }
        pieces.push(piece.segment(from, 1.0));
        (start, next) = (*end, next + 1);
    }
    Some(pieces)
}

/// How long pieces take by the F in the text, minutes.
fn minutes(path: &[Bezier], asked: &Asked<'_>, axes: &Axes) -> f64 {
    let Some(feed) = asked.feed.map(Decimal::to_f64) else { return 0.0 };
    path.iter().map(|piece| counted_length(piece, axes, asked.machine, asked.radius)).sum::<f64>() / feed
}

/// Pieces whose directions start with length 1.
fn at_unit_length(pieces: &[Bezier], first: usize) -> Vec<Bezier> {
    let length = pieces.first().map_or(1.0, |piece| direction::length(&piece.start(), first));
    direction::scaled(pieces, Some(first), 1.0 / length)
}

/// Straight pieces with both directions at length 1.
fn with_unit_ends(pieces: &[Bezier], first: usize) -> Vec<Bezier> {
    let unit = |place: &Position| direction::unit(place, first);
    pieces.iter().map(|piece| Bezier::line(unit(&piece.start()), unit(&piece.end()))).collect()
}

impl Cursor<'_> {
    /// Meets the path of a curve.
    pub(super) fn curve(&mut self, asked: &Asked<'_>, written: &Written) -> Result<Found, Diagnostics> {
        let pieces = asked.curve.pieces();
        let mut found = Found { cutting_length: self.length(&pieces), ..Found::new() };
        if let Written::Through(kind, points) = written {
            self.through_curve(asked, Form::Through(*kind), points, &mut found)?;
            return Ok(found);
        }
        if let Curve::Lines(line) = asked.curve {
            found.rests = self.rests(line);
        }
        let Some(last) = pieces.last() else {
            return Err(self.differs("not-comparable", "only the control knows this curve".to_owned()));
        };
        let (path, blocks) = self.path(written, &last.end(), found.cutting_length)?;
        let axes = self.decimals.program.axes;
        let frame = Frame { axes: &axes, machine: asked.machine, radius: asked.radius };
        let metric = frame.metric(asked.tolerance);
        // Knots that were inserted cut the curve where they cut the path.
        let pieces = match (asked.curve, written) {
            (Curve::Nurbs(curve), Written::Nurbs(nurbs)) => {
                to_nurbs(self.decimals, nurbs).ok().and_then(|path| cut_like(curve, &path)).unwrap_or(pieces)
            }
            (Curve::Nurbs(_) | Curve::Lines(_) | Curve::Arc(_) | Curve::Polynomial(_), _)
            | (Curve::Through(..) | Curve::Logarithmic(_) | Curve::Formula(_), _) => pieces,
        };
        let turning = axes.direction();
        let (path, pieces) = match turning {
            Some(first) => {
                let chords = matches!(written, Written::Lines(_));
                let path = if chords { with_unit_ends(&path, first) } else { at_unit_length(&path, first) };
                (path, at_unit_length(&pieces, first))
            }
            None => (path, pieces),
        };
        // In place: a million lines are a third of a gigabyte of pieces.
        let scaled = |mut pieces: Vec<Bezier>| {
            for piece in &mut pieces {
                *piece = metric.scaled(piece);
            }
            pieces
        };
        let time = minutes(&path, asked, &axes);
        let (path, pieces) = (scaled(path), scaled(pieces));
        self.has_length(&pieces, &path, &metric)?;
        let reach = turning.map(|first| (first, metric.reach()));
        let followed = follow_turning(&path, &pieces, reach, asked.tolerance)
            .map_err(|error| self.differs("order-differs", error.to_string()))?;
        // Straight blocks, one a line, are no spline.
        if let Curve::Lines(line) = asked.curve
            && !matches!(written, Written::Lines(_))
            && path.len() < line.count()
        {
            let first = pieces.first().map(Bezier::start);
            let points: Vec<Position> = first.into_iter().chain(pieces.iter().map(Bezier::end)).collect();
            let likeness = runs::compare(&points, &path);
            found.splined =
                Some(Run { lines: line.count(), blocks, from_lines: followed.distance, likeness });
        }
        if let Some(first) = turning {
            let norm = |axes: &[f64]| axes.iter().map(|x| x * x).sum::<f64>().sqrt();
            let tip = norm(&followed.axes[..first]).min(followed.distance);
            // On lines the control turns the tool evenly, which no chord does.
            let pace = match written {
                Written::Lines(_) => {
                    let theta =
                        path.iter().map(|piece| direction::between(&piece.start(), &piece.end(), first));
                    direction::pace(theta.fold(0.0f64, f64::max))
                }
                Written::Arc(_) | Written::Polynomial(_) | Written::Nurbs(_) | Written::Through(..) => {
                    Some(0.0)
                }
            };
            let Some(pace) = pace else {
                let message = "a straight block turns the tool by more than a radian".to_owned();
                return Err(self.differs("direction-unknown", message));
            };
            let mut rad = followed.turn + pace;
            if matches!(written, Written::Lines(_)) && asked.machine.orientation.turn == Turn::Tilt {
                // The rotary axes leave the plane between two directions; how far is seen at some places.
                let of = |place: &Position| [place[first], place[first + 1], place[first + 2]];
                let departure = path
                    .iter()
                    .map(|piece| direction::tilt_departure(&of(&piece.start()), &of(&piece.end())));
                rad += departure.fold(0.0f64, f64::max);
                found.status = Status::Sampled;
            }
            found.deviation = Bound { mm: tip, rad };
            found.path_blocks = blocks;
            found.minutes = time;
            self.map = self.map.max(Some(followed.map));
            self.pass(written, blocks);
            return Ok(found);
        }
        let turn = |axis: usize| followed.axes[axis] * DEGREES / asked.radius / DEGREES;
        let rotary = metric.rotary().iter().enumerate().filter(|(_, rotary)| **rotary);
        let rad = rotary.fold(0.0, |most, (axis, _)| f64::max(most, turn(axis)));
        found.deviation = Bound { mm: followed.distance, rad };
        found.path_blocks = blocks;
        found.minutes = time;
        self.map = self.map.max(Some(followed.map));
        self.pass(written, blocks);
        Ok(found)
    }

    /// Goes on behind so many blocks of a path.
    fn pass(&mut self, written: &Written, blocks: usize) {
        match written {
            Written::Lines(points) => {
                self.within += blocks;
                self.leave(points);
            }
            Written::Polynomial(polynomial) => {
                self.within += blocks;
                if polynomial.blocks.len() <= self.within {
                    self.advance();
                }
            }
            Written::Nurbs(_) | Written::Arc(_) | Written::Through(..) => self.advance(),
        }
    }

    /// How far pieces are from the expressions that they stand for, given the bound in each axis.
    pub(super) fn stand_in(&self, bound: &Position) -> Bound {
        let axes = self.decimals.program.axes;
        let kinds: Vec<Kind> = axes.as_slice().iter().map(|(_, kind)| *kind).collect();
        Metric::new(&kinds, self.radius).distance(&[0.0; MAX_AXES], bound)
    }

    /// The length of the linear axes' path, mm.
    fn length(&self, pieces: &[Bezier]) -> f64 {
        let axes = self.decimals.program.axes;
        pieces.iter().map(|piece| linear_length(piece, &axes)).sum()
    }

    /// The pieces that belong to a curve of this end and length, and how many blocks they are.
    fn path(
        &self,
        written: &Written,
        end: &Position,
        length: f64,
    ) -> Result<(Vec<Bezier>, usize), Diagnostics> {
        let mut path = Vec::new();
        let ends_here = |units: &Units| {
            (0..self.decimals.program.axes.count()).all(|i| self.units(i, end[i]) == Some(units[i]))
        };
        let mut along = 0.0;
        // The end that is reached after a way most like the curve's.
        let mut best: Option<(f64, usize)> = None;
        let mut meet = |piece: Bezier, to: &Units, path: &mut Vec<Bezier>| {
            along += self.length(&[piece]);
            path.push(piece);
            let off = (along - length).abs();
            if ends_here(to) && off <= SHARE * length && best.is_none_or(|(known, _)| off < known) {
                best = Some((off, path.len()));
            }
            along <= (1.0 + SHARE) * length
        };
        match written {
            Written::Nurbs(nurbs) => {
                let pieces = self.pieces(written)?;
                return Ok((pieces, nurbs.points.len() - 1));
            }
            Written::Lines(points) => {
                let mut from = self.before(points);
                for to in points.points().skip(self.within) {
                    let piece = Bezier::line(self.decimals.position(&from), self.decimals.position(&to));
                    if !meet(piece, &to, &mut path) {
                        break;
                    }
                    from = to;
                }
            }
            Written::Polynomial(polynomial) => {
                let blocks = &polynomial.blocks;
                let mut from = match self.within.checked_sub(1) {
                    None => polynomial.start,
                    Some(last) => blocks[last].end,
                };
                for block in &blocks[self.within..] {
                    if !meet(block.to_bezier(&self.decimals.digits, &from), &block.end, &mut path) {
                        break;
                    }
                    from = block.end;
                }
            }
            // An arc is none of these curves' blocks.
            Written::Arc(_) | Written::Through(..) => {}
        }
        if path.is_empty() {
            return Err(self.differs("less-than-asked", "a path is missing here".to_owned()));
        }
        // Where no block ends at the end, all of them are measured, and are found too far away.
        let mut count = best.map_or(path.len(), |(_, count)| count);
        // A last step that rounding made a rest ends where the block before it does, and no other curve is behind it.
        let left = match written {
            Written::Lines(points) => points.count() - self.within,
            Written::Polynomial(_) | Written::Nurbs(_) | Written::Arc(_) | Written::Through(..) => 0,
        };
        if count + 1 == left && path.get(count).is_some_and(|last| last.start() == last.end()) {
            count = left;
        }
        path.truncate(count);
        Ok((path, count))
    }

    /// The control's own spline: its points are those that were asked for, and nothing is known between them.
    fn through_curve(
        &mut self,
        asked: &Asked<'_>,
        form: Form,
        points: &WrittenPoints,
        found: &mut Found,
    ) -> Result<(), Diagnostics> {
        found.status = Status::PointsOnly;
        let axes = self.decimals.program.axes;
        let frame = Frame { axes: &axes, machine: asked.machine, radius: asked.radius };
        let curve = approximate(asked.curve, form, &frame, asked.tolerance, true)?;
        let (Curve::Lines(line) | Curve::Through(_, line)) = curve else {
            return Err(self.differs("not-comparable", "this curve has no points".to_owned()));
        };
        if line.count() != points.count() {
            let message = format!("the spline has {} points, not {}", points.count(), line.count());
            return Err(self.differs("points-differ", message));
        }
        found.deviation = self.starts_at(&line.start, points)?;
        self.same_points(&line, points, asked, found)?;
        found.path_blocks = points.count();
        self.advance();
        Ok(())
    }

    /// Every point is the one that was asked for, rounded.
    fn same_points(
        &mut self,
        line: &Polyline,
        points: &WrittenPoints,
        asked: &Asked<'_>,
        found: &mut Found,
    ) -> Result<(), Diagnostics> {
        let axes = self.decimals.program.axes;
        let kinds: Vec<Kind> = axes.as_slice().iter().map(|(_, kind)| *kind).collect();
        let metric = Metric::new(&kinds, asked.radius);
        for (wanted, read) in line.points().zip(points.points()) {
            for axis in 0..axes.count().min(MAX_AXES) {
                if self.units(axis, wanted[axis]) != Some(read[axis]) {
                    let name = axes.name(axis);
                    let message = format!("{name} of a point was asked to be {}", wanted[axis]);
                    let refused = Diagnostic::refusal("point-differs", message);
                    return Err(match self.step() {
                        Some(step) => refused.at(self.place(step), "").into(),
                        None => refused.into(),
                    });
                }
            }
            let distance = metric.distance(&wanted, &self.decimals.position(&read));
            found.deviation = found.deviation.max(distance);
        }
        Ok(())
    }
}
