//! `splinepost verify`: proof on a program that already exists.

use super::compile::{Reading, language};
use super::io::{self, Console};
use super::{MethodName, machine, tolerance};
use splinepost::Options;
use splinepost::diagnostic::Diagnostics;
use splinepost::source::Sources;
use splinepost::summary::Summary;

/// Prove that an existing program does what an input asks
#[derive(clap::Args, Debug)]
pub(crate) struct Verify {
    /// The program
    program: String,
    /// The input that it was made from
    #[arg(long, value_name = "INPUT")]
    against: String,
    /// The machine that it was written for
    #[arg(long, value_name = "MACHINE")]
    to: String,
    /// How curves are followed, instead of as the input says
    #[arg(long, value_enum, value_name = "METHOD")]
    method: Option<MethodName>,
    /// Tolerance in mm, instead of the input's or the machine's
    #[arg(long, value_name = "MM", value_parser = tolerance)]
    tolerance: Option<f64>,
    /// The program's number, instead of the input's
    #[arg(long, value_name = "NUMBER", value_parser = clap::value_parser!(u32).range(1..=9999))]
    number: Option<u32>,
    /// The input's language, where it cannot be told from its text
    #[arg(long, value_name = "LANGUAGE")]
    from: Option<String>,
    #[command(flatten)]
    reading: Reading,
}

impl Verify {
    /// Runs it.
    pub(crate) fn run(&self, console: &Console, sources: &mut Sources) -> Result<(), Diagnostics> {
        *sources = Sources::new(io::read_input(&self.against)?);
        self.reading.tell(sources)?;
        let program = io::read_source(&self.program)?;
        let text = program.text.clone();
        let id = sources.push(program);
        let machine = machine(&self.to, sources)?;
        let language = language(self.from.as_deref(), sources)?;
        let options = Options {
            method: self.method.map(Into::into),
            tolerance: self.tolerance,
            number: self.number,
            ..Options::default()
        };
        let verified = splinepost::verify_program(sources, language, id, &machine, &options)?;
        console.diagnostics(&verified.warnings, sources);
        let report = Some(&verified.report);
        let (intent, tolerance) = (&verified.intent, verified.tolerance);
        console.summary(&Summary::new(
            intent,
            &verified.machine,
            None,
            &text,
            report,
            tolerance,
            verified.report.setup.clone(),
        ));
        Ok(())
    }
}
