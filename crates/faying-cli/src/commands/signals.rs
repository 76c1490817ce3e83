//! Requests to end: Ctrl-C, and on Unix SIGTERM and SIGHUP, which come from schedulers, services and terminals that close.

use std::io::Write;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Sets `flag` at every request to end, with a message. A second Ctrl-C ends at once; other requests come in pairs (a terminal and its
/// shell both hang up), so that only the first of them counts.
///
/// SIGHUP stays ignored where the process was started so, as under `nohup`.
pub fn listen(flag: &Arc<AtomicBool>) {
    let flag = Arc::clone(flag);
    // without a listener a request ends the program at once, as it does for programs that have none
    let _ = platform::listen(move |request: Request| {
        let known = flag.swap(true, Ordering::Relaxed);
        let text = match request {
            Request::Interrupt if known => std::process::exit(130),
            Request::Interrupt => "interrupted: writing what there is; press again to end at once",
            Request::End(_) if known => return,
            Request::End(name) => &format!("asked to end by {name}: writing what there is"),
        };
        // the terminal may be gone
        let _ = writeln!(std::io::stderr(), "{text}");
    });
}

/// Request to end.
enum Request {
    /// Ctrl-C.
    Interrupt,
    /// The signal of this name.
    #[cfg_attr(not(unix), allow(dead_code))]
    End(&'static str),
}

#[cfg(unix)]
mod platform {
    use crate::commands::signals::Request;
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    use signal_hook::iterator::Signals;

    pub(super) fn listen(mut hear: impl FnMut(Request) + Send + 'static) -> std::io::Result<()> {
        let ignored = std::fs::read_to_string("/proc/self/status").map_or(0, |status| crate::commands::signals::ignored(&status));
        let hangs_up = (ignored >> (SIGHUP - 1)) & 1 == 0;
        let mut signals = Signals::new([SIGINT, SIGTERM].into_iter().chain(hangs_up.then_some(SIGHUP)))?;
        let each = move || {
            for signal in signals.forever() {
                hear(match signal {
                    SIGINT => Request::Interrupt,
                    SIGTERM => Request::End("SIGTERM"),
                    _ => Request::End("SIGHUP"),
                });
            }
        };
        std::thread::Builder::new().name("signals".into()).spawn(each).map(drop)
    }
}

#[cfg(not(unix))]
mod platform {
    use crate::commands::signals::Request;

    pub(super) fn listen(mut hear: impl FnMut(Request) + Send + 'static) -> Result<(), ctrlc::Error> {
        ctrlc::set_handler(move || hear(Request::Interrupt))
    }
}

/// The signals that a process ignores, signal n in bit n - 1, read from its status file on Linux.
#[cfg(unix)]
fn ignored(status: &str) -> u64 {
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}

#[cfg(all(test, unix))]
mod tests {
    #[test]
    fn ignored_signals_are_read_from_the_status() {
        assert_eq!(crate::commands::signals::ignored("Name:\tx\nSigBlk:\t0000000000000001\nSigIgn:\t0000000000000003\n"), 3);
        assert_eq!(crate::commands::signals::ignored("Name:\tx\n"), 0);
    }
}
