//! What statements mean, one after the other. All modes of the language end here.

use super::cycles::{Cycle, Kind as CycleKind, Stated};
use super::motion::Pending;
use super::points::Survey;
use super::program::Builder;
use super::records::{Kind, MAX_RECORD, Record, Records};
use super::remarks::Matrix;
use super::splines::Spline;
use super::statement::{self, Argument, Placed, Statement};
use super::systems::System;
use super::technology::Feed;
use super::tools::Known;
use super::words::{Meaning, Words};
use crate::diagnostic::{Diagnostic, Diagnostics, Severity};
use crate::ir::{Auxiliary, Intent, ToolCall};
use crate::source::{SourceId, Span};
use std::collections::BTreeMap;

/// The reader stops after so many errors: the rest follows from the first.
const MAX_ERRORS: usize = 10;

/// Warnings of one kind that are told one by one; the others are counted.
const MAX_WARNINGS: usize = 20;

/// Millimetres in an inch.
pub(super) const INCH: f64 = 25.4;

/// A file in reading.
#[allow(clippy::struct_excessive_bools, reason = "each is a mode of the language, which has many")]
pub(super) struct Reader<'s> {
    pub(super) source: SourceId,
    pub(super) system: &'s System,
    pub(super) words: Words,
    lenient: bool,
    /// What is wrong or strange.
    pub(super) diagnostics: Diagnostics,
    pub(super) program: Builder,
    /// Words that say nothing for a program: how often each stands, and where first.
    left_out: BTreeMap<String, (usize, Span)>,
    name: Option<(String, Span)>,
    ended: bool,
    /// Whether the file is of a kind that is not read, so that all else would follow from that.
    pub(super) hopeless: bool,
    errors: usize,
    warnings: usize,
    /// mm in a unit of the file.
    pub(super) scale: f64,
    /// Whether UNITS was read.
    pub(super) units_stated: bool,
    /// Whether --units states the unit.
    pub(super) unit_told: bool,
    /// Whether a number was taken in the unit of the file before that was stated.
    pub(super) unit_taken: bool,
    /// The first feed in inches, and the first in millimetres.
    pub(super) unit_signs: [Option<Span>; 2],
    /// Tools by their numbers: the name and the diameter that each had where it first moved.
    pub(super) known_tools: BTreeMap<u32, Known>,
    /// The tool that TOOL PATH names, in capitals.
    pub(super) path_tool: Option<String>,
    /// Whether the tool, its name or its diameter was stated since the last move.
    pub(super) dirty_tool: bool,
    /// Whether the next motion is a rapid.
    pub(super) rapid: bool,
    pub(super) feed: Option<Feed>,
    pub(super) rpm: Option<f64>,
    pub(super) tool: Option<ToolCall>,
    /// The cutter's diameter, mm.
    pub(super) diameter: Option<f64>,
    /// Where the tool was when the file began, for GOHOME.
    pub(super) home: Option<[f64; 3]>,
    /// A circle that waits for its end, or a tangent that waits for its arc.
    pub(super) pending: Option<Pending>,
    pub(super) cycle: Option<Cycle>,
    /// The cycle that CYCLE/ON takes up again, as it was stated.
    pub(super) last_cycle: Option<(CycleKind, Stated)>,
    /// The height that the tool had before the cycle, along which axis.
    pub(super) initial: Option<(f64, [f64; 3])>,
    pub(super) spline: Option<Spline>,
    /// Whether a tilt of the tool may not hold any more: MULTAX/OFF, or another tool.
    pub(super) axis_stale: bool,
    /// LENGTH of `MOVNRB/5AXIS`, mm, while it holds.
    pub(super) second_point: Option<f64>,
    /// Where and in which direction the last spline ended.
    pub(super) spline_end: Option<([f64; 3], [f64; 3])>,
    /// The greatest angle at which splines meet, degrees, and the spline behind it.
    pub(super) joint: Option<(f64, Span)>,
    /// The frames in force, by the words that state them.
    pub(super) frames: BTreeMap<String, String>,
    pub(super) matrix: Option<Matrix>,
    /// How many arcs agree with the sense that their system has, and how many do not, by their neighbours' tangents.
    pub(super) votes: super::arcs::Votes,
    /// What the arcs of the file show of the points behind them.
    pub(super) survey: Survey,
}

/// One statement and its record.
pub(super) struct Said<'r> {
    /// The record.
    pub(super) record: &'r Record<'r>,
    /// What it says.
    pub(super) statement: Statement<'r>,
    /// Its whole place.
    pub(super) span: Span,
}

impl<'r> Said<'r> {
    /// Its arguments.
    pub(super) fn arguments(&self) -> &[Placed<'r>] {
        &self.statement.arguments
    }

    /// The place of an argument.
    pub(super) fn place(&self, placed: &Placed<'_>) -> Span {
        self.record.place(self.span.source, placed.range.clone())
    }

    /// The place of the major word.
    pub(super) fn word_place(&self) -> Span {
        self.record.place(self.span.source, 0..self.statement.major.len())
    }

    /// Whether a word stands among the arguments.
    pub(super) fn has(&self, word: &str) -> bool {
        self.arguments()
            .iter()
            .filter_map(|placed| placed.argument.word())
            .any(|known| known.eq_ignore_ascii_case(word))
    }

    /// Whether nothing stands behind the major word; `RAPID /` of Creo has an empty argument.
    pub(super) fn is_bare(&self) -> bool {
        self.arguments().iter().all(|placed| placed.argument == Argument::Empty)
    }

    /// The first argument, where it is a word.
    pub(super) fn first_word(&self) -> &'r str {
        self.arguments().first().and_then(|placed| placed.argument.word()).unwrap_or_default()
    }

    /// The first number.
    pub(super) fn first_number(&self) -> Option<f64> {
        self.arguments().iter().find_map(|placed| placed.argument.number())
    }
}

/// The words of APT that make geometry.
const GEOMETRY: &[&str] = &[
    "POINT", "LINE", "CIRCLE", "PLANE", "VECTOR", "CYLNDR", "ELLIPS", "HYPERB", "PARAB", "CONE", "SPHERE",
    "MATRIX", "PATERN", "TABCYL", "LCONIC", "GCONIC", "QADRIC", "RLDSRF", "POLCON", "SCURV", "SSURF",
];

/// Whether a statement names geometry, `P1=POINT/0,0,0`, as part programs do and CL data never does.
fn is_part_program(text: &str) -> bool {
    let Some((name, rest)) = text.split_once('=') else { return false };
    let word = rest.split('/').next().unwrap_or_default().trim();
    let name = name.trim();
    !name.is_empty()
        && name.bytes().all(|b| b.is_ascii_alphanumeric())
        && GEOMETRY.iter().any(|known| word.eq_ignore_ascii_case(known))
}

impl<'s> Reader<'s> {
    /// At the beginning.
    pub(super) fn new(source: SourceId, system: &'s System, words: Words, lenient: bool) -> Reader<'s> {
        Reader {
            source,
            system,
            words,
            lenient,
            diagnostics: Diagnostics::new(),
            program: Builder::new(),
            left_out: BTreeMap::new(),
            name: None,
            ended: false,
            hopeless: false,
            errors: 0,
            warnings: 0,
            scale: 1.0,
            units_stated: false,
            unit_told: false,
            unit_taken: false,
            unit_signs: [None; 2],
            known_tools: BTreeMap::new(),
            path_tool: None,
            dirty_tool: false,
            rapid: false,
            feed: None,
            rpm: None,
            tool: None,
            diameter: None,
            home: None,
            pending: None,
            cycle: None,
            last_cycle: None,
            initial: None,
            spline: None,
            axis_stale: false,
            second_point: None,
            spline_end: None,
            joint: None,
            frames: BTreeMap::new(),
            matrix: None,
            votes: super::arcs::Votes::default(),
            survey: Survey::default(),
        }
    }

    /// Reads a text.
    pub(super) fn read(mut self, text: &str) -> Result<Intent, Diagnostics> {
        self.survey = Survey::of(text, &self.words, self.scale);
        let goto = self.words.meaning("GOTO") == Some(Meaning::Goto);
        let mut records = Records::new(text);
        while self.errors < MAX_ERRORS && !self.hopeless {
            // Points are by far the most, and most of them come in a row.
            let plain = goto && self.spline.is_none() && !self.ended;
            if plain && let Some(goto) = statement::goto(records.rest()) {
                let (line, start) = records.pass(goto.end);
                let place = start + goto.place.start..start + goto.place.end;
                self.goto(goto.numbers(), line, Span::new(self.source, place));
                continue;
            }
            let Some(record) = &records.next() else { break };
            match record.kind {
                Kind::Code => self.code(record),
                Kind::Remark => {
                    self.close_arc();
                    self.remark(&record.text, record.span(self.source));
                }
                Kind::TooLong => {
                    let message = format!("a statement of more than {MAX_RECORD} characters is no CL data");
                    let start = record.range.start;
                    let span = Span::new(self.source, start..start + 1);
                    self.push(Diagnostic::error("statement-too-long", message).at(span, "it begins here"));
                }
            }
        }
        self.end(text)
    }

    fn end(mut self, text: &str) -> Result<Intent, Diagnostics> {
        self.end_spline();
        self.end_pending();
        let last = Span::new(self.source, text.len()..text.len());
        self.end_cycle("the end of the file", last);
        if !self.hopeless {
            self.unit_is_known();
        }
        self.vote();
        self.joints();
        for (word, (count, span)) in std::mem::take(&mut self.left_out) {
            let times = if count == 1 { String::new() } else { format!(", {count} times") };
            let message = format!("{word} is left out{times}: it says nothing that the program needs");
            self.diagnostics.push(Diagnostic::warning("word-left-out", message).at(span, "first here"));
        }
        if MAX_WARNINGS < self.warnings {
            let message =
                format!("{} more warnings of this file are not shown", self.warnings - MAX_WARNINGS);
            self.diagnostics.push(Diagnostic::warning("warnings-many", message));
        }
        self.diagnostics.extend(self.program.told());
        let warnings = self.diagnostics.into_result()?;
        let (name, name_span) = match self.name {
            Some((name, span)) => (name, Some(span)),
            None => ("PROGRAM".to_owned(), None),
        };
        let whole = Span::new(self.source, 0..text.find('\n').unwrap_or(text.len()).min(80));
        self.program.finish(name, name_span, whole, warnings)
    }

    /// Tells something; errors are counted, so that a file of another kind ends soon.
    pub(super) fn push(&mut self, diagnostic: Diagnostic) {
        match diagnostic.severity {
            Severity::Error | Severity::Refusal => self.errors += 1,
            Severity::Warning | Severity::Note => {
                self.warnings += 1;
                if MAX_WARNINGS < self.warnings {
                    return;
                }
            }
        }
        self.diagnostics.push(diagnostic);
    }

    /// Says that something is wrong.
    pub(super) fn error(&mut self, id: &'static str, message: impl Into<String>, span: Span) {
        self.push(Diagnostic::error(id, message).at(span, ""));
    }

    /// Says that something was understood and is not compiled.
    pub(super) fn refuse(&mut self, id: &'static str, message: impl Into<String>, span: Span) {
        self.push(Diagnostic::refusal(id, message).at(span, ""));
    }

    /// Says that a word is not understood: an error, or a warning where that was asked for.
    pub(super) fn unknown(&mut self, message: String, span: Span, hint: Option<String>) {
        // A word that is nearly another one may be that one misspelt, and then it would be missed.
        let lenient = self.lenient && hint.is_none();
        let mut diagnostic = if lenient {
            Diagnostic::warning("word-unknown", format!("{message}; it is left out"))
        } else {
            Diagnostic::error("word-unknown", message)
        }
        .at(span, "");
        if let Some(hint) = hint {
            diagnostic = diagnostic.hint(hint);
        }
        if !self.lenient {
            diagnostic =
                diagnostic.hint("--words gives it a meaning; --lenient leaves it out with a warning");
        } else if !lenient {
            diagnostic = diagnostic.hint("--words gives it a meaning, such as \"left-out\"");
        }
        self.push(diagnostic);
    }

    /// Says that an argument of a word that is understood is not: no table gives it a meaning, and without it the word would say
    /// something else.
    pub(super) fn argument(&mut self, argument: &str, word: &str, span: Span) {
        self.error("word-unknown", format!("`{argument}` is not understood in {word}"), span);
    }

    /// Takes a word as saying nothing that a program needs.
    pub(super) fn leave_out(&mut self, word: &str, span: Span) {
        let entry = self.left_out.entry(word.to_ascii_uppercase()).or_insert((0, span));
        entry.0 += 1;
    }

    /// One statement.
    fn code(&mut self, record: &Record<'_>) {
        let span = record.span(self.source);
        if self.ended {
            return self.behind_the_end(record, span);
        }
        if super::records::is_free_text(&record.text) {
            return self.free_text(record, span);
        }
        if is_part_program(&record.text) {
            self.hopeless = true;
            // What stood before it follows from that.
            self.diagnostics = Diagnostics::new();
            return self.push(
                Diagnostic::refusal("apt-part-program", "this is an APT part program, not CL data")
                    .at(span, "geometry is named here; CL data has places alone")
                    .hint("an APT processor makes CL data of it"),
            );
        }
        let statement = match statement::parse(&record.text) {
            Ok(statement) => statement,
            Err(_) if self.listed_point(&record.text, span) => return,
            Err(unreadable) => {
                let at = unreadable.at.min(record.text.len());
                let width = record.text[at..].chars().next().map_or(0, char::len_utf8);
                let place = record.place(self.source, at..at + width);
                return self.error("statement-unreadable", "this statement cannot be read", place);
            }
        };
        let said = Said { record, statement, span };
        if self.in_spline(&said) {
            return;
        }
        match self.words.meaning(said.statement.major) {
            Some(meaning) => self.statement(meaning, &said),
            None => {
                let word = said.statement.major;
                let hint = self.words.nearest(word).map(|meant| format!("did you mean {meant}?"));
                self.unknown(format!("`{word}` is not understood"), said.word_place(), hint);
            }
        }
    }

    /// Behind FINI text says nothing, but moves are another program, and left out they would be missed.
    fn behind_the_end(&mut self, record: &Record<'_>, span: Span) {
        let word = statement::parse(&record.text).ok().and_then(|said| self.words.meaning(said.major));
        if !word.is_some_and(Meaning::moves) {
            return self.leave_out("TEXT AFTER FINI", span);
        }
        self.hopeless = true;
        self.push(
            Diagnostic::error("moves-after-end", "a move stands behind the end of the program")
                .at(span, "")
                .hint("a file is one program: take its parts apart, or take out the FINI between them"),
        );
    }

    /// A statement whose text goes to the end of its line.
    fn free_text(&mut self, record: &Record<'_>, span: Span) {
        self.close_arc();
        let text = record.text.as_ref();
        // The longest free word has nine letters.
        let end = text.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).unwrap_or(text.len());
        let end = if text[..end].eq_ignore_ascii_case("TOOL") { text.find('/').unwrap_or(end) } else { end };
        let (word, rest) = (text[..end].trim(), text[end..].trim());
        let rest = rest.strip_prefix('/').unwrap_or(rest).trim();
        let rest = rest.strip_prefix('\'').and_then(|r| r.strip_suffix('\'')).unwrap_or(rest);
        match self.words.meaning(word) {
            Some(Meaning::Partno) => {
                self.name(rest, span);
                self.carry(&format!("PARTNO {rest}"), span);
            }
            Some(Meaning::Path) => {
                self.end_operation("TOOL PATH", span);
                self.name(rest.split(',').next().unwrap_or_default(), span);
                self.carry(&format!("TOOL PATH {rest}"), span);
                self.path(rest, span);
            }
            Some(Meaning::Comment) => self.carry(rest, span),
            Some(Meaning::LeftOut) => self.leave_out(word, span),
            Some(Meaning::Insert) => {
                let message = "INSERT puts text into the program that cannot be proved";
                if self.lenient {
                    self.push(
                        Diagnostic::warning("insert", format!("{message}; it becomes a remark")).at(span, ""),
                    );
                    self.carry(&format!("INSERT {rest}"), span);
                } else {
                    self.push(Diagnostic::error("insert", message).at(span, "").hint(
                        "--lenient makes a remark of it; --words may give INSERT the meaning \"comment\"",
                    ));
                }
            }
            _ => self.refuse("word-refused", format!("{word} is not compiled"), span),
        }
    }

    /// The first name of the file is the program's: letters, digits and underscores, the first two letters.
    fn name(&mut self, text: &str, span: Span) {
        if self.name.is_some() {
            return;
        }
        let mut name: String = super::remarks::plain(text)
            .chars()
            .map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_uppercase() } else { '_' })
            .collect();
        while name.contains("__") {
            name = name.replace("__", "_");
        }
        let mut name = name.trim_matches('_').to_owned();
        if !name.bytes().take(2).all(|b| b.is_ascii_alphabetic()) || name.len() < 2 {
            name = format!("CL_{name}");
        }
        name.truncate(24);
        self.name = Some((name.trim_end_matches('_').to_owned(), span));
    }

    /// What a statement means.
    fn statement(&mut self, meaning: Meaning, said: &Said<'_>) {
        let word = said.statement.major;
        self.between(meaning, said.span);
        if self.dirty_tool && meaning.cuts_or_goes() {
            self.meets_tool(said.span);
        }
        match meaning {
            Meaning::Comment => {
                let text = said.record.text.replace('/', " ");
                self.carry(&text, said.span);
            }
            Meaning::LeftOut => self.leave_out(word, said.span),
            Meaning::Refused => {
                let span = said.word_place();
                self.push(
                    Diagnostic::refusal(
                        "word-refused",
                        format!("{word} is not compiled: it changes what the machine does"),
                    )
                    .at(span, "")
                    .hint("--words may give it another meaning, such as \"comment\" or \"left-out\""),
                );
            }
            // These are free text; as other words they are too.
            Meaning::Partno | Meaning::Insert | Meaning::Path => self.free_text(said.record, said.span),
            Meaning::PathEnd => {
                self.end_operation(&word.to_ascii_uppercase(), said.span);
                self.leave_out(word, said.span);
            }
            Meaning::End => {
                self.end_cycle(&word.to_ascii_uppercase(), said.span);
                self.ended = true;
            }
            Meaning::Units => self.units(said),
            Meaning::Mode => self.mode(said),
            Meaning::Stop if said.is_bare() => self.program.auxiliary(Auxiliary::Stop, said.span),
            Meaning::Opstop if said.is_bare() => self.program.auxiliary(Auxiliary::OptionalStop, said.span),
            Meaning::Cutter => self.cutter(said),
            Meaning::Tldata => self.tldata(said),
            Meaning::Toolno => self.toolno(said),
            Meaning::Loadtl => self.loadtl(said),
            Meaning::Load => self.load(said),
            Meaning::Spindl => self.spindl(said),
            Meaning::Fedrat => self.fedrat(said),
            Meaning::Coolnt => self.coolnt(said),
            Meaning::Delay => self.delay(said),
            Meaning::Cutcom => self.cutcom(said),
            Meaning::Frame => {
                let values = said.record.text.split_once('/').map_or("", |(_, values)| values);
                self.frame(&word.to_ascii_uppercase(), values, said.span);
            }
            Meaning::Multax => self.multax(said),
            Meaning::Tlaxis => self.tlaxis(said),
            Meaning::Rapid if said.is_bare() => self.rapid = true,
            Meaning::Stop | Meaning::Opstop | Meaning::Rapid => {
                self.error("arguments", format!("{word} takes no argument"), said.span);
            }
            Meaning::From => self.from(said),
            Meaning::Gohome => self.gohome(said),
            Meaning::Godlta => self.godlta(said),
            Meaning::Goto => match said.statement.numbers() {
                Some(numbers) => self.goto(&numbers, said.record.line, said.span),
                None => self.error("arguments", format!("{word} takes numbers only"), said.span),
            },
            Meaning::Circle => self.circle(said),
            Meaning::Movarc => self.movarc(said),
            Meaning::Indirv => self.indirv(said),
            Meaning::Tlon => self.tlon(said),
            Meaning::NurbsSiemens | Meaning::Nurbs | Meaning::Movnrb if self.cycle.is_some() => {
                // Told once.
                self.cycle = None;
                let message = "a spline within a cycle: CYCLE/OFF has to stand before it";
                self.error("spline-in-cycle", message, said.span);
                self.spline = Some(Spline::Refused);
            }
            Meaning::NurbsSiemens => self.nurbs_siemens(said),
            Meaning::Nurbs => self.nurbs(said),
            Meaning::Knot | Meaning::Cntrl => {
                let message = format!("{word} stands outside of NURBS/");
                self.error("nurbs-order", message, said.span);
            }
            Meaning::Movnrb => self.movnrb(said),
            Meaning::Cycle => self.cycle(said),
        }
    }
}
