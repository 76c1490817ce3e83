//! Loads and norms on cells in lanes: values at the points of cells, summed over them. Fields at all points (`states`).
//!
//! Cells are added by groups with common tables, then by their numbers: same bits for any number of threads and of lanes.

use super::batch::Nodes;
use super::nodes::{self, MapNodes};
use super::points::{self, Kinds, PointTables, SameTables};
use super::visit::{BatchVisit, PointQuantity};
use crate::assembly::Form;
use crate::assembly::source::Integrand;
use crate::assembly::sum_factorization::{PointCallback, PointOperator, SQUARES};
use crate::linalg::{Real, lit};
use crate::parallel;
use crate::quadrature::Quadrature;
use crate::space::Space;

/// Elements of one task, and tasks whose results wait at a time.
const ELEMENTS_PER_TASK: usize = 256;
const TASKS_AT_ONCE: usize = 16;

/// A space of cells that share reference cells, with its rule, for sums over its points.
#[derive(Debug)]
pub(in crate::assembly) struct Sums<'a, const D: usize, const N: usize, T: Real, S: ?Sized> {
    /// Elements ascend in each.
    pub(super) groups: Vec<SameTables<PointTables<D>, u32>>,
    pub(super) nodes: MapNodes<'a, D, N, T>,
    pub(super) space: &'a S,
    /// The instruction set.
    pub(super) arch: pulp::Arch,
}

/// Numbers of the elements of a task, and the ids of their functions if they are needed.
#[derive(Default)]
struct Task {
    numbers: Vec<f64>,
    ids: Vec<u32>,
    /// Of one element.
    own: Vec<usize>,
}

impl<'a, const D: usize, const N: usize, T: Real, S: Space<D, N, T> + ?Sized> Sums<'a, D, N, T, S> {
    /// The cells of `space`; `None` if the plain loop has to be used.
    pub fn new<Q: Quadrature<D, T> + ?Sized>(space: &'a S, quadrature: &Q) -> Option<Self> {
        if !super::has_lanes::<D, N, T>() {
            return None;
        }
        let control = space.map_structure().control()?;
        let structure = space.structure();
        let mut groups = Kinds::default();
        for e in 0..space.num_elements() {
            let rule = quadrature.rule(e);
            let key = points::key(structure.reference(e)?, control.basis, e, rule)?;
            groups.put(key, u32::try_from(e).ok()?, || PointTables::new(space, control.basis, e, rule))?;
        }
        Some(Self { groups: groups.of, nodes: MapNodes::new(control), space, arch: pulp::Arch::new() })
    }

    /// ∫ f . N dx for forces of `width` components, computed by `answer`, then their moments as
    /// [`Patches::load`](crate::assembly::sum_factorization::Patches::load) has them.
    pub fn load(&self, width: usize, answer: &PointCallback<'_>) -> (Vec<T>, Vec<f64>) {
        self.forces(PointQuantity::Load(answer), width, None, width * (D + 1))
    }

    /// Numbers per function of `kind` with a `state`, added to those of the whole; then the `extra` sums beside them.
    fn forces(&self, kind: PointQuantity<'_>, width: usize, state: Option<&Nodes<'_>>, extra: usize) -> (Vec<T>, Vec<f64>) {
        let mut out = vec![T::zero(); width * self.space.num_functions()];
        let mut sums = vec![0.0; extra];
        self.each(kind, width, state, true, |tables, task| {
            let loads = width * tables.functions;
            for (numbers, ids) in task.numbers.chunks_exact(loads + extra).zip(task.ids.chunks_exact(tables.functions)) {
                let (loads, own) = numbers.split_at(loads);
                for (&i, loads) in ids.iter().zip(loads.chunks_exact(width)) {
                    out[width * i as usize..].iter_mut().zip(loads).for_each(|(out, &load)| *out += lit(load));
                }
                sums.iter_mut().zip(own).for_each(|(sum, m)| *sum += m);
            }
        });
        (out, sums)
    }

    /// Sums over the cells, task by task.
    fn each(
        &self,
        kind: PointQuantity<'_>,
        width: usize,
        state: Option<&Nodes<'_>>,
        ids: bool,
        mut sink: impl FnMut(&PointTables<D>, &Task),
    ) {
        let mut tasks: Vec<Task> = (0..TASKS_AT_ONCE).map(|_| Task::default()).collect();
        for SameTables { tables, members } in &self.groups {
            for block in members.chunks(ELEMENTS_PER_TASK * TASKS_AT_ONCE) {
                parallel::for_each(tasks.iter_mut().zip(block.chunks(ELEMENTS_PER_TASK)), |(task, elements)| {
                    task.numbers.clear();
                    task.ids.clear();
                    for &e in if ids { elements } else { &[] } {
                        self.space.active(e as usize, &mut task.own);
                        task.ids.extend(task.own.iter().map(|&i| i as u32));
                    }
                    let Task { numbers, own: ids, .. } = task;
                    let nodes = |elements: &[u32], ids: &mut Vec<usize>, out: &mut [f64]| self.nodes.gather(elements, ids, out);
                    self.arch.dispatch(BatchVisit::<D> { tables, nodes: &nodes, state, kind, width, elements, ids, numbers });
                });
                tasks[..block.len().div_ceil(ELEMENTS_PER_TASK)].iter().for_each(|task| sink(tables, task));
            }
        }
    }
}

impl<const N: usize, T: Real, S: Space<N, N, T> + ?Sized> Sums<'_, N, N, T, S> {
    /// The sums of squares of the difference between the field `u` (empty: zero) and the one of `answer`, as in
    /// [`Patches::deviation`](crate::assembly::sum_factorization::Patches::deviation).
    pub fn deviation<const C: usize>(&self, form: &Form<'_, C, N, T>, u: &[T], answer: &PointCallback<'_>) -> [f64; SQUARES] {
        let mut total = [0.0; SQUARES];
        let source = Integrand::new(form);
        let Some(law) = PointOperator::new::<N>(&source, C) else { return total };
        let field = |elements: &[u32], ids: &mut Vec<usize>, out: &mut [f64]| self.coefficients::<C, T>(u, elements, ids, out);
        let state = source.state().map(|state| {
            move |elements: &[u32], ids: &mut Vec<usize>, out: &mut [f64]| self.coefficients::<C, f64>(state, elements, ids, out)
        });
        let state = state.as_ref().map(|state| state as &Nodes<'_>);
        self.each(PointQuantity::Squares { law: &law, field: &field, answer }, C, state, false, |_, task| {
            for sums in task.numbers.chunks_exact(SQUARES) {
                total.iter_mut().zip(sums).for_each(|(total, sum)| *total += sum);
            }
        });
        total
    }

    /// ∫ P : grad N dx for the stress P and the energy density computed by `answer` from the gradient of `u` (empty: zero); then the
    /// energy.
    pub fn internal_force<const C: usize>(&self, u: &[T], answer: &PointCallback<'_>) -> (Vec<T>, f64) {
        let field = |elements: &[u32], ids: &mut Vec<usize>, out: &mut [f64]| self.coefficients::<C, T>(u, elements, ids, out);
        let (forces, energy) = self.forces(PointQuantity::Stress(answer), C, Some(&field), 1);
        (forces, energy.iter().sum())
    }

    /// Writes coefficient c of function a of the element of a lane at `(a * C + c) * lanes + lane`; nothing if `u` is empty.
    pub(super) fn coefficients<const C: usize, U: Real>(&self, u: &[U], elements: &[u32], ids: &mut Vec<usize>, out: &mut [f64]) {
        let lanes = elements.len();
        for (lane, &e) in elements.iter().enumerate().filter(|_| !u.is_empty()) {
            self.space.active(e as usize, ids);
            nodes::put(u, C, ids.iter().copied(), (lane, lanes), out);
        }
    }
}
