//! Choice of the kernels that integrate over a space: the fastest that space, map and rule allow.

use super::Form;
use super::simd_cells::Sums;
use super::sum_factorization::{Glue, MapEvaluator, MapEvaluators, Patches, PointCallback, SQUARES};
use crate::basis::Order;
use crate::geometry::MapTable;
use crate::linalg::{Real, Vector, lit, to_f64};
use crate::quadrature::Quadrature;
use crate::space::{FieldAt, Space};
use std::sync::Arc;

/// Kernels for sums over the quadrature points of a space.
#[derive(Debug)]
pub(super) enum Kernels<'a, const D: usize, const N: usize, T: Real, S: ?Sized> {
    /// Products of directions, by sum factorisation.
    Patches(Patches<'a>),
    /// Cells that share tables, in SIMD lanes.
    Cells(Sums<'a, D, N, T, S>),
    /// One element after the other: any space; the caller has the loop.
    Elements,
}

impl<'a, const D: usize, const N: usize, T: Real, S: Space<D, N, T> + ?Sized> Kernels<'a, D, N, T, S> {
    /// Chooses the kernels; `map` is that of [`map_of`].
    pub fn new<Q: Quadrature<D, T> + ?Sized>(space: &'a S, quadrature: &Q, map: &'a MapEvaluators<'a>) -> Self {
        match patches(space, quadrature, map, None) {
            Some(patches) => Self::Patches(patches),
            None => Sums::new(space, quadrature).map_or(Self::Elements, Self::Cells),
        }
    }

    /// ∫ f . N dx for forces of `width` components, computed by `answer`, then their moments as [`Patches::load`] has them; `None` of
    /// elements.
    pub fn load(&self, space: &S, width: usize, answer: &PointCallback<'_>) -> Option<(Vec<T>, Vec<f64>)> {
        match self {
            Self::Patches(patches) => Some(patches.load(width, space.num_functions(), answer)),
            Self::Cells(cells) => Some(cells.load(width, answer)),
            Self::Elements => None,
        }
    }
}

impl<const N: usize, T: Real, S: Space<N, N, T> + ?Sized> Kernels<'_, N, N, T, S> {
    /// Sums of squares of the difference between the field `u` (empty: zero) and the one of `answer`, as [`Patches::deviation`] has
    /// them; `None` of elements.
    pub fn deviation<const C: usize>(&self, form: &Form<'_, C, N, T>, u: &[T], answer: &PointCallback<'_>) -> Option<[f64; SQUARES]> {
        match self {
            Self::Patches(patches) => Some(patches.deviation(form, u, answer)),
            Self::Cells(cells) => Some(cells.deviation(form, u, answer)),
            Self::Elements => None,
        }
    }

    /// ∫ P : grad N dx for the stress P of C components and the energy density computed by `answer` from the gradient of `u` (empty:
    /// zero), then the energy; `None` of elements.
    pub fn internal_force<const C: usize>(&self, space: &S, u: &[T], answer: &PointCallback<'_>) -> Option<(Vec<T>, f64)> {
        match self {
            Self::Patches(patches) => Some(patches.internal_force(C, space.num_functions(), u, answer)),
            Self::Cells(cells) => Some(cells.internal_force::<C>(u, answer)),
            Self::Elements => None,
        }
    }

    /// The result of `visit` per element for the field `u` at its points; `None` of elements.
    pub fn states<const C: usize, W: Default, R: Send>(
        &self,
        u: &[T],
        visit: &(impl Fn(&mut W, usize, &[FieldAt<C, N, T>]) -> R + Sync),
    ) -> Option<Vec<R>> {
        match self {
            Self::Patches(patches) => Some(patches.states(u, visit)),
            Self::Cells(cells) => Some(cells.states(u, visit)),
            Self::Elements => None,
        }
    }
}

/// The patches of `space`, with the numbers `glue` of [`Patches::glue`] if they are known; `None` if it is not made of products.
pub(super) fn patches<'a, const D: usize, const N: usize, T, S, Q>(
    space: &S,
    quadrature: &Q,
    map: &'a MapEvaluators<'a>,
    glue: Option<&Arc<Glue>>,
) -> Option<Patches<'a>>
where
    T: Real,
    S: Space<D, N, T> + ?Sized,
    Q: Quadrature<D, T> + ?Sized,
{
    Patches::new(space, quadrature, &|e| space.map_structure().map_block(e), map, glue)
}

/// Returns the map of `space` as a closure on `f64`: x and the tangents at local points of an element.
pub(super) fn map_of<'a, const D: usize, const N: usize, T, S>(space: &'a S) -> Box<MapEvaluator<'a>>
where
    T: Real,
    S: Space<D, N, T> + ?Sized,
{
    let (mut points, mut table) = (Vec::new(), MapTable::new());
    Box::new(move |element: usize, xi: &[f64], out: &mut Vec<f64>| {
        points.clear();
        points.extend(xi.chunks_exact(D).map(|xi| Vector::<D, T>::from_fn(|k, _| lit(xi[k]))));
        space.map(element, &points, Order::Gradients, &mut table);
        out.clear();
        for (x, jacobian) in table.x.iter().zip(&table.jacobian) {
            out.extend(x.iter().map(|&x| to_f64(x)));
            // by columns: the tangents one after the other
            out.extend(jacobian.iter().map(|&j| to_f64(j)));
        }
    })
}
