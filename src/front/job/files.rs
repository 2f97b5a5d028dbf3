//! Curves of a file that a job names: read, put in order, joined.

use super::curves::{Own, Shape};
use super::file::CurveTable;
use super::{MEET, Reader, kind_of};
use crate::diagnostic::Diagnostic;
use crate::front::curves::order::{self, Order, gap};
use crate::front::curves::{self, FORMATS, FileCurve, Path, Point};
use crate::ir::{Curve, Polyline};
use crate::source::{LineColumn, Source};
use crate::tables::nearest;
use crate::units::{Axis, Kind, MAX_AXES, Position};
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A drawing whose z is nowhere more than this is plane: what rounding leaves of a zero, mm.
const PLANE: f64 = 1.0e-9;

/// Gaps below this look as if the curves were meant to meet, mm.
const SMALL_GAP: f64 = 0.05;

/// The words of `units`, and how long each is, mm.
const UNITS: [(&str, f64); 4] = [("mm", 1.0), ("cm", 10.0), ("m", 1000.0), ("inch", 25.4)];

/// The words of `order`.
const ORDERS: [&str; 2] = ["file", "chain"];

/// The files that a job names, each once.
pub fn named(source: &Source) -> Vec<String> {
    let mut names = Vec::new();
    // A job without files need not be read twice.
    if !source.text.contains("file") {
        return names;
    }
    let text = source.text.trim_start_matches('\u{feff}');
    let Ok(table) = DeTable::parse(text) else { return names };
    let Some(DeValue::Array(tables)) = table.get_ref().get("curve").map(Spanned::get_ref) else {
        return names;
    };
    for one in tables {
        if let DeValue::Table(table) = one.get_ref()
            && let Some(DeValue::String(name)) = table.get("file").map(Spanned::get_ref)
            && !names.iter().any(|known| known == name.as_ref())
        {
            names.push(name.to_string());
        }
    }
    names
}

impl<'s> Reader<'s> {
    /// The curves of the file that a table names.
    pub(super) fn file(&mut self, table: &Spanned<CurveTable>) -> Option<Vec<Shape>> {
        let range = table.span();
        let head = range.start..range.end.min(range.start + "[[curve]]".len());
        let table = table.get_ref();
        let name = table.file.as_ref()?;
        self.needless(table, "file");
        let unit = match &table.units {
            None => None,
            Some(word) => {
                let words = UNITS.map(|(word, _)| word);
                let word = self.word("units", word, &words)?;
                UNITS.iter().find(|(known, _)| *known == word).map(|(_, mm)| *mm)
            }
        };
        let chain = match &table.order {
            None => false,
            Some(word) => self.word("order", word, &ORDERS)? == "chain",
        };
        let must = "must be greater than zero and at most 1 mm";
        let join = table
            .join
            .as_ref()
            .map(|value| self.number("join", value, "join-range", must, |x| 0.0 < x && x <= 1.0));
        let stated = match &table.axes {
            None => None,
            Some(_) => Some(self.file_axes(table, head.clone())?),
        };
        let (source, found) = self.found(name, unit)?;
        let plane = found.iter().all(|curve| curve.path.height() <= PLANE);
        let axes = match stated {
            Some(axes) => axes,
            None => {
                ["X", "Y", "Z"][..if plane { 2 } else { 3 }].iter().filter_map(|n| Axis::new(n)).collect()
            }
        };
        if axes.len() == 2 && !plane {
            let message = format!("the curves of {} move in z too", name.get_ref());
            let place = table.axes.as_ref().map_or(head, Spanned::span);
            self.hinted("file-not-plane", message, place, "name three axes, for its x, y and z");
            return None;
        }
        let at = self.at(table, &axes);
        let tolerance = join.unwrap_or(0.0).max(MEET);
        let (runs, told) = ordered(found, chain, tolerance, source);
        for diagnostic in told {
            self.tell(diagnostic);
        }
        let mut shapes = Vec::new();
        for curve in runs.into_iter().flatten() {
            let path = if axes.len() == 2 { curve.path.flat() } else { curve.path };
            shapes.push(Shape {
                axes: axes.clone(),
                at: at.clone(),
                curve: own(path, axes.len()),
                span: curve.span,
                error: curve.error,
            });
        }
        Some(shapes)
    }

    /// Says something once, however often a file is named.
    fn tell(&mut self, diagnostic: Diagnostic) {
        if !self.diagnostics.0.contains(&diagnostic) {
            self.diagnostics.push(diagnostic);
        }
    }

    /// One of the words that a key may have.
    fn word(&mut self, key: &str, word: &Spanned<String>, words: &[&'static str]) -> Option<&'static str> {
        let found = words.iter().find(|known| *known == word.get_ref());
        if found.is_none() {
            let hint = match nearest(word.get_ref(), words.iter().copied()) {
                Some(meant) => format!("did you mean \"{meant}\"?"),
                None => format!("{key} is one of {}", words.join(", ")),
            };
            self.hinted(
                "word-unknown",
                format!("`{}` is no value of {key}", word.get_ref()),
                word.span(),
                hint,
            );
        }
        found.copied()
    }

    /// The axes that x, y and perhaps z of a file move.
    fn file_axes(&mut self, table: &CurveTable, head: Range<usize>) -> Option<Vec<Axis>> {
        let axes = self.own_axes(table, head)?;
        let names = table.axes.as_ref()?;
        if !(2..=3).contains(&axes.len()) || axes.iter().any(|axis| kind_of(*axis) != Kind::Linear) {
            let message = "a curve file has two or three linear axes, for its x, y and z";
            self.error("axes-range", message, names.span());
            return None;
        }
        Some(axes)
    }

    /// The curves of a file, and the file.
    fn found(&mut self, name: &Spanned<String>, unit: Option<f64>) -> Option<(&'s Source, Vec<FileCurve>)> {
        let Some(format) = curves::format_of(name.get_ref()) else {
            let known: Vec<String> =
                FORMATS.iter().map(|f| format!("{} (.{})", f.name, f.extensions.join(", ."))).collect();
            let message = format!("`{}` is no curve file that is read", name.get_ref());
            let hint = format!("read are {}", known.join(", "));
            self.hinted("file-kind", message, name.span(), hint);
            return None;
        };
        let sources = self.sources;
        let loaded = sources.named(name.get_ref()).unwrap_or(Err("it was not loaded"));
        let (id, source) = match loaded.map(|id| (id, sources.get(id))) {
            Ok((id, Some(source))) => (id, source),
            Ok((_, None)) => return None,
            Err(why) => {
                let message = format!("cannot read {}: {why}", name.get_ref());
                let hint = "a path starts where the job file stands";
                self.hinted("file-unreadable", message, name.span(), hint);
                return None;
            }
        };
        match curves::read(source, id, format, unit) {
            Err(errors) => {
                errors.0.into_iter().for_each(|error| self.tell(error));
                None
            }
            Ok(found) => {
                found.warnings.0.into_iter().for_each(|warning| self.tell(warning));
                if found.curves.is_empty() {
                    self.error("curve-missing", format!("{} has no curve", name.get_ref()), name.span());
                    return None;
                }
                Some((source, found.curves))
            }
        }
    }
}

/// The curves in their order, and what there is to say about it.
fn ordered(
    curves: Vec<FileCurve>,
    chain: bool,
    tolerance: f64,
    source: &Source,
) -> (Vec<order::Run>, Vec<Diagnostic>) {
    let mut told = Vec::new();
    let line = |curve: &FileCurve| LineColumn::of(&source.text, curve.span.start as usize).line;
    let put = |tolerance: f64| {
        if chain { order::chained(&curves, tolerance) } else { order::of_file(&curves, tolerance) }
    };
    let asked = put(tolerance);
    if let Some(branch) = asked.branch {
        let curve = &curves[branch];
        let message = format!(
            "more than two curves meet at an end of {}: the nearest goes on, and of equal ones the first in the file",
            curve.kind
        );
        told.push(Diagnostic::warning("curves-branch", message).at(curve.span, ""));
    }
    if 1 < asked.runs.len() {
        told.extend(apart(&curves, &asked, chain, tolerance, &put));
    }
    let spans: Vec<_> = curves.iter().map(|curve| (curve.kind, curve.span, line(curve))).collect();
    let joined = order::joined(curves, &asked, MEET);
    if let Some((kind, span, line)) = joined.backwards.iter().min().map(|first| spans[*first]) {
        let message = match joined.backwards.len() {
            1 => format!("{kind} of line {line} is run backwards, so that it meets its neighbour"),
            n => {
                format!("{n} curves are run backwards, so that they meet; {kind} of line {line} is the first")
            }
        };
        told.push(Diagnostic::note("curves-backwards", message).at(span, ""));
    }
    if let (1.., widest) = joined.bridges {
        let count = joined.bridges.0;
        let message = format!("{count} gaps of up to {widest:.2e} mm are closed by straight lines");
        told.push(match joined.runs.first().and_then(|run| run.first()) {
            Some(first) => Diagnostic::note("gaps-joined", message).at(first.span, ""),
            None => Diagnostic::note("gaps-joined", message),
        });
    }
    (joined.runs, told)
}

/// What to say where curves make several paths and might make fewer.
fn apart(
    curves: &[FileCurve],
    asked: &Order,
    chain: bool,
    tolerance: f64,
    put: &impl Fn(f64) -> Order,
) -> Option<Diagnostic> {
    let count = asked.runs.len();
    let chained = if chain { count } else { order::chained(curves, tolerance).runs.len() };
    let wide = tolerance.max(SMALL_GAP);
    let loose = if chain || count == chained { put(wide) } else { order::chained(curves, wide) };
    let closer = loose.runs.len() < chained;
    if count <= chained && !closer {
        return None;
    }
    let end = |(i, back): (usize, bool)| -> Point {
        let path = &curves[i].path;
        if back { path.start() } else { path.end() }
    };
    let start = |(i, back): (usize, bool)| end((i, !back));
    let (before, behind) = (asked.runs.first()?.last()?, asked.runs.get(1)?.first()?);
    let way = gap(&end(*before), &start(*behind));
    let order = if chain { "put end to end" } else { "in the order of the file" };
    let message = format!("{order}, these curves make {count} paths, and the tool retracts between them");
    let label = format!("starts {way:.6} mm from where the one before ends");
    let mut warning = Diagnostic::warning("curves-apart", message).at(curves[behind.0].span, label);
    if chained < count {
        let paths = if chained == 1 { "one path".to_owned() } else { format!("{chained} paths") };
        warning = warning.hint(format!("order = \"chain\" beside `file` puts them end to end: {paths}"));
    }
    if closer {
        let widest = loose
            .runs
            .iter()
            .flat_map(|run| run.windows(2))
            .map(|pair| gap(&end(pair[0]), &start(pair[1])))
            .fold(0.0, f64::max);
        warning = warning.hint(format!(
            "ends up to {widest:.2e} mm apart look as if they were meant to meet: join = {} closes such gaps by straight \
             lines",
            rounded_up(widest)
        ));
    }
    Some(warning)
}

/// The next of 1, 2 and 5 times a power of ten.
fn rounded_up(x: f64) -> f64 {
    let steps = [1e-5, 2e-5, 5e-5, 1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5];
    steps.into_iter().find(|step| x <= *step).unwrap_or(1.0)
}

/// A path in its own coordinates, `axes` of them.
fn own(path: Path, axes: usize) -> Own {
    let position = |p: &Point| -> Position {
        let mut position = [0.0; MAX_AXES];
        position[..axes].copy_from_slice(&p[..axes]);
        position
    };
    match path {
        Path::Lines(points, lines) => {
            let mut line = Polyline::new(position(&points[0]), axes);
            points[1..].iter().for_each(|point| line.push(&position(point)));
            if lines.len() == line.count() {
                line.lines = lines;
            }
            Own::Curve(Curve::Lines(line))
        }
        Path::Conic(conic) => Own::Conic(conic),
        Path::Pieces(pieces) => Own::Curve(Curve::Polynomial(pieces)),
        Path::Nurbs(nurbs) => Own::Curve(Curve::Nurbs(nurbs)),
    }
}
