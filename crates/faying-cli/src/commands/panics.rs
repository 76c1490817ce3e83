//! A panic is a bug: it ends with exit 70 and a document instead of a trace.

use super::ended::Exit;
use super::streams::Streams;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, PoisonError};

/// Runs `act`; a panic in it, in any thread, becomes an internal error.
pub fn caught(streams: &Streams, act: impl FnOnce() -> Exit) -> Exit {
    let first: Arc<Mutex<Option<String>>> = Arc::default();
    let hears = first.clone();
    let verbose = streams.verbose;
    std::panic::set_hook(Box::new(move |info| {
        let payload = info.payload();
        let message = payload
            .downcast_ref::<&str>()
            .copied()
            .or_else(|| payload.downcast_ref::<String>().map(String::as_str))
            .unwrap_or("no message");
        let place = info.location().map_or(String::new(), |at| format!(" ({}:{})", at.file(), at.line()));
        hears.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(format!("{message}{place}"));
        if verbose {
            eprintln!("{}", std::backtrace::Backtrace::force_capture());
        }
    }));
    // data that a panic may have left inconsistent are not used again
    let ended = catch_unwind(AssertUnwindSafe(act));
    drop(std::panic::take_hook());
    ended.unwrap_or_else(|_| {
        let what = first.lock().unwrap_or_else(PoisonError::into_inner).take().unwrap_or_default();
        let message = format!("internal error: {}", crate::errors::one_line(&what));
        let help = "this is a bug of faying; please report it with the case file";
        Exit::plain("internal", 70, &message, Some(help))
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::commands::arguments::Arguments;
    use clap::Parser;

    #[test]
    fn a_panic_in_any_thread_is_exit_70_with_a_document() {
        let arguments = Arguments::try_parse_from(["faying", "run", "a.toml"]).unwrap();
        let streams = Streams::new(&arguments.common);
        let ended = caught(&streams, || {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
            pool.install(|| panic!("row {} is lost", 7))
        });
        assert_eq!(ended.exit, 70);
        let document: serde_json::Value = serde_json::from_str(&ended.document).unwrap();
        assert_eq!((&document["status"], &document["exit"]), (&"internal".into(), &70.into()));
        assert!(
            document["diagnostics"][0]["message"].as_str().unwrap().starts_with("internal error: row 7 is lost (crates/faying-cli/src/")
        );
    }
}
