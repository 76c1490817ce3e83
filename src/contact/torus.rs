//! The obstacle within a distance of a circle.

use super::obstacles::unit;
use super::{Hit, Obstacle, opposes};
use crate::linalg::{Real, Vector};

/// The points of space within `tube` of a circle: a ring.
///
/// With c the centre of the circle of radius R, a its axis, d = x - c and e = (d - (d . a) a) / |..| the direction of x across the axis, the
/// circle comes nearest to x in q = c + R e, and
///
/// ```text
/// n = (x - q) / |x - q|,   g = |x - q| - tube
/// ```
///
/// What does not face the near part of the ring may face the far one, q = c - R e: a body in the hole that looks across it. From points of
/// the axis, for which no part is nearer, the part is seen towards which the slave looks. Points of the circle have no closest point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torus<const N: usize, T: Real = f64> {
    center: Vector<N, T>,
    axis: Vector<N, T>,
    circle: T,
    tube: T,
}

impl<const N: usize, T: Real> Torus<N, T> {
    /// The ring of the radius `tube` around the circle of radius `circle` \[length\] about `center`, in the plane across `axis` (any length);
    /// `None` if the axis is zero, or the tube is not thinner than the circle.
    pub fn try_new(center: Vector<N, T>, axis: Vector<N, T>, circle: T, tube: T) -> Option<Self> {
        (tube < circle).then_some(Self { center, axis: unit(axis)?, circle, tube })
    }

    /// The closest point of the tube around the point of the circle in the direction `across`.
    fn around<const D: usize>(&self, x: &Vector<N, T>, across: &Vector<N, T>) -> Option<Hit<D, N, T>> {
        let away = x - (self.center + across * self.circle);
        let normal = unit(away)?;
        let gap = away.norm() - self.tube;
        Some(Hit { x: x - normal * gap, normal, gap, at: None })
    }
}

impl<const D: usize, const N: usize, T: Real> Obstacle<D, N, T> for Torus<N, T> {
    fn project(&self, x: &Vector<N, T>, outward: &Vector<N, T>) -> Option<Hit<D, N, T>> {
        let across = |v: Vector<N, T>| unit(v - self.axis * v.dot(&self.axis));
        let near = across(x - self.center).or_else(|| across(*outward))?;
        let hit = self.around(x, &near);
        if hit.as_ref().is_some_and(|hit| opposes(outward, &hit.normal)) {
            return hit;
        }
        self.around(x, &-near).filter(|far: &Hit<D, N, T>| opposes(outward, &far.normal)).or(hit)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::contact::{Cylinder, opposed};

    fn point(x: [f64; 3]) -> Vector<3> {
        Vector::<3>::from(x)
    }

    /// (x, y, z) on the torus about the origin: ((R + r cos t) cos s, (R + r cos t) sin s, r sin t).
    fn on_surface(circle: f64, tube: f64, s: f64, t: f64) -> (Vector<3>, Vector<3>) {
        let normal = point([t.cos() * s.cos(), t.cos() * s.sin(), t.sin()]);
        (point([circle * s.cos(), circle * s.sin(), 0.0]) + normal * tube, normal)
    }

    #[test]
    fn points_off_the_surface_come_back_along_its_normal() {
        let torus = Torus::try_new(Vector::<3>::zeros(), point([0.0, 0.0, -2.0]), 2.0, 0.5).unwrap();
        for k in 0..40 {
            let (s, t) = (0.7 * k as f64, 1.9 * k as f64);
            let (foot, normal) = on_surface(2.0, 0.5, s, t);
            for gap in [-0.4, -1e-3, 0.0, 0.3, 1.2] {
                let hit: Hit<2, 3> = torus.project(&(foot + normal * gap), &-normal).unwrap();
                assert!((hit.gap - gap).abs() < 1e-13 && (hit.x - foot).norm() < 1e-13, "{k} {gap}: {hit:?}");
                assert!((hit.normal - normal).norm() < 1e-12);
            }
        }
        assert!(Torus::try_new(Vector::<3>::zeros(), point([0.0, 0.0, 1.0]), 1.0, 1.0).is_none());
        assert!(Torus::try_new(Vector::<3>::zeros(), Vector::zeros(), 1.0, 0.5).is_none());
    }

    /// A large ring is a cylinder from near.
    #[test]
    fn a_large_ring_is_a_cylinder_from_near() {
        let large = 1e6;
        let torus = Torus::try_new(point([-large, 0.0, 0.0]), point([0.0, 0.0, 1.0]), large, 0.5).unwrap();
        let cylinder = Cylinder::try_new(Vector::<3>::zeros(), point([0.0, 1.0, 0.0]), 0.5).unwrap();
        let x = point([0.6, 0.3, 0.2]);
        let outward = -point([0.6, 0.0, 0.2]) / f64::hypot(0.6, 0.2);
        let [a, b]: [Hit<2, 3>; 2] = [&torus as &dyn Obstacle<2, 3>, &cylinder].map(|o| o.project(&x, &outward).unwrap());
        assert!((a.gap - b.gap).abs() < 1e-6 && (a.normal - b.normal).norm() < 1e-6);
    }

    /// In the hole the wall that the slave looks at counts, not the one behind it.
    #[test]
    fn a_body_in_the_hole_faces_the_wall_that_it_looks_at() {
        let torus = Torus::try_new(Vector::<3>::zeros(), point([0.0, 0.0, 1.0]), 2.0, 0.5).unwrap();
        for (x, gap) in [(-0.2, 1.7), (0.0, 1.5), (0.2, 1.3)] {
            let hit = opposed::<2, 3, f64>(&torus, &point([x, 0.0, 0.0]), &point([1.0, 0.0, 0.0])).unwrap();
            assert!((hit.gap - gap).abs() < 1e-14 && (hit.x - point([1.5, 0.0, 0.0])).norm() < 1e-14, "{hit:?}");
        }
        assert!(opposed::<2, 3, f64>(&torus, &point([0.1, 0.0, 0.0]), &point([0.0, 0.0, 1.0])).is_none());
        // the circle itself has no closest point
        assert!(Obstacle::<2, 3>::project(&torus, &point([2.0, 0.0, 0.0]), &point([0.0, 0.0, 1.0])).is_none());
    }
}
