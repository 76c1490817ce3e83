//! Spaces without some of their structure, and how far two matrices are apart.
#![allow(dead_code)]

use faying::basis::{Basis, BasisStructure, Cell, Elements, Order, ShapeTable};
use faying::geometry::{Bounds, Control, Geometry, MapStructure, MapTable};
use faying::linalg::{Csr, Vector};
use faying::space::Space;

/// Hides patches, reference cells and the structure of the map: what is assembled takes the plain loop.
#[derive(Debug)]
pub struct Plain<'a, const N: usize>(pub &'a dyn Space<N, N>);
impl<const N: usize> Elements for Plain<'_, N> {
    fn num_elements(&self) -> usize {
        self.0.num_elements()
    }
    fn cell(&self, element: usize) -> Cell {
        self.0.cell(element)
    }
}
impl<const N: usize> Basis<N> for Plain<'_, N> {
    fn num_functions(&self) -> usize {
        self.0.num_functions()
    }
    fn degree(&self, element: usize) -> [usize; N] {
        self.0.degree(element)
    }
    fn active(&self, element: usize, ids: &mut Vec<usize>) {
        self.0.active(element, ids);
    }
    fn tabulate(&self, element: usize, xi: &[Vector<N>], order: Order, table: &mut ShapeTable<N>) {
        self.0.tabulate(element, xi, order, table);
    }
}
impl<const N: usize> Geometry<N, N> for Plain<'_, N> {
    fn map(&self, element: usize, xi: &[Vector<N>], order: Order, table: &mut MapTable<N, N>) {
        self.0.map(element, xi, order, table);
    }
    fn bounds(&self, element: usize) -> Bounds<N> {
        self.0.bounds(element)
    }
}
impl<const N: usize> Space<N, N> for Plain<'_, N> {}

/// A space with its cells and its map, but with its functions in another order and no list of them.
#[derive(Debug)]
pub struct Renumbered<'a, const N: usize> {
    space: Plain<'a, N>,
    number: Vec<usize>,
}
impl<'a, const N: usize> Renumbered<'a, N> {
    /// Function i of `space` gets `number[i]`.
    pub fn new(space: &'a dyn Space<N, N>, number: Vec<usize>) -> Self {
        Self { space: Plain(space), number }
    }
}
impl<const N: usize> Elements for Renumbered<'_, N> {
    fn num_elements(&self) -> usize {
        self.space.num_elements()
    }
    fn cell(&self, element: usize) -> Cell {
        self.space.cell(element)
    }
}
impl<const N: usize> Basis<N> for Renumbered<'_, N> {
    fn num_functions(&self) -> usize {
        self.space.num_functions()
    }
    fn degree(&self, element: usize) -> [usize; N] {
        self.space.degree(element)
    }
    fn active(&self, element: usize, ids: &mut Vec<usize>) {
        self.space.active(element, ids);
        ids.iter_mut().for_each(|i| *i = self.number[*i]);
    }
    fn tabulate(&self, element: usize, xi: &[Vector<N>], order: Order, table: &mut ShapeTable<N>) {
        self.space.tabulate(element, xi, order, table);
    }
    fn structure(&self) -> &dyn BasisStructure<N> {
        self
    }
}
impl<const N: usize> BasisStructure<N> for Renumbered<'_, N> {
    fn reference(&self, element: usize) -> Option<usize> {
        self.space.0.structure().reference(element)
    }
}
impl<const N: usize> Geometry<N, N> for Renumbered<'_, N> {
    fn map(&self, element: usize, xi: &[Vector<N>], order: Order, table: &mut MapTable<N, N>) {
        self.space.map(element, xi, order, table);
    }
    fn bounds(&self, element: usize) -> Bounds<N> {
        self.space.bounds(element)
    }
    fn map_structure(&self) -> &dyn MapStructure<N, N> {
        self
    }
}
impl<const N: usize> MapStructure<N, N> for Renumbered<'_, N> {
    fn control(&self) -> Option<Control<'_, N, N>> {
        self.space.0.map_structure().control()
    }
}
impl<const N: usize> Space<N, N> for Renumbered<'_, N> {}

/// The largest of some sizes; NaN where one is NaN.
pub fn largest(sizes: impl IntoIterator<Item = f64>) -> f64 {
    sizes.into_iter().map(f64::abs).fold(0.0, |most, size| if size > most || size.is_nan() { size } else { most })
}

/// Largest difference of two matrices of one pattern over the largest entry.
pub fn apart(a: &Csr, b: &Csr) -> f64 {
    assert_eq!(a.pattern(), b.pattern());
    largest(a.vals().iter().zip(b.vals()).map(|(a, b)| a - b)) / largest(b.vals().iter().copied())
}
