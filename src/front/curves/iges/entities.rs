//! Entities that are curves.

use super::super::conic::{Conic, TURN, dot};
use super::super::spline::{Number, Stated};
use super::super::turn;
use super::super::{FileCurve, LeftOut, MOST_ERRORS, Path, Point, Read, Unit, fail, order, point};
use super::cards::{Cards, Entry, Parameter, number};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::geom::bezier::Bezier;
use crate::geom::elementary::atan2;
use crate::units::MAX_AXES;
use std::collections::BTreeSet;

/// How deep composite curves and transformations may stand in each other.
const DEEPEST: usize = 16;

/// Pieces and ends that are no farther apart than this are one place, mm: what six printed decimals may lose.
const SAME: f64 = 2.0e-6;

/// Kinds that shape nothing: colours, properties, groups, views, definitions.
const SILENT: &[i64] = &[0, 124, 302, 304, 310, 312, 314, 402, 404, 406, 410];

/// Curves that are not read.
const UNREAD: &[(i64, &str)] = &[(130, "offset curve")];

/// Curves that are read.
const CURVES: &[i64] = &[100, 102, 104, 106, 110, 112, 126];

/// R p + T.
#[derive(Clone, Copy)]
struct Matrix([[f64; 4]; 3]);

impl Matrix {
    const SAME: Matrix = Matrix([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]);

    fn apply(&self, p: &Point) -> Point {
        self.0.map(|row| row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3])
    }

    /// This one behind another.
    fn after(&self, first: &Matrix) -> Matrix {
        let column = |j: usize| [first.0[0][j], first.0[1][j], first.0[2][j]];
        Matrix(std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let c = column(j);
                let turned: f64 = (0..3).map(|k| self.0[i][k] * c[k]).sum();
                if j == 3 { turned + self.0[i][3] } else { turned }
            })
        }))
    }
}

/// Reads the curves of a file.
pub(super) fn read(cards: &Cards) -> Result<Read, Diagnostics> {
    let mut errors = Diagnostics::new();
    let mut left_out = LeftOut::default();
    let mut curves = Vec::new();
    let (mut parts, mut reached) = (BTreeSet::new(), BTreeSet::new());
    for entry in cards.entries.iter().filter(|entry| entry.kind == 102) {
        match members(cards, entry) {
            Ok(numbers) => parts.extend(numbers),
            Err(error) => errors.extend(error),
        }
    }
    for entry in &cards.entries {
        if MOST_ERRORS <= errors.0.len() {
            break;
        }
        if SILENT.contains(&entry.kind) || parts.contains(&entry.number) {
            continue;
        }
        let open_line = entry.kind == 110 && entry.form != 0;
        let points = entry.kind == 106 && ![11, 12, 13, 63].contains(&entry.form);
        let name = format!("entity {}", entry.kind);
        if entry.blanked {
            left_out.add(&format!("{name} that is blanked"), entry.span);
        } else if let Some((kind, name)) = UNREAD.iter().find(|(kind, _)| *kind == entry.kind) {
            let error =
                Diagnostic::error("curve-unread", format!("{kind}, a {name}, is a curve that is not read"));
            errors.push(error.at(entry.span, "").hint("export curves as B-splines (126)"));
        } else if !CURVES.contains(&entry.kind) || open_line || points {
            left_out.add(&name, entry.span);
        } else if entry.depends {
            left_out.add(&format!("{name} that is a part of another"), entry.span);
        } else {
            match curve(cards, entry, 0, &mut reached) {
                Ok(own) => curves.extend(own),
                Err(error) => errors.extend(error),
            }
        }
    }
    errors.into_result()?;
    // Curves that are parts of each other have no whole.
    for entry in cards.entries.iter().filter(|e| parts.contains(&e.number) && !reached.contains(&e.number)) {
        left_out.add(&format!("entity {} that is a part of what is left out", entry.kind), entry.span);
    }
    let mut warnings = Diagnostics::new();
    if let Some((scale, span)) = cards.scale {
        let message = format!("the model has the scale {scale}; coordinates are taken as they stand");
        warnings.push(Diagnostic::warning("model-scale", message).at(span, ""));
    }
    let unit = match &cards.unit {
        Unit::Stated(mm) => Unit::Stated(*mm),
        Unit::Unknown(why, span) => Unit::Unknown(why.clone(), *span),
    };
    Ok(Read { curves, unit, left_out, warnings })
}

/// The parameters of an entity, read from the first to the last.
struct Reader<'c> {
    entry: &'c Entry,
    /// [`SAME`] in units of the file.
    same: f64,
    /// What is nearer than this is one place, in units of the file.
    resolution: f64,
    all: Vec<Parameter>,
    at: usize,
}

impl<'c> Reader<'c> {
    fn of(cards: &Cards, entry: &'c Entry) -> Result<Reader<'c>, Diagnostics> {
        let mm = if let Unit::Stated(mm) = cards.unit { mm } else { 1.0 };
        Ok(Reader {
            entry,
            same: SAME / mm,
            resolution: cards.resolution,
            all: cards.parameters(entry)?,
            at: 0,
        })
    }

    fn next(&mut self) -> Result<Number, Diagnostics> {
        let Some(parameter) = self.all.get(self.at) else {
            let message =
                format!("{} ends behind {} parameters; more belong to it", self.entry.kind, self.all.len());
            let span = self.all.last().map_or(self.entry.span, |last| last.span);
            return Err(fail("entity-truncated", message, span));
        };
        self.at += 1;
        number(parameter)
    }

    fn float(&mut self) -> Result<f64, Diagnostics> {
        self.next().map(|(x, _)| x)
    }

    /// A whole number from 0 to what parameters there can be.
    fn whole(&mut self, what: &str) -> Result<usize, Diagnostics> {
        let (x, span) = self.next()?;
        let most = self.all.len() as f64;
        if x.fract() == 0.0 && 0.0 <= x && x <= most {
            return Ok(x as usize);
        }
        let message = format!("{}: {x} is no {what} that its {most} parameters allow", self.entry.kind);
        Err(fail("count-differs", message, span))
    }

    fn many(&mut self, count: usize) -> Result<Vec<Number>, Diagnostics> {
        (0..count).map(|_| self.next()).collect()
    }

    fn point(&mut self) -> Result<Point, Diagnostics> {
        Ok([self.float()?, self.float()?, self.float()?])
    }
}

/// The numbers of the parts of a composite curve.
fn members(cards: &Cards, entry: &Entry) -> Result<Vec<usize>, Diagnostics> {
    let mut reader = Reader::of(cards, entry)?;
    let count = reader.whole("number of curves")?;
    (0..count).map(|_| reader.next().map(|(x, _)| x.abs() as usize)).collect()
}

/// The transformation of an entry.
fn matrix(cards: &Cards, entry: &Entry, depth: usize) -> Result<Matrix, Diagnostics> {
    if entry.matrix == 0 {
        return Ok(Matrix::SAME);
    }
    let wrong = |what: &str| fail("reference-unknown", format!("{} {what}", entry.kind), entry.span);
    let Some(own) = cards.find(entry.matrix).filter(|own| own.kind == 124) else {
        return Err(wrong("names a transformation that is none"));
    };
    if DEEPEST < depth {
        return Err(wrong("has transformations within each other without end"));
    }
    let mut reader = Reader::of(cards, own)?;
    let mut rows = [[0.0; 4]; 3];
    for x in rows.iter_mut().flatten() {
        *x = reader.float()?;
    }
    Ok(matrix(cards, own, depth + 1)?.after(&Matrix(rows)))
}

/// The curves of an entry, in the coordinates of the model.
fn curve(
    cards: &Cards,
    entry: &Entry,
    depth: usize,
    reached: &mut BTreeSet<usize>,
) -> Result<Vec<FileCurve>, Diagnostics> {
    let own = matrix(cards, entry, 0)?;
    let curves = if entry.kind == 102 {
        if DEEPEST < depth {
            let message = "102 has composite curves within each other without end";
            return Err(fail("reference-unknown", message, entry.span));
        }
        let mut curves = Vec::new();
        for number in members(cards, entry)? {
            let Some(part) = cards.find(number) else {
                let message = format!("102 names the entity {number}, which there is none of");
                return Err(fail("reference-unknown", message, entry.span));
            };
            reached.insert(number);
            // A point may stand between curves.
            if matches!(part.kind, 116 | 132) {
                continue;
            }
            if !CURVES.contains(&part.kind) {
                let message = format!("102 has a part of kind {}, a curve that is not read", part.kind);
                return Err(fail("curve-unread", message, part.span));
            }
            curves.extend(curve(cards, part, depth + 1, reached)?);
            if 1_000_000 < curves.len() {
                return Err(fail("points-too-many", "102 has more than a million curves", entry.span));
            }
        }
        curves
    } else {
        let (kind, path) = simple(cards, entry)?;
        vec![FileCurve::new(path, kind, entry.span)]
    };
    Ok(curves
        .into_iter()
        .map(|curve| match entry.matrix {
            0 => curve,
            _ => FileCurve { path: curve.path.mapped(&|p: &Point| own.apply(p)), ..curve },
        })
        .collect())
}

/// A curve without parts, in its own coordinates.
fn simple(cards: &Cards, entry: &Entry) -> Result<(&'static str, Path), Diagnostics> {
    let mut reader = Reader::of(cards, entry)?;
    Ok(match entry.kind {
        110 => ("110", Path::Lines(vec![reader.point()?, reader.point()?], Vec::new())),
        100 => ("100", arc(&mut reader)?),
        104 => ("104", conic_arc(&mut reader)?),
        106 => ("106", points(&mut reader)?),
        112 => ("112", parametric(&mut reader)?),
        _ => ("126", rational(&mut reader)?),
    })
}

/// ZT, the centre, the start and the end: counter-clockwise about Z, and the whole circle where the file does not tell the
/// end from the start.
fn arc(reader: &mut Reader<'_>) -> Result<Path, Diagnostics> {
    let z = reader.float()?;
    let mut place = || -> Result<Point, Diagnostics> { Ok([reader.float()?, reader.float()?, z]) };
    let (center, start, end) = (place()?, place()?, place()?);
    let (ux, uy) = (start[0] - center[0], start[1] - center[1]);
    let (u, v) = ([ux, uy, 0.0], [-uy, ux, 0.0]);
    if ux == 0.0 && uy == 0.0 {
        return Err(fail("radius-range", "100 starts at its centre", reader.entry.span));
    }
    let by = Conic::angle(&center, &u, &v, &end).rem_euclid(TURN);
    let turn =
        turn::between_places("100", by, (order::gap(&start, &end), reader.resolution), reader.entry.span)?;
    let conic = Conic::new(center, u, v, 0.0, turn).with_ends(start, end);
    let misfit = conic.misfit();
    // What eight printed digits leave of a radius.
    let most = 1e-6 * (ux * ux + uy * uy).sqrt() + reader.same;
    if most < misfit {
        let message = format!("100 ends {misfit:.3e} beside its circle");
        return Err(fail("arc-misfit", message, reader.entry.span));
    }
    Ok(Path::Conic(conic))
}

/// A part of an ellipse A x² + B xy + C y² + D x + E y + F = 0 at the height ZT, from the start to the end, counter-clockwise
/// about Z. Its centre c and its matrix are
///
/// ```text
/// (2A  B ) c = −(D)          M = 1/−F' (A    B/2)          F' = F + (D, E)·c/2
/// (B   2C)      (E)                    (B/2  C  )
/// ```
///
/// so that (p − c)ᵀ M (p − c) = 1. With u from the centre to the start and v = J M u/√det M, J a quarter turn, uᵀMv = 0 and
/// vᵀMv = uᵀMu = 1: these are half axes that belong together, and a place lies at the angle of (uᵀMd, vᵀMd).
fn conic_arc(reader: &mut Reader<'_>) -> Result<Path, Diagnostics> {
    let span = reader.entry.span;
    let mut six = [0.0; 6];
    for x in &mut six {
        *x = reader.float()?;
    }
    let [a, b, c, d, e, f] = six;
    let z = reader.float()?;
    let mut place = || -> Result<Point, Diagnostics> { Ok([reader.float()?, reader.float()?, z]) };
    let (start, end) = (place()?, place()?);
    let det = 4.0 * a * c - b * b;
    let center = [(b * e - 2.0 * c * d) / det, (b * d - 2.0 * a * e) / det, z];
    let rest = -(f + 0.5 * (d * center[0] + e * center[1]));
    let [p, q, r] = [a, 0.5 * b, c].map(|x| x / rest);
    let square = p * r - q * q;
    if !(0.0 < det && 0.0 < p && 0.0 < square && square.is_finite()) {
        let message = "104 is a part of a parabola or hyperbola, a curve that is not read";
        return Err(Diagnostic::error("curve-unread", message)
            .at(span, "")
            .hint("export curves as B-splines (126)")
            .into());
    }
    let times = |x: f64, y: f64| [p * x + q * y, q * x + r * y];
    let (ux, uy) = (start[0] - center[0], start[1] - center[1]);
    let own = times(ux, uy);
    // The start is brought onto the ellipse; how far it was beside is looked at below.
    let size = (own[0] * ux + own[1] * uy).sqrt();
    if !(0.0 < size) {
        return Err(fail("radius-range", "104 starts at its centre", span));
    }
    let u = [ux / size, uy / size, 0.0];
    let [mx, my] = times(u[0], u[1]);
    let v = [-my / square.sqrt(), mx / square.sqrt(), 0.0];
    let [nx, ny] = times(v[0], v[1]);
    let (dx, dy) = (end[0] - center[0], end[1] - center[1]);
    let by = atan2(nx * dx + ny * dy, mx * dx + my * dy).rem_euclid(TURN);
    let turn = turn::between_places("104", by, (order::gap(&start, &end), reader.resolution), span)?;
    let conic = Conic::new(center, u, v, 0.0, turn).with_ends(start, end);
    let misfit = conic.misfit();
    // Ten printed digits of the six numbers leave as much of the axes.
    let most = 1e-6 * dot(&u, &u).max(dot(&v, &v)).sqrt() + reader.same;
    if most < misfit {
        return Err(fail("arc-misfit", format!("104 ends {misfit:.3e} beside its ellipse"), span));
    }
    Ok(Path::Conic(conic))
}

/// Copious data: forms 11 and 63 have one z and pairs, 12 triples, 13 triples with a vector each.
fn points(reader: &mut Reader<'_>) -> Result<Path, Diagnostics> {
    let kind = reader.whole("interpretation")?;
    let count = reader.whole("number of points")?;
    let z = if kind == 1 { reader.float()? } else { 0.0 };
    let mut places = Vec::with_capacity(count);
    for _ in 0..count {
        places.push(match kind {
            1 => [reader.float()?, reader.float()?, z],
            2 | 3 => {
                let place = reader.point()?;
                if kind == 3 {
                    reader.point()?;
                }
                place
            }
            _ => {
                let message = format!("106 has the interpretation {kind}; it is 1, 2 or 3");
                return Err(fail("count-differs", message, reader.entry.span));
            }
        });
    }
    if reader.entry.form == 63 && places.first() != places.last() {
        places.extend(places.first().copied());
    }
    places.dedup();
    Ok(Path::Lines(places, Vec::new()))
}

/// A parametric spline: pieces of third degree in power form.
fn parametric(reader: &mut Reader<'_>) -> Result<Path, Diagnostics> {
    let span = reader.entry.span;
    let (_kind, _continuity) = (reader.whole("spline type")?, reader.whole("degree of continuity")?);
    let (_plane, count) = (reader.whole("number of dimensions")?, reader.whole("number of pieces")?);
    let breaks = reader.many(count + 1)?;
    let mut pieces: Vec<Bezier> = Vec::with_capacity(count);
    for pair in breaks.windows(2) {
        let length = pair[1].0 - pair[0].0;
        if !(0.0 < length) {
            return Err(fail("knots-decrease", "112: a break point is not behind the one before", pair[1].1));
        }
        let mut points = [[0.0; MAX_AXES]; 4];
        for axis in 0..3 {
            let a = [reader.float()?, reader.float()?, reader.float()?, reader.float()?];
            for (point, x) in points.iter_mut().zip(Bezier::ordinates(&a, length)) {
                point[axis] = x;
            }
        }
        if let Some(last) = pieces.last() {
            let apart = order::gap(&point(&last.end()), &point(&points[0]));
            if reader.same < apart {
                let message = format!("112: a piece starts {apart:.3e} from where the one before ends");
                return Err(fail("curve-breaks", message, pair[0].1));
            }
            points[0] = last.end();
        }
        pieces.push(Bezier::new(&points));
    }
    if pieces.is_empty() {
        return Err(fail("count-differs", "112 has no piece", span));
    }
    Ok(Path::Pieces(pieces))
}

/// A rational B-spline.
fn rational(reader: &mut Reader<'_>) -> Result<Path, Diagnostics> {
    let last = reader.whole("upper index")?;
    let degree = reader.next()?;
    for _ in 0..4 {
        reader.next()?;
    }
    let kind = "126";
    let span = reader.entry.span;
    if !(0.0..=100.0).contains(&degree.0) {
        return Err(fail("degree-range", format!("126 has degree {}", degree.0), degree.1));
    }
    let knots = reader.many(last + degree.0 as usize + 2)?;
    let weights = reader.many(last + 1)?;
    let points = (0..=last).map(|_| reader.point()).collect::<Result<_, _>>()?;
    let range = [reader.float()?, reader.float()?];
    // Some writers leave the range out.
    let range = Some(range).filter(|range| range[0] != range[1]);
    let equal = weights.windows(2).all(|pair| pair[0].0 == pair[1].0);
    // Equal weights cancel, where they are weights at all.
    let weights = if equal && weights.iter().all(|w| 0.0 < w.0) { Vec::new() } else { weights };
    Ok(Path::Nurbs(Stated { kind, span, degree, knots, weights, points, range }.nurbs()?))
}
