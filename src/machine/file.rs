//! Machine files as text: keys, values, and what is wrong with them.

use super::keys::{AxesFile, AxisFile, DigitsFile, File, KEYS, SplineFile};
use super::template::Template;
use super::{AxisLimits, BUILT_IN, Digits, Frame, Machine, RotaryFeed, Spline, Text};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::dialect::{self, Form};
use crate::source::{SourceId, Span};
use crate::tables::{self, nearest};
use crate::units::{Axes, Axis, Kind, MAX_AXES};
use std::collections::BTreeMap;
use toml::Spanned;

/// Reads a machine file.
///
/// # Errors
/// It is not TOML, has unknown keys or values that no machine can have, or extends a machine that is not built in.
pub(super) fn parse(text: &str, source: SourceId) -> Result<Machine, Diagnostics> {
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
        if let (Some(digits), true) =
            (digits, dialect.motions.iter().any(|m| m.form == Form::Polynomial { closing: true }))
            && 8 < digits.linear.max(digits.rotary)
        {
            let message = format!(
                "{} closes its spline blocks in 8 decimals; positions cannot have more",
                dialect.name
            );
            self.diagnostics.push(Diagnostic::error("digits-range", message));
        }
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
        let feed = file.feed.unwrap_or_default();
        let block_time = feed.block_time.as_ref().map(|time| *time.get_ref());
        if let Some(time) =
            feed.block_time.filter(|time| !(0.0 < *time.get_ref() && time.get_ref().is_finite()))
        {
            self.error("block-time", "block_time is a number of milliseconds greater than zero", time.span());
        }
        let rotary_feed = match feed.rotary {
            None => self.or(None, base.map(|b| b.rotary_feed), "feed.rotary")?,
            Some(word) => match word.get_ref().as_str() {
                "free" => RotaryFeed::Free,
                "degrees-as-mm" => RotaryFeed::DegreesAsMm,
                _ => {
                    self.error("feed-rotary", "rotary is \"free\" or \"degrees-as-mm\"", word.span());
                    RotaryFeed::Free
                }
            },
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
            limits: self.limits(file.axis.unwrap_or_default(), axes.as_ref(), base),
            digits: digits?,
            text,
            rotary_feed,
            block_time: block_time.or(base.and_then(|b| b.block_time)),
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

    /// What the file says of each axis, over what the machine below it says.
    fn limits(
        &mut self,
        file: BTreeMap<String, AxisFile>,
        axes: Option<&Axes>,
        base: Option<&Machine>,
    ) -> BTreeMap<Axis, AxisLimits> {
        let mut all = base.map(|b| b.limits.clone()).unwrap_or_default();
        for (name, own) in file {
            let axis = Axis::new(&name).filter(|axis| axes.is_none_or(|axes| axes.index_of(*axis).is_some()));
            let Some(axis) = axis else {
                let message = format!("[axis.{name}] speaks of an axis that the machine does not have");
                self.diagnostics.push(Diagnostic::error("axis-unknown", message));
                continue;
            };
            let limits = all.entry(axis).or_default();
            if let Some(kind) = &own.kind {
                match kind.get_ref().as_str() {
                    "linear" => limits.modulo = false,
                    "modulo" => limits.modulo = true,
                    _ => self.error(
                        "axis-kind",
                        "kind is \"linear\" (it counts on) or \"modulo\"",
                        kind.span(),
                    ),
                }
            }
            let mut number = |value: Option<Spanned<f64>>, into: &mut Option<f64>, positive: bool| {
                if let Some(value) = value {
                    let x = *value.get_ref();
                    if !x.is_finite() || (positive && x <= 0.0) {
                        self.error(
                            "axis-limit",
                            "a limit is a finite number, a speed or an acceleration greater than zero",
                            value.span(),
                        );
                    }
                    *into = Some(x);
                }
            };
            number(own.min, &mut limits.min, false);
            let max_span = own.max.as_ref().map(Spanned::span);
            number(own.max, &mut limits.max, false);
            number(own.max_speed, &mut limits.max_speed, true);
            number(own.max_acceleration, &mut limits.max_acceleration, true);
            number(own.max_step, &mut limits.max_step, true);
            if let (Some(min), Some(max)) = (limits.min, limits.max)
                && max <= min
            {
                self.error("axis-limit", "max must be greater than min", max_span.unwrap_or(0..0));
            }
        }
        all
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
        // Empty where a control has none.
        for (word, known) in
            [(&file.begin, ["", "BAUTO", "BNAT", "BTAN"]), (&file.end, ["", "EAUTO", "ENAT", "ETAN"])]
        {
            if let Some(word) = word
                && !known.contains(&word.get_ref().as_str())
            {
                let message = format!("the end condition is {}", known[1..].join(" or "));
                self.error("end-condition", message, word.span());
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
