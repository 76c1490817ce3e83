//! Sides that touch are tied, sides that do not are not: how far facets may deviate from their surface, clearances, and contacts whose sides cannot meet.

use crate::common::peer;
use faying::basis::{BSpline, Cell, Order, TensorProduct};
use faying::geometry::{ControlPoints, Geometry, MapTable, Sag};
use faying::linalg::Vector;
use faying_cli::Case;
use faying_cli::case::ReadOptions;
use faying_cli::errors::{Diagnostics, Severity};
use faying_cli::{Registry, RunResult, Status};
use std::path::Path;
use tempfile::TempDir;

fn try_run(folder: &Path, text: &str) -> Result<RunResult, Diagnostics> {
    let options = ReadOptions { folder: Some(folder.to_owned()), ..ReadOptions::default() };
    Case::parse("case.toml", text, &options)?.run(&Registry::default())
}

fn run(folder: &Path, text: &str) -> RunResult {
    let result = try_run(folder, text).unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert_eq!(result.status, Status::Ok, "{:?}\n{text}", result.diagnostics);
    result
}

/// Pairs that an interface ties, and warnings about distances.
fn tied(result: &RunResult) -> (Vec<(String, String)>, Vec<String>) {
    let sides = result.interface.iter().flat_map(|(_, i)| &i.sides);
    let mut pairs: Vec<(String, String)> =
        sides.map(|s| if s.slave < s.master { (s.slave.clone(), s.master.clone()) } else { (s.master.clone(), s.slave.clone()) }).collect();
    pairs.sort();
    (pairs, apart(result))
}

fn apart(result: &RunResult) -> Vec<String> {
    result.warnings.iter().filter(|w| w.code == "E023").map(|w| w.message.clone()).collect()
}

fn pair(a: &str, b: &str) -> (String, String) {
    (a.into(), b.into())
}

/// True deviation of every chord of `curve` between the parameters `at` over its sag: the largest and the least.
fn ratios(curve: impl Fn(f64) -> Vector<2>, at: &[f64]) -> [f64; 2] {
    let n = at.len() - 1;
    let points: Vec<Vector<2>> = at.iter().map(|&a| curve(a)).collect();
    let chords = ControlPoints { basis: BSpline::uniform(1, n, 0), points: points.clone() };
    let sag = Sag::of(&chords, &vec![1.0; n]);
    (0..n).fold([0.0, f64::MAX], |[most, least], e| {
        let t = (points[e + 1] - points[e]).normalize();
        let off = |k: usize| {
            let x = curve(at[e] + (at[e + 1] - at[e]) * k as f64 / 200.0) - points[e];
            (x[0] * t[1] - x[1] * t[0]).abs()
        };
        let ratio = (0..=200).map(off).fold(0.0, f64::max) / sag.of_facet(e);
        [f64::max(most, ratio), f64::min(least, ratio)]
    })
}

/// Parameters from 0 to `end` whose steps alternate 1 : `ratio`.
fn graded(end: f64, n: usize, ratio: f64) -> Vec<f64> {
    let steps: Vec<f64> = (0..n).map(|k| if k % 2 == 0 { 1.0 } else { ratio }).collect();
    let sum: f64 = steps.iter().sum();
    let mut at = vec![0.0];
    steps.iter().for_each(|s| at.push(at[at.len() - 1] + s * end / sum));
    at
}

#[test]
fn sag_of_arcs_is_right_to_5_percent_also_where_neighbours_differ_by_5() {
    for (n, ratio) in [(6, 1.0), (8, 5.0), (12, 0.2), (40, 5.0), (5, 2.0)] {
        let [most, least] = ratios(|a| Vector::<2>::new(a.cos(), a.sin()), &graded(2.0, n, ratio));
        println!("{n} {ratio}: {least} to {most}");
        assert!(most <= 1.05 && least >= 0.9, "{n} {ratio}: {least} to {most}");
    }
}

#[test]
fn ellipses_in_few_facets_stay_within_the_factor_that_is_allowed() {
    for n in [16, 24, 48, 96] {
        let [most, _] = ratios(|a| Vector::<2>::new(3.0 * a.cos(), a.sin()), &graded(std::f64::consts::TAU, n, 1.0));
        println!("{n}: {most}");
        assert!(most <= 2.4, "{n}: {most}");
    }
}

#[test]
fn boxes_and_their_corners_do_not_sag() {
    let points = [[0.0, 0.0], [0.4, 0.0], [1.0, 0.0], [1.0, 0.3], [1.0, 1.0]].map(Vector::from).to_vec();
    let sag = Sag::of(&ControlPoints { basis: BSpline::uniform(1, 4, 0), points }, &[1.0; 4]);
    assert!((0..4).all(|e| sag.of_facet(e) <= 1e-16));
}

#[test]
fn quadratic_facets_of_an_arc_sag_by_no_less_than_they_deviate() {
    let n = 6;
    let at = |k: f64| Vector::<2>::new((k / n as f64).cos(), (k / n as f64).sin());
    // Bezier points of the parabola through three points
    let mut points = vec![at(0.0)];
    for e in 0..n {
        let [a, m, b] = [0.0, 0.5, 1.0].map(|d| at(e as f64 + d));
        points.extend([m * 2.0 - (a + b) * 0.5, b]);
    }
    let curve = ControlPoints { basis: BSpline::uniform(2, n, 0), points };
    let sag = Sag::of(&curve, &vec![1.0; n]);
    let mut table = MapTable::new();
    for e in 0..n {
        curve.map(e, &(0..=50).map(|k| Vector::<1>::new(k as f64 / 50.0)).collect::<Vec<_>>(), Order::Values, &mut table);
        let off = table.x.iter().map(|x| (x.norm() - 1.0).abs()).fold(0.0, f64::max);
        let ratio = off / sag.of_facet(e);
        assert!((0.15..=1.0).contains(&ratio), "{ratio}");
        assert_eq!(sag.bulge(e, Cell::Tensor, &Vector::<1>::new(0.5)), 0.0);
    }
}

#[test]
fn quadrilaterals_of_a_sphere_sag_as_they_deviate() {
    let n = 8;
    let at = |i: usize, j: usize| {
        let [a, b] = [i, j].map(|k| -0.5 + k as f64 / n as f64);
        Vector::<3>::new(a, b, 1.0).normalize()
    };
    let basis = TensorProduct::new([BSpline::uniform(1, n, 0), BSpline::uniform(1, n, 0)]);
    let points = (0..=n).flat_map(|j| (0..=n).map(move |i| at(i, j))).collect();
    let surface = ControlPoints { basis, points };
    let sag = Sag::of(&surface, &vec![1.0; n * n]);
    let mut table = MapTable::new();
    for e in (0..n * n).filter(|e| (1..n - 1).contains(&(e % n)) && (1..n - 1).contains(&(e / n))) {
        let middle = Vector::<2>::new(0.5, 0.5);
        surface.map(e, &[middle], Order::Values, &mut table);
        let ratio = (1.0 - table.x[0].norm()) / sag.of_facet(e);
        assert!((0.84..=1.05).contains(&ratio), "{e}: {ratio}");
        let raised = table.x[0].norm() + sag.bulge(e, Cell::Tensor, &middle);
        assert!((raised - 1.0).abs() <= 0.06 * sag.of_facet(e), "{raised}");
    }
}

/// A layer of `nx` bilinear cells between y0 and y1 as a Gmsh file.
fn layer(name: &str, [y0, y1]: [f64; 2], nx: usize) -> String {
    let nodes: String = (0..2)
        .flat_map(|j| {
            (0..=nx).map(move |i| format!("{} {} {} 0\n", j * (nx + 1) + i + 1, i as f64 / nx as f64, if j == 0 { y0 } else { y1 }))
        })
        .collect();
    let (mut elements, mut count) = (String::new(), 0);
    let mut push = |kind: usize, group: usize, nodes: &[usize]| {
        count += 1;
        let list: Vec<String> = nodes.iter().map(usize::to_string).collect();
        elements += &format!("{count} {kind} 2 {group} {group} {}\n", list.join(" "));
    };
    for i in 0..nx {
        push(1, 1, &[i + 1, i + 2]);
        push(1, 2, &[nx + i + 2, nx + i + 3]);
        push(3, 3, &[i + 1, i + 2, nx + i + 3, nx + i + 2]);
    }
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 1 \"bottom\"\n1 2 \"top\"\n2 3 \"{name}\"\n$EndPhysicalNames\n\
         $Nodes\n{}\n{nodes}$EndNodes\n$Elements\n{count}\n{elements}$EndElements\n",
        2 * (nx + 1)
    )
}

#[test]
fn the_far_faces_of_three_thin_layers_are_not_tied() {
    let folder = TempDir::new().unwrap();
    let mut text = "[model]\nphysics = \"poisson\"\ndimension = 2\n[discretization]\nbackend = \"fe\"\ndegree = 1\n".to_owned();
    for (k, nx) in [8, 7, 8].into_iter().enumerate() {
        let y = 0.02 * k as f64;
        std::fs::write(folder.path().join(format!("l{k}.msh")), layer(&format!("l{k}"), [y, y + 0.02], nx)).unwrap();
        text += &format!("[[patch]]\nname = \"l{k}\"\ngeometry = {{ kind = \"file\", file = \"l{k}.msh\", group = \"l{k}\" }}\n");
    }
    text += "[[interface]]\nname = \"i\"\nbetween = \"all\"\n[[boundary]]\non = \"l0.bottom\"\ndirichlet = \"0\"\n\
             [[boundary]]\non = \"l2.top\"\nneumann = \"1\"\n[[probe]]\nquantity = \"u at [0.5, 0.06]\"\n";
    let result = run(folder.path(), &text);
    let (pairs, warnings) = tied(&result);
    assert_eq!(pairs, [pair("l0.top", "l1.bottom"), pair("l1.top", "l2.bottom")]);
    assert!(warnings.is_empty(), "{warnings:?}");
    // u = y: unit flux through three layers in series
    assert!((result.probes[0].value - 0.06).abs() <= 1e-12, "{}", result.probes[0].value);
    for side in result.interface.iter().flat_map(|(_, i)| &i.sides) {
        assert!((side.share - 1.0).abs() <= 1e-9 && side.distance <= 1e-12, "{side:?}");
    }
}

/// Layers between the heights, which `between` ties where they touch; the lowest is clamped, the highest pulled.
fn layers(folder: &Path, heights: &[[f64; 2]], rest: &str) -> String {
    let mut text = fe("elasticity", 1) + "[[interface]]\nname = \"i\"\nbetween = \"all\"\n";
    for (k, y) in heights.iter().enumerate() {
        std::fs::write(folder.join(format!("l{k}.msh")), layer(&format!("l{k}"), *y, [6, 7, 9][k])).unwrap();
        text += &format!("[[patch]]\nname = \"l{k}\"\ngeometry = {{ kind = \"file\", file = \"l{k}.msh\", group = \"l{k}\" }}\n");
    }
    let last = heights.len() - 1;
    text + &format!("[[boundary]]\non = [\"l0.bottom\", \"l{last}.top\"]\ndirichlet = [\"0\", \"0.01*y\"]\n{rest}")
}

#[test]
fn sides_that_are_near_for_their_facets_are_named_and_not_tied() {
    let folder = TempDir::new().unwrap();
    let of = |gap: f64, rest: &str| run(folder.path(), &layers(folder.path(), &[[0.0, 0.5], [0.5, 1.0], [1.0 + gap, 1.5]], rest));
    for (gap, distance) in [(1e-4, "0.0001"), (1e-3, "0.001"), (5e-3, "0.005"), (-1e-3, "0.001 deep")] {
        let (pairs, warnings) = tied(&of(gap, ""));
        assert_eq!(pairs, [pair("l0.top", "l1.bottom")]);
        let [one] = &warnings[..] else { panic!("{gap}: {warnings:?}") };
        assert!(["`l1.top`", "`l2.bottom`", "not tied", distance].iter().all(|word| one.contains(word)), "{gap}: {one}");
    }
    // sides that are far away, in contact, or named; the far faces of thin layers
    let contact = "[[contact]]\nname = \"c\"\nslave = \"l2.bottom\"\nmaster = \"l1.top\"\n";
    let named = "[[interface]]\nname = \"n\"\nslave = \"l2.bottom\"\nmaster = \"l1.top\"\ntolerance = 0.01\n";
    for (gap, rest) in [(0.05, ""), (1e-3, contact), (1e-3, named)] {
        assert!(apart(&of(gap, rest)).is_empty(), "{gap} {rest}");
    }
    let thin = [0.0, 1e-3, 2e-3].map(|y| [y, y + 1e-3]);
    let (pairs, warnings) = tied(&run(folder.path(), &layers(folder.path(), &thin, "")));
    assert_eq!((pairs.len(), warnings.len()), (2, 0), "{warnings:?}");
    // nothing touches: the error names those that are nearest
    for gap in [1e-3, 0.1, -1e-3] {
        let found = try_run(folder.path(), &layers(folder.path(), &[[0.0, 0.5], [0.5 + gap, 1.0]], "")).expect_err("nothing touches");
        let fault = found.items.iter().find(|d| d.severity == Severity::Error).unwrap();
        let distance = format!(" {} ", f64::abs(gap));
        let words = ["`l0.top`", "`l1.bottom`", &distance];
        assert!(fault.code == "E023" && words.iter().all(|word| fault.message.contains(word)), "{gap}: {found}");
    }
}

/// A sector of a ring of finite elements.
fn sector(name: &str, radius: [f64; 2], degrees: f64, elements: usize, more: &str) -> String {
    format!(
        "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"annulus-sector\", center = [0, 0], radius = {radius:?}, angle_deg = [0, {degrees:?}] }}\n\
         elements = [{elements}, 2]\n{more}"
    )
}

fn fe(physics: &str, degree: usize) -> String {
    let material = if physics == "poisson" { "" } else { "[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n" };
    format!("[model]\nphysics = \"{physics}\"\ndimension = 2\n{material}[discretization]\nbackend = \"fe\"\ndegree = {degree}\n")
}

#[test]
fn the_layers_of_a_curved_sandwich_are_tied_one_after_the_other() {
    for degree in [1, 2] {
        let radii = |k: usize| [1.0 + 0.02 * k as f64, 1.02 + 0.02 * k as f64];
        let layers: String = [12, 10, 15].into_iter().enumerate().map(|(k, n)| sector(&format!("l{k}"), radii(k), 90.0, n, "")).collect();
        let text = fe("poisson", degree)
            + &layers
            + "[[interface]]\nname = \"i\"\nbetween = \"all\"\nmultiplier = \"p/p\"\n[[boundary]]\non = \"l0.v0\"\ndirichlet = \"0\"\n\
               [[boundary]]\non = \"l2.v1\"\nneumann = \"1\"\n[[probe]]\nquantity = \"u at [0.749533, 0.749533]\"\n";
        let result = run(Path::new("."), &text);
        let (pairs, warnings) = tied(&result);
        assert_eq!(pairs, [pair("l0.v1", "l1.v0"), pair("l1.v1", "l2.v0")], "degree {degree}");
        assert!(warnings.is_empty(), "{warnings:?}");
        // u = R log r for unit flux through r = R
        let exact = 1.06 * 1.06f64.ln();
        assert!((result.probes[0].value / exact - 1.0).abs() <= 0.02, "{} {exact}", result.probes[0].value);
    }
}

fn rings(degree: usize, clearance: f64, [inner, outer]: [usize; 2]) -> String {
    fe("elasticity", degree)
        + &sector("a", [0.5, 1.0], 360.0, inner, "closed = \"u\"\n")
        + &sector("b", [1.0 + clearance, 1.5], 360.0, outer, "closed = \"u\"\n")
        + "[[interface]]\nname = \"i\"\nbetween = \"all\"\n[[boundary]]\non = \"a.v0\"\nfix = [\"x\", \"y\"]\n\
           [[boundary]]\non = \"b.v1\"\ndirichlet = [\"0.01\", \"0\"]\n"
}

#[test]
fn rings_that_touch_are_tied_and_rings_with_a_clearance_are_not() {
    let sizes = [[16, 24], [24, 40], [48, 36], [96, 64]];
    for (degree, n) in [1, 2].into_iter().flat_map(|p| sizes.map(|n| (p, n))) {
        let together = run(Path::new("."), &rings(degree, 0.0, n));
        let (pairs, warnings) = tied(&together);
        assert_eq!(pairs, [pair("a.v1", "b.v0")], "{degree} {n:?}");
        assert!(warnings.is_empty(), "{degree} {n:?}: {warnings:?}");
        for clearance in [0.01, 0.02, 0.03] {
            let found = try_run(Path::new("."), &rings(degree, clearance, n)).expect_err("nothing touches");
            assert!(found.items.iter().any(|d| d.code == "E023" && d.severity == Severity::Error), "{degree} {n:?} {clearance}: {found}");
        }
    }
}

#[test]
fn a_small_clearance_is_warned_and_a_named_interface_ties_it_with_a_warning() {
    // sag of 24 chords is 0.0086: a clearance of it is not explained
    let near = try_run(Path::new("."), &rings(1, 0.0086, [24, 24])).expect_err("nothing touches");
    let warned = near.items.iter().find(|d| d.severity == Severity::Warning).expect("a warning");
    assert!(warned.message.contains("`a.v1`") && warned.message.contains("`b.v0`") && warned.message.contains("not tied"), "{near}");
    assert!(warned.message.contains("on average") && warned.message.contains("faceting would explain"), "{near}");
    let named = rings(1, 0.0086, [24, 24]).replace("between = \"all\"", "slave = \"a.v1\"\nmaster = \"b.v0\"");
    let result = run(Path::new("."), &named);
    assert_eq!(apart(&result).len(), 1, "{:?}", result.warnings);
    let forced = run(Path::new("."), &named.replace("master = \"b.v0\"", "master = \"b.v0\"\ntolerance = 0.02"));
    assert!(apart(&forced).is_empty(), "{:?}", forced.warnings);
    let found = run(Path::new("."), &rings(1, 0.0086, [24, 24]).replace("between = \"all\"", "between = \"all\"\ntolerance = 0.02"));
    assert_eq!(tied(&found).0, [pair("a.v1", "b.v0")]);
}

#[test]
fn solids_of_several_patches_as_finite_elements_are_glued_where_they_touch() {
    let Some(peer) = peer::peer_data() else { return };
    for (file, degree, elements) in
        [("gismo/volumes/fichera.xml", 1, 2), ("mfem/data/disc-nurbs.mesh", 2, 2), ("mfem/data/square-disc-nurbs.mesh", 2, 1)]
    {
        let dimension = if file.contains("volumes") { 3 } else { 2 };
        let of = |backend: &str| {
            let text = format!(
                "[model]\nphysics = \"poisson\"\ndimension = {dimension}\nsource = \"1\"\n[discretization]\nbackend = \"{backend}\"\ndegree = {degree}\n\
                 continuity = 0\n[[patch]]\nname = \"f\"\ngeometry = {{ kind = \"file\", file = \"{file}\" }}\nelements = {elements}\n\
                 [[boundary]]\non = \"all-outer\"\ndirichlet = \"0\"\n"
            );
            run(&peer, &if backend == "fe" { text.replace("continuity = 0\n", "") } else { text })
        };
        let fe = of("fe");
        assert_eq!(fe.unknowns, of("iga").unknowns, "{file}");
        assert!(apart(&fe).is_empty(), "{file}: {:?}", fe.warnings);
    }
}

/// Four quarters of a pipe of radii 2 and 3 as a G+Smo file: a straight piece of length 10, each quarter one trilinear-in-length patch of rational arcs.
fn pipe() -> String {
    let corner = |k: usize| [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]][k % 4];
    let half = 0.5f64.sqrt();
    let mut text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<xml>\n".to_owned();
    for k in 0..4 {
        let ([a, b], mut points, mut weights) = ([corner(k), corner(k + 1)], String::new(), String::new());
        for z in [0.0, 10.0] {
            for r in [2.0, 3.0] {
                for (x, w) in [(a, 1.0), ([a[0] + b[0], a[1] + b[1]], half), (b, 1.0)] {
                    points += &format!("{} {} {z}\n", r * x[0], r * x[1]);
                    weights += &format!("{w}\n");
                }
            }
        }
        let knots = |i: usize, degree: usize| {
            let list = ["0"; 4][..=degree].iter().chain(["1"; 4][..=degree].iter()).copied().collect::<Vec<_>>().join(" ");
            format!("<Basis type=\"BSplineBasis\" index=\"{i}\"><KnotVector degree=\"{degree}\">{list}</KnotVector></Basis>\n")
        };
        text += &format!(
            "<Geometry type=\"TensorNurbs3\" id=\"{k}\">\n<Basis type=\"TensorNurbsBasis3\">\n<Basis type=\"TensorBSplineBasis3\">\n{}{}{}</Basis>\n\
             <weights>\n{weights}</weights>\n</Basis>\n<coefs geoDim=\"3\">\n{points}</coefs>\n</Geometry>\n",
            knots(0, 2),
            knots(1, 1),
            knots(2, 1)
        );
    }
    text + "</xml>\n"
}

#[test]
fn the_quarters_of_a_pipe_are_glued_where_they_touch_and_nowhere_else() {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("pipe.xml"), pipe()).unwrap();
    for (degree, n) in [(1, 1), (1, 2), (2, 1), (2, 2), (3, 1)] {
        let text = format!(
            "[model]\nphysics = \"poisson\"\ndimension = 3\nsource = \"1\"\n[discretization]\nbackend = \"fe\"\ndegree = {degree}\n\
             [[patch]]\nname = \"f\"\ngeometry = {{ kind = \"file\", file = \"pipe.xml\" }}\nelements = {n}\n\
             [[boundary]]\non = \"all-outer\"\ndirichlet = \"0\"\n"
        );
        let result = run(folder.path(), &text);
        // around, through the wall, along: four quarters share four faces
        let (around, line) = (4 * n * degree, n * degree + 1);
        assert_eq!(result.unknowns.primal, around * line * line, "degree {degree}, {n} elements");
        assert!(apart(&result).is_empty(), "{:?}", result.warnings);
    }
}

/// Two blocks, b on a, pressed together by 0.01.
fn blocks(slave: &str, master: &str) -> String {
    format!(
        "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1000.0\npoisson = 0.3\n\
         [[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [2, 1] }}\nelements = [8, 4]\n\
         [[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [0.5, 1], max = [1.5, 2] }}\nelements = [5, 4]\n\
         [[contact]]\nname = \"c\"\nslave = \"{slave}\"\nmaster = \"{master}\"\n\
         [[boundary]]\non = \"a.left\"\nfix = [\"x\", \"y\"]\n[[boundary]]\non = \"b.right\"\nfix = [\"x\"]\ndirichlet = {{ y = \"-0.01\" }}\n"
    )
}

#[test]
fn contacts_whose_sides_cannot_meet_are_refused_with_the_sides_that_were_meant() {
    let good = run(Path::new("."), &blocks("b.bottom", "a.top"));
    assert!(good.contact.get("c").unwrap().force[1] > 0.0);
    for (slave, master) in [("b.bottom", "a.bottom"), ("b.left", "a.top"), ("b.top", "a.bottom"), ("b.bottom", "a.right")] {
        let found = try_run(Path::new("."), &blocks(slave, master)).expect_err("the sides cannot meet");
        let fault = found.items.iter().find(|d| d.code == "E023").unwrap_or_else(|| panic!("{slave} {master}: {found}"));
        let help = fault.help.clone().unwrap_or_default();
        assert!(help.contains("`b.bottom` on `a.top`"), "{slave} {master}: {found}");
    }
    // a list may hold sides that look elsewhere
    let listed = run(Path::new("."), &blocks("b.bottom", "a.top").replace("slave = \"b.bottom\"", "slave = [\"b.bottom\", \"b.left\"]"));
    assert!(listed.warnings.iter().any(|w| w.code == "E023" && w.message.contains("`b.left`")), "{:?}", listed.warnings);
    let force = |r: &RunResult| r.contact.get("c").unwrap().force[1];
    assert!((force(&listed) / force(&good) - 1.0).abs() <= 0.05, "{} {}", force(&listed), force(&good));
}

#[test]
fn an_overlap_at_rest_may_be_up_to_half_the_thickness_of_a_body() {
    let overlapping = |depth: f64| {
        format!(
            "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1000.0\npoisson = 0.3\n\
             [[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [1, 1] }}\nelements = [6, 8]\n\
             [[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [0, {}], max = [1, {}] }}\nelements = [5, 8]\n\
             [[contact]]\nname = \"c\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\n\
             [[boundary]]\non = \"a.bottom\"\nfix = [\"x\", \"y\"]\n[[boundary]]\non = \"b.top\"\nfix = [\"x\", \"y\"]\n",
            1.0 - depth,
            1.4 - depth
        )
    };
    // b is 0.4 thick
    for depth in [1e-3, 0.05, 0.19] {
        assert!(run(Path::new("."), &overlapping(depth)).contact.get("c").unwrap().force[1] > 0.0);
    }
    for depth in [0.21, 0.39, 0.6] {
        let found = try_run(Path::new("."), &overlapping(depth)).expect_err("too deep");
        assert!(found.items.iter().any(|d| d.code == "E023" && d.message.contains("deep")), "{depth}: {found}");
    }
}

#[test]
fn a_gap_by_formula_may_overlap_by_up_to_half_the_thickness_of_a_body() {
    let fit = |gap: &str| {
        format!(
            "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1000.0\npoisson = 0.3\n\
             [[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [1, 1] }}\nelements = [6, 8]\n\
             [[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [0, 1.02], max = [1, 1.42] }}\nelements = [5, 8]\n\
             [[contact]]\nname = \"c\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\ngap = \"{gap}\"\n\
             [[boundary]]\non = \"a.bottom\"\nfix = [\"x\", \"y\"]\n[[boundary]]\non = \"b.top\"\nfix = [\"x\", \"y\"]\n\
             [steps]\nt = [0.5, 1.0]\n"
        )
    };
    // b is 0.4 thick and 0.02 away; what comes after the first time is no overlap at rest
    for gap in ["g - 0.03", "g - 0.21", "-0.19", "g - 0.3*t"] {
        assert!(run(Path::new("."), &fit(gap)).contact.get("c").unwrap().force[1] > 0.0, "{gap}");
    }
    for gap in ["g - 0.23", "g - 1", "-0.21", "g - 0.5*t"] {
        let found = try_run(Path::new("."), &fit(gap)).expect_err("too deep");
        let fault = found.items.iter().find(|d| d.code == "E023").unwrap_or_else(|| panic!("{gap}: {found}"));
        assert!(fault.message.contains("deep") && fault.message.contains("`gap`") && fault.line == Some(20), "{gap}: {found}");
    }
}

/// Walls of three rows of three boxes with any joints and numbers of elements: sides that overlap without the middle of an element are tied,
/// too, so that linear fields are exact.
#[test]
fn walls_with_any_joints_are_tied_everywhere() {
    let folder = TempDir::new().unwrap();
    let mut state = 7_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / f64::from(1_u32 << 31)
    };
    for k in 0..24 {
        let backend = ["iga", "fe"][k % 2];
        let mut text = format!(
            "[model]\nphysics = \"poisson\"\ndimension = 2\nexact = {{ u = \"x + 2*y\" }}\n[discretization]\nbackend = \"{backend}\"\ndegree = {}\n\
             [[material]]\nname = \"m\"\n",
            2 + k / 2 % 2
        );
        let mut outer = Vec::new();
        for row in 0..3 {
            let (a, b) = (0.3 + 1.2 * random(), 1.5 + 1.2 * random());
            for (i, [from, to]) in [[0.0, a], [a, b], [b, 3.0]].into_iter().enumerate() {
                let n = 1 + (3.0 * random()) as usize;
                text += &format!(
                    "[[patch]]\nname = \"p{row}{i}\"\ngeometry = {{ kind = \"box\", min = [{from:?}, {row}], max = [{to:?}, {}] }}\nelements = [{n}, {}]\n",
                    row + 1,
                    1 + (2.0 * random()) as usize
                );
                let open = [(row == 0, "bottom"), (row == 2, "top"), (i == 0, "left"), (i == 2, "right")];
                outer.extend(open.into_iter().filter(|o| o.0).map(|(_, side)| format!("\"p{row}{i}.{side}\"")));
            }
        }
        text +=
            &format!("[[interface]]\nname = \"t\"\nbetween = \"all\"\n[[boundary]]\non = [{}]\ndirichlet = \"exact\"\n", outer.join(", "));
        let result = run(folder.path(), &text);
        let error = result.errors["error.u.L2"];
        assert!(error < 1e-11, "{k}: {error:e}\n{text}");
    }
}

/// A plate below a block that leans on it, one side of the block 59 degrees from the plate: `n` elements along all directions, so that the edge
/// between both sides passes through the middle of facets of the plate where `n` is odd.
fn leaning(n: usize, interface: &str) -> String {
    let solid = |name: &str, x: [f64; 2], z: f64| {
        let corner = |c: usize| {
            let shift = if c < 4 { 0.0 } else { 0.3 };
            format!("[{}, {}, {}]", x[c % 2] + shift, c / 2 % 2, if c < 4 { z } else { z + 0.5 })
        };
        let points: Vec<String> = (0..8).map(corner).collect();
        format!(
            "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"nurbs\", degree = [1, 1, 1], \
             knots = [[0, 0, 1, 1], [0, 0, 1, 1], [0, 0, 1, 1]], points = [{}] }}\nelements = [{n}, {n}, {n}]\n",
            points.join(", ")
        )
    };
    "[model]\nphysics = \"elasticity\"\ndimension = 3\nexact = { u = [\"0.001*x\", \"0.002*z\", \"0.001*y\"] }\n\
     [[material]]\nname = \"m\"\nyoung = 1\npoisson = 0.3\n"
        .to_owned()
        + &solid("plate", [0.0, 1.0], 0.0)
        + &solid("block", [0.3, 0.8], 0.5)
        + "[[boundary]]\non = \"plate.w0\"\ndirichlet = \"exact\"\n[[boundary]]\n\
           on = [\"block.w1\", \"block.u0\", \"block.u1\", \"block.v0\", \"block.v1\", \"plate.u0\", \"plate.u1\", \"plate.v0\", \"plate.v1\"]\n\
           traction = \"exact\"\n"
        + interface
}

/// Sides that have only an edge in common do not touch: they are neither tied nor told.
#[test]
fn sides_that_meet_in_an_edge_alone_do_not_touch() {
    let folder = TempDir::new().unwrap();
    for n in [2, 3, 5] {
        for interface in ["between = \"all\"", "slave = \"block.w0\"\nmaster = \"plate.w1\""] {
            let result = run(folder.path(), &leaning(n, &format!("[[interface]]\nname = \"t\"\n{interface}\n")));
            assert_eq!(tied(&result), (vec![pair("block.w0", "plate.w1")], vec![]), "{n} {interface}");
        }
    }
}

/// One quadratic element on a quarter of a ring: its nodes lie on the circle, its middle does not.
#[test]
fn an_element_that_leaves_its_arc_between_its_nodes_is_tied_by_name_with_a_warning() {
    let folder = TempDir::new().unwrap();
    let ring = |name: &str, radius: &str, more: &str| {
        format!(
            "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"annulus-sector\", radius = {radius}, angle_deg = [0, 90], extrude = 1 }}\n\
             elements = [1, 1, 2]\ndegree = 2\n{more}\n"
        )
    };
    let text = "[model]\nphysics = \"poisson\"\ndimension = 3\n[[material]]\nname = \"m\"\n".to_owned()
        + &ring("inner", "[1, 1.5]", "backend = \"fe\"")
        + &ring("outer", "[1.5, 2]", "")
        + "[[boundary]]\non = \"inner.v0\"\ndirichlet = 1.0\n[[boundary]]\non = \"outer.v1\"\ndirichlet = 0.0\n\
           [[interface]]\nname = \"t\"\nslave = \"inner.v1\"\nmaster = \"outer.v0\"\n";
    let (sides, warnings) = tied(&run(folder.path(), &text));
    assert_eq!(sides, [pair("inner.v1", "outer.v0")]);
    assert!(warnings.len() == 1 && warnings[0].contains("tied because they are named"), "{warnings:?}");
}
