//! The reader of CL data against its grammar.

use super::generate::Generator;
use super::grammar;
use super::recognise::Recogniser;
use super::terms::Terms;
use crate::apt::{inputs, joined};
use crate::support::sources;
use splinepost::front;

/// Whether a text is unreadable, whatever it means.
fn unreadable(text: &str) -> bool {
    let language = front::find("apt").expect("CL data");
    match (language.parse)(&sources(text)) {
        Ok(_) => false,
        Err(errors) => errors.0.iter().any(|d| d.id == "statement-unreadable"),
    }
}

#[test]
fn sentences_are_read() {
    let (grammar, terms) = (grammar("apt"), Terms::plain());
    let recogniser = Recogniser { grammar: &grammar, terms: &terms };
    let mut generator = Generator::new(recogniser, 3, &["exponent"]);
    for _ in 0..2000 {
        let line = generator.sentence("line");
        assert!(!unreadable(&line), "{line:?} is in the grammar");
    }
    let unmet: Vec<&str> = grammar.rules[1..]
        .iter()
        .map(|rule| rule.name.as_str())
        .filter(|name| !generator.met.contains(*name))
        .collect();
    assert!(unmet.is_empty(), "no line has {unmet:?}");
}

#[test]
fn what_is_not_in_the_grammar_is_not_read() {
    let (grammar, terms) = (grammar("apt"), Terms::plain());
    let recogniser = Recogniser { grammar: &grammar, terms: &terms };
    for line in
        ["/1", "GOTO/1 2", "GOTO/1,2)", "A/(B/1", "A/'b", "A=1", "1A", "A/1.2.3", "A/X=1=2", "A/(1))", "#"]
    {
        assert!(!recogniser.recognises("line", line), "{line}");
        assert!(unreadable(line), "{line}");
    }
}

#[test]
fn fixtures_are_recognised() {
    let (grammar, terms) = (grammar("apt"), Terms::plain());
    let recogniser = Recogniser { grammar: &grammar, terms: &terms };
    let mut count = 0;
    for (name, text) in inputs() {
        for line in joined(&text).lines() {
            assert!(recogniser.recognises("line", line), "{name}: {line}");
            count += 1;
        }
    }
    assert!(100 < count, "{count} lines");
}
