//! What is read, and what is refused.

use super::*;
use crate::diagnostic::Severity;
use crate::geom::nurbs::Nurbs;

/// X and Y only, without lines round the program.
const FLAT: &str = "extends = \"mazak\"\n[axes]\nlinear = [\"X\", \"Y\"]\nrotary = []\n\
    [program]\nheader = []\ntool = [\"T{tool} M6\", \"G43 H{tool}\"]\nfooter = []\nclose = []\n";

/// Example B of the reference: x = t.
const B: &str = "G01 X0. Y0. F1000.\nG06.2 P4 K0. X0. Y0. R1.\nK0. X10. Y0. R1.\nK0. X30. Y24. R1.\n\
    K0. X60. Y0. R1.\nK30. X90. Y-24. R1.\nK60. X110. Y0. R1.\nK90. X120. Y0. R1.\n\
    K120.\nK120.\nK120.\nK120.\nG01 X130.\n";

fn machine(text: &str) -> Machine {
    Machine::parse(text, SourceId::INPUT).unwrap()
}

fn read_with(text: &str, axes: &str) -> Result<Warned<Reading>, Diagnostics> {
    let machine = machine(&FLAT.replace("\"X\", \"Y\"", axes));
    read(text, SourceId::INPUT, &machine)
}

fn flat(text: &str) -> Result<Warned<Reading>, Diagnostics> {
    read_with(text, "\"X\", \"Y\"")
}

fn curve(reading: &Reading) -> Nurbs {
    let decimals = &reading.decimals;
    let mut curves = decimals.program.steps.iter().filter_map(|located| match &located.step {
        Step::Cut(cut) => match &cut.curve {
            Written::Nurbs(nurbs) => {
                // Its knots are in units of their last decimal; here they are wanted as written.
                let spline = crate::verify::to_nurbs(decimals, nurbs).unwrap();
                let unit = crate::decimal::power_of_ten(nurbs.knot_digits) as f64;
                let knots = spline.knots().iter().map(|t| t / unit).collect();
                let (points, weights) = (spline.points().to_vec(), spline.weights().to_vec());
                Some(Nurbs::new(spline.degree(), knots, points, weights).unwrap())
            }
            Written::Lines(_) | Written::Arc(_) | Written::Polynomial(_) | Written::Through(..) => None,
        },
        Step::Comment(_)
        | Step::Tool(_)
        | Step::Spindle(_)
        | Step::Coolant
        | Step::Home(_)
        | Step::Shift(_)
        | Step::Auxiliary(_)
        | Step::Rapid(_) => None,
    });
    curves.next_back().unwrap()
}

/// The first problem, and the text that it points at.
fn problem(text: &str) -> (&'static str, String) {
    let mut errors = flat(text).unwrap_err().0;
    errors.retain(|d| d.severity == Severity::Error);
    let span = errors[0].span.unwrap();
    assert_eq!(errors.len(), 1, "{errors:?}");
    (errors[0].id, text[span.start as usize..span.end as usize].to_owned())
}

#[test]
fn a_cubic_bezier_on_a_straight_line() {
    let text = "G1 X0. Y0. Z0. F100.\nG06.2 P4 X0. Y0. Z0. K0.\nX10. Y10. Z10. K0.\nX20. Y20. Z20. K0.\n\
        X30. Y30. Z30. K0.\nK1.\nK1.\nK1.\nK1.\n";
    let curve = curve(&read_with(text, "\"X\", \"Y\", \"Z\"").unwrap().value);
    for t in [0.0, 0.25, 0.5, 1.0] {
        let at = curve.eval(t);
        assert!(at[..3].iter().all(|x| (x - 30.0 * t).abs() < 1.0e-12), "{at:?}");
    }
}

#[test]
fn the_reference_curve() {
    let curve = curve(&flat(B).unwrap().value);
    let y = [0.0, 6.25, 14.0, 10.75, 0.0, -10.75, -14.0, -6.25, 0.0];
    for (i, y) in y.into_iter().enumerate() {
        let at = curve.eval(15.0 * i as f64);
        assert!((at[0] - 15.0 * i as f64).abs() < 1.0e-12 && (at[1] - y).abs() < 1.0e-12, "{at:?}");
    }
}

#[test]
fn a_quarter_circle_of_order_three() {
    let text = "G01 X100. Y0. F1000.\nG06.2 P3 K0. X100. Y0. R1.\nK0. X100. Y100. R0.7071\nK0. X0. Y100. R1.\n\
        K1.\nK1.\nK1.\nG01 X0.\n";
    let curve = curve(&flat(text).unwrap().value);
    assert_eq!(curve.degree(), 2);
    for i in 0..=20 {
        let at = curve.eval(f64::from(i) / 20.0);
        // The reference gives 0.16 µm for four decimals of the weight.
        assert!(((at[0] * at[0] + at[1] * at[1]).sqrt() - 100.0).abs() < 0.2e-3, "{at:?}");
    }
}

#[test]
fn the_order_may_be_missing_and_the_degree_may_stand_for_it() {
    let same = |text: &str| curve(&flat(text).unwrap().value) == curve(&flat(B).unwrap().value);
    assert!(same(&B.replace("P4 ", "")));
    assert!(same(&B.replace("G06.2", "G6.2").replace("G01", "N7 G1")));
    let degree = B.replace("P4", "P3");
    assert!(same(&degree));
    let warnings = flat(&degree).unwrap().warnings;
    assert_eq!(warnings.0.iter().map(|d| d.id).collect::<Vec<_>>(), ["order-is-degree", "start-unknown"]);
}

#[test]
fn what_is_wrong_with_a_curve_is_shown_at_its_place() {
    let with = |from: &str, to: &str| {
        assert!(B.contains(from));
        problem(&B.replacen(from, to, 1))
    };
    let is = |found: (&'static str, String), id: &str, place: &str| {
        assert_eq!((found.0, found.1.as_str()), (id, place));
    };
    is(with("K30. X90.", "X90."), "knot-missing", "X90. Y-24. R1.");
    is(with("K60.", "K20."), "knots-decrease", "K20.");
    is(with("K120.\nG01", "G01"), "closing-blocks", "K120.");
    is(with("K120.\nG01", "K120.\nK120.\nK120.\nG01"), "closing-blocks", "K120.");
    is(with("P4 K0. X0.", "P4 K0. X0.001"), "start-mismatch", "X");
    is(with("P4 K0. X0. Y0.", "P4 K0. X0."), "axis-not-in-first-block", "Y");
    is(with("P4 K0. X0. Y0. R1.", "P4 K0."), "first-point-missing", "G06.2 P4 K0.");
    is(with("P4", "P5"), "order-range", "P5");
    is(with("P4", "P4.5"), "order-range", "P4.5");
    is(with("K0. X30.", "K0. P4 X30."), "spline-word", "P4");
    is(with("R1.", "R0."), "weight-range", "R0.");
    is(with("K0. X30. Y24. R1.", "K0. X30. Y24. R1. F9."), "feed-in-spline", "F9.");
    is(with("G01 X130.", "X130. Y0."), "spline-ended", "X130. Y0.");
    is(with("K30. X90.", "K30. K30. X90."), "word-twice", "K30.");
    for (from, to, id) in [
        ("K120.\nG01", "K121.\nG01", "end-multiplicity"),
        ("K0. X60.", "K1. X60.", "end-multiplicity"),
        ("K30. X90. Y-24. R1.\nK60.", "K90. X90. Y-24. R1.\nK90.", "accepted"),
    ] {
        let text = B.replacen(from, to, 1);
        let errors = flat(&text).err().unwrap_or_default().0;
        let found = errors.iter().find(|d| d.severity == Severity::Error).map_or("accepted", |d| d.id);
        assert_eq!(found, id, "{text}");
    }
    assert_eq!(
        problem("G1 X0. Y0. F1.\nG06.2 P4 K0. X0. Y0.\nK0. X1. Y1.\nK1.\nK1.\nK1.\nK1.\n").0,
        "points-too-few"
    );
}

#[test]
fn other_words_are_errors_at_their_place() {
    let is = |text: &str, id: &str, place: &str| {
        let found = problem(text);
        assert_eq!((found.0, found.1.as_str()), (id, place), "{text}");
    };
    for code in ["G91", "G20", "G93", "G95", "G41", "G42", "G04", "G61.2", "G43.4", "G28"] {
        is(&format!("G17 {code}\n"), "code-refused", code);
    }
    is("G1 X1. F0.\n", "feed-range", "F0.");
    is("G1 X1. W3.\n", "axis-unknown", "W3.");
    is("G123 X1.\n", "word-unknown", "G123");
    is("G1 X1. X2.\n", "axis-twice", "X2.");
    is("G0 G1 X1.\n", "codes-conflict", "G1");
    is("X1.\n", "motion-missing", "X1.");
    is("G1 X1.23456\n", "digits-too-many", "X1.23456");
    is("G1 X1. K3.\n", "spline-word", "K3.");
    is("G1 X1. I3.\n", "arc-word", "I3.");
    is("G0 X0. Y0.\nG2 X1. Y1.\n", "arc-axes", "G2 X1. Y1.");
    is("G1 X1. (open\n", "remark-open", "(open");
    is("G1 #100\n", "word-unreadable", "#100");
    is("/G1 X1.\n", "block-skip", "/G1");
    is("G05.1 Q2\n", "code-refused", "G05.1");
    is("G43 H1\n", "tool-offset", "G43");
    is("G54\nG55\n", "code-refused", "G55");
    is("X=PO\n", "word-unreadable", "X=PO");
    is("Q1=3.\n", "axis-unknown", "Q1=3.");
}

#[test]
fn codes_that_say_what_is_so_anyway_are_read() {
    let text = "%\nO0012\nG17 G21 G40 G49 G54 G64 G69 G80 G90 G94\nG05 P2\nG61.1\nG05.1 Q1 ;\nG00 X1. (to the start)\n%\n";
    let reading = flat(text).unwrap().value;
    assert_eq!(reading.decimals.program.name, "O12");
    // The move, and the remark behind it.
    assert_eq!(reading.decimals.program.steps.len(), 2);
    let running: Vec<&str> = reading.stated.running.iter().map(|running| running.word.as_str()).collect();
    assert_eq!(running, ["G5 P2", "G61.1", "G5.1 Q1"]);
}

#[test]
fn the_offset_of_a_tool_is_called_once_and_in_time() {
    let first = |rest: &str| {
        let text = format!("T4 M6\n{rest}");
        let errors = read_with(&text, "\"X\", \"Z\"").err().unwrap_or_default().0;
        errors.iter().find(|d| d.severity == Severity::Error).map_or("read", |d| d.id)
    };
    assert_eq!(first("G0 X3.\nG43 H4 Z5.\n"), "read");
    assert_eq!(first("G43 H4\nG1 X3. F2.\n"), "read");
    assert_eq!(first("G0 Z5.\n"), "tool-offset-missing");
    assert_eq!(first("G0 G43 H3 Z5.\n"), "tool-offset");
    assert_eq!(first("G0 G43 H4 Z5.\nG43 H4\n"), "tool-offset");
    assert_eq!(first("G1 X3. F2.\n"), "tool-offset-missing");
}

#[test]
fn remarks_end_no_spline() {
    let text = "G0 X0. Y0.\nG06.1 X1. Y1. F5.\n(HERE)\nX2. Y0.\nG06.1 X3. Y1.\nG1\nG06.1 X4. Y0.\n";
    let steps = flat(text).unwrap().value.decimals.program.steps;
    let shown: Vec<String> = steps
        .iter()
        .map(|located| match &located.step {
            Step::Comment(text) => text.clone(),
            Step::Cut(cut) => match &cut.curve {
                Written::Through(_, points) => points.count().to_string(),
                Written::Lines(_) | Written::Arc(_) | Written::Polynomial(_) | Written::Nurbs(_) => {
                    "other".to_owned()
                }
            },
            Step::Tool(_)
            | Step::Spindle(_)
            | Step::Coolant
            | Step::Home(_)
            | Step::Shift(_)
            | Step::Auxiliary(_)
            | Step::Rapid(_) => "step".to_owned(),
        })
        .collect();
    assert_eq!(shown, ["step", "3", "HERE", "1"]);
}

#[test]
fn a_length_is_taken_in_x_y() {
    let ids = |text: &str, more: &str| -> Vec<&'static str> {
        let machine = machine(&(FLAT.replace("\"X\", \"Y\"", "\"X\", \"Y\", \"Z\"") + more));
        read(text, SourceId::INPUT, &machine)
            .map_or_else(|e| e.0.iter().map(|d| d.id).collect(), |_| Vec::new())
    };
    let arc = "T1 M6\nG0 X0. Y0.\nG43 H1 Z10.\nG1 Z0. F100.\nG18 G2 X5. Z5. I0. K5.\n";
    assert_eq!(ids(&format!("{arc}G17\nT2 M6\nG0 G43 H2 Z9.\n"), ""), [""; 0]);
    assert_eq!(ids(&format!("{arc}T2 M6\nG17 G0 G43 H2 Z9.\n"), ""), [""; 0]);
    assert_eq!(ids(&format!("{arc}T2 M6\nG0 G43 H2 Z9.\n"), ""), ["arc-plane"]);
    assert_eq!(ids(arc, "[arcs]\nplanes = false\n")[0], "arc-plane");
}
