//! The curves of a job, each in its own coordinates first.

use super::file::CurveTable;
use super::{GREATEST, Placed, Reader};
use crate::diagnostic::Diagnostic;
use crate::front::curves::Point;
use crate::front::curves::conic::Conic;
use crate::geom::bezier::{Bezier, MAX_PIECE_DEGREE};
use crate::geom::nurbs::{Nurbs, NurbsError};
use crate::ir::{Curve, Described, Polyline};
use crate::source::Span;
use crate::tables::nearest;
use crate::units::{Axes, Axis, MAX_AXES, Position};
use std::ops::Range;
use std::sync::Arc;
use toml::Spanned;

/// The words of `kind`.
const KINDS: [&str; 5] = ["nurbs", "bezier", "polynomial", "points", "expression"];

/// The most points of one curve.
const MAX_POINTS: usize = 10_000_000;

/// A curve in coordinates of its own.
pub(super) enum Own {
    /// Any but an arc.
    Curve(Curve),
    /// A part of an ellipse: an arc where its plane is one of the machine's.
    Conic(Conic),
}

/// A curve in the coordinates that it names.
pub(super) struct Shape {
    /// The coordinates of its points.
    pub(super) axes: Vec<Axis>,
    /// Where other axes stand.
    pub(super) at: Vec<(Axis, f64)>,
    /// The curve, its coordinates in the order of `axes`.
    pub(super) curve: Own,
    /// Where it stands in the file.
    pub(super) span: Span,
    /// How far it may be from what its file states, mm.
    pub(super) error: f64,
}

impl Shape {
    /// All axes that it speaks of.
    pub(super) fn names(&self) -> impl Iterator<Item = Axis> {
        self.axes.iter().copied().chain(self.at.iter().map(|(axis, _)| *axis))
    }

    /// The curve in the coordinates of the program, other axes where `rest` says.
    pub(super) fn place(self, axes: &Axes, rest: &Position) -> Placed {
        // Every axis of a curve is one of the program's.
        let columns: Vec<usize> = self.axes.iter().filter_map(|axis| axes.index_of(*axis)).collect();
        let place = |own: &Position| {
            let mut point = *rest;
            for (from, to) in columns.iter().enumerate() {
                point[*to] = own[from];
            }
            point
        };
        let own = match self.curve {
            Own::Curve(curve) => curve,
            Own::Conic(conic) => {
                let conic = conic.mapped(&|p: &Point| place(&[p[0], p[1], p[2], 0.0, 0.0, 0.0]));
                let spatial = ["X", "Y", "Z"]
                    .iter()
                    .enumerate()
                    .all(|(i, name)| i < axes.count() && axes.name(i).as_str() == *name);
                let arc = if spatial { conic.arc().map(Curve::Arc) } else { None };
                let curve = arc.unwrap_or_else(|| Curve::Polynomial(conic.pieces()));
                return Placed {
                    curve,
                    start: conic.start,
                    end: conic.end,
                    span: self.span,
                    error: self.error,
                    rests: false,
                };
            }
        };
        let (curve, start, end) = match own {
            Curve::Lines(line) => {
                let start = place(&line.start);
                let mut placed = Polyline::new(start, axes.count());
                placed.values.reserve(line.count() * axes.count());
                placed.lines.clone_from(&line.lines);
                let mut end = start;
                for point in line.points() {
                    end = place(&point);
                    placed.push(&end);
                }
                (Curve::Lines(placed), start, end)
            }
            Curve::Polynomial(mut pieces) => {
                for piece in &mut pieces {
                    for point in &mut piece.points {
                        *point = place(point);
                    }
                }
                let (start, end) = (pieces[0].start(), pieces[pieces.len() - 1].end());
                (Curve::Polynomial(pieces), start, end)
            }
            Curve::Nurbs(nurbs) => {
                let placed = nurbs.mapped(place);
                let (start, end) = (placed.points()[0], placed.points()[placed.points().len() - 1]);
                (Curve::Nurbs(placed), start, end)
            }
            Curve::Formula(own) => {
                let mut described = own;
                for piece in &mut described.pieces {
                    for point in &mut piece.points {
                        *point = place(point);
                    }
                }
                let mut bound = [0.0; MAX_AXES];
                for (from, to) in columns.iter().enumerate() {
                    bound[*to] = described.bound[from];
                }
                described.bound = bound;
                described.formula = Arc::new(described.formula.placed(&columns, &rest[..axes.count()]));
                let pieces = &described.pieces;
                let (start, end) = (pieces[0].start(), pieces[pieces.len() - 1].end());
                (Curve::Formula(described), start, end)
            }
            // No kind of curve makes these; arcs of files are placed above.
            curve @ (Curve::Arc(_) | Curve::Through(..) | Curve::Logarithmic(_)) => (curve, *rest, *rest),
        };
        Placed { curve, start, end, span: self.span, error: self.error, rests: false }
    }
}

impl Reader<'_> {
    /// The curves of a table: one, or those of its file.
    pub(super) fn shapes(&mut self, table: Spanned<CurveTable>) -> Vec<Shape> {
        if table.get_ref().file.is_some() {
            return self.file(&table).unwrap_or_default();
        }
        self.shape(table).into_iter().collect()
    }

    /// The curve of a table.
    fn shape(&mut self, table: Spanned<CurveTable>) -> Option<Shape> {
        let range = table.span();
        let table = table.into_inner();
        // The header of the table, so that a thousand points are not shown for one message.
        let head = range.start..range.end.min(range.start + "[[curve]]".len());
        let Some(kind) = &table.kind else {
            self.hinted(
                "key-missing",
                "[[curve]] has neither `kind` nor `file`".to_owned(),
                head,
                format!("kind is one of {}; file names a DXF, IGES or STEP file", KINDS.join(", ")),
            );
            return None;
        };
        let word = kind.get_ref().as_str();
        if !KINDS.contains(&word) {
            let hint = match nearest(word, KINDS.into_iter()) {
                Some(meant) => format!("did you mean \"{meant}\"?"),
                None => format!("kind is one of {}", KINDS.join(", ")),
            };
            self.hinted("word-unknown", format!("`{word}` is not a kind of curve"), kind.span(), hint);
            return None;
        }
        self.needless(&table, word);
        let own = if word == "expression" { Some(self.expression(&table, head.clone())?) } else { None };
        let axes = match &own {
            Some((axes, _)) => axes.clone(),
            None => self.own_axes(&table, head.clone())?,
        };
        let at = self.at(&table, &axes);
        let curve = match (own, word) {
            (Some((_, curve)), _) => Some(curve),
            (None, "nurbs") => self.nurbs(&table, axes.len(), head.clone()),
            (None, "bezier") => self.bezier(&table, axes.len(), head.clone()),
            (None, "polynomial") => self.polynomial(&table, axes.len(), head.clone()),
            (None, _) => self.run(&table, axes.len(), head.clone()),
        }?;
        if stands_still(&curve) {
            self.error("curve-empty", "this curve has no length", head);
            return None;
        }
        let span = self.span(head);
        Some(Shape { axes, at, curve: Own::Curve(curve), span, error: 0.0 })
    }

    /// Keys that this kind of curve has no use for.
    pub(super) fn needless(&mut self, table: &CurveTable, kind: &str) {
        let used: &[&str] = match kind {
            "file" => &["file", "axes", "units", "order", "join"],
            "nurbs" => &["axes", "degree", "knots", "points", "weights"],
            "bezier" => &["axes", "degree", "points", "weights"],
            "polynomial" => &["axes", "coefficients", "range"],
            "expression" => &["u", "constants", "X", "Y", "Z", "U", "V", "W", "A", "B", "C"],
            _ => &["axes", "points"],
        };
        let expressions = table.expressions().map(|(name, text)| (name, text.as_ref().map(Spanned::span)));
        let present = [
            ("kind", table.kind.as_ref().map(Spanned::span).filter(|_| kind == "file")),
            ("units", table.units.as_ref().map(Spanned::span)),
            ("order", table.order.as_ref().map(Spanned::span)),
            ("join", table.join.as_ref().map(Spanned::span)),
            ("axes", table.axes.as_ref().map(Spanned::span)),
            ("u", table.u.as_ref().map(Spanned::span)),
            ("constants", table.constants.as_ref().map(Spanned::span)),
            ("degree", table.degree.as_ref().map(Spanned::span)),
            ("knots", table.knots.as_ref().map(Spanned::span)),
            ("points", table.points.as_ref().map(Spanned::span)),
            ("weights", table.weights.as_ref().map(Spanned::span)),
            ("coefficients", table.coefficients.as_ref().map(Spanned::span)),
            ("range", table.range.as_ref().map(Spanned::span)),
        ];
        for (key, span) in present.into_iter().chain(expressions) {
            if let Some(range) = span
                && !used.contains(&key)
            {
                let range = range.start..range.end.min(range.start + 1);
                let message = match kind {
                    "file" => format!("a curve of a file has no {key}"),
                    _ => format!("a curve of kind \"{kind}\" has no {key}"),
                };
                self.hinted("key-needless", message, range, format!("its keys are {}", used.join(", ")));
            }
        }
    }

    pub(super) fn own_axes(&mut self, table: &CurveTable, head: Range<usize>) -> Option<Vec<Axis>> {
        let Some(names) = &table.axes else {
            self.hinted(
                "key-missing",
                "[[curve]] has no `axes`".to_owned(),
                head,
                "add a line like `axes = [\"X\", \"Y\"]`",
            );
            return None;
        };
        let mut axes = Vec::new();
        for name in names.get_ref() {
            let axis = self.axis(name)?;
            if axes.contains(&axis) {
                self.error("axis-twice", format!("{axis} stands twice"), name.span());
                return None;
            }
            axes.push(axis);
        }
        if axes.is_empty() || MAX_AXES < axes.len() {
            self.error("axes-range", format!("a curve has 1 to {MAX_AXES} axes"), names.span());
            return None;
        }
        Some(axes)
    }

    pub(super) fn at(&mut self, table: &CurveTable, own: &[Axis]) -> Vec<(Axis, f64)> {
        let Some(at) = &table.at else { return Vec::new() };
        let mut places = Vec::new();
        for (name, value) in at.get_ref() {
            let x =
                self.number(name, value, "point-range", "must lie within a million", |x| x.abs() < GREATEST);
            let Some(axis) = self.axis(&Spanned::new(value.span(), name.clone())) else { continue };
            if own.contains(&axis) {
                self.error("axis-twice", format!("{axis} is one of the curve's own axes"), value.span());
            } else {
                places.push((axis, x));
            }
        }
        places
    }

    /// Rows of so many numbers each, as positions.
    fn rows(
        &mut self,
        key: &str,
        rows: Option<&Spanned<Vec<Spanned<Vec<f64>>>>>,
        axes: usize,
        head: Range<usize>,
    ) -> Option<Vec<Position>> {
        let Some(rows) = rows else {
            self.missing(key, head);
            return None;
        };
        if MAX_POINTS < rows.get_ref().len() {
            self.error("points-too-many", format!("a curve has at most {MAX_POINTS} points"), head);
            return None;
        }
        let mut points = Vec::with_capacity(rows.get_ref().len());
        for (i, row) in rows.get_ref().iter().enumerate() {
            let values = row.get_ref();
            if values.len() != axes {
                let message =
                    format!("point {} has {} coordinates; there are {axes} axes", i + 1, values.len());
                self.error("point-count", message, row.span());
                return None;
            }
            if let Some(x) = values.iter().find(|x| !(x.abs() < GREATEST)) {
                let message = format!("point {} has the coordinate {x}, beyond a million", i + 1);
                self.error("point-range", message, row.span());
                return None;
            }
            let mut point = [0.0; MAX_AXES];
            point[..axes].copy_from_slice(values);
            points.push(point);
        }
        Some(points)
    }

    fn missing(&mut self, key: &str, head: Range<usize>) {
        let example = match key {
            "degree" => "degree = 3",
            "knots" => "knots = [0, 0, 0, 0, 1, 1, 1, 1]",
            "coefficients" => "coefficients = [[0, 10], [0, 0, 5]]",
            _ => "points = [[0, 0], [10, 0], [10, 10], [20, 10]]",
        };
        self.hinted(
            "key-missing",
            format!("[[curve]] has no `{key}`"),
            head,
            format!("add a line like `{example}`"),
        );
    }

    fn degree(&mut self, degree: &Spanned<i64>) -> Option<usize> {
        let found = usize::try_from(*degree.get_ref()).ok().filter(|d| (1..=MAX_PIECE_DEGREE).contains(d));
        if found.is_none() {
            self.error("degree-range", format!("degree must be 1 to {MAX_PIECE_DEGREE}"), degree.span());
        }
        found
    }

    /// One weight a point; all 1 where none is stated.
    fn weights(&mut self, weights: Option<&Spanned<Vec<Spanned<f64>>>>, count: usize) -> Option<Vec<f64>> {
        let Some(weights) = weights else { return Some(vec![1.0; count]) };
        let values = weights.get_ref();
        if values.len() != count {
            let message = format!("{} weights for {count} points", values.len());
            self.hinted("weight-count", message, weights.span(), "each control point has one weight");
            return None;
        }
        for weight in values {
            if !(0.0 < *weight.get_ref() && weight.get_ref().is_finite()) {
                self.error("weight-range", "a weight must be greater than zero", weight.span());
                return None;
            }
        }
        Some(values.iter().map(|weight| *weight.get_ref()).collect())
    }

    fn nurbs(&mut self, table: &CurveTable, axes: usize, head: Range<usize>) -> Option<Curve> {
        let points = self.rows("points", table.points.as_ref(), axes, head.clone());
        let (Some(degree), Some(knots)) = (&table.degree, &table.knots) else {
            for (key, missing) in [("degree", table.degree.is_none()), ("knots", table.knots.is_none())] {
                if missing {
                    self.missing(key, head.clone());
                }
            }
            return None;
        };
        let p = self.degree(degree)?;
        let points = points?;
        let weights = self.weights(table.weights.as_ref(), points.len())?;
        let values: Vec<f64> = knots.get_ref().iter().map(|knot| *knot.get_ref()).collect();
        match Nurbs::clamped(p, values, points, weights) {
            Ok(nurbs) => Some(Curve::Nurbs(nurbs)),
            Err(error) => {
                let knot = |i: usize| knots.get_ref().get(i).map_or(head.clone(), Spanned::span);
                let (id, range) = match error {
                    NurbsError::Degree(_) => ("degree-range", degree.span()),
                    NurbsError::Counts { .. } => ("knot-count", knots.span()),
                    NurbsError::Decreases(i) => ("knots-decrease", knot(i)),
                    NurbsError::NotClamped(_) => ("knots-empty", knots.span()),
                    NurbsError::TooOften(i) => ("knot-too-often", knot(i)),
                    NurbsError::Breaks(i) => ("curve-breaks", knot(i)),
                    NurbsError::Weight(_) => ("weight-range", head),
                };
                let diagnostic = Diagnostic::error(id, error.to_string()).at(self.span(range), "");
                let diagnostic = match error {
                    NurbsError::Counts { points, degree, .. } if points <= degree => diagnostic
                        .hint(format!("a curve of degree {degree} has at least {} points", degree + 1)),
                    NurbsError::Breaks(_) => {
                        diagnostic.hint("make two curves of it, or give both control points there one place")
                    }
                    NurbsError::Counts { .. }
                    | NurbsError::Degree(_)
                    | NurbsError::Decreases(_)
                    | NurbsError::NotClamped(_)
                    | NurbsError::TooOften(_)
                    | NurbsError::Weight(_) => diagnostic,
                };
                self.diagnostics.push(diagnostic);
                None
            }
        }
    }

    fn bezier(&mut self, table: &CurveTable, axes: usize, head: Range<usize>) -> Option<Curve> {
        let points = self.rows("points", table.points.as_ref(), axes, head.clone())?;
        let degree = match &table.degree {
            Some(degree) => self.degree(degree)?,
            None => points.len().saturating_sub(1),
        };
        let fits = (1..=MAX_PIECE_DEGREE).contains(&degree)
            && 1 < points.len()
            && (points.len() - 1).is_multiple_of(degree);
        if !fits {
            let message = match table.degree {
                Some(_) => format!("{} points do not make Bezier curves of degree {degree}", points.len()),
                None => format!("{} points make no Bezier curve of degree 1 to 5", points.len()),
            };
            let range = table.points.as_ref().map_or(head, Spanned::span);
            let range = range.start..range.end.min(range.start + 1);
            self.hinted(
                "point-count",
                message,
                range,
                "with `degree` = 3 four points make one curve, and three more make the next",
            );
            return None;
        }
        let weights = self.weights(table.weights.as_ref(), points.len())?;
        let pieces = (0..(points.len() - 1) / degree).map(|i| {
            let mut piece = Bezier::new(&points[i * degree..=(i + 1) * degree]);
            piece.weights[..=degree].copy_from_slice(&weights[i * degree..=(i + 1) * degree]);
            piece
        });
        Some(Curve::Polynomial(pieces.collect()))
    }

    fn polynomial(&mut self, table: &CurveTable, axes: usize, head: Range<usize>) -> Option<Curve> {
        let Some(lists) = &table.coefficients else {
            self.missing("coefficients", head);
            return None;
        };
        if lists.get_ref().len() != axes {
            let message = format!("{} lists of coefficients for {axes} axes", lists.get_ref().len());
            self.error("coefficient-count", message, lists.span());
            return None;
        }
        let [from, to] = match table.range.as_ref().map(|range| (range.get_ref().as_slice(), range.span())) {
            None => [0.0, 1.0],
            Some(([from, to], _)) if from.get_ref() < to.get_ref() => [*from.get_ref(), *to.get_ref()],
            Some((_, place)) => {
                self.error("range-empty", "range is [from, to], with from below to", place);
                return None;
            }
        };
        let most = lists.get_ref().iter().map(|list| list.get_ref().len()).max().unwrap_or(0);
        let degree = most.saturating_sub(1).max(1);
        let mut points = [[0.0; MAX_AXES]; MAX_PIECE_DEGREE + 1];
        for (axis, list) in lists.get_ref().iter().enumerate() {
            let values = list.get_ref();
            if !(1..=MAX_PIECE_DEGREE + 1).contains(&values.len()) {
                let message = format!("an axis has 1 to {} coefficients", MAX_PIECE_DEGREE + 1);
                self.error("degree-range", message, list.span());
                return None;
            }
            // About u = from: f(from + v) by repeated synthetic division.
            let mut a = [0.0; MAX_PIECE_DEGREE + 1];
            a[..values.len()].copy_from_slice(values);
            for k in 0..=degree {
                for i in (k..degree).rev() {
                    a[i] += from * a[i + 1];
                }
            }
            let ordinates = Bezier::ordinates(&a[..=degree], to - from);
            if !ordinates.iter().all(|x| x.abs() < GREATEST) {
                self.error("point-range", "this curve goes beyond a million", list.span());
                return None;
            }
            for (point, x) in points.iter_mut().zip(ordinates) {
                point[axis] = x;
            }
        }
        Some(Curve::Polynomial(vec![Bezier::new(&points[..=degree])]))
    }

    /// A run of points, as lines.
    fn run(&mut self, table: &CurveTable, axes: usize, head: Range<usize>) -> Option<Curve> {
        let points = self.rows("points", table.points.as_ref(), axes, head.clone())?;
        let [first, rest @ ..] = &points[..] else {
            self.error("point-count", "a run has at least two points", head);
            return None;
        };
        let mut line = Polyline::new(*first, axes);
        line.values.reserve(rest.len() * axes);
        for point in rest {
            line.push(point);
        }
        Some(Curve::Lines(line))
    }
}

/// Whether all points of a curve are one.
fn stands_still(curve: &Curve) -> bool {
    match curve {
        Curve::Lines(line) | Curve::Through(_, line) => line.points().all(|point| point == line.start),
        Curve::Polynomial(pieces) | Curve::Formula(Described { pieces, .. }) => {
            pieces.iter().flat_map(Bezier::control_points).all(|point| *point == pieces[0].start())
        }
        Curve::Nurbs(nurbs) => nurbs.points().iter().all(|point| *point == nurbs.points()[0]),
        Curve::Logarithmic(_) | Curve::Arc(_) => false,
    }
}
