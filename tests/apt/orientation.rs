//! The direction of the tool: five axes in every dialect.

use super::{cases, input, machine, program, verified};
use splinepost::diagnostic::Diagnostics;
use splinepost::geom::elementary;
use splinepost::machine::Machine;
use splinepost::pass::check;
use splinepost::source::{Source, SourceId, Sources};
use splinepost::{Options, Output, compile, front};
use std::fs;

/// The cases of five axes, by name and text.
fn tilted() -> Vec<(String, String)> {
    let five =
        ["catia-five-arcs", "catia-five-axes", "catia-second-curve", "creo-second-curve", "nx-five-axes"];
    let of = |case: &std::path::PathBuf| {
        let name = case.file_name()?.to_string_lossy().into_owned();
        let text = fs::read_to_string(input(case)).ok()?;
        five.contains(&name.as_str()).then_some((name, text))
    };
    let all: Vec<_> = cases().iter().filter_map(of).collect();
    assert_eq!(all.len(), five.len());
    all
}

fn in_motion(text: &str, machine: &Machine, motion: &str) -> Result<Output, Diagnostics> {
    let sources = Sources::new(Source::new("input.cl", text));
    let motion = machine.dialect.motion(motion);
    let options = Options { motion, ..Options::default() };
    let language = front::detect(sources.get(SourceId::INPUT).expect("the input")).expect("a language");
    compile(&sources, language, machine, &options).map_err(|failure| failure.diagnostics)
}

fn square(x: f64) -> f64 {
    x * x
}

/// Every number of a block behind one of these words.
fn numbers(block: &str, words: &[&str]) -> Vec<f64> {
    words
        .iter()
        .map(|word| {
            let value = block.split(' ').find_map(|part| part.strip_prefix(word)).expect(word);
            value.parse().expect(word)
        })
        .collect()
}

/// Figure 8 of the third seed: its block as printed, but for `Y-52.679898` of N110, where figure 7 has -52.67898.
const FIGURE_8: [[f64; 7]; 7] = [
    [67.76826, -52.67898, 210.92639, 103.66057, -52.688, 252.60063, 0.0],
    [67.16855, -52.7024, 210.21829, 103.06085, -52.71142, 251.89253, 0.0],
    [66.16709, -52.34892, 209.23191, 102.05939, -52.35794, 250.90615, 2.78157],
    [64.93429, -51.23395, 208.35718, 100.82659, -51.24297, 250.03142, 1.4042],
    [63.96272, -49.91019, 207.89007, 99.85502, -49.91921, 249.56431, 1.39289],
    [63.47366, -48.75558, 207.89878, 99.36596, -48.7646, 249.57302, 2.27356],
    [63.2851, -48.03474, 208.03981, 99.1774, -48.04376, 249.71405, 0.0],
];

#[test]
fn figure_7_becomes_figure_8() {
    let (_, text) = tilted().into_iter().find(|(name, _)| name == "catia-second-curve").expect("the case");
    let output = in_motion(&text, &machine("extends = \"sinumerik\""), "bspline").expect("a program");
    let blocks: Vec<&str> =
        output.text.lines().skip_while(|line| !line.ends_with("ORICURVE")).skip(1).take(7).collect();
    for (i, (block, printed)) in blocks.iter().zip(FIGURE_8).enumerate() {
        let mut words = vec!["X", "Y", "Z", "XH=", "YH=", "ZH="];
        if 0 < i {
            // The first of them is the straight block that states the start.
            words.push("PL=");
        }
        assert_eq!(numbers(block, &words), printed[..words.len()], "{block}");
    }
    assert!(blocks[1].contains(" BSPLINE SD=3 "), "{}", blocks[1]);
    // Knots that are inserted into the second spline move its points by up to half a unit of the sixth decimal.
    assert!(output.report.expect("a proof").deviation.mm < 1e-6);
}

#[test]
fn every_motion_is_proved_and_read_back_to_the_same_bytes() {
    for (name, input) in tilted() {
        for dialect in splinepost::dialect::DIALECTS {
            let own = crate::support::five(dialect.name);
            for motion in ["linear", "poly", "bspline"] {
                if dialect.motion(motion).is_none() {
                    continue;
                }
                let output = in_motion(&input, &own, motion)
                    .unwrap_or_else(|e| panic!("{name} {} {motion}: {e:?}", dialect.name));
                let report = output.report.expect("a proof");
                assert!(report.deviation.mm <= own.tolerance, "{name} {motion}: {:?}", report.deviation);
                assert!(report.deviation.rad.to_degrees() <= own.orientation.tolerance, "{name} {motion}");
                verified(&input, &output.text, &own)
                    .unwrap_or_else(|e| panic!("{name} {} {motion}: {e:?}", dialect.name));
                let five = own.clone().for_program(&output.text);
                let reading = (dialect.read)(&output.text, SourceId::INPUT, &five).expect("a reading").value;
                let legal = check::check(reading.decimals, &five).expect("a legal program").value;
                assert_eq!((dialect.write)(&legal, &five), output.text, "{name} {} {motion}", dialect.name);
            }
        }
    }
}

/// de Boor's scheme, straight from the definition: a cubic on clamped knots.
fn de_boor(knots: &[f64], points: &[[f64; 6]], t: f64) -> [f64; 6] {
    let last = points.len() - 1;
    let k = (3..=last).rev().find(|k| knots[*k] <= t).unwrap_or(3);
    let mut d: Vec<[f64; 6]> = (0..4).map(|j| points[j + k - 3]).collect();
    for r in 1..4 {
        for j in (r..4).rev() {
            let (low, high) = (knots[j + k - 3], knots[j + 1 + k - r]);
            let a = (t - low) / (high - low);
            d[j] = std::array::from_fn(|i| (1.0 - a) * d[j - 1][i] + a * d[j][i]);
        }
    }
    d[3]
}

/// Lines of the text against the curve of figure 7, both evaluated here: in order, tip and direction within what is stated.
#[test]
fn lines_follow_the_second_curve() {
    let points: Vec<[f64; 6]> =
        FIGURE_8.iter().map(|row| [row[0], row[1], row[2], row[3], row[4], row[5]]).collect();
    let mut knots = vec![0.0, 0.0];
    for row in FIGURE_8 {
        knots.push(knots[knots.len() - 1] + row[6]);
    }
    let end = knots[knots.len() - 1];
    knots.extend([end, end]);
    let places: Vec<([f64; 3], [f64; 3])> = (0..=20_000)
        .map(|i| {
            let p = de_boor(&knots, &points, end * f64::from(i) / 20_000.0);
            let d: [f64; 3] = std::array::from_fn(|i| p[3 + i] - p[i]);
            let size = d.iter().map(|x| x * x).sum::<f64>().sqrt();
            ([p[0], p[1], p[2]], d.map(|x| x / size))
        })
        .collect();
    let (_, text) = tilted().into_iter().find(|(name, _)| name == "catia-second-curve").expect("the case");
    for (name, words) in
        [("heidenhain", ["X", "Y", "Z", "TX", "TY", "TZ"]), ("mazak", ["X", "Y", "Z", "I", "J", "K"])]
    {
        let output = in_motion(&text, &crate::support::five(name), "linear").expect("a program");
        // From where the curve starts, rounded, to where it ends.
        let all: Vec<Vec<f64>> = output
            .text
            .lines()
            .filter(|line| words.iter().all(|word| line.split(' ').any(|part| part.starts_with(word))))
            .filter(|line| !line.starts_with('('))
            .map(|line| numbers(line, &words))
            .collect();
        let at = |tip: [f64; 3]| all.iter().position(|p| (0..3).all(|i| (p[i] - tip[i]).abs() < 1e-4));
        let (first, last) =
            (at([67.7683, -52.679, 210.9264]).unwrap(), at([63.2851, -48.0347, 208.0398]).unwrap());
        assert!(first + 10 < last, "{name}: {first} {last}");
        let (mut from, mut worst, mut turned) = (0, 0.0f64, 0.0f64);
        for pair in all[first..=last].windows(2) {
            for s in 0..10 {
                let s = f64::from(s) / 10.0;
                let p: Vec<f64> = (0..6).map(|i| pair[0][i] + s * (pair[1][i] - pair[0][i])).collect();
                let off = |k: usize| (0..3).map(|i| square(places[k].0[i] - p[i])).sum::<f64>();
                // The nearest place, not behind the one before.
                let near =
                    (from..places.len().min(from + 2000)).min_by(|a, b| off(*a).total_cmp(&off(*b))).unwrap();
                from = near;
                worst = worst.max(off(near).sqrt());
                let size = (3..6).map(|i| p[i] * p[i]).sum::<f64>().sqrt();
                let apart = (0..3).map(|i| square(places[near].1[i] - p[3 + i] / size)).sum::<f64>().sqrt();
                // The chord of a small angle: shorter than it by some 1e-12 here.
                turned = turned.max(apart);
            }
        }
        let report = output.report.expect("a proof");
        // Places are some 4e-4 mm apart, so that a distance seen at one is too great by less than that squared over twice it.
        assert!(worst <= report.deviation.mm + 1e-4, "{name}: {worst} {:?}", report.deviation);
        assert!(0.5 * report.deviation.mm < worst, "{name}: {worst} {:?}", report.deviation);
        assert!(turned <= report.deviation.rad + 1e-7, "{name}: {turned} {:?}", report.deviation);
    }
}

/// Each number of each word that states a direction, changed by more than the machine allows, is refused.
#[test]
fn damaged_directions_are_refused() {
    let (mut tried, mut missed) = (0, Vec::new());
    for (case, input) in tilted() {
        for (name, motion, words) in [
            ("sinumerik", "bspline", &["A3=", "B3=", "C3=", "XH=", "YH=", "ZH="][..]),
            ("sinumerik", "poly", &["A3=", "B3=", "C3=", "PO[XH]=(", "PO[YH]=(", "PO[ZH]=("]),
            ("heidenhain", "linear", &["TX", "TY", "TZ"]),
            ("mazak", "linear", &["I", "J", "K"]),
        ] {
            let own = crate::support::five(name);
            let text = in_motion(&input, &own, motion).expect("a program").text;
            let lines: Vec<&str> = text.lines().collect();
            for (i, line) in lines.iter().enumerate() {
                // Of a run of lines every third is enough.
                if line.starts_with(['(', ';']) || (motion == "linear" && i % 3 != 0) {
                    continue;
                }
                let parts: Vec<&str> = line.split(' ').collect();
                for (j, part) in parts.iter().enumerate() {
                    let Some(word) = words.iter().find(|word| part.starts_with(**word)) else { continue };
                    let number: String = part[word.len()..]
                        .chars()
                        .take_while(|c| c.is_ascii_digit() || "+-.".contains(*c))
                        .collect();
                    let Ok(value) = number.parse::<f64>() else { continue };
                    // 0.5 mm at the second point, some 50 mm and more away; 0.01 of a direction.
                    let by = if word.contains('H') { 0.5 } else { 0.01 };
                    let changed = format!("{:.4}", value + by);
                    if !word.contains('H') {
                        // A component along the direction changes its length and hardly the direction.
                        let mut d = numbers(line, &words[..3]);
                        let e = d.clone();
                        let k = words.iter().position(|other| other == word).expect("one of them");
                        d[k % 3] = value + by;
                        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
                        // 1 − cos δ is δ²/2 for small angles.
                        let cosine = dot(&d, &e) / (dot(&d, &d) * dot(&e, &e)).sqrt();
                        if 1.0 - cosine <= 0.5 * square(own.orientation.tolerance.to_radians()) {
                            continue;
                        }
                    }
                    let mut damaged = parts.clone();
                    let own_part = format!("{word}{changed}{}", &part[word.len() + number.len()..]);
                    damaged[j] = &own_part;
                    let mut all: Vec<String> = lines.iter().map(|line| (*line).to_owned()).collect();
                    all[i] = damaged.join(" ");
                    tried += 1;
                    if verified(&input, &(all.join("\n") + "\n"), &own).is_ok() {
                        missed.push(format!("{case} {name} {motion}: {line}\n  {}", all[i]));
                    }
                }
            }
        }
    }
    assert!(200 < tried, "{tried}");
    assert!(missed.is_empty(), "{} of {tried}:\n{}", missed.len(), missed.join("\n"));
}

/// Before the tool is tilted it is retracted, and no retraction stands between its call and its first move.
#[test]
fn the_tool_turns_at_safe_height() {
    let (_, input) = tilted().into_iter().find(|(name, _)| name == "catia-five-axes").expect("the case");
    let own = machine("extends = \"sinumerik\"\n[orientation]\nsafe_height = 150.0\n");
    let text = in_motion(&input, &own, "linear").expect("a program").text;
    let lines: Vec<&str> =
        text.lines().map(|line| line.split_once(' ').map_or(line, |(_, rest)| rest)).collect();
    let tools: Vec<usize> = (0..lines.len()).filter(|i| ["T1", "T2"].contains(&lines[*i])).collect();
    assert_eq!(tools.len(), 2);
    for at in tools {
        assert!(
            lines[..at].iter().rev().take(2).any(|line| line.starts_with("G0 SUPA Z0")),
            "{:?}",
            &lines[at - 3..at]
        );
        let on = at + lines[at..].iter().position(|line| *line == "TRAORI").expect("TRAORI");
        assert!(!lines[at..on].iter().any(|line| line.contains("SUPA")));
        let first = lines[on..].iter().find(|line| line.starts_with("G0 X")).expect("a rapid");
        assert_eq!(numbers(first, &["Z"]), [150.0], "{first}");
    }
    // The second tool goes down along its own axis, 30 degrees from Z: 81.71573 mm up are 47.17860 mm aside.
    let second =
        lines.iter().filter(|line| line.starts_with("G0 X") && line.contains("Z150 ")).nth(1).expect("it");
    assert!((numbers(second, &["X"])[0] - 75.462_9).abs() < 1e-3, "{second}");
}

/// An arc in which the tool keeps its direction is one where the control's manual says so, with the direction in its block.
#[test]
fn arcs_are_arcs_where_the_tool_keeps_its_direction() {
    let (_, input) = tilted().into_iter().find(|(name, _)| name == "catia-five-arcs").expect("the case");
    let text = |own: &str| in_motion(&input, &machine(own), "linear").expect("a program").text;
    let sinumerik = text("extends = \"sinumerik\"");
    for block in [
        "G17 G3 X0 Y20 I-20 J0 A3=0.5 B3=0 C3=0.866025",
        "CIP Y13 Z1 I1=AC(0) J1=AC(16.707107) K1=AC(1.949747) A3=0 B3=0.5 C3=0.866025",
        "CIP X15 Y14 Z8 I1=AC(13.535534) J1=AC(11.171573) K1=AC(5.87868) A3=0 B3=0.5 C3=0.866025",
    ] {
        assert!(sinumerik.contains(block), "{sinumerik}");
    }
    let lines = text("extends = \"sinumerik\"\n[orientation]\narcs = false\n");
    assert!(!lines.contains("G3") && !lines.contains("CIP"), "{lines}");
    // In Klartext no page says it, so that it is the machine file's to say: in X Y, where C lies.
    let (built_in, told) =
        (text("extends = \"heidenhain\""), text("extends = \"heidenhain\"\n[orientation]\narcs = true\n"));
    assert!(!built_in.contains(" CC ") && built_in.lines().count() > told.lines().count(), "{built_in}");
    assert!(told.contains(" CC X+0 Y+0\n") && told.contains(" C X+0 Y+20 DR+\n"), "{told}");
    // I J K would be the direction and the centre at once.
    let mazak = Machine::parse("extends = \"mazak\"\n[orientation]\narcs = true\n", SourceId::INPUT);
    assert_eq!(mazak.expect_err("I J K").0[0].id, "directed-arcs");
    let planes = Machine::parse("extends = \"heidenhain\"\n[arcs]\nplanes = true\n", SourceId::INPUT);
    assert_eq!(planes.expect_err("no words").0[0].id, "arc-planes");
    // The direction belongs to the block.
    let own = machine("extends = \"sinumerik\"");
    for (from, to) in [
        (" A3=0.5 B3=0 C3=0.866025\nN200", "\nN200"),
        ("I-20 J0 A3=0.5", "I-20 J0 A3=0.6"),
        ("I-20 J0 A3=0.5 ", "I-20 J0 "),
        ("K1=AC(1.949747)", "K1=AC(1.959747)"),
        ("G17 G3", "G17 G2"),
    ] {
        assert!(sinumerik.contains(from), "{from}\n{sinumerik}");
        assert!(verified(&input, &sinumerik.replacen(from, to, 1), &own).is_err(), "{to} for {from}");
    }
}

#[test]
fn what_a_machine_lacks_is_refused() {
    let (_, input) = tilted().into_iter().find(|(name, _)| name == "nx-five-axes").expect("the case");
    let without = machine("extends = \"mazak\"\n[program]\ntip_control = []\n");
    let refused = program("nx", &input, &without).expect_err("no lines lead the tip");
    assert_eq!(refused.0[0].id, "five-axes");
    let (_, spline) = tilted().into_iter().find(|(name, _)| name == "catia-second-curve").expect("the case");
    let refused =
        in_motion(&spline, &machine("extends = \"heidenhain\""), "spl").expect_err("SPL takes none");
    assert_eq!(refused.0[0].id, "spline-direction");
}

/// What the control makes of A3 B3 C3 between two blocks is the machine file's to say, and is told.
#[test]
fn even_rotary_axes_are_told() {
    let (_, input) = tilted().into_iter().find(|(name, _)| name == "catia-five-axes").expect("the case");
    let tilt = machine(
        "extends = \"sinumerik\"\n[orientation]\nturn = \"tilt\"\n[program]\ntip_control = [\"TRAORI\", \"ORIWKS ORIAXES\"]\n",
    );
    let output = in_motion(&input, &tilt, "linear").expect("a program");
    let told = output.setup.turn.expect("a figure");
    // From (0, -sin 10, cos 10) by some 2.5 degrees at a time: a small part of a degree, and not nothing.
    assert!(0.001 < told && told < 1.0, "{told}");
    assert_eq!(in_motion(&input, &machine("extends = \"sinumerik\""), "linear").unwrap().setup.turn, None);
}

/// The first error or refusal of CL data on the default machine of a dialect.
fn refused(text: &str, dialect: &str) -> &'static str {
    let own = crate::support::five(dialect);
    let errors = program("iso", text, &own).map(|output| output.text).expect_err(text);
    errors.0.iter().find(|d| splinepost::diagnostic::Severity::Refusal <= d.severity).expect("an error").id
}

const HEAD: &str = "UNITS/MM\nLOADTL/1\nSPINDL/8000,RPM,CLW\nFEDRAT/500,MMPM\n";

/// Blocks without their numbers.
fn blocks(text: &str) -> Vec<&str> {
    text.lines()
        .map(|line| line.split_once(' ').filter(|(n, _)| n.starts_with('N')).map_or(line, |(_, rest)| rest))
        .collect()
}

#[test]
fn a_cut_that_comes_first_is_begun_where_it_begins() {
    // Tool 2 begins with a cut where tool 1 ended, 60 mm below the greatest height.
    let input = format!(
        "{HEAD}RAPID\nGOTO/0,0,60,0,0,1\nGOTO/50,0,0,0,0,1\nLOADTL/2\nSPINDL/500,RPM,CLW\nGOTO/50,50,0,0.5,0,0.8660254\nFINI\n"
    );
    let own = machine("extends = \"sinumerik\"");
    let text = program("iso", &input, &own).expect("a program").text;
    let blocks = blocks(&text);
    let at = blocks.iter().position(|block| *block == "T2").expect("tool 2");
    let moves: Vec<&&str> = blocks[at..].iter().filter(|block| block.contains("A3=")).collect();
    // The tool stood upright there: straight down at feed, and the cut turns it.
    assert_eq!(*moves[0], "G0 X50 Y0 Z60 A3=0 B3=0 C3=1");
    assert_eq!(*moves[1], "G1 Z0 A3=0 B3=0 C3=1 F500");
    assert_eq!(*moves[2], "Y50 A3=0.5 B3=0 C3=0.866025");
    // Behind it the tilted tool goes up along itself: 60 mm up are 60 tan 30 = 34.641 mm aside.
    assert_eq!(*moves[3], "G0 X84.641016 Y50 Z60 A3=0.5 B3=0 C3=0.866025");
    // Whoever starts the cut elsewhere does not verify.
    let elsewhere = text.replace("G1 Z0 A3=0 B3=0 C3=1 F500", "G1 Z5 A3=0 B3=0 C3=1 F500");
    assert!(verified(&input, &elsewhere, &own).is_err());
}

#[test]
fn where_nothing_is_known_to_be_clear_is_refused() {
    for (input, id) in [
        // No tool, so no length.
        (
            "UNITS/MM\nFEDRAT/500,MMPM\nRAPID\nGOTO/0,0,60,0.6,0,0.8\nGOTO/0,0,0\nFINI\n".to_owned(),
            "tool-missing",
        ),
        // The first move cuts, and nothing is higher.
        (format!("{HEAD}GOTO/0,0,-5,0.6,0,0.8\nGOTO/10,0,-5\nFINI\n"), "safe-height"),
        // An undercut that nothing leaves.
        (format!("{HEAD}RAPID\nGOTO/0,0,60,0,0,1\nGOTO/0,0,0,0.8,0,-0.6\nFINI\n"), "safe-height"),
        // Half a turn has no plane.
        (format!("{HEAD}RAPID\nGOTO/0,0,60,1,0,0\nGOTO/0,0,50,-1,0,0\nFINI\n"), "direction-opposite"),
        // Whether a tilt holds behind MULTAX/OFF or another tool no page says.
        (format!("{HEAD}RAPID\nGOTO/0,0,60,0.6,0,0.8\nMULTAX/OFF\nGOTO/0,0,0\nFINI\n"), "tool-axis-stale"),
        (format!("{HEAD}RAPID\nGOTO/0,0,60,0.6,0,0.8\nLOADTL/2\nGOTO/0,0,0\nFINI\n"), "tool-axis-stale"),
        (
            format!(
                "{HEAD}RAPID\nGOTO/0,0,60,0,0,1\nCYCLE/DRILL,DEPTH,3,MMPM,50,CLEAR,1\nGOTO/5,0,0,0.6,0,0.8\nFINI\n"
            ),
            "cycle-turns",
        ),
    ] {
        for dialect in ["sinumerik", "heidenhain", "mazak"] {
            assert_eq!(refused(&input, dialect), id, "{dialect}: {input}");
        }
    }
}

#[test]
fn a_tool_that_was_changed_is_nowhere_known() {
    // Spot drill and drill over one hole: the second rapid is made although the first tool ended there.
    let hole = "CYCLE/DRILL,DEPTH,3,MMPM,50,CLEAR,2\nGOTO/10,10,0\nCYCLE/OFF\n";
    let input = format!("{HEAD}RAPID\nGOTO/10,10,2\n{hole}LOADTL/2\n{hole}RAPID\nGOTO/0,0,50\nFINI\n");
    let text = program("iso", &input, &machine("extends = \"sinumerik\"")).expect("a program").text;
    let blocks = blocks(&text);
    let at = blocks.iter().position(|block| *block == "T2").expect("tool 2");
    let made = blocks[at..].windows(2).any(|two| two == ["G0 X10 Y10", "Z2"]);
    assert!(made, "{text}");
    // Where a cut follows a tool call, the tool goes over its start first and comes down at feed.
    let input = format!("{HEAD}RAPID\nGOTO/10,10,2\nGOTO/10,10,-3\nLOADTL/2\nGOTO/10,10,-8\nFINI\n");
    for (dialect, block) in [
        ("sinumerik", "G0 X10 Y10\nN210 G1 Z-3 F500\nN220 Z-8\n"),
        ("heidenhain", "L X+10 Y+10 R0 FMAX\n30 L Z-3 F500\n31 L Z-8\n"),
        ("mazak", "G0 X10. Y10.\nG1 G43 H2 Z-3. F500.\nZ-8.\n"),
    ] {
        let text = program("iso", &input, &crate::support::five(dialect)).expect("a program").text;
        assert!(text.contains(block), "{text}");
    }
    // Without a home it would come from wherever the changer left it.
    let homeless = machine("extends = \"sinumerik\"\n[program]\nhome = []\n");
    let errors = program("iso", &input, &homeless).map(|output| output.text).expect_err("no home");
    assert_eq!(errors.0[0].id, "home-missing");
    // Without the word its length holds nowhere.
    let mazak = machine("extends = \"mazak\"");
    let text = program("iso", &input, &mazak).expect("a program").text;
    let errors = verified(&input, &text.replace("G1 G43 H2 ", "G1 "), &mazak).expect_err("no length");
    assert_eq!(errors.0[0].id, "tool-offset-missing");
}

#[test]
fn splines_that_keep_the_direction_are_lines_where_nothing_else_is_known() {
    let (_, input) = tilted().into_iter().find(|(name, _)| name == "creo-second-curve").expect("the case");
    let fixed = input.replace("MOVNRB / 5AXIS, LENGTH, 100.0", "MOVNRB / M3AXIS, LENGTH, 0");
    let lines = fixed.lines().filter(|line| !line.starts_with("MOVNRB / 3"));
    let fixed = lines.collect::<Vec<_>>().join("\n").replace("0.0, 0.0, 1.0", "0.0, 0.6, 0.8") + "\n";
    for (dialect, motion) in [("heidenhain", "spl"), ("mazak", "g06.2")] {
        let own = machine(&format!(
            "extends = \"{dialect}\"\n{}[program]\nplane = []\n",
            if dialect == "mazak" { crate::support::PARK } else { "" }
        ));
        let output = program("creo", &fixed, &own).expect("a program");
        assert_eq!(output.motion.name, "linear");
        assert!(output.warnings.0.iter().any(|d| d.id == "spline-direction"), "{:?}", output.warnings);
        let errors = in_motion(&fixed, &own, motion).expect_err("no page says what they do");
        assert_eq!(errors.0[0].id, "spline-direction");
    }
    // With words for it the direction just stays.
    let led = machine("extends = \"sinumerik\"\n[program]\nplane = []\n");
    let text = in_motion(&fixed, &led, "bspline").expect("a program").text;
    assert!(text.contains("BSPLINE SD=3 X10 Y0 PL=0") && !text.contains("ORICURVE"), "{text}");
}

#[test]
fn lines_under_even_rotary_axes_are_held_to_the_tolerance() {
    let (_, input) = tilted().into_iter().find(|(name, _)| name == "creo-second-curve").expect("the case");
    // Past Z the turn of C is large: no chord is short enough there.
    let own =
        machine(&format!("extends = \"mazak\"\n{}[orientation]\nturn = \"tilt\"\n", crate::support::PARK));
    match program("creo", &input, &own) {
        Ok(output) => {
            let report = output.report.expect("a report");
            assert_eq!(report.status.word(), "sampled");
            assert!(report.deviation.rad.to_degrees() <= own.orientation.tolerance);
        }
        Err(errors) => assert_eq!(errors.0[0].id, "direction-too-far"),
    }
    let wrong = "extends = \"sinumerik\"\n[orientation]\nturn = \"tilt\"\n";
    let errors = Machine::parse(wrong, SourceId::INPUT).expect_err("ORIVECT stands in tip_control");
    assert_eq!(errors.0[0].id, "orientation-turn");
}

/// Lines in six coordinates become one spline with a second curve.
#[test]
fn runs_of_lines_become_a_spline_with_a_second_curve() {
    // The tip on a circle of radius 40, the tool tilted outward by 15 to 20 degrees.
    let point = |i: i32| {
        let u = f64::from(i) / 600.0;
        let (angle, tilt) = (1.5 * u, (15.0 + 5.0 * u).to_radians());
        let (c, s) = (elementary::cos(angle), elementary::sin(angle));
        let (across, up) = (elementary::sin(tilt), elementary::cos(tilt));
        let (x, y, i, j) = (40.0 * c, 40.0 * s, across * c, across * s);
        format!("GOTO/{x:.5},{y:.5},0.0,{i:.7},{j:.7},{up:.7}")
    };
    let points = (0..=600).map(point).collect::<Vec<_>>().join("\n");
    let input = format!(
        "{HEAD}RAPID\nGOTO/40,0,50,0.258819,0,0.965926\n{points}\nRAPID\nGOTO/2.8,39.9,50,0.0241925,0.341164,0.939693\nFINI\n"
    );
    for motion in ["poly", "bspline"] {
        let own = machine(&format!("extends = \"sinumerik\"\nmotion = \"{motion}\"\ntolerance = 0.005\n"));
        let sources = Sources::new(Source::new("input.cl", input.clone()));
        let options = Options { fit: true, ..Options::default() };
        let language = front::find("iso").expect("a language");
        let output = compile(&sources, language, &own, &options)
            .unwrap_or_else(|failure| panic!("{motion}: {:?}", failure.diagnostics));
        let report = output.report.expect("a proof");
        assert!(report.deviation.mm <= 0.005, "{motion}: {:?}", report.deviation);
        assert!(
            report.deviation.rad.to_degrees() <= own.orientation.tolerance,
            "{motion}: {:?}",
            report.deviation
        );
        assert!(output.text.contains("ORICURVE\n") && output.text.contains("XH"), "{}", output.text);
        assert!(report.path_blocks < 60, "{motion}: {} blocks of 601 points", report.path_blocks);
        verified(&input, &output.text, &own).unwrap_or_else(|e| panic!("{motion}: {e:?}"));
    }
}
