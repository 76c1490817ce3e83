//! Running a case: build, predict, assemble, solve, measure.

mod arc_length;
mod fields;
mod integrate;
mod loads;
mod predict;
mod report;
mod solve;

use super::build::{self, MakeNet, Model, free_motions, plane_net, sentences};
use super::output::{Finished, RunOptions};
use super::quantities::Questions;
use super::registry::{Names, Registry, solver_name};
use super::result::{RunResult, Status, StepReport};
use super::watch::{Progress, Stop, Watch};
use crate::constraint::SolveError;
use crate::contact::half_width;
use crate::io::case::Case;
use crate::io::errors::{Diagnostic, Diagnostics, Severity};
use crate::linalg::LinearError;
use std::sync::Arc;

pub use loads::Resultant;
pub use predict::{Prediction, bytes, predict};
pub use report::{HalfWidth, component_rows, multiplier_at};
pub use solve::{StepError, StepState, Unsolved};

/// A model with its solution.
#[derive(Debug)]
pub struct Solved<const S: usize, const N: usize> {
    /// The model.
    pub model: Model<S, N>,
    /// The last step.
    pub state: StepState<S, N>,
}

/// What belongs to a dimension.
struct Dimension<'a, const S: usize, const N: usize> {
    names: &'a Names<S, N>,
    net: MakeNet<N>,
    half_width: Option<HalfWidth<S, N>>,
}

fn plane(registry: &Registry) -> Dimension<'_, 1, 2> {
    Dimension { names: &registry.plane, net: plane_net, half_width: Some(half_width::<2, f64>) }
}

impl Case {
    /// Solves the case with the built-in or added names of `registry`.
    ///
    /// The result has a status: a check that fails or an iteration that does not settle is a result, too.
    /// # Errors
    /// What is wrong with the case, with its places.
    ///
    /// # Example
    /// ```
    /// use faying::{app::Registry, io::Case};
    /// # let text = "schema = 1\n[model]\nphysics = \"poisson\"\ndimension = 2\n[[patch]]\nname = \"a\"\ngeometry = { kind = \"box\", min = [0, 0], max = [1, 1] }\nelements = [2, 2]\n[[boundary]]\non = \"all-outer\"\ndirichlet = \"x\"\n";
    /// let case = Case::parse("demo.toml", text, &Default::default())?; // or Case::read("demo.toml")?
    /// let result = case.run(&Registry::default())?;
    /// assert_eq!(result.exit, 0);
    /// # Ok::<(), faying::io::Diagnostics>(())
    /// ```
    pub fn run(&self, registry: &Registry) -> Result<RunResult, Diagnostics> {
        solve_case("run", self, registry, &plane(registry), &Watch::default()).map(|(result, _)| result)
    }
}

/// Runs a case and keeps its fields for the files. What is wrong with the case stands in the result's diagnostics, with
/// status `Invalid` (exit 3), or `Limit` (exit 6) where the predicted memory is too large.
pub fn run(case: &Case, registry: &Registry, options: &RunOptions, watch: &Watch) -> Finished {
    match solve_case("run", case, registry, &plane(registry), watch) {
        Ok((result, solved)) => {
            let output = solved.map(|solved| {
                watch.phase("fields");
                fields::output(case, &Arc::new(solved), options)
            });
            Finished { result, output }
        }
        Err(faults) => Finished { result: refused("run", case, faults), output: None },
    }
}

/// Everything but the solve: the result has the names, the counts and the prediction.
pub fn check(case: &Case, registry: &Registry, _options: &RunOptions, watch: &Watch) -> Finished {
    let outcome = || -> Result<RunResult, Diagnostics> {
        watch.phase("build");
        let model = built(case, registry, &plane(registry))?;
        let mut result = report::skeleton("check", case, &model);
        Questions::of(case, &model, &result.to_value())?;
        result.solve = None;
        let prediction = predict(&model);
        if let Some(limit) = watch.max_memory.filter(|&limit| prediction.memory > limit) {
            return Err(memory_limit(case, &model, &prediction, limit).into());
        }
        result.predicted = Some(prediction);
        Ok(result)
    };
    let result = outcome().unwrap_or_else(|faults| refused("check", case, faults));
    Finished { result, output: None }
}

/// The result of a case that cannot be run.
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
) -> Result<Model<S, N>, Diagnostics> {
    let word = &case.solver.constraint;
    if let Err(unknown) = registry.solvers.get(solver_name(&word.value)) {
        return Err(Diagnostic::error("E015", unknown.to_string()).at(&case.source, word.at).into());
    }
    build::build(case, dimension.names, dimension.net)
}

/// A result, and the solution where there is one.
type Outcome<const S: usize, const N: usize> = (RunResult, Option<Solved<S, N>>);

fn solve_case<const S: usize, const N: usize>(
    command: &str,
    case: &Case,
    registry: &Registry,
    dimension: &Dimension<'_, S, N>,
    watch: &Watch,
) -> Result<Outcome<S, N>, Diagnostics> {
    watch.phase("build");
    let model = built(case, registry, dimension)?;
    let mut result = report::skeleton(command, case, &model);
    let questions = Questions::of(case, &model, &result.to_value())?;
    if let Some(limit) = watch.max_memory {
        let prediction = predict(&model);
        if prediction.memory > limit {
            return Err(memory_limit(case, &model, &prediction, limit).into());
        }
    }
    if let Some(stop) = watch.stop() {
        stopped(&mut result, stop);
        return Ok((result, None));
    }
    watch.phase("assemble");
    let matrices = solve::stiffness(&model);
    let times = &case.steps.value;
    let mut last: Option<StepState<S, N>> = None;
    for (k, &t) in times.iter().enumerate() {
        if let Some(stop) = watch.stop() {
            stopped(&mut result, stop);
            break;
        }
        if times.len() > 1 {
            watch.report(Progress::Step { step: k + 1, of: times.len() });
        }
        watch.phase("solve");
        let (state, failure) = match solve::step(&model, &matrices, registry, &case.solver.constraint.value, t) {
            Ok(state) => (Some(state), None),
            Err(unsolved) => (unsolved.last.map(|b| *b), Some(unsolved.error)),
        };
        if let Some(active) = state.as_ref().and_then(|s| s.active_set.as_ref()) {
            let rows = state.as_ref().map_or(0, |s| s.sign_case.iter().filter(|c| **c < 9).count());
            for (i, &n) in active.history.iter().enumerate() {
                watch.report(Progress::Iteration { iteration: i + 1, active: n, rows });
            }
        }
        watch.phase("measure");
        let (mut status, mut reason, fault) = match &failure {
            None => (Status::Ok, "converged", None),
            Some(error) => {
                let (status, reason, fault) = step_fault(case, &model, error);
                (status, reason, Some(fault))
            }
        };
        if let Some(state) = &state {
            report::fill(&mut result, &model, state, &matrices, dimension.half_width, reason);
            if status == Status::Ok && !state.u.iter().chain(&state.lambda).all(|v| v.is_finite()) {
                (status, reason) = (Status::NotFinite, "not-finite");
                result.diagnostics.push(Diagnostic::error("E073", "the solution is not finite"));
            } else if let Some(left) = floating(&model, state).filter(|_| status == Status::Ok) {
                (status, reason) = (Status::Singular, "singular");
                result.diagnostics.push(left);
            }
        }
        if let Some(solve) = &mut result.solve {
            solve.reason = reason.into();
        }
        result.diagnostics.extend(fault);
        let passed = questions.answer(case, &model, state.as_ref(), &mut result);
        if status == Status::Ok && !passed {
            status = Status::CheckFailed;
        }
        result.status = status;
        result.exit = status.exit();
        if times.len() > 1 {
            let contact = result.contact.clone();
            result.steps.push(StepReport { t, status, probes: result.probes.clone(), contact });
        }
        last = state.or(last);
        if !matches!(status, Status::Ok | Status::CheckFailed) {
            break;
        }
    }
    Ok((result, last.map(|state| Solved { model, state })))
}

fn memory_limit<const S: usize, const N: usize>(case: &Case, model: &Model<S, N>, prediction: &Prediction, limit: u64) -> Diagnostic {
    let largest = (0..model.patches.len()).max_by_key(|&k| model.patches[k].num_unknowns()).unwrap_or(0);
    let at = case.patches.get(largest).map(|p| p.elements.at).unwrap_or_default();
    let name = model.patches.get(largest).map_or("", |p| p.name.as_str());
    let text = format!("{} unknowns need about {} of memory; the limit is {}", model.unknowns, bytes(prediction.memory), bytes(limit));
    Diagnostic::error("E081", text).at(&case.source, at).with_help(format!("raise --max-memory, or give patch \"{name}\" fewer elements"))
}

fn stopped(result: &mut RunResult, stop: Stop) {
    let (status, text) = match stop {
        Stop::Interrupted => (Status::Interrupted, "the run was interrupted".to_string()),
        Stop::TimeLimit { seconds } => {
            let text = format!("the time limit of {seconds} s has passed");
            result.diagnostics.push(Diagnostic::error("E081", text.clone()).with_help("raise --time-limit"));
            (Status::Limit, text)
        }
    };
    if let Some(solve) = &mut result.solve {
        solve.reason = text;
    }
    result.status = status;
    result.exit = status.exit();
}

/// What a failed step means to the user.
fn step_fault<const S: usize, const N: usize>(case: &Case, model: &Model<S, N>, error: &StepError) -> (Status, &'static str, Diagnostic) {
    let contact = case.contacts.first().map(|c| c.active_set.max_iterations.at).unwrap_or_default();
    let at = |d: Diagnostic| d.at(&case.source, contact);
    match error {
        StepError::Solve(SolveError::Cycling { first, second, rows, .. }) => {
            let text = format!(
                "contact does not settle: the active set visited the same state twice (iterations {first} and {second}); {}",
                flipping(model, rows)
            );
            (
                Status::NotConverged,
                "cycling",
                at(Diagnostic::error("E071", text)).with_help("try active_set = { start = \"gap\" }, another c, or more elements"),
            )
        }
        StepError::Solve(SolveError::TooManyIterations { iterations, .. }) => {
            let text = format!("contact does not settle within {iterations} iterations of the active set");
            (Status::NotConverged, "iterations", at(Diagnostic::error("E071", text)).with_help("raise active_set.max_iterations"))
        }
        StepError::Solve(SolveError::RigidMotion { iteration, open, .. }) => {
            let is_open = |k: usize, p: usize, q: usize| {
                let part = &model.contacts[k].parts[p];
                let piece = part.first.segments.start.partition_point(|&s| s <= q) - 1;
                let mut ids = Vec::new();
                part.multiplier.active(part.first.segments.slave[piece], &mut ids);
                ids.iter().all(|j| open.contains(&(part.first_row + j)))
            };
            let free = free_motions(model, &|k, p, q| !is_open(k, p, q));
            let bodies = sentences(model, &free);
            let who = if bodies.is_empty() { "a body lost its support".to_string() } else { bodies.join("; ") };
            let text = format!("rigid motion left: {who} (iteration {iteration} of the active set, {} contact rows open)", open.len());
            (
                Status::Singular,
                "rigid motion left",
                Diagnostic::error("E072", text).with_help("support the body beside its contacts, or press it on"),
            )
        }
        StepError::Solve(SolveError::Linear(LinearError::NotFinite)) => {
            let text = "a number in the system is not finite; a load or a material formula has no value somewhere on its body";
            (Status::NotFinite, "not-finite", Diagnostic::error("E073", text))
        }
        StepError::Solve(SolveError::OverConstrained { row, .. }) => {
            let text = format!("the constraints are redundant: {}", owner(model, *row));
            (
                Status::Singular,
                "singular",
                Diagnostic::error("E072", text).with_help("lower the multiplier's degree or refine the slave side"),
            )
        }
        other => (Status::Singular, "singular", Diagnostic::error("E072", other.to_string())),
    }
}

/// Which interface a row belongs to, and its number there.
fn owner<const S: usize, const N: usize>(model: &Model<S, N>, row: usize) -> String {
    let ties = model.ties.iter().flat_map(|t| t.parts.iter().map(move |p| (&t.name, p.first_row, p.num_rows)));
    let contacts = model.contacts.iter().flat_map(|c| c.parts.iter().map(move |p| (&c.name, p.first_row, p.multiplier.num_functions())));
    ties.chain(contacts)
        .find(|(_, first, n)| (*first..first + n).contains(&row))
        .map_or_else(|| format!("row {row}"), |(name, first, _)| format!("row {} of \"{name}\"", row - first))
}

fn flipping<const S: usize, const N: usize>(model: &Model<S, N>, rows: &[usize]) -> String {
    let mut lists: Vec<String> = Vec::new();
    for c in &model.contacts {
        for p in &c.parts {
            let range = p.first_row..p.first_row + p.multiplier.num_functions();
            let mine: Vec<usize> = rows.iter().copied().filter(|r| range.contains(r)).collect();
            if mine.is_empty() {
                continue;
            }
            let numbers: Vec<String> = mine.iter().take(8).map(|r| (r - p.first_row).to_string()).collect();
            let more = if mine.len() > 8 { format!(" and {} more", mine.len() - 8) } else { String::new() };
            let place = place_of(p, mine[0] - p.first_row).map_or(String::new(), |x| format!(" (near {x})"));
            lists.push(format!("functions {}{more} of \"{}\" on `{}` flip{place}", numbers.join(", "), c.name, p.slave.label));
        }
    }
    lists.join("; ")
}

/// Where a multiplier function of a contact lives: its heaviest point.
fn place_of<const S: usize, const N: usize>(part: &build::ContactPart<S, N>, function: usize) -> Option<String> {
    let s = &part.first.segments;
    let mut best: Option<(f64, usize)> = None;
    let (mut ids, mut table) = (Vec::new(), crate::basis::ShapeTable::new());
    for piece in 0..s.num_pieces() {
        part.multiplier.active(s.slave[piece], &mut ids);
        let Some(a) = ids.iter().position(|&j| j == function) else { continue };
        part.multiplier.tabulate(s.slave[piece], &s.slave_xi[s.points(piece)], crate::basis::Order::Values, &mut table);
        for (k, q) in s.points(piece).enumerate() {
            let value = table.values(k)[a];
            if best.is_none_or(|b| value > b.0) {
                best = Some((value, q));
            }
        }
    }
    let (_, q) = best?;
    let list: Vec<String> =
        ["x", "y", "z"][..N].iter().zip(part.first.frames.x[q].iter()).map(|(l, v)| format!("{l} = {}", build::short(*v))).collect();
    Some(list.join(", "))
}

/// A body that the final active set leaves free: nothing determines where it is.
fn floating<const S: usize, const N: usize>(model: &Model<S, N>, state: &StepState<S, N>) -> Option<Diagnostic> {
    if model.contacts.is_empty() {
        return None;
    }
    let mut ids = Vec::new();
    // a point counts as closed where an active function lives
    let closed: Vec<Vec<Vec<bool>>> = model
        .contacts
        .iter()
        .map(|c| {
            c.parts
                .iter()
                .map(|p| {
                    let s = &p.first.segments;
                    let mut flags = vec![false; s.ds.len()];
                    for piece in 0..s.num_pieces() {
                        p.multiplier.active(s.slave[piece], &mut ids);
                        let active = ids.iter().any(|j| state.active[p.first_row + j]);
                        s.points(piece).for_each(|q| flags[q] = active);
                    }
                    flags
                })
                .collect()
        })
        .collect();
    let free = free_motions(model, &|k, p, q| closed[k][p][q]);
    if free.is_empty() {
        return None;
    }
    let text = format!("rigid motion left: {}", sentences(model, &free).join("; "));
    Some(Diagnostic::error("E072", text).with_help("every contact that held it has opened"))
}
