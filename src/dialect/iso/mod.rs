//! stub
use super::{Dialect, Motion};
/// The dialect.
pub const MAZAK: Dialect = Dialect {
    name: "mazak",
    about: "",
    motions: &[] as &[Motion],
    naming: ("", |_| true),
    write: |_, _| String::new(),
    read: |_, _, _| Err(crate::diagnostic::Diagnostics::new()),
};
