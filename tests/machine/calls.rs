//! Subprograms behind the end of the program: every call becomes the blocks that it runs.

use super::words::{Block, Flow, Word};
use super::{Rule, Violation};

/// The blocks in the order in which they run, and what is wrong with labels and calls.
pub(super) fn expand(blocks: &[Block]) -> (Vec<Block>, Vec<Violation>) {
    let finish = blocks.iter().position(|block| block.words.contains(&Word::Finish));
    let (main, behind) = blocks.split_at(finish.map_or(blocks.len(), |at| at + 1));
    let mut subprograms = Subprograms { behind, called: vec![false; behind.len()], violations: Vec::new() };
    let mut run = Vec::new();
    for block in main {
        match &block.flow {
            None => run.push(block.clone()),
            Some(Flow::Call(from, to)) => {
                let body = subprograms.body(block, from, to.as_deref());
                run.extend_from_slice(body);
            }
            Some(Flow::Label(_) | Flow::Return) => {
                subprograms.violation(block, "a subprogram begins or ends before the program does");
            }
        }
    }
    run.extend(subprograms.rest());
    (run, subprograms.violations)
}

struct Subprograms<'a> {
    /// What stands behind M30.
    behind: &'a [Block],
    called: Vec<bool>,
    violations: Vec<Violation>,
}

impl<'a> Subprograms<'a> {
    fn violation(&mut self, block: &Block, what: impl Into<String>) {
        self.violations.push(Violation { line: block.line, rule: Rule::Call, what: what.into() });
    }

    /// The blocks between a label and the return, or another label.
    fn body(&mut self, call: &Block, from: &str, to: Option<&str>) -> &'a [Block] {
        let is = |block: &Block, name: &str| matches!(&block.flow, Some(Flow::Label(label)) if label == name);
        let behind = self.behind;
        let starts: Vec<usize> = (0..behind.len()).filter(|at| is(&behind[*at], from)).collect();
        let [start] = starts[..] else {
            self.violation(call, format!("{} labels `{from}` stand behind the program", starts.len()));
            return &[];
        };
        let returns = |block: &Block| match to {
            Some(to) => is(block, to),
            None => block.flow == Some(Flow::Return),
        };
        let Some(length) = behind[start..].iter().position(returns) else {
            self.violation(call, format!("there is no return from `{from}`"));
            return &[];
        };
        self.called[start..=start + length].fill(true);
        let body = &behind[start + 1..start + length];
        if let Some(nested) = body.iter().find(|block| block.flow.is_some()) {
            self.violation(nested, "a call or a label inside a subprogram");
            return &[];
        }
        body
    }

    /// What stands behind the program and is no subprogram.
    fn rest(&mut self) -> Vec<Block> {
        let mut rest = Vec::new();
        let mut inside = false;
        for (at, block) in self.behind.iter().enumerate() {
            match &block.flow {
                _ if self.called[at] => inside = false,
                Some(Flow::Label(label)) => {
                    self.violation(block, format!("`{label}` is never called"));
                    inside = true;
                }
                Some(Flow::Return) if inside => inside = false,
                Some(Flow::Return) => self.violation(block, "a return from nothing"),
                // One violation is enough for a body that nobody calls.
                None if inside && !block.words.iter().any(|word| matches!(word, Word::Close(_))) => {}
                Some(Flow::Call(..)) if inside => {}
                Some(Flow::Call(..)) => self.violation(block, "a call behind the end"),
                None => rest.push(block.clone()),
            }
        }
        rest
    }
}
