//! splinepost: a compiler and postprocessor for NC programs that writes the control's own splines and proves that the
//! program does what was asked.
//!
//! ```text
//!  cutter.toml ── parse ─> Intent ─ settle ─ interpolate ─ convert ─ quantise ─ check ─> Legal ─ write ─> text
//!                            └──────────────────── verify <──── read <───────────────────────────────────┘
//! ```
//!
//! Five words carry the design.
//!
//! - [`source::Source`]: a named text. Everything wrong in it is reported with a span.
//! - [`ir::Program`]: the intermediate representation. Explicit, absolute, metric, dialect-free, mode-free.
//! - [`pass::check::Legal`]: a program in decimals that fits one machine. Only `check` makes one; only writers take one.
//! - [`dialect::Dialect`]: a value with a `write` and a `read`, which are inverses and live in one folder.
//! - [`machine::Machine`]: one machine file: dialect, axes, digits, header and footer, what its splines take.
//!
//! The library reads no files, prints nothing and does not panic on any input. [`compile`] is the whole of it, from top
//! to bottom; the modules in reading order:
//!
//! | module | what |
//! |---|---|
//! | [`source`], [`diagnostic`] | texts, places, and everything that a user is told |
//! | [`units`], [`decimal`] | axes and positions; numbers as a control reads them |
//! | [`ir`], [`dump`] | programs, and programs as text |
//! | [`geom`] | curves, fits, and the bounds that are the proof |
//! | [`machine`], [`tables`] | machine files |
//! | [`front`] | what a user writes |
//! | [`translate`] | NC programs as inputs |
//! | [`pass`] | from what was asked to what one machine takes |
//! | [`dialect`] | how controls spell it, and reading it back |
//! | [`verify`] | the proof |
//! | [`diff`] | two programs beside each other |
//! | [`map`] | which lines of the input each block came from |
//! | [`points`] | the table of interpolated points |
//! | [`simulate`] | the path as a control would run it |
//! | [`plot`] | pictures |
//! | [`setup`], [`summary`] | what a person at the machine must know, and what a compilation tells |
//!
//! The command is the feature `cli`, on by default. `default-features = false` leaves the library alone, without the crates
//! that only the command needs.

pub mod decimal;
pub mod diagnostic;
pub mod dialect;
pub mod diff;
pub mod dump;
pub mod front;
pub mod geom;
pub mod ir;
pub mod machine;
pub mod map;
pub mod pass;
pub mod plot;
pub mod points;
pub mod setup;
pub mod simulate;
pub mod source;
pub mod summary;
pub mod tables;
pub mod translate;
pub mod units;
pub mod verify;

use diagnostic::{Diagnostic, Diagnostics};
use dialect::{Form, Motion};
use front::Language;
use geom::smooth::{self, Fitting};
use ir::{Curve, Cut, Intent, Located, Method, Step, Written};
use machine::Machine;
use setup::Setup;
use source::{Source, SourceId, Sources};
use verify::Report;

/// What the command line may say beside input and machine.
#[derive(Clone, Copy, Debug, Default)]
pub struct Options {
    /// The motion for cutting pieces; none: the machine's, or `auto`.
    pub motion: Option<&'static Motion>,
    /// How curves are followed; none: as the input says.
    pub method: Option<Method>,
    /// mm; none: the input's, or the machine's.
    pub tolerance: Option<f64>,
    /// The program's number, where the control wants one; none: the input's.
    pub number: Option<u32>,
    /// Write the program without its proof, and say so in it.
    pub no_verify: bool,
    /// Make splines of runs of short lines.
    pub fit: bool,
    /// Where such a run turns by more, it has a corner, degrees; none: [`smooth::CORNER`].
    pub corner: Option<f64>,
}

/// A program and its proof.
#[derive(Clone, Debug)]
pub struct Output {
    /// The text.
    pub text: String,
    /// What was proved; none under `no_verify`.
    pub report: Option<Report>,
    /// The motion that cutting pieces have.
    pub motion: &'static Motion,
    /// What was asked, with all that the input left open settled.
    pub intent: Intent,
    /// The tolerance that held, mm.
    pub tolerance: f64,
    /// The machine as the program wants it, with the axes that it names: what reads the text.
    pub machine: Machine,
    /// What to know at the machine.
    pub setup: Setup,
    /// What to know.
    pub warnings: Diagnostics,
}

/// A compilation that came to nothing.
#[derive(Clone, Debug)]
pub struct Failure {
    /// Why.
    pub diagnostics: Diagnostics,
    /// The program that did not verify, behind [`SourceId::PROGRAM`].
    pub program: Option<Source>,
}

impl From<Diagnostics> for Failure {
    fn from(diagnostics: Diagnostics) -> Failure {
        Failure { diagnostics, program: None }
    }
}

/// What is refused of one motion and may not be of another, beside what the proof refuses.
const OF_MOTION: [&str; 4] =
    ["form-out-of-reach", "number-range", "position-range", "tolerance-out-of-reach"];

impl Failure {
    /// Whether another motion may come through: the program that was written is not proved, or its numbers do not go into
    /// the control's.
    fn is_of_motion(&self) -> bool {
        self.program.is_some() || self.diagnostics.0.iter().all(|found| OF_MOTION.contains(&found.id))
    }
}

/// Compiles an input for a machine, reads the program back and proves it.
///
/// # Errors
/// The input is wrong, the machine cannot do it, or the program does not verify.
pub fn compile(
    sources: &Sources,
    language: &Language,
    machine: &Machine,
    options: &Options,
) -> Result<Output, Failure> {
    compile_intent((language.parse)(sources)?, machine, options)
}

/// Compiles an NC program that was written for the machine `from` for another one, and proves it against that program.
///
/// # Errors
/// As [`compile`]; and where the program cannot be read, or asks for what only its own machine knows.
pub fn recompile(
    sources: &Sources,
    from: &Machine,
    machine: &Machine,
    options: &Options,
) -> Result<Output, Failure> {
    let mut intent = translate::parse(sources, from, machine)?;
    intent.warnings.extend(translate::turns_otherwise(&intent, from, machine));
    compile_intent(intent, machine, options)
}

fn compile_intent(intent: Intent, machine: &Machine, options: &Options) -> Result<Output, Failure> {
    let intent = with_options(intent, options);
    let intent = pass::place::place(intent, machine)?;
    if !options.fit {
        return compile_placed(&intent, machine, options);
    }
    // A spline may ask for what lines do not: accelerations inside blocks, axes that splines do not move, decimals. What goes
    // through as lines is no worse for having been asked as splines.
    let refused = match compile_placed(&intent, machine, options) {
        Ok(output) => return Ok(output),
        Err(refused) => refused,
    };
    match compile_placed(&intent, machine, &Options { fit: false, ..*options }) {
        Ok(mut output) => {
            output.warnings.push(fit_refused(&refused.diagnostics));
            Ok(output)
        }
        Err(_) => Err(refused),
    }
}

fn compile_placed(intent: &Intent, machine: &Machine, options: &Options) -> Result<Output, Failure> {
    let machine = machine.with_axes(&intent.program.axes)?;
    if let Some(diagnostic) = pass::check::name(&intent.program.name, &machine) {
        let diagnostic = match intent.name_span {
            Some(span) => diagnostic.at(span, ""),
            None => diagnostic,
        };
        return Err(Diagnostics::from(diagnostic).into());
    }
    length_within_decimals(intent, &machine)?;
    let tolerance = tolerance(intent, &machine, options)?;
    verify::contours(intent, &machine, tolerance)?;
    let mut warnings = intent.warnings.clone();
    let asked = options.motion.or(machine.motion);
    let motions = match asked {
        Some(motion) => vec![motion],
        None => {
            let fitted = options.fit.then(|| pass::fit::fit(intent, &machine, fitting(tolerance, options)));
            let chosen = pass::choose::choose(intent, fitted.as_ref(), &machine, tolerance)?;
            warnings.extend(chosen.warnings);
            let mut motions = chosen.value;
            // Lines in place of a fit are another compilation, which says so.
            if options.fit && motions.first().is_some_and(|best| best.form != Form::Lines) {
                motions.retain(|motion| motion.form != Form::Lines);
            }
            motions
        }
    };
    let mut refused: Vec<(&'static Motion, Failure)> = Vec::new();
    for motion in motions {
        match compile_as(intent.clone(), motion, &machine, tolerance, options) {
            Ok(mut output) => {
                for (other, failure) in &refused {
                    warnings.push(passed_over(other, motion, failure));
                }
                warnings.extend(std::mem::take(&mut output.warnings));
                return Ok(Output { warnings, ..output });
            }
            Err(failure) => {
                let last = !failure.is_of_motion();
                refused.push((motion, failure));
                if last {
                    break;
                }
            }
        }
    }
    // Of several refusals the best motion's is told.
    Err(refused.into_iter().next().map_or_else(|| Failure::from(Diagnostics::new()), |(_, failure)| failure))
}

/// Compiles a placed intent with one motion.
fn compile_as(
    intent: Intent,
    motion: &'static Motion,
    machine: &Machine,
    tolerance: f64,
    options: &Options,
) -> Result<Output, Failure> {
    let asked = options.motion.or(machine.motion);
    let intent = pass::settle::settle(intent, motion.form, asked.is_some(), tolerance)?;
    let mut warnings = overrun_without_steps(&intent);
    // Rounding costs something. What is left of the tolerance is for the fit; where the whole turns out too dear,
    // the fit is made finer. Lines are never refined: their points are asked for as they are.
    let left = tolerance - resolution(&intent, machine).min(0.5 * tolerance);
    let mut failure = Failure::from(Diagnostics::new());
    // An exact form that rounding spoils is given up only where no finer fit of the others helps.
    let exact = [1.0, 0.7, 0.4, 0.2, 0.05].map(|share| (share, true));
    let fitted = [1.0, 0.5, 0.1].map(|share| (share, false));
    for (share, exact) in exact.into_iter().chain(fitted) {
        let attempt =
            Attempt { motion, machine, tolerance, fit: share * left, exact, asked: asked.is_some(), options };
        match attempt.run(&intent) {
            Ok(Attempted { text, report, setup, warnings: found }) => {
                warnings.extend(found);
                warnings.extend(pass::stretch::varying(&intent, machine));
                warnings.extend(pass::approximate::notes(&intent, motion.form, machine, !attempt.exact));
                if let Some(report) = &report {
                    if options.fit && report.splined.is_none() {
                        warnings.push(nothing_splined(motion));
                    }
                    warnings.extend(steps_exceed_tolerance(&intent, report, tolerance));
                }
                let machine = machine.clone();
                return Ok(Output { text, report, motion, intent, tolerance, machine, setup, warnings });
            }
            Err(error) => {
                // Where a small path became a point, a finer fit makes it one again.
                let refine = error.diagnostics.0.iter().all(|d| {
                    matches!(d.id, "deviation-too-large" | "direction-too-far" | "cut-without-length")
                });
                failure = error;
                if !refine || (exact && share == 0.05 && !pass::approximate::may_be_exact(&intent)) {
                    break;
                }
            }
        }
    }
    Err(failure)
}

/// A program that came through all passes.
struct Attempted {
    text: String,
    report: Option<Report>,
    setup: Setup,
    warnings: Diagnostics,
}

/// One way through all passes, with a fit of its own tolerance.
struct Attempt<'a> {
    motion: &'static Motion,
    machine: &'a Machine,
    tolerance: f64,
    fit: f64,
    exact: bool,
    asked: bool,
    options: &'a Options,
}

/// How runs of lines become splines within `tolerance` mm.
fn fitting(tolerance: f64, options: &Options) -> Fitting {
    Fitting { tolerance, corner: options.corner.unwrap_or(smooth::CORNER) }
}

impl Attempt<'_> {
    fn run(&self, intent: &Intent) -> Result<Attempted, Failure> {
        let Attempt { machine, tolerance, fit, exact, .. } = *self;
        let no_verify = self.options.no_verify;
        let form = self.motion.form;
        let splines = matches!(form, Form::Polynomial { .. } | Form::Nurbs);
        let fitted = (self.options.fit && splines)
            .then(|| pass::fit::fit(intent, machine, fitting(fit, self.options)));
        let source = fitted.as_ref().unwrap_or(intent);
        let program = pass::interpolate::interpolate(source, form, machine, (fit, tolerance), exact)?;
        let mut program = pass::convert::convert(program, form, machine, self.asked)?;
        if no_verify && let Some(span) = program.steps.first().map(|located| located.span) {
            program.steps.insert(0, Located { step: Step::Comment("NOT VERIFIED".to_owned()), span });
        }
        let mut decimals = pass::quantise::quantise(program, form, machine, tolerance, intent.radius())?;
        let setup = Setup::new(intent, &decimals, machine);
        decimals.setup = setup.remarks(machine);
        let legal = pass::check::check(decimals, machine)?;
        let text = (machine.dialect.write)(&legal.value, machine);
        let warnings = legal.warnings;
        if no_verify {
            return Ok(Attempted { text, report: None, setup, warnings });
        }
        // The reading alone is needed from here on.
        drop(legal.value);
        match verify_text(intent, &text, SourceId::PROGRAM, machine, tolerance) {
            Ok(report) => Ok(Attempted { text, report: Some(report), setup, warnings }),
            Err(diagnostics) => {
                Err(Failure { diagnostics, program: Some(Source::new("the program written", text)) })
            }
        }
    }
}

/// What is said of a motion that would take fewer blocks and cannot be proved.
fn passed_over(motion: &Motion, taken: &Motion, failure: &Failure) -> Diagnostic {
    let reason = failure.diagnostics.0.first();
    let message = format!(
        "written as `{}`: as `{}` {}",
        taken.name,
        motion.name,
        reason.map_or("", |reason| reason.message.as_str())
    );
    let note = Diagnostic::note("motion-passed-over", message);
    // The program that failed is no text that anyone has; the entity of the input is.
    let entity = reason.and_then(|reason| {
        let spans = reason.span.into_iter().chain(reason.others().map(|(span, _)| *span));
        spans.into_iter().find(|span| span.source != SourceId::PROGRAM)
    });
    match entity {
        Some(span) => note.at(span, ""),
        None => note,
    }
}

/// What is said where splines were to be made of lines, and none was.
fn nothing_splined(motion: &Motion) -> Diagnostic {
    let (name, lines) = (motion.name, "lines stay lines");
    let message = match motion.form {
        Form::Polynomial { .. } | Form::Nurbs => {
            format!("{lines}: no run is long enough for a spline to save blocks")
        }
        Form::Lines | Form::Through(_) => {
            format!("{lines}: the motion is `{name}`, where no spline saves blocks")
        }
    };
    Diagnostic::note("nothing-fitted", message)
}

/// What is said where a program goes through with its lines only.
fn fit_refused(refused: &Diagnostics) -> Diagnostic {
    let reason = refused.0.first().map_or("", |diagnostic| diagnostic.message.as_str());
    Diagnostic::warning("fit-refused", format!("lines stay lines: with splines in their place {reason}"))
}

/// Reads a program and compares it with a settled intent.
fn verify_text(
    intent: &Intent,
    text: &str,
    id: SourceId,
    machine: &Machine,
    tolerance: f64,
) -> Result<Report, Diagnostics> {
    let reading = (machine.dialect.read)(text, id, machine)?;
    verify::verify(intent, &reading.value, text, id, machine, tolerance)
}

/// A program that exists already, compared with what was asked.
#[derive(Clone, Debug)]
pub struct Verified {
    /// What was proved.
    pub report: Report,
    /// What was asked, settled for the form that the program has.
    pub intent: Intent,
    /// The tolerance that held, mm.
    pub tolerance: f64,
    /// The machine as the program wants it, with the axes that it names.
    pub machine: Machine,
    /// What to know.
    pub warnings: Diagnostics,
}

/// Proves a program that exists already, `sources.get(program)`, against the input.
///
/// # Errors
/// Either cannot be read, or the program does something else.
pub fn verify_program(
    sources: &Sources,
    language: &Language,
    program: SourceId,
    machine: &Machine,
    options: &Options,
) -> Result<Verified, Diagnostics> {
    let intent = with_options((language.parse)(sources)?, options);
    let intent = pass::place::place(intent, machine)?;
    let machine = machine.with_axes(&intent.program.axes)?;
    let tolerance = tolerance(&intent, &machine, options)?;
    let text = sources.get(program).map_or("", |source| source.text.as_str());
    let reading = (machine.dialect.read)(text, program, &machine)?;
    // Whether lines were asked for or chosen cannot be seen, and matters for straight paths only: one line or many.
    let form = form_of(&reading.value.decimals);
    let settle = |asked| pass::settle::settle(intent.clone(), form, asked, tolerance);
    let check = |intent: &Intent| verify::verify(intent, &reading.value, text, program, &machine, tolerance);
    let chosen = settle(false)?;
    let (intent, report) = match check(&chosen) {
        Ok(report) => (chosen, report),
        Err(refused) => {
            let asked = settle(true)?;
            let report = if asked == chosen { Err(refused.clone()) } else { check(&asked) };
            // Of two refusals the first is told: the shorter program is the usual one.
            (asked, report.map_err(|_| refused)?)
        }
    };
    let legal = pass::check::check(reading.value.decimals, &machine)?;
    verify::same_form(text, &(machine.dialect.write)(&legal.value, &machine), program)?;
    let mut warnings = intent.warnings.clone();
    warnings.extend(reading.warnings);
    warnings.extend(pass::stretch::varying(&intent, &machine));
    warnings.extend(steps_exceed_tolerance(&intent, &report, tolerance));
    Ok(Verified { report, intent, tolerance, machine, warnings })
}

/// The form that a program's paths have: that of its first curve, or lines.
fn form_of(decimals: &ir::Decimals) -> Form {
    let mut curves = decimals.program.steps.iter().filter_map(|located| match &located.step.cut()?.curve {
        Written::Lines(_) | Written::Arc(_) => None,
        Written::Polynomial(_) => Some(Form::Polynomial { closing: false }),
        Written::Nurbs(_) => Some(Form::Nurbs),
        Written::Through(kind, _) => Some(Form::Through(*kind)),
    });
    curves.next().unwrap_or(Form::Lines)
}

fn with_options(mut intent: Intent, options: &Options) -> Intent {
    if let Some(number) = options.number {
        intent.program.number = number;
    }
    if let Some(method) = options.method {
        for located in &mut intent.program.steps {
            if let Step::Cut(Cut { curve: Curve::Logarithmic(log), .. }) = &mut located.step {
                log.method = method;
            }
        }
    }
    intent
}

/// A length that rounds to nothing, or to a diameter of nothing, is no path.
fn length_within_decimals(intent: &Intent, machine: &Machine) -> Result<(), Diagnostics> {
    let digits = machine.axis_digits()[0];
    for (log, _, span) in intent.logarithmic() {
        let units = decimal::round_units(log.curve.end(), digits).unwrap_or(0);
        let end = decimal::units_to_f64(units, digits);
        if units <= 0 || 1.0 + log.curve.beta() * end <= 0.0 {
            let message = format!(
                "with {digits} decimals the length {} becomes {end}, which is no path",
                log.curve.end()
            );
            return Err(Diagnostic::error("length-below-decimals", message).at(span, "").into());
        }
    }
    Ok(())
}

/// The warning where whole cycles were asked for and no steps are made.
fn overrun_without_steps(intent: &Intent) -> Diagnostics {
    let mut warnings = Diagnostics::new();
    if let Some((_, _, span)) =
        intent.logarithmic().find(|(log, ..)| log.overrun && log.method == Method::Direct)
    {
        let message =
            "overrun is a rule of odd-even steps; this path follows the curve itself and ends at its length";
        warnings.push(
            Diagnostic::warning("overrun-unused", message)
                .at(span, "")
                .hint("method = \"odd-even\" makes the steps"),
        );
    }
    warnings
}

/// What half a unit of the last decimal in every axis makes at the surface, mm.
fn resolution(intent: &Intent, machine: &Machine) -> f64 {
    0.5 * decimal::unit_at_surface(&machine.axes, &machine.axis_digits(), intent.radius())
}

/// The greatest tolerance, mm. A program may be off by a tolerance wherever it cuts; farther off no cut is the one that was
/// asked, and a figure like 1000 is a slip of its unit.
pub const MOST_TOLERANCE: f64 = 1.0;

/// The tolerance that holds: the command line's, the input's, the machine's.
///
/// # Errors
/// It is not positive, above [`MOST_TOLERANCE`], or below what the machine's decimals can carry.
fn tolerance(intent: &Intent, machine: &Machine, options: &Options) -> Result<f64, Diagnostics> {
    let tolerance =
        options.tolerance.or(intent.tolerance.map(|(tolerance, _)| tolerance)).unwrap_or(machine.tolerance);
    let place = intent.tolerance.filter(|_| options.tolerance.is_none()).map(|(_, span)| span);
    let at = |diagnostic: Diagnostic| match place {
        Some(span) => diagnostic.at(span, ""),
        None => diagnostic,
    };
    if !(0.0 < tolerance && tolerance.is_finite()) {
        return Err(
            at(Diagnostic::error("tolerance-range", "the tolerance must be greater than zero")).into()
        );
    }
    if MOST_TOLERANCE < tolerance {
        let message = format!("the tolerance of {tolerance} mm is above {MOST_TOLERANCE} mm");
        return Err(at(Diagnostic::error("tolerance-range", message)).into());
    }
    let least = resolution(intent, machine);
    if tolerance < least {
        let message = format!(
            "the tolerance of {tolerance} mm is below what the machine's decimals carry, {least:.2e} mm"
        );
        let diagnostic = Diagnostic::error("tolerance-below-decimals", message)
            .hint("allow a larger tolerance, or give the axes more decimals in the machine file");
        return Err(at(diagnostic).into());
    }
    Ok(tolerance)
}

/// The warning where odd-even steps leave the ideal curve by more than the tolerance, with the Δl that would hold it.
fn steps_exceed_tolerance(intent: &Intent, report: &Report, tolerance: f64) -> Diagnostics {
    let mut warnings = Diagnostics::new();
    let Some(from_ideal) = report.from_ideal.filter(|bound| tolerance < bound.mm) else { return warnings };
    let Some((log, _, span)) = intent.logarithmic().next() else { return warnings };
    let message = format!(
        "the steps leave the ideal curve by up to {:.3e} mm, more than the tolerance of {tolerance} mm",
        from_ideal.mm
    );
    let mut warning = Diagnostic::warning("steps-exceed-tolerance", message).at(span, "");
    if let Ok(dl) = pass::settle::step(log, tolerance) {
        // Rounded down, so that the figure named holds.
        let shown = decimal::Decimal::round((dl * 1.0e4).floor() / 1.0e4, 4).unwrap_or_default();
        let shown = if shown.is_zero() { format!("{dl:e}") } else { shown.to_string() };
        warning = warning.hint(format!("dl = {shown} would hold it, and so would a spline motion"));
    }
    warnings.push(warning);
    warnings
}
