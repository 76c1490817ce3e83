//! Stored runs: errors against them, what is refused, and files that are broken.

use faying_cli::Case;
use faying_cli::case::ReadOptions;
use faying_cli::errors::Diagnostics;
use faying_cli::reference::{MAGIC, StoredRun, read, write};
use faying_cli::run::run;
use faying_cli::{Registry, RunControl, RunOptions, RunResult};
use faying_files::{FileError, Limits};
use std::path::Path;
use std::process::Command;

/// u of the tied problem, harmonic: no source.
const EXACT: &str = "exp(x)*sin(y)";

/// A sector of a ring around one of a disc, tied along the arc; `model` and `rest` are added.
fn arc(model: &str, rest: &str) -> String {
    format!(
        "[model]\nphysics = \"poisson\"\ndimension = 2\n{model}\n\
         [discretization]\ndegree = 2\nextra_points = 3\n\
         [[patch]]\nname = \"inner\"\ngeometry = {{ kind = \"annulus-sector\", center = [0, 0], radius = [0.4, 1.0], angle_deg = [0, 90] }}\nelements = [4, 3]\n\
         [[patch]]\nname = \"outer\"\ngeometry = {{ kind = \"annulus-sector\", center = [0, 0], radius = [1.0, 1.7], angle_deg = [0, 90] }}\nelements = [3, 3]\n\
         [[boundary]]\non = \"all-outer\"\ndirichlet = \"{EXACT}\"\n\
         [[interface]]\nname = \"arc\"\nslave = \"inner.v1\"\nmaster = \"outer.v0\"\nmultiplier = \"p/p\"\nextra_points = 6\n{rest}\n"
    )
}

/// An octant of a shell around one of another shell, tied along the sphere between them; u is harmonic.
fn sphere(model: &str) -> String {
    format!(
        "[model]\nphysics = \"poisson\"\ndimension = 3\n{model}\n\
         [discretization]\ndegree = 2\n\
         [[patch]]\nname = \"inner\"\ngeometry = {{ kind = \"sphere-octant\", center = [0, 0, 0], radius = [0.6, 1.0] }}\nelements = [4, 4, 2]\n\
         [[patch]]\nname = \"outer\"\ngeometry = {{ kind = \"sphere-octant\", center = [0, 0, 0], radius = [1.0, 1.5] }}\nelements = [3, 3, 2]\n\
         [[boundary]]\non = \"all-outer\"\ndirichlet = \"{EXACT}\"\n\
         [[interface]]\nname = \"arc\"\nslave = \"inner.w1\"\nmaster = \"outer.w0\"\n"
    )
}

/// A paraboloid pressed on a block.
const PRESSED_SOLID: &str = r#"
[model]
physics = "elasticity"
dimension = 3
[[material]]
name = "m"
young = 1.0
poisson = 0.3
[[patch]]
name = "upper"
geometry = { kind = "nurbs", degree = [2, 2, 1], knots = [[0, 0, 0, 1, 1, 1], [0, 0, 0, 1, 1, 1], [0, 0, 1, 1]], points = [[-0.5, -0.5, 0.1], [0, -0.5, 0], [0.5, -0.5, 0.1], [-0.5, 0, 0], [0, 0, -0.1], [0.5, 0, 0], [-0.5, 0.5, 0.1], [0, 0.5, 0], [0.5, 0.5, 0.1], [-0.5, -0.5, 0.6], [0, -0.5, 0.6], [0.5, -0.5, 0.6], [-0.5, 0, 0.6], [0, 0, 0.6], [0.5, 0, 0.6], [-0.5, 0.5, 0.6], [0, 0.5, 0.6], [0.5, 0.5, 0.6]] }
elements = [5, 5, 1]
[[patch]]
name = "lower"
geometry = { kind = "box", min = [-0.5, -0.5, -0.6], max = [0.5, 0.5, 0] }
elements = [4, 4, 1]
[[boundary]]
on = "lower.bottom"
fix = ["x", "y", "z"]
[[boundary]]
on = "upper.top"
fix = ["x", "y"]
dirichlet = { z = "-0.06" }
[[contact]]
name = "pad"
slave = "upper.bottom"
master = "lower.top"
"#;

/// A parabola pressed on a block.
const PRESSED: &str = r#"
[model]
physics = "elasticity"
dimension = 2
[[material]]
name = "m"
young = 1.0
poisson = 0.3
[[patch]]
name = "upper"
geometry = { kind = "nurbs", degree = [2, 1], knots = [[0, 0, 0, 1, 1, 1], [0, 0, 1, 1]], points = [[-0.5, 0.05], [0, -0.05], [0.5, 0.05], [-0.5, 0.6], [0, 0.6], [0.5, 0.6]] }
elements = [8, 3]
[[patch]]
name = "lower"
geometry = { kind = "box", min = [-0.5, -0.8], max = [0.5, 0] }
elements = [7, 3]
[[boundary]]
on = "lower.bottom"
fix = ["x", "y"]
[[boundary]]
on = "upper.top"
fix = ["x"]
dirichlet = { y = "-0.03" }
[[contact]]
name = "pad"
slave = "upper.bottom"
master = "lower.top"
"#;

fn options(folder: &Path, sets: &[&str], backend: Option<&str>) -> ReadOptions {
    ReadOptions {
        folder: Some(folder.to_owned()),
        sets: sets.iter().map(|s| (*s).to_owned()).collect(),
        backend: backend.map(str::to_owned),
        ..ReadOptions::default()
    }
}

fn case(folder: &Path, text: &str, sets: &[&str], backend: Option<&str>) -> Result<Case, Diagnostics> {
    Case::parse("case.toml", text, &options(folder, sets, backend))
}

fn solve(folder: &Path, text: &str, sets: &[&str], backend: Option<&str>) -> Result<RunResult, Diagnostics> {
    case(folder, text, sets, backend)?.run(&Registry::default())
}

/// The stored run of a case.
fn stored(folder: &Path, text: &str, sets: &[&str], backend: Option<&str>) -> StoredRun {
    let case = case(folder, text, sets, backend).unwrap_or_else(|e| panic!("{e}"));
    let keep = RunOptions { keep: true, ..RunOptions::default() };
    let finished = run(&case, &Registry::default(), &keep, &RunControl::default());
    finished.stored.unwrap_or_else(|| panic!("{:?}", finished.result.diagnostics))
}

fn save(folder: &Path, name: &str, run: &StoredRun) {
    std::fs::write(folder.join(name), write(run)).unwrap();
}

fn error(result: &RunResult, name: &str) -> f64 {
    *result.errors.get(name).unwrap_or_else(|| panic!("no {name} among {:?}", result.errors))
}

const KEPT: &str = "model.reference=\"kept.ref\"";

#[test]
fn a_run_has_no_error_against_itself() {
    let at = tempfile::tempdir().unwrap();
    std::fs::copy(
        format!("{}/tests/data/gmsh/disc_tri_p2_v4_bin.msh", concat!(env!("CARGO_MANIFEST_DIR"), "/../..")),
        at.path().join("disc.msh"),
    )
    .unwrap();
    let disc = "[model]\nphysics = \"poisson\"\ndimension = 2\nsource = \"1\"\n[discretization]\nbackend = \"fe\"\n\
                [[patch]]\nname = \"disc\"\ngeometry = { kind = \"file\", file = \"disc.msh\" }\nrefine = 1\n\
                [[boundary]]\non = \"all-outer\"\ndirichlet = 0\n";
    let cube = "[model]\nphysics = \"poisson\"\ndimension = 3\nsource = \"x\"\n\
                [[patch]]\nname = \"cube\"\ngeometry = { kind = \"box\", min = [0, 0, 0], max = [1, 1, 1] }\nelements = [3, 2, 2]\n\
                [[boundary]]\non = \"cube.bottom\"\ndirichlet = 0\n";
    let tied = arc("", "");
    let with_lambda = ["error.u.L2.rel", "error.u.H1.rel", "error.u.energy.rel", "error.lambda.L2.rel"];
    let shells = sphere("");
    let cases: [(&str, &[&str], Option<&str>, usize); 14] = [
        (&tied, &[], Some("iga"), 4),
        (&tied, &["patch.outer.backend=\"fe\""], None, 4),
        (&tied, &["discretization.cells=\"simplex\""], Some("fe"), 4),
        (&tied, &["discretization.mapping=\"exact\"", "discretization.degree=[3, 2]"], Some("fe"), 4),
        (&tied, &["interface.arc.multiplier=\"dual\"", "discretization.continuity=0"], None, 4),
        (PRESSED, &[], Some("iga"), 4),
        (PRESSED, &["contact.pad.multiplier=\"p/p\""], Some("fe"), 4),
        (disc, &[], None, 3),
        (cube, &[], None, 3),
        (&shells, &[], Some("iga"), 4),
        (&shells, &["patch.inner.cells=\"simplex\"", "patch.inner.backend=\"fe\""], None, 4),
        (&shells, &["patch.inner.cells=\"simplex\"", "patch.outer.cells=\"simplex\"", "discretization.degree=3"], Some("fe"), 4),
        (PRESSED_SOLID, &[], Some("iga"), 4),
        (PRESSED_SOLID, &["discretization.cells=\"simplex\""], Some("fe"), 4),
    ];
    for (text, sets, backend, count) in cases {
        save(at.path(), "kept.ref", &stored(at.path(), text, sets, backend));
        let again = solve(at.path(), text, &[sets, &[KEPT]].concat(), backend).unwrap_or_else(|e| panic!("{sets:?}: {e}"));
        for (k, name) in with_lambda[..count].iter().enumerate() {
            // rounded to 2^-44 of the largest coefficient; a derivative multiplies that by degree / h
            let most = if k == 1 || k == 2 { 1e-10 } else { 1e-12 };
            assert!(error(&again, name) < most, "{sets:?} {backend:?}: {name} = {:e}", error(&again, name));
        }
    }
}

#[test]
fn a_run_of_another_assumption_is_no_reference() {
    let at = tempfile::tempdir().unwrap();
    save(at.path(), "kept.ref", &stored(at.path(), PRESSED, &["model.assumption=\"plane-stress\""], None));
    assert!(solve(at.path(), PRESSED, &["model.assumption=\"plane-stress\"", KEPT], None).is_ok());
    let errors = solve(at.path(), PRESSED, &["model.assumption=\"plane-strain\"", KEPT], None).unwrap_err();
    let words = "the stored run is one of plane-stress, this case of plane-strain";
    assert!(errors.items.iter().any(|e| e.code == "E015" && e.message.contains(words)), "{errors}");
}

/// One backend, a grid that is not nested in the finer one, against the same exact solution and against a fine run of any backend, on which
/// errors are below `share` of those of the grid.
fn measured_against_a_fine_run(text: fn(&str) -> String, fine: &[&str], share: f64) {
    let at = tempfile::tempdir().unwrap();
    let known = text(&format!("exact = {{ u = \"{EXACT}\" }}"));
    let names = ["error.u.L2", "error.u.H1", "error.u.energy", "error.arc.lambda.L2", "error.lambda.L2"];
    for storing in ["iga", "fe"] {
        save(at.path(), "kept.ref", &stored(at.path(), &text(""), fine, Some(storing)));
        let own = solve(at.path(), &known, fine, Some(storing)).unwrap();
        for backend in ["iga", "fe"] {
            // the rule of the bodies' degree misses 5 % of the error of quadratic elements in space
            let exact = solve(at.path(), &known, &["discretization.extra_points=2"], Some(backend)).unwrap();
            let found = solve(at.path(), &text(""), &[KEPT], Some(backend)).unwrap();
            for name in names {
                let (e, f, fine) = (error(&exact, name), error(&found, name), error(&own, name));
                println!("{backend} against {storing}: {name} {f:e} instead of {e:e} within {fine:e}");
                assert!(fine < share * e, "{storing} is not fine for {backend}: {name} {fine:e} against {e:e}");
                // Lagrange bodies of degree 2 reach beyond the arc, where the run is known at the nearest point only
                let apart = if backend == "fe" { 2e-2 * e } else { 1e-4 * e };
                assert!((e - f).abs() <= fine + apart, "{backend} against {storing}: {name} {f:e} instead of {e:e} within {fine:e}");
            }
        }
    }
}

#[test]
fn the_error_against_a_fine_run_is_the_error_against_the_exact_solution_within_that_of_the_fine_run() {
    let fine = ["patch.inner.elements=[13, 9]", "patch.outer.elements=[11, 9]", "discretization.degree=4"];
    measured_against_a_fine_run(|model| arc(model, ""), &fine, 0.02);
}

#[test]
fn in_space_the_error_against_a_fine_run_is_that_against_the_exact_solution() {
    let fine = ["patch.inner.elements=[5, 5, 3]", "patch.outer.elements=[4, 4, 3]", "discretization.degree=4"];
    measured_against_a_fine_run(sphere, &fine, 0.1);
}

#[test]
fn a_case_with_an_exact_solution_is_measured_against_that() {
    let at = tempfile::tempdir().unwrap();
    let known = arc(&format!("exact = {{ u = \"{EXACT}\" }}"), "");
    save(at.path(), "kept.ref", &stored(at.path(), &arc("", ""), &[], None));
    let (plain, both) = (solve(at.path(), &known, &[], None).unwrap(), solve(at.path(), &known, &[KEPT], None).unwrap());
    assert_eq!(plain.to_json(), both.to_json());
}

#[test]
fn ties_without_multipliers_have_the_error_of_their_flux_against_a_stored_multiplier() {
    let at = tempfile::tempdir().unwrap();
    let fine = ["patch.inner.elements=[13, 9]", "patch.outer.elements=[11, 9]", "discretization.degree=4"];
    save(at.path(), "kept.ref", &stored(at.path(), &arc("", ""), &fine, None));
    let nitsche = ["interface.arc.coupling=\"nitsche\"", "interface.arc.multiplier=\"auto\"", KEPT];
    let found = solve(at.path(), &arc("", ""), &[&fine[..], &nitsche].concat(), None).unwrap();
    // two approximations of one flux
    let apart = error(&found, "error.lambda.L2.rel");
    assert!(apart > 1e-8 && apart < 1e-3, "{apart:e}");
    // a run without multipliers has none to offer
    save(at.path(), "kept.ref", &stored(at.path(), &arc("", ""), &nitsche[..2], None));
    let none = solve(at.path(), &arc("", ""), &[KEPT], None).unwrap();
    assert!(none.errors.get("error.lambda.L2").is_none() && none.errors.get("error.u.L2").is_some());
    let asked = arc("", "[[check]]\nquantity = \"error.arc.lambda.L2\"\nbelow = 1.0\n");
    let fault = solve(at.path(), &asked, &[KEPT], None).unwrap_err().to_string();
    assert!(fault.contains("E062") && fault.contains("the stored run has no multiplier"), "{fault}");
}

#[test]
fn a_contact_by_nitsche_is_measured_against_a_stored_multiplier() {
    let at = tempfile::tempdir().unwrap();
    let nitsche = ["contact.pad.method=\"nitsche\"", KEPT];
    save(at.path(), "kept.ref", &stored(at.path(), PRESSED, &[], None));
    let found = solve(at.path(), PRESSED, &nitsche, None).unwrap();
    // eight elements a side: the zone's end costs both a fifth of the pressure; a wrong sign would cost twice all of it
    let apart = error(&found, "error.pad.lambda.L2.rel");
    assert!(apart > 1e-8 && apart < 0.5, "{apart:e}");
    save(at.path(), "kept.ref", &stored(at.path(), PRESSED, &nitsche[..1], None));
    let none = solve(at.path(), PRESSED, &[KEPT], None).unwrap();
    assert!(none.errors.get("error.pad.lambda.L2").is_none() && none.errors.get("error.u.L2").is_some());
}

fn refused(folder: &Path, text: &str, sets: &[&str], code: &str, part: &str) {
    match solve(folder, text, &[sets, &[KEPT]].concat(), None) {
        Ok(_) => panic!("{code} expected for {part}"),
        Err(faults) => {
            let text = faults.to_string();
            assert!(text.contains(code) && text.contains(part), "{code}, {part} expected, found\n{text}");
        }
    }
}

#[test]
fn a_stored_run_of_something_else_is_refused_with_the_reason() {
    let at = tempfile::tempdir().unwrap();
    let text = arc("", "");
    refused(at.path(), &text, &[], "E003", "there is no file kept.ref");
    let good = stored(at.path(), &text, &[], None);
    save(at.path(), "kept.ref", &good);
    refused(
        at.path(),
        &text,
        &["patch.outer.geometry.radius=[1.0, 1.71]"],
        "E015",
        "patch \"outer\" of the stored run has another geometry",
    );
    refused(at.path(), &text, &["patch.outer.name=\"shell\"", "interface.arc.master=\"shell.v0\""], "E015", "this case has inner, shell");
    refused(
        at.path(),
        &text,
        &["interface.arc.slave=\"outer.v0\"", "interface.arc.master=\"inner.v1\""],
        "E015",
        "covers 0 % of `outer.v0`",
    );
    refused(at.path(), PRESSED, &[], "E015", "the stored run is one of poisson, this case of elasticity");
    refused(at.path(), &text, &["steps.t=[0.5, 2.0]"], "E015", "the stored run ends at t = 1, this case at t = 2");
    let cube = "[model]\nphysics = \"poisson\"\ndimension = 3\n[[patch]]\nname = \"a\"\ngeometry = { kind = \"box\", min = [0, 0, 0], max = [1, 1, 1] }\nelements = [1, 1, 1]\n[[boundary]]\non = \"a.bottom\"\ndirichlet = 0\n";
    refused(at.path(), cube, &[], "E044", "the stored run has dimension 2, this case 3");
    // steps that end at the stored time are fine
    assert!(solve(at.path(), &text, &["steps.t=[0.5, 1.0]", KEPT], None).is_ok());
    let bytes = write(&good);
    for (broken, part) in [
        (bytes[..bytes.len() - 1].to_vec(), "byte"),
        (bytes[..bytes.len() / 2].to_vec(), "byte"),
        ([&bytes[..], b"x"].concat(), "something follows its end"),
        (b"faying.reference/3\n".to_vec(), "this version of stored runs is not supported"),
        (b"schema = 1\n".to_vec(), "a file that is no stored run is not supported"),
        (Vec::new(), "a file that is no stored run is not supported"),
    ] {
        std::fs::write(at.path().join("kept.ref"), broken).unwrap();
        refused(at.path(), &text, &[], "E043", part);
    }
}

/// Xorshift: the same changes on every machine.
fn random(state: &mut u64) -> usize {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    *state as usize
}

#[test]
fn bytes_that_changed_are_noticed_and_memory_stays_below_the_limit() {
    let at = tempfile::tempdir().unwrap();
    let bytes = write(&stored(at.path(), PRESSED, &[], None));
    let mut state = 7;
    for _ in 0..3000 {
        let mut broken = bytes.clone();
        let k = MAGIC.len() + random(&mut state) % (bytes.len() - MAGIC.len());
        match random(&mut state) % 3 {
            0 => broken[k] ^= 1 << (random(&mut state) % 8),
            1 => broken.truncate(k),
            _ => broken.insert(k, random(&mut state) as u8),
        }
        // a flag of the stream that means nothing may change; everything else has a checksum
        if let Ok(run) = read(&broken, &Limits::default()) {
            assert_eq!(write(&run), bytes);
        }
    }
    let limited = read(&bytes, &Limits { memory: Some(bytes.len() as u64 + 1000) });
    assert!(matches!(limited, Err(FileError::Memory { .. })), "{limited:?}");
}

#[test]
fn contents_that_contradict_themselves_are_refused() {
    let at = tempfile::tempdir().unwrap();
    let good = stored(at.path(), &arc("", ""), &[], None);
    type Change = fn(&mut StoredRun);
    let changes: [(Change, &str); 18] = [
        (|r| r.components = 2, "E015"),
        (|r| r.dimension = 7, "E043"),
        (|r| r.patches[0].degree = vec![3, 2], "functions"),
        (|r| r.patches[0].degree = vec![200, 2], "cannot be made"),
        (|r| r.patches[0].degree = vec![2], "E043"),
        (|r| r.patches[0].functions = 1, "coefficients for 1 functions"),
        (|r| r.patches[0].functions = usize::MAX, "coefficients for"),
        (|r| r.patches[1].coefficients.truncate(3), "has 3 coefficients for"),
        (|r| r.patches[1].backend = "modal".into(), "unknown backend `modal`"),
        (|r| r.patches[1].basis = "wavelets".into(), "wavelets"),
        (|r| r.patches[1].breakpoints[0] = (0..100_000).map(|k| k as f64 * 1e-5).collect(), "elements"),
        (|r| r.patches[1].breakpoints[0].reverse(), "E043"),
        (|r| r.patches[1].breakpoints[1][0] = -1.0, "cannot be made"),
        (|r| r.sides[0].facets[0] = 1e9, "facet on element 1000000000"),
        (|r| r.sides[0].facets[6] = 0.3, "covers 92 % of `inner.v1`"),
        (|r| r.sides[0].facets[8] = 0.3, "is not on a side"),
        (|r| r.sides[0].patch = "nowhere".into(), "is no patch"),
        (|r| r.sides[0].degree = usize::MAX, "E043"),
    ];
    for (k, (change, part)) in changes.into_iter().enumerate() {
        let mut bad = good.clone();
        change(&mut bad);
        if let Err(fault) = read(&write(&bad), &Limits::default()) {
            assert_eq!((faying_cli::codes::of_file(&fault), part), ("E043", "E043"), "change {k}: {fault}");
        }
        save(at.path(), "kept.ref", &bad);
        refused(at.path(), &arc("", ""), &[], "", part);
    }
}

#[test]
fn the_same_run_gives_the_same_bytes_on_any_number_of_threads() {
    let at = tempfile::tempdir().unwrap();
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            save(at.path(), "kept.ref", &stored(at.path(), PRESSED, &["patch.upper.elements=[16, 6]"], None));
            let measured = solve(at.path(), PRESSED, &[KEPT], None).unwrap().to_json();
            (std::fs::read(at.path().join("kept.ref")).unwrap(), measured)
        })
    };
    assert_eq!(on(1), on(2));
}

#[test]
fn the_program_stores_a_run_whole_and_over_nothing_else() {
    let at = tempfile::tempdir().unwrap();
    std::fs::write(at.path().join("case.toml"), arc("", "")).unwrap();
    let faying = |words: &[&str]| {
        let done = Command::new(env!("CARGO_BIN_EXE_faying")).current_dir(at.path()).args(words).output().unwrap();
        (done.status.code().unwrap(), String::from_utf8_lossy(&done.stderr).into_owned())
    };
    let keep = |file: &str| faying(&["run", "case.toml", "--vtu", "none", "-q", "--save-reference", file]);
    assert_eq!(keep("a.ref"), (0, String::new()));
    let first = std::fs::read(at.path().join("a.ref")).unwrap();
    assert_eq!(keep("a.ref"), (0, String::new()));
    assert_eq!(std::fs::read(at.path().join("a.ref")).unwrap(), first);
    let (code, text) = keep("case.toml");
    assert!(code == 4 && text.contains("E090") && text.contains("is no stored run"), "{code} {text}");
    let (code, text) = keep("nowhere/a.ref");
    assert!(code == 4 && text.contains("E091") && text.contains("no folder"), "{code} {text}");
    // the study of a case in a folder of its own: paths are relative to the case, rates follow, the manifest hashes the file
    std::fs::create_dir(at.path().join("cases")).unwrap();
    std::fs::write(at.path().join("cases/coarse.toml"), arc("reference = \"../a.ref\"", "")).unwrap();
    let sets = ["--set", "patch.inner.elements=[2, 1]", "--set", "patch.outer.elements=[1, 1]", "--out", "out", "--levels", "2", "-q"];
    let (code, text) = faying(&[&["convergence", "cases/coarse.toml"], &sets[..]].concat());
    assert_eq!(code, 0, "{text}");
    let of = |name: &str| -> serde_json::Value {
        serde_json::from_str(&std::fs::read_to_string(at.path().join("out").join(name)).unwrap()).unwrap()
    };
    let rate = of("result.json")["rows"][1]["rates"]["error.u.L2"].as_f64().unwrap();
    assert!(rate > 2.0, "{rate}");
    assert_eq!(of("manifest.json")["inputs"][1]["file"], "../a.ref");
    let (code, text) = faying(&["run", "cases/coarse.toml", "--vtu", "none", "-q", "--save-reference", "a.ref"]);
    assert!(code == 4 && text.contains("E090") && text.contains("is the `reference` of this run"), "{code} {text}");
    // the case with every default written out runs where it lies
    let (code, text) = faying(&["run", "out/case.effective.toml", "--vtu", "none", "--out", "again", "-q"]);
    assert_eq!(code, 0, "{text}");
}
