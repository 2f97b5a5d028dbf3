//! Whether a text is a sentence of a grammar.
//!
//! Each part of a rule is given a place and answers with all the places where it can end, so that nothing has to be
//! tried again and no order of alternatives matters. A rule must not begin with itself.

use super::ebnf::{Expr, Grammar};
use super::terms::Terms;
use std::collections::BTreeSet;

/// A grammar and what its words in question marks mean.
pub(super) struct Recogniser<'g> {
    pub(super) grammar: &'g Grammar,
    pub(super) terms: &'g Terms,
}

type Ends = BTreeSet<usize>;

impl Recogniser<'_> {
    /// Whether the whole text is a sentence of a rule.
    pub(super) fn recognises(&self, rule: &str, text: &str) -> bool {
        self.fits(&Expr::Rule(rule.to_owned()), text)
    }

    /// Whether the whole text is a sentence of an expression.
    pub(super) fn fits(&self, expr: &Expr, text: &str) -> bool {
        self.ends(expr, text, 0).contains(&text.len())
    }

    fn ends(&self, expr: &Expr, text: &str, at: usize) -> Ends {
        match expr {
            Expr::Terminal(word) if text[at..].starts_with(word) => Ends::from([at + word.len()]),
            Expr::Terminal(_) => Ends::new(),
            Expr::Rule(name) => self.grammar.get(name).map_or(Ends::new(), |rule| self.ends(rule, text, at)),
            Expr::Special(words) => self.terms.lengths(words, &text[at..]).iter().map(|l| at + l).collect(),
            Expr::Sequence(parts) => {
                parts.iter().fold(Ends::from([at]), |from, part| self.all(part, text, &from))
            }
            Expr::Choice(parts) => parts.iter().flat_map(|part| self.ends(part, text, at)).collect(),
            Expr::Optional(part) => {
                let mut ends = self.ends(part, text, at);
                ends.insert(at);
                ends
            }
            Expr::Repeated(part) => {
                let (mut ends, mut todo) = (Ends::from([at]), vec![at]);
                while let Some(from) = todo.pop() {
                    todo.extend(self.ends(part, text, from).into_iter().filter(|end| ends.insert(*end)));
                }
                ends
            }
            Expr::Times(times, part) => {
                (0..*times).fold(Ends::from([at]), |from, _| self.all(part, text, &from))
            }
            Expr::Except(part, but) => {
                let mut ends = self.ends(part, text, at);
                if !ends.is_empty() {
                    let not = self.ends(but, text, at);
                    ends.retain(|end| !not.contains(end));
                }
                ends
            }
        }
    }

    fn all(&self, part: &Expr, text: &str, from: &Ends) -> Ends {
        from.iter().flat_map(|at| self.ends(part, text, *at)).collect()
    }
}

#[test]
fn every_kind_of_expression() {
    let grammar = Grammar::parse(
        "all = 'a', [ 'b' ], { 'c' }, 2 * [ 'd' ], ( digit - '0' | deep ) ; digit = ? 0 to 9 ? ; deep = '(', all, ')' ;",
    )
    .expect("a grammar");
    let terms = Terms::plain();
    let recogniser = Recogniser { grammar: &grammar, terms: &terms };
    for text in ["a1", "ab9", "acccd5", "abdd1", "a(a(ab7))"] {
        assert!(recogniser.recognises("all", text), "{text}");
    }
    for text in ["", "a", "a0", "abb1", "addd1", "b1", "a11", "a(a1", "a1)"] {
        assert!(!recogniser.recognises("all", text), "{text}");
    }
}
