//! The obstacle within a distance of a line.

use super::obstacles::unit;
use super::{Hit, Obstacle};
use crate::linalg::{Real, Vector};

/// The points of space within `radius` of a line: a cylinder without ends.
///
/// With c a point of the axis, a its direction and d = x - c the normal and the gap at x are
///
/// ```text
/// r = d - (d . a) a,   n = r / |r|,   g = |r| - radius
/// ```
///
/// Points of the axis have no closest point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder<const N: usize, T: Real = f64> {
    center: Vector<N, T>,
    axis: Vector<N, T>,
    radius: T,
}

impl<const N: usize, T: Real> Cylinder<N, T> {
    /// The cylinder of `radius` \[length\] around the line through `center` along `axis` (any length); `None` if the axis is zero.
    pub fn try_new(center: Vector<N, T>, axis: Vector<N, T>, radius: T) -> Option<Self> {
        Some(Self { center, axis: unit(axis)?, radius })
    }
}

impl<const D: usize, const N: usize, T: Real> Obstacle<D, N, T> for Cylinder<N, T> {
    fn project(&self, x: &Vector<N, T>, _outward: &Vector<N, T>) -> Option<Hit<D, N, T>> {
        let away = x - self.center;
        let across = away - self.axis * away.dot(&self.axis);
        let normal = unit(across)?;
        let gap = across.norm() - self.radius;
        Some(Hit { x: x - normal * gap, normal, gap, at: None })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::contact::{HalfPlane, Sphere, opposed};

    fn point(x: [f64; 3]) -> Vector<3> {
        Vector::<3>::from(x)
    }

    #[test]
    fn the_gap_is_the_distance_from_the_axis_less_the_radius() {
        let cylinder = Cylinder::try_new(point([1.0, -2.0, 0.5]), point([0.0, 0.0, 3.0]), 0.75).unwrap();
        for (x, y, z) in [(2.0, -2.0, 9.0), (1.0, -1.0, -4.0), (1.1, -2.05, 0.0), (-3.0, 5.0, 1.0)] {
            let (dx, dy) = (x - 1.0, y + 2.0);
            let r = f64::hypot(dx, dy);
            let hit: Hit<2, 3> = cylinder.project(&point([x, y, z]), &point([-dx / r, -dy / r, 0.0])).unwrap();
            let wanted = point([1.0 + 0.75 * dx / r, -2.0 + 0.75 * dy / r, z]);
            assert!((hit.gap - (r - 0.75)).abs() < 1e-14 && (hit.x - wanted).norm() < 1e-14);
            assert!((hit.normal - point([dx / r, dy / r, 0.0])).norm() < 1e-14 && hit.at.is_none());
        }
        let on_axis: Option<Hit<2, 3>> = cylinder.project(&point([1.0, -2.0, 7.0]), &point([1.0, 0.0, 0.0]));
        assert!(on_axis.is_none());
        assert!(Cylinder::try_new(Vector::<3>::zeros(), Vector::zeros(), 1.0).is_none());
    }

    /// In the plane across the axis it is a circle; seen from near it is its tangent plane.
    #[test]
    fn it_is_a_circle_across_its_axis_and_a_plane_from_near() {
        let axis = point([1.0, 2.0, -0.5]);
        let center = point([0.3, 0.1, 0.2]);
        let cylinder = Cylinder::try_new(center, axis, 2.0).unwrap();
        let sphere = Sphere { center, radius: 2.0, inside: false };
        let across = unit(axis.cross(&point([0.0, 0.0, 1.0]))).unwrap();
        for distance in [0.5, 1.9, 2.0, 3.0] {
            let x = center + across * distance;
            let [a, b]: [Hit<2, 3>; 2] = [&cylinder as &dyn Obstacle<2, 3>, &sphere].map(|o| o.project(&x, &-across).unwrap());
            assert!((a.gap - b.gap).abs() < 1e-14 && (a.x - b.x).norm() < 1e-14 && (a.normal - b.normal).norm() < 1e-14);
        }
        let plane = HalfPlane::try_new(center + across * 2.0, across).unwrap();
        let x = center + across * 2.01 + axis * 5.0;
        let [a, b]: [Hit<2, 3>; 2] = [&cylinder as &dyn Obstacle<2, 3>, &plane].map(|o| o.project(&x, &-across).unwrap());
        assert!((a.gap - b.gap).abs() < 1e-13 && (a.normal - b.normal).norm() < 1e-13);
    }

    #[test]
    fn it_faces_what_opposes_it() {
        let cylinder = Cylinder::try_new(point([0.1, 0.2, 0.0]), point([0.2, -0.3, 1.0]), 0.8).unwrap();
        // a slave that looks away from it, or along it
        let x = point([2.0, 0.2, 0.0]);
        for (outward, faced) in [([-1.0, 0.0, 0.0], true), ([1.0, 0.0, 0.0], false), ([0.0, 0.0, 1.0], false)] {
            assert_eq!(opposed::<2, 3, f64>(&cylinder, &x, &point(outward)).is_some(), faced, "{outward:?}");
        }
    }
}
