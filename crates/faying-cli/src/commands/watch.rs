//! `faying run --watch`: solves again when the case or a file it names changes, and says which probes change.

use super::ended::{Exit, usage};
use super::streams::Streams;
use crate::table::{Table, short};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, SystemTime};

/// Time between two looks at the files.
const PAUSE: Duration = Duration::from_millis(200);

/// Time of the last change and length of a file; `None` while there is none.
type Stamp = Option<(SystemTime, u64)>;

/// Solves by `solve`, which adds the files that it reads to its list, tells the end of every run by `tell`, and waits for changes until
/// `interrupted` is set.
pub fn watch(
    case: &Path,
    streams: &Streams,
    interrupted: &AtomicBool,
    solve: &dyn Fn(&mut Vec<PathBuf>) -> Exit,
    tell: &dyn Fn(&Exit) -> i32,
) -> Exit {
    if case.as_os_str() == "-" || streams.json_on_stdout() {
        let help = "name a case file; --json=FILE writes the document of every run to FILE";
        return usage("--watch needs a case in a file, and stdout for its tables", Some(help));
    }
    if stamp(case).is_none() {
        return solve(&mut Vec::new());
    }
    let mut before: Vec<(String, f64)> = Vec::new();
    let mut files = vec![case.to_owned()];
    loop {
        // as they are before they are read: a change meanwhile is seen
        let begun: Vec<(PathBuf, Stamp)> = files.iter().map(|file| (file.clone(), stamp(file))).collect();
        files.truncate(1);
        let mut ended = solve(&mut files);
        let now = probes(&ended.document);
        ended.summary += &changes(&before, &now);
        if !now.is_empty() {
            before = now;
        }
        let exit = tell(&ended);
        if files.len() == 1 {
            // the case could not be read: what it named before counts still
            files.extend(begun[1..].iter().map(|(file, _)| file.clone()));
        }
        let first = |file: &PathBuf| begun.iter().find(|(known, _)| known == file).map_or_else(|| stamp(file), |(_, stamp)| *stamp);
        let known: Vec<Stamp> = files.iter().map(first).collect();
        loop {
            if interrupted.load(Ordering::Relaxed) {
                return Exit { exit: if exit == 70 { 70 } else { 130 }, ..Exit::default() };
            }
            std::thread::sleep(PAUSE);
            // editors put a new file in the place of the old one
            if stamp(case).is_some() && files.iter().zip(&known).any(|(file, known)| stamp(file) != *known) {
                break;
            }
        }
        streams.message(&format!("\n{} or a file it names changed: solving again\n", case.display()));
    }
}

fn stamp(file: &Path) -> Stamp {
    let known = std::fs::metadata(file).ok()?;
    Some((known.modified().ok()?, known.len()))
}

/// Names and values of the probes of a document.
fn probes(document: &str) -> Vec<(String, f64)> {
    let document: Value = serde_json::from_str(document).unwrap_or_default();
    let list = document["probes"].as_array().cloned().unwrap_or_default();
    list.iter().filter_map(|p| Some((p["name"].as_str()?.to_owned(), p["value"].as_f64()?))).collect()
}

/// A table of the probes whose values differ; empty if there are none.
fn changes(before: &[(String, f64)], now: &[(String, f64)]) -> String {
    let mut table = Table::new(["probe", "before", "now", "change"]);
    for (name, value) in now {
        let Some((_, old)) = before.iter().find(|(known, old)| known == name && old != value) else { continue };
        let share = if *old == 0.0 { "-".to_owned() } else { format!("{} %", short(100.0 * (value - old) / old.abs(), 3)) };
        table.row([name.clone(), short(*old, 8), short(*value, 8), share]);
    }
    match (table.is_empty(), before.is_empty() || now.is_empty()) {
        (true, true) => String::new(),
        (true, false) => "\nno probe changed\n".to_owned(),
        (false, _) => format!("\nchanged since the run before:\n{table}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probes_that_change_are_listed_with_their_share() {
        let list = |values: [f64; 3]| ["a", "b", "c"].map(str::to_owned).into_iter().zip(values).collect::<Vec<_>>();
        let text = changes(&list([1.0, -2.0, 0.0]), &list([1.0, -2.5, 0.5]));
        assert!(text.contains("b          -2  -2.5  -25 %") && text.contains("c           0   0.5  -") && !text.contains("\na "), "{text}");
        assert_eq!(changes(&list([1.0; 3]), &list([1.0; 3])), "\nno probe changed\n");
        assert_eq!(changes(&[], &list([1.0; 3])), "");
    }
}
