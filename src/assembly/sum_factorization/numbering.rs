//! Numbers of the functions of patches: in a basis, checked; in the whole of several patches that are glued, with the pattern of the
//! union; and in a vector of unknowns, with their weights.

use super::{Patch, Patches};
use crate::assembly::pattern::each_row;
use crate::basis::{Basis, TensorPatch};
use crate::linalg::{Real, lit, to_f64};
use crate::parallel;

/// The patches of `basis`, or the one block that covers it; `None` where they do not cover all elements, or where the basis
/// numbers its functions in another way than they say.
///
/// What patches say is trusted by everything that follows, so it is checked on elements that reach every function.
pub(in crate::assembly) fn patches<const N: usize, T: Real, B: Basis<N, T> + ?Sized>(basis: &B) -> Option<Vec<TensorPatch<'_, N, T>>> {
    let (elements, functions) = (basis.num_elements(), basis.num_functions());
    if elements == 0 || u32::try_from(functions).is_err() {
        return None;
    }
    let parts = match basis.structure().patches() {
        Some(parts) => parts,
        None => {
            let block = basis.structure().block(0)?;
            let ids = (0..block.axes.iter().map(|a| a.num_functions()).product()).collect();
            vec![TensorPatch { block, ids }]
        }
    };
    let mut next = 0;
    for part in &parts {
        let counts = part.block.axes.map(|a| a.num_elements());
        if part.block.first != next || next + counts.iter().product::<usize>() > elements || !agrees(basis, part) {
            return None;
        }
        next += counts.iter().product::<usize>();
    }
    (next == elements).then_some(parts)
}

/// Whether `ids` are all functions in their order.
pub(in crate::assembly) fn is_whole(ids: &[usize], functions: usize) -> bool {
    ids.len() == functions && ids.iter().enumerate().all(|(i, &id)| i == id)
}

/// Whether the elements of a patch have the functions that its numbers say.
fn agrees<const N: usize, T: Real, B: Basis<N, T> + ?Sized>(basis: &B, part: &TensorPatch<'_, N, T>) -> bool {
    let (elements, functions) = (part.block.axes.map(|a| a.num_elements()), part.block.axes.map(|a| a.num_functions()));
    if part.ids.len() != functions.iter().product::<usize>() || part.ids.iter().any(|&id| id >= basis.num_functions()) {
        return false;
    }
    let mut ids = Vec::new();
    // (element, its first and last function) along every axis
    let reach = part.block.axes.map(|axis| {
        let (mut chosen, mut reached) = (Vec::new(), 0);
        let mut last = None;
        for e in 0..axis.num_elements() {
            axis.active(e, &mut ids);
            let (Some(&from), Some(&to)) = (ids.first(), ids.last()) else { continue };
            if from > reached {
                chosen.extend(last.take());
            }
            reached = chosen.last().map_or(0, |&(_, _, to): &(usize, usize, usize)| to + 1);
            last = Some((e, from, to));
        }
        chosen.extend(last);
        chosen
    });
    let (mut own, mut lines) = (Vec::new(), [0; N]);
    for chosen in 0..reach.iter().map(Vec::len).product() {
        let mut rest = chosen;
        for k in 0..N {
            lines[k] = rest % reach[k].len();
            rest /= reach[k].len();
        }
        let at: [(usize, usize, usize); N] = std::array::from_fn(|k| reach[k][lines[k]]);
        let element = (0..N).rev().fold(0, |e, k| e * elements[k] + at[k].0);
        own.clear();
        let widths = at.map(|(_, from, to)| to + 1 - from);
        for mut rest in 0..widths.iter().product() {
            let (mut id, mut stride) = (0, 1);
            for k in 0..N {
                id += stride * (at[k].1 + rest % widths[k]);
                (rest, stride) = (rest / widths[k], stride * functions[k]);
            }
            own.push(id);
        }
        if own.iter().any(|&i| i >= part.ids.len()) {
            return false;
        }
        own.iter_mut().for_each(|i| *i = part.ids[*i]);
        basis.active(part.block.first + element, &mut ids);
        ids.sort_unstable();
        own.sort_unstable();
        own.dedup();
        if own != ids {
            return false;
        }
    }
    true
}

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
        glue.direct = parallel::map(functions, |k| glue.is_direct(patches, k));
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
        let counts: Vec<usize> = parallel::map_init(self.functions, Vec::new, count);
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

/// Unknowns of a patch within the whole.
#[derive(Clone, Copy, Debug)]
pub(super) struct PatchNumbering<'a> {
    /// Number in the whole of every function of the patch; `None` if they are the same.
    pub ids: Option<&'a [u32]>,
    /// One weight per function of a rational basis.
    pub weights: Option<&'a [f64]>,
    /// Numbers per function.
    pub width: usize,
}

impl PatchNumbering<'_> {
    /// Reads the coefficients of the patch's functions times their weights, from number `from` of the patch on; an empty `u` is zero.
    pub fn read<T: Real>(&self, u: &[T], from: usize, to: &mut [f64]) {
        if u.is_empty() {
            to.fill(0.0);
            return;
        }
        match self.ids {
            None => {
                let u = &u[from..from + to.len()];
                to.iter_mut().zip(u).for_each(|(to, &u)| *to = to_f64(u));
            }
            Some(ids) => {
                for (k, to) in (from..).zip(to.iter_mut()) {
                    *to = to_f64(u[self.width * ids[k / self.width] as usize + k % self.width]);
                }
            }
        }
        if let Some(weights) = self.weights {
            to.iter_mut().enumerate().for_each(|(k, to)| *to *= weights[(from + k) / self.width]);
        }
    }

    /// Calls `sum` with zeroed numbers of the patch and adds the result times the weights to `out`, which is zero before
    /// the first patch.
    pub fn add<T: Real>(&self, functions: usize, out: &mut [T], sum: impl FnOnce(&mut [T])) {
        let Some(ids) = self.ids else {
            sum(out);
            self.scale(out);
            return;
        };
        let mut own = vec![T::zero(); self.width * functions];
        sum(&mut own);
        self.scale(&mut own);
        for (own, &id) in own.chunks_exact(self.width).zip(ids) {
            out[self.width * id as usize..].iter_mut().zip(own).for_each(|(out, &own)| *out += own);
        }
    }

    fn scale<T: Real>(&self, out: &mut [T]) {
        if let Some(weights) = self.weights {
            out.chunks_exact_mut(self.width).zip(weights).for_each(|(out, &w)| out.iter_mut().for_each(|v| *v *= lit(w)));
        }
    }
}

impl Patches<'_> {
    /// The unknowns of patch `k` for fields of `width` components.
    pub(super) fn part(&self, k: usize, width: usize) -> PatchNumbering<'_> {
        let ids = self.glue.as_ref().map(|glue| &glue.ids[glue.first[k]..glue.first[k + 1]]);
        PatchNumbering { ids, weights: self.patches[k].weight.as_ref().map(|(_, weights)| &weights[..]), width }
    }
}
