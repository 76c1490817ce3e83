//! Nitsche's method on sides that carry something else in the same points: refused, for the stress of such a side is not that of the interface
//! alone. Where other parts of the side carry it, and by Lagrange's method, uniform states are exact.

use crate::common::pressed::{probe, read};
use faying_cli::{Registry, RunResult, Status};

/// A column of two cubes without lateral strain, the lower one held below, the upper one pressed by 0.01; `joint` joins them, `rest` is what
/// the side of the joint carries besides.
fn column(dimension: usize, joint: &str, rest: &str) -> Result<RunResult, String> {
    let (axis, fixed) = if dimension == 2 { ("y", "\"x\"") } else { ("z", "\"x\", \"y\"") };
    let corner = |z: &str| if dimension == 2 { format!("[0, {z}]") } else { format!("[0, 0, {z}]") };
    let far = |z: &str| if dimension == 2 { format!("[1, {z}]") } else { format!("[1, 1, {z}]") };
    let elements = |n: usize| format!("{:?}", vec![n; dimension]);
    let text = format!(
        "[model]\nphysics = \"elasticity\"\ndimension = {dimension}\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.0\n\
         [[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = {}, max = {} }}\nelements = {}\n\
         [[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = {}, max = {} }}\nelements = {}\n\
         [[boundary]]\non = \"a.bottom\"\nfix = [{fixed}, \"{axis}\"]\n[[boundary]]\non = \"b.top\"\nfix = [{fixed}]\npressure = 0.01\n\
         {joint}\n{rest}\n[[probe]]\nname = \"p\"\nquantity = \"stress.{axis}{axis}.max\"\n[[probe]]\nname = \"q\"\nquantity = \"stress.{axis}{axis}.min\"\n",
        corner("0"),
        far("1"),
        elements(2),
        corner("1"),
        far("2"),
        elements(3)
    );
    let case = read(&text.replace("AXIS", axis), &[]);
    case.run(&Registry::default()).map_err(|e| e.to_string())
}

const JOINTS: [(&str, &str, &str); 2] = [
    ("contact", "[[contact]]\nname = \"j\"\nslave = \"a.top\"\nmaster = \"b.bottom\"\nmethod = \"KIND\"", "lagrange"),
    ("interface", "[[interface]]\nname = \"j\"\nslave = \"b.bottom\"\nmaster = \"a.top\"\ncoupling = \"KIND\"", "mortar"),
];

#[test]
fn sides_that_carry_something_else_are_refused() {
    for dimension in [2, 3] {
        for (table, joint, other) in JOINTS {
            for (rest, word) in [
                (
                    "[[boundary]]\nname = \"l\"\non = \"a.top\"\npressure = 0.01",
                    "`a.top` for what crosses the interface, but the side has the load \"l\", too",
                ),
                (
                    "[[boundary]]\nname = \"l\"\non = \"b.bottom\"\ntraction = { AXIS = \"0.005*t\" }\n[steps]\nt = [0.0, 1.0]",
                    "the side has the load \"l\"",
                ),
                ("[[boundary]]\nname = \"l\"\non = \"a.top\"\nforce = { AXIS = 0.01 }", "the side has the load \"l\""),
                ("[[boundary]]\nname = \"l\"\non = \"b.bottom\"\nspring = { AXIS = 2.0 }", "the side has the springs \"l\""),
                ("[[boundary]]\non = \"MASTER\"\nfix = [\"AXIS\"]", "` for what crosses the interface, but the side is held"),
                ("[[boundary]]\non = \"MASTER\"\nrigid_force = { AXIS = 0.0 }", "the side is held"),
                (
                    "[[contact]]\nname = \"stop\"\nslave = \"MASTER\"\nrigid = { kind = \"sphere\", center = CENTER, radius = 1.0 }",
                    "the side belongs to \"stop\" in the same points",
                ),
            ] {
                let (master, beyond) = if table == "contact" { ("b.bottom", -4.0) } else { ("a.top", 4.0) };
                let rest =
                    rest.replace("MASTER", master).replace("CENTER", &format!("{}, {beyond:?}]", ["[0.5", "[0.5, 0.5"][dimension - 2]));
                let refused = column(dimension, &joint.replace("KIND", "nitsche"), &rest);
                let told = refused.expect_err("a side that carries something else");
                let help = format!("= \"{other}\", or state what the side carries");
                assert!(told.starts_with("error[E019]") && told.contains(word) && told.contains(&help), "{table} {rest}: {told}");
                let allowed = column(dimension, &joint.replace("KIND", other), &rest).unwrap_or_else(|e| panic!("{table} {rest}: {e}"));
                assert_eq!(allowed.status, Status::Ok, "{table} {rest}: {:?}", allowed.diagnostics);
            }
        }
    }
}

#[test]
fn what_others_parts_of_a_side_carry_does_no_harm() {
    for dimension in [2, 3] {
        for (table, joint, _) in JOINTS {
            // along the side, on the sides beside it, on none of it, and at no time
            for rest in [
                "",
                "[[boundary]]\non = [\"a.left\", \"b.left\"]\nfix = [\"x\"]",
                "[[boundary]]\non = [\"a.top\", \"b.bottom\"]\nfix = [\"x\"]",
                "[[boundary]]\non = \"a.top\"\npressure = 0.0",
                "[[boundary]]\non = \"a.top\"\npressure = \"max(0, x - 2)\"",
            ] {
                let found = column(dimension, &joint.replace("KIND", "nitsche"), rest).unwrap_or_else(|e| panic!("{table} {rest}: {e}"));
                assert_eq!(found.status, Status::Ok, "{table} {rest}: {:?}", found.diagnostics);
                for name in ["p", "q"] {
                    let stress = probe(&found, name);
                    assert!((stress + 0.01).abs() < 1e-12, "{table} {rest}: {name} {stress}");
                }
            }
        }
    }
}

/// A block, held below, under a rigid box that comes to the loaded part of its side at the last of `times`.
fn slides(dimension: usize, rest: &str, times: &str, method: &str) -> Result<RunResult, String> {
    let (axis, fixed) = if dimension == 2 { ("y", "\"x\"") } else { ("z", "\"x\", \"y\"") };
    let corner = |x: &str, z: &str| if dimension == 2 { format!("[{x}, {z}]") } else { format!("[{x}, 0, {z}]") };
    let far = |x: &str, y: &str, z: &str| if dimension == 2 { format!("[{x}, {z}]") } else { format!("[{x}, {y}, {z}]") };
    let beside = |z: &str| if dimension == 2 { format!("[-1, {z}]") } else { format!("[-1, -1, {z}]") };
    let text = format!(
        "[model]\nphysics = \"elasticity\"\ndimension = {dimension}\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.0\n\
         [[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = {}, max = {} }}\nelements = {:?}\n\
         [[boundary]]\non = \"a.bottom\"\nfix = [{fixed}, \"{axis}\"]\n\
         [[contact]]\nname = \"j\"\nslave = \"a.top\"\nmethod = \"{method}\"\n\
         rigid = {{ kind = \"box\", min = {}, max = {}, move = {{ x = \"2*t\" }} }}\n{rest}\n[steps]\nt = {times}\n",
        corner("0", "0"),
        far("2", "1", "1"),
        if dimension == 2 { vec![8, 2] } else { vec![8, 2, 2] },
        beside("0.99"),
        far("0.75", "2", "2"),
    );
    read(&text.replace("AXIS", axis), &[]).run(&Registry::default()).map_err(|e| e.to_string())
}

#[test]
fn a_moving_obstacle_is_looked_at_where_it_stands() {
    for dimension in [2, 3] {
        for (rest, word) in [
            ("pressure = 0.01", "has the load \"l\""),
            ("spring = { AXIS = 0.1 }", "has the springs \"l\""),
            ("fix = [\"AXIS\"]", "is held"),
        ] {
            let rest = format!("[[boundary]]\nname = \"l\"\non = \"a.top\"\nwhere = \"x > 1\"\n{rest}");
            // at the first time it ends before the part, at the second it covers a half of it
            for (times, method, is_told) in [("[0, 0.4]", "nitsche", true), ("[0, 0.1]", "nitsche", false), ("[0, 0.4]", "lagrange", false)]
            {
                let found = slides(dimension, &rest, times, method);
                match found {
                    Err(told) => {
                        assert!(is_told && told.starts_with("error[E019]") && told.contains(word), "{rest} {times} {method}: {told}")
                    }
                    Ok(_) => assert!(!is_told, "{dimension} {rest} {times} {method}"),
                }
            }
        }
    }
}

/// Blocks that slide along their normals, one each, have opposite directions: both are held, and nothing moves between them.
#[test]
fn sides_that_are_held_alike_do_no_harm() {
    for (table, joint, _) in JOINTS {
        for held in ["fix = [\"AXIS\"]", "fix = [\"normal\"]"] {
            let rest = ["a.top", "b.bottom"].map(|on| format!("[[boundary]]\non = \"{on}\"\n{held}\n")).concat();
            for dimension in [2, 3] {
                let found = column(dimension, &joint.replace("KIND", "nitsche"), &rest);
                let found = found.unwrap_or_else(|e| panic!("{table} {rest}: {e}"));
                assert!(probe(&found, "p").abs() < 0.02, "{table} {rest}");
            }
        }
    }
}

/// Two blocks beside each other on a third, `joints` for their names, pressed together; the second begins at `begin` of a width of two.
fn pair_on_one(kind: &str, scale: f64, begin: f64, [first, second]: [&str; 2], elements: [usize; 3]) -> Result<RunResult, String> {
    let space = kind == "space";
    let point = |x: f64, z: f64, y: f64| if space { format!("[{x}, {y}, {z}]") } else { format!("[{x}, {z}]") };
    let block = |name: &str, [from, to]: [f64; 2], z: f64, n: usize| {
        let [min, max] = [(from, z, 0.0), (to, z + 1.0, 1.0)].map(|(x, z, y)| point(scale * x, scale * z, scale * y));
        let n = if space { vec![n, 2, 2] } else { vec![n, 2] };
        format!("[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"box\", min = {min}, max = {max} }}\nelements = {n:?}\n")
    };
    let assumption = if kind == "axisymmetric" { "assumption = \"axisymmetric\"\n" } else { "" };
    let text = format!(
        "[model]\nphysics = \"elasticity\"\ndimension = {}\n{assumption}[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.0\n",
        if space { 3 } else { 2 }
    ) + &block("a", [0.0, 2.0], 0.0, elements[0])
        + &block("b", [0.0, 1.0], 1.0, elements[1])
        + &block("c", [begin, 2.0], 1.0, elements[2])
        + &format!(
            "[[boundary]]\non = \"a.bottom\"\nfix = [\"x\", \"AXIS\"{}]\n[[boundary]]\non = [\"b.top\", \"c.top\"]\npressure = 0.001\n{first}\n{second}\n\
             [[probe]]\nname = \"p\"\nquantity = \"stress.AXISAXIS.max\"\n[[probe]]\nname = \"q\"\nquantity = \"stress.AXISAXIS.min\"\n",
            if space { ", \"y\"" } else { "" }
        );
    read(&text.replace("AXIS", if space { "z" } else { "y" }), &[]).run(&Registry::default()).map_err(|e| e.to_string())
}

/// What two interfaces have in common does not depend on the unit of length, on the axis of revolution, or on the points of the integration.
#[test]
fn interfaces_beside_each_other_are_allowed_in_any_unit() {
    for kind in ["plane", "axisymmetric", "space"] {
        for scale in [1e-3, 1.0, 1e3] {
            for rule in ["merged", "slave"] {
                let tie = |name: &str, coupling: &str| {
                    format!(
                        "[[interface]]\nname = \"{name}\"\nslave = \"{name}.bottom\"\nmaster = \"a.top\"\ncoupling = \"{coupling}\"\nintegration = \"{rule}\""
                    )
                };
                for second in ["nitsche", "mortar"] {
                    let what = format!("{kind} {scale} {rule} {second}");
                    let solve = |begin: f64, elements| pair_on_one(kind, scale, begin, [&tie("b", "nitsche"), &tie("c", second)], elements);
                    // also where the border lies within an element of the master
                    for elements in [[4, 3, 2], [5, 3, 2]] {
                        let found = solve(1.0, elements).unwrap_or_else(|e| panic!("{what} {elements:?}: {e}"));
                        let allowed = if rule == "merged" { 1e-9 } else { 0.3 };
                        for name in ["p", "q"] {
                            assert!((probe(&found, name) / -0.001 - 1.0).abs() < allowed, "{what} {elements:?}: {}", probe(&found, name));
                        }
                    }
                    let told = solve(0.5, [4, 3, 3]).expect_err(&what);
                    assert!(told.starts_with("error[E019]") && told.contains("in the same points"), "{what}: {told}");
                }
            }
        }
    }
}

/// Both sides are held, each where the other one is free: the stress beside a support is not that of the interface.
#[test]
fn sides_that_are_held_in_different_points_are_refused() {
    for dimension in [2, 3] {
        for (table, joint, _) in JOINTS {
            let rest = |a: &str, b: &str| {
                format!(
                    "[[boundary]]\non = \"a.top\"\nwhere = \"{a}\"\nfix = [\"AXIS\"]\n[[boundary]]\non = \"b.bottom\"\nwhere = \"{b}\"\nfix = [\"AXIS\"]\n"
                )
            };
            for (a, b) in [("x > 0.5", "x < 0.5"), ("x >= 0", "x < 0.5"), ("x > 0.5", "x >= 0")] {
                let told = column(dimension, &joint.replace("KIND", "nitsche"), &rest(a, b));
                let told = told.map(|r| r.status).expect_err(&format!("{dimension} {table} {a} {b}"));
                assert!(told.contains("error[E019]") && told.contains("but the side is held"), "{dimension} {table} {a} {b}: {told}");
            }
        }
    }
}
