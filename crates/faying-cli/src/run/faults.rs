//! Errors of a run as diagnostics with codes and messages.

use super::predict::{Prediction, bytes};
use super::room::Room;
use crate::case::{Case, Method, Variant};
use crate::errors::Diagnostic;
use crate::result::{RunResult, Status};
use crate::watch::Stop;
use crate::words::short;
use faying::constraint::SolveError;
use faying::contact::ContactError;
use faying::linalg::LinearError;
use faying::problem::{ContactModel, ContactPart, Model, StepError, StepState, closed_points, free_motions, left_free, sentences};
use std::collections::HashSet;

/// Builds E081 for a prediction that exceeds the available memory.
pub fn memory_limit<const S: usize, const N: usize>(case: &Case, model: &Model<S, N>, prediction: &Prediction, room: &Room) -> Diagnostic {
    let largest = (0..model.patches.len()).max_by_key(|&k| model.patches[k].num_unknowns()).unwrap_or(0);
    let at = case.patches.get(largest).map(|p| p.elements.at).unwrap_or_default();
    let name = model.patches.get(largest).map_or("", |p| p.name.as_str());
    let text = format!("{} unknowns need about {} of memory; {}", model.unknowns, bytes(prediction.memory), room.why());
    Diagnostic::error("E081", text).at(&case.source, at).with_help(format!("{}, or give patch \"{name}\" fewer elements", room.raise()))
}

/// Builds E015 for a constraint solver that needs symmetry, with an interface or contact (`who`) that is not symmetric by mixed integration
/// or by its coupling.
pub fn not_symmetric(case: &Case, who: &str, mixed: bool) -> Diagnostic {
    let word = &case.solver.constraint;
    let (what, instead) = match mixed {
        true => ("integration = \"mixed\"", "integration = \"merged\""),
        false => ("the coupling", "variant = \"symmetric\""),
    };
    let text = format!("constraint = \"{}\" needs a symmetric system; {what} of {who} makes one that is not", word.value);
    let help = format!("write constraint = \"saddle-point\" (with linear = \"iterative\" GMRES over the symmetric factor), or {instead}");
    Diagnostic::error("E015", text).at(&case.source, word.at).with_help(help)
}

/// Builds E015 for a constraint solver that needs symmetry, with a contact whose system is not symmetric.
pub fn contact_not_symmetric(case: &Case, contact: &str) -> Diagnostic {
    let word = &case.solver.constraint;
    let variant = case.contacts.iter().find(|c| c.name.value == contact).map_or(Variant::Symmetric, |c| c.variant.value);
    let text = format!(
        "constraint = \"{}\" needs a symmetric system; the {} variant of contact \"{contact}\" makes one that is not",
        word.value,
        format!("{variant:?}").to_lowercase()
    );
    let help = "write constraint = \"saddle-point\", or variant = \"symmetric\"";
    Diagnostic::error("E015", text).at(&case.source, word.at).with_help(help)
}

/// Builds E015 for a constraint solver that needs as many slave unknowns as rows, with a contact that has a row per point.
pub fn rows_at_points(case: &Case, contact: &str) -> Diagnostic {
    let word = &case.solver.constraint;
    let text = format!(
        "constraint = \"{}\" eliminates an unknown per row; method = \"nitsche\" of contact \"{contact}\" has more rows, one per point",
        word.value
    );
    Diagnostic::error("E015", text).at(&case.source, word.at).with_help("write constraint = \"saddle-point\"")
}

/// Marks a result as stopped early.
pub fn stopped(result: &mut RunResult, stop: Stop) {
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

/// Returns status, reason and diagnostic of a failed step.
pub fn step_fault<const S: usize, const N: usize>(
    case: &Case,
    model: &Model<S, N>,
    error: &StepError,
    t: f64,
) -> (Status, &'static str, Diagnostic) {
    // all contacts settle together: the largest limit counts
    let limits = case.contacts.iter().map(|c| &c.active_set.max_iterations);
    let contact = limits.rev().max_by_key(|limit| limit.value).map(|limit| limit.at).unwrap_or_default();
    let at = |d: Diagnostic| d.at(&case.source, contact);
    match error {
        StepError::Solve(SolveError::Cycling { first, second, rows, iterations, .. }) => {
            let text = format!(
                "contact does not settle: the active set visited the same state twice (iterations {first} and {second}), and single \
                 exchanges did not end within {iterations} iterations; {}",
                flipping(model, rows)
            );
            (
                Status::NotConverged,
                "cycling",
                at(Diagnostic::error("E071", text))
                    .with_help("raise active_set.max_iterations, or try another start: \"all\", \"gap\", { seed = 1 }"),
            )
        }
        StepError::Solve(SolveError::TooManyIterations { iterations, .. }) => {
            let text = format!("contact does not settle within {iterations} iterations of the active set");
            (Status::NotConverged, "iterations", at(Diagnostic::error("E071", text)).with_help("raise active_set.max_iterations"))
        }
        StepError::Solve(SolveError::Multipliers { .. }) => {
            let key = case.contacts.iter().find(|c| c.method.value == Method::Augmented).map_or(contact, |c| c.tolerance.at);
            let help = "raise `factor` or `tolerance` of the contact, or write method = \"lagrange\"";
            (Status::NotConverged, "iterations", Diagnostic::error("E074", error.to_string()).at(&case.source, key).with_help(help))
        }
        StepError::Solve(SolveError::RigidMotion { iteration, open, .. }) => {
            let open: HashSet<usize> = open.iter().copied().collect();
            let bodies = loose_bodies(model, &open, t);
            let who = if bodies.is_empty() { "a body lost its support".to_string() } else { bodies.join("; ") };
            let text = format!("rigid motion left: {who} (iteration {iteration} of the active set, {} contact rows open)", open.len());
            (
                Status::Singular,
                "rigid motion left",
                Diagnostic::error("E072", text).with_help("support the body beside its contacts, or press it on"),
            )
        }
        StepError::Obstacle { .. } => {
            let help = "start it near the body (geometry or earlier steps), or prescribe its motion by `move`";
            (Status::NotConverged, "obstacle", at(Diagnostic::error("E071", error.to_string())).with_help(help))
        }
        StepError::Infeasible { what } => (
            Status::Singular,
            "infeasible load",
            Diagnostic::error("E072", format!("infeasible load: {what}")).with_help("support the body beside its contacts, or press it on"),
        ),
        StepError::Coarse { what } => {
            let text = format!("the contact side is too coarse for its load, which acts beyond the middle of its last function: {what}");
            let help = "give the contact side more elements, or take a multiplier of higher degree";
            (Status::Singular, "side too coarse", Diagnostic::error("E072", text).with_help(help))
        }
        StepError::Contact(ContactError::Gap { .. }) => (Status::NotFinite, "not-finite", Diagnostic::error("E073", error.to_string())),
        StepError::Solve(SolveError::OverConstrained { row, .. }) => {
            let text = format!("the constraints are redundant: {}", owner(model, *row));
            (
                Status::Singular,
                "singular",
                Diagnostic::error("E072", text).with_help("lower the multiplier's degree or refine the slave side"),
            )
        }
        StepError::Solve(SolveError::Residual { .. } | SolveError::Conditions { .. } | SolveError::Shape { .. }) => {
            let word = &case.solver.constraint;
            let text = format!("constraint = \"{}\" does not solve the system: {error}", word.value);
            let help = "faying::check::solver finds what is wrong with a solver; constraint = \"auto\" is that of the program";
            (Status::NotConverged, "wrong answer", Diagnostic::error("E074", text).at(&case.source, word.at).with_help(help))
        }
        StepError::Solve(SolveError::Linear(linear)) => linear_fault(case, model.unknowns + model.rows, linear, error.to_string()),
        other => (Status::Singular, "singular", Diagnostic::error("E072", other.to_string())),
    }
}

/// Returns status, reason and diagnostic of linear algebra that failed with the error `message` on a system of `size` unknowns.
fn linear_fault(case: &Case, size: usize, error: &LinearError, message: String) -> (Status, &'static str, Diagnostic) {
    match error {
        LinearError::NotFinite => {
            let text = "a number in the system is not finite; a load or a material formula has no value somewhere on its body";
            (Status::NotFinite, "not-finite", Diagnostic::error("E073", text))
        }
        LinearError::NotConverged { iterations, residual, tolerance } => {
            let text = format!(
                "the iterative solver stopped after {iterations} iterations at the relative residual {residual:.1e}; wanted {tolerance:.1e}"
            );
            let s = &case.solver;
            let at = s.max_iterations.map_or(s.linear.at, |m| m.at);
            let help = "raise solver.max_iterations or solver.tolerance, or write linear = \"direct\" with constraint = \"saddle-point\"";
            (Status::NotConverged, "iterations", Diagnostic::error("E074", text).at(&case.source, at).with_help(help))
        }
        LinearError::Indefinite { .. } => {
            let help = "raise `factor` beside \"nitsche\" (auto is 4), or write variant = \"unsymmetric\"";
            (Status::Singular, "indefinite", Diagnostic::error("E072", message).with_help(help))
        }
        LinearError::Memory => {
            let text = format!("{size} unknowns: the memory that is left does not hold the factor and what dense products take beside it");
            let key = case.patches.first().map(|p| p.elements.at).unwrap_or_default();
            let raise = Room::least(None).map_or("raise the limits of the process", |room| room.raise());
            let help = format!("{raise}; give the bodies fewer elements, or write linear = \"iterative\"");
            (Status::Limit, "memory", Diagnostic::error("E081", text).at(&case.source, key).with_help(help))
        }
        LinearError::NotSymmetric => {
            let help = "write constraint = \"saddle-point\", or variant = \"symmetric\" for coupling = \"nitsche\"";
            (Status::Singular, "not symmetric", Diagnostic::error("E072", message).with_help(help))
        }
        _ => (Status::Singular, "singular", Diagnostic::error("E072", message)),
    }
}

/// Sentences on the bodies that have a rigid motion at time t with the contact rows `open`.
fn loose_bodies<const S: usize, const N: usize>(model: &Model<S, N>, open: &HashSet<usize>, t: f64) -> Vec<String> {
    let at_time =
        |c: &ContactModel<S, N>| -> Vec<_> { c.parts.iter().map(|p| c.at(model, p, t).unwrap_or_else(|_| p.first.clone())).collect() };
    let contacts: Vec<Vec<_>> = model.contacts.iter().map(at_time).collect();
    let contacts: Vec<Vec<_>> = contacts.iter().map(|c| c.iter().collect()).collect();
    // a point counts as closed if an enforced function is active there
    let closed = closed_points(model, &contacts, &|row| !open.contains(&row));
    let free = free_motions(model, &contacts, &|k, p, q| closed[k][p][q]);
    sentences(model, &free)
}

/// Describes a row: its number within an interface or contact, and the name of that.
fn owner<const S: usize, const N: usize>(model: &Model<S, N>, row: usize) -> String {
    let ties = model.ties.iter().flat_map(|t| t.parts.iter().map(move |p| (&t.name, p.first_row, p.num_rows)));
    let contacts = model.contacts.iter().flat_map(|c| c.parts.iter().map(move |p| (&c.name, p.first_row, p.num_rows)));
    ties.chain(contacts)
        .find(|(_, first, n)| (*first..first + n).contains(&row))
        .map_or_else(|| format!("row {row}"), |(name, first, _)| format!("row {} of \"{name}\"", row - first))
}

fn flipping<const S: usize, const N: usize>(model: &Model<S, N>, rows: &[usize]) -> String {
    let mut lists: Vec<String> = Vec::new();
    for c in &model.contacts {
        for p in &c.parts {
            let range = p.rows();
            let mine: Vec<usize> = rows.iter().copied().filter(|r| range.contains(r)).collect();
            if mine.is_empty() {
                continue;
            }
            let numbers: Vec<String> = mine.iter().take(8).map(|r| (r - p.first_row).to_string()).collect();
            let more = if mine.len() > 8 { format!(" and {} more", mine.len() - 8) } else { String::new() };
            let place = place_of(p, mine[0] - p.first_row).map_or(String::new(), |x| format!(" (near {x})"));
            let what = if p.multiplier.is_some() { "functions" } else { "points" };
            lists.push(format!("{what} {}{more} of \"{}\" on `{}` flip{place}", numbers.join(", "), c.name, p.slave.label));
        }
    }
    lists.join("; ")
}

/// Place of a multiplier function of a contact: its point of largest weight.
fn place_of<const S: usize, const N: usize>(part: &ContactPart<S, N>, function: usize) -> Option<String> {
    let s = &part.first.segments;
    let (mut best, mut pieces): (Option<(f64, usize)>, _) = (None, 0..s.num_pieces());
    let (mut ids, mut table) = (Vec::new(), faying::basis::ShapeTable::new());
    if let Some(points) = &part.first.points {
        best = points.row.iter().position(|&j| j == function).map(|q| (1.0, q));
        pieces = 0..0;
    }
    for piece in pieces {
        let psi = part.multiplier.as_ref()?;
        psi.active(s.slave[piece], &mut ids);
        let Some(a) = ids.iter().position(|&j| j == function) else { continue };
        psi.tabulate(s.slave[piece], &s.slave_xi[s.points(piece)], faying::basis::Order::Values, &mut table);
        for (k, q) in s.points(piece).enumerate() {
            let value = table.values(k)[a];
            if best.is_none_or(|b| value > b.0) {
                best = Some((value, q));
            }
        }
    }
    let (_, q) = best?;
    let list: Vec<String> =
        ["x", "y", "z"][..N].iter().zip(part.first.frames.x[q].iter()).map(|(l, v)| format!("{l} = {}", short(*v))).collect();
    Some(list.join(", "))
}

/// Returns E072 if the final active set leaves a body a rigid motion, so that its position is not determined.
pub fn floating<const S: usize, const N: usize>(model: &Model<S, N>, state: &StepState<S, N>) -> Option<Diagnostic> {
    let text = format!("rigid motion left: {}", left_free(model, state)?.join("; "));
    Some(Diagnostic::error("E072", text).with_help("every contact that held it has opened"))
}
