//! Cases in three dimensions: shapes and their measures, patch tests, convergence, supports, quantities, files.
#![cfg(feature = "cli")]
#![allow(clippy::unwrap_used)]

use faying::app::{Registry, RunResult, Status};
use faying::io::Case;
use faying::io::case::ReadOptions;
use faying::io::errors::Diagnostics;
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
