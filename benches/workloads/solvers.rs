//! W7: the direct solver alone on the matrices of the other workloads, and their export for other solvers.

use crate::bodies;
use crate::measure::{Time, median, peak_rss_mb, timed};
use crate::meshes::cells;
use crate::run::Options;
use crate::saddle;
use faying::assembly::{Prescribed, Reduced, dirichlet, gauss_rules, load, stiffness};
use faying::basis::Cell;
use faying::linalg::{Csr, Ldlt, LinearSolver, Vector, ordering};
use faying::physics::{Conductor, Hooke, Material, form};
use faying::space::{Body, Field, Mapping, Mesh};
use std::io::Write;
use std::path::Path;
use std::process::Command;

/// The matrices: (name, p, n).
pub const LIST: [(&str, usize, usize); 9] = [
    ("W7-W1", 3, 256),
    ("W7-W3-2d", 3, 128),
    ("W7-W3-3d", 2, 24),
    ("W7-W4a", 2, 256),
    ("W7-W4b", 2, 256),
    ("W7-W4c", 2, 16),
    ("W7-W4d", 2, 24),
    ("W7-W4e", 2, 256),
    ("W7-W4f", 2, 24),
];

/// Names of all workloads here.
pub fn names() -> impl Iterator<Item = &'static str> {
    LIST.iter().chain(&saddle::LIST).map(|w| w.0)
}

/// Runs the list, each matrix in a process of its own, and prints a row for each.
pub fn list(options: &Options) {
    println!(
        "{:<14} {:>7} {:>9} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>8} {:>9}",
        "name", "dofs", "nnz", "total", "analyse", "factor", "checks", "solve", "again", "MB", "residual"
    );
    for name in names() {
        let mut command = Command::new(std::env::current_exe().unwrap());
        command.args([name, "--threads", &options.threads.to_string(), "--reps", &options.reps.to_string()]);
        let output = command.output().unwrap();
        let Ok(value) = serde_json::from_slice::<serde_json::Value>(&output.stdout) else {
            println!("{name:<14} failed: {}", String::from_utf8_lossy(&output.stderr));
            continue;
        };
        let seconds = |key: &str| value[key].as_f64().map_or("-".to_owned(), |v| format!("{v:.3}"));
        println!(
            "{name:<14} {:>7} {:>9} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>8.0} {:>9.1e}",
            value["dofs"],
            value["nnz"],
            seconds("total_cpu_s"),
            seconds("analyse_s"),
            seconds("factor_s"),
            seconds("checks_s"),
            seconds("solve_s"),
            seconds("refactor_s"),
            value["peak_rss_mb"].as_f64().unwrap_or(0.0),
            value["residual"].as_f64().unwrap_or(f64::NAN)
        );
    }
}

/// Unknowns without the prescribed ones.
#[derive(Debug)]
pub struct System {
    pub matrix: Csr,
    pub load: Vec<f64>,
}

/// One line of JSON; `None` for names that are not in the list.
pub fn record(name: &str, options: &Options) -> Option<serde_json::Value> {
    let Some(&(_, p, n)) = LIST.iter().find(|w| w.0 == name) else { return saddle::record(name, options) };
    let (p, n) = (options.p.unwrap_or(p), options.n.unwrap_or(n));
    let system = system(name, p, n)?;
    if let Some(folder) = &options.export {
        export(&system, folder).expect("the folder can be written to");
    }
    Some(measured(name, [p, n], &system, options))
}

fn system(name: &str, p: usize, n: usize) -> Option<System> {
    let flat = |cell| Mesh::<1, 2>::from_cells(&cells(cell, n), p, Mapping::Exact).unwrap();
    let solid = |cell| Mesh::<2, 3>::from_cells(&cells(cell, n), p, Mapping::Exact).unwrap();
    let (conductor, heat) = (Conductor::<2>::try_new(1.0).unwrap(), Conductor::<3>::try_new(1.0).unwrap());
    let (plane, hooke) = (Hooke::<2>::plane_strain(1.0, 0.3).unwrap(), Hooke::<3>::solid(1.0, 0.3).unwrap());
    Some(match name.strip_prefix("W7-")? {
        "W1" => held(&bodies::annulus(p, n), &conductor),
        "W3-2d" => held(&bodies::annulus(p, n), &plane),
        "W3-3d" => held(&bodies::cylinder(p, n), &hooke),
        "W4a" => held(&flat(Cell::Simplex), &conductor),
        "W4b" => held(&flat(Cell::Tensor), &conductor),
        "W4c" => held(&solid(Cell::Simplex), &heat),
        "W4d" => held(&solid(Cell::Tensor), &heat),
        "W4e" => held(&flat(Cell::Simplex), &plane),
        "W4f" => held(&solid(Cell::Tensor), &hooke),
        _ => return None,
    })
}

/// The body with zero values on all sides under a load of one along the first component.
fn held<const C: usize, const S: usize, const N: usize>(body: &dyn Body<S, N>, material: &dyn Material<C, N>) -> System {
    let space = &**body.space();
    let k = stiffness(space, &gauss_rules(space, 0), &form(material).unwrap());
    let f = load::<C, N, N, _, _, _>(space, &gauss_rules(space, 0), &|_: &Vector<N>| Vector::<C>::from_fn(|c, _| f64::from(c == 0)));
    let traces: Vec<_> = body.sides().iter().map(|s| body.trace(s).unwrap()).collect();
    let sides: Vec<Prescribed<'_, S, N>> =
        traces.iter().flat_map(|trace| (0..C).map(move |component| Prescribed { trace, component, value: None })).collect();
    let prescribed = dirichlet(&sides, Field { first: 0, components: C }, 0, &mut Ldlt::new()).unwrap();
    let reduced = Reduced::try_new(&[&k], &f, &prescribed, &[]).unwrap();
    System { matrix: reduced.stiffness, load: reduced.load }
}

/// What a run of the solver takes.
#[derive(Clone, Copy, Debug)]
struct Phases {
    order: Time,
    analyse: Time,
    prepare: Time,
    check: Time,
    solve: Time,
    refactor: Time,
}

fn measured(name: &str, [p, n]: [usize; 2], system: &System, options: &Options) -> serde_json::Value {
    let System { matrix, load } = system;
    // what a next step of load or of an iteration brings: the same pattern with other numbers
    let mut next = matrix.clone();
    next.vals_mut().iter_mut().for_each(|v| *v *= 1.5);
    let (ptr, cols) = upper(matrix);
    let mut x = vec![0.0; load.len()];
    let (mut runs, mut entries, mut refinements, mut condition) = (Vec::new(), 0, 0, 0.0);
    for _ in 0..options.reps {
        let order = timed(|| {
            let order = ordering::nested_dissection(&ptr, &cols, faying::linalg::Operator::dof_coordinates(matrix));
            order.map(|order| ordering::postordered(&ptr, &cols, &order))
        });
        drop(order.0);
        let analyse = timed(|| Ldlt::new().analyse(matrix).unwrap()).1;
        let mut solver = Ldlt::new();
        let prepare = timed(|| solver.prepare(matrix).unwrap()).1;
        let check = timed(|| solver.check(matrix).unwrap()).1;
        let (done, solve) = timed(|| solver.solve(matrix, load, &mut x).unwrap());
        let refactor = timed(|| solver.prepare(&next).unwrap()).1;
        (entries, refinements, condition) = (solver.factor_entries(), done, solver.condition(&next).unwrap());
        runs.push(Phases { order: order.1, analyse, prepare, check, solve, refactor });
    }
    let cpu = |pick: fn(&Phases) -> Time| median(&runs.iter().map(pick).collect::<Vec<_>>()).cpu;
    let total = cpu(|r| Time { wall: 0.0, cpu: r.prepare.cpu + r.solve.cpu });
    serde_json::json!({
        "peer": "faying", "version": env!("CARGO_PKG_VERSION"), "workload": name, "p": p, "n": n,
        "dofs": load.len(), "nnz": matrix.num_entries(), "threads": options.threads, "reps": options.reps,
        "total_cpu_s": total, "order_s": cpu(|r| r.order), "analyse_s": cpu(|r| r.analyse), "factor_s": cpu(|r| Time { wall: 0.0, cpu: r.prepare.cpu - r.analyse.cpu - r.check.cpu }),
        "checks_s": cpu(|r| r.check), "solve_s": cpu(|r| r.solve), "refactor_s": cpu(|r| r.refactor),
        "refinements": refinements, "residual": residual(matrix, load, &x), "condition": condition, "factor_entries": entries,
        "fill": entries as f64 / cols.len() as f64, "peak_rss_mb": peak_rss_mb(), "notes": "seconds of CPU; refactor with checks; analyse with order and the check of symmetry",
    })
}

/// |b - A x| / (|A| |x| + |b|), largest entries and row sums.
fn residual(a: &Csr, b: &[f64], x: &[f64]) -> f64 {
    let largest = |x: &[f64]| x.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    let row = |i: usize| a.row(i).0.zip(a.row(i).1);
    let top = (0..b.len()).map(|i| (b[i] - row(i).map(|(j, v)| v * x[j]).sum::<f64>()).abs()).fold(0.0, f64::max);
    let norm = (0..b.len()).map(|i| row(i).map(|(_, v)| v.abs()).sum::<f64>()).fold(0.0, f64::max);
    top / (norm * largest(x) + largest(b))
}

/// The pattern of the upper triangle.
fn upper(a: &Csr) -> (Vec<usize>, Vec<usize>) {
    let (mut ptr, mut cols) = (vec![0], Vec::with_capacity(a.num_entries() / 2 + a.num_rows()));
    for i in 0..a.num_rows() {
        cols.extend(a.row(i).0.filter(|&j| j >= i));
        ptr.push(cols.len());
    }
    (ptr, cols)
}

/// The upper triangle by rows and the load as little-endian files: `ptr.i64`, `cols.i32`, `vals.f64`, `rhs.f64`; places as `places.f64`.
pub fn export(system: &System, folder: &Path) -> std::io::Result<()> {
    std::fs::create_dir_all(folder)?;
    let file = |name: &str| Ok::<_, std::io::Error>(std::io::BufWriter::new(std::fs::File::create(folder.join(name))?));
    let (mut ptr, mut cols, mut vals, mut end) = (file("ptr.i64")?, file("cols.i32")?, file("vals.f64")?, 0i64);
    ptr.write_all(&end.to_le_bytes())?;
    for i in 0..system.load.len() {
        let (row, row_vals) = system.matrix.row(i);
        for (j, v) in row.zip(row_vals).filter(|(j, _)| *j >= i) {
            cols.write_all(&(j as u32).to_le_bytes())?;
            vals.write_all(&v.to_le_bytes())?;
            end += 1;
        }
        ptr.write_all(&end.to_le_bytes())?;
    }
    for (name, numbers) in
        [("rhs.f64", &system.load[..]), ("places.f64", faying::linalg::Operator::dof_coordinates(&system.matrix).as_flattened())]
    {
        let mut out = file(name)?;
        numbers.iter().try_for_each(|v| out.write_all(&v.to_le_bytes()))?;
        out.flush()?;
    }
    ptr.flush()?;
    cols.flush()?;
    vals.flush()
}
