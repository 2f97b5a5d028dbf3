//! Which lines of the input each block of a program came from.
//!
//! ```json
//! {"program":"POCKET1","input":"pocket.ncl","blocks":[
//! {"line":20,"from":[15,16]},
//! {"line":21,"from":[18,18]}
//! ]}
//! ```
//!
//! Lines count from 1; `from` is the first and the last line of the statement. Lines that the machine file puts round a
//! program, and remarks, come from no statement. What came from a curve file that the input names has the lines of that
//! file, which `"file":"outline.dxf"` says then.

use crate::dialect::Reading;
use crate::ir::{Curve, Cut, Intent, Step, Written};
use crate::source::{SourceId, Sources, Span};
use crate::verify::Report;
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Where each line of a text starts.
struct Lines(Vec<u32>);

impl Lines {
    fn of(text: &str) -> Lines {
        let starts = memchr::memchr_iter(b'\n', text.as_bytes()).map(|at| at as u32 + 1);
        Lines(std::iter::once(0).chain(starts).collect())
    }

    /// The line of a byte, from 1.
    fn line(&self, at: u32) -> u32 {
        self.0.partition_point(|start| *start <= at) as u32
    }

    fn lines(&self, span: Span) -> [u32; 2] {
        let first = self.line(span.start);
        [first, self.line(span.end.saturating_sub(1)).max(first)]
    }
}

/// The map of a program that was proved, as JSON: `text` is its text, read again as `reading`.
pub fn json(intent: &Intent, report: &Report, reading: &Reading, text: &str, sources: &Sources) -> String {
    let input = sources.get(SourceId::INPUT);
    let own = Lines::of(text);
    let mut known: BTreeMap<SourceId, (Lines, String)> = BTreeMap::new();
    let blocks = blocks(reading, &own);
    let mut at = 0;
    let mut out = String::with_capacity(40 * blocks.len() + 100);
    let name = |text: &str| serde_json::to_string(text).unwrap_or_default();
    // Writing to a String cannot fail.
    let _ = write!(
        out,
        "{{\"program\":{},\"input\":{},\"blocks\":[",
        name(&intent.program.name),
        name(input.map_or("", |source| source.name.as_str()))
    );
    let mut first = true;
    let splined = |step: usize| {
        report.splined.as_ref().is_some_and(|splined| splined.steps.binary_search(&step).is_ok())
    };
    for (step, (located, count)) in intent.program.steps.iter().zip(&report.blocks).enumerate() {
        let count = *count as usize;
        let (from, file) = known.entry(located.span.source).or_insert_with(|| {
            let source = sources.get(located.span.source);
            let file = source.filter(|_| located.span.source != SourceId::INPUT);
            let file = file.map_or(String::new(), |source| format!(",\"file\":{}", name(&source.name)));
            (Lines::of(source.map_or("", |source| source.text.as_str())), file)
        });
        let whole = from.lines(located.span);
        for k in 0..count {
            let Some(block) = blocks.get(at + k) else { break };
            let from = match &located.step {
                // Every block of a spline stands for its whole run.
                Step::Cut(Cut { curve: Curve::Lines(line), .. }) if splined(step) => {
                    match (line.lines.first(), line.lines.last()) {
                        (Some(first), Some(last)) => [*first, *last],
                        (None, _) | (_, None) => whole,
                    }
                }
                Step::Cut(Cut { curve: Curve::Lines(line), .. }) => {
                    line.lines.get(k).map_or(whole, |line| [*line, *line])
                }
                Step::Cut(_)
                | Step::Comment(_)
                | Step::Tool(_)
                | Step::Spindle(_)
                | Step::Coolant
                | Step::Home(_)
                | Step::Shift(_)
                | Step::Auxiliary(_)
                | Step::Rapid(_) => whole,
            };
            let _ = write!(
                out,
                "{}\n{{\"line\":{block},\"from\":[{},{}]{file}}}",
                if first { "" } else { "," },
                from[0],
                from[1]
            );
            first = false;
        }
        at += count;
    }
    out.push_str("\n]}\n");
    out
}

/// The line of each block but remarks, in the order of the text.
fn blocks(reading: &Reading, own: &Lines) -> Vec<u32> {
    let mut all = Vec::new();
    for located in &reading.decimals.program.steps {
        match &located.step {
            Step::Comment(_) => {}
            Step::Cut(cut) => match &cut.curve {
                Written::Lines(points) | Written::Through(_, points) => all.extend(&points.lines),
                Written::Arc(arc) => all.push(arc.line),
                Written::Polynomial(polynomial) => {
                    all.extend(polynomial.blocks.iter().map(|block| block.line));
                }
                // The first point is where the tool stands.
                Written::Nurbs(nurbs) => all.extend(nurbs.lines.iter().skip(1)),
            },
            Step::Tool(_)
            | Step::Spindle(_)
            | Step::Coolant
            | Step::Home(_)
            | Step::Shift(_)
            | Step::Auxiliary(_)
            | Step::Rapid(_) => all.push(own.line(located.span.start)),
        }
    }
    all
}
