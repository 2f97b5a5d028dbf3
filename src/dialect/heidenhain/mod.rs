//! stub
use super::{Dialect, Motion};
/// The dialect.
pub const DIALECT: Dialect = Dialect {
    name: "heidenhain",
    about: "",
    motions: &[] as &[Motion],
    naming: ("", |_| true),
    write: |_, _| String::new(),
    read: |_, _, _| Err(crate::diagnostic::Diagnostics::new()),
};
