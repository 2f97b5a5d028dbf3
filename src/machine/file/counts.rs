//! What numbers of a program count: least increments or whole ones, and from where.

use super::Reader;
use crate::decimal::Decimal;
use crate::diagnostic::Diagnostic;
use crate::dialect::Dialect;
use crate::machine::line::words;
use toml::Spanned;

impl Reader {
    /// The lines of a work offset state all of it, from the work's own zero.
    pub(super) fn counts_from_zero(&mut self, shift: &[Spanned<String>], dialect: &Dialect) {
        for line in shift {
            let all = words(line.get_ref());
            let adds = |code: &&&str| all.iter().any(|word| word.is(code));
            if let Some(word) = dialect.adds_shift.iter().find(adds) {
                let message = format!("`{word}` makes no work offset that counts from the work's own zero");
                self.error("shift-adds", message, line.span());
            }
        }
    }

    /// Where a number without a point may be less than it says, each has its point.
    pub(super) fn says_points(
        &mut self,
        dialect: &Dialect,
        point_always: bool,
        without_point: Option<Decimal>,
    ) {
        if dialect.least_increments && !point_always && without_point != Some(Decimal::new(1, 0)) {
            let message = "without point_always X30 is written, which may be 0.030 mm";
            self.diagnostics.push(
                Diagnostic::error("point-always", message)
                    .hint("where the control takes it for 30 mm, [text] without_point = 1.0 says so"),
            );
        }
    }

    /// What 1 without a point is.
    pub(super) fn without_point(&mut self, one: &Spanned<f64>, dialect: &Dialect) -> Option<Decimal> {
        let units = [1, 10, 100, 1000, 10_000].map(|parts| 1.0 / f64::from(parts));
        if !dialect.least_increments {
            let message =
                format!("without a point X30 is 30 mm on {}, whatever without_point says", dialect.name);
            self.error("without-point", message, one.span());
        } else if !units.contains(one.get_ref()) {
            self.error("without-point", "without_point is 1.0, 0.1, 0.01, 0.001 or 0.0001", one.span());
        }
        Decimal::round(*one.get_ref(), 4)
    }
}
