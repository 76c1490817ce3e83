//! Forces in corners and along edges: against equilibrium, equal tractions of one element, and the theory of beams.

use faying_cli::case::ReadOptions;
use faying_cli::errors::Diagnostics;
use faying_cli::result::Moment;
use faying_cli::{Case, Registry, RunResult, Status};

fn run(text: &str) -> RunResult {
    let case = Case::parse("case.toml", text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let result = case.run(&Registry::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert!(matches!(result.status, Status::Ok), "{:?}\n{text}", result.diagnostics);
    result
}

fn faults(text: &str) -> Diagnostics {
    match Case::parse("case.toml", text, &ReadOptions::default()) {
        Err(faults) => faults,
        Ok(case) => case.run(&Registry::default()).expect_err("refused"),
    }
}

fn near(a: f64, b: f64, within: f64) {
    assert!((a - b).abs() <= within, "{a} for {b}");
}

fn probe(result: &RunResult, name: &str) -> f64 {
    result.probes.iter().find(|p| p.name == name).unwrap().value
}

fn model(dimension: usize, more: &str) -> String {
    format!("[model]\nphysics = \"elasticity\"\ndimension = {dimension}\n{more}\n[[material]]\nname = \"m\"\nyoung = 1e3\npoisson = 0.3\n")
}

fn block(name: &str, min: &str, max: &str, elements: &str, rest: &str) -> String {
    format!(
        "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"box\", min = [{min}], max = [{max}] }}\nelements = [{elements}]\n{rest}\n"
    )
}

fn on(regions: &str, what: &str) -> String {
    format!("[[boundary]]\nname = \"{}\"\non = {regions}\n{what}\n", regions.replace(['"', '[', ']', ' '], "").replace(['.', ','], "-"))
}

const BACKENDS: [&str; 4] =
    ["backend = \"iga\"", "backend = \"fe\"", "backend = \"fe\"\ncells = \"simplex\"", "degree = 3\nbackend = \"iga\""];

/// A beam on two corners, pulled in a third one: reactions by equilibrium, the energy is half the work of the force.
#[test]
fn a_beam_on_two_corners_has_the_reactions_of_equilibrium() {
    for backend in BACKENDS {
        let (l, h, f) = (7.0, 1.5, [3.0, -2.0]);
        let text = model(2, "")
            + &block("b", "0, 0", &format!("{l}, {h}"), "7, 2", backend)
            + &on("\"b.u0v0\"", "fix = [\"x\", \"y\"]")
            + &on("\"b.u1v0\"", "fix = [\"y\"]")
            + &on("\"b.u1v1\"", &format!("force = {{ x = {}, y = {} }}", f[0], f[1]))
            + &format!(
                "[[probe]]\nname = \"x\"\nquantity = \"u.x at [{l}, {h}]\"\n[[probe]]\nname = \"y\"\nquantity = \"u.y at [{l}, {h}]\"\n"
            );
        let result = run(&text);
        let right = (h * f[0] - l * f[1]) / l;
        let reaction = |name: &str| result.reactions.get(name).unwrap_or_else(|| panic!("{:?}", result.reactions));
        near(reaction("b.u1v0")[1], right, 1e-9);
        near(reaction("b.u0v0")[0], -f[0], 1e-9);
        near(reaction("b.u0v0")[1], -f[1] - right, 1e-9);
        let load = result.loads.get("b-u1v1").unwrap();
        near(load.force[0], f[0], 1e-13);
        near(load.force[1], f[1], 1e-13);
        let Some(Moment::Plane(moment)) = load.moment else { panic!("{load:?}") };
        near(moment, l * f[1] - h * f[0], 1e-12);
        let u = ["x", "y"].map(|name| probe(&result, name));
        near(result.energy, 0.5 * (f[0] * u[0] + f[1] * u[1]), 1e-9 * result.energy);
    }
}

/// On one bilinear element forces in the corners, or along the edges, of a side are a uniform traction of the side.
#[test]
fn corners_and_edges_of_one_element_share_a_uniform_traction() {
    for backend in ["degree = 1\nbackend = \"iga\"", "degree = 1\nbackend = \"fe\""] {
        let probes = |n: usize| -> String {
            let at = ["2, 0.4", "2, 0.4, 1.1"][n - 2];
            ["x", "y"].map(|c| format!("[[probe]]\nname = \"{c}\"\nquantity = \"u.{c} at [{at}]\"\n")).concat()
        };
        let plane = |load: &str| {
            run(&(model(2, "")
                + &block("b", "0, 0", "2, 1", "1, 1", backend)
                + &on("\"b.u0\"", "fix = [\"x\", \"y\"]")
                + load
                + &probes(2)))
        };
        let solid = |load: &str| {
            run(&(model(3, "")
                + &block("b", "0, 0, 0", "2, 1, 3", "1, 1, 1", backend)
                + &on("\"b.u0\"", "fix = [\"x\", \"y\", \"z\"]")
                + load
                + &probes(3)))
        };
        let force = "force = { x = 3, y = -0.7 }";
        let all = [
            (plane(&on("\"b.u1\"", force)), plane(&on("[\"b.u1v0\", \"b.u1v1\"]", force))),
            (solid(&on("\"b.u1\"", force)), solid(&on("[\"b.u1v0\", \"b.u1v1\"]", force))),
            (solid(&on("\"b.u1\"", force)), solid(&on("[\"b.u1v0w0\", \"b.u1v1w0\", \"b.u1v0w1\", \"b.u1v1w1\"]", force))),
        ];
        for (side, points) in &all {
            for name in ["x", "y"] {
                let [a, b] = [side, points].map(|r| probe(r, name));
                near(a, b, 1e-13 * a.abs().max(1e-2));
            }
            near(side.energy, points.energy, 1e-12 * side.energy);
        }
    }
}

/// A force that varies along an edge is spread evenly by length as its formula says, over edges of different length together.
#[test]
fn forces_on_edges_are_spread_by_length_and_vary_with_place_and_time() {
    for backend in BACKENDS {
        let text = model(3, "")
            + &block("b", "0, 0, 0", "2, 1, 3", "2, 2, 2", backend)
            + &on("\"b.u0\"", "fix = [\"x\", \"y\", \"z\"]")
            + &on("[\"b.u1v0\", \"b.u1w1\"]", "force = { y = \"t*(1 + z)\" }")
            + "[steps]\nt = [1, 2]\n";
        let result = run(&text);
        // along z at x = 2, y = 0: 3 + 9/2; along y at z = 3: 4; over a length of 4, at t = 2
        let load = result.loads.get("b-u1v0-b-u1w1").unwrap();
        near(load.force[1], 2.0 * (7.5 + 4.0) / 4.0, 1e-12);
        let Some(Moment::Space(moment)) = &load.moment else { panic!("{load:?}") };
        // -z f_y: -∫ z (1 + z) over 0..3, and -3 · 4
        near(moment[0], -2.0 * (4.5 + 9.0 + 12.0) / 4.0, 1e-11);
        near(result.reactions.get("b.u0").or(result.reactions.get("b.left")).unwrap()[1], -load.force[1], 1e-9);
    }
}

/// Three-point bending: two glued halves, a force in the corner between them; deflection F L³/(48 E I) + F L/(4 κ G A), κ = 5/6.
#[test]
fn a_slender_beam_bends_as_the_theory_of_beams_says() {
    let (l, h, f) = (40.0_f64, 1.0_f64, -1e-3);
    for backend in ["backend = \"iga\"", "backend = \"fe\""] {
        let text = model(2, "assumption = \"plane-stress\"")
            + &block("a", "0, 0", "20, 1", "40, 2", backend)
            + &block("b", "20, 0", "40, 1", "40, 2", backend)
            + "[[interface]]\nname = \"g\"\nslave = \"a.u1\"\nmaster = \"b.u0\"\ncoupling = \"glue\"\n"
            + &on("\"a.u0v0\"", "fix = [\"x\", \"y\"]")
            + &on("\"b.u1v0\"", "fix = [\"y\"]")
            + &on("\"a.u1v1\"", &format!("force = {{ y = {f} }}"))
            + "[[probe]]\nname = \"y\"\nquantity = \"u.y at [20, 0.5] in a\"\n";
        let result = run(&text);
        let (e, g) = (1e3, 1e3 / 2.6);
        let theory = f * l.powi(3) / (48.0 * e * h.powi(3) / 12.0) + f * l / (4.0 * 5.0 / 6.0 * g * h);
        let found = probe(&result, "y");
        near(found / theory, 1.0, 5e-3);
        near(result.reactions.get("b.u1v0").unwrap()[1], -f / 2.0, 1e-10);
    }
}

#[test]
fn forces_that_act_on_supports_or_on_regions_of_two_kinds_are_refused() {
    let text = |more: &str| model(2, "") + &block("b", "0, 0", "2, 1", "2, 2", "") + &on("\"b.u0\"", "fix = [\"x\", \"y\"]") + more;
    let refused = |more: &str, code: &str, part: &str| {
        let found = faults(&text(more));
        assert!(found.items.len() == 1 && found.items[0].code == code && found.items[0].message.contains(part), "{more}: {found:?}");
        assert!(found.items[0].line.is_some() && found.items[0].help.is_some() || code == "E015", "{found:?}");
    };
    let held = |component: &str| format!("[[boundary]]\non = \"b.u1v1\"\nfix = [\"{component}\"]\n");
    refused(&on("\"b.u0v1\"", "force = { y = 1 }"), "E052", "component y of `b.u0v1` is loaded, and prescribed");
    refused(&(held("y") + &on("\"b.u1v1\"", "force = { y = 1 }")), "E052", "`b.u1v1` has two conditions for component y");
    refused(&on("[\"b.u1\", \"b.u1v1\"]", "force = { y = 1 }"), "E015", "a force is spread over sides, over edges or over corners");
    refused(&on("\"b.u1v1\"", "force = { y = \"1/(x - 2)\" }"), "E017", "b.u1v1");
    refused(&on("\"b.u1v1\"", "spring = { y = 1 }"), "E015", "it takes fix, dirichlet and force");
    // what is held along x takes a force along y
    let beside = text(&(held("x") + &on("\"b.u1v1\"", "force = { y = 1 }")));
    near(run(&beside).loads.get("b-u1v1").unwrap().force[1], 1.0, 1e-14);
}

/// A source in a corner: all of it flows out through the sides that are held.
#[test]
fn a_source_in_a_corner_flows_out() {
    for backend in BACKENDS {
        let text = String::from("[model]\nphysics = \"poisson\"\ndimension = 2\n")
            + &block("b", "0, 0", "2, 1", "3, 2", backend)
            + &on("\"b.u0\"", "fix = [\"u\"]")
            + &on("\"b.u1v1\"", "force = 3");
        let result = run(&text);
        let out = result.reactions.get("b.u0").or(result.reactions.get("b.left")).unwrap();
        near(out[0], -3.0, 1e-10);
    }
}

/// Around an axis a force in a corner is that of the full circle; on the axis there is one along it alone.
#[test]
fn a_force_on_the_axis_of_revolution_acts_along_it() {
    for backend in BACKENDS {
        let text = |force: &str| {
            model(2, "assumption = \"axisymmetric\"")
                + &block("b", "0, 0", "1, 2", "4, 8", backend)
                + "[[boundary]]\non = \"b.bottom\"\nfix = [\"y\"]\n"
                + force
        };
        for corner in ["b.u0v1", "b.u1v1"] {
            let result = run(&text(&on(&format!("\"{corner}\""), "force = { y = -3 }")));
            near(result.reactions.get("b.bottom").unwrap()[1], 3.0, 1e-12);
        }
        run(&text(&on("\"b.u1v1\"", "force = { x = 2 }")));
        let found = faults(&text(&on("\"b.u0v1\"", "force = { x = 2 }")));
        let [fault] = &found.items[..] else { panic!("{found:?}") };
        assert!(fault.code == "E015" && fault.line.is_some() && fault.message.contains("`b.u0v1` lies on the axis"), "{fault:?}");
    }
}
