//! `faying check`: validation and size of a case, without solving.

use super::arguments::{CheckArguments, Common};
use super::case;
use super::ended::Exit;
use super::streams::Streams;
use super::summary;
use super::timing::Clock;
use crate::errors::Diagnostics;
use crate::{Progress, Registry, RunControl, RunOptions};

/// Validates a case and predicts its size; makes no folder.
pub fn check(registry: &Registry, arguments: &CheckArguments, common: &Common, streams: &Streams) -> Exit {
    let clock = Clock::start(streams);
    let ended = checked(registry, arguments, common, &clock).unwrap_or_else(|ended| ended);
    clock.stop();
    ended
}

fn checked(registry: &Registry, arguments: &CheckArguments, common: &Common, clock: &Clock) -> Result<Exit, Exit> {
    let hears = clock.clone();
    let watch = RunControl { listener: Some(Box::new(move |news| hears.hear(news))), ..case::watch(common) };
    clock.hear(Progress::Phase("read"));
    let loaded = case::load(&arguments.case, arguments.backend.as_deref(), common, registry)?;
    let pool = case::pool(common)?;
    let result = pool.install(|| crate::run::check(&loaded.case, registry, &RunOptions::default(), &watch)).result;
    let diagnostics = Diagnostics { items: result.diagnostics.iter().chain(&result.warnings).cloned().collect() };
    if result.exit != 0 {
        return Err(Exit::refused(result.exit, diagnostics));
    }
    let summary = summary::of_check(&result);
    Ok(Exit { exit: result.exit, summary, document: result.to_json(), diagnostics, message: None })
}
