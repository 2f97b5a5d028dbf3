//! Instances that are curves, and which of them make the path.

use super::model::{Instance, Model};
use super::text::Value;
use super::units;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::front::curves::conic::{Conic, TURN, cross, dot, unit};
use crate::front::curves::invert::parameters;
use crate::front::curves::order::gap;
use crate::front::curves::spline::{Number, Stated, part};
use crate::front::curves::turn::{self, Turn};
use crate::front::curves::{FileCurve, LeftOut, MOST_ERRORS, Path, Point, Read, Unit, fail};
use crate::geom::nurbs::Nurbs;
use crate::source::Span;
use std::cell::RefCell;
use std::collections::BTreeSet;

/// How deep curves may be made of others.
const DEEPEST: usize = 16;

/// The most curves of one composite.
const MOST: usize = 1_000_000;

/// An edge whose ends are no farther than this from those of its curve is the whole of it, mm.
const EDGE: f64 = 1.0e-3;

/// Curves that have both ends, or are closed.
const BOUNDED: &[&str] = &[
    "CIRCLE",
    "ELLIPSE",
    "POLYLINE",
    "B_SPLINE_CURVE_WITH_KNOTS",
    "QUASI_UNIFORM_CURVE",
    "UNIFORM_CURVE",
    "BEZIER_CURVE",
    "TRIMMED_CURVE",
    "COMPOSITE_CURVE",
    "SURFACE_CURVE",
    "SEAM_CURVE",
    "INTERSECTION_CURVE",
];

/// Curves that are not read.
const UNREAD: &[&str] =
    &["PARABOLA", "HYPERBOLA", "OFFSET_CURVE_3D", "CLOTHOID", "CIRCULAR_INVOLUTE", "INDEXED_POLY_CURVE"];

/// What makes use of curves.
const USERS: &[&str] = &[
    "TRIMMED_CURVE",
    "COMPOSITE_CURVE",
    "COMPOSITE_CURVE_SEGMENT",
    "EDGE_CURVE",
    "SURFACE_CURVE",
    "SEAM_CURVE",
    "INTERSECTION_CURVE",
    "OFFSET_CURVE_3D",
    "PCURVE",
    "DEFINITIONAL_REPRESENTATION",
    "SURFACE_OF_LINEAR_EXTRUSION",
    "SURFACE_OF_REVOLUTION",
];

/// Sets of curves.
const SETS: &[&str] = &["GEOMETRIC_CURVE_SET", "GEOMETRIC_SET"];

/// What has a shape and is no curve.
const SHAPES: &[&str] = &[
    "ADVANCED_FACE",
    "FACE_SURFACE",
    "OPEN_SHELL",
    "CLOSED_SHELL",
    "MANIFOLD_SOLID_BREP",
    "BREP_WITH_VOIDS",
    "TESSELLATED_SOLID",
    "TRIANGULATED_FACE",
    "COMPLEX_TRIANGULATED_FACE",
];

/// Reads the curves of a file.
pub(super) fn read(model: &Model<'_>) -> Result<Read, Diagnostics> {
    let units = units::of(model)?;
    let mm = if let Unit::Stated(mm) = units.length { mm } else { 1.0 };
    let reader = Reader { model, angle: units.angle, same: EDGE / mm, reached: RefCell::default() };
    let mut out = Out {
        curves: Vec::new(),
        errors: Diagnostics::new(),
        rest: LeftOut::default(),
        done: BTreeSet::new(),
    };
    let mut used: BTreeSet<u64> = BTreeSet::new();
    let mut faces = 0;
    for (number, keyword) in &model.order {
        if USERS.contains(keyword) {
            used.extend(model.get(*number, model.span(*number))?.references());
        } else if SHAPES.contains(keyword) {
            faces += usize::from(keyword.ends_with("FACE") || *keyword == "FACE_SURFACE");
            out.rest.add(keyword, model.span(*number));
        } else if ["MAPPED_ITEM", "CONTEXT_DEPENDENT_SHAPE_REPRESENTATION"].contains(keyword) {
            out.rest.add(&format!("{keyword}, which places a part,"), model.span(*number));
        }
    }
    let of = |wanted: &'static [&'static str]| {
        model.order.iter().filter(move |(_, keyword)| wanted.contains(keyword)).map(|(number, _)| *number)
    };
    for number in of(SETS) {
        let set = model.get(number, model.span(number))?;
        for item in set.list(set.parameter(0, 1)?)? {
            let Value::Reference(number) = item.value else { continue };
            let own = model.get(number, set.place(item))?;
            if is_curve(&own) {
                out.take(number, reader.curve(number, set.place(item), 0));
            } else if UNREAD.contains(&own.keyword()) || own.is("LINE") {
                out.take(number, Err(unread(&own)));
            } else {
                out.rest.add(own.keyword(), own.span);
                out.done.insert(number);
            }
        }
    }
    for number in of(&["EDGE_LOOP", "PATH", "OPEN_PATH"]) {
        let edges = model.get(number, model.span(number))?;
        for item in edges.list(edges.parameter(0, 1)?)? {
            let oriented = model.follow(&edges, item)?;
            let (Value::Reference(edge), forwards) =
                (&oriented.parameter(0, 3)?.value, oriented.parameter(0, 4)?)
            else {
                return Err(fail("parameter-kind", "an edge is wanted here", oriented.span));
            };
            let forwards = oriented.truth(forwards)?;
            out.take(
                *edge,
                reader.edge(*edge, oriented.span).map(|mut curve| {
                    if !forwards {
                        curve.path = curve.path.reversed();
                    }
                    vec![curve]
                }),
            );
        }
    }
    for (number, keyword) in &model.order {
        let span = model.span(*number);
        if MOST_ERRORS <= out.errors.0.len() {
            break;
        }
        if *keyword == "EDGE_CURVE" {
            out.take(*number, reader.edge(*number, span).map(|curve| vec![curve]));
        } else if used.contains(number) {
        } else if UNREAD.contains(keyword) {
            out.take(*number, Err(unread(&model.get(*number, span)?)));
        } else if *keyword == "LINE" && !out.done.contains(number) {
            out.rest.add("LINE without ends", span);
        } else if BOUNDED.contains(keyword)
            || (keyword.is_empty() && model.text(*number).contains("B_SPLINE_CURVE"))
        {
            out.take(*number, reader.curve(*number, span, 0));
        }
    }
    for (number, keyword) in &model.order {
        // What surfaces are made of, and curves that are parts of each other.
        if ["TRIMMED_CURVE", "COMPOSITE_CURVE"].contains(keyword) && !reader.reached.borrow().contains(number)
        {
            out.rest.add(&format!("{keyword} that is a part of what is left out"), model.span(*number));
        }
    }
    let Out { curves, errors, rest: left_out, .. } = out;
    let mut warnings = errors.into_result()?;
    if 1 < faces
        && let Some(first) = curves.first()
    {
        let message = format!("the curves are the edges of {faces} faces, each run once");
        warnings.push(
            Diagnostic::warning("edges-of-faces", message)
                .at(first.span, "")
                .hint("export the curves that make the path alone"),
        );
    }
    Ok(Read { curves, unit: units.length, left_out, warnings })
}

fn is_curve(own: &Instance<'_>) -> bool {
    BOUNDED.contains(&own.keyword()) || own.is("B_SPLINE_CURVE") || own.is("EDGE_CURVE")
}

fn unread(own: &Instance<'_>) -> Diagnostics {
    let message = match own.keyword() {
        "LINE" => format!("#{}, a LINE, has no ends", own.number),
        keyword => format!("#{}, a {keyword}, is a curve that is not read", own.number),
    };
    Diagnostic::error("curve-unread", message).at(own.span, "").hint("export curves as B-splines").into()
}

/// What was found so far.
struct Out {
    curves: Vec<FileCurve>,
    errors: Diagnostics,
    rest: LeftOut,
    /// Instances that were taken.
    done: BTreeSet<u64>,
}

impl Out {
    fn take(&mut self, number: u64, curves: Result<Vec<FileCurve>, Diagnostics>) {
        if !self.done.insert(number) {
            return;
        }
        match curves {
            Ok(curves) => self.curves.extend(curves),
            Err(errors) => self.errors.extend(errors),
        }
    }
}

struct Reader<'m, 't> {
    model: &'m Model<'t>,
    /// The unit of angles, radians.
    angle: f64,
    /// Ends of edges, in units of the file.
    same: f64,
    /// The curves that were read, be it as a part of others.
    reached: RefCell<BTreeSet<u64>>,
}

/// The ends of a part of a curve: a parameter, a place or both.
struct Trim {
    parameter: Option<f64>,
    place: Option<Point>,
}

impl Reader<'_, '_> {
    /// The curves of an instance.
    fn curve(&self, number: u64, from: Span, depth: usize) -> Result<Vec<FileCurve>, Diagnostics> {
        let own = self.model.get(number, from)?;
        self.reached.borrow_mut().insert(number);
        if DEEPEST < depth {
            let message = format!("#{number} is made of curves within each other without end");
            return Err(fail("reference-unknown", message, own.span));
        }
        let one = |kind: &'static str, path: Path| Ok(vec![FileCurve::new(path, kind, own.span)]);
        match own.keyword() {
            "CIRCLE" | "ELLIPSE" => {
                let kind = if own.is("CIRCLE") { "CIRCLE" } else { "ELLIPSE" };
                let (center, u, v) = self.ellipse(&own)?;
                one(kind, Path::Conic(Conic::new(center, u, v, 0.0, Turn::WHOLE)))
            }
            "POLYLINE" => {
                let list = own.list(own.parameter(0, 1)?)?;
                let points = list.iter().map(|p| self.model.triple(&own, p)).collect::<Result<_, _>>()?;
                one("POLYLINE", Path::Lines(points, Vec::new()))
            }
            "TRIMMED_CURVE" => self.trimmed(&own, depth),
            "COMPOSITE_CURVE" => self.composite(&own, depth),
            "SURFACE_CURVE" | "SEAM_CURVE" | "INTERSECTION_CURVE" => {
                let inner = self.model.follow(&own, own.parameter(0, 1)?)?;
                self.curve(inner.number, own.span, depth + 1)
            }
            "EDGE_CURVE" => self.edge(number, from).map(|curve| vec![curve]),
            _ if own.is("B_SPLINE_CURVE") || BOUNDED.contains(&own.keyword()) => {
                one("B_SPLINE_CURVE", Path::Nurbs(self.spline(&own)?))
            }
            _ => Err(unread(&own)),
        }
    }

    /// Centre and half axes.
    fn ellipse(&self, own: &Instance<'_>) -> Result<(Point, Point, Point), Diagnostics> {
        let place = self.model.follow(own, own.parameter(0, 1)?)?;
        if !place.is("AXIS2_PLACEMENT_3D") {
            let message = format!("#{} has no placement in space", own.number);
            return Err(fail("kind-differs", message, own.span));
        }
        let direction = |i: usize| -> Result<Option<Point>, Diagnostics> {
            let parameter = place.parameter(0, i)?;
            if parameter.value == Value::Omitted {
                return Ok(None);
            }
            self.model.triple(&place, parameter).map(Some)
        };
        let wrong =
            || fail("normal-zero", format!("#{} has axes without direction", place.number), place.span);
        let z = unit(&direction(2)?.unwrap_or([0.0, 0.0, 1.0])).ok_or_else(wrong)?;
        // Where nothing is said X is taken, or Y where that is the axis.
        let other = if z[1] == 0.0 && z[2] == 0.0 { [0.0, 1.0, 0.0] } else { [1.0, 0.0, 0.0] };
        let stated = direction(3)?.unwrap_or(other);
        let along = dot(&stated, &z);
        let x = unit(&std::array::from_fn(|i| stated[i] - along * z[i])).ok_or_else(wrong)?;
        let y = cross(&z, &x);
        let center = self.model.triple(&place, place.parameter(0, 1)?)?;
        let a = own.number(own.parameter(0, 2)?)?;
        let b = if own.is("CIRCLE") { a } else { own.number(own.parameter(0, 3)?)? };
        for (x, span) in [a, b] {
            if !(0.0 < x) {
                return Err(fail("radius-range", format!("#{} has the radius {x}", own.number), span));
            }
        }
        Ok((center, x.map(|c| a.0 * c + 0.0), y.map(|c| b.0 * c + 0.0)))
    }

    /// A B-spline, rational or not, with knots that it states or that follow from its kind.
    fn spline(&self, own: &Instance<'_>) -> Result<Nurbs, Diagnostics> {
        // A complex instance has its name in a record of its own.
        let complex = own.is("B_SPLINE_CURVE");
        let (keyword, skip) = if complex { ("B_SPLINE_CURVE", 0) } else { (own.keyword(), 1) };
        let degree = own.number(own.of(keyword, skip)?)?;
        let list = own.list(own.of(keyword, skip + 1)?)?;
        let points: Vec<Point> = list.iter().map(|p| self.model.triple(own, p)).collect::<Result<_, _>>()?;
        let numbers =
            |parameter| own.list(parameter)?.iter().map(|p| own.number(p)).collect::<Result<Vec<_>, _>>();
        let rational = own.is("RATIONAL_B_SPLINE_CURVE");
        let weights = if rational { numbers(own.of("RATIONAL_B_SPLINE_CURVE", 0)?)? } else { Vec::new() };
        let (p, count) = (degree.0, points.len() as f64);
        let knots = if own.is("B_SPLINE_CURVE_WITH_KNOTS") {
            let first = if complex { 0 } else { 6 };
            let many = own.of("B_SPLINE_CURVE_WITH_KNOTS", first)?;
            let multiplicities = numbers(many)?;
            let knots = numbers(own.of("B_SPLINE_CURVE_WITH_KNOTS", first + 1)?)?;
            if multiplicities.len() != knots.len() {
                let message = format!(
                    "#{} has {} multiplicities for {} knots",
                    own.number,
                    multiplicities.len(),
                    knots.len()
                );
                return Err(fail("knot-count", message, own.place(many)));
            }
            let most = count + p + 1.0;
            let mut all = Vec::new();
            for (knot, (times, span)) in knots.into_iter().zip(multiplicities) {
                if !(1.0 <= times && times <= most && times.fract() == 0.0) {
                    let message = format!("#{}: {times} is no multiplicity of a knot", own.number);
                    return Err(fail("knot-count", message, span));
                }
                all.extend(std::iter::repeat_n(knot, times as usize));
                if most < all.len() as f64 {
                    let message = format!(
                        "#{} has more knots than {count} control points of degree {p} need, {most}",
                        own.number
                    );
                    return Err(fail("knot-count", message, own.place(many)));
                }
            }
            all
        } else {
            own_knots(own, degree, count)?
        };
        let stated =
            Stated { kind: "B_SPLINE_CURVE", span: own.span, degree, knots, weights, points, range: None };
        Ok(stated.nurbs()?)
    }

    fn composite(&self, own: &Instance<'_>, depth: usize) -> Result<Vec<FileCurve>, Diagnostics> {
        let mut curves = Vec::new();
        for item in own.list(own.parameter(0, 1)?)? {
            let segment = self.model.follow(own, item)?;
            let forwards = segment.truth(segment.parameter(0, 1)?)?;
            let inner = self.model.follow(&segment, segment.parameter(0, 2)?)?;
            let mut parts = self.curve(inner.number, segment.span, depth + 1)?;
            if !forwards {
                parts = backwards(parts);
            }
            curves.extend(parts);
            if MOST < curves.len() {
                return Err(fail("points-too-many", "a curve is made of more than a million", own.span));
            }
        }
        Ok(curves)
    }

    fn trim(&self, own: &Instance<'_>, i: usize) -> Result<Trim, Diagnostics> {
        let mut trim = Trim { parameter: None, place: None };
        for item in own.list(own.parameter(0, i)?)? {
            match &item.value {
                Value::Typed(record)
                    if record.keyword == "PARAMETER_VALUE" && record.parameters.len() == 1 =>
                {
                    trim.parameter = Some(own.number(&record.parameters[0])?.0);
                }
                Value::Number(_) => trim.parameter = Some(own.number(item)?.0),
                Value::Typed(_)
                | Value::Text(_)
                | Value::Word(_)
                | Value::Reference(_)
                | Value::List(_)
                | Value::Omitted
                | Value::Derived => trim.place = Some(self.model.vertex(own, item)?),
            }
        }
        Ok(trim)
    }

    /// A part of a curve, between parameters or places.
    fn trimmed(&self, own: &Instance<'_>, depth: usize) -> Result<Vec<FileCurve>, Diagnostics> {
        let basis = self.model.follow(own, own.parameter(0, 1)?)?;
        let (first, second) = (self.trim(own, 2)?, self.trim(own, 3)?);
        let forwards = own.truth(own.parameter(0, 4)?)?;
        let by_parameter = own.parameter(0, 5)?.value == Value::Word("PARAMETER");
        let missing = || fail("trim-missing", format!("#{} says no end of its curve", own.number), own.span);
        let one = |path: Path| Ok(vec![FileCurve::new(path, "TRIMMED_CURVE", own.span)]);
        if basis.is("LINE") {
            let start = self.model.triple(&basis, basis.parameter(0, 1)?)?;
            let vector = self.model.follow(&basis, basis.parameter(0, 2)?)?;
            let direction = self.model.triple(&vector, vector.parameter(0, 1)?)?;
            let size = vector.number(vector.parameter(0, 2)?)?.0;
            let along = unit(&direction).ok_or_else(|| {
                fail("normal-zero", format!("#{} has no direction", vector.number), vector.span)
            })?;
            let at = |trim: &Trim| {
                let place = trim.parameter.map(|t| std::array::from_fn(|i| start[i] + t * size * along[i]));
                if by_parameter { place.or(trim.place) } else { trim.place.or(place) }
            };
            let (Some(from), Some(to)) = (at(&first), at(&second)) else { return Err(missing()) };
            return one(Path::Lines(vec![from, to], Vec::new()));
        }
        if basis.is("CIRCLE") || basis.is("ELLIPSE") {
            let (center, u, v) = self.ellipse(&basis)?;
            let stated = first.parameter.zip(second.parameter);
            let places = first.place.zip(second.place);
            let turned = match stated.filter(|_| by_parameter || places.is_none()) {
                Some((from, to)) => {
                    let stated = self.angle * (if forwards { to - from } else { from - to });
                    let turn = turn::between_angles("an arc", stated, own.span)?;
                    ((from * self.angle).rem_euclid(TURN), turn)
                }
                None => {
                    let at = |trim: &Trim| {
                        let angle = trim.parameter.map(|t| t * self.angle);
                        trim.place.or_else(|| Some(Conic::place(&center, &u, &v, angle?)))
                    };
                    let (Some(start), Some(end)) = (at(&first), at(&second)) else { return Err(missing()) };
                    Self::turned((&center, &u, &v), (&start, &end), forwards, own.span)?
                }
            };
            let ends = (first.place, second.place);
            return one(self.arc((center, u, v), turned, ends, forwards, own.span)?);
        }
        let mut curves = self.curve(basis.number, own.span, depth + 1)?;
        if let ([FileCurve { path: Path::Nurbs(nurbs), .. }], Some(from), Some(to)) =
            (&curves[..], first.parameter, second.parameter)
        {
            let (low, high) = if forwards { (from, to) } else { (to, from) };
            let path = part(nurbs, low, high).map(Path::Nurbs).ok_or_else(|| {
                let message = format!("#{} runs from {from} to {to}, which its curve does not", own.number);
                fail("range-outside", message, own.span)
            })?;
            return one(if forwards { path } else { path.reversed() });
        }
        if !forwards {
            curves = backwards(curves);
        }
        let whole = |at: Option<Point>, end: Option<Point>| match (at, end) {
            (Some(a), Some(b)) => gap(&a, &b) <= self.same,
            _ => false,
        };
        let (start, end) = (curves.first().map(|c| c.path.start()), curves.last().map(|c| c.path.end()));
        if whole(first.place, start) && whole(second.place, end) {
            return Ok(curves);
        }
        if let ([FileCurve { path, .. }], Some(from), Some(to)) = (&curves[..], first.place, second.place)
            && let Some(path) = self.between(path, &from, &to)
        {
            return one(path);
        }
        let message = format!("#{} is a part of a curve, and its ends do not say which", own.number);
        Err(Diagnostic::error("trim-unread", message)
            .at(own.span, "")
            .hint("export the part as a curve of its own, or its ends as parameters")
            .into())
    }

    /// An arc that starts at an angle, forwards or backwards; between places where they are known.
    fn arc(
        &self,
        (center, u, v): (Point, Point, Point),
        (from, turn): (f64, Turn),
        ends: (Option<Point>, Option<Point>),
        forwards: bool,
        span: Span,
    ) -> Result<Path, Diagnostics> {
        let conic = if forwards {
            Conic::new(center, u, v, from, turn)
        } else {
            Conic::new(center, u, v, from - turn.by, turn).reversed()
        };
        let conic = conic.with_ends(ends.0.unwrap_or(conic.start), ends.1.unwrap_or(conic.end));
        let misfit = conic.misfit();
        if self.same < misfit {
            return Err(fail("arc-misfit", format!("an arc ends {misfit:.3e} beside its circle"), span));
        }
        Ok(Path::Conic(conic))
    }

    /// The angle of one place on a circle or ellipse, and how far it is from there to another, forwards or backwards.
    fn turned(
        (center, u, v): (&Point, &Point, &Point),
        (start, end): (&Point, &Point),
        forwards: bool,
        span: Span,
    ) -> Result<(f64, Turn), Diagnostics> {
        let (from, to) = (Conic::angle(center, u, v, start), Conic::angle(center, u, v, end));
        let by = (if forwards { to - from } else { from - to }).rem_euclid(TURN);
        // Ends of edges are instances, which are one or not.
        Ok((from, turn::between_places("an arc", by, (gap(start, end), 0.0), span)?))
    }

    /// The part of a path from one place to another, where each of them lies on it once; the ends of a closed one are passed
    /// twice, of which that counts which leads forwards.
    fn between(&self, path: &Path, start: &Point, end: &Point) -> Option<Path> {
        let Path::Nurbs(nurbs) = path else { return None };
        let starts = parameters(nurbs, start, self.same)?;
        let ends = parameters(nurbs, end, self.same)?;
        let mut forwards = starts.iter().flat_map(|from| ends.iter().map(move |to| (*from, *to)));
        let mut forwards = forwards.by_ref().filter(|(from, to)| from < to);
        let (Some((from, to)), None) = (forwards.next(), forwards.next()) else { return None };
        // Ends that are near to each other may be a part of the curve or the rest of it.
        (self.same < gap(start, end)).then(|| part(nurbs, from, to).map(Path::Nurbs))?
    }

    /// An edge, from its first vertex to its second.
    fn edge(&self, number: u64, from: Span) -> Result<FileCurve, Diagnostics> {
        let own = self.model.get(number, from)?;
        if !own.is("EDGE_CURVE") {
            return Err(fail("kind-differs", format!("#{number} is no EDGE_CURVE"), from));
        }
        let start = self.model.vertex(&own, own.parameter(0, 1)?)?;
        let end = self.model.vertex(&own, own.parameter(0, 2)?)?;
        let mut basis = self.model.follow(&own, own.parameter(0, 3)?)?;
        let forwards = own.truth(own.parameter(0, 4)?)?;
        if ["SURFACE_CURVE", "SEAM_CURVE", "INTERSECTION_CURVE"].contains(&basis.keyword()) {
            basis = self.model.follow(&basis, basis.parameter(0, 1)?)?;
        }
        let path = if basis.is("LINE") {
            Path::Lines(vec![start, end], Vec::new())
        } else if basis.is("CIRCLE") || basis.is("ELLIPSE") {
            let (center, u, v) = self.ellipse(&basis)?;
            let turned = Self::turned((&center, &u, &v), (&start, &end), forwards, own.span)?;
            self.arc((center, u, v), turned, (Some(start), Some(end)), forwards, own.span)?
        } else {
            let mut curves = self.curve(basis.number, own.span, 1)?;
            let path = match (curves.pop(), curves.is_empty()) {
                (Some(curve), true) => curve.path,
                _ => return Err(fail("edge-part", format!("#{number} has no single curve"), own.span)),
            };
            let path = if forwards { path } else { path.reversed() };
            if gap(&path.start(), &start).max(gap(&path.end(), &end)) <= self.same {
                path
            } else {
                self.between(&path, &start, &end).ok_or_else(|| {
                    let message = format!("#{number} is a part of its curve, and its ends do not say which");
                    Diagnostic::error("edge-part", message)
                        .at(own.span, "")
                        .hint("export the edges as curves of their own")
                })?
            }
        };
        Ok(FileCurve::new(path, "EDGE_CURVE", own.span))
    }
}

/// Knots that follow from the kind.
fn own_knots(own: &Instance<'_>, degree: Number, count: f64) -> Result<Vec<Number>, Diagnostics> {
    let at = |x: f64| (x, own.span);
    if !(1.0..=5.0).contains(&degree.0) || count <= degree.0 {
        // What is wrong is told of by whoever makes a curve of it.
        return Ok(Vec::new());
    }
    let (p, n) = (degree.0 as i32, count as i32 - 1);
    if own.is("UNIFORM_CURVE") {
        return Ok((-p..=n + 1).map(|i| at(f64::from(i))).collect());
    }
    let (spans, inner) = if own.is("BEZIER_CURVE") {
        if n % p != 0 {
            let message =
                format!("#{}: {} points do not make Bezier curves of degree {p}", own.number, n + 1);
            return Err(fail("point-count", message, own.span));
        }
        (n / p, p)
    } else {
        (n - p + 1, 1)
    };
    let times = |i: i32| if i == 0 || i == spans { p + 1 } else { inner };
    Ok((0..=spans).flat_map(|i| std::iter::repeat_n(at(f64::from(i)), times(i) as usize)).collect())
}

/// Curves in a row from the last to the first, each from its end to its start.
fn backwards(curves: Vec<FileCurve>) -> Vec<FileCurve> {
    let turned = |curve: FileCurve| FileCurve { path: curve.path.reversed(), ..curve };
    curves.into_iter().rev().map(turned).collect()
}
