//! Material of a patch, with one interface for scalar and vector unknowns.

use super::exact::Exact;
use super::reference::ReferencePatch;
use crate::case::{self, Elastic as Constants};
use crate::formula::{Formula, Point};
use crate::run::Resultant;
use faying::assembly::{self, Errors, Form};
use faying::linalg::{Csr, Matrix, Vector};
use faying::physics::{self, Assumption, BodyFlux, Conductor, Elastic, Flux, Hooke, Jet, Material, MaterialError};
use faying::quadrature::Quadrature;
use faying::space::{Field, Space, Trace};
use std::sync::Arc;

/// A material for one component (Poisson) or N (elasticity).
#[derive(Clone, Debug)]
pub enum Physics<const N: usize> {
    /// One component.
    Scalar(Arc<Conductor<N>>),
    /// As many components as coordinates.
    Vector(Arc<Hooke<N>>),
}

/// The solution at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointState<const N: usize> {
    /// Position \[length\].
    pub x: Vector<N>,
    /// u; missing components are zero.
    pub u: [f64; 3],
    /// xx yy zz xy yz xz [force/area]; Poisson: k grad u in the first entries.
    pub stress: [f64; 6],
}

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
fn form<const C: usize, const N: usize>(material: &dyn Material<C, N>) -> Form<'_, C, N> {
    physics::form(material).expect(LINEAR)
}

fn filled<const C: usize>(fill: impl FnOnce(&mut [f64])) -> Vector<C> {
    let mut out = Vector::<C>::zeros();
    fill(out.as_mut_slice());
    out
}

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

    /// Flux sigma n of the field numbered by `field` through a side of the body.
    pub fn flux<const S: usize>(&self, space: &Arc<dyn Space<N, N>>, trace: &Trace<S, N>, field: Field) -> Box<dyn Flux<S, N>> {
        match self {
            Self::Scalar(m) => Box::new(BodyFlux::new(Arc::clone(space), trace.clone(), field, m.clone()).expect(LINEAR)),
            Self::Vector(m) => Box::new(BodyFlux::new(Arc::clone(space), trace.clone(), field, m.clone()).expect(LINEAR)),
        }
    }

    /// Assembles the stiffness of a body.
    pub fn stiffness(&self, space: &dyn Space<N, N>, rules: &dyn Quadrature<N>) -> Csr {
        match self {
            Self::Scalar(m) => assembly::stiffness(space, rules, &form(&**m)),
            Self::Vector(m) => assembly::stiffness(space, rules, &form(&**m)),
        }
    }

    /// Assembles ∫ f . N dx; also returns the resultant of f.
    pub fn load(&self, space: &dyn Space<N, N>, rules: &dyn Quadrature<N>, f: &PlaceFn<'_, N>) -> (Vec<f64>, Resultant) {
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
    pub fn side_load<const S: usize>(&self, trace: &Trace<S, N>, rules: &dyn Quadrature<S>, f: &SideFn<'_, N>, load: &mut [f64]) {
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
    pub fn springs<const S: usize>(
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

    /// Writes -div sigma(exact), the source for which `exact` is a solution.
    pub fn exact_source(&self, exact: &Exact, at: &Point, x: &Vector<N>, out: &mut [f64]) {
        match self {
            Self::Scalar(m) => {
                let jet = exact.jet::<1, N>(at);
                out.copy_from_slice((-m.divergence(x, &jet.gradient, &jet.hessian)).as_slice());
            }
            Self::Vector(m) => {
                let jet = exact.jet::<N, N>(at);
                out.copy_from_slice((-m.divergence(x, &jet.gradient, &jet.hessian)).as_slice());
            }
        }
    }

    /// Writes sigma n (k du/dn) of the exact solution.
    pub fn exact_traction(&self, exact: &Exact, at: &Point, x: &Vector<N>, normal: &Vector<N>, out: &mut [f64]) {
        match self {
            Self::Scalar(m) => out.copy_from_slice((m.respond(x, &exact.slope::<1, N>(at).1).stress * normal).as_slice()),
            Self::Vector(m) => out.copy_from_slice((m.respond(x, &exact.slope::<N, N>(at).1).stress * normal).as_slice()),
        }
    }

    /// Computes norms of the error of `u` against the exact solution at time `t`.
    pub fn errors(&self, space: &dyn Space<N, N>, rules: &dyn Quadrature<N>, u: &[f64], exact: &Exact, t: f64) -> Errors {
        match self {
            Self::Scalar(m) => {
                assembly::errors(space, rules, &form(&**m), u, &|x: &Vector<N>| exact.slope::<1, N>(&Point::new(x.as_slice()).at_time(t)))
            }
            Self::Vector(m) => {
                assembly::errors(space, rules, &form(&**m), u, &|x: &Vector<N>| exact.slope::<N, N>(&Point::new(x.as_slice()).at_time(t)))
            }
        }
    }

    /// Computes norms of the difference of `u` and a stored run, with the rules of `other`.
    pub fn difference<const S: usize>(&self, space: &dyn Space<N, N>, u: &[f64], other: &ReferencePatch<S, N>) -> Errors {
        match self {
            Self::Scalar(m) => {
                assembly::difference(space, &other.rules, &form(&**m), u, &|e, xi: &Vector<N>, x: &Vector<N>| other.at::<1>(e, xi, x))
            }
            Self::Vector(m) => {
                assembly::difference(space, &other.rules, &form(&**m), u, &|e, xi: &Vector<N>, x: &Vector<N>| other.at::<N>(e, xi, x))
            }
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
