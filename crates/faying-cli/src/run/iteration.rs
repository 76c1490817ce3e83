//! Report of an active-set iteration, in numbers and in words.

use crate::result::ActiveSetSummary;
use faying::constraint::{ActiveSetEvent, ActiveSetReport};

/// Returns the summary of a report for `result.json`.
pub fn summary(report: &ActiveSetReport) -> ActiveSetSummary {
    ActiveSetSummary {
        iterations: report.iterations,
        history: report.history.clone(),
        sets: report.sets.clone(),
        wrong: report.violated().collect(),
        sign_cases: report.sign_cases.clone(),
        cycles: report.cycles().count(),
        best: report.best,
        notes: report.events.iter().map(note).collect(),
        updates: Some(report.updates).filter(|&n| n > 0),
    }
}

/// Describes an event other than a nominal step.
fn note(event: &ActiveSetEvent) -> String {
    match event {
        ActiveSetEvent::Symmetric { sets: 1 } => "start: the set of the symmetric system, found in one set of its rows alone".into(),
        ActiveSetEvent::Symmetric { sets } => format!("start: the set of the symmetric system, found in {sets} sets of its rows alone"),
        ActiveSetEvent::Alone(event) => format!("rows alone: {}", note_of("set", event)),
        event => note_of("iteration", event),
    }
}

/// Describes an event of what is counted as `one`: an iteration, or a set of the rows alone.
fn note_of(one: &str, event: &ActiveSetEvent) -> String {
    match event {
        ActiveSetEvent::AllClosed { iteration: 1 } => format!("{one} 1: the start left a body free; all rows were closed"),
        ActiveSetEvent::AllClosed { iteration } => format!("{one} {iteration}: the step left a body free; all rows were closed"),
        ActiveSetEvent::Part { iteration, changed, wanted } => {
            format!("{one} {iteration}: the step left a body free; {changed} of {wanted} rows changed")
        }
        ActiveSetEvent::Springs { iteration } => {
            format!("{one} {iteration}: every step left a body free; weak springs found the rows that hold it, and were taken away")
        }
        ActiveSetEvent::Cycle(c) => {
            let (first, second) = (c.first, c.second);
            format!("{one} {second}: the state of {one} {first} came back, {} rows flip; single exchanges follow", c.rows.len())
        }
        other => format!("{other:?}"),
    }
}

/// Lines for the log: every iteration with its sign cases, then the events.
pub fn lines(report: &ActiveSetReport) -> Vec<String> {
    let mut lines = vec!["active set: iteration, active and violated rows; rows lambda < 0, = 0, > 0 by gap = 0, > 0, < 0".to_owned()];
    let wrong = report.violated();
    for (k, ((active, wrong), cases)) in report.history.iter().zip(wrong).zip(&report.sign_cases).enumerate() {
        let row = |r: usize| cases[3 * r..3 * r + 3].iter().map(usize::to_string).collect::<Vec<_>>().join(" ");
        lines.push(format!("  {:3} {active:6} {wrong:6}   {} | {} | {}", k + 1, row(0), row(1), row(2)));
    }
    if !report.sets.is_empty() {
        let closed: Vec<String> = report.sets.iter().map(usize::to_string).collect();
        lines.push(format!("  decided by the rows alone before: {} sets with {} closed", closed.len(), closed.join(", ")));
    }
    lines.extend(report.events.iter().map(|event| format!("  {}", note(event))));
    lines
}
