//! `grammar/*.ebnf` is a contract: closed, quoted by the functions that read, in step with readers, writers and keys.
//!
//! | module | what |
//! |---|---|
//! | `ebnf` | reads a grammar |
//! | `terms` | what it says in words |
//! | `recognise` | whether a text is a sentence |
//! | `generate` | sentences |
//! | `apt` | CL data: its reader against its grammar |
//! | `curves` | curve files: their readers against their grammars |
//! | `dialects` | readers read what the grammar has, writers write nothing else |
//! | `quotes` | functions quote their rules |
//! | `keys` | TOML inputs: the keys and kinds of the code |

mod apt;
mod curves;
mod dialects;
mod ebnf;
mod generate;
mod keys;
mod quotes;
mod recognise;
mod terms;

use crate::support::folder;
use ebnf::{Expr, Grammar};
use splinepost::dialect::DIALECTS;
use std::collections::BTreeSet;
use std::fs;

/// The grammar of a language.
fn grammar(name: &str) -> Grammar {
    let path = folder("grammar").join(format!("{name}.ebnf"));
    let text = fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    Grammar::parse(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

#[test]
fn every_language_has_a_grammar_and_every_grammar_a_language() {
    let found: BTreeSet<String> = fs::read_dir(folder("grammar"))
        .expect("grammar/")
        .flatten()
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    let languages = splinepost::front::LANGUAGES.iter().map(|language| language.grammar);
    let formats = splinepost::front::curves::FORMATS.iter().map(|format| format.grammar);
    let names =
        DIALECTS.iter().map(|dialect| dialect.name).chain(languages).chain(formats).chain(["machine"]);
    assert_eq!(found, names.map(|name| format!("{name}.ebnf")).collect());
}

#[test]
fn every_grammar_is_closed() {
    let mut wrong = Vec::new();
    for entry in fs::read_dir(folder("grammar")).expect("grammar/").flatten() {
        let file = entry.file_name().to_string_lossy().into_owned();
        let grammar = grammar(file.trim_end_matches(".ebnf"));
        wrong.extend(grammar.open_ends().into_iter().map(|what| format!("{file}: {what}")));
        for rule in &grammar.rules {
            rule.expr.each(&mut |part| {
                if let Expr::Special(words) = part
                    && !terms::Terms::knows(words)
                {
                    wrong.push(format!("{file}: nobody knows what ? {words} ? is"));
                }
            });
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
