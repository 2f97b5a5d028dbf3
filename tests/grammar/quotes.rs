//! A function that reads a rule has its name and quotes it in its doc comment.

use super::ebnf::{Expr, Grammar, production};
use super::grammar;
use crate::support::folder;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Folders under `src/dialect` and the grammar that each one reads.
const FOLDERS: &[(&str, &str)] =
    &[("heidenhain", "heidenhain"), ("iso", "mazak"), ("sinumerik", "sinumerik")];

/// Doc comments and what each stands before.
fn documented(source: &str) -> Vec<(String, String)> {
    let (mut found, mut doc) = (Vec::new(), String::new());
    for line in source.lines().map(str::trim) {
        if let Some(text) = line.strip_prefix("///") {
            doc.push_str(text);
            doc.push(' ');
        } else if !line.starts_with("#[") {
            found.push((std::mem::take(&mut doc), line.to_owned()));
        }
    }
    found
}

/// The rules that a doc comment quotes: what stands in backticks and begins with a name and ` = `.
fn quoted(doc: &str) -> Vec<&str> {
    let is_rule = |text: &&str| {
        text.split_once(" = ").is_some_and(|(name, _)| {
            !name.is_empty() && name.bytes().all(|b| b.is_ascii_lowercase() || b == b'_')
        })
    };
    doc.split('`').skip(1).step_by(2).filter(is_rule).collect()
}

/// The name of a function, where a line begins one.
fn function(item: &str) -> Option<&str> {
    let start = item.find("fn ").filter(|at| *at == 0 || item[..*at].ends_with(' '))?;
    if !["", "pub ", "pub(super) ", "pub(crate) "].contains(&&item[..start]) {
        return None;
    }
    item[start + 3..].split(['(', '<']).next()
}

/// What is wrong with the quotes in a source file, and how many there are.
fn disagreements(source: &str, grammar: &Grammar) -> (Vec<String>, usize) {
    let mut wrong = Vec::new();
    let mut quotes = 0;
    for (doc, item) in documented(source) {
        let rules = quoted(&doc);
        let function = function(&item);
        let mut names = Vec::new();
        for rule in rules {
            quotes += 1;
            match production(rule) {
                Err(error) => wrong.push(format!("`{rule}` is no rule: {error}")),
                Ok((name, expr)) => {
                    match grammar.get(&name) {
                        None => wrong.push(format!("`{rule}` is not in the grammar")),
                        Some(known) if *known != expr => {
                            wrong.push(format!("`{rule}` is another rule in the grammar: {}", shown(known)));
                        }
                        Some(_) => {}
                    }
                    names.push(name);
                }
            }
        }
        match (function, names.first()) {
            (Some(function), Some(first)) if function != first => {
                wrong.push(format!("fn {function} quotes the rule {first}"));
            }
            (None, Some(first)) => wrong.push(format!("{first} is quoted, but not by a function: {item}")),
            // A parser with a rule's name quotes the rule.
            (Some(function), None)
                if quoted(&doc).is_empty() && item.contains("IResult") && grammar.get(function).is_some() =>
            {
                wrong.push(format!("fn {function} does not quote its rule"));
            }
            (Some(_) | None, Some(_) | None) => {}
        }
    }
    (wrong, quotes)
}

fn shown(expr: &Expr) -> String {
    let mut shown = format!("{expr:?}");
    shown.truncate(300);
    shown
}

fn sources(under: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(under).expect("a folder").flatten() {
        let path = entry.path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found
}

#[test]
fn every_function_quotes_its_rule() {
    let folders = fs::read_dir(folder("src/dialect")).expect("src/dialect").flatten();
    let folders: BTreeSet<String> = folders
        .filter(|entry| entry.path().is_dir())
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    assert_eq!(folders, FOLDERS.iter().map(|(folder, _)| (*folder).to_owned()).collect());
    let mut wrong = Vec::new();
    for (name, language) in FOLDERS {
        let grammar = grammar(language);
        let mut all = 0;
        for path in sources(&folder("src/dialect").join(name)) {
            let source = fs::read_to_string(&path).expect("UTF-8");
            let (own, quotes) = disagreements(&source, &grammar);
            wrong.extend(own.into_iter().map(|what| format!("{}: {what}", path.display())));
            all += quotes;
        }
        assert!(4 < all, "src/dialect/{name} quotes {all} rules only");
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_reader_of_cl_data_quotes_its_rules() {
    let grammar = grammar("apt");
    let path = folder("src/front/apt/statement.rs");
    let (wrong, quotes) = disagreements(&fs::read_to_string(path).expect("UTF-8"), &grammar);
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(8 < quotes, "{quotes} rules are quoted only");
}

#[test]
fn the_reader_of_step_quotes_its_rules() {
    let grammar = grammar("step");
    let path = folder("src/front/curves/step/text.rs");
    let (wrong, quotes) = disagreements(&fs::read_to_string(path).expect("UTF-8"), &grammar);
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(8 < quotes, "{quotes} rules are quoted only");
}

#[test]
fn a_wrong_quote_is_found() {
    let grammar = Grammar::parse("word = { blank }, \"K\" ; blank = \" \" ;").expect("a grammar");
    let wrong = |source: &str| disagreements(source, &grammar).0.len();
    let parser = "(input: &str) -> IResult<&str, Word<'_>> {";
    assert_eq!(
        wrong(&format!("/// `word = {{ blank }},\n/// \"K\"`, and more.\n#[inline]\nfn word{parser}")),
        0
    );
    for source in [
        format!("/// `word = {{ blank }}, \"L\"`\nfn word{parser}"),
        format!("/// `words = {{ blank }}, \"K\"`\nfn words{parser}"),
        format!("/// `word = {{ blank }}, \"K\"`\npub(super) fn other{parser}"),
        format!("/// `word = {{ blank`\nfn word{parser}"),
        format!("/// A word.\nfn word{parser}"),
        "/// `blank = \" \"`\nstruct Blank;".into(),
    ] {
        assert_eq!(wrong(&source), 1, "{source}");
    }
}
