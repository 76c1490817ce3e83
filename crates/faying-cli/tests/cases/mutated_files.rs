//! Meshes, geometries and cases with parts exchanged: they are used, looked at and converted, or refused as the contract says.
//!
//! Each family takes a fixed sample; `FAYING_MUTATIONS=10000` in the environment makes that many of each.

#[path = "mutated_files/mutate.rs"]
mod mutate;
#[path = "mutated_files/seeds.rs"]
mod seeds;

use faying_cli::Case;
use faying_cli::case::ReadOptions;
use faying_cli::codes;
use faying_cli::convert::{ConvertOptions, convert};
use faying_cli::errors::{Diagnostic, Severity};
use faying_cli::inspect::{inspect, picture};
use faying_cli::run::{check, run};
use faying_cli::{Registry, RunControl, RunOptions};
use faying_files::{self, FileError, Format, Limits};
use mutate::{Random, mutate, mutate_case};
use seeds::{cases, seeds};
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::time::{Duration, Instant};

/// Memory that reading may take [bytes].
const READING: u64 = 2_000_000;
/// Memory beside what readers count: messages, names, the case itself [bytes].
const SLACK: u64 = 500_000;
/// Memory that a run may take [bytes].
const RUNNING: u64 = 60_000_000;

/// How many mutants of a family.
fn how_many(sample: usize) -> usize {
    std::env::var("FAYING_MUTATIONS").ok().and_then(|n| n.parse().ok()).unwrap_or(sample)
}

/// Codes whose message alone says what is allowed.
const PLAIN: [&str; 12] = ["E013", "E014", "E015", "E016", "E017", "E018", "E042", "E043", "E044", "E053", "E072", "E073"];

/// What an end must have: a known code, its exit, a place, and advice.
fn fair(all: &[Diagnostic], exit: i32, about: &str) {
    let errors: Vec<&Diagnostic> = all.iter().filter(|d| d.severity == Severity::Error).collect();
    assert!(!errors.is_empty(), "{about}: exit {exit} without an error");
    for d in errors {
        let code = codes::find(d.code).unwrap_or_else(|| panic!("{about}: {} is no code", d.code));
        assert!([3, 4, 5, 6].contains(&code.exit), "{about}: {d:?}");
        // a matrix that is singular has no line
        assert!(d.file.is_some() || exit == 5, "{about}: no file in {d:?}");
        assert!(!d.message.is_empty() && d.message.len() < 4000, "{about}: {d:?}");
        assert!(PLAIN.contains(&d.code) || d.advice().is_some_and(|a| !a.is_empty()), "{about}: no advice in {d:?}");
    }
}

fn watch() -> RunControl {
    let limit = Duration::from_secs(20);
    let deadline = Some((Instant::now() + limit, limit.as_secs_f64()));
    RunControl { max_memory: Some(RUNNING), deadline, ..RunControl::default() }
}

/// Reads, checks and runs a case; the exit.
fn use_case(folder: &Path, text: &str, registry: &Registry, about: &str) -> i32 {
    let options =
        ReadOptions { folder: Some(folder.to_owned()), memory: Some(READING), names: registry.case_names(), ..ReadOptions::default() };
    let mut read = None;
    let used = allocation_counter::measure(|| read = Some(Case::parse("case.toml", text, &options)));
    assert!(used.bytes_max <= READING + SLACK, "{about}: reading takes {} bytes", used.bytes_max);
    let case = match read.unwrap() {
        Ok(case) => case,
        Err(found) => {
            fair(&found.items, found.exit(), about);
            let exit = found.exit();
            assert!([3, 4, 6].contains(&exit), "{about}: {found}");
            return exit;
        }
    };
    let checked = check(&case, registry, &RunOptions::default(), &watch()).result;
    let finished = run(&case, registry, &RunOptions::default(), &watch());
    let exit = finished.result.exit;
    if [3, 6].contains(&checked.exit) {
        assert_eq!(exit, checked.exit, "{about}: `check` and `run` disagree: {:?}", checked.diagnostics);
    }
    if ![0, 1].contains(&exit) {
        fair(&finished.result.diagnostics, exit, about);
    }
    let json = finished.result.to_json();
    assert!(serde_json::from_str::<serde_json::Value>(&json).is_ok(), "{about}: {json}");
    exit
}

/// Looks at the file, draws it, writes it in every format.
fn look(bytes: &[u8], about: &str) -> Result<(), FileError> {
    let mut read = None;
    let limits = Limits { memory: Some(READING) };
    let used = allocation_counter::measure(|| read = Some(faying_files::parse("file", bytes, &limits)));
    assert!(used.bytes_max + bytes.len() as u64 <= READING + SLACK, "{about}: reading takes {} bytes", used.bytes_max);
    let contents = read.unwrap()?;
    if let Ok(seen) = inspect(&contents) {
        assert!(!seen.text("file").is_empty());
    }
    let _ = picture(&contents, "file");
    for format in [Format::Gmsh, Format::Gismo, Format::Mfem, Format::Vtu] {
        for binary in [false, true] {
            match convert(&contents, format, &ConvertOptions { binary, ..ConvertOptions::default() }) {
                // what is written is read again
                Ok(written) => {
                    let again = faying_files::parse("written", &written.bytes, &Limits::default());
                    assert!(again.is_ok(), "{about}: {format:?} written by us: {:?}", again.err());
                }
                Err(e) => assert!(codes::find(codes::of_file(&e)).is_some(), "{about}: {e}"),
            }
        }
    }
    Ok(())
}

/// Ends that were seen, the slowest mutant, and those that broke a rule.
#[derive(Default)]
struct Seen {
    ends: BTreeMap<i32, usize>,
    slowest: (Duration, String),
    failed: Vec<String>,
}

impl Seen {
    /// Uses one mutant; what breaks a rule is kept in a file and told at the end.
    fn mutant(&mut self, about: &str, bytes: &[u8], name: &str, used: impl FnOnce() -> i32) {
        let since = Instant::now();
        match catch_unwind(AssertUnwindSafe(used)) {
            Ok(exit) => *self.ends.entry(exit).or_default() += 1,
            Err(_) => {
                let kept = std::env::temp_dir().join(name);
                std::fs::write(&kept, bytes).unwrap();
                self.failed.push(format!("{about}, kept in {}", kept.display()));
            }
        }
        if since.elapsed() > self.slowest.0 {
            self.slowest = (since.elapsed(), about.to_owned());
        }
    }

    /// No mutant broke a rule, and each of `exits` was seen often.
    fn finish(&self, exits: [i32; 2], often: usize) {
        println!("ends {:?}, slowest {:?}", self.ends, self.slowest);
        assert!(self.failed.is_empty(), "{} mutants break a rule, see above:\n{}", self.failed.len(), self.failed.join("\n"));
        assert!(exits.iter().all(|e| self.ends.get(e).is_some_and(|n| *n >= often)), "{:?}", self.ends);
    }
}

#[test]
fn mutated_files_are_bodies_or_refused() {
    let registry = Registry::default();
    let folder = tempfile::tempdir().unwrap();
    let (seeds, mut r, mut seen) = (seeds(), Random(1), Seen::default());
    for number in 0..how_many(900) {
        let seed = &seeds[number % seeds.len()];
        let mut bytes = seed.bytes.clone();
        for _ in 0..number / seeds.len() % 3 + usize::from(number >= seeds.len()) {
            mutate(&mut bytes, &mut r);
        }
        let about = format!("mutant {number} of {}", seed.name);
        std::fs::write(folder.path().join(&seed.name), &bytes).unwrap();
        seen.mutant(&about, &bytes, &format!("mutant-{number}-{}", seed.name), || {
            if let Err(e) = look(&bytes, &about) {
                assert!(["E043", "E044", "E081"].contains(&codes::of_file(&e)), "{about}: {e}");
            }
            let exit = use_case(folder.path(), &seed.case(), &registry, &about);
            // untouched seeds run
            assert!(number >= seeds.len() || exit == 0, "{about} ends with {exit}");
            exit
        });
    }
    seen.finish([0, 3], 50);
}

#[test]
fn mutated_cases_with_files_end_as_the_contract_says() {
    let registry = Registry::default();
    let folder = tempfile::tempdir().unwrap();
    for seed in seeds() {
        std::fs::write(folder.path().join(&seed.name), &seed.bytes).unwrap();
    }
    for name in ["cross-point.xml", "iga-fe-plate.xml", "iga-fe-plate.msh"] {
        std::fs::write(folder.path().join(name), seeds::example(name)).unwrap();
    }
    let (cases, mut r, mut seen) = (cases(), Random(2), Seen::default());
    for number in 0..how_many(500) {
        let mut text = cases[number % cases.len()].clone();
        for _ in 0..number / cases.len() % 3 + usize::from(number >= cases.len()) {
            text = mutate_case(&text, &mut r);
        }
        let about = format!("mutant {number} of case {}", number % cases.len());
        seen.mutant(&about, text.as_bytes(), &format!("mutant-{number}.toml"), || {
            let exit = use_case(folder.path(), &text, &registry, &about);
            assert!(number >= cases.len() || exit <= 1, "{about} ends with {exit}");
            exit
        });
    }
    seen.finish([0, 3], 20);
}
