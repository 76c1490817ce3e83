//! Elements of several maps as one map.

use crate::basis::{Cell, Elements, Order};
use crate::geometry::{Bounds, Geometry, MapTable};
use crate::linalg::{Real, Vector};

/// Elements one after another, each with its map (a reference, a box or an `Arc`) and its number there.
///
/// Their connectivity follows from the coordinates of their ends.
#[derive(Clone, Debug)]
pub(super) struct Several<G> {
    pub elements: Vec<(G, usize)>,
}

impl<G: Elements> Elements for Several<G> {
    fn num_elements(&self) -> usize {
        self.elements.len()
    }
    fn cell(&self, element: usize) -> Cell {
        let (map, own) = &self.elements[element];
        map.cell(*own)
    }
}

impl<const D: usize, const N: usize, T: Real, G: Geometry<D, N, T>> Geometry<D, N, T> for Several<G> {
    fn map(&self, element: usize, xi: &[Vector<D, T>], order: Order, table: &mut MapTable<D, N, T>) {
        let (map, own) = &self.elements[element];
        map.map(*own, xi, order, table);
    }
    fn bounds(&self, element: usize) -> Bounds<N, T> {
        let (map, own) = &self.elements[element];
        map.bounds(*own)
    }
}
