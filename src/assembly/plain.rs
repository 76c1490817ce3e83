//! The bulk loop: element matrices in parallel, added in place into a known pattern.
//!
//!   K_(a,c)(b,e) = ∫ sum_lj d_l N_a  tangent[e][j][(c,l)]  d_j N_b dx
//!
//! Blocks of elements: kernels fill buffers, then owners of rows add them up in the order of the elements. Every entry
//! is summed in that order, so the result has the same bits for any number of threads and any block
//! size. It needs no structure of the space and is the reference of every faster path.

use super::fields::tangent_at;
use super::pattern::Pattern;
use super::scratch::Scratch;
use super::{Coefficient, Form};
use crate::linalg::{Csr, Real};
use crate::parallel;
use crate::quadrature::Quadrature;
use crate::space::Space;

/// Adds the matrix of `form` to `matrix`, which has the pattern `pattern.csr(C)`.
///
/// # Panics
/// If the shapes do not fit.
pub(super) fn add_stiffness<const C: usize, const N: usize, T, S, Q>(
    pattern: &Pattern,
    space: &S,
    quadrature: &Q,
    form: &Form<'_, C, N, T>,
    matrix: &mut Csr<T>,
) where
    T: Real,
    S: Space<N, N, T> + ?Sized,
    Q: Quadrature<N, T> + ?Sized,
{
    add_elements(pattern, C, matrix, |scratch: &mut Scratch<N, N, T>, element, out| {
        scratch.gradients(space, element, quadrature.rule(element));
        element_stiffness(scratch, form, out);
    });
}

/// Adds the matrix ∫ N_a N_b dx to `matrix`, which has the pattern `pattern.csr(1)`.
pub(super) fn add_mass<const D: usize, const N: usize, T, S, Q>(pattern: &Pattern, space: &S, quadrature: &Q, matrix: &mut Csr<T>)
where
    T: Real,
    S: Space<D, N, T> + ?Sized,
    Q: Quadrature<D, T> + ?Sized,
{
    add_elements(pattern, 1, matrix, |scratch: &mut Scratch<D, N, T>, element, out| {
        scratch.values(space, element, quadrature.rule(element));
        element_mass(scratch, out);
    });
}

/// The matrix of one element, `out[((a * C + c) * n + b) * C + e]`.
pub(super) fn element_stiffness<const C: usize, const N: usize, T: Real>(
    scratch: &mut Scratch<N, N, T>,
    form: &Form<'_, C, N, T>,
    out: &mut [T],
) {
    let (points, n) = (scratch.dx.len(), scratch.ids.len());
    match &form.coefficient {
        // sums of products of gradients first, the tangent once per pair: N^2 instead of C^2 N products per point
        Coefficient::Constant(tangent) if C > 1 => {
            scratch.planes.clear();
            scratch.planes.resize(N * N * n * n, T::zero());
            scratch.factors.clear();
            scratch.factors.resize(points, T::zero());
            for l in 0..N {
                for a in 0..n {
                    for q in 0..points {
                        scratch.factors[q] = scratch.dx[q] * scratch.grads[(l * points + q) * n + a];
                    }
                    let from = if form.symmetric { a } else { 0 };
                    for j in 0..N {
                        let row = &mut scratch.planes[((l * N + j) * n + a) * n..][from..n];
                        add_products(row, &scratch.factors, &scratch.grads[j * points * n..(j + 1) * points * n], n, from);
                    }
                }
            }
            fill(n, C, form.symmetric, out, |a, c, b, e| {
                let mut sum = T::zero();
                for l in 0..N {
                    for j in 0..N {
                        sum += tangent[e][j][(c, l)] * scratch.planes[((l * N + j) * n + a) * n + b];
                    }
                }
                sum
            });
        }
        coefficient => {
            let terms = N * points;
            scratch.planes.clear();
            scratch.planes.resize(C * C * n * n, T::zero());
            scratch.factors.clear();
            scratch.factors.resize(n * C * C * terms, T::zero());
            for q in 0..points {
                let varying;
                let tangent = match coefficient {
                    Coefficient::Constant(tangent) => tangent,
                    _ => {
                        varying = tangent_at(scratch, form, q);
                        &varying
                    }
                };
                let dx = scratch.dx[q];
                for a in 0..n {
                    for c in 0..C {
                        for e in 0..C {
                            for j in 0..N {
                                let dotted =
                                    (0..N).fold(T::zero(), |s, l| s + scratch.grads[(l * points + q) * n + a] * tangent[e][j][(c, l)]);
                                scratch.factors[((a * C + c) * C + e) * terms + j * points + q] = dx * dotted;
                            }
                        }
                    }
                }
            }
            for a in 0..n {
                let from = if form.symmetric { a } else { 0 };
                for ce in 0..C * C {
                    let row = &mut scratch.planes[(ce * n + a) * n..][from..n];
                    add_products(row, &scratch.factors[(a * C * C + ce) * terms..][..terms], &scratch.grads, n, from);
                }
            }
            fill(n, C, form.symmetric, out, |a, c, b, e| scratch.planes[((c * C + e) * n + a) * n + b]);
        }
    }
}

/// The mass matrix of one element, `out[a * n + b]`.
fn element_mass<const D: usize, const N: usize, T: Real>(scratch: &mut Scratch<D, N, T>, out: &mut [T]) {
    let n = scratch.ids.len();
    for a in 0..n {
        for b in a..n {
            let mut sum = T::zero();
            for (q, &dx) in scratch.dx.iter().enumerate() {
                let values = scratch.shapes.values(q);
                sum += dx * values[a] * values[b];
            }
            out[a * n + b] = sum;
            out[b * n + a] = sum;
        }
    }
}

/// row[b] += sum_k factors[k] table[k][from + b], four terms at a time.
#[inline]
pub(super) fn add_products<T: Real>(row: &mut [T], factors: &[T], table: &[T], n: usize, from: usize) {
    let mut k = 0;
    while k + 4 <= factors.len() {
        let [w0, w1, w2, w3] = [factors[k], factors[k + 1], factors[k + 2], factors[k + 3]];
        let line = |i: usize| &table[(k + i) * n + from..(k + i + 1) * n];
        let (g0, g1, g2, g3) = (line(0), line(1), line(2), line(3));
        for ((((r, &x0), &x1), &x2), &x3) in row.iter_mut().zip(g0).zip(g1).zip(g2).zip(g3) {
            *r += (w0 * x0 + w1 * x1) + (w2 * x2 + w3 * x3);
        }
        k += 4;
    }
    for k in k..factors.len() {
        let w = factors[k];
        for (r, &x) in row.iter_mut().zip(&table[k * n + from..(k + 1) * n]) {
            *r += w * x;
        }
    }
}

/// Writes an element matrix from its entries, the lower half by mirroring where it is symmetric.
pub(super) fn fill<T: Real>(n: usize, components: usize, symmetric: bool, out: &mut [T], entry: impl Fn(usize, usize, usize, usize) -> T) {
    let size = n * components;
    for a in 0..n {
        for c in 0..components {
            let row = a * components + c;
            for b in if symmetric { a } else { 0 }..n {
                for e in 0..components {
                    let col = b * components + e;
                    if !symmetric {
                        out[row * size + col] = entry(a, c, b, e);
                    } else if col >= row {
                        let value = entry(a, c, b, e);
                        out[row * size + col] = value;
                        out[col * size + row] = value;
                    }
                }
            }
        }
    }
}

/// Bytes of element matrices that wait at a time: enough for all threads, little enough to stay in cache.
const BLOCK_BYTES: usize = 4 << 20;
/// Elements of a block at least, so that large elements still come in parallel.
const BLOCK_ELEMENTS: usize = 16;

/// Returns the end of the block of elements that begins with `first`, and fills `start` with the offsets of their matrices in a buffer.
fn block_end<T>(pattern: &Pattern, components: usize, first: usize, start: &mut Vec<usize>) -> usize {
    let mut last = first;
    start.clear();
    start.push(0);
    while last < pattern.num_elements() {
        let size = components * pattern.ids(last).len();
        let total = start[last - first] + size * size;
        if last - first >= BLOCK_ELEMENTS && total * size_of::<T>() > BLOCK_BYTES {
            break;
        }
        start.push(total);
        last += 1;
    }
    last
}

/// Adds a line of an element matrix to the row `own`, in which function j has the place `mark[j]`.
#[inline]
fn add_line<T: Real>(own: &mut [T], mark: &[u32], ids: &[u32], line: &[T], components: usize) {
    if components == 1 {
        for (&j, &value) in ids.iter().zip(line) {
            own[mark[j as usize] as usize] += value;
        }
    } else {
        for (&j, values) in ids.iter().zip(line.chunks_exact(components)) {
            let at = components * mark[j as usize] as usize;
            for (own, &value) in own[at..at + components].iter_mut().zip(values) {
                *own += value;
            }
        }
    }
}

/// Runs `kernel` on all elements and adds what it writes to `matrix`.
pub(super) fn add_elements<const D: usize, const N: usize, T: Real>(
    pattern: &Pattern,
    components: usize,
    matrix: &mut Csr<T>,
    kernel: impl Fn(&mut Scratch<D, N, T>, usize, &mut [T]) + Sync,
) {
    let (c, functions) = (components, pattern.num_functions());
    let vals = matrix.vals_mut();
    assert_eq!(vals.len(), c * c * pattern.ptr()[functions], "the matrix has the pattern of the basis");
    // one task per mark array; the number of tasks changes the task that adds, never the order
    let tasks = 2 * rayon::current_num_threads();
    let mut marks = vec![Vec::<u32>::new(); tasks];
    let mut buffer: Vec<T> = Vec::new();
    let (mut seen, mut touched): (Vec<u32>, Vec<u32>) = (vec![u32::MAX; functions], Vec::new());
    let mut start: Vec<usize> = Vec::new();
    let (mut first, mut block) = (0, 0u32);
    while first < pattern.num_elements() {
        let last = block_end::<T>(pattern, c, first, &mut start);
        let needed = start[last - first];
        if buffer.len() < needed {
            buffer.resize(needed, T::zero());
        }
        let mut pieces = Vec::with_capacity(last - first);
        let mut rest = &mut buffer[..needed];
        for k in 0..last - first {
            let (mine, others) = rest.split_at_mut(start[k + 1] - start[k]);
            pieces.push(mine);
            rest = others;
        }
        let size = parallel::piece_size(pieces.len());
        parallel::for_each(pieces.chunks_mut(size).enumerate(), |(piece, own)| {
            let mut scratch = Scratch::default();
            own.iter_mut().zip(first + piece * size..).for_each(|(out, e)| kernel(&mut scratch, e, out));
        });

        touched.clear();
        for e in first..last {
            for &i in pattern.ids(e) {
                if seen[i as usize] != block {
                    seen[i as usize] = block;
                    touched.push(i);
                }
            }
        }
        touched.sort_unstable();
        let share = touched.len().div_ceil(tasks).max(1);
        let mut owners = Vec::with_capacity(tasks);
        let (mut rest, mut cut) = (&mut *vals, 0);
        for (rows, mark) in touched.chunks(share).zip(&mut marks) {
            let (lo, hi) = (rows[0] as usize, rows[rows.len() - 1] as usize + 1);
            let begin = c * c * pattern.ptr()[lo];
            let end = c * c * pattern.ptr()[hi];
            let (mine, others) = std::mem::take(&mut rest)[begin - cut..].split_at_mut(end - begin);
            (rest, cut) = (others, end);
            owners.push((rows, begin, mine, mark));
        }
        parallel::for_each(owners.into_iter(), |(rows, begin, mine, mark)| {
            mark.resize(functions, 0);
            for &i in rows {
                let row = pattern.row(i as usize);
                for (k, &j) in row.iter().enumerate() {
                    mark[j as usize] = k as u32;
                }
                let own = &mut mine[c * c * pattern.ptr()[i as usize] - begin..][..c * c * row.len()];
                let cells = pattern.cells(i as usize);
                let from = cells.partition_point(|&(e, _)| (e as usize) < first);
                for &(e, a) in cells[from..].iter().take_while(|&&(e, _)| (e as usize) < last) {
                    let ids = pattern.ids(e as usize);
                    let width = c * ids.len();
                    let element = &buffer[start[e as usize - first] + a as usize * c * width..][..c * width];
                    for (k, line) in element.chunks_exact(width).enumerate() {
                        add_line(&mut own[k * c * row.len()..][..c * row.len()], mark, ids, line, c);
                    }
                }
            }
        });
        first = last;
        block += 1;
    }
}
