//! Tables on the reference cell of a group of elements: functions, map, weights.

use crate::basis::{Basis, Order, ShapeTable};
use crate::linalg::{Real, to_f64};
use crate::quadrature::Rule;

/// Columns of an element matrix that are summed at once.
pub(super) const TILE: usize = 4;

/// K numbers per function and point, for sums of products: sum_q sum_kl B_ak(q) D_kl(q) B_bl(q).
#[derive(Debug)]
pub(super) struct Products<const K: usize> {
    /// B_ak(q) at `test[a * points + q]`.
    pub test: Vec<[f64; K]>,
    /// The same of TILE functions at once at `trial[tile * points + q]`, zero beyond the last.
    pub trial: Vec<[[f64; TILE]; K]>,
    pub points: usize,
    pub functions: usize,
}

impl<const K: usize> Products<K> {
    fn new(functions: usize, points: usize, number: impl Fn(usize, usize, usize) -> f64) -> Self {
        let at = |a: usize, q: usize| std::array::from_fn(|k| number(a, q, k));
        let test = (0..functions).flat_map(|a| (0..points).map(move |q| at(a, q))).collect();
        let trial = (0..functions.div_ceil(TILE))
            .flat_map(|tile| (0..points).map(move |q| (tile, q)))
            .map(|(tile, q)| {
                std::array::from_fn(|k| {
                    std::array::from_fn(|t| {
                        let b = tile * TILE + t;
                        if b < functions { number(b, q, k) } else { 0.0 }
                    })
                })
            })
            .collect();
        Self { test, trial, points, functions }
    }

    /// Columns of an element matrix with those beyond the last.
    pub fn padded(&self) -> usize {
        self.functions.next_multiple_of(TILE)
    }
}

/// The tables of a group.
#[derive(Debug)]
pub(super) struct Tables<const N: usize> {
    /// Functions per element.
    pub functions: usize,
    /// Functions of the map per element.
    pub nodes: usize,
    pub weights: Vec<f64>,
    /// Values of the functions.
    pub values: Products<1>,
    /// Their gradients.
    pub grads: Products<N>,
    /// Values of the map's functions at `map_values[q * nodes + b]`.
    pub map_values: Vec<f64>,
    /// Their gradients.
    pub map_grads: Vec<[f64; N]>,
    /// sum_q w B_ak B_bl at `sums[a * functions + b][k][l]`: enough where D is constant.
    pub sums: Vec<[[f64; N]; N]>,
}

impl<const N: usize> Tables<N> {
    /// The tables of `element` for all that have its reference cells and its rule.
    pub fn new<T: Real, B: Basis<N, T> + ?Sized>(basis: &B, map: &dyn Basis<N, T>, element: usize, rule: &Rule<N, T>) -> Self {
        let (mut shapes, mut nodes) = (ShapeTable::new(), ShapeTable::new());
        basis.tabulate(element, &rule.points, Order::Gradients, &mut shapes);
        map.tabulate(element, &rule.points, Order::Gradients, &mut nodes);
        let (points, n, m) = (rule.points.len(), shapes.num_functions(), nodes.num_functions());
        let weights: Vec<f64> = rule.weights.iter().map(|&w| to_f64(w)).collect();
        let grad = |a: usize, q: usize, k: usize| to_f64(shapes.grads(q)[a][k]);
        let sum = |a: usize, b: usize, k: usize, l: usize| {
            weights.iter().enumerate().fold(0.0, |s, (q, &w)| s + w * grad(a, q, k) * grad(b, q, l))
        };
        let sums = (0..n * n).map(|ab| std::array::from_fn(|k| std::array::from_fn(|l| sum(ab / n, ab % n, k, l)))).collect();
        Self {
            functions: n,
            nodes: m,
            values: Products::new(n, points, |a, q, _| to_f64(shapes.values(q)[a])),
            grads: Products::new(n, points, grad),
            map_values: (0..points).flat_map(|q| nodes.values(q).iter().map(|&v| to_f64(v))).collect(),
            map_grads: (0..points).flat_map(|q| nodes.grads(q).iter().map(|g| std::array::from_fn(|k| to_f64(g[k])))).collect(),
            weights,
            sums,
        }
    }
}
