//! `splinepost simulate`: the path as a control would run it.

use super::io::{self, Console};
use super::subject::{Subject, Understood};
use clap::ValueEnum;
use splinepost::diagnostic::Diagnostics;
use splinepost::simulate::limits::Limits;
use splinepost::simulate::partition::{Law, Method};
use splinepost::simulate::rows::{self, Writer};
use splinepost::simulate::track::{Setting, Track};
use splinepost::simulate::{Options, simulate};
use splinepost::source::Sources;

/// Run a path cycle by cycle, as a control would: the next point is the one whose chord is feed times cycle
#[derive(clap::Args, Debug)]
pub(crate) struct Simulate {
    #[command(flatten)]
    subject: Subject,
    #[command(flatten)]
    law: LawArguments,
    /// How the rows are written to standard output
    #[arg(long, value_enum, default_value_t = Format::Csv, value_name = "FORMAT")]
    format: Format,
}

/// How a path is run.
#[derive(clap::Args, Debug)]
pub(super) struct LawArguments {
    /// The control cycle: 1ms, 500us, 0.001s; a number alone is ms
    #[arg(long, default_value = "1ms", value_name = "TIME", value_parser = cycle)]
    cycle: f64,
    /// mm/min, instead of every feed of the input
    #[arg(long, value_name = "F", value_parser = positive)]
    feed: Option<f64>,
    /// How the next point is found
    #[arg(long, value_enum, default_value_t = MethodName::Secant, value_name = "METHOD")]
    method: MethodName,
    /// The relative feed error below which a point is taken
    #[arg(long, default_value = "1e-8", value_name = "RELATIVE", value_parser = share)]
    feed_error: f64,
}

/// How the next point of a curve is found.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum MethodName {
    /// The interval is halved
    Bisection,
    /// The secant through the last two values, within the interval
    Secant,
    /// One first-order Taylor step, which the other two replace
    Taylor,
}

/// How rows are written.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Format {
    /// Comma-separated, in full precision
    Csv,
    /// One JSON array
    Json,
}

/// A number greater than zero.
fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if 0.0 < x && x.is_finite() => Ok(x),
        _ => Err("a number greater than zero is needed".to_owned()),
    }
}

/// A part of a whole: with an error of all of it a point may stay where it is, and no path ends.
fn share(text: &str) -> Result<f64, String> {
    match positive(text) {
        Ok(x) if x < 1.0 => Ok(x),
        _ => Err("a number greater than zero and below one is needed".to_owned()),
    }
}

/// A time in s, from `1ms`, `500us`, `0.001s` or a number of ms.
fn cycle(text: &str) -> Result<f64, String> {
    let units = [("ms", 1e3), ("us", 1e6), ("µs", 1e6), ("s", 1.0)];
    let (number, per_second) =
        units.iter().find_map(|(unit, per)| Some((text.strip_suffix(unit)?, *per))).unwrap_or((text, 1e3));
    match positive(number.trim()) {
        Ok(x) => Ok(x / per_second),
        Err(_) => Err("a time greater than zero is needed, as 1ms, 500us or 0.001s".to_owned()),
    }
}

/// What is run, and how.
pub(super) struct Run {
    /// The pieces.
    pub(super) track: Track,
    /// The law, the limits.
    pub(super) options: Options,
    /// What to know about the input.
    pub(super) warnings: Diagnostics,
}

impl LawArguments {
    /// The track of an input or a program, and how it is run. `radius` is where a program's rotary axes count, mm, where
    /// that is known.
    pub(super) fn run_of(
        &self,
        understood: &Understood,
        subject: &Subject,
        sources: &mut Sources,
        polygons: bool,
        radius: Option<f64>,
    ) -> Result<Run, Diagnostics> {
        let own;
        let (mut track, machine, tolerance, warnings) = match understood {
            Understood::Program(machine, reading) => {
                let tolerance = machine.tolerance;
                let setting =
                    Setting { machine: Some(machine), feed: self.feed, tolerance, radius, polygons };
                let track = Track::of_decimals(&reading.value.decimals, &setting)?;
                (track, Some(machine.as_ref()), tolerance, reading.warnings.clone())
            }
            Understood::Input(_, intent) => {
                own = subject.machine(sources)?;
                let stated = intent.tolerance.map(|(mm, _)| mm);
                let tolerance = stated.or(own.as_ref().map(|m| m.tolerance)).unwrap_or(0.001);
                let radius = intent.radius;
                let setting = Setting { machine: own.as_ref(), feed: self.feed, tolerance, radius, polygons };
                let track = Track::of_program(&intent.program, &setting)?;
                (track, own.as_ref(), tolerance, intent.warnings.clone())
            }
        };
        track.find_lines(sources);
        let limits = machine.map_or(Limits::NONE, |m| Limits::of(m, &track.axes, self.cycle));
        let method = match self.method {
            MethodName::Bisection => Method::Bisection,
            MethodName::Secant => Method::Secant,
            MethodName::Taylor => Method::Taylor,
        };
        let law = Law { method, cycle: self.cycle, tolerance: self.feed_error };
        let block_time = machine.and_then(|m| m.block_time);
        Ok(Run { track, options: Options { law, limits, block_time, tolerance }, warnings })
    }
}

/// Rows are written in portions of this many bytes.
const PORTION: usize = 1 << 16;

impl Simulate {
    /// Runs it.
    pub(crate) fn run(&self, console: &Console, sources: &mut Sources) -> Result<(), Diagnostics> {
        let understood = self.subject.understand(sources)?;
        let Run { track, options, warnings } =
            self.law.run_of(&understood, &self.subject, sources, false, None)?;
        let format = match self.format {
            Format::Csv => rows::Format::Csv,
            Format::Json => rows::Format::Json,
        };
        let mut writer = Writer::new(&track.axes, format);
        let mut text = writer.header();
        let mut failed = None;
        let summary = simulate(&track, &options, &mut |row| {
            writer.row(row, &mut text);
            if PORTION < text.len() && failed.is_none() {
                failed = io::print(&text).err();
                text.clear();
            }
        })?;
        if let Some(failed) = failed {
            return Err(failed);
        }
        text.push_str(writer.footer());
        io::print(&text)?;
        console.diagnostics(&warnings, sources);
        console.figures(&summary.render(&track.axes), &summary.to_json());
        Ok(())
    }
}
