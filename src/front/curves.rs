//! Curves of CAD files: what a job's `file = "outline.dxf"` names.
//!
//! | reader | file | its curves |
//! |---|---|---|
//! | [`dxf`] | `.dxf`, ASCII | SPLINE, LINE, ARC, CIRCLE, ELLIPSE, LWPOLYLINE, POLYLINE |
//! | [`iges`] | `.igs`, `.iges` | 126, 112, 110, 100, 102, 106, through transformations 124 |
//! | [`step`] | `.stp`, `.step`, `.p21` | B-splines of every form, lines, circles, ellipses, polylines, trimmed, composite, edges |
//!
//! A reader keeps every number as it stands, so knots and weights lose nothing, and knows where each number stands, so
//! that a message can point at it. That is why these are readers of our own, for curves only. Of the libraries that
//! there are, `dxf` 0.6 drops the stated counts of a SPLINE and the places of everything, so that a damaged one goes
//! unseen; `ruststep` 0.4 panics on long whole numbers, keeps no places and does not know a doubled quote in a text;
//! `truck-stepio` stands on it and prints its errors; for IGES there is none that stands alone.
//!
//! What a file says that is no curve is told of, once a kind. A curve of a kind that is not read is an error: a path
//! with a piece left out is another path.

pub mod conic;
pub mod dxf;
pub mod iges;
mod invert;
pub mod order;
mod spline;
pub mod step;
mod straight;
mod turn;

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::geom::bezier::Bezier;
use crate::geom::nurbs::Nurbs;
use crate::source::{Source, SourceId, Span};
use crate::units::{MAX_AXES, Position};
use conic::Conic;

/// A place in the coordinates of a file.
pub type Point = [f64; 3];

/// The greatest coordinate, mm.
const GREATEST: f64 = 1.0e6;

/// The most errors that are told of one file.
const MOST_ERRORS: usize = 20;

/// How a format is read.
pub struct Format {
    /// What people call it.
    pub name: &'static str,
    /// How its files end.
    pub extensions: &'static [&'static str],
    /// Its grammar, in `grammar/`.
    pub grammar: &'static str,
    /// Reads a file, in its own units.
    read: fn(&str, SourceId) -> Result<Read, Diagnostics>,
}

/// Every format that is read.
pub const FORMATS: &[Format] = &[
    Format { name: "DXF", extensions: &["dxf"], grammar: "dxf", read: dxf::read },
    Format { name: "IGES", extensions: &["igs", "iges"], grammar: "iges", read: iges::read },
    Format { name: "STEP", extensions: &["stp", "step", "p21"], grammar: "step", read: step::read },
];

/// The path of one curve.
#[derive(Clone, Debug, PartialEq)]
pub enum Path {
    /// Straight lines from point to point, and the line of the file that each of them came from.
    Lines(Vec<Point>, Vec<u32>),
    /// A part of a circle or an ellipse.
    Conic(Conic),
    /// Pieces that meet end to start.
    Pieces(Vec<Bezier>),
    /// A B-spline.
    Nurbs(Nurbs),
}

/// A curve of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct FileCurve {
    /// Its path, mm.
    pub path: Path,
    /// What the file calls it: `SPLINE`, `126`.
    pub kind: &'static str,
    /// Where it stands.
    pub span: Span,
    /// Whether the file says that it is closed.
    pub closed: bool,
    /// How far its path may be from what the file states, mm.
    pub error: f64,
}

impl FileCurve {
    fn new(path: Path, kind: &'static str, span: Span) -> FileCurve {
        FileCurve { path, kind, span, closed: false, error: 0.0 }
    }
}

/// What a file holds, in its own units.
struct Read {
    curves: Vec<FileCurve>,
    /// How long its unit is, mm; none where it does not say.
    unit: Unit,
    left_out: LeftOut,
    warnings: Diagnostics,
}

/// What a file says about its unit.
enum Unit {
    /// It is so many millimetres long.
    Stated(f64),
    /// Nothing that could be relied on: why, and where.
    Unknown(String, Option<Span>),
}

/// What a file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// Its curves in order, mm.
    pub curves: Vec<FileCurve>,
    /// What to know.
    pub warnings: Diagnostics,
}

/// Entities without a curve, by kind, in the order in which they were met.
#[derive(Default)]
struct LeftOut(Vec<(String, usize, Span)>);

impl LeftOut {
    fn add(&mut self, kind: &str, span: Span) {
        match self.0.iter_mut().find(|(known, ..)| known == kind) {
            Some((_, count, _)) => *count += 1,
            None => self.0.push((kind.to_owned(), 1, span)),
        }
    }

    fn warnings(self) -> Diagnostics {
        let warning = |(kind, count, span): (String, usize, Span)| {
            let message = if count == 1 {
                format!("{kind} is left out")
            } else {
                format!("{kind} is left out, {count} times")
            };
            Diagnostic::warning("entity-left-out", message).at(span, "")
        };
        Diagnostics(self.0.into_iter().map(warning).collect())
    }
}

/// One error at its place.
fn fail(id: &'static str, message: impl Into<String>, span: Span) -> Diagnostics {
    Diagnostic::error(id, message).at(span, "").into()
}

/// The format of a file by the end of its name.
pub fn format_of(name: &str) -> Option<&'static Format> {
    let extension = std::path::Path::new(name).extension()?.to_str()?.to_ascii_lowercase();
    FORMATS.iter().find(|format| format.extensions.contains(&extension.as_str()))
}

/// The curves of a file, `unit` mm being the length of its unit where somebody says so.
///
/// # Errors
/// The file is damaged, or has a curve that no path can be made of.
pub fn read(source: &Source, id: SourceId, format: &Format, unit: Option<f64>) -> Result<Found, Diagnostics> {
    let text = source.text.as_str();
    let first = Span::new(id, 0..0);
    if text.starts_with("AutoCAD Binary DXF") || text.contains('\0') {
        let message = format!("this is a binary file; {} is read as text", format.name);
        return Err(Diagnostic::error("file-binary", message)
            .at(first, "")
            .hint(format!("export it as ASCII {}", format.name))
            .into());
    }
    let Read { curves, unit: stated, left_out, mut warnings } = (format.read)(text, id)?;
    let scale = match (unit, stated) {
        (None, Unit::Stated(mm)) => mm,
        (None, Unit::Unknown(why, span)) => {
            return Err(Diagnostic::error("units-unknown", why)
                .at(span.unwrap_or(first), "")
                .hint("say beside `file` in the job: units = \"mm\", or units = \"inch\"")
                .into());
        }
        (Some(said), Unit::Unknown(..)) => said,
        (Some(said), Unit::Stated(mm)) => {
            if (said - mm).abs() > 1e-9 * mm {
                let message = format!(
                    "the file says that its unit is {mm} mm; `units` overrules it, {said} mm are taken"
                );
                warnings.push(Diagnostic::warning("units-overruled", message).at(first, ""));
            }
            said
        }
    };
    warnings.extend(left_out.warnings());
    let mut found = Vec::with_capacity(curves.len());
    let mut errors = Diagnostics::new();
    let mut empty = LeftOut::default();
    for curve in curves {
        let FileCurve { path, kind, span, closed, .. } = curve;
        let path = if scale == 1.0 { path } else { path.scaled(scale) };
        if !path.reach().is_some_and(|reach| reach < GREATEST) {
            if errors.0.len() < MOST_ERRORS {
                let message = format!("{kind} goes beyond a million mm");
                errors.push(Diagnostic::error("point-range", message).at(span, ""));
            }
        } else if path.is_empty() {
            empty.add(&format!("{kind} without length"), span);
        } else {
            if closed {
                warnings.0.extend(not_closed(&path, kind, span));
            }
            let (path, error) = straight::straightened(path);
            found.push(FileCurve { path, kind, span, closed, error });
        }
    }
    errors.into_result()?;
    warnings.extend(empty.warnings());
    Ok(Found { curves: found, warnings })
}

/// What to say of a curve that is said to be closed, and is not: it is run as its numbers have it.
fn not_closed(path: &Path, kind: &str, span: Span) -> Option<Diagnostic> {
    let apart = order::gap(&path.start(), &path.end());
    // Six printed digits of a coordinate.
    let most = 1e-6 * path.reach().unwrap_or(0.0).max(1.0);
    (most < apart).then(|| {
        let message = format!("{kind} is said to be closed, and ends {apart:.6} mm from its start");
        Diagnostic::warning("curve-open", message)
            .at(span, "is run as the open curve that its numbers make")
            .hint("where it should be closed, close it in the CAD system")
    })
}

/// A place of a file as a position in its three coordinates.
fn position(point: &Point) -> Position {
    let mut position = [0.0; MAX_AXES];
    position[..3].copy_from_slice(point);
    position
}

fn point(position: &Position) -> Point {
    [position[0], position[1], position[2]]
}

impl Path {
    /// Where it starts.
    pub fn start(&self) -> Point {
        match self {
            Path::Lines(points, _) => points.first().copied().unwrap_or_default(),
            Path::Conic(conic) => conic.start,
            Path::Pieces(pieces) => pieces.first().map_or([0.0; 3], |piece| point(&piece.start())),
            Path::Nurbs(nurbs) => point(&nurbs.points()[0]),
        }
    }

    /// Where it ends.
    pub fn end(&self) -> Point {
        match self {
            Path::Lines(points, _) => points.last().copied().unwrap_or_default(),
            Path::Conic(conic) => conic.end,
            Path::Pieces(pieces) => pieces.last().map_or([0.0; 3], |piece| point(&piece.end())),
            Path::Nurbs(nurbs) => point(&nurbs.points()[nurbs.points().len() - 1]),
        }
    }

    /// The same path from its end to its start.
    #[must_use]
    pub fn reversed(self) -> Path {
        match self {
            Path::Lines(mut points, mut lines) => {
                points.reverse();
                lines.reverse();
                Path::Lines(points, lines)
            }
            Path::Conic(conic) => Path::Conic(conic.reversed()),
            Path::Pieces(pieces) => Path::Pieces(pieces.iter().rev().map(Bezier::reversed).collect()),
            Path::Nurbs(nurbs) => Path::Nurbs(spline::reversed(&nurbs)),
        }
    }

    /// The same path from exactly this place, which is very near to its start.
    #[must_use]
    pub fn starting_at(self, start: Point) -> Path {
        match self {
            Path::Lines(mut points, lines) => {
                if let Some(first) = points.first_mut() {
                    *first = start;
                }
                Path::Lines(points, lines)
            }
            Path::Conic(conic) => Path::Conic(conic.with_ends(start, conic.end)),
            Path::Pieces(mut pieces) => {
                if let Some(first) = pieces.first_mut() {
                    first.points[0] = position(&start);
                }
                Path::Pieces(pieces)
            }
            Path::Nurbs(nurbs) => {
                let mut points = nurbs.points().to_vec();
                points[0] = position(&start);
                let moved =
                    Nurbs::new(nurbs.degree(), nurbs.knots().to_vec(), points, nurbs.weights().to_vec());
                Path::Nurbs(moved.unwrap_or(nurbs))
            }
        }
    }

    /// The path under an affine map of places.
    #[must_use]
    fn mapped(self, map: &impl Fn(&Point) -> Point) -> Path {
        let of = |p: &Position| position(&map(&point(p)));
        match self {
            Path::Lines(points, lines) => Path::Lines(points.iter().map(map).collect(), lines),
            Path::Conic(conic) => Path::Conic(conic.mapped(map)),
            Path::Pieces(mut pieces) => {
                for piece in &mut pieces {
                    piece.points = piece.points.each_ref().map(of);
                }
                Path::Pieces(pieces)
            }
            Path::Nurbs(nurbs) => Path::Nurbs(nurbs.mapped(of)),
        }
    }

    fn scaled(self, scale: f64) -> Path {
        self.mapped(&|p: &Point| p.map(|x| scale * x))
    }

    /// The control points, or points that hold the path between them.
    fn hull(&self, mut each: impl FnMut(&Point)) {
        match self {
            Path::Lines(points, _) => points.iter().for_each(each),
            Path::Conic(conic) => {
                let pieces = conic.mapped(&position).pieces();
                pieces.iter().flat_map(Bezier::control_points).for_each(|p| each(&point(p)));
            }
            Path::Pieces(pieces) => {
                pieces.iter().flat_map(Bezier::control_points).for_each(|p| each(&point(p)));
            }
            Path::Nurbs(nurbs) => nurbs.points().iter().for_each(|p| each(&point(p))),
        }
    }

    /// The greatest coordinate of its control points; none where one is no number.
    fn reach(&self) -> Option<f64> {
        let mut most = Some(0.0f64);
        self.hull(|p| {
            for x in p {
                most = most.filter(|_| x.is_finite()).map(|most| most.max(x.abs()));
            }
        });
        most
    }

    /// The greatest |z|.
    pub fn height(&self) -> f64 {
        let mut most = 0.0f64;
        self.hull(|p| most = most.max(p[2].abs()));
        most
    }

    /// The same path with z = 0.
    #[must_use]
    pub fn flat(self) -> Path {
        self.mapped(&|p: &Point| [p[0], p[1], 0.0])
    }

    /// Whether it has no length.
    fn is_empty(&self) -> bool {
        let start = self.start();
        let mut same = true;
        self.hull(|p| same &= *p == start);
        let turned = if let Path::Conic(conic) = self { !conic.moves() } else { false };
        same || turned
    }
}
