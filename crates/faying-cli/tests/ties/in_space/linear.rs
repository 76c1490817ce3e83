//! Linear fields across grids that do not match are exact.

use super::{KINDS, error, run, stacked};
use faying_cli::RunResult;
use faying_cli::result::Moment;

/// Largest error of u and of lambda.
const EXACT: f64 = 1e-9;

#[test]
fn all_pairs_of_cells_keep_linear_fields_with_mortar_and_nitsche() {
    for degree in [1, 2] {
        for (k, slave) in KINDS.iter().enumerate() {
            for (l, master) in KINDS.iter().enumerate() {
                // both physics and both couplings in turn
                let scalar = (k + l + degree) % 2 == 0;
                let coupling = if (k + degree) % 2 == 0 { "coupling = \"mortar\"" } else { "coupling = \"nitsche\"" };
                let result = run(&stacked(scalar, [master, slave], degree, coupling), &[]);
                for name in ["error.u.L2", "error.u.H1", "error.seam.lambda.L2"] {
                    let found = error(&result, name);
                    assert!(found < EXACT, "{name} {found:e}: {master} {slave} {degree} {coupling} {scalar}");
                }
            }
        }
    }
}

#[test]
fn mixed_integration_keeps_linear_fields() {
    for (k, kinds) in [[0, 2], [2, 3], [3, 0], [3, 3]].into_iter().enumerate() {
        let result = run(&stacked(k % 2 == 0, kinds.map(|kind| KINDS[kind]), 1 + k % 2, "integration = \"mixed\""), &[]);
        for name in ["error.u.L2", "error.u.H1", "error.seam.lambda.L2"] {
            let found = error(&result, name);
            assert!(found < EXACT, "{name} {found:e}: {kinds:?}");
        }
    }
}

#[test]
fn multipliers_by_name_and_by_data_hold_constant_tractions() {
    for (kind, degree, multiplier, functions) in [
        (0, 2, "\"p/p\"", None),
        (0, 3, "\"p/p-2\"", Some(3 * 3 * 4)),
        (2, 2, "\"p/p-2\"", Some(3 * 6)),
        (0, 2, "\"constant\"", Some(3 * 6)),
        (0, 3, "{ degree = 1, continuity = 0, ends = \"full\" }", Some(3 * 3 * 4)),
        (3, 3, "\"p/p-2\"", Some(3 * 3 * 4)),
        (3, 1, "\"p/p\"", None),
        (0, 2, "\"dual\"", None),
        (2, 2, "\"dual\"", None),
        (3, 1, "\"dual\"", None),
    ] {
        let result = run(&stacked(false, [KINDS[0], KINDS[kind]], degree, &format!("multiplier = {multiplier}")), &[]);
        let (u, lambda) = (error(&result, "error.u.L2"), error(&result, "error.seam.lambda.L2"));
        assert!(u < EXACT && lambda < EXACT, "{kind} {degree} {multiplier}: {u:e} {lambda:e}");
        let found = result.interface.get("seam").unwrap().multiplier.clone().unwrap();
        assert!(functions.is_none_or(|n| n == found.functions), "{kind} {degree} {multiplier}: {found:?}");
        assert_eq!(found.functions, result.unknowns.multipliers);
    }
}

/// A small box on a large one, its grid turned by `degrees` about z: a stretch along the interface without tractions across it. The upper box
/// is held by the tie alone.
fn turned(degrees: f64, kinds: [&str; 2], degree: usize, coupling: &str) -> String {
    let patch = |name: &str, kind: &str, shape: &str, n: &str| {
        format!("[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"box\", {shape} }}\nelements = {n}\ndegree = {degree}\n{kind}")
    };
    let upper = format!("min = [-0.5, -0.6, 0], max = [0.6, 0.5, 0.4], rotate_deg = {degrees}, axis = [0, 0, 1]");
    format!(
        "[let]\na = 0.4\nb = -0.15\nc = 0.25\nd = \"-0.3/0.7*(a + b)\"\n[model]\nphysics = \"elasticity\"\ndimension = 3\n\
         exact = {{ u = [\"a*x + (c + 0.1)*y - 0.2*z\", \"(c - 0.1)*x + b*y + 0.3*z\", \"0.2*x - 0.3*y + d*z\"] }}\n\
         [[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n{}{}\
         [[boundary]]\non = [\"lower.u0\", \"lower.u1\", \"lower.v0\", \"lower.v1\", \"lower.w0\"]\ndirichlet = \"exact\"\n\
         [[boundary]]\non = [\"upper.u0\", \"upper.u1\", \"upper.v0\", \"upper.v1\", \"upper.w1\"]\ntraction = \"exact\"\n\
         [[interface]]\nname = \"seam\"\nslave = \"upper.bottom\"\nmaster = \"lower.top\"\ncoupling = \"{coupling}\"\n",
        patch("lower", kinds[0], "min = [-1, -1, -0.5], max = [1, 1, 0]", "[4, 5, 1]"),
        patch("upper", kinds[1], &upper, "[3, 2, 1]"),
    )
}

#[test]
fn grids_turned_against_each_other_keep_linear_fields_with_every_coupling() {
    for (k, degrees) in [0.0, 17.0, 45.0].into_iter().enumerate() {
        for (l, coupling) in ["mortar", "nitsche", "penalty"].into_iter().enumerate() {
            let kinds = [KINDS[(k + l) % 4], KINDS[(k + 2 * l + 1) % 4]];
            let result = run(&turned(degrees, kinds, 1 + (k + l) % 2, coupling), &[]);
            let (u, lambda) = (error(&result, "error.u.L2"), error(&result, "error.seam.lambda.L2"));
            assert!(u < EXACT && lambda < EXACT, "{degrees} {coupling} {kinds:?}: {u:e} {lambda:e}");
            let seam = result.interface.get("seam").unwrap();
            assert!((seam.segments.measure - 1.21).abs() < 1e-12 && (seam.share - 1.0).abs() < 1e-12, "{seam:?}");
        }
    }
}

/// Products of functions of cells that are turned, or of different shapes, have a higher total degree than each.
#[test]
fn regions_of_turned_cells_are_integrated_exactly() {
    for kinds in [[KINDS[0]; 2], [KINDS[2], KINDS[3]], [KINDS[3], KINDS[2]], [KINDS[3]; 2]] {
        for degree in [1, 2, 3].into_iter().filter(|p| *p < 3 || !kinds.contains(&KINDS[3])) {
            for words in ["mortar", "mortar\"\nmultiplier = \"p/p", "nitsche"] {
                let text = turned(17.0, kinds, degree, words).replace("\"a*x + (c + 0.1)*y", "\"a*x + 0.2*y*z + (c + 0.1)*y");
                let found = run(&text, &[]).interface.get("seam").unwrap().consistency;
                assert!(found < 1e-12, "{kinds:?} {degree} {words}: {found:e}");
            }
        }
    }
}

/// With tractions across the interface a penalty lets the bodies part by lambda over its stiffness, which is the factor's inverse.
#[test]
fn the_gap_of_a_penalty_falls_with_its_factor() {
    let jump = |factor: &str| {
        let result = run(&stacked(false, [KINDS[2], KINDS[0]], 2, &format!("coupling = \"penalty\"\nfactor = {factor}")), &[]);
        result.interface.get("seam").unwrap().jump.l2
    };
    let (first, second) = (jump("1e4"), jump("1e5"));
    assert!(first > 1e-6 && (first / second - 10.0).abs() < 0.05, "{first:e} {second:e}");
}

#[test]
fn forces_and_moments_balance_and_unknowns_meet() {
    for kinds in [[KINDS[0], KINDS[2]], [KINDS[3], KINDS[1]]] {
        for coupling in ["mortar", "nitsche", "penalty"] {
            let text = stacked(false, kinds, 2, &format!("coupling = \"{coupling}\""))
                .replace("[\"0.3*x - 0.2*y + 0.5*z\"", "[\"0.3*x*z - 0.2*y^2 + 0.5*z\"");
            let result = run(&text, &[]);
            let scale = result.reactions.iter().flat_map(|(_, r)| r).fold(0.0_f64, |m, v| m.max(v.abs()));
            let Moment::Space(moment) = result.balance.moment.clone().unwrap() else { panic!("three numbers") };
            assert!(result.balance.force.iter().chain(&moment).all(|v| v.abs() < 1e-12 * scale), "{coupling}: {:?}", result.balance);
            let seam = result.interface.get("seam").unwrap();
            assert!(seam.balance < 1e-12, "{coupling}: {}", seam.balance);
            assert!(seam.lambda.norm > 0.1 && seam.distance < 1e-14, "{coupling}: {seam:?}");
        }
    }
}

/// The slave's own points do not see the kinks of the master's functions: every coupling tells by how much, and merged integration has no
/// such error.
#[test]
fn slave_points_that_spoil_linear_fields_are_told_with_every_coupling() {
    for coupling in ["mortar", "nitsche", "penalty"] {
        for degree in [1, 2] {
            let [own, merged] = ["slave", "merged"].map(|rule| {
                let words = format!("coupling = \"{coupling}\"\nintegration = \"{rule}\"");
                run(&stacked(false, [KINDS[0]; 2], degree, &words), &[])
            });
            let off = error(&own, "error.seam.lambda.L2.rel").max(error(&own, "error.u.H1.rel"));
            let told = |result: &RunResult| result.warnings.iter().any(|w| w.code == "E065" && w.message.contains("inexact"));
            let found = own.interface.get("seam").unwrap().consistency;
            assert!(off > 5e-3 && told(&own), "{coupling} {degree}: {off:e} {:?}", own.warnings);
            assert!(found > 0.3 * off && found < 10.0 * off, "{coupling} {degree}: {found:e} of {off:e}");
            let found = merged.interface.get("seam").unwrap().consistency;
            assert!(found < 1e-11 && merged.warnings.is_empty(), "{coupling} {degree}: {found:e} {:?}", merged.warnings);
        }
    }
}

/// Where a tie carries nothing its forces are rounding, and no error is a share of them.
#[test]
fn a_tie_without_traction_has_no_doubt() {
    // sigma . n = 0 on the interface, between turned grids
    let exact = "[\"0.3*x + 0.1*y - 0.05*z\", \"0.04*x - 0.2*y + 0.02*z\", \"0.05*x - 0.02*y - 0.042857142857142864*z\"]";
    let patch = |name: &str, geometry: &str, elements: &str| {
        format!("[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"box\", {geometry} }}\nelements = {elements}\n")
    };
    for keys in ["coupling = \"nitsche\"", "integration = \"slave\"", "integration = \"mixed\"\nmultiplier = \"p/p\""] {
        let text = format!("[model]\nphysics = \"elasticity\"\ndimension = 3\nexact = {{ u = {exact} }}\n")
            + "[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n"
            + &patch("lower", "min = [-1.1, -1.2, -1.0], max = [1.2, 1.3, 0.0]", "[2, 3, 1]")
            + &patch("upper", "min = [-0.6, -0.5, 0.0], max = [0.55, 0.6, 0.8], rotate_deg = 45, axis = [0, 0, 1]", "[3, 2, 1]")
            + "[[boundary]]\non = \"lower.bottom\"\ndirichlet = \"exact\"\n[[boundary]]\non = \"all-outer\"\nneumann = \"exact\"\n"
            + &format!("[[interface]]\nname = \"s\"\nslave = \"upper.bottom\"\nmaster = \"lower.top\"\n{keys}\n");
        let result = run(&text, &[]);
        assert!(result.interface["s"].consistency < 1e-2 && error(&result, "error.u.H1") < 1e-10, "{keys}: {:?}", result.interface["s"]);
        assert!(!result.warnings.iter().any(|w| w.code == "E065"), "{keys}: {:?}", result.warnings);
    }
}

/// Products of squares have the total degree 4, which triangles of degree 2 and 3 do not hold: facets lie off the surface, and it is no error.
#[test]
fn tetrahedra_off_a_polynomial_surface_are_tied_across_their_gap() {
    let net = |bottom: bool| {
        let seam = |i: usize, j: usize| [0.0, 0.1, 0.0][i] + [0.0, 0.1, 0.0][j] + if i == 1 && j == 1 { 0.1 } else { 0.0 };
        let point = |k: usize| {
            let (i, j, up) = (k % 3, k / 3 % 3, k / 9 == 1);
            let z = if up == bottom {
                seam(i, j)
            } else if bottom {
                -1.0
            } else {
                1.0
            };
            format!("[{}, {}, {z}]", 0.5 * i as f64, 0.5 * j as f64)
        };
        let points: Vec<String> = (0..18).map(point).collect();
        format!("kind = \"nurbs\", degree = [2, 2, 1], knots = [[0,0,0,1,1,1], [0,0,0,1,1,1], [0,0,1,1]], points = [{}]", points.join(", "))
    };
    for degree in [2, 3, 4] {
        let text = format!(
            "[model]\nphysics = \"poisson\"\ndimension = 3\n[discretization]\ndegree = {degree}\n[[material]]\nname = \"m\"\n\
             [[patch]]\nname = \"A\"\ngeometry = {{ {} }}\nelements = [4, 4, 1]\n\
             [[patch]]\nname = \"B\"\ngeometry = {{ {} }}\nelements = [4, 4, 1]\nbackend = \"fe\"\ncells = \"simplex\"\n\
             [[boundary]]\non = \"A.w0\"\ndirichlet = 0\n[[boundary]]\non = \"B.w1\"\nneumann = 1\n\
             [[interface]]\nname = \"s\"\nslave = \"A.w1\"\nmaster = \"B.w0\"\n",
            net(true),
            net(false)
        );
        let tie = &run(&text, &[]).interface["s"];
        assert!((tie.distance < 1e-12) == (degree == 4) && tie.distance < 1e-3, "{degree}: {}", tie.distance);
        assert!((tie.share - 1.0).abs() < 1e-9, "{degree}: {tie:?}");
    }
}
