//! Which entries a bulk matrix has: element to function, function to element, rows in ascending order.

use super::tensor::numbers;
use crate::basis::{Basis, Block, Elements};
use crate::linalg::{Csr, Real, Sparsity};
use rayon::prelude::*;
use std::sync::Arc;

/// The graph of a basis: functions that share an element.
///
/// Everything is linear in the number of entries and nothing is sorted: function i is appended to the row of every
/// neighbour for ascending i, so each row comes out ascending. Where the basis is one product block the rows are
/// products of index ranges and are written down directly.
#[derive(Clone, Debug)]
pub struct Pattern {
    functions: usize,
    element_start: Vec<usize>,
    element_ids: Vec<u32>,
    cell_start: Vec<usize>,
    cells: Vec<(u32, u32)>,
    ptr: Vec<usize>,
    cols: Vec<u32>,
}

impl Pattern {
    /// The graph of `basis`.
    ///
    /// # Panics
    /// If there are 2^32 functions or elements or more.
    pub fn new<const D: usize, T: Real, B: Basis<D, T> + ?Sized>(basis: &B) -> Self {
        let (elements, functions) = (basis.num_elements(), basis.num_functions());
        assert!(u32::try_from(elements.max(functions)).is_ok(), "fewer than 2^32 functions and elements");
        let mut element_start = Vec::with_capacity(elements + 1);
        let (mut element_ids, mut ids) = (Vec::new(), Vec::new());
        element_start.push(0);
        for e in 0..elements {
            basis.active(e, &mut ids);
            element_ids.extend(ids.iter().map(|&i| i as u32));
            element_start.push(element_ids.len());
        }
        let mut cell_start = vec![0usize; functions + 1];
        for &i in &element_ids {
            cell_start[i as usize + 1] += 1;
        }
        for i in 0..functions {
            cell_start[i + 1] += cell_start[i];
        }
        let (mut place, mut cells) = (cell_start.clone(), vec![(0u32, 0u32); element_ids.len()]);
        for e in 0..elements {
            for (a, &i) in element_ids[element_start[e]..element_start[e + 1]].iter().enumerate() {
                cells[place[i as usize]] = (e as u32, a as u32);
                place[i as usize] += 1;
            }
        }
        let mut pattern = Self { functions, element_start, element_ids, cell_start, cells, ptr: Vec::new(), cols: Vec::new() };
        let whole = numbers::patches(basis).and_then(|parts| match &parts[..] {
            [part] if numbers::is_whole(&part.ids, functions) => pattern.product(&part.block),
            _ => None,
        });
        (pattern.ptr, pattern.cols) = whole.unwrap_or_else(|| pattern.rows());
        pattern
    }

    /// Rows of one block that covers the basis: products of ranges per axis.
    fn product<const D: usize, T: Real>(&self, block: &Block<'_, D, T>) -> Option<(Vec<usize>, Vec<u32>)> {
        let elements: usize = block.axes.iter().map(|a| a.num_elements()).product();
        let functions: usize = block.axes.iter().map(|a| a.num_functions()).product();
        if block.first != 0 || elements != self.element_start.len() - 1 || functions != self.functions {
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
        let mut cols = vec![0u32; ptr[functions]];
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

    /// Rows of any basis, in two passes over the neighbours of every function.
    fn rows(&self) -> (Vec<usize>, Vec<u32>) {
        let mut mark = vec![u32::MAX; self.functions];
        let mut ptr = vec![0usize; self.functions + 1];
        for i in 0..self.functions {
            let mut count = 0;
            for &(e, _) in self.cells(i) {
                for &j in self.ids(e as usize) {
                    if mark[j as usize] != i as u32 {
                        mark[j as usize] = i as u32;
                        count += 1;
                    }
                }
            }
            ptr[i + 1] = ptr[i] + count;
        }
        let (mut place, mut cols) = (ptr.clone(), vec![0u32; ptr[self.functions]]);
        mark.fill(u32::MAX);
        for i in 0..self.functions {
            for &(e, _) in self.cells(i) {
                for &j in self.ids(e as usize) {
                    if mark[j as usize] != i as u32 {
                        mark[j as usize] = i as u32;
                        // the graph is symmetric: appending i to its neighbours for ascending i leaves every row sorted
                        cols[place[j as usize]] = i as u32;
                        place[j as usize] += 1;
                    }
                }
            }
        }
        (ptr, cols)
    }

    /// Number of functions.
    pub fn num_functions(&self) -> usize {
        self.functions
    }

    /// Number of elements.
    pub fn num_elements(&self) -> usize {
        self.element_start.len() - 1
    }

    /// Functions of `element` in the order of [`Basis::active`].
    #[inline]
    pub fn ids(&self, element: usize) -> &[u32] {
        &self.element_ids[self.element_start[element]..self.element_start[element + 1]]
    }

    /// (element, local number) of function `i` wherever it is active, elements ascending.
    #[inline]
    pub fn cells(&self, i: usize) -> &[(u32, u32)] {
        &self.cells[self.cell_start[i]..self.cell_start[i + 1]]
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

    /// A zero matrix for fields of `components` components, unknown = components * function + component, in blocks of that size.
    ///
    /// # Panics
    /// If there are 2^32 unknowns or more.
    pub fn csr<T: Real>(&self, components: usize) -> Csr<T> {
        Csr::zeros(Arc::new(Sparsity::new(components, self.functions, self.ptr.clone(), self.cols.clone())))
    }
}

/// Rows handed to one task at a time.
const ROWS_PER_TASK: usize = 512;

/// Calls `fill(i, row i of data)` for all rows, in parallel over runs of rows.
pub(super) fn each_row<X: Send>(ptr: &[usize], data: &mut [X], fill: impl Fn(usize, &mut [X]) + Sync) {
    // no memory: the second array has elements of no size
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
    tasks.into_par_iter().for_each(|(range, x, y)| {
        let mut rest = (x, y);
        for i in range {
            let (x, others_x) = rest.0.split_at_mut(ptr[i + 1] - ptr[i]);
            let (y, others_y) = rest.1.split_at_mut(ptr[i + 1] - ptr[i]);
            rest = (others_x, others_y);
            fill(i, x, y);
        }
    });
}
