//! Multipliers that lower the order of convergence are told, and those that are told do: against a known solution on two grids.

use faying_cli::case::ReadOptions;
use faying_cli::errors::Diagnostic;
use faying_cli::{Case, Registry, RunResult, Status};

/// Two boxes tied along y = 1/2, 6 elements on 4 and their halves, with a smooth solution; the slave is below.
fn seam(backend: &str, degree: usize, multiplier: &str, integration: &str, refine: usize) -> RunResult {
    seam_of([6, 4], backend, degree, multiplier, integration, refine)
}

/// The same with other numbers of elements along the seam.
fn seam_of([below, above]: [usize; 2], backend: &str, degree: usize, multiplier: &str, integration: &str, refine: usize) -> RunResult {
    let block = |name: &str, low: f64, elements: [usize; 2]| {
        let high = low + 0.5;
        format!(
            "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"box\", min = [0, {low}], max = [1, {high}] }}\nelements = {elements:?}\nrefine = {refine}\n"
        )
    };
    let text = format!(
        "[model]\nphysics = \"elasticity\"\ndimension = 2\nexact = {{ u = [\"0.01*sin(2*x)*cos(y)\", \"0.01*cos(x)*exp(y)\"] }}\n\
         [discretization]\nbackend = \"{backend}\"\ndegree = {degree}\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n"
    ) + &block("a", 0.0, [below, 3])
        + &block("b", 0.5, [above, 2])
        + "[[boundary]]\non = \"all-outer\"\ndirichlet = \"exact\"\n"
        + &format!(
            "[[interface]]\nname = \"seam\"\nslave = \"a.top\"\nmaster = \"b.bottom\"\nmultiplier = \"{multiplier}\"\nintegration = \"{integration}\"\n"
        );
    let case = Case::parse("case.toml", &text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let result = case.run(&Registry::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert_eq!(result.status, Status::Ok, "{:?}\n{text}", result.diagnostics);
    result
}

/// The warning of a code with a word.
fn told<'a>(result: &'a RunResult, code: &str, word: &str) -> Option<&'a Diagnostic> {
    result.warnings.iter().find(|w| w.code == code && w.message.contains(word))
}

/// Order of an error between the grids halved `from` times and once more.
fn order(of: &dyn Fn(usize) -> RunResult, error: &str, from: usize) -> f64 {
    let value = |refine: usize| *of(refine).errors.get(error).unwrap_or_else(|| panic!("no {error}"));
    (value(from) / value(from + 1)).log2()
}

const DUAL: &str = "holds constants only";
const MIXED: &str = "mixed integration of \"seam\"";

#[test]
fn dual_multipliers_of_splines_are_told_from_degree_3_on() {
    for (degree, wrong) in [(3, 0.33), (4, 1.09)] {
        let dual = |refine: usize| seam("iga", degree, "dual", "merged", refine);
        let coarse = dual(0);
        let warning = told(&coarse, "E061", DUAL).unwrap_or_else(|| panic!("{:?}", coarse.warnings));
        assert!(warning.message.contains(&format!("degree {degree}")) && warning.line == Some(29), "{warning:?}");
        assert_eq!(warning.help.as_deref(), Some("use p/p or p/p-2"));
        // lambda is off by tens of percent, and falls with order 1 or little more; the energy falls with order 2 for the degree
        let found = *coarse.errors.get("error.seam.lambda.L2.rel").unwrap();
        assert!((found / wrong - 1.0).abs() < 0.02, "{degree}: {found}");
        let (lambda, energy) = (order(&dual, "error.seam.lambda.L2", 2), order(&dual, "error.u.energy", 2));
        assert!(lambda < 1.5 && energy < 2.2, "{degree}: {lambda} {energy}");
        // what the help names keeps the order
        for good in ["p/p", "p/p-2"] {
            let good = |refine: usize| seam("iga", degree, good, "merged", refine);
            assert!(good(0).warnings.is_empty(), "{:?}", good(0).warnings);
            assert!(order(&good, "error.u.energy", 1) > degree as f64 - 0.1);
        }
    }
}

#[test]
fn dual_multipliers_that_keep_the_order_are_not_told() {
    for (backend, degree) in [("iga", 1), ("iga", 2), ("fe", 1), ("fe", 2), ("fe", 3), ("fe", 4)] {
        let result = seam(backend, degree, "dual", "merged", 0);
        assert!(told(&result, "E061", DUAL).is_none(), "{backend} {degree}: {:?}", result.warnings);
    }
    // of Lagrange elements dual multipliers have the order of the degree
    let of = |refine: usize| seam("fe", 3, "dual", "merged", refine);
    assert!(order(&of, "error.seam.lambda.L2", 0) > 2.8 && order(&of, "error.u.L2", 0) > 3.8);
}

#[test]
fn mixed_integration_of_multipliers_that_jump_or_kink_is_told() {
    for (backend, degree) in [("iga", 2), ("iga", 3), ("fe", 2), ("fe", 3)] {
        let mixed = |refine: usize| seam(backend, degree, "p/p-2", "mixed", refine);
        let result = mixed(0);
        let warning = told(&result, "E065", MIXED).unwrap_or_else(|| panic!("{:?}", result.warnings));
        assert!(warning.message.contains(&format!("multiplier of degree {}", degree - 2)) && warning.line == Some(30), "{warning:?}");
        assert!(warning.help.as_ref().is_some_and(|help| help.contains("multiplier = \"p/p\"")), "{warning:?}");
        assert!(order(&mixed, "error.u.L2", 2) < 2.3, "{backend} {degree}");
    }
}

/// Functions of Lagrange elements kink at their vertices, which takes up to an order of those of splines; on finer grids it is a whole one.
#[test]
fn mixed_integration_of_lagrange_elements_is_told_at_any_degree() {
    for (backend, degree, multiplier) in
        [("iga", 2, "p/p"), ("iga", 3, "p/p"), ("iga", 4, "p/p-2"), ("fe", 2, "p/p"), ("fe", 3, "p/p"), ("fe", 4, "p/p-2")]
    {
        let [mixed, merged] = ["mixed", "merged"].map(|rule| move |refine: usize| seam(backend, degree, multiplier, rule, refine));
        let (result, from) = (mixed(0), if degree == 4 { 1 } else { 3 });
        let orders = (order(&mixed, "error.u.L2", from), order(&merged, "error.u.L2", from));
        match told(&result, "E065", MIXED) {
            None => assert!(backend == "iga" && orders.0 > degree as f64 + 0.8, "{backend} {degree}: {orders:?}, {:?}", result.warnings),
            Some(warning) => {
                assert!(
                    backend == "fe" && warning.message.ends_with(&format!("errors of u may fall with order {} only", degree.min(3))),
                    "{warning:?}"
                );
                assert!(warning.help.as_ref().is_some_and(|help| help.contains("integration = \"merged\"")), "{warning:?}");
                assert!(orders.0 < orders.1 - 0.25 && orders.1 > degree as f64 + 0.8, "{backend} {degree}: {orders:?}");
            }
        }
    }
}

/// Functions that jump or kink and hold polynomials of degree k leave the error with order min(k + 1, p), where the master has twice the size.
#[test]
fn mixed_integration_has_the_order_that_is_told() {
    for (backend, degree, multiplier, known) in [
        ("iga", 2, "dual", 1),
        ("iga", 2, "constant", 1),
        ("fe", 2, "constant", 1),
        ("fe", 2, "p/p-2", 1),
        ("iga", 3, "p/p-2", 2),
        ("fe", 3, "p/p-2", 2),
        ("fe", 4, "p/p-2", 3),
        ("fe", 1, "p/p", 1),
        ("fe", 1, "dual", 1),
    ] {
        let of = |rule: &str, refine: usize| seam_of([8, 4], backend, degree, multiplier, rule, refine);
        let warning = told(&of("mixed", 0), "E065", MIXED).cloned().unwrap_or_else(|| panic!("{backend} {degree} {multiplier}"));
        assert!(warning.message.ends_with(&format!("errors of u may fall with order {known} only")), "{warning:?}");
        let from = if degree == 4 { 1 } else { 2 };
        let [mixed, merged] = ["mixed", "merged"].map(|rule| order(&|refine| of(rule, refine), "error.u.L2", from));
        println!("{backend} {degree} {multiplier}: {mixed} {merged}");
        assert!((mixed - known as f64).abs() < 0.3 && merged > mixed + 0.7, "{backend} {degree} {multiplier}: {mixed} {merged}");
    }
}

/// In space, on cubes and tetrahedra, and with a master of a lower degree than the slave.
#[test]
fn mixed_integration_in_space_and_of_masters_of_low_degree_is_told() {
    for (slave, master, multiplier, known) in [
        ("backend = \"iga\"\ndegree = 3", "backend = \"iga\"\ndegree = 3", "auto", Some(2)),
        ("backend = \"iga\"\ndegree = 3", "backend = \"iga\"\ndegree = 3", "p/p", None),
        ("backend = \"iga\"\ndegree = 2", "backend = \"fe\"\ndegree = 1", "p/p", None),
        ("backend = \"iga\"\ndegree = 2", "backend = \"iga\"\ndegree = 2", "dual", Some(1)),
        ("backend = \"fe\"\ndegree = 2", "backend = \"fe\"\ndegree = 2", "p/p", Some(2)),
        ("backend = \"fe\"\ndegree = 3", "backend = \"fe\"\ndegree = 1", "p/p", Some(1)),
        ("backend = \"fe\"\ncells = \"simplex\"\ndegree = 1", "backend = \"fe\"\ndegree = 1", "p/p", Some(1)),
    ] {
        let block = |name: &str, z: f64, n: usize, cells: &str| {
            format!(
                "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"box\", min = [0, 0, {z}], max = [1, 1, {}] }}\nelements = [{n}, {n}, 1]\n{cells}\n",
                z + 1.0
            )
        };
        let text = "[model]\nphysics = \"poisson\"\ndimension = 3\nexact = { u = \"sin(2*x)*cos(2*z)*cos(y)\" }\n[[material]]\nname = \"m\"\nconductivity = 1\n".to_owned()
            + &block("a", 0.0, 3, master)
            + &block("b", 1.0, 4, slave)
            + &format!(
                "[[boundary]]\non = \"all-outer\"\ndirichlet = \"exact\"\n[[interface]]\nname = \"seam\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\n\
                 multiplier = \"{multiplier}\"\nintegration = \"mixed\"\n"
            );
        let case = Case::parse("case.toml", &text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
        let result = case.run(&Registry::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
        let order = told(&result, "E065", MIXED).map(|w| w.message.clone());
        let wanted = known.map(|known| format!("errors of u may fall with order {known} only"));
        assert_eq!(order.is_some(), wanted.is_some(), "{slave} {master} {multiplier}: {order:?}");
        assert!(order.zip(wanted).is_none_or(|(order, wanted)| order.ends_with(&wanted)), "{slave} {master} {multiplier}");
    }
}

/// Where the slave's vertices lie on borders of the master's elements its functions are smooth inside of these.
#[test]
fn mixed_integration_on_nested_grids_is_not_told() {
    for (backend, degree) in [("iga", 2), ("iga", 3), ("fe", 2), ("fe", 3)] {
        for multiplier in ["p/p", "p/p-2", "dual", "constant"] {
            for grids in [[4, 4], [4, 8], [2, 6]] {
                let of = |rule: &str, refine: usize| seam_of(grids, backend, degree, multiplier, rule, refine);
                let coarse = of("mixed", 1);
                let warning = told(&coarse, "E065", MIXED);
                assert!(warning.is_none(), "{backend} {degree} {multiplier} {grids:?}: {warning:?}");
                let [mixed, merged] = ["mixed", "merged"].map(|rule| order(&|refine| of(rule, refine), "error.u.L2", 1));
                assert!(mixed > merged - 0.1, "{backend} {degree} {multiplier} {grids:?}: {mixed} {merged}");
            }
        }
    }
}

/// Blocks pressed together: the warning stands for contacts, too, at their own line.
#[test]
fn contacts_are_told_as_well() {
    let text = |degree: usize, choice: &str| {
        let block = |name: &str, low: f64, n: usize| {
            format!(
                "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"box\", min = [0, {low}], max = [1, {}] }}\nelements = [{n}, {n}]\n",
                low + 1.0
            )
        };
        format!(
            "[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\ndegree = {degree}\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n"
        ) + &block("a", 0.0, 3)
            + &block("b", 1.0, 4)
            + "[[boundary]]\non = \"a.bottom\"\nfix = [\"x\", \"y\"]\n[[boundary]]\non = [\"b.left\", \"b.right\"]\nfix = [\"x\"]\n\
               [[boundary]]\non = \"b.top\"\npressure = 0.01\n[[contact]]\nname = \"pad\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\n"
            + choice
    };
    let run = |degree: usize, choice: &str| {
        let case = Case::parse("case.toml", &text(degree, choice), &ReadOptions::default()).unwrap();
        case.run(&Registry::default()).unwrap_or_else(|e| panic!("{e}"))
    };
    assert!(told(&run(3, "multiplier = \"dual\"\n"), "E061", "\"dual\" of \"pad\" holds constants only on `b.bottom`").is_some());
    assert!(told(&run(2, "multiplier = \"dual\"\n"), "E061", DUAL).is_none());
    let mixed = run(2, "integration = \"mixed\"\n");
    assert!(told(&mixed, "E065", "mixed integration of \"pad\" with a multiplier of degree 0").is_some(), "{:?}", mixed.warnings);
    assert!(told(&run(2, "integration = \"mixed\"\nmultiplier = \"p/p\"\n"), "E065", "mixed integration of").is_none());
}

/// A cantilever with a force at its end.
fn cantilever(discretization: &str, (length, elements): (f64, [usize; 2]), material: &str, assumption: &str) -> RunResult {
    let text = format!(
        "[model]\nphysics = \"elasticity\"\ndimension = 2\nassumption = \"{assumption}\"\n[discretization]\n{discretization}\n[[material]]\nname = \"m\"\n\
         young = 1000\npoisson = {material}\n[[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [{length}, 1] }}\nelements = {elements:?}\n\
         [[boundary]]\non = \"b.left\"\nfix = [\"x\", \"y\"]\n[[boundary]]\non = \"b.right\"\nforce = {{ y = 1e-5 }}\n"
    );
    let case = Case::parse("case.toml", &text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    case.run(&Registry::default()).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// Energies of degree 1 over those of a fine mesh of degree 3; only such bodies are told.
#[test]
fn bodies_of_degree_1_that_lock_are_told() {
    const LOCK: &str = "is too stiff: its material resists changes of volume";
    let energy = |discretization: &str, n: usize, nu: &str| cantilever(discretization, (4.0, [8 * n, 2 * n]), nu, "plane-strain").energy;
    let right = energy("backend = \"iga\"\ndegree = 3", 4, "0.4999");
    let shares = [1, 8].map(|n| energy("backend = \"fe\"\ndegree = 1", n, "0.4999") / right);
    println!("{shares:?}");
    assert!((shares[0] - 0.064).abs() < 5e-4 && (shares[1] - 0.20).abs() < 5e-3, "{shares:?}");
    for backend in ["backend = \"iga\"", "backend = \"fe\"", "backend = \"fe\"\ncells = \"simplex\""] {
        for (degree, nu, assumption, is_told) in [
            (1, "0.4999", "plane-strain", true),
            (1, "0.49", "plane-strain", true),
            (1, "0.49", "axisymmetric", true),
            (1, "0.49", "plane-stress", false),
            (1, "0.45", "plane-strain", false),
            (2, "0.4999", "plane-strain", false),
        ] {
            let result = cantilever(&format!("{backend}\ndegree = {degree}"), (4.0, [4, 1]), nu, assumption);
            assert_eq!(told(&result, "E053", LOCK).is_some(), is_told, "{backend} {degree} {nu} {assumption}: {:?}", result.warnings);
        }
    }
    let solid = "[model]\nphysics = \"elasticity\"\ndimension = 3\n[discretization]\ndegree = 1\n[[material]]\nname = \"m\"\nyoung = 1000\npoisson = 0.495\n\
        [[patch]]\nname = \"b\"\ngeometry = { kind = \"box\", min = [0, 0, 0], max = [4, 1, 1] }\nelements = [4, 1, 1]\n[[boundary]]\non = \"b.left\"\nfix = [\"x\", \"y\", \"z\"]\n\
        [[boundary]]\non = \"b.right\"\nforce = { z = 1e-5 }\n";
    let result = Case::parse("case.toml", solid, &ReadOptions::default()).unwrap().run(&Registry::default()).unwrap();
    assert!(told(&result, "E053", LOCK).is_some(), "{:?}", result.warnings);
    // bending of a slender body, over beam theory: F l^3 / (3 E I), energy F u / 2
    let beam = 0.5 * 1e-10 * 1e6 / (3.0 * 1000.0 / 12.0);
    let slender =
        |degree: usize| cantilever(&format!("backend = \"fe\"\ndegree = {degree}"), (100.0, [20, 2]), "0", "plane-stress").energy / beam;
    assert!((slender(1) - 0.074).abs() < 5e-4 && (slender(2) - 0.9996).abs() < 1e-4, "{} {}", slender(1), slender(2));
}
