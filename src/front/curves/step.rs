//! STEP, ISO 10303-21: a text of instances that name each other. `grammar/step.ebnf` has the form of an instance.
//!
//! ```text
//! #12=B_SPLINE_CURVE_WITH_KNOTS('',3,(#1,#2,#3,#4),.UNSPECIFIED.,.F.,.F.,(4,4),(0.,1.),.UNSPECIFIED.);
//! #13=(BOUNDED_CURVE() B_SPLINE_CURVE(2,(#5,#6,#7),.CIRCULAR_ARC.,.F.,.F.)
//!      B_SPLINE_CURVE_WITH_KNOTS((3,3),(0.,1.),.UNSPECIFIED.) CURVE() GEOMETRIC_REPRESENTATION_ITEM()
//!      RATIONAL_B_SPLINE_CURVE((1.,0.707106781186548,1.)) REPRESENTATION_ITEM(''));
//! ```
//!
//! (ISO 10303-42.) Knots stand once with their multiplicities; where an instance has none, they follow from its kind, of
//! degree p with points 0 … n:
//!
//! | kind | knots |
//! |---|---|
//! | quasi-uniform | 0 p + 1 times, 1, 2, … n − p, n − p + 1 p + 1 times |
//! | uniform | −p, … n + 1 |
//! | Bezier | 0 p + 1 times, 1 p times, … n/p p + 1 times |
//!
//! Which curves make the path, and in which order: those of geometric sets as they are listed; edges as loops have
//! them, each once; then all others that no instance makes use of, as they stand in the file. Faces, shells and solids are left
//! out, and told of; so is the placement of parts in an assembly, which is not followed.

mod curves;
mod model;
mod text;
mod units;

use super::Read;
use crate::diagnostic::Diagnostics;
use crate::source::SourceId;

pub use text::instance;

/// Reads a file.
pub(super) fn read(text: &str, id: SourceId) -> Result<Read, Diagnostics> {
    let model = model::Model::of(text, id)?;
    curves::read(&model)
}
