//! Front ends: what a user writes becomes an [`Intent`].
//!
//! | module | input |
//! |---|---|
//! | [`cutter`] | a conical cutter as its drawing states it |

pub mod cutter;

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::ir::Intent;
use crate::source::{Source, SourceId, Sources, Span};

/// A language that programs are made from.
pub struct Language {
    /// Its name.
    pub name: &'static str,
    /// What it is, in one line.
    pub about: &'static str,
    /// Reads the input as what a program is to be made of.
    pub parse: fn(&Sources) -> Result<Intent, Diagnostics>,
    /// Whether a text looks like it.
    pub recognise: fn(&str) -> bool,
}

impl std::fmt::Debug for Language {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name)
    }
}

/// All languages.
pub const LANGUAGES: &[Language] = &[Language {
    name: "cutter",
    about: "TOML with a [cutter] table: D1, S, C, r, length",
    parse: |sources| {
        let input = sources.get(SourceId::INPUT).ok_or_else(Diagnostics::new)?;
        cutter::parse_program(input, SourceId::INPUT)
    },
    recognise: |text| {
        let text = text.trim_start_matches('\u{feff}');
        text.lines().any(|line| line.trim_start().starts_with("[cutter]"))
    },
}];

/// The language of a name.
pub fn find(name: &str) -> Option<&'static Language> {
    LANGUAGES.iter().find(|language| language.name == name)
}

/// The language of an input, by its text and, where that is not enough, its extension.
///
/// # Errors
/// No language or several fit.
pub fn detect(input: &Source) -> Result<&'static Language, Diagnostics> {
    let fitting: Vec<&Language> =
        LANGUAGES.iter().filter(|language| (language.recognise)(&input.text)).collect();
    if let [one] = fitting[..] {
        return find(one.name).ok_or_else(Diagnostics::new);
    }
    if fitting.is_empty()
        && std::path::Path::new(&input.name).extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"))
    {
        // Said to be TOML: the cutter reader knows best what is missing.
        return find("cutter").ok_or_else(Diagnostics::new);
    }
    let names: Vec<&str> = LANGUAGES.iter().map(|language| language.name).collect();
    let first = input.text.find('\n').unwrap_or(input.text.len()).min(80);
    Err(Diagnostic::error("language-unknown", "the input is in no language that is known")
        .at(Span::new(SourceId::INPUT, 0..first), "")
        .hint(format!("say which with --from; known are {}", names.join(", ")))
        .into())
}
