//! Feeds that mean what was asked: F for every stretch of a path.
//!
//! What was asked is a speed of one [`Measure`] (mm along X Y Z, along the edge, along X, or degrees of A); F counts
//! another on a control that counts degrees of A too. With m the rate of what was asked per mm of X, n that of what F
//! counts, M and N what passes of each over a stretch, the stretch takes the time M / feed when
//!
//! ```text
//! F = feed · N / M          the speed at X is then  feed · e(X),   e = (N/M) · m(X)/n(X)
//! ```
//!
//! m/n is monotone in X for every pair of measures, since each rate is of the form √(c² + (k qⁿ)²) with q = 1 + βX. So |e − 1| is greatest at
//! an end of the stretch. Where it is greater than the machine file's `error`, the path is cut into the fewest stretches
//! of equal ratio of m/n that hold it.

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::geom::elementary::ln_1p;
use crate::geom::logcurve::{LogCurve, Measure};
use crate::geom::{self, bezier::Bezier};
use crate::ir::{Curve, Cut, Intent, Logarithmic, Polyline, Role, Step};
use crate::machine::{Machine, RotaryFeed};
use crate::units::{Axes, DEGREES, Kind, Position};

/// The most stretches of one path.
const MAX_STRETCHES: usize = 1000;

/// A part of a path that has one F.
#[derive(Clone, Debug, PartialEq)]
pub struct Stretch {
    /// The part.
    pub path: Logarithmic,
    /// F, per minute; none where no feed was asked for.
    pub feed: Option<f64>,
    /// The greatest |e − 1| on it.
    pub error: f64,
}

/// What F counts on a machine.
pub fn counted(machine: &Machine) -> Measure {
    match machine.rotary_feed {
        RotaryFeed::Free => Measure::Path,
        RotaryFeed::DegreesAsMm => Measure::PathAndDegrees,
        RotaryFeed::Surface => Measure::Edge,
        // What lines count is time; other blocks move linear axes only.
        RotaryFeed::InverseTime => Measure::Path,
    }
}

/// F of any other curve, whose feed is mm/min along its linear axes, and how far the speed is from that inside it, as a share:
/// such a curve is one stretch. Where no linear axis moves, the feed is that of what does.
pub fn of_curve(curve: &Curve, feed: f64, axes: &Axes, machine: &Machine, radius: f64) -> (f64, f64) {
    let turns = axes.as_slice().iter().any(|(_, kind)| *kind == Kind::Rotary);
    let each = weight(machine, radius);
    if !turns || each == 0.0 {
        return (feed, 0.0);
    }
    let pieces = curve.pieces();
    let linear: f64 = pieces.iter().map(|piece| linear_length(piece, axes)).sum();
    let counted: f64 = pieces.iter().map(|piece| length(piece, axes, each)).sum();
    if linear == 0.0 || counted == linear {
        return (feed, 0.0);
    }
    let mean = counted / linear;
    let mut error = 0.0f64;
    for piece in &pieces {
        for i in 0..=PARTS {
            let t = f64::from(i) / f64::from(PARTS);
            let e = mean * speed(piece, axes, 0.0, t) / speed(piece, axes, each, t);
            error = error.max((e - 1.0).abs());
        }
    }
    (feed * mean, error)
}

/// What is said of the curve whose speed varies most, where that is more than the machine file's `error`: such curves are
/// not cut for their feed.
pub fn varying(intent: &Intent, machine: &Machine) -> Diagnostics {
    let radius = intent.radius();
    let mut worst = (machine.feed_error, None);
    for located in &intent.program.steps {
        let Step::Cut(Cut { feed: Some(feed), role: Role::Path, curve }) = &located.step else { continue };
        if matches!(curve, Curve::Logarithmic(_)) {
            continue;
        }
        let (_, error) = of_curve(curve, *feed, &intent.program.axes, machine, radius);
        if worst.0 < error {
            worst = (error, Some(located.span));
        }
    }
    let mut warnings = Diagnostics::new();
    if let (error, Some(span)) = worst {
        let message = format!(
            "along this curve the speed is up to {:.1} percent off what was asked: F counts its rotary axes too",
            100.0 * error
        );
        let hint = format!(
            "a curve has one F: state several shorter ones, or let it be with error = {} under [feed] of the machine file",
            (100.0 * error).ceil() / 100.0
        );
        warnings.push(Diagnostic::warning("feed-varies", message).at(span, "").hint(hint));
    }
    warnings
}

/// What a degree counts on a machine, mm.
fn weight(machine: &Machine, radius: f64) -> f64 {
    match machine.rotary_feed {
        RotaryFeed::Free | RotaryFeed::InverseTime => 0.0,
        RotaryFeed::DegreesAsMm => 1.0,
        RotaryFeed::Surface => radius / DEGREES,
    }
}

/// At how many places of a piece its speed is looked at, less one.
const PARTS: i32 = 16;

/// The length of a piece as F counts it. A block that moves nothing that F counts runs at F in its rotary axes, in degrees.
pub fn counted_length(piece: &Bezier, axes: &Axes, machine: &Machine, radius: f64) -> f64 {
    match length(piece, axes, weight(machine, radius)) {
        0.0 => rotary_length(piece, axes),
        counted => counted,
    }
}

/// The length of a piece in the linear axes, mm.
pub fn linear_length(piece: &Bezier, axes: &Axes) -> f64 {
    length(piece, axes, 0.0)
}

/// How much of what a feed that is asked for is a speed of passes along a curve: mm of the linear axes; where these rest,
/// what F counts of the others.
pub fn amount(curve: &Curve, axes: &Axes, machine: &Machine, radius: f64) -> f64 {
    match curve {
        Curve::Logarithmic(log) => log.curve.amount(log.along),
        Curve::Arc(arc) => arc.length(),
        Curve::Lines(line) | Curve::Through(_, line) => amount_of_lines(line, axes, machine, radius),
        Curve::Polynomial(_) | Curve::Nurbs(_) | Curve::Formula(_) => {
            let pieces = curve.pieces();
            match pieces.iter().map(|piece| linear_length(piece, axes)).sum::<f64>() {
                0.0 => pieces.iter().map(|piece| counted_length(piece, axes, machine, radius)).sum(),
                linear => linear,
            }
        }
    }
}

/// The same of lines, each for itself.
pub fn amount_of_lines(line: &Polyline, axes: &Axes, machine: &Machine, radius: f64) -> f64 {
    let of = |kind: Kind| -> Vec<usize> { (0..axes.count()).filter(|i| axes.kind(*i) == kind).collect() };
    let (linear, rotary) = (of(Kind::Linear), of(Kind::Rotary));
    // A degree where F counts none is one.
    let degree = match weight(machine, radius) {
        0.0 => 1.0,
        weight => weight,
    };
    let way = |axes: &[usize], from: &Position, to: &Position| {
        axes.iter().map(|i| (to[*i] - from[*i]) * (to[*i] - from[*i])).sum::<f64>().sqrt()
    };
    let mut from = line.start;
    let each = |to: Position| {
        let from = std::mem::replace(&mut from, to);
        match way(&linear, &from, &to) {
            0.0 => degree * way(&rotary, &from, &to),
            linear => linear,
        }
    };
    line.points().map(each).sum()
}

/// How far the rotary axes go along a piece, degrees.
pub fn rotary_length(piece: &Bezier, axes: &Axes) -> f64 {
    geom::length::length(piece, &scale(axes, 0.0, 1.0)).mm
}

fn length(piece: &Bezier, axes: &Axes, degree: f64) -> f64 {
    geom::length::length(piece, &scale(axes, 1.0, degree)).mm
}

/// What each axis counts, a millimetre and a degree counting so much.
fn scale(axes: &Axes, mm: f64, degree: f64) -> Position {
    std::array::from_fn(|i| match axes.as_slice().get(i) {
        Some((_, Kind::Linear)) => mm,
        Some((_, Kind::Rotary)) => degree,
        Some((_, Kind::Direction)) | None => 0.0,
    })
}

/// |x′(t)| with a degree counted as so many millimetres.
fn speed(piece: &Bezier, axes: &Axes, degree: f64, t: f64) -> f64 {
    let [_, d, _] = piece.derivatives(t);
    let square = |i: usize| match axes.kind(i) {
        Kind::Linear => d[i] * d[i],
        Kind::Rotary => degree * d[i] * degree * d[i],
        Kind::Direction => 0.0,
    };
    (0..axes.count()).map(square).sum::<f64>().sqrt()
}

/// How often a minute the way between two X could be made at a feed: F under inverse time. One interval of Simpson's rule,
/// since a line is short.
pub fn rate(path: &Logarithmic, feed: f64, from: f64, to: f64) -> f64 {
    let at = |x: f64| path.curve.rate(path.along, x);
    6.0 * feed / ((to - from).abs() * (at(from) + 4.0 * at(0.5 * (from + to)) + at(to)))
}

/// The stretches of a path, in the order of X. `whole` asks for one, where a form cannot be cut.
pub fn stretches(path: &Logarithmic, feed: Option<f64>, whole: bool, machine: &Machine) -> Vec<Stretch> {
    let curve = &path.curve;
    let pair = (path.along, counted(machine));
    let Some(feed) = feed else {
        return vec![Stretch { path: path.clone(), feed: None, error: 0.0 }];
    };
    let part = |from: f64, to: f64| {
        // Both ends lie on the path, so that the range is a sound one.
        let curve = curve.with_range(from, to).unwrap_or(*curve);
        let mean = curve.amount(pair.1) / curve.amount(pair.0);
        let error = [curve.start(), curve.end()].map(|x| (mean * ratio(&curve, pair, x) - 1.0).abs());
        let path = Logarithmic { curve, ..path.clone() };
        Stretch { path, feed: Some(feed * mean), error: error[0].max(error[1]) }
    };
    if machine.rotary_feed == RotaryFeed::InverseTime && path.curve.k() != 0.0 {
        return vec![Stretch { path: path.clone(), feed: Some(feed), error: 0.0 }];
    }
    if whole || pair.0 == pair.1 {
        return vec![part(curve.start(), curve.end())];
    }
    let mut n = 1;
    loop {
        let breaks = breaks(curve, pair, n);
        let parts: Vec<Stretch> = breaks.windows(2).map(|pair| part(pair[0], pair[1])).collect();
        let holds = parts.iter().all(|part| part.error <= machine.feed_error);
        if holds || MAX_STRETCHES <= n {
            return parts;
        }
        n += 1;
    }
}

/// The stretch that a step belongs to, by the X of its end.
pub fn stretch_of(stretches: &[Stretch], x: f64) -> usize {
    // A step that ends a rounding behind the end of a stretch still belongs to it.
    stretches.iter().position(|stretch| x <= stretch.path.curve.end() + 1.0e-9).unwrap_or(stretches.len() - 1)
}

/// m/n at X.
fn ratio(curve: &LogCurve, (asked, counted): (Measure, Measure), x: f64) -> f64 {
    curve.rate(asked, x) / curve.rate(counted, x)
}

/// The ends of `n` stretches of equal ratio of m/n: bisection on a monotone function.
fn breaks(curve: &LogCurve, pair: (Measure, Measure), n: usize) -> Vec<f64> {
    let (start, end) = (curve.start(), curve.end());
    let at = |x: f64| ln_1p(ratio(curve, pair, x) - 1.0);
    let (first, last) = (at(start), at(end));
    let mut breaks = vec![start];
    for i in 1..n {
        let wanted = first + (last - first) * i as f64 / n as f64;
        let (mut low, mut high) = (start, end);
        // Forty halvings of some metres are a few picometres.
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if (at(middle) < wanted) == (first < last) {
                low = middle;
            } else {
                high = middle;
            }
        }
        let next = 0.5 * (low + high);
        if breaks.last().is_some_and(|known| *known < next) && next < end {
            breaks.push(next);
        }
    }
    breaks.push(end);
    breaks
}

/// What is wrong with the feed of a path: it cannot be counted.
///
/// # Errors
/// A does not turn and the feed is one of A.
pub fn check(path: &Logarithmic, feed: Option<f64>) -> Result<(), Diagnostics> {
    if feed.is_some() && path.along == Measure::A && path.curve.k() == 0.0 {
        let message = "a feed in degrees of A is asked for, and A does not turn: the flute is straight";
        return Err(Diagnostic::error("feed-along", message).into());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::logcurve::tests::paper;
    use crate::ir::Method;
    use crate::source::SourceId;

    fn path(along: Measure) -> Logarithmic {
        let curve = LogCurve::new(paper(), 0.0).unwrap();
        Logarithmic { curve, method: Method::Direct, dl: None, overrun: false, back: false, along }
    }

    fn machine(rotary: &str, error: f64) -> Machine {
        let text = format!("extends = \"sinumerik\"\n[feed]\nrotary = \"{rotary}\"\nerror = {error}\n");
        Machine::parse(&text, SourceId::INPUT).unwrap()
    }

    #[test]
    fn every_stretch_takes_the_time_that_was_asked() {
        for along in [Measure::Path, Measure::Edge, Measure::X, Measure::A, Measure::PathAndDegrees] {
            for rotary in ["free", "degrees-as-mm", "surface"] {
                let machine = machine(rotary, 0.02);
                let path = path(along);
                let parts = stretches(&path, Some(200.0), false, &machine);
                let minutes: f64 = parts
                    .iter()
                    .map(|part| part.path.curve.amount(counted(&machine)) / part.feed.unwrap())
                    .sum();
                let asked = path.curve.amount(along) / 200.0;
                // Simpson's rule is right to some 1e-8.
                approx::assert_relative_eq!(minutes, asked, max_relative = 1.0e-7);
                assert!(parts.iter().all(|part| part.error <= 0.02), "{along:?} {rotary}");
                // Between the ends the error is no greater: the ratio is monotone.
                for part in &parts {
                    let curve = &part.path.curve;
                    let mean = part.feed.unwrap() / 200.0;
                    for i in 0..=20 {
                        let x = curve.start() + (curve.end() - curve.start()) * f64::from(i) / 20.0;
                        let e = mean * ratio(curve, (along, counted(&machine)), x) - 1.0;
                        assert!(e.abs() <= part.error + 1.0e-12, "{along:?} {rotary} {x}");
                    }
                }
            }
        }
    }

    #[test]
    fn one_stretch_is_enough_where_the_counts_agree() {
        // dA/dX falls from k to k/1.525 over the paper's cutter, and with degrees as mm so does the speed, nearly.
        let counts = [("free", 1), ("surface", 1), ("degrees-as-mm", 5)];
        for (rotary, count) in counts {
            let machine = machine(rotary, 0.05);
            assert_eq!(
                stretches(&path(Measure::Path), Some(200.0), false, &machine).len(),
                count,
                "{rotary}"
            );
            let whole = stretches(&path(Measure::Path), Some(200.0), true, &machine);
            assert_eq!(whole.len(), 1);
        }
    }
}
