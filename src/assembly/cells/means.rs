//! Where the unknowns of cells live: means of the map's points with weights of the reference cell.

use super::Pattern;
use crate::basis::{Basis, Cell, Order, ShapeTable};
use crate::linalg::{Real, to_f64};
use crate::quadrature::{Quadrature, Rule, TensorRule, simplex_rule};
use crate::space::Space;

/// Weights of one pair of reference cells.
struct Weights {
    key: (usize, usize),
    nodes: usize,
    /// Of the map's node b for function a at `[a * (nodes + 1) + b]`, then their sum.
    of: Vec<f64>,
}

impl Weights {
    /// sum_q N_a² M_b, and sum_q N_a².
    fn new<const D: usize, T: Real, B: Basis<D, T> + ?Sized>(
        key: (usize, usize),
        basis: &B,
        map: &dyn Basis<D, T>,
        element: usize,
        rule: &Rule<D, T>,
    ) -> Self {
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
        Self { key, nodes, of }
    }
}

/// What [`places`](super::super::places()) says, from tables of the reference cells; `None` where there are none.
pub(in crate::assembly) fn means<const D: usize, const N: usize, T: Real, S: Space<D, N, T> + ?Sized>(
    space: &S,
    pattern: &Pattern,
    components: usize,
) -> Option<Vec<[f64; 3]>> {
    let (order, control) = (&pattern.slots()?.order, space.control()?);
    let (tensor, simplex) = (TensorRule::gauss([2; D]), simplex_rule::<D, T>(2));
    let mut kinds: Vec<Weights> = Vec::new();
    let mut sums = vec![[0.0; 4]; pattern.num_functions()];
    let (mut ids, mut nodes) = (Vec::new(), Vec::new());
    for &e in order {
        let e = e as usize;
        let key = (space.reference(e)?, control.basis.reference(e)?);
        let k = kinds.iter().position(|k| k.key == key).unwrap_or_else(|| {
            let rule = if space.cell(e) == Cell::Simplex { &simplex } else { tensor.rule(e) };
            kinds.push(Weights::new(key, space, control.basis, e, rule));
            kinds.len() - 1
        });
        control.basis.active(e, &mut ids);
        nodes.clear();
        nodes.extend(ids.iter().map(|&i| -> [f64; 3] { std::array::from_fn(|k| if k < N { to_f64(control.points[i][k]) } else { 0.0 }) }));
        for (&i, weights) in pattern.ids(e).iter().zip(kinds[k].of.chunks_exact(kinds[k].nodes + 1)) {
            let sum = &mut sums[i as usize];
            for (x, w) in nodes.iter().zip(weights) {
                for k in 0..N.min(3) {
                    sum[k] += w * x[k];
                }
            }
            sum[3] += weights[kinds[k].nodes];
        }
    }
    let mut places = Vec::with_capacity(components * sums.len());
    for [x, y, z, weight] in sums {
        let w = if weight > 0.0 { weight } else { 1.0 };
        places.extend(std::iter::repeat_n([x / w, y / w, z / w], components));
    }
    Some(places)
}
