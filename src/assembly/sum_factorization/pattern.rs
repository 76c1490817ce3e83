//! Row pointers and columns of a patch in closed form.

use super::write::Directions;
use crate::assembly::pattern::each_row;
use crate::linalg::Buffer;

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
