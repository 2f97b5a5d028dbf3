//! The direction of the tool: A3 B3 C3, or a second curve XH YH ZH under ORICURVE.
//!
//! A second point H beside the tip P states the direction D = H − P, by its coordinates or, in POLY, by polynomials.

use super::{Block, Motion, Reader, SECOND};
use crate::decimal::{Decimal, units_to_f64};
use crate::ir::COEFFICIENTS;
use crate::source::Span;
use std::ops::Range;

/// cos of the greatest angle by which the start of a second curve may turn the tool that stands there: some 0.08 degrees.
const SAME: f64 = 0.999_999;

impl Reader<'_> {
    /// Takes `XH=1`, or `PO[XH]=(1,2)`.
    pub(super) fn second_point(
        &mut self,
        name: &str,
        values: &[Decimal],
        range: Range<usize>,
        block: &mut Block,
    ) {
        let place = SECOND.iter().position(|known| *known == name);
        let (Some(i), [end, rest @ ..]) = (place, values) else { return };
        let mut coefficients = [Decimal::ZERO; COEFFICIENTS];
        coefficients[..rest.len()].copy_from_slice(rest);
        if block.second[i].replace((*end, coefficients)).is_some() {
            self.assembler.error("axis-twice", format!("{name} stands twice in this block"), range);
        }
    }

    /// What a block says of the direction joins the axes that it names; false where that is wrong, or where the block
    /// states the start of a second curve and moves nothing.
    pub(super) fn directed(&mut self, block: &mut Block, span: Span) -> bool {
        let whole = || span.start as usize..span.end as usize;
        let stated = block.direction.iter().any(Option::is_some);
        let second = block.second.iter().any(Option::is_some);
        if !stated && !second && !self.second {
            return true;
        }
        if self.assembler.machine.axes.direction().is_none() {
            let message = "this program leads no tip, so that no block states the tool's direction";
            self.assembler.error("direction", message, whole());
            return false;
        }
        if self.second && (stated || (block.count != 0 && !second)) {
            let message = "under ORICURVE every block has XH YH ZH, and none A3 B3 C3";
            self.assembler.error("second-curve", message, whole());
            return false;
        }
        if second && block.denominator.is_some() {
            let message = "what PO[] divides beside XH YH ZH no page says";
            self.assembler.error("denominator-axis", message, whole());
            return false;
        }
        if !self.second && second {
            self.assembler.error("second-curve", "XH YH ZH belong to ORICURVE", whole());
            return false;
        }
        let components = if second {
            match self.along(block) {
                Some(components) => components,
                None => {
                    let message =
                        "XH YH ZH stand together, beside a tip that is known, with no more decimals than it";
                    self.assembler.error("second-curve", message, whole());
                    return false;
                }
            }
        } else if stated {
            block.direction
        } else {
            return true;
        };
        let Some(named) = self.assembler.direction(components, whole()) else { return false };
        let spline = matches!(self.motion, Motion::Poly | Motion::Bspline | Motion::Through(_));
        if second && !spline && self.stays(block) {
            return self.starts_second(&named, whole());
        }
        for (axis, units) in named {
            block.named[block.count] = (axis, units);
            block.count += 1;
        }
        true
    }

    /// H − P at the end of a block, as the text counts both; what belongs to it of the coefficients goes into the block.
    fn along(&self, block: &mut Block) -> Option<[Option<Decimal>; 3]> {
        let first = self.assembler.machine.axes.direction()?;
        let mut components = [None; 3];
        for i in 0..3 {
            let (end, coefficients) = block.second[i]?;
            let named = block.named().iter().find(|(axis, _)| *axis == i).map(|(_, units)| *units);
            let tip = self.assembler.counted(i, named.or(self.assembler.position[i])?)?;
            components[i] = Some(end.minus(tip)?);
            for k in 0..COEFFICIENTS {
                let own = self.assembler.coefficient(i, block.coefficients()[i][k]);
                let along = coefficients[k].minus(own)?;
                block.coefficients_mut()[first + i][k] = self.assembler.coefficient(first + i, along);
            }
        }
        Some(components)
    }

    /// Whether a block leaves the tip where it is.
    fn stays(&self, block: &Block) -> bool {
        block.named().iter().all(|(axis, units)| self.assembler.position[*axis] == Some(*units))
    }

    /// The start of a second curve: the tool keeps its direction, and only the length of its vector changes.
    fn starts_second(&mut self, named: &[(usize, i64); 3], range: Range<usize>) -> bool {
        let digits = self.assembler.digits;
        let (mut a, mut b) = ([0.0; 3], [0.0; 3]);
        for (i, (axis, units)) in named.iter().enumerate() {
            a[i] = units_to_f64(*units, digits[*axis]);
            b[i] = self.assembler.position[*axis].map_or(a[i], |units| units_to_f64(units, digits[*axis]));
        }
        let dot = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        if !(SAME * (dot(&a, &a) * dot(&b, &b)).sqrt() < dot(&a, &b)) {
            let message = "the second curve starts in another direction than the tool has";
            self.assembler.error("second-curve-start", message, range);
            return false;
        }
        for (axis, units) in named {
            self.assembler.position[*axis] = Some(*units);
        }
        false
    }
}
