//! Sides of which a block joins a part, by a tag of a mesh or by `where`: `between` ties the rest of them, and what nothing joins is told.

use faying_cli::case::ReadOptions;
use faying_cli::{Case, Diagnostics, Registry, RunResult, Status};

/// Cells of the strip: 0 to 6 along x.
const CELLS: usize = 6;

/// A tag of the strip's top, and its first and last cells, from 1.
type Tag = (&'static str, [usize; 2]);

/// Half of the top each, and all of it.
const HALVES: [Tag; 3] = [("top0", [1, 3]), ("top1", [4, 6]), ("top", [1, 6])];

/// A strip of unit squares or cubes as a file, with the tags "bottom", "end", in space "front", and `tags` on its top, which may overlap.
fn strip(dimension: usize, tags: &[Tag]) -> String {
    let (mut text, stride) = (String::from("*NODE\n"), CELLS + 1);
    // nodes by layer: the corners of a square in the plane, those of the bottom and then those of the top in space
    let layers: &[[usize; 2]] = if dimension == 2 { &[[0, 0], [1, 0]] } else { &[[0, 0], [1, 0], [0, 1], [1, 1]] };
    for (layer, [a, b]) in layers.iter().enumerate() {
        for i in 0..=CELLS {
            let rest = if dimension == 2 { format!("{a}") } else { format!("{a}, {b}") };
            text += &format!("{}, {i}, {rest}\n", 1 + layer * stride + i);
        }
    }
    let node = |layer: usize, i: usize| 1 + layer * stride + i;
    let (kind, bottom, top, end) = if dimension == 2 { ("CPE4", "S1", "S3", "S4") } else { ("C3D8", "S1", "S2", "S6") };
    text += &format!("*ELEMENT, TYPE={kind}, ELSET=all\n");
    for e in 0..CELLS {
        let mut nodes = vec![node(0, e), node(0, e + 1), node(1, e + 1), node(1, e)];
        if dimension == 3 {
            nodes.extend([node(2, e), node(2, e + 1), node(3, e + 1), node(3, e)]);
        }
        text += &format!("{}, {}\n", e + 1, nodes.iter().map(ToString::to_string).collect::<Vec<_>>().join(", "));
    }
    text += &format!("*SURFACE, NAME=bottom\nall, {bottom}\n*SURFACE, NAME=end\n1, {end}\n");
    if dimension == 3 {
        text += "*SURFACE, NAME=front\nall, S3\n";
    }
    for (tag, [first, last]) in tags {
        text += &format!("*SURFACE, NAME={tag}\n");
        (*first..=*last).for_each(|e| text += &format!("{e}, {top}\n"));
    }
    text
}

/// The strip under a block of `elements` along x, joined by `joins`, under the pressure 0.01: without lateral strain, u = -0.02 on the top.
fn pressed(dimension: usize, upper: &str, elements: usize, joins: &str) -> Result<RunResult, Diagnostics> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("strip.inp"), strip(dimension, &HALVES)).unwrap();
    let up = ["v", "w"][dimension - 2];
    let (block, counts, axis, traction, at) = if dimension == 2 {
        ("min = [0, 1], max = [6, 2]", format!("[{elements}, 2]"), "y", "[0, -0.01]", ["[1.3, 2]", "[4.6, 2]"])
    } else {
        ("min = [0, 0, 1], max = [6, 1, 2]", format!("[{elements}, 2, 2]"), "z", "[0, 0, -0.01]", ["[1.3, 0.3, 2]", "[4.6, 0.7, 2]"])
    };
    let mut text = format!(
        "[model]\nphysics = \"elasticity\"\ndimension = {dimension}\n[discretization]\ndegree = 1\n\
         [[material]]\nname = \"m\"\nyoung = 1\npoisson = 0\n\
         [[patch]]\nname = \"b\"\ngeometry = {{ kind = \"file\", file = \"strip.inp\" }}\nbackend = \"fe\"\n\
         [[patch]]\nname = \"up\"\n{upper}\ngeometry = {{ kind = \"box\", {block} }}\nelements = {counts}\n\
         [[boundary]]\non = \"b.bottom\"\nfix = [\"{axis}\"]\n[[boundary]]\non = [\"b.end\", \"up.u0\"]\nfix = [\"x\"]\n\
         [[boundary]]\non = \"up.{up}1\"\ntraction = {traction}\n"
    );
    if dimension == 3 {
        text += "[[boundary]]\non = \"up.v0\"\nfix = [\"y\"]\n[[boundary]]\non = \"b.front\"\nfix = [\"y\"]\n";
    }
    for (k, at) in at.iter().enumerate() {
        text += &format!("[[probe]]\nname = \"p{k}\"\nquantity = \"u.{axis} at {at}\"\n");
    }
    text += &joins.replace("BOTTOM", &format!("up.{up}0"));
    let options = ReadOptions { folder: Some(folder.path().to_path_buf()), ..ReadOptions::default() };
    Case::parse("case.toml", &text, &options)?.run(&Registry::default())
}

/// The blocks above: backend, elements along x.
const UPPER: [(&str, usize); 4] = [("backend = \"iga\"\ndegree = 2", 4), ("backend = \"fe\"", 9), ("backend = \"fe\"", 6), (SIMPLICES, 4)];
const SIMPLICES: &str = "backend = \"fe\"\ncells = \"simplex\"";

/// What joins a part, by a tag or by `where`, with one of both as slave; then `between`. What is joined in part and what is joined whole carry
/// the same, whoever finds the rest.
#[test]
fn the_rest_of_a_side_is_tied() {
    let join = |kind: &str, slave: &str, master: &str, more: &str| {
        format!("[[{kind}]]\nname = \"part\"\nslave = \"{slave}\"\nmaster = \"{master}\"\n{more}")
    };
    let parts = [
        join("interface", "b.top0", "BOTTOM", ""),
        join("interface", "BOTTOM", "b.top0", "where = \"x < 2.9\"\n"),
        join("interface", "BOTTOM", "b.top1", "where = \"x > 3.4\"\n"),
        join("interface", "BOTTOM", "b.top", "where = \"x < 2.9\"\n"),
        join("interface", "b.top", "BOTTOM", "where = \"x > 3\"\n"),
        join("contact", "b.top0", "BOTTOM", ""),
        join("contact", "b.top1", "BOTTOM", ""),
    ];
    for dimension in [2, 3] {
        for (upper, elements) in UPPER {
            for (part, between) in parts.iter().flat_map(|part| ["\"all\"", "[\"b\", \"up\"]"].map(|b| (part, b))) {
                let free = "[[boundary]]\non = \"all-outer\"\ntraction = ".to_owned() + ["[0, 0]\n", "[0, 0, 0]\n"][dimension - 2];
                let text = format!("{part}[[interface]]\nname = \"rest\"\nbetween = {between}\n{free}");
                let what = format!("{dimension} {upper} {elements}\n{text}");
                let result = pressed(dimension, upper, elements, &text).unwrap_or_else(|e| panic!("{e}\n{what}"));
                assert_eq!(result.status, Status::Ok, "{:?}\n{what}", result.diagnostics);
                for probe in &result.probes {
                    assert!((probe.value + 0.02).abs() < 1e-9, "{}: {}\n{what}", probe.name, probe.value);
                }
                assert!(result.warnings.iter().all(|w| w.code != "E023" && w.code != "E021"), "{:?}\n{what}", result.warnings);
            }
        }
    }
}

/// What nothing joins of a side of which another part is tied.
#[test]
fn the_rest_of_a_side_is_told_where_nothing_joins_it() {
    for dimension in [2, 3] {
        let text = "[[interface]]\nslave = \"b.top0\"\nmaster = \"BOTTOM\"\n";
        let result = pressed(dimension, UPPER[0].0, UPPER[0].1, text).unwrap_or_else(|e| panic!("{e}"));
        let told: Vec<&str> = result.warnings.iter().filter(|w| w.code == "E023").map(|w| w.message.as_str()).collect();
        let rest = "`b.top where nothing joins it` and `up.bottom` touch, and nothing joins them";
        assert!(told.contains(&rest), "{dimension}: {told:?}");
        assert!(told.iter().all(|text| !text.contains("top0")), "{dimension}: {told:?}");
        let help = result.warnings.iter().find(|w| w.message == rest).and_then(|w| w.help.clone()).unwrap_or_default();
        assert!(help.starts_with("write [[interface]] with between = [\"b\", \"up\"] to tie them"), "{help}");
    }
}

/// u = x + 2 y on the strip and a block on it, with the flux of "all-outer": it acts on every facet that nothing joins, and on no other.
#[test]
fn all_outer_is_what_nothing_joins() {
    // tags that overlap with the one that is tied, also so that their rest is in a side with facets that nothing joins
    for tags in [&HALVES[..], &[HALVES[0], HALVES[2]], &[HALVES[0], ("top1", [2, 6])]] {
        for (upper, elements) in UPPER {
            let folder = tempfile::tempdir().unwrap();
            std::fs::write(folder.path().join("strip.inp"), strip(2, tags)).unwrap();
            let text = format!(
                "[model]\nphysics = \"poisson\"\ndimension = 2\nexact = {{ u = \"x + 2*y\" }}\n[discretization]\ndegree = 1\n\
                 [[patch]]\nname = \"b\"\ngeometry = {{ kind = \"file\", file = \"strip.inp\" }}\nbackend = \"fe\"\n\
                 [[patch]]\nname = \"up\"\n{upper}\ngeometry = {{ kind = \"box\", min = [0, 1], max = [6, 2] }}\nelements = [{elements}, 2]\n\
                 [[boundary]]\non = \"b.bottom\"\ndirichlet = \"exact\"\n[[boundary]]\nname = \"rest\"\non = \"all-outer\"\nneumann = \"exact\"\n\
                 [[interface]]\nslave = \"b.top0\"\nmaster = \"up.v0\"\n[[interface]]\nbetween = \"all\"\n"
            );
            let options = ReadOptions { folder: Some(folder.path().to_path_buf()), ..ReadOptions::default() };
            let result = Case::parse("case.toml", &text, &options).and_then(|case| case.run(&Registry::default()));
            let result = result.unwrap_or_else(|e| panic!("{e}\n{text}"));
            assert_eq!(result.status, Status::Ok, "{:?}\n{text}", result.diagnostics);
            let error = result.errors["error.u.L2"];
            assert!(error < 1e-10, "{error} {tags:?}\n{text}");
            assert!(result.warnings.is_empty(), "{:?} {tags:?}\n{text}", result.warnings);
        }
    }
}
