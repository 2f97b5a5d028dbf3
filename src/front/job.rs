//! Jobs: a TOML file with curves, feed and tool becomes a program that runs along them.
//!
//! ```toml
//! name = "QUARTER"
//! # tolerance = 0.001            # mm
//! # radius = 20.0                # mm, at which rotary axes count
//!
//! [process]
//! feed = 1000.0                  # mm/min
//! retract = { axis = "Z", to = 50.0 }
//! # spindle = 3000.0  tool = 1
//!
//! [[curve]]
//! kind = "nurbs"                 # or "bezier", "polynomial", "points"
//! axes = ["X", "Y"]
//! at = { Z = -2.0 }              # the other axes; by default they stay where they are
//! degree = 2
//! knots = [0, 0, 0, 1, 1, 1]
//! points = [[10, 0], [10, 10], [0, 10]]
//! weights = [1, 0.7071067811865476, 1]
//! ```
//!
//! | kind | keys | the curve |
//! |---|---|---|
//! | `nurbs` | `degree`, `knots`, `points`, `weights` | Σ N_i w_i P_i / Σ N_i w_i on t_p ≤ t ≤ t_{n+1}; clamped or not |
//! | `bezier` | `points`, `degree`, `weights` | Bezier curves of one degree in a row, each starting where the last ended |
//! | `polynomial` | `coefficients`, `range` | X(u) = x₀ + x₁u + x₂u² … for each axis |
//! | `points` | `points` | straight lines from point to point |
//! | `expression` | `X` … `C`, `u`, `constants` | X(u), Y(u) … as expressions; angles in radians, rotary axes in degrees |
//!
//! A curve may also stand in a file of a CAD system (`files.rs`):
//!
//! ```toml
//! [[curve]]
//! file = "outline.dxf"           # or .igs, .stp: a path from where the job stands
//! # units = "mm"                 # where the file does not say
//! # order = "chain"              # each curve next to the one that it meets
//! # join = 0.01                  # mm; closes gaps with a straight line
//! ```
//!
//! Curves are run in their order. Where one starts within [`MEET`] of where the one before ended they are joined;
//! elsewhere the tool retracts between them.

mod curves;
mod expression;
mod file;
mod files;
mod program;

pub use file::{KEYS, schema};
pub use files::named;
pub use program::parse_program;

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::ir::Curve;
use crate::source::{SourceId, Sources, Span};
use crate::tables;
use crate::units::{Axes, Axis, Kind, MAX_AXES, Position};
use file::{File, ProcessTable, RetractTable};
use std::ops::Range;
use toml::Spanned;

/// Curves meet where they are no farther apart than this, mm or degrees: what six printed decimals may lose.
pub const MEET: f64 = 2.0e-6;

/// The greatest coordinate, mm or degrees.
const GREATEST: f64 = 1.0e6;

/// A job file, read and found sound.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// The program's name.
    pub name: String,
    /// Where it stands in the file.
    pub name_span: Option<Span>,
    /// Its number, where the control wants one; 0: nobody chose one.
    pub number: u32,
    /// The tolerance of the input, mm, and where it stands.
    pub tolerance: Option<(f64, Span)>,
    /// The radius at which rotary axes count, mm.
    pub radius: Option<f64>,
    /// The coordinates of the program.
    pub axes: Axes,
    /// The curves, in order.
    pub curves: Vec<Placed>,
    /// Feed, retract, spindle, tool.
    pub process: Process,
    /// What to know.
    pub warnings: Diagnostics,
}

/// A curve in the coordinates of the program.
#[derive(Clone, Debug, PartialEq)]
pub struct Placed {
    /// The curve.
    pub curve: Curve,
    /// Where it starts.
    pub start: Position,
    /// Where it ends.
    pub end: Position,
    /// Where it stands in the file.
    pub span: Span,
    /// How far it may be from what the input states, mm.
    pub error: f64,
    /// Whether the retract axis rests where it is clear: nothing has said yet where it cuts.
    pub rests: bool,
}

/// What the machine needs beside the path.
#[derive(Clone, Debug, PartialEq)]
pub struct Process {
    /// mm/min along the linear axes.
    pub feed: Option<f64>,
    /// Which axis goes where, absolute and in clear air.
    pub retract: Option<(Axis, f64)>,
    /// rev/min.
    pub spindle: Option<f64>,
    /// Whether the coolant flows.
    pub coolant: bool,
    /// The tool's number.
    pub tool: u32,
    /// Where the process stands in the file, or the start of it.
    pub span: Span,
}

/// What a name of an axis means: A B C turn, I J K are no axes, others are linear.
fn kind_of(axis: Axis) -> Kind {
    match axis.as_str().as_bytes()[0] {
        b'A' | b'B' | b'C' => Kind::Rotary,
        _ => Kind::Linear,
    }
}

/// Where an axis stands among the others: X Y Z, U V W, A B C, then by name.
fn rank(axis: Axis) -> (usize, Axis) {
    let first = axis.as_str().as_bytes()[0];
    (b"XYZUVWABC".iter().position(|letter| *letter == first).unwrap_or(9), axis)
}

struct Reader<'s> {
    sources: &'s Sources,
    source: SourceId,
    diagnostics: Diagnostics,
}

/// Reads a job file.
///
/// # Errors
/// Whatever keeps a path from being made of it, all at once where that makes sense.
pub fn parse(sources: &Sources, id: SourceId) -> Result<Job, Diagnostics> {
    let source = sources.get(id).ok_or_else(Diagnostics::new)?;
    let text =
        source.text.strip_prefix('\u{feff}').map_or_else(|| source.text.clone(), |rest| format!("   {rest}"));
    let file: File = tables::read(&text, id, KEYS)?;
    let mut reader = Reader { sources, source: id, diagnostics: Diagnostics::new() };
    let job = reader.job(file, text.len());
    let warnings = reader.diagnostics.into_result()?;
    job.map(|job| Job { warnings, ..job }).ok_or_else(Diagnostics::new)
}

impl Reader<'_> {
    fn span(&self, range: Range<usize>) -> Span {
        Span::new(self.source, range)
    }

    fn error(&mut self, id: &'static str, message: impl Into<String>, range: Range<usize>) {
        let span = self.span(range);
        self.diagnostics.push(Diagnostic::error(id, message).at(span, ""));
    }

    fn hinted(&mut self, id: &'static str, message: String, range: Range<usize>, hint: impl Into<String>) {
        let span = self.span(range);
        self.diagnostics.push(Diagnostic::error(id, message).at(span, "").hint(hint));
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

    fn job(&mut self, file: File, length: usize) -> Option<Job> {
        let whole = self.span(0..length.min(1));
        let name = file.name.as_ref().map_or_else(|| "JOB".to_owned(), |name| name.get_ref().clone());
        if let Some(spanned) = &file.name
            && (name.is_empty()
                || 64 < name.len()
                || !name.bytes().all(|b| (32..127).contains(&b))
                || name.trim() != name)
        {
            self.error("name-characters", "name must be 1 to 64 printable ASCII characters", spanned.span());
        }
        let positive = |x: f64| 0.0 < x && x < 1.0e6;
        let must = "must be greater than zero and below a million";
        let tolerance = file.tolerance.as_ref().map(|value| {
            let span = self.span(value.span());
            (self.number("tolerance", value, "tolerance-range", must, positive), span)
        });
        let radius =
            file.radius.as_ref().map(|value| self.number("radius", value, "radius-range", must, positive));
        let process_span = file.process.as_ref().map_or(whole, |p| self.span(p.span()));
        let process = self.process(file.process.map(Spanned::into_inner), process_span);
        let tables = file.curve.unwrap_or_default();
        if tables.is_empty() {
            let at = file.name.as_ref().map_or(0..0, Spanned::span);
            self.hinted(
                "curve-missing",
                "the file has no [[curve]]".to_owned(),
                at,
                "add [[curve]] with kind, axes and points",
            );
            return None;
        }
        let shapes: Vec<curves::Shape> = tables.into_iter().flat_map(|table| self.shapes(table)).collect();
        let axes = self.axes(&shapes, process.retract)?;
        if self.diagnostics.has_errors() {
            return None;
        }
        let curves = self.placed(shapes, &axes, process.retract);
        let name_span = file.name.as_ref().map(|name| self.span(name.span()));
        let warnings = Diagnostics::new();
        let number = match &file.number {
            None => 0,
            Some(number) => {
                if !(1..=9999).contains(number.get_ref()) {
                    self.error("number-range", "number is 1 to 9999", number.span());
                }
                u32::try_from(*number.get_ref()).unwrap_or(1)
            }
        };
        Some(Job { name, name_span, number, tolerance, radius, axes, curves, process, warnings })
    }

    /// The coordinates of the program: those of all curves, and the retract axis.
    fn axes(&mut self, shapes: &[curves::Shape], retract: Option<(Axis, f64)>) -> Option<Axes> {
        let mut names: Vec<Axis> = shapes.iter().flat_map(curves::Shape::names).collect();
        names.extend(retract.map(|(axis, _)| axis));
        names.sort_by_key(|axis| rank(*axis));
        names.dedup();
        let list: Vec<(Axis, Kind)> = names.iter().map(|axis| (*axis, kind_of(*axis))).collect();
        let axes = Axes::new(&list);
        if axes.is_none()
            && let Some(shape) = shapes.last()
        {
            let (count, span) = (list.len(), shape.span);
            self.diagnostics.push(
                Diagnostic::error("axes-too-many", format!("{count} axes move together; {MAX_AXES} can"))
                    .at(span, ""),
            );
        }
        axes
    }

    /// Every curve in the coordinates of the program, the axes that it does not name where they stay.
    fn placed(
        &mut self,
        shapes: Vec<curves::Shape>,
        axes: &Axes,
        retract: Option<(Axis, f64)>,
    ) -> Vec<Placed> {
        let mut known: [Option<f64>; MAX_AXES] = [None; MAX_AXES];
        let mut warned = false;
        let mut rests = retract.is_some();
        let mut placed = Vec::with_capacity(shapes.len());
        for shape in shapes {
            let mut rest = [0.0; MAX_AXES];
            rests &= retract.is_some_and(|(axis, _)| shape.names().all(|name| name != axis));
            for i in 0..axes.count() {
                let name = axes.name(i);
                if shape.axes.contains(&name) {
                    continue;
                }
                let stated = shape.at.iter().find(|(axis, _)| *axis == name).map(|(_, x)| *x);
                let clear = retract.filter(|(axis, _)| *axis == name).map(|(_, to)| to);
                match stated.or(known[i]) {
                    Some(x) => rest[i] = x,
                    None => match clear {
                        Some(to) => {
                            rest[i] = to;
                            if !warned {
                                warned = true;
                                let message =
                                    format!("{name} stays at {to}, where it is clear, along this curve");
                                self.diagnostics.push(
                                    Diagnostic::warning("retract-axis-rests", message)
                                        .at(shape.span, "")
                                        .hint(format!("say where it cuts: at = {{ {name} = 0.0 }}")),
                                );
                            }
                        }
                        None => {
                            let message = format!("nothing says where {name} is along this curve");
                            self.diagnostics.push(
                                Diagnostic::error("axis-unplaced", message)
                                    .at(shape.span, "")
                                    .hint(format!("add to the curve: at = {{ {name} = 0.0 }}")),
                            );
                        }
                    },
                }
            }
            let one = Placed { rests, ..shape.place(axes, &rest) };
            for i in 0..axes.count() {
                known[i] = Some(one.end[i]);
            }
            placed.push(one);
        }
        placed
    }

    fn process(&mut self, table: Option<ProcessTable>, span: Span) -> Process {
        let mut process = Process { feed: None, retract: None, spindle: None, coolant: false, tool: 1, span };
        let Some(table) = table else { return process };
        let positive = |x: f64| 0.0 < x && x < 1.0e6;
        let must = "must be greater than zero and below a million";
        process.feed =
            table.feed.as_ref().map(|value| self.number("feed", value, "feed-range", must, positive));
        process.coolant = table.coolant.unwrap_or(false);
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
            let RetractTable { axis: Some(axis), to: Some(to) } = retract.get_ref() else {
                let message = "retract needs axis and to, as { axis = \"Z\", to = 50.0 }";
                self.error("retract-missing", message, retract.span());
                return process;
            };
            let linear = self.axis(axis).filter(|axis| kind_of(*axis) == Kind::Linear);
            if linear.is_none() {
                self.error("retract-axis", "the retract axis is a linear one, as X, Y or Z", axis.span());
            }
            let within = |x: f64| x.abs() < GREATEST;
            let to = self.number("to", to, "retract-range", "must lie within a million mm", within);
            process.retract = linear.map(|axis| (axis, to));
        }
        process
    }

    /// The axis of a name.
    fn axis(&mut self, name: &Spanned<String>) -> Option<Axis> {
        let axis = Axis::new(name.get_ref());
        let direction = |axis: &Axis| matches!(axis.as_str().as_bytes()[0], b'I' | b'J' | b'K');
        if axis.is_none_or(|axis| direction(&axis)) {
            self.hinted(
                "axis-name",
                format!("`{}` is no axis", name.get_ref()),
                name.span(),
                "axes are called X Y Z, U V W, A B C, or X1 and so on",
            );
            return None;
        }
        axis
    }
}

#[cfg(test)]
mod tests;
