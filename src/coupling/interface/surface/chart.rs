//! The chart of a slave facet: local coordinates of points of space, along the normals of the master.
//!
//! A point x with the master's normal n has the coordinates that minimise, over the closed cell,
//!
//! ```text
//! r·G r = |r - n (n·r)|² + (1 - s) (n·r)²,    r = x - x_s(xi),   G = I - s n nᵀ,
//! ```
//!
//! plus (JᵀGJ)⁻¹ JᵀG r, the linear step that the cell holds back. Inside, r is parallel to n: x is seen along the master's normal. The
//! share s falls from 1 to 0 where n is far from the facet's normal, so that the chart tends to the closest point and is defined
//! everywhere. It is 1 wherever a point of the facet may be opposed, within 60 degrees, unless the facet itself turns by more than 18
//! degrees: images along normals and closest points differ so much there that the chart folds where s falls. The differences are taken as written: rᵀr - s (n·r)² would lose half the digits across a gap. Nothing is evaluated
//! outside of the cell.

use super::facets::Facets;
use super::polygon::Polygon;
use crate::basis::Order;
use crate::geometry::MapTable;
use crate::linalg::{Matrix, Vector, inverse};

/// Steps of the iteration; near the facet it converges in three to six.
const STEPS: usize = 40;
/// A step after which the next one is below rounding.
const SQUARED: f64 = 1e-9;
/// Angles between the master's normal and that of a flat facet up to which s is 1, and from which on it is 0 \[degrees\]; they decrease by
/// the largest turn of the facet's normals.
const FLAT: [f64; 2] = [78.5, 87.0];
/// The least of these angles, of facets that turn much.
const TURNING: [f64; 2] = [49.5, 69.5];

/// The chart of one facet, with its work arrays.
pub(super) struct Chart<'a> {
    facets: &'a Facets<'a>,
    facet: usize,
    pub polygon: Polygon,
    pub affine: bool,
    /// Coordinates this near to a side are on it.
    pub snap: f64,
    center: Vector<2>,
    x: Vector<3>,
    jacobian: Matrix<3, 2>,
    normal: Vector<3>,
    /// Cosines between the master's and the facet's normal at which s is 0, and from which on it is 1.
    blend: [f64; 2],
    /// Linearised coordinates this far outside are not improved.
    far: f64,
    done: f64,
    is_pole: bool,
    table: MapTable<2, 3>,
}

/// The quadratic model of r·G r / 2 at a point of the facet.
struct Model {
    /// JᵀGJ.
    h: Matrix<2, 2>,
    /// JᵀG r.
    g: Vector<2>,
    /// r·G r.
    value: f64,
}

impl<'a> Chart<'a> {
    /// Rounding of coordinates that are found.
    pub fn rounding(&self) -> f64 {
        4.0 * self.done
    }

    /// The chart of a facet; `rounding`: that of the positions it is given \[length\].
    pub fn new(facets: &'a Facets<'a>, facet: usize, rounding: f64) -> Self {
        let own = &facets.list[facet];
        let (polygon, x, jacobian) = (own.polygon, own.x, own.jacobian);
        let center = polygon.center();
        let scale = 1.0 + own.rounding.max(rounding) / (f64::EPSILON * own.size);
        let [whole, none] = [0, 1].map(|k| (FLAT[k] - own.cone.to_degrees()).max(TURNING[k]).to_radians().cos());
        Self {
            facets,
            facet,
            polygon,
            affine: own.affine,
            snap: (60.0 * f64::EPSILON * scale).max(4e-14),
            center,
            x,
            jacobian,
            normal: own.normal,
            blend: [none, whole],
            far: 1.0 + 3.0 * own.bend,
            done: 4e-16 * scale,
            is_pole: own.pole,
            table: MapTable::new(),
        }
    }

    /// The share s for a normal of the master that points to the same side as the facet's.
    fn share(&self, n: &Vector<3>) -> f64 {
        let [none, whole] = self.blend;
        let t = ((n.dot(&self.normal) - none) / (whole - none)).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    }

    /// Coordinates of `x`, where the master has the unit normal `n`, of the facet's orientation; on a side within `snap`.
    pub fn pull(&mut self, x: &Vector<3>, n: &Vector<3>) -> Vector<2> {
        let found = self.pulled(x, n);
        let pole = Vector::<2>::new(0.0, 1.0);
        if self.is_pole && (found - pole).amax() <= self.snap.max(1e-12) {
            return pole;
        }
        self.polygon.snapped(&found, self.snap)
    }

    fn pulled(&mut self, x: &Vector<3>, n: &Vector<3>) -> Vector<2> {
        let s = self.share(n);
        let first = Model::at(&self.jacobian, &(x - self.x), n, s);
        let image = self.center + first.newton();
        if self.affine || self.polygon.depth(&image) < -self.far {
            return image;
        }
        let mut at = self.polygon.least(&self.center, &first.h, &first.g);
        let mut here = self.model(&at, x, n, s);
        let mut last = f64::INFINITY;
        for _ in 0..STEPS {
            let free = at + here.newton();
            // inside nothing is left of r·G r: steps square, and the next one would be rounding
            if (free - at).amax() <= SQUARED && self.polygon.depth(&free) >= 0.0 {
                return free;
            }
            let target = self.polygon.least(&at, &here.h, &here.g);
            let mut step = target - at;
            let length = step.amax();
            // round-off: steps no longer shrink
            if length <= self.done || (length < 1e-9 && length >= 0.5 * last) {
                break;
            }
            last = length;
            let mut next = target;
            let mut there = self.model(&next, x, n, s);
            while there.value > here.value && step.amax() > 1e-6 {
                step *= 0.5;
                next = at + step;
                there = self.model(&next, x, n, s);
            }
            (at, here) = (next, there);
        }
        at + here.newton()
    }

    fn model(&mut self, at: &Vector<2>, x: &Vector<3>, n: &Vector<3>, s: f64) -> Model {
        let (on, jacobian) = self.facets.one(self.facet, at, &mut self.table);
        Model::at(&jacobian, &(x - on), n, s)
    }

    /// Positions and Jacobians at points of the facet, in its coordinates.
    pub fn eval(&mut self, points: &[Vector<2>]) -> &MapTable<2, 3> {
        self.facets.at(self.facet, points, Order::Gradients, &mut self.table);
        &self.table
    }
}

impl Model {
    fn at(j: &Matrix<3, 2>, r: &Vector<3>, n: &Vector<3>, s: f64) -> Self {
        let (up, tilt) = (n.dot(r), j.tr_mul(n));
        let flat = r - n * up;
        let across = j - n * tilt.transpose();
        let rest = 1.0 - s;
        Self {
            h: across.tr_mul(&across) + tilt * tilt.transpose() * rest,
            g: across.tr_mul(&flat) + tilt * (rest * up),
            value: flat.norm_squared() + rest * up * up,
        }
    }

    /// The unconstrained step H⁻¹ g.
    fn newton(&self) -> Vector<2> {
        inverse(&self.h).map_or_else(Vector::zeros, |inv| inv * self.g)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::basis::BSpline;
    use crate::basis::TensorProduct;
    use crate::geometry::ControlPoints;

    /// A bilinear patch that is bent, as x = (u, v, 0.3 u v).
    fn bent() -> ControlPoints<TensorProduct<2, BSpline>, 3> {
        let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.3]];
        let line = || BSpline::uniform(1, 1, 0);
        ControlPoints { basis: TensorProduct::new([line(), line()]), points: points.map(Vector::from).to_vec() }
    }

    #[test]
    fn inside_a_point_is_seen_along_the_normal_that_is_given() {
        let map = bent();
        let facets = Facets::new(&map).unwrap();
        let mut chart = Chart::new(&facets, 0, 0.0);
        for (u, v) in [(0.2, 0.7), (0.5, 0.5), (0.99, 0.01), (0.0, 0.4), (1.0, 1.0)] {
            let on = Vector::<3>::new(u, v, 0.3 * u * v);
            for n in [[0.0, 0.0, 1.0], [0.3, -0.2, 0.9]] {
                let n = Vector::<3>::from(n).normalize();
                for gap in [0.0, 0.4, -0.3] {
                    let found = chart.pull(&(on + n * gap), &n);
                    assert!((found - Vector::<2>::new(u, v)).amax() < 2e-15, "{u} {v} {gap}: {found:?}");
                }
            }
        }
    }

    #[test]
    fn outside_is_outside_and_continuous() {
        let map = bent();
        let facets = Facets::new(&map).unwrap();
        let mut chart = Chart::new(&facets, 0, 0.0);
        let n = Vector::<3>::new(0.1, 0.2, 1.0).normalize();
        let mut last = chart.pull(&Vector::<3>::new(0.5, 0.5, 0.2), &n);
        for i in 1..=300 {
            let angle = f64::from(i) * 0.02;
            let x = Vector::<3>::new(0.5 + 1.2 * angle.cos(), 0.5 + 1.2 * angle.sin(), 0.2);
            let at = chart.pull(&x, &n);
            assert!(chart.polygon.depth(&at) < 0.0, "{x:?} {at:?}");
            assert!(i == 1 || (at - last).norm() < 0.1, "{x:?} {at:?} {last:?}");
            last = at;
        }
    }
}
