//! NX CLSF.
//!
//! Frame in `MSYS`; `CIRCLE` with eleven numbers, clockwise about its axis; the tool axis of a `GOTO` with six numbers
//! holds until the next; splines in `NURBS/`. A hole's `FEDTO` is negative below its point.

use super::System;

pub(super) const SYSTEM: System = System {
    name: "nx",
    words: "nx",
    recognise: |head| {
        head.line("TOOLPATH/") || head.line("TLDATA/") || head.line("MSYS/") || head.line("PAINT/")
    },
};
