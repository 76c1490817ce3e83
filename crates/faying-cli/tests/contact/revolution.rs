//! Contact of bodies of revolution: two spheres (code_aster SSNV104), and pressures on the axis itself.

use faying_cli::case::ReadOptions;
use faying_cli::{Case, Registry, RunResult, Status};
use std::f64::consts::PI;

const MODEL: &str = "[model]\nphysics = \"elasticity\"\ndimension = 2\nassumption = \"axisymmetric\"\n\
    [[material]]\nname = \"m\"\nyoung = 20000.0\npoisson = 0.3\n";

fn run(text: &str) -> RunResult {
    let case = Case::parse("case.toml", text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let result = case.run(&Registry::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert!(matches!(result.status, Status::Ok), "{:?}\n{text}", result.diagnostics);
    result
}

fn probe(result: &RunResult, name: &str) -> f64 {
    result.probes.iter().find(|p| p.name == name).unwrap().value
}

const RADIUS: f64 = 50.0;

/// A mesh of a half sphere of radius 50: backend, degree, elements per direction, and its size at the pole over the uniform one.
type Mesh = (&'static str, usize, usize, f64);

/// Half spheres that touch in the origin; the plane y = 50 of the upper one moves down by `d`, that of the lower one up. With one sphere it
/// is pressed on a rigid plane, which is the same by symmetry.
fn spheres(two: bool, (backend, degree, n, ratio): Mesh, d: f64, contact: &str) -> RunResult {
    let half = |name: &str, y: f64, angles: &str, pole: f64, flat: &str, by: f64| {
        format!(
            "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"disc-sector\", center = [0, {y:?}], radius = {RADIUS:?}, angle_deg = [{angles}] }}\n\
             elements = [{n}, {n}]\ngrade = {{ toward = {{ u = {pole:?}, v = 1.0 }}, ratio = {ratio:?} }}\nbackend = \"{backend}\"\ndegree = {degree}\n\
             [[boundary]]\non = \"{name}.{flat}\"\ndirichlet = {{ y = {by:?} }}\n"
        )
    };
    let upper = half("upper", RADIUS, "-90, 0", 0.0, "u1", -d);
    let (lower, opponent) = if two {
        (half("lower", -RADIUS, "0, 90", 1.0, "u0", d), "master = \"lower.v1\"")
    } else {
        (String::new(), "rigid = { kind = \"half-plane\", point = [0, 0], normal = [0, 1] }")
    };
    let probes = [("F", "contact.c.force.y"), ("p0", "contact.c.pressure at [0, 0]"), ("s", "stress.yy at [0, 0] in upper")];
    let probes: String = probes.iter().map(|(name, q)| format!("[[probe]]\nname = \"{name}\"\nquantity = \"{q}\"\n")).collect();
    run(&format!("{MODEL}{upper}{lower}[[contact]]\nname = \"c\"\nslave = \"upper.v1\"\n{opponent}\n{contact}\n{probes}"))
}

/// Hertz' pressure in the centre for the force F of two equal spheres of radius R, or of one on a rigid plane, whose E*/R it is:
/// p0³ = 6 F E*² / (pi³ R²). Johnson, Contact Mechanics (1985), ch. 4.
fn hertz(force: f64) -> f64 {
    let modulus = 20000.0 / (1.0 - 0.09);
    (6.0 * force * f64::powi(modulus, 2) / (PI.powi(3) * RADIUS * RADIUS)).cbrt()
}

/// SSNV104: Hertz' approach of half spaces, 2 mm each, gives 2798.3 = 2 E* a / (pi R), a² = R d. Half spheres that end at 50 mm are stiffer. An
/// independent program (bilinear elements, contact at nodes, 20, 40 and 80 elements in the zone) has
///
/// - on a rigid plane the force 659 800 and the pressure 2910.5, which is Hertz' pressure for this force;
/// - between two spheres, with gaps along the normals of the undeformed master, 641 200 and 2974.5, 3.1 % above Hertz for this force. With
///   vertical gaps it has the numbers of the plane: the normals, which stand up to a/R = 0.2 off the axis where the deformed zone is
///   flat, are what small kinematics changes, by (a/R)².
#[test]
fn half_spheres_have_the_force_and_the_pressure_of_an_independent_program() {
    let fine: [Mesh; 4] = [("iga", 2, 64, 0.05), ("fe", 2, 64, 0.05), ("iga", 3, 32, 0.05), ("fe", 3, 32, 0.05)];
    for (mesh, two) in fine.into_iter().flat_map(|mesh| [(mesh, false), (mesh, true)]) {
        let result = spheres(two, mesh, 2.0, "");
        let [force, p0, stress] = ["F", "p0", "s"].map(|name| probe(&result, name));
        println!("{mesh:?} two {two}: F {force:.1} p0 {p0:.2} stress {stress:.2} Hertz {:.2}", hertz(force));
        let (wanted_force, wanted, above) = if two { (641_200.0, 2974.5, 1.031) } else { (659_800.0, 2910.5, 1.0) };
        assert!((force / wanted_force - 1.0).abs() < 2e-3, "{force}");
        assert!((p0 / wanted - 1.0).abs() < 1e-3 && (-stress / p0 - 1.0).abs() < 1e-3, "{p0} {stress}");
        assert!((p0 / hertz(force) - above).abs() < 2e-3, "{p0} for {}", hertz(force));
    }
}

/// At a/R = 0.02 the normals of the undeformed spheres do not matter: by multipliers and methods, one sphere and two, the difference to Hertz
/// falls with the elements.
#[test]
fn the_pressure_in_the_centre_converges_for_every_multiplier_and_method() {
    for backend in ["iga", "fe"] {
        let own =
            [(true, ""), (false, ""), (false, "multiplier = \"p/p\""), (false, "method = \"penalty\""), (false, "method = \"augmented\"")];
        for (two, contact) in own {
            let off = |n: usize| {
                let result = spheres(two, (backend, 2, n, 0.003), 0.02, contact);
                probe(&result, "p0") / hertz(probe(&result, "F")) - 1.0
            };
            let [coarse, fine] = [24, 48].map(off);
            println!("{backend} two {two} {contact}: {coarse:.5} {fine:.5}");
            assert!(fine.abs() < 4e-3 && fine.abs() < coarse.abs(), "{backend} {contact}: {coarse} {fine}");
        }
    }
}

/// Extents of zones are lengths of the curve, whatever the radius: a ring that is pressed as a whole, and Hertz' a³ = 3 F R / (4 E*).
#[test]
fn half_widths_are_lengths_of_the_curve() {
    const A: &str = "[[probe]]\nname = \"a\"\nquantity = \"contact.c.half_width\"\n";
    for backend in ["iga", "fe"] {
        for radius in [0.0, 1.0, 30.0] {
            let result = run(&format!(
                "{MODEL}[discretization]\nbackend = \"{backend}\"\n[[patch]]\nname = \"a\"\n\
                 geometry = {{ kind = \"box\", min = [{radius:?}, 0], max = [{:?}, 1] }}\nelements = [8, 3]\n\
                 [[boundary]]\non = \"a.top\"\ndirichlet = {{ y = -0.01 }}\n\
                 [[contact]]\nname = \"c\"\nslave = \"a.bottom\"\nrigid = {{ kind = \"half-plane\", point = [0, 0], normal = [0, 1] }}\n{A}",
                radius + 1.0
            ));
            // a disc goes on beyond the axis
            let wanted = if radius == 0.0 { 1.0 } else { 0.5 };
            assert!((probe(&result, "a") - wanted).abs() < 1e-9, "{backend} {radius}: {}", probe(&result, "a"));
        }
        let result = spheres(false, (backend, 2, 64, 0.05), 0.5, &format!("symmetry = true\n{A}"));
        let hertz = (0.75 * probe(&result, "F") * RADIUS * 0.91 / 20000.0).cbrt();
        assert!((probe(&result, "a") / hertz - 1.0).abs() < 1e-2, "{backend}: {} for {hertz}", probe(&result, "a"));
    }
}

/// A cylinder under uniform compression: sigma_yy = -E d / h everywhere, on the axis too, for contacts and ties of every method.
#[test]
fn pressures_on_the_axis_are_those_beside_it() {
    let (h, d) = (2.0, 0.01);
    let exact = 20000.0 * d / h;
    let block = |name: &str, from: f64, to: f64| {
        format!(
            "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"box\", min = [0, {from:?}], max = [1, {to:?}] }}\nelements = [3, 2]\n"
        )
    };
    let pressed = |name: &str| format!("[[boundary]]\non = \"{name}.top\"\ndirichlet = {{ y = {:?} }}\n", -d);
    for backend in ["iga", "fe"] {
        for method in ["lagrange", "nitsche", "augmented"] {
            let result = run(&format!(
                "{MODEL}[discretization]\nbackend = \"{backend}\"\n{}{}[[contact]]\nname = \"c\"\nslave = \"a.bottom\"\nmethod = \"{method}\"\n\
                 rigid = {{ kind = \"half-plane\", point = [0, 0], normal = [0, 1] }}\n\
                 [[probe]]\nname = \"axis\"\nquantity = \"contact.c.pressure at [0, 0]\"\n\
                 [[probe]]\nname = \"rim\"\nquantity = \"contact.c.pressure at [1, 0]\"\n",
                block("a", 0.0, h),
                pressed("a")
            ));
            for name in ["axis", "rim"] {
                let found = probe(&result, name);
                assert!((found / exact - 1.0).abs() < 1e-8, "{backend} {method} {name}: {found} for {exact}");
            }
        }
        for coupling in ["mortar", "nitsche"] {
            let result = run(&format!(
                "{MODEL}[discretization]\nbackend = \"{backend}\"\n{}{}{}[[boundary]]\non = \"b.bottom\"\nfix = [\"y\"]\n\
                 [[interface]]\nname = \"t\"\nslave = \"a.bottom\"\nmaster = \"b.top\"\ncoupling = \"{coupling}\"\n\
                 [[probe]]\nname = \"axis\"\nquantity = \"interface.t.lambda.y at [0, 1]\"\n\
                 [[probe]]\nname = \"rim\"\nquantity = \"interface.t.lambda.y at [1, 1]\"\n",
                block("b", 0.0, 1.0),
                block("a", 1.0, h).replace("[3, 2]", "[2, 2]"),
                pressed("a")
            ));
            for name in ["axis", "rim"] {
                let found = probe(&result, name);
                assert!((found.abs() / exact - 1.0).abs() < 1e-8, "{backend} {coupling} {name}: {found} for {exact}");
            }
        }
    }
}
