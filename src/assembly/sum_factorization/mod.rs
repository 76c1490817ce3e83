//! Bulk matrices of patches whose functions are products: contraction of the whole grid, one direction after the other.
//!
//!   A(i, j) = sum_ab sum_q D_ab(q) prod_k N_ik^[a = k](q_k) N_jk^[b = k](q_k),   D = weight |det J| J^-1 tangent J^-T
//!
//! The fastest direction first, for pairs j >= i only; then the middle one; then the slowest, element by element into a
//! ring of sums, from which rows are written front to back as they become complete. Work per entry grows like p + 1, not
//! like (p + 1)^3; nothing is searched, sorted or interpolated, and the rule is the one given.
//!
//! | file | content |
//! |---|---|
//! | `axis`, `numbering` | tables of one direction; numbers of the functions, also of several patches as one body |
//! | `map`, `tensor_field` | positions and Jacobians on the grid |
//! | `coefficient` | D per pair of components; rational functions by an extended coefficient |
//! | `contract` | the three contractions |
//! | `sweep`, `tile` | loops and threads: strips, windows, layers |
//! | `rows`, `matrix` | rows of the matrix, also those of several patches; its pattern in closed form |
//! | `grid`, `cell` | a walk over the points, cell by cell; closures that are called there |
//! | `interpolate`, `integrate` | coefficients to the points, and the transpose |
//! | `point_operator`, `product`, `diagonal`, `matrix_free` | the tangent at a point; products without a matrix, their diagonal, stored data |
//! | `force`, `norms`, `states` | loads and internal forces; norms of differences; a field and its gradient |
//! | `dof_coordinates`, `simd` | coordinates of the unknowns; helpers of the lanes |
//!
//! Lanes are chosen at run time. They never mix and products are fused at every width, so that a sum has the same terms in
//! the same order on AVX2 and AVX-512, and for any number of threads. Kernels compute in `f64`; other scalars, degrees above
//! 5, processors without lanes and spaces without product structure take the plain loop.

mod axis;
mod cell;
mod coefficient;
mod contract;
mod diagonal;
mod dof_coordinates;
mod force;
mod grid;
mod integrate;
mod interpolate;
mod map;
mod matrix;
mod matrix_free;
mod norms;
pub(super) mod numbering;
mod point_operator;
mod product;
mod rows;
mod simd;
mod states;
mod sweep;
mod tensor_field;
#[cfg(test)]
mod tests;
mod tile;

use axis::{AxisTable, COMPILED};
pub(super) use cell::CellPoints;
pub(super) use force::add_moments;
pub(super) use grid::{PointCallback, QuadraturePoints};
use map::Map;
pub(super) use map::{MapEvaluator, MapEvaluators, finish, inverse, numbers as numbers_of_map};
pub(super) use matrix_free::Free;
pub(super) use norms::{SQUARES, Squares};
pub(super) use numbering::Glue;
pub(super) use point_operator::{PointOperator, physical, tested};
pub(in crate::assembly) use simd::available as lanes_available;
pub(super) use states::Physical;
pub(super) use states::{size as state_size, state};
use tensor_field::TensorField;

use crate::basis::{Basis, Block};
use crate::geometry::MapBlock;
use crate::linalg::{Real, to_f64};
use crate::quadrature::Quadrature;
use std::any::TypeId;
use std::ops::Range;
use std::sync::Arc;

/// A space that is made of patches, with its rules and its map.
#[derive(Debug)]
pub(super) struct Patches<'a> {
    patches: Vec<Patch<'a>>,
    /// Numbers of the functions; `None` if the only patch is numbered like the whole.
    glue: Option<Arc<Glue>>,
}

/// A run of elements that is one product of directions.
#[derive(Debug)]
struct Patch<'a> {
    axes: Vec<AxisTable>,
    /// First element.
    first_element: usize,
    /// Placeholder for the middle direction of a patch in the plane.
    none: AxisTable,
    map: Map<'a>,
    /// The weight function of a rational basis, and its weights.
    weight: Option<(TensorField, Vec<f64>)>,
    /// The instruction set.
    arch: pulp::Arch,
}

impl<'a> Patches<'a> {
    /// The patches that a space of functions `basis` is made of; `None` if the plain loop has to be used.
    ///
    /// `map` returns the product structure of the map around an element, if there is one, with points of M coordinates;
    /// `asks` returns an evaluator of the map of one element. The numbers `known` from [`Self::glue`] are taken if they are of the same
    /// functions; map and rules may differ.
    pub fn new<'m, const N: usize, const M: usize, T, B, Q>(
        basis: &B,
        quadrature: &Q,
        map: &dyn Fn(usize) -> Option<MapBlock<'m, N, M, T>>,
        asks: &'a MapEvaluators<'a>,
        known: Option<&Arc<Glue>>,
    ) -> Option<Self>
    where
        T: Real,
        B: Basis<N, T> + ?Sized,
        Q: Quadrature<N, T> + ?Sized,
    {
        if TypeId::of::<T>() != TypeId::of::<f64>() || !simd::available() || N != M || !(N == 2 || N == 3) || basis.num_elements() == 0 {
            return None;
        }
        let parts = numbering::patches(basis)?;
        let mut patches = Vec::with_capacity(parts.len());
        for part in &parts {
            let first = part.block.first;
            let rules = rules_of(quadrature, first..first + part.block.axes.iter().map(|a| a.num_elements()).product::<usize>())?;
            patches.push(Patch::new(&part.block, &rules, map(first), asks)?);
        }
        let functions = basis.num_functions();
        let whole = parts.len() == 1 && numbering::is_whole(&parts[0].ids, functions);
        let ids = || parts.iter().flat_map(|part| part.ids.iter().map(|&id| id as u32));
        let glue = (!whole).then(|| match known {
            Some(known) if known.is_of(&patches, ids(), functions) => known.clone(),
            _ => Arc::new(Glue::new(&patches, ids().collect(), functions)),
        });
        Some(Self { patches, glue })
    }

    /// The numbers of patches that are glued, or not numbered like the whole; `None` for others.
    pub fn glue(&self) -> Option<&Arc<Glue>> {
        self.glue.as_ref()
    }
}

/// The rules per direction of `elements`; `None` if they have none or different ones.
fn rules_of<const N: usize, T: Real, Q: Quadrature<N, T> + ?Sized>(
    quadrature: &Q,
    elements: Range<usize>,
) -> Option<[&dyn Quadrature<1, T>; N]> {
    let rules = quadrature.axes(elements.start)?;
    let is_same = |own: [&dyn Quadrature<1, T>; N]| own.iter().zip(&rules).all(|(own, rule)| std::ptr::addr_eq(*own, *rule));
    elements.skip(1).all(|e| quadrature.axes(e).is_some_and(is_same)).then_some(rules)
}

impl<'a> Patch<'a> {
    fn new<const N: usize, const M: usize, T: Real>(
        block: &Block<'_, N, T>,
        rules: &[&dyn Quadrature<1, T>; N],
        map: Option<MapBlock<'_, N, M, T>>,
        asks: &'a MapEvaluators<'a>,
    ) -> Option<Self> {
        let axes: Vec<AxisTable> = block.axes.iter().zip(rules).map(|(axis, rule)| AxisTable::new(*axis, *rule)).collect::<Option<_>>()?;
        if axes.iter().any(|axis| !COMPILED.contains(&axis.active)) {
            return None;
        }
        let weight = match block.weights {
            None => None,
            Some(weights) => {
                let weights: Vec<f64> = weights.iter().map(|&w| to_f64(w)).collect();
                Some((TensorField::new(block, rules, 1, weights.clone())?, weights))
            }
        };
        let elements: Vec<usize> = axes.iter().map(AxisTable::elements).collect();
        let net = map.filter(|m| m.basis.first == block.first).and_then(|m| control(&m, rules)).filter(|n| n.elements() == elements);
        Some(Self {
            axes,
            first_element: block.first,
            none: AxisTable::none(),
            map: net.map_or(Map::Elements(asks, block.first), Map::TensorField),
            weight,
            arch: pulp::Arch::new(),
        })
    }
}

/// The net of a map: control points, in homogeneous form where it is rational.
fn control<const N: usize, const M: usize, T: Real>(
    map: &MapBlock<'_, N, M, T>,
    rules: &[&dyn Quadrature<1, T>; N],
) -> Option<TensorField> {
    let width = if map.basis.weights.is_some() { N + 1 } else { N };
    let mut coefficients = Vec::with_capacity(map.control.len() * width);
    for (k, point) in map.control.iter().enumerate() {
        let weight = map.basis.weights.map(|w| to_f64(w[k]));
        coefficients.extend(point.iter().map(|&x| to_f64(x) * weight.unwrap_or(1.0)));
        coefficients.extend(weight);
    }
    TensorField::new(&map.basis, rules, width, coefficients)
}
