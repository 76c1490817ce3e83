//! Iterative solvers, linear and constrained: contracts, one problem with one answer, how many iterations, how they fail.

use crate::common::blocks;
use blocks::{Blocks, contact_blocks, difference, differences, largest};
use faying::check;
use faying::constraint::{
    ActiveSet, Augmented, Condensed, ConstrainedSolution, ConstrainedSystem, ConstraintSolver, Direct, Krylov, PenaltyElimination, RowKind,
    Schur, SolveError, penalty,
};
use faying::coupling::Rows;
use faying::linalg::{Cancellation, Cg, Csr, Gmres, Limits, LinearError, LinearSolver, Minres, Operator, Triplets};

type Make = fn(Limits) -> Box<dyn ConstraintSolver>;

/// Every solver that iterates, by the words of a case file.
const ITERATIVE: [(&str, Make); 5] = [
    ("saddle-point, iterative", |limits| Box::new(Krylov::new(limits))),
    ("condensed, iterative", |limits| Box::new(Condensed::iterative(limits))),
    ("schur", |limits| Box::new(Schur::new(limits))),
    ("uzawa", |limits| Box::new(Augmented::uzawa(limits))),
    ("uzawa, iterative", |limits| Box::new(Augmented::uzawa_iterative(limits))),
];

// ---------------------------------------------------------------------------------------------- contracts

#[test]
fn krylov_methods_keep_the_contract_of_linear_solvers() {
    check::linear_solver(|| Box::new(Cg::new(1e-13).with_gauss_seidel())).unwrap();
    check::linear_solver(|| Box::new(Minres::new(1e-13))).unwrap();
    // a chain of 300 springs has 300 eigenvalues: a restart before that stands still
    check::linear_solver(|| Box::new(Gmres::new(1e-13).with_restart(320))).unwrap();
}

#[test]
fn iterative_constraint_solvers_keep_their_contract() {
    for (name, make) in ITERATIVE {
        check::solver(|| make(Limits::default())).unwrap_or_else(|e| panic!("{name}: {e}"));
        check::solver(|| Box::new(ActiveSet::new(make(Limits::default())))).unwrap_or_else(|e| panic!("{name} in an active set: {e}"));
    }
    // solvers wrap solvers: anything that knows soft rows serves
    check::solver(|| Box::new(Augmented::new(Direct::new()))).unwrap();
    check::solver(|| Box::new(Augmented::new(Condensed::new()))).unwrap();
}

// ---------------------------------------------------------------------------------------------- linear solvers

/// A square matrix of n unknowns without symmetry, with a dominant diagonal in part of its rows, and its dense numbers.
fn skew(n: usize) -> Csr {
    let mut a = Triplets::new(n, n);
    for i in 0..n {
        a.push(i, i, 3.0 + (i as f64).sin());
        for k in [1, 5, 11] {
            a.push(i, (i + k) % n, 0.8 * ((i * k) as f64).cos());
            a.push((i + 2 * k) % n, i, -0.5 + 0.1 * k as f64);
        }
    }
    a.to_csr()
}

/// x of A x = b by Gaussian elimination on all entries.
fn dense(a: &Csr, b: &[f64]) -> Vec<f64> {
    let n = b.len();
    let mut m: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| a.get(i, j)).chain([b[i]]).collect()).collect();
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| m[i][k].abs().total_cmp(&m[j][k].abs())).unwrap();
        m.swap(k, pivot);
        for i in k + 1..n {
            let factor = m[i][k] / m[k][k];
            for j in k..=n {
                m[i][j] -= factor * m[k][j];
            }
        }
    }
    for k in (0..n).rev() {
        m[k][n] = (m[k][n] - (k + 1..n).map(|j| m[k][j] * m[j][n]).sum::<f64>()) / m[k][k];
    }
    m.iter().map(|row| row[n]).collect()
}

#[test]
fn gmres_solves_matrices_without_symmetry_with_and_without_restart() {
    let a = skew(60);
    assert!((0..60).any(|i| (a.get(i, (i + 1) % 60) - a.get((i + 1) % 60, i)).abs() > 0.1));
    let b: Vec<f64> = (0..60).map(|i| (0.3 * i as f64).cos()).collect();
    let expected = dense(&a, &b);
    let mut counts = Vec::new();
    for restart in [60, 10, 5] {
        let mut gmres = Gmres::new(1e-13).with_restart(restart);
        gmres.prepare(&a).unwrap();
        let mut x = vec![0.0; 60];
        counts.push(gmres.solve(&a, &b, &mut x).unwrap());
        assert!(difference(&x, &expected) < 1e-11, "restart {restart}: {:e}", difference(&x, &expected));
        // a start at the answer needs nothing
        assert!(gmres.solve(&a, &b, &mut x).unwrap() <= 1);
    }
    assert!(counts[0] <= 60 && counts[0] <= counts[1] && counts[1] <= counts[2], "{counts:?}");
}

#[test]
fn gmres_ends_in_as_many_iterations_as_there_are_eigenvalues() {
    // the minimal polynomial of diag(1, 1, 2, 2, 5, 5) has degree 3; the diagonal as preconditioner leaves one eigenvalue
    #[derive(Debug)]
    struct NoDiagonal(Csr);
    impl Operator for NoDiagonal {
        fn size(&self) -> usize {
            6
        }
        fn apply(&self, x: &[f64], y: &mut [f64]) {
            self.0.apply(x, y);
        }
        fn diagonal(&self) -> Vec<f64> {
            vec![1.0; 6]
        }
    }
    let a = Csr::from_parts(6, (0..=6).collect(), (0..6).collect(), vec![1.0, 1.0, 2.0, 2.0, 5.0, 5.0]);
    let b = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    for (a, wanted) in [(&NoDiagonal(a.clone()) as &dyn Operator, 3), (&a, 1)] {
        let mut gmres = Gmres::new(1e-14);
        gmres.prepare(a).unwrap();
        let mut x = [0.0; 6];
        assert_eq!(gmres.solve(a, &b, &mut x), Ok(wanted));
        assert!(difference(&x, &[1.0, 2.0, 1.5, 2.0, 1.0, 1.2]) < 1e-14);
    }
}

#[test]
fn minres_solves_a_saddle_point_that_conjugate_gradients_cannot() {
    let blocks = Blocks::new((4, 1.0), (3, 1.0), &[0, 1]);
    let saddle = blocks.saddle();
    let mut b = blocks.load.clone();
    b.resize(saddle.num_rows(), 0.0);
    let (mut minres, mut gmres) = (Minres::new(1e-12), Gmres::new(1e-12).with_restart(b.len()));
    let (mut x, mut y) = (vec![0.0; b.len()], vec![0.0; b.len()]);
    minres.prepare(&saddle).unwrap();
    gmres.prepare(&saddle).unwrap();
    minres.solve(&saddle, &b, &mut x).unwrap();
    gmres.solve(&saddle, &b, &mut y).unwrap();
    let expected = dense(&saddle, &b);
    assert!(difference(&x, &expected) < 1e-8, "{:e}", difference(&x, &expected));
    assert!(difference(&y, &expected) < 1e-8, "{:e}", difference(&y, &expected));
    assert!(Cg::new(1e-12).prepare(&saddle).is_err());
}

#[test]
fn krylov_methods_work_in_single_precision() {
    let a = Csr::from_parts(2, vec![0, 2, 4], vec![0, 1, 0, 1], vec![2.0f32, 1.0, 1.0, 3.0]);
    let solvers: [Box<dyn LinearSolver<f32>>; 3] =
        [Box::new(Minres::new(1e-6)), Box::new(Gmres::new(1e-6)), Box::new(Cg::new(1e-6).with_gauss_seidel())];
    for mut solver in solvers {
        solver.prepare(&a).unwrap();
        let mut x = [0.0f32; 2];
        solver.solve(&a, &[3.0, 4.0], &mut x).unwrap();
        assert!((x[0] - 1.0).abs() < 1e-5 && (x[1] - 1.0).abs() < 1e-5, "{solver:?}");
    }
}

#[test]
fn sweeps_halve_the_iterations_of_conjugate_gradients() {
    let blocks = contact_blocks(0.0);
    let k = {
        // springs to the ground make the stiffness of the floating block regular
        let n = blocks.load.len();
        let mut all = Triplets::new(n, n);
        for i in 0..n {
            let (cols, vals) = blocks.stiffness.row(i);
            cols.zip(vals).for_each(|(j, &v)| all.push(i, j, v));
            all.push(i, i, 1e-3);
        }
        all.to_csr()
    };
    let count = |mut solver: Cg| {
        solver.prepare(&k).unwrap();
        let mut x = vec![0.0; k.num_rows()];
        let done = solver.solve(&k, &blocks.load.iter().map(|_| 1.0).collect::<Vec<_>>(), &mut x).unwrap();
        (done, x)
    };
    let ((plain, x), (swept, y)) = (count(Cg::new(1e-12)), count(Cg::new(1e-12).with_gauss_seidel()));
    assert!(2 * swept <= plain + 2, "{swept} against {plain}");
    assert!(difference(&x, &y) < 1e-9);
}

#[test]
fn iterations_that_are_not_allowed_or_stopped_are_errors_with_their_number() {
    let a = skew(60);
    let b = vec![1.0; 60];
    let symmetric = Blocks::new((4, 1.0), (3, 1.0), &[0, 1]).saddle();
    let load = vec![1.0; symmetric.num_rows()];
    let limited = |max_iterations, stop: Cancellation| {
        let (mut gmres, mut minres) = (Gmres::new(1e-12), Minres::new(1e-12));
        (gmres.max_iterations, gmres.stop) = (max_iterations, stop.clone());
        (minres.max_iterations, minres.stop) = (max_iterations, stop);
        gmres.prepare(&a).unwrap();
        minres.prepare(&symmetric).unwrap();
        [gmres.solve(&a, &b, &mut [0.0; 60]).unwrap_err(), minres.solve(&symmetric, &load, &mut vec![0.0; load.len()]).unwrap_err()]
    };
    for error in limited(3, Cancellation::default()) {
        let LinearError::NotConverged { iterations: 3, residual, tolerance } = error else { panic!("{error}") };
        assert!(residual > tolerance && residual < 1.0 && tolerance == 1e-12);
    }
    for error in limited(0, Cancellation::new(|| true)) {
        assert_eq!(error, LinearError::Stopped { iterations: 0 });
    }
}

// ---------------------------------------------------------------------------------------------- one answer

#[test]
fn one_problem_has_one_answer_across_contrasts_and_units() {
    for exponent in [-4, 0, 4] {
        for unit in [1e-9, 1.0, 1e12] {
            let blocks = Blocks::new((12, unit), (8, unit * 10f64.powi(exponent)), &[0, 1]);
            let direct = Direct::new().solve(&blocks.system()).unwrap();
            assert_eq!(direct.iterations, 0);
            for (name, make) in ITERATIVE {
                let other = make(Limits::default()).solve(&blocks.system()).unwrap_or_else(|e| panic!("{name}, 1e{exponent}: {e}"));
                let d = differences(&blocks, &direct, &other);
                println!(
                    "{name}, contrast 1e{exponent}, unit {unit:.0e}: {} iterations, {d:?}, residual {:e}",
                    other.iterations, other.residual
                );
                assert!(d.iter().all(|&x| x < 1e-9), "{name}, contrast 1e{exponent}, unit {unit:.0e}: {d:?}");
                assert!(other.iterations > 0 && other.residual < 1e-11);
            }
        }
    }
}

#[test]
fn iterations_do_not_grow_with_the_mesh_where_rows_are_the_matter() {
    for (name, make) in [ITERATIVE[2], ITERATIVE[3]] {
        let count =
            |n: usize| make(Limits::new(1e-10)).solve(&Blocks::new((3 * n, 1.0), (2 * n, 1.0), &[0, 1]).system()).unwrap().iterations;
        let counts = [count(2), count(4), count(8)];
        println!("{name}: {counts:?}");
        assert!(counts[2] <= counts[0] + 4, "{name}: {counts:?}");
        assert!(counts[2] <= 40, "{name}: {counts:?}");
    }
}

#[test]
fn soft_rows_of_any_softness_have_the_same_answer() {
    let blocks = Blocks::new((6, 70e9), (4, 210e9), &[0, 1]);
    for factor in [1e-3, 1.0, 1e4, 1e12] {
        let compliance = penalty(&blocks.stiffness.diagonal(), &blocks.rows, blocks.offset.len(), factor);
        let system = ConstrainedSystem { compliance: &compliance, ..blocks.system() };
        let direct = Direct::new().solve(&system).unwrap();
        for (name, make) in ITERATIVE {
            let other = make(Limits::default()).solve(&system).unwrap_or_else(|e| panic!("{name}, factor {factor:.0e}: {e}"));
            let d = differences(&blocks, &direct, &other);
            assert!(d.iter().all(|&x| x < 1e-9), "{name}, factor {factor:.0e}: {d:?}");
        }
        if factor <= 1e4 {
            let free = PenaltyElimination::new().solve(&system).unwrap();
            assert!(differences(&blocks, &direct, &free).iter().all(|&x| x < 1e-9), "factor {factor:.0e}");
        }
    }
    assert_eq!(PenaltyElimination::new().solve(&blocks.system()).unwrap_err(), SolveError::ExactRow { row: 0 });
}

#[test]
fn one_iteration_of_the_augmented_lagrangian_is_penalty() {
    let blocks = Blocks::new((6, 1.0), (4, 1.0), &[0, 1]);
    for factor in [10.0, 1e4] {
        let compliance = penalty(&blocks.stiffness.diagonal(), &blocks.rows, blocks.offset.len(), factor);
        let soft = Direct::new().solve(&ConstrainedSystem { compliance: &compliance, ..blocks.system() }).unwrap();
        let once = Augmented { factor, iterations: 1, ..Augmented::new(PenaltyElimination::new()) }.solve(&blocks.system()).unwrap();
        assert!(differences(&blocks, &soft, &once).iter().all(|&x| x < 1e-9), "factor {factor:.0e}");
        assert_eq!(once.iterations, 1);
    }
}

#[test]
fn redundant_rows_that_agree_leave_the_displacement_alone() {
    let mut blocks = Blocks::new((6, 1.0), (4, 1.0), &[0, 1]);
    let once = Direct::new().solve(&blocks.system()).unwrap();
    let m = blocks.offset.len();
    let copy = |t: &Triplets| {
        let mut all = t.clone();
        all.append_below(t, m);
        all
    };
    blocks.rows = Rows { slave: copy(&blocks.rows.slave), master: copy(&blocks.rows.master) };
    blocks.offset = vec![0.0; 2 * m];
    blocks.kind = vec![RowKind::Equal; 2 * m];
    for (name, make) in ITERATIVE {
        let solved = make(Limits::default()).solve(&blocks.system());
        if name.starts_with("condensed") {
            assert_eq!(solved.unwrap_err(), SolveError::OverConstrained { row: m, rows: 2 * m });
            continue;
        }
        let twice = solved.unwrap_or_else(|e| panic!("{name}: {e}"));
        assert!(difference(&twice.unknowns, &once.unknowns) < 1e-9, "{name}");
        for j in 0..m {
            let sum = twice.multipliers[j] + twice.multipliers[m + j];
            assert!((sum - once.multipliers[j]).abs() < 1e-9 * largest(&once.multipliers), "{name}");
        }
    }
}

#[test]
fn a_body_that_slides_freely_is_refused_by_every_solver() {
    let blocks = Blocks::new((6, 210e9), (4, 210e9), &[1]);
    for (name, make) in ITERATIVE {
        let error = make(Limits::default()).solve(&blocks.system()).unwrap_err();
        assert!(matches!(error, SolveError::Linear(LinearError::Singular { .. })), "{name}: {error}");
    }
}

// ---------------------------------------------------------------------------------------------- contact

#[test]
fn a_tilting_block_opens_as_far_with_every_solver() {
    let blocks = contact_blocks(0.006);
    let direct = ActiveSet::new(Direct::new()).solve(&blocks.system()).unwrap();
    for (name, make) in ITERATIVE {
        let other = ActiveSet::new(make(Limits::default())).solve(&blocks.system()).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(direct.active, other.active, "{name}");
        let signs = |s: &ConstrainedSolution| s.active_set.as_ref().unwrap().sign_cases.last().cloned();
        assert_eq!(signs(&direct), signs(&other), "{name}");
        let d = differences(&blocks, &direct, &other);
        assert!(d.iter().all(|&x| x < 1e-9), "{name}: {d:?}");
        // the sum over the systems of the active set
        assert!(other.iterations >= other.active_set.unwrap().iterations, "{name}");
    }
}

#[test]
fn a_lifted_block_is_a_rigid_motion_for_every_solver() {
    let blocks = contact_blocks(1.0);
    for (name, make) in ITERATIVE {
        let error = ActiveSet::new(make(Limits::default())).solve(&blocks.system()).unwrap_err();
        assert!(matches!(error, SolveError::RigidMotion { .. }), "{name}: {error}");
    }
}

#[test]
fn the_schur_complement_factorises_a_stiffness_once_for_all_states_of_contact() {
    // weak springs everywhere: the stiffness is regular whatever opens
    let mut blocks = contact_blocks(0.006);
    let n = blocks.load.len();
    let mut k = Triplets::new(n, n);
    for i in 0..n {
        let (cols, vals) = blocks.stiffness.row(i);
        cols.zip(vals).for_each(|(j, &v)| k.push(i, j, v));
        k.push(i, i, 1e-4);
    }
    blocks.stiffness = k.to_csr().with_dof_coordinates(blocks.stiffness.dof_coordinates().to_vec());
    let mut schur = ActiveSet::new(Schur::default());
    let solution = schur.solve(&blocks.system()).unwrap();
    let report = solution.active_set.as_ref().unwrap();
    assert!(report.iterations > 2, "{report:?}");
    // the second look at a matrix of one pattern is what stores it for comparison
    assert!(schur.inner.factorisations() <= 2 && schur.inner.num_symbolic_factorizations() == 1, "{}", schur.inner.factorisations());
    let direct = ActiveSet::new(Direct::new()).solve(&blocks.system()).unwrap();
    assert!(differences(&blocks, &direct, &solution).iter().all(|&x| x < 1e-9));
    // bodies that float: one pattern, one analysis, however many rows open
    let floating = contact_blocks(0.006);
    let mut schur = ActiveSet::new(Schur::default());
    let report = schur.solve(&floating.system()).unwrap().active_set.unwrap();
    assert!(report.iterations > 2);
    assert_eq!(schur.inner.num_symbolic_factorizations(), 2, "the stiffness once, with the rows as springs once");
    let mut uzawa = ActiveSet::new(Augmented::uzawa(Limits::default()));
    uzawa.solve(&floating.system()).unwrap();
    assert_eq!(uzawa.inner.inner.linear.num_symbolic_factorizations(), 1);
}

// ---------------------------------------------------------------------------------------------- without symmetry

/// A reaction that differs from the constraint by a few per cent on the master side.
fn mixed(blocks: &Blocks) -> Rows {
    let mut reaction = blocks.rows.clone();
    for (k, entry) in reaction.master.entries.iter_mut().enumerate() {
        entry.2 *= 1.0 + 0.05 * (k as f64).sin();
    }
    reaction
}

#[test]
fn gmres_with_the_symmetric_factor_meets_lu_on_a_mixed_system() {
    for (unit, contrast) in [(1.0, 1.0), (210e9, 1e4), (1e-9, 1e-4)] {
        let blocks = Blocks::new((12, unit), (8, unit * contrast), &[0, 1]);
        let reaction = mixed(&blocks);
        let system = ConstrainedSystem { reaction: Some(&reaction), ..blocks.system() };
        let lu = Direct::new().solve(&system).unwrap();
        assert_eq!(lu.method, "saddle-point, LU");
        let gmres = Krylov::new(Limits::default()).solve(&system).unwrap();
        assert_eq!(gmres.method, "saddle-point, GMRES with the symmetric factor");
        let d = differences(&blocks, &gmres, &lu);
        println!("GMRES, unit {unit:.0e}, contrast {contrast:.0e}: {} iterations, {d:?}", gmres.iterations);
        assert!(d.iter().all(|&x| x < 1e-10), "unit {unit:.0e}: {d:?}");
        assert!(gmres.iterations < 60, "{}", gmres.iterations);
        // it is another answer than that of the symmetric system
        let symmetric = Direct::new().solve(&blocks.system()).unwrap();
        assert!(differences(&blocks, &symmetric, &lu).iter().any(|&x| x > 1e-4));
        for (name, make) in &ITERATIVE[1..] {
            assert_eq!(make(Limits::default()).solve(&system).unwrap_err(), SolveError::NotSymmetric, "{name}");
        }
    }
}

// ---------------------------------------------------------------------------------------------- limits

#[test]
fn too_few_iterations_are_an_error_with_the_residual_and_a_stop_is_one() {
    let blocks = Blocks::new((12, 1.0), (8, 1.0), &[0, 1]);
    let reaction = mixed(&blocks);
    for (name, make) in ITERATIVE {
        match make(Limits::new(1e-12).within(1)).solve(&blocks.system()).unwrap_err() {
            SolveError::Linear(LinearError::NotConverged { residual, tolerance, .. }) => {
                assert!(residual > 1e-12 && residual <= 1.0, "{name}: {residual:e}");
                assert!(tolerance >= 1e-12, "{name}");
            }
            other => panic!("{name}: {other}"),
        }
        let stopped = Limits { stop: Cancellation::new(|| true), ..Limits::default() };
        let error = make(stopped.clone()).solve(&blocks.system()).unwrap_err();
        assert!(matches!(error, SolveError::Linear(LinearError::Stopped { .. })), "{name}: {error}");
        let contact = contact_blocks(0.006);
        let error = ActiveSet::new(make(stopped)).solve(&contact.system()).unwrap_err();
        assert!(matches!(error, SolveError::Stopped { iterations: 0, best: None }), "{name}: {error}");
    }
    let system = ConstrainedSystem { reaction: Some(&reaction), ..blocks.system() };
    let error = Krylov::new(Limits::new(1e-12).within(1)).solve(&system).unwrap_err();
    assert!(matches!(error, SolveError::Linear(LinearError::NotConverged { iterations: 1, .. })), "{error}");
}

#[test]
fn answers_do_not_depend_on_the_number_of_threads() {
    let blocks = Blocks::new((12, 1.0), (8, 3.0), &[0, 1]);
    let reaction = mixed(&blocks);
    let all = || -> Vec<ConstrainedSolution> {
        let mut answers: Vec<_> = ITERATIVE.iter().map(|(_, make)| make(Limits::default()).solve(&blocks.system()).unwrap()).collect();
        let system = ConstrainedSystem { reaction: Some(&reaction), ..blocks.system() };
        answers.push(Krylov::new(Limits::default()).solve(&system).unwrap());
        answers
    };
    let with = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(all);
    assert_eq!(with(1), with(2));
}

// ---------------------------------------------------------------------------------------------- case files

/// Every number of a result but those that name the solver.
fn numbers(value: &serde_json::Value, path: &str, found: &mut Vec<(String, f64)>) {
    match value {
        serde_json::Value::Number(n) => found.push((path.into(), n.as_f64().unwrap())),
        serde_json::Value::Array(items) => items.iter().enumerate().for_each(|(k, v)| numbers(v, &format!("{path}.{k}"), found)),
        serde_json::Value::Object(map) => map.iter().for_each(|(k, v)| numbers(v, &format!("{path}.{k}"), found)),
        _ => {}
    }
}

#[test]
fn sample_cases_have_the_same_probes_with_every_solver() {
    use faying_cli::Case;
    use faying_cli::Registry;
    use faying_cli::case::ReadOptions;
    let words: [&[&str]; 6] = [
        &["solver.constraint=\"condensed\""],
        &["solver.constraint=\"schur\"", "solver.tolerance=1e-12"],
        &["solver.constraint=\"uzawa\"", "solver.tolerance=1e-12"],
        &["solver.linear=\"iterative\"", "solver.tolerance=1e-12"],
        &["solver.constraint=\"condensed\"", "solver.linear=\"iterative\"", "solver.tolerance=1e-12"],
        &["solver.constraint=\"uzawa\"", "solver.linear=\"iterative\"", "solver.tolerance=1e-12"],
    ];
    for name in ["iga-fe-arc", "hertz"] {
        let path = format!("{}/examples/cases/{name}.toml", concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
        let text = std::fs::read_to_string(&path).unwrap();
        let run = |sets: &[&str]| {
            let options = ReadOptions { sets: sets.iter().map(|s| (*s).to_string()).collect(), ..ReadOptions::default() };
            let case = Case::parse(&path, &text, &options).unwrap_or_else(|e| panic!("{name} {sets:?}: {e}"));
            case.run(&Registry::default()).unwrap_or_else(|e| panic!("{name} {sets:?}: {e}"))
        };
        let probes = |result: &faying_cli::RunResult| {
            assert_eq!(result.exit, 0, "{name}: {:?}", result.diagnostics);
            let mut found = Vec::new();
            let value = result.to_value();
            for key in ["probes", "energy", "errors", "reactions"] {
                numbers(&value[key], key, &mut found);
            }
            found
        };
        let reference = run(&[]);
        let wanted = probes(&reference);
        assert!(wanted.len() > 3, "{wanted:?}");
        let largest = wanted.iter().fold(0.0f64, |m, (_, v)| m.max(v.abs()));
        // thousands of small systems of an active set are no work for methods without a factor
        for sets in words.into_iter().filter(|sets| name != "hertz" || !sets.contains(&"solver.linear=\"iterative\"")) {
            let other = run(sets);
            let solve = other.solve.as_ref().unwrap();
            println!("{name}, {}: {} iterations, residual {:e}", solve.linear, solve.iterations, solve.residual);
            // the same last set, however it was found
            let set = |r: &faying_cli::RunResult| {
                let report = r.solve.as_ref().unwrap().active_set.clone();
                report.map(|set| (set.history.last().copied(), set.sign_cases.last().cloned(), set.cycles))
            };
            assert_eq!(set(&reference), set(&other), "{name} {sets:?}");
            for ((key, a), (_, b)) in wanted.iter().zip(probes(&other)) {
                // numbers that are rounding of others have no digits of their own
                assert!((a - b).abs() <= 1e-9 * a.abs().max(1e-3 * largest), "{name} {sets:?}: {key} is {b:e} instead of {a:e}");
            }
        }
    }
}

#[test]
fn gmres_with_the_symmetric_part_meets_lu_where_the_stiffness_is_not_symmetric() {
    let mut blocks = Blocks::new((12, 1.0), (8, 1.0), &[0, 1]);
    // a skew part, as unsymmetric couplings add one: the energy stays that of the symmetric part
    let n = blocks.load.len();
    let mut k = Triplets::new(n, n);
    for i in 0..n {
        let (cols, vals) = blocks.stiffness.row(i);
        cols.zip(vals).for_each(|(j, &v)| k.push(i, j, v));
        if i + 3 < n {
            k.push(i, i + 3, 0.1);
            k.push(i + 3, i, -0.1);
        }
    }
    blocks.stiffness = k.to_csr().with_dof_coordinates(blocks.stiffness.dof_coordinates().to_vec());
    let lu = Direct::new().solve(&blocks.system()).unwrap();
    assert_eq!(lu.method, "saddle-point, LU");
    let gmres = Krylov::new(Limits::default()).solve(&blocks.system()).unwrap();
    assert!(differences(&blocks, &gmres, &lu).iter().all(|&x| x < 1e-10));
    assert!(gmres.iterations > 0);
    for (name, make) in &ITERATIVE[1..] {
        let error = make(Limits::default()).solve(&blocks.system()).unwrap_err();
        assert_eq!(error, LinearError::NotSymmetric.into(), "{name}");
    }
}
