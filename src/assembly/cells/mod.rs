//! Bulk matrices of cells that share reference cells: tables once per group, cells in lanes, rows without a search.
//!
//!   K_(a,c)(b,e) = sum_q sum_kl d_k N_a(q) D^ce_kl(q) d_l N_b(q),   D = weight |det J| J^-1 tangent J^-T
//!
//! | file | does |
//! |---|---|
//! | `slots` | places of the entries of element matrices within their rows |
//! | `tables` | functions and map on the reference cell |
//! | `lanes` | Jacobians, D, and the sums above, one cell per lane |
//! | `batch` | the matrices of some cells, batch after batch |
//! | `scatter` | adds them to rows |
//! | `means` | where unknowns live |
//! | `points`, `sums` | loads and norms: tables at points, and what is summed there |
//!
//! Cells are added by groups and within a group by their least function; threads own rows, and a cell whose rows have several owners
//! is computed by each of them. So a sum has the same terms in the same order for any number of threads and of lanes. Kernels count
//! in `f64`; other scalars, processors without lanes and spaces without reference cells take the plain loop.

mod batch;
mod lanes;
mod means;
mod points;
mod scatter;
mod slots;
mod sums;
mod tables;

pub(super) use means::means;
pub(super) use slots::{Place, Places, Slots, ordered};
pub(super) use sums::Sums;

use super::Form;
use super::pattern::Pattern;
use super::source::Source;
use crate::geometry::Control;
use crate::linalg::{Csr, Real, to_f64};
use crate::quadrature::Quadrature;
use crate::space::Space;
use batch::{Entries, Run};
use rayon::prelude::*;
use scatter::Rows;
use std::any::TypeId;
use std::ops::Range;
use tables::Tables;

/// Groups of elements at most: more have nothing in common.
const GROUPS: usize = 32;

/// Elements with common tables.
#[derive(Debug)]
struct Group<const D: usize> {
    tables: Tables<D>,
    /// In the order in which their matrices are added.
    elements: Vec<u32>,
    /// Whether all maps are affine.
    affine: bool,
}

/// A space of cells that share reference cells, with its rule.
#[derive(Debug)]
pub(super) struct Cells<'a, const D: usize, const N: usize, T: Real> {
    groups: Vec<Group<D>>,
    control: Control<'a, D, N, T>,
}

impl<'a, const D: usize, const N: usize, T: Real> Cells<'a, D, N, T> {
    /// The cells of `space`; `None` where the plain loop has to do it.
    pub fn new<S, Q>(pattern: &Pattern, space: &'a S, quadrature: &Q) -> Option<Self>
    where
        S: Space<D, N, T> + ?Sized,
        Q: Quadrature<D, T> + ?Sized,
    {
        if TypeId::of::<T>() != TypeId::of::<f64>() || !super::tensor::lanes_available() || D != N || !(N == 2 || N == 3) {
            return None;
        }
        let (slots, control) = (pattern.slots()?, space.control()?);
        let mut keys = Vec::new();
        let mut groups: Vec<Group<D>> = Vec::new();
        let mut last = 0;
        for &element in &slots.order {
            let e = element as usize;
            let rule = quadrature.rule(e);
            let key = (space.reference(e)?, control.basis.reference(e)?, std::ptr::from_ref(rule));
            if keys.get(last) != Some(&key) {
                last = keys.iter().position(|k| *k == key).unwrap_or(keys.len());
            }
            if last == keys.len() {
                if last == GROUPS {
                    return None;
                }
                let tables = Tables::new(space, control.basis, e, rule);
                // nothing to sum: not worth a kernel
                if tables.weights.is_empty() || tables.functions == 0 || tables.nodes == 0 {
                    return None;
                }
                keys.push(key);
                groups.push(Group { tables, elements: Vec::new(), affine: true });
            }
            let group = &mut groups[last];
            group.affine = group.affine && space.is_affine(e);
            group.elements.push(element);
        }
        Some(Self { groups, control })
    }

    /// Adds the matrix of products of functions to `matrix`.
    pub fn mass(&self, pattern: &Pattern, matrix: &mut Csr<T>) {
        self.fill::<1>(pattern, &Source::Mass, true, true, matrix);
    }

    fn fill<const C: usize>(&self, pattern: &Pattern, source: &Source<'_>, symmetric: bool, add: bool, matrix: &mut Csr<T>) {
        let (ptr, values) = (pattern.ptr(), matrix.vals_mut());
        assert_eq!(values.len(), C * C * ptr[pattern.num_functions()], "the matrix has the pattern of the basis");
        let slots = pattern.slots().expect("cells are made of them");
        // owners of equal numbers of entries
        let owners = rayon::current_num_threads();
        let cut =
            |k: usize| if k == owners { pattern.num_functions() } else { ptr.partition_point(|&p| p * owners < k * ptr[ptr.len() - 1]) };
        let (mut parts, mut rest) = (Vec::with_capacity(owners), values);
        for k in 0..owners {
            let functions = cut(k).min(pattern.num_functions())..cut(k + 1).min(pattern.num_functions());
            let (own, others) = rest.split_at_mut(C * C * (ptr[functions.end] - ptr[functions.start]));
            rest = others;
            parts.push((functions, own));
        }
        parts.into_par_iter().for_each(|(functions, values)| {
            if !add {
                values.fill(T::zero());
            }
            match &slots.places {
                Places::Short(places) => self.rows::<C, _>(pattern, places, source, symmetric, functions, values),
                Places::Long(places) => self.rows::<C, _>(pattern, places, source, symmetric, functions, values),
            }
        });
    }

    /// Adds everything to the rows of `functions`.
    fn rows<const C: usize, P: Place>(
        &self,
        pattern: &Pattern,
        places: &[P],
        source: &Source<'_>,
        symmetric: bool,
        functions: Range<usize>,
        values: &mut [T],
    ) {
        let first = &pattern.slots().expect("cells are made of them").first;
        let whole = functions.len() == pattern.num_functions();
        let Control { basis, points } = self.control;
        let nodes = |e: usize, ids: &mut Vec<usize>, out: &mut [f64], lanes: usize, lane: usize| {
            basis.active(e, ids);
            for (out, &i) in out.chunks_exact_mut(D * lanes).zip(ids.iter()) {
                for (k, &x) in points[i].iter().enumerate() {
                    out[k * lanes + lane] = to_f64(x);
                }
            }
        };
        let constant = if let Source::Constant(all) = source { entries::<D>(all) } else { Vec::new() };
        let mut rows = Rows { pattern, first, places, functions, upper: symmetric, values };
        for group in &self.groups {
            let mine: Vec<u32>;
            let elements = if whole {
                &group.elements
            } else {
                let reaches = |e: &u32| pattern.ids(*e as usize).iter().any(|&i| rows.functions.contains(&(i as usize)));
                mine = group.elements.iter().copied().filter(reaches).collect();
                &mine
            };
            let (tables, affine) = (&group.tables, group.affine);
            pulp::Arch::new().dispatch(Run {
                tables,
                affine,
                nodes: &nodes,
                source,
                constant: &constant,
                components: C,
                upper: symmetric,
                elements,
                sink: &mut |batch, matrices| rows.add::<C>(batch, matrices),
            });
        }
    }
}

impl<const N: usize, T: Real> Cells<'_, N, N, T> {
    /// Adds the matrix of `form` to `matrix`, which has the pattern `pattern.csr(C)`, or writes it over the values.
    pub fn stiffness<const C: usize>(&self, pattern: &Pattern, form: &Form<'_, C, N, T>, add: bool, matrix: &mut Csr<T>) {
        self.fill::<C>(pattern, &Source::new(form), form.symmetric, add, matrix);
    }
}

/// The tangents of N x N numbers in `all`, entries that are not zero.
fn entries<const N: usize>(all: &[f64]) -> Vec<Entries> {
    let of = |pair: &[f64]| pair.iter().enumerate().filter(|(_, t)| **t != 0.0).map(|(ij, &t)| (ij / N, ij % N, t)).collect();
    all.chunks_exact(N * N).map(of).collect()
}
