//! The fastest feed profile of a run that no axis is too slow for, with look-ahead over all its joints.
//!
//! Along the path s that F counts, axis i moves at x′ v and is accelerated by x″ v² + x′ dv/dt. A piece is cut into cells
//! no longer than a cycle's way, a line is one cell. In each cell, with the greatest |x′| and |x″| of five places in it:
//!
//! ```text
//! v ≤ min(F, Vᵢ/|xᵢ′|, √(0.7 Aᵢ/|xᵢ″|))          dv/dt ≤ min (Aᵢ − |xᵢ″| v²)/|xᵢ′|
//! ```
//!
//! so that at least 0.3 A is left for the way into and out of a bend; on a straight line all of it is. A thousandth of A is
//! kept in hand for what lies between the places looked at.
//!
//! **Joints.** Where the direction changes by Δx′ an axis' speed steps by v |Δx′|. Steps that fall within two cycles add up
//! in what a cycle shows, so the joint and those within the way of two cycles, 2T min(F, v + aT), are taken together:
//! v Σ|Δxᵢ′| ≤ the step allowed. Then from one cycle to the next no axis' speed changes by more than
//!
//! ```text
//! Aᵢ T                    and at a joint besides by what is allowed there
//! ```
//!
//! **Look-ahead**: one pass forward and one backward over the cells hold v² ≤ v₀² + 2as. In a cell the profile is a
//! trapezoid: up, level, down. Without any acceleration limit speeds step.

use super::limits::Limits;
use super::partition::{Parametric, Piece, Weights};
use super::shape::Shape;
use crate::units::{MAX_AXES, Position};

/// The share of an axis' acceleration that a bend may take.
const BEND: f64 = 0.7;

/// What is kept in hand of every limit.
const IN_HAND: f64 = 0.999;

/// Within a cell ‖c′‖ varies by no more than this factor.
const UNEVEN: f64 = 1.5;

/// A curved piece is halved at least this often.
const LEAST_HALVINGS: u32 = 3;

/// A piece is halved at most this often.
const MOST_HALVINGS: u32 = 20;

/// A stretch of a piece with one trapezoid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Which piece.
    pub piece: usize,
    /// Its first parameter.
    pub from: f64,
    /// Its last parameter.
    pub to: f64,
    /// Its length in what F counts.
    pub length: f64,
    /// The greatest speed.
    cap: f64,
    /// The acceleration along the path.
    acceleration: f64,
    /// The speed at its start.
    enter: f64,
    /// The speed at its end.
    leave: f64,
}

/// Abscissas and weights of the five-point rule of Gauss and Legendre on −1 … 1, exact to degree 9.
const GAUSS: [(f64, f64); 5] = [
    (0.0, 128.0 / 225.0),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
    (0.906_179_845_938_664, 0.236_926_885_056_189_08),
];

/// ∫ ‖c′‖ du between two parameters, by one step of the rule.
pub fn length(curve: &Shape, counts: &Weights, from: f64, to: f64) -> f64 {
    if let Shape::Line(_, by) = curve {
        return counts.norm(by) * (to - from);
    }
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let speed = |x: f64| counts.norm(&curve.jet(middle + half * x)[1]);
    GAUSS.iter().map(|(x, weight)| weight * speed(*x)).sum::<f64>() * half
}

/// x′ and x″ along the path; none where the curve stands still by the parameter.
fn along(piece: &Piece<Shape>, u: f64) -> Option<(Position, Position)> {
    let [_, rate, second] = piece.curve.jet(u);
    let speed = piece.counts.norm(&rate);
    let span = piece.to - piece.from;
    if !(1e-9 * piece.counts.norm(&second) * span < speed) {
        return None;
    }
    // x′ = c′/σ          x″ = (c″ − c′ (c′·c″)/σ²)/σ²          σ = ‖c′‖
    let square = speed * speed;
    let tangent = piece.counts.dot(&rate, &second) / square;
    let first = rate.map(|x| x / speed);
    Some((first, std::array::from_fn(|i| (second[i] - rate[i] * tangent) / square)))
}

/// The direction at an end of a piece: where it stands still there, that of a place nearby.
fn direction(piece: &Piece<Shape>, end: bool) -> Option<Position> {
    let span = piece.to - piece.from;
    let at = |share: f64| if end { piece.to - share * span } else { piece.from + share * span };
    [0.0, 1e-6, 1e-3].iter().find_map(|share| along(piece, at(*share))).map(|(first, _)| first)
}

/// The profile of a run.
#[derive(Clone, Debug, Default)]
pub struct Profile {
    /// Its cells, in order.
    pub cells: Vec<Cell>,
}

impl Profile {
    /// The profile of pieces that join, within limits, at cycles of `cycle` s.
    pub fn new(pieces: &[Piece<Shape>], limits: &Limits, cycle: f64) -> Profile {
        let mut cells = Vec::new();
        for (i, piece) in pieces.iter().enumerate() {
            cut(piece, i, limits, cycle, &mut cells);
        }
        let mut speeds = joints(pieces, &cells, limits, cycle);
        look_ahead(&cells, &mut speeds);
        for (i, cell) in cells.iter_mut().enumerate() {
            (cell.enter, cell.leave) = (speeds[i], speeds[i + 1]);
        }
        Profile { cells }
    }

    /// How long it takes, s.
    pub fn time(&self) -> f64 {
        self.cells.iter().map(Cell::time).sum()
    }
}

/// The greatest speed and acceleration along a piece that hold at these parameters.
fn caps(piece: &Piece<Shape>, at: &[f64], limits: &Limits) -> (f64, f64) {
    let mut steep: Position = [0.0; MAX_AXES];
    let mut bend: Position = [0.0; MAX_AXES];
    for u in at {
        let Some((first, second)) = along(piece, *u) else { continue };
        for axis in 0..MAX_AXES {
            steep[axis] = steep[axis].max(first[axis].abs());
            bend[axis] = bend[axis].max(second[axis].abs());
        }
    }
    let mut cap = piece.feed;
    for axis in 0..MAX_AXES {
        if steep[axis] != 0.0 {
            cap = cap.min(IN_HAND * limits.speed[axis] / steep[axis]);
        }
        if bend[axis] != 0.0 {
            cap = cap.min((BEND * IN_HAND * limits.acceleration[axis] / bend[axis]).sqrt());
        }
    }
    let mut acceleration = f64::INFINITY;
    for axis in (0..MAX_AXES).filter(|axis| steep[*axis] != 0.0 && limits.acceleration[*axis].is_finite()) {
        let left = IN_HAND * limits.acceleration[axis] - bend[axis] * cap * cap;
        acceleration = acceleration.min(left / steep[axis]);
    }
    (cap, acceleration)
}

/// Whether ‖c′‖ is nearly even at these parameters. Where it falls the path bends or turns sharply, and narrow places have
/// to be found before they can be looked at.
fn even(piece: &Piece<Shape>, at: &[f64]) -> bool {
    let speeds = at.iter().map(|u| piece.counts.norm(&piece.curve.jet(*u)[1]));
    let (least, most) = speeds.fold((f64::INFINITY, 0.0f64), |(a, b), x| (a.min(x), b.max(x)));
    most <= UNEVEN * least
}

/// Whether the shares of the limits that speed `cap` and `acceleration` take, |x′|v/V, |x″|v²/A and |x′|a/A, vary so
/// little over five even places that between them there is no more than half of what is kept in hand: a parabola rises
/// between such places by no more than a 16th of its range over them.
fn level(piece: &Piece<Shape>, at: &[f64; 5], limits: &Limits, (cap, acceleration): (f64, f64)) -> bool {
    let most = 16.0 * 0.5 * (1.0 - IN_HAND);
    let places: Vec<(Position, Position)> = at.iter().filter_map(|u| along(piece, *u)).collect();
    (0..MAX_AXES).all(|axis| {
        let shares = |(first, second): &(Position, Position)| {
            [
                first[axis].abs() * cap / limits.speed[axis],
                second[axis].abs() * cap * cap / limits.acceleration[axis],
                first[axis].abs() * acceleration / limits.acceleration[axis],
            ]
        };
        let (mut least, mut greatest) = ([f64::INFINITY; 3], [0.0f64; 3]);
        for place in &places {
            for (k, share) in shares(place).into_iter().enumerate() {
                // Without a limit on acceleration the last is ∞/∞; `min` and `max` pass over that.
                (least[k], greatest[k]) = (least[k].min(share), greatest[k].max(share));
            }
        }
        (0..3).all(|k| greatest[k] <= least[k] + most)
    })
}

/// Cuts a piece into cells: no longer than a cycle's way, ‖c′‖ nearly even, and so short that what the limits allow is
/// nearly level.
fn cut(piece: &Piece<Shape>, number: usize, limits: &Limits, cycle: f64, cells: &mut Vec<Cell>) {
    let straight = piece.curve.is_line();
    let mut stack = vec![(piece.from, piece.to, 0)];
    while let Some((from, to, depth)) = stack.pop() {
        let whole = length(&piece.curve, &piece.counts, from, to);
        let [first, middle, third] = [0.25, 0.5, 0.75].map(|share| from + share * (to - from));
        let (cap, acceleration) = if straight {
            caps(piece, &[from], limits)
        } else {
            let all = [from, first, middle, third, to];
            let found = caps(piece, &all, limits);
            let settled = LEAST_HALVINGS <= depth
                && whole <= piece.feed * cycle
                && even(piece, &all)
                && level(piece, &all, limits, found);
            if !settled && depth < MOST_HALVINGS {
                stack.push((middle, to, depth + 1));
                stack.push((from, middle, depth + 1));
                continue;
            }
            found
        };
        if whole != 0.0 {
            let cell =
                Cell { piece: number, from, to, length: whole, cap, acceleration, enter: 0.0, leave: 0.0 };
            cells.push(cell);
        }
    }
}

/// A joint of two pieces: before which cell, how far along the run, by how much each direction changes.
struct Joint {
    cell: usize,
    at: f64,
    change: Position,
}

/// The greatest speed before each cell and after the last.
fn joints(pieces: &[Piece<Shape>], cells: &[Cell], limits: &Limits, cycle: f64) -> Vec<f64> {
    let mut speeds = Vec::with_capacity(cells.len() + 1);
    let mut joints = Vec::new();
    let mut at = 0.0;
    // Where a run starts and ends the axes stand, unless they can step.
    let rest =
        |cell: Option<&Cell>| cell.map_or(0.0, |c| if c.acceleration.is_finite() { 0.0 } else { c.cap });
    speeds.push(rest(cells.first()));
    for i in 1..cells.len() {
        let (before, after) = (&cells[i - 1], &cells[i]);
        at += before.length;
        speeds.push(before.cap.min(after.cap));
        if before.piece == after.piece {
            continue;
        }
        let ends = (direction(&pieces[before.piece], true), direction(&pieces[after.piece], false));
        if let (Some(one), Some(other)) = ends {
            let change: Position = std::array::from_fn(|k| (other[k] - one[k]).abs());
            // Below the roundings of a direction there is no joint.
            if change.iter().any(|x| 1e-12 < *x) {
                joints.push(Joint { cell: i, at, change });
            }
        }
    }
    speeds.push(rest(cells.last()));
    let fastest = pieces.iter().map(|piece| piece.feed).fold(0.0, f64::max);
    let hardest = cells.iter().map(|cell| cell.acceleration).fold(0.0, f64::max);
    for k in 0..joints.len() {
        let mut cap = f64::INFINITY;
        for axis in (0..MAX_AXES).filter(|axis| limits.step[*axis].is_finite()) {
            cap = cap.min(together(&joints[k..], axis, IN_HAND * limits.step[axis], fastest, hardest, cycle));
        }
        if cap.is_infinite() {
            continue;
        }
        let reach = 2.0 * cycle * fastest.min(cap + hardest * cycle);
        for joint in joints[k..].iter().take_while(|joint| joint.at - joints[k].at <= reach) {
            speeds[joint.cell] = speeds[joint.cell].min(cap);
        }
    }
    speeds
}

/// The greatest v with v Σ|Δx′| ≤ `step`, summed over the joints within 2T min(`fastest`, v + `hardest` T) of the first.
fn together(joints: &[Joint], axis: usize, step: f64, fastest: f64, hardest: f64, cycle: f64) -> f64 {
    let mut sum = 0.0;
    // The speed from which on a joint counts.
    let counts_from = |joint: &Joint| {
        let way = joint.at - joints[0].at;
        if 2.0 * cycle * fastest < way { f64::INFINITY } else { way / (2.0 * cycle) - hardest * cycle }
    };
    for (m, joint) in joints.iter().enumerate() {
        sum += joint.change[axis];
        let next = joints.get(m + 1).map_or(f64::INFINITY, counts_from);
        let own = step / sum;
        if own <= next {
            // Below the speed from which this joint counts the ones before it were no bar.
            return if m == 0 { own } else { own.max(counts_from(joint)) };
        }
        if next.is_infinite() {
            break;
        }
    }
    f64::INFINITY
}

/// Holds v² ≤ v₀² + 2as forward and backward.
fn look_ahead(cells: &[Cell], speeds: &mut [f64]) {
    let reachable = |from: f64, cell: &Cell| (from * from + 2.0 * cell.acceleration * cell.length).sqrt();
    for i in 0..cells.len() {
        speeds[i + 1] = speeds[i + 1].min(reachable(speeds[i], &cells[i]));
    }
    for i in (0..cells.len()).rev() {
        speeds[i] = speeds[i].min(reachable(speeds[i + 1], &cells[i]));
    }
}

impl Cell {
    /// The greatest speed that is reached in it.
    fn peak(&self) -> f64 {
        let (enter, leave) = (self.enter, self.leave);
        let reached = (0.5 * (enter * enter + leave * leave) + self.acceleration * self.length).sqrt();
        // Rounding must not lift an end above the level.
        self.cap.min(reached).max(enter).max(leave)
    }

    /// Time and way of the three parts: up, level, down.
    fn parts(&self) -> [(f64, f64); 3] {
        let peak = self.peak();
        let ramp = |from: f64| {
            if self.acceleration.is_infinite() || peak <= from {
                (0.0, 0.0)
            } else {
                ((peak - from) / self.acceleration, (peak * peak - from * from) / (2.0 * self.acceleration))
            }
        };
        let (up, down) = (ramp(self.enter), ramp(self.leave));
        let level = (self.length - up.1 - down.1).max(0.0);
        [up, (level / peak, level), down]
    }

    /// How long it takes, s.
    pub fn time(&self) -> f64 {
        self.parts().iter().map(|(time, _)| time).sum()
    }

    /// The way after `time` s in it.
    pub fn way(&self, time: f64) -> f64 {
        let [up, level, down] = self.parts();
        let peak = self.peak();
        let way = if time < up.0 {
            time * (self.enter + 0.5 * self.acceleration * time)
        } else if time < up.0 + level.0 {
            up.1 + peak * (time - up.0)
        } else {
            // From the end, backward.
            let left = (up.0 + level.0 + down.0 - time).max(0.0);
            if down.0 == 0.0 {
                self.length
            } else {
                self.length - left * (self.leave + 0.5 * self.acceleration * left)
            }
        };
        way.clamp(0.0, self.length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    const XY: Weights = Weights([1.0, 1.0, 0.0, 0.0, 0.0, 0.0]);

    fn line(from: [f64; 2], to: [f64; 2]) -> Piece<Shape> {
        let at = |p: [f64; 2]| [p[0], p[1], 0.0, 0.0, 0.0, 0.0];
        Piece {
            curve: Shape::line(at(from), at(to)),
            from: 0.0,
            to: 1.0,
            feed: 100.0,
            counts: XY,
            surface: XY,
        }
    }

    fn limits(acceleration: f64, step: f64) -> Limits {
        let mut limits = Limits::NONE;
        for axis in 0..2 {
            // What is kept in hand is put on top here, so that closed forms come out.
            limits.acceleration[axis] = acceleration / IN_HAND;
            limits.step[axis] = step / IN_HAND;
        }
        limits
    }

    #[test]
    fn a_line_is_a_full_trapezoid_or_a_triangle() {
        // 50 mm at 100 mm/s and 1000 mm/s²: 0.5 + 0.1 s; 2.5 mm: 2√(2.5/1000).
        for (length, time) in [(50.0, 0.6), (2.5, 0.1)] {
            let profile = Profile::new(&[line([0.0, 0.0], [length, 0.0])], &limits(1000.0, 1.0), 1e-3);
            assert_eq!(profile.cells.len(), 1);
            assert_relative_eq!(profile.time(), time, max_relative = 1e-14);
        }
        let at = |time| {
            Profile::new(&[line([0.0, 0.0], [50.0, 0.0])], &limits(1000.0, 1.0), 1e-3).cells[0].way(time)
        };
        // ½at², then F(t − t₁/2), then the mirror of the start.
        assert_relative_eq!(at(0.05), 1.25, max_relative = 1e-14);
        assert_relative_eq!(at(0.3), 25.0, max_relative = 1e-14);
        assert_relative_eq!(at(0.55), 48.75, max_relative = 1e-14);
    }

    #[test]
    fn a_corner_is_slowed_to_its_step() {
        // A right angle changes both directions by 1: with a step of 5 mm/s it is met at 5 mm/s.
        let pieces = [line([0.0, 0.0], [50.0, 0.0]), line([50.0, 0.0], [50.0, 50.0])];
        let profile = Profile::new(&pieces, &limits(1000.0, 5.0), 1e-3);
        assert_relative_eq!(profile.cells[0].leave, 5.0, max_relative = 1e-14);
        // Each side: up from 0 to 100 and down to 5, (100 + 95)/1000 s on (10000 + 9975)/2000 mm.
        let side = 0.195 + (50.0 - 9.9875) / 100.0;
        assert_relative_eq!(profile.time(), 2.0 * side, max_relative = 1e-14);
    }

    #[test]
    fn joints_within_two_cycles_add_up() {
        // A zigzag of steps of 0.01 mm: X goes on, Y turns by 2 sin at every joint.
        let step = 0.01;
        let point = |i: i32| [step * f64::from(i), if i % 2 == 0 { 0.0 } else { step }];
        let pieces: Vec<_> = (0..200).map(|i| line(point(i), point(i + 1))).collect();
        let profile = Profile::new(&pieces, &limits(1000.0, 20.0), 1e-3);
        let fastest = profile.cells.iter().map(Cell::peak).fold(0.0, f64::max);
        // Each joint steps Y by √2 v. Two cycles go 2T(v + aT) and meet at least that/(√2·0.01) joints: at v mm/s the sum is
        // √2 v (1 + 0.002 (v + 1)/0.01414), which is 20 for v between 7 and 8.
        assert!(5.0 < fastest && fastest < 8.5, "{fastest}");
    }

    #[test]
    fn a_length_is_an_arc_length() {
        let piece = crate::geom::bezier::Bezier::new(&[
            [0.0; 6],
            [0.5, 0.0, 0.0, 0.0, 0.0, 0.0],
            [1.0, 1.0, 0.0, 0.0, 0.0, 0.0],
        ]);
        // The parabola y = x²: √5/2 + arsinh(2)/4.
        let arc = 0.5 * 5f64.sqrt() + 0.25 * 1.443_635_475_178_810_3;
        let shape = Shape::bezier(&piece);
        let sum: f64 = (0..8).map(|i| length(&shape, &XY, f64::from(i) / 8.0, f64::from(i + 1) / 8.0)).sum();
        assert_relative_eq!(sum, arc, max_relative = 1e-12);
    }
}
