//! The registry of diagnostics: in step with the source, with its page, and with the tests that show each of them.

mod shown;

use crate::support::{compare, fail_on, folder};
use crate::tidy::{code, files, source};
use splinepost::diagnostic::Severity;
use splinepost::diagnostic::registry::{self, Entry};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::PathBuf;

/// Words in kebab case that are no ids: values of keys, languages, machines, figures.
const NO_IDS: &[&str] = &[
    "acceleration-rotary",
    "chord-error",
    "constant-helix",
    "constant-lead",
    "degrees-as-mm",
    "great-circle",
    "iso-4343",
    "kebab-case",
    "left-hand",
    "left-out",
    "nurbs-siemens",
    "odd-even",
    "path-end",
    "points-only",
    "right-hand",
    "rotary-2",
    "rotary-3",
    "rotary-4",
    "rotary-5",
    "rotary-6",
    "sans-serif",
    "sinumerik-840d",
    "trace-end",
    "trace-start",
];

/// What no test and no fixture shows yet. It only gets shorter.
const UNSHOWN: &[&str] = &[
    "coefficient-digits",
    "direction-unknown",
    "figure-failed",
    "form-not-in-dialect",
    "not-comparable",
    "order-differs",
    "plane-translated",
    "second-curve-start",
    "start-differs",
    "turns-differ",
];

/// Words that are ids, and values of keys or figures too: only a row of `shown` shows them.
const BOTH: &[&str] = &["feed-error", "inverse-time"];

/// Functions whose first argument is an id, and the severity that they give it.
const RAISES: &[(&str, Severity)] = &[
    ("Diagnostic::error", Severity::Error),
    ("Diagnostic::refusal", Severity::Refusal),
    ("Diagnostic::warning", Severity::Warning),
    ("Diagnostic::note", Severity::Note),
    (".error", Severity::Error),
    (".hinted", Severity::Error),
    (".refuse", Severity::Refusal),
    (".differs", Severity::Refusal),
    ("fail", Severity::Error),
    ("failed", Severity::Error),
    ("error", Severity::Error),
    ("refusal", Severity::Refusal),
    ("wrong", Severity::Error),
];

/// A literal of the source: what stands before it, itself, and the letter behind it.
struct Literal<'t> {
    before: &'t str,
    text: &'t str,
    behind: char,
}

/// The literals of a text of Rust, without those of comments.
fn literals(text: &str) -> Vec<Literal<'_>> {
    let mut found = Vec::new();
    let bytes = text.as_bytes();
    let mut at = 0;
    while at < bytes.len() {
        match bytes[at] {
            b'/' if bytes.get(at + 1) == Some(&b'/') => {
                at += text[at..].find('\n').unwrap_or(text.len() - at);
            }
            // A quote as a character.
            b'\'' if text[at..].starts_with("'\"'") => at += 3,
            b'\'' if text[at..].starts_with("'\\") => at += 3,
            b'"' => {
                let start = at + 1;
                at = start;
                while at < bytes.len() && bytes[at] != b'"' {
                    at += if bytes[at] == b'\\' { 2 } else { 1 };
                }
                let behind = text[(at + 1).min(text.len())..].trim_start().chars().next().unwrap_or(' ');
                found.push(Literal { before: text[..start - 1].trim_end(), text: &text[start..at], behind });
                at += 1;
            }
            _ => at += 1,
        }
    }
    found
}

/// Whether a text is small letters and digits with single hyphens between, a letter first.
fn is_kebab(text: &str) -> bool {
    text.split('-')
        .all(|word| !word.is_empty() && word.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit()))
        && text.as_bytes()[0].is_ascii_lowercase()
}

/// The function that a literal is the first argument of, if it is one that raises a diagnostic.
fn raised_by(literal: &Literal<'_>) -> Option<Severity> {
    let call = literal.before.strip_suffix('(')?;
    if literal.behind != ',' {
        return None;
    }
    let found = RAISES.iter().find(|(name, _)| {
        let whole = name.starts_with(['.', 'D']);
        call.strip_suffix(name).is_some_and(|rest| {
            whole || !rest.ends_with(|c: char| c == '.' || c == '_' || c.is_alphanumeric())
        })
    });
    found.map(|(_, severity)| *severity)
}

fn code_files() -> Vec<(PathBuf, String)> {
    let registry = folder("src/diagnostic");
    let all = files(&folder("src"), "rs").into_iter().filter(|path| !path.starts_with(&registry));
    all.map(|path| (path.clone(), code(&path))).collect()
}

#[test]
fn ids_of_the_source_are_registered() {
    let mut wrong = Vec::new();
    let mut calls = 0;
    for (path, text) in code_files() {
        for literal in literals(&text).iter().filter(|literal| is_kebab(literal.text)) {
            let (id, raised) = (literal.text, raised_by(literal));
            let entry = registry::find(id);
            if entry.is_none() && !NO_IDS.contains(&id) && (id.contains('-') || raised.is_some()) {
                wrong.push(format!("{}: `{id}` has no entry in src/diagnostic/registry", path.display()));
            }
            if let (Some(severity), Some(entry)) = (raised, entry) {
                calls += 1;
                if !entry.severities.contains(&severity) {
                    wrong.push(format!("{}: `{id}` is raised as {severity:?}", path.display()));
                }
            }
        }
    }
    // Nearly every id is raised by a literal: a scan that finds a few has missed the source.
    assert!(registry::all().len() < calls, "{calls}");
    fail_on(&wrong);
}

#[test]
fn registered_ids_stand_in_the_source() {
    let mut known = BTreeSet::new();
    for (_, text) in code_files() {
        known.extend(literals(&text).iter().map(|literal| literal.text.to_owned()));
    }
    let mut wrong: Vec<String> = registry::all()
        .iter()
        .filter(|entry| !known.contains(entry.id))
        .map(|entry| format!("nothing raises `{}`", entry.id))
        .collect();
    wrong.extend(
        NO_IDS.iter().filter(|word| !known.contains(**word)).map(|word| format!("`{word}` is no word")),
    );
    fail_on(&wrong);
}

#[test]
fn entries_are_whole_and_in_order() {
    let mut wrong = Vec::new();
    let mut sections = 0;
    for path in files(&folder("src/diagnostic/registry"), "md") {
        sections += source(&path).matches("\n## ").count();
    }
    assert_eq!(
        sections,
        registry::all().len(),
        "a section of the registry is no entry, or a file is not in it"
    );
    for pair in registry::all().windows(2) {
        assert_ne!(pair[0].id, pair[1].id, "an id has two entries");
    }
    for topic in registry::topics() {
        for pair in topic.entries.windows(2) {
            assert!(pair[0].id < pair[1].id, "{}: {} stands before {}", topic.title, pair[0].id, pair[1].id);
        }
        for Entry { id, severities, says, text } in &topic.entries {
            let whole = |text: &str| text.ends_with(['.', ':']) && !text.contains('\t');
            if !is_kebab(id)
                || severities.is_empty()
                || severities.iter().collect::<BTreeSet<_>>().len() != severities.len()
            {
                wrong.push(format!("{id}: id or severities"));
            }
            if !whole(says) || says.contains('\n') || says.matches(". ").count() != 0 {
                wrong.push(format!("{id}: what it says is one sentence"));
            }
            if text.is_empty() || !text.lines().all(|line| line.is_empty() || whole(line)) {
                wrong.push(format!("{id}: its text has a sentence a line"));
            }
        }
    }
    fail_on(&wrong);
}

/// The page of all diagnostics.
fn page() -> String {
    let mut page = "# Diagnostics\n\n\
        Every error, warning and note of splinepost, by its id, the word in brackets: `error[knots-decrease]`.\n\
        `splinepost explain knots-decrease` prints the same on a terminal.\n\n\
        | severity | exit code | meaning |\n|---|---|---|\n\
        | error | 2 | the input, the usage or a file is wrong; nothing is written |\n\
        | error | 1 | the question was understood and the answer is no: it cannot be met, it differs; nothing is written |\n\
        | warning | 0 | the program is written; look at this before it runs |\n\
        | note | 0 | worth knowing |\n\n\
        This page is written from `src/diagnostic/registry/`.\n"
        .to_owned();
    for topic in registry::topics() {
        let _ = write!(page, "\n## {}\n", topic.title);
        if !topic.about.is_empty() {
            let _ = write!(page, "\n{}\n", topic.about);
        }
        for entry in &topic.entries {
            let severities: Vec<String> = entry
                .severities
                .iter()
                .map(|of| match registry::exit_code(*of) {
                    0 => registry::word(*of).to_owned(),
                    code => format!("{} with exit code {code}", registry::word(*of)),
                })
                .collect();
            let _ = write!(
                page,
                "\n### `{}`\n\n**{}**\n({})\n\n{}\n",
                entry.id,
                entry.says,
                severities.join(", "),
                entry.text
            );
        }
    }
    page
}

#[test]
fn the_page_is_written_from_the_registry() {
    let mut wrong = Vec::new();
    compare(&folder("docs/diagnostics.md"), &page(), &mut wrong);
    fail_on(&wrong);
}

/// Whether a text has a word in kebab case as a whole.
fn has_word(text: &str, word: &str) -> bool {
    let part = |c: char| c == '-' || c == '_' || c.is_ascii_alphanumeric();
    text.match_indices(word)
        .any(|(at, _)| !text[..at].ends_with(part) && !text[at + word.len()..].starts_with(part))
}

/// The texts of tests and fixtures that may show a diagnostic.
fn showing() -> BTreeMap<PathBuf, String> {
    let uncommented = |text: &str| {
        text.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n")
    };
    let mut texts = BTreeMap::new();
    for path in files(&folder("tests"), "rs") {
        if !path.ends_with("tests/diagnostics.rs") {
            texts.insert(path.clone(), uncommented(&source(&path)));
        }
    }
    for path in files(&folder("src"), "rs") {
        let text = source(&path);
        let test = if path.ends_with("tests.rs") {
            Some(&text[..])
        } else {
            text.split_once("#[cfg(test)]").map(|(_, test)| test)
        };
        if let Some(test) = test {
            texts.insert(path.clone(), uncommented(test));
        }
    }
    for path in files(&folder("fixtures"), "stderr").into_iter().chain([folder("README.md")]) {
        texts.insert(path.clone(), source(&path));
    }
    texts
}

#[test]
fn every_diagnostic_is_shown() {
    let texts = showing();
    let rows: String = source(&folder("tests/diagnostics/shown.rs")).split_whitespace().collect();
    let shows = |id: &str| {
        let message = format!("[{id}]");
        let literal = format!("(\"{id}\"");
        let literal = if BOTH.contains(&id) { literal } else { format!("\"{id}\"") };
        texts.values().any(|text| {
            let named = if id.contains('-') { has_word(text, id) } else { text.contains(&literal) };
            text.contains(&message) || (named && !BOTH.contains(&id))
        }) || (BOTH.contains(&id) && rows.contains(&literal))
    };
    let mut wrong = Vec::new();
    for entry in registry::all() {
        match (shows(entry.id), UNSHOWN.contains(&entry.id)) {
            (false, false) => wrong.push(format!("no test or fixture shows `{}`", entry.id)),
            (true, true) => wrong.push(format!("`{}` is shown: take it out of UNSHOWN", entry.id)),
            (true, false) | (false, true) => {}
        }
    }
    wrong.extend(
        UNSHOWN.iter().filter(|id| registry::find(id).is_none()).map(|id| format!("there is no `{id}`")),
    );
    fail_on(&wrong);
}
