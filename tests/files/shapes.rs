//! Every kind of curve that is read, its places from a closed form.

use super::writers::{drawing, entity, exchange, model};
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
        entity("INSERT 66=1 2=B"),
        entity("ATTRIB 1=x"),
        entity("SEQEND 8=0"),
    ];
    let found = found("c.dxf", &drawing(&text.concat())).unwrap();
    assert_eq!(found.curves.len(), 2);
    let told: Vec<&str> = found.warnings.0.iter().map(|d| d.message.as_str()).collect();
    assert_eq!(
        told,
        [
            "curves of 2 layers are run alike: 0 (2), CENTER (1)",
            "TEXT is left out, 2 times",
            "LINE in paper space is left out",
            "POLYLINE that is a mesh is left out",
            "INSERT, and with it the curves of its block, is left out",
            "ATTRIB is left out",
            "LINE without length is left out",
        ]
    );
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
