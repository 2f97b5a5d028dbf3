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
//! # spindle = 3000.0  tool = 1
//! ```
//!
//! Each flute is a section: retract, return, index, approach, path, retract. Rapids go one axis at a time, and A never
//! turns before the retract axis is clear.

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::geom::logcurve::{Cutter, CutterError, Hand, Law, LogCurve};
use crate::geom::oddeven::{OddEven, StepError};
use crate::ir::{Curve, Cut, Intent, Located, Logarithmic, Method, Polyline, Program, Role, Step};
use crate::source::{Source, SourceId, Span};
use crate::tables::{self, Key};
use crate::units::{Axes, Axis, Kind, Position};
use serde::Deserialize;
use std::ops::Range;
use toml::Spanned;

/// The keys of a cutter file.
pub const KEYS: &[Key] = &[
    Key::value("name"),
    Key::table(
        "cutter",
        &[
            Key::value("D1"),
            Key::value("S"),
            Key::value("C"),
            Key::value("r"),
            Key::value("length"),
            Key::value("flutes"),
            Key::value("index"),
            Key::value("hand"),
            Key::value("law"),
        ],
    ),
    Key::table(
        "interpolation",
        &[
            Key::value("dl"),
            Key::value("Δl"),
            Key::value("method"),
            Key::value("overrun"),
            Key::value("tolerance"),
        ],
    ),
    Key::table(
        "process",
        &[
            Key::value("feed"),
            Key::table("retract", &[Key::value("axis"), Key::value("to")]),
            Key::value("spindle"),
            Key::value("tool"),
        ],
    ),
];

#[derive(Deserialize)]
struct File {
    name: Option<Spanned<String>>,
    cutter: Option<Spanned<CutterTable>>,
    interpolation: Option<InterpolationTable>,
    process: Option<Spanned<ProcessTable>>,
}

#[derive(Deserialize)]
#[allow(non_snake_case, reason = "the keys are the drawing's letters")]
struct CutterTable {
    D1: Option<Spanned<f64>>,
    S: Option<Spanned<f64>>,
    C: Option<Spanned<f64>>,
    r: Option<Spanned<f64>>,
    length: Option<Spanned<f64>>,
    flutes: Option<Spanned<i64>>,
    index: Option<Spanned<Vec<Spanned<f64>>>>,
    hand: Option<Spanned<String>>,
    law: Option<Spanned<String>>,
}

#[derive(Deserialize, Default)]
struct InterpolationTable {
    #[serde(alias = "Δl")]
    dl: Option<Spanned<f64>>,
    method: Option<Spanned<String>>,
    overrun: Option<bool>,
    tolerance: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
struct ProcessTable {
    feed: Option<Spanned<f64>>,
    retract: Option<Spanned<RetractTable>>,
    spindle: Option<Spanned<f64>>,
    tool: Option<Spanned<i64>>,
}

#[derive(Deserialize)]
struct RetractTable {
    axis: Option<Spanned<String>>,
    to: Option<Spanned<f64>>,
}

/// A cutter file, read and found sound.
#[derive(Clone, Debug, PartialEq)]
pub struct CutterJob {
    /// The program's name.
    pub name: String,
    /// Where it stands in the file.
    pub name_span: Option<Span>,
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
    /// mm/min along X Y Z.
    pub feed: Option<f64>,
    /// Which axis goes where, absolute and in clear air.
    pub retract: Option<(usize, f64)>,
    /// rev/min.
    pub spindle: Option<f64>,
    /// The tool's number.
    pub tool: u32,
    /// Where the process stands in the file, or the whole of it.
    pub span: Span,
}

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
        let process_span = file.process.as_ref().map_or(whole, |p| self.span(p.span()));
        let process = self.process(file.process.map(Spanned::into_inner), process_span);
        let flutes = flute_indices
            .into_iter()
            .map(|index| Logarithmic { curve: curve.with_index(index), method, dl, overrun })
            .collect();
        let name_span = file.name.as_ref().map(|name| self.span(name.span()));
        Some(CutterJob { name, name_span, flutes, tolerance, process, span: cutter_span })
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
            Ok(curve) => Some((curve, indices)),
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
                if index.get_ref().is_empty() {
                    self.error("flutes-range", "index names no flute", index.span());
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

    fn process(&mut self, table: Option<ProcessTable>, span: Span) -> Process {
        let mut process = Process { feed: None, retract: None, spindle: None, tool: 1, span };
        let Some(table) = table else { return process };
        let positive = |x: f64| 0.0 < x && x < 1.0e6;
        let must = "must be greater than zero and below a million";
        process.feed =
            table.feed.as_ref().map(|value| self.number("feed", value, "feed-range", must, positive));
        process.spindle = table
            .spindle
            .as_ref()
            .map(|value| self.number("spindle", value, "spindle-range", must, positive));
        if let Some(tool) = &table.tool {
            match u32::try_from(*tool.get_ref()) {
                Ok(number) if (1..=99_999_999).contains(&number) => process.tool = number,
                _ => self.error("tool-range", "tool must be 1 to 99999999", tool.span()),
            }
        }
        if let Some(retract) = &table.retract {
            let RetractTable { axis, to } = retract.get_ref();
            match (axis, to) {
                (Some(axis), Some(to)) => {
                    let found = Axis::new(axis.get_ref()).and_then(|name| Axes::xyza().index_of(name));
                    let linear = found.filter(|i| Axes::xyza().kind(*i) == Kind::Linear);
                    if linear.is_none() {
                        self.error("retract-axis", "the retract axis is X, Y or Z", axis.span());
                    }
                    let to = self.number("to", to, "retract-range", "must lie within a million mm", |x| {
                        x.abs() < 1.0e6
                    });
                    process.retract = linear.map(|axis| (axis, to));
                }
                _ => self.error(
                    "retract-missing",
                    "retract needs axis and to, as { axis = \"Z\", to = 50.0 }",
                    retract.span(),
                ),
            }
        }
        process
    }
}

/// Reads a cutter file as what a program is to be made of.
///
/// # Errors
/// As [`parse`]; also where feed or retract is missing.
pub fn parse_program(source: &Source, id: SourceId) -> Result<Intent, Diagnostics> {
    let job = parse(source, id)?;
    let mut diagnostics = Diagnostics::new();
    let mut missing = |id, what: &str, line: &str| {
        diagnostics.push(
            Diagnostic::error(id, format!("a program needs {what}"))
                .at(job.process.span, "")
                .hint(format!("add under [process]: {line}")),
        );
    };
    if job.process.feed.is_none() {
        missing("feed-missing", "a feed", "feed = 200.0");
    }
    if job.process.retract.is_none() {
        missing(
            "retract-missing",
            "a place in clear air to retract to",
            "retract = { axis = \"Z\", to = 50.0 }",
        );
    }
    if let Some((axis, to)) = job.process.retract {
        let clear = job.flutes.iter().all(|flute| {
            let far = flute_end(flute);
            let (start, end) = (flute.curve.position(0.0)[axis], flute.curve.position(far)[axis]);
            to < start.min(end) || start.max(end) < to
        });
        if !clear {
            let name = Axes::xyza().name(axis);
            diagnostics.push(
                Diagnostic::error(
                    "retract-not-clear",
                    format!("{name} {to} lies on the way that {name} takes over the cutter"),
                )
                .at(job.process.span, "")
                .hint("retract to a position that the path does not reach"),
            );
        }
    }
    diagnostics.into_result()?;
    Ok(job.intent())
}

/// The greatest X that a flute may reach: an overrun ends within two steps of the end.
fn flute_end(flute: &Logarithmic) -> f64 {
    let more = if flute.overrun { 2.0 * flute.dl.unwrap_or(crate::pass::settle::MAX_STEP) } else { 0.0 };
    flute.curve.end() + more
}

impl CutterJob {
    /// The program, without the moves that feed and retract would allow where those are missing.
    pub fn intent(&self) -> Intent {
        let axes = Axes::xyza();
        let mut steps = Vec::new();
        let mut add = |step: Step<f64, Curve>| steps.push(Located { step, span: self.span });
        let Process { feed, retract, spindle, tool, .. } = self.process;
        if retract.is_some() {
            add(Step::Tool(tool));
        }
        if let Some(rpm) = spindle {
            add(Step::Spindle(rpm));
        }
        let count = self.flutes.len();
        for (i, flute) in self.flutes.iter().enumerate() {
            let start = flute.curve.position(0.0);
            let shown = crate::decimal::Decimal::round(flute.curve.index, 4).unwrap_or_default();
            add(Step::Comment(format!("FLUTE {} OF {count}, A {shown}", i + 1)));
            if let Some((axis, to)) = retract {
                add(Step::Rapid(vec![(axis, to)]));
                let linear_first = (0..axes.count()).filter(|other| *other != axis);
                for other in linear_first {
                    add(Step::Rapid(vec![(other, start[other])]));
                }
                let mut clear: Position = start;
                clear[axis] = to;
                let mut approach = Polyline::new(clear, axes.count());
                approach.push(&start);
                add(Step::Cut(Cut { feed, role: Role::Approach, curve: Curve::Lines(approach) }));
            }
            add(Step::Cut(Cut { feed, role: Role::Path, curve: Curve::Logarithmic(flute.clone()) }));
            if let Some((axis, to)) = retract {
                add(Step::Rapid(vec![(axis, to)]));
            }
        }
        Intent {
            program: Program { name: self.name.clone(), axes, steps },
            tolerance: self.tolerance,
            name_span: self.name_span,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAPER: &str = "name = \"CONE10\"\n[cutter]\nD1 = 10\nS = 30\nC = 5\nr = 8\nlength = 30\n";

    fn ids(text: &str) -> Vec<&'static str> {
        match parse_program(&Source::new("t", text), SourceId::INPUT) {
            Ok(_) => vec![],
            Err(errors) => errors.0.iter().map(|d| d.id).collect(),
        }
    }

    #[test]
    fn the_smallest_file_is_enough_for_points() {
        let job = parse(&Source::new("t", PAPER), SourceId::INPUT).unwrap();
        assert_eq!((job.flutes.len(), job.flutes[0].curve.end()), (1, 30.0));
        assert_eq!(ids(PAPER), ["feed-missing", "retract-missing"]);
    }

    #[test]
    fn the_greek_key_and_the_byte_order_mark_are_taken() {
        let text = format!("\u{feff}{PAPER}[interpolation]\n\"Δl\" = 0.5\n");
        assert_eq!(parse(&Source::new("t", text), SourceId::INPUT).unwrap().flutes[0].dl, Some(0.5));
    }

    #[test]
    fn a_flute_is_retracted_before_anything_turns() {
        let text =
            format!("{PAPER}flutes = 2\n[process]\nfeed = 200\nretract = {{ axis = \"Z\", to = 50 }}\n");
        let intent = parse_program(&Source::new("t", text), SourceId::INPUT).unwrap();
        let moves: Vec<(usize, f64)> = intent
            .program
            .steps
            .iter()
            .filter_map(|located| match &located.step {
                Step::Rapid(axes) => Some(axes[0]),
                Step::Comment(_) | Step::Tool(_) | Step::Spindle(_) | Step::Cut(_) => None,
            })
            .collect();
        let flute = |a: f64| [(2, 50.0), (0, 0.0), (1, 0.0), (3, a), (2, 50.0)];
        assert_eq!(moves, [flute(0.0), flute(180.0)].concat());
    }

    #[test]
    fn what_is_wrong_is_named() {
        let process = "[process]\nfeed = 200\nretract = { axis = \"Z\", to = 50 }\n";
        let with = |from: &str, to: &str| ids(&format!("{}{process}", PAPER.replace(from, to)));
        assert_eq!(with("D1 = 10", "D1 = 0"), ["not-positive"]);
        assert_eq!(with("S = 30", "S = 90"), ["angle-range"]);
        assert_eq!(with("C = 5", "C = -45"), ["taper-ends"]);
        assert_eq!(with("length = 30", "length = nan"), ["not-finite"]);
        assert_eq!(with("D1 = 10\nS = 30\n", ""), ["key-missing", "key-missing"]);
        assert_eq!(with("r = 8", "r = 8\nflutes = 0"), ["flutes-range"]);
        assert_eq!(with("r = 8", "r = 8\nhand = \"up\""), ["word-unknown"]);
        assert_eq!(with("length = 30\n", "length = 30\n[interpolation]\ndl = 900\n"), ["step-too-large"]);
        assert_eq!(ids(&format!("{PAPER}{}", process.replace("50", "0.2"))), ["retract-not-clear"]);
        assert_eq!(ids(""), ["cutter-missing"]);
    }
}
