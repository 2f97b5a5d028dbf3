//! Two programs beside each other: do they make the same motion?
//!
//! Each is read by its own machine's reader, or by its language where it is an input, and becomes a list of switches, rapids and paths
//! (`diff/side.rs`). The lists are walked side by side:
//!
//! | | compared |
//! |---|---|
//! | tools, spindle, coolant, stops, dwells, homes, an operator's parameters, their order | exactly |
//! | rapids | where each leads to, exactly; one that moves nothing is none |
//! | paths at feed, of any blocks: lines, arcs, polynomials, B-splines | by a bound on their distance, both run in order |
//! | F | exactly where the paths meet, every one in its order; by the time of the path where the machines measure it differently |
//! | the control's own splines | their points, and that both are of one kind |
//! | the work offset, G54, where both state one | exactly |
//! | remarks, block numbers, names, shifts of the text, subprograms, the lines round a program | not: they are no motion |
//!
//! Numbers of machines with different decimals are the same where the coarser one would have rounded to it.
//!
//! The bound is that of [`geom::follow`](crate::geom::follow), the one that verification uses; what differs is that no intent says
//! which block belongs to which, so that both are run along together. Where a bound is greater than the tolerance the
//! paths part; that a better map of the one to the other would hold it is possible where a path runs along itself within some
//! tolerances, and is not looked for. The answer does not depend on which program is named first: two programs are the same when either
//! order shows it.

mod pace;
mod path;
mod report;
mod side;
mod walk;

pub use report::{Figures, Place};

use crate::diagnostic::{Diagnostic, Diagnostics, Warned};
use crate::dialect::{DIALECTS, Reading};
use crate::front::Language;
use crate::ir::Intent;
use crate::machine::Machine;
use crate::pass;
use crate::source::{SourceId, Sources, Span};
use crate::translate;
use crate::units::DEGREES;
use side::Side;
use walk::{Found, Scale, Walk};

/// How a text is read.
#[derive(Clone, Debug)]
pub enum Origin {
    /// As an NC program for a machine.
    Program(Box<Machine>),
    /// As an input in a language.
    Input(&'static Language),
}

/// What the command line may say beside both programs.
#[derive(Clone, Copy, Debug, Default)]
pub struct Options {
    /// mm; none: what both say together, since each may be so far from what was asked.
    pub tolerance: Option<f64>,
    /// The radius at which rotary axes count, mm; none: a degree counts as a millimetre.
    pub radius: Option<f64>,
}

/// What was found.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// The figures.
    pub figures: Figures,
    /// The first places where the programs differ.
    pub differences: Diagnostics,
    /// What to know.
    pub warnings: Diagnostics,
}

/// The built-in machine whose program a text is: the only one whose header, words and end it has.
///
/// # Errors
/// It is no program of a built-in machine, or of several.
pub fn detect(sources: &Sources) -> Result<Machine, Diagnostics> {
    let text = sources.get(SourceId::INPUT).map_or("", |source| source.text.as_str());
    let fits = |machine: &Machine| {
        let machine = translate::machine_of(text, machine);
        (machine.dialect.read)(text, SourceId::INPUT, &machine)
            .is_ok_and(|reading| reading.value.header && reading.value.footer)
    };
    let mut fitting = DIALECTS.iter().filter_map(|dialect| Machine::built_in(dialect.name)).filter(fits);
    match (fitting.next(), fitting.next()) {
        (Some(machine), None) => Ok(machine),
        _ => {
            let first = text.find('\n').unwrap_or(text.len()).min(80);
            Err(Diagnostic::error("machine-missing", "no built-in machine alone writes such a program")
                .at(Span::new(SourceId::INPUT, 0..first), "")
                .hint("say with --from which machine it is for, or --from-a and --from-b where they differ; a language of inputs is as good")
                .into())
        }
    }
}

/// A text that was read.
enum Read {
    Program(Box<Machine>, Box<Reading>),
    Input(Box<Intent>),
}

fn read(sources: &Sources, origin: &Origin) -> Result<Warned<Read>, Diagnostics> {
    match origin {
        Origin::Program(machine) => {
            let text = sources.get(SourceId::INPUT).map_or("", |source| source.text.as_str());
            let machine = translate::machine_of(text, machine);
            let Warned { value, mut warnings } = (machine.dialect.read)(text, SourceId::INPUT, &machine)?;
            warnings.extend(translate::is_whole(&value, &machine)?);
            Ok(Warned { value: Read::Program(Box::new(machine), Box::new(value)), warnings })
        }
        Origin::Input(language) => {
            let mut intent = (language.parse)(sources)?;
            let warnings = std::mem::take(&mut intent.warnings);
            Ok(Warned { value: Read::Input(Box::new(intent)), warnings })
        }
    }
}

/// The same, behind `count` other texts.
fn behind(mut diagnostics: Diagnostics, count: usize) -> Diagnostics {
    let moved = |span: &mut Span| span.source = span.source.behind(count);
    for diagnostic in &mut diagnostics.0 {
        diagnostic.span.iter_mut().for_each(moved);
        diagnostic.others.iter_mut().flat_map(|others| &mut others.0).for_each(|(span, _)| moved(span));
    }
    diagnostics
}

/// Compares two programs. Places in the second text count on behind those of the first: [`Sources::joined`].
///
/// # Errors
/// One of them cannot be read, or is no whole program.
pub fn compare(
    [a, b]: [&Sources; 2],
    [from_a, from_b]: [&Origin; 2],
    options: &Options,
) -> Result<Comparison, Diagnostics> {
    let count = a.count();
    // What is wrong with either is told.
    let (first, second) = match (read(a, from_a), read(b, from_b).map_err(|errors| behind(errors, count))) {
        (Ok(first), Ok(second)) => (first, second),
        (Err(mut errors), Err(more)) => {
            errors.extend(more);
            return Err(errors);
        }
        (Err(errors), Ok(_)) | (Ok(_), Err(errors)) => return Err(errors),
    };
    let mut warnings = first.warnings;
    warnings.extend(behind(second.warnings, count));
    let (mut first, mut second) = (first.value, second.value);
    second.shift(count);
    // An input goes where the other's machine does: to its homes, with its axes' names.
    place(&mut first, &second)?;
    place(&mut second, &first)?;
    let tolerance = options.tolerance.unwrap_or(first.tolerance() + second.tolerance());
    let radius = options.radius.or(first.radius()).or(second.radius()).unwrap_or(DEGREES);
    // As with the tolerance: each may be so far from what was asked of both.
    let turn = first.turn() + second.turn();
    let rule = Scale { tolerance, turn, radius };
    let text = |sources: &Sources| sources.get(SourceId::INPUT).map_or(String::new(), |s| s.text.clone());
    let (text_a, text_b) = (text(a), text(b));
    let own = side(&first, &second, (&text_a, SourceId::INPUT), radius)?;
    let other = side(&second, &first, (&text_b, SourceId::INPUT.behind(count)), radius)?;
    let found = if let Some(diagnostic) = own.has_other_axes(&other).or(other.has_other_axes(&own)) {
        let mut found = Found::new();
        found.differs(|| diagnostic);
        found
    } else {
        let other = other.ordered(&own.axes);
        let found = Walk::new(&own, &other, rule).run();
        // A map that runs the other way may be better.
        let back = if found.is_same() { None } else { Some(Walk::new(&other, &own, rule).run()) };
        back.filter(Found::is_same).map_or(found, Found::swapped)
    };
    let mut found = found;
    if let Some(diagnostic) = other_offset(&first, &second) {
        found.differs_first(diagnostic);
    }
    let names = [a, b].map(|sources| sources.get(SourceId::INPUT).map_or(String::new(), |s| s.name.clone()));
    let figures = Figures::new(&found, names, [from_a, from_b], tolerance, own.axes.direction().is_some());
    let mut differences = Diagnostics(found.told);
    if differences.0.len() < found.differences {
        let more = found.differences - differences.0.len();
        let message = format!("the programs differ in {more} more places");
        differences.push(Diagnostic::refusal("more-differences", message));
    }
    Ok(Comparison { figures, differences, warnings })
}

impl Read {
    fn machine(&self) -> Option<&Machine> {
        match self {
            Read::Program(machine, _) => Some(machine),
            Read::Input(_) => None,
        }
    }

    fn tolerance(&self) -> f64 {
        match self {
            Read::Program(machine, _) => machine.tolerance,
            Read::Input(intent) => intent.tolerance.map_or(0.001, |(tolerance, _)| tolerance),
        }
    }

    fn radius(&self) -> Option<f64> {
        match self {
            Read::Program(..) => None,
            Read::Input(intent) => intent.radius,
        }
    }

    /// How far the tool's direction may be off, radians.
    fn turn(&self) -> f64 {
        self.machine().map_or(0.0, |machine| machine.orientation.tolerance / DEGREES)
    }

    /// Its steps stand in a text with so many before it.
    fn shift(&mut self, count: usize) {
        let moved = |span: &mut Span| span.source = span.source.behind(count);
        match self {
            Read::Program(_, reading) => {
                reading.stated.offset.iter_mut().for_each(|offset| moved(&mut offset.span));
                reading.decimals.program.steps.iter_mut().for_each(|located| moved(&mut located.span));
            }
            Read::Input(intent) => {
                intent.program.steps.iter_mut().for_each(|located| moved(&mut located.span));
            }
        }
    }
}

/// What is wrong where both programs state from which work offset they count, and not the same.
fn other_offset(first: &Read, second: &Read) -> Option<Diagnostic> {
    let (Read::Program(_, first), Read::Program(_, second)) = (first, second) else { return None };
    let (own, other) = (first.stated.offset.as_ref()?, second.stated.offset.as_ref()?);
    (own.word != other.word).then(|| {
        let message = format!("the first program counts from {}, the second from {}", own.word, other.word);
        Diagnostic::refusal("work-offset-differs", message)
            .at(own.span, own.word.as_str())
            .and_at(other.span, other.word.as_str())
    })
}

/// An input as the machine of the other program counts it.
fn place(read: &mut Read, other: &Read) -> Result<(), Diagnostics> {
    if let (Read::Input(intent), Some(machine)) = (read, other.machine()) {
        **intent = pass::place::place((**intent).clone(), machine)?;
    }
    Ok(())
}

fn side<'a>(
    read: &'a Read,
    other: &'a Read,
    text: (&'a str, SourceId),
    radius: f64,
) -> Result<Side<'a>, Diagnostics> {
    Ok(match read {
        Read::Program(machine, reading) => Side::of_program(&reading.decimals, machine, text, radius)?,
        Read::Input(intent) => Side::of_intent(intent, other.machine(), text, radius)?,
    })
}
