//! `splinepost plot`: pictures of a path.

use super::io::{self, Console};
use super::simulate::{LawArguments, Run};
use super::subject::{Subject, Understood};
use splinepost::Options;
use splinepost::diagnostic::{Diagnostic, Diagnostics};
use splinepost::front::Language;
use splinepost::ir::{Intent, Logarithmic};
use splinepost::machine::Machine;
use splinepost::plot::{Figure, deviation, page, paper, paths, profiles};
use splinepost::points::Table;
use splinepost::simulate::track::{Setting, Track};
use splinepost::source::{Source, SourceId, Sources};
use std::path::Path;

/// Draw a path: projections, rotary axes, control polygons, deviation, feed, acceleration and curvature
#[derive(clap::Args, Debug)]
pub(crate) struct Plot {
    #[command(flatten)]
    subject: Subject,
    #[command(flatten)]
    law: LawArguments,
    /// The file to write: .svg for one drawing, .html for one self-contained page
    #[arg(short, long, value_name = "FILE")]
    output: String,
    /// What an NC program is compared with
    #[arg(long, value_name = "INPUT")]
    against: Option<String>,
}

/// What a picture is written as.
#[derive(Clone, Copy)]
enum Kind {
    Svg,
    Html,
}

impl Plot {
    /// Runs it.
    pub(crate) fn run(&self, console: &Console, sources: &mut Sources) -> Result<(), Diagnostics> {
        let kind = self.kind()?;
        let understood = self.subject.understand(sources)?;
        if self.subject.is(&self.output, sources)
            || self.against.as_ref().is_some_and(|a| io::same_file(a, &self.output))
        {
            let message = format!("{} is what is read; it is not written over", self.output);
            return Err(Diagnostic::error("output-is-input", message).into());
        }
        let (program, intent) = match &understood {
            Understood::Program(..) => (None, self.reference(sources)?),
            Understood::Input(language, intent) => {
                if self.against.is_some() {
                    let message =
                        "--against is for NC programs; an input is compared with what --to makes of it";
                    return Err(Diagnostic::error("against-unused", message).into());
                }
                let machine = self.subject.machine(sources)?;
                let program = machine.map(|machine| compiled(sources, language, &machine)).transpose()?;
                (program, Some(intent.as_ref().clone()))
            }
        };
        // An input with --to is drawn as the program that is written for the machine.
        let mut told = Diagnostics::new();
        let understood = match program {
            Some((machine, text)) => {
                told.extend(intent.as_ref().map_or(Diagnostics::new(), |intent| intent.warnings.clone()));
                let reading = (machine.dialect.read)(&text, SourceId::PROGRAM, &machine)?;
                sources.program = Some(Source::new("the program written", text));
                Understood::Program(Box::new(machine), reading)
            }
            None => understood,
        };
        let radius = intent.as_ref().map(Intent::radius);
        let Run { track, options, warnings } =
            self.law.run_of(&understood, &self.subject, sources, true, radius)?;
        let machine = match &understood {
            Understood::Program(machine, _) => Some(machine.as_ref()),
            Understood::Input(..) => None,
        };
        let flute =
            intent.as_ref().and_then(|intent| intent.logarithmic().next()).map(|(log, ..)| log.clone());
        let mut figures = match &flute {
            Some(log) => traces(log, options.tolerance)?,
            None => Vec::new(),
        };
        for message in paths::left_out(&track) {
            told.push(Diagnostic::note("figure-left-out", message));
        }
        figures.extend(paths::figures(&track, flute.as_ref().map(|log| &log.curve)));
        if let (Some(intent), Understood::Program(..)) = (&intent, &understood) {
            let setting = Setting {
                machine,
                feed: Some(1.0),
                tolerance: options.tolerance,
                radius: intent.radius,
                polygons: false,
            };
            let reference = Track::of_program(&intent.program, &setting)?;
            match deviation::figure(&track, &reference, flute.as_ref().map(|log| &log.curve)) {
                Ok(figure) => figures.push(figure),
                Err(why) => {
                    let message = format!("the figure of the deviation is not drawn: {why}");
                    let hint = "`diff` and `verify` compare programs of other paths";
                    told.push(Diagnostic::warning("figure-left-out", message).hint(hint));
                }
            }
        }
        let (profiles, summary) = profiles::figures(&track, &options)?;
        figures.extend(profiles);
        let figured = summary.render(&track.axes);
        let text = drawn(kind, &figures, &figured, sources)?;
        io::write_file(&self.output, &text)?;
        console.diagnostics(&told, sources);
        console.diagnostics(&warnings, sources);
        console.remark(&format!("{}: {} figures\n{figured}", self.output, figures.len()));
        Ok(())
    }

    fn kind(&self) -> Result<Kind, Diagnostics> {
        match Path::new(&self.output)
            .extension()
            .and_then(|e| e.to_str())
            .map(str::to_ascii_lowercase)
            .as_deref()
        {
            Some("svg") => Ok(Kind::Svg),
            Some("html" | "htm") => Ok(Kind::Html),
            _ => Err(Diagnostic::error("output-kind", format!("{} is neither .svg nor .html", self.output))
                .hint("the extension says what is written: -o path.svg or -o path.html")
                .into()),
        }
    }

    /// The input that --against names.
    fn reference(&self, sources: &mut Sources) -> Result<Option<Intent>, Diagnostics> {
        let Some(path) = &self.against else { return Ok(None) };
        let source = io::read_source(path)?;
        let mut alone = Sources::new(source.clone());
        let parsed = super::compile::language(None, &mut alone).and_then(|language| (language.parse)(&alone));
        match parsed {
            Ok(intent) => {
                sources.push(source);
                Ok(Some(intent))
            }
            Err(errors) => {
                // What is wrong stands in the input and what it names.
                *sources = alone;
                Err(errors)
            }
        }
    }
}

/// Figures as the text of a file.
fn drawn(kind: Kind, figures: &[Figure], summary: &str, sources: &Sources) -> Result<String, Diagnostics> {
    // The name of the file, without where it stands.
    let input = sources.get(SourceId::INPUT).map_or("", |source| source.name.as_str());
    let name = Path::new(input).file_name().and_then(|name| name.to_str()).unwrap_or(input);
    let drawn = match kind {
        Kind::Svg => page::sheet(figures),
        Kind::Html => page::html(&format!("splinepost: {name}"), figures, summary),
    };
    drawn.map_err(|error| Diagnostic::error("figure-failed", error.to_string()).into())
}

/// The program that is written for a machine, and the machine as that wants it.
fn compiled(
    sources: &Sources,
    language: &Language,
    machine: &Machine,
) -> Result<(Machine, String), Diagnostics> {
    let output = splinepost::compile(sources, language, machine, &Options::default());
    output.map(|output| (output.machine, output.text)).map_err(|failure| failure.diagnostics)
}

/// The paper's figures of a flute: its odd-even points, or with the direct method the points of its chords.
fn traces(log: &Logarithmic, tolerance: f64) -> Result<Vec<Figure>, Diagnostics> {
    let table = Table::new(log, tolerance).map_err(|error| {
        Diagnostic::refusal("points-too-many", error.to_string())
            .hint("allow a larger tolerance, or state dl")
    })?;
    Ok(paper::figures(&table, &log.curve))
}
