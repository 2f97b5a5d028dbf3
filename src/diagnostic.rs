//! Everything a user is told: errors, warnings and notes, with a place in a text.
//!
//! One struct serves all: severity, a stable kebab-case id, a message that stands on its own, a span with a label,
//! and hints that say what to do. [`Diagnostics::render`] draws them in the style of rustc, [`Diagnostics::to_json`]
//! gives a line each for scripts:
//!
//! ```json
//! {"severity":"error","id":"key-unknown","message":"…","file":"input.toml","line":3,"column":1,
//!  "end_line":3,"end_column":5,"label":"…","hints":["…"]}
//! ```
//!
//! What each id means stands in the [`registry`], and `splinepost explain ID` prints it.
//!
//! Columns count characters from 1; `file` to `label` are null where a diagnostic has no place. Where more than one place belongs
//! to it, as in two programs that differ, `others` has them: `[{"file":"b.h","line":7,…,"label":"…"}]`.

pub mod registry;

use crate::source::{LineColumn, Sources, Span};
use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
use serde::Serialize;

/// How bad it is, and with which code the program ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// Worth knowing.
    Note,
    /// The job is done, but look here. Exit 0.
    Warning,
    /// The question was understood and the answer is no: it differs, it cannot be met. Exit 1.
    #[serde(rename = "error")]
    Refusal,
    /// The input, the usage or a file is wrong. Exit 2.
    Error,
}

/// Places and what is there.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Others(pub Vec<(Span, String)>);

/// One thing to tell.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostic {
    /// How bad it is.
    pub severity: Severity,
    /// Its stable name: `knots-decrease`.
    pub id: &'static str,
    /// One phrase, lower case, no full stop, understood on its own.
    pub message: String,
    /// Where.
    pub span: Option<Span>,
    /// What is there; may be shorter than the message, since it points.
    pub label: String,
    /// Other places that belong to it, in any text, and what is there; most have none, and a result is no larger for it.
    pub others: Option<Box<Others>>,
    /// What to do.
    pub hints: Vec<String>,
}

impl Diagnostic {
    fn new(severity: Severity, id: &'static str, message: impl Into<String>) -> Diagnostic {
        debug_assert!(
            registry::find(id).is_some_and(|entry| entry.severities.contains(&severity)),
            "`{id}` is not in the registry as {severity:?}"
        );
        Diagnostic {
            severity,
            id,
            message: message.into(),
            span: None,
            label: String::new(),
            others: None,
            hints: Vec::new(),
        }
    }

    /// Something in the input is wrong.
    pub fn error(id: &'static str, message: impl Into<String>) -> Diagnostic {
        Diagnostic::new(Severity::Error, id, message)
    }

    /// The answer is no.
    pub fn refusal(id: &'static str, message: impl Into<String>) -> Diagnostic {
        Diagnostic::new(Severity::Refusal, id, message)
    }

    /// Done, but look here.
    pub fn warning(id: &'static str, message: impl Into<String>) -> Diagnostic {
        Diagnostic::new(Severity::Warning, id, message)
    }

    /// Worth knowing.
    pub fn note(id: &'static str, message: impl Into<String>) -> Diagnostic {
        Diagnostic::new(Severity::Note, id, message)
    }

    /// Points at a place.
    #[must_use]
    pub fn at(mut self, span: Span, label: impl Into<String>) -> Diagnostic {
        self.span = Some(span);
        self.label = label.into();
        self
    }

    /// Points at another place too.
    #[must_use]
    pub fn and_at(mut self, span: Span, label: impl Into<String>) -> Diagnostic {
        self.others.get_or_insert_default().0.push((span, label.into()));
        self
    }

    /// The other places.
    pub fn others(&self) -> impl Iterator<Item = &(Span, String)> {
        self.others.iter().flat_map(|others| &others.0)
    }

    /// Adds a way out.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Diagnostic {
        self.hints.push(hint.into());
        self
    }
}

/// Several things to tell, in order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Diagnostics(pub Vec<Diagnostic>);

impl From<Diagnostic> for Diagnostics {
    fn from(diagnostic: Diagnostic) -> Diagnostics {
        Diagnostics(vec![diagnostic])
    }
}

/// A value and the warnings that travel with it.
#[derive(Clone, Debug)]
pub struct Warned<T> {
    /// The value.
    pub value: T,
    /// What to know about it.
    pub warnings: Diagnostics,
}

#[derive(Serialize)]
struct JsonLine<'a> {
    severity: Severity,
    id: &'a str,
    message: &'a str,
    file: Option<&'a str>,
    line: Option<usize>,
    column: Option<usize>,
    end_line: Option<usize>,
    end_column: Option<usize>,
    label: Option<&'a str>,
    hints: &'a [String],
    #[serde(skip_serializing_if = "Vec::is_empty")]
    others: Vec<JsonPlace<'a>>,
}

#[derive(Serialize)]
struct JsonPlace<'a> {
    file: &'a str,
    line: usize,
    column: usize,
    end_line: usize,
    end_column: usize,
    label: &'a str,
}

impl Diagnostics {
    /// Nothing to tell.
    pub fn new() -> Diagnostics {
        Diagnostics::default()
    }

    /// Adds one.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        self.0.push(diagnostic);
    }

    /// Adds all of another.
    pub fn extend(&mut self, other: Diagnostics) {
        self.0.extend(other.0);
    }

    /// The worst severity; a note where there is nothing.
    pub fn worst(&self) -> Severity {
        self.0.iter().map(|d| d.severity).max().unwrap_or(Severity::Note)
    }

    /// Whether one of them stops the job.
    pub fn has_errors(&self) -> bool {
        Severity::Refusal <= self.worst()
    }

    /// Itself as an error where it has one, otherwise as warnings.
    ///
    /// # Errors
    /// One of them stops the job.
    pub fn into_result(self) -> Result<Diagnostics, Diagnostics> {
        if self.has_errors() { Err(self) } else { Ok(self) }
    }

    /// Draws them in the style of rustc.
    pub fn render(&self, sources: &Sources, color: bool) -> String {
        let renderer = if color { Renderer::styled() } else { Renderer::plain() };
        let mut text = String::new();
        for diagnostic in &self.0 {
            let level = match diagnostic.severity {
                Severity::Error | Severity::Refusal => Level::ERROR,
                Severity::Warning => Level::WARNING,
                Severity::Note => Level::NOTE,
            };
            let mut group = annotate_snippets::Group::with_title(
                level.primary_title(diagnostic.message.as_str()).id(diagnostic.id),
            );
            let first = diagnostic.span.map(|span| (span, &diagnostic.label));
            let others = diagnostic.others().map(|(span, label)| (*span, label));
            for (i, (span, label)) in first.into_iter().chain(others).enumerate() {
                let Some(source) = sources.get(span.source) else { continue };
                let (window, first_line, range) = window(&source.text, span);
                // A carriage return would be drawn; a blank in its place moves nothing.
                let window = window.replace('\r', " ");
                let kind = if i == 0 { AnnotationKind::Primary } else { AnnotationKind::Context };
                let mut annotation = kind.span(range);
                if !label.is_empty() {
                    annotation = annotation.label(label.as_str());
                }
                group = group.element(
                    Snippet::source(window)
                        .line_start(first_line)
                        .path(source.name.as_str())
                        .annotation(annotation),
                );
            }
            for hint in &diagnostic.hints {
                group = group.element(Level::HELP.message(hint.as_str()));
            }
            text.push_str(&renderer.render(&[group]));
            text.push('\n');
        }
        text
    }

    /// One JSON object a line, as the module's documentation shows.
    pub fn to_json(&self, sources: &Sources) -> String {
        let mut text = String::new();
        for diagnostic in &self.0 {
            let place = diagnostic.span.and_then(|s| Some((s, sources.get(s.source)?)));
            let start = place.map(|(span, source)| LineColumn::of(&source.text, span.start as usize));
            let end = place.map(|(span, source)| LineColumn::of(&source.text, span.end as usize));
            let line = JsonLine {
                severity: diagnostic.severity,
                id: diagnostic.id,
                message: &diagnostic.message,
                file: place.map(|(_, source)| source.name.as_str()),
                line: start.map(|at| at.line),
                column: start.map(|at| at.column),
                end_line: end.map(|at| at.line),
                end_column: end.map(|at| at.column),
                label: place.map(|_| diagnostic.label.as_str()),
                hints: &diagnostic.hints,
                others: diagnostic
                    .others()
                    .filter_map(|(span, label)| json_place(*span, label, sources))
                    .collect(),
            };
            text.push_str(&serde_json::to_string(&line).unwrap_or_default());
            text.push('\n');
        }
        text
    }
}

fn json_place<'a>(span: Span, label: &'a str, sources: &'a Sources) -> Option<JsonPlace<'a>> {
    let source = sources.get(span.source)?;
    let start = LineColumn::of(&source.text, span.start as usize);
    let end = LineColumn::of(&source.text, span.end as usize);
    Some(JsonPlace {
        file: &source.name,
        line: start.line,
        column: start.column,
        end_line: end.line,
        end_column: end.column,
        label,
    })
}

/// The lines around a span, so that a gigabyte is not scanned for one message; a line longer than any screen is cut.
fn window(text: &str, span: Span) -> (&str, usize, std::ops::Range<usize>) {
    const LONGEST: usize = 2000;
    let boundary = |mut at: usize| {
        at = at.min(text.len());
        while !text.is_char_boundary(at) {
            at -= 1;
        }
        at
    };
    let (start, end) = (boundary(span.start as usize), boundary(span.end.max(span.start) as usize));
    let mut from = text[..start].rfind('\n').map_or(0, |i| i + 1);
    let mut to = text[end..].find('\n').map_or(text.len(), |i| end + i);
    if LONGEST < start - from {
        from = boundary(start - LONGEST / 2);
    }
    if LONGEST < to - start {
        to = boundary(start + LONGEST).max(boundary(start));
    }
    let line = text[..from].bytes().filter(|b| *b == b'\n').count() + 1;
    (&text[from..to], line, start - from..end.min(to) - from)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::{Source, SourceId};

    fn sample() -> (Sources, Diagnostics) {
        let sources = Sources::new(Source::new("part.toml", "[cutter]\nD2 = 10\n"));
        let span = Span::new(SourceId::INPUT, 9..11);
        let diagnostic = Diagnostic::error("key-unknown", "`D2` is not a key of [cutter]")
            .at(span, "unknown key")
            .hint("did you mean `D1`?");
        (sources, diagnostic.into())
    }

    #[test]
    fn renders_message_place_and_hint() {
        let (sources, diagnostics) = sample();
        let text = diagnostics.render(&sources, false);
        for part in
            ["error[key-unknown]: `D2` is not a key", "--> part.toml:2:1", "^^ unknown key", "did you mean"]
        {
            assert!(text.contains(part), "{text}");
        }
    }

    #[test]
    fn json_is_one_line_each() {
        let (sources, diagnostics) = sample();
        assert_eq!(
            diagnostics.to_json(&sources),
            "{\"severity\":\"error\",\"id\":\"key-unknown\",\"message\":\"`D2` is not a key of [cutter]\",\
             \"file\":\"part.toml\",\"line\":2,\"column\":1,\"end_line\":2,\"end_column\":3,\
             \"label\":\"unknown key\",\"hints\":[\"did you mean `D1`?\"]}\n"
        );
    }

    #[test]
    fn a_span_past_the_end_does_no_harm() {
        let (sources, mut diagnostics) = sample();
        diagnostics.0[0].span = Some(Span::new(SourceId::INPUT, 500..600));
        assert!(diagnostics.render(&sources, false).contains("part.toml"));
    }
}
