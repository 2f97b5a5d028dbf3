//! What a compilation tells beside the program.

use crate::decimal::at_most;
use crate::geom::follow::Map;
use crate::ir::{Intent, Step};
use crate::machine::Machine;
use crate::setup::Setup;
use crate::units::DEGREES;
use crate::verify::{Report, Splined};
use serde::Serialize;
use std::fmt::Write as _;

/// The figures of a compilation or a verification.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// The program's name.
    pub name: String,
    /// The machine's name.
    pub machine: String,
    /// The motion of cutting pieces, where it was chosen.
    pub motion: Option<String>,
    /// Blocks of the program, comments included.
    pub blocks: usize,
    /// Blocks that cut; none where nothing was verified.
    pub path_blocks: Option<usize>,
    /// The paths' length, mm; none where nothing was verified.
    pub cutting_length: Option<f64>,
    /// How long the paths take at the F of the program, minutes: without rapids, approaches and acceleration; none where
    /// nothing was verified.
    pub cutting_minutes: Option<f64>,
    /// How far the speed is from the one asked for inside a block, as a share of it; none where nothing was verified.
    pub feed_error: Option<f64>,
    /// mm.
    pub tolerance: f64,
    /// `proved`, `points-only` or `not verified`.
    pub status: &'static str,
    /// The map that the deviation of curves holds for.
    pub map: Option<&'static str>,
    /// The greatest deviation, at the surface of a cutter, mm.
    pub deviation_mm: Option<f64>,
    /// The greatest deviation in a rotary axis or of the tool axis, radians.
    pub deviation_rad: Option<f64>,
    /// Runs of lines that became splines.
    pub fit: Option<FitFigures>,
    /// Where lines follow odd-even steps: the steps' distance from the ideal curve, mm.
    pub steps_from_ideal_mm: Option<f64>,
    /// The same in A, radians.
    pub steps_from_ideal_rad: Option<f64>,
    /// The cutter.
    pub cutter: Option<CutterFigures>,
    /// What to know at the machine.
    pub setup: Setup,
    /// What to know.
    pub notes: Vec<String>,
}

/// The figures of runs of lines that became splines.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FitFigures {
    /// How many runs.
    pub runs: usize,
    /// How many lines they had.
    pub lines: usize,
    /// How many blocks they have.
    pub blocks: usize,
    /// How many corners were kept.
    pub corners: usize,
    /// The greatest distance of a spline from its lines, proved, mm.
    pub spline_from_lines_mm: f64,
    /// The greatest distance of a point from its spline, proved, mm.
    pub points_from_spline_mm: f64,
    /// The greatest curvature of the points, by the circle through three, corners left out, 1/mm.
    pub curvature_before: f64,
    /// The greatest curvature of the splines, at nine places of each block, 1/mm.
    pub curvature_after: f64,
}

impl From<&Splined> for FitFigures {
    fn from(splined: &Splined) -> FitFigures {
        FitFigures {
            runs: splined.steps.len(),
            lines: splined.lines,
            blocks: splined.blocks,
            corners: splined.corners,
            spline_from_lines_mm: splined.from_lines,
            points_from_spline_mm: splined.from_points,
            curvature_before: splined.curvature_before,
            curvature_after: splined.curvature_after,
        }
    }
}

/// The figures of a conical cutter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CutterFigures {
    /// How many flutes.
    pub flutes: usize,
    /// How many passes over each.
    pub passes: usize,
    /// Helix angle along the axis at both ends, degrees.
    pub helix_axial_deg: [f64; 2],
    /// Helix angle along the generatrix at both ends, degrees.
    pub helix_generatrix_deg: [f64; 2],
    /// Lead at both ends, mm; none for a straight flute.
    pub lead_mm: Option<[f64; 2]>,
    /// Diameter at both ends, mm.
    pub diameter_mm: [f64; 2],
    /// How far A turns on a flute, degrees.
    pub turn_deg: f64,
    /// Δl, where odd-even steps are made.
    pub dl: Option<f64>,
}

impl Summary {
    /// The figures of an intent, a text and its proof.
    pub fn new(
        intent: &Intent,
        machine: &Machine,
        motion: Option<&str>,
        text: &str,
        report: Option<&Report>,
        tolerance: f64,
        setup: Setup,
    ) -> Summary {
        let mut notes = Vec::new();
        let steps = &intent.program.steps;
        if !steps.iter().any(|located| matches!(located.step, Step::Spindle(_))) {
            notes.push(match intent.logarithmic().next() {
                Some(_) => "no spindle word is written: the input has no [process] spindle".to_owned(),
                None => "no spindle word is written: the input starts none".to_owned(),
            });
        }
        if setup.home.is_empty() {
            // CL data and jobs say every move; a cutter asks for its home, and the machine file says where that is.
            let why = match intent.logarithmic().next() {
                Some(_) => "the machine stands (no [axis] home in the machine file)",
                None => "the moves of the input leave it",
            };
            notes.push(format!("no axis goes home: the tool is changed where {why}"));
        }
        if intent.logarithmic().next().is_some() {
            notes.push(
                "the path is that of the contact point; the wheel's radius and profile are not modelled"
                    .to_owned(),
            );
        }
        if let Some(rests @ 1..) = report.map(|report| report.rests) {
            let (points, lead) =
                if rests == 1 { ("1 point", "stands") } else { (&*format!("{rests} points"), "stand") };
            notes.push(format!(
                "{points} of the input {lead} where the tool is already, in the decimals of the machine: nothing moves there"
            ));
        }
        if report.is_some() {
            notes.push(
            "the proof covers the programmed path, not what the control's own smoothing or compressor adds"
                .to_owned(),
        );
        }
        Summary {
            name: intent.program.name.clone(),
            machine: machine.name.clone(),
            motion: motion.map(str::to_owned),
            blocks: blocks(text),
            path_blocks: report.map(|r| r.path_blocks),
            cutting_length: report.map(|r| r.cutting_length),
            cutting_minutes: report.map(|r| r.minutes),
            feed_error: report.map(|r| r.feed_error),
            tolerance,
            status: report.map_or("not verified", |r| r.status.word()),
            map: report.and_then(|r| r.map).map(Map::words),
            deviation_mm: report.map(|r| r.deviation.mm),
            deviation_rad: report.map(|r| r.deviation.rad),
            fit: report.and_then(|r| r.splined.as_ref()).map(FitFigures::from),
            steps_from_ideal_mm: report.and_then(|r| r.from_ideal).map(|b| b.mm),
            steps_from_ideal_rad: report.and_then(|r| r.from_ideal).map(|b| b.rad),
            cutter: CutterFigures::of(intent),
            setup,
            notes,
        }
    }

    /// As text, for standard error.
    pub fn render(&self) -> String {
        let mut text = String::new();
        let motion = self.motion.as_deref().map_or(String::new(), |motion| format!(", {motion}"));
        let flutes = self.cutter.as_ref().map_or(String::new(), |c| {
            let passes = if c.passes == 1 { String::new() } else { format!(", {} passes", c.passes) };
            format!(", {} flute{}{passes}", c.flutes, plural(c.flutes))
        });
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{}: {}{motion}{flutes}", self.name, self.machine);
        let cutting = self.path_blocks.map_or(String::new(), |n| format!(", {n} of them cutting"));
        let _ = writeln!(text, "  blocks     {}{cutting}", self.blocks);
        if let Some(length) = self.cutting_length {
            let _ = writeln!(text, "  length     {length:.3} mm cutting");
        }
        if let Some([least, most]) = self.setup.path_minutes {
            let paths = self.setup.paths;
            let (least, most) = (format!("{least:.3}"), format!("{most:.3}"));
            let each = if least == most { least } else { format!("{least} to {most}") };
            let in_text =
                self.cutting_minutes.map_or(String::new(), |m| format!(", {m:.3} min by F in the program"));
            let _ =
                writeln!(text, "  time       {paths} path{} of {each} min as asked{in_text}", plural(paths));
        }
        if let Some(error) = self.feed_error.filter(|error| 0.0005 < *error) {
            let _ = writeln!(text, "  feed       within {:.1} percent of what was asked", 100.0 * error);
        }
        for figures in &self.setup.axes {
            let Some([low, high]) = figures.range else { continue };
            let (axis, unit) = (&figures.axis, figures.unit);
            let speed = match figures.speed {
                Some(speed) => format!("at most {speed:.0} {unit}/min at feed"),
                None => "at feed as fast as it can, since it moves where the others stand".to_owned(),
            };
            let work = if figures.moves_work { ", moves the work" } else { "" };
            let _ = writeln!(text, "  {axis:<10} {low:.3} to {high:.3} {unit}, {speed}{work}");
        }
        if let Some([least, most]) = self.setup.tilt {
            let _ = writeln!(text, "  tool axis  {least:.3} to {most:.3} degrees from Z");
        }
        if let Some(turn) = self.setup.turn {
            let _ = writeln!(
                text,
                "  turning    rotary axes go evenly and leave the great circle by up to {turn:.4} degrees (sampled)"
            );
        }
        match (self.deviation_mm, self.deviation_rad) {
            (Some(mm), Some(rad)) => {
                let where_to = if self.cutter.is_some() {
                    format!(" at the surface, {} rad in A", at_most(rad))
                } else if self.setup.tilt.is_some() {
                    format!(" at the tip, {} degrees of the tool axis", at_most(rad * DEGREES))
                } else if 0.0 < rad {
                    format!(", {} rad in rotary axes", at_most(rad))
                } else {
                    String::new()
                };
                let map = self.map.map_or(String::new(), |map| format!(" {map}"));
                let _ = writeln!(
                    text,
                    "  deviation  {} mm{where_to}, {}{map} (tolerance {} mm)",
                    at_most(mm),
                    self.status,
                    self.tolerance
                );
            }
            _ => {
                let _ = writeln!(text, "  deviation  {}", self.status);
            }
        }
        if let Some(fit) = &self.fit {
            let (runs, corners) = (fit.runs, fit.corners);
            let _ = writeln!(
                text,
                "  fit        {runs} run{} of {} lines in {} blocks, {corners} corner{} kept",
                plural(runs),
                fit.lines,
                fit.blocks,
                plural(corners)
            );
            let _ = writeln!(
                text,
                "             splines within {} mm of the lines, points within {} mm of the splines",
                at_most(fit.spline_from_lines_mm),
                at_most(fit.points_from_spline_mm)
            );
            let _ = writeln!(
                text,
                "             curvature at most {:.3e}/mm before, {:.3e}/mm after",
                fit.curvature_before, fit.curvature_after
            );
        }
        if let (Some(mm), Some(rad)) = (self.steps_from_ideal_mm, self.steps_from_ideal_rad) {
            let dl =
                self.cutter.as_ref().and_then(|c| c.dl).map_or(String::new(), |dl| format!(" at dl = {dl}"));
            let _ = writeln!(
                text,
                "  steps      {} mm, {} rad from the ideal curve{dl}",
                at_most(mm),
                at_most(rad)
            );
        }
        if let Some(cutter) = &self.cutter {
            let range = |[a, b]: [f64; 2], digits: usize| {
                let (a, b) = (format!("{a:.digits$}"), format!("{b:.digits$}"));
                if a == b { a } else { format!("{a} to {b}") }
            };
            let _ = writeln!(
                text,
                "  helix      {} degrees axial, {} along the generatrix",
                range(cutter.helix_axial_deg, 4),
                range(cutter.helix_generatrix_deg, 4)
            );
            match cutter.lead_mm {
                Some(lead) => {
                    let _ = writeln!(text, "  lead       {} mm", range(lead, 3));
                }
                None => {
                    let _ = writeln!(text, "  lead       none: the flute is straight");
                }
            }
            let _ = writeln!(text, "  diameter   {} mm", range(cutter.diameter_mm, 4));
        }
        for note in &self.notes {
            let _ = writeln!(text, "  note       {note}");
        }
        text
    }

    /// One JSON object, after those of the diagnostics: `{"summary": {…}}`.
    pub fn to_json(&self) -> String {
        #[derive(Serialize)]
        struct Line<'a> {
            summary: &'a Summary,
        }
        serde_json::to_string(&Line { summary: self }).unwrap_or_default() + "\n"
    }
}

/// How many blocks a text has: a continued block goes on in indented lines.
fn blocks(text: &str) -> usize {
    let bytes = text.as_bytes();
    let starts = std::iter::once(0).chain(memchr::memchr_iter(b'\n', bytes).map(|end| end + 1));
    starts.filter(|start| bytes.get(*start).is_some_and(|first| *first != b' ')).count()
}

fn plural(n: usize) -> &'static str {
    if n == 1 { "" } else { "s" }
}

impl CutterFigures {
    /// The figures of the first flute; none where there is no cutter.
    pub fn of(intent: &Intent) -> Option<CutterFigures> {
        let flutes: Vec<_> = intent.logarithmic().map(|(log, ..)| log).collect();
        let log = flutes.first()?;
        let mut indices: Vec<f64> = Vec::new();
        for flute in &flutes {
            if !indices.contains(&flute.curve.index) {
                indices.push(flute.curve.index);
            }
        }
        let (curve, end) = (&log.curve, log.curve.end());
        let lead = [curve.lead(0.0), curve.lead(end)];
        Some(CutterFigures {
            flutes: indices.len(),
            passes: flutes.len() / indices.len(),
            helix_axial_deg: [curve.helix_axial(0.0), curve.helix_axial(end)],
            helix_generatrix_deg: [curve.helix_generatrix(0.0), curve.helix_generatrix(end)],
            lead_mm: lead[0].is_finite().then_some(lead),
            diameter_mm: [2.0 * curve.radius(0.0), 2.0 * curve.radius(end)],
            turn_deg: curve.angle(end) * DEGREES,
            dl: log.dl,
        })
    }
}
