//! What each diagnostic means, by its id: a sentence, and why it is so, what a control does, what to type.
//!
//! The texts are prose, so they stand in Markdown, a file for each topic in `registry/`, where they are written and
//! read without quotes and escapes. They are in the program, for `splinepost explain`, and `docs/diagnostics.md` is
//! written from them. An entry is
//!
//! ```text
//! ## knots-decrease
//!
//! error: A knot is less than the one before it.
//!
//! Knots never decrease.
//! Check the order of the list, and that no knot is missing.
//! ```
//!
//! with its severities before the colon, `error`, `refusal`, `warning` or `note`: an id has more than one where the same
//! thing is worse in one place than in another.
//! [`Diagnostic`](super::Diagnostic) asserts in debug builds that its id is here with its severity.

use super::Severity;
use serde::Serialize;
use std::fmt::Write as _;
use std::sync::LazyLock;

const TEXTS: &[&str] = &[
    include_str!("registry/usage.md"),
    include_str!("registry/inputs.md"),
    include_str!("registry/cutters.md"),
    include_str!("registry/jobs.md"),
    include_str!("registry/curve-files.md"),
    include_str!("registry/cl-data.md"),
    include_str!("registry/nc.md"),
    include_str!("registry/machine.md"),
    include_str!("registry/passes.md"),
    include_str!("registry/proof.md"),
    include_str!("registry/diff.md"),
];

/// The width of a page of text.
const WIDTH: usize = 88;

/// Ids that may have been meant, at most.
const MOST_NEAREST: usize = 3;

static TOPICS: LazyLock<Vec<Topic>> = LazyLock::new(|| TEXTS.iter().map(|text| Topic::of(text)).collect());

static BY_ID: LazyLock<Vec<&'static Entry>> = LazyLock::new(|| {
    let mut all: Vec<&Entry> = TOPICS.iter().flat_map(|topic| &topic.entries).collect();
    all.sort_by_key(|entry| entry.id);
    all
});

/// Diagnostics about one thing: CL data, machine files.
#[derive(Debug)]
pub struct Topic {
    /// Its title.
    pub title: &'static str,
    /// What is said of all of them; may be empty.
    pub about: &'static str,
    /// Its diagnostics, by their ids.
    pub entries: Vec<Entry>,
}

/// What a diagnostic means.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Its stable name: `knots-decrease`.
    pub id: &'static str,
    /// How bad it is; more than one where that depends on where it is found.
    pub severities: Vec<Severity>,
    /// One sentence: what is wrong.
    pub says: &'static str,
    /// Why it is so, what a control does, what to type: one sentence a line.
    pub text: &'static str,
}

#[derive(Serialize)]
struct JsonSeverity {
    severity: Severity,
    exit_code: u8,
}

#[derive(Serialize)]
struct JsonEntry<'a> {
    id: &'a str,
    severities: Vec<JsonSeverity>,
    says: &'a str,
    text: String,
}

impl Topic {
    fn of(text: &'static str) -> Topic {
        let (head, rest) = text.split_once("\n## ").unwrap_or((text, ""));
        let (title, about) = head.split_once('\n').unwrap_or((head, ""));
        Topic {
            title: title.trim_start_matches("# "),
            about: about.trim(),
            entries: rest.split("\n## ").filter_map(Entry::of).collect(),
        }
    }
}

impl Entry {
    /// None where the text is no entry, which a test finds.
    fn of(text: &'static str) -> Option<Entry> {
        let (id, body) = text.split_once("\n\n")?;
        let (first, text) = body.split_once("\n\n")?;
        let (severities, says) = first.split_once(": ")?;
        let severities = severities.split(", ").map(severity).collect::<Option<Vec<Severity>>>()?;
        Some(Entry { id, severities, says, text: text.trim() })
    }

    /// A page of text for a person.
    pub fn explained(&self) -> String {
        let severities: Vec<String> = self
            .severities
            .iter()
            .map(|of| format!("{} (exit code {})", word(*of), exit_code(*of)))
            .collect();
        let mut page = format!("{}: {}\n\n", self.id, severities.join(", "));
        for paragraph in std::iter::once(self.says).chain(self.text.split("\n\n")) {
            wrap(paragraph, &mut page);
            page.push('\n');
        }
        page.truncate(page.trim_end().len());
        page.push('\n');
        page
    }

    /// One JSON object, on one line.
    pub fn to_json(&self) -> String {
        let severities =
            self.severities.iter().map(|of| JsonSeverity { severity: *of, exit_code: exit_code(*of) });
        let entry = JsonEntry {
            id: self.id,
            severities: severities.collect(),
            says: self.says,
            text: self.text.replace('\n', " ").replace("  ", "\n\n"),
        };
        serde_json::to_string(&entry).unwrap_or_default() + "\n"
    }
}

/// The topics, in the order of a job: what is typed, what is read, what is made of it, how it is proved.
pub fn topics() -> &'static [Topic] {
    &TOPICS
}

/// All diagnostics, by their ids.
pub fn all() -> &'static [&'static Entry] {
    &BY_ID
}

/// What an id means.
pub fn find(id: &str) -> Option<&'static Entry> {
    let at = BY_ID.binary_search_by_key(&id, |entry| entry.id).ok()?;
    BY_ID.get(at).copied()
}

/// The ids that were probably meant: those with words in common, or few letters away.
pub fn nearest(id: &str) -> Vec<&'static str> {
    let words: Vec<&str> = id.split(['-', '_', ' ']).filter(|word| 2 < word.len()).collect();
    let near = |known: &&'static str| {
        let letters = strsim::damerau_levenshtein(id, known);
        let shared = words.iter().filter(|word| known.split('-').any(|own| own == **word)).count();
        let close = letters <= known.chars().count().div_ceil(3);
        (close || 0 < shared).then_some((std::cmp::Reverse(shared), letters))
    };
    let mut found: Vec<_> =
        all().iter().map(|entry| entry.id).filter_map(|id| Some((near(&id)?, id))).collect();
    found.sort_unstable();
    found.into_iter().take(MOST_NEAREST).map(|(_, id)| id).collect()
}

/// The ids with their sentences, by topic.
pub fn list() -> String {
    let widest = all().iter().map(|entry| entry.id.len()).max().unwrap_or(0);
    let mut text = String::new();
    for topic in topics() {
        let _ = writeln!(text, "{}{}:", if text.is_empty() { "" } else { "\n" }, topic.title);
        for entry in &topic.entries {
            let _ = writeln!(text, "  {:<widest$}  {}", entry.id, entry.says);
        }
    }
    text
}

fn severity(word: &str) -> Option<Severity> {
    match word {
        "error" => Some(Severity::Error),
        "refusal" => Some(Severity::Refusal),
        "warning" => Some(Severity::Warning),
        "note" => Some(Severity::Note),
        _ => None,
    }
}

/// A severity as a message shows it.
pub fn word(severity: Severity) -> &'static str {
    match severity {
        Severity::Error | Severity::Refusal => "error",
        Severity::Warning => "warning",
        Severity::Note => "note",
    }
}

/// With which code the program ends where nothing worse is found.
pub fn exit_code(severity: Severity) -> u8 {
    match severity {
        Severity::Error => 2,
        Severity::Refusal => 1,
        Severity::Warning | Severity::Note => 0,
    }
}

/// Appends a paragraph in lines of [`WIDTH`] at most, or with one word where that is longer.
fn wrap(paragraph: &str, into: &mut String) {
    let mut column = 0;
    for word in paragraph.split_whitespace() {
        let width = word.chars().count();
        if column != 0 && WIDTH < column + 1 + width {
            into.push('\n');
            column = 0;
        } else if column != 0 {
            into.push(' ');
            column += 1;
        }
        into.push_str(word);
        column += width;
    }
    into.push('\n');
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_entry_is_read_in_its_parts() {
        let text = "knots-decrease\n\nerror, warning: A knot: less.\n\nOne.\nTwo.\n\nThree.\n";
        let entry = Entry::of(text).unwrap();
        assert_eq!(
            (entry.id, entry.says, entry.text),
            ("knots-decrease", "A knot: less.", "One.\nTwo.\n\nThree.")
        );
        assert_eq!(entry.severities, [Severity::Error, Severity::Warning]);
        let page = "knots-decrease: error (exit code 2), warning (exit code 0)\n\nA knot: less.\n\nOne. Two.\n\nThree.\n";
        assert_eq!(entry.explained(), page);
        assert_eq!(
            entry.to_json(),
            "{\"id\":\"knots-decrease\",\"severities\":[{\"severity\":\"error\",\"exit_code\":2},\
             {\"severity\":\"warning\",\"exit_code\":0}],\"says\":\"A knot: less.\",\
             \"text\":\"One. Two.\\n\\nThree.\"}\n"
        );
        assert_eq!(Entry::of("knots-decrease\n\nwrong: A knot.\n\nOne.\n"), None);
    }

    #[test]
    fn lines_are_no_wider_than_a_page() {
        let mut text = String::new();
        wrap(&"seven77 ".repeat(30), &mut text);
        assert!(text.lines().all(|line| line.len() == 87 || line.len() == 63), "{text}");
        assert_eq!(text.split_whitespace().count(), 30);
    }

    #[test]
    fn what_was_meant_is_found() {
        assert_eq!(nearest("knot-decrease")[0], "knots-decrease");
        assert!(nearest("knots").iter().all(|id| id.starts_with("knots-")));
        assert_eq!(nearest("xyzzy"), [""; 0]);
    }
}
