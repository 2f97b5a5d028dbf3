//! `splinepost man`: the manual page.

use super::Arguments;
use super::io::{self, Console};
use clap::CommandFactory;
use splinepost::diagnostic::{Diagnostic, Diagnostics};

/// Print the manual page of the program, or of one command
#[derive(clap::Args, Debug)]
pub(crate) struct Man {
    /// The command
    command: Option<String>,
}

impl Man {
    /// Runs it.
    pub(crate) fn run(&self, _console: &Console) -> Result<(), Diagnostics> {
        let mut whole = Arguments::command();
        whole.build();
        let page = match &self.command {
            None => whole,
            Some(name) => match whole.find_subcommand(name) {
                Some(command) => command.clone(),
                None => {
                    let error = Diagnostic::error("command-unknown", format!("there is no command `{name}`"));
                    return Err(error.hint("`splinepost help` lists them").into());
                }
            },
        };
        let mut text = Vec::new();
        let rendered = clap_mangen::Man::new(page).render(&mut text);
        // Rendering into memory cannot fail.
        rendered.map_or(Ok(()), |()| io::print(&String::from_utf8_lossy(&text)))
    }
}
