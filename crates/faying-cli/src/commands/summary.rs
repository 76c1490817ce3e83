//! The short summary of a run for stdout.

use crate::result::{GluedSides, Moment, RunResult};
use crate::table::{Table, short};
use crate::text_format::bytes;
use std::fmt::Write as _;

/// A few lines and tables: the case, the active set, sides, errors, probes, checks.
pub fn of(result: &RunResult, folder: Option<&str>) -> String {
    let mut text = String::new();
    // writing to a String cannot fail
    let _ = writeln!(text, "{}: {}", result.case, status(result));
    let bodies = result.backends.iter().map(|(patch, backend)| format!("{patch} {backend}")).collect::<Vec<_>>().join(", ");
    let u = &result.unknowns;
    let _ = writeln!(text, "{bodies}; {} unknowns, {} multipliers", u.primal, u.multipliers);
    if let Some(solve) = result.solve.as_ref().filter(|_| result.solved) {
        let iterations = if solve.iterations > 0 { format!(", {} iterations", solve.iterations) } else { String::new() };
        let _ = writeln!(text, "{}{iterations}; residual {}", solve.linear, short(solve.residual, 2));
        if let Some(set) = &solve.active_set {
            let list = |numbers: &[usize]| numbers.iter().map(usize::to_string).collect::<Vec<_>>().join(" ");
            let before = if set.sets.is_empty() { String::new() } else { format!(" after {} sets of the rows alone", set.sets.len()) };
            let _ = writeln!(text, "active set: {} iterations{before}, active rows {}", set.iterations, list(&set.history));
            if set.iterations > 1 {
                let _ = writeln!(text, "            violated rows per iteration {}", list(&set.wrong));
            }
            for note in &set.notes {
                let _ = writeln!(text, "            {note}");
            }
            if solve.reason != "converged" && set.best > 0 {
                let _ = writeln!(text, "            the results show iteration {}, with the fewest violated rows", set.best);
            }
        }
    }
    let numbers = if result.solved { vec![loads(result), contacts(result), interfaces(result), errors(result)] } else { Vec::new() };
    for table in numbers.into_iter().chain([steps(result), probes(result), checks(result)]) {
        if !table.is_empty() {
            let _ = write!(text, "\n{table}");
        }
    }
    if let Some(folder) = folder {
        let _ = writeln!(text, "\nresults in {folder}");
    }
    text
}

/// Summary of a check: the case is valid, with its patches, ties and sizes.
pub fn of_check(result: &RunResult) -> String {
    let mut table = Table::new(["patch", "backend", "measure"]);
    for (patch, backend) in result.backends.iter() {
        table.row([patch.to_owned(), backend.clone(), result.geometry.measure.get(patch).map_or("-".to_owned(), |m| short(*m, 8))]);
    }
    let mut tied = Table::new(["interface", "slave", "master", "distance", "share"]);
    for (name, report) in result.interface.iter() {
        for s in &report.sides {
            tied.row([name.to_owned(), s.slave.clone(), s.master.clone(), short(s.distance, 3), short(s.share, 6)]);
        }
    }
    for GluedSides { interface, sides: s } in &result.geometry.glued {
        tied.row([interface.clone(), s.slave.clone(), s.master.clone(), short(s.distance, 3), short(s.share, 6)]);
    }
    let tied = if tied.is_empty() { String::new() } else { format!("{tied}\n") };
    let loads = loads(result);
    let loads = if loads.is_empty() { String::new() } else { format!("{loads}\n") };
    let u = &result.unknowns;
    let memory = result.predicted.map_or(String::new(), |p| format!("; about {} of memory", bytes(p.memory)));
    format!("{}: valid\n\n{table}\n{tied}{loads}{} unknowns, {} multipliers{memory}\n", result.case, u.primal, u.multipliers)
}

/// Steps shown; `history.csv` has all of them.
const STEPS_SHOWN: usize = 20;

/// The last steps: time, status, probes, and the force and active rows of every contact.
pub(super) fn steps(result: &RunResult) -> Table {
    let mut head = vec!["t".to_owned(), "status".to_owned()];
    head.extend(result.probes.iter().map(|p| p.name.clone()));
    head.extend(result.contact.iter().flat_map(|(name, _)| [format!("{name}.force"), format!("{name}.active")]));
    let mut table = Table::new(head);
    for step in &result.steps[result.steps.len().saturating_sub(STEPS_SHOWN)..] {
        let word = serde_json::to_value(step.status).ok().and_then(|v| v.as_str().map(str::to_owned)).unwrap_or_default();
        let mut row = vec![short(step.t, 6), word];
        row.extend(step.probes.iter().map(|p| short(p.value, 8)));
        for (name, _) in result.contact.iter() {
            let of = step.contact.get(name);
            row.extend([of.map_or("-".to_owned(), |c| vector(&c.force)), of.map_or("-".to_owned(), |c| c.active.to_string())]);
        }
        table.row(row);
    }
    table
}

pub(super) fn status(result: &RunResult) -> String {
    serde_json::to_value(result.status).ok().and_then(|v| v.as_str().map(str::to_owned)).unwrap_or_default()
}

pub(super) fn vector(values: &[f64]) -> String {
    format!("({})", values.iter().map(|v| short(*v, 5)).collect::<Vec<_>>().join(", "))
}

pub(super) fn loads(result: &RunResult) -> Table {
    let mut table = Table::new(["load", "resultant", "moment"]);
    for (name, load) in result.loads.iter() {
        table.row([name.to_owned(), vector(&load.force), moment(load.moment.as_ref())]);
    }
    table
}

pub(super) fn moment(moment: Option<&Moment>) -> String {
    match moment {
        None => "-".to_owned(),
        Some(Moment::Plane(m)) => short(*m, 5),
        Some(Moment::Space(m)) => vector(m),
    }
}

pub(super) fn contacts(result: &RunResult) -> Table {
    let mut table = Table::new(["contact", "force", "largest pressure", "area", "half width", "least gap", "active"]);
    for (name, c) in result.contact.iter() {
        table.row([
            name.to_owned(),
            vector(&c.force),
            short(c.pressure.max, 6),
            short(c.area, 6),
            c.half_width.map_or("-".to_owned(), |width| short(width, 6)),
            short(c.gap.least, 3),
            c.active.to_string(),
        ]);
    }
    table
}

pub(super) fn interfaces(result: &RunResult) -> Table {
    let mut table = Table::new(["interface", "|lambda|", "jump", "distance", "segments"]);
    for (name, i) in result.interface.iter() {
        table.row([name.to_owned(), short(i.lambda.norm, 6), short(i.jump.l2, 3), short(i.distance, 3), i.segments.count.to_string()]);
    }
    table
}

pub(super) fn errors(result: &RunResult) -> Table {
    let mut table = Table::new(["error", "value"]);
    for (name, value) in result.errors.iter().filter(|(name, _)| !name.ends_with(".rel")) {
        table.row([name.to_owned(), short(*value, 6)]);
    }
    table
}

pub(super) fn probes(result: &RunResult) -> Table {
    let mut table = Table::new(["probe", "value", "quantity"]);
    for probe in &result.probes {
        let value = if probe.value.is_finite() { short(probe.value, 10) } else { "-".to_owned() };
        let place = probe.at.as_ref().map_or(String::new(), |x| format!(" at {}", vector(x)));
        let place = probe.patch.as_ref().map_or(place, |patch| format!(", of \"{patch}\": other bodies meet it there"));
        table.row([probe.name.clone(), value, probe.reason.clone().unwrap_or_else(|| probe.quantity.clone() + &place)]);
    }
    table
}

pub(super) fn checks(result: &RunResult) -> Table {
    let mut table = Table::new(["check", "value", "", "wanted", "verdict"]);
    for check in &result.checks {
        let verdict = match (check.skipped, check.ok) {
            (true, _) => "skipped".to_owned(),
            (_, true) => "passed".to_owned(),
            (_, false) => check.reason.as_ref().map_or("FAILED".to_owned(), |r| format!("FAILED: {r}")),
        };
        table.row([check.name.clone(), short(check.value, 8), check.relation.clone(), short(check.expected, 8), verdict]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::result::{ActiveSetSummary, SolveReport};

    #[test]
    fn an_iteration_that_does_not_settle_says_which_state_is_shown() {
        let mut result = RunResult::new("run", "a.toml");
        result.solved = true;
        let set = ActiveSetSummary { iterations: 3, history: vec![7, 4, 5], wrong: vec![7, 0, 2], best: 2, ..Default::default() };
        result.solve = Some(SolveReport { reason: "cycling".into(), active_set: Some(set), ..Default::default() });
        let text = of(&result, None);
        assert!(text.contains("violated rows per iteration 7 0 2"), "{text}");
        assert!(text.contains("the results show iteration 2, with the fewest violated rows"), "{text}");
    }
}
