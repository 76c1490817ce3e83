//! Published and manufactured problems of contact with every multiplier and backend they apply to.
//!
//! The cases as written are under reference/contact-*: tests/reference.rs holds them to their numbers. Here are the variants.

use crate::common::pressed;
use faying_cli::RunResult;
use pressed::{contact, run};

const RINGS: &str = include_str!("../../../../reference/contact-rings/case.toml");
const HALF_DISC: &str = include_str!("../../../../reference/contact-half-disc/case.toml");
const NAFEMS: &str = include_str!("../../../../examples/cases/cylinder-on-block.toml");
const MANUFACTURED: &str = include_str!("../../../../reference/contact-manufactured/case.toml");
const HERTZ: &str = include_str!("../../../../examples/cases/hertz.toml");

const BACKENDS: [&str; 2] = ["discretization.backend=iga", "discretization.backend=fe"];

fn error(result: &RunResult, name: &str) -> f64 {
    *result.errors.get(name).unwrap_or_else(|| panic!("no {name}"))
}

/// log2 of the ratios of neighbours.
fn rates(errors: &[f64]) -> Vec<f64> {
    errors.windows(2).map(|w| (w[0] / w[1]).log2()).collect()
}

/// Data of a case without the checks of its reference.
fn without_checks(text: &str) -> String {
    text.split("[[check]]").next().unwrap().to_owned()
}

// code_aster SSNP167. p/p-2 has a linear pressure on 48 elements: its best approximation is 1.7e-6.
#[test]
fn concentric_rings_have_the_pressure_of_michell_to_what_their_multiplier_can() {
    for backend in BACKENDS {
        for (multiplier, most) in [("p/p", 1e-6), ("p/p-2", 5e-6)] {
            let set = format!("contact.fit.multiplier={multiplier}");
            let r = run(&without_checks(RINGS), &[backend, &set], 2.0);
            let e = error(&r, "error.fit.lambda.L2.rel");
            println!("{backend} {multiplier}: {e:e}, {} unknowns", r.unknowns.primal + r.unknowns.multipliers);
            assert!(e <= most, "{backend} {multiplier}: {e:e}");
            assert_eq!(contact(&r, "fit").active, r.unknowns.multipliers, "all of it is closed");
        }
    }
}

// MOOSE, small strain: 717.2 with the cut clamped sideways, 690.3 with the cut free; halves here.
#[test]
fn a_half_disc_takes_the_force_that_is_known_and_the_pressure_of_hertz() {
    for backend in BACKENDS {
        for (top, force) in [("{ x = \"0\", y = \"-0.002\" }", 358.6), ("{ y = \"-0.002\" }", 345.15)] {
            let sets = [backend, &format!("boundary.top.dirichlet={top}"), &format!("check.force.equals={force}")];
            let r = run(HALF_DISC, &sets, 3.0);
            println!("{backend} {top}: {:?}", r.checks.iter().map(|c| c.value / c.expected - 1.0).collect::<Vec<_>>());
        }
    }
}

#[test]
fn a_steel_cylinder_on_an_aluminium_block_meets_nafems_with_p_p_too() {
    for backend in BACKENDS {
        let r = run(NAFEMS, &[backend, "contact.line.multiplier=p/p"], 200.0);
        println!("{backend}: {:?}", r.checks.iter().map(|c| c.value / c.expected - 1.0).collect::<Vec<_>>());
        assert!(r.balance.force.iter().all(|f| f.abs() < 1e-6 * 35e3), "{:?}", r.balance);
    }
}

// One half of two equal cylinders is one cylinder on a plane that stays plane: F on R/2 and twice the compliance.
#[test]
fn two_equal_cylinders_press_each_other_as_one_does_a_rigid_plane() {
    let (cylinder, rest) = HERTZ.split_once("[[patch]]").map(|(head, rest)| (head.to_owned(), format!("[[patch]]{rest}"))).unwrap();
    let small = rest.replace("elements = [64, 40]", "elements = [48, 24]");
    let other = "[[patch]]\nname = \"other\"\ngeometry = { kind = \"annulus-sector\", center = [0.0, \"-R\"], radius = [\"0.1*R\", \"R\"], angle_deg = [0.0, 90.0] }\n\
                 elements = [48, 24]\ngrade = { toward = { u = 1.0, v = 1.0 }, ratio = 0.02 }\n\
                 [[boundary]]\non = \"other.u1\"\nfix = [\"x\"]\n[[boundary]]\non = \"other.u0\"\nfix = [\"y\"]\n";
    for backend in BACKENDS {
        let alone = run(&format!("{cylinder}{small}"), &[backend], 1.0);
        let both = small.replace("rigid = { kind = \"half-plane\", point = [0.0, 0.0], normal = [0.0, 1.0] }", "master = \"other.v1\"");
        let both = run(&format!("{cylinder}{other}{both}"), &[backend], 1.0);
        let (a, b) = (contact(&alone, "plane"), contact(&both, "plane"));
        println!("{backend}: {a:?}\n{b:?}");
        // the checks of hertz.toml hold for both; between the two there are only the arcs' slopes, a/R = 0.015
        assert!((a.pressure.max / b.pressure.max - 1.0).abs() < 1e-3, "{} {}", a.pressure.max, b.pressure.max);
        assert_eq!(a.active, b.active);
        assert!((a.area / b.area - 1.0).abs() < 1e-9, "{} {}", a.area, b.area);
        assert!((a.force[1] / b.force[1] - 1.0).abs() < 1e-9);
    }
}

// After code_aster SSNP150. Rates: [u, pressure]; a linear multiplier that jumps between Lagrange elements costs u half an order.
#[test]
fn a_manufactured_contact_is_exact_where_it_can_be_and_has_its_rates_elsewhere() {
    for (backend, half) in BACKENDS.into_iter().zip([0.0, 0.5]) {
        for n in [1, 2, 5] {
            let sets = [backend, &format!("patch.square.elements=[{n}, {}]", n + 1)];
            let r = run(&without_checks(MANUFACTURED), &sets, 1.0);
            for name in ["error.u.L2.rel", "error.u.H1.rel", "error.pad.lambda.L2.rel"] {
                assert!(error(&r, name) < 1e-12, "{backend} {n}: {name} {:e}", error(&r, name));
            }
        }
        for (degree, multiplier, expected) in [(2, "p/p", [3.0, 2.6]), (3, "p/p-2", [4.0 - half, 2.0])] {
            let runs: Vec<RunResult> = (1..=3)
                .map(|level| {
                    let sets = [
                        backend,
                        &format!("discretization.degree={degree}"),
                        &format!("contact.pad.multiplier={multiplier}"),
                        &format!("patch.square.refine={level}"),
                    ];
                    run(&without_checks(MANUFACTURED), &sets, 1.0)
                })
                .collect();
            for (name, expected) in ["error.u.L2", "error.pad.lambda.L2"].into_iter().zip(expected) {
                let found = rates(&runs.iter().map(|r| error(r, name)).collect::<Vec<_>>());
                println!("{backend} {degree} {multiplier} {name}: {found:?}");
                assert!(
                    found.iter().all(|&r| r >= expected - 0.1),
                    "{backend} {degree} {multiplier} {name}: {found:?}, expected {expected}"
                );
            }
        }
    }
}

/// Rings under the same pressure inside and outside: sigma = -p I, u = -k x.
fn hydrostatic(slave: &str, master: &str) -> String {
    format!(
        "[let]\np = 0.01\nk = \"p*(1 + 0.3)*(1 - 2*0.3)\"\n\
         [model]\nphysics = \"elasticity\"\ndimension = 2\nexact = {{ u = [\"-k*x\", \"-k*y\"] }}\n\
         [[material]]\nname = \"m\"\nyoung = 1\npoisson = 0.3\n\
         [[patch]]\nname = \"inner\"\ngeometry = {{ kind = \"annulus-sector\", center = [0, 0], radius = [1, 1.5], angle_deg = [0, 90] }}\n\
         elements = [5, 2]\n\
         [[patch]]\nname = \"outer\"\ngeometry = {{ kind = \"annulus-sector\", center = [0, 0], radius = [1.5, 2], angle_deg = [0, 90] }}\n\
         elements = [4, 3]\n\
         [[boundary]]\non = [\"inner.u0\", \"outer.u0\"]\nfix = [\"y\"]\n[[boundary]]\non = [\"inner.u1\", \"outer.u1\"]\nfix = [\"x\"]\n\
         [[boundary]]\non = [\"outer.v1\", \"inner.v0\"]\npressure = \"p\"\n\
         [[contact]]\nname = \"arc\"\nslave = \"{slave}\"\nmaster = \"{master}\"\n"
    )
}

const ROLES: [[&str; 2]; 2] = [["outer.v0", "inner.v1"], ["inner.v1", "outer.v0"]];

#[test]
fn a_hydrostatic_state_passes_an_arc_up_to_quadrature() {
    for [slave, master] in ROLES {
        for multiplier in ["p/p", "p/p-2", "dual"] {
            // points beyond p + 1
            for (extra, most) in [(1, 1e-7), (3, 1e-11)] {
                let sets = [
                    "discretization.degree=2",
                    &format!("discretization.extra_points={extra}"),
                    &format!("contact.arc.extra_points={extra}"),
                    &format!("contact.arc.multiplier={multiplier}"),
                ];
                let r = run(&hydrostatic(slave, master), &sets, 2.0);
                for name in ["error.u.L2.rel", "error.arc.lambda.L2.rel"] {
                    println!("{slave} {multiplier} {extra}: {name} {:e}", error(&r, name));
                    assert!(error(&r, name) <= most, "{slave} {multiplier} {extra}: {name} {:e}", error(&r, name));
                }
            }
        }
    }
}

// Isoparametric arcs do not fit each other: gaps of order h^(p+1), normals of order h^p.
#[test]
fn a_hydrostatic_state_across_polynomial_arcs_improves_with_order_p() {
    for [slave, master] in ROLES {
        for cells in ["tensor", "simplex"] {
            for degree in 1..=3 {
                let runs: Vec<RunResult> = (1..=3)
                    .map(|level| {
                        let sets = [
                            "discretization.backend=fe",
                            &format!("discretization.cells={cells}"),
                            &format!("discretization.degree={degree}"),
                            "contact.arc.multiplier=p/p",
                            &format!("patch.inner.refine={level}"),
                            &format!("patch.outer.refine={level}"),
                        ];
                        run(&hydrostatic(slave, master), &sets, 2.0)
                    })
                    .collect();
                for name in ["error.u.L2", "error.u.H1"] {
                    let found = rates(&runs.iter().map(|r| error(r, name)).collect::<Vec<_>>());
                    println!("{slave} {cells} {degree} {name}: {found:?}");
                    assert!(found.iter().all(|&r| r >= f64::from(degree) - 0.1), "{slave} {cells} {degree} {name}: {found:?}");
                }
            }
        }
    }
}
