//! Ties of bodies in space from case files: linear fields, curved interfaces, results and files, and what is refused.

mod curved;
mod facets;
mod inf_sup;
mod linear;
mod refused;
mod results;

use faying_cli::case::ReadOptions;
use faying_cli::{Case, Registry, RunResult, Status};

/// Lines of a patch that choose its kind of body.
const KINDS: [&str; 4] =
    ["backend = \"iga\"\nbasis = \"b-spline\"\n", "backend = \"iga\"\n", "backend = \"fe\"\n", "backend = \"fe\"\ncells = \"simplex\"\n"];

/// Reads a case with `--set` words.
fn read(text: &str, sets: &[&str]) -> Case {
    let options = ReadOptions { sets: sets.iter().map(|s| (*s).to_owned()).collect(), ..ReadOptions::default() };
    Case::parse("case.toml", text, &options).unwrap_or_else(|e| panic!("{e}\n{sets:?}\n{text}"))
}

/// Runs a case with `--set` words; every check passes.
fn run(text: &str, sets: &[&str]) -> RunResult {
    let result = read(text, sets).run(&Registry::default()).unwrap_or_else(|e| panic!("{e}\n{sets:?}\n{text}"));
    assert_eq!(result.status, Status::Ok, "{:?} {:?}\n{sets:?}\n{text}", result.diagnostics, result.checks);
    result
}

/// An error norm of a result.
fn error(result: &RunResult, name: &str) -> f64 {
    *result.errors.get(name).unwrap_or_else(|| panic!("no {name} in {:?}", result.errors))
}

/// Two boxes that touch in z = 0, both turned about one axis by 40 degrees, under a displacement or temperature that is prescribed on all
/// other sides; `choices` are the lines of the interface.
fn stacked(scalar: bool, kinds: [&str; 2], degree: usize, choices: &str) -> String {
    let (physics, exact, material) = if scalar {
        ("poisson", "\"0.3*x - 0.2*y + 0.5*z + 1\"", "conductivity = 2.0")
    } else {
        ("elasticity", "[\"0.3*x - 0.2*y + 0.5*z\", \"0.1*x - 0.4*y + 0.2*z\", \"-0.6*x + 0.3*y + 0.7*z\"]", "young = 1.0\npoisson = 0.3")
    };
    let patch = |name: &str, kind: &str, min: &str, max: &str, n: &str| {
        format!(
            "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"box\", min = {min}, max = {max}, rotate_deg = 40, axis = [1, 2, 0.5] }}\n\
             elements = {n}\ndegree = {degree}\n{kind}"
        )
    };
    format!(
        "[model]\nphysics = \"{physics}\"\ndimension = 3\nexact = {{ u = {exact} }}\n[[material]]\nname = \"m\"\n{material}\n{}{}\
         [[boundary]]\non = \"all-outer\"\ndirichlet = \"exact\"\n\
         [[interface]]\nname = \"seam\"\nslave = \"upper.bottom\"\nmaster = \"lower.top\"\n{choices}\n",
        patch("lower", kinds[0], "[0, 0, -0.5]", "[1, 0.8, 0]", "[3, 2, 1]"),
        patch("upper", kinds[1], "[0, 0, 0]", "[1, 0.8, 0.6]", "[2, 3, 1]"),
    )
}
