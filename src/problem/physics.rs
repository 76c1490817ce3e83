//! Material of a patch, with one interface for scalar and vector unknowns.

use super::data::{Exact, Point, field_slope};
use super::resultant::Resultant;
use crate::assembly::{self, Errors, Form, LowerOrder};
use crate::linalg::{Csr, Matrix, Vector};
use crate::physics::{self, BodyFlux, Flux, Material, MaterialError, NotLinear};
use crate::quadrature::Quadrature;
use crate::space::{Field, Space, Trace};
use std::any::Any;
use std::sync::Arc;

/// A material for one component (Poisson) or N (elasticity).
#[derive(Clone, Debug)]
pub enum Physics<const N: usize> {
    /// One component.
    Scalar(Arc<dyn Material<1, N>>),
    /// One component per coordinate.
    Vector(Arc<dyn Material<N, N>>),
}

/// A material that a problem cannot take.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PhysicsError {
    /// Its law is not linear.
    #[error(transparent)]
    NotLinear(#[from] NotLinear),
    /// It has neither one component nor one per coordinate.
    #[error("a material of {components} components in {dimension} dimensions; problems have 1 or {dimension}")]
    Components {
        /// Its number of components.
        components: usize,
        /// The dimension.
        dimension: usize,
    },
}

/// The solution at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointState<const N: usize> {
    /// The place.
    pub x: Vector<N>,
    /// u; missing components are zero.
    pub u: [f64; 3],
    /// xx yy zz xy yz xz [force/area]; Poisson: k grad u in the first entries.
    pub stress: [f64; 6],
    /// Strains xx yy zz xy yz xz, eps_xy = (du_x/dy + du_y/dx) / 2; of bodies of revolution rr, zz, the hoop strain, rz; Poisson: zero.
    pub strain: [f64; 6],
}

/// A field on the elements of a body that does not come from its unknowns.
pub trait OtherField<const N: usize>: Sync {
    /// Values and gradients, `[component]` and `[component][axis]`, at a local point of an element, whose place is `x`.
    fn at(&self, element: usize, xi: &Vector<N>, x: &Vector<N>, components: usize) -> ([f64; 3], [[f64; 3]; 3]);
}

/// Values written by a function of place: one entry per component.
pub(super) type PlaceFn<'a, const N: usize> = dyn Fn(&Vector<N>, &mut [f64]) + Sync + 'a;
/// Values written by a function of place and outward normal: one entry per component.
pub(super) type SideFn<'a, const N: usize> = dyn Fn(&Vector<N>, &Vector<N>, &mut [f64]) + 'a;

/// Stiffness per volume of every component at a place.
pub(super) type StiffnessFn<'a, const N: usize> = dyn Fn(&Vector<N>) -> [f64; 3] + Send + Sync + 'a;

/// Message of a law that is not linear.
const LINEAR: &str = "Hooke's and Fourier's laws are linear";

/// The form of a linear law with a foundation.
fn form<'a, const C: usize, const N: usize>(
    material: &'a dyn Material<C, N>,
    foundation: Option<&'a StiffnessFn<'a, N>>,
) -> Form<'a, C, N> {
    let form = physics::form(material).expect(LINEAR);
    let Some(foundation) = foundation else { return form };
    form.with_lower_order(move |x| {
        let stiffness = foundation(x);
        LowerOrder::of_values(Matrix::from_fn(|c, e| if c == e { stiffness[c] } else { 0.0 }))
    })
}

/// sigma n of the field numbered by `field` through a side of the body.
fn flux<const C: usize, const S: usize, const N: usize>(
    material: &Arc<dyn Material<C, N>>,
    space: &Arc<dyn Space<N, N>>,
    (trace, field, is_revolved): (&Trace<S, N>, Field, bool),
) -> Box<dyn Flux<S, N>> {
    let flux = BodyFlux::new(Arc::clone(space), trace.clone(), field, Arc::clone(material)).expect(LINEAR);
    Box::new(if is_revolved { flux.revolved() } else { flux })
}

fn filled<const C: usize>(fill: impl FnOnce(&mut [f64])) -> Vector<C> {
    let mut out = Vector::<C>::zeros();
    fill(out.as_mut_slice());
    out
}

impl<const N: usize> Physics<N> {
    /// A linear material of one component, or of one per coordinate.
    ///
    /// # Errors
    /// [`PhysicsError`] for any other.
    pub fn new<const C: usize>(material: impl Material<C, N> + 'static) -> Result<Self, PhysicsError> {
        let material: Arc<dyn Material<C, N>> = Arc::new(material);
        physics::form(&*material)?;
        // C is 1 or N: the same type by another name
        let any = |material: Arc<dyn Material<C, N>>| -> Box<dyn Any> { Box::new(material) };
        if let Some(scalar) = any(material.clone()).downcast_ref::<Arc<dyn Material<1, N>>>() {
            return Ok(Self::Scalar(scalar.clone()));
        }
        let vector = any(material).downcast_ref::<Arc<dyn Material<N, N>>>().cloned();
        vector.map(Self::Vector).ok_or(PhysicsError::Components { components: C, dimension: N })
    }

    /// Number of components of the unknown.
    pub fn components(&self) -> usize {
        match self {
            Self::Scalar(_) => 1,
            Self::Vector(_) => N,
        }
    }

    /// Whether the material has a strain around the axis of bodies of revolution.
    pub(super) fn is_of_revolution(&self) -> bool {
        match self {
            Self::Scalar(m) => physics::is_of_revolution(&**m),
            Self::Vector(m) => physics::is_of_revolution(&**m),
        }
    }

    /// The modulus at `x` that scales penalties [force/area].
    pub fn modulus(&self, x: &Vector<N>) -> f64 {
        match self {
            Self::Scalar(m) => m.modulus(x),
            Self::Vector(m) => m.modulus(x),
        }
    }

    /// Whether its constants are within their limits at `x`.
    ///
    /// # Errors
    /// [`MaterialError`] with the constant that is not.
    pub(super) fn check(&self, x: &Vector<N>) -> Result<(), MaterialError> {
        match self {
            Self::Scalar(m) => m.check(x),
            Self::Vector(m) => m.check(x),
        }
    }

    /// Whether the material is the same everywhere.
    pub fn is_homogeneous(&self) -> bool {
        match self {
            Self::Scalar(m) => m.is_homogeneous(),
            Self::Vector(m) => m.is_homogeneous(),
        }
    }

    /// Whether both are homogeneous, with one tangent.
    pub(super) fn is_uniform_with(&self, other: &Self) -> bool {
        let x = Vector::zeros();
        self.is_homogeneous()
            && other.is_homogeneous()
            && match (self, other) {
                (Self::Scalar(a), Self::Scalar(b)) => a.respond(&x, &Matrix::zeros()).tangent == b.respond(&x, &Matrix::zeros()).tangent,
                (Self::Vector(a), Self::Vector(b)) => a.respond(&x, &Matrix::zeros()).tangent == b.respond(&x, &Matrix::zeros()).tangent,
                _ => false,
            }
    }

    /// sigma n of the field numbered by `field` through a side of the body, of one of revolution if `is_revolved`.
    pub(super) fn flux<const S: usize>(
        &self,
        space: &Arc<dyn Space<N, N>>,
        trace: &Trace<S, N>,
        field: Field,
        is_revolved: bool,
    ) -> Box<dyn Flux<S, N>> {
        match self {
            Self::Scalar(m) => flux(m, space, (trace, field, is_revolved)),
            Self::Vector(m) => flux(m, space, (trace, field, is_revolved)),
        }
    }

    /// The stiffness of a body on a foundation, if it has one.
    pub(super) fn stiffness(&self, space: &dyn Space<N, N>, rules: &dyn Quadrature<N>, foundation: Option<&StiffnessFn<'_, N>>) -> Csr {
        match self {
            Self::Scalar(m) => assembly::stiffness(space, rules, &form(&**m, foundation)),
            Self::Vector(m) => assembly::stiffness(space, rules, &form(&**m, foundation)),
        }
    }

    /// ∫ f . N dx, and the resultant of f.
    pub(super) fn load(&self, space: &dyn Space<N, N>, rules: &dyn Quadrature<N>, f: &PlaceFn<'_, N>) -> (Vec<f64>, Resultant) {
        match self {
            Self::Scalar(_) => {
                let at = |x: &Vector<N>| filled(|out| f(x, out));
                let (load, moments) = assembly::load_with_moments::<1, N, N, f64, _, _>(space, rules, &at);
                (load, Resultant::of(&moments))
            }
            Self::Vector(_) => {
                let at = |x: &Vector<N>| filled(|out| f(x, out));
                let (load, moments) = assembly::load_with_moments::<N, N, N, f64, _, _>(space, rules, &at);
                (load, Resultant::of(&moments))
            }
        }
    }

    /// Adds ∫ f . N ds over a side to the load of its body.
    pub(super) fn side_load<const S: usize>(&self, trace: &Trace<S, N>, rules: &dyn Quadrature<S>, f: &SideFn<'_, N>, load: &mut [f64]) {
        match self {
            Self::Scalar(_) => {
                assembly::trace_load::<1, S, N, f64, _>(trace, rules, &|x: &Vector<N>, n: &Vector<N>| filled(|out| f(x, n, out)), load);
            }
            Self::Vector(_) => {
                assembly::trace_load::<N, S, N, f64, _>(trace, rules, &|x: &Vector<N>, n: &Vector<N>| filled(|out| f(x, n, out)), load);
            }
        }
    }

    /// Adds springs of stiffness `k(x)` [force/area per length] in a component to the matrix of a body.
    pub(super) fn springs<const S: usize>(
        &self,
        trace: &Trace<S, N>,
        rules: &dyn Quadrature<S>,
        component: usize,
        k: &dyn Fn(&Vector<N>) -> f64,
        matrix: &mut Csr,
    ) {
        match self {
            Self::Scalar(_) => {
                assembly::trace_springs::<1, S, N, f64, _>(
                    trace,
                    rules,
                    &|x: &Vector<N>, _: &Vector<N>| Matrix::<1, 1>::from_element(k(x)),
                    matrix,
                );
            }
            Self::Vector(_) => assembly::trace_springs::<N, S, N, f64, _>(
                trace,
                rules,
                &|x: &Vector<N>, _: &Vector<N>| {
                    let mut value = Matrix::<N, N>::zeros();
                    value[(component, component)] = k(x);
                    value
                },
                matrix,
            ),
        }
    }

    /// Norms of the error of `u` against the exact solution at time `t`; a foundation is part of the energy.
    pub(super) fn errors(
        &self,
        space: &dyn Space<N, N>,
        rules: &dyn Quadrature<N>,
        foundation: Option<&StiffnessFn<'_, N>>,
        (u, exact, t): (&[f64], &dyn Exact, f64),
    ) -> Errors {
        match self {
            Self::Scalar(m) => assembly::errors(space, rules, &form(&**m, foundation), u, &|x: &Vector<N>| {
                field_slope::<1, N>(exact, &Point::new(x.as_slice()).at_time(t))
            }),
            Self::Vector(m) => assembly::errors(space, rules, &form(&**m, foundation), u, &|x: &Vector<N>| {
                field_slope::<N, N>(exact, &Point::new(x.as_slice()).at_time(t))
            }),
        }
    }

    /// Norms of the difference of `u` and another field, whose value and gradient are asked for at (element, local point, place);
    /// a foundation is part of the energy.
    pub(super) fn difference(
        &self,
        space: &dyn Space<N, N>,
        rules: &dyn Quadrature<N>,
        foundation: Option<&StiffnessFn<'_, N>>,
        (u, other): (&[f64], &dyn OtherField<N>),
    ) -> Errors {
        match self {
            Self::Scalar(m) => assembly::difference(space, rules, &form(&**m, foundation), u, &|e, xi: &Vector<N>, x: &Vector<N>| {
                let (value, gradient) = other.at(e, xi, x, 1);
                (Vector::<1>::from_fn(|i, _| value[i]), Matrix::<1, N>::from_fn(|i, j| gradient[i][j]))
            }),
            Self::Vector(m) => assembly::difference(space, rules, &form(&**m, foundation), u, &|e, xi: &Vector<N>, x: &Vector<N>| {
                let (value, gradient) = other.at(e, xi, x, N);
                (Vector::<N>::from_fn(|i, _| value[i]), Matrix::<N, N>::from_fn(|i, j| gradient[i][j]))
            }),
        }
    }

    /// Evaluates the solution at local points of an element; `u` holds the unknowns of all bodies.
    pub fn at(&self, space: &dyn Space<N, N>, field: &Field, u: &[f64], element: usize, xi: &[Vector<N>]) -> Vec<PointState<N>> {
        match self {
            Self::Scalar(m) => physics::stress_at::<1, N, f64, _, _>(space, &**m, &u[field.first..], element, xi)
                .into_iter()
                .map(|s| PointState {
                    x: s.x,
                    u: [s.value[0], 0.0, 0.0],
                    stress: std::array::from_fn(|k| if k < N { s.stress[(0, k)] } else { 0.0 }),
                    strain: [0.0; 6],
                })
                .collect(),
            Self::Vector(m) => physics::stress_at::<N, N, f64, _, _>(space, &**m, &u[field.first..], element, xi)
                .into_iter()
                .map(|s| PointState {
                    x: s.x,
                    u: std::array::from_fn(|k| if k < N { s.value[k] } else { 0.0 }),
                    stress: s.spatial,
                    strain: s.strain,
                })
                .collect(),
        }
    }
}
