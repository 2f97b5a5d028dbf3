//! What a person at the machine must know before the start: where zero is, how far each axis goes and how fast, how long
//! it takes, what the control needs, and what nobody has proved.

use crate::decimal::Decimal;
use crate::dialect::Form;
use crate::dialect::parts::Assigned;
use crate::geom::direction;
use crate::geom::rotation::Rotation;
use crate::ir::{Auxiliary, Decimals, Intent, Role, Step, Units, Written};
use crate::machine::remark::{taken, wrapped};
use crate::machine::{Machine, Moves, PlaneApproach, RotaryFeed, Turn};
use crate::pass::check::moving;
use crate::pass::stretch::amount;
use crate::pass::{limits, range};
use crate::units::{DEGREES, Kind};
use serde::Serialize;

/// The figures of a program on one machine.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Setup {
    /// Where zero is; none where the input does not say.
    pub zero: Option<String>,
    /// How far and how fast each axis goes.
    pub axes: Vec<AxisFigures>,
    /// The least and the greatest angle of the tool to Z, degrees, in five axes and in tilted planes.
    pub tilt: Option<[f64; 2]>,
    /// How tilted planes are approached, where there are some; then ranges are counted in each of them.
    pub planes: Option<PlaneApproach>,
    /// Where rotary axes go evenly between two directions: how far that leaves the great circle at most, degrees.
    pub turn: Option<f64>,
    /// Where rapids are clear: an axis and its place.
    pub clear: Option<(String, f64)>,
    /// Axes that retract in machine coordinates.
    pub home: Vec<String>,
    /// What ends the length of the last tool; none where no word of its own does.
    pub length_end: Option<LengthEnd>,
    /// How many paths there are: flutes times passes.
    pub paths: usize,
    /// How long a path takes at the feed that was asked for, minutes: from the shortest to the longest.
    pub path_minutes: Option<[f64; 2]>,
    /// What the control has for the speed of axes that F does not count, where the program moves some with others that it counts.
    pub free_axes: Option<String>,
    /// What the program's parameters are.
    pub parameters: Vec<String>,
    /// What the control needs beside its basic functions.
    pub needs: Vec<String>,
    /// What the proof does not cover.
    pub not_covered: Vec<String>,
}

/// What becomes of the length of the last tool on a control where ending it may move an axis.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum LengthEnd {
    /// It ends at the park place: the axes and their homes.
    Parked(Vec<(String, f64)>),
    /// It stays in force, for want of such a place.
    Left,
}

/// How far and how fast an axis goes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AxisFigures {
    /// Its name.
    pub axis: String,
    /// `mm` or `degrees`.
    pub unit: &'static str,
    /// Its least and greatest position as the text counts it, mm or degrees; none where it does not move.
    pub range: Option<[f64; 2]>,
    /// Its greatest speed at feed, mm/min or degrees/min; none where it moves while all axes that F counts stand, which
    /// bounds nothing.
    pub speed: Option<f64>,
    /// Whether it moves the work and not the wheel.
    pub moves_work: bool,
}

impl Setup {
    /// The figures of what was asked and of what is written.
    pub fn new(intent: &Intent, decimals: &Decimals, machine: &Machine) -> Setup {
        let axes = decimals.program.axes;
        let extents = range::counted_extents(decimals, machine);
        let speeds = limits::greatest_speeds(decimals, machine);
        let places = axes.direction().unwrap_or(axes.count());
        let figures = (0..places).map(|i| {
            let (low, high) = extents[i];
            AxisFigures {
                axis: axes.name(i).to_string(),
                unit: match axes.kind(i) {
                    Kind::Linear | Kind::Direction => "mm",
                    Kind::Rotary => "degrees",
                },
                range: (low <= high).then_some([low, high]),
                speed: speeds[i],
                moves_work: machine.limits(axes.name(i)).moves == Moves::Work,
            }
        });
        let steps = || intent.program.steps.iter().map(|located| &located.step);
        let retracts = |axis: usize| intent_retracts(intent, axis);
        let home = steps().filter_map(|step| match step {
            Step::Home(axis) => retracts(*axis).then(|| axes.name(*axis).to_string()),
            Step::Comment(_)
            | Step::Tool(_)
            | Step::Spindle(_)
            | Step::Coolant
            | Step::Shift(_)
            | Step::Auxiliary(_)
            | Step::Rapid(_)
            | Step::Cut(_) => None,
        });
        let mut home: Vec<String> = home.collect();
        home.dedup();
        let paths = steps().filter_map(|step| step.cut()).filter(|cut| cut.role == Role::Path);
        let radius = intent.radius();
        let minutes: Vec<f64> =
            paths.filter_map(|cut| Some(amount(&cut.curve, &axes, machine, radius) / cut.feed?)).collect();
        let range = minutes.iter().fold(None, |range: Option<[f64; 2]>, m| {
            Some(range.map_or([*m, *m], |[least, most]| [least.min(*m), most.max(*m)]))
        });
        Setup {
            zero: zero(intent),
            axes: figures.collect(),
            tilt: tilt(decimals, machine),
            planes: decimals.program.has_planes().then_some(machine.orientation.plane_approach),
            turn: (machine.orientation.turn == Turn::Tilt).then(|| departure(decimals)).flatten(),
            clear: clear(intent),
            home,
            length_end: length_end(intent, machine),
            paths: minutes.len(),
            path_minutes: range,
            free_axes: free_axes(decimals, machine),
            parameters: parameters(decimals, machine),
            needs: needs(decimals, machine),
            not_covered: not_covered(intent),
        }
    }

    /// The remarks behind the header, none where the machine file wants none.
    pub fn remarks(&self, machine: &Machine) -> Vec<String> {
        if !machine.frame.setup {
            return Vec::new();
        }
        self.lines().iter().flat_map(|line| wrapped(&taken(line, &machine.text), machine)).collect()
    }

    fn lines(&self) -> Vec<String> {
        let short = |x: f64, digits: u8| Decimal::round(x, digits).unwrap_or_default().to_string();
        let mut lines = Vec::new();
        if let Some(zero) = &self.zero {
            lines.push(format!("ZERO: {zero}"));
        }
        let ranges: Vec<String> = self
            .axes
            .iter()
            .filter_map(|figures| {
                let [low, high] = figures.range?;
                Some(format!("{} {} TO {}", figures.axis, short(low, 3), short(high, 3)))
            })
            .collect();
        let counted = if self.planes.is_some() { "RANGE, COUNTED IN EACH PLANE" } else { "RANGE" };
        lines.push(format!("{counted}: {}", ranges.join(", ")));
        if let Some([least, most]) = self.tilt {
            lines.push(format!("TOOL AXIS: {} TO {} DEGREES FROM Z", short(least, 3), short(most, 3)));
        }
        match self.planes {
            Some(PlaneApproach::Over) => {
                lines.push(
                    "PLANES ARE APPROACHED X Y FIRST, THEN Z: THE TABLE MUST TILT, NOT THE HEAD".to_owned(),
                );
            }
            Some(PlaneApproach::Together) => {
                lines.push("PLANES ARE APPROACHED X Y Z TOGETHER IN A STRAIGHT LINE FROM HOME".to_owned());
            }
            None => {}
        }
        if let Some((axis, to)) = &self.clear {
            let home = if self.home.is_empty() {
                String::new()
            } else {
                format!(", HOME OF {} AT TOOL CHANGE AND END", self.home.join(" "))
            };
            lines.push(format!("CLEAR: {axis} {}{home}", short(*to, 3)));
        }
        match &self.length_end {
            None => {}
            Some(LengthEnd::Parked(axes)) => {
                let places: Vec<String> =
                    axes.iter().map(|(axis, to)| format!("{axis} {}", short(*to, 3))).collect();
                lines.push(format!("PARK PLACE AT THE END, OF THE MACHINE: {}", places.join(", ")));
            }
            Some(LengthEnd::Left) => {
                lines.push("LENGTH OF THE LAST TOOL STAYS IN FORCE".to_owned());
            }
        }
        if let Some([least, most]) = self.path_minutes {
            let (least, most) = (short(least, 3), short(most, 3));
            let minutes = if least == most { least } else { format!("{least} TO {most}") };
            let paths = if self.paths == 1 { "PATH" } else { "PATHS" };
            lines.push(format!("TIME: {} {paths} OF {minutes} MIN", self.paths));
        }
        let speeds: Vec<String> = self
            .axes
            .iter()
            .filter(|figures| figures.speed != Some(0.0))
            .map(|figures| match figures.speed {
                Some(speed) => format!("{} {}", figures.axis, short(speed, 0)),
                None => format!("{} AS FAST AS IT CAN", figures.axis),
            })
            .collect();
        if !speeds.is_empty() {
            lines.push(format!("FASTEST AT FEED, MM OR DEGREES A MINUTE: {}", speeds.join(", ")));
        }
        let work: Vec<&str> = self
            .axes
            .iter()
            .filter(|figures| figures.moves_work)
            .map(|figures| figures.axis.as_str())
            .collect();
        if !work.is_empty() {
            lines.push(format!("THE WORK MOVES WITH: {}", work.join(" ")));
        }
        if let Some(free) = &self.free_axes {
            lines.push(free.clone());
        }
        if !self.parameters.is_empty() {
            lines.push(format!("PARAMETERS: {}", self.parameters.join(", ").to_uppercase()));
        }
        if !self.needs.is_empty() {
            lines.push(format!("NEEDS: {}", self.needs.join(", ").to_uppercase()));
        }
        lines.push(format!("{LAST_REMARK} {}", self.not_covered.join(", ").to_uppercase()));
        lines
    }
}

/// Whether an axis retracts where a tool is changed or the program ends, and does not only park then.
fn intent_retracts(intent: &Intent, axis: usize) -> bool {
    let steps = &intent.program.steps;
    let homes = |from: usize| {
        steps[from..].iter().take_while(|located| matches!(located.step, Step::Home(_))).count()
    };
    steps.iter().enumerate().any(|(i, located)| {
        let parks =
            || steps.get(i + homes(i)).is_some_and(|next| next.step == Step::Auxiliary(Auxiliary::LengthEnd));
        // The first of them retracts, and the others park.
        let first = i == 0 || !matches!(steps[i - 1].step, Step::Home(_));
        located.step == Step::Home(axis) && (first || !parks())
    })
}

/// What becomes of the length of the last tool.
fn length_end(intent: &Intent, machine: &Machine) -> Option<LengthEnd> {
    let calls = intent.program.steps.iter().any(|located| matches!(located.step, Step::Tool(_)))
        && machine.calls_length();
    let led = intent.program.axes.direction().is_some();
    if !machine.frame.length_end_moves || !(calls || led) {
        return None;
    }
    let ends = Step::Auxiliary(if led { Auxiliary::TipControlEnd } else { Auxiliary::LengthEnd });
    let park = machine.park().filter(|_| intent.program.steps.iter().any(|located| located.step == ends));
    let place = |axis: usize| {
        Some((machine.axes.name(axis).to_string(), machine.limits(machine.axes.name(axis)).home?))
    };
    Some(match park {
        Some([_, x, y]) => LengthEnd::Parked([x, y].into_iter().filter_map(place).collect()),
        None => LengthEnd::Left,
    })
}

/// What is to be seen to where F is the speed of the linear axes alone, and others go along: where those hardly move only the
/// control's own data say how fast the others may be.
fn free_axes(decimals: &Decimals, machine: &Machine) -> Option<String> {
    let data = machine.dialect.free_axes.filter(|_| machine.rotary_feed == RotaryFeed::Free)?;
    let axes = decimals.program.axes;
    let cuts = decimals.program.steps.iter().filter_map(|located| located.step.cut());
    let moved: Vec<usize> = cuts.flat_map(|cut| moving(&cut.curve)).collect();
    let named = |kind: Kind| {
        let all = (0..axes.count())
            .filter(|i| axes.kind(*i) == kind && (kind == Kind::Linear || moved.contains(i)));
        all.map(|i| axes.name(i).to_string()).collect::<Vec<_>>().join(" ")
    };
    let free = named(Kind::Rotary);
    let linear = named(Kind::Linear);
    (!free.is_empty()).then(|| {
        format!("F COUNTS {linear} ALONE: {data} SAYS HOW FAST {free} MAY BE WHERE THESE HARDLY MOVE, 3 IS ADVISED")
    })
}

/// How the last of the remarks that say what to set up begins.
pub const LAST_REMARK: &str = "NOT PROVED:";

/// Where zero is: a cutter's path starts there.
fn zero(intent: &Intent) -> Option<String> {
    let (log, ..) = intent.logarithmic().next()?;
    let axes = intent.program.axes;
    let [x, y, z, a] = [0, 1, 2, 3].map(|i| axes.name(i));
    let d1 = Decimal::round(log.curve.cutter().d1, 4).unwrap_or_default();
    Some(format!("{x} WHERE THE DIAMETER IS D1 {d1}, {y} {z} CONTACT THERE, {a} THE INDEX OF THE CUTTER"))
}

/// All that a proof may not cover.
const NOT_COVERED: [&str; 5] = [
    "smoothing and compressor of the control",
    "radius and profile of the wheel",
    "where the rotary axes go and what they meet there",
    "that the tool turns between blocks as the machine file says",
    "how far the axes of the machine go in tilted planes",
];

/// What the proof does not cover.
fn not_covered(intent: &Intent) -> Vec<String> {
    let [smoothing, wheel, rotary, turning, axes] = NOT_COVERED;
    let (led, tilted) = (intent.program.axes.direction().is_some(), intent.program.has_planes());
    let all = [
        (smoothing, true),
        (wheel, intent.logarithmic().next().is_some()),
        (rotary, led || tilted),
        (turning, led),
        (axes, tilted),
    ];
    all.into_iter().filter(|(_, holds)| *holds).map(|(what, _)| what.to_owned()).collect()
}

/// The remarks before the first step that do not say what to set up: those behind the last of these, which may go on for some
/// lines.
pub fn own_remarks(remarks: &[String]) -> &[String] {
    let Some(last) = remarks.iter().rposition(|remark| remark.starts_with(LAST_REMARK)) else {
        return remarks;
    };
    let mut text = String::new();
    for (i, remark) in remarks[last..].iter().enumerate() {
        text.push(' ');
        text.push_str(remark);
        let said = text.trim_start().strip_prefix(LAST_REMARK).unwrap_or_default().trim_start();
        if said.split(", ").all(|part| NOT_COVERED.iter().any(|known| known.eq_ignore_ascii_case(part))) {
            return &remarks[last + i + 1..];
        }
    }
    &remarks[last + 1..]
}

/// Where rapids are clear: the first rapid's axis and place.
fn clear(intent: &Intent) -> Option<(String, f64)> {
    // Elsewhere rapids go where the input sends them.
    intent.logarithmic().next()?;
    let axes = intent.program.axes;
    intent.program.steps.iter().find_map(|located| match &located.step {
        Step::Rapid(targets) => targets.first().map(|(axis, to)| (axes.name(*axis).to_string(), *to)),
        Step::Comment(_)
        | Step::Tool(_)
        | Step::Spindle(_)
        | Step::Coolant
        | Step::Home(_)
        | Step::Shift(_)
        | Step::Auxiliary(_)
        | Step::Cut(_) => None,
    })
}

/// What each parameter of a program is.
fn parameters(decimals: &Decimals, machine: &Machine) -> Vec<String> {
    let Assigned { corrections, feeds } = Assigned::of(decimals, machine);
    let letter = machine.dialect.parameter.letter;
    let shifts = |(axis, _, number): &(usize, Decimal, u32)| {
        format!("{letter}{number} shifts all paths in {}", decimals.program.axes.name(*axis))
    };
    let mut parameters: Vec<String> = corrections.iter().map(shifts).collect();
    match (feeds.first(), feeds.last()) {
        (Some((_, first)), Some((_, last))) if first < last => {
            parameters.push(format!("{letter}{first} to {letter}{last} feeds"));
        }
        (Some((_, first)), _) => parameters.push(format!("{letter}{first} feed")),
        (None, _) => {}
    }
    parameters
}

/// The directions that a program states, those of second curves at their control points, each with the one before it in a
/// run of lines.
fn directions(decimals: &Decimals, first: usize, mut take: impl FnMut([f64; 3], Option<[f64; 3]>)) {
    let of = |units: &Units| {
        let place = decimals.position(units);
        [place[first], place[first + 1], place[first + 2]]
    };
    for located in &decimals.program.steps {
        match &located.step {
            Step::Cut(cut) => match &cut.curve {
                Written::Lines(line) | Written::Through(_, line) => {
                    let mut before = of(&line.start);
                    for point in line.points() {
                        let d = of(&point);
                        take(d, Some(before));
                        before = d;
                    }
                }
                Written::Nurbs(nurbs) => nurbs.points.iter().for_each(|point| take(of(point), None)),
                Written::Polynomial(polynomial) => {
                    take(of(&polynomial.start), None);
                    polynomial.blocks.iter().for_each(|block| take(of(&block.end), None));
                }
                Written::Arc(arc) => take(of(&arc.end), None),
            },
            Step::Rapid(targets) => {
                let component = |i: usize| targets.iter().find(|(axis, _)| *axis == first + i);
                if let [Some((_, x)), Some((_, y)), Some((_, z))] = [0, 1, 2].map(component) {
                    take([x.to_f64(), y.to_f64(), z.to_f64()], None);
                }
            }
            Step::Comment(_)
            | Step::Tool(_)
            | Step::Spindle(_)
            | Step::Coolant
            | Step::Home(_)
            | Step::Shift(_)
            | Step::Auxiliary(_) => {}
        }
    }
}

/// How far the tool is tilted, degrees.
fn tilt(decimals: &Decimals, machine: &Machine) -> Option<[f64; 2]> {
    let mut range: Option<[f64; 2]> = None;
    let mut take = |d: [f64; 3]| {
        let tilt = direction::tilt(&d);
        let [least, most] = range.unwrap_or([tilt, tilt]);
        range = Some([least.min(tilt), most.max(tilt)]);
    };
    if let Some(first) = decimals.program.axes.direction() {
        directions(decimals, first, |d, _| take(d));
    }
    for located in &decimals.program.steps {
        if let Step::Auxiliary(Auxiliary::Plane(angles)) = located.step {
            let angles = angles.map(Decimal::to_f64);
            take(Rotation::of(machine.orientation.plane_order, angles).axis());
        }
    }
    range
}

/// How far rotary axes that go evenly leave the great circle, degrees.
fn departure(decimals: &Decimals) -> Option<f64> {
    let first = decimals.program.axes.direction()?;
    let mut worst = 0.0f64;
    directions(decimals, first, |d, before| {
        if let Some(before) = before {
            worst = worst.max(direction::tilt_departure(&before, &d) * DEGREES);
        }
    });
    Some(worst)
}

/// What the motions of a program need.
fn needs(decimals: &Decimals, machine: &Machine) -> Vec<String> {
    let mut needs: Vec<String> = Vec::new();
    if decimals.program.axes.direction().is_some() {
        needs.push("five-axis transformation".to_owned());
    }
    if decimals.program.has_planes() {
        needs.push("tilted planes".to_owned());
    }
    for cut in decimals.program.steps.iter().filter_map(|located| located.step.cut()) {
        let form = match &cut.curve {
            Written::Lines(_) | Written::Arc(_) => continue,
            Written::Polynomial(_) => None,
            Written::Nurbs(_) => Some(Form::Nurbs),
            Written::Through(kind, _) => Some(Form::Through(*kind)),
        };
        let motion = machine.dialect.motions.iter().find(|motion| match form {
            None => matches!(motion.form, Form::Polynomial { .. }),
            Some(form) => motion.form == form,
        });
        if let Some(motion) = motion.filter(|motion| !motion.needs.is_empty())
            && !needs.iter().any(|known| known == motion.needs)
        {
            needs.push(motion.needs.to_owned());
        }
    }
    needs
}
