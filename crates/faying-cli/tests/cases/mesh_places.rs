//! Supports and forces at named points, edges and inner lines and surfaces of meshes: against the same model cut into patches that are glued
//! there, whose sides, edges and corners they are.

use faying_cli::case::ReadOptions;
use faying_cli::errors::Diagnostics;
use faying_cli::{Case, Registry, RunResult, Status};
use std::fmt::Write as _;
use tempfile::TempDir;

/// A mesh of [0, 2] x [0, 1] (x [0, 1]) with `n` cells along every unit: quadrilaterals or triangles, hexahedra. Groups are the sides "left"
/// and "right", across the middle "middle", its corner or edge "pin", the point "tip" at the end.
struct Grid {
    dimension: usize,
    n: usize,
    simplex: bool,
    /// x and y change places: the middle is a level.
    upright: bool,
}

impl Grid {
    fn text(&self) -> String {
        let (n, d) = (self.n, self.dimension);
        let counts = [2 * n + 1, n + 1, if d == 3 { n + 1 } else { 1 }];
        let node = |[i, j, k]: [usize; 3]| 1 + i + counts[0] * (j + counts[1] * k);
        let mut text = String::from("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n6\n");
        for (number, (name, dimension)) in
            [("left", d - 1), ("right", d - 1), ("middle", d - 1), ("pin", d - 2), ("tip", 0), ("body", d)].iter().enumerate()
        {
            writeln!(text, "{dimension} {} \"{name}\"", number + 1).unwrap();
        }
        text += &format!("$EndPhysicalNames\n$Nodes\n{}\n", counts.iter().product::<usize>());
        let each = || (0..counts[2]).flat_map(|k| (0..counts[1]).flat_map(move |j| (0..counts[0]).map(move |i| [i, j, k])));
        for at in each() {
            let [u, v, w] = at.map(|i| i as f64 / n as f64);
            let [x, y] = if self.upright { [v, u] } else { [u, v] };
            writeln!(text, "{} {x} {y} {w}", node(at)).unwrap();
        }
        let mut elements: Vec<(usize, usize, Vec<usize>)> = Vec::new();
        let add = |a: [usize; 3], b: [usize; 3]| [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
        let square = |a: [usize; 3], u: [usize; 3], v: [usize; 3]| [a, add(a, u), add(add(a, u), v), add(a, v)].map(node);
        let [u, v, w] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
        for j in 0..n {
            for (group, i) in [(1, 0), (2, 2 * n), (3, n)] {
                match d {
                    2 => elements.push((1, group, vec![node([i, j, 0]), node([i, j + 1, 0])])),
                    _ => elements.extend((0..n).map(|k| (3, group, square([i, j, k], v, w).to_vec()))),
                }
            }
            if d == 3 {
                elements.push((1, 4, vec![node([n, 0, j]), node([n, 0, j + 1])]));
            }
        }
        if d == 2 {
            elements.push((15, 4, vec![node([n, 0, 0])]));
        }
        elements.push((15, 5, vec![node([2 * n, n, counts[2] - 1])]));
        for at in each().filter(|at| at[0] < 2 * n && at[1] < n && (d == 2 || at[2] < n)) {
            let [a, b, c, e] = square(at, u, v);
            match (d, self.simplex) {
                (2, true) => elements.extend([vec![a, b, c], vec![a, c, e]].map(|t| (2, 6, t))),
                (2, false) => elements.push((3, 6, vec![a, b, c, e])),
                _ => elements.push((5, 6, [square(at, u, v), square(add(at, w), u, v)].concat())),
            }
        }
        text += &format!("$EndNodes\n$Elements\n{}\n", elements.len());
        for (k, (kind, group, nodes)) in elements.iter().enumerate() {
            let list: Vec<String> = nodes.iter().map(usize::to_string).collect();
            writeln!(text, "{} {kind} 2 {group} {group} {}", k + 1, list.join(" ")).unwrap();
        }
        text + "$EndElements\n"
    }

    /// The mesh as a patch "b", halved once.
    fn patch(&self, degree: usize) -> String {
        format!(
            "[[patch]]\nname = \"b\"\ngeometry = {{ kind = \"file\", file = \"grid.msh\" }}\nrefine = 1\ndegree = {degree}\nbackend = \"fe\"\n"
        )
    }

    /// The two halves, glued in the middle, and what they call the names of the mesh.
    fn halves(&self, degree: usize) -> String {
        let list = |v: &[f64]| v.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(", ");
        let d = self.dimension;
        let turned = |v: [f64; 3]| if self.upright { [v[1], v[0], v[2]] } else { v };
        let cells = if self.simplex { "cells = \"simplex\"\n" } else { "" };
        let half = |name: &str, from: f64| {
            let (min, max) = (turned([from, 0.0, 0.0]), turned([from + 1.0, 1.0, 1.0]));
            let n = vec![(2 * self.n).to_string(); d].join(", ");
            format!(
                "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"box\", min = [{}], max = [{}] }}\nelements = [{n}]\ndegree = {degree}\n\
                 backend = \"fe\"\n{cells}",
                list(&min[..d]),
                list(&max[..d])
            )
        };
        let [a, b] = if self.upright { ["v1", "v0"] } else { ["u1", "u0"] };
        half("a", 0.0)
            + &half("c", 1.0)
            + &format!("[[interface]]\nname = \"g\"\nslave = \"a.{a}\"\nmaster = \"c.{b}\"\ncoupling = \"glue\"\n")
    }

    /// A text about the mesh said about the halves.
    fn of_halves(&self, text: &str) -> String {
        let names = match (self.dimension, self.upright) {
            (2, false) => [("left", "a.u0"), ("right", "c.u1"), ("middle", "a.u1"), ("pin", "a.u1v0"), ("tip", "c.u1v1")],
            (2, true) => [("left", "a.v0"), ("right", "c.v1"), ("middle", "a.v1"), ("pin", "a.u0v1"), ("tip", "c.u1v1")],
            _ => [("left", "a.u0"), ("right", "c.u1"), ("middle", "a.u1"), ("pin", "a.u1v0"), ("tip", "c.u1v1w1")],
        };
        names.iter().fold(text.to_owned(), |text, (from, to)| text.replace(&format!("b.{from}\""), &format!("{to}\"")))
    }
}

fn folder(grid: &Grid) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("grid.msh"), grid.text()).unwrap();
    folder
}

fn read(folder: &TempDir, text: &str) -> Result<Case, Diagnostics> {
    let options = ReadOptions { folder: Some(folder.path().to_path_buf()), ..ReadOptions::default() };
    Case::parse("case.toml", text, &options)
}

fn run(folder: &TempDir, text: &str) -> RunResult {
    let result = read(folder, text).and_then(|case| case.run(&Registry::default())).unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert!(matches!(result.status, Status::Ok), "{:?}\n{text}", result.diagnostics);
    result
}

fn model(dimension: usize, more: &str) -> String {
    format!("[model]\nphysics = \"elasticity\"\ndimension = {dimension}\n{more}\n[[material]]\nname = \"m\"\nyoung = 1e3\npoisson = 0.3\n")
}

/// Runs what is said of the mesh and of the halves, and compares energy, displacements and the sum of all reactions.
fn same(grid: &Grid, model: &str, degree: usize, blocks: &str) -> RunResult {
    let folder = folder(grid);
    let d = grid.dimension;
    let mut probes = String::new();
    for (k, at) in [[0.37, 0.21, 0.4], [1.0, 1.0, 1.0], [1.61, 0.83, 0.7], [2.0, 0.5, 0.1]].iter().enumerate() {
        let at = if grid.upright { [at[1], at[0], at[2]] } else { *at };
        let at = at[..d].iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(", ");
        for c in &["x", "y", "z"][..d] {
            writeln!(probes, "[[probe]]\nname = \"{c}{k}\"\nquantity = \"u.{c} at [{at}]\"").unwrap();
        }
    }
    let mesh = run(&folder, &(model.to_owned() + &grid.patch(degree) + blocks + &probes));
    let halves = run(&folder, &(model.to_owned() + &grid.halves(degree) + &grid.of_halves(blocks) + &probes));
    assert!((mesh.energy / halves.energy - 1.0).abs() < 1e-9, "{} {}", mesh.energy, halves.energy);
    let size = halves.probes.iter().fold(0.0_f64, |m, p| m.max(p.value.abs()));
    for (a, b) in mesh.probes.iter().zip(&halves.probes) {
        assert!((a.value - b.value).abs() < 1e-9 * size, "{}: {} for {}\n{blocks}", a.name, a.value, b.value);
    }
    let total = |result: &RunResult, c: usize| result.reactions.iter().map(|(_, r)| r[c]).sum::<f64>();
    let most = halves.reactions.iter().flat_map(|(_, r)| r).fold(0.0_f64, |m, r| m.max(r.abs()));
    assert!(most > 0.0 && size > 0.0);
    for c in 0..d {
        assert!((total(&mesh, c) - total(&halves, c)).abs() < 1e-8 * most, "{:?} {:?}", mesh.reactions, halves.reactions);
    }
    mesh
}

fn on(regions: &str, what: &str) -> String {
    format!("[[boundary]]\non = {regions}\n{what}\n")
}

#[test]
fn an_inner_line_is_supported_and_loaded_as_the_side_of_glued_halves() {
    for (simplex, degree) in [(false, 1), (false, 2), (true, 2), (false, 3)] {
        let grid = Grid { dimension: 2, n: 3, simplex, upright: false };
        let model = model(2, "");
        let left = on("\"b.left\"", "fix = [\"x\", \"y\"]");
        let pull = on("\"b.right\"", "force = { x = 3, y = -1 }");
        let held = same(&grid, &model, degree, &(on("\"b.middle\"", "fix = [\"x\", \"y\"]") + &pull));
        assert!((held.reactions.get("b.middle").unwrap()[0] + 3.0).abs() < 1e-9);
        same(&grid, &model, degree, &(left.clone() + &pull + &on("\"b.middle\"", "fix = [\"y\"]")));
        same(&grid, &model, degree, &(left.clone() + &on("\"b.middle\"", "dirichlet = { x = \"0.01*(1 + y)\", y = 0.02 }")));
        let loaded = same(&grid, &model, degree, &(left.clone() + &on("\"b.middle\"", "force = { x = \"2 + y\", y = -2 }")));
        // over a length of 1
        assert!((loaded.reactions.get("b.left").unwrap()[0] + 2.5).abs() < 1e-9);
        // a load over the inner line and a side: 1 + 1 long
        same(&grid, &model, degree, &(left + &on("[\"b.middle\", \"b.right\"]", "force = { y = -2 }")));
    }
}

#[test]
fn points_of_a_mesh_are_supported_and_loaded_as_corners() {
    for (simplex, degree) in [(false, 1), (true, 1), (false, 2)] {
        let grid = Grid { dimension: 2, n: 2, simplex, upright: false };
        let blocks = on("\"b.left\"", "fix = [\"x\"]") + &on("\"b.pin\"", "fix = [\"y\"]") + &on("\"b.tip\"", "force = { x = 1, y = -2 }");
        let result = same(&grid, &model(2, ""), degree, &blocks);
        // equilibrium
        assert!(
            (result.reactions.get("b.pin").unwrap()[1] - 2.0).abs() < 1e-9
                && (result.reactions.get("b.left").unwrap()[0] + 1.0).abs() < 1e-9
        );
        same(
            &grid,
            &model(2, ""),
            degree,
            &(on("\"b.left\"", "fix = [\"x\", \"y\"]") + &on("[\"b.pin\", \"b.tip\"]", "force = { y = 1 }")),
        );
        same(
            &grid,
            &model(2, ""),
            degree,
            &(on("\"b.left\"", "fix = [\"x\", \"y\"]") + &on("\"b.tip\"", "dirichlet = { y = \"0.01*x\" }")),
        );
    }
}

#[test]
fn forces_on_inner_lines_of_bodies_of_revolution_are_spread_over_the_surface() {
    for upright in [false, true] {
        let grid = Grid { dimension: 2, n: 3, simplex: false, upright };
        let model = model(2, "assumption = \"axisymmetric\"");
        let held = on("\"b.left\"", "fix = [\"y\"]") + &on("\"b.right\"", "fix = [\"y\"]");
        same(&grid, &model, 2, &(held + &on("\"b.middle\"", "force = { y = \"-2 + x\" }")));
    }
}

#[test]
fn inner_surfaces_edges_and_points_of_solids_are_supported_and_loaded() {
    for degree in [1, 2] {
        let grid = Grid { dimension: 3, n: 2, simplex: false, upright: false };
        let model = model(3, "");
        let left = on("\"b.left\"", "fix = [\"x\", \"y\", \"z\"]");
        same(&grid, &model, degree, &(on("\"b.middle\"", "fix = [\"x\", \"y\", \"z\"]") + &on("\"b.right\"", "force = { x = 3, y = -1 }")));
        same(&grid, &model, degree, &(left.clone() + &on("\"b.middle\"", "force = { z = \"y*z\" }")));
        same(&grid, &model, degree, &(left.clone() + &on("\"b.pin\"", "force = { y = \"1 + z\", x = 2 }")));
        same(&grid, &model, degree, &(left.clone() + &on("\"b.pin\"", "dirichlet = { y = \"0.01*z\" }")));
        same(&grid, &model, degree, &(left + &on("\"b.pin\"", "fix = [\"y\"]") + &on("\"b.tip\"", "force = { x = 1, z = -2 }")));
    }
}

#[test]
fn what_only_sides_take_is_refused_at_its_place() {
    for (dimension, words) in
        [(2, ["a line inside of its body", "a set of points"]), (3, ["a surface inside of its body", "a set of edges"])]
    {
        let grid = Grid { dimension, n: 1, simplex: false, upright: false };
        let folder = folder(&grid);
        let components = if dimension == 2 { "[\"x\", \"y\"]" } else { "[\"x\", \"y\", \"z\"]" };
        let text = |more: &str| model(dimension, "") + &grid.patch(1) + &on("\"b.left\"", &format!("fix = {components}")) + more;
        let refused = |more: &str, code: &str, part: &str| {
            let found = match read(&folder, &text(more)) {
                Err(found) => found,
                Ok(case) => case.run(&Registry::default()).expect_err("refused"),
            };
            let fault = found.items.first().unwrap();
            assert!(
                found.items.len() == 1 && fault.code == code && fault.message.contains(part) && fault.line.is_some(),
                "{more}: {found}"
            );
        };
        for (name, words) in ["middle", "pin"].iter().zip(words) {
            let load = |what: &str| on(&format!("\"b.{name}\""), what);
            refused(&load("pressure = 1"), "E015", &format!("`b.{name}` is {words}; it takes fix, dirichlet and force"));
            refused(&load("spring = { y = 1 }"), "E015", "act on sides");
            refused(&load("rigid_force = { y = 1 }"), "E015", "act on sides");
            refused(&load("fix = [\"normal\"]"), "E015", "has no normal");
            refused(&load("force = { y = 1 }\nwhere = \"x > 0\""), "E015", "`where` chooses facets of sides");
            if dimension == 3 {
                continue;
            }
            let pair = |kind: &str| format!("[[{kind}]]\nname = \"i\"\nslave = \"b.right\"\nmaster = \"b.{name}\"\n");
            refused(&pair("contact"), "E021", &format!("`b.{name}`"));
            refused(&pair("interface"), "E021", &format!("`b.{name}`"));
        }
        refused(&on("\"b.tip\"", "pressure = 1"), "E015", "`b.tip` is a set of points");
        refused(
            &on("\"b.tap\"", "force = { y = 1 }"),
            "E021",
            "there is no side `b.tap`; sides of \"b\" are left, right; points, edges and what lies inside: middle, pin, tip",
        );
    }
}

/// A square of 2 x 2 quadrilaterals, elements 5 to 8, with its right edge as a group of two lines, 3 and 4; the last two corners of those in
/// `twisted` are exchanged.
fn square(twisted: &[usize]) -> String {
    let mut text = String::from("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 1 \"bottom\"\n1 2 \"right\"\n2 5 \"body\"\n");
    text += "$EndPhysicalNames\n$Nodes\n9\n";
    for k in 0..9 {
        writeln!(text, "{} {} {} 0", k + 1, (k % 3) as f64 / 2.0, (k / 3) as f64 / 2.0).unwrap();
    }
    text += "$EndNodes\n$Elements\n8\n1 1 2 1 1 1 2\n2 1 2 1 1 2 3\n3 1 2 2 2 3 6\n4 1 2 2 2 6 9\n";
    for (k, at) in [1, 2, 4, 5].into_iter().enumerate() {
        let [c, d] = if twisted.contains(&(5 + k)) { [at + 3, at + 4] } else { [at + 4, at + 3] };
        writeln!(text, "{} 3 2 5 5 {at} {} {c} {d}", 5 + k, at + 1).unwrap();
    }
    text + "$EndElements\n"
}

/// A quadrilateral whose corners do not follow each other has lost two of its edges: the mistake is its own, not that of the names there.
#[test]
fn twisted_quadrilaterals_are_named_by_their_number() {
    let folder = tempfile::tempdir().unwrap();
    let check = |twisted: &[usize], side: &str| {
        std::fs::write(folder.path().join("grid.msh"), square(twisted)).unwrap();
        let text = model(2, "")
            + "[[patch]]\nname = \"b\"\ngeometry = { kind = \"file\", file = \"grid.msh\" }\n"
            + &format!("[[boundary]]\non = \"{side}\"\nfix = [\"x\", \"y\"]\n");
        read(&folder, &text).and_then(|case| case.run(&Registry::default()))
    };
    for side in ["b.right", "b.bottom", "all-outer"] {
        assert!(check(&[], side).is_ok());
        // one of the two elements at the named edge, and both
        for twisted in [&[8][..], &[6], &[6, 8], &[5, 6, 7, 8]] {
            let error = check(twisted, side).unwrap_err();
            let first = &error.items[0];
            assert_eq!(first.code, "E041", "{twisted:?} {side}: {error}");
            assert!(twisted.iter().any(|k| first.message.contains(&format!("element {k} "))), "{twisted:?} {side}: {error}");
            assert!(first.help.as_ref().is_some_and(|help| help.contains("order")), "{error}");
        }
    }
}

/// Chords of quarter rings [1, 2] and [2, 3] as meshes of order 1: what they leave of the circle is told with what helps meshes that are read.
#[test]
fn facets_of_meshes_in_contact_are_told_with_what_helps_files() {
    let ring = |inner: f64, n: usize| {
        let mut text = String::from(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n5\n1 1 \"inner\"\n1 2 \"outer\"\n1 3 \"foot\"\n1 4 \"head\"\n2 5 \"ring\"\n",
        );
        text += &format!("$EndPhysicalNames\n$Nodes\n{}\n", 2 * (n + 1));
        for (k, i) in (0..=n).flat_map(|i| [i, i]).enumerate() {
            let (r, a) = (inner + (k % 2) as f64, std::f64::consts::FRAC_PI_2 * i as f64 / n as f64);
            writeln!(text, "{} {} {} 0", k + 1, r * a.cos(), r * a.sin()).unwrap();
        }
        text += &format!("$EndNodes\n$Elements\n{}\n1 1 2 3 3 1 2\n2 1 2 4 4 {} {}\n", 3 * n + 2, 2 * n + 1, 2 * n + 2);
        for i in 0..n {
            let [a, b, c, d] = [1, 2, 4, 3].map(|k| 2 * i + k);
            writeln!(text, "{} 1 2 1 1 {a} {d}\n{} 1 2 2 2 {b} {c}\n{} 3 2 5 5 {a} {b} {c} {d}", 3 * i + 3, 3 * i + 4, 3 * i + 5).unwrap();
        }
        text + "$EndElements\n"
    };
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("in.msh"), ring(1.0, 7)).unwrap();
    std::fs::write(folder.path().join("out.msh"), ring(2.0, 10)).unwrap();
    let patch = |name: &str, file: &str| format!("[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"file\", file = \"{file}\" }}\n");
    let text = |adjust: bool| {
        model(2, "[discretization]\ndegree = 1\nbackend = \"fe\"\n")
            + &patch("a", "in.msh")
            + &patch("b", "out.msh")
            + "[[boundary]]\non = [\"a.foot\", \"b.foot\"]\nfix = [\"y\"]\n[[boundary]]\non = [\"a.head\", \"b.head\"]\nfix = [\"x\"]\n"
            + "[[boundary]]\non = \"b.outer\"\npressure = 0.01\n"
            + &format!("[[contact]]\nname = \"c\"\nslave = \"b.inner\"\nmaster = \"a.outer\"\nadjust = {adjust}\n")
    };
    let told = |result: &RunResult| result.warnings.iter().find(|w| w.code == "E065" && w.message.contains("facets decide")).cloned();
    let warning = told(&run(&folder, &text(false))).expect("a warning of facets");
    // chords of both circles of radius 2: 2 (1 - cos(a/2)) each, a the angle of an element
    let sag: f64 = [7.0, 10.0].iter().map(|n| 2.0 * (1.0 - (std::f64::consts::FRAC_PI_4 / n).cos())).sum();
    let number: f64 = warning.message.split("up to ").nth(1).unwrap().split(',').next().unwrap().parse().unwrap();
    assert!((number / sag - 1.0).abs() < 0.05, "{number} {sag}");
    let help = warning.help.unwrap();
    assert!(help.contains("order 2") && help.contains("adjust = true") && !help.contains("mapping"), "{help}");
    assert!(told(&run(&folder, &text(true))).is_none());
}
