//! The matrices of some cells, batch after batch.

pub(super) use super::lanes::Entries;
use super::lanes::{Jacobians, OutputLayout, bent, constant, jacobians, products, pulled_back};
use super::slots::{BATCH, Batch};
use super::tables::Tables;
use crate::assembly::source::{Integrand, PointTangent};
use crate::assembly::sum_factorization::physical;
use pulp::{Simd, WithSimd, bytemuck};
use std::ops::Range;

/// Writes coordinate i of node b of the element of a lane at `(b * N + i) * lanes + lane`: (elements, ids as scratch, numbers).
pub(super) type Nodes<'a> = dyn Fn(&[u32], &mut Vec<usize>, &mut [f64]) + Sync + 'a;

/// Cells of a batch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Member {
    pub batch: u32,
    /// Bit mask of the cells.
    pub lanes: u8,
}

/// The matrices of the cells of a batch: entry (a, c; b, e) of cell `k` is in part `k / lanes` of `values.len() * lanes / BATCH` numbers,
/// at `(((a * padded + b) * C + c) * C + e) * lanes + k % lanes`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Matrices<'a> {
    pub values: &'a [f64],
    pub lanes: usize,
    pub padded: usize,
}

/// Computes the matrices of the `members` that have a function in `functions`, all with the same `tables`, and passes them to `sink`.
pub(super) struct BatchKernel<'a, const N: usize> {
    pub tables: &'a Tables<N>,
    pub nodes: &'a Nodes<'a>,
    pub source: &'a Integrand<'a>,
    /// Writes the coefficients of the state, as [`Nodes`] writes nodes, if the source has one.
    pub state: Option<&'a Nodes<'a>>,
    /// Non-zero entries of a constant tangent, per pair of components.
    pub constant: &'a [Entries],
    pub components: usize,
    /// Whether only b >= a is computed.
    pub upper: bool,
    pub batches: &'a [Batch],
    pub members: &'a [Member],
    pub functions: Range<u32>,
    pub sink: &'a mut dyn FnMut(&Batch, u8, Matrices<'_>),
}

impl<const N: usize> WithSimd for BatchKernel<'_, N> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        if !S::IS_SCALAR {
            run(simd, self);
        }
    }
}

/// Memory of a run, reused from batch to batch.
struct Scratch<V, const N: usize> {
    jacobians: Jacobians<V, N>,
    d: Vec<[[V; N]; N]>,
    weights: Vec<[[V; 1]; 1]>,
    tested: Vec<[V; N]>,
    tested_values: Vec<[V; 1]>,
    /// Tangents per point and pair of components.
    tangents: Vec<[[V; N]; N]>,
    /// Physical gradient of the state at a point, per component; empty without a state.
    gradient: Vec<[V; N]>,
    /// The gradient of one lane.
    numbers: Vec<f64>,
    ids: Vec<usize>,
    tangent: Vec<f64>,
}

#[inline(always)]
fn run<S: Simd, const N: usize>(simd: S, run: BatchKernel<'_, N>) {
    let zero = simd.splat_f64s(0.0);
    let (tables, lanes, pairs) = (run.tables, S::F64_LANES, run.components * run.components);
    let padded = tables.grads.padded();
    let mut scratch = Scratch {
        jacobians: Jacobians { adjugate: Vec::new(), det: Vec::new() },
        d: Vec::new(),
        weights: Vec::new(),
        tested: Vec::new(),
        tested_values: Vec::new(),
        tangents: vec![[[zero; N]; N]; if matches!(run.source, Integrand::PerPoint { .. }) { tables.at.weights.len() * pairs } else { 0 }],
        gradient: vec![[zero; N]; if run.state.is_some() { run.components } else { 0 }],
        numbers: vec![0.0; if run.state.is_some() { run.components * N } else { 0 }],
        ids: Vec::new(),
        tangent: vec![0.0; pairs * N * N],
    };
    let size = tables.at.functions * padded * pairs;
    let mut out = vec![zero; size * BATCH / lanes];
    let mut nodes = vec![[zero; N]; tables.at.nodes * BATCH / lanes];
    let mut state = vec![zero; if run.state.is_some() { tables.at.functions * run.components } else { 0 }];
    for member in run.members {
        let batch = &run.batches[member.batch as usize];
        if batch.end <= run.functions.start || batch.least >= run.functions.end {
            continue;
        }
        // lanes without a cell repeat one
        let cells = batch.cells();
        let mut elements = [cells[member.lanes.trailing_zeros() as usize]; BATCH];
        for (k, &e) in cells.iter().enumerate() {
            if member.lanes >> k & 1 == 1 {
                elements[k] = e;
            }
        }
        let used = |part: usize| (usize::from(member.lanes) >> (part * lanes)) & ((1 << lanes) - 1);
        // decided for the whole member, so that its matrices have the same bits for any number of lanes
        let mut straight = tables.bends.is_some();
        for (part, nodes) in nodes.chunks_exact_mut(tables.at.nodes).enumerate().filter(|(part, _)| used(*part) != 0) {
            (run.nodes)(&elements[part * lanes..][..lanes], &mut scratch.ids, bytemuck::cast_slice_mut(nodes.as_flattened_mut()));
            straight = straight && simd.vectorize(Straight { simd, tables, nodes });
        }
        let parts = nodes.chunks_exact(tables.at.nodes).zip(out.chunks_exact_mut(size));
        for (part, (nodes, out)) in parts.enumerate().filter(|(part, _)| used(*part) != 0) {
            if let Some(read) = run.state {
                read(&elements[part * lanes..][..lanes], &mut scratch.ids, bytemuck::cast_slice_mut(&mut state));
            }
            simd.vectorize(Part { simd, run: &run, used: used(part), straight, nodes, state: &state, scratch: &mut scratch, out });
        }
        (run.sink)(batch, member.lanes, Matrices { values: bytemuck::cast_slice(&out), lanes, padded });
    }
}

/// Check whether each cell of one vector of lanes has the same Jacobian at all points.
struct Straight<'a, S: Simd, const N: usize> {
    simd: S,
    tables: &'a Tables<N>,
    nodes: &'a [[S::f64s; N]],
}

impl<S: Simd, const N: usize> pulp::NullaryFnOnce for Straight<'_, S, N> {
    type Output = bool;
    #[inline(always)]
    fn call(self) -> bool {
        let Some(bends) = &self.tables.bends else { return false };
        let bent = bent(self.simd, bends, self.nodes);
        bends.is_empty() || bytemuck::cast_slice::<_, f64>(&[bent]).iter().all(|&b| b <= 0.0)
    }
}

/// The cells of one vector of lanes, compiled for the chosen instruction set.
struct Part<'a, 'r, S: Simd, const N: usize> {
    simd: S,
    run: &'a BatchKernel<'r, N>,
    /// A bit per lane that has a cell, from the lowest.
    used: usize,
    straight: bool,
    nodes: &'a [[S::f64s; N]],
    /// `[function * components + component]`.
    state: &'a [S::f64s],
    scratch: &'a mut Scratch<S::f64s, N>,
    out: &'a mut [S::f64s],
}

impl<S: Simd, const N: usize> pulp::NullaryFnOnce for Part<'_, '_, S, N> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let Self { simd, run, used, straight, nodes, state, scratch, out } = self;
        let tables = run.tables;
        let is_constant = straight && matches!(run.source, Integrand::Constant(_));
        let points = if straight { 1 } else { tables.at.weights.len() };
        jacobians(simd, tables, points, nodes, &mut scratch.jacobians);
        let at = |q: usize| if straight { 0 } else { q };
        if let Integrand::Mass = run.source {
            scratch.weights.clear();
            for (q, &w) in tables.at.weights.iter().enumerate() {
                scratch.weights.push([[simd.mul_f64s(simd.splat_f64s(w), simd.abs_f64s(scratch.jacobians.det[at(q)]))]]);
            }
            let layout = OutputLayout { stride: 1, offset: 0, upper: run.upper };
            products(simd, &tables.values, &scratch.weights, &mut scratch.tested_values, layout, out);
            return;
        }
        if let Integrand::PerPoint { at: tangent, .. } = run.source {
            tangents(simd, run, tangent, (used, straight), nodes, state, scratch);
        }
        let pairs = run.components * run.components;
        for pair in 0..pairs {
            let layout = OutputLayout { stride: pairs, offset: pair, upper: run.upper };
            if is_constant {
                let entries = run.constant[pair].iter().map(|&(i, j, t)| (i, j, simd.splat_f64s(t)));
                let d = pulled_back(simd, &scratch.jacobians, 0, 1.0, entries);
                constant(simd, tables, &d, layout, out);
                continue;
            }
            scratch.d.clear();
            for (q, &w) in tables.at.weights.iter().enumerate() {
                let d = match run.source {
                    Integrand::Constant(_) => {
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
            products(simd, &tables.grads, &scratch.d, &mut scratch.tested, layout, out);
        }
    }
}

/// The tangents at all points of the cells of a part.
#[inline(always)]
fn tangents<S: Simd, const N: usize>(
    simd: S,
    run: &BatchKernel<'_, N>,
    tangent: &PointTangent<'_>,
    (used, straight): (usize, bool),
    nodes: &[[S::f64s; N]],
    state: &[S::f64s],
    scratch: &mut Scratch<S::f64s, N>,
) {
    let (lanes, numbers) = (S::F64_LANES, run.components * run.components * N * N);
    for q in 0..run.tables.at.weights.len() {
        let values = &run.tables.at.map_values[q * run.tables.at.nodes..][..run.tables.at.nodes];
        let mut x = [simd.splat_f64s(0.0); N];
        for (node, &value) in nodes.iter().zip(values) {
            for i in 0..N {
                x[i] = simd.mul_add_e_f64s(node[i], simd.splat_f64s(value), x[i]);
            }
        }
        gradients(simd, run, (q, straight), state, scratch);
        let gradient: &[f64] = bytemuck::cast_slice(scratch.gradient.as_flattened());
        let x: &[f64] = bytemuck::cast_slice(&x);
        let all: &mut [f64] = bytemuck::cast_slice_mut(scratch.tangents.as_flattened_mut().as_flattened_mut());
        let all = &mut all[q * numbers * lanes..][..numbers * lanes];
        for lane in 0..lanes {
            if used >> lane & 1 == 1 {
                let mut at = [0.0; N];
                for i in 0..N {
                    at[i] = x[i * lanes + lane];
                }
                scratch.numbers.iter_mut().enumerate().for_each(|(k, g)| *g = gradient[k * lanes + lane]);
                tangent(&at, &scratch.numbers, &mut scratch.tangent);
            }
            for (to, &t) in all.chunks_exact_mut(lanes).zip(&scratch.tangent) {
                to[lane] = t;
            }
        }
    }
}

/// The physical gradient of the state at point `q`, if there is a state.
#[inline(always)]
fn gradients<S: Simd, const N: usize>(
    simd: S,
    run: &BatchKernel<'_, N>,
    (q, straight): (usize, bool),
    state: &[S::f64s],
    scratch: &mut Scratch<S::f64s, N>,
) {
    let grads = &run.tables.at.grads[q * run.tables.at.functions..][..run.tables.at.functions];
    let at = if straight { 0 } else { q };
    for (c, out) in scratch.gradient.iter_mut().enumerate() {
        let mut slope = [simd.splat_f64s(0.0); N];
        for (&u, grad) in state[c..].iter().step_by(run.components).zip(grads) {
            for k in 0..N {
                slope[k] = simd.mul_add_e_f64s(u, simd.splat_f64s(grad[k]), slope[k]);
            }
        }
        *out = physical::<S, N>(simd, &scratch.jacobians.adjugate[at], &slope).map(|h| simd.div_f64s(h, scratch.jacobians.det[at]));
    }
}
