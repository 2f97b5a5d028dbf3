//! IGES 5.3, the fixed ASCII form: lines of 80 columns, of which the 73rd says the section. `grammar/iges.ebnf` has the form.
//!
//! | section | what |
//! |---|---|
//! | S | remarks |
//! | G | delimiters, units |
//! | D | the directory: two lines of ten fields of eight columns an entity, known by the number of its first line |
//! | P | parameters, delimited, up to column 64 |
//! | T | how many lines each section has |
//!
//! A rational B-spline (126) states its upper index K, its degree M, four properties, the knots T(−M) … T(N+M) with
//! N = K + 1 − M, the weights W(0) … W(K), the points and the range V(0) … V(1), which may be a part of what its knots
//! allow. A parametric spline (112) states for each of its pieces T(i) ≤ u ≤ T(i+1) and each coordinate
//!
//! ```text
//! X(u) = AX + BX s + CX s² + DX s³          s = u − T(i)
//! ```
//!
//! A composite curve (102) runs its parts in order. Where a directory entry names a transformation (124), places p become
//! R p + T; parts have their own and that of the whole.
//!
//! Entities that depend on others (a trimmed surface and its boundary) and blanked ones are left out, and told of.

mod cards;
mod entities;

use super::Read;
use crate::diagnostic::Diagnostics;
use crate::source::SourceId;

/// Reads a file.
pub(super) fn read(text: &str, id: SourceId) -> Result<Read, Diagnostics> {
    let cards = cards::Cards::of(text, id)?;
    entities::read(&cards)
}
