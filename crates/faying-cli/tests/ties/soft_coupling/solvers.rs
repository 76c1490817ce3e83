//! Solvers of symmetric positive definite systems refuse others; both know how.

use faying::constraint::{ActiveSet, Condensed, ConstrainedSystem, ConstraintSolver, Direct, RowKind, SolveError};
use faying::coupling::Rows;
use faying::linalg::{Cg, Csr, Ldlt, LinearError, LinearSolver, Lu, Triplets};

/// Springs in a row, stiffness 1, held at both ends, `n` unknowns, and `extra` entries.
fn chain(n: usize, extra: &[(usize, usize, f64)]) -> Csr {
    let mut k = Triplets::new(n, n);
    for i in 0..n {
        k.push(i, i, 2.0);
        if i + 1 < n {
            k.push(i, i + 1, -1.0);
            k.push(i + 1, i, -1.0);
        }
    }
    extra.iter().for_each(|&(i, j, v)| k.push(i, j, v));
    k.to_csr()
}

fn solve(solver: &mut dyn ConstraintSolver, k: &Csr, row: bool) -> Result<Vec<f64>, SolveError> {
    let n = k.num_rows();
    let mut rows = Rows { slave: Triplets::new(usize::from(row), n), master: Triplets::new(usize::from(row), n) };
    if row {
        rows.slave.push(0, 0, 1.0);
        rows.master.push(0, n - 1, -1.0);
    }
    let system = ConstrainedSystem {
        stiffness: k,
        load: &(0..n).map(|i| i as f64).collect::<Vec<_>>(),
        constraint: &rows,
        reaction: None,
        offset: &vec![0.25; usize::from(row)],
        kind: &vec![RowKind::Equal; usize::from(row)],
        compliance: &[],
    };
    solver.solve(&system).map(|s| s.unknowns)
}

#[test]
fn a_stiffness_that_is_not_symmetric_is_solved_by_lu_and_refused_by_the_others() {
    for n in [5, 300] {
        let k = chain(n, &[(1, 3, 0.3), (0, n - 1, 0.01)]);
        for solver in [&mut Ldlt::new() as &mut dyn LinearSolver, &mut Cg::new(1e-10)] {
            assert_eq!(solver.prepare(&k).unwrap_err(), LinearError::NotSymmetric);
        }
        assert!(Lu::new().prepare(&k).is_ok());
        for row in [false, true] {
            let u = solve(&mut Direct::new(), &k, row).unwrap();
            assert_eq!(solve(&mut ActiveSet::new(Direct::new()), &k, row).unwrap(), u);
            assert_eq!(solve(&mut Condensed::new(), &k, row).unwrap_err(), LinearError::NotSymmetric.into());
            // rows that no constraint touches are in equilibrium
            let mut f = vec![0.0; n];
            k.mul(&u, &mut f);
            (1..n - 1).for_each(|i| assert!((f[i] - i as f64).abs() < 1e-9 * n as f64 * n as f64, "row {i}: {}", f[i]));
            assert!(!row || (u[0] - u[n - 1] + 0.25).abs() < 1e-9);
        }
        // rounding is no lack of symmetry
        assert!(solve(&mut Condensed::new(), &chain(n, &[(1, 3, 1e-14)]), true).is_ok());
    }
}

#[test]
fn a_stiffness_with_negative_energy_is_refused_with_the_number_of_its_directions() {
    for n in [5, 300, 4000] {
        // two unknowns far from each other are pushed away from rest
        let k = chain(n, &[(1, 1, -3.0), (n - 2, n - 2, -3.0)]);
        for row in [false, true] {
            for solver in [&mut Direct::new() as &mut dyn ConstraintSolver, &mut Condensed::new()] {
                assert_eq!(solve(solver, &k, row).unwrap_err(), LinearError::Indefinite { negative: 2 }.into(), "{n} {row}");
            }
        }
        // as soft as it may be: still an energy
        let soft = chain(n, &[(0, 0, -0.999_999)]);
        assert!(solve(&mut Direct::new(), &soft, true).is_ok());
    }
}
