//! `splinepost diff`: do two programs make the same motion?

use super::compile::{Reading, is_machine, language};
use super::io::{self, Console};
use super::{length, machine, tolerance};
use splinepost::diagnostic::Diagnostics;
use splinepost::diff::{self, Options, Origin};
use splinepost::front;
use splinepost::source::{Encoding, Sources};

/// Say whether two programs make the same motion, in any two dialects, and where not
///
/// Tools, spindle, coolant, stops, rapids and F are compared exactly, in their order. Paths at feed may be of any blocks, lines in
/// the one and splines in the other: both are run from start to end, each at its own pace, and a proved bound on their distance is
/// held against the tolerance. So order counts: the same passes in another order, or one of them twice, are a difference. Remarks,
/// block numbers, names and the lines round a program are not compared.
///
/// Exit code 0: the same within the tolerance. 1: they differ. 2: an input, the usage or a file is wrong.
#[derive(clap::Args, Debug)]
pub(crate) struct Diff {
    /// The first program, or - for standard input
    a: String,
    /// The second program
    b: String,
    /// The machine that both are NC programs for, or the language of inputs; without it the built-in machines are tried
    #[arg(long, value_name = "LANGUAGE|MACHINE")]
    from: Option<String>,
    /// The same for the first program alone
    #[arg(long, value_name = "LANGUAGE|MACHINE")]
    from_a: Option<String>,
    /// The same for the second program alone
    #[arg(long, value_name = "LANGUAGE|MACHINE")]
    from_b: Option<String>,
    /// Tolerance in mm, instead of what both machines or inputs allow together
    #[arg(long, value_name = "MM", value_parser = tolerance)]
    tolerance: Option<f64>,
    /// The radius at which rotary axes count; without it a degree counts as a millimetre
    #[arg(long, value_name = "MM", value_parser = length)]
    radius: Option<f64>,
    #[command(flatten)]
    reading: Reading,
}

impl Diff {
    /// Runs it; whether both make the same motion.
    pub(crate) fn run(&self, console: &Console, sources: &mut Sources) -> Result<bool, Diagnostics> {
        let mut first = Sources::new(io::read_input(&self.a)?);
        let from_a = self.from_a.as_ref().or(self.from.as_ref());
        let from_b = self.from_b.as_ref().or(self.from.as_ref());
        let own = self.origin(from_a, &mut first);
        *sources = first.clone();
        let own = own?;
        let mut second = Sources::new(io::read_input(&self.b)?);
        let other = self.origin(from_b, &mut second);
        // What is wrong with the second has places in its own texts.
        let other = other.inspect_err(|_| *sources = second.clone())?;
        *sources = first.clone().joined(second.clone());
        let options = Options { tolerance: self.tolerance, radius: self.radius };
        let mut found = diff::compare([&first, &second], [&own, &other], &options)?;
        found.figures.find_lines(sources);
        console.diagnostics(&found.warnings, sources);
        console.diagnostics(&found.differences, sources);
        console.figures(&found.figures.render(), &found.figures.to_json());
        Ok(found.figures.same)
    }

    /// How a text is to be read: as `from` says, as an input where it looks like one, otherwise as a program of the one built-in
    /// machine that writes such programs.
    fn origin(&self, from: Option<&String>, sources: &mut Sources) -> Result<Origin, Diagnostics> {
        self.reading.tell(sources)?;
        let looks_like_input = sources
            .get(splinepost::source::SourceId::INPUT)
            .is_some_and(|input| front::detect(input).is_ok());
        let program = |sources: &Sources, origin: Origin| {
            let input = sources.get(splinepost::source::SourceId::INPUT);
            match input.filter(|input| input.encoding == Encoding::Windows1252) {
                Some(input) => {
                    let line = input.text.lines().position(|line| !line.is_ascii()).unwrap_or(0) + 1;
                    Err(io::not_utf8(&input.name, line))
                }
                None => Ok(origin),
            }
        };
        match from {
            Some(name) if front::find(name).is_none() && is_machine(name) => {
                let machine = machine(name, sources)?;
                program(sources, Origin::Program(Box::new(machine)))
            }
            None if !looks_like_input => {
                let machine = diff::detect(sources)?;
                program(sources, Origin::Program(Box::new(machine)))
            }
            from => language(from.map(String::as_str), sources).map(Origin::Input),
        }
    }
}
