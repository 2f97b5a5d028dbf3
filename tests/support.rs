//! What several tests share: cutters, machines, compiling.

use splinepost::diagnostic::Diagnostics;
use splinepost::dialect::Motion;
use splinepost::machine::Machine;
use splinepost::source::{Source, SourceId, Sources};
use splinepost::summary::Summary;
use splinepost::{Options, Output, compile, front};
use std::path::{Path, PathBuf};

/// A folder of the project.
pub(crate) fn folder(path: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// Whether expected files are to be written anew: `SPLINEPOST_BLESS=1 cargo test`. Read what changed before committing.
pub(crate) fn bless() -> bool {
    std::env::var_os("SPLINEPOST_BLESS").is_some()
}

/// Cutters from the ordinary to the awkward, as lines of [cutter].
pub(crate) const CUTTERS: &[(&str, &str)] = &[
    ("paper", "D1 = 10\nS = 30\nC = 5\nr = 8\nlength = 30"),
    ("cylinder", "D1 = 10\nS = 30\nC = 0\nr = 8\nlength = 30"),
    ("reverse-taper", "D1 = 12\nS = 30\nC = -5\nr = 8\nlength = 20"),
    ("steep-cone", "D1 = 6\nS = 30\nC = 30\nr = 8\nlength = 12"),
    ("high-helix", "D1 = 10\nS = 60\nC = 5\nr = 8\nlength = 30"),
    ("straight-flute", "D1 = 10\nS = 0\nC = 5\nr = 8\nlength = 30"),
    ("small", "D1 = 0.5\nS = 30\nC = 5\nr = 8\nlength = 5"),
    ("long", "D1 = 10\nS = 30\nC = 5\nr = 8\nlength = 200"),
    ("six-flutes", "D1 = 10\nS = 30\nC = 5\nr = 8\nlength = 30\nflutes = 6"),
    ("left-hand", "D1 = 10\nS = 30\nC = 5\nr = 8\nlength = 30\nhand = \"left\""),
    ("constant-lead", "D1 = 10\nS = 30\nC = 5\nr = 8\nlength = 30\nlaw = \"constant-lead\""),
    ("no-rake", "D1 = 10\nS = 30\nC = 5\nr = 0\nlength = 30"),
];

/// A cutter file.
pub(crate) fn input(cutter: &str, interpolation: &str) -> String {
    format!(
        "name = \"CONE10\"\n[cutter]\n{cutter}\n[interpolation]\n{interpolation}\n\
         [process]\nfeed = 200\nretract = {{ axis = \"Z\", to = 500 }}\nspindle = 3000\n"
    )
}

/// The built-in machine of each dialect, with A in splines allowed.
pub(crate) fn machines() -> Vec<Machine> {
    let file = |name: &str| {
        format!("extends = \"{name}\"\nname = \"{name}\"\n[spline]\naxes = [\"X\", \"Y\", \"Z\", \"A\"]\n")
    };
    let mut machines: Vec<Machine> =
        splinepost::dialect::DIALECTS.iter().map(|d| machine(&file(d.name))).collect();
    machines.push(machine(&file("sinumerik-840d")));
    machines
}

/// The same, with one block a path where a fit needs no more, however much the speed varies inside it.
pub(crate) fn whole_path_machines() -> Vec<Machine> {
    machines().into_iter().map(|machine| Machine { feed_error: 10.0, ..machine }).collect()
}

/// A machine from its file.
pub(crate) fn machine(text: &str) -> Machine {
    Machine::parse(text, SourceId::INPUT).unwrap_or_else(|e| panic!("{e:?}"))
}

/// A place in X and Y where a tool is clear of the work, for a machine file: there a Mazak may end the length of a tool.
pub(crate) const PARK: &str = "[axis.X]\nhome = -500.0\n[axis.Y]\nhome = 0.0\n";

/// A built-in machine for programs of five axes.
pub(crate) fn five(name: &str) -> Machine {
    machine(&format!("extends = \"{name}\"\nname = \"{name}\"\n{}", if name == "mazak" { PARK } else { "" }))
}

/// The text as the only source.
pub(crate) fn sources(text: &str) -> Sources {
    Sources::new(Source::new("input.toml", text))
}

/// A text, and the files that it names in a folder, loaded as the command line does.
pub(crate) fn sources_in(name: &str, text: &str, folder: &Path) -> Sources {
    let source = Source::new(name, text);
    let names = front::detect(&source).map_or(Vec::new(), |language| (language.files)(&source));
    let mut sources = Sources::new(source);
    for name in names {
        let loaded = std::fs::read(folder.join(&name));
        sources.name(&name, loaded.map(|bytes| Source::decode(&name, bytes)).map_err(|e| e.to_string()));
    }
    sources
}

/// A text, and the files that it names, which are no files yet.
pub(crate) fn sources_with(text: &str, files: &[(&str, &str)]) -> Sources {
    let mut sources = sources(text);
    for (name, text) in files {
        sources.name(name, Ok(Source::new(*name, *text)));
    }
    sources
}

/// Whether a file beside a golden input is a program: neither a TOML file nor one that the input names.
pub(crate) fn is_program(path: &Path) -> bool {
    let name = path.display().to_string();
    path.extension().is_some_and(|extension| extension != "toml") && front::curves::format_of(&name).is_none()
}

/// Compiles an input of any language.
pub(crate) fn compiled(
    text: &str,
    machine: &Machine,
    motion: Option<&'static Motion>,
) -> Result<Output, Diagnostics> {
    compiled_from(&sources(text), machine, motion)
}

/// The same, with the files that the input names.
pub(crate) fn compiled_from(
    sources: &Sources,
    machine: &Machine,
    motion: Option<&'static Motion>,
) -> Result<Output, Diagnostics> {
    let options = Options { motion, ..Options::default() };
    let language = front::detect(sources.get(SourceId::INPUT).expect("an input"))?;
    compile(sources, language, machine, &options).map_err(|failure| failure.diagnostics)
}

/// The text and the JSON of a compilation's figures.
pub(crate) fn told(output: &Output) -> String {
    let summary = Summary::new(
        &output.intent,
        &output.machine,
        Some(output.motion.name),
        &output.text,
        output.report.as_ref(),
        output.tolerance,
        output.setup.clone(),
    );
    summary.render() + &summary.to_json()
}

/// Numbers that are none, as words.
pub(crate) fn no_number(text: &str) -> Option<&str> {
    let mut words = text.split(|c: char| !c.is_ascii_alphanumeric());
    words.find(|word| ["inf", "nan", "infinity"].iter().any(|none| word.eq_ignore_ascii_case(none)))
}

/// Compares with a file, or writes it where that is asked for.
pub(crate) fn compare(path: &Path, actual: &str, wrong: &mut Vec<String>) {
    let expected = std::fs::read(path).ok();
    if expected.as_deref() == Some(actual.as_bytes()) {
        return;
    }
    if bless() {
        std::fs::write(path, actual).expect("the fixture can be written");
        return;
    }
    let shown = path.strip_prefix(folder("")).unwrap_or(path).display().to_string();
    let Some(expected) = expected else {
        wrong.push(format!("{shown} is missing"));
        return;
    };
    let expected = String::from_utf8_lossy(&expected);
    let at = expected.lines().zip(actual.lines()).take_while(|(a, b)| a == b).count();
    let line = |text: &str| text.lines().nth(at).unwrap_or("(the end)").to_owned();
    wrong.push(format!(
        "{shown}:{} differs\n  expected {}\n  got      {}",
        at + 1,
        line(&expected),
        line(actual)
    ));
}

/// Fails with all that is wrong.
pub(crate) fn fail_on(wrong: &[String]) {
    assert!(
        wrong.is_empty(),
        "{}\n(SPLINEPOST_BLESS=1 writes expected files anew; read the difference before committing)",
        wrong.join("\n")
    );
}
