//! What the machine needs beside the path, read and found sound.

use super::file::{CorrectionTable, InfeedTable, ProcessTable, RetractTable};
use super::{Infeed, MAX_PASSES, Order, Process, Reader};
use crate::geom::logcurve::{LogCurve, Measure};
use crate::source::Span;
use crate::units::{Axes, Axis};
use toml::Spanned;

/// How paths are run.
pub(super) struct Travel {
    /// From the end to D1.
    pub(super) back: bool,
    /// What the feed is a speed of.
    pub(super) along: Measure,
    /// mm along X before and behind the flute, in the order of X.
    beyond: [f64; 2],
}

impl Reader {
    pub(super) fn travel(&mut self, table: Option<&ProcessTable>) -> Travel {
        let mut travel = Travel { back: false, along: Measure::Path, beyond: [0.0; 2] };
        let Some(table) = table else { return travel };
        travel.back = self.word("travel", table.travel.as_ref(), &[("from-D1", false), ("to-D1", true)]);
        travel.along = self.word(
            "feed_along",
            table.feed_along.as_ref(),
            &[("path", Measure::Path), ("edge", Measure::Edge), ("X", Measure::X), ("A", Measure::A)],
        );
        let mut beyond = |key: &str, value: &Option<Spanned<f64>>| {
            let holds = |x: f64| (0.0..=1000.0).contains(&x);
            let must = "must lie within 0 and 1000 mm";
            value.as_ref().map_or(0.0, |value| self.number(key, value, "run-range", must, holds))
        };
        let (run_in, run_out) = (beyond("run_in", &table.run_in), beyond("run_out", &table.run_out));
        travel.beyond = if travel.back { [run_out, run_in] } else { [run_in, run_out] };
        travel
    }

    /// The curve with what a path runs before and behind its flute.
    pub(super) fn extended(
        &mut self,
        curve: LogCurve,
        travel: &Travel,
        process: Option<&Spanned<ProcessTable>>,
    ) -> Option<LogCurve> {
        let span = || process.map_or(0..0, Spanned::span);
        if travel.along == Measure::A && curve.k() == 0.0 {
            let message = "a feed in degrees of A is asked for, and A does not turn: the flute is straight";
            self.error("feed-along", message, span());
            return None;
        }
        let [before, behind] = travel.beyond;
        match curve.with_range(curve.start() - before, curve.end() + behind) {
            Ok(extended) => Some(extended),
            Err(error) => {
                self.error("taper-ends", format!("run_in and run_out: {error}"), span());
                None
            }
        }
    }

    pub(super) fn process(&mut self, table: Option<ProcessTable>, span: Span) -> Process {
        let mut process = Process {
            feed: None,
            approach_feed: None,
            return_feed: None,
            retract: None,
            spindle: None,
            coolant: false,
            tool: 1,
            infeed: None,
            spark_out: 0,
            order: Order::Flute,
            correction: None,
            span,
        };
        let Some(table) = table else { return process };
        process.infeed = table.infeed.as_ref().and_then(|infeed| self.infeed(infeed));
        if let Some(spark_out) = &table.spark_out {
            process.spark_out = self.passes("spark_out", spark_out, 0);
        }
        process.order =
            self.word("order", table.order.as_ref(), &[("flute", Order::Flute), ("pass", Order::Pass)]);
        let positive = |x: f64| 0.0 < x && x < 1.0e6;
        let must = "must be greater than zero and below a million";
        let mut feed = |key: &str, value: &Option<Spanned<f64>>| {
            value.as_ref().map(|value| self.number(key, value, "feed-range", must, positive))
        };
        process.feed = feed("feed", &table.feed);
        process.approach_feed = feed("approach_feed", &table.approach_feed);
        process.return_feed = feed("return_feed", &table.return_feed);
        process.coolant = table.coolant.unwrap_or(false);
        process.correction = table.correction.as_ref().and_then(|table| self.correction(table));
        process.spindle = table
            .spindle
            .as_ref()
            .map(|value| self.number("spindle", value, "spindle-range", must, positive));
        if let Some(tool) = &table.tool {
            match u32::try_from(*tool.get_ref()) {
                Ok(number) if (1..=99_999_999).contains(&number) => process.tool = number,
                _ => self.error("tool-range", "tool must be 1 to 99999999", tool.span()),
            }
        }
        if let Some(retract) = &table.retract {
            let RetractTable { axis, to } = retract.get_ref();
            match (axis, to) {
                (Some(axis), Some(to)) => {
                    let found = Axis::new(axis.get_ref()).and_then(|name| Axes::xyza().index_of(name));
                    // Along X one of the ways there and back would run through the whole flute.
                    let across = found.filter(|i| *i == 1 || *i == 2);
                    if across.is_none() {
                        let message = "the retract axis is Y or Z: X runs along the cutter";
                        self.error("retract-axis", message, axis.span());
                    }
                    let to = self.number("to", to, "retract-range", "must lie within a million mm", |x| {
                        x.abs() < 1.0e6
                    });
                    process.retract = across.map(|axis| (axis, to));
                }
                _ => self.error(
                    "retract-missing",
                    "retract needs axis and to, as { axis = \"Z\", to = 50.0 }",
                    retract.span(),
                ),
            }
        }
        process
    }

    fn infeed(&mut self, table: &Spanned<InfeedTable>) -> Option<Infeed> {
        let InfeedTable { axis: Some(axis), sign, step: Some(step), passes: Some(passes) } = table.get_ref()
        else {
            self.error(
                "infeed-incomplete",
                "infeed needs axis, step and passes, as { axis = \"Y\", step = 0.2, passes = 3 }",
                table.span(),
            );
            return None;
        };
        let index = Axis::new(axis.get_ref()).and_then(|name| Axes::xyza().index_of(name));
        let index = index.filter(|i| *i == 1 || *i == 2);
        if index.is_none() {
            self.error("infeed-axis", "the infeed axis is Y or Z: X runs along the cutter", axis.span());
        }
        let holds = |x: f64| x != 0.0 && x.abs() < 1000.0;
        let step =
            self.number("step", step, "infeed-range", "must lie within 1000 mm and not be zero", holds);
        let step = match sign.as_ref().map(|sign| (*sign.get_ref(), sign.span())) {
            None | Some((1, _)) => step,
            Some((-1, _)) => -step,
            Some((_, span)) => {
                self.error("infeed-sign", "sign is 1 or -1", span);
                step
            }
        };
        let passes = self.passes("passes", passes, 1);
        index.map(|axis| Infeed { axis, step, passes })
    }

    /// A count of passes.
    fn passes(&mut self, key: &str, value: &Spanned<i64>, least: i64) -> u32 {
        let n = *value.get_ref();
        if !(least..=MAX_PASSES).contains(&n) {
            self.error("passes-range", format!("{key} must be {least} to {MAX_PASSES}"), value.span());
        }
        u32::try_from(n).unwrap_or(0)
    }

    /// A parameter that shifts all paths.
    fn correction(&mut self, table: &Spanned<CorrectionTable>) -> Option<(usize, f64)> {
        let CorrectionTable { axis, value } = table.get_ref();
        let Some(axis) = axis else {
            let message = "correction needs axis, as { axis = \"Y\", value = 0.0 }";
            self.error("correction-incomplete", message, table.span());
            return None;
        };
        let index = Axis::new(axis.get_ref()).and_then(|name| Axes::xyza().index_of(name));
        let index = index.filter(|i| *i == 1 || *i == 2);
        if index.is_none() {
            self.error(
                "correction-axis",
                "the axis of a correction is Y or Z: X runs along the cutter",
                axis.span(),
            );
        }
        let value = value.as_ref().map_or(0.0, |value| {
            self.number("value", value, "correction-range", "must lie within 1000 mm", |x| x.abs() <= 1000.0)
        });
        index.map(|axis| (axis, value))
    }
}
