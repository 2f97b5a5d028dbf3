//! G06.2: control points, knots and weights, block by block; then the curve that they make.

use super::{Block, Placed, Reader, Run};
use crate::decimal::Decimal;
use crate::diagnostic::Diagnostic;
use crate::geom::nurbs::NurbsError;
use crate::ir::{Decimals, Program, Units, WrittenNurbs};
use crate::source::Span;
use crate::units::MAX_AXES;
use std::ops::Range;

/// A G06.2 curve in the making.
pub(super) struct NurbsRun {
    pub(super) start: Units,
    /// P and where it stands.
    order: Option<Placed>,
    /// The axes of the first block.
    axes: [bool; MAX_AXES],
    pub(super) points: Vec<Units>,
    lines: Vec<u32>,
    knots: Vec<Decimal>,
    weights: Vec<Option<Decimal>>,
    /// Blocks with K alone.
    pub(super) closing: usize,
    /// The last block.
    last: Range<usize>,
    /// Whether something was wrong with it, and said.
    broken: bool,
    pub(super) span: Span,
}

impl Reader<'_> {
    /// A block of a curve: the first as `G06.2 P4 K0. X0. Y0. R1. F200.`, then points as `K0. X10. Y0. R1.`, then K alone.
    pub(super) fn nurbs_block(&mut self, block: &Block, line: u32, span: Span) {
        let whole = span.start as usize..span.end as usize;
        if block.count == 0
            && block.k.is_none()
            && block.r.is_none()
            && block.p.is_none()
            && block.motion.is_none()
        {
            return;
        }
        match self.run.take() {
            Some(Run::Nurbs(mut run)) => {
                self.nurbs_goes_on(&mut run, block, line, &whole);
                run.span.end = span.end;
                run.last = whole;
                self.run = Some(Run::Nurbs(run));
            }
            Some(Run::Through { .. }) | None if block.motion.is_none() => {
                self.error("spline-ended", "the spline has ended; a code of motion must come first", whole);
            }
            Some(Run::Through { .. }) | None => self.nurbs_begins(block, line, span),
        }
    }

    fn nurbs_begins(&mut self, block: &Block, line: u32, span: Span) {
        let whole = span.start as usize..span.end as usize;
        let mut broken = false;
        let target = self.assembler.target(block.named());
        let start = self.assembler.start(block.named(), &target, span);
        let mut axes = [false; MAX_AXES];
        let mut mismatch = None;
        for ((axis, units), place) in block.named().iter().zip(block.places) {
            axes[*axis] = true;
            if start[*axis] != *units && mismatch.is_none() {
                mismatch = Some((*axis, *units, place));
            }
        }
        if block.count == 0 {
            broken = true;
            self.error(
                "first-point-missing",
                "the first block of G06.2 states where the tool stands, and all axes of the curve",
                whole.clone(),
            );
        }
        if let Some((axis, units, place)) = mismatch {
            broken = true;
            let (name, digits) = (self.assembler.machine.axes.name(axis), self.assembler.digits[axis]);
            let [here, there] = [start[axis], units].map(|units| Decimal::new(units, digits));
            let at = self.assembler.span(place..place + name.as_str().len());
            let diagnostic =
                Diagnostic::error("start-mismatch", "the spline does not start where the tool is")
                    .at(at, format!("starts at {name}{there}, the tool is at {name}{here}"))
                    .hint("the first control point is the end of the block before");
            self.assembler.diagnostics.push(diagnostic);
        }
        let mut run = NurbsRun {
            start,
            order: block.p.clone(),
            axes,
            points: Vec::new(),
            lines: Vec::new(),
            knots: Vec::new(),
            weights: Vec::new(),
            closing: 0,
            last: whole.clone(),
            broken,
            span,
        };
        if 0 < block.count {
            self.nurbs_point(&mut run, block, line, &whole);
        }
        self.run = Some(Run::Nurbs(run));
    }

    fn nurbs_goes_on(&mut self, run: &mut NurbsRun, block: &Block, line: u32, whole: &Range<usize>) {
        if let Some((_, range)) = &block.p {
            run.broken = true;
            self.error("spline-word", "P stands in the first block of G06.2", range.clone());
        }
        if block.count == 0 {
            if let Some((_, range)) = &block.r {
                run.broken = true;
                self.error("spline-word", "R stands with a control point", range.clone());
            }
            if block.k.is_some() {
                run.closing += 1;
                self.nurbs_knot(run, block, whole);
            }
            return;
        }
        if 0 < run.closing {
            if !run.broken {
                run.broken = true;
                self.error(
                    "spline-ended",
                    "a block with K alone ends the control points; a code of motion must come first",
                    whole.clone(),
                );
            }
            return;
        }
        for ((axis, _), place) in block.named().iter().zip(block.places) {
            if !run.axes[*axis] && !run.broken {
                run.broken = true;
                let name = self.assembler.machine.axes.name(*axis);
                let place = place..place + name.as_str().len();
                self.error(
                    "axis-not-in-first-block",
                    format!("{name} does not stand in the first block of this curve"),
                    place,
                );
            }
        }
        let left_out = block.count < run.axes.iter().filter(|named| **named).count();
        if left_out && !self.warned_left_out {
            self.warned_left_out = true;
            let span = self.assembler.span(whole.clone());
            self.assembler.diagnostics.push(
                Diagnostic::warning(
                    "axis-left-out",
                    "a control point without one of the curve's axes is taken to keep its last value",
                )
                .at(span, ""),
            );
        }
        self.nurbs_point(run, block, line, whole);
    }

    fn nurbs_point(&mut self, run: &mut NurbsRun, block: &Block, line: u32, whole: &Range<usize>) {
        run.points.push(self.assembler.target(block.named()));
        run.lines.push(line);
        for (axis, units) in block.named() {
            self.assembler.position[*axis] = Some(*units);
        }
        if let Some((weight, range)) = &block.r
            && weight.compare(Decimal::ZERO).is_le()
        {
            run.broken = true;
            self.error("weight-range", "a weight must be greater than zero", range.clone());
        }
        run.weights.push(block.r.as_ref().map(|(weight, _)| *weight));
        self.nurbs_knot(run, block, whole);
    }

    fn nurbs_knot(&mut self, run: &mut NurbsRun, block: &Block, whole: &Range<usize>) {
        let Some((knot, range)) = &block.k else {
            if !run.broken {
                run.broken = true;
                self.error("knot-missing", "each block of G06.2 has its knot K", whole.clone());
            }
            return;
        };
        if let Some(last) = run.knots.last()
            && knot.compare(*last).is_lt()
            && !run.broken
        {
            run.broken = true;
            self.error(
                "knots-decrease",
                format!("K{knot} is less than the knot before it, {last}"),
                range.clone(),
            );
        }
        run.knots.push(*knot);
    }

    /// The degree, from P and the closing blocks.
    fn degree(&mut self, run: &NurbsRun) -> Option<usize> {
        let place = run.order.as_ref().map_or(run.last.clone(), |(_, range)| range.clone());
        let said = match &run.order {
            None => Some(4),
            Some((order, _)) => order
                .units(0)
                .and_then(|order| usize::try_from(order).ok())
                .filter(|order| (1..=4).contains(order)),
        };
        let Some(said) = said else {
            self.error("order-range", "P is 2, 3 or 4: the degree and one", place);
            return None;
        };
        if run.closing == said && 2 <= said {
            return Some(said - 1);
        }
        if run.closing == said + 1 && said <= 3 && run.order.is_some() {
            let span = self.assembler.span(place);
            let message =
                format!("P{said} is the degree here, since {} blocks with K alone follow", run.closing);
            self.assembler.diagnostics.push(
                Diagnostic::warning("order-is-degree", message)
                    .at(span, "")
                    .hint(format!("on the control P is the order, P{}", said + 1)),
            );
            return Some(said);
        }
        let message =
            format!("a curve of order {said} ends with {said} blocks with K alone, not with {}", run.closing);
        self.error("closing-blocks", message, run.last.clone());
        None
    }

    /// A curve, where nothing is wrong with it.
    pub(super) fn nurbs(&mut self, run: NurbsRun) -> Option<WrittenNurbs> {
        if run.broken {
            return None;
        }
        let degree = self.degree(&run)?;
        let knot_digits =
            run.knots.iter().map(|t| t.digits()).max().unwrap_or(0).max(self.assembler.machine.digits.knot);
        // Differences of knots must be whole numbers too.
        let greatest = i64::MAX / 4;
        let units =
            |t: &Decimal| t.units(knot_digits).filter(|units| units.unsigned_abs() < greatest.unsigned_abs());
        let Some(knots) = run.knots.iter().map(units).collect::<Option<Vec<i64>>>() else {
            self.error("knot-range", format!("a knot is too large for {knot_digits} decimals"), run.last);
            return None;
        };
        if knots.first() == knots.last() {
            self.error("spline-empty", "all knots of this curve are equal", run.last);
            return None;
        }
        let weights = if run.weights.iter().all(Option::is_none) {
            None
        } else {
            Some(run.weights.iter().map(|w| w.unwrap_or(Decimal::new(1, 0))).collect())
        };
        let nurbs =
            WrittenNurbs { degree, knots, knot_digits, points: run.points, weights, lines: run.lines };
        let axes = self.assembler.machine.axes;
        let empty = Decimals {
            program: Program { name: String::new(), number: 0, axes, steps: Vec::new() },
            digits: self.assembler.digits,
            unnamed: [false; MAX_AXES],
            setup: Vec::new(),
        };
        if let Err(error) = crate::verify::to_nurbs(&empty, &nurbs) {
            let id = match error {
                NurbsError::Counts { .. } => "points-too-few",
                NurbsError::NotClamped(_) => "end-multiplicity",
                NurbsError::TooOften(_) | NurbsError::Breaks(_) => "knot-too-often",
                NurbsError::Decreases(_) => "knots-decrease",
                NurbsError::Weight(_) => "weight-range",
                NurbsError::Degree(_) => "order-range",
            };
            let whole = run.span.start as usize..run.span.end as usize;
            self.error(id, error.to_string(), whole);
            return None;
        }
        Some(nurbs)
    }
}
