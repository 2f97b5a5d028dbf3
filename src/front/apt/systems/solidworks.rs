//! SolidWorks CAM and CAMWorks.
//!
//! Frame in `CSYS` with twelve numbers by rows; `CIRCLE` with six numbers and no radius, counter-clockwise about its axis.

use super::System;

pub(super) const SYSTEM: System = System {
    name: "solidworks",
    words: "solidworks",
    recognise: |head| head.line("UNIT/") || head.line("TRNTYP/"),
};
