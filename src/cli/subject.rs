//! What `check` and `dump` look at: an input, or a program with the machine that it was written for.

use super::compile::Reading as CommandReading;
use super::{io, machine};
use splinepost::diagnostic::{Diagnostic, Diagnostics, Warned};
use splinepost::dialect::Reading;
use splinepost::front::Language;
use splinepost::ir::Intent;
use splinepost::machine::Machine;
use splinepost::source::{SourceId, Sources};
use splinepost::translate;

/// A file, and how to read it.
#[derive(clap::Args, Debug)]
pub(super) struct Subject {
    /// The input file, or - for standard input
    input: String,
    /// A machine: the input is then an NC program for it, unless --from says otherwise
    #[arg(long, value_name = "MACHINE")]
    to: Option<String>,
    /// The input's language: cutter, job, apt, catia, creo, nx, solidworks, fusion, iso, or nc with --to
    #[arg(long, value_name = "LANGUAGE")]
    from: Option<String>,
    #[command(flatten)]
    reading: CommandReading,
}

/// A file that was understood.
pub(super) enum Understood {
    Program(Box<Machine>, Warned<Reading>),
    Input(&'static Language, Box<Intent>),
}

impl Subject {
    /// Reads it.
    pub(super) fn understand(&self, sources: &mut Sources) -> Result<Understood, Diagnostics> {
        *sources = Sources::new(io::read_input(&self.input)?);
        self.reading.tell(sources)?;
        if let Some(to) = self.machine_of_program(sources)?.map(ToOwned::to_owned) {
            let machine = machine(&to, sources)?;
            let text = sources.get(SourceId::INPUT).map_or("", |source| source.text.as_str());
            let machine = translate::machine_of(text, &machine);
            let reading = (machine.dialect.read)(text, SourceId::INPUT, &machine)?;
            return Ok(Understood::Program(Box::new(machine), reading));
        }
        let language = super::compile::language(self.from.as_deref(), sources)?;
        (language.understand)(sources).map(|intent| Understood::Input(language, Box::new(intent)))
    }

    /// Whether it is this file, one that it names, or its machine's.
    pub(super) fn is(&self, path: &str, sources: &Sources) -> bool {
        io::is_read(path, sources) || self.to.as_ref().is_some_and(|to| io::same_file(path, to))
    }

    /// The machine that --to names.
    pub(super) fn machine(&self, sources: &mut Sources) -> Result<Option<Machine>, Diagnostics> {
        self.to.as_deref().map(|to| machine(to, sources)).transpose()
    }

    /// The machine of an NC program: that is what the file is where `--from nc` says so, or where a machine is named and
    /// the text is in no language of inputs.
    fn machine_of_program(&self, sources: &mut Sources) -> Result<Option<&str>, Diagnostics> {
        let looks_like_input =
            sources.get(SourceId::INPUT).is_some_and(|input| splinepost::front::detect(input).is_ok());
        match (self.from.as_deref(), self.to.as_deref()) {
            (Some("nc"), Some(to)) => Ok(Some(to)),
            (Some("nc"), None) => Err(Diagnostic::error(
                "machine-missing",
                "an NC program is read with the machine that --to names",
            )
            .into()),
            (None, Some(to)) if !looks_like_input => Ok(Some(to)),
            (from, _) => super::compile::language(from, sources).map(|_| None),
        }
    }
}
