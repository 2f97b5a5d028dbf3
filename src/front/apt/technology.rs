//! Units, tools, spindle, feed, coolant, dwell and stops.

use super::reader::{INCH, Reader, Said};
use super::statement::{Argument, Placed};
use super::words::Register;
use crate::diagnostic::Diagnostic;
use crate::ir::{Auxiliary, ToolCall};
use crate::source::Span;

/// A foot a minute, in mm/min.
const FOOT: f64 = 12.0 * INCH;

/// The feed in force, in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Feed {
    /// mm/min
    PerMinute(f64),
    /// mm/rev
    PerRevolution(f64),
}

/// A unit of feed: per minute or per revolution, and how many mm; NaN where it is the unit of the file.
type FeedUnit = (fn(f64) -> Feed, f64);

/// What the unit of a feed is in mm and minutes.
fn feed_unit(word: &str) -> Option<FeedUnit> {
    Some(match word {
        "MMPM" => (Feed::PerMinute, 1.0),
        "IPM" => (Feed::PerMinute, INCH),
        "FPM" => (Feed::PerMinute, FOOT),
        "MMPR" => (Feed::PerRevolution, 1.0),
        "IPR" => (Feed::PerRevolution, INCH),
        "FPR" => (Feed::PerRevolution, FOOT),
        // Without a word for it: units of the file a minute.
        "PERMIN" => (Feed::PerMinute, f64::NAN),
        "PERREV" => (Feed::PerRevolution, f64::NAN),
        _ => return None,
    })
}

/// mm in a unit of UNITS.
pub(super) fn unit_scale(word: &str) -> Option<f64> {
    match word.to_ascii_uppercase().as_str() {
        "MM" | "MILLIMETER" | "MILLIMETERS" => Some(1.0),
        "INCHES" | "INCH" | "IN" => Some(INCH),
        "CM" => Some(10.0),
        "FEET" | "FT" => Some(FOOT),
        _ => None,
    }
}

/// A whole number that a tool or a register may have.
fn whole(number: Option<f64>) -> Option<u32> {
    number.filter(|n| n.fract() == 0.0 && (0.0..4.0e9).contains(n)).map(|n| n as u32)
}

impl Reader<'_> {
    /// `UNITS/MM|INCHES|CM|FEET`
    pub(super) fn units(&mut self, said: &Said<'_>) {
        let word = match said.arguments() {
            [one] => one.argument.word().unwrap_or_default(),
            _ => "",
        };
        match unit_scale(word) {
            Some(scale) => {
                if self.unit_told && !self.units_stated && scale != self.scale {
                    let message = "the file states another unit than --units";
                    return self.error("units-differ", message, said.span);
                }
                if self.units_stated && scale != self.scale {
                    let message =
                        "the unit changes within the file; positions from here on are in the new one";
                    self.push(Diagnostic::warning("units-change", message).at(said.span, ""));
                } else if !self.units_stated && scale != self.scale && self.unit_taken {
                    let message = "the unit is stated behind places or feeds that were read in mm";
                    return self.error("units-late", message, said.span);
                }
                self.diameter = self.diameter.map(|d| d / self.scale * scale);
                self.scale = scale;
                self.units_stated = true;
            }
            None => {
                self.error("units", format!("`{}` is no unit", said.record.text), said.span);
            }
        }
    }

    /// A file that states no unit is in millimetres where its feeds are, and nobody knows what it is in where they are in inches.
    pub(super) fn unit_is_known(&mut self) {
        if self.units_stated || self.unit_told {
            return;
        }
        let hint = "--units inches or --units mm says what its places are in";
        let diagnostic = match self.unit_signs {
            [Some(span), _] => {
                let message =
                    "the file states no unit, and feeds in inches: its places may be in inches or in mm";
                Diagnostic::refusal("units-missing", message).at(span, "")
            }
            [None, Some(_)] => return,
            [None, None] => Diagnostic::warning("units-missing", "the file states no unit: it is read in mm"),
        };
        self.push(diagnostic.hint(hint));
    }

    /// `MODE/MILL|TURN`
    pub(super) fn mode(&mut self, said: &Said<'_>) {
        match said.arguments() {
            [_] if said.has("MILL") => {}
            _ if said.has("TURN") => self.turned(said.span),
            _ => self.error("arguments", "MODE is MILL: no other mode is compiled", said.span),
        }
    }

    /// Turning is another geometry: X is a diameter or a radius, arcs lie in X Z, speeds are cutting speeds.
    pub(super) fn turned(&mut self, span: Span) {
        let diagnostic = self.turning(span);
        self.push(diagnostic);
    }

    /// What a turning file is refused with: nothing behind it is worth a report.
    pub(super) fn turning(&mut self, span: Span) -> Diagnostic {
        self.hopeless = true;
        Diagnostic::refusal("turning", "this is a turning file; milling is compiled only").at(span, "")
    }

    /// `CUTTER/d,r,e,f,a,b,h`
    pub(super) fn cutter(&mut self, said: &Said<'_>) {
        self.diameter = said.first_number().map(|d| d * self.scale);
        self.dirty_tool = true;
        let text = said.record.text.replace('/', " ");
        self.carry(&text, said.span);
    }

    /// `TLDATA/MILL,d,r,len,tip,taper` and others.
    pub(super) fn tldata(&mut self, said: &Said<'_>) {
        if said.has("WEDM") {
            self.hopeless = true;
            return self.refuse(
                "wire",
                "this is a file for wire erosion; milling is compiled only",
                said.span,
            );
        }
        if said.has("TURN") {
            return self.turned(said.span);
        }
        self.cutter(said);
    }

    /// `TOOLNO/n {,arg}`: the data of a tool that is called later.
    pub(super) fn toolno(&mut self, said: &Said<'_>) {
        if said.has("TURN") {
            return self.turned(said.span);
        }
        if said.has("ADJUST") || said.has("OSETNO") {
            let message =
                "the register of the tool's length stands in TOOLNO: only that of a tool call is compiled";
            return self.push(Diagnostic::refusal("tool-register", message).at(said.span, "").hint(
                "state it in LOADTL or LOAD/TOOL; TOOLNO = \"comment\" in a table for --words leaves it out",
            ));
        }
        let text = said.record.text.replace('/', " ");
        self.carry(&text, said.span);
    }

    /// A tool's number.
    fn tool_number(&mut self, said: &Said<'_>) -> Option<u32> {
        let number = whole(said.first_number());
        if number.is_none() {
            self.error("tool-number", "a tool is called by its number", said.span);
        }
        number
    }

    /// `LOADTL/n[,…]`
    pub(super) fn loadtl(&mut self, said: &Said<'_>) {
        if let Some(number) = self.tool_number(said) {
            self.call(number, said, 1);
        }
    }

    /// `LOAD/TOOL,n`
    pub(super) fn load(&mut self, said: &Said<'_>) {
        if said.has("WIRE") {
            self.hopeless = true;
            return self.refuse(
                "wire",
                "this is a file for wire erosion; milling is compiled only",
                said.span,
            );
        }
        if let Some(number) = self.tool_number(said) {
            self.call(number, said, 2);
        }
    }

    /// `ADJUST,m` or `OSETNO,m` of a tool call: the register that the length of the tool is taken from. None where it is wrong.
    fn register(&mut self, call: ToolCall, said: &Said<'_>) -> Option<ToolCall> {
        let is_word = |placed: &Placed<'_>| {
            let word = placed.argument.word().unwrap_or_default();
            word.eq_ignore_ascii_case("ADJUST") || word.eq_ignore_ascii_case("OSETNO")
        };
        let mut stated = said.arguments().iter().skip_while(|placed| !is_word(placed));
        let Some(word) = stated.next() else { return Some(call) };
        let register = stated.next().and_then(|placed| whole(placed.argument.number()));
        if stated.any(is_word) {
            self.error("tool-register", "the register of the tool's length is stated twice", said.span);
            return None;
        }
        match register {
            _ if self.words.register == Register::LeftOut => {
                self.leave_out("ADJUST", said.span);
                Some(call)
            }
            Some(register) if 0 < register => Some(call.with_register(register)),
            Some(_) | None => {
                let message =
                    "ADJUST or OSETNO states the register of the tool's length, a whole number above zero";
                self.push(Diagnostic::error("tool-register", message).at(said.place(word), "").hint(
                    "tool_register = \"left-out\" in a table for --words takes the tool's own length instead",
                ));
                None
            }
        }
    }

    /// Calls a tool, of whose statement so many arguments are read, and the register of its length.
    fn call(&mut self, number: u32, said: &Said<'_>, read: usize) {
        let Some(call) = self.register(ToolCall::own(number), said) else { return };
        self.end_operation(&said.statement.major.to_ascii_uppercase(), said.span);
        if self.contradicts_table(call, said) {
            return;
        }
        let own = said.has("ADJUST") || said.has("OSETNO");
        if read + if own { 2 } else { 0 } < said.arguments().len() {
            let message = format!("of {} the tool's number is read", said.record.text);
            self.push(
                Diagnostic::warning("tool-arguments", message)
                    .at(said.span, "")
                    .hint("offsets and lengths are those of the tool on the control"),
            );
        }
        if self.tool == Some(call) {
            let message = format!("{call} is called again; it is called once in the program");
            self.push(Diagnostic::warning("tool-repeated", message).at(said.span, ""));
            return;
        }
        self.change(call, said.span);
    }

    /// Another tool comes into the spindle.
    pub(super) fn change(&mut self, call: ToolCall, span: Span) {
        if self.tool.is_none() && self.program.has_moved() {
            let message = "the file moves before it calls its first tool: no length of that tool holds there";
            self.push(
                Diagnostic::warning("moves-before-tool", message)
                    .at(span, "first called here")
                    .hint("see that those moves are clear for whatever tool the spindle holds"),
            );
        }
        self.tool = Some(call);
        self.program.tool(call, span);
        (self.axis_stale, self.dirty_tool) = (true, true);
    }

    /// `SPINDL/ { n | RPM|SFM|SMM | CLW|CCLW | MAXRPM,n | RANGE,n } | ON | OFF | ORIENT | MAIN`
    pub(super) fn spindl(&mut self, said: &Said<'_>) {
        let mut speed = None;
        if said.has("OFF") && said.arguments().len() != 1 {
            return self.error("arguments", "SPINDL/OFF stands alone", said.span);
        }
        let mut arguments = said.arguments().iter();
        while let Some(placed) = arguments.next() {
            match placed.argument {
                Argument::Number(_) if speed.is_some() => {
                    return self.error("arguments", "SPINDL states two speeds", said.place(placed));
                }
                Argument::Number(n) => speed = Some(n),
                Argument::Word(word) => match word.to_ascii_uppercase().as_str() {
                    "RPM" | "CLW" | "ON" | "MAIN" => {}
                    "SFM" | "SMM" => {
                        let message = format!("{word}: a cutting speed is not compiled; RPM is");
                        return self.refuse("cutting-speed", message, said.place(placed));
                    }
                    "CCLW" => {
                        let message = "CCLW: a spindle that turns counter-clockwise is not compiled";
                        return self.push(
                            Diagnostic::refusal("spindle-reverse", message)
                                .at(said.place(placed), "")
                                .hint("state CLW in the CAM system, and put the machine's own word for it into the program that comes out"),
                        );
                    }
                    "OFF" => return self.program.auxiliary(Auxiliary::SpindleStop, said.span),
                    "ORIENT" => {
                        let message = "ORIENT: an oriented stop is not compiled";
                        return self.refuse("spindle-orient", message, said.place(placed));
                    }
                    "MAXRPM" | "RANGE" => {
                        let value = arguments.next().map(|placed| &placed.argument);
                        let stated = match value {
                            Some(Argument::Number(_)) => true,
                            Some(Argument::Word(range)) => ["LOW", "MEDIUM", "HIGH"]
                                .iter()
                                .any(|known| range.eq_ignore_ascii_case(known)),
                            Some(_) | None => false,
                        };
                        if !stated {
                            let message = format!("{word} of SPINDL has no value");
                            return self.error("arguments", message, said.place(placed));
                        }
                        if word.eq_ignore_ascii_case("RANGE") && !self.words.range_left_out {
                            let message = "RANGE: a gear of the spindle is not compiled";
                            return self.push(
                                Diagnostic::refusal("spindle-range", message)
                                    .at(said.place(placed), "")
                                    .hint("spindle_range = \"left-out\" in a table for --words takes it out, where the machine finds its gear by the speed"),
                            );
                        }
                        self.leave_out(&format!("SPINDL {word}"), said.span);
                    }
                    _ => {
                        let place = said.place(placed);
                        return self.argument(word, "SPINDL", place);
                    }
                },
                Argument::Empty => {}
                Argument::Quoted(_)
                | Argument::Assigned(..)
                | Argument::AssignedWord(..)
                | Argument::Group(_) => {
                    self.error("arguments", "SPINDL takes numbers and words", said.place(placed));
                }
            }
        }
        match speed.or_else(|| self.rpm.filter(|_| said.has("ON"))) {
            Some(rpm) if 0.0 < rpm && rpm.is_finite() => {
                self.rpm = Some(rpm);
                self.program.spindle(rpm, said.span);
            }
            Some(_) => self.error("spindle-range", "the speed must be greater than zero", said.span),
            None if said.has("MAIN") => self.leave_out("SPINDL MAIN", said.span),
            None => self.error("spindle-speed", "no speed was stated for the spindle", said.span),
        }
    }

    /// `FEDRAT/ { n | MMPM|MMPR|IPM|IPR|FPM|FPR } | INVERS,AUTO|OFF`
    pub(super) fn fedrat(&mut self, said: &Said<'_>) {
        let (mut value, mut unit) = (None, None);
        for placed in said.arguments() {
            match placed.argument {
                Argument::Number(_) if value.is_some() => {
                    return self.error("arguments", "FEDRAT states two feeds", said.place(placed));
                }
                Argument::Number(n) => value = Some(n),
                Argument::Word(word) => {
                    let word = word.to_ascii_uppercase();
                    match feed_unit(&word) {
                        Some(_) if unit.is_some() => {
                            return self.error("arguments", "FEDRAT states two units", said.place(placed));
                        }
                        Some(known) => {
                            self.sign(&word, said.place(placed));
                            unit = Some(known);
                        }
                        None if said.has("INVERS") && (word == "OFF" || said.has("OFF")) => {}
                        None if word == "INVERS" => {
                            let message = "INVERS: inverse-time feed is not compiled";
                            return self.refuse("feed-inverse", message, said.place(placed));
                        }
                        None => {
                            let place = said.place(placed);
                            return self.argument(&word, "FEDRAT", place);
                        }
                    }
                }
                Argument::Empty => {}
                Argument::Quoted(_)
                | Argument::Assigned(..)
                | Argument::AssignedWord(..)
                | Argument::Group(_) => {
                    self.error("arguments", "FEDRAT takes numbers and words", said.place(placed));
                }
            }
        }
        let Some(value) = value else {
            if said.has("INVERS") && unit.is_none() {
                // It ends what nothing began.
                return;
            }
            return self.error("feed-missing", "FEDRAT states no feed", said.span);
        };
        if unit.is_none() && matches!(self.feed, Some(Feed::PerRevolution(_))) {
            let message = "this feed states no unit, and the one before it was a feed a revolution";
            self.push(
                Diagnostic::error("feed-unit", message)
                    .at(said.span, "")
                    .hint("MMPM, MMPR, IPM or IPR says what it counts"),
            );
        }
        self.feed = self.feed_of(value, unit, said.span).or(self.feed);
    }

    /// A feed in inches or in millimetres shows what the file is in.
    fn sign(&mut self, word: &str, span: Span) {
        let sign = match word {
            "IPM" | "IPR" | "FPM" | "FPR" => 0,
            "MMPM" | "MMPR" => 1,
            _ => return,
        };
        self.unit_signs[sign] = self.unit_signs[sign].or(Some(span));
    }

    /// A feed in a unit, or in units of the file a minute.
    fn feed_of(&mut self, value: f64, unit: Option<FeedUnit>, span: Span) -> Option<Feed> {
        if !(0.0 < value && value.is_finite()) {
            self.error("feed-range", "the feed must be greater than zero", span);
            return None;
        }
        let (make, mm) = unit.unwrap_or((Feed::PerMinute, f64::NAN));
        self.unit_taken |= mm.is_nan() && !self.units_stated;
        Some(make(value * if mm.is_nan() { self.scale } else { mm }))
    }

    /// A feed by the word of its unit, as cycles state it.
    pub(super) fn feed_in(&mut self, word: &str, value: f64, span: Span) -> Option<Feed> {
        let unit = feed_unit(word)?;
        self.sign(word, span);
        self.feed_of(value, Some(unit), span)
    }

    /// A feed in mm/min; per revolution it needs the spindle's speed.
    pub(super) fn per_minute(&mut self, feed: Option<Feed>, span: Span) -> Option<f64> {
        match feed {
            Some(Feed::PerMinute(mm)) => Some(mm),
            Some(Feed::PerRevolution(mm)) => match self.rpm {
                Some(rpm) => Some(mm * rpm),
                None => {
                    let message = "a feed a revolution needs the spindle's speed before it";
                    self.error("feed-per-revolution", message, span);
                    // Told once.
                    self.feed = Some(Feed::PerMinute(1.0));
                    None
                }
            },
            None => {
                self.push(
                    Diagnostic::error("feed-missing", "no feed was stated before this move")
                        .at(span, "")
                        .hint("FEDRAT states one; RAPID before a move makes it a rapid"),
                );
                // Told once.
                self.feed = Some(Feed::PerMinute(1.0));
                None
            }
        }
    }

    /// `COOLNT/ON|OFF|FLOOD|MIST|TAP|THRU[,LOW|MEDIUM|HIGH]`
    pub(super) fn coolnt(&mut self, said: &Said<'_>) {
        let word = said.first_word().to_ascii_uppercase();
        for placed in said.arguments().iter().skip(1) {
            let pressure = placed.argument.word().map(str::to_ascii_uppercase);
            if !matches!(pressure.as_deref(), Some("LOW" | "MEDIUM" | "HIGH")) {
                return self.error("arguments", "COOLNT states one kind of coolant", said.place(placed));
            }
            self.leave_out(&format!("COOLNT {}", pressure.unwrap_or_default()), said.span);
        }
        match word.as_str() {
            "ON" | "FLOOD" => self.program.coolant(said.span),
            "OFF" => self.program.auxiliary(Auxiliary::CoolantStop, said.span),
            "MIST" | "TAP" | "THRU" => {
                let message = format!("{word}: of coolants ON, FLOOD and OFF are compiled");
                self.push(
                    Diagnostic::refusal("coolant", message)
                        .at(said.span, "")
                        .hint("COOLNT = \"comment\" in a table for --words makes remarks of them; the machine's own word for it stands under [program] coolant"),
                );
            }
            _ => {
                self.argument(&word, "COOLNT", said.span);
            }
        }
    }

    /// `DELAY/seconds`
    pub(super) fn delay(&mut self, said: &Said<'_>) {
        if said.has("REV") {
            let message = "REV: a dwell in revolutions is not compiled";
            return self.refuse("dwell-revolutions", message, said.span);
        }
        if said.arguments().len() != 1 {
            return self.error("arguments", "DELAY takes seconds and nothing else", said.span);
        }
        match said.first_number() {
            Some(seconds) if 0.0 < seconds && seconds.is_finite() => {
                self.program.auxiliary(Auxiliary::Dwell(seconds), said.span);
            }
            _ => self.error("dwell-range", "DELAY takes seconds greater than zero", said.span),
        }
    }

    /// `CUTCOM/LEFT|RIGHT[,…] | ON | OFF`
    pub(super) fn cutcom(&mut self, said: &Said<'_>) {
        if said.has("OFF") {
            // Compensation is off: nothing switched it on.
            return;
        }
        self.push(
            Diagnostic::refusal(
                "cutter-compensation",
                "CUTCOM: the control would move by a radius that the file does not state",
            )
            .at(said.span, "")
            .hint("output the path of the tool's centre from the CAM system"),
        );
    }
}
