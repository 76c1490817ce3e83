//! Coordinates of the unknowns of cells: means of the map's points with weights of the reference cell.

use super::nodes::MapNodes;
use super::points::Kinds;
use super::slots::Batch;
use super::{Pattern, parts, shares};
use crate::basis::{Basis, Cell, Order, ShapeTable};
use crate::linalg::{Real, to_f64};
use crate::parallel;
use crate::quadrature::{Quadrature, Rule, TensorRule, simplex_rule};
use crate::space::Space;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

/// Weights of one pair of reference cells.
struct Weights {
    nodes: usize,
    /// sum_q N_a² M_b for function a and map node b at `[a * (nodes + 1) + b]`, sum_q N_a² at b = nodes.
    of: Vec<f64>,
}

impl Weights {
    /// Weights on the cell of `element`, with two Gauss points per direction.
    fn of_cell<const D: usize, const N: usize, T: Real, S: Space<D, N, T> + ?Sized>(
        space: &S,
        map: &dyn Basis<D, T>,
        element: usize,
    ) -> Self {
        match space.cell(element) {
            Cell::Simplex => Self::new(space, map, element, &simplex_rule::<D, T>(2)),
            Cell::Tensor => Self::new(space, map, element, TensorRule::gauss([2; D]).rule(element)),
        }
    }

    /// Weights at the points of `rule`.
    fn new<const D: usize, T: Real, B: Basis<D, T> + ?Sized>(basis: &B, map: &dyn Basis<D, T>, element: usize, rule: &Rule<D, T>) -> Self {
        let (mut shapes, mut table) = (ShapeTable::new(), ShapeTable::new());
        basis.tabulate(element, &rule.points, Order::Values, &mut shapes);
        map.tabulate(element, &rule.points, Order::Values, &mut table);
        let nodes = table.num_functions();
        let mut of = Vec::with_capacity(shapes.num_functions() * (nodes + 1));
        for a in 0..shapes.num_functions() {
            let squares: Vec<f64> = (0..rule.points.len()).map(|q| to_f64(shapes.values(q)[a]).powi(2)).collect();
            of.extend((0..nodes).map(|b| squares.iter().enumerate().map(|(q, s)| s * to_f64(table.values(q)[b])).sum::<f64>()));
            of.push(squares.iter().sum());
        }
        Self { nodes, of }
    }
}

/// Computes [`dof_coordinates`](super::super::dof_coordinates()) from tables of the reference cells; `None` if there are none.
pub(in crate::assembly) fn means<const D: usize, const N: usize, T: Real, S: Space<D, N, T> + ?Sized>(
    space: &S,
    pattern: &Pattern,
    components: usize,
) -> Option<Vec<[f64; 3]>> {
    let (slots, control) = (pattern.slots()?, space.map_structure().control()?);
    if components == 0 {
        return Some(Vec::new());
    }
    let nodes = MapNodes::new(control);
    let functions = pattern.num_functions();
    let mut places = vec![[0.0; 3]; components * functions];
    let ranges = shares(pattern.ptr(), rayon::current_num_threads());
    let owned = parts(&mut places, &ranges, |i| components * i).into_iter().zip(&ranges);
    let whole = AtomicBool::new(true);
    let own = |(places, range): (&mut [[f64; 3]], &Range<usize>)| -> Option<()> {
        let (mut sums, mut kinds) = (vec![0.0; range.len()], Kinds::<_, Weights>::default());
        let (mut ids, mut points) = (Vec::new(), Vec::new());
        let reaches = |b: &&Batch| (b.least as usize) < range.end && range.start < b.end as usize;
        for batch in slots.batches.iter().filter(reaches) {
            for (&e, own) in batch.cells().iter().zip(slots.ids(batch)) {
                let e = e as usize;
                let key = (batch.reference, control.basis.structure().reference(e)?);
                let k = kinds.place(key, |_| Some(Weights::of_cell(space, control.basis, e)))?;
                let kind = &kinds.of[k];
                points.clear();
                points.extend(nodes.of(e, &mut ids).iter().map(|&i| nodes.point(i)));
                for (&i, weights) in own.iter().zip(kind.of.chunks_exact(kind.nodes + 1)) {
                    let own = (i as usize).wrapping_sub(range.start);
                    let Some(sum) = sums.get_mut(own) else { continue };
                    let place = &mut places[components * own];
                    for (x, w) in points.iter().zip(weights) {
                        for k in 0..N.min(3) {
                            place[k] += w * x[k];
                        }
                    }
                    *sum += weights[kind.nodes];
                }
            }
        }
        for (places, weight) in places.chunks_exact_mut(components).zip(sums) {
            let w = if weight > 0.0 { weight } else { 1.0 };
            places.fill(places[0].map(|x| x / w));
        }
        Some(())
    };
    parallel::for_each(owned, |part| {
        if own(part).is_none() {
            whole.store(false, Ordering::Relaxed);
        }
    });
    whole.into_inner().then_some(places)
}
