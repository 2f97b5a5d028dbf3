//! What is read, and what is refused.

use super::*;
use crate::diagnostic::Severity;
use crate::front;
use crate::ir::{Cut, Decimals};
use crate::pass::check::check;
use crate::source::{Source, Sources};
use crate::verify::Status;
use crate::{Options, compile};
use proptest::prelude::*;

fn three_axes() -> Machine {
    let file = "extends = \"heidenhain\"\n[axes]\nrotary = []\n[program]\n\
                    header = [\"BEGIN PGM {name} MM\"]\nfooter = []\n";
    Machine::parse(file, SourceId::INPUT).unwrap()
}

fn reading(text: &str) -> Warned<Reading> {
    read(text, SourceId::INPUT, &three_axes()).unwrap_or_else(|errors| panic!("{errors:?}"))
}

fn warnings(reading: &Warned<Reading>) -> Vec<&'static str> {
    reading.warnings.0.iter().map(|d| d.id).collect()
}

/// The only error of a text: its name and the text it points at.
fn error(text: &str) -> (&'static str, &str) {
    let errors = read(text, SourceId::INPUT, &three_axes()).unwrap_err();
    let errors: Vec<&Diagnostic> = errors.0.iter().filter(|d| d.severity == Severity::Error).collect();
    let [Diagnostic { id, span: Some(span), .. }] = &errors[..] else { panic!("{text}: {errors:?}") };
    (id, &text[span.start as usize..span.end as usize])
}

fn curves(decimals: &Decimals) -> Vec<&Written> {
    let curve = |step| match step {
        &Step::Cut(Cut { ref curve, .. }) => Some(curve),
        Step::Comment(_)
        | Step::Tool(_)
        | Step::Spindle(_)
        | Step::Coolant
        | Step::Home(_)
        | Step::Shift(_)
        | Step::Auxiliary(_)
        | Step::Rapid(_) => None,
    };
    decimals.program.steps.iter().filter_map(|located| curve(&located.step)).collect()
}

/// Where each SPL block is at t = ½: (start + end)/2 − a₂/4 − 3a₃/8 by the formula of the IR.
fn middles(decimals: &Decimals) -> Vec<[f64; 3]> {
    let mut middles = Vec::new();
    for curve in curves(decimals) {
        let Written::Polynomial(polynomial) = curve else { continue };
        let mut start = polynomial.start;
        for block in &polynomial.blocks {
            let (from, to) = (decimals.position(&start), decimals.position(&block.end));
            middles.push(std::array::from_fn(|i| {
                let [a2, a3, ..] = block.coefficients[i].map(Decimal::to_f64);
                0.5 * (from[i] + to[i]) - 0.25 * a2 - 0.375 * a3
            }));
            start = block.end;
        }
    }
    middles
}

fn rewritten(reading: Reading, machine: &Machine) -> String {
    (machine.dialect.write)(&check(reading.decimals, machine).unwrap().value, machine)
}

const REFERENCE: &str = "\
0 BEGIN PGM CURVE MM
1 L X+0 Y+0 Z+0 F1000
2 SPL X+30 Y+14 ~
  K3X+0 K2X+0 K1X-3.0E+1 ~
  K3Y+2.2E+1 K2Y-3.0E+1 K1Y-6
3 SPL X+60 Y+0 ~
  K3X+0 K2X+0 K1X-3.0E+1 ~
  K3Y-1.0E+1 K2Y+0 K1Y+2.4E+1
4 SPL X+90 Y-14 ~
  K3X+0 K2X+0 K1X-3.0E+1 ~
  K3Y-1.0E+1 K2Y+3.0E+1 K1Y-6
5 SPL X+120 Y+0 ~
  K3X+0 K2X+0 K1X-3.0E+1 ~
  K3Y+2.2E+1 K2Y-3.6E+1 K1Y+0
6 END PGM CURVE MM
";

#[test]
fn the_reference_curve_means_what_was_calculated_by_hand() {
    let read = reading(REFERENCE);
    assert!(read.value.header && read.value.footer && read.value.misnumbered.is_none());
    // Of the first line the start is not known; the splines close exactly.
    assert_eq!(warnings(&read), ["start-unknown"]);
    let expected = [[15.0, 6.25, 0.0], [45.0, 10.75, 0.0], [75.0, -10.75, 0.0], [105.0, -6.25, 0.0]];
    assert_eq!(middles(&read.value.decimals), expected);
    assert_eq!(rewritten(read.value, &three_axes()), REFERENCE);
    // As manuals print it: one line a block, or none of the `~`.
    let bare = REFERENCE.replace(" ~\n", "\n");
    let one_line = REFERENCE.replace(" ~\n", "");
    for text in
        [bare, one_line, REFERENCE.replace('.', ",").replace('+', ""), REFERENCE.replace('\n', "\r\n")]
    {
        let read = reading(&text.replace("E1", "E+001"));
        assert_eq!(rewritten(read.value, &three_axes()), REFERENCE, "{text}");
    }
}

#[test]
fn the_quarter_circle_has_its_radius() {
    // As one cubic with (4/3)(√2 − 1) its radius is exact at the ends and in the middle.
    let text = "1 L X+10 Y+0 Z+0 F100\n2 SPL X+0 Y+10 K3X-3.43145751 K2X-3.13708499 K1X+1.65685425E+1 \
                    K3Y+3.43145750 K2Y-1.34314575E+1 K1Y+0\n";
    let read = reading(text);
    assert_eq!(warnings(&read), ["start-unknown"]);
    let [[x, y, _]] = middles(&read.value.decimals)[..] else { panic!() };
    // Eight decimals of four numbers, at t = ½.
    assert!((x - y).abs() < 2.0e-8 && (x * x + y * y - 100.0).abs() < 20.0 * 2.0e-8, "{x} {y}");
}

/// Vavruška 2013, figure 6, blocks 26 to 30, with its commas; Z stands still with three zeros and no end.
const FIGURE_6: &str = "\
24 L X+176.881 Y+28.804 Z-8. R0 FMAX
25 L Z-10. F600
26 SPL X+176.864 Y+28.928 K3X+1.86078E-005 K2X-3.90197E-003 K1X+2.09682E-002 K3Y+1.89123E-004
   K2Y-7.31031E-004 K1Y-1.23615E-001 K3Z+1.78000E-015 K2Z+0.00000E+000 K1Z+0.00000E+000
27 SPL X+176.536 Y+29.733 K3X-9.97782E-003 K2X-1.61263E-001 K1X+4.99237E-001 K3Y+2.46742E-002
   K2Y-1,09843E-001 K1Y-7,19643E-001 K3Z-0.00000E+000 K2Z+0.00000E+000 K1Z-0.00000E+000
28 SPL X+175.897 Y+30.323 K3X-2.15417E-002 K2X-9.66380E-002 K1X+7.57138E-001 K3Y+1.98853E-002
   K2Y-1.69499E-001 K1Y-4.40301E-001 K3Z-0.00000E+000 K2Z+0.00000E+000 K1Z-0.00000E+000
29 SPL X+175.069 Y+30.586 K3X-2.53894E-002 K2X-2.04697E-002 K1X+8.74246E-001 K3Y+7.97566E-003
   K2Y-1.93426E-001 K1Y-7.73760E-002 K3Z-0.00000E+000 K2Z+0.00000E+000 K1Z-0.00000E+000
30 SPL X+174.944 Y+30.593 K3X-1.79250E-004 K2X+1.20000E-004 K1X+1.25190E-001 K3Y-2.70729E-005
   K2Y-3.86625E-003 K1Y-3.24000E-003 K3Z-0.00000E+000 K2Z+0.00000E+000 K1Z-0.00000E+000
";

#[test]
fn published_blocks_close_within_a_micrometre() {
    let read = reading(FIGURE_6);
    assert_eq!(warnings(&read), ["continuation-unmarked", "start-gap"]);
    // X of block 29: 175.069 − 0.0253894 − 0.0204697 + 0.874246 = 175.8973869, where 28 ends at 175.897.
    assert!(read.warnings.0[1].message.contains("up to 0.0003869 mm"), "{:?}", read.warnings);
    let [Written::Lines(_), Written::Polynomial(polynomial)] = curves(&read.value.decimals)[..] else {
        panic!()
    };
    assert_eq!(polynomial.start[..3], [1_768_810, 288_040, -100_000]);
    assert_eq!(polynomial.blocks.len(), 5);
    assert!(polynomial.blocks.iter().all(|block| block.end[2] == -100_000));
    let [a2, a3, ..] = polynomial.blocks[0].coefficients[0];
    assert_eq!((a2, a3), (Decimal::new(-38_461_466, 10), Decimal::new(-186_078, 10)));
}

#[test]
fn published_blocks_reach_a_fixed_point_when_they_are_written_again() {
    let machine = three_axes();
    let text = format!("0 BEGIN PGM FIG6 MM\n{FIGURE_6}99 END PGM FIG6 MM\n");
    let first = rewritten(reading(&text).value, &machine);
    let read = reading(&first);
    assert_eq!(warnings(&read), [""; 0]);
    assert_eq!(rewritten(read.value, &machine), first);
}

#[test]
fn the_manual_example_closes() {
    // iTNC 530, X and Y of blocks 7 to 9, whose Z does not belong to them.
    let text = "7 L X+28.338 Y+19.385 Z-0.5 FMAX\n8 SPL X24.875 Y15.924 Z-0.5 ~\n  K3X-4.688E-002 K2X2.459E-002 \
                    K1X3.486E+000 ~\n  K3Y-4.563E-002 K2Y2.155E-002 K1Y3.486E+000 ~\n  K3Z0.000E+000 K2Z0.000E+000 \
                    K1Z0.000E+000 F10000\n9 SPL X17.952 Y9.003 K3X5.159E-002 K2X-5.644E-002 K1X6.928E+000 \
                    K3Y3.753E-002 K2Y-2.644E-002 K1Y6.910E+000\n";
    let read = reading(text);
    // 0.92 µm in Y of block 8.
    assert!(read.warnings.0[0].message.contains("up to 0.00092 mm"), "{:?}", read.warnings);
    assert_eq!(middles(&read.value.decimals).len(), 2);
}

#[test]
fn a_spline_that_starts_elsewhere_is_refused_with_the_distance() {
    let text = FIGURE_6.replace("X+176.881", "X+175.881");
    assert_eq!(error(&text), ("start-mismatch", text.lines().nth(2).unwrap().trim_start_matches("26 ")));
    let errors = read(&text, SourceId::INPUT, &three_axes()).unwrap_err();
    assert_eq!(errors.0[0].label, "starts at X+176.8810848378, the tool is at X+175.881: 1.0000848378 apart");
    // 1 µm is accepted, more is not.
    let block = |start: &str| format!("1 L X+{start} Y+0 Z+0 R0 FMAX\n2 SPL X+1 K3X+0 K2X+0 K1X+1\n");
    assert_eq!(warnings(&reading(&block("2"))), [""; 0]);
    let coarse = "extends = \"heidenhain\"\n[digits]\nlinear = 5\n";
    let machine = Machine::parse(coarse, SourceId::INPUT).unwrap();
    let gap =
        |start| read(&block(start), SourceId::INPUT, &machine).map(|_| ()).map_err(|errors| errors.0[0].id);
    assert_eq!((gap("2.001"), gap("2.00101"), gap("1.999")), (Ok(()), Err("start-mismatch"), Ok(())));
}

#[test]
fn a_fragment_starts_where_its_first_spline_says() {
    let read = reading("1 SPL X+1 Y+1 Z+0 K3X+0 K2X+0 K1X+1 K3Y+0 K2Y+0 K1Y-2 K3Z+0 K2Z+0 K1Z+0\n");
    assert_eq!(warnings(&read), [""; 0]);
    let [Written::Polynomial(polynomial)] = curves(&read.value.decimals)[..] else { panic!() };
    assert_eq!(polynomial.start[..3], [20_000, -10_000, 0]);
}

#[test]
fn feed_is_modal_and_rapid_is_not() {
    let read = reading(
        "1 L X+0 Y+0 Z+0 R0 FMAX\n2 L X+1 F100\n3 L X+2 F MAX\n4 L X+3 ; F9\n5 L X+4 F200,5\n6 L X+5 Y+6\n",
    );
    let said = |step: &Step<Decimal, Written>| match step {
        Step::Rapid(_) => "rapid".to_owned(),
        Step::Cut(Cut { feed: Some(feed), curve: Written::Lines(points), .. }) => {
            format!("{feed} {}", points.count())
        }
        Step::Comment(text) => format!("; {text}"),
        other @ (Step::Tool(_)
        | Step::Spindle(_)
        | Step::Coolant
        | Step::Home(_)
        | Step::Shift(_)
        | Step::Auxiliary(_)
        | Step::Cut(_)) => {
            panic!("{other:?}")
        }
    };
    let steps: Vec<String> =
        read.value.decimals.program.steps.iter().map(|located| said(&located.step)).collect();
    assert_eq!(steps, ["rapid", "100 1", "rapid", "100 1", "; F9", "200.5 2"]);
}

#[test]
fn what_is_not_understood_is_named_at_its_place() {
    let start = "1 L X+0 Y+0 Z+0 R0 FMAX\n";
    let found = |line: &str| {
        let text = format!("{start}{line}\n");
        let (id, at) = error(&text);
        (id, at.to_owned())
    };
    for (line, id, at) in [
        ("2 L X+1 RL F100", "compensation", "RL"),
        ("2 L X+1 M8", "m-function", "M8"),
        ("2 L IX+1", "incremental", "IX+1"),
        ("2 L X+1 FQ1", "parameter-unset", "FQ1"),
        ("2 L X+Q1", "parameter", "X+Q1"),
        ("2 L X+1 X+2", "axis-twice", "X+2"),
        ("2 L B+1", "axis-unknown", "B+1"),
        ("2 L X+1.00001", "digits-too-many", "X+1.00001"),
        ("2 L X+1 F0", "feed-range", "F0"),
        ("2 L X+1 F100 FMAX", "feed-twice", "FMAX"),
        ("2 L X+1 K1X+1", "spline-word", "K1X+1"),
        ("2 L X+1 ~", "block-unfinished", "~"),
        ("2 L X+1 hello", "word-unknown", "hello"),
        ("2 CR X+1 Y+1 R+5 DR-", "block-unknown", "CR"),
        ("2 C X+1 Y+1 DR-", "arc-center", "C X+1 Y+1 DR-"),
        ("2 C X+1 Y+1", "rotation-missing", "C X+1 Y+1"),
        ("2 CC X+1", "arc-center", "CC X+1"),
        ("2 L X+1 DR+", "rotation", "L X+1 DR+"),
        ("2 LN X+1 NX+1", "compensation", "NX+1"),
        ("2 LN X+1 TX+1 TY+0", "direction", "LN X+1 TX+1 TY+0"),
        ("2 L X+1 TX+1", "direction", "L X+1 TX+1"),
        ("2 CYCL DEF 200 DRILLING ~\n  Q200=+2 ~\n  Q201=-3", "block-unknown", "CYCL"),
        ("2 M7", "block-unknown", "M7"),
        ("/2 L X+1", "block-unknown", "/2"),
        ("2 SPL F100", "spline-empty", "SPL F100"),
        ("2 SPL X+1", "coefficients-missing", "X+1"),
        ("2 SPL X+1 K3X+0 K1X-1", "coefficients-missing", "X+1"),
        ("2 SPL X+1 K3X+0 K2X+0 K1X-1 K3Y+0", "coefficients-missing", "K3Y+0"),
        ("2 SPL X+1 K3X+0 K2X+0 K1X-1 K3Y+0 K2Y+0 K1Y+1", "coordinate-missing", "K3Y+0"),
        ("2 SPL X+1 K3X+0 K2X+0 K1X-1 K1X-1", "coefficient-twice", "K1X-1"),
        ("2 SPL X+1 K3X+0 K2X+0 K1X+1E+99", "coefficient-range", "K1X+1E+99"),
        ("2 SPL X+1 K3X+0.000000000001 K2X+0 K1X+999999999", "coefficient-range", "X+1"),
        ("2 SPL X+1 K3X+0 K2X+0 K1X-1 FMAX", "rapid-spline", "FMAX"),
        ("2 SPL X+1 K3X+0 K2X+0 K1X-2 ~\n  F100 ; ends ~\n", "start-mismatch", "SPL X+1 K3X+0 K2X+0 K1X-2"),
    ] {
        assert_eq!(found(line), (id, at.to_owned()), "{line}");
    }
}

#[test]
fn every_block_is_counted_and_lines_that_continue_one_are_not() {
    assert_eq!(reading(REFERENCE).value.misnumbered, None);
    let text = REFERENCE.replace("\n4 SPL", "\n5 SPL");
    assert_eq!(
        reading(&text).value.misnumbered.map(|range| text[range].to_owned()).as_deref(),
        Some("5 SPL X+90 Y-14 ~")
    );
    let text = REFERENCE.replace("\n6 END", "\nEND");
    assert!(reading(&text).value.misnumbered.is_some());
}

#[test]
fn fixed_lines_may_go_on_too() {
    let file = "extends = \"heidenhain\"\n[program]\nheader = [\"BEGIN PGM {name} MM\", \
                    \"CYCL DEF 247 DATUM SETTING ~\", \"  Q339=+1 ;DATUM NUMBER\"]\nfooter = []\n";
    let machine = Machine::parse(file, SourceId::INPUT).unwrap();
    let text = "0 BEGIN PGM P1 MM\n1 CYCL DEF 247 DATUM SETTING ~\n  Q339=+1 ;DATUM NUMBER\n2 ; A REMARK\n\
                    3 L Z+50 R0 FMAX\n4 END PGM P1 MM\n";
    let read = read(text, SourceId::INPUT, &machine).unwrap().value;
    assert!(read.header && read.footer && read.misnumbered.is_none());
    assert_eq!(rewritten(read, &machine), text);
}

#[test]
fn what_is_compiled_is_proved_and_read_back_as_it_is_written() {
    let input = "name = \"CONE10\"\n[cutter]\nD1 = 10\nS = 30\nC = 5\nr = 8\nlength = 30\nflutes = 2\n[process]\n\
                     feed = 200\nspindle = 3000\nretract = { axis = \"Z\", to = 50 }\n";
    let language = front::find("cutter").unwrap();
    for (from, to) in [
        ("S = 30", "S = 30"),
        ("C = 5", "C = 0"),
        ("S = 30", "S = 0"),
        ("C = 5", "C = -5"),
        ("= 30\nf", "= 200\nf"),
    ] {
        let sources = Sources::new(Source::new("cone.toml", input.replace(from, to)));
        let whole = "extends = \"heidenhain\"\n[feed]\nerror = 10\n";
        let machine = Machine::parse(whole, SourceId::INPUT).unwrap();
        for motion in ["auto", "spl", "linear"] {
            let options = Options { motion: machine.dialect.motion(motion), ..Options::default() };
            let output = compile(&sources, language, &machine, &options)
                .unwrap_or_else(|e| panic!("{to} {motion}: {e:?}"));
            assert_eq!(output.report.unwrap().status, Status::Proved, "{to} {motion}");
            assert!(output.text.lines().all(|line| line.len() < 128), "{to} {motion}");
            let read = read(&output.text, SourceId::INPUT, &machine).unwrap();
            assert_eq!(warnings(&read), [""; 0], "{to} {motion}");
            assert_eq!(rewritten(read.value, &machine), output.text, "{to} {motion}");
            if motion == "spl" {
                assert_eq!(output.text.matches(" SPL ").count(), 2, "{to}: one block a flute");
            }
        }
    }
}

proptest! {
    #[test]
    fn no_text_panics(text in "([0-9 LXYZABK321+.,EFMAXSP~;RQ\n-]|SPL |K3X+0 |µ|\n[0-9] ){0,60}") {
        let _ = read(&text, SourceId::INPUT, &three_axes());
    }

    #[test]
    fn no_damage_to_a_program_panics(at in 0usize..400, sign in "[ -~\nµ]{0,2}", length in 0usize..8) {
        let mut chars: Vec<char> = REFERENCE.chars().collect();
        let at = at.min(chars.len());
        let end = (at + length).min(chars.len());
        chars.splice(at..end, sign.chars());
        let text: String = chars.into_iter().collect();
        if let Err(errors) = read(&text, SourceId::INPUT, &three_axes()) {
            for Diagnostic { span, .. } in errors.0 {
                let span = span.unwrap();
                prop_assert!(text.get(span.start as usize..span.end as usize).is_some());
            }
        }
    }
}
