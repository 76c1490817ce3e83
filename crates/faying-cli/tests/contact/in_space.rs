//! Contact of solids with rigid obstacles from case files: numbers, files, and what is refused.

use crate::common::pressed::kkt;
use faying_cli::case::ReadOptions;
use faying_cli::run::{check, run as run_case};
use faying_cli::{Case, Registry, RunControl, RunOptions, RunResult, SideOutput, SidePart};

/// A block whose bottom touches z = 0; its sides x = 0 and y = 0 are symmetry planes, its top is pressed.
const BLOCK: &str = "[model]\nphysics = \"elasticity\"\ndimension = 3\n[discretization]\nbackend = \"iga\"\ndegree = 2\n\
    [[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n\
    [[patch]]\nname = \"block\"\ngeometry = { kind = \"box\", min = [0, 0, 0], max = [1, 0.8, 0.5] }\nelements = [3, 3, 2]\n\
    [[boundary]]\non = \"block.u0\"\nfix = [\"x\"]\n[[boundary]]\non = \"block.v0\"\nfix = [\"y\"]\n\
    [[boundary]]\non = \"block.top\"\npressure = 1e-3\n\
    [[contact]]\nname = \"floor\"\nslave = \"block.bottom\"\nrigid = { kind = \"half-plane\", point = [0, 0, 0], normal = [0, 0, 1] }\n";

/// The bodies that a case may ask for.
const CELLS: [&str; 3] = ["backend = \"iga\"", "backend = \"fe\"", "backend = \"fe\"\ncells = \"simplex\""];

fn with(changes: &[(&str, &str)]) -> String {
    changes.iter().fold(BLOCK.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    })
}

fn read(text: &str) -> Result<Case, String> {
    Case::parse("case.toml", text, &ReadOptions::default()).map_err(|e| e.to_string())
}

fn run(text: &str) -> RunResult {
    let case = read(text).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let result = case.run(&Registry::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert_eq!(result.exit, 0, "{:?}\n{text}", result.diagnostics);
    result
}

fn refused(text: &str) -> String {
    match read(text) {
        Err(faults) => faults,
        Ok(case) => case.run(&Registry::default()).expect_err("refused").to_string(),
    }
}

#[test]
fn a_block_on_a_plane_has_a_uniform_pressure_by_every_method_on_all_cells() {
    for cells in CELLS {
        for method in ["lagrange", "augmented", "nitsche"] {
            let contact = format!("name = \"floor\"\nmethod = \"{method}\"");
            let result = run(&with(&[("backend = \"iga\"", cells), ("name = \"floor\"", &contact)]));
            let found = result.contact.get("floor").unwrap();
            if method == "lagrange" {
                kkt(&result, 1.0);
            }
            assert!((found.force[2] - 8e-4).abs() < 1e-15 && found.force[..2].iter().all(|f| f.abs() < 1e-15), "{cells} {found:?}");
            assert!((found.pressure.max - 1e-3).abs() < 1e-15 && (found.pressure.min - 1e-3).abs() < 1e-15, "{cells} {method}");
            assert!((found.area - 0.8).abs() < 1e-12, "{cells} {method}: {}", found.area);
            let faying_cli::result::Moment::Space(moment) = &found.moment else { panic!("three numbers") };
            let wanted = [0.4 * 8e-4, -0.5 * 8e-4, 0.0];
            assert!(moment.iter().zip(wanted).all(|(m, w)| (m - w).abs() < 1e-15), "{cells} {method}: {moment:?}");
            assert_eq!(found.displacement.as_deref(), Some(&[0.0; 3][..]));
            assert_eq!((found.segments.outside, found.segments.lost), (None, None), "an obstacle has no cells");
        }
    }
}

/// An edge of the slave is held along the normal, as the uniform state moves it: p/p is lowered there on all cells.
#[test]
fn functions_of_an_edge_that_is_held_along_the_normal_have_no_multiplier_of_their_own() {
    for (cells, degree) in CELLS.into_iter().flat_map(|cells| [1, 2, 3].map(|p| (cells, p))) {
        for part in ["", "where = \"y > 0.8/3 - 1e-6\"\n"] {
            let held = "\n[[boundary]]\non = \"block.u1\"\ndirichlet = { z = \"-1e-3*z\" }\n[[contact]]";
            let contact = format!("name = \"floor\"\nmultiplier = \"p/p\"\n{part}");
            let below = "[[boundary]]\non = \"block.bottom\"\nwhere = \"y < 0.8/3 + 1e-6\"\nfix = [\"z\"]\n";
            let held = if part.is_empty() { held.to_owned() } else { held.replace("[[contact]]", &format!("{below}[[contact]]")) };
            let text = with(&[("[[contact]]", &held), ("backend = \"iga\"", cells), ("degree = 2", &format!("degree = {degree}"))]);
            let result = run(&text.replace("name = \"floor\"", &contact));
            let found = result.contact.get("floor").unwrap();
            assert!(
                (found.pressure.max - 1e-3).abs() < 1e-12 && (found.pressure.min - 1e-3).abs() < 1e-12,
                "{cells} {degree} {part}: {found:?}"
            );
        }
    }
}

#[test]
fn the_multiplier_of_auto_is_named_and_counted() {
    for (cells, degree, name, functions) in [
        (CELLS[0], 2, "p/p-2", 9),
        (CELLS[1], 2, "p/p-2", 9),
        (CELLS[2], 2, "p/p-1", 16),
        (CELLS[2], 1, "p/p", 16),
        (CELLS[0], 1, "p/p", 16),
    ] {
        let result = run(&with(&[("backend = \"iga\"", cells), ("degree = 2", &format!("degree = {degree}"))]));
        let multiplier = result.contact.get("floor").unwrap().multiplier.clone().unwrap();
        assert_eq!((multiplier.name.as_str(), multiplier.functions), (name, functions), "{cells} {degree}");
        assert_eq!(result.unknowns.multipliers, functions);
    }
}

#[test]
fn every_kind_of_obstacle_of_space_carries_the_load() {
    let plane = "kind = \"half-plane\", point = [0, 0, 0], normal = [0, 0, 1]";
    for kind in [
        "kind = \"sphere\", center = [0.4, 0.3, -3], radius = 3",
        "kind = \"cylinder\", center = [0.4, 0.3, -2], axis = [1, 0.2, 0], radius = 2",
        "kind = \"torus\", center = [0.5, -1.1, -1], axis = [0, 0, 1], radius = [1.5, 1.0]",
        "kind = \"level-set\", f = \"z + 0.1*x^2 + 0.2*y^2\"",
        "kind = \"level-set\", f = \"z + 0.1*x^2\", along = [0, 0, 1]",
    ] {
        let result = run(&with(&[(plane, kind), ("pressure = 1e-3", "dirichlet = { x = 0, y = 0, z = \"-0.02\" }")]));
        let found = result.contact.get("floor").unwrap();
        assert!(found.force[2] > 0.0 && found.active > 0, "{kind}: {found:?}");
        kkt(&result, 1.0);
        // driven by a force it carries that force
        let driven = format!("{kind}, force = {{ z = 2e-3 }}");
        let result = run(&with(&[(plane, &driven), ("pressure = 1e-3", "fix = [\"x\", \"y\", \"z\"]")]));
        let found = result.contact.get("floor").unwrap();
        assert!((found.force[2] - 2e-3).abs() < 1e-12, "{kind}: {:?}", found.force);
    }
}

#[test]
fn what_is_not_there_is_said_with_what_is() {
    let plane = "kind = \"half-plane\", point = [0, 0, 0], normal = [0, 0, 1]";
    let text = refused(&with(&[(plane, "kind = \"disc-sector\", radius = 1, angle_deg = [0, 90]")]));
    assert!(text.contains("E044") && text.contains("this disc-sector is plane") && text.contains("cylinder"), "{text}");
    let text = refused(&with(&[(plane, "kind = \"torus\", center = [0, 0, -2], axis = [0, 0, 1], radius = [1, 1]")]));
    assert!(text.contains("E015") && text.contains("thinner"), "{text}");
    let named = |cells: &str, multiplier: &str, degree: usize| {
        let changes = [
            ("backend = \"iga\"", cells.to_owned()),
            ("degree = 2", format!("degree = {degree}")),
            ("name = \"floor\"", format!("name = \"floor\"\nmultiplier = \"{multiplier}\"")),
        ];
        with(&changes.each_ref().map(|(from, to)| (*from, to.as_str())))
    };
    let text = refused(&named(CELLS[2], "dual", 2));
    assert!(text.contains("E064") && text.contains("lumped weight") && text.contains("p/p, p/p-1, constant"), "{text}");
    let text = refused(&named(CELLS[2], "p/p-2", 2));
    assert!(text.contains("E064") && text.contains("this side has p/p, p/p-1, constant"), "{text}");
    let text = refused(&with(&[("backend = \"iga\"", CELLS[2]), ("name = \"floor\"", "name = \"floor\"\ncone = \"values\"")]));
    assert!(text.contains("E064") && text.contains("Greville") && !text.contains("take a multiplier"), "{text}");
    // warnings: odd pairings of tensor cells, and multipliers that jump between triangles
    let warned = |text: &str| {
        let checked = check(&read(text).unwrap(), &Registry::default(), &RunOptions::default(), &RunControl::default()).result;
        assert_eq!(checked.exit, 0, "{:?}", checked.diagnostics);
        checked.warnings.iter().any(|w| w.code == "E061")
    };
    assert!(warned(&named(CELLS[0], "p/p-1", 2)) && !warned(&named(CELLS[2], "p/p-1", 2)));
    assert!(
        warned(&named(CELLS[2], "constant", 2)) && !warned(&named(CELLS[2], "constant", 3)) && !warned(&named(CELLS[1], "constant", 2))
    );
}

#[test]
fn files_show_the_side_without_an_arc_length() {
    let case = read(&with(&[])).unwrap();
    let finished = run_case(&case, &Registry::default(), &RunOptions::default(), &RunControl::default());
    let output = finished.output.unwrap();
    let [side] = &output.sides[..] else { panic!("one side") };
    assert!(side.contact && side.name == "floor" && side.rows.len() == 9);
    assert!(side.rows.iter().all(|row| row.s.is_none() && row.active && (row.lambda[0] + 1e-3).abs() < 1e-15));
    let text = faying_cli::table::interface_csv(&side.rows);
    assert!(text.starts_with("s,x,y,z,lambda,gap,active\n,1.66666666666666"), "{text}");
    let SidePart::Surface(part) = &side.part else { panic!("a surface") };
    let names: Vec<(&str, usize)> = part.fields.iter().map(|f| (f.name.as_str(), f.components)).collect();
    assert_eq!(names, [("lambda", 1), ("gap", 1), ("active", 1), ("traction", 3), ("normal", 3), ("pressure", 1)]);
    let middle = [faying::linalg::Vector::<2>::new(0.5, 0.5)];
    let value = |k: usize| (part.fields[k].sample)(4, &middle);
    assert!((value(0)[0] + 1e-3).abs() < 1e-15 && value(1)[0].abs() < 1e-15 && value(2) == [1.0]);
    assert!((value(3)[2] - 1e-3).abs() < 1e-15 && value(4) == [0.0, 0.0, 1.0] && (value(5)[0] - 1e-3).abs() < 1e-15);
    assert!(!SideOutput::vtu(&output.sides).unwrap().is_empty());
}

/// `half_width` is one of the plane, and says so.
#[test]
fn what_belongs_to_the_plane_is_not_answered() {
    let probe = "\n[[probe]]\nname = \"w\"\nquantity = \"contact.floor.half_width\"\n";
    assert!(refused(&(with(&[]) + probe)).contains("E018"));
    assert!(run(&with(&[])).contact.get("floor").unwrap().half_width.is_none());
}

#[test]
fn the_samples_in_space_pass_their_checks() {
    for name in ["hertz-solid", "crossed-cylinders", "punch-solid", "shrink-fit-solid"] {
        for backend in [None, Some("fe")] {
            let options = ReadOptions { backend: backend.map(str::to_owned), ..ReadOptions::default() };
            let path = format!("{}/../../examples/cases/{name}.toml", env!("CARGO_MANIFEST_DIR"));
            let result = Case::read_with(&path, &options).unwrap().run(&Registry::default()).unwrap();
            assert_eq!(result.exit, 0, "{name} {backend:?}: {:?} {:?}", result.diagnostics, result.checks);
        }
    }
}
