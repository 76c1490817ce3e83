//! Bulk matrices of cells that share reference cells: tables once per group, cells in lanes, rows without a search.
//!
//!   K_(a,c)(b,e) = sum_q sum_kl d_k N_a(q) D^ce_kl(q) d_l N_b(q),   D = weight |det J| J^-1 tangent J^-T
//!
//! | file | does |
//! |---|---|
//! | `slots` | batches of cells, and places of the entries of their matrices within rows |
//! | `points` | tables on the reference cell, and the elements that share them |
//! | `tables` | further tables for matrices |
//! | `lanes` | Jacobians, D, and the sums above, one cell per lane |
//! | `batch` | the matrices of the cells of a batch |
//! | `scatter` | adds them to rows |
//! | `nodes` | the points of a cell's map |
//! | `means` | coordinates of the unknowns |
//! | `sums`, `states` | loads and norms; a field and its gradient at all points |
//! | `visit` | evaluation at the points of cells in lanes |
//!
//! Batches of cells are fixed with the graph: cells follow one another by their greatest function. Threads own rows, and a batch whose
//! rows have several owners is computed by each of them. So a sum has the same terms in the same order for any number of threads and
//! of lanes. If all cells of a part of a batch are affine up to rounding of their nodes, one Jacobian and one table serve them. Kernels
//! compute in `f64`; other scalars, processors without lanes and spaces without reference cells take the plain loop.

mod batch;
#[cfg(all(test, target_arch = "x86_64"))]
mod bits;
mod lanes;
mod means;
mod nodes;
mod points;
mod scatter;
mod slots;
mod states;
mod sums;
mod tables;
mod visit;

pub(super) use means::means;
pub(super) use slots::{BATCH, Slot, Slots};
pub(super) use sums::Sums;

use super::Form;
use super::graph::{parts, shares};
use super::pattern::Pattern;
use super::source::Integrand;
use crate::linalg::{Csr, Real};
use crate::parallel;
use crate::quadrature::Quadrature;
use crate::space::Space;
use batch::{BatchKernel, Entries, Member};
use nodes::MapNodes;
use points::{Key, Kinds, PointTables, SameTables};
use scatter::Rows;
use slots::RowPlaces;
use std::any::TypeId;
use std::ops::Range;
use tables::Tables;

/// Batches handed to one task at a time.
const BATCHES_PER_TASK: usize = 512;

/// A space of cells that share reference cells, with its rule.
#[derive(Debug)]
pub(super) struct CellSpace<'a, const D: usize, const N: usize, T: Real> {
    groups: Vec<SameTables<Tables<D>, Member>>,
    nodes: MapNodes<'a, D, N, T>,
    /// The instruction set.
    arch: pulp::Arch,
}

impl<'a, const D: usize, const N: usize, T: Real> CellSpace<'a, D, N, T> {
    /// The cells of `space`; `None` if the plain loop has to be used.
    pub fn new<S, Q>(pattern: &Pattern, space: &'a S, quadrature: &Q) -> Option<Self>
    where
        S: Space<D, N, T> + ?Sized,
        Q: Quadrature<D, T> + ?Sized,
    {
        if !has_lanes::<D, N, T>() {
            return None;
        }
        let (slots, control) = (pattern.slots()?, space.map_structure().control()?);
        let keyed: Vec<Option<Vec<(Key, Member)>>> = parallel::map_ranges(slots.batches.len(), BATCHES_PER_TASK, |range| {
            let batches = &slots.batches[range.clone()];
            let mut members: Vec<(Key, Member)> = Vec::with_capacity(batches.len());
            for (k, batch) in batches.iter().enumerate() {
                let own = members.len();
                for (lane, &e) in batch.cells().iter().enumerate() {
                    let key = points::key(batch.reference, control.basis, e as usize, quadrature.rule(e as usize))?;
                    match members[own..].iter_mut().find(|m| m.0 == key) {
                        Some((_, member)) => member.lanes |= 1 << lane,
                        None => members.push((key, Member { batch: (range.start + k) as u32, lanes: 1 << lane })),
                    }
                }
            }
            Some(members)
        });
        let mut groups = Kinds::default();
        for members in keyed {
            for (key, member) in members? {
                let e = slots.batches[member.batch as usize].cells()[member.lanes.trailing_zeros() as usize] as usize;
                groups.put(key, member, || PointTables::new(space, control.basis, e, quadrature.rule(e)).map(Tables::from))?;
            }
        }
        Some(Self { groups: groups.of, nodes: MapNodes::new(control), arch: pulp::Arch::new() })
    }

    /// Writes the matrix of products of functions over the values of `matrix`, which has the pattern `pattern.csr(1)`.
    pub fn mass(&self, pattern: &Pattern, matrix: &mut Csr<T>) {
        self.fill::<1>(pattern, &Integrand::Mass, true, false, matrix);
    }

    fn fill<const C: usize>(&self, pattern: &Pattern, source: &Integrand<'_>, symmetric: bool, add: bool, matrix: &mut Csr<T>) {
        let (ptr, values) = (pattern.ptr(), matrix.vals_mut());
        assert_eq!(values.len(), C * C * ptr[pattern.num_functions()], "the matrix has the pattern of the basis");
        let slots = pattern.slots().expect("cells are made of them");
        // owners of equal numbers of entries
        let ranges = shares(ptr, rayon::current_num_threads());
        let owned = parts(values, &ranges, |i| C * C * ptr[i]);
        parallel::for_each(owned.into_iter().zip(ranges), |(values, functions)| match &slots.places {
            RowPlaces::Short(places) => self.rows::<C, u16>(pattern, places, source, symmetric, functions, (values, add)),
            RowPlaces::Long(places) => self.rows::<C, u32>(pattern, places, source, symmetric, functions, (values, add)),
        });
    }

    /// Adds all cells to the rows of `functions`, over zeros unless `add` is set.
    fn rows<const C: usize, P: Slot>(
        &self,
        pattern: &Pattern,
        places: &[P],
        source: &Integrand<'_>,
        symmetric: bool,
        functions: Range<usize>,
        (values, add): (&mut [T], bool),
    ) {
        let constant = if let Integrand::Constant(all) = source { entries::<D>(all) } else { Vec::new() };
        let field = source.state().map(|u| {
            move |elements: &[u32], _: &mut Vec<usize>, out: &mut [f64]| {
                for (lane, &e) in elements.iter().enumerate() {
                    nodes::put(u, C, pattern.ids(e as usize).iter().map(|&i| i as usize), (lane, elements.len()), out);
                }
            }
        });
        let slots = pattern.slots().expect("cells are made of them");
        let ready = if add { values.len() } else { 0 };
        let reach = functions.start as u32..functions.end as u32;
        let mut rows = Rows { ptr: pattern.ptr(), slots, places, functions, upper: symmetric, values, ready, starts: Vec::new() };
        for SameTables { tables, members } in &self.groups {
            self.arch.dispatch(BatchKernel {
                tables,
                nodes: &|elements, ids, out| self.nodes.gather(elements, ids, out),
                source,
                state: field.as_ref().map(|field| field as &batch::Nodes<'_>),
                constant: &constant,
                components: C,
                upper: symmetric,
                batches: &slots.batches,
                members,
                functions: reach.clone(),
                sink: &mut |batch, lanes, matrices| rows.add::<C>(batch, lanes, matrices),
            });
        }
        rows.make_ready::<C>(pattern.num_functions());
    }
}

impl<const N: usize, T: Real> CellSpace<'_, N, N, T> {
    /// Adds the matrix of `form` to `matrix`, which has the pattern `pattern.csr(C)`, or writes it over the values.
    pub fn stiffness<const C: usize>(&self, pattern: &Pattern, form: &Form<'_, C, N, T>, add: bool, matrix: &mut Csr<T>) {
        self.fill::<C>(pattern, &Integrand::new(form), form.symmetric, add, matrix);
    }
}

/// Whether there are kernels for cells of D dimensions in N that compute in `T`, and SIMD lanes for them.
fn has_lanes<const D: usize, const N: usize, T: Real>() -> bool {
    TypeId::of::<T>() == TypeId::of::<f64>() && super::sum_factorization::lanes_available() && D == N && (N == 2 || N == 3)
}

/// The non-zero entries of the tangents in `all`, N x N numbers each.
fn entries<const N: usize>(all: &[f64]) -> Vec<Entries> {
    let of = |pair: &[f64]| pair.iter().enumerate().filter(|(_, t)| **t != 0.0).map(|(ij, &t)| (ij / N, ij % N, t)).collect();
    all.chunks_exact(N * N).map(of).collect()
}
