//! Lagrange polynomials on the intervals of a line, continuous across them.

use super::{BSpline, Basis, BasisStructure, Block, Elements, Order, Polynomials, ShapeTable};
use crate::linalg::{Real, Vector, lit, num};
use crate::quadrature::gauss_lobatto_nodes;

/// The nodes of the Lagrange basis of `degree` on the unit interval: Gauss-Lobatto, which is equispaced up to degree 2.
pub fn lagrange_nodes<T: Real>(degree: usize) -> Vec<T> {
    gauss_lobatto_nodes(degree)
}

/// Lagrange polynomials of one degree p on `elements` intervals; function e p + a is node a of element e.
///
///   l_i(x) = prod_(k != i) (x - x_k) / (x_i - x_k)
#[derive(Clone, Debug, PartialEq)]
pub struct LagrangeLine<T: Real = f64> {
    degree: usize,
    nodes: Vec<T>,
    /// 1 / (x_i - x_k) at i (degree + 1) + k.
    inverse: Vec<T>,
    breakpoints: Vec<T>,
}

impl<T: Real> LagrangeLine<T> {
    /// Creates the basis of degree 1 or more on `elements` intervals.
    ///
    /// # Panics
    /// If the degree or the number of elements is zero.
    pub fn new(degree: usize, elements: usize) -> Self {
        Self::with_breakpoints(degree, (0..=elements).map(num::<T>).collect())
    }

    /// Creates the basis with given parameters of the interval ends; their spacing only affects [`Basis::polynomials`] of
    /// continuity 1 and more.
    ///
    /// # Panics
    /// If the degree is zero, or there are fewer than two breakpoints, or they do not rise.
    pub fn with_breakpoints(degree: usize, breakpoints: Vec<T>) -> Self {
        assert!(degree > 0, "a continuous Lagrange basis has degree 1 or more");
        assert!(breakpoints.len() >= 2, "a line has at least one element");
        assert!(breakpoints.windows(2).all(|w| w[0] < w[1]), "breakpoints rise");
        let nodes = lagrange_nodes::<T>(degree);
        let inverse = nodes
            .iter()
            .enumerate()
            .flat_map(|(i, &x)| nodes.iter().enumerate().map(move |(k, &y)| if i == k { T::zero() } else { T::one() / (x - y) }))
            .collect();
        Self { degree, nodes, inverse, breakpoints }
    }

    /// The nodes on the unit interval.
    pub fn nodes(&self) -> &[T] {
        &self.nodes
    }

    /// The parameters of the intervals' ends.
    pub fn breakpoints(&self) -> &[T] {
        &self.breakpoints
    }
}

impl<T: Real> Elements for LagrangeLine<T> {
    fn num_elements(&self) -> usize {
        self.breakpoints.len() - 1
    }
    fn corners(&self, element: usize, ids: &mut Vec<usize>) {
        ids.clear();
        ids.extend([element, element + 1]);
    }
}

impl<T: Real> Basis<1, T> for LagrangeLine<T> {
    fn num_functions(&self) -> usize {
        self.num_elements() * self.degree + 1
    }
    fn degree(&self, _element: usize) -> [usize; 1] {
        [self.degree]
    }
    fn active(&self, element: usize, ids: &mut Vec<usize>) {
        ids.clear();
        ids.extend(element * self.degree..=(element + 1) * self.degree);
    }
    fn tabulate(&self, _element: usize, xi: &[Vector<1, T>], order: Order, table: &mut ShapeTable<1, T>) {
        let n = self.degree + 1;
        table.resize(xi.len(), n, order);
        let two = lit::<T>(2.0);
        for (q, x) in xi.iter().enumerate() {
            let (values, grads, hessians) = table.point_mut(q);
            for (i, value) in values.iter_mut().enumerate() {
                // product rule on prod_k (x - x_k) / (x_i - x_k), one factor after the other
                let (mut v, mut d, mut h) = (T::one(), T::zero(), T::zero());
                let factors = self.nodes.iter().zip(&self.inverse[i * n..(i + 1) * n]).enumerate();
                for (_, (&node, &slope)) in factors.filter(|(k, _)| *k != i) {
                    let factor = (x[0] - node) * slope;
                    h = h * factor + two * d * slope;
                    d = d * factor + v * slope;
                    v *= factor;
                }
                *value = v;
                if let Some(grad) = grads.get_mut(i) {
                    grad[0] = d;
                }
                if let Some(hessian) = hessians.get_mut(i) {
                    hessian[0] = h;
                }
            }
        }
    }
    fn structure(&self) -> &dyn BasisStructure<1, T> {
        self
    }
    /// The spline space of regularity 0 answers, in Bernstein form.
    fn polynomials(&self, wanted: Polynomials) -> Option<Box<dyn Basis<1, T>>> {
        BSpline::from_breakpoints(self.degree, &self.breakpoints, &vec![0; self.num_elements() - 1]).polynomials(wanted)
    }
}

impl<T: Real> BasisStructure<1, T> for LagrangeLine<T> {
    /// One: the nodes of all elements lie alike.
    fn reference(&self, _element: usize) -> Option<usize> {
        Some(0)
    }
    fn block(&self, _element: usize) -> Option<Block<'_, 1, T>> {
        Some(Block { first: 0, axes: [self], weights: None })
    }
}
