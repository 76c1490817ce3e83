//! Curved sides that slide, and what meets them: other parts of the side, kinks, prescribed values, loads; `check` and `run` say the same.

use crate::supports::{line_of, refused, ring, solved};

const QUARTER: &str = "[0, 90]";

/// A check that a component of the displacement of the outer circle vanishes at an angle.
fn vanishes(component: &str, degrees: f64, atol: f64) -> String {
    let (sin, cos) = degrees.to_radians().sin_cos();
    format!("[[check]]\nquantity = \"u.{component} about [0, 0] at [{:.12}, {:.12}]\"\nequals = 0\natol = {atol:e}\n", 2.0 * cos, 2.0 * sin)
}

#[test]
fn normals_and_tangents_of_an_arc_hold_their_common_point() {
    for backend in ["iga", "fe"] {
        let below = ("v1", "fix = [\"normal\"]\nwhere = \"y < x\"");
        let above = ("v1", "fix = [\"tangential\"]\nwhere = \"y > x\"");
        for [first, second] in [[below, above], [above, below]] {
            // displacements up to 2e-3
            let blocks = [("v0", "pressure = 1e-3"), ("v0", "traction = { x = 5e-4 }"), first, second];
            let checks = [("r", 45.0), ("t", 45.0), ("r", 44.0), ("t", 46.0)].map(|(c, degrees)| vanishes(c, degrees, 5e-6));
            solved(&(ring(backend, QUARTER, &blocks) + &checks.concat()));
        }
    }
}

#[test]
fn a_side_with_a_kink_holds_its_corner() {
    for backend in ["iga", "fe"] {
        for word in ["normal", "tangential"] {
            let fix = format!("fix = [\"{word}\"]");
            let blocks = [("v1", &*fix), ("u0", "fix = [\"y\"]"), ("u1", "fix = [\"x\"]"), ("v0", "traction = { x = 1, y = 0.3 }")];
            let ring = ring(backend, QUARTER, &blocks);
            let shape = "kind = \"plate-with-hole\", radius = 1, half_width = 4";
            let text = ring.replace("kind = \"annulus-sector\", radius = [1, 2], angle_deg = [0, 90]", shape).replace("[32, 8]", "[8, 4]");
            assert!(text.contains(shape));
            let zero = |what: &str| format!("[[check]]\nquantity = \"{what}\"\nequals = 0\natol = 1e-11\n");
            solved(&(text + &["u.x at [4, 4]", "u.y at [4, 4]", "balance.force.x", "balance.force.y"].map(zero).concat()));
        }
    }
}

#[test]
fn values_at_the_end_of_an_arc_agree_with_what_it_holds() {
    for backend in ["iga", "fe"] {
        for (fix, bad, good) in [
            (
                "fix = [\"normal\"]",
                ["x = 1e-3, y = 0", "x = \"1e-3*x\", y = \"1e-3*y\""],
                ["x = 0, y = 1e-3", "x = \"1e-3*(2 - x)\", y = 0"],
            ),
            ("fix = [\"tangential\"]", ["x = 0, y = 1e-3", "x = 0, y = \"1e-3*x\""], ["x = 1e-3, y = 0", "x = 0, y = \"1e-3*(2 - x)\""]),
        ] {
            for values in bad {
                let moved = format!("dirichlet = {{ {values} }}");
                for blocks in [[("u0", &*moved), ("v1", fix)], [("v1", fix), ("u0", &*moved)]] {
                    let text = ring(backend, QUARTER, &blocks);
                    let found = refused(&text);
                    assert_eq!((found.len(), found[0].code, found[0].line), (1, "E052", line_of(&text, "fix")), "{found:?}\n{text}");
                    let other = format!(
                        "the condition on `b.v1` contradicts `b.u0` (line {}) where they meet",
                        line_of(&text, "dirichlet").unwrap()
                    );
                    assert!(found[0].message.starts_with(&other), "{found:?}");
                }
            }
            for values in good {
                solved(&ring(backend, QUARTER, &[("u0", &format!("dirichlet = {{ {values} }}")), ("v1", fix)]));
            }
        }
    }
}

#[test]
fn loads_along_the_tangents_of_a_mantle_are_carried_by_their_support_alone() {
    for backend in ["iga", "fe"] {
        let text = |fix: &str, load: &str| {
            let blocks = [("v0", "fix = [\"x\", \"y\", \"z\"]"), ("v1", fix), ("v1", load)];
            let plane = ring(backend, QUARTER, &blocks).replace("degree = 3", "degree = 2");
            plane.replace("dimension = 2", "dimension = 3").replace("90] }", "90], extrude = 0.5 }").replace("[32, 8]", "[4, 2, 1]")
        };
        for load in ["traction = { z = 1 }", "force = { z = 1 }", "spring = { z = 1 }"] {
            let refused_text = text("fix = [\"tangential\"]", load);
            let found = refused(&refused_text);
            let at = (1, "E052", Some(refused_text.lines().count()));
            assert_eq!((found.len(), found[0].code, found[0].line), at, "{found:?}\n{refused_text}");
            assert!(found[0].message.contains("directions that are held in line 21"), "{found:?}");
            solved(&text("fix = [\"normal\"]", load));
        }
        solved(&text("fix = [\"tangential\"]", "traction = { x = 1, z = 1 }"));
        // as on planar sides
        solved(&text("fix = [\"normal\"]", "pressure = 1"));
    }
}
