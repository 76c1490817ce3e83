//! Principal stresses, strains, directions about a centre, lengths of displacements, forces of sides: against closed forms.

use faying_cli::case::ReadOptions;
use faying_cli::{Case, Registry, RunResult, Status};

/// Splines, quadrilaterals, triangles.
const KINDS: [&str; 3] =
    ["backend = \"iga\"", "backend = \"fe\"\nmapping = \"exact\"", "backend = \"fe\"\nmapping = \"exact\"\ncells = \"simplex\""];

fn read(text: &str) -> Result<Case, String> {
    Case::parse("case.toml", text, &ReadOptions::default()).map_err(|e| e.to_string())
}

fn run(text: &str) -> RunResult {
    let result = read(text).unwrap_or_else(|e| panic!("{e}\n{text}")).run(&Registry::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert_eq!(result.status, Status::Ok, "{:?} {:?}\n{text}", result.diagnostics, result.checks);
    result
}

/// Runs a case and compares quantities with their exact values, relative to `size`.
fn compare(text: &str, wanted: &[(String, f64)], (size, tolerance): (f64, f64)) {
    let probes: String = wanted.iter().enumerate().map(|(k, (q, _))| format!("[[probe]]\nname = \"p{k}\"\nquantity = \"{q}\"\n")).collect();
    let result = run(&(text.to_owned() + &probes));
    for (probe, (quantity, exact)) in result.probes.iter().zip(wanted) {
        let off = (probe.value - exact).abs();
        assert!(off <= tolerance * size, "{quantity}: {} instead of {exact}, off by {off:e}\n{text}", probe.value);
    }
}

fn elastic(kind: &str, degree: usize, more: &str) -> String {
    format!(
        "[model]\nphysics = \"elasticity\"\n{more}\n[discretization]\ndegree = {degree}\n{kind}\n\
         [[material]]\nname = \"m\"\nyoung = 100\npoisson = 0.3\n"
    )
}

/// A quarter of a ring of radii 1 and 2 about (0.7, -0.4), under the pressure 3 in its bore, in plane strain:
/// sigma_rr, sigma_tt = A -+ B / r^2 and u_r = (1 + nu) / E ((1 - 2 nu) A r + B / r) with A = 1, B = 4.
#[test]
fn a_ring_of_lame_has_its_stresses_strains_and_forces_about_its_centre() {
    let (young, nu, a, b) = (100.0, 0.3, 1.0, 4.0);
    for (kind, degree, elements, tolerance) in [(KINDS[0], 5, [2, 48], 1e-6), (KINDS[1], 5, [8, 48], 1e-6), (KINDS[2], 4, [8, 48], 1e-4)] {
        let text = elastic(kind, degree, "dimension = 2")
            + "[[patch]]\nname = \"ring\"\ngeometry = { kind = \"annulus-sector\", center = [0.7, -0.4], radius = [1, 2], angle_deg = [0, 90] }\n\
               [[boundary]]\non = \"ring.u0\"\nfix = [\"y\"]\n[[boundary]]\non = \"ring.u1\"\nfix = [\"x\"]\n\
               [[boundary]]\nname = \"bore\"\non = \"ring.v0\"\npressure = 3.0\n";
        let text = text.replace("angle_deg = [0, 90] }\n", &format!("angle_deg = [0, 90] }}\nelements = {elements:?}\n"));
        let (r, angle) = (1.5, 0.5_f64);
        let (rr, tt) = (a - b / (r * r), a + b / (r * r));
        let u = (1.0 + nu) / young * ((1.0 - 2.0 * nu) * a * r + b / r);
        let (err, ett) = ((1.0 + nu) / young * ((1.0 - nu) * rr - nu * tt), (1.0 + nu) / young * ((1.0 - nu) * tt - nu * rr));
        let (c, s) = (angle.cos(), angle.sin());
        let at = format!("at [{}, {}]", 0.7 + r * c, -0.4 + r * s);
        let about = "about [0.7, -0.4]";
        let stresses = [
            (format!("stress.rr {about} {at}"), rr),
            (format!("stress.tt {at} {about} in ring"), tt),
            (format!("stress.rt {about} {at}"), 0.0),
            // principal stresses are those of the ring's directions, and nu (rr + tt) along z
            (format!("principal.1 {at}"), tt),
            (format!("principal.2 {at}"), nu * (rr + tt)),
            (format!("principal.3 {at}"), rr),
            ("principal.1.max".to_owned(), a + b),
            ("principal.3.min".to_owned(), a - b),
            (format!("stress.tt.max {about}"), a + b),
            // the quarter: bore and cut carry p times the radius
            ("force.ring.v0.x".to_owned(), 3.0),
            ("force.ring.v0.y".to_owned(), 3.0),
            ("force.ring.u0.y".to_owned(), -3.0),
            ("force.ring.v1.x".to_owned(), 0.0),
        ];
        compare(&text, &stresses, (5.0, tolerance));
        let deformations = [
            (format!("u.r {about} {at}"), u),
            (format!("u.t {about} {at}"), 0.0),
            (format!("u.norm {at}"), u),
            (format!("strain.rr {about} {at}"), err),
            (format!("strain.tt {about} {at}"), ett),
            (format!("strain.rt {about} {at}"), 0.0),
            (format!("strain.xx {at}"), err * c * c + ett * s * s),
            (format!("strain.xy {at}"), (err - ett) * c * s),
            (format!("strain.zz {at}"), 0.0),
        ];
        compare(&text, &deformations, (ett, tolerance));
        // a check on a field as a whole, and one whose value asks for a quantity with a centre
        let checks = format!(
            "[[check]]\nquantity = \"stress.rt {about}\"\nover = \"all\"\nequals = 0\natol = {}\n\
             [[check]]\nquantity = \"stress.tt {about} {at}\"\nequals = \"2 - stress.rr {about} {at}\"\nrtol = {tolerance}\n",
            100.0 * tolerance
        );
        run(&(text + &checks));
    }
}

/// u = G x on a turned box: constant strains, and stresses whose principal values have the invariants of the tensor.
#[test]
fn constant_states_in_turned_bodies_have_exact_strains_and_principal_stresses() {
    let (lambda, mu) = (100.0_f64 * 0.3 / (1.3 * 0.4), 100.0_f64 / 2.6);
    let plane = [("plane-strain", lambda, 0.0), ("plane-stress", 2.0 * lambda * mu / (lambda + 2.0 * mu), -0.3 / 0.7)];
    for (assumption, lambda, out) in plane {
        for kind in KINDS {
            let text = elastic(kind, 2, &format!("dimension = 2\nassumption = \"{assumption}\""))
                + "[[patch]]\nname = \"a\"\ngeometry = { kind = \"box\", min = [0, 0], max = [1, 0.6], rotate_deg = 25 }\nelements = [2, 2]\n\
                   [[boundary]]\non = \"all-outer\"\ndirichlet = [\"0.01*x + 0.03*y\", \"-0.005*x - 0.02*y\"]\n";
            let (exx, eyy, exy) = (0.01_f64, -0.02_f64, 0.0125_f64);
            let trace = exx + eyy;
            let (xx, yy, xy) = (lambda * trace + 2.0 * mu * exx, lambda * trace + 2.0 * mu * eyy, 2.0 * mu * exy);
            let (mean, radius) = (0.5 * (xx + yy), (0.25 * (xx - yy) * (xx - yy) + xy * xy).sqrt());
            let zz = if assumption == "plane-strain" { lambda * trace } else { 0.0 };
            let mut principal = [mean + radius, mean - radius, zz];
            principal.sort_by(|a, b| b.total_cmp(a));
            let (x, y) = (0.3_f64, 0.4_f64);
            let (c, s) = ((x + 1.0) / (x + 1.0).hypot(y - 2.0), (y - 2.0) / (x + 1.0).hypot(y - 2.0));
            let u = [0.01 * x + 0.03 * y, -0.005 * x - 0.02 * y];
            let at = format!("at [{x}, {y}]");
            let wanted = [
                (format!("strain.xx {at}"), exx),
                (format!("strain.yy {at}"), eyy),
                (format!("strain.xy {at}"), exy),
                (format!("strain.zz {at}"), out * trace),
                ("strain.xy.max".to_owned(), exy),
                (format!("u.norm {at}"), u[0].hypot(u[1])),
                (format!("u.r about [-1, 2] {at}"), c * u[0] + s * u[1]),
                (format!("u.t about [-1, 2] {at}"), c * u[1] - s * u[0]),
                (format!("principal.1 {at}"), principal[0]),
                (format!("principal.2 {at}"), principal[1]),
                (format!("principal.3 {at}"), principal[2]),
                (format!("stress.rr about [-1, 2] {at}"), xx * c * c + yy * s * s + 2.0 * xy * c * s),
                (format!("stress.tt about [-1, 2] {at}"), xx * s * s + yy * c * c - 2.0 * xy * c * s),
                (format!("stress.rt about [-1, 2] {at}"), (yy - xx) * c * s + xy * (c * c - s * s)),
            ];
            compare(&text, &wanted, (1.0, 1e-11));
        }
    }
}

#[test]
fn solids_have_all_six_strains_and_polar_stresses_about_the_axis_of_z() {
    let (lambda, mu) = (100.0 * 0.3 / (1.3 * 0.4), 100.0 / 2.6);
    let g = [[0.01, 0.03, -0.02], [0.005, -0.02, 0.01], [0.04, -0.01, 0.015]];
    let strain = |i: usize, j: usize| 0.5 * (g[i][j] + g[j][i]);
    let trace = g[0][0] + g[1][1] + g[2][2];
    let stress = |i: usize, j: usize| 2.0 * mu * strain(i, j) + if i == j { lambda * trace } else { 0.0 };
    for kind in KINDS {
        let row = |i: usize| format!("\"{}*x + {}*y + {}*z\"", g[i][0], g[i][1], g[i][2]);
        let text = elastic(kind, 1, "dimension = 3")
            + &format!(
                "[[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = [0, 0, 0], max = [1, 1, 1] }}\nelements = [2, 1, 1]\n\
                 [[boundary]]\non = \"all-outer\"\ndirichlet = [{}, {}, {}]\n",
                row(0),
                row(1),
                row(2)
            );
        let at = "at [0.3, 0.4, 0.6]";
        let (c, s) = (0.6, 0.8);
        let names = ["xx", "yy", "zz", "xy", "yz", "xz"];
        let places = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)];
        let mut wanted: Vec<(String, f64)> =
            names.iter().zip(places).map(|(name, (i, j))| (format!("strain.{name} {at}"), strain(i, j))).collect();
        let rr = stress(0, 0) * c * c + stress(1, 1) * s * s + 2.0 * stress(0, 1) * c * s;
        wanted.push((format!("stress.rr about [0, 0] {at}"), rr));
        // the force on a face is that of its constant stress
        wanted.push(("force.a.right.x".to_owned(), stress(0, 0)));
        wanted.push(("force.a.right.z".to_owned(), stress(0, 2)));
        wanted.push(("force.a.back.y".to_owned(), stress(1, 1)));
        wanted.push(("force.a.front.z".to_owned(), -stress(1, 2)));
        compare(&text, &wanted, (1.0, 1e-11));
        // the principal stresses have the invariants of the tensor
        let probes: String = (1..=3).map(|k| format!("[[probe]]\nname = \"p{k}\"\nquantity = \"principal.{k} {at}\"\n")).collect();
        let p: Vec<f64> = run(&(text.clone() + &probes)).probes.iter().map(|p| p.value).collect();
        assert!(p[0] >= p[1] && p[1] >= p[2], "{p:?}");
        let squares: f64 = (0..3).flat_map(|i| (0..3).map(move |j| (i, j))).map(|(i, j)| stress(i, j) * stress(i, j)).sum();
        let minor = |a: usize, b: usize| stress(1, a) * stress(2, b) - stress(1, b) * stress(2, a);
        let determinant = stress(0, 0) * minor(1, 2) - stress(0, 1) * minor(0, 2) + stress(0, 2) * minor(0, 1);
        assert!((p.iter().sum::<f64>() - (stress(0, 0) + stress(1, 1) + stress(2, 2))).abs() < 1e-11, "{p:?}");
        assert!((p.iter().map(|p| p * p).sum::<f64>() - squares).abs() < 1e-10, "{p:?}");
        assert!((p.iter().product::<f64>() - determinant).abs() < 1e-10, "{p:?}");
    }
}

/// u_r = a r, u_z = b z: the hoop strain is a, at any radius and on the axis.
#[test]
fn bodies_of_revolution_have_a_hoop_strain() {
    for kind in KINDS {
        let text = elastic(kind, 2, "dimension = 2\nassumption = \"axisymmetric\"")
            + "[[patch]]\nname = \"a\"\ngeometry = { kind = \"box\", min = [0, 0], max = [1, 2] }\nelements = [2, 2]\n\
               [[boundary]]\non = [\"a.right\", \"a.bottom\", \"a.top\"]\ndirichlet = [\"0.01*x\", \"-0.02*y\"]\n";
        let (lambda, mu) = (100.0 * 0.3 / (1.3 * 0.4), 100.0 / 2.6);
        // sigma_z over the disc of radius 1
        let force = (lambda * (2.0 * 0.01 - 0.02) - 2.0 * mu * 0.02) * std::f64::consts::PI;
        let wanted = [
            ("strain.zz at [0.7, 0.3]".to_owned(), 0.01),
            ("strain.zz at [0, 1.3]".to_owned(), 0.01),
            ("strain.xx at [0.7, 0.3]".to_owned(), 0.01),
            ("strain.yy at [0.7, 0.3]".to_owned(), -0.02),
            ("force.a.top.y".to_owned(), force),
        ];
        compare(&text, &wanted, (1.0, 1e-10));
    }
}

/// Two blocks one above the other, the upper one pulled by 2 per area, on every backend: what passes through the cut is the load.
#[test]
fn ties_and_sides_between_bodies_carry_the_load() {
    for (lower, upper) in [("iga", "iga"), ("iga", "fe"), ("fe", "iga"), ("fe", "fe")] {
        let text = elastic("", 2, "dimension = 2")
            + &format!(
                "[[patch]]\nname = \"lower\"\nbackend = \"{lower}\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [1, 1] }}\nelements = [2, 2]\n\
                 [[patch]]\nname = \"upper\"\nbackend = \"{upper}\"\ngeometry = {{ kind = \"box\", min = [0, 1], max = [1, 2] }}\nelements = [3, 2]\n\
                 [[boundary]]\non = [\"lower.left\", \"upper.left\"]\nfix = [\"x\"]\n[[boundary]]\non = \"lower.bottom\"\nfix = [\"y\"]\n\
                 [[boundary]]\nname = \"pull\"\non = \"upper.top\"\ntraction = {{ y = 2.0 }}\n\
                 [[interface]]\nname = \"cut\"\nslave = \"upper.bottom\"\nmaster = \"lower.top\"\n"
            );
        let wanted = [
            ("interface.cut.force.y".to_owned(), -2.0),
            ("interface.cut.force.x".to_owned(), 0.0),
            ("interface.cut.moment.z".to_owned(), -1.0),
            ("force.upper.bottom.y".to_owned(), -2.0),
            ("force.lower.top.y".to_owned(), 2.0),
            ("force.upper.top.y".to_owned(), 2.0),
            ("force.lower.bottom.y".to_owned(), -2.0),
            ("reaction.lower.bottom.y".to_owned(), -2.0),
        ];
        compare(&text, &wanted, (1.0, 1e-11));
    }
    let conduction = "[model]\nphysics = \"poisson\"\ndimension = 2\n[[material]]\nname = \"m\"\nconductivity = 3\n[[patch]]\nname = \"a\"\n\
        geometry = { kind = \"box\", min = [0, 0], max = [2, 0.5] }\nelements = [2, 2]\n[[boundary]]\non = \"all-outer\"\ndirichlet = \"x + 2*y\"\n";
    let wanted = [("force.a.right".to_owned(), 1.5), ("force.a.left".to_owned(), -1.5), ("force.a.top".to_owned(), 12.0)];
    compare(conduction, &wanted, (1.0, 1e-11));
}

#[test]
fn what_is_asked_wrongly_is_told() {
    let plane = elastic("", 1, "dimension = 2")
        + "[[patch]]\nname = \"a\"\ngeometry = { kind = \"box\", min = [0, 0], max = [1, 1] }\nelements = [1, 1]\n\
           [[boundary]]\non = \"a.left\"\nfix = [\"x\", \"y\"]\n";
    let solid = [
        ("dimension = 2", "dimension = 3"),
        ("[0, 0]", "[0, 0, 0]"),
        ("[1, 1] }", "[1, 1, 1] }"),
        ("elements = [1, 1]", "elements = [1, 1, 1]"),
        ("fix = [\"x\", \"y\"]", "fix = [\"x\", \"y\", \"z\"]"),
    ]
    .iter()
    .fold(plane.clone(), |text, (from, to)| text.replace(from, to));
    for (text, quantity, code, part) in [
        (&plane, "stress.rr at [0.5, 0.5]", "E018", "write stress.rr about [0, 0]"),
        (&plane, "principal.4 at [0.5, 0.5]", "E018", "principal.1, principal.2 and principal.3"),
        (&plane, "strain.xx", "E018", "is a field"),
        (&plane, "force.a.right", "E018", "write force.a.right.x"),
        (&plane, "force.a.right.z", "E018", "write force.a.right.x to .y"),
        (&plane, "force.a.roof.y", "E021", "a"),
        (&plane, "nominal.xx at [0.5, 0.5]", "E019", "not in this version"),
        (&solid, "stress.tt about [0, 0, 0] at [0.5, 0.5, 0.5]", "E018", "write about [x, y]"),
    ] {
        let case = read(&format!("{text}[[probe]]\nname = \"p\"\nquantity = \"{quantity}\"\n")).unwrap();
        let faults = case.run(&Registry::default()).unwrap_err().to_string();
        assert!(faults.contains(code) && faults.contains(part), "{quantity}: {faults}");
    }
}

/// A point off the body by less than a quarter of an element is taken at the nearest one, and the answer says where.
#[test]
fn a_point_beside_the_body_says_where_it_is_taken() {
    let text = "[model]\nphysics = \"poisson\"\ndimension = 2\nexact = { u = \"x\" }\n[[patch]]\nname = \"a\"\ngeometry = { kind = \"box\", min = [0, 0], max = [2, 1] }\n\
        elements = [2, 1]\n[[boundary]]\non = \"all-outer\"\ndirichlet = \"exact\"\n[[probe]]\nname = \"off\"\nquantity = \"u at [2.2, 0.5]\"\n\
        [[probe]]\nname = \"on\"\nquantity = \"u at [2, 0.5]\"\n[[check]]\nquantity = \"u at [2.2, 0.5]\"\nequals = 2\nrtol = 1e-9\n";
    let result = run(text);
    assert_eq!(result.probes[0].at.as_deref().map(|at| [at[0], at[1]]), Some([2.0, 0.5]));
    assert!(result.probes[1].at.is_none() && (result.probes[0].value - 2.0).abs() < 1e-9, "{:?}", result.probes);
}
