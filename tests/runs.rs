//! Runs of points of every kind under `--fit`: splines where they are proved, and lines everywhere else.

use crate::support::{machine, sources};
use splinepost::dialect::DIALECTS;
use splinepost::ir::Written;
use splinepost::machine::Machine;
use splinepost::source::{Source, SourceId};
use splinepost::verify::Status;
use splinepost::{Failure, Options, Output, compile, front, verify_program};
use std::fmt::Write as _;

/// CL data of one run at one feed.
fn cl_data(points: &[[f64; 3]]) -> String {
    let mut text = "PARTNO RUN\nUNITS/MM\nLOADTL/1\nSPINDL/RPM,9000,CLW\nRAPID\n".to_owned();
    for (i, point) in points.iter().enumerate() {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "GOTO/{:.5},{:.5},{:.5}", point[0], point[1], point[2]);
        if i == 0 {
            text.push_str("FEDRAT/400.0,MMPM\n");
        }
    }
    text.push_str("FINI\n");
    text
}

fn options(fit: bool, tolerance: f64) -> Options {
    Options { fit, tolerance: Some(tolerance), ..Options::default() }
}

fn compiled(text: &str, machine: &Machine, options: &Options) -> Result<Output, Failure> {
    compile(&sources(text), front::find("apt").expect("CL data"), machine, options)
}

/// Whether a program is what the CL data ask for.
fn verifies(text: &str, program: &str, machine: &Machine, tolerance: f64) -> bool {
    let mut all = sources(text);
    let id = all.push(Source::new("part.nc", program));
    let language = front::find("apt").expect("CL data");
    verify_program(&all, language, id, machine, &options(false, tolerance)).is_ok()
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

    fn one_of<T: Copy>(&mut self, all: &[T]) -> T {
        all[((self.next() * all.len() as f64) as usize).min(all.len() - 1)]
    }

    /// From 10^low to 10^high, each power as likely.
    fn size(&mut self, low: f64, high: f64) -> f64 {
        splinepost::geom::elementary::exp(self.from(low, high) * std::f64::consts::LN_10)
    }
}

/// A run of arcs, straight and noisy ways, turns at random, zigzags and repeated points, in steps of 0.001 to 10 mm.
fn run(seed: u64) -> Vec<[f64; 3]> {
    use splinepost::geom::elementary::{cos, sin};
    let mut random = Random(seed);
    let (mut at, mut heading) = ([0.0; 3], random.from(0.0, std::f64::consts::TAU));
    let mut points = vec![at];
    for _ in 0..=(6.0 * random.next()) as usize {
        let count = random.one_of(&[1, 2, 3, 5, 20, 100, 300]);
        let (step, noise) = (random.size(-3.0, 1.0), random.size(-4.0, -2.0));
        let bend = random.from(-1.0, 1.0) * random.size(-2.0, 0.5);
        let kind = random.one_of(&["arc", "straight", "noise", "coarse", "zigzag", "repeat", "turn", "fine"]);
        for k in 0..count {
            let step = match kind {
                "arc" => {
                    heading += bend * step;
                    step
                }
                "coarse" => {
                    heading += random.from(-1.0, 1.0);
                    random.from(0.1, 5.0)
                }
                "zigzag" => {
                    heading += if k % 2 == 0 { -2.5 } else { 2.5 };
                    step
                }
                "fine" => {
                    heading += 0.02 * sin(0.1 * f64::from(k));
                    0.05
                }
                "repeat" => 0.0,
                "turn" => {
                    heading += random.from(-3.0, 3.0);
                    0.0
                }
                _ => step,
            };
            at = [at[0] + step * cos(heading), at[1] + step * sin(heading), at[2] + 0.03 * step];
            let off = if kind == "noise" { noise } else { 0.0 };
            points.push(at.map(|x| x + off * random.from(-1.0, 1.0)));
        }
    }
    points
}

#[test]
fn what_goes_through_as_lines_goes_through_with_a_fit() {
    let machines: Vec<Machine> =
        DIALECTS.iter().map(|dialect| machine(&format!("extends = \"{}\"\n", dialect.name))).collect();
    let (mut lines, mut splines, mut mixed, mut saved, mut refused) = (0, 0, 0, 0, 0);
    for seed in 0..150 {
        let points = run(seed);
        let text = cl_data(&points);
        let tolerance = [0.002, 0.01, 0.05][seed as usize % 3];
        for machine in &machines {
            let Ok(plain) = compiled(&text, machine, &options(false, tolerance)) else { continue };
            let motions = machine.dialect.motions.iter().map(Some);
            let motion = motions.chain([None, None]).nth(seed as usize % (machine.dialect.motions.len() + 2));
            let asked = Options { motion: motion.flatten(), ..options(true, tolerance) };
            let output = compiled(&text, machine, &asked);
            let output =
                output.unwrap_or_else(|e| panic!("{seed} {} {motion:?}: {:?}", machine.name, e.diagnostics));
            let report = output.report.as_ref().expect("a report");
            assert_eq!(report.status, Status::Proved, "{seed} {}", machine.name);
            assert!(report.deviation.mm <= tolerance, "{seed} {}: {:?}", machine.name, report.deviation);
            assert!(verifies(&text, &output.text, machine, tolerance), "{seed} {}", machine.name);
            refused += usize::from(output.warnings.0.iter().any(|warning| warning.id == "fit-refused"));
            // A spline stands for as many lines, and the rest is as it was.
            let before = plain.report.as_ref().expect("a report").path_blocks;
            match &report.splined {
                Some(splined) => {
                    let kept = before - splined.lines;
                    assert_eq!(report.path_blocks, kept + splined.blocks, "{seed} {}", machine.name);
                    saved += usize::from(report.path_blocks < before);
                    splines += 1;
                    mixed += usize::from(0 < kept);
                }
                None => {
                    assert_eq!(report.path_blocks, before, "{seed} {}", machine.name);
                    lines += 1;
                }
            }
        }
    }
    println!(
        "{splines} with splines, {mixed} of them with lines too, {saved} shorter; {lines} lines; {refused} given up"
    );
    // The kinds of runs are about as many as each other, and each answer is one that the test sees.
    assert!(100 < splines && 20 < mixed && 100 < saved && 40 < lines);
    // The rule that keeps lines in a run keeps whole programs of lines for what it cannot see: rounding.
    assert!(50 * refused < splines, "{refused}");
}

/// A wave at 1.27 mm, whose lines are up to 0.09 mm from any curve through their ends, about the middle of another wave at
/// 0.05 mm, whose lines are within 0.0002 mm.
fn partly() -> Vec<[f64; 3]> {
    let at = |x: f64| [x, 5.0 * splinepost::geom::elementary::sin(0.3 * x), 0.0];
    let fine = |from: f64| (0..400).map(move |i| at(from + 0.05 * f64::from(i)));
    let coarse = (0..24).map(|i| at(20.0 + 1.25 * f64::from(i)));
    fine(0.0).chain(coarse).chain(fine(50.0)).collect()
}

#[test]
fn coarse_points_stay_lines() {
    let points: Vec<[f64; 3]> = (0..60)
        .map(|i| 1.27 * f64::from(i))
        .map(|x| [x, 5.0 * splinepost::geom::elementary::sin(0.3 * x), 0.0])
        .collect();
    let text = cl_data(&points);
    for dialect in DIALECTS {
        let machine = machine(&format!("extends = \"{}\"\n", dialect.name));
        for tolerance in [0.001, 0.01] {
            let plain = compiled(&text, &machine, &options(false, tolerance)).expect("it compiles");
            for motion in dialect.motions.iter().map(Some).chain([None]) {
                let asked = Options { motion, ..options(true, tolerance) };
                let output = compiled(&text, &machine, &asked)
                    .unwrap_or_else(|e| panic!("{} {motion:?}: {:?}", dialect.name, e.diagnostics));
                assert_eq!(output.text, plain.text, "{} {motion:?}", dialect.name);
                assert!(output.warnings.0.iter().any(|note| note.id == "nothing-fitted"));
            }
        }
    }
}

#[test]
fn a_run_that_fits_partly_is_fitted_partly() {
    let points = partly();
    let text = cl_data(&points);
    for dialect in DIALECTS {
        let machine = machine(&format!("extends = \"{}\"\n", dialect.name));
        let output = compiled(&text, &machine, &options(true, 0.005));
        let output = output.unwrap_or_else(|e| panic!("{}: {:?}", dialect.name, e.diagnostics));
        let report = output.report.as_ref().expect("a report");
        let splined = report.splined.as_ref().expect("splines");
        // All 799 fine lines, and of the coarse ones at most those where the wave turns over, three times, and is nearly straight.
        assert!((799..=805).contains(&splined.lines), "{}: {splined:?}", dialect.name);
        assert!(10 * splined.blocks < splined.lines, "{}: {splined:?}", dialect.name);
        assert_eq!(report.path_blocks, splined.blocks + points.len() - 1 - splined.lines);
        let reading = (dialect.read)(&output.text, SourceId::INPUT, &machine).expect("it is read");
        let cuts = reading.value.decimals.program.steps.iter().filter_map(|located| located.step.cut());
        let cuts = cuts.map(|cut| matches!(cut.curve, Written::Lines(_)));
        assert_eq!(cuts.collect::<Vec<_>>(), [false, true, false], "{}\n{}", dialect.name, output.text);
        assert!(verifies(&text, &output.text, &machine, 0.005));
    }
}

/// Splines and lines in turn are met in their order, and nothing more: what is dropped, doubled, swapped or changed is refused.
#[test]
fn damage_to_a_run_that_is_partly_fitted_is_refused() {
    let text = cl_data(&partly());
    let mut count = 0;
    for dialect in DIALECTS {
        let machine = machine(&format!("extends = \"{}\"\n", dialect.name));
        let program = compiled(&text, &machine, &options(true, 0.005)).expect("it compiles").text;
        let all: Vec<&str> = program.lines().collect();
        // The first digit of the block's X.
        let digit_of = |line: &str| {
            let valued = |(at, _): (usize, &str)| {
                let rest = &line[at + 1..];
                let digit = rest.find(|c: char| c.is_ascii_digit())?;
                rest[..digit].chars().all(|c| "]=(+-".contains(c)).then_some(at + 1 + digit)
            };
            let first = line.match_indices('X').next().filter(|_| line.contains('Y'));
            first.and_then(valued).filter(|_| !line.starts_with([';', '(']))
        };
        let places: Vec<usize> = (0..all.len()).filter(|i| digit_of(all[*i]).is_some()).collect();
        // Behind the rapid.
        for &i in &places[1..] {
            let dropped = [&all[..i], &all[i + 1..]].concat();
            let doubled = [&all[..=i], &all[i..]].concat();
            let digit = digit_of(all[i]).expect("a digit");
            let mut word = all[i].to_owned();
            let value = all[i].as_bytes()[digit] - b'0';
            word.replace_range(digit..=digit, &((value + 3) % 10).to_string());
            let mut changed = all.clone();
            changed[i] = &word;
            for other in [dropped, doubled, changed] {
                let other = other.join("\n") + "\n";
                assert!(!verifies(&text, &other, &machine, 0.005), "{}: {}", dialect.name, all[i]);
                count += 1;
            }
        }
    }
    assert!(200 < count, "{count}");
}
