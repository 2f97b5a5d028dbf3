//! CL data: APT as CAM systems write it, after ISO 3592 and ISO 4343.
//!
//! ```text
//! PARTNO POCKET
//! UNITS/MM
//! LOADTL/1
//! SPINDL/RPM,9000,CLW
//! RAPID
//! GOTO/0.0,0.0,2.0
//! FEDRAT/400.0,MMPM
//! GOTO/0.0,0.0,-1.5
//! CIRCLE/0.0,5.0,-1.5,0.0,0.0,1.0,5.0
//! GOTO/5.0,5.0,-1.5
//! FINI
//! ```
//!
//! There is no one such language: ISO gives words, and every CAM system writes a dialect. Two layers read them all, and a
//! third knows the system:
//!
//! | module | what |
//! |---|---|
//! | `records` | lines become statements and remarks; `$` joins lines; every byte keeps its place |
//! | `statement` | a statement is a major word and arguments |
//! | `words` | what a word means, as data |
//! | `reader` | what statements mean, one after the other: modes end here |
//! | `technology`, `tools`, `motion`, `arcs`, `points`, `tangents`, `cycles`, `splines`, `directions`, `remarks` | its parts |
//! | `systems` | one file a CAM system: how it is recognised, and what it does differently |
//! | `program` | moves become the steps of a program |
//! | `running` | whether a tool, the spindle and the coolant are there where something is cut |
//!
//! Positions stand in the frame that the file states; the frame is written down in a remark and never applied.
//! A word that is not understood is an error, or with `lenient` a warning; nothing is dropped in silence.

mod arcs;
mod cycles;
mod directions;
mod motion;
mod points;
mod program;
mod reader;
mod records;
mod remarks;
mod running;
mod splines;
mod statement;
mod systems;
mod tangents;
mod technology;
mod tools;
mod words;

pub use words::KEYS;

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::ir::Intent;
use crate::source::{Encoding, SourceId, Sources, Span};
use systems::System;

/// How much of a text is looked at to see what wrote it.
const HEAD: usize = 1 << 16;

/// Whether a text looks like CL data: one of its first statements is one that all systems write.
pub fn recognise(text: &str) -> bool {
    let head = head(text);
    let words = words::Words::built_in("iso");
    records::Records::new(head).filter(|record| record.kind == records::Kind::Code).take(20).any(|record| {
        record.text.split(['/', ',', '(']).next().is_some_and(|major| {
            major.trim().len() < record.text.len().min(30) && words.meaning(major.trim()).is_some()
                || ["RAPID", "FINI", "END", "NURBS"].contains(&record.text.trim())
        })
    }) || systems::ALL.iter().any(|system| (system.recognise)(&systems::Head::new(head)))
}

/// The beginning of a text.
fn head(text: &str) -> &str {
    let mut end = text.len().min(HEAD);
    while !text.is_char_boundary(end) {
        end -= 1;
    }
    &text[..end]
}

/// Reads CL data of any system.
///
/// # Errors
/// Whatever keeps a program from being made of it.
pub fn parse(sources: &Sources) -> Result<Intent, Diagnostics> {
    parse_as(sources, None)
}

/// Reads CL data of the CAM system of this name, or of the one that it looks like.
///
/// # Errors
/// Whatever keeps a program from being made of it.
pub fn parse_as(sources: &Sources, system: Option<&str>) -> Result<Intent, Diagnostics> {
    let input = sources.get(SourceId::INPUT).ok_or_else(Diagnostics::new)?;
    let text = input.text.as_str();
    let system: &'static System = match system.and_then(systems::find) {
        Some(system) => system,
        None => systems::detect(head(text)),
    };
    let mut words = words::Words::built_in(system.words);
    if let Some((id, table)) = sources.words.and_then(|id| Some((id, sources.get(id)?))) {
        words.add(&table.text, id)?;
    }
    let mut reader = reader::Reader::new(SourceId::INPUT, system, words, sources.lenient);
    if let Some(unit) = sources.units {
        (reader.scale, reader.unit_told) = (unit, true);
    }
    if input.encoding == Encoding::Windows1252 {
        let at = text.find(|c: char| !c.is_ascii()).unwrap_or(0);
        let width = text[at..].chars().next().map_or(0, char::len_utf8);
        reader.diagnostics.push(
            Diagnostic::warning("text-windows-1252", "the text is not UTF-8; it is read as Windows-1252")
                .at(Span::new(SourceId::INPUT, at..at + width), "the first such character"),
        );
    }
    reader.read(text)
}
