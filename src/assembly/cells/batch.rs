//! The matrices of some cells, batch after batch.

pub(super) use super::lanes::Entries;
use super::lanes::{Jacobians, Layout, constant, jacobians, products, pulled_back};
use super::tables::Tables;
use crate::assembly::source::{PointTangent, Source};
use pulp::{Simd, WithSimd, bytemuck};

/// Writes coordinate i of node b of an element at `(b * N + i) * lanes + lane`: (element, ids as scratch, numbers, lanes, lane).
pub(super) type Nodes<'a> = dyn Fn(usize, &mut Vec<usize>, &mut [f64], usize, usize) + Sync + 'a;
/// The matrices of the cells of a batch: entry (a, c; b, e) of cell `lane` at `(((a * padded + b) * C + c) * C + e) * lanes + lane`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Matrices<'a> {
    pub values: &'a [f64],
    pub lanes: usize,
    pub padded: usize,
}

/// Runs over `elements`, which have the tables `tables`, and hands on the matrices of as many as there are lanes.
pub(super) struct Run<'a, const N: usize> {
    pub tables: &'a Tables<N>,
    /// All maps are affine.
    pub affine: bool,
    pub nodes: &'a Nodes<'a>,
    pub source: &'a Source<'a>,
    /// Of the same tangents everywhere, per pair of components.
    pub constant: &'a [Entries],
    pub components: usize,
    /// Only b >= a is wanted.
    pub upper: bool,
    pub elements: &'a [u32],
    pub sink: &'a mut dyn FnMut(&[u32], Matrices<'_>),
}

impl<const N: usize> WithSimd for Run<'_, N> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        if !S::IS_SCALAR {
            run(simd, self);
        }
    }
}

/// What a run keeps between batches.
struct Scratch<V, const N: usize> {
    jacobians: Jacobians<V, N>,
    nodes: Vec<[V; N]>,
    d: Vec<[[V; N]; N]>,
    weights: Vec<[[V; 1]; 1]>,
    tested: Vec<[V; N]>,
    tested_values: Vec<[V; 1]>,
    /// Tangents per point and pair of components.
    tangents: Vec<[[V; N]; N]>,
    ids: Vec<usize>,
    tangent: Vec<f64>,
    out: Vec<V>,
}

#[inline(always)]
fn run<S: Simd, const N: usize>(simd: S, run: Run<'_, N>) {
    let zero = simd.splat_f64s(0.0);
    let (tables, lanes, pairs) = (run.tables, S::F64_LANES, run.components * run.components);
    let padded = tables.grads.padded();
    let mut scratch = Scratch {
        jacobians: Jacobians { adjugate: Vec::new(), det: Vec::new() },
        nodes: vec![[zero; N]; tables.nodes],
        d: Vec::new(),
        weights: Vec::new(),
        tested: Vec::new(),
        tested_values: Vec::new(),
        tangents: vec![[[zero; N]; N]; if matches!(run.source, Source::PerPoint(_)) { tables.weights.len() * pairs } else { 0 }],
        ids: Vec::new(),
        tangent: vec![0.0; pairs * N * N],
        out: vec![zero; tables.functions * padded * pairs],
    };
    for batch in run.elements.chunks(lanes) {
        gather::<S, N>(&run, batch, &mut scratch);
        simd.vectorize(Batch { simd, run: &run, batch, scratch: &mut scratch });
        (run.sink)(batch, Matrices { values: bytemuck::cast_slice(&scratch.out), lanes, padded });
    }
}

/// Nodes of the cells of a batch; lanes beyond the last repeat it.
#[inline(always)]
fn gather<S: Simd, const N: usize>(run: &Run<'_, N>, batch: &[u32], scratch: &mut Scratch<S::f64s, N>) {
    let lanes = S::F64_LANES;
    let to: &mut [f64] = bytemuck::cast_slice_mut(scratch.nodes.as_flattened_mut());
    for lane in 0..lanes {
        let e = batch[lane.min(batch.len() - 1)];
        (run.nodes)(e as usize, &mut scratch.ids, to, lanes, lane);
    }
}

/// One batch, compiled for the lanes chosen.
struct Batch<'a, 'r, S: Simd, const N: usize> {
    simd: S,
    run: &'a Run<'r, N>,
    batch: &'a [u32],
    scratch: &'a mut Scratch<S::f64s, N>,
}

impl<S: Simd, const N: usize> pulp::NullaryFnOnce for Batch<'_, '_, S, N> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let Self { simd, run, batch, scratch } = self;
        let tables = run.tables;
        let is_constant = run.affine && matches!(run.source, Source::Constant(_));
        let points = if run.affine { 1 } else { tables.weights.len() };
        jacobians(simd, tables, points, &scratch.nodes, &mut scratch.jacobians);
        // the Jacobian at a point; an affine map has one
        let at = |q: usize| if run.affine { 0 } else { q };
        if let Source::Mass = run.source {
            scratch.weights.clear();
            for (q, &w) in tables.weights.iter().enumerate() {
                scratch.weights.push([[simd.mul_f64s(simd.splat_f64s(w), scratch.jacobians.det[at(q)])]]);
            }
            let layout = Layout { stride: 1, offset: 0, upper: run.upper };
            products(simd, &tables.values, &scratch.weights, &mut scratch.tested_values, layout, &mut scratch.out);
            return;
        }
        if let Source::PerPoint(tangent) = run.source {
            tangents(simd, run, tangent, batch.len(), scratch);
        }
        let pairs = run.components * run.components;
        for pair in 0..pairs {
            let layout = Layout { stride: pairs, offset: pair, upper: run.upper };
            if is_constant {
                let entries = run.constant[pair].iter().map(|&(i, j, t)| (i, j, simd.splat_f64s(t)));
                let d = pulled_back(simd, &scratch.jacobians, 0, 1.0, entries);
                constant(simd, tables, &d, layout, &mut scratch.out);
                continue;
            }
            scratch.d.clear();
            for (q, &w) in tables.weights.iter().enumerate() {
                let d = match run.source {
                    Source::Constant(_) => {
                        let entries = run.constant[pair].iter().map(|&(i, j, t)| (i, j, simd.splat_f64s(t)));
                        pulled_back(simd, &scratch.jacobians, at(q), w, entries)
                    }
                    _ => {
                        let t = &scratch.tangents[q * pairs + pair];
                        let entries = (0..N * N).map(|ij| (ij / N, ij % N, t[ij / N][ij % N]));
                        pulled_back(simd, &scratch.jacobians, at(q), w, entries)
                    }
                };
                scratch.d.push(d);
            }
            products(simd, &tables.grads, &scratch.d, &mut scratch.tested, layout, &mut scratch.out);
        }
    }
}

/// The tangents at all points of all cells of a batch.
#[inline(always)]
fn tangents<S: Simd, const N: usize>(
    simd: S,
    run: &Run<'_, N>,
    tangent: &PointTangent<'_>,
    cells: usize,
    scratch: &mut Scratch<S::f64s, N>,
) {
    let (lanes, numbers) = (S::F64_LANES, run.components * run.components * N * N);
    for q in 0..run.tables.weights.len() {
        let values = &run.tables.map_values[q * run.tables.nodes..][..run.tables.nodes];
        let mut x = [simd.splat_f64s(0.0); N];
        for (node, &value) in scratch.nodes.iter().zip(values) {
            for i in 0..N {
                x[i] = simd.mul_add_e_f64s(node[i], simd.splat_f64s(value), x[i]);
            }
        }
        let x: &[f64] = bytemuck::cast_slice(&x);
        let all: &mut [f64] = bytemuck::cast_slice_mut(scratch.tangents.as_flattened_mut().as_flattened_mut());
        let all = &mut all[q * numbers * lanes..][..numbers * lanes];
        for lane in 0..lanes {
            if lane < cells {
                let mut at = [0.0; N];
                for i in 0..N {
                    at[i] = x[i * lanes + lane];
                }
                tangent(&at, &mut scratch.tangent);
            }
            for (to, &t) in all.chunks_exact_mut(lanes).zip(&scratch.tangent) {
                to[lane] = t;
            }
        }
    }
}
