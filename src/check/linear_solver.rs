//! Contract of `LinearSolver`: correct solutions of positive definite systems, errors for systems without one.

use crate::linalg::{Csr, LinearError, LinearSolver, Operator, Triplets};

/// Checks solvers made by `make` on chains and grids of springs in several units.
///
/// Covers known solutions, one object for new values and patterns, singular and contradictory systems, wrong lengths, and numbers that
/// are not finite.
///
/// # Errors
/// A sentence that names the broken rule and the place.
pub fn linear_solver(make: impl Fn() -> Box<dyn LinearSolver>) -> Result<(), String> {
    let mut solver = make();
    // one object for all systems: new values of a pattern, new patterns, and sizes that grow and shrink
    for (n, unit) in [(1, 1.0), (20, 1.0), (20, 1e12), (20, 1e-12), (300, 1.0), (7, 1e9)] {
        answers(&mut *solver, &chain(n, unit, 1.0), &format!("chain of {n} springs of stiffness {unit:.0e}"))?;
    }
    answers(&mut *solver, &grid(24, false), "grid of 24 x 24 unknowns")?;
    answers(&mut *solver, &grid(24, true), "grid of 24 x 24 unknowns with places")?;
    let mut uneven = grid(12, true);
    uneven.vals_mut().iter_mut().for_each(|v| *v *= 3.0);
    answers(&mut *solver, &uneven, "grid of 12 x 12 unknowns, other values")?;

    let a = chain(10, 1.0, 1.0);
    prepared(&mut *solver, &a, "chain")?;
    let mut x = vec![1.0; 10];
    solver.solve(&a, &[0.0; 10], &mut x).map_err(|e| format!("linear solver: the right-hand side zero fails: {e}"))?;
    if x.iter().any(|&v| v.abs() > 1e-9) {
        return Err("linear solver: the right-hand side zero does not give zero".into());
    }
    if !matches!(solver.solve(&a, &[1.0; 9], &mut [0.0; 9]), Err(LinearError::Shape { .. })) {
        return Err("linear solver: a right-hand side of another length is not refused as `Shape`".into());
    }
    let mut b = [1.0; 10];
    b[3] = f64::NAN;
    if solver.solve(&a, &b, &mut [0.0; 10]).is_ok() {
        return Err("linear solver: a right-hand side that is not a number is accepted".into());
    }
    let mut broken = a.clone();
    broken.vals_mut()[4] = f64::INFINITY;
    if solver.prepare(&broken).and_then(|()| solver.solve(&broken, &[1.0; 10], &mut [0.0; 10])).is_ok() {
        return Err("linear solver: an infinite entry of the matrix is accepted".into());
    }
    // a chain without support, pulled at one end: no solution exists
    let free = chain(10, 1.0, 0.0);
    let mut pull = [0.0; 10];
    pull[9] = 1.0;
    let mut x = [0.0; 10];
    if solver.prepare(&free).and_then(|()| solver.solve(&free, &pull, &mut x)).is_ok() {
        return Err("linear solver: a singular system without a solution is answered".into());
    }
    answers(&mut *solver, &a, "chain after errors")
}

/// n springs in a row, the first one to the ground (stiffness `support` times the others).
fn chain(n: usize, unit: f64, support: f64) -> Csr {
    let mut k = Triplets::new(n, n);
    k.push(0, 0, unit * support);
    for i in 1..n {
        for (a, b, v) in [(i, i, unit), (i - 1, i - 1, unit), (i, i - 1, -unit), (i - 1, i, -unit)] {
            k.push(a, b, v);
        }
    }
    k.to_csr()
}

/// Five-point grid, all sides fixed; numbered in a scattered order so that the order matters.
fn grid(n: usize, places: bool) -> Csr {
    let id = |i: usize, j: usize| (i * n + j) * 7 % (n * n);
    let mut k = Triplets::new(n * n, n * n);
    let mut at = vec![[0.0; 3]; n * n];
    for i in 0..n {
        for j in 0..n {
            at[id(i, j)] = [i as f64, j as f64, 0.0];
            k.push(id(i, j), id(i, j), 4.0);
            for (p, q) in [(i.wrapping_sub(1), j), (i + 1, j), (i, j.wrapping_sub(1)), (i, j + 1)] {
                if p < n && q < n {
                    k.push(id(i, j), id(p, q), -1.0);
                }
            }
        }
    }
    let k = k.to_csr();
    if places { k.with_dof_coordinates(at) } else { k }
}

fn prepared(solver: &mut dyn LinearSolver, a: &Csr, name: &str) -> Result<(), String> {
    solver.prepare(a).map_err(|e| format!("linear solver: {name}: prepare fails: {e}"))
}

fn answers(solver: &mut dyn LinearSolver, a: &Csr, name: &str) -> Result<(), String> {
    prepared(solver, a, name)?;
    let n = a.size();
    for k in [1.0, 2.7] {
        let expected: Vec<f64> = (0..n).map(|i| (k * (i + 1) as f64).sin()).collect();
        let (mut b, mut x) = (vec![0.0; n], vec![0.0; n]);
        a.apply(&expected, &mut b);
        solver.solve(a, &b, &mut x).map_err(|e| format!("linear solver: {name}: {e}"))?;
        if let Some(i) = (0..n).find(|&i| x[i].is_nan() || (x[i] - expected[i]).abs() > 1e-7) {
            return Err(format!("linear solver: {name}: unknown {i} is {} instead of {}", x[i], expected[i]));
        }
    }
    Ok(())
}
