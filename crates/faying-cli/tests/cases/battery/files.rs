//! Meshes of straight cells as MSH 2.2 files: bodies without an exact map.

use std::fmt::Write;
use std::path::Path;

/// Writes n x m quadrilaterals, or twice as many triangles, of the unit square mapped by `place` as NAME.msh; groups `body`, `u0`, `u1`, `v0`, `v1`.
pub fn write(folder: &Path, name: &str, [n, m]: [usize; 2], triangles: bool, place: &dyn Fn([f64; 2]) -> [f64; 2]) {
    let mut out = String::from("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n5\n");
    for (k, side) in ["u0", "u1", "v0", "v1"].iter().enumerate() {
        writeln!(out, "1 {} \"{side}\"", k + 1).unwrap();
    }
    writeln!(out, "2 5 \"body\"\n$EndPhysicalNames\n$Nodes\n{}", (n + 1) * (m + 1)).unwrap();
    let node = |i: usize, j: usize| 1 + i + (n + 1) * j;
    for j in 0..=m {
        for i in 0..=n {
            let [x, y] = place([i as f64 / n as f64, j as f64 / m as f64]);
            writeln!(out, "{} {x:.17e} {y:.17e} 0", node(i, j)).unwrap();
        }
    }
    let mut cells: Vec<(usize, usize, Vec<usize>)> = Vec::new();
    for j in 0..m {
        cells.push((1, 1, vec![node(0, j), node(0, j + 1)]));
        cells.push((1, 2, vec![node(n, j), node(n, j + 1)]));
    }
    for i in 0..n {
        cells.push((1, 3, vec![node(i, 0), node(i + 1, 0)]));
        cells.push((1, 4, vec![node(i, m), node(i + 1, m)]));
    }
    for j in 0..m {
        for i in 0..n {
            let [a, b, c, d] = [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)];
            if triangles {
                cells.push((2, 5, vec![a, b, c]));
                cells.push((2, 5, vec![a, c, d]));
            } else {
                cells.push((3, 5, vec![a, b, c, d]));
            }
        }
    }
    writeln!(out, "$EndNodes\n$Elements\n{}", cells.len()).unwrap();
    for (k, (kind, group, nodes)) in cells.iter().enumerate() {
        let list: Vec<String> = nodes.iter().map(usize::to_string).collect();
        writeln!(out, "{} {kind} 2 {group} {group} {}", k + 1, list.join(" ")).unwrap();
    }
    out += "$EndElements\n";
    std::fs::write(folder.join(format!("{name}.msh")), out).unwrap();
}
