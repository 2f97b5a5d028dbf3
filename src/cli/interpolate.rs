//! `splinepost interpolate`: the point table, as the paper's Table 1.

use super::io::{self, Console};
use super::{MethodName, machine, tolerance};
use clap::ValueEnum;
use splinepost::diagnostic::{Diagnostic, Diagnostics};
use splinepost::front::cutter;
use splinepost::ir::{Intent, Method};
use splinepost::points::Table;
use splinepost::points::curves::Points;
use splinepost::source::{SourceId, Sources};

/// Print the interpolated points of a cutter's flute beside the theoretical curve, or those of a job's curves
#[derive(clap::Args, Debug)]
pub(crate) struct Interpolate {
    /// The input file, or - for standard input
    input: String,
    /// A machine whose tolerance decides the step, where neither the input nor the command line says
    #[arg(long, value_name = "MACHINE")]
    to: Option<String>,
    /// How the curve is followed
    #[arg(long, value_enum, value_name = "METHOD")]
    method: Option<MethodName>,
    /// Tolerance in mm, instead of the input's
    #[arg(long, value_name = "MM", value_parser = tolerance)]
    tolerance: Option<f64>,
    /// How the table is written to standard output
    #[arg(long, value_enum, default_value_t = Format::Text, value_name = "FORMAT")]
    format: Format,
}

/// How a table is written.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Format {
    /// As the paper prints it
    Text,
    /// Comma-separated, in full precision
    Csv,
    /// One JSON object
    Json,
}

impl Interpolate {
    /// Runs it.
    pub(crate) fn run(&self, console: &Console, sources: &mut Sources) -> Result<(), Diagnostics> {
        *sources = Sources::new(io::read_source(&self.input)?);
        let default = match &self.to {
            Some(to) => machine(to, sources)?.tolerance,
            None => 0.001,
        };
        let language = super::compile::language(None, sources)?;
        if language.name != "cutter" {
            let intent = (language.understand)(sources)?;
            return self.curves(console, sources, &intent, default);
        }
        let job = match sources.get(SourceId::INPUT) {
            Some(input) => cutter::parse(input, SourceId::INPUT)?,
            None => return Err(Diagnostics::new()),
        };
        let tolerance = self.tolerance.or(job.tolerance.map(|(mm, _)| mm)).unwrap_or(default);
        let Some(mut flute) = job.flutes.into_iter().next() else { return Err(Diagnostics::new()) };
        if let Some(method) = self.method {
            flute.method = Method::from(method);
        }
        let table = Table::new(&flute, tolerance).map_err(|error| {
            Diagnostic::refusal("points-too-many", error.to_string())
                .hint("allow a larger tolerance, or state dl")
        })?;
        io::print(&match self.format {
            Format::Text => table.to_text(),
            Format::Csv => table.to_csv(),
            Format::Json => table.to_json(),
        })?;
        console.remark(&table.summary());
        Ok(())
    }

    /// Points of any other curve.
    fn curves(
        &self,
        console: &Console,
        sources: &Sources,
        intent: &Intent,
        default: f64,
    ) -> Result<(), Diagnostics> {
        if let Some(MethodName::OddEven) = self.method {
            let message = "odd-even steps are those of a cutter's logarithmic curve";
            return Err(Diagnostic::error("method-of-cutters-only", message)
                .hint("--method direct gives as few points as hold the tolerance")
                .into());
        }
        let tolerance = self.tolerance.or(intent.tolerance.map(|(mm, _)| mm)).unwrap_or(default);
        let points = Points::new(intent, tolerance).map_err(|error| {
            Diagnostic::refusal("tolerance-out-of-reach", error.to_string()).hint("allow a larger tolerance")
        })?;
        io::print(&match self.format {
            Format::Text => points.to_text(),
            Format::Csv => points.to_csv(),
            Format::Json => points.to_json(),
        })?;
        console.diagnostics(&intent.warnings, sources);
        console.remark(&points.summary());
        Ok(())
    }
}
