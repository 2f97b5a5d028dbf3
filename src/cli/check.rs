//! `splinepost check`: is an input or a program sound?

use super::io::{self, Console};
use super::machine;
use splinepost::diagnostic::{Diagnostic, Diagnostics};
use splinepost::front::cutter;
use splinepost::pass;
use splinepost::source::{SourceId, Sources};

/// Check an input, or with --to and a program's text that a machine's reader understands it
#[derive(clap::Args, Debug)]
pub(crate) struct Check {
    /// The input file, or - for standard input
    input: String,
    /// A machine: the input is then an NC program for it, unless --from says otherwise
    #[arg(long, value_name = "MACHINE")]
    to: Option<String>,
    /// The input's language: cutter, or nc with --to
    #[arg(long, value_name = "LANGUAGE")]
    from: Option<String>,
}

impl Check {
    /// Runs it.
    pub(crate) fn run(&self, console: &Console, sources: &mut Sources) -> Result<(), Diagnostics> {
        *sources = Sources::new(io::read_source(&self.input)?);
        match program_or_input(self.from.as_deref(), self.to.as_deref(), sources)? {
            Kind::Program => {
                let machine = machine(self.to.as_deref().unwrap_or_default(), sources)?;
                let text = sources.get(SourceId::INPUT).map_or("", |source| source.text.as_str());
                let reading = (machine.dialect.read)(text, SourceId::INPUT, &machine)?;
                let legal = pass::check::check(reading.value.decimals, &machine)?;
                console.diagnostics(&reading.warnings, sources);
                console.diagnostics(&legal.warnings, sources);
            }
            Kind::Input => {
                let Some(input) = sources.get(SourceId::INPUT) else { return Err(Diagnostics::new()) };
                let job = cutter::parse(input, SourceId::INPUT)?;
                if job.process.feed.is_none() || job.process.retract.is_none() {
                    let note = Diagnostic::note(
                        "process-incomplete",
                        "a program would need feed and retract under [process]",
                    );
                    console.diagnostics(&note.into(), sources);
                }
            }
        }
        console.remark("no errors\n");
        Ok(())
    }
}

/// What an input is.
pub(super) enum Kind {
    Program,
    Input,
}

/// An NC program where `--from nc` says so, or where a machine is named and the text is no cutter.
pub(super) fn program_or_input(
    from: Option<&str>,
    to: Option<&str>,
    sources: &Sources,
) -> Result<Kind, Diagnostics> {
    let looks_like_input =
        sources.get(SourceId::INPUT).is_some_and(|input| splinepost::front::detect(input).is_ok());
    match (from, to) {
        (Some("nc"), Some(_)) => Ok(Kind::Program),
        (Some("nc"), None) => Err(Diagnostic::error(
            "machine-missing",
            "an NC program is read with the machine that --to names",
        )
        .into()),
        (None, Some(_)) if !looks_like_input => Ok(Kind::Program),
        _ => super::compile::language(from, sources).map(|_| Kind::Input),
    }
}
