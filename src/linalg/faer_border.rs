//! Sparse rows as a border of a factorised matrix: their Schur complement, by forward elimination alone.
//!
//!   P A Pᵀ = L D Lᵀ,   X = L⁻¹ P Cᵀ,   C A⁻¹ Cᵀ = Xᵀ D⁻¹ X
//!
//! X has entries only in the nodes of the factor (supernodes, or single columns) between those that a row touches and the root of the
//! elimination tree. A node's part of X is dropped once processed; only the updates from lower nodes to higher ones are stored.
//! Single-threaded: results do not depend on the number of threads.
//!
//! Sources: Gilbert, Peierls, SIAM J. Sci. Stat. Comput. 9 (1988) 862-874 (sparse right-hand sides); Liu, SIAM Review 34 (1992) 82-109.

use super::multifrontal::lower_product;
use super::{Buffer, Csr};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::solve_unit_lower_triangular_in_place;
use faer::sparse::linalg::cholesky::SymbolicCholeskyRaw;
use faer::{Accum, MatMut, MatRef, Par};
use std::ops::Range;

/// The nodes of a factor: its supernodes, or its single columns. The values of a node are stored by columns, with D on the diagonal.
#[derive(Clone, Copy)]
pub(super) struct Nodes<'a>(pub &'a SymbolicCholeskyRaw<usize>);

/// A node: its columns, the rows below them, and the range of its values.
pub(super) struct Supernode<'a> {
    pub begin: usize,
    pub width: usize,
    pub below: &'a [usize],
    pub values: Range<usize>,
}

impl Supernode<'_> {
    fn height(&self) -> usize {
        self.width + self.below.len()
    }
}

impl<'a> Nodes<'a> {
    pub fn len(self) -> usize {
        match self.0 {
            SymbolicCholeskyRaw::Simplicial(s) => s.nrows(),
            SymbolicCholeskyRaw::Supernodal(s) => s.n_supernodes(),
        }
    }

    pub fn node(self, k: usize) -> Supernode<'a> {
        match self.0 {
            SymbolicCholeskyRaw::Simplicial(s) => {
                let values = s.col_ptr()[k]..s.col_ptr()[k + 1];
                Supernode { begin: k, width: 1, below: &s.row_idx()[values.start + 1..values.end], values }
            }
            SymbolicCholeskyRaw::Supernodal(s) => {
                let (begin, end) = (s.supernode_begin()[k], s.supernode_end()[k]);
                Supernode {
                    begin,
                    width: end - begin,
                    below: s.supernode(k).pattern(),
                    values: s.col_ptr_for_val()[k]..s.col_ptr_for_val()[k + 1],
                }
            }
        }
    }

    /// Rows of the largest node.
    pub fn highest(self) -> usize {
        (0..self.len()).map(|k| self.node(k).height()).max().unwrap_or(0)
    }

    /// Operations of the factorisation, a multiplication and an addition counted as two.
    pub fn operations(self) -> f64 {
        let of = |k| {
            let node = self.node(k);
            (node.below.len() + 1..=node.height()).map(|h| (h * h) as f64).sum::<f64>()
        };
        (0..self.len()).map(of).sum()
    }

    /// The node of each column.
    fn of_columns(self, n: usize) -> Vec<usize> {
        let mut node = vec![0; n];
        for k in 0..self.len() {
            let Supernode { begin, width, .. } = self.node(k);
            node[begin..begin + width].fill(k);
        }
        node
    }
}

/// Rows of the border and the nodes that each of them reaches.
#[derive(Debug)]
pub(crate) struct Border {
    /// The rows, as numbered by the caller.
    pub(crate) rows: Vec<usize>,
    /// Nodes that some row reaches, ascending; every node above one of them is among them.
    pub(super) nodes: Vec<usize>,
    /// Starts in `reaching` of the rows that reach each of `nodes`.
    first: Vec<usize>,
    /// Indices into `rows`, ascending in every node.
    reaching: Vec<u32>,
    /// Operations for X, and for Xᵀ D⁻¹ X.
    pub(crate) operations: [f64; 2],
    /// Largest number of values stored at once beside the Schur complement.
    scratch: usize,
}

impl Border {
    /// Border of the rows `chosen` of `c`, whose unknown j is column `new[j]` of the factor.
    pub(super) fn of(nodes: Nodes<'_>, new: &[usize], c: &Csr<f64>, chosen: &[usize]) -> Self {
        let node = nodes.of_columns(new.len());
        let mut waiting: Vec<Vec<u32>> = vec![Vec::new(); nodes.len()];
        for (at, &a) in (0u32..).zip(chosen) {
            for j in c.row(a).0 {
                waiting[node[new[j]]].push(at);
            }
        }
        let mut border =
            Self { rows: chosen.to_vec(), nodes: Vec::new(), first: vec![0], reaching: Vec::new(), operations: [0.0; 2], scratch: 0 };
        for k in 0..nodes.len() {
            let mut reaching = std::mem::take(&mut waiting[k]);
            if reaching.is_empty() {
                continue;
            }
            reaching.sort_unstable();
            reaching.dedup();
            let Supernode { width, below, .. } = nodes.node(k);
            if let Some(&row) = below.iter().min() {
                waiting[node[row]].extend_from_slice(&reaching);
            }
            let [w, h, r] = [width, below.len(), reaching.len()].map(|x| x as f64);
            border.operations[0] += r * w * (w + 2.0 * h);
            border.operations[1] += r * r * w;
            border.nodes.push(k);
            border.reaching.extend_from_slice(&reaching);
            border.first.push(border.reaching.len());
        }
        border.scratch = border.most_alive(nodes, &node);
        border
    }

    fn reaching(&self, at: usize) -> &[u32] {
        &self.reaching[self.first[at]..self.first[at + 1]]
    }

    /// Index in `nodes` of a node that is among them.
    fn place(&self, node: usize) -> usize {
        self.nodes.partition_point(|&k| k < node)
    }

    /// Largest number of values that [`Border::complement`] stores beside its result.
    fn most_alive(&self, nodes: Nodes<'_>, node: &[usize]) -> usize {
        let mut begun = vec![false; self.nodes.len()];
        let (mut alive, mut most) = (0, 0);
        for (at, &k) in self.nodes.iter().enumerate() {
            let own = nodes.node(k);
            let part = own.width * self.reaching(at).len();
            if !begun[at] {
                alive += part;
            }
            for &row in own.below {
                let above = self.place(node[row]);
                if !begun[above] {
                    begun[above] = true;
                    alive += nodes.node(node[row]).width * self.reaching(above).len();
                }
            }
            let square = self.reaching(at).len().pow(2);
            most = most.max(alive + part + square.max(own.below.len() * self.reaching(at).len()));
            alive -= part;
        }
        most
    }

    /// Memory in bytes of the Schur complement, its computation and these lists.
    pub(crate) fn bytes(&self) -> usize {
        8 * (self.rows.len() * self.rows.len() + self.scratch + self.nodes.len() + self.first.len()) + 4 * self.reaching.len()
    }

    /// C A⁻¹ Cᵀ, column after column, of which only the lower triangle is set. `None` if out of memory.
    pub(super) fn complement(&self, nodes: Nodes<'_>, factor: &[f64], new: &[usize], c: &Csr<f64>) -> Option<Buffer<f64>> {
        let m = self.rows.len();
        let node = nodes.of_columns(new.len());
        let mut sum = Buffer::try_zeros(m * m)?;
        let mut entries = self.entries(&node, new, c);
        entries.reverse();
        let mut parts: Vec<Buffer<f64>> = (0..self.nodes.len()).map(|_| Buffer::default()).collect();
        let (mut product, mut scaled, mut position) = (Vec::new(), Vec::new(), Vec::new());
        for (at, &k) in self.nodes.iter().enumerate() {
            let (own, reaching) = (nodes.node(k), self.reaching(at));
            let (width, height, r) = (own.width, own.height(), reaching.len());
            let mut x = std::mem::take(&mut parts[at]);
            if x.is_empty() {
                x = Buffer::try_zeros(width * r)?;
            }
            while let Some(&(_, row, column, value)) = entries.last().filter(|e| e.0 == k) {
                let place = reaching.partition_point(|&a| a < row);
                x[place * width + column - own.begin] += value;
                entries.pop();
            }
            let panel = MatRef::from_column_major_slice(&factor[own.values.clone()], height, width);
            let (unit, lower) = panel.split_at_row(width);
            solve_unit_lower_triangular_in_place(unit, MatMut::from_column_major_slice_mut(&mut x, width, r), Par::Seq);
            // Xᵀ D⁻¹ X
            enough(&mut scaled, width * r)?;
            for (z, x) in scaled.chunks_exact_mut(width).zip(x.chunks_exact(width)) {
                (0..width).for_each(|i| z[i] = x[i] / panel[(i, i)]);
            }
            enough(&mut product, (r * r).max(own.below.len() * r))?;
            let x = MatRef::from_column_major_slice(&x, width, r);
            let z = MatRef::from_column_major_slice(&scaled[..width * r], width, r);
            lower_product(MatMut::from_column_major_slice_mut(&mut product[..r * r], r, r), x.transpose(), z.transpose());
            for (j, column) in product[..r * r].chunks_exact(r).enumerate() {
                let target = &mut sum[reaching[j] as usize * m..][..m];
                reaching[j..].iter().zip(&column[j..]).for_each(|(&a, v)| target[a as usize] -= v);
            }
            // update of the rows below the node
            let below = own.below.len();
            if below == 0 {
                continue;
            }
            let left = &mut product[..below * r];
            matmul(MatMut::from_column_major_slice_mut(left, below, r), Accum::Replace, lower, x, 1.0, Par::Seq);
            let mut begin = 0;
            while begin < below {
                let above = node[own.below[begin]];
                let Supernode { begin: first, width, .. } = nodes.node(above);
                let end = begin + own.below[begin..].iter().take_while(|&&row| node[row] == above).count();
                let place = self.place(above);
                let others = self.reaching(place);
                let target = &mut parts[place];
                if target.is_empty() {
                    *target = Buffer::try_zeros(width * others.len())?;
                }
                position.clear();
                let mut q = 0;
                for &a in reaching {
                    while others[q] < a {
                        q += 1;
                    }
                    position.push(q);
                }
                for (column, &q) in left.chunks_exact(below).zip(&position) {
                    let target = &mut target[q * width..(q + 1) * width];
                    own.below[begin..end].iter().zip(&column[begin..end]).for_each(|(&row, v)| target[row - first] -= v);
                }
                begin = end;
            }
        }
        Some(sum)
    }

    /// Entries of the rows as (node, row, column, value), by nodes.
    fn entries(&self, node: &[usize], new: &[usize], c: &Csr<f64>) -> Vec<(usize, u32, usize, f64)> {
        let mut entries = Vec::new();
        for (at, &a) in (0u32..).zip(&self.rows) {
            let (cols, vals) = c.row(a);
            entries.extend(cols.zip(vals).map(|(j, &v)| (node[new[j]], at, new[j], v)));
        }
        entries.sort_by_key(|e| e.0);
        entries
    }
}

/// Makes room for `n` values.
fn enough(v: &mut Vec<f64>, n: usize) -> Option<()> {
    if v.len() < n {
        v.try_reserve_exact(n - v.len()).ok()?;
        v.resize(n, 0.0);
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use crate::linalg::residual::trial_numbers;
    use crate::linalg::{Csr, Ldlt, LinearSolver, Triplets};
    use faer::sparse::linalg::cholesky::SymbolicCholeskyRaw;

    /// A box of nodes tied to all within `reach`, every seventh with a negative diagonal.
    fn tied(n: [usize; 3], reach: usize, placed: bool) -> Csr {
        let count = n.iter().product::<usize>();
        let place = |i: usize| [i % n[0], i / n[0] % n[1], i / (n[0] * n[1])];
        let (mut all, mut numbers) = (Triplets::new(count, count), trial_numbers(count * (2 * reach + 1).pow(3)).into_iter());
        for i in 0..count {
            for j in 0..i {
                let far = place(i).iter().zip(place(j)).map(|(a, b)| a.abs_diff(b)).max().unwrap();
                if far <= reach {
                    let v = numbers.next().unwrap() - 0.5;
                    all.push(i, j, v);
                    all.push(j, i, v);
                }
            }
            let own = 2.0 * (2.0 * reach as f64 + 1.0).powi(n.iter().filter(|&&n| n > 1).count() as i32);
            all.push(i, i, if i % 7 == 3 { -own } else { own });
        }
        let matrix = all.to_csr();
        if placed { matrix.with_dof_coordinates((0..count).map(|i| place(i).map(|x| x as f64)).collect()) } else { matrix }
    }

    /// Rows with two to five entries, some of which meet the same unknowns; the last has none.
    fn rows(m: usize, n: usize) -> Csr {
        let mut all = Triplets::new(m + 1, n);
        let numbers = trial_numbers(10 * m);
        for a in 0..m {
            for k in 0..2 + a % 4 {
                let at = ((numbers[10 * a + k] + 0.5) * 0.5 * n as f64) as usize;
                all.push(a, if k == 1 { n - 1 - a % 3 } else { at.min(n - 1) }, numbers[10 * a + 5 + k] - 0.5);
            }
        }
        all.to_csr()
    }

    /// C A⁻¹ Cᵀ by a solution for every row.
    fn by_solutions(a: &Csr, solver: &Ldlt, c: &Csr, chosen: &[usize]) -> Vec<f64> {
        let n = a.num_rows();
        let mut all = Vec::new();
        for &row in chosen {
            let (mut b, mut x) = (vec![0.0; n], vec![0.0; n]);
            let (cols, vals) = c.row(row);
            cols.zip(vals).for_each(|(j, &v)| b[j] += v);
            solver.solve(a, &b, &mut x).unwrap();
            let mut product = vec![0.0; c.num_rows()];
            c.mul(&x, &mut product);
            all.extend(chosen.iter().map(|&k| product[k]));
        }
        all
    }

    #[test]
    fn the_complement_is_that_of_solutions_row_by_row_for_supernodes_and_single_columns() {
        let mut seen = [false; 2];
        // a chain has single columns, a block with long couplings supernodes; places or not decides the order
        for (n, reach) in [([60, 1, 1], 1), ([16, 14, 1], 2), ([12, 11, 10], 1), ([300, 1, 1], 1)] {
            for placed in [false, true] {
                let a = tied(n, reach, placed);
                let c = rows(23, a.num_rows());
                let chosen: Vec<usize> = (0..24).filter(|k| k % 5 != 2).collect();
                let mut solver = Ldlt::new();
                solver.prepare(&a).unwrap();
                seen[usize::from(matches!(solver.raw(), SymbolicCholeskyRaw::Supernodal(_)))] = true;
                let border = solver.border(&c, &chosen);
                let found = solver.complement(&border, &c).unwrap();
                let expected = by_solutions(&a, &solver, &c, &chosen);
                let top = expected.iter().fold(0.0f64, |m, v| m.max(v.abs()));
                for j in 0..chosen.len() {
                    for i in j..chosen.len() {
                        let at = j * chosen.len() + i;
                        assert!((found[at] - expected[at]).abs() < 1e-13 * top, "{n:?} {i} {j}: {} {}", found[at], expected[at]);
                    }
                }
                assert!(border.operations[0] <= 23.0 * 2.0 * solver.size().0 as f64, "forward only, on what is reached");
            }
        }
        assert_eq!(seen, [true; 2], "both kinds of factors");
    }

    #[test]
    fn a_bordered_solution_is_that_of_the_bordered_system() {
        for (n, reach) in [([60, 1, 1], 1), ([12, 11, 10], 1)] {
            let a = tied(n, reach, true);
            let count = a.num_rows();
            let c = rows(17, count);
            let chosen: Vec<usize> = (0..17).step_by(2).collect();
            let mut solver = Ldlt::new();
            solver.prepare(&a).unwrap();
            let border = solver.border(&c, &chosen);
            let b: [Vec<f64>; 2] = std::array::from_fn(|k| trial_numbers(2 * count)[k * count..][..count].to_vec());
            let mut x = b.clone();
            let [one, two] = &mut x;
            let mut h = [Vec::new(), Vec::new()];
            // nu = 2 h, or 0
            solver
                .solve_bordered(&border, &c, [one, two], |r, values| {
                    h[r] = values.to_vec();
                    values.iter_mut().for_each(|v| *v *= if r == 0 { 2.0 } else { 0.0 });
                })
                .unwrap();
            for r in 0..2 {
                let (mut plain, mut product) = (vec![0.0; count], vec![0.0; c.num_rows()]);
                solver.solve(&a, &b[r], &mut plain).unwrap();
                c.mul(&plain, &mut product);
                let mut load = b[r].clone();
                for (h, &k) in h[r].iter().zip(&chosen) {
                    assert!((h - product[k]).abs() < 1e-13);
                    let (cols, vals) = c.row(k);
                    cols.zip(vals).for_each(|(j, v)| load[j] -= if r == 0 { 2.0 * h * v } else { 0.0 });
                }
                solver.solve(&a, &load, &mut plain).unwrap();
                assert!(plain.iter().zip(&x[r]).all(|(p, q)| (p - q).abs() < 1e-13), "{n:?} {r}");
            }
        }
    }
}
