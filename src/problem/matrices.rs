//! Matrices of a model at a given time: one per body, and the coupling matrix of ties and contacts.

use super::data::Point;
use super::model::Model;
use super::state::StepError;
use super::tie_fluxes::between;
use crate::assembly::Blocks;
use crate::linalg::{Csr, Vector};
use std::borrow::Cow;

/// Stiffness of every body at a given time, springs and foundations included.
#[derive(Clone, Debug)]
pub struct Stiffness {
    matrices: Matrices,
    changes: Vec<bool>,
    t: f64,
}

/// Matrices of a model at a given time.
#[derive(Clone, Debug)]
pub struct Matrices {
    /// One per body, springs and foundations included.
    pub bodies: Vec<Csr>,
    /// Stiffness of ties and contacts between the bodies, in all unknowns.
    pub(super) between: Option<Csr>,
    /// Error of a tie or a contact that has no stiffness at this time.
    pub(super) fault: Option<StepError>,
}

impl Stiffness {
    /// Assembles all bodies at time `t`.
    pub fn new<const S: usize, const N: usize>(model: &Model<S, N>, t: f64) -> Self {
        let springs = |k: usize| {
            model.springs.iter().any(|s| s.side.patch == k && s.stiffness.depends_on_time()) || model.foundations_change(Some(k))
        };
        let (between, fault) = added(model, t, true);
        Self {
            matrices: Matrices { bodies: (0..model.patches.len()).map(|k| assembled(model, k, t)).collect(), between, fault },
            changes: (0..model.patches.len()).map(|k| model.patches[k].changing.is_some() || springs(k)).collect(),
            t,
        }
    }

    /// Returns the matrices at time `t`: those of bodies whose material, springs and foundations do not change are kept.
    pub fn at<const S: usize, const N: usize>(&mut self, model: &Model<S, N>, t: f64) -> &Matrices {
        if t != self.t {
            for k in (0..self.changes.len()).filter(|&k| self.changes[k]) {
                self.matrices.bodies[k] = assembled(model, k, t);
            }
            let contacts = model.contacts.iter().flat_map(|c| &c.parts).any(|part| part.changes && part.first.stiffness.is_some());
            if contacts || model.ties.iter().flat_map(|tie| &tie.parts).any(|part| part.changes(model)) {
                (self.matrices.between, self.matrices.fault) = added(model, t, false);
            }
            self.t = t;
        }
        &self.matrices
    }
}

impl Matrices {
    /// Calls `use_them` with the blocks of the bodies and of the obstacles that forces press, and what lies between them.
    ///
    /// # Errors
    /// [`StepError`] of a tie or a contact that has no stiffness at this time.
    pub(super) fn with_blocks<const S: usize, const N: usize, R>(
        &self,
        model: &Model<S, N>,
        use_them: impl FnOnce(Blocks<'_>) -> R,
    ) -> Result<R, StepError> {
        if let Some(fault) = &self.fault {
            return Err(fault.clone());
        }
        let obstacles = model.has_pressed().then(|| model.pressed_block());
        let bodies: Vec<&Csr> = self.bodies.iter().chain(&obstacles).collect();
        Ok(use_them(Blocks { bodies: &bodies, between: self.between.as_ref() }))
    }
}

/// Stiffness of ties and contacts at time `t`; `first`: of ties as it was found when the model was built.
fn added<const S: usize, const N: usize>(model: &Model<S, N>, t: f64, first: bool) -> (Option<Csr>, Option<StepError>) {
    let mut parts = Vec::new();
    for part in model.ties.iter().flat_map(|tie| &tie.parts) {
        match if first || !part.changes(model) { Ok(Cow::Borrowed(&part.stiffness)) } else { part.stiffness_at(model, t).map(Cow::Owned) } {
            Ok(entries) => parts.push(entries),
            Err(fault) => return (None, Some(fault.into())),
        }
    }
    for contact in &model.contacts {
        for part in contact.parts.iter().filter(|part| part.first.stiffness.is_some()) {
            match contact.at(model, part, t) {
                Ok(built) => parts.extend(built.stiffness.map(Cow::Owned)),
                Err(fault) => return (None, Some(fault.into())),
            }
        }
    }
    (between(model, parts.iter().map(|p| &**p)), None)
}

/// Assembles the stiffness of body `k` at time `t`.
fn assembled<const S: usize, const N: usize>(model: &Model<S, N>, k: usize, t: f64) -> Csr {
    let (patch, physics) = (&model.patches[k], model.patches[k].physics_at(t));
    let mut matrix = physics.stiffness(&**patch.body.space(), &patch.rules, model.foundation(k, t).as_deref());
    for spring in model.springs.iter().filter(|s| s.side.patch == k) {
        let value = |x: &Vector<N>| spring.stiffness.value(&Point::new(x.as_slice()).at_time(t));
        physics.springs(&spring.side.trace, &spring.side.rules, spring.component, &value, &mut matrix);
    }
    matrix
}
