//! What no input asks for, the retraction and the way between paths, is clear of all that is cut.

use super::{compiled, proved};
use crate::support::machine;
use splinepost::dialect::DIALECTS;
use splinepost::{Options, Output};

/// Along it Z runs from 0 to 30 tan 5° sin 8° = 0.3653, and Y to 30 tan 5° = 2.6247.
const CUTTER: &str = "name = \"CONE\"\nnumber = 12\n[cutter]\nD1 = 10\nS = 30\nC = 5\nr = 8\nlength = 30\nflutes = 2\n[process]\nfeed = 200\n";

/// A square, and a line beside it, at Z-2: X 0 to 10 and 20 to 30.
const JOB: &str = "[[curve]]\nkind = \"points\"\naxes = [\"X\", \"Y\"]\nat = { Z = -2 }\n\
    points = [[10, 0], [10, 10], [0, 10], [0, 0], [10, 0]]\n\
    [[curve]]\nkind = \"points\"\naxes = [\"X\", \"Y\"]\npoints = [[30, 0], [20, 5], [30, 10]]\n";

fn job(axis: &str, to: f64) -> String {
    format!(
        "name = \"JOB\"\nnumber = 5\n[process]\nfeed = 500\nretract = {{ axis = \"{axis}\", to = {to} }}\n{JOB}"
    )
}

fn cutter(axis: &str, to: f64, more: &str) -> String {
    format!("{CUTTER}retract = {{ axis = \"{axis}\", to = {to} }}\n{more}\n")
}

/// The program on a Sinumerik, or the one error, with its hint.
fn made(text: &str) -> Result<Output, (&'static str, String)> {
    compiled(text, &machine("extends = \"sinumerik\"\n"), &Options::default()).map_err(|found| {
        let ids: Vec<&str> = found.0.iter().map(|d| d.id).collect();
        assert_eq!(ids.len(), 1, "{found:?}");
        (found.0[0].id, format!("{} {:?}", found.0[0].message, found.0[0]))
    })
}

fn refused(text: &str, id: &str, says: &str) {
    let (found, message) = made(text).err().unwrap_or_else(|| panic!("made: {text}"));
    assert_eq!(found, id, "{text}");
    assert!(message.contains(says), "{message}");
}

/// Each place in Z that the text names at rapid behind the offset.
fn rapids(output: &Output) -> Vec<f64> {
    let z = |line: &str| line.split_whitespace().find_map(|word| word.strip_prefix('Z')?.parse().ok());
    output.text.lines().filter(|line| line.contains("G0 Z")).filter_map(z).collect()
}

#[test]
fn a_retraction_is_above_what_is_cut() {
    // At the depth, under it, within rounding of it, and between two depths.
    refused(&job("Z", -2.0), "retract-not-clear", "Z -2 to -2");
    refused(&job("Z", -10.0), "retract-through-work", "well above Z -2");
    refused(&job("Z", -1.999), "retract-not-clear", "well above Z -2");
    let two = job("Z", -1.0).replace(
        "axes = [\"X\", \"Y\"]\npoints = [[30",
        "axes = [\"X\", \"Y\"]\nat = { Z = 3 }\npoints = [[30",
    );
    refused(&two, "retract-not-clear", "Z -2 to 3");
    assert_eq!(rapids(&made(&job("Z", 1.0)).unwrap()), [1.0; 4]);
    refused(&cutter("Z", 0.2, ""), "retract-not-clear", "Z 0 to 0.3653");
    refused(&cutter("Z", 0.3653, ""), "retract-not-clear", "well above Z 0.3653");
    refused(&cutter("Z", -50.0, ""), "retract-through-work", "sign = -1");
    refused(&cutter("Y", -30.0, ""), "retract-through-work", "well above Y 2.6247");
    assert!(made(&cutter("Y", 30.0, "")).is_ok());
    // The stock is below, and so is the tool; the first pass is 0.2 below the path.
    let below = "infeed = { axis = \"Z\", sign = -1, step = 0.2, passes = 1 }";
    refused(&cutter("Z", 50.0, below), "retract-through-work", "well below Z -0.2");
    assert!(made(&cutter("Z", -50.0, below)).is_ok());
    // An infeed along another axis says nothing of Z.
    let beside = "infeed = { axis = \"Y\", sign = -1, step = 0.2, passes = 1 }";
    refused(&cutter("Z", -50.0, beside), "retract-through-work", "well above Z 0.3653");
}

/// With R1 at its value and at zero the retraction is never below the one that was asked for, and above the path.
#[test]
fn a_correction_leaves_the_retraction_clear() {
    for (to, value, written) in [(50.0, 60.0, 50.0), (1.0, 5.0, 1.0), (50.0, 0.0, 50.0), (50.0, -60.0, 110.0)]
    {
        let text = cutter("Z", to, &format!("correction = {{ axis = \"Z\", value = {value} }}"));
        for dialect in DIALECTS {
            let machine = machine(&format!("extends = \"{}\"\n", dialect.name));
            let output = compiled(&text, &machine, &Options::default()).unwrap_or_else(|e| panic!("{e:?}"));
            assert!(proved(&output, &output.text).is_ok(), "{}", output.text);
        }
        let output = made(&text).unwrap();
        assert_eq!(rapids(&output), [written; 4], "{}", output.text);
        // The path as the text counts it is that without a correction, 0 to 0.3653.
        assert!(output.text.contains("G1 Z0 F200"), "{}", output.text);
    }
    // What was asked for is not clear of the path where R1 is zero.
    refused(
        &cutter("Z", -10.0, "correction = { axis = \"Z\", value = -60 }"),
        "retract-through-work",
        "0.3653",
    );
    // Along Y the parameter shifts nothing of a retraction in Z.
    let output = made(&cutter("Z", 50.0, "correction = { axis = \"Y\", value = 60 }")).unwrap();
    assert_eq!(rapids(&output), [50.0; 4]);
}

#[test]
fn no_way_to_a_path_runs_along_it() {
    for travel in ["from-D1", "to-D1"] {
        for to in [50.0, -50.0] {
            let more = format!("travel = \"{travel}\"\nreturn_feed = 1000");
            refused(&cutter("X", to, &more), "retract-axis", "Y or Z");
        }
    }
    // Both begin and end at their greatest X, and the first lies behind the second.
    refused(&job("X", 50.0), "retract-through-work", "X 10");
    // To lesser X the way crosses the square; to greater Y the first path too.
    refused(&job("X", -50.0), "retract-through-work", "X 0");
    refused(&job("Y", 50.0), "retract-through-work", "Y 10");
    refused(&job("X", 5.0), "retract-not-clear", "X 0 to 30");
    // Alone, the second path is reached from its side, and from no other.
    let alone = |to: f64| {
        let (process, curves) = (job("X", to), JOB.rfind("[[curve]]").unwrap());
        let at = "axes = [\"X\", \"Y\"]\nat = { Z = -2 }\npoints = [[30";
        process.replace(JOB, &JOB[curves..].replace("axes = [\"X\", \"Y\"]\npoints = [[30", at))
    };
    assert!(made(&alone(50.0)).is_ok());
    refused(&alone(-50.0), "retract-through-work", "X 30");
}

/// A retract axis that no curve names stays where it is clear, with a warning; a stated depth is none that rests.
#[test]
fn what_rests_in_clear_air_is_warned_of() {
    let output = made(&job("Z", 50.0).replace("at = { Z = -2 }\n", "")).unwrap();
    assert!(output.warnings.0.iter().any(|d| d.id == "retract-axis-rests"));
    refused(&job("Z", 50.0).replace("Z = -2", "Z = 50"), "retract-not-clear", "Z 50 to 50");
}
