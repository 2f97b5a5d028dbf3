//! splinepost.
pub mod decimal;
pub mod diagnostic;
pub mod geom;
pub mod ir;
pub mod source;
pub mod units;
