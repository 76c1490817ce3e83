//! Several workloads, each in a process of its own: the table of all, and the slope of times against unknowns.

use crate::run::Options;
use serde_json::{Value, json};
use std::process::Command;

/// The line of one workload, run by this program again; else what it complained of.
fn apart(name: &str, [p, n]: [usize; 2], options: &Options) -> Result<Value, String> {
    let mut command = Command::new(std::env::current_exe().unwrap());
    command.args([name, "--p", &p.to_string(), "--n", &n.to_string(), "--threads", &options.threads.to_string()]);
    command.args(["--reps", &options.reps.to_string()]);
    if !options.solve {
        command.arg("--nosolve");
    }
    let output = command.output().unwrap();
    serde_json::from_slice(&output.stdout).map_err(|_| String::from_utf8_lossy(&output.stderr).into_owned())
}

/// Runs the list and prints a row for each.
pub fn list(all: &[(&str, usize, usize)], options: &Options) {
    println!(
        "{:<11} {:>2} {:>4} {:>9} {:>10} {:>9} {:>9} {:>9} {:>8} {:>9}",
        "name", "p", "n", "dofs", "nnz", "first", "again", "solve", "MB", "error"
    );
    for &(name, p, n) in all {
        let value = match apart(name, [p, n], options) {
            Ok(value) => value,
            Err(complaint) => {
                println!("{name:<11} {p:>2} {n:>4} failed: {complaint}");
                continue;
            }
        };
        let text = |key: &str| value[key].as_f64().map_or("-".to_owned(), |v| format!("{v:.4}"));
        let error = value["error"].as_f64().map_or("-".to_owned(), |v| format!("{v:.2e}"));
        println!(
            "{name:<11} {p:>2} {n:>4} {:>9} {:>10} {:>9} {:>9} {:>9} {:>8.0} {error:>9}",
            value["dofs"],
            value["nnz"],
            text("assemble_cpu_s"),
            text("assemble_again_cpu_s"),
            text("solve_cpu_s"),
            value["peak_rss_mb"].as_f64().unwrap_or(0.0)
        );
    }
}

/// Assembly at several n: a line for each, and one with the slopes d log(time) / d log(unknowns) by least squares.
pub fn slope(name: &str, p: usize, sizes: &[usize], options: &Options) -> Vec<String> {
    let options = Options { solve: false, ..options.clone() };
    let keys = ["assemble_cpu_s", "assemble_again_cpu_s"];
    let runs: Vec<Value> = sizes.iter().map(|&n| apart(name, [p, n], &options).unwrap()).collect();
    let logs = |key: &str| -> Vec<f64> { runs.iter().map(|r| r[key].as_f64().unwrap().ln()).collect() };
    let unknowns = logs("dofs");
    let mut lines: Vec<String> = runs
        .iter()
        .map(|r| {
            let [first, again] = keys.map(|key| r[key].as_f64().unwrap());
            let entries = r["nnz"].as_f64().unwrap();
            let per = json!({"first": 1e9 * first / entries, "again": 1e9 * again / entries});
            json!({"workload": name, "n": r["n"], "dofs": r["dofs"], keys[0]: first, keys[1]: again, "ns_per_entry": per}).to_string()
        })
        .collect();
    let [first, again] = keys.map(|key| fitted(&unknowns, &logs(key)));
    lines.push(json!({"workload": format!("slope-{name}"), "p": p, "slope_first": first, "slope_again": again}).to_string());
    lines
}

/// The slope of the straight line through (x, y) by least squares.
fn fitted(x: &[f64], y: &[f64]) -> f64 {
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let (mx, my) = (mean(x), mean(y));
    let (xy, xx) = x.iter().zip(y).fold((0.0, 0.0), |(xy, xx), (x, y)| (xy + (x - mx) * (y - my), xx + (x - mx) * (x - mx)));
    xy / xx
}
