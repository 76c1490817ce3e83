//! The system of a problem at a time and a state: stiffness, load and rows, for any solver of constrained systems.

use super::blocked::blocked;
use super::data::Point;
use super::enforced::Enforced;
use super::equilibrium::{Unheld, unheld};
use super::integrate::{on_trace, over_side};
use super::loads::Loads;
use super::model::Model;
use super::resultant::Resultant;
use super::state::{NO_CONTACT, StepError, StepState};
use super::system::InterfaceSystem;
use crate::assembly::{Blocks, Reduced};
use crate::constraint::{ConstrainedSolution, ConstrainedSystem, RowKind, sign_case_of_rows};
use crate::coupling::Rows;
use std::sync::Arc;

/// The system of a [`System`](super::System) at a time:
///
/// ```text
/// K u + Bᵀ lambda = f,   rows C u + g: zero, compliant, or a non-negative gap
/// ```
///
/// in the unknowns that supports leave free. Solve [`constrained`](Linearised::constrained) by any means and give the answer to
/// [`System::accept`](super::System::accept).
#[derive(Debug)]
pub struct Linearised<const S: usize, const N: usize> {
    pub(super) model: Arc<Model<S, N>>,
    pub(super) inner: StepSystem<S, N>,
}

impl<const S: usize, const N: usize> Linearised<S, N> {
    /// Its matrices, load, rows and their kinds. Rows that a method makes exact by an iteration are exact rows here.
    pub fn constrained(&self) -> ConstrainedSystem<'_> {
        self.inner.constrained()
    }

    /// First guess of the closed rows, one flag per row.
    pub fn start(&self) -> &[bool] {
        &self.inner.interface.start
    }

    /// Number of free unknowns, the size of K.
    pub fn unknowns(&self) -> usize {
        self.inner.reduced.num_free()
    }

    /// Its time.
    pub fn time(&self) -> f64 {
        self.inner.t
    }
}

/// The system of a model at a time.
#[derive(Debug)]
pub(super) struct StepSystem<const S: usize, const N: usize> {
    pub(super) t: f64,
    loads: Loads,
    total: Resultant,
    pub(super) interface: InterfaceSystem<S, N>,
    pub(super) reduced: Reduced,
    /// C, B and g in the free unknowns.
    rows: Rows,
    reaction: Option<Rows>,
    offset: Vec<f64>,
    pub(super) enforced: Enforced,
}

impl<const S: usize, const N: usize> StepSystem<S, N> {
    /// Assembles the system with obstacles displaced by their entries of `place`, the active set started as it ended in `before`.
    pub(super) fn of(
        model: &Model<S, N>,
        matrices: Blocks<'_>,
        t: f64,
        before: Option<&StepState<S, N>>,
        place: Option<&[f64]>,
    ) -> Result<Self, StepError> {
        let prescribed = model.prescribed(t).map_err(|e| e.0)?;
        let loads = model.loads(t);
        let mut total = Resultant::default();
        loads.totals.iter().for_each(|own| total.sum(own));
        let interface = InterfaceSystem::of(model, t, before, place)?;
        let reduced = Reduced::try_new(matrices, &loads.vector, &prescribed, &model.all_equations())?;
        let (slave, shift) = reduced.rows(&interface.rows.slave);
        let (master, shift_master) = reduced.rows(&interface.rows.master);
        let offset: Vec<f64> = (0..model.rows).map(|i| interface.offset[i] + shift[i] + shift_master[i]).collect();
        let rows = Rows { slave, master };
        if let Some(error) = blocked(model, &interface, &rows, &offset) {
            return Err(error);
        }
        let enforced = Enforced::of(model, &matrices, &interface.rows, &interface.contacts, before.is_none())?;
        let reaction = interface.reaction.as_ref().map(|b| Rows { slave: reduced.rows(&b.slave).0, master: reduced.rows(&b.master).0 });
        Ok(Self { t, loads, total, interface, reduced, rows, reaction, offset, enforced })
    }

    pub(super) fn constrained(&self) -> ConstrainedSystem<'_> {
        ConstrainedSystem {
            stiffness: &self.reduced.stiffness,
            load: &self.reduced.load,
            constraint: &self.rows,
            reaction: self.reaction.as_ref(),
            offset: &self.offset,
            kind: &self.interface.kind,
            compliance: &self.enforced.compliance,
        }
    }

    pub(super) fn has_contact(&self) -> bool {
        self.interface.kind.iter().any(|k| *k != RowKind::Equal)
    }

    /// Loads that no contact pressure balances; none where one does.
    pub(super) fn unheld_load(&self, model: &Model<S, N>) -> Option<Unheld> {
        let pushes: Vec<_> = self.loads.totals.iter().map(|r| (r.force, r.moment)).collect();
        unheld(model, self.t, &self.interface.contacts, &pushes, self.loads.vector.iter().map(|f| f.abs()).sum())
    }

    /// The state of the model with a solution of the system; `matrices`: those that it was assembled with.
    pub(super) fn finished(&self, model: &Model<S, N>, matrices: Blocks<'_>, solution: ConstrainedSolution) -> StepState<S, N> {
        let sign_case = sign_case_of_rows(&self.constrained(), &solution).into_iter().map(|case| case.unwrap_or(NO_CONTACT)).collect();
        let mut total = self.total;
        let u = self.reduced.expand(&solution.unknowns);
        let b = self.interface.reaction.as_ref().unwrap_or(&self.interface.rows);
        let mut support = self.reduced.residual(matrices, &self.loads.vector, &[&b.slave, &b.master], &solution.multipliers, &u);
        model.glued.gather(&mut support);
        // restoring forces of the springs
        for spring in &model.springs {
            let field = model.patches[spring.side.patch].field;
            over_side(&spring.side, |e, xi, x, _, ds| {
                let value = on_trace(&spring.side.trace, field, &u, e, &[*xi])[0];
                let mut force = [0.0; 3];
                force[spring.component] = -spring.stiffness.value(&Point::new(x.as_slice()).at_time(self.t)) * value[spring.component];
                total.add(x, &force, ds);
            });
        }
        total.sum(&model.foundation_forces(&u, self.t));
        let mut lambda = solution.multipliers.clone();
        for (contact, built) in model.contacts.iter().zip(&self.interface.contacts) {
            for (part, rows) in contact.parts.iter().zip(built) {
                let range = part.rows();
                let turned = rows.multipliers(&lambda[range.clone()]);
                lambda[range].copy_from_slice(&turned);
            }
        }
        StepState {
            t: self.t,
            u,
            lambda,
            mu: solution.multipliers,
            active: solution.active,
            contacts: self.interface.contacts.clone(),
            support,
            load: total,
            loads: self.loads.sums.clone(),
            free: self.reduced.num_free(),
            residual: solution.residual,
            condition: solution.condition,
            method: solution.method,
            iterations: solution.iterations,
            factors: 0,
            active_set: solution.active_set,
            sign_case,
        }
    }
}
