//! A space in its deformed configuration.

use super::Space;
use crate::basis::{Basis, BasisStructure, Cell, Elements, Order, Polynomials, ShapeTable};
use crate::geometry::{Bounds, Geometry, MapTable, hull};
use crate::linalg::{Real, Vector};

/// The functions of a space over the deformed map x + u, u = sum_i N_i u_i.
#[derive(Clone, Debug)]
pub struct Deformed<X, const N: usize, T: Real = f64> {
    /// The undeformed space.
    pub space: X,
    /// One displacement per function \[length\].
    pub u: Vec<Vector<N, T>>,
}

impl<X: Elements, const N: usize, T: Real> Elements for Deformed<X, N, T> {
    fn num_elements(&self) -> usize {
        self.space.num_elements()
    }
    fn cell(&self, element: usize) -> Cell {
        self.space.cell(element)
    }
    fn corners(&self, element: usize, ids: &mut Vec<usize>) {
        self.space.corners(element, ids);
    }
}

impl<X: Basis<D, T>, const D: usize, const N: usize, T: Real> Basis<D, T> for Deformed<X, N, T> {
    fn num_functions(&self) -> usize {
        self.space.num_functions()
    }
    fn degree(&self, element: usize) -> [usize; D] {
        self.space.degree(element)
    }
    fn active(&self, element: usize, ids: &mut Vec<usize>) {
        self.space.active(element, ids);
    }
    fn tabulate(&self, element: usize, xi: &[Vector<D, T>], order: Order, table: &mut ShapeTable<D, T>) {
        self.space.tabulate(element, xi, order, table);
    }
    fn structure(&self) -> &dyn BasisStructure<D, T> {
        self.space.structure()
    }
    fn polynomials(&self, wanted: Polynomials) -> Option<Box<dyn Basis<D, T>>> {
        self.space.polynomials(wanted)
    }
}

impl<X: Space<D, N, T>, const D: usize, const N: usize, T: Real> Geometry<D, N, T> for Deformed<X, N, T> {
    fn map(&self, element: usize, xi: &[Vector<D, T>], order: Order, table: &mut MapTable<D, N, T>) {
        let mut shapes = ShapeTable::new();
        self.evaluate(element, xi, order, &mut shapes, table);
    }

    fn bounds(&self, element: usize) -> Bounds<N, T> {
        let at_rest = self.space.bounds(element);
        match hull(&self.space, element, |i| self.u[i]) {
            Some(u) => Bounds { lo: at_rest.lo + u.lo, hi: at_rest.hi + u.hi },
            None => at_rest,
        }
    }
}

impl<X: Space<D, N, T>, const D: usize, const N: usize, T: Real> Space<D, N, T> for Deformed<X, N, T> {
    fn evaluate(&self, element: usize, xi: &[Vector<D, T>], order: Order, shapes: &mut ShapeTable<D, T>, map: &mut MapTable<D, N, T>) {
        self.space.evaluate(element, xi, order, shapes, map);
        let mut ids = std::mem::take(&mut map.ids);
        self.space.active(element, &mut ids);
        for q in 0..xi.len() {
            for (a, &i) in ids.iter().enumerate() {
                let u = &self.u[i];
                map.x[q] += u * shapes.values(q)[a];
                if order >= Order::Gradients {
                    map.jacobian[q] += u * shapes.grads(q)[a].transpose();
                }
                if order >= Order::Hessians {
                    for c in 0..N {
                        map.hessian[q][c] += shapes.hessians(q)[a] * u[c];
                    }
                }
            }
        }
        map.ids = ids;
    }
}
