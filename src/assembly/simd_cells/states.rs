//! A field and its gradient at all points of cells in lanes, handed over element by element.

use super::points::{PointTables, SameTables};
use super::sums::Sums;
use super::visit::{BatchVisit, PointQuantity};
use crate::assembly::sum_factorization::{state, state_size};
use crate::linalg::Real;
use crate::parallel;
use crate::space::{FieldAt, Space};
use std::ops::Range;

/// Elements of one task: their numbers stay in the L2 cache.
const ELEMENTS_PER_TASK: usize = 64;

/// Memory of one task.
struct Task<const C: usize, const N: usize, T: Real> {
    numbers: Vec<f64>,
    /// Range in `numbers` of every element.
    places: Vec<Range<usize>>,
    ids: Vec<usize>,
    states: Vec<FieldAt<C, N, T>>,
}

impl<const N: usize, T: Real, S: Space<N, N, T> + ?Sized> Sums<'_, N, N, T, S> {
    /// `visit(kept, element, states)` of every element, ascending: the field of `u` at the points of its rule. An empty `u` is
    /// zero; `kept` is memory of the visitor with arbitrary content.
    pub fn states<const C: usize, W: Default, R: Send>(
        &self,
        u: &[T],
        visit: &(impl Fn(&mut W, usize, &[FieldAt<C, N, T>]) -> R + Sync),
    ) -> Vec<R> {
        let elements = self.space.num_elements();
        let new = || (Task { numbers: Vec::new(), places: Vec::new(), ids: Vec::new(), states: Vec::new() }, W::default());
        let of_task = |(memory, kept): &mut (Task<C, N, T>, W), task: usize| {
            let range = task * ELEMENTS_PER_TASK..((task + 1) * ELEMENTS_PER_TASK).min(elements);
            self.fill(u, range.clone(), memory);
            let Task { numbers, places, states, .. } = memory;
            let own = |(e, place): (usize, &Range<usize>)| {
                states.clear();
                states.extend(numbers[place.clone()].chunks_exact(state_size(N, C)).map(state));
                visit(kept, e, states)
            };
            range.zip(places.iter()).map(own).collect::<Vec<R>>()
        };
        let tasks: Vec<Vec<R>> = parallel::map_init(elements.div_ceil(ELEMENTS_PER_TASK), new, of_task);
        tasks.into_iter().flatten().collect()
    }

    /// Computes the numbers of the elements of `range`, and their places.
    fn fill<const C: usize>(&self, u: &[T], range: Range<usize>, task: &mut Task<C, N, T>) {
        let Task { numbers, places, ids, .. } = task;
        numbers.clear();
        places.clear();
        places.resize(range.len(), 0..0);
        let nodes = |elements: &[u32], ids: &mut Vec<usize>, out: &mut [f64]| self.nodes.gather(elements, ids, out);
        let field = |elements: &[u32], ids: &mut Vec<usize>, out: &mut [f64]| self.coefficients::<C, T>(u, elements, ids, out);
        for SameTables { tables, members } in &self.groups {
            let before = |end: usize| members.partition_point(|&e| (e as usize) < end);
            let (elements, first) = (&members[before(range.start)..before(range.end)], numbers.len());
            if elements.is_empty() {
                continue;
            }
            let length = length::<C, N>(tables);
            for (k, &e) in elements.iter().enumerate() {
                places[e as usize - range.start] = first + k * length..first + (k + 1) * length;
            }
            let kind = PointQuantity::States((!u.is_empty()).then_some(&field));
            self.arch.dispatch(BatchVisit::<N> { tables, nodes: &nodes, state: None, kind, width: C, elements, ids, numbers });
        }
    }
}

/// Numbers of an element.
fn length<const C: usize, const N: usize>(tables: &PointTables<N>) -> usize {
    tables.weights.len() * state_size(N, C)
}
