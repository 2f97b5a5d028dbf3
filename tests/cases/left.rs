//! What a program leaves behind: feed modes, coolant, wound axes, swivelled planes, second curves; what it is called; and the
//! letters and lines of its remarks. The expected words are those of the controls' manuals.

use crate::support::{compiled, folder, input, machine, sources};
use splinepost::diagnostic::Diagnostics;
use splinepost::ir::{Auxiliary, Step};
use splinepost::machine::Machine;
use splinepost::source::{Source, SourceId, Sources};
use splinepost::{Options, Output, compile, front, pass, recompile, verify_program};

const NAMES: [&str; 3] = ["sinumerik", "heidenhain", "mazak"];

fn built_in(name: &str) -> Machine {
    Machine::built_in(name).expect("a built-in machine")
}

/// The program of CL data, proved, and again as `verify` reads it.
fn program(text: &str, machine: &Machine) -> Output {
    let mut sources = Sources::new(Source::new("input.cl", text));
    let language = front::detect(sources.get(SourceId::INPUT).expect("the input")).expect("a language");
    let output = compile(&sources, language, machine, &Options::default())
        .unwrap_or_else(|failure| panic!("{:?}", failure.diagnostics));
    let id = sources.push(Source::new("program", output.text.clone()));
    verify_program(&sources, language, id, machine, &Options::default())
        .unwrap_or_else(|errors| panic!("{errors:?}\n{}", output.text));
    output
}

/// The program of a cutter or a job.
fn text_of(text: &str, machine: &Machine) -> String {
    compiled(text, machine, None).unwrap_or_else(|errors| panic!("{errors:?}")).text
}

/// The lines without their numbers.
fn lines(text: &str) -> Vec<&str> {
    text.lines()
        .map(|line| {
            let line = line.trim();
            let digits = line.trim_start_matches('N').trim_start_matches(|c: char| c.is_ascii_digit());
            if digits.len() < line.len() && (digits.starts_with(' ') || digits.is_empty()) {
                digits.trim()
            } else {
                line
            }
        })
        .collect()
}

/// The blocks of a control that switch or move, in short: those that begin or end as one of these.
fn among<'t>(text: &'t str, wanted: &[&str]) -> Vec<&'t str> {
    lines(text).into_iter().filter(|line| wanted.iter().any(|word| line.contains(word))).collect()
}

/// Coolant is on when tool 2 is called, and nobody says it again.
const TWO_TOOLS: &str = "PARTNO TWO\nUNITS/MM\nLOADTL/1\nSPINDL/2000,RPM,CLW\nCOOLNT/ON\nRAPID\nGOTO/0,0,50\n\
    FEDRAT/300,MMPM\nGOTO/0,0,0\nGOTO/50,0,0\nRAPID\nGOTO/50,0,50\nLOADTL/2\nSPINDL/3000,RPM,CLW\nRAPID\n\
    GOTO/0,20,50\nGOTO/0,20,0\nRAPID\nGOTO/0,20,50\nFINI\n";

#[test]
fn coolant_stops_before_a_tool_change_and_flows_behind_it() {
    let expected: [&[&str]; 3] = [
        &["M6", "M8", "M9", "M6", "M8", "M9"],
        &["TOOL CALL 1 Z S2000", "M8", "M9", "TOOL CALL 2 Z S3000", "M8", "M9"],
        &["T1 M6", "M8", "M9", "T2 M6", "M8", "M9"],
    ];
    for (name, expected) in NAMES.iter().zip(expected) {
        let text = program(TWO_TOOLS, &built_in(name)).text;
        assert_eq!(
            among(&text, &["M6", "TOOL CALL", "M8", "M9"])
                .iter()
                .filter(|line| !line.contains("M91"))
                .copied()
                .collect::<Vec<_>>(),
            expected,
            "{name}\n{text}"
        );
        // Before the tool goes home, and before it moves to the work again.
        let all = lines(&text);
        let at = |word: &str, from: usize| {
            from + all[from..].iter().position(|line| line.contains(word)).expect(word)
        };
        let stop = all.iter().position(|line| *line == "M9").expect("M9");
        let home = at(["SUPA", "M91", "G53"][NAMES.iter().position(|n| n == name).expect("a name")], stop);
        let again = at("M8", home);
        assert!(stop < home && home < again && again < at("Y", again), "{name}\n{text}");
    }
}

/// What the input says between the call and the first move is what is done, and a start before the first tool waits for it.
#[test]
fn coolant_of_the_input_is_not_said_twice() {
    let sinumerik = built_in("sinumerik");
    let words = |text: &str| -> Vec<String> {
        let text = program(text, &sinumerik).text;
        among(&text, &["M6", "M8", "M9"]).into_iter().map(str::to_owned).collect()
    };
    let off = TWO_TOOLS.replace("LOADTL/2", "COOLNT/OFF\nLOADTL/2");
    assert_eq!(words(&off), ["M6", "M8", "M9", "M6", "M9"]);
    let on = TWO_TOOLS.replace("SPINDL/3000,RPM,CLW", "SPINDL/3000,RPM,CLW\nCOOLNT/ON");
    assert_eq!(words(&on), ["M6", "M8", "M9", "M6", "M8", "M9"]);
    let early = TWO_TOOLS.replace("COOLNT/ON\n", "").replace("LOADTL/1", "COOLNT/ON\nLOADTL/1");
    assert_eq!(words(&early), ["M6", "M8", "M9", "M6", "M8", "M9"]);
}

/// 840D, NC Programming 12.19: G71 leaves F in the basic system's unit; CYCLE800() ends what another program swivelled, and may
/// turn axes, so that Z is home before.
#[test]
fn a_sinumerik_states_its_unit_and_ends_a_plane_that_was_left() {
    let cone = input("D1 = 10\nS = 30\nC = 5\nr = 8\nlength = 30", "");
    let text = text_of(&cone, &built_in("sinumerik"));
    assert!(lines(&text)[1].ends_with("G17 G40 G710 G90 G94"), "{text}");
    let shown = among(&text, &["SUPA", "CYCLE800", "T1", "M6"]);
    assert_eq!(shown[..4], ["G0 SUPA Z0 D0", "CYCLE800()", "T1", "M6"], "{text}");
    assert_eq!(text.matches("CYCLE800").count(), 1);
    // A machine without swivel data has none, one without a home ends it first.
    let without = machine("extends = \"sinumerik\"\n[program]\nstart = []\n");
    assert!(!text_of(&cone, &without).contains("CYCLE800"));
    let nowhere = machine("extends = \"sinumerik\"\n[program]\nhome = []\n");
    let text = text_of(&cone, &nowhere);
    assert_eq!(among(&text, &["SUPA", "CYCLE800", "T1"]), ["CYCLE800()", "T1"], "{text}");
    // It is part of what must stand before the first tool.
    for damaged in [text.replace("CYCLE800()", "; CYCLE800()"), text.replace("CYCLE800()", "CYCLE800(1)")] {
        assert_ne!(damaged, text);
        let mut sources = sources(&cone);
        let id = sources.push(Source::new("program", damaged));
        let cutter = front::find("cutter").expect("a language");
        assert!(verify_program(&sources, cutter, id, &nowhere, &Options::default()).is_err());
    }
    // Behind the first tool the same line is the end of a plane.
    let planes = std::fs::read_to_string(folder("fixtures/apt/nx-planes/sinumerik.mpf")).expect("a program");
    let sinumerik = built_in("sinumerik");
    let first = lines(&planes).iter().position(|line| *line == "CYCLE800()").expect("the start");
    let without: String = planes
        .split_inclusive('\n')
        .enumerate()
        .filter(|(at, _)| *at != first)
        .map(|(_, line)| line)
        .collect();
    let ends = |text: &str| {
        let reading =
            (sinumerik.dialect.read)(text, SourceId::PROGRAM, &sinumerik).expect("it is read").value;
        let end = |step: &Step<_, _>| matches!(step, Step::Auxiliary(Auxiliary::PlaneEnd));
        (reading.header, reading.decimals.program.steps.iter().filter(|located| end(&located.step)).count())
    };
    let (whole, count) = ends(&planes);
    assert!(whole && 1 < count && ends(&without) == (false, count), "{count}");
    // What the header switches on is off at the end.
    let end: Vec<&str> = lines(&text).into_iter().rev().take(5).collect();
    assert_eq!(end, ["M30", "SPATH", "FGROUP()", "M9", "M5"]);
}

/// Labels behind M30 are called by CALL BLOCK (Siemens' own posts); REPEAT to them is told by no manual.
#[test]
fn subprograms_of_a_sinumerik_are_called_as_blocks() {
    let alike = "name = \"CONE10\"\n[cutter]\nD1 = 10\nS = 30\nC = 5\nr = 8\nlength = 30\nflutes = 2\n\
        [process]\nfeed = 200\nretract = { axis = \"Z\", to = 50 }\n";
    let machine = machine("extends = \"sinumerik\"\n[program]\nsubprograms = true\n");
    let text = text_of(alike, &machine);
    assert_eq!(text.matches("CALL BLOCK FLUTE1 TO FLUTE1_END").count(), 2, "{text}");
    assert!(!text.contains("REPEAT"));
    // From the label of one to the end of another is a call of nothing.
    let wrong = text.replacen("TO FLUTE1_END", "TO FLUTE2_END", 1);
    assert!((machine.dialect.read)(&wrong, SourceId::PROGRAM, &machine).is_err());
}

#[test]
fn inverse_time_ends_with_the_lines_that_have_it() {
    let mazak = machine("extends = \"mazak\"\n[feed]\nrotary = \"inverse-time\"\n");
    let text = text_of(&input("D1 = 10\nS = 30\nC = 5\nr = 8\nlength = 30\nflutes = 2", ""), &mazak);
    let mut timed = false;
    let mut runs = 0;
    for line in text.lines() {
        let words: Vec<&str> = line.split(' ').collect();
        let on = words.contains(&"G93");
        runs += u32::from(on && !timed);
        timed = (timed || on) && !words.contains(&"G94");
        // No remark, rapid or line of the machine file stands under it.
        let moves = words
            .iter()
            .any(|word| word.starts_with('F') && word.ends_with(|c: char| c.is_ascii_digit() || c == '.'));
        assert!(!timed || moves, "{line}\n{text}");
    }
    assert!(runs == 2 && !timed, "{text}");
}

/// TNC 426 manual p.192: M94 first counts the axis below 360 degrees; without it A+0 turns back by all turns.
#[test]
fn steps_round_a_wrapping_axis_are_unwound() {
    let wraps = "extends = \"heidenhain\"\n[axis.A]\nkind = \"modulo\"\n";
    let long = "name = \"TURNS\"\n[cutter]\nD1 = 10\nS = 60\nC = 2\nr = 8\nlength = 200\nflutes = 2\n\
        [process]\nfeed = 300\nspindle = 3000\nretract = { axis = \"Z\", to = 50 }\n";
    let text = text_of(long, &machine(wraps));
    let all = lines(&text);
    let mut wound = false;
    let mut unwound = 0;
    for (at, line) in all.iter().enumerate() {
        wound |= line.contains(" IA");
        if *line == "L M94 A" {
            assert!(wound && all[at - 1] == "L Z+50 R0 FMAX", "{text}");
            (wound, unwound) = (false, unwound + 1);
        }
        let absolute = line.starts_with("L ") && line.contains(" A") || line.starts_with("CYCL DEF 7");
        assert!(!(wound && absolute), "{line}\n{text}");
    }
    assert!(unwound == 2 && !wound, "{text}");
    let none = machine(&format!("{wraps}[program]\nunwind = []\n"));
    assert!(!text_of(long, &none).contains("M94"));
}

/// LN: X Y Z and all components in every block (Heidenhain's posts; "required").
#[test]
fn ln_states_all_of_a_place_and_a_direction() {
    let cl = std::fs::read_to_string(folder("fixtures/apt/nx-five-axes/input.cls")).expect("an input");
    let heidenhain = built_in("heidenhain");
    let text = program(&cl, &heidenhain).text;
    let blocks: Vec<&str> = lines(&text).into_iter().filter(|line| line.starts_with("LN ")).collect();
    assert!(6 < blocks.len());
    for block in &blocks {
        for word in [" X", " Y", " Z", " TX", " TY", " TZ"] {
            assert_eq!(block.matches(word).count(), 1, "{block}");
        }
    }
    let own = heidenhain.for_program(&text);
    for (word, id) in [("X", "place-incomplete"), ("Z", "place-incomplete"), ("TY", "direction-incomplete")] {
        let whole = blocks[blocks.len() - 2];
        let without: Vec<&str> = whole
            .split(' ')
            .filter(|part| part.trim_end_matches(|c: char| !c.is_ascii_alphabetic()) != word)
            .collect();
        let damaged = text.replace(whole, &without.join(" "));
        assert_ne!(damaged, text, "{whole}");
        let errors = (own.dialect.read)(&damaged, SourceId::PROGRAM, &own).expect_err("a word is missing");
        assert_eq!(errors.0[0].id, id, "{errors:?}");
    }
}

/// A second curve leads the tool between splines only: ORICURVE is off before the transformation is.
#[test]
fn a_second_curve_ends_before_the_transformation() {
    for case in ["catia-second-curve", "creo-second-curve"] {
        let text = std::fs::read_to_string(folder("fixtures/apt").join(case).join("sinumerik.mpf"))
            .expect("a program");
        let mut second = false;
        for line in lines(&text) {
            second = (second || line == "ORICURVE") && line != "ORIVECT";
            assert!(!(second && ["TRAFOOF", "M30"].contains(&line)), "{case}");
        }
        assert!(text.contains("ORICURVE"), "{case}");
    }
}

#[test]
fn names_of_devices_and_of_the_control_are_no_names() {
    let allowed = |machine: &str, name: &str| pass::check::name(name, &built_in(machine)).is_none();
    for name in ["CON", "con", "PRN", "Aux", "NUL", "COM1", "com9", "LPT1", "LPT9"] {
        assert!(!allowed("sinumerik", name) && !allowed("heidenhain", name), "{name}");
    }
    for name in ["CYCLE800", "cycle832", "CYCLE800_2", "_N_SHAFT", "_N_SHAFT_MPF", "SHAFT_MPF", "shaft_spf"] {
        assert!(!allowed("sinumerik", name), "{name}");
    }
    for name in ["CONE10", "CON1", "COM", "COM0", "COM10", "LPT", "AUXILIARY", "CYCLES", "MPF_SHAFT"] {
        assert!(allowed("sinumerik", name) && allowed("heidenhain", name), "{name}");
    }
}

fn ids(warnings: &Diagnostics) -> Vec<&'static str> {
    warnings.0.iter().map(|warning| warning.id).collect()
}

#[test]
fn a_number_that_nobody_chose_is_warned_of() {
    let cone = input("D1 = 10\nS = 30\nC = 5\nr = 8\nlength = 30", "");
    let mazak = built_in("mazak");
    let run = |text: &str, options: &Options| {
        let language =
            front::find(if text.starts_with("PARTNO") { "iso" } else { "cutter" }).expect("a language");
        compile(&sources(text), language, &mazak, options)
            .unwrap_or_else(|failure| panic!("{:?}", failure.diagnostics))
    };
    for text in [cone.as_str(), TWO_TOOLS] {
        let output = run(text, &Options::default());
        assert!(output.text.contains("\nO0001\n") && ids(&output.warnings).contains(&"number-unchosen"));
        let output = run(text, &Options { number: Some(1234), ..Options::default() });
        assert!(output.text.contains("\nO1234\n") && !ids(&output.warnings).contains(&"number-unchosen"));
    }
    let output = run(&format!("number = 1\n{cone}"), &Options::default());
    assert!(output.text.contains("\nO0001\n") && !ids(&output.warnings).contains(&"number-unchosen"));
    // Other controls have none; a program of one of them has none either, one of a Mazak keeps its own.
    let sinumerik = built_in("sinumerik");
    let other = program(TWO_TOOLS, &sinumerik);
    assert!(!ids(&other.warnings).contains(&"number-unchosen"));
    let from = |text: &str, machine: &Machine| {
        let sources = Sources::new(Source::new("program", text));
        recompile(&sources, machine, &mazak, &Options::default())
            .unwrap_or_else(|failure| panic!("{:?}", failure.diagnostics))
    };
    assert!(ids(&from(&other.text, &sinumerik).warnings).contains(&"number-unchosen"));
    let chosen = run(TWO_TOOLS, &Options { number: Some(77), ..Options::default() });
    let again = from(&chosen.text, &mazak);
    assert!(again.text.contains("\nO0077\n") && !ids(&again.warnings).contains(&"number-unchosen"));
}

/// Everything that a user may write into a remark, as each control takes it.
#[test]
fn remarks_have_letters_that_the_control_takes() {
    let cl = "PARTNO REMARKS\nUNITS/MM\nPPRINT Größe ((grob) fein) $5 50% don't!\nTPRINT/Fräser #6 ~\nLOADTL/1\n\
        SPINDL/2000,RPM,CLW\nRAPID\nGOTO/0,0,50\nFEDRAT/300,MMPM\nPPRINT second (op)\nGOTO/0,0,0\nRAPID\nGOTO/0,0,50\nFINI\n";
    let expected = [
        ["; Groesse [[grob] fein]", "; second [op]"],
        ["; GROESSE ((GROB) FEIN)", "; SECOND (OP)"],
        ["(GROESSE GROB FEIN 5 50PCT DONT.)", "(SECOND OP)"],
    ];
    for (name, expected) in NAMES.iter().zip(expected) {
        let machine = built_in(name);
        let text = program(cl, &machine).text;
        let all = lines(&text);
        for remark in expected {
            assert!(all.iter().any(|line| line.starts_with(remark)), "{name}: {remark}\n{text}");
        }
        for line in all.iter().filter(|line| line.starts_with(['(', ';'])) {
            let inside = line.trim_start_matches("; ");
            let inside = inside
                .strip_prefix('(')
                .and_then(|rest| rest.strip_suffix(')'))
                .filter(|_| *name == "mazak")
                .unwrap_or(inside);
            let taken = |c: char| {
                c.is_ascii_uppercase()
                    || c.is_ascii_digit()
                    || c == ' '
                    || machine.text.comment_signs.contains(c)
                    || (machine.text.comment_lower && c.is_ascii_lowercase())
            };
            assert!(inside.chars().all(taken), "{name}: {line}");
            assert!(*name != "mazak" || !inside.contains(['(', ')', '$', '!']), "{line}");
        }
    }
}

#[test]
fn setup_remarks_break_between_items_and_count_one_path() {
    let narrow = |name: &str| machine(&format!("extends = \"{name}\"\n[text]\ncomment_length = 40\n"));
    for name in NAMES {
        let text = text_of(&input("D1 = 10\nS = 30\nC = 5\nr = 8\nlength = 30", ""), &narrow(name));
        assert!(text.contains("TIME: 1 PATH OF"), "{text}");
        let remarks: Vec<&str> =
            lines(&text).into_iter().filter(|line| line.starts_with(['(', ';'])).collect();
        for line in &remarks {
            let end = line.trim_end_matches(')');
            let last = end.split(' ').next_back().unwrap_or_default();
            assert!(!["X", "Y", "Z", "A"].contains(&last), "{line} tears a name from its figure");
        }
    }
    let four = input("D1 = 10\nS = 30\nC = 5\nr = 8\nlength = 30\nflutes = 4", "");
    assert!(text_of(&four, &built_in("sinumerik")).contains("TIME: 4 PATHS OF"));
}

/// Where F counts X Y Z alone, MD22430 says what A may do where these hardly move.
#[test]
fn axes_beside_f_are_told() {
    let told = |text: &str| {
        text.replace("\n; ", " ").contains("F COUNTS X Y Z ALONE: MD22430 SAYS HOW FAST A MAY BE")
    };
    let cone = input("D1 = 10\nS = 30\nC = 5\nr = 8\nlength = 30", "");
    assert!(told(&text_of(&cone, &built_in("sinumerik"))));
    assert!(!told(&text_of(
        &cone,
        &machine("extends = \"sinumerik\"\n[feed]\nrotary = \"degrees-as-mm\"\n")
    )));
    assert!(!told(&text_of(&cone.replace("S = 30", "S = 0"), &built_in("sinumerik"))));
    assert!(!told(&program(TWO_TOOLS, &built_in("sinumerik")).text));
}

/// The numbers of a POLY block: X Y Z of fifth degree take 15, with A 20.
#[test]
fn poly_blocks_have_as_many_numbers_as_the_machine_takes() {
    let three = "name = \"QUINTIC\"\n[[curve]]\naxes = [\"X\", \"Y\", \"Z\"]\nkind = \"bezier\"\npoints = [[0, 0, 0], [12, 5, 1], [20, -4, 3], \
        [30, 6, -2], [44, -3, 1], [50, 2, 4]]\n[process]\nfeed = 300\nretract = { axis = \"Z\", to = 50 }\n";
    let most = |text: &str| {
        let numbers = |line: &str| {
            line.split(' ')
                .filter(|word| word.starts_with("PO["))
                .map(|word| word.matches(',').count() + 1)
                .sum::<usize>()
        };
        text.lines().map(numbers).max().unwrap_or(0)
    };
    let poly = built_in("sinumerik").dialect.motion("poly");
    let run = |text: &str, words: usize| {
        let machine = machine(&format!("extends = \"sinumerik\"\n[spline]\npoly_words = {words}\n"));
        compiled(text, &machine, poly)
    };
    assert_eq!(most(&run(three, 18).expect("it compiles").text), 15);
    let fewer = most(&run(three, 14).expect("it compiles").text);
    assert!(0 < fewer && fewer <= 9, "{fewer}");
    // Four axes of third degree take twelve, whatever is fitted.
    let four = "name = \"CUBIC\"\n[[curve]]\naxes = [\"X\", \"Y\", \"Z\", \"A\"]\nkind = \"bezier\"\npoints = [[0, 0, 0, 0], [12, 5, 1, 30], [20, -4, 3, 20], \
        [30, 6, -2, 70]]\n[process]\nfeed = 300\nretract = { axis = \"Z\", to = 50 }\n";
    assert_eq!(most(&run(four, 12).expect("it compiles").text), 12);
    let refused = run(four, 11).expect_err("a block has too many");
    assert!(refused.0.iter().any(|error| error.id == "words-too-many"), "{refused:?}");
}
