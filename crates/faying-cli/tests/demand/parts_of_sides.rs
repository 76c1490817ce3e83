//! `where` of interfaces and contacts: a side with several partners; `adjust`: gaps that facets leave.

use faying_cli::case::ReadOptions;
use faying_cli::{Case, Diagnostics, Registry, RunResult, Status};

fn solve(text: &str) -> Result<RunResult, Diagnostics> {
    Case::parse("case.toml", text, &ReadOptions::default())?.run(&Registry::default())
}

/// A block [0, 2] x [1, 2] on two blocks that meet at x = 1: in plane strain without lateral strain, its top at -0.01.
fn blocks(upper: &str, lower: &str, degree: usize, joins: &str) -> String {
    format!(
        "[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\ndegree = {degree}\n\
         [[material]]\nname = \"m\"\nyoung = 100\npoisson = 0\n\
         [[patch]]\nname = \"top\"\n{upper}\ngeometry = {{ kind = \"box\", min = [0, 1], max = [2, 2] }}\nelements = [8, 3]\n\
         [[patch]]\nname = \"a\"\n{lower}\ngeometry = {{ kind = \"box\", min = [0, 0], max = [1, 1] }}\nelements = [3, 2]\n\
         [[patch]]\nname = \"b\"\n{lower}\ngeometry = {{ kind = \"box\", min = [1, 0], max = [2, 1] }}\nelements = [5, 2]\n\
         [[boundary]]\non = [\"a.bottom\", \"b.bottom\"]\nfix = [\"y\"]\n[[boundary]]\non = [\"a.left\", \"b.left\", \"top.left\"]\nfix = [\"x\"]\n\
         [[boundary]]\non = \"top.top\"\ndirichlet = {{ y = -0.01 }}\n{joins}\
         [[probe]]\nname = \"left\"\nquantity = \"stress.yy at [0.4, 1.3] in top\"\n[[probe]]\nname = \"middle\"\nquantity = \"u.y at [1, 1.5]\"\n\
         [[probe]]\nname = \"right\"\nquantity = \"stress.yy at [1.7, 0.3] in b\"\n"
    )
}

const KINDS: [&str; 3] = ["backend = \"iga\"", "backend = \"fe\"", "backend = \"fe\"\ncells = \"simplex\""];

/// Uniform compression by 0.005: sigma_yy = -0.5 everywhere.
#[test]
fn a_side_with_two_partners_carries_uniform_compression() {
    for kind in ["interface", "contact"] {
        for (upper, lower, degree) in [
            (KINDS[0], KINDS[0], 1),
            (KINDS[0], KINDS[1], 2),
            (KINDS[0], KINDS[0], 3),
            (KINDS[1], KINDS[0], 1),
            (KINDS[1], KINDS[1], 2),
            (KINDS[2], KINDS[1], 1),
            (KINDS[2], KINDS[0], 2),
        ] {
            let join = |name: &str, place: &str| {
                format!("[[{kind}]]\nname = \"on-{name}\"\nslave = \"top.bottom\"\nmaster = \"{name}.top\"\nwhere = \"{place}\"\n")
            };
            let text = blocks(upper, lower, degree, &(join("a", "x < 1") + &join("b", "x > 1")));
            let result = solve(&text).unwrap_or_else(|e| panic!("{e}\n{text}"));
            assert_eq!(result.status, Status::Ok, "{:?}\n{text}", result.diagnostics);
            for (probe, exact) in result.probes.iter().zip([-0.5, -0.0075, -0.5]) {
                assert!((probe.value - exact).abs() < 1e-10, "{}: {} instead of {exact}\n{text}", probe.name, probe.value);
            }
            let forces: Vec<&[f64]> = match kind {
                "contact" => result.contact.values().map(|c| c.force.as_slice()).collect(),
                _ => result.interface.values().map(|t| t.force.as_slice()).collect(),
            };
            for force in &forces {
                assert!((force[1] - 0.5).abs() < 1e-10, "{force:?}\n{text}");
            }
            assert_eq!(forces.len(), 2);
        }
    }
}

#[test]
fn parts_with_common_facets_and_parts_without_any_are_errors() {
    let join =
        |name: &str, place: &str| format!("[[contact]]\nname = \"on-{name}\"\nslave = \"top.bottom\"\nmaster = \"{name}.top\"\n{place}");
    for (a, b, code, part) in [
        ("where = \"x < 1.3\"\n", "where = \"x > 1\"\n", "E026", "facets that are slave twice"),
        ("where = \"x < 1\"\n", "", "E026", "is slave twice"),
        ("where = \"x < 1\"\n", "where = \"x > 7\"\n", "E015", "the centres lie in x from 0.125 to 1.875, y 1"),
        ("where = \"x < 1\"\n", "where = \"x > t\"\n", "E017", "must not depend on t"),
    ] {
        let text = blocks(KINDS[0], KINDS[0], 2, &(join("a", a) + &join("b", b)));
        let faults = solve(&text).unwrap_err().to_string();
        assert!(faults.contains(code) && faults.contains(part), "{a}{b}: {faults}");
    }
}

/// Rings of radii 0.5, 1 and 2 of one material whose surfaces touch, a quarter of each in straight facets of different number, under the
/// pressure 1e-4 outside: as one ring, q = 1e-4 (1 - a²/r²) b² / (b² - a²) at r = 1.
fn rings(adjust: &str) -> RunResult {
    fit(STRAIGHT, 1.0, adjust)
}

const STRAIGHT: &str = "backend = \"fe\"\ndegree = 1";

/// The same with another discretisation, and a radius of the bore of the outer ring.
fn fit(kind: &str, bore: f64, adjust: &str) -> RunResult {
    let text = format!(
        "[model]\nphysics = \"elasticity\"\ndimension = 2\n[discretization]\n{kind}\n\
         [[material]]\nname = \"m\"\nyoung = 100\npoisson = 0.3\n\
         [[patch]]\nname = \"inner\"\ngeometry = {{ kind = \"annulus-sector\", center = [0, 0], radius = [0.5, 1], angle_deg = [0, 90] }}\n\
         elements = [32, 12]\n\
         [[patch]]\nname = \"outer\"\ngeometry = {{ kind = \"annulus-sector\", center = [0, 0], radius = [{bore}, 2], angle_deg = [0, 90] }}\n\
         elements = [20, 12]\n\
         [[boundary]]\non = [\"inner.u0\", \"outer.u0\"]\nfix = [\"y\"]\n[[boundary]]\non = [\"inner.u1\", \"outer.u1\"]\nfix = [\"x\"]\n\
         [[boundary]]\non = \"outer.v1\"\npressure = 1e-4\n\
         [[contact]]\nname = \"fit\"\nslave = \"inner.v1\"\nmaster = \"outer.v0\"\n{adjust}"
    );
    let result = solve(&text).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(result.status, Status::Ok, "{:?}", result.diagnostics);
    result
}

#[test]
fn gaps_that_facets_leave_between_surfaces_that_touch_are_closed() {
    let exact = 1e-4 * (1.0 - 0.25) * 4.0 / (4.0 - 0.25);
    let closed = &rings("adjust = true\n");
    let fit = &closed.contact["fit"];
    assert!((fit.area / fit.segments.measure - 1.0).abs() < 1e-9, "{} of {}", fit.area, fit.segments.measure);
    // the resultant of a uniform pressure on a quarter of the circle, to the order of straight facets
    for force in &fit.force {
        assert!((force.abs() / exact - 1.0).abs() < 0.01, "{force} instead of {exact}");
    }
    assert!(fit.pressure.min > 0.8 * exact && fit.pressure.max < 1.2 * exact, "{:?} around {exact}", fit.pressure);
    assert!(!closed.warnings.iter().any(|w| w.message.contains("facets")), "{:?}", closed.warnings);
    let pressed = &rings("adjust = true\ngap = \"g - 1e-3\"\n");
    assert!(!pressed.warnings.iter().any(|w| w.message.contains("facets")), "{:?}", pressed.warnings);
    let told = &rings("gap = \"g - 1e-3\"\n");
    assert!(
        told.warnings.iter().any(|w| w.message.contains("facets") && w.help.as_ref().is_some_and(|h| h.contains("adjust"))),
        "{:?}",
        told.warnings
    );
    // a gap that is said, whatever the sides are, has no facets
    let said = &rings("gap = \"-1e-3\"\n");
    assert!(!said.warnings.iter().any(|w| w.message.contains("facets")), "{:?}", said.warnings);
    // as meshed, the corners alone carry
    let fit = &rings("").contact["fit"];
    assert!(
        fit.area < 0.5 * fit.segments.measure && fit.pressure.max > 2.0 * exact,
        "{} of {}, {:?}",
        fit.area,
        fit.segments.measure,
        fit.pressure
    );
}

/// A press fit or a clearance that is drawn is no matter of facets: it is closed, and told.
#[test]
fn fits_that_are_drawn_and_closed_are_told() {
    for bore in [0.998, 1.002, 0.9992] {
        let found = fit(STRAIGHT, bore, "adjust = true\n");
        let told = found.warnings.iter().find(|w| w.code == "E023" && w.message.contains("`adjust` of contact \"fit\" closes"));
        let told = told.unwrap_or_else(|| panic!("{bore}: {:?}", found.warnings));
        assert!(told.help.as_ref().is_some_and(|h| h.contains("`gap`")), "{told:?}");
    }
    // exact sides are where they are drawn: nothing is closed, and the fit presses
    for bore in [0.998, 0.9999, 1.0] {
        let found = fit("backend = \"fe\"\nmapping = \"exact\"\ndegree = 2", bore, "adjust = true\n");
        assert!(found.warnings.is_empty() && found.contact["fit"].pressure.min > 0.0, "{bore}: {:?}", found.warnings);
    }
}

/// A quarter ring of 1 <= r <= 2 in two straight sectors, "bore" and "outside", "low" and "high" its ends.
const CHORDS: &str = "*NODE\n1, 1, 0\n2, 0.7071067811865476, 0.7071067811865476\n3, 0, 1\n\
    4, 2, 0\n5, 1.4142135623730951, 1.4142135623730951\n6, 0, 2\n\
    *ELEMENT, TYPE=CPE4, ELSET=all\n1, 1, 4, 5, 2\n2, 2, 5, 6, 3\n\
    *SURFACE, NAME=bore\nall, S4\n*SURFACE, NAME=outside\nall, S2\n*SURFACE, NAME=low\n1, S1\n*SURFACE, NAME=high\n2, S3\n";

/// Two chords meet like two walls, and are pieces of a slave side as these are: the sag of an arc is theirs all the same.
#[test]
fn a_bore_in_two_chords_has_their_sag() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("ring.inp"), CHORDS).unwrap();
    let shrunk = |adjust: &str| {
        let text = format!(
            "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1\npoisson = 0.3\n\
             [[patch]]\nname = \"ring\"\ngeometry = {{ kind = \"file\", file = \"ring.inp\" }}\nbackend = \"fe\"\ndegree = 1\n\
             [[patch]]\nname = \"shaft\"\ngeometry = {{ kind = \"annulus-sector\", radius = [0.5, 1], angle_deg = [0, 90] }}\nelements = [6, 3]\n\
             [[boundary]]\non = [\"shaft.u0\", \"ring.low\"]\nfix = [\"y\"]\n[[boundary]]\non = [\"shaft.u1\", \"ring.high\"]\nfix = [\"x\"]\n\
             [[boundary]]\non = [\"ring.outside\", \"shaft.v0\"]\npressure = 0.01\n\
             [[contact]]\nname = \"fit\"\nslave = \"ring.bore\"\nmaster = \"shaft.v1\"\n{adjust}"
        );
        let options = ReadOptions { folder: Some(folder.path().to_path_buf()), ..ReadOptions::default() };
        let result = Case::parse("case.toml", &text, &options).unwrap().run(&Registry::default()).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(result.status, Status::Ok, "{:?}", result.diagnostics);
        result
    };
    let tells = |result: &RunResult, words: &str| result.warnings.iter().any(|w| w.message.contains(words));
    let closed = shrunk("adjust = true\n");
    assert!(!tells(&closed, "`adjust`"), "{:?}", closed.warnings);
    let pressure = &closed.contact["fit"].pressure;
    assert!(pressure.min > 0.009 && pressure.max < 0.011, "{pressure:?}");
    let as_meshed = shrunk("");
    assert!(as_meshed.contact["fit"].pressure.max > 0.015, "{:?}", as_meshed.contact["fit"].pressure);
    assert!(tells(&as_meshed, "facets"), "{:?}", as_meshed.warnings);
}

#[test]
fn an_obstacle_that_moves_has_no_gaps_of_facets() {
    let text = "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 100\npoisson = 0\n[[patch]]\nname = \"a\"\n\
        geometry = { kind = \"box\", min = [0, 0], max = [1, 1] }\nelements = [1, 1]\n[[boundary]]\non = \"a.top\"\nfix = [\"x\", \"y\"]\n\
        [[contact]]\nname = \"c\"\nslave = \"a.bottom\"\nadjust = true\n\
        rigid = { kind = \"half-plane\", point = [0, 0], normal = [0, 1], move = { y = \"0.01*t\" } }\n";
    let faults = solve(text).unwrap_err().to_string();
    assert!(faults.contains("E015") && faults.contains("the obstacle moves"), "{faults}");
}

/// What `where` keeps is told where it is not the part in which it holds, though its length be the same.
#[test]
fn a_border_within_a_facet_is_told_whatever_length_is_kept() {
    let text = |part: &str, statement: &str| {
        format!(
            "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1000\npoisson = 0\n[[patch]]\nname = \"b\"\n\
             geometry = {{ kind = \"box\", min = [0, 0], max = [10, 1] }}\nelements = [10, 2]\n[[boundary]]\non = \"b.left\"\nfix = [\"x\", \"y\"]\n\
             [[boundary]]\nname = \"part\"\non = \"b.bottom\"\nwhere = \"{part}\"\n{statement}\n"
        )
    };
    for statement in ["pressure = 0.01", "fix = [\"y\"]", "spring = { y = 1.0 }"] {
        for (part, words) in [
            ("abs(x - 7.2) < 0.5", Some("a length of 1 for the 1 in which `abs(x - 7.2) < 0.5` holds, 0.3 of it where it does not")),
            ("x > 4.9", Some("a length of 5 for the 5.1 in which `x > 4.9` holds")),
            ("abs(x - 7.5) < 0.5", None),
            ("x > 5", None),
        ] {
            let result = solve(&text(part, statement)).unwrap_or_else(|e| panic!("{e}"));
            let found = result.warnings.iter().find(|w| w.code == "E017").map(|w| w.message.clone());
            assert_eq!(found.is_some(), words.is_some(), "{part} {statement}: {found:?}");
            assert!(words.is_none_or(|w| found.as_ref().unwrap().contains(w)), "{part} {statement}: {found:?}");
        }
    }
}

/// Facets of two shells that touch are closed, and what points see of them while they slide is no sliding of the shells.
#[test]
fn facets_that_are_closed_are_no_sliding() {
    for cells in ["tensor", "simplex"] {
        let shell = |name: &str, radius: [f64; 2], n: usize| {
            format!(
                "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"sphere-octant\", radius = {radius:?} }}\nelements = [{n}, {n}, 2]\n\
                 [[boundary]]\non = \"{name}.v0\"\nfix = [\"z\"]\n[[boundary]]\non = \"{name}.u0\"\nfix = [\"y\"]\n[[boundary]]\non = \"{name}.u1\"\nfix = [\"x\"]\n"
            )
        };
        let text = format!(
            "[model]\nphysics = \"elasticity\"\ndimension = 3\n[discretization]\nbackend = \"fe\"\ndegree = 1\ncells = \"{cells}\"\n[[material]]\nname = \"m\"\nyoung = 100\npoisson = 0.3\n"
        ) + &shell("inner", [0.5, 1.0], 6)
            + &shell("outer", [1.0, 2.0], 3)
            + "[[boundary]]\non = \"outer.w1\"\npressure = 1e-3\n[[contact]]\nname = \"fit\"\nslave = \"inner.w1\"\nmaster = \"outer.w0\"\nadjust = true\n";
        let result = solve(&text).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(result.status, Status::Ok, "{:?}", result.diagnostics);
        assert!(result.warnings.is_empty(), "{cells}: {:?}", result.warnings);
    }
}
