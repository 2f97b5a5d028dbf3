//! Machine files: what one machine takes, as data.
//!
//! A machine file is TOML; the built-ins have the same form and are embedded. A file may say
//! `extends = "sinumerik"` and then states only what differs. What a control's manual leaves open is a key here,
//! never a constant in the code. `splinepost machines --show NAME` prints a built-in with its comments: the best
//! start for a file of one's own.

pub mod template;

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::dialect::{self, Dialect, Motion};
use crate::source::{SourceId, Span};
use crate::tables::{self, Key, nearest};
use crate::units::{Axes, Axis, Kind, MAX_AXES};
use serde::Deserialize;
use template::Template;
use toml::Spanned;

/// The machines that are built in, with their files.
pub const BUILT_IN: &[(&str, &str)] = &[
    ("sinumerik", include_str!("sinumerik.toml")),
    ("sinumerik-840d", include_str!("sinumerik-840d.toml")),
    ("heidenhain", include_str!("heidenhain.toml")),
    ("mazak", include_str!("mazak.toml")),
];

/// The file of a built-in machine.
pub fn built_in(name: &str) -> Option<&'static str> {
    BUILT_IN.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}

/// One machine.
#[derive(Clone, Debug)]
pub struct Machine {
    /// Its name.
    pub name: String,
    /// What it is, in one line.
    pub about: String,
    /// How it is written to.
    pub dialect: &'static Dialect,
    /// The motion for cutting pieces; none for `auto`.
    pub motion: Option<&'static Motion>,
    /// mm, where neither the command line nor the input says.
    pub tolerance: f64,
    /// Its axes.
    pub axes: Axes,
    /// Whether rotary axes wrap at 360°.
    pub wraps: bool,
    /// Decimals.
    pub digits: Digits,
    /// Spelling.
    pub text: Text,
    /// What its splines take.
    pub spline: Spline,
    /// The lines round a program.
    pub frame: Frame,
}

/// How many decimals an address takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Digits {
    /// Linear axes.
    pub linear: u8,
    /// Rotary axes.
    pub rotary: u8,
    /// Feed and spindle speed.
    pub feed: u8,
    /// PL of BSPLINE, K of G06.2.
    pub knot: u8,
    /// PW, R.
    pub weight: u8,
}

/// How text is spelled.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Text {
    /// `X30.` instead of `X30`.
    pub point_always: bool,
    /// `X+30` instead of `X30`.
    pub sign_always: bool,
    /// The first block number.
    pub number_start: u32,
    /// What it grows by; 0 for none at all.
    pub number_step: u32,
    /// The usual extension of a program file.
    pub extension: String,
}

/// What splines a machine takes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Spline {
    /// Which axes spline blocks may move.
    pub axes: Vec<Axis>,
    /// The greatest degree of polynomial blocks.
    pub poly_degree: usize,
    /// Whether all axes of a spline block share one parameter on the control.
    pub shared_parameter: bool,
    /// The fewest blocks a B-spline may have.
    pub bspline_min_blocks: usize,
    /// The word for the start condition of through-point splines.
    pub begin: String,
    /// The word for their end condition.
    pub end: String,
}

/// The lines round a program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Before the first step.
    pub header: Vec<Template>,
    /// A tool call.
    pub tool: Vec<Template>,
    /// The spindle's start.
    pub spindle: Vec<Template>,
    /// A tool call and the spindle's start in one, where a control wants them so; empty: one after the other.
    pub tool_spindle: Vec<Template>,
    /// After the last step.
    pub footer: Vec<Template>,
}

/// The keys of a machine file.
pub const KEYS: &[Key] = &[
    Key::value("extends"),
    Key::value("name"),
    Key::value("about"),
    Key::value("dialect"),
    Key::value("motion"),
    Key::value("tolerance"),
    Key::table("axes", &[Key::value("linear"), Key::value("rotary"), Key::value("wraps")]),
    Key::table(
        "digits",
        &[
            Key::value("linear"),
            Key::value("rotary"),
            Key::value("feed"),
            Key::value("knot"),
            Key::value("weight"),
        ],
    ),
    Key::table(
        "text",
        &[
            Key::value("point_always"),
            Key::value("sign_always"),
            Key::value("number_start"),
            Key::value("number_step"),
            Key::value("extension"),
        ],
    ),
    Key::table(
        "spline",
        &[
            Key::value("axes"),
            Key::value("poly_degree"),
            Key::value("shared_parameter"),
            Key::value("bspline_min_blocks"),
            Key::value("begin"),
            Key::value("end"),
        ],
    ),
    Key::table(
        "program",
        &[
            Key::value("header"),
            Key::value("tool"),
            Key::value("spindle"),
            Key::value("tool_spindle"),
            Key::value("footer"),
        ],
    ),
];

#[derive(Deserialize, Default)]
struct File {
    extends: Option<Spanned<String>>,
    name: Option<String>,
    about: Option<String>,
    dialect: Option<Spanned<String>>,
    motion: Option<Spanned<String>>,
    tolerance: Option<Spanned<f64>>,
    axes: Option<AxesFile>,
    digits: Option<DigitsFile>,
    text: Option<TextFile>,
    spline: Option<SplineFile>,
    program: Option<ProgramFile>,
}

#[derive(Deserialize, Default)]
struct AxesFile {
    linear: Option<Spanned<Vec<Spanned<String>>>>,
    rotary: Option<Spanned<Vec<Spanned<String>>>>,
    wraps: Option<bool>,
}

#[derive(Deserialize, Default)]
struct DigitsFile {
    linear: Option<Spanned<u8>>,
    rotary: Option<Spanned<u8>>,
    feed: Option<Spanned<u8>>,
    knot: Option<Spanned<u8>>,
    weight: Option<Spanned<u8>>,
}

#[derive(Deserialize, Default)]
struct TextFile {
    point_always: Option<bool>,
    sign_always: Option<bool>,
    number_start: Option<u32>,
    number_step: Option<u32>,
    extension: Option<String>,
}

#[derive(Deserialize, Default)]
struct SplineFile {
    axes: Option<Vec<Spanned<String>>>,
    poly_degree: Option<Spanned<usize>>,
    shared_parameter: Option<bool>,
    bspline_min_blocks: Option<Spanned<usize>>,
    begin: Option<Spanned<String>>,
    end: Option<Spanned<String>>,
}

#[derive(Deserialize, Default)]
struct ProgramFile {
    header: Option<Vec<Spanned<String>>>,
    tool: Option<Vec<Spanned<String>>>,
    spindle: Option<Vec<Spanned<String>>>,
    tool_spindle: Option<Vec<Spanned<String>>>,
    footer: Option<Vec<Spanned<String>>>,
}

impl Machine {
    /// A built-in machine.
    pub fn built_in(name: &str) -> Option<Machine> {
        // A test reads every built-in, so that an error cannot hide here.
        built_in(name).and_then(|text| Machine::parse(text, SourceId::INPUT).ok())
    }

    /// Reads a machine file.
    ///
    /// # Errors
    /// It is not TOML, has unknown keys or values that no machine can have, or extends a machine that is not built in.
    pub fn parse(text: &str, source: SourceId) -> Result<Machine, Diagnostics> {
        let file: File = tables::read(text, source, KEYS)?;
        let base = match &file.extends {
            None => None,
            Some(name) => match Machine::built_in(name.get_ref()) {
                Some(machine) => Some(machine),
                None => return Err(unknown_machine(name, source).into()),
            },
        };
        let mut at = Reader { source, diagnostics: Diagnostics::new() };
        let machine = at.machine(file, base.as_ref());
        at.diagnostics.into_result()?;
        // Where a value is missing, a diagnostic said so.
        machine.ok_or_else(Diagnostics::new)
    }

    /// The decimals of each of the program's axes.
    pub fn axis_digits(&self) -> [u8; MAX_AXES] {
        let mut digits = [0; MAX_AXES];
        for (i, (_, kind)) in self.axes.as_slice().iter().enumerate() {
            digits[i] = match kind {
                Kind::Linear | Kind::Direction => self.digits.linear,
                Kind::Rotary => self.digits.rotary,
            };
        }
        digits
    }

    /// The machine with these axes only, in this order; the program names no others, so they rest.
    ///
    /// # Errors
    /// The machine lacks one of them, or counts it as another kind.
    pub fn with_axes(&self, axes: &Axes) -> Result<Machine, Diagnostics> {
        for (axis, kind) in axes.as_slice() {
            let own = self.axes.index_of(*axis).map(|i| self.axes.kind(i));
            if own != Some(*kind) {
                let what = match kind {
                    Kind::Linear => "linear",
                    Kind::Rotary => "rotary",
                    Kind::Direction => "direction",
                };
                return Err(Diagnostic::error(
                    "axis-missing",
                    format!("machine `{}` has no {what} axis {axis}", self.name),
                )
                .hint("name it under [axes] in the machine file")
                .into());
            }
        }
        Ok(Machine { axes: *axes, ..self.clone() })
    }

    /// The axes that spline blocks may not move, of those given.
    pub fn axes_without_spline(&self, moving: &[Axis]) -> Vec<Axis> {
        moving.iter().copied().filter(|axis| !self.spline.axes.contains(axis)).collect()
    }
}

/// The diagnostic for a machine that is not built in.
fn unknown_machine(name: &Spanned<String>, source: SourceId) -> Diagnostic {
    let names = BUILT_IN.iter().map(|(name, _)| *name);
    let error =
        Diagnostic::error("machine-unknown", format!("there is no built-in machine `{}`", name.get_ref()))
            .at(Span::new(source, name.span()), "not built in");
    match nearest(name.get_ref(), names.clone()) {
        Some(meant) => error.hint(format!("did you mean `{meant}`?")),
        None => error.hint(format!("built in are {}", names.collect::<Vec<_>>().join(", "))),
    }
}

struct Reader {
    source: SourceId,
    diagnostics: Diagnostics,
}

impl Reader {
    fn error(&mut self, id: &'static str, message: impl Into<String>, span: std::ops::Range<usize>) {
        let span = Span::new(self.source, span);
        self.diagnostics.push(Diagnostic::error(id, message).at(span, ""));
    }

    fn missing<T>(&mut self, key: &str) -> Option<T> {
        self.diagnostics.push(
            Diagnostic::error("key-missing", format!("the machine file has no `{key}`")).hint(
                "start with `extends = \"sinumerik\"` (or heidenhain, mazak) and state only what differs",
            ),
        );
        None
    }

    fn or<T>(&mut self, own: Option<T>, base: Option<T>, key: &str) -> Option<T> {
        own.or(base).or_else(|| self.missing(key))
    }

    fn machine(&mut self, file: File, base: Option<&Machine>) -> Option<Machine> {
        let dialect = match &file.dialect {
            None => self.or(None, base.map(|b| b.dialect), "dialect"),
            Some(name) => {
                let found = dialect::find(name.get_ref());
                if found.is_none() {
                    let names: Vec<&str> = dialect::DIALECTS.iter().map(|d| d.name).collect();
                    let message =
                        format!("`{}` is not a dialect; they are {}", name.get_ref(), names.join(", "));
                    self.error("dialect-unknown", message, name.span());
                }
                found
            }
        }?;
        let motion = match &file.motion {
            None => base.and_then(|b| b.motion).filter(|m| dialect.motion(m.name).is_some()),
            Some(name) if name.get_ref() == "auto" => None,
            Some(name) => {
                let found = dialect.motion(name.get_ref());
                if found.is_none() {
                    let message = format!(
                        "`{}` is not a motion of {}; they are auto, {}",
                        name.get_ref(),
                        dialect.name,
                        dialect.motion_names()
                    );
                    self.error("motion-unknown", message, name.span());
                }
                found
            }
        };
        if let Some(tolerance) = &file.tolerance
            && !(0.0 < *tolerance.get_ref() && tolerance.get_ref().is_finite())
        {
            self.error("tolerance-range", "tolerance must be greater than zero", tolerance.span());
        }
        let axes_file = file.axes.unwrap_or_default();
        let axes = self.axes(&axes_file, base);
        let digits = self.digits(&file.digits.unwrap_or_default(), base.map(|b| b.digits));
        let text_file = file.text.unwrap_or_default();
        let text = Text {
            point_always: self.or(
                text_file.point_always,
                base.map(|b| b.text.point_always),
                "text.point_always",
            )?,
            sign_always: self.or(
                text_file.sign_always,
                base.map(|b| b.text.sign_always),
                "text.sign_always",
            )?,
            number_start: self.or(
                text_file.number_start,
                base.map(|b| b.text.number_start),
                "text.number_start",
            )?,
            number_step: self.or(
                text_file.number_step,
                base.map(|b| b.text.number_step),
                "text.number_step",
            )?,
            extension: self.or(
                text_file.extension,
                base.map(|b| b.text.extension.clone()),
                "text.extension",
            )?,
        };
        let spline = self.spline(file.spline.unwrap_or_default(), base)?;
        let program = file.program.unwrap_or_default();
        let frame = Frame {
            header: self.lines(program.header, base.map(|b| &b.frame.header), "header", &["name"])?,
            tool: self.lines(program.tool, base.map(|b| &b.frame.tool), "tool", &["tool"])?,
            spindle: self.lines(program.spindle, base.map(|b| &b.frame.spindle), "spindle", &["rpm"])?,
            tool_spindle: self.lines(
                program.tool_spindle,
                base.map(|b| &b.frame.tool_spindle),
                "tool_spindle",
                &["tool", "rpm"],
            )?,
            footer: self.lines(program.footer, base.map(|b| &b.frame.footer), "footer", &["name"])?,
        };
        Some(Machine {
            name: self.or(file.name, base.map(|b| b.name.clone()), "name")?,
            about: self.or(file.about, base.map(|b| b.about.clone()), "about")?,
            dialect,
            motion,
            tolerance: self.or(
                file.tolerance.map(Spanned::into_inner),
                base.map(|b| b.tolerance),
                "tolerance",
            )?,
            axes: axes?,
            wraps: self.or(axes_file.wraps, base.map(|b| b.wraps), "axes.wraps")?,
            digits: digits?,
            text,
            spline,
            frame,
        })
    }

    fn axis(&mut self, name: &Spanned<String>) -> Option<Axis> {
        let axis = Axis::new(name.get_ref());
        if axis.is_none() {
            self.error("axis-name", format!("`{}` is not the name of an axis", name.get_ref()), name.span());
        }
        axis
    }

    fn axes(&mut self, file: &AxesFile, base: Option<&Machine>) -> Option<Axes> {
        let mut list = Vec::new();
        for (own, kind, key) in
            [(&file.linear, Kind::Linear, "axes.linear"), (&file.rotary, Kind::Rotary, "axes.rotary")]
        {
            match own {
                Some(names) => {
                    for name in names.get_ref() {
                        list.push((self.axis(name)?, kind));
                    }
                }
                None => match base {
                    Some(base) => list.extend(base.axes.as_slice().iter().filter(|(_, k)| *k == kind)),
                    None => return self.missing(key),
                },
            }
        }
        let axes = Axes::new(&list);
        if axes.is_none() {
            let span = file.linear.as_ref().or(file.rotary.as_ref()).map_or(0..0, Spanned::span);
            self.error("axes-count", format!("one to {MAX_AXES} axes, none named twice"), span);
        }
        axes
    }

    fn digits(&mut self, file: &DigitsFile, base: Option<Digits>) -> Option<Digits> {
        // Nine decimals of a position up to 10⁵ are as many as a float holds.
        for digits in [&file.linear, &file.rotary, &file.feed, &file.knot, &file.weight].into_iter().flatten()
        {
            if 9 < *digits.get_ref() {
                self.error("digits-range", "at most 9 decimals", digits.span());
            }
        }
        let own = |digits: &Option<Spanned<u8>>| digits.as_ref().map(|d| *d.get_ref());
        Some(Digits {
            linear: self.or(own(&file.linear), base.map(|b| b.linear), "digits.linear")?,
            rotary: self.or(own(&file.rotary), base.map(|b| b.rotary), "digits.rotary")?,
            feed: self.or(own(&file.feed), base.map(|b| b.feed), "digits.feed")?,
            knot: self.or(own(&file.knot), base.map(|b| b.knot), "digits.knot")?,
            weight: self.or(own(&file.weight), base.map(|b| b.weight), "digits.weight")?,
        })
    }

    fn spline(&mut self, file: SplineFile, base: Option<&Machine>) -> Option<Spline> {
        let base = base.map(|b| &b.spline);
        let axes = match file.axes {
            None => self.or(None, base.map(|b| b.axes.clone()), "spline.axes")?,
            Some(names) => names.iter().map(|name| self.axis(name)).collect::<Option<Vec<Axis>>>()?,
        };
        if let Some(degree) = &file.poly_degree
            && !(3..=5).contains(degree.get_ref())
        {
            self.error("degree-range", "poly_degree is 3 to 5", degree.span());
        }
        if let Some(blocks) = &file.bspline_min_blocks
            && 1000 < *blocks.get_ref()
        {
            self.error("blocks-range", "bspline_min_blocks is at most 1000", blocks.span());
        }
        for (word, letters) in [(&file.begin, "BAUTO, BNAT or BTAN"), (&file.end, "EAUTO, ENAT or ETAN")] {
            if let Some(word) = word
                && !letters.split([',', ' ']).any(|known| known == word.get_ref())
            {
                self.error("end-condition", format!("the end condition is {letters}"), word.span());
            }
        }
        Some(Spline {
            axes,
            poly_degree: self.or(
                file.poly_degree.map(Spanned::into_inner),
                base.map(|b| b.poly_degree),
                "spline.poly_degree",
            )?,
            shared_parameter: self.or(
                file.shared_parameter,
                base.map(|b| b.shared_parameter),
                "spline.shared_parameter",
            )?,
            bspline_min_blocks: self.or(
                file.bspline_min_blocks.map(Spanned::into_inner),
                base.map(|b| b.bspline_min_blocks),
                "spline.bspline_min_blocks",
            )?,
            begin: self.or(
                file.begin.map(Spanned::into_inner),
                base.map(|b| b.begin.clone()),
                "spline.begin",
            )?,
            end: self.or(file.end.map(Spanned::into_inner), base.map(|b| b.end.clone()), "spline.end")?,
        })
    }

    fn lines(
        &mut self,
        own: Option<Vec<Spanned<String>>>,
        base: Option<&Vec<Template>>,
        key: &str,
        variables: &[&str],
    ) -> Option<Vec<Template>> {
        let Some(own) = own else { return self.or(None, base.cloned(), &format!("program.{key}")) };
        let mut lines = Vec::new();
        for line in own {
            let template = Template(line.get_ref().clone());
            let strange = template.variables().find(|v| !variables.contains(v)).map(str::to_owned);
            if let Some(strange) = strange {
                let message = format!(
                    "`{{{strange}}}` cannot be filled in here; only {{{}}} can",
                    variables.join("}, {")
                );
                self.error("template-variable", message, line.span());
            }
            if line.get_ref().is_empty() || !line.get_ref().bytes().all(|b| (32..127).contains(&b)) {
                self.error("template-text", "a line of printable ASCII is needed", line.span());
            }
            lines.push(template);
        }
        Some(lines)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_built_in_reads() {
        for (name, text) in BUILT_IN {
            let machine = Machine::parse(text, SourceId::INPUT).unwrap_or_else(|e| panic!("{name}: {e:?}"));
            assert_eq!(machine.name, *name);
        }
    }

    #[test]
    fn a_file_states_only_what_differs() {
        let text = "extends = \"mazak\"\nname = \"mine\"\n[spline]\naxes = [\"X\", \"Y\", \"Z\", \"A\"]\n";
        let machine = Machine::parse(text, SourceId::INPUT).unwrap();
        assert_eq!((machine.name.as_str(), machine.spline.axes.len(), machine.digits.linear), ("mine", 4, 4));
    }

    #[test]
    fn wrong_values_are_reported_together() {
        let text =
            "extends = \"sinumerik\"\nmotion = \"spl\"\n[digits]\nlinear = 12\n[spline]\npoly_degree = 9\n";
        let ids: Vec<&str> =
            Machine::parse(text, SourceId::INPUT).unwrap_err().0.iter().map(|d| d.id).collect();
        assert_eq!(ids, ["motion-unknown", "digits-range", "degree-range"]);
        assert_eq!(
            Machine::parse("extends = \"fanuk\"", SourceId::INPUT).unwrap_err().0[0].id,
            "machine-unknown"
        );
        assert!(Machine::parse("", SourceId::INPUT).unwrap_err().has_errors());
    }
}
