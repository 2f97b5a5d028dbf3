//! The three NURBS forms of CL data become one curve each.
//!
//! | | first point | knots | weights |
//! |---|---|---|---|
//! | CATIA `BEGIN NURBS_SIEMENS` | N0, written | increments DK | W |
//! | NX `NURBS/` | the position, not written | inner ones and the final 1.0 | none |
//! | Creo `MOVNRB` | in the list | all | none |
//!
//! With points N0 … Nn the knots of CATIA are, for a cubic,
//!
//! ```text
//! t_0 = t_1 = 0     t_{i+2} = DK_0 + … + DK_i     t_{n+4} = t_{n+3} = t_{n+2}
//! ```
//!
//! and those of NX 0 four times, the values listed but for the last, and that four times. Only ratios of knots count, so
//! those of NX and Creo are scaled to the length of the control polygon, in mm, as those of CATIA are.

use super::directions::Second;
use super::program::joined;
use super::reader::{Reader, Said};
use super::statement::{Argument, Placed};
use super::technology::Feed;
use super::words::Meaning;
use crate::diagnostic::Diagnostic;
use crate::geom::nurbs::Nurbs;
use crate::source::Span;
use crate::units::Position;

/// The most control points of one spline.
const MAX_POINTS: usize = 1_000_000;

/// How far a spline may start from where the tool is, mm.
const START_SLACK: f64 = 0.001;

/// A spline in reading.
#[derive(Clone, Debug)]
pub(super) enum Spline {
    /// CATIA.
    Siemens(Siemens),
    /// NX.
    Nx(Nx),
    /// Creo.
    Creo(Creo),
    /// One that was refused: what belongs to it is passed over, since one report is enough.
    Refused,
}

/// A spline of CATIA.
#[derive(Clone, Debug)]
pub(super) struct Siemens {
    feed: f64,
    /// LENGTH, mm, of AXIS=VAR.
    length: Option<f64>,
    points: Vec<[f64; 3]>,
    /// XH YH ZH less XT YT ZT, where LENGTH is stated.
    directions: Vec<[f64; 3]>,
    increments: Vec<f64>,
    weights: Vec<f64>,
    span: Span,
}

/// A spline of NX.
#[derive(Clone, Debug)]
pub(super) struct Nx {
    knots: Vec<f64>,
    points: Vec<[f64; 3]>,
    span: Span,
}

/// A spline of Creo.
#[derive(Clone, Debug)]
pub(super) struct Creo {
    order: usize,
    knot_count: usize,
    point_count: usize,
    knots: Vec<f64>,
    numbers: Vec<f64>,
    /// Points of the upper curve.
    upper: Vec<f64>,
    span: Span,
}

/// The value of `NAME=`.
fn assigned(arguments: &[Placed<'_>], name: &str) -> Option<f64> {
    arguments.iter().find_map(|placed| placed.argument.assigned(name))
}

/// The digits of `N12`, a point of CATIA's.
fn point_number(major: &str) -> Option<&str> {
    let digits = major.strip_prefix(['N', 'n'])?;
    (!digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit())).then_some(digits)
}

/// Whether a spline of CATIA's ends: `END NURBS`.
fn is_end(major: &str) -> bool {
    let mut words = major.split_ascii_whitespace();
    let mut next = |word: &str| words.next().is_some_and(|known| known.eq_ignore_ascii_case(word));
    next("END") && next("NURBS") && words.next().is_none()
}

impl Reader<'_> {
    /// Meets a statement where a spline is read; whether it was part of it.
    pub(super) fn in_spline(&mut self, said: &Said<'_>) -> bool {
        match &mut self.spline {
            None => false,
            Some(Spline::Refused) => {
                let (major, numbered) = (said.statement.major, point_number(said.statement.major));
                let ends = is_end(major);
                let meaning = self.words.meaning(major);
                if ends
                    || !(numbered.is_some()
                        || matches!(meaning, Some(Meaning::Knot | Meaning::Cntrl | Meaning::Movnrb)))
                {
                    self.spline = None;
                }
                ends || self.spline.is_some()
            }
            Some(Spline::Siemens(_)) => {
                let major = said.statement.major;
                if let Some(digits) = point_number(major) {
                    self.siemens_point(said, digits);
                    return true;
                }
                if is_end(major) {
                    self.end_spline();
                    return true;
                }
                self.spline = None;
                self.error("nurbs-unfinished", "a spline ends without END NURBS", said.span);
                false
            }
            Some(Spline::Nx(nx)) => {
                let points = nx.points.len();
                match (self.words.meaning(said.statement.major), said.statement.numbers()) {
                    (Some(Meaning::Knot), Some(knots)) if points == 0 => {
                        nx.knots.extend(knots);
                        nx.span.end = said.span.end;
                    }
                    (Some(Meaning::Cntrl), Some(numbers)) if numbers.len() == 3 && points < MAX_POINTS => {
                        let scale = self.scale;
                        nx.points.push([numbers[0] * scale, numbers[1] * scale, numbers[2] * scale]);
                        nx.span.end = said.span.end;
                    }
                    (Some(Meaning::Cntrl), Some(numbers)) if numbers.len() == 6 => {
                        self.spline = Some(Spline::Refused);
                        let message =
                            "NURBS of five axes are not compiled: no public file shows how they are written";
                        self.refuse("tool-axis-tilted", message, said.span);
                    }
                    (Some(Meaning::Knot | Meaning::Cntrl), _) => {
                        self.spline = Some(Spline::Refused);
                        let message = "KNOT has numbers and stands before CNTRL, which has three";
                        self.error("nurbs-order", message, said.span);
                    }
                    _ => {
                        self.end_spline();
                        return false;
                    }
                }
                true
            }
            Some(Spline::Creo(_)) => {
                if self.words.meaning(said.statement.major) == Some(Meaning::Movnrb) {
                    return false;
                }
                let message =
                    format!("{} stands inside of MOVNRB, which is not compiled", said.statement.major);
                self.refuse("movnrb-inside", message, said.word_place());
                true
            }
        }
    }

    /// `BEGIN NURBS_SIEMENS(D=3,F=1000,AXIS=0.00,0.00,1.00);`
    pub(super) fn nurbs_siemens(&mut self, said: &Said<'_>) {
        self.spline = Some(self.siemens_header(said).map_or(Spline::Refused, Spline::Siemens));
    }

    fn siemens_header(&mut self, said: &Said<'_>) -> Option<Siemens> {
        let [Placed { argument: Argument::Group(header), .. }] = said.arguments() else {
            self.error("nurbs-header", "BEGIN NURBS_SIEMENS has D, F and AXIS in parentheses", said.span);
            return None;
        };
        let header = &header.arguments;
        let (Some(degree), Some(feed)) = (assigned(header, "D"), assigned(header, "F")) else {
            self.error("nurbs-header", "BEGIN NURBS_SIEMENS states no D or no F", said.span);
            return None;
        };
        if degree != 3.0 {
            let message = format!("D={degree}: knots of other degrees than 3 are not known");
            self.refuse("nurbs-degree", message, said.span);
            return None;
        }
        if !(0.0 < feed && feed.is_finite()) {
            self.error("feed-range", "F must be greater than zero", said.span);
            return None;
        }
        if matches!(self.feed, Some(Feed::PerRevolution(_))) {
            let message =
                "whether F counts a minute or a revolution where FEDRAT counts revolutions is not known";
            self.refuse("nurbs-revolutions", message, said.span);
            return None;
        }
        if self.scale != 1.0 {
            let message = "whether F counts inches in a file of inches is not known";
            self.refuse("nurbs-inches", message, said.span);
            return None;
        }
        let axis = header.iter().position(|placed| match placed.argument {
            Argument::Assigned(name, _) => name.eq_ignore_ascii_case("AXIS"),
            Argument::AssignedWord(name, word) => {
                name.eq_ignore_ascii_case("AXIS") && word.eq_ignore_ascii_case("VAR")
            }
            Argument::Empty
            | Argument::Number(_)
            | Argument::Word(_)
            | Argument::Quoted(_)
            | Argument::Group(_) => false,
        });
        let stated = assigned(header, "LENGTH").filter(|length| 0.0 < *length && length.is_finite());
        let mut length = None;
        match axis.map(|at| &header[at..]) {
            Some(
                [
                    Placed { argument: Argument::Assigned(_, i), .. },
                    Placed { argument: Argument::Number(j), .. },
                    Placed { argument: Argument::Number(k), .. },
                ],
            ) => {
                if !self.keeps_axis([*i, *j, *k], said.span) {
                    return None;
                }
            }
            Some([Placed { argument: Argument::AssignedWord(..), .. }, ..]) if stated.is_some() => {
                length = stated;
            }
            Some(_) | None => {
                let message = "AXIS is three numbers, or VAR with a LENGTH greater than zero behind it";
                self.error("nurbs-header", message, said.span);
                return None;
            }
        }
        Some(Siemens {
            feed,
            length,
            points: Vec::new(),
            directions: Vec::new(),
            increments: Vec::new(),
            weights: Vec::new(),
            span: said.span,
        })
    }

    /// `N1,XT=10.0,YT=0.0,ZT=0.0,DK=0.0,W=1.0;`
    fn siemens_point(&mut self, said: &Said<'_>, index: &str) {
        let value = |name: &str| assigned(said.arguments(), name);
        let all = (value("XT"), value("YT"), value("ZT"), value("DK"), value("W"));
        let second = (value("XH"), value("YH"), value("ZH"));
        let Some(Spline::Siemens(spline)) = &mut self.spline else { return };
        let expected = spline.points.len();
        let (Some(x), Some(y), Some(z), Some(dk), Some(w)) = all else {
            self.spline = Some(Spline::Refused);
            return self.error("nurbs-point", "a point has XT, YT, ZT, DK and W", said.span);
        };
        if index.parse() != Ok(expected) {
            self.spline = Some(Spline::Refused);
            return self.error("nurbs-point", format!("here point N{expected} was expected"), said.span);
        }
        if !(0.0 <= dk) {
            self.spline = Some(Spline::Refused);
            return self.error("knots-decrease", "DK is an increment and cannot be negative", said.span);
        }
        if !(0.0 < w && w.is_finite()) {
            self.spline = Some(Spline::Refused);
            return self.error("weight-range", "W must be greater than zero", said.span);
        }
        if MAX_POINTS <= expected {
            self.spline = Some(Spline::Refused);
            return self.error("nurbs-point", "the spline has too many points", said.span);
        }
        match (second, spline.length) {
            ((Some(xh), Some(yh), Some(zh)), Some(_)) => spline.directions.push([xh - x, yh - y, zh - z]),
            ((None, None, None), None) => {}
            _ => {
                self.spline = Some(Spline::Refused);
                let message = "XH, YH and ZH stand in every point under AXIS=VAR, and in none otherwise";
                return self.error("nurbs-point", message, said.span);
            }
        }
        spline.points.push([x, y, z]);
        spline.increments.push(dk);
        spline.weights.push(w);
        spline.span.end = said.span.end;
    }

    /// `NURBS/`
    pub(super) fn nurbs(&mut self, said: &Said<'_>) {
        if !said.arguments().is_empty() {
            return self.error("nurbs-header", "NURBS/ stands alone in its line", said.span);
        }
        self.spline = Some(Spline::Nx(Nx { knots: Vec::new(), points: Vec::new(), span: said.span }));
    }

    /// `MOVNRB / …`
    pub(super) fn movnrb(&mut self, said: &Said<'_>) {
        let arguments = said.arguments();
        let first = arguments.first().map(|placed| placed.argument.clone());
        let numbers: Vec<f64> =
            arguments.iter().skip(1).filter_map(|placed| placed.argument.number()).collect();
        match (first, &mut self.spline) {
            (Some(Argument::Word(word)), None) if word.eq_ignore_ascii_case("M3AXIS") => {
                self.second_point = None;
            }
            (Some(Argument::Word(word)), None) if word.eq_ignore_ascii_case("5AXIS") => {
                let length = arguments
                    .windows(2)
                    .find(|pair| {
                        pair[0].argument.word().is_some_and(|word| word.eq_ignore_ascii_case("LENGTH"))
                    })
                    .and_then(|pair| pair[1].argument.number())
                    .filter(|length| 0.0 < *length && length.is_finite());
                if length.is_none() {
                    let message = "MOVNRB/5AXIS states the LENGTH from the tip to the upper curve";
                    self.error("nurbs-header", message, said.span);
                }
                self.second_point = length.map(|length| length * self.scale);
            }
            (Some(Argument::Word(word)), None) if word.eq_ignore_ascii_case("ON") => {
                let count = |x: f64| {
                    (x.fract() == 0.0 && (0.0..=MAX_POINTS as f64).contains(&x)).then_some(x as usize)
                };
                let [order, knots, weights, points, _length] = numbers[..] else {
                    let message = "MOVNRB/ON has order, knots, weights, points and a length";
                    return self.error("nurbs-header", message, said.span);
                };
                let (Some(order), Some(knots), Some(points)) = (count(order), count(knots), count(points))
                else {
                    return self.error("nurbs-header", "MOVNRB/ON counts in whole numbers", said.span);
                };
                if weights != 0.0 {
                    let message = "MOVNRB with weights is not compiled: how they are written is not known";
                    return self.refuse("nurbs-weights", message, said.span);
                }
                self.spline = Some(Spline::Creo(Creo {
                    order,
                    knot_count: knots,
                    point_count: points,
                    knots: Vec::new(),
                    numbers: Vec::new(),
                    upper: Vec::new(),
                    span: said.span,
                }));
            }
            (Some(Argument::Number(part)), Some(Spline::Creo(creo))) if [1.0, 2.0, 3.0].contains(&part) => {
                let list = match part {
                    1.0 => &mut creo.knots,
                    2.0 => &mut creo.numbers,
                    _ => &mut creo.upper,
                };
                if 4 * MAX_POINTS < list.len() + numbers.len() {
                    self.spline = None;
                    return self.error("nurbs-point", "the spline has too many points", said.span);
                }
                list.extend(numbers);
                creo.span.end = said.span.end;
            }
            (Some(Argument::Word(word)), Some(Spline::Creo(_)))
                if word.eq_ignore_ascii_case("NEXT") || word.eq_ignore_ascii_case("OFF") =>
            {
                self.end_spline();
            }
            (Some(Argument::Word(word)), None) if word.eq_ignore_ascii_case("OFF") => {}
            _ => self.error("nurbs-order", "this MOVNRB does not stand where it can be read", said.span),
        }
    }

    /// Ends a spline: it becomes a curve.
    pub(super) fn end_spline(&mut self) {
        match self.spline.take() {
            None | Some(Spline::Refused) => {}
            Some(Spline::Siemens(siemens)) => self.end_siemens(siemens),
            Some(Spline::Nx(nx)) => self.end_nx(nx),
            Some(Spline::Creo(creo)) => self.end_creo(creo),
        }
    }

    fn end_siemens(&mut self, siemens: Siemens) {
        let Siemens { feed, length, points, directions, increments, weights, span } = siemens;
        let mut knots = vec![0.0, 0.0];
        let mut t = 0.0;
        for increment in increments {
            t += increment;
            knots.push(t);
        }
        knots.extend([t, t]);
        let second = length.map(|length| Second { directions, length });
        self.curve(3, knots, &points, second, weights, feed, span);
    }

    fn end_nx(&mut self, nx: Nx) {
        let Nx { knots, mut points, span } = nx;
        if points.len() != knots.len() + 2 {
            let message = format!(
                "{} values of KNOT need {} of CNTRL, not {}",
                knots.len(),
                knots.len() + 2,
                points.len()
            );
            return self.error("nurbs-counts", message, span);
        }
        let Some(start) = self.program.position else {
            return self.error("start-unknown", "a spline from a place that is not known", span);
        };
        points.insert(0, start);
        let last = knots.last().copied().unwrap_or(1.0);
        let mut all = vec![0.0; 4];
        all.extend(&knots[..knots.len().saturating_sub(1)]);
        all.extend([last; 4]);
        self.with_feed(3, all, &points, None, span);
    }

    fn end_creo(&mut self, creo: Creo) {
        let Creo { order, knot_count, point_count, knots, numbers, upper, span } = creo;
        let wanted = if self.second_point.is_some() { 3 * point_count } else { 0 };
        if upper.len() != wanted {
            let message = format!("{wanted} numbers of the upper curve belong here, {} follow", upper.len());
            return self.error("nurbs-counts", message, span);
        }
        if knots.len() != knot_count || numbers.len() != 3 * point_count || order < 2 {
            let message = format!(
                "{knot_count} knots and {point_count} points were announced, {} and {} numbers follow",
                knots.len(),
                numbers.len()
            );
            return self.error("nurbs-counts", message, span);
        }
        let scale = self.scale;
        let points: Vec<[f64; 3]> =
            numbers.chunks_exact(3).map(|p| [p[0] * scale, p[1] * scale, p[2] * scale]).collect();
        let along = upper.chunks_exact(3).zip(&points);
        let directions =
            along.map(|(h, p)| [h[0] * scale - p[0], h[1] * scale - p[1], h[2] * scale - p[2]]).collect();
        let second = self.second_point.map(|length| Second { directions, length });
        let first = knots.first().copied().unwrap_or(0.0);
        self.with_feed(order - 1, knots.iter().map(|t| t - first).collect(), &points, second, span);
    }

    /// A spline at the feed in force, its knots scaled to the length of its polygon.
    fn with_feed(
        &mut self,
        degree: usize,
        mut knots: Vec<f64>,
        points: &[[f64; 3]],
        second: Option<Second>,
        span: Span,
    ) {
        let feed = self.feed;
        let Some(feed) = self.per_minute(feed, span) else { return };
        let size =
            |p: &[f64; 3], q: &[f64; 3]| (0..3).map(|i| (q[i] - p[i]) * (q[i] - p[i])).sum::<f64>().sqrt();
        let length: f64 = points.windows(2).map(|pair| size(&pair[0], &pair[1])).sum();
        let last = knots.last().copied().unwrap_or(0.0);
        let scale = length / last;
        if 0.0 < scale && scale.is_finite() {
            for t in &mut knots {
                *t *= scale;
            }
        }
        let weights = vec![1.0; points.len()];
        self.curve(degree, knots, points, second, weights, feed, span);
    }

    #[allow(clippy::too_many_arguments, reason = "they are what a spline is made of")]
    fn curve(
        &mut self,
        degree: usize,
        knots: Vec<f64>,
        points: &[[f64; 3]],
        second: Option<Second>,
        weights: Vec<f64>,
        feed: f64,
        span: Span,
    ) {
        if std::mem::take(&mut self.rapid) {
            return self.refuse("rapid-arc", "a spline at rapid is not compiled", span);
        }
        self.pending = None;
        let all: Vec<Position> = match &second {
            None => points.iter().map(|point| self.program.place(point)).collect(),
            Some(second) => {
                points.iter().zip(&second.directions).map(|(tip, along)| joined(tip, along)).collect()
            }
        };
        let nurbs = match Nurbs::new(degree, knots, all, weights) {
            Ok(nurbs) => nurbs,
            Err(error) => return self.error("nurbs", error.to_string(), span),
        };
        let Some(tool) = self.program.position.filter(|_| self.program.has_moved()) else {
            return self.error("start-unknown", "a spline from a place that no move went to", span);
        };
        let start = points[0];
        let gap = (0..3).map(|i| (start[i] - tool[i]) * (start[i] - tool[i])).sum::<f64>().sqrt();
        if START_SLACK < gap {
            let message = format!("the spline starts {gap:.4} mm from where the tool is");
            return self.push(Diagnostic::error("spline-start", message).at(span, ""));
        }
        if second.is_none() && self.program.stood() != self.program.axis() {
            return self.error(
                "spline-axis",
                "the tool turns where this spline starts: no move turned it",
                span,
            );
        }
        self.meets(&nurbs, span);
        if let Some(second) = second {
            self.second_curve(&nurbs, second.length, span);
        }
        self.program.spline(nurbs, feed, span);
    }
}
