//! The direct solver: what it keeps from system to system, and the condition it reports.

use crate::common::blocks;
use blocks::{Blocks, contact_blocks};
use faying::constraint::{Abilities, ActiveSet, ConstrainedSolution, ConstrainedSystem, ConstraintSolver, Direct, RowKind, SolveError};
use faying::coupling::Rows;
use faying::linalg::{Csr, Ldlt, LinearError, LinearSolver, Triplets};
use std::f64::consts::PI;

/// A direct solver that writes down (rows enforced, analyses so far).
#[derive(Debug)]
struct Counted(Direct, std::sync::Arc<std::sync::Mutex<Vec<(usize, usize)>>>);

impl ConstraintSolver for Counted {
    fn abilities(&self) -> Abilities {
        self.0.abilities()
    }

    fn solve(&mut self, system: &ConstrainedSystem<'_>) -> Result<ConstrainedSolution, SolveError> {
        let solution = self.0.solve(system);
        let enforced = system.kind.iter().filter(|&&k| k == RowKind::Equal).count();
        self.1.lock().unwrap().push((enforced, self.0.num_symbolic_factorizations()));
        solution
    }
}

#[test]
fn a_run_of_several_steps_with_changing_contact_analyses_once() {
    use faying_cli::Case;
    use faying_cli::case::ReadOptions;
    use faying_cli::{Registry, Status};
    let seen = std::sync::Arc::new(std::sync::Mutex::new(Vec::new()));
    let mut registry = Registry::default();
    let list = seen.clone();
    registry.solvers.add("counted", Box::new(move |_| Ok(Box::new(Counted(Direct::new(), list.clone())))));
    let text = "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
                [[patch]]\nname = \"a\"\nbackend = \"fe\"\ngeometry = { kind = \"box\", min = [0, 0], max = [1, 1] }\nelements = [6, 4]\n\
                [[patch]]\nname = \"b\"\nbackend = \"iga\"\ngeometry = { kind = \"box\", min = [0, 1], max = [1, 2] }\nelements = [5, 4]\n\
                [[boundary]]\non = \"a.bottom\"\nfix = [\"x\", \"y\"]\n[[boundary]]\non = \"b.left\"\nfix = [\"x\"]\n\
                [[boundary]]\non = \"b.top\"\npressure = \"0.001*(1 - 40*t*(x - 0.5))\"\n\
                [[contact]]\nname = \"c\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\n[steps]\nt = [0.05, 0.3, 0.6, 1]\n\
                [solver]\nconstraint = \"counted\"\n";
    let options = ReadOptions { names: registry.case_names(), ..ReadOptions::default() };
    let result =
        Case::parse("case.toml", text, &options).unwrap_or_else(|e| panic!("{e}")).run(&registry).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(result.status, Status::Ok, "{:?}", result.diagnostics);
    let seen = seen.lock().unwrap();
    // more systems than steps, in several states of contact, under one analysis
    assert!(seen.len() > 4 && seen.iter().any(|s| s.0 != seen[0].0), "{seen:?}");
    assert!(seen.iter().all(|s| s.1 == 1), "{seen:?}");
    let condition = result.solve.unwrap().condition.unwrap();
    assert!(condition > 10.0 && condition < 1e7, "{condition}");
}

#[test]
fn steps_of_load_and_changes_of_contact_share_one_analysis_and_another_pattern_gets_its_own() {
    let mut solver = ActiveSet::new(Direct::new());
    let mut active = Vec::new();
    for lift in [0.0, 0.002, 0.004, 0.006, 0.003] {
        let solution = solver.solve(&contact_blocks(lift).system()).unwrap();
        active.push(solution.active.iter().filter(|&&a| a).count());
        assert_eq!(solver.inner.num_symbolic_factorizations(), 1, "{active:?}");
    }
    assert!(active.windows(2).any(|w| w[0] != w[1]), "{active:?}");
    solver.inner.solve(&Blocks::new((6, 1.0), (4, 1.0), &[0, 1]).system()).unwrap();
    assert_eq!(solver.inner.num_symbolic_factorizations(), 2);
}

#[test]
fn three_steps_are_the_whole_and_a_known_pattern_keeps_its_analysis() {
    let a = laplace(12, 9, |_| 1.0);
    let (mut whole, mut parts) = (Ldlt::new(), Ldlt::new());
    whole.prepare(&a).unwrap();
    parts.analyse(&a).unwrap();
    assert_eq!((parts.num_symbolic_factorizations(), parts.factorisations()), (1, 0));
    parts.factorise(&a).unwrap();
    parts.check(&a).unwrap();
    let b: Vec<f64> = (0..108).map(|i| f64::from(i % 7) - 3.0).collect();
    let (mut x, mut y) = (vec![0.0; 108], vec![0.0; 108]);
    whole.solve(&a, &b, &mut x).unwrap();
    parts.solve(&a, &b, &mut y).unwrap();
    assert_eq!(x, y);
    let mut twice = a.clone();
    twice.vals_mut().iter_mut().for_each(|v| *v *= 2.0);
    parts.prepare(&twice).unwrap();
    assert_eq!((parts.num_symbolic_factorizations(), parts.factorisations()), (1, 2));
    parts.solve(&twice, &b, &mut y).unwrap();
    assert!(x.iter().zip(&y).all(|(x, y)| (x - 2.0 * y).abs() < 1e-14 * x.abs().max(1.0)));
    // not symmetric any more: refused, and what was known serves the next
    let mut skew = a.clone();
    skew.row_mut(5).1[0] *= 1.01;
    assert_eq!(parts.prepare(&skew), Err(LinearError::NotSymmetric));
    parts.prepare(&a).unwrap();
    assert_eq!(parts.num_symbolic_factorizations(), 1);
}

/// Five-point stencil on an inner n x m grid with zero values around, rows and columns scaled by `unit`.
fn laplace(n: usize, m: usize, unit: impl Fn(usize) -> f64) -> Csr {
    let mut t = Triplets::new(n * m, n * m);
    for j in 0..m {
        for i in 0..n {
            let own = j * n + i;
            t.push(own, own, 4.0 * unit(own) * unit(own));
            let beside = [(i > 0).then(|| own - 1), (i + 1 < n).then(|| own + 1), (j > 0).then(|| own - n), (j + 1 < m).then(|| own + n)];
            beside.into_iter().flatten().for_each(|other| t.push(own, other, -unit(own) * unit(other)));
        }
    }
    t.to_csr()
}

#[test]
fn the_condition_is_that_of_a_known_spectrum_whatever_the_units() {
    for (n, m) in [(1, 1), (5, 1), (40, 1), (12, 9), (40, 40)] {
        // eigenvalues of the scaled matrix: 1 - (cos i pi / (n + 1) + cos j pi / (m + 1)) / 2
        let least = 1.0 - 0.5 * ((PI / (n as f64 + 1.0)).cos() + (PI / (m as f64 + 1.0)).cos());
        let exact = (2.0 - least) / least;
        for unit in [|_: usize| 1.0, |i: usize| 10f64.powi(i as i32 % 9 - 4)] {
            let a = laplace(n, m, unit);
            let mut solver = Ldlt::new();
            solver.prepare(&a).unwrap();
            let condition = solver.condition(&a).unwrap();
            assert!((0.4..2.5).contains(&(condition / exact)), "{n} x {m}: {condition}, exact {exact}");
        }
    }
}

#[test]
fn the_condition_of_a_constrained_system_is_that_of_its_matrix() {
    // a chain held at its ends by rows alone: what is left to move are n - 2 links between fixed ends
    let n = 30;
    let mut k = Triplets::new(n, n);
    for i in 0..n {
        let ends = usize::from(i == 0) + usize::from(i == n - 1);
        k.push(i, i, 2.0 - ends as f64);
        if i + 1 < n {
            k.push(i, i + 1, -1.0);
            k.push(i + 1, i, -1.0);
        }
    }
    let mut rows = Rows { slave: Triplets::new(2, n), master: Triplets::new(2, n) };
    rows.slave.push(0, 0, 5.0);
    rows.slave.push(1, n - 1, 0.1);
    let (stiffness, load) = (k.to_csr(), vec![1.0; n]);
    let system = ConstrainedSystem {
        stiffness: &stiffness,
        load: &load,
        constraint: &rows,
        reaction: None,
        offset: &[0.0; 2],
        kind: &[RowKind::Equal; 2],
        compliance: &[],
    };
    let solution = Direct::new().solve(&system).unwrap();
    let least = 1.0 - (PI / (n as f64 - 1.0)).cos();
    let exact = (2.0 - least) / least;
    let condition = solution.condition.unwrap();
    assert!((0.4..2.5).contains(&(condition / exact)), "{condition}, exact {exact}");
    // nothing but the matrix decides
    let other = Direct::new().solve(&ConstrainedSystem { load: &vec![-3.0; n], ..system }).unwrap();
    assert_eq!(other.condition, solution.condition);
}

#[test]
fn the_factor_answers_for_no_matrix_of_another_size() {
    let (small, large) = (laplace(4, 3, |_| 1.0), laplace(7, 5, |_| 1.0));
    for (known, other) in [(&small, &large), (&large, &small)] {
        let mut solver = Ldlt::new();
        solver.prepare(known).unwrap();
        let (expected, found) = (known.num_rows(), other.num_rows());
        for error in [solver.check(other).unwrap_err(), solver.condition(other).unwrap_err()] {
            assert!(matches!(error, LinearError::Shape { expected: e, found: f } if (e, f) == (expected, found)), "{error}");
        }
        assert!(solver.condition(known).unwrap() > 1.0);
    }
}
