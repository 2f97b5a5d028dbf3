//! Machine files: what one machine takes, as data.
//!
//! A machine file is TOML; the built-ins have the same form and are embedded. A file may say
//! `extends = "sinumerik"` and then states only what differs. What a control's manual leaves open is a key here,
//! never a constant in the code. `splinepost machines --show NAME` prints a built-in with its comments: the best
//! start for a file of one's own.

mod file;
mod keys;
pub mod line;
mod parts;
pub mod remark;
pub mod template;

use crate::decimal::Decimal;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::dialect::parts::{home_word, spelled};
use crate::source::SourceId;
use crate::units::{Axes, Axis, Kind, MAX_AXES};
pub use keys::{KEYS, schema};
pub use parts::{
    AxisLimits, Digits, FirstPoint, Frame, LineEnd, Machine, Moves, Orientation, Parameters, PlaneApproach,
    RotaryFeed, Spline, Text, Turn,
};

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

impl Machine {
    /// A built-in machine.
    pub fn built_in(name: &str) -> Option<Machine> {
        // A test reads every built-in, so that an error cannot hide here.
        built_in(name).and_then(|text| Machine::parse(text, SourceId::INPUT).ok())
    }

    /// Where a hint says that keys are to be stated: in a file that extends this machine where it is built in, and otherwise in
    /// its own, which nothing can extend.
    pub fn to_state(&self, keys: &str) -> String {
        if built_in(&self.name).is_some() {
            format!("in a machine file: extends = \"{}\", {keys}", self.name)
        } else {
            format!("in the file of machine `{}`: {keys}", self.name)
        }
    }

    /// Reads a machine file.
    ///
    /// # Errors
    /// It is not TOML, has unknown keys or values that no machine can have, or extends a machine that is not built in.
    pub fn parse(text: &str, source: SourceId) -> Result<Machine, Diagnostics> {
        file::parse(text, source)
    }

    /// What an axis can do; nothing is known of one that the file does not speak of.
    pub fn limits(&self, axis: Axis) -> AxisLimits {
        self.limits.get(&axis).copied().unwrap_or_default()
    }

    /// The decimals of each of the program's axes.
    pub fn axis_digits(&self) -> [u8; MAX_AXES] {
        let mut digits = [0; MAX_AXES];
        for (i, (axis, kind)) in self.axes.as_slice().iter().enumerate() {
            let usual = match kind {
                Kind::Linear => self.digits.linear,
                Kind::Direction => self.orientation.digits,
                Kind::Rotary => self.digits.rotary,
            };
            digits[i] = self.limits(*axis).digits.unwrap_or(usual);
        }
        digits
    }

    /// The machine as a program of its own wants it: with a direction of the tool where the program leads the tip.
    #[must_use]
    pub fn for_program(self, text: &str) -> Machine {
        let leads = |line: &str| {
            let body = line.trim_start().trim_start_matches('N');
            let body = body.trim_start_matches(|c: char| c.is_ascii_digit()).trim();
            self.frame.tip_control.first().is_some_and(|template| template.matched(body).is_some())
        };
        let tip = ["X", "Y", "Z"].iter().enumerate().all(|(i, name)| {
            i < self.axes.count() && self.axes.name(i).as_str() == *name && self.axes.kind(i) == Kind::Linear
        });
        if tip && text.lines().any(leads) { Machine { axes: Axes::with_direction(), ..self } } else { self }
    }

    /// The machine with these axes only, in this order; the program names no others, so they rest.
    ///
    /// # Errors
    /// The machine lacks one of them, or counts it as another kind.
    pub fn with_axes(&self, axes: &Axes) -> Result<Machine, Diagnostics> {
        for (axis, kind) in axes.as_slice() {
            if *kind == Kind::Direction {
                if self.frame.tip_control.is_empty() {
                    return Err(Diagnostic::refusal(
                        "five-axes",
                        format!("machine `{}` has no lines that lead the tip of a tilted tool", self.name),
                    )
                    .hint(
                        "state them under [program]: tip_control = [\"TRAORI\"] or what the control calls it",
                    )
                    .into());
                }
                continue;
            }
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
                .hint(self.axis_named(*axis, *kind))
                .into());
            }
        }
        Ok(Machine { axes: *axes, ..self.clone() })
    }

    /// The hint to name an axis of a kind among those that there are.
    fn axis_named(&self, axis: Axis, kind: Kind) -> String {
        let key = if kind == Kind::Rotary { "rotary" } else { "linear" };
        let own = self.axes.as_slice().iter().filter(|(_, own)| *own == kind).map(|(axis, _)| *axis);
        let names: Vec<String> = own.chain([axis]).map(|axis| format!("\"{axis}\"")).collect();
        format!(
            "where there is one, state it {}",
            self.to_state(&format!("[axes] {key} = [{}]", names.join(", ")))
        )
    }

    /// Which of the program's axes the control counts the other way.
    pub fn reversed(&self) -> [bool; MAX_AXES] {
        let mut reversed = [false; MAX_AXES];
        for (i, (axis, _)) in self.axes.as_slice().iter().enumerate() {
            // The components of a direction are counted as the axes that they lie along.
            let along = match self.axes.direction().and_then(|first| i.checked_sub(first)) {
                Some(component) => self.axes.name(component),
                None => *axis,
            };
            reversed[i] = self.limits(along).reversed;
        }
        reversed
    }

    /// Where axis `i` is clear in machine coordinates, in its decimals.
    pub fn home(&self, i: usize) -> Option<Decimal> {
        let home = self.limits(self.axes.name(i)).home?;
        Decimal::round(home, self.axis_digits()[i])
    }

    /// Whether axis `i` can retract to a clear place in machine coordinates.
    pub fn retracts(&self, i: usize) -> bool {
        let own = self.frame.home_axis.is_none_or(|axis| axis == self.axes.name(i));
        own && self.home(i).is_some() && !self.frame.home.is_empty()
    }

    /// Z, X and Y, where each can go to a place in machine coordinates: there the tool is clear of the work.
    pub fn park(&self) -> Option<[usize; 3]> {
        let index = |name: &str| Axis::new(name).and_then(|axis| self.axes.index_of(axis));
        let [z, x, y] = ["Z", "X", "Y"].map(|name| index(name).filter(|i| self.retracts(*i)));
        Some([z?, x?, y?])
    }

    /// Whether the lines of a tool call the length of the tool by a word of their own.
    pub fn calls_length(&self) -> bool {
        let mut lines = self.frame.tool.iter().chain(&self.frame.tool_spindle);
        lines.any(|line| line::words(&line.0).iter().any(|word| word.is("G43")))
    }

    /// The machine with what it knows of itself filled into its lines: `{axes}`, every axis that it has at zero, and the homes
    /// before tool centre point control ends.
    #[must_use]
    pub fn filled(&self) -> Machine {
        let zeros: Vec<String> = self.declared.iter().map(|axis| self.zero(*axis)).collect();
        let homes: Vec<String> = match self.park() {
            Some(axes) => axes.iter().map(|axis| home_word(*axis, self)).collect(),
            None => Vec::new(),
        };
        let mut machine = self.clone();
        machine.frame.header = spread(&self.frame.header, "axes", &zeros);
        machine.frame.footer = spread(&self.frame.footer, "axes", &zeros);
        let ends = |line: &template::Template| line.variables().any(|name| name == "home");
        let (home, other): (Vec<_>, Vec<_>) = self.frame.tip_control_end.iter().cloned().partition(ends);
        // All lines that go home, axis by axis, and then those that end it.
        let mut lines = Vec::new();
        for word in &homes {
            lines.extend(home.iter().map(|line| template::Template(line.fill(&[("home", word)]))));
        }
        lines.extend(other);
        machine.frame.tip_control_end = lines;
        machine
    }

    /// The word of an axis at zero.
    fn zero(&self, axis: Axis) -> String {
        let equals = if axis.as_str().len() == 1 { "" } else { "=" };
        format!("{axis}{equals}{}", spelled(Decimal::ZERO, self))
    }

    /// Whether the length of a tool may be taken from any register: its lines have a place for the number, and no line that takes
    /// the length again has the number of the tool.
    pub fn has_registers(&self) -> bool {
        let frame = &self.frame;
        let calls = [&frame.tool, &frame.tool_spindle];
        let again = [&frame.tip_control, &frame.plane];
        calls.into_iter().filter(|lines| !lines.is_empty()).all(|lines| says(lines, "register"))
            && again.into_iter().all(|lines| !says(lines, "tool"))
    }

    /// Whether programs say their number.
    pub fn has_number(&self) -> bool {
        says(&self.frame.header, "number")
    }

    /// Whether programs say their name.
    pub fn has_name(&self) -> bool {
        [&self.frame.header, &self.frame.footer, &self.frame.close]
            .into_iter()
            .any(|lines| says(lines, "name"))
    }

    /// The names of the linear axes, separated by commas.
    pub fn linear_names(&self) -> String {
        let linear = self.axes.as_slice().iter().filter(|(_, kind)| *kind == Kind::Linear);
        linear.map(|(axis, _)| axis.as_str()).collect::<Vec<_>>().join(",")
    }

    /// Whether spline blocks may move an axis.
    pub fn splines_move(&self, axis: Axis) -> bool {
        let direction = Axes::with_direction().as_slice()[3..].iter().any(|(own, _)| *own == axis);
        if direction { self.orientation.second_curve } else { self.spline.axes.contains(&axis) }
    }

    /// The axes that spline blocks may not move, of those given.
    pub fn axes_without_spline(&self, moving: &[Axis]) -> Vec<Axis> {
        moving.iter().copied().filter(|axis| !self.splines_move(*axis)).collect()
    }
}

/// Lines with all words in the place of a variable; a line with `{i}` once for each word.
fn spread(lines: &[template::Template], variable: &str, words: &[String]) -> Vec<template::Template> {
    let mut all = Vec::new();
    for line in lines {
        let has = |name: &str| line.variables().any(|own| own == name);
        if has(variable) && has("i") {
            let each = words.iter().enumerate();
            all.extend(each.map(|(i, word)| line.fill(&[("i", &(i + 1).to_string()), (variable, word)])));
        } else {
            all.push(line.fill(&[(variable, &words.join(" "))]));
        }
    }
    all.into_iter().map(template::Template).collect()
}

/// Whether a variable stands in some lines.
fn says(lines: &[template::Template], variable: &str) -> bool {
    lines.iter().any(|line| line.variables().any(|known| known == variable))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a hint says to write is a file that can be.
    #[test]
    fn hints_extend_what_can_be_extended() {
        for (name, text) in BUILT_IN {
            let built_in = Machine::built_in(name).unwrap();
            let said = built_in.to_state("[axes] linear = [\"X\"]");
            let file =
                said.strip_prefix("in a machine file: ").unwrap().replace(", ", "\n").replace("] ", "]\n");
            assert!(Machine::parse(&file, SourceId::INPUT).is_ok(), "{file}: {text}");
            let own =
                Machine::parse(&format!("extends = \"{name}\"\nname = \"mine\"\n"), SourceId::INPUT).unwrap();
            assert_eq!(own.to_state("keys"), "in the file of machine `mine`: keys");
        }
    }

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
        let text = "extends = \"sinumerik\"\nmotion = \"spl\"\n[digits]\nlinear = 12\n[text]\nnumber_step = 100000000\n[spline]\npoly_degree = 9\n";
        let ids: Vec<&str> =
            Machine::parse(text, SourceId::INPUT).unwrap_err().0.iter().map(|d| d.id).collect();
        assert_eq!(ids, ["motion-unknown", "digits-range", "block-number-range", "degree-range"]);
        assert_eq!(
            Machine::parse("extends = \"fanuk\"", SourceId::INPUT).unwrap_err().0[0].id,
            "machine-unknown"
        );
        assert!(Machine::parse("", SourceId::INPUT).unwrap_err().has_errors());
    }

    #[test]
    fn a_tool_gets_its_length_again_where_home_ended_it() {
        let ids = |dialect: &str, lines: &str| -> Vec<&'static str> {
            let text = format!("extends = \"{dialect}\"\n[program]\n{lines}\n");
            Machine::parse(&text, SourceId::INPUT)
                .map_or_else(|e| e.0.iter().map(|d| d.id).collect(), |_| Vec::new())
        };
        let sinumerik = |lines: &str| ids("sinumerik", lines);
        for tool in [
            "\"T{tool}\", \"M6\"",
            "\"T{tool} D0\", \"M6\"",
            "\"D1\", \"T{tool} M6 D0\"",
            "\"T{tool} M6 ;D1\"",
        ] {
            assert_eq!(sinumerik(&format!("tool = [{tool}]")), ["tool-length"], "{tool}");
        }
        for tool in
            ["\"T{tool}\", \"M6\", \"D1\"", "\"T{tool} M6 D=2\"", "\"T{tool}D1 M6\"", "\"T1 M6 D{tool}\""]
        {
            assert!(sinumerik(&format!("tool = [{tool}]")).is_empty(), "{tool}");
        }
        // Where nothing ends it, nothing has to call it.
        assert!(sinumerik("tool = [\"T{tool}\", \"M6\"]\nhome = [\"G0 SUPA {home}\"]").is_empty());
        assert_eq!(sinumerik("tool_spindle = [\"T{tool} M6 S{rpm} M3\"]"), ["tool-length"]);
        assert_eq!(sinumerik("plane = ['CYCLE800({first},{second},{third})']"), ["plane-length"]);
        // A control that takes the length from its tool data has no G43.
        assert!(ids("mazak", "tool = [\"T{tool} M6\"]").is_empty());
    }

    #[test]
    fn places_of_rotary_axes_are_no_direction() {
        let told = |line: &str| {
            let text = format!("extends = \"mazak\"\n[program]\ntip_control = [\"{line}\"]\n");
            Machine::parse(&text, SourceId::INPUT).map_or_else(|e| e.0[0].id, |_| "")
        };
        assert_eq!(told("G43.4 H{tool}"), "mode-not-granted");
        assert_eq!(told("G43.4H{tool}"), "mode-not-granted");
        assert_eq!(told("G43.5 H{tool}"), "");
    }

    #[test]
    fn lines_round_a_program_leave_it_as_it_takes_itself_to_be() {
        let told = |dialect: &str, key: &str, lines: &str| {
            let text = format!("extends = \"{dialect}\"\n[program]\n{key} = [{lines}]\n");
            Machine::parse(&text, SourceId::INPUT).map_or_else(|e| e.0[0].message.clone(), |_| String::new())
        };
        let refused = [
            ("mazak", "header", "\"O{number}({name})\", \"G91\"", "G91"),
            ("mazak", "home", "\"G91 G28 {home}\"", "G91"),
            ("mazak", "header", "\"G17G20G90\"", "G20"),
            ("mazak", "tool", "\"T{tool} M6\", \"g95\"", "G95"),
            ("sinumerik", "header", "\"G90 G700\"", "G700"),
            ("sinumerik", "footer", "\"G19\", \"M30\"", "G19"),
            ("heidenhain", "header", "\"0 BEGIN PGM {name} INCH\"", "INCH"),
        ];
        for (dialect, key, lines, word) in refused {
            let message = told(dialect, key, lines);
            assert!(message.contains(&format!("`{word}`")), "{lines}: {message}");
        }
        let allowed = [
            ("mazak", "home", "\"G91 G28 {home}\", \"G90\""),
            ("mazak", "header", "\"G91 G28 X0\", \"G90 (G91 IS OVER)\""),
            ("sinumerik", "header", "\"; {name}, NO G91\", \"G910\", \"R91=1\""),
        ];
        for (dialect, key, lines) in allowed {
            assert_eq!(told(dialect, key, lines), "", "{lines}");
        }
    }
}
