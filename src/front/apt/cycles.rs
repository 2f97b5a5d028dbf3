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
//!
//! `RTRCTO,AUTO` goes back to the height that the tool had before the cycle, along the tool (G98 of ISO); `RTRCTO,n` to n above P.
//!
//! Two posts of Autodesk write the same numbers at the same places and mean two things. With d the depth, c the clearance
//! and r what follows RAPTO, heights along Z:
//!
//! | `cycle_heights` | the GOTO | feed begins at | retracts to |
//! |---|---|---|---|
//! | `top` | P, the top | c above P | c above P |
//! | `iso-4343` | the bottom, so that P is d above | Z = c - r | Z = c |
//! | `generative` | P, the top | c - r above the bottom | c above the bottom |
//!
//! A tool call, another operation, GOHOME and the end of the file end a cycle, with a warning where CYCLE/OFF did not.

use super::program::UPRIGHT;
use super::reader::{Reader, Said};
use super::statement::Argument;
use super::technology::Feed;
use super::words::{CycleHeights, CycleRapid};
use crate::diagnostic::Diagnostic;
use crate::ir::Auxiliary;
use crate::source::Span;

/// The most pecks of one hole.
const MAX_PECKS: f64 = 1000.0;

/// What a cycle does at each point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Drill,
    Deep,
    Ream,
    /// Refused: its points are passed over, since one report is enough.
    Refused,
}

/// Where a hole retracts to.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Return {
    /// To where its feed begins.
    Start,
    /// So far above the point, units of the file.
    Above(f64),
    /// To the height that the tool had before the cycle.
    Initial,
}

/// The heights of a cycle, mm.
#[derive(Clone, Copy, Debug)]
enum Heights {
    /// Above the top of the hole: where the feed begins, and where it retracts to.
    Above(f64, f64),
    /// The feed begins so far above the top, and the height that it retracts to lies along the axis that the tool had there.
    Initial(f64, f64, [f64; 3]),
    /// Places on Z.
    Absolute(f64, f64),
}

/// A cycle in force.
#[derive(Clone, Debug)]
pub(super) struct Cycle {
    kind: Kind,
    /// mm below the top of the hole.
    depth: f64,
    heights: Heights,
    /// Whether its points are the bottoms of the holes.
    bottom: bool,
    /// The depths that it feeds to, mm below the top; the last is `depth`.
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
        heights: Heights::Above(0.0, 0.0),
        bottom: false,
        step: 0.0,
        dwell: 0.0,
        feed: None,
        line: 0,
    };
}

/// What the arguments of a cycle state, in units of the file.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Stated {
    /// Below the point.
    depth: Option<f64>,
    /// Whether FEDTO states it, which some systems count upwards.
    fedto: bool,
    clear: Option<f64>,
    /// RAPTO, where it does not mean the same as CLEAR.
    rapto: Option<f64>,
    retract: Option<Return>,
    step: Option<f64>,
    dwell: Option<f64>,
    feed: Option<Feed>,
    /// Whether a number stands there without a word before it.
    positional: bool,
    /// Whether DEEP stands behind the type.
    deep: bool,
}

impl Stated {
    /// What is stated here, and otherwise what was stated before.
    fn or(self, before: Stated) -> Stated {
        Stated {
            depth: self.depth.or(before.depth),
            fedto: if self.depth.is_some() { self.fedto } else { before.fedto },
            clear: self.clear.or(before.clear),
            rapto: self.rapto.or(before.rapto),
            retract: self.retract.or(before.retract),
            step: self.step.or(before.step),
            dwell: self.dwell.or(before.dwell),
            feed: self.feed.or(before.feed),
            positional: self.positional || before.positional,
            deep: self.deep || before.deep,
        }
    }
}

impl Reader<'_> {
    /// `CYCLE/type,args | OFF | ON[,args] | INIT | CLEAR`
    pub(super) fn cycle(&mut self, said: &Said<'_>) {
        let name = said.first_word().to_ascii_uppercase();
        if self.cycle.is_none() {
            // The height before the first cycle stays the initial one until it is over.
            self.initial = self.program.height();
        }
        let before = self.cycle.replace(Cycle::REFUSED);
        let kind = match name.as_str() {
            "OFF" | "CLEAR" | "INIT" if said.arguments().len() != 1 => {
                let message = format!("CYCLE/{name} stands alone");
                return self.error("arguments", message, said.span);
            }
            "OFF" | "CLEAR" => {
                self.cycle = None;
                return;
            }
            // It says nothing: a cycle follows.
            "INIT" => {
                self.cycle = before;
                return;
            }
            "ON" if self.last_cycle.is_none() => {
                return self.error("cycle-unknown", "CYCLE/ON without a cycle before it", said.span);
            }
            "ON" => Kind::Refused,
            "DRILL" | "CSINK" | "FACE" | "SPDRL" => Kind::Drill,
            "DEEP" => Kind::Deep,
            "REAM" => Kind::Ream,
            "TAP" => {
                let message = "CYCLE/TAP: tapping needs the spindle to follow the feed, which no move says";
                return self.refuse("cycle", message, said.span);
            }
            _ => {
                let message = format!("CYCLE/{name} is not compiled; DRILL, DEEP, CSINK, FACE and REAM are");
                return self.refuse("cycle", message, said.span);
            }
        };
        let Some(stated) = self.stated(said) else { return };
        let (kind, stated) = match self.last_cycle.take() {
            Some((kind, before)) if name == "ON" => (kind, stated.or(before)),
            Some(_) | None if kind == Kind::Drill && stated.deep => (Kind::Deep, stated),
            Some(_) | None => (kind, stated),
        };
        self.last_cycle = Some((kind, stated));
        let Some(heights) = self.heights(kind, &stated, said) else { return };
        let Some(depth) = self.depth(&stated, said.span) else { return };
        let Some(step) = self.peck(kind, &stated, depth, said.span) else { return };
        self.cycle = Some(Cycle {
            kind,
            depth,
            heights,
            bottom: self.words.heights == CycleHeights::Iso4343,
            step,
            dwell: stated.dwell.unwrap_or(0.0),
            feed: stated.feed,
            line: said.record.line,
        });
        if name != "ON" || 1 < said.arguments().len() {
            let text = format!("{} AS MOVES", said.record.text.replace('/', " "));
            self.carry(&text, said.span);
        }
    }

    /// The depth of a cycle, mm below the top of the hole.
    fn depth(&mut self, stated: &Stated, span: Span) -> Option<f64> {
        let depth = stated.depth.map(|d| d * self.scale);
        if let Some(up) = depth.filter(|depth| *depth < 0.0 && depth.is_finite()) {
            let message = format!("the cycle feeds to {} mm above its point", -up);
            let other = if self.words.fedto < 0.0 { "positive" } else { "negative" };
            let hint = if stated.fedto {
                format!(
                    "fedto = \"{other}\" in a table for --words, where the shop's files count below the point so"
                )
            } else {
                "DEPTH counts downwards: below its point it is positive".to_owned()
            };
            self.push(Diagnostic::error("cycle-depth", message).at(span, "").hint(hint));
            return None;
        }
        let depth = depth.filter(|depth| 0.0 < *depth && depth.is_finite());
        if depth.is_none() {
            self.push(Diagnostic::error("cycle-depth", "the cycle states no depth").at(span, "").hint(
                "DEPTH or FEDTO states one; a number without a word needs its place in [cycles] of --words",
            ));
        }
        depth
    }

    /// How deep each stroke of a cycle is, mm.
    fn peck(&mut self, kind: Kind, stated: &Stated, depth: f64, span: Span) -> Option<f64> {
        let message = match (kind, stated.step) {
            (Kind::Deep, None) => "DEEP drills in steps, and no STEP says how deep".to_owned(),
            (Kind::Drill | Kind::Ream | Kind::Refused, Some(_)) => {
                "STEP is of DEEP; this cycle drills in one stroke".to_owned()
            }
            (Kind::Drill | Kind::Ream | Kind::Refused, None) => return Some(depth),
            (Kind::Deep, Some(step)) => {
                let step = step * self.scale;
                if 0.0 < step && depth / step <= MAX_PECKS {
                    return Some(step);
                }
                format!("STEP must be greater than zero and make at most {MAX_PECKS} pecks")
            }
        };
        self.error("cycle-step", message, span);
        None
    }

    /// The heights of a cycle, by what its system counts them from.
    fn heights(&mut self, kind: Kind, stated: &Stated, said: &Said<'_>) -> Option<Heights> {
        let Some(clear) = stated.clear.map(|c| c * self.scale).filter(|c| c.is_finite()) else {
            self.error("cycle-clear", "the cycle states no CLEAR or RAPTO to begin from", said.span);
            return None;
        };
        let (rapto, depth) =
            (stated.rapto.unwrap_or(0.0) * self.scale, stated.depth.unwrap_or(0.0) * self.scale);
        let by_place = matches!(self.words.heights, CycleHeights::Iso4343 | CycleHeights::Generative);
        if by_place && stated.positional && (stated.retract.is_some() || rapto < 0.0) {
            let message = "RTRCTO, or a RAPTO below zero, in a cycle whose numbers have their places: from where it counts is not known";
            self.refuse("cycle-heights", message, said.span);
            return None;
        }
        let heights = match (stated.positional, self.words.heights) {
            (true, CycleHeights::Unsure) => {
                let message = "two posts of Autodesk write these numbers at these places: with one of them the points of the cycle are the bottoms of the holes, with the other their tops";
                self.push(
                    Diagnostic::refusal("cycle-heights", message)
                        .at(said.span, "")
                        .hint("cycle_heights = \"iso-4343\" in a table for --words: the GOTO is the bottom of the hole, the clearance a place on Z, as \"Common ISO 4343 APT\" writes it")
                        .hint("cycle_heights = \"generative\": the GOTO is the top, the clearance counts from the bottom, as \"Generative Machining APT\" writes it"),
                );
                return None;
            }
            (true, CycleHeights::Iso4343) => Heights::Absolute(clear - rapto, clear),
            (true, CycleHeights::Generative) => Heights::Above(clear - rapto - depth, clear - depth),
            (false, CycleHeights::Iso4343 | CycleHeights::Generative) => {
                let message = "the table for --words says what the numbers at fixed places mean, and this cycle has words before its numbers";
                self.refuse("cycle-heights", message, said.span);
                return None;
            }
            (_, CycleHeights::Top) | (false, CycleHeights::Unsure) => {
                if stated.rapto.is_some() {
                    let message = "the cycle states RAPTO, or what means the same, twice";
                    self.error("arguments", message, said.span);
                    return None;
                }
                match stated.retract.unwrap_or(Return::Start) {
                    Return::Start => Heights::Above(clear, clear),
                    Return::Above(up) => {
                        let up = up * self.scale;
                        if up < clear {
                            let message = format!(
                                "RTRCTO is below the {clear} mm from which the cycle begins: it retracts to there"
                            );
                            self.push(Diagnostic::warning("cycle-retract", message).at(said.span, ""));
                        }
                        Heights::Above(clear, up.max(clear))
                    }
                    Return::Initial => {
                        let Some((height, axis)) = self.initial else {
                            let message = "RTRCTO,AUTO goes back to the height that the tool had before the cycle, and nothing brought it there";
                            self.push(
                                Diagnostic::refusal("cycle-retract", message)
                                    .at(said.span, "")
                                    .hint("a RAPID with its GOTO between the tool call and the cycle states that height; RTRCTO with a number states another"),
                            );
                            return None;
                        };
                        Heights::Initial(clear, height, axis)
                    }
                }
            }
        };
        let begins = match heights {
            Heights::Above(clear, _) | Heights::Initial(clear, ..) => clear,
            // Its points say how far above the hole that is.
            Heights::Absolute(..) => return Some(heights),
        };
        self.clears(kind, begins, said.span).then_some(heights)
    }

    /// Whether a cycle begins far enough above the top of its hole.
    fn clears(&mut self, kind: Kind, clear: f64, span: Span) -> bool {
        if !(0.0 <= clear) {
            self.error("cycle-clear", "the cycle begins below the top of the hole", span);
            return false;
        }
        if kind == Kind::Deep && clear == 0.0 {
            let message =
                "with a CLEAR of 0 each stroke would start at rapid on the bottom of the one before";
            self.error("cycle-clear", message, span);
            return false;
        }
        if clear == 0.0 {
            let message = "with a CLEAR of 0 the tool goes at rapid as far as the point itself";
            self.push(Diagnostic::warning("cycle-clear", message).at(span, ""));
        }
        true
    }

    /// A cycle ends where something ends it, and CYCLE/OFF did not: `what` stands at `span`.
    pub(super) fn end_cycle(&mut self, what: &str, span: Span) {
        if let Some(cycle) = self.cycle.take().filter(|cycle| cycle.kind != Kind::Refused) {
            let message =
                format!("the cycle of line {} is not ended before {what}: it ends here", cycle.line);
            self.push(
                Diagnostic::warning("cycle-open", message)
                    .at(span, "")
                    .hint("CYCLE/OFF ends a cycle; points behind it are moves"),
            );
        }
    }

    /// What the arguments say, by their words or their places.
    fn stated(&mut self, said: &Said<'_>) -> Option<Stated> {
        let mut stated = Stated::default();
        let mut word: Option<String> = None;
        let name = said.first_word().to_ascii_uppercase();
        let kind = name.as_str();
        let order: Vec<String> = self.words.cycle(kind).to_vec();
        let mut order = order.into_iter();
        for placed in said.arguments().iter().skip(1) {
            match placed.argument {
                Argument::Word(next) => {
                    let next = next.to_ascii_uppercase();
                    match word.take() {
                        Some(before) if before == "RTRCTO" && (next == "AUTO" || next == "MANUAL") => {
                            let to = if next == "AUTO" { Return::Initial } else { Return::Start };
                            if stated.retract.replace(to).is_some() {
                                self.error("arguments", "the cycle states RTRCTO twice", said.place(placed));
                                return None;
                            }
                        }
                        Some(before) => {
                            let message = format!("{before} of a cycle has no number");
                            self.error("arguments", message, said.place(placed));
                            return None;
                        }
                        None if next == "MANUAL" => {
                            // `RTRCTO,n,MANUAL` is n; alone it contradicts AUTO.
                            if stated.retract == Some(Return::Initial) {
                                let message = "RTRCTO is AUTO and MANUAL: which one is not known";
                                self.error("arguments", message, said.place(placed));
                                return None;
                            }
                        }
                        None if next == "DEEP" && kind == "DRILL" => stated.deep = true,
                        None => word = Some(next),
                    }
                }
                Argument::Number(x) => {
                    stated.positional |= word.is_none();
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
                        "DEPTH" => stated.depth.replace(x).is_some(),
                        "FEDTO" => {
                            stated.fedto = true;
                            stated.depth.replace(x * self.words.fedto).is_some()
                        }
                        // Of a cycle by places RAPTO is another number than its clearance.
                        "RAPTO" if stated.clear.is_some() => stated.rapto.replace(x).is_some(),
                        "CLEAR" | "RAPTO" => stated.clear.replace(x).is_some(),
                        "RTRCTO" => stated.retract.replace(Return::Above(x)).is_some(),
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

    /// Whether `RAPID` before a point of a cycle leaves it a hole; where nobody says, the cycle is refused.
    fn drills(&mut self, span: Span) -> bool {
        if !std::mem::take(&mut self.rapid) {
            return true;
        }
        match self.words.cycle_rapid {
            Some(CycleRapid::Hole) => true,
            Some(CycleRapid::Off) => {
                self.end_cycle("RAPID", span);
                self.rapid = true;
                false
            }
            None => {
                let message = "RAPID stands within a cycle: whether this point is one more hole, or a move that ends the cycle, no page says";
                self.push(
                    Diagnostic::refusal("cycle-rapid", message)
                        .at(span, "")
                        .hint("cycle_rapid = \"hole\" in a table for --words drills here; \"off\" ends the cycle, as CYCLE/OFF before it would"),
                );
                self.cycle = Some(Cycle::REFUSED);
                true
            }
        }
    }

    /// Where the feed of a hole begins and where it retracts to, mm above its top.
    fn over(&mut self, cycle: &Cycle, top: [f64; 3], axis: [f64; 3], span: Span) -> Option<(f64, f64)> {
        match cycle.heights {
            Heights::Above(clear, retract) => Some((clear, retract)),
            Heights::Initial(clear, height, along) => {
                if along != axis {
                    let message =
                        "RTRCTO,AUTO goes back to the height before the cycle, and the tool has turned since";
                    self.error("cycle-retract", message, span);
                    return None;
                }
                let retract = height - (0..3).map(|i| top[i] * axis[i]).sum::<f64>();
                if retract < clear {
                    let message = format!(
                        "the height before the cycle is below the {clear} mm above the hole from which it begins: it retracts to there"
                    );
                    self.push(Diagnostic::warning("cycle-retract", message).at(span, ""));
                }
                Some((clear, retract.max(clear)))
            }
            Heights::Absolute(start, end) => {
                if axis != UPRIGHT {
                    let message = "the clearance of this cycle is a place on Z, and the tool is tilted";
                    self.refuse("cycle-heights", message, span);
                    return None;
                }
                let (clear, retract) = (start - top[2], end - top[2]);
                self.clears(cycle.kind, clear, span).then_some((clear, retract))
            }
        }
    }

    /// The cycle at one point; whether it was one of its points.
    pub(super) fn hole(&mut self, point: [f64; 3], span: Span) -> bool {
        if !self.drills(span) {
            return false;
        }
        let Some(cycle) = self.cycle.clone() else { return false };
        if cycle.kind == Kind::Refused {
            self.program.position = Some(point);
            return true;
        }
        self.pending = None;
        if self.drill(&cycle, point, span).is_none() {
            self.program.position = Some(point);
        }
        true
    }

    /// One hole; none where it cannot be drilled.
    fn drill(&mut self, cycle: &Cycle, point: [f64; 3], span: Span) -> Option<()> {
        let feed = cycle.feed.or(self.feed);
        let feed = self.per_minute(feed, span)?;
        let axis = self.program.axis();
        let below = if cycle.bottom { cycle.depth } else { 0.0 };
        let point: [f64; 3] = std::array::from_fn(|i| point[i] + below * axis[i]);
        let (clear, retract) = self.over(cycle, point, axis, span)?;
        // So far above the point, along the tool.
        let at = |h: f64| -> [f64; 3] { std::array::from_fn(|i| point[i] + h * axis[i]) };
        let (top, bottom) = (clear, -cycle.depth);
        if let Some(from) = self.program.position {
            if self.program.stood() != axis {
                let message =
                    "the tool turns on its way to this hole, and a cycle does not say where that is clear";
                self.push(
                    Diagnostic::refusal("cycle-turns", message)
                        .at(span, "")
                        .hint("a move before the cycle turns the tool, behind CYCLE/OFF between two holes"),
                );
                return None;
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
                self.dwell(cycle, span);
            }
            Kind::Deep => {
                let pecks = (cycle.depth / cycle.step - 1.0e-9).ceil().max(1.0) as usize;
                for k in 1..=pecks {
                    let to = if k == pecks { bottom } else { -cycle.step * k as f64 };
                    self.program.line(&at(to), feed, line, span);
                    self.dwell(cycle, span);
                    if k < pecks {
                        self.program.rapid(&at(top), span);
                        self.program.rapid(&at((to + clear).min(top)), span);
                    }
                }
            }
        }
        if cycle.kind == Kind::Ream {
            self.program.line(&at(top), feed, line, span);
        }
        if cycle.kind != Kind::Ream || clear < retract {
            self.program.rapid(&at(retract), span);
        }
        Some(())
    }

    fn dwell(&mut self, cycle: &Cycle, span: Span) {
        if 0.0 < cycle.dwell {
            self.program.auxiliary(Auxiliary::Dwell(cycle.dwell), span);
        }
    }
}
