//! Spells a legal program for Sinumerik.

use crate::decimal::{Decimal, Spelling, write_units};
use crate::dialect::modal::Modal;
use crate::ir::{
    Decimals, Step, ThroughKind, Units, Written, WrittenNurbs, WrittenPoints, WrittenPolynomial,
};
use crate::machine::Machine;
use crate::pass::check::{Legal, moving};
use crate::units::Kind;

/// The text of a program.
pub(super) fn write(legal: &Legal, machine: &Machine) -> String {
    let decimals = legal.decimals();
    let size = super::super::block::expected_size(decimals);
    let mut writer =
        Writer { modal: Modal::new(machine, size), decimals, upath: false, splinepath: Vec::new() };
    writer.program();
    String::from_utf8(writer.modal.out).unwrap_or_default()
}

struct Writer<'a> {
    modal: Modal<'a>,
    decimals: &'a Decimals,
    /// Whether UPATH is in force in this section.
    upath: bool,
    /// The axes of the SPLINEPATH in force in this section.
    splinepath: Vec<usize>,
}

impl Writer<'_> {
    fn spelling(&self) -> Spelling {
        let text = &self.modal.machine.text;
        Spelling { point_always: text.point_always, sign_always: text.sign_always }
    }

    fn begin(&mut self) {
        if let Some(number) = self.modal.take_number() {
            self.modal.out.push(b'N');
            self.modal.text(itoa::Buffer::new().format(number));
            self.modal.out.push(b' ');
        }
    }

    /// A block of fixed words; a comment has no number.
    fn block(&mut self, text: &str) {
        if !text.starts_with(';') {
            self.begin();
        }
        self.modal.text(text);
        self.modal.end();
    }

    fn program(&mut self) {
        let machine = self.modal.machine;
        let program = &self.decimals.program;
        for line in &machine.frame.header {
            self.block(&line.fill(&[("name", &program.name)]));
        }
        let mut at = 0;
        while let Some(located) = program.steps.get(at) {
            let next = program.steps.get(at + 1).map(|located| &located.step);
            let (lines, covered) = self.modal.frame_lines(&located.step, next);
            for line in lines {
                self.block(&line);
            }
            at += covered;
            match &located.step {
                Step::Tool(_) | Step::Spindle(_) => {}
                Step::Comment(text) => {
                    self.block(&format!("; {text}"));
                    self.modal.forget();
                    self.upath = false;
                    self.splinepath.clear();
                }
                Step::Rapid(targets) => self.rapid(targets),
                Step::Cut(cut) => {
                    let feed = cut.feed;
                    match &cut.curve {
                        Written::Lines(points) => self.lines(points, feed),
                        Written::Polynomial(polynomial) => self.polynomial(polynomial, &cut.curve, feed),
                        Written::Nurbs(nurbs) => self.nurbs(nurbs, &cut.curve, feed),
                        Written::Through(kind, points) => self.through(*kind, points, &cut.curve, feed),
                    }
                }
            }
        }
        for line in &machine.frame.footer {
            self.block(&line.fill(&[("name", &program.name)]));
        }
    }

    /// The motion word, where it is not in force.
    fn motion(&mut self, word: &'static str) {
        if self.modal.motion != Some(word) {
            self.modal.text(word);
            self.modal.out.push(b' ');
            self.modal.motion = Some(word);
        }
    }

    fn feed(&mut self, feed: Option<Decimal>) {
        if let Some(value) = feed
            && self.modal.feed != feed
        {
            let spelling = self.spelling();
            self.modal.out.push(b'F');
            value.write(&mut self.modal.out, spelling);
            self.modal.out.push(b' ');
            self.modal.feed = feed;
        }
    }

    #[inline]
    fn axis(&mut self, i: usize, units: i64) {
        let name = self.modal.machine.axes.name(i);
        self.modal.text(name.as_str());
        // `=` is required after a name of more than one letter.
        if 1 < name.as_str().len() {
            self.modal.out.push(b'=');
        }
        let spelling = self.spelling();
        write_units(&mut self.modal.out, units, self.decimals.digits[i], spelling);
        self.modal.out.push(b' ');
    }

    fn rapid(&mut self, targets: &[(usize, Decimal)]) {
        self.begin();
        self.motion("G0");
        for (axis, to) in targets {
            let units = to.units(self.decimals.digits[*axis]).unwrap_or_default();
            self.axis(*axis, units);
            self.modal.position[*axis] = Some(units);
        }
        self.modal.end();
    }

    fn lines(&mut self, points: &WrittenPoints, feed: Option<Decimal>) {
        for point in points.points() {
            self.begin();
            self.motion("G1");
            let mut moved = false;
            for i in 0..points.stride {
                if self.modal.moves(i, &point) {
                    self.axis(i, point[i]);
                    moved = true;
                }
            }
            if !moved {
                self.axis(0, point[0]);
            }
            self.feed(feed);
            self.modal.reached(&point);
            self.modal.end();
        }
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

    /// Words for a control point: every axis that the curve moves, on every block.
    fn point(&mut self, point: &Units, moved: &[usize]) {
        for i in moved {
            self.axis(*i, point[*i]);
        }
    }

    fn polynomial(&mut self, polynomial: &WrittenPolynomial, curve: &Written, feed: Option<Decimal>) {
        self.path_reference(curve, false);
        let moved = moving(curve);
        for block in &polynomial.blocks {
            self.begin();
            self.motion("POLY");
            for &i in &moved {
                let coefficients = &block.coefficients[i];
                let count =
                    coefficients.len() - coefficients.iter().rev().take_while(|a| a.is_zero()).count();
                if count == 0 {
                    self.axis(i, block.end[i]);
                    continue;
                }
                let name = self.modal.machine.axes.name(i);
                self.modal.text("PO[");
                self.modal.text(name.as_str());
                self.modal.text("]=(");
                let spelling = self.spelling();
                write_units(&mut self.modal.out, block.end[i], self.decimals.digits[i], spelling);
                for a in &coefficients[..count] {
                    self.modal.out.push(b',');
                    a.write(&mut self.modal.out, spelling);
                }
                self.modal.text(") ");
            }
            self.modal.text("PL=");
            block.pl.write(&mut self.modal.out, Spelling::PLAIN);
            self.modal.out.push(b' ');
            self.feed(feed);
            self.modal.reached(&block.end);
            self.modal.end();
        }
    }

    fn nurbs(&mut self, nurbs: &WrittenNurbs, curve: &Written, feed: Option<Decimal>) {
        self.path_reference(curve, true);
        let moved = moving(curve);
        // A spline starts anew: two in a row would else be one.
        self.modal.motion = None;
        for (j, point) in nurbs.points.iter().enumerate().skip(1) {
            self.begin();
            if j == 1 {
                self.motion("BSPLINE");
                self.modal.text("SD=");
                self.modal.text(itoa::Buffer::new().format(nurbs.degree));
                self.modal.out.push(b' ');
            }
            self.point(point, &moved);
            self.modal.text("PL=");
            let distance = nurbs.knots[j + 2] - nurbs.knots[j + 1];
            write_units(&mut self.modal.out, distance, nurbs.knot_digits, Spelling::PLAIN);
            self.modal.out.push(b' ');
            if let Some(weights) = &nurbs.weights {
                self.modal.text("PW=");
                weights[j].write(&mut self.modal.out, Spelling::PLAIN);
                self.modal.out.push(b' ');
            }
            self.feed(feed);
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
            self.begin();
            if j == 0 {
                self.motion(word);
                let spline = &self.modal.machine.spline;
                let ends = format!("{} {} ", spline.begin, spline.end);
                self.modal.text(&ends);
            }
            self.point(&point, &moved);
            self.feed(feed);
            self.modal.reached(&point);
            self.modal.end();
        }
    }
}
