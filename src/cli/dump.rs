//! `splinepost dump`: what was understood.

use super::check::{Kind, program_or_input};
use super::io::{self, Console};
use super::machine;
use splinepost::diagnostic::Diagnostics;
use splinepost::dump;
use splinepost::front::cutter;
use splinepost::source::{SourceId, Sources};

/// Print what was understood of an input, or with --to of a program
#[derive(clap::Args, Debug)]
pub(crate) struct Dump {
    /// The input file, or - for standard input
    input: String,
    /// A machine: the input is then an NC program for it, unless --from says otherwise
    #[arg(long, value_name = "MACHINE")]
    to: Option<String>,
    /// The input's language: cutter, or nc with --to
    #[arg(long, value_name = "LANGUAGE")]
    from: Option<String>,
}

impl Dump {
    /// Runs it.
    pub(crate) fn run(&self, console: &Console, sources: &mut Sources) -> Result<(), Diagnostics> {
        *sources = Sources::new(io::read_source(&self.input)?);
        match program_or_input(self.from.as_deref(), self.to.as_deref(), sources)? {
            Kind::Program => {
                let machine = machine(self.to.as_deref().unwrap_or_default(), sources)?;
                let text = sources.get(SourceId::INPUT).map_or("", |source| source.text.as_str());
                let reading = (machine.dialect.read)(text, SourceId::INPUT, &machine)?;
                console.diagnostics(&reading.warnings, sources);
                io::print(&dump::decimals(&reading.value.decimals))
            }
            Kind::Input => {
                let Some(input) = sources.get(SourceId::INPUT) else { return Err(Diagnostics::new()) };
                io::print(&dump::intent(&cutter::parse(input, SourceId::INPUT)?.intent()))
            }
        }
    }
}
