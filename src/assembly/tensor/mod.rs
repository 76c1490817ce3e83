//! Bulk matrices of patches whose functions are products: contraction of the whole grid, one direction after the other.
//!
//!   A(i, j) = sum_ab sum_q D_ab(q) prod_k N_ik^[a = k](q_k) N_jk^[b = k](q_k),   D = weight |det J| J^-1 tangent J^-T
//!
//! The fastest direction first, for pairs j >= i only; then the middle one; then the slowest, element by element into a
//! ring of sums, from which rows are written front to back as they become complete. Work per entry grows like p + 1, not
//! like (p + 1)^3; nothing is searched, sorted or interpolated, and the rule is the one given.
//!
//! | file | does |
//! |---|---|
//! | `axis` | tables of one direction |
//! | `net`, `map` | positions and Jacobians on the grid |
//! | `coefficient` | D per pair of components; rational functions by an extended coefficient |
//! | `groups`, `fast`, `middle`, `slow` | the three contractions |
//! | `layer`, `march` | loops and threads |
//! | `write` | rows of the matrix |
//! | `pattern`, `places` | row pointers and columns in closed form; where the unknowns live |
//! | `entry` | the matrix of a form |
//!
//! Lanes are chosen at run time. They never mix and products are fused at every width, so that a sum has the same terms in
//! the same order on AVX2 and AVX-512, and for any number of threads. Kernels count in `f64`; other scalars, degrees above
//! 5, processors without lanes and spaces without product structure take the plain loop.

mod axis;
mod coefficient;
mod entry;
mod fast;
mod groups;
mod lanes;
mod layer;
mod map;
mod march;
mod middle;
mod net;
mod pattern;
mod places;
mod slow;
mod write;

use axis::{Axis, COMPILED};
use map::Map;
pub(super) use map::{Ask, Asks};
use net::Net;

use crate::basis::{Basis, Block};
use crate::geometry::MapBlock;
use crate::linalg::{Real, to_f64};
use crate::quadrature::Quadrature;
use std::any::TypeId;

/// A space that is one product of directions, with its rule and its map.
#[derive(Debug)]
pub(super) struct Patch<'a> {
    axes: Vec<Axis>,
    map: Map<'a>,
    /// The weight function of a rational basis, and its weights.
    weight: Option<(Net, Vec<f64>)>,
}

impl<'a> Patch<'a> {
    /// The patch that a space of functions `basis` is; `None` where the plain loop has to do it.
    ///
    /// `map` is the product structure of its map, where there is one, with points of M coordinates; `asks` gives the map
    /// of one element.
    pub fn new<const N: usize, const M: usize, T, B, Q>(
        basis: &B,
        quadrature: &Q,
        map: Option<MapBlock<'_, N, M, T>>,
        asks: &'a Asks<'a>,
    ) -> Option<Self>
    where
        T: Real,
        B: Basis<N, T> + ?Sized,
        Q: Quadrature<N, T> + ?Sized,
    {
        if TypeId::of::<T>() != TypeId::of::<f64>() || !lanes::available() || N != M || !(N == 2 || N == 3) || basis.num_elements() == 0 {
            return None;
        }
        let block = basis.block(0)?;
        let rules = quadrature.axes(0)?;
        if !is_whole(basis, &block) {
            return None;
        }
        let axes: Vec<Axis> = block.axes.iter().zip(&rules).map(|(axis, rule)| Axis::new(*axis, *rule)).collect::<Option<_>>()?;
        if axes.iter().any(|axis| !COMPILED.contains(&axis.active)) {
            return None;
        }
        let weight = match block.weights {
            None => None,
            Some(weights) => {
                let weights: Vec<f64> = weights.iter().map(|&w| to_f64(w)).collect();
                Some((Net::new(&block, &rules, 1, weights.clone())?, weights))
            }
        };
        let elements: Vec<usize> = axes.iter().map(Axis::elements).collect();
        let net = map.filter(|m| m.basis.first == 0).and_then(|m| control(&m, &rules)).filter(|n| n.elements() == elements);
        Some(Self { axes, map: net.map_or(Map::Elements(asks), Map::Net), weight })
    }
}

/// Whether `block` is all of `basis`, numbered like it.
///
/// A block of all elements and functions could still be a renumbering; the ids of the elements along every axis tell.
fn is_whole<const N: usize, T: Real, B: Basis<N, T> + ?Sized>(basis: &B, block: &Block<'_, N, T>) -> bool {
    let elements = block.axes.map(|a| a.num_elements());
    let functions = block.axes.map(|a| a.num_functions());
    if block.first != 0 || elements.iter().product::<usize>() != basis.num_elements() {
        return false;
    }
    if functions.iter().product::<usize>() != basis.num_functions() {
        return false;
    }
    let (mut ids, mut own) = (Vec::new(), Vec::new());
    let strides = |sizes: &[usize; N]| -> [usize; N] { std::array::from_fn(|k| sizes[..k].iter().product()) };
    let (element_stride, function_stride) = (strides(&elements), strides(&functions));
    (0..N).all(|along| {
        (0..elements[along]).all(|e| {
            basis.active(e * element_stride[along], &mut ids);
            let first: usize = (0..N)
                .map(|k| {
                    block.axes[k].active(if k == along { e } else { 0 }, &mut own);
                    own.first().copied().unwrap_or(0) * function_stride[k]
                })
                .sum();
            ids.first() == Some(&first)
        })
    })
}

/// The net of a map: control points, in homogeneous form where it is rational.
fn control<const N: usize, const M: usize, T: Real>(map: &MapBlock<'_, N, M, T>, rules: &[&dyn Quadrature<1, T>; N]) -> Option<Net> {
    let width = if map.basis.weights.is_some() { N + 1 } else { N };
    let mut coefficients = Vec::with_capacity(map.control.len() * width);
    for (k, point) in map.control.iter().enumerate() {
        let weight = map.basis.weights.map(|w| to_f64(w[k]));
        coefficients.extend(point.iter().map(|&x| to_f64(x) * weight.unwrap_or(1.0)));
        coefficients.extend(weight);
    }
    Net::new(&map.basis, rules, width, coefficients)
}
