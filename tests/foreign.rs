//! Mesh files that are written here, read by Gmsh and by meshio; skipped where Python has not both.

#![cfg(feature = "cli")]
#![allow(clippy::unwrap_used)]

use faying::app::convert::{ConvertOptions, convert};
use faying::io::files::{Format, Limits, read};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join(name)
}

/// What Gmsh and meshio find in some files.
fn seen(files: &[PathBuf]) -> Vec<Value> {
    let output = Command::new("python3").arg(file("foreign/read.py")).args(files).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    // both print remarks before the document
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    serde_json::from_str(text.lines().last().unwrap()).unwrap()
}

#[test]
fn gmsh_and_meshio_read_what_is_written() {
    if !Command::new("python3").args(["-c", "import gmsh, meshio"]).output().is_ok_and(|o| o.status.success()) {
        println!("skipped: no Python with gmsh and meshio");
        return;
    }
    let names = [
        "disc_tri_p1_v4_bin",
        "disc_tri_p2_v4_bin",
        "disc_tri_p3_v4_bin",
        "disc_tri_p4_v4_bin",
        "disc_quad_p1_v4_bin",
        "disc_quad_p2_v4_bin",
        "disc_quad_p3_v4_bin",
        "disc_quad_p4_v4_bin",
        "octant_tet_p1_v2_bin",
        "octant_tet_p2_v4",
        "octant_tet_p3_v2_bin",
        "octant_tet_p4_v2_bin",
        "box_hex_p3_v4",
    ];
    let folder = tempfile::tempdir().unwrap();
    let mut files = Vec::new();
    for name in names {
        let own = file("data/gmsh").join(format!("{name}.msh"));
        let contents = read(&own, &Limits::default()).unwrap();
        files.push(own);
        for binary in [false, true] {
            let path = folder.path().join(format!("{name}_{binary}.msh"));
            std::fs::write(&path, convert(&contents, Format::Gmsh, &ConvertOptions { binary, ..ConvertOptions::default() }).unwrap().bytes)
                .unwrap();
            files.push(path);
        }
    }
    let all = seen(&files);
    for (name, own) in names.iter().zip(all.chunks(3)) {
        // version 2 lists an element once per group, and others keep every copy: its facets are counted twice
        let exact = name.contains("v4");
        for written in &own[1..] {
            assert_eq!(written[0]["types"], own[0][0]["types"], "{name}");
            if exact {
                assert_eq!(written[0]["groups"], own[0][0]["groups"], "{name}");
                assert_eq!(written[1], own[0][1], "{name}");
            }
            for d in if exact { 0..3 } else { 2..3 } {
                let (a, b) = (written[0]["measures"][d].as_f64().unwrap(), own[0][0]["measures"][d].as_f64().unwrap());
                assert!((a - b).abs() <= 1e-13 * b.abs(), "{name}: measure of dimension {}: {a}, {b} in the original", d + 1);
            }
        }
        assert!(own[0][0]["measures"].as_array().unwrap().iter().any(|m| m.as_f64().unwrap() > 0.4), "{name}");
    }
}
