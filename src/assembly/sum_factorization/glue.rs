//! Patches glued to one body: the numbers of their functions in the whole, and the pattern of the union.

use super::Patch;
use crate::assembly::pattern::each_row;
use rayon::prelude::*;

/// Rows whose neighbours are gathered by one task.
const ROWS_AT_ONCE: usize = 512;

/// The functions of all patches, one patch after the other, and their numbers in the whole.
#[derive(Clone, Debug)]
pub(in crate::assembly) struct Glue {
    /// Functions of the whole.
    pub functions: usize,
    /// Number in the whole of every function of the patches.
    pub ids: Vec<u32>,
    /// First function of every patch, and the number of all.
    pub first: Vec<usize>,
    /// End of the run of consecutive numbers that starts at each function of the patches.
    pub run_end: Vec<usize>,
    /// Whether the rows of a function of the whole are those of one function of one patch, in the same order.
    pub direct: Vec<bool>,
    /// Functions of the whole that are several functions of one patch.
    pub merged: Vec<usize>,
    /// First and last neighbour of every function of every direction of the patches.
    columns: Vec<(usize, usize)>,
    /// Functions of the patches that form every function of the whole, ascending.
    start: Vec<usize>,
    owners: Vec<usize>,
}

impl Glue {
    /// The functions of `patches` under the numbers `ids`, below `functions`.
    pub(super) fn new(patches: &[Patch<'_>], ids: Vec<u32>, functions: usize) -> Self {
        let mut first = vec![0];
        first.extend(patches.iter().scan(0, |next, patch| {
            *next += patch.functions();
            Some(*next)
        }));
        let mut start = vec![0usize; functions + 1];
        ids.iter().for_each(|&id| start[id as usize + 1] += 1);
        for k in 0..functions {
            start[k + 1] += start[k];
        }
        let (mut next, mut owners) = (start.clone(), vec![0; ids.len()]);
        for (i, &id) in ids.iter().enumerate() {
            owners[next[id as usize]] = i;
            next[id as usize] += 1;
        }
        let mut run_end = vec![ids.len(); ids.len()];
        for own in first.windows(2) {
            run_end[own[0]..own[1]].fill(own[1]);
            for i in (own[0] + 1..own[1]).rev() {
                run_end[i - 1] = if ids[i] == ids[i - 1] + 1 { run_end[i] } else { i };
            }
        }
        let columns = columns(patches).collect();
        let mut glue = Self { functions, ids, first, run_end, direct: Vec::new(), merged: Vec::new(), columns, start, owners };
        let patch_of = |i: usize| glue.first.partition_point(|&f| f <= i);
        glue.merged = (0..functions).filter(|&k| glue.owners(k).windows(2).any(|w| patch_of(w[0]) == patch_of(w[1]))).collect();
        glue.direct = (0..functions).into_par_iter().with_min_len(ROWS_AT_ONCE).map(|k| glue.is_direct(patches, k)).collect();
        glue
    }

    /// Whether this is [`Self::new`] of the same patches, numbers and functions.
    pub(super) fn is_of(&self, patches: &[Patch<'_>], ids: impl Iterator<Item = u32>, functions: usize) -> bool {
        let sizes = self.first.windows(2).map(|w| w[1] - w[0]);
        let same = self.functions == functions && sizes.eq(patches.iter().map(Patch::functions));
        same && columns(patches).eq(self.columns.iter().copied()) && ids.eq(self.ids.iter().copied())
    }

    /// Functions of the patches that form function `k` of the whole.
    fn owners(&self, k: usize) -> &[usize] {
        &self.owners[self.start[k]..self.start[k + 1]]
    }

    /// Calls `visit(from, to)` for the runs of neighbours of function `i` of the patches, within the patch.
    fn runs(&self, patches: &[Patch<'_>], i: usize, mut visit: impl FnMut(usize, usize)) {
        let patch = self.first.partition_point(|&f| f <= i) - 1;
        let (to, first) = (patches[patch].directions(), self.first[patch]);
        let (n0, n1) = (to.fast.functions, to.middle.functions);
        let own = i - first;
        let columns = [to.fast.columns[own % n0], to.middle.columns[own / n0 % n1], to.slow.columns[own / n0 / n1]];
        for slow in columns[2].0..columns[2].1 {
            for middle in columns[1].0..columns[1].1 {
                let line = first + n0 * (middle + n1 * slow);
                visit(line + columns[0].0, line + columns[0].1);
            }
        }
    }

    fn is_direct(&self, patches: &[Patch<'_>], k: usize) -> bool {
        let &[i] = self.owners(k) else { return false };
        let (mut ascending, mut last) = (true, None);
        self.runs(patches, i, |from, to| {
            ascending &= self.run_end[from] >= to && last.is_none_or(|last| last < self.ids[from]);
            last = Some(self.ids[to - 1]);
        });
        ascending
    }

    /// The neighbours of function `k`, ascending.
    fn neighbours(&self, patches: &[Patch<'_>], k: usize, row: &mut Vec<u32>) {
        row.clear();
        for &i in self.owners(k) {
            self.runs(patches, i, |from, to| row.extend_from_slice(&self.ids[from..to]));
        }
        if !self.direct[k] {
            row.sort_unstable();
            row.dedup();
        }
    }

    /// Row pointers and columns of scalar functions.
    pub(super) fn pattern(&self, patches: &[Patch<'_>]) -> (Vec<usize>, Vec<u32>) {
        let count = |row: &mut Vec<u32>, k: usize| {
            if self.direct[k] {
                let mut sum = 0;
                self.runs(patches, self.owners(k)[0], |from, to| sum += to - from);
                return sum;
            }
            self.neighbours(patches, k, row);
            row.len()
        };
        let counts: Vec<usize> = (0..self.functions).into_par_iter().with_min_len(ROWS_AT_ONCE).map_init(Vec::new, count).collect();
        let mut ptr = Vec::with_capacity(self.functions + 1);
        ptr.push(0usize);
        for count in counts {
            ptr.push(ptr[ptr.len() - 1] + count);
        }
        let mut cols = vec![0u32; ptr[self.functions]];
        each_row(&ptr, &mut cols, |k, out| {
            if self.direct[k] {
                let mut rest = out;
                self.runs(patches, self.owners(k)[0], |from, to| {
                    let (own, others) = std::mem::take(&mut rest).split_at_mut(to - from);
                    own.copy_from_slice(&self.ids[from..to]);
                    rest = others;
                });
            } else {
                let mut row = Vec::with_capacity(2 * out.len());
                self.neighbours(patches, k, &mut row);
                out.copy_from_slice(&row);
            }
        });
        (ptr, cols)
    }
}

/// First and last neighbour of every function, direction by direction, patch by patch.
fn columns<'a>(patches: &'a [Patch<'_>]) -> impl Iterator<Item = (usize, usize)> + 'a {
    patches.iter().flat_map(|patch| {
        let to = patch.directions();
        [to.fast, to.middle, to.slow].into_iter().flat_map(|axis| axis.columns.iter().copied())
    })
}
