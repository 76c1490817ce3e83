//! Pᵀ K P: in the blocks of the bodies where every node is free or held as a whole, else entry by entry.

use super::blocks::Blocks;
use super::pattern::{each_row, each_row_pair};
use super::reduce::{Bound, Reduced};
use crate::linalg::{Buffer, Csr, Operator, Real, Sparsity};
use std::collections::BTreeMap;
use std::sync::Arc;

impl<T: Real> Reduced<T> {
    /// Pᵀ K P of matrices of the same sizes.
    pub fn matrix<'m>(&self, matrices: impl Into<Blocks<'m, T>>) -> Csr<T> {
        let matrices: Blocks<'m, T> = matrices.into();
        let matrix = match self.block(matrices) {
            Some(c) => self.in_blocks(matrices, c),
            None => self.by_entries(matrices),
        };
        if matrices.bodies.iter().any(|m| m.dof_coordinates().len() != m.num_rows()) {
            return matrix;
        }
        let places: Vec<[f64; 3]> = matrices.bodies.iter().flat_map(|m| m.dof_coordinates().iter().copied()).collect();
        matrix.with_dof_coordinates(self.free.iter().map(|&i| places[i]).collect())
    }

    /// The block of all bodies, where they have one and all unknowns of a block are free or all are prescribed.
    fn block(&self, matrices: Blocks<'_, T>) -> Option<usize> {
        let c = matrices.bodies.first()?.pattern().block();
        let whole = |group: &[Bound<T>]| {
            group.iter().all(|b| matches!(b, Bound::Free(_))) || group.iter().all(|b| matches!(b, Bound::Terms(t) if t.is_empty()))
        };
        let same = matrices.between.is_none() && matrices.bodies.iter().all(|m| m.pattern().block() == c);
        (c > 1 && same && self.bound.chunks(c).all(whole)).then_some(c)
    }

    fn in_blocks(&self, matrices: Blocks<'_, T>, c: usize) -> Csr<T> {
        let starts = matrices.starts();
        let groups: Vec<usize> = self.free.iter().step_by(c).map(|&i| i / c).collect();
        let mut number = vec![u32::MAX; self.bound.len() / c];
        groups.iter().enumerate().for_each(|(new, &old)| number[old] = new as u32);
        // the body that free group k lies in, its row there, and where its columns go
        let line = |k: usize| {
            let i = c * groups[k];
            let body = starts.partition_point(|&s| s <= i) - 1;
            let (matrix, row, numbers) = (matrices.bodies[body], i - starts[body], &number[starts[body] / c..]);
            (matrix, row, matrix.pattern().group(row / c).iter().map(|&j| numbers[j as usize]))
        };
        let mut ptr = Vec::with_capacity(groups.len() + 1);
        ptr.push(0usize);
        for k in 0..groups.len() {
            ptr.push(ptr[k] + line(k).2.filter(|&j| j != u32::MAX).count());
        }
        let mut cols = Buffer::zeros(ptr[groups.len()]);
        each_row(&ptr, &mut cols, |k, out| {
            out.iter_mut().zip(line(k).2.filter(|&j| j != u32::MAX)).for_each(|(out, j)| *out = j);
        });
        let values: Vec<usize> = ptr.iter().map(|&p| c * c * p).collect();
        let mut matrix = Csr::zeros(Arc::new(Sparsity::of(c, groups.len(), ptr, cols)));
        each_row(&values, matrix.vals_mut(), |k, out| {
            let (from, row, targets) = line(k);
            let width = (out.len() / c).max(1);
            for (l, out) in out.chunks_exact_mut(width).enumerate() {
                let kept = targets.clone().zip(from.row(row + l).1.chunks_exact(c)).filter(|(j, _)| *j != u32::MAX);
                out.chunks_exact_mut(c).zip(kept).for_each(|(out, (_, values))| out.copy_from_slice(values));
            }
        });
        matrix
    }

    fn by_entries(&self, matrices: Blocks<'_, T>) -> Csr<T> {
        let starts = matrices.starts();
        // unknowns that a bound one brings into its equations, per free unknown
        let mut followers: BTreeMap<usize, Vec<(usize, T)>> = BTreeMap::new();
        for (i, bound) in self.bound.iter().enumerate() {
            if let Bound::Terms(terms) = bound {
                for &(k, coefficient) in terms {
                    followers.entry(k).or_default().push((i, coefficient));
                }
            }
        }
        let row_of = |i: usize| matrices.row(&starts, i);
        let simple = |i: usize, k: usize| {
            followers.is_empty()
                || !followers.contains_key(&k) && row_of(i).all(|(j, _)| !matches!(&self.bound[j], Bound::Terms(t) if !t.is_empty()))
        };
        let merged = |i: usize, k: usize| {
            let mut row: BTreeMap<usize, T> = BTreeMap::new();
            for &(i, factor) in std::iter::once(&(i, T::one())).chain(followers.get(&k).into_iter().flatten()) {
                for (j, value) in row_of(i) {
                    self.each_term(j, |col, c| *row.entry(col).or_insert(T::zero()) += factor * value * c);
                }
            }
            row
        };
        let mut ptr = Vec::with_capacity(self.num_free() + 1);
        ptr.push(0usize);
        for (k, &i) in self.free.iter().enumerate() {
            let count = if simple(i, k) { row_of(i).filter(|&(j, _)| self.is_free(j)).count() } else { merged(i, k).len() };
            ptr.push(ptr[k] + count);
        }
        let entries = ptr[self.num_free()];
        let (mut cols, mut vals) = (Buffer::zeros(entries), Buffer::zeros(entries));
        each_row_pair(&ptr, &mut cols, &mut vals, |k, cols, vals| {
            let i = self.free[k];
            let slots = cols.iter_mut().zip(vals);
            if simple(i, k) {
                let free = row_of(i).filter_map(|(j, value)| match self.bound[j] {
                    Bound::Free(col) => Some((col, value)),
                    Bound::Terms(_) => None,
                });
                slots.zip(free).for_each(|(slot, (j, value))| (*slot.0, *slot.1) = (j as u32, value));
            } else {
                slots.zip(merged(i, k)).for_each(|(slot, (j, value))| (*slot.0, *slot.1) = (j as u32, value));
            }
        });
        Csr::of(Arc::new(Sparsity::of(1, self.num_free(), ptr, cols)), vals)
    }
}
