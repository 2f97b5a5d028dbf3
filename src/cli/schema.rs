//! `splinepost schema`: JSON Schema of the TOML files, for editors.

use super::io::{self, Console};
use clap::ValueEnum;
use splinepost::diagnostic::Diagnostics;
use splinepost::{front, machine};

/// Print the JSON Schema of an input or of a machine file, for editors that complete and check TOML
#[derive(clap::Args, Debug)]
pub(crate) struct Schema {
    /// Of which file
    #[arg(value_enum)]
    file: File,
}

/// The files that have a schema.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum File {
    /// A conical cutter
    Cutter,
    /// Curves, with feed and tool
    Job,
    /// A machine
    Machine,
}

impl Schema {
    /// Runs it.
    pub(crate) fn run(&self, _console: &Console) -> Result<(), Diagnostics> {
        let schema = match self.file {
            File::Cutter => front::cutter::schema(),
            File::Job => front::job::schema(),
            File::Machine => machine::schema(),
        };
        io::print(&(serde_json::to_string_pretty(&schema).unwrap_or_default() + "\n"))
    }
}
