//! Whole runs through the library: sample cases, quantities, errors of the build, repeatability.
#![cfg(feature = "cli")]

use faying::app::{Registry, RunResult, Status};
use faying::io::Case;
use faying::io::case::ReadOptions;
use faying::io::errors::Diagnostics;

#[allow(dead_code)]
fn read(text: &str) -> Result<Case, Diagnostics> {
    Case::parse("case.toml", text, &ReadOptions::default())
}

#[allow(dead_code)]
fn run(text: &str) -> RunResult {
    let case = read(text).unwrap_or_else(|e| panic!("{e}"));
    case.run(&Registry::default()).unwrap_or_else(|e| panic!("{e}"))
}

fn show(result: &RunResult) -> String {
    let mut out = format!("status {:?}\n", result.status);
    for c in &result.checks {
        out += &format!("{} {}: {:e} {} {:e} -> {} {:?}\n", c.name, c.quantity, c.value, c.relation, c.expected, c.ok, c.reason);
    }
    out + &format!("{:?}\n", result.diagnostics)
}

#[test]
fn sample_cases_pass_their_checks_as_written_and_with_each_backend() {
    for name in ["poisson-arc", "contact-patch", "hertz", "iga-fe-arc"] {
        for backend in [None, Some("iga"), Some("fe")] {
            let options = ReadOptions { backend: backend.map(str::to_owned), ..ReadOptions::default() };
            let path = format!("{}/examples/cases/{name}.toml", env!("CARGO_MANIFEST_DIR"));
            let case = Case::read_with(path, &options).unwrap_or_else(|e| panic!("{name}: {e}"));
            let result = case.run(&Registry::default()).unwrap_or_else(|e| panic!("{name}: {e}"));


            assert_eq!(result.status, Status::Ok, "{name} {backend:?}: {}", show(&result));
        }
    }
}
