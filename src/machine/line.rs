//! A line of a machine file as words: what stands in it, whatever its blanks, its zeros and what is filled in.
//!
//! `G43H{tool}`, `g043 H {tool}` and `G43 H{tool}` are the same two words. Compared as texts they would be three lines, and
//! what a program needs of such a line would be lost in two of them. So whatever is asked of a line is asked of its words.
//!
//! A word is an address and what is behind it: texts and places to fill in, in their order.
//!
//! ```text
//! G43 H2{tool}                address G, text 43; address H, text 2, place tool
//! G0 SUPA {home} D0           G 0; SUPA; place home; D 0
//! CYCLE800(0,"",{first})      address CYCLE800, text (0,"", place first, text )
//! T="MILL" M06 ; D1           T "MILL"; M 06; what is behind ; is a remark, and what is in brackets of its own
//! ```

/// A part of a word's value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Part {
    /// As it stands.
    Text(String),
    /// `{name}`.
    Place(String),
}

/// A word of a line.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Word {
    /// Its letters, capitals; none where a number or a place stands alone.
    pub address: String,
    /// What is behind.
    pub value: Vec<Part>,
}

impl Word {
    /// Its number, where it is one and nothing is filled in.
    pub fn number(&self) -> Option<f64> {
        match self.value.as_slice() {
            [Part::Text(text)] => text.parse().ok(),
            [] | [Part::Place(_)] | [_, _, ..] => None,
        }
    }

    /// Whether it is this code: `G043`, `g43.0` and `G43` are `G43`. What is not a letter and a number is compared as it stands.
    pub fn is(&self, code: &str) -> bool {
        let [other] = words(code).try_into().unwrap_or([Word::default()]);
        let number = |word: &Word| word.number().map(f64::to_bits);
        self.address == other.address
            && (self.value == other.value || (number(self).is_some() && number(self) == number(&other)))
    }

    /// Whether something is filled into it.
    pub fn has(&self, place: &str) -> bool {
        self.value.iter().any(|part| matches!(part, Part::Place(name) if name == place))
    }

    /// Its value as a template's text.
    pub fn text(&self) -> String {
        let part = |part: &Part| match part {
            Part::Text(text) => text.clone(),
            Part::Place(name) => format!("{{{name}}}"),
        };
        self.value.iter().map(part).collect()
    }
}

/// The words of a line, without its remarks.
pub fn words(line: &str) -> Vec<Word> {
    let mut reader = Reader { rest: line, words: Vec::new() };
    while reader.word() {}
    reader.words
}

struct Reader<'l> {
    rest: &'l str,
    words: Vec<Word>,
}

impl<'l> Reader<'l> {
    /// Takes what fits from the start of the rest.
    fn take(&mut self, fits: impl Fn(char) -> bool) -> &'l str {
        let (taken, rest) = self.rest.split_at(self.rest.find(|c| !fits(c)).unwrap_or(self.rest.len()));
        self.rest = rest;
        taken
    }

    /// Takes as many bytes.
    fn cut(&mut self, length: usize) -> &'l str {
        let (taken, rest) = self.rest.split_at(length.min(self.rest.len()));
        self.rest = rest;
        taken
    }

    /// Up to a closing sign, that with it, or all that is left.
    fn through(&mut self, close: char) -> &'l str {
        let length = self.rest.char_indices().skip(1).find(|(_, c)| *c == close);
        self.cut(length.map_or(self.rest.len(), |(at, c)| at + c.len_utf8()))
    }

    /// The next word; false at the end of the line.
    fn word(&mut self) -> bool {
        self.take(char::is_whitespace);
        let Some(first) = self.rest.chars().next() else { return false };
        match first {
            ';' => return false,
            '(' => drop(self.through(')')),
            '"' => {
                let text = self.through('"').to_owned();
                self.words.push(Word { address: String::new(), value: vec![Part::Text(text)] });
            }
            _ if first.is_ascii_alphabetic() || "_#".contains(first) => self.addressed(),
            _ if first == '{' || is_figure(first) => {
                let value = self.value();
                self.words.push(Word { address: String::new(), value });
            }
            _ => drop(self.cut(first.len_utf8())),
        }
        true
    }

    /// A word that begins with letters.
    fn addressed(&mut self) {
        let mut address = self.take(|c| c.is_ascii_alphabetic() || "_#".contains(c)).to_ascii_uppercase();
        // A letter may stand apart from its number.
        if address.len() == 1 && self.rest.trim_start().starts_with(|c| c == '{' || is_figure(c)) {
            self.take(char::is_whitespace);
        }
        let mut value = self.value();
        let behind = self.rest.trim_start();
        let name = |value: &[Part]| match value {
            [] => Some(String::new()),
            [Part::Text(text)] => Some(text.clone()),
            [Part::Place(_)] | [_, _, ..] => None,
        };
        if let Some(figures) = name(&value) {
            if let Some(assigned) = behind.strip_prefix('=') {
                // A3=0.5, D=2, T="MILL": what stood there belongs to the name.
                self.rest = assigned.trim_start();
                address.push_str(&figures);
                value = self.assigned();
            } else if self.rest.starts_with('(') && 1 < address.len() {
                address.push_str(&figures);
                value = parts(self.through(')'));
            }
        }
        self.words.push(Word { address, value });
    }

    /// What stands behind `=`.
    fn assigned(&mut self) -> Vec<Part> {
        if self.rest.starts_with('"') {
            return vec![Part::Text(self.through('"').to_owned())];
        }
        let name = self.rest.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(self.rest.len());
        if 0 < name && self.rest[name..].starts_with('(') {
            let name = self.cut(name).to_owned();
            let value = parts(self.through(')'));
            return std::iter::once(Part::Text(name)).chain(value).collect();
        }
        let value = self.value();
        if value.is_empty() {
            vec![Part::Text(self.take(|c| c.is_ascii_alphanumeric()).to_owned())]
        } else {
            value
        }
    }

    /// Figures and places.
    fn value(&mut self) -> Vec<Part> {
        let mut value = Vec::new();
        loop {
            if self.rest.starts_with('{') {
                value.extend(parts(self.through('}')));
            } else if self.rest.starts_with(is_figure) {
                value.push(Part::Text(self.take(is_figure).to_owned()));
            } else {
                return value;
            }
        }
    }
}

/// What a number is made of.
fn is_figure(c: char) -> bool {
    c.is_ascii_digit() || "+-.".contains(c)
}

/// A text with places in it.
fn parts(text: &str) -> Vec<Part> {
    let mut parts = Vec::new();
    let mut rest = text;
    while let Some((before, behind)) = rest.split_once('{') {
        let Some((name, after)) = behind.split_once('}') else { break };
        if !before.is_empty() {
            parts.push(Part::Text(before.to_owned()));
        }
        parts.push(Part::Place(name.to_owned()));
        rest = after;
    }
    if !rest.is_empty() {
        parts.push(Part::Text(rest.to_owned()));
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spelled(line: &str) -> Vec<String> {
        words(line).iter().map(|word| format!("{}|{}", word.address, word.text())).collect()
    }

    #[test]
    fn words_are_told_apart_without_blanks() {
        for line in
            ["G43H{tool}", "G43 H{tool}", "g43  h {tool}", "G 43 H{tool}(LENGTH)", "G43H{tool} ; LENGTH"]
        {
            assert_eq!(spelled(line), ["G|43", "H|{tool}"], "{line}");
        }
        assert_eq!(spelled("G43 H2{tool}"), ["G|43", "H|2{tool}"]);
        assert_eq!(spelled("G91G28Z0."), ["G|91", "G|28", "Z|0."]);
        assert_eq!(spelled("G0 SUPA {home} D0"), ["G|0", "SUPA|", "|{home}", "D|0"]);
        assert_eq!(
            spelled("N10 T=\"D1 X\" M06 D=2 A3=-0.5"),
            ["N|10", "T|\"D1 X\"", "M|06", "D|2", "A3|-0.5"]
        );
        assert_eq!(
            spelled("CYCLE800(0,\"\",{first},-1) FGROUP({linear})"),
            ["CYCLE800|(0,\"\",{first},-1)", "FGROUP|({linear})"]
        );
        assert_eq!(spelled("TOOL CALL {tool} Z S{rpm}"), ["TOOL|", "CALL|", "|{tool}", "Z|", "S|{rpm}"]);
        assert_eq!(spelled("0 BEGIN PGM {name} INCH"), ["|0", "BEGIN|", "PGM|", "|{name}", "INCH|"]);
        assert_eq!(spelled("A=DC({first}) #101=3.5 %"), ["A|DC({first})", "#101|3.5"]);
        assert_eq!(spelled("(G49) \"G49\" {open"), ["|\"G49\"", "|{open"]);
    }

    #[test]
    fn a_code_is_itself_however_it_is_spelled() {
        let is = |line: &str, code: &str| words(line).iter().any(|word| word.is(code));
        for (line, code) in
            [("G049", "G49"), ("g49.0", "G49"), ("G5.1 Q1", "G05.1"), ("BEGIN PGM INCH", "INCH")]
        {
            assert!(is(line, code), "{line}");
        }
        for (line, code) in
            [("G490", "G49"), ("G4{tool}", "G4"), ("R49=1", "G49"), ("(G49)", "G49"), ("G43.5", "G43")]
        {
            assert!(!is(line, code), "{line}");
        }
    }
}
