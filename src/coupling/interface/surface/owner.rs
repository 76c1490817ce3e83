//! The master surface for many queries: candidates near a facet, the element of the closest point, feet on continued facets.

use super::facets::Facets;
use super::polygon::Polygon;
use super::skeleton::Skeleton;
use crate::basis::Order;
use crate::coupling::CouplingError;
use crate::geometry::{Bounds, ClosestPoint, Geometry, MapTable, Projection, foot_step, unit_normal};
use crate::linalg::{Matrix, Vector, inverse};
use crate::parallel;

/// Newton steps of a foot; quadratic convergence needs about five.
const FOOT_STEPS: usize = 30;
/// A step after which the next one is below rounding, where steps square.
const SQUARED: f64 = 1e-9;
/// Distance to a facet, as a share of its size, at which second derivatives do not matter.
const TOUCHES: f64 = 1e-7;
/// A foot this far outside of its cell is tried again from other starts.
const FAR_OUTSIDE: f64 = 1e-3;
/// Closest points this near to the boundary of their cell, in local coordinates, are on it.
const AT_EDGE: f64 = 1e-9;

/// Facets, skeleton and closest points of the master.
#[derive(Debug)]
pub(super) struct MasterSurface<'a> {
    pub facets: Facets<'a>,
    pub skeleton: Skeleton,
    closest: ClosestPoint<2, 3, &'a dyn Geometry<2, 3>>,
}

/// A foot: local coordinates on the continued facet and the point there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Foot {
    pub eta: Vector<2>,
    pub x: Vector<3>,
    /// Whether Newton's method ended at a foot.
    pub found: bool,
}

impl<'a> MasterSurface<'a> {
    pub fn new(map: &'a dyn Geometry<2, 3>) -> Result<Self, CouplingError> {
        let facets = Facets::new(map)?;
        let (skeleton, closest) = parallel::both(|| Skeleton::new(&facets), || ClosestPoint::new(map));
        Ok(Self { facets, skeleton, closest })
    }

    /// The closest point.
    pub fn project(&self, x: &Vector<3>) -> Option<Projection<2, 3>> {
        self.closest.project(x)
    }

    /// The closest point, without its `rim`.
    pub fn nearest(&self, x: &Vector<3>) -> Option<Projection<2, 3>> {
        self.closest.project_anywhere(x)
    }

    /// Facets of elements whose boxes meet `bounds`, in ascending order.
    pub fn candidates(&self, bounds: &Bounds<3>) -> Vec<usize> {
        self.closest.tree().meeting(bounds).into_iter().flat_map(|e| self.facets.of(e)).collect()
    }

    /// Whether the closest point of `x` lies on facet `f` or on one that shares a vertex with it.
    pub fn owns(&self, f: usize, x: &Vector<3>) -> bool {
        let Some(hit) = self.nearest(x) else { return false };
        let holding = self.facets.of(hit.element).filter(|&g| self.facets.list[g].holds(&hit.xi));
        let own = &self.skeleton.corners[f];
        holding.into_iter().any(|g| g == f || self.skeleton.corners[g].iter().any(|v| *v != usize::MAX && own.contains(v)))
    }

    /// The facets that hold a closest point, with its coordinates there: one, or at an edge or a vertex several, that of its element first.
    pub fn holding(&self, hit: &Projection<2, 3>, table: &mut MapTable<2, 3>) -> Vec<(usize, Vector<2>)> {
        let Some(own) = self.facets.of(hit.element).find(|&f| self.facets.list[f].holds(&hit.xi)) else { return Vec::new() };
        let at = self.facets.list[own].seen(&hit.xi);
        let mut found = vec![(own, at)];
        if self.facets.list[own].polygon.depth(&at) <= AT_EDGE {
            let near = Bounds { lo: hit.x, hi: hit.x }.inflated(AT_EDGE * self.facets.list[own].size);
            for f in self.candidates(&near).into_iter().filter(|&f| f != own) {
                let foot = self.newton(f, &[hit.x], &mut [self.started(f, &hit.x)], Order::Gradients, table)[0];
                let facet = &self.facets.list[f];
                if (foot.x - hit.x).norm() <= AT_EDGE * facet.size && facet.polygon.depth(&foot.eta) >= -AT_EDGE {
                    found.push((f, foot.eta));
                }
            }
        }
        found
    }

    /// The facet that holds the closest point of `x`, and the foot on it, continued beyond its cell; `None` beyond a rim. Of several
    /// facets at an edge or a vertex the one whose normal is nearest to the line to `x`.
    pub fn place(&self, x: &Vector<3>, table: &mut MapTable<2, 3>) -> Option<(usize, Foot)> {
        let hit = self.project(x).filter(|hit| !hit.rim)?;
        let (line, holding) = (x - hit.x, self.holding(&hit, table));
        let (mut owner, mut best) = (*holding.first()?, f64::NEG_INFINITY);
        if holding.len() > 1 {
            for at in holding {
                self.facets.at(at.0, &[at.1], Order::Gradients, table);
                let along = line.dot(&unit_normal(&table.jacobian[0], 1.0)).abs();
                if along > best + AT_EDGE * line.norm() {
                    (owner, best) = (at, along);
                }
            }
        }
        let foot = self.newton(owner.0, &[*x], &mut [owner.1], Order::Hessians, table)[0];
        Some((owner.0, foot))
    }

    /// The linearised coordinates of `x` on facet `f`, within one cell of it.
    fn started(&self, f: usize, x: &Vector<3>) -> Vector<2> {
        let facet = &self.facets.list[f];
        self.limited(f, facet.polygon.center() + facet.back * (x - facet.x))
    }

    /// Puts into `feet` those of `x` on the continued facet `f`: Jᵀ(x - x_m(eta)) = 0 with eta within one cell of the facet, started about
    /// that of `center`.
    pub fn feet(&self, f: usize, center: &Vector<3>, x: &[Vector<3>], feet: &mut Vec<Foot>, table: &mut MapTable<2, 3>) {
        feet.clear();
        let facet = &self.facets.list[f];
        if facet.affine {
            let on = |eta: Vector<2>| Foot { eta, x: facet.x + facet.jacobian * (eta - facet.polygon.center()), found: true };
            feet.extend(x.iter().map(|x| on(self.started(f, x))));
            return;
        }
        let middle = self.newton(f, &[*center], &mut [self.started(f, center)], Order::Hessians, table)[0];
        self.facets.at(f, &[middle.eta], Order::Gradients, table);
        let j = table.jacobian[0];
        let back: Matrix<2, 3> = inverse(&j.tr_mul(&j)).unwrap_or_else(Matrix::zeros) * j.transpose();
        let mut eta: Vec<Vector<2>> = x.iter().map(|x| self.limited(f, middle.eta + back * (x - center))).collect();
        // what touches needs no second derivatives
        let order = if (middle.x - center).norm() <= TOUCHES * facet.size { Order::Gradients } else { Order::Hessians };
        feet.extend(self.newton(f, x, &mut eta, order, table));
    }

    fn newton(&self, f: usize, x: &[Vector<3>], eta: &mut [Vector<2>], order: Order, table: &mut MapTable<2, 3>) -> Vec<Foot> {
        let mut feet = self.iterate(f, x, eta, order, table);
        let polygon = self.facets.list[f].polygon;
        for (foot, x) in feet.iter_mut().zip(x) {
            if foot.found && polygon.depth(&foot.eta) >= -FAR_OUTSIDE {
                continue;
            }
            let seeds = polygon.grid(3);
            let tried = self.iterate(f, &vec![*x; seeds.len()], &mut seeds.clone(), Order::Hessians, table);
            let key = |foot: &Foot| (polygon.depth(&foot.eta) >= -FAR_OUTSIDE, -(foot.x - x).norm());
            for other in tried.into_iter().filter(|t| t.found) {
                if !foot.found || key(&other) > key(foot) {
                    *foot = other;
                }
            }
        }
        feet
    }

    /// Newton's method for all points at once, without second derivatives for `Order::Gradients`.
    fn iterate(&self, f: usize, x: &[Vector<3>], eta: &mut [Vector<2>], order: Order, table: &mut MapTable<2, 3>) -> Vec<Foot> {
        let mut feet: Vec<Foot> = eta.iter().map(|eta| Foot { eta: *eta, x: Vector::zeros(), found: false }).collect();
        let mut last = f64::INFINITY;
        for _ in 0..FOOT_STEPS {
            self.facets.at(f, eta, order, table);
            let (mut largest, mut squares) = (0.0f64, true);
            for (q, eta) in eta.iter_mut().enumerate() {
                let (r, j) = (x[q] - table.x[q], table.jacobian[q]);
                let (step, newton) = foot_step(&r, &j, table.hessian.get(q));
                let next = self.limited(f, *eta + step);
                let moved = next - *eta;
                feet[q] = Foot { eta: next, x: table.x[q] + j * moved, found: step.amax() <= 1e-8 };
                (largest, squares, *eta) = (largest.max(moved.amax()), squares && (newton || r.norm() <= TOUCHES * j.norm()), next);
            }
            // the next step would be below rounding, or steps no longer shrink
            if largest <= if squares { SQUARED } else { 4.0 * f64::EPSILON } || (largest < 1e-10 && largest >= last) {
                break;
            }
            last = largest;
        }
        feet
    }

    /// Coordinates within one cell of the facet, and not beyond a pole.
    fn limited(&self, f: usize, eta: Vector<2>) -> Vector<2> {
        let eta = eta.map(|v| v.clamp(-1.0, 2.0));
        let facet = &self.facets.list[f];
        match facet.polygon {
            Polygon::Triangle if facet.pole => Vector::<2>::new(eta[0], eta[1].min(1.0)),
            _ => eta,
        }
    }
}
