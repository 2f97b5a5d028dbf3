//! The three NURBS forms of CL data, in every dialect.
//!
//! No public file shows some of them: what is called synthetic here was written for these tests.

use super::program;
use splinepost::dialect::{Dialect, Form};
use splinepost::machine::Machine;
use splinepost::source::{Source, Sources};
use splinepost::verify::Status;
use splinepost::{Options, Output, compile, front, verify_program};

/// The reference curve as CATIA writes it, with these weights.
fn catia(weights: [f64; 7]) -> String {
    let points = [(0, 0), (10, 0), (30, 24), (60, 0), (90, -24), (110, 0), (120, 0)];
    let dk = [0, 0, 30, 30, 30, 30, 0];
    let rows: Vec<String> = (0..7)
        .map(|i| {
            let ((x, y), dk, w) = (points[i], dk[i], weights[i]);
            format!("N{i},XT={x}.000,YT={y}.000,ZT=0.000,DK={dk}.00,W={w:.1};\n")
        })
        .collect();
    format!(
        "PARTNO REF\nRAPID\nGOTO/0,0,10\nFEDRAT/1000,MMPM\nGOTO/0,0,0\nBEGIN NURBS_SIEMENS(D=3,F=1000,AXIS=0.00,0.00,1.00);\n{}END NURBS;\nGOTO/120,0,10\nFINI\n",
        rows.concat()
    )
}

const NX: &str = "PARTNO REF\nRAPID\nGOTO/0,0,10\nFEDRAT/1000,MMPM\nGOTO/0,0,0\nNURBS/\nKNOT/0.25,0.5,0.75,1.0\n\
    CNTRL/10,0,0\nCNTRL/30,24,0\nCNTRL/60,0,0\nCNTRL/90,-24,0\nCNTRL/110,0,0\nCNTRL/120,0,0\nGOTO/120,0,10\nFINI\n";

/// Synthetic: the reference curve as Creo would write it.
const CREO: &str = "PARTNO REF\nRAPID\nGOTO/0,0,10\nFEDRAT/1000,MMPM\nGOTO/0,0,0\nMOVNRB / M3AXIS, LENGTH, 0\n\
    MOVNRB / ON, 4, 11, 0, 7, 155.2\nMOVNRB / 1, 0, 0, 0, 0, 1, $\n 2, 3, 4, 4, 4, 4\n\
    MOVNRB / 2, 0, 0, 0, 10, 0, 0, 30, 24, 0, 60, 0, 0\nMOVNRB / 2, 90, -24, 0, 110, 0, 0, 120, 0, 0\nMOVNRB / OFF\n\
    GOTO/120,0,10\nFINI\n";

fn machine(dialect: &Dialect) -> Machine {
    crate::support::five(dialect.name)
}

fn in_motion(language: &str, text: &str, machine: &Machine, motion: &str) -> Output {
    let sources = Sources::new(Source::new("input.cl", text));
    let options = Options { motion: machine.dialect.motion(motion), ..Options::default() };
    compile(&sources, front::find(language).expect("a language"), machine, &options)
        .unwrap_or_else(|failure| panic!("{motion}: {:?}", failure.diagnostics))
}

#[test]
fn one_curve_in_three_forms_is_one_program() {
    for dialect in splinepost::dialect::DIALECTS {
        let machine = machine(dialect);
        let text = |language, text: &str| {
            let output =
                program(language, text, &machine).unwrap_or_else(|e| panic!("{}: {e:?}", dialect.name));
            let report = output.report.expect("a proof");
            assert_eq!(report.status, Status::Proved);
            // All numbers of this curve are whole: only the proof's own rounding is left.
            assert!(report.deviation.mm < 1e-10, "{}: {}", dialect.name, report.deviation.mm);
            output.text
        };
        let reference = text("catia", &catia([1.0; 7]));
        // NX knots are scaled to the length of the polygon; where knots are written they are others.
        if dialect.name != "mazak" {
            assert_eq!(text("nx", NX), reference);
            assert_eq!(text("creo", CREO), reference);
        }
    }
}

/// As printed in the manual: PL is the middle knot's distance, the first point stands before it.
#[test]
fn the_reference_curve_is_the_manuals_bspline() {
    let machine = Machine::built_in("sinumerik").expect("sinumerik");
    let output = in_motion("catia", &catia([1.0; 7]), &machine, "bspline");
    let blocks = "BSPLINE SD=3 X10 Y0 PL=0\nX30 Y24 PL=30\nX60 Y0 PL=30\nX90 Y-24 PL=30\nX110 Y0 PL=30\nX120 Y0 PL=0\n";
    let unnumbered: Vec<&str> = output
        .text
        .lines()
        .map(|line| line.split_once(' ').filter(|(n, _)| n.starts_with('N')).map_or(line, |(_, rest)| rest))
        .collect();
    let unnumbered = unnumbered.join("\n");
    assert!(unnumbered.contains(blocks), "{}", output.text);
}

/// A documented pair of NX and Heidenhain: K3 = P0−3P1+3P2−P3, K2 = 3(P1−2P2+P3), K1 = 3(P2−P3).
#[test]
fn the_worked_nx_example_has_its_coefficients() {
    let text = "PARTNO PAIR\nRAPID\nGOTO/0,-55,10\nFEDRAT/500,MMPM\nGOTO/0,-55,-5\nNURBS/\nKNOT/1.0\n\
        CNTRL/0,-55.0772,10.5123\nCNTRL/0,-48.1729,25.8788\nCNTRL/0,-36.5234,36.1222\nFINI\n";
    let machine = Machine::built_in("heidenhain").expect("heidenhain");
    let output = program("nx", text, &machine).unwrap_or_else(|e| panic!("{e:?}"));
    for part in [
        "SPL Y-36.5234 Z+36.1222 ~",
        "K3Y+2.2363 K2Y+1.42356E+1 K1Y-3.49485E+1 ~",
        "K3Z+4.9773 K2Z-1.53693E+1 K1Z-3.07302E+1",
    ] {
        assert!(output.text.contains(part), "{part}\n{}", output.text);
    }
}

/// The example of CATIA's documentation: x = 0, 10, 20, 30 on one span of 30 is a straight line at even speed.
#[test]
fn the_example_of_the_catia_documentation_is_straight() {
    let text = "PARTNO LINE\nRAPID\nGOTO/0,0,10\nFEDRAT/1000,MMPM\nGOTO/0,0,0\n\
        BEGIN NURBS_SIEMENS(D=3,F=1000,AXIS=0.00,0.00,1.00);\nN0,XT=0.0,YT=0.0,ZT=0.0,DK=0.0,W=1.0;\n\
        N1,XT=10.0,YT=0.0,ZT=0.0,DK=0.0,W=1.0;\nN2,XT=20.0,YT=0.0,ZT=0.0,DK=30.0,W=1.0;\n\
        N3,XT=30.0,YT=0.0,ZT=0.0,DK=0.0,W=1.0;\nEND NURBS;\nFINI\n";
    let machine = Machine::built_in("sinumerik").expect("sinumerik");
    let output = program("catia", text, &machine).unwrap_or_else(|e| panic!("{e:?}"));
    assert!(output.text.contains("POLY X30 PL=1\n"), "{}", output.text);
}

/// The tip of the third seed's Fig. 7, first block, with its axis held still: its numbers are those of Fig. 8.
#[test]
fn the_seeds_control_points_and_knot_distances_are_kept() {
    let text = "PARTNO FIG7\nRAPID\nGOTO/67.76826,-52.67898,300\nFEDRAT/100,MMPM\nGOTO/67.76826,-52.67898,210.92639\n\
        BEGIN NURBS_SIEMENS (D=3,F=100.000,AXIS= 0.00000, 0.00000, 1.0$\n0000)\n\
        N0, XT=   67.76826, YT=  -52.67898, ZT=  210.92639, DK=   0.00000,W=   1.00000;\n\
        N1, XT=   67.16855, YT=  -52.70240, ZT=  210.21829, DK=   0.00000,W=   1.00000;\n\
        N2, XT=   66.16709, YT=  -52.34892, ZT=$\n  209.23191, DK=   2.78157,W=   1.00000;\n\
        N3, XT=   64.93429, YT=  -51.23395, ZT=  208.35718, DK=   1.40420,W=   1.00000;\n\
        N4, XT=   63.96272, YT=  -49.91019, ZT=  207.89007, DK=   1.39289,W=   1.00000;\n\
        N5, XT=   63.47366, YT=  -48.75558, ZT=  207.89878, DK=   2.27356,W=   1.00000;\n\
        N6, XT=   63.28510, YT=  -48.03474, ZT=  208.03981, DK=   0.00000,W=   1.00000;\nEND NURBS\nFINI\n";
    let machine = Machine::built_in("sinumerik").expect("sinumerik");
    let output = in_motion("catia", text, &machine, "bspline");
    for part in [
        "BSPLINE SD=3 X67.16855 Y-52.7024 Z210.21829 PL=0\n",
        "X66.16709 Y-52.34892 Z209.23191 PL=2.78157\n",
        "X64.93429 Y-51.23395 Z208.35718 PL=1.4042\n",
        "X63.96272 Y-49.91019 Z207.89007 PL=1.39289\n",
        "X63.47366 Y-48.75558 Z207.89878 PL=2.27356\n",
        "X63.2851 Y-48.03474 Z208.03981 PL=0\n",
    ] {
        assert!(output.text.contains(part), "{part}\n{}", output.text);
    }
    // Five and six decimals: nothing is rounded but by Mazak's and Heidenhain's four, half of which in each axis is
    // 8.7e-5 mm together; knots of four decimals add to that.
    for dialect in splinepost::dialect::DIALECTS {
        let machine = crate::support::five(dialect.name);
        let output = program("catia", text, &machine).unwrap_or_else(|e| panic!("{}: {e:?}", dialect.name));
        let deviation = output.report.expect("a proof").deviation.mm;
        let bound = if dialect.name == "sinumerik" { 1e-4 } else { 3e-4 };
        assert!(deviation < bound, "{}: {deviation}", dialect.name);
    }
}

/// Synthetic: weights that differ and a double inner knot.
#[test]
fn weights_and_multiple_knots_survive() {
    let weighted = catia([1.0, 1.0, 2.0, 0.5, 1.5, 1.0, 1.0]);
    let sinumerik = Machine::built_in("sinumerik").expect("sinumerik");
    let output = in_motion("catia", &weighted, &sinumerik, "bspline");
    assert!(output.text.contains("X30 Y24 PL=30 PW=2\n") && output.text.contains("X60 Y0 PL=30 PW=0.5\n"));
    // Of weights only ratios count, and R is scaled so that it loses least.
    let mazak = Machine::built_in("mazak").expect("mazak");
    let output = program("catia", &weighted, &mazak).unwrap_or_else(|e| panic!("{e:?}"));
    let weights: Vec<f64> = output
        .text
        .split_whitespace()
        .filter_map(|word| word.strip_prefix('R').and_then(|weight| weight.parse().ok()))
        .collect();
    assert_eq!(weights.len(), 7, "{}", output.text);
    for (weight, asked) in weights.iter().zip([1.0, 1.0, 2.0, 0.5, 1.5, 1.0, 1.0]) {
        assert!((weight / weights[0] - asked).abs() < 1e-5, "{weights:?}");
    }
    // SPL has no weights: cubics are fitted.
    let heidenhain = Machine::built_in("heidenhain").expect("heidenhain");
    let output = program("catia", &weighted, &heidenhain).unwrap_or_else(|e| panic!("{e:?}"));
    assert_eq!(output.report.expect("a proof").status, Status::Proved);
    let double = catia([1.0; 7]).replace("DK=30.00,W=1.0;\nN4", "DK=0.00,W=1.0;\nN4");
    let output = in_motion("catia", &double, &sinumerik, "bspline");
    assert!(output.text.contains("X60 Y0 PL=0\n"), "{}", output.text);
    assert_eq!(output.report.expect("a proof").status, Status::Proved);
}

/// Two splines in a row with one feed are two, and the second follows the first.
#[test]
fn splines_follow_each_other() {
    let second = "NURBS/\nKNOT/1.0\nCNTRL/130,0,0\nCNTRL/140,5,0\nCNTRL/150,5,0\n";
    let text = NX.replace("GOTO/120,0,10\n", &format!("{second}GOTO/150,5,10\n"));
    for dialect in splinepost::dialect::DIALECTS {
        let output =
            program("nx", &text, &machine(dialect)).unwrap_or_else(|e| panic!("{}: {e:?}", dialect.name));
        assert_eq!(output.report.expect("a proof").status, Status::Proved);
    }
}

/// Every number of the spline blocks, changed in its second digit, is found.
#[test]
fn damage_to_a_spline_is_refused() {
    let text = catia([1.0, 1.0, 2.0, 1.0, 1.5, 1.0, 1.0]);
    let plain = catia([1.0; 7]);
    for (name, motion, text) in [
        ("sinumerik", "poly", &plain),
        ("sinumerik", "bspline", &text),
        ("heidenhain", "spl", &plain),
        ("mazak", "g06.2", &text),
    ] {
        let machine = crate::support::five(name);
        let output = in_motion("catia", text, &machine, motion);
        let mut tried = 0;
        for (from, to) in [
            ("Y24 ", "Y24.01 "),
            ("Y24. ", "Y24.01 "),
            ("PL=30\n", "PL=31\n"),
            ("PW=2", "PW=2.1"),
            ("R2.", "R2.1"),
            ("K30. ", "K31. "),
            ("PO[Y]=(14,36,-22)", "PO[Y]=(14,36.1,-22)"),
            ("PO[Y]=(14,36,-22)", "PO[Y]=(14.01,36,-22)"),
            ("X60 ", "X60.01 "),
            ("K3Y-1.0E+1", "K3Y-1.1E+1"),
            ("X+60", "X+60.01"),
        ] {
            if !output.text.contains(from) {
                continue;
            }
            tried += 1;
            let mut sources = Sources::new(Source::new("input.cl", text.as_str()));
            let id = sources.push(Source::new("program", output.text.replacen(from, to, 1)));
            let language = front::find("catia").expect("catia");
            let verified = verify_program(&sources, language, id, &machine, &Options::default());
            assert!(verified.is_err(), "{name} {motion}: {to} for {from}");
        }
        assert!(1 < tried, "{name} {motion}: {tried}");
    }
}

/// The third seed's Fig. 6, SPL blocks 26 to 28: where each ends, and K3 K2 K1 in X and Y.
const FIG_6: [([f64; 2], [f64; 3], [f64; 3]); 3] = [
    ([176.864, 28.928], [1.86078e-5, -3.90197e-3, 2.09682e-2], [1.89123e-4, -7.31031e-4, -1.23615e-1]),
    ([176.536, 29.733], [-9.97782e-3, -1.61263e-1, 4.99237e-1], [2.46742e-2, -1.09843e-1, -7.19643e-1]),
    ([175.897, 30.323], [-2.15417e-2, -9.66380e-2, 7.57138e-1], [1.98853e-2, -1.69499e-1, -4.40301e-1]),
];

/// Fig. 5, POLY blocks N140 to N150: PO[X], PO[Y] as far as the print can be read.
const FIG_5: [(&str, &[f64]); 5] = [
    ("PO[X]=(176.864,", &[-0.003_858_5, -0.000_014_5]),
    ("PO[Y]=(28.928,", &[-0.000_172_3, -0.000_186_3]),
    ("PO[X]=(176.536,", &[-0.191_200_3, 0.009_980_4]),
    ("PO[Y]=(29.733,", &[-0.035_829, -0.024_669_7]),
    ("PO[X]=(175.897,", &[-0.161_259, 0.021_540_4]),
];

/// One input makes the path of Fig. 5 and of Fig. 6: the printed pair agrees to 2e-4 mm.
#[test]
fn figures_5_and_6_are_one_path_of_one_input() {
    let mut text = String::from(
        "PARTNO FIG56\nLOADTL/10\nSPINDL/500,CLW\nRAPID\nGOTO/176.881,28.804,142\nFEDRAT/600,MMPM\nGOTO/176.881,28.804,-10\n",
    );
    for ([x, y], kx, ky) in FIG_6 {
        // f(t) = K3 t³ + K2 t² + K1 t + end, t from 1 to 0: P3 = end, P2 = end + K1/3, P1 = end + (2 K1 + K2)/3.
        let point =
            |share: fn([f64; 3]) -> f64| format!("CNTRL/{:.7},{:.7},-10.0\n", x + share(kx), y + share(ky));
        let inner = [point(|[_, k2, k1]| (2.0 * k1 + k2) / 3.0), point(|[_, _, k1]| k1 / 3.0)];
        text += &["NURBS/\nKNOT/1.0\n", &inner[0], &inner[1], &point(|_| 0.0)].concat();
    }
    text += "FINI\n";
    let number = |text: &str, after: &str| -> f64 {
        let start = text.find(after).unwrap_or_else(|| panic!("{after} in {text}")) + after.len();
        let length = text[start..].find([',', ')', ' ', '\n']).expect("an end");
        text[start..start + length].parse().unwrap_or_else(|e| panic!("{after}: {e}"))
    };
    let sinumerik = Machine::built_in("sinumerik").expect("sinumerik");
    let poly = program("nx", &text, &sinumerik).unwrap_or_else(|e| panic!("{e:?}")).text;
    for (block, printed) in FIG_5 {
        let mut found = Vec::new();
        let mut after = block.to_owned();
        for _ in printed {
            let coefficient = number(&poly, &after);
            let start = poly.find(&after).expect("found before") + after.len();
            let length = poly[start..].find([',', ')']).expect("an end");
            after = format!("{after}{},", &poly[start..start + length]);
            found.push(coefficient);
        }
        // Both have the same ends, so that they differ by Δa2 (p² − p) + Δa3 (p³ − p).
        let (d2, d3) = (found[0] - printed[0], found[1] - printed[1]);
        let apart =
            (0..=100).map(|i| f64::from(i) / 100.0).map(|p| (d2 * (p * p - p) + d3 * (p * p * p - p)).abs());
        let worst = apart.fold(0.0, f64::max);
        assert!(worst < 2e-4, "{block}: {worst}");
    }
    let heidenhain = Machine::built_in("heidenhain").expect("heidenhain");
    let spl = program("nx", &text, &heidenhain).unwrap_or_else(|e| panic!("{e:?}")).text;
    for ([x, y], kx, ky) in FIG_6 {
        let block =
            &spl[spl.find(&format!("SPL X+{x} Y+{y} ~")).unwrap_or_else(|| panic!("{x} {y} in {spl}"))..];
        for (axis, k) in [("X", kx), ("Y", ky)] {
            let found = ["K3", "K2", "K1"].map(|power| number(block, &format!("{power}{axis}")));
            let at = |k: [f64; 3], t: f64| ((k[0] * t + k[1]) * t + k[2]) * t;
            let worst = (0..=100)
                .map(|i| f64::from(i) / 100.0)
                .map(|t| (at(found, t) - at(k, t)).abs())
                .fold(0.0, f64::max);
            assert!(worst < 2e-4, "{axis} {x}: {worst}");
        }
    }
}

/// The first control point stands before the spline, or in it too: one curve, two spellings of the third seed's figures.
#[test]
fn the_first_control_point_may_stand_in_the_spline_too() {
    let input = catia([1.0; 7]);
    let first = |output: &Output| {
        let mut lines = output.text.lines().skip_while(|line| !line.contains("BSPLINE"));
        let mut line =
            || lines.next().and_then(|line| line.split_once(' ')).map_or("", |(_, words)| words).to_owned();
        [line(), line()]
    };
    let plain = in_motion("catia", &input, &Machine::built_in("sinumerik").expect("sinumerik"), "bspline");
    let repeats = crate::support::machine("extends = \"sinumerik\"\n[spline]\nfirst_point = \"repeat\"\n");
    let repeated = in_motion("catia", &input, &repeats, "bspline");
    assert_eq!(first(&plain), ["BSPLINE SD=3 X10 Y0 PL=0", "X30 Y24 PL=30"]);
    assert_eq!(first(&repeated), ["BSPLINE SD=3 X0 Y0 PL=0", "X10 Y0 PL=0"]);
    for (output, machine) in
        [(&plain, Machine::built_in("sinumerik").expect("sinumerik")), (&repeated, repeats)]
    {
        assert!(output.report.as_ref().is_some_and(|report| report.deviation.mm < 1e-10));
        let mut sources = Sources::new(Source::new("input.cl", input.as_str()));
        let id = sources.push(Source::new("program", output.text.as_str()));
        let language = front::find("catia").expect("catia");
        let verified = verify_program(&sources, language, id, &machine, &Options::default());
        assert!(verified.is_ok(), "{verified:?}");
    }
    // Rational: the weight of the first point stands there too.
    let weighted = in_motion(
        "catia",
        &catia([1.0, 1.0, 2.0, 1.0, 1.0, 1.0, 1.0]),
        &crate::support::machine("extends = \"sinumerik\"\n[spline]\nfirst_point = \"repeat\"\n"),
        "bspline",
    );
    assert!(first(&weighted)[0].starts_with("BSPLINE SD=3 X0 Y0 PL=0 PW=1"), "{:?}", first(&weighted));
}

/// Synthetic: degrees 2 and 5, exact where a control takes them and fitted where not.
#[test]
fn other_degrees_reach_every_dialect() {
    let curve = |order: usize, points: &[[i32; 2]]| {
        let (n, spans) = (points.len(), points.len() + 1 - order);
        let inner = (1..spans).map(|i| i.to_string());
        let ends = |k: usize| std::iter::repeat_n(k.to_string(), order);
        let knots: Vec<String> = ends(0).chain(inner).chain(ends(spans)).collect();
        let places: Vec<String> = points.iter().map(|[x, y]| format!("{x},{y},0")).collect();
        let [x, y] = points[n - 1];
        format!(
            "PARTNO DEGREE\nLOADTL/1\nRAPID\nGOTO/0,0,10\nFEDRAT/1000,MMPM\nGOTO/0,0,0\nMOVNRB/M3AXIS,LENGTH,0\n\
             MOVNRB/ON,{order},{},0,{n},0\nMOVNRB/1,{}\nMOVNRB/2,{}\nMOVNRB/OFF\nGOTO/{x},{y},10\nFINI\n",
            knots.len(),
            knots.join(","),
            places.join(",")
        )
    };
    let parabolas = curve(3, &[[0, 0], [10, 20], [30, 20], [40, 0]]);
    let quintics = curve(6, &[[0, 0], [10, 20], [20, -10], [30, 25], [45, 5], [55, 0], [60, 10]]);
    for text in [parabolas, quintics] {
        for dialect in splinepost::dialect::DIALECTS {
            for motion in dialect.motions.iter().filter(|motion| !matches!(motion.form, Form::Through(_))) {
                let output = in_motion("creo", &text, &machine(dialect), motion.name);
                let report = output.report.expect("a proof");
                assert_eq!(report.status, Status::Proved, "{}", motion.name);
                assert!(report.deviation.mm <= output.tolerance, "{}: {:?}", motion.name, report.deviation);
            }
        }
    }
}
