//! 3+2 axes: the text of each dialect is counted back by the words of its control, with rotations of its own.

use super::{cases, input, machine, program, verified};
use splinepost::Output;
use splinepost::geom::elementary::{cos, sin};
use splinepost::machine::Machine;
use splinepost::source::SourceId;
use std::fs;

const DIALECTS: [&str; 3] = ["sinumerik", "heidenhain", "mazak"];

fn default(dialect: &str) -> Machine {
    crate::support::five(dialect)
}

fn case() -> String {
    let all = cases();
    let path = all.iter().find(|case| case.ends_with("nx-planes")).expect("the case");
    fs::read_to_string(input(path)).expect("an input")
}

fn compiled(text: &str, machine: &Machine) -> Output {
    program("nx", text, machine).unwrap_or_else(|errors| panic!("{}: {errors:?}", machine.name))
}

type Matrix = [[f64; 3]; 3];

/// A rotation about X, Y or Z by its textbook matrix.
fn about(axis: char, degrees: f64) -> Matrix {
    let (c, s) = (cos(degrees.to_radians()), sin(degrees.to_radians()));
    match axis {
        'X' => [[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]],
        'Y' => [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]],
        _ => [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]],
    }
}

fn times(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

fn number(text: &str) -> f64 {
    let digits: String =
        text.chars().take_while(|c| c.is_ascii_digit() || matches!(c, '.' | '-' | '+')).collect();
    digits.parse().expect(text)
}

/// The rotation that a line tilts its plane by, as the manual of its control says; none of another line.
fn tilted(block: &str) -> Option<Matrix> {
    let word = |name: &str| {
        let mut numbers = block.split(' ').filter_map(|word| word.strip_prefix(name));
        number(numbers.find(|rest| !rest.starts_with(char::is_alphabetic)).expect(name))
    };
    if let Some(arguments) = block.strip_prefix("CYCLE800(0,\"\",0,57,") {
        // Mode 57: about X, the new Y, the newest Z.
        let angles: Vec<f64> = arguments.split(',').skip(3).take(3).map(number).collect();
        return Some(times(&times(&about('X', angles[0]), &about('Y', angles[1])), &about('Z', angles[2])));
    }
    if block.starts_with("PLANE SPATIAL") {
        // About the axes that do not turn: first A, then B, then C.
        let first = times(&about('Y', word("SPB")), &about('X', word("SPA")));
        return Some(times(&about('Z', word("SPC")), &first));
    }
    if block.starts_with("G68.2 ") {
        // Euler's angles: about Z, the new X, the newest Z.
        return Some(times(&times(&about('Z', word("I")), &about('X', word("J"))), &about('Z', word("K"))));
    }
    None
}

/// A block without its number.
fn block(line: &str) -> &str {
    line.trim_start_matches('N').trim_start_matches(|c: char| c.is_ascii_digit()).trim()
}

/// Where the tool points in the planes of a text.
fn axes(text: &str) -> Vec<[f64; 3]> {
    text.lines().filter_map(|line| tilted(block(line))).map(|r| [r[0][2], r[1][2], r[2][2]]).collect()
}

/// Where the tip goes in the coordinates of the work, and where the tool points, straight from a text of lines.
fn places(text: &str) -> Vec<([f64; 3], [f64; 3])> {
    let mut plane = about('Z', 0.0);
    let mut at = [f64::NAN; 3];
    let mut places: Vec<([f64; 3], [f64; 3])> = Vec::new();
    for line in text.lines().filter(|line| !line.starts_with([';', '('])) {
        let block = block(line);
        if let Some(next) = tilted(block) {
            (plane, at) = (next, [f64::NAN; 3]);
            continue;
        }
        let beyond = ["SUPA", "M91", "G53", "G52", "CYCL", "G17 G40", "G17 G21", "BLK", ";"];
        if beyond.iter().any(|word| block.contains(word)) {
            continue;
        }
        let mut moved = false;
        for word in block.split(' ') {
            let axis = ["X", "Y", "Z"].iter().position(|name| {
                word.strip_prefix(name).is_some_and(|rest| {
                    rest.starts_with(['-', '+']) || rest.starts_with(|c: char| c.is_ascii_digit())
                })
            });
            if let Some(axis) = axis {
                at[axis] = number(&word[1..]);
                moved = true;
            }
        }
        if moved && at.iter().all(|x| x.is_finite()) {
            let out = |p: [f64; 3]| std::array::from_fn(|i| (0..3).map(|j| plane[i][j] * p[j]).sum());
            places.push((out(at), out([0.0, 0.0, 1.0])));
        }
    }
    places
}

/// The places of GOTO with the direction that is in force.
fn asked(text: &str) -> Vec<([f64; 3], [f64; 3])> {
    let mut direction = [0.0, 0.0, 1.0];
    let goto = text.lines().filter_map(|line| line.strip_prefix("GOTO/"));
    goto.map(|line| {
        let numbers: Vec<f64> = line.split(',').map(|number| number.trim().parse().expect(line)).collect();
        if let [_, _, _, i, j, k] = numbers[..] {
            direction = [i, j, k];
        }
        ([numbers[0], numbers[1], numbers[2]], direction)
    })
    .collect()
}

fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum::<f64>().sqrt()
}

/// Every place of the input, in order, is a place of the program; between them stand the ways up along the tool.
fn goes_where_asked(input: &str, text: &str, dialect: &str) {
    let mut left = places(text).into_iter();
    for (tip, direction) in asked(input) {
        let length = distance(&direction, &[0.0; 3]);
        let unit = direction.map(|x| x / length);
        // Half a unit of the fourth decimal in each axis is 8.7e-5 mm; as much in the last decimal of an angle, 1.5e-6 in
        // each of three.
        let met = left.any(|(p, d)| distance(&p, &tip) < 9.0e-5 && distance(&d, &unit) < 5.0e-6);
        assert!(met, "{dialect}: {tip:?} {direction:?} is not met in\n{text}");
    }
}

#[test]
fn planes_are_those_of_the_controls() {
    let input = case();
    for dialect in DIALECTS {
        let own = default(dialect);
        let output = compiled(&input, &own);
        goes_where_asked(&input, &output.text, dialect);
        let report = output.report.expect("a proof");
        assert!(0.0 < report.deviation.rad && report.deviation.rad < 1.0e-6, "{dialect}");
        verified(&input, &output.text, &own).unwrap_or_else(|errors| panic!("{dialect}: {errors:?}"));
    }
}

/// Any order of turns leads to the same places: what differs is X and Y of the plane.
#[test]
fn every_order_of_turns_is_proved() {
    let input = case();
    for order in ["xyz", "xzy", "yxz", "yzx", "zxy", "zyx", "xyx", "xzx", "yxy", "yzy", "zxz", "zyz"] {
        let own = machine(&format!("extends = \"mazak\"\n[orientation]\nplane_order = \"{order}\"\n"));
        let output = compiled(&input, &own);
        let letters: Vec<char> = order.to_ascii_uppercase().chars().collect();
        let mut turned = Vec::new();
        for line in output.text.lines() {
            // Written as Euler's angles, read as this order.
            if let Some(words) = line.strip_prefix("G68.2 X0. Y0. Z0. I") {
                let angles: Vec<f64> =
                    words.split([' ', 'J', 'K']).filter(|w| !w.is_empty()).map(number).collect();
                let first = times(&about(letters[0], angles[0]), &about(letters[1], angles[1]));
                let r = times(&first, &about(letters[2], angles[2]));
                turned.push([r[0][2], r[1][2], r[2][2]]);
            }
        }
        let third = 1.0 / 3.0f64.sqrt();
        // At the end it stands upright again.
        let expected = [[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [third; 3], [0.0, 0.0, 1.0]];
        assert_eq!(turned.len(), expected.len(), "{order}");
        for (axis, expected) in turned.iter().zip(&expected) {
            assert!(distance(axis, expected) < 5.0e-6, "{order}: {axis:?}");
        }
        verified(&input, &output.text, &own).unwrap_or_else(|errors| panic!("{order}: {errors:?}"));
    }
}

/// Between two planes the tool is home in Z, and its length holds before it goes back to the work.
#[test]
fn the_tool_turns_where_it_is_clear() {
    for (dialect, home, tilt, length) in [
        ("sinumerik", "G0 SUPA Z0 D0", "CYCLE800(0", "D1"),
        ("heidenhain", "L Z+0 R0 FMAX M91", "PLANE SPATIAL", ""),
        ("mazak", "G0 G53 Z0.", "G68.2", "G43 H"),
    ] {
        let text = compiled(&case(), &machine(&format!("extends = \"{dialect}\""))).text;
        let lines: Vec<&str> = text.lines().collect();
        let tilts: Vec<usize> = (0..lines.len()).filter(|i| lines[*i].contains(tilt)).collect();
        assert_eq!(tilts.len(), 4, "{text}");
        for (i, at) in tilts.into_iter().enumerate() {
            let back = lines[..at].iter().rposition(|line| line.contains(home)).expect(home);
            let moves = lines[back + 1..at].iter().filter(|line| {
                let words: Vec<&str> = line.split(' ').collect();
                !line.starts_with(['(', ';'])
                    && words.iter().any(|word| word.starts_with(['X', 'Y', 'Z']) && *word != "Z")
            });
            assert_eq!(moves.count(), 0, "{text}");
            if i == 3 {
                // The last one only turns the tool upright.
                assert!(
                    !lines[at + 1..].iter().any(|line| line.contains(" X") || line.contains(" Z")),
                    "{text}"
                );
                continue;
            }
            let down = lines[at + 1..].iter().position(|line| line.contains('Z') && !line.contains("G68.2"));
            let down = at + 1 + down.expect("a way down");
            assert!(lines[back + 1..=down].iter().any(|line| line.contains(length)), "{text}");
            // X and Y come first, in a block of their own.
            assert!(
                lines[at + 1..down].iter().any(|line| line.contains(" X") && line.contains(" Y")),
                "{text}"
            );
        }
    }
}

/// A program without its block numbers, so that a line less is not told by them.
fn unnumbered(text: &str) -> String {
    let bare = |line: &str| {
        let number = line.trim_start_matches('N').trim_start_matches(|c: char| c.is_ascii_digit());
        if line.starts_with('N') { format!("N{number}\n") } else { format!("{number}\n") }
    };
    text.split_terminator('\n').map(bare).collect()
}

fn numbered(bare: &str, dialect: &str) -> String {
    let mut blocks = 0;
    let mut line = |line: &str| match (dialect, line.strip_prefix('N')) {
        ("sinumerik", Some(rest)) => {
            blocks += 10;
            format!("N{blocks}{rest}\n")
        }
        ("heidenhain", _) => {
            blocks += 1;
            format!("{}{line}\n", blocks - 1)
        }
        _ => format!("{line}\n"),
    };
    bare.split_terminator('\n').map(&mut line).collect()
}

#[test]
fn damage_to_a_plane_is_refused() {
    for (dialect, damages) in [
        (
            "sinumerik",
            vec![
                ("0,0,0,90,0,0,0,0,0,-1", "0,0,0,-90,0,0,0,0,0,-1"),
                ("0,0,0,90,0,0,0,0,0,-1", "0,0,0,90.000001,0,0,0,0,0,-1"),
                ("0,0,0,90,0,0,0,0,0,-1", "0,0,0,0,90,0,0,0,0,-1"),
                (",0,57,0,0,0,90", ",0,27,0,0,0,90"),
                ("N D1\nN CYCLE800(0,\"\",0,57,0,0,0,90", "N CYCLE800(0,\"\",0,57,0,0,0,90"),
                ("N CYCLE800()\n", ""),
                ("N G0 SUPA Z0 D0\nN CYCLE800()", "N CYCLE800()"),
            ],
        ),
        (
            "heidenhain",
            vec![
                ("SPA+90", "SPA-90"),
                ("SPA+90 SPB+0", "SPA+0 SPB+90"),
                ("SPC+135", "SPC+134.9999"),
                ("TURN FMAX", "STAY"),
                ("M91\n PLANE RESET STAY\n", "M91\n"),
                (" L Z+0 R0 FMAX M91\n PLANE RESET", " PLANE RESET"),
            ],
        ),
        (
            "mazak",
            vec![
                ("I0. J90. K0.", "I0. J-90. K0."),
                ("I0. J90. K0.", "I0. J90. K1."),
                ("I135.", "I-45."),
                ("J90. K0.\nG53.1\n", "J90. K0.\n"),
                ("G69\nG68.2 X0. Y0. Z0. I0. J90.", "G68.2 X0. Y0. Z0. I0. J90."),
                ("G43 H1 Z80.", "Z80."),
                ("X0. Y0. Z0. I135.", "X1. Y0. Z0. I135."),
            ],
        ),
    ] {
        let (input, own) = (case(), default(dialect));
        let text = compiled(&input, &own).text;
        assert_eq!(numbered(&unnumbered(&text), dialect), text);
        for (from, to) in damages {
            let bare = unnumbered(&text);
            assert!(bare.contains(from), "{dialect}: {from} stands nowhere in\n{bare}");
            let damaged = numbered(&bare.replacen(from, to, 1), dialect);
            assert!(verified(&input, &damaged, &own).is_err(), "{dialect}: {from:?} as {to:?} passes");
        }
    }
}

#[test]
fn where_the_tool_turns_at_feed_its_tip_is_led() {
    // Their arcs are square to another direction.
    let lines: String = case().split_inclusive('\n').filter(|line| !line.starts_with("CIRCLE")).collect();
    let slanted = lines.replace("0.0000000,-1.0000000,0.0000000", "0.0000000,-0.6000000,0.8000000");
    let last = "GOTO/40.0000,-48.0000,-30.0000";
    let input = slanted.replace(&format!("{last}\n"), &format!("{last},0.0000000,-0.8000000,0.6000000\n"));
    assert!(slanted != lines && input != slanted);
    for (dialect, led, plane) in [
        ("sinumerik", "TRAORI", "CYCLE800(0"),
        ("heidenhain", "M128", "PLANE SPATIAL"),
        ("mazak", "G43.5", "G68.2"),
    ] {
        let text = compiled(&input, &default(dialect)).text;
        assert!(text.contains(led) && !text.contains(plane), "{text}");
        // So it is where a machine has no planes.
        let without = machine(&format!(
            "extends = \"{dialect}\"\n{}[program]\nplane = []\n",
            if dialect == "mazak" { crate::support::PARK } else { "" }
        ));
        let text = compiled(&slanted, &without).text;
        assert!(text.contains(led) && !text.contains(plane), "{text}");
    }
}

#[test]
fn holes_are_drilled_square_to_their_plane() {
    let input = "PARTNO DRILL\nMULTAX/ON\nLOADTL/5\nSPINDL/RPM,2000,CLW\nRAPID\nGOTO/0,-60,20,0,-0.6,0.8\n\
        CYCLE/DRILL,DEPTH,10,MMPM,120,CLEAR,3\nGOTO/0,-30,0,0,-0.6,0.8\nGOTO/10,-30,0\nCYCLE/OFF\n\
        RAPID\nGOTO/20,-60,40\nFINI\n";
    let text = program("iso", input, &default("sinumerik")).expect("a program").text;
    let blocks = unnumbered(&text);
    // In the plane Y is 0.8 y + 0.6 z and Z is 0.8 z - 0.6 y: the holes lie at Y -24, Z 18. Behind the remark every axis is
    // named, and nothing is written where nothing moves.
    let holes = "AS MOVES\nN G0 X0 Y-24 Z52\nN Z21\nN G1 Z8 F120\nN G0 Z21\nN X10\nN G1 Z8\nN G0 Z21\n";
    assert!(blocks.contains(holes), "{text}");
}

#[test]
fn a_plane_needs_a_home_and_a_tool() {
    let refused = |input: &str, machine: &Machine| {
        program("nx", input, machine).map_or_else(|errors| errors.0[0].id, |output| panic!("{}", output.text))
    };
    let homeless = machine("extends = \"heidenhain\"\n[program]\nhome = []\n");
    assert_eq!(refused(&case(), &homeless), "home-missing");
    let toolless: String = case().split_inclusive('\n').filter(|line| !line.starts_with("LOAD")).collect();
    assert_eq!(refused(&toolless, &default("heidenhain")), "tool-missing");
    let coarse = machine("extends = \"heidenhain\"\n[digits]\nrotary = 0\n[orientation]\ntolerance = 0.01\n");
    assert_eq!(refused(&case(), &coarse), "direction-too-far");
}

#[test]
fn lines_of_a_plane_say_its_angles_and_the_length() {
    let told = |lines: &str| {
        let text = format!("extends = \"sinumerik\"\n{lines}");
        Machine::parse(&text, SourceId::INPUT).map_or_else(|e| e.0[0].id, |_| "")
    };
    assert_eq!(told("[program]\nplane = [\"D1\", \"ROT X{first} Y{second} Z{third}\"]\n"), "");
    assert_eq!(told("[program]\nplane = [\"ROT X{first} Y{second} Z{third}\"]\n"), "plane-length");
    assert_eq!(told("[program]\nplane = [\"D1\", \"ROT X{first} Y{second}\"]\n"), "plane-angles");
    assert_eq!(
        told("[program]\nplane = [\"D1\", \"ROT X{first}\", \"AROT Y{second} Z{third}\"]\n"),
        "plane-angles"
    );
    assert_eq!(told("[orientation]\nplane_order = \"xxz\"\n"), "plane-order");
    assert_eq!(told("[orientation]\nplane_order = \"abc\"\n"), "plane-order");
}

/// Where the head tilts, X and Y of a tilted plane alone would take the machine's Z down.
#[test]
fn a_head_that_tilts_comes_with_all_axes_at_once() {
    for (dialect, tilt) in [("sinumerik", "CYCLE800(0"), ("heidenhain", "PLANE SPATIAL"), ("mazak", "G53.1")]
    {
        let head =
            machine(&format!("extends = \"{dialect}\"\n[orientation]\nplane_approach = \"together\"\n"));
        let output = compiled(&case(), &head);
        goes_where_asked(&case(), &output.text, dialect);
        let lines: Vec<&str> = output.text.lines().collect();
        let mut ways = Vec::new();
        for at in (0..lines.len()).filter(|i| lines[*i].contains(tilt)) {
            let first = lines[at + 1..].iter().find(|line| line.contains(" X") && line.contains(" Y"));
            ways.extend(first.map(|line| line.contains(" Z")));
        }
        // The first plane stands upright, and there the tool goes over the work first; so does the last, where it ends.
        assert_eq!(ways, [false, true, true], "{}", output.text);
        assert!(output.text.contains("TOGETHER"), "{}", output.text);
        let over = compiled(&case(), &default(dialect)).text;
        assert!(over.contains("APPROACHED X Y FIRST") && over != output.text);
        // From below, home in Z leads through the work.
        let below = case().replace("0.0000000,-1.0000000,0.0000000", "0.0000000,-0.8000000,-0.6000000");
        let below: String = below.split_inclusive('\n').filter(|line| !line.starts_with("CIRCLE")).collect();
        let errors = program("nx", &below, &head).map(|output| output.text).expect_err("from below");
        assert_eq!(errors.0[0].id, "plane-from-below");
        assert!(program("nx", &below, &default(dialect)).is_ok());
    }
}

/// A file of six decimals with a unit of noise in each component.
#[test]
fn a_unit_of_the_last_decimal_turns_no_tool() {
    let input = "PARTNO NOISE\nMULTAX/ON\nLOADTL/5\nSPINDL/RPM,2000,CLW\nFEDRAT/300,MMPM\nRAPID\n\
        GOTO/0,-60,20,0,-0.6,0.8\nGOTO/0,-30,0,0.000001,-0.6,0.799999\nGOTO/10,-30,0,-0.000001,-0.600001,0.8\nRAPID\n\
        GOTO/10,-60,40,0,-0.6,0.8\nRAPID\nGOTO/10,-60,90,0.000001,0.000001,1\nGOTO/20,0,0,0.000010,0,1\nRAPID\n\
        GOTO/20,0,50\nFINI\n";
    // The second cut against the first rapid's direction: 1e-6 across, and about as much along; the last against Z: 1e-5.
    for dialect in DIALECTS {
        let own = default(dialect);
        let output = compiled(input, &own);
        // Of the number of a Mazak nobody spoke.
        assert!(output.warnings.0.iter().all(|d| d.id == "number-unchosen"), "{:?}", output.warnings);
        let planes = axes(&output.text);
        assert_eq!(planes.len(), 2, "{}", output.text);
        assert!(
            distance(&planes[0], &[0.0, -0.6, 0.8]) < 5.0e-6 && planes[1] == [0.0, 0.0, 1.0],
            "{planes:?}"
        );
        // The greatest is that of the last cut, and it is stated.
        let rad = output.report.expect("a proof").deviation.rad;
        assert!((rad - 1.0e-5).abs() < 1.0e-10, "{dialect}: {rad}");
        verified(input, &output.text, &own).unwrap_or_else(|errors| panic!("{dialect}: {errors:?}"));
        // With a tolerance that they exceed the tool turns while it cuts, and a note says where.
        let park = if dialect == "mazak" { crate::support::PARK } else { "" };
        let strict = machine(&format!("extends = \"{dialect}\"\n{park}[orientation]\ntolerance = 0.001\n"));
        let mut output = compiled(input, &strict);
        output.warnings.0.retain(|d| d.id != "number-unchosen");
        assert!(axes(&output.text).is_empty(), "{}", output.text);
        let notes: Vec<&str> = output.warnings.0.iter().map(|d| d.id).collect();
        assert_eq!(notes, ["tip-led"]);
        let at = output.warnings.0[0].span.expect("a place");
        let place = &input[at.start as usize..at.end as usize];
        assert!(place.contains("GOTO/20,0,0,"), "{place}");
    }
}

#[test]
fn a_tool_that_is_upright_but_for_noise_needs_three_axes() {
    let input = "TOOL PATH/UPRIGHT,TOOL,A\nMULTAX/ON\nLOADTL/5\nSPINDL/RPM,2000,CLW\nFEDRAT/300,MMPM\nRAPID\n\
        GOTO/0,0,20,0.000002,0,1\nGOTO/0,0,0,0,0,1\nCIRCLE/5,0,0,0,0,1,5\nGOTO/10,0,0,0.000001,0.000001,1\nRAPID\nGOTO/10,0,20\nFINI\n";
    for dialect in DIALECTS {
        let own = default(dialect);
        let output = compiled(input, &own);
        assert_eq!(output.intent.program.axes.count(), 3);
        assert!(axes(&output.text).is_empty(), "{}", output.text);
        let rad = output.report.expect("a proof").deviation.rad;
        assert!((rad - 2.0e-6).abs() < 1.0e-10, "{dialect}: {rad}");
        verified(input, &output.text, &own).unwrap_or_else(|errors| panic!("{dialect}: {errors:?}"));
    }
}

/// Between a cut and the remark behind it nothing moves that the input does not have: a tool that is down goes nowhere at rapid.
#[test]
fn nothing_moves_before_a_remark_that_was_not_asked() {
    let input = "UNITS/MM\nLOADTL/1\nSPINDL/3000,RPM,CLW\nRAPID\nGOTO/0,0,50\nFEDRAT/200,MMPM\nGOTO/0,0,-5\n\
        GOTO/20,0,-5\nPPRINT/SECOND\nRAPID\nGOTO/20,0,50\nRAPID\nGOTO/80,30,50\nRAPID\nGOTO/80,30,2\nGOTO/80,30,-5\nFINI\n";
    let tilted = input.replace("GOTO/0,0,50\n", "GOTO/0,0,50,0,-0.6,0.8\n");
    for (dialect, cut) in [("sinumerik", "X20"), ("heidenhain", " L X+20"), ("mazak", "X20.")] {
        for input in [input, tilted.as_str()] {
            let text = program("iso", input, &default(dialect)).expect("a program").text;
            let bare = unnumbered(&text);
            let lines: Vec<&str> = bare.lines().map(|line| line.trim_start_matches("N ")).collect();
            let remark = lines.iter().position(|line| line.contains("SECOND")).expect("the remark");
            assert_eq!(lines[remark - 1].split(" F").next(), Some(cut), "{text}");
        }
    }
}
