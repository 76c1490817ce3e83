//! Feasibility of the loads: whether contact pressure alone can balance them.
//!
//! With the rigid motions R left by supports and ties, equilibrium requires lambda <= 0 with Rᵀ Cᵀ lambda = Rᵀ f. By Farkas' lemma either
//! such a lambda exists, or a rigid motion on which the load does work and which no contact resists: the residual of the least squares
//! problem min |Rᵀ f - Rᵀ Cᵀ lambda| over lambda <= 0 is that motion, and its negative the missing force.
//!
//! Source: Farkas, J. Reine Angew. Math. 124 (1902) 1-27; conditions of this kind for contact: Kikuchi, Oden, Contact Problems in
//! Elasticity, SIAM 1988, chapter 6.

use super::model::{ContactPart, Model};
use super::rigid::RigidForm;
use super::rigid_bodies::RigidBodies;
use super::rigid_rows::{contact_forms, point_forms};
use super::supports::held;
use crate::contact::{Cone, ContactRows};
use nalgebra::{DMatrix, DVector};

/// A missing force below this fraction of the sum of all nodal loads is round-off.
const BALANCED: f64 = 1e-9;
/// Bodies that move less than this fraction of the whole motion are not named.
const STILL: f64 = 1e-3;

/// Four digits of a number.
fn short(x: f64) -> String {
    format!("{x:.3e}").parse::<f64>().map_or_else(|_| x.to_string(), |v| format!("{v}"))
}

/// A load on a patch: a force and its moment about the origin.
type Push = ([f64; 3], [f64; 3]);

/// Loads that no pressure of the multipliers balances.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Unheld {
    /// Sentence: `nothing holds body "upper" against its load in ...`.
    pub what: String,
    /// Whether forces at the points and the ends of the sides would balance them.
    pub coarse: bool,
}

/// Loads that no contact pressure balances, none where one does.
///
/// `contacts` at time `t`, per contact and part; `loads` per patch, then on the obstacle of every contact; `size`: sum of the
/// sizes of all nodal loads.
pub(super) fn unheld<const S: usize, const N: usize>(
    model: &Model<S, N>,
    t: f64,
    contacts: &[Vec<ContactRows<S, N>>],
    loads: &[Push],
    size: f64,
) -> Option<Unheld> {
    let bodies = RigidBodies::of(model);
    // loads are known per patch
    if !bodies.are_whole() {
        return None;
    }
    let (modes, forms) = held(model, t, &bodies);
    let null = modes.null(&forms);
    // the cones W and E allow tension locally: a test per function does not apply
    if null.ncols() == 0 || model.contacts.iter().flat_map(|c| &c.parts).any(|part| part.cone != Cone::Coefficients) {
        return None;
    }
    let m = modes.modes();
    let mut load = DVector::<f64>::zeros(null.nrows());
    for (patch, (force, moment)) in loads.iter().enumerate() {
        let body = match patch.checked_sub(model.patches.len()) {
            None => bodies.of_patch(patch),
            Some(contact) => match bodies.of_obstacle(contact) {
                Some(body) => body,
                None => continue,
            },
        };
        let first = m * body;
        modes.work(body, force, moment).into_iter().enumerate().for_each(|(k, w)| load[first + k] += w);
    }
    // loads that are not finite are reported when the system is solved
    if load.iter().any(|l| !l.is_finite()) {
        return None;
    }
    let parts: Vec<(usize, &ContactPart<S, N>, &ContactRows<S, N>)> = model
        .contacts
        .iter()
        .zip(contacts)
        .enumerate()
        .flat_map(|(k, (contact, built))| contact.parts.iter().zip(built).map(move |(part, built)| (k, part, built)))
        .collect();
    let balance = |forms: Vec<RigidForm>| {
        let columns: Vec<_> = forms.iter().map(|form| -(null.transpose() * modes.dense(form))).collect();
        crate::linalg::nonnegative_least_squares(&columns, &(null.transpose() * &load)).1
    };
    let of_functions = parts.iter().flat_map(|&(k, part, built)| contact_forms(model, &modes, &bodies, k, part, built));
    let rest = balance(of_functions.map(|(form, _)| form).collect());
    if rest.norm() <= BALANCED * size {
        return None;
    }
    let of_points = parts.iter().flat_map(|&(k, part, built)| point_forms(model, &modes, &bodies, k, part, built));
    let coarse = balance(of_points.collect()).norm() <= BALANCED * size;
    let motion = &null * &rest;
    let sentence = |body: usize| {
        let own = motion.rows(m * body, m).into_owned();
        let named = modes.name(body, &DMatrix::from_column_slice(m, 1, (&own / own.norm()).as_slice()));
        let mut lacks = Vec::new();
        let list: Vec<String> = own.iter().take(N).map(|f| if f.abs() > STILL * own.norm() { short(-f) } else { "0".into() }).collect();
        if own.rows(0, N).norm() > STILL * own.norm() {
            lacks.push(format!("a force ({})", list.join(", ")));
        }
        if own.rows(N, m - N).norm() > STILL * own.norm() {
            let (center, size) = modes.frames[body];
            let about: Vec<String> = center.iter().map(|&x| short(x)).collect();
            lacks.push(format!("a moment {} about ({})", short(-own[N] * size), about.join(", ")));
        }
        let number = bodies.number(model, body);
        let who = match model.patches.get(number) {
            Some(patch) => format!("body \"{}\"", patch.name),
            None => format!("the obstacle of contact \"{}\"", model.contacts[number - model.patches.len()].name),
        };
        format!("nothing holds {who} against its load in {}: {} is missing", named.join(", "), lacks.join(" and "))
    };
    let moving = (0..modes.num_bodies()).filter(|&b| motion.rows(m * b, m).norm() > STILL * motion.norm());
    Some(Unheld { what: moving.map(sentence).collect::<Vec<_>>().join("; "), coarse })
}
