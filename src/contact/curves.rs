//! Elements of several curves as one curve.

use crate::basis::{Cell, Elements, Order};
use crate::geometry::{Bounds, Geometry, MapTable};
use crate::linalg::{Real, Vector};

/// Elements one after another, each with its curve (a reference, a box or an `Arc`) and its number there.
///
/// Their connectivity follows from the coordinates of their ends.
#[derive(Clone, Debug)]
pub(super) struct Curves<G> {
    pub elements: Vec<(G, usize)>,
}

impl<G: Elements> Elements for Curves<G> {
    fn num_elements(&self) -> usize {
        self.elements.len()
    }
    fn cell(&self, element: usize) -> Cell {
        let (curve, own) = &self.elements[element];
        curve.cell(*own)
    }
}

impl<const N: usize, T: Real, G: Geometry<1, N, T>> Geometry<1, N, T> for Curves<G> {
    fn map(&self, element: usize, xi: &[Vector<1, T>], order: Order, table: &mut MapTable<1, N, T>) {
        let (curve, own) = &self.elements[element];
        curve.map(*own, xi, order, table);
    }
    fn bounds(&self, element: usize) -> Bounds<N, T> {
        let (curve, own) = &self.elements[element];
        curve.bounds(*own)
    }
}
