//! Functions on the grid of points, contracted from their coefficients direction by direction.

use super::axis::AxisTable;
use crate::basis::Block;
use crate::linalg::Real;
use crate::quadrature::Quadrature;
use pulp::Simd;
use std::ops::Range;

/// sum_k N_k c_k with `width` numbers c_k per function: positions in homogeneous form, or a weight function.
#[derive(Clone, Debug)]
pub(super) struct TensorField {
    /// The directions of the functions.
    pub axes: Vec<AxisTable>,
    /// Numbers per function.
    pub width: usize,
    /// The numbers, those of one function together.
    pub coefficients: Vec<f64>,
}

/// The functions of the second direction at the points of one tile.
#[derive(Clone, Debug)]
pub(super) struct Tile<V> {
    first: usize,
    /// Value and derivative per function, points in lanes.
    tables: Vec<[V; 2]>,
}

/// A net contracted along all directions but the second: per point of the first direction the coefficients of a curve.
#[derive(Clone, Debug, Default)]
pub(super) struct Curves {
    /// Functions of the second direction.
    of: Range<usize>,
    /// `[((point * functions + function) * N + kind) * width + c]`, kinds value, derivative along the first direction, derivative
    /// along the third, points counted from the first of the elements.
    numbers: Vec<f64>,
}

impl Curves {
    /// Whether nothing has been contracted yet.
    pub fn is_empty(&self) -> bool {
        self.numbers.is_empty()
    }
}

impl<V> Default for Tile<V> {
    fn default() -> Self {
        Self { first: 0, tables: Vec::new() }
    }
}

impl TensorField {
    /// The functions of `block` with `coefficients`, at the points of `rules`; `None` where an axis has no simple form.
    pub fn new<const N: usize, T: Real>(
        block: &Block<'_, N, T>,
        rules: &[&dyn Quadrature<1, T>; N],
        width: usize,
        coefficients: Vec<f64>,
    ) -> Option<Self> {
        let axes: Vec<AxisTable> = block.axes.iter().zip(rules).map(|(axis, rule)| AxisTable::new(*axis, *rule)).collect::<Option<_>>()?;
        let functions: usize = axes.iter().map(|a| a.functions).product();
        (coefficients.len() == functions * width).then_some(Self { axes, width, coefficients })
    }

    /// Elements per direction.
    pub fn elements(&self) -> Vec<usize> {
        self.axes.iter().map(AxisTable::elements).collect()
    }

    /// Contracts all but the second direction: on `elements` of the first and for those of the second, the third at a point with its
    /// element, `slow`.
    pub fn curves<const N: usize>(
        &self,
        (slow, owner): (usize, usize),
        elements: [&Range<usize>; 2],
        out: &mut Curves,
        scratch: &mut Vec<f64>,
    ) {
        let m = self.width;
        let (first, second) = (&self.axes[0], &self.axes[1]);
        let n0 = first.functions;
        // functions on these elements
        let [own, of] =
            [(first, elements[0]), (second, elements[1])].map(|(axis, e)| axis.first[e.start]..axis.first[e.end - 1] + axis.active);
        let (mut stride, mut before) = (n0, 0);
        let (values, slopes): (&[f64], &[f64]) = if N == 3 {
            let third = &self.axes[2];
            (stride, before) = (own.len(), own.start);
            let plane = stride * of.len() * m;
            scratch.clear();
            scratch.resize(2 * plane, 0.0);
            let (values, slopes) = scratch.split_at_mut(plane);
            for a in 0..third.active {
                let (v, s) = (third.values[slow * third.active + a], third.slopes[slow * third.active + a]);
                let from = &self.coefficients[((third.first[owner] + a) * second.functions + of.start) * n0 * m..][..of.len() * n0 * m];
                let to = values.chunks_exact_mut(stride * m).zip(slopes.chunks_exact_mut(stride * m));
                for ((values, slopes), from) in to.zip(from.chunks_exact(n0 * m)) {
                    for ((value, slope), &c) in values.iter_mut().zip(slopes).zip(&from[own.start * m..own.end * m]) {
                        *value += v * c;
                        *slope += s * c;
                    }
                }
            }
            (values, slopes)
        } else {
            (&self.coefficients[of.start * n0 * m..of.end * n0 * m], &[])
        };
        let origin = first.start[elements[0].start];
        out.numbers.clear();
        out.numbers.resize((first.start[elements[0].end] - origin) * of.len() * N * m, 0.0);
        for e in elements[0].clone() {
            for q in first.start[e]..first.start[e + 1] {
                for k in 0..of.len() {
                    let to = &mut out.numbers[((q - origin) * of.len() + k) * N * m..][..N * m];
                    for a in 0..first.active {
                        let (v, s) = (first.values[q * first.active + a], first.slopes[q * first.active + a]);
                        let from = (k * stride + first.first[e] + a - before) * m;
                        for c in 0..m {
                            to[c] += v * values[from + c];
                            to[m + c] += s * values[from + c];
                            if N == 3 {
                                to[2 * m + c] += v * slopes[from + c];
                            }
                        }
                    }
                }
            }
        }
        out.of = of;
    }

    /// Tables of the second direction with `points[lane]` = (point, element) in lanes.
    pub fn tile<S: Simd>(&self, simd: S, points: &[(usize, usize)], tile: &mut Tile<S::f64s>) {
        let axis = &self.axes[1];
        let range = points.iter().map(|p| axis.first[p.1]);
        let (lo, hi) = (range.clone().min().unwrap_or(0), range.max().unwrap_or(0) + axis.active);
        tile.first = lo;
        tile.tables.clear();
        tile.tables.resize(hi - lo, [simd.splat_f64s(0.0); 2]);
        let lanes = S::F64_LANES;
        let numbers: &mut [f64] = pulp::bytemuck::cast_slice_mut(tile.tables.as_flattened_mut());
        for (lane, &(q, e)) in points.iter().enumerate() {
            for a in 0..axis.active {
                let at = 2 * (axis.first[e] + a - lo) * lanes + lane;
                numbers[at] = axis.values[q * axis.active + a];
                numbers[at + lanes] = axis.slopes[q * axis.active + a];
            }
        }
    }

    /// Value and derivatives along all directions at point `q` of `curves`, the tile's points in lanes.
    #[inline(always)]
    pub fn at<S: Simd, const N: usize, const M: usize>(
        &self,
        simd: S,
        q: usize,
        curves: &Curves,
        tile: &Tile<S::f64s>,
    ) -> ([S::f64s; M], [[S::f64s; M]; N]) {
        Self::some::<S, N, M>(simd, q, curves, tile, (M, 0))
    }

    /// [`Self::at`] for the number `c` of each function alone.
    #[inline(always)]
    pub fn one<S: Simd, const N: usize>(
        &self,
        simd: S,
        (q, c): (usize, usize),
        curves: &Curves,
        tile: &Tile<S::f64s>,
    ) -> (S::f64s, [S::f64s; N]) {
        let ([value], slope) = Self::some::<S, N, 1>(simd, q, curves, tile, (self.width, c));
        (value, slope.map(|[s]| s))
    }

    /// M of `width` numbers per function, from the one of number `first` on.
    #[inline(always)]
    fn some<S: Simd, const N: usize, const M: usize>(
        simd: S,
        q: usize,
        curves: &Curves,
        tile: &Tile<S::f64s>,
        (width, first): (usize, usize),
    ) -> ([S::f64s; M], [[S::f64s; M]; N]) {
        let zero = simd.splat_f64s(0.0);
        let (mut value, mut slope) = ([zero; M], [[zero; M]; N]);
        let start = (q * curves.of.len() + tile.first - curves.of.start) * N * width;
        let lines = curves.numbers[start..start + tile.tables.len() * N * width].chunks_exact(N * width);
        for (line, [v, s]) in lines.zip(&tile.tables) {
            for c in 0..M {
                let along = simd.splat_f64s(line[first + c]);
                value[c] = simd.mul_add_e_f64s(along, *v, value[c]);
                slope[1][c] = simd.mul_add_e_f64s(along, *s, slope[1][c]);
                slope[0][c] = simd.mul_add_e_f64s(simd.splat_f64s(line[width + first + c]), *v, slope[0][c]);
                if N == 3 {
                    slope[2][c] = simd.mul_add_e_f64s(simd.splat_f64s(line[2 * width + first + c]), *v, slope[2][c]);
                }
            }
        }
        (value, slope)
    }
}
