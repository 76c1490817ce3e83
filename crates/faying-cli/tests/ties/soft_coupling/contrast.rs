//! Moduli that jump by 1e6 across the interface, and units: what is soft must not feel how hard its neighbour is.

use super::sample::{Sample, error, solved};

/// Lower and upper modulus.
const CONTRASTS: [[f64; 2]; 3] = [[1.0, 1.0], [1.0, 1e6], [1e6, 1.0]];

/// With S = y - 1/2 and moduli m: u = w / m + v, w = 0 on the interface, the flux of w of unit modulus is that of both sides, and v has
/// none. Value and flux are continuous whatever the moduli are.
fn piecewise(w: &str, v: &str, m: [f64; 2]) -> String {
    let text = format!("if(y < 0.5, ({w})/{:e}, ({w})/{:e}) + ({v})", m[0], m[1]);
    text.replace('S', "(y - 0.5)")
}

/// Relative error of Nitsche's lambda on the grids of these tests.
const LAMBDA: f64 = 0.05;

const COUPLINGS: [&str; 2] = ["coupling = \"nitsche\"", "coupling = \"mortar\"\nmultiplier = \"p/p-2\""];

/// The relative error of the energy norm at a jump is at most twice that of equal moduli.
///
/// `traction` is that of the lower body at the interface: lambda is minus that of the slave.
fn ratios(sample: impl Fn([f64; 2]) -> Sample, traction: &[&str], what: &str) {
    for slave in [0, 1] {
        let sign = if slave == 0 { "-" } else { "" };
        let list: Vec<String> = traction.iter().map(|t| format!("\"{sign}({t})\"")).collect();
        let exact = if list.len() == 1 { list[0].clone() } else { format!("[{}]", list.join(", ")) };
        let [equal, up, down] = CONTRASTS.map(|m| {
            let sample = sample(m);
            let tie = format!("{}\nexact = {exact}", sample.tie);
            let result = Sample { slave, tie, ..sample }.run();
            // nor does the hard side spoil the traction; multipliers on a hard slave that is finer than its soft master have no such bound
            let lambda = error(&result, "i.lambda.L2.rel");
            assert!(lambda < LAMBDA || what.contains("mortar"), "{what}, slave {slave}, moduli {m:?}: lambda {lambda:e}");
            error(&result, "u.energy.rel")
        });
        for jump in [up, down] {
            println!("{what}, slave {slave}: energy {equal:.2e} {jump:.2e}");
            assert!(jump < 2.0 * equal, "{what}, slave {slave}: energy {equal:e} {jump:e}");
        }
    }
}

#[test]
fn a_conductivity_that_jumps_by_a_million_costs_no_more_than_a_factor_two() {
    let w = "S*(1 + sin(2*x)) + S^2*cos(3*x)";
    for tie in COUPLINGS {
        for degree in [2, 3] {
            // v = 0: the hard side is nearly at rest; else it carries nearly all energy
            for v in ["0", "cos(2*x)*(1 + S^2)"] {
                for backends in [["iga", "iga"], ["fe", "iga"]] {
                    ratios(
                        |m| Sample {
                            materials: m.map(|k| format!("conductivity = {k:e}")),
                            degree,
                            backends,
                            elements: [[12, 6], [8, 4]],
                            ..Sample::poisson(&piecewise(w, v, m), tie)
                        },
                        &["1 + sin(2*x)"],
                        &format!("{tie} p = {degree}, v = {v}, {backends:?}"),
                    );
                }
            }
        }
    }
}

#[test]
fn a_stiffness_that_jumps_by_a_million_costs_no_more_than_a_factor_two() {
    // v has no traction at S = 0: eps_yy = -nu/(1 - nu) eps_xx = -3/7 eps_xx, no shear
    let w = ["S*(0.5 + sin(2*x))", "S*cos(x) + S^2*sin(3*x)"];
    for tie in COUPLINGS {
        for v in [["0", "0"], ["sin(2*x)", "-6/7*cos(2*x)*S"]] {
            ratios(
                |m| {
                    let exact = [piecewise(w[0], v[0], m), piecewise(w[1], v[1], m)];
                    Sample {
                        materials: m.map(|e| format!("young = {e:e}\npoisson = 0.3")),
                        degree: 2,
                        elements: [[12, 6], [8, 4]],
                        backends: ["iga", "fe"],
                        ..Sample::elastic([&exact[0], &exact[1]], tie)
                    }
                },
                // mu and lambda + 2 mu of E = 1, nu = 0.3
                &["(0.5 + sin(2*x))/2.6", "cos(x)*0.7/(1.3*0.4)"],
                &format!("elastic, {tie}, v = {v:?}"),
            );
        }
    }
}

#[test]
fn units_of_force_and_length_change_no_relative_error() {
    for tie in ["coupling = \"nitsche\"", "coupling = \"nitsche\"\nvariant = \"unsymmetric\"", "coupling = \"penalty\"\nfactor = 1e3"] {
        let with = |young: f64, size: f64| {
            let f =
                |text: &str| format!("{size:e}*({})", text.replace('X', &format!("(x/{size:e})")).replace('Y', &format!("(y/{size:e})")));
            let exact = [f("sin(2*X + Y)*exp(Y)"), f("X*Y^2 + cos(3*X)")];
            let sample = Sample {
                materials: [format!("young = {young:e}\npoisson = 0.3"), format!("young = {:e}\npoisson = 0.2", 3.0 * young)],
                size,
                ..Sample::elastic([&exact[0], &exact[1]], tie)
            };
            let result = sample.run();
            ["u.L2.rel", "u.energy.rel", "i.lambda.L2.rel"].map(|name| error(&result, name))
        };
        let reference = with(1.0, 1.0);
        for (young, size) in [(1e-9, 1.0), (1e12, 1.0), (2.1e5, 1e-3), (1.0, 1e4), (1e12, 1e-6)] {
            for (a, b) in with(young, size).into_iter().zip(reference) {
                assert!((a - b).abs() < 1e-7 * b, "{tie}: E = {young:e}, L = {size:e}: {a:e} {b:e}");
            }
        }
    }
}

#[test]
fn results_of_soft_couplings_do_not_depend_on_the_number_of_threads() {
    for tie in ["coupling = \"nitsche\"", "coupling = \"nitsche\"\nvariant = \"incomplete\"", "coupling = \"penalty\""] {
        let text = Sample { elements: [[12, 4], [17, 4]], ..Sample::elastic(["sin(2*x + y)", "x*y^2"], tie) }.text();
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| solved(&text).to_json())
        };
        assert_eq!(with(1), with(2), "{tie}");
    }
}
