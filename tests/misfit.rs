//! Arcs whose end is not on their circle: what is read, warned of and refused; and that no program of our own is.

use crate::support::machine;
use splinepost::diagnostic::{Diagnostics, Severity};
use splinepost::geom::elementary::{cos, sin};
use splinepost::machine::Machine;
use splinepost::source::{Source, SourceId, Sources};
use splinepost::{Options, recompile};

/// A quarter of a circle of radius 5 about (20, 5), which should end at (20, 10): in each dialect, with its end for `{y}`.
const QUARTERS: [(&str, &str); 3] = [
    ("sinumerik", "G0 X15 Y5 Z0\nG1 Z-1 F100\nG2 X20 Y{y} I5 J0\n"),
    (
        "heidenhain",
        "L Z+0 R0 FMAX\nL X+15 R0 FMAX\nL Y+5 R0 FMAX\nL Z-1 F100\nCC X+20 Y+5\nC X+20 Y+{y} DR-\n",
    ),
    ("mazak", "G0 X15. Y5. Z0.\nG1 Z-1. F100.\nG2 X20. Y{y} I5. J0.\n"),
];

/// What reading a text tells: ids and severities.
fn told(name: &str, text: &str) -> Vec<(&'static str, Severity)> {
    let machine = Machine::built_in(name).expect("a machine");
    let machine =
        Machine { frame: splinepost::machine::Frame { header: Vec::new(), ..machine.frame }, ..machine };
    let diagnostics = match (machine.dialect.read)(text, SourceId::INPUT, &machine) {
        Ok(read) => read.warnings,
        Err(errors) => errors,
    };
    let arcs = diagnostics.0.iter().filter(|d| d.id != "start-unknown");
    arcs.map(|d| (d.id, d.severity)).collect()
}

#[test]
fn an_end_beside_its_circle_is_warned_of_or_refused() {
    // Three decimals explain 4 · √2 · 0.0005 = 0.002828… mm, and 0.01 mm is the most that is read.
    let cases = [
        ("10.0028", None),
        ("9.9972", None),
        ("10.0029", Some(Severity::Warning)),
        ("9.9971", Some(Severity::Warning)),
        ("10.0099", Some(Severity::Warning)),
        ("10.0101", Some(Severity::Error)),
        ("9.9899", Some(Severity::Error)),
        ("12.0", Some(Severity::Error)),
    ];
    for (name, text) in QUARTERS {
        for (y, severity) in cases {
            let expected: Vec<_> = severity.into_iter().map(|severity| ("arc-misfit", severity)).collect();
            assert_eq!(told(name, &text.replace("{y}", y)), expected, "{name}: {y}");
        }
    }
}

#[test]
fn many_of_them_are_one_warning_about_the_worst() {
    // More than a reader tells of before it gives up.
    let arc = |i: u32| {
        let y = if i == 77 { "10.005" } else { "10.004" };
        format!("G1 X15. Y5.\nG2 X20. Y{y} I5. J0.\n")
    };
    let text = "G0 X15. Y5. Z0.\nG1 Z-1. F100.\n".to_owned() + &(0..200).map(arc).collect::<String>();
    let machine = Machine::built_in("mazak").expect("a machine");
    let read = (machine.dialect.read)(&text, SourceId::INPUT, &machine).expect("it is read");
    let misfits: Vec<_> = read.warnings.0.iter().filter(|d| d.id == "arc-misfit").collect();
    let [misfit] = misfits[..] else { panic!("{misfits:?}") };
    assert!(misfit.message.contains("200 arcs") && misfit.message.contains("0.0050"), "{}", misfit.message);
    let place = misfit.span.expect("a place");
    assert!(text[place.start as usize..place.end as usize].contains("10.005"));
}

#[test]
fn the_block_of_the_input_is_blamed_when_it_is_translated() {
    let from = Machine::built_in("mazak").expect("a machine");
    let good =
        std::fs::read_to_string(crate::support::folder("fixtures/apt/catia-arcs/mazak.eia")).expect("it");
    let bad = good.replace("G2 X20. Y10. I5. J0.", "G2 X22. Y10. I5. J0.");
    assert_ne!(good, bad);
    for to in ["sinumerik", "heidenhain", "mazak"] {
        let to = Machine::built_in(to).expect("a machine");
        let translated = |text: &str| -> Result<String, Diagnostics> {
            let sources = Sources::new(Source::new("part.eia", text));
            let output = recompile(&sources, &from, &to, &Options::default());
            output.map(|output| output.text).map_err(|failure| failure.diagnostics)
        };
        assert!(translated(&good).is_ok());
        let errors = translated(&bad).expect_err("no circle");
        let first = &errors.0[0];
        assert_eq!(first.id, "arc-misfit");
        let place = first.span.expect("a place");
        assert_eq!(&bad[place.start as usize..place.end as usize], "G2 X22. Y10. I5. J0.");
    }
}

/// Arcs of all radii and angles from six decimals to as few as two, where rounding alone makes a misfit of up to 0.028 mm.
#[test]
fn what_is_written_is_never_refused() {
    let from = machine("extends = \"sinumerik\"\nname = \"from\"\n");
    let header: Vec<String> =
        ["; AB", "G17 G40 G710 G90 G94", "MCALL", "TRAFOOF", "TRANS", "G54 G64 COMPOF", "FGROUP(X,Y,Z)"]
            .map(str::to_owned)
            .to_vec();
    let mut lines = header;
    lines.push("G0 X0 Y0 Z0".to_owned());
    lines.push("G1 Z-1 F1000".to_owned());
    for i in 0..60 {
        let i = f64::from(i);
        let (radius, angle, sweep) = (0.7 + 1.37 * i, 0.7 * i, 0.2 + 0.1 * i % 6.0);
        let (x, y) = (10.0 * sin(1.3 * i), 10.0 * cos(1.7 * i));
        let at = |angle: f64| (x + radius * cos(angle), y + radius * sin(angle));
        let ((sx, sy), (ex, ey)) = (at(angle), at(angle + sweep));
        lines.push(format!("G1 X{sx:.6} Y{sy:.6}"));
        lines.push(format!("G3 X{ex:.6} Y{ey:.6} I{:.6} J{:.6}", x - sx, y - sy));
    }
    lines.extend(["G0 Z50", "M5", "M9", "FGROUP()", "SPATH", "M30"].map(str::to_owned));
    let text = lines.join("\n") + "\n";
    for name in ["sinumerik", "heidenhain", "mazak"] {
        for digits in [2, 3, 4] {
            let to = machine(&format!("extends = \"{name}\"\nname = \"to\"\n[digits]\nlinear = {digits}\n"));
            let sources = Sources::new(Source::new("part.mpf", text.as_str()));
            let options = Options { tolerance: Some(0.1), ..Options::default() };
            let output = recompile(&sources, &from, &to, &options);
            let output = output.unwrap_or_else(|f| panic!("{name}, {digits}: {:?}", f.diagnostics));
            let arcs =
                output.text.lines().filter(|line| line.contains("G3 X") || line.contains("C X")).count();
            assert!(50 < arcs, "{name}, {digits}: {arcs}");
            let again = (output.machine.dialect.read)(&output.text, SourceId::PROGRAM, &output.machine);
            let again = again.expect("it is read");
            assert!(digits < 3 || again.warnings.0.iter().all(|d| d.id != "arc-misfit"), "{name}, {digits}");
        }
    }
}
