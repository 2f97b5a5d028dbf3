//! Reads a program of an ISO control, in two layers: blocks as written, then what they mean.
//!
//! A word that is not understood is an error at its place. A number without a decimal point is read as it stands: X30 is
//! 30 mm, though a control set to least increments takes it for 0.003 mm. A remark behind the words of a block is passed
//! over. A remark in a line of its own ends no spline; where one stands inside a spline, it is read as coming after it.

mod nurbs;
mod words;

use super::{Offset, is_block};
use crate::decimal::Decimal;
use crate::diagnostic::{Diagnostics, Warned};
use crate::dialect::assemble::Assembler;
use crate::dialect::block::{Frame, Lines, Met, Numbering, block_number};
use crate::dialect::{Form, Reading};
use crate::ir::{Step, ThroughKind, Units, Written, WrittenPoints};
use crate::machine::Machine;
use crate::source::{SourceId, Span};
use crate::units::{Axis, MAX_AXES};
use nurbs::NurbsRun;
use std::ops::Range;
use words::{Word, word};

/// G group 1.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Motion {
    None,
    Rapid,
    Line,
    Nurbs,
    Through,
}

/// Codes that state what the IR assumes anyway, and codes of how exactly the control runs, which move no path; in tenths.
const STATE_CODES: &[i64] = &[150, 170, 210, 400, 490, 610, 611, 640, 670, 690, 800, 900, 940, 970, 980];

/// Codes under which the same words are another path, and what they mean; in tenths.
const REFUSED_CODES: &[(i64, &str)] = &[
    (20, "arcs are not read"),
    (30, "arcs are not read"),
    (40, "a dwell is not read"),
    (180, "another plane than XY is not read"),
    (190, "another plane than XY is not read"),
    (200, "inches are not read"),
    (280, "the home position is the machine's own"),
    (410, "cutter radius compensation is not read"),
    (420, "cutter radius compensation is not read"),
    (434, "tool centre point control is not read"),
    (435, "tool centre point control is not read"),
    (530, "machine coordinates are not read"),
    (612, "modal spline interpolation makes curves of lines, which only the control knows"),
    (680, "a turned coordinate system is not read"),
    (910, "incremental positions are not read"),
    (930, "inverse time feed is not read"),
    (950, "feed a revolution is not read"),
];

/// A value and where it stands.
type Placed = (Decimal, Range<usize>);

/// What one block says.
#[derive(Default)]
struct Block {
    named: [(usize, i64); MAX_AXES],
    /// Where each named axis stands in the text.
    places: [usize; MAX_AXES],
    count: usize,
    motion: Option<Motion>,
    feed: Option<Placed>,
    k: Option<Placed>,
    r: Option<Placed>,
    p: Option<Placed>,
    q: Option<Placed>,
    h: Option<Placed>,
    /// G05 or G05.1, in tenths.
    high_speed: Option<(i64, Range<usize>)>,
    /// G43.
    offset: Option<Range<usize>>,
}

impl Block {
    fn named(&self) -> &[(usize, i64)] {
        &self.named[..self.count]
    }
}

/// A spline in the making.
enum Run {
    Nurbs(NurbsRun),
    Through { start: Units, units: Vec<i64>, lines: Vec<u32>, span: Span },
}

struct Reader<'m> {
    assembler: Assembler<'m>,
    motion: Motion,
    run: Option<Run>,
    /// Remarks within the spline in the making.
    remarks: Vec<(String, Span)>,
    z: Option<usize>,
    /// The tool whose length offset is still to be called.
    offset_due: Option<u32>,
    /// The work offset in force, G54 to G59, in tenths.
    work_offset: Option<i64>,
    warned_left_out: bool,
}

/// Reads a program.
pub(super) fn read(text: &str, source: SourceId, machine: &Machine) -> Result<Warned<Reading>, Diagnostics> {
    let offset = Offset::new(machine);
    let machine: &Machine = &offset.machine;
    let mut frame = Frame::new(machine);
    let mut numbering = Numbering::new(machine);
    let mut reader = Reader {
        assembler: Assembler::new(machine, source),
        motion: Motion::None,
        run: None,
        remarks: Vec::new(),
        z: Axis::new("Z").and_then(|z| machine.axes.index_of(z)),
        offset_due: None,
        work_offset: None,
        warned_left_out: false,
    };
    for line in Lines::new(text) {
        let mut body = line.text.trim_start();
        if body.is_empty() {
            continue;
        }
        let number = body.strip_prefix('N').and_then(block_number);
        if let Some((_, digits)) = number {
            body = body[1 + digits..].trim_start();
        }
        if number.is_some() || is_block(body) {
            numbering.meet(number.map(|(number, _)| number), line.range());
        }
        let start = line.start + line.text.len() - body.len();
        let span = Span::new(source, line.range());
        // A line that begins with an axis is a move, and by far the most are; only others can be lines of the frame.
        let first = body.bytes().next().unwrap_or(b' ');
        let is_move = frame.header_complete()
            && reader.motion != Motion::None
            && reader.assembler.letter(first).is_some();
        if !is_move {
            if reader.run.is_some() && frame.may_begin(body) {
                reader.flush();
            }
            if frame.meet(body, span, line.range(), &mut reader.assembler) == Met::Fixed {
                reader.tool_line(body, &offset);
                // The machine's own lines may hold a work offset; another one later would be another place.
                let mut codes =
                    body.split_whitespace().filter_map(|code| code.strip_prefix("G5")?.parse().ok());
                if let Some(digit) = codes.rfind(|digit: &i64| (4..=9).contains(digit)) {
                    reader.work_offset = Some(500 + 10 * digit);
                }
                continue;
            }
        }
        reader.block(body.strip_suffix(';').unwrap_or(body), start, line.number, span);
        if 100 < reader.assembler.diagnostics.0.len() {
            break;
        }
    }
    reader.flush();
    let (header, footer) = (frame.header_complete(), frame.footer_complete());
    let warned = reader.assembler.finish()?;
    let reading = Reading { decimals: warned.value, header, footer, misnumbered: numbering.misnumbered };
    Ok(Warned { value: reading, warnings: warned.warnings })
}

impl Reader<'_> {
    fn error(&mut self, id: &'static str, message: impl Into<String>, range: Range<usize>) {
        self.assembler.error(id, message, range);
    }

    /// Where a fixed line calls a tool, the offset that was taken out of the machine's lines must follow.
    fn tool_line(&mut self, body: &str, offset: &Offset<'_>) {
        let frame = &self.assembler.machine.frame;
        for (lines, due) in [(&frame.tool, offset.tool), (&frame.tool_spindle, offset.tool_spindle)] {
            if due && lines.first().is_some_and(|template| template.matched(body).is_some()) {
                self.offset_due = self.assembler.tool();
            }
        }
    }

    /// One block: its words, then what they do together.
    fn block(&mut self, code: &str, start: usize, line: u32, span: Span) {
        let mut block = Block::default();
        let (mut remark, mut words) = (None, 0);
        let mut rest = code;
        if rest == "%" {
            return;
        }
        while !rest.is_empty() {
            let at = start + (code.len() - rest.len());
            let Ok((after, word)) = word(rest) else { return self.unreadable(rest, at) };
            let range = at..at + (rest.len() - after.len());
            match word {
                Word::Remark(text) => remark = Some(text),
                Word::Address(letter, value) => {
                    words += 1;
                    match self.assembler.letter(letter) {
                        Some(axis) => self.axis(&mut block, axis, value, range),
                        None => self.address(letter, value, range, &mut block),
                    }
                }
                Word::Assignment(name, value) => {
                    words += 1;
                    match self.assembler.axis(name) {
                        Some(axis) => self.axis(&mut block, axis, value, range),
                        None => self.error(
                            "axis-unknown",
                            format!("{name} is not an axis of this machine"),
                            range,
                        ),
                    }
                }
            }
            rest = after.trim_start();
        }
        match remark {
            Some(text) if words == 0 => {
                let text = text.trim().to_owned();
                if self.run.is_some() {
                    self.remarks.push((text, span));
                } else {
                    self.assembler.step(Step::Comment(text), span);
                }
            }
            Some(_) | None => self.act(block, line, span),
        }
    }

    fn unreadable(&mut self, rest: &str, at: usize) {
        let length = rest.find([' ', '\t']).unwrap_or(rest.len());
        let (id, message) = match rest.bytes().next() {
            Some(b'/') => ("block-skip", "whether a block behind / runs is decided at the machine"),
            Some(b'(') => ("remark-open", "this remark has no end"),
            _ => ("word-unreadable", "this word cannot be read"),
        };
        self.error(id, message, at..at + length);
    }

    #[inline]
    fn axis(&mut self, block: &mut Block, axis: usize, value: Decimal, range: Range<usize>) {
        let at = range.start;
        let Some(units) = self.assembler.units(axis, value, range.clone()) else { return };
        if block.named().iter().any(|(other, _)| *other == axis) {
            let name = self.assembler.machine.axes.name(axis);
            return self.error("axis-twice", format!("{name} stands twice in this block"), range);
        }
        // There are no more axes than places, and none comes here twice.
        block.named[block.count] = (axis, units);
        block.places[block.count] = at;
        block.count += 1;
    }

    fn address(&mut self, letter: u8, value: Decimal, range: Range<usize>, block: &mut Block) {
        let slot = match letter {
            b'G' => return self.code(value, range, block),
            b'F' => &mut block.feed,
            b'K' => &mut block.k,
            b'R' => &mut block.r,
            b'P' => &mut block.p,
            b'Q' => &mut block.q,
            b'H' => &mut block.h,
            // The program's number; its name stands in the header.
            b'O' if value.units(0).is_some_and(|number| 0 < number) => {
                if self.assembler.name.is_empty() {
                    self.assembler.name = format!("O{value}");
                }
                return;
            }
            _ => {
                return self.error(
                    "word-unknown",
                    format!("`{}{value}` is not understood", char::from(letter)),
                    range,
                );
            }
        };
        if slot.is_some() {
            return self.error(
                "word-twice",
                format!("{} stands twice in this block", char::from(letter)),
                range,
            );
        }
        *slot = Some((value, range));
    }

    /// A G code.
    fn code(&mut self, value: Decimal, range: Range<usize>, block: &mut Block) {
        let dialect = self.assembler.machine.dialect;
        let tenths = value.units(1);
        let motion = match tenths {
            Some(0) => Motion::Rapid,
            Some(10) => Motion::Line,
            Some(62) if dialect.motion_of(Form::Nurbs).is_some() => Motion::Nurbs,
            Some(61) if dialect.motion_of(Form::Through(ThroughKind::Fine)).is_some() => Motion::Through,
            Some(tenths @ (50 | 51)) => {
                block.high_speed = Some((tenths, range));
                return;
            }
            Some(430) => {
                block.offset = Some(range);
                return;
            }
            Some(tenths @ (540 | 550 | 560 | 570 | 580 | 590)) => {
                if self.work_offset.is_some_and(|known| known != tenths) {
                    self.error(
                        "code-refused",
                        format!("G{value}: another work offset is another place"),
                        range,
                    );
                }
                self.work_offset = Some(tenths);
                return;
            }
            Some(tenths) if STATE_CODES.contains(&tenths) => return,
            _ => {
                let refused = REFUSED_CODES.iter().find(|(code, _)| Some(*code) == tenths);
                return match refused {
                    Some((_, why)) => self.error("code-refused", format!("G{value}: {why}"), range),
                    None => self.error("word-unknown", format!("`G{value}` is not understood"), range),
                };
            }
        };
        if block.motion.is_some_and(|other| other != motion) {
            return self.error("codes-conflict", "two codes of motion in one block", range);
        }
        block.motion = Some(motion);
    }

    /// What the words of a block do together.
    fn act(&mut self, mut block: Block, line: u32, span: Span) {
        let whole = || span.start as usize..span.end as usize;
        if let Some(motion) = block.motion {
            // G06.2 begins a curve each time; the others stay in force.
            if motion != self.motion || motion == Motion::Nurbs {
                self.flush();
            }
            self.motion = motion;
        }
        if let Some((code, range)) = block.high_speed.take() {
            self.high_speed(code, &mut block, range);
        }
        if block.offset.is_some() || block.h.is_some() || self.offset_due.is_some() {
            self.length_offset(&mut block, whole());
        }
        if let Some((feed, range)) = block.feed.take() {
            self.set_feed(feed, range);
        }
        if let Some((_, range)) = block.q.take() {
            self.error("word-unknown", "Q is read with G05.1 only", range);
        }
        if self.motion == Motion::Nurbs {
            return self.nurbs_block(&block, line, span);
        }
        for (name, word) in [("K", block.k.take()), ("R", block.r.take()), ("P", block.p.take())] {
            if let Some((_, range)) = word {
                self.error("spline-word", format!("{name} belongs to G06.2"), range);
            }
        }
        if block.count == 0 {
            return;
        }
        match self.motion {
            // Once, and not where a code of motion before it was refused.
            Motion::None if self.assembler.diagnostics.has_errors() => {}
            Motion::None => self.error("motion-missing", "a move before any G0, G1 or spline", whole()),
            Motion::Rapid => self.assembler.rapid(block.named(), span),
            Motion::Line => self.assembler.line(block.named(), line, span),
            Motion::Through => self.through_block(&block, line, span),
            Motion::Nurbs => {} // met above
        }
    }

    /// `G05 P2`, `G05.1 Q1`: how fast the control runs, not where.
    fn high_speed(&mut self, code: i64, block: &mut Block, range: Range<usize>) {
        let whole = |word: Option<Placed>| word.and_then(|(value, _)| value.units(0));
        let known = if code == 50 {
            matches!(whole(block.p.take()), Some(0 | 1 | 2 | 10_000))
        } else {
            matches!(whole(block.q.take()), Some(0 | 1))
        };
        if !known {
            self.error("code-refused", "only G05 P0, P1, P2, P10000 and G05.1 Q0, Q1 are read", range);
        }
    }

    /// `G43 H1`, after a tool call whose lines in the machine file end with it.
    fn length_offset(&mut self, block: &mut Block, whole: Range<usize>) {
        let (offset, number) = (block.offset.take(), block.h.take());
        match (offset, number, self.offset_due) {
            (Some(_), Some((h, range)), Some(tool)) => {
                if h.units(0) != Some(i64::from(tool)) {
                    self.error(
                        "tool-offset",
                        format!("the offset of tool {tool} is called here, not that of H{h}"),
                        range,
                    );
                }
                self.offset_due = None;
            }
            (Some(range), _, _) => {
                self.error("tool-offset", "G43 H is read once after a tool call that asks for it", range);
            }
            (None, Some((_, range)), _) => self.error("word-unknown", "H is read with G43 only", range),
            (None, None, Some(tool)) => {
                let moves = match self.motion {
                    Motion::None => false,
                    Motion::Rapid => block.named().iter().any(|(axis, _)| Some(*axis) == self.z),
                    Motion::Line | Motion::Nurbs | Motion::Through => 0 < block.count,
                };
                if moves {
                    self.offset_due = None;
                    self.error(
                        "tool-offset-missing",
                        format!("tool {tool} moves before its `G43 H{tool}`"),
                        whole,
                    );
                }
            }
            (None, None, None) => {}
        }
    }

    fn set_feed(&mut self, feed: Decimal, range: Range<usize>) {
        if feed.compare(Decimal::ZERO).is_le() {
            return self.error("feed-range", "the feed must be greater than zero", range);
        }
        if self.assembler.feed != Some(feed) {
            if matches!(&self.run, Some(Run::Nurbs(run)) if 0 < run.closing) {
                self.flush();
            }
            if self.run.is_some() {
                return self.error("feed-in-spline", "a spline has one feed, that of its first block", range);
            }
            self.assembler.feed = Some(feed);
        }
    }

    fn through_block(&mut self, block: &Block, line: u32, span: Span) {
        let target = self.assembler.target(block.named());
        let start = if self.run.is_none() { self.assembler.start(&target, span) } else { target };
        for (axis, units) in block.named() {
            self.assembler.position[*axis] = Some(*units);
        }
        let stride = self.assembler.machine.axes.count();
        let run = self.run.get_or_insert_with(|| Run::Through {
            start,
            units: Vec::new(),
            lines: Vec::new(),
            span,
        });
        if let Run::Through { units, lines, span: whole, .. } = run {
            units.extend_from_slice(&target[..stride]);
            lines.push(line);
            whole.end = span.end;
        }
    }

    /// Ends a spline: it becomes a cut. Remarks within it come after it.
    fn flush(&mut self) {
        match self.run.take() {
            None => {}
            Some(Run::Through { start, units, lines, span }) => {
                let stride = self.assembler.machine.axes.count();
                let mut end = start;
                if let Some(last) = units.chunks_exact(stride).next_back() {
                    end[..stride].copy_from_slice(last);
                }
                let points = WrittenPoints { start, stride, units, lines };
                self.assembler.curve(Written::Through(ThroughKind::Fine, points), &end, span);
            }
            Some(Run::Nurbs(run)) => {
                let (end, span) = (run.points.last().copied().unwrap_or(run.start), run.span);
                if let Some(nurbs) = self.nurbs(run) {
                    self.assembler.curve(Written::Nurbs(nurbs), &end, span);
                }
            }
        }
        for (text, span) in std::mem::take(&mut self.remarks) {
            self.assembler.step(Step::Comment(text), span);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostic::Severity;
    use crate::geom::nurbs::Nurbs;

    /// X and Y only, without lines round the program.
    const FLAT: &str = "extends = \"mazak\"\n[axes]\nlinear = [\"X\", \"Y\"]\nrotary = []\n\
        [program]\nheader = []\ntool = [\"T{tool} M6\", \"G43 H{tool}\"]\nfooter = []\n";

    /// Example B of the reference: x = t.
    const B: &str = "G01 X0. Y0. F1000.\nG06.2 P4 K0. X0. Y0. R1.\nK0. X10. Y0. R1.\nK0. X30. Y24. R1.\n\
        K0. X60. Y0. R1.\nK30. X90. Y-24. R1.\nK60. X110. Y0. R1.\nK90. X120. Y0. R1.\n\
        K120.\nK120.\nK120.\nK120.\nG01 X130.\n";

    fn machine(text: &str) -> Machine {
        Machine::parse(text, SourceId::INPUT).unwrap()
    }

    fn read_with(text: &str, axes: &str) -> Result<Warned<Reading>, Diagnostics> {
        let machine = machine(&FLAT.replace("\"X\", \"Y\"", axes));
        read(text, SourceId::INPUT, &machine)
    }

    fn flat(text: &str) -> Result<Warned<Reading>, Diagnostics> {
        read_with(text, "\"X\", \"Y\"")
    }

    fn curve(reading: &Reading) -> Nurbs {
        let decimals = &reading.decimals;
        let mut curves = decimals.program.steps.iter().filter_map(|located| match &located.step {
            Step::Cut(cut) => match &cut.curve {
                Written::Nurbs(nurbs) => Some(crate::verify::to_nurbs(decimals, nurbs).unwrap()),
                Written::Lines(_) | Written::Polynomial(_) | Written::Through(..) => None,
            },
            Step::Comment(_) | Step::Tool(_) | Step::Spindle(_) | Step::Rapid(_) => None,
        });
        curves.next_back().unwrap()
    }

    /// The first problem, and the text that it points at.
    fn problem(text: &str) -> (&'static str, String) {
        let mut errors = flat(text).unwrap_err().0;
        errors.retain(|d| d.severity == Severity::Error);
        let span = errors[0].span.unwrap();
        assert_eq!(errors.len(), 1, "{errors:?}");
        (errors[0].id, text[span.start as usize..span.end as usize].to_owned())
    }

    #[test]
    fn a_cubic_bezier_on_a_straight_line() {
        let text = "G1 X0. Y0. Z0. F100.\nG06.2 P4 X0. Y0. Z0. K0.\nX10. Y10. Z10. K0.\nX20. Y20. Z20. K0.\n\
            X30. Y30. Z30. K0.\nK1.\nK1.\nK1.\nK1.\n";
        let curve = curve(&read_with(text, "\"X\", \"Y\", \"Z\"").unwrap().value);
        for t in [0.0, 0.25, 0.5, 1.0] {
            let at = curve.eval(t);
            assert!(at[..3].iter().all(|x| (x - 30.0 * t).abs() < 1.0e-12), "{at:?}");
        }
    }

    #[test]
    fn the_reference_curve() {
        let curve = curve(&flat(B).unwrap().value);
        let y = [0.0, 6.25, 14.0, 10.75, 0.0, -10.75, -14.0, -6.25, 0.0];
        for (i, y) in y.into_iter().enumerate() {
            let at = curve.eval(15.0 * i as f64);
            assert!((at[0] - 15.0 * i as f64).abs() < 1.0e-12 && (at[1] - y).abs() < 1.0e-12, "{at:?}");
        }
    }

    #[test]
    fn a_quarter_circle_of_order_three() {
        let text = "G01 X100. Y0. F1000.\nG06.2 P3 K0. X100. Y0. R1.\nK0. X100. Y100. R0.7071\nK0. X0. Y100. R1.\n\
            K1.\nK1.\nK1.\nG01 X0.\n";
        let curve = curve(&flat(text).unwrap().value);
        assert_eq!(curve.degree(), 2);
        for i in 0..=20 {
            let at = curve.eval(f64::from(i) / 20.0);
            // The reference gives 0.16 µm for four decimals of the weight.
            assert!(((at[0] * at[0] + at[1] * at[1]).sqrt() - 100.0).abs() < 0.2e-3, "{at:?}");
        }
    }

    #[test]
    fn the_order_may_be_missing_and_the_degree_may_stand_for_it() {
        let same = |text: &str| curve(&flat(text).unwrap().value) == curve(&flat(B).unwrap().value);
        assert!(same(&B.replace("P4 ", "")));
        assert!(same(&B.replace("G06.2", "G6.2").replace("120.", "120").replace("G01", "N7 G1")));
        let degree = B.replace("P4", "P3");
        assert!(same(&degree));
        let warnings = flat(&degree).unwrap().warnings;
        assert_eq!(warnings.0.iter().map(|d| d.id).collect::<Vec<_>>(), ["start-unknown", "order-is-degree"]);
    }

    #[test]
    fn what_is_wrong_with_a_curve_is_shown_at_its_place() {
        let with = |from: &str, to: &str| {
            assert!(B.contains(from));
            problem(&B.replacen(from, to, 1))
        };
        let is = |found: (&'static str, String), id: &str, place: &str| {
            assert_eq!((found.0, found.1.as_str()), (id, place));
        };
        is(with("K30. X90.", "X90."), "knot-missing", "X90. Y-24. R1.");
        is(with("K60.", "K20."), "knots-decrease", "K20.");
        is(with("K120.\nG01", "G01"), "closing-blocks", "K120.");
        is(with("K120.\nG01", "K120.\nK120.\nK120.\nG01"), "closing-blocks", "K120.");
        is(with("P4 K0. X0.", "P4 K0. X0.001"), "start-mismatch", "X");
        is(with("P4 K0. X0. Y0.", "P4 K0. X0."), "axis-not-in-first-block", "Y");
        is(with("P4 K0. X0. Y0. R1.", "P4 K0."), "first-point-missing", "G06.2 P4 K0.");
        is(with("P4", "P5"), "order-range", "P5");
        is(with("P4", "P4.5"), "order-range", "P4.5");
        is(with("K0. X30.", "K0. P4 X30."), "spline-word", "P4");
        is(with("R1.", "R0."), "weight-range", "R0.");
        is(with("K0. X30. Y24. R1.", "K0. X30. Y24. R1. F9."), "feed-in-spline", "F9.");
        is(with("G01 X130.", "X130. Y0."), "spline-ended", "X130. Y0.");
        is(with("K30. X90.", "K30. K30. X90."), "word-twice", "K30.");
        for (from, to, id) in [
            ("K120.\nG01", "K121.\nG01", "end-multiplicity"),
            ("K0. X60.", "K1. X60.", "end-multiplicity"),
            ("K30. X90. Y-24. R1.\nK60.", "K90. X90. Y-24. R1.\nK90.", "accepted"),
        ] {
            let text = B.replacen(from, to, 1);
            let errors = flat(&text).err().unwrap_or_default().0;
            let found = errors.iter().find(|d| d.severity == Severity::Error).map_or("accepted", |d| d.id);
            assert_eq!(found, id, "{text}");
        }
        assert_eq!(
            problem("G1 X0. Y0. F1.\nG06.2 P4 K0. X0. Y0.\nK0. X1. Y1.\nK1.\nK1.\nK1.\nK1.\n").0,
            "points-too-few"
        );
    }

    #[test]
    fn other_words_are_errors_at_their_place() {
        let is = |text: &str, id: &str, place: &str| {
            let found = problem(text);
            assert_eq!((found.0, found.1.as_str()), (id, place), "{text}");
        };
        for code in ["G91", "G20", "G93", "G95", "G41", "G42", "G2", "G03", "G61.2", "G43.4", "G28"] {
            is(&format!("G17 {code}\n"), "code-refused", code);
        }
        is("G1 X1. F0.\n", "feed-range", "F0.");
        is("G1 X1. W3.\n", "word-unknown", "W3.");
        is("G123 X1.\n", "word-unknown", "G123");
        is("G1 X1. X2.\n", "axis-twice", "X2.");
        is("G0 G1 X1.\n", "codes-conflict", "G1");
        is("X1.\n", "motion-missing", "X1.");
        is("G1 X1.23456\n", "digits-too-many", "X1.23456");
        is("G1 X1. K3.\n", "spline-word", "K3.");
        is("G1 X1. (open\n", "remark-open", "(open");
        is("G1 #100\n", "word-unreadable", "#100");
        is("/G1 X1.\n", "block-skip", "/G1");
        is("G05.1 Q2\n", "code-refused", "G05.1");
        is("G43 H1\n", "tool-offset", "G43");
        is("G54\nG55\n", "code-refused", "G55");
        is("X=PO\n", "word-unreadable", "X=PO");
        is("Q1=3.\n", "axis-unknown", "Q1=3.");
    }

    #[test]
    fn codes_that_say_what_is_so_anyway_are_read() {
        let text = "%\nO0012\nG17 G21 G40 G49 G54 G64 G69 G80 G90 G94\nG05 P2\nG61.1\nG05.1 Q1 ;\nG00 X1. (to the start)\n%\n";
        let reading = flat(text).unwrap().value;
        assert_eq!(reading.decimals.program.name, "O12");
        assert_eq!(reading.decimals.program.steps.len(), 1);
    }

    #[test]
    fn the_offset_of_a_tool_is_called_once_and_in_time() {
        let first = |rest: &str| {
            let text = format!("T4 M6\n{rest}");
            let errors = read_with(&text, "\"X\", \"Z\"").err().unwrap_or_default().0;
            errors.iter().find(|d| d.severity == Severity::Error).map_or("read", |d| d.id)
        };
        assert_eq!(first("G0 X3.\nG43 H4 Z5.\n"), "read");
        assert_eq!(first("G43 H4\nG1 X3. F2.\n"), "read");
        assert_eq!(first("G0 Z5.\n"), "tool-offset-missing");
        assert_eq!(first("G0 G43 H3 Z5.\n"), "tool-offset");
        assert_eq!(first("G0 G43 H4 Z5.\nG43 H4\n"), "tool-offset");
        assert_eq!(first("G1 X3. F2.\n"), "tool-offset-missing");
    }

    #[test]
    fn remarks_end_no_spline() {
        let text = "G0 X0. Y0.\nG06.1 X1. Y1. F5.\n(HERE)\nX2. Y0.\nG06.1 X3. Y1.\nG1\nG06.1 X4. Y0.\n";
        let steps = flat(text).unwrap().value.decimals.program.steps;
        let shown: Vec<String> = steps
            .iter()
            .map(|located| match &located.step {
                Step::Comment(text) => text.clone(),
                Step::Cut(cut) => match &cut.curve {
                    Written::Through(_, points) => points.count().to_string(),
                    Written::Lines(_) | Written::Polynomial(_) | Written::Nurbs(_) => "other".to_owned(),
                },
                Step::Tool(_) | Step::Spindle(_) | Step::Rapid(_) => "step".to_owned(),
            })
            .collect();
        assert_eq!(shown, ["step", "3", "HERE", "1"]);
    }
}
