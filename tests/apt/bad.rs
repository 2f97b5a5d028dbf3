//! Input that is none: a diagnostic with its place, and never a panic.

use super::{inputs, intent_as};
use proptest::prelude::*;
use splinepost::diagnostic::Severity;
use splinepost::front;
use splinepost::source::{Encoding, Source, SourceId, Sources};

const START: &str = "LOADTL/1\nFEDRAT/100\nRAPID\nGOTO/0,0,10\nGOTO/0,0,0\n";

/// The id of the only error, and the text that it points at.
fn error(system: &str, text: &str) -> (&'static str, String) {
    let errors = intent_as(system, text, false).expect_err(text);
    let error = errors.0.iter().find(|d| Severity::Refusal <= d.severity).expect("an error");
    let span = error.span.expect("a place");
    (error.id, text.get(span.start as usize..span.end as usize).unwrap_or_default().to_owned())
}

#[test]
fn splines_that_are_none() {
    let catia = |points: &str, end: &str| {
        format!("{START}BEGIN NURBS_SIEMENS(D=3,F=1000,AXIS=0.0,0.0,1.0)\n{points}{end}GOTO/1,0,0\nFINI\n")
    };
    let point =
        |i: usize, x: f64, dk: f64, w: f64| format!("N{i},XT={x:.1},YT=0.0,ZT=0.0,DK={dk:.1},W={w:.1};\n");
    let four = |dk: f64, w: f64| {
        [point(0, 0.0, 0.0, 1.0), point(1, 1.0, 0.0, w), point(2, 2.0, dk, 1.0), point(3, 3.0, 0.0, 1.0)]
            .concat()
    };
    assert!(intent_as("catia", &catia(&four(3.0, 1.0), "END NURBS\n"), false).is_ok());
    let id = |text: &str| error("catia", text).0;
    assert_eq!(id(&catia(&four(3.0, 1.0), "")), "nurbs-unfinished");
    assert_eq!(id(&catia(&four(-3.0, 1.0), "END NURBS\n")), "knots-decrease");
    assert_eq!(id(&catia(&four(3.0, 0.0), "END NURBS\n")), "weight-range");
    assert_eq!(id(&catia(&four(0.0, 1.0), "END NURBS\n")), "nurbs");
    assert_eq!(id(&catia(&point(1, 0.0, 0.0, 1.0), "END NURBS\n")), "nurbs-point");
    assert_eq!(id(&catia("N0,XT=1.0,YT=0.0;\n", "END NURBS\n")), "nurbs-point");
    assert_eq!(id(&catia("N0,XT=nan,YT=0.0,ZT=0.0,DK=0.0,W=1.0;\n", "END NURBS\n")), "nurbs-point");
    assert_eq!(id(&catia("", "END NURBS\n")), "nurbs");
    assert_eq!(id(&catia(&four(3.0, 1.0).replace("XT=0.0", "XT=0.5"), "END NURBS\n")), "spline-start");
    let header = |header: &str| id(&format!("{START}BEGIN NURBS_SIEMENS{header}\nFINI"));
    assert_eq!(header(""), "nurbs-header");
    assert_eq!(header("(D=5,F=1000,AXIS=0.0,0.0,1.0)"), "nurbs-degree");
    assert_eq!(header("(D=3,F=0,AXIS=0.0,0.0,1.0)"), "feed-range");
    assert_eq!(header("(D=3,F=9,AXIS=0.0,1.0,0.0)"), "spline-axis");
    assert_eq!(header("(D=3,F=9,AXIS=VAR)"), "nurbs-header");
    assert_eq!(header("(D=3,F=9,AXIS=VAR,LENGTH=0)"), "nurbs-header");
    let nx = |body: &str| error("nx", &format!("{START}NURBS/\n{body}\nFINI")).0;
    assert_eq!(nx("KNOT/0.5,1.0\nCNTRL/1,0,0"), "nurbs-counts");
    assert_eq!(
        nx("KNOT/0.9,0.5,1.0\nCNTRL/1,0,0\nCNTRL/2,0,0\nCNTRL/3,0,0\nCNTRL/4,0,0\nCNTRL/5,0,0"),
        "nurbs"
    );
    assert_eq!(nx("CNTRL/1,0,0\nKNOT/1.0"), "nurbs-order");
    assert_eq!(error("nx", "CNTRL/1,0,0").0, "nurbs-order");
    let creo = |body: &str| error("creo", &format!("{START}MOVNRB/ON,4,8,0,4,3\n{body}\nFINI")).0;
    assert_eq!(creo("MOVNRB/1,0,0,0,0,1,1,1,1\nMOVNRB/OFF"), "nurbs-counts");
    assert_eq!(creo("GOTO/1,2,3"), "movnrb-inside");
}

#[test]
fn arcs_that_are_none() {
    let id = |statement: &str| error("creo", &format!("{START}{statement}\nFINI")).0;
    assert_eq!(id("CIRCLE/5,0,0,0,0,1,5"), "arc-end-missing");
    assert_eq!(id("CIRCLE/5,0,0,0,0,1,5\nGOTO/9,0,0"), "arc-misfit");
    assert_eq!(id("CIRCLE/5,0,0,0,0,1,4\nGOTO/10,0,0"), "arc-misfit");
    assert_eq!(id("CIRCLE/5,0,0,0,0,0,5\nGOTO/10,0,0"), "arc-plane");
    assert_eq!(id("CIRCLE/0,0,0,0,0,1,0\nGOTO/10,0,0"), "arc");
    assert_eq!(id("CIRCLE/5,0\nGOTO/10,0,0"), "arc-numbers");
    assert_eq!(id("RAPID\nCIRCLE/5,0,0,0,0,1,5\nGOTO/10,0,0"), "rapid-arc");
    assert_eq!(id("MOVARC/5,0,0,0,0,1,5,ANGLE,90\nGOTO/10,0,0"), "arc-sweep");
    assert_eq!(id("TLON,GOFWD/(CIRCLE/5,0,0,5)"), "tangent-missing");
    assert_eq!(id("INDIRV/0,1,0\nTLON,GOFWD/(CIRCLE/5,0,0,5)"), "tlon");
    assert_eq!(error("creo", "FEDRAT/1\nCIRCLE/5,0,0,0,0,1,5\nGOTO/10,0,0").0, "start-unknown");
}

#[test]
fn text_that_is_none() {
    assert_eq!(error("apt", "GOTO/1,2,\u{1}\n"), ("statement-unreadable", "\u{1}".into()));
    assert_eq!(error("apt", "GOTO/1,2,3\n"), ("feed-missing", "GOTO/1,2,3".into()));
    assert_eq!(error("apt", "GOTO/1e999,2,3\n").0, "number-range");
    assert_eq!(error("apt", "PARTNO X\n"), ("moves-missing", "PARTNO X".into()));
    assert_eq!(error("apt", "").0, "moves-missing");
    assert_eq!(error("apt", "FEDRAT/1\nGOTO/1,$\n 2,$\n x\n").0, "arguments");
    assert_eq!(error("apt", "GOTTO/1,2,3").1, "GOTTO");
    // A line without an end: one report, and its text is not kept.
    let long = format!("{START}GOTO/{}", "1,".repeat(3_000_000));
    assert_eq!(error("apt", &long), ("statement-too-long", "G".into()));
    let deep = format!("{START}TLON,{}", "(A/".repeat(400_000));
    assert_eq!(error("apt", &deep).0, "statement-too-long");
    let deep = format!("{START}TLON,{}", "(A/".repeat(4_000));
    assert_eq!(error("apt", &deep).0, "statement-unreadable");
}

#[test]
fn bytes_that_are_not_utf8_are_windows_1252() {
    let bytes =
        b"PARTNO PI\xc8CE\nLOADTL/1\nSPINDL/9\nFEDRAT/9,MMPM\nRAPID\nGOTO/1,2,3\nGOTO/1,2,4\n".to_vec();
    let source = Source::decode("input.cl", bytes);
    assert_eq!((source.encoding, source.text.contains("PIÈCE")), (Encoding::Windows1252, true));
    let sources = Sources::new(source);
    let intent = (front::find("apt").expect("CL data").parse)(&sources).expect("it reads");
    let ids: Vec<&str> = intent.warnings.0.iter().map(|d| d.id).collect();
    assert_eq!((ids, intent.program.name.as_str()), (vec!["text-windows-1252"], "PIECE"));
    let every: Vec<u8> = (0..=255).collect();
    let _ = (front::find("apt").expect("CL data").parse)(&Sources::new(Source::decode("b", every)));
}

/// Whoever reads an error sees his own line, joined or not.
#[test]
fn diagnostics_point_at_the_line() {
    let text = "LOADTL/1\r\nFEDRAT/100,MMPM\r\nCYCLE / DEEP, DEPTH, 3.5, STEP, 1.0, MMPM, 50.0, CLEAR,$\r\n 1.0, FROBNI, 7.0\r\n";
    let errors = intent_as("creo", text, false).expect_err("FROBNI");
    let sources = Sources::new(Source::new("input.ncl", text));
    let drawn = errors.render(&sources, false);
    assert!(drawn.contains("input.ncl:4:") && drawn.contains("FROBNI") && !drawn.contains('␍'), "{drawn}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn no_text_is_too_strange(edits in prop::collection::vec((any::<usize>(), any::<u8>(), prop_oneof![
        4 => prop::sample::select(b"0123456789.,-+/=()$'; \nGOTCIRLENUDK\r".to_vec()),
        1 => any::<u8>(),
    ]), 1..8)) {
        for (_, text) in inputs() {
            let mut bytes = text.into_bytes();
            for (place, kind, byte) in &edits {
                if bytes.is_empty() {
                    break;
                }
                let at = place % bytes.len();
                match kind % 4 {
                    0 => bytes[at] = *byte,
                    1 => drop(bytes.remove(at)),
                    2 => bytes.insert(at, *byte),
                    _ => bytes.truncate(at),
                }
            }
            let sources = Sources::new(Source::decode("input.cl", bytes));
            if let Err(errors) = (front::find("apt").expect("CL data").parse)(&sources) {
                prop_assert!(errors.has_errors());
                prop_assert!(!errors.render(&sources, false).is_empty());
            }
            let _ = front::detect(sources.get(SourceId::INPUT).expect("the input"));
        }
    }
}
