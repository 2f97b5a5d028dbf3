//! Small inputs, `fixtures/cases/`, and what becomes of them, each with its right value.
//!
//! | module | what it holds |
//! |---|---|
//! | `cl` | CL data: what its statements mean, as it stands in the program of every machine |
//! | `left` | what a program leaves behind on the control, at tool changes and at its end, and what its remarks are made of |

mod cl;
mod left;
