//! Assembly and solution of the system of a problem at a time.

use super::compliance::Softness;
use super::data::Point;
use super::equilibrium::{Unheld, unheld};
use super::integrate::on_trace;
use super::loads::{LoadSum, Loads};
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
use std::ops::ControlFlow;

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
    let goes_on = || match observer(&Progress::System) {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(SolveError::Stopped { iterations: 0, best: None }),
    };
    if let Some(fault) = &matrices.fault {
        return Err(fault.clone().into());
    }
    let obstacles = model.has_pressed().then(|| model.pressed_block());
    let bodies: Vec<&Csr> = matrices.bodies.iter().chain(&obstacles).collect();
    let matrices = Blocks { bodies: &bodies, between: matrices.between.as_ref() };
    let prescribed = model.prescribed(t).map_err(|e| Unsolved::<Box<StepState<S, N>>>::from(e.0))?;
    let Loads { vector: load, totals, sums } = model.loads(t);
    let mut total = Resultant::default();
    totals.iter().for_each(|own| total.sum(own));
    let system = InterfaceSystem::of(model, t, before, place)?;
    let reduced = Reduced::try_new(matrices, &load, &prescribed, &model.all_equations())?;
    let (slave, shift) = reduced.rows(&system.rows.slave);
    let (master, shift_master) = reduced.rows(&system.rows.master);
    let offset: Vec<f64> = (0..model.rows).map(|i| system.offset[i] + shift[i] + shift_master[i]).collect();
    let rows = Rows { slave, master };
    let softness = Softness::of(model, &matrices, &system.rows, &system.contacts);
    let reaction = system.reaction.as_ref().map(|b| Rows { slave: reduced.rows(&b.slave).0, master: reduced.rows(&b.master).0 });
    let constrained = ConstrainedSystem {
        stiffness: &reduced.stiffness,
        load: &reduced.load,
        constraint: &rows,
        reaction: reaction.as_ref(),
        offset: &offset,
        kind: &system.kind,
        compliance: &softness.compliance,
    };
    goes_on()?;
    let factors = solver.set.inner.factors();
    let has_contact = system.kind.iter().any(|k| *k != RowKind::Equal);
    let missing = if has_contact { unheld_load(model, &system, &load, &totals) } else { None };
    let solved = if reduced.num_free() == 0 && model.rows == 0 {
        Ok(ConstrainedSolution { method: "nothing to solve".into(), ..ConstrainedSolution::default() })
    } else if has_contact && !(solver.abilities().contact && softness.is_exact()) {
        let active_set = &mut solver.set;
        active_set.start.clone_from(&system.start);
        active_set.near = before.is_some();
        active_set.elements.clone_from(&system.elements);
        active_set.max_iterations = model.max_iterations;
        active_set.c = model.c;
        // backtracking does not help if no pressure balances the loads
        active_set.retreat = missing.is_none();
        softness.solve(active_set, &constrained, system.eased.clone(), observer)
    } else {
        solver.set.inner.solve(&constrained).map_err(as_stopped)
    };
    // an augmented Lagrangian closes its rows up to its own tolerance
    let tolerance = solver.set.inner.tolerance().max(softness.error());
    let solved = solved.and_then(|solution| match reduced.num_free() + model.rows {
        0 => Ok(solution),
        _ => verified(&constrained, solution, tolerance),
    });
    let factors = solver.set.inner.factors() - factors;
    let finish = |solution: ConstrainedSolution| {
        if let Some(report) = &solution.active_set {
            // a request to stop finds the system solved
            let _ = observer(&Progress::ActiveSet(report));
        }
        let sign_case = sign_case_of_rows(&constrained, &solution).into_iter().map(|case| case.unwrap_or(NO_CONTACT)).collect();
        let state = finished(model, matrices, &load, total, sums.clone(), &reduced, &system, solution, sign_case, t);
        StepState { factors, ..state }
    };
    match solved {
        Ok(solution) => Ok(finish(solution)),
        Err(error) => {
            let last = last_iterate(&error);
            let error = match (missing, StepError::from(error)) {
                (Some(Unheld { what, coarse }), StepError::Solve(e)) if !matches!(e, SolveError::Stopped { .. }) => {
                    if coarse {
                        StepError::Coarse { what }
                    } else {
                        StepError::Infeasible { what }
                    }
                }
                (_, error) => error,
            };
            let usable = last.filter(|l| l.unknowns.len() == reduced.num_free() && l.multipliers.len() == model.rows);
            Err(Unsolved { error, best: usable.map(|l| Box::new(finish(*l))) })
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

/// Loads that no contact pressure balances; none where one does.
fn unheld_load<const S: usize, const N: usize>(
    model: &Model<S, N>,
    system: &InterfaceSystem<S, N>,
    load: &[f64],
    totals: &[Resultant],
) -> Option<Unheld> {
    let pushes: Vec<_> = totals.iter().map(|r| (r.force, r.moment)).collect();
    unheld(model, &system.contacts, &pushes, load.iter().map(|f| f.abs()).sum())
}

fn finished<const S: usize, const N: usize>(
    model: &Model<S, N>,
    matrices: Blocks<'_>,
    load: &[f64],
    mut total: Resultant,
    loads: Vec<LoadSum>,
    reduced: &Reduced,
    system: &InterfaceSystem<S, N>,
    solution: ConstrainedSolution,
    sign_case: Vec<u8>,
    t: f64,
) -> StepState<S, N> {
    let u = reduced.expand(&solution.unknowns);
    let b = system.reaction.as_ref().unwrap_or(&system.rows);
    let mut support = reduced.residual(matrices, load, &[&b.slave, &b.master], &solution.multipliers, &u);
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
    for (contact, built) in model.contacts.iter().zip(&system.contacts) {
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
        contacts: system.contacts.clone(),
        support,
        load: total,
        loads,
        free: reduced.num_free(),
        residual: solution.residual,
        condition: solution.condition,
        method: solution.method,
        iterations: solution.iterations,
        factors: 0,
        active_set: solution.active_set,
        sign_case,
    }
}
