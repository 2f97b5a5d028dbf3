//! Curves as expressions in u.

use super::file::{Bound, CurveTable};
use super::{GREATEST, Reader};
use crate::geom::bezier::Bezier;
use crate::geom::expr::Expression;
use crate::geom::expr::curve::{Formula, FormulaError};
use crate::geom::expr::parse::{ParseError, Wrong, is_constant_name, parse};
use crate::ir::{Curve, Described};
use crate::tables::nearest;
use crate::units::{Axis, MAX_AXES};
use std::ops::Range;
use std::sync::Arc;
use toml::Spanned;

/// Pieces stand for an expression within this, mm or degrees: a thousandth of what most machines' last decimals are to a
/// tolerance, and far above what a float loses.
const STAND_IN: f64 = 1.0e-8;

/// Bytes of an expression as bytes of the file: behind the quote, where the text stands as it is.
fn within(text: &Spanned<String>, inner: &Range<usize>) -> Range<usize> {
    let outer = text.span();
    // An escape or a text of several lines is longer in the file than its value.
    if outer.len() == text.get_ref().len() + 2 {
        outer.start + 1 + inner.start..outer.start + 1 + inner.end
    } else {
        outer
    }
}

impl Reader<'_> {
    /// The axes and the curve of a table of kind "expression".
    pub(super) fn expression(
        &mut self,
        table: &CurveTable,
        head: Range<usize>,
    ) -> Option<(Vec<Axis>, Curve)> {
        let constants = self.constants(table)?;
        let mut axes = Vec::new();
        let mut expressions = Vec::new();
        let mut texts = Vec::new();
        let mut sound = true;
        for (name, text) in table.expressions() {
            let (Some(text), Some(axis)) = (text, Axis::new(name)) else { continue };
            match parse(text.get_ref(), &constants) {
                Ok(expression) => {
                    axes.push(axis);
                    expressions.push(expression);
                    texts.push(text);
                }
                Err(error) => {
                    self.unread(&error, &constants, within(text, &error.span));
                    sound = false;
                }
            }
        }
        let range = self.range_of_u(table, &constants, head.clone());
        if !sound {
            return None;
        }
        if axes.is_empty() || MAX_AXES < axes.len() {
            let message = format!("a curve has 1 to {MAX_AXES} axes");
            self.hinted("axes-range", message, head, "add a line like `X = \"R*cos(u)\"`");
            return None;
        }
        let (from, to, span) = range?;
        let failed = |error: FormulaError| (error, texts.clone());
        let formula = match Formula::new(expressions, from, to).map_err(failed) {
            Ok(formula) => formula,
            Err((error, texts)) => {
                self.unsound(&error, &texts, span);
                return None;
            }
        };
        match formula.pieces(STAND_IN) {
            Ok((pieces, bound)) => {
                let far = pieces.iter().flat_map(Bezier::control_points).flatten();
                if far.into_iter().any(|x| !(x.abs() < GREATEST)) {
                    self.error("point-range", "coordinates must lie within a million", head);
                    return None;
                }
                Some((axes, Curve::Formula(Described { formula: Arc::new(formula), pieces, bound })))
            }
            Err(error) => {
                self.unsound(&error, &texts, span);
                None
            }
        }
    }

    /// The named constants.
    fn constants(&mut self, table: &CurveTable) -> Option<Vec<(String, f64)>> {
        let mut constants = Vec::new();
        let mut sound = true;
        for (name, value) in table.constants.as_ref().map(Spanned::get_ref).into_iter().flatten() {
            if !is_constant_name(name) {
                let message = format!("`{name}` cannot name a constant");
                let hint = "a name is a letter, then letters, digits and _, and no function, u, pi or e";
                self.hinted("constant-name", message, value.span(), hint);
                sound = false;
            } else if value.get_ref().is_finite() {
                constants.push((name.clone(), *value.get_ref()));
            } else {
                self.error("not-finite", format!("{name} must be a finite number"), value.span());
                sound = false;
            }
        }
        sound.then_some(constants)
    }

    /// From where to where u runs, and where that stands.
    fn range_of_u(
        &mut self,
        table: &CurveTable,
        constants: &[(String, f64)],
        head: Range<usize>,
    ) -> Option<(f64, f64, Range<usize>)> {
        let Some(u) = &table.u else {
            let message = "[[curve]] of kind \"expression\" has no `u`".to_owned();
            self.hinted("key-missing", message, head, "add a line like `u = [0, \"2*pi\"]`");
            return None;
        };
        let [from, to] = &u.get_ref()[..] else {
            self.error("u-range", "u has two ends, as [0, \"2*pi\"]", u.span());
            return None;
        };
        let ends = [from, to].map(|end| self.end_of_u(end, constants));
        let [Some(from), Some(to)] = ends else { return None };
        Some((from, to, u.span()))
    }

    fn end_of_u(&mut self, end: &Spanned<Bound>, constants: &[(String, f64)]) -> Option<f64> {
        let expression = match end.get_ref() {
            Bound::Number(x) if !x.is_finite() => {
                self.error("not-finite", "an end of u must be a finite number", end.span());
                return None;
            }
            Bound::Number(x) => Expression::number(*x),
            Bound::Text(text) => match parse(text, constants) {
                Ok(expression) => expression,
                Err(error) => {
                    let text = Spanned::new(end.span(), text.clone());
                    self.unread(&error, constants, within(&text, &error.span));
                    return None;
                }
            },
        };
        match expression.at(0.0) {
            Ok(_) if expression.depends() => {
                self.error("u-range", "an end of u cannot depend on u", end.span());
            }
            // What an expression gives is finite.
            Ok(x) => return Some(x),
            Err(failing) => self.error("expression-domain", failing.fault.to_string(), end.span()),
        }
        None
    }

    /// Says why a text is no expression.
    fn unread(&mut self, error: &ParseError, constants: &[(String, f64)], span: Range<usize>) {
        let message = error.wrong.to_string();
        let names = || constants.iter().map(|(name, _)| name.as_str()).chain(["u", "pi", "e"]);
        let functions = || crate::geom::expr::FUNCTIONS.iter().map(|(name, _)| *name).chain(["atan2"]);
        let hint = match &error.wrong {
            Wrong::UnknownName(name) => match nearest(name, names()) {
                Some(meant) => format!("did you mean `{meant}`?"),
                None => format!("known are {}", names().collect::<Vec<_>>().join(", ")),
            },
            Wrong::UnknownFunction(name) => match nearest(name, functions()) {
                Some(meant) => format!("did you mean `{meant}`?"),
                None => format!("functions are {}", functions().collect::<Vec<_>>().join(", ")),
            },
            Wrong::Expected(_)
            | Wrong::FunctionAlone(_)
            | Wrong::Arguments(..)
            | Wrong::TooDeep
            | Wrong::TooLong
            | Wrong::NumberTooLarge => {
                self.error("expression-syntax", message, span);
                return;
            }
        };
        self.hinted("expression-syntax", message, span, hint);
    }

    /// Says why expressions are no curve.
    fn unsound(&mut self, error: &FormulaError, texts: &[&Spanned<String>], range: Range<usize>) {
        let message = error.to_string();
        match error {
            FormulaError::Fails { axis, failing, .. } => {
                let span = texts.get(*axis).map_or(range, |text| within(text, &failing.span));
                let hint =
                    "take the range of u so that every coordinate is smooth on it, or state two curves";
                self.hinted("expression-domain", message, span, hint);
            }
            FormulaError::Stands { .. } => {
                let hint = "take another parameter, or end one curve there and start the next";
                self.hinted("curve-stands", message, range, hint);
            }
            FormulaError::Range | FormulaError::TooHard => self.error("u-range", message, range),
        }
    }
}
