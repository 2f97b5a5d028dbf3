//! CATIA V5 and 3DEXPERIENCE (and Mastercam's APT, which has the same arcs).
//!
//! Frame in `$$*CATIA0` and three rows of remarks; arcs by their start tangent, `INDIRV` and `TLON`; splines in `BEGIN
//! NURBS_SIEMENS`; words after the PP table of the shop.

use super::System;

pub(super) const SYSTEM: System = System {
    name: "catia",
    words: "catia",
    recognise: |head| {
        head.line("$$CATIAAPTVERSION")
            || head.line("$$*CATIA0")
            || head.line("BEGINNURBS_SIEMENS")
            || (head.line("INDIRV/") && head.line("TLON,"))
    },
};
