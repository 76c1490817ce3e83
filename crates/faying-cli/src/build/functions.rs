//! Multiplier functions applied to rigid motions: C R, one linear form per function.
//!
//! R: the rigid motions of the bodies. They lie in the bodies' spaces, so that on them row j of a tie is
//!
//!   ∫ ψ_j d . (u_slave - u_master) ds = d . (t_s - t_m) ∫ ψ_j ds + ...  ∫ ψ_j (x - c) ds,
//!
//! whatever the functions of the sides are: both bodies are evaluated at the points of the slave, so that sides that are slightly apart
//! hold no more than sides that touch. Counting rows or points is not enough: one constant per component has a row for each translation and
//! lets the body rotate about the middle of the side.

use super::Builder;
use super::model::{ContactPart, Model, TiePart};
use super::rigid::{MOST, RigidForm, RigidModes, RigidRow};
use super::supports::{RigidBodies, Ties, contact_points, contact_terms, held_by, tie_points, unit};
use crate::place::Place;
use crate::registry::is_glue;
use faying::basis::{Order, ShapeTable};
use faying::contact::{Cone, Contact};
use faying::geometry::MapTable;
use faying::linalg::Vector;
use nalgebra::DMatrix;

/// Parts whose relative motion is below this fraction of the largest are not named.
const STILL: f64 = 1e-3;

/// Integrals of a multiplier function over the part of its slave side paired with one master.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FunctionSums<const N: usize> {
    /// ∫ ψ ds.
    pub sum: f64,
    /// ∫ ψ (x - middle of the slave's patch) ds \[length\].
    pub lever: Vector<N>,
    /// ∫ |ψ| ds.
    pub size: f64,
}

/// Reference point for levers of a patch: the centre of its bounding box.
fn origin<const S: usize, const N: usize>(model: &Model<S, N>, patch: usize) -> Vector<N> {
    model.patches[patch].extent.map_or(model.center, |b| b.center())
}

/// Integrates the multiplier functions of a tie: per master, component after component, in the order of its rows.
pub(super) fn function_sums<const S: usize, const N: usize>(model: &Model<S, N>, part: &TiePart<S, N>) -> Vec<Vec<FunctionSums<N>>> {
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

/// Returns the rows of a tie on rigid motions, as means over each function; empty if the rows are not mortar rows.
pub(super) fn tie_forms<const S: usize, const N: usize>(
    model: &Model<S, N>,
    modes: &RigidModes<N>,
    bodies: &RigidBodies,
    part: &TiePart<S, N>,
) -> Vec<RigidForm> {
    let (origin, slave) = (origin(model, part.slave.patch), bodies.of_patch(model, part.slave.patch));
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
                let master = bodies.of_patch(model, pairing.master.patch);
                form.push((master, modes.sums(master, &direction, -sum, &-lever, &origin)));
            }
            forms.push(form);
        }
        row += psi.num_functions();
    }
    forms
}

/// Returns every row of a contact on rigid motions with ∫ |ψ| ds; for Nitsche's method one per point, with 1.
pub(super) fn contact_forms<const S: usize, const N: usize>(
    model: &Model<S, N>,
    modes: &RigidModes<N>,
    bodies: &RigidBodies,
    contact_number: usize,
    part: &ContactPart<S, N>,
    contact: &Contact<S, N>,
) -> Vec<(RigidForm, f64)> {
    let segments = &contact.segments;
    let push = |q: usize| {
        modes.form(&RigidRow { terms: contact_terms(model, bodies, contact_number, part, contact, q), direction: contact.frames.normal[q] })
    };
    let Some(multiplier) = &part.multiplier else {
        // rows of Nitsche's method act at their points
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

fn add(sum: &mut RigidForm, body: usize, own: &[f64; MOST], weight: f64) {
    let place = sum.iter().position(|t| t.0 == body).unwrap_or_else(|| {
        sum.push((body, [0.0; MOST]));
        sum.len() - 1
    });
    sum[place].1.iter_mut().zip(own).for_each(|(s, v)| *s += weight * v);
}

/// Returns the rows of all contacts, closed, on rigid motions: as means over each function.
pub(super) fn closed_forms<const S: usize, const N: usize>(
    model: &Model<S, N>,
    modes: &RigidModes<N>,
    bodies: &RigidBodies,
) -> Vec<RigidForm> {
    let mut all = Vec::new();
    for (k, contact) in model.contacts.iter().enumerate() {
        for part in &contact.parts {
            // functions that face nothing have no row; rows of other cones mix functions
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

/// Reports E024 for every interface whose multiplier functions allow a rigid motion that its points would prevent.
///
/// Precondition: the points of ties and closed contacts leave no rigid motion.
pub(super) fn check<const S: usize, const N: usize>(builder: &mut Builder<'_, S, N>, model: &Model<S, N>, bodies: &RigidBodies) {
    if model.rows == 0 {
        return;
    }
    let (modes, mut forms) = held_by(model, bodies, &model.springs, Ties::Functions);
    forms.extend(closed_forms(model, &modes, bodies));
    let left = modes.null(&forms);
    if left.ncols() == 0 {
        return;
    }
    let free = modes.names(&left);
    let case = builder.case;
    // largest separation of the points of an interface
    let most = |forms: Vec<RigidForm>| forms.iter().map(|f| moved(&modes, f, &left)).fold(0.0, f64::max);
    let mut loose = Vec::new();
    for (tie, read) in model.ties.iter().zip(case.interfaces.iter().filter(|t| !is_glue(&t.coupling.value))) {
        for part in &tie.parts {
            let masters = part.pairings.iter().map(|p| p.master.patch).collect();
            let functions = part.multipliers.iter().map(|m| m.num_functions()).max().unwrap_or(0);
            let apart = most(tie_points(model, &modes, bodies, part));
            loose.push(Loose {
                name: &tie.name,
                slave: &part.slave.label,
                patches: (part.slave.patch, masters),
                functions,
                along: " per component",
                apart,
                at: read.multiplier.at,
            });
        }
    }
    for (k, contact) in model.contacts.iter().enumerate() {
        let Some(read) = case.contacts.iter().find(|c| c.name.value == contact.name) else { continue };
        for part in &contact.parts {
            let Some(psi) = &part.multiplier else { continue };
            let masters = part.masters.iter().map(|m| m.patch).collect();
            let apart = most(contact_points(model, &modes, bodies, k, part, &part.first, &|_| true));
            let patches = (part.slave.patch, masters);
            loose.push(Loose {
                name: &contact.name,
                slave: &part.slave.label,
                patches,
                functions: psi.num_functions(),
                along: " along the normal",
                apart,
                at: read.multiplier.at,
            });
        }
    }
    let largest = loose.iter().map(|l| l.apart).fold(0.0, f64::max);
    for l in loose.iter().filter(|l| l.apart > STILL * largest) {
        let moving = |patch: &usize| free.iter().find(|f| f.body == bodies.of_patch(model, *patch)).map(|f| (*patch, f));
        let Some((patch, body)) = moving(&l.patches.0).or_else(|| l.patches.1.iter().find_map(moving)) else { continue };
        let (slave, name) = (&model.patches[l.patches.0].name, &model.patches[patch].name);
        let closed = if model.contacts.is_empty() { "" } else { ", even with every contact closed" };
        let number = if l.functions == 1 { "one function".to_string() } else { format!("{} functions", l.functions) } + l.along;
        let text = format!(
            "the multiplier of \"{}\" on `{}` has too few functions ({number}) to hold body \"{name}\", which can still move: {}{closed}",
            l.name,
            l.slave,
            body.motions.join(", ")
        );
        let help =
            format!("give patch \"{slave}\" more elements along `{}`, or take a multiplier with more functions, such as p/p", l.slave);
        let fault = builder.error("E024", text, l.at).with_help(help);
        builder.faults.push(fault);
    }
}

/// Slave side, and its largest separation from the masters by the remaining rigid motions.
struct Loose<'a> {
    name: &'a str,
    slave: &'a str,
    /// Patch of the slave, and those of its masters.
    patches: (usize, Vec<usize>),
    functions: usize,
    /// End of the function count in messages: " per component", " along the normal".
    along: &'static str,
    apart: f64,
    at: Place,
}

/// Norm of a form applied to the motions in the columns of `motions`.
fn moved<const N: usize>(modes: &RigidModes<N>, form: &RigidForm, motions: &DMatrix<f64>) -> f64 {
    let m = modes.modes();
    let of =
        |column: usize| -> f64 { form.iter().flat_map(|(body, own)| (0..m).map(move |k| own[k] * motions[(m * body + k, column)])).sum() };
    (0..motions.ncols()).map(|k| of(k) * of(k)).sum::<f64>().sqrt()
}
