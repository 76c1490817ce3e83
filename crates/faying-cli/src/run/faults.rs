//! Errors of a run as diagnostics with codes and messages.

use super::room::MemoryLimit;
use crate::case::{Case, Contact};
use crate::errors::Diagnostic;
use crate::lower::Places;
use crate::place::{Located, SourceSpan};
use crate::result::{Prediction, RunResult, Status};
use crate::run_control::Stop;
use crate::text_format::{bytes, place, short};
use faying::constraint::SolveError;
use faying::contact::{Augmented, ContactError};
use faying::linalg::LinearError;
use faying::problem::{StepError, System};

/// Powers of ten by which a `factor` may differ from 1 without being to blame for a system that is not solved.
const FAR: f64 = 6.0;

/// Builds E081 for a prediction that exceeds the available memory.
pub fn memory_limit<const S: usize, const N: usize>(
    case: &Case,
    system: &System<S, N>,
    prediction: &Prediction,
    room: &MemoryLimit,
) -> Diagnostic {
    let contents = system.contents();
    let largest = (0..contents.bodies().len()).max_by_key(|&k| contents.body(k).unknowns().len()).unwrap_or(0);
    let at = case.patches.get(largest).map(|p| p.elements.at).unwrap_or_default();
    let name = contents.bodies().nth(largest).map_or("", |b| b.name());
    let text = format!("{} unknowns need about {} of memory; {}", contents.size().unknowns, bytes(prediction.memory), room.why());
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
    let given = case.contacts.iter().find(|c| c.name.value == contact).map(|c| &c.given).filter(|given| given.at("variant").is_some());
    let what = given.map_or_else(|| "the method".to_owned(), |given| format!("the {} variant", given.word("variant")));
    let text = format!("constraint = \"{}\" needs a symmetric system; {what} of contact \"{contact}\" makes one that is not", word.value);
    let instead = if given.is_some() { "variant = \"symmetric\"" } else { "another method" };
    let help = format!("write constraint = \"saddle-point\", or {instead}");
    Diagnostic::error("E015", text).at(&case.source, word.at).with_help(help)
}

/// Builds E015 for a constraint solver that needs as many slave unknowns as rows, with a contact that has a row per point.
pub fn rows_at_points(case: &Case, contact: &str) -> Diagnostic {
    let word = &case.solver.constraint;
    let method = case.contacts.iter().find(|c| c.name.value == contact).map_or("", |c| &c.method.value);
    let text = format!(
        "constraint = \"{}\" eliminates an unknown per row; method = {method:?} of contact \"{contact}\" has more rows, one per point",
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
    (system, places): (&System<S, N>, &Places),
    error: &StepError,
    t: f64,
) -> (Status, &'static str, Diagnostic) {
    if let Some(fault) = factor_fault(case, error).or_else(|| unsettled(case, system, error)) {
        return fault;
    }
    match error {
        StepError::Solve(SolveError::RigidMotion { iteration, open, .. }) => {
            let bodies: Vec<String> = system.motions_with_open(t, open).into_iter().map(|motion| motion.sentence).collect();
            let who = if bodies.is_empty() { "a body lost its support".to_string() } else { bodies.join("; ") };
            let text = format!("rigid motion left: {who} (iteration {iteration} of the active set, {} contact rows open)", open.len());
            (
                Status::Singular,
                "rigid motion left",
                Diagnostic::error("E072", text).with_help("support the body beside its contacts, or press it on"),
            )
        }
        StepError::Infeasible { what } => (
            Status::Singular,
            "infeasible load",
            Diagnostic::error("E072", format!("infeasible load: {what}")).with_help("support the body beside its contacts, or press it on"),
        ),
        StepError::Blocked { contact, slave, of, .. } => {
            let side =
                places.said((*contact).into()).and_then(|said| said.slaves.get(*slave).copied()).unwrap_or_else(|| largest_limit(case));
            let lines: Vec<String> = of.iter().filter_map(|of| places.at(*of).in_file()).map(|(line, _)| format!("line {line}")).collect();
            let of_lines = if lines.is_empty() { String::new() } else { format!(" ({})", lines.join(", ")) };
            let help = format!("prescribe values{of_lines} that leave no overlap, or let another side be the slave");
            let fault = Diagnostic::error("E072", error.to_string()).at(&case.source, side).with_help(help);
            (Status::Singular, "infeasible contact", fault)
        }
        StepError::Coarse { what } => {
            let text = format!("the contact side is too coarse for its load, which acts beyond the middle of its last function: {what}");
            let help = "give the contact side more elements, or take a multiplier of higher degree";
            (Status::Singular, "side too coarse", Diagnostic::error("E072", text).with_help(help))
        }
        StepError::Free { motions } => {
            let text = format!("rigid motion left: {}", motions.join("; "));
            (Status::Singular, "singular", Diagnostic::error("E072", text).with_help("every contact that held it has opened"))
        }
        StepError::Contact(ContactError::Gap { at: x, geometric }) => {
            let what = if geometric.is_finite() { "a gap is not finite by its formula" } else { "an obstacle has no finite gap" };
            let text = format!("{what} at {}, t = {}", place(&x[..N]), short(t));
            (Status::NotFinite, "not-finite", Diagnostic::error("E073", text))
        }
        StepError::Solve(SolveError::OverConstrained { row, .. }) => {
            let text = format!("the constraints are redundant: {}", owner(system, *row));
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
        StepError::Solve(SolveError::Linear(linear)) => {
            linear_fault(case, system.contents().size().unknowns + system.contents().size().rows, linear, error.to_string())
        }
        other => (Status::Singular, "singular", Diagnostic::error("E072", other.to_string())),
    }
}

/// Place of the limit of iterations: all contacts settle together, and the largest counts.
fn largest_limit(case: &Case) -> SourceSpan {
    let limits = case.contacts.iter().map(|c| &c.active_set.max_iterations);
    limits.rev().max_by_key(|limit| limit.value).map(|limit| limit.at).unwrap_or_default()
}

/// Status, reason and diagnostic of an iteration of contacts that does not end.
fn unsettled<const S: usize, const N: usize>(
    case: &Case,
    system: &System<S, N>,
    error: &StepError,
) -> Option<(Status, &'static str, Diagnostic)> {
    let limit = largest_limit(case);
    let at = |d: Diagnostic| d.at(&case.source, limit);
    Some(match error {
        StepError::Solve(SolveError::Cycling { first, second, rows, iterations, .. }) => {
            let text = format!(
                "contact does not settle: the active set visited the same state twice (iterations {first} and {second}), and single \
                 exchanges did not end within {iterations} iterations; {}",
                flipping(system, rows)
            );
            let help = "raise active_set.max_iterations, or try another start: \"all\", \"gap\", { seed = 1 }";
            (Status::NotConverged, "cycling", at(Diagnostic::error("E071", text)).with_help(help))
        }
        StepError::Solve(SolveError::TooManyIterations { iterations, .. }) => {
            let text = format!("contact does not settle within {iterations} iterations of the active set");
            (Status::NotConverged, "iterations", at(Diagnostic::error("E071", text)).with_help("raise active_set.max_iterations"))
        }
        StepError::Solve(SolveError::Multipliers { .. }) => {
            // all contacts iterate to the least tolerance of them
            let value = |c: &Contact| c.given.written("tolerance").map_or(Augmented::TOLERANCE, |t| t.value);
            let all = case.contacts.iter().filter_map(|c| Some((c, c.given.at("tolerance")?)));
            let least = all.min_by(|(a, _), (b, _)| value(a).total_cmp(&value(b)));
            let (key, whose) = least.map_or((limit, "the contact".to_owned()), |(c, at)| (at, format!("contact \"{}\"", c.name.value)));
            let help = format!("raise `factor` or `tolerance` of {whose}, or write method = \"lagrange\"");
            (Status::NotConverged, "iterations", Diagnostic::error("E074", error.to_string()).at(&case.source, key).with_help(help))
        }
        StepError::Obstacle { .. } => {
            let help = "give the side smaller elements where it touches (a few across the zone), start it near the body, or prescribe its motion by `move`";
            (Status::NotConverged, "obstacle", at(Diagnostic::error("E071", error.to_string())).with_help(help))
        }
        _ => return None,
    })
}

/// Status, reason and diagnostic of a system that the `factor` of an interface or contact spoils.
fn factor_fault(case: &Case, error: &StepError) -> Option<(Status, &'static str, Diagnostic)> {
    let (status, code) = match error {
        StepError::Solve(SolveError::Linear(LinearError::NotFinite)) => (Status::NotFinite, "E073"),
        StepError::Solve(SolveError::Linear(LinearError::Singular { .. })) => (Status::Singular, "E072"),
        StepError::Solve(SolveError::Residual { .. } | SolveError::Conditions { .. } | SolveError::Multipliers { .. }) => {
            (Status::NotConverged, "E074")
        }
        _ => return None,
    };
    let (who, factor) = extreme_factor(case)?;
    let size = if factor.value < 1.0 { "small" } else { "large" };
    let text = format!("`factor` of {who} is too {size}, found {:e}: {error}", factor.value);
    let fault = Diagnostic::error(code, text).at(&case.source, factor.at);
    Some((status, "factor", fault.with_help("leave `factor` out, or write a number nearer to 1")))
}

/// The `factor` of an interface or contact that is farthest from 1, with the name of that, if it is far enough to spoil the system.
fn extreme_factor(case: &Case) -> Option<(String, Located<f64>)> {
    let ties = case.interfaces.iter().map(|t| (format!("interface \"{}\"", t.name.value), t.given.written("factor")));
    let contacts = case.contacts.iter().map(|c| (format!("contact \"{}\"", c.name.value), c.given.written("factor")));
    let far = |factor: f64| factor.log10().abs();
    let all = ties.chain(contacts).filter_map(|(who, factor)| Some((who, factor?)));
    all.filter(|(_, f)| far(f.value) > FAR).max_by(|a, b| far(a.1.value).total_cmp(&far(b.1.value)))
}

/// Returns status, reason and diagnostic of linear algebra that failed with the error `message` on a system of `size` unknowns.
fn linear_fault(case: &Case, size: usize, error: &LinearError, message: String) -> (Status, &'static str, Diagnostic) {
    match error {
        LinearError::NotFinite => {
            let text = "a number in the system is not finite: a load or a material formula has no value somewhere on its body, or a \
                        product of large numbers overflows";
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
            let raise = MemoryLimit::least(None).map_or("raise the limits of the process", |room| room.raise());
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

/// Describes a row: its number within an interface or contact, and the name of that.
fn owner<const S: usize, const N: usize>(system: &System<S, N>, row: usize) -> String {
    system.row_owner(row).map_or_else(|| format!("row {row}"), |(_, name, number)| format!("row {number} of \"{name}\""))
}

/// Describes contact rows that change from set to set.
fn flipping<const S: usize, const N: usize>(system: &System<S, N>, rows: &[usize]) -> String {
    let of_side = |rows: faying::problem::RowsOfSide<N>| {
        let numbers: Vec<String> = rows.numbers.iter().take(8).map(usize::to_string).collect();
        let more = if rows.numbers.len() > 8 { format!(" and {} more", rows.numbers.len() - 8) } else { String::new() };
        let near = rows.place.map_or(String::new(), |x| format!(" (near {})", place(x.as_slice())));
        let what = if rows.at_points { "points" } else { "functions" };
        format!("{what} {}{more} of \"{}\" on `{}` flip{near}", numbers.join(", "), rows.contact, rows.slave)
    };
    system.contact_rows(rows).into_iter().map(of_side).collect::<Vec<_>>().join("; ")
}
