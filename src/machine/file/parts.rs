//! The tables of a machine file, one by one.

use super::Reader;
use crate::diagnostic::Diagnostic;
use crate::dialect::Dialect;
use crate::geom::rotation::Order;
use crate::machine::keys::{
    ArcsFile, AxisFile, DigitsFile, OrientationFile, ParameterFile, ProgramFile, SplineFile,
};
use crate::machine::line::{Word, words};
use crate::machine::template::Template;
use crate::machine::{
    AxisLimits, Digits, FirstPoint, Frame, Machine, Moves, Orientation, Parameters, PlaneApproach, Spline,
    Turn,
};
use crate::source::Span;
use crate::units::{Axes, Axis};
use std::collections::BTreeMap;
use toml::Spanned;

/// The numbers of X Y Z of third degree: each its end and two coefficients.
const LEAST_POLY_WORDS: usize = 9;

impl Reader {
    /// What the file says of each axis, over what the machine below it says.
    pub(super) fn limits(
        &mut self,
        file: BTreeMap<Spanned<String>, AxisFile>,
        axes: Option<&Axes>,
        base: Option<&Machine>,
    ) -> BTreeMap<Axis, AxisLimits> {
        let mut all = base.map(|b| b.limits.clone()).unwrap_or_default();
        for (name, own) in file {
            let axis = Axis::new(name.get_ref())
                .filter(|axis| axes.is_none_or(|axes| axes.index_of(*axis).is_some()));
            let Some(axis) = axis else {
                let message =
                    format!("[axis.{}] speaks of an axis that the machine does not have", name.get_ref());
                self.error("axis-unknown", message, name.span());
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
            if let Some(digits) = &own.digits {
                if 9 < *digits.get_ref() {
                    self.error("digits-range", "at most 9 decimals", digits.span());
                }
                limits.digits = Some(*digits.get_ref());
            }
            if let Some(sign) = &own.sign {
                match sign.get_ref() {
                    1 => limits.reversed = false,
                    -1 => limits.reversed = true,
                    _ => self.error("axis-sign", "sign is 1 or -1", sign.span()),
                }
            }
            if let Some(moves) = &own.moves {
                match moves.get_ref().as_str() {
                    "wheel" => limits.moves = Moves::Wheel,
                    "work" => limits.moves = Moves::Work,
                    _ => self.error("axis-moves", "moves is \"wheel\" or \"work\"", moves.span()),
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
            number(own.home, &mut limits.home, false);
            if let (Some(min), Some(max)) = (limits.min, limits.max)
                && max <= min
            {
                self.error("axis-limit", "max must be greater than min", max_span.unwrap_or(0..0));
            }
        }
        all
    }

    pub(super) fn digits(&mut self, file: &DigitsFile, base: Option<Digits>) -> Option<Digits> {
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

    pub(super) fn spline(&mut self, file: SplineFile, base: Option<&Machine>) -> Option<Spline> {
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
        if let Some(words) = &file.poly_words
            && !(LEAST_POLY_WORDS..=100).contains(words.get_ref())
        {
            let message = format!("poly_words is {LEAST_POLY_WORDS} to 100: X Y Z of third degree take nine");
            self.error("words-range", message, words.span());
        }
        if let Some(blocks) = &file.bspline_min_blocks
            && 1000 < *blocks.get_ref()
        {
            self.error("blocks-range", "bspline_min_blocks is at most 1000", blocks.span());
        }
        let first_point = file.first_point.and_then(|word| match word.get_ref().as_str() {
            "g1" => Some(FirstPoint::Before),
            "repeat" => Some(FirstPoint::Repeated),
            _ => {
                self.error("first-point", "first_point is \"g1\" or \"repeat\"", word.span());
                None
            }
        });
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
            poly_words: self.or(
                file.poly_words.map(Spanned::into_inner),
                base.map(|b| b.poly_words),
                "spline.poly_words",
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
            first_point: self.or(first_point, base.map(|b| b.first_point), "spline.first_point")?,
            begin: self.or(
                file.begin.map(Spanned::into_inner),
                base.map(|b| b.begin.clone()),
                "spline.begin",
            )?,
            end: self.or(file.end.map(Spanned::into_inner), base.map(|b| b.end.clone()), "spline.end")?,
        })
    }

    /// Whether arcs may choose another plane than X Y.
    pub(super) fn arc_planes(
        &mut self,
        file: ArcsFile,
        dialect: &Dialect,
        base: Option<&Machine>,
    ) -> Option<bool> {
        if let Some(planes) = file.planes.as_ref().filter(|planes| *planes.get_ref())
            && !dialect.arcs.planes
        {
            let message = format!("{} has no words that choose the plane of an arc", dialect.name);
            self.error("arc-planes", message, planes.span());
        }
        self.or(file.planes.map(Spanned::into_inner), base.map(|b| b.arc_planes), "arcs.planes")
    }

    /// How the direction of the tool is stated and turned.
    pub(super) fn orientation(
        &mut self,
        file: &OrientationFile,
        dialect: &Dialect,
        base: Option<Orientation>,
    ) -> Option<Orientation> {
        if let Some(digits) = &file.digits
            && !(3..=9).contains(digits.get_ref())
        {
            self.error("digits-range", "a direction has 3 to 9 decimals", digits.span());
        }
        let mut positive = |value: &Option<Spanned<f64>>, name: &str| {
            if let Some(value) = value
                && !(0.0 < *value.get_ref() && value.get_ref().is_finite())
            {
                let message = format!("{name} must be greater than zero");
                self.error("orientation-range", message, value.span());
            }
            value.as_ref().map(|value| *value.get_ref())
        };
        let tolerance = positive(&file.tolerance, "tolerance");
        let length = positive(&file.length, "length");
        if let Some(height) = file.safe_height.as_ref().filter(|height| !height.get_ref().is_finite()) {
            self.error("orientation-range", "safe_height is a number of millimetres", height.span());
        }
        if let Some(second) = file.second_curve.as_ref().filter(|second| *second.get_ref())
            && !dialect.second_curve
        {
            let message = format!("{} has no words for a second curve", dialect.name);
            self.error("second-curve", message, second.span());
        }
        if let Some(arcs) = file.arcs.as_ref().filter(|arcs| *arcs.get_ref())
            && !dialect.arcs.directed
        {
            let message =
                format!("in {} the words of the tool's direction are those of an arc's centre", dialect.name);
            self.error("directed-arcs", message, arcs.span());
        }
        let turn = match &file.turn {
            None => self.or(None, base.map(|b| b.turn), "orientation.turn")?,
            Some(word) => match word.get_ref().as_str() {
                "great-circle" => Turn::GreatCircle,
                "tilt" => Turn::Tilt,
                _ => {
                    self.error("orientation-turn", "turn is \"great-circle\" or \"tilt\"", word.span());
                    Turn::GreatCircle
                }
            },
        };
        let plane_order = file.plane_order.as_ref().and_then(|word| {
            let order = Order::new(word.get_ref());
            if order.is_none() {
                let message = "plane_order is three of x, y and z, and none follows itself: \"xyz\", \"zxz\"";
                self.error("plane-order", message, word.span());
            }
            order
        });
        let plane_approach = file.plane_approach.as_ref().and_then(|word| match word.get_ref().as_str() {
            "over" => Some(PlaneApproach::Over),
            "together" => Some(PlaneApproach::Together),
            _ => {
                let message = "plane_approach is \"over\" or \"together\"";
                self.error("plane-approach", message, word.span());
                None
            }
        });
        let digits = file.digits.as_ref().map(|digits| *digits.get_ref());
        let second = file.second_curve.as_ref().map(|second| *second.get_ref());
        Some(Orientation {
            digits: self.or(digits, base.map(|b| b.digits), "orientation.digits")?,
            tolerance: self.or(tolerance, base.map(|b| b.tolerance), "orientation.tolerance")?,
            turn,
            second_curve: self.or(second, base.map(|b| b.second_curve), "orientation.second_curve")?,
            plane_order: self.or(plane_order, base.map(|b| b.plane_order), "orientation.plane_order")?,
            plane_approach: self.or(
                plane_approach,
                base.map(|b| b.plane_approach),
                "orientation.plane_approach",
            )?,
            length: self.or(length, base.map(|b| b.length), "orientation.length")?,
            arcs: self.or(
                file.arcs.as_ref().map(|arcs| *arcs.get_ref()),
                base.map(|b| b.arcs),
                "orientation.arcs",
            )?,
            safe_height: file
                .safe_height
                .as_ref()
                .map(|height| *height.get_ref())
                .or(base.and_then(|b| b.safe_height)),
        })
    }

    /// Lines round a program may not leave it in a mode that it does not expect: `G91 G28 Z0.` needs a `G90` behind it.
    fn say_what_is_granted(&mut self, lines: &[Spanned<String>], dialect: &Dialect) {
        for granted in dialect.granted {
            let mut last = None;
            for line in lines {
                for word in words(line.get_ref()) {
                    if let Some(wrong) = granted.wrong.iter().find(|code| word.is(code)) {
                        last = Some((*wrong, line.span()));
                    } else if granted.right.iter().any(|code| word.is(code)) {
                        last = None;
                    }
                }
            }
            if let Some((word, span)) = last {
                let message =
                    format!("behind `{word}` a program would not do what it says: {}", granted.what);
                let right = granted.right.join(" or ");
                let hint = format!("put {right} behind it or in its place, or leave it out");
                let span = Span::new(self.source, span);
                self.diagnostics.push(Diagnostic::error("mode-not-granted", message).at(span, "").hint(hint));
            }
        }
    }

    /// The lines that lead the tip must not say that the tool turns in another way than `turn`.
    pub(super) fn turns_as_stated(&mut self, frame: &Frame, orientation: Orientation, dialect: &Dialect) {
        let Some([plane, evenly]) = dialect.turn else { return };
        let wrong = match orientation.turn {
            Turn::GreatCircle => evenly,
            Turn::Tilt => plane,
        };
        if frame.tip_control.iter().any(|line| words(&line.0).iter().any(|word| word.is(wrong))) {
            let message = format!("tip_control says {wrong}, and [orientation] turn another way");
            self.diagnostics.push(
                Diagnostic::error("orientation-turn", message)
                    .hint("state both: [orientation] turn, and [program] tip_control with its word"),
            );
        }
    }

    /// One of the lines of a tilted plane states its three angles.
    pub(super) fn tilts(&mut self, frame: &Frame) {
        if frame.plane.is_empty() {
            return;
        }
        let angles = |line: &Template| {
            let mut angles: Vec<String> = line
                .variables()
                .filter(|name| !["tool", "register"].contains(name))
                .map(str::to_owned)
                .collect();
            angles.sort_unstable();
            angles
        };
        let stating: Vec<Vec<String>> =
            frame.plane.iter().map(angles).filter(|angles| !angles.is_empty()).collect();
        if stating != [["first", "second", "third"]] {
            let message = "one line of plane states {first}, {second} and {third}, each once";
            self.diagnostics.push(Diagnostic::error("plane-angles", message));
        }
    }

    /// Where the retraction before a tool or a plane ends the length of the tool, their lines call one.
    ///
    /// That a control takes an edge by itself behind M6 is its machine data (20270 on a Sinumerik), which no machine file knows,
    /// and D1 says no more than that does. A retraction by G49 is not looked at: a control that takes the length from its tool
    /// data has no G43.
    pub(super) fn lengths(&mut self, frame: &Frame) {
        let edge = |lines: &[Template]| lines.iter().filter_map(last_edge).next_back();
        if edge(&frame.home) != Some(false) {
            return;
        }
        let lists = [
            ("tool-length", "tool", &frame.tool, "put D1 behind the line that changes the tool"),
            (
                "tool-length",
                "tool_spindle",
                &frame.tool_spindle,
                "put D1 behind the line that changes the tool",
            ),
            ("plane-length", "plane", &frame.plane, "put D1 before the line that tilts the plane"),
        ];
        for (id, key, lines, hint) in lists {
            if !lines.is_empty() && edge(lines) != Some(true) {
                let message =
                    format!("D0 in home ends the length of the tool, and {key} does not call it again");
                self.diagnostics.push(Diagnostic::error(id, message).hint(hint));
            }
        }
    }

    /// A line names no axis that the machine lacks: the control stops there.
    fn names_its_axes(&mut self, line: &Spanned<String>) {
        let Some(declared) = self.declared else { return };
        let all = words(line.get_ref());
        // Their letters are arguments.
        let macros = ["G4", "G04", "G10", "G65", "G66"];
        if all.iter().any(|word| macros.iter().any(|code| word.is(code))) {
            return;
        }
        let missing = |word: &&Word| {
            let letter =
                word.address.len() == 1 && "XYZABCUVW".contains(&word.address) && word.number().is_some();
            letter && Axis::new(&word.address).is_none_or(|axis| declared.index_of(axis).is_none())
        };
        if let Some(word) = all.iter().find(missing) {
            let message =
                format!("`{}{}` names an axis that the machine does not have", word.address, word.text());
            let span = Span::new(self.source, line.span());
            let error = Diagnostic::error("axis-unknown", message).at(span, "");
            self.diagnostics
                .push(error.hint("name it under [axes], or write {axes}: every axis of the machine at zero"));
        }
    }

    fn lines(
        &mut self,
        own: Option<Vec<Spanned<String>>>,
        base: Option<&Vec<Template>>,
        key: &str,
        variables: &[&str],
        dialect: &Dialect,
    ) -> Option<Vec<Template>> {
        let Some(own) = own else { return self.or(None, base.cloned(), &format!("program.{key}")) };
        self.say_what_is_granted(&own, dialect);
        let mut lines = Vec::new();
        for line in own {
            self.names_its_axes(&line);
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

    pub(super) fn parameters(
        &mut self,
        file: &ParameterFile,
        base: Option<Parameters>,
    ) -> Option<Parameters> {
        let own = |number: &Option<Spanned<u32>>| number.as_ref().map(|n| *n.get_ref());
        let first = self.or(own(&file.first), base.map(|b| b.first), "parameter.first")?;
        let last = self.or(own(&file.last), base.map(|b| b.last), "parameter.last")?;
        if last < first {
            let span = file.last.as_ref().or(file.first.as_ref()).map_or(0..0, Spanned::span);
            self.error("parameter-range", "the last parameter comes before the first", span);
        }
        Some(Parameters { first, last })
    }

    pub(super) fn frame(
        &mut self,
        file: ProgramFile,
        base: Option<&Frame>,
        dialect: &Dialect,
    ) -> Option<Frame> {
        self.counts_from_zero(file.shift.as_deref().unwrap_or_default(), dialect);
        let lines = |this: &mut Self, own, of: fn(&Frame) -> &Vec<Template>, key, variables: &[&str]| {
            this.lines(own, base.map(of), key, variables, dialect)
        };
        let frame = Frame {
            header: lines(
                self,
                file.header,
                |b| &b.header,
                "header",
                &["name", "number", "linear", "axes", "i"],
            )?,
            setup: self.or(file.setup, base.map(|b| b.setup), "program.setup")?,
            start: lines(self, file.start, |b| &b.start, "start", &[])?,
            home: lines(self, file.home, |b| &b.home, "home", &["home"])?,
            home_axis: None,
            tool: lines(self, file.tool, |b| &b.tool, "tool", &["tool", "register"])?,
            spindle: lines(self, file.spindle, |b| &b.spindle, "spindle", &["rpm"])?,
            tool_spindle: lines(
                self,
                file.tool_spindle,
                |b| &b.tool_spindle,
                "tool_spindle",
                &["tool", "register", "rpm"],
            )?,
            coolant: lines(self, file.coolant, |b| &b.coolant, "coolant", &[])?,
            coolant_stop: lines(self, file.coolant_stop, |b| &b.coolant_stop, "coolant_stop", &[])?,
            spindle_stop: lines(self, file.spindle_stop, |b| &b.spindle_stop, "spindle_stop", &[])?,
            stop: lines(self, file.stop, |b| &b.stop, "stop", &[])?,
            optional_stop: lines(self, file.optional_stop, |b| &b.optional_stop, "optional_stop", &[])?,
            dwell: lines(self, file.dwell, |b| &b.dwell, "dwell", &["seconds"])?,
            tip_control: lines(
                self,
                file.tip_control,
                |b| &b.tip_control,
                "tip_control",
                &["tool", "register"],
            )?,
            tip_control_end: lines(
                self,
                file.tip_control_end,
                |b| &b.tip_control_end,
                "tip_control_end",
                &["home"],
            )?,
            tip_end_parks: false,
            length_end: lines(self, file.length_end, |b| &b.length_end, "length_end", &[])?,
            length_end_moves: self.or(
                file.length_end_moves,
                base.map(|b| b.length_end_moves),
                "program.length_end_moves",
            )?,
            plane: lines(
                self,
                file.plane,
                |b| &b.plane,
                "plane",
                &["first", "second", "third", "tool", "register"],
            )?,
            plane_end: lines(self, file.plane_end, |b| &b.plane_end, "plane_end", &[])?,
            shift: lines(self, file.shift, |b| &b.shift, "shift", &["words", "i"])?,
            unwind: lines(self, file.unwind, |b| &b.unwind, "unwind", &["axis"])?,
            footer: lines(self, file.footer, |b| &b.footer, "footer", &["name", "axes", "i"])?,
            subprograms: self.or(file.subprograms, base.map(|b| b.subprograms), "program.subprograms")?,
            call: self.line(file.call, base.map(|b| &b.call), "call", dialect)?,
            begin: self.line(file.begin, base.map(|b| &b.begin), "begin", dialect)?,
            end: self.line(file.end, base.map(|b| &b.end), "end", dialect)?,
            close: lines(self, file.close, |b| &b.close, "close", &["name"])?,
        };
        let parks = frame.tip_control_end.iter().any(|line| line.variables().any(|name| name == "home"));
        Some(Frame { tip_end_parks: parks, ..frame })
    }

    /// A line of subprograms.
    fn line(
        &mut self,
        own: Option<Spanned<String>>,
        base: Option<&Template>,
        key: &str,
        dialect: &Dialect,
    ) -> Option<Template> {
        let (own, base) = (own.map(|line| vec![line]), base.cloned().map(|b| vec![b]));
        let lines = self.lines(own, base.as_ref(), key, &["label"], dialect)?;
        lines.into_iter().next()
    }
}

/// Whether the last D of a line calls a length of the tool or, D0, ends it; none where it has no D: `T1D1`, `D=2`, `D{tool}`.
fn last_edge(line: &Template) -> Option<bool> {
    let mut edges = words(&line.0).into_iter().filter(|word| word.address == "D" && !word.value.is_empty());
    edges.next_back().map(|edge| edge.number() != Some(0.0))
}
