//! The path as a control would run it, cycle by cycle.
//!
//! | module | what |
//! |---|---|
//! | [`partition`] | the next point of a curve: the one whose chord is F·T |
//! | [`shape`] | curves in the form that is quickest to evaluate |
//! | [`track`] | a program as pieces to run |
//! | [`limits`], [`profile`], [`planned`] | what the axes can do, the feed profile that keeps it, and its cycles |
//! | [`report`] | how long, how well, where worst |
//! | [`rows`] | cycles as CSV and JSON |
//!
//! Without limits every cycle is as long as F asks from the first to the last full one of a run; with limits the feed
//! profile rises from a stand, slows down for bends and joints, and ends at a stand.
//! `docs/simulation.md` has the formulas and what was measured.

pub mod limits;
pub mod partition;
pub mod planned;
pub mod profile;
pub mod report;
pub mod rows;
pub mod shape;
pub mod track;

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::geom::length::length;
use crate::geom::smooth;
use crate::units::Position;
use limits::Limits;
use partition::{Cycle, Cycles, Law, Parametric, Piece};
use planned::Planned;
use report::{BlockRate, Kinematics, Summary};
use shape::Shape;
use std::ops::Range;
use track::{Event, Track};

/// How a track is run.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// The law of every cycle.
    pub law: Law,
    /// What the axes can do.
    pub limits: Limits,
    /// What the control takes for a block, ms.
    pub block_time: Option<f64>,
    /// mm, for the number of spline blocks that would do instead.
    pub tolerance: f64,
}

/// The end of one cycle, or the start of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// From 0.
    pub n: u64,
    /// When, s.
    pub t: f64,
    /// How many pieces lie behind, and which share of the current one by its parameter.
    pub u: f64,
    /// Where, mm and degrees.
    pub at: Position,
    /// The chord, in what F counts.
    pub chord: f64,
    /// (chord − asked)/asked.
    pub feed_error: f64,
    /// How far the curve is from the chord, m.
    pub chord_error: f64,
    /// Which piece it ends on.
    pub piece: usize,
    /// How long the cycle is, s; 0 at the start of a run.
    pub time: f64,
}

/// More cycles than these are a mistake in feed or cycle time.
const MOST_CYCLES: f64 = 1e8;

/// Runs a track and shows every row.
///
/// # Errors
/// It would take more than 10⁸ cycles.
pub fn simulate(
    track: &Track,
    options: &Options,
    visit: &mut dyn FnMut(&Row),
) -> Result<Summary, Diagnostics> {
    let lengths: Vec<f64> = track.pieces.iter().map(whole_length).collect();
    let count: f64 = track.pieces.iter().zip(&lengths).map(|(p, l)| l / (p.feed * options.law.cycle)).sum();
    if !(count <= MOST_CYCLES) {
        let message = format!("at this feed and cycle time the path takes {count:.1e} cycles");
        return Err(Diagnostic::refusal("cycles-too-many", message)
            .hint("take a greater feed or cycle time")
            .into());
    }
    let limited = options.limits.any();
    let mut simulation = Simulation {
        track,
        options,
        visit,
        summary: Summary::new(track, limited),
        kinematics: Kinematics::new(options.law.cycle),
        blocks: BlockRate::new(track, options.block_time),
        t: 0.0,
        n: 0,
    };
    for event in &track.events {
        match event {
            Event::Run(range) => simulation.run(range.clone(), &lengths),
            Event::Rapid(moves) => match options.limits.rapid(moves) {
                Some(time) => {
                    simulation.t += time;
                    simulation.summary.rapid_time += time;
                }
                None => simulation.summary.rapids_without_time += 1,
            },
            Event::Dwell(seconds) => {
                simulation.t += seconds;
                simulation.summary.dwell_time += seconds;
            }
        }
    }
    Ok(simulation.finish(&lengths))
}

/// ∫ ‖c′‖ du over a piece: of polynomials and rational ones with an error bound, of others by the five-point rule on 64 parts.
fn whole_length(piece: &Piece<Shape>) -> f64 {
    if let Some(bezier) = piece.curve.piece() {
        return length(&bezier.segment(piece.from, piece.to), &piece.counts.0).mm;
    }
    let parts = if piece.curve.is_line() { 1 } else { 64 };
    let at = |i: i32| piece.from + (piece.to - piece.from) * f64::from(i) / f64::from(parts);
    (0..parts).map(|i| profile::length(&piece.curve, &piece.counts, at(i), at(i + 1))).sum()
}

struct Simulation<'t, 'v> {
    track: &'t Track,
    options: &'t Options,
    visit: &'v mut dyn FnMut(&Row),
    summary: Summary,
    kinematics: Kinematics,
    blocks: BlockRate<'t>,
    /// When the next run starts, s.
    t: f64,
    n: u64,
}

impl Simulation<'_, '_> {
    fn run(&mut self, range: Range<usize>, lengths: &[f64]) {
        let pieces = &self.track.pieces[range.clone()];
        let Some(first) = pieces.first() else { return };
        let start = first.curve.at(first.from);
        let stood = self.options.limits.acceleration.iter().any(|a| a.is_finite());
        self.kinematics.start(&start, range.start, stood);
        self.row(range.start, first.from, &start, None);
        let begun = self.t;
        if self.summary.limited {
            let planned = Planned::new(pieces, &self.options.limits, self.options.law);
            let mut times = vec![0.0; pieces.len()];
            for cell in &planned.profile().cells {
                times[cell.piece] += cell.time();
            }
            for (i, time) in times.into_iter().enumerate() {
                self.blocks.block(range.start + i, time, lengths[range.start + i]);
            }
            self.cycles(planned, range.start, begun, stood);
        } else {
            for i in range.clone() {
                self.blocks.block(i, lengths[i] / self.track.pieces[i].feed, lengths[i]);
            }
            self.cycles(Cycles::new(pieces, self.options.law), range.start, begun, stood);
        }
        self.blocks.close(range.end);
        self.summary.feed_time += self.t - begun;
    }

    fn cycles(&mut self, cycles: impl Iterator<Item = Cycle>, offset: usize, begun: f64, stood: bool) {
        let mut end = None;
        for (full, cycle) in cycles.enumerate() {
            // k T, not a sum of many T.
            let rest = cycle.time < self.options.law.cycle;
            self.t = begun + full as f64 * self.options.law.cycle + cycle.time;
            let piece = offset + cycle.piece;
            let place = self.track.places[piece];
            self.summary.cycles += 1;
            self.summary.feed_error.meet(cycle.feed_error.abs(), self.t, place);
            self.summary.chord_error.meet(cycle.chord_error * 1e-3, self.t, place);
            // Without limits the rest of a cycle is no whole one; with limits the axes come to a stand in it.
            if stood || !rest {
                self.kinematics.arrive(&cycle.at, piece, self.t, place, &mut self.summary.axes);
            }
            end = Some((piece, cycle.at));
            self.row(piece, cycle.u, &cycle.at, Some(&cycle));
        }
        if let (true, Some((piece, at))) = (stood, end) {
            for _ in 0..3 {
                let place = self.track.places[piece];
                self.kinematics.arrive(&at, piece, self.t, place, &mut self.summary.axes);
            }
        }
    }

    fn row(&mut self, piece: usize, u: f64, at: &Position, cycle: Option<&Cycle>) {
        let Piece { from, to, .. } = self.track.pieces[piece];
        let row = Row {
            n: self.n,
            t: self.t,
            u: piece as f64 + (u - from) / (to - from),
            at: *at,
            chord: cycle.map_or(0.0, |c| c.chord),
            feed_error: cycle.map_or(0.0, |c| c.feed_error),
            chord_error: cycle.map_or(0.0, |c| c.chord_error * 1e-3),
            piece,
            time: cycle.map_or(0.0, |c| c.time),
        };
        self.n += 1;
        (self.visit)(&row);
    }

    fn finish(self, lengths: &[f64]) -> Summary {
        let mut summary = self.summary;
        let (mut blocks, worst) = self.blocks.finish();
        if let (Some((first, last)), Some(starved)) = (worst, &mut blocks.starved) {
            starved.splines = instead(&self.track.pieces[first..=last], self.options.tolerance);
        }
        summary.length = lengths.iter().sum();
        summary.time = self.t;
        summary.blocks = blocks;
        summary
    }
}

/// As how many blocks `--fit` would write lines; none where they are no lines, or all of them would stay.
fn instead(pieces: &[Piece<Shape>], tolerance: f64) -> Option<usize> {
    let scale = pieces.first()?.surface.0.map(|weight| if weight == 0.0 { 1.0 } else { weight });
    let scaled = |p: Position| std::array::from_fn(|i| scale[i] * p[i]);
    let mut points: Vec<Position> = Vec::with_capacity(pieces.len() + 1);
    for piece in pieces {
        let Shape::Line(from, _) = piece.curve else { return None };
        points.push(scaled(from));
    }
    points.extend(pieces.last().map(|piece| scaled(piece.curve.at(piece.to))));
    let parts = smooth::parts(&points, smooth::Fitting { tolerance, corner: smooth::CORNER })?;
    let (mut from, mut blocks) = (0, 0);
    for part in &parts {
        blocks += match part {
            smooth::Part::Spline(spline, _) => spline.beziers().count(),
            smooth::Part::Lines(last) => last - from,
        };
        from = part.last();
    }
    Some(blocks)
}
