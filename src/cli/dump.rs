//! `splinepost dump`: what was understood.

use super::io::{self, Console};
use super::subject::{Subject, Understood};
use splinepost::diagnostic::Diagnostics;
use splinepost::dump;
use splinepost::source::Sources;

/// Print what was understood of an input, or with --to of a program
#[derive(clap::Args, Debug)]
pub(crate) struct Dump {
    #[command(flatten)]
    subject: Subject,
}

impl Dump {
    /// Runs it.
    pub(crate) fn run(&self, console: &Console, sources: &mut Sources) -> Result<(), Diagnostics> {
        match self.subject.understand(sources)? {
            Understood::Program(_, reading) => {
                console.diagnostics(&reading.warnings, sources);
                io::print(&dump::decimals(&reading.value.decimals))
            }
            Understood::Input(_, intent) => {
                console.diagnostics(&intent.warnings, sources);
                io::print(&dump::intent(&intent))
            }
        }
    }
}
