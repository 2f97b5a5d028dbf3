//! What a program text does, by the manuals' formulas: a tolerant reader that evaluates as it goes.

use super::curve::Point;

/// Places looked at on each line, block or knot span.
const PLACES: u32 = 200;

const AXES: [&str; 4] = ["X", "Y", "Z", "A"];

/// One cutting path: what is cut between an approach and the next rapid.
#[derive(Clone, Debug, Default)]
pub(super) struct Path {
    /// Where the approach ends.
    pub(super) start: Point,
    /// The ends of lines and polynomial blocks, the end of a B-spline, the points of a spline through points.
    pub(super) ends: Vec<Point>,
    /// Places along it, in order; none on a spline through points.
    pub(super) places: Vec<Point>,
    /// F in force on these places, and how many there are by then.
    pub(super) feeds: Vec<(usize, f64)>,
    /// Blocks; of G06.2, control points.
    pub(super) blocks: usize,
    /// Where A follows the arc length: how far X, Y, Z stray from even motion along a knot span, mm.
    pub(super) straying: f64,
    /// The greatest distance in an axis of an SPL block's start from where the tool is.
    pub(super) gap: f64,
}

/// The cutting paths of a program.
pub(super) fn paths(dialect: &str, text: &str) -> Result<Vec<Path>, String> {
    let mut tool = Tool::default();
    match dialect {
        "sinumerik" => sinumerik(text, &mut tool)?,
        "heidenhain" => heidenhain(text, &mut tool)?,
        "mazak" => mazak(text, &mut tool)?,
        other => return Err(format!("no evaluator for {other}")),
    }
    tool.retract();
    Ok(tool.done)
}

/// Where the tool is and what it has cut.
#[derive(Default)]
struct Tool {
    at: [Option<f64>; 4],
    feed: f64,
    approached: bool,
    open: Option<Path>,
    done: Vec<Path>,
}

impl Tool {
    fn retract(&mut self) {
        self.done.extend(self.open.take());
        self.approached = false;
    }

    fn rapid(&mut self, target: &[Option<f64>; 4]) {
        self.retract();
        for (at, to) in self.at.iter_mut().zip(target) {
            *at = to.or(*at);
        }
    }

    /// The position; an axis that was never named rests at 0.
    fn position(&self) -> Point {
        self.at.map(Option::unwrap_or_default)
    }

    fn resolve(&self, target: &[Option<f64>; 4]) -> Point {
        std::array::from_fn(|i| target[i].unwrap_or(self.position()[i]))
    }

    fn path(&mut self) -> &mut Path {
        let start = self.position();
        self.open.get_or_insert_with(|| Path { start, ..Path::default() })
    }

    /// Ends `blocks` blocks at `end`.
    fn arrive(&mut self, end: Point, blocks: usize) {
        let feed = self.feed;
        let path = self.path();
        path.ends.push(end);
        path.feeds.push((path.places.len(), feed));
        path.blocks += blocks;
        self.at = end.map(Some);
    }

    /// A straight move at feed; the first one after a rapid is the approach.
    fn line(&mut self, target: &[Option<f64>; 4]) {
        let (from, to) = (self.position(), self.resolve(target));
        if !self.approached {
            self.approached = true;
            self.at = to.map(Some);
            return;
        }
        let places = shares().map(|t| std::array::from_fn(|i| from[i] + t * (to[i] - from[i])));
        self.path().places.extend(places);
        self.arrive(to, 1);
    }

    fn through(&mut self, target: &[Option<f64>; 4]) {
        let to = self.resolve(target);
        self.arrive(to, 1);
    }
}

/// 0 … 1.
fn shares() -> impl Iterator<Item = f64> {
    (0..=PLACES).map(|i| f64::from(i) / f64::from(PLACES))
}

fn number(text: &str) -> Result<f64, String> {
    text.parse().map_err(|_| format!("`{text}` is no number"))
}

/// The axis that an address names, or none; a rotary axis that no cutter moves is an error.
fn axis(address: &str) -> Result<Option<usize>, String> {
    if ["B", "C", "U", "V", "W"].contains(&address) {
        return Err(format!("axis {address} moves"));
    }
    Ok(AXES.iter().position(|name| *name == address))
}

// ---- Sinumerik ----

#[derive(Clone, Copy, PartialEq)]
enum Mode {
    None,
    Rapid,
    Line,
    Poly,
    Spline,
    Through,
}

/// The control points after the first, with PL and PW.
type SplineBlock = (Point, f64, f64);

fn sinumerik(text: &str, tool: &mut Tool) -> Result<(), String> {
    let mut mode = Mode::None;
    let mut upath = false;
    let mut spline: Vec<SplineBlock> = Vec::new();
    for line in text.lines() {
        let line = line.split(';').next().unwrap_or_default();
        let mut target = [None; 4];
        let mut coefficients: [Vec<f64>; 4] = Default::default();
        let (mut pl, mut pw) = (None, 1.0);
        let mut feed = None;
        let before = mode;
        for word in line.split_whitespace() {
            match word {
                "G0" => mode = Mode::Rapid,
                "G1" => mode = Mode::Line,
                "POLY" => mode = Mode::Poly,
                "BSPLINE" => mode = Mode::Spline,
                "ASPLINE" | "CSPLINE" => mode = Mode::Through,
                "UPATH" => upath = true,
                "SPATH" => upath = false,
                _ if word.contains('=') => {
                    let (address, value) = word.split_once('=').unwrap_or_default();
                    match address {
                        "PL" => pl = Some(number(value)?),
                        "PW" => pw = number(value)?,
                        "SD" if value == "3" => {}
                        _ => {
                            let name = address.strip_prefix("PO[").and_then(|rest| rest.strip_suffix(']'));
                            let list = value.strip_prefix('(').and_then(|rest| rest.strip_suffix(')'));
                            let (Some(name), Some(list)) = (name, list) else {
                                return Err(format!("`{word}`"));
                            };
                            let i = axis(name)?.ok_or_else(|| format!("`{word}`"))?;
                            let values = list.split(',').map(number).collect::<Result<Vec<f64>, String>>()?;
                            target[i] = values.first().copied();
                            coefficients[i] = values[1..].to_vec();
                        }
                    }
                }
                _ if word.contains('(') => {}
                _ => {
                    let digits = word.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(word.len());
                    if let Some(i) = axis(&word[..digits])? {
                        target[i] = Some(number(&word[digits..])?);
                    } else if &word[..digits] == "F" {
                        feed = Some(number(&word[digits..])?);
                    }
                }
            }
        }
        if before == Mode::Spline && mode != Mode::Spline {
            bspline(tool, &std::mem::take(&mut spline), upath)?;
        }
        // A new F is not that of the spline before; a spline begins with its word.
        if before == Mode::Spline && line.contains("BSPLINE") {
            bspline(tool, &std::mem::take(&mut spline), upath)?;
        }
        tool.feed = feed.unwrap_or(tool.feed);
        if target.iter().all(Option::is_none) {
            continue;
        }
        match mode {
            Mode::None => return Err(format!("no motion is on in `{line}`")),
            Mode::Rapid => tool.rapid(&target),
            Mode::Line => tool.line(&target),
            Mode::Through => tool.through(&target),
            Mode::Poly => poly(tool, &target, &coefficients, pl.unwrap_or(1.0), upath),
            Mode::Spline => {
                let pl = pl.ok_or_else(|| format!("no PL in `{line}`"))?;
                let from = spline.last().map_or(tool.position(), |block| block.0);
                spline.push((std::array::from_fn(|i| target[i].unwrap_or(from[i])), pl, pw));
            }
        }
    }
    if mode == Mode::Spline { bspline(tool, &spline, upath) } else { Ok(()) }
}

/// f(p) = a0 + a1 p + a2 p² + …, 0 ≤ p ≤ PL, with a0 the start and a1 = (xe − a0 − a2 PL² − …)/PL. Under SPATH A is
/// taken where the arc length of X, Y, Z is the same share of the whole as p is of PL.
fn poly(tool: &mut Tool, target: &[Option<f64>; 4], coefficients: &[Vec<f64>; 4], pl: f64, upath: bool) {
    let (start, end) = (tool.position(), tool.resolve(target));
    let value = |i: usize, p: f64| {
        let higher = |p: f64| coefficients[i].iter().rev().fold(0.0, |sum, a| (sum + a) * p) * p;
        let a1 = (end[i] - start[i] - higher(pl)) / pl;
        start[i] + a1 * p + higher(p)
    };
    let mut places: Vec<Point> =
        shares().map(|share| std::array::from_fn(|i| value(i, share * pl))).collect();
    if !upath {
        let mut way = vec![0.0];
        for pair in places.windows(2) {
            let step: f64 = (0..3).map(|i| (pair[1][i] - pair[0][i]).powi(2)).sum();
            way.push(way[way.len() - 1] + step.sqrt());
        }
        let whole = way[way.len() - 1];
        for (place, way) in places.iter_mut().zip(&way) {
            place[3] = value(3, pl * way / whole);
        }
    }
    tool.path().places.extend(places);
    tool.arrive(end, 1);
}

/// A cubic B-spline: t2 = 0, t(j+2) = t(j+1) + PLj, both ends fourfold; evaluated by de Boor's algorithm on points and
/// weights together.
fn bspline(tool: &mut Tool, blocks: &[SplineBlock], upath: bool) -> Result<(), String> {
    let (Some(first), Some(last)) = (blocks.first(), blocks.last()) else { return Ok(()) };
    if first.1 != 0.0 || last.1 != 0.0 {
        return Err("the first and the last PL of a BSPLINE must be 0".to_owned());
    }
    let start = tool.position();
    let mut points = vec![[start[0], start[1], start[2], start[3], 1.0]];
    let mut t = vec![0.0, 0.0, 0.0];
    for (point, pl, w) in blocks {
        points.push([point[0] * w, point[1] * w, point[2] * w, point[3] * w, *w]);
        t.push(t[t.len() - 1] + pl);
    }
    t.extend([t[t.len() - 1]; 2]);
    if t.len() != points.len() + 4 {
        return Err("a BSPLINE of too few blocks".to_owned());
    }
    let mut places = Vec::new();
    let mut straying = 0.0f64;
    for k in 3..points.len() {
        if t[k] == t[k + 1] {
            continue;
        }
        let place = |share: f64| -> Point {
            let u = t[k] + share * (t[k + 1] - t[k]);
            let mut d: Vec<[f64; 5]> = points[k - 3..=k].to_vec();
            for r in 1..=3 {
                for j in (r..=3).rev() {
                    let alpha = (u - t[j + k - 3]) / (t[j + 1 + k - r] - t[j + k - 3]);
                    d[j] = std::array::from_fn(|i| (1.0 - alpha) * d[j - 1][i] + alpha * d[j][i]);
                }
            }
            std::array::from_fn(|i| d[3][i] / d[3][4])
        };
        let (from, to) = (place(0.0), place(1.0));
        for share in shares() {
            let at = place(share);
            if !upath {
                let stray = |i: usize| at[i] - from[i] - share * (to[i] - from[i]);
                straying = straying.max((0..3).map(|i| stray(i).powi(2)).sum::<f64>().sqrt());
            }
            places.push(at);
        }
    }
    let path = tool.path();
    path.places.extend(places);
    path.straying = path.straying.max(straying);
    tool.arrive(last.0, blocks.len());
    Ok(())
}

// ---- Heidenhain ----

fn heidenhain(text: &str, tool: &mut Tool) -> Result<(), String> {
    let mut block = String::new();
    for line in text.lines() {
        let line = line.split(';').next().unwrap_or_default().trim();
        if let Some(part) = line.strip_suffix('~') {
            block.push_str(part);
            block.push(' ');
            continue;
        }
        block.push_str(line);
        let mut words: Vec<String> = Vec::new();
        for word in block.replace(',', ".").split_whitespace() {
            match words.last_mut() {
                // An exponent may stand apart.
                Some(mantissa) if word.starts_with('E') && word[1..].parse::<i32>().is_ok() => {
                    mantissa.push_str(word);
                }
                _ => words.push(word.to_owned()),
            }
        }
        block.clear();
        if words.first().is_some_and(|word| word.bytes().all(|b| b.is_ascii_digit())) {
            words.remove(0);
        }
        match words.first().map(String::as_str) {
            Some("L") => {
                let mut target = [None; 4];
                for word in &words[1..] {
                    if let Some(i) = axis(&word[..1])? {
                        target[i] = Some(number(&word[1..])?);
                    } else if word.starts_with('F') && word != "FMAX" {
                        tool.feed = number(&word[1..])?;
                    }
                }
                if words.iter().any(|word| word == "FMAX") { tool.rapid(&target) } else { tool.line(&target) }
            }
            Some("SPL") => spl(tool, &words[1..])?,
            _ => {}
        }
    }
    Ok(())
}

/// A(t) = K3 t³ + K2 t² + K1 t + A with t from 1 to 0.
fn spl(tool: &mut Tool, words: &[String]) -> Result<(), String> {
    let mut target = [None; 4];
    let mut k: [[Option<f64>; 4]; 4] = Default::default();
    for word in words {
        if let Some(rest) = word.strip_prefix('K') {
            let power = rest[..1].parse::<usize>().map_err(|_| word.clone())?;
            let i = axis(&rest[1..2])?.ok_or_else(|| word.clone())?;
            *k[i].get_mut(power).ok_or_else(|| word.clone())? = Some(number(&rest[2..])?);
        } else if let Some(i) = axis(&word[..1])? {
            target[i] = Some(number(&word[1..])?);
        } else if let Some(feed) = word.strip_prefix('F') {
            tool.feed = number(feed)?;
        } else if !word.starts_with('M') {
            return Err(format!("`{word}`"));
        }
    }
    let (start, end) = (tool.position(), tool.resolve(&target));
    let mut gap = 0.0f64;
    for i in 0..4 {
        match (target[i], k[i]) {
            (Some(_), [None, Some(k1), Some(k2), Some(k3)]) => {
                gap = gap.max((end[i] + k1 + k2 + k3 - start[i]).abs());
            }
            (None, [None, None, None, None]) => {}
            (None, [None, Some(k1), Some(k2), Some(k3)]) if k1 == 0.0 && k2 == 0.0 && k3 == 0.0 => {}
            _ => return Err(format!("{} has not all of its end, K1, K2, K3", AXES[i])),
        }
    }
    if 0.001 < gap {
        return Err(format!("an SPL block starts {gap} from the tool; the control takes 0.001"));
    }
    let path = tool.path();
    path.gap = path.gap.max(gap);
    path.places.extend(shares().map(|share| -> Point {
        let t = 1.0 - share;
        std::array::from_fn(|i| {
            let [_, k1, k2, k3] = k[i].map(Option::unwrap_or_default);
            k3 * t * t * t + k2 * t * t + k1 * t + end[i]
        })
    }));
    tool.arrive(end, 1);
    Ok(())
}

// ---- Mazak ----

/// A G06.2 curve as it is read.
#[derive(Default)]
struct Nurbs {
    order: usize,
    knots: Vec<f64>,
    points: Vec<(Point, f64)>,
}

fn mazak(text: &str, tool: &mut Tool) -> Result<(), String> {
    let mut mode = Mode::None;
    let mut nurbs = Nurbs::default();
    for line in text.lines() {
        let line = line.split('(').next().unwrap_or_default().trim();
        let mut target = [None; 4];
        let (mut knot, mut weight) = (None, 1.0);
        let mut feed = None;
        let before = mode;
        let mut rest = line.trim_start_matches('%');
        while !rest.is_empty() {
            let (address, tail) = rest.split_at(1);
            let tail = tail.trim_start();
            let length =
                tail.find(|c: char| !(c.is_ascii_digit() || "+-.".contains(c))).unwrap_or(tail.len());
            let (value, tail) = (number(&tail[..length])?, &tail[length..]);
            rest = tail.trim_start();
            match address {
                "G" if value == 0.0 => mode = Mode::Rapid,
                "G" if value == 1.0 => mode = Mode::Line,
                "G" if value == 6.1 => mode = Mode::Through,
                "G" if value == 6.2 => {
                    mode = Mode::Spline;
                    g06_2(tool, &std::mem::take(&mut nurbs))?;
                    nurbs.order = 4;
                }
                "P" if mode == Mode::Spline => nurbs.order = value as usize,
                "K" => knot = Some(value),
                "R" => weight = value,
                "F" => feed = Some(value),
                _ => {
                    if let Some(i) = axis(address)? {
                        target[i] = Some(value);
                    }
                }
            }
        }
        if before == Mode::Spline && mode != Mode::Spline {
            g06_2(tool, &std::mem::take(&mut nurbs))?;
        }
        tool.feed = feed.unwrap_or(tool.feed);
        let moves = target.iter().any(Option::is_some);
        match mode {
            Mode::None | Mode::Poly => {}
            Mode::Rapid if moves => tool.rapid(&target),
            Mode::Line if moves => tool.line(&target),
            Mode::Through if moves => tool.through(&target),
            Mode::Rapid | Mode::Line | Mode::Through => {}
            Mode::Spline => {
                let Some(knot) = knot else { return Err(format!("no K in `{line}`")) };
                nurbs.knots.push(knot);
                if moves {
                    let from = nurbs.points.last().map_or(tool.position(), |point| point.0);
                    nurbs.points.push((std::array::from_fn(|i| target[i].unwrap_or(from[i])), weight));
                    if nurbs.knots.len() != nurbs.points.len() {
                        return Err("a control point after a single K".to_owned());
                    }
                }
            }
        }
    }
    g06_2(tool, &nurbs)
}

/// N(i,1) = 1 on the span from ki to k(i+1), and otherwise
/// N(i,k) = (t − ki) N(i,k−1)/(k(i+k−1) − ki) + (k(i+k) − t) N(i+1,k−1)/(k(i+k) − k(i+1)), with 0/0 = 0.
fn basis(knots: &[f64], i: usize, order: usize, span: usize, t: f64) -> f64 {
    if order == 1 {
        return if i == span { 1.0 } else { 0.0 };
    }
    let part = |numerator: f64, width: f64, i: usize| {
        if width == 0.0 { 0.0 } else { numerator / width * basis(knots, i, order - 1, span, t) }
    };
    part(t - knots[i], knots[i + order - 1] - knots[i], i)
        + part(knots[i + order] - t, knots[i + order] - knots[i + 1], i + 1)
}

/// P(t) = Σ N(i,p)(t) wi Pi / Σ N(i,p)(t) wi for k(p−1) ≤ t ≤ k(n+1).
fn g06_2(tool: &mut Tool, nurbs: &Nurbs) -> Result<(), String> {
    let Nurbs { order, knots, points } = nurbs;
    let (Some((first, _)), Some((last, _))) = (points.first(), points.last()) else { return Ok(()) };
    let (p, n) = (*order, points.len());
    let same = |knots: &[f64]| knots.iter().all(|k| *k == knots[0]);
    if knots.len() != n + p || n < p || !same(&knots[..p]) || !same(&knots[n..]) || !knots.is_sorted() {
        return Err(format!("{n} control points of order {p} with the knots {knots:?}"));
    }
    if tool.position().iter().zip(first).any(|(at, to)| at != to) {
        return Err("the first control point is not where the tool is".to_owned());
    }
    let mut places = Vec::new();
    for span in p - 1..n {
        if knots[span] == knots[span + 1] {
            continue;
        }
        for share in shares() {
            let t = knots[span] + share * (knots[span + 1] - knots[span]);
            let mut sum = [0.0; 5];
            for i in span + 1 - p..=span {
                let (point, weight) = &points[i];
                let share = basis(knots, i, p, span, t) * weight;
                for axis in 0..4 {
                    sum[axis] += share * point[axis];
                }
                sum[4] += share;
            }
            places.push(std::array::from_fn(|i| sum[i] / sum[4]));
        }
    }
    tool.path().places.extend(places);
    tool.arrive(*last, n);
    Ok(())
}
