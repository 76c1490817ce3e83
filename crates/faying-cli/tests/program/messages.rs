//! What the program says of mistakes: the remedy, where it stands, and nothing that only follows from the first mistake.

use std::path::Path;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// Two blocks pressed together.
const PAIR: &str = r#"
[let]
E = 1.0
[model]
physics = "elasticity"
dimension = 2
[discretization]
degree = 1
[[material]]
name = "m"
young = "E"
poisson = 0.3
[[patch]]
name = "lower"
geometry = { kind = "box", min = [0, 0], max = [1, 1] }
elements = [2, 2]
[[patch]]
name = "upper"
geometry = { kind = "box", min = [0, 1], max = [1, 2] }
elements = [3, 2]
[[boundary]]
on = "lower.bottom"
fix = ["x", "y"]
[[boundary]]
on = "upper.top"
dirichlet = { x = 0, y = -0.01 }
[[contact]]
name = "pad"
slave = "upper.bottom"
master = "lower.top"
"#;

/// A square of four nodes whose node 2 has the name "pin" and whose left edge is "left".
const MESH: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 1 \"left\"\n2 2 \"beam\"\n0 3 \"pin\"\n$EndPhysicalNames\n\
$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n$EndNodes\n$Elements\n3\n1 1 2 1 1 4 1\n2 3 2 2 1 1 2 3 4\n3 15 2 3 1 2\n$EndElements\n";

fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("pair.toml"), PAIR).unwrap();
    std::fs::write(folder.path().join("beam.msh"), MESH).unwrap();
    folder
}

fn faying(at: &Path, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_faying")).current_dir(at).args(words).stdin(Stdio::null()).output().unwrap()
}

/// Messages of a check of the pair with changes.
fn said(at: &Path, sets: &[&str]) -> String {
    let sets = sets.iter().flat_map(|set| ["--set", *set]);
    let out = faying(at, &["check", "pair.toml"].into_iter().chain(sets).collect::<Vec<_>>());
    String::from_utf8(out.stderr).unwrap()
}

#[track_caller]
fn says(at: &Path, sets: &[&str], parts: &[&str]) {
    let said = said(at, sets);
    for part in parts {
        assert!(said.contains(part), "`{part}` is not in\n{said}");
    }
    assert_eq!(said.matches("error[").count(), 1, "one mistake, one message:\n{said}");
}

#[test]
fn a_code_without_help_of_its_own_says_the_remedy_of_the_code() {
    let at = folder();
    for sets in [&["probe=[{name=\"p\",quantity=\"u.x at [9,9]\"}]"][..], &["patch.upper.geometry.max=[0,2]"]] {
        let said = said(at.path(), sets);
        assert!(said.contains("error[") && !said.contains("= help: faying explain"), "{said}");
    }
    let out = faying(at.path(), &["convert", "nothing.msh", "a.vtu", "--json"]);
    let document: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
    assert!(document["diagnostics"][0]["help"].as_str().is_some_and(|help| help.starts_with("correct the name")), "{document}");
    assert_eq!(document["checks"], serde_json::json!([]));
}

#[test]
fn g_is_a_constant_where_no_gap_formula_takes_it() {
    let at = folder();
    let gravity = ["let.g=9.81", "let.weight=\"2*g\"", "model.body_force=[\"0\", \"-weight/1e6\"]"];
    assert_eq!(said(at.path(), &gravity), "");
    assert_eq!(said(at.path(), &[&gravity[..], &["contact.pad.gap=\"g\""]].concat()), "");
    says(at.path(), &["let.g=9.81", "contact.pad.gap=\"g - 0.001\""], &["E016", "`g` is the geometric gap here", "another name"]);
    // without the constant g has no value outside of gap formulas
    says(at.path(), &["boundary.1.dirichlet={ y = \"g\" }"], &["E017", "`g` has a value only in the gap formula"]);
    // the gap is the geometric one, whatever the constant is
    let out = faying(at.path(), &["run", "pair.toml", "--json", "--set", "let.g=5", "--set", "model.body_force=[\"0\", \"0*g\"]"]);
    let same = faying(at.path(), &["run", "pair.toml", "--json", "--force"]);
    let force = |out: &Output| serde_json::from_slice::<serde_json::Value>(&out.stdout).unwrap()["contact"]["pad"]["force"].clone();
    assert_eq!(force(&out), force(&same));
}

#[test]
fn a_constant_with_an_error_is_one_error() {
    let at = folder();
    says(at.path(), &["let.E=true"], &["E014", "must be a number or a quoted formula", "write NAME = 2.5"]);
    says(at.path(), &["let.E=nan"], &["E015"]);
    says(at.path(), &["let.E=-1"], &["E053", "`young` must be positive", "young = 1.0"]);
    // a constant that only an option gives is one that something uses
    says(at.path(), &["let.e2=2"], &["E012", "no formula uses a constant `e2`", "constants here: E"]);
    assert_eq!(said(at.path(), &["let.nu=0.2", "material.m.poisson=nu"]), "");
}

#[test]
fn quantities_of_contacts_that_do_not_exist_list_those_that_do() {
    let at = folder();
    let probe = |quantity: &str| format!("probe=[{{name=\"p\",quantity=\"{quantity}\"}}]");
    says(at.path(), &[&probe("contact.pda.force.y")], &["there is no contact `pda`; contacts: pad", "did you mean `contact.pad.force.y`?"]);
    says(
        at.path(),
        &[&probe("interface.pad.jump.L2")],
        &["there is no interface `pad`; the case has no [[interface]]", "write contact.pad"],
    );
    says(at.path(), &[&probe("contact.c.pressure at [0.5, 1]")], &["there is no contact `c`; contacts: pad"]);
}

#[test]
fn blocks_without_a_name_are_set_by_the_name_that_messages_give_them() {
    let at = folder();
    assert_eq!(said(at.path(), &["boundary.boundary-1.dirichlet={ x = 0, y = -0.02 }"]), "");
    says(at.path(), &["boundary.boundary-2.pressure=1"], &["there is no boundary `boundary-2`", "positions 0 to 1"]);
}

#[test]
fn a_geometry_without_kind_is_told_the_kind_that_its_keys_fit() {
    let at = folder();
    for (geometry, kind) in [
        ("{ file = \"beam.msh\" }", "file"),
        ("{ min = [0, 0], max = [1, 1] }", "box"),
        ("{ radius = [1, 2], angle_deg = [0, 90] }", "annulus-sector"),
        ("{ radius = 1, half_width = 4 }", "plate-with-hole"),
    ] {
        says(
            at.path(),
            &[&format!("patch.lower.geometry={geometry}")],
            &["E013", &format!("write geometry = {{ kind = \"{kind}\", .. }}")],
        );
    }
}

#[test]
fn where_that_keeps_nothing_says_where_the_centres_are() {
    let at = folder();
    says(at.path(), &["boundary.1.where=\"x > 2\""], &["E015", "the centres lie in x from 0.1667 to 0.8333, y 2"]);
}

#[test]
fn names_that_files_cannot_have_are_refused_before_solving() {
    let at = folder();
    let name = "a".repeat(101);
    says(at.path(), &[&format!("patch.upper.name={name}")], &["E016", "a name of 101 letters is too long", "at most 100"]);
    assert_eq!(said(at.path(), &[&format!("contact.pad.name={}", &name[..100])]), "");
}

#[test]
fn points_of_a_mesh_are_no_sides_and_the_message_says_what_they_take() {
    let at = folder();
    let mesh = "patch.lower.geometry={ kind = \"file\", file = \"beam.msh\" }";
    let sets = [mesh, "patch.lower.backend=fe", "boundary.0.on=lower.left", "contact.pad.master=lower.pin"];
    std::fs::write(at.path().join("pair.toml"), PAIR.replacen("elements = [2, 2]\n", "", 1)).unwrap();
    says(at.path(), &sets, &["E021", "`lower.pin` is a set of points of the file, no side", "for fix, dirichlet and force", "are left"]);
}

#[test]
fn a_side_with_two_partners_is_to_be_cut() {
    let at = folder();
    let tie = "interface=[{ slave = \"upper.bottom\", master = \"lower.top\" }]";
    says(at.path(), &[tie], &["E026", "slave twice", "cut it, by `where`, a patch or a group of the mesh per partner"]);
}

#[test]
fn what_a_format_cannot_hold_names_the_file_of_that_format() {
    let at = folder();
    let out = faying(at.path(), &["convert", "beam.msh", "beam.xml"]);
    let said = String::from_utf8(out.stderr).unwrap();
    assert!(said.contains("error[E043]: `beam.xml`: a Lagrange mesh in G+Smo XML"), "{said}");
}

#[test]
fn a_probe_where_bodies_meet_says_whose_value_it_is() {
    let at = folder();
    let probes = "probe=[{name=\"p\",quantity=\"u.x at [0.5, 1]\"},{name=\"q\",quantity=\"u.x at [0.5, 1] in upper\"},{name=\"r\",quantity=\"u.x at [0.5, 0]\"}]";
    let out = faying(at.path(), &["run", "pair.toml", "--set", probes]);
    let text = String::from_utf8(out.stdout).unwrap();
    assert_eq!(text.matches("other bodies meet it there").count(), 1, "{text}");
    let document: serde_json::Value = serde_json::from_slice(&std::fs::read(at.path().join("pair.out/result.json")).unwrap()).unwrap();
    let patches: Vec<_> = (0..3).map(|k| document["probes"][k]["patch"].as_str()).collect();
    assert_eq!(patches, [Some("lower"), None, None]);
}

#[test]
fn the_help_and_the_codes_use_the_words_of_the_field() {
    let at = folder();
    let said = |words: &[&str]| {
        let text = String::from_utf8(faying(at.path(), words).stdout).unwrap();
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    for (words, part) in [
        (&["--help"][..], "Mortar tying and contact of NURBS and finite element meshes that do not match."),
        (&["--help"], "Memory limit, such as 4GB; a larger run"),
        (&["compare", "--help"], "iga+fe: iga on slave patches, fe elsewhere [default: the case's; compare: iga,fe]"),
        (&["quadrature", "--help"], "Extra Gauss points per segment, such as 0,1,2 [quadrature: 0,1,2,4,8]"),
        (&["infsup", "--help"], "h^-1/2 |w| of traces, h^1/2 |mu| of multipliers"),
        (
            &["explain", "E023"],
            "`between` ties sides if faceting explains their gap: mean at most 1/4, largest at most 2 times the deviation",
        ),
        (&["explain", "E065"], "E065: inexact integration (a warning)"),
        (&["explain", "E072"], "(exit 5)"),
        (&["explain", "moment cut"], "moment cut, a quantity"),
        (&["explain", "force.y cut [0, 0] to [0, 1] in a"], "force.x cut, a quantity"),
        (&["explain", "E065"], "the quadrature error at this interface is above 1 %"),
    ] {
        assert!(said(words).contains(part), "`{part}` is not in\n{}", said(words));
    }
}

#[test]
fn a_study_with_a_row_that_failed_says_that_the_others_are_valid() {
    let at = folder();
    let out = faying(at.path(), &["sweep", "pair.toml", "--vary", "contact.pad.multiplier=p/p,p/p-4"]);
    assert_eq!(out.status.code(), Some(3));
    let page = std::fs::read_to_string(at.path().join("pair.sweep/report.html")).unwrap();
    assert!(page.contains("1 of 2 rows could not be finished, the first one: invalid, E064. The other rows are valid."), "{page}");
    // one row has no curve: nothing to warn of
    let out = faying(at.path(), &["convergence", "pair.toml", "--levels", "1"]);
    let said = String::from_utf8(out.stderr).unwrap();
    assert!(out.status.success() && !said.contains("E091") && !at.path().join("pair.convergence/study.svg").exists(), "{said}");
}

#[test]
fn quantities_that_are_several_numbers_or_lack_a_part_list_what_there_is() {
    let at = folder();
    let probe = |quantity: &str| format!("probe=[{{name=\"p\",quantity=\"{quantity}\"}}]");
    for (quantity, parts) in [
        (
            "contact.pad.pressure",
            &[
                "`contact.pad.pressure` is more than one number",
                "contact.pad.pressure at [x, y], contact.pad.pressure.min, contact.pad.pressure.max",
            ][..],
        ),
        ("contact.pad.force", &["is more than one number", "numbers of contact.pad.force: contact.pad.force.x, contact.pad.force.y "]),
        ("contact.pad.gap", &["is more than one number", "contact.pad.gap.min"]),
        ("contact.pad.force.z", &["unknown quantity", "numbers of contact.pad.force: contact.pad.force.x, contact.pad.force.y "]),
        ("contact.pad.presure.max", &["did you mean `contact.pad.pressure.max`?"]),
        ("reaction.lower.bottom", &["is more than one number", "reaction.lower.bottom.x, reaction.lower.bottom.y"]),
        (
            "reaction.lower.bottom.q",
            &["unknown quantity", "numbers of reaction.lower.bottom: reaction.lower.bottom.x, reaction.lower.bottom.y "],
        ),
        ("reaction.lower.y", &["unknown quantity", "numbers of reaction.lower: reaction.lower.bottom.x, reaction.lower.bottom.y "]),
        ("balance.force", &["balance.force.x, balance.force.y"]),
        ("u.x at", &["nothing stands after `at`; write u.x at [x, y]"]),
        ("von_mises.max in", &["nothing stands after `in`; write von_mises.max in PATCH"]),
        ("u.x + u.y", &["no blanks, brackets or signs"]),
    ] {
        says(at.path(), &[&probe(quantity)], parts);
        // one sentence, and no advice to write what is there already
        let said = said(at.path(), &[&probe(quantity)]);
        assert!(said.matches("is no quantity").count() <= 1 && !said.contains("did you mean `u."), "{said}");
    }
}

#[test]
fn the_tolerance_that_is_wanted_is_the_one_that_is_named() {
    let at = folder();
    let second = "[[boundary]]\nname = \"held\"\non = \"upper.left\"\nfix = [\"x\"]\n[[contact]]\nname = \"plate\"\nslave = \"upper.right\"\n\
        rigid = { kind = \"half-plane\", point = [1, 0], normal = [-1, 0] }\nmethod = \"augmented\"\nfactor = 1e-2\ntolerance = 1e-9\n";
    std::fs::write(
        at.path().join("pair.toml"),
        PAIR.replace("x = 0, y", "y") + "method = \"augmented\"\nfactor = 1e-2\ntolerance = 1e-2\n" + second,
    )
    .unwrap();
    let out = faying(at.path(), &["run", "pair.toml"]);
    let said = String::from_utf8(out.stderr).unwrap();
    assert_eq!(out.status.code(), Some(5), "{said}");
    let line = 1 + std::fs::read_to_string(at.path().join("pair.toml")).unwrap().lines().position(|l| l == "tolerance = 1e-9").unwrap();
    for part in ["error[E074]", "wanted 1.0e-9", "`tolerance` of contact \"plate\"", &format!("pair.toml:{line}:")] {
        assert!(said.contains(part), "`{part}` is not in\n{said}");
    }
}

#[test]
fn flags_are_explained_by_the_value_that_is_not_their_default() {
    let at = folder();
    for (key, example) in [("contact.adjust", "adjust = true"), ("contact.symmetry", "symmetry = true"), ("patch.glue", "glue = false")] {
        let told = String::from_utf8(faying(at.path(), &["explain", key]).stdout).unwrap();
        assert!(told.contains(&format!("example  {example}")), "{told}");
    }
}
