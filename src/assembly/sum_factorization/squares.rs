//! Squares of the difference of two fields at the points of a cell: values, gradients, energy.

use super::cell::{Cell, quotient};
use super::map::{inverse, numbers};
use super::point_operator::{self, PointOperator};
use pulp::{Simd, bytemuck};

/// Squares that are summed: value, gradient, energy of the difference, then of the other field.
pub(in crate::assembly) const SQUARES: usize = 6;

/// Sums squares; what it needs in between is kept from cell to cell.
pub(in crate::assembly) struct Squares<'a, V> {
    law: &'a PointOperator<'a>,
    width: usize,
    h: Vec<V>,
    stress: Vec<V>,
    tangents: Vec<V>,
    buffer: Vec<f64>,
}

impl<'a, V: bytemuck::Pod> Squares<'a, V> {
    /// For fields of `width` components, with the energy of `law`.
    pub fn new(law: &'a PointOperator<'a>, width: usize) -> Self {
        Self { law, width, h: Vec::new(), stress: Vec::new(), tangents: Vec::new(), buffer: Vec::new() }
    }

    /// The sums over the points of a cell. The field has local derivatives and values `g[(point * width + c) * (N + 1) + d]`
    /// (d = N: value; numerators, where it is rational), the other one values, then derivatives, `width * (N + 1)` numbers
    /// per point.
    #[inline(always)]
    pub fn of<S: Simd<f64s = V>, const N: usize>(&mut self, simd: S, cell: Cell<'_, V>, g: &mut [V], other: &[V]) -> [V; SQUARES] {
        let width = self.width;
        let zero = simd.splat_f64s(0.0);
        self.law.tangents::<S, N>(simd, width, cell, &mut self.buffer, &mut self.tangents);
        let size = self.tangents.len() / cell.points.max(1);
        self.h.resize(width * N, zero);
        self.stress.resize(width * N, zero);
        let mut sums = [zero; SQUARES];
        for q in 0..cell.points {
            let map = &cell.map[q * numbers(N)..][..numbers(N)];
            let tangent = &self.tangents[q * size..][..size];
            let other = &other[q * width * (N + 1)..][..width * (N + 1)];
            let (dx, r) = (map[N + N * N + 1], inverse::<S, N>(simd, map));
            let mut squares = [zero; SQUARES];
            for c in 0..width {
                let g = &mut g[(q * width + c) * (N + 1)..][..N + 1];
                quotient::<S, N>(simd, cell, q, g);
                let own = point_operator::physical::<S, N>(simd, &r, g);
                let value = simd.sub_f64s(g[N], other[c]);
                squares[0] = simd.mul_add_e_f64s(value, value, squares[0]);
                squares[3] = simd.mul_add_e_f64s(other[c], other[c], squares[3]);
                for j in 0..N {
                    let there = other[width + c * N + j];
                    let apart = simd.sub_f64s(own[j], there);
                    self.h[c * N + j] = apart;
                    squares[1] = simd.mul_add_e_f64s(apart, apart, squares[1]);
                    squares[4] = simd.mul_add_e_f64s(there, there, squares[4]);
                }
            }
            self.law.stress::<S, N>(simd, tangent, &self.h, &mut self.stress);
            squares[2] = dot(simd, &self.stress, &self.h);
            self.law.stress::<S, N>(simd, tangent, &other[width..], &mut self.stress);
            squares[5] = dot(simd, &self.stress, &other[width..]);
            for k in 0..SQUARES {
                sums[k] = simd.mul_add_e_f64s(dx, squares[k], sums[k]);
            }
        }
        sums
    }
}

#[inline(always)]
fn dot<S: Simd>(simd: S, a: &[S::f64s], b: &[S::f64s]) -> S::f64s {
    let mut sum = simd.splat_f64s(0.0);
    for (a, b) in a.iter().zip(b) {
        sum = simd.mul_add_e_f64s(*a, *b, sum);
    }
    sum
}
