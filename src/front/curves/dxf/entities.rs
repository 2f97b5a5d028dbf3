//! Entities that are curves.

use super::super::conic::{Conic, TURN, cross, dot, unit};
use super::super::spline::Stated;
use super::super::turn::{self, Turn};
use super::super::{FileCurve, Path, Point};
use super::tags::Group;
use crate::diagnostic::Diagnostic;
use crate::geom::elementary::atan;
use crate::source::Span;

/// Where one unit of a normal's x and y is smaller than this, the arbitrary axis is Y instead of Z.
const SMALL: f64 = 1.0 / 64.0;

/// The coordinates of an entity with a normal.
pub(super) struct Own {
    x: Point,
    y: Point,
    z: Point,
}

impl Own {
    /// By the arbitrary axis algorithm, from codes 210, 220 and 230.
    pub(super) fn of(group: &Group<'_>) -> Result<Own, Diagnostic> {
        let normal = [
            group.float(210)?.unwrap_or(0.0),
            group.float(220)?.unwrap_or(0.0),
            group.float(230)?.unwrap_or(1.0),
        ];
        let wrong = || group.error("normal-zero", format!("{} has a normal without direction", group.name));
        let z = unit(&normal).ok_or_else(wrong)?;
        let other = if z[0].abs() < SMALL && z[1].abs() < SMALL { [0.0, 1.0, 0.0] } else { [0.0, 0.0, 1.0] };
        let x = unit(&cross(&other, &z)).ok_or_else(wrong)?;
        Ok(Own { x, y: cross(&z, &x), z })
    }

    pub(super) fn vector(&self, [x, y, z]: Point) -> Point {
        // Zero is added so that no coordinate is a negative zero.
        std::array::from_fn(|i| x * self.x[i] + y * self.y[i] + z * self.z[i] + 0.0)
    }
}

fn curve(group: &Group<'_>, kind: &'static str, path: Path) -> FileCurve {
    FileCurve::new(path, kind, group.head)
}

pub(super) fn line(group: &Group<'_>) -> Result<FileCurve, Diagnostic> {
    let points = vec![group.point(10, "start")?, group.point(11, "end")?];
    Ok(curve(group, "LINE", Path::Lines(points, vec![group.line])))
}

/// An ARC or a CIRCLE, counter-clockwise about its normal; angles in degrees.
pub(super) fn circle(group: &Group<'_>) -> Result<FileCurve, Diagnostic> {
    let own = Own::of(group)?;
    let center = own.vector(group.point(10, "centre")?);
    let radius = group.needed(40, "radius")?;
    if !(0.0 < radius) {
        return Err(group.error("radius-range", format!("{} has the radius {radius}", group.name)));
    }
    let arc = group.name == "ARC";
    let kind = if arc { "ARC" } else { "CIRCLE" };
    let degrees = |x: f64| x * (TURN / 360.0);
    let (from, turn) = if arc {
        let from = group.needed(50, "start angle")?;
        let stated = degrees(group.needed(51, "end angle")? - from);
        (degrees(from.rem_euclid(360.0)), turn::between_angles(kind, stated, group.head)?)
    } else {
        (0.0, Turn::WHOLE)
    };
    let (u, v) = (own.vector([radius, 0.0, 0.0]), own.vector([0.0, radius, 0.0]));
    Ok(curve(group, kind, Path::Conic(Conic::new(center, u, v, from, turn))))
}

/// Half the greater axis is stated, and what share of it the smaller one has; parameters in radians.
pub(super) fn ellipse(group: &Group<'_>) -> Result<FileCurve, Diagnostic> {
    let own = Own::of(group)?;
    let (center, u) = (group.point(10, "centre")?, group.point(11, "axis")?);
    let ratio = group.needed(40, "ratio of its axes")?;
    if !(0.0 < ratio && 0.0 < dot(&u, &u)) {
        return Err(group.error("radius-range", "ELLIPSE has an axis without length"));
    }
    let v = cross(&own.z, &u).map(|x| ratio * x);
    let from = group.float(41)?.unwrap_or(0.0);
    let stated = group.float(42)?.unwrap_or(TURN) - from;
    let turn = turn::between_angles("ELLIPSE", stated, group.head)?;
    let conic = Conic::new(center, u, v, from.rem_euclid(TURN), turn);
    Ok(curve(group, "ELLIPSE", Path::Conic(conic)))
}

pub(super) fn spline(group: &Group<'_>) -> Result<FileCurve, Diagnostic> {
    let points = group.points(10)?;
    let (knots, weights) = (group.all(40)?, group.all(41)?);
    group.count(73, "control points", points.len())?;
    group.count(72, "knots", knots.len())?;
    if points.is_empty() {
        let message = "SPLINE has fit points only: its shape is left to the CAD system";
        return Err(group
            .error("spline-fit-points", message)
            .hint("convert it to a spline with control points, or to a polyline"));
    }
    let degree = (group.needed(71, "degree")?, group.tags.iter().find(|tag| tag.code == 71));
    let degree = (degree.0, degree.1.map_or(group.head, |tag| tag.span));
    let stated = Stated { kind: "SPLINE", span: group.head, degree, knots, weights, points, range: None };
    let closed = group.whole(70)?.unwrap_or(0) & 1 == 1;
    Ok(FileCurve { closed, ..curve(group, "SPLINE", Path::Nurbs(stated.nurbs()?)) })
}

/// A corner of a polyline, and the bulge of what goes on from there: tan(θ/4) of an arc that turns by θ.
struct Corner {
    place: Point,
    bulge: f64,
    line: u32,
}

pub(super) fn light_polyline(group: &Group<'_>) -> Result<Vec<FileCurve>, Diagnostic> {
    let own = Own::of(group)?;
    let height = group.float(38)?.unwrap_or(0.0);
    let places = group.points(10)?;
    group.count(90, "vertices", places.len())?;
    let mut corners: Vec<Corner> = Vec::new();
    for tag in &group.tags {
        match (tag.code, corners.last_mut()) {
            (10, _) => {
                let [x, y, _] = places[corners.len()];
                corners.push(Corner { place: [x, y, height], bulge: 0.0, line: group.line });
            }
            (42, Some(corner)) => corner.bulge = group.number(tag)?,
            _ => {}
        }
    }
    let closed = group.whole(70)?.unwrap_or(0) & 1 == 1;
    Ok(polyline("LWPOLYLINE", group.head, &corners, closed, &own))
}

/// The lines and arcs of a polyline; lines in a row are one path.
fn polyline(kind: &'static str, span: Span, corners: &[Corner], closed: bool, own: &Own) -> Vec<FileCurve> {
    let mut curves: Vec<FileCurve> = Vec::new();
    let mut add = |path: Path| match (curves.last_mut().map(|last| &mut last.path), path) {
        (Some(Path::Lines(points, lines)), Path::Lines(more, from)) => {
            points.extend(&more[1..]);
            lines.extend(from);
        }
        (_, path) => curves.push(FileCurve::new(path, kind, span)),
    };
    let closing = corners.first().filter(|_| closed);
    for (corner, next) in corners.iter().zip(corners[1.min(corners.len())..].iter().chain(closing)) {
        let (p, q, b) = (corner.place, next.place, corner.bulge);
        if p == q {
            continue;
        }
        let (start, end) = (own.vector(p), own.vector(q));
        // The chord, 10⁻¹² of its half beside the arc.
        if b.abs() < 1e-12 {
            add(Path::Lines(vec![start, end], vec![corner.line]));
            continue;
        }
        // The centre lies (1 − b²)/4b of the chord to the left of its middle.
        let (dx, dy, k) = (q[0] - p[0], q[1] - p[1], (1.0 - b * b) / (4.0 * b));
        let center = [0.5 * (p[0] + q[0]) - k * dy, 0.5 * (p[1] + q[1]) + k * dx, p[2]];
        let (ux, uy) = (p[0] - center[0], p[1] - center[1]);
        let side = 1.0f64.copysign(b);
        let (u, v) = ([ux, uy, 0.0], [-side * uy, side * ux, 0.0]);
        // A bulge turns by less than a whole turn, and says so: nothing is reduced.
        let turn = Turn { by: 4.0 * atan(b.abs()), error: 0.0 };
        let arc = Conic::new(own.vector(center), own.vector(u), own.vector(v), 0.0, turn);
        add(Path::Conic(arc.with_ends(start, end)));
    }
    if curves.is_empty() {
        // Told of as a curve without length.
        let places = corners.iter().map(|corner| own.vector(corner.place)).collect();
        curves.push(FileCurve::new(Path::Lines(places, Vec::new()), kind, span));
    }
    curves
}

/// A POLYLINE whose vertices follow it as entities of their own.
pub(super) struct Polyline {
    head: Span,
    own: Option<Own>,
    flags: i64,
    corners: Vec<Corner>,
}

impl Polyline {
    /// A polyline; none of a mesh.
    pub(super) fn new(group: &Group<'_>) -> Result<Option<Polyline>, Diagnostic> {
        let flags = group.whole(70)?.unwrap_or(0);
        if flags & (16 | 64) != 0 {
            return Ok(None);
        }
        let own = Own::of(group)?;
        Ok(Some(Polyline { head: group.head, own: Some(own), flags, corners: Vec::new() }))
    }

    /// One that is left out together with its vertices.
    pub(super) fn ignored(group: &Group<'_>) -> Polyline {
        Polyline { head: group.head, own: None, flags: 0, corners: Vec::new() }
    }

    /// Takes a vertex.
    pub(super) fn vertex(&mut self, group: &Group<'_>) -> Result<(), Diagnostic> {
        // A control point of a polyline that is drawn as a spline lies beside it.
        if self.own.is_none() || group.whole(70)?.unwrap_or(0) & 16 != 0 {
            return Ok(());
        }
        let place = group.point(10, "place")?;
        let bulge = group.float(42)?.unwrap_or(0.0);
        self.corners.push(Corner { place, bulge, line: group.line });
        Ok(())
    }

    /// Its lines and arcs.
    pub(super) fn curves(self) -> Vec<FileCurve> {
        let Some(mut own) = self.own else { return Vec::new() };
        let spatial = self.flags & 8 != 0;
        if spatial {
            own = Own { x: [1.0, 0.0, 0.0], y: [0.0, 1.0, 0.0], z: [0.0, 0.0, 1.0] };
        }
        let mut corners = self.corners;
        if spatial {
            for corner in &mut corners {
                corner.bulge = 0.0;
            }
        }
        polyline("POLYLINE", self.head, &corners, self.flags & 1 == 1, &own)
    }

    /// What is wrong where its vertices are not ended.
    pub(super) fn unfinished(&self) -> Diagnostic {
        let message = "POLYLINE has no SEQEND behind its vertices";
        Diagnostic::error("seqend-missing", message).at(self.head, "")
    }
}
