//! `splinepost compile`: the job.

use super::io::{self, Console};
use super::{MethodName, machine, motion, tolerance};
use splinepost::diagnostic::Diagnostics;
use splinepost::front::{self, Language};
use splinepost::machine::Machine;
use splinepost::source::{Encoding, Source, SourceId, Sources};
use splinepost::summary::Summary;
use splinepost::{Options, diagnostic::Diagnostic};

/// Compile an input to an NC program, read it back and prove it
#[derive(clap::Args, Debug)]
pub(crate) struct Compile {
    /// The input file, or - for standard input
    input: String,
    /// A built-in machine (see `splinepost machines`) or a machine file
    #[arg(long, value_name = "MACHINE")]
    to: String,
    /// Write to this file instead of standard output (-)
    #[arg(short, long, value_name = "FILE")]
    output: Option<String>,
    /// The motion for cutting pieces: auto, or one of the dialect's
    #[arg(long, value_name = "MOTION")]
    motion: Option<String>,
    /// How curves are followed
    #[arg(long, value_enum, value_name = "METHOD")]
    method: Option<MethodName>,
    /// Tolerance in mm, instead of the input's or the machine's
    #[arg(long, value_name = "MM", value_parser = tolerance)]
    tolerance: Option<f64>,
    /// The program's number, where the control wants one, instead of the input's
    #[arg(long, value_name = "NUMBER", value_parser = clap::value_parser!(u32).range(1..=9999))]
    number: Option<u32>,
    /// The input's language, where it cannot be told from its text; or the machine that it is an NC program for
    #[arg(long, value_name = "LANGUAGE|MACHINE")]
    from: Option<String>,
    /// Write to this file, or standard output (-), which lines of the input each block came from (JSON)
    #[arg(long, value_name = "FILE", conflicts_with = "no_verify")]
    map: Option<String>,
    #[command(flatten)]
    reading: Reading,
    /// Make splines of runs of short lines, within the tolerance of them and with their corners
    #[arg(long)]
    fit: bool,
    /// With --fit: a turn by more degrees than this is a corner, and kept [default: 25]
    #[arg(long, value_name = "DEGREES", requires = "fit", value_parser = corner)]
    corner: Option<f64>,
    /// Write the program without its proof, and say so in it
    #[arg(long)]
    no_verify: bool,
}

impl Compile {
    /// Runs it.
    pub(crate) fn run(&self, console: &Console, sources: &mut Sources) -> Result<(), Diagnostics> {
        *sources = Sources::new(io::read_input(&self.input)?);
        self.reading.tell(sources)?;
        let machine = machine(&self.to, sources)?;
        let written_for = self.machine_of_input(sources)?;
        let known = match written_for {
            Some(_) => None,
            None => Some(language(self.from.as_deref(), sources)?),
        };
        self.outputs_are_free(sources)?;
        let options = Options {
            motion: motion(self.motion.as_deref(), &machine)?,
            method: self.method.map(Into::into),
            tolerance: self.tolerance,
            number: self.number,
            no_verify: self.no_verify,
            fit: self.fit,
            corner: self.corner,
        };
        // `--motion auto` overrules the machine's own choice.
        let mut machine = machine;
        if self.motion.as_deref() == Some("auto") {
            machine.motion = None;
        }
        let compiled = match (&written_for, known) {
            (Some(from), _) => splinepost::recompile(sources, from, &machine, &options),
            (None, Some(language)) => splinepost::compile(sources, language, &machine, &options),
            (None, None) => Err(Diagnostics::new().into()),
        };
        let output = compiled.map_err(|failure| {
            sources.program = failure.program;
            failure.diagnostics
        })?;
        let machine = output.machine;
        let mut files = vec![(self.output.as_deref().unwrap_or("-"), output.text.as_str())];
        let map;
        if let (Some(path), Some(report)) = (&self.map, &output.report) {
            let reading = (machine.dialect.read)(&output.text, SourceId::PROGRAM, &machine)?.value;
            map = splinepost::map::json(&output.intent, report, &reading, &output.text, sources);
            files.push((path, &map));
        }
        io::write_files(&files)?;
        console.diagnostics(&output.warnings, sources);
        console.summary(&Summary::new(
            &output.intent,
            &machine,
            Some(output.motion.name),
            &output.text,
            output.report.as_ref(),
            output.tolerance,
            output.setup,
        ));
        Ok(())
    }
}

impl Compile {
    /// Whether both outputs are files of their own.
    fn outputs_are_free(&self, sources: &Sources) -> Result<(), Diagnostics> {
        let output = self.output.as_deref();
        for path in output.into_iter().chain(self.map.as_deref()) {
            if io::is_read(path, sources) || io::same_file(path, &self.to) {
                let message = format!("{path} is what is read; it is not written over");
                return Err(Diagnostic::error("output-is-input", message).into());
            }
        }
        let output = output.unwrap_or("-");
        match self.map.as_deref() {
            Some(map) if map == output || io::same_file(map, output) => {
                let message = match output {
                    "-" => "program and map would both go to standard output".to_owned(),
                    _ => format!("{map} cannot hold both the program and its map"),
                };
                Err(Diagnostic::error("outputs-are-one", message).into())
            }
            Some(_) | None => Ok(()),
        }
    }

    /// The machine that the input is an NC program for, where `--from` names one.
    fn machine_of_input(&self, sources: &mut Sources) -> Result<Option<Machine>, Diagnostics> {
        match &self.from {
            Some(name) if front::find(name).is_none() && is_machine(name) => machine(name, sources).map(Some),
            Some(_) | None => Ok(None),
        }
    }
}

/// Whether a name is that of a built-in machine, or of a file.
pub(super) fn is_machine(name: &str) -> bool {
    Machine::built_in(name).is_some() || std::path::Path::new(name).is_file()
}

/// The angle of a corner must be one.
fn corner(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if 0.0 < x && x < 180.0 => Ok(x),
        _ => Err("an angle above 0 and below 180 degrees is needed".to_owned()),
    }
}

/// The language that `--from` names, or that the input looks like; one that does not read Windows-1252 refuses it.
/// The files that the input names are loaded, so that a message about them can point into the input.
pub(super) fn language(from: Option<&str>, sources: &mut Sources) -> Result<&'static Language, Diagnostics> {
    let language = language_of(from, sources)?;
    io::load_named(language, sources);
    Ok(language)
}

fn language_of(from: Option<&str>, sources: &Sources) -> Result<&'static Language, Diagnostics> {
    let empty = Source::new("", "");
    let input = sources.get(SourceId::INPUT).unwrap_or(&empty);
    let language = match from {
        Some(name) => front::find(name).ok_or_else(|| {
            let names: Vec<&str> = front::LANGUAGES.iter().map(|language| language.name).collect();
            Diagnostic::error("language-unknown", format!("`{name}` is not a language")).hint(format!(
                "known are {}; `compile` takes a machine too, whose NC program the input is",
                names.join(", ")
            ))
        })?,
        None => front::detect(input)?,
    };
    if input.encoding == Encoding::Windows1252 && !language.windows_1252 {
        let line = input.text.lines().position(|line| !line.is_ascii()).unwrap_or(0) + 1;
        return Err(io::not_utf8(&input.name, line));
    }
    Ok(language)
}

/// How CL data is read.
#[derive(clap::Args, Debug)]
pub(super) struct Reading {
    /// A table of words for CL data, beside the built-in ones (TOML: [words], [cycles], circle)
    #[arg(long, value_name = "FILE")]
    words: Option<String>,
    /// Leave out words of CL data that are not understood, with a warning
    #[arg(long)]
    lenient: bool,
    /// The unit of CL data that state none
    #[arg(long, value_name = "UNIT")]
    units: Option<Unit>,
}

/// Millimetres in an inch.
const MM_PER_INCH: f64 = 25.4;

/// A unit of length.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum Unit {
    /// Millimetres
    Mm,
    /// Inches
    Inches,
}

impl Reading {
    /// Tells it to whoever reads the sources.
    pub(super) fn tell(&self, sources: &mut Sources) -> Result<(), Diagnostics> {
        sources.lenient = self.lenient;
        sources.units = self.units.map(|unit| match unit {
            Unit::Mm => 1.0,
            Unit::Inches => MM_PER_INCH,
        });
        if let Some(path) = &self.words {
            let source = io::read_source(path)?;
            sources.words = Some(sources.push(source));
        }
        Ok(())
    }
}
