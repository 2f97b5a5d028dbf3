//! Units, tools, spindle, feed, coolant, dwell and stops.

use super::reader::{INCH, Reader, Said};
use super::statement::Argument;
use crate::diagnostic::Diagnostic;
use crate::ir::Auxiliary;
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

impl Reader<'_> {
    /// `UNITS/MM|INCHES|CM|FEET`
    pub(super) fn units(&mut self, said: &Said<'_>) {
        let word = match said.arguments() {
            [one] => one.argument.word().unwrap_or_default(),
            _ => "",
        };
        match unit_scale(word) {
            Some(scale) => {
                if self.units_stated && scale != self.scale {
                    let message =
                        "the unit changes within the file; positions from here on are in the new one";
                    self.push(Diagnostic::warning("units-change", message).at(said.span, ""));
                } else if !self.units_stated && scale != 1.0 && self.program.has_moved() {
                    let message = "the unit is stated after the first move, which was read in mm";
                    return self.error("units-late", message, said.span);
                }
                self.scale = scale;
                self.units_stated = true;
            }
            None => {
                self.error("units", format!("`{}` is no unit", said.record.text), said.span);
            }
        }
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
        let text = said.record.text.replace('/', " ");
        self.carry(&text, said.span);
    }

    /// A tool's number.
    fn tool_number(&mut self, said: &Said<'_>) -> Option<u32> {
        let number = said.first_number();
        let whole = number.filter(|n| n.fract() == 0.0 && (0.0..4.0e9).contains(n)).map(|n| n as u32);
        if whole.is_none() {
            self.error("tool-number", "a tool is called by its number", said.span);
        }
        whole
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

    /// Calls a tool, of whose statement so many arguments are read.
    fn call(&mut self, number: u32, said: &Said<'_>, read: usize) {
        if read < said.arguments().len() {
            let message = format!("of {} the tool's number is read", said.record.text);
            self.push(
                Diagnostic::warning("tool-arguments", message)
                    .at(said.span, "")
                    .hint("offsets and lengths are those of the tool on the control"),
            );
        }
        if self.tool == Some(number) {
            let message = format!("tool {number} is called again; it is called once in the program");
            self.push(Diagnostic::warning("tool-repeated", message).at(said.span, ""));
            return;
        }
        if self.tool.is_none() && self.program.has_moved() {
            let message = "the file moves before it calls its first tool: no length of that tool holds there";
            self.push(
                Diagnostic::warning("moves-before-tool", message)
                    .at(said.span, "first called here")
                    .hint("see that those moves are clear for whatever tool the spindle holds"),
            );
        }
        self.tool = Some(number);
        self.program.tool(number, said.span);
        self.axis_stale = true;
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
                        return self.refuse("spindle-reverse", message, said.place(placed));
                    }
                    "OFF" => return self.program.auxiliary(Auxiliary::SpindleStop, said.span),
                    "ORIENT" => {
                        let message = "ORIENT: an oriented stop is not compiled";
                        return self.refuse("spindle-orient", message, said.place(placed));
                    }
                    "MAXRPM" | "RANGE" => {
                        arguments.next();
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
                        Some(known) => unit = Some(known),
                        None if word == "INVERS" && said.has("OFF") => return,
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

    /// A feed in a unit, or in units of the file a minute.
    fn feed_of(&mut self, value: f64, unit: Option<FeedUnit>, span: Span) -> Option<Feed> {
        if !(0.0 < value && value.is_finite()) {
            self.error("feed-range", "the feed must be greater than zero", span);
            return None;
        }
        let (make, mm) = unit.unwrap_or((Feed::PerMinute, f64::NAN));
        Some(make(value * if mm.is_nan() { self.scale } else { mm }))
    }

    /// A feed by the word of its unit, as cycles state it.
    pub(super) fn feed_in(&mut self, word: &str, value: f64, span: Span) -> Option<Feed> {
        let unit = feed_unit(word)?;
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
        }
        match word.as_str() {
            "ON" | "FLOOD" => self.program.coolant(said.span),
            "OFF" => self.program.auxiliary(Auxiliary::CoolantStop, said.span),
            "MIST" | "TAP" | "THRU" => {
                let message = format!("{word}: of coolants ON, FLOOD and OFF are compiled");
                self.refuse("coolant", message, said.span);
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
