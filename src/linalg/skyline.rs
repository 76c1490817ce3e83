//! L U of a sparse matrix within its profile (skyline), without pivoting: for matrices whose graph is a curve.
//!
//! Rows and columns are renumbered by breadth first search, so open curves have a band and closed ones a band of twice the width. Without
//! pivoting it is stable for positive definite and for totally positive matrices: Gram and collocation matrices of splines.
//! Source for totally positive matrices: de Boor, Pinkus, Numer. Math. 27 (1977) 485-490.

use super::{Csr, Real, lit};

/// Relative size, against the largest entry of its row, below which a pivot is zero.
const NO_PIVOT: f64 = 1e-13;

/// P A Pᵀ = L U with a unit lower triangle, in the symmetric profile of A.
#[derive(Clone, Debug, PartialEq)]
pub struct ProfileLu<T: Real = f64> {
    /// Old number of every new row.
    order: Vec<usize>,
    /// First column of row i of L and first row of column i of U.
    first: Vec<usize>,
    /// Row i of L and column i of U begin here; row i has i - first(i) entries, its column one more: the pivot.
    start: Vec<usize>,
    lower: Vec<T>,
    upper: Vec<T>,
}

/// Reason why a matrix has no factors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProfileFault {
    /// Its profile has more entries than allowed.
    TooLarge {
        /// Entries of one triangle.
        entries: usize,
    },
    /// The pivot of this row and column vanishes: the row depends on others.
    Pivot {
        /// Number of the row in the matrix.
        row: usize,
    },
}

impl<T: Real> ProfileLu<T> {
    /// Factorises the square matrix `a`, whose profile may have at most `most` entries per triangle.
    ///
    /// # Errors
    /// [`ProfileFault`] if the profile is too large or a pivot vanishes.
    pub fn try_new(a: &Csr<T>, most: usize) -> Result<Self, ProfileFault> {
        let order = breadth_first(a);
        let n = order.len();
        let mut place = vec![0; n];
        order.iter().enumerate().for_each(|(new, &old)| place[old] = new);
        let mut first: Vec<usize> = (0..n).collect();
        for old in 0..n {
            for c in a.row(old).0 {
                let (i, j) = (place[old].max(place[c]), place[old].min(place[c]));
                first[i] = first[i].min(j);
            }
        }
        let mut start = vec![0];
        for i in 0..n {
            start.push(start[i] + i - first[i] + 1);
        }
        if start[n] > most {
            return Err(ProfileFault::TooLarge { entries: start[n] });
        }
        let mut lu = Self { order, first, lower: vec![T::zero(); start[n]], upper: vec![T::zero(); start[n]], start };
        let mut scale = vec![T::zero(); n];
        for old in 0..n {
            let (cols, vals) = a.row(old);
            for (c, &v) in cols.zip(vals) {
                let (i, j) = (place[old], place[c]);
                scale[i] = scale[i].max(v.abs());
                if j < i {
                    lu.lower[lu.start[i] + j - lu.first[i]] = v;
                } else {
                    lu.upper[lu.start[j] + i - lu.first[j]] = v;
                }
            }
        }
        for i in 0..n {
            lu.eliminate(i);
            if lu.pivot(i).abs() <= scale[i] * lit(NO_PIVOT) {
                return Err(ProfileFault::Pivot { row: lu.order[i] });
            }
        }
        Ok(lu)
    }

    fn pivot(&self, i: usize) -> T {
        self.upper[self.start[i + 1] - 1]
    }

    /// Computes row i of L and column i of U from the previous ones.
    fn eliminate(&mut self, i: usize) {
        let at = self.start[i];
        for j in self.first[i]..i {
            let from = self.first[i].max(self.first[j]);
            let (own, other, terms) = (at + from - self.first[i], self.start[j] + from - self.first[j], j - from);
            let (mut l, mut u) = (self.lower[at + j - self.first[i]], self.upper[at + j - self.first[i]]);
            for k in 0..terms {
                l -= self.lower[own + k] * self.upper[other + k];
                u -= self.lower[other + k] * self.upper[own + k];
            }
            self.lower[at + j - self.first[i]] = l / self.pivot(j);
            self.upper[at + j - self.first[i]] = u;
        }
        let before = i - self.first[i];
        let sum = (0..before).fold(T::zero(), |s, k| s + self.lower[at + k] * self.upper[at + k]);
        self.upper[at + before] -= sum;
    }

    /// Solves A x = b in place.
    pub fn solve(&self, b: &mut [T]) {
        self.triangles(b, &self.lower, &self.upper, |x, _| x, |x, pivot| x / pivot);
    }

    /// Solves Aᵀ x = b in place.
    pub fn solve_transposed(&self, b: &mut [T]) {
        self.triangles(b, &self.upper, &self.lower, |x, pivot| x / pivot, |x, _| x);
    }

    /// Forward by the rows of `forward`, backward by the columns of `backward`; the pivot goes to one of them.
    fn triangles(&self, b: &mut [T], forward: &[T], backward: &[T], down: impl Fn(T, T) -> T, up: impl Fn(T, T) -> T) {
        let n = self.order.len();
        let mut x: Vec<T> = self.order.iter().map(|&old| b[old]).collect();
        for i in 0..n {
            let (at, first) = (self.start[i], self.first[i]);
            let sum = (0..i - first).fold(x[i], |s, k| s - forward[at + k] * x[first + k]);
            x[i] = down(sum, self.pivot(i));
        }
        for i in (0..n).rev() {
            let (at, first) = (self.start[i], self.first[i]);
            x[i] = up(x[i], self.pivot(i));
            let value = x[i];
            (0..i - first).for_each(|k| x[first + k] -= backward[at + k] * value);
        }
        self.order.iter().zip(x).for_each(|(&old, v)| b[old] = v);
    }
}

/// Rows in the order of a breadth first search, neighbours by their degree; every part begins at a row of least degree.
fn breadth_first<T: Real>(a: &Csr<T>) -> Vec<usize> {
    let n = a.num_rows();
    let mut near: Vec<Vec<usize>> = vec![Vec::new(); n];
    for i in 0..n {
        for j in a.row(i).0.filter(|&j| j != i) {
            near[i].push(j);
            near[j].push(i);
        }
    }
    for list in &mut near {
        list.sort_unstable();
        list.dedup();
    }
    let mut roots: Vec<usize> = (0..n).collect();
    roots.sort_by_key(|&i| (near[i].len(), i));
    let (mut seen, mut order) = (vec![false; n], Vec::with_capacity(n));
    for root in roots {
        if seen[root] {
            continue;
        }
        seen[root] = true;
        order.push(root);
        let mut next = order.len() - 1;
        while next < order.len() {
            let mut new: Vec<usize> = near[order[next]].iter().copied().filter(|&j| !seen[j]).collect();
            new.sort_by_key(|&j| (near[j].len(), j));
            for j in new {
                seen[j] = true;
                order.push(j);
            }
            next += 1;
        }
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::Triplets;

    /// A ring of `n` rows with two neighbours on either side and unequal entries.
    fn ring(n: usize) -> Csr {
        let mut t = Triplets::new(n, n);
        for i in 0..n {
            for (d, v) in [(0, 3.0), (1, 0.9), (2, 0.2), (n - 1, 0.4), (n - 2, 0.1)] {
                t.push(i, (i + d) % n, v + 0.01 * (i % 3) as f64);
            }
        }
        t.to_csr()
    }

    #[test]
    fn both_solves_undo_the_matrix_on_a_ring() {
        let a = ring(23);
        let lu = ProfileLu::try_new(&a, 1000).unwrap();
        let x: Vec<f64> = (0..23).map(|i| ((i * i) as f64).sin()).collect();
        let (mut b, mut c) = (vec![0.0; 23], vec![0.0; 23]);
        a.mul(&x, &mut b);
        a.add_transposed_mul(&x, &mut c);
        lu.solve(&mut b);
        lu.solve_transposed(&mut c);
        let far = |y: &[f64]| x.iter().zip(y).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
        assert!(far(&b) < 1e-14 && far(&c) < 1e-14);
    }

    #[test]
    fn a_ring_has_a_band_and_what_depends_on_others_is_named() {
        assert!(ProfileLu::try_new(&ring(400), 400 * 6).is_ok());
        assert!(matches!(ProfileLu::try_new(&ring(400), 800), Err(ProfileFault::TooLarge { .. })));
        let mut t = Triplets::new(2, 2);
        t.entries.extend([(0, 0, 1.0), (0, 1, 2.0), (1, 0, 2.0), (1, 1, 4.0)]);
        assert_eq!(ProfileLu::try_new(&t.to_csr(), 10).unwrap_err(), ProfileFault::Pivot { row: 1 });
    }
}
