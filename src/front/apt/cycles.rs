//! Drilling cycles, expanded into moves: every control does the same then, and the proof covers it.
//!
//! With the point P of a `GOTO`, CLEAR (or RAPTO) c above it and DEPTH (or FEDTO) d below it, both along the tool:
//!
//! ```text
//! DRILL CSINK FACE SPDRL   rapid over P to P + c; feed to P − d; dwell; rapid to P + c, or to RTRCTO
//! DEEP                     rapid over P to P + c; then for k = 1, 2, … feed to P − k·STEP, at most P − d; rapid to P + c;
//!                          rapid to c above where it was
//! REAM                     as DRILL, but back at feed
//! ```
//!
//! A rapid over P never goes down before it is over P, and never goes across before it is up.

use super::program::UPRIGHT;
use super::reader::{Reader, Said};
use super::statement::Argument;
use super::technology::Feed;
use crate::diagnostic::Diagnostic;
use crate::ir::Auxiliary;
use crate::source::Span;

/// The most pecks of one hole.
const MAX_PECKS: f64 = 1000.0;

/// What a cycle does at each point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Drill,
    Deep,
    Ream,
    /// Refused: its points are passed over, since one report is enough.
    Refused,
}

/// A cycle in force.
#[derive(Clone, Debug)]
pub(super) struct Cycle {
    kind: Kind,
    /// mm below the point.
    depth: f64,
    /// mm above the point.
    clear: f64,
    /// mm above the point, where it retracts to.
    retract: f64,
    step: f64,
    /// Seconds.
    dwell: f64,
    feed: Option<Feed>,
    line: u32,
}

impl Cycle {
    const REFUSED: Cycle = Cycle {
        kind: Kind::Refused,
        depth: 0.0,
        clear: 0.0,
        retract: 0.0,
        step: 0.0,
        dwell: 0.0,
        feed: None,
        line: 0,
    };
}

/// What the arguments of a cycle state, in units of the file.
#[derive(Default)]
struct Stated {
    depth: Option<f64>,
    clear: Option<f64>,
    retract: Option<f64>,
    step: Option<f64>,
    dwell: Option<f64>,
    feed: Option<Feed>,
}

impl Reader<'_> {
    /// `CYCLE/type,args | OFF | ON | INIT | CLEAR`
    pub(super) fn cycle(&mut self, said: &Said<'_>) {
        let kind = said.first_word().to_ascii_uppercase();
        self.cycle = Some(Cycle::REFUSED);
        let kind = match kind.as_str() {
            "OFF" | "CLEAR" | "ON" if said.arguments().len() != 1 => {
                let message = format!("CYCLE/{kind} stands alone");
                return self.error("arguments", message, said.span);
            }
            "OFF" | "CLEAR" => {
                self.cycle = None;
                return;
            }
            "ON" => {
                self.cycle = self.last_cycle.clone();
                if self.cycle.is_none() {
                    self.error("cycle-unknown", "CYCLE/ON without a cycle before it", said.span);
                }
                return;
            }
            "DRILL" | "CSINK" | "FACE" | "SPDRL" => Kind::Drill,
            "DEEP" => Kind::Deep,
            "REAM" => Kind::Ream,
            "TAP" => {
                let message = "CYCLE/TAP: tapping needs the spindle to follow the feed, which no move says";
                return self.refuse("cycle", message, said.span);
            }
            _ => {
                let message = format!("CYCLE/{kind} is not compiled; DRILL, DEEP, CSINK, FACE and REAM are");
                return self.refuse("cycle", message, said.span);
            }
        };
        let Some(stated) = self.stated(said) else { return };
        let Some(depth) = stated.depth.map(|d| d.abs() * self.scale).filter(|d| 0.0 < *d && d.is_finite())
        else {
            self.push(Diagnostic::error("cycle-depth", "the cycle states no depth").at(said.span, "").hint(
                "DEPTH or FEDTO states one; a number without a word needs its place in [cycles] of --words",
            ));
            return;
        };
        let Some(clear) = stated.clear.map(|c| c * self.scale).filter(|c| 0.0 <= *c && c.is_finite()) else {
            return self.error("cycle-clear", "the cycle states no CLEAR or RAPTO to begin from", said.span);
        };
        if kind == Kind::Deep && clear == 0.0 {
            let message =
                "with a CLEAR of 0 each stroke would start at rapid on the bottom of the one before";
            return self.error("cycle-clear", message, said.span);
        }
        if clear == 0.0 {
            let message = "with a CLEAR of 0 the tool goes at rapid as far as the point itself";
            self.push(Diagnostic::warning("cycle-clear", message).at(said.span, ""));
        }
        let retract = stated.retract.map(|r| r * self.scale);
        if retract.is_some_and(|r| r < clear) {
            let message =
                format!("RTRCTO is below the {clear} mm from which the cycle begins: it retracts to there");
            self.push(Diagnostic::warning("cycle-retract", message).at(said.span, ""));
        }
        if (kind == Kind::Deep) != stated.step.is_some() {
            let message = match kind {
                Kind::Deep => "DEEP drills in steps, and no STEP says how deep",
                Kind::Drill | Kind::Ream | Kind::Refused => {
                    "STEP is of DEEP; this cycle drills in one stroke"
                }
            };
            return self.error("cycle-step", message, said.span);
        }
        let step = stated.step.map_or(depth, |step| step * self.scale);
        if kind == Kind::Deep && !(0.0 < step && depth / step <= MAX_PECKS) {
            let message = format!("STEP must be greater than zero and make at most {MAX_PECKS} pecks");
            return self.error("cycle-step", message, said.span);
        }
        self.cycle = Some(Cycle {
            kind,
            depth,
            clear,
            retract: retract.map_or(clear, |r| r.max(clear)),
            step,
            dwell: stated.dwell.unwrap_or(0.0),
            feed: stated.feed,
            line: said.record.line,
        });
        self.last_cycle.clone_from(&self.cycle);
        let text = format!("{} AS MOVES", said.record.text.replace('/', " "));
        self.carry(&text, said.span);
    }

    /// What the arguments say, by their words or their places.
    fn stated(&mut self, said: &Said<'_>) -> Option<Stated> {
        let mut stated = Stated::default();
        let mut word: Option<String> = None;
        let kind = said.first_word();
        let order: Vec<String> = self.words.cycle(kind).to_vec();
        let mut order = order.into_iter();
        for placed in said.arguments().iter().skip(1) {
            match placed.argument {
                Argument::Word(next) => {
                    let next = next.to_ascii_uppercase();
                    match word.take() {
                        Some(before) if before == "RTRCTO" && (next == "AUTO" || next == "MANUAL") => {}
                        Some(before) => {
                            let message = format!("{before} of a cycle has no number");
                            self.error("arguments", message, said.place(placed));
                            return None;
                        }
                        None if next == "MANUAL" => {}
                        None => word = Some(next),
                    }
                }
                Argument::Number(x) => {
                    let Some(name) = word.take().or_else(|| order.next()) else {
                        let place = said.place(placed);
                        self.push(
                            Diagnostic::error("cycle-number", "nothing says what this number of the cycle is")
                                .at(place, "")
                                .hint(format!("its place can be stated in a table for --words: [cycles] {kind} = [\"DEPTH\", …]")),
                        );
                        return None;
                    };
                    let twice = match name.as_str() {
                        "DEPTH" | "FEDTO" => stated.depth.replace(x).is_some(),
                        "CLEAR" | "RAPTO" => stated.clear.replace(x).is_some(),
                        "RTRCTO" => stated.retract.replace(x).is_some(),
                        "STEP" | "INCR" => stated.step.replace(x).is_some(),
                        "DWELL" if 0.0 <= x && x.is_finite() => stated.dwell.replace(x).is_some(),
                        "IPM" | "MMPM" | "MMPR" | "IPR" | "FPM" => {
                            let feed = self.feed_in(&name, x, said.place(placed))?;
                            stated.feed.replace(feed).is_some()
                        }
                        _ => {
                            let message = format!("{name} {x} of a cycle is not compiled");
                            self.refuse("cycle", message, said.place(placed));
                            return None;
                        }
                    };
                    if twice {
                        let message = format!("the cycle states {name}, or what means the same, twice");
                        self.error("arguments", message, said.place(placed));
                        return None;
                    }
                }
                Argument::Empty => {
                    order.next();
                }
                Argument::Quoted(_)
                | Argument::Assigned(..)
                | Argument::AssignedWord(..)
                | Argument::Group(_) => {
                    self.error("arguments", "a cycle takes words and numbers", said.place(placed));
                    return None;
                }
            }
        }
        if let Some(word) = word {
            let message = format!("{word} of a cycle has no number");
            self.error("arguments", message, said.span);
            return None;
        }
        Some(stated)
    }

    /// The cycle at one point.
    pub(super) fn hole(&mut self, point: [f64; 3], span: Span) {
        let Some(cycle) = self.cycle.clone() else { return };
        self.rapid = false;
        if cycle.kind == Kind::Refused {
            self.program.position = Some(point);
            return;
        }
        self.pending = None;
        let feed = cycle.feed.or(self.feed);
        let Some(feed) = self.per_minute(feed, span) else { return };
        let axis = self.program.axis();
        // So far above the point, along the tool.
        let at = |h: f64| -> [f64; 3] { std::array::from_fn(|i| point[i] + h * axis[i]) };
        let (top, bottom) = (cycle.clear, -cycle.depth);
        if let Some(from) = self.program.position {
            if self.program.stood() != axis {
                let message =
                    "the tool turns on its way to this hole, and a cycle does not say where that is clear";
                self.push(
                    Diagnostic::refusal("cycle-turns", message)
                        .at(span, "")
                        .hint("a move before the cycle turns the tool, behind CYCLE/OFF between two holes"),
                );
                return;
            }
            let height: f64 = (0..3).map(|i| (from[i] - point[i]) * axis[i]).sum();
            let over = at(height);
            // Squarely over or under the point only rounding is left.
            let aside = (0..3).any(|i| 1.0e-9 < (from[i] - over[i]).abs());
            if height < top {
                let mut up: [f64; 3] = std::array::from_fn(|i| from[i] + (top - height) * axis[i]);
                if axis == UPRIGHT {
                    up = [from[0], from[1], at(top)[2]];
                }
                self.program.rapid(&up, span);
            } else if aside && top < height {
                self.program.rapid(&over, span);
            }
        }
        // Behind a tool call nobody knows where the tool is.
        if !self.program.is_told() || self.program.position != Some(at(top)) {
            self.program.rapid(&at(top), span);
        }
        let line = cycle.line;
        match cycle.kind {
            Kind::Refused => {}
            Kind::Drill | Kind::Ream => {
                self.program.line(&at(bottom), feed, line, span);
                self.dwell(&cycle, span);
            }
            Kind::Deep => {
                let pecks = (cycle.depth / cycle.step - 1.0e-9).ceil().max(1.0) as usize;
                for k in 1..=pecks {
                    let to = if k == pecks { bottom } else { -cycle.step * k as f64 };
                    self.program.line(&at(to), feed, line, span);
                    self.dwell(&cycle, span);
                    if k < pecks {
                        self.program.rapid(&at(top), span);
                        self.program.rapid(&at((to + cycle.clear).min(top)), span);
                    }
                }
            }
        }
        let up = cycle.retract;
        if cycle.kind == Kind::Ream {
            self.program.line(&at(top), feed, line, span);
        }
        if cycle.kind != Kind::Ream || cycle.clear < cycle.retract {
            self.program.rapid(&at(up), span);
        }
    }

    fn dwell(&mut self, cycle: &Cycle, span: Span) {
        if 0.0 < cycle.dwell {
            self.program.auxiliary(Auxiliary::Dwell(cycle.dwell), span);
        }
    }
}
