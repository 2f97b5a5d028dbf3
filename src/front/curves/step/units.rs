//! Units of a file: what its contexts assign.

use super::model::{Instance, Model, Read};
use super::text::Value;
use crate::front::curves::{Unit, fail};
use crate::source::Span;

/// How deep units may be stated by others.
const DEEPEST: usize = 8;

/// Prefixes of SI units: of themselves, and in thousandths, so that no length is rounded twice.
const PREFIXES: &[(&str, f64, f64)] = &[
    ("", 1.0, 1e3),
    ("KILO", 1e3, 1e6),
    ("HECTO", 1e2, 1e5),
    ("DECA", 1e1, 1e4),
    ("DECI", 1e-1, 1e2),
    ("CENTI", 1e-2, 1e1),
    ("MILLI", 1e-3, 1.0),
    ("MICRO", 1e-6, 1e-3),
    ("NANO", 1e-9, 1e-6),
];

/// The length of a unit and, in radians, the size of its angles.
pub(super) struct Units {
    pub(super) length: Unit,
    pub(super) angle: f64,
}

/// The units of a file.
///
/// # Errors
/// A unit is not readable.
pub(super) fn of(model: &Model<'_>) -> Read<Units> {
    let mut units =
        Units { length: Unit::Unknown("this file does not say its units".to_owned(), None), angle: 1.0 };
    let mut angled = false;
    for (number, _) in model.order.iter().filter(|(_, keyword)| keyword.is_empty()) {
        if !model.text(*number).contains("GLOBAL_UNIT_ASSIGNED_CONTEXT") {
            continue;
        }
        let context = model.get(*number, model.span(*number))?;
        if !context.is("GLOBAL_UNIT_ASSIGNED_CONTEXT") {
            continue;
        }
        for parameter in context.list(context.of("GLOBAL_UNIT_ASSIGNED_CONTEXT", 0)?)? {
            let unit = model.follow(&context, parameter)?;
            let span = context.place(parameter);
            if unit.is("LENGTH_UNIT") {
                let mm = size(model, &unit, "METRE", span, 0)?;
                match units.length {
                    Unit::Stated(known) if (known - mm).abs() > 1e-9 * mm => {
                        let message =
                            format!("one part of this file is in units of {known} mm, another of {mm} mm");
                        units.length = Unit::Unknown(message, Some(span));
                        return Ok(units);
                    }
                    Unit::Stated(_) | Unit::Unknown(..) => units.length = Unit::Stated(mm),
                }
            } else if unit.is("PLANE_ANGLE_UNIT") {
                let radians = size(model, &unit, "RADIAN", span, 0)?;
                if angled && (radians - units.angle).abs() > 1e-9 * radians {
                    return Err(fail("units-differ", "angles of this file have several units", span));
                }
                (units.angle, angled) = (radians, true);
            }
        }
    }
    Ok(units)
}

/// How large a unit is: a length in mm, an angle in radians.
fn size(model: &Model<'_>, unit: &Instance<'_>, base: &str, span: Span, depth: usize) -> Read<f64> {
    let wrong = || fail("units-unreadable", format!("#{} is no unit that is known", unit.number), span);
    if DEEPEST < depth {
        return Err(wrong());
    }
    if unit.is("SI_UNIT") {
        let Value::Word(name) = unit.of("SI_UNIT", 1)?.value else { return Err(wrong()) };
        if name != base {
            return Err(wrong());
        }
        let parameter = unit.of("SI_UNIT", 0)?;
        let prefix = if let Value::Word(prefix) = parameter.value { prefix } else { "" };
        if prefix.is_empty() && parameter.value != Value::Omitted {
            return Err(wrong());
        }
        let (_, one, thousandths) = PREFIXES.iter().find(|(known, ..)| *known == prefix).ok_or_else(wrong)?;
        return Ok(if base == "METRE" { *thousandths } else { *one });
    }
    if !unit.is("CONVERSION_BASED_UNIT") {
        return Err(wrong());
    }
    // LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#si)
    let measure = model.follow(unit, unit.of("CONVERSION_BASED_UNIT", 1)?)?;
    let record = measure.records.iter().position(|record| record.parameters.len() == 2).ok_or_else(wrong)?;
    let (count, of) = (measure.parameter(record, 0)?, measure.parameter(record, 1)?);
    let count = match &count.value {
        Value::Typed(typed) => typed.parameters.first().ok_or_else(wrong)?,
        Value::Number(_)
        | Value::Text(_)
        | Value::Word(_)
        | Value::Reference(_)
        | Value::List(_)
        | Value::Omitted
        | Value::Derived => count,
    };
    let count = measure.number(count)?.0;
    if !(0.0 < count) {
        return Err(wrong());
    }
    Ok(count * size(model, &model.follow(&measure, of)?, base, span, depth + 1)?)
}
