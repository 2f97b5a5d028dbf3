//! Arcs and helices in every plane, of several turns too, and the words that each dialect has for them.

#![allow(
    clippy::disallowed_methods,
    reason = "the oracle uses the platform's functions so that it shares no code with the crate"
)]

use super::Point;

/// An arc as CIRCLE states it in Creo, counter-clockwise about its axis, or, of several turns, as MOVARC does in Fusion.
pub(super) struct Case {
    pub(super) name: &'static str,
    pub(super) start: Point,
    pub(super) center: Point,
    pub(super) axis: Point,
    pub(super) end: Point,
    /// Degrees, counter-clockwise about +X, +Y or +Z, or about a tilted axis.
    pub(super) sweep: f64,
    /// The words that each dialect has for it: Sinumerik, Heidenhain, Mazak.
    pub(super) words: [&'static str; 3],
}

pub(super) const CASES: &[Case] = &[
    Case {
        name: "three quarters in X Y",
        start: [0.0, 0.0, 0.0],
        center: [5.0, 0.0, 0.0],
        axis: [0.0, 0.0, 1.0],
        end: [5.0, 5.0, 0.0],
        sweep: 270.0,
        words: ["G3 X5 Y5 I5 J0", "C X+5 Y+5 DR+", "G3 X5. Y5. I5. J0."],
    },
    Case {
        name: "a whole circle in X Y",
        start: [0.0, 0.0, 0.0],
        center: [5.0, 0.0, 0.0],
        axis: [0.0, 0.0, -1.0],
        end: [0.0, 0.0, 0.0],
        sweep: -360.0,
        words: ["G2 X0 Y0 I5 J0", "C X+0 Y+0 DR-", "G2 X0. Y0. I5. J0."],
    },
    Case {
        name: "a quarter in Z X",
        start: [0.0, 2.0, 5.0],
        center: [0.0, 2.0, 0.0],
        axis: [0.0, 1.0, 0.0],
        end: [5.0, 2.0, 0.0],
        sweep: 90.0,
        words: ["CIP X5 Z0 I1=AC(3.535534) J1=AC(2) K1=AC(3.535534)", "L X", "G18 G3 X5. Z0. I0. K-5."],
    },
    Case {
        name: "a whole circle in Z X",
        start: [0.0, 2.0, 5.0],
        center: [0.0, 2.0, 0.0],
        axis: [0.0, -1.0, 0.0],
        end: [0.0, 2.0, 5.0],
        sweep: -360.0,
        words: ["CIP X0 Z-5", "L X", "G18 G2 X0. Z5. I0. K-5."],
    },
    Case {
        name: "three quarters in Y Z",
        start: [1.0, 5.0, 0.0],
        center: [1.0, 0.0, 0.0],
        axis: [-1.0, 0.0, 0.0],
        end: [1.0, 0.0, 5.0],
        sweep: -270.0,
        words: ["CIP Y0 Z5 I1=AC(1)", "L Y", "G19 G2 Y0. Z5. J-5. K0."],
    },
    Case {
        name: "a helix of three quarters",
        start: [0.0, 0.0, 0.0],
        center: [5.0, 0.0, 0.0],
        axis: [0.0, 0.0, 1.0],
        end: [5.0, 5.0, -3.0],
        sweep: 270.0,
        words: ["G3 X5 Y5 Z-3 I5 J0", "CP IPA+270 IZ-3 DR+", "G3 X5. Y5. Z-3. I5. J0."],
    },
    Case {
        name: "a helix of a whole turn",
        start: [0.0, 0.0, 0.0],
        center: [5.0, 0.0, 0.0],
        axis: [0.0, 0.0, -1.0],
        end: [0.0, 0.0, -3.0],
        sweep: -360.0,
        words: ["G2 X0 Y0 Z-3 I5 J0", "CP IPA-360 IZ-3 DR-", "G2 X0. Y0. Z-3. I5. J0."],
    },
    Case {
        // atan2(4, −3) of the 3-4-5 triangle: an angle that rounds.
        name: "a helix that ends at no round angle",
        start: [10.0, 0.0, 0.0],
        center: [5.0, 0.0, 0.0],
        axis: [0.0, 0.0, 1.0],
        end: [2.0, 4.0, 1.0],
        sweep: 126.869_897_645_844,
        words: ["G3 X2 Y4 Z1 I-5 J0", "CP IPA+126.8699 IZ+1 DR+", "G3 X2. Y4. Z1. I-5. J0."],
    },
    Case {
        // Its sagitta is 5e-5 mm: three places with six decimals say where it runs, and nothing about its centre.
        name: "a flat arc in Z X",
        start: [0.0, 2.0, 1000.0],
        center: [0.0, 2.0, 0.0],
        axis: [0.0, 1.0, 0.0],
        end: [0.6, 2.0, 999.999_82],
        sweep: 0.034_377_469,
        words: ["X0.6 Z999.99982", "L X+0.6", "G18 G3 X0.6"],
    },
    Case {
        // u = (3, 0, 4)/5, v = (0, −1, 0): w = u × v = (4, 0, −3)/5.
        name: "a quarter in a tilted plane",
        start: [4.0, 2.0, 7.0],
        center: [1.0, 2.0, 3.0],
        axis: [0.8, 0.0, -0.6],
        end: [1.0, -3.0, 3.0],
        sweep: 90.0,
        words: ["CIP X1 Y-3 Z3 I1=AC(3.12132) J1=AC(-1.535534) K1=AC(5.828427)", "L X", "X3.9"],
    },
    Case {
        name: "three quarters in a tilted plane, the other way",
        start: [4.0, 2.0, 7.0],
        center: [1.0, 2.0, 3.0],
        axis: [-0.8, 0.0, 0.6],
        end: [1.0, -3.0, 3.0],
        sweep: 270.0,
        words: ["CIP X1 Y-3 Z3 I1=AC(-1.12132) J1=AC(5.535534)", "L X", "X3.9"],
    },
    Case {
        name: "a whole circle in a tilted plane",
        start: [4.0, 2.0, 7.0],
        center: [1.0, 2.0, 3.0],
        axis: [0.8, 0.0, -0.6],
        end: [4.0, 2.0, 7.0],
        sweep: 360.0,
        words: ["CIP X-2 Y2 Z-1 I1=AC(1) J1=AC(-3) K1=AC(3)", "L X", "X3.9"],
    },
    Case {
        // A half turn and 2 mm along (0.8, 0, −0.6).
        name: "a helix about a tilted axis",
        start: [4.0, 2.0, 7.0],
        center: [1.0, 2.0, 3.0],
        axis: [0.8, 0.0, -0.6],
        end: [-0.4, 2.0, -2.2],
        sweep: 180.0,
        words: ["X3.9", "L X", "X3.9"],
    },
    Case {
        // In six decimals its axis is not quite square to the chord: the arc rises by some 1e-5 mm.
        name: "half a circle about an axis that was rounded",
        start: [0.0, 0.0, 0.0],
        center: [8.660_254, 5.0, 0.0],
        axis: [0.5, -0.866_026, 0.0],
        end: [17.320_508, 10.0, 0.0],
        sweep: 180.0,
        words: ["CIP X17.320508 Y10 Z0 I1=AC(8.66", "L X", "X0.0"],
    },
    Case {
        name: "two turns and three quarters of a helix",
        start: [0.0, 0.0, 0.0],
        center: [5.0, 0.0, 0.0],
        axis: [0.0, 0.0, 1.0],
        end: [5.0, 5.0, -11.0],
        sweep: 990.0,
        words: ["G3 X5 Y5 Z-11 I5 J0 TURN=2", "CP IPA+990 IZ-11 DR+", "G3 X0. Y0. Z-4. I5. J0."],
    },
    Case {
        // It would end over its start, where TURN could be read in two ways.
        name: "three turns of a helix",
        start: [0.0, 0.0, 0.0],
        center: [5.0, 0.0, 0.0],
        axis: [0.0, 0.0, -1.0],
        end: [0.0, 0.0, -6.0],
        sweep: -1080.0,
        words: ["G2 X10 Y0 Z-5 I5 J0 TURN=2", "CP IPA-1080 IZ-6 DR-", "G2 X0. Y0. Z-2. I5. J0."],
    },
    Case {
        name: "round twice in X Y",
        start: [0.0, 0.0, 0.0],
        center: [5.0, 0.0, 0.0],
        axis: [0.0, 0.0, 1.0],
        end: [0.0, 0.0, 0.0],
        sweep: 720.0,
        words: ["G3 X10 Y0 I5 J0 TURN=1", "CP IPA+720 DR+", "G3 X0. Y0. I5. J0."],
    },
    Case {
        name: "eighteen turns",
        start: [0.0, 0.0, 0.0],
        center: [5.0, 0.0, 0.0],
        axis: [0.0, 0.0, 1.0],
        end: [5.0, -5.0, -18.25],
        sweep: 6570.0,
        words: ["G3 X5 Y-5 Z-18.25 I5 J0 TURN=18", "CP IPA+5400 IZ-15 DR+", "G3 X0. Y0. Z-1. I5. J0."],
    },
    Case {
        name: "a turn and a quarter in Z X",
        start: [0.0, 2.0, 5.0],
        center: [0.0, 2.0, 0.0],
        axis: [0.0, 1.0, 0.0],
        end: [5.0, 2.0, 0.0],
        sweep: 450.0,
        words: ["CIP X", "L X", "G18 G3 X0. Z5. I0. K-5."],
    },
    Case {
        name: "a helix about Y",
        start: [0.0, 2.0, 5.0],
        center: [0.0, 2.0, 0.0],
        axis: [0.0, 1.0, 0.0],
        end: [5.0, 4.0, 0.0],
        sweep: 90.0,
        words: ["X0.", "L X", "G18 G3 X5. Y4. Z0. I0. K-5."],
    },
];

impl Case {
    pub(super) fn system(&self) -> &'static str {
        if self.sweep.abs() <= 360.0 { "creo" } else { "fusion" }
    }

    pub(super) fn text(&self) -> String {
        let list = |p: Point| p.map(|x| x.to_string()).join(",");
        let [x, y, _] = self.start;
        let (center, axis, radius) = (list(self.center), list(self.axis), self.radius());
        let arc = match self.system() {
            "creo" => format!("CIRCLE/{center},{axis},{radius}"),
            _ => format!("MOVARC/{center},{axis},{radius},ANGLE,{}", self.sweep.abs()),
        };
        format!(
            "PARTNO ARC\nLOADTL/1\nSPINDL/500,RPM,CLW\nFEDRAT/100,MMPM\nRAPID\nGOTO/{x},{y},1200\nGOTO/{start}\n\
             {arc}\nGOTO/{end}\nGOTO/40,-30,1100\nGOTO/40,-30,1200\nFINI\n",
            start = list(self.start),
            end = list(self.end),
        )
    }

    /// u, v and w: of X, Y or Z the axis that points up, otherwise as stated.
    fn frame(&self) -> [Point; 3] {
        let w = self.axis.map(|x| x / dot(self.axis, self.axis).sqrt());
        let principal = (0..3).find(|i| w[*i].abs() == 1.0);
        let w = if principal.is_some() { w.map(f64::abs) } else { w };
        let from = minus(self.start, self.center);
        let flat = minus(from, w.map(|x| x * dot(from, w)));
        let u = flat.map(|x| x / dot(flat, flat).sqrt());
        [u, cross(w, u), w]
    }

    /// u, v and w of a place, from the centre.
    pub(super) fn local(&self, p: Point) -> Point {
        self.frame().map(|axis| dot(axis, minus(p, self.center)))
    }

    pub(super) fn radius(&self) -> f64 {
        let [u, v, _] = self.local(self.start);
        u.hypot(v)
    }
}

pub(super) fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(super) fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
