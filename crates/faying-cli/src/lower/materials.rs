//! Materials of a case at a time.

use crate::case::{self, Elastic as Constants};
use crate::formula::{Formula, Point};
use faying::linalg::Vector;
use faying::physics::{Assumption, Conductor, Elastic, Hooke, Jet, MaterialError};
use faying::problem::Physics;
use std::sync::Arc;

/// Value and gradient of a formula at a place and a time.
fn jet<const N: usize>(formula: &Formula, x: &Vector<N>, t: f64) -> Jet<N> {
    let jet = formula.slope(&Point::new(x.as_slice()).at_time(t));
    Jet::new(jet.value, Vector::from_fn(|k, _| jet.gradient[k]))
}

/// The material of the case at time `t`.
///
/// # Errors
/// [`MaterialError`] for constants that make no stable material.
pub(super) fn material<const N: usize>(material: &case::Material, assumption: Assumption, t: f64) -> Result<Physics<N>, MaterialError> {
    let Some(elastic) = &material.elastic else {
        let k = material.conductivity.value.clone();
        return Ok(Physics::Scalar(match k.as_constant() {
            Some(value) => Arc::new(Conductor::<N>::try_new(value)?),
            None => Arc::new(Conductor::<N>::varying(move |x| jet(&k, x, t))),
        }));
    };
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
    Ok(Physics::Vector(Arc::new(hooke)))
}
