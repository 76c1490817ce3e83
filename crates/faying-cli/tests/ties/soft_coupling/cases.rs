//! Whole runs: factors that are too small, time, contact beside a tie, ends that are held, results and files.

use super::sample::{Sample, error, probe, solved};
use faying_cli::Case;
use faying_cli::Registry;
use faying_cli::case::ReadOptions;

const SMOOTH: &str = "cos(3*x + 0.3)*exp(y) + sin(2*pi*x*y)";

// From the smallest factor that is accepted on the answer is right, whatever the factor is.
#[test]
fn every_factor_that_is_accepted_gives_the_right_answer() {
    for (degree, backends) in [(1, ["iga", "fe"]), (2, ["iga", "iga"]), (3, ["fe", "iga"])] {
        let with = |factor: f64, variant: &str| {
            let tie = format!("coupling = \"nitsche\"\nfactor = {factor:e}\nvariant = \"{variant}\"");
            error(&Sample { degree, backends, ..Sample::poisson(SMOOTH, &tie) }.run(), "u.H1")
        };
        let reference = with(4.0, "symmetric");
        for factor in [1e-6, 1e-3, 0.1, 0.5, 1.0, 1.5, 2.0, 1e2, 1e4, 1e6] {
            for variant in ["symmetric", "incomplete", "unsymmetric"] {
                if factor >= 1.0 || variant == "unsymmetric" {
                    let found = with(factor, variant);
                    assert!(found < 2.0 * reference, "p = {degree}, factor {factor}, {variant}: {found:e} {reference:e}");
                }
            }
        }
    }
}

#[test]
fn keys_that_soft_couplings_do_not_know_are_refused_with_a_remedy() {
    let refuses = |tie: &str, code: &str, part: &str| {
        let text = Sample::poisson(SMOOTH, tie).text();
        let found = match Case::parse("case.toml", &text, &ReadOptions::default()) {
            Err(found) => found,
            Ok(case) => case.run(&Registry::default()).expect_err(tie),
        };
        assert!(found.items.iter().any(|d| d.code == code && d.line.is_some() && d.render().contains(part)), "{tie}: {found}");
    };
    refuses("coupling = \"nitsche\"\nmultiplier = \"p/p\"", "E015", "`multiplier` is a key of couplings with a multiplier");
    refuses("coupling = \"nitsche\"\nvariant = \"incomplete\"\nfactor = 0.5", "E015", "stable for factors from 1 on");
    refuses("coupling = \"nitsche\"\nfactor = 0.9", "E015", "stable for factors from 1 on");
    refuses("coupling = \"penalty\"\nvariant = \"incomplete\"", "E015", "`variant` is not a key");
    refuses("coupling = \"mortar\"\nfactor = 10", "E015", "`factor` is not a key");
    refuses("coupling = \"nitsche\"\nfactor = -1", "E015", "factor");
    // auto may stand anywhere
    solved(&Sample::poisson(SMOOTH, "coupling = \"nitsche\"\nmultiplier = \"auto\"\nfactor = \"auto\"").text());
}

#[test]
fn materials_that_change_with_the_time_take_their_stabilisation_with_them() {
    let text = |steps: &str| {
        let tie = format!(
            "coupling = \"nitsche\"\n[[probe]]\nname = \"u\"\nquantity = \"u at [0.3, 0.6]\"\n\
             [[probe]]\nname = \"l\"\nquantity = \"interface.i.lambda at [0.7, 0.5]\"\n[steps]\nt = [{steps}]\n"
        );
        let materials = ["conductivity = \"1 + 1e3*(t - 1)\"".to_owned(), "conductivity = 2".to_owned()];
        Sample { materials, ..Sample::poisson("x + y^2", &tie) }.text()
    };
    let (all, last) = (solved(&text("1, 1.5, 2")), solved(&text("2")));
    for name in ["u", "l"] {
        let (a, b) = (probe(&all, name), probe(&last, name));
        assert!((a - b).abs() < 1e-12 * b.abs(), "{name}: {a} {b}");
    }
    let middle = solved(&text("1.5"));
    let step = all.steps[1].probes.iter().find(|p| p.name == "l").unwrap().value;
    assert!((step - probe(&middle, "l")).abs() < 1e-12 * step.abs());
    let first = all.steps[0].probes.iter().find(|p| p.name == "l").unwrap().value;
    assert!((step - first).abs() > 1e-2 * step.abs(), "the material does change: {step} {first}");
}

/// Three blocks on each other: the lower two tied, the upper one pressed on by contact.
fn tower(tie: &str, extra: &str) -> String {
    let block = |name: &str, y: f64, n: usize| {
        format!(
            "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"box\", min = [0, {y}], max = [1, {}] }}\nelements = [{n}, 2]\n",
            y + 0.5
        )
    };
    format!(
        "schema = 1\n[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 100\npoisson = 0.3\n{}{}{}\
         [[boundary]]\non = \"a.bottom\"\nfix = [\"y\"]\n[[boundary]]\non = [\"a.left\", \"b.left\", \"c.left\"]\nfix = [\"x\"]\n\
         [[boundary]]\non = \"c.top\"\npressure = \"PRESSURE\"\n[[interface]]\nname = \"i\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\n{tie}\n\
         [[contact]]\nname = \"k\"\nslave = \"c.bottom\"\nmaster = \"b.top\"\n{extra}\n",
        block("a", 0.0, 3),
        block("b", 0.5, 4),
        block("c", 1.0, 3)
    )
}

#[test]
fn contact_beside_a_tie_without_rows_is_that_beside_a_mortar_tie() {
    let with = |tie: &str, pressure: &str, solver: &str| {
        let extra = format!("[solver]\nconstraint = \"{solver}\"\n[[probe]]\nname = \"u\"\nquantity = \"u.y at [0.4, 1.5] in c\"");
        solved(&tower(tie, &extra).replace("PRESSURE", pressure))
    };
    for tie in ["coupling = \"nitsche\"", "coupling = \"nitsche\"\nvariant = \"incomplete\"", "coupling = \"penalty\"\nfactor = 1e9"] {
        let result = with(tie, "1", "auto");
        let contact = result.contact.get("k").unwrap();
        // a state of constant stress: exact
        assert!((contact.force[1] - 1.0).abs() < 1e-9 && (contact.pressure.max - 1.0).abs() < 1e-7, "{tie}: {contact:?}");
        assert!((contact.pressure.min - 1.0).abs() < 1e-7, "{tie}: {contact:?}");
        assert!(result.balance.force.iter().all(|f| f.abs() < 1e-10), "{tie}: {:?}", result.balance);
        assert!((result.reactions.get("a.bottom").unwrap()[1] - 1.0).abs() < 1e-9, "{tie}");
        // a state that opens: both ties are approximations of the same
        let (soft, hard) = (with(tie, "6*(x - 0.4)", "auto"), with("coupling = \"mortar\"", "6*(x - 0.4)", "auto"));
        let (a, b) = (probe(&soft, "u"), probe(&hard, "u"));
        assert!((a - b).abs() < 2e-2 * b.abs(), "{tie}: {a} {b}");
        let active = soft.contact.get("k").unwrap().active;
        assert!(active > 0 && active < hard.contact.get("k").unwrap().sign_cases.iter().sum::<usize>(), "{tie}: {active}");
    }
    let (a, b) = (with("coupling = \"nitsche\"", "1 + x", "saddle-point"), with("coupling = \"nitsche\"", "1 + x", "condensed"));
    assert!((probe(&a, "u") - probe(&b, "u")).abs() < 1e-9 * probe(&a, "u").abs());
}

#[test]
fn a_body_is_held_by_its_tie_alone_and_a_free_pair_is_refused() {
    let text = |fix: &str, coupling: &str| {
        format!(
            "schema = 1\n[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 100\npoisson = 0.3\n\
             [[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [1, 1] }}\nelements = [3, 3]\n\
             [[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [0, 1], max = [1, 2] }}\nelements = [4, 2]\n\
             {fix}[[boundary]]\non = \"b.top\"\ntraction = [1, 2]\n[[interface]]\nname = \"i\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\ncoupling = \"{coupling}\"\n"
        )
    };
    for coupling in ["nitsche", "penalty"] {
        let result = solved(&text("[[boundary]]\non = \"a.bottom\"\nfix = [\"x\", \"y\"]\n", coupling));
        let reaction = result.reactions.get("a.bottom").unwrap();
        assert!((reaction[0] + 1.0).abs() < 1e-9 && (reaction[1] + 2.0).abs() < 1e-9, "{coupling}: {reaction:?}");
        let case = Case::parse("case.toml", &text("", coupling), &ReadOptions::default()).unwrap();
        let refused = case.run(&Registry::default()).expect_err("nothing holds the pair");
        assert!(refused.to_string().contains("E051"), "{refused}");
    }
}

// A slave side whose unknowns are all prescribed over-constrains a multiplier; Nitsche's method has none.
#[test]
fn sides_that_are_held_and_cross_points_need_no_care_without_a_multiplier() {
    let text = |coupling: &str| {
        let block = |name: &str, x: f64, y: f64, n: usize| {
            format!(
                "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"box\", min = [{x}, {y}], max = [{}, {}] }}\nelements = [{n}, {n}]\n",
                x + 1.0,
                y + 1.0
            )
        };
        format!(
            "schema = 1\n[model]\nphysics = \"poisson\"\ndimension = 2\nexact = {{ u = \"2*x - y + 1\" }}\n{}{}{}{}\
             [[boundary]]\non = \"all-outer\"\ndirichlet = \"exact\"\n[[interface]]\nname = \"i\"\nbetween = \"all\"\ncoupling = \"{coupling}\"\n",
            block("a", 0.0, 0.0, 2),
            block("b", 1.0, 0.0, 3),
            block("c", 0.0, 1.0, 4),
            block("d", 1.0, 1.0, 5)
        )
    };
    for coupling in ["nitsche", "mortar"] {
        let result = solved(&text(coupling));
        assert!(error(&result, "u.L2") < 1e-10 && error(&result, "i.lambda.L2") < 1e-9, "{coupling}: {:?}", result.errors);
        assert_eq!(result.unknowns.multipliers == 0, coupling == "nitsche");
        assert!(result.interface.get("i").unwrap().balance < 1e-12);
    }
}

#[test]
fn lambda_of_nitsche_stands_in_probes_tables_and_files() {
    let folder = std::env::temp_dir().join(format!("faying-nitsche-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    // u = 3 y: k du/dy = 3 with k = 1 crosses; lambda is minus the slave's traction
    let tie = "coupling = \"nitsche\"\n[[probe]]\nname = \"l\"\nquantity = \"interface.i.lambda at [0.3, 0.5]\"";
    for (slave, lambda) in [(0, -3.0), (1, 3.0)] {
        let sample = Sample { slave, ..Sample::poisson("3*y", tie) };
        let result = sample.run();
        assert!((probe(&result, "l") - lambda).abs() < 1e-10, "{}", probe(&result, "l"));
        let interface = result.interface.get("i").unwrap();
        assert!((interface.lambda.norm - 3.0).abs() < 1e-10 && interface.jump.l2 < 1e-12, "{interface:?}");
        std::fs::write(folder.join("case.toml"), sample.text()).unwrap();
        let out = std::process::Command::new(env!("CARGO_BIN_EXE_faying"))
            .current_dir(&folder)
            .args(["run", "case.toml", "--force", "--vtu", "lagrange"])
            .output()
            .unwrap();
        assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
        let table = std::fs::read_to_string(folder.join("case.out/interface_i.csv")).unwrap();
        let lines: Vec<Vec<f64>> = table.lines().skip(1).map(|l| l.split(',').filter_map(|v| v.parse().ok()).collect()).collect();
        assert_eq!(lines.len(), interface.segments.count * 3, "one line per point");
        assert!(lines.iter().all(|l| (l[4] - lambda).abs() < 1e-10) && lines.windows(2).all(|w| w[0][0] < w[1][0]), "{table}");
        let vtu = std::fs::read(folder.join("case.out/interface_i.vtu")).unwrap();
        assert!(String::from_utf8_lossy(&vtu).contains("lambda") && folder.join("case.out/interface_i.svg").is_file());
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn the_predicted_memory_counts_what_stands_between_the_bodies() {
    let check = |coupling: &str| {
        let sample = Sample { elements: [[60, 30], [40, 20]], ..Sample::poisson(SMOOTH, &format!("coupling = \"{coupling}\"")) };
        let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_faying"))
            .args(["check", "-", "--json"])
            .stdin(std::process::Stdio::piped())
            .stdout(std::process::Stdio::piped())
            .spawn()
            .unwrap();
        std::io::Write::write_all(&mut child.stdin.take().unwrap(), sample.text().as_bytes()).unwrap();
        let out = child.wait_with_output().unwrap();
        let document: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
        document["predicted"]["entries"].as_f64().unwrap()
    };
    let (mortar, nitsche) = (check("mortar"), check("nitsche"));
    assert!(nitsche > mortar && nitsche < 1.5 * mortar, "{mortar} {nitsche}");
}
