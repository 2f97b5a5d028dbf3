//! Machine files as text: keys, values, and what is wrong with them.

mod counts;
mod home;
mod parts;
mod spelling;

use super::keys::{AxesFile, File, KEYS};
use super::{BUILT_IN, Machine, RotaryFeed};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::dialect::{self, Form};
use crate::source::{SourceId, Span};
use crate::tables::{self, nearest};
use crate::units::{Axes, Axis, Kind, MAX_AXES};
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
    let mut at = Reader { source, declared: None, diagnostics: Diagnostics::new() };
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
    /// The axes that the file declares.
    declared: Option<Axes>,
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
            && !(0.0 < *tolerance.get_ref() && *tolerance.get_ref() <= crate::MOST_TOLERANCE)
        {
            let message =
                format!("tolerance must be greater than zero, and at most {} mm", crate::MOST_TOLERANCE);
            self.error("tolerance-range", message, tolerance.span());
        }
        let axes_file = file.axes.unwrap_or_default();
        let axes = self.axes(&axes_file, base);
        self.declared = axes;
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
        let text = self.text(file.text.unwrap_or_default(), base.map(|b| &b.text), dialect)?;
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
                "surface" => RotaryFeed::Surface,
                "inverse-time" if dialect.inverse_time => RotaryFeed::InverseTime,
                "inverse-time" => {
                    let message = format!("{} has no feed in inverse time", dialect.name);
                    self.error("feed-rotary", message, word.span());
                    RotaryFeed::Free
                }
                _ => {
                    let message = "rotary is \"free\", \"degrees-as-mm\", \"surface\" or \"inverse-time\"";
                    self.error("feed-rotary", message, word.span());
                    RotaryFeed::Free
                }
            },
        };
        if let Some(error) = &feed.error
            && !(0.001..=10.0).contains(error.get_ref())
        {
            self.error("feed-error", "error is a share from 0.001 to 10: 0.05 is 5 percent", error.span());
        }
        let feed_error =
            self.or(feed.error.map(Spanned::into_inner), base.map(|b| b.feed_error), "feed.error")?;
        let feed_parameter = self.or(feed.parameter, base.map(|b| b.feed_parameter), "feed.parameter")?;
        let parameters = self.parameters(&file.parameter.unwrap_or_default(), base.map(|b| b.parameters))?;
        let spline = self.spline(file.spline.unwrap_or_default(), base)?;
        let arc_planes = self.arc_planes(file.arcs.unwrap_or_default(), dialect, base)?;
        let own = file.orientation.unwrap_or_default();
        let orientation = self.orientation(&own, dialect, base.map(|b| b.orientation))?;
        let mut frame = self.frame(file.program.unwrap_or_default(), base.map(|b| &b.frame), dialect)?;
        frame.home_axis = self.home_axis(&frame, dialect);
        self.turns_as_stated(&frame, orientation, dialect);
        self.tilts(&frame);
        self.lengths(&frame);
        let cutter_axes = self.cutter_axes(axes_file.cutter.as_ref(), base)?;
        let machine = Machine {
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
            declared: axes?.as_slice().iter().map(|(axis, _)| *axis).collect(),
            cutter_axes,
            limits: self.limits(file.axis.unwrap_or_default(), axes.as_ref(), base),
            digits: digits?,
            text,
            rotary_feed,
            feed_error,
            feed_parameter,
            block_time: block_time.or(base.and_then(|b| b.block_time)),
            parameters,
            spline,
            arc_planes,
            orientation,
            frame,
        };
        self.diagnostics.0.extend((dialect.lines)(&machine).0);
        Some(machine)
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

    /// X, Y, Z and A of a cutter: by name, or as ever where nothing is said.
    fn cutter_axes(
        &mut self,
        names: Option<&Spanned<Vec<Spanned<String>>>>,
        base: Option<&Machine>,
    ) -> Option<[Axis; 4]> {
        let Some(names) = names else {
            let usual = || [0, 1, 2, 3].map(|i| Axes::xyza().name(i));
            return Some(base.map_or_else(usual, |b| b.cutter_axes));
        };
        let axes: Option<Vec<Axis>> = names.get_ref().iter().map(|name| self.axis(name)).collect();
        let four: Option<[Axis; 4]> = axes?.try_into().ok();
        if four.is_none() {
            let message = "cutter names four axes: those that are X, Y, Z and A of a cutter";
            self.error("cutter-axes", message, names.span());
        }
        four
    }
}
