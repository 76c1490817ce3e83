//! A map with the outward signs of its elements.

use super::{Bounds, Geometry, MapStructure, MapTable};
use crate::basis::{Cell, Elements, Order};
use crate::linalg::{Real, Vector};

/// The map of a side (a reference, a box or an `Arc` will do) and the side on which its body lies.
#[derive(Clone, Debug)]
pub struct Oriented<G, T: Real = f64> {
    /// The map.
    pub map: G,
    /// +1 or -1 per element: times the cross product of its tangents it points out of the body.
    pub outward: Vec<T>,
}

impl<G: Elements, T: Real> Elements for Oriented<G, T> {
    fn num_elements(&self) -> usize {
        self.map.num_elements()
    }
    fn cell(&self, element: usize) -> Cell {
        self.map.cell(element)
    }
    fn corners(&self, element: usize, ids: &mut Vec<usize>) {
        self.map.corners(element, ids);
    }
}

impl<const D: usize, const N: usize, T: Real, G: Geometry<D, N, T>> Geometry<D, N, T> for Oriented<G, T> {
    fn map(&self, element: usize, xi: &[Vector<D, T>], order: Order, table: &mut MapTable<D, N, T>) {
        self.map.map(element, xi, order, table);
    }
    fn bounds(&self, element: usize) -> Bounds<N, T> {
        self.map.bounds(element)
    }
    fn all_bounds(&self) -> Vec<Bounds<N, T>> {
        self.map.all_bounds()
    }
    fn extent(&self) -> Option<Bounds<N, T>> {
        self.map.extent()
    }
    fn outward(&self, element: usize) -> Option<T> {
        self.outward.get(element).copied()
    }
    fn map_structure(&self) -> &dyn MapStructure<D, N, T> {
        self.map.map_structure()
    }
}
