//! Sparsity pattern of a bulk matrix: elements to functions, functions to elements, rows with ascending columns.

use super::graph::Graph;
use super::simd_cells::Slots;
use super::sum_factorization::numbering;
use crate::basis::{Basis, Block, Elements};
use crate::linalg::{Buffer, Csr, Real, Sparsity};
use crate::parallel;
use std::sync::Arc;

/// The graph of a basis: functions that share an element.
///
/// Everything is linear in the number of entries and nothing is sorted: function i is appended to the row of every
/// neighbour for ascending i, so each row comes out ascending. Where the basis is one product block the rows are
/// products of index ranges and are written down directly. The result does not depend on the number of threads.
#[derive(Clone, Debug)]
pub struct Pattern {
    graph: Graph,
    ptr: Vec<usize>,
    cols: Buffer<u32>,
    /// Positions of element-matrix entries in the rows; `None` for one product block or without reference cells.
    slots: Option<Slots>,
}

impl Pattern {
    /// The graph of `basis`.
    ///
    /// # Panics
    /// If there are 2^32 functions or elements or more.
    pub fn new<const D: usize, T: Real, B: Basis<D, T> + ?Sized>(basis: &B) -> Self {
        let (elements, functions) = (basis.num_elements(), basis.num_functions());
        assert!(u32::try_from(elements.max(functions)).is_ok(), "fewer than 2^32 functions and elements");
        let mut pattern = Self { graph: Graph::new(basis), ptr: Vec::new(), cols: Buffer::default(), slots: None };
        let whole = numbering::patches(basis).and_then(|parts| match &parts[..] {
            [part] if numbering::is_whole(&part.ids, functions) => pattern.product(&part.block),
            _ => None,
        });
        if let Some((ptr, cols)) = whole {
            (pattern.ptr, pattern.cols) = (ptr, cols);
            return pattern;
        }
        pattern.ptr = pattern.graph.lengths();
        let structure = basis.structure();
        match (0..elements).map(|e| structure.reference(e)).collect::<Option<Vec<usize>>>() {
            None => pattern.cols = pattern.graph.columns(&pattern.ptr),
            Some(references) => {
                let slots;
                (pattern.cols, slots) = Slots::new(&pattern.graph, &references, &pattern.ptr);
                pattern.slots = Some(slots);
            }
        }
        pattern
    }

    /// Rows of one block that covers the basis: products of ranges per axis.
    fn product<const D: usize, T: Real>(&self, block: &Block<'_, D, T>) -> Option<(Vec<usize>, Buffer<u32>)> {
        let elements: usize = block.axes.iter().map(|a| a.num_elements()).product();
        let functions: usize = block.axes.iter().map(|a| a.num_functions()).product();
        if block.first != 0 || elements != self.num_elements() || functions != self.num_functions() {
            return None;
        }
        let mut ids = Vec::new();
        let ranges: Vec<Vec<(usize, usize)>> = block
            .axes
            .iter()
            .map(|axis| {
                let mut range = vec![(usize::MAX, 0usize); axis.num_functions()];
                for e in 0..axis.num_elements() {
                    axis.active(e, &mut ids);
                    let (lo, hi) = (ids.iter().copied().min().unwrap_or(0), ids.iter().copied().max().map_or(0, |i| i + 1));
                    for &i in &ids {
                        range[i] = (range[i].0.min(lo), range[i].1.max(hi));
                    }
                }
                range
            })
            .collect();
        let sizes: Vec<usize> = ranges.iter().map(Vec::len).collect();
        let mut ptr = Vec::with_capacity(functions + 1);
        ptr.push(0usize);
        let split = |mut i: usize| -> [usize; D] {
            std::array::from_fn(|k| {
                let r = i % sizes[k];
                i /= sizes[k];
                r
            })
        };
        for i in 0..functions {
            let at = split(i);
            let count: usize = (0..D).map(|k| ranges[k][at[k]].1.saturating_sub(ranges[k][at[k]].0)).product();
            ptr.push(ptr[i] + count);
        }
        let mut cols = Buffer::<u32>::zeros(ptr[functions]);
        each_row(&ptr, &mut cols, |i, row| {
            let at = split(i);
            let range: [(usize, usize); D] = std::array::from_fn(|k| ranges[k][at[k]]);
            let mut index: [usize; D] = std::array::from_fn(|k| range[k].0);
            for slot in row {
                *slot = (0..D).rev().fold(0, |s, k| s * sizes[k] + index[k]) as u32;
                for k in 0..D {
                    index[k] += 1;
                    if index[k] < range[k].1 {
                        break;
                    }
                    index[k] = range[k].0;
                }
            }
        });
        Some((ptr, cols))
    }

    /// Positions of element-matrix entries in the rows; `None` for one product block or without reference cells.
    pub(super) fn slots(&self) -> Option<&Slots> {
        self.slots.as_ref()
    }

    /// Number of functions.
    pub fn num_functions(&self) -> usize {
        self.graph.num_functions()
    }

    /// Number of elements.
    pub fn num_elements(&self) -> usize {
        self.graph.num_elements()
    }

    /// Functions of `element` in the order of [`Basis::active`].
    #[inline]
    pub fn ids(&self, element: usize) -> &[u32] {
        self.graph.ids(element)
    }

    /// (element, local number) of function `i` wherever it is active, elements ascending.
    #[inline]
    pub fn cells(&self, i: usize) -> &[(u32, u32)] {
        self.graph.cells(i)
    }

    /// Neighbours of function `i`, ascending.
    #[inline]
    pub fn row(&self, i: usize) -> &[u32] {
        &self.cols[self.ptr[i]..self.ptr[i + 1]]
    }

    /// Row pointers of the scalar matrix.
    #[inline]
    pub fn ptr(&self) -> &[usize] {
        &self.ptr
    }

    /// Returns the matrix of [`csr`](Self::csr) and moves the columns into it: [`row`](Self::row) must not be called afterwards.
    pub(super) fn csr_once<T: Real>(&mut self, components: usize) -> Csr<T> {
        let cols = std::mem::take(&mut self.cols);
        Csr::zeros(Arc::new(Sparsity::of(components, self.num_functions(), self.ptr.clone(), cols)))
    }

    /// A zero matrix for fields of `components` components, unknown = components * function + component, in blocks of that size.
    ///
    /// # Panics
    /// If there are 2^32 unknowns or more.
    pub fn csr<T: Real>(&self, components: usize) -> Csr<T> {
        Csr::zeros(Arc::new(Sparsity::of(components, self.num_functions(), self.ptr.clone(), self.cols.clone())))
    }
}

/// Rows handed to one task at a time.
const ROWS_PER_TASK: usize = 512;

/// Calls `fill(i, row i of data)` for all rows, in parallel over runs of rows.
pub(super) fn each_row<X: Send>(ptr: &[usize], data: &mut [X], fill: impl Fn(usize, &mut [X]) + Sync) {
    // takes no memory: the elements of the second array are zero-sized
    let mut nothing = vec![(); data.len()];
    each_row_pair(ptr, data, &mut nothing, |i, row, _| fill(i, row));
}

/// Calls `fill(i, row i of first, row i of second)` for all rows, in parallel over runs of rows.
pub(super) fn each_row_pair<X: Send, Y: Send>(
    ptr: &[usize],
    first: &mut [X],
    second: &mut [Y],
    fill: impl Fn(usize, &mut [X], &mut [Y]) + Sync,
) {
    let rows = ptr.len() - 1;
    let mut tasks = Vec::with_capacity(rows / ROWS_PER_TASK + 1);
    let mut rest = (first, second);
    for from in (0..rows).step_by(ROWS_PER_TASK) {
        let end = (from + ROWS_PER_TASK).min(rows);
        let (x, others_x) = rest.0.split_at_mut(ptr[end] - ptr[from]);
        let (y, others_y) = rest.1.split_at_mut(ptr[end] - ptr[from]);
        rest = (others_x, others_y);
        tasks.push((from..end, x, y));
    }
    parallel::for_each(tasks.into_iter(), |(range, x, y)| {
        let mut rest = (x, y);
        for i in range {
            let (x, others_x) = rest.0.split_at_mut(ptr[i + 1] - ptr[i]);
            let (y, others_y) = rest.1.split_at_mut(ptr[i + 1] - ptr[i]);
            rest = (others_x, others_y);
            fill(i, x, y);
        }
    });
}
