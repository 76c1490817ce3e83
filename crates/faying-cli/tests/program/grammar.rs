//! The table of keys: what the reader, the schema, `faying explain` and the reference make of its rows.

use faying_cli::case::reference::{find, keys, reference};
use faying_cli::case::{Absent, Names, ReadOptions};
use faying_cli::{Case, Registry};
use std::path::Path;
use std::process::{Command, Output};

fn explain(words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_faying")).arg("explain").args(words).output().unwrap()
}

fn stdout(out: Output) -> String {
    assert_eq!(out.status.code(), Some(0), "{}", String::from_utf8_lossy(&out.stderr));
    String::from_utf8(out.stdout).unwrap()
}

/// Cases in which every block stands, with a mark where a key of it may be added.
fn scenes() -> Vec<String> {
    let plane = "[model]\nphysics = \"elasticity\"\ndimension = 2\n#model\n[[material]]\nname = \"m\"\nyoung = 1\npoisson = 0.3\ndensity = 1\n#material\n\
        [[patch]]\nname = \"a\"\ngeometry = { kind = \"box\", min = [0, 0], max = [1, 1] }\nelements = [2, 2]\n#patch\n\
        [[patch]]\nname = \"b\"\ngeometry = { kind = \"box\", min = [1, 0], max = [2, 1] }\nelements = [2, 2]\n\
        [[boundary]]\non = \"a.left\"\nfix = [\"x\", \"y\"]\n[[boundary]]\non = \"b.top\"\n#boundary\nforce = 1\n\
        [[interface]]\nslave = \"a.right\"\nmaster = \"b.left\"\n#interface\n\
        [[contact]]\nslave = \"a.bottom\"\nrigid = { kind = \"half-plane\", point = [0, -1], normal = [0, 1] }\n#contact\n\
        [solver]\n#solver\n[[check]]\nquantity = \"energy\"\nbelow = 1\n#check\n";
    let without = |text: &str, from: &str, to: &str| {
        let (a, b) = (text.find(from).unwrap(), text.find(to).unwrap());
        format!("{}{}", &text[..a], &text[b..])
    };
    let plane = plane.replace("force = 1\n", "force = [0, 1]\n");
    let poisson = without(&plane, "[[contact]]", "[solver]")
        .replace("\"elasticity\"", "\"poisson\"")
        .replace("young = 1\npoisson = 0.3\n", "")
        .replace("fix = [\"x\", \"y\"]", "fix = [\"u\"]")
        .replace("force = [0, 1]\n", "force = 1\n");
    let space = without(&without(&plane, "[[interface]]", "[[contact]]"), "[[contact]]", "[solver]")
        .replace("dimension = 2", "dimension = 3")
        .replace("[0, 0], max = [1, 1]", "[0, 0, 0], max = [1, 1, 1]")
        .replace("[1, 0], max = [2, 1]", "[1, 0, 0], max = [2, 1, 1]")
        .replace("[2, 2]", "[2, 2, 2]")
        .replace("fix = [\"x\", \"y\"]", "fix = [\"x\", \"y\", \"z\"]")
        .replace("force = [0, 1]", "force = [0, 0, 1]");
    vec![
        plane.clone(),
        plane.replace("#patch\n", "backend = \"fe\"\n#patch\n"),
        plane.replace("#interface\n", "coupling = \"nitsche\"\n#interface\n").replace("#contact\n", "method = \"nitsche\"\n#contact\n"),
        plane.replace("#interface\n", "coupling = \"glue\"\n#interface\n"),
        plane.replace("#solver\n", "linear = \"iterative\"\n#solver\n"),
        plane.replace("below = 1\n#check", "equals = 1\n#check"),
        poisson,
        space,
    ]
}

/// Whether a text with a key is read; `None` if another mistake than a key without effect hides the answer.
fn takes(text: &str, key: &str) -> Option<bool> {
    match Case::parse("case.toml", text, &ReadOptions::default()) {
        Ok(_) => Some(true),
        Err(found) => {
            let idle = format!("`{key}` is a key of ");
            found.items.iter().any(|d| d.code == "E015" && d.message.starts_with(&idle)).then_some(false)
        }
    }
}

#[test]
fn keys_with_a_condition_are_taken_where_it_holds_and_refused_elsewhere() {
    let mut seen = 0;
    for found in keys(&Names::default()) {
        let Some((block, key)) = found.path.rsplit_once('.') else { continue };
        // keys of entries of the registry have a rule and tests of their own
        if found.only.is_empty()
            || found.only.contains(" = \"") && !found.only.starts_with("linear")
            || block.contains("rigid")
            || block.starts_with("patch.geometry")
        {
            continue;
        }
        let (Absent::Required(value) | Absent::Is(value) | Absent::None(value)) = found.key.absent else { panic!("{}", found.path) };
        // another value than the default, which is taken anywhere
        let value = match key {
            "multiplier" => "\"p/p\"",
            "integration" => "\"slave\"",
            "extra_points" => "1",
            "cone" => "\"weights\"",
            "assumption" => "\"plane-stress\"",
            "conductivity" => "2.0",
            "tolerance" => "1e-8",
            _ => value,
        };
        let mark = format!("#{block}\n");
        let answers: Vec<bool> = scenes()
            .iter()
            .filter(|scene| scene.contains(&mark))
            .flat_map(|scene| {
                [
                    scene.replace(&mark, &format!("{key} = {value}\n")),
                    scene.replace("young = 1\npoisson = 0.3\n", "lambda = 1\nmu = 1\n").replace(&mark, &format!("{key} = {value}\n")),
                ]
            })
            .filter_map(|text| takes(&text, key))
            .collect();
        assert!(answers.contains(&false), "{} is never refused: {answers:?}", found.path);
        if !matches!(key, "young" | "poisson" | "lambda" | "mu" | "glue" | "reference") {
            assert!(answers.contains(&true), "{} = {value} is never taken: {answers:?}", found.path);
        }
        seen += 1;
    }
    assert!(seen >= 20, "{seen}");
}

#[test]
fn every_row_has_a_meaning_and_values_of_its_type() {
    let names = Registry::default().case_names();
    let all = keys(&names);
    assert!(all.len() > 200, "{}", all.len());
    for found in &all {
        let key = &found.key;
        assert!(key.text.len() > 4, "{}", found.path);
        let (Absent::Required(value) | Absent::Is(value) | Absent::None(value)) = key.absent else { panic!("{}", found.path) };
        // lists that go on
        if !value.is_empty() && !value.contains("..") {
            let text = format!("v = {value}");
            assert!(text.parse::<toml::Table>().is_ok(), "{}: {text}", found.path);
        }
        let values = faying_cli::case::reference::values(key, &names);
        assert!(!values.is_empty(), "{}", found.path);
    }
}

#[test]
fn keys_and_quantities_are_explained() {
    for (word, parts) in [
        ("contact.gap", &["contact.gap: formula of the geometric gap", "[length]", "default  \"g\""][..]),
        ("young", &["material.young: Young's modulus", "[force/area]", "only for law \"hooke\" of elasticity"]),
        ("nonmortar", &["interface.slave, contact.slave: side that carries the multiplier", "nonmortar, secondary"]),
        ("patch.lower.degree", &["patch.degree: instead of that of [discretization]"]),
        ("study.infsup.norm", &["study.norm: norm of multipliers"]),
        ("geometry.extrude", &["patch.geometry.box.extrude, ", "height along z"]),
        ("contact.multiplier", &["\"p/p-2\"", "default  \"auto\"", "keys     degree, continuity, ends"]),
        ("active_set.start", &["contact.active_set.start: rows that are closed at first", "{ seed = 7 }"]),
        ("contact.rigid.sphere.radius", &["a number above zero", "[length]"]),
        ("rigid", &["half-plane: point, normal, move, force", "level-set: f, along"]),
        ("variant", &["only for coupling = \"nitsche\"", "only for method = \"nitsche\"", "\"unsymmetric\""]),
        ("friction", &["0; other values are not in this version", "contact is frictionless here"]),
        ("half_width", &["contact.NAME.half_width, a quantity [length]", "half the extent of the zone"]),
        ("error.u.L2", &["norm of the error against `exact`"]),
        ("contact.pad.force.y", &["contact.NAME.force.x", "force of the master on the slave"]),
        ("u.y at [1, 0] in upper", &["a component of the displacement"]),
        ("energy", &["1/2 a(u, u)"]),
    ] {
        let said = stdout(explain(&[word]));
        assert!(parts.iter().all(|part| said.contains(part)), "{word}: {said}");
    }
    let out = explain(&["foo.bar"]);
    let error = String::from_utf8_lossy(&out.stderr).into_owned();
    assert!(out.status.code() == Some(2) && error.contains("there is no code, key or quantity `foo.bar`"), "{error}");
    let document: serde_json::Value = serde_json::from_str(&stdout(explain(&["contact.gap", "--json"]))).unwrap();
    assert_eq!(document["keys"][0]["unit"], "length");
    // every key and every quantity of the lists is found by its own name
    let names = Names::default();
    for found in keys(&names) {
        assert!(find(&found.path, &names).iter().any(|k| k.path == found.path), "{}", found.path);
    }
    for row in faying_cli::quantities::reference::QUANTITIES {
        assert_eq!(faying_cli::quantities::reference::find(row.pattern), [row]);
        assert!(!faying_cli::quantities::reference::find(row.example).is_empty(), "{}", row.example);
        faying_cli::quantities::Quantity::parse(row.example).unwrap_or_else(|e| panic!("{}: {e}", row.example));
    }
}

/// `FAYING_WRITE=1` writes the page instead.
#[test]
fn the_reference_page_is_that_of_the_table() {
    let page = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/reference.md"));
    let mut text = reference(&Names::default());
    text.push_str(&faying_cli::quantities::reference::page());
    if std::env::var_os("FAYING_WRITE").is_some() {
        std::fs::write(page, &text).unwrap();
    }
    let found = std::fs::read_to_string(page).unwrap_or_default();
    assert!(found == text, "docs/reference.md is stale: run FAYING_WRITE=1 cargo test --release --test program grammar");
}

fn sample(name: &str) -> String {
    std::fs::read_to_string(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/cases")).join(name)).unwrap()
}

fn with_sets(text: &str, sets: &[&str]) -> Case {
    let options = ReadOptions { sets: sets.iter().map(|s| (*s).to_owned()).collect(), ..ReadOptions::default() };
    Case::parse("case.toml", text, &options).unwrap_or_else(|e| panic!("{sets:?}: {e}"))
}

/// Defaults of keys without effect are taken, so that a coupling, a method or a backend can be exchanged by an option.
#[test]
fn defaults_beside_another_entry_are_taken() {
    let seam = sample("seam.toml");
    for coupling in ["glue", "nitsche", "penalty", "mortar"] {
        with_sets(&seam, &[&format!("interface.seam.coupling={coupling}")]);
    }
    let patch = seam.replace("elements = [6, 3]", "elements = [6, 3]\ncontinuity = 1");
    with_sets(&patch, &[]);
    // chosen by an option, where the other patches keep theirs
    with_sets(&patch, &["discretization.backend=fe"]);
    let of_file = patch.replace("backend = \"iga\"", "backend = \"fe\"");
    let found = Case::parse("case.toml", &of_file, &ReadOptions::default()).unwrap_err().to_string();
    assert!(found.contains("error[E015]: `continuity` is a key of backend \"iga\""), "{found}");
}

#[test]
fn effective_cases_and_the_schema_have_every_default() {
    let iterative = with_sets(&sample("seam.toml"), &["solver.linear=iterative"]);
    assert!(iterative.effective_toml().contains("tolerance = 0.0000000001"), "{}", iterative.effective_toml());
    assert!(!with_sets(&sample("seam.toml"), &[]).effective_toml().contains("0.0000000001"));
    let schema = faying_cli::case::schema(&Names::default());
    for (path, default) in [
        ("solver/properties/tolerance", serde_json::json!(1e-10)),
        ("contact/items/properties/factor", "auto".into()),
        ("contact/items/properties/variant", "symmetric".into()),
        ("contact/items/properties/active_set/properties/start", "auto".into()),
        ("interface/items/properties/factor", "auto".into()),
    ] {
        let found = schema.pointer(&format!("/properties/{path}")).unwrap_or_else(|| panic!("{path}"));
        assert_eq!(found["default"], default, "{path}");
    }
}

#[test]
fn an_option_replaces_another_name_of_its_key() {
    let text =
        sample("seam.toml").replace("slave = \"lower.top\"", "nonmortar = \"lower.top\"").replace("master = \"upper", "mortar = \"upper");
    let sets = ["interface.seam.slave=upper.bottom", "interface.seam.primary=lower.top"];
    let effective = with_sets(&text, &sets).effective_toml().to_owned();
    assert!(effective.contains("slave = \"upper.bottom\"\nmaster = \"lower.top\""), "{effective}");
}

#[test]
fn one_mistake_is_one_error() {
    let solver = |line: &str| {
        let found = Case::parse("case.toml", &format!("{}[solver]\n{line}\n", sample("seam.toml")), &ReadOptions::default()).unwrap_err();
        assert_eq!(found.items.len(), 1, "{found}");
        found.to_string()
    };
    let text = solver("linear = \"iterative\"\ntolerance = -1");
    assert!(text.contains("`tolerance` must be positive"), "{text}");
    let text = solver("preconditionner = \"auto\"");
    assert!(text.contains("error[E012]") && text.contains("did you mean `preconditioner`?"), "{text}");
}

/// Studies exchange backends: keys that only one of them has are taken.
#[test]
fn studies_take_keys_of_all_their_backends() {
    let at = tempfile::tempdir().unwrap();
    let text = sample("seam.toml").replace("elements = [6, 3]", "elements = [6, 3]\ncells = \"simplex\"");
    std::fs::write(at.path().join("seam.toml"), text).unwrap();
    let code =
        |words: &[&str]| Command::new(env!("CARGO_BIN_EXE_faying")).current_dir(at.path()).args(words).output().unwrap().status.code();
    assert_eq!(code(&["check", "seam.toml"]), Some(3));
    assert_eq!(code(&["check", "seam.toml", "--backend", "iga"]), Some(0));
    assert_eq!(code(&["compare", "seam.toml", "--backends", "iga,fe"]), Some(0));
}
