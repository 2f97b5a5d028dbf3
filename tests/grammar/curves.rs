//! The readers of curve files against their grammars.

use super::generate::Generator;
use super::grammar;
use super::recognise::Recogniser;
use super::terms::Terms;
use crate::files::fixtures;
use splinepost::front::curves::{FORMATS, format_of, read, step};
use splinepost::source::{Source, SourceId};

/// What a reader says of a text that is not in the form at all.
const FORM: &[&str] = &[
    "group-code",
    "file-truncated",
    "section-unknown",
    "section-order",
    "step-header",
    "instance-unreadable",
];

#[test]
fn sentences_have_the_form_that_is_read() {
    for format in FORMATS {
        let (grammar, terms) = (grammar(format.grammar), Terms::plain());
        let recogniser = Recogniser { grammar: &grammar, terms: &terms };
        let mut generator = Generator::new(recogniser, 5, &["exponent"]);
        let mut read_whole = 0;
        for _ in 0..300 {
            let sentence = generator.sentence(grammar.root());
            let source = Source::new("sentence", sentence.as_str());
            let errors = read(&source, SourceId::INPUT, format, Some(1.0)).err().unwrap_or_default();
            let form = errors.0.iter().find(|d| FORM.contains(&d.id));
            assert!(form.is_none(), "{form:?}\n{sentence}");
            read_whole += usize::from(errors.0.is_empty());
        }
        let unmet: Vec<&str> = grammar.rules[1..]
            .iter()
            .map(|rule| rule.name.as_str())
            .filter(|name| !generator.met.contains(*name))
            .collect();
        assert!(unmet.is_empty(), "{}: no sentence has {unmet:?}", format.name);
        assert!(0 < read_whole || format.name != "STEP", "{}", format.name);
    }
}

#[test]
fn instances_are_read() {
    let (grammar, terms) = (grammar("step"), Terms::plain());
    let recogniser = Recogniser { grammar: &grammar, terms: &terms };
    let mut generator = Generator::new(recogniser, 7, &["exponent", "digits"]);
    for _ in 0..2000 {
        let sentence = generator.sentence("instance");
        assert!(step::instance(&sentence).is_ok_and(|(rest, _)| rest.is_empty()), "{sentence}");
    }
    let recogniser = Recogniser { grammar: &grammar, terms: &terms };
    for bad in
        ["#1=A(1,);", "#1=A(1", "#x=A();", "#1=(A(1)B);", "#1=A(.T);", "#1=A('a);", "#1=A(1.E);", "1=A();"]
    {
        assert!(!recogniser.recognises("instance", bad), "{bad}");
        assert!(step::instance(bad).is_err(), "{bad}");
    }
}

#[test]
fn fixtures_are_recognised() {
    let mut count = 0;
    for (name, text) in fixtures() {
        let format = format_of(&name).expect("a format");
        let (grammar, terms) = (grammar(format.grammar), Terms::plain());
        let recogniser = Recogniser { grammar: &grammar, terms: &terms };
        assert!(recogniser.recognises(grammar.root(), &text), "{name}");
        // A line less or a line more makes another text of it.
        let middle = text.match_indices('\n').nth(text.lines().count() / 2).map_or(0, |(at, _)| at);
        let damaged = format!("{}\n?{}", &text[..middle], &text[middle..]);
        assert!(!recogniser.recognises(grammar.root(), &damaged), "{name}");
        count += 1;
    }
    assert!(6 < count, "{count} files");
}
