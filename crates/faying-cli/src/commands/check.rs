//! `faying check`: validation and size of a case, without solving; `faying run --dry`: the same, and the model in words.

use super::arguments::{CheckArguments, Common, RunArguments};
use super::case;
use super::ended::Exit;
use super::streams::Streams;
use super::summary;
use super::timing::Clock;
use crate::case::Case;
use crate::errors::Diagnostics;
use crate::{Progress, Registry, RunControl, RunOptions, RunResult};
use std::path::Path;

/// Validates a case and predicts its size; makes no folder.
pub fn check(registry: &Registry, arguments: &CheckArguments, common: &Common, streams: &Streams) -> Exit {
    let look = |case: &Case, watch: &RunControl| crate::run::check(case, registry, &RunOptions::default(), watch).result;
    looked_at(registry, (&arguments.case, arguments.backend.as_deref()), common, streams, &look)
}

/// Prints the model of a case in words; makes no folder.
pub fn dry(registry: &Registry, arguments: &RunArguments, common: &Common, streams: &Streams) -> Exit {
    let look = |case: &Case, watch: &RunControl| crate::run::dry(case, registry, watch);
    looked_at(registry, (&arguments.case, arguments.backend.as_deref()), common, streams, &look)
}

/// Reads a case with the backend of the options, and returns what `look` finds.
fn looked_at(
    registry: &Registry,
    (path, backend): (&Path, Option<&str>),
    common: &Common,
    streams: &Streams,
    look: &(dyn Fn(&Case, &RunControl) -> RunResult + Sync),
) -> Exit {
    let clock = Clock::start(streams);
    let hears = clock.clone();
    let watch = RunControl { listener: Some(Box::new(move |news| hears.hear(news))), ..case::watch(common, &case::interrupted()) };
    clock.hear(Progress::Phase("read"));
    let outcome = case::load(path, backend, common, registry).and_then(|loaded| {
        let result = case::pool(common)?.install(|| look(&loaded.case, &watch));
        let diagnostics = Diagnostics { items: result.diagnostics.iter().chain(&result.warnings).cloned().collect() };
        if result.exit != 0 {
            return Err(Exit::refused(result.exit, diagnostics));
        }
        let summary = if result.model.is_empty() { summary::of_check(&result) } else { result.model.join("\n") + "\n" };
        Ok(Exit { exit: result.exit, summary, document: result.to_json(), diagnostics, message: None })
    });
    clock.stop();
    outcome.unwrap_or_else(|ended| ended)
}
