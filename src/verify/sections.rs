//! The remarks at which a program can be restarted.
//!
//! Each remark of an intent starts a section: a flute, a pass, an operation, a tool. An operator looks for it and starts there,
//! so that one too many is as wrong as a move. Their text, order and place are those that were asked: each stands right
//! before the step that it was asked before, and nowhere else is there a remark that could be taken for one of them, the same words with
//! whatever numbers, or for one of another program: `FLUTE 1 OF 4`. All other remarks are free.

use super::Cursor;
use crate::diagnostic::Diagnostics;
use crate::ir::{Intent, Located, Step};
use crate::machine::Machine;
use crate::machine::remark::wrapped;
use std::collections::BTreeSet;

/// What remarks begin with that programs are restarted at, whether this one has such or not.
const RESTARTS: [&str; 8] =
    ["FLUTE #", "ROUGH #", "FINISH", "SPARK-OUT", "PASS #", "PATH #", "TOOL #", "OPERATION #"];

/// Whether an operator could take a remark for a place to start at, by its gist.
fn is_restart(gist: &str) -> bool {
    let ends = |rest: &str| rest.chars().next().is_none_or(|c| !c.is_alphanumeric());
    RESTARTS.iter().any(|words| gist.strip_prefix(words).is_some_and(ends))
}

/// The remarks that start a section, as they are told from others.
pub(super) struct Sections(BTreeSet<String>);

/// What two remarks have in common that an operator could take for each other: letters of either case, with one blank between
/// words and one sign for each number.
fn gist(remark: &str) -> String {
    let mut gist = String::with_capacity(remark.len());
    for word in remark.split_whitespace() {
        if !gist.is_empty() {
            gist.push(' ');
        }
        for letter in word.chars() {
            if !letter.is_ascii_digit() {
                gist.extend(letter.to_uppercase());
            } else if !gist.ends_with('#') {
                gist.push('#');
            }
        }
    }
    gist
}

impl Sections {
    /// Those of an intent, as the machine's text has them.
    pub(super) fn of(intent: &Intent, machine: &Machine) -> Sections {
        let mut all = BTreeSet::new();
        for located in &intent.program.steps {
            match &located.step {
                Step::Comment(text) => all.extend(wrapped(text, machine).iter().map(|line| gist(line))),
                Step::Tool(_)
                | Step::Spindle(_)
                | Step::Coolant
                | Step::Home(_)
                | Step::Shift(_)
                | Step::Auxiliary(_)
                | Step::Rapid(_)
                | Step::Cut(_) => {}
            }
        }
        Sections(all)
    }
}

impl<'p> Cursor<'p> {
    /// The remark that comes next.
    fn remark(&self) -> Option<&'p str> {
        match self.step() {
            Some(Located { step: Step::Comment(text), .. }) => Some(text),
            Some(_) | None => None,
        }
    }

    /// Passes a remark that starts no section.
    fn pass_remark(&mut self, read: &str) -> Result<(), Diagnostics> {
        let gist = gist(read);
        if self.sections.0.contains(&gist) || is_restart(&gist) {
            let message = format!("no section starts with the remark `{read}` here");
            return Err(self.differs("section-differs", message));
        }
        self.at += 1;
        Ok(())
    }

    /// Passes the remarks that come next; none of them starts a section.
    pub(super) fn skip_remarks(&mut self) -> Result<(), Diagnostics> {
        while let Some(read) = self.remark() {
            self.pass_remark(read)?;
        }
        Ok(())
    }

    /// Meets a remark that starts a section; free ones may stand before it.
    pub(super) fn section(&mut self, asked: &str) -> Result<(), Diagnostics> {
        if let Some((read, rest)) = self.leading.split_first()
            && read == asked
        {
            self.leading = rest;
            return Ok(());
        }
        while let Some(read) = self.remark() {
            if read == asked && self.within == 0 {
                self.at += 1;
                return Ok(());
            }
            self.pass_remark(read)?;
        }
        Err(self.differs("section-differs", format!("expected the remark `{asked}` here")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn remarks_that_could_be_taken_for_each_other_are_alike() {
        assert_eq!(gist("FLUTE 2 OF 6, A 97.25"), "FLUTE # OF #, A #.#");
        assert_eq!(gist("flute  12 of 6, A 0.5"), gist("FLUTE 2 OF 6, A 97.25"));
        assert_ne!(gist("FLUTE 2 OF 6"), gist("PASS 2 OF 6"));
        assert_ne!(gist("FLUTE 2"), gist("SEE FLUTE 2"));
    }

    #[test]
    fn remarks_of_other_programs_may_be_taken_for_a_start() {
        for remark in ["FLUTE 1 OF 4, A 0", "flute 3", "FINISH", "SPARK-OUT", "TOOL 5", "PASS 2: ROUGH"] {
            assert!(is_restart(&gist(remark)), "{remark}");
        }
        for remark in
            ["FLUTES 4", "FINISHED 12:00", "TOOL AXIS: 0 TO 5", "SEE FLUTE 2", "TOOLS", "PATH LENGTH"]
        {
            assert!(!is_restart(&gist(remark)), "{remark}");
        }
    }
}
