//! Sets of directions in space.

use crate::linalg::Vector;
use std::f64::consts::PI;

/// Round-off of angles \[rad\].
const ANGLE: f64 = 1e-6;

/// Directions up to the angle `half` from `axis`; all of them from `half` = pi on.
#[derive(Clone, Copy, Debug)]
pub(super) struct NormalCone {
    axis: Vector<3>,
    half: f64,
}

/// The angle between two vectors \[rad\].
pub(super) fn angle(a: &Vector<3>, b: &Vector<3>) -> f64 {
    a.cross(b).norm().atan2(a.dot(b))
}

impl NormalCone {
    /// A cone around unit vectors, and `more` beyond them \[rad\].
    pub fn around(normals: &[Vector<3>], more: f64) -> Self {
        let axis = normals.iter().sum::<Vector<3>>();
        let half = normals.iter().map(|n| angle(&axis, n)).fold(0.0, f64::max) + more;
        Self { axis, half: if axis.norm() > 0.0 { half } else { PI } }
    }

    /// A cone around both.
    #[must_use]
    pub fn join(self, other: Self) -> Self {
        let apart = angle(&self.axis, &other.axis);
        if self.half >= PI || apart + other.half <= self.half {
            return self;
        }
        if other.half >= PI || apart + self.half <= other.half {
            return other;
        }
        let half = (self.half + apart + other.half) / 2.0;
        let (a, b) = (self.axis.normalize(), other.axis.normalize());
        let across = b - a * a.dot(&b);
        if across.norm() <= ANGLE {
            return Self { axis: a, half: if apart < 1.0 { half + ANGLE } else { PI } };
        }
        let (s, c) = (half - self.half).sin_cos();
        Self { axis: a * c + across.normalize() * s, half }
    }

    /// Whether a direction lies within `more` of the cone \[rad\].
    pub fn holds(&self, direction: &Vector<3>, more: f64) -> bool {
        self.half >= PI || angle(&self.axis, direction) <= self.half + more + ANGLE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cones_hold_what_they_were_made_of() {
        let unit = |k: usize| Vector::<3>::new((1.3 * k as f64).sin(), (0.7 * k as f64 + 1.0).cos(), (2.1 * k as f64).sin()).normalize();
        for k in 0..60 {
            let parts = [[unit(k), unit(k + 1)], [unit(k + 2), unit(k + 5)]];
            let cones = parts.each_ref().map(|p| NormalCone::around(p, 0.05));
            let both = cones[0].join(cones[1]);
            for n in parts.iter().flatten() {
                assert!(both.holds(n, 0.0), "{k}");
            }
        }
        let narrow = NormalCone::around(&[Vector::<3>::z()], 0.1);
        assert!(!narrow.holds(&Vector::<3>::x(), 1.0) && narrow.holds(&Vector::<3>::x(), 1.5));
        let all = narrow.join(NormalCone::around(&[-Vector::<3>::z()], 0.1));
        assert!(all.holds(&Vector::<3>::x(), 0.0) && all.holds(&Vector::<3>::y(), 0.0));
    }
}
