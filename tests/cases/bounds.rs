//! The bound that is stated of lines, against the distance that is there: texts are read by a few words, and both paths looked at
//! at many places, with no code of the project between.

#![expect(
    clippy::disallowed_methods,
    reason = "what is compared with the project's own must not come from there, and no text depends on it"
)]

use super::{case, compiled};
use splinepost::machine::Machine;
use splinepost::source::{Source, SourceId, Sources};
use splinepost::{Options, recompile};
use std::fmt::Write as _;

/// X Y Z, A in degrees, and the tool's direction.
type Place = [f64; 7];

/// The moves of a program: whether each is at rapid, and where it ends. Moves in machine coordinates are none.
fn moves(text: &str) -> Vec<(bool, Place)> {
    const WORDS: [(&str, usize); 13] = [
        ("A3=", 4),
        ("B3=", 5),
        ("C3=", 6),
        ("TX", 4),
        ("TY", 5),
        ("TZ", 6),
        ("X", 0),
        ("Y", 1),
        ("Z", 2),
        ("A", 3),
        ("I", 4),
        ("J", 5),
        ("K", 6),
    ];
    let (mut all, mut at, mut rapid) = (Vec::new(), [0.0; 7], true);
    for line in text.lines() {
        let away = ["SUPA", "G53", "M91", "DATUM", "DEF", "G52", "G54", "(", ";"];
        if away.iter().any(|word| line.contains(word)) {
            continue;
        }
        let mut moved = false;
        for token in line.split_whitespace() {
            match token {
                "G0" => rapid = true,
                "G1" | "L" | "LN" => rapid = false,
                "FMAX" => rapid = true,
                _ => {
                    let of = |(word, axis): &(&str, usize)| {
                        let number: f64 = token.strip_prefix(word)?.parse().ok()?;
                        Some((*axis, number))
                    };
                    if let Some((axis, number)) = WORDS.iter().find_map(of) {
                        (at[axis], moved) = (number, true);
                    }
                }
            }
        }
        if moved {
            all.push((rapid, at));
        }
    }
    all
}

/// The places of the cuts of a program, and the one before them.
fn cuts(text: &str) -> Vec<Place> {
    let all = moves(text);
    let first = all.iter().position(|(rapid, _)| !rapid).expect("a cut");
    let before = all[..first].last().expect("an approach").1;
    let cutting = all[first..].iter().take_while(|(rapid, _)| !rapid).map(|(_, place)| *place);
    std::iter::once(before).chain(cutting).collect()
}

fn norm(of: impl Iterator<Item = f64>) -> f64 {
    of.map(|x| x * x).sum::<f64>().sqrt()
}

/// The angle between two vectors, radians: by half the chord of the unit sphere, which is exact for small ones.
fn angle(a: &[f64], b: &[f64]) -> f64 {
    let (m, n) = (norm(a.iter().copied()), norm(b.iter().copied()));
    2.0 * (0.5 * norm(a.iter().zip(b).map(|(a, b)| a / m - b / n))).asin()
}

/// The direction at share s of an even turn from one to another.
fn turned(a: &[f64], b: &[f64], s: f64) -> [f64; 3] {
    let theta = angle(a, b);
    let (m, n) = (norm(a.iter().copied()), norm(b.iter().copied()));
    let (p, q) = if theta < 1.0e-9 { (1.0 - s, s) } else { (((1.0 - s) * theta).sin(), (s * theta).sin()) };
    std::array::from_fn(|i| p * a[i] / m + q * b[i] / n)
}

/// The greatest distance of two paths of as many lines at equal shares of each, mm, with degrees counted at `radius`; and the
/// greatest angle between the tool's directions, radians.
fn farthest(a: &[Place], b: &[Place], radius: f64) -> (f64, f64) {
    assert_eq!(a.len(), b.len(), "as many lines");
    let (mut mm, mut rad) = (0.0f64, 0.0f64);
    for (p, q) in a.windows(2).zip(b.windows(2)) {
        for k in 0..=16 {
            let s = f64::from(k) / 16.0;
            let at = |pair: &[Place], i: usize| pair[0][i] + s * (pair[1][i] - pair[0][i]);
            let scale = |i: usize| if i == 3 { radius.to_radians() } else { 1.0 };
            mm = mm.max(norm((0..4).map(|i| scale(i) * (at(p, i) - at(q, i)))));
            if p[0][4..] != [0.0; 3] {
                let of = |pair: &[Place]| turned(&pair[0][4..], &pair[1][4..], s);
                rad = rad.max(angle(&of(p), &of(q)));
            }
        }
    }
    (mm, rad)
}

/// What a distance that was looked at may exceed a bound by: coordinates up to 1000 are rounded to 1.2e-13, each place is made of
/// some ten operations on them, in four coordinates.
const NOISE: f64 = 1.0e-11;

/// The same of an angle that is the difference of unit vectors: some thirty operations on numbers up to 1, of 1.2e-16 each.
const ANGLE_NOISE: f64 = 1.0e-14;

fn machine(dialect: &str, keys: &str) -> Machine {
    crate::support::machine(&format!("extends = \"{dialect}\"\nname = \"rounded\"\n{keys}"))
}

/// The points of a job whose only curve is one of points.
fn job_points(text: &str) -> Vec<Place> {
    let list = text.split("points = [[").nth(1).expect("points").split("]]").next().expect("an end");
    let place = |row: &str| {
        let mut place = [0.0; 7];
        for (x, number) in place.iter_mut().zip(row.split(',')) {
            *x = number.trim().parse().expect("a number");
        }
        place
    };
    list.split("],").map(|row| place(row.trim().trim_start_matches('['))).collect()
}

#[test]
fn the_bound_of_lines_is_a_distance_of_all_coordinates() {
    let own = Machine::parse(&case("proof/lines-m.toml"), SourceId::INPUT).expect("a machine");
    let mazak = Machine::built_in("mazak").expect("a machine");
    // Each of X Y Z is off by 4.9e-5 and A by as many degrees at 200 mm: 4.9e-5 √(3 + 3.4907²) = 1.910e-4.
    for (name, machine, tolerance, right) in [
        ("proof/lines-default-mazak.toml", &mazak, None, 1.910e-4),
        ("proof/lines-in.toml", &own, Some(0.02), 1.910e-2),
    ] {
        let text = case(name);
        let options = Options { tolerance, ..Options::default() };
        let output = compiled(&text, machine, &options).unwrap_or_else(|e| panic!("{name}: {e:?}"));
        let stated = output.report.expect("a proof").deviation;
        assert!((stated.mm / right - 1.0).abs() < 1.0e-3, "{name}: {}", stated.mm);
        let (mm, _) = farthest(&cuts(&output.text)[1..], &job_points(&text), 200.0);
        assert!(mm <= stated.mm + NOISE && stated.mm < mm * (1.0 + 1.0e-9), "{name}: {mm} {}", stated.mm);
        // A alone: 4.9e-5 degrees.
        assert!((stated.rad / (right / 1.910e-4 * 4.9e-5f64.to_radians()) - 1.0).abs() < 1.0e-3, "{name}");
    }
}

/// The cuts of CL data in inches, from the rapid before them.
fn cl_points(text: &str) -> Vec<Place> {
    let (mut rapid, mut axis, mut all) = (false, [0.0, 0.0, 1.0], Vec::new());
    let (mut before, mut cutting) = (None, false);
    for line in text.lines() {
        rapid |= line == "RAPID";
        let Some(rest) = line.strip_prefix("GOTO/") else { continue };
        let numbers: Vec<f64> = rest.split(',').map(|x| x.trim().parse().expect("a number")).collect();
        if let [_, _, _, i, j, k] = numbers[..] {
            axis = [i, j, k];
        }
        let inch = 25.4;
        let place = [inch * numbers[0], inch * numbers[1], inch * numbers[2], 0.0, axis[0], axis[1], axis[2]];
        if rapid && cutting {
            break;
        }
        cutting |= !rapid;
        if cutting {
            all.extend(before.take());
            all.push(place);
        } else {
            before = Some(place);
        }
        rapid = false;
    }
    all
}

#[test]
fn the_bound_of_lines_of_cl_data_is_a_distance_too() {
    for (name, dialect) in [
        ("proof/lines-three-axis-mazak.apt", "mazak"),
        ("proof/lines-five-axis-heidenhain.apt", "heidenhain"),
    ] {
        let text = case(name);
        let machine = Machine::built_in(dialect).expect("a machine");
        let output =
            compiled(&text, &machine, &Options::default()).unwrap_or_else(|e| panic!("{name}: {e:?}"));
        let stated = output.report.expect("a proof").deviation;
        let (mm, rad) = farthest(&cuts(&output.text), &cl_points(&text), 1.0);
        assert!(mm <= stated.mm + NOISE && stated.mm <= 1.0001 * mm + NOISE, "{name}: {mm} {}", stated.mm);
        assert!(
            rad <= stated.rad + ANGLE_NOISE && stated.rad <= 1.05 * rad + ANGLE_NOISE,
            "{name}: {rad} {}",
            stated.rad
        );
    }
}

/// Numbers from 0 to 1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn from(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    fn below(&mut self, n: usize) -> usize {
        ((self.next() * n as f64) as usize).min(n - 1)
    }
}

/// A run of lines that was compiled: what was asked, what was written, the radius, and the bound of both.
struct Run {
    asked: Vec<Place>,
    written: Vec<Place>,
    radius: f64,
    stated: splinepost::geom::deviation::Bound,
}

const DIALECTS: [&str; 3] = ["sinumerik", "heidenhain", "mazak"];

/// A job of lines in three axes, or in four with a radius.
fn run_of_a_job(random: &mut Random, digits: u8, with_radius: bool) -> Run {
    let axes = if with_radius { 4 } else { 3 };
    let radius = if with_radius { random.from(1.0, 200.0) } else { 1.0 };
    let count = 2 + random.below(12);
    let mut rows = Vec::new();
    for _ in 0..count {
        let row: Vec<String> = (0..axes).map(|_| format!("{:.7}", random.from(-90.0, 90.0))).collect();
        rows.push(format!("[{}]", row.join(", ")));
    }
    let names = if with_radius { "\"X\", \"Y\", \"Z\", \"A\"" } else { "\"X\", \"Y\", \"Z\"" };
    let stated = if with_radius { format!("radius = {radius}\n") } else { String::new() };
    let text = format!(
        "name = \"RUN\"\n{stated}[process]\nfeed = 1000.0\nretract = {{ axis = \"Z\", to = 150.0 }}\n[[curve]]\n\
         kind = \"points\"\naxes = [{names}]\npoints = [{}]\n",
        rows.join(", ")
    );
    let keys = format!("[digits]\nlinear = {digits}\nrotary = {digits}\n");
    let machine = machine(DIALECTS[random.below(3)], &keys);
    let options =
        Options { tolerance: Some(0.2), motion: machine.dialect.motion("linear"), ..Options::default() };
    let output = compiled(&text, &machine, &options).unwrap_or_else(|e| panic!("{e:?}\n{text}"));
    // The first cut is the approach.
    let written = cuts(&output.text)[1..].to_vec();
    Run { asked: job_points(&text), written, radius, stated: output.report.expect("a proof").deviation }
}

/// Where the tool is clear of the work, for controls on which ending tool centre point control may move it.
const PARK: &str = "[axis.X]\nhome = -500.0\n[axis.Y]\nhome = 0.0\n";

/// CL data of five axes, in inches.
fn run_of_five_axes(random: &mut Random, digits: u8) -> Run {
    let mut text = "PARTNO/RUN\nUNITS/INCHES\nMULTAX/ON\nLOADTL/1\nSPINDL/8000,RPM,CLW\nRAPID\n".to_owned();
    let mut axis = [0.0, 0.0, 1.0];
    for i in 0..3 + random.below(12) {
        let (x, y) = (axis[0] + random.from(-0.3, 0.3), axis[1] + random.from(-0.3, 0.3));
        let size = norm([x, y, 1.0].into_iter());
        axis = [x / size, y / size, 1.0 / size];
        // Safe height is the highest place.
        let z = if i == 0 { 5.0 } else { random.from(-1.0, 1.0) };
        // Writing to a String cannot fail.
        let _ = write!(text, "GOTO/{:.8},{:.8},{z:.8},", random.from(-4.0, 4.0), random.from(-4.0, 4.0));
        let _ = writeln!(text, "{:.8},{:.8},{:.8}", axis[0], axis[1], axis[2]);
        if i == 0 {
            text.push_str("FEDRAT/600.0,MMPM\n");
        }
    }
    text.push_str("FINI\n");
    let places = digits.max(3);
    let keys = format!(
        "[digits]\nlinear = {digits}\nrotary = {digits}\n[orientation]\ntolerance = 1.0\ndigits = {places}\n{PARK}"
    );
    let machine = machine(DIALECTS[random.below(3)], &keys);
    let options = Options { tolerance: Some(0.2), ..Options::default() };
    let output = compiled(&text, &machine, &options).unwrap_or_else(|e| panic!("{e:?}\n{text}"));
    let stated = output.report.expect("a proof").deviation;
    Run { asked: cl_points(&text), written: cuts(&output.text), radius: 1.0, stated }
}

/// A job with six decimals, and its program as the input of another machine.
fn run_of_a_program(random: &mut Random, digits: u8) -> Run {
    let fine = machine("sinumerik", "");
    let run = run_of_rows(random);
    let first = compiled(&run, &fine, &Options::default()).unwrap_or_else(|e| panic!("{e:?}\n{run}"));
    let to = machine(DIALECTS[random.below(3)], &format!("[digits]\nlinear = {digits}\nrotary = {digits}\n"));
    let sources = Sources::new(Source::new("first.mpf", first.text.as_str()));
    let options = Options { tolerance: Some(0.2), ..Options::default() };
    let output = recompile(&sources, &fine, &to, &options).unwrap_or_else(|e| panic!("{:?}", e.diagnostics));
    let stated = output.report.expect("a proof").deviation;
    // A program states no radius: a degree counts as a millimetre.
    Run { asked: cuts(&first.text), written: cuts(&output.text), radius: 1.0f64.to_degrees(), stated }
}

fn run_of_rows(random: &mut Random) -> String {
    let row = |random: &mut Random| {
        let row: Vec<String> = (0..4).map(|_| format!("{:.7}", random.from(-90.0, 90.0))).collect();
        format!("[{}]", row.join(", "))
    };
    let rows: Vec<String> = (0..2 + random.below(12)).map(|_| row(random)).collect();
    format!(
        "name = \"RUN\"\n[process]\nfeed = 1000.0\nretract = {{ axis = \"Z\", to = 150.0 }}\n[[curve]]\n\
         kind = \"points\"\naxes = [\"X\", \"Y\", \"Z\", \"A\"]\npoints = [{}]\n",
        rows.join(", ")
    )
}

#[test]
fn stated_bounds_of_500_runs_are_distances_and_hardly_more() {
    let mut random = Random(12);
    let began = std::time::Instant::now();
    let kinds = ["three axes", "a radius", "five axes", "a program"];
    for (kind, name) in kinds.iter().enumerate() {
        let (mut shares, mut turns) = (Vec::new(), Vec::new());
        for i in 0..125 {
            let digits = if i % 2 == 0 { 2 } else { 4 };
            let run = match kind {
                0 => run_of_a_job(&mut random, digits, false),
                1 => run_of_a_job(&mut random, digits, true),
                2 => run_of_five_axes(&mut random, digits),
                _ => run_of_a_program(&mut random, digits),
            };
            let (mm, rad) = farthest(&run.written, &run.asked, run.radius);
            let stated = run.stated;
            assert!(0.0 < mm && mm <= stated.mm + NOISE, "{name} {i}: {mm} above {}", stated.mm);
            assert!(rad <= stated.rad + ANGLE_NOISE, "{name} {i}: {rad} above {}", stated.rad);
            shares.push(stated.mm / mm);
            if 0.0 < rad {
                turns.push(stated.rad / rad);
            }
        }
        let median = |all: &mut Vec<f64>| {
            all.sort_by(f64::total_cmp);
            all.get(all.len() / 2).copied().unwrap_or(1.0)
        };
        let (share, turn) = (median(&mut shares), median(&mut turns));
        println!("{name}: {share:.4} of the distance, {turn:.4} of the angle, in the median");
        assert!(share < 1.05 && turn < 1.05, "{name}: {share} {turn}");
    }
    println!("{:.1} s", began.elapsed().as_secs_f64());
}
