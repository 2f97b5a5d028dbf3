//! Two programs beside each other: the same in any dialect, and every change found where it is.

use crate::support::{compiled, folder, input, machine, sources};
use splinepost::diagnostic::{Diagnostics, Severity};
use splinepost::diff::{Comparison, Options, Origin, compare, detect};
use splinepost::front;
use splinepost::machine::Machine;
use splinepost::source::{LineColumn, Source, SourceId, Sources};
use std::fs;
use std::process::{Command, Output};

const NAMES: [&str; 3] = ["sinumerik", "heidenhain", "mazak"];

/// The machine of a program: a built-in one, or the Mazak whose park place its end names.
fn machine_of(text: &str) -> Result<Machine, Diagnostics> {
    if text.contains("\nG0 G53 X-500.\n") {
        return Ok(crate::support::five("mazak"));
    }
    detect(&Sources::new(Source::new("part.nc", text)))
}

fn program(text: &str) -> (Sources, Origin) {
    let machine = machine_of(text).unwrap_or_else(|errors| panic!("{errors:?}"));
    (Sources::new(Source::new("part.nc", text)), Origin::Program(Box::new(machine)))
}

fn within(a: &str, b: &str, tolerance: Option<f64>) -> Result<Comparison, Diagnostics> {
    let (a, own) = program(a);
    let other = machine_of(b).map(|machine| Origin::Program(Box::new(machine)));
    let other = other.unwrap_or_else(|_| own.clone());
    let b = Sources::new(Source::new("other.nc", b));
    compare([&a, &b], [&own, &other], &Options { tolerance, radius: None })
}

fn same(a: &str, b: &str) -> bool {
    within(a, b, None).unwrap_or_else(|errors| panic!("{errors:?}")).figures.same
}

/// A job as every built-in machine has it.
fn written(job: &str) -> [String; 3] {
    NAMES.map(|name| {
        let machine = Machine::built_in(name).expect("a built-in");
        compiled(job, &machine, None).unwrap_or_else(|errors| panic!("{errors:?}")).text
    })
}

/// The golden programs of CL data, three of each.
fn golden() -> Vec<(String, [String; 3])> {
    let mut cases = Vec::new();
    for entry in fs::read_dir(folder("fixtures/apt")).expect("a folder").flatten() {
        let read = |name: &str| fs::read_to_string(entry.path().join(name)).expect("a program");
        let name = entry.file_name().to_string_lossy().into_owned();
        cases.push((name, ["sinumerik.mpf", "heidenhain.h", "mazak.eia"].map(read)));
    }
    cases.sort();
    assert!(9 < cases.len());
    cases
}

/// The lines of both texts that the first difference names.
fn lines(found: &Comparison, b: &str, a: &str) -> [Vec<usize>; 2] {
    let first = &found.differences.0[0];
    let spans = first.span.iter().chain(first.others().map(|(span, _)| span));
    let mut lines = [Vec::new(), Vec::new()];
    for span in spans {
        let second = span.source != SourceId::INPUT;
        let text = if second { b } else { a };
        lines[usize::from(second)].push(LineColumn::of(text, span.start as usize).line);
    }
    lines
}

const MIXED: &str = "name = \"MIXED\"\n[process]\nfeed = 1000\nspindle = 3000\ntool = 3\nretract = { axis = \"Z\", to = 50 }\n\
    [[curve]]\nkind = \"nurbs\"\naxes = [\"X\", \"Y\", \"Z\"]\ndegree = 3\nknots = [0, 0, 0, 0, 10, 20, 35, 45, 60, 60, 60, 60]\n\
    points = [[0, 0, 1], [10, 5, 2], [20, -5, 3], [30, 8, 2], [40, 1, 1], [55, 0, 0], [60, 3, 1], [72, 4, 2]]\n\
    [[curve]]\nkind = \"points\"\naxes = [\"X\", \"Y\", \"Z\"]\npoints = [[72, 4, 2], [80, 4, 2], [80, 14, 2], [70, 14, 3]]\n\
    [[curve]]\nkind = \"nurbs\"\naxes = [\"X\", \"Y\", \"Z\"]\ndegree = 2\nknots = [0, 0, 0, 1, 1, 1]\n\
    points = [[70, 14, 3], [60, 14, 3], [60, 24, 3]]\nweights = [1, 0.7071067811865476, 1]\n";

#[test]
fn one_job_is_the_same_in_every_dialect() {
    for (i, a) in written(MIXED).iter().enumerate() {
        for (j, b) in written(MIXED).iter().enumerate() {
            let found = within(a, b, None).unwrap_or_else(|errors| panic!("{errors:?}"));
            assert!(found.figures.same, "{} {}: {:?}", NAMES[i], NAMES[j], found.differences);
            assert_eq!(found.figures.status, "proved");
            // Each is within 0.001 mm of what was asked.
            let deviation = found.figures.deviation_mm.expect("paths");
            assert!(deviation <= 0.002, "{deviation}");
            // Exactly none of a program with itself, and some between spellings.
            assert_eq!(deviation == 0.0, i == j, "{} {}: {deviation}", NAMES[i], NAMES[j]);
        }
    }
}

#[test]
fn golden_programs_of_three_and_five_axes_are_the_same_in_every_dialect() {
    for (name, texts) in golden() {
        for (i, a) in texts.iter().enumerate() {
            for (j, b) in texts.iter().enumerate() {
                let found = within(a, b, None).unwrap_or_else(|errors| panic!("{name}: {errors:?}"));
                assert!(found.figures.same, "{name}, {} {}: {:?}", NAMES[i], NAMES[j], found.differences);
                assert!(0 < found.figures.paths);
                if i == j {
                    assert_eq!(
                        (found.figures.deviation_mm, found.figures.deviation_rad),
                        (Some(0.0), Some(0.0))
                    );
                }
            }
        }
        // Another program is another one.
        assert!(!same(&texts[0], &written(MIXED)[0]), "{name}");
    }
}

#[test]
fn a_cutter_is_the_same_where_machines_count_degrees_in_f() {
    let cutter = input("D1 = 10\nS = 30\nC = 5\nr = 8\nlength = 30", "");
    let [sinumerik, heidenhain, _] = written(&cutter);
    let found = within(&sinumerik, &heidenhain, None).expect("both are read");
    assert!(found.figures.same, "{:?}", found.differences);
    assert_eq!(found.figures.timed, found.figures.paths);
    let slower = heidenhain.replacen("F1", "F2", 3);
    assert_ne!(slower, heidenhain);
    let found = within(&sinumerik, &slower, None).expect("both are read");
    assert_eq!(found.differences.0[0].id, "time-differs");
    // On one machine F is compared as it stands.
    let found = within(&heidenhain, &slower, None).expect("both are read");
    assert_eq!(found.differences.0[0].id, "feed-differs");
    let figures = within(&heidenhain, &heidenhain, None).expect("both are read").figures;
    assert_eq!((figures.deviation_mm, figures.timed), (Some(0.0), 0));
}

/// Where the numbers of a line start, behind its block number.
fn numbers(line: &str) -> Vec<usize> {
    let bytes = line.as_bytes();
    let numbered = line.starts_with(|c: char| c == 'N' || c.is_ascii_digit());
    let body = if numbered { line.find(' ').unwrap_or(0) } else { 0 };
    let starts = |i: &usize| {
        let before = i.checked_sub(1).map_or(b' ', |k| bytes[k]);
        bytes[*i].is_ascii_digit() && !before.is_ascii_digit() && before != b'.'
    };
    (body..bytes.len()).filter(starts).collect()
}

/// A changed digit of this line's numbers, where it changes one by 0.03 or more: a coefficient of a cubic moves it by at most a
/// quarter as much, and still farther than the tolerance of 0.002 mm.
fn damaged(line: &str) -> Vec<String> {
    let mut all = Vec::new();
    for start in numbers(line) {
        let number: String = line[start..].chars().take_while(|c| c.is_ascii_digit() || *c == '.').collect();
        let whole = number.split('.').next().unwrap_or_default().len();
        let hundredths = number.split('.').nth(1).is_some_and(|part| 2 <= part.len());
        let at = if number.starts_with('0') && hundredths { start + whole + 1 } else { start + whole - 1 };
        let digit = line.as_bytes()[at] - b'0';
        let mut text = line.to_owned();
        text.replace_range(at..=at, &((digit + 3) % 10).to_string());
        all.push(text);
    }
    all
}

#[test]
fn every_changed_number_of_a_motion_is_found_in_its_line() {
    let (mut count, mut refused) = (0, 0);
    let mut programs = written(MIXED).to_vec();
    let (_, contour) = golden().into_iter().find(|(name, _)| name == "nx-contour").expect("the contour");
    programs.extend(contour);
    for text in programs {
        let all: Vec<&str> = text.lines().collect();
        for (i, line) in all.iter().enumerate() {
            let words = line.trim_start_matches(|c: char| c == 'N' || c.is_ascii_digit() || c == ' ');
            // An axis and its value, or PO[X].
            let valued = |rest: &str| rest.starts_with(|c: char| c.is_ascii_digit() || "+-]".contains(c));
            let moves = ['X', 'Y', 'Z'].iter().any(|axis| words.split(*axis).skip(1).any(valued));
            if !moves || words.starts_with([';', '(']) {
                continue;
            }
            for changed in damaged(line) {
                let mut lines_of = all.clone();
                lines_of[i] = &changed;
                let other = lines_of.join("\n") + "\n";
                let found = match within(&text, &other, None) {
                    Ok(found) => found,
                    // What a control would not take is another matter, an arc beside its circle first of all.
                    Err(errors) => {
                        refused += usize::from(errors.0.iter().any(|d| d.id == "arc-misfit"));
                        continue;
                    }
                };
                assert!(!found.figures.same, "{line}\n{changed}");
                assert_eq!(found.differences.worst(), Severity::Refusal);
                let [first, second] = lines(&found, &other, &text);
                // A start that moved is seen where the path begins, and where the one goes on straight the other may be in its
                // next block already: an arc of Klartext, its centre before it.
                let near = |named: &[usize], lines: usize| named.iter().any(|at| at.abs_diff(i + 1) <= lines);
                assert!(
                    near(&first, 6) && near(&second, 3),
                    "{line}\n{changed}\n{:?}",
                    found.differences.0[0]
                );
                // Whichever is named first.
                assert!(!within(&other, &text, None).expect("both are read").figures.same, "{changed}");
                count += 1;
            }
        }
    }
    println!("{count} numbers, {refused} refused");
    assert!(150 < count && 200 < count + refused, "{count} {refused}");
}

#[test]
fn a_dropped_doubled_or_swapped_block_is_found() {
    let mut count = 0;
    for text in written(MIXED) {
        let all: Vec<&str> = text.lines().collect();
        // Behind the plunge: before it rapids lead to where the tool is already.
        let plunge = all.iter().position(|line| line.contains("F1000")).expect("a plunge");
        let names_x = |i: &usize| all[*i].contains(" X") || all[*i].starts_with('X');
        let places: Vec<usize> = (plunge + 1..all.len()).filter(names_x).collect();
        for i in places {
            let dropped: Vec<&str> = [&all[..i], &all[i + 1..]].concat();
            let mut swapped = all.clone();
            swapped.swap(i, i - 1);
            for lines_of in [dropped, swapped] {
                let other = lines_of.join("\n") + "\n";
                let Ok(found) = within(&text, &other, None) else { continue };
                assert!(!found.figures.same, "{}: {}", all[i], i + 1);
                let [first, _] = lines(&found, &other, &text);
                assert!(
                    first.iter().any(|at| at.abs_diff(i + 1) <= 3),
                    "{}: {:?}",
                    all[i],
                    found.differences.0[0]
                );
                count += 1;
            }
        }
    }
    assert!(10 < count, "{count}");
}

#[test]
fn feeds_tools_and_switches_are_told_by_name() {
    let [sinumerik, heidenhain, mazak] = written(MIXED);
    let cases = [
        (&sinumerik, "F1000", "F1001", "feed-differs"),
        (&sinumerik, "N90 T3", "N90 T4", "step-differs"),
        (&sinumerik, "S3000", "S3001", "step-differs"),
        (&sinumerik, "G0 Z50", "G0 Z51", "step-differs"),
        (&heidenhain, "F1000", "F999", "feed-differs"),
        (&heidenhain, "S3000", "S300", "step-differs"),
        (&mazak, "F1000.", "F1000.5", "feed-differs"),
        (&mazak, "S3000", "S30", "step-differs"),
    ];
    for (text, from, to, id) in cases {
        let other = text.replacen(from, to, 1);
        assert_ne!(*text, other, "{from} is not in\n{text}");
        let line = other.lines().zip(text.lines()).position(|(a, b)| a != b).expect("a line") + 1;
        for original in [text, &heidenhain, &sinumerik] {
            let found = within(original, &other, None).unwrap_or_else(|errors| panic!("{from}: {errors:?}"));
            assert_eq!(found.differences.0[0].id, id, "{from}: {:?}", found.differences);
            // From another height the path begins elsewhere too.
            let count = 1 + usize::from(from.starts_with("G0"));
            assert_eq!(found.figures.differences, count, "{from}: {:?}", found.differences);
            let [first, second] = lines(&found, &other, original);
            assert!(second.contains(&line) && !first.is_empty(), "{from}: {second:?}, not {line}");
        }
    }
}

/// CL data of passes at rapids between.
fn passes(order: &[usize]) -> String {
    let pass = |k: &usize| {
        let y = 5 * k;
        format!(
            "RAPID\nGOTO/0,{y},50\nRAPID\nGOTO/0,{y},2\nFEDRAT/500,MMPM\nGOTO/0,{y},0\nGOTO/30,{y},0\nRAPID\nGOTO/30,{y},50\n"
        )
    };
    let all: String = order.iter().map(pass).collect();
    format!("PARTNO PASSES\nUNITS/MM\nLOADTL/1\nSPINDL/3000,RPM,CLW\n{all}FINI\n")
}

#[test]
fn a_pass_more_is_one_difference() {
    let machine = Machine::built_in("sinumerik").expect("a built-in");
    let text = |order: &[usize]| compiled(&passes(order), &machine, None).expect("it compiles").text;
    let whole = text(&[0, 1, 2, 3, 4]);
    for (order, id) in [(vec![0, 1, 3, 4], "step-missing"), (vec![0, 1, 2, 2, 3, 4], "step-missing")] {
        let other = text(&order);
        for (a, b) in [(&whole, &other), (&other, &whole)] {
            let found = within(a, b, None).expect("both are read");
            assert_eq!(found.figures.differences, 1, "{order:?}: {:?}", found.differences);
            assert_eq!(found.differences.0[0].id, id);
        }
    }
    // The same passes in another order.
    assert!(!same(&whole, &text(&[0, 2, 1, 3, 4])));
}

/// A wave in lines of this length, and back 5 mm beside it.
fn wave(step: f64) -> String {
    let mut points = Vec::new();
    for row in 0..4 {
        let mut x = 0.0;
        while x < 60.0 {
            points.push((row, x));
            x += step;
        }
        points.push((row, 60.0));
    }
    let spelled = points.iter().map(|(row, x)| {
        let at = if row % 2 == 0 { *x } else { 60.0 - x };
        let y = f64::from(5 * row);
        // z = sin(x/8), whose chords of 0.2 mm are off by at most 0.2²/8 · 1/64 = 8e-5 mm.
        format!("[{at:.6}, {y}, {:.6}]", splinepost::geom::elementary::sin(at / 8.0))
    });
    format!(
        "name = \"WAVE\"\n[process]\nfeed = 1000\nspindle = 3000\nretract = {{ axis = \"Z\", to = 50 }}\n[[curve]]\nkind = \"points\"\n\
         axes = [\"X\", \"Y\", \"Z\"]\npoints = [{}]\n",
        spelled.collect::<Vec<_>>().join(", ")
    )
}

#[test]
fn lines_through_other_points_of_one_path_are_the_same() {
    let ([coarse, ..], [fine, _, mazak]) = (written(&wave(0.2)), written(&wave(0.13)));
    for (a, b) in [(&coarse, &fine), (&fine, &coarse), (&coarse, &mazak), (&mazak, &coarse)] {
        let found = within(a, b, None).expect("both are read");
        assert!(found.figures.same, "{:?}", found.differences);
        let deviation = found.figures.deviation_mm.expect("a path");
        // Both chords, and half a unit of four decimals in two axes at both ends.
        assert!(deviation <= 2.0 * 8.0e-5 + 2.0 * 7.1e-5 && 1.0e-5 < deviation, "{deviation}");
        assert!(!within(a, b, Some(1.0e-5)).expect("both are read").figures.same);
    }
    // A point that is moved by 0.5 mm, in lines that share no other point.
    let line = fine.lines().position(|line| line.contains(" X21.")).expect("a line");
    let other: Vec<String> = fine
        .lines()
        .enumerate()
        .map(|(i, l)| if i == line { l.replace(" X21.", " X21.5") } else { l.to_owned() })
        .collect();
    let other = other.join("\n") + "\n";
    for (a, b) in [(&coarse, &other), (&other, &coarse)] {
        let found = within(a, b, None).expect("both are read");
        assert_eq!(found.figures.differences, 1, "{:?}", found.differences);
        let named = lines(&found, b, a);
        let named = if a == &other { &named[0] } else { &named[1] };
        assert!(named.iter().any(|at| at.abs_diff(line + 1) <= 1), "{named:?}, not {}", line + 1);
    }
    // One row run twice is no longer the same, though it is the same set of places.
    let rows: Vec<&str> = fine.lines().collect();
    let ends: Vec<usize> = (0..rows.len()).filter(|i| rows[*i].contains(" Y5")).collect();
    let doubled = [&rows[..=ends[0]], &["G1 Y0", "G1 Y5"], &rows[ends[0] + 1..]].concat().join("\n") + "\n";
    assert!(!same(&fine, &doubled));
}

#[test]
fn an_input_is_compared_with_its_program() {
    for text in written(MIXED) {
        let (b, other) = program(&text);
        let own = Origin::Input(front::find("job").expect("jobs"));
        let a = sources(MIXED);
        let found =
            compare([&a, &b], [&own, &other], &Options::default()).unwrap_or_else(|e| panic!("{e:?}"));
        assert!(found.figures.same, "{:?}", found.differences);
        let found =
            compare([&b, &a], [&other, &own], &Options::default()).unwrap_or_else(|e| panic!("{e:?}"));
        assert!(found.figures.same, "{:?}", found.differences);
        let moved = sources(&MIXED.replace("[80, 14, 2]", "[80, 14.1, 2]"));
        let found =
            compare([&b, &moved], [&other, &own], &Options::default()).unwrap_or_else(|e| panic!("{e:?}"));
        assert_eq!(found.differences.0[0].id, "path-differs");
    }
    let cutter = input("D1 = 10\nS = 30\nC = 5\nr = 8\nlength = 30", "");
    let (b, other) = program(&written(&cutter)[0]);
    let own = Origin::Input(front::find("cutter").expect("cutters"));
    let errors = compare([&sources(&cutter), &b], [&own, &other], &Options::default()).expect_err("a cutter");
    assert_eq!((errors.0[0].id, errors.worst()), ("input-cutter", Severity::Error));
}

#[test]
fn each_program_has_its_own_machine() {
    let shop = machine(
        "extends = \"sinumerik\"\nname = \"shop\"\n[digits]\nlinear = 3\n[program]\nheader = [\"; {name}\", \"G54\"]\n",
    );
    let own = compiled(MIXED, &shop, None).expect("it compiles").text;
    let [text, ..] = written(MIXED);
    let a = Sources::new(Source::new("a.mpf", own.as_str()));
    let (b, other) = program(&text);
    let from = Origin::Program(Box::new(shop));
    let found = compare([&a, &b], [&from, &other], &Options::default()).unwrap_or_else(|e| panic!("{e:?}"));
    assert!(found.figures.same && found.warnings.0.is_empty(), "{:?}", found.differences);
    // Read as the other machine's its header is strange.
    let Ok(found) = compare([&a, &b], [&other, &other], &Options::default()) else { return };
    assert_eq!(found.warnings.0[0].id, "header-differs");
}

fn splinepost(arguments: &[&str], within: &std::path::Path) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_splinepost"));
    command.args(arguments).current_dir(within).output().expect("it runs")
}

#[test]
fn the_command_answers_with_its_exit_code() {
    let dir = tempfile::tempdir().expect("a folder");
    let at = dir.path();
    let [sinumerik, heidenhain, mazak] = written(MIXED);
    fs::write(at.join("a.mpf"), &sinumerik).expect("written");
    fs::write(at.join("b.h"), &heidenhain).expect("written");
    fs::write(at.join("c.eia"), mazak.replacen("F1000.", "F900.", 1)).expect("written");
    let half = sinumerik.find("N230").expect("a block");
    fs::write(at.join("cut.mpf"), &sinumerik[..half]).expect("written");
    fs::write(at.join("words.mpf"), sinumerik.replacen("G1", "G1 Q7", 1)).expect("written");
    fs::write(at.join("garbage.h"), "hello\n").expect("written");
    fs::write(at.join("job.toml"), MIXED).expect("written");
    fs::write(at.join("bad.toml"), MIXED.replace("degree = 3", "degre = 3")).expect("written");
    fs::write(at.join("latin.mpf"), b"; Fr\xe4ser\n").expect("written");
    let cases: &[(&[&str], i32, &str)] = &[
        (&["diff", "a.mpf", "b.h"], 0, "the same motion"),
        (&["diff", "a.mpf", "a.mpf"], 0, "0.00e0 mm"),
        (&["diff", "a.mpf", "./a.mpf", "--from", "sinumerik", "--tolerance", "0.0001"], 0, "the same motion"),
        (&["diff", "a.mpf", "b.h", "--from-a", "sinumerik", "--from-b", "heidenhain"], 0, "the same motion"),
        (&["diff", "job.toml", "b.h"], 0, "the same motion"),
        (&["diff", "a.mpf", "job.toml", "--from-b", "job"], 0, "the same motion"),
        (&["diff", "a.mpf", "c.eia"], 1, "feed-differs"),
        (&["diff", "c.eia", "b.h"], 1, "they differ in 1 place"),
        (&["diff", "a.mpf", "b.h", "--tolerance", "1e-9"], 1, "path-differs"),
        (&["diff", "a.mpf", "none.mpf"], 2, "cannot read none.mpf"),
        (&["diff", "a.mpf", "garbage.h"], 2, "machine-missing"),
        (&["diff", "a.mpf", "cut.mpf", "--from", "sinumerik"], 2, "footer-differs"),
        (&["diff", "words.mpf", "a.mpf", "--from", "sinumerik"], 2, "words.mpf:"),
        (&["diff", "a.mpf", "words.mpf", "--from", "sinumerik"], 2, "words.mpf:"),
        (&["diff", "a.mpf", "b.h", "--from", "sinumerik"], 2, "b.h:"),
        (&["diff", "a.mpf", "b.h", "--from", "fanuk"], 2, "language-unknown"),
        (&["diff", "a.mpf", "bad.toml"], 2, "bad.toml:"),
        (&["diff", "a.mpf", "latin.mpf", "--from", "sinumerik"], 2, "not-utf8"),
        (&["diff", "a.mpf", "b.h", "--tolerance", "0"], 2, "greater than zero"),
        (&["diff", "a.mpf"], 2, "required"),
    ];
    for (arguments, code, word) in cases {
        let output = splinepost(arguments, at);
        let told = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(*code), "{arguments:?}: {told}");
        assert!(told.contains(word), "{arguments:?}: {word} is not in\n{told}");
        assert!(output.stdout.is_empty());
    }
}

#[test]
fn differences_come_as_json_with_both_places() {
    let dir = tempfile::tempdir().expect("a folder");
    let [sinumerik, heidenhain, _] = written(MIXED);
    fs::write(dir.path().join("a.mpf"), &sinumerik).expect("written");
    fs::write(dir.path().join("b.h"), heidenhain.replacen("F1000", "F900", 1)).expect("written");
    let output = splinepost(&["--message-format", "json", "diff", "a.mpf", "b.h"], dir.path());
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    let all: Vec<serde_json::Value> = told
        .lines()
        .map(|line| serde_json::from_str(line).unwrap_or_else(|e| panic!("{e}: {line}")))
        .collect();
    let [difference, last] = &all[..] else { panic!("{told}") };
    assert_eq!((&difference["id"], &difference["file"]), (&"feed-differs".into(), &"a.mpf".into()));
    assert_eq!(difference["others"][0]["file"], "b.h");
    let line = heidenhain.lines().position(|line| line.contains("F1000")).expect("a line") + 1;
    assert_eq!(difference["others"][0]["line"], line);
    assert_eq!((&last["summary"]["same"], &last["summary"]["differences"]), (&false.into(), &1.into()));
}
