//! Expressions in one parameter: `R*cos(u)`, with exact derivatives and proved bounds.
//!
//! | module | what |
//! |---|---|
//! | [`parse`] | text to expression, with the place of what is wrong |
//! | [`number`], [`interval`] | what expressions are evaluated in |
//! | [`jet`] | a value and its derivatives, by rules |
//! | [`curve`] | a curve whose coordinates are expressions |
//!
//! An expression is a list of operations, each after those that it needs, so evaluation is one pass. The same pass over
//! floats gives values and derivatives, over intervals it bounds them on a whole range of u. What has no value or no
//! derivative is a [`Fault`] with its place in the text.

pub mod curve;
pub mod interval;
pub mod jet;
pub mod number;
pub mod parse;

use jet::Jet;
use number::{Fault, Number};
use std::ops::Range;

/// One operation; its arguments are indices of operations before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Op {
    Number(f64),
    Parameter,
    Negative(usize),
    Plus(usize, usize),
    Minus(usize, usize),
    Times(usize, usize),
    Over(usize, usize),
    /// aⁿ with a whole number.
    WholePower(usize, i32),
    /// aʳ with a number.
    RealPower(usize, f64),
    /// aᵇ with an exponent that changes: e^(b ln a).
    Power(usize, usize),
    Call(Function, usize),
    /// The angle of (second, first).
    Atan2(usize, usize),
}

/// A function of one argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Function {
    /// √x.
    Sqrt,
    /// ∛x.
    Cbrt,
    /// eˣ.
    Exp,
    /// The natural logarithm.
    Ln,
    /// The logarithm to base 10.
    Log10,
    /// sin x, x in radians like all angles.
    Sin,
    /// cos x.
    Cos,
    /// tan x.
    Tan,
    /// arcsin x.
    Asin,
    /// arccos x.
    Acos,
    /// arctan x.
    Atan,
    /// sinh x.
    Sinh,
    /// cosh x.
    Cosh,
    /// tanh x.
    Tanh,
    /// |x|.
    Abs,
    /// Radians in degrees.
    Deg,
    /// Degrees in radians.
    Rad,
}

/// The functions of one argument by name.
pub const FUNCTIONS: &[(&str, Function)] = &[
    ("sqrt", Function::Sqrt),
    ("cbrt", Function::Cbrt),
    ("exp", Function::Exp),
    ("ln", Function::Ln),
    ("log", Function::Ln),
    ("log10", Function::Log10),
    ("sin", Function::Sin),
    ("cos", Function::Cos),
    ("tan", Function::Tan),
    ("asin", Function::Asin),
    ("acos", Function::Acos),
    ("atan", Function::Atan),
    ("sinh", Function::Sinh),
    ("cosh", Function::Cosh),
    ("tanh", Function::Tanh),
    ("abs", Function::Abs),
    ("deg", Function::Deg),
    ("rad", Function::Rad),
];

/// A fault and where in the text it is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failing {
    /// What is wrong.
    pub fault: Fault,
    /// The bytes of the operation in the expression's text.
    pub span: Range<usize>,
}

/// An expression in one parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Expression {
    /// Each after its arguments; the last is the whole. Never empty.
    ops: Vec<(Op, Range<usize>)>,
    text: String,
}

impl Expression {
    /// The number itself.
    pub fn number(x: f64) -> Expression {
        Expression { ops: vec![(Op::Number(x), 0..0)], text: x.to_string() }
    }

    /// As it was written.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Whether the parameter stands in it.
    pub fn depends(&self) -> bool {
        self.ops.iter().any(|(op, _)| *op == Op::Parameter)
    }

    /// The value and N − 1 derivatives at `u`, over their factorials.
    ///
    /// # Errors
    /// Something has no value or no derivative there: over an interval, may have none.
    pub fn jet<T: Number, const N: usize>(&self, u: T) -> Result<Jet<T, N>, Failing> {
        let mut values: Vec<Jet<T, N>> = Vec::with_capacity(self.ops.len());
        for (op, span) in &self.ops {
            let fail = |fault| Failing { fault, span: span.clone() };
            let value = evaluate(*op, u, &values).map_err(fail)?;
            if !value.is_finite() {
                return Err(fail(Fault::Overflow));
            }
            values.push(value);
        }
        // Never empty, by construction.
        values.pop().ok_or(Failing { fault: Fault::Overflow, span: 0..0 })
    }

    /// f(u).
    ///
    /// # Errors
    /// As [`Expression::jet`].
    pub fn at(&self, u: f64) -> Result<f64, Failing> {
        self.jet::<f64, 1>(u).map(|jet| jet.0[0])
    }
}

fn evaluate<T: Number, const N: usize>(op: Op, u: T, values: &[Jet<T, N>]) -> Result<Jet<T, N>, Fault> {
    match op {
        Op::Number(x) => Ok(Jet::constant(x)),
        Op::Parameter => Ok(Jet::parameter(u)),
        Op::Negative(a) => Ok(values[a].negative()),
        Op::Plus(a, b) => Ok(values[a].plus(values[b])),
        Op::Minus(a, b) => Ok(values[a].minus(values[b])),
        Op::Times(a, b) if a == b => Ok(values[a].square()),
        Op::Times(a, b) => Ok(values[a].times(values[b])),
        Op::Over(a, b) => values[a].over(values[b]),
        Op::WholePower(a, n) => values[a].whole_power(n),
        Op::RealPower(a, r) => values[a].power(r),
        Op::Power(a, b) => values[b].times(values[a].ln().map_err(|_| Fault::PowerOfNonPositive)?).exp(),
        Op::Atan2(y, x) => values[y].atan2(values[x]),
        Op::Call(function, a) => call(function, values[a]),
    }
}

fn call<T: Number, const N: usize>(function: Function, a: Jet<T, N>) -> Result<Jet<T, N>, Fault> {
    match function {
        Function::Sqrt => a.sqrt(),
        Function::Cbrt => a.cbrt(),
        Function::Exp => a.exp(),
        Function::Ln => a.ln(),
        Function::Log10 => a.ln()?.over(Jet::constant(std::f64::consts::LN_10)),
        Function::Sin => Ok(a.sin_cos()?.0),
        Function::Cos => Ok(a.sin_cos()?.1),
        Function::Tan => a.tan(),
        Function::Asin => a.asin(),
        Function::Acos => a.acos(),
        Function::Atan => a.atan(),
        Function::Sinh => Ok(a.sinh_cosh()?.0),
        Function::Cosh => Ok(a.sinh_cosh()?.1),
        Function::Tanh => a.tanh(),
        Function::Abs => a.abs(),
        Function::Deg => Ok(a.scaled(crate::units::DEGREES)),
        Function::Rad => Ok(a.scaled(1.0 / crate::units::DEGREES)),
    }
}

#[cfg(test)]
mod tests;
