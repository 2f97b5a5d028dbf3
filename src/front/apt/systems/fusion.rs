//! Fusion's ISO 4343 APT, and hyperMILL.
//!
//! Arcs in `MOVARC` with their sweep; cycles with numbers at fixed places.

use super::System;

pub(super) const SYSTEM: System = System {
    name: "fusion",
    words: "fusion",
    recognise: |head| head.line("MOVARC/") || head.line("MODE/MILL") || head.line("SPINDL/MAIN"),
};
