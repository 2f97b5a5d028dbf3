//! TOML files with good manners: every unknown key is reported at its place, with the key that was meant.
//!
//! `serde` stops at the first surprise, so keys are walked first, on the parsed table; then the values go into a flat
//! struct of [`toml::Spanned`] fields.

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::{SourceId, Span};
use serde::de::DeserializeOwned;
use toml::de::{DeTable, DeValue};

/// A key and, where its value is a table, the keys of that.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// Its name.
    pub name: &'static str,
    /// The keys of its table; empty where the value is no table.
    pub inner: &'static [Key],
    /// Whether it is a table of tables with any names, `inner` being the keys of each.
    pub each: bool,
    /// Whether it is a list of tables, `inner` being the keys of each.
    pub list: bool,
}

impl Key {
    /// A key with a value.
    pub const fn value(name: &'static str) -> Key {
        Key { name, inner: &[], each: false, list: false }
    }

    /// A key with a table.
    pub const fn table(name: &'static str, inner: &'static [Key]) -> Key {
        Key { name, inner, each: false, list: false }
    }

    /// A key with a table of tables, each of any name and with the same keys.
    pub const fn each(name: &'static str, inner: &'static [Key]) -> Key {
        Key { name, inner, each: true, list: false }
    }

    /// A key with a list of tables, each with the same keys.
    pub const fn tables(name: &'static str, inner: &'static [Key]) -> Key {
        Key { name, inner, each: false, list: true }
    }
}

/// Reads a TOML text into `T`, after every key was checked against `keys`.
///
/// # Errors
/// The text is not TOML, a key is unknown or stands twice, a value is of another kind.
pub fn read<T: DeserializeOwned>(text: &str, source: SourceId, keys: &[Key]) -> Result<T, Diagnostics> {
    let table = DeTable::parse(text).map_err(|error| {
        let diagnostic = from_toml(&error, source);
        // TOML wants quotes round a key that is not plain ASCII.
        match text.lines().find(|line| line.trim_start().starts_with('Δ')) {
            Some(_) => diagnostic.hint("a Greek key stands in quotes: \"Δl\" = 0.2; `dl` is the same key"),
            None => diagnostic,
        }
    })?;
    let mut diagnostics = Diagnostics::new();
    walk(table.get_ref(), keys, "", source, &mut diagnostics);
    // In the order of the text, not of the alphabet.
    diagnostics.0.sort_by_key(|d| d.span.map_or(0, |span| span.start));
    diagnostics.into_result()?;
    let deserializer = toml::de::Deserializer::from(table);
    T::deserialize(deserializer).map_err(|error| from_toml(&error, source).into())
}

/// What the TOML library says, as a diagnostic.
fn from_toml(error: &toml::de::Error, source: SourceId) -> Diagnostic {
    let message = error.message().to_owned();
    let id = if message.contains("duplicate") {
        "key-repeated"
    } else if message.starts_with("invalid type") || message.starts_with("invalid value") {
        "value-kind"
    } else {
        "toml-syntax"
    };
    let mut phrase = message.lines().next().unwrap_or_default().to_owned();
    // In the user's words, not in Rust's.
    for (rust, plain) in [
        ("expected f64", "expected a number"),
        ("expected i64", "expected a whole number"),
        ("expected u8", "expected a small whole number"),
        ("expected u32", "expected a whole number"),
        ("expected usize", "expected a whole number"),
        ("expected struct", "expected a table"),
        ("expected a sequence", "expected a list"),
        ("expected a map", "expected a table"),
    ] {
        if let Some(at) = phrase.find(rust) {
            phrase.truncate(at);
            phrase.push_str(plain);
        }
    }
    let diagnostic = Diagnostic::error(id, phrase);
    match error.span() {
        Some(range) => diagnostic.at(Span::new(source, range), ""),
        None => diagnostic,
    }
}

fn walk(table: &DeTable<'_>, keys: &[Key], within: &str, source: SourceId, diagnostics: &mut Diagnostics) {
    for (key, value) in table {
        let name = key.get_ref().as_ref();
        let Some(known) = keys.iter().find(|known| known.name == name) else {
            let place = if within.is_empty() { "this file".to_owned() } else { format!("[{within}]") };
            let mut diagnostic =
                Diagnostic::error("key-unknown", format!("`{name}` is not a key of {place}"))
                    .at(Span::new(source, key.span()), "unknown key");
            diagnostic = match nearest(name, keys.iter().map(|key| key.name)) {
                Some(meant) => diagnostic.hint(format!("did you mean `{meant}`?")),
                None => {
                    let names: Vec<&str> = keys.iter().map(|key| key.name).collect();
                    diagnostic.hint(format!("the keys are {}", names.join(", ")))
                }
            };
            diagnostics.push(diagnostic);
            continue;
        };
        if known.list {
            list(value, known, source, diagnostics);
            continue;
        }
        if !known.inner.is_empty() && !value.get_ref().is_table() {
            diagnostics.push(
                Diagnostic::error("value-kind", format!("`{name}` is a table"))
                    .at(Span::new(source, value.span()), "not a table"),
            );
        }
        if let (DeValue::Table(inner), false) = (value.get_ref(), known.inner.is_empty()) {
            let path = if within.is_empty() { name.to_owned() } else { format!("{within}.{name}") };
            if !known.each {
                walk(inner, known.inner, &path, source, diagnostics);
                continue;
            }
            for (name, value) in inner {
                if let DeValue::Table(table) = value.get_ref() {
                    walk(table, known.inner, &format!("{path}.{}", name.get_ref()), source, diagnostics);
                }
            }
        }
    }
}

/// The tables of a list, each walked on its own.
fn list(value: &toml::Spanned<DeValue<'_>>, known: &Key, source: SourceId, diagnostics: &mut Diagnostics) {
    let name = known.name;
    let mut wrong = |place: std::ops::Range<usize>| {
        diagnostics.push(
            Diagnostic::error("value-kind", format!("`{name}` is a list of tables, each under [[{name}]]"))
                .at(Span::new(source, place), "not a list of tables"),
        );
    };
    let DeValue::Array(items) = value.get_ref() else { return wrong(value.span()) };
    if let Some(item) = items.iter().find(|item| !item.get_ref().is_table()) {
        return wrong(item.span());
    }
    for item in items {
        if let DeValue::Table(table) = item.get_ref() {
            walk(table, known.inner, &format!("[{name}]"), source, diagnostics);
        }
    }
}

/// The name that was probably meant: the same but for case, or few letters away.
pub fn nearest<'a>(name: &str, names: impl Iterator<Item = &'a str> + Clone) -> Option<&'a str> {
    if let Some(same) = names.clone().find(|known| known.eq_ignore_ascii_case(name)) {
        return Some(same);
    }
    names
        .map(|known| (strsim::damerau_levenshtein(&name.to_lowercase(), &known.to_lowercase()), known))
        .filter(|(distance, known)| *distance <= known.chars().count().max(2).div_ceil(3))
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, known)| known)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;

    #[derive(Deserialize, Debug)]
    struct File {
        cutter: Cutter,
    }

    #[derive(Deserialize, Debug)]
    struct Cutter {
        length: toml::Spanned<f64>,
    }

    const KEYS: &[Key] =
        &[Key::value("name"), Key::table("cutter", &[Key::value("length"), Key::value("flutes")])];

    #[test]
    fn every_unknown_key_is_reported_with_what_was_meant() {
        let text = "nmae = 1\n[cutter]\nlenght = 3\nzzzzzz = 1\n";
        let errors = read::<File>(text, SourceId::INPUT, KEYS).unwrap_err();
        let hints: Vec<&str> = errors.0.iter().map(|d| d.hints[0].as_str()).collect();
        assert_eq!(hints, ["did you mean `name`?", "did you mean `length`?", "the keys are length, flutes"]);
    }

    #[test]
    fn spans_reach_the_values() {
        let file: File = read("[cutter]\nlength = 30\n", SourceId::INPUT, KEYS).unwrap();
        assert_eq!((*file.cutter.length.get_ref(), file.cutter.length.span()), (30.0, 18..20));
    }

    #[test]
    fn repeated_keys_and_wrong_kinds_have_their_own_ids() {
        let id = |text: &str| read::<File>(text, SourceId::INPUT, KEYS).unwrap_err().0[0].id;
        assert_eq!(id("[cutter]\nlength = 1\nlength = 2\n"), "key-repeated");
        assert_eq!(id("[cutter]\nlength = \"1\"\n"), "value-kind");
        assert_eq!(id("[cutter\n"), "toml-syntax");
    }
}
