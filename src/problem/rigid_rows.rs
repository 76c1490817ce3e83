//! Rows of multiplier functions on rigid motions: C R, one form per function.
//!
//! R: the rigid motions of the bodies. They lie in the bodies' spaces, so that row j of a tie is on them
//!
//! ```text
//! ∫ ψ_j d . (u_slave - u_master) ds = d . (t_s - t_m) ∫ ψ_j ds + ...  ∫ ψ_j (x - c) ds,
//! ```
//!
//! whatever the functions of the sides are: both bodies are looked at in the place of the slave, so that sides that are a little apart hold
//! no more than sides that touch. Counting rows or points says too little: one constant per component has a row for each translation and
//! lets the body turn about the middle of the side.

use super::function_sums::FunctionSums;
use super::model::{ContactPart, Model, TiePart};
use super::rigid::{MOST, RigidForm, RigidModes, RigidRow};
use super::rigid_bodies::{RigidBodies, contact_terms, unit};
use crate::basis::{Order, ShapeTable};
use crate::contact::{Cone, ContactRows};
use crate::geometry::{MapTable, cell};
use crate::linalg::Vector;

/// Part of the way from the outermost points of an element to its corners: at the corners themselves no finer side would press, either.
const INSIDE: f64 = 0.99;

/// A point from which levers of a patch are measured: its middle.
fn origin<const S: usize, const N: usize>(model: &Model<S, N>, patch: usize) -> Vector<N> {
    model.patches[patch].extent.map_or(model.center, |b| b.center())
}

/// The sums of the functions of a tie: per master, component after component, in the order of its rows.
pub fn function_sums<const S: usize, const N: usize>(model: &Model<S, N>, part: &TiePart<S, N>) -> Vec<Vec<FunctionSums<N>>> {
    let (space, origin) = (&*part.slave.trace.space, origin(model, part.slave.patch));
    let (mut ids, mut table, mut map) = (Vec::new(), ShapeTable::new(), MapTable::new());
    let total = part.multipliers.iter().map(|m| m.num_functions()).sum();
    let mut all = Vec::with_capacity(part.pairings.len());
    for segments in part.pairings.iter().map(|p| &p.segments) {
        let mut own = vec![FunctionSums { sum: 0.0, lever: Vector::zeros(), size: 0.0 }; total];
        for piece in 0..segments.num_pieces() {
            let (element, points) = (segments.slave[piece], segments.points(piece));
            let xi = &segments.slave_xi[points.clone()];
            space.map(element, xi, Order::Values, &mut map);
            let mut first = 0;
            for psi in &part.multipliers {
                psi.active(element, &mut ids);
                psi.tabulate(element, xi, Order::Values, &mut table);
                for (k, &ds) in segments.ds[points.clone()].iter().enumerate() {
                    for (&j, &value) in ids.iter().zip(table.values(k)) {
                        let sums = &mut own[first + j];
                        sums.sum += value * ds;
                        sums.lever += (map.x[k] - origin) * (value * ds);
                        sums.size += (value * ds).abs();
                    }
                }
                first += psi.num_functions();
            }
        }
        all.push(own);
    }
    all
}

/// The rows of a tie on rigid motions, as means over each function; none where the coupling makes other rows than mortar.
pub(super) fn tie_forms<const S: usize, const N: usize>(
    model: &Model<S, N>,
    modes: &RigidModes<N>,
    bodies: &RigidBodies,
    part: &TiePart<S, N>,
) -> Vec<RigidForm> {
    let (origin, slave) = (origin(model, part.slave.patch), bodies.of_patch(part.slave.patch));
    let mut forms = Vec::new();
    let mut row = 0;
    for (component, psi) in part.multipliers.iter().enumerate().filter(|_| !part.function_sums.is_empty()) {
        for j in row..row + psi.num_functions() {
            let size: f64 = part.function_sums.iter().map(|own| own[j].size).sum();
            if size == 0.0 {
                continue;
            }
            let mut form = RigidForm::new();
            for (pairing, own) in part.pairings.iter().zip(&part.function_sums) {
                let (sum, lever, direction) = (own[j].sum / size, own[j].lever / size, unit(component));
                form.push((slave, modes.sums(slave, &direction, sum, &lever, &origin)));
                let master = bodies.of_patch(pairing.master.patch);
                form.push((master, modes.sums(master, &direction, -sum, &-lever, &origin)));
            }
            forms.push(form);
        }
        row += psi.num_functions();
    }
    forms
}

/// Every row of a contact on rigid motions, and ∫ |ψ| ds; of a contact by points one per point, with 1.
pub(super) fn contact_forms<const S: usize, const N: usize>(
    model: &Model<S, N>,
    modes: &RigidModes<N>,
    bodies: &RigidBodies,
    contact_number: usize,
    part: &ContactPart<S, N>,
    contact: &ContactRows<S, N>,
) -> Vec<(RigidForm, f64)> {
    let segments = &contact.segments;
    let push = |q: usize| {
        modes.form(&RigidRow { terms: contact_terms(model, bodies, contact_number, part, contact, q), direction: contact.frames.normal[q] })
    };
    let Some(multiplier) = &part.multiplier else {
        // rows at points push there
        return (0..contact.frames.x.len()).map(|q| (push(q), 1.0)).collect();
    };
    let mut forms = vec![(RigidForm::new(), 0.0); multiplier.num_functions()];
    let (mut ids, mut table) = (Vec::new(), ShapeTable::new());
    for piece in 0..segments.num_pieces() {
        let points = segments.points(piece);
        multiplier.active(segments.slave[piece], &mut ids);
        multiplier.tabulate(segments.slave[piece], &segments.slave_xi[points.clone()], Order::Values, &mut table);
        for (k, q) in points.enumerate() {
            let form = push(q);
            for (&j, value) in ids.iter().zip(table.values(k)) {
                let weight = value * segments.ds[q];
                let (sum, size) = &mut forms[j];
                *size += weight.abs();
                form.iter().for_each(|(body, own)| add(sum, *body, own, weight));
            }
        }
    }
    forms
}

/// Forces along the normal at every point of a contact and near the corners of its elements, on rigid motions.
pub(super) fn point_forms<const S: usize, const N: usize>(
    model: &Model<S, N>,
    modes: &RigidModes<N>,
    bodies: &RigidBodies,
    contact_number: usize,
    part: &ContactPart<S, N>,
    contact: &ContactRows<S, N>,
) -> Vec<RigidForm> {
    let (segments, frames, space) = (&contact.segments, &contact.frames, &*part.slave.trace.space);
    let push = |q: usize, away: Vector<N>| {
        let mut terms = contact_terms(model, bodies, contact_number, part, contact, q);
        terms.iter_mut().for_each(|term| term.2 += away);
        modes.form(&RigidRow { terms, direction: frames.normal[q] })
    };
    let (mut forms, mut map) = (Vec::new(), MapTable::new());
    for piece in 0..segments.num_pieces() {
        forms.extend(segments.points(piece).map(|q| push(q, Vector::zeros())));
        let element = segments.slave[piece];
        space.map(element, &cell::grid(space.cell(element), 2), Order::Values, &mut map);
        for corner in &map.x {
            let apart = |q: &usize| (frames.x[*q] - corner).norm();
            let nearest = segments.points(piece).min_by(|a, b| apart(a).total_cmp(&apart(b)));
            forms.extend(nearest.map(|q| push(q, (corner - frames.x[q]) * INSIDE)));
        }
    }
    forms
}

/// Adds the modes of a body, times `weight`, to a form.
pub(super) fn add(sum: &mut RigidForm, body: usize, own: &[f64; MOST], weight: f64) {
    let place = sum.iter().position(|t| t.0 == body).unwrap_or_else(|| {
        sum.push((body, [0.0; MOST]));
        sum.len() - 1
    });
    sum[place].1.iter_mut().zip(own).for_each(|(s, v)| *s += weight * v);
}

/// The rows of all contacts, closed, on rigid motions: as means over each function.
pub fn closed_forms<const S: usize, const N: usize>(model: &Model<S, N>, modes: &RigidModes<N>, bodies: &RigidBodies) -> Vec<RigidForm> {
    let mut all = Vec::new();
    for (k, contact) in model.contacts.iter().enumerate() {
        for part in &contact.parts {
            // functions that face nothing have no row; those of other cones are mixed
            let has_row = |j: usize| part.cone != Cone::Coefficients || part.multiplier.is_none() || part.first.facing[j];
            let forms = contact_forms(model, modes, bodies, k, part, &part.first).into_iter().enumerate();
            for (mut form, size) in forms.filter(|(j, (_, size))| *size > 0.0 && has_row(*j)).map(|f| f.1) {
                form.iter_mut().flat_map(|t| &mut t.1).for_each(|v| *v /= size);
                all.push(form);
            }
        }
    }
    all
}
