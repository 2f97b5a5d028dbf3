//! Start and end of every program, and what stands round its paths: run by the [`table`] of its control.
//!
//! Nothing here knows what a program is for, so that all of them are run: cutters, jobs and CL data, in three axes, in
//! five and in tilted planes. What a path looks like is the matter of the other modules.

mod said;
mod table;

use super::words::Dialect;
use super::{Job, Rule, Violation, is_rotary};
use said::Said;
use std::collections::{BTreeMap, BTreeSet};
use table::{Before, Mode, Motion, Off, Table, table};

/// The rules that are asked of every program here and nowhere else.
pub(super) const OWN: [Rule; 7] =
    [Rule::Header, Rule::Left, Rule::Axis, Rule::Length, Rule::Upright, Rule::Direction, Rule::Remark];

/// What tilts a tool.
const PLANE: &str = "a plane";
const DIRECTION: &str = "its direction";

/// A number that is no place: a parameter, or what a word makes of one.
const UNREAD: f64 = f64::NAN;

#[allow(clippy::struct_excessive_bools, reason = "each is something that a control holds by itself")]
struct Control<'a> {
    job: &'a Job,
    table: &'static Table,
    /// By the place of the mode in the table: whether it is on; none where nothing has stated it.
    modes: Vec<Option<bool>>,
    motion: Option<Motion>,
    feed: bool,
    /// Axes whose place in the work is known, and which the program ever moves.
    known: BTreeSet<char>,
    moved: BTreeSet<char>,
    /// Axes at their home in machine coordinates.
    home: BTreeSet<char>,
    /// The zeros of a programmed shift that are not zero.
    shifted: BTreeSet<char>,
    tool: Option<f64>,
    changed: bool,
    length: bool,
    spindle: bool,
    turns: bool,
    coolant: bool,
    /// Why the tool may not stand upright: a plane, or its direction.
    tilted: Option<&'static str>,
    /// Rotary axes that a block has turned to 0.
    upright: BTreeSet<char>,
    /// Axes that steps have turned on, perhaps past 360 degrees: their next place would turn them all the way back.
    wound: BTreeSet<char>,
    finished: bool,
    line: usize,
    violations: Vec<Violation>,
}

/// What the words of one block are, as far as they need each other.
#[derive(Default)]
#[allow(clippy::struct_excessive_bools, reason = "each is a word that stands in the block or does not")]
struct Block {
    places: BTreeMap<char, f64>,
    direction: BTreeMap<usize, f64>,
    machine: bool,
    shift: bool,
    /// G43, and G43.4 or G43.5.
    length: bool,
    tip: bool,
    plane: bool,
    ends_length: bool,
    register: Option<f64>,
    /// Axes that the block names by a step.
    steps: BTreeSet<char>,
    second: bool,
    ln: bool,
}

/// Whether a word is that of a pattern, which may have a star behind.
fn fits(word: &str, pattern: &str) -> bool {
    match pattern.strip_suffix('*') {
        Some(start) => word.starts_with(start),
        None => word == pattern,
    }
}

fn any(word: &str, patterns: &[&str]) -> bool {
    patterns.iter().any(|pattern| fits(word, pattern))
}

/// The address and the number behind it.
fn split(word: &str) -> (&str, f64) {
    if let Some((address, text)) = word.split_once('=') {
        return (address, text.parse().unwrap_or(UNREAD));
    }
    let at = word.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(word.len());
    (&word[..at], word[at..].parse().unwrap_or(UNREAD))
}

/// Everything round its paths that a program breaks.
pub(super) fn check(job: &Job, text: &str) -> Vec<Violation> {
    let said = said::read(job.dialect, text);
    let table = table(job.dialect);
    let mut control = Control {
        job,
        table,
        modes: table.modes.iter().map(|_| None).collect(),
        motion: None,
        feed: false,
        known: BTreeSet::new(),
        moved: BTreeSet::new(),
        home: BTreeSet::new(),
        shifted: BTreeSet::new(),
        tool: None,
        changed: false,
        length: false,
        spindle: said.iter().flat_map(|said| &said.words).any(|word| {
            let (address, value) = split(word);
            address == "S" && 0.0 < value
        }),
        turns: false,
        coolant: false,
        tilted: None,
        upright: BTreeSet::new(),
        wound: BTreeSet::new(),
        finished: false,
        line: 0,
        violations: Vec::new(),
    };
    control.moved = control.ever_moved(&said);
    for said in &said {
        control.said(said);
    }
    control.violations
}

impl Control<'_> {
    fn require(&mut self, holds: bool, rule: Rule, what: impl Into<String>) {
        if !holds {
            self.violations.push(Violation { line: self.line, rule, what: what.into() });
        }
    }

    fn axis(&self, word: &str) -> Option<char> {
        // C alone is a circle.
        let (address, _) = split(word);
        let mut letters = address.chars().take_while(|_| address.len() < word.len());
        let first = letters.next()?;
        let letter = match (first, letters.next(), letters.next()) {
            (letter, None, _) => letter,
            // A step of Klartext.
            ('I', Some(letter), None) if self.job.dialect == Dialect::Heidenhain => letter,
            _ => return None,
        };
        "XYZABCUVW".contains(letter).then_some(letter)
    }

    /// The axes that count from the work anywhere.
    fn ever_moved(&self, said: &[Said]) -> BTreeSet<char> {
        let moves = |said: &&Said| {
            let is = |word: &str| said.words.iter().any(|own| own == word);
            !is(self.table.machine) && !is("G52") && !is("TRANS") && !is("CC") && !is("G4") && !is("TOOL")
        };
        let words = said.iter().filter(moves).flat_map(|said| &said.words);
        words.filter_map(|word| self.axis(word)).collect()
    }

    fn mode(&self, what: &str) -> bool {
        self.table.modes.iter().zip(&self.modes).any(|(mode, on)| mode.what == what && *on == Some(true))
    }

    /// Whether the machine has a mode at all.
    fn has(&self, mode: &Mode) -> bool {
        !mode.tilting || self.job.tilts
    }

    fn said(&mut self, said: &Said) {
        self.line = said.line;
        if let Some(text) = &said.remark {
            self.remark(text);
        }
        if said.words.is_empty() {
            return;
        }
        // A dwell moves nothing, whatever its words are.
        if said.words.iter().any(|word| word == "G4") {
            return;
        }
        if let [first, second, axes @ ..] = said.words.as_slice()
            && first == "L"
            && second == "M94"
        {
            return self.unwind(axes);
        }
        let mut block = Block::default();
        if self.job.dialect == Dialect::Heidenhain && said.words[0].starts_with("CYCL DEF 7.") {
            return self.datum(&said.words[0]);
        }
        if self.job.dialect == Dialect::Heidenhain && said.words[0] == "TOOL" {
            return self.tool_call(&said.words);
        }
        for word in &said.words {
            self.word(word, &mut block);
        }
        self.act(&block);
    }

    /// `L M94 A`: the axis counts below 360 degrees again; without one all do.
    fn unwind(&mut self, axes: &[String]) {
        self.wound.retain(|wound| !axes.is_empty() && !axes.iter().any(|axis| axis.starts_with(*wound)));
    }

    /// None of these axes may be anywhere but below 360 degrees.
    fn is_unwound(&mut self, axes: &[char], place: &str) {
        for axis in axes {
            let wound = self.wound.contains(axis);
            self.require(!wound, Rule::Left, format!("the turns of {axis} are left {place}"));
        }
    }

    fn remark(&mut self, text: &str) {
        // Lower case is skipped where a program is read in.
        let fits = self.job.dialect != Dialect::Mazak
            || !text.contains(|c: char| c.is_ascii_lowercase() || "$!".contains(c));
        self.require(fits, Rule::Remark, format!("letters that the control does not take: {text}"));
        self.require(!text.contains(": 1 PATHS"), Rule::Remark, "one path is not several");
    }

    /// `CYCL DEF 7.1 X+0`
    fn datum(&mut self, line: &str) {
        let Some(word) = line.split(' ').nth(3).filter(|_| !line.ends_with("SHIFT")) else { return };
        if let Some(axis) = self.axis(word) {
            let (_, to) = split(word);
            self.named(axis);
            self.shift(axis, to);
        }
    }

    fn shift(&mut self, axis: char, to: f64) {
        if to == 0.0 {
            self.shifted.remove(&axis);
        } else {
            self.shifted.insert(axis);
        }
    }

    fn named(&mut self, axis: char) {
        let has = self.job.axes.contains(&axis);
        self.require(has, Rule::Axis, format!("the machine has no axis {axis}"));
    }

    /// `TOOL CALL 3 Z S12000`
    fn tool_call(&mut self, words: &[String]) {
        let Some(tool) = words.get(2).and_then(|word| word.parse().ok()) else {
            return;
        };
        self.tool = Some(tool);
        self.change();
        self.length = true;
    }

    fn change(&mut self) {
        self.require(self.tool.is_some(), Rule::Tool, "no tool is called for the change");
        let home =
            self.home.contains(&'Z') || self.job.home_axis.is_none_or(|axis| self.home.contains(&axis));
        self.require(home, Rule::Home, "the tool is changed away from home");
        self.require(!self.coolant, Rule::Coolant, "coolant flows while the tool is changed");
        self.must_be_off(Off::Tool, "where a tool is changed");
        self.is_unwound(&Vec::from_iter(self.wound.clone()), "where a tool is changed");
        self.changed = self.tool.is_some();
        self.length = false;
    }

    fn must_be_off(&mut self, at: Off, place: &str) {
        for (mode, on) in self.table.modes.iter().zip(self.modes.clone()) {
            let left = on == Some(true) && mode.must.contains(&at);
            let own = ["tip control", "tilted plane", "second curve", "modal call", "cycle", "feed"];
            let rule = if own.contains(&mode.what) { Rule::Left } else { Rule::Header };
            self.require(!left, rule, format!("{} is left {place}", mode.what));
        }
    }

    fn must_be_stated(&mut self, before: &[Before]) {
        for (mode, on) in self.table.modes.iter().zip(self.modes.clone()) {
            let missing = on.is_none() && before.contains(&mode.before) && self.has(mode);
            self.require(!missing, Rule::Header, format!("{} may be left from another program", mode.what));
        }
    }

    fn word(&mut self, word: &str, block: &mut Block) {
        let table = self.table;
        for (mode, on) in table.modes.iter().zip(self.modes.iter_mut()) {
            if any(word, mode.off) {
                *on = Some(false);
            } else if any(word, mode.on) {
                *on = Some(true);
            }
        }
        let known = table.modes.iter().any(|mode| any(word, mode.off) || any(word, mode.on));
        if any(word, table.length_end) {
            block.ends_length = true;
        }
        if let Some(list) = word.strip_prefix("FGROUP(").or_else(|| word.strip_prefix("SPLINEPATH(1,")) {
            list.trim_end_matches(')')
                .split(',')
                .filter_map(|axis| axis.chars().next())
                .for_each(|axis| self.named(axis));
        }
        match word {
            "TRANS" => {
                self.shifted.clear();
                block.shift = true;
            }
            "G52" => block.shift = true,
            "G43" => block.length = true,
            "G43.4" | "G43.5" => block.tip = true,
            "G68.2" => block.plane = true,
            "CC" => block.shift = false,
            "LN" => block.ln = true,
            _ => {}
        }
        if let Some(angles) = word.strip_prefix("CYCLE800(").map(|rest| rest.split(',').collect::<Vec<_>>())
            && let [_, _, _, _, _, _, _, a, b, c, ..] = angles[..]
        {
            self.plane([a, b, c].iter().any(|angle| angle.parse() != Ok(0.0)));
        }
        if word.starts_with("PLANE SPATIAL") {
            let angles = word.split(' ').filter(|word| word.starts_with("SP") && *word != "SPATIAL");
            self.plane(angles.map(split).any(|(_, angle)| angle != 0.0));
        }
        if let Some((_, motion)) = table.motions.iter().find(|(own, _)| *own == word) {
            self.motion = Some(*motion);
            return;
        }
        if word == table.machine {
            block.machine = true;
        } else if any(word, table.change) {
            self.change();
        } else if any(word, table.finish) {
            self.finish();
        } else if any(word, table.spindle.0) {
            self.turns = true;
        } else if any(word, table.spindle.1) {
            self.turns = false;
        } else if any(word, table.coolant.0) {
            self.coolant = true;
        } else if any(word, table.coolant.1) {
            self.coolant = false;
        } else {
            self.valued(word, block, known);
        }
    }

    /// A word with a number.
    fn valued(&mut self, word: &str, block: &mut Block, known: bool) {
        let table = self.table;
        let (address, value) = split(word);
        let component = table
            .direction
            .iter()
            .position(|own| word.starts_with(own) && (own.len() == 2 || *own == address));
        let directed = self.mode(table.tip) || block.plane;
        if let Some(component) = component.filter(|_| directed) {
            // A3=0.5 is no number of A.
            let value = word.split_once('=').map_or(value, |(_, text)| text.parse().unwrap_or(UNREAD));
            block.direction.insert(component, value);
            return;
        }
        if let Some(axis) = self
            .axis(word)
            .filter(|_| !word.starts_with("A3") && !word.starts_with("B3") && !word.starts_with("C3"))
        {
            self.named(axis);
            block.places.insert(axis, value);
            if address.len() == 2 {
                block.steps.insert(axis);
            }
            return;
        }
        match address {
            "T" => self.tool = Some(value),
            "D" => self.length = value != 0.0,
            "H" => block.register = Some(value),
            "F" | "FQ" => self.feed = true,
            "XH" | "YH" | "ZH" => block.second = true,
            _ => {
                if word.starts_with("PO[XH]") {
                    block.second = true;
                }
                let known =
                    known || any(word, table.free) || table.numbers.contains(&address) || word.ends_with(':');
                self.require(known, Rule::Word, format!("`{word}` is in no table"));
            }
        }
        if let Some(axis) = word
            .strip_prefix("PO[")
            .and_then(|rest| rest.chars().next())
            .filter(|_| word.as_bytes().get(4) == Some(&b']'))
        {
            self.named(axis);
            block.places.insert(axis, UNREAD);
        }
    }

    fn act(&mut self, block: &Block) {
        if block.ends_length {
            self.end_length(block);
        }
        if block.shift {
            for (axis, to) in &block.places {
                self.shift(*axis, *to);
            }
            return;
        }
        if block.plane {
            self.plane(block.direction.values().any(|angle| *angle != 0.0));
            self.known.clear();
            return;
        }
        if block.length || block.tip {
            self.call_length(block);
        }
        if block.machine {
            return self.go_home(block);
        }
        if !block.places.is_empty() || !block.direction.is_empty() {
            self.moves(block);
        }
    }

    /// G43 without an axis may move Z by the length; a tip is led from the block of its first move.
    fn call_length(&mut self, block: &Block) {
        let moves = if block.tip {
            "XYZ".chars().all(|axis| block.places.contains_key(&axis)) && block.direction.len() == 3
        } else {
            block.places.contains_key(&'Z')
        };
        let what = if block.tip {
            "tip control is called without a move"
        } else {
            "a length is called without a move of Z"
        };
        self.require(moves && self.motion.is_some(), Rule::Length, what);
        let own = block.register.is_some() && block.register == self.tool;
        self.require(own, Rule::Tool, "the length is another tool's");
        self.length = true;
    }

    /// What ends a length stands in machine coordinates, or, where it moves, at the park place.
    fn end_length(&mut self, block: &Block) {
        self.length = false;
        if !self.table.length_end_moves {
            self.require(block.machine, Rule::Length, "a length ends where the tool may be at the work");
            return;
        }
        let parked = "XYZ".chars().all(|axis| self.home.contains(&axis));
        self.require(parked, Rule::Length, "a length ends away from the park place");
    }

    fn go_home(&mut self, block: &Block) {
        self.must_be_stated(&[Before::Retraction]);
        self.must_be_off(Off::Home, "on the way home");
        self.require(self.motion == Some(Motion::Rapid), Rule::Home, "the way home is not a rapid");
        for (axis, to) in &block.places {
            let home = self.job.homes.get(axis).is_some_and(|home| home == to);
            self.require(home, Rule::Home, format!("this is not the home of {axis}"));
            self.known.remove(axis);
            if home {
                self.home.insert(*axis);
            }
            if is_rotary(*axis) && *to == 0.0 {
                self.upright.insert(*axis);
            }
        }
        // On some controls the length is out of force then.
        if self.job.dialect == Dialect::Mazak && !self.mode(self.table.tip) {
            self.length = false;
        }
        self.straighten();
    }

    /// A plane is tilted, or made upright: the axes turn.
    fn plane(&mut self, tilted: bool) {
        let home = self.job.home_axis.is_none_or(|axis| self.home.contains(&axis));
        self.require(home, Rule::Home, "a plane is tilted while the tool is away from home");
        self.tilted = tilted.then_some(PLANE);
    }

    /// All rotary axes at 0, while nothing leads the tip, are a tool that stands upright.
    fn straighten(&mut self) {
        let mut rotary = self.job.axes.iter().filter(|axis| is_rotary(**axis)).peekable();
        if rotary.peek().is_some()
            && rotary.all(|axis| self.upright.contains(axis))
            && !self.mode(self.table.tip)
        {
            self.tilted = None;
        }
    }

    fn moves(&mut self, block: &Block) {
        self.require(!self.finished, Rule::End, "the program has ended before");
        self.must_be_stated(&[Before::Retraction, Before::Move]);
        self.require(self.changed, Rule::Tool, "no tool is in the spindle");
        let feeds = self.motion == Some(Motion::Feed);
        let needs_length = feeds || self.job.dialect != Dialect::Mazak || block.places.contains_key(&'Z');
        self.require(self.length || !needs_length, Rule::Tool, "no tool length counts");
        if feeds {
            self.require(self.feed, Rule::Feed, "no feed is in force for this move");
            self.require(self.turns || !self.spindle, Rule::Spindle, "the spindle does not turn");
            // One axis alone comes down from wherever it is.
            let alone = block.places.len() == 1;
            let unknown: String = self
                .moved
                .iter()
                .filter(|axis| !(self.known.contains(axis) || alone && block.places.contains_key(axis)))
                .collect();
            self.require(unknown.is_empty(), Rule::Position, format!("nobody knows where {unknown} is"));
        }
        if self.mode(self.table.tip) && !block.second {
            self.require(
                block.direction.len() == 3,
                Rule::Direction,
                "a component of the direction is missing",
            );
            let whole = !block.ln || "XYZ".chars().all(|axis| block.places.contains_key(&axis));
            self.require(whole, Rule::Direction, "LN does not name X Y Z");
        }
        if block.direction.len() == 3 {
            let upright =
                block.direction[&0] == 0.0 && block.direction[&1] == 0.0 && 0.0 < block.direction[&2];
            self.tilted = (!upright).then_some(DIRECTION);
        }
        if block.second {
            self.tilted = Some(DIRECTION);
        }
        for (axis, to) in &block.places {
            self.known.insert(*axis);
            self.home.remove(axis);
            let steps = block.steps.contains(axis);
            if steps && is_rotary(*axis) {
                self.wound.insert(*axis);
            } else {
                self.is_unwound(&[*axis], "before its next place");
            }
            if is_rotary(*axis) && *to == 0.0 && !steps {
                self.upright.insert(*axis);
            } else {
                self.upright.remove(axis);
            }
        }
        self.straighten();
    }

    fn finish(&mut self) {
        self.must_be_stated(&[Before::Retraction, Before::Move]);
        self.must_be_off(Off::End, "at the end");
        self.is_unwound(&Vec::from_iter(self.wound.clone()), "at the end");
        let home = self.job.home_axis.is_none_or(|axis| self.home.contains(&axis));
        self.require(home, Rule::Home, "the program ends away from home");
        self.require(!self.coolant, Rule::Coolant, "the coolant is not off at the end");
        self.require(!self.turns, Rule::End, "the spindle was not stopped");
        if let Some(why) = self.tilted {
            self.require(false, Rule::Upright, format!("the tool is left tilted by {why}"));
        }
        self.require(self.shifted.is_empty(), Rule::Offset, "the work offset is not taken back");
        self.finished = true;
    }
}
