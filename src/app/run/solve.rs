//! Assembling and solving the system of a model at a time.

use super::at_rest::at_rest;
use super::integrate::on_trace;
use super::iteration;
use super::loads::Resultant;
use super::soften::Softness;
use crate::app::build::{ContactModel, Model, between, unheld};
use crate::app::registry::{Fault, Registry, SolverOptions, solver_name};
use crate::app::watch::{Progress, Watch};
use crate::assembly::{Blocks, DirichletError, Reduced, ReductionError};
use crate::constraint::{ActiveSet, ConstrainedSolution, ConstrainedSystem, ConstraintSolver, RowKind, SolveError, sign_case_of_rows};
use crate::contact::{Contact, ContactError};
use crate::coupling::{CouplingError, Rows};
use crate::io::case::{self, Start};
use crate::io::formula::Point;
use crate::linalg::{Csr, Limits, LinearError, Triplets, Vector};
use std::borrow::Cow;

/// Sign case of rows without one: ties, and contact rows that face nothing.
const NO_CONTACT: u8 = 9;
/// Gaps below this share of the lengths they come from count as zero where a start looks at gaps.
const ZERO: f64 = 1e-12;

/// The solution of a step.
#[derive(Debug)]
pub struct StepState<const S: usize, const N: usize> {
    /// Its time.
    pub t: f64,
    /// All unknowns.
    pub u: Vec<f64>,
    /// One multiplier per row: coefficients of lambda.
    pub lambda: Vec<f64>,
    /// What the solver found for every row: of contacts the variables of their cone, lambda = T mu; of ties lambda.
    pub mu: Vec<f64>,
    /// Whether each row is enforced.
    pub active: Vec<bool>,
    /// Rows, weights and points of every contact part at this time.
    pub contacts: Vec<Vec<Contact<S, N>>>,
    /// What supports do to the bodies, per unknown.
    pub support: Vec<f64>,
    /// Sum of all loads, springs included.
    pub load: Resultant,
    /// Number of unknowns that are free.
    pub free: usize,
    /// Relative residual.
    pub residual: f64,
    /// What was done, in words.
    pub method: String,
    /// Iterations of the linear algebra, 0 where all was done by factors.
    pub iterations: usize,
    /// The active set, where there is contact.
    pub active_set: Option<crate::constraint::ActiveSetReport>,
    /// Sign case 0 to 8 of every row; 9 for rows of ties.
    pub sign_case: Vec<u8>,
}

/// Why a step has no solution.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StepError {
    /// Prescribed values could not be projected.
    #[error(transparent)]
    Dirichlet(#[from] DirichletError),
    /// Conditions contradict each other.
    #[error(transparent)]
    Reduction(#[from] ReductionError),
    /// A tie has no stiffness at this time.
    #[error(transparent)]
    Coupling(#[from] CouplingError),
    /// A contact could not be set up at this time.
    #[error(transparent)]
    Contact(#[from] ContactError),
    /// No contact pressure balances the loads.
    #[error("infeasible load: {what}")]
    Infeasible {
        /// Which body moves which way, and what force is missing.
        what: String,
    },
    /// The system was not solved.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// Obstacles that forces press did not come to rest.
    #[error("an obstacle that a force presses does not come to rest: contact was built at {places} places")]
    Obstacle {
        /// At how many places.
        places: usize,
    },
}

/// The stiffness of every body at a time, springs included.
#[derive(Clone, Debug)]
pub struct Stiffness {
    matrices: Matrices,
    changes: Vec<bool>,
    t: f64,
}

/// The matrices of a model at a time.
#[derive(Clone, Debug)]
pub struct Matrices {
    /// One per body, springs included.
    pub bodies: Vec<Csr>,
    /// What ties and contacts add between the bodies, in all unknowns.
    pub between: Option<Csr>,
    /// Why a tie or a contact has no stiffness at this time.
    fault: Option<StepError>,
}

impl Stiffness {
    /// Assembles all bodies at time `t`.
    pub fn new<const S: usize, const N: usize>(model: &Model<S, N>, t: f64) -> Self {
        let springs = |k: usize| model.springs.iter().any(|s| s.side.patch == k && s.stiffness.depends_on_time());
        let (between, fault) = added(model, t, true);
        Self {
            matrices: Matrices { bodies: (0..model.patches.len()).map(|k| assembled(model, k, t)).collect(), between, fault },
            changes: (0..model.patches.len()).map(|k| model.patches[k].changing.is_some() || springs(k)).collect(),
            t,
        }
    }

    /// The matrices at time `t`: bodies whose material and springs do not change keep theirs.
    pub fn at<const S: usize, const N: usize>(&mut self, model: &Model<S, N>, t: f64) -> &Matrices {
        if t != self.t {
            for k in (0..self.changes.len()).filter(|&k| self.changes[k]) {
                self.matrices.bodies[k] = assembled(model, k, t);
            }
            let contacts = model.contacts.iter().flat_map(|c| &c.parts).any(|part| part.changes && part.first.points.is_some());
            if contacts || model.ties.iter().flat_map(|tie| &tie.parts).any(|part| part.changes(model)) {
                (self.matrices.between, self.matrices.fault) = added(model, t, false);
            }
            self.t = t;
        }
        &self.matrices
    }
}

/// What ties and contacts add at time `t`; `first`: of ties as it was found when the model was built.
fn added<const S: usize, const N: usize>(model: &Model<S, N>, t: f64, first: bool) -> (Option<Csr>, Option<StepError>) {
    let mut parts = Vec::new();
    for part in model.ties.iter().flat_map(|tie| &tie.parts) {
        match if first || !part.changes(model) { Ok(Cow::Borrowed(&part.stiffness)) } else { part.stiffness_at(model, t).map(Cow::Owned) } {
            Ok(entries) => parts.push(entries),
            Err(fault) => return (None, Some(fault.into())),
        }
    }
    for contact in &model.contacts {
        for part in contact.parts.iter().filter(|part| part.first.points.is_some()) {
            match contact.at(model, part, t) {
                Ok(built) => parts.extend(built.points.map(|points| Cow::Owned(points.stiffness))),
                Err(fault) => return (None, Some(fault.into())),
            }
        }
    }
    (between(model, parts.iter().map(|p| &**p)), None)
}

/// The stiffness of body `k` at time `t`.
fn assembled<const S: usize, const N: usize>(model: &Model<S, N>, k: usize, t: f64) -> Csr {
    let (patch, physics) = (&model.patches[k], model.patches[k].physics_at(t));
    let mut matrix = physics.stiffness(&**patch.body.space(), &patch.rules);
    for spring in model.springs.iter().filter(|s| s.side.patch == k) {
        let value = |x: &Vector<N>| spring.stiffness.value(&Point::new(x.as_slice()).at_time(t));
        physics.springs(&spring.side.trace, &spring.side.rules, spring.component, &value, &mut matrix);
    }
    matrix
}

/// C, B, g and kinds of all rows in all unknowns.
struct System<const S: usize, const N: usize> {
    rows: Rows,
    reaction: Option<Rows>,
    offset: Vec<f64>,
    kind: Vec<RowKind>,
    start: Vec<bool>,
    /// Rows of points that start closed whatever their gap is.
    eased: Vec<bool>,
    contacts: Vec<Vec<Contact<S, N>>>,
}

fn empty(rows: usize, unknowns: usize) -> Rows {
    Rows { slave: Triplets::new(rows, unknowns), master: Triplets::new(rows, unknowns) }
}

fn append(sum: &mut Rows, part: &Rows, first: usize) {
    sum.slave.append_below(&part.slave, first);
    sum.master.append_below(&part.master, first);
}

impl<const S: usize, const N: usize> System<S, N> {
    /// `before`: the step whose active rows are the first guess.
    ///
    /// `place`: unknowns that say where obstacles are that forces press; none: at rest.
    fn of(model: &Model<S, N>, t: f64, before: Option<&StepState<S, N>>, place: Option<&[f64]>) -> Result<Self, StepError> {
        let m = model.rows;
        let mut rows = empty(m, model.unknowns);
        let (mut reaction, mut differs) = (empty(m, model.unknowns), false);
        let (mut offset, mut kind, mut start) = (vec![0.0; m], vec![RowKind::Equal; m], vec![true; m]);
        for part in model.ties.iter().flat_map(|tie| &tie.parts) {
            append(&mut rows, &part.rows, part.first_row);
            append(&mut reaction, part.reaction.as_ref().unwrap_or(&part.rows), part.first_row);
            differs |= part.reaction.is_some();
        }
        let mut eased = vec![false; m];
        let mut contacts = Vec::with_capacity(model.contacts.len());
        for contact in &model.contacts {
            let mut parts = Vec::with_capacity(contact.parts.len());
            for part in &contact.parts {
                let built = contact.at_place(model, part, t, place)?;
                let turned = built.turned(&built.rows);
                append(&mut rows, &turned, part.first_row);
                let pulls = built.reaction.as_ref().map(|b| built.turned(b));
                append(&mut reaction, pulls.as_ref().unwrap_or(&turned), part.first_row);
                differs |= built.reaction.is_some();
                let (own, weights) = (built.turned_offset(), built.turned_weights());
                for (j, (&g, k)) in own.iter().zip(built.kinds()).enumerate() {
                    offset[part.first_row + j] = g;
                    kind[part.first_row + j] = k;
                    let row = part.first_row + j;
                    // rows that faced nothing say nothing
                    let known = before.filter(|b| b.sign_case[row] != NO_CONTACT);
                    start[row] = known.map_or_else(|| starts_active(model, contact, (g, weights[j]), j, part.first_row), |b| b.active[row]);
                }
                eased[part.rows()].fill(built.points.is_some() && contact.start == Start::All && before.is_none());
                parts.push(built);
            }
            contacts.push(parts);
        }
        Ok(Self { rows, reaction: differs.then_some(reaction), offset, kind, start, eased, contacts })
    }
}

fn starts_active<const S: usize, const N: usize>(
    model: &Model<S, N>,
    contact: &ContactModel<S, N>,
    (offset, weight): (f64, f64),
    j: usize,
    first: usize,
) -> bool {
    match contact.start {
        Start::All => true,
        Start::None => false,
        // bodies that touch have gaps of round-off: zero within a share of the lengths the gaps come from
        Start::Gap => offset <= ZERO * model.size.max(model.center.norm()) * weight.abs(),
        Start::Seed(seed) => {
            // SplitMix64 of seed and row: the same on every machine
            let mut z = seed.wrapping_add((first + j + 1) as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15);
            z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            (z ^ (z >> 31)) & 1 == 1
        }
    }
}

/// A step that was not solved, with the last state, where there is one.
#[derive(Debug)]
pub struct Unsolved<const S: usize, const N: usize> {
    /// Why.
    pub error: StepError,
    /// The last state computed.
    pub last: Option<Box<StepState<S, N>>>,
}

impl<const S: usize, const N: usize, E: Into<StepError>> From<E> for Unsolved<S, N> {
    fn from(error: E) -> Self {
        Self { error: error.into(), last: None }
    }
}

/// The constraint solver of a run: what it learnt from a step serves the next ones.
#[derive(Debug)]
pub struct Solver {
    set: ActiveSet<Box<dyn ConstraintSolver>>,
    /// Whether the solver inside decides contact rows itself: then it is no part of an active set.
    decides: bool,
}

impl Solver {
    /// The solver that `wanted` names, stopped by `watch`. One that refuses contact rows gets an active set around it.
    ///
    /// # Errors
    /// [`Fault`] where the registry has none of this name, or the name and the other keys do not go together.
    pub fn new(registry: &Registry, wanted: &case::Solver, watch: &Watch) -> Result<Self, Fault> {
        let make = registry.solvers.get(solver_name(&wanted.constraint.value)).map_err(|e| Fault::new("E015", e.to_string()))?;
        let limits = Limits {
            tolerance: wanted.tolerance.value,
            max_iterations: wanted.max_iterations.map_or(0, |m| m.value),
            stop: watch.stop_sign(),
        };
        let mut inner = make(&SolverOptions { linear: wanted.linear.value, limits })?;
        let decides = decides_contact(&mut *inner);
        Ok(Self { set: ActiveSet::new(inner), decides })
    }

    /// Whether the solver refuses systems whose reaction differs from the constraint: asked of a system with one row.
    pub fn needs_symmetry(&mut self) -> bool {
        let (mut rows, stiffness) = (empty(1, 2), Csr::from_parts(2, vec![0, 1, 2], vec![0, 1], vec![1.0; 2]));
        rows.slave.push(0, 0, 1.0);
        let mut reaction = rows.clone();
        reaction.slave.push(0, 1, 0.5);
        let system = ConstrainedSystem {
            stiffness: &stiffness,
            load: &[0.0; 2],
            constraint: &rows,
            reaction: Some(&reaction),
            offset: &[-1.0],
            kind: &[RowKind::Equal],
            compliance: &[],
        };
        matches!(self.set.inner.solve(&system), Err(SolveError::NotSymmetric))
    }
}

impl Solver {
    /// Whether the solver refuses soft rows of which there are more than unknowns: asked of two rows on one unknown.
    pub fn needs_independent_rows(&mut self) -> bool {
        let (mut rows, stiffness) = (empty(2, 1), Csr::from_parts(1, vec![0, 1], vec![0], vec![1.0]));
        rows.slave.push(0, 0, 1.0);
        rows.slave.push(1, 0, 1.0);
        let system = ConstrainedSystem {
            stiffness: &stiffness,
            load: &[1.0],
            constraint: &rows,
            reaction: None,
            offset: &[0.0; 2],
            kind: &[RowKind::Equal; 2],
            compliance: &[1.0; 2],
        };
        matches!(self.set.inner.solve(&system), Err(SolveError::OverConstrained { .. }))
    }
}

/// Whether a solver answers contact rows: asked of two springs pushed by 2 and 0, the first towards a wall at distance 1.
fn decides_contact(solver: &mut dyn ConstraintSolver) -> bool {
    let (mut rows, stiffness) = (empty(1, 2), Csr::from_parts(2, vec![0, 1, 2], vec![0, 1], vec![1.0; 2]));
    rows.slave.push(0, 0, -1.0);
    let system = ConstrainedSystem {
        stiffness: &stiffness,
        load: &[2.0, 0.0],
        constraint: &rows,
        reaction: None,
        offset: &[1.0],
        kind: &[RowKind::Contact],
        compliance: &[],
    };
    solver.solve(&system).is_ok()
}

/// Solves the model at time `t` with the matrices of its bodies at that time.
///
/// The active set starts as it ended in `before`. Where that leads nowhere it starts again as the case says: a set that holds a
/// body in one step may leave it free in the next.
///
/// # Errors
/// [`Unsolved`], with the last state of an active set that did not settle or that `watch` stopped.
pub fn step<const S: usize, const N: usize>(
    model: &Model<S, N>,
    matrices: &Matrices,
    solver: &mut Solver,
    t: f64,
    before: Option<&StepState<S, N>>,
    watch: &Watch,
) -> Result<StepState<S, N>, Unsolved<S, N>> {
    let before = before.filter(|_| !model.contacts.is_empty());
    let solved = at_rest(model, matrices, solver, t, before, watch);
    match &solved {
        Err(Unsolved { error: StepError::Solve(e), .. }) if before.is_some() && !matches!(e, SolveError::Stopped { .. }) => {
            at_rest(model, matrices, solver, t, None, watch)
        }
        _ => solved,
    }
}

/// Solves the system with obstacles where `place` says, the active set started as it ended in `before`.
pub(super) fn once<const S: usize, const N: usize>(
    model: &Model<S, N>,
    matrices: &Matrices,
    solver: &mut Solver,
    t: f64,
    before: Option<&StepState<S, N>>,
    place: Option<&[f64]>,
    watch: &Watch,
) -> Result<StepState<S, N>, Unsolved<S, N>> {
    let goes_on = || match watch.stop() {
        None => Ok(()),
        Some(_) => Err(SolveError::Stopped { iterations: 0, best: None }),
    };
    if let Some(fault) = &matrices.fault {
        return Err(fault.clone().into());
    }
    let obstacles = model.has_pressed().then(|| model.pressed_block());
    let bodies: Vec<&Csr> = matrices.bodies.iter().chain(&obstacles).collect();
    let matrices = Blocks { bodies: &bodies, between: matrices.between.as_ref() };
    let prescribed = model.prescribed(t).map_err(|e| Unsolved::<S, N>::from(e.0))?;
    let (load, totals) = model.loads(t);
    let mut total = Resultant::default();
    totals.iter().for_each(|own| total.sum(own));
    let system = System::of(model, t, before, place)?;
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
    let has_contact = system.kind.iter().any(|k| *k != RowKind::Equal);
    let missing = if has_contact { unheld_load(model, &system, &load, &totals) } else { None };
    let solved = if reduced.num_free() == 0 && model.rows == 0 {
        Ok(ConstrainedSolution { method: "nothing to solve".into(), ..ConstrainedSolution::default() })
    } else if has_contact && !(solver.decides && softness.is_exact()) {
        let active_set = &mut solver.set;
        active_set.start.clone_from(&system.start);
        active_set.max_iterations = model.max_iterations;
        active_set.c = model.c;
        // where no pressure balances the loads, no step back leads anywhere
        active_set.retreat = missing.is_none();
        softness.solve(active_set, &constrained, system.eased.clone(), watch)
    } else {
        solver.set.inner.solve(&constrained).map_err(|error| match error {
            SolveError::Linear(LinearError::Stopped { .. }) => SolveError::Stopped { iterations: 0, best: None },
            other => other,
        })
    };
    let finish = |solution: ConstrainedSolution| {
        if let Some(report) = &solution.active_set {
            iteration::lines(report).iter().for_each(|line| watch.report(Progress::Note(line)));
        }
        let sign_case = sign_case_of_rows(&constrained, &solution).into_iter().map(|case| case.unwrap_or(NO_CONTACT)).collect();
        finished(model, matrices, &load, total, &reduced, &system, solution, sign_case, t)
    };
    match solved {
        Ok(solution) => Ok(finish(solution)),
        Err(error) => {
            let last = match &error {
                SolveError::Cycling { best: last, .. }
                | SolveError::TooManyIterations { best: last, .. }
                | SolveError::Multipliers { last, .. } => Some(last.clone()),
                SolveError::RigidMotion { best, .. } | SolveError::Stopped { best, .. } => best.clone(),
                _ => None,
            };
            let error = match (missing, StepError::from(error)) {
                (Some(what), StepError::Solve(e)) if !matches!(e, SolveError::Stopped { .. }) => StepError::Infeasible { what },
                (_, error) => error,
            };
            let usable = last.filter(|l| l.unknowns.len() == reduced.num_free() && l.multipliers.len() == model.rows);
            Err(Unsolved { error, last: usable.map(|l| Box::new(finish(*l))) })
        }
    }
}

/// Why no contact pressure balances the loads, where that is so.
fn unheld_load<const S: usize, const N: usize>(
    model: &Model<S, N>,
    system: &System<S, N>,
    load: &[f64],
    totals: &[Resultant],
) -> Option<String> {
    let pushes: Vec<_> = totals.iter().map(|r| (r.force, r.moment)).collect();
    unheld(model, &system.contacts, &pushes, load.iter().map(|f| f.abs()).sum())
}

fn finished<const S: usize, const N: usize>(
    model: &Model<S, N>,
    matrices: Blocks<'_>,
    load: &[f64],
    mut total: Resultant,
    reduced: &Reduced,
    system: &System<S, N>,
    solution: ConstrainedSolution,
    sign_case: Vec<u8>,
    t: f64,
) -> StepState<S, N> {
    let u = reduced.expand(&solution.unknowns);
    let b = system.reaction.as_ref().unwrap_or(&system.rows);
    let mut support = reduced.residual(matrices, load, &[&b.slave, &b.master], &solution.multipliers, &u);
    model.glued.gather(&mut support);
    // springs pull back
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
        free: reduced.num_free(),
        residual: solution.residual,
        method: solution.method,
        iterations: solution.iterations,
        active_set: solution.active_set,
        sign_case,
    }
}
