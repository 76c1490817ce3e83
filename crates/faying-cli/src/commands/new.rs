//! `faying new`: sample cases that run as they are.

use super::arguments::{Common, NewArguments};
use super::ended::Exit;
use super::folder::write_new;
use crate::errors::{Diagnostic, nearest};
use crate::table::Table;
use serde_json::json;
use std::path::PathBuf;

/// A sample case.
struct Sample {
    name: &'static str,
    about: &'static str,
    text: &'static str,
    /// Meshes and geometries that the case reads, and their sources.
    files: &'static [(&'static str, &'static [u8])],
}

macro_rules! sample {
    ($name:literal, $about:literal $(, $file:literal)*) => {
        Sample {
            name: $name,
            about: $about,
            text: include_str!(concat!("../../cases/", $name, ".toml")),
            files: &[$(($file, include_bytes!(concat!("../../cases/", $file)))),*],
        }
    };
}

const SAMPLES: [Sample; 16] = [
    sample!("poisson-arc", "Poisson on a ring sector with a known solution"),
    sample!("contact-patch", "two blocks pressed together: uniform stress across meshes that do not match"),
    sample!("hertz", "a half cylinder pressed on a rigid plane, against the formula of Hertz"),
    sample!("hertz-solid", "a rigid ball pressed on a block in three dimensions, against the formula of Hertz"),
    sample!(
        "crossed-cylinders",
        "a NURBS cylinder pressed on one of hexahedra at a right angle, in three dimensions, against the formula of Hertz"
    ),
    sample!("punch-solid", "a rigid box pressed into a block in three dimensions: its face alone carries the force"),
    sample!("shrink-fit", "a ring shrunk on another, against the formula of Lame"),
    sample!("shrink-fit-solid", "a hollow ball shrunk into another one in three dimensions, against the formula of Lame"),
    sample!("cylinder-on-block", "a steel cylinder on an aluminium block, benchmark of NAFEMS"),
    sample!("iga-fe-arc", "a NURBS ring tied to a triangle mesh"),
    sample!("seam", "two squares tied along a line, known solution: every choice of an interface can be tried on it"),
    sample!("seam-solid", "a pipe of two layers in three dimensions, tied along a cylinder, against the formula of Lame"),
    sample!("cross-point", "three patches of a G+Smo file that meet in a point, grids that do not match", "cross-point.xml"),
    sample!(
        "iga-fe-plate",
        "a plate with a hole: a NURBS patch of a G+Smo file tied to a mesh of a Gmsh file",
        "iga-fe-plate.xml",
        "iga-fe-plate.msh",
        "iga-fe-plate.geo"
    ),
    sample!("l-bracket", "a bracket from Gmsh: physical groups, curved triangles", "l-bracket.msh", "l-bracket.geo"),
    sample!("solid", "a pipe in three dimensions: NURBS, hexahedra, tetrahedra"),
];

/// The file to which the sample is written.
pub fn file(arguments: &NewArguments, common: &Common) -> PathBuf {
    let name = arguments.name.as_deref().unwrap_or_default().trim_end_matches(".toml");
    let file = common.out.clone().unwrap_or_else(|| PathBuf::from(".")).join(format!("{name}.toml"));
    file.strip_prefix(".").map(PathBuf::from).unwrap_or(file)
}

/// Lists, prints or writes a sample.
pub fn new(arguments: &NewArguments, common: &Common) -> Exit {
    let names: Vec<&str> = SAMPLES.iter().map(|s| s.name).collect();
    let Some(name) = arguments.name.as_deref().filter(|_| !arguments.list) else {
        let mut table = Table::new(["sample", "what it shows"]);
        for s in &SAMPLES {
            table.row([s.name, s.about]);
        }
        let samples: Vec<_> = SAMPLES.iter().map(|s| json!({"name": s.name, "about": s.about})).collect();
        return Exit::done("new", table.to_string(), json!({"samples": samples}));
    };
    let Some(sample) = SAMPLES.iter().find(|s| s.name == name.trim_end_matches(".toml")) else {
        let near = nearest(name, names.iter().copied()).map_or(String::new(), |n| format!("; did you mean `{n}`?"));
        return super::ended::usage(&format!("there is no sample `{name}`; known: {}{near}", names.join(", ")), Some("faying new --list"));
    };
    if arguments.to.is_some() {
        return Exit::done("new", sample.text.to_owned(), json!({"name": sample.name, "text": sample.text}));
    }
    let file = file(arguments, common);
    let beside = |name: &str| file.with_file_name(name);
    let parts = || sample.files.iter().map(|(name, bytes)| (beside(name), *bytes)).chain([(file.clone(), sample.text.as_bytes())]);
    // nothing is written where one of them exists
    if let Some((there, _)) = parts().find(|(path, _)| path.exists()) {
        return exists(&there, sample.name);
    }
    // the case last, after the files that it reads
    for (path, bytes) in parts() {
        match write_new(&path, bytes) {
            Ok(()) => {}
            Err(e) if e.kind() == std::io::ErrorKind::AlreadyExists => return exists(&path, sample.name),
            Err(e) => return Diagnostic::error("E091", format!("writing `{}` failed: {e}", path.display())).into(),
        }
    }
    let shown = file.display().to_string();
    let all: Vec<String> =
        std::iter::once(shown.clone()).chain(sample.files.iter().map(|(n, _)| beside(n).display().to_string())).collect();
    Exit::done("new", format!("{} written; solve it with: faying run {shown}\n", all.join(", ")), json!({"files": all}))
}

fn exists(file: &std::path::Path, sample: &str) -> Exit {
    Diagnostic::error("E090", format!("`{}` exists; `faying new` never writes over a file", file.display()))
        .with_help(format!("remove it, choose another folder with --out, or print the sample: faying new {sample} -"))
        .into()
}
