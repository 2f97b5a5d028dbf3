//! Moves and switches become the steps of a program: straight moves of one feed are gathered into one run.

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::geom::arc::Arc;
use crate::geom::nurbs::Nurbs;
use crate::ir::{Auxiliary, Curve, Cut, Intent, Located, Polyline, Program, Role, Step};
use crate::source::Span;
use crate::units::{Axes, Axis, Kind, Position};

/// How many coordinates there are: X Y Z.
pub(super) const AXES: usize = 3;

/// A program in the making.
pub(super) struct Builder {
    steps: Vec<Located<f64, Curve>>,
    run: Option<(Polyline, f64, Span)>,
    /// Where the tool is known to be, mm.
    pub(super) position: Option<[f64; AXES]>,
    /// Which axes a rapid need not name, since nothing made a control forget them.
    told: bool,
    /// Where the tool was before that.
    pub(super) before: Option<[f64; AXES]>,
}

/// X Y Z in six places.
pub(super) fn position(point: &[f64; AXES]) -> Position {
    [point[0], point[1], point[2], 0.0, 0.0, 0.0]
}

impl Builder {
    /// An empty program.
    pub(super) fn new() -> Builder {
        Builder { steps: Vec::new(), run: None, position: None, told: false, before: None }
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
    pub(super) fn tool(&mut self, number: u32, span: Span) {
        self.step(Step::Tool(number), span);
        self.told = false;
    }

    /// Starts the spindle, clockwise, rev/min.
    pub(super) fn spindle(&mut self, rpm: f64, span: Span) {
        self.step(Step::Spindle(rpm), span);
    }

    /// Starts the coolant.
    pub(super) fn coolant(&mut self, span: Span) {
        self.step(Step::Coolant, span);
    }

    /// Switches something.
    pub(super) fn auxiliary(&mut self, auxiliary: Auxiliary<f64>, span: Span) {
        self.step(Step::Auxiliary(auxiliary), span);
    }

    /// Goes to a point at rapid: all axes where a control may have forgotten them, otherwise those that move.
    pub(super) fn rapid(&mut self, to: &[f64; AXES], span: Span) {
        let known = self.position.filter(|_| self.told);
        let mut targets: Vec<(usize, f64)> =
            (0..AXES).filter(|&i| known.is_none_or(|from| from[i] != to[i])).map(|i| (i, to[i])).collect();
        if targets.is_empty() {
            targets.push((0, to[0]));
        }
        self.step(Step::Rapid(targets), span);
        self.before = self.position;
        self.position = Some(*to);
        self.told = true;
    }

    /// Goes to a point in a straight line, mm/min.
    #[inline]
    pub(super) fn line(&mut self, to: &[f64; AXES], feed: f64, line: u32, span: Span) {
        if self.run.as_ref().is_some_and(|(_, known, _)| *known != feed) {
            self.flush();
        }
        let start = self.position.unwrap_or(*to);
        let (points, _, whole) =
            self.run.get_or_insert_with(|| (Polyline::new(position(&start), AXES), feed, span));
        points.values.extend_from_slice(to);
        points.lines.push(line);
        whole.end = span.end;
        self.before = self.position;
        self.position = Some(*to);
        self.told = true;
    }

    /// Follows an arc, mm/min.
    pub(super) fn arc(&mut self, arc: Arc, feed: f64, span: Span) {
        let end = arc.end();
        self.before = None;
        let cut = Cut { feed: Some(feed), role: Role::AsAsked, curve: Curve::Arc(arc) };
        self.step(Step::Cut(cut), span);
        self.position = Some([end[0], end[1], end[2]]);
        self.told = true;
    }

    /// Follows a spline, mm/min.
    pub(super) fn spline(&mut self, nurbs: Nurbs, feed: f64, span: Span) {
        let end = nurbs.points().last().copied();
        self.before = None;
        let cut = Cut { feed: Some(feed), role: Role::Path, curve: Curve::Nurbs(nurbs) };
        self.step(Step::Cut(cut), span);
        self.position = end.map(|end| [end[0], end[1], end[2]]);
        self.told = true;
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
        let linear = |name| Axis::new(name).map(|axis| (axis, Kind::Linear));
        let list: Option<Vec<(Axis, Kind)>> = ["X", "Y", "Z"].into_iter().map(linear).collect();
        let axes = list.and_then(|list| Axes::new(&list)).ok_or_else(Diagnostics::new)?;
        let program = Program { name, number: 1, axes, steps: self.steps };
        Ok(Intent { program, tolerance: None, name_span, radius: None, warnings })
    }
}
