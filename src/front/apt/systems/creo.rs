//! Creo NCL.
//!
//! Frame in `$$-> CSYS`; `CIRCLE` with seven numbers, counter-clockwise about its axis; cycles with words; splines in
//! `MOVNRB`. The point of a cycle's `GOTO` is the top of the hole.

use super::System;

pub(super) const SYSTEM: System = System {
    name: "creo",
    words: "creo",
    recognise: |head| head.line("$$*PRO/CLFILE") || head.line("$$->MFGNO") || head.line("$$->FEATNO"),
};
