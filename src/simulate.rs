//! The path as a control would run it, cycle by cycle.
//!
//! | module | what |
//! |---|---|
//! | [`partition`] | the next point of a curve: the one whose chord is F·T |
//! | [`shape`] | curves in the form that is quickest to evaluate |
//!
//! `docs/simulation.md` has the formulas and what was measured.

pub mod partition;
pub mod shape;
