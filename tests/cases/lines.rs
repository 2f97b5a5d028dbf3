//! The lines of machine files round a program: what may move an axis, however it is spelled, and which axes they name.

use crate::support::{PARK, compiled, five, folder, machine, sources};
use splinepost::machine::Machine;
use splinepost::source::{Source, SourceId, Sources};
use splinepost::{Options, compile, front, verify_program};
use std::fs;

fn fixture(path: &str) -> String {
    fs::read_to_string(folder("fixtures").join(path)).expect("a fixture")
}

/// A cutter of four flutes that turns A.
fn cutter() -> String {
    fixture("compile/conical-mill/input.toml")
}

/// A circle in X and Y.
fn circle() -> String {
    fixture("compile/circle/input.toml")
}

fn text(input: &str, machine: &Machine) -> String {
    compiled(input, machine, None).unwrap_or_else(|e| panic!("{e:?}")).text
}

/// The program of CL data.
fn of_cl(case: &str, machine: &Machine) -> Result<String, splinepost::diagnostic::Diagnostics> {
    let sources = Sources::new(Source::new("input.cls", fixture(&format!("apt/{case}/input.cls"))));
    let language = front::detect(sources.get(SourceId::INPUT).expect("an input")).expect("a language");
    let output = compile(&sources, language, machine, &Options::default());
    output.map(|output| output.text).map_err(|failure| failure.diagnostics)
}

/// Whether a program is what its input asks for, as the machine reads it.
fn verifies(input: &str, text: &str, machine: &Machine) -> Result<(), Vec<&'static str>> {
    let mut sources = sources(input);
    let language = front::detect(sources.get(SourceId::INPUT).expect("an input")).expect("a language");
    let id = sources.push(Source::new("program", text));
    match verify_program(&sources, language, id, machine, &Options::default()) {
        Ok(_) => Ok(()),
        Err(errors) => Err(errors.0.iter().map(|d| d.id).collect()),
    }
}

/// What a machine file is refused for.
fn refused(lines: &str) -> Vec<&'static str> {
    let text = format!("extends = \"mazak\"\n{lines}\n");
    Machine::parse(&text, SourceId::INPUT).map_or_else(|e| e.0.iter().map(|d| d.id).collect(), |_| Vec::new())
}

#[test]
fn the_length_of_a_mazak_ends_at_the_park_place_or_not_at_all() {
    let built_in = Machine::built_in("mazak").expect("mazak");
    let parked = machine(&format!("extends = \"mazak\"\n{PARK}"));
    let remark = "STAYS IN FORCE";
    for input in [cutter(), circle()] {
        let without = text(&input, &built_in);
        assert!(!without.contains("G49") && without.contains(remark), "{without}");
        // Put back by hand it is no line of the machine file, wherever it stands behind a tool.
        for (line, place) in [("G0 G53 Z0.\nM5", "G0 G53 Z0.\nG49\nM5"), (" M6\n", " M6\nG49\n")] {
            let back = without.replacen(line, place, 1);
            assert_ne!(back, without);
            assert_eq!(verifies(&input, &back, &built_in), Err(vec!["tool-offset"]), "{back}");
        }
        let with = text(&input, &parked);
        assert_eq!(with.matches("G49").count(), 1, "{with}");
        assert!(with.contains("\nG0 G53 Z0.\nG0 G53 X-500.\nG0 G53 Y0.\nG49\nM5\nM9\nM30\n"), "{with}");
        assert!(!with.contains(remark) && with.contains("PARK PLACE AT THE END"), "{with}");
        assert_eq!(verifies(&input, &with, &parked), Ok(()));
        // Elsewhere it is no line of the machine file.
        let early = with.replacen("G0 G53 X-500.\n", "", 1);
        assert!(verifies(&input, &early, &parked).is_err(), "{early}");
    }
    // Between two tools the next length replaces the one before.
    let planes = of_cl("nx-planes", &parked).expect("a program");
    assert_eq!((planes.matches("G49").count(), planes.matches(" M6").count()), (1, 2), "{planes}");
    assert!(planes.contains("G69\nG0 G53 X-500.\nG0 G53 Y0.\nG49\nM5\n"), "{planes}");
    assert!(!of_cl("nx-planes", &built_in).expect("a program").contains("G49"));
    // Where a parameter says that it moves nothing, it stands with Z at home.
    let still = machine("extends = \"mazak\"\n[program]\nlength_end_moves = false\n");
    let with = text(&circle(), &still);
    assert!(with.contains("\nG0 G53 Z0.\nG49\nM5\nM9\nM30\n") && !with.contains(remark), "{with}");
    assert_eq!(verifies(&circle(), &with, &still), Ok(()));
}

#[test]
fn tool_centre_point_control_ends_at_the_park_place() {
    let built_in = Machine::built_in("mazak").expect("mazak");
    let errors = of_cl("nx-five-axes", &built_in).expect_err("no park place");
    assert_eq!(errors.0[0].id, "park-missing");
    let told = format!("{:?}", errors.0[0]);
    for key in ["[axis.X] home", "[axis.Y] home", "length_end_moves"] {
        assert!(told.contains(key), "{told}");
    }
    let with = of_cl("nx-five-axes", &five("mazak")).expect("a program");
    assert!(with.contains("\nG0 G53 Z0.\nG0 G53 X-500.\nG0 G53 Y0.\nG49\n"), "{with}");
    assert_eq!(with.matches("G49").count(), 1, "{with}");
    // The lines of a file of one's own are held to the same.
    let own = machine(&format!("extends = \"mazak\"\n{PARK}[program]\ntip_control_end = [\"G49\"]\n"));
    assert_eq!(of_cl("nx-five-axes", &own).expect_err("no way there").0[0].id, "park-missing");
    let still = machine("extends = \"mazak\"\n[program]\nlength_end_moves = false\n");
    assert!(of_cl("nx-five-axes", &still).expect("a program").contains("\nG49\nG0 G53 Z0.\n"));
}

#[test]
fn a_word_that_may_move_z_is_found_however_it_is_spelled() {
    for (key, line) in [
        ("header", "G17 G21 G40 G49 G90 G94"),
        ("header", "G90G049"),
        ("home", "g49 G0 G53 {home}"),
        ("footer", "G43 H0"),
        ("footer", "G43H00"),
        ("tool_spindle", "T{tool} M6 S{rpm} M3 G49"),
        ("plane_end", "G69 G49.0"),
        ("coolant", "M8G49"),
    ] {
        assert_eq!(refused(&format!("[program]\n{key} = [\"{line}\"]")), ["length-end"], "{key} {line}");
        let still = refused(&format!("[program]\nlength_end_moves = false\n{key} = [\"{line}\"]"));
        assert!(!still.contains(&"length-end"), "{key} {line}: {still:?}");
    }
    for line in ["G490", "(G49)", "M8 (NO G49)", "M8;G49"] {
        assert!(refused(&format!("[program]\ncoolant = [\"{line}\"]")).is_empty(), "{line}");
    }
    for (key, lines, id) in [
        (
            "plane",
            "\"G68.2 X0. Y0. Z0. I{first} J{second} K{third}\", \"G53.1\", \"G43 H{tool}\"",
            "length-call",
        ),
        ("spindle", "\"S{rpm} M3\", \"G43H1\"", "length-call"),
        ("footer", "\"G28 Z0.\", \"M30\"", "home-way"),
        ("footer", "\"G91 G28 Z5.\", \"G90\", \"M30\"", "home-way"),
        ("footer", "\"G91 G90 G28 Z0.\", \"M30\"", "home-way"),
        ("footer", "\"G91 G28 Z0.\", \"G90\", \"G28 X0.\", \"M30\"", "home-way"),
        ("home", "\"G28 {home}\"", "home-way"),
        ("home", "\"G0 G53\"", "home-axis"),
        ("home", "\"G91 G28 X0. Z0.\", \"G90\"", "home-axis"),
    ] {
        assert_eq!(refused(&format!("[program]\n{key} = [{lines}]")), [id], "{key} {lines}");
    }
    let away = "[axis.Z]\nhome = 500.0\n[program]\nhome = [\"G91 G28 {home}\", \"G90\"]";
    assert_eq!(refused(away), ["home-way"]);
}

#[test]
fn the_call_of_a_length_is_read_and_not_compared() {
    let built_in = text(&cutter(), &Machine::built_in("mazak").expect("mazak"));
    assert!(built_in.contains("\nG0 G43 H1 Z50.\n"), "{built_in}");
    for line in ["G43H{tool}", "g43 h{tool}", "G043 H {tool}", "H{tool} G43", "G43 H{tool} (LENGTH)"] {
        let own =
            machine(&format!("extends = \"mazak\"\n[program]\ntool = [\"T{{tool}} M6\", \"{line}\"]\n"));
        assert_eq!(text(&cutter(), &own), built_in, "{line}");
    }
    // A register is what stands there: a text and the number of the tool.
    let own = machine("extends = \"mazak\"\n[program]\ntool = [\"T{tool} M6\", \"G43 H2{tool}\"]\n");
    let numbered = text(&cutter(), &own);
    assert_eq!(numbered, built_in.replace("G43 H1 ", "G43 H21 "));
    assert_eq!(verifies(&cutter(), &numbered, &own), Ok(()));
    let other = numbered.replacen("G43 H21 ", "G43 H1 ", 1);
    assert_eq!(verifies(&cutter(), &other, &own), Err(vec!["tool-offset"]));
    for lines in [
        "\"G43 H{tool}\"",
        "\"T{tool} M6\", \"G43 H1\"",
        "\"T{tool} M6\", \"G43\"",
        "\"T{tool} M6\", \"H{tool}\"",
        "\"T{tool} M6\", \"G44 H{tool}\"",
        "\"T{tool} M6\", \"G43 H{tool} Z100.\"",
        "\"T{tool} M6 G43 H{tool}\"",
        "\"T{tool} M6\", \"G43H{tool}\", \"M8\"",
        "\"T{tool} M6\", \"G43.5 H{tool}\"",
    ] {
        assert_eq!(refused(&format!("[program]\ntool = [{lines}]")), ["length-call"], "{lines}");
    }
}

#[test]
fn a_home_that_names_its_axis_is_the_home_of_that_axis() {
    let own = machine("extends = \"mazak\"\n[program]\nhome = [\"G91G28Z0.\", \"G90\"]\n");
    let with = text(&cutter(), &own);
    assert_eq!(with.matches("\nG91G28Z0.\nG90\n").count(), 2, "{with}");
    assert_eq!(verifies(&cutter(), &with, &own), Ok(()));
    // Behind it nobody knows where Z is: without its call the length is missing.
    let lost = with.replacen("G0 G43 H1 Z50.", "G0 Z50.", 1);
    let ids = verifies(&cutter(), &lost, &own).expect_err("no length");
    assert_eq!(ids[0], "tool-offset-missing");
    // No other axis goes there.
    let along_y = cutter().replace("axis = \"Z\"", "axis = \"Y\"");
    assert_ne!(along_y, cutter());
    assert!(!text(&along_y, &own).contains("G28"), "Y does not retract by the line of Z");
}

/// A retraction to a place of the work is none.
#[test]
fn a_retraction_counts_in_machine_coordinates() {
    for (name, home) in [
        ("mazak", "G0 Z-50."),
        ("mazak", "G0 {home}"),
        ("sinumerik", "G0 Z200"),
        ("heidenhain", "L Z+200 R0 FMAX"),
        ("heidenhain", "L {home} R0 FMAX"),
    ] {
        let text = format!("extends = \"{name}\"\n[program]\nhome = [\"{home}\"]\n");
        let ids: Vec<&str> =
            Machine::parse(&text, SourceId::INPUT).expect_err(home).0.iter().map(|d| d.id).collect();
        assert!(ids.contains(&"home-coordinates"), "{name} {home}: {ids:?}");
    }
    for (name, home) in [
        ("sinumerik", "G0 G153 {home} D0"),
        ("heidenhain", "L {home} R0 FMAX M92"),
        ("mazak", "g0 g053 {home}"),
    ] {
        let text = format!("extends = \"{name}\"\n[program]\nhome = [\"{home}\"]\n");
        assert!(Machine::parse(&text, SourceId::INPUT).is_ok(), "{name} {home}");
    }
}

/// The length of a tilted tool ends when it is upright again: in the plane it would move along another axis.
#[test]
fn the_length_of_a_tilted_tool_ends_behind_its_plane() {
    let parked = machine(&format!("extends = \"mazak\"\n{PARK}"));
    let text = of_cl("nx-planes", &parked).unwrap_or_else(|e| panic!("{e:?}"));
    let (end, plane) = (text.rfind("G49").expect("G49"), text.rfind("G69").expect("G69"));
    assert!(plane < end, "{text}");
    let behind: Vec<&str> = text[plane..end].lines().collect();
    assert_eq!(behind, ["G69", "G0 G53 X-500.", "G0 G53 Y0."], "{text}");
}

#[test]
fn lines_name_the_axes_of_the_machine() {
    for (rotary, words) in
        [("", "X0. Y0. Z0."), ("\"C\"", "X0. Y0. Z0. C0."), ("\"B\", \"C\"", "X0. Y0. Z0. B0. C0.")]
    {
        let own = machine(&format!("extends = \"mazak\"\n[axes]\nrotary = [{rotary}]\n"));
        let with = text(&circle(), &own);
        assert!(with.contains(&format!("\nG52 {words}\n")), "{with}");
        let own = machine(&format!("extends = \"heidenhain\"\n[axes]\nrotary = [{rotary}]\n"));
        let with = text(&circle(), &own);
        let shifts: Vec<&str> =
            with.lines().filter_map(|line| line.split_once("CYCL DEF 7.")).map(|(_, s)| s).collect();
        let each = words.replace("0.", "+0");
        let expected: Vec<String> =
            each.split(' ').enumerate().map(|(i, word)| format!("{} {word}", i + 1)).collect();
        assert_eq!(shifts[1..], expected, "{with}");
        assert_eq!(verifies(&circle(), &with, &own), Ok(()));
    }
    // A line of one's own names no other either.
    let none = "[axes]\nrotary = []\n[program]\n";
    assert_eq!(
        refused(&format!("{none}header = [\"%\", \"O{{number}}\", \"({{name}})\", \"G52 A0.\"]")),
        ["axis-unknown"]
    );
    assert_eq!(refused(&format!("{none}footer = [\"G0A0.\", \"M30\"]")), ["axis-unknown"]);
    assert!(refused(&format!("{none}footer = [\"G52 {{axes}}\", \"G65 P9001 A1.\", \"M30\"]")).is_empty());
}

/// Below a cut the tool would come to the work at rapid, turning, from wherever it is.
#[test]
fn the_tool_turns_above_what_is_cut() {
    let start = "UNITS/MM\nMULTAX/ON\nLOADTL/1\nSPINDL/500,RPM,CLW\nFEDRAT/100,MMPM\n";
    let flat = format!("{start}GOTO/0,0,0,0.5,0,0.8660254\nGOTO/10,0,0,0.6,0,0.8\nFINI\n");
    let level = format!(
        "{start}RAPID\nGOTO/50,0,-30,1,0,0\nGOTO/50,10,-30,0.9950042,0.0998334,0\nGOTO/50,20,-30,1,0,0\nFINI\n"
    );
    let clear = level.replacen("GOTO/50,0,-30", "GOTO/80,0,-20", 1);
    let clear = clear.replace("FINI", "RAPID\nGOTO/80,0,-20,1,0,0\nFINI");
    assert_ne!(clear, level);
    for name in ["sinumerik", "heidenhain", "mazak"] {
        let keys = |height: &str| format!("extends = \"{name}\"\n{PARK}[orientation]\n{height}\n");
        let refused = |text: &str, height: &str| {
            let errors = compiled(text, &machine(&keys(height)), None).map(|output| output.text);
            errors.expect_err("it is refused").0[0].id
        };
        assert_eq!(refused(&flat, "safe_height = -20.0"), "safe-height", "{name}");
        assert_eq!(refused(&flat, ""), "safe-height", "{name}");
        assert_eq!(refused(&level, ""), "safe-height", "{name}");
        let above = compiled(&flat, &machine(&keys("safe_height = 20.0")), None);
        assert!(above.is_ok(), "{name}: {above:?}");
        let above = compiled(&clear, &machine(&keys("")), None);
        assert!(above.is_ok(), "{name}: {above:?}");
    }
}
