//! Solutions with a supernodal L D Lᵀ: a column of supernodes after the other, four columns at a time.

use super::faer_panel::subtract;
use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;
use pulp::{Arch, Simd, WithSimd};

/// Columns that are taken together.
const FEW: usize = 4;
/// Partial sums of a dot product: as many whatever the lanes, so that all instruction sets give the same bits from one factor.
const SUMS: usize = 8;

/// x = (L D Lᵀ)⁻¹ x in the order of the factor.
pub(super) fn solve(nodes: &SymbolicSupernodalCholesky<usize>, factor: &[f64], x: &mut [f64]) {
    let count = nodes.n_supernodes();
    let height = |k: usize| nodes.supernode_end()[k] - nodes.supernode_begin()[k] + nodes.supernode(k).pattern().len();
    let work = vec![0.0; (0..count).map(height).max().unwrap_or(0)];
    Arch::new().dispatch(Solve { nodes, factor, x, work });
}

struct Solve<'a> {
    nodes: &'a SymbolicSupernodalCholesky<usize>,
    factor: &'a [f64],
    x: &'a mut [f64],
    /// The part of x that a supernode acts on.
    work: Vec<f64>,
}

impl WithSimd for Solve<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { nodes, factor, x, mut work } = self;
        for k in 0..nodes.n_supernodes() {
            let (begin, end, below) = (nodes.supernode_begin()[k], nodes.supernode_end()[k], nodes.supernode(k).pattern());
            let panel = &factor[nodes.col_ptr_for_val()[k]..nodes.col_ptr_for_val()[k + 1]];
            let width = end - begin;
            let part = &mut work[..width + below.len()];
            part[..width].copy_from_slice(&x[begin..end]);
            part[width..].fill(0.0);
            forward(simd, panel, width, part);
            x[begin..end].copy_from_slice(&part[..width]);
            for (&row, v) in below.iter().zip(&part[width..]) {
                x[row] += v;
            }
        }
        for k in (0..nodes.n_supernodes()).rev() {
            let (begin, end, below) = (nodes.supernode_begin()[k], nodes.supernode_end()[k], nodes.supernode(k).pattern());
            let panel = &factor[nodes.col_ptr_for_val()[k]..nodes.col_ptr_for_val()[k + 1]];
            let width = end - begin;
            let part = &mut work[..width + below.len()];
            for (j, v) in x[begin..end].iter().enumerate() {
                part[j] = v / panel[j * (width + below.len()) + j];
            }
            for (v, &row) in part[width..].iter_mut().zip(below) {
                *v = x[row];
            }
            backward(panel, width, part);
            x[begin..end].copy_from_slice(&part[..width]);
        }
    }
}

/// The first `width` of t by the unit triangle, the others less their products with the rows below.
#[inline(always)]
fn forward<S: Simd>(simd: S, panel: &[f64], width: usize, t: &mut [f64]) {
    let height = t.len();
    let mut j = 0;
    while j < width {
        let end = if width - j < FEW { j + 1 } else { j + FEW };
        for a in j..end {
            for b in a + 1..end {
                t[b] -= panel[a * height + b] * t[a];
            }
        }
        let (done, rest) = t.split_at_mut(end);
        let line = |a: usize| &panel[a * height + end..(a + 1) * height];
        if end - j == FEW {
            let lines = [line(j), line(j + 1), line(j + 2), line(j + 3)];
            subtract(simd, rest, lines, [-done[j], -done[j + 1], -done[j + 2], -done[j + 3]]);
        } else {
            subtract(simd, rest, [line(j)], [-done[j]]);
        }
        j = end;
    }
}

/// The first `width` of t by the transposed unit triangle, less the products of the others with their columns.
#[inline(always)]
fn backward(panel: &[f64], width: usize, t: &mut [f64]) {
    let height = t.len();
    let mut end = width;
    while end > 0 {
        let j = if end.is_multiple_of(FEW) { end - FEW } else { end - 1 };
        let line = |a: usize| &panel[a * height + end..(a + 1) * height];
        let mut sums = [0.0; FEW];
        if end - j == FEW {
            sums = dots([line(j), line(j + 1), line(j + 2), line(j + 3)], &t[end..]);
        } else {
            [sums[0]] = dots([line(j)], &t[end..]);
        }
        for a in (j..end).rev() {
            let mut v = t[a] - sums[a - j];
            for b in a + 1..end {
                v -= panel[a * height + b] * t[b];
            }
            t[a] = v;
        }
        end = j;
    }
}

/// Dot products of some columns with t.
#[inline(always)]
fn dots<const K: usize>(columns: [&[f64]; K], t: &[f64]) -> [f64; K] {
    let mut sums = [[0.0; SUMS]; K];
    let mut parts: [&[[f64; SUMS]]; K] = [&[]; K];
    let mut rests: [&[f64]; K] = [&[]; K];
    for k in 0..K {
        (parts[k], rests[k]) = columns[k][..t.len()].as_chunks::<SUMS>();
    }
    let (whole, rest) = t.as_chunks::<SUMS>();
    for (i, t) in whole.iter().enumerate() {
        for k in 0..K {
            let c = &parts[k][i];
            for l in 0..SUMS {
                sums[k][l] += c[l] * t[l];
            }
        }
    }
    let mut total = [0.0; K];
    for k in 0..K {
        for (c, t) in rests[k].iter().zip(rest) {
            total[k] += c * t;
        }
        for s in sums[k] {
            total[k] += s;
        }
    }
    total
}

#[cfg(test)]
mod tests {
    use crate::linalg::faer_analysis::analyse;
    use crate::linalg::residual::trial_numbers;
    use crate::linalg::{Triplets, Upper};
    use faer::sparse::linalg::cholesky::SymbolicCholeskyRaw;

    // rows tied to their neighbours in a box, every `odd`-th diagonal entry negative
    #[test]
    fn solutions_are_those_of_faer_on_definite_and_indefinite_matrices() {
        for (n, odd) in [([30, 25, 5], usize::MAX), ([13, 12, 11], usize::MAX), ([31, 23, 6], 5), ([12, 13, 11], 2)] {
            let count = n.iter().product::<usize>();
            let (mut all, mut numbers) = (Triplets::new(count, count), trial_numbers(4 * count).into_iter());
            for i in 0..count {
                let v = numbers.next().unwrap();
                all.push(i, i, if i % odd == odd - 1 { -8.0 - v } else { 8.0 + v });
                for (step, rest) in [(1, i % n[0]), (n[0], i / n[0] % n[1]), (n[0] * n[1], i / (n[0] * n[1]))].into_iter().zip(n) {
                    if step.1 + 1 < rest {
                        let v = numbers.next().unwrap();
                        all.push(i, i + step.0, v);
                        all.push(i + step.0, i, v);
                    }
                }
            }
            let a = all.to_csr();
            let places: Vec<[f64; 3]> = (0..count).map(|i| [i % n[0], i / n[0] % n[1], i / (n[0] * n[1])].map(|x| x as f64)).collect();
            let upper = Upper::of(&a);
            let analysis = analyse(&upper.pattern, &places).unwrap();
            assert!(matches!(analysis.symbolic.raw(), SymbolicCholeskyRaw::Supernodal(_)), "{n:?}");
            let mut factor = vec![0.0; analysis.symbolic.len_val()];
            analysis.by_columns(&upper, &mut factor).unwrap();
            let x = trial_numbers(count);
            let (mut b, mut c) = (vec![0.0; count], vec![0.0; count]);
            a.mul(&x, &mut b);
            c.copy_from_slice(&b);
            analysis.solve(&factor, &mut b).unwrap();
            analysis.solve_by_faer(&factor, &mut c).unwrap();
            let apart = |y: &[f64], z: &[f64]| y.iter().zip(z).fold(0.0f64, |m, (y, z)| m.max((y - z).abs()));
            assert!(apart(&b, &c) < 1e-13 && apart(&b, &x) < 1e-13, "{n:?}: {:e} {:e}", apart(&b, &c), apart(&b, &x));
        }
    }
}
