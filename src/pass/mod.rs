//! From what was asked to what one machine takes. Each pass is a function; `compile` in the crate's root calls them in
//! this order:
//!
//! | pass | what |
//! |---|---|
//! | [`choose`] | one motion for the program, where `auto` leaves it open |
//! | [`settle`] | method and Δl, where the input leaves them open: after this the intent is exact |
//! | [`place`] | work offsets, where an axis wraps or sections are to be alike |
//! | [`stretch`] | what F has to be, and where a path is cut so that it can be |
//! | [`fit`](mod@fit) | runs of lines become splines, where that is asked for |
//! | [`interpolate`] | logarithmic curves become steps, points or pieces |
//! | [`approximate`] | other curves that the form cannot take exactly are fitted, within `interpolate` |
//! | [`convert`] | every curve takes the form of the motion, exactly |
//! | [`quantise`] | every number is rounded, once |
//! | [`check`] | what is left fits the machine: the result is [`check::Legal`] |
//! | [`range`], [`limits`] | how far and how fast each axis has to move |

pub mod approximate;
pub mod arcs;
pub mod check;
pub mod choose;
pub mod convert;
pub mod fit;
pub mod interpolate;
pub mod limits;
pub mod place;
pub mod quantise;
pub mod range;
pub mod settle;
pub mod stretch;
