//! What the axes can do.
//!
//! **A trapezoid**, the fastest way over a distance s from stand to stand at speed F and acceleration a:
//!
//! ```text
//! s ≥ F²/a:   t = s/F + F/a          s < F²/a:   t = 2√(s/a)
//! ```

use crate::machine::Machine;
use crate::units::{Axes, MAX_AXES};

/// What each axis can do, in mm or degrees and seconds; infinite where nothing is said.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// mm/s.
    pub speed: [f64; MAX_AXES],
    /// mm/s².
    pub acceleration: [f64; MAX_AXES],
    /// The step in speed that is allowed at a joint, mm/s.
    pub step: [f64; MAX_AXES],
}

impl Limits {
    /// No limits.
    pub const NONE: Limits = Limits {
        speed: [f64::INFINITY; MAX_AXES],
        acceleration: [f64::INFINITY; MAX_AXES],
        step: [f64::INFINITY; MAX_AXES],
    };

    /// Those of a machine; where no step is said, what the axis' acceleration does in one cycle of `cycle` s.
    pub fn of(machine: &Machine, axes: &Axes, cycle: f64) -> Limits {
        let mut limits = Limits::NONE;
        for i in 0..axes.count() {
            let own = machine.limits(axes.name(i));
            limits.speed[i] = own.max_speed.map_or(f64::INFINITY, |speed| speed / 60.0);
            limits.acceleration[i] = own.max_acceleration.unwrap_or(f64::INFINITY);
            limits.step[i] = own.max_step.map_or(limits.acceleration[i] * cycle, |step| step / 60.0);
        }
        limits
    }

    /// Whether there is any.
    pub fn any(&self) -> bool {
        *self != Limits::NONE
    }

    /// How long a rapid takes, s: each axis on its own as fast as it can. None where a speed or a distance is not known.
    pub fn rapid(&self, moves: &[(usize, Option<f64>)]) -> Option<f64> {
        let mut longest = 0.0f64;
        for (axis, distance) in moves {
            let distance = (*distance)?;
            if distance == 0.0 {
                continue;
            }
            if self.speed[*axis].is_infinite() {
                return None;
            }
            longest = longest.max(trapezoid(distance, self.speed[*axis], self.acceleration[*axis]));
        }
        Some(longest)
    }
}

/// The time of a trapezoid, s.
pub fn trapezoid(distance: f64, speed: f64, acceleration: f64) -> f64 {
    if acceleration.is_infinite() {
        distance / speed
    } else if speed * speed / acceleration <= distance {
        distance / speed + speed / acceleration
    } else {
        2.0 * (distance / acceleration).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rapid_takes_as_long_as_its_slowest_axis() {
        let mut limits = Limits::NONE;
        (limits.speed[0], limits.speed[1]) = (100.0, 100.0);
        (limits.acceleration[0], limits.acceleration[1]) = (1000.0, 1000.0);
        // 50 mm: 0.5 s + 0.1 s; 2.5 mm never reach 100 mm/s: 2√(0.0025).
        assert_eq!(limits.rapid(&[(0, Some(50.0)), (1, Some(2.5))]), Some(0.6));
        assert_eq!(limits.rapid(&[(1, Some(2.5))]), Some(0.1));
        assert_eq!(limits.rapid(&[(2, Some(2.5))]), None);
        assert_eq!(limits.rapid(&[(2, Some(0.0))]), Some(0.0));
        assert_eq!(limits.rapid(&[(0, None)]), None);
    }
}
