//! The TOML inputs: a grammar has the keys of the code and no others, with values of the kinds that the code takes.

use super::ebnf::{Expr, Grammar};
use super::generate::Generator;
use super::grammar;
use super::recognise::Recogniser;
use super::terms::Terms;
use splinepost::diagnostic::Diagnostics;
use splinepost::machine::Machine;
use splinepost::source::{Source, SourceId};
use splinepost::tables::Key;
use std::collections::{BTreeMap, BTreeSet};

/// `process.retract.to`, `axis.*.kind`: the keys of a table of code that hold values.
fn of_code(keys: &[Key], within: &str, out: &mut BTreeSet<String>) {
    for key in keys {
        if key.list {
            of_code(key.inner, &format!("{within}[{}].", key.name), out);
            continue;
        }
        let path = format!("{within}{}", key.name);
        match (key.inner, key.each) {
            ([], _) => _ = out.insert(path),
            (inner, true) => of_code(inner, &format!("{path}.*."), out),
            (inner, false) => of_code(inner, &format!("{path}."), out),
        }
    }
}

/// The same keys as a grammar has them, each with the name of its rule.
fn of_grammar(grammar: &Grammar) -> BTreeMap<String, String> {
    let mut out = BTreeMap::new();
    visit(grammar, &Expr::Rule(grammar.root().to_owned()), "", "", &mut out);
    out
}

/// A sequence that begins with `"[table]"` begins that table; one that begins with `"key", "="` is a key, and one more
/// level where its value holds keys.
fn visit(grammar: &Grammar, expr: &Expr, within: &str, rule: &str, out: &mut BTreeMap<String, String>) {
    match expr {
        Expr::Rule(name) => {
            if let Some(expr) = grammar.get(name) {
                visit(grammar, expr, within, name, out);
            }
        }
        Expr::Sequence(parts) => match &parts[..] {
            [Expr::Terminal(table), rest @ ..] if 1 < table.len() && table.starts_with('[') => {
                let path = match table[1..].strip_suffix(']') {
                    Some(path) => format!("{path}."),
                    None => format!("{}*.", &table[1..]), // `"[axis.", name, "]"`
                };
                for part in rest {
                    visit(grammar, part, &path, rule, out);
                }
            }
            [Expr::Terminal(key), Expr::Terminal(is), rest @ ..] if is == "=" => {
                // TOML has quotes round a key of other letters than English ones.
                let path = format!("{within}{}", key.trim_matches('"'));
                let before = out.len();
                for part in rest {
                    visit(grammar, part, &format!("{path}."), rule, out);
                }
                if out.len() == before {
                    assert_eq!(out.insert(path, rule.to_owned()), None, "{within}{key} stands twice");
                }
            }
            parts => parts.iter().for_each(|part| visit(grammar, part, within, rule, out)),
        },
        Expr::Choice(parts) => parts.iter().for_each(|part| visit(grammar, part, within, rule, out)),
        Expr::Optional(part) | Expr::Repeated(part) | Expr::Times(_, part) | Expr::Except(part, _) => {
            visit(grammar, part, within, rule, out);
        }
        Expr::Terminal(_) | Expr::Special(_) => {}
    }
}

/// Keys that only one of the two has.
fn differences(grammar: &Grammar, keys: &[Key]) -> Vec<String> {
    let mut code = BTreeSet::new();
    of_code(keys, "", &mut code);
    let written: BTreeSet<String> = of_grammar(grammar).into_keys().collect();
    let missing = code.difference(&written).map(|key| format!("{key} is in the code only"));
    missing.chain(written.difference(&code).map(|key| format!("{key} is in the grammar only"))).collect()
}

/// A language, its keys, what its reader says of a text, and what stands before a key that is tried alone.
type Language = (&'static str, &'static [Key], fn(&str) -> Option<Diagnostics>, &'static str);

const LANGUAGES: &[Language] = &[
    (
        "cutter",
        splinepost::front::cutter::KEYS,
        |text| splinepost::front::cutter::parse(&Source::new("input.toml", text), SourceId::INPUT).err(),
        "",
    ),
    (
        "job",
        splinepost::front::job::KEYS,
        |text| splinepost::front::job::parse(&crate::support::sources(text), SourceId::INPUT).err(),
        "",
    ),
    (
        "machine",
        splinepost::machine::KEYS,
        |text| Machine::parse(text, SourceId::INPUT).err(),
        "extends = \"sinumerik\"\n",
    ),
];

#[test]
fn keys_are_those_of_the_code() {
    for (name, keys, ..) in LANGUAGES {
        let differences = differences(&grammar(name), keys);
        assert!(differences.is_empty(), "{name}: {}", differences.join("\n"));
    }
}

#[test]
fn a_key_on_one_side_only_is_found() {
    const KEYS: &[Key] =
        &[Key::value("a"), Key::table("t", &[Key::value("b")]), Key::each("u", &[Key::value("c")])];
    let same = "f = { a | t | u } ; a = 'a', '=', '1' ; t = '[t]', { b } ; b = 'b', '=', '1' ; u = '[u.', 'X', ']', { c } ; c = 'c', '=', '1' ;";
    let found = |from: &str, to: &str| {
        differences(&Grammar::parse(&same.replace(from, to)).expect("a grammar"), KEYS)
    };
    assert_eq!(found("", ""), [""; 0]);
    assert_eq!(found("{ b }", "'x'"), ["t.b is in the code only"]);
    assert_eq!(found("'c', '='", "'d', '='"), ["u.*.c is in the code only", "u.*.d is in the grammar only"]);
    assert_eq!(found("'[t]'", "'[s]'"), ["t.b is in the code only", "s.b is in the grammar only"]);
}

#[test]
fn every_key_has_unit_default_and_meaning() {
    for (name, ..) in LANGUAGES {
        let grammar = grammar(name);
        for (key, rule) in of_grammar(&grammar) {
            let rule = grammar.rules.iter().find(|known| known.name == rule).expect("its rule");
            let comment = rule.comment.as_deref().unwrap_or_default();
            let parts: Vec<&str> = comment.splitn(3, "; ").collect();
            let sound = matches!(parts[..], [unit, left_out, meaning] if !unit.is_empty() && !meaning.is_empty()
                && ["required", "default ", "optional"].iter().any(|word| left_out.starts_with(word)));
            assert!(sound, "{name}: {key} has `{comment}`, not unit; default; meaning");
        }
    }
}

/// Values of each kind that a key may have, and the kind's name.
const KINDS: &[(&str, &str)] = &[
    ("whole number", "3"),
    ("fraction", "3.5"),
    ("text", "\"x\""),
    ("boolean", "true"),
    ("list of whole numbers", "[3]"),
    ("list of fractions", "[3.5]"),
    ("list of texts", "[\"X\"]"),
    ("table", "{}"),
    ("list of lists", "[[3.5]]"),
];

/// The kind of a value, from how it begins; none of a list without items.
fn kind(value: &str) -> Option<&'static str> {
    let number = |text: &str| usize::from(text.contains('.'));
    let at = match value.as_bytes() {
        [b'[', b']'] => return None,
        [b'[', b'"', ..] => 6,
        [b'[', b'[', ..] => 8,
        [b'[', ..] => 4 + number(value),
        [b'"', ..] => 2,
        [b't' | b'f', ..] => 3,
        [b'{', ..] => 7,
        _ => number(value),
    };
    Some(KINDS[at].0)
}

#[test]
fn values_are_of_the_kinds_that_the_code_takes() {
    for (name, _, errors, before) in LANGUAGES {
        let grammar = grammar(name);
        let terms = Terms::plain();
        for (key, rule) in of_grammar(&grammar) {
            let (table, key) = key.rsplit_once('.').unwrap_or(("", &key));
            let table =
                if table.is_empty() { String::new() } else { format!("[{}]\n", table.replace('*', "A")) };
            let refused = |value: &str| {
                let key = if key.is_ascii() { key.to_owned() } else { format!("\"{key}\"") };
                let before = if key == "extends" { "" } else { before };
                let text = format!("{before}{table}{key} = {value}\n");
                let errors = errors(&text).map_or(Vec::new(), |errors| errors.0);
                errors.into_iter().find(|d| ["value-kind", "toml-syntax", "key-unknown"].contains(&d.id))
            };
            let taken: BTreeSet<&str> =
                KINDS.iter().filter(|(_, value)| refused(value).is_none()).map(|(kind, _)| *kind).collect();
            let recogniser = Recogniser { grammar: &grammar, terms: &terms };
            let mut generator = Generator::new(recogniser, 1, &[]);
            let mut written = BTreeSet::new();
            for _ in 0..60 {
                let sentence = generator.sentence(&rule);
                let (_, value) = sentence.split_once('=').expect("a key and its value");
                written.extend(kind(value));
                // Whole numbers below zero and large ones are questions of range.
                if let Some(error) =
                    refused(value).filter(|_| taken.contains(kind(value).unwrap_or_default()))
                {
                    assert!(error.message.contains("invalid value"), "{name}: {table}{sentence}: {error:?}");
                }
            }
            assert_eq!(written, taken, "{name}: {table}{key}: in the grammar, and in the code");
        }
    }
}
