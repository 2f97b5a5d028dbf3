//! Derivatives against closed forms, intervals against samples, and texts that nobody meant to write.

use super::curve::{Formula, FormulaError};
use super::interval::Interval;
use super::number::Fault;
use super::parse::{Wrong, is_constant_name, parse};
use super::{Expression, FUNCTIONS};
use approx::assert_relative_eq;
use proptest::prelude::*;

fn expression(text: &str) -> Expression {
    let constants = [("R".to_owned(), 30.0), ("k2".to_owned(), -0.5)];
    parse(text, &constants).unwrap_or_else(|e| panic!("{text}: {e:?}"))
}

/// f, f′, f″, f‴ at u.
fn derivatives(text: &str, u: f64) -> [f64; 4] {
    let jet = expression(text).jet::<f64, 4>(u).unwrap_or_else(|e| panic!("{text}: {e:?}")).0;
    [jet[0], jet[1], 2.0 * jet[2], 6.0 * jet[3]]
}

#[test]
fn operators_bind_as_in_mathematics() {
    for (text, value) in [
        ("1 + 2*3", 7.0),
        ("(1 + 2)*3", 9.0),
        ("8/4/2", 1.0),
        ("1 - 2 - 3", -4.0),
        ("2^3^2", 512.0),
        ("-2^2", -4.0),
        ("(-2)^2", 4.0),
        ("2^-2", 0.25),
        ("2*-3", -6.0),
        ("--2", 2.0),
        ("2e1 + .5 + 1.", 21.5),
        ("2*e", 2.0 * std::f64::consts::E),
        ("R*k2", -15.0),
        ("sqrt(9) + abs(-2)", 5.0),
        ("deg(pi)", 180.0),
        ("rad(180)/pi", 1.0),
        ("atan2(1, 1)*4/pi", 1.0),
        ("log10(1000)", 3.0),
        ("4^0.5", 2.0),
        ("(-8)^3", -512.0),
        ("cbrt(-27)", -3.0),
        ("0^0", 1.0),
    ] {
        // A few roundings of numbers below 1000.
        assert_relative_eq!(expression(text).at(0.7).unwrap(), value, max_relative = 1e-15);
    }
}

#[test]
fn derivatives_have_their_closed_forms() {
    let (u, s, c) = (0.7f64, 0.644_217_687_237_691, 0.764_842_187_284_488_4);
    let root = u.sqrt();
    let e = 2.013_752_707_470_476_6;
    let (sh, ch) = (0.758_583_701_839_533_5, 1.255_169_005_630_943);
    let th = sh / ch;
    let (t, sec2) = (s / c, 1.0 / (c * c));
    let w = 1.0 + u * u;
    let v = 1.0 - u * u;
    for (text, expected) in [
        ("sin(u)", [s, c, -s, -c]),
        ("cos(u)", [c, -s, -c, s]),
        ("exp(u)", [e, e, e, e]),
        ("u^5", [u * u * u * u * u, 5.0 * u * u * u * u, 20.0 * u * u * u, 60.0 * u * u]),
        ("sqrt(u)", [root, 0.5 / root, -0.25 / (u * root), 0.375 / (u * u * root)]),
        ("u^0.5", [root, 0.5 / root, -0.25 / (u * root), 0.375 / (u * u * root)]),
        ("1/u", [1.0 / u, -1.0 / (u * u), 2.0 / (u * u * u), -6.0 / (u * u * u * u)]),
        ("u^-1", [1.0 / u, -1.0 / (u * u), 2.0 / (u * u * u), -6.0 / (u * u * u * u)]),
        ("ln(u)", [-0.356_674_943_938_732_4, 1.0 / u, -1.0 / (u * u), 2.0 / (u * u * u)]),
        ("sinh(u)", [sh, ch, sh, ch]),
        ("cosh(u)", [ch, sh, ch, sh]),
        ("tan(u)", [t, sec2, 2.0 * sec2 * t, sec2 * (4.0 * t * t + 2.0 * sec2)]),
        (
            "tanh(u)",
            [th, 1.0 - th * th, -2.0 * th * (1.0 - th * th), (1.0 - th * th) * (6.0 * th * th - 2.0)],
        ),
        (
            "atan(u)",
            [0.610_725_964_389_208_6, 1.0 / w, -2.0 * u / (w * w), (6.0 * u * u - 2.0) / (w * w * w)],
        ),
        (
            "atan2(u, 1)",
            [0.610_725_964_389_208_6, 1.0 / w, -2.0 * u / (w * w), (6.0 * u * u - 2.0) / (w * w * w)],
        ),
        (
            "asin(u)",
            [
                0.775_397_496_610_753,
                1.0 / v.sqrt(),
                u / (v * v.sqrt()),
                (1.0 + 2.0 * u * u) / (v * v * v.sqrt()),
            ],
        ),
        ("sin(u)^2 + cos(u)^2", [1.0, 0.0, 0.0, 0.0]),
        ("asin(u) + acos(u)", [std::f64::consts::FRAC_PI_2, 0.0, 0.0, 0.0]),
        ("ln(exp(u))", [u, 1.0, 0.0, 0.0]),
        ("cbrt(u)^3", [u, 1.0, 0.0, 0.0]),
        ("u^u/exp(u*ln(u))", [1.0, 0.0, 0.0, 0.0]),
        ("abs(-u)", [u, 1.0, 0.0, 0.0]),
        ("deg(u) - u*180/pi", [0.0, 0.0, 0.0, 0.0]),
    ] {
        for (own, expected) in derivatives(text, u).into_iter().zip(expected) {
            // Some thirty roundings of numbers below 50.
            assert_relative_eq!(own, expected, epsilon = 1e-13, max_relative = 1e-13);
        }
    }
}

#[test]
fn wrong_texts_have_their_place() {
    let wrong = |text: &str| parse(text, &[]).map(|_| ()).map_err(|e| (e.wrong, e.span)).unwrap_err();
    assert!(matches!(wrong(""), (Wrong::Expected(_), span) if span == (0..0)));
    assert!(matches!(wrong("2 +"), (Wrong::Expected(_), span) if span == (3..3)));
    assert_eq!(wrong("2u"), (Wrong::Expected("an operator: + - * / ^"), 1..2));
    assert_eq!(wrong("sin(u"), (Wrong::Expected("a closing bracket"), 5..5));
    assert_eq!(wrong("2*Q"), (Wrong::UnknownName("Q".into()), 2..3));
    assert_eq!(wrong("1 + sn(u)"), (Wrong::UnknownFunction("sn".into()), 4..6));
    assert_eq!(wrong("sin + 1"), (Wrong::FunctionAlone("sin".into()), 0..3));
    assert_eq!(wrong("sin(1, 2)"), (Wrong::Arguments("sin".into(), "one argument"), 0..3));
    assert_eq!(wrong("atan2(1)"), (Wrong::Arguments("atan2".into(), "two arguments, y and x"), 0..5));
    assert_eq!(wrong("1e999"), (Wrong::NumberTooLarge, 0..5));
    assert_eq!(wrong(&"(".repeat(500)).0, Wrong::TooDeep);
    assert_eq!(wrong(&"-".repeat(100_000)).0, Wrong::TooDeep);
    assert_eq!(wrong(&"1+".repeat(5000)).0, Wrong::TooLong);
    assert!(matches!(wrong("2 ° u"), (Wrong::Expected(_), span) if span == (2..4)));
}

#[test]
fn names_of_constants_are_free() {
    assert!(is_constant_name("R") && is_constant_name("r_2") && is_constant_name("ex"));
    for name in ["u", "pi", "e", "sin", "atan2", "2r", "", "a-b", "ä"] {
        assert!(!is_constant_name(name), "{name}");
    }
}

fn curve(x: &str, y: &str, from: f64, to: f64) -> Result<Formula, FormulaError> {
    Formula::new(vec![expression(x), expression(y)], from, to)
}

#[test]
fn faults_are_found_with_place_and_parameter() {
    let fault = |x: &str, from: f64, to: f64| match curve(x, "u", from, to) {
        Err(FormulaError::Fails { axis: 0, failing, u }) => (failing.fault, failing.span, u),
        other => panic!("{x}: {other:?}"),
    };
    let near = |found: (Fault, std::ops::Range<usize>, f64), fault, span, u: f64, width: f64| {
        assert_eq!((found.0, found.1), (fault, span));
        // The first place that fails, to a billionth of the range.
        assert!((found.2 - u).abs() <= 2e-9 * width, "{} is not {u}", found.2);
    };
    near(fault("2 + ln(1 - u)", 0.0, 3.0), Fault::LogarithmOfNonPositive, 4..13, 1.0, 3.0);
    near(fault("1/(u - 0.3)", -1.0, 1.0), Fault::DivisionByZero, 0..11, 0.3, 2.0);
    near(fault("abs(u - 0.25)", 0.0, 1.0), Fault::Kink, 0..13, 0.25, 1.0);
    near(fault("sqrt(u)", 0.0, 1.0), Fault::RootOfZero, 0..7, 0.0, 1.0);
    near(fault("sqrt(u)", -1.0, 1.0), Fault::RootOfNegative, 0..7, -1.0, 2.0);
    near(fault("tan(u)", 0.0, 3.0), Fault::PoleOfTangent, 0..6, std::f64::consts::FRAC_PI_2, 3.0);
    near(fault("acos(u)", 0.0, 1.0), Fault::ArcOfOne, 0..7, 1.0, 1.0);
    near(fault("asin(2*u)", 0.0, 1.0), Fault::ArcOfOne, 0..9, 0.5, 1.0);
    near(fault("u^1.5", 0.0, 1.0), Fault::PowerOfNonPositive, 0..5, 0.0, 1.0);
    near(fault("exp(u)", 0.0, 1000.0), Fault::Overflow, 0..6, 709.782_712_893_384, 1000.0);
}

#[test]
fn parameters_are_told_in_seven_figures() {
    let told = |u: f64| FormulaError::Stands { u }.to_string();
    assert_eq!(told(1.0 / 3.0), "the curve stands still at u = 0.3333333");
    assert_eq!(told(-0.0), "the curve stands still at u = 0");
    assert_eq!(told(2.5e-7), "the curve stands still at u = 2.5e-7");
    assert_eq!(told(9.313_225_746e290), "the curve stands still at u = 9.313226e290");
}

#[test]
fn a_curve_that_stands_still_is_none() {
    // The cusp of an involute, of a cycloid.
    let stands = |x: &str, y: &str, from: f64, to: f64| match curve(x, y, from, to) {
        Err(FormulaError::Stands { u }) => u,
        other => panic!("{other:?}"),
    };
    assert!(stands("cos(u) + u*sin(u)", "sin(u) - u*cos(u)", 0.0, 3.0).abs() < 1e-8);
    assert!((stands("u - sin(u)", "1 - cos(u)", 1.0, 9.0) - std::f64::consts::TAU).abs() < 1e-7);
    assert!(matches!(curve("1", "2", 0.0, 1.0), Err(FormulaError::Stands { .. })));
    assert_eq!(curve("u", "u", 1.0, 1.0), Err(FormulaError::Range));
    assert!(curve("R*cos(u)", "R*sin(2*u)", 0.0, 7.0).is_ok());
    assert!(curve("cos(u) + u*sin(u)", "sin(u) - u*cos(u)", 3.0, 0.5).is_ok(), "it may fall");
}

/// The greatest distance in each axis of `n` equal pieces from their curve on 0 … `end`.
fn off(formula: &Formula, pieces: &[crate::geom::bezier::Bezier], end: f64) -> [f64; 2] {
    let mut worst = [0.0f64; 2];
    let n = pieces.len();
    for (i, piece) in pieces.iter().enumerate() {
        for k in 0..=32 {
            let t = f64::from(k) / 32.0;
            let (own, asked) = (piece.eval(t), formula.at(end * (i as f64 + t) / n as f64));
            for axis in 0..2 {
                worst[axis] = worst[axis].max((own[axis] - asked[axis]).abs());
            }
        }
    }
    worst
}

#[test]
fn quintics_are_within_their_bound_and_reach_it() {
    // Of u⁶ the sixth coefficient is 1, so the bound is the error: (h/2)⁶ ≤ 1e-8 for h = 1/16.
    let sixth = curve("u", "u^6", 0.0, 1.0).unwrap();
    let (pieces, bound) = sixth.pieces(1e-8).unwrap();
    assert_eq!(pieces.len(), 16);
    let worst = off(&sixth, &pieces, 1.0);
    assert_relative_eq!(worst[1], 1.0 / f64::from(1u32 << 30), max_relative = 1e-4);
    assert!(
        worst[0] <= bound[0] && worst[1] <= bound[1] && bound[1] < 1.001 * worst[1],
        "{worst:?} {bound:?}"
    );
    // 30·2⁶/720 (h/2)⁶ ≤ 1e-7 for h = 0.1, whatever sin and cos are.
    let lissajous = curve("30*cos(u)", "30*sin(2*u)", 0.0, 6.4).unwrap();
    let (pieces, bound) = lissajous.pieces(1e-7).unwrap();
    assert_eq!(pieces.len(), 64);
    let worst = off(&lissajous, &pieces, 6.4);
    assert!(worst[0] <= bound[0] && worst[1] <= bound[1], "{worst:?} {bound:?}");
}

#[test]
fn a_curve_in_other_coordinates_is_the_same_curve() {
    let formula = curve("30*cos(u)", "30*sin(2*u)", 0.0, 7.0).unwrap();
    let placed = formula.placed(&[2, 0], &[1.0, -5.0, 0.0]);
    let (own, asked) = (placed.at(0.3), formula.at(0.3));
    assert_eq!((own[2], own[0], own[1]), (asked[0], asked[1], -5.0));
}

/// Random expressions of u in [0.2, 2], most of them defined there.
fn texts() -> impl Strategy<Value = String> {
    let leaf = prop_oneof![
        Just("u".to_owned()),
        (-3.0f64..3.0).prop_map(|x| format!("({x})")),
        Just("R".to_owned()),
        Just("pi".to_owned())
    ];
    leaf.prop_recursive(4, 24, 2, |inner| {
        let names: Vec<&'static str> = FUNCTIONS.iter().map(|(name, _)| *name).collect();
        prop_oneof![
            (inner.clone(), prop::sample::select(vec!["+", "-", "*", "/", "^"]), inner.clone())
                .prop_map(|(a, op, b)| format!("({a}{op}{b})")),
            (prop::sample::select(names), inner.clone()).prop_map(|(f, a)| format!("{f}({a})")),
            (inner.clone(), inner).prop_map(|(a, b)| format!("atan2({a},{b})")),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]
    #[test]
    fn intervals_hold_what_is_inside(text in texts(), low in 0.2f64..1.9, width in 1e-6f64..0.3) {
        let f = expression(&text);
        let Ok(bounds) = f.jet::<Interval, 5>(Interval::new(low, low + width)) else { return Ok(()) };
        for i in 0..=50 {
            let u = (low + width * f64::from(i) / 50.0).min(low + width);
            // Where bounds exist there is a value, and within them.
            let jet = f.jet::<f64, 5>(u);
            prop_assert!(jet.is_ok(), "{} at {}: {:?}", text, u, jet);
            for (own, bound) in jet.unwrap().0.iter().zip(bounds.0) {
                // Outward rounding holds the rounded result of every operation, so it holds that of all.
                prop_assert!(bound.contains(*own), "{} at {}: {} not in {:?}", text, u, own, bound);
            }
        }
    }

    #[test]
    fn values_stand_within_a_point_interval(text in texts(), u in 0.2f64..2.0) {
        let f = expression(&text);
        let (Ok(value), Ok(bound)) = (f.jet::<f64, 1>(u), f.jet::<Interval, 1>(Interval::point(u))) else { return Ok(()) };
        // The rounded value of one operation after another: the interval of one point holds it as it is.
        prop_assert!(bound.0[0].contains(value.0[0]), "{} at {}: {:?} {:?}", text, u, value, bound);
    }

    #[test]
    fn no_text_panics(text in "[-+*/^(),. 0-9a-zA-Zπ_]{0,40}", u in -10.0f64..10.0) {
        if let Ok(f) = parse(&text, &[]) {
            let _ = f.jet::<f64, 4>(u);
            let _ = f.jet::<Interval, 4>(Interval::new(u, u + 1.0));
        }
    }
}
