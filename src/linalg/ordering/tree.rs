//! Elimination trees: postorder and number of entries of a factor.

use super::parts::index;

/// Renumbers `order` by a postorder of its elimination tree: the same fill, larger supernodes.
///
/// `ptr`, `cols`: one triangle of the pattern or both; `order[new] = old` before and after.
pub fn postordered(ptr: &[usize], cols: &[usize], order: &[usize]) -> Vec<usize> {
    let n = order.len();
    let parent = elimination_tree(ptr, cols, order);
    // children as linked lists, filled from the back so that they ascend
    let (mut first, mut next) = (vec![NONE; n], vec![NONE; n]);
    for k in (0..n).rev() {
        let p = parent[k];
        if p != NONE {
            next[k] = first[p];
            first[p] = k;
        }
    }
    let (mut result, mut stack) = (Vec::with_capacity(n), Vec::new());
    for root in (0..n).filter(|&k| parent[k] == NONE) {
        stack.push(root);
        while let Some(&k) = stack.last() {
            let child = first[k];
            if child == NONE {
                result.push(order[k]);
                stack.pop();
            } else {
                first[k] = next[child];
                stack.push(child);
            }
        }
    }
    result
}

/// Number of entries of the Cholesky factor (diagonal included) under `order`: what orders are compared by.
pub fn factor_entries(ptr: &[usize], cols: &[usize], order: &[usize]) -> usize {
    let n = order.len();
    let (below_ptr, below) = permuted(ptr, cols, order);
    let parent = elimination_tree(ptr, cols, order);
    let mut mark = vec![NONE; n];
    let mut count = n;
    for k in 0..n {
        // row k of the factor: the paths of the tree from the entries of row k up to k
        mark[k] = k;
        for &i in &below[below_ptr[k]..below_ptr[k + 1]] {
            let mut i = i as usize;
            while mark[i] != k {
                mark[i] = k;
                count += 1;
                i = parent[i];
            }
        }
    }
    count
}

const NONE: usize = usize::MAX;

/// Parent of every column in the elimination tree, numbered by `order`; [`NONE`] for roots.
fn elimination_tree(ptr: &[usize], cols: &[usize], order: &[usize]) -> Vec<usize> {
    let n = order.len();
    let (below_ptr, below) = permuted(ptr, cols, order);
    let (mut parent, mut ancestor) = (vec![NONE; n], vec![NONE; n]);
    for k in 0..n {
        for &i in &below[below_ptr[k]..below_ptr[k + 1]] {
            let mut i = i as usize;
            while i != NONE && i < k {
                let up = ancestor[i];
                ancestor[i] = k; // path compression
                if up == NONE {
                    parent[i] = k;
                }
                i = up;
            }
        }
    }
    parent
}

/// For every new index k the new indices i < k it is tied to.
fn permuted(ptr: &[usize], cols: &[usize], order: &[usize]) -> (Vec<usize>, Vec<u32>) {
    let n = order.len();
    let mut new = vec![0usize; n];
    for (k, &i) in order.iter().enumerate() {
        new[i] = k;
    }
    let mut below_ptr = vec![0usize; n + 1];
    for i in 0..n {
        for &j in &cols[ptr[i]..ptr[i + 1]] {
            if i != j {
                below_ptr[new[i].max(new[j]) + 1] += 1;
            }
        }
    }
    for k in 0..n {
        below_ptr[k + 1] += below_ptr[k];
    }
    let (mut place, mut below) = (below_ptr.clone(), vec![0u32; below_ptr[n]]);
    for i in 0..n {
        for &j in &cols[ptr[i]..ptr[i + 1]] {
            if i != j {
                let (a, b) = (new[i].min(new[j]), new[i].max(new[j]));
                below[place[b]] = index(a);
                place[b] += 1;
            }
        }
    }
    (below_ptr, below)
}
