//! Points that a drawing cannot tell from fewer.
//!
//! A path of a million blocks has more points than a drawing has room for. Every so many-th of them would be another path: a
//! plunge between two of them would not be there. Of a stretch a point is left out only where it lies within [`FINEST`] of the
//! line between those that stay (Douglas and Peucker), so that every extreme stays, and what is drawn is the path to within
//! half of the finest step of the drawing.

/// The greatest distance of a point that is left out from the line that is drawn, as a share of the width or height of the
/// drawing: half of one of its 6000 steps.
const FINEST: f64 = 1.0 / 12_000.0;

/// Stretches of so many points are thinned for themselves.
const STRETCH: usize = 512;

/// The points, without those that make no difference. Points that are no numbers break a line, and stay.
pub(super) fn thinned(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let finite = || points.iter().filter(|p| p[0].is_finite() && p[1].is_finite());
    let scale = [0, 1].map(|i| {
        let (low, high) =
            finite().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), p| (a.min(p[i]), b.max(p[i])));
        if low < high { 1.0 / (FINEST * (high - low)) } else { 0.0 }
    });
    let mut out = Vec::new();
    for (n, part) in points.split(|p| !(p[0].is_finite() && p[1].is_finite())).enumerate() {
        if n != 0 {
            out.push([f64::NAN; 2]);
        }
        let mut from = 0;
        out.extend(part.first());
        while from + 1 < part.len() {
            let to = (from + STRETCH).min(part.len() - 1);
            keep(&part[from..=to], scale, &mut out);
            from = to;
        }
    }
    out
}

/// Adds what stays of a stretch, without its first point.
fn keep(stretch: &[[f64; 2]], scale: [f64; 2], out: &mut Vec<[f64; 2]>) {
    let last = stretch.len() - 1;
    let (a, b) = (stretch[0], stretch[last]);
    let far = |p: &[f64; 2]| {
        // The square of the distance from the segment, in steps.
        let d = [0, 1].map(|i| (b[i] - a[i]) * scale[i]);
        let e = [0, 1].map(|i| (p[i] - a[i]) * scale[i]);
        let square = d[0] * d[0] + d[1] * d[1];
        let t = if 0.0 < square { ((e[0] * d[0] + e[1] * d[1]) / square).clamp(0.0, 1.0) } else { 0.0 };
        [0, 1].map(|i| (e[i] - t * d[i]) * (e[i] - t * d[i])).iter().sum::<f64>()
    };
    let worst = (1..last).map(|i| (i, far(&stretch[i]))).max_by(|(_, x), (_, y)| x.total_cmp(y));
    match worst {
        Some((i, most)) if 1.0 < most => {
            keep(&stretch[..=i], scale, out);
            keep(&stretch[i..], scale, out);
        }
        _ => out.push(b),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plunge_between_a_hundred_thousand_points_stays() {
        let flat = |i: u32| [f64::from(i) * 1e-3, 0.0];
        let mut points: Vec<[f64; 2]> = (0..100_000).map(flat).collect();
        points[33_333][1] = -20.0;
        points.push([f64::NAN; 2]);
        points.extend([[0.0, 5.0], [1.0, 5.0]]);
        let thin = thinned(&points);
        assert!(thin.contains(&[33.333, -20.0]), "the plunge");
        // Its foot on both sides, and the ends of 196 stretches.
        assert!(thin.len() < 300, "{}", thin.len());
        assert_eq!(thin.iter().filter(|p| p[0].is_nan()).count(), 1);
        assert_eq!(thin[thin.len() - 1], [1.0, 5.0]);
    }

    #[test]
    fn a_point_and_a_way_there_and_back_stay() {
        assert_eq!(thinned(&[[1.0, 1.0]]), [[1.0, 1.0]]);
        let there = [[0.0, 0.0], [5.0, 0.0], [10.0, 0.0], [5.0, 0.0], [0.0, 0.0]];
        assert_eq!(thinned(&there), [[0.0, 0.0], [10.0, 0.0], [0.0, 0.0]]);
    }
}
