//! What a compilation tells beside the program.

use crate::geom::follow::Map;
use crate::ir::{Cut, Intent, Role, Step};
use crate::machine::{Machine, RotaryFeed};
use crate::units::DEGREES;
use crate::verify::{Report, length};
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
    /// How long the paths take at their feed, minutes: without rapids, approaches and acceleration.
    pub cutting_minutes: f64,
    /// The speed along X Y Z at the slowest and the fastest place of a path, mm/min.
    pub speed: Option<[f64; 2]>,
    /// mm.
    pub tolerance: f64,
    /// `proved`, `points-only` or `not verified`.
    pub status: &'static str,
    /// The map that the deviation of curves holds for.
    pub map: Option<&'static str>,
    /// The greatest deviation, at the surface of a cutter, mm.
    pub deviation_mm: Option<f64>,
    /// The greatest deviation in a rotary axis, radians.
    pub deviation_rad: Option<f64>,
    /// Where lines follow odd-even steps: the steps' distance from the ideal curve, mm.
    pub steps_from_ideal_mm: Option<f64>,
    /// The same in A, radians.
    pub steps_from_ideal_rad: Option<f64>,
    /// The cutter.
    pub cutter: Option<CutterFigures>,
    /// What to know.
    pub notes: Vec<String>,
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
    ) -> Summary {
        let mut notes = Vec::new();
        let steps = &intent.program.steps;
        if !steps.iter().any(|located| matches!(located.step, Step::Spindle(_))) {
            notes.push("no spindle word is written: the input has no [process] spindle".to_owned());
        }
        let (cutting_minutes, speed) = times(intent, machine);
        if let (RotaryFeed::DegreesAsMm, Some([slow, fast])) = (machine.rotary_feed, speed)
            && intent.logarithmic().any(|(log, ..)| log.curve.k() != 0.0)
        {
            notes.push(format!(
                "F counts degrees of A as mm on this machine: X Y Z move at {slow:.1} to {fast:.1} mm/min, not at F"
            ));
        }
        if intent.logarithmic().next().is_some() {
            notes.push(
                "the path is that of the contact point; the wheel's radius and profile are not modelled"
                    .to_owned(),
            );
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
            // A continued block goes on in indented lines.
            blocks: text.lines().filter(|line| !line.starts_with(' ')).count(),
            path_blocks: report.map(|r| r.path_blocks),
            cutting_length: report.map(|r| r.cutting_length),
            cutting_minutes,
            speed,
            tolerance,
            status: report.map_or("not verified", |r| r.status.word()),
            map: report.and_then(|r| r.map).map(Map::words),
            deviation_mm: report.map(|r| r.deviation.mm),
            deviation_rad: report.map(|r| r.deviation.rad),
            steps_from_ideal_mm: report.and_then(|r| r.from_ideal).map(|b| b.mm),
            steps_from_ideal_rad: report.and_then(|r| r.from_ideal).map(|b| b.rad),
            cutter: CutterFigures::of(intent),
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
        let _ = writeln!(text, "  time       {:.2} min cutting", self.cutting_minutes);
        match (self.deviation_mm, self.deviation_rad) {
            (Some(mm), Some(rad)) => {
                let where_to = if self.cutter.is_some() {
                    format!(" at the surface, {rad:.2e} rad in A")
                } else if 0.0 < rad {
                    format!(", {rad:.2e} rad in rotary axes")
                } else {
                    String::new()
                };
                let map = self.map.map_or(String::new(), |map| format!(" {map}"));
                let _ = writeln!(
                    text,
                    "  deviation  {mm:.2e} mm{where_to}, {}{map} (tolerance {} mm)",
                    self.status, self.tolerance
                );
            }
            _ => {
                let _ = writeln!(text, "  deviation  {}", self.status);
            }
        }
        if let (Some(mm), Some(rad)) = (self.steps_from_ideal_mm, self.steps_from_ideal_rad) {
            let dl =
                self.cutter.as_ref().and_then(|c| c.dl).map_or(String::new(), |dl| format!(" at dl = {dl}"));
            let _ = writeln!(text, "  steps      {mm:.2e} mm, {rad:.2e} rad from the ideal curve{dl}");
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

/// Cutting time in minutes, and the least and greatest speed along X Y Z.
fn times(intent: &Intent, machine: &Machine) -> (f64, Option<[f64; 2]>) {
    let mut minutes = 0.0;
    let mut speed: Option<[f64; 2]> = None;
    for (log, feed, _) in intent.logarithmic() {
        let (Some(feed), curve) = (feed, &log.curve) else { continue };
        let c = curve.length_per_x();
        let (length, at) = match machine.rotary_feed {
            RotaryFeed::Free => (curve.end() * c, [feed; 2]),
            RotaryFeed::DegreesAsMm => {
                let local = |x: f64| {
                    let a = curve.slope(x) * DEGREES;
                    feed * c / (c * c + a * a).sqrt()
                };
                (curve.length_with_degrees(), [local(0.0), local(curve.end())])
            }
        };
        minutes += length / feed;
        let (slow, fast) = (at[0].min(at[1]), at[0].max(at[1]));
        speed = Some(speed.map_or([slow, fast], |known| [known[0].min(slow), known[1].max(fast)]));
    }
    for located in &intent.program.steps {
        let Step::Cut(Cut { feed: Some(feed), role: Role::Path, curve }) = &located.step else { continue };
        let pieces = curve.pieces();
        minutes += pieces.iter().map(|piece| length(piece, &intent.program.axes)).sum::<f64>() / feed;
    }
    (minutes, speed)
}
