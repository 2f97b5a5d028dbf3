//! Cuts without length.
//!
//! Within the tolerance a small circle and a point are as good as each other, and a bound on their distance tells them not
//! apart. So it is an error where a path that was asked is longer than the rounding of its ends can hide, and what was written has no
//! length, or the other way round. A point that was asked twice is no such path, nor is a step below the last decimal: both
//! are ordinary in CL data, are written as blocks that move nothing, and are counted.

use super::Cursor;
use crate::decimal::units_to_f64;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::geom::arc::Arc;
use crate::geom::bezier::Bezier;
use crate::geom::deviation::Metric;
use crate::ir::{Curve, Cut, Intent, Polyline, Role, Step};
use crate::machine::Machine;
use crate::pass::approximate::Frame;
use crate::source::Span;
use crate::units::{Kind, MAX_AXES, Position};

/// A path has at least the length of the polygon through so many places of each of its pieces.
const PLACES: u32 = 8;

/// Half a turn, radians: whoever leaves out a whole one leaves out more.
const HALF_TURN: f64 = std::f64::consts::PI;

fn distance(p: &Position, q: &Position) -> f64 {
    p.iter().zip(q).map(|(p, q)| (p - q) * (p - q)).sum::<f64>().sqrt()
}

/// A length that pieces have at least, of those in mm as they count.
fn at_least(pieces: &[Bezier]) -> f64 {
    let of = |piece: &Bezier| {
        let places: Vec<Position> =
            (0..=PLACES).map(|k| piece.eval(f64::from(k) / f64::from(PLACES))).collect();
        places.windows(2).map(|pair| distance(&pair[0], &pair[1])).sum::<f64>()
    };
    pieces.iter().map(of).sum()
}

/// Whether pieces never leave one place.
fn is_point(pieces: &[Bezier]) -> bool {
    let Some(first) = pieces.first().map(Bezier::start) else { return true };
    pieces.iter().flat_map(Bezier::control_points).all(|point| *point == first)
}

/// The greatest length that rounding both ends of a path can hide, mm: each is moved by half a unit of the last decimal in every
/// axis at most, so that ends less than a unit apart in each may become one place.
fn hidden(digits: [u8; MAX_AXES], metric: &Metric) -> f64 {
    let unit: Position = std::array::from_fn(|i| units_to_f64(1, digits[i]));
    metric.distance(&unit, &[0.0; MAX_AXES]).mm
}

impl Cursor<'_> {
    fn refused_length(&self, message: String) -> Diagnostics {
        self.differs("cut-without-length", message)
    }

    /// Holds the pieces that were written against those that were asked, both in mm as they count.
    pub(super) fn has_length(
        &self,
        asked: &[Bezier],
        written: &[Bezier],
        metric: &Metric,
    ) -> Result<(), Diagnostics> {
        let hidden = hidden(self.decimals.digits, metric);
        if is_point(written) && hidden < at_least(asked) {
            let length = at_least(asked);
            return Err(self.refused_length(format!(
                "this path has no length, where one of {length:.3e} mm or more was asked"
            )));
        }
        if is_point(asked) && hidden < at_least(written) {
            return Err(self.refused_length("this path has a length, where none was asked".to_owned()));
        }
        Ok(())
    }

    /// Holds an arc: what was written of it has a length of `written` mm and turns by `turned` radians. A turn that is left out
    /// is one more than half that is missing.
    pub(super) fn arc_has_length(&self, asked: &Arc, written: f64, turned: f64) -> Result<(), Diagnostics> {
        let kinds: Vec<Kind> = self.decimals.program.axes.as_slice().iter().map(|(_, kind)| *kind).collect();
        let hidden = hidden(self.decimals.digits, &Metric::new(&kinds, self.radius));
        // The rounding of its ends hides the chord of a short arc; one of a radian is longer by a 23rd.
        let least =
            if asked.sweep().abs() < 1.0 { self.apart(&asked.start(), &asked.end()) } else { asked.length() };
        if written == 0.0 && hidden < least {
            return Err(self.refused_length(format!(
                "this arc has no length, where one of {:.3e} mm was asked",
                asked.length()
            )));
        }
        if HALF_TURN < asked.sweep().abs() - turned {
            let message = format!(
                "this arc makes {:.3} turns, where {:.3} were asked",
                turned / (2.0 * HALF_TURN),
                asked.turns()
            );
            return Err(self.differs("turns-differ", message));
        }
        Ok(())
    }

    /// How many lines lead to where the tool is already, in the decimals of the text.
    pub(super) fn rests(&self, line: &Polyline) -> usize {
        let units = |p: &Position| -> [Option<i64>; MAX_AXES] {
            std::array::from_fn(|i| if i < line.stride { self.units(i, p[i]) } else { None })
        };
        let mut from = units(&line.start);
        let mut rests = 0;
        for to in line.points() {
            let to = units(&to);
            rests += usize::from(to == from);
            from = to;
        }
        rests
    }
}

/// A contour that is to be cut along some curve, and leads nowhere: all its paths from one approach to the next step that is
/// none are together no longer than rounding hides. A circle whose sweep became next to nothing is such a one.
///
/// # Errors
/// There is one.
pub(crate) fn contours(intent: &Intent, machine: &Machine, tolerance: f64) -> Result<(), Diagnostics> {
    let frame = Frame { axes: &intent.program.axes, machine, radius: intent.radius() };
    let metric = frame.metric(tolerance);
    let hidden = hidden(machine.axis_digits(), &metric);
    // How long the contour is so far, and its first curve that is not made of lines.
    let (mut length, mut curve) = (0.0, None);
    let ended = |length: f64, curve: Option<Span>| match curve {
        Some(span) if length <= hidden => {
            let message = format!(
                "this curve is {length:.1e} mm long, less than the last decimal of the machine: a point, not a path"
            );
            let diagnostic = Diagnostic::refusal("path-without-length", message)
                .at(span, "")
                .hint("a whole turn has to be stated as one: by ends that are a whole turn apart");
            Err(Diagnostics::from(diagnostic))
        }
        Some(_) | None => Ok(()),
    };
    for located in &intent.program.steps {
        match &located.step {
            Step::Comment(_) => {}
            Step::Cut(Cut { role: Role::Path | Role::AsAsked, curve: asked, .. }) => {
                let (own, is_curve) = length_of(asked, &metric);
                length += own;
                curve = curve.or(is_curve.then_some(located.span));
            }
            Step::Cut(Cut { role: Role::Approach, .. })
            | Step::Tool(_)
            | Step::Spindle(_)
            | Step::Coolant
            | Step::Home(_)
            | Step::Shift(_)
            | Step::Auxiliary(_)
            | Step::Rapid(_) => {
                ended(length, curve)?;
                (length, curve) = (0.0, None);
            }
        }
    }
    ended(length, curve)
}

/// A length that a curve has at least, mm, and whether it is one, and no lines.
fn length_of(curve: &Curve, metric: &Metric) -> (f64, bool) {
    match curve {
        // Of lines any length is what was asked, and long ones need no look.
        Curve::Lines(_) | Curve::Logarithmic(_) => (f64::INFINITY, false),
        Curve::Arc(arc) => (arc.length() + metric.distance(&arc.start(), &arc.end()).mm, true),
        Curve::Through(_, line) => {
            let mut from = line.start;
            let mut length = 0.0;
            for to in line.points() {
                length += metric.distance(&from, &to).mm;
                from = to;
            }
            (length, true)
        }
        Curve::Polynomial(_) | Curve::Nurbs(_) | Curve::Formula(_) => {
            let pieces: Vec<Bezier> = curve.pieces().iter().map(|piece| metric.scaled(piece)).collect();
            (at_least(&pieces), true)
        }
    }
}
