//! The plain language of ISO 3592 and ISO 4343, for what no other system wrote.

use super::System;

pub(super) const SYSTEM: System = System { name: "iso", words: "iso", recognise: |_| false };
