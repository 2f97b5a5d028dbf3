//! What a comparison tells beside the differences.

use super::Origin;
use super::walk::{Found, counted};
use crate::decimal::at_most;
use crate::source::{LineColumn, Sources, Span};
use crate::units::DEGREES;
use serde::Serialize;
use std::fmt::Write as _;

/// The figures of a comparison.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figures {
    /// What the first text is called.
    pub a: String,
    /// What the second text is called.
    pub b: String,
    /// The machine that the first program is for, or the language of an input.
    pub from_a: String,
    /// The same of the second.
    pub from_b: String,
    /// Whether both make the same motion.
    pub same: bool,
    /// In how many places they differ.
    pub differences: usize,
    /// mm.
    pub tolerance: f64,
    /// `proved`, `sampled` or `points-only`.
    pub status: &'static str,
    /// An upper bound on the distance of their paths, mm; none where no paths were compared.
    pub deviation_mm: Option<f64>,
    /// The same in rotary axes or in the direction of the tool, radians.
    pub deviation_rad: Option<f64>,
    /// The greatest angle between tilted planes, degrees, where there are some.
    pub planes_deg: Option<f64>,
    /// Where the first program is farthest from the second.
    pub farthest_a: Option<Place>,
    /// Where the second program is then.
    pub farthest_b: Option<Place>,
    /// How many paths were compared.
    pub paths: usize,
    /// How long they are, mm.
    pub length: f64,
    /// How many rapids are the same.
    pub rapids: usize,
    /// How many other steps are the same.
    pub steps: usize,
    /// Of how many paths the times were compared, and not F.
    pub timed: usize,
    /// What to know.
    pub notes: Vec<&'static str>,
    /// Whether the angle is that of the tool's direction.
    #[serde(skip)]
    direction: bool,
    #[serde(skip)]
    farthest: Option<[Span; 2]>,
}

/// A line of a text.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Place {
    /// Its file.
    pub file: String,
    /// From 1.
    pub line: usize,
}

impl Figures {
    pub(super) fn new(
        found: &Found,
        [a, b]: [String; 2],
        origins: [&Origin; 2],
        tolerance: f64,
        direction: bool,
    ) -> Figures {
        let [from_a, from_b] = origins.map(|origin| match origin {
            Origin::Program(machine) => machine.name.clone(),
            Origin::Input(language) => language.name.to_owned(),
        });
        let some = |x: f64| (0 < found.paths && x.is_finite()).then_some(x);
        let mut notes = Vec::new();
        if 0 < found.timed {
            notes.push("F counts rotary axes in one program and not in the other, or lines have times: the times of those paths were compared");
        }
        notes.push("programmed paths are compared, not what each control's own smoothing or compressor adds");
        Figures {
            a,
            b,
            from_a,
            from_b,
            same: found.is_same(),
            differences: found.differences,
            tolerance,
            status: found.status.word(),
            deviation_mm: some(found.deviation.mm),
            deviation_rad: some(found.deviation.rad),
            planes_deg: found.planes.map(|planes| planes * DEGREES),
            farthest_a: None,
            farthest_b: None,
            paths: found.paths,
            length: found.length,
            rapids: found.rapids,
            steps: found.switches,
            timed: found.timed,
            notes,
            direction,
            farthest: found.worst,
        }
    }

    /// Finds the lines of the places.
    pub fn find_lines(&mut self, sources: &Sources) {
        let place = |span: Span| {
            let source = sources.get(span.source)?;
            let line = LineColumn::of(&source.text, span.start as usize).line;
            Some(Place { file: source.name.clone(), line })
        };
        if let Some([a, b]) = self.farthest {
            (self.farthest_a, self.farthest_b) = (place(a), place(b));
        }
    }

    /// As text, for standard error.
    pub fn render(&self) -> String {
        let mut text = String::new();
        let verdict = if self.same {
            "the same motion".to_owned()
        } else {
            format!("they differ in {}", counted(self.differences, "place"))
        };
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{} ({}), {} ({}): {verdict}", self.a, self.from_a, self.b, self.from_b);
        let _ = writeln!(
            text,
            "  compared   {} of {:.3} mm, {}, {}",
            counted(self.paths, "path"),
            self.length,
            counted(self.rapids, "rapid"),
            counted(self.steps, "other step"),
        );
        if let (Some(mm), Some(rad)) = (self.deviation_mm, self.deviation_rad) {
            let angle = if self.direction {
                format!(" at the tip, {} degrees of the tool axis", at_most(rad * DEGREES))
            } else if 0.0 < rad {
                format!(", {} rad in rotary axes", at_most(rad))
            } else {
                String::new()
            };
            let farthest = match (&self.farthest_a, &self.farthest_b) {
                (Some(a), Some(b)) => format!(", at {}:{} and {}:{}", a.file, a.line, b.file, b.line),
                _ => String::new(),
            };
            let _ = writeln!(
                text,
                "  deviation  {} mm{angle}, {} (tolerance {} mm){farthest}",
                at_most(mm),
                self.status,
                self.tolerance
            );
        }
        if let Some(planes) = self.planes_deg {
            let _ = writeln!(
                text,
                "  planes     tilted alike within {planes:.2e} degrees, which the deviation holds"
            );
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
            summary: &'a Figures,
        }
        serde_json::to_string(&Line { summary: self }).unwrap_or_default() + "\n"
    }
}
