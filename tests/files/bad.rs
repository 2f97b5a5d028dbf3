//! Damaged files: what is said of them, and that nothing panics.

use super::writers::{WRITERS, drawing, dxf, entity, exchange, iges, model, step, with_blocks};
use super::{PROCESS, fixtures, found, sample};
use crate::robust::{edits, mutated};
use crate::support::sources_with;
use proptest::prelude::*;
use splinepost::front;

fn ids(name: &str, text: &str) -> Vec<&'static str> {
    found(name, text).err().map_or(vec![], |errors| errors.0.iter().map(|d| d.id).collect())
}

fn changed(name: &str, text: &str, from: &str, to: &str) -> Vec<&'static str> {
    assert!(text.contains(from), "{from} is not in\n{text}");
    ids(name, &text.replacen(from, to, 1))
}

#[test]
fn damaged_drawings() {
    let text = dxf(&[sample()]);
    let with = |from: &str, to: &str| changed("c.dxf", &text, from, to);
    assert_eq!(ids("c.dxf", &text), [""; 0]);
    assert_eq!(with(" 41\n1.25\n", ""), ["weight-count"]);
    assert_eq!(with(" 41\n1.25", " 41\n-1.25"), ["weight-range"]);
    assert_eq!(with(" 72\n10", " 72\n9"), ["count-differs"]);
    assert_eq!(with(" 73\n6", " 73\n7"), ["count-differs"]);
    assert_eq!(with(" 20\n15.0\n", ""), ["point-incomplete"]);
    assert_eq!(with(" 71\n3", " 71\n6"), ["degree-range"]);
    assert_eq!(with(" 71\n3\n", ""), ["group-missing"]);
    assert_eq!(with(" 71\n3", " 71\n2"), ["knot-count"]);
    assert_eq!(with("10.0", "1e400"), ["number-unreadable"]);
    assert_eq!(with("60.0", "6e7"), ["point-range"]);
    assert_eq!(with(" 71\n", " x1\n"), ["group-code"]);
    assert_eq!(with("  0\nEOF\n", ""), ["file-truncated"]);
    assert_eq!(with("$INSUNITS\n 70\n4", "$INSUNITS\n 70\n0"), ["units-unknown"]);
    assert_eq!(with("$INSUNITS\n 70\n4", "$MEASUREMENT\n 70\n1"), [""; 0]);
    assert_eq!(with("ENTITIES", "BLOCKS"), ["entities-missing"]);
    assert_eq!(ids("c.dxf", ""), ["file-truncated"]);
    let one = |text: &str| ids("c.dxf", &drawing(&entity(text)));
    assert_eq!(one("SPLINE 70=0 71=3 74=2 11=0 21=0 11=1 21=1"), ["spline-fit-points"]);
    assert_eq!(one("HELIX 40=1"), ["curve-unread"]);
    assert_eq!(one("CIRCLE 10=0 20=0 40=0"), ["radius-range"]);
    assert_eq!(one("CIRCLE 10=0 20=0 40=1 210=0 220=0 230=0"), ["normal-zero"]);
    assert_eq!(one("POLYLINE 66=1 70=0"), ["seqend-missing"]);
    assert_eq!(one("ARC 10=0 20=0 40=1 50=30 51=30"), ["turn-unclear"]);
    assert_eq!(one("ELLIPSE 10=0 20=0 11=1 21=0 40=1 41=0 42=6.2832"), ["turn-unclear"]);
    let blocks = |blocks: &[(&str, &str)], text: &str| ids("c.dxf", &with_blocks(blocks, &entity(text)));
    assert_eq!(blocks(&[], "INSERT 2=B 10=0 20=0"), ["block-unknown"]);
    assert_eq!(blocks(&[("B", "CIRCLE 10=0 20=0 40=1")], "INSERT 2=B 10=0 20=0 41=0"), ["scale-zero"]);
    let circle = [("B", "INSERT 2=C 10=1 20=0"), ("C", "INSERT 2=B 10=0 20=1")];
    assert_eq!(blocks(&circle, "INSERT 2=B 10=0 20=0"), ["block-circular"]);
    assert_eq!(blocks(&[("B", "LINE 10=0 20=0 11=1 21=0"); 2], "INSERT 2=B 10=0 20=0"), ["block-twice"]);
    assert_eq!(blocks(&[("B", "HELIX 40=1")], "INSERT 2=B 10=0 20=0"), ["curve-unread"]);
    // What is wrong in a block that nothing inserts is no part of the drawing.
    assert_eq!(blocks(&[("B", "HELIX 40=1")], "LINE 10=0 20=0 11=1 21=0"), [""; 0]);
    let many = [("B", "LINE 10=0 20=0 11=1 21=0"), ("C", "INSERT 2=B 10=0 20=0 70=9999 71=99 44=1 45=1")];
    assert_eq!(blocks(&many, "INSERT 2=C 10=0 20=0 70=99 44=1"), ["blocks-too-many"]);
    // Whatever its last entity lacks, that a part is missing is what there is to say.
    let half = text.find(" 41\n").expect("weights");
    assert_eq!(ids("c.dxf", &text[..half]), ["file-truncated"]);
    assert_eq!(one("VERTEX 10=0 20=0"), ["vertex-alone"]);
}

#[test]
fn damaged_iges() {
    let text = iges(&[sample()]);
    let with = |from: &str, to: &str| changed("c.igs", &text, from, to);
    assert_eq!(ids("c.igs", &text), [""; 0]);
    assert_eq!(with("1.25E0", "-.25E0"), ["weight-range"]);
    assert_eq!(with("1.25E0", "1.2.E0"), ["number-unreadable"]);
    assert_eq!(with("126,5,3,", "126,6,3,"), ["entity-truncated"]);
    assert_eq!(with("126,5,3,", "126,5,7,"), ["entity-truncated"]);
    assert_eq!(with("126,5,3,", "126,x,3,"), ["number-unreadable"]);
    assert_eq!(with("126,5,3,", "128,5,3,"), ["directory-differs"]);
    let cut = text.rfind('\n').and_then(|at| text[..at].rfind('\n')).expect("two lines");
    assert_eq!(ids("c.igs", &text[..cut]), ["file-truncated"]);
    assert_eq!(ids("c.igs", "hello\n"), ["section-unknown"]);
    assert_eq!(ids("c.igs", ""), ["file-truncated"]);
    let one = |kind, form, text: &str| ids("c.igs", &model(&[(kind, form, 0, "00000000", text.to_owned())]));
    assert_eq!(one(104, 1, "1.,0.,1.,0.,0.,-1.,0.,1.,0.,0.,1."), [""; 0]);
    assert_eq!(one(104, 1, "1.,0.,1.,0.,0.,-1.,0.,1.,0.,0.,1.1"), ["arc-misfit"]);
    assert_eq!(one(104, 2, "1.,0.,-1.,0.,0.,-1.,0.,1.,0.,2.,1.7320508"), ["curve-unread"]);
    assert_eq!(one(104, 3, "1.,0.,0.,0.,-1.,0.,0.,0.,0.,1.,1."), ["curve-unread"]);
    assert_eq!(one(100, 0, "0.,0.,0.,5.,0.,0.,6."), ["arc-misfit"]);
    assert_eq!(one(102, 0, "1,9"), ["reference-unknown"]);
    assert_eq!(one(102, 0, "1,1"), [""; 0], "a curve that is a part of itself is no curve");
    assert_eq!(one(112, 0, "3,1,3,1,1.,0."), ["knots-decrease"]);
    assert_eq!(one(126, 0, "1,1,0,0,1,0,0.,0.,4.,4.,1.,1.,0.,0.,0.,4.,8.,0.,1.,5."), ["range-outside"]);
    let moved = model(&[(110, 0, 9, "00000000", "0.,0.,0.,1.,0.,0.".to_owned())]);
    assert_eq!(ids("c.igs", &moved), ["reference-unknown"]);
}

#[test]
fn damaged_step() {
    let text = step(&[sample()]);
    let with = |from: &str, to: &str| changed("c.stp", &text, from, to);
    assert_eq!(ids("c.stp", &text), [""; 0]);
    assert_eq!(with("1.25E0", "0."), ["weight-range"]);
    assert_eq!(with(",1.25E0", ""), ["weight-count"]);
    assert_eq!(with("(4,2,4)", "(4,3,4)"), ["knot-count"]);
    assert_eq!(with("(4,2,4)", "(4,4)"), ["knot-count"]);
    assert_eq!(with("(4,2,4)", "(4,2,900000000000)"), ["knot-count"]);
    assert_eq!(with("(0.E0,1.E0,2.E0)", "(0.E0,2.E0,1.E0)"), ["knots-decrease"]);
    assert_eq!(with("#1003,", "#99,"), ["reference-unknown"]);
    assert_eq!(with("#1003,", "#900,"), ["kind-differs"]);
    assert_eq!(with("#1003,", ""), ["knot-count"]);
    assert_eq!(with("#1003=", "#1002="), ["instance-twice"]);
    assert_eq!(with(".F.,.F.)", ".F.,.F)"), ["instance-unreadable"]);
    assert_eq!(with("B_SPLINE_CURVE(3", "B_SPLINE_CURVE(9"), ["degree-range"]);
    assert_eq!(with(".MILLI.", ".MILLY."), ["units-unreadable"]);
    assert_eq!(with("#900,#901", "#901"), ["units-unknown"]);
    assert_eq!(with("#900,#901", "#900,#904"), ["units-unknown"]);
    assert_eq!(with("END-ISO-10303-21;", ""), ["file-truncated"]);
    assert_eq!(ids("c.stp", "hello"), ["step-header"]);
    let frame = "#1=CARTESIAN_POINT('',(0.,0.,0.));\n#2=AXIS2_PLACEMENT_3D('',#1,$,$);\n#3=CIRCLE('',#2,5.);\n\
                 #4=CARTESIAN_POINT('',(6.,0.,0.));\n#5=PARABOLA('',#2,1.);\n";
    let one = |text: &str| ids("c.stp", &exchange(&format!("{frame}{text}")));
    assert_eq!(one("#9=SEAM_CURVE('',#5,(),$);\n"), ["curve-unread"]);
    assert_eq!(
        one("#9=TRIMMED_CURVE('',#3,(#4),(#1),.T.,.CARTESIAN.);\n#8=PCURVE('',#5,$);\n"),
        ["turn-unclear"]
    );
    assert_eq!(one("#9=TRIMMED_CURVE('',#9,(#4),(#1),.T.,.CARTESIAN.);\n#8=PCURVE('',#5,$);\n"), [""; 0]);
    assert_eq!(one("#9=GEOMETRIC_SET('',(#9,#5));\n"), ["curve-unread"]);
}

#[test]
fn keys_of_the_job() {
    let text = dxf(&[sample()]);
    let job = front::find("job").expect("jobs");
    let ids = |file: &str, keys: &str| -> Vec<&'static str> {
        let sources =
            sources_with(&format!("{PROCESS}[[curve]]\nfile = \"{file}\"\n{keys}"), &[("c.dxf", &text)]);
        match (job.parse)(&sources) {
            Ok(intent) => intent.warnings.0.iter().map(|d| d.id).collect(),
            Err(errors) => errors.0.iter().map(|d| d.id).collect(),
        }
    };
    assert_eq!(ids("c.dxf", "at = { Z = -2 }\n"), [""; 0]);
    assert_eq!(ids("c.dxf", ""), ["retract-axis-rests"]);
    assert_eq!(ids("c.dxf", "axes = [\"X\", \"Y\", \"Z\"]\n"), [""; 0]);
    assert_eq!(ids("c.dxf", "axes = [\"X\", \"Y\", \"Z\"]\nat = { Z = 1 }\n"), ["axis-twice"]);
    assert_eq!(ids("c.dxf", "axes = [\"X\", \"A\"]\n"), ["axes-range"]);
    assert_eq!(ids("c.dxf", "at = { Z = 0 }\nunits = \"inch\"\n"), ["units-overruled"]);
    assert_eq!(ids("c.dxf", "units = \"feet\"\n"), ["word-unknown"]);
    assert_eq!(ids("c.dxf", "order = \"chian\"\n"), ["word-unknown"]);
    assert_eq!(ids("c.dxf", "join = 0\n"), ["join-range"]);
    assert_eq!(ids("c.dxf", "kind = \"nurbs\"\nat = { Z = 0 }\n"), ["key-needless"]);
    assert_eq!(ids("other.dxf", ""), ["file-unreadable"]);
    assert_eq!(ids("c.dwg", ""), ["file-kind"]);
    let sources = sources_with(
        &format!("{PROCESS}[[curve]]\nfile = \"c.dxf\"\naxes = [\"X\", \"Y\"]\n"),
        &[("c.dxf", &drawing(&entity("LINE 10=0 20=0 30=0 11=1 21=1 31=1")))],
    );
    assert_eq!((job.parse)(&sources).unwrap_err().0[0].id, "file-not-plane");
    let none = sources_with(
        &format!("{PROCESS}[[curve]]\nfile = \"c.dxf\"\n"),
        &[("c.dxf", &drawing(&entity("POINT 10=0 20=0")))],
    );
    let errors = (job.parse)(&none).unwrap_err();
    assert_eq!(errors.0.iter().map(|d| d.id).collect::<Vec<_>>(), ["entity-left-out", "curve-missing"]);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn readers_survive_any_text(edits in edits()) {
        let mut all: Vec<(String, String)> = fixtures();
        all.extend(WRITERS.iter().map(|(name, write)| ((*name).to_owned(), write(&[sample()]))));
        for (name, text) in all {
            if let Err(errors) = found(&name, &mutated(&text, &edits)) {
                prop_assert!(errors.has_errors(), "a failure without a word");
                let source = splinepost::source::Source::new(name.as_str(), mutated(&text, &edits));
                // What is told can be drawn.
                let drawn = errors.render(&splinepost::source::Sources::new(source), false);
                prop_assert!(drawn.contains("error"));
            }
        }
    }
}
