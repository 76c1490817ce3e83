//! Rigid motions that are left to a system, by bodies and obstacles.

use super::closed_points::closed_points;
use super::error::{ErrorKind, ProblemError, ProblemErrors};
use super::handles::Statement;
use super::model::{ContactModel, Model};
use super::rigid::RemainingMotions;
use super::rigid_bodies::RigidBodies;
use super::rigid_rows::closed_forms;
use super::supports::{Ties, free_motions, motion_texts, remaining_motions_with, rigid_forms};
use std::collections::HashSet;

/// A body, or an obstacle that a force presses, that can still move as a rigid body.
#[derive(Clone, Debug, PartialEq)]
pub struct RigidMotion {
    /// The body, or the contact of the obstacle.
    pub of: Statement,
    /// Names of its motions: "translation x", "rotation", "rotation about (0, 1)", "constant".
    pub motions: Vec<String>,
    /// A sentence about them: `body "upper" can still move: translation x, rotation`.
    pub sentence: String,
}

impl<const S: usize, const N: usize> Model<S, N> {
    /// Motions that are left with all points of ties held and all contacts closed, at the first of `times` that leaves any.
    pub(super) fn rigid_motions(&self, times: &[f64]) -> Vec<RigidMotion> {
        self.motions(self.left_by_points(times))
    }

    fn left_by_points(&self, times: &[f64]) -> Vec<RemainingMotions> {
        let first: Vec<Vec<_>> = self.contacts.iter().map(|c| c.parts.iter().map(|p| &p.first).collect()).collect();
        self.first_left(times, |t| remaining_motions_with(self, t, &first, &|_, _, _| true, Ties::Points))
    }

    /// Motions at the first of `times` that leaves any: springs and foundations may vanish at some of them.
    fn first_left(&self, times: &[f64], left: impl Fn(f64) -> Vec<RemainingMotions>) -> Vec<RemainingMotions> {
        let changes = self.springs.iter().any(|s| s.stiffness.depends_on_time()) || self.foundations_change(None);
        let times = if changes { times } else { &times[..times.len().min(1)] };
        times.iter().map(|t| left(*t)).find(|free| !free.is_empty()).unwrap_or_default()
    }

    /// Checks that nothing can move as a rigid body with every contact closed: neither where points of ties hold nor where only the
    /// functions of multipliers do, at all `times`.
    pub(super) fn held(&self, times: &[f64]) -> Result<(), ProblemErrors> {
        let mut free = self.left_by_points(times);
        if free.is_empty() {
            let bodies = RigidBodies::of(self);
            free = self.first_left(times, |t| {
                let (modes, mut forms) = rigid_forms(self, &bodies, Some(t), Ties::Functions);
                forms.extend(closed_forms(self, &modes, &bodies));
                let left = modes.names(&modes.null(&forms)).into_iter();
                left.map(|f| bodies.numbered(self, &modes, f)).collect()
            });
        }
        if free.is_empty() { Ok(()) } else { Err(ProblemError::named(ErrorKind::Motions(motion_texts(self, &free)), &[]).into()) }
    }

    /// Motions that are left at time `t` with the contact rows `open`, all others closed.
    pub(super) fn motions_with_open(&self, t: f64, open: &[usize]) -> Vec<RigidMotion> {
        let open: HashSet<usize> = open.iter().copied().collect();
        let at_time =
            |c: &ContactModel<S, N>| -> Vec<_> { c.parts.iter().map(|p| c.at(self, p, t).unwrap_or_else(|_| p.first.clone())).collect() };
        let contacts: Vec<Vec<_>> = self.contacts.iter().map(at_time).collect();
        let contacts: Vec<Vec<_>> = contacts.iter().map(|c| c.iter().collect()).collect();
        // a point counts as closed if an enforced function is active there
        let closed = closed_points(self, &contacts, &|row| !open.contains(&row));
        self.motions(free_motions(self, t, &contacts, &|k, p, q| closed[k][p][q]))
    }

    fn motions(&self, free: Vec<RemainingMotions>) -> Vec<RigidMotion> {
        let sentences = motion_texts(self, &free);
        let of = |f: &RemainingMotions| match f.body.checked_sub(self.patches.len()) {
            Some(contact) => self.contacts[contact].id.into(),
            None => self.patches[f.body].id.into(),
        };
        free.into_iter().zip(sentences).map(|(f, sentence)| RigidMotion { of: of(&f), motions: f.motions, sentence }).collect()
    }
}
