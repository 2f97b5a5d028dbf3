//! Arcs of controls that spell them G2 and G3 with the centre in I J K, counted from where the arc starts.
//!
//! ```text
//! G2 X10 Y0 I5 J0          from (0, 0) to (10, 0) about (5, 0), clockwise seen against Z
//! G3 X0 Y0 Z-1 I5 J0       a whole turn of a helix where it ends over its start
//! G18 G2 X10 Z0 I5 K0      in another plane: seen against Y
//! G3 X5 Y5 Z-9 I5 J0 TURN=2    two whole turns before the way to the end, on controls that have the word
//! ```
//!
//! I J K and TURN are never modal.
//!
//! # An end that is not on the circle
//!
//! Start, end and centre are three rounded places, so that the radii to start and end differ. A control compares them and stops
//! where they differ by more than its own limit:
//!
//! | control | limit |
//! |---|---|
//! | Sinumerik | machine data 21000 or, of large circles, 21010 times the radius: alarm 14040 |
//! | Heidenhain | `circleDeviation` or MP 7431, 0.016 mm at most |
//! | Mazak | a parameter of the machine |
//!
//! What a control makes of less is its own: one moves the centre, another the radius along the way. So what rounding explains is
//! taken for one circle, more is warned of, and beyond [`MISFIT_REFUSED`] nobody knows which circle was meant.

use super::assemble::Assembler;
use super::modal::Modal;
use crate::decimal::{Decimal, Spelling, write_units};
use crate::diagnostic::Diagnostic;
use crate::geom::arc::{Plane, Sense};
use crate::ir::{ArcBy, Circle, Units, Written, WrittenArc};
use crate::machine::Machine;
use crate::source::Span;
use crate::units::Axis;
use crate::verify::to_arc;

/// Programs are commonly rounded to so many decimals, whatever the control takes.
const COMMON_DIGITS: u8 = 3;

/// Radii to start and end that differ by more are those of no circle, mm. Below the greatest figure that a Heidenhain can be set
/// to, and three times what three decimals explain.
pub const MISFIT_REFUSED: f64 = 0.01;

/// The letters of the centre, in the order of X Y Z.
const CENTER: [u8; 3] = *b"IJK";

/// The word that chooses a plane.
pub fn plane_word(plane: Plane) -> &'static str {
    match plane {
        Plane::Xy => "G17",
        Plane::Zx => "G18",
        Plane::Yz => "G19",
    }
}

/// The word of a sense.
pub fn motion_word(sense: Sense) -> &'static str {
    match sense {
        Sense::Clockwise => "G2",
        Sense::CounterClockwise => "G3",
    }
}

/// The sense of an arc as the control sees it: where it counts one of the plane's axes the other way, it sees a mirror
/// image. The same way back.
pub fn counted_sense(machine: &Machine, plane: Plane, sense: Sense) -> Sense {
    let reversed = machine.reversed();
    let [u, v, _] = plane.axes();
    if reversed[u] == reversed[v] { sense } else { sense.reversed() }
}

/// The circle of an arc, where the block states it by its end, and how many whole turns it makes before.
pub fn stated_circle(arc: &WrittenArc) -> Option<(Circle, u32)> {
    match arc.by {
        ArcBy::Center(circle, turns) => Some((circle, turns)),
        ArcBy::Way(_) | ArcBy::Turn(..) => None,
    }
}

/// Writes an arc about a centre as one block. `plane` is the one in force; another is chosen in the block.
pub fn write(
    modal: &mut Modal<'_>,
    arc: &WrittenArc,
    (circle, turns): (Circle, u32),
    feed: Option<Decimal>,
    plane: &mut Option<Plane>,
) {
    let [u, v, w] = circle.plane.axes();
    modal.begin("N");
    if *plane != Some(circle.plane) {
        modal.text(plane_word(circle.plane));
        modal.gap();
        *plane = Some(circle.plane);
    }
    modal.motion(motion_word(counted_sense(modal.machine, circle.plane, circle.sense)));
    modal.inverse(false);
    let axes = modal.direction.unwrap_or(modal.machine.axes.count());
    let digits = modal.machine.axis_digits();
    for i in 0..axes {
        let in_plane = i == u || i == v;
        if in_plane || modal.position[i] != Some(arc.end[i]) || (i == w && arc.start[w] != arc.end[w]) {
            modal.axis(i, arc.end[i]);
        }
    }
    for i in 0..3 {
        let center = match i {
            _ if i == u => circle.center[0],
            _ if i == v => circle.center[1],
            _ => continue,
        };
        modal.out.push(CENTER[i]);
        let spelling = Spelling { sign_always: false, ..modal.spelling };
        // From where the arc starts, as the control counts: no work offset is in it.
        let offset = modal.counted(i, center) - modal.counted(i, arc.start[i]);
        write_units(&mut modal.out, offset, digits[i], spelling);
        modal.gap();
    }
    if turns != 0 {
        modal.text("TURN=");
        modal.text(itoa::Buffer::new().format(turns));
        modal.gap();
    }
    modal.directions(&arc.end);
    modal.feed(feed);
    modal.reached(&arc.end);
    modal.end();
}

/// What a block of G2 or G3 says beside its axes.
pub struct Said<'b> {
    /// The plane in force.
    pub plane: Plane,
    /// G2 or G3.
    pub sense: Sense,
    /// The axes named.
    pub named: &'b [(usize, i64)],
    /// I J K.
    pub offsets: [Option<Decimal>; 3],
    /// TURN.
    pub turns: u32,
    /// The line of the text.
    pub line: u32,
    /// The block.
    pub span: Span,
}

/// Adds the arc that a block of G2 or G3 means.
pub fn read(assembler: &mut Assembler<'_>, said: &Said<'_>) {
    let range = || said.span.start as usize..said.span.end as usize;
    let [u, v, w] = said.plane.axes();
    let names = ["X", "Y", "Z"];
    if !(0..3)
        .all(|i| Axis::new(names[i]).is_some_and(|axis| assembler.machine.axes.index_of(axis) == Some(i)))
    {
        return assembler.error("arc-axes", "arcs are read where the first axes are X Y Z", range());
    }
    if said.offsets[w].is_some() {
        let message = format!("{} is no centre in this plane", char::from(CENTER[w]));
        return assembler.error("arc-center", message, range());
    }
    if said.offsets.iter().all(Option::is_none) {
        return assembler.error("arc-center", "an arc without its centre in I J K", range());
    }
    if !is_placed(assembler, &[u, v], said.named, w, said.span) {
        return;
    }
    let end = assembler.target(said.named);
    let start: Units = assembler.start(said.named, &end, said.span);
    let reversed = assembler.machine.reversed();
    let mut center = [0; 2];
    for (center, i) in center.iter_mut().zip([u, v]) {
        let offset = said.offsets[i].unwrap_or_default();
        let Some(units) = offset.units(assembler.digits[i]) else {
            let message = format!("{offset} has more decimals than the machine file gives this axis");
            return assembler.error("digits-too-many", message, range());
        };
        let units = if reversed[i] { units.checked_neg() } else { Some(units) };
        match units.and_then(|units| start[i].checked_add(units)) {
            Some(sum) => *center = sum,
            None => return assembler.error("arc-center", "the centre is out of range", range()),
        }
    }
    let sense = counted_sense(assembler.machine, said.plane, said.sense);
    if said.turns != 0 && start[u] == end[u] && start[v] == end[v] {
        let message = "whether TURN counts the turn of an arc that ends over its start no page says";
        return assembler.error("arc-turns", message, range());
    }
    let by = ArcBy::Center(Circle { plane: said.plane, sense, center }, said.turns);
    let arc = WrittenArc { start, end, by, line: said.line };
    add(assembler, arc, &end, said.span);
}

/// Whether an arc starts from a place that the text says, in these axes, and in `along` where it goes along it: its centre counts
/// from there.
pub fn is_placed(
    assembler: &mut Assembler<'_>,
    plane: &[usize],
    named: &[(usize, i64)],
    along: usize,
    span: Span,
) -> bool {
    let goes_along = named.iter().any(|(axis, _)| *axis == along).then_some(along);
    let mut axes = plane.iter().copied().chain(goes_along);
    let Some(axis) = axes.find(|axis| assembler.position[*axis].is_none()) else { return true };
    let message = format!(
        "where {} is at the start of this arc the text does not say",
        assembler.machine.axes.name(axis)
    );
    assembler.diagnostics.push(
        Diagnostic::error("place-unknown", message)
            .at(span, "")
            .hint("nothing named it yet, or it went to its home: a rapid before says where it is"),
    );
    false
}

/// Adds an arc that has a radius, and an end on its circle.
pub fn add(assembler: &mut Assembler<'_>, arc: WrittenArc, end: &Units, span: Span) {
    if to_arc(&assembler.empty(), &arc).is_none() {
        let diagnostic = Diagnostic::error("arc-radius", "this arc has no radius").at(span, "");
        assembler.diagnostics.push(diagnostic);
        return;
    }
    match arc.by {
        ArcBy::Center(circle, _) => {
            let misfit = circle.misfit(&assembler.digits, (&arc.start, end));
            let common = assembler.digits.map(|digits| digits.min(COMMON_DIGITS));
            let refused = MISFIT_REFUSED.max(circle.rounding(&assembler.digits));
            if refused < misfit {
                let message = format!(
                    "this arc ends beside its circle: the radii to its start and to its end differ by {misfit:.4} mm"
                );
                assembler.diagnostics.push(Diagnostic::error("arc-misfit", message).at(span, "").hint(
                    format!(
                        "up to {refused} mm is read; a control stops here, or runs a circle of its own choice"
                    ),
                ));
            } else if circle.rounding(&common) < misfit {
                assembler.misfits(misfit, span);
            }
        }
        // Neither states an end beside another circle.
        ArcBy::Way(_) | ArcBy::Turn(..) => {}
    }
    assembler.curve(Written::Arc(arc), end, span);
}
