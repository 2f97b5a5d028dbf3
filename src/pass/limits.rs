//! How fast each axis has to move, against what the machine file allows.
//!
//! F is the speed along the path of the axes that the machine file says it counts: the linear ones, or all with a degree
//! as a millimetre. On a piece with position x(t) and path speed L′ = √(ΣX′²) axis i moves at F · |x_i′|/L′. Pieces are halved until each part is a 32nd; there |x_i′| is bounded from
//! above and each X′ from below by Bernstein coefficients, so the figure is never too low.

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::geom::bernstein::Bernstein;
use crate::geom::bezier::Bezier;
use crate::ir::{Cut, Decimals, Step, Written};
use crate::machine::{Machine, RotaryFeed};
use crate::source::Span;
use crate::units::{Kind, MAX_AXES, Position};
use crate::verify::to_nurbs;

/// Each piece is looked at in 2⁵ parts.
const HALVINGS: u32 = 5;

/// The fastest that an axis was found to move, and where.
#[derive(Clone, Copy)]
struct Fastest {
    speed: f64,
    at: Position,
    feed: f64,
    span: Span,
}

/// A refusal for each axis that would have to move faster than it can.
pub fn speeds(decimals: &Decimals, machine: &Machine) -> Diagnostics {
    let axes = decimals.program.axes;
    let limited: Vec<(usize, f64)> =
        (0..axes.count()).filter_map(|i| Some((i, machine.limits(axes.name(i)).max_speed?))).collect();
    let mut found = Diagnostics::new();
    if limited.is_empty() {
        return found;
    }
    let mut fastest: [Option<Fastest>; MAX_AXES] = [None; MAX_AXES];
    for located in &decimals.program.steps {
        let Step::Cut(Cut { feed: Some(feed), curve, .. }) = &located.step else { continue };
        let feed = feed.to_f64();
        each_piece(decimals, curve, |piece| {
            for (axis, _) in &limited {
                let (speed, at) = axis_speed(decimals, machine, piece, *axis, feed);
                if fastest[*axis].is_none_or(|known| known.speed < speed) {
                    fastest[*axis] = Some(Fastest { speed, at, feed, span: located.span });
                }
            }
        });
    }
    for (axis, most) in limited {
        let Some(Fastest { speed, at, feed, span }) = fastest[axis].filter(|known| most < known.speed) else {
            continue;
        };
        let name = axes.name(axis);
        let (unit, turns) = match axes.kind(axis) {
            Kind::Linear | Kind::Direction => ("mm/min", String::new()),
            Kind::Rotary => ("degrees/min", format!(" ({:.1} rev/min)", speed / 360.0)),
        };
        let message = format!(
            "{name} would have to move at {speed:.0} {unit}{turns} at {} {:.3}; machine `{}` allows {most}",
            axes.name(0),
            at[0],
            machine.name
        );
        let hint =
            format!("a feed of {:.3} mm/min would hold it", (feed * most / speed * 1.0e3).floor() / 1.0e3);
        found.push(Diagnostic::refusal("axis-speed", message).at(span, "").hint(hint));
    }
    found
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

/// An upper bound of an axis' speed on a piece, and the start of the part where it is reached. A block that
/// moves no linear axis runs at F in the rotary one.
fn axis_speed(
    decimals: &Decimals,
    machine: &Machine,
    piece: &Bezier,
    axis: usize,
    feed: f64,
) -> (f64, Position) {
    let axes = decimals.program.axes;
    // Of a rational piece N/D: N′D − ND′, since all axes share the D² below it and only their ratio counts.
    let below = (!piece.is_polynomial()).then(|| piece.denominator());
    let derivative = |i: usize| {
        let n = piece.numerator(i);
        match &below {
            None => n.derivative(),
            Some(d) => n.derivative().times(d).combined(1.0, &n.times(&d.derivative()), -1.0),
        }
    };
    let counts = |i: &usize| axes.kind(*i) == Kind::Linear || machine.rotary_feed == RotaryFeed::DegreesAsMm;
    let linear: Vec<Bernstein> = (0..axes.count()).filter(counts).map(derivative).collect();
    let own = derivative(axis);
    if own.max_abs() == 0.0 {
        return (0.0, piece.start());
    }
    if linear.iter().all(|x| x.max_abs() == 0.0) {
        return (feed, piece.start());
    }
    let depth = if piece.degree == 1 { 0 } else { HALVINGS };
    let mut worst = (0.0, 0.0);
    let mut stack = vec![(own, linear, 0.0, 0u32)];
    while let Some((own, linear, t, level)) = stack.pop() {
        if level == depth {
            let least = |x: &Bernstein| x.min().max(-x.max()).max(0.0);
            let path = linear.iter().map(|x| least(x) * least(x)).sum::<f64>().sqrt();
            let speed = feed * own.max_abs() / path;
            if worst.0 < speed {
                worst = (speed, t);
            }
            continue;
        }
        let (left, right) = own.halves();
        let halves: Vec<(Bernstein, Bernstein)> = linear.iter().map(Bernstein::halves).collect();
        let width = 0.5 / f64::from(1u32 << level);
        stack.push((left, halves.iter().map(|half| half.0).collect(), t, level + 1));
        stack.push((right, halves.iter().map(|half| half.1).collect(), t + width, level + 1));
    }
    (worst.0, piece.eval(worst.1))
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
            // The feed that is named holds.
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
        assert_eq!(ids("extends = \"sinumerik\"\n[axis.A]\nkind = \"modulo\"\n"), ["rotary-wraps"]);
        assert_eq!(ids("extends = \"sinumerik\"\n[axis.X]\nmax = 25\n"), ["axis-range", "rotary-range"]);
        assert_eq!(ids("extends = \"sinumerik\"\n[axis.Q]\nmax = 25\n"), ["axis-unknown"]);
    }
}
