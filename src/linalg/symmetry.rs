//! Symmetry test of a sparse matrix: compares every entry with its transposed partner in one pass without searches.

use super::csr::largest;
use super::{Csr, Real, Sparsity, lit};

impl<T: Real> Csr<T> {
    /// Whether |a_ij - a_ji| <= `tolerance` (m_i m_j)^1/2 everywhere, m_i the largest |entry| of row i; linear in the number of entries.
    pub fn is_symmetric(&self, tolerance: f64) -> bool {
        if self.num_rows() != self.num_cols() {
            return false;
        }
        let limit: Vec<T> = (0..self.num_rows()).map(|i| (largest(self.row(i).1) * lit(tolerance)).sqrt()).collect();
        match self.pattern().block() {
            1 => self.agrees::<1>(&limit),
            2 => self.agrees::<2>(&limit),
            3 => self.agrees::<3>(&limit),
            _ => self.agrees::<0>(&limit),
        }
    }

    /// Whether |a_ij - a_ji| <= `limit[i]` `limit[j]` everywhere, for blocks of C rows (C = 0: of any size).
    fn agrees<const C: usize>(&self, limit: &[T]) -> bool {
        let (pattern, vals) = (&**self.pattern(), self.vals());
        let agree = |i: usize, at: usize, j: usize, opposite: Option<usize>| agree::<C, T>(pattern, vals, limit, [i, at, j], opposite);
        // rows ascend: the next block of group j left of its diagonal is the partner of the block of group i, or has none
        let groups = pattern.ptr().len() - 1;
        let mut next = vec![0u32; groups];
        for i in 0..groups {
            for (at, &j) in pattern.group(i).iter().enumerate() {
                let j = j as usize;
                if j == i && !agree(i, at, i, Some(at)) {
                    return false;
                }
                if j <= i {
                    continue;
                }
                let row = pattern.group(j);
                while row.get(next[j] as usize).is_some_and(|&b| (b as usize) < i) {
                    if !agree(j, next[j] as usize, row[next[j] as usize] as usize, None) {
                        return false;
                    }
                    next[j] += 1;
                }
                let partner = row.get(next[j] as usize).is_some_and(|&b| b as usize == i);
                if !agree(i, at, j, partner.then_some(next[j] as usize)) {
                    return false;
                }
                next[j] += u32::from(partner);
            }
        }
        // remaining blocks left of the diagonal, without partner
        (0..groups).all(|j| {
            let row = pattern.group(j);
            (next[j] as usize..row.len()).take_while(|&at| (row[at] as usize) < j).all(|at| agree(j, at, row[at] as usize, None))
        })
    }
}

/// Whether block `at` of group `i` of rows, in column group `j`, agrees with the block `opposite` of group `j`, or with zero without one.
#[inline(always)]
fn agree<const C: usize, T: Real>(pattern: &Sparsity, vals: &[T], limit: &[T], [i, at, j]: [usize; 3], opposite: Option<usize>) -> bool {
    let (c, ptr) = (if C == 0 { pattern.block() } else { C }, pattern.ptr());
    let place = |i: usize, at: usize, k: usize, l: usize| if C == 1 { ptr[i] + at } else { pattern.place(i, at, k, l) };
    let mut good = true;
    for k in 0..c {
        for l in 0..c {
            let own = vals[place(i, at, k, l)];
            let other = opposite.map_or_else(T::zero, |at| vals[place(j, at, l, k)]);
            good &= (own - other).abs() <= limit[c * i + k] * limit[c * j + l];
        }
    }
    good
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::Triplets;

    fn matrix(entries: &[(usize, usize, f64)]) -> Csr {
        Triplets { rows: 4, cols: 4, entries: entries.to_vec() }.to_csr()
    }

    #[test]
    fn symmetry_is_seen_with_and_without_partners() {
        let even = [(0, 0, 2.0), (0, 3, 1.0), (3, 0, 1.0), (1, 2, -1.0), (2, 1, -1.0), (3, 3, 4.0), (2, 2, 1.0), (1, 1, 1.0)];
        assert!(matrix(&even).is_symmetric(0.0));
        for odd in [(0, 1, 1e-3), (1, 0, 1e-3), (3, 2, 1e-3), (2, 3, 1e-3), (3, 0, 1e-3), (1, 2, 1e-3)] {
            let more: Vec<_> = even.iter().copied().chain([odd]).collect();
            assert!(!matrix(&more).is_symmetric(1e-6), "{odd:?}");
            assert!(matrix(&more).is_symmetric(1e-2), "{odd:?}");
        }
    }
}
