//! `splinepost check`: is an input or a program sound?

use super::io::Console;
use super::subject::{Subject, Understood};
use splinepost::diagnostic::{Diagnostic, Diagnostics};
use splinepost::pass;
use splinepost::source::Sources;

/// Check an input, or with --to and a program's text that a machine's reader understands it
#[derive(clap::Args, Debug)]
pub(crate) struct Check {
    #[command(flatten)]
    subject: Subject,
}

impl Check {
    /// Runs it.
    pub(crate) fn run(&self, console: &Console, sources: &mut Sources) -> Result<(), Diagnostics> {
        match self.subject.understand(sources)? {
            Understood::Program(machine, reading) => {
                let legal = pass::check::check(reading.value.decimals, &machine)?;
                console.diagnostics(&reading.warnings, sources);
                console.diagnostics(&legal.warnings, sources);
            }
            Understood::Input(language, intent) => {
                console.diagnostics(&intent.warnings, sources);
                if language.grammar != "apt" && !intent.is_complete() {
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
