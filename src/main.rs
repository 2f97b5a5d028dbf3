//! The command line: parse arguments, run, print, exit code.
//!
//! | code | meaning |
//! |---|---|
//! | 0 | done; warnings may have been printed |
//! | 1 | the answer is no: it differs, it cannot be met, it does not verify; nothing was written |
//! | 2 | the input, the usage or a file is wrong; nothing was written |

mod cli;

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = cli::Arguments::parse();
    cli::run(&arguments)
}
