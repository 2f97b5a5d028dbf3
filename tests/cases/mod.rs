//! Small inputs and what becomes of them, each with its right value.
//!
//! | module | what it holds |
//! |---|---|
//! | `left` | what a program leaves behind on the control, at tool changes and at its end, and what its remarks are made of |

mod left;
