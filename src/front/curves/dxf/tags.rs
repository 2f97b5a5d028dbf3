//! Pairs of group code and value, and the groups that they make.

use super::super::Point;
use super::super::spline::Number;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::{SourceId, Span};

/// A group code and its value.
pub(super) struct Tag<'t> {
    pub(super) code: i32,
    /// Without the blanks round it.
    pub(super) value: &'t str,
    /// Where the value stands.
    pub(super) span: Span,
}

/// A pair with code 0 and all up to the next one.
pub(super) struct Group<'t> {
    pub(super) name: &'t str,
    /// Where the name stands.
    pub(super) head: Span,
    /// The line of the name, from 1.
    pub(super) line: u32,
    pub(super) tags: Vec<Tag<'t>>,
}

/// The groups of a file.
pub(super) struct Groups<'t> {
    text: &'t str,
    id: SourceId,
    at: usize,
    /// The line that is read next, from 1.
    line: u32,
    /// The head of the next group, and its line.
    next: Option<(Tag<'t>, u32)>,
}

impl<'t> Groups<'t> {
    pub(super) fn new(text: &'t str, id: SourceId) -> Groups<'t> {
        let at = if text.starts_with('\u{feff}') { 3 } else { 0 };
        Groups { text, id, at, line: 1, next: None }
    }

    /// Whether no group is left behind the last one.
    pub(super) fn is_over(&self) -> bool {
        self.next.is_none()
    }

    /// The next line without its end and the blanks round it, and where it stands.
    fn line(&mut self) -> Option<(&'t str, Span)> {
        let rest = self.text.get(self.at..).filter(|rest| !rest.is_empty())?;
        let end = memchr::memchr(b'\n', rest.as_bytes()).unwrap_or(rest.len());
        let line = rest[..end].trim();
        let from = self.at + (rest[..end].len() - rest[..end].trim_start().len());
        self.at += end + 1;
        self.line += 1;
        Some((line, Span::new(self.id, from..from + line.len())))
    }

    /// A pair; none where nothing is left.
    fn pair(&mut self) -> Result<Option<Tag<'t>>, Diagnostics> {
        let Some((code, code_span)) = self.line() else { return Ok(None) };
        if code.is_empty() && self.text[self.at.min(self.text.len())..].trim().is_empty() {
            return Ok(None);
        }
        let Ok(number) = code.parse() else {
            let message = "a group code is a whole number";
            let error = Diagnostic::error("group-code", message).at(code_span, "");
            return Err(error.hint("a DXF file is pairs of lines: a group code, and its value").into());
        };
        let Some((value, span)) = self.line() else {
            let message = "the file ends behind a group code: a part of it is missing";
            return Err(Diagnostic::error("file-truncated", message).at(code_span, "").into());
        };
        Ok(Some(Tag { code: number, value, span }))
    }

    /// The next group.
    ///
    /// # Errors
    /// The text is not made of pairs.
    pub(super) fn next(&mut self) -> Result<Option<Group<'t>>, Diagnostics> {
        // Comments may stand before the first group.
        while self.next.is_none() {
            let line = self.line + 1;
            match self.pair()? {
                None => return Ok(None),
                Some(tag) if tag.code == 0 => self.next = Some((tag, line)),
                Some(tag) if tag.code == 999 => {}
                Some(tag) => {
                    let message = "the file does not begin with a section";
                    return Err(Diagnostic::error("group-code", message).at(tag.span, "").into());
                }
            }
        }
        let Some((head, line)) = self.next.take() else { return Ok(None) };
        let mut group = Group { name: head.value, head: head.span, line, tags: Vec::new() };
        // What an application adds behind its own name is not the entity's.
        let mut foreign = false;
        loop {
            let line = self.line + 1;
            if group.name == "EOF" {
                return Ok(Some(group));
            }
            match self.pair()? {
                None => return Ok(Some(group)),
                Some(tag) if tag.code == 0 => {
                    self.next = Some((tag, line));
                    return Ok(Some(group));
                }
                Some(tag) => {
                    foreign |= tag.code == 1001 || tag.code == 101;
                    if !foreign && tag.code != 999 {
                        group.tags.push(tag);
                    }
                }
            }
        }
    }
}

impl<'t> Group<'t> {
    /// An error that points at its name.
    pub(super) fn error(&self, id: &'static str, message: impl Into<String>) -> Diagnostic {
        Diagnostic::error(id, message).at(self.head, "")
    }

    /// The first value of a code.
    pub(super) fn text(&self, code: i32) -> Option<&'t str> {
        self.tags.iter().find(|tag| tag.code == code).map(|tag| tag.value)
    }

    /// The first value of a code, a whole number.
    pub(super) fn whole(&self, code: i32) -> Result<Option<i64>, Diagnostic> {
        let Some(tag) = self.tags.iter().find(|tag| tag.code == code) else { return Ok(None) };
        tag.value.parse().map(Some).map_err(|_| {
            let message = format!("{}: {} is no whole number", self.name, shown(tag.value));
            Diagnostic::error("number-unreadable", message).at(tag.span, "")
        })
    }

    /// A value as a finite number.
    pub(super) fn number(&self, tag: &Tag<'_>) -> Result<f64, Diagnostic> {
        tag.value.parse().ok().filter(|x: &f64| x.is_finite()).ok_or_else(|| {
            let message = format!("{}: {} is no finite number", self.name, shown(tag.value));
            Diagnostic::error("number-unreadable", message).at(tag.span, "")
        })
    }

    /// The first value of a code as a number.
    pub(super) fn float(&self, code: i32) -> Result<Option<f64>, Diagnostic> {
        self.tags.iter().find(|tag| tag.code == code).map(|tag| self.number(tag)).transpose()
    }

    /// The same, which must be there.
    pub(super) fn needed(&self, code: i32, what: &str) -> Result<f64, Diagnostic> {
        let missing = || self.error("group-missing", format!("{} has no {what} (code {code})", self.name));
        self.float(code)?.ok_or_else(missing)
    }

    /// All values of a code.
    pub(super) fn all(&self, code: i32) -> Result<Vec<Number>, Diagnostic> {
        let tags = self.tags.iter().filter(|tag| tag.code == code);
        tags.map(|tag| Ok((self.number(tag)?, tag.span))).collect()
    }

    /// A point in the codes `code`, `code` + 10 and `code` + 20, of which the last may be missing.
    pub(super) fn point(&self, code: i32, what: &str) -> Result<Point, Diagnostic> {
        let z = self.float(code + 20)?.unwrap_or(0.0);
        Ok([self.needed(code, what)?, self.needed(code + 10, what)?, z])
    }

    /// All points in these codes; a point begins with its first.
    pub(super) fn points(&self, code: i32) -> Result<Vec<Point>, Diagnostic> {
        let mut points: Vec<Point> = Vec::new();
        let mut whole = true;
        for tag in &self.tags {
            let axis = match tag.code - code {
                0 => 0,
                10 => 1,
                20 => 2,
                _ => continue,
            };
            let x = self.number(tag)?;
            let incomplete = || {
                let message = format!("{} has a point of one coordinate", self.name);
                Diagnostic::error("point-incomplete", message).at(tag.span, "")
            };
            if axis == 0 {
                if !whole {
                    return Err(incomplete());
                }
                points.push([x, 0.0, 0.0]);
                whole = false;
                continue;
            }
            match points.last_mut() {
                Some(point) if axis == 2 || !whole => point[axis] = x,
                Some(_) | None => return Err(incomplete()),
            }
            whole |= axis == 1;
        }
        if whole {
            return Ok(points);
        }
        Err(self.error("point-incomplete", format!("{} ends within a point", self.name)))
    }

    /// Checks a stated count, where there is one.
    pub(super) fn count(&self, code: i32, what: &str, found: usize) -> Result<(), Diagnostic> {
        match self.whole(code)? {
            Some(stated) if stated != found as i64 => {
                let span = self.tags.iter().find(|tag| tag.code == code).map_or(self.head, |tag| tag.span);
                let message = format!("{} is said to have {stated} {what}, and has {found}", self.name);
                Err(Diagnostic::error("count-differs", message).at(span, ""))
            }
            _ => Ok(()),
        }
    }
}

/// A value as a message shows it.
fn shown(value: &str) -> String {
    let short: String = value.chars().take(24).collect();
    format!("`{short}`")
}
