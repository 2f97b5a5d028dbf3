//! Arcs cut into what one block takes; and those that a control has no word for, as lines.

use crate::dialect::{ArcKind, ArcWord};
use crate::geom::arc::Arc;
use crate::geom::elementary;
use crate::ir::Polyline;
use crate::machine::Machine;

/// The most that an arc by a place on the way turns, radians: 300 degrees. Its three places are then never nearer to each
/// other than the radius, or than a half of the arc.
const MOST_BY_WAY: f64 = 5.0 / 3.0 * std::f64::consts::PI;

/// How near to a whole number of turns, as a share of one, an arc of several ends over its start: the place of its end would
/// hardly tell a turn from none.
const OVER: f64 = 0.01;

/// The rise, mm, below which an arc in a plane that is none of the machine's is flat: its axis is a rounded number, so that
/// it always has some.
const FLAT: f64 = 0.002;

/// The rise, mm, below which an arc in a plane of the machine is flat: what a turned frame leaves of none.
const ROUNDED: f64 = 1.0e-9;

/// What kind of arc this is to the words of a control.
pub fn kind(arc: &Arc) -> ArcKind {
    let slack = if arc.plane().is_some() { ROUNDED } else { FLAT };
    ArcKind { plane: arc.plane(), helix: slack < arc.rise().abs(), turns: 1.0 + 1.0e-9 < arc.turns() }
}

/// The word that a machine has for an arc; none where it becomes lines, among them where the tip of the tool is led and
/// nothing says that arcs go with that.
pub fn word(arc: &Arc, machine: &Machine) -> Option<ArcWord> {
    let led = machine.axes.direction().is_some();
    (machine.dialect.arcs.word)(kind(arc), machine).filter(|_| !led || machine.orientation.arcs)
}

/// The arcs that one block each takes.
pub fn blocks(arc: &Arc, word: ArcWord, machine: &Machine) -> Vec<Arc> {
    let parts = |n: f64| {
        let share = |i: u32| f64::from(i) / n;
        (0..n as u32).map(|i| arc.part(share(i), share(i + 1))).collect()
    };
    let most = machine.dialect.arcs.most_turns;
    match word {
        ArcWord::Way => parts((arc.sweep().abs() / MOST_BY_WAY - 1.0e-9).ceil().max(1.0)),
        ArcWord::Turn => arc.by_turns(most),
        ArcWord::Center if most == 1 => arc.by_turns(1),
        ArcWord::Center => arc.by_turns(most).into_iter().flat_map(beside_start).collect(),
    }
}

/// An arc of several turns that ends over its start leaves its last half to another.
fn beside_start(arc: Arc) -> Vec<Arc> {
    let turns = arc.turns();
    if turns <= 1.0 + OVER || OVER < (turns - turns.round()).abs() {
        return vec![arc];
    }
    let last = 1.0 - 0.5 / turns;
    vec![arc.part(0.0, last), arc.part(last, 1.0)]
}

/// The longest chord turns by this, radians: a quarter.
const LONGEST: f64 = std::f64::consts::FRAC_PI_2;

/// The most lines of one arc.
const MOST: f64 = 1.0e6;

/// Points so near to each other that chords between them stay within `tolerance` mm of the arc. A chord that turns by δ
/// is farthest in its middle:
///
/// ```text
/// R (1 − cos(δ/2)) = 2R sin²(δ/4) ≤ R δ²/8
/// ```
/// `stride` is how many coordinates the program has.
pub fn lines(arc: &Arc, stride: usize, tolerance: f64) -> Polyline {
    let delta = (8.0 * tolerance / arc.radius()).sqrt().min(LONGEST);
    let count = (arc.sweep().abs() / delta).ceil().clamp(1.0, MOST);
    let mut line = Polyline::new(arc.start(), stride);
    for i in 1..count as usize {
        line.push(&arc.eval(i as f64 / count));
    }
    line.push(&arc.end());
    line
}

/// How far chords that turn by `delta` radians stay from an arc of `radius` mm, mm: its sagitta, and along the arc the
/// difference between the place on the chord and that on the arc at equal shares, δ − 2 sin(δ/2) of the radius at most.
pub fn sagitta(radius: f64, delta: f64) -> f64 {
    let quarter = elementary::sin(0.25 * delta);
    radius * (2.0 * quarter * quarter + (delta - 2.0 * elementary::sin(0.5 * delta)).max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::arc::{Plane, Sense};

    #[test]
    fn chords_hold_the_tolerance() {
        let at = |x, y, z| [x, y, z, 0.0, 0.0, 0.0];
        let arc = Arc::new(Plane::Xy, Sense::Clockwise, at(10.0, 0.0, 0.0), at(10.0, 0.0, -3.0), [0.0, 0.0])
            .unwrap();
        for tolerance in [1.0, 0.01, 0.0001] {
            let line = lines(&arc, 3, tolerance);
            let count = line.count();
            let mut from = line.start;
            let mut worst = 0.0f64;
            for (i, to) in line.points().enumerate() {
                for k in 0..=10 {
                    let s = f64::from(k) / 10.0;
                    let on = arc.eval((i as f64 + s) / count as f64);
                    let p = [0, 1, 2].map(|j| from[j] + s * (to[j] - from[j]) - on[j]);
                    worst = worst.max((p[0] * p[0] + p[1] * p[1] + p[2] * p[2]).sqrt());
                }
                from = to;
            }
            let bound = sagitta(arc.radius(), arc.sweep().abs() / count as f64);
            // The bound adds what is across and what is along, which are never greatest at one place.
            assert!(worst <= bound && bound < 1.6 * tolerance, "{tolerance}: {worst} {bound}");
            assert!(0.2 * tolerance < worst || tolerance == 1.0, "{tolerance}: {worst}");
        }
    }

    /// What one block takes of an arc of so many turns: by its centre, as a control takes several turns or not, by a place on
    /// the way, or by an angle.
    #[test]
    fn blocks_tell_turns_apart() {
        let at = |x: f64, y: f64, z: f64| [x, y, z, 0.0, 0.0, 0.0];
        let turns = |machine: &str, word: ArcWord, turns: f64| {
            let machine = Machine::built_in(machine).unwrap();
            let angle = turns.fract() * std::f64::consts::TAU;
            let end = at(10.0 * elementary::cos(angle), 10.0 * elementary::sin(angle), -turns);
            let end = if turns.fract() == 0.0 { at(10.0, 0.0, -turns) } else { end };
            let once =
                Arc::new(Plane::Xy, Sense::CounterClockwise, at(10.0, 0.0, 0.0), end, [0.0, 0.0]).unwrap();
            let more = (turns - once.turns()).round() as u32;
            let parts = blocks(&once.with_turns(more), word, &machine);
            assert!(parts.windows(2).all(|pair| pair[0].end() == pair[1].start()));
            parts.iter().map(|part| (part.turns() * 1000.0).round() / 1000.0).collect::<Vec<f64>>()
        };
        let (sinumerik, mazak, heidenhain) = ("sinumerik", "mazak", "heidenhain");
        assert_eq!(turns(sinumerik, ArcWord::Center, 1.0), [1.0]);
        assert_eq!(turns(sinumerik, ArcWord::Center, 2.25), [2.25]);
        assert_eq!(turns(sinumerik, ArcWord::Center, 2.0), [1.5, 0.5]);
        assert_eq!(turns(sinumerik, ArcWord::Center, 2.001), [1.501, 0.5]);
        assert_eq!(turns(sinumerik, ArcWord::Center, 1000.5), [998.5, 0.5, 1.5]);
        assert_eq!(turns(mazak, ArcWord::Center, 2.25), [1.0, 1.0, 0.25]);
        assert_eq!(turns(mazak, ArcWord::Center, 2.0), [1.0, 1.0]);
        assert_eq!(turns(heidenhain, ArcWord::Turn, 15.0), [15.0]);
        assert_eq!(turns(heidenhain, ArcWord::Turn, 15.25), [15.0, 0.25]);
        assert_eq!(turns(sinumerik, ArcWord::Way, 0.75), [0.75]);
        assert_eq!(turns(sinumerik, ArcWord::Way, 0.9), [0.45, 0.45]);
        assert_eq!(turns(sinumerik, ArcWord::Way, 1.0), [0.5, 0.5]);
        assert_eq!(turns(sinumerik, ArcWord::Way, 2.0), [0.667, 0.667, 0.667]);
    }
}
