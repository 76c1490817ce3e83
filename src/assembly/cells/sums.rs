//! Loads and norms on cells in lanes: what is asked at the points of a batch of cells, summed over them.
//!
//! Cells are added by groups with common tables, then by their numbers: same bits for any number of threads and of lanes.

use super::batch::Nodes;
use super::nodes::MapNodes;
use super::points::{self, Group, Kinds, PointTables};
use crate::assembly::Form;
use crate::assembly::source::Source;
use crate::assembly::tensor::{Answer, Cell, Law, SQUARES, Sites, Squares, add_moments, finish, numbers_of_map};
use crate::linalg::{Real, lit, to_f64};
use crate::quadrature::Quadrature;
use crate::space::Space;
use pulp::{NullaryFnOnce, Simd, WithSimd, bytemuck};
use rayon::prelude::*;

/// Elements of one task, and tasks whose results wait at a time.
const ELEMENTS_PER_TASK: usize = 256;
const TASKS_AT_ONCE: usize = 16;

/// A space of cells that share reference cells, with its rule, for sums over its points.
#[derive(Debug)]
pub(in crate::assembly) struct Sums<'a, const D: usize, const N: usize, T: Real, S: ?Sized> {
    /// Elements ascend in each.
    groups: Vec<Group<PointTables<D>, u32>>,
    nodes: MapNodes<'a, D, N, T>,
    space: &'a S,
    /// The instruction set.
    pub(super) arch: pulp::Arch,
}

/// What is summed.
#[derive(Clone, Copy)]
enum Kind<'a> {
    /// Forces times functions, then the moments of the forces.
    Load,
    /// Squares of a field against the answers; `field` gives its coefficients as [`Nodes`] gives nodes.
    Squares { law: &'a Law<'a>, field: &'a Nodes<'a> },
}

/// Numbers of the elements of a task, and the ids of their functions where they are asked for.
#[derive(Default)]
struct Task {
    numbers: Vec<f64>,
    ids: Vec<u32>,
    /// Of one element.
    own: Vec<usize>,
}

impl<'a, const D: usize, const N: usize, T: Real, S: Space<D, N, T> + ?Sized> Sums<'a, D, N, T, S> {
    /// The cells of `space`; `None` where the plain loop has to do it.
    pub fn new<Q: Quadrature<D, T> + ?Sized>(space: &'a S, quadrature: &Q) -> Option<Self> {
        if !super::has_lanes::<D, N, T>() {
            return None;
        }
        let control = space.control()?;
        let mut groups = Kinds::default();
        for e in 0..space.num_elements() {
            let rule = quadrature.rule(e);
            let key = points::key(space.reference(e)?, control.basis, e, rule)?;
            groups.put(key, u32::try_from(e).ok()?, || PointTables::new(space, control.basis, e, rule))?;
        }
        Some(Self { groups: groups.of, nodes: MapNodes::new(control), space, arch: pulp::Arch::new() })
    }

    /// ∫ f . N dx for forces of `width` components, which `answer` gives, then their moments as
    /// [`Patches::load`](crate::assembly::tensor::Patches::load) has them.
    pub fn load(&self, width: usize, answer: &Answer<'_>) -> (Vec<T>, Vec<f64>) {
        let mut out = vec![T::zero(); width * self.space.num_functions()];
        let mut moments = vec![0.0; width * (D + 1)];
        self.each(Kind::Load, width, answer, true, |tables, task| {
            let loads = width * tables.functions;
            for (numbers, ids) in task.numbers.chunks_exact(loads + moments.len()).zip(task.ids.chunks_exact(tables.functions)) {
                let (loads, own) = numbers.split_at(loads);
                for (&i, loads) in ids.iter().zip(loads.chunks_exact(width)) {
                    out[width * i as usize..].iter_mut().zip(loads).for_each(|(out, &load)| *out += lit(load));
                }
                moments.iter_mut().zip(own).for_each(|(sum, m)| *sum += m);
            }
        });
        (out, moments)
    }

    /// Sums over the cells, task by task.
    fn each(&self, kind: Kind<'_>, width: usize, answer: &Answer<'_>, ids: bool, mut sink: impl FnMut(&PointTables<D>, &Task)) {
        let mut tasks: Vec<Task> = (0..TASKS_AT_ONCE).map(|_| Task::default()).collect();
        for Group { tables, members } in &self.groups {
            for block in members.chunks(ELEMENTS_PER_TASK * TASKS_AT_ONCE) {
                tasks.par_iter_mut().zip(block.par_chunks(ELEMENTS_PER_TASK)).for_each(|(task, elements)| {
                    task.numbers.clear();
                    task.ids.clear();
                    for &e in if ids { elements } else { &[] } {
                        self.space.active(e as usize, &mut task.own);
                        task.ids.extend(task.own.iter().map(|&i| i as u32));
                    }
                    let Task { numbers, own: ids, .. } = task;
                    let nodes = |elements: &[u32], ids: &mut Vec<usize>, out: &mut [f64]| self.nodes.gather(elements, ids, out);
                    self.arch.dispatch(Run::<D> { tables, nodes: &nodes, kind, width, answer, elements, ids, numbers });
                });
                tasks[..block.len().div_ceil(ELEMENTS_PER_TASK)].iter().for_each(|task| sink(tables, task));
            }
        }
    }
}

impl<const N: usize, T: Real, S: Space<N, N, T> + ?Sized> Sums<'_, N, N, T, S> {
    /// The sums of squares of the field `u` (an empty one is zero) against the one that `answer` gives, as
    /// [`Patches::deviation`](crate::assembly::tensor::Patches::deviation) has them.
    pub fn deviation<const C: usize>(&self, form: &Form<'_, C, N, T>, u: &[T], answer: &Answer<'_>) -> [f64; SQUARES] {
        let field = |elements: &[u32], ids: &mut Vec<usize>, out: &mut [f64]| {
            let lanes = elements.len();
            for (lane, &e) in elements.iter().enumerate().filter(|_| !u.is_empty()) {
                self.space.active(e as usize, ids);
                for (out, &i) in out.chunks_exact_mut(C * lanes).zip(ids.iter()) {
                    for (c, &x) in u[C * i..C * (i + 1)].iter().enumerate() {
                        out[c * lanes + lane] = to_f64(x);
                    }
                }
            }
        };
        let mut total = [0.0; SQUARES];
        let source = Source::new(form);
        let Some(law) = Law::new::<N>(&source, C) else { return total };
        self.each(Kind::Squares { law: &law, field: &field }, C, answer, false, |_, task| {
            for sums in task.numbers.chunks_exact(SQUARES) {
                total.iter_mut().zip(sums).for_each(|(total, sum)| *total += sum);
            }
        });
        total
    }
}

/// The elements of a task, batch after batch; the numbers of each to `numbers`.
struct Run<'a, const D: usize> {
    tables: &'a PointTables<D>,
    nodes: &'a Nodes<'a>,
    kind: Kind<'a>,
    width: usize,
    answer: &'a Answer<'a>,
    elements: &'a [u32],
    ids: &'a mut Vec<usize>,
    numbers: &'a mut Vec<f64>,
}

impl<const D: usize> WithSimd for Run<'_, D> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        if S::IS_SCALAR {
            return;
        }
        let Self { tables, nodes, kind, width, answer, elements, ids, numbers } = self;
        let (zero, lanes) = (simd.splat_f64s(0.0), S::F64_LANES);
        let mut places = vec![[zero; D]; tables.nodes];
        let mut map = vec![zero; tables.weights.len() * numbers_of_map(D)];
        let (mut sites, mut answers, mut out) = (Sites::default(), Vec::new(), Vec::<S::f64s>::new());
        let (mut field, mut g) = (vec![zero; tables.functions * width], vec![zero; tables.weights.len() * width * (D + 1)]);
        let mut squares = if let Kind::Squares { law, .. } = kind { Some(Squares::new(law, width)) } else { None };
        let (mut which, mut here) = (Vec::with_capacity(lanes), Vec::with_capacity(lanes));
        sites.xi = tables.xi.repeat(lanes);
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
            if let Kind::Squares { field: read, .. } = kind {
                read(&here, ids, bytemuck::cast_slice_mut(&mut field));
            }
            simd.vectorize(Place { simd, tables, nodes: &places, out: &mut map });
            let cell = Cell { points: tables.weights.len(), map: &map, kept: &[], weight: None };
            let size = if squares.is_some() { width * (D + 1) } else { width };
            sites.ask::<S, D>(simd, cell, &which, answer, size, &mut answers);
            match &mut squares {
                None => simd.vectorize(Load { simd, tables, width, map: &map, forces: &mut answers, out: &mut out }),
                Some(squares) => {
                    let (field, g, other, out) = (&field, &mut g, &answers, &mut out);
                    simd.vectorize(Compare::<'_, '_, S, D> { simd, tables, width, cell, field, g, squares, other, out });
                }
            }
            let sums: &[f64] = bytemuck::cast_slice(&out);
            for lane in 0..batch.len() {
                numbers.extend(sums[lane..].iter().step_by(lanes));
            }
        }
    }
}

/// The map at the points of a batch, as on a grid of points.
struct Place<'a, S: Simd, const D: usize> {
    simd: S,
    tables: &'a PointTables<D>,
    nodes: &'a [[S::f64s; D]],
    out: &'a mut [S::f64s],
}

impl<S: Simd, const D: usize> NullaryFnOnce for Place<'_, S, D> {
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

/// The field at the points, and its squares.
struct Compare<'a, 'l, S: Simd, const D: usize> {
    simd: S,
    tables: &'a PointTables<D>,
    width: usize,
    cell: Cell<'a, S::f64s>,
    /// `[function * width + component]`.
    field: &'a [S::f64s],
    g: &'a mut [S::f64s],
    squares: &'a mut Squares<'l, S::f64s>,
    other: &'a [S::f64s],
    out: &'a mut Vec<S::f64s>,
}

impl<S: Simd, const D: usize> NullaryFnOnce for Compare<'_, '_, S, D> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let Self { simd, tables, width, cell, field, g, squares, other, out } = self;
        let zero = simd.splat_f64s(0.0);
        let points = tables.values.chunks_exact(tables.functions).zip(tables.grads.chunks_exact(tables.functions));
        for (g, (values, grads)) in g.chunks_exact_mut(width * (D + 1)).zip(points) {
            for (c, g) in g.chunks_exact_mut(D + 1).enumerate() {
                let (mut value, mut slope) = (zero, [zero; D]);
                for ((&u, &v), grad) in field[c..].iter().step_by(width).zip(values).zip(grads) {
                    value = simd.mul_add_e_f64s(u, simd.splat_f64s(v), value);
                    for k in 0..D {
                        slope[k] = simd.mul_add_e_f64s(u, simd.splat_f64s(grad[k]), slope[k]);
                    }
                }
                g[..D].copy_from_slice(&slope);
                g[D] = value;
            }
        }
        out.clear();
        out.extend_from_slice(&squares.of::<S, D>(simd, cell, g, other));
    }
}
