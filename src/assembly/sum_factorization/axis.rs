//! One direction of a patch: tables at its quadrature points, supports, neighbours.

use crate::basis::{Basis, Order, ShapeTable};
use crate::linalg::{Real, to_f64};
use crate::quadrature::Quadrature;

/// Fewest and most functions per element that kernels are compiled for: degrees 1 to 5.
pub(super) const COMPILED: std::ops::RangeInclusive<usize> = 2..=6;

/// A univariate basis at the points of a rule, element after element.
#[derive(Clone, Debug, Default)]
pub(super) struct AxisTable {
    /// Number of functions.
    pub functions: usize,
    /// Active functions per element, the same on all.
    pub active: usize,
    /// First active function of every element; it never falls.
    pub first: Vec<usize>,
    /// First point of every element, and the number of all points.
    pub start: Vec<usize>,
    /// Local coordinate of every point.
    pub xi: Vec<f64>,
    /// Weight of every point.
    pub weights: Vec<f64>,
    /// Values at `point * active + local function`.
    pub values: Vec<f64>,
    /// Derivatives with respect to the local coordinate, likewise.
    pub slopes: Vec<f64>,
    /// Elements `[from, to)` of every function; (0, 0) where it has none.
    pub support: Vec<(usize, usize)>,
    /// Functions `[from, to)` that share an element with every function.
    pub columns: Vec<(usize, usize)>,
    /// Sum of the lengths of `columns` before every function, and of all.
    pub sums: Vec<usize>,
}

impl AxisTable {
    /// The tables of `basis` at the points of `rule`; `None` unless all elements have the same number of consecutive
    /// functions, which never fall from one element to the next.
    pub fn new<T: Real>(basis: &dyn Basis<1, T>, rule: &dyn Quadrature<1, T>) -> Option<Self> {
        let functions = basis.num_functions();
        let mut axis = Self { functions, start: vec![0], ..Self::default() };
        axis.support = vec![(0, 0); functions];
        axis.columns = vec![(0, 0); functions];
        let (mut ids, mut table) = (Vec::new(), ShapeTable::new());
        for e in 0..basis.num_elements() {
            basis.active(e, &mut ids);
            let first = *ids.first()?;
            if e == 0 {
                axis.active = ids.len();
            }
            let consecutive = ids.iter().enumerate().all(|(a, &i)| i == first + a);
            if !consecutive || ids.len() != axis.active || axis.first.last().is_some_and(|&last| first < last) {
                return None;
            }
            axis.first.push(first);
            for &i in &ids {
                let (support, columns) = (&mut axis.support[i], &mut axis.columns[i]);
                if support.1 == 0 {
                    (support.0, columns.0) = (e, first);
                }
                (support.1, columns.1) = (e + 1, first + ids.len());
            }
            let rule = rule.rule(e);
            basis.tabulate(e, &rule.points, Order::Gradients, &mut table);
            for q in 0..rule.points.len() {
                axis.xi.push(to_f64(rule.points[q][0]));
                axis.weights.push(to_f64(rule.weights[q]));
                axis.values.extend(table.values(q).iter().map(|&v| to_f64(v)));
                axis.slopes.extend(table.grads(q).iter().map(|g| to_f64(g[0])));
            }
            axis.start.push(axis.xi.len());
        }
        // a rule without points has nothing to contract
        if axis.xi.is_empty() {
            return None;
        }
        axis.sums.push(0);
        for (from, to) in &axis.columns {
            axis.sums.push(axis.sums[axis.sums.len() - 1] + to - from);
        }
        Some(axis)
    }

    /// One function, one point, no derivative: the direction that a patch in the plane lacks.
    pub fn none() -> Self {
        Self {
            functions: 1,
            active: 1,
            first: vec![0],
            start: vec![0, 1],
            xi: vec![0.0],
            weights: vec![1.0],
            values: vec![1.0],
            slopes: vec![0.0],
            support: vec![(0, 1)],
            columns: vec![(0, 1)],
            sums: vec![0, 1],
        }
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.first.len()
    }

    /// Number of points of all elements.
    pub fn points(&self) -> usize {
        self.xi.len()
    }

    /// The element of every point.
    pub fn owners(&self) -> Vec<usize> {
        (0..self.elements()).flat_map(|e| std::iter::repeat_n(e, self.start[e + 1] - self.start[e])).collect()
    }
}
