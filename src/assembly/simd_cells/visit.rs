//! Evaluation at the points of cells in lanes, batch by batch: loads, squares of differences, fields.

use super::batch::Nodes;
use super::points::PointTables;
use crate::assembly::sum_factorization::{
    CellPoints, Physical, PointCallback, PointOperator, QuadraturePoints, Squares, add_moments, finish, inverse, numbers_of_map, physical,
    state_size, tested,
};
use pulp::{NullaryFnOnce, Simd, WithSimd, bytemuck};

/// Quantity to compute.
#[derive(Clone, Copy)]
pub(super) enum PointQuantity<'a> {
    /// Forces times functions, then the moments of the forces.
    Load(&'a PointCallback<'a>),
    /// Stresses times gradients of functions, then the energy.
    Stress(&'a PointCallback<'a>),
    /// Squares of the difference between a field and the values of `answer`; `field` writes its coefficients as [`Nodes`] writes nodes.
    Squares { law: &'a PointOperator<'a>, field: &'a Nodes<'a>, answer: &'a PointCallback<'a> },
    /// Position, values and gradients of a field at every point; `None` is the zero field, for any map.
    States(Option<&'a Nodes<'a>>),
}

/// Evaluates some elements batch by batch and appends the numbers of each to `numbers`.
pub(super) struct BatchVisit<'a, const D: usize> {
    pub tables: &'a PointTables<D>,
    pub nodes: &'a Nodes<'a>,
    /// Writes the coefficients of a state as [`Nodes`] writes nodes: its gradient belongs to the points.
    pub state: Option<&'a Nodes<'a>>,
    pub kind: PointQuantity<'a>,
    /// Components of the force or of the field.
    pub width: usize,
    pub elements: &'a [u32],
    /// Ids of the functions of an element, as scratch.
    pub ids: &'a mut Vec<usize>,
    pub numbers: &'a mut Vec<f64>,
}

impl<const D: usize> WithSimd for BatchVisit<'_, D> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        if S::IS_SCALAR {
            return;
        }
        let Self { tables, nodes, state, kind, width, elements, ids, numbers } = self;
        let (zero, lanes, points) = (simd.splat_f64s(0.0), S::F64_LANES, tables.weights.len());
        let mut places = vec![[zero; D]; tables.nodes];
        let mut map = vec![zero; points * numbers_of_map(D)];
        let (mut sites, mut answers, mut out) = (QuadraturePoints::default(), Vec::new(), Vec::<S::f64s>::new());
        let (mut field, mut g) = (vec![zero; tables.functions * width], vec![zero; points * width * (D + 1)]);
        let per_state = |n: usize| vec![zero; if state.is_some() { n * width } else { 0 }];
        let (mut unknowns, mut gradients) = (per_state(tables.functions), per_state(points * D));
        let mut squares = if let PointQuantity::Squares { law, .. } = kind { Some(Squares::new(law, width)) } else { None };
        let (mut which, mut here) = (Vec::with_capacity(lanes), Vec::with_capacity(lanes));
        sites.xi = tables.xi.repeat(lanes);
        sites.first = vec![0; lanes];
        for batch in elements.chunks(lanes) {
            which.clear();
            sites.elements.clear();
            here.clear();
            for lane in 0..lanes {
                let k = lane.min(batch.len() - 1);
                which.push((k, batch[k] as usize));
                sites.elements.push(batch[k] as usize);
                here.push(batch[k]);
            }
            nodes(&here, ids, bytemuck::cast_slice_mut(places.as_flattened_mut()));
            simd.vectorize(BatchMap { simd, tables, nodes: &places, out: &mut map });
            let mut cell = CellPoints { points, map: &map, kept: &[], weight: None, state: &[] };
            if let Some(read) = state {
                read(&here, ids, bytemuck::cast_slice_mut(&mut unknowns));
                simd.vectorize(Spread::<'_, S, D> { simd, tables, width, field: &unknowns, out: &mut g });
                simd.vectorize(Physical::<'_, S, D> { simd, cell, width, g: &mut g, out: &mut gradients });
                cell.state = &gradients;
            }
            if let PointQuantity::Squares { field: read, .. } | PointQuantity::States(Some(read)) = kind {
                read(&here, ids, bytemuck::cast_slice_mut(&mut field));
                simd.vectorize(Spread::<'_, S, D> { simd, tables, width, field: &field, out: &mut g });
            }
            match (kind, &mut squares) {
                (PointQuantity::Load(answer), _) => {
                    sites.ask::<S, D>(simd, cell, &which, answer, width, &mut answers);
                    simd.vectorize(Load { simd, tables, width, map: &map, forces: &mut answers, out: &mut out });
                }
                (PointQuantity::Stress(answer), _) => {
                    sites.ask::<S, D>(simd, cell, &which, answer, width * D + 1, &mut answers);
                    simd.vectorize(Force { simd, tables, width, map: &map, answers: &answers, t: &mut g, out: &mut out });
                }
                (PointQuantity::Squares { answer, .. }, Some(squares)) => {
                    sites.ask::<S, D>(simd, cell, &which, answer, width * (D + 1), &mut answers);
                    let (g, other, out) = (&mut g, &answers, &mut out);
                    simd.vectorize(Compare::<'_, '_, S, D> { simd, cell, g, squares, other, out });
                }
                _ => {
                    let g = matches!(kind, PointQuantity::States(Some(_))).then_some(&g[..]);
                    simd.vectorize(Show::<'_, S, D> { simd, width, map: &map, g, out: &mut out });
                }
            }
            let made: &[f64] = bytemuck::cast_slice(&out);
            for lane in 0..batch.len() {
                numbers.extend(made[lane..].iter().step_by(lanes));
            }
        }
    }
}

/// The map at the points of a batch, as on a grid of points.
struct BatchMap<'a, S: Simd, const D: usize> {
    simd: S,
    tables: &'a PointTables<D>,
    nodes: &'a [[S::f64s; D]],
    out: &'a mut [S::f64s],
}

impl<S: Simd, const D: usize> NullaryFnOnce for BatchMap<'_, S, D> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let Self { simd, tables, nodes, out } = self;
        let zero = simd.splat_f64s(0.0);
        let points = tables.map_values.chunks_exact(tables.nodes).zip(tables.map_grads.chunks_exact(tables.nodes));
        for ((out, (values, grads)), &weight) in out.chunks_exact_mut(numbers_of_map(D)).zip(points).zip(&tables.weights) {
            let (mut x, mut t) = ([zero; D], [[zero; D]; D]);
            for ((node, &value), grad) in nodes.iter().zip(values).zip(grads) {
                let value = simd.splat_f64s(value);
                for c in 0..D {
                    x[c] = simd.mul_add_e_f64s(node[c], value, x[c]);
                }
                for d in 0..D {
                    let grad = simd.splat_f64s(grad[d]);
                    for c in 0..D {
                        t[d][c] = simd.mul_add_e_f64s(node[c], grad, t[d][c]);
                    }
                }
            }
            finish(simd, &x, &t, simd.splat_f64s(weight), out);
        }
    }
}

/// Forces times functions, then the moments of the forces.
struct Load<'a, S: Simd, const D: usize> {
    simd: S,
    tables: &'a PointTables<D>,
    width: usize,
    map: &'a [S::f64s],
    forces: &'a mut [S::f64s],
    out: &'a mut Vec<S::f64s>,
}

impl<S: Simd, const D: usize> NullaryFnOnce for Load<'_, S, D> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let Self { simd, tables, width, map, forces, out } = self;
        out.clear();
        out.resize((tables.functions + D + 1) * width, simd.splat_f64s(0.0));
        let (loads, moments) = out.split_at_mut(tables.functions * width);
        let points = map.chunks_exact(numbers_of_map(D)).zip(forces.chunks_exact_mut(width));
        for ((map, forces), values) in points.zip(tables.values.chunks_exact(tables.functions)) {
            add_moments::<S, D>(simd, map, forces, moments);
            for force in forces.iter_mut() {
                *force = simd.mul_f64s(*force, map[D + D * D + 1]);
            }
            for (loads, &value) in loads.chunks_exact_mut(width).zip(values) {
                let value = simd.splat_f64s(value);
                for (load, &force) in loads.iter_mut().zip(forces.iter()) {
                    *load = simd.mul_add_e_f64s(value, force, *load);
                }
            }
        }
    }
}

/// Stresses times gradients of functions, then the energy.
struct Force<'a, S: Simd, const D: usize> {
    simd: S,
    tables: &'a PointTables<D>,
    width: usize,
    map: &'a [S::f64s],
    /// Stress and energy density per point.
    answers: &'a [S::f64s],
    /// Memory of `width * (D + 1)` numbers.
    t: &'a mut [S::f64s],
    out: &'a mut Vec<S::f64s>,
}

impl<S: Simd, const D: usize> NullaryFnOnce for Force<'_, S, D> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let Self { simd, tables, width, map, answers, t, out } = self;
        out.clear();
        out.resize(tables.functions * width + 1, simd.splat_f64s(0.0));
        let (forces, energy) = out.split_at_mut(tables.functions * width);
        let (t, points) = (&mut t[..width * (D + 1)], map.chunks_exact(numbers_of_map(D)).zip(answers.chunks_exact(width * D + 1)));
        for ((map, answers), grads) in points.zip(tables.grads.chunks_exact(tables.functions)) {
            tested::<S, D>(simd, map, None, &answers[..width * D], t);
            energy[0] = simd.mul_add_e_f64s(answers[width * D], map[D + D * D + 1], energy[0]);
            for (forces, grad) in forces.chunks_exact_mut(width).zip(grads) {
                for (force, t) in forces.iter_mut().zip(t.chunks_exact(D + 1)) {
                    for k in 0..D {
                        *force = simd.mul_add_e_f64s(simd.splat_f64s(grad[k]), t[k], *force);
                    }
                }
            }
        }
    }
}

/// Local derivatives and values of a field at the points, `[(point * width + c) * (D + 1) + d]`, d = D the value.
struct Spread<'a, S: Simd, const D: usize> {
    simd: S,
    tables: &'a PointTables<D>,
    width: usize,
    /// `[function * width + component]`.
    field: &'a [S::f64s],
    out: &'a mut [S::f64s],
}

impl<S: Simd, const D: usize> NullaryFnOnce for Spread<'_, S, D> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let Self { simd, tables, width, field, out } = self;
        let zero = simd.splat_f64s(0.0);
        let points = tables.values.chunks_exact(tables.functions).zip(tables.grads.chunks_exact(tables.functions));
        for (out, (values, grads)) in out.chunks_exact_mut(width * (D + 1)).zip(points) {
            for (c, out) in out.chunks_exact_mut(D + 1).enumerate() {
                let (mut value, mut slope) = (zero, [zero; D]);
                for ((&u, &v), grad) in field[c..].iter().step_by(width).zip(values).zip(grads) {
                    value = simd.mul_add_e_f64s(u, simd.splat_f64s(v), value);
                    for k in 0..D {
                        slope[k] = simd.mul_add_e_f64s(u, simd.splat_f64s(grad[k]), slope[k]);
                    }
                }
                out[..D].copy_from_slice(&slope);
                out[D] = value;
            }
        }
    }
}

/// Squares of the difference between the field and the given values `other`.
struct Compare<'a, 'l, S: Simd, const D: usize> {
    simd: S,
    cell: CellPoints<'a, S::f64s>,
    g: &'a mut [S::f64s],
    squares: &'a mut Squares<'l, S::f64s>,
    other: &'a [S::f64s],
    out: &'a mut Vec<S::f64s>,
}

impl<S: Simd, const D: usize> NullaryFnOnce for Compare<'_, '_, S, D> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let Self { simd, cell, g, squares, other, out } = self;
        out.clear();
        out.extend_from_slice(&squares.of::<S, D>(simd, cell, g, other));
    }
}

/// Position, values and gradients of the field, `state_size` numbers per point.
struct Show<'a, S: Simd, const D: usize> {
    simd: S,
    width: usize,
    map: &'a [S::f64s],
    /// Local derivatives and values of the field; `None` if it is zero.
    g: Option<&'a [S::f64s]>,
    out: &'a mut Vec<S::f64s>,
}

impl<S: Simd, const D: usize> NullaryFnOnce for Show<'_, S, D> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let Self { simd, width, map, g, out } = self;
        let (points, size) = (map.len() / numbers_of_map(D), state_size(D, width));
        out.clear();
        out.resize(points * size, simd.splat_f64s(0.0));
        for (q, (out, map)) in out.chunks_exact_mut(size).zip(map.chunks_exact(numbers_of_map(D))).enumerate() {
            out[..D].copy_from_slice(&map[..D]);
            let Some(g) = g else { continue };
            let (r, (values, gradients)) = (inverse::<S, D>(simd, map), out[D..].split_at_mut(width));
            let g = &g[q * width * (D + 1)..][..width * (D + 1)];
            for (c, g) in g.chunks_exact(D + 1).enumerate() {
                values[c] = g[D];
                gradients[c * D..(c + 1) * D].copy_from_slice(&physical::<S, D>(simd, &r, g));
            }
        }
    }
}
