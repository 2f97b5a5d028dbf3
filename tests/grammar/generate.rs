//! Sentences of a grammar, the same in every run.

use super::ebnf::{Expr, Grammar};
use super::recognise::Recogniser;
use std::collections::{BTreeMap, BTreeSet};

/// Numbers that look random: splitmix64.
pub(super) struct Random(pub(super) u64);

impl Random {
    /// A number below `bound`, which is not zero.
    pub(super) fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.0;
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ (x >> 31)) % bound as u64) as usize
    }

    /// One of several.
    pub(super) fn pick<'a, T>(&mut self, all: &'a [T]) -> Option<&'a T> {
        if all.is_empty() { None } else { all.get(self.below(all.len())) }
    }
}

/// How often `{ }` is repeated at most.
const REPEATS: usize = 3;

/// How deep rules are nested before the shortest way out is taken.
const DEPTH: usize = 12;

/// Makes sentences.
pub(super) struct Generator<'g> {
    recogniser: Recogniser<'g>,
    random: Random,
    /// How long the way out of a rule is.
    heights: BTreeMap<&'g str, usize>,
    /// Rules whose `{ }` are left out.
    short: &'g [&'g str],
    /// The rules met so far.
    pub(super) met: BTreeSet<String>,
}

impl<'g> Generator<'g> {
    /// Sentences of a grammar; within the rules of `short` nothing is repeated.
    pub(super) fn new(recogniser: Recogniser<'g>, seed: u64, short: &'g [&'g str]) -> Generator<'g> {
        let heights = heights(recogniser.grammar);
        Generator { recogniser, random: Random(seed), heights, short, met: BTreeSet::new() }
    }

    /// A sentence of a rule.
    pub(super) fn sentence(&mut self, rule: &str) -> String {
        let mut out = String::new();
        self.rule(rule, 0, REPEATS, &mut out);
        out
    }

    fn rule(&mut self, name: &str, depth: usize, repeats: usize, out: &mut String) {
        self.met.insert(name.to_owned());
        let grammar = self.recogniser.grammar;
        let rule = grammar.get(name).unwrap_or_else(|| panic!("{name} is not defined"));
        self.expr(rule, depth + 1, if self.short.contains(&name) { 0 } else { repeats }, out);
    }

    fn expr(&mut self, expr: &Expr, depth: usize, repeats: usize, out: &mut String) {
        let deep = DEPTH < depth;
        match expr {
            Expr::Terminal(word) => out.push_str(word),
            Expr::Rule(name) => self.rule(name, depth, repeats, out),
            Expr::Special(words) => {
                let sample = self.recogniser.terms.sample(words, &mut self.random);
                out.push_str(&sample.unwrap_or_else(|| panic!("there is nothing that is {words}")));
            }
            Expr::Sequence(parts) => {
                for part in parts {
                    self.expr(part, depth, repeats, out);
                }
            }
            Expr::Choice(parts) => {
                let one = if deep {
                    parts.iter().min_by_key(|part| height(part, &self.heights))
                } else {
                    self.random.pick(parts)
                };
                self.expr(one.expect("a choice has parts"), depth, repeats, out);
            }
            Expr::Optional(part) => {
                if !deep && self.random.below(2) == 0 {
                    self.expr(part, depth, repeats, out);
                }
            }
            Expr::Repeated(part) => {
                let times = if deep { 0 } else { self.random.below(repeats + 1) };
                for _ in 0..times {
                    self.expr(part, depth, repeats, out);
                }
            }
            Expr::Times(times, part) => {
                for _ in 0..*times {
                    self.expr(part, depth, repeats, out);
                }
            }
            Expr::Except(part, but) => {
                for _ in 0..100 {
                    let mut sample = String::new();
                    self.expr(part, depth, repeats, &mut sample);
                    if !self.recogniser.fits(but, &sample) {
                        return out.push_str(&sample);
                    }
                }
                panic!("hardly anything is {part:?} and not {but:?}");
            }
        }
    }
}

/// How many rules the shortest way out of each rule goes through.
fn heights(grammar: &Grammar) -> BTreeMap<&str, usize> {
    let mut heights = BTreeMap::new();
    // Each round settles at least one rule more.
    for _ in &grammar.rules {
        for rule in &grammar.rules {
            let own = height(&rule.expr, &heights).saturating_add(1);
            heights.insert(rule.name.as_str(), own);
        }
    }
    heights
}

fn height(expr: &Expr, heights: &BTreeMap<&str, usize>) -> usize {
    match expr {
        Expr::Terminal(_) | Expr::Special(_) | Expr::Optional(_) | Expr::Repeated(_) => 0,
        Expr::Rule(name) => heights.get(name.as_str()).copied().unwrap_or(usize::MAX),
        Expr::Sequence(parts) => parts.iter().map(|part| height(part, heights)).max().unwrap_or(0),
        Expr::Choice(parts) => parts.iter().map(|part| height(part, heights)).min().unwrap_or(0),
        Expr::Times(_, part) | Expr::Except(part, _) => height(part, heights),
    }
}

#[test]
fn sentences_are_those_of_the_grammar_and_end() {
    let text =
        "all = 'a', { 'b' }, 2 * [ digit - '0' ], ( 'c' | '(', all, ')', [ all ] ) ; digit = ? 0 to 9 ? ;";
    let grammar = Grammar::parse(text).expect("a grammar");
    let terms = super::terms::Terms::plain();
    let recogniser = || Recogniser { grammar: &grammar, terms: &terms };
    let mut different = BTreeSet::new();
    for seed in 0..100 {
        let sentence = Generator::new(recogniser(), seed, &[]).sentence("all");
        assert!(recogniser().recognises("all", &sentence), "{sentence}");
        assert_eq!(sentence, Generator::new(recogniser(), seed, &[]).sentence("all"));
        assert!(!Generator::new(recogniser(), seed, &["all"]).sentence("all").contains('b'));
        different.insert(sentence);
    }
    assert!(50 < different.len(), "{different:?}");
}
