//! One file a command, clap types beside what they do; files are touched here only.

mod check;
mod compile;
mod completions;
mod diff;
mod dump;
mod explain;
mod interpolate;
mod io;
mod machines;
mod man;
mod plot;
mod schema;
mod simulate;
mod subject;
mod verify;

use clap::{Parser, Subcommand, ValueEnum};
use io::Console;
use splinepost::diagnostic::{Diagnostic, Diagnostics};
use splinepost::dialect::Motion;
use splinepost::ir::Method;
use splinepost::machine::{self, Machine};
use splinepost::source::{Source, Sources};
use splinepost::tables::nearest;
use std::process::ExitCode;

/// NC compiler and postprocessor that writes the control's own splines and proves its output
#[derive(Parser, Debug)]
#[command(version, about, arg_required_else_help = true)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    command: Command,
    /// How diagnostics and summaries are written to standard error
    #[arg(long, global = true, value_enum, default_value_t = MessageFormat::Text, value_name = "FORMAT")]
    message_format: MessageFormat,
}

/// How diagnostics and summaries are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum MessageFormat {
    /// For people
    Text,
    /// One JSON object a line
    Json,
}

#[derive(Subcommand, Debug)]
enum Command {
    Compile(compile::Compile),
    Interpolate(interpolate::Interpolate),
    Verify(verify::Verify),
    Diff(diff::Diff),
    Simulate(simulate::Simulate),
    Plot(plot::Plot),
    Check(check::Check),
    Dump(dump::Dump),
    Machines(machines::Machines),
    Explain(explain::Explain),
    Schema(schema::Schema),
    Completions(completions::Completions),
    Man(man::Man),
}

/// The methods as the command line spells them.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum MethodName {
    /// Odd-even for lines along a curve, direct otherwise
    Auto,
    /// The paper's odd-even third-order steps
    OddEven,
    /// The curve itself, in as few pieces as the tolerance allows
    Direct,
}

impl From<MethodName> for Method {
    fn from(name: MethodName) -> Method {
        match name {
            MethodName::Auto => Method::Auto,
            MethodName::OddEven => Method::OddEven,
            MethodName::Direct => Method::Direct,
        }
    }
}

/// Runs a command and gives its exit code.
pub(crate) fn run(arguments: &Arguments) -> ExitCode {
    let console = Console::new(arguments.message_format);
    let mut sources = Sources::default();
    let result = match &arguments.command {
        Command::Compile(command) => command.run(&console, &mut sources),
        Command::Interpolate(command) => command.run(&console, &mut sources),
        Command::Verify(command) => command.run(&console, &mut sources),
        Command::Diff(command) => match command.run(&console, &mut sources) {
            Ok(true) => Ok(()),
            Ok(false) => return ExitCode::from(1),
            Err(diagnostics) => Err(diagnostics),
        },
        Command::Simulate(command) => command.run(&console, &mut sources),
        Command::Plot(command) => command.run(&console, &mut sources),
        Command::Check(command) => command.run(&console, &mut sources),
        Command::Dump(command) => command.run(&console, &mut sources),
        Command::Machines(command) => command.run(&console),
        Command::Explain(command) => command.run(&console),
        Command::Schema(command) => command.run(&console),
        Command::Completions(command) => command.run(&console),
        Command::Man(command) => command.run(&console),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(diagnostics) => {
            console.diagnostics(&diagnostics, &sources);
            Console::exit_code(&diagnostics)
        }
    }
}

/// The machine that `--to` names: a built-in, or a file.
fn machine(to: &str, sources: &mut Sources) -> Result<Machine, Diagnostics> {
    if let Some(machine) = Machine::built_in(to) {
        return Ok(machine);
    }
    let path = std::path::Path::new(to);
    if !path.exists() {
        let names = machine::BUILT_IN.iter().map(|(name, _)| *name);
        let error =
            Diagnostic::error("machine-unknown", format!("`{to}` is neither a built-in machine nor a file"));
        let hint = match nearest(to, names.clone()) {
            Some(meant) => format!("did you mean `{meant}`?"),
            None => format!(
                "built in are {}; a machine file is given by its path",
                names.collect::<Vec<_>>().join(", ")
            ),
        };
        return Err(error.hint(hint).into());
    }
    let text = io::read_text(to)?;
    let id = sources.push(Source::new(to, text.clone()));
    Machine::parse(&text, id)
}

/// The motion that `--motion` names; none for `auto`.
fn motion(name: Option<&str>, machine: &Machine) -> Result<Option<&'static Motion>, Diagnostics> {
    let Some(name) = name.filter(|name| *name != "auto") else { return Ok(None) };
    machine.dialect.motion(name).map(Some).ok_or_else(|| {
        let error = Diagnostic::error(
            "motion-unknown",
            format!("`{name}` is not a motion of {}", machine.dialect.name),
        );
        error.hint(format!("its motions are auto, {}", machine.dialect.motion_names())).into()
    })
}

/// A length on the command line must be a positive number.
fn length(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if 0.0 < x && x.is_finite() => Ok(x),
        _ => Err("a number of mm greater than zero is needed".to_owned()),
    }
}

/// A tolerance on the command line is one that holds something.
fn tolerance(text: &str) -> Result<f64, String> {
    match length(text)? {
        x if x <= splinepost::MOST_TOLERANCE => Ok(x),
        _ => Err(format!("at most {} mm", splinepost::MOST_TOLERANCE)),
    }
}
