//! Curves end to end: in the order of the file, or each next to the one that it meets.

use super::{FileCurve, Path, Point};
use std::collections::BTreeMap;

/// Curves that meet, end to start.
pub type Run = Vec<FileCurve>;

/// The greatest difference in one coordinate.
pub fn gap(p: &Point, q: &Point) -> f64 {
    p.iter().zip(q).fold(0.0, |most, (a, b)| f64::max(most, (a - b).abs()))
}

/// Curves in an order, and which way round each is run.
pub struct Order {
    /// For each run the numbers of its curves, and whether they are run backwards.
    pub runs: Vec<Vec<(usize, bool)>>,
    /// The first place where more than two ends meet, so that there was a choice: the number of a curve there.
    pub branch: Option<usize>,
}

/// The ends of the curves, by number.
struct Ends(Vec<[Point; 2]>);

impl Ends {
    fn of(curves: &[FileCurve]) -> Ends {
        Ends(curves.iter().map(|curve| [curve.path.start(), curve.path.end()]).collect())
    }

    fn start(&self, (i, back): (usize, bool)) -> &Point {
        &self.0[i][usize::from(back)]
    }

    fn end(&self, (i, back): (usize, bool)) -> &Point {
        &self.0[i][usize::from(!back)]
    }
}

/// The order of the file. A curve that only its other end joins to the one before, or to the one behind where it is the
/// first, is run backwards.
pub fn of_file(curves: &[FileCurve], tolerance: f64) -> Order {
    let ends = Ends::of(curves);
    let near = |p: &Point, q: &Point| gap(p, q) <= tolerance;
    let mut runs: Vec<Vec<(usize, bool)>> = Vec::new();
    for i in 0..curves.len() {
        if let Some(run) = runs.last_mut()
            && let Some(last) = run.last()
            && let Some(back) = [false, true].into_iter().find(|b| near(ends.end(*last), ends.start((i, *b))))
        {
            run.push((i, back));
            continue;
        }
        let meets_next = |p: &Point| ends.0.get(i + 1).is_some_and(|next| next.iter().any(|q| near(p, q)));
        let back = !meets_next(ends.end((i, false))) && meets_next(ends.start((i, false)));
        runs.push(vec![(i, back)]);
    }
    Order { runs, branch: None }
}

/// Ends of curves by place, in cells of the tolerance.
struct Cells {
    size: f64,
    cells: BTreeMap<[i64; 3], Vec<(usize, bool)>>,
}

impl Cells {
    fn new(ends: &Ends, tolerance: f64) -> Cells {
        let mut cells = Cells { size: tolerance, cells: BTreeMap::new() };
        for i in 0..ends.0.len() {
            for back in [false, true] {
                let cell = cells.cell(ends.start((i, back)));
                cells.cells.entry(cell).or_default().push((i, back));
            }
        }
        cells
    }

    /// Coordinates are within a million and the tolerance not below a millionth.
    fn cell(&self, p: &Point) -> [i64; 3] {
        p.map(|x| (x / self.size).floor() as i64)
    }

    /// The unused curves that start near a place, run forwards or backwards: the nearest one, and how many there are.
    fn nearest(&mut self, p: &Point, ends: &Ends, used: &[bool]) -> (Option<(usize, bool)>, usize) {
        let [a, b, c] = self.cell(p);
        let mut best: Option<(f64, (usize, bool))> = None;
        let mut count = 0;
        for cell in (a - 1..=a + 1)
            .flat_map(|a| (b - 1..=b + 1).flat_map(move |b| (c - 1..=c + 1).map(move |c| [a, b, c])))
        {
            let Some(all) = self.cells.get_mut(&cell) else { continue };
            all.retain(|(i, _)| !used[*i]);
            for one in all.iter() {
                let far = gap(p, ends.start(*one));
                if far <= self.size {
                    count += 1;
                    let better = best.is_none_or(|(least, other)| (far, *one) < (least, other));
                    if better {
                        best = Some((far, *one));
                    }
                }
            }
        }
        (best.map(|(_, one)| one), count)
    }
}

/// Each curve next to the one that it meets: the first that is left, run as it stands, then on from its end, then back from
/// its start.
pub fn chained(curves: &[FileCurve], tolerance: f64) -> Order {
    let ends = Ends::of(curves);
    let mut cells = Cells::new(&ends, tolerance);
    let mut used = vec![false; curves.len()];
    let mut order = Order { runs: Vec::new(), branch: None };
    for first in 0..curves.len() {
        if used[first] {
            continue;
        }
        used[first] = true;
        let mut run = vec![(first, false)];
        let mut before = Vec::new();
        for backwards in [false, true] {
            let mut last = (first, backwards);
            loop {
                let (next, count) = cells.nearest(ends.end(last), &ends, &used);
                // A closed curve has both of its ends there.
                let own = next.is_some_and(|(i, _)| gap(&ends.0[i][0], &ends.0[i][1]) <= tolerance);
                if 1 + usize::from(own) < count && order.branch.is_none() {
                    order.branch = Some(last.0);
                }
                let Some(next) = next else { break };
                used[next.0] = true;
                if backwards {
                    before.push((next.0, !next.1));
                } else {
                    run.push(next);
                }
                last = next;
            }
        }
        before.reverse();
        before.extend(run);
        order.runs.push(before);
    }
    order
}

/// The curves of an order, and what was done so that they meet.
pub struct Joined {
    /// The runs.
    pub runs: Vec<Run>,
    /// The curves that are run backwards.
    pub backwards: Vec<usize>,
    /// How many gaps were closed by a line, and the widest of them, mm.
    pub bridges: (usize, f64),
}

/// Puts curves into an order. Ends no farther apart than `meet` mm are one place, that of the curve before; between others
/// there is a straight line. Lines in a row are one path.
pub fn joined(curves: Vec<FileCurve>, order: &Order, meet: f64) -> Joined {
    let mut left: Vec<Option<FileCurve>> = curves.into_iter().map(Some).collect();
    let mut joined = Joined { runs: Vec::new(), backwards: Vec::new(), bridges: (0, 0.0) };
    for numbers in &order.runs {
        let mut run: Run = Vec::new();
        for (i, back) in numbers {
            // Each number stands once in an order.
            let Some(mut curve) = left[*i].take() else { continue };
            if *back {
                curve.path = curve.path.reversed();
                joined.backwards.push(*i);
            }
            if let Some(last) = run.last() {
                let end = last.path.end();
                let apart = gap(&end, &curve.path.start());
                if apart <= meet {
                    if apart != 0.0 {
                        curve.path = curve.path.starting_at(end);
                    }
                } else {
                    joined.bridges = (joined.bridges.0 + 1, joined.bridges.1.max(apart));
                    let bridge = Path::Lines(vec![end, curve.path.start()], Vec::new());
                    push(&mut run, FileCurve::new(bridge, "line", curve.span));
                }
            }
            push(&mut run, curve);
        }
        joined.runs.push(run);
    }
    joined
}

fn push(run: &mut Run, curve: FileCurve) {
    if let Some(FileCurve { path: Path::Lines(points, lines), .. }) = run.last_mut()
        && let Path::Lines(more, from) = &curve.path
        && lines.len() + 1 == points.len()
        && from.len() + 1 == more.len()
    {
        points.extend(&more[1..]);
        lines.extend(from);
        return;
    }
    run.push(curve);
}
