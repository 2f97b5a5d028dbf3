//! Programs of other posts and written by hand: each file of `fixtures/cases/nc` is read right, or refused where it says what is
//! not read. What each means is in the manuals that `docs/dialects/` names.

use crate::support::{folder, machine};
use splinepost::diagnostic::{Diagnostics, Severity};
use splinepost::diff::{self, Origin};
use splinepost::machine::Machine;
use splinepost::source::{LineColumn, Source, SourceId, Sources};
use splinepost::{Options, dump, recompile, translate};
use std::fs;

/// What is right for a file.
enum Right {
    /// It is read: the dump has these lines together, in this order.
    Read(&'static [&'static str]),
    /// It is refused first with this id, in this line, at this text.
    Refused(&'static str, usize, &'static str),
}
use Right::{Read, Refused};

const RIGHT: &[(&str, Right)] = &[
    ("r-arc-radius.eia", Refused("arc-center", 12, "R5.")),
    ("r-arc-radius.h", Refused("block-unknown", 24, "CR")),
    ("r-atrans.mpf", Refused("word-unknown", 15, "ATRANS")),
    ("r-axis-b.eia", Refused("axis-unknown", 12, "B30.")),
    ("r-blkform.h", Refused("block-unknown", 23, "BLK")),
    ("r-block-skip.eia", Refused("block-skip", 12, "/M8")),
    ("r-cycl200.h", Refused("block-unknown", 23, "CYCL")),
    ("r-cycle832.mpf", Refused("word-unknown", 14, "CYCLE832(0.01,1,1)")),
    // `D1` of line 15 begins the lines of a tilted plane in the machine file.
    ("r-d1-alone.mpf", Refused("frame-line", 16, "G1 X20")),
    ("r-footer-order.mpf", Refused("m-function", 18, "M30")),
    ("r-g20.eia", Refused("code-refused", 12, "G20")),
    ("r-g28.eia", Refused("code-refused", 13, "G91")),
    ("r-g41.eia", Refused("code-refused", 12, "G41")),
    // G49 may move Z by the length, and the tool is at the work.
    ("r-g49-alone.eia", Refused("tool-offset", 12, "G49")),
    ("r-g81.eia", Refused("word-unknown", 12, "G81")),
    ("r-g91.eia", Refused("code-refused", 12, "G91")),
    ("r-header-comment.eia", Read(&["    X 10.0 Y 0.0 Z 50.0 A 0.0", "rapid Z 50"])),
    ("r-ic.mpf", Refused("word-unreadable", 14, "X=IC(10)")),
    ("r-lower-case.mpf", Refused("word-unknown", 14, "g1")),
    ("r-m91.h", Refused("m-function", 23, "M91")),
    ("r-m98-any.eia", Refused("m-function", 12, "M98")),
    ("r-msg.mpf", Refused("word-unknown", 14, "MSG(\"A\")")),
    (
        "r-name.nc",
        Read(&[
            "rapid X 0 Y 0 Z 5",
            "cut feed 100 lines from X 0.0 Y 0.0 Z 5.0 A 0.0",
            "    X 0.0 Y 0.0 Z -1.0 A 0.0",
        ]),
    ),
    ("r-q.h", Refused("parameter", 24, "X+Q1")),
    ("r-rparam.mpf", Refused("word-unreadable", 15, "X=R1")),
    ("r-semicolon.eia", Refused("word-unreadable", 12, ";")),
    ("r-tool-spelling.eia", Refused("word-unknown", 12, "T02")),
    ("r-trailing-remark.eia", Read(&["coolant", "comment ON"])),
    ("third-party-fanuc-a.nc", Refused("header-differs", 3, "N10 G21 G17 G90 G40 G49 G80")),
    ("third-party-fanuc-b.nc", Refused("header-differs", 3, "N10 G21 G17 G90 G40 G49 G80")),
    ("w1-home-g0-as-g1.eia", Read(&["home Z", "cut feed 200 lines from X 10.0 Y 0.0 Z 50.0 A 0.0"])),
    ("w1-home-g0.eia", Read(&["home Z", "rapid X 50 Y 50 Z 50"])),
    // G0 of `G0 SUPA Z0 D0` is in force, and so is D0: Z50 would be without the length of the tool.
    ("w1-home-g0.mpf", Refused("tool-length", 17, "X50 Y50 Z50")),
    ("w2-trans-replaces.mpf", Read(&["shift X 10", "rapid X 10 Y 0", "shift Y 5 X 0", "rapid X 0 Y 5"])),
    ("w3-label-in-flow.h", Read(TWICE)),
    ("w3-label-in-flow.mpf", Read(TWICE)),
    ("w4-g54.nc", Read(&["rapid X 0 Y 0 Z 50"])),
    ("w4-g55.nc", Read(&["rapid X 0 Y 0 Z 50"])),
    ("w5-fgroup-x.mpf", Refused("fgroup-axes", 14, "FGROUP(X)")),
    ("w6-no-point.eia", Refused("point-missing", 12, "X10")),
];

/// The labelled section runs when it is passed, and again when it is called.
const TWICE: &[&str] = &[
    "cut feed 100 lines from X 0.0 Y 0.0 Z 50.0 A 0.0",
    "    X 10.0 Y 0.0 Z 50.0 A 0.0",
    "    X 0.0 Y 0.0 Z 50.0 A 0.0",
    "    X 10.0 Y 0.0 Z 50.0 A 0.0",
    "    X 0.0 Y 0.0 Z 50.0 A 0.0",
];

/// The Sinumerik that the files are for: its lines round a program.
const SINUMERIK: &str = "extends = \"sinumerik\"\nname = \"nc\"\n[program]\n\
    header = [\"; {name}\", \"G17 G40 G71 G90 G94\", \"MCALL\", \"TRAFOOF\", \"TRANS\", \"G54 G64 COMPOF\", \"FGROUP({linear})\"]\n\
    start = []\nfooter = [\"M5\", \"M9\", \"M30\"]\ncall = \"REPEAT FLUTE{label} FLUTE{label}_END\"\n";

/// The machine of a dialect that the files are for.
fn of(dialect: &str) -> Machine {
    if dialect == "sinumerik" { machine(SINUMERIK) } else { Machine::built_in(dialect).expect("a built-in") }
}

/// The machine that a file is for.
fn own(name: &str) -> Machine {
    of(match name.rsplit('.').next() {
        Some("mpf") => "sinumerik",
        Some("h") => "heidenhain",
        _ => "mazak",
    })
}

fn text(name: &str) -> String {
    fs::read_to_string(folder("fixtures/cases/nc").join(name)).expect("a file")
}

/// The steps of a text, or what is wrong with it.
fn dumped(text: &str, machine: &Machine) -> Result<String, Diagnostics> {
    let machine = translate::machine_of(text, machine);
    let reading = (machine.dialect.read)(text, SourceId::INPUT, &machine)?;
    Ok(dump::decimals(&reading.value.decimals))
}

/// The first error of a text: its id, its line and what stands there.
fn first(errors: &Diagnostics, text: &str) -> (&'static str, usize, String) {
    let error = errors.0.iter().find(|d| d.severity == Severity::Error).expect("an error");
    let span = error.span.expect("a place");
    let (start, end) = (span.start as usize, span.end as usize);
    (error.id, LineColumn::of(text, start).line, text[start..end].to_owned())
}

#[test]
fn each_program_has_its_right_answer() {
    let mut files: Vec<String> = fs::read_dir(folder("fixtures/cases/nc"))
        .expect("a folder")
        .map(|entry| entry.expect("a file").file_name().to_string_lossy().into_owned())
        .collect();
    files.sort();
    assert!(files.iter().eq(RIGHT.iter().map(|(name, _)| name)), "a file without an answer: {files:?}");
    for (name, right) in RIGHT {
        let text = text(name);
        match (right, dumped(&text, &own(name))) {
            (Read(lines), Ok(dump)) => {
                let wanted = lines.join("\n") + "\n";
                assert!(dump.contains(&wanted), "{name}: no\n{wanted}in\n{dump}");
            }
            (Refused(id, line, place), Err(errors)) => {
                let found = first(&errors, &text);
                assert_eq!((found.0, found.1, found.2.as_str()), (*id, *line, *place), "{name}");
            }
            (Read(_), Err(errors)) => panic!("{name}: {errors:?}"),
            (Refused(..), Ok(dump)) => panic!("{name} is read:\n{dump}"),
        }
    }
}

fn compared(a: &str, b: &str) -> diff::Comparison {
    let sources = |name: &str| Sources::new(Source::new(name, text(name)));
    let origin = |name: &str| Origin::Program(Box::new(own(name)));
    let options = diff::Options { tolerance: None, radius: None };
    diff::compare([&sources(a), &sources(b)], [&origin(a), &origin(b)], &options)
        .unwrap_or_else(|errors| panic!("{errors:?}"))
}

/// A rapid where the other program cuts, though neither block says which it is.
#[test]
fn what_a_line_of_the_machine_leaves_in_force_is_compared() {
    let found = compared("w1-home-g0.eia", "w1-home-g0-as-g1.eia");
    assert!(!found.figures.same);
    let first = &found.differences.0[0];
    assert!(first.message.contains("a rapid to X 50 Y 50 Z 50"), "{}", first.message);
}

#[test]
fn work_offsets_are_compared_and_kept() {
    let found = compared("w4-g54.nc", "w4-g55.nc");
    assert_eq!((found.figures.same, found.differences.0[0].id), (false, "work-offset-differs"));
    assert!(compared("w4-g55.nc", "w4-g55.nc").figures.same);
    let mazak = Machine::built_in("mazak").expect("a built-in");
    let header = "\"%\", \"O{number}\", \"({name})\", \"G17 G21 G40 G64 G80 G90 G94\", \"G55\"";
    let other = machine(&format!("extends = \"mazak\"\nname = \"g55\"\n[program]\nheader = [{header}]\n"));
    let compiled = |name: &str, to: &Machine| {
        let sources = Sources::new(Source::new(name, text(name)));
        recompile(&sources, &mazak, to, &Options::default()).map_err(|failure| failure.diagnostics)
    };
    let refused = |name: &str, to: &Machine| first(&compiled(name, to).expect_err("refused"), &text(name));
    assert_eq!(refused("w4-g55.nc", &mazak), ("work-offset", 2, "G55".to_owned()));
    assert_eq!(refused("w4-g54.nc", &other), ("work-offset", 2, "G54".to_owned()));
    for dialect in ["sinumerik", "heidenhain"] {
        let to = Machine::built_in(dialect).expect("a built-in");
        assert_eq!(refused("w4-g55.nc", &to).0, "work-offset");
    }
    let kept = |name, to: &Machine| match compiled(name, to) {
        Ok(output) => output.text,
        Err(errors) => panic!("{name}: {errors:?}"),
    };
    assert!(kept("w4-g55.nc", &other).contains("\nG55\n"));
    assert!(kept("w4-g54.nc", &mazak).contains("\nG54\n"));
}

/// X10 is 10 mm or 0.010 mm, and the machine file says which.
#[test]
fn a_number_without_a_point_is_what_the_machine_file_says() {
    let text = text("w6-no-point.eia");
    for (one, x) in [("1.0", "10.0"), ("0.001", "0.01"), ("0.0001", "0.001")] {
        let machine = machine(&format!("extends = \"mazak\"\nname = \"m\"\n[text]\nwithout_point = {one}\n"));
        let dump = dumped(&text, &machine).expect("it reads");
        assert!(dump.contains(&format!("    X {x} Y 0.0 Z 50.0 A 0.0\n")), "{one}: {dump}");
    }
    let ids = |file: &str| -> Vec<&'static str> {
        let read = Machine::parse(file, SourceId::INPUT);
        read.err().unwrap_or_default().0.iter().map(|d| d.id).collect()
    };
    assert_eq!(ids("extends = \"mazak\"\n[text]\npoint_always = false\n"), ["point-always"]);
    assert_eq!(
        ids("extends = \"mazak\"\n[text]\npoint_always = false\nwithout_point = 0.001\n"),
        ["point-always"]
    );
    assert!(ids("extends = \"mazak\"\n[text]\npoint_always = false\nwithout_point = 1.0\n").is_empty());
    assert_eq!(ids("extends = \"mazak\"\n[text]\nwithout_point = 0.003\n"), ["without-point"]);
    assert_eq!(ids("extends = \"sinumerik\"\n[text]\nwithout_point = 1.0\n"), ["without-point"]);
}

/// A program of these lines behind the machine's own header, tool call and approach, before its footer.
fn within(dialect: &str, lines: &str) -> String {
    match dialect {
        "mazak" => text("w6-no-point.eia").replace("G1 X10 F100\n", lines),
        "sinumerik" => text("w5-fgroup-x.mpf").replace("FGROUP(X)\nG1 X10 Y50 F100\n", lines),
        _ => text("r-q.h").replace("FN 0: Q1=+10\nL X+Q1 F100\n", lines),
    }
}

fn problem(dialect: &str, lines: &str) -> (&'static str, String) {
    let text = within(dialect, lines);
    match dumped(&text, &of(dialect)) {
        Ok(dump) => ("read", dump),
        Err(errors) => {
            let (id, _, place) = first(&errors, &text);
            (id, place)
        }
    }
}

/// Words that were read and dropped, and words that say two things at once.
#[test]
fn nothing_is_taken_in_silence() {
    let refused = [
        ("mazak", "G17 G18 G1 X1. F9.\n", "codes-conflict", "G18"),
        ("mazak", "G90 G91 G1 X1. F9.\n", "codes-conflict", "G91"),
        ("mazak", "G64 G61.1\n", "codes-conflict", "G61.1"),
        // LinuxCNC has no motion behind G80, a Fanuc the one of a parameter.
        ("mazak", "G1 X1. F9.\nG80\nX5.\n", "motion-missing", "X5."),
        ("mazak", "O0002\nG1 X1. F9.\n", "program-start", "O0002"),
        ("mazak", "%\nG1 X1. F9.\n", "text-after-end", "G1 X1. F9."),
        ("mazak", "G68.2 X0. Y0. Z0. I10. J0. K0.\nG53.1\nG69 G0 X5.\n", "plane", "G69"),
        (
            "mazak",
            "G52 X5.\nG68.2 X0. Y0. Z0. I10. J0. K0.\nG53.1\n",
            "offset-tilted",
            "G68.2 X0. Y0. Z0. I10. J0. K0.",
        ),
        ("sinumerik", "G0 G1 X1 F9\n", "codes-conflict", "G1"),
        ("sinumerik", "POLY G1 X1 F9\n", "codes-conflict", "G1"),
        ("sinumerik", "G17 G19 G1 X1 F9\n", "codes-conflict", "G19"),
        ("sinumerik", "G1 X1 F9 F8\n", "word-twice", "F8"),
        ("sinumerik", "G2 X1 Y0 I5 I6 J0 F9\n", "word-twice", "I6"),
        ("sinumerik", "TRANS G0 X1\n", "shift-alone", "TRANS G0 X1"),
        ("sinumerik", "G55\n", "code-refused", "G55"),
        ("sinumerik", "S-3000 M3\n", "word-unknown", "S-3000"),
        ("heidenhain", "CC X+5 Y+0\nC X+10 Y+0 DR+ DR- F9\n", "word-twice", "DR-"),
        ("heidenhain", "L X+1 RL F9\n", "compensation", "RL"),
    ];
    for (dialect, lines, id, place) in refused {
        let found = problem(dialect, lines);
        assert_eq!((found.0, found.1.as_str()), (id, place), "{dialect}: {lines}");
    }
}

/// A transformation may end the shift before it.
#[test]
fn no_shift_stands_where_the_tip_is_led() {
    let text = within("sinumerik", "TRANS X5\nTRAORI\nG54\nORIWKS ORIVECT\n").replace("\nA0\n", "\n");
    let errors = dumped(&text, &of("sinumerik")).expect_err("refused");
    let (id, _, place) = first(&errors, &text);
    assert_eq!((id, place.as_str()), ("offset-transformed", "TRAORI"));
}

/// Behind a retraction the centre of an arc counts from nowhere.
#[test]
fn an_arc_starts_from_a_place_that_the_text_says() {
    let text = "G21 G90 G17 G94\nG0 X0. Y0. Z0. A0.\nG49\nG0 G53 Z0.\nG19 G2 Y0. Z6. K3. F9.\nG0 Z5.\n";
    let machine = Machine::built_in("mazak").expect("a built-in");
    let errors = dumped(text, &machine).expect_err("refused");
    assert_eq!(first(&errors, text), ("place-unknown", 5, "G19 G2 Y0. Z6. K3. F9.".to_owned()));
    let known = text.replace("G19 G2", "G0 Z0.\nG19 G2");
    assert!(dumped(&known, &machine).expect("it reads").contains("about [0.0, 3.0]"));
}

/// Behind the end of the program nothing is a move, whatever it begins with.
#[test]
fn no_move_stands_behind_the_end() {
    for (dialect, end, line) in [
        ("mazak", "M30\n", "X500.\n"),
        ("sinumerik", "M30\n", "X500\n"),
        ("heidenhain", "M30\n", "L X+500 F9\n"),
        ("mazak", "%\n", "X500.\n"),
        ("heidenhain", "END PGM T MM\n", "L X+500 F9\n"),
    ] {
        let text = within(dialect, "");
        let at = text.rfind(end).expect("an end") + end.len();
        let text = format!("{}{line}{}", &text[..at], &text[at..]);
        let errors = dumped(&text, &of(dialect)).expect_err("refused");
        let id = first(&errors, &text).0;
        assert!(["text-after-end", "footer-differs"].contains(&id), "{dialect} {end}: {id}");
    }
}

/// What holds behind a line of the machine file is what that line left in force.
#[test]
fn lines_of_the_machine_are_read_as_far_as_they_hold() {
    let read = |dialect: &str, program: &str, lines: &str| {
        let own =
            if dialect == "sinumerik" { SINUMERIK } else { "extends = \"mazak\"\nname = \"m\"\n[program]\n" };
        dumped(&within(dialect, lines), &machine(&format!("{own}{program}\n")))
    };
    let id = |found: Result<String, Diagnostics>| match found {
        Ok(dump) => panic!("{dump}"),
        Err(errors) => errors.0.iter().find(|d| d.severity == Severity::Error).expect("an error").id,
    };
    // A coolant that moves: where X is then nobody knows, and an arc needs it.
    let moved = read("mazak", "coolant = [\"M8\", \"G0 X900.\"]", "G1 X1. F9.\nM8\nG0 X900.\nY5.\n")
        .expect("it reads");
    assert!(moved.contains("coolant\nrapid Y 5\n"), "{moved}");
    // A feed of the machine's own lines is not the path's.
    let fed = read("mazak", "coolant = [\"M8 F500.\"]", "G1 X1. F9.\nM8 F500.\nX5.\n").expect("it reads");
    assert!(fed.contains("coolant\ncut lines") || fed.contains("coolant\ncut feed none"), "{fed}");
    // A retraction at feed leaves G1.
    let slow =
        read("sinumerik", "home = [\"G1 SUPA {home}\"]", "G0 X1\nG1 SUPA Z0\nX5 Y0 Z5\n").expect("it reads");
    assert!(slow.contains("home Z\ncut"), "{slow}");
    for (dialect, program) in
        [("sinumerik", "shift = [\"ATRANS {words}\"]"), ("mazak", "shift = [\"G92 {words}\"]")]
    {
        let file = format!("extends = \"{dialect}\"\nname = \"m\"\n[program]\n{program}\n");
        assert_eq!(Machine::parse(&file, SourceId::INPUT).expect_err("refused").0[0].id, "shift-adds");
    }
    for (dialect, program) in [
        ("sinumerik", "tool = [\"T{tool}\", \"M6\", \"D1 G41\"]"),
        ("mazak", "stop = [\"M0 G68\"]"),
        ("heidenhain", "stop = [\"M0 M126\"]"),
    ] {
        let file = format!("extends = \"{dialect}\"\nname = \"m\"\n[program]\n{program}\n");
        assert_eq!(Machine::parse(&file, SourceId::INPUT).expect_err("refused").0[0].id, "mode-not-granted");
    }
    assert_eq!(id(read("sinumerik", "coolant = [\"FGROUP(X)\", \"M8\"]", "FGROUP(X)\nM8\n")), "fgroup-axes");
}

/// G61.1 and G5 P2 make another path of the same words, and another control has other words for it.
#[test]
fn what_says_how_exactly_the_control_runs_is_not_lost() {
    let compiled = |dialect: &str, lines: &str, to: &str| {
        // A Sinumerik has no name of one letter.
        let text = within(dialect, lines)
            .replace("(T)", "(TEST)")
            .replace("PGM T MM", "PGM TEST MM")
            .replace("; T\n", "; TEST\n");
        let [from, to] = [dialect, to].map(of);
        let sources = Sources::new(Source::new("p", text.as_str()));
        recompile(&sources, &from, &to, &Options::default())
            .map(|output| output.text)
            .map_err(|failure| first(&failure.diagnostics, &text))
    };
    for (dialect, line, to) in [
        ("mazak", "G61.1", "sinumerik"),
        ("mazak", "G05 P2", "heidenhain"),
        ("mazak", "G05.1 Q1", "mazak"),
        ("mazak", "G61", "mazak"),
        ("sinumerik", "G60", "mazak"),
        ("sinumerik", "SOFT", "heidenhain"),
    ] {
        let point = if dialect == "mazak" { "." } else { "" };
        let lines = format!("{line}\nG1 X10{point} F100{point}\n");
        let (id, number, _) = compiled(dialect, &lines, to).expect_err("refused");
        assert_eq!((id, number), ("running-lost", if dialect == "mazak" { 12 } else { 14 }), "{line}");
    }
    // What holds anyway is not lost.
    let text =
        compiled("mazak", "G64\nG1 X10. F100. (TO THE END)\nG05 P0\n", "sinumerik").expect("it compiles");
    assert!(text.contains("TO THE END"), "{text}");
    let text = compiled("sinumerik", "G64\nG1 X10 F100 ; TO THE END\n", "heidenhain").expect("it compiles");
    assert!(text.contains("TO THE END"), "{text}");
    let text = compiled("heidenhain", "L X+10 F100 ; TO THE END\n", "mazak").expect("it compiles");
    assert!(text.contains("TO THE END"), "{text}");
}
