//! Sets of directions in the plane.

use std::f64::consts::PI;

/// Round-off of angles.
const ANGLE: f64 = 1e-6;

/// A set of directions in the plane: angles up to `half` from `middle`; all of them from `half` = pi on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cone {
    middle: f64,
    half: f64,
}

/// The angle in [-pi, pi).
pub(super) fn turn(angle: f64) -> f64 {
    angle - 2.0 * PI * ((angle + PI) / (2.0 * PI)).floor()
}

impl Cone {
    pub const ALL: Self = Self { middle: 0.0, half: PI };

    /// The angles from `lo` to `hi`.
    pub fn between(lo: f64, hi: f64) -> Self {
        let half = 0.5 * (hi - lo);
        if half < PI { Self { middle: turn(0.5 * (lo + hi)), half } } else { Self::ALL }
    }

    /// A cone around both.
    #[must_use]
    pub fn join(self, other: Self) -> Self {
        let apart = turn(other.middle - self.middle);
        let (lo, hi) = ((-self.half).min(apart - other.half), self.half.max(apart + other.half));
        Self::between(self.middle + lo, self.middle + hi)
    }

    /// Whether a direction lies within `more` of the cone.
    pub fn holds(&self, angle: f64, more: f64) -> bool {
        turn(angle - self.middle).abs() <= self.half + more + ANGLE
    }
}
