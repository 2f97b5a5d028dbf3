//! Moves and switches become the steps of a program: straight moves of one feed are gathered into one run.

use super::running::{Coolant, Running, Spindle};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::geom::arc::Arc;
use crate::geom::deviation::Bound;
use crate::geom::nurbs::Nurbs;
use crate::ir::{Auxiliary, Curve, Cut, Intent, Located, Polyline, Program, Role, Step, ToolCall, map_along};
use crate::source::Span;
use crate::units::{Axes, Position};

/// How many coordinates a place has: X Y Z of the tip.
pub(super) const AXES: usize = 3;

/// The axis that retracts.
const Z: usize = 2;

/// Along Z.
pub(super) const UPRIGHT: [f64; 3] = [0.0, 0.0, 1.0];

/// A program in the making.
pub(super) struct Builder {
    steps: Vec<Located<f64, Curve>>,
    run: Option<(Polyline, f64, Span)>,
    /// Where the tool is known to be, mm.
    pub(super) position: Option<[f64; AXES]>,
    /// Which axes a rapid need not name, since nothing made a control forget them.
    told: bool,
    /// Whether this tool has moved since it was called, in the frame that holds.
    moved: bool,
    /// Where the tool was before that.
    pub(super) before: Option<[f64; AXES]>,
    /// The direction of the tool, of length 1.
    axis: [f64; 3],
    /// The direction that it had when its last move ended.
    stood: [f64; 3],
    /// Whether the tool was ever tilted, so that every place has its direction too.
    five: bool,
    running: Running,
    /// Where the frame changed, if the program has not stopped for that yet.
    stop_due: Option<Span>,
}

/// A tip and a direction in six places.
pub(super) fn joined(tip: &[f64; AXES], axis: &[f64; 3]) -> Position {
    [tip[0], tip[1], tip[2], axis[0], axis[1], axis[2]]
}

/// The components of a direction as a rapid names them.
fn directed(axis: &[f64; 3]) -> impl Iterator<Item = (usize, f64)> + use<> {
    let axis = *axis;
    (0..3).map(move |i| (AXES + i, axis[i]))
}

impl Builder {
    /// An empty program.
    pub(super) fn new() -> Builder {
        Builder {
            steps: Vec::new(),
            run: None,
            position: None,
            told: false,
            moved: false,
            before: None,
            axis: UPRIGHT,
            stood: UPRIGHT,
            five: false,
            running: Running::default(),
            stop_due: None,
        }
    }

    /// How many coordinates the program has.
    fn stride(&self) -> usize {
        if self.five { 2 * AXES } else { AXES }
    }

    /// A tip with the direction that the tool has.
    pub(super) fn place(&self, tip: &[f64; AXES]) -> Position {
        if self.five { joined(tip, &self.axis) } else { joined(tip, &[0.0; 3]) }
    }

    /// Turns the tool to a direction of length 1 with its next move. The first that is not Z makes the program one of five
    /// axes: up to there the tool stood upright.
    pub(super) fn turn(&mut self, axis: [f64; 3]) {
        if !self.five && axis != UPRIGHT {
            self.flush();
            self.five = true;
            let place = |p: &Position| joined(&[p[0], p[1], p[2]], &UPRIGHT);
            let rapid = |targets: &mut Vec<(usize, f64)>| targets.extend(directed(&UPRIGHT));
            map_along(&mut self.steps, 2 * AXES, rapid, place);
        }
        self.axis = axis;
    }

    /// Makes the program one of five axes.
    pub(super) fn tilt(&mut self) {
        let axis = self.axis;
        // Any other direction makes it one.
        self.turn([0.0; 3]);
        self.axis = axis;
    }

    /// Whether the control still knows where the tool is: no tool was called and no section began since its last move.
    pub(super) fn is_told(&self) -> bool {
        self.told
    }

    /// Takes the tool to stand in a direction of length 1, before anything moved.
    pub(super) fn stand(&mut self, axis: [f64; 3]) {
        self.stood = axis;
    }

    /// The direction that the tool had when its last move ended.
    pub(super) fn stood(&self) -> [f64; 3] {
        self.stood
    }

    /// The direction of the tool.
    pub(super) fn axis(&self) -> [f64; 3] {
        self.axis
    }

    /// Whether anything was cut or moved yet.
    pub(super) fn has_moved(&self) -> bool {
        self.run.is_some()
            || self.steps.iter().any(|located| matches!(located.step, Step::Rapid(_) | Step::Cut(_)))
    }

    fn flush(&mut self) {
        if let Some((line, feed, span)) = self.run.take() {
            let cut = Cut { feed: Some(feed), role: Role::AsAsked, curve: Curve::Lines(line) };
            self.steps.push(Located { step: Step::Cut(cut), span });
        }
    }

    fn step(&mut self, step: Step<f64, Curve>, span: Span) {
        self.flush();
        self.steps.push(Located { step, span });
    }

    /// Adds a remark: a section starts.
    pub(super) fn comment(&mut self, text: &str, span: Span) {
        if text.is_empty() {
            return;
        }
        self.step(Step::Comment(text.to_owned()), span);
        self.told = false;
    }

    /// Calls a tool.
    pub(super) fn tool(&mut self, call: ToolCall, span: Span) {
        // CAM systems leave it to the post to bring the tool away before it is changed.
        if self.stop().is_none() {
            self.step(Step::Home(Z), span);
        }
        self.step(Step::Tool(call), span);
        self.running.tool(call);
        (self.told, self.moved) = (false, false);
    }

    /// Starts the spindle, clockwise, rev/min.
    pub(super) fn spindle(&mut self, rpm: f64, span: Span) {
        self.running.spindle(Spindle::Turns(rpm));
        self.step(Step::Spindle(rpm), span);
    }

    /// Starts the coolant.
    pub(super) fn coolant(&mut self, span: Span) {
        self.running.coolant(Coolant::Flows);
        self.step(Step::Coolant, span);
    }

    /// Switches something.
    pub(super) fn auxiliary(&mut self, auxiliary: Auxiliary<f64>, span: Span) {
        if auxiliary == Auxiliary::SpindleStop {
            self.running.spindle(Spindle::Stopped);
        }
        if auxiliary == Auxiliary::CoolantStop {
            self.running.coolant(Coolant::Off);
        }
        self.step(Step::Auxiliary(auxiliary), span);
    }

    /// Goes to a point at rapid: all axes where a control may have forgotten them, otherwise those that move.
    pub(super) fn rapid(&mut self, to: &[f64; AXES], span: Span) {
        if let Some(span) = self.stop() {
            // The program starts again with the call of its tool.
            for step in self.running.again() {
                self.step(step, span);
            }
        }
        let known = self.position.filter(|_| self.told);
        let mut targets: Vec<(usize, f64)> =
            (0..AXES).filter(|&i| known.is_none_or(|from| from[i] != to[i])).map(|i| (i, to[i])).collect();
        if targets.is_empty() {
            targets.push((0, to[0]));
        }
        if self.five {
            // A direction is never modal.
            targets.extend(directed(&self.axis));
        }
        if let Some(up) = self.begins(to) {
            let (first, last) = targets.into_iter().partition(|(axis, _)| (*axis == Z) == up);
            self.step(Step::Rapid(first), span);
            targets = last;
        }
        self.step(Step::Rapid(targets), span);
        self.running.rapid(span);
        self.before = self.position;
        self.position = Some(*to);
        (self.told, self.moved) = (true, true);
        self.stood = self.axis;
    }

    /// Whether Z goes first in the first rapid of a file without a tool: nobody knows where the tool is, so it goes over the
    /// work first and then down. Where FROM says that it is lower, first up.
    fn begins(&self, to: &[f64; AXES]) -> Option<bool> {
        let begins = !self.has_moved() && self.running.has_no_tool() && !self.five;
        begins.then(|| self.position.is_some_and(|from| from[Z] < to[Z]))
    }

    /// The height of the tool along its axis and that axis, where it has moved since it was called.
    pub(super) fn height(&self) -> Option<(f64, [f64; 3])> {
        let place = self.position.filter(|_| self.moved)?;
        Some(((0..AXES).map(|i| place[i] * self.stood[i]).sum(), self.stood))
    }

    /// Goes to a point in a straight line, mm/min.
    #[inline]
    pub(super) fn line(&mut self, to: &[f64; AXES], feed: f64, line: u32, span: Span) {
        if self.run.as_ref().is_some_and(|(_, known, _)| *known != feed) {
            self.flush();
        }
        let start = match self.position {
            Some(tip) if self.five => joined(&tip, &self.stood),
            Some(tip) => self.place(&tip),
            None => self.place(to),
        };
        if self.run.is_none() {
            self.running.cuts(span);
            self.run = Some((Polyline::new(start, self.stride()), feed, span));
        }
        let Some((points, _, whole)) = &mut self.run else { return };
        points.values.extend_from_slice(to);
        if self.five {
            points.values.extend_from_slice(&self.axis);
        }
        points.lines.push(line);
        whole.end = span.end;
        self.before = self.position;
        self.position = Some(*to);
        (self.told, self.moved) = (true, true);
        self.stood = self.axis;
    }

    /// Follows an arc, mm/min.
    pub(super) fn arc(&mut self, arc: Arc, feed: f64, span: Span) {
        let end = arc.end();
        self.running.cuts(span);
        self.before = None;
        let cut = Cut { feed: Some(feed), role: Role::AsAsked, curve: Curve::Arc(arc) };
        self.step(Step::Cut(cut), span);
        self.position = Some([end[0], end[1], end[2]]);
        (self.told, self.moved) = (true, true);
        self.stood = self.axis;
    }

    /// Follows a spline, mm/min.
    pub(super) fn spline(&mut self, nurbs: Nurbs, feed: f64, span: Span) {
        let end = nurbs.points().last().copied();
        self.running.cuts(span);
        self.before = None;
        let cut = Cut { feed: Some(feed), role: Role::Path, curve: Curve::Nurbs(nurbs) };
        self.step(Step::Cut(cut), span);
        self.position = end.map(|end| [end[0], end[1], end[2]]);
        if let Some([_, _, _, x, y, z]) = end.filter(|_| self.five) {
            let length = (x * x + y * y + z * z).sqrt();
            self.axis = [x / length, y / length, z / length];
        }
        (self.told, self.moved) = (true, true);
        self.stood = self.axis;
    }

    /// Positions count in another frame from here on, which the operator sets: before the next move the tool is brought away and the
    /// program stops. Where the tool is in the new frame nobody knows.
    pub(super) fn reframed(&mut self, span: Span) {
        self.stop_due = Some(span);
        self.running.reframed();
        (self.told, self.moved) = (false, false);
        (self.position, self.before) = (None, None);
    }

    /// Stops for another frame, with the tool at home, where that is due.
    fn stop(&mut self) -> Option<Span> {
        let span = self.stop_due.take()?;
        self.step(Step::Home(Z), span);
        self.step(Step::Auxiliary(Auxiliary::Stop), span);
        Some(span)
    }

    /// What there is to say of spindle, coolant and tool where they cut.
    pub(super) fn told(&mut self) -> Diagnostics {
        std::mem::take(&mut self.running.diagnostics)
    }

    /// What was asked, in all.
    ///
    /// # Errors
    /// There is no move in it.
    pub(super) fn finish(
        mut self,
        name: String,
        name_span: Option<Span>,
        whole: Span,
        warnings: Diagnostics,
    ) -> Result<Intent, Diagnostics> {
        self.flush();
        if !self.has_moved() {
            let message = "the file has no move";
            return Err(Diagnostic::error("moves-missing", message).at(whole, "").into());
        }
        if self.steps.iter().any(|located| matches!(located.step, Step::Tool(_))) {
            let span = self.steps.last().map_or(whole, |located| located.span);
            self.steps.push(Located { step: Step::Home(Z), span });
        }
        let all = Axes::with_direction();
        let axes = Axes::new(&all.as_slice()[..self.stride()]).ok_or_else(Diagnostics::new)?;
        let program = Program { name, number: 0, axes, steps: self.steps };
        Ok(Intent {
            program,
            tolerance: None,
            name_span,
            radius: None,
            tilt_error: Bound::ZERO,
            input_error: 0.0,
            warnings,
        })
    }
}
