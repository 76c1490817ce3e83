//! Errors of a solved model against exact solutions and multipliers, or against a stored run if there are none.

use crate::lower::Built;
use crate::named::Named;
use crate::reference::{OnSide, Reference, ReferenceLambda};
use faying::assembly::Errors;
use faying::linalg::Vector;
use faying::problem::{ContactField, Model, Solution, SquaredError, StepState, TieField, TieModel};

/// Errors that can be measured.
pub fn error_names<const S: usize, const N: usize>(built: &Built<S, N>) -> Vec<String> {
    let (model, reference) = (built.system.model(), built.reference.as_ref());
    let mut names = Vec::new();
    let mut add = |name: String| {
        names.push(name.clone());
        names.push(format!("{name}.rel"));
    };
    if model.exact.is_some() || reference.is_some() {
        for norm in ["L2", "H1", "energy"] {
            add(format!("error.u.{norm}"));
        }
    }
    let ties = model.ties.iter().filter(|t| t.exact.is_some() || is_known(model, reference, &t.name)).map(|t| &t.name);
    let contacts = model.contacts.iter().filter(|c| c.exact.is_some() || is_known(model, reference, &c.name)).map(|c| &c.name);
    let interfaces: Vec<&String> = ties.chain(contacts).collect();
    for name in &interfaces {
        add(format!("error.{name}.lambda.L2"));
    }
    if !interfaces.is_empty() {
        add("error.lambda.L2".into());
    }
    names
}

/// Whether the exact solution or the stored run has lambda of an interface or contact.
fn is_known<const S: usize, const N: usize>(model: &Model<S, N>, reference: Option<&Reference<S, N>>, name: &str) -> bool {
    model.exact.is_some() || reference.is_some_and(|r| r.lambda_of(name).is_some())
}

/// Every error that can be measured, by its quantity; NaN where the exact solution is left open.
pub fn errors<const S: usize, const N: usize>(solution: &Solution<S, N>, reference: Option<&Reference<S, N>>) -> Named<f64> {
    let (model, state) = (solution.model(), solution.state());
    let mut all = Named::default();
    let mut add = |name: String, error: f64, exact: f64| {
        all.push(name.clone(), error);
        all.push(format!("{name}.rel"), error / exact);
    };
    let of_body = |k: usize| {
        let p = &model.patches[k];
        let (physics, space, u) = (p.physics_at(state.t), &**p.body.space(), &state.u[p.range()]);
        let stored = || {
            let other = &reference?.patches[k];
            Some(physics.difference(space, &other.rules, u, other))
        };
        model.exact.as_ref().map(|exact| physics.errors(space, &p.rules, u, &**exact, state.t)).or_else(stored)
    };
    let bodies: Option<Vec<Errors>> = (0..model.patches.len()).map(of_body).collect();
    if let Some(bodies) = bodies {
        let sum = bodies.into_iter().fold(Errors::default(), Errors::hypot);
        add("error.u.L2".into(), sum.error.l2, sum.exact.l2);
        add("error.u.H1".into(), sum.error.h1, sum.exact.h1);
        add("error.u.energy".into(), sum.error.energy, sum.exact.energy);
    }
    let mut total = SquaredError::default();
    let mut any = false;
    for tie in model.ties.iter().filter(|t| t.exact.is_some() || is_known(model, reference, &t.name)) {
        let s = match stored_lambda(model, reference, &tie.name, tie.exact.is_some()) {
            Some(stored) => tie_difference(model, state, tie, stored),
            None => tie.lambda_error(model, state),
        };
        total = SquaredError { error: total.error + s.error, exact: total.exact + s.exact };
        add(format!("error.{}.lambda.L2", tie.name), s.error.sqrt(), s.exact.sqrt());
        any = true;
    }
    for (k, contact) in model.contacts.iter().enumerate().filter(|(_, c)| c.exact.is_some() || is_known(model, reference, &c.name)) {
        let s = match stored_lambda(model, reference, &contact.name, contact.exact.is_some()) {
            Some(stored) => contact_difference(model, state, k, stored),
            None => contact.lambda_error(model, &state.contacts[k], state),
        };
        total = SquaredError { error: total.error + s.error, exact: total.exact + s.exact };
        add(format!("error.{}.lambda.L2", contact.name), s.error.sqrt(), s.exact.sqrt());
        any = true;
    }
    if any {
        add("error.lambda.L2".into(), total.error.sqrt(), total.exact.sqrt());
    }
    all
}

/// lambda of the stored run, where nothing exact stands before it.
fn stored_lambda<'a, const S: usize, const N: usize>(
    model: &Model<S, N>,
    reference: Option<&'a Reference<S, N>>,
    name: &str,
    exact: bool,
) -> Option<&'a ReferenceLambda<S>> {
    reference.filter(|_| !exact && model.exact.is_none())?.lambda_of(name)
}

/// Adds squares of error and stored lambda over the pieces `on`; `found(element, points)` returns lambda, `[component][point]`.
fn add_difference<const S: usize>(sum: &mut SquaredError, on: &OnSide<S>, found: impl Fn(usize, &[Vector<S>]) -> Vec<Vec<f64>>) {
    let s = &on.segments;
    for piece in 0..s.num_pieces() {
        let points = s.points(piece);
        let found = found(s.slave[piece], &s.slave_xi[points.clone()]);
        for (k, q) in points.enumerate() {
            for (c, wanted) in on.at(piece, q).into_iter().enumerate() {
                sum.error += s.ds[q] * (found[c][k] - wanted).powi(2);
                sum.exact += s.ds[q] * wanted.powi(2);
            }
        }
    }
}

fn tie_difference<const S: usize, const N: usize>(
    model: &Model<S, N>,
    state: &StepState<S, N>,
    tie: &TieModel<S, N>,
    stored: &ReferenceLambda<S>,
) -> SquaredError {
    let mut sum = SquaredError::default();
    for (part, sides) in tie.parts.iter().zip(&stored.parts) {
        let lambda = TieField::of(model, part, state.t);
        sides.iter().for_each(|on| add_difference(&mut sum, on, |e, xi| lambda.at(model, part, state, e, xi)));
    }
    sum
}

fn contact_difference<const S: usize, const N: usize>(
    model: &Model<S, N>,
    state: &StepState<S, N>,
    number: usize,
    stored: &ReferenceLambda<S>,
) -> SquaredError {
    let mut sum = SquaredError::default();
    let contact = &model.contacts[number];
    for (part, sides) in contact.parts.iter().zip(&stored.parts) {
        let lambda = ContactField::of(model, part, state.t);
        let of = |e: usize, xi: &[Vector<S>]| lambda.at(model, contact, part, state, e, xi).into_iter().map(|found| found[0]).collect();
        sides.iter().for_each(|on| add_difference(&mut sum, on, |e, xi| vec![of(e, xi)]));
    }
    sum
}
