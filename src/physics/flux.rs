//! The flux sigma n of a body on one of its sides, for Nitsche's method and for tractions.

use super::{Flux, FluxTable, Material, NotLinear, hoop_strain};
use crate::assembly::{Scratch, element_matrix, element_rule, inverse_or_nan};
use crate::basis::{Order, ShapeTable};
use crate::geometry::{MapTable, circumference};
use crate::linalg::{Matrix, Real, Vector, lit, measure, to_f64};
use crate::space::{Field, Space, Trace};
use nalgebra::{DMatrix, SymmetricEigen};
use std::sync::Arc;

/// sigma n of a body with C components on a trace, whose points are lifted through the facets into the body.
#[derive(Clone, Debug)]
pub struct BodyFlux<const C: usize, const S: usize, const N: usize, T: Real = f64> {
    space: Arc<dyn Space<N, N, T>>,
    trace: Trace<S, N, T>,
    field: Field,
    material: Arc<dyn Material<C, N, T>>,
    /// Whether integrals are those over bodies of revolution.
    is_revolved: bool,
}

impl<const C: usize, const S: usize, const N: usize, T: Real> BodyFlux<C, S, N, T> {
    /// The flux of the field numbered by `field` on `space` through `trace`.
    ///
    /// # Errors
    /// [`NotLinear`] for a material that is not linear: its flux is no linear map of the unknowns.
    pub fn new(
        space: Arc<dyn Space<N, N, T>>,
        trace: Trace<S, N, T>,
        field: Field,
        material: Arc<dyn Material<C, N, T>>,
    ) -> Result<Self, NotLinear> {
        super::linear(&*material)?;
        Ok(Self { space, trace, field, material, is_revolved: false })
    }

    /// The flux of a body of revolution, whose integrals have the factor 2 pi r.
    #[must_use]
    pub fn revolved(self) -> Self {
        Self { is_revolved: true, ..self }
    }

    /// 2 pi r at a place of a body of revolution, 1 of any other.
    fn around(&self, x: &Vector<N, T>) -> T {
        if self.is_revolved { circumference(x) } else { T::one() }
    }

    /// Calls `visit(q, x, normal, measure, values, grads)` for every lifted point, with those of the functions of the body's element.
    fn each_point(
        &self,
        element: usize,
        xi: &[Vector<S, T>],
        mut visit: impl FnMut(usize, &Vector<N, T>, &Vector<N, T>, T, &[T], &[Vector<N, T>]),
    ) {
        let facet = &self.trace.facets[element];
        let lifted: Vec<Vector<N, T>> = xi.iter().map(|xi| facet.lift(xi)).collect();
        let (mut shapes, mut map) = (ShapeTable::new(), MapTable::new());
        self.space.evaluate(facet.element, &lifted, Order::Gradients, &mut shapes, &mut map);
        let mut grads = Vec::new();
        for q in 0..xi.len() {
            let jacobian = &map.jacobian[q];
            let to_physical = inverse_or_nan(jacobian).transpose();
            grads.clear();
            grads.extend(shapes.grads(q).iter().map(|g| to_physical * g));
            // tangents of the side are those of the body along the facet
            let tangents = jacobian * facet.axes;
            let normal = self.trace.normal(element, &tangents);
            let stretch = measure(&tangents) * self.around(&map.x[q]);
            visit(q, &map.x[q], &normal, stretch, shapes.values(q), &grads);
        }
    }
}

/// Shift of the element matrix before its factorisation, relative to its trace: rigid motions have no energy and no flux.
const RIGID_SHIFT: f64 = 1e-10;

impl<const C: usize, const S: usize, const N: usize, T: Real> Flux<S, N, T> for BodyFlux<C, S, N, T> {
    fn tabulate(&self, element: usize, xi: &[Vector<S, T>], table: &mut FluxTable<T>) {
        let mut ids = Vec::new();
        self.space.active(self.trace.facets[element].element, &mut ids);
        let n = ids.len() * C;
        table.components = C;
        table.dofs.clear();
        table.dofs.extend(ids.iter().flat_map(|&i| (0..C).map(move |c| (i, c))).map(|(i, c)| self.field.unknown(i, c)));
        table.values.clear();
        table.values.resize(xi.len() * C * n, T::zero());
        self.each_point(element, xi, |q, x, normal, _, values, grads| {
            let tangent = self.material.respond(x, &Matrix::zeros()).tangent;
            let around = self.material.hoop(x).map(|hoop| hoop.coupling * normal);
            for (a, grad) in grads.iter().enumerate() {
                for e in 0..C {
                    let mut flux = Vector::<C, T>::zeros();
                    for j in 0..N {
                        flux += tangent[e][j] * normal * grad[j];
                    }
                    if let (0, Some(around)) = (e, &around) {
                        flux += around * hoop_strain(x, &Vector::<1, T>::new(values[a]), &grad.transpose(), T::zero());
                    }
                    for c in 0..C {
                        table.values[(q * C + c) * n + a * C + e] = flux[c];
                    }
                }
            }
        });
    }

    /// The largest eigenvalue of ∫ sigma n . sigma n ds over the facet against the energy of the element.
    fn stabilisation(&self, element: usize) -> T {
        let outside = element_rule(&*self.trace.space, element, 1);
        let rule = outside.rule(0);
        let mut ds = Vec::with_capacity(rule.points.len());
        self.each_point(element, &rule.points, |q, _, _, stretch, _, _| ds.push(rule.weights[q] * stretch));
        self.stabilisation_of_sum(element, &rule.points, &ds)
    }

    /// The largest eigenvalue of the sum of ds sigma n . sigma n against the energy of the element.
    fn stabilisation_of_sum(&self, element: usize, xi: &[Vector<S, T>], ds: &[T]) -> T {
        let parent = self.trace.facets[element].element;
        let mut table = FluxTable::default();
        self.tabulate(element, xi, &mut table);
        let (n, rows) = (table.dofs.len(), xi.len() * C);
        // the facet's matrix is G Gᵀ, and its rank that of the few columns of G
        let g = DMatrix::from_fn(n, rows, |a, r| ds[r / C].sqrt() * table.values[r * n + a]);
        let none = T::zero() / T::zero();
        let Ok(form) = super::form(&*self.material) else { return none };
        let mut scratch = Scratch::default();
        scratch.gradients(&*self.space, parent, element_rule(&*self.space, parent, 0).rule(0));
        for (dx, x) in scratch.dx.iter_mut().zip(&scratch.map.x) {
            *dx *= self.around(x);
        }
        let mut energy = vec![T::zero(); n * n];
        element_matrix(&mut scratch, &form, &mut energy);
        let mut energy = DMatrix::from_row_slice(n, n, &energy);
        let shift = energy.trace() * T::default_epsilon().max(lit(RIGID_SHIFT));
        for a in 0..n {
            energy[(a, a)] += shift;
        }
        let Some(root) = energy.cholesky() else { return none };
        // eigenvalues of L^-1 G Gᵀ L^-T, other than zero, are those of (L^-1 G)ᵀ (L^-1 G)
        let Some(half) = root.l().solve_lower_triangular(&g) else { return none };
        if half.iter().any(|v| !to_f64(*v).is_finite()) {
            return none;
        }
        let product = if rows < n { half.transpose() * &half } else { &half * half.transpose() };
        SymmetricEigen::new(product).eigenvalues.iter().fold(T::zero(), |m, &v| m.max(v))
    }
}
