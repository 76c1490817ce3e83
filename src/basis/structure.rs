//! Structure of a basis that assembly can use: reference cells, lists of functions, products.

use super::Basis;
use crate::linalg::Real;
use std::borrow::Cow;
use std::fmt::Debug;

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
    /// Begin of the functions of every element, and the length of `ids` behind them.
    pub first: &'a [usize],
    /// Functions, element after element, in the order of [`Basis::active`].
    pub ids: &'a [usize],
}

/// Structure of a basis for fast assembly, see [`Basis::structure`]. Every answer is optional.
pub trait BasisStructure<const D: usize, T: Real = f64>: Debug + Send + Sync {
    /// Whether the functions on `element` are known to be polynomials of total degree one: their gradients are constant.
    fn is_linear(&self, _element: usize) -> bool {
        false
    }
    /// A number of the reference cell of `element`: elements that answer with the same number have the same table at the same
    /// points, so that one table serves them all. None where tables differ from element to element.
    fn reference(&self, _element: usize) -> Option<usize> {
        None
    }
    /// The answers of [`active`](Basis::active) for all elements, where the basis keeps them as a list: nobody has to ask one by one.
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
}

/// The structure of a basis or a geometry that has none: every answer is its default.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NoStructure;

impl<const D: usize, T: Real> BasisStructure<D, T> for NoStructure {}
