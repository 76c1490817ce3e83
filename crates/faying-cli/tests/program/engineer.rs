//! Conditions as engineers state them, each against an exact solution, with both backends and over steps.

use faying_cli::Case;
use faying_cli::case::ReadOptions;
use faying_cli::{Progress, Registry, RunControl, RunOptions, RunResult, Status};
use std::f64::consts::PI;
use std::process::{Command, Stdio};

const BACKENDS: [&str; 2] = ["iga", "fe"];

fn read(text: &str) -> Case {
    Case::parse("case.toml", text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn run(text: &str) -> RunResult {
    let result = read(text).run(&Registry::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert_eq!(result.status, Status::Ok, "{:?} {:?}\n{text}", result.diagnostics, result.checks);
    result
}

/// The value of a probe at the end of every step.
fn history(result: &RunResult, name: &str) -> Vec<f64> {
    let of = |k: usize| result.steps[k].probes.iter().find(|p| p.name == name).unwrap().value;
    (0..result.steps.len()).map(of).collect()
}

fn probe(name: &str, quantity: &str) -> String {
    format!("[[probe]]\nname = \"{name}\"\nquantity = \"{quantity}\"\n")
}

fn close(found: f64, expected: f64, what: &str) {
    assert!((found - expected).abs() <= 1e-11 * expected.abs().max(1.0), "{what}: {found:e}, expected {expected:e}");
}

/// Elasticity without lateral strain on a column of width 1 and height 2, held along x on its left side.
fn column(backend: &str, material: &str, rest: &str) -> String {
    format!(
        "[model]\nphysics = \"elasticity\"\ndimension = 2\ngravity = [0, -10]\n[discretization]\nbackend = \"{backend}\"\ndegree = 2\n\
         [[material]]\nname = \"m\"\npoisson = 0\n{material}\n\
         [[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [1, 2] }}\nelements = [2, 3]\n\
         [[boundary]]\non = \"a.left\"\nfix = [\"x\"]\n{rest}"
    )
}

#[test]
fn a_column_under_its_own_weight_shortens_by_rho_g_h2_over_2e_at_every_time() {
    for backend in BACKENDS {
        let text = column(
            backend,
            "young = \"100/t\"\ndensity = \"3*t\"",
            &format!(
                "[[boundary]]\non = \"a.bottom\"\nfix = [\"y\"]\n[steps]\nt = [0.5, 1.0, 4.0]\n{}{}{}{}",
                probe("top", "u.y at [0.3, 2.0]"),
                probe("middle", "u.y at [0.3, 1.0]"),
                probe("foot", "stress.yy at [0.3, 0.0]"),
                probe("support", "reaction.a.bottom.y"),
            ),
        );
        let result = run(&text);
        for (k, t) in [0.5, 1.0, 4.0].into_iter().enumerate() {
            // E u'' = rho g, u(0) = 0, u'(2) = 0
            let (rho, young) = (3.0 * t, 100.0 / t);
            let u = |y: f64| -rho * 10.0 / young * (2.0 * y - y * y / 2.0);
            close(history(&result, "top")[k], u(2.0), backend);
            close(history(&result, "middle")[k], u(1.0), backend);
            close(history(&result, "foot")[k], -rho * 10.0 * 2.0, backend);
            close(history(&result, "support")[k], rho * 10.0 * 2.0, backend);
            assert_eq!(result.steps[k].t, t);
        }
        assert_eq!(result.t, Some(4.0));
        assert_eq!(result.probes, result.steps[2].probes);
    }
}

#[test]
fn a_spring_and_a_bar_in_series_add_their_compliances_at_every_time() {
    for backend in BACKENDS {
        let text = column(
            backend,
            "young = \"50*(1 + t)\"\ndensity = 0",
            &format!(
                "[[boundary]]\non = \"a.bottom\"\nspring = {{ y = \"20*t\" }}\n[[boundary]]\non = \"a.top\"\ntraction = {{ y = \"6*t\" }}\n\
                 [steps]\ncount = 4\n{}{}",
                probe("top", "u.y at [1.0, 2.0]"),
                probe("bottom", "u.y at [0.5, 0.0]"),
            ),
        );
        let result = run(&text);
        for k in 0..4 {
            let t = (k + 1) as f64 / 4.0;
            close(history(&result, "bottom")[k], 6.0 * t / (20.0 * t), backend);
            close(history(&result, "top")[k], 6.0 * t / (20.0 * t) + 6.0 * t * 2.0 / (50.0 * (1.0 + t)), backend);
        }
        // springs count among the forces
        assert!(result.balance.force.iter().all(|f| f.abs() < 1e-11), "{:?}", result.balance);
    }
}

/// A quarter of a ring that is clamped at one end: no field in it is simple.
fn wedge(backend: &str, top: &str) -> String {
    format!(
        "[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\nbackend = \"{backend}\"\ndegree = 3\n\
         [[material]]\nname = \"m\"\nyoung = \"1 + x^2\"\npoisson = 0.3\n\
         [[patch]]\nname = \"a\"\ngeometry = {{ kind = \"annulus-sector\", center = [0, 0], radius = [1, 2], angle_deg = [0, 90] }}\n\
         elements = [4, 3]\n[[boundary]]\non = \"a.u1\"\nfix = [\"x\", \"y\"]\n{top}[steps]\nt = [0.5, 2.0]\n{}{}{}",
        probe("end", "u.y at [1.5, 0.0]"),
        probe("other", "u.y at [1.1, 0.0]"),
        probe("held", "reaction.a.u0.y"),
    )
}

#[test]
fn a_side_that_moves_as_one_takes_the_force_that_the_same_prescribed_motion_asks_for() {
    for backend in BACKENDS {
        let pushed = run(&wedge(backend, "[[boundary]]\non = \"a.u0\"\nrigid_force = { y = \"-0.3*t\" }\n"));
        let moved = history(&pushed, "end");
        let scale = moved[1].abs();
        assert!(moved[1] < -0.1, "{moved:?}");
        assert!((history(&pushed, "other")[0] - moved[0]).abs() < 1e-12 * scale, "the side moves as one");
        // linear: the motion follows the force
        assert!((moved[1] - 4.0 * moved[0]).abs() < 1e-11 * scale, "{moved:?}");
        let motion = format!("[[boundary]]\non = \"a.u0\"\ndirichlet = {{ y = \"{:.17e}*t\" }}\n", moved[1] / 2.0);
        let held = run(&wedge(backend, &motion));
        for (k, t) in [0.5, 2.0].into_iter().enumerate() {
            close(history(&held, "held")[k], -0.3 * t, backend);
        }
    }
}

#[test]
fn polynomial_solutions_of_the_time_are_met_when_material_source_and_data_follow_it() {
    for backend in BACKENDS {
        // plane stress makes a rational function of lambda and mu: points enough to integrate it. k du/dn is constant along the interface: in the multiplier's space
        let tied = "[[patch]]\nname = \"b\"\ngeometry = { kind = \"box\", min = [1, 0], max = [2, 2] }\nelements = [3, 4]\n\
                    [[interface]]\nname = \"i\"\nslave = \"b.left\"\nmaster = \"a.right\"\n\
                    [[boundary]]\non = \"b.right\"\ndirichlet = \"exact\"\n[[boundary]]\non = [\"b.top\", \"b.bottom\"]\nneumann = \"exact\"\n\
                    [[probe]]\nname = \"lambda\"\nquantity = \"error.i.lambda.L2.rel\"\n";
        let alone = "[[boundary]]\non = \"a.right\"\nneumann = \"exact\"\n";
        for (model, material, rest) in [
            ("physics = \"poisson\"\nexact = { u = \"t*x^2 - y^2 + t^2\" }", "conductivity = \"1 + t*x\"", tied),
            (
                "physics = \"elasticity\"\nexact = { u = [\"t*x^2 - y^2\", \"x*y + t^2\"] }",
                "young = \"2 + t*x*y\"\npoisson = \"0.1 + 0.1*t\"",
                alone,
            ),
            (
                "physics = \"elasticity\"\nassumption = \"plane-stress\"\nexact = { u = [\"t*x^2 - y^2\", \"x*y + t^2\"] }",
                "lambda = \"t + x\"\nmu = \"1 + y*t\"",
                alone,
            ),
        ] {
            let text = format!(
                "[model]\ndimension = 2\n{model}\n[discretization]\nbackend = \"{backend}\"\ndegree = 2\nextra_points = 8\n\
                 [[material]]\nname = \"m\"\n{material}\n\
                 [[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [1, 2] }}\nelements = [2, 3]\n\
                 [[boundary]]\non = [\"a.left\", \"a.top\"]\ndirichlet = \"exact\"\n\
                 [[boundary]]\non = \"a.bottom\"\nneumann = \"exact\"\n{rest}[steps]\nt = [0.5, 1.0, 3.0]\n{}{}",
                probe("u", "error.u.L2.rel"),
                probe("du", "error.u.energy.rel"),
            );
            let result = run(&text);
            for name in result.probes.iter().map(|p| &p.name) {
                let errors = history(&result, name);
                assert!(errors.iter().all(|e| *e < 1e-10), "{name} {errors:?}\n{text}");
            }
        }
    }
}

#[test]
fn a_bar_on_inclined_rollers_follows_hooke_along_its_own_axes() {
    // a bar of length 3 and height 1, turned by 30 degrees; s along it, n across; plane strain
    let (young, nu, pull): (f64, f64, f64) = (200.0, 0.25, 4.0);
    let (c, s) = ((PI / 6.0).cos(), (PI / 6.0).sin());
    for backend in BACKENDS {
        let bar = |nu: f64, supports: &str| {
            format!(
                "[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\nbackend = \"{backend}\"\ndegree = 2\n\
                 [[material]]\nname = \"m\"\nyoung = {young}\npoisson = {nu}\n\
                 [[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [3, 1], rotate_deg = 30 }}\nelements = [3, 2]\n\
                 {supports}[[boundary]]\non = \"a.right\"\ntraction = [\"{:.17e}*t\", \"{:.17e}*t\"]\n[steps]\ncount = 2\n{}{}",
                pull * c,
                pull * s,
                probe("x", &format!("u.x at [{:.17}, {:.17}]", 3.0 * c - s, 3.0 * s + c)),
                probe("y", &format!("u.y at [{:.17}, {:.17}]", 3.0 * c - s, 3.0 * s + c)),
            )
        };
        let sliding = "[[boundary]]\non = [\"a.bottom\", \"a.left\"]\nfix = [\"normal\"]\n";
        let held = "[[boundary]]\non = [\"a.bottom\"]\nfix = [\"normal\"]\n[[boundary]]\non = \"a.left\"\nfix = [\"normal\", \"tangential\"]\n\
                    [[boundary]]\non = \"a.right\"\nfix = [\"tangential\"]\n";
        for (nu, supports) in [(nu, sliding), (0.0, held)] {
            let result = run(&bar(nu, supports));
            for k in 0..2 {
                let t = (k + 1) as f64 / 2.0;
                // strains of a plane strain bar pulled along s
                let (along, across) = (pull * t * (1.0 - nu * nu) / young * 3.0, -pull * t * nu * (1.0 + nu) / young);
                close(history(&result, "x")[k], c * along - s * across, backend);
                close(history(&result, "y")[k], s * along + c * across, backend);
            }
            assert!(result.balance.force.iter().all(|f| f.abs() < 1e-11), "{:?}", result.balance);
        }
    }
}

/// Two columns side by side, of heights 1 and 3, fixed below, the same material without lateral strain.
fn columns(backend: &str, load: &str) -> String {
    format!(
        "[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\nbackend = \"{backend}\"\n\
         [[material]]\nname = \"m\"\nyoung = 10\npoisson = 0\n\
         [[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [1, 1] }}\nelements = [2, 2]\n\
         [[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [2, 0], max = [5, 3] }}\nelements = [2, 2]\n\
         [[boundary]]\non = [\"a.bottom\", \"b.bottom\"]\nfix = [\"x\", \"y\"]\n[[boundary]]\non = [\"a.top\", \"b.top\"]\n{load}\n\
         [steps]\nt = [1, 2]\n{}{}{}{}",
        probe("a", "u.y at [0.5, 1.0]"),
        probe("b", "u.y at [3.0, 3.0]"),
        probe("ra", "reaction.a.bottom.y"),
        probe("rb", "reaction.b.bottom.y"),
    )
}

#[test]
fn the_resultant_of_a_list_of_sides_is_spread_over_all_of_them() {
    for backend in BACKENDS {
        // 8 t over a length of 4: traction -2 t on both
        let spread = run(&columns(backend, "force = { y = \"-8*t\" }"));
        // the same motion of both: stiffness 10 * 1 / 1 and 10 * 3 / 3, so each takes half
        let plate = run(&columns(backend, "rigid_force = { y = \"-8*t\" }"));
        for (k, t) in [1.0, 2.0].into_iter().enumerate() {
            close(history(&spread, "a")[k], -2.0 * t / 10.0, backend);
            close(history(&spread, "b")[k], -2.0 * t / 10.0 * 3.0, backend);
            close(history(&spread, "ra")[k], 2.0 * t, backend);
            close(history(&spread, "rb")[k], 6.0 * t, backend);
            close(history(&plate, "a")[k], -0.4 * t, backend);
            close(history(&plate, "b")[k], -0.4 * t, backend);
            close(history(&plate, "ra")[k], 4.0 * t, backend);
            close(history(&plate, "rb")[k], 4.0 * t, backend);
        }
    }
}

/// A column of height 2 that an obstacle above presses on as it moves.
fn pressed(backend: &str, motion: &str, steps: &str) -> String {
    column(
        backend,
        "young = 80\ndensity = 0",
        &format!(
            "[[boundary]]\non = \"a.bottom\"\nfix = [\"y\"]\n[[contact]]\nname = \"pad\"\nslave = \"a.top\"\n\
             rigid = {{ kind = \"half-plane\", point = [0, 2.05], normal = [0, -1], move = {{ y = \"{motion}\" }} }}\n\
             [steps]\n{steps}\n{}{}",
            probe("top", "u.y at [0.5, 2.0]"),
            probe("force", "contact.pad.force.y"),
        ),
    )
}

#[test]
fn an_obstacle_that_comes_and_goes_presses_while_it_is_there() {
    for backend in BACKENDS {
        for start in ["all", "none", "gap"] {
            let text = pressed(backend, "-0.1*sin(pi*t)", "count = 12")
                .replace("slave = \"a.top\"", &format!("slave = \"a.top\"\nactive_set = {{ start = \"{start}\" }}"));
            let result = run(&text);
            assert_eq!(result.steps.len(), 12);
            for (k, step) in result.steps.iter().enumerate() {
                let t = (k + 1) as f64 / 12.0;
                let depth = (0.1 * (PI * t).sin() - 0.05).max(0.0);
                close(history(&result, "top")[k], -depth, start);
                close(history(&result, "force")[k], -80.0 * depth / 2.0, start);
                let pad = step.contact.get("pad").unwrap();
                // where both just touch either answer is right
                if (0.1 * (PI * t).sin() - 0.05).abs() > 1e-9 {
                    assert_eq!(pad.active > 0, depth > 0.0, "step {k}: {pad:?}");
                }
                // the set of the step before is the first guess: it settles at once unless contact opened or closed
                let before = |t: f64| 0.1 * (PI * t).sin() > 0.05 + 1e-9;
                if k > 0 && before(t) == before(t - 1.0 / 12.0) && depth != 0.0 {
                    assert_eq!(pad.iterations, 1, "step {k}, start {start}");
                }
            }
        }
    }
}

#[test]
fn the_last_of_many_steps_is_the_single_step_at_its_time() {
    for backend in BACKENDS {
        let many = run(&pressed(backend, "-0.08*t", "t = [0.1, 0.7, 0.9, 1.0]"));
        let one = run(&pressed(backend, "-0.08*t", "t = [1.0]"));
        let without = run(&pressed(backend, "-0.08*t", "t = [1.0]").replace("[steps]\nt = [1.0]\n", ""));
        for (a, b) in [(&many, &one), (&one, &without)] {
            close(a.energy, b.energy, backend);
            assert_eq!(a.contact.get("pad").unwrap().active, b.contact.get("pad").unwrap().active);
        }
        assert_eq!((one.steps.len(), without.steps.len(), without.t), (1, 0, None));
        assert!(without.to_value().get("t").is_none());
    }
}

/// A block that only its contact holds: pressed down at first, lifted at the end.
const LIFTED: &str = r#"
[model]
physics = "elasticity"
dimension = 2
[[material]]
name = "m"
young = 10
poisson = 0.3
[[patch]]
name = "a"
geometry = { kind = "box", min = [0, 0], max = [1, 1] }
elements = [2, 2]
[[boundary]]
on = "a.left"
fix = ["x"]
[[boundary]]
on = "a.top"
traction = { y = "t - 2.5" }
[[contact]]
name = "pad"
slave = "a.bottom"
rigid = { kind = "half-plane", point = [0, 0], normal = [0, 1] }
[steps]
t = [1, 2, 3, 4]
[[probe]]
name = "top"
quantity = "contact.pad.force.y"
[[check]]
quantity = "contact.pad.force.y"
above = -10
"#;

#[test]
fn a_step_that_fails_leaves_the_steps_before_it() {
    let finished = faying_cli::run::run(&read(LIFTED), &Registry::default(), &RunOptions::default(), &RunControl::default());
    let result = &finished.result;
    assert_eq!((result.status, result.exit), (Status::Singular, 5), "{:?}", result.diagnostics);
    let statuses: Vec<Status> = result.steps.iter().map(|s| s.status).collect();
    assert_eq!(statuses, [Status::Ok, Status::Ok, Status::Singular]);
    close(result.steps[0].probes[0].value, 1.5, "force at t = 1");
    close(result.steps[1].probes[0].value, 0.5, "force at t = 2");
    let said = &result.diagnostics[0].message;
    assert!(
        said.starts_with("step 3, t = 3: infeasible load: nothing holds body \"a\" against its load in translation y: a force (0, -0.5)"),
        "{said}"
    );
    // checks speak of the end, which was not reached
    assert!(!result.checks[0].ok && result.checks[0].reason.as_deref() == Some("nothing was solved"), "{:?}", result.checks);
    assert!(finished.output.is_some() && finished.steps.len() >= 2);
}

#[test]
fn a_run_that_is_interrupted_between_steps_keeps_those_that_were_solved() {
    let interrupted = std::sync::Arc::new(std::sync::atomic::AtomicBool::new(false));
    let flag = interrupted.clone();
    let listener = move |news: Progress<'_>| {
        if matches!(news, Progress::Step { step: 2, .. }) {
            flag.store(true, std::sync::atomic::Ordering::Relaxed);
        }
    };
    let watch = RunControl { interrupted, listener: Some(Box::new(listener)), ..RunControl::default() };
    let finished = faying_cli::run::run(&read(LIFTED), &Registry::default(), &RunOptions::default(), &watch);
    let result = &finished.result;
    assert_eq!((result.status, result.exit), (Status::Interrupted, 130));
    assert_eq!((result.steps[0].status, finished.steps.len(), result.t), (Status::Ok, 1, Some(1.0)));
    assert!(result.solved && finished.output.is_some());
}

#[test]
fn what_is_wrong_at_a_later_time_is_found_before_anything_is_solved() {
    let base = LIFTED.replace("t = [1, 2, 3, 4]", "t = [0.5, 1, 2]");
    for (from, to, code, part) in [
        ("poisson = 0.3", "poisson = \"0.2*t + 0.1\"", "E053", "t = 2"),
        ("young = 10", "young = \"1.5 - t\"", "E053", "t = 2"),
        ("\"t - 2.5\"", "\"1/(t - 1)\"", "E017", "t = 1"),
        ("fix = [\"x\"]", "dirichlet = { x = \"log(1.5 - t)\" }", "E017", "t = 2"),
        ("[[contact]]", "[[boundary]]\non = \"a.bottom\"\ndirichlet = { x = \"max(0, t - 1)\" }\n[[contact]]", "E052", "t = 2"),
        ("t = [0.5, 1, 2]", "t = [0.5, 0.5]", "E015", "must increase"),
        ("t = [0.5, 1, 2]", "t = []", "E014", "times"),
        ("t = [0.5, 1, 2]", "count = 0", "E015", "count"),
        ("t = [0.5, 1, 2]", "t = [1]\ncount = 2", "E015", "beside"),
    ] {
        let text = base.replacen(from, to, 1);
        let found = match Case::parse("case.toml", &text, &ReadOptions::default()) {
            Err(found) => found,
            Ok(case) => case.run(&Registry::default()).expect_err(to),
        };
        assert!(found.items.iter().any(|d| d.code == code && d.render().contains(part)), "{to}: {found}");
    }
}

#[test]
fn steps_write_numbered_fields_collections_and_a_history() {
    let folder = tempfile::tempdir().unwrap();
    let go = |name: &str, text: &str, words: &[&str]| {
        std::fs::write(folder.path().join(name), text).unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_faying"));
        command.current_dir(folder.path()).stdin(Stdio::null()).args(["run", name]).args(words).output().unwrap()
    };
    let out = go("push.toml", &pressed("iga", "-0.1*t", "t = [0.25, 0.75, 1]"), &[]);
    assert_eq!(out.status.code(), Some(0), "{}", String::from_utf8_lossy(&out.stderr));
    let at = folder.path().join("push.out");
    let names = |at: &std::path::Path| {
        let mut all: Vec<String> = std::fs::read_dir(at).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        all.sort();
        all
    };
    let expected = [
        "active_set.svg",
        "case.effective.toml",
        "fields.pvd",
        "fields.svg",
        "fields_0001.vtu",
        "fields_0002.vtu",
        "fields_0003.vtu",
        "history.csv",
        "interface_pad.csv",
        "interface_pad.pvd",
        "interface_pad.svg",
        "interface_pad_0001.vtu",
        "interface_pad_0002.vtu",
        "interface_pad_0003.vtu",
        "log.txt",
        "manifest.json",
        "report.html",
        "result.json",
    ];
    assert_eq!(names(&at), expected);
    let history = std::fs::read_to_string(at.join("history.csv")).unwrap();
    let lines: Vec<Vec<&str>> = history.lines().map(|l| l.split(',').collect()).collect();
    assert_eq!(lines.len(), 4);
    assert_eq!(lines[0][..5], ["t", "status", "top", "force", "contact.pad.force.x"]);
    let number = |row: usize, column: &str| -> f64 { lines[row][lines[0].iter().position(|c| *c == column).unwrap()].parse().unwrap() };
    close(number(2, "top"), -0.025, "second step");
    close(number(3, "contact.pad.force.y"), -2.0, "third step");
    assert_eq!((number(1, "t"), number(1, "contact.pad.active"), lines[1][1]), (0.25, 0.0, "ok"));
    let collection = std::fs::read_to_string(at.join("fields.pvd")).unwrap();
    assert!(collection.contains("timestep=\"0.75\" group=\"\" part=\"0\" file=\"fields_0002.vtu\""), "{collection}");
    let result: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(at.join("result.json")).unwrap()).unwrap();
    assert_eq!((result["steps"].as_array().unwrap().len(), result["t"].as_f64()), (3, Some(1.0)));
    assert_eq!(result["steps"][1]["status"], "ok");
    assert_eq!(result["probes"], result["steps"][2]["probes"]);
    for file in result["files"].as_array().unwrap() {
        assert!(at.join(file.as_str().unwrap()).exists(), "{file}");
    }
    let effective = std::fs::read_to_string(at.join("case.effective.toml")).unwrap();
    assert!(effective.contains("[steps]") && effective.contains("0.75"), "{effective}");
    // fewer steps of the same case: what the longer run wrote is gone
    let out = go("push.toml", &pressed("iga", "-0.1*t", "count = 1"), &["--vtu", "none"]);
    assert_eq!(out.status.code(), Some(0), "{}", String::from_utf8_lossy(&out.stderr));
    assert!(names(&at).iter().all(|n| !n.ends_with(".vtu") && !n.ends_with(".pvd")), "{:?}", names(&at));

    // a step that fails: everything so far
    let out = go("lifted.toml", LIFTED, &[]);
    assert_eq!(out.status.code(), Some(5));
    let at = folder.path().join("lifted.out");
    let all = names(&at);
    for name in ["fields_0001.vtu", "fields_0002.vtu", "fields.pvd", "history.csv", "result.json"] {
        assert!(all.iter().any(|n| n == name), "{name} is missing from {all:?}");
    }
    assert_eq!(std::fs::read_to_string(at.join("history.csv")).unwrap().lines().count(), 4);
}

/// A solid or plate of E = 10 with `elements` 2 per direction.
fn block(backend: &str, dimension: usize, poisson: f64, geometry: &str, rest: &str) -> String {
    let elements = &"2, 2, 2"[..3 * dimension - 2];
    format!(
        "[model]\nphysics = \"elasticity\"\ndimension = {dimension}\n[discretization]\nbackend = \"{backend}\"\ndegree = 2\n\
         [[material]]\nname = \"m\"\nyoung = 10\npoisson = {poisson}\n\
         [[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", {geometry} }}\nelements = [{elements}]\n{rest}"
    )
}

fn balanced(result: &RunResult, what: &str) {
    use faying_cli::result::Moment;
    let moment = match result.balance.moment.clone().unwrap() {
        Moment::Plane(m) => vec![m],
        Moment::Space(m) => m,
    };
    assert!(result.balance.force.iter().chain(&moment).all(|v| v.abs() < 1e-10), "{what}: {:?}", result.balance);
}

/// The reactions of `result` are those of `expected`, in no order.
fn reacts(result: &RunResult, expected: &[(&str, &[f64])], what: &str) {
    for (label, force) in expected {
        let found = result.reactions.get(*label).unwrap();
        let same = found.len() == force.len() && found.iter().zip(*force).all(|(a, b)| (a - b).abs() < 1e-10);
        assert!(same, "{what}: {label} {found:?}, expected {force:?}");
    }
}

#[test]
fn forces_and_moments_balance_where_sides_slide_along_inclines_or_move_as_one() {
    let slide = |sides: &str| format!("[[boundary]]\non = [{sides}]\nfix = [\"normal\"]\n");
    let clamp = "[[boundary]]\non = \"b.w0\"\nfix = [\"x\", \"y\", \"z\"]\n";
    let solid = "min = [0, 0, 0], max = [1, 2, 3]";
    let tilted = format!("{solid}, rotate_deg = 30, axis = [0, 1, 0], move = [1, 1, 1]");
    let normals = slide("\"b.u0\", \"b.v0\", \"b.w0\"");
    let held = "[[boundary]]\non = \"b.w0\"\nfix = [\"normal\", \"tangential\"]\n[[boundary]]\non = \"b.w1\"\ntraction = [1, 2, 3]\n";
    let cases = [
        (3, format!("{solid}, rotate_deg = 50, axis = [1, 2, 3]"), format!("{normals}[[boundary]]\non = \"b.u1\"\nforce = {{ x = 4, y = 3 }}\n")),
        (3, tilted, held.to_string()),
        (3, solid.to_string(), format!("{clamp}[[boundary]]\non = \"b.w1\"\nrigid_force = {{ z = -4 }}\n")),
        (3, solid.to_string(), format!("{clamp}[[boundary]]\non = \"b.w1\"\nrigid_force = {{ z = 0 }}\n[[boundary]]\non = \"b.w1\"\ntraction = {{ x = 1 }}\n")),
        (2, "min = [0, 0], max = [1, 2], rotate_deg = 37".into(), format!("{}[[boundary]]\non = \"b.u1\"\nforce = {{ x = 1.5, y = 1 }}\n", slide("\"b.u0\", \"b.v0\""))),
        (
            2,
            "min = [0, 0], max = [1, 3]".into(),
            "[[boundary]]\non = \"b.bottom\"\nfix = [\"x\", \"y\"]\n[[boundary]]\non = \"b.top\"\nrigid_force = { y = 0 }\ntraction = { x = 1 }\n".into(),
        ),
    ];
    for backend in BACKENDS {
        for (dimension, geometry, rest) in &cases {
            balanced(&run(&block(backend, *dimension, 0.3, geometry, rest)), &format!("{backend}: {geometry}\n{rest}"));
        }
    }
}

#[test]
fn supports_that_share_an_edge_carry_what_they_hold() {
    let (solid, plate) = ("min = [0, 0, 0], max = [1, 2, 3]", "min = [0, 0], max = [1, 3]");
    let slide = |sides: &str| format!("[[boundary]]\non = [{sides}]\nfix = [\"normal\"]\n");
    let press = |side: &str| format!("[[boundary]]\non = \"b.{side}\"\npressure = 2\n");
    let root = 3f64.sqrt();
    for backend in BACKENDS {
        let go = |dimension: usize, geometry: &str, rest: &str, expected: &[(&str, &[f64])]| {
            let result = run(&block(backend, dimension, 0.0, geometry, rest));
            let what = format!("{backend}: {geometry}\n{rest}");
            reacts(&result, expected, &what);
            balanced(&result, &what);
        };
        let rest = format!(
            "[[boundary]]\non = \"b.w0\"\nfix = [\"x\", \"y\", \"z\"]\n[[boundary]]\non = \"b.v1\"\nrigid_force = {{ x = 0 }}\n{}",
            press("w1")
        );
        go(3, solid, &rest, &[("b.bottom", &[0.0, 0.0, 4.0]), ("b.back", &[0.0; 3])]);
        let rest = format!(
            "[[boundary]]\non = \"b.bottom\"\nfix = [\"x\", \"y\"]\n[[boundary]]\non = \"b.right\"\nrigid_force = {{ x = 0 }}\n{}",
            press("top")
        );
        go(2, plate, &rest, &[("b.bottom", &[0.0, 2.0]), ("b.right", &[0.0; 2])]);
        let rest = format!("[[boundary]]\non = \"b.w0\"\nfix = [\"z\"]\n{}{}", slide("\"b.u0\", \"b.v0\""), press("w1"));
        go(
            3,
            &format!("{solid}, rotate_deg = 30, axis = [0, 0, 1]"),
            &rest,
            &[("b.bottom", &[0.0, 0.0, 4.0]), ("b.left", &[0.0; 3]), ("b.front", &[0.0; 3])],
        );
        let rest = format!("{}{}", slide("\"b.bottom\", \"b.u0\""), press("top"));
        go(2, &format!("{plate}, rotate_deg = 30"), &rest, &[("b.bottom", &[-1.0, root]), ("b.left", &[0.0; 2])]);
    }
}

#[test]
fn glued_sides_of_different_sizes_carry_a_uniform_stress_by_their_areas() {
    for backend in BACKENDS {
        let rest = "[[patch]]\nname = \"c\"\ngeometry = { kind = \"box\", min = [1, 0, 0], max = [3, 2, 3] }\nelements = [2, 2, 2]\n\
                    [[boundary]]\non = [\"b.w0\", \"c.w0\"]\nfix = [\"z\"]\n[[boundary]]\non = \"b.u0\"\nfix = [\"x\"]\n\
                    [[boundary]]\non = [\"b.v0\", \"c.v0\"]\nfix = [\"y\"]\n[[boundary]]\non = [\"b.w1\", \"c.w1\"]\nrigid_force = { z = -6 }\n\
                    [[interface]]\nname = \"g\"\nslave = \"b.u1\"\nmaster = \"c.u0\"\ncoupling = \"glue\"\n";
        let result = run(&block(backend, 3, 0.3, "min = [0, 0, 0], max = [1, 2, 3]", rest));
        reacts(
            &result,
            &[("b.bottom", &[0.0, 0.0, 2.0]), ("c.bottom", &[0.0, 0.0, 4.0]), ("b.top", &[0.0; 3]), ("c.top", &[0.0; 3])],
            backend,
        );
        balanced(&result, backend);
    }
}
