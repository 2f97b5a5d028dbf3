//! The paper's curve and its steps, from the printed formulas.

use std::fmt::Write;

/// X, Y, Z in mm and A in degrees.
pub(super) type Point = [f64; 4];

/// √(a² + b² + c²).
pub(super) fn length(of: [f64; 3]) -> f64 {
    of.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// A conical cutter; angles in degrees, lengths in mm.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cutter {
    pub(super) name: &'static str,
    pub(super) d1: f64,
    pub(super) s: f64,
    pub(super) c: f64,
    pub(super) r: f64,
    pub(super) length: f64,
    pub(super) flutes: usize,
    pub(super) left: bool,
    pub(super) constant_lead: bool,
}

impl Cutter {
    /// The input file that asks for it.
    pub(super) fn toml(&self) -> String {
        let Cutter { d1, s, c, r, length, flutes, .. } = self;
        let mut text = "name = \"ORACLE\"\n[cutter]\n".to_owned();
        for (key, value) in [("D1", d1), ("S", s), ("C", c), ("r", r), ("length", length)] {
            writeln!(text, "{key} = {value:?}").expect("a string takes all");
        }
        writeln!(text, "flutes = {flutes}").expect("a string takes all");
        if self.left {
            text.push_str("hand = \"left\"\n");
        }
        if self.constant_lead {
            text.push_str("law = \"constant-lead\"\n");
        }
        text + "[process]\nfeed = 200.0\nretract = { axis = \"Z\", to = 50.0 }\n"
    }

    /// The index of a flute, degrees.
    pub(super) fn index(&self, flute: usize) -> f64 {
        360.0 / self.flutes as f64 * flute as f64
    }

    fn tan_c(&self) -> f64 {
        self.c.to_radians().tan()
    }

    /// ab = 2 tan S / D1, against the clock for a left hand.
    fn ab(&self) -> f64 {
        2.0 * self.s.to_radians().tan() / self.d1 * if self.left { -1.0 } else { 1.0 }
    }

    /// The b of the angle's law: 2 tan C / D1, or 0 where the lead is constant.
    fn b(&self) -> f64 {
        if self.constant_lead { 0.0 } else { 2.0 * self.tan_c() / self.d1 }
    }

    /// Whether A is linear in X.
    pub(super) fn is_straight(&self) -> bool {
        self.s == 0.0 || self.b() == 0.0
    }

    /// A at X, radians: (2 tan S / D1) X ln(1 + bX)/(bX), whose limit for b → 0 is (2 tan S / D1) X.
    pub(super) fn angle(&self, x: f64) -> f64 {
        let bx = self.b() * x;
        let share = if bx == 0.0 { 1.0 } else { bx.ln_1p() / bx };
        self.ab() * x * share
    }

    /// |dA/dX| at X, radians a millimetre.
    fn slope(&self, x: f64) -> f64 {
        (self.ab() / (1.0 + self.b() * x)).abs()
    }

    /// D1/2 + X tan C.
    fn radius(&self, x: f64) -> f64 {
        0.5 * self.d1 + x * self.tan_c()
    }

    /// Y = X tan C, Z = X tan C sin r.
    pub(super) fn position(&self, x: f64, radians: f64, index: f64) -> Point {
        let y = x * self.tan_c();
        [x, y, y * self.r.to_radians().sin(), index + radians.to_degrees()]
    }

    /// R ΔA, ΔY and ΔZ against the curve at equal X.
    pub(super) fn differences(&self, at: &Point, index: f64) -> [f64; 3] {
        let asked = self.position(at[0], self.angle(at[0]), index);
        [self.radius(at[0]) * (at[3] - asked[3]).to_radians(), at[1] - asked[1], at[2] - asked[2]]
    }

    /// √((R ΔA)² + ΔY² + ΔZ²) against the curve at equal X.
    pub(super) fn deviation(&self, at: &Point, index: f64) -> f64 {
        length(self.differences(at, index))
    }

    /// The most that `deviation` can be for a point of the curve whose coordinates are off by up to `mm` and `degrees`:
    /// the error of X makes another Y, Z and A to compare with.
    pub(super) fn rounding(&self, x: f64, mm: f64, degrees: f64) -> f64 {
        let arc = self.radius(x) * (degrees.to_radians() + self.slope(x) * mm);
        let y = mm * (1.0 + self.tan_c().abs());
        (arc * arc + 2.0 * y * y).sqrt()
    }

    /// What A makes at the surface when it lags `mm` of X behind.
    pub(super) fn lag(&self, mm: f64) -> f64 {
        let end = |x: f64| self.radius(x) * self.slope(x);
        end(0.0).max(end(self.length)) * mm
    }

    /// The odd-even steps of length `dl`, points (X, A in radians) after the first. With a, b, tan θ = ab/(1 + bX0):
    ///
    /// ```text
    /// ΔX10 = (1 + bX0) Δl / √((1 + bX0)² + (ab)²)       ΔA10 = ab Δl / √((1 + bX0)² + (ab)²)                  (8) (9)
    /// ΔX21 = ΔX10 [3a³ − 2ΔA10² sin²θ (3a − 8ΔA10)] / [3a³ − 2a ΔA10 sin²θ (3a − 4ΔA10)]                      (14)
    /// ΔA21 = ΔA10 [3a² − 2ΔA10 (3a − 4ΔA10)] / [3a² − 2ΔA10 sin²θ (3a − 4ΔA10)]                               (15)
    /// ```
    ///
    /// Where A is linear in X the even step repeats the odd one. The path ends at the length with the exact A; a last
    /// step below a thousandth of Δl is not made, and the point before it moves to the end. With `overrun` whole
    /// cycles are made until X reaches the end or passes it.
    pub(super) fn odd_even(&self, dl: f64, overrun: bool) -> Vec<(f64, f64)> {
        let (ab, b) = (self.ab(), self.b());
        let a = ab / b;
        let (mut x, mut angle) = (0.0, 0.0);
        let mut points = Vec::new();
        while x < self.length {
            let q = 1.0 + b * x;
            let h = (q * q + ab * ab).sqrt();
            let (dx10, da10) = (q * dl / h, ab * dl / h);
            let (dx21, da21) = if self.is_straight() {
                (dx10, da10)
            } else {
                let sin2 = ab * ab / (h * h);
                let x_numerator = 3.0 * a.powi(3) - 2.0 * da10 * da10 * sin2 * (3.0 * a - 8.0 * da10);
                let x_denominator = 3.0 * a.powi(3) - 2.0 * a * da10 * sin2 * (3.0 * a - 4.0 * da10);
                let a_numerator = 3.0 * a * a - 2.0 * da10 * (3.0 * a - 4.0 * da10);
                let a_denominator = 3.0 * a * a - 2.0 * da10 * sin2 * (3.0 * a - 4.0 * da10);
                (dx10 * x_numerator / x_denominator, da10 * a_numerator / a_denominator)
            };
            for (dx, da) in [(dx10, da10), (dx21, da21)] {
                (x, angle) = (x + dx, angle + da);
                if !overrun && self.length - 1.0e-3 * dl <= x {
                    points.push((self.length, self.angle(self.length)));
                    return points;
                }
                points.push((x, angle));
            }
        }
        points
    }

    /// The greatest deviation of the polyline through the steps, from 16 places on each line.
    pub(super) fn polyline_deviation(&self, steps: &[(f64, f64)]) -> f64 {
        let mut worst = 0.0f64;
        let mut from = (0.0, 0.0);
        for &to in steps {
            for i in 0..=16 {
                let t = f64::from(i) / 16.0;
                let at = self.position(from.0 + t * (to.0 - from.0), from.1 + t * (to.1 - from.1), 0.0);
                worst = worst.max(self.deviation(&at, 0.0));
            }
            from = to;
        }
        worst
    }

    /// How far places, in order, are from the polyline through `points` (the first included), each from the nearest of
    /// the line that holds its X and the two beside it.
    pub(super) fn polyline_distance(&self, points: &[Point], places: &[Point]) -> f64 {
        let mut line = 0;
        let mut worst = 0.0f64;
        for at in places {
            while line + 2 < points.len() && points[line + 1][0] < at[0] {
                line += 1;
            }
            let near = line.saturating_sub(1)..(line + 2).min(points.len() - 1);
            let nearest = near
                .map(|i| self.line_distance(&points[i], &points[i + 1], at))
                .fold(f64::INFINITY, f64::min);
            worst = worst.max(nearest);
        }
        worst
    }

    /// The distance of a place from a line, degrees counted at the place's radius.
    fn line_distance(&self, from: &Point, to: &Point, at: &Point) -> f64 {
        let mm = [1.0, 1.0, 1.0, self.radius(at[0]).to_radians()];
        let (mut along, mut square) = (0.0, 0.0);
        for i in 0..4 {
            let d = (to[i] - from[i]) * mm[i];
            along += d * (at[i] - from[i]) * mm[i];
            square += d * d;
        }
        let t = (along / square).clamp(0.0, 1.0);
        (0..4).map(|i| ((at[i] - from[i] - t * (to[i] - from[i])) * mm[i]).powi(2)).sum::<f64>().sqrt()
    }
}

/// The cutter of the paper's accuracy test.
pub(super) const PAPER: Cutter = Cutter {
    name: "paper",
    d1: 10.0,
    s: 30.0,
    c: 5.0,
    r: 8.0,
    length: 30.0,
    flutes: 4,
    left: false,
    constant_lead: false,
};

/// Cutters at and about the limits.
pub(super) const CUTTERS: &[Cutter] = &[
    PAPER,
    Cutter { name: "cylinder", c: 0.0, flutes: 1, ..PAPER },
    Cutter { name: "reverse taper", c: -5.0, d1: 12.0, length: 20.0, flutes: 1, ..PAPER },
    Cutter { name: "steep cone", c: 30.0, d1: 6.0, length: 12.0, flutes: 2, ..PAPER },
    Cutter { name: "steep spiral", s: 60.0, flutes: 1, ..PAPER },
    Cutter { name: "straight flute", s: 0.0, flutes: 2, ..PAPER },
    Cutter { name: "thin", d1: 0.5, length: 5.0, flutes: 1, ..PAPER },
    Cutter { name: "long", length: 200.0, flutes: 1, ..PAPER },
    Cutter { name: "six flutes", flutes: 6, ..PAPER },
    Cutter { name: "left hand", left: true, flutes: 2, ..PAPER },
    Cutter { name: "constant lead", constant_lead: true, flutes: 2, ..PAPER },
];
