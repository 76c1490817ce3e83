//! Numerical supernodal LDLᵀ factorisation by the multifrontal method.
//!
//! The front of a supernode assembles its entries of the matrix and the update matrices of its children, is factorised, and
//! passes its own update matrix, -L D Lᵀ of the rows below plus the rest of its children's, to its parent. Update matrices
//! wait on a stack: children come right before their parent. One dense product per supernode instead of one per pair.
//! The factor has the layout of faer's supernodal factor; nothing depends on the number of threads.
//!
//! Sources: Duff, Reid, ACM Trans. Math. Softw. 9 (1983) 302-325; Liu, SIAM Review 34 (1992) 82-109.

use super::Buffer;
use super::dense_panel::eliminate;
use super::packed::{add, triangle};
use faer::linalg::matmul::matmul;
use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;
use faer::{Accum, MatMut, MatRef, Par};

/// Columns of a front below which its lower triangle is computed as a full square.
const SQUARE: usize = 64;

/// Least size of the factor, as a multiple of the working memory of the fronts.
const SHARE: usize = 5;

/// Symbolic data of a multifrontal factorisation.
pub(super) struct Fronts {
    /// First entry of each supernode.
    first: Vec<usize>,
    /// Position of each entry in the values of the matrix, and its target in the columns of its supernode.
    entries: Vec<(u32, u32)>,
    /// Number of children of each supernode.
    children: Vec<u32>,
    /// Position of each row below a supernode in its parent's front, in the order of faer's row indices.
    position: Vec<u32>,
    /// Largest number of values on the stack, including the current front.
    stack: usize,
    /// Number of values in the columns of the largest supernode.
    largest: usize,
}

/// A supernode: its columns, and the rows below them.
struct Node<'a> {
    begin: usize,
    width: usize,
    below: &'a [usize],
}

impl<'a> Node<'a> {
    fn of(s: &'a SymbolicSupernodalCholesky<usize>, k: usize) -> Self {
        let begin = s.supernode_begin()[k];
        Self { begin, width: s.supernode_end()[k] - begin, below: s.supernode(k).pattern() }
    }

    fn rows(&self) -> impl Iterator<Item = usize> {
        (self.begin..self.begin + self.width).chain(self.below.iter().copied())
    }

    fn height(&self) -> usize {
        self.width + self.below.len()
    }
}

impl Fronts {
    /// Fronts of the upper triangle with rows `ptr`, `cols` in the order `new[old]`; `None` if children do not come right before their
    /// parents or an index does not fit 32 bits.
    pub fn of(s: &SymbolicSupernodalCholesky<usize>, ptr: &[usize], cols: &[usize], new: &[usize]) -> Option<Self> {
        let (n, count) = (s.nrows(), s.n_supernodes());
        u32::try_from(cols.len().max(n)).ok()?;
        let (start, mut entries) = by_column(ptr, cols, new);
        let mut node = vec![0usize; n];
        let (mut first, mut children, mut position) = (vec![0], vec![0u32; count], vec![0u32; s.row_idx().len()]);
        let (mut local, mut waiting) = (vec![u32::MAX; n], Vec::<usize>::new());
        let (mut top, mut stack, mut largest) = (0, 0, 0);
        for k in 0..count {
            let Node { begin, width, .. } = Node::of(s, k);
            node[begin..begin + width].fill(k);
        }
        for k in 0..count {
            let own = Node::of(s, k);
            own.rows().zip(0u32..).for_each(|(row, at)| local[row] = at);
            stack = stack.max(top + own.below.len() * own.below.len());
            largest = largest.max(own.width * own.height());
            while let Some(&child) = waiting.last() {
                let below = Node::of(s, child).below;
                if node[below[0]] > k {
                    break;
                }
                for (&row, at) in below.iter().zip(&mut position[s.col_ptr_for_row_idx()[child]..]) {
                    *at = local[row];
                    if *at == u32::MAX {
                        return None;
                    }
                }
                children[k] += 1;
                top -= triangle(below.len());
                waiting.pop();
            }
            for (column, from) in (own.begin..own.begin + own.width).zip((0..).step_by(own.height())) {
                for (_, target) in &mut entries[start[column]..start[column + 1]] {
                    *target = u32::try_from(local[*target as usize] as usize + from).ok()?;
                }
            }
            first.push(start[own.begin + own.width]);
            own.rows().for_each(|row| local[row] = u32::MAX);
            if !own.below.is_empty() {
                waiting.push(k);
                top += triangle(own.below.len());
            }
        }
        waiting.is_empty().then_some(Self { first, entries, children, position, stack, largest })
    }

    /// Bytes of these arrays.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.first) + size_of_val(&*self.entries) + 4 * (self.children.len() + self.position.len())
    }

    /// Bytes that a factorisation needs beside the factor.
    pub fn work_bytes(&self) -> usize {
        8 * (self.stack + self.largest)
    }

    /// Allocates the working memory of a factorisation; `None` if out of memory.
    pub fn work(&self) -> Option<[Buffer<f64>; 2]> {
        Some([Buffer::try_zeros(self.stack)?, Buffer::try_zeros(self.largest)?])
    }

    /// Whether the memory of the fronts is small enough beside a factor of `factor` values. In 2D fronts are faster than columns;
    /// in 3D dense products take most of the time either way, and the stack is a third of the factor.
    pub fn is_profitable(&self, factor: usize) -> bool {
        SHARE * (self.stack + self.largest) <= factor
    }

    /// Computes L and D of the matrix with the values `vals` of its upper triangle; `None` if a pivot is zero or not finite.
    pub fn factorise(
        &self,
        s: &SymbolicSupernodalCholesky<usize>,
        vals: &[f64],
        factor: &mut [f64],
        work: &mut [Buffer<f64>; 2],
    ) -> Option<()> {
        let [stack, scaled] = work;
        let (mut waiting, mut runs, mut top) = (Vec::<usize>::new(), Vec::new(), 0);
        for k in 0..s.n_supernodes() {
            let own = Node::of(s, k);
            let (height, width, below) = (own.height(), own.width, own.below.len());
            let panel = &mut factor[s.col_ptr_for_val()[k]..s.col_ptr_for_val()[k + 1]];
            panel.fill(0.0);
            for &(place, target) in &self.entries[self.first[k]..self.first[k + 1]] {
                panel[target as usize] += vals[place as usize];
            }
            let others = waiting.len() - self.children[k] as usize;
            let position = |child: usize| &self.position[s.col_ptr_for_row_idx()[child]..][..s.supernode(child).pattern().len()];
            let mut from = top;
            for &child in waiting[others..].iter().rev() {
                let position = position(child);
                from -= triangle(position.len());
                add(&stack[from..], position, [0, width], panel, height, &mut runs);
            }
            eliminate(panel, height, width, &mut scaled[..height * width])?;
            if below == 0 {
                waiting.truncate(others);
                top = from;
                continue;
            }
            let (held, front) = stack.split_at_mut(top);
            let front = &mut front[..below * below];
            let whole = |columns| MatRef::from_column_major_slice(columns, height, width).split_at_row(width).1;
            lower_product(MatMut::from_column_major_slice_mut(front, below, below), whole(&*panel), whole(&scaled[..height * width]));
            let mut at = top;
            for &child in waiting[others..].iter().rev() {
                let position = position(child);
                at -= triangle(position.len());
                add(&held[at..], position, [width, height], front, below, &mut runs);
            }
            // packed, where the children were
            let mut to = from;
            for column in 0..below {
                stack.copy_within(top + column * below + column..top + (column + 1) * below, to);
                to += below - column;
            }
            top = to;
            waiting.truncate(others);
            waiting.push(k);
        }
        Some(())
    }
}

/// Lower triangle of C = -A Bᵀ; what is above the diagonal of C is overwritten in part.
pub(super) fn lower_product(c: MatMut<'_, f64>, a: MatRef<'_, f64>, b: MatRef<'_, f64>) {
    let n = c.nrows();
    if n <= SQUARE {
        matmul(c, Accum::Replace, a, b.transpose(), -1.0, Par::Seq);
        return;
    }
    let half = n / 2;
    let ((a0, a1), (b0, b1)) = (a.split_at_row(half), b.split_at_row(half));
    let (c00, _, c10, c11) = c.split_at_mut(half, half);
    lower_product(c00, a0, b0);
    matmul(c10, Accum::Replace, a1, b0.transpose(), -1.0, Par::Seq);
    lower_product(c11, a1, b1);
}

/// The entries (row `ptr`, `cols` of the upper triangle) by columns of the permuted lower triangle: starts, and (place, new row).
fn by_column(ptr: &[usize], cols: &[usize], new: &[usize]) -> (Vec<usize>, Vec<(u32, u32)>) {
    let n = new.len();
    let mut start = vec![0usize; n + 2];
    let rows = || (0..n).flat_map(|i| (ptr[i]..ptr[i + 1]).map(move |k| (i, k)));
    for (i, k) in rows() {
        start[new[i].min(new[cols[k]]) + 2] += 1;
    }
    for column in 0..n {
        start[column + 2] += start[column + 1];
    }
    let mut entries = vec![(0, 0); cols.len()];
    for (i, k) in rows() {
        let (a, b) = (new[i], new[cols[k]]);
        let next = &mut start[a.min(b) + 1];
        entries[*next] = (k as u32, a.max(b) as u32);
        *next += 1;
    }
    start.pop();
    (start, entries)
}

#[cfg(test)]
mod tests {
    use super::Fronts;
    use crate::linalg::faer_analysis::analyse;
    use crate::linalg::residual::trial_numbers;
    use crate::linalg::{Buffer, Csr, Triplets, Upper};
    use faer::sparse::linalg::cholesky::SymbolicCholeskyRaw;

    /// A box of nodes tied to all 26 around them; every node `odd` counts to has a negative diagonal.
    fn tied(n: [usize; 3], odd: usize) -> Csr {
        let at = |x: [usize; 3]| x[0] + n[0] * (x[1] + n[1] * x[2]);
        let count = n.iter().product::<usize>();
        let (mut all, mut places, mut numbers) = (Triplets::new(count, count), Vec::new(), trial_numbers(14 * count).into_iter());
        for i in 0..count {
            let x = [i % n[0], i / n[0] % n[1], i / (n[0] * n[1])];
            places.push(x.map(|x| x as f64));
            for k in 13..27 {
                let step = [k % 3, k / 3 % 3, k / 9];
                let y: [usize; 3] = std::array::from_fn(|d| (x[d] + step[d]).wrapping_sub(1));
                if (0..3).any(|d| y[d] >= n[d]) {
                    continue;
                }
                let v = numbers.next().unwrap();
                if k == 13 {
                    all.push(i, i, if i % odd == 0 { -30.0 - v } else { 30.0 + v });
                } else {
                    all.push(i, at(y), v);
                    all.push(at(y), i, v);
                }
            }
        }
        all.to_csr().with_dof_coordinates(places)
    }

    /// The factor of `a` by fronts and by columns.
    fn fronts_and_columns(a: &Csr) -> [Option<Vec<f64>>; 2] {
        let upper = Upper::of(a);
        let analysis = analyse(&upper.pattern, crate::linalg::Operator::dof_coordinates(a)).unwrap();
        let SymbolicCholeskyRaw::Supernodal(nodes) = analysis.symbolic.raw() else { panic!("no supernodes") };
        let (ptr, cols) = &*upper.pattern;
        let fronts = Fronts::of(nodes, ptr, cols, analysis.symbolic.perm().unwrap().arrays().1).unwrap();
        let (mut one, mut other) = (vec![f64::NAN; nodes.len_val()], vec![0.0; nodes.len_val()]);
        // what earlier numbers left does not matter; what lies beyond the predicted memory is not touched
        let sizes = fronts.work().unwrap().each_ref().map(|w| w.len());
        let mut work = sizes.map(|n| Buffer::from(vec![f64::NAN; n + 16]));
        let done = fronts.factorise(nodes, &upper.vals, &mut one, &mut work).map(|()| one);
        assert!(work.iter().zip(sizes).all(|(w, n)| w[n..].iter().all(|v| v.is_nan())));
        assert!(done.is_none() || !work[0][sizes[0] - 1].is_nan(), "all of it is needed");
        let known = analysis.by_columns(&upper, &mut other).ok().map(|()| other);
        [done, known]
    }

    #[test]
    fn fronts_give_the_factor_that_columns_give() {
        for (n, odd) in [([13, 12, 11], usize::MAX), ([40, 30, 4], usize::MAX), ([13, 12, 11], 7), ([60, 20, 5], 5)] {
            let [fronts, columns] = fronts_and_columns(&tied(n, odd));
            let (fronts, columns) = (fronts.unwrap(), columns.unwrap());
            let top = columns.iter().fold(0.0f64, |m, v| m.max(v.abs()));
            let apart = fronts.iter().zip(&columns).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
            println!("{n:?}: {apart:e} of {top:e}");
            assert!(fronts.iter().all(|v| v.is_finite()) && apart < 1e-13 * top, "{n:?}: {apart:e} of {top:e}");
        }
    }

    #[test]
    fn a_pivot_of_zero_is_refused() {
        let mut a = tied([13, 12, 11], usize::MAX);
        for i in 0..a.num_rows() {
            let (cols, vals) = a.row_mut(i);
            cols.zip(vals).filter(|(j, _)| i == 100 || *j == 100).for_each(|(_, v)| *v = 0.0);
        }
        let [fronts, columns] = fronts_and_columns(&a);
        assert!(fronts.is_none() && columns.is_none());
    }

    #[test]
    fn fronts_pay_in_the_plane_and_not_in_space() {
        let pays = |n| {
            let a = tied(n, usize::MAX);
            let upper = Upper::of(&a);
            analyse(&upper.pattern, crate::linalg::Operator::dof_coordinates(&a)).unwrap().fronts.is_some()
        };
        assert!(pays([120, 100, 3]), "a plate");
        assert!(!pays([13, 12, 11]), "a block");
    }
}
