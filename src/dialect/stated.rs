//! What a program states beside its moves: the work offset that its places count from, and how exactly the control runs.
//!
//! Neither is a step of the program, and neither may be lost: two programs that count from G54 and from G55 cut in two places, and
//! `G61.1` or `G5 P2` rounds the same corners in another way.

use crate::source::Span;

/// The work offset of a program: `G54`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WorkOffset {
    /// Its word.
    pub word: String,
    /// Where it stands.
    pub span: Span,
    /// Whether it is the machine file's, and not the program's own.
    pub fixed: bool,
}

/// A word that says how exactly the control runs a path, and moves none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Running {
    /// The word.
    pub word: String,
    /// Where it stands.
    pub span: Span,
}

/// What was stated so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stated {
    /// The work offset in force.
    pub offset: Option<WorkOffset>,
    /// The words of the program's own that changed how the control runs.
    pub running: Vec<Running>,
    /// What is in force of each kind, where it is not what a control starts with.
    in_force: Vec<(&'static str, String)>,
}

impl Stated {
    /// Meets a word of how the control runs, of a kind that starts with `usual`. One that changes nothing says nothing; the
    /// machine file's own are its own affair.
    pub fn runs(&mut self, usual: &'static str, word: &str, span: Span, fixed: bool) {
        let known = self.in_force.iter().position(|(kind, _)| *kind == usual);
        if known.map_or(usual, |at| self.in_force[at].1.as_str()) == word {
            return;
        }
        match known {
            Some(at) => word.clone_into(&mut self.in_force[at].1),
            None => self.in_force.push((usual, word.to_owned())),
        }
        if !fixed {
            self.running.push(Running { word: word.to_owned(), span });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::SourceId;

    #[test]
    fn a_word_that_changes_nothing_says_nothing() {
        let mut stated = Stated::default();
        let span = Span::new(SourceId::INPUT, 0..1);
        for (word, fixed) in [
            ("G64", false),
            ("G61.1", true),
            ("G61.1", false),
            ("G64", false),
            ("G64", false),
            ("G61", false),
        ] {
            stated.runs("G64", word, span, fixed);
        }
        let words: Vec<&str> = stated.running.iter().map(|running| running.word.as_str()).collect();
        assert_eq!(words, ["G64", "G61"]);
    }
}
