//! Scratch memory of element loops: tables, physical gradients and weights, kept between elements.

use crate::basis::{Order, ShapeTable};
use crate::geometry::{MapTable, combine};
use crate::linalg::{Matrix, Real, Vector, determinant, inverse, measure};
use crate::quadrature::Rule;
use crate::space::Space;

/// Tables of more reference cells than this are not kept.
const KEPT: usize = 8;

/// The tables of elements with the same reference cells and the same rule.
#[derive(Debug)]
struct Kept<const D: usize, T: Real> {
    /// Reference cells of the functions and of the map.
    references: (usize, usize),
    rule: Rule<D, T>,
    shapes: ShapeTable<D, T>,
    nodes: ShapeTable<D, T>,
}

/// Tables of one element at the points of its rule; all elements are those of one space.
#[derive(Debug)]
pub(crate) struct Scratch<const D: usize, const N: usize, T: Real> {
    /// Shape functions in local coordinates.
    pub shapes: ShapeTable<D, T>,
    /// The map.
    pub map: MapTable<D, N, T>,
    /// Ids of the functions.
    pub ids: Vec<usize>,
    /// Physical weights: rule weight times measure of the map.
    pub dx: Vec<T>,
    /// dN_a/dx_j at `grads[(j * points + q) * functions + a]`.
    pub grads: Vec<T>,
    /// Factors of the test function, one row of terms per local function.
    pub factors: Vec<T>,
    /// Planes of sums over points, `planes[(plane * functions + a) * functions + b]`.
    pub planes: Vec<T>,
    kept: Vec<Kept<D, T>>,
    /// Index of the kept table that is swapped with `shapes`.
    current: Option<usize>,
}

impl<const D: usize, const N: usize, T: Real> Default for Scratch<D, N, T> {
    fn default() -> Self {
        Self {
            shapes: ShapeTable::new(),
            map: MapTable::new(),
            ids: Vec::new(),
            dx: Vec::new(),
            grads: Vec::new(),
            factors: Vec::new(),
            planes: Vec::new(),
            kept: Vec::new(),
            current: None,
        }
    }
}

impl<const D: usize, const N: usize, T: Real> Scratch<D, N, T> {
    /// Ids, functions and map; tables of reference cells are made once.
    fn evaluate<S: Space<D, N, T> + ?Sized>(&mut self, space: &S, element: usize, rule: &Rule<D, T>) {
        space.active(element, &mut self.ids);
        let Some((points, kept)) = self.shared(space, element, rule) else {
            self.put_back();
            space.evaluate(element, &rule.points, Order::Gradients, &mut self.shapes, &mut self.map);
            return;
        };
        if self.current != Some(kept) {
            self.put_back();
            std::mem::swap(&mut self.shapes, &mut self.kept[kept].shapes);
            self.current = Some(kept);
        }
        let nodes = &self.kept[kept].nodes;
        let ids = std::mem::take(&mut self.map.ids);
        combine(points, &ids, nodes, rule.points.len(), Order::Gradients, &mut self.map);
        self.map.ids = ids;
    }

    /// Control points of the map and index of the kept tables of `element`, made on first use; writes its control ids to `map.ids`.
    /// `None` without reference cells, or if [`KEPT`] others are kept.
    fn shared<'a, S: Space<D, N, T> + ?Sized>(
        &mut self,
        space: &'a S,
        element: usize,
        rule: &Rule<D, T>,
    ) -> Option<(&'a [Vector<N, T>], usize)> {
        let control = space.map_structure().control()?;
        let references = (space.structure().reference(element)?, control.basis.structure().reference(element)?);
        let known = self.kept.iter().position(|k| k.references == references && k.rule == *rule);
        let kept = match known {
            Some(k) => k,
            None if self.kept.len() < KEPT => {
                let (mut shapes, mut nodes) = (ShapeTable::new(), ShapeTable::new());
                space.tabulate(element, &rule.points, Order::Gradients, &mut shapes);
                control.basis.tabulate(element, &rule.points, Order::Gradients, &mut nodes);
                self.kept.push(Kept { references, rule: rule.clone(), shapes, nodes });
                self.kept.len() - 1
            }
            None => return None,
        };
        control.basis.active(element, &mut self.map.ids);
        Some((control.points, kept))
    }

    /// Swaps the current table back to the kept ones.
    fn put_back(&mut self) {
        if let Some(k) = self.current.take() {
            std::mem::swap(&mut self.shapes, &mut self.kept[k].shapes);
        }
    }

    /// Ids, values, positions and weights.
    pub fn values<S: Space<D, N, T> + ?Sized>(&mut self, space: &S, element: usize, rule: &Rule<D, T>) {
        // the weights need the Jacobian; the functions' derivatives come with it
        self.evaluate(space, element, rule);
        self.dx.clear();
        self.dx.extend(rule.weights.iter().zip(&self.map.jacobian).map(|(&w, j)| w * measure(j)));
    }
}

impl<const N: usize, T: Real> Scratch<N, N, T> {
    /// Ids, values, positions, weights and physical gradients.
    ///
    /// At a point with a singular Jacobian the gradients, and all results from them, are not finite: linear solvers return
    /// [`LinearError::NotFinite`](crate::linalg::LinearError::NotFinite).
    pub fn gradients<S: Space<N, N, T> + ?Sized>(&mut self, space: &S, element: usize, rule: &Rule<N, T>) {
        self.evaluate(space, element, rule);
        let (points, n) = (rule.points.len(), self.ids.len());
        self.dx.clear();
        self.grads.clear();
        self.grads.resize(N * points * n, T::zero());
        for q in 0..points {
            let jacobian = &self.map.jacobian[q];
            self.dx.push(rule.weights[q] * determinant(jacobian).abs());
            let inv = inverse_or_nan(jacobian);
            let local = self.shapes.grads(q);
            for j in 0..N {
                let row = &mut self.grads[(j * points + q) * n..][..n];
                for (g, d) in row.iter_mut().zip(local) {
                    // grad N = J^-T grad_xi N
                    *g = (0..N).fold(T::zero(), |s, k| s + inv[(k, j)] * d[k]);
                }
            }
        }
    }

    /// The gradient of function `a` at point `q`.
    pub fn grad(&self, q: usize, a: usize) -> Vector<N, T> {
        let (points, n) = (self.dx.len(), self.ids.len());
        Vector::from_fn(|j, _| self.grads[(j * points + q) * n + a])
    }
}

/// J^-1, or NaN if J is singular.
pub(crate) fn inverse_or_nan<const N: usize, T: Real>(jacobian: &Matrix<N, N, T>) -> Matrix<N, N, T> {
    inverse(jacobian).unwrap_or_else(|| Matrix::repeat(T::zero() / T::zero()))
}
