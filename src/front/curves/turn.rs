//! How far an arc turns, from what its file states: the one rule of all readers.
//!
//! Files state a whole turn as an end that is 2π behind the start, rounded up or down. Reduced to one turn, an end a hair
//! above 2π is an arc of a hair, a point on the work instead of a circle. So nothing is reduced before this is decided:
//!
//! ```text
//! d = end − start, radians                    as stated; degrees and other units are converted first
//! |d − 2πk| ≤ 10⁻⁵ for some k ≥ 1             a whole turn
//! 0 < d < 2π                                  an arc of d
//! |d| ≤ 10⁻⁵, d ≤ 0                           no arc: an error
//! |d| beyond a turn, d mod 2π within 10⁻³ of one or of none     either could be meant: an error
//! otherwise                                   an arc of d mod 2π
//! ```
//!
//! Arcs whose ends are places instead are whole where the places are one: no farther apart than what the file says that it
//! can tell apart. Farther apart, with a turn that is within 10⁻⁵ of none or of a whole one, either could be meant.
//!
//! What a whole turn differs from the stated one, 10⁻⁵ R at most, is kept, and counts in the bound of the proof.

use super::conic::TURN;
use crate::diagnostic::Diagnostic;
use crate::source::Span;

/// How far a stated turn may be from a whole one, radians: six digits of 2π, and all coarser ways of printing that are in use.
const WHOLE: f64 = 1.0e-5;

/// Nearer to a whole turn than this, radians, an angle that is to be reduced first may have been meant as one: 2π in four
/// decimals.
const UNCLEAR: f64 = 1.0e-3;

/// How far an arc turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Turn {
    /// Radians, more than none and a whole turn at most.
    pub(super) by: f64,
    /// What it may differ from the turn that is stated, radians.
    pub(super) error: f64,
}

impl Turn {
    /// A whole turn.
    pub(super) const WHOLE: Turn = Turn { by: TURN, error: 0.0 };

    /// Whether it is a whole turn.
    pub(super) fn is_whole(self) -> bool {
        self.by == TURN
    }
}

fn unclear(message: String, span: Span) -> Diagnostic {
    Diagnostic::error("turn-unclear", message)
        .at(span, "")
        .hint("export a whole circle or ellipse as one, or its end as its start and 360 degrees")
}

/// The turn of an arc whose angles differ by `stated` radians.
///
/// # Errors
/// A whole turn or none could be meant.
pub(super) fn between_angles(kind: &str, stated: f64, span: Span) -> Result<Turn, Diagnostic> {
    let turns = (stated / TURN).round();
    let error = (stated - turns * TURN).abs();
    if 1.0 <= turns && error <= WHOLE {
        return Ok(Turn { by: TURN, error });
    }
    if 0.0 < stated && stated < TURN {
        return Ok(Turn { by: stated, error: 0.0 });
    }
    if stated.abs() <= WHOLE {
        let message =
            format!("{kind} ends at the angle where it starts: a point, or a whole turn that is not stated");
        return Err(unclear(message, span));
    }
    let by = stated.rem_euclid(TURN);
    // A huge angle has lost what it had behind the whole turns.
    let beyond = !(stated.abs() <= TURN - UNCLEAR);
    if beyond && (error < UNCLEAR || !(stated.abs() <= 1.0e6)) {
        let message = format!("{kind} turns by {stated} radians: next to nothing, or a whole turn");
        return Err(unclear(message, span));
    }
    Ok(Turn { by, error: 0.0 })
}

/// The turn of an arc from one place to another, that lie `by` radians apart, 0 ≤ `by` < 2π, and `apart` in units of the file,
/// which does not tell apart what is nearer than `resolution`.
///
/// # Errors
/// A whole turn or none could be meant.
pub(super) fn between_places(
    kind: &str,
    by: f64,
    (apart, resolution): (f64, f64),
    span: Span,
) -> Result<Turn, Diagnostic> {
    let error = by.min(TURN - by);
    if apart <= resolution {
        return Ok(Turn { by: TURN, error });
    }
    if error < WHOLE {
        let message = format!(
            "{kind} ends {apart:.3e} from its start, and the file tells {resolution:e} apart: next to nothing, or a whole turn"
        );
        return Err(unclear(message, span));
    }
    Ok(Turn { by, error: 0.0 })
}

#[cfg(test)]
#[expect(clippy::unreadable_literal, clippy::approx_constant, reason = "numbers as files print them")]
mod tests {
    use super::*;
    use crate::source::SourceId;

    fn angles(stated: f64) -> Option<Turn> {
        between_angles("ARC", stated, Span::new(SourceId::INPUT, 0..0)).ok()
    }

    #[test]
    fn whole_turns_are_told_before_anything_is_reduced() {
        // 2π printed with 5 to 15 digits, up and down, and as two turns and more.
        for printed in
            [6.28318, 6.28319, 6.283185, 6.2831855, 6.28318530718, 6.283185307179586, 12.566371, 62.831853]
        {
            let turn = angles(printed).unwrap();
            assert!(turn.is_whole(), "{printed}");
            let off = (printed / TURN).round() * TURN - printed;
            assert_eq!(turn.error, off.abs());
        }
        for arc in [1e-9, 1e-5, 1.0, 6.2831, 6.28] {
            assert_eq!(angles(arc), Some(Turn { by: arc, error: 0.0 }));
        }
        // Past zero, and more than a turn.
        assert_eq!(angles(-1.0).map(|turn| turn.by), Some((-1.0f64).rem_euclid(TURN)));
        assert_eq!(angles(-1.0e-4).map(|turn| turn.by), Some((-1.0e-4f64).rem_euclid(TURN)));
        assert!((angles(7.0).unwrap().by - (7.0 - TURN)).abs() < 1e-15);
    }

    #[test]
    fn a_point_is_never_taken_for_a_turn() {
        for stated in
            [0.0, -0.0, -1e-9, -1e-5, -TURN, -2.0 * TURN, -6.2831855, 6.2832, -6.2832, 6.284, 1e9, f64::NAN]
        {
            assert_eq!(angles(stated), None, "{stated}");
        }
    }

    #[test]
    fn places_are_one_where_the_file_does_not_tell_them_apart() {
        let places = |by, apart, resolution| {
            between_places("100", by, (apart, resolution), Span::new(SourceId::INPUT, 0..0)).ok()
        };
        assert_eq!(places(0.0, 0.0, 0.0), Some(Turn::WHOLE));
        assert_eq!(places(1e-7, 1e-6, 1e-6), Some(Turn { by: TURN, error: 1e-7 }));
        assert!(places(TURN - 1e-7, 1e-6, 1e-6).unwrap().error < 1.001e-7);
        assert_eq!(places(1e-7, 1e-6, 1e-7), None);
        assert_eq!(places(TURN - 1e-7, 1e-6, 0.0), None);
        assert_eq!(places(1e-4, 1e-3, 1e-6), Some(Turn { by: 1e-4, error: 0.0 }));
    }
}
