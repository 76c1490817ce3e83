//! Sums of the stresses over straight cuts, against closed forms and statics.

use faying_cli::case::ReadOptions;
use faying_cli::errors::Diagnostics;
use faying_cli::{Case, Registry, RunResult, Status};

fn try_run(text: &str, quantities: &[&str]) -> Result<RunResult, Diagnostics> {
    let probes = quantities.iter().enumerate().map(|(k, q)| format!("[[probe]]\nname = \"p{k}\"\nquantity = \"{q}\"\n"));
    Case::parse("case.toml", &(text.to_owned() + &probes.collect::<String>()), &ReadOptions::default())?.run(&Registry::default())
}

/// Values of quantities of a case.
fn values(text: &str, quantities: &[&str]) -> Vec<f64> {
    let result = try_run(text, quantities).unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert_eq!(result.status, Status::Ok, "{:?}\n{text}", result.diagnostics);
    result.probes.iter().map(|p| p.value).collect()
}

fn near(found: &[f64], expected: &[f64], within: f64) {
    assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= within), "{found:?} {expected:?}");
}

/// A beam of modulus 12 in pure bending, stress.xx = 12 y on -1/2 < y < 1/2: the moment 1, and no force, on every cut through its height. Two
/// tied halves whose elements do not match.
fn bent(backend: &str) -> String {
    let half = |name: &str, x: [f64; 2], elements: [usize; 2]| {
        format!(
            "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"box\", min = [{}, -0.5], max = [{}, 0.5] }}\nelements = {elements:?}\n",
            x[0], x[1]
        )
    };
    format!(
        "[model]\nphysics = \"elasticity\"\ndimension = 2\nassumption = \"plane-stress\"\nexact = {{ u = [\"x*y\", \"-x^2/2\"] }}\n\
         [discretization]\nbackend = \"{backend}\"\ndegree = 2\n[[material]]\nname = \"m\"\nyoung = 12\npoisson = 0\n"
    ) + &half("a", [0.0, 1.0], [3, 4])
        + &half("b", [1.0, 2.0], [2, 3])
        + "[[boundary]]\non = \"all-outer\"\ndirichlet = \"exact\"\n[[interface]]\nname = \"i\"\nslave = \"a.right\"\nmaster = \"b.left\"\nmultiplier = \"p/p\"\n"
}

#[test]
fn a_moment_goes_through_every_cut_of_a_bent_beam() {
    for backend in ["iga", "fe"] {
        // upright, askew through both halves, beyond the body, and from above: n turns round; from the middle down it is half of the beam
        let found = values(
            &bent(backend),
            &[
                "moment cut [0.3, -0.5] to [0.3, 0.5]",
                "force.x cut [0.3, -0.5] to [0.3, 0.5]",
                "moment cut [0.2, -0.5] to [1.9, 0.5]",
                "force.x cut [0.2, -0.5] to [1.9, 0.5]",
                "force.y cut [0.2, -0.5] to [1.9, 0.5]",
                "moment cut [1.5, -2] to [1.5, 3]",
                "moment cut [0.3, 0.5] to [0.3, -0.5]",
                "force.x cut [0.7, 0] to [0.7, 0.5]",
                "force.x cut [0.2, 0.5] to [1.9, 0] in a",
            ],
        );
        // M = ∫ x σ_yn - y σ_xn = -1 for n = x; half of the height carries 12 / 8; the cut from (0.2, 0.5) to (1, y1), y1 = 0.5 - 0.8/3.4, has n = (-dy, -dx)
        let low = 0.5 - 0.8 / 3.4;
        let in_a = -(6.0 * (0.25 - low * low));
        near(&found, &[-1.0, 0.0, -1.0, 0.0, 0.0, -1.0, 1.0, 1.5, in_a], 1e-10);
    }
}

/// A quarter of a ring of radii 1 and 2 under the pressure 1 in its bore: on every radius the hoop stress sums up to 1, pressure times radius of
/// the bore; the cut begins and ends outside.
#[test]
fn the_hoop_stress_of_a_ring_carries_its_pressure() {
    for kind in ["backend = \"iga\"", "backend = \"fe\"", "backend = \"fe\"\nmapping = \"exact\"\ncells = \"simplex\""] {
        let text = format!(
            "[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\ndegree = 3\n{kind}\n[[material]]\nname = \"m\"\nyoung = 100\npoisson = 0.3\n\
             [[patch]]\nname = \"a\"\ngeometry = {{ kind = \"annulus-sector\", radius = [1, 2], angle_deg = [0, 90] }}\nelements = [7, 6]\n\
             [[boundary]]\non = \"a.u0\"\nfix = [\"y\"]\n[[boundary]]\non = \"a.u1\"\nfix = [\"x\"]\n[[boundary]]\non = \"a.v0\"\npressure = 1\n"
        );
        let end = |r: f64| format!("[{}, {}]", 0.6 * r, 0.8 * r);
        let cut = format!("cut {} to {}", end(0.5), end(3.0));
        // n is against the angle: the force is -(-0.8, 0.6), its moment about the middle of the ring -∫ r sigma_tt dr = -(A 3/2 + B ln 2)
        let found = values(&text, &[&format!("force.x {cut}"), &format!("force.y {cut}"), &format!("moment {cut}")]);
        near(&found, &[0.8, -0.6, -(0.5 + 4.0 / 3.0 * 2f64.ln())], 1e-3);
    }
}

/// A cantilever under its own weight: cuts carry what lies beyond them, up to what the mesh has of it.
#[test]
fn a_cut_carries_what_lies_beyond_it() {
    let text = |n: usize| {
        format!(
            "[model]\nphysics = \"elasticity\"\ndimension = 2\nbody_force = [\"0\", \"-1\"]\n[discretization]\ndegree = 3\n[[material]]\nname = \"m\"\nyoung = 1e5\npoisson = 0.3\n\
             [[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [4, 1] }}\nelements = [{}, {n}]\n\
             [[boundary]]\non = \"a.left\"\nfix = [\"x\", \"y\"]\n",
            4 * n
        )
    };
    let asked = ["force.x cut [1.3, 0] to [1.3, 1]", "force.y cut [1.3, 0] to [1.3, 1]", "moment cut [1.3, 0] to [1.3, 1]"];
    // the part to the right weighs 2.7 with its middle at 2.65: it pulls down by that, and so does it to the left
    let exact = [0.0, -2.7, -2.7 * 2.65];
    let [coarse, fine] = [2, 4].map(|n| values(&text(n), &asked));
    let off = |found: &[f64]| found.iter().zip(exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off(&fine) < 0.02 && off(&fine) < 0.5 * off(&coarse), "{coarse:?} {fine:?}");
}

#[test]
fn the_flux_through_a_cut_is_that_of_the_gradient() {
    let text = "[model]\nphysics = \"poisson\"\ndimension = 2\nexact = { u = \"x^2 - y^2\" }\n[[material]]\nname = \"m\"\nconductivity = 2\n\
        [[patch]]\nname = \"a\"\ngeometry = { kind = \"box\", min = [0, 0], max = [1, 1] }\nelements = [3, 2]\n[[boundary]]\non = \"all-outer\"\ndirichlet = \"exact\"\n";
    // k du/dx = 4 x along x = 1/4; k grad u . n = 4 (x, -y) . (1, 1) / sqrt(2) = 0 along y = x, whose right side is (1, -1): 4 (x + y)
    let found = values(text, &["flux cut [0.25, 0] to [0.25, 1]", "flux cut [0, 0] to [1, 1]"]);
    near(&found, &[1.0, 4.0], 1e-11);
}

/// Along edges of elements, where stresses jump, a cut is the mean of those to its left and right; along a side of the body it is that inside.
#[test]
fn a_cut_along_edges_is_the_mean_of_both_sides() {
    let text = "[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\nbackend = \"fe\"\ncells = \"simplex\"\ndegree = 1\n[[material]]\nname = \"m\"\n\
        young = 1000\npoisson = 0.3\n[[patch]]\nname = \"a\"\ngeometry = { kind = \"box\", min = [0, 0], max = [4, 1] }\nelements = [8, 2]\n\
        [[boundary]]\non = \"a.left\"\nfix = [\"x\", \"y\"]\n[[boundary]]\non = \"a.right\"\ntraction = { y = -1 }\n";
    let cuts = [[2.0, 2.0], [1.999999, 1.999999], [2.000001, 2.000001], [4.0, 4.0], [3.999999, 3.999999]];
    let mut quantities: Vec<String> = cuts.iter().map(|[a, b]| format!("force.y cut [{a}, 0] to [{b}, 1]")).collect();
    quantities.push("force.y cut [2, 1] to [2, 0]".to_owned());
    quantities.push("force.y cut [2, -1] to [2, 7]".to_owned());
    let found = values(text, &quantities.iter().map(String::as_str).collect::<Vec<_>>());
    let [edge, left, right, end, inside, back, long] = found[..] else { panic!("{found:?}") };
    assert!((left - right).abs() > 1e-2 * edge.abs(), "{found:?}");
    near(&[edge, -back, long, end], &[0.5 * (left + right), edge, edge, inside], 1e-4 * edge.abs());
}

/// Ends far beyond the body change nothing, and cuts stand in the formulas of checks.
#[test]
fn a_cut_may_be_long_and_stand_in_a_check() {
    let plane = bent("fe");
    let far = |r: &str| [format!("moment cut [0.3, -{r}] to [0.3, {r}]"), format!("force.x cut [-{r}, 0.25] to [{r}, 0.25]")];
    let cuts: Vec<String> = ["2", "1e3", "1e9", "1e300"].iter().flat_map(|r| far(r)).collect();
    let found = values(&plane, &cuts.iter().map(String::as_str).collect::<Vec<_>>());
    for pair in found.chunks(2) {
        near(pair, &[-1.0, 0.0], 1e-10);
    }
    near(&values(&plane, &["moment cut [-1e8, -1e8] to [1e8, 1e8]"]), &values(&plane, &["moment cut [-1, -1] to [1, 1]"]), 1e-7);
    let check = "[[check]]\nquantity = \"moment cut [0.3, -0.5] to [0.3, 0.5]\"\nequals = \"-(moment cut [1.5, 0.5] to [1.5, -0.5] in b)\"\natol = 1e-9\n";
    let result =
        Case::parse("case.toml", &(plane + check), &ReadOptions::default()).and_then(|case| case.run(&Registry::default())).unwrap();
    let check = &result.checks[0];
    assert!(check.ok && (check.expected + 1.0).abs() < 1e-10, "{check:?}");
}

#[test]
fn cuts_that_are_none_are_refused() {
    let refused = |text: &str, quantity: &str| {
        let error = try_run(text, &[quantity]).unwrap_err();
        (error.items[0].code.to_owned(), error.items[0].message.clone())
    };
    let plane = bent("iga");
    let solid = "[model]\nphysics = \"elasticity\"\ndimension = 3\n[[material]]\nname = \"m\"\nyoung = 1\npoisson = 0.3\n[[patch]]\nname = \"a\"\n\
        geometry = { kind = \"box\", min = [0, 0, 0], max = [1, 1, 1] }\nelements = [1, 1, 1]\n[[boundary]]\non = \"a.left\"\nfix = [\"x\", \"y\", \"z\"]\n";
    for (text, quantity, code, part) in [
        (&*plane, "force.x cut [0, 0]", "E018", "a cut has two ends"),
        (&*plane, "moment cut [0, 0] to [0, 1] about [1, 1]", "E018", "takes no `about`"),
        (&*plane, "force.x at [1, 0] cut [0, 0] to [0, 1]", "E018", "takes no `at`"),
        (&*plane, "stress.xx cut [0, 0] to [0, 1]", "E018", "`stress.xx` is no sum over a cut"),
        (&*plane, "force.z cut [0, 0] to [0, 1]", "E018", "not there in the plane"),
        (&*plane, "flux cut [0, 0] to [0, 1]", "E018", "the flux belongs to Poisson"),
        (&*plane, "moment cut [1, 0] to [1, 0]", "E015", "no length"),
        (&*plane, "moment cut [5, 0] to [5, 1]", "E022", "no point of the cut"),
        (&*plane, "moment cut [1, 0] to [1, 1] in c", "E021", "patches are a, b"),
        (solid, "force.x cut [0, 0, 0] to [0, 1, 0]", "E019", "plane models"),
    ] {
        let (found, message) = refused(text, quantity);
        assert!(found == code && message.contains(part), "{quantity}: {found} {message}");
    }
}
