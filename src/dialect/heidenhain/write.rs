//! Spells a legal program in Klartext. Every block has a number, comments too; a block that goes on in the next line
//! ends with `~`, and the lines that continue it have none.

use crate::decimal::{Decimal, Spelling, write_units};
use crate::dialect::arc::counted_sense;
use crate::dialect::block::expected_size;
use crate::dialect::modal::Modal;
use crate::dialect::parts::{Part, parts};
use crate::geom::arc::Sense;
use crate::ir::{
    ArcBy, Decimals, PolynomialBlock, Units, Written, WrittenArc, WrittenPoints, WrittenPolynomial,
};
use crate::machine::Machine;
use crate::pass::check::{Legal, closing_coefficients};

/// The decimals of a K, behind its one digit before the point.
const MANTISSA_DIGITS: u8 = 8;

/// SPL moves two to five axes: a second one is named where only one moves.
const FEWEST_AXES: usize = 2;

/// The text of a program.
pub(super) fn write(legal: &Legal, machine: &Machine) -> String {
    let decimals = legal.decimals();
    let size = expected_size(decimals);
    let mut writer = Writer { modal: Modal::new(machine, size), decimals, goes_on: false };
    writer.program();
    String::from_utf8(writer.modal.out).unwrap_or_default()
}

struct Writer<'a> {
    modal: Modal<'a>,
    decimals: &'a Decimals,
    /// Whether the last line ended with `~`.
    goes_on: bool,
}

impl Writer<'_> {
    /// A line of fixed words.
    fn block(&mut self, text: &str) {
        if !self.goes_on {
            self.modal.begin("");
        }
        self.modal.text(text);
        self.modal.end();
        self.goes_on = text.ends_with('~');
    }

    fn program(&mut self) {
        let (parts, feeds) = parts(self.decimals, self.modal.machine);
        self.modal.parameters(&feeds);
        for part in parts {
            self.unwind(&part);
            match part {
                Part::Fixed(line) => {
                    self.block(&line);
                    continue;
                }
                // A program can be restarted at each tool.
                Part::Tool(..) => self.modal.forget(),
                Part::TipControl(false) if self.modal.machine.frame.tip_end_parks => self.modal.forget(),
                Part::Spindle | Part::TipControl(_) | Part::LengthEnd => {}
                Part::Plane => self.modal.forget(),
                Part::Home(axis) => self.modal.lose(axis),
                Part::Shift(shifts) => self.modal.shift(shifts),
                Part::Remark(text) => self.remark(text),
                Part::Comment(text) => {
                    self.remark(text);
                    self.modal.forget();
                }
                Part::Body => self.modal.forget(),
                Part::Rapid(targets) => self.rapid(targets),
                Part::Cut(cut) => match &cut.curve {
                    Written::Lines(points) => self.lines(points, cut.feed),
                    Written::Arc(arc) => self.arc(arc, cut.feed),
                    Written::Polynomial(polynomial) => self.polynomial(polynomial, cut.feed),
                    // No motion of this dialect has these forms, so that `check` lets none pass.
                    Written::Nurbs(_) | Written::Through(..) => {}
                },
            }
            // A fixed line that ends with `~` goes on in the next of its kind only.
            self.goes_on = false;
        }
    }

    /// Counts an axis that went round in steps below 360 degrees again, behind the last of them and before anything names it: from
    /// 1080 degrees on `A+0` turns back by three turns. A retraction comes first, so that the tool does not stand in the work.
    fn unwind(&mut self, part: &Part) {
        for i in 0..self.modal.machine.axes.count() {
            let goes_on = match part {
                Part::Rapid(targets) => targets.iter().all(|(axis, _)| *axis != i),
                Part::Cut(cut) => {
                    matches!(&cut.curve, Written::Lines(points) if self.modal.goes_round(points, i))
                }
                Part::Tool(..)
                | Part::Spindle
                | Part::Home(_)
                | Part::TipControl(_)
                | Part::LengthEnd
                | Part::Plane => true,
                Part::Shift(_) | Part::Body | Part::Fixed(_) | Part::Remark(_) | Part::Comment(_) => {
                    self.goes_on
                }
            };
            if self.modal.wound[i] && !goes_on {
                self.modal.wound[i] = false;
                let axis = self.modal.machine.axes.name(i);
                for line in &self.modal.machine.frame.unwind {
                    self.block(&line.fill(&[("axis", axis.as_str())]));
                }
            }
        }
    }

    fn remark(&mut self, text: &str) {
        if self.modal.machine.text.number_comments {
            self.modal.begin("");
        }
        self.modal.text("; ");
        self.modal.text(text);
        self.modal.end();
    }

    /// The places of a straight block: all of them beside the tool's direction, since LN takes no fewer.
    fn places(&mut self, point: &[i64]) {
        if self.modal.direction.is_some() {
            point.iter().enumerate().for_each(|(i, units)| self.modal.axis(i, *units));
        } else {
            self.modal.moved_axes(point);
        }
    }

    /// The word of a straight block: with the tool's direction LN.
    fn straight(&mut self) {
        self.modal.text(if self.modal.direction.is_some() { "LN " } else { "L " });
    }

    fn rapid(&mut self, targets: &[(usize, Decimal)]) {
        self.modal.begin("");
        self.straight();
        self.modal.targets(targets);
        // LN takes no compensation word: the vector of the tool alone compensates nothing.
        self.modal.text(if self.modal.direction.is_some() { "FMAX" } else { "R0 FMAX" });
        self.modal.end();
    }

    fn lines(&mut self, points: &WrittenPoints, feed: Option<Decimal>) {
        self.modal.lines(points);
        for point in points.units.chunks_exact(points.stride) {
            self.modal.begin("");
            self.straight();
            self.places(point);
            self.modal.feed(feed);
            self.modal.reached(point);
            self.modal.end();
        }
        self.modal.lines_end();
    }

    /// The centre, then the end, or for a helix the angle and the height. `check` lets arcs in X Y pass only.
    fn arc(&mut self, arc: &WrittenArc, feed: Option<Decimal>) {
        let (circle, turn) = match arc.by {
            ArcBy::Center(circle, _) => (circle, None),
            ArcBy::Turn(circle, degrees) => (circle, Some(degrees)),
            // The dialect does not ask for it, so that `quantise` makes none.
            ArcBy::Way(_) => return,
        };
        let [u, v, w] = circle.plane.axes();
        self.modal.begin("");
        self.modal.text("CC ");
        self.modal.axis(u, circle.center[0]);
        self.modal.axis(v, circle.center[1]);
        self.modal.end();
        self.modal.begin("");
        let sense = counted_sense(self.modal.machine, circle.plane, circle.sense);
        // The other axes rest; where they are is said by the next move that is straight.
        if let Some(degrees) = turn {
            self.modal.text("CP IPA");
            let signed = if sense == Sense::Clockwise { degrees.times(-1) } else { Some(degrees) };
            signed.unwrap_or(degrees).write(&mut self.modal.out, self.modal.spelling);
            self.modal.gap();
            let rise = self.modal.counted(w, arc.end[w]) - self.modal.counted(w, arc.start[w]);
            if rise != 0 {
                self.modal.text("I");
                self.modal.axis_name(w);
                write_units(&mut self.modal.out, rise, self.decimals.digits[w], self.modal.spelling);
                self.modal.gap();
                self.modal.position[w] = Some(arc.end[w]);
            }
            // An angle leads to no place in decimals, so that the next move names one.
            (self.modal.position[u], self.modal.position[v]) = (None, None);
        } else {
            self.modal.text("C ");
            self.modal.axis(u, arc.end[u]);
            self.modal.axis(v, arc.end[v]);
            self.modal.position[u] = Some(arc.end[u]);
            self.modal.position[v] = Some(arc.end[v]);
        }
        self.modal.text(match sense {
            Sense::Clockwise => "DR- ",
            Sense::CounterClockwise => "DR+ ",
        });
        self.modal.feed(feed);
        self.modal.end();
    }

    fn polynomial(&mut self, polynomial: &WrittenPolynomial, feed: Option<Decimal>) {
        let mut start = polynomial.start;
        for block in &polynomial.blocks {
            self.spline(block, &start, feed);
            start = block.end;
        }
    }

    fn spline(&mut self, block: &PolynomialBlock, start: &Units, feed: Option<Decimal>) {
        let named = self.named(block, start);
        self.modal.begin("");
        self.modal.text("SPL ");
        for &i in &named {
            self.modal.axis(i, block.end[i]);
        }
        self.modal.text("~");
        self.modal.end_line();
        for (n, &i) in named.iter().enumerate() {
            // `check` lets no block pass without them.
            let k = closing_coefficients(block, i, start[i], self.decimals.digits[i]).unwrap_or_default();
            let name = self.modal.machine.axes.name(i);
            self.modal.out.push(b' ');
            for (power, k) in [(b'3', k[0]), (b'2', k[1]), (b'1', k[2])] {
                self.modal.out.extend_from_slice(&[b' ', b'K', power]);
                self.modal.text(name.as_str());
                let k = self.modal.coefficient(i, k);
                write_coefficient(&mut self.modal.out, k, self.modal.spelling);
            }
            self.modal.out.push(b' ');
            if n + 1 < named.len() {
                self.modal.text("~");
                self.modal.end_line();
            }
        }
        self.modal.feed(feed);
        self.modal.reached(&block.end);
        self.modal.end();
    }

    /// The axes that a block names: those that it moves or whose place was not said since the last comment.
    fn named(&self, block: &PolynomialBlock, start: &Units) -> Vec<usize> {
        let axes = self.modal.machine.axes.count();
        let moves = |i: &usize| {
            let (i, k) = (*i, &block.coefficients[*i]);
            self.modal.position[i] != Some(block.end[i])
                || block.end[i] != start[i]
                || k.iter().any(|a| !a.is_zero())
        };
        let mut named: Vec<usize> = (0..axes).filter(moves).collect();
        for i in 0..axes {
            if named.len() < FEWEST_AXES && !named.contains(&i) {
                named.push(i);
            }
        }
        named.sort_unstable();
        named
    }
}

/// A K: as it is where it fits one digit before and eight behind the point, otherwise d.dddddddd E±n.
fn write_coefficient(out: &mut Vec<u8>, k: Decimal, spelling: Spelling) {
    if k.digits() <= MANTISSA_DIGITS
        && k.compare(Decimal::new(10, 0)).is_lt()
        && k.compare(Decimal::new(-10, 0)).is_gt()
    {
        return k.write(out, spelling);
    }
    let (mantissa, exponent) = scientific(k);
    mantissa.write(out, spelling);
    if mantissa.digits() == 0 {
        out.extend_from_slice(if spelling.point_always { b"0" } else { b".0" });
    }
    out.extend_from_slice(if exponent < 0 { b"E-" } else { b"E+" });
    out.extend_from_slice(itoa::Buffer::new().format(exponent.unsigned_abs()).as_bytes());
}

/// `value` = mantissa · 10^exponent with one digit before the point.
fn scientific(value: Decimal) -> (Decimal, i32) {
    let digits = value.digits();
    // In units of its own last decimal every decimal is whole.
    let mut units = value.units(digits).unwrap_or_default();
    let mut exponent = -i32::from(digits);
    while units != 0 && units % 10 == 0 {
        units /= 10;
        exponent += 1;
    }
    let mut places = 0;
    let mut rest = units / 10;
    while rest != 0 {
        rest /= 10;
        places += 1;
    }
    (Decimal::new(units, places), exponent + i32::from(places))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spelled(units: i64, digits: u8) -> String {
        let mut out = Vec::new();
        write_coefficient(
            &mut out,
            Decimal::new(units, digits),
            Spelling { point_always: false, sign_always: true, leading_zero: true },
        );
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn coefficients_have_nine_digits_and_an_exponent_from_ten_on() {
        assert_eq!(spelled(0, 0), "+0");
        assert_eq!(spelled(-6, 0), "-6");
        assert_eq!(spelled(-343_145_751, 8), "-3.43145751");
        assert_eq!(spelled(999_999_999, 8), "+9.99999999");
        assert_eq!(spelled(10, 0), "+1.0E+1");
        assert_eq!(spelled(-30, 0), "-3.0E+1");
        assert_eq!(spelled(165_685_425, 7), "+1.65685425E+1");
        assert_eq!(spelled(1, 8), "+0.00000001");
        assert_eq!(spelled(-186_078, 10), "-1.86078E-5");
        assert_eq!(spelled(12_345_678_000, 4), "+1.2345678E+6");
    }

    #[test]
    fn a_point_is_always_written_where_the_machine_asks() {
        let mut out = Vec::new();
        let spelling = Spelling { point_always: true, sign_always: false, leading_zero: true };
        write_coefficient(&mut out, Decimal::new(30, 0), spelling);
        write_coefficient(&mut out, Decimal::new(-6, 0), spelling);
        assert_eq!(out, b"3.0E+1-6.");
    }
}
