//! Small inputs of the field and their right answers, each with the value in it.

mod curves;
