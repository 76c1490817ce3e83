//! Solves with an L D Lᵀ factor, node by node and four columns at a time.

use super::dense_panel::subtract_each;
use super::faer_border::{Border, Nodes, Supernode};
use super::{Buffer, Csr};
use pulp::{Arch, Simd, WithSimd};

/// Columns processed together.
const FEW: usize = 4;
/// Partial sums of a dot product, the same number for all SIMD widths, so that all instruction sets give the same bits from one factor.
const SUMS: usize = 8;

/// x = (L D Lᵀ)⁻¹ x for each of R vectors, unknown `order[i]` of the vector being unknown i of the factor. The factor is read once, and
/// each solution is bitwise that of a solve for it alone. `None` if out of memory.
pub(super) fn solve<const R: usize>(
    arch: Arch,
    nodes: Nodes<'_>,
    factor: &[f64],
    order: &[usize],
    x: [&mut [f64]; R],
    memory: &mut Buffer<f64>,
) -> Option<()> {
    let highest = nodes.highest();
    let mut rest = reserved(memory, R * (order.len() + highest))?;
    let mut vectors = x.each_ref().map(|x| {
        let vector = Vector::taken(&mut rest, order.len(), highest);
        vector.own.iter_mut().zip(order).for_each(|(v, &old)| *v = x[old]);
        vector
    });
    half(arch, Half::Forward, nodes, None, factor, &mut vectors);
    half(arch, Half::Backward, nodes, None, factor, &mut vectors);
    for (x, vector) in x.into_iter().zip(vectors) {
        vector.own.iter().zip(order).for_each(|(&v, &old)| x[old] = v);
    }
    Some(())
}

/// x = A⁻¹ (x - Cᵀ nu) for each of R vectors, where `inner`(r, h) replaces h = C A⁻¹ x, one number per row of the border, by nu.
///
/// The backward substitution for h and the forward one for Cᵀ nu visit the nodes of the border only.
pub(super) fn solve_bordered<const R: usize>(
    arch: Arch,
    nodes: Nodes<'_>,
    factor: &[f64],
    order: [&[usize]; 2],
    border: &Border,
    c: &Csr<f64>,
    x: [&mut [f64]; R],
    memory: &mut Buffer<f64>,
    mut inner: impl FnMut(usize, &mut [f64]),
) -> Option<()> {
    let ([order, new], highest, m) = (order, nodes.highest(), border.rows.len());
    let n = order.len();
    let (numbers, rest) = reserved(memory, R * (2 * n + 2 * highest) + m)?.split_at_mut(m);
    let mut rest = rest;
    let mut vectors = x.each_ref().map(|x| {
        let vector = Vector::taken(&mut rest, n, highest);
        vector.own.iter_mut().zip(order).for_each(|(v, &old)| *v = x[old]);
        vector
    });
    half(arch, Half::Forward, nodes, None, factor, &mut vectors);
    let mut reached: [Vector<'_>; R] = std::array::from_fn(|_| Vector::taken(&mut rest, n, highest));
    let columns = || border.nodes.iter().map(|&k| nodes.node(k)).flat_map(|node| node.begin..node.begin + node.width);
    for (z, x) in reached.iter_mut().zip(&vectors) {
        columns().for_each(|i| z.own[i] = x.own[i]);
    }
    half(arch, Half::Backward, nodes, Some(&border.nodes), factor, &mut reached);
    for (r, z) in reached.iter_mut().enumerate() {
        for (h, &a) in numbers.iter_mut().zip(&border.rows) {
            let (cols, vals) = c.row(a);
            *h = cols.zip(vals).map(|(j, v)| v * z.own[new[j]]).sum();
        }
        inner(r, numbers);
        columns().for_each(|i| z.own[i] = 0.0);
        for (nu, &a) in numbers.iter().zip(&border.rows) {
            let (cols, vals) = c.row(a);
            cols.zip(vals).for_each(|(j, v)| z.own[new[j]] += v * nu);
        }
    }
    half(arch, Half::Forward, nodes, Some(&border.nodes), factor, &mut reached);
    for (z, x) in reached.iter().zip(&mut vectors) {
        columns().for_each(|i| x.own[i] -= z.own[i]);
    }
    half(arch, Half::Backward, nodes, None, factor, &mut vectors);
    for (x, vector) in x.into_iter().zip(vectors) {
        vector.own.iter().zip(order).for_each(|(&v, &old)| x[old] = v);
    }
    Some(())
}

/// Returns at least `n` values of `memory`, enlarged if needed; `None` if out of memory.
fn reserved(memory: &mut Buffer<f64>, n: usize) -> Option<&mut [f64]> {
    if memory.len() < n {
        *memory = Buffer::default();
        *memory = Buffer::try_zeros(n)?;
    }
    Some(&mut **memory)
}

/// A right-hand side that becomes the solution.
struct Vector<'a> {
    /// In the order of the factor.
    own: &'a mut [f64],
    /// Entries of the current node: its columns and the rows below.
    part: &'a mut [f64],
}

impl<'a> Vector<'a> {
    /// Takes a vector from the front of `rest`.
    fn taken(rest: &mut &'a mut [f64], n: usize, highest: usize) -> Self {
        let (own, others) = std::mem::take(rest).split_at_mut(n);
        let (part, others) = others.split_at_mut(highest);
        *rest = others;
        Self { own, part }
    }
}

/// Half of a solve: L⁻¹ (forward) or L⁻ᵀ D⁻¹ (backward).
#[derive(Clone, Copy)]
enum Half {
    Forward,
    Backward,
}

/// Runs half a solve on the nodes `chosen` (ascending, with all ancestors of each), or on all if `None`.
fn half<const R: usize>(arch: Arch, half: Half, nodes: Nodes<'_>, chosen: Option<&[usize]>, factor: &[f64], vectors: &mut [Vector<'_>; R]) {
    arch.dispatch(Sweep { half, nodes, chosen, factor, vectors });
}

struct Sweep<'a, 'b, const R: usize> {
    half: Half,
    nodes: Nodes<'a>,
    chosen: Option<&'a [usize]>,
    factor: &'a [f64],
    vectors: &'a mut [Vector<'b>; R],
}

impl<const R: usize> WithSimd for Sweep<'_, '_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { half, nodes, chosen, factor, vectors } = self;
        let count = chosen.map_or(nodes.len(), <[usize]>::len);
        for at in 0..count {
            let at = if matches!(half, Half::Forward) { at } else { count - 1 - at };
            let Supernode { begin, width, below, values } = nodes.node(chosen.map_or(at, |chosen| chosen[at]));
            let (panel, end) = (&factor[values], begin + width);
            match half {
                Half::Forward => {
                    forward(
                        simd,
                        panel,
                        width,
                        vectors.each_mut().map(|v| {
                            let part = &mut v.part[..width + below.len()];
                            part[..width].copy_from_slice(&v.own[begin..end]);
                            part[width..].fill(0.0);
                            part
                        }),
                    );
                    for Vector { own, part } in vectors.iter_mut() {
                        own[begin..end].copy_from_slice(&part[..width]);
                        for (&row, v) in below.iter().zip(&part[width..]) {
                            own[row] += v;
                        }
                    }
                }
                Half::Backward => {
                    backward(
                        panel,
                        width,
                        vectors.each_mut().map(|v| {
                            let part = &mut v.part[..width + below.len()];
                            for (j, x) in v.own[begin..end].iter().enumerate() {
                                part[j] = x / panel[j * (width + below.len()) + j];
                            }
                            for (x, &row) in part[width..].iter_mut().zip(below) {
                                *x = v.own[row];
                            }
                            part
                        }),
                    );
                    for Vector { own, part } in vectors.iter_mut() {
                        own[begin..end].copy_from_slice(&part[..width]);
                    }
                }
            }
        }
    }
}

/// Solves for the first `width` entries of each t with the unit triangle and subtracts their products with the rows below from the others.
#[inline(always)]
fn forward<S: Simd, const R: usize>(simd: S, panel: &[f64], width: usize, mut t: [&mut [f64]; R]) {
    let height = t[0].len();
    let mut j = 0;
    while j < width {
        let end = if width - j < FEW { j + 1 } else { j + FEW };
        for t in &mut t {
            for a in j..end {
                for b in a + 1..end {
                    t[b] -= panel[a * height + b] * t[a];
                }
            }
        }
        let factors = t.each_ref().map(|t| -> [f64; FEW] { std::array::from_fn(|k| if j + k < end { -t[j + k] } else { 0.0 }) });
        let rest = t.each_mut().map(|t| &mut t[end..]);
        let line = |a: usize| &panel[a * height + end..(a + 1) * height];
        if end - j == FEW {
            subtract_each(simd, rest, [line(j), line(j + 1), line(j + 2), line(j + 3)], factors);
        } else {
            subtract_each(simd, rest, [line(j)], factors.map(|f| [f[0]]));
        }
        j = end;
    }
}

/// Solves for the first `width` entries of each t with the transposed unit triangle, less the products of the others with their columns.
#[inline(always)]
fn backward<const R: usize>(panel: &[f64], width: usize, mut t: [&mut [f64]; R]) {
    let height = t[0].len();
    let mut end = width;
    while end > 0 {
        let j = if end.is_multiple_of(FEW) { end - FEW } else { end - 1 };
        let line = |a: usize| &panel[a * height + end..(a + 1) * height];
        let mut sums = [[0.0; FEW]; R];
        let rest = t.each_ref().map(|t| &t[end..]);
        if end - j < FEW {
            let products = dots([line(j)], rest);
            (0..R).for_each(|r| sums[r][0] = products[r][0]);
        } else if R == 1 {
            sums = dots([line(j), line(j + 1), line(j + 2), line(j + 3)], rest);
        } else {
            // more sums do not fit the registers
            for (k, products) in [(0, dots([line(j), line(j + 1)], rest)), (2, dots([line(j + 2), line(j + 3)], rest))] {
                (0..R).for_each(|r| sums[r][k..k + 2].copy_from_slice(&products[r]));
            }
        }
        for (t, sums) in t.iter_mut().zip(sums) {
            for a in (j..end).rev() {
                let mut v = t[a] - sums[a - j];
                for b in a + 1..end {
                    v -= panel[a * height + b] * t[b];
                }
                t[a] = v;
            }
        }
        end = j;
    }
}

/// Dot products of some columns with each t.
#[inline(always)]
fn dots<const K: usize, const R: usize>(columns: [&[f64]; K], t: [&[f64]; R]) -> [[f64; K]; R] {
    let n = t[0].len();
    let mut sums = [[[0.0; SUMS]; K]; R];
    let columns = columns.map(|c| c[..n].as_chunks::<SUMS>());
    let t = t.map(|t| t[..n].as_chunks::<SUMS>());
    for i in 0..n / SUMS {
        for k in 0..K {
            let c = &columns[k].0[i];
            for r in 0..R {
                let t = &t[r].0[i];
                for l in 0..SUMS {
                    sums[r][k][l] += c[l] * t[l];
                }
            }
        }
    }
    let mut total = [[0.0; K]; R];
    for r in 0..R {
        for k in 0..K {
            for (c, t) in columns[k].1.iter().zip(t[r].1) {
                total[r][k] += c * t;
            }
            for s in sums[r][k] {
                total[r][k] += s;
            }
        }
    }
    total
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::faer_analysis::{Analysis, analyse};
    use crate::linalg::residual::trial_numbers;
    use crate::linalg::{Csr, Ldlt, LinearSolver, Triplets, Upper};
    use faer::sparse::linalg::cholesky::SymbolicCholeskyRaw;

    const CASES: [([usize; 3], usize); 4] = [([30, 25, 5], usize::MAX), ([13, 12, 11], usize::MAX), ([31, 23, 6], 5), ([12, 13, 11], 2)];

    /// Rows tied to their neighbours in a box, every `odd`-th diagonal entry negative.
    fn tied(n: [usize; 3], odd: usize) -> Csr {
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
        all.to_csr()
    }

    fn grid_coordinates(n: [usize; 3]) -> Vec<[f64; 3]> {
        (0..n.iter().product()).map(|i| [i % n[0], i / n[0] % n[1], i / (n[0] * n[1])].map(|x| x as f64)).collect()
    }

    fn factorised(a: &Csr, places: &[[f64; 3]]) -> (Analysis, Vec<f64>) {
        let upper = Upper::of(a);
        let analysis = analyse(&upper.pattern, places).unwrap();
        assert!(matches!(analysis.symbolic.raw(), SymbolicCholeskyRaw::Supernodal(_)));
        let mut factor = vec![0.0; analysis.symbolic.len_val()];
        analysis.by_columns(&upper, &mut factor).unwrap();
        (analysis, factor)
    }

    fn apart(y: &[f64], z: &[f64]) -> f64 {
        y.iter().zip(z).fold(0.0f64, |m, (y, z)| m.max((y - z).abs()))
    }

    #[test]
    fn solutions_are_those_of_faer_on_definite_and_indefinite_matrices() {
        for (n, odd) in CASES {
            // by dissection, and by minimum degree where no places are known
            for places in [grid_coordinates(n), Vec::new()] {
                let a = tied(n, odd);
                let (analysis, factor) = factorised(&a, &places);
                assert_eq!(analysis.dissected, !places.is_empty());
                let x = trial_numbers(a.num_rows());
                let (mut b, mut c) = (vec![0.0; x.len()], vec![0.0; x.len()]);
                a.mul(&x, &mut b);
                c.copy_from_slice(&b);
                analysis.solve(&factor, [&mut b], &mut Buffer::default()).unwrap();
                analysis.solve_by_faer(&factor, &mut c).unwrap();
                assert!(apart(&b, &c) < 1e-13 && apart(&b, &x) < 1e-13, "{n:?}: {:e} {:e}", apart(&b, &c), apart(&b, &x));
            }
        }
    }

    #[test]
    fn a_matrix_without_places_is_solved_in_the_order_of_minimum_degree() {
        for (n, odd) in CASES {
            let a = tied(n, odd);
            let (x, mut b, mut y) = (trial_numbers(a.num_rows()), vec![0.0; a.num_rows()], vec![0.0; a.num_rows()]);
            a.mul(&x, &mut b);
            let mut solver = Ldlt::new();
            solver.prepare(&a).unwrap();
            assert!(!solver.uses_nested_dissection());
            solver.solve(&a, &b, &mut y).unwrap();
            assert!(apart(&x, &y) < 1e-14 * 8.0, "{n:?}: {:e}", apart(&x, &y));
        }
    }

    /// Bits of the solutions of some loads, `R` at once.
    fn bits<const R: usize>(arch: Arch, a: &Csr, (analysis, factor): &(Analysis, Vec<f64>)) -> Vec<Vec<u64>> {
        let (nodes, perm) = (Nodes(analysis.symbolic.raw()), analysis.symbolic.perm().unwrap());
        let mut loads: [Vec<f64>; 2] =
            std::array::from_fn(|k| trial_numbers(2 * a.num_rows())[k * a.num_rows()..][..a.num_rows()].to_vec());
        // memory that earlier solutions left
        let mut memory = Buffer::from(vec![f64::NAN; 5 * a.num_rows()]);
        for loads in loads.chunks_exact_mut(R) {
            let mut loads = loads.iter_mut();
            let x: [&mut [f64]; R] = std::array::from_fn(|_| loads.next().unwrap().as_mut_slice());
            solve(arch, nodes, factor, perm.arrays().0, x, &mut memory).unwrap();
        }
        loads.iter().map(|x| x.iter().map(|v| v.to_bits()).collect()).collect()
    }

    #[test]
    fn two_loads_at_once_have_the_bits_of_each_alone() {
        for (n, odd) in CASES {
            let a = tied(n, odd);
            let known = factorised(&a, &grid_coordinates(n));
            let alone = bits::<1>(Arch::new(), &a, &known);
            assert!(alone[0] != alone[1]);
            assert!(bits::<2>(Arch::new(), &a, &known) == alone, "{n:?}");
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[test]
    fn all_instruction_sets_give_the_same_bits() {
        use pulp::x86::{V3, V4};
        let wide = [V3::try_new().map(Arch::V3), V4::try_new().map(Arch::V4)];
        for (n, odd) in CASES {
            let a = tied(n, odd);
            let known = factorised(&a, &grid_coordinates(n));
            let expected = bits::<1>(Arch::Scalar, &a, &known);
            for arch in wide.into_iter().flatten() {
                assert!(bits::<1>(arch, &a, &known) == expected, "{n:?}: one");
                assert!(bits::<2>(arch, &a, &known) == expected, "{n:?}: two");
            }
        }
    }
}
