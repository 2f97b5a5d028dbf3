//! Conical cutters: a TOML file with the figures of the drawing becomes the path of each flute.
//!
//! ```toml
//! name = "CONE10"
//!
//! [cutter]
//! D1 = 10.0          # end diameter, mm                                   ISO 13399: DC
//! S = 30.0           # spiral angle, degrees                              FHA
//! C = 5.0            # cone angle to the axis, degrees                    BHTA
//! r = 8.0            # rake, degrees                                      GAMF
//! length = 30.0      # travel along X, mm                                 APMX
//! flutes = 4         # default 1                                          NOF
//! # index = [0.0, 88.0, 180.0, 268.0]     instead of flutes
//! # hand = "left"  law = "constant-lead"
//!
//! [interpolation]    # optional
//! # dl = 0.2  method = "auto"  overrun = false  tolerance = 0.001
//!
//! [process]          # a program needs feed and retract; a table of points does not
//! feed = 200.0       # mm/min
//! retract = { axis = "Z", to = 50.0 }
//! # spindle = 3000.0  coolant = true  tool = 1  feed_along = "path"  approach_feed = 100.0  return_feed = 1000.0
//! # travel = "from-D1"  run_in = 2.0  run_out = 2.0
//! # infeed = { axis = "Y", sign = 1, step = 0.2, passes = 3 }  spark_out = 1  order = "flute"
//! # correction = { axis = "Y", value = 0.0 }
//! ```
//!
//! Each pass over a flute is a section: retract, return, index, approach, path, retract. Rapids go one axis at a time,
//! and A never turns before the retract axis is clear.

mod file;
mod process;
mod program;

use file::{CutterTable, File};
pub use file::{KEYS, schema};
pub use program::parse_program;

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::geom::logcurve::{Cutter, CutterError, Hand, Law, LogCurve};
use crate::geom::oddeven::{OddEven, StepError};
use crate::ir::{Logarithmic, Method};
use crate::source::{Source, SourceId, Span};
use crate::tables;
use crate::units::DEGREES;
use std::ops::Range;
use toml::Spanned;

/// A cutter file, read and found sound.
#[derive(Clone, Debug, PartialEq)]
pub struct CutterJob {
    /// The program's name.
    pub name: String,
    /// Where it stands in the file.
    pub name_span: Option<Span>,
    /// Its number, where the control wants one; 0: nobody chose one.
    pub number: u32,
    /// The paths of the flutes, in order.
    pub flutes: Vec<Logarithmic>,
    /// The tolerance of the input, mm, and where it stands.
    pub tolerance: Option<(f64, Span)>,
    /// Feed, retract, spindle, tool.
    pub process: Process,
    /// Where the cutter stands in the file.
    pub span: Span,
}

/// What the machine needs beside the path.
#[derive(Clone, Debug, PartialEq)]
pub struct Process {
    /// mm/min or degrees/min along what the flutes say.
    pub feed: Option<f64>,
    /// mm/min of the move to the work; none: what feed makes along X Y Z where the path begins.
    pub approach_feed: Option<f64>,
    /// mm/min back to the start of a path; none: rapid traverse.
    pub return_feed: Option<f64>,
    /// Which axis goes where, absolute and in clear air.
    pub retract: Option<(usize, f64)>,
    /// rev/min.
    pub spindle: Option<f64>,
    /// Whether the coolant flows.
    pub coolant: bool,
    /// The tool's number.
    pub tool: u32,
    /// Rough passes before the finishing one.
    pub infeed: Option<Infeed>,
    /// How often the finishing pass is made again without infeed.
    pub spark_out: u32,
    /// In which order flutes and passes are taken.
    pub order: Order,
    /// A parameter that shifts all paths: its axis and its value, mm.
    pub correction: Option<(usize, f64)>,
    /// Where the process stands in the file, or the whole of it.
    pub span: Span,
}

/// Rough passes: the whole path, shifted away from the finished one by step after step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Infeed {
    /// Y or Z, as an index into X Y Z A.
    pub axis: usize,
    /// mm from one pass to the next; its sign says on which side the stock is.
    pub step: f64,
    /// How many rough passes there are.
    pub passes: u32,
}

/// In which order flutes and passes are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// All passes of a flute, then the next flute.
    Flute,
    /// A pass on all flutes, then the next pass.
    Pass,
}

/// Below this the end diameter is no drawing's figure, mm.
const LEAST_DIAMETER: f64 = 0.001;

/// The greatest turn of A over a flute, degrees: what the narrowest control counts (Heidenhain: ±99 999.9999), less room
/// for an index.
const MAX_TURN: f64 = 99_000.0;

/// The most passes of one kind.
const MAX_PASSES: i64 = 1000;

/// The most flutes a cutter may have.
const MAX_FLUTES: i64 = 1000;

struct Reader {
    source: SourceId,
    diagnostics: Diagnostics,
}

impl Reader {
    fn span(&self, range: Range<usize>) -> Span {
        Span::new(self.source, range)
    }

    fn error(&mut self, id: &'static str, message: impl Into<String>, range: Range<usize>) {
        let span = self.span(range);
        self.diagnostics.push(Diagnostic::error(id, message).at(span, ""));
    }

    /// A number that is finite and lies within what `holds` says.
    fn number(
        &mut self,
        key: &str,
        value: &Spanned<f64>,
        id: &'static str,
        must: &str,
        holds: impl Fn(f64) -> bool,
    ) -> f64 {
        let x = *value.get_ref();
        if !x.is_finite() {
            self.error("not-finite", format!("{key} must be a finite number"), value.span());
        } else if !holds(x) {
            self.error(id, format!("{key} {must}"), value.span());
        }
        x
    }

    /// One of a few words.
    fn word<T: Copy>(&mut self, key: &str, value: Option<&Spanned<String>>, words: &[(&str, T)]) -> T {
        let Some(value) = value else { return words[0].1 };
        if let Some((_, meaning)) = words.iter().find(|(word, _)| word == value.get_ref()) {
            return *meaning;
        }
        let names: Vec<String> = words.iter().map(|(word, _)| format!("\"{word}\"")).collect();
        let span = self.span(value.span());
        self.diagnostics.push(
            Diagnostic::error("word-unknown", format!("`{}` is not a {key}", value.get_ref()))
                .at(span, "")
                .hint(format!("{key} is {}", names.join(" or "))),
        );
        words[0].1
    }
}

/// Reads a cutter file.
///
/// # Errors
/// Whatever keeps a path from being made of it, all at once where that makes sense.
pub fn parse(source: &Source, id: SourceId) -> Result<CutterJob, Diagnostics> {
    let text =
        source.text.strip_prefix('\u{feff}').map_or_else(|| source.text.clone(), |rest| format!("   {rest}"));
    let file: File = tables::read(&text, id, KEYS)?;
    let mut reader = Reader { source: id, diagnostics: Diagnostics::new() };
    let job = reader.job(file, text.len());
    reader.diagnostics.into_result()?;
    job.ok_or_else(Diagnostics::new)
}

impl Reader {
    fn job(&mut self, file: File, length: usize) -> Option<CutterJob> {
        let whole = self.span(0..length.min(1));
        let Some(cutter) = file.cutter else {
            let name = file.name.as_ref().map_or(0..0, Spanned::span);
            self.diagnostics.push(
                Diagnostic::error("cutter-missing", "the file has no [cutter] table")
                    .at(self.span(name), "")
                    .hint("add [cutter] with D1, S, C, r and length"),
            );
            return None;
        };
        let cutter_span = self.span(cutter.span());
        let name = file.name.as_ref().map_or_else(|| "CUTTER".to_owned(), |name| name.get_ref().clone());
        if let Some(spanned) = &file.name
            && (name.is_empty()
                || 64 < name.len()
                || !name.bytes().all(|b| (32..127).contains(&b))
                || name.trim() != name)
        {
            self.error("name-characters", "name must be 1 to 64 printable ASCII characters", spanned.span());
        }
        let number = match &file.number {
            None => 0,
            Some(number) => {
                if !(1..=9999).contains(number.get_ref()) {
                    self.error("number-range", "number is 1 to 9999", number.span());
                }
                u32::try_from(*number.get_ref()).unwrap_or(1)
            }
        };
        let interpolation = file.interpolation.unwrap_or_default();
        let method = self.word(
            "method",
            interpolation.method.as_ref(),
            &[("auto", Method::Auto), ("odd-even", Method::OddEven), ("direct", Method::Direct)],
        );
        let tolerance = interpolation.tolerance.as_ref().map(|value| {
            let span = self.span(value.span());
            (
                self.number("tolerance", value, "tolerance-range", "must be greater than zero", |x| 0.0 < x),
                span,
            )
        });
        let dl = interpolation
            .dl
            .as_ref()
            .map(|value| self.number("dl", value, "step-range", "must be greater than zero", |x| 0.0 < x));
        let (curve, flute_indices) = self.cutter(&cutter)?;
        let travel = self.travel(file.process.as_ref().map(Spanned::get_ref));
        let curve = self.extended(curve, &travel, file.process.as_ref())?;
        let overrun = interpolation.overrun.unwrap_or(false);
        if overrun && method == Method::Direct {
            let span = interpolation.method.as_ref().map_or(0..0, Spanned::span);
            self.error(
                "overrun-direct",
                "overrun is a rule of odd-even steps; the direct method ends exactly",
                span,
            );
        }
        if let (Some(step), Some(spanned)) = (dl, &interpolation.dl)
            && 0.0 < step
            && let Err(error) = OddEven::new(curve, step, overrun)
        {
            let id = match error {
                StepError::TooLarge { .. } => "step-too-large",
                StepError::TooManyPoints { .. } => "points-too-many",
                StepError::NotPositive => "step-range",
            };
            self.error(id, error.to_string(), spanned.span());
        }
        let unknown_end = overrun
            && (travel.back || file.process.as_ref().is_some_and(|p| p.get_ref().return_feed.is_some()));
        if unknown_end {
            let span = interpolation.method.as_ref().map_or(cutter.span(), Spanned::span);
            let message = "where an overrun ends follows from its steps: it cannot be run back, nor returned from at feed";
            self.error("overrun-travel", message, span);
        }
        let process_span = file.process.as_ref().map_or(whole, |p| self.span(p.span()));
        let process = self.process(file.process.map(Spanned::into_inner), process_span);
        let flutes = flute_indices
            .into_iter()
            .map(|index| Logarithmic {
                curve: curve.with_index(index),
                method,
                dl,
                overrun,
                back: travel.back,
                along: travel.along,
            })
            .collect();
        let name_span = file.name.as_ref().map(|name| self.span(name.span()));
        Some(CutterJob { name, name_span, number, flutes, tolerance, process, span: cutter_span })
    }

    /// The curve of the first flute and the index of each.
    fn cutter(&mut self, table: &Spanned<CutterTable>) -> Option<(LogCurve, Vec<f64>)> {
        let t = table.get_ref();
        let required = [
            ("D1", &t.D1, "10.0"),
            ("S", &t.S, "30.0"),
            ("C", &t.C, "5.0"),
            ("r", &t.r, "8.0"),
            ("length", &t.length, "30.0"),
        ];
        let mut missing = false;
        for (key, value, example) in required {
            if value.is_none() {
                missing = true;
                let span = self.span(table.span());
                self.diagnostics.push(
                    Diagnostic::error("key-missing", format!("[cutter] has no `{key}`"))
                        .at(span, "")
                        .hint(format!("add a line like `{key} = {example}`")),
                );
            }
        }
        let hand = self.word("hand", t.hand.as_ref(), &[("right", Hand::Right), ("left", Hand::Left)]);
        let law = self.word(
            "law",
            t.law.as_ref(),
            &[("constant-helix", Law::ConstantHelix), ("constant-lead", Law::ConstantLead)],
        );
        let indices = self.indices(t);
        if missing {
            return None;
        }
        let value = |v: &Option<Spanned<f64>>| v.as_ref().map_or(0.0, |v| *v.get_ref());
        let cutter = Cutter {
            d1: value(&t.D1),
            s: value(&t.S),
            c: value(&t.C),
            r: value(&t.r),
            length: value(&t.length),
            hand,
            law,
        };
        match LogCurve::new(cutter, 0.0) {
            Ok(curve) => {
                if cutter.d1 < LEAST_DIAMETER {
                    let place = t.D1.as_ref().map_or(table.span(), Spanned::span);
                    self.error("diameter-range", format!("D1 must be at least {LEAST_DIAMETER} mm"), place);
                }
                let turn = curve.angle(curve.end()).abs() * DEGREES;
                if !(turn <= MAX_TURN) {
                    let message =
                        format!("A would turn by {turn:.0} degrees; no control counts beyond {MAX_TURN}");
                    self.error("turn-range", message, table.span());
                }
                Some((curve, indices))
            }
            Err(error) => {
                let (key, id) = match error {
                    CutterError::NotFinite(key) => (key, "not-finite"),
                    CutterError::NotPositive(key) => (key, "not-positive"),
                    CutterError::RightAngle(key) => (key, "angle-range"),
                    CutterError::Vanishes { .. } => ("length", "taper-ends"),
                };
                let place = required.iter().find(|(name, ..)| *name == key).and_then(|(_, v, _)| v.as_ref());
                self.error(id, error.to_string(), place.map_or(table.span(), Spanned::span));
                None
            }
        }
    }

    fn indices(&mut self, t: &CutterTable) -> Vec<f64> {
        match (&t.flutes, &t.index) {
            (Some(flutes), Some(_)) => {
                self.error(
                    "flutes-and-index",
                    "flutes and index both say how many flutes there are",
                    flutes.span(),
                );
                vec![0.0]
            }
            (_, Some(index)) => {
                if !(1..=MAX_FLUTES as usize).contains(&index.get_ref().len()) {
                    self.error(
                        "flutes-range",
                        format!("index must name 1 to {MAX_FLUTES} flutes"),
                        index.span(),
                    );
                }
                let in_range = |x: f64| x.abs() <= 360.0;
                index
                    .get_ref()
                    .iter()
                    .map(|value| {
                        self.number(
                            "index",
                            value,
                            "index-range",
                            "must lie within -360 and 360 degrees",
                            in_range,
                        )
                    })
                    .collect()
            }
            (Some(flutes), None) => {
                let n = *flutes.get_ref();
                if !(1..=MAX_FLUTES).contains(&n) {
                    self.error("flutes-range", format!("flutes must be 1 to {MAX_FLUTES}"), flutes.span());
                    return vec![0.0];
                }
                (0..n).map(|i| 360.0 * i as f64 / n as f64).collect()
            }
            (None, None) => vec![0.0],
        }
    }
}

#[cfg(test)]
mod tests;
