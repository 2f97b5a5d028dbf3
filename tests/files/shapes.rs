//! Every kind of curve that is read, its places from a closed form.

use super::writers::{drawing, entity, exchange, model, with_blocks};
use super::{curves, found};
use approx::assert_relative_eq;
use splinepost::front::curves::Path;
use splinepost::geom::bezier::Bezier;

/// The pieces of a path.
fn pieces(path: &Path) -> Vec<Bezier> {
    let place = |p: &[f64; 3]| [p[0], p[1], p[2], 0.0, 0.0, 0.0];
    match path {
        Path::Lines(points, _) => {
            points.windows(2).map(|p| Bezier::line(place(&p[0]), place(&p[1]))).collect()
        }
        Path::Conic(conic) => conic.mapped(&place).pieces(),
        Path::Pieces(pieces) => pieces.clone(),
        Path::Nurbs(nurbs) => nurbs.beziers().map(|(piece, _)| piece).collect(),
    }
}

/// Places along a path, ends and middles of its pieces.
fn places(path: &Path) -> Vec<[f64; 3]> {
    let pieces = pieces(path);
    let place = |p: [f64; 6]| [p[0], p[1], p[2]];
    let mut all = vec![place(pieces[0].start())];
    for piece in pieces {
        all.extend([0.25, 0.5, 0.75, 1.0].map(|t| place(piece.eval(t))));
    }
    all
}

/// That a path runs from one place to another through places where `zero` is 0.
#[track_caller]
fn runs(path: &Path, from: [f64; 3], to: [f64; 3], zero: impl Fn([f64; 3]) -> f64) {
    for (found, wanted) in [(path.start(), from), (path.end(), to)] {
        for i in 0..3 {
            assert!((found[i] - wanted[i]).abs() < 1e-12, "{found:?} is not {wanted:?}");
        }
    }
    for place in places(path) {
        // Some ten roundings of squares of numbers below 100.
        assert!(zero(place).abs() < 1e-11, "{place:?}: {}", zero(place));
    }
}

fn one(text: &str) -> Path {
    let mut curves = curves("c.dxf", &drawing(&entity(text)));
    assert_eq!(curves.len(), 1);
    curves.remove(0).path
}

fn circle(center: [f64; 3], radius: f64) -> impl Fn([f64; 3]) -> f64 {
    move |p| {
        let d = [p[0] - center[0], p[1] - center[1], p[2] - center[2]];
        d.iter().map(|x| x * x).sum::<f64>() - radius * radius
    }
}

#[test]
fn arcs_of_drawings() {
    let arc = one("ARC 10=5 20=5 30=1 40=5 50=0 51=90");
    runs(&arc, [10., 5., 1.], [5., 10., 1.], circle([5., 5., 1.], 5.));
    // Past zero.
    let arc = one("ARC 10=0 20=0 30=0 40=5 50=270 51=90");
    runs(&arc, [0., -5., 0.], [0., 5., 0.], circle([0.; 3], 5.));
    assert!(places(&arc).iter().all(|p| -1e-12 < p[0]));
    // Seen from below, X is turned round: the arc runs the other way.
    let below = one("ARC 10=5 20=5 30=-1 40=5 50=0 51=90 210=0 220=0 230=-1");
    runs(&below, [-10., 5., 1.], [-5., 10., 1.], circle([-5., 5., 1.], 5.));
    // Normal X: the axes are Y and Z.
    let upright = one("CIRCLE 10=2 20=3 30=7 40=4 210=1 220=0 230=0");
    runs(&upright, [7., 6., 3.], [7., 6., 3.], circle([7., 2., 3.], 4.));
    assert!(places(&upright).iter().all(|p| (p[0] - 7.0).abs() < 1e-14));
    assert_eq!(pieces(&upright).len(), 4);
}

#[test]
fn ellipses_of_drawings() {
    let zero = |p: [f64; 3]| ((p[0] - 1.0) / 4.0) * ((p[0] - 1.0) / 4.0) + (p[1] / 2.0) * (p[1] / 2.0) - 1.0;
    let half = one("ELLIPSE 10=1 20=0 30=0 11=4 21=0 31=0 40=0.5 41=0 42=3.141592653589793");
    runs(&half, [5., 0., 0.], [-3., 0., 0.], zero);
    assert!(places(&half).iter().all(|p| -1e-12 < p[1]));
    let whole = one("ELLIPSE 10=1 20=0 30=0 11=4 21=0 31=0 40=0.5 41=0 42=6.283185307");
    runs(&whole, [5., 0., 0.], [5., 0., 0.], zero);
}

#[test]
fn polylines_of_drawings() {
    let text = entity("LWPOLYLINE 90=3 70=1 38=2 10=0 20=0 10=10 20=0 42=1 10=10 20=10");
    let all = curves("c.dxf", &drawing(&text));
    let [line, arc, back] = &all[..] else { panic!("{all:?}") };
    runs(&line.path, [0., 0., 2.], [10., 0., 2.], |p| p[1]);
    // Bulge 1 is half a circle, to the right of the way.
    runs(&arc.path, [10., 0., 2.], [10., 10., 2.], circle([10., 5., 2.], 5.));
    assert!(places(&arc.path).iter().all(|p| 10.0 - 1e-12 < p[0]));
    runs(&back.path, [10., 10., 2.], [0., 0., 2.], |p| p[0] - p[1]);
    let text = [
        entity("POLYLINE 66=1 70=8"),
        entity("VERTEX 10=0 20=0 30=0 70=32"),
        entity("VERTEX 10=1 20=2 30=3 70=32 42=1"),
        entity("VERTEX 10=9 20=9 30=9 70=16"),
        entity("VERTEX 10=1 20=2 30=9 70=32"),
        entity("SEQEND 8=0"),
    ];
    let all = curves("c.dxf", &drawing(&text.concat()));
    assert_eq!(all.len(), 1);
    assert!(matches!(&all[0].path, Path::Lines(points, lines) if points.len() == 3 && lines.len() == 2));
    // A quarter: tan(π/8).
    let text = entity("LWPOLYLINE 90=2 70=0 10=10 20=0 42=-0.41421356237309503 10=0 20=-10");
    runs(&curves("c.dxf", &drawing(&text))[0].path, [10., 0., 0.], [0., -10., 0.], circle([0.; 3], 10.));
}

#[test]
fn what_is_no_curve_is_told_of_once_a_kind() {
    let text = [
        entity("TEXT 10=0 20=0"),
        entity("LINE 10=0 20=0 11=1 21=0"),
        entity("TEXT 10=1 20=0"),
        entity("LINE 67=1 10=0 20=0 11=1 21=0"),
        entity("LINE 10=3 20=0 11=3 21=0"),
        entity("LINE 8=CENTER 10=0 20=0 11=1 21=0"),
        entity("POLYLINE 66=1 70=64"),
        entity("VERTEX 10=0 20=0"),
        entity("SEQEND 8=0"),
        entity("INSERT 66=1 2=B 10=0 20=0"),
        entity("ATTRIB 1=x"),
        entity("SEQEND 8=0"),
    ];
    let found = found("c.dxf", &with_blocks(&[("B", "POINT 10=0 20=0")], &text.concat())).unwrap();
    assert_eq!(found.curves.len(), 2);
    let told: Vec<&str> = found.warnings.0.iter().map(|d| d.message.as_str()).collect();
    assert_eq!(
        told,
        [
            "curves of 2 layers are run alike: 0 (2), CENTER (1)",
            "TEXT is left out, 2 times",
            "LINE in paper space is left out",
            "POLYLINE that is a mesh is left out",
            "POINT is left out",
            "ATTRIB is left out",
            "LINE without length is left out",
        ]
    );
}

/// A quarter circle twice as wide and turned, mirrored, in an array and in another block.
#[test]
fn blocks_of_drawings() {
    let quarter = "ARC 10=1 20=1 30=0 40=2 50=0 51=90";
    let read = |blocks: &[(&str, &str)], insert: &str| curves("c.dxf", &with_blocks(blocks, &entity(insert)));
    // x is doubled, then all is turned: the centre (1, 1) comes to (11 − 1, 18 + 2), (2 cos t, 2 sin t) to (−2 sin t, 4 cos t).
    let all = read(&[("B", quarter)], "INSERT 2=b 10=11 20=18 41=2 50=90");
    runs(&all[0].path, [10., 24., 0.], [8., 20., 0.], |p| {
        let (x, y) = ((p[0] - 10.0) / 2.0, (p[1] - 20.0) / 4.0);
        x * x + y * y - 1.0
    });
    // Mirrored, it runs clockwise.
    let all = read(&[("B", quarter)], "INSERT 2=B 10=0 20=0 41=-1");
    runs(&all[0].path, [-3., 1., 0.], [-1., 3., 0.], circle([-1., 1., 0.], 2.0));
    let all = read(&[("B", quarter)], "INSERT 2=B 10=0 20=0 70=3 71=2 44=10 45=-10 41=1");
    let starts: Vec<[f64; 3]> = all.iter().map(|curve| curve.path.start()).collect();
    let right = [[3., 1.], [13., 1.], [23., 1.], [3., -9.], [13., -9.], [23., -9.]];
    assert_eq!(starts, right.map(|[x, y]| [x, y, 0.]));
    // Shifted by 5 within a block that is shifted by 100.
    let all = read(&[("B", quarter), ("C", "INSERT 2=B 10=5 20=0")], "INSERT 2=C 10=100 20=0");
    runs(&all[0].path, [108., 1., 0.], [106., 3., 0.], circle([106., 1., 0.], 2.0));
}

/// Whole turns as files print them, and what is next to none.
#[test]
fn turns_are_told_before_they_are_reduced() {
    let ellipse = |end: &str| one(&format!("ELLIPSE 10=0 20=0 30=0 11=4 21=0 31=0 40=0.5 41=0 42={end}"));
    for end in ["6.28319", "6.2831855", "6.28318530718", "6.283185"] {
        let whole = ellipse(end);
        assert!(whole.start() == whole.end() && places(&whole).len() == 17, "{end}");
    }
    assert_eq!(one("ARC 10=0 20=0 40=1 50=0 51=360.0001").start(), [1., 0., 0.]);
    assert_eq!(places(&one("ARC 10=0 20=0 40=1 50=30 51=390.0001")).len(), 17);
    // Five millionths of a turn are that, not a whole one.
    let short = one("ARC 10=0 20=0 40=1000 50=0 51=0.0001");
    let size = short.end()[1];
    assert!((size - 1.0e-4 * std::f64::consts::PI / 0.18).abs() < 1e-9, "{size}");
    let frame =
        "#1=CARTESIAN_POINT('',(0.,0.,0.));\n#2=AXIS2_PLACEMENT_3D('',#1,$,$);\n#3=CIRCLE('',#2,10.);\n";
    let step = |trim: &str| found("c.stp", &exchange(&format!("{frame}#9=TRIMMED_CURVE('',#3,{trim});\n")));
    let whole = step("(PARAMETER_VALUE(0.)),(PARAMETER_VALUE(6.28318530718)),.T.,.PARAMETER.").unwrap();
    assert_eq!(places(&whole.curves[0].path).len(), 17);
    // 6.28318530718 is 4e-13 above 2π, 4e-12 mm at radius 10.
    assert!((whole.curves[0].error - 4.1e-12).abs() < 0.2e-12, "{}", whole.curves[0].error);
    let none = step("(PARAMETER_VALUE(1.)),(PARAMETER_VALUE(1.)),.T.,.PARAMETER.").unwrap_err();
    assert_eq!(none.0[0].id, "turn-unclear");
    // The file of the writer tells 1e-7 apart.
    let iges =
        |end: &str| found("c.igs", &model(&[(100, 0, 0, "00000000", format!("0.,0.,0.,5.,0.,{end}"))]));
    assert_eq!(places(&iges("5.,1.E-8").unwrap().curves[0].path).len(), 17);
    for end in ["5.,1.E-6", "5.,-1.E-6"] {
        assert_eq!(iges(end).unwrap_err().0[0].id, "turn-unclear", "{end}");
    }
    assert_eq!(iges("5.,1.E-3").unwrap().curves[0].path.end(), [5., 1e-3, 0.]);
}

/// Arcs that are straight, and an arc whose centre is twenty thousand kilometres away.
#[test]
fn arcs_that_are_nearly_straight() {
    let read = |bulge: &str, long: &str| {
        let text = entity(&format!("LWPOLYLINE 90=2 70=0 10=0 20=0 42={bulge} 10={long} 20=0"));
        curves("c.dxf", &drawing(&text)).remove(0)
    };
    let line = read("1e-6", "30");
    assert!(matches!(line.path, Path::Lines(..)));
    // b c/2
    assert_relative_eq!(line.error, 1.5e-5, epsilon = 1e-14);
    for bulge in ["1e-13", "1e-300", "-1e-320"] {
        assert!(matches!(read(bulge, "30").path, Path::Lines(..)), "{bulge}");
    }
    let far = read("1e-7", "8000");
    let Path::Pieces(pieces) = &far.path else { panic!("{far:?}") };
    let top = pieces[0].eval(0.5);
    assert!((top[0] - 4000.0).abs() < 1e-9 && (top[1] + 4.0e-4).abs() < 1e-12, "{top:?}");
}

#[test]
fn curves_of_iges() {
    let entities = |all: &[(u32, u32, usize, &str, &str)]| {
        let all: Vec<_> = all.iter().map(|(k, f, m, s, p)| (*k, *f, *m, *s, (*p).to_owned())).collect();
        found("c.igs", &model(&all)).unwrap_or_else(|e| panic!("{e:?}"))
    };
    let path = |found: &splinepost::front::curves::Found, i: usize| found.curves[i].path.clone();
    // A quarter turn about X and a shift, of an arc and of the line in front of it.
    let matrix = "1.,0.,0.,1.,0.,0.,-1.,2.,0.,1.,0.,3.";
    let all = entities(&[
        (124, 0, 0, "00000000", matrix),
        (110, 0, 0, "00010000", "0.,5.,0.,5.,5.,0."),
        (100, 0, 0, "00010000", "0.,5.,0.,5.,5.,0.,0."),
        (102, 0, 1, "00000000", "2,3,5"),
        (116, 0, 0, "00000000", "1.,1.,1."),
        (110, 0, 0, "01000000", "0.,5.,0.,5.,5.,0."),
    ]);
    assert_eq!(all.curves.len(), 2);
    runs(&path(&all, 0), [1., 2., 8.], [6., 2., 8.], |p| p[2] - 8.0);
    runs(&path(&all, 1), [6., 2., 8.], [1., 2., 3.], circle([6., 2., 3.], 5.));
    let told: Vec<&str> = all.warnings.0.iter().map(|d| d.message.as_str()).collect();
    assert_eq!(told, ["entity 116 is left out", "entity 110 that is blanked is left out"]);
    // y = s³ − s, on two spans, with x = s.
    let all = entities(&[(
        112,
        0,
        0,
        "00000000",
        "3,1,2,2,0.,1.,3.,0.,1.,0.,0.,0.,-1.,0.,1.,0.,0.,0.,0.,1.,1.,0.,0.,0.,2.,3.,1.D0,0.,0.,0.,0.,0.,0.,0.,0.,0.,0.,0.,0.,0.,0.,0.,0.",
    )]);
    runs(&path(&all, 0), [0., 0., 0.], [3., 24., 0.], |p| p[1] - p[0] * p[0] * p[0] + p[0]);
    let all = entities(&[(106, 63, 0, "00000000", "1,3,2.,0.,0.,5.,0.,5.,5.")]);
    runs(&path(&all, 0), [0., 0., 2.], [0., 0., 2.], |p| p[2] - 2.0);
    // From a parameter to another: x = t.
    let all = entities(&[(
        126,
        0,
        0,
        "00000000",
        "1,1,0,0,1,0,0.,0.,4.,4.,1.,1.,0.,0.,0.,4.,8.,0.,1.,3.,0.,0.,1.",
    )]);
    runs(&path(&all, 0), [1., 2., 0.], [3., 6., 0.], |p| p[1] - 2.0 * p[0]);
}

#[test]
fn curves_of_step() {
    let frame = "#1=CARTESIAN_POINT('',(1.,2.,3.));\n#2=DIRECTION('',(0.,0.,1.));\n#3=DIRECTION('',(0.,1.,0.));\n\
        #4=AXIS2_PLACEMENT_3D('',#1,#2,#3);\n#5=CIRCLE('',#4,5.);\n\
        #11=CARTESIAN_POINT('',(1.,7.,3.));\n#12=CARTESIAN_POINT('',(6.,2.,3.));\n#13=CARTESIAN_POINT('',(9.,2.,3.));\n\
        #14=VECTOR('',#2,2.);\n#15=LINE('',#1,#14);\n#21=VERTEX_POINT('',#11);\n#22=VERTEX_POINT('',#12);\n";
    let path = |instances: &str| {
        let mut all = curves("c.stp", &exchange(&format!("{frame}{instances}")));
        assert!(!all.is_empty());
        all.remove(0).path
    };
    let on = || circle([1., 2., 3.], 5.);
    // X of the placement is Y, and its Y is −X: angle 0 at (1, 7), a quarter at (−4, 2).
    let trimmed = "#30=TRIMMED_CURVE('',#5,(PARAMETER_VALUE(0.)),(PARAMETER_VALUE(1.5707963267948966)),.T.,.PARAMETER.);\n";
    runs(&path(trimmed), [1., 7., 3.], [-4., 2., 3.], on());
    let back = "#30=TRIMMED_CURVE('',#5,(#11),(#12),.F.,.CARTESIAN.);\n";
    let short = path(back);
    runs(&short, [1., 7., 3.], [6., 2., 3.], on());
    assert_eq!(places(&short).len(), 5);
    let long = path("#30=TRIMMED_CURVE('',#5,(#11),(#12),.T.,.CARTESIAN.);\n");
    runs(&long, [1., 7., 3.], [6., 2., 3.], on());
    assert_eq!(places(&long).len(), 13);
    let line = path(
        "#29=GEOMETRIC_SET('',(#30));\n#30=TRIMMED_CURVE('',#15,(PARAMETER_VALUE(1.)),(PARAMETER_VALUE(-1.)),.F.,.PARAMETER.);\n",
    );
    runs(&line, [1., 2., 5.], [1., 2., 1.], |p| p[0] - 1.0);
    let edge = path("#30=EDGE_CURVE('',#21,#22,#5,.F.);\n");
    runs(&edge, [1., 7., 3.], [6., 2., 3.], on());
    assert_eq!(places(&edge).len(), 5);
    let ellipse = path("#6=ELLIPSE('',#4,4.,2.);\n#30=GEOMETRIC_CURVE_SET('',(#6));\n");
    runs(&ellipse, [1., 6., 3.], [1., 6., 3.], |p| {
        (p[0] - 1.0) * (p[0] - 1.0) / 4.0 + (p[1] - 2.0) * (p[1] - 2.0) / 16.0 - 1.0
    });
    let all = curves(
        "c.stp",
        &exchange(&format!(
            "{frame}#30=COMPOSITE_CURVE('',(#31,#32),.F.);\n#31=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.F.,#33);\n\
             #32=COMPOSITE_CURVE_SEGMENT(.DISCONTINUOUS.,.T.,#34);\n#33=TRIMMED_CURVE('',#5,(#12),(#11),.T.,.CARTESIAN.);\n\
             #34=POLYLINE('',(#12,#13));\n"
        )),
    );
    assert_eq!(all.len(), 2);
    runs(&all[0].path, [1., 7., 3.], [6., 2., 3.], on());
    runs(&all[1].path, [6., 2., 3.], [9., 2., 3.], |p| p[1] - 2.0);
}

#[test]
fn knots_that_follow_from_the_kind() {
    let points: String =
        [0, 1, 2, 3, 4].map(|i| format!("#{}=CARTESIAN_POINT('',({i}.,{}.,0.));\n", 10 + i, i * i)).concat();
    let knots = |kind: &str, degree: usize| {
        let text = format!("{points}#30={kind}('',{degree},(#10,#11,#12,#13,#14),.UNSPECIFIED.,.F.,.F.);\n");
        let Path::Nurbs(nurbs) = curves("c.stp", &exchange(&text)).remove(0).path else { panic!("a spline") };
        nurbs
    };
    assert_eq!(knots("QUASI_UNIFORM_CURVE", 3).knots(), [0., 0., 0., 0., 1., 2., 2., 2., 2.]);
    assert_eq!(knots("BEZIER_CURVE", 2).knots(), [0., 0., 0., 1., 1., 2., 2., 2.]);
    assert_eq!(knots("BEZIER_CURVE", 4).knots(), [0., 0., 0., 0., 0., 1., 1., 1., 1., 1.]);
    // Uniform: on 0 … 3 the quadratic starts in the middle of its first two points.
    let uniform = knots("UNIFORM_CURVE", 2);
    assert_relative_eq!(uniform.eval(0.0)[0], 0.5, epsilon = 1e-15);
    assert_relative_eq!(uniform.eval(3.0)[0], 3.5, epsilon = 1e-15);
}
