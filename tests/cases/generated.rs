//! Random inputs on random machines: compile either succeeds, or refuses for a fault of the input, never by its own proof.
//!
//! A long run: `SPLINEPOST_INPUTS=20000 SPLINEPOST_SEED=7 cargo test --test tests -- cases::generated`.

use crate::support::no_number;
use crate::support::{machine, sources};
use splinepost::source::SourceId;
use splinepost::summary::Summary;
use splinepost::{Options, compile, front};
use std::fmt::Write as _;

/// SplitMix64 (Steele, Lea, Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: u64) -> u64 {
        self.next() % n
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    fn of<'a, T>(&mut self, all: &'a [T]) -> &'a T {
        &all[self.below(all.len() as u64) as usize]
    }
}

fn a_machine(random: &mut Random) -> String {
    let base = *random.of(&["sinumerik", "heidenhain", "mazak", "sinumerik-840d"]);
    let axes = *random.of(&["", "[spline]\naxes = [\"X\", \"Y\", \"Z\", \"A\"]\n"]);
    let modulo = *random.of(&["", "[axis.A]\nkind = \"modulo\"\n"]);
    let rotary = *random.of(&["", "[feed]\nrotary = \"degrees-as-mm\"\n", "[feed]\nrotary = \"surface\"\n"]);
    format!("extends = \"{base}\"\nname = \"rnd\"\n{axes}{modulo}{rotary}")
}

fn a_cutter(random: &mut Random) -> String {
    format!(
        "name = \"CUT\"\n[cutter]\nD1 = {}\nS = {}\nC = {}\nr = {}\nlength = {}\nlaw = \"{}\"\nhand = \"{}\"\nflutes = {}\n\
         [process]\nfeed = 500.0\nretract = {{ axis = \"Z\", to = 300.0 }}\nspindle = 3000.0\ntravel = \"{}\"\n",
        random.between(0.5, 20.0),
        random.between(0.0, 55.0),
        random.between(-1.0, 12.0),
        random.between(0.0, 15.0),
        random.between(2.0, 12.0),
        random.of(&["constant-helix", "constant-lead"]),
        random.of(&["left", "right"]),
        1 + random.below(3),
        random.of(&["from-D1", "to-D1"]),
    )
}

/// One or two curves, some of whose control points are one, some with weights.
fn a_job(random: &mut Random) -> String {
    let mut text =
        "name = \"JOB\"\nradius = 8.0\n[process]\nfeed = 1000.0\nretract = { axis = \"Z\", to = 50.0 }\n"
            .to_owned();
    let rotary = random.below(3) == 0;
    let names = if rotary { "\"X\", \"Y\", \"A\"" } else { "\"X\", \"Y\"" };
    let mut last: Vec<f64> = (0..if rotary { 3 } else { 2 }).map(|_| random.between(-20.0, 20.0)).collect();
    for _ in 0..=random.below(2) {
        let degree = 1 + random.below(3) as usize;
        let spans = 1 + random.below(4) as usize;
        let mut points = vec![last.clone()];
        while points.len() < degree + spans {
            if random.below(5) != 0 {
                let reach = *random.of(&[0.05, 3.0, 30.0]);
                for x in &mut last {
                    *x += random.between(-reach, reach);
                }
            }
            points.push(last.clone());
        }
        // A curve that is a point is a fault of the input.
        if points.iter().all(|p| *p == points[0]) {
            last[0] += 1.0;
            points.push(last.clone());
            points.remove(1);
        }
        let mut knots = vec![0.0; degree + 1];
        knots.extend((1..spans).map(|i| i as f64));
        knots.extend(vec![spans as f64; degree + 1]);
        write!(
            text,
            "[[curve]]\nkind = \"nurbs\"\naxes = [{names}]\nat = {{ Z = 0.0 }}\ndegree = {degree}\nknots = {knots:?}\npoints = {points:?}\n"
        )
        .expect("a string");
        if random.below(3) == 0 {
            let weights: Vec<f64> = points.iter().map(|_| *random.of(&[1.0, 1.0, 0.4, 3.0, 25.0])).collect();
            writeln!(text, "weights = {weights:?}").expect("a string");
        }
    }
    text
}

/// What an input or its machine can be at fault for.
const FAULTS: [&str; 8] = [
    "arc-length",
    "curve-corner",
    "form-out-of-reach",
    "points-too-many",
    "rotary-range",
    "rotary-wraps",
    "tolerance-below-decimals",
    "tolerance-out-of-reach",
];

fn seeded(name: &str, otherwise: u64) -> u64 {
    std::env::var(name).ok().and_then(|n| n.parse().ok()).unwrap_or(otherwise)
}

#[test]
fn own_programs_are_proved() {
    let (seed, inputs) = (seeded("SPLINEPOST_SEED", 1), seeded("SPLINEPOST_INPUTS", 40));
    let mut compiled = 0;
    for i in 0..inputs {
        let mut random = Random(seed.wrapping_mul(1_000_003).wrapping_add(i));
        let machine_text = a_machine(&mut random);
        let text = if random.below(3) == 0 { a_cutter(&mut random) } else { a_job(&mut random) };
        let options = Options { tolerance: Some(random.between(4.0e-4, 5.0e-3)), ..Options::default() };
        let machine = machine(&machine_text);
        let sources = sources(&text);
        let language = front::detect(sources.get(SourceId::INPUT).expect("an input")).expect("a language");
        let shown = format!("seed {seed}, input {i}, {options:?}\n{machine_text}\n{text}");
        match compile(&sources, language, &machine, &options) {
            Ok(output) => {
                compiled += 1;
                let summary = Summary::new(
                    &output.intent,
                    &output.machine,
                    Some(output.motion.name),
                    &output.text,
                    output.report.as_ref(),
                    output.tolerance,
                    output.setup.clone(),
                );
                let warnings = output.warnings.render(&sources, false);
                for told in [&output.text, &summary.render(), &summary.to_json(), &warnings] {
                    assert_eq!(no_number(told), None, "{shown}\n{told}");
                }
            }
            Err(failure) => {
                let told = failure.diagnostics.render(&sources, false);
                assert!(failure.program.is_none(), "{shown}\n{told}");
                assert!(failure.diagnostics.0.iter().all(|d| FAULTS.contains(&d.id)), "{shown}\n{told}");
            }
        }
    }
    // Most inputs are sound.
    assert!(inputs <= 2 * compiled, "{compiled} of {inputs}");
}
