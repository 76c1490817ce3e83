//! The workloads that speed is measured on: `cargo bench --bench workloads -- NAME [--p P] [--n N] [--threads T] [--reps R] [--nosolve] [--beside] [--export FOLDER]`.
//!
//! With a name it prints one line of JSON; without one it runs the list, each workload in a process of its own, and
//! prints a table. Threads are 1 unless told otherwise.
#![allow(clippy::unwrap_used)]

mod beside;
mod bodies;
mod contact;
mod floor;
mod interface;
mod measure;
mod meshes;
mod run;
mod saddle;
mod solvers;
mod surfaces;
mod table;

use contact::Backend;
use run::{Options, Record};

/// Workloads of the specification that this version does not have.
const LATER: [&str; 1] = ["W8"];

/// What runs without a name: (workload, p, n).
const LIST: [(&str, usize, usize); 29] = [
    ("W1", 2, 256),
    ("W1", 3, 256),
    ("W1", 4, 256),
    ("W1", 5, 256),
    ("W2", 2, 32),
    ("W2", 3, 32),
    ("W2", 4, 32),
    ("W2", 2, 48),
    ("W2", 3, 48),
    ("W2", 4, 48),
    ("W3-2d", 3, 128),
    ("W3-3d", 2, 24),
    ("W4a", 2, 256),
    ("W4b", 2, 256),
    ("W4c", 2, 30),
    ("W4d", 2, 24),
    ("W4e", 2, 256),
    ("W4f", 2, 24),
    ("W5-2d", 2, 1000),
    ("W5-3d-p1", 1, 64),
    ("W5-3d-q2", 2, 64),
    ("W6-spline", 2, 32),
    ("W6-spline", 2, 96),
    ("W6-lagrange", 2, 32),
    ("W6-lagrange", 2, 96),
    ("W6-3d-spline", 2, 8),
    ("W6-3d-spline", 2, 16),
    ("W6-3d-lagrange", 2, 8),
    ("W6-3d-lagrange", 2, 16),
];

/// The lines of a workload; none where there is no such name.
fn lines(name: &str, options: &Options) -> Option<Vec<String>> {
    if LATER.contains(&name) {
        return Some(vec![serde_json::json!({"peer": "faying", "workload": name, "notes": "not in this version"}).to_string()]);
    }
    let p = options.p.unwrap_or(2);
    let contact = |name, backend| contact::two_bodies(name, backend, p, options.n.unwrap_or(32), options).to_string();
    let solids = |name, backend| contact::two_solids(name, backend, p, options.n.unwrap_or(8), options).to_string();
    match name {
        "W5-2d" => Some(vec![interface::straight(name, p, options.n.unwrap_or(1000), options).to_string()]),
        "W5-3d-p1" | "W5-3d-q2" => Some(vec![surfaces::pair(name, options.n.unwrap_or(64), options).to_string()]),
        "W6-spline" => Some(vec![contact(name, Backend::Spline)]),
        "W6-lagrange" => Some(vec![contact(name, Backend::Lagrange)]),
        "W6-3d-spline" => Some(vec![solids(name, Backend::Spline)]),
        "W6-3d-lagrange" => Some(vec![solids(name, Backend::Lagrange)]),
        "floor" => Some(vec![floor::record(options).to_string()]),
        "slope-W2" => Some(table::slope("W2", p, &[20, 30, 46, 68, 98], options)),
        "slope-W4d" => Some(table::slope("W4d", p, &[10, 16, 24, 34, 50], options)),
        "W6" => Some(vec![contact("W6-spline", Backend::Spline), contact("W6-lagrange", Backend::Lagrange)]),
        _ if name.starts_with("W7-") => solvers::record(name, options).map(|record| vec![record.to_string()]),
        _ => record(name, options).map(|record| vec![record.json(options)]),
    }
}

/// The record of one workload of assembly and solution; none where there is no such name.
fn record(name: &str, options: &Options) -> Option<Record> {
    let p = |default| options.p.unwrap_or(default);
    let n = |default| options.n.unwrap_or(default);
    match name {
        "W1" => Some(run::annulus(name, p(3), n(256), options)),
        "W2" => Some(run::cylinder(name, p(3), n(32), options)),
        "W3-2d" => Some(run::annulus_elastic(name, p(3), n(128), options)),
        "W3-3d" => Some(run::cylinder_elastic(name, p(2), n(24), options)),
        _ => meshes::record(name, p(2), n(meshes::default_n(name)), options),
    }
}

fn main() {
    let mut words = std::env::args().skip(1);
    let (mut name, mut options) = (None, Options { p: None, n: None, threads: 1, reps: 3, solve: true, export: None, beside: false });
    while let Some(word) = words.next() {
        if word == "--export" {
            options.export = Some(words.next().expect("--export wants a folder").into());
            continue;
        }
        let mut number = || words.next().and_then(|w| w.parse::<usize>().ok()).unwrap_or_else(|| panic!("{word} wants a number"));
        match word.as_str() {
            "--p" => options.p = Some(number()),
            "--n" => options.n = Some(number()),
            "--threads" => options.threads = number(),
            "--reps" => options.reps = number().max(1),
            "--nosolve" => options.solve = false,
            "--beside" => options.beside = true,
            "--bench" => {} // cargo adds it
            other => name = Some(other.to_owned()),
        }
    }
    match name {
        Some(name) => {
            rayon::ThreadPoolBuilder::new().num_threads(options.threads).build_global().unwrap();
            match lines(&name, &options) {
                Some(lines) => lines.iter().for_each(|line| println!("{line}")),
                None => {
                    let further = ["W6", "floor", "slope-W2", "slope-W4d"];
                    let listed = LIST.iter().chain(&solvers::LIST).map(|l| l.0);
                    let mut known: Vec<&str> = listed.chain(further).chain(LATER).collect();
                    known.sort_unstable();
                    known.dedup();
                    eprintln!("no workload \"{name}\"; known: {}", known.join(", "));
                    std::process::exit(2);
                }
            }
        }
        None => {
            table::list(&LIST, &options);
            solvers::list(&options);
        }
    }
}
