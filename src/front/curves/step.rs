//! STEP.
use super::Read;
use crate::diagnostic::Diagnostics;
use crate::source::SourceId;
pub(super) fn read(_text: &str, _id: SourceId) -> Result<Read, Diagnostics> {
    Err(Diagnostics::new())
}
