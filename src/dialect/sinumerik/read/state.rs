//! Words that change what holds, the feed, axes that go the short way, and words that are not read.

use super::fixed::TRANS;
use super::{Block, Motion, Reader};
use crate::decimal::Decimal;
use crate::diagnostic::Diagnostic;
use crate::dialect::sinumerik::write::turn_word;
use crate::ir::ThroughKind;
use crate::source::Span;
use std::ops::Range;

impl Reader<'_> {
    /// An axis that goes to its place the short way.
    pub(super) fn shortest(&mut self, name: &str, value: Decimal, range: Range<usize>, block: &mut Block) {
        let Some(axis) = self.assembler.axis(name).filter(|axis| self.assembler.wraps(*axis)) else {
            let message = format!("DC belongs to axes that wrap at 360 degrees, and {name} is none here");
            return self.assembler.error("short-way-axis", message, range);
        };
        let Some(units) = self.assembler.units(axis, value, range.clone()) else { return };
        match self.assembler.nearest(axis, units) {
            Some(units) => self.name_axis(block, axis, units, range),
            None => {
                let message =
                    format!("which way {name} goes cannot be said: it is unknown, or both are as long");
                self.assembler.error("short-way", message, range);
            }
        }
    }

    /// The feed of a block holds from its own move on. A new one starts a new run of polynomial blocks; a spline is one
    /// curve with one feed.
    pub(super) fn set_feed(&mut self, feed: Decimal, span: Span) {
        if self.assembler.feed == Some(feed) {
            return;
        }
        match self.run.as_ref().map(|run| run.motion) {
            Some(Motion::Bspline | Motion::Through(_)) => {
                let whole = span.start as usize..span.end as usize;
                self.assembler.error("feed-in-spline", "the feed changes inside a spline", whole);
            }
            Some(
                Motion::Poly | Motion::None | Motion::Rapid | Motion::Line | Motion::Arc(_) | Motion::ArcBy,
            )
            | None => {
                self.flush();
            }
        }
        self.assembler.feed = Some(feed);
    }

    pub(super) fn keyword(&mut self, keyword: &str, range: Range<usize>, block: &mut Block) {
        match keyword {
            "CIP" => self.motion_word(Motion::ArcBy, &range, block),
            "POLY" => self.motion_word(Motion::Poly, &range, block),
            "BSPLINE" => self.starts(Motion::Bspline, &range, block),
            "ASPLINE" => self.starts(Motion::Through(ThroughKind::Akima), &range, block),
            "CSPLINE" => self.starts(Motion::Through(ThroughKind::Cubic), &range, block),
            "TRANS" => block.kinds |= TRANS,
            "UPATH" | "SPATH" => {
                self.flush();
                self.upath = keyword == "UPATH";
            }
            "BAUTO" | "BNAT" | "BTAN" => self.end_condition(keyword, true, range),
            "EAUTO" | "ENAT" | "ETAN" => self.end_condition(keyword, false, range),
            "ORICURVE" => {
                self.flush();
                self.second = true;
            }
            "ORIVECT" | "ORIAXES" => {
                self.flush();
                self.second = false;
                let own = turn_word(self.assembler.machine.orientation.turn);
                if keyword != own {
                    let message = format!("the machine file turns the tool by {own}, not {keyword}");
                    self.assembler.error("orientation-turn", message, range);
                }
            }
            "TRAFOOF" if self.assembler.leads_tip() => {
                let message =
                    "TRAFOOF in a block of its own ends leading the tip, with the lines of the machine file";
                self.assembler.error("tip-control", message, range);
            }
            "TRAFOOF" => {}
            _ if self.runs(keyword, &range, false) => {}
            _ => self.assembler.error("word-unknown", format!("`{keyword}` is not understood"), range),
        }
    }

    pub(super) fn m_function(&mut self, value: Decimal, range: Range<usize>) {
        let diagnostic = Diagnostic::error("m-function", format!("M{value} is not read here"));
        let hint = if matches!(value.units(0), Some(2 | 30)) {
            "the program ends with the footer of the machine file, line by line and in its order"
        } else {
            "M functions are read where they are whole lines of the machine file"
        };
        self.assembler.diagnostics.push(diagnostic.at(self.assembler.span(range), "").hint(hint));
    }

    pub(super) fn unreadable(&mut self, rest: &str, at: usize) {
        let length = rest.find([' ', '\t', ';']).unwrap_or(rest.len());
        let text = &rest[..length];
        let message = if text.starts_with('/') {
            "whether a block behind / runs is decided at the machine"
        } else if text.contains("=IC(") {
            "incremental positions are not read"
        } else if text.contains("=R") {
            "parameters are read as feeds and work offsets only"
        } else {
            "this word cannot be read"
        };
        self.assembler.error("word-unreadable", message, at..at + length);
    }

    /// A word that begins a spline, each time.
    fn starts(&mut self, motion: Motion, range: &Range<usize>, block: &mut Block) {
        block.starts_spline = true;
        self.motion_word(motion, range, block);
    }

    /// The IR has no place for end conditions: they are the machine file's.
    fn end_condition(&mut self, word: &str, begin: bool, range: Range<usize>) {
        let spline = &self.assembler.machine.spline;
        let expected = if begin { &spline.begin } else { &spline.end };
        if word != expected {
            let message = format!("the machine file has the end condition {expected} here, not {word}");
            self.assembler.error("end-condition", message, range);
        }
    }
}
