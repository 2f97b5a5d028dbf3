//! Front ends: what a user writes becomes an [`Intent`].
//!
//! | module | input |
//! |---|---|
//! | [`apt`] | CL data of CATIA, NX, Creo, SolidWorks CAM, Fusion |
//! | [`cutter`] | a conical cutter as its drawing states it |
//! | [`job`] | curves, with feed and tool |
//! | [`curves`] | the curve files that jobs name: DXF, IGES, STEP |
//!
//! `clear` holds retractions to be clear of what is cut.

pub mod apt;
mod clear;
pub mod curves;
pub mod cutter;
pub mod job;

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
    /// Reads the input as far as it goes: without feed and retract there is a path, but no program.
    pub understand: fn(&Sources) -> Result<Intent, Diagnostics>,
    /// The files that an input names, as it names them; whoever calls the library loads them ([`Sources::name`]).
    pub files: fn(&Source) -> Vec<String>,
    /// Whether a text looks like it.
    pub recognise: fn(&str) -> bool,
    /// Whether a text that is not UTF-8 is read as Windows-1252.
    pub windows_1252: bool,
    /// Its grammar, in `grammar/`.
    pub grammar: &'static str,
}

impl std::fmt::Debug for Language {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name)
    }
}

/// All languages.
pub const LANGUAGES: &[Language] = &[
    Language {
        name: "cutter",
        about: "TOML with a [cutter] table: D1, S, C, r, length",
        parse: |sources| cutter::parse_program(input(sources)?, SourceId::INPUT),
        understand: |sources| cutter::parse(input(sources)?, SourceId::INPUT).map(|job| job.intent()),
        files: no_files,
        recognise: |text| has_table(text, &["[cutter]"]),
        windows_1252: false,
        grammar: "cutter",
    },
    Language {
        name: "job",
        about: "TOML with [[curve]] tables: NURBS, Bezier curves, polynomials, points, expressions, curve files",
        parse: |sources| job::parse_program(sources, SourceId::INPUT),
        understand: |sources| job::parse(sources, SourceId::INPUT).map(|job| job.intent()),
        files: job::named,
        recognise: |text| has_table(text, &["[[curve]]", "[curve]"]),
        windows_1252: false,
        grammar: "job",
    },
    Language {
        name: "apt",
        about: "CL data of the CAM system that it looks like",
        parse: apt::parse,
        understand: apt::parse,
        files: no_files,
        recognise: apt::recognise,
        windows_1252: true,
        grammar: "apt",
    },
    cl_data("catia", "CL data of CATIA V5, 3DEXPERIENCE or Mastercam", |sources| {
        apt::parse_as(sources, Some("catia"))
    }),
    cl_data("creo", "CL data of Creo", |sources| apt::parse_as(sources, Some("creo"))),
    cl_data("nx", "CL data of NX", |sources| apt::parse_as(sources, Some("nx"))),
    cl_data("solidworks", "CL data of SolidWorks CAM", |sources| apt::parse_as(sources, Some("solidworks"))),
    cl_data("fusion", "CL data of Fusion or hyperMILL", |sources| apt::parse_as(sources, Some("fusion"))),
    cl_data("iso", "CL data after ISO 3592 and 4343", |sources| apt::parse_as(sources, Some("iso"))),
];

fn input(sources: &Sources) -> Result<&Source, Diagnostics> {
    sources.get(SourceId::INPUT).ok_or_else(Diagnostics::new)
}

fn no_files(_: &Source) -> Vec<String> {
    Vec::new()
}

/// Whether a line of the text begins one of these tables.
fn has_table(text: &str, tables: &[&str]) -> bool {
    let text = text.trim_start_matches('\u{feff}');
    memchr::memchr_iter(b'[', text.as_bytes()).any(|at| {
        let (before, behind) = text.split_at(at);
        tables.iter().any(|table| behind.starts_with(table))
            && before.trim_end_matches([' ', '\t']).chars().next_back().is_none_or(|c| c == '\n')
    })
}

/// CL data of one CAM system; its text is recognised as `apt`, which finds the system.
const fn cl_data(
    name: &'static str,
    about: &'static str,
    parse: fn(&Sources) -> Result<Intent, Diagnostics>,
) -> Language {
    Language {
        name,
        about,
        parse,
        understand: parse,
        files: no_files,
        recognise: |_| false,
        windows_1252: true,
        grammar: "apt",
    }
}

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
    if let Some(format) = curves::format_of(&input.name) {
        let message = format!("a {} file has curves, but no feed, tool and place to retract to", format.name);
        let name = std::path::Path::new(&input.name).file_name().and_then(|name| name.to_str());
        return Err(Diagnostic::error("curve-file-alone", message)
            .at(Span::new(SourceId::INPUT, 0..0), "")
            .hint(format!(
                "write a job that has them and names the file: [[curve]] file = \"{}\"",
                name.unwrap_or_default()
            ))
            .into());
    }
    let names: Vec<&str> = LANGUAGES.iter().map(|language| language.name).collect();
    let first = input.text.find('\n').unwrap_or(input.text.len()).min(80);
    Err(Diagnostic::error("language-unknown", "the input is in no language that is known")
        .at(Span::new(SourceId::INPUT, 0..first), "")
        .hint(format!("say which with --from; known are {}", names.join(", ")))
        .into())
}
