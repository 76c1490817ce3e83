//! Cases whose bodies come from files: spline files of several patches, meshes with tags, and what is refused.

use crate::common::peer;
use faying_cli::Case;
use faying_cli::case::ReadOptions;
use faying_cli::errors::Diagnostics;
use faying_cli::{Registry, RunResult, Status};
use std::path::Path;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

fn read_at(folder: &Path, text: &str) -> Result<Case, Diagnostics> {
    let options = ReadOptions { folder: Some(folder.to_owned()), ..ReadOptions::default() };
    Case::parse("case.toml", text, &options)
}

fn run_at(folder: &Path, text: &str) -> RunResult {
    let case = read_at(folder, text).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let result = case.run(&Registry::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert_eq!(result.status, Status::Ok, "{:?}\n{text}", result.diagnostics);
    result
}

fn faults(folder: &Path, text: &str) -> Diagnostics {
    match read_at(folder, text) {
        Err(found) => found,
        Ok(case) => case.run(&Registry::default()).expect_err("the case is wrong"),
    }
}

#[track_caller]
fn refused(folder: &Path, text: &str, code: &str, part: &str) {
    let found = faults(folder, text);
    assert_eq!(found.items[0].code, code, "{found}");
    assert!(found.to_string().contains(part), "{part:?} is not in\n{found}");
}

fn values(result: &RunResult) -> Vec<f64> {
    result.probes.iter().map(|p| p.value).collect()
}

fn folder_with(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

/// -div grad u = 1 with u = 0 around the patches of a file, seen at some points.
fn poisson(geometry: &str, keys: &str, points: &[[f64; 2]]) -> String {
    let mut text = format!(
        "[model]\nphysics = \"poisson\"\ndimension = 2\nsource = 1\n[[patch]]\nname = \"body\"\n\
         geometry = {{ kind = \"file\", {geometry} }}\n{keys}\n[[boundary]]\non = \"all-outer\"\ndirichlet = 0\n\
         [[probe]]\nname = \"energy\"\nquantity = \"energy\"\n[[probe]]\nname = \"area\"\nquantity = \"area.body\"\n"
    );
    for (k, [x, y]) in points.iter().enumerate() {
        text += &format!("[[probe]]\nname = \"p{k}\"\nquantity = \"u at [{x}, {y}] in body\"\n");
    }
    text
}

#[test]
fn variants_of_one_domain_have_one_solution() {
    let Some(peer) = peer::peer_data() else { return };
    let folder = peer.join("mfem/miniapps-nurbs");
    let groups: [(&[&str], f64, &[[f64; 2]]); 3] = [
        (&["two-squares-nurbs", "two-squares-nurbs-autoedge", "two-squares-nurbs-rot"], 2.0, &[[0.3, 0.4], [1.0, 0.5], [1.6, 0.2]]),
        (&["plus-nurbs", "plus-nurbs-permuted"], 5.0, &[[0.5, 1.5], [0.3, 0.2], [-0.4, 1.3], [0.0, 1.5]]),
        (&["3patch-nurbs", "3patch-nurbs-flipedge"], 3.5, &[[0.5, 0.5], [1.0, 1.0], [1.5, 1.2], [1.2, 1.5]]),
    ];
    for (names, area, points) in groups {
        for backend in ["iga", "fe"] {
            let keys = format!("backend = \"{backend}\"\ndegree = 3\nelements = 4");
            let all: Vec<Vec<f64>> =
                names.iter().map(|n| values(&run_at(&folder, &poisson(&format!("file = \"{n}.mesh\""), &keys, points)))).collect();
            for (name, one) in names.iter().zip(&all) {
                let apart = one.iter().zip(&all[0]).map(|(a, b)| ((a - b) / b).abs()).fold(0.0, f64::max);
                println!("{name} {backend}: energy {:.12}, apart {apart:.1e}", one[0]);
                assert!(apart < 1e-10, "{name} {backend}: {one:?} {:?}", all[0]);
                assert!(one[2..].iter().all(|u| *u > 0.01), "{one:?}");
            }
            assert!((all[0][1] - area).abs() < 1e-12 * area, "{}", all[0][1]);
        }
    }
}

#[test]
fn a_list_of_knots_is_the_same_as_breakpoints() {
    let Some(peer) = peer::peer_data() else { return };
    let folder = peer.join("mfem/miniapps-nurbs");
    // the list puts one knot at 0.2 of the three knot vectors: two along x, one along y; as a knot of the geometry of degree 1 it
    // would make splines less smooth there, Lagrange elements are the same
    let points = [[0.3, 0.4], [1.0, 0.5], [1.6, 0.2]];
    let by_list = "file = \"two-squares-nurbs.mesh\", refinement = \"two-squares.ref\"";
    let listed = values(&run_at(&folder, &poisson(by_list, "backend = \"fe\"\ndegree = 2\nelements = 2", &points)));
    let pieces = [0.0, 0.1, 0.2, 0.6, 1.0];
    let by_hand = format!("backend = \"fe\"\ndegree = 2\nelements = [{pieces:?}, {pieces:?}]");
    let plain = values(&run_at(&folder, &poisson("file = \"two-squares-nurbs.mesh\"", &by_hand, &points)));
    for (a, b) in listed.iter().zip(&plain) {
        assert!((a - b).abs() < 1e-10 * b.abs(), "{listed:?} {plain:?}");
    }
    refused(&folder, &poisson("file = \"two-squares-nurbs.mesh\", refinement = \"two-cubes.ref\"", "", &points), "E043", "two-cubes.ref");
}

#[test]
fn a_file_of_many_patches_is_one_body() {
    let Some(peer) = peer::peer_data() else { return };
    // linear data on the boundary of 21 patches: the solution is linear whatever the patches are
    let text = "[model]\nphysics = \"poisson\"\ndimension = 2\nexact = { u = \"x - 2*y\" }\n[[patch]]\nname = \"yeti\"\n\
                geometry = { kind = \"file\", file = \"yeti_mp2.xml\" }\ndegree = 2\n[[boundary]]\non = \"all-outer\"\ndirichlet = \"exact\"\n\
                [[probe]]\nname = \"e\"\nquantity = \"error.u.L2\"\n[[probe]]\nname = \"a\"\nquantity = \"area.yeti\"\n";
    let result = run_at(&peer.join("gismo/domain2d"), text);
    println!("yeti: error {:e}, area {}", result.probes[0].value, result.probes[1].value);
    assert!(result.probes[0].value < 1e-10 * result.probes[1].value);
    assert_eq!(result.backends.len(), 21);
}

/// Gmsh 2.2: nodes from 1, elements as (type, physical, nodes), groups as (dimension, number, name).
fn gmsh(groups: &[(usize, usize, &str)], nodes: &[[f64; 2]], elements: &[(usize, usize, Vec<usize>)]) -> String {
    let mut text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n".to_owned();
    text += &format!("$PhysicalNames\n{}\n", groups.len());
    groups.iter().for_each(|(d, n, name)| text += &format!("{d} {n} \"{name}\"\n"));
    text += &format!("$EndPhysicalNames\n$Nodes\n{}\n", nodes.len());
    nodes.iter().enumerate().for_each(|(k, x)| text += &format!("{} {:.17e} {:.17e} 0\n", k + 1, x[0], x[1]));
    text += &format!("$EndNodes\n$Elements\n{}\n", elements.len());
    for (k, (kind, physical, nodes)) in elements.iter().enumerate() {
        let list: Vec<String> = nodes.iter().map(|n| (n + 1).to_string()).collect();
        text += &format!("{} {kind} 2 {physical} 1 {}\n", k + 101, list.join(" "));
    }
    text + "$EndElements\n"
}

const GROUPS: [(usize, usize, &str); 8] = [
    (1, 1, "bottom"),
    (1, 2, "right"),
    (1, 3, "top face"),
    (1, 4, "left"),
    (2, 10, "lower"),
    (2, 11, "upper"),
    (0, 20, "tip"),
    (1, 30, "middle line"),
];

/// Triangles (order 1 or 2) of n x n squares under a map of the unit square; the lower half is group "lower", the upper "upper".
fn triangles(n: usize, order: usize, map: impl Fn(f64, f64) -> [f64; 2]) -> String {
    let m = n * order;
    let nodes: Vec<[f64; 2]> =
        (0..=m).flat_map(|j| (0..=m).map(move |i| (i, j))).map(|(i, j)| map(i as f64 / m as f64, j as f64 / m as f64)).collect();
    let node = |i: usize, j: usize| i + (m + 1) * j;
    let (line, triangle) = if order == 1 { (1, 2) } else { (8, 9) };
    let mut elements = vec![(15, 20, vec![node(m, m)])];
    let edge = |a: (usize, usize), b: (usize, usize)| -> Vec<usize> {
        let mut list = vec![node(a.0, a.1), node(b.0, b.1)];
        if order == 2 {
            list.push(node((a.0 + b.0) / 2, (a.1 + b.1) / 2));
        }
        list
    };
    for k in 0..n {
        let (a, b) = (k * order, (k + 1) * order);
        elements.push((line, 1, edge((a, 0), (b, 0))));
        elements.push((line, 2, edge((m, a), (m, b))));
        elements.push((line, 3, edge((a, m), (b, m))));
        elements.push((line, 4, edge((0, a), (0, b))));
        elements.push((line, 30, edge((a, m / 2), (b, m / 2))));
    }
    for j in 0..n {
        for i in 0..n {
            let c = |a: usize, b: usize| ((i + a) * order, (j + b) * order);
            for corners in [[c(0, 0), c(1, 0), c(1, 1)], [c(0, 0), c(1, 1), c(0, 1)]] {
                let mut list: Vec<usize> = corners.iter().map(|x| node(x.0, x.1)).collect();
                if order == 2 {
                    for (a, b) in [(0, 1), (1, 2), (2, 0)] {
                        list.push(edge(corners[a], corners[b])[2]);
                    }
                }
                elements.push((triangle, if 2 * j < n { 10 } else { 11 }, list));
            }
        }
    }
    gmsh(&GROUPS, &nodes, &elements)
}

const ELASTIC: &str = "[model]\nphysics = \"elasticity\"\ndimension = 2\n";
const STEEL: &str = "[[material]]\nname = \"steel\"\nyoung = 1.0\npoisson = 0.3\n";

#[test]
fn tags_of_curved_meshes_carry_conditions_and_quantities_at_the_right_order() {
    // a quarter ring from 1 to 2: quadratic triangles, quadratic functions: L2 of order 3, H1 of order 2
    let ring = |u: f64, v: f64| {
        let (r, a) = (1.0 + u, v * std::f64::consts::FRAC_PI_2);
        [r * a.cos(), r * a.sin()]
    };
    let folder = folder_with(&[("ring.msh", &triangles(4, 2, ring))]);
    let exact = [("poisson", "u = \"exp(x)*sin(y)\"", ""), ("elasticity", "u = [\"sin(x)*y\", \"x*x*y\"]", STEEL)];
    for (physics, exact, material) in exact {
        let case = |refine: usize| {
            format!(
                "[model]\nphysics = \"{physics}\"\ndimension = 2\nexact = {{ {exact} }}\n{material}\
                 [[patch]]\nname = \"ring\"\ngeometry = {{ kind = \"file\", file = \"ring.msh\" }}\ndegree = 2\nrefine = {refine}\n\
                 [[boundary]]\non = ['ring.\"top face\"', \"ring.bottom\"]\ndirichlet = \"exact\"\n\
                 [[boundary]]\non = \"ring.right\"\nneumann = \"exact\"\n[[boundary]]\non = \"all-outer\"\nneumann = \"exact\"\n\
                 [[probe]]\nname = \"L2\"\nquantity = \"error.u.L2\"\n[[probe]]\nname = \"H1\"\nquantity = \"error.u.H1\"\n\
                 [[probe]]\nname = \"length\"\nquantity = 'length.ring.\"top face\"'\n[[probe]]\nname = \"arc\"\nquantity = \"length.ring.right\"\n"
            )
        };
        let coarse = values(&run_at(folder.path(), &case(1)));
        let fine = values(&run_at(folder.path(), &case(2)));
        let order = |k: usize| (coarse[k] / fine[k]).log2();
        println!("{physics}: L2 {:.3} H1 {:.3}, errors {fine:?}", order(0), order(1));
        assert!(order(0) > 2.9 && order(1) > 1.9, "{coarse:?} {fine:?}");
        // halving keeps the quadratic curves: the top is straight, the arc that of the first mesh
        assert!((fine[2] - 1.0).abs() < 1e-12 && (fine[3] - coarse[3]).abs() < 1e-6, "{fine:?}");
        assert!((fine[3] - std::f64::consts::PI).abs() < 1e-3, "{fine:?}");
    }
}

#[test]
fn points_and_reactions_are_asked_for_by_their_tags() {
    let folder = folder_with(&[("square.msh", &triangles(4, 1, |x, y| [x, y]))]);
    // plane stress bar under its own traction: u.x = x, sigma = 1, reaction -1 on the left
    let text = format!(
        "{ELASTIC}assumption = \"plane-stress\"\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.0\n\
         [[patch]]\nname = \"b\"\ngeometry = {{ kind = \"file\", file = \"square.msh\" }}\ndegree = 1\n\
         [[boundary]]\non = \"b.left\"\nfix = [\"x\", \"y\"]\n[[boundary]]\non = \"b.right\"\ntraction = {{ x = 1 }}\n\
         [[probe]]\nname = \"tip\"\nquantity = \"u.x at tip\"\n[[probe]]\nname = \"r\"\nquantity = \"reaction.b.left.x\"\n"
    );
    let result = values(&run_at(folder.path(), &text));
    assert!((result[0] - 1.0).abs() < 1e-12 && (result[1] + 1.0).abs() < 1e-12, "{result:?}");
    let quoted = text.replace("b.left\"", "b.\\\"top face\\\"\"").replace("\"reaction.b.left.x\"", "'reaction.b.\"top face\".x'");
    let result = values(&run_at(folder.path(), &quoted));
    assert!((result[1] + 1.0).abs() < 1e-12, "{result:?}");
    refused(folder.path(), &text.replace("at tip", "at tap"), "E021", "points are tip");
}

#[test]
fn groups_of_one_mesh_stay_joined_unless_an_interface_names_them() {
    let folder = folder_with(&[("square.msh", &triangles(4, 1, |x, y| [x, y]))]);
    let model = "[model]\nphysics = \"poisson\"\ndimension = 2\nsource = 1\n";
    let rest = "[[boundary]]\non = \"all-outer\"\ndirichlet = 0\n[[probe]]\nname = \"e\"\nquantity = \"energy\"\n\
                [[probe]]\nname = \"m\"\nquantity = \"u at [0.5, 0.5]\"\n";
    let patch = |name: &str, group: &str| {
        format!("[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"file\", file = \"square.msh\"{group} }}\ndegree = 2\n")
    };
    let whole = values(&run_at(folder.path(), &format!("{model}{}{rest}", patch("all", ""))));
    let (a, b) = (patch("a", ", group = \"lower\""), patch("b", ", group = 11"));
    let joined = values(&run_at(folder.path(), &format!("{model}{a}{b}{rest}")));
    for (x, y) in whole.iter().zip(&joined) {
        assert!((x - y).abs() < 1e-12 * x.abs(), "{whole:?} {joined:?}");
    }
    // tied by multipliers: the same solution of matching grids
    let tie = "[[interface]]\nname = \"t\"\nslave = 'a.\"middle line\"'\nmaster = 'b.\"middle line\"'\nmultiplier = \"p/p\"\n";
    let tied = run_at(folder.path(), &format!("{model}{a}{b}{tie}{rest}"));
    assert!(tied.unknowns.multipliers > 0);
    for (x, y) in whole.iter().zip(&values(&tied)) {
        assert!((x - y).abs() < 1e-2 * x.abs(), "{whole:?} {:?}", values(&tied));
    }
    let twice = format!("{model}{a}{}{rest}", patch("b", ""));
    refused(folder.path(), &twice, "E015", "is in patches \"a\" and \"b\"");
}

#[test]
fn groups_of_one_mesh_that_meet_in_a_point_share_its_function() {
    // squares [0, 1]^2 and [1, 2]^2 of 2 x 2 quadrilaterals: node (1, 1) is in both
    let nodes: Vec<[f64; 2]> = (0..5).flat_map(|j| (0..5).map(move |i| [0.5 * f64::from(i), 0.5 * f64::from(j)])).collect();
    let mut elements = Vec::new();
    for (group, first) in [(1, 0), (2, 2)] {
        for (i, j) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let c = first + i + 5 * (first + j);
            elements.push((3, group, vec![c, c + 1, c + 6, c + 5]));
        }
    }
    for k in 0..2 {
        elements.push((1, 3, vec![k, k + 1]));
        elements.push((1, 3, vec![5 * k, 5 * k + 5]));
        elements.push((1, 3, vec![5 * k + 2, 5 * k + 7]));
        elements.push((1, 3, vec![k + 10, k + 11]));
    }
    let mesh = gmsh(&[(2, 1, "one"), (2, 2, "two"), (1, 3, "around")], &nodes, &elements);
    let folder = folder_with(&[("bow.msh", &mesh)]);
    let patch = |group: &str, more: &str| {
        format!("[[patch]]\nname = \"{group}\"\ngeometry = {{ kind = \"file\", file = \"bow.msh\", group = \"{group}\"{more} }}\n")
    };
    let rest =
        "[[boundary]]\non = 'one.around'\ndirichlet = \"x - 2*y\"\n[[probe]]\nname = \"far\"\nquantity = \"u at [1.8, 1.7] in two\"\n";
    for (degree, refine) in [(1, 0), (2, 0), (2, 1), (3, 1)] {
        let both = format!("{}refine = {refine}\n{}refine = {refine}\n", patch("one", ""), patch("two", ""));
        let text = format!("[model]\nphysics = \"poisson\"\ndimension = 2\n[discretization]\ndegree = {degree}\n{both}{rest}");
        // nothing flows through a point: all of the second square has the value there
        let found = values(&run_at(folder.path(), &text))[0];
        assert!((found + 1.0).abs() < 1e-12, "degree {degree}, refine {refine}: {found}");
    }
    // a point holds no rotation
    let model = "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1\npoisson = 0.3\n";
    let text = format!("{model}{}{}[[boundary]]\non = 'one.around'\nfix = [\"x\", \"y\"]\n", patch("one", ""), patch("two", ""));
    refused(folder.path(), &text, "E051", "body \"two\" can still move: rotation");
}

#[test]
fn a_list_of_between_parts_groups_of_one_mesh_and_all_ties_only_what_is_not_joined() {
    let folder = folder_with(&[("square.msh", &triangles(4, 1, |x, y| [x, y]))]);
    let model = "[model]\nphysics = \"poisson\"\ndimension = 2\nexact = { u = \"x - 2*y\" }\n";
    let rest = "[[boundary]]\non = \"all-outer\"\ndirichlet = \"exact\"\n[[probe]]\nname = \"e\"\nquantity = \"error.u.L2\"\n\
                [[probe]]\nname = \"m\"\nquantity = \"u at [0.4, 0.5] in a\"\n";
    let patch = |name: &str, group: &str| {
        format!("[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"file\", file = \"square.msh\", group = \"{group}\" }}\ndegree = 2\n")
    };
    let (a, b) = (patch("a", "lower"), patch("b", "upper"));
    let run = |extra: &str, tie: &str| run_at(folder.path(), &format!("{model}{a}{b}{extra}{tie}{rest}"));
    let tie = |what: &str| format!("[[interface]]\nname = \"t\"\n{what}\n");
    let named = run("", &tie("slave = 'a.\"middle line\"'\nmaster = 'b.\"middle line\"'"));
    let listed = run("", &tie("between = [\"a\", \"b\"]"));
    // the tag of the file and the common facets are one side: the line is tied once
    let measure = |r: &RunResult| r.interface.get("t").unwrap().segments.measure;
    assert!((measure(&listed) - 1.0).abs() < 1e-12, "{}", measure(&listed));
    assert!(listed.unknowns.multipliers > 0);
    assert_eq!(listed.unknowns.primal, named.unknowns.primal);
    assert_eq!(listed.unknowns.multipliers, named.unknowns.multipliers);
    for result in [&named, &listed] {
        let found = values(result);
        assert!(found[0] < 1e-11 && (found[1] + 0.6).abs() < 1e-11, "{found:?}");
    }
    // "all" leaves the groups joined and ties the box on top of them
    let lid = "[[patch]]\nname = \"lid\"\ngeometry = { kind = \"box\", min = [0, 1], max = [1, 2] }\nelements = [3, 3]\ndegree = 2\n";
    let all = run(lid, &tie("between = \"all\""));
    let top = run(lid, &tie("slave = 'b.\"top face\"'\nmaster = \"lid.bottom\""));
    assert!((measure(&all) - 1.0).abs() < 1e-12, "{}", measure(&all));
    assert_eq!((all.unknowns.primal, all.unknowns.multipliers), (top.unknowns.primal, top.unknowns.multipliers));
    assert!(values(&all)[0] < 1e-11, "{:?}", values(&all));
    // what a list has tied is not tied again by "all", whichever comes first
    let both = format!("{}[[interface]]\nname = \"l\"\nbetween = [\"a\", \"b\"]\n", tie("between = \"all\""));
    let both = run(lid, &both);
    assert!((measure(&both) - 1.0).abs() < 1e-12 && values(&both)[0] < 1e-11, "{} {:?}", measure(&both), values(&both));
    assert!((both.interface.get("l").unwrap().segments.measure - 1.0).abs() < 1e-12);
    refused(folder.path(), &format!("{model}{a}{b}{}{rest}", tie("between = \"all\"")), "E023", "that are not joined yet");
}

#[test]
fn between_takes_every_facet_once_where_tags_overlap() {
    // a square of 3 x 3 quadrilaterals with a left and a right side and a tag that holds the whole boundary
    let nodes: Vec<[f64; 2]> = (0..16).map(|k| [(k % 4) as f64 / 3.0, (k / 4) as f64 / 3.0]).collect();
    let mut elements = Vec::new();
    for k in 0..3 {
        let (left, right) = (vec![4 * k, 4 * k + 4], vec![4 * k + 3, 4 * k + 7]);
        elements.extend([(1, 1, left.clone()), (1, 2, right.clone()), (1, 3, left), (1, 3, right)]);
        elements.extend([(1, 3, vec![k, k + 1]), (1, 3, vec![12 + k, 13 + k])]);
        elements.extend((0..3).map(|i| (3, 4, vec![4 * k + i, 4 * k + i + 1, 4 * k + i + 5, 4 * k + i + 4])));
    }
    let mesh = gmsh(&[(1, 1, "left"), (1, 2, "right"), (1, 3, "skin"), (2, 4, "A")], &nodes, &elements);
    let folder = folder_with(&[("q.msh", &mesh)]);
    let patch = |name: &str, by: usize| {
        format!("[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"file\", file = \"q.msh\", move = [{by}, 0] }}\ndegree = 2\n")
    };
    for between in ["\"all\"", "[\"l\", \"r\"]"] {
        let text = format!(
            "[model]\nphysics = \"poisson\"\ndimension = 2\nexact = {{ u = \"x - 2*y\" }}\n{}{}\
             [[interface]]\nname = \"t\"\nbetween = {between}\n[[boundary]]\non = \"all-outer\"\ndirichlet = \"exact\"\n\
             [[probe]]\nname = \"e\"\nquantity = \"error.u.L2\"\n",
            patch("l", 0),
            patch("r", 1)
        );
        let result = run_at(folder.path(), &text);
        let measure = result.interface.get("t").unwrap().segments.measure;
        assert!((measure - 1.0).abs() < 1e-12 && values(&result)[0] < 1e-11, "{between}: {measure} {:?}", values(&result));
    }
}

#[test]
fn between_names_patches_of_a_spline_file_apart() {
    let Some(peer) = peer::peer_data() else { return };
    let folder = peer.join("gismo/planar");
    let text = |tie: &str| {
        format!(
            "[model]\nphysics = \"poisson\"\ndimension = 2\nexact = {{ u = \"x - 2*y\" }}\n[discretization]\ndegree = 3\n\
             [[patch]]\nname = \"P\"\ngeometry = {{ kind = \"file\", file = \"hexagon_5p.xml\" }}\nrefine = 1\n{tie}\
             [[boundary]]\non = \"all-outer\"\ndirichlet = \"exact\"\n[[probe]]\nname = \"e\"\nquantity = \"error.u.L2\"\n"
        )
    };
    let glued = run_at(&folder, &text(""));
    let parted = run_at(&folder, &text("[[interface]]\nname = \"t\"\nbetween = [\"P.0\", \"P.1\"]\n"));
    assert!(parted.unknowns.primal > glued.unknowns.primal && parted.unknowns.multipliers > 0);
    let errors = [values(&glued)[0], values(&parted)[0]];
    assert!(errors.iter().all(|e| *e < 1e-9), "{errors:?}");
    refused(&folder, &text("[[interface]]\nbetween = \"all\"\n"), "E023", "that are not joined yet");
}

#[test]
fn lists_of_sides_of_a_mesh_have_only_what_can_be_named() {
    let folder = folder_with(&[("square.msh", &triangles(4, 1, |x, y| [x, y]))]);
    let text = |side: &str| poisson("file = \"square.msh\"", "degree = 1", &[]).replace("\"all-outer\"", side);
    // the middle line lies inside: it is no side, but supports take it
    run_at(folder.path(), &text("'body.\"middle line\"'"));
    let found = faults(folder.path(), &text("'body.\"middle line\"'").replace("dirichlet = 0", "spring = 1"));
    assert!(found.items[0].code == "E015" && found.items[0].message.contains("`body.middle line` is a line inside of its body"), "{found}");
    for side in ["'body.nothing'", "'body.untagged'"] {
        let found = faults(folder.path(), &text(side));
        assert_eq!(found.items[0].code, "E021", "{found}");
        let told = found.to_string();
        let list = told.split_once("sides of \"body\" are ").expect(&told).1;
        let (list, inner) = list.lines().next().unwrap().split_once("; points, edges and what lies inside: ").expect(&told);
        assert!(list.contains("bottom") && !list.contains("middle line") && !list.contains("untagged"), "{told}");
        assert!(inner.contains("\"middle line\"") && !inner.contains("bottom"), "{told}");
        assert!(told.contains("\"all-outer\" is every side"), "{told}");
    }
}

#[test]
fn where_keeps_the_facets_whose_centre_satisfies_it() {
    let folder = folder_with(&[("square.msh", &triangles(4, 1, |x, y| [x, y]))]);
    // the top is pulled with 1 on its right half and with 2 on its left half: two parts of one side
    for geometry in ["kind = \"file\", file = \"square.msh\"", "kind = \"box\", min = [0, 0], max = [1, 1]"] {
        let (file, elements) = if geometry.contains("file") { ("'b.\"top face\"'", "") } else { ("\"b.top\"", "elements = [4, 4]\n") };
        let text = format!(
            "{ELASTIC}{STEEL}[[patch]]\nname = \"b\"\ngeometry = {{ {geometry} }}\ndegree = 1\n{elements}\
             [[boundary]]\non = \"b.bottom\"\nfix = [\"x\", \"y\"]\n\
             [[boundary]]\non = {file}\nwhere = \"x > 0.5\"\ntraction = {{ y = 1 }}\n\
             [[boundary]]\non = {file}\nwhere = \"x < 0.5\"\ntraction = {{ y = 2 }}\n\
             [[probe]]\nname = \"r\"\nquantity = \"reaction.b.bottom.y\"\n[[probe]]\nname = \"m\"\nquantity = \"balance.moment\"\n"
        );
        let result = values(&run_at(folder.path(), &text));
        assert!((result[0] + 1.5).abs() < 1e-12, "{geometry}: {result:?}");
        refused(folder.path(), &text.replace("x < 0.5", "x < -1"), "E015", "no facet of the sides of");
    }
}

#[test]
fn a_nurbs_patch_from_one_file_is_tied_to_a_mesh_from_another() {
    let gismo = r#"<?xml version="1.0" encoding="UTF-8"?>
<xml><Geometry type="TensorNurbs2" id="0"><Basis type="TensorNurbsBasis2"><Basis type="TensorBSplineBasis2">
<Basis type="BSplineBasis" index="0"><KnotVector degree="2">0 0 0 0.4 1 1 1</KnotVector></Basis>
<Basis type="BSplineBasis" index="1"><KnotVector degree="1">0 0 1 1</KnotVector></Basis></Basis>
<weights>1 1 1 1 1 1 1 1</weights></Basis>
<coefs geoDim="2">0 -0.5 0.2 -0.5 0.7 -0.5 1 -0.5 0 0 0.2 0 0.7 0 1 0</coefs></Geometry></xml>"#;
    let folder = folder_with(&[("lower.xml", gismo), ("upper.msh", &triangles(4, 1, |x, y| [x, y]))]);
    let text = format!(
        "{ELASTIC}exact = {{ u = [\"0.1*x + 0.2*y\", \"-0.3*x + 0.1*y\"] }}\n{STEEL}\
         [[patch]]\nname = \"lower\"\ngeometry = {{ kind = \"file\", file = \"lower.xml\", id = 0 }}\ndegree = 2\nelements = [2, 2]\n\
         [[patch]]\nname = \"upper\"\ngeometry = {{ kind = \"file\", file = \"upper.msh\" }}\ndegree = 2\n\
         [[interface]]\nname = \"joint\"\nslave = \"lower.top\"\nmaster = \"upper.bottom\"\n\
         [[boundary]]\non = \"all-outer\"\ndirichlet = \"exact\"\n[[probe]]\nname = \"e\"\nquantity = \"error.u.L2\"\n\
         [[probe]]\nname = \"h\"\nquantity = \"error.u.H1\"\n"
    );
    let result = values(&run_at(folder.path(), &text));
    println!("tied patch test: {result:?}");
    assert!(result.iter().all(|e| *e < 1e-10), "{result:?}");
}

#[test]
fn meshes_of_nutils_of_all_orders_and_both_versions_solve_the_same_problem() {
    let Some(peer) = peer::peer_data() else { return };
    // the files of both versions are different meshes of [0, 2] x [0, 1] (85 and 83 corners): a solution in both spaces is the same
    for name in [1, 2, 3, 4].iter().flat_map(|p| [2, 4].map(|v| format!("mesh2d_p{p}_v{v}.msh"))) {
        for patches in [&[("all", "")][..], &[("a", ", group = \"left\""), ("b", ", group = \"right\"")]] {
            let mut text =
                "[model]\nphysics = \"poisson\"\ndimension = 2\nexact = { u = \"x^2 - 2*y\" }\n[discretization]\ndegree = 2\n".to_owned();
            for (patch, group) in patches {
                text += &format!("[[patch]]\nname = \"{patch}\"\ngeometry = {{ kind = \"file\", file = \"{name}\"{group} }}\n");
            }
            let all: Vec<String> = patches.iter().map(|(p, _)| format!("area.{p}")).collect();
            text += "[[boundary]]\non = \"all-outer\"\ndirichlet = \"exact\"\n[[probe]]\nquantity = \"error.u.L2\"\n";
            text += "[[probe]]\nquantity = \"u at midpoint\"\n";
            all.iter().for_each(|a| text += &format!("[[probe]]\nquantity = \"{a}\"\n"));
            let result = values(&run_at(&peer.join("nutils"), &text));
            println!("{name}, {} bodies: {result:?}", patches.len());
            assert!(result[0] < 1e-10 && (result[2..].iter().sum::<f64>() - 2.0).abs() < 1e-12, "{name}: {result:?}");
            assert!(result[1].is_finite());
        }
    }
}

#[test]
fn what_is_wrong_with_a_file_is_said_at_its_place() {
    let mesh = triangles(2, 1, |x, y| [x, y]);
    let broken = mesh.replace("$EndNodes", "10 0 0\n$EndNodes");
    let solid = mesh.replace(" 0\n2 ", " 0.5\n2 ");
    let folder = folder_with(&[("square.msh", &mesh), ("broken.msh", &broken), ("lifted.msh", &solid), ("note.txt", "hello")]);
    let at = folder.path();
    let case = |geometry: &str| poisson(geometry, "", &[]);
    refused(at, &case("file = \"sqare.msh\""), "E003", "similar names there: square.msh");
    refused(at, &case("file = \"none/square.msh\""), "E003", "there is no folder");
    refused(at, &case("file = \".\""), "E003", "it is a folder");
    refused(at, &case("file = \"note.txt\""), "E043", "begins with \"hello\"");
    refused(at, &case("file = \"broken.msh\""), "E043", "line ");
    refused(at, &case("file = \"lifted.msh\""), "E044", "off the plane");
    refused(at, &case("file = \"square.msh\", group = \"steel\""), "E042", "there is no group \"steel\"; there are \"lower\", \"upper\"");
    refused(at, &case("file = \"square.msh\", id = 3"), "E015", "belongs to files of spline patches");
    refused(
        at,
        &poisson("file = \"square.msh\"", "elements = 4", &[]),
        "E015",
        "`elements` is not a key of patches that are read from a mesh",
    );
    refused(at, &poisson("file = \"square.msh\"", "grade = { toward = { u = 0 }, ratio = 0.1 }", &[]), "E015", "`grade`");
    let side = case("file = \"square.msh\"").replace("\"all-outer\"", "\"body.top\"");
    refused(at, &side, "E021", "sides of \"body\" are bottom, right, \"top face\", left");
    assert_eq!(faults(at, &case("file = \"sqare.msh\"")).exit(), 4);
    // the place is that of the name in the case
    let found = faults(at, &case("file = \"note.txt\""));
    assert_eq!((found.items[0].line, found.items[0].column.is_some()), (Some(7), true));
}

#[test]
fn a_mesh_stays_fe_and_says_so_where_another_backend_is_asked_for() {
    let folder = folder_with(&[("square.msh", &triangles(2, 1, |x, y| [x, y]))]);
    let text = poisson("file = \"square.msh\"", "backend = \"iga\"", &[]);
    let result = run_at(folder.path(), &text);
    assert!(result.warnings.iter().any(|w| w.message.contains("stays with backend \"fe\"")), "{:?}", result.warnings);
    assert!(run_at(folder.path(), &text.replace("backend = \"iga\"", "")).warnings.is_empty());
}

fn faying(at: &Path, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_faying")).current_dir(at).args(words).stdin(Stdio::null()).output().unwrap()
}

#[test]
fn the_effective_case_of_files_runs_where_it_lies_and_the_manifest_names_them() {
    let folder = folder_with(&[("case.toml", &poisson("file = \"mesh/square.msh\"", "degree = 2", &[[0.5, 0.5]]))]);
    std::fs::create_dir(folder.path().join("mesh")).unwrap();
    std::fs::write(folder.path().join("mesh/square.msh"), triangles(2, 1, |x, y| [x, y])).unwrap();
    let first = faying(folder.path(), &["run", "case.toml", "--json", "--vtu", "none"]);
    assert_eq!(first.status.code(), Some(0), "{}", String::from_utf8_lossy(&first.stderr));
    let manifest = std::fs::read_to_string(folder.path().join("case.out/manifest.json")).unwrap();
    assert!(manifest.contains("\"mesh/square.msh\"") && manifest.matches("\"sha256\"").count() == 2, "{manifest}");
    let again = faying(&folder.path().join("case.out"), &["run", "case.effective.toml", "--json", "--vtu", "none"]);
    assert_eq!(again.status.code(), Some(0), "{}", String::from_utf8_lossy(&again.stderr));
    let probes = |out: &Output| serde_json::from_slice::<serde_json::Value>(&out.stdout).unwrap()["probes"].clone();
    assert_eq!(probes(&first), probes(&again));
}

#[test]
fn hostile_files_end_with_a_message_and_bounded_memory() {
    let folder = folder_with(&[("self.toml", &poisson("file = \"self.toml\"", "", &[]))]);
    let at = folder.path();
    let end = |case: &str, more: &[&str]| {
        let out = faying(at, &[&["check", case], more].concat());
        (out.status.code().unwrap_or(-1), String::from_utf8_lossy(&out.stderr).into_owned())
    };
    let (code, text) = end("self.toml", &[]);
    assert!(code == 3 && text.contains("E043"), "{text}");
    std::fs::write(at.join("zero.toml"), poisson("file = \"/dev/zero\"", "", &[])).unwrap();
    let (code, text) = end("zero.toml", &[]);
    assert!(code == 4 && text.contains("no regular file"), "{text}");
    // one line of 1 GB, which takes no room on the disk
    std::fs::File::create(at.join("huge.msh")).unwrap().set_len(1 << 30).unwrap();
    std::fs::write(at.join("huge.toml"), poisson("file = \"huge.msh\"", "", &[])).unwrap();
    let (code, text) = end("huge.toml", &["--max-memory", "500MB"]);
    assert!(code == 6 && text.contains("E081") && text.contains("--max-memory"), "{text}");
    // the case itself
    let (code, text) = end("huge.msh", &[]);
    assert!(code == 6 && text.contains("longest case"), "{text}");
    #[cfg(unix)]
    if Command::new("mkfifo").arg(at.join("pipe")).status().is_ok_and(|s| s.success()) {
        std::fs::write(at.join("pipe.toml"), poisson("file = \"pipe\"", "", &[])).unwrap();
        for case in ["pipe.toml", "pipe"] {
            let (code, text) = end(case, &[]);
            assert!(code == 4 && text.contains("no regular file"), "{text}");
        }
    }
}
