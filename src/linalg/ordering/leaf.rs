//! Minimum degree orders of small sets.

use super::graph::Subgraph;
use super::parts::index;
use pulp::{Arch, Simd, WithSimd};

/// Minimum degree order of a small part of `whole`; its neighbours outside, all of them ordered later, count in the degrees.
///
/// Adjacency as bits: first the vertices of the set, then the neighbours.
pub(super) fn minimum_degree(piece: &Subgraph, whole: &Subgraph) -> Vec<u32> {
    let (n, ids) = (piece.ids.len(), &piece.ids);
    let mut others: Vec<u32> = Vec::new();
    // ids ascend in the piece and in both graphs: what is not met in the piece lies outside
    let mut first = vec![0];
    for v in 0..n {
        let mut inner = piece.neighbours(v).iter().map(|&u| ids[u as usize]).peekable();
        others.extend(whole.neighbours(ids[v] as usize).iter().filter(|&u| inner.next_if_eq(u).is_none()));
        first.push(others.len());
    }
    let mut names = others.clone();
    names.sort_unstable();
    names.dedup();
    let words = (n + names.len()).div_ceil(64);
    let mut tied = vec![0u64; words * n];
    for v in 0..n {
        let row = &mut tied[v * words..(v + 1) * words];
        let inner = piece.neighbours(v).iter().map(|&u| u as usize);
        let mut from = 0;
        let outer = others[first[v]..first[v + 1]].iter().map(|&u| {
            // both lists ascend
            from += names[from..].partition_point(|&o| o < u);
            n + from
        });
        for k in inner.chain(outer) {
            row[k / 64] |= 1 << (k % 64);
        }
    }
    let order = Arch::new().dispatch(Eliminate { tied, words, n });
    order.into_iter().map(|v| ids[v as usize]).collect()
}

/// Eliminates n vertices with rows of bits, always one of least degree.
struct Eliminate {
    tied: Vec<u64>,
    words: usize,
    n: usize,
}

impl WithSimd for Eliminate {
    type Output = Vec<u32>;

    // counts of bits and unions of rows take the instructions that are there
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Vec<u32> {
        let Self { mut tied, words, n } = self;
        let mut degree: Vec<u32> = Vec::with_capacity(n);
        for row in tied.chunks_exact(words) {
            degree.push(count(row));
        }
        let mut alive: Vec<u32> = (0..index(n)).collect();
        let (mut order, mut clique) = (Vec::with_capacity(n), vec![0u64; words]);
        while !alive.is_empty() {
            let (mut k, mut least) = (0, u32::MAX);
            for (i, &v) in alive.iter().enumerate() {
                if degree[v as usize] < least {
                    (k, least) = (i, degree[v as usize]);
                }
            }
            let v = alive.remove(k);
            order.push(v);
            let v = v as usize;
            clique.copy_from_slice(&tied[v * words..(v + 1) * words]);
            for &u in &alive {
                let u = u as usize;
                if clique[u / 64] >> (u % 64) & 1 == 1 {
                    let row = &mut tied[u * words..(u + 1) * words];
                    for (w, c) in row.iter_mut().zip(&clique) {
                        *w |= c;
                    }
                    row[u / 64] &= !(1 << (u % 64));
                    row[v / 64] &= !(1 << (v % 64));
                    degree[u] = count(row);
                }
            }
        }
        order
    }
}

#[inline(always)]
fn count(row: &[u64]) -> u32 {
    let mut sum = 0;
    for w in row {
        sum += w.count_ones();
    }
    sum
}
