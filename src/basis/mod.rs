//! Floor 3: scalar bases, evaluated per element at batches of points in the element's own coordinates.

mod bernstein;
mod bspline;
mod convert;
mod extracted;
mod knots;
mod lagrange;
mod numbering;
mod piecewise;
mod rational;
mod refined;
mod scratch_slot;
mod simplex;
mod structure;
mod table;
mod tensor;
mod topology;
mod unstructured;

use crate::linalg::{Real, Vector};
use std::fmt::Debug;

pub use bernstein::BernsteinSimplex;
pub use bspline::BSpline;
pub use extracted::Extracted;
pub use knots::{ContainError, KnotError};
pub use lagrange::{LagrangeLine, lagrange_nodes};
pub(crate) use numbering::lattice;
pub use piecewise::{ElementPolynomials, Piecewise, legendre_polynomials};
pub use rational::{Rational, WeightError, check_weights};
pub use refined::Refined;
pub use scratch_slot::ScratchSlot;
pub use simplex::{LagrangeSimplex, simplex_lattice, simplex_nodes, simplex_numbering};
pub use structure::{BasisStructure, Block, Listed, NoStructure, TensorPatch};
pub use table::{Order, ShapeTable};
pub use tensor::TensorProduct;
pub use topology::Topology;
pub(crate) use topology::{key_of, local_edges};
pub use unstructured::Unstructured;
pub(crate) use unstructured::corner_places;

/// The reference cell of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Cell {
    /// Unit interval, square, cube.
    Tensor,
    /// Unit interval, triangle, tetrahedron: xi_k >= 0, sum xi_k <= 1.
    Simplex,
}

/// The elements a basis and a geometry have in common.
pub trait Elements: Debug + Send + Sync {
    /// Number of elements.
    fn num_elements(&self) -> usize;
    /// Reference cell of `element`.
    fn cell(&self, _element: usize) -> Cell {
        Cell::Tensor
    }
    /// Topological ids of the element's corners, shared by neighbours, first axis fastest; empty if unknown.
    fn corners(&self, _element: usize, ids: &mut Vec<usize>) {
        ids.clear();
    }
}

/// Polynomial space requested from [`Basis::polynomials`], for multipliers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Polynomials {
    /// Degree p - k on the same breakpoints, knots kept with their multiplicity: regularity max(r - k, -1).
    Lowered(usize),
    /// Given degree and continuity (-1: discontinuous) on the same breakpoints.
    Uniform {
        /// Degree of the polynomials.
        degree: usize,
        /// Continuity between elements, -1 for none.
        continuity: isize,
    },
}

/// A scalar basis on elements.
///
/// Rules: [`tabulate`](Basis::tabulate) continues the element's own polynomials outside its cell;
/// [`active`](Basis::active) lists each function once, in the order of the table; a [`Block`] numbers functions and
/// elements with the first axis fastest, and the active ids of an axis are consecutive and never fall.
///
/// A new basis implements evaluation and nothing else; [`structure`](Basis::structure) is for those that have more to tell.
pub trait Basis<const D: usize, T: Real = f64>: Elements {
    /// Number of functions.
    fn num_functions(&self) -> usize;
    /// Degree per direction on `element`; on simplices the total degree in every entry.
    fn degree(&self, element: usize) -> [usize; D];
    /// Ids of the functions that are active on `element`.
    fn active(&self, element: usize, ids: &mut Vec<usize>);
    /// Values and derivatives of the active functions at the local points `xi`.
    fn tabulate(&self, element: usize, xi: &[Vector<D, T>], order: Order, table: &mut ShapeTable<D, T>);
    /// Structure that assembly can use; nothing by default.
    fn structure(&self) -> &dyn BasisStructure<D, T> {
        &NoStructure
    }
    /// Non-negative polynomials on the same elements that sum to one, never rational, for multipliers; `None` if there are none.
    fn polynomials(&self, _wanted: Polynomials) -> Option<Box<dyn Basis<D, T>>> {
        None
    }
}

macro_rules! forward_basis {
    ($($pointer:ty),*) => {$(
        impl<X: Elements + ?Sized> Elements for $pointer {
            fn num_elements(&self) -> usize { (**self).num_elements() }
            fn cell(&self, element: usize) -> Cell { (**self).cell(element) }
            fn corners(&self, element: usize, ids: &mut Vec<usize>) { (**self).corners(element, ids) }
        }
        impl<const D: usize, T: Real, X: Basis<D, T> + ?Sized> Basis<D, T> for $pointer {
            fn num_functions(&self) -> usize { (**self).num_functions() }
            fn degree(&self, element: usize) -> [usize; D] { (**self).degree(element) }
            fn active(&self, element: usize, ids: &mut Vec<usize>) { (**self).active(element, ids) }
            fn tabulate(&self, element: usize, xi: &[Vector<D, T>], order: Order, table: &mut ShapeTable<D, T>) {
                (**self).tabulate(element, xi, order, table)
            }
            fn structure(&self) -> &dyn BasisStructure<D, T> { (**self).structure() }
            fn polynomials(&self, wanted: Polynomials) -> Option<Box<dyn Basis<D, T>>> { (**self).polynomials(wanted) }
        }
    )*};
}
forward_basis!(&X, Box<X>, std::sync::Arc<X>);
