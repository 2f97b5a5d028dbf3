//! How fast each axis has to move and to speed up, against what the machine file allows.
//!
//! F is the speed along the path of the axes that the machine file says it counts: the linear ones, or all with a degree
//! as a millimetre. On a piece with position x(t) and path speed L′ = √(ΣX′²) axis i moves, F being constant, at
//!
//! ```text
//! v_i = F x_i′/L′          a_i = F² (x_i″ L′² − x_i′ ΣX′X″)/L′⁴
//! ```
//!
//! Pieces are halved until each part is a 32nd; there the derivatives are bounded from above and L′ from below by
//! Bernstein coefficients, so that no figure is too low. Where F counts mm at the surface, the rotary axis' share of L′ is
//! left out, and the figures are too high rather than too low. Starts, stops and corners are not in it.

use crate::decimal::{Decimal, power_of_ten};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::geom::bernstein::Bernstein;
use crate::geom::bezier::Bezier;
use crate::ir::{Cut, Decimals, Written, WrittenPoints};
use crate::machine::{Machine, RotaryFeed};
use crate::source::Span;
use crate::units::{Kind, MAX_AXES, Position};
use crate::verify::{to_arc, to_nurbs};

/// Each piece is looked at in 2⁵ parts.
const HALVINGS: u32 = 5;

/// The most that was found of something, and where.
#[derive(Clone, Copy)]
struct Most {
    amount: f64,
    at: Position,
    span: Span,
}

/// A figure for each axis, where it has one.
type Figures = [Option<Most>; MAX_AXES];

/// A refusal for each axis that would have to move or to speed up faster than it can.
pub(super) fn check(decimals: &Decimals, machine: &Machine) -> Diagnostics {
    let axes = decimals.program.axes;
    let limits = |i: usize| machine.limits(axes.name(i));
    let limited: Vec<usize> = (0..axes.count())
        .filter(|i| limits(*i).max_speed.is_some() || limits(*i).max_acceleration.is_some())
        .collect();
    let mut found = Diagnostics::new();
    if limited.is_empty() {
        return found;
    }
    let (speeds, accelerations) = figures(decimals, machine, &limited);
    for axis in limited {
        let name = axes.name(axis);
        let unit = match axes.kind(axis) {
            Kind::Linear | Kind::Direction => "mm",
            Kind::Rotary => "degrees",
        };
        let place =
            |most: &Most| format!("at {} {:.3}; machine `{}` allows", axes.name(0), most.at[0], machine.name);
        if let (Some(most), Some(allowed)) = (speeds[axis], limits(axis).max_speed)
            && allowed < most.amount
        {
            let turns = match axes.kind(axis) {
                Kind::Linear | Kind::Direction => String::new(),
                Kind::Rotary => format!(" ({:.1} rev/min)", most.amount / 360.0),
            };
            let message = format!(
                "{name} would have to move at {:.0} {unit}/min{turns} {} {allowed}",
                most.amount,
                place(&most)
            );
            // Rounded down, so that the figure named holds.
            let share = (allowed / most.amount * 1.0e4).floor() / 100.0;
            found.push(
                Diagnostic::refusal("axis-speed", message)
                    .at(most.span, "")
                    .hint(format!("{share} percent of this feed would hold it")),
            );
        }
        if let (Some(most), Some(allowed)) = (accelerations[axis], limits(axis).max_acceleration)
            && allowed < most.amount
        {
            let message = format!(
                "{name} would have to speed up by {:.1} {unit}/s² inside a block {} {allowed}",
                most.amount,
                place(&most)
            );
            // It grows with the square of the feed.
            let share = ((allowed / most.amount).sqrt() * 1.0e4).floor() / 100.0;
            found.push(
                Diagnostic::refusal("axis-acceleration", message)
                    .at(most.span, "")
                    .hint(format!("{share} percent of this feed would hold it")),
            );
        }
    }
    found
}

/// The greatest speed of each axis at feed, mm/min or degrees/min.
pub fn greatest_speeds(decimals: &Decimals, machine: &Machine) -> [f64; MAX_AXES] {
    let all: Vec<usize> = (0..decimals.program.axes.count()).collect();
    figures(decimals, machine, &all).0.map(|most| most.map_or(0.0, |most| most.amount))
}

/// The greatest speeds and accelerations of some axes.
fn figures(decimals: &Decimals, machine: &Machine, wanted: &[usize]) -> (Figures, Figures) {
    let mut speeds: Figures = [None; MAX_AXES];
    let mut accelerations: Figures = [None; MAX_AXES];
    let counts = counts(decimals, machine);
    let take = |figures: &mut Figures, axis: usize, most: Most| {
        if figures[axis].is_none_or(|known| known.amount < most.amount) {
            figures[axis] = Some(most);
        }
    };
    for located in &decimals.program.steps {
        let Some(Cut { feed, curve, .. }) = located.step.cut() else { continue };
        let span = located.span;
        if let Written::Lines(line) = curve
            && !line.rates.is_empty()
        {
            for &axis in wanted {
                take(&mut speeds, axis, timed(decimals, line, axis, span));
            }
            continue;
        }
        let Some(feed) = feed.map(Decimal::to_f64) else { continue };
        if let Written::Lines(line) | Written::Through(_, line) = curve {
            let shares = steepest(decimals, line, &counts);
            for &axis in wanted {
                let (share, block) = shares[axis];
                let at = match block.checked_sub(1) {
                    None => decimals.position(&line.start),
                    Some(before) => {
                        line.points().nth(before).map_or([0.0; MAX_AXES], |p| decimals.position(&p))
                    }
                };
                take(&mut speeds, axis, Most { amount: feed * share, at, span });
            }
            continue;
        }
        if let Written::Arc(arc) = curve {
            let Some(meant) = to_arc(decimals, arc) else { continue };
            let [u, v, w] = meant.frame().axes();
            for &axis in wanted.iter().filter(|axis| **axis < 3) {
                // Each axis of the plane may have the whole of F, and v²/R towards the centre; of a plane that is tilted the
                // share that the axis has in it.
                let at = decimals.position(&arc.start);
                let most = |amount| Most { amount, at, span };
                let within = (u[axis] * u[axis] + v[axis] * v[axis]).sqrt();
                if within != 0.0 {
                    take(&mut speeds, axis, most(feed * within));
                    let toward = (feed / 60.0) * (feed / 60.0) / meant.radius();
                    take(&mut accelerations, axis, most(toward * within));
                }
                if w[axis] != 0.0 && arc.start[axis] != arc.end[axis] && within != 1.0 {
                    take(&mut speeds, axis, most(feed));
                }
            }
            continue;
        }
        each_piece(decimals, curve, |piece| {
            for &axis in wanted {
                let (speed, acceleration) = of_piece(&counts, piece, axis, feed);
                let most = |(amount, t)| Most { amount, at: piece.eval(t), span };
                take(&mut speeds, axis, most(speed));
                take(&mut accelerations, axis, most(acceleration));
            }
        });
    }
    (speeds, accelerations)
}

/// The greatest speed of an axis where each line has its time.
fn timed(decimals: &Decimals, line: &WrittenPoints, axis: usize, span: Span) -> Most {
    let mut most = Most { amount: 0.0, at: decimals.position(&line.start), span };
    let mut from = most.at;
    for (point, rate) in line.points().zip(&line.rates) {
        let to = decimals.position(&point);
        let amount = (to[axis] - from[axis]).abs() * rate.to_f64();
        if most.amount < amount {
            most = Most { amount, at: from, span };
        }
        from = to;
    }
    most
}

/// Of each axis the greatest share of a line's way, and the line: its way by that of the axes that F counts. A line that
/// moves none of those runs at F.
fn steepest(decimals: &Decimals, line: &WrittenPoints, counts: &[usize]) -> [(f64, usize); MAX_AXES] {
    let units: [f64; MAX_AXES] = std::array::from_fn(|i| 1.0 / power_of_ten(decimals.digits[i]) as f64);
    let mut counted = [0.0; MAX_AXES];
    for i in counts {
        counted[*i] = 1.0;
    }
    // Squares are compared, and only the greatest are taken the root of.
    let mut greatest = [(0.0, 0); MAX_AXES];
    let mut from: &[i64] = &line.start;
    for (block, to) in line.units.chunks_exact(line.stride).enumerate() {
        let mut squares = [0.0; MAX_AXES];
        let mut path = 0.0;
        for (i, (to, from)) in to.iter().zip(from).enumerate() {
            let way = (to - from) as f64 * units[i];
            squares[i] = way * way;
            path += counted[i] * squares[i];
        }
        for (greatest, square) in greatest.iter_mut().zip(&squares[..to.len()]) {
            let share = if path == 0.0 { f64::from(*square != 0.0) } else { square / path };
            if greatest.0 < share {
                *greatest = (share, block);
            }
        }
        from = to;
    }
    greatest.map(|(share, block)| (f64::sqrt(share), block))
}

/// The axes that F counts.
fn counts(decimals: &Decimals, machine: &Machine) -> Vec<usize> {
    let axes = decimals.program.axes;
    let counts = |i: &usize| axes.kind(*i) == Kind::Linear || machine.rotary_feed == RotaryFeed::DegreesAsMm;
    (0..axes.count()).filter(counts).collect()
}

/// Every piece of a curve in decimals.
pub(super) fn each_piece(decimals: &Decimals, curve: &Written, mut visit: impl FnMut(&Bezier)) {
    match curve {
        Written::Lines(line) | Written::Through(_, line) => {
            let mut from = decimals.position(&line.start);
            for point in line.points() {
                let to = decimals.position(&point);
                visit(&Bezier::line(from, to));
                from = to;
            }
        }
        // It is no polynomial.
        Written::Arc(_) => {}
        Written::Polynomial(polynomial) => {
            let mut start = polynomial.start;
            for block in &polynomial.blocks {
                visit(&block.to_bezier(&decimals.digits, &start));
                start = block.end;
            }
        }
        Written::Nurbs(nurbs) => {
            if let Ok(spline) = to_nurbs(decimals, nurbs) {
                spline.beziers().for_each(|(piece, _)| visit(&piece));
            }
        }
    }
}

/// The derivatives of a piece on one interval of t.
#[derive(Clone)]
struct Derivatives {
    own: Bernstein,
    own_second: Bernstein,
    /// Of each axis that F counts, the first and the second.
    path: Vec<(Bernstein, Bernstein)>,
    t: f64,
    level: u32,
}

impl Derivatives {
    fn halves(&self) -> [Derivatives; 2] {
        let (own, second) = (self.own.halves(), self.own_second.halves());
        let path: Vec<_> = self.path.iter().map(|(x, y)| (x.halves(), y.halves())).collect();
        let level = self.level + 1;
        let width = 1.0 / f64::from(1u32 << level);
        [
            Derivatives {
                own: own.0,
                own_second: second.0,
                path: path.iter().map(|(x, y)| (x.0, y.0)).collect(),
                t: self.t,
                level,
            },
            Derivatives {
                own: own.1,
                own_second: second.1,
                path: path.iter().map(|(x, y)| (x.1, y.1)).collect(),
                t: self.t + width,
                level,
            },
        ]
    }
}

/// Upper bounds of an axis' speed (a minute) and acceleration (a second squared) on a polynomial piece, and t where
/// the part begins in which each is reached. A block that moves no axis that F counts runs at F in the others.
fn of_piece(counts: &[usize], piece: &Bezier, axis: usize, feed: f64) -> ((f64, f64), (f64, f64)) {
    let derivatives = |i: usize| {
        let first = piece.numerator(i).derivative();
        (first, first.derivative())
    };
    let path: Vec<(Bernstein, Bernstein)> = counts.iter().map(|i| derivatives(*i)).collect();
    let (own, own_second) = derivatives(axis);
    if own.max_abs() == 0.0 {
        return ((0.0, 0.0), (0.0, 0.0));
    }
    if path.iter().all(|(x, _)| x.max_abs() == 0.0) {
        return ((feed, 0.0), (0.0, 0.0));
    }
    let depth = if piece.degree == 1 { 0 } else { HALVINGS };
    let (mut speed, mut acceleration) = ((0.0, 0.0), (0.0, 0.0));
    let mut stack = vec![Derivatives { own, own_second, path, t: 0.0, level: 0 }];
    while let Some(part) = stack.pop() {
        if part.level < depth {
            stack.extend(part.halves());
            continue;
        }
        let least = |x: &Bernstein| x.min().max(-x.max()).max(0.0);
        let square = part.path.iter().map(|(x, _)| least(x) * least(x)).sum::<f64>();
        let across = part.path.iter().map(|(x, y)| x.max_abs() * y.max_abs()).sum::<f64>();
        let fast = feed * part.own.max_abs() / square.sqrt();
        // mm/min becomes mm/s.
        let feed = feed / 60.0;
        let quick = feed * feed * (part.own_second.max_abs() + part.own.max_abs() * across / square) / square;
        if speed.0 < fast {
            speed = (fast, part.t);
        }
        if acceleration.0 < quick {
            acceleration = (quick, part.t);
        }
    }
    (speed, acceleration)
}

#[cfg(test)]
mod tests {
    use crate::diagnostic::Diagnostics;
    use crate::machine::Machine;
    use crate::source::{Source, SourceId, Sources};
    use crate::{Options, compile, front};

    fn refusals(machine: &str, motion: &str, cutter: &str, feed: f64) -> Diagnostics {
        let text = format!(
            "name = \"CONE\"\n[cutter]\n{cutter}\n[process]\nfeed = {feed}\nretract = {{ axis = \"Z\", to = 50 }}\n"
        );
        let machine = match Machine::parse(machine, SourceId::INPUT) {
            Ok(machine) => machine,
            Err(errors) => return errors,
        };
        let options = Options { motion: machine.dialect.motion(motion), ..Options::default() };
        let sources = Sources::new(Source::new("t", text));
        compile(&sources, &front::LANGUAGES[0], &machine, &options)
            .map_or_else(|f| f.diagnostics, |o| o.warnings)
    }

    const SMALL: &str = "D1 = 0.5\nS = 60\nC = 5\nr = 8\nlength = 5";

    #[test]
    fn a_small_cutter_asks_a_hundred_turns_a_minute() {
        // k/√(1 + tan²C(1 + sin²r)) = 6.9282/1.00389 rad/mm at X = 0; at 100 mm/min that is 109.8 rev/min.
        let machine = "extends = \"sinumerik\"\n[axis.A]\nmax_speed = 21600\n";
        for motion in ["poly", "bspline", "linear", "aspline"] {
            let found = refusals(machine, motion, SMALL, 100.0);
            let refusal = found
                .0
                .iter()
                .find(|d| d.id == "axis-speed")
                .unwrap_or_else(|| panic!("{motion}: {found:?}"));
            assert!(refusal.message.contains("rev/min) at X 0.000"), "{}", refusal.message);
            let turns: f64 = refusal
                .message
                .split(['(', ' '])
                .find_map(|w| w.parse().ok().filter(|x| *x < 200.0))
                .unwrap();
            // Bounds are never too low, and splitting in 32 keeps them within some percent.
            let true_turns = if motion == "linear" || motion == "aspline" { 100.0 } else { 109.8 };
            assert!((true_turns..116.0).contains(&turns), "{motion}: {turns}");
            // The share of the feed that is named holds.
            let feed: f64 = refusal.hints[0].split(' ').find_map(|w| w.parse().ok()).unwrap();
            assert!(
                refusals(machine, motion, SMALL, feed).0.iter().all(|d| d.id != "axis-speed"),
                "{motion}"
            );
        }
    }

    #[test]
    fn ranges_and_wraps_are_refused_with_the_reason() {
        let ids = |machine: &str| -> Vec<&str> {
            refusals(machine, "poly", "D1 = 10\nS = 30\nC = 5\nr = 8\nlength = 30\nflutes = 4", 200.0)
                .0
                .iter()
                .map(|d| d.id)
                .collect()
        };
        assert_eq!(
            ids("extends = \"sinumerik\"\n[axis.A]\nmin = -3600\nmax = 3600\nmax_speed = 3600\n"),
            ["rotary-range"]
        );
        // Counted from its index, each flute stays within 0 to 360.
        assert_eq!(ids("extends = \"sinumerik\"\n[axis.A]\nkind = \"modulo\"\n"), [""; 0]);
        assert_eq!(ids("extends = \"sinumerik\"\n[axis.X]\nmax = 25\n"), ["axis-range", "rotary-range"]);
        assert_eq!(ids("extends = \"sinumerik\"\n[axis.Q]\nmax = 25\n"), ["axis-unknown"]);
    }
}
