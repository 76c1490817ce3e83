//! Time to read structured meshes of tetrahedra from Gmsh files, beside meshio's reader where python3 has it.
//!
//! Run by `cargo bench --bench gmsh_reader`. Files are made in memory and for meshio written to a temporary folder.
#![allow(clippy::unwrap_used)]

use faying_files::gmsh::{parse, write};
use faying_files::{CellShape, Format, Group, Limits, MeshBlock, MeshFile};
use std::path::Path;
use std::process::Command;
use std::time::Instant;

/// Six tetrahedra in each of n^3 boxes of the unit cube, with one group for the cells.
fn cube(n: u32) -> MeshFile {
    let m = n + 1;
    let point = |k: u32| [k % m, k / m % m, k / m / m].map(|i| (f64::from(i) / f64::from(n)).sin());
    let points: Vec<[f64; 3]> = (0..m * m * m).map(point).collect();
    let mut nodes = Vec::new();
    for box_ in 0..n * n * n {
        let first = box_ % n + m * (box_ / n % n + m * (box_ / n / n));
        for order in [[0, 1, 2], [1, 2, 0], [2, 0, 1], [1, 0, 2], [0, 2, 1], [2, 1, 0]] {
            let mut at = first;
            nodes.push(at);
            for axis in order {
                at += [1, m, m * m][axis];
                nodes.push(at);
            }
        }
    }
    let ids = (1..=nodes.len() as u64 / 4).collect();
    MeshFile {
        format: Format::Gmsh,
        ids: (1..=points.len() as u64).collect(),
        points,
        blocks: vec![MeshBlock { shape: CellShape::Tetrahedron, order: 1, nodes, ids, groups: vec![0] }],
        groups: vec![Group { dimension: 3, number: 1, name: Some("cube".into()) }],
        notes: Vec::new(),
    }
}

/// Least of some times \[s\].
fn least(times: usize, mut f: impl FnMut()) -> f64 {
    (0..times).fold(f64::INFINITY, |best, _| {
        let start = Instant::now();
        f();
        best.min(start.elapsed().as_secs_f64())
    })
}

/// Least of three times of meshio's reader \[s\]; none where it is not installed.
fn meshio(path: &Path) -> Option<f64> {
    let script = "import sys, time, meshio\nbest = 1e9\nfor _ in range(3):\n    t = time.perf_counter()\n    m = meshio.read(sys.argv[1])\n    \
                  best = min(best, time.perf_counter() - t)\nprint(best)";
    let output = Command::new("python3").args(["-c", script]).arg(path).output().ok()?;
    String::from_utf8_lossy(&output.stdout).lines().last()?.trim().parse().ok()
}

fn main() {
    let folder = tempfile::tempdir().unwrap();
    println!("{:>10} {:>8} {:>8} {:>12} {:>12} {:>10} {:>8}", "cells", "format", "MB", "reading [s]", "ns per cell", "meshio [s]", "ratio");
    // 6 * 26^3 = 105 456 and 6 * 55^3 = 998 250 cells
    for n in [26, 55] {
        let mesh = cube(n);
        let cells = mesh.blocks[0].ids.len();
        for binary in [false, true] {
            let bytes = write(&mesh, binary).unwrap();
            let seconds = least(3, || assert_eq!(parse(&bytes, &Limits::default()).unwrap().blocks[0].ids.len(), cells));
            let path = folder.path().join("cube.msh");
            std::fs::write(&path, &bytes).unwrap();
            let other = meshio(&path);
            let text = |v: Option<f64>| v.map_or("-".to_owned(), |v| format!("{v:.2}"));
            let (mb, per_cell) = (bytes.len() as f64 / 1e6, seconds / cells as f64 * 1e9);
            let kind = if binary { "binary" } else { "text" };
            println!(
                "{cells:>10} {kind:>8} {mb:>8.1} {seconds:>12.3} {per_cell:>12.0} {:>10} {:>8}",
                text(other),
                text(other.map(|o| o / seconds))
            );
        }
    }
}
