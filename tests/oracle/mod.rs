//! An oracle that shares no code with the crate's curves, readers or proof: programs are evaluated straight from their
//! text, by the formulas of the manuals and of the paper, and compared with what was asked.
//!
//! | module | what |
//! |---|---|
//! | [`curve`] | the logarithmic law, odd-even steps, distances at the surface |
//! | [`text`] | what a program text does |
//! | [`published`] | the oracle itself, on published fragments |

#![allow(
    clippy::disallowed_methods,
    reason = "the oracle uses the platform's functions so that it shares no code with the crate"
)]

mod curve;
mod published;
mod text;

use crate::support::{machines, sources, whole_path_machines};
use curve::{CUTTERS, Cutter, PAPER, Point, length};
use splinepost::dialect::{Form, Motion};
use splinepost::ir::{Curve, Cut, Logarithmic, Method, Step};
use splinepost::machine::Machine;
use splinepost::verify::Status;
use splinepost::{Options, Output};
use text::Path;

/// Floating-point noise, mm and degrees. Angles stay below 1e3 degrees, so that an operation costs at most
/// 1e3 · 2⁻⁵³ ≈ 1e-13; the longest sums are the odd-even steps, a few thousand additions of both sides: 1e3 · 1e-13 · 2,
/// taken up to the next power of ten. At the surface it is less, since no radius exceeds 57 mm.
const NOISE: f64 = 1.0e-9;

fn compile(cutter: &Cutter, machine: &Machine, options: &Options) -> Result<Output, String> {
    let language = splinepost::front::find("cutter").expect("the cutter language");
    splinepost::compile(&sources(&cutter.toml()), language, machine, options)
        .map_err(|failure| format!("{:?}", failure.diagnostics))
}

/// How the crate settled the path of the first flute.
fn settled(output: &Output) -> &Logarithmic {
    let paths = output.intent.program.steps.iter().filter_map(|located| match &located.step {
        Step::Cut(Cut { curve: Curve::Logarithmic(log), .. }) => Some(log),
        Step::Cut(_)
        | Step::Comment(_)
        | Step::Tool(_)
        | Step::Spindle(_)
        | Step::Coolant
        | Step::Home(_)
        | Step::Shift(_)
        | Step::Auxiliary(_)
        | Step::Rapid(_) => None,
    });
    paths.take(1).next().expect("a cutter has a flute")
}

/// An `Err` with a message, unless it holds.
macro_rules! hold {
    ($holds:expr, $($message:tt)+) => {
        if !$holds {
            return Err(format!($($message)+));
        }
    };
}

/// Half a unit of the last decimal in mm and degrees.
#[derive(Clone, Copy)]
struct Half {
    mm: f64,
    degrees: f64,
}

impl Half {
    fn of(machine: &Machine) -> Half {
        let half = |digits: u8| 0.5 * 0.1f64.powi(i32::from(digits));
        Half { mm: half(machine.digits.linear), degrees: half(machine.digits.rotary) }
    }

    /// What rounding makes of a point of the curve at the surface, at most, mm.
    fn at_surface(self, cutter: &Cutter) -> f64 {
        [0.0, cutter.length]
            .map(|x| cutter.rounding(x, self.mm, self.degrees))
            .into_iter()
            .fold(0.0, f64::max)
    }

    /// Whether a printed position is this one, rounded.
    fn rounds(self, printed: &Point, asked: &Point) -> bool {
        (0..4).all(|i| (printed[i] - asked[i]).abs() <= if i == 3 { self.degrees } else { self.mm } + NOISE)
    }
}

/// Compares a program with what was asked.
fn examine(cutter: &Cutter, machine: &Machine, output: &Output, text: &str) -> Result<(), String> {
    let report = output.report.as_ref().ok_or("no report")?;
    let log = settled(output);
    let form = output.motion.form;
    let through = matches!(form, Form::Through(_));
    let status = if through { Status::PointsOnly } else { Status::Proved };
    hold!(report.status == status, "the status is {}", report.status.word());
    let paths = text::paths(machine.dialect.name, text)?;
    hold!(paths.len() == cutter.flutes, "{} cutting paths", paths.len());
    let half = Half::of(machine);
    let steps = (log.method == Method::OddEven).then(|| cutter.odd_even(log.dl.unwrap_or_default(), false));
    let (mut sampled, mut cut, mut allowance) = (0.0f64, 0.0, NOISE);
    let (mut greatest, mut zigzag) = ([0.0f64; 3], 0.0);
    for (flute, path) in paths.iter().enumerate() {
        let index = cutter.index(flute);
        let (x, a) = (cutter.length, cutter.angle(cutter.length));
        let start = cutter.position(0.0, 0.0, index);
        hold!(half.rounds(&path.start, &start), "flute {flute} starts at {:?}", path.start);
        let end = path.ends.last().ok_or("an empty path")?;
        hold!(half.rounds(end, &cutter.position(x, a, index)), "flute {flute} ends at {end:?}");
        hold!(path.gap <= NOISE, "an SPL block starts {:e} from the tool", path.gap);
        // Where A follows the arc length, what X, Y, Z stray from even motion puts A as far ahead or behind. Only
        // rounding may be the cause: the control points are off by half a unit in three axes, and so is the start.
        hold!(path.straying <= 4.0 * half.mm, "X, Y, Z stray {:e} from even motion", path.straying);
        allowance = allowance.max(NOISE + cutter.lag(path.straying));
        let along: Vec<Point> = [path.start].into_iter().chain(path.ends.iter().copied()).collect();
        let way = if through { &along } else { &path.places };
        // Between the ends a line of length l turns by the rounding δ across it, up to 2√2 half units, and grows by δ²/2l.
        let corners = match &steps {
            Some(steps) => corners(cutter, steps, index),
            None => along.clone(),
        };
        zigzag += corners
            .windows(2)
            .map(|pair| 4.0 * half.mm * half.mm / distance(&pair[0], &pair[1]))
            .sum::<f64>();
        cut += way.windows(2).map(|pair| distance(&pair[0], &pair[1])).sum::<f64>();
        hold!(way.windows(2).all(|pair| pair[0][0] <= pair[1][0] + NOISE), "flute {flute} runs back");
        match &steps {
            Some(steps) => sampled = sampled.max(odd_even(cutter, index, half, form, steps, path)?),
            None if through => through_points(cutter, index, half, output.tolerance, path)?,
            None => {
                for at in &path.places {
                    let differences = cutter.differences(at, index);
                    sampled = sampled.max(length(differences));
                    greatest = std::array::from_fn(|i| greatest[i].max(differences[i].abs()));
                }
            }
        }
    }
    let bound = report.deviation.mm;
    hold!(sampled <= bound + allowance, "{sampled:e} mm from what was asked, the bound is {bound:e}");
    hold!(bound <= output.tolerance, "the bound is {bound:e}");
    if steps.is_none() && matches!(form, Form::Polynomial { .. } | Form::Nurbs) {
        // A bound may take the arc, Y and Z each where it is greatest, and the rounding of control points in full.
        let found = length(greatest);
        let loose = 1.1 * found + half.at_surface(cutter);
        hold!(bound <= loose, "the bound is {bound:e}, but only {found:e} mm are found");
    }
    if let Some(steps) = &steps {
        let from_ideal = report.from_ideal.ok_or("no distance from the ideal curve")?.mm;
        let found = cutter.polyline_deviation(steps);
        hold!(
            found <= from_ideal + NOISE,
            "the steps are {found:e} mm from the curve, the bound is {from_ideal:e}"
        );
        hold!(
            from_ideal <= 1.1 * found + 1.0e-6,
            "the steps' bound is {from_ideal:e}, found are {found:e} mm"
        );
        hold!(
            from_ideal <= output.tolerance,
            "the steps that were chosen are {from_ideal:e} mm from the curve"
        );
    }
    // Each end is off by half a unit in three axes.
    let ends = 4.0 * half.mm * cutter.flutes as f64 + zigzag;
    hold!((report.cutting_length - cut).abs() <= ends, "{} mm are reported of {cut}", report.cutting_length);
    let blocks: usize = paths.iter().map(|path| path.blocks).sum();
    // The first control point of G06.2 is where the tool is already.
    let no_cut = text.matches("G06.2 P").count();
    hold!(report.path_blocks == blocks - no_cut, "{} blocks are reported of {blocks}", report.path_blocks);
    Ok(())
}

/// √(ΔX² + ΔY² + ΔZ²).
fn distance(from: &Point, to: &Point) -> f64 {
    length(std::array::from_fn(|i| to[i] - from[i]))
}

/// The start and the steps.
fn corners(cutter: &Cutter, steps: &[(f64, f64)], index: f64) -> Vec<Point> {
    [(0.0, 0.0)].iter().chain(steps).map(|(x, a)| cutter.position(*x, *a, index)).collect()
}

/// A path that follows odd-even steps: its points are the steps, rounded, in order and number; how far it is from the
/// polyline through them.
fn odd_even(
    cutter: &Cutter,
    index: f64,
    half: Half,
    form: Form,
    steps: &[(f64, f64)],
    path: &Path,
) -> Result<f64, String> {
    let through = matches!(form, Form::Through(_));
    let last = steps.len() - 1;
    let wanted = |i: usize| match form {
        Form::Lines | Form::Polynomial { .. } => true,
        // The even points, and the end.
        Form::Through(_) => i % 2 == 1 || i == last,
        Form::Nurbs => i == last,
    };
    let asked: Vec<Point> = steps
        .iter()
        .enumerate()
        .filter(|(i, _)| wanted(*i))
        .map(|(_, (x, a))| cutter.position(*x, *a, index))
        .collect();
    hold!(path.ends.len() == asked.len(), "{} points instead of {}", path.ends.len(), asked.len());
    for (i, (printed, asked)) in path.ends.iter().zip(&asked).enumerate() {
        hold!(half.rounds(printed, asked), "point {} is {printed:?} instead of {asked:?}", i + 1);
    }
    if through {
        return Ok(0.0);
    }
    Ok(cutter.polyline_distance(&corners(cutter, steps, index), &path.places))
}

/// A control's own spline: points of the curve, rounded, so near to each other that lines between them would hold the
/// tolerance.
fn through_points(
    cutter: &Cutter,
    index: f64,
    half: Half,
    tolerance: f64,
    path: &Path,
) -> Result<(), String> {
    let mut from = path.start;
    for to in &path.ends {
        let rounding = cutter.rounding(to[0], half.mm, half.degrees) + NOISE;
        let off = cutter.deviation(to, index);
        hold!(off <= rounding, "the point {to:?} is {off:e} mm from the curve");
        let middle: Point = std::array::from_fn(|i| 0.5 * (from[i] + to[i]));
        let chord = cutter.deviation(&middle, index);
        hold!(chord <= tolerance + rounding, "the chord to {to:?} is {chord:e} mm from the curve");
        from = *to;
    }
    Ok(())
}

/// The methods to try: lines may follow steps or the curve.
fn methods(form: Form) -> &'static [Method] {
    match form {
        Form::Lines => &[Method::Auto, Method::OddEven, Method::Direct],
        Form::Polynomial { .. } | Form::Nurbs | Form::Through(_) => &[Method::Auto, Method::OddEven],
    }
}

/// Compiles one combination and examines it.
fn combination(
    cutter: &Cutter,
    machine: &Machine,
    motion: &'static Motion,
    method: Method,
    tolerance: Option<f64>,
) -> Result<(), String> {
    let options = Options { motion: Some(motion), method: Some(method), tolerance, ..Options::default() };
    // The control points of steps do not say where one B-spline ends and the next begins: here it is one.
    let whole = motion.form == Form::Nurbs && method == Method::OddEven;
    let feed_error = if whole { 10.0 } else { machine.feed_error };
    let machine = &Machine { feed_error, ..machine.clone() };
    let result =
        compile(cutter, machine, &options).and_then(|output| examine(cutter, machine, &output, &output.text));
    result.map_err(|what| {
        let (cutter, machine, motion) = (cutter.name, &machine.name, motion.name);
        format!("{cutter}, {machine}, {motion}, {method:?}, {tolerance:?}: {what}")
    })
}

#[test]
fn every_cutter_in_every_motion_is_what_was_asked() {
    let mut wrong = Vec::new();
    for machine in machines() {
        if machine.dialect.motions.is_empty() {
            println!("{}: no motions yet", machine.dialect.name);
        }
        for motion in machine.dialect.motions {
            for cutter in CUTTERS {
                for method in methods(motion.form) {
                    // The machine's own tolerance, and a coarse one.
                    for tolerance in [None, Some(0.02)] {
                        wrong.extend(combination(cutter, &machine, motion, *method, tolerance).err());
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The first machine of a dialect and one of its motions; none while the dialect has none.
fn find(dialect: &str, motion: &str) -> Option<(Machine, &'static Motion)> {
    let machine = whole_path_machines().into_iter().find(|machine| machine.dialect.name == dialect)?;
    if machine.dialect.motions.is_empty() {
        return None;
    }
    let found = machine.dialect.motion(motion);
    Some((machine, found.unwrap_or_else(|| panic!("{dialect} has no {motion}"))))
}

/// The paper's 152 points are 2.0e-4 mm from the curve.
#[test]
fn few_blocks_are_as_near_as_the_papers_152_points() {
    for (dialect, motion, most) in [
        ("sinumerik", "poly", 1),
        ("sinumerik", "bspline", 6),
        ("heidenhain", "spl", 1),
        ("mazak", "g06.2", 4),
    ] {
        let Some((machine, motion)) = find(dialect, motion) else {
            println!("{dialect}: no motions yet");
            continue;
        };
        let options = Options { motion: Some(motion), tolerance: Some(2.0e-4), ..Options::default() };
        let output =
            compile(&PAPER, &machine, &options).unwrap_or_else(|what| panic!("{}: {what}", motion.name));
        examine(&PAPER, &machine, &output, &output.text)
            .unwrap_or_else(|what| panic!("{}: {what}", motion.name));
        let bound = output.report.expect("a report").deviation.mm;
        assert!(bound < 2.0e-4, "{}: {bound:e}", motion.name);
        for path in text::paths(dialect, &output.text).expect("the text was read before") {
            assert!(path.blocks <= most, "{}: {} blocks", motion.name, path.blocks);
        }
    }
}

/// Where an occurrence of `needle` behind the first approach begins.
fn place(text: &str, needle: &str, occurrence: usize) -> usize {
    let approach = text.find("F200").expect("an approach has the feed");
    let found = text[approach..].match_indices(needle).nth(occurrence);
    approach + found.unwrap_or_else(|| panic!("no `{needle}` in\n{text}")).0
}

/// The text with `by` added to the number that follows an occurrence of `needle`.
fn bump(text: &str, needle: &str, occurrence: usize, by: f64) -> String {
    let (before, rest) = text.split_at(place(text, needle, occurrence) + needle.len());
    let length = rest.find(|c: char| !(c.is_ascii_digit() || "+-.E".contains(c))).unwrap_or(rest.len());
    let value: f64 = rest[..length].parse().unwrap_or_else(|_| panic!("no number in `{}`", &rest[..length]));
    format!("{before}{:+.8}{}", value + by, &rest[length..])
}

/// The text without the line that holds an occurrence of `needle`.
fn without_line(text: &str, needle: &str, occurrence: usize) -> String {
    let at = place(text, needle, occurrence);
    let start = text[..at].rfind('\n').map_or(0, |at| at + 1);
    let end = text[at..].find('\n').map_or(text.len(), |length| at + length + 1);
    text[..start].to_owned() + &text[end..]
}

/// A is turned by 0.05 degrees, 0.0044 mm at the least radius and more than any bound allowed, or a quarter of it in the
/// middle of a block; a block is dropped. Every time the oracle must say so.
#[test]
fn damage_is_found() {
    for machine in machines() {
        for motion in machine.dialect.motions {
            let options = Options { motion: Some(motion), ..Options::default() };
            let output =
                compile(&PAPER, &machine, &options).unwrap_or_else(|what| panic!("{}: {what}", motion.name));
            let intact = &output.text;
            assert_eq!(examine(&PAPER, &machine, &output, intact), Ok(()), "{}", motion.name);
            let damaged = match motion.form {
                Form::Polynomial { closing: true } => vec![
                    bump(intact, "K2A", 0, 0.05),
                    // It still closes.
                    bump(&bump(intact, "K2A", 0, 0.05), "K1A", 0, -0.05),
                    without_line(intact, "K2A", 0),
                ],
                Form::Polynomial { closing: false } => {
                    let list = intact.find("PO[A]=(").expect("A is a polynomial");
                    let end = intact[list..].find(',').map_or(list, |length| list + length + 1);
                    let head = &intact[list..end];
                    vec![
                        bump(intact, "PO[A]=(", 0, 0.05),
                        bump(intact, head, 0, 0.05),
                        without_line(intact, "PO[A]", 0),
                    ]
                }
                // Not the first: of G06.2 that is where the tool is.
                Form::Lines | Form::Nurbs | Form::Through(_) => vec![
                    bump(intact, " A", 1, 0.05),
                    without_line(intact, " A", 1),
                    without_line(intact, " A", 2),
                ],
            };
            // Its pieces are not even in the parameter, so that A would be elsewhere along the arc length.
            let without_upath = (motion.form == Form::Nurbs && intact.contains("UPATH"))
                .then(|| intact.replace("UPATH", "SPATH"));
            for text in damaged.into_iter().chain(without_upath) {
                assert_ne!(text, *intact);
                assert!(examine(&PAPER, &machine, &output, &text).is_err(), "{}:\n{text}", motion.name);
            }
        }
    }
}

/// A bound below what the oracle finds, and one far above, are both refused. What it finds is no less than 1/√3 of a
/// sound bound, since that may take three axes each where it is farthest off.
#[test]
fn a_wrong_bound_is_found() {
    for machine in whole_path_machines() {
        for motion in machine
            .dialect
            .motions
            .iter()
            .filter(|motion| matches!(motion.form, Form::Polynomial { .. } | Form::Nurbs))
        {
            let options = Options { motion: Some(motion), ..Options::default() };
            let mut output =
                compile(&PAPER, &machine, &options).unwrap_or_else(|what| panic!("{}: {what}", motion.name));
            let bound = output.report.as_ref().expect("a report").deviation.mm;
            for wrong in [0.5 * bound, 1.2 * bound + Half::of(&machine).at_surface(&PAPER)] {
                output.report.as_mut().expect("a report").deviation.mm = wrong;
                assert!(
                    examine(&PAPER, &machine, &output, &output.text).is_err(),
                    "{}: {wrong:e}",
                    motion.name
                );
            }
        }
    }
}

/// How long a path takes, minutes: the way between its places by the F of their block.
fn minutes(path: &Path, degrees_count: bool) -> f64 {
    let mut from = 0;
    let mut minutes = 0.0;
    for (to, feed) in &path.feeds {
        for pair in path.places[from..*to].windows(2) {
            let turn = if degrees_count { pair[1][3] - pair[0][3] } else { 0.0 };
            let way = distance(&pair[0], &pair[1]);
            minutes += (way * way + turn * turn).sqrt() / feed;
        }
        from = *to;
    }
    minutes
}

/// Every flute takes the time that was asked, on every control and in every motion that says where it goes.
#[test]
fn a_flute_takes_the_same_time_on_every_control() {
    let mut tried = 0;
    for cutter in CUTTERS {
        let asked = {
            let along: Vec<Point> = (0..=1000)
                .map(|i| cutter.length * f64::from(i) / 1000.0)
                .map(|x| cutter.position(x, cutter.angle(x), 0.0))
                .collect();
            along.windows(2).map(|pair| distance(&pair[0], &pair[1])).sum::<f64>() / 200.0
        };
        for machine in machines() {
            let counts = machine.rotary_feed == splinepost::machine::RotaryFeed::DegreesAsMm;
            for motion in machine.dialect.motions {
                if matches!(motion.form, Form::Through(_)) {
                    continue;
                }
                let what = format!("{}, {}, {}", cutter.name, machine.name, motion.name);
                let options = Options { motion: Some(motion), ..Options::default() };
                let output = compile(cutter, &machine, &options).unwrap_or_else(|e| panic!("{what}: {e}"));
                let paths = text::paths(machine.dialect.name, &output.text).expect("it was read before");
                for path in &paths {
                    let took = minutes(path, counts);
                    // Steps zigzag, F and positions are rounded; of lines a stretch has whole ones only.
                    assert!((took / asked - 1.0).abs() < 0.01, "{what}: {took} min of {asked}");
                    tried += 1;
                }
                let all: f64 = paths.iter().map(|path| minutes(path, counts)).sum();
                let report = output.report.expect("a report");
                assert!((report.minutes / all - 1.0).abs() < 1.0e-3, "{what}: {} of {all}", report.minutes);
                assert!(report.feed_error <= machine.feed_error, "{what}: {}", report.feed_error);
            }
        }
    }
    assert!(100 < tried, "{tried} paths");
}
