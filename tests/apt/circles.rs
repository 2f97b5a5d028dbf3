//! What stands behind a circle, between it and its end, and beside a start tangent.

use super::intent_as;
use splinepost::diagnostic::{Diagnostics, Severity};
use splinepost::geom::elementary;
use splinepost::ir::{Curve, Intent, Step};
use splinepost::source::{Source, Sources};
use splinepost::{Options, compile, front};
use std::f64::consts::PI;

const HEAD: &str = "UNITS/MM\nLOADTL/1\nSPINDL/1000,CLW\nFEDRAT/300,MMPM\nRAPID\nGOTO/0,0,10\nGOTO/30,0,0\n";
const CIRCLE: &str = "CIRCLE/30,10,0,0,0,1,10\n";

fn read(system: &str, body: &str) -> Result<Intent, Diagnostics> {
    intent_as(system, &format!("{HEAD}{body}\nFINI\n"), false)
}

/// How far each arc turns, degrees, and how many straight moves stand behind the last one.
fn arcs(intent: &Intent) -> (Vec<f64>, usize) {
    let (mut sweeps, mut lines) = (Vec::new(), 0);
    for located in &intent.program.steps {
        if let Step::Cut(cut) = &located.step {
            match &cut.curve {
                Curve::Arc(arc) => (sweeps, lines) = ([sweeps, vec![arc.sweep() * 180.0 / PI]].concat(), 0),
                Curve::Lines(line) => lines += line.count(),
                Curve::Nurbs(_)
                | Curve::Polynomial(_)
                | Curve::Through(..)
                | Curve::Logarithmic(_)
                | Curve::Formula(_) => panic!("{:?}", cut.curve),
            }
        }
    }
    (sweeps, lines)
}

/// The ids of the errors.
fn errors(system: &str, body: &str) -> Vec<&'static str> {
    let Err(found) = read(system, body) else { panic!("read: {body}") };
    found.0.iter().filter(|d| Severity::Refusal <= d.severity).map(|d| d.id).collect()
}

/// The ids of the warnings of a body that is read.
fn warnings(intent: &Intent) -> Vec<&'static str> {
    intent.warnings.0.iter().map(|d| d.id).collect()
}

/// The sweep of the only arc, the lines behind it, and the warnings.
fn one(system: &str, body: &str) -> (f64, usize, Vec<&'static str>) {
    let intent = read(system, body).unwrap_or_else(|e| panic!("{body}: {e:?}"));
    let (sweeps, lines) = arcs(&intent);
    assert_eq!(sweeps.len(), 1, "{body}");
    // Three decimals of the points at R = 10 mm leave 0.003 degrees open.
    ((sweeps[0] * 100.0).round() / 100.0, lines, warnings(&intent))
}

/// The text of a body, with a shop's word on the points of its arcs.
fn shop(points: &str, body: &str) -> Sources {
    let mut sources = Sources::new(Source::new("input.ncl", format!("{HEAD}{body}\nFINI\n")));
    let table = format!("extends = \"creo\"\ncircle_points = \"{points}\"\n");
    sources.words = Some(sources.push(Source::new("shop.toml", table)));
    sources
}

fn stated(points: &str, body: &str) -> Result<Intent, Diagnostics> {
    (front::find("creo").expect("creo").parse)(&shop(points, body))
}

/// The sweep of the only arc and the lines behind it, where points are stated to be along arcs; without that word they are none.
fn along(body: &str) -> (f64, usize) {
    assert_eq!(errors("creo", body), ["arc-points"], "{body}");
    let intent = stated("along", body).unwrap_or_else(|e| panic!("{body}: {e:?}"));
    assert!(intent.warnings.0.is_empty(), "{body}: {:?}", intent.warnings);
    let (sweeps, lines) = arcs(&intent);
    assert_eq!(sweeps.len(), 1, "{body}");
    ((sweeps[0] * 100.0).round() / 100.0, lines)
}

#[test]
fn the_points_behind_a_circle_of_creo_are_on_its_arc() {
    let creo = |points: &str| along(&format!("{CIRCLE}{points}"));
    assert_eq!(creo("GOTO/37.071,2.929,0\nGOTO/40,10,0"), (90.0, 0));
    // Round once, and away.
    let round = "GOTO/40,10,0\nGOTO/20,10,0\nGOTO/30,0,0\n";
    assert_eq!(creo(&format!("{round}GOTO/30,0,9\nGOTO/0,0,9")), (360.0, 2));
    // A helix whose points rise with it, and a line behind it that does not.
    assert_eq!(creo("GOTO/40,10,-1\nGOTO/30,20,-2\nGOTO/20,10,-5"), (180.0, 1));
    // Half moons, at however many depths, are not made whole.
    let moon = |z: i32| format!("GOTO/30,0,{z}\nCIRCLE/30,10,{z},0,0,1,10\nGOTO/30,20,{z}\nGOTO/30,0,{z}\n");
    assert!(errors("creo", &[moon(-1), moon(-2), moon(-3)].concat()).contains(&"arc-points"));
    // A feed or a remark among the points: one of two arcs, or a line, and nobody knows.
    for between in ["FEDRAT/100,MMPM", "$$ NOTE"] {
        let body = format!("{CIRCLE}GOTO/37.071,2.929,0\nGOTO/40,10,0\n{between}\nGOTO/30,20,0");
        let found = stated("along", &body).expect_err("a chord");
        assert_eq!(found.0[0].id, "arc-points", "{between}");
    }
    // A short line that leaves along the tangent is within 0.01 mm of the circle, and a line.
    assert_eq!(
        one("creo", &format!("{CIRCLE}GOTO/40,10,0\nGOTO/40,10.4,0\nGOTO/60,10.4,0")),
        (90.0, 2, vec![])
    );
    // Points so near that lines would be the same path are no question.
    let near: Vec<String> = (1..=90)
        .map(|i| {
            let angle = f64::from(i) * PI / 180.0;
            let (sin, cos) = (elementary::sin(angle), elementary::cos(angle));
            format!("GOTO/{:.5},{:.5},0", 30.0 + 10.0 * sin, 10.0 - 10.0 * cos)
        })
        .collect();
    let near = near.join("\n");
    assert_eq!(one("creo", &format!("{CIRCLE}{near}")), (90.0, 0, vec![]));
    // The other sense, and another plane.
    let other = "CIRCLE/30,10,0,0,0,-1,10\nGOTO/22.92893,2.92893,0\nGOTO/20,10,0\nGOTO/20,50,0";
    assert_eq!(along(other), (-90.0, 1));
    let upright = "CIRCLE/30,0,10,0,-1,0,10\nGOTO/37.07107,0,2.92893\nGOTO/40,0,10";
    assert_eq!((along(upright).0.abs(), along(upright).1), (90.0, 0));
}

#[test]
fn what_is_no_point_of_the_arc_is_a_line() {
    let creo = |points: &str| one("creo", &format!("{CIRCLE}{points}"));
    // Off the circle, straight up from its end, and back against the sense, beyond the start.
    assert_eq!(creo("GOTO/40,10,0\nGOTO/40,20,0"), (90.0, 1, vec![]));
    assert_eq!(creo("GOTO/40,10,0\nGOTO/40,10,50"), (90.0, 1, vec![]));
    assert_eq!(creo("GOTO/40,10,0\nGOTO/37.071,2.929,0"), (90.0, 1, vec![]));
    assert_eq!(creo("GOTO/30,0,-1\nGOTO/30,0,50"), (360.0, 1, vec![]));
    // A line behind more than half a turn, as of a shaft with a flat: told.
    assert_eq!(creo("GOTO/20,10,0\nGOTO/30,0,0"), (270.0, 1, vec!["arc-points"]));
    // What stands between ends the arc: told too, but not of a rapid.
    assert_eq!(creo("GOTO/40,10,0\nFEDRAT/200,MMPM\nGOTO/30,20,0"), (90.0, 1, vec!["arc-points"]));
    assert_eq!(creo("GOTO/40,10,0\n$$ REMARK\nGOTO/30,20,0"), (90.0, 1, vec!["arc-points"]));
    assert_eq!(creo("GOTO/40,10,0\nRAPID\nGOTO/30,20,0"), (90.0, 0, vec![]));
}

/// PTC's help lists the points of an arc in one statement; then the last is the end beyond doubt.
#[test]
fn points_that_are_listed_are_of_the_arc() {
    let body = format!("{CIRCLE}GOTO/37.071,2.929,0\n40,10,0\nGOTO/30,20,0");
    assert_eq!(one("creo", &body), (90.0, 1, vec![]));
    assert_eq!(errors("creo", &format!("{CIRCLE}GOTO/37.071,2.929,0\n40,11,0")), ["arc-points"]);
    assert_eq!(errors("creo", "GOTO/1,2,3\n40,11,0"), ["statement-unreadable"]);
}

/// An operation with an arc whose end is its only point has no points before the end of any.
#[test]
fn a_file_shows_whether_its_arcs_have_points() {
    let alone = format!("{CIRCLE}GOTO/30,20,0\nGOTO/0,20,0\nGOTO/30,0,0\n");
    let half_moon = format!("{CIRCLE}GOTO/40,10,0\nGOTO/30,20,0\n");
    let lines = |body: &str| {
        let intent = read("creo", body).unwrap_or_else(|e| panic!("{body}: {e:?}"));
        (arcs(&intent), warnings(&intent))
    };
    let rounded = |((sweeps, lines), ids): ((Vec<f64>, usize), Vec<&'static str>)| {
        (sweeps.iter().map(|s| s.round()).collect::<Vec<_>>(), lines, ids)
    };
    assert_eq!(rounded(lines(&[&*alone, &half_moon].concat())), (vec![180.0, 90.0], 1, vec!["arc-points"]));
    // Wherever it stands.
    let body = [&*half_moon, "GOTO/30,0,0\n", &alone].concat();
    assert_eq!(rounded(lines(&body)).0, [90.0, 180.0]);
    // Another operation may have other parameters: nobody knows.
    let body = [&*alone, "$$-> FEATNO / 7\n", &half_moon].concat();
    assert_eq!(errors("creo", &body), ["arc-points"]);
    // A shop says what it is.
    for (points, sweep) in [("end", 90.0), ("along", 180.0)] {
        let intent = stated(points, &body).unwrap_or_else(|e| panic!("{points}: {e:?}"));
        assert_eq!((arcs(&intent).0[1].round(), warnings(&intent).len()), (sweep, 0), "{points}");
    }
    assert_eq!(stated("some", &body).expect_err("some").0[0].id, "word-unknown");
}

#[test]
fn other_systems_end_a_circle_at_its_first_point() {
    let body = format!("{CIRCLE}GOTO/37.071,2.929,0\nGOTO/40,10,0");
    assert_eq!(one("solidworks", &body), (45.0, 1, vec![]));
    assert_eq!(one("nx", &body), (-315.0, 1, vec![]));
    // A sweep that is stated leaves no question.
    let movarc = "MOVARC/30,10,0,0,0,1,10,ANGLE,45\nGOTO/37.071068,2.928932,0\nGOTO/40,10,0";
    for system in ["creo", "fusion", "iso"] {
        assert_eq!(one(system, movarc), (45.0, 1, vec![]), "{system}");
    }
    // Of a system that was not recognised nobody knows.
    assert_eq!(errors("iso", &body), ["arc-points"]);
    assert_eq!(one("iso", &format!("{CIRCLE}GOTO/40,10,0\nGOTO/40,20,0")), (90.0, 1, vec![]));
}

/// The arc is one block, and proved.
#[test]
fn an_arc_with_points_is_one_block() {
    let body = format!("{CIRCLE}GOTO/37.071,2.929,0\nGOTO/40,10,0\nGOTO/40,60,0");
    for (name, block) in [
        ("mazak", "G17 G3 X40. Y10. I0. J10."),
        ("sinumerik", "G3 X40 Y10 I0 J10"),
        ("heidenhain", "C X+40 Y+10 DR+"),
    ] {
        let machine = crate::support::five(name);
        let creo = front::find("creo").expect("creo");
        let output = compile(&shop("along", &body), creo, &machine, &Options::default())
            .unwrap_or_else(|f| panic!("{name}: {f:?}"));
        assert!(output.text.contains(block), "{}", output.text);
        assert!(output.report.expect("a proof").deviation.mm <= 1e-3);
    }
}

/// What may stand between a circle and its end, and what is an error at once: never another path.
#[test]
fn what_stands_between_a_circle_and_its_end() {
    let arc = format!("{CIRCLE}^\nGOTO/40,10,0\nGOTO/40,60,0");
    let tangent =
        "INDIRV/1,0,0\n^\nTLON,GOFWD/(CIRCLE/30,10,0,10),ON,(LINE/30,10,0,40,10,0)\nGOTO/40,60,0".to_owned();
    for (statement, id) in [
        ("FEDRAT/200,MMPM", None),
        ("SPINDL/900,CLW", None),
        ("COOLNT/ON", None),
        ("STOP", None),
        ("OPSTOP", None),
        ("DELAY/1", None),
        ("TLAXIS/0,0,1", None),
        ("MULTAX/ON", None),
        ("MULTAX/OFF", None),
        ("PPRINT TEXT", None),
        ("$$ TEXT", None),
        ("CUTCOM/OFF", None),
        ("RAPID", Some("rapid-arc")),
        ("LOADTL/2", Some("-")),
        ("CYCLE/OFF", Some("-")),
        ("CYCLE/DRILL,DEPTH,3,MMPM,50,CLEAR,1", Some("-")),
        ("GODLTA/0,0,-1", Some("-")),
        ("GOHOME/0,0,50", Some("-")),
        ("FROM/0,0,50", Some("-")),
        ("UNITS/INCHES", Some("-")),
        ("MSYS/0,0,20,1,0,0,0,-1,0", Some("-")),
        ("$$-> CSYS / 1.0, 0.0, 0.0, 0.0", Some("-")),
        ("CIRCLE/30,10,0,0,0,1,10", Some("-")),
        ("MOVARC/30,10,0,0,0,1,10,ANGLE,90", Some("-")),
        ("FINI", Some("-")),
    ] {
        for (body, missing) in [(&arc, "arc-end-missing"), (&tangent, "tangent-alone")] {
            let body = body.replace('^', statement);
            match id {
                None => {
                    let intent = read("creo", &body).unwrap_or_else(|e| panic!("{body}: {e:?}"));
                    let (sweeps, lines) = arcs(&intent);
                    assert!((sweeps[0] - 90.0).abs() < 1e-6 && lines == 1, "{body}: {sweeps:?}");
                }
                // GODLTA is the point of what it broke off, so that the TLON behind it is told too; a frame must
                // not begin with a cut, and nothing moves behind FINI.
                Some("-")
                    if ["GODLTA", "MSYS", "$$->", "FINI"].iter().any(|word| statement.starts_with(word)) =>
                {
                    assert_eq!(errors("creo", &body).first(), Some(&missing), "{body}");
                }
                Some("-") => assert_eq!(errors("creo", &body), [missing], "{body}"),
                Some(id) => assert_eq!(errors("creo", &body), [id], "{body}"),
            }
        }
    }
    let lost = format!("{CIRCLE}INDIRV/1,0,0\nTLON,GOFWD/(CIRCLE/30,10,0,10),ON,(LINE/30,10,0,40,10,0)");
    assert_eq!(errors("creo", &lost), ["arc-end-missing"]);
    assert_eq!(errors("creo", &format!("{CIRCLE}TLON,GOFWD/(CIRCLE/30,10,0,10),ON")), ["arc-end-missing"]);
    assert_eq!(
        errors("nx", &format!("{CIRCLE}NURBS/\nKNOT/1.0\nCNTRL/1,0,0")).first(),
        Some(&"arc-end-missing")
    );
    // The last tangent is that of the arc.
    let twice = tangent.replace('^', "INDIRV/-1,0,0");
    assert!((arcs(&read("catia", &twice).expect("an arc")).0[0] + 270.0).abs() < 1e-6);
}

#[test]
fn an_arc_within_a_cycle_is_an_error() {
    let cycle = "CYCLE/DRILL,DEPTH,3,MMPM,50,CLEAR,1\nGOTO/5,0,0\n";
    let tangent = "INDIRV/1,0,0\nTLON,GOFWD/(CIRCLE/30,10,0,10),ON,(LINE/30,10,0,40,10,0)\n";
    let movarc = "MOVARC/30,10,0,0,0,1,10,ANGLE,90\n";
    for arc in [CIRCLE, movarc, tangent] {
        for behind in ["GOTO/90,0,0\nCYCLE/OFF\nGOTO/9,9,9", "CYCLE/OFF\nGOTO/90,0,0\nGOTO/9,9,9"] {
            assert_eq!(errors("creo", &format!("{cycle}{arc}{behind}")), ["arc-in-cycle"], "{arc}");
        }
    }
}

/// One mistake, one report, whatever stands behind it.
#[test]
fn an_arc_that_is_refused_is_told_once() {
    let behind = "GOTO/40,10,0\nCIRCLE/40,20,0,0,0,1,10\nGOTO/50,20,0\nGOTO/0,0,0";
    for (statement, id) in [
        ("CIRCLE/30,10\n", "arc-numbers"),
        ("CIRCLE/30,10,0,0,0,0,10\n", "arc-plane"),
        ("CIRCLE/30,10,0,0,0,1,9\n", "arc-misfit"),
        ("CIRCLE/30,15,0,0,0,1,10\n", "arc-misfit"),
        ("RAPID\nCIRCLE/30,10,0,0,0,1,10\n", "rapid-arc"),
        ("MOVARC/30,10,0,0,0,1,10,ANGLE,0\n", "arc-numbers"),
        ("MOVARC/30,10,0,0,0,1,10,ANGLE,30\n", "arc-sweep"),
        ("INDIRV/0,0,0\nTLON,GOFWD/(CIRCLE/30,10,0,10),ON,(LINE/30,10,0,40,10,0)\n", "tangent"),
        ("CIRCLE/30,10,0,0,0,1,10\nTLAXIS/0,0.6,0.8\n", "arc-axis"),
    ] {
        assert_eq!(errors("creo", &format!("{statement}{behind}")), [id], "{statement}");
    }
    // A point that is refused is neither the end of an arc nor a rapid for what follows.
    let tilted = "GOTO/30,0,0,0,0.6,0.8\nLOADTL/2\nSPINDL/1000,CLW\nRAPID\nGOTO/30,0,0\nCIRCLE/30,10,0,0,0,1,10\nGOTO/40,10,0";
    assert_eq!(errors("creo", tilted), ["tool-axis-stale"]);
    let stale = "GOTO/30,0,0,0,0.6,0.8\nMULTAX/OFF\nCIRCLE/30,10,0,0,0,1,10\nGOTO/40,10,0";
    assert_eq!(errors("creo", stale), ["tool-axis-stale"]);
}

/// The sense of an arc is that of its tangent: a tangent that is none makes no arc.
#[test]
fn a_start_tangent_is_one() {
    let arc = |tangent: &str, line: &str| {
        format!(
            "INDIRV/{tangent}\nTLON,GOFWD/(CIRCLE/30,10,0,10),ON,{line}(LINE/30,10,0,40,10,0)\nGOTO/40,60,0"
        )
    };
    for (tangent, sweep) in [("1,0,0", 90.0), ("-1,0,0", -270.0), ("0.99995,0.01,0", 90.0)] {
        let (found, lines, warned) = one("catia", &arc(tangent, ""));
        assert_eq!((found, lines, warned), (sweep, 1, vec![]), "{tangent}");
    }
    // 2.9 degrees; 5.7, radial, square to the plane, nearly so, and no direction.
    assert_eq!(one("catia", &arc("0.99875,0.05,0", "")).2, ["tangent"]);
    for tangent in
        ["0.995,0.1,0", "0.995,0,0.1", "0,1,0", "0,0,1", "-0.01,1,0", "0.001,0,0", "0,0,0", "3,0,0"]
    {
        assert_eq!(errors("catia", &arc(tangent, "")), ["tangent"], "{tangent}");
    }
    // A helix, whose tangent may rise with it: 4 mm in a quarter of R = 10 mm are 14.3 degrees.
    let helix = |tangent: &str| {
        format!(
            "INDIRV/{tangent}\nTLON,GOFWD/(CYLNDR/30,10,0,0,0,1,10),ON,(PLANE/PERPTO,(PLANE/(POINT/30,10,0),PERPTO,\
             (VECTOR/0,0,1)),(POINT/30,10,0),(POINT/40,10,4))\nGOTO/40,60,0"
        )
    };
    for tangent in ["1,0,0", "0.969,0,0.247"] {
        assert_eq!(one("catia", &helix(tangent)), (90.0, 1, vec![]), "{tangent}");
    }
    assert_eq!(errors("catia", &helix("0.969,0,-0.247")), ["tangent"]);
    // Which place of the line is met: the first is at most half a turn away.
    assert_eq!(one("catia", &arc("1,0,0", "INTOF,")).0, 90.0);
    assert_eq!(one("catia", &arc("1,0,0", "1,INTOF,")).0, 90.0);
    assert_eq!(one("catia", &arc("-1,0,0", "2,INTOF,")).0, -270.0);
    for other in ["2,INTOF,", "3,INTOF,", "2,"] {
        assert_eq!(errors("catia", &arc("1,0,0", other)), ["tlon"], "{other}");
    }
    let round = "INDIRV/1,0,0\nTLON,GOFWD/(CIRCLE/30,10,0,10),ON,2,INTOF,(LINE/30,10,0,30,0,0)\nGOTO/9,9,9";
    assert_eq!(one("catia", round), (360.0, 1, vec![]));
    assert_eq!(one("catia", &round.replace("2,INTOF,", "")), (360.0, 1, vec!["tlon"]));
    // Other words are other paths.
    for (from, to) in [
        ("GOFWD", "GOBACK"),
        ("GOFWD", "GOLFT"),
        ("GOFWD", "GORGT"),
        (",ON", ",PAST"),
        (",ON", ",TO"),
        (",ON", ",TANTO"),
        (",ON", ""),
        ("GOFWD/", ""),
    ] {
        assert_eq!(errors("catia", &arc("1,0,0", "").replace(from, to)), ["tlon"], "{to} for {from}");
    }
}

#[test]
fn what_is_refused_points_to_its_place() {
    let sources = Sources::new(Source::new(
        "input.ncl",
        format!("{HEAD}{CIRCLE}GOTO/37.071,2.929,0\nGOTO/40,10,0\nFINI\n"),
    ));
    let errors = (front::find("creo").expect("creo").parse)(&sources).expect_err("points");
    let drawn = errors.render(&sources, false);
    assert!(drawn.contains("input.ncl:8:1") && drawn.contains("circle_points"), "{drawn}");
}
