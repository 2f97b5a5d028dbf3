//! Curves of a program, exactly as its text says, by the manuals' formulas.

use super::rational::{Poly, Q, Span, decimal, q, spans};
use num_traits::{One, Zero};
use std::collections::BTreeMap;

/// A number as printed.
pub(super) type Printed = String;

/// One POLY block: for each axis its end and coefficients, and the denominator's, as printed.
#[derive(Clone, Debug, Default)]
pub(super) struct Block {
    pub(super) axes: BTreeMap<char, Vec<Printed>>,
    pub(super) denominator: Option<Vec<Printed>>,
}

/// A B-spline as printed.
#[derive(Clone, Debug, Default)]
pub(super) struct Spline {
    pub(super) degree: usize,
    pub(super) knots: Vec<Q>,
    pub(super) points: Vec<Vec<Q>>,
    pub(super) weights: Vec<Q>,
}

/// What the paths of a program are, spans in order.
#[derive(Clone, Debug, Default)]
pub(super) struct Paths {
    pub(super) spans: Vec<Span>,
    pub(super) blocks: Vec<Block>,
    pub(super) splines: Vec<Spline>,
}

fn number(text: &str) -> Q {
    decimal(text).unwrap_or_else(|| panic!("`{text}` is no number"))
}

/// The paths of a program; `axes` in the order of the coordinates.
pub(super) fn paths(dialect: &str, text: &str, axes: &str) -> Paths {
    match dialect {
        "sinumerik" => sinumerik(text, axes),
        "heidenhain" => heidenhain(text, axes),
        _ => mazak(text, axes),
    }
}

/// Where the tool is.
struct Tool<'a> {
    axes: &'a str,
    at: Vec<Q>,
}

impl Tool<'_> {
    fn index(&self, axis: char) -> Option<usize> {
        self.axes.chars().position(|own| own == axis)
    }

    /// Takes the words of axes.
    fn words<'w>(&mut self, words: impl Iterator<Item = &'w str>) {
        for word in words {
            let (name, value) = word.split_at(1);
            if let (Some(i), Some(value)) = (name.chars().next().and_then(|c| self.index(c)), decimal(value))
            {
                self.at[i] = value;
            }
        }
    }
}

/// a₀ + a₁s + a₂s² … with this start, this value at 1 and these a₂ ….
fn closed(start: &Q, end: &Q, rest: &[Q]) -> Poly {
    let linear = rest.iter().fold(end - start, |sum, a| sum - a);
    let mut all = vec![start.clone(), linear];
    all.extend(rest.iter().cloned());
    Poly(all)
}

fn sinumerik(text: &str, axes: &str) -> Paths {
    let mut paths = Paths::default();
    let mut tool = Tool { axes, at: vec![Q::zero(); axes.len()] };
    let mut mode = "";
    let (mut pl, mut spline) = (Vec::new(), Spline::default());
    for line in text.lines().skip_while(|line| !line.starts_with("; CURVE")) {
        let words: Vec<&str> =
            line.split(' ').filter(|w| !w.starts_with('N') && !w.starts_with(';')).collect();
        let first = words.first().copied().unwrap_or_default();
        let was = mode;
        for word in ["G0", "G1", "POLY", "BSPLINE"] {
            if words.contains(&word) {
                mode = word;
            }
        }
        if was == "BSPLINE" && (mode != was || first == "BSPLINE") {
            end_of_bspline(&mut paths, std::mem::take(&mut spline), &std::mem::take(&mut pl));
        }
        let moves = words
            .iter()
            .any(|w| w.starts_with("PO[") || tool.index(w.chars().next().unwrap_or(' ')).is_some());
        match mode {
            "POLY" if moves => {
                let mut block = Block::default();
                for word in &words {
                    if let Some((name, list)) = word.strip_prefix("PO[").and_then(|w| w.split_once("]=(")) {
                        let list: Vec<Printed> =
                            list.trim_end_matches(')').split(',').map(str::to_owned).collect();
                        match name.chars().next() {
                            Some(axis) => drop(block.axes.insert(axis, list)),
                            None => block.denominator = Some(list),
                        }
                    } else if let Some(axis) = word.chars().next().filter(|c| tool.index(*c).is_some()) {
                        block.axes.insert(axis, vec![word[1..].to_owned()]);
                    }
                }
                assert!(words.contains(&"PL=1"), "{line}");
                paths.spans.push(poly_span(&tool, &block));
                for (axis, list) in &block.axes {
                    let i = tool.index(*axis).expect("an axis");
                    tool.at[i] = number(&list[0]);
                }
                paths.blocks.push(block);
            }
            "BSPLINE" if moves => {
                if spline.points.is_empty() {
                    spline.points.push(tool.at.clone());
                    spline.weights.push(Q::one());
                }
                tool.words(words.iter().copied());
                spline.points.push(tool.at.clone());
                let of = |key: &str| words.iter().find_map(|w| w.strip_prefix(key));
                spline.weights.push(of("PW=").map_or_else(Q::one, number));
                pl.push(number(of("PL=").expect("PL on every block")));
            }
            _ => tool.words(words.iter().copied()),
        }
    }
    paths
}

/// One POLY block from where the tool is.
fn poly_span(tool: &Tool<'_>, block: &Block) -> Span {
    let rest = |list: &[Printed]| list[1..].iter().map(|x| number(x)).collect::<Vec<Q>>();
    let below = block.denominator.as_ref();
    let denominator = below.map_or(Poly(vec![Q::one()]), |d| closed(&Q::one(), &number(&d[0]), &rest(d)));
    let end_below = denominator.at(&Q::one());
    let numerators = tool.axes.chars().enumerate().map(|(i, axis)| match block.axes.get(&axis) {
        Some(list) => closed(&tool.at[i], &(number(&list[0]) * &end_below), &rest(list)),
        // An axis that is not named rests.
        None => denominator.scaled(&tool.at[i]),
    });
    Span { numerators: numerators.collect(), denominator: denominator.clone() }
}

/// t[j+2] = t[j+1] + PL_j; the ends are four-fold.
fn end_of_bspline(paths: &mut Paths, mut spline: Spline, pl: &[Q]) {
    let mut knots = vec![Q::zero(); 3];
    for distance in pl {
        knots.push(&knots[knots.len() - 1] + distance);
    }
    let last = knots[knots.len() - 1].clone();
    while knots.len() < spline.points.len() + 4 {
        knots.push(last.clone());
    }
    spline.degree = 3;
    spline.knots = knots;
    paths.spans.extend(spans(3, &spline.knots, &spline.points, &spline.weights));
    paths.splines.push(spline);
}

fn mazak(text: &str, axes: &str) -> Paths {
    let mut paths = Paths::default();
    let mut tool = Tool { axes, at: vec![Q::zero(); axes.len()] };
    let mut spline: Option<Spline> = None;
    let lines = text.lines().skip_while(|line| !line.starts_with("(CURVE"));
    for line in lines.chain(["G0"]) {
        let words: Vec<&str> = line.split(' ').collect();
        let of = |key: char| words.iter().find_map(|w| w.strip_prefix(key)).and_then(decimal);
        if line.starts_with('G') {
            if let Some(done) = spline.take() {
                paths.spans.extend(spans(done.degree, &done.knots, &done.points, &done.weights));
                paths.splines.push(done);
            }
            if line.starts_with("G06.2") {
                let order = of('P').and_then(|p| p.to_integer().try_into().ok()).unwrap_or(4usize);
                spline = Some(Spline { degree: order - 1, ..Spline::default() });
            }
        }
        tool.words(words.iter().copied());
        if let (Some(spline), Some(knot)) = (&mut spline, of('K')) {
            spline.knots.push(knot);
            if 1 < words.len() {
                spline.points.push(tool.at.clone());
                spline.weights.push(of('R').unwrap_or_else(Q::one));
            }
        }
    }
    paths
}

fn heidenhain(text: &str, axes: &str) -> Paths {
    let mut paths = Paths::default();
    let mut tool = Tool { axes, at: vec![Q::zero(); axes.len()] };
    let joined = text.replace(" ~\n", " ");
    for line in joined.lines().skip_while(|line| !line.contains("; CURVE")) {
        let words: Vec<&str> = line.split_whitespace().skip(1).collect();
        if words.first() != Some(&"SPL") {
            tool.words(words.iter().copied());
            continue;
        }
        let k = |power: char, axis: char| {
            let key = format!("K{power}{axis}");
            words.iter().find_map(|w| w.strip_prefix(key.as_str())).map(number)
        };
        let before = tool.at.clone();
        tool.words(words.iter().copied().filter(|w| !w.starts_with('K')));
        let numerators = axes.chars().enumerate().map(|(i, axis)| {
            let (Some(k1), Some(k2), Some(k3)) = (k('1', axis), k('2', axis), k('3', axis)) else {
                assert_eq!(before[i], tool.at[i], "{axis} moves without its K: {line}");
                return Poly(vec![before[i].clone()]);
            };
            // K3 t³ + K2 t² + K1 t + A with t = 1 − s.
            let t = Poly(vec![Q::one(), q(-1, 1)]);
            let power = |n: usize| (0..n).fold(Poly(vec![Q::one()]), |p, _| p.times(&t));
            let sum = power(3).scaled(&k3).plus(&power(2).scaled(&k2)).plus(&power(1).scaled(&k1));
            let sum = sum.plus(&Poly(vec![tool.at[i].clone()]));
            assert_eq!(sum.at(&Q::zero()), before[i], "SPL does not start where the tool is: {line}");
            sum
        });
        paths.spans.push(Span { numerators: numerators.collect(), denominator: Poly(vec![Q::one()]) });
    }
    paths
}
