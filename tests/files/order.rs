//! Curves of a file end to end.

use super::PROCESS;
use super::writers::{drawing, entity};
use crate::support::sources_with;
use splinepost::front;
use splinepost::ir::{Curve, Cut, Intent, Role, Step};

fn intent(entities: &[&str], keys: &str) -> Intent {
    let text = drawing(&entities.iter().map(|text| entity(text)).collect::<String>());
    let job = format!("{PROCESS}[[curve]]\nfile = \"c.dxf\"\nat = {{ Z = -1 }}\n{keys}");
    let language = front::find("job").expect("jobs");
    (language.parse)(&sources_with(&job, &[("c.dxf", &text)])).unwrap_or_else(|e| panic!("{e:?}"))
}

/// The places of each path, X and Y; an arc has its ends.
fn paths(intent: &Intent) -> Vec<Vec<[f64; 2]>> {
    let cuts = intent.program.steps.iter().filter_map(|located| match &located.step {
        Step::Comment(_) => Some(None),
        Step::Cut(Cut { role: Role::Path, curve, .. }) => Some(Some(curve)),
        Step::Cut(_)
        | Step::Tool(_)
        | Step::Spindle(_)
        | Step::Coolant
        | Step::Home(_)
        | Step::Shift(_)
        | Step::Auxiliary(_)
        | Step::Rapid(_) => None,
    });
    let mut all: Vec<Vec<[f64; 2]>> = Vec::new();
    for cut in cuts {
        let Some(curve) = cut else {
            all.push(Vec::new());
            continue;
        };
        let places: Vec<[f64; 2]> = match curve {
            Curve::Lines(line) => {
                std::iter::once(line.start).chain(line.points()).map(|p| [p[0], p[1]]).collect()
            }
            Curve::Arc(arc) => [arc.start(), arc.end()].map(|p| [p[0], p[1]]).to_vec(),
            Curve::Polynomial(_)
            | Curve::Nurbs(_)
            | Curve::Through(..)
            | Curve::Logarithmic(_)
            | Curve::Formula(_) => panic!("{curve:?}"),
        };
        all.last_mut().expect("a section").extend(places);
    }
    all
}

fn ids(intent: &Intent) -> Vec<&'static str> {
    intent.warnings.0.iter().map(|d| d.id).collect()
}

/// A square of sides a, b, c, d from (0, 0): some of them drawn the other way.
const A: &str = "LINE 10=0 20=0 11=10 21=0";
const B: &str = "LINE 10=10 20=0 11=10 21=10";
const C_BACK: &str = "LINE 10=0 20=10 11=10 21=10";
const D: &str = "LINE 10=0 20=10 11=0 21=0";

const SQUARE: [[f64; 2]; 5] = [[0., 0.], [10., 0.], [10., 10.], [0., 10.], [0., 0.]];

#[test]
fn lines_in_a_row_are_one_path_whichever_way_they_were_drawn() {
    let square = intent(&[A, B, C_BACK, D], "");
    assert_eq!(paths(&square), [SQUARE.to_vec()]);
    assert_eq!(ids(&square), ["curves-backwards"]);
    // The first is turned where the second tells how.
    let turned = intent(&["LINE 10=10 20=0 11=0 21=0", B], "");
    assert_eq!(paths(&turned), [SQUARE[..3].to_vec()]);
}

#[test]
fn order_chain_puts_them_end_to_end() {
    let mixed = [A, C_BACK, D, B];
    let as_drawn = intent(&mixed, "");
    assert_eq!(paths(&as_drawn).len(), 3);
    assert_eq!(ids(&as_drawn), ["curves-apart", "curves-backwards"]);
    let told = &as_drawn.warnings.0[0];
    assert_eq!(told.label, "starts 10.000000 mm from where the one before ends");
    assert!(told.hints[0].contains("order = \"chain\"") && told.hints[0].contains("one path"), "{told:?}");
    let chained = intent(&mixed, "order = \"chain\"\n");
    assert_eq!(paths(&chained), [SQUARE.to_vec()]);
    // An open row is followed both ways from its first curve.
    let open = intent(&[B, A, C_BACK], "order = \"chain\"\n");
    assert_eq!(paths(&open), [SQUARE[..4].to_vec()]);
}

#[test]
fn gaps_are_closed_where_that_is_asked_for() {
    let gap = ["LINE 10=0 20=0 11=10 21=0", "LINE 10=10.004 20=0 11=10.004 21=10"];
    let open = intent(&gap, "");
    assert_eq!((paths(&open).len(), ids(&open)), (2, vec!["curves-apart"]));
    assert!(open.warnings.0[0].hints[0].contains("join = 0.005"), "{:?}", open.warnings);
    for keys in ["join = 0.005\n", "join = 0.005\norder = \"chain\"\n"] {
        let closed = intent(&gap, keys);
        assert_eq!(
            paths(&closed),
            [vec![[0., 0.], [10., 0.], [10., 0.], [10.004, 0.], [10.004, 0.], [10.004, 10.]]]
        );
        assert_eq!(ids(&closed), ["gaps-joined"]);
    }
    // What six decimals lose is no gap.
    let near = intent(&["LINE 10=0 20=0 11=10.000001 21=0", "LINE 10=10 20=0 11=10 21=10"], "");
    assert_eq!(paths(&near), [vec![[0., 0.], [10.000_001, 0.], [10., 10.]]]);
}

#[test]
fn a_branch_is_told_of() {
    let branch = intent(&[A, "LINE 10=10 20=0 11=20 21=0", B], "order = \"chain\"\n");
    assert_eq!(ids(&branch), ["curves-branch"]);
    assert_eq!(paths(&branch)[0], [[0., 0.], [10., 0.], [20., 0.]]);
    // Separate circles are no matter.
    let circles = intent(&["CIRCLE 10=0 20=0 40=1", "CIRCLE 10=9 20=0 40=1"], "");
    assert_eq!((paths(&circles).len(), ids(&circles)), (2, vec![]));
}
