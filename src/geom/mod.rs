//! Curves in Rⁿ, their fits, and bounds on the distance between them.
//!
//! A curve is a function from \[0, 1\] to Rⁿ, n ≤ 6. Nothing here knows a control, a file or a unit beyond
//! millimetres and degrees. In reading order:
//!
//! | module | what |
//! |---|---|
//! | [`elementary`] | the only transcendental functions of the project |
//! | [`logcurve`] | the path of a conical cutter, A = a ln(1 + bX) |
//! | [`oddeven`] | its points by the odd-even third-order steps |
//! | [`arc`] | arcs and helices, and how far a control may be from one |
//! | [`rotation`] | frames that are turned, and the three angles that state them |
//! | [`bernstein`] | polynomials whose coefficients bound them |
//! | [`bezier`] | one piece of a curve, rational where it must be |
//! | [`expr`] | expressions in one parameter, their derivatives and bounds |
//! | [`nurbs`] | knots, insertion, pieces to spline and back |
//! | [`knots`] | clamping, degree elevation, by the blossom |
//! | [`fit`] | few pieces within a tolerance |
//! | [`chain`] | a curve of many pieces as one function |
//! | [`geometric`] | few pieces within a tolerance of any curve |
//! | `relax` | one cubic fewer, by joints that leave the curve |
//! | [`smooth`] | runs of points to splines, corners kept |
//! | [`runs`] | such a run beside its spline: distances, curvature, corners |
//! | [`deviation`] | the proof: upper bounds on the distance of two curves run in order |
//! | [`follow`] | the same for any two paths of pieces, as a whole or place by place |
//! | [`round`] | arcs as such pieces |

pub mod arc;
pub mod bernstein;
pub mod bezier;
pub mod chain;
pub mod deviation;
pub mod direction;
pub mod elementary;
pub mod expr;
pub mod fit;
pub mod follow;
pub mod geometric;
pub mod knots;
pub mod length;
pub mod logcurve;
pub mod nurbs;
pub mod oddeven;
mod relax;
pub mod rotation;
pub mod round;
pub mod runs;
pub mod smooth;

#[cfg(test)]
mod tests;
