//! What a grammar says in words: `? an axis of the machine ?`.

use super::generate::Random;
use splinepost::machine::Machine;
use splinepost::machine::template::Template;
use splinepost::units::Kind;

/// What the words in question marks mean for one machine.
pub(super) struct Terms {
    axes: Vec<(String, Kind)>,
    /// Which of them wrap at 360 degrees.
    wrapping: Vec<String>,
    /// An axis and its home.
    home: String,
    /// All lines of the machine file, to recognise.
    lines: Vec<Template>,
    /// Those that begin something, to generate.
    beginnings: Vec<Template>,
}

/// Signs for comments, some of which mean something elsewhere.
const SIGNS: &[char] = &['A', 'z', '7', ' ', '.', '-', '=', '"', ';', '~', '(', ')', '%', '[', 'ä', '°', 'µ'];

impl Terms {
    /// Without a machine: there are no axes and no lines.
    pub(super) fn plain() -> Terms {
        Terms {
            axes: Vec::new(),
            wrapping: Vec::new(),
            home: String::new(),
            lines: Vec::new(),
            beginnings: Vec::new(),
        }
    }

    /// For a machine.
    pub(super) fn of(machine: &Machine) -> Terms {
        let filled = machine.filled();
        let frame = &filled.frame;
        let calls = [
            &frame.tool,
            &frame.spindle,
            &frame.tool_spindle,
            &frame.coolant,
            &frame.start,
            &frame.unwind,
            &frame.home,
            &frame.coolant_stop,
            &frame.spindle_stop,
            &frame.stop,
            &frame.optional_stop,
            &frame.dwell,
            &frame.tip_control,
            &frame.tip_control_end,
            &frame.length_end,
            &frame.plane,
            &frame.plane_end,
            &frame.shift,
        ];
        let all = [&frame.header, &frame.footer, &frame.close].into_iter().chain(calls);
        let wrapping = machine.axes.as_slice().iter().filter(|(axis, _)| machine.limits(*axis).modulo);
        Terms {
            axes: machine.axes.as_slice().iter().map(|(axis, kind)| (axis.to_string(), *kind)).collect(),
            wrapping: wrapping.map(|(axis, _)| axis.to_string()).collect(),
            home: splinepost::dialect::parts::home_word(2, machine),
            lines: all.flatten().chain([&frame.call, &frame.begin, &frame.end]).cloned().collect(),
            beginnings: calls.iter().filter_map(|lines| lines.first()).cloned().collect(),
        }
    }

    /// The same, where a line stands alone: one that follows another of the machine file is not recognised.
    pub(super) fn alone(machine: &Machine) -> Terms {
        let terms = Terms::of(machine);
        Terms { lines: terms.beginnings.clone(), ..terms }
    }

    /// Whether the words mean something.
    pub(super) fn knows(words: &str) -> bool {
        range(words).is_some()
            || matches!(
                words,
                "tab"
                    | "end of line"
                    | "any character of a line"
                    | "an axis of the machine"
                    | "an axis of the machine whose name is one letter"
                    | "a linear axis of the machine"
                    | "an axis of the machine that wraps"
                    | "a line of the machine file"
            )
    }

    fn names(&self, words: &str) -> impl Iterator<Item = &str> {
        let (single, linear) = (words.ends_with("one letter"), words.contains("linear"));
        let wraps = words.ends_with("wraps");
        self.axes
            .iter()
            .filter(move |(name, kind)| (!single || name.len() == 1) && (!linear || *kind == Kind::Linear))
            .filter(move |(name, _)| !wraps || self.wrapping.contains(name))
            .map(|(name, _)| name.as_str())
    }

    /// How long what the words mean can be at the start of `text`.
    pub(super) fn lengths(&self, words: &str, text: &str) -> Vec<usize> {
        let one = |fits: &dyn Fn(char) -> bool| -> Vec<usize> {
            text.chars().next().filter(|c| fits(*c)).map(char::len_utf8).into_iter().collect()
        };
        if let Some((first, last)) = range(words) {
            return one(&|c| (first..=last).contains(&c));
        }
        match words {
            "tab" => one(&|c| c == '\t'),
            // The last line of a text may go without.
            "end of line" if text.is_empty() => vec![0],
            "end of line" if text.starts_with("\r\n") => vec![2],
            "end of line" => one(&|c| c == '\n'),
            "any character of a line" => one(&|c| c != '\n' && c != '\r'),
            "a line of the machine file" => {
                let line = text.lines().next().unwrap_or_default();
                let fits = self.lines.iter().any(|template| is_filled_in(template, line));
                fits.then_some(line.len()).into_iter().collect()
            }
            _ => self.names(words).filter(|name| text.starts_with(name)).map(str::len).collect(),
        }
    }

    /// Something that the words mean; none where there is nothing, as without axes.
    pub(super) fn sample(&self, words: &str, random: &mut Random) -> Option<String> {
        if let Some((first, last)) = range(words) {
            let count = u32::from(last) - u32::from(first) + 1;
            let c = char::from_u32(u32::from(first) + random.below(count as usize) as u32)?;
            return Some(c.to_string());
        }
        match words {
            "tab" => Some("\t".into()),
            "end of line" => Some("\n".into()),
            "any character of a line" => random.pick(SIGNS).map(char::to_string),
            "a line of the machine file" => {
                let values = [
                    ("name", "CONE10"),
                    ("tool", "7"),
                    ("register", "7"),
                    ("rpm", "3000"),
                    ("home", &self.home),
                    ("words", "A90"),
                    ("axis", "A"),
                    ("seconds", "2.5"),
                    ("first", "90"),
                    ("second", "-12.5"),
                    ("third", "0"),
                ];
                random.pick(&self.beginnings).map(|template| template.fill(&values))
            }
            _ => random.pick(&self.names(words).collect::<Vec<_>>()).map(|name| (*name).to_owned()),
        }
    }
}

/// Whether a line is a template with a whole number for a tool and a number for a speed.
fn is_filled_in(template: &Template, line: &str) -> bool {
    template.matched(line).is_some_and(|values| {
        values.iter().all(|(variable, value)| match variable.as_str() {
            "tool" | "register" => value.bytes().all(|b| b.is_ascii_digit()),
            "label" | "i" | "number" => value.bytes().all(|b| b.is_ascii_digit()),
            "home" | "words" | "axis" => value.starts_with(|c: char| c.is_ascii_uppercase()),
            "first" | "second" | "third" => {
                value.bytes().all(|b| b.is_ascii_digit() || matches!(b, b'.' | b'+' | b'-'))
            }
            "rpm" | "seconds" => value.bytes().all(|b| b.is_ascii_digit() || b == b'.'),
            _ => true,
        })
    })
}

/// `0 to 9`
fn range(words: &str) -> Option<(char, char)> {
    let (first, last) = words.split_once(" to ")?;
    Some((first.parse().ok()?, last.parse().ok()?))
}
