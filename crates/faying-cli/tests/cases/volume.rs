//! Cases in three dimensions: shapes and their measures, patch tests, convergence, supports, quantities, files.

use faying_cli::Case;
use faying_cli::case::ReadOptions;
use faying_cli::errors::Diagnostics;
use faying_cli::plot::FieldPlot;
use faying_cli::{Registry, RunControl, RunOptions, RunResult, Status};
use faying_files::vtu::CellStyle;
use std::f64::consts::PI;

fn read(text: &str, backend: Option<&str>) -> Result<Case, Diagnostics> {
    Case::parse("case.toml", text, &ReadOptions { backend: backend.map(str::to_owned), ..ReadOptions::default() })
}

fn run(text: &str, backend: Option<&str>) -> RunResult {
    let case = read(text, backend).unwrap_or_else(|e| panic!("{e}"));
    case.run(&Registry::default()).unwrap_or_else(|e| panic!("{e}"))
}

/// The errors of a case, found while reading or building.
fn faults(text: &str) -> Diagnostics {
    match read(text, None) {
        Err(found) => found,
        Ok(case) => case.run(&Registry::default()).expect_err("the case is wrong"),
    }
}

/// Poisson on one patch "a", zero all around unless `rest` says more.
fn poisson(geometry: &str, elements: &str, rest: &str) -> String {
    format!(
        "[model]\nphysics = \"poisson\"\ndimension = 3\n[[patch]]\nname = \"a\"\ngeometry = {{ {geometry} }}\nelements = {elements}\n\
         [[boundary]]\non = \"all-outer\"\nfix = [\"u\"]\n{rest}"
    )
}

fn probe(quantity: &str) -> String {
    format!("[[probe]]\nname = \"q{}\"\nquantity = \"{quantity}\"\n", quantity.replace(['.', ' ', '[', ']', ','], "-"))
}

#[track_caller]
fn near(found: f64, expected: f64, relative: f64, what: &str) {
    assert!((found - expected).abs() <= relative * expected.abs(), "{what}: {found:e}, expected {expected:e}");
}

#[test]
fn volumes_and_areas_of_exact_shapes_are_those_of_the_formulas() {
    let shapes: [(&str, &str, f64, &[(&str, f64)]); 6] = [
        ("kind = \"box\", min = [0, 0, 0], max = [1, 2, 3]", "[2, 1, 1]", 6.0, &[("left", 6.0), ("front", 3.0), ("top", 2.0)]),
        // a quarter ring of radii 1 and 2, height 3: pi/4 (4 - 1) 3
        (
            "kind = \"annulus-sector\", radius = [1, 2], angle_deg = [0, 90], extrude = 3",
            "[2, 1, 1]",
            2.25 * PI,
            &[("v0", 1.5 * PI), ("v1", 3.0 * PI), ("u0", 3.0), ("w1", 0.75 * PI)],
        ),
        // a full cylinder of radius 2 and height 5
        (
            "kind = \"disc-sector\", radius = 2, angle_deg = [0, 360], extrude = 5",
            "[4, 1, 1]",
            20.0 * PI,
            &[("v1", 20.0 * PI), ("w0", 4.0 * PI), ("u1", 10.0)],
        ),
        // an eighth of a shell: 4/3 pi (r1^3 - r0^3) / 8, its spheres 4 pi r^2 / 8, its quarters of rings
        (
            "kind = \"sphere-octant\", center = [1, 2, 3], radius = [1, 2]",
            "[1, 1, 1]",
            7.0 * PI / 6.0,
            &[("w0", 0.5 * PI), ("w1", 2.0 * PI), ("u0", 0.75 * PI), ("u1", 0.75 * PI), ("v0", 0.75 * PI)],
        ),
        // half a plate of width 4 less a quarter of a disc, twice as large, turned and moved: lengths grow by 2
        (
            "kind = \"plate-with-hole\", radius = 1, half_width = 2, extrude = 0.5, scale = 2, rotate_deg = 40, axis = [1, 1, 0], move = [1, 2, 3]",
            "[2, 1, 1]",
            4.0 * (4.0 - 0.25 * PI),
            &[("v0", PI), ("v1", 8.0), ("w0", 4.0 * (4.0 - 0.25 * PI))],
        ),
        // a plane net with two knot vectors, extruded
        (
            "kind = \"nurbs\", degree = [2, 1], knots = [[0, 0, 0, 1, 1, 1], [0, 0, 1, 1]], points = [[1, 0], [1, 1], [0, 1], [2, 0], [2, 2], [0, 2]], \
             weights = [1, 0.70710678118654752, 1, 1, 0.70710678118654752, 1], extrude = 3",
            "1",
            2.25 * PI,
            &[("v0", 1.5 * PI), ("w1", 0.75 * PI)],
        ),
    ];
    for (geometry, elements, volume, sides) in shapes {
        let probes: String = sides.iter().map(|(side, _)| probe(&format!("area.a.{side}"))).collect();
        let result = run(&poisson(geometry, elements, &(probe("volume.a") + &probes)), None);
        assert_eq!(result.status, Status::Ok);
        near(result.probes[0].value, volume, 1e-12, geometry);
        for (found, (side, area)) in result.probes[1..].iter().zip(sides) {
            near(found.value, *area, 1e-12, &format!("{geometry}: {side}"));
        }
    }
}

#[test]
fn transformations_are_applied_in_the_order_extrude_scale_rotate_move() {
    // the corner (1, 0, 2) of the extruded square: scaled (2, 0, 4), turned about y by 90 degrees (4, 0, -2), moved (5, 1, -1)
    let text = poisson(
        "kind = \"box\", min = [0, 0], max = [1, 1], extrude = 2, scale = 2, rotate_deg = 90, axis = [0, 1, 0], move = { x = 1, y = 1, z = 1 }",
        "[1, 1, 1]",
        "",
    )
    .replace("fix = [\"u\"]", "dirichlet = \"x + 10*y + 100*z\"")
        + &probe("u at [5, 1, -1]");
    let result = run(&text, None);
    near(result.probes[0].value, 5.0 + 10.0 - 100.0, 1e-12, "u in the corner");
}

#[test]
fn shapes_of_the_wrong_dimension_are_refused_with_the_remedy() {
    let plane = poisson("kind = \"annulus-sector\", radius = [1, 2], angle_deg = [0, 90]", "[2, 1, 1]", "");
    let found = faults(&plane);
    assert_eq!(found.items[0].code, "E044");
    assert!(found.items[0].message.contains("add extrude = h"), "{}", found.items[0].message);
    let solid = poisson("kind = \"sphere-octant\", radius = [1, 2], extrude = 1", "[2, 1, 1]", "");
    assert_eq!(faults(&solid).items[0].code, "E044");
    let knots = "kind = \"nurbs\", degree = [1, 1], knots = [[0, 0, 1, 1], [0, 0, 1, 1]], points = [[0, 0], [1, 0], [0, 1], [1, 1]]";
    let found = faults(&poisson(knots, "1", ""));
    assert_eq!(found.items[0].code, "E044");
    assert!(found.items[0].help.as_deref().is_some_and(|h| h.contains("extrude")), "{:?}", found.items[0].help);
    let flat = "[model]\nphysics = \"poisson\"\ndimension = 2\n[[patch]]\nname = \"a\"\ngeometry = { kind = \"sphere-octant\", radius = [1, 2] }\n\
                elements = [1, 1]\n[[boundary]]\non = \"a.u0\"\nfix = [\"u\"]\n";
    assert_eq!(faults(flat).items[0].code, "E044");
}

/// The value of a quantity of a reference case on a backend, with the number published for it and its relative tolerance.
fn reference(name: &str, change: impl Fn(String) -> String, backend: Option<&str>) -> (f64, f64, f64) {
    let folder = format!("{}/reference/{name}", concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let text = change(std::fs::read_to_string(format!("{folder}/case.toml")).unwrap());
    let expected: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(format!("{folder}/expected.json")).unwrap()).unwrap();
    let result = run(&text, backend);
    assert_eq!(result.status, Status::Ok, "{:?}", result.diagnostics);
    let probe = result.probes.iter().find(|p| expected["quantity"] == p.quantity.as_str()).unwrap();
    println!("{name} {backend:?}: {} for {}", probe.value, expected["value"]);
    (probe.value, expected["value"].as_f64().unwrap(), expected["rtol"].as_f64().unwrap())
}

#[test]
fn the_thick_elliptic_plate_of_nafems_has_the_published_stress() {
    let quadratic = |text: String| text.replace("degree = 3\n", "degree = 2\n");
    let (iga, value, rtol) = reference("nafems-le10", |text| text, None);
    near(iga, value, rtol, "iga, degree 3");
    let (fe, ..) = reference("nafems-le10", quadratic, Some("fe"));
    near(fe, value, rtol, "curved hexahedra of degree 2");
}

/// Elasticity on one patch with an affine field and its tractions: supported by "exact" on `held`, loaded on all other sides.
fn affine(geometry: &str, elements: &str, discretization: &str, held: &str) -> String {
    format!(
        "[model]\nphysics = \"elasticity\"\ndimension = 3\n\
         exact = {{ u = [\"0.1*x + 0.02*y - 0.3*z\", \"0.03*z - 0.04*x\", \"0.05*y + 0.01*z + 0.2*x\"] }}\n\
         [discretization]\n{discretization}\n[[material]]\nname = \"m\"\nyoung = 3.0\npoisson = 0.3\n\
         [[patch]]\nname = \"a\"\ngeometry = {{ {geometry} }}\nelements = {elements}\n\
         [[boundary]]\non = {held}\ndirichlet = \"exact\"\n[[boundary]]\non = \"all-outer\"\ntraction = \"exact\"\n\
         [[probe]]\nname = \"s\"\nquantity = \"stress.yz.min\"\n[[probe]]\nname = \"t\"\nquantity = \"stress.yz.max\"\n"
    )
}

#[test]
fn affine_fields_are_reproduced_by_every_backend_on_straight_and_on_exact_bodies() {
    let bent = "kind = \"nurbs\", degree = [1, 1, 1], knots = [[0, 0, 1, 1], [0, 0, 1, 1], [0, 0, 1, 1]], \
                points = [[0, 0, 0], [1, 0.1, 0], [0.1, 1, 0], [1.2, 1, 0.2], [0, 0, 1], [1, 0, 1.1], [0, 1.1, 0.9], [1.1, 1, 1]]";
    let ring = "kind = \"annulus-sector\", radius = [1, 2], angle_deg = [0, 90], extrude = 1";
    let octant = "kind = \"sphere-octant\", radius = [1, 2]";
    let mut cases = vec![(ring, "degree = 2\nextra_points = 8".to_owned()), (octant, "degree = 2\nextra_points = 8".to_owned())];
    for degree in 1..=3 {
        let kinds = ["backend = \"iga\"", "backend = \"fe\"", "backend = \"fe\"\ncells = \"simplex\""];
        cases.extend(kinds.map(|kind| (bent, format!("{kind}\ndegree = {degree}"))));
    }
    for (geometry, discretization) in cases {
        let elements = if geometry == bent { "2" } else { "[2, 2, 2]" };
        let result = run(&affine(geometry, elements, &discretization, "[\"a.u0\", \"a.w0\"]"), None);
        let error = *result.errors.get("error.u.L2.rel").unwrap();
        assert!(error < 1e-11, "{geometry} {discretization}: error {error:e}");
        // 2 mu eps_yz = 3/1.3 * 0.5 (0.03 + 0.05)
        for probe in &result.probes {
            // beside a pole, where the map collapses, gradients keep half of their digits
            near(
                probe.value,
                3.0 / 1.3 * 0.04,
                if geometry == octant { 1e-8 } else { 1e-9 },
                &format!("{geometry} {discretization}: stress.yz"),
            );
        }
        let balance = result.balance.force.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
        assert!(balance < 1e-9, "{geometry} {discretization}: balance {balance:e}");
    }
}

#[test]
fn six_pinned_components_hold_a_solid_without_forces_and_fewer_are_named() {
    // an affine field held at one corner, along one edge and in one more corner component: statically determinate
    let pinned = "[\"a.u0v0w0\"]\ndirichlet = \"exact\"\n[[boundary]]\non = \"a.u1v0w0\"\n\
                  dirichlet = { y = \"0.03*z - 0.04*x\", z = \"0.05*y + 0.01*z + 0.2*x\" }\n[[boundary]]\non = \"a.v1u0w0\"\n\
                  dirichlet = { z = \"0.05*y + 0.01*z + 0.2*x\" }\n[[boundary]]\non = \"a.left\"\ntraction = \"exact\"";
    for backend in ["iga", "fe"] {
        let geometry = "kind = \"box\", min = [0, 0, 0], max = [1, 2, 1.5]";
        let text = affine(geometry, "[2, 2, 2]", &format!("backend = \"{backend}\"\ndegree = 2"), "HELD")
            .replace("on = HELD\ndirichlet = \"exact\"", &format!("on = {pinned}"));
        let result = run(&(text.clone() + &probe("reaction.a.u0v0w0.x")), None);
        let error = *result.errors.get("error.u.L2.rel").unwrap();
        assert!(error < 1e-11, "{backend}: {error:e}");
        assert!(result.probes.last().unwrap().value.abs() < 1e-10, "{backend}: the tractions are in balance");
        let loose =
            text.replace(", z = \"0.05*y + 0.01*z + 0.2*x\" }\n[[boundary]]\non = \"a.v1u0w0\"", " }\n[[boundary]]\non = \"a.v1u0w0\"");
        let found = faults(&loose);
        assert_eq!(found.items[0].code, "E051");
        let line = "rotation about the line along (0, 1, 0) through (0, 0, 0)";
        assert!(found.items[0].message.contains(line), "{}", found.items[0].message);
    }
}

#[test]
fn a_body_without_supports_names_all_six_motions() {
    let text = affine("kind = \"box\", min = [0, 0, 0], max = [1, 1, 1]", "1", "degree = 1", "HELD")
        .replace("[[boundary]]\non = HELD\ndirichlet = \"exact\"\n", "")
        .replace("elements = 1", "elements = [1, 1, 1]");
    let found = faults(&text);
    assert_eq!(found.items[0].code, "E051");
    for motion in ["translation x", "translation y", "translation z", "rotation about x", "rotation about y", "rotation about z"] {
        assert!(found.items[0].message.contains(motion), "{}", found.items[0].message);
    }
}

#[test]
fn data_on_an_edge_is_projected_along_it_and_must_agree_with_its_sides() {
    // u = x + 2 y + 3 z held on one edge only: a harmonic function with du/dn given elsewhere
    let case = |edge: &str, value: &str| {
        format!(
            "[model]\nphysics = \"poisson\"\ndimension = 3\nexact = {{ u = \"x + 2*y + 3*z\" }}\n[[patch]]\nname = \"a\"\n\
             geometry = {{ kind = \"annulus-sector\", radius = [1, 2], angle_deg = [0, 90], extrude = 1 }}\nelements = [2, 2, 2]\nextra_points = 8\n\
             [[boundary]]\non = \"{edge}\"\ndirichlet = \"{value}\"\n[[boundary]]\non = [\"a.u0\", \"a.u1\", \"a.v1\", \"a.w0\", \"a.w1\"]\n\
             neumann = \"exact\"\n"
        )
    };
    let held = "[[boundary]]\non = \"a.v0\"\n";
    let result = run(&(case("a.w1v0", "exact") + held + "neumann = \"exact\"\n"), None);
    let error = *result.errors.get("error.u.L2.rel").unwrap();
    assert!(error < 1e-10, "{error:e}");
    let result = run(&(case("a.w1v0", "exact") + held + "dirichlet = \"exact\"\n"), None);
    assert!(*result.errors.get("error.u.L2.rel").unwrap() < 1e-10);
    let found = faults(&(case("a.w1v0", "x + 2*y + 3*z + 0.1") + held + "dirichlet = \"exact\"\n"));
    assert_eq!(found.items[0].code, "E052");
    let found = faults(&(case("a.w1v0", "exact").replace("dirichlet = \"exact\"", "neumann = 1") + held + "neumann = \"exact\"\n"));
    assert_eq!(found.items[0].code, "E015");
    assert!(found.items[0].message.contains("is an edge; it takes fix, dirichlet and force"), "{}", found.items[0].message);
}

#[test]
fn errors_fall_by_the_orders_of_the_degree_on_nurbs_hexahedra_and_tetrahedra() {
    // an exact ring segment held on one side; L2 with p + 1, the gradient with p, less 0.1
    let [iga, hexahedra, tetrahedra] = ["iga\"", "fe\"", "fe\"\ncells = \"simplex\""];
    for (kind, p, coarse) in [
        (iga, 1, 4),
        (iga, 2, 4),
        (iga, 3, 4),
        (hexahedra, 1, 4),
        (hexahedra, 2, 4),
        (hexahedra, 3, 4),
        (tetrahedra, 1, 8),
        (tetrahedra, 2, 4),
        (tetrahedra, 3, 4),
    ] {
        let error = |n: usize| {
            let text = format!(
                "[model]\nphysics = \"poisson\"\ndimension = 3\nexact = {{ u = \"sin(1.5*x + 0.5)*cos(y)*exp(0.5*z)\" }}\n\
                 [discretization]\nbackend = \"{kind}\ndegree = {p}\n[[patch]]\nname = \"a\"\n\
                 geometry = {{ kind = \"annulus-sector\", radius = [1, 1.6], angle_deg = [0, 45], extrude = 0.8 }}\nelements = [{n}, {n}, {n}]\n\
                 [[boundary]]\non = \"a.u0\"\ndirichlet = \"exact\"\n[[boundary]]\non = \"all-outer\"\nneumann = \"exact\"\n"
            );
            let result = run(&text, None);
            ["error.u.L2", "error.u.H1"].map(|name| *result.errors.get(name).unwrap())
        };
        let (coarse, fine) = (error(coarse), error(2 * coarse));
        let rates = [0, 1].map(|k| (coarse[k] / fine[k]).log2());
        println!("{kind} p = {p}: rates {rates:?}");
        assert!(rates[0] > p as f64 + 0.9 && rates[1] > p as f64 - 0.1, "{kind} p = {p}: {rates:?}");
    }
}

#[test]
fn files_of_a_solid_are_written_with_every_kind_of_cell() {
    let text = poisson("kind = \"sphere-octant\", radius = [1, 2]", "[2, 2, 1]", "");
    for backend in ["iga", "fe"] {
        let case = read(&text, Some(backend)).unwrap();
        for cells in [None, Some(CellStyle::Bezier), Some(CellStyle::Lagrange), Some(CellStyle::Linear)] {
            let finished =
                faying_cli::run::run(&case, &Registry::default(), &RunOptions { cells, ..RunOptions::default() }, &RunControl::default());
            let output = finished.output.unwrap();
            let vtu = output.parts.vtu().unwrap();
            assert!(vtu.windows(16).any(|w| w == b"UnstructuredGrid"));
            let svg = output
                .parts
                .svg(&FieldPlot {
                    title: "octant",
                    label: "u",
                    field: "u",
                    component: Some(0),
                    range: None,
                    length: "",
                    moved: 0.0,
                    marks: &[],
                    obstacles: &[],
                })
                .unwrap();
            assert!(svg.starts_with("<svg") && svg.matches("z").count() > 100);
        }
    }
}

#[test]
fn remedies_speak_of_points_in_space() {
    let field = poisson("kind = \"box\", min = [0, 0, 0], max = [1, 1, 1]", "[1, 1, 1]", &probe("u"));
    for text in [field.clone(), field.replace("quantity = \"u\"", "quantity = \"u at tip\"")] {
        let found = faults(&text);
        assert!(found.to_string().contains("at [x, y, z]"), "{found}");
    }
    // the axis of a cylinder
    let cylinder = poisson("kind = \"disc-sector\", radius = 1, angle_deg = [0, 90], extrude = 2", "[2, 2, 2]", "");
    for edge in ["v0", "u0v0", "v0w1"] {
        let found = faults(&format!("{cylinder}[[boundary]]\non = \"a.{edge}\"\ndirichlet = 1\n"));
        assert!(found.items[0].code == "E021" && found.to_string().contains("v0 is the centre of the disc"), "{found}");
    }
}
