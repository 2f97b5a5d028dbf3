//! What is read, and what is refused.

use super::*;
use crate::ir::{Cut, Intent, Role, Step};
use crate::source::Source;

const PROCESS: &str = "[process]\nfeed = 1000\nretract = { axis = \"Z\", to = 50 }\n";
const QUARTER: &str = "[[curve]]\nkind = \"nurbs\"\naxes = [\"X\", \"Y\"]\nat = { Z = -2 }\ndegree = 2\n\
    knots = [0, 0, 0, 1, 1, 1]\npoints = [[10, 0], [10, 10], [0, 10]]\nweights = [1, 0.7071067811865476, 1]\n";

fn intent(text: &str) -> Result<Intent, Diagnostics> {
    parse_program(&Sources::new(Source::new("t", text)), SourceId::INPUT)
}

fn ids(text: &str) -> Vec<&'static str> {
    intent(text).err().map_or(vec![], |errors| errors.0.iter().map(|d| d.id).collect())
}

/// Rapids as axis and end, cuts as the role's letter.
fn moves(intent: &Intent) -> Vec<String> {
    let axes = intent.program.axes;
    intent
        .program
        .steps
        .iter()
        .filter_map(|located| match &located.step {
            Step::Rapid(targets) => Some(format!("{}{}", axes.name(targets[0].0), targets[0].1)),
            Step::Cut(Cut { role: Role::Approach | Role::AsAsked, .. }) => Some("approach".to_owned()),
            Step::Cut(Cut { role: Role::Path, .. }) => Some("path".to_owned()),
            Step::Comment(text) => Some(text.clone()),
            Step::Tool(_)
            | Step::Spindle(_)
            | Step::Coolant
            | Step::Home(_)
            | Step::Shift(_)
            | Step::Auxiliary(_) => None,
        })
        .collect()
}

#[test]
fn one_axis_at_a_time_and_clear() {
    let intent = intent(&format!("{PROCESS}{QUARTER}")).unwrap();
    let expected = ["CURVE 1 OF 1", "Z50", "X10", "Y0", "approach", "path", "Z50"];
    assert_eq!(moves(&intent), expected);
    assert!(intent.warnings.0.is_empty());
}

#[test]
fn curves_are_joined_where_they_meet() {
    let line = |from: &str, to: &str| {
        format!("[[curve]]\nkind = \"points\"\naxes = [\"X\", \"Y\"]\npoints = [{from}, {to}]\n")
    };
    let text = |second: &str| format!("{PROCESS}{QUARTER}{}", line(second, "[-30, 10]"));
    let expected = ["CURVES 1 TO 2 OF 2", "Z50", "X10", "Y0", "approach", "path", "path", "Z50"];
    assert_eq!(moves(&intent(&text("[0, 10]")).unwrap()), expected);
    let apart = intent(&text("[0, 10.01]")).unwrap();
    // Z stays at -2, where the curve before left it, and so the tool is brought there again.
    let expected = ["CURVE 2 OF 2", "Z50", "X0", "Y10.01", "approach", "path", "Z50"];
    assert_eq!(moves(&apart)[7..], expected);
    assert_eq!(apart.warnings.0[0].id, "gap-small");
    assert!(intent(&text("[0, 20]")).unwrap().warnings.0.is_empty());
}

#[test]
fn an_axis_that_nobody_places_is_asked_for() {
    let text = QUARTER.replace("at = { Z = -2 }\n", "");
    let rests = intent(&format!("{PROCESS}{text}")).unwrap();
    assert_eq!(rests.warnings.0[0].id, "retract-axis-rests");
    assert_eq!(moves(&rests), ["CURVE 1 OF 1", "Z50", "X10", "Y0", "path", "Z50"]);
    let b = "[[curve]]\nkind = \"points\"\naxes = [\"B\"]\npoints = [[0], [90]]\n";
    assert_eq!(ids(&format!("{PROCESS}{QUARTER}{b}")), ["axis-unplaced"]);
}

#[test]
fn a_polynomial_is_taken_about_its_start() {
    let text = "[[curve]]\nkind = \"polynomial\"\naxes = [\"X\", \"Z\"]\nrange = [1, 3]\n\
        coefficients = [[0, 1], [5, 0, -1, 0.5]]\n";
    let job = parse(&Sources::new(Source::new("t", text)), SourceId::INPUT).unwrap();
    let Curve::Polynomial(pieces) = &job.curves[0].curve else { panic!("{:?}", job.curves[0].curve) };
    // z = 5 − u² + u³/2: 4.5 at u = 1, 5 at u = 2, 9.5 at u = 3.
    for (t, x, z) in [(0.0, 1.0, 4.5), (0.5, 2.0, 5.0), (1.0, 3.0, 9.5)] {
        let p = pieces[0].eval(t);
        approx::assert_relative_eq!(p[0], x, epsilon = 1e-14);
        approx::assert_relative_eq!(p[1], z, epsilon = 1e-13);
    }
}

#[test]
fn bezier_curves_stand_in_a_row() {
    let text = "[[curve]]\nkind = \"bezier\"\naxes = [\"X\", \"Y\"]\ndegree = 2\n\
        points = [[0, 0], [1, 1], [2, 0], [3, -1], [4, 0]]\nweights = [1, 2, 1, 0.5, 1]\n";
    let job = parse(&Sources::new(Source::new("t", text)), SourceId::INPUT).unwrap();
    let Curve::Polynomial(pieces) = &job.curves[0].curve else { panic!("{:?}", job.curves[0].curve) };
    assert_eq!((pieces.len(), pieces[1].weights[1]), (2, 0.5));
    assert_eq!(pieces[0].end(), pieces[1].start());
}

#[test]
fn what_is_wrong_is_named() {
    let with = |from: &str, to: &str| {
        assert!(QUARTER.contains(from));
        ids(&format!("{PROCESS}{}", QUARTER.replacen(from, to, 1)))
    };
    assert_eq!(with("\"nurbs\"", "\"nurb\""), ["word-unknown"]);
    assert_eq!(with("degree = 2", "degree = 6"), ["degree-range"]);
    assert_eq!(with("degree = 2", "degree = 1"), ["knot-count"]);
    assert_eq!(with("0, 1, 1, 1]", "2, 1, 1, 1]"), ["knots-decrease"]);
    assert_eq!(with("[0, 0, 0, 1, 1, 1]", "[0, 0, 0, 0, 0, 0]"), ["knots-empty"]);
    assert_eq!(with("[10, 10],", "[10, 10, 10],"), ["point-count"]);
    assert_eq!(with("[10, 10],", "[10, nan],"), ["point-range"]);
    assert_eq!(with("[1, 0.7071067811865476, 1]", "[1, 1]"), ["weight-count"]);
    assert_eq!(with("0.7071067811865476", "-0.7"), ["weight-range"]);
    assert_eq!(with("\"X\", \"Y\"", "\"X\", \"X\""), ["axis-twice"]);
    assert_eq!(with("\"X\", \"Y\"", "\"X\", \"3\""), ["axis-name"]);
    assert_eq!(with("Z = -2", "X = -2"), ["axis-twice"]);
    assert_eq!(with("Z = -2", "Z = 50.0, U = 1, V = 2, W = 3, A = 4"), ["axes-too-many"]);
    assert_eq!(with("degree = 2", "degree = 2\nrange = [0, 1]"), ["key-needless"]);
    assert_eq!(with("degree = 2\n", ""), ["key-missing"]);
    assert_eq!(with("kind = \"nurbs\"", "# kind"), ["key-missing"]);
    assert_eq!(with("[[10, 0], [10, 10], [0, 10]]", "[[1, 0], [1, 0], [1, 0]]"), ["curve-empty"]);
    assert_eq!(ids(&format!("{}{QUARTER}", PROCESS.replace("50", "-2"))), ["retract-not-clear"]);
    assert_eq!(ids(QUARTER), ["feed-missing", "retract-missing"]);
    assert_eq!(ids(PROCESS), ["curve-missing"]);
    let x = PROCESS.replace("axis = \"Z\", to = 50", "axis = \"X\", to = 5");
    assert_eq!(ids(&format!("{x}{QUARTER}")), ["retract-not-clear"]);
    let a = PROCESS.replace("\"Z\"", "\"A\"");
    assert_eq!(ids(&format!("{a}{QUARTER}")), ["retract-axis"]);
}

#[test]
fn expressions_are_stood_for_within_their_bound() {
    let text = "[[curve]]\nkind = \"expression\"\nat = { X = 3 }\nu = [\"-pi/2\", 1]\nconstants = { r = 2.0 }\n\
                Z = \"r*sin(u)\"\nA = \"deg(u)\"\n";
    let source = Sources::new(Source::new("t", text));
    let job = parse(&source, SourceId::INPUT).unwrap_or_else(|e| panic!("{e:?}"));
    let placed = &job.curves[0];
    let Curve::Formula(described) = &placed.curve else { panic!("{:?}", placed.curve) };
    // X Z A in the order of the program.
    assert_eq!((placed.start[0], placed.start[1], placed.start[2]), (3.0, -2.0, -90.0));
    assert_eq!(described.formula.range(), (-std::f64::consts::FRAC_PI_2, 1.0));
    // The bound is that of the quintics; X rests, and has the allowance for rounding only.
    assert!(described.bound[0] == 0.0 && 0.0 < described.bound[1] && described.bound[1] <= 1.1e-8);
}
