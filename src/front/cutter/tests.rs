//! What is read, and what is refused.

use super::*;
use crate::ir::Step;

const PAPER: &str = "name = \"CONE10\"\n[cutter]\nD1 = 10\nS = 30\nC = 5\nr = 8\nlength = 30\n";

fn ids(text: &str) -> Vec<&'static str> {
    match parse_program(&Source::new("t", text), SourceId::INPUT) {
        Ok(_) => vec![],
        Err(errors) => errors.0.iter().map(|d| d.id).collect(),
    }
}

#[test]
fn the_smallest_file_is_enough_for_points() {
    let job = parse(&Source::new("t", PAPER), SourceId::INPUT).unwrap();
    assert_eq!((job.flutes.len(), job.flutes[0].curve.end()), (1, 30.0));
    assert_eq!(ids(PAPER), ["feed-missing", "retract-missing"]);
}

#[test]
fn the_greek_key_and_the_byte_order_mark_are_taken() {
    let text = format!("\u{feff}{PAPER}[interpolation]\n\"Δl\" = 0.5\n");
    assert_eq!(parse(&Source::new("t", text), SourceId::INPUT).unwrap().flutes[0].dl, Some(0.5));
}

#[test]
fn a_flute_is_retracted_before_anything_turns() {
    let text = format!("{PAPER}flutes = 2\n[process]\nfeed = 200\nretract = {{ axis = \"Z\", to = 50 }}\n");
    let intent = parse_program(&Source::new("t", text), SourceId::INPUT).unwrap();
    let moves: Vec<(usize, f64)> = intent
        .program
        .steps
        .iter()
        .filter_map(|located| match &located.step {
            Step::Rapid(axes) => Some(axes[0]),
            Step::Comment(_)
            | Step::Tool(_)
            | Step::Spindle(_)
            | Step::Coolant
            | Step::Home(_)
            | Step::Shift(_)
            | Step::Auxiliary(_)
            | Step::Cut(_) => None,
        })
        .collect();
    let flute = |a: f64| [(2, 50.0), (0, 0.0), (1, 0.0), (3, a), (2, 50.0)];
    assert_eq!(moves, [flute(0.0), flute(180.0)].concat());
}

#[test]
fn what_is_wrong_is_named() {
    let process = "[process]\nfeed = 200\nretract = { axis = \"Z\", to = 50 }\n";
    let with = |from: &str, to: &str| ids(&format!("{}{process}", PAPER.replace(from, to)));
    assert_eq!(with("D1 = 10", "D1 = 0"), ["not-positive"]);
    assert_eq!(with("S = 30", "S = 90"), ["angle-range"]);
    assert_eq!(with("C = 5", "C = -45"), ["taper-ends"]);
    assert_eq!(with("length = 30", "length = nan"), ["not-finite"]);
    assert_eq!(with("D1 = 10\nS = 30\n", ""), ["key-missing", "key-missing"]);
    assert_eq!(with("r = 8", "r = 8\nflutes = 0"), ["flutes-range"]);
    assert_eq!(with("r = 8", "r = 8\nhand = \"up\""), ["word-unknown"]);
    assert_eq!(with("length = 30\n", "length = 30\n[interpolation]\ndl = 900\n"), ["step-too-large"]);
    assert_eq!(ids(&format!("{PAPER}{}", process.replace("50", "0.2"))), ["retract-not-clear"]);
    assert_eq!(ids(""), ["cutter-missing"]);
}

fn sections(process: &str) -> Vec<String> {
    let text = format!("{PAPER}flutes = 2\n[process]\nfeed = 200\n{process}\n");
    let intent = parse_program(&Source::new("t", text), SourceId::INPUT).unwrap();
    let comment = |step: &Step<f64, crate::ir::Curve>| match step {
        Step::Comment(text) => Some(text.clone()),
        Step::Tool(_)
        | Step::Spindle(_)
        | Step::Coolant
        | Step::Home(_)
        | Step::Shift(_)
        | Step::Auxiliary(_)
        | Step::Rapid(_)
        | Step::Cut(_) => None,
    };
    intent.program.steps.iter().filter_map(|located| comment(&located.step)).collect()
}

#[test]
fn passes_come_flute_by_flute_or_pass_by_pass() {
    let infeed = "retract = { axis = \"Z\", to = 50 }\ninfeed = { axis = \"Y\", step = 0.2, passes = 2 }\nspark_out = 1";
    let (rough1, rough2) = ("ROUGH 1 OF 2, Y 0.4", "ROUGH 2 OF 2, Y 0.2");
    let flute = |n: usize, name: &str| format!("FLUTE {n} OF 2, A {}, {name}", (n - 1) * 180);
    let names = [rough1, rough2, "FINISH", "SPARK-OUT 1 OF 1"];
    let by_flute: Vec<String> = (1..=2).flat_map(|n| names.map(|name| flute(n, name))).collect();
    assert_eq!(sections(infeed), by_flute);
    let by_pass: Vec<String> = names.iter().flat_map(|name| (1..=2).map(|n| flute(n, name))).collect();
    assert_eq!(sections(&format!("{infeed}\norder = \"pass\"")), by_pass);
}

#[test]
fn stock_decides_which_side_is_clear() {
    let with = |step: f64, to: f64| {
        let process = format!(
            "retract = {{ axis = \"Z\", to = {to} }}\ninfeed = {{ axis = \"Z\", step = {step}, passes = 2 }}"
        );
        ids(&format!("{PAPER}[process]\nfeed = 200\n{process}\n"))
    };
    assert!(with(0.2, 50.0).is_empty() && with(-0.2, -50.0).is_empty());
    assert_eq!(with(0.2, -50.0), ["retract-through-work"]);
    assert_eq!(with(0.2, 0.5), ["retract-not-clear"]);
}

#[test]
fn infeed_is_checked() {
    let with = |infeed: &str| {
        ids(&format!(
            "{PAPER}[process]\nfeed = 200\nretract = {{ axis = \"Z\", to = 50 }}\ninfeed = {{ {infeed} }}\n"
        ))
    };
    assert_eq!(with("axis = \"X\", step = 0.1, passes = 1"), ["infeed-axis"]);
    assert_eq!(with("axis = \"Y\", step = 0.0, passes = 1"), ["infeed-range"]);
    assert_eq!(with("axis = \"Y\", step = 0.1, passes = 0"), ["passes-range"]);
    assert_eq!(with("axis = \"Y\", step = 0.1"), ["infeed-incomplete"]);
    assert_eq!(with("axis = \"Y\", step = 0.1, pases = 1"), ["key-unknown"]);
}
