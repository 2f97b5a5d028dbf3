//! The oracle itself, on published fragments and on figures that were calculated by hand.

use super::curve::{CUTTERS, Cutter, PAPER, Point};
use super::text::paths;

/// The places of the one path that a fragment cuts.
fn places(dialect: &str, text: &str) -> Vec<Point> {
    let mut paths = paths(dialect, text).unwrap_or_else(|what| panic!("{what}\n{text}"));
    assert_eq!(paths.len(), 1, "{text}");
    paths.remove(0).places
}

/// The curve with the control points (0,0) (10,0) (30,24) (60,0) (90,−24) (110,0) (120,0) and the knots 0×4, 30, 60,
/// 90, 120×4, on which x is the parameter.
const REFERENCE: [(f64, f64); 9] = [
    (0.0, 0.0),
    (15.0, 6.25),
    (30.0, 14.0),
    (45.0, 10.75),
    (60.0, 0.0),
    (75.0, -10.75),
    (90.0, -14.0),
    (105.0, -6.25),
    (120.0, 0.0),
];

/// Every place whose X is one of the reference's has its Y, and none of the reference is missed. All numbers are below
/// 1e3 and come of some dozens of operations, 1e-13 each.
fn is_reference(dialect: &str, text: &str) {
    let places = places(dialect, text);
    for (x, y) in REFERENCE {
        let here: Vec<f64> = places.iter().filter(|at| (at[0] - x).abs() < 1.0e-11).map(|at| at[1]).collect();
        assert!(!here.is_empty(), "{dialect}: no place at X {x}");
        assert!(here.iter().all(|found| (found - y).abs() < 1.0e-11), "{dialect}: Y {here:?} at X {x}");
    }
}

const POLY: &str = "N10 G1 X0 Y0 F1000
N20 POLY PO[X]=(30) PO[Y]=(14,0.36,-0.022) PL=10
N30 PO[X]=(60) PO[Y]=(0,-0.3,0.01) PL=10
N40 PO[X]=(90) PO[Y]=(-14,0,0.01) PL=10
N50 PO[X]=(120) PO[Y]=(0,0.3,-0.022) PL=10
N60 G1 X130
";

const BSPLINE: &str = "N10 G1 X0 Y0 F1000
N20 BSPLINE SD=3 X10 Y0 PL=0
N30 X30 Y24 PL=30
N40 X60 Y0 PL=30
N50 X90 Y-24 PL=30
N60 X110 Y0 PL=30
N70 X120 Y0 PL=0
N80 G1 X130
";

const SPL: &str = "1 L X+0 Y+0 F1000
2 SPL X+30 Y+14 K3X+0 K2X+0 K1X-3.0E+1 K3Y+2.2E+1 K2Y-3.0E+1 K1Y-6
3 SPL X+60 Y+0 K3X+0 K2X+0 K1X-3.0E+1 K3Y-1.0E+1 K2Y+0 K1Y+2.4E+1
4 SPL X+90 Y-14 K3X+0 K2X+0 K1X-3.0E+1 K3Y-1.0E+1 K2Y+3.0E+1 K1Y-6
5 SPL X+120 Y+0 K3X+0 K2X+0 K1X-3.0E+1 K3Y+2.2E+1 K2Y-3.6E+1 K1Y+0
";

const G06_2: &str = "G01 X0. Y0. F1000.
G06.2 P4 K0. X0. Y0. R1.
K0. X10. Y0. R1.
K0. X30. Y24. R1.
K0. X60. Y0. R1.
K30. X90. Y-24. R1.
K60. X110. Y0. R1.
K90. X120. Y0. R1.
K120.
K120.
K120.
K120.
G01 X130.
";

#[test]
fn the_reference_curve_is_the_same_in_every_form() {
    is_reference("sinumerik", POLY);
    is_reference("sinumerik", BSPLINE);
    is_reference("heidenhain", SPL);
    is_reference("mazak", G06_2);
}

#[test]
#[should_panic(expected = "sinumerik: Y")]
fn a_changed_coefficient_is_another_curve() {
    is_reference("sinumerik", &POLY.replace("-0.022)", "-0.0221)"));
}

#[test]
#[should_panic(expected = "mazak: Y")]
fn a_changed_control_point_is_another_curve() {
    is_reference("mazak", &G06_2.replace("Y24.", "Y24.1"));
}

#[test]
#[should_panic(expected = "sinumerik: ")]
fn changed_knots_are_another_curve() {
    is_reference("sinumerik", &BSPLINE.replacen("PL=30", "PL=31", 1));
}

#[test]
fn what_a_control_refuses_is_refused() {
    let refused = |dialect, text: &str| assert!(paths(dialect, text).is_err(), "{text}");
    refused("heidenhain", &SPL.replace("K1Y+2.4E+1", "K1Y+2.402E+1"));
    refused("heidenhain", &SPL.replace(" K2Y-3.6E+1", ""));
    refused("mazak", &G06_2.replacen("K120.\n", "", 1));
    refused("mazak", &G06_2.replace("K60.", "K10."));
    refused("mazak", &G06_2.replace("P4 K0. X0.", "P4 K0. X1."));
    refused("sinumerik", &BSPLINE.replace("Y24 PL=30", "Y24"));
    refused("sinumerik", &BSPLINE.replace("Y0 PL=0\nN80", "Y0 PL=1\nN80"));
}

/// √(X² + Y²) from a centre at the origin: least and greatest.
fn radii(places: &[Point]) -> (f64, f64) {
    let radii = places.iter().map(|at| (at[0] * at[0] + at[1] * at[1]).sqrt());
    radii.fold((f64::INFINITY, 0.0), |(least, greatest), r| (least.min(r), greatest.max(r)))
}

/// The quadratic circle whose weight of 0.7071 costs 0.16 µm of a radius of 100 mm.
#[test]
fn the_weights_of_g06_2_make_a_circle() {
    let text = "G01 X100. Y0. F1000.\nG06.2 P3 K0. X100. Y0. R1.\nK0. X100. Y100. R0.7071\nK0. X0. Y100. R1.\nK1.\nK1.\nK1.\nG01 X0.\n";
    let (least, greatest) = radii(&places("mazak", text));
    let error = (100.0 - least).max(greatest - 100.0);
    assert!((0.155e-3..0.165e-3).contains(&error), "{error:e}");
}

/// The same circle raised to the third degree: w = 1, (1 + 2/√2)/3; Q1 = (P0 + √2 P1)/(1 + √2). Points and weights
/// have seven digits behind the point, so that half a unit of each moves it by 5e-8 and 100 · 5e-8 mm.
#[test]
fn the_weights_of_bspline_make_a_circle() {
    let text = "G1 X100 Y0\nBSPLINE SD=3 X100 Y58.5786438 PL=0 PW=0.8047379\nX58.5786438 Y100 PL=1 PW=0.8047379\nX0 Y100 PL=0\nG1 X0\n";
    let (least, greatest) = radii(&places("sinumerik", text));
    assert!((100.0 - least).max(greatest - 100.0) < 5.1e-6, "{least} {greatest}");
}

/// The quarter circle of radius 10 as one cubic: its radius is up to 2.73 µm too great.
#[test]
fn the_printed_quarter_circle_in_spl_has_its_radius() {
    let text = "1 L X+10 Y+0\n2 SPL X+0 Y+10 K3X-3.43145751 K2X-3.13708499 K1X+1.65685425E+1 ~\n K3Y+3.43145750 K2Y-1.34314575 E+1 K1Y+0\n";
    let (least, greatest) = radii(&places("heidenhain", text));
    assert!(10.0 - 1.0e-8 < least && (2.725e-3..2.735e-3).contains(&(greatest - 10.0)), "{least} {greatest}");
}

/// The manual's own block, with a comma as some controls write it: its start is 0.71 and 0.92 µm from the tool.
#[test]
fn the_manuals_spl_block_just_closes() {
    let text = "7 L X+28,338 Y+19,385 Z-0,5 FMAX\n8 SPL X24,875 Y15,924 Z-0,5 ~
K3X-4,688E-002 K2X2,459E-002 K1X3,486E+000 ~
K3Y-4,563E-002 K2Y2,155E-002 K1Y3,486E+000 ~
K3Z0,000E+000 K2Z0,000E+000 K1Z0,000E+000 F10000\n";
    let gap = paths("heidenhain", text).expect("the block is whole")[0].gap;
    assert!((0.915e-3..0.925e-3).contains(&gap), "{gap:e}");
}

/// `POLY PO[X]=(10,10) A10`: A = X along the arc length, A = √(10 X) along the parameter.
#[test]
fn the_path_reference_changes_where_a_rotary_axis_is() {
    let block = "G1 X0 A0\nPOLY PO[X]=(10,10) A10\n";
    for at in places("sinumerik", block) {
        assert!((at[3] - at[0]).abs() < 1.0e-11, "{at:?}");
    }
    for at in places("sinumerik", &format!("UPATH\n{block}")) {
        assert!((at[3] - (10.0 * at[0]).sqrt()).abs() < 1.0e-11, "{at:?}");
    }
}

/// A at X less than its theoretical value, of odd and even points: the greatest.
fn errors(steps: &[(f64, f64)]) -> (f64, f64) {
    let greatest = |first: usize| {
        let errors = steps.iter().skip(first).step_by(2).map(|(x, a)| (PAPER.angle(*x) - a).abs());
        errors.fold(0.0, f64::max)
    };
    (greatest(0), greatest(1))
}

#[test]
fn the_steps_are_those_of_table_1() {
    let steps = PAPER.odd_even(0.2, true);
    assert_eq!(steps.len(), 152);
    // Printed with four decimals.
    for (number, x, a) in [
        (1, 0.1987, 0.0229),
        (2, 0.3974, 0.0457),
        (9, 1.7885, 0.2034),
        (143, 28.4736, 2.6679),
        (152, 30.2684, 2.8048),
    ] {
        let step = steps[number - 1];
        assert!((step.0 - x).abs() <= 0.5e-4 && (step.1 - a).abs() <= 0.5e-4, "{number}: {step:?}");
    }
    let (odd, even) = errors(&steps);
    assert!((odd - 3.9785e-5).abs() <= 0.5e-9 && (even - 3.5e-7).abs() <= 0.5e-9, "{odd:e} {even:e}");
    let steps = PAPER.odd_even(0.5, true);
    assert_eq!(steps.len(), 62);
    assert!((steps[61].0 - 30.8667).abs() <= 0.5e-4 && (errors(&steps).0 - 2.4780e-4).abs() <= 0.5e-8);
}

/// a ln(1 + bX), its limit, its mirror image.
#[test]
fn the_law_is_the_papers() {
    let (s, c) = (30.0f64.to_radians().tan(), 5.0f64.to_radians().tan());
    let printed = s / c * (1.0 + 2.0 * c / 10.0 * 30.0).ln();
    // Of the order of 1, with ln(1 + 0.5): a dozen operations.
    assert!((PAPER.angle(30.0) - printed).abs() < 1.0e-14);
    let cylinder = Cutter { c: 0.0, ..PAPER };
    let nearly = Cutter { c: 1.0e-9, ..PAPER };
    // ln(1 + z)/z = 1 − z/2 + …, z = 2 tan C X / D1 = 1e-10.
    assert!((cylinder.angle(30.0) - nearly.angle(30.0)).abs() < 1.0e-9);
    assert_eq!(Cutter { left: true, ..PAPER }.angle(17.0), -PAPER.angle(17.0));
}

/// Every angle of the table stays where the noise was reckoned: below 1e3 degrees, radii below 57 mm.
#[test]
fn the_cutters_are_within_the_noise_that_was_reckoned() {
    for cutter in CUTTERS {
        let end = cutter.position(cutter.length, cutter.angle(cutter.length), 360.0);
        assert!(end[3].abs() < 1.0e3 && 0.5 * cutter.d1 + end[1] < 57.0, "{}: {end:?}", cutter.name);
    }
}
