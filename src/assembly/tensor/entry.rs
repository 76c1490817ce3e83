//! The matrix of a patch: pattern, then values.

use super::coefficient::Coefficient;
use super::march::{Plan, march};
use super::pattern::pattern;
use super::write::{Directions, RowScratch, Sums};
use super::{Patch, Patches, scatter};
use crate::assembly::Form;
use crate::assembly::source::Source;
use crate::linalg::{Csr, Real, Sparsity};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// Rows of the slowest direction that a march in the plane takes at least: every march starts some elements early.
const ROWS_AT_LEAST: usize = 16;
/// Marches per thread in the plane; tasks per thread of a layer's rows.
const TASKS_PER_THREAD: usize = 2;

impl Patches<'_> {
    fn functions(&self) -> usize {
        self.glue.as_ref().map_or_else(|| self.patches[0].functions(), |glue| glue.functions)
    }

    /// A zero matrix for fields of `components` components, in blocks of that size.
    ///
    /// # Panics
    /// If there are 2^32 unknowns or more.
    pub fn csr<T: Real>(&self, components: usize) -> Csr<T> {
        let (ptr, cols) = match &self.glue {
            None => pattern(self.patches[0].directions()),
            Some(glue) => {
                let (ptr, cols) = glue.pattern(&self.patches);
                (ptr, cols.into())
            }
        };
        Csr::zeros(Arc::new(Sparsity::of(components, self.functions(), ptr, cols)))
    }

    /// The matrix of `form` to the values of `matrix`; `add`: on top of what is there.
    ///
    /// # Panics
    /// If `matrix` has not the pattern of the basis.
    pub fn stiffness<const C: usize, const N: usize, T: Real>(&self, form: &Form<'_, C, N, T>, add: bool, matrix: &mut Csr<T>) {
        self.fill(&Coefficient { components: C, symmetric: form.symmetric, source: Source::new(form) }, add, matrix);
    }

    /// The matrix of products of functions to the values of `matrix`.
    pub fn mass<T: Real>(&self, matrix: &mut Csr<T>) {
        self.fill(&Coefficient { components: 1, symmetric: true, source: Source::Mass }, false, matrix);
    }

    fn fill<T: Real>(&self, coefficient: &Coefficient<'_>, add: bool, matrix: &mut Csr<T>) {
        assert_eq!(matrix.num_rows(), coefficient.components * self.functions(), "the matrix has the pattern of the basis");
        match &self.glue {
            None => self.patches[0].fill(coefficient, add, matrix.vals_mut()),
            Some(glue) => scatter::fill(&self.patches, glue, coefficient, add, matrix),
        }
    }
}

impl Patch<'_> {
    /// The directions.
    pub(super) fn directions(&self) -> Directions<'_> {
        let n = self.axes.len();
        Directions { fast: &self.axes[0], middle: if n == 3 { &self.axes[1] } else { &self.none }, slow: &self.axes[n - 1] }
    }

    /// Number of functions.
    pub fn functions(&self) -> usize {
        self.axes.iter().map(|a| a.functions).product()
    }

    fn fill<T: Real>(&self, coefficient: &Coefficient<'_>, add: bool, values: &mut [T]) {
        let plan = Plan::new(self, coefficient);
        let (threads, solid) = (rayon::current_num_threads(), self.axes.len() == 3);
        let write = Write { to: self.directions(), components: coefficient.components, add };
        let rows = write.to.slow.functions;
        assert_eq!(values.len(), write.place(rows * write.to.middle.functions), "the matrix has the pattern of the basis");
        // inside the pool, so that no pass has to enter it
        rayon::scope(|_| {
            let marches = if solid { 1 } else { (TASKS_PER_THREAD * threads).min(rows / ROWS_AT_LEAST) };
            if threads == 1 || marches <= 1 {
                write.march(&plan, 0..rows, if solid { threads } else { 1 }, values);
                return;
            }
            // in the plane a block is a function of the slow direction
            let parts = write.parts(0..rows, rows.div_ceil(marches), values);
            parts.into_par_iter().for_each(|(rows, values)| write.march(&plan, rows, 1, values));
        });
    }
}

/// Where complete sums go.
#[derive(Clone, Copy)]
struct Write<'a> {
    to: Directions<'a>,
    components: usize,
    add: bool,
}

impl Write<'_> {
    /// Place of block `k`: all rows of one function of the slow and one of the middle direction.
    fn place(&self, k: usize) -> usize {
        let middle = self.to.middle.functions;
        self.components * self.components * self.to.entries(k % middle, k / middle)
    }

    /// `values` of `blocks`, cut into parts of `share` of them.
    fn parts<'v, T>(&self, blocks: Range<usize>, share: usize, values: &'v mut [T]) -> Vec<(Range<usize>, &'v mut [T])> {
        let (mut parts, mut rest) = (Vec::with_capacity(blocks.len().div_ceil(share)), values);
        for from in blocks.clone().step_by(share) {
            let part = from..(from + share).min(blocks.end);
            let (own, others) = rest.split_at_mut(self.place(part.end) - self.place(part.start));
            rest = others;
            parts.push((part, own));
        }
        parts
    }

    /// The rows of the functions `rows` of the slow direction to `values`.
    fn march<T: Real>(&self, plan: &Plan<'_, '_>, rows: Range<usize>, threads: usize, values: &mut [T]) {
        let middle = self.to.middle.functions;
        let tasks = if threads == 1 { 1 } else { TASKS_PER_THREAD * threads };
        let (mut rest, mut kept) = (values, vec![RowScratch::default(); tasks]);
        march(plan, rows, threads, &mut |sums: Sums<'_>, rows: Range<usize>| {
            let blocks = rows.start * middle..rows.end * middle;
            let (own, others) = std::mem::take(&mut rest).split_at_mut(self.place(blocks.end) - self.place(blocks.start));
            rest = others;
            let share = blocks.len().div_ceil(tasks).max(1);
            self.parts(blocks, share, own).into_par_iter().zip(&mut kept).for_each(|((part, mut own), scratch)| {
                for k in part {
                    let (block, others) = std::mem::take(&mut own).split_at_mut(self.place(k + 1) - self.place(k));
                    own = others;
                    sums.write(self.to, k % middle, k / middle, self.add, scratch, block);
                }
            });
        });
    }
}
