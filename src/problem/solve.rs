//! Assembly and solution of the system of a problem at a time.

use super::compliance::Softness;
use super::data::Point;
use super::equilibrium::{Unheld, unheld};
use super::integrate::on_trace;
use super::loads::Loads;
use super::matrices::Matrices;
use super::model::Model;
use super::observer::{Observer, Progress};
use super::resultant::Resultant;
use super::solver::Solver;
use super::state::{NO_CONTACT, StepError, StepState, Unsolved};
use super::system::InterfaceSystem;
use crate::assembly::{Blocks, Reduced};
use crate::constraint::{ConstrainedSolution, ConstrainedSystem, ConstraintSolver, RowKind, SolveError, sign_case_of_rows, verified};
use crate::coupling::Rows;
use crate::linalg::{Csr, LinearError};

/// The system of a model at a time.
struct StepSystem<'a, const S: usize, const N: usize> {
    matrices: Blocks<'a>,
    loads: Loads,
    total: Resultant,
    interface: InterfaceSystem<S, N>,
    reduced: Reduced,
    /// C, B and g in the free unknowns.
    rows: Rows,
    reaction: Option<Rows>,
    offset: Vec<f64>,
    softness: Softness,
}

/// Solves the system with obstacles displaced by their entries of `place`, the active set started as it ended in `before`.
pub(super) fn once<const S: usize, const N: usize>(
    model: &Model<S, N>,
    matrices: &Matrices,
    solver: &mut Solver,
    t: f64,
    before: Option<&StepState<S, N>>,
    place: Option<&[f64]>,
    observer: Observer<'_>,
) -> Result<StepState<S, N>, Unsolved<Box<StepState<S, N>>>> {
    if let Some(fault) = &matrices.fault {
        return Err(fault.clone().into());
    }
    let obstacles = model.has_pressed().then(|| model.pressed_block());
    let bodies: Vec<&Csr> = matrices.bodies.iter().chain(&obstacles).collect();
    let system = StepSystem::of(model, Blocks { bodies: &bodies, between: matrices.between.as_ref() }, t, before, place)?;
    if observer(&Progress::System).is_break() {
        return Err(SolveError::Stopped { iterations: 0, best: None }.into());
    }
    let factors = solver.set.inner.factors();
    let missing = if system.has_contact() { system.unheld_load(model) } else { None };
    // backtracking does not help if no pressure balances the loads
    let solved = system.solved(model, solver, before.is_some(), missing.is_none(), observer);
    let factors = solver.set.inner.factors() - factors;
    let finish = |solution: ConstrainedSolution| {
        if let Some(report) = &solution.active_set {
            // a request to stop finds the system solved
            let _ = observer(&Progress::ActiveSet(report));
        }
        StepState { factors, ..system.finished(model, solution, t) }
    };
    solved.map(&finish).map_err(|error| {
        let usable = |l: &ConstrainedSolution| l.unknowns.len() == system.reduced.num_free() && l.multipliers.len() == model.rows;
        let last = last_iterate(&error).filter(|l| usable(l)).map(|l| Box::new(finish(*l)));
        Unsolved { error: explained(error, missing), best: last }
    })
}

/// Returns the error of a step whose system ended with `error`: where no pressure balances the loads, that is why.
fn explained(error: SolveError, missing: Option<Unheld>) -> StepError {
    match (missing, StepError::from(error)) {
        (Some(Unheld { what, coarse }), StepError::Solve(e)) if !matches!(e, SolveError::Stopped { .. }) => {
            if coarse {
                StepError::Coarse { what }
            } else {
                StepError::Infeasible { what }
            }
        }
        (_, error) => error,
    }
}

impl<'a, const S: usize, const N: usize> StepSystem<'a, S, N> {
    /// Assembles the system with obstacles displaced by their entries of `place`.
    fn of(
        model: &Model<S, N>,
        matrices: Blocks<'a>,
        t: f64,
        before: Option<&StepState<S, N>>,
        place: Option<&[f64]>,
    ) -> Result<Self, Unsolved<Box<StepState<S, N>>>> {
        let prescribed = model.prescribed(t).map_err(|e| Unsolved::<Box<StepState<S, N>>>::from(e.0))?;
        let loads = model.loads(t);
        let mut total = Resultant::default();
        loads.totals.iter().for_each(|own| total.sum(own));
        let interface = InterfaceSystem::of(model, t, before, place)?;
        let reduced = Reduced::try_new(matrices, &loads.vector, &prescribed, &model.all_equations())?;
        let (slave, shift) = reduced.rows(&interface.rows.slave);
        let (master, shift_master) = reduced.rows(&interface.rows.master);
        let offset: Vec<f64> = (0..model.rows).map(|i| interface.offset[i] + shift[i] + shift_master[i]).collect();
        let softness = Softness::of(model, &matrices, &interface.rows, &interface.contacts);
        let reaction = interface.reaction.as_ref().map(|b| Rows { slave: reduced.rows(&b.slave).0, master: reduced.rows(&b.master).0 });
        Ok(Self { matrices, loads, total, interface, reduced, rows: Rows { slave, master }, reaction, offset, softness })
    }

    fn constrained(&self) -> ConstrainedSystem<'_> {
        ConstrainedSystem {
            stiffness: &self.reduced.stiffness,
            load: &self.reduced.load,
            constraint: &self.rows,
            reaction: self.reaction.as_ref(),
            offset: &self.offset,
            kind: &self.interface.kind,
            compliance: &self.softness.compliance,
        }
    }

    fn has_contact(&self) -> bool {
        self.interface.kind.iter().any(|k| *k != RowKind::Equal)
    }

    /// Loads that no contact pressure balances; none where one does.
    fn unheld_load(&self, model: &Model<S, N>) -> Option<Unheld> {
        let pushes: Vec<_> = self.loads.totals.iter().map(|r| (r.force, r.moment)).collect();
        unheld(model, &self.interface.contacts, &pushes, self.loads.vector.iter().map(|f| f.abs()).sum())
    }

    /// Solves the system and checks the answer; `near` and `retreat` as of the [active set](crate::constraint::ActiveSet).
    fn solved(
        &self,
        model: &Model<S, N>,
        solver: &mut Solver,
        near: bool,
        retreat: bool,
        observer: Observer<'_>,
    ) -> Result<ConstrainedSolution, SolveError> {
        let (system, size) = (self.constrained(), self.reduced.num_free() + model.rows);
        if size == 0 {
            return Ok(ConstrainedSolution { method: "nothing to solve".into(), ..ConstrainedSolution::default() });
        }
        let solution = if self.has_contact() && !(solver.abilities().contact && self.softness.is_exact()) {
            let active_set = &mut solver.set;
            active_set.start.clone_from(&self.interface.start);
            active_set.near = near;
            active_set.elements.clone_from(&self.interface.elements);
            active_set.max_iterations = model.max_iterations;
            active_set.c = model.c;
            active_set.retreat = retreat;
            self.softness.solve(active_set, &system, self.interface.eased.clone(), observer)?
        } else {
            solver.set.inner.solve(&system).map_err(as_stopped)?
        };
        // an augmented Lagrangian closes its rows up to its own tolerance
        verified(&system, solution, solver.set.inner.tolerance().max(self.softness.error()))
    }

    /// The state of the model with a solution of the system.
    fn finished(&self, model: &Model<S, N>, solution: ConstrainedSolution, t: f64) -> StepState<S, N> {
        let sign_case = sign_case_of_rows(&self.constrained(), &solution).into_iter().map(|case| case.unwrap_or(NO_CONTACT)).collect();
        let mut total = self.total;
        let u = self.reduced.expand(&solution.unknowns);
        let b = self.interface.reaction.as_ref().unwrap_or(&self.interface.rows);
        let mut support = self.reduced.residual(self.matrices, &self.loads.vector, &[&b.slave, &b.master], &solution.multipliers, &u);
        model.glued.gather(&mut support);
        // restoring forces of the springs
        for spring in &model.springs {
            let field = model.patches[spring.side.patch].field;
            super::integrate::over_side(&spring.side, |e, xi, x, _, ds| {
                let value = on_trace(&spring.side.trace, field, &u, e, &[*xi])[0];
                let mut force = [0.0; 3];
                force[spring.component] = -spring.stiffness.value(&Point::new(x.as_slice()).at_time(t)) * value[spring.component];
                total.add(x, &force, ds);
            });
        }
        let mut lambda = solution.multipliers.clone();
        for (contact, built) in model.contacts.iter().zip(&self.interface.contacts) {
            for (part, rows) in contact.parts.iter().zip(built) {
                let range = part.rows();
                let turned = rows.multipliers(&lambda[range.clone()]);
                lambda[range].copy_from_slice(&turned);
            }
        }
        StepState {
            t,
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

/// Turns the error of linear algebra that was cancelled into that of a cancelled step.
fn as_stopped(error: SolveError) -> SolveError {
    match error {
        SolveError::Linear(LinearError::Stopped { .. }) => SolveError::Stopped { iterations: 0, best: None },
        other => other,
    }
}

/// Best or last iterate of an algorithm that ended with `error`, if it has one.
fn last_iterate(error: &SolveError) -> Option<Box<ConstrainedSolution>> {
    match error {
        SolveError::Cycling { best: last, .. }
        | SolveError::TooManyIterations { best: last, .. }
        | SolveError::Multipliers { last, .. } => Some(last.clone()),
        SolveError::RigidMotion { best, .. } | SolveError::Stopped { best, .. } => best.clone(),
        _ => None,
    }
}
