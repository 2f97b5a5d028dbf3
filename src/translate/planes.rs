//! Places that count in tilted planes, in the coordinates of the work: the tool's direction is stated instead, and the machine
//! that the program is written for next tilts planes of its own or leads the tip.

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::geom::rotation::{Order, Rotation};
use crate::ir::{Auxiliary, Curve, Cut, Located, Program, Step};
use crate::source::Span;
use crate::units::{Axes, Position};

/// How many coordinates a place has.
const PLACE: usize = 3;

/// The axis that comes down to the work.
const Z: usize = 2;

/// Counts the places of a program with tilted planes in the coordinates of the work. A rapid names some of the plane's axes; the
/// place that it leads to is known once all were named, and the tool goes there at once. From its home it goes over the work
/// first, as ever.
///
/// # Errors
/// Other axes than X Y Z are moved, a path starts at a place that nothing says, or it is a curve of the control's own.
pub(super) fn count_back(program: &mut Program<f64, Curve>, order: Order) -> Result<(), Diagnostics> {
    let first = program.steps.iter().find(|located| is_plane(&located.step)).map(|located| located.span);
    let Some(span) = first else { return Ok(()) };
    let own = Axes::with_direction();
    if program.axes.as_slice() != &own.as_slice()[..PLACE] {
        let message = "tilted planes are translated where X, Y and Z are all that moves";
        return Err(Diagnostic::error("plane-translated", message).at(span, "").into());
    }
    let mut back = Back { rotation: Rotation::NONE, at: [None; PLACE], unmet: None };
    let mut steps = Vec::with_capacity(program.steps.len());
    for Located { step, span } in std::mem::take(&mut program.steps) {
        steps.extend(back.step(step, order, span)?.map(|step| Located { step, span }));
    }
    back.met()?;
    program.steps = steps;
    program.axes = own;
    Ok(())
}

fn is_plane(step: &Step<f64, Curve>) -> bool {
    matches!(step, Step::Auxiliary(Auxiliary::Plane(_)))
}

struct Back {
    rotation: Rotation,
    /// Where the tip is, as the plane counts it.
    at: [Option<f64>; PLACE],
    /// A rapid that leads to no place that is known yet.
    unmet: Option<Span>,
}

impl Back {
    /// A place of the plane, and the tool's direction.
    fn place(&self, p: &Position) -> Position {
        let [x, y, z] = self.rotation.out([p[0], p[1], p[2]]);
        let [i, j, k] = self.rotation.axis();
        [x, y, z, i, j, k]
    }

    /// Refuses a rapid that would be lost: it leads to no place of the work.
    fn met(&self) -> Result<(), Diagnostics> {
        let Some(span) = self.unmet else { return Ok(()) };
        let message = "this rapid leads to no place of the work: nothing says where its other axes are";
        Err(Diagnostic::error("plane-translated", message).at(span, "").into())
    }

    fn step(
        &mut self,
        step: Step<f64, Curve>,
        order: Order,
        span: Span,
    ) -> Result<Option<Step<f64, Curve>>, Diagnostics> {
        Ok(match step {
            Step::Auxiliary(Auxiliary::Plane(angles)) => {
                self.met()?;
                *self = Back { rotation: Rotation::of(order, angles), at: [None; PLACE], unmet: None };
                None
            }
            Step::Auxiliary(Auxiliary::PlaneEnd) => {
                self.met()?;
                *self = Back { rotation: Rotation::NONE, at: [None; PLACE], unmet: None };
                None
            }
            Step::Home(axis) => {
                self.met()?;
                self.at[axis] = None;
                Some(Step::Home(axis))
            }
            Step::Rapid(targets) => {
                for (axis, to) in targets {
                    if axis == Z && (self.at[0].is_none() || self.at[1].is_none()) {
                        // Over the work comes first wherever the program is written next.
                        self.unmet = Some(span);
                        self.met()?;
                    }
                    self.at[axis] = Some(to);
                }
                let [Some(x), Some(y), Some(z)] = self.at else {
                    self.unmet = self.unmet.or(Some(span));
                    return Ok(None);
                };
                self.unmet = None;
                let place = self.place(&[x, y, z, 0.0, 0.0, 0.0]);
                Some(Step::Rapid(place.into_iter().enumerate().collect()))
            }
            Step::Cut(cut) => {
                if self.at.contains(&None) {
                    let message = "this path starts at a place that nothing says since the plane was tilted";
                    return Err(Diagnostic::error("start-unknown", message).at(span, "").into());
                }
                let (Some(curve), Some((_, end))) = (self.curve(&cut.curve), cut.curve.ends()) else {
                    let message = "a control's own spline in a tilted plane is not translated";
                    return Err(Diagnostic::error("plane-translated", message).at(span, "").into());
                };
                self.at = [0, 1, 2].map(|i| Some(end[i]));
                Some(Step::Cut(Cut { curve, ..cut }))
            }
            other @ (Step::Comment(_)
            | Step::Tool(_)
            | Step::Spindle(_)
            | Step::Coolant
            | Step::Shift(_)
            | Step::Auxiliary(_)) => Some(other),
        })
    }

    /// A curve of the plane in the coordinates of the work; none of one that only the control knows.
    fn curve(&self, curve: &Curve) -> Option<Curve> {
        let place = |p: &Position| self.place(p);
        Some(match curve {
            Curve::Lines(line) => Curve::Lines(line.mapped(2 * PLACE, place)),
            Curve::Arc(arc) => {
                let [i, j, k] = self.rotation.axis();
                let turned = arc.turned(&self.rotation, 0.0);
                Curve::Arc(turned.mapped_along(|p| [p[0], p[1], p[2], i, j, k]))
            }
            Curve::Polynomial(pieces) => {
                Curve::Polynomial(pieces.iter().map(|piece| piece.mapped(place)).collect())
            }
            Curve::Nurbs(nurbs) => Curve::Nurbs(nurbs.mapped(place)),
            Curve::Through(..) | Curve::Logarithmic(_) | Curve::Formula(_) => return None,
        })
    }
}
