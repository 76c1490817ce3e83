//! Floor 3: scalar bases, asked per element and batch of points in the element's own coordinates.

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
mod simplex;
mod table;
mod tensor;
mod topology;
mod unstructured;

use crate::linalg::{Real, Vector};
use std::borrow::Cow;
use std::fmt::Debug;

pub use bernstein::BernsteinSimplex;
pub use bspline::BSpline;
pub use extracted::Extracted;
pub use knots::{ContainError, KnotError};
pub use lagrange::{LagrangeLine, lagrange_nodes};
pub(crate) use numbering::lattice;
pub use piecewise::{Piece, Piecewise, legendre_polynomials};
pub use rational::{Rational, WeightError, check_weights};
pub use refined::Refined;
pub use simplex::{LagrangeSimplex, simplex_lattice, simplex_nodes, simplex_numbering};
pub use table::{Order, ShapeTable};
pub use tensor::TensorProduct;
pub use topology::Topology;
pub(crate) use topology::key_of;
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
    /// Topological ids of the element's corners, shared by neighbours, first axis fastest; none where unknown.
    fn corners(&self, _element: usize, ids: &mut Vec<usize>) {
        ids.clear();
    }
}

/// A run of elements `first + e1 + n1 (e2 + n2 e3)` on which function i is a product N_i, or w_i N_i / sum_j w_j N_j.
#[derive(Clone, Copy, Debug)]
pub struct Block<'a, const D: usize, T: Real = f64> {
    /// First element of the run.
    pub first: usize,
    /// Univariate factors; the first axis is the fastest in elements and functions.
    pub axes: [&'a dyn Basis<1, T>; D],
    /// Weights of a rational basis, one per function of the run.
    pub weights: Option<&'a [T]>,
}

/// A [`Block`] with the numbers that its functions have in the whole basis.
///
/// On the elements of the block, function k of the basis is the sum of the functions i of the block with `ids[i] = k`: one
/// where patches are glued, several where an edge is collapsed.
#[derive(Clone, Debug)]
pub struct TensorPatch<'a, const D: usize, T: Real = f64> {
    /// Elements and univariate factors.
    pub block: Block<'a, D, T>,
    /// One number per function of the block.
    pub ids: Cow<'a, [usize]>,
}

/// The functions of all elements in one list: those of element e are `ids[first[e]..first[e + 1]]`.
#[derive(Clone, Copy, Debug)]
pub struct Listed<'a> {
    /// Where the functions of every element begin, and the length of `ids` behind them.
    pub first: &'a [usize],
    /// Functions, element after element, in the order of [`Basis::active`].
    pub ids: &'a [usize],
}

/// Which multiplier polynomials are wanted of a basis.
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
pub trait Basis<const D: usize, T: Real = f64>: Elements {
    /// Number of functions.
    fn num_functions(&self) -> usize;
    /// Degree per direction on `element`; on simplices the total degree in every entry.
    fn degree(&self, element: usize) -> [usize; D];
    /// Ids of the functions that live on `element`.
    fn active(&self, element: usize, ids: &mut Vec<usize>);
    /// Values and derivatives of the active functions at the local points `xi`.
    fn tabulate(&self, element: usize, xi: &[Vector<D, T>], order: Order, table: &mut ShapeTable<D, T>);
    /// Whether the functions on `element` are known to be polynomials of total degree one: their gradients are constant.
    fn is_linear(&self, _element: usize) -> bool {
        false
    }
    /// A number of the reference cell of `element`: elements that answer with the same number have the same table at the same
    /// points, so that one table serves them all. None where tables differ from element to element.
    fn reference(&self, _element: usize) -> Option<usize> {
        None
    }
    /// What [`active`](Basis::active) says of all elements, where the basis keeps it as a list: nobody has to ask element by element.
    fn listed(&self) -> Option<Listed<'_>> {
        None
    }
    /// Product structure around `element`, where there is one: sum factorisation.
    fn block(&self, _element: usize) -> Option<Block<'_, D, T>> {
        None
    }
    /// All elements as blocks, ascending and without overlap, with the numbers of their functions, where the basis is made
    /// of blocks: what is integrated patch by patch.
    fn patches(&self) -> Option<Vec<TensorPatch<'_, D, T>>> {
        None
    }
    /// Non-negative polynomials on the same elements that sum to one, never rational: what multipliers are made of.
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
            fn is_linear(&self, element: usize) -> bool { (**self).is_linear(element) }
            fn reference(&self, element: usize) -> Option<usize> { (**self).reference(element) }
            fn listed(&self) -> Option<Listed<'_>> { (**self).listed() }
            fn block(&self, element: usize) -> Option<Block<'_, D, T>> { (**self).block(element) }
            fn patches(&self) -> Option<Vec<TensorPatch<'_, D, T>>> { (**self).patches() }
            fn polynomials(&self, wanted: Polynomials) -> Option<Box<dyn Basis<D, T>>> { (**self).polynomials(wanted) }
        }
    )*};
}
forward_basis!(&X, Box<X>, std::sync::Arc<X>);
