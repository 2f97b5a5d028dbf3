//! What a simulation tells beside its rows: how long, how well, where worst.

use super::track::{Place, Track};
use crate::units::{Axes, Kind, MAX_AXES, Position};
use serde::Serialize;
use std::fmt::Write as _;

/// The greatest value of something, and where.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Worst {
    /// The value, never negative.
    pub value: f64,
    /// When, s.
    pub t: f64,
    /// The line of its block; 0 where it has none.
    pub line: u32,
}

impl Worst {
    /// Keeps the greater.
    pub(super) fn meet(&mut self, value: f64, t: f64, place: Place) {
        if self.value < value {
            *self = Worst { value, t, line: place.line };
        }
    }

    /// `1.2e-3 at 0.5 s, line 27`.
    fn told(&self, value: &str) -> String {
        let line = if self.line == 0 { String::new() } else { format!(", line {}", self.line) };
        if self.value == 0.0 { value.to_owned() } else { format!("{value} at {:.3} s{line}", self.t) }
    }
}

/// What one axis does.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AxisFigures {
    /// Its name.
    pub axis: String,
    /// mm/min or degrees/min.
    pub speed: Worst,
    /// Within a block, mm/s² or degrees/s².
    pub acceleration: Worst,
    /// The change of speed from a cycle to the next where a joint of two blocks falls in, mm/min or degrees/min.
    pub step: Worst,
    /// Within a block, mm/s³ or degrees/s³.
    pub jerk: Worst,
}

/// Blocks against the time that the control takes for one.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Blocks {
    /// How many cut.
    pub count: usize,
    /// How long the shortest lasts, ms.
    pub shortest_ms: f64,
    /// What the control takes for one, ms, where the machine file says it.
    pub block_time_ms: Option<f64>,
    /// How many are shorter than that.
    pub short: usize,
    /// How much longer the control takes for them than they last, s.
    pub lost: f64,
    /// The stretch of such blocks where most is lost.
    pub starved: Option<Stretch>,
}

/// Blocks in a row that are shorter than the control's block time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Stretch {
    /// The line of the first; 0 where it has none.
    pub from_line: u32,
    /// The line of the last.
    pub to_line: u32,
    /// How many.
    pub blocks: usize,
    /// How long they last at their feed, s.
    pub time: f64,
    /// How long the control takes for them, s.
    pub needed: f64,
    /// How far they go, in what F counts.
    pub length: f64,
    /// As how many cubic blocks `--fit` would write their points, within the tolerance; none where that is no fewer.
    pub splines: Option<usize>,
}

/// The figures of a simulation.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// How many cycles at feed.
    pub cycles: u64,
    /// How far the path at feed goes, in what F counts.
    pub length: f64,
    /// How long it takes at feed, s.
    pub feed_time: f64,
    /// How long rapids take, s: those whose speed and distance are known.
    pub rapid_time: f64,
    /// How many rapids have no time, since the machine file has no max_speed for an axis or the start is not known.
    pub rapids_without_time: usize,
    /// How long it waits, s.
    pub dwell_time: f64,
    /// All of it, s.
    pub time: f64,
    /// The greatest |chord − asked|/asked.
    pub feed_error: Worst,
    /// The greatest distance of the curve from a chord, m.
    pub chord_error: Worst,
    /// What each axis does.
    pub axes: Vec<AxisFigures>,
    /// Whether limits of the machine were kept.
    pub limited: bool,
    /// Blocks against the control's time.
    pub blocks: Blocks,
    /// What to know.
    pub notes: Vec<String>,
}

impl Summary {
    pub(super) fn new(track: &Track, limited: bool) -> Summary {
        let figures = |(name, _): &(crate::units::Axis, Kind)| AxisFigures {
            axis: name.to_string(),
            speed: Worst::default(),
            acceleration: Worst::default(),
            step: Worst::default(),
            jerk: Worst::default(),
        };
        let mut notes = Vec::new();
        if track.through {
            notes.push(
                "the control's own spline is known at its points only; here lines join them".to_owned(),
            );
        }
        if track.radius_unknown {
            notes.push(
                "F counts rotary axes at a radius that the program does not say; here a degree counts as a millimetre"
                    .to_owned(),
            );
        }
        let mixed = |piece: &super::Piece<super::Shape>| {
            let counted = |kind: Kind| {
                let of_kind = |i: &usize| track.axes.kind(*i) == kind && piece.counts.0[*i] != 0.0;
                (0..track.axes.count()).any(|i| of_kind(&i))
            };
            counted(Kind::Linear) && counted(Kind::Rotary)
        };
        if track.pieces.iter().any(mixed) {
            notes.push("the length and the feed count rotary axes too, as F does".to_owned());
        }
        Summary {
            cycles: 0,
            length: 0.0,
            feed_time: 0.0,
            rapid_time: 0.0,
            rapids_without_time: 0,
            dwell_time: 0.0,
            time: 0.0,
            feed_error: Worst::default(),
            chord_error: Worst::default(),
            axes: track.axes.as_slice().iter().map(figures).collect(),
            limited,
            blocks: Blocks::default(),
            notes,
        }
    }

    /// As text, for standard error.
    pub fn render(&self, axes: &Axes) -> String {
        let mut text = String::new();
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{} cycles", self.cycles);
        let _ = writeln!(text, "  length        {:.3} mm", self.length);
        let untimed = match self.rapids_without_time {
            0 => String::new(),
            n => format!("; {n} rapids are not counted: no max_speed, or no known start"),
        };
        let waits = if self.dwell_time == 0.0 {
            String::new()
        } else {
            format!(", {:.3} s waiting", self.dwell_time)
        };
        let _ = writeln!(
            text,
            "  time          {:.3} s: {:.3} s at feed, {:.3} s at rapid{waits}{untimed}",
            self.time, self.feed_time, self.rapid_time
        );
        let feed = format!("{:.2e}", self.feed_error.value);
        let _ = writeln!(text, "  feed error    {}", self.feed_error.told(&feed));
        let chord = format!("{:.2e} m", self.chord_error.value);
        let _ = writeln!(text, "  chord error   {}", self.chord_error.told(&chord));
        for (figures, (_, kind)) in self.axes.iter().zip(axes.as_slice()) {
            let unit = match kind {
                Kind::Linear => "mm",
                Kind::Rotary => "degrees",
                // What the machine's axes do to turn the tool nobody knows here.
                Kind::Direction => continue,
            };
            let told =
                |worst: &Worst, per: &str| worst.told(&format!("{} {unit}/{per}", figure(worst.value)));
            let _ = writeln!(text, "  {:<4} speed    {}", figures.axis, told(&figures.speed, "min"));
            let _ = writeln!(text, "       accel.   {}", told(&figures.acceleration, "s2"));
            if figures.step.value != 0.0 {
                let _ = writeln!(text, "       joint    {}", told(&figures.step, "min"));
            }
            let _ = writeln!(text, "       jerk     {}", told(&figures.jerk, "s3"));
        }
        self.blocks.render(&mut text);
        for note in &self.notes {
            let _ = writeln!(text, "  note          {note}");
        }
        text
    }

    /// As one line of JSON.
    pub fn to_json(&self) -> String {
        serde_json::to_string(&serde_json::json!({ "simulation": self })).unwrap_or_default() + "\n"
    }
}

/// A value with three decimals, a small one with three figures.
fn figure(x: f64) -> String {
    if x == 0.0 || 0.1 <= x { format!("{:.3}", x + 0.0) } else { format!("{x:.2e}") }
}

impl Blocks {
    fn render(&self, text: &mut String) {
        let _ =
            writeln!(text, "  blocks        {}, the shortest lasts {:.3} ms", self.count, self.shortest_ms);
        let Some(block_time) = self.block_time_ms else { return };
        if self.short == 0 {
            let _ =
                writeln!(text, "                none is shorter than the control's {block_time} ms a block");
            return;
        }
        let _ = writeln!(
            text,
            "  starved       {} of them are shorter than the control's {block_time} ms a block, which costs {:.3} s",
            self.short, self.lost
        );
        let Some(stretch) = &self.starved else { return };
        let lines = if stretch.from_line == 0 {
            String::new()
        } else {
            format!(", lines {} to {}", stretch.from_line, stretch.to_line)
        };
        let _ = writeln!(
            text,
            "                most in {} blocks{lines}: {:.3} s at their feed, {:.3} s at the control's: {:.0} % of the feed",
            stretch.blocks,
            stretch.time,
            stretch.needed,
            100.0 * stretch.time / stretch.needed
        );
        match stretch.splines {
            Some(splines) => {
                let each = stretch.time / splines as f64 * 1e3;
                let enough = if block_time <= each { "at full feed" } else { "still too short" };
                let blocks = if splines == 1 { "block" } else { "blocks" };
                let does = if splines == 1 { "does" } else { "do" };
                let _ = writeln!(
                    text,
                    "                as splines (--fit, or a flute's own --motion) {splines} cubic {blocks} of {each:.1} ms {does}: {enough}"
                );
            }
            None => {
                let _ = writeln!(text, "                splines would not make them fewer");
            }
        }
    }
}

/// Speeds, accelerations and jerks of each axis, from positions at equal times.
pub(super) struct Kinematics {
    cycle: f64,
    /// The last three positions, the latest first, and on which piece each was.
    last: [(Position, usize); 3],
    /// How many of them there are.
    count: usize,
}

impl Kinematics {
    pub(super) fn new(cycle: f64) -> Kinematics {
        Kinematics { cycle, last: [([0.0; MAX_AXES], 0); 3], count: 0 }
    }

    /// A run starts here; where the axes stood, they stood for long.
    pub(super) fn start(&mut self, at: &Position, piece: usize, stood: bool) {
        self.last = [(*at, piece); 3];
        self.count = if stood { 3 } else { 1 };
    }

    /// One cycle later the axes are here.
    pub(super) fn arrive(
        &mut self,
        at: &Position,
        piece: usize,
        t: f64,
        place: Place,
        axes: &mut [AxisFigures],
    ) {
        let [one, two, three] = self.last;
        for (i, figures) in axes.iter_mut().enumerate() {
            let (now, one_at, two_at, three_at) = (at[i], one.0[i], two.0[i], three.0[i]);
            if 1 <= self.count {
                figures.speed.meet((now - one_at).abs() / self.cycle * 60.0, t, place);
            }
            if 2 <= self.count {
                let change = ((now - one_at) - (one_at - two_at)).abs() / self.cycle;
                if two.1 == piece {
                    figures.acceleration.meet(change / self.cycle, t, place);
                } else {
                    figures.step.meet(change * 60.0, t, place);
                }
            }
            if 3 <= self.count && three.1 == piece {
                let third = now - 3.0 * one_at + 3.0 * two_at - three_at;
                figures.jerk.meet(third.abs() / (self.cycle * self.cycle * self.cycle), t, place);
            }
        }
        self.last = [(*at, piece), one, two];
        self.count = (self.count + 1).min(3);
    }
}

/// Blocks against a block time, one at a time.
pub(super) struct BlockRate<'t> {
    track: &'t Track,
    blocks: Blocks,
    /// The stretch of short blocks that is open: its first and the time and length so far.
    open: Option<(usize, f64, f64)>,
    most: f64,
    /// The first and last of the stretch where most is lost.
    worst: Option<(usize, usize)>,
}

impl<'t> BlockRate<'t> {
    pub(super) fn new(track: &'t Track, block_time: Option<f64>) -> BlockRate<'t> {
        let blocks = Blocks { shortest_ms: f64::INFINITY, block_time_ms: block_time, ..Blocks::default() };
        BlockRate { track, blocks, open: None, most: 0.0, worst: None }
    }

    /// Block `piece` takes `time` s over `length`.
    pub(super) fn block(&mut self, piece: usize, time: f64, length: f64) {
        self.blocks.count += 1;
        self.blocks.shortest_ms = self.blocks.shortest_ms.min(time * 1e3);
        let Some(least) = self.blocks.block_time_ms.map(|ms| ms * 1e-3) else { return };
        if least <= time {
            self.close(piece);
            return;
        }
        self.blocks.short += 1;
        self.blocks.lost += least - time;
        let (first, so_far, way) = self.open.unwrap_or((piece, 0.0, 0.0));
        self.open = Some((first, so_far + time, way + length));
    }

    /// The stretch before block `next` is over.
    pub(super) fn close(&mut self, next: usize) {
        let (Some((first, time, length)), Some(ms)) = (self.open.take(), self.blocks.block_time_ms) else {
            return;
        };
        let blocks = next - first;
        let needed = blocks as f64 * ms * 1e-3;
        if self.most < needed - time {
            self.most = needed - time;
            self.worst = Some((first, next - 1));
            self.blocks.starved = Some(Stretch {
                from_line: self.track.places[first].line,
                to_line: self.track.places[next - 1].line,
                blocks,
                time,
                needed,
                length,
                splines: None,
            });
        }
    }

    /// What was found, and which pieces are the worst stretch.
    pub(super) fn finish(self) -> (Blocks, Option<(usize, usize)>) {
        (self.blocks, self.worst)
    }
}
