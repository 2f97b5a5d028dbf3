//! Planes of arcs: X Y, Z X and Y Z, whose axes are picked and never multiplied, and any other by an axis.

use crate::geom::elementary;

/// A plane of the machine, and its right-handed axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plane {
    /// X Y, about Z.
    Xy,
    /// Z X, about Y.
    Zx,
    /// Y Z, about X.
    Yz,
}

impl Plane {
    /// All three.
    pub const ALL: [Plane; 3] = [Plane::Xy, Plane::Zx, Plane::Yz];

    /// Which coordinates are u, v and w.
    pub fn axes(self) -> [usize; 3] {
        match self {
            Plane::Xy => [0, 1, 2],
            Plane::Zx => [2, 0, 1],
            Plane::Yz => [1, 2, 0],
        }
    }
}

/// Which way round, seen against w.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sense {
    /// Clockwise: G2.
    Clockwise,
    /// Counter-clockwise: G3.
    CounterClockwise,
}

impl Sense {
    /// The other one.
    #[must_use]
    pub fn reversed(self) -> Sense {
        match self {
            Sense::Clockwise => Sense::CounterClockwise,
            Sense::CounterClockwise => Sense::Clockwise,
        }
    }
}

/// The right-handed axes u, v, w of the plane of an arc: u and v lie in it, w is square to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    plane: Option<Plane>,
    /// u, v and w, each of length 1.
    axes: [[f64; 3]; 3],
}

impl From<Plane> for Frame {
    fn from(plane: Plane) -> Frame {
        let unit = |axis: usize| std::array::from_fn(|i| f64::from(u8::from(i == axis)));
        Frame { plane: Some(plane), axes: plane.axes().map(unit) }
    }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(a: [f64; 3]) -> Option<[f64; 3]> {
    // By the greatest first, so that no square overflows or vanishes.
    let most = a.iter().fold(0.0f64, |most, x| most.max(x.abs()));
    if !(0.0 < most && most.is_finite()) {
        return None;
    }
    let a = a.map(|x| x / most);
    let length = a.iter().map(|x| x * x).sum::<f64>().sqrt();
    Some(a.map(|x| x / length))
}

impl Frame {
    /// The frame whose w points along `axis`, and whether it does: a plane of the machine where `axis` is within `slack`,
    /// a share of its length, of X, Y or Z; its w may then point the other way. None where `axis` is no direction.
    ///
    /// Of any other plane u = e × w of the unit vector e that is nearest to square to w, and v = w × u.
    pub fn about(axis: [f64; 3], slack: f64) -> Option<(Frame, bool)> {
        let w = unit(axis)?;
        for plane in Plane::ALL {
            let [u, v, along] = plane.axes();
            if w[u].abs() <= slack && w[v].abs() <= slack {
                return Some((plane.into(), 0.0 < w[along]));
            }
        }
        let least = usize::from(w[1].abs() < w[0].abs());
        let least = if w[2].abs() < w[least].abs() { 2 } else { least };
        let u = unit(cross(std::array::from_fn(|i| f64::from(u8::from(i == least))), w))?;
        Some((Frame { plane: None, axes: [u, cross(w, u), w] }, true))
    }

    /// The plane of the machine that it is, where it is one.
    pub fn plane(&self) -> Option<Plane> {
        self.plane
    }

    /// u, v and w in X Y Z.
    pub fn axes(&self) -> [[f64; 3]; 3] {
        self.axes
    }

    /// The coordinates u, v, w of a place or a vector.
    pub fn local(&self, p: [f64; 3]) -> [f64; 3] {
        match self.plane {
            Some(plane) => plane.axes().map(|i| p[i]),
            None => self.axes.map(|axis| axis[0] * p[0] + axis[1] * p[1] + axis[2] * p[2]),
        }
    }

    /// The place or vector of coordinates u, v, w.
    pub fn global(&self, p: [f64; 3]) -> [f64; 3] {
        match self.plane {
            Some(plane) => {
                let mut place = [0.0; 3];
                for (i, x) in plane.axes().into_iter().zip(p) {
                    place[i] = x;
                }
                place
            }
            None => std::array::from_fn(|i| {
                self.axes[0][i] * p[0] + self.axes[1][i] * p[1] + self.axes[2][i] * p[2]
            }),
        }
    }
}

/// atan2(y, x), in radians between −π and π.
pub(super) fn direction(y: f64, x: f64) -> f64 {
    let half = std::f64::consts::FRAC_PI_2;
    if x.abs() < y.abs() {
        return half.copysign(y) - elementary::atan(x / y);
    }
    if x == 0.0 {
        return 0.0;
    }
    let angle = elementary::atan(y / x);
    if 0.0 < x { angle } else { angle + (2.0 * half).copysign(y) }
}
