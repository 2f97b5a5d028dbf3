//! Spells a legal program for ISO controls.

use super::{Offset, is_block, register};
use crate::decimal::{Decimal, write_units};
use crate::dialect::arc;
use crate::dialect::block::expected_size;
use crate::dialect::modal::Modal;
use crate::dialect::parts::{Part, ToolLines, parts};
use crate::geom::arc::Plane;
use crate::ir::{Decimals, Written, WrittenNurbs, WrittenPoints};
use crate::machine::Machine;
use crate::pass::check::{Legal, moving};
use crate::units::Axis;

/// The text of a program.
pub(super) fn write(legal: &Legal, machine: &Machine) -> String {
    let decimals = legal.decimals();
    let offset = Offset::new(machine);
    let mut writer = Writer {
        modal: Modal::new(&offset.machine, expected_size(decimals)),
        decimals,
        z: Axis::new("Z").and_then(|z| machine.axes.index_of(z)),
        offset: &offset,
        offset_due: None,
        offset_again: None,
        offset_tool: None,
        led: false,
        through: false,
        plane: None,
    };
    writer.program();
    String::from_utf8(writer.modal.out).unwrap_or_default()
}

struct Writer<'a> {
    modal: Modal<'a>,
    decimals: &'a Decimals,
    /// Which axis is Z.
    z: Option<usize>,
    offset: &'a Offset,
    /// The register of the length that is still to be called.
    offset_due: Option<String>,
    /// The register of the length that is in force, and which this section calls again with its first rapid of Z.
    offset_again: Option<String>,
    /// The register of the length that each section calls.
    offset_tool: Option<String>,
    /// Whether the tip of the tool is led.
    led: bool,
    /// Whether the last motion is G06.1, which a comment does not end.
    through: bool,
    /// The plane that this section chose.
    plane: Option<Plane>,
}

impl Writer<'_> {
    /// Leaves another plane than X Y, so that a length of a tool that is called from here on counts along Z.
    fn leave_plane(&mut self) {
        if self.plane.take_if(|plane| *plane != Plane::Xy).is_some() {
            self.modal.begin("N");
            self.modal.text(arc::plane_word(Plane::Xy));
            self.modal.end();
        }
    }

    /// A line of fixed words. It stands in X Y.
    fn line(&mut self, text: &str) {
        self.leave_plane();
        // What follows may be the end, or another section, which count F a minute.
        if self.modal.is_timed() {
            self.modal.begin("N");
            self.modal.inverse(false);
            self.modal.end();
        }
        if is_block(text) || (text.starts_with('(') && self.modal.machine.text.number_comments) {
            self.modal.begin("N");
        }
        self.modal.text(text);
        self.modal.end();
    }

    fn program(&mut self) {
        let (parts, feeds) = parts(self.decimals, self.modal.machine);
        self.modal.parameters(&feeds);
        for part in parts {
            match &part {
                Part::Fixed(line) => self.line(line),
                Part::Tool(call, lines) => {
                    let called = match lines {
                        ToolLines::WithSpindle => &self.offset.tool_spindle,
                        ToolLines::Alone => &self.offset.tool,
                    };
                    // A program can be restarted at each tool.
                    self.leave_plane();
                    self.modal.forget();
                    self.plane = None;
                    self.offset_tool = called.as_ref().map(|called| register(called, *call));
                    self.offset_due.clone_from(&self.offset_tool);
                }
                Part::Spindle => {}
                // The lines that lead the tip hold the length of the tool.
                Part::TipControl(true) => {
                    (self.offset_due, self.offset_again) = (None, None);
                    self.led = true;
                }
                Part::TipControl(false) => {
                    self.led = false;
                    self.offset_due.clone_from(&self.offset_tool);
                    if self.modal.machine.frame.tip_end_parks {
                        self.modal.forget();
                    }
                }
                Part::LengthEnd => self.offset_due.clone_from(&self.offset_tool),
                Part::Plane => {
                    self.leave_plane();
                    self.modal.forget();
                    self.plane = None;
                }
                Part::Home(axis) => {
                    self.modal.lose(*axis);
                    self.modal.motion = None;
                    self.offset_due = self.offset_tool.clone().filter(|_| !self.led);
                }
                Part::Shift(shifts) => self.modal.shift(shifts),
                Part::Remark(text) => self.line(&format!("({text})")),
                Part::Comment(text) => {
                    self.line(&format!("({text})"));
                    self.modal.forget();
                    self.plane = None;
                    self.offset_again = self.offset_tool.clone().filter(|_| !self.led);
                }
                Part::Body => {
                    self.modal.forget();
                    self.offset_again = self.offset_tool.clone().filter(|_| !self.led);
                }
                Part::Rapid(targets) => self.rapid(targets),
                Part::Cut(cut) => {
                    // A section that starts with a cut goes on with what is in force.
                    self.offset_again = None;
                    self.offset_before(&cut.curve);
                    match &cut.curve {
                        Written::Lines(points) => self.lines(points, cut.feed),
                        // The dialect asks for nothing but centres.
                        Written::Arc(arc) => {
                            if let Some(circle) = arc::stated_circle(arc) {
                                arc::write(&mut self.modal, arc, circle, cut.feed, &mut self.plane);
                            }
                        }
                        Written::Nurbs(nurbs) => self.nurbs(nurbs, &cut.curve, cut.feed),
                        Written::Through(_, points) => self.through(points, &cut.curve, cut.feed),
                        // No motion of these dialects has this form, so `convert` leaves none.
                        Written::Polynomial(_) => {}
                    }
                }
            }
            self.through = match &part {
                Part::Comment(_)
                | Part::Remark(_)
                | Part::Fixed(_)
                | Part::Shift(_)
                | Part::Body
                | Part::Plane
                | Part::LengthEnd
                | Part::TipControl(_) => self.through,
                Part::Tool(..) | Part::Spindle | Part::Home(_) | Part::Rapid(_) => false,
                Part::Cut(cut) => matches!(cut.curve, Written::Through(..)),
            };
        }
    }

    fn knot(&mut self, nurbs: &WrittenNurbs, units: i64) {
        self.modal.out.push(b'K');
        write_units(&mut self.modal.out, units, nurbs.knot_digits, self.modal.spelling);
        self.modal.gap();
    }

    fn rapid(&mut self, targets: &[(usize, Decimal)]) {
        self.modal.begin("N");
        self.modal.motion("G0");
        if self.modal.is_timed() {
            self.modal.inverse(false);
        }
        if targets.iter().any(|(axis, _)| Some(*axis) == self.z) {
            let again = self.offset_again.take();
            if let Some(register) = self.offset_due.take().or(again) {
                self.modal.text(&format!("G43 H{register} "));
            }
        }
        self.modal.targets(targets);
        self.modal.end();
    }

    /// Calls a length that is due: in the first line where that names Z, otherwise in a block of its own.
    fn offset_before(&mut self, curve: &Written) {
        let Some(register) = self.offset_due.clone() else { return };
        let names_z = |points: &WrittenPoints| {
            let mut ends = points.points();
            self.z.zip(ends.next()).is_some_and(|(z, end)| self.modal.position[z] != Some(end[z]))
        };
        let waits = match curve {
            Written::Lines(points) => names_z(points),
            Written::Arc(_) | Written::Nurbs(_) | Written::Through(..) | Written::Polynomial(_) => false,
        };
        if !waits {
            self.offset_due = None;
            self.line(&format!("G43 H{register}"));
        }
    }

    fn lines(&mut self, points: &WrittenPoints, feed: Option<Decimal>) {
        self.modal.lines(points);
        for (i, point) in points.units.chunks_exact(points.stride).enumerate() {
            let rate = points.rates.get(i);
            self.modal.begin("N");
            self.modal.motion("G1");
            if i == 0
                && let Some(register) = self.offset_due.take()
            {
                self.modal.text(&format!("G43 H{register} "));
            }
            self.modal.inverse(rate.is_some());
            self.modal.moved_axes(point);
            match rate {
                Some(rate) => self.modal.rate(*rate),
                None => self.modal.feed(feed),
            }
            self.modal.reached(point);
            self.modal.end();
        }
        self.modal.lines_end();
    }

    /// The axes that a curve moves; the first where it moves none, since a block needs one.
    fn named(curve: &Written) -> Vec<usize> {
        let moved = moving(curve);
        if moved.is_empty() { vec![0] } else { moved }
    }

    fn nurbs(&mut self, nurbs: &WrittenNurbs, curve: &Written, feed: Option<Decimal>) {
        let named = Self::named(curve);
        // Each curve has its own word, though the one before leaves it in force.
        self.modal.motion = None;
        for (i, (point, knot)) in nurbs.points.iter().zip(&nurbs.knots).enumerate() {
            self.modal.begin("N");
            if i == 0 {
                self.modal.motion("G06.2");
                self.modal.inverse(false);
                self.modal.out.push(b'P');
                self.modal.text(itoa::Buffer::new().format(nurbs.degree + 1));
                self.modal.gap();
            }
            self.knot(nurbs, *knot);
            self.modal.axes(&named, point);
            if let Some(weight) = nurbs.weights.as_ref().and_then(|weights| weights.get(i)) {
                self.modal.out.push(b'R');
                weight.write(&mut self.modal.out, self.modal.spelling);
                self.modal.gap();
            }
            self.modal.feed(feed);
            self.modal.reached(point);
            self.modal.end();
        }
        for knot in nurbs.knots.iter().skip(nurbs.points.len()) {
            self.modal.begin("N");
            self.knot(nurbs, *knot);
            self.modal.end();
        }
    }

    fn through(&mut self, points: &WrittenPoints, curve: &Written, feed: Option<Decimal>) {
        let named = Self::named(curve);
        // Points after points would go on with the same spline; another code of the group ends it.
        if self.through {
            self.line("G1");
            self.modal.motion = None;
        }
        for point in points.points() {
            self.modal.begin("N");
            self.modal.motion("G06.1");
            self.modal.inverse(false);
            self.modal.axes(&named, &point);
            self.modal.feed(feed);
            self.modal.reached(&point);
            self.modal.end();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostic::Severity;
    use crate::pass::check::check;
    use crate::source::{Source, SourceId, Sources};
    use crate::verify::Status;
    use crate::{Failure, Options, Output};
    use proptest::prelude::*;

    const PAPER: &str = "name = \"CONE10\"\nnumber = 1\n[cutter]\nD1 = 10\nS = 30\nC = 5\nr = 8\nlength = 30\nflutes = 2\n\
        [process]\nfeed = 200\nspindle = 3000\nretract = { axis = \"Z\", to = 50 }\n";

    fn machine(text: &str) -> Machine {
        Machine::parse(text, SourceId::INPUT).unwrap()
    }

    /// The machine as built in, and one whose splines move A.
    fn with_a() -> Machine {
        machine(
            "extends = \"mazak\"\n[feed]\nrotary = \"free\"\n[spline]\naxes = [\"X\", \"Y\", \"Z\", \"A\"]\n",
        )
    }

    fn compile(input: &str, machine: &Machine, motion: Option<&str>) -> Result<Output, Failure> {
        let source = Source::new("cutter.toml", input);
        let language = crate::front::detect(&source).unwrap();
        let motion = motion.map(|name| machine.dialect.motion(name).unwrap());
        crate::compile(&Sources::new(source), language, machine, &Options { motion, ..Options::default() })
    }

    fn warnings(output: &Output) -> Vec<&'static str> {
        assert!(output.warnings.0.iter().all(|d| d.severity == Severity::Warning));
        output.warnings.0.iter().map(|d| d.id).collect()
    }

    /// `write(check(read(text)))`
    fn again(text: &str, machine: &Machine) -> String {
        let reading = (machine.dialect.read)(text, SourceId::PROGRAM, machine).unwrap().value;
        assert!(reading.header && reading.footer && reading.misnumbered.is_none());
        write(&check(reading.decimals, machine).unwrap().value, machine)
    }

    #[test]
    fn where_splines_do_not_move_a_the_paper_is_lines() {
        let built_in = Machine::built_in("mazak").unwrap();
        let output = compile(PAPER, &built_in, None).unwrap();
        assert_eq!((output.motion.name, output.report.unwrap().status), ("linear", Status::Proved));
        assert!(warnings(&compile(PAPER, &built_in, None).unwrap()).contains(&"spline-axes"));
        assert_eq!(again(&output.text, &built_in), output.text);
    }

    #[test]
    fn a_motion_that_was_asked_for_is_written_with_a_warning() {
        let built_in = Machine::built_in("mazak").unwrap();
        for (motion, status) in [("g06.2", Status::Proved), ("g06.1", Status::PointsOnly)] {
            let output = compile(PAPER, &built_in, Some(motion)).unwrap();
            assert_eq!(output.report.as_ref().unwrap().status, status, "{motion}");
            assert!(warnings(&output).contains(&"spline-axes"), "{motion}");
            assert_eq!(again(&output.text, &built_in), output.text);
        }
    }

    #[test]
    fn one_span_holds_the_paper() {
        let machine = Machine { tolerance: 0.0002, ..with_a() };
        let output = compile(PAPER, &machine, None).unwrap();
        assert_eq!(output.motion.name, "g06.2");
        assert!(warnings(&output).is_empty());
        assert_eq!(again(&output.text, &machine), output.text);
        let curve: Vec<&str> = output
            .text
            .lines()
            .skip_while(|line| !line.starts_with("G06.2"))
            .take_while(|line| !line.starts_with("G0 "))
            .collect();
        assert_eq!(curve.len(), 8);
        assert_eq!(curve[0], "G06.2 P4 K0. X0. Y0. Z0. A0.");
        assert!(curve[1..4].iter().all(|line| line.starts_with("K0. X") && line.contains(" A")), "{curve:?}");
        assert!(curve[4..].iter().all(|line| *line == curve[4] && line.split(' ').count() == 1), "{curve:?}");
        assert!(
            output
                .text
                .contains("\nT1 M6\nS3000 M3\nG0 X0.\nY0.\n(FLUTE 1 OF 2, A 0)\nG0 G43 H1 Z50.\nX0.\n"),
            "{}",
            output.text
        );
    }

    #[test]
    fn numbers_stand_before_blocks_only() {
        let machine = machine("extends = \"mazak\"\n[text]\nnumber_start = 1\nnumber_step = 2\n");
        let output = compile(PAPER, &machine, Some("linear")).unwrap();
        assert!(output.text.starts_with("%\nO0001\n(CONE10)\nN1 G17 "), "{}", &output.text[..60]);
        assert_eq!(again(&output.text, &machine), output.text);
    }

    #[test]
    fn cutters_of_every_kind() {
        let change = |changes: &[(&str, &str)]| {
            changes.iter().fold(PAPER.to_owned(), |text, (from, to)| {
                assert!(text.contains(from));
                text.replacen(from, to, 1)
            })
        };
        let inputs = [
            change(&[("C = 5", "C = 0")]),
            change(&[("S = 30", "S = 0")]),
            change(&[("C = 5", "C = -5")]),
            change(&[("S = 30", "S = 60")]),
            change(&[("length = 30", "length = 200")]),
            change(&[("flutes = 2", "flutes = 2\nhand = \"left\"")]),
            change(&[("D1 = 10", "D1 = 0.5"), ("length = 30", "length = 5")]),
        ];
        let machine = with_a();
        for input in &inputs {
            for motion in [None, Some("g06.2"), Some("g06.1"), Some("linear")] {
                let output = compile(input, &machine, motion).unwrap_or_else(|failure| {
                    panic!(
                        "{input} {motion:?}: {:?}\n{}",
                        failure.diagnostics,
                        failure.program.map_or(String::new(), |p| p.text)
                    )
                });
                let expected = if motion == Some("g06.1") { Status::PointsOnly } else { Status::Proved };
                assert_eq!(output.report.unwrap().status, expected, "{input} {motion:?}");
                assert_eq!(again(&output.text, &machine), output.text, "{input} {motion:?}");
            }
        }
    }

    #[test]
    fn curves_in_a_row_stay_apart() {
        let machine =
            machine("extends = \"mazak\"\n[program]\nheader = [\"({name})\"]\nfooter = []\nclose = []\n");
        let machine = machine.with_axes(&crate::units::Axes::xyza()).unwrap();
        let text = "(ROW)\nG0 X0. Y0. Z0. A0.\nG06.2 P3 K0. X0. Y0. R1. F9.\nK0. X1. Y0. R0.7071\nK0. X1. Y1. R1.\nK1.\nK1.\nK1.\n\
            G06.2 P2 K0. X1. Y1.\nK0. X5. Y2.\nK1.5\nK1.5\nG06.1 X6. Y3.\nX7. Y1.\n(NEXT)\nG1\nG06.1 X8. Y2. F9.\nX9. Y2.\n\
            G1 X10.\nF8.\nX11.\n";
        // A feed of its own, and X10. after a comment forgot where Y is: neither is our spelling.
        let ours = text.replace("X10.\nF8.\nX11.", "X10.\nX11. F8.");
        assert_eq!(again(text, &machine), ours);
        assert_eq!(again(&ours, &machine), ours);
    }

    #[test]
    fn names_stay_within_their_comment() {
        let (_, allowed) = crate::dialect::iso::MAZAK.naming;
        assert!(allowed("CONE 10, R8") && allowed(&"N".repeat(32)));
        for name in ["", "A(1", "A)", "50%", "Ä", "A\nB", " A", &"N".repeat(33)] {
            assert!(!allowed(name), "{name}");
        }
    }

    proptest! {
        #[test]
        fn no_text_is_too_strange(text in "[GXYZAKRPFHOQN0-9.()=/% ;\\-\n]{0,200}|\\PC{0,80}") {
            let machine = machine("extends = \"mazak\"\n[program]\nheader = []\nfooter = []\nclose = []\n");
            let _ = (machine.dialect.read)(&text, SourceId::INPUT, &machine);
        }

        #[test]
        fn what_reads_is_written_to_a_fixed_point(words in proptest::collection::vec(
            proptest::sample::select(vec![
                "G0 X1. Y2.\n", "G0 Z5.\n", "G1 X3. F7.\n", "X4.5 A10.\n", "G1 F9.5\n", "(REMARK)\n", "T3 M6\nS100 M3\nG0 G43 H3 Z9.\n",
                "G06.1 X1. Y1.\n", "X2. Y2.\n", "G1\n", "G0 X0. Y0. Z0. A0.\nG06.2 P2 K0. X0. A0.\nK0. X3. A5.\nK3.\nK3.\n",
                "G0 X0.\nG06.2 K0. X0. R2.\nK0. X1.\nK0. X2. R3.\nK0. X3.\nK1. X4.\nK2.\nK2.\nK2.\nK2.\nG1\n",
            ]), 0..20)) {
            let machine = machine("extends = \"mazak\"\n[axis.A]\nkind = \"linear\"\n[program]\nheader = []\nfooter = []\nclose = []\n");
            let start = "G0 X0. Y0. Z0. A0.\nG1 F5.\n";
            let text = format!("(START)\n{start}{}", words.concat());
            if let Ok(reading) = (machine.dialect.read)(&text, SourceId::INPUT, &machine) {
                // The program has no name to be checked here.
                let mut decimals = reading.value.decimals;
                decimals.program.name = "N".to_owned();
                let written = write(&check(decimals.clone(), &machine).unwrap().value, &machine);
                let mut reread = (machine.dialect.read)(&written, SourceId::INPUT, &machine).unwrap().value.decimals;
                reread.program.name = "N".to_owned();
                prop_assert_eq!(write(&check(reread, &machine).unwrap().value, &machine), written);
            }
        }
    }
}
