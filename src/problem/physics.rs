//! Material of a patch, with one interface for scalar and vector unknowns.

use super::data::{Exact, Point, field_derivatives, field_slope};
use super::loads::Resultant;
use crate::assembly::{self, Errors, Form};
use crate::linalg::{Csr, Matrix, Vector};
use crate::physics::{self, BodyFlux, Conductor, Flux, Hooke, Material};
use crate::quadrature::Quadrature;
use crate::space::{Field, Space, Trace};
use std::sync::Arc;

/// A material for one component (Poisson) or N (elasticity).
#[derive(Clone, Debug)]
pub enum Physics<const N: usize> {
    /// One component.
    Scalar(Arc<Conductor<N>>),
    /// One component per coordinate.
    Vector(Arc<Hooke<N>>),
}

/// The solution at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointState<const N: usize> {
<<<<<<< HEAD:crates/faying-cli/src/build/physics.rs
    /// Position \[length\].
=======
    /// The place.
>>>>>>> 3fda307cc570f233f5f494b56a4a0cc778b24513:src/problem/physics.rs
    pub x: Vector<N>,
    /// u; missing components are zero.
    pub u: [f64; 3],
    /// xx yy zz xy yz xz [force/area]; Poisson: k grad u in the first entries.
    pub stress: [f64; 6],
}

<<<<<<< HEAD:crates/faying-cli/src/build/physics.rs
/// Function of position that writes one value per component.
pub type PlaceFn<'a, const N: usize> = dyn Fn(&Vector<N>, &mut [f64]) + Sync + 'a;
/// Function of position and outward normal that writes one value per component.
pub type SideFn<'a, const N: usize> = dyn Fn(&Vector<N>, &Vector<N>, &mut [f64]) + 'a;

/// Value and gradient of a formula at a point and a time.
fn jet<const N: usize>(formula: &Formula, x: &Vector<N>, t: f64) -> Jet<N> {
    let jet = formula.slope(&Point::new(x.as_slice()).at_time(t));
    Jet::new(jet.value, Vector::from_fn(|k, _| jet.gradient[k]))
}

/// Panic message: the laws of cases are linear.
const LINEAR: &str = "Hooke's and Fourier's laws are linear";

/// Bilinear form of a material law of a case.
=======
/// A field on the elements of a body that does not come from its unknowns.
pub trait OtherField<const N: usize>: Sync {
    /// Values and gradients, `[component]` and `[component][axis]`, at a local point of an element, whose place is `x`.
    fn at(&self, element: usize, xi: &Vector<N>, x: &Vector<N>, components: usize) -> ([f64; 3], [[f64; 3]; 3]);
}

/// Values written by a function of place: one entry per component.
pub(super) type PlaceFn<'a, const N: usize> = dyn Fn(&Vector<N>, &mut [f64]) + Sync + 'a;
/// Values written by a function of place and outward normal: one entry per component.
pub(super) type SideFn<'a, const N: usize> = dyn Fn(&Vector<N>, &Vector<N>, &mut [f64]) + 'a;

/// Message of a law that is not linear.
const LINEAR: &str = "Hooke's and Fourier's laws are linear";

/// The form of a linear law.
>>>>>>> 3fda307cc570f233f5f494b56a4a0cc778b24513:src/problem/physics.rs
fn form<const C: usize, const N: usize>(material: &dyn Material<C, N>) -> Form<'_, C, N> {
    physics::form(material).expect(LINEAR)
}

fn filled<const C: usize>(fill: impl FnOnce(&mut [f64])) -> Vector<C> {
    let mut out = Vector::<C>::zeros();
    fill(out.as_mut_slice());
    out
}

<<<<<<< HEAD:crates/faying-cli/src/build/physics.rs
/// Kinematic assumption of the case in N dimensions; in space there is one only.
pub(super) fn assumption<const N: usize>(word: case::Assumption) -> Assumption {
    match (N, word) {
        (3, _) => Assumption::Solid,
        (_, case::Assumption::PlaneStress) => Assumption::PlaneStress,
        _ => Assumption::PlaneStrain,
    }
}

impl<const N: usize> Physics<N> {
    /// Creates the material of the case at time `t`.
    ///
    /// # Errors
    /// [`MaterialError`] for constants that make no stable material.
    pub fn of(material: &case::Material, assumption: case::Assumption, t: f64) -> Result<Self, MaterialError> {
        let Some(elastic) = &material.elastic else {
            let k = material.conductivity.value.clone();
            return Ok(Self::Scalar(match k.as_constant() {
                Some(value) => Arc::new(Conductor::<N>::try_new(value)?),
                None => Arc::new(Conductor::<N>::varying(move |x| jet(&k, x, t))),
            }));
        };
        let assumption = self::assumption::<N>(assumption);
        let (a, b, young) = match elastic {
            Constants::YoungPoisson(e, nu) => (e.value.clone(), nu.value.clone(), true),
            Constants::Lame(l, m) => (l.value.clone(), m.value.clone(), false),
        };
        let hooke = match (a.as_constant(), b.as_constant()) {
            (Some(a), Some(b)) if young => Hooke::<N>::try_new(Elastic::Young { young: a, poisson: b }, assumption)?,
            (Some(a), Some(b)) => Hooke::<N>::try_new(Elastic::Lame { lambda: a, mu: b }, assumption)?,
            _ => Hooke::<N>::varying(
                move |x| {
                    let (a, b) = (jet(&a, x, t), jet(&b, x, t));
                    if young { Elastic::Young { young: a, poisson: b } } else { Elastic::Lame { lambda: a, mu: b } }
                },
                assumption,
            ),
        };
        Ok(Self::Vector(Arc::new(hooke)))
    }

    /// Number of components of the unknown.
    pub fn components(&self) -> usize {
        match self {
            Self::Scalar(_) => 1,
            Self::Vector(_) => N,
        }
    }

=======
impl<const N: usize> Physics<N> {
>>>>>>> 3fda307cc570f233f5f494b56a4a0cc778b24513:src/problem/physics.rs
    /// The modulus at `x` that scales penalties [force/area].
    pub fn modulus(&self, x: &Vector<N>) -> f64 {
        match self {
            Self::Scalar(m) => m.modulus(x),
            Self::Vector(m) => m.modulus(x),
        }
    }

    /// Whether the material is the same everywhere.
    pub fn is_homogeneous(&self) -> bool {
        match self {
            Self::Scalar(m) => m.is_homogeneous(),
            Self::Vector(m) => m.is_homogeneous(),
        }
    }

<<<<<<< HEAD:crates/faying-cli/src/build/physics.rs
    /// Flux sigma n of the field numbered by `field` through a side of the body.
    pub fn flux<const S: usize>(&self, space: &Arc<dyn Space<N, N>>, trace: &Trace<S, N>, field: Field) -> Box<dyn Flux<S, N>> {
=======
    /// sigma n of the field numbered by `field` through a side of the body.
    pub(super) fn flux<const S: usize>(&self, space: &Arc<dyn Space<N, N>>, trace: &Trace<S, N>, field: Field) -> Box<dyn Flux<S, N>> {
>>>>>>> 3fda307cc570f233f5f494b56a4a0cc778b24513:src/problem/physics.rs
        match self {
            Self::Scalar(m) => Box::new(BodyFlux::new(Arc::clone(space), trace.clone(), field, m.clone()).expect(LINEAR)),
            Self::Vector(m) => Box::new(BodyFlux::new(Arc::clone(space), trace.clone(), field, m.clone()).expect(LINEAR)),
        }
    }

<<<<<<< HEAD:crates/faying-cli/src/build/physics.rs
    /// Assembles the stiffness of a body.
    pub fn stiffness(&self, space: &dyn Space<N, N>, rules: &dyn Quadrature<N>) -> Csr {
=======
    /// The stiffness of a body.
    pub(super) fn stiffness(&self, space: &dyn Space<N, N>, rules: &dyn Quadrature<N>) -> Csr {
>>>>>>> 3fda307cc570f233f5f494b56a4a0cc778b24513:src/problem/physics.rs
        match self {
            Self::Scalar(m) => assembly::stiffness(space, rules, &form(&**m)),
            Self::Vector(m) => assembly::stiffness(space, rules, &form(&**m)),
        }
    }

<<<<<<< HEAD:crates/faying-cli/src/build/physics.rs
    /// Assembles ∫ f . N dx; also returns the resultant of f.
    pub fn load(&self, space: &dyn Space<N, N>, rules: &dyn Quadrature<N>, f: &PlaceFn<'_, N>) -> (Vec<f64>, Resultant) {
=======
    /// ∫ f . N dx, and the resultant of f.
    pub(super) fn load(&self, space: &dyn Space<N, N>, rules: &dyn Quadrature<N>, f: &PlaceFn<'_, N>) -> (Vec<f64>, Resultant) {
>>>>>>> 3fda307cc570f233f5f494b56a4a0cc778b24513:src/problem/physics.rs
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

<<<<<<< HEAD:crates/faying-cli/src/build/physics.rs
    /// Writes -div sigma(exact), the source for which `exact` is a solution.
    pub fn exact_source(&self, exact: &Exact, at: &Point, x: &Vector<N>, out: &mut [f64]) {
=======
    /// -div sigma(exact): the source that makes it a solution.
    pub(super) fn exact_source(&self, exact: &dyn Exact, at: &Point, x: &Vector<N>, out: &mut [f64]) {
>>>>>>> 3fda307cc570f233f5f494b56a4a0cc778b24513:src/problem/physics.rs
        match self {
            Self::Scalar(m) => {
                let (gradient, hessian) = field_derivatives::<1, N>(exact, at);
                out.copy_from_slice((-m.divergence(x, &gradient, &hessian)).as_slice());
            }
            Self::Vector(m) => {
                let (gradient, hessian) = field_derivatives::<N, N>(exact, at);
                out.copy_from_slice((-m.divergence(x, &gradient, &hessian)).as_slice());
            }
        }
    }

<<<<<<< HEAD:crates/faying-cli/src/build/physics.rs
    /// Writes sigma n (k du/dn) of the exact solution.
    pub fn exact_traction(&self, exact: &Exact, at: &Point, x: &Vector<N>, normal: &Vector<N>, out: &mut [f64]) {
=======
    /// sigma n (k du/dn) of the exact solution.
    pub fn exact_traction(&self, exact: &dyn Exact, at: &Point, x: &Vector<N>, normal: &Vector<N>, out: &mut [f64]) {
>>>>>>> 3fda307cc570f233f5f494b56a4a0cc778b24513:src/problem/physics.rs
        match self {
            Self::Scalar(m) => out.copy_from_slice((m.respond(x, &field_slope::<1, N>(exact, at).1).stress * normal).as_slice()),
            Self::Vector(m) => out.copy_from_slice((m.respond(x, &field_slope::<N, N>(exact, at).1).stress * normal).as_slice()),
        }
    }

<<<<<<< HEAD:crates/faying-cli/src/build/physics.rs
    /// Computes norms of the error of `u` against the exact solution at time `t`.
    pub fn errors(&self, space: &dyn Space<N, N>, rules: &dyn Quadrature<N>, u: &[f64], exact: &Exact, t: f64) -> Errors {
=======
    /// Norms of the error of `u` against the exact solution at time `t`.
    pub fn errors(&self, space: &dyn Space<N, N>, rules: &dyn Quadrature<N>, u: &[f64], exact: &dyn Exact, t: f64) -> Errors {
>>>>>>> 3fda307cc570f233f5f494b56a4a0cc778b24513:src/problem/physics.rs
        match self {
            Self::Scalar(m) => assembly::errors(space, rules, &form(&**m), u, &|x: &Vector<N>| {
                field_slope::<1, N>(exact, &Point::new(x.as_slice()).at_time(t))
            }),
            Self::Vector(m) => assembly::errors(space, rules, &form(&**m), u, &|x: &Vector<N>| {
                field_slope::<N, N>(exact, &Point::new(x.as_slice()).at_time(t))
            }),
        }
    }

<<<<<<< HEAD:crates/faying-cli/src/build/physics.rs
    /// Computes norms of the difference of `u` and a stored run, with the rules of `other`.
    pub fn difference<const S: usize>(&self, space: &dyn Space<N, N>, u: &[f64], other: &ReferencePatch<S, N>) -> Errors {
=======
    /// Norms of the difference of `u` and another field, whose value and gradient are asked for at (element, local point, place).
    pub fn difference(&self, space: &dyn Space<N, N>, rules: &dyn Quadrature<N>, u: &[f64], other: &dyn OtherField<N>) -> Errors {
>>>>>>> 3fda307cc570f233f5f494b56a4a0cc778b24513:src/problem/physics.rs
        match self {
            Self::Scalar(m) => assembly::difference(space, rules, &form(&**m), u, &|e, xi: &Vector<N>, x: &Vector<N>| {
                let (value, gradient) = other.at(e, xi, x, 1);
                (Vector::<1>::from_fn(|i, _| value[i]), Matrix::<1, N>::from_fn(|i, j| gradient[i][j]))
            }),
            Self::Vector(m) => assembly::difference(space, rules, &form(&**m), u, &|e, xi: &Vector<N>, x: &Vector<N>| {
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
                })
                .collect(),
            Self::Vector(m) => physics::stress_at::<N, N, f64, _, _>(space, &**m, &u[field.first..], element, xi)
                .into_iter()
                .map(|s| PointState { x: s.x, u: std::array::from_fn(|k| if k < N { s.value[k] } else { 0.0 }), stress: s.spatial })
                .collect(),
        }
    }
}
