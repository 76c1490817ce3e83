//! One workload: times of assembly and solution, fingerprints, error.

use crate::beside::{Beside, beside};
use crate::bodies::{self, Jet};
use crate::measure::{Time, median, peak_rss_mb, timed};
use faying::assembly::{Assembler, Form, Prescribed, Reduced, dirichlet, errors, gauss_rules, load, stiffness};
use faying::linalg::{Csr, Ldlt, LinearSolver, Operator, Vector};
use faying::physics::{Conductor, Hooke, Material, form};
use faying::space::{Body, Field, Space};

/// What the command line asks for.
#[derive(Clone, Debug)]
pub struct Options {
    pub p: Option<usize>,
    pub n: Option<usize>,
    pub threads: usize,
    pub reps: usize,
    pub solve: bool,
    /// Where W7 writes its matrices.
    pub export: Option<std::path::PathBuf>,
    /// Loads, norms, and products with and without the matrix too.
    pub beside: bool,
}

/// What is printed.
#[derive(Debug)]
pub struct Record {
    name: String,
    p: usize,
    n: usize,
    dofs: usize,
    nnz: usize,
    first: Time,
    again: Time,
    solve: Option<Time>,
    error: Option<f64>,
    trace: f64,
    fro: f64,
    beside: Option<Beside>,
    notes: String,
}

impl Record {
    /// One line.
    pub fn json(&self, options: &Options) -> String {
        let cpu = |pick: fn(&Beside) -> Time| self.beside.as_ref().map(|b| pick(b).cpu);
        serde_json::json!({
            "peer": "faying", "version": env!("CARGO_PKG_VERSION"), "workload": self.name, "p": self.p, "n": self.n,
            "dofs": self.dofs, "nnz": self.nnz, "threads": options.threads, "reps": options.reps,
            "assemble_s": self.first.wall, "assemble_cpu_s": self.first.cpu,
            "assemble_again_s": self.again.wall, "assemble_again_cpu_s": self.again.cpu,
            "solve_s": self.solve.map(|t| t.wall), "solve_cpu_s": self.solve.map(|t| t.cpu),
            "peak_rss_mb": peak_rss_mb(), "error": self.error, "fp_trace": self.trace, "fp_fro": self.fro, "notes": self.notes,
            "product_cpu_s": cpu(|b| b.product), "apply_cpu_s": cpu(|b| b.apply),
            "load_cpu_s": cpu(|b| b.load), "errors_cpu_s": cpu(|b| b.errors),
            "force_cpu_s": cpu(|b| b.force), "field_cpu_s": cpu(|b| b.field),
            "stress_cpu_s": cpu(|b| b.stress), "traction_cpu_s": cpu(|b| b.traction), "springs_cpu_s": cpu(|b| b.springs),
        })
        .to_string()
    }

    /// Solution and error are those of a smaller one.
    pub fn solved_as(&mut self, smaller: &Self) {
        (self.solve, self.error) = (smaller.solve, smaller.error);
        self.notes = format!("solve and error at n = {}", smaller.n);
    }
}

/// The line of a workload that measures something of its own: what all lines have, then `fields`.
pub fn own_record(name: &str, [p, n]: [usize; 2], options: &Options, fields: serde_json::Value) -> serde_json::Value {
    let mut line = serde_json::json!({
        "peer": "faying", "version": env!("CARGO_PKG_VERSION"), "workload": name, "p": p, "n": n,
        "threads": options.threads, "reps": options.reps, "peak_rss_mb": peak_rss_mb(), "notes": "",
    });
    if let (Some(line), serde_json::Value::Object(fields)) = (line.as_object_mut(), fields) {
        line.extend(fields);
    }
    line
}

/// Assembly, timed: the matrix, the time from nothing, the time with pattern and memory known.
fn assemble<const C: usize, const N: usize>(space: &dyn Space<N, N>, form: &Form<'_, C, N>, reps: usize) -> (Csr, Time, Time) {
    let first: Vec<Time> = (0..=reps).map(|_| timed(|| stiffness(space, &gauss_rules(space, 0), form)).1).collect();
    let mut matrix = stiffness(space, &gauss_rules(space, 0), form);
    let rules = gauss_rules(space, 0);
    let kept = Assembler::new(space, &rules);
    let again: Vec<Time> = (0..=reps).map(|_| timed(|| kept.refill_stiffness(space, &rules, form, &mut matrix)).1).collect();
    // the first of each warms up
    (matrix, median(&first[1..]), median(&again[1..]))
}

/// Solves with zero values on all sides for a field that vanishes there: time of the solver, relative L2 error.
fn solve<const C: usize, const S: usize, const N: usize>(
    body: &dyn Body<S, N>,
    material: &dyn Material<C, N>,
    k: &Csr,
    exact: fn(&Vector<N>) -> Jet<C, N>,
    reps: usize,
) -> (Time, f64) {
    let space = &**body.space();
    let f = load::<C, N, N, _, _, _>(space, &gauss_rules(space, 0), &|x: &Vector<N>| {
        let (_, gradient, hessian) = exact(x);
        -material.divergence(x, &gradient, &hessian)
    });
    let traces: Vec<_> = body.sides().iter().map(|s| body.trace(s).unwrap()).collect();
    let held: Vec<Prescribed<'_, S, N>> =
        traces.iter().flat_map(|trace| (0..C).map(move |component| Prescribed { trace, component, value: None })).collect();
    let prescribed = dirichlet(&held, Field { first: 0, components: C }, 0, &mut Ldlt::new()).unwrap();
    let reduced = Reduced::try_new(&[k], &f, &prescribed, &[]).unwrap();
    let mut v = vec![0.0; reduced.num_free()];
    let times: Vec<Time> = (0..=reps)
        .map(|_| {
            let solving = || {
                let mut solver = Ldlt::new();
                solver.prepare(&reduced.stiffness).unwrap();
                solver.solve(&reduced.stiffness, &reduced.load, &mut v).unwrap();
            };
            timed(solving).1
        })
        .collect();
    let u = reduced.expand(&v);
    let norms = errors(space, &gauss_rules(space, 1), &form(material).unwrap(), &u, &|x: &Vector<N>| {
        let (value, gradient, _) = exact(x);
        (value, gradient)
    });
    (median(&times[1..]), norms.error.l2 / norms.exact.l2)
}

/// Trace and Frobenius norm.
fn fingerprints(k: &Csr) -> (f64, f64) {
    (k.diagonal().iter().sum(), k.vals().iter().map(|v| v * v).sum::<f64>().sqrt())
}

/// The record of one body and its matrix.
pub fn whole<const C: usize, const S: usize, const N: usize>(
    name: &str,
    [p, n]: [usize; 2],
    body: &dyn Body<S, N>,
    material: &dyn Material<C, N>,
    exact: fn(&Vector<N>) -> Jet<C, N>,
    solved: bool,
    options: &Options,
) -> (Record, Csr) {
    let (k, first, again) = assemble(&**body.space(), &form(material).unwrap(), options.reps);
    let (trace, fro) = fingerprints(&k);
    let solved = (solved && options.solve).then(|| solve(body, material, &k, exact, options.reps));
    let beside = options.beside.then(|| beside(body, material, &k, exact, options.reps));
    let record = Record {
        name: name.into(),
        p,
        n,
        dofs: k.num_rows(),
        nnz: k.num_entries(),
        first,
        again,
        solve: solved.map(|s| s.0),
        error: solved.map(|s| s.1),
        trace,
        fro,
        beside,
        notes: String::new(),
    };
    (record, k)
}

/// W1: Poisson on the quarter annulus; solved at p = 3.
pub fn annulus(name: &str, p: usize, n: usize, options: &Options) -> Record {
    let material = Conductor::<2>::try_new(1.0).unwrap();
    whole(name, [p, n], &bodies::annulus(p, n), &material, bodies::plane_field, p == 3, options).0
}

/// W2: Poisson on the quarter cylinder; the error is that of the energy of u = z over the volume 3 pi / 4.
pub fn cylinder(name: &str, p: usize, n: usize, options: &Options) -> Record {
    let body = bodies::cylinder(p, n);
    let (mut record, k) = whole(name, [p, n], &body, &Conductor::<3>::try_new(1.0).unwrap(), bodies::solid_field, false, options);
    // z is the Greville parameter of the third axis, for the map is linear along it
    let [a, b, c] = body.axes();
    let plane = faying::basis::Basis::<1>::num_functions(a) * faying::basis::Basis::<1>::num_functions(b);
    let u: Vec<f64> = c.greville().into_iter().flat_map(|z| std::iter::repeat_n(z, plane)).collect();
    let mut ku = vec![0.0; u.len()];
    k.apply(&u, &mut ku);
    let energy: f64 = u.iter().zip(&ku).map(|(u, k)| u * k).sum();
    record.error = Some((energy / (0.75 * std::f64::consts::PI) - 1.0).abs());
    record
}

/// W3-2d: plane strain on the quarter annulus.
pub fn annulus_elastic(name: &str, p: usize, n: usize, options: &Options) -> Record {
    let material = Hooke::<2>::plane_strain(1.0, 0.3).unwrap();
    whole(name, [p, n], &bodies::annulus(p, n), &material, bodies::plane_field, true, options).0
}

/// W3-3d: elasticity on the quarter cylinder.
pub fn cylinder_elastic(name: &str, p: usize, n: usize, options: &Options) -> Record {
    let material = Hooke::<3>::solid(1.0, 0.3).unwrap();
    whole(name, [p, n], &bodies::cylinder(p, n), &material, bodies::solid_field, true, options).0
}
