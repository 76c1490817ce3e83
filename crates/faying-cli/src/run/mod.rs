//! Running a case: build, forecast, assemble, solve, measure.

mod errors;
mod faults;
mod fields;
mod forecast;
mod iteration;
mod marks;
mod mesh_picture;
mod model_words;
mod multipliers;
mod obstacles;
mod report;
mod room;
mod solver;
mod warnings;

use faults::{memory_limit, step_fault, stopped};
use forecast::avoids_factors;

use super::lower::{self, LoweredCase, Places};
use super::output::{Finished, Output, RunOptions, StepOutput};
use super::quantities::{Questions, Step, Told};
use super::registry::{Names, Registry};
use super::result::{Prediction, ProbeReport, RunResult, Status, StepReport};
use super::run_control::{Progress, RunControl};
use super::shapes::{MakeControlNet, plane_net, solid_net};
use crate::case::Case;
use crate::errors::{Diagnostic, Diagnostics, Severity};
use crate::plot::faces::FacePlot;
use crate::plot::mesh_faces;
use crate::reference::Reference;
use faying::constraint::SolveError;
use faying::coupling::multiplier::reproduction;
use faying::problem::{self, InterfaceId, InterfaceSide, InterfaceView, Solution, StepError, System, Unsolved, Warning};
use faying::space::Trace;
use std::ops::ControlFlow;
use std::sync::Arc;

pub(crate) use forecast::too_large;
pub(crate) use model_words::equation;
pub(crate) use room::{MemoryLimit, memory_for_files, most_threads};
pub use solver::solver;

/// The solution of a step.
#[derive(Debug)]
pub struct Solved<const S: usize, const N: usize> {
    /// The solution.
    pub solution: Solution<S, N>,
    /// The number of the step, from 1.
    pub step: usize,
}

/// Names and functions that depend on the dimension.
struct Dimension<'a, const S: usize, const N: usize> {
    names: &'a Names<S, N>,
    net: MakeControlNet<N>,
    reproduction: Option<multipliers::Reproduction<S, N>>,
    output: MakeOutput<S, N>,
}

fn plane(registry: &Registry) -> Dimension<'_, 1, 2> {
    let held: multipliers::Reproduction<1, 2> = |curve, multiplier| reproduction(curve, multiplier);
    Dimension { names: &registry.plane, net: plane_net, reproduction: Some(held), output: fields::plane_output }
}

fn volume(registry: &Registry) -> Dimension<'_, 2, 3> {
    Dimension { names: &registry.volume, net: solid_net, reproduction: None, output: fields::volume_output }
}

/// Whether a case is one of space; every other is one of the plane.
fn in_space(case: &Case) -> bool {
    case.model.dimension.value == 3
}

impl Case {
    /// Solves the case with the built-in or added names of `registry`.
    ///
    /// The result has a status: a check that fails or an iteration that does not converge is a result, too.
    /// # Errors
    /// All errors of the case, with their source locations.
    ///
    /// # Example
    /// ```
    /// use faying_cli::{Case, Registry};
    /// # let text = "schema = 1\n[model]\nphysics = \"poisson\"\ndimension = 2\n[[patch]]\nname = \"a\"\ngeometry = { kind = \"box\", min = [0, 0], max = [1, 1] }\nelements = [2, 2]\n[[boundary]]\non = \"all-outer\"\ndirichlet = \"x\"\n";
    /// let case = Case::parse("demo.toml", text, &Default::default())?; // or Case::read("demo.toml")?
    /// let result = case.run(&Registry::default())?;
    /// assert_eq!(result.exit, 0);
    /// # Ok::<(), faying_cli::Diagnostics>(())
    /// ```
    pub fn run(&self, registry: &Registry) -> Result<RunResult, Diagnostics> {
        let watch = RunControl::default();
        if in_space(self) {
            solve_case("run", self, registry, &volume(registry), &watch).map(|(result, _)| result)
        } else {
            solve_case("run", self, registry, &plane(registry), &watch).map(|(result, _)| result)
        }
    }
}

/// Runs a case and keeps its fields for the files. Errors of the case are in the result's diagnostics, with status `Invalid` (exit 3), or
/// `Limit` (exit 6) if the predicted memory is too large.
pub fn run(case: &Case, registry: &Registry, options: &RunOptions, watch: &RunControl) -> Finished {
    if in_space(case) {
        run_in(case, registry, &volume(registry), options, watch)
    } else {
        run_in(case, registry, &plane(registry), options, watch)
    }
}

fn run_in<const S: usize, const N: usize>(
    case: &Case,
    registry: &Registry,
    dimension: &Dimension<'_, S, N>,
    options: &RunOptions,
    watch: &RunControl,
) -> Finished
where
    Trace<S, N>: InterfaceSide<S, N>,
{
    match solve_case("run", case, registry, dimension, watch) {
        Ok((mut result, solved)) => {
            let output = solved.last().map(|last| {
                watch.phase("fields");
                (dimension.output)(case, last, options)
            });
            end_early(&mut result, watch);
            let good = matches!(result.status, Status::Ok | Status::CheckFailed);
            let stored = solved
                .last()
                .filter(|_| options.keep && good)
                .and_then(|last| crate::reference::stored_run(case, dimension.names, dimension.net, &last.solution).ok());
            let steps = if case.has_steps() {
                solved.into_iter().map(|s| step_output(case, s, dimension.output, *options)).collect()
            } else {
                Vec::new()
            };
            Finished { result, output, steps, stored }
        }
        Err(faults) => Finished { result: refused("run", case, faults), output: None, steps: Vec::new(), stored: None },
    }
}

/// Runs a case and returns its numbers without fields, as `command` reports them: a row of a study. Faults as in [`run`].
pub fn numbers(command: &str, case: &Case, registry: &Registry, watch: &RunControl) -> RunResult {
    let solved = if in_space(case) {
        solve_case(command, case, registry, &volume(registry), watch).map(|(result, _)| result)
    } else {
        solve_case(command, case, registry, &plane(registry), watch).map(|(result, _)| result)
    };
    match solved {
        Ok(mut result) => {
            end_early(&mut result, watch);
            result
        }
        Err(faults) => refused(command, case, faults),
    }
}

/// Returns, per patch, whether it has a slave side once slave and master are chosen.
///
/// # Errors
/// Errors of the bodies or their sides, with their source locations.
pub fn slave_patches(case: &Case, registry: &Registry) -> Result<Vec<bool>, Diagnostics> {
    if in_space(case) { slaves_in(case, registry, &volume(registry)) } else { slaves_in(case, registry, &plane(registry)) }
}

fn slaves_in<const S: usize, const N: usize>(
    case: &Case,
    registry: &Registry,
    dimension: &Dimension<'_, S, N>,
) -> Result<Vec<bool>, Diagnostics>
where
    Trace<S, N>: InterfaceSide<S, N>,
{
    let model = built(case, registry, dimension, &RunControl::default(), MemoryLimit::least(None))?;
    let mut slave = vec![false; case.patches.len()];
    model.system.contents().interfaces().flat_map(|of| of.sides()).for_each(|of| slave[of.side().body()] = true);
    Ok(slave)
}

/// The mesh of a case that is solved, with its supports and loads at the end of its steps.
///
/// # Errors
/// Those of the case, with their source locations.
pub fn mesh(case: &Case, registry: &Registry, title: &str) -> Result<FacePlot, Diagnostics> {
    let (watch, room) = (RunControl::default(), MemoryLimit::least(None));
    Ok(match in_space(case) {
        true => mesh_picture::of(case, &built(case, registry, &volume(registry), &watch, room)?, title, mesh_faces::of_solid),
        false => mesh_picture::of(case, &built(case, registry, &plane(registry), &watch, room)?, title, mesh_faces::of_plane),
    })
}

/// Does everything but the solve: the result has the names, the counts and the prediction.
pub fn check(case: &Case, registry: &Registry, _options: &RunOptions, watch: &RunControl) -> Finished {
    let result = unsolved("check", case, registry, watch);
    Finished { result, output: None, steps: Vec::new(), stored: None }
}

/// Does everything of a run but the solve: the result has the model in words, the names, the counts and the prediction.
pub fn dry(case: &Case, registry: &Registry, watch: &RunControl) -> RunResult {
    unsolved("run", case, registry, watch)
}

fn unsolved(command: &str, case: &Case, registry: &Registry, watch: &RunControl) -> RunResult {
    match in_space(case) {
        true => check_in(command, case, registry, &volume(registry), watch),
        false => check_in(command, case, registry, &plane(registry), watch),
    }
}

fn check_in<const S: usize, const N: usize>(
    command: &str,
    case: &Case,
    registry: &Registry,
    dimension: &Dimension<'_, S, N>,
    watch: &RunControl,
) -> RunResult
where
    Trace<S, N>: InterfaceSide<S, N>,
{
    let outcome = || -> Result<RunResult, Diagnostics> {
        watch.phase("build");
        let room = MemoryLimit::least(watch.max_memory);
        let model = built(case, registry, dimension, watch, room)?;
        let mut result = report::skeleton(command, case, &model);
        Questions::of(case, &model, &result.numbers())?;
        result.solve = None;
        let end = case.steps.value.last().copied().unwrap_or(1.0);
        result.loads = report::loads::<N>(model.system.contents().components(), &model.system.loads(end));
        let prediction = fitting(case, &model, room)?;
        result.predicted = Some(prediction);
        if command == "run" {
            result.model = model_words::of(case, &model, &result).lines().map(str::to_owned).collect();
        }
        end_early(&mut result, watch);
        Ok(result)
    };
    outcome().unwrap_or_else(|faults| refused(command, case, faults))
}

/// Makes the output of a solution.
type MakeOutput<const S: usize, const N: usize> = fn(&Case, &Arc<Solved<S, N>>, &RunOptions) -> Output;

/// Returns the output of a step, computed when it is written.
fn step_output<const S: usize, const N: usize>(
    case: &Case,
    solved: Arc<Solved<S, N>>,
    output: MakeOutput<S, N>,
    options: RunOptions,
) -> StepOutput {
    let (case, number, t) = (case.clone(), solved.step, solved.solution.t());
    StepOutput { number, t, make: Box::new(move || output(&case, &solved, &options)) }
}

/// Marks a result without errors as ended early if `watch` requests it; returns whether it did.
pub(super) fn end_early(result: &mut RunResult, watch: &RunControl) -> bool {
    let stop = watch.stop().filter(|_| matches!(result.status, Status::Ok | Status::CheckFailed));
    if let Some(stop) = stop {
        stopped(result, stop);
    }
    stop.is_some()
}

/// Returns the result of a case that cannot be run.
fn refused(command: &str, case: &Case, faults: Diagnostics) -> RunResult {
    let mut result = RunResult::new(command, &case.source.name);
    result.status = match faults.exit() {
        4 => Status::IoFailed,
        6 => Status::Limit,
        5 => Status::Singular,
        _ => Status::Invalid,
    };
    result.exit = result.status.exit();
    result.checks_expected = case.checks.len();
    for d in case.warnings.items.iter().chain(&faults.items) {
        let list = if d.severity == Severity::Error { &mut result.diagnostics } else { &mut result.warnings };
        list.push(d.clone());
    }
    result
}

fn built<const S: usize, const N: usize>(
    case: &Case,
    registry: &Registry,
    dimension: &Dimension<'_, S, N>,
    watch: &RunControl,
    room: Option<MemoryLimit>,
) -> Result<LoweredCase<S, N>, Diagnostics>
where
    Trace<S, N>: InterfaceSide<S, N>,
{
    let word = &case.solver.constraint;
    let solver =
        solver(registry, &case.solver, watch).map_err(|fault| Diagnostic::error(fault.code, fault.message).at(&case.source, word.at))?;
    if let Some(fault) = too_large(case, dimension.net, room, !avoids_factors(case)) {
        return Err(fault.into());
    }
    let mut model = lower::build(case, dimension.names, dimension.net)?;
    let abilities = solver.abilities();
    let leaning = model.system.contents().interfaces().find(|of| !of.is_symmetric()).filter(|_| !abilities.unsymmetric);
    if let Some(of) = leaning {
        return Err(match (of.id(), of.is_mixed()) {
            (InterfaceId::Tie(_), mixed) => faults::not_symmetric(case, &format!("interface \"{}\"", of.name()), mixed),
            (InterfaceId::Contact(_), true) => faults::not_symmetric(case, &format!("contact \"{}\"", of.name()), true),
            (InterfaceId::Contact(_), false) => faults::contact_not_symmetric(case, of.name()),
        }
        .into());
    }
    let at_points = model.system.contents().contacts().find(InterfaceView::has_rows_at_points);
    if let Some(contact) = at_points.filter(|_| !abilities.more_rows_than_unknowns) {
        return Err(faults::rows_at_points(case, contact.name()).into());
    }
    model.system.set_solver(solver);
    Ok(model)
}

/// Predicts the size of the system and checks its memory.
///
/// # Errors
/// E081 if the memory exceeds `room`.
fn fitting<const S: usize, const N: usize>(
    case: &Case,
    model: &LoweredCase<S, N>,
    room: Option<MemoryLimit>,
) -> Result<Prediction, Diagnostics> {
    let factor = !avoids_factors(case) || model.system.contents().interfaces().any(|of| !of.is_symmetric());
    let prediction: Prediction = model.system.forecast(factor, case.steps.value.len()).into();
    match room.filter(|room| prediction.memory > room.bytes) {
        Some(room) => Err(memory_limit(case, &model.system, &prediction, &room).into()),
        None => Ok(prediction),
    }
}

/// Reports the progress of a step to `watch`, and cancels it where `watch` says so.
fn observer(watch: &RunControl) -> impl Fn(&problem::Progress<'_>) -> ControlFlow<()> + Sync {
    move |news| match news {
        // a step that is solved is told, whatever the watch says
        problem::Progress::ActiveSet(report) => {
            iteration::lines(report).iter().for_each(|line| watch.report(Progress::Note(line)));
            ControlFlow::Continue(())
        }
        _ if watch.stop().is_some() => ControlFlow::Break(()),
        problem::Progress::Iteration { iteration, active, rows } => {
            watch.report(Progress::Iteration { iteration: *iteration, active: *active, rows: *rows });
            ControlFlow::Continue(())
        }
        _ => ControlFlow::Continue(()),
    }
}

/// A result and its solutions: of all steps that have one, the last where the case has no steps.
type Outcome<const S: usize, const N: usize> = (RunResult, Vec<Arc<Solved<S, N>>>);

fn solve_case<const S: usize, const N: usize>(
    command: &str,
    case: &Case,
    registry: &Registry,
    dimension: &Dimension<'_, S, N>,
    watch: &RunControl,
) -> Result<Outcome<S, N>, Diagnostics>
where
    Trace<S, N>: InterfaceSide<S, N>,
{
    watch.phase("build");
    // determined before the model takes memory
    let room = MemoryLimit::least(watch.max_memory);
    let mut model = built(case, registry, dimension, watch, room)?;
    let mut result = report::skeleton(command, case, &model);
    multipliers::describe(case, &model.system.contents(), dimension.reproduction, &mut result);
    let questions = Questions::of(case, &model, &result.numbers())?;
    fitting(case, &model, room)?;
    if let Some(stop) = watch.stop() {
        stopped(&mut result, stop);
        return Ok((result, Vec::new()));
    }
    let times = &case.steps.value;
    let (system, reference) = (&mut model.system, model.reference.as_ref());
    let mut solved = Vec::<Arc<Solved<S, N>>>::new();
    let mut measures =
        Measures { case, reference, questions: &questions, places: &model.places, told: Vec::new(), answers: Told::default() };
    let mut finished = false;
    for (k, &t) in times.iter().enumerate() {
        if let Some(stop) = watch.stop() {
            stopped(&mut result, stop);
            break;
        }
        if case.has_steps() {
            watch.report(Progress::Step { step: k + 1, of: times.len() });
        }
        watch.phase("assemble");
        system.assemble_at(t);
        watch.phase("solve");
        let before = solved.last().map(|s| &s.solution);
        let (solution, failure) = match system.solve_observed(t, before, &observer(watch)) {
            Ok(solution) => (Some(solution), None),
            Err(Unsolved { error, best }) => (best, Some(error)),
        };
        watch.phase("measure");
        finished = k + 1 == times.len();
        let probes = measures.enter(k, system, solution.as_ref(), failure.as_ref(), &mut result);
        end_early(&mut result, watch);
        let status = result.status;
        if case.has_steps() {
            let contact = solution.as_ref().map(|_| result.contact.clone()).unwrap_or_default();
            let active_set = solution.as_ref().and_then(|_| result.solve.as_ref()?.active_set.clone());
            result.steps.push(StepReport { t, status, probes, contact, active_set });
        }
        if let Some(solution) = solution {
            if !case.has_steps() {
                solved.clear();
            }
            solved.push(Arc::new(Solved { solution, step: k + 1 }));
        }
        if !matches!(status, Status::Ok | Status::CheckFailed) {
            break;
        }
    }
    if !finished {
        questions.close(case, &mut result, &mut measures.answers);
    }
    Ok((result, solved))
}

/// Measures of the steps of a run.
struct Measures<'a, const S: usize, const N: usize> {
    case: &'a Case,
    reference: Option<&'a Reference<S, N>>,
    questions: &'a Questions<S, N>,
    places: &'a Places,
    /// Warnings about the states so far.
    told: Vec<Warning>,
    /// Probes and checks of the steps so far.
    answers: Told,
}

impl<const S: usize, const N: usize> Measures<'_, S, N> {
    /// Enters step `k` into the result: its status, numbers and diagnostics, the probes and, with the last step, the checks; returns all
    /// probes at its end.
    fn enter(
        &mut self,
        k: usize,
        system: &System<S, N>,
        solution: Option<&Solution<S, N>>,
        failure: Option<&StepError>,
        result: &mut RunResult,
    ) -> Vec<ProbeReport> {
        let (case, times) = (self.case, &self.case.steps.value);
        let t = times[k];
        let when = |d: Diagnostic| if case.has_steps() { at_step(d, k, t) } else { d };
        let (mut status, mut reason, mut fault) = match failure {
            None => (Status::Ok, "converged", None),
            Some(StepError::Solve(SolveError::Stopped { .. })) => (Status::Ok, "stopped", None),
            Some(error) => {
                let (status, reason, fault) = step_fault(case, (system, self.places), error, t);
                (status, reason, Some(fault))
            }
        };
        if let Some(solution) = solution {
            report::fill(result, solution, self.reference, reason);
            warnings::of_solution(case, (solution, fault.is_some()), &mut self.told, result);
            result.t = case.has_steps().then_some(t);
            let solved = matches!(failure, None | Some(StepError::Solve(SolveError::Stopped { .. }) | StepError::Free { .. }));
            if solved && !solution.unknowns().iter().chain(solution.multipliers()).all(|v| v.is_finite()) {
                (status, reason) = (Status::NotFinite, "not-finite");
                fault = Some(Diagnostic::error("E073", "the solution is not finite"));
            }
        }
        if let Some(solve) = &mut result.solve {
            solve.reason = reason.into();
        }
        result.diagnostics.extend(fault.map(when));
        let step = Step { t, is_last: k + 1 == times.len() };
        if let Some(solution) = solution {
            self.questions.lines(case, &step, solution, result);
        }
        let probes = self.questions.probes(case, &step, solution, result, &mut self.answers);
        self.questions.checks(case, &step, solution, result, &mut self.answers);
        if step.is_last && !self.questions.close(case, result, &mut self.answers) && status == Status::Ok {
            status = Status::CheckFailed;
        }
        result.status = status;
        result.exit = status.exit();
        probes
    }
}

/// Returns the diagnostic with the step at which it occurred.
fn at_step(fault: Diagnostic, step: usize, t: f64) -> Diagnostic {
    Diagnostic { message: format!("step {}, t = {}: {}", step + 1, crate::text_format::short(t), fault.message), ..fault }
}
