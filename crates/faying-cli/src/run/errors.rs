//! Errors of a solution against exact solutions and multipliers, or against a stored run if there are none.

use crate::lower::LoweredCase;
use crate::reference::{OnSide, Reference, ReferenceLambda};
use faying::assembly::Errors;
use faying::problem::{Contents, InterfaceView, LambdaField, Solution, SquaredError};
use indexmap::IndexMap;

/// Errors that can be measured.
pub fn error_names<const S: usize, const N: usize>(built: &LoweredCase<S, N>) -> Vec<String> {
    let mut names = Vec::new();
    let mut add = |name: String| {
        names.push(name.clone());
        names.push(format!("{name}.rel"));
    };
    let (contents, reference) = (built.system.contents(), built.reference.as_ref());
    if contents.has_exact() || reference.is_some() {
        for norm in ["L2", "H1", "energy"] {
            add(format!("error.u.{norm}"));
        }
    }
    let known = measured(&contents, reference);
    for of in &known {
        add(format!("error.{}.lambda.L2", of.name()));
    }
    if !known.is_empty() {
        add("error.lambda.L2".into());
    }
    names
}

/// Ties and contacts whose lambda is known: by themselves, by the exact solution, or by the stored run.
fn measured<'a, const S: usize, const N: usize>(
    contents: &Contents<'a, S, N>,
    reference: Option<&Reference<S, N>>,
) -> Vec<InterfaceView<'a, S, N>> {
    let is_known = |of: &InterfaceView<'_, S, N>| {
        !of.exact().is_empty() || contents.has_exact() || reference.is_some_and(|r| r.lambda_of(of.name()).is_some())
    };
    contents.interfaces().filter(is_known).collect()
}

/// Every error that can be measured, by its quantity; NaN where the exact solution is left open.
pub fn errors<const S: usize, const N: usize>(solution: &Solution<S, N>, reference: Option<&Reference<S, N>>) -> IndexMap<String, f64> {
    let mut all = IndexMap::default();
    let mut add = |name: String, error: f64, exact: f64| {
        all.insert(name.clone(), error);
        all.insert(format!("{name}.rel"), error / exact);
    };
    let contents = solution.contents();
    let stored = |reference: &Reference<S, N>| {
        let bodies = contents.bodies().zip(&reference.patches);
        bodies.map(|(body, other)| solution.difference(body.id(), &other.rules, other).expect("a body of the solution")).collect()
    };
    let bodies: Option<Vec<Errors>> = contents.has_exact().then(|| solution.own_errors()).or_else(|| reference.map(stored));
    if let Some(bodies) = bodies {
        let sum = bodies.into_iter().fold(Errors::default(), Errors::hypot);
        add("error.u.L2".into(), sum.error.l2, sum.exact.l2);
        add("error.u.H1".into(), sum.error.h1, sum.exact.h1);
        add("error.u.energy".into(), sum.error.energy, sum.exact.energy);
    }
    let known = measured(&contents, reference);
    let mut total = SquaredError::default();
    for of in &known {
        // a stored lambda counts where nothing exact stands before it
        let stored = reference.filter(|_| of.exact().is_empty() && !contents.has_exact()).and_then(|r| r.lambda_of(of.name()));
        let s = match stored {
            Some(stored) => difference(solution, of, stored),
            None => solution.lambda_error(of.id()).expect("a tie or contact of the solution"),
        };
        total = SquaredError { error: total.error + s.error, exact: total.exact + s.exact };
        add(format!("error.{}.lambda.L2", of.name()), s.error.sqrt(), s.exact.sqrt());
    }
    if !known.is_empty() {
        add("error.lambda.L2".into(), total.error.sqrt(), total.exact.sqrt());
    }
    all
}

/// The error of lambda against that of a stored run.
fn difference<const S: usize, const N: usize>(
    solution: &Solution<S, N>,
    of: &InterfaceView<'_, S, N>,
    stored: &ReferenceLambda<S>,
) -> SquaredError {
    let mut sum = SquaredError::default();
    for (side, pieces) in stored.parts.iter().enumerate() {
        if let Ok(Some(lambda)) = solution.lambda(of.id(), side) {
            pieces.iter().for_each(|on| add_difference(&mut sum, on, &lambda));
        }
    }
    sum
}

/// Adds squares of error and stored lambda over the pieces `on`.
fn add_difference<const S: usize>(sum: &mut SquaredError, on: &OnSide<S>, lambda: &LambdaField<S>) {
    let s = &on.segments;
    for piece in 0..s.num_pieces() {
        let points = s.points(piece);
        let found = lambda.at(s.slave[piece], &s.slave_xi[points.clone()]);
        for (k, q) in points.enumerate() {
            for (c, wanted) in on.at(piece, q).into_iter().enumerate() {
                sum.error += s.ds[q] * (found[c][k] - wanted).powi(2);
                sum.exact += s.ds[q] * wanted.powi(2);
            }
        }
    }
}
