//! The columns of one supernode: a dense LDLᵀ without pivoting and the rows below it.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use pulp::{Arch, Simd, WithSimd};

/// Columns up to which they are eliminated one by one; more are split into halves with a dense product.
const FEW: usize = 16;

/// Replaces the `height` x `width` columns [A11; A21] by L, its diagonal by D: L D Lᵀ = A11 and L21 D L11ᵀ = A21. `scaled` becomes L D
/// below the diagonal. `None` if a pivot is zero or not finite.
pub(super) fn eliminate(columns: &mut [f64], height: usize, width: usize, scaled: &mut [f64]) -> Option<()> {
    halves(Arch::new(), columns, height, [0, width], scaled)?;
    // products of halves fill whole squares on the diagonal
    if width > FEW {
        columns.chunks_exact_mut(height).enumerate().for_each(|(j, column)| column[..j].fill(0.0));
    }
    Some(())
}

fn halves(arch: Arch, columns: &mut [f64], height: usize, [from, to]: [usize; 2], scaled: &mut [f64]) -> Option<()> {
    if to - from <= FEW {
        return arch.dispatch(Few { columns, height, from, to, scaled }).then_some(());
    }
    let middle = from + (to - from).div_ceil(2).next_multiple_of(FEW).min(to - from - 1);
    halves(arch, columns, height, [from, middle], scaled)?;
    let (done, rest) = columns.split_at_mut(middle * height);
    let wide = MatRef::from_column_major_slice(&scaled[from * height..middle * height], height, middle - from).split_at_row(middle).1;
    let unit = MatRef::from_column_major_slice(&done[from * height..], height, middle - from).subrows(middle, to - middle);
    let target = MatMut::from_column_major_slice_mut(&mut rest[..(to - middle) * height], height, to - middle);
    matmul(target.split_at_row_mut(middle).1, Accum::Add, wide, unit.transpose(), -1.0, Par::Seq);
    halves(arch, columns, height, [middle, to], scaled)
}

/// Elimination of the columns `from..to`, with the contributions of earlier columns already applied.
struct Few<'a> {
    columns: &'a mut [f64],
    height: usize,
    from: usize,
    to: usize,
    scaled: &'a mut [f64],
}

impl WithSimd for Few<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> bool {
        let Self { columns, height, from, to, scaled } = self;
        for c in from..to {
            let (before, own) = columns.split_at_mut(c * height);
            let own = &mut own[c..height];
            let (done, new) = scaled.split_at_mut(c * height);
            let factor = |j: usize| -before[j * height + c];
            let line = |j: usize| &done[j * height + c..(j + 1) * height];
            let mut j = from;
            while j + 4 <= c {
                subtract(simd, own, std::array::from_fn::<_, 4, _>(|k| line(j + k)), std::array::from_fn(|k| factor(j + k)));
                j += 4;
            }
            while j < c {
                subtract(simd, own, [line(j)], [factor(j)]);
                j += 1;
            }
            let pivot = own[0];
            if pivot == 0.0 || !pivot.is_finite() {
                return false;
            }
            new[c..height].copy_from_slice(own);
            divide(simd, &mut own[1..], 1.0 / pivot);
        }
        true
    }
}

/// y += sum_k factor_k x_k.
#[inline(always)]
fn subtract<S: Simd, const K: usize>(simd: S, y: &mut [f64], x: [&[f64]; K], factor: [f64; K]) {
    subtract_each(simd, [y], x, [factor]);
}

/// y_r += sum_k factor_rk x_k for R vectors y_r; every x is read once.
#[inline(always)]
pub(super) fn subtract_each<S: Simd, const K: usize, const R: usize>(simd: S, y: [&mut [f64]; R], x: [&[f64]; K], factor: [[f64; K]; R]) {
    let n = x[0].len();
    let wide = factor.map(|f| f.map(|f| simd.splat_f64s(f)));
    let x: [_; K] = std::array::from_fn(|k| S::as_simd_f64s(&x[k][..n]));
    let y = y.map(|y| S::as_mut_simd_f64s(&mut y[..n]));
    for i in 0..x[0].0.len() {
        let x: [S::f64s; K] = std::array::from_fn(|k| x[k].0[i]);
        for r in 0..R {
            let mut sum = y[r].0[i];
            for k in 0..K {
                sum = simd.mul_add_f64s(wide[r][k], x[k], sum);
            }
            y[r].0[i] = sum;
        }
    }
    if !x[0].1.is_empty() {
        for r in 0..R {
            let mut last = simd.partial_load_f64s(y[r].1);
            for k in 0..K {
                last = simd.mul_add_f64s(wide[r][k], simd.partial_load_f64s(x[k].1), last);
            }
            simd.partial_store_f64s(y[r].1, last);
        }
    }
}

#[inline(always)]
fn divide<S: Simd>(simd: S, y: &mut [f64], factor: f64) {
    let wide = simd.splat_f64s(factor);
    let (lanes, rest) = S::as_mut_simd_f64s(y);
    for y in lanes {
        *y = simd.mul_f64s(wide, *y);
    }
    for y in rest {
        *y *= factor;
    }
}
