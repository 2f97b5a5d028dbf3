//! Reads a grammar in the notation of ISO 14977: `rule = a, "b" | { c }, [ d ], 2 * e, f - g, ? words ? ; (* comment *)`.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

/// The right-hand side of a rule, or a part of it.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Expr {
    /// `"G1"`
    Terminal(String),
    /// The name of a rule.
    Rule(String),
    /// `? said in words ?`
    Special(String),
    /// `a, b`
    Sequence(Vec<Expr>),
    /// `a | b`
    Choice(Vec<Expr>),
    /// `[ a ]`
    Optional(Box<Expr>),
    /// `{ a }`
    Repeated(Box<Expr>),
    /// `4 * a`
    Times(usize, Box<Expr>),
    /// `a - b`: what is `a` and not `b`
    Except(Box<Expr>, Box<Expr>),
}

/// One rule.
pub(super) struct Rule {
    pub(super) name: String,
    pub(super) expr: Expr,
    /// The comment behind it, in the line where it ends.
    pub(super) comment: Option<String>,
}

/// The rules of a file in their order; the first is the root.
pub(super) struct Grammar {
    pub(super) rules: Vec<Rule>,
    by_name: BTreeMap<String, usize>,
}

impl Grammar {
    /// Reads a file.
    pub(super) fn parse(text: &str) -> Result<Grammar, String> {
        let mut parser = Parser { text, at: 0 };
        let mut grammar = Grammar { rules: Vec::new(), by_name: BTreeMap::new() };
        parser.skip()?;
        while !parser.rest().is_empty() {
            let (name, expr) = parser.production()?;
            parser.symbol(';')?;
            let line_end = parser.rest().find('\n').unwrap_or(parser.rest().len());
            let behind = parser.rest()[..line_end].trim();
            let comment = behind.strip_prefix("(*").and_then(|c| c.strip_suffix("*)"));
            let rule = Rule { name, expr, comment: comment.map(|c| c.trim().to_owned()) };
            if grammar.by_name.insert(rule.name.clone(), grammar.rules.len()).is_some() {
                return Err(format!("{} is defined twice", rule.name));
            }
            grammar.rules.push(rule);
            parser.skip()?;
        }
        if grammar.rules.is_empty() { Err("there is no rule".into()) } else { Ok(grammar) }
    }

    /// The right-hand side of a rule.
    pub(super) fn get(&self, name: &str) -> Option<&Expr> {
        self.by_name.get(name).map(|i| &self.rules[*i].expr)
    }

    /// The rule that is the whole.
    pub(super) fn root(&self) -> &str {
        &self.rules[0].name // `parse` refuses a file without rules
    }

    /// What keeps the grammar from being closed: a rule that is used and not defined, or that the root does not reach.
    pub(super) fn open_ends(&self) -> Vec<String> {
        let mut reached = BTreeSet::from([self.root()]);
        let mut todo = vec![self.root()];
        let mut wrong = Vec::new();
        while let Some(name) = todo.pop() {
            let Some(expr) = self.get(name) else {
                wrong.push(format!("{name} is not defined"));
                continue;
            };
            expr.each(&mut |part| {
                if let Expr::Rule(used) = part
                    && reached.insert(used)
                {
                    todo.push(used);
                }
            });
        }
        let unused = self.rules.iter().filter(|rule| !reached.contains(rule.name.as_str()));
        wrong.extend(unused.map(|rule| format!("{} is not used", rule.name)));
        wrong
    }
}

/// Reads one production, without `;` behind it.
pub(super) fn production(text: &str) -> Result<(String, Expr), String> {
    let mut parser = Parser { text, at: 0 };
    parser.skip()?;
    let production = parser.production()?;
    if parser.rest().is_empty() { Ok(production) } else { Err(parser.wrong("something behind the rule")) }
}

impl Expr {
    /// Calls `f` with every part, the whole first.
    pub(super) fn each<'e>(&'e self, f: &mut impl FnMut(&'e Expr)) {
        f(self);
        match self {
            Expr::Terminal(_) | Expr::Rule(_) | Expr::Special(_) => {}
            Expr::Sequence(parts) | Expr::Choice(parts) => {
                for part in parts {
                    part.each(f);
                }
            }
            Expr::Optional(part) | Expr::Repeated(part) | Expr::Times(_, part) => part.each(f),
            Expr::Except(part, but) => {
                part.each(f);
                but.each(f);
            }
        }
    }
}

struct Parser<'t> {
    text: &'t str,
    at: usize,
}

impl<'t> Parser<'t> {
    fn rest(&self) -> &'t str {
        &self.text[self.at..]
    }

    fn wrong(&self, what: &str) -> String {
        let line = 1 + self.text[..self.at].matches('\n').count();
        let mut message = format!("line {line}: {what}");
        if let Some(found) = self.rest().lines().next() {
            let _ = write!(message, " at `{found}`");
        }
        message
    }

    /// Passes over blanks and comments.
    fn skip(&mut self) -> Result<(), String> {
        loop {
            self.at += self.rest().len() - self.rest().trim_start().len();
            if !self.rest().starts_with("(*") {
                return Ok(());
            }
            let end = self.rest().find("*)").ok_or_else(|| self.wrong("a comment without its end"))?;
            self.at += end + 2;
        }
    }

    /// Takes a sign; what stands behind it is left as it is.
    fn symbol(&mut self, symbol: char) -> Result<(), String> {
        if !self.rest().starts_with(symbol) {
            return Err(self.wrong(&format!("`{symbol}` is missing")));
        }
        self.at += symbol.len_utf8();
        Ok(())
    }

    fn take(&mut self, fits: impl Fn(char) -> bool) -> &'t str {
        let rest = self.rest();
        let length = rest.find(|c: char| !fits(c)).unwrap_or(rest.len());
        self.at += length;
        &rest[..length]
    }

    fn name(&mut self) -> Result<String, String> {
        let name = self.take(|c| c.is_ascii_alphanumeric() || c == '_').to_owned();
        self.skip()?;
        if name.starts_with(|c: char| c.is_ascii_alphabetic()) {
            Ok(name)
        } else {
            Err(self.wrong("a name is missing"))
        }
    }

    fn production(&mut self) -> Result<(String, Expr), String> {
        let name = self.name()?;
        self.symbol('=')?;
        self.skip()?;
        Ok((name, self.choice()?))
    }

    fn choice(&mut self) -> Result<Expr, String> {
        self.listed('|', Expr::Choice, Parser::sequence)
    }

    fn sequence(&mut self) -> Result<Expr, String> {
        self.listed(',', Expr::Sequence, Parser::exception)
    }

    /// Parts with a sign between them; one part alone is itself.
    fn listed(
        &mut self,
        between: char,
        all: fn(Vec<Expr>) -> Expr,
        part: fn(&mut Self) -> Result<Expr, String>,
    ) -> Result<Expr, String> {
        let first = part(self)?;
        let mut parts = vec![first];
        while self.rest().starts_with(between) {
            self.symbol(between)?;
            self.skip()?;
            parts.push(part(self)?);
        }
        Ok(if parts.len() == 1 { parts.remove(0) } else { all(parts) })
    }

    fn exception(&mut self) -> Result<Expr, String> {
        let part = self.factor()?;
        if !self.rest().starts_with('-') {
            return Ok(part);
        }
        self.symbol('-')?;
        self.skip()?;
        Ok(Expr::Except(Box::new(part), Box::new(self.factor()?)))
    }

    fn factor(&mut self) -> Result<Expr, String> {
        let times = self.take(|c| c.is_ascii_digit());
        if times.is_empty() {
            return self.primary();
        }
        let times = times.parse().map_err(|_| self.wrong("too large a number"))?;
        self.skip()?;
        self.symbol('*')?;
        self.skip()?;
        Ok(Expr::Times(times, Box::new(self.primary()?)))
    }

    fn primary(&mut self) -> Result<Expr, String> {
        let first = self.rest().chars().next().ok_or_else(|| self.wrong("the text ends"))?;
        let expr = match first {
            '"' | '\'' => Expr::Terminal(self.quoted(first)?),
            '?' => Expr::Special(self.quoted(first)?.trim().to_owned()),
            '(' => self.bracketed('(', ')')?,
            '[' => Expr::Optional(Box::new(self.bracketed('[', ']')?)),
            '{' => Expr::Repeated(Box::new(self.bracketed('{', '}')?)),
            _ => return self.name().map(Expr::Rule),
        };
        self.skip()?;
        Ok(expr)
    }

    fn quoted(&mut self, mark: char) -> Result<String, String> {
        self.symbol(mark)?;
        let inner = self.take(|c| c != mark && c != '\n').to_owned();
        self.symbol(mark)?;
        Ok(inner)
    }

    fn bracketed(&mut self, open: char, close: char) -> Result<Expr, String> {
        self.symbol(open)?;
        self.skip()?;
        let inner = self.choice()?;
        self.symbol(close)?;
        Ok(inner)
    }
}

#[test]
fn the_notation_binds_as_the_standard_says() {
    let (name, expr) = production("a = \"x\", b - c | 2 * [ d ], { ? e ? } (* f *)").expect("a rule");
    let rule = |name: &str| Box::new(Expr::Rule(name.into()));
    let first = Expr::Sequence(vec![Expr::Terminal("x".into()), Expr::Except(rule("b"), rule("c"))]);
    let second = Expr::Sequence(vec![
        Expr::Times(2, Box::new(Expr::Optional(rule("d")))),
        Expr::Repeated(Box::new(Expr::Special("e".into()))),
    ]);
    assert_eq!((name.as_str(), expr), ("a", Expr::Choice(vec![first, second])));
}

#[test]
fn what_is_no_grammar_is_refused() {
    for text in [
        "",
        "a = b",
        "a = ;",
        "a = \"b ;",
        "a = ( b ;",
        "a = b c ;",
        "a = b ; a = b ;",
        "(* a = b ;",
        "= a ;",
    ] {
        assert!(Grammar::parse(text).is_err(), "{text}");
    }
}

#[test]
fn a_grammar_with_open_ends_is_told_so() {
    let grammar = Grammar::parse("a = b, { c } ; b = 'x' ; d = b ; e = f ; f = e ;").expect("a grammar");
    assert_eq!(grammar.open_ends(), ["c is not defined", "d is not used", "e is not used", "f is not used"]);
}
