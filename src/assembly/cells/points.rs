//! Tables at the points of a rule for all elements that share reference cells, and which elements these are.

use crate::basis::{Basis, Order, ShapeTable};
use crate::geometry::Control;
use crate::linalg::{Real, to_f64};
use crate::quadrature::{Quadrature, Rule};
use crate::space::Space;

/// Groups of elements at most: more have nothing in common.
const GROUPS: usize = 32;

/// Functions, map and rule on a reference cell, `[point * functions + a]` and `[point * nodes + b]`.
#[derive(Debug)]
pub(super) struct PointTables<const D: usize> {
    pub functions: usize,
    pub nodes: usize,
    /// Local points, D numbers each.
    pub xi: Vec<f64>,
    pub weights: Vec<f64>,
    pub values: Vec<f64>,
    pub grads: Vec<[f64; D]>,
    pub map_values: Vec<f64>,
    pub map_grads: Vec<[f64; D]>,
}

impl<const D: usize> PointTables<D> {
    fn new<T: Real, B: Basis<D, T> + ?Sized>(basis: &B, map: &dyn Basis<D, T>, element: usize, rule: &Rule<D, T>) -> Self {
        let (mut shapes, mut nodes) = (ShapeTable::new(), ShapeTable::new());
        basis.tabulate(element, &rule.points, Order::Gradients, &mut shapes);
        map.tabulate(element, &rule.points, Order::Gradients, &mut nodes);
        let points = rule.points.len();
        let values = |table: &ShapeTable<D, T>| (0..points).flat_map(|q| table.values(q).to_vec()).map(to_f64).collect();
        let grads = |table: &ShapeTable<D, T>| {
            (0..points).flat_map(|q| table.grads(q).to_vec()).map(|g| std::array::from_fn(|k| to_f64(g[k]))).collect()
        };
        Self {
            functions: shapes.num_functions(),
            nodes: nodes.num_functions(),
            xi: rule.points.iter().flat_map(|xi| xi.iter().map(|&x| to_f64(x))).collect(),
            weights: rule.weights.iter().map(|&w| to_f64(w)).collect(),
            values: values(&shapes),
            grads: grads(&shapes),
            map_values: values(&nodes),
            map_grads: grads(&nodes),
        }
    }
}

/// Elements with common tables, ascending.
#[derive(Debug)]
pub(super) struct PointGroup<const D: usize> {
    pub tables: PointTables<D>,
    pub elements: Vec<u32>,
}

/// The elements of `space` by their reference cells and rules; `None` where some have none, or too many differ.
pub(super) fn groups<const D: usize, const N: usize, T, S, Q>(
    space: &S,
    control: Control<'_, D, N, T>,
    quadrature: &Q,
) -> Option<Vec<PointGroup<D>>>
where
    T: Real,
    S: Space<D, N, T> + ?Sized,
    Q: Quadrature<D, T> + ?Sized,
{
    let mut keys = Vec::new();
    let mut groups: Vec<PointGroup<D>> = Vec::new();
    let mut last = 0;
    for e in 0..space.num_elements() {
        let rule = quadrature.rule(e);
        let key = (space.reference(e)?, control.basis.reference(e)?, std::ptr::from_ref(rule));
        if keys.get(last) != Some(&key) {
            last = keys.iter().position(|k| *k == key).unwrap_or(keys.len());
        }
        if last == keys.len() {
            let tables = PointTables::new(space, control.basis, e, rule);
            if last == GROUPS || tables.functions == 0 || tables.nodes == 0 {
                return None;
            }
            keys.push(key);
            groups.push(PointGroup { tables, elements: Vec::new() });
        }
        groups[last].elements.push(u32::try_from(e).ok()?);
    }
    Some(groups)
}
