//! A program changed in any word, with a block dropped, doubled or swapped, is refused.
//!
//! Blocks have no numbers here, so that what refuses is the meaning; numbers have a test of their own. The digit that
//! is changed is the first that counts: the last decimal of a coordinate may change within the tolerance.

mod golden;

use crate::support::{compiled, input, machine, sources};
use splinepost::diagnostic::{Diagnostics, Severity};
use splinepost::dialect::DIALECTS;
use splinepost::machine::Machine;
use splinepost::source::Source;
use splinepost::{Options, Verified, front, verify_program};

fn verified(input: &str, program: &str, machine: &Machine) -> Result<Verified, Diagnostics> {
    let mut sources = sources(input);
    let id = sources.push(Source::new("program", program));
    let language = front::detect(&Source::new("input.toml", input)).expect("a language");
    verify_program(&sources, language, id, machine, &Options::default())
}

/// Every text that differs from `line` by one fault in one word.
fn faults(line: &str) -> Vec<String> {
    let mut faulty = Vec::new();
    let bytes = line.as_bytes();
    let mut at = 0;
    while at < bytes.len() {
        if bytes[at].is_ascii_digit()
            || (bytes[at] == b'.' && bytes.get(at + 1).is_some_and(u8::is_ascii_digit))
        {
            let start = at;
            while at < bytes.len() && (bytes[at].is_ascii_digit() || bytes[at] == b'.') {
                at += 1;
            }
            // The first digit that is not zero, or the first.
            let place = (start..at).find(|i| (b'1'..=b'9').contains(&bytes[*i])).unwrap_or(start);
            let digit = if bytes[place] == b'9' { b'8' } else { bytes[place] + 1 };
            let mut changed = bytes.to_vec();
            changed[place] = digit;
            faulty.push(changed);
            // The sign.
            let mut signed = bytes.to_vec();
            match start.checked_sub(1).map(|i| bytes[i]) {
                Some(b'-') => signed[start - 1] = b'+',
                Some(b'+') => signed[start - 1] = b'-',
                _ => signed.insert(start, b'-'),
            }
            // Minus zero is zero.
            if (start..at).any(|i| (b'1'..=b'9').contains(&bytes[i])) {
                faulty.push(signed);
            }
        } else {
            at += 1;
        }
    }
    // An axis letter: one that is there already, and one that no machine here has.
    for (from, to) in [(b'X', b'Y'), (b'Y', b'X'), (b'Z', b'Y'), (b'A', b'X'), (b'X', b'V'), (b'A', b'B')] {
        for (i, byte) in bytes.iter().enumerate() {
            let is_word = bytes.get(i + 1).is_some_and(|b| b.is_ascii_digit() || b"+-.]".contains(b));
            if *byte == from && is_word && (i == 0 || !bytes[i - 1].is_ascii_alphabetic()) {
                let mut changed = bytes.to_vec();
                changed[i] = to;
                faulty.push(changed);
            }
        }
    }
    faulty
        .into_iter()
        .map(|bytes| String::from_utf8(bytes).expect("ASCII"))
        .filter(|text| text != line)
        .collect()
}

/// Every program with one fault.
fn damaged(program: &str) -> Vec<(String, String)> {
    let lines: Vec<&str> = program.lines().collect();
    let mut all = Vec::new();
    let mut add = |what: String, lines: Vec<&str>| {
        let text = lines.join("\n") + "\n";
        if text != program {
            all.push((what, text));
        }
    };
    // Of long runs of like blocks the first, some in the middle and the last are enough.
    let is_long = 120 < lines.len();
    let interesting = |i: usize| !is_long || i < 25 || lines.len() < i + 12 || i.is_multiple_of(37);
    for (i, line) in lines.iter().enumerate().filter(|(i, _)| interesting(*i)) {
        for fault in faults(line) {
            let mut changed = lines.clone();
            changed[i] = &fault;
            add(format!("line {}: {line} -> {fault}", i + 1), changed);
        }
        let mut dropped = lines.clone();
        dropped.remove(i);
        add(format!("line {} dropped: {line}", i + 1), dropped);
        let mut doubled = lines.clone();
        doubled.insert(i, line);
        add(format!("line {} doubled: {line}", i + 1), doubled);
        if i + 1 < lines.len() {
            let mut swapped = lines.clone();
            swapped.swap(i, i + 1);
            add(format!("lines {} and {} swapped: {line}", i + 1, i + 2), swapped);
        }
    }
    all
}

#[test]
fn every_fault_is_refused() {
    let mut missed = Vec::new();
    let mut tried = 0;
    for dialect in DIALECTS {
        let machine = machine(&format!(
            "extends = \"{}\"\nname = \"plain\"\n[spline]\naxes = [\"X\", \"Y\", \"Z\", \"A\"]\n[text]\nnumber_step = 0\n",
            dialect.name
        ));
        for motion in dialect.motions {
            let input = input("D1 = 10\nS = 30\nC = 5\nr = 8\nlength = 30\nindex = [0, 97]", "");
            let program = compiled(&input, &machine, Some(motion)).expect("it compiles").text;
            verified(&input, &program, &machine).expect("the sound program verifies");
            for (what, text) in damaged(&program) {
                tried += 1;
                match verified(&input, &text, &machine) {
                    Ok(_) => missed.push(format!("{} {}: {what}", dialect.name, motion.name)),
                    Err(errors) => assert!(Severity::Refusal <= errors.worst(), "{what}: no error"),
                }
            }
        }
    }
    println!("{tried} faults, {} missed", missed.len());
    assert!(missed.is_empty(), "{} of {tried} faults missed:\n{}", missed.len(), missed.join("\n"));
    assert!(2000 < tried, "only {tried} faults were tried");
}

/// Work offsets, calls, parameters and axes that go round: the text means what was asked only as it stands.
#[test]
fn every_fault_of_calls_offsets_and_rounds_is_refused() {
    let (mut missed, mut tried) = (Vec::new(), 0);
    for dialect in DIALECTS {
        let file = format!(
            "extends = \"{}\"\nname = \"calls\"\n[axis.A]\nkind = \"modulo\"\n[spline]\naxes = [\"X\", \"Y\", \"Z\", \"A\"]\n\
             [text]\nnumber_step = 0\n[feed]\nparameter = true\n[program]\nsubprograms = true\n",
            dialect.name
        );
        let machine = machine(&file);
        let calls = input("D1 = 10\nS = 30\nC = 5\nr = 8\nlength = 30\nindex = [0, 97, 270]", "")
            .replace("[process]", "[process]\ncoolant = true\ncorrection = { axis = \"Y\", value = 0.5 }");
        let rounds =
            input("D1 = 4\nS = 60\nC = 2\nr = 8\nlength = 30\nindex = [0, 97]", "dl = 1.0\ntolerance = 0.05");
        for input in [calls, rounds] {
            let program = compiled(&input, &machine, None).expect("it compiles").text;
            verified(&input, &program, &machine).expect("the sound program verifies");
            for (what, text) in damaged(&program) {
                tried += 1;
                match verified(&input, &text, &machine) {
                    Ok(_) => missed.push(format!("{}: {what}", dialect.name)),
                    Err(errors) => assert!(Severity::Refusal <= errors.worst(), "{what}: no error"),
                }
            }
        }
    }
    println!("{tried} faults, {} missed", missed.len());
    assert!(missed.is_empty(), "{} of {tried} faults missed:\n{}", missed.len(), missed.join("\n"));
    assert!(1000 < tried, "only {tried} faults were tried");
}

/// Curves in one section: rational, cubic, quintic. No straight ones: there another pace along the line is the same path.
const JOB: &str = "name = \"JOB\"\n[process]\nfeed = 1000\nretract = { axis = \"Z\", to = 50 }\n\
    [[curve]]\nkind = \"nurbs\"\naxes = [\"X\", \"Y\"]\nat = { Z = -2 }\ndegree = 2\nknots = [0, 0, 0, 1, 1, 1]\n\
    points = [[10, 0], [10, 10], [0, 10]]\nweights = [1, 0.75, 1]\n\
    [[curve]]\nkind = \"bezier\"\naxes = [\"X\", \"Y\", \"Z\"]\npoints = [[0, 10, -2], [-10, 10, -3], [-20, 22, -4], [-20, 40, -6]]\n\
    [[curve]]\nkind = \"polynomial\"\naxes = [\"X\", \"Y\"]\ncoefficients = [[-20, 20, 3, 0, 0, 10], [40, 5, 0, 0, -22]]\n";

#[test]
fn every_fault_of_a_job_is_refused() {
    let mut missed = Vec::new();
    let mut tried = 0;
    for dialect in DIALECTS {
        let machine =
            machine(&format!("extends = \"{}\"\nname = \"plain\"\n[text]\nnumber_step = 0\n", dialect.name));
        for motion in dialect.motions {
            let program = compiled(JOB, &machine, Some(motion)).expect("it compiles").text;
            verified(JOB, &program, &machine).unwrap_or_else(|e| panic!("{}: {e:?}\n{program}", motion.name));
            for (what, text) in damaged(&program) {
                tried += 1;
                match verified(JOB, &text, &machine) {
                    Ok(_) => missed.push(format!("{} {}: {what}", dialect.name, motion.name)),
                    Err(errors) => assert!(Severity::Refusal <= errors.worst(), "{what}: no error"),
                }
            }
        }
    }
    println!("{tried} faults, {} missed", missed.len());
    assert!(missed.is_empty(), "{} of {tried} faults missed:\n{}", missed.len(), missed.join("\n"));
    assert!(2000 < tried, "only {tried} faults were tried");
}

#[test]
fn a_wrong_block_number_is_refused() {
    for dialect in DIALECTS {
        let machine = Machine::built_in(dialect.name).expect("a default machine");
        if machine.text.number_step == 0 {
            continue;
        }
        let input = input("D1 = 10\nS = 30\nC = 5\nr = 8\nlength = 30", "");
        let program = compiled(&input, &machine, None).expect("it compiles").text;
        let numbered = |line: &&str| line.starts_with(|c: char| c == 'N' || c.is_ascii_digit());
        let line = program.lines().filter(numbered).nth(9).expect("ten blocks");
        let fault = faults(line).into_iter().next().expect("a number");
        let errors = verified(&input, &program.replacen(line, &fault, 1), &machine).expect_err("refused");
        assert_eq!(errors.0[0].id, "block-number-differs");
    }
}

/// Near a tip the surface shrinks to nothing, and with it the distance that a wrong A makes there.
#[test]
fn a_wrong_angle_near_a_tip_is_refused() {
    let mazak = machine("extends = \"mazak\"\n");
    let cutter = "D1 = 20\nS = 30\nC = -45\nr = 8\nlength = 9.9999\nlaw = \"constant-lead\"";
    let input = input(cutter, "method = \"odd-even\"\ndl = 20");
    let program = compiled(&input, &mazak, mazak.dialect.motion("linear")).expect("it compiles").text;
    let changed = program.replace("A33.0794", "A82.0794");
    assert_ne!(program, changed);
    assert_eq!(verified(&input, &changed, &mazak).expect_err("refused").0[0].id, "point-differs");
}

#[test]
fn a_pointed_cutter_is_followed_in_a_too() {
    let sinumerik = machine("extends = \"sinumerik\"\n");
    let input = input("D1 = 6\nS = 30\nC = -15\nr = 8\nlength = 11.196", "");
    let output = compiled(&input, &sinumerik, None).expect("it compiles");
    // A counts at a twentieth of the greatest radius, 0.15 mm, at least: 0.001 mm there are 0.0067 rad.
    let rad = output.report.expect("a report").deviation.rad;
    assert!(rad < 0.0067, "{rad}");
}
