//! Every number is rounded, once, to what the control reads.
//!
//! Positions take the machine's decimals. Coefficients of polynomial blocks take as many as the tolerance asks: with
//! coefficients a₂ … a₅ on 0 ≤ p ≤ PL rounding moves a point by at most Σ ½·10⁻ᵈ PLᵏ, and d is the least that keeps
//! this within a tenth of the tolerance. What rounding cost in all is measured afterwards, on the curve that the
//! rounded numbers make.
//!
//! # SPL blocks close exactly
//!
//! An SPL block states its end A and K1 K2 K3; its start is A + K1 + K2 + K3, which must be the end of the block
//! before. Both ends are rounded to the machine's decimals, with errors δs and δe. The inner control points move with
//! their ends, so that both tangents stay as they are:
//!
//! ```text
//! K1 = 3(P2 − P3)          K2 = 3(P1 − 2P2 + P3) + 3(δs − δe)          K3 = start − end − K1 − K2
//! ```
//!
//! and all three are counted in one step q = 10^(e−8), e the least for which each fits nine digits. q divides the
//! positions' last decimal, so that K3 is a whole number of q and nothing is lost. In the basis of the IR, a₂ = 3 K3 + K2
//! and a₃ = −K3.

mod rational;

use crate::decimal::{Decimal, Origin, round_units, units_to_f64};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::dialect::{ArcKind, ArcWord, Form};
use crate::geom::arc::{Arc, Plane};
use crate::geom::bezier::Bezier;
use crate::geom::nurbs::Nurbs;
use crate::ir::{
    ArcBy, Auxiliary, COEFFICIENTS, Circle, Curve, Cut, Decimals, Located, Passed, Polyline, PolynomialBlock,
    Program, Role, Shift, Step, Units, Written, WrittenArc, WrittenNurbs, WrittenPoints, WrittenPolynomial,
    sweep, turned_end,
};
use crate::machine::Machine;
use crate::machine::remark::wrapped;
use crate::units::{DEGREES, Kind, MAX_AXES, Position};
use std::borrow::Cow;

/// The most decimals of a coefficient.
const MAX_COEFFICIENT_DIGITS: u8 = 12;

/// The digits of an SPL coefficient behind the point at exponent 0.
const CLOSING_DECIMALS: u8 = 8;

/// A number is too large to be written, or not finite.
struct Unwritable;

struct Quantiser<'m> {
    machine: &'m Machine,
    tolerance: f64,
    digits: [u8; MAX_AXES],
    coefficient_digits: [u8; MAX_AXES],
    position: [Option<i64>; MAX_AXES],
    /// Whether the control stands where a turn by an angle led it, which is no place in decimals.
    loose: bool,
    /// Where each axis counts from.
    origin: [Origin; MAX_AXES],
    closing: bool,
}

/// Rounds a converted program. `radius` is the greatest at which a rotary axis counts, mm.
///
/// # Errors
/// A number is too large for the machine's decimals, or a feed rounds to zero.
pub fn quantise(
    program: Passed<'_>,
    form: Form,
    machine: &Machine,
    tolerance: f64,
    radius: f64,
) -> Result<Decimals, Diagnostics> {
    let digits = machine.axis_digits();
    let coefficient_digits = std::array::from_fn(|i| {
        let rotary = machine.axes.as_slice().get(i).is_some_and(|(_, kind)| *kind == Kind::Rotary);
        let share = if rotary && 0.0 < radius { 0.1 * tolerance * DEGREES / radius } else { 0.1 * tolerance };
        let mut d = digits[i];
        // Four coefficients, PL = 1.
        while d < MAX_COEFFICIENT_DIGITS
            && share < 0.5 * COEFFICIENTS as f64 / crate::decimal::power_of_ten(d) as f64
        {
            d += 1;
        }
        d
    });
    let closing = form == (Form::Polynomial { closing: true });
    let origin = [Origin::default(); MAX_AXES];
    let mut quantiser = Quantiser {
        machine,
        tolerance,
        digits,
        coefficient_digits,
        position: [None; MAX_AXES],
        loose: false,
        origin,
        closing,
    };
    let mut steps = Vec::with_capacity(program.steps.len());
    for Located { step, span } in program.steps {
        if let Step::Comment(text) = &step {
            let lines = wrapped(text, machine).into_iter();
            steps.extend(lines.map(|line| Located { step: Step::Comment(line), span }));
            continue;
        }
        let step = quantiser.step(step).map_err(|Unwritable| {
            Diagnostic::error("number-range", "a number is too large for the machine's decimals").at(span, "")
        })?;
        let zero = step.cut().is_some_and(|cut| match &cut.curve {
            Written::Lines(line) if !line.rates.is_empty() => line.rates.iter().any(|rate| rate.is_zero()),
            Written::Lines(_)
            | Written::Arc(_)
            | Written::Polynomial(_)
            | Written::Nurbs(_)
            | Written::Through(..) => cut.feed.is_some_and(Decimal::is_zero),
        });
        if zero {
            return Err(Diagnostic::error("feed-rounds-to-zero", "the feed rounds to zero")
                .at(span, "")
                .into());
        }
        if let Step::Spindle(rpm) = &step
            && rpm.is_zero()
        {
            let message = "the spindle speed rounds to zero";
            return Err(Diagnostic::error("spindle-rounds-to-zero", message).at(span, "").into());
        }
        steps.push(Located { step, span });
    }
    let program = Program { steps, name: program.name, number: program.number, axes: program.axes };
    Ok(Decimals { program, digits, unnamed: [false; MAX_AXES], setup: Vec::new() })
}

/// A coefficient with so many decimals, or as many as a float of its size holds.
fn coefficient(a: f64, digits: u8) -> Option<Decimal> {
    (0..=digits).rev().find_map(|digits| Decimal::round(a, digits))
}

impl Quantiser<'_> {
    #[inline]
    fn units(&self, axis: usize, x: f64) -> Result<i64, Unwritable> {
        self.origin[axis].round(x, self.digits[axis]).ok_or(Unwritable)
    }

    fn point(&self, point: &[f64; MAX_AXES]) -> Result<Units, Unwritable> {
        let mut units = [0; MAX_AXES];
        for (i, units) in units.iter_mut().enumerate().take(self.machine.axes.count()) {
            *units = self.units(i, point[i])?;
        }
        Ok(units)
    }

    /// Where the control stands, or would: the position it was sent to, not the one that was meant.
    fn start(&self, meant: &[f64; MAX_AXES]) -> Result<Units, Unwritable> {
        let mut start = self.point(meant)?;
        for (start, known) in start.iter_mut().zip(self.position) {
            *start = known.unwrap_or(*start);
        }
        Ok(start)
    }

    /// Where a curve starts: its direction in its own length, where it turns the tool, and otherwise as it is.
    fn curve_start(&self, meant: &[f64; MAX_AXES], turns: bool) -> Result<Units, Unwritable> {
        let mut start = self.start(meant)?;
        if let Some(first) = self.machine.axes.direction().filter(|_| turns) {
            start[first..first + 3].copy_from_slice(&self.point(meant)?[first..first + 3]);
        }
        Ok(start)
    }

    /// The end of a piece that does not turn the tool: the tool has the direction that it had.
    fn unturned(&self, mut point: Units, start: &Units, turns: bool) -> Units {
        if let Some(first) = self.machine.axes.direction().filter(|_| !turns) {
            point[first..first + 3].copy_from_slice(&start[first..first + 3]);
        }
        point
    }

    /// Whether some of these places differ in the tool's direction.
    fn turns<'p>(&self, mut places: impl Iterator<Item = &'p [f64; MAX_AXES]>) -> bool {
        let Some(first) = self.machine.axes.direction() else { return false };
        let Some(start) = places.next() else { return false };
        places.any(|place| place[first..first + 3] != start[first..first + 3])
    }

    fn arrive(&mut self, point: &Units) {
        for i in 0..self.machine.axes.count() {
            self.position[i] = Some(point[i]);
        }
    }

    fn step(&mut self, step: Step<f64, Cow<'_, Curve>>) -> Result<Step<Decimal, Written>, Unwritable> {
        let rate = |x: f64| Decimal::round(x, self.machine.digits.feed).ok_or(Unwritable);
        Ok(match step {
            Step::Comment(text) => Step::Comment(text),
            Step::Tool(call) => Step::Tool(call),
            Step::Spindle(rpm) => Step::Spindle(rate(rpm)?),
            Step::Coolant => Step::Coolant,
            Step::Auxiliary(auxiliary) => {
                if matches!(auxiliary, Auxiliary::Plane(_) | Auxiliary::PlaneEnd) {
                    self.position = [None; MAX_AXES];
                }
                let angle = |x: f64| Decimal::round(x, self.machine.digits.rotary);
                let auxiliary = auxiliary.try_map(|seconds| rate(seconds).ok(), angle);
                Step::Auxiliary(auxiliary.ok_or(Unwritable)?)
            }
            Step::Home(axis) => {
                self.position[axis] = None;
                Step::Home(axis)
            }
            Step::Shift(shifts) => {
                let mut rounded = Vec::with_capacity(shifts.len());
                for Shift { axis, to, parameter } in shifts {
                    let units = round_units(to, self.digits[axis]).ok_or(Unwritable)?;
                    self.origin[axis] = Origin { at: to, units };
                    rounded.push(Shift { axis, to: Decimal::new(units, self.digits[axis]), parameter });
                }
                Step::Shift(rounded)
            }
            Step::Rapid(targets) => {
                // The axes of turns are the first two.
                self.loose &= ![0, 1].iter().all(|axis| targets.iter().any(|(named, _)| named == axis));
                let mut rounded = Vec::with_capacity(targets.len());
                for (axis, to) in targets {
                    let units = self.units(axis, to)?;
                    self.position[axis] = Some(units);
                    rounded.push((axis, Decimal::new(units, self.digits[axis])));
                }
                Step::Rapid(rounded)
            }
            Step::Cut(Cut { feed, role, curve }) => {
                let timed = matches!(&*curve, Curve::Lines(line) if !line.rates.is_empty());
                let feed = if timed { None } else { feed.map(rate).transpose()? };
                Step::Cut(Cut { feed, role, curve: self.curve(&curve, role)? })
            }
        })
    }

    fn curve(&mut self, curve: &Curve, role: Role) -> Result<Written, Unwritable> {
        let loose = std::mem::take(&mut self.loose);
        match curve {
            Curve::Lines(line) => Ok(Written::Lines(self.points(line)?)),
            Curve::Arc(arc) => self.arc(arc, loose),
            Curve::Through(kind, line) => Ok(Written::Through(*kind, self.points(line)?)),
            Curve::Polynomial(pieces) => self.polynomial(pieces, role != Role::Approach && self.closing),
            Curve::Nurbs(nurbs) => self.nurbs(nurbs),
            Curve::Logarithmic(_) | Curve::Formula(_) => Err(Unwritable), // `interpolate` left none
        }
    }

    fn points(&mut self, line: &Polyline) -> Result<WrittenPoints, Unwritable> {
        let start = self.start(&line.start)?;
        let mut units = Vec::with_capacity(line.values.len());
        for point in line.values.chunks_exact(line.stride) {
            for (axis, x) in point.iter().enumerate() {
                units.push(self.units(axis, *x)?);
            }
        }
        let mut end = start;
        if let Some(last) = units.chunks_exact(line.stride).next_back() {
            end[..line.stride].copy_from_slice(last);
        }
        self.arrive(&end);
        let rate = |x: &f64| Decimal::round(*x, self.machine.digits.feed).ok_or(Unwritable);
        let rates = line.rates.iter().map(rate).collect::<Result<Vec<Decimal>, Unwritable>>()?;
        Ok(WrittenPoints { start, stride: line.stride, units, lines: Vec::new(), rates })
    }

    /// An arc between the rounded ends. One so short that these are the same would become a whole turn: it is a line.
    ///
    /// One that starts at no place in decimals goes on by an angle too: with an end, a whole circle could be next to nothing.
    fn arc(&mut self, arc: &Arc, loose: bool) -> Result<Written, Unwritable> {
        let (start, end) = (self.start(&arc.start())?, self.point(&arc.end())?);
        let kind = super::arcs::kind(arc);
        let Some(plane) = arc.plane() else {
            return match (self.machine.dialect.arcs.word)(kind, self.machine) {
                Some(ArcWord::Way) => self.arc_by_way(arc, start, end),
                Some(ArcWord::Center | ArcWord::Turn) | None => self.arc_in_lines(arc),
            };
        };
        let [u, v, w] = plane.axes();
        let over = start[u] == end[u] && start[v] == end[v];
        if !arc.is_full() && over && arc.sweep().abs() < 1.0 {
            self.arrive(&end);
            let stride = self.machine.axes.count();
            let units = end[..stride].to_vec();
            let (lines, rates) = (Vec::new(), Vec::new());
            return Ok(Written::Lines(WrittenPoints { start, stride, units, lines, rates }));
        }
        let kind = ArcKind { helix: start[w] != end[w], ..kind };
        let word = (self.machine.dialect.arcs.word)(kind, self.machine);
        let center = [self.units(u, arc.center()[0])?, self.units(v, arc.center()[1])?];
        let circle = Circle { plane, sense: arc.sense(), center };
        let stated = WrittenArc { start, end, by: ArcBy::Center(circle, 0), line: 0 };
        let once = stated.arc(&self.digits).ok_or(Unwritable)?;
        let turns = (arc.turns() - once.turns()).round().max(0.0) as u32;
        match word.map(|word| if loose { ArcWord::Turn } else { word }) {
            None => self.arc_in_lines(arc),
            // An arc that was asked beside its circle: no control takes it for one, however many decimals hold its end.
            Some(ArcWord::Center)
                if circle.rounding(&self.digits) < circle.misfit(&self.digits, (&start, &end)) =>
            {
                self.arc_in_lines(arc)
            }
            Some(ArcWord::Center) => {
                self.arrive(&end);
                Ok(Written::Arc(WrittenArc { by: ArcBy::Center(circle, turns), ..stated }))
            }
            Some(ArcWord::Way) => self.arc_by_way(arc, start, end),
            Some(ArcWord::Turn) => {
                let sweep = once.with_turns(turns).sweep().abs();
                let degrees =
                    Decimal::round(sweep * DEGREES, self.machine.digits.rotary).ok_or(Unwritable)?;
                let meant = ArcBy::Turn(circle, degrees);
                let off = if loose { 0.0 } else { self.turn_is_off(arc, (&start, &end), &circle, degrees) };
                if self.tolerance < off {
                    return self.arc_in_lines(arc);
                }
                let end = turned_end(&self.digits, (&start, &end), &circle, degrees).ok_or(Unwritable)?;
                self.loose = true;
                self.arrive(&end);
                Ok(Written::Arc(WrittenArc { end, by: meant, ..stated }))
            }
        }
    }

    /// How far a turn by an angle is from an arc, its end from the arc's included, mm.
    fn turn_is_off(
        &self,
        arc: &Arc,
        (start, end): (&Units, &Units),
        circle: &Circle,
        degrees: Decimal,
    ) -> f64 {
        let place =
            |units: &Units| -> Position { std::array::from_fn(|i| units_to_f64(units[i], self.digits[i])) };
        let (mut start, mut end) = (place(start), place(end));
        // The direction of the tool is no place.
        if let Some(first) = self.machine.axes.direction() {
            start[first..].copy_from_slice(&arc.start()[first..]);
            end[first..].copy_from_slice(&arc.end()[first..]);
        }
        let sweep = sweep(circle.sense, degrees);
        let (off, ends) = arc.deviation_turned(circle.plane, start, end, circle.place(&self.digits), sweep);
        let asked = arc.end();
        off + ends.iter().zip(&asked).map(|(p, q)| (p - q) * (p - q)).sum::<f64>().sqrt()
    }

    /// An arc by a place in its middle; lines where one would do, and where rounded places say too little about it.
    fn arc_by_way(&mut self, arc: &Arc, start: Units, end: Units) -> Result<Written, Unwritable> {
        let mut way = start;
        way[..3].copy_from_slice(&self.point(&arc.eval(0.5))?[..3]);
        if let Some([.., w]) = arc.plane().map(Plane::axes) {
            way[w] = start[w];
        }
        let written = WrittenArc { start, end, by: ArcBy::Way(way), line: 0 };
        let directed = self.machine.axes.direction();
        let near = written.arc(&self.digits).is_some_and(|meant| {
            // The direction of the tool is no place.
            let along = |p: &Position| {
                let mut place = *p;
                if let Some(first) = directed {
                    place[first..].fill(0.0);
                }
                place
            };
            arc.mapped_along(along).apart(&meant.mapped_along(along)) <= self.tolerance
        });
        if !near || self.chords(arc).count() == 1 {
            return self.arc_in_lines(arc);
        }
        self.arrive(&end);
        Ok(Written::Arc(written))
    }

    /// Half of the tolerance is for the chords, or what is left of it beside an end that is off the circle, at least a
    /// fiftieth.
    fn chords(&self, arc: &Arc) -> Polyline {
        let left = 0.9 * (self.tolerance - arc.misfit());
        let share = left.clamp(0.02 * self.tolerance, 0.5 * self.tolerance);
        super::arcs::lines(arc, self.machine.axes.count(), share)
    }

    fn arc_in_lines(&mut self, arc: &Arc) -> Result<Written, Unwritable> {
        let chords = self.chords(arc);
        Ok(Written::Lines(self.points(&chords)?))
    }

    fn polynomial(&mut self, pieces: &[Bezier], closing: bool) -> Result<Written, Unwritable> {
        let turns = self.turns(pieces.iter().flat_map(Bezier::control_points));
        let start = self.curve_start(&pieces.first().ok_or(Unwritable)?.start(), turns)?;
        let mut from = start;
        let mut blocks = Vec::with_capacity(pieces.len());
        // A piece below the last decimal, or of control points that are all one, is no block: it would name no axis.
        let mut resting = None;
        let mut take = |block: PolynomialBlock, from: &mut Units| {
            if block.rests(from) {
                resting = Some(block);
            } else {
                *from = block.end;
                blocks.push(block);
            }
        };
        for piece in pieces {
            let end = self.unturned(self.point(&piece.end())?, &start, turns);
            if !piece.is_polynomial() {
                take(rational::block(self, piece, &end)?, &mut from);
                continue;
            }
            let mut coefficients = [[Decimal::ZERO; COEFFICIENTS]; MAX_AXES];
            for axis in 0..self.machine.axes.count() {
                coefficients[axis] = if closing {
                    self.closing_coefficients(piece, axis, from[axis], end[axis])?
                } else {
                    let a = piece.power_basis(axis, 1.0);
                    let mut rounded = [Decimal::ZERO; COEFFICIENTS];
                    for (rounded, a) in rounded.iter_mut().zip(&a[2..]).take(piece.degree.saturating_sub(1)) {
                        *rounded = coefficient(*a, self.coefficient_digits[axis]).ok_or(Unwritable)?;
                    }
                    rounded
                };
            }
            let pl = Decimal::new(1, 0);
            take(PolynomialBlock { pl, end, coefficients, denominator: None, line: 0 }, &mut from);
        }
        // A path that is less than the last decimal everywhere is told by its block.
        if blocks.is_empty() {
            blocks.extend(resting);
        }
        self.arrive(&from);
        Ok(Written::Polynomial(WrittenPolynomial { start, blocks }))
    }

    /// a₂ and a₃ of one axis of an SPL block, as the module's documentation derives them.
    fn closing_coefficients(
        &self,
        piece: &Bezier,
        axis: usize,
        start: i64,
        end: i64,
    ) -> Result<[Decimal; COEFFICIENTS], Unwritable> {
        if piece.degree == 1 {
            // Straight between the rounded ends: K2 = K3 = 0.
            return Ok([Decimal::ZERO; COEFFICIENTS]);
        }
        let cubic = piece.raised_to(3);
        let [p0, p1, p2, p3] = [0, 1, 2, 3].map(|i| cubic.points[i][axis]);
        let digits = self.digits[axis];
        let (delta_s, delta_e) = (units_to_f64(start, digits) - p0, units_to_f64(end, digits) - p3);
        let k1 = 3.0 * (p2 - p3);
        let k2 = 3.0 * (p1 - 2.0 * p2 + p3) + 3.0 * (delta_s - delta_e);
        let gap = Decimal::new(start, digits).minus(Decimal::new(end, digits)).ok_or(Unwritable)?;
        // e from 0 while q = 10^(e−8) still divides the positions' last decimal.
        for e in 0..=CLOSING_DECIMALS.checked_sub(digits).ok_or(Unwritable)? {
            let q_digits = CLOSING_DECIMALS - e;
            let (Some(k1), Some(k2)) = (Decimal::round(k1, q_digits), Decimal::round(k2, q_digits)) else {
                continue;
            };
            let Some(k3) = gap.minus(k1).and_then(|rest| rest.minus(k2)) else { continue };
            let fits =
                |k: Decimal| k.units(q_digits).is_some_and(|units| units.unsigned_abs() < 1_000_000_000);
            if fits(k1) && fits(k2) && fits(k3) {
                let a2 = k3.times(3).and_then(|k| k.plus(k2)).ok_or(Unwritable)?;
                let a3 = k3.times(-1).ok_or(Unwritable)?;
                return Ok([a2, a3, Decimal::ZERO, Decimal::ZERO]);
            }
        }
        Err(Unwritable)
    }

    fn nurbs(&mut self, nurbs: &Nurbs) -> Result<Written, Unwritable> {
        let turns = self.turns(nurbs.points().iter());
        let start = self.curve_start(&nurbs.points()[0], turns)?;
        let mut points = vec![start];
        for point in &nurbs.points()[1..] {
            points.push(self.unturned(self.point(point)?, &start, turns));
        }
        let knot_digits = self.machine.digits.knot;
        let knots = nurbs
            .knots()
            .iter()
            .map(|t| round_units(*t, knot_digits).ok_or(Unwritable))
            .collect::<Result<Vec<i64>, Unwritable>>()?;
        let weights = if nurbs.is_polynomial() {
            None
        } else {
            let round = |w: &f64| Decimal::round(*w, self.machine.digits.weight).ok_or(Unwritable);
            Some(nurbs.weights().iter().map(round).collect::<Result<Vec<Decimal>, Unwritable>>()?)
        };
        let end = points[points.len() - 1];
        self.arrive(&end);
        Ok(Written::Nurbs(WrittenNurbs {
            degree: nurbs.degree(),
            knots,
            knot_digits,
            points,
            weights,
            lines: Vec::new(),
        }))
    }
}
