//! Every golden program with one fault: any word changed, dropped, doubled or moved, any block dropped, doubled, swapped or moved,
//! remarks too. `verify` refuses each that changes what a control or an operator does.
//!
//! `cargo test` tries a sample by seed. `SPLINEPOST_DAMAGE=100000 cargo test -- damage::golden --nocapture` tries as many faults
//! as it says, or all of them, and tells which passed; `SPLINEPOST_DAMAGE_SEED` starts from elsewhere.

use super::faults;
use crate::support::{folder, is_program, machine, sources_in};
use splinepost::diagnostic::{Diagnostics, Severity};
use splinepost::dialect::find;
use splinepost::ir::Step;
use splinepost::machine::Machine;
use splinepost::source::{Source, SourceId, Sources};
use splinepost::{Options, front, translate, verify_program};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// So many faults are tried where nobody says: some seconds.
const SAMPLE: usize = 400;

/// A golden program and what it was made of.
struct Golden {
    path: PathBuf,
    sources: Sources,
    machine: Machine,
    text: String,
}

/// Numbers that are the same on every machine: splitmix64.
struct Random(u64);

impl Random {
    fn below(&mut self, count: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % count as u64) as usize
    }
}

/// The machine of a golden program, by its file's name.
fn machine_of(case: &Path, name: &str) -> Option<Machine> {
    let stem = name.rsplit_once('.')?.0;
    match fs::read_to_string(case.join(format!("{stem}.machine.toml"))) {
        Ok(text) => Some(machine(&text)),
        Err(_) => find(stem).and_then(|dialect| Machine::built_in(dialect.name)),
    }
}

fn golden() -> Vec<Golden> {
    let mut all = Vec::new();
    for folder_name in ["fixtures/compile", "fixtures/curves", "fixtures/apt"] {
        for case in fs::read_dir(folder(folder_name)).expect("a folder").flatten() {
            let case = case.path();
            let mut files: Vec<PathBuf> =
                fs::read_dir(&case).expect("a case").flatten().map(|entry| entry.path()).collect();
            files.sort();
            let name = |path: &Path| path.file_name().expect("a name").to_string_lossy().into_owned();
            let is_input = |path: &&PathBuf| {
                path.file_stem().is_some_and(|stem| stem == "input")
                    && path.extension().is_some_and(|extension| extension != "stderr")
            };
            let Some(input) = files.iter().find(is_input) else { continue };
            let bytes = fs::read(input).expect("an input");
            let text = Source::decode(name(input), bytes).text;
            for path in files.iter().filter(|path| is_program(path)) {
                let Some(machine) = machine_of(&case, &name(path)) else { continue };
                let sources = sources_in(&name(input), &text, &case);
                let text = fs::read_to_string(path).expect("a program");
                all.push(Golden { path: path.clone(), sources, machine, text });
            }
        }
    }
    all.sort_by(|a, b| a.path.cmp(&b.path));
    assert!(80 < all.len(), "only {} golden programs", all.len());
    all
}

fn verified(golden: &Golden, text: &str) -> Result<(), Diagnostics> {
    let mut sources = golden.sources.clone();
    let id = sources.push(Source::new("program", text));
    let language = front::detect(sources.get(SourceId::INPUT).expect("an input"))?;
    verify_program(&sources, language, id, &golden.machine, &Options::default()).map(|_| ())
}

/// A line, and nothing of one that is a remark.
fn code<'l>(line: &'l str, machine: &Machine) -> &'l str {
    let mark = if machine.dialect.least_increments { '(' } else { ';' };
    let numbered = line.strip_prefix('N').unwrap_or(line);
    let body = numbered.trim_start_matches(|c: char| c.is_ascii_digit()).trim_start();
    if body.starts_with(mark) { "" } else { line }
}

/// One fault, and what it is.
fn damaged(text: &str, random: &mut Random) -> Option<(&'static str, String, String)> {
    let lines: Vec<&str> = text.lines().collect();
    let at = random.below(lines.len());
    let line = lines[at];
    let words: Vec<&str> = line.split(' ').collect();
    let word = random.below(words.len());
    let other = random.below(lines.len());
    let mut changed: Vec<String> = lines.iter().map(|line| (*line).to_owned()).collect();
    let joined = |words: &[&str]| words.join(" ");
    let kind = match random.below(12) {
        0 | 1 => {
            let faulty = faults(line);
            if faulty.is_empty() {
                return None;
            }
            changed[at].clone_from(&faulty[random.below(faulty.len())]);
            "a word changed"
        }
        2 => {
            let mut words = words.clone();
            words.remove(word);
            changed[at] = joined(&words);
            "a word dropped"
        }
        3 => {
            let mut words = words.clone();
            words.insert(word, words[word]);
            changed[at] = joined(&words);
            "a word doubled"
        }
        4 => {
            let from = lines[other].split(' ').collect::<Vec<_>>();
            let mut words = words.clone();
            words.push(from[random.below(from.len())]);
            changed[at] = joined(&words);
            "a word of another block added"
        }
        5 => {
            let from = lines[other].split(' ').collect::<Vec<_>>();
            let mut words = words.clone();
            words[word] = from[random.below(from.len())];
            changed[at] = joined(&words);
            "a word replaced by one of another block"
        }
        6 => {
            changed.remove(at);
            "a block dropped"
        }
        7 => {
            changed.insert(at, line.to_owned());
            "a block doubled"
        }
        8 => {
            changed.swap(at, (at + 1) % lines.len());
            "a block swapped with the next"
        }
        9 => {
            let moved = changed.remove(at);
            changed.insert(other.min(changed.len()), moved);
            "a block moved"
        }
        10 => {
            changed.insert(other, line.to_owned());
            "a block copied elsewhere"
        }
        _ => {
            lines[other].clone_into(&mut changed[at]);
            "a block replaced by another"
        }
    };
    let what = format!("line {}: {line} ({})", at + 1, lines[other]);
    let changed = changed.join("\n") + "\n";
    (changed != text).then_some((kind, what, changed))
}

/// The words of a program, block by block, without remarks and block numbers.
fn blocks(text: &str, machine: &Machine) -> Vec<Vec<String>> {
    let lines = text.lines().map(|line| code(line, machine)).filter(|line| !line.trim().is_empty());
    lines.map(|line| line.split_whitespace().map(str::to_owned).collect()).collect()
}

/// What two remarks have in common that an operator could take for each other.
fn gist(remark: &str) -> String {
    let words = remark.split_whitespace().collect::<Vec<_>>().join(" ").to_uppercase();
    let mut signs: Vec<char> = words.chars().map(|c| if c.is_ascii_digit() { '#' } else { c }).collect();
    signs.dedup_by(|a, b| *a == '#' && *b == '#');
    signs.into_iter().collect()
}

/// The remarks of a program, without block numbers and marks.
fn remarks<'l>(text: &'l str, machine: &Machine) -> Vec<&'l str> {
    let lines = text.lines().filter(|line| code(line, machine).is_empty());
    lines
        .filter_map(|line| line.find(['(', ';']).map(|at| line[at..].trim_matches(['(', ')', ';', ' '])))
        .collect()
}

/// The remarks of a golden program at which an operator can start again: those that do not say what to set up.
fn places_to_start(golden: &Golden) -> Vec<String> {
    let machine = translate::machine_of(&golden.text, &golden.machine);
    let reading = (machine.dialect.read)(&golden.text, SourceId::INPUT, &machine).expect("it reads");
    let steps = &reading.value.decimals.program.steps;
    let remarks = steps.iter().filter_map(|located| match &located.step {
        Step::Comment(text) => Some(text.trim_matches(['(', ')', ';', ' ']).to_owned()),
        Step::Tool(_)
        | Step::Spindle(_)
        | Step::Coolant
        | Step::Home(_)
        | Step::Shift(_)
        | Step::Auxiliary(_)
        | Step::Rapid(_)
        | Step::Cut(_) => None,
    });
    remarks.collect()
}

/// Whether nothing but a remark is changed that no operator takes for a place to start again. That those that say what to set up
/// stand before all is compared by itself; a copy of one elsewhere says the same again.
fn is_about_free_remarks(golden: &Golden, text: &str) -> bool {
    let gists: Vec<String> = places_to_start(golden).iter().map(|remark| gist(remark)).collect();
    let starts = |text| -> Vec<String> {
        let all = remarks(text, &golden.machine).into_iter().map(str::to_owned);
        all.filter(|remark| gists.contains(&gist(remark))).collect()
    };
    starts(&golden.text) == starts(text)
        && blocks(&golden.text, &golden.machine) == blocks(text, &golden.machine)
}

/// Whether the blocks that are others only state places, directions and coefficients, so that the path is another within the
/// tolerance that was proved.
fn is_within_tolerance(golden: &Golden, text: &str) -> bool {
    let is_number = |word: &str| word.trim_start_matches('N').bytes().all(|b| b.is_ascii_digit());
    let is_place = |word: &str| {
        if word.starts_with("PO[") || word.starts_with("PL=") {
            return true;
        }
        let at = word.trim_start_matches(['T', 'I', 'J', 'K', 'X', 'Y', 'Z', 'A']);
        at.len() < word.len()
            && at.starts_with(['+', '-', '.', '0', '1', '2', '3', '4', '5', '6', '7', '8', '9'])
    };
    let places = |block: &Vec<String>| {
        let words = block.iter().filter(|word| !is_number(word) && *word != "LN" && *word != "POLY");
        words.clone().count() != 0 && words.into_iter().all(|word| is_place(word))
    };
    let left = |text: &str| -> Vec<Vec<String>> {
        blocks(text, &golden.machine).into_iter().filter(|block| !places(block)).collect()
    };
    left(&golden.text) == left(text) && blocks(&golden.text, &golden.machine) != blocks(text, &golden.machine)
}

#[test]
fn every_fault_of_a_golden_program_is_refused() {
    let asked = |name: &str| std::env::var(name).ok().and_then(|count| count.parse::<usize>().ok());
    let count = asked("SPLINEPOST_DAMAGE").unwrap_or(SAMPLE);
    let mut random = Random(asked("SPLINEPOST_DAMAGE_SEED").unwrap_or(12) as u64);
    let all = golden();
    let (mut survivors, mut tried) = (Vec::new(), 0);
    let (mut kinds, mut remarks, mut within) = (BTreeMap::new(), BTreeMap::new(), BTreeMap::new());
    let mut told: BTreeMap<&'static str, usize> = BTreeMap::new();
    while tried < count {
        // Each in turn, so that short ones are damaged as often as long ones.
        let golden = &all[tried % all.len()];
        let Some((kind, what, text)) = damaged(&golden.text, &mut random) else { continue };
        tried += 1;
        *kinds.entry(kind).or_insert(0) += 1;
        match verified(golden, &text) {
            Err(errors) => {
                assert!(Severity::Refusal <= errors.worst(), "{what}: no error");
                *told.entry(errors.0[0].id).or_insert(0) += 1;
                if SAMPLE < count && errors.0[0].id == "form-differs" {
                    println!("form {kind}: {}: {what}", golden.path.display());
                }
            }
            Ok(()) if is_about_free_remarks(golden, &text) => {
                *remarks.entry(kind).or_insert(0) += 1;
                if SAMPLE < count {
                    println!("remark {kind}: {}: {what}", golden.path.display());
                }
            }
            Ok(()) if is_within_tolerance(golden, &text) => {
                *within.entry(kind).or_insert(0) += 1;
                if SAMPLE < count {
                    println!("within {kind}: {}: {what}", golden.path.display());
                }
            }
            Ok(()) => survivors.push(format!("{kind}: {}: {what}", golden.path.display())),
        }
    }
    println!(
        "{tried} faults: {kinds:?}\nrefused: {told:?}\nfree remarks: {remarks:?}\nwithin the tolerance: {within:?}"
    );
    assert_eq!(kinds.len(), 11, "every kind is tried: {kinds:?}");
    assert!(survivors.is_empty(), "{} of {tried} passed:\n{}", survivors.len(), survivors.join("\n"));
}
