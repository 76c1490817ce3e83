//! Structure of a map that assembly can use: functions and points, products.

use crate::basis::{Basis, Block, NoStructure};
use crate::linalg::{Real, Vector};
use std::borrow::Cow;
use std::fmt::Debug;

/// Univariate factors of a map: x = sum_i N_i control_i over the functions of `basis`.
#[derive(Clone, Debug)]
pub struct MapBlock<'a, const D: usize, const N: usize, T: Real = f64> {
    /// The basis of the map, answering on the elements of the geometry.
    pub basis: Block<'a, D, T>,
    /// One control point per function of the run.
    pub control: Cow<'a, [Vector<N, T>]>,
}

/// A map as functions and points: x = sum_i M_i points_i on every element.
#[derive(Clone, Copy, Debug)]
pub struct Control<'a, const D: usize, const N: usize, T: Real = f64> {
    /// The functions M_i, answering on the elements of the geometry.
    pub basis: &'a dyn Basis<D, T>,
    /// One point per function \[length\].
    pub points: &'a [Vector<N, T>],
}

/// Structure of a map for fast assembly, see [`Geometry::map_structure`](super::Geometry::map_structure). Every answer is optional.
pub trait MapStructure<const D: usize, const N: usize, T: Real = f64>: Debug + Send + Sync {
    /// Whether the map of `element` is known to be affine: its Jacobian is constant, the images of segments are straight.
    fn is_affine(&self, _element: usize) -> bool {
        false
    }
    /// The map as functions and points, where it is that everywhere: tables of a reference cell, see
    /// [`BasisStructure::reference`](crate::basis::BasisStructure::reference).
    fn control(&self) -> Option<Control<'_, D, N, T>> {
        None
    }
    /// Product structure of the map around `element`, where there is one.
    fn map_block(&self, _element: usize) -> Option<MapBlock<'_, D, N, T>> {
        None
    }
}

impl<const D: usize, const N: usize, T: Real> MapStructure<D, N, T> for NoStructure {}
