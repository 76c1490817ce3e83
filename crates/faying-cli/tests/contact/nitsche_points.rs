//! lambda of Nitsche's method at single points: with slave and master exchanged the method is the same, and so is what it transmits.

use crate::common::pressed::{probe, solve};

/// Two blocks with moduli 1000 and 1 under a load that varies along x, joined by `joint`, asked for lambda at points by `quantity`.
fn blocks(dimension: usize, [lower, upper]: [&str; 2], joint: &str, quantity: &str) -> Vec<f64> {
    let (sides, load, low, middle, high, top, elements) = match dimension {
        2 => ("\"x\", \"y\"", "y", "[0, 0]", "[1, 0.5]", "[1, 1]", "[0, 0.5]", ["[3, 2]", "[4, 2]"]),
        _ => ("\"x\", \"y\", \"z\"", "z", "[0, 0, 0]", "[1, 1, 0.5]", "[1, 1, 1]", "[0, 0, 0.5]", ["[2, 2, 1]", "[3, 3, 2]"]),
    };
    let across = if dimension == 2 { "fix = [\"x\"]" } else { "fix = [\"x\", \"y\"]" };
    let mut text = format!(
        "[model]\nphysics = \"elasticity\"\ndimension = {dimension}\n[discretization]\ndegree = 2\n\
         [[material]]\nname = \"stiff\"\nyoung = 1000.0\npoisson = 0.3\n[[material]]\nname = \"soft\"\nyoung = 1.0\npoisson = 0.1\n\
         [[patch]]\nname = \"a\"\nmaterial = \"stiff\"\n{lower}\ngeometry = {{ kind = \"box\", min = {low}, max = {middle} }}\nelements = {}\n\
         [[patch]]\nname = \"b\"\nmaterial = \"soft\"\n{upper}\ngeometry = {{ kind = \"box\", min = {top}, max = {high} }}\nelements = {}\n\
         [[boundary]]\non = \"a.bottom\"\nfix = [{sides}]\n[[boundary]]\non = \"b.top\"\n{across}\n\
         [[boundary]]\non = \"b.top\"\npressure = \"1e-3*(1 + x)\"\n{joint}\n",
        elements[0], elements[1]
    );
    let at: Vec<f64> = (1..10).map(|k| f64::from(k) * 0.1).collect();
    for (k, x) in at.iter().enumerate() {
        let place = if dimension == 2 { format!("[{x}, 0.5]") } else { format!("[{x}, 0.55, 0.5]") };
        text += &format!("[[probe]]\nname = \"p{k}\"\nquantity = \"{} at {place}\"\n", quantity.replace("NORMAL", load));
    }
    let result = solve(&text, &[]);
    (0..at.len()).map(|k| probe(&result, &format!("p{k}"))).collect()
}

#[test]
fn exchanging_slave_and_master_does_not_change_lambda_at_points() {
    let of = |[slave, master]: [&str; 2], table: &str, rest: &str| {
        format!("[[{table}]]\nname = \"j\"\nslave = \"{slave}\"\nmaster = \"{master}\"\n{rest}")
    };
    let backends = [["backend = \"iga\""; 2], ["backend = \"fe\"", "backend = \"iga\""]];
    for (dimension, backends) in [2, 3].into_iter().flat_map(|d| backends.map(|b| (d, b))) {
        for (table, rest, quantity) in [
            ("contact", "method = \"nitsche\"", "contact.j.pressure"),
            ("interface", "coupling = \"nitsche\"", "interface.j.lambda.NORMAL"),
        ] {
            let sides = ["a.top", "b.bottom"];
            let stiff = blocks(dimension, backends, &of(sides, table, rest), quantity);
            let soft = blocks(dimension, backends, &of([sides[1], sides[0]], table, rest), quantity);
            for (k, (a, b)) in stiff.iter().zip(&soft).enumerate() {
                assert!((a.abs() - b.abs()).abs() < 1e-9 * b.abs(), "{table} in {dimension}D, {k}: {a:e}, {b:e}");
            }
        }
    }
}
