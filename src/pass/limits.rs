//! How fast each axis has to move and to speed up, against what the machine file allows.
//!
//! F is the speed along the path of the axes that the machine file says it counts: the linear ones, or all with a degree
//! as a millimetre. On a piece with position x(t) and path speed L′ = √(ΣX′²) axis i moves, F being constant, at
//!
//! ```text
//! v_i = F x_i′/L′          a_i = F² (x_i″ L′² − x_i′ ΣX′X″)/L′⁴
//! ```
//!
//! Pieces are halved until each part is a 32nd, and on where that says too little; there the derivatives are bounded from above and L′ from below by
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
            if most.amount == f64::INFINITY {
                let message = format!(
                    "{name} would have to move while all axes that F counts stand, {} {allowed} {unit}/min",
                    place(&most)
                );
                found.push(Diagnostic::refusal("axis-speed", message).at(most.span, ""));
                continue;
            }
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
            if most.amount == f64::INFINITY {
                let message = format!(
                    "{name} would have to turn a corner inside a block at F, {} {allowed} {unit}/s²",
                    place(&most)
                );
                found.push(Diagnostic::refusal("axis-acceleration", message).at(most.span, ""));
                continue;
            }
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

/// The greatest speed of each axis at feed, mm/min or degrees/min; none where nothing bounds it, since it moves where all axes
/// that F counts stand.
pub fn greatest_speeds(decimals: &Decimals, machine: &Machine) -> [Option<f64>; MAX_AXES] {
    let all: Vec<usize> = (0..decimals.program.axes.count()).collect();
    let amount = |most: Option<Most>| most.map_or(0.0, |most| most.amount);
    figures(decimals, machine, &all).0.map(|most| Some(amount(most)).filter(|speed| speed.is_finite()))
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

/// The derivatives of a piece on one interval of t: u = N′D − ND′, and u′.
#[derive(Clone)]
struct Derivatives {
    own: Bernstein,
    own_second: Bernstein,
    /// Of each axis that F counts, the first and the second.
    path: Vec<(Bernstein, Bernstein)>,
    /// D, what u was divided by, and so on: what divides L′.
    below: Bernstein,
    t: f64,
    level: u32,
}

/// Halving stops here.
const DEEPEST: u32 = 30;

/// And here: each further part is taken as it is.
const MOST_PARTS: u32 = 512;

/// A part is halved beyond [`HALVINGS`] where its bound is above what was seen of the piece by more than this factor.
const LOOSE: f64 = 1.25;

/// A share of F that is not worth a closer look.
const LITTLE: f64 = 0.01;

impl Derivatives {
    fn halves(&self) -> [Derivatives; 2] {
        let (own, second) = (self.own.halves(), self.own_second.halves());
        let path: Vec<_> = self.path.iter().map(|(x, y)| (x.halves(), y.halves())).collect();
        let below = self.below.halves();
        let level = self.level + 1;
        let width = 1.0 / f64::from(1u32 << level);
        [
            Derivatives {
                own: own.0,
                own_second: second.0,
                path: path.iter().map(|(x, y)| (x.0, y.0)).collect(),
                below: below.0,
                t: self.t,
                level,
            },
            Derivatives {
                own: own.1,
                own_second: second.1,
                path: path.iter().map(|(x, y)| (x.1, y.1)).collect(),
                below: below.1,
                t: self.t + width,
                level,
            },
        ]
    }

    /// Upper bounds of speed and acceleration on the part, F being 1 mm/s; infinite where nothing bounds them.
    fn bounds(&self) -> (f64, f64) {
        let least = |x: &Bernstein| x.min().max(-x.max()).max(0.0);
        let square = self.path.iter().map(|(x, _)| least(x) * least(x)).sum::<f64>();
        let across = self.path.iter().map(|(x, y)| x.max_abs() * y.max_abs()).sum::<f64>();
        let own = self.own.max_abs();
        let below = self.below.max_abs();
        let second = below * below * (self.own_second.max_abs() + own * across / square) / square;
        (own / square.sqrt(), second)
    }

    /// The speed at the start of the part, F being 1; 0 where it is not known.
    fn seen(&self) -> f64 {
        let square = self.path.iter().map(|(x, _)| x.start() * x.start()).sum::<f64>();
        let speed = self.own.start().abs() / square.sqrt();
        if speed.is_finite() { speed } else { 0.0 }
    }
}

/// Whether all control points lie on one line, in the axes given: then the axes keep their speed at F.
fn is_straight(piece: &Bezier, axes: &[usize]) -> bool {
    let points = piece.control_points();
    let way = |p: &Position| -> Vec<f64> { axes.iter().map(|i| p[*i] - points[0][*i]).collect() };
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let ways: Vec<Vec<f64>> = points.iter().map(way).collect();
    let longest = ways.iter().max_by(|a, b| dot(a, a).total_cmp(&dot(b, b)));
    let Some(longest) = longest else { return true };
    let size = dot(longest, longest);
    // To rounding: a part in 10¹² of the longest way.
    ways.iter().all(|way| {
        let share = dot(way, longest) / size;
        let off: f64 = way.iter().zip(longest).map(|(x, l)| (x - share * l) * (x - share * l)).sum();
        off <= 1.0e-24 * size
    })
}

/// Upper bounds of an axis' speed (a minute) and acceleration (a second squared) on a piece, and t where the part begins in
/// which each is reached. A block that moves no axis that F counts runs at F in the others. With D the denominator and
/// u = N′D − ND′ of each axis, x′ = u/D²:
///
/// ```text
/// v_i = F u_i/|u|          a_i = F² D² (u_i′ − u_i u·u′/u²)/u²
/// ```
///
/// Where the piece stands at its start or end, t or 1 − t divides every u there, and is left out of v. An axis that F counts
/// is never faster than F. Infinite is what nothing bounds: another axis that moves where those stand.
fn of_piece(counts: &[usize], piece: &Bezier, axis: usize, feed: f64) -> ((f64, f64), (f64, f64)) {
    let mut piece = *piece;
    let greatest = piece.weights[..=piece.degree].iter().copied().fold(0.0, f64::max);
    piece.weights.iter_mut().for_each(|w| *w /= greatest);
    let d = piece.denominator();
    let polynomial = piece.is_polynomial();
    let derivative = |i: usize| {
        let n = piece.numerator(i);
        if polynomial {
            return n.derivative();
        }
        n.derivative().times(&d).combined(1.0, &n.times(&d.derivative()), -1.0)
    };
    let mut own = derivative(axis);
    let mut path: Vec<Bernstein> = counts.iter().map(|i| derivative(*i)).collect();
    let rests = |i: usize| piece.control_points().iter().all(|p| p[i] == piece.points[0][i]);
    if rests(axis) {
        return ((0.0, 0.0), (0.0, 0.0));
    }
    if counts.iter().all(|i| rests(*i)) {
        return ((feed, 0.0), (0.0, 0.0));
    }
    let mut below = if polynomial { Bernstein::new(&[1.0]) } else { d };
    // L′ is |u|/D², so that what is taken out of u divides 1/L′ too; its square root stands for it in `below`, and is 0 where
    // the piece stands, which leaves its acceleration without a bound unless it is straight.
    let mut stands = false;
    for at_end in [false, true] {
        while std::iter::once(&own)
            .chain(&path)
            .all(|u| 0 < u.degree() && (if at_end { u.end() } else { u.start() }) == 0.0)
        {
            stands = true;
            own = own.without_root(at_end);
            for u in &mut path {
                *u = u.without_root(at_end);
            }
        }
    }
    let mut moving: Vec<usize> = counts.to_vec();
    moving.push(axis);
    let straight = is_straight(&piece, &moving);
    if stands {
        below = Bernstein::new(&[f64::INFINITY]);
    }
    let counted = counts.contains(&axis);
    let with_second = |u: Bernstein| (u, u.derivative());
    let path: Vec<_> = path.into_iter().map(with_second).collect();
    let depth = if piece.degree == 1 { 0 } else { HALVINGS };
    let (mut speed, mut acceleration) = ((0.0, 0.0), (0.0, 0.0));
    let (mut seen, mut parts) = (0.0f64, 0);
    let own_second = own.derivative();
    let mut stack = vec![Derivatives { own, own_second, path, below, t: 0.0, level: 0 }];
    while let Some(part) = stack.pop() {
        seen = seen.max(part.seen());
        let (mut fast, mut quick) = part.bounds();
        // A quotient of nothing by nothing bounds nothing either.
        fast = if fast.is_nan() { f64::INFINITY } else { fast };
        quick = if quick.is_nan() { f64::INFINITY } else { quick };
        if counted {
            fast = fast.min(1.0);
        }
        if straight {
            quick = 0.0;
        }
        let loose = LOOSE * seen.max(LITTLE) < fast || (quick == f64::INFINITY && !stands);
        if part.level < depth || (loose && depth != 0 && part.level < DEEPEST && parts < MOST_PARTS) {
            parts += 1;
            let [first, last] = part.halves();
            stack.push(last);
            stack.push(first);
            continue;
        }
        if speed.0 < fast {
            speed = (fast, part.t);
        }
        if acceleration.0 < quick {
            acceleration = (quick, part.t);
        }
    }
    // mm/min becomes mm/s.
    let (a_minute, a_second) = (feed, feed / 60.0);
    ((a_minute * speed.0, speed.1), (a_second * a_second * acceleration.0, acceleration.1))
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
