//! Multipliers whose functions hold less than their points would.

use super::warning::{Subject, Warning};
use crate::problem::model::Model;
use crate::problem::rigid::{RigidForm, RigidModes};
use crate::problem::rigid_bodies::RigidBodies;
use crate::problem::rigid_rows::closed_forms;
use crate::problem::supports::{Ties, contact_points, rigid_forms, tie_points};
use nalgebra::DMatrix;

/// Parts whose relative motion is below this fraction of the largest are not named.
const STILL: f64 = 1e-3;

/// Slave side, and its largest separation from the masters by the remaining rigid motions.
struct Loose<'a> {
    of: Subject,
    slave: &'a str,
    /// Patch of the slave, and those of its masters.
    patches: (usize, Vec<usize>),
    functions: usize,
    apart: f64,
}

impl<const S: usize, const N: usize> Model<S, N> {
    /// [`Warning::TooFewFunctions`] of every interface whose points would hold what its functions do not; of models whose bodies are held
    /// by the points of ties and closed contacts at time `t`.
    pub fn too_few_functions(&self, t: f64) -> Vec<Warning> {
        if self.rows == 0 {
            return Vec::new();
        }
        let bodies = RigidBodies::of(self);
        let (modes, mut forms) = rigid_forms(self, &bodies, Some(t), Ties::Functions);
        forms.extend(closed_forms(self, &modes, &bodies));
        let left = modes.null(&forms);
        if left.ncols() == 0 {
            return Vec::new();
        }
        let free = modes.names(&left);
        let loose = loose(self, &bodies, &modes, &left);
        let largest = loose.iter().map(|l| l.apart).fold(0.0, f64::max);
        let warning = |l: Loose<'_>| {
            let moving = |patch: &usize| free.iter().find(|f| f.body == bodies.of_patch(*patch)).map(|f| (*patch, f));
            let (patch, body) = moving(&l.patches.0).or_else(|| l.patches.1.iter().find_map(moving))?;
            Some(Warning::TooFewFunctions {
                of: l.of,
                slave: l.slave.to_owned(),
                slave_body: Subject::body(self, l.patches.0),
                functions: l.functions,
                body: Subject::body(self, patch),
                motions: body.motions.clone(),
            })
        };
        loose.into_iter().filter(|l| l.apart > STILL * largest).filter_map(warning).collect()
    }
}

/// All slave sides with multipliers, of ties and of contacts; `left`: the motions that their functions leave.
fn loose<'a, const S: usize, const N: usize>(
    model: &'a Model<S, N>,
    bodies: &RigidBodies,
    modes: &RigidModes<N>,
    left: &DMatrix<f64>,
) -> Vec<Loose<'a>> {
    // largest separation of the points of an interface
    let most = |forms: Vec<RigidForm>| forms.iter().map(|f| moved(modes, f, left)).fold(0.0, f64::max);
    let mut loose = Vec::new();
    for (k, tie) in model.ties.iter().enumerate() {
        for part in &tie.parts {
            loose.push(Loose {
                of: Subject::tie(model, k),
                slave: &part.slave.label,
                patches: (part.slave.patch, part.pairings.iter().map(|p| p.master.patch).collect()),
                functions: part.multipliers.iter().map(|m| m.num_functions()).max().unwrap_or(0),
                apart: most(tie_points(model, modes, bodies, part)),
            });
        }
    }
    for (k, contact) in model.contacts.iter().enumerate() {
        for part in &contact.parts {
            let Some(psi) = &part.multiplier else { continue };
            loose.push(Loose {
                of: Subject::contact(model, k),
                slave: &part.slave.label,
                patches: (part.slave.patch, part.masters.iter().map(|m| m.patch).collect()),
                functions: psi.num_functions(),
                apart: most(contact_points(model, modes, bodies, k, part, &part.first, &|_| true)),
            });
        }
    }
    loose
}

/// Norm of a form applied to the motions in the columns of `motions`.
fn moved<const N: usize>(modes: &RigidModes<N>, form: &RigidForm, motions: &DMatrix<f64>) -> f64 {
    let m = modes.modes();
    let of =
        |column: usize| -> f64 { form.iter().flat_map(|(body, own)| (0..m).map(move |k| own[k] * motions[(m * body + k, column)])).sum() };
    (0..motions.ncols()).map(|k| of(k) * of(k)).sum::<f64>().sqrt()
}
