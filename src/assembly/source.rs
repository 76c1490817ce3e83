//! Type-erased data of forms, so that the SIMD kernels are compiled once and not for every type of form.

use super::{Coefficient, Form, Tangent};
use crate::linalg::{Matrix, Real, Vector, lit, to_f64};
use std::fmt::Debug;

/// Writes the tangent at a point with a gradient of the state, component by component (empty: zero): entry `((c * C + e) * N + i) * N + j` couples direction i of component c of the test
/// function with direction j of component e of the trial function.
pub(super) type PointTangent<'a> = dyn Fn(&[f64], &[f64], &mut [f64]) + Sync + 'a;

/// Integrand of a bulk matrix.
pub(super) enum Integrand<'a> {
    /// Products of function values.
    Mass,
    /// One tangent everywhere, in the order of [`PointTangent`].
    Constant(Vec<f64>),
    /// A tangent per physical point and gradient of a state.
    PerPoint {
        /// The tangent.
        at: Box<PointTangent<'a>>,
        /// Unknowns of the state; empty: its gradient is zero, or the tangent does not depend on it.
        state: Vec<f64>,
    },
}

impl<'a> Integrand<'a> {
    /// Type-erased coefficient of `form`.
    pub fn new<const C: usize, const N: usize, T: Real>(form: &'a Form<'_, C, N, T>) -> Self {
        match &form.coefficient {
            Coefficient::Constant(tangent) => {
                let mut all = vec![0.0; C * C * N * N];
                numbers(tangent, &mut all);
                Self::Constant(all)
            }
            Coefficient::PerPoint(at) => {
                Self::PerPoint { at: Box::new(move |x, _, out| numbers(&at(&Vector::from_fn(|k, _| lit(x[k]))), out)), state: Vec::new() }
            }
            Coefficient::PerState(at) => {
                let of_state = move |x: &[f64], gradient: &[f64], out: &mut [f64]| {
                    let entry = |c: usize, k: usize| gradient.get(c * N + k).map_or(T::zero(), |&g| lit(g));
                    numbers(&at(&Vector::from_fn(|k, _| lit(x[k])), &Matrix::from_fn(entry)), out);
                };
                Self::PerPoint { at: Box::new(of_state), state: form.state.iter().map(|&u| to_f64(u)).collect() }
            }
        }
    }

    /// The unknowns of the state that the tangent depends on.
    pub fn state(&self) -> Option<&[f64]> {
        match self {
            Self::PerPoint { state, .. } if !state.is_empty() => Some(state),
            _ => None,
        }
    }
}

impl Debug for Integrand<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Mass => "Mass",
            Self::Constant(_) => "Constant",
            Self::PerPoint { .. } => "PerPoint",
        })
    }
}

/// Writes a tangent in the order of [`PointTangent`].
fn numbers<const C: usize, const N: usize, T: Real>(tangent: &Tangent<C, N, T>, out: &mut [f64]) {
    for c in 0..C {
        for e in 0..C {
            for i in 0..N {
                for j in 0..N {
                    out[((c * C + e) * N + i) * N + j] = to_f64(tangent[e][j][(c, i)]);
                }
            }
        }
    }
}
