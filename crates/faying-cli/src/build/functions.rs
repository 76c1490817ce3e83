//! Whether the functions of multipliers hold the bodies that their points would hold.

use super::builder::Builder;
use super::built::Built;
use crate::place::Place;
use crate::registry::is_glue;
use faying::problem::{RigidBodies, RigidForm, RigidModes, Ties, closed_forms, contact_points, held_by, tie_points};
use nalgebra::DMatrix;

/// Parts whose relative motion is below this fraction of the largest are not named.
const STILL: f64 = 1e-3;

/// E024 for every interface whose points would hold what its functions do not.
///
/// To be asked where the points of ties and closed contacts leave no motion.
pub fn check<const S: usize, const N: usize>(builder: &mut Builder<'_, S, N>, model: &Built<S, N>, bodies: &RigidBodies) {
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
        let moving = |patch: &usize| free.iter().find(|f| f.body == bodies.of_patch(*patch)).map(|f| (*patch, f));
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
