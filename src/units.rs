//! Axes, their kinds, and positions.
//!
//! There are three kinds of coordinate, and they are never mixed:
//!
//! | kind | unit | compared by |
//! |---|---|---|
//! | linear | millimetres | distance |
//! | rotary | degrees, unwound: 429° is not 69° | difference of angles |
//! | direction | a component of a vector | angle between normalised vectors |
//!
//! Radians live inside the logarithmic curve only; inches end in the reader.

use std::fmt;

/// The greatest number of coordinates of one run: X Y Z and a second spatial curve, or X Y Z and three more.
pub const MAX_AXES: usize = 6;

/// One place in Rⁿ, n ≤ [`MAX_AXES`]; coordinates beyond the run's axes are zero.
pub type Position = [f64; MAX_AXES];

/// Degrees in one radian.
pub const DEGREES: f64 = 180.0 / std::f64::consts::PI;

/// What a coordinate measures, and so how two of its values are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Millimetres.
    Linear,
    /// Degrees, unwound.
    Rotary,
    /// One component of a direction; only the direction of the whole vector counts.
    Direction,
}

/// The name of an axis as the control spells it: `X`, `A`, `X1`, `XH`.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Axis {
    bytes: [u8; 4],
    len: u8,
}

impl Axis {
    /// Reads a name: a letter, then up to three letters or digits. Lower case becomes upper case.
    pub fn new(name: &str) -> Option<Axis> {
        let ok = (1..=4).contains(&name.len())
            && name.starts_with(|c: char| c.is_ascii_alphabetic())
            && name.bytes().all(|b| b.is_ascii_alphanumeric());
        if !ok {
            return None;
        }
        let mut bytes = [0; 4];
        for (to, from) in bytes.iter_mut().zip(name.bytes()) {
            *to = from.to_ascii_uppercase();
        }
        Some(Axis { bytes, len: name.len() as u8 })
    }

    /// The name as text.
    pub fn as_str(&self) -> &str {
        // The constructor admits ASCII only.
        std::str::from_utf8(self.as_bytes()).unwrap_or_default()
    }

    /// The name as ASCII.
    #[inline]
    pub fn as_bytes(&self) -> &[u8] {
        &self.bytes[..usize::from(self.len)]
    }
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

impl fmt::Debug for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

/// The coordinates of a run, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Axes {
    list: [(Axis, Kind); MAX_AXES],
    len: usize,
}

impl Axes {
    /// An ordered list of at most [`MAX_AXES`] axes, none named twice.
    pub fn new(list: &[(Axis, Kind)]) -> Option<Axes> {
        let first = *list.first()?;
        let twice = (1..list.len()).any(|i| list[..i].iter().any(|other| other.0 == list[i].0));
        if MAX_AXES < list.len() || twice {
            return None;
        }
        let mut axes = Axes { list: [first; MAX_AXES], len: list.len() };
        axes.list[..list.len()].copy_from_slice(list);
        Some(axes)
    }

    /// X Y Z in millimetres and A in degrees: the coordinates of a conical cutter.
    pub fn xyza() -> Axes {
        let name = |bytes| Axis { bytes, len: 1 };
        let mut list = [(name(*b"X\0\0\0"), Kind::Linear); MAX_AXES];
        list[1].0 = name(*b"Y\0\0\0");
        list[2].0 = name(*b"Z\0\0\0");
        list[3] = (name(*b"A\0\0\0"), Kind::Rotary);
        Axes { list, len: 4 }
    }

    /// X Y Z of the tool's tip in millimetres and TX TY TZ, a vector from the tip along the tool: the coordinates of five
    /// axes. The length of the vector means nothing.
    pub fn with_direction() -> Axes {
        let mut axes = Axes::xyza();
        for (i, letter) in (b'X'..=b'Z').enumerate() {
            axes.list[3 + i] = (Axis { bytes: [b'T', letter, 0, 0], len: 2 }, Kind::Direction);
        }
        axes.len = 6;
        axes
    }

    /// The first of the three components of the tool's direction, where the run has one.
    #[inline]
    pub fn direction(&self) -> Option<usize> {
        self.as_slice().iter().position(|(_, kind)| *kind == Kind::Direction)
    }

    /// The axes in order.
    pub fn as_slice(&self) -> &[(Axis, Kind)] {
        &self.list[..self.len]
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.len
    }

    /// The name of axis `i`.
    pub fn name(&self, i: usize) -> Axis {
        self.list[i].0
    }

    /// The kind of axis `i`.
    pub fn kind(&self, i: usize) -> Kind {
        self.list[i].1
    }

    /// Where in the order an axis stands.
    pub fn index_of(&self, axis: Axis) -> Option<usize> {
        self.as_slice().iter().position(|(name, _)| *name == axis)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_a_letter_then_letters_or_digits() {
        assert_eq!(Axis::new("x1").unwrap().as_str(), "X1");
        assert!(Axis::new("1X").is_none() && Axis::new("").is_none() && Axis::new("ABCDE").is_none());
    }

    #[test]
    fn a_direction_stands_behind_the_tip() {
        let axes = Axes::with_direction();
        assert_eq!((axes.count(), axes.direction(), Axes::xyza().direction()), (6, Some(3), None));
        assert_eq!(axes.name(5).as_str(), "TZ");
    }

    #[test]
    fn no_axis_stands_twice() {
        let x = (Axis::new("X").unwrap(), Kind::Linear);
        assert!(Axes::new(&[x, x]).is_none());
        assert_eq!(Axes::xyza().index_of(Axis::new("A").unwrap()), Some(3));
    }
}
