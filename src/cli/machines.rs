//! `splinepost machines`: what is built in.

use super::io::{self, Console};
use splinepost::diagnostic::{Diagnostic, Diagnostics};
use splinepost::machine::{BUILT_IN, Machine, built_in};
use std::fmt::Write as _;

/// List the built-in machines, or print the file of one
#[derive(clap::Args, Debug)]
pub(crate) struct Machines {
    /// Print this machine's file: the start for one of your own
    #[arg(long, value_name = "NAME")]
    show: Option<String>,
}

impl Machines {
    /// Runs it.
    pub(crate) fn run(&self, _console: &Console) -> Result<(), Diagnostics> {
        if let Some(name) = &self.show {
            return match built_in(name) {
                Some(text) => io::print(text),
                None => Err(Diagnostic::error(
                    "machine-unknown",
                    format!("there is no built-in machine `{name}`"),
                )
                .hint("`splinepost machines` lists them")
                .into()),
            };
        }
        let mut text = String::new();
        for (name, _) in BUILT_IN {
            if let Some(machine) = Machine::built_in(name) {
                let _ = writeln!(text, "{name:<16}{}", machine.about);
                for motion in machine.dialect.motions {
                    let _ = writeln!(text, "  {:<14}{}", motion.name, motion.about);
                }
            }
        }
        io::print(&text)
    }
}
