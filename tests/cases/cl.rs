//! What CL data means: each file's places, heights, feeds and tools as the programs of all built-in machines have them.

use crate::support::folder;
use splinepost::diagnostic::{Diagnostics, Severity};
use splinepost::ir::{Curve, Intent};
use splinepost::machine::{BUILT_IN, Machine};
use splinepost::source::{Source, SourceId, Sources};
use splinepost::{Options, Output, compile, dump, front, verify_program};

/// How a file is read: by the table of a shop, and in the unit that the command line names, mm.
#[derive(Clone, Copy, Default)]
struct How<'t> {
    words: &'t str,
    units: Option<f64>,
}

fn sources(text: &str, how: How<'_>) -> Sources {
    let mut sources = Sources::new(Source::new("input.cl", text));
    sources.units = how.units;
    if !how.words.is_empty() {
        sources.words = Some(sources.push(Source::new("words.toml", how.words)));
    }
    sources
}

fn compiled(text: &str, how: How<'_>, machine: &Machine) -> Result<Output, Diagnostics> {
    let sources = sources(text, how);
    let language = front::detect(sources.get(SourceId::INPUT).expect("the input")).expect("a language");
    compile(&sources, language, machine, &Options::default()).map_err(|failure| failure.diagnostics)
}

/// A file of `fixtures/cases/cl`.
fn case(name: &str) -> String {
    std::fs::read_to_string(folder("fixtures/cases/cl").join(name)).expect("a case")
}

fn machines() -> Vec<Machine> {
    BUILT_IN.iter().map(|(name, _)| Machine::built_in(name).expect("a built-in machine")).collect()
}

/// What a program does, read from its text: retractions, tools, stops, rapids, and each point at feed behind its F.
fn events(output: &Output, machine: &Machine) -> Vec<String> {
    let machine = machine.with_axes(&output.intent.program.axes).expect("its axes");
    let reading = (machine.dialect.read)(&output.text, SourceId::PROGRAM, &machine)
        .unwrap_or_else(|errors| panic!("{errors:?}\n{}", output.text));
    let (mut events, mut feed) = (Vec::new(), String::new());
    for line in dump::decimals(&reading.value.decimals).lines().skip(2) {
        let word = line.split(' ').next().unwrap_or_default();
        match word {
            "comment" | "spindle" | "coolant" => {}
            "cut" => {
                let rest = line.trim_start_matches("cut as asked ").trim_start_matches("cut ");
                let mut words = rest.trim_start_matches("feed ").splitn(2, ' ');
                feed = format!("F{}", words.next().unwrap_or_default());
                match words.next() {
                    Some(path) if path.starts_with("arc") => events.push(format!("{feed} {path}")),
                    Some(_) | None => {}
                }
            }
            "" => events.push(format!("{feed} {}", line.trim().replace(".0 ", " ").trim_end_matches(".0"))),
            _ => events.push(line.to_owned()),
        }
    }
    events
}

/// The place of a point at feed.
fn point(event: &str) -> Option<[f64; 3]> {
    let words: Vec<&str> = event.split(' ').collect();
    match words[..] {
        [feed, "X", x, "Y", y, "Z", z] if feed.starts_with('F') => {
            Some([x, y, z].map(|value| value.parse().expect("a number")))
        }
        _ => None,
    }
}

/// The events of a file, one a line, on every machine.
fn does(text: &str, how: How<'_>, expected: &str) {
    let expected: Vec<&str> = expected.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    for machine in machines() {
        let output =
            compiled(text, how, &machine).unwrap_or_else(|errors| panic!("{}: {errors:?}", machine.name));
        assert_eq!(events(&output, &machine), expected, "{}\n{}", machine.name, output.text);
    }
}

/// The errors and refusals of a file, on every machine.
fn refused(text: &str, how: How<'_>, id: &str) -> String {
    let mut hints = String::new();
    for machine in machines() {
        let errors = compiled(text, how, &machine).map(|output| output.text).expect_err("it is refused");
        let ids: Vec<&str> =
            errors.0.iter().filter(|e| Severity::Refusal <= e.severity).map(|e| e.id).collect();
        assert_eq!(ids, [id], "{}: {errors:?}", machine.name);
        hints = errors
            .0
            .iter()
            .filter(|e| e.id == id)
            .flat_map(|e| e.hints.clone())
            .collect::<Vec<_>>()
            .join("\n");
    }
    hints
}

/// The warnings of a file.
fn warned(text: &str, how: How<'_>) -> Vec<&'static str> {
    intent(text, how).warnings.0.iter().map(|warning| warning.id).collect()
}

fn intent(text: &str, how: How<'_>) -> Intent {
    let sources = sources(text, how);
    let language = front::detect(sources.get(SourceId::INPUT).expect("the input")).expect("a language");
    (language.parse)(&sources).unwrap_or_else(|errors| panic!("{errors:?}"))
}

/// How many turns each arc of a file has, and how far it rises, mm.
fn arcs(text: &str, how: How<'_>) -> Vec<(f64, f64)> {
    let intent = intent(text, how);
    let cuts = intent.program.steps.iter().filter_map(|located| located.step.cut());
    let arc = |curve: &Curve| match curve {
        Curve::Arc(arc) => Some((arc.turns(), arc.rise())),
        Curve::Lines(_)
        | Curve::Polynomial(_)
        | Curve::Nurbs(_)
        | Curve::Formula(_)
        | Curve::Through(..)
        | Curve::Logarithmic(_) => None,
    };
    cuts.filter_map(|cut| arc(&cut.curve)).collect()
}

fn words(words: &str) -> How<'_> {
    How { words, ..How::default() }
}

/// `RTRCTO,AUTO`: back to the height before the cycle, between the holes too.
#[test]
fn retract_auto_is_the_height_before_the_cycle() {
    does(
        &case("nx-retract-auto.cls"),
        How::default(),
        "home Z
        tool 4
        rapid X 0 Y 0
        rapid Z 60
        rapid X 0 Y 0 Z 3
        F150 X 0 Y 0 Z -10
        rapid Z 60
        rapid X 50
        rapid Z 3
        F150 X 50 Y 0 Z -10
        rapid Z 60
        rapid X 50
        home Z",
    );
    // Nothing brought the tool to a height.
    let alone = "UNITS/MM\nTOOL PATH/A,TOOL,B\nLOAD/TOOL,1\nSPINDL/RPM,100,CLW\nCYCLE/DRILL,RAPTO,3,FEDTO,-5,RTRCTO,AUTO,MMPM,50\nGOTO/0,0,0\n";
    assert!(refused(alone, How::default(), "cycle-retract").contains("RAPID"));
    // MANUAL is where the feed begins, and a number counts from the point.
    for (to, height) in [("MANUAL", 3), ("8", 8), ("8,MANUAL", 8)] {
        let file = case("nx-retract-auto.cls").replace("AUTO", to);
        let output = compiled(&file, How::default(), &machines()[0]).expect("a program");
        let found = events(&output, &machines()[0]);
        assert_eq!(found[6], format!("rapid Z {height}"), "{to}: {found:?}");
    }
}

/// The same five numbers of two posts of Autodesk: a key says which, and without it they are refused.
#[test]
fn cycles_by_position_are_told_apart() {
    let expected = "home Z
        tool 3
        rapid X 20 Y 10
        rapid Z 5
        rapid X 20 Y 10 Z 5
        F150 X 20 Y 10 Z -12
        rapid Z 5
        rapid X 40
        F150 X 40 Y 10 Z -12
        rapid Z 5
        rapid X 40
        home Z";
    let file = case("fusion-drill-point-is-bottom.apt");
    let iso = words("extends = \"fusion\"\ncycle_heights = \"iso-4343\"");
    let generative = words("extends = \"fusion\"\ncycle_heights = \"generative\"");
    does(&file, iso, expected);
    let hints = refused(&file, How::default(), "cycle-heights");
    assert!(hints.contains("\"iso-4343\"") && hints.contains("\"generative\""), "{hints}");
    // The other post writes the same holes so: the top, and the clearance from the bottom.
    let other = file.replace("-12.\n", "0.\n").replace("150., 5.", "150., 17.");
    does(&other, generative, expected);
    // The clearance less RAPTO is where the feed begins.
    let raised = file.replace("150., 5.\n", "150., 5., RAPTO, 3.\n");
    let found = events(&compiled(&raised, iso, &machines()[0]).expect("a program"), &machines()[0]);
    assert_eq!(found[4..7], ["rapid X 20 Y 10 Z 2", "F150 X 20 Y 10 Z -12", "rapid Z 5"]);
    // The first file read as the other post writes: it would begin 7 mm below the top.
    assert_eq!(refused(&file, generative, "cycle-clear"), "");
}

/// What ends a cycle where CYCLE/OFF is missing.
#[test]
fn a_cycle_ends_with_its_tool_its_operation_and_its_file() {
    let file = case("cycle-open-at-tool-change.apt");
    does(
        &file,
        How::default(),
        "home Z
        tool 4
        rapid X 10 Y 10
        rapid Z 50
        rapid X 10 Y 10 Z 3
        F120 X 10 Y 10 Z -7
        rapid Z 50
        home Z
        tool 2
        rapid X 50 Y 50
        rapid Z 50
        rapid Z 2.5
        F80 X 50 Y 50 Z -1
        F200 X 80 Y 50 Z -1
        F200 X 80 Y 80 Z -1
        rapid Z 50
        home Z",
    );
    assert!(warned(&file, How::default()).contains(&"cycle-open"));
    let start = "UNITS/MM\nLOADTL/1\nSPINDL/100,CLW\nFEDRAT/100,MMPM\nRAPID\nGOTO/0,0,20\nCYCLE/DRILL,DEPTH,5,CLEAR,2\nGOTO/0,0,0\n";
    for end in
        ["END-OF-PATH", "TOOL PATH/B,TOOL,C", "$$-> FEATNO / 7", "$$ OPERATION NAME : B", "GOHOME/0,0,30", ""]
    {
        let text = format!("{start}{end}\nFINI\n");
        let open = warned(&text, How::default()).iter().filter(|id| **id == "cycle-open").count();
        assert_eq!(open, 1, "{end}");
    }
    // No other tool takes it up again.
    let again = format!("{start}LOADTL/2\nSPINDL/100,CLW\nRAPID\nGOTO/0,0,20\nCYCLE/ON\nGOTO/5,0,0\n");
    refused(&again, How::default(), "cycle-unknown");
    // RAPID: a hole or a move, as a key says.
    let rapid = format!("{start}RAPID\nGOTO/9,0,20\nCYCLE/OFF\n");
    assert!(refused(&rapid, How::default(), "cycle-rapid").contains("cycle_rapid"));
    let last = |how| {
        let output = compiled(&rapid, how, &machines()[0]).expect("a program");
        let found = events(&output, &machines()[0]);
        found[found.len() - 3..].join(" | ")
    };
    assert_eq!(last(words("cycle_rapid = \"hole\"")), "F100 X 9 Y 0 Z 15 | rapid Z 22 | home Z");
    assert_eq!(last(words("cycle_rapid = \"off\"")), "rapid Z 2 | rapid X 9 Z 20 | home Z");
}

/// A tool that has another name, or another diameter, than its number had before is another tool.
#[test]
fn a_path_names_the_tool_that_cuts_it() {
    let file = case("nx-two-tools-one-load.cls");
    assert!(refused(&file, How::default(), "tool-name").contains("[tools]"));
    does(
        &file,
        words("[tools]\nBALL_D6 = 2"),
        "home Z
        tool 1
        rapid X 0 Y 0
        rapid Z 50
        F300 X 0 Y 0 Z 0
        F300 X 50 Y 0 Z 0
        rapid Z 50
        home Z
        tool 2
        rapid X 0 Y 20
        rapid Z 50
        F300 X 0 Y 20 Z -2
        F300 X 50 Y 20 Z -2
        rapid Z 50
        home Z",
    );
    // The same number for two names, and the same for two diameters.
    let again = file.replace("TLDATA/MILL,6", "LOAD/TOOL,1\nTLDATA/MILL,6");
    refused(&again, How::default(), "tool-name");
    let cutters = "UNITS/MM\nCUTTER/20\nLOADTL/1\nSPINDL/100,CLW\nFEDRAT/100,MMPM\nRAPID\nGOTO/0,0,20\nCUTTER/6\nGOTO/0,0,0\n";
    assert!(refused(cutters, How::default(), "tool-diameter").contains("CUTTER"));
    refused(&file, words("[tools]\nMILL_D20 = 7\nBALL_D6 = 2"), "tool-name");
}

/// Eleven numbers are left-handed in every system; lines beside arcs that say otherwise are believed.
#[test]
fn circles_of_eleven_numbers_are_left_handed() {
    let file = case("circle-eleven-numbers-unknown-system.apt");
    let turns: Vec<f64> = arcs(&file, How::default()).into_iter().map(|(turns, _)| turns).collect();
    // A quarter each; the centres are exact, so that the angles are off by rounding of atan2 alone, 1e-15.
    assert!(turns.len() == 2 && turns.iter().all(|turns| (turns - 0.25).abs() < 1.0e-14), "{turns:?}");
    for machine in machines() {
        let output = compiled(&file, How::default(), &machine).expect("a program");
        let arcs: Vec<String> =
            events(&output, &machine).into_iter().filter(|event| event.contains(" arc ")).collect();
        let quarter = |arc: &String, from: &str, to: &str| {
            arc.contains("CounterClockwise") && arc.contains(from) && arc.contains(to)
        };
        assert!(quarter(&arcs[0], "from X 5.0 Y 20.0", "to X 0.0 Y 15.0"), "{arcs:?}");
        assert!(quarter(&arcs[1], "from X 0.0 Y 5.0", "to X 5.0 Y 0.0"), "{arcs:?}");
    }
    // The same arcs, as seven numbers, and as MOVARC, with the axis the wrong way round.
    let seven = file.replace(",5.0,0.002,0.5,10.0,0.0\n", ",5.0\n");
    let movarc = seven.replace("CIRCLE/", "MOVARC/").replace("-1.0,5.0\n", "-1.0,5.0,ANGLE,270\n");
    for (text, key) in [(&seven, "circle"), (&movarc, "movarc")] {
        let hints = refused(text, How::default(), "arc-sense");
        assert!(hints.contains(&format!("{key} = \"left-hand\"")), "{hints}");
        let told = format!("{key} = \"right-hand\"");
        assert!(warned(text, words(&told)).contains(&"arc-sense"), "{key}");
    }
    assert_eq!(arcs(&seven, words("circle = \"left-hand\"")).len(), 2);
}

/// `TIMES,n`: the end is met the n-th time.
#[test]
fn times_adds_whole_turns() {
    let [(turns, rise)] = arcs(&case("nx-helix-times.cls"), How::default())[..] else { panic!("one helix") };
    assert!((turns - 1.25).abs() < 1.0e-14 && rise == -3.0, "{turns} {rise}");
    for machine in machines() {
        compiled(&case("nx-helix-times.cls"), How::default(), &machine).expect("a program");
    }
}

/// A frame stated again is no other one, and under TRNTYP/WORLD positions stay in one.
#[test]
fn a_frame_stated_again_is_no_other_one() {
    let file = case("solidworks-same-frame-again.apt");
    let expected = "home Z
        tool 1
        rapid X 0 Y 0
        rapid Z 20
        F300 X 0 Y 0 Z -1
        F300 X 30 Y 0 Z -1
        rapid Z 20
        rapid X 0 Y 20
        F300 X 0 Y 20 Z -1
        F300 X 30 Y 20 Z -1
        rapid Z 20
        home Z";
    does(&file, How::default(), expected);
    let (first, second) = file.split_at(file.rfind("CSYS/").expect("two frames"));
    let turned = format!("{first}{}", second.replacen("CSYS/1.,0,0,0,", "CSYS/1.,0,0,7.,", 1));
    let found =
        events(&compiled(&turned, How::default(), &machines()[0]).expect("a program"), &machines()[0]);
    assert!(!found.contains(&"stop".to_owned()), "{found:?}");
    // In another frame the program stops.
    let local = turned.replace("TRNTYP/WORLD", "TRNTYP/LOCAL");
    let found = events(&compiled(&local, How::default(), &machines()[0]).expect("a program"), &machines()[0]);
    assert!(found.contains(&"stop".to_owned()), "{found:?}");
}

/// ADJUST and OSETNO are the register of the tool's length, and no other register is as good.
#[test]
fn a_register_is_written_or_refused() {
    let file = case("nx-adjust-register.cls");
    for text in [file.clone(), file.replace("ADJUST", "OSETNO")] {
        for machine in machines() {
            let result = compiled(&text, How::default(), &machine);
            if machine.name == "mazak" {
                let output = result.expect("a program");
                assert!(
                    output.text.contains("T5 M6\n") && output.text.contains("\nG43 H12 Z20.\n"),
                    "{}",
                    output.text
                );
                let expected = "home Z | tool 5 with the length of register 12 | rapid X 10 Y 0 | rapid Z 20";
                assert_eq!(events(&output, &machine)[..4].join(" | "), expected);
                let mut sources = sources(&text, How::default());
                let language = front::find("nx").expect("a language");
                let id = sources.push(Source::new("program", output.text.replace("H12", "H5")));
                let wrong = verify_program(&sources, language, id, &machine, &Options::default());
                assert!(wrong.is_err(), "the length of another register");
            } else {
                let errors = result.map(|output| output.text).expect_err("no such register");
                assert!(errors.0.iter().any(|e| e.id == "tool-register"), "{errors:?}");
                compiled(&text, words("tool_register = \"left-out\""), &machine).expect("the tool's own");
            }
        }
    }
    // Its own number is no other register, and no length is none.
    does(
        &file.replace("ADJUST,12", "ADJUST,5"),
        How::default(),
        "home Z
        tool 5
        rapid X 10 Y 0
        rapid Z 20
        F400 X 10 Y 0 Z 0
        rapid Z 20
        home Z",
    );
    refused(&file.replace("ADJUST,12", "ADJUST,0"), How::default(), "tool-register");
    // The same tool with another register is another call.
    let mazak = Machine::built_in("mazak").expect("a machine");
    let again = file.replace(
        "END-OF-PATH",
        "LOAD/TOOL,5,ADJUST,13\nSPINDL/RPM,900,CLW\nRAPID\nGOTO/0,0,9\nGOTO/0,0,1\nEND-OF-PATH",
    );
    let text = compiled(&again, How::default(), &mazak).expect("a program").text;
    assert!(text.contains("G43 H12 ") && text.contains("G43 H13 "), "{text}");
    // A machine whose lines have the number of the tool takes no other register.
    let own = "extends = \"mazak\"\nname = \"own\"\n[program]\ntool = [\"T{tool} M6\", \"G43 H{tool}\"]\ntip_control = [\"G43.5 H{tool}\"]\n";
    let own = Machine::parse(own, SourceId::INPUT).expect("a machine");
    let errors = compiled(&file, How::default(), &own).map(|output| output.text).expect_err("refused");
    assert!(errors.0.iter().any(|e| e.id == "tool-register"), "{errors:?}");
}

/// Without a tool the first rapid goes over the work, and then down.
#[test]
fn the_first_move_without_a_tool_goes_over_and_down() {
    let file = case("first-move-three-axes.cls");
    does(
        &file,
        How::default(),
        "rapid X 150 Y -20
        rapid Z 10
        F250 X 150 Y -20 Z 0
        F250 X 200 Y -20 Z 0
        rapid Z 10",
    );
    // Where FROM says that the tool is lower, it goes up first.
    let low = file.replace("RAPID\nGOTO/150", "FROM/0,0,-5\nRAPID\nGOTO/150");
    let found = events(&compiled(&low, How::default(), &machines()[0]).expect("a program"), &machines()[0]);
    assert_eq!(found[..2], ["rapid Z 10", "rapid X 150 Y -20"]);
}

/// A feed in inches in a file that states no unit.
#[test]
fn a_unit_is_stated_or_asked_for() {
    let file = case("nx-inch-no-units.cls");
    assert!(refused(&file, How::default(), "units-missing").contains("--units inches"));
    does(
        &file,
        How { units: Some(25.4), ..How::default() },
        "home Z
        tool 1
        rapid X 0 Y 0
        rapid Z 25.4
        rapid Z 2.54
        F254 X 0 Y 0 Z -2.54
        F254 X 50.8 Y 0 Z -2.54
        F254 X 50.8 Y 38.1 Z -2.54
        rapid Z 25.4
        home Z",
    );
    // Feeds in mm say what the file is in; without any it is told. A unit behind a feed that had none comes too late.
    let mm = "LOADTL/1\nSPINDL/100,CLW\nFEDRAT/100,MMPM\nRAPID\nGOTO/0,0,9\nGOTO/0,0,1\n";
    assert!(!warned(mm, How::default()).contains(&"units-missing"));
    assert!(warned(&mm.replace(",MMPM", ""), How::default()).contains(&"units-missing"));
    refused(&format!("FEDRAT/10\nUNITS/INCHES\n{mm}"), How::default(), "units-late");
    refused(&format!("UNITS/MM\n{mm}"), How { units: Some(25.4), ..How::default() }, "units-differ");
}

/// RANGE of SPINDL is a gear: it is not lost.
#[test]
fn a_gear_of_the_spindle_is_not_lost() {
    let text =
        "UNITS/MM\nLOADTL/1\nSPINDL/RPM,1500,CLW,RANGE,2\nFEDRAT/100,MMPM\nRAPID\nGOTO/0,0,9\nGOTO/0,0,1\n";
    assert!(refused(text, How::default(), "spindle-range").contains("spindle_range"));
    refused(&text.replace("RANGE,2", "RANGE,HIGH"), How::default(), "spindle-range");
    assert!(warned(text, words("spindle_range = \"left-out\"")).contains(&"word-left-out"));
    refused(&text.replace(",RANGE,2", ",RANGE"), How::default(), "arguments");
}

/// A helix whose end is over its start is a turn; almost over it, it may be a plunge.
#[test]
fn a_helix_over_its_start_is_a_turn() {
    let tilted = case("helix-turn-tilted.ncl");
    let whole: Vec<(f64, f64)> =
        arcs(&tilted, How::default()).into_iter().filter(|(turns, _)| (turns - 1.0).abs() < 1.0e-9).collect();
    // The pitch of the last is √(0.057334² + 0.076445²) mm along its axis, the other goes round in its plane.
    let pitch = (0.057_334_f64 * 0.057_334 + 0.076_445 * 0.076_445).sqrt();
    assert!(whole.iter().any(|(_, rise)| (rise.abs() - pitch).abs() < 1.0e-6), "{whole:?}");
    for machine in machines() {
        let output = compiled(&tilted, How::default(), &machine).expect("a program");
        let points: Vec<[f64; 3]> =
            events(&output, &machine).iter().filter_map(|event| point(event)).collect();
        // The least decimals are four, so that a place is off by half a unit of the last.
        let is = |p: &[f64; 3], q: [f64; 3]| (0..3).all(|i| (p[i] - q[i]).abs() <= 0.5e-4 + 1.0e-9);
        let end = points.iter().position(|p| is(p, [0.816_586, 2.912_027, -0.0616]));
        let end = end.unwrap_or_else(|| panic!("{}: {points:?}", machine.name));
        assert!(!is(&points[end - 1], [0.759_252, 2.912_027, -0.138_045]), "{}: a plunge", machine.name);
    }
    let file = case("helix-turn-z.ncl");
    let [(turns, rise)] = arcs(&file, How::default())[..] else { panic!("one arc") };
    // 0.001 mm short of a turn at a radius of 5 mm.
    let short = 0.001 / 5.0 / (2.0 * std::f64::consts::PI);
    assert!((turns - (1.0 - short)).abs() < 1.0e-9 && rise == -2.0, "{turns} {rise}");
    // As far on the other side of its start it may be either.
    refused(&file.replace("-0.0010000", "0.0010000"), How::default(), "arc-turn");
}

/// A part program is told as one thing.
#[test]
fn a_part_program_is_one_message() {
    refused(&case("apt-part-program.apt"), How::default(), "apt-part-program");
}

/// `DRILL,DEEP` is DEEP, and `CYCLE/ON` changes one argument.
#[test]
fn a_cycle_taken_up_again_may_change_an_argument() {
    does(
        &case("nx-drill-deep-cycle-on.cls"),
        How::default(),
        "home Z
        tool 62
        rapid X 0 Y 0
        rapid Z 80
        rapid X 0 Y 0 Z 3
        F250 X 0 Y 0 Z -20
        rapid Z 3
        rapid Z -17
        F250 X 0 Y 0 Z -40
        rapid Z 3
        rapid Z -37
        F250 X 0 Y 0 Z -50
        rapid Z 80
        rapid X 40 Y 0 Z 80
        rapid Z 3
        F250 X 40 Y 0 Z -20
        rapid Z 3
        rapid Z -17
        F250 X 40 Y 0 Z -30
        rapid Z 80
        home Z",
    );
}

/// An end one in the fifth decimal beside the start is that of a whole turn, wherever the circle lies; farther away it may be
/// either, however it is spelled.
#[test]
fn an_end_beside_its_start_is_a_turn_or_asked() {
    let file = |y: &str, end: &str| {
        format!(
            "TOOL PATH/A,TOOL,B\nUNITS/MM\nLOAD/TOOL,1\nSPINDL/RPM,1000,CLW\nRAPID\nGOTO/10.,{y},20.\nFEDRAT/MMPM,100\n\
             GOTO/10.,{y},0.\nCIRCLE/0.,{y},0.,0,0,1,10.,0.06,0.5,12,0\nGOTO/{end},0.\nGOTO/10.,{y},20.\n"
        )
    };
    for (y, end) in [
        ("31.90445", "10.,31.90444"),
        ("1.00001", "10.,1.00000"),
        ("0.00000", "10.,-0.00001"),
        ("99999.99999", "10.,99999.99998"),
        ("1.00000", "10.,1.00000"),
    ] {
        let [(turns, rise)] = arcs(&file(y, end), How::default())[..] else { panic!("one arc: {y}") };
        // 1e-5 mm of 10 mm are 1.6e-7 turns.
        assert!((turns - 1.0).abs() < 2.0e-7 && rise == 0.0, "{y}: {turns}");
    }
    for end in ["10.,-0.0001", "10.,0.0001", "10.,-0.001"] {
        let text = file("0.", end);
        if arcs_or(&text).is_some_and(|turns| 0.99 < turns) {
            // On the far side of the start it is almost a turn as it stands.
            continue;
        }
        refused(&text, How::default(), "arc-turn");
    }
}

/// The turns of the only arc, where the file is read.
fn arcs_or(text: &str) -> Option<f64> {
    let machine = machines().into_iter().next()?;
    compiled(text, How::default(), &machine).ok()?;
    arcs(text, How::default()).first().map(|(turns, _)| *turns)
}

/// NX counts below its point as negative, others as positive; the other sign would be above it.
#[test]
fn a_depth_above_the_point_is_refused() {
    let nx = "TOOL PATH/A,TOOL,B\nUNITS/MM\nLOAD/TOOL,1\nSPINDL/RPM,100,CLW\nRAPID\nGOTO/0,0,20\n\
              CYCLE/DRILL,RAPTO,3,FEDTO,-5,RTRCTO,AUTO,MMPM,50\nGOTO/0,0,0\nCYCLE/OFF\n";
    let iso = "UNITS/MM\nLOADTL/1\nSPINDL/100,CLW\nFEDRAT/100,MMPM\nRAPID\nGOTO/0,0,20\n\
               CYCLE/DRILL,DEPTH,5,CLEAR,2\nGOTO/0,0,0\nCYCLE/OFF\nFINI\n";
    let deep = |text: &str, how: How<'_>| {
        let machine = machines().into_iter().next().expect("a machine");
        let output = compiled(text, how, &machine).unwrap_or_else(|e| panic!("{e:?}\n{text}"));
        let events = events(&output, &machine);
        events.iter().filter_map(|event| point(event)).map(|p| p[2]).fold(f64::INFINITY, f64::min)
    };
    assert_eq!(deep(nx, How::default()).to_bits(), (-5.0f64).to_bits());
    assert_eq!(deep(iso, How::default()).to_bits(), (-5.0f64).to_bits());
    let (up, down) = (nx.replace("FEDTO,-5", "FEDTO,5"), iso.replace("DEPTH,5", "FEDTO,-5"));
    for (text, sign) in [(&up, "positive"), (&down, "negative")] {
        let hints = refused(text, How::default(), "cycle-depth");
        let key = format!("fedto = \"{sign}\"");
        assert!(hints.contains(&key), "{hints}");
        assert_eq!(deep(text, words(&key)).to_bits(), (-5.0f64).to_bits(), "{key}");
    }
    refused(&iso.replace("DEPTH,5", "DEPTH,-5"), How::default(), "cycle-depth");
}
