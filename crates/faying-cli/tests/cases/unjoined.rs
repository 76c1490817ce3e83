//! Parts of bodies and sides of bodies that nothing joins: warnings, and errors with the part that can move.

use faying_cli::case::ReadOptions;
use faying_cli::errors::{Diagnostic, Diagnostics};
use faying_cli::{Case, Registry, RunResult};
use std::fmt::Write as _;
use std::path::Path;

fn run_in(folder: &Path, text: &str) -> Result<RunResult, Diagnostics> {
    let path = folder.join("case.toml");
    std::fs::write(&path, text).unwrap();
    Case::read_with(&path, &ReadOptions::default())?.run(&Registry::default())
}

fn run(text: &str) -> RunResult {
    let case = Case::parse("case.toml", text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    case.run(&Registry::default()).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn e023(result: &RunResult) -> Vec<&Diagnostic> {
    result.warnings.iter().filter(|w| w.code == "E023").collect()
}

/// The warning that names both sides, with a line to write.
fn names<'a>(result: &'a RunResult, a: &str, b: &str, how: &str, write: &str) -> &'a Diagnostic {
    let found = e023(result);
    let hit = found.iter().find(|w| [a, b].iter().all(|s| w.message.contains(&format!("`{s}`"))));
    let Some(warning) = hit else { panic!("{a}, {b}: {found:?}") };
    assert!(warning.message.contains(how) && warning.line.is_some(), "{how}: {warning:?}");
    assert!(warning.help.as_ref().unwrap().contains(write), "{write}: {warning:?}");
    warning
}

/// A Gmsh mesh of two rectangles of `n` by `n` quadrilaterals side by side on [0, 5] and [5, 10] times [0, 2], lengths times `size`; the
/// nodes of the middle line are shared below `shared`. With `gap` the right one begins that much later.
fn halves(n: usize, shared: usize, size: f64, gap: f64) -> String {
    let id = |side: usize, i: usize, j: usize| {
        let own = if side == 1 && i == 0 && j < shared { j * (n + 1) + n } else { side * (n + 1) * (n + 1) + j * (n + 1) + i };
        own + 1
    };
    let mut nodes = String::new();
    let grid = || (0..2).flat_map(|s| (0..=n).flat_map(move |j| (0..=n).map(move |i| (s, i, j))));
    for (s, i, j) in grid() {
        let x = size * (5.0 * (i as f64 / n as f64 + s as f64) + gap * s as f64);
        writeln!(nodes, "{} {x:?} {:?} 0", s * (n + 1) * (n + 1) + j * (n + 1) + i + 1, 2.0 * size * j as f64 / n as f64).unwrap();
    }
    let mut elements = String::new();
    let mut count = 0;
    let mut add = |kind: usize, group: usize, ids: &[usize]| {
        count += 1;
        let list: Vec<String> = ids.iter().map(usize::to_string).collect();
        writeln!(elements, "{count} {kind} 2 {group} {group} {}", list.join(" ")).unwrap();
    };
    for j in 0..n {
        add(1, 1, &[id(0, 0, j), id(0, 0, j + 1)]);
        add(1, 2, &[id(1, n, j), id(1, n, j + 1)]);
    }
    for (s, i) in (0..2).flat_map(|s| (0..n).map(move |i| (s, i))) {
        add(1, 3, &[id(s, i, n), id(s, i + 1, n)]);
    }
    for (s, j, i) in (0..2).flat_map(|s| (0..n).flat_map(move |j| (0..n).map(move |i| (s, j, i)))) {
        add(3, 4, &[id(s, i, j), id(s, i + 1, j), id(s, i + 1, j + 1), id(s, i, j + 1)]);
    }
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n4\n1 1 \"left\"\n1 2 \"right\"\n1 3 \"top\"\n2 4 \"beam\"\n$EndPhysicalNames\n\
         $Nodes\n{}\n{nodes}$EndNodes\n$Elements\n{count}\n{elements}$EndElements\n",
        2 * (n + 1) * (n + 1)
    )
}

fn beam(fixed: &str) -> String {
    format!(
        "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1e3\npoisson = 0.3\n[[patch]]\nname = \"beam\"\n\
         geometry = {{ kind = \"file\", file = \"m.msh\", group = \"beam\" }}\nbackend = \"fe\"\n[[boundary]]\non = {fixed}\nfix = [\"x\", \"y\"]\n\
         [[boundary]]\non = \"beam.top\"\npressure = 1e-3\n"
    )
}

#[test]
fn nodes_that_coincide_and_are_not_shared_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let both = beam("[\"beam.left\", \"beam.right\"]");
    for (n, shared, size) in [(4, 0, 1.0), (8, 0, 1e-3), (4, 2, 1e3), (4, 5, 1.0)] {
        std::fs::write(folder.path().join("m.msh"), halves(n, shared, size, 0.0)).unwrap();
        let result = run_in(folder.path(), &both).unwrap();
        let found = e023(&result);
        if shared > n {
            assert!(found.is_empty(), "{found:?}");
            continue;
        }
        let [warning] = found[..] else { panic!("{n} {shared}: {found:?}") };
        assert!(warning.message.contains("\"beam\"") && warning.message.contains(&format!("{} pairs", n + 1 - shared)), "{warning:?}");
        assert_eq!(warning.message.contains("2 parts"), shared == 0, "{warning:?}");
        assert!(warning.help.as_ref().unwrap().contains("[[interface]]"), "{warning:?}");
        let seen = std::process::Command::new(env!("CARGO_BIN_EXE_faying"))
            .current_dir(folder.path())
            .args(["inspect", "m.msh"])
            .output()
            .unwrap();
        let text = String::from_utf8_lossy(&seen.stdout).into_owned();
        assert!(text.contains("coincide and are not shared"), "{text}");
    }
}

/// The right part hangs on nothing: it is named by its middle and its motion, whatever holds the other one.
#[test]
fn a_part_that_can_move_is_an_error_with_its_middle_and_its_motion() {
    let folder = tempfile::tempdir().unwrap();
    for (size, gap) in [(1.0, 0.0), (1e-3, 0.0), (1e3, 0.3)] {
        std::fs::write(folder.path().join("m.msh"), halves(4, 0, size, gap)).unwrap();
        let faults = run_in(folder.path(), &beam("\"beam.left\"")).unwrap_err();
        let Some(fault) = faults.items.iter().find(|d| d.code == "E051") else { panic!("{faults}") };
        let middle = format!("({}, {})", (7.5 + gap) * size, size);
        for word in [middle.as_str(), "body \"beam\"", "translation x, translation y, rotation"] {
            assert!(fault.message.contains(word), "{word}: {fault:?}");
        }
        // held along x alone it still slides along y
        let text = beam("\"beam.left\"") + "[[boundary]]\non = \"beam.right\"\nfix = [\"x\"]\n";
        let faults = run_in(folder.path(), &text).unwrap_err();
        let fault = faults.items.iter().find(|d| d.code == "E051").unwrap();
        assert!(fault.message.contains("translation y") && !fault.message.contains("translation x"), "{fault:?}");
        // springs hold it
        let text = beam("\"beam.left\"") + "[[boundary]]\non = \"beam.right\"\nspring = { x = 1e3, y = 1e3 }\n";
        assert_eq!(run_in(folder.path(), &text).unwrap().exit, 0);
    }
}

/// Two parts of one mesh on another body that a tie holds, and on one that they press: nothing is free, and each part is seen by itself.
#[test]
fn parts_are_held_by_ties_and_contacts_of_their_own_facets() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("m.msh"), halves(4, 0, 1.0, 0.5)).unwrap();
    let cover = "[[patch]]\nname = \"cover\"\ngeometry = { kind = \"box\", min = [0, 2], max = [10.5, 3] }\nelements = [12, 2]\n";
    let base = beam("\"cover.top\"").replace("[[boundary]]\non = \"beam.top\"\npressure = 1e-3\n", "") + cover;
    let tie = "[[interface]]\nname = \"i\"\nslave = \"beam.top\"\nmaster = \"cover.bottom\"\n";
    let tied = run_in(folder.path(), &(base.clone() + tie)).unwrap();
    assert_eq!((tied.exit, tied.warnings.len()), (0, 0), "{:?}", tied.warnings);
    let pressed =
        tie.replace("[[interface]]", "[[contact]]") + "[[boundary]]\non = [\"beam.left\", \"beam.right\"]\nfix = [\"x\", \"y\"]\n";
    let base = base.replace("fix = [\"x\", \"y\"]", "dirichlet = [\"0\", \"-1e-3\"]");
    let result = run_in(folder.path(), &(base + &pressed)).unwrap();
    assert_eq!(result.exit, 0, "{:?}", result.diagnostics);
}

const POISSON: &str = "[model]\nphysics = \"poisson\"\ndimension = 2\nsource = \"1\"\n";
const ELASTIC: &str = "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1e3\npoisson = 0.3\n";

fn block(name: &str, min: [f64; 2], max: [f64; 2]) -> String {
    format!("[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"box\", min = {min:?}, max = {max:?} }}\nelements = [4, 4]\n")
}

fn on(sides: &str, what: &str) -> String {
    format!("[[boundary]]\non = {sides}\n{what}\n")
}

#[test]
fn touching_near_and_overlapping_sides_that_nothing_joins_are_told() {
    for size in [1.0, 1e-3, 1e4] {
        let two = |left: f64, rest: &str| {
            POISSON.to_owned()
                + &block("a", [0.0, 0.0], [size, size])
                + &block("b", [left * size, 0.0], [2.0 * size, size])
                + &on("[\"a.left\", \"b.right\"]", "dirichlet = \"0\"")
                + rest
        };
        let line = "slave = \"b.left\" and master = \"a.right\"";
        names(&run(&two(1.0, "")), "a.right", "b.left", "touch", line);
        names(&run(&two(1.01, "")), "a.right", "b.left", "apart", line);
        names(&run(&two(0.99, "")), "a.right", "b.left", "deep in each other", line);
        // bodies that lie in each other farther than that have no sides that nearly meet
        for deep in [0.7, 0.3] {
            let result = run(&two(deep, ""));
            let [warning] = e023(&result)[..] else { panic!("{deep}: {:?}", result.warnings) };
            assert!(warning.message.contains("\"a\" and \"b\" overlap"), "{warning:?}");
        }
        // half of a facet apart: two bodies
        assert!(e023(&run(&two(1.15, ""))).is_empty());
        let tie = "[[interface]]\nname = \"i\"\nslave = \"b.left\"\nmaster = \"a.right\"\n";
        assert!(e023(&run(&two(1.0, tie))).is_empty());
        assert!(e023(&run(&two(1.0, "[[interface]]\nname = \"i\"\nbetween = \"all\"\n"))).is_empty());
        assert!(e023(&run(&two(1.0, &(tie.to_owned() + "coupling = \"glue\"\n")))).is_empty());
        // named as outer sides
        assert!(e023(&run(&two(1.0, &on("\"a.right\"", "neumann = \"0\"")))).is_empty());
        assert_eq!(e023(&run(&two(1.0, &on("\"all-outer\"", "dirichlet = \"0\"")))).len(), 1);
    }
}

/// A T-junction of coarse boxes: the stretch between the joints has the middle of no element, and both its sides have partners.
#[test]
fn a_stretch_without_the_middle_of_an_element_is_told() {
    let wall = POISSON.to_owned()
        + &block("a", [0.0, 0.0], [0.66, 1.0])
        + &block("b", [0.66, 0.0], [1.0, 1.0])
        + &block("c", [0.0, 1.0], [0.43, 2.0])
        + &block("d", [0.43, 1.0], [1.0, 2.0])
        + &on("\"a.left\"", "dirichlet = \"0\"");
    let wall = wall.replace("elements = [4, 4]", "elements = [1, 1]");
    let tie = |name: &str, slave: &str, master: &str| format!("[[interface]]\nname = \"{name}\"\nslave = \"{slave}\"\nmaster = {master}\n");
    let tied = wall + &tie("i", "b.left", "\"a.right\"") + &tie("j", "d.left", "\"c.right\"") + &tie("k", "c.bottom", "\"a.top\"");
    let result = run(&(tied.clone() + &tie("l", "b.top", "\"d.bottom\"")));
    names(&result, "a.top", "d.bottom", "touch", "[[interface]]");
    assert_eq!(e023(&result).len(), 1, "{:?}", result.warnings);
    assert!(e023(&run(&(tied + &tie("l", "d.bottom", "[\"a.top\", \"b.top\"]")))).is_empty());
}

/// Three blocks: the third is tied to the second, the second to the first, and a hair above the first, which it should stand on.
#[test]
fn a_seam_that_is_missed_by_a_hair_is_told_among_bodies_that_are_tied() {
    let blocks = |gap: f64| {
        POISSON.to_owned()
            + &block("a", [0.0, 0.0], [2.0, 1.0])
            + &block("b", [1.0, 1.0], [2.0, 2.0])
            + &block("c", [0.0, 1.0 + gap], [1.0, 2.0])
            + &on("\"a.bottom\"", "dirichlet = \"0\"")
            + "[[interface]]\nname = \"i\"\nbetween = \"all\"\n"
    };
    assert!(e023(&run(&blocks(0.0))).is_empty());
    let result = run(&blocks(0.005));
    names(&result, "a.top", "c.bottom", "apart", "[[interface]]");
    assert_eq!(e023(&result).len(), 1, "{:?}", result.warnings);
    // layers on both sides of a thin one that they are tied to
    let layers = POISSON.to_owned()
        + &block("a", [0.0, 0.0], [2.0, 1.0])
        + &block("b", [0.0, 1.0], [2.0, 1.005])
        + &block("c", [0.0, 1.005], [2.0, 2.0])
        + &on("\"a.bottom\"", "dirichlet = \"0\"")
        + "[[interface]]\nname = \"i\"\nbetween = \"all\"\n";
    assert!(e023(&run(&layers)).is_empty(), "{:?}", run(&layers).warnings);
}

/// A square in four: three ties leave a slit, a fourth closes it.
#[test]
fn a_seam_that_is_left_out_of_many_is_told() {
    let four = POISSON.to_owned()
        + &block("a", [0.0, 0.0], [1.0, 1.0])
        + &block("b", [1.0, 0.0], [2.0, 1.0])
        + &block("c", [0.0, 1.0], [1.0, 2.0])
        + &block("d", [1.0, 1.0], [2.0, 2.0])
        + &on("\"a.left\"", "dirichlet = \"0\"");
    let tie =
        |name: &str, slave: &str, master: &str| format!("[[interface]]\nname = \"{name}\"\nslave = \"{slave}\"\nmaster = \"{master}\"\n");
    let three = four + &tie("i", "b.left", "a.right") + &tie("j", "c.bottom", "a.top") + &tie("k", "d.left", "c.right");
    let result = run(&three);
    assert_eq!(e023(&result).len(), 1, "{:?}", result.warnings);
    names(&result, "b.top", "d.bottom", "touch", "[[interface]]");
    assert!(e023(&run(&(three + &tie("l", "d.bottom", "b.top")))).is_empty());
}

#[test]
fn bodies_that_a_contact_lets_touch_are_not_told_of_their_other_sides() {
    // a key in a slot: below it contact, beside it nothing
    let slot = ELASTIC.to_owned()
        + &block("base", [0.0, 0.0], [3.0, 1.0])
        + &block("wall", [0.0, 1.0], [1.0, 2.0])
        + &block("key", [1.0, 1.0], [2.0, 2.0])
        + &on("\"base.bottom\"", "fix = [\"x\", \"y\"]")
        + &on("\"key.top\"", "dirichlet = [\"0\", \"-1e-3\"]")
        + "[[interface]]\nname = \"i\"\nslave = \"wall.bottom\"\nmaster = \"base.top\"\n[[contact]]\nname = \"c\"\nslave = \"key.bottom\"\nmaster = \"base.top\"\n";
    assert!(e023(&run(&slot)).is_empty(), "{:?}", run(&slot).warnings);
    // halves that symmetry holds in their common plane
    let halves = ELASTIC.to_owned()
        + &block("a", [-1.0, 0.0], [0.0, 1.0])
        + &block("b", [0.0, 0.0], [1.0, 1.0])
        + &on("[\"a.right\", \"b.left\"]", "fix = [\"x\"]")
        + &on("[\"a.bottom\", \"b.bottom\"]", "fix = [\"y\"]")
        + &on("[\"a.left\", \"b.right\"]", "pressure = 1e-3");
    assert!(run(&halves).warnings.is_empty());
}

#[test]
fn sides_of_one_patch_that_coincide_are_told_with_the_key_that_joins_them() {
    for (kind, axis, exact) in [("annulus-sector", "u", 1e-3), ("disc-sector", "u", 1e-3)] {
        for (scale, angles) in [(1.0, [0, 360]), (1e-3, [90, 450])] {
            let radius = if kind == "disc-sector" { format!("{:e}", 2.0 * scale) } else { format!("[{:e}, {:e}]", scale, 2.0 * scale) };
            let sides = if kind == "disc-sector" { "\"ring.v1\"" } else { "[\"ring.v0\", \"ring.v1\"]" };
            let ring = |closed: &str| {
                format!(
                    "[model]\nphysics = \"poisson\"\ndimension = 2\nexact = {{ u = \"x + 2*y\" }}\n[[patch]]\nname = \"ring\"\n\
                     geometry = {{ kind = \"{kind}\", center = [0, 0], radius = {radius}, angle_deg = {angles:?} }}\nelements = [16, 4]\n{closed}\n"
                ) + &on(sides, "dirichlet = \"exact\"")
            };
            let open = run(&ring(""));
            names(&open, "ring.u0", "ring.u1", "coincide", &format!("closed = \"{axis}\""));
            let closed = run(&ring("closed = \"u\""));
            assert!(e023(&closed).is_empty(), "{:?}", closed.warnings);
            assert!(*closed.errors.get("error.u.L2.rel").unwrap() < exact);
            // a slit that somebody has thought of
            let slit = run(&(ring("") + &on("[\"ring.u0\", \"ring.u1\"]", "neumann = \"exact\"")));
            assert!(e023(&slit).is_empty(), "{:?}", slit.warnings);
            let part = run(&ring("").replace(&format!("{angles:?}"), "[0, 270]"));
            assert!(e023(&part).is_empty(), "{:?}", part.warnings);
        }
    }
}

#[test]
fn solids_that_touch_are_told_and_coarse_facets_of_one_cylinder_too() {
    let solid = |name: &str, x: f64| {
        format!(
            "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"box\", min = [{x:?}, 0, 0], max = [{:?}, 1, 1] }}\nelements = [2, 2, 2]\n",
            x + 1.0
        )
    };
    let text = "[model]\nphysics = \"poisson\"\ndimension = 3\nsource = \"1\"\n".to_owned()
        + &solid("a", 0.0)
        + &solid("b", 1.0)
        + &on("[\"a.left\", \"b.right\"]", "dirichlet = \"0\"");
    names(&run(&text), "a.right", "b.left", "touch", "[[interface]]");
    let rings = POISSON.to_owned()
        + "[[patch]]\nname = \"in\"\nbackend = \"fe\"\ndegree = 1\ngeometry = { kind = \"annulus-sector\", center = [0, 0], radius = [1, 2], angle_deg = [0, 90] }\nelements = [7, 3]\n"
        + "[[patch]]\nname = \"out\"\ngeometry = { kind = \"annulus-sector\", center = [0, 0], radius = [2, 3], angle_deg = [0, 90] }\nelements = [10, 3]\n"
        + &on("[\"in.v0\", \"out.v1\"]", "dirichlet = \"0\"");
    names(&run(&rings), "in.v1", "out.v0", "touch", "[[interface]]");
}

#[test]
fn a_tag_of_a_mesh_may_look_like_a_corner() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("m.msh"), halves(4, 5, 1.0, 0.0).replace("\"left\"", "\"u0v0\"")).unwrap();
    let tagged = run_in(folder.path(), &beam("[\"beam.u0v0\", \"beam.right\"]")).unwrap();
    std::fs::write(folder.path().join("m.msh"), halves(4, 5, 1.0, 0.0)).unwrap();
    let plain = run_in(folder.path(), &beam("[\"beam.left\", \"beam.right\"]")).unwrap();
    assert_eq!((tagged.exit, tagged.energy), (plain.exit, plain.energy));
}

/// A thin layer between two contacts: the bodies on both sides of it are apart by its thickness.
#[test]
fn bodies_beside_a_layer_that_both_press_are_none() {
    for dimension in [2, 3] {
        for thick in [0.05, 0.01, 0.001] {
            let block = |name: &str, [from, to]: [f64; 2]| {
                let (min, max) = if dimension == 2 {
                    (format!("[0, {from}]"), format!("[1, {to}]"))
                } else {
                    (format!("[0, 0, {from}]"), format!("[1, 1, {to}]"))
                };
                let n = &[2, 2, 1][3 - dimension..];
                format!("[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"box\", min = {min}, max = {max} }}\nelements = {n:?}\n")
            };
            let text = |between: &str| {
                format!(
                    "[model]\nphysics = \"elasticity\"\ndimension = {dimension}\n[[material]]\nname = \"m\"\nyoung = 1\npoisson = 0\n{}{}{}\
                     [[boundary]]\non = [\"low.bottom\", \"high.left\", \"layer.left\"]\nfix = [\"x\", \"y\"{}]\n\
                     [[boundary]]\non = \"high.top\"\npressure = 0.001\n\
                     [[contact]]\nslave = \"low.top\"\nmaster = \"layer.bottom\"\n{between}",
                    block("low", [0.0, 1.0]),
                    block("layer", [1.0, 1.0 + thick]),
                    block("high", [1.0 + thick, 2.0]),
                    if dimension == 3 { ", \"z\"" } else { "" }
                )
            };
            let both = run(&text("[[contact]]\nslave = \"layer.top\"\nmaster = \"high.bottom\"\n"));
            assert!(e023(&both).is_empty(), "{dimension}D {thick}: {:?}", both.warnings);
            // a layer that one of them presses only
            if thick < 0.02 {
                let one = run(&text(""));
                assert!(!e023(&one).is_empty(), "{dimension}D {thick}");
            }
        }
    }
}
