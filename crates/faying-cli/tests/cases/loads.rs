//! Resultants of loads as integrated, and warnings where a load, a spring or a modulus jumps inside of elements.

use faying_cli::case::ReadOptions;
use faying_cli::errors::Diagnostic;
use faying_cli::result::{LoadReport, Moment};
use faying_cli::{Case, Registry, RunControl, RunOptions, RunResult, Status};

fn run(text: &str) -> RunResult {
    let case = Case::parse("case.toml", text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let result = case.run(&Registry::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert!(matches!(result.status, Status::Ok), "{:?}\n{text}", result.diagnostics);
    result
}

fn e017(result: &RunResult) -> Vec<&Diagnostic> {
    result.warnings.iter().filter(|w| w.code == "E017").collect()
}

fn load<'a>(result: &'a RunResult, name: &str) -> &'a LoadReport {
    result.loads.get(name).unwrap_or_else(|| panic!("{name}: {:?}", result.loads))
}

fn plane(load: &LoadReport) -> f64 {
    let Some(Moment::Plane(m)) = load.moment else { panic!("{load:?}") };
    m
}

fn near(a: f64, b: f64, within: f64) {
    assert!((a - b).abs() <= within * b.abs().max(1e-300), "{a} for {b}");
}

const BLOCK: &str = "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1e3\npoisson = 0.3\n\
    [[patch]]\nname = \"b\"\ngeometry = { kind = \"box\", min = [0, 0], max = [10, 10] }\nelements = [10, 10]\n\
    [[boundary]]\non = \"b.bottom\"\nfix = [\"x\", \"y\"]\n";

fn pressed(width: f64, size: f64, more: &str) -> String {
    BLOCK.replace("[10, 10] }", &format!("[{:e}, {:e}] }}", 10.0 * size, 10.0 * size))
        + &format!("[[boundary]]\nname = \"top\"\non = \"b.top\"\npressure = \"if(x < {:e}, 1e-3, 0)\"\n{more}", width * size)
}

/// Three Gauss points per element: the part of a cut element that they see is 5/18, 13/18 or all of it.
#[test]
fn loads_are_what_is_integrated_and_the_part_that_is_missed_is_told() {
    for size in [1.0, 1e-4, 1e3] {
        for (width, seen) in
            [(2.3, 2.0 + 5.0 / 18.0), (2.5, 2.0 + 5.0 / 18.0), (0.1, 0.0), (0.02, 0.0), (9.9, 10.0), (3.0, 3.0), (10.0, 10.0)]
        {
            let result = run(&pressed(width, size, ""));
            let top = load(&result, "top");
            near(top.force[1], -1e-3 * size * seen, 1e-12);
            near(result.reactions.get("b.bottom").unwrap()[1], 1e-3 * size * seen, 1e-9);
            let found = e017(&result);
            if seen == width {
                assert!(found.is_empty(), "{width}: {found:?}");
                near(plane(top), -1e-3 * size * size * width * width / 2.0, 1e-12);
            } else {
                let [warning] = found[..] else { panic!("{width}, size {size}: {found:?}") };
                assert!(warning.message.contains("\"top\"") && warning.help.as_ref().unwrap().contains("breakpoints"), "{warning:?}");
                assert_eq!(warning.line, Some(18), "{warning:?}");
                // the force, or the moment about the middle of the load, is off by at least that
                let missed = 100.0 * (width - seen).abs() / width.max(seen);
                let told: f64 = warning.message.rsplit(", ").next().unwrap().split(' ').next().unwrap().parse().unwrap();
                assert!(told > 0.95 * missed, "{missed}: {warning:?}");
            }
        }
    }
}

/// Four points see half of an element that is cut in its middle, though not where: the force is right, its moment is not.
#[test]
fn a_moment_is_looked_at_beside_the_force() {
    let text = pressed(2.5, 1.0, "").replace("elements", "degree = 3\nelements");
    let result = run(&text);
    near(load(&result, "top").force[1], -2.5e-3, 1e-12);
    let off = (plane(load(&result, "top")) / (-1e-3 * 2.5 * 1.25) - 1.0).abs();
    assert!(off > 1e-3 && e017(&result).len() == 1, "{off}: {:?}", result.warnings);
    // on a finer mesh the same jump lies on an edge
    assert!(e017(&run(&text.replace("[10, 10]\n", "[20, 20]\n"))).is_empty());
}

#[test]
fn smooth_loads_on_coarse_meshes_and_curved_sides_are_not_told() {
    let coarse = BLOCK.replace("elements = [10, 10]", "elements = [2, 2]");
    for p in ["sin(pi*x/10)", "sin(pi*x/8)", "exp(x/5)", "x^3", "1 + x*y", "if(x < 5, 1, 2)", "abs(x - 5)", "max(x - 5, 0)"] {
        for backend in ["iga", "fe"] {
            let text = format!("{coarse}[[boundary]]\nname = \"top\"\non = \"b.top\"\npressure = \"1e-3*({p})\"\n");
            let text = text.replace("elements", &format!("backend = \"{backend}\"\nelements"));
            let result = run(&text);
            assert!(e017(&result).is_empty(), "{p}: {:?}", result.warnings);
        }
    }
    for cells in ["cells = \"tensor\"", "cells = \"simplex\"", "mapping = \"exact\""] {
        for backend in ["iga", "fe"] {
            let ring = BLOCK
                .replace(
                    "{ kind = \"box\", min = [0, 0], max = [10, 10] }",
                    "{ kind = \"annulus-sector\", radius = [1, 2], angle_deg = [0, 90] }",
                )
                .replace(
                    "elements = [10, 10]",
                    &format!("backend = \"{backend}\"\nelements = [2, 1]\n{}", if backend == "fe" { cells } else { "" }),
                )
                .replace("b.bottom", "b.u0");
            let text = ring + "[[boundary]]\nname = \"in\"\non = \"b.v0\"\npressure = 1e-2\n";
            let result = run(&text);
            assert!(e017(&result).is_empty(), "{cells}: {:?}", result.warnings);
            let force = &load(&result, "in").force;
            near(force[0], 1e-2, 1e-3);
            near(force[1], 1e-2, 1e-3);
        }
    }
}

#[test]
fn every_kind_of_load_has_its_resultant() {
    let text = BLOCK.to_owned()
        + "[[boundary]]\non = \"b.right\"\ntraction = { x = 1e-3 }\n[[boundary]]\non = [\"b.left\", \"b.top\"]\nforce = { y = -0.02 }\n";
    let text = text.replace("poisson = 0.3", "poisson = 0.3\ndensity = 1e-3").replace("dimension = 2", "dimension = 2\ngravity = [0, -2]");
    let result = run(&text);
    let names: Vec<&str> = result.loads.keys().map(String::as_str).collect();
    assert_eq!(names, ["b.body_force", "boundary-1", "boundary-2"]);
    near(load(&result, "b.body_force").force[1], -0.2, 1e-12);
    near(plane(load(&result, "b.body_force")), -1.0, 1e-12);
    near(load(&result, "boundary-1").force[0], 1e-2, 1e-12);
    near(plane(load(&result, "boundary-1")), -5e-2, 1e-12);
    // half of the force on each of two equal sides: moment -0.01 * 5
    near(load(&result, "boundary-2").force[1], -0.02, 1e-12);
    near(plane(load(&result, "boundary-2")), -0.05, 1e-12);
    let sum: f64 = result.loads.iter().map(|(_, l)| l.force[1]).sum();
    near(result.reactions.get("b.bottom").unwrap()[1], -sum, 1e-9);
    assert!(e017(&result).is_empty(), "{:?}", result.warnings);
    let probed = run(&(text + "[[probe]]\nname = \"F\"\nquantity = \"loads.boundary-2.force.1\"\n"));
    near(probed.probes[0].value, -0.02, 1e-12);
}

#[test]
fn loads_in_space_and_fluxes_have_resultants_and_warnings_too() {
    let solid = |breaks: &str| {
        format!(
            "[model]\nphysics = \"elasticity\"\ndimension = 3\n[[material]]\nname = \"m\"\nyoung = 1e3\npoisson = 0.3\n[[patch]]\nname = \"b\"\n\
             geometry = {{ kind = \"box\", min = [0, 0, 0], max = [1, 1, 1] }}\nelements = [{breaks}, 2, 1]\n[[boundary]]\non = \"b.bottom\"\n\
             fix = [\"x\", \"y\", \"z\"]\n[[boundary]]\nname = \"top\"\non = \"b.top\"\npressure = \"if(x < 0.3, 1, 0)\"\n"
        )
    };
    let cut = run(&solid("2"));
    assert_eq!(e017(&cut).len(), 1, "{:?}", cut.warnings);
    let sound = run(&solid("[0, 0.3, 1]"));
    assert!(e017(&sound).is_empty(), "{:?}", sound.warnings);
    let top = load(&sound, "top");
    near(top.force[2], -0.3, 1e-12);
    let Some(Moment::Space(m)) = &top.moment else { panic!("{top:?}") };
    near(m[0], -0.15, 1e-12);
    near(m[1], 0.045, 1e-12);
    for (breaks, warnings) in [("4", 2), ("[0, 0.3, 1]", 0)] {
        let text = format!(
            "[model]\nphysics = \"poisson\"\ndimension = 2\nsource = \"if(x < 0.3, 2, 0)\"\n[[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = [0, 0], \
             max = [1, 1] }}\nelements = [{breaks}, 3]\n[[boundary]]\non = \"a.bottom\"\ndirichlet = \"0\"\n[[boundary]]\nname = \"q\"\non = \"a.top\"\n\
             neumann = \"if(x < 0.3, 5, 1)\"\n"
        );
        let result = run(&text);
        assert_eq!(e017(&result).len(), warnings, "{:?}", result.warnings);
        let off = if warnings == 0 { 1e-12 } else { 0.3 };
        near(load(&result, "a.source").force[0], 0.6, off);
        near(load(&result, "q").force[0], 2.2, off);
        assert!(load(&result, "q").moment.is_none());
        let sum: f64 = result.loads.iter().map(|(_, l)| l.force[0]).sum();
        near(result.reactions.get("a.bottom").unwrap()[0].abs(), sum, 1e-9);
    }
}

#[test]
fn springs_moduli_densities_and_cut_facets_are_told() {
    let with = |young: &str, rest: &str| BLOCK.replace("young = 1e3", &format!("young = {young}")) + rest;
    let spring =
        |at: f64| with("1e3", &format!("[[boundary]]\nname = \"s\"\non = \"b.top\"\nspring = {{ y = \"if(x < {at}, 10, 0)\" }}\n"));
    for (at, count) in [(4.0, 0), (4.3, 1)] {
        let result = run(&spring(at));
        let found = e017(&result);
        assert!(found.len() == count && found.iter().all(|w| w.message.contains("springs of \"s\" along y")), "{found:?}");
        let result = run(&with(&format!("\"if(x < {at}, 1e3, 1e5)\""), ""));
        let found = e017(&result);
        assert!(found.len() == count && found.iter().all(|w| w.message.contains("modulus of patch \"b\"")), "{found:?}");
        let heavy = BLOCK
            .replace("dimension = 2", "dimension = 2\ngravity = [0, -1]")
            .replace("poisson = 0.3", &format!("poisson = 0.3\ndensity = \"if(y < {at}, 1e-3, 0)\""));
        let result = run(&heavy);
        let found = e017(&result);
        assert!(found.len() == count && found.iter().all(|w| w.message.contains("\"b.body_force\"")), "{found:?}");
        for what in ["pressure = 1e-3", "fix = [\"y\"]"] {
            let result = run(&with("1e3", &format!("[[boundary]]\nname = \"w\"\non = \"b.top\"\nwhere = \"x < {at}\"\n{what}\n")));
            let found = e017(&result);
            assert!(found.len() == count && found.iter().all(|w| w.message.contains("a length of 4 for the 4.3")), "{found:?}");
        }
    }
    // moduli that vary smoothly, strongly on coarse meshes
    for young in ["1e3*exp(x/3)", "1e3*(1 + x^2)", "1e3*(2 + sin(x))"] {
        let result = run(&with(&format!("\"{young}\""), "").replace("[10, 10]\n", "[4, 4]\n"));
        assert!(e017(&result).is_empty(), "{young}: {:?}", result.warnings);
    }
}

#[test]
fn loads_that_move_are_looked_at_in_every_step_and_by_check() {
    // on an edge at t = 1 and 3, inside of an element at t = 2.5
    let text =
        BLOCK.to_owned() + "[[boundary]]\nname = \"top\"\non = \"b.top\"\npressure = \"if(x < t, 1e-3, 0)\"\n[steps]\nt = [1, 2.5, 3]\n";
    let result = run(&text);
    let found = e017(&result);
    assert!(found.len() == 1 && found[0].message.contains("at t = 2.5"), "{found:?}");
    near(load(&result, "top").force[1], -3e-3, 1e-12);
    assert!(e017(&run(&text.replace("2.5", "2"))).is_empty());
    let case = Case::parse("case.toml", &text, &ReadOptions::default()).unwrap();
    let checked = faying_cli::run::check(&case, &Registry::default(), &RunOptions::default(), &RunControl::default()).result;
    assert_eq!((checked.exit, e017(&checked).len()), (0, 1), "{:?}", checked.warnings);
    near(load(&checked, "top").force[1], -3e-3, 1e-12);
    let document = checked.to_value();
    assert!(document["loads"]["top"]["moment"].is_number() && document.get("reactions").is_none(), "{document}");
}

/// A plate whose bottom has prescribed values.
fn plate(degree: usize, n: usize, backend: &str, value: &str) -> String {
    format!(
        "[model]\nphysics = \"poisson\"\ndimension = 2\n[discretization]\nbackend = \"{backend}\"\ndegree = {degree}\n\
         [[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [1, 1] }}\nelements = [{n}, {n}]\n\
         [[boundary]]\non = \"a.top\"\nfix = \"u\"\n[[boundary]]\non = \"a.bottom\"\ndirichlet = {value}\n"
    )
}

#[test]
fn prescribed_values_without_a_bound_are_told() {
    for backend in ["iga", "fe"] {
        for n in [2, 8, 32] {
            for degree in 1..=3 {
                for value in ["1/r", "1/x^2", "x^(-0.5)", "log(r)^3", "1/(x - 0.371)"] {
                    // fine meshes see the mean of what is not singular to 1e-3
                    if n == 32 && value.starts_with("log") {
                        continue;
                    }
                    let result = run(&plate(degree, n, backend, &format!("\"{value}\"")));
                    let [found] = e017(&result)[..] else { panic!("{value}, {degree}, {n}: {:?}", result.warnings) };
                    assert!(found.message.contains("the value of u prescribed on `a.bottom` is integrated inexactly"), "{found:?}");
                    assert!(found.line == Some(16) && found.help.as_ref().unwrap().contains("depend on the mesh"), "{found:?}");
                }
                let degree = degree + 1;
                for value in [
                    "\"sin(pi*x)\"",
                    "\"x^3 - x\"",
                    "\"exp(2*x)\"",
                    "\"abs(x - 0.5)\"",
                    "\"if(x < 0.37, 1, 2)\"",
                    "\"sin(3*pi*x)\"",
                    "\"r\"",
                    "0.3",
                ] {
                    // two elements have no three half waves
                    if n == 2 && value.contains("3*pi") {
                        continue;
                    }
                    let result = run(&plate(degree, n, backend, value));
                    assert!(e017(&result).is_empty(), "{value}, {degree}, {n}: {:?}", result.warnings);
                }
            }
        }
        // values of an exact solution that has no value in a corner
        for (u, warnings) in [("log(r)", 2), ("sin(20*x)*exp(-20*y)", 0), ("log(r + 1e-3)", 0)] {
            let text = plate(1, 2, backend, "\"exact\"").replace("dimension = 2", &format!("dimension = 2\nexact = {{ u = \"{u}\" }}"));
            let text = text.replace("on = \"a.bottom\"", "on = [\"a.bottom\", \"a.left\"]").replace("fix = \"u\"", "dirichlet = \"exact\"");
            let found = run(&text);
            let of_values = e017(&found).into_iter().filter(|w| w.message.contains("the value of u")).count();
            assert_eq!(of_values, warnings, "{u}: {:?}", found.warnings);
        }
    }
}

/// What no gravity and no pressure is.
#[test]
fn radial_gravity_and_pressures_on_seams_are_refused() {
    let refused = |text: &str| {
        let errors = Case::parse("case.toml", text, &ReadOptions::default()).and_then(|case| case.run(&Registry::default())).unwrap_err();
        (errors.items[0].code, errors.items[0].message.clone())
    };
    let body = |model: &str, rest: &str| {
        format!(
            "[model]\nphysics = \"elasticity\"\ndimension = 2\n{model}\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\ndensity = 2\n\
             [[patch]]\nname = \"s\"\nelements = [8, 2]\n{rest}\n"
        )
    };
    let block = "geometry = { kind = \"box\", min = [0, 0], max = [1, 2] }\n[[boundary]]\non = \"s.bottom\"\nfix = [\"x\", \"y\"]";
    let (code, message) = refused(&body("assumption = \"axisymmetric\"\ngravity = [-10, 0]", block));
    assert!(code == "E015" && message.contains("`gravity` along the radius is none"), "{code} {message}");
    assert_eq!(run(&body("assumption = \"axisymmetric\"\ngravity = [0, -10]", block)).exit, 0);
    let ring = |on: &str, what: &str| {
        let shape = "geometry = { kind = \"annulus-sector\", radius = [1, 2], angle_deg = [0, 360] }\nclosed = \"u\"\n[[boundary]]\non = \"s.v0\"\nfix = [\"x\", \"y\"]";
        body("", &format!("{shape}\n[[boundary]]\non = \"{on}\"\n{what}"))
    };
    let (code, message) = refused(&ring("s.u0", "pressure = 1.0"));
    assert!(code == "E015" && message.contains("`s.u0` is inside of its body, which is closed along u"), "{code} {message}");
    assert_eq!(run(&ring("s.v1", "pressure = 1e-3")).exit, 0);
    assert_eq!(run(&ring("s.u0", "fix = [\"x\"]")).exit, 0);
}

/// Values that change or jump within elements are told where functions miss more than 30 % of them, in the plane and in space.
#[test]
fn prescribed_values_that_the_mesh_does_not_have_are_told() {
    let missed = |text: &str| {
        let result = run(text);
        e017(&result).iter().filter(|w| w.message.contains("the mesh does not have the values of u prescribed on `a.bottom`")).count()
    };
    for backend in ["iga", "fe"] {
        for (n, value, wanted) in [
            (10, "sin(400*x)", 1),
            (10, "if(abs(x - 0.72) < 0.02, 1, 0)", 1),
            (10, "sin(10*x)", 0),
            (10, "if(x < 0.37, 1, 2)", 0),
            (200, "sin(400*x)", 0),
            // zero but for the rounding of the formula
            (10, "(x + 0.1) - x - 0.1", 0),
            (10, "1e-3*(sqrt(x^2 + 1) - sqrt(1 + x^2)) + 1e-16*sin(400*x)", 0),
        ] {
            assert_eq!(missed(&plate(2, n, backend, &format!("\"{value}\""))), wanted, "{backend} {n} {value}");
        }
        let solid = plate(2, 4, backend, "\"sin(400*x)\"")
            .replace("dimension = 2", "dimension = 3")
            .replace("max = [1, 1]", "max = [1, 1], extrude = 1");
        assert_eq!(missed(&solid.replace("[4, 4]", "[4, 4, 2]")), 1, "{backend}");
        // only at one of the steps
        let late = plate(2, 10, backend, "\"if(t > 1.5, sin(400*x), 0)\"").replace("[[patch]]", "[steps]\nt = [1, 2]\n[[patch]]");
        assert_eq!(missed(&late), 1, "{backend}");
    }
}

#[test]
fn values_of_an_exact_solution_that_are_not_finite_name_the_point_and_the_time() {
    let on = |side: &str, u: &str, steps: &str| {
        let text = plate(2, 4, "iga", "\"exact\"").replace("a.bottom", side);
        text.replace("dimension = 2", &format!("dimension = 2\nexact = {{ u = \"{u}\" }}"))
            .replace("[[patch]]", &format!("{steps}[[patch]]"))
    };
    for (text, words) in [
        (on("a.left", "1/x", ""), "the value of `a.left`: `1/x` is not finite at x = 0, y = 0.0"),
        (on("a.bottom", "sqrt(x - 0.5)", ""), "the value of `a.bottom`: `sqrt(x - 0.5)` is not finite at x = 0.0"),
        (on("a.bottom", "x/(t - 2)", "[steps]\nt = [1, 2]\n"), ", y = 0, t = 2 (found"),
        (on("a.u0v0", "1/x", ""), "the value of `a.u0v0`: `1/x` is not finite at x = 0, y = 0 (found"),
    ] {
        let case = Case::parse("case.toml", &text, &ReadOptions::default()).unwrap();
        let faults = case.run(&Registry::default()).unwrap_err();
        let [found] = &faults.items[..] else { panic!("{faults}") };
        assert!(found.code == "E017" && found.message.contains(words) && found.line.is_some(), "{words}\n{faults}");
    }
}
