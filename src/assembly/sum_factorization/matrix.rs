//! The matrix of a patch: row pointers and columns in closed form, then values.

use super::coefficient::Coefficient;
use super::rows::{self, Directions, RowScratch, Sums};
use super::sweep::{self, RowRange, SweepPlan, march};
use super::{Patch, Patches};
use crate::assembly::Form;
use crate::assembly::pattern::each_row;
use crate::assembly::source::Integrand;
use crate::linalg::{Buffer, Csr, Real, Sparsity};
use crate::parallel;
use std::ops::Range;
use std::sync::Arc;

/// Minimum number of rows of the slowest direction per march in the plane: every march starts some elements early.
const ROWS_AT_LEAST: usize = 16;
/// Marches per thread in the plane; tasks per thread of a layer's rows.
const TASKS_PER_THREAD: usize = 2;
/// Minimum width of a strip of the middle direction, per active function, when strips are narrowed to give every thread as many:
/// the overlap of narrower ones costs more than a march shared by threads.
const NARROW: usize = 3;

impl<'p> Patches<'p> {
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

    /// Writes the matrix of `form` to the values of `matrix`; `add`: adds to them.
    ///
    /// # Panics
    /// If `matrix` does not have the pattern of the basis.
    pub fn stiffness<const C: usize, const N: usize, T: Real>(&self, form: &Form<'_, C, N, T>, add: bool, matrix: &mut Csr<T>) {
        self.fill(&Coefficient { components: C, symmetric: form.symmetric, source: Integrand::new(form) }, add, matrix);
    }

    /// Writes the matrix of products of functions to the values of `matrix`.
    pub fn mass<T: Real>(&self, matrix: &mut Csr<T>) {
        self.fill(&Coefficient { components: 1, symmetric: true, source: Integrand::Mass }, false, matrix);
    }

    fn fill<T: Real>(&self, coefficient: &Coefficient<'_>, add: bool, matrix: &mut Csr<T>) {
        assert_eq!(matrix.num_rows(), coefficient.components * self.functions(), "the matrix has the pattern of the basis");
        let plans: Vec<SweepPlan<'_, '_>> = (0..self.patches.len()).map(|k| self.plan(k, coefficient)).collect();
        self.fill_strips(&plans, add, matrix);
    }

    /// The plan of patch `k`.
    pub(super) fn plan<'a>(&'a self, k: usize, coefficient: &'a Coefficient<'a>) -> SweepPlan<'a, 'p> {
        SweepPlan::new(&self.patches[k], self.part(k, coefficient.components), coefficient)
    }

    /// Writes the matrix of `plans`, one per patch, to the values of `matrix`.
    pub(super) fn fill_strips<T: Real>(&self, plans: &[SweepPlan<'_, '_>], add: bool, matrix: &mut Csr<T>) {
        match &self.glue {
            None => self.patches[0].fill_strips(&plans[0], add, matrix.vals_mut()),
            Some(glue) => rows::fill(plans, glue, add, matrix),
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

    /// Writes the matrix of `plan` to `values`, in strips of two directions, one thread per strip as far as all threads are busy.
    fn fill_strips<T: Real>(&self, plan: &SweepPlan<'_, '_>, add: bool, values: &mut [T]) {
        let threads = rayon::current_num_threads();
        let write = Write { to: self.directions(), components: plan.coefficient.components, add };
        let (rows, middle) = (write.to.slow.functions, write.to.middle.functions);
        assert_eq!(values.len(), write.place(0, rows), "the matrix has the pattern of the basis");
        let mut strips = plan.strips();
        // as many for every thread, unless they become narrow
        let count = (strips[1].len()..).find(|count| (strips[0].len() * count).is_multiple_of(threads)).unwrap_or(1);
        let even = middle.div_ceil(count);
        if even >= NARROW * write.to.middle.active {
            strips[1] = sweep::cut(middle, even);
        }
        let plane = self.axes.len() == 2;
        // in the plane there is no other way to share the work; every march starts some elements early
        let slabs = if plane && threads > 1 { (TASKS_PER_THREAD * threads).min(rows / ROWS_AT_LEAST).max(1) } else { 1 };
        let mut parts = write.parts(&strips, &sweep::cut(rows, rows.div_ceil(slabs)), values);
        // inside the pool, so that no pass has to enter it
        rayon::scope(|_| {
            // parts that would leave some threads without one are shared by all
            let shared = parts.split_off(if plane { parts.len() } else { parts.len() / threads * threads });
            parallel::for_each(parts.into_iter(), |part| write.march(plan, part, 1));
            shared.into_iter().for_each(|part| write.march(plan, part, threads));
        });
    }
}

/// Destination of complete sums: the rows of a matrix on a patch.
#[derive(Clone, Copy)]
struct Write<'a> {
    to: Directions<'a>,
    components: usize,
    add: bool,
}

/// A part of the rows and their values, one piece per function of the slow and of the middle direction.
type Pieces<'v, T> = (RowRange, Vec<&'v mut [T]>);

impl Write<'_> {
    /// Place of all rows of one function of the middle and one of the slow direction.
    fn place(&self, middle: usize, slow: usize) -> usize {
        self.components * self.components * self.to.entries(middle, slow)
    }

    /// `values` cut into `strips` of the fast and of the middle and `slabs` of the slow direction.
    fn parts<'v, T>(&self, [fast, middle]: &[Vec<Range<usize>>; 2], slabs: &[Range<usize>], values: &'v mut [T]) -> Vec<Pieces<'v, T>> {
        let (mut parts, mut rest) = (Vec::with_capacity(fast.len() * middle.len() * slabs.len()), values);
        let sums = &self.to.fast.sums;
        for slow in slabs {
            let first = parts.len();
            for middle in middle {
                parts.extend(fast.iter().map(|fast| {
                    let part = RowRange { fast: fast.clone(), middle: middle.clone(), slow: slow.clone() };
                    (part, Vec::with_capacity(middle.len() * slow.len()))
                }));
            }
            for slow in slow.clone() {
                for (middle, parts) in middle.iter().zip(parts[first..].chunks_exact_mut(fast.len())) {
                    for k in middle.clone() {
                        // entries per neighbour along the fast direction
                        let runs = (self.place(k + 1, slow) - self.place(k, slow)) / sums[self.to.fast.functions];
                        for (fast, (_, pieces)) in fast.iter().zip(parts.iter_mut()) {
                            let (own, others) = rest.split_at_mut(runs * (sums[fast.end] - sums[fast.start]));
                            pieces.push(own);
                            rest = others;
                        }
                    }
                }
            }
        }
        parts
    }

    /// The rows of a part, made by `threads`.
    fn march<T: Real>(&self, plan: &SweepPlan<'_, '_>, (part, pieces): Pieces<'_, T>, threads: usize) {
        let middle = part.middle.clone();
        let tasks = if threads == 1 { 1 } else { TASKS_PER_THREAD * threads };
        let share = middle.len().div_ceil(tasks).max(1);
        let (mut pieces, mut kept) = (pieces, vec![RowScratch::default(); tasks]);
        let mut planes = pieces.chunks_exact_mut(middle.len().max(1));
        march(plan, part, threads, &mut |sums: Sums<'_>, rows: Range<usize>| {
            for (slow, plane) in rows.zip(&mut planes) {
                let shares = plane.chunks_mut(share).zip(&mut kept).enumerate();
                parallel::for_each(shares, |(task, (own, scratch))| {
                    for (k, out) in (middle.start + task * share..).zip(own) {
                        sums.write(self.to, [k, slow], self.add, scratch, out);
                    }
                });
            }
        });
    }
}

/// Row pointers and columns of scalar functions on the product of `to`.
pub(super) fn pattern(to: Directions<'_>) -> (Vec<usize>, Buffer<u32>) {
    let (n0, n1, n2) = (to.fast.functions, to.middle.functions, to.slow.functions);
    let length = |columns: (usize, usize)| columns.1 - columns.0;
    let mut ptr = Vec::with_capacity(n0 * n1 * n2 + 1);
    let mut next = 0;
    ptr.push(next);
    for slow in 0..n2 {
        for middle in 0..n1 {
            let runs = length(to.middle.columns[middle]) * length(to.slow.columns[slow]);
            for fast in 0..n0 {
                next += runs * length(to.fast.columns[fast]);
                ptr.push(next);
            }
        }
    }
    let mut cols = Buffer::zeros(next);
    each_row(&ptr, &mut cols, |i, out| {
        let (fast, middle, slow) = (to.fast.columns[i % n0], to.middle.columns[i / n0 % n1], to.slow.columns[i / n0 / n1]);
        let mut runs = out.chunks_exact_mut(length(fast).max(1));
        for j2 in slow.0..slow.1 {
            for j1 in middle.0..middle.1 {
                let first = (fast.0 + n0 * (j1 + n1 * j2)) as u32;
                let run = runs.next().expect("one run per pair of the other directions");
                for (k, col) in run.iter_mut().enumerate() {
                    *col = first + k as u32;
                }
            }
        }
    });
    (ptr, cols)
}
