//! Force-driven obstacles: their unknowns in the system, and the iteration for their position of equilibrium.
//!
//! The rows of a contact depend on the position of its obstacle, which the solution changes. The contact is built again in the new position
//! until neither rows nor gaps change. The rows of half-planes do not depend on it: they are solved once.

use super::matrices::Matrices;
use super::model::{ContactModel, Model};
use super::observer::Observer;
use super::solve::once;
use super::solver::ProblemSolver;
use super::state::{StepError, StepState, Unsolved};
use crate::constraint::ActiveSetReport;
use crate::contact::ContactRows;
use crate::linalg::{Csr, Triplets, Vector};

/// Largest number of positions at which a contact is built.
const MOST_PLACES: usize = 40;
/// Relative change of rows and gaps below which the position is the same.
const SAME_PLACE: f64 = 1e-12;
/// Round-off of gaps, which are differences of coordinates, as a fraction of the model's size.
const GAP_ROUNDING: f64 = 4.0 * f64::EPSILON;

impl<const S: usize, const N: usize> Model<S, N> {
    /// Whether a contact has a force-driven obstacle.
    pub(super) fn has_pressed(&self) -> bool {
        self.contacts.iter().any(ContactModel::is_pressed)
    }

    /// Returns the matrix of the obstacles' unknowns, which is zero: only contact resists them.
    pub(super) fn pressed_block(&self) -> Csr {
        let places: Vec<[f64; 3]> = self
            .contacts
            .iter()
            .flat_map(|c| {
                // placed in the middle of the points that it may touch
                let x = || c.parts.iter().flat_map(|p| &p.first.frames.x);
                let middle = x().fold(Vector::<N>::zeros(), |s, x| s + x) / x().count().max(1) as f64;
                let place: [f64; 3] = std::array::from_fn(|k| if k < N { middle[k] } else { 0.0 });
                c.obstacle.iter().flat_map(|o| &o.pressed).map(move |_| place)
            })
            .collect();
        let n = places.len();
        let cols = (0..n).map(|k| u32::try_from(k).expect("a few unknowns")).collect();
        Csr::from_parts(n, (0..=n).collect(), cols, vec![0.0; n]).with_dof_coordinates(places)
    }
}

/// Solves by [`once`], and again at the new place of the obstacles until they stay.
///
/// # Errors
/// As [`once`]; [`StepError::Obstacle`] if the positions do not converge.
pub(super) fn at_rest<const S: usize, const N: usize>(
    model: &Model<S, N>,
    matrices: &Matrices,
    solver: &mut ProblemSolver,
    t: f64,
    before: Option<&StepState<S, N>>,
    observer: Observer<'_>,
) -> Result<StepState<S, N>, Unsolved<Box<StepState<S, N>>>> {
    let mut state = once(model, matrices, solver, t, before, before.map(|b| b.u.as_slice()), observer)?;
    if !model.has_pressed() {
        return Ok(state);
    }
    for _ in 0..MOST_PLACES {
        let mut there = Vec::with_capacity(model.contacts.len());
        for contact in &model.contacts {
            let parts = contact.parts.iter().map(|part| contact.at_place(model, part, t, Some(&state.u)));
            there.push(parts.collect::<Result<Vec<_>, _>>()?);
        }
        let moved = state.u.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let tolerance = SAME_PLACE * moved + GAP_ROUNDING * (model.size + model.center.norm());
        let same = state.contacts.iter().flatten().zip(there.iter().flatten()).all(|(a, b)| agree(a, b, &state.u, tolerance));
        if same {
            state.contacts = there;
            return Ok(state);
        }
        let mut next = once(model, matrices, solver, t, Some(&state), Some(&state.u), observer)?;
        // one history over all places
        if let (Some(known), Some(new)) = (state.active_set.take(), &mut next.active_set) {
            *new = together(known, new);
        }
        next.iterations += state.iterations;
        next.factors += state.factors;
        state = next;
    }
    Err(Unsolved { error: StepError::Obstacle { places: MOST_PLACES }, best: Some(Box::new(state)) })
}

fn together(mut known: ActiveSetReport, new: &ActiveSetReport) -> ActiveSetReport {
    known.iterations += new.iterations;
    known.history.extend(&new.history);
    known.sets.extend(&new.sets);
    known.sign_cases.extend(&new.sign_cases);
    known
}

/// Whether the contact in another position has the same rows, and the same gaps up to `tolerance` for the unknowns `u`.
fn agree<const S: usize, const N: usize>(a: &ContactRows<S, N>, b: &ContactRows<S, N>, u: &[f64], tolerance: f64) -> bool {
    let rows = |a: &Triplets, b: &Triplets| {
        let largest = a.entries.iter().fold(0.0_f64, |m, e| m.max(e.2.abs()));
        a.entries.len() == b.entries.len()
            && a.entries.iter().zip(&b.entries).all(|(x, y)| (x.0, x.1) == (y.0, y.1) && (x.2 - y.2).abs() <= SAME_PLACE * largest)
    };
    let gaps = || {
        a.lumped_gap(u).into_iter().zip(b.lumped_gap(u)).all(|pair| match pair {
            (Some(x), Some(y)) => (x - y).abs() <= tolerance,
            (x, y) => x.is_none() && y.is_none(),
        })
    };
    a.facing == b.facing && rows(&a.rows.slave, &b.rows.slave) && rows(&a.rows.master, &b.rows.master) && gaps()
}
