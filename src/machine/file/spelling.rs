//! How a machine file says that text is spelled.

use super::Reader;
use crate::dialect::Dialect;
use crate::machine::keys::TextFile;
use crate::machine::{LineEnd, Text};
use toml::Spanned;

/// Controls take block numbers of up to eight figures.
const GREATEST_NUMBER: u32 = 99_999_999;

impl Reader {
    pub(super) fn text(&mut self, file: TextFile, base: Option<&Text>, dialect: &Dialect) -> Option<Text> {
        let line_end = match &file.line_end {
            None => self.or(None, base.map(|b| b.line_end), "text.line_end")?,
            Some(word) => match word.get_ref().as_str() {
                "lf" => LineEnd::Lf,
                "crlf" => LineEnd::CrLf,
                _ => {
                    self.error("line-end", "line_end is \"lf\" or \"crlf\"", word.span());
                    LineEnd::Lf
                }
            },
        };
        if let Some(length) = &file.comment_length
            && !(20..=500).contains(length.get_ref())
        {
            self.error("comment-length", "comment_length is 20 to 500", length.span());
        }
        if let Some(signs) = file.comment_signs.as_ref()
            && let Some(c) =
                signs.get_ref().chars().find(|c| !c.is_ascii_graphic() || c.is_ascii_alphanumeric())
        {
            let message =
                format!("`{c}` is no sign: comment_signs are ASCII signs, no letters, digits and blanks");
            self.error("comment-signs", message, signs.span());
        }
        // The remarks that say what to set up have these; a minus that is lost is another place.
        if let Some(signs) = file.comment_signs.as_ref()
            && let Some(c) = ".,:-".chars().find(|c| !signs.get_ref().contains(*c))
        {
            self.error(
                "comment-signs",
                format!("comment_signs lacks `{c}`, which setup remarks have"),
                signs.span(),
            );
        }
        let length = file.comment_length.map(Spanned::into_inner);
        let signs = file.comment_signs.map(Spanned::into_inner);
        let point_always = self.or(file.point_always, base.map(|b| b.point_always), "text.point_always")?;
        let own = file.without_point.map(|one| self.without_point(&one, dialect));
        let without_point = own.unwrap_or(base.and_then(|b| b.without_point));
        self.says_points(dialect, point_always, without_point);
        Some(Text {
            point_always,
            without_point,
            sign_always: self.or(file.sign_always, base.map(|b| b.sign_always), "text.sign_always")?,
            leading_zero: self.or(file.leading_zero, base.map(|b| b.leading_zero), "text.leading_zero")?,
            spaces: self.or(file.spaces, base.map(|b| b.spaces), "text.spaces")?,
            number_start: self.block_number(
                file.number_start,
                base.map(|b| b.number_start),
                "number_start",
            )?,
            number_step: self.block_number(file.number_step, base.map(|b| b.number_step), "number_step")?,
            number_comments: self.or(
                file.number_comments,
                base.map(|b| b.number_comments),
                "text.number_comments",
            )?,
            line_end,
            comment_length: self.or(length, base.map(|b| b.comment_length), "text.comment_length")?,
            comment_signs: self.or(signs, base.map(|b| b.comment_signs.clone()), "text.comment_signs")?,
            comment_lower: self.or(
                file.comment_lower,
                base.map(|b| b.comment_lower),
                "text.comment_lower",
            )?,
            extension: self.or(file.extension, base.map(|b| b.extension.clone()), "text.extension")?,
        })
    }

    /// A block number, or a step between two.
    fn block_number(&mut self, own: Option<Spanned<u32>>, base: Option<u32>, key: &str) -> Option<u32> {
        if let Some(number) = own.as_ref().filter(|number| GREATEST_NUMBER < *number.get_ref()) {
            self.error("block-number-range", format!("{key} is at most {GREATEST_NUMBER}"), number.span());
        }
        self.or(own.map(Spanned::into_inner), base, &format!("text.{key}"))
    }
}
