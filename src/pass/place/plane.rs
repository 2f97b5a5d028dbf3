//! A tool that turns only at rapid stands square to a plane while it works: 3+2 axes. Such a program needs no direction in its
//! blocks and no transformation that leads the tip: the plane is tilted, and X Y Z count in it.
//!
//! # What is written
//!
//! Wherever the tool turns it goes up along its own axis as far as it has been in this plane, retracts in Z of the machine,
//! and the lines of the machine file tilt the next plane. Over the work it goes in X and Y of that plane first, and then down
//! along itself. Where a tool stands upright in such a program its plane is stated too, with three angles of 0: the machine
//! may be tilted.
//!
//! # Numbers
//!
//! The angles are chosen in the decimals that the text has, and places are counted in the plane of these angles. So no
//! rounding moves a place; the tool's direction alone is off, by half a unit of the last decimal or so, and that is stated.
//!
//! # What counts as one direction
//!
//! A file states directions in some decimals, and a unit of the last of them turns no tool. Directions within half of
//! `[orientation] tolerance` of the one that a plane was tilted for are its own, and one that is as near to Z is Z; how far each
//! of them is from the plane's axis is in the bound. The other half of the tolerance is left to the rounding of angles.

use super::Z;
use crate::decimal::{Decimal, round_units};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::geom::arc::Arc;
use crate::geom::deviation::Bound;
use crate::geom::direction;
use crate::geom::rotation::Rotation;
use crate::ir::{Auxiliary, Curve, Cut, Intent, Located, Step, map_along};
use crate::machine::{Machine, Orientation, PlaneApproach};
use crate::source::Span;
use crate::units::{Axes, DEGREES, Position};

/// How many coordinates a place has.
const PLACE: usize = 3;

/// The angles of a plane are rounded, so that an arc that is square to the tool is hardly ever quite so: it is taken for one
/// where that moves it by less than this, mm.
const SQUARE: f64 = 1.0e-4;

type All = Vec<Located<f64, Curve>>;

/// How far a direction may be from another one and count as the same, radians.
fn near(machine: &Machine) -> f64 {
    0.5 * machine.orientation.tolerance / DEGREES
}

/// Z, or against it, where a direction is as near to that.
fn squared(direction: [f64; 3], near: f64) -> [f64; 3] {
    let ends = [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    ends.into_iter().find(|end| direction::angle(end, &direction) <= near).unwrap_or(direction)
}

/// An intent whose tool stands upright all through, as good as its directions say, needs no direction: it is one of three axes.
pub(super) fn upright(intent: &mut Intent, machine: &Machine) {
    let Some(first) = intent.program.axes.direction() else { return };
    let Some(axes) = Axes::new(&intent.program.axes.as_slice()[..first]) else { return };
    let (z, near, mut worst) = ([0.0, 0.0, 1.0], near(machine), 0.0f64);
    let stands = intent.program.steps.iter().all(|located| {
        let strays = match &located.step {
            Step::Rapid(targets) => named_direction(targets, first).map(|d| direction::angle(&d, &z)),
            Step::Cut(cut) => cut.curve.strays(first, &z),
            Step::Comment(_)
            | Step::Tool(_)
            | Step::Spindle(_)
            | Step::Coolant
            | Step::Home(_)
            | Step::Shift(_)
            | Step::Auxiliary(_) => Some(0.0),
        };
        worst = worst.max(strays.unwrap_or(f64::INFINITY));
        worst <= near
    });
    if !stands {
        return;
    }
    let place = |p: &Position| [p[0], p[1], p[2], 0.0, 0.0, 0.0];
    let rapid = |targets: &mut Vec<(usize, f64)>| targets.retain(|(axis, _)| *axis < first);
    map_along(&mut intent.program.steps, PLACE, rapid, place);
    intent.program.steps.retain(|located| located.step != Step::Rapid(Vec::new()));
    intent.program.axes = axes;
    intent.tilt_error = Bound { rad: worst, ..Bound::ZERO };
}

/// Writes an intent of five axes in tilted planes, where the machine has them and the tool turns at rapid only. Where it does not,
/// the answer says so, if there is a plane in which the program could cut, or another reason why the tip is led.
///
/// # Errors
/// No tool is called, the machine file states no home for Z, or the tool cannot be cleared or turned well enough.
pub(super) fn tilt(intent: &mut Intent, machine: &Machine) -> Result<Option<Diagnostic>, Diagnostics> {
    let Some(first) = intent.program.axes.direction() else { return Ok(None) };
    let counts = |name: &str| {
        machine
            .axes
            .as_slice()
            .iter()
            .any(|(axis, _)| axis.as_str() == name && !machine.limits(*axis).reversed)
    };
    if machine.frame.plane.is_empty() || !["X", "Y", "Z"].into_iter().all(counts) {
        return Ok(None);
    }
    let Some(axes) = Axes::new(&intent.program.axes.as_slice()[..first]) else { return Ok(None) };
    if let Err(note) = turns_at_rapid(&intent.program.steps, first, near(machine)) {
        return Ok(note);
    }
    let own = machine.with_axes(&axes)?;
    let mut walk = Walk {
        first,
        machine: &own,
        near: near(machine),
        all: Vec::new(),
        plane: None,
        at: None,
        called: false,
        told: false,
        tilted: false,
        error: Bound::ZERO,
    };
    let steps = &intent.program.steps;
    for located in steps {
        if walk.step(located)?.is_none() {
            let message = "no word of the control makes this move in a tilted plane: the tip of the tool is led all through";
            return Ok(Some(Diagnostic::note("tip-led", message).at(located.span, "")));
        }
    }
    if let Some(last) = steps.last() {
        walk.leave(last.span);
        walk.straighten(last.span);
    }
    let (all, error) = (walk.all, walk.error);
    intent.program.steps = all;
    intent.program.axes = axes;
    intent.tilt_error = error;
    let (degrees, allowed) = (error.rad * DEGREES, machine.orientation.tolerance);
    if degrees <= allowed {
        return Ok(None);
    }
    let message = format!(
        "angles of {} decimals turn the tool by up to {degrees:.4} degrees from where it should be, more than {allowed}",
        machine.digits.rotary
    );
    Err(Diagnostic::refusal("direction-too-far", message)
        .hint("[digits] rotary and [orientation] tolerance of the machine file")
        .into())
}

/// Whether every path keeps the direction with which the rapid before it came, and each tool comes by a rapid. Otherwise: where the
/// first does not, if another one that is tilted does.
fn turns_at_rapid(steps: &[Located<f64, Curve>], first: usize, near: f64) -> Result<(), Option<Diagnostic>> {
    let mut stands: Option<[f64; 3]> = None;
    let (mut turns, mut tilted) = (None, false);
    for located in steps {
        match &located.step {
            Step::Tool(_) => stands = None,
            Step::Rapid(targets) => {
                let named = named_direction(targets, first);
                let known = |d: &[f64; 3]| {
                    let angle = |stands: &[f64; 3]| direction::angle(stands, d);
                    stands.filter(|stands| angle(stands) <= near).unwrap_or(squared(*d, near))
                };
                stands = named.as_ref().map(known);
                if stands.is_none() {
                    turns = turns.or(Some(located.span));
                }
            }
            Step::Cut(cut) => {
                let strays = stands.and_then(|d| cut.curve.strays(first, &d));
                if strays.is_some_and(|strays| strays <= near) {
                    tilted |= stands.is_some_and(|[x, y, _]| x != 0.0 || y != 0.0);
                } else {
                    turns = turns.or(Some(located.span));
                }
            }
            Step::Comment(_)
            | Step::Spindle(_)
            | Step::Coolant
            | Step::Home(_)
            | Step::Shift(_)
            | Step::Auxiliary(_) => {}
        }
    }
    let Some(span) = turns else { return Ok(()) };
    let message = "the tool turns here while it cuts: its tip is led all through, in no tilted plane";
    Err(tilted.then(|| Diagnostic::note("tip-led", message).at(span, "")))
}

/// The direction that a rapid names.
fn named_direction(targets: &[(usize, f64)], first: usize) -> Option<[f64; 3]> {
    let component = |i: usize| targets.iter().find(|(axis, _)| *axis == first + i).map(|(_, x)| *x);
    Some([component(0)?, component(1)?, component(2)?])
}

/// A plane that is in force.
struct Tilted {
    /// The direction that it was tilted for.
    asked: [f64; 3],
    rotation: Rotation,
    /// The greatest height in it so far, mm.
    top: f64,
}

struct Walk<'m> {
    first: usize,
    machine: &'m Machine,
    /// How far directions of one plane may be apart, radians.
    near: f64,
    all: All,
    plane: Option<Tilted>,
    /// Where the input takes the tip to be, in the work's own coordinates.
    at: Option<[f64; 3]>,
    called: bool,
    /// Whether no section began since the last move: its first rapid names every axis.
    told: bool,
    /// Whether the last plane was not upright.
    tilted: bool,
    error: Bound,
}

impl Walk<'_> {
    fn push(&mut self, step: Step<f64, Curve>, span: Span) {
        self.all.push(Located { step, span });
    }

    /// Takes a step; none where a curve has no place in a plane.
    fn step(&mut self, located: &Located<f64, Curve>) -> Result<Option<()>, Diagnostics> {
        let span = located.span;
        match &located.step {
            Step::Tool(_) => {
                self.leave(span);
                self.called = true;
                self.push(located.step.clone(), span);
            }
            Step::Rapid(targets) => {
                let named = |i: usize| targets.iter().find(|(axis, _)| *axis == i).map(|(_, to)| *to);
                let place = [0, 1, 2].map(|i| named(i).or(self.at.map(|at| at[i])));
                let ([Some(x), Some(y), Some(z)], Some(asked)) =
                    (place, named_direction(targets, self.first))
                else {
                    return Ok(None);
                };
                self.rapid([x, y, z], asked, span)?;
            }
            Step::Cut(cut) => {
                let Some(plane) = &mut self.plane else { return Ok(None) };
                let Some((curve, off)) = plane.counted(&cut.curve) else { return Ok(None) };
                let Some((_, [x, y, z, ..])) = curve.ends() else { return Ok(None) };
                let strays = cut.curve.strays(self.first, &plane.rotation.axis());
                self.error.rad = self.error.rad.max(strays.unwrap_or(0.0));
                self.error.mm = self.error.mm.max(off);
                plane.top = plane.top.max(curve.greatest(Z));
                self.at = Some(plane.rotation.out([x, y, z]));
                self.told = true;
                self.push(Step::Cut(Cut { feed: cut.feed, role: cut.role, curve }), span);
            }
            // The plane is left by way of it.
            Step::Home(_) if self.plane.is_some() => self.leave(span),
            Step::Comment(_) => {
                self.told = false;
                self.push(located.step.clone(), span);
            }
            Step::Spindle(_) | Step::Coolant | Step::Home(_) | Step::Shift(_) | Step::Auxiliary(_) => {
                self.push(located.step.clone(), span);
            }
        }
        Ok(Some(()))
    }

    /// Goes to a place at rapid with the tool in a direction.
    fn rapid(&mut self, place: [f64; 3], asked: [f64; 3], span: Span) -> Result<(), Diagnostics> {
        let apart = |plane: &Tilted| direction::angle(&plane.asked, &asked);
        let turns = self.plane.as_ref().is_none_or(|plane| self.near < apart(plane));
        if turns {
            self.leave(span);
            self.enter(squared(asked, self.near), span)?;
        }
        let Some(plane) = &mut self.plane else { return Ok(()) };
        let turned = direction::angle(&plane.rotation.axis(), &asked);
        self.error.rad = self.error.rad.max(turned);
        let to = plane.rotation.into_frame(place);
        plane.top = plane.top.max(to[Z]);
        let from = self.at.filter(|_| !turns && self.told).map(|at| plane.rotation.into_frame(at));
        self.at = Some(place);
        self.told = true;
        if turns {
            self.push(Step::Rapid((0..PLACE).map(|i| (i, to[i])).collect()), span);
            return Ok(());
        }
        let digits = self.machine.digits.linear;
        let moves = |i: &usize| from.is_none_or(|from| !same(from[*i], to[*i], digits));
        let targets: Vec<(usize, f64)> = (0..PLACE).filter(moves).map(|i| (i, to[i])).collect();
        // Where nothing moves nothing is written.
        if !targets.is_empty() {
            self.push(Step::Rapid(targets), span);
        }
        Ok(())
    }

    /// Tilts the plane square to a direction.
    fn enter(&mut self, asked: [f64; 3], span: Span) -> Result<(), Diagnostics> {
        if !self.called {
            let message = "a plane is to be tilted, and no tool is called: its length is not known";
            return Err(Diagnostic::error("tool-missing", message).at(span, "").into());
        }
        if !self.machine.retracts(Z) {
            let message = "the tool turns here, and the machine file states no place in Z where it is clear";
            return Err(Diagnostic::refusal("home-missing", message)
                .at(span, "")
                .hint("state [axis.Z] home, or plane = [] under [program] where the tip is to be led")
                .into());
        }
        let Orientation { plane_order: order, plane_approach: approach, .. } = self.machine.orientation;
        if asked[Z] < 0.0 && approach == PlaneApproach::Together {
            let message = "the tool comes from below here, and Z would take a head that tilts through the work on its way home";
            return Err(Diagnostic::refusal("plane-from-below", message)
                .at(span, "")
                .hint("[orientation] plane_approach = \"over\" is for a table that tilts; plane = [] under [program] leads the tip")
                .into());
        }
        let digits = self.machine.digits.rotary;
        let angles = Rotation::level(asked).angles(order).map(|angle| rounded(angle, digits));
        self.push(Step::Auxiliary(Auxiliary::Plane(angles)), span);
        self.tilted = angles != [0.0; PLACE];
        let rotation = Rotation::of(order, angles);
        self.plane = Some(Tilted { asked, rotation, top: f64::NEG_INFINITY });
        Ok(())
    }

    /// Leaves the plane: up along the tool, home in Z, and no plane any more.
    fn leave(&mut self, span: Span) {
        let Some(plane) = self.plane.take() else { return };
        let height = self.at.map(|at| plane.rotation.into_frame(at)[Z]);
        if let Some(height) = height
            && height < plane.top
            && !same(height, plane.top, self.machine.digits.linear)
        {
            self.push(Step::Rapid(vec![(Z, plane.top)]), span);
        }
        self.push(Step::Home(Z), span);
        self.push(Step::Auxiliary(Auxiliary::PlaneEnd), span);
    }

    /// Turns the tool upright at the end, with Z at home: the next program may know nothing of planes.
    fn straighten(&mut self, span: Span) {
        if self.tilted {
            self.push(Step::Auxiliary(Auxiliary::Plane([0.0; PLACE])), span);
            self.push(Step::Auxiliary(Auxiliary::PlaneEnd), span);
        }
    }
}

/// An angle in the decimals of the text.
fn rounded(angle: f64, digits: u8) -> f64 {
    Decimal::round(angle, digits).map_or(angle, Decimal::to_f64)
}

/// Whether two places of an axis are one in the text.
fn same(a: f64, b: f64, digits: u8) -> bool {
    round_units(a, digits) == round_units(b, digits)
}

impl Tilted {
    /// A curve as the plane counts it, and how far that is from it at most, mm; none where no word of a control fits it.
    fn counted(&self, curve: &Curve) -> Option<(Curve, f64)> {
        let place = |p: &Position| {
            let [x, y, z] = self.rotation.into_frame([p[0], p[1], p[2]]);
            [x, y, z, 0.0, 0.0, 0.0]
        };
        if let Curve::Arc(arc) = curve {
            let (arc, off) = self.arc(arc);
            return Some((Curve::Arc(arc), off));
        }
        Some((curve.mapped(PLACE, place)?, 0.0))
    }

    /// An arc as the plane counts it, and how far that is from it at most, mm: about an axis that is θ off, its places are
    /// up to Rθ out of the plane, and as far from the straight rise between its ends.
    fn arc(&self, arc: &Arc) -> (Arc, f64) {
        let plain = arc.mapped_along(|p| [p[0], p[1], p[2], 0.0, 0.0, 0.0]);
        let counted = plain.turned(&self.rotation.inverse(), SQUARE / arc.radius());
        let [.., asked] = arc.frame().axes();
        let [.., axis] = counted.frame().axes();
        let off = direction::angle(&self.rotation.into_frame(asked), &axis);
        (counted, 2.0 * arc.radius() * off.min(std::f64::consts::PI - off))
    }
}
