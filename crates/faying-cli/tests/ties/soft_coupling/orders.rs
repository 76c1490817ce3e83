//! Orders of convergence of Nitsche's method, and the error of penalties against their factor.

use super::sample::{Sample, error};
use rayon::prelude::*;

/// The problem of the mortar rates: Poisson, y = 1/2, theory less 0.1.
const EXACT: &str = "cos(3*x + 0.3)*exp(y) + sin(2*pi*x*y)";
const SLACK: f64 = 0.1;

/// Elements of slave and master at a level; the slave finer, 3:2, or coarser.
fn elements(level: usize, finer: bool, slave: usize) -> [[usize; 2]; 2] {
    let n = 1 << level;
    let of = |along: usize| [along, along / 2];
    let (s, m) = if finer { (of(3 * n), of(2 * n)) } else { (of(2 * n), of(3 * n)) };
    if slave == 0 { [s, m] } else { [m, s] }
}

#[test]
fn nitsche_has_the_orders_of_theory_on_both_backends_and_across() {
    let mut cases = Vec::new();
    for backends in [["iga", "iga"], ["fe", "fe"], ["iga", "fe"], ["fe", "iga"], ["iga", "simplex"]] {
        for (degree, finer) in (1..=4).flat_map(|p| [(p, true), (p, false)]) {
            for variant in ["symmetric", "unsymmetric", "incomplete"] {
                // the other variants across backends, the highest degree on one grid of each kind
                let wanted = if degree == 4 { finer || backends == ["iga"; 2] } else { true };
                if wanted && (variant == "symmetric" || (degree <= 2 && backends == ["iga", "fe"])) {
                    cases.push((backends, degree, finer, variant));
                }
            }
        }
    }
    let rates: Vec<([f64; 3], _)> = cases
        .into_par_iter()
        .map(|case| {
            let (backends, degree, finer, variant) = case;
            let [coarse, fine] = [2, 3].map(|level| {
                let tie = format!("coupling = \"nitsche\"\nvariant = \"{variant}\"\nextra_points = 2");
                let sample = Sample { backends, degree, elements: elements(level, finer, 0), ..Sample::poisson(EXACT, &tie) };
                let result = sample.run();
                ["u.L2", "u.H1", "i.lambda.L2"].map(|name| error(&result, name))
            });
            (std::array::from_fn(|k| (coarse[k] / fine[k]).log2()), case)
        })
        .collect();
    let mut wrong = Vec::new();
    for (rate, (backends, degree, finer, variant)) in rates {
        let p = degree as f64;
        // without the symmetric term the dual problem has no consistency: only order p is proven in L2
        let l2 = if variant == "symmetric" { p + 1.0 } else { p };
        // h^(1/2) |lambda - lambda_h| is of order p
        for (name, found, theory) in [("L2", rate[0], l2), ("H1", rate[1], p), ("lambda", rate[2], p - 0.5)] {
            println!("{backends:?} p = {degree}, {variant}, finer {finer}: {name} {found:.2} ({theory})");
            if found < theory - SLACK {
                wrong.push(format!("{backends:?} p = {degree}, {variant}, finer {finer}: {name} {found:.2} < {theory}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_order_of_an_elastic_body_is_that_of_theory_with_either_slave() {
    for (slave, degree) in [(0, 2), (1, 2), (1, 3)] {
        let exact = ["sin(2*x + y)*exp(y)", "x*y^2 + cos(3*x)"];
        let [coarse, fine] = [2, 3].map(|level| {
            let sample = Sample {
                slave,
                degree,
                backends: ["fe", "iga"],
                elements: elements(level, true, slave),
                ..Sample::elastic(exact, "coupling = \"nitsche\"")
            };
            let result = sample.run();
            ["u.L2", "u.energy", "i.lambda.L2"].map(|name| error(&result, name))
        });
        let p = degree as f64;
        for (k, theory) in [p + 1.0, p, p - 0.5].into_iter().enumerate() {
            let rate = (coarse[k] / fine[k]).log2();
            assert!(rate > theory - SLACK, "slave {slave}, p = {degree}, norm {k}: {rate:.2} < {theory}");
        }
    }
}

// A linear field is reproduced by the mortar coupling: what is left is the penalty's own error, inverse to its factor.
#[test]
fn the_error_of_a_penalty_is_inverse_to_its_factor() {
    for (poisson, slave) in [(true, 0), (true, 1), (false, 0)] {
        let with = |factor: f64| {
            let tie = format!("coupling = \"penalty\"\nfactor = {factor:e}");
            let sample = if poisson {
                Sample::poisson("0.3*x - 0.2*y + 1", &tie)
            } else {
                Sample::elastic(["0.3*x + 0.5*y", "0.1*x - 0.4*y"], &tie)
            };
            let result = Sample { slave, ..sample }.run();
            let jump = result.interface.get("i").unwrap().jump.l2;
            [error(&result, "u.L2"), error(&result, "i.lambda.L2.rel"), jump]
        };
        let found: Vec<[f64; 3]> = [1e2, 1e4, 1e6, 1e8].map(with).to_vec();
        for pair in found.windows(2) {
            for k in 0..3 {
                let ratio = pair[0][k] / pair[1][k];
                assert!((80.0..125.0).contains(&ratio), "poisson {poisson}, slave {slave}: {ratio} in {found:?}");
            }
        }
        assert!(found[3][0] < 1e-8, "{found:?}");
    }
}

#[test]
fn a_penalty_reaches_the_error_of_the_mortar_coupling_on_any_grid() {
    for level in [1, 2, 3] {
        let with = |tie: &str| {
            let sample = Sample { degree: 3, elements: elements(level, true, 0), ..Sample::poisson(EXACT, tie) };
            let result = sample.run();
            [error(&result, "u.L2"), error(&result, "u.H1"), error(&result, "i.lambda.L2")]
        };
        let (mortar, penalty) = (with("coupling = \"mortar\""), with("coupling = \"penalty\""));
        for k in 0..3 {
            assert!((mortar[k] - penalty[k]).abs() < 1e-2 * mortar[k], "level {level}: {mortar:?} {penalty:?}");
        }
    }
}
