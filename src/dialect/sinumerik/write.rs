//! Spells a legal program for Sinumerik.

use crate::decimal::{Decimal, Spelling, write_units};
use crate::dialect::arc;
use crate::dialect::modal::Modal;
use crate::dialect::parts::{Part, parts};
use crate::geom::arc::Plane;
use crate::ir::{
    ArcBy, COEFFICIENTS, Decimals, PolynomialBlock, ThroughKind, Units, Written, WrittenArc, WrittenNurbs,
    WrittenPoints, WrittenPolynomial,
};
use crate::machine::{FirstPoint, Machine, Turn};
use crate::pass::check::{Legal, moving};
use crate::units::Kind;

/// The names of the second point's coordinates (machine data 10646).
pub(super) const SECOND: [&str; 3] = ["XH", "YH", "ZH"];

/// The word of how the tool turns between two directions.
pub(super) fn turn_word(turn: Turn) -> &'static str {
    let [plane, evenly] = super::DIALECT.turn.unwrap_or_default();
    match turn {
        Turn::GreatCircle => plane,
        Turn::Tilt => evenly,
    }
}

/// The text of a program.
pub(super) fn write(legal: &Legal, machine: &Machine) -> String {
    let decimals = legal.decimals();
    let size = super::super::block::expected_size(decimals);
    let mut writer = Writer {
        modal: Modal::new(machine, size),
        decimals,
        upath: false,
        splinepath: Vec::new(),
        plane: None,
        second: false,
    };
    writer.program();
    String::from_utf8(writer.modal.out).unwrap_or_default()
}

/// Coefficients up to the last that is not zero.
fn used(coefficients: &[Decimal]) -> &[Decimal] {
    let count = coefficients.len() - coefficients.iter().rev().take_while(|a| a.is_zero()).count();
    &coefficients[..count]
}

struct Writer<'a> {
    modal: Modal<'a>,
    decimals: &'a Decimals,
    /// Whether UPATH is in force in this section.
    upath: bool,
    /// The axes of the SPLINEPATH in force in this section.
    splinepath: Vec<usize>,
    /// The plane that this section chose.
    plane: Option<Plane>,
    /// Whether a second curve leads the tool's direction, ORICURVE.
    second: bool,
}

impl Writer<'_> {
    /// A block of fixed words. It stands in X Y, so that the length of a tool that it calls counts along Z.
    fn block(&mut self, text: &str) {
        if self.plane.take_if(|plane| *plane != Plane::Xy).is_some() {
            self.modal.begin("N");
            self.modal.text(arc::plane_word(Plane::Xy));
            self.modal.end();
        }
        if self.modal.machine.text.number_comments || !text.starts_with(';') {
            self.modal.begin("N");
        }
        self.modal.text(text);
        self.modal.end();
    }

    /// Nothing holds any more.
    fn forget(&mut self) {
        self.modal.forget();
        self.plane = None;
        self.upath = false;
        self.splinepath.clear();
    }

    fn program(&mut self) {
        let (parts, feeds) = parts(self.decimals, self.modal.machine);
        self.modal.parameters(&feeds);
        for part in parts {
            match part {
                Part::Fixed(line) => {
                    // A second curve leads the tool between splines only.
                    self.lead(false);
                    self.block(&line);
                }
                // A program can be restarted at each tool.
                Part::Tool(..) => self.forget(),
                Part::Spindle | Part::LengthEnd => {}
                // The machine's own lines say how the tool turns.
                Part::TipControl(led) => {
                    if !led && self.modal.machine.frame.tip_end_parks {
                        self.forget();
                    }
                    self.second = false;
                }
                Part::Plane => self.forget(),
                Part::Home(axis) => {
                    self.modal.lose(axis);
                    self.modal.motion = None;
                }
                Part::Shift(shifts) => self.modal.shift(shifts),
                Part::Remark(text) => self.block(&format!("; {text}")),
                Part::Comment(text) => {
                    self.block(&format!("; {text}"));
                    self.forget();
                }
                Part::Body => self.forget(),
                Part::Rapid(targets) => self.rapid(targets),
                Part::Cut(cut) => match &cut.curve {
                    Written::Lines(points) => self.lines(points, cut.feed),
                    Written::Arc(arc) => self.arc(arc, cut.feed),
                    Written::Polynomial(polynomial) => self.polynomial(polynomial, &cut.curve, cut.feed),
                    Written::Nurbs(nurbs) => self.nurbs(nurbs, &cut.curve, cut.feed),
                    Written::Through(kind, points) => self.through(*kind, points, &cut.curve, cut.feed),
                },
            }
        }
    }

    fn rapid(&mut self, targets: &[(usize, Decimal)]) {
        self.lead(false);
        self.modal.begin("N");
        self.modal.motion("G0");
        self.modal.targets(targets);
        self.modal.end();
    }

    /// ORICURVE, where a second curve is to lead the tool's direction, or the word that ends it.
    fn lead(&mut self, second: bool) {
        if self.second != second {
            self.block(if second { "ORICURVE" } else { turn_word(self.modal.machine.orientation.turn) });
            self.second = second;
        }
    }

    /// Where a curve moves the tool's direction its second curve starts at a place of its own, which a straight block
    /// states. Whether the curve does.
    fn second_curve(&mut self, moved: &[usize], start: &Units, feed: Option<Decimal>) -> bool {
        let Some(first) = self.modal.direction.filter(|first| moved.iter().any(|i| first <= i)) else {
            self.lead(false);
            return false;
        };
        let known = (first..first + 3).all(|i| self.modal.position[i] == Some(start[i]));
        if !(self.second && known) {
            self.lead(true);
            self.modal.begin("N");
            self.modal.motion("G1");
            self.modal.axes(&[0, 1, 2], start);
            self.second_point(first, start);
            self.modal.feed(feed);
            self.modal.reached(start);
            self.modal.end();
        }
        true
    }

    /// A coordinate of the second point, as the text counts it: the tip's and the direction's.
    fn second(&self, first: usize, i: usize, point: &Units) -> Decimal {
        let digits = &self.decimals.digits;
        let tip = Decimal::new(self.modal.counted(i, point[i]), digits[i]);
        let along = Decimal::new(self.modal.counted(first + i, point[first + i]), digits[first + i]);
        // Both have at most nine decimals and are below a million.
        tip.plus(along).unwrap_or(tip)
    }

    /// `XH= YH= ZH=`
    fn second_point(&mut self, first: usize, point: &Units) {
        for (i, name) in SECOND.into_iter().enumerate() {
            self.modal.text(name);
            self.modal.out.push(b'=');
            self.second(first, i, point).write(&mut self.modal.out, self.modal.spelling);
            self.modal.gap();
        }
    }

    fn lines(&mut self, points: &WrittenPoints, feed: Option<Decimal>) {
        self.lead(false);
        self.modal.lines(points);
        for point in points.units.chunks_exact(points.stride) {
            self.modal.begin("N");
            self.modal.motion("G1");
            self.modal.moved_axes(point);
            self.modal.feed(feed);
            self.modal.reached(point);
            self.modal.end();
        }
        self.modal.lines_end();
    }

    fn arc(&mut self, arc: &WrittenArc, feed: Option<Decimal>) {
        self.lead(false);
        match arc.by {
            ArcBy::Center(circle, turns) => {
                arc::write(&mut self.modal, arc, (circle, turns), feed, &mut self.plane);
            }
            ArcBy::Way(way) => self.arc_by(arc, &way, feed),
            // The dialect does not ask for it, so that `quantise` makes none.
            ArcBy::Turn(..) => {}
        }
    }

    /// CIP: the end, and a place on the way. AC states it from zero, whatever G90 and G91 do to it.
    fn arc_by(&mut self, arc: &WrittenArc, way: &Units, feed: Option<Decimal>) {
        self.modal.begin("N");
        self.modal.motion("CIP");
        for i in 0..self.modal.direction.unwrap_or(self.modal.machine.axes.count()) {
            // Of X Y Z those of the plane.
            let rests = i < 3 && way[i] == arc.start[i] && arc.end[i] == arc.start[i];
            if (i < 3 && !rests) || self.modal.position[i] != Some(arc.end[i]) {
                self.modal.axis(i, arc.end[i]);
            }
        }
        let spelling = self.modal.spelling;
        for (i, name) in ["I1", "J1", "K1"].into_iter().enumerate() {
            self.modal.text(name);
            self.modal.text("=AC(");
            let place = self.modal.counted(i, way[i]);
            write_units(&mut self.modal.out, place, self.decimals.digits[i], spelling);
            self.modal.text(") ");
        }
        self.modal.directions(&arc.end);
        self.modal.feed(feed);
        self.modal.reached(&arc.end);
        self.modal.end();
    }

    /// UPATH, where a rotary axis moves; SPLINEPATH, where a spline group is to have it.
    fn path_reference(&mut self, curve: &Written, spline: bool) {
        let moved = moving(curve);
        let axes = self.modal.machine.axes;
        if !moved.iter().any(|i| axes.kind(*i) == Kind::Rotary) {
            return;
        }
        if self.modal.machine.spline.shared_parameter && !self.upath {
            self.block("UPATH");
            self.upath = true;
        }
        if spline && self.splinepath != moved {
            let names: Vec<String> = moved.iter().map(|i| axes.name(*i).to_string()).collect();
            self.block(&format!("SPLINEPATH(1,{})", names.join(",")));
            self.splinepath = moved;
        }
    }

    /// a₂ and so on, behind the end.
    fn coefficients(&mut self, coefficients: &[Decimal]) {
        for a in coefficients {
            self.modal.out.push(b',');
            a.write(&mut self.modal.out, self.modal.spelling);
        }
        self.modal.text(") ");
    }

    fn polynomial(&mut self, polynomial: &WrittenPolynomial, curve: &Written, feed: Option<Decimal>) {
        self.path_reference(curve, false);
        let mut moved = moving(curve);
        let second = self.second_curve(&moved, &polynomial.start, feed);
        let first = self.modal.direction.filter(|_| second);
        moved.retain(|i| self.modal.direction.is_none_or(|first| *i < first));
        for block in &polynomial.blocks {
            self.modal.begin("N");
            self.modal.motion("POLY");
            for &i in &moved {
                let coefficients = used(&block.coefficients[i]);
                let divided = block.denominator.is_some_and(|denominator| denominator.divides[i]);
                if coefficients.is_empty() && !divided {
                    // An axis that rests is left out, whatever it does in other blocks of the run, which may be read as one
                    // run with the next curve's.
                    if self.modal.position[i] != Some(block.end[i]) {
                        self.modal.axis(i, block.end[i]);
                    }
                    continue;
                }
                let name = self.modal.machine.axes.name(i);
                self.modal.text("PO[");
                self.modal.text(name.as_str());
                self.modal.text("]=(");
                let spelling = self.modal.spelling;
                let end = self.modal.counted(i, block.end[i]);
                write_units(&mut self.modal.out, end, self.decimals.digits[i], spelling);
                let counted: Vec<Decimal> =
                    coefficients.iter().map(|a| self.modal.coefficient(i, *a)).collect();
                self.coefficients(&counted);
            }
            if let Some(first) = first {
                self.second_polynomial(first, block);
            }
            if let Some(denominator) = &block.denominator {
                self.modal.text("PO[]=(");
                denominator.end.write(&mut self.modal.out, self.modal.spelling);
                self.coefficients(used(&denominator.coefficients));
            }
            self.modal.text("PL=");
            block.pl.write(&mut self.modal.out, Spelling::PLAIN);
            self.modal.gap();
            self.modal.feed(feed);
            self.modal.reached(&block.end);
            self.modal.end();
        }
    }

    /// `PO[XH]=(…)` and so on: end and coefficients of the tip's and the direction's added.
    fn second_polynomial(&mut self, first: usize, block: &PolynomialBlock) {
        for (i, name) in SECOND.into_iter().enumerate() {
            let sum: Vec<Decimal> = (0..COEFFICIENTS)
                .map(|k| {
                    let own = |axis: usize| self.modal.coefficient(axis, block.coefficients[axis][k]);
                    own(i).plus(own(first + i)).unwrap_or_default()
                })
                .collect();
            self.modal.text("PO[");
            self.modal.text(name);
            self.modal.text("]=(");
            self.second(first, i, &block.end).write(&mut self.modal.out, self.modal.spelling);
            self.coefficients(used(&sum));
        }
    }

    fn nurbs(&mut self, nurbs: &WrittenNurbs, curve: &Written, feed: Option<Decimal>) {
        self.path_reference(curve, true);
        let mut moved = moving(curve);
        let second = self.second_curve(&moved, &nurbs.points[0], feed);
        let turned = self.modal.direction.filter(|_| second);
        moved.retain(|i| self.modal.direction.is_none_or(|first| *i < first));
        // A spline starts anew: two in a row would else be one.
        self.modal.motion = None;
        let first = match self.modal.machine.spline.first_point {
            FirstPoint::Before => 1,
            FirstPoint::Repeated => 0,
        };
        for (j, point) in nurbs.points.iter().enumerate().skip(first) {
            self.modal.begin("N");
            if j == first {
                self.modal.motion("BSPLINE");
                self.modal.text("SD=");
                self.modal.text(itoa::Buffer::new().format(nurbs.degree));
                self.modal.gap();
            }
            self.modal.axes(&moved, point);
            if let Some(first) = turned {
                self.second_point(first, point);
            }
            self.modal.text("PL=");
            let distance = nurbs.knots[j + 2] - nurbs.knots[j + 1];
            write_units(&mut self.modal.out, distance, nurbs.knot_digits, Spelling::PLAIN);
            self.modal.gap();
            if let Some(weights) = &nurbs.weights {
                self.modal.text("PW=");
                weights[j].write(&mut self.modal.out, Spelling::PLAIN);
                self.modal.gap();
            }
            self.modal.feed(feed);
            self.modal.reached(point);
            self.modal.end();
        }
    }

    fn through(&mut self, kind: ThroughKind, points: &WrittenPoints, curve: &Written, feed: Option<Decimal>) {
        self.path_reference(curve, true);
        let moved = moving(curve);
        let word = match kind {
            ThroughKind::Akima | ThroughKind::Fine => "ASPLINE",
            ThroughKind::Cubic => "CSPLINE",
        };
        self.modal.motion = None;
        for (j, point) in points.points().enumerate() {
            self.modal.begin("N");
            if j == 0 {
                self.modal.motion(word);
                let spline = &self.modal.machine.spline;
                let ends = format!("{} {} ", spline.begin, spline.end);
                self.modal.text(&ends);
            }
            self.modal.axes(&moved, &point);
            self.modal.feed(feed);
            self.modal.reached(&point);
            self.modal.end();
        }
    }
}
