//! Imports point down only: every `crate::` and `super::` path in `src/` is read and held against the floors.

use std::path::{Path, PathBuf};

/// Lowest first; `check` may use everything up to `problem` and nothing uses it.
const FLOORS: [&str; 13] = [
    "parallel",
    "linalg",
    "quadrature",
    "basis",
    "geometry",
    "space",
    "assembly",
    "physics",
    "coupling",
    "constraint",
    "contact",
    "problem",
    "check",
];

fn rank(floor: &str) -> Option<usize> {
    FLOORS.iter().position(|f| *f == floor)
}

fn sources(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("the folder can be read") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            sources(&path, files);
        } else if path.extension().is_some_and(|e| e == "rs") {
            files.push(path);
        }
    }
}

/// Module path of a file below `src`, `mod.rs` standing for its folder.
fn module_path(src: &Path, file: &Path) -> Vec<String> {
    let mut parts: Vec<String> =
        file.strip_prefix(src).expect("below src").with_extension("").iter().map(|p| p.to_string_lossy().into_owned()).collect();
    if parts.last().is_some_and(|p| p == "mod") {
        parts.pop();
    }
    parts
}

/// The floors named by one line of code: (floor, the text that names it).
fn floors_named(line: &str, module: &[String]) -> Vec<(String, String)> {
    let mut found = Vec::new();
    let ident = |text: &str| text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    for root in ["crate::", "faying::"] {
        for (at, _) in line.match_indices(root) {
            let rest = &line[at + root.len()..];
            if let Some(list) = rest.strip_prefix('{') {
                // crate::{a::.., b::..}: the first word of every entry at depth zero
                let mut depth = 0;
                let mut start = 0;
                for (k, c) in list.char_indices() {
                    match c {
                        '{' => depth += 1,
                        '}' if depth == 0 => {
                            found.push((ident(list[start..k].trim()), line.into()));
                            break;
                        }
                        '}' => depth -= 1,
                        ',' if depth == 0 => {
                            found.push((ident(list[start..k].trim()), line.into()));
                            start = k + 1;
                        }
                        _ => {}
                    }
                }
            } else {
                found.push((ident(rest), line.into()));
            }
        }
    }
    for (at, _) in line.match_indices("super::") {
        if at >= 7 && &line[at - 7..at] == "super::" {
            continue; // counted with the first of its run
        }
        let (mut rest, mut supers) = (&line[at..], 0);
        while let Some(next) = rest.strip_prefix("super::") {
            rest = next;
            supers += 1;
        }
        if supers >= module.len() {
            found.push((ident(rest), line.into()));
        }
    }
    found
}

#[test]
fn imports_point_down_only() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    sources(&src, &mut files);
    assert!(files.len() > 20, "the sources are found");
    let mut climbs = Vec::new();
    for file in files {
        let module = module_path(&src, &file);
        let Some(own) = module.first().and_then(|m| rank(m)) else { continue }; // lib.rs stands outside
        let text = std::fs::read_to_string(&file).expect("a source file");
        for (number, line) in text.lines().enumerate() {
            if line.trim_start().starts_with("//") {
                continue;
            }
            for (floor, _) in floors_named(line, &module) {
                if rank(&floor).is_some_and(|r| r > own) {
                    climbs.push(format!("{}:{}: {}", file.display(), number + 1, line.trim()));
                }
                if floor == "check" && module[0] != "check" {
                    climbs.push(format!("{}:{}: nothing uses `check`: {}", file.display(), number + 1, line.trim()));
                }
            }
        }
    }
    assert!(climbs.is_empty(), "imports that climb:\n{}", climbs.join("\n"));
}

#[test]
fn faer_is_named_in_its_own_files_only() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    sources(&src, &mut files);
    for file in files {
        let name = file.file_name().expect("a name").to_string_lossy().into_owned();
        let text = std::fs::read_to_string(&file).expect("a source file");
        let names = text.lines().any(|l| !l.trim_start().starts_with("//") && l.contains("faer::"));
        let own = name.starts_with("faer_") || ["multifrontal.rs", "dense_panel.rs"].contains(&name.as_str());
        assert!(!names || own, "{} names faer", file.display());
    }
}

#[test]
fn a_climbing_import_would_be_found() {
    let module = ["geometry".to_string(), "bvh".to_string()];
    let named = |line: &str| floors_named(line, &module).into_iter().map(|f| f.0).collect::<Vec<_>>();
    assert_eq!(named("use crate::coupling::Mortar;"), ["coupling"]);
    assert_eq!(named("use crate::{linalg::Real, space::{Body, Space}};"), ["linalg", "space"]);
    assert_eq!(named("use super::super::contact::Hit;"), ["contact"]);
    assert!(named("use super::Bounds;").is_empty());
}
