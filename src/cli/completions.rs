//! `splinepost completions`: for the shell.

use super::Arguments;
use super::io::{self, Console};
use clap::CommandFactory;
use splinepost::diagnostic::Diagnostics;

/// Print a completion script for a shell
#[derive(clap::Args, Debug)]
pub(crate) struct Completions {
    /// The shell
    shell: clap_complete::Shell,
}

impl Completions {
    /// Runs it.
    pub(crate) fn run(&self, _console: &Console) -> Result<(), Diagnostics> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut Arguments::command(), "splinepost", &mut script);
        io::print(&String::from_utf8_lossy(&script))
    }
}
