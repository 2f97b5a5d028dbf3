//! The remarks at which an operator restarts a program: each dropped, moved, doubled, renamed, swapped.

use super::{compiled, proved};
use crate::support::machine;
use splinepost::diagnostic::Diagnostics;
use splinepost::dialect::DIALECTS;
use splinepost::source::SourceId;
use splinepost::{Options, Output};

/// A cutter of three flutes in two passes.
const CUTTER: &str = "name = \"PART\"\n[cutter]\nD1 = 10\nS = 30\nC = 5\nr = 8\nlength = 10\nflutes = 3\n\
    [interpolation]\n[process]\nfeed = 200\nretract = { axis = \"Z\", to = 500 }\nspindle = 3000\n\
    infeed = { axis = \"Z\", step = 0.5, passes = 2 }\n";

/// Two curves that do not meet.
const JOB: &str = "name = \"PART\"\n[process]\nfeed = 100.0\nretract = { axis = \"Z\", to = 50.0 }\n\
    [[curve]]\nkind = \"points\"\naxes = [\"X\", \"Y\", \"Z\"]\npoints = [[0, 0, 0], [10, 0, -1], [10, 10, -1]]\n\
    [[curve]]\nkind = \"points\"\naxes = [\"X\", \"Y\", \"Z\"]\npoints = [[0, 20, 0], [10, 20, -1], [10, 30, -1]]\n";

/// Two operations with two tools.
const CL: &str = "PARTNO/TWO\nUNITS/MM\nPPRINT/OPERATION 1 ROUGH\nLOADTL/1\nSPINDL/8000,RPM,CLW\nRAPID\nGOTO/0,0,50\nRAPID\n\
    GOTO/0,0,2\nFEDRAT/600.0,MMPM\nGOTO/0,0,-1\nGOTO/10,0,-1\nRAPID\nGOTO/10,0,50\nPPRINT/OPERATION 2 FINISH\nLOADTL/2\n\
    SPINDL/9000,RPM,CLW\nRAPID\nGOTO/0,5,50\nRAPID\nGOTO/0,5,2\nGOTO/0,5,-1\nGOTO/10,5,-1\nRAPID\nGOTO/10,5,50\nFINI\n";

/// The lines of a program that say where a section starts.
fn sections(text: &str) -> Vec<usize> {
    let marks = ["FLUTE", "CURVE", "OPERATION"];
    let is = |line: &str| marks.iter().any(|mark| line.contains(mark)) && !line.contains("PARTNO");
    text.lines().enumerate().filter(|(_, line)| is(line)).map(|(i, _)| i).collect()
}

/// Whether the meaning and the form of a program are what would be written.
fn verified(output: &Output, text: &str) -> Result<(), Diagnostics> {
    proved(output, text)?;
    let read = (output.machine.dialect.read)(text, SourceId::INPUT, &output.machine)?;
    let legal = splinepost::pass::check::check(read.value.decimals, &output.machine)?;
    let written = (output.machine.dialect.write)(&legal.value, &output.machine);
    splinepost::verify::same_form(text, &written, SourceId::INPUT)
}

#[test]
fn every_fault_of_a_section_remark_is_refused() {
    let (mut missed, mut tried, mut by_meaning) = (Vec::new(), 0, 0);
    for dialect in DIALECTS {
        let machine = machine(&format!(
            "extends = \"{}\"\nname = \"plain\"\n[spline]\naxes = [\"X\", \"Y\", \"Z\", \"A\"]\n[text]\nnumber_step = 0\n",
            dialect.name
        ));
        for (input, count) in [(CUTTER, 9), (JOB, 2), (CL, 2)] {
            let output = compiled(input, &machine, &Options::default()).unwrap_or_else(|e| panic!("{e:?}"));
            let text = &output.text;
            verified(&output, text).unwrap_or_else(|e| panic!("{}: {e:?}\n{text}", dialect.name));
            let (lines, at) = (text.lines().collect::<Vec<&str>>(), sections(text));
            assert_eq!(at.len(), count, "{}\n{text}", dialect.name);
            // What must be refused by the meaning alone, and what by it or by the form: a remark that goes over a line that is
            // no step, such as a plane that is stated again, means the same.
            let mut faults: Vec<(String, Vec<String>, bool)> = Vec::new();
            let own = || lines.iter().map(|line| (*line).to_owned()).collect::<Vec<String>>();
            for (n, &i) in at.iter().enumerate() {
                let line = lines[i].to_owned();
                let mut dropped = own();
                dropped.remove(i);
                faults.push((format!("dropped {line}"), dropped, true));
                for to in [i - 1, i + 1] {
                    let mut moved = own();
                    moved.swap(i, to);
                    faults.push((format!("{line} swapped with {}", lines[to]), moved, false));
                }
                // Copies right here, and before every step, within paths too.
                for to in (at[0]..lines.len() - 1).step_by(3).chain([i, i + 1]) {
                    let mut doubled = own();
                    doubled.insert(to, line.clone());
                    faults.push((format!("{line} again before {}", lines[to]), doubled, true));
                }
                let digit = line.find(|c: char| c.is_ascii_digit() && c != '0').expect("a number");
                let changed = if line.as_bytes()[digit] == b'9' { "8" } else { "9" };
                let mut renamed = own();
                renamed[i].replace_range(digit..=digit, changed);
                faults.push((format!("renamed {line}"), renamed, true));
                // One more, of a number that no section has.
                let mut more = own();
                let mut other = line.clone();
                other.replace_range(digit..=digit, "77");
                more.insert(i, other);
                faults.push((format!("another beside {line}"), more, true));
                for &other in &at[n + 1..] {
                    let mut swapped = own();
                    swapped.swap(i, other);
                    faults.push((format!("{line} swapped with {}", lines[other]), swapped, true));
                }
            }
            for (what, fault, means) in faults {
                let fault = fault.join("\n") + "\n";
                tried += 1;
                if fault == *text {
                    continue;
                }
                by_meaning += usize::from(proved(&output, &fault).is_err());
                let found =
                    if means { proved(&output, &fault).map(|_| ()) } else { verified(&output, &fault) };
                if found.is_ok() {
                    missed.push(format!("{}: {what}", dialect.name));
                }
            }
            // A remark of somebody else's is free, before each section and behind the last.
            let note = lines[at[0]].replace(|c: char| c.is_ascii_alphanumeric(), "Q");
            for &i in &at[1..] {
                let mut free = own();
                free.insert(i, note.clone());
                proved(&output, &(free.join("\n") + "\n")).unwrap_or_else(|e| panic!("{note}: {e:?}"));
            }
        }
    }
    println!("{tried} faults, {by_meaning} refused by their meaning, {} missed", missed.len());
    assert!(missed.is_empty(), "{} of {tried} missed:\n{}", missed.len(), missed.join("\n"));
    assert!(300 < tried && 9 * tried < 10 * by_meaning, "{tried} {by_meaning}");
}
