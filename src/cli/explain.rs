//! `splinepost explain`: what a diagnostic means.

use super::io::{self, Console};
use clap::ValueEnum;
use splinepost::diagnostic::registry::{self, Entry};
use splinepost::diagnostic::{Diagnostic, Diagnostics};

/// Print what a diagnostic means and what to do, or list all diagnostics
#[derive(clap::Args, Debug)]
pub(crate) struct Explain {
    /// Its id, as it stands in brackets in the message: knots-decrease
    id: Option<String>,
    /// How it is printed
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

/// How diagnostics are explained.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// For people
    Text,
    /// One JSON object a line
    Json,
}

impl Explain {
    /// Runs it.
    pub(crate) fn run(&self, _console: &Console) -> Result<(), Diagnostics> {
        let text = match (&self.id, self.format) {
            (Some(id), Format::Text) => found(id)?.explained(),
            (Some(id), Format::Json) => found(id)?.to_json(),
            (None, Format::Text) => registry::list(),
            (None, Format::Json) => registry::all().iter().map(|entry| entry.to_json()).collect(),
        };
        io::print(&text)
    }
}

/// The entry of an id, which may come with the word and the brackets of its message: `error[knots-decrease]`.
fn found(given: &str) -> Result<&'static Entry, Diagnostics> {
    let inner = given.rsplit_once('[').map_or(given, |(_, id)| id).trim_end_matches([':', ']']);
    let id = inner.to_ascii_lowercase();
    registry::find(&id).ok_or_else(|| {
        let error = Diagnostic::error("diagnostic-unknown", format!("there is no diagnostic `{inner}`"));
        let near: Vec<String> = registry::nearest(&id).iter().map(|id| format!("`{id}`")).collect();
        let error =
            if near.is_empty() { error } else { error.hint(format!("did you mean {}?", near.join(" or "))) };
        error.hint("`splinepost explain` lists all of them").into()
    })
}
