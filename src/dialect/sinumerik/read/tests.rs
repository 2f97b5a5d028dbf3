//! What is read, and what is refused.

use super::*;
use crate::diagnostic::Severity;
use crate::ir::Cut;
use crate::verify::to_nurbs;

/// A machine of X and Y without lines of its own round a program, to read fragments with.
fn fragment(text: &str) -> Result<Warned<Reading>, Diagnostics> {
    let machine = Machine::parse(
        "extends = \"sinumerik\"\n[axes]\nlinear = [\"X\", \"Y\"]\nrotary = []\n\
         [program]\nheader = []\nstart = []\ntool = []\nspindle = []\nfooter = []\n",
        SourceId::INPUT,
    )?;
    read(text, SourceId::INPUT, &machine)
}

fn id(text: &str) -> &'static str {
    let errors = fragment(text).unwrap_err().0;
    errors.iter().find(|d| d.severity == Severity::Error).map_or("no error", |d| d.id)
}

const BSPLINE: &str = "N10 G1 X0 Y0 F1000\nN20 BSPLINE SD=3 X10 Y0 PL=0\nN30 X30 Y24 PL=30\nN40 X60 Y0 PL=30\n\
                       N50 X90 Y-24 PL=30\nN60 X110 Y0 PL=30\nN70 X120 Y0 PL=0\nN80 G1 X130\n";
const POLY: &str = "N10 G1 X0 Y0 F1000\nN20 POLY PO[X]=(30) PO[Y]=(14,0.36,-0.022) PL=10\n\
                    N30 PO[X]=(60) PO[Y]=(0,-0.3,0.01) PL=10\nN40 X=PO(90) Y=PO(-14,0,0.01) PL=10\n\
                    N50 PO[X]=(120) PO[Y]=(0,0.3,-0.022) PL=10\nN60 G1 X130\n";

/// y of the reference curve at x = 0, 15, … 120, from the pieces that a text means.
fn heights(text: &str) -> Vec<f64> {
    let reading = fragment(text).unwrap().value.decimals;
    let mut pieces = Vec::new();
    for located in &reading.program.steps {
        match &located.step {
            Step::Cut(Cut { curve: Written::Polynomial(polynomial), .. }) => {
                let mut start = polynomial.start;
                for block in &polynomial.blocks {
                    pieces.push(block.to_bezier(&reading.digits, &start));
                    start = block.end;
                }
            }
            Step::Cut(Cut { curve: Written::Nurbs(nurbs), .. }) => {
                pieces.extend(to_nurbs(&reading, nurbs).unwrap().beziers().map(|(piece, _)| piece));
            }
            Step::Cut(_)
            | Step::Comment(_)
            | Step::Tool(_)
            | Step::Spindle(_)
            | Step::Coolant
            | Step::Home(_)
            | Step::Shift(_)
            | Step::Auxiliary(_)
            | Step::Rapid(_) => {}
        }
    }
    assert_eq!(pieces.len(), 4);
    let mut heights: Vec<f64> =
        pieces.iter().flat_map(|piece| [piece.eval(0.0)[1], piece.eval(0.5)[1]]).collect();
    heights.push(pieces[3].eval(1.0)[1]);
    heights
}

#[test]
fn a_denominator_makes_the_manuals_arcs() {
    // Both of the manual: a quarter circle of radius 10, and an arc of 120 degrees of radius 1/√12 from (0, 0).
    let quarter = "POLY X10 Y0 F100\nPO[X]=(0,-10) PO[Y]=(10) PO[]=(2,1)\n";
    let third = "POLY X0 Y0 F100\nPO[X]=(0.25,0.5,0) PO[Y]=(0.433,0,0) PO[]=(1,1,0)\n";
    // The second circle has its centre at (¼, √3/12); 0.433 is √3/4 rounded by 1.3e-5.
    for (text, centre, radius, slack) in [
        (quarter, [0.0, 0.0], 10.0, 1.0e-14),
        (third, [0.25, 0.144_337_567_297_406], 0.288_675_134_594_813, 2.0e-5),
    ] {
        let reading = fragment(text).unwrap().value.decimals;
        let Step::Cut(Cut { curve: Written::Polynomial(polynomial), .. }) = &reading.program.steps[0].step
        else {
            panic!("{reading:?}")
        };
        let piece = polynomial.blocks[1].to_bezier(&reading.digits, &polynomial.blocks[0].end);
        for i in 0..=8 {
            let p = piece.eval(f64::from(i) / 8.0);
            let (x, y) = (p[0] - centre[0], p[1] - centre[1]);
            approx::assert_relative_eq!((x * x + y * y).sqrt(), radius, epsilon = slack);
        }
    }
    assert_eq!(id("POLY X0 Y0\nPO[X]=(1,2) Y3 PO[]=(2,1)\n"), "denominator-axis");
    assert_eq!(id("POLY X0 Y0\nPO[X]=(1,2) PO[]=(-1,1)\n"), "denominator-range");
    assert_eq!(id("POLY X0 Y0\nPO[X]=(1,2) PO[]=(2) PO[]=(2)\n"), "axis-twice");
}

#[test]
fn the_reference_curve_in_both_forms() {
    let expected = [0.0, 6.25, 14.0, 10.75, 0.0, -10.75, -14.0, -6.25, 0.0];
    for text in [BSPLINE, POLY] {
        for (y, expected) in heights(text).iter().zip(expected) {
            approx::assert_relative_eq!(*y, expected, epsilon = 1e-12);
        }
    }
}

#[test]
fn a_repeated_first_point_is_the_same_curve() {
    let repeated =
        BSPLINE.replace("N20 BSPLINE SD=3 X10 Y0 PL=0", "N15 BSPLINE SD=3 X0 Y0 PL=0\nN20 X10 Y0 PL=0");
    assert_eq!(heights(&repeated), heights(BSPLINE));
}

#[test]
fn without_pl_the_knots_are_guessed_with_a_warning() {
    let text: String = BSPLINE
        .split_inclusive('\n')
        .map(|line| line.split(" PL").next().unwrap_or("").trim().to_owned() + "\n")
        .collect();
    let reading = fragment(&text).unwrap();
    assert!(reading.warnings.0.iter().any(|warning| warning.id == "knots-unknown"));
}

#[test]
fn what_is_wrong_has_a_name() {
    assert_eq!(id("G1 X0 Y0 F100\nG91 X1\n"), "word-unknown");
    assert_eq!(id("G1 X0 Y0 F100\nG55\n"), "code-refused");
    assert_eq!(id("G1 X0 Y0 F100\nG505\n"), "word-unknown");
    assert_eq!(id("G1 X0 Y0 F100\nM30 M30\n"), "m-function");
    assert_eq!(id("G1 X0 Y0 X1 F100\n"), "axis-twice");
    assert_eq!(id("G1 X0 Y0 PO[X]=(1,2)\n"), "axis-twice");
    assert_eq!(id("G1 X0 Y0 F100\nPO[X]=(1,2)\n"), "po-without-poly");
    assert_eq!(id("G1 X0 Y0 F100\nPOLY X1 PL=0\n"), "pl-range");
    assert_eq!(id("G1 X0 Y0 F100\nX1 PL=1\n"), "spline-word");
    assert_eq!(id("X1\n"), "motion-missing");
    assert_eq!(id("G1 X0.1234567 Y0\n"), "digits-too-many");
    assert_eq!(id("G1 X0 Y0 F0\n"), "feed-range");
    assert_eq!(id("G1 X0 ? Y0\n"), "word-unreadable");
    assert_eq!(id(&BSPLINE.replace("PL=30\nN50", "\nN50")), "pl-missing");
    assert_eq!(id(&BSPLINE.replace("Y-24 PL=30", "Y-24 PL=-30")), "pl-range");
    assert_eq!(id(&BSPLINE.replace("SD=3 X10 Y0 PL=0", "SD=3 X10 Y0 PL=5")), "spline-unsound");
    assert_eq!(id(&BSPLINE.replace("Y-24 PL=30", "Y-24 PL=30 F300")), "feed-in-spline");
    assert_eq!(id("G1 X0 Y0 F100\nBSPLINE X1 Y1 PL=0\nX2 Y2 PL=0\nG1 X3\n"), "spline-too-short");
}

#[test]
fn the_feed_of_a_block_holds_from_it_on() {
    let reading = fragment("G1 X0 Y0 F100\nX1\nF200 X2\n").unwrap().value.decimals;
    let feeds: Vec<Option<Decimal>> = reading
        .program
        .steps
        .iter()
        .filter_map(|located| match &located.step {
            Step::Cut(cut) => Some(cut.feed),
            Step::Comment(_)
            | Step::Tool(_)
            | Step::Spindle(_)
            | Step::Coolant
            | Step::Home(_)
            | Step::Shift(_)
            | Step::Auxiliary(_)
            | Step::Rapid(_) => None,
        })
        .collect();
    assert_eq!(feeds, [Some(Decimal::new(100, 0)), Some(Decimal::new(200, 0))]);
}
