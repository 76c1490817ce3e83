//! `faying new`: sample cases that run as they are.

use super::arguments::{Common, NewArguments};
use super::ended::Ended;
use super::folder::write_new;
use crate::io::errors::{Diagnostic, nearest};
use crate::io::table::Table;
use serde_json::json;
use std::path::PathBuf;

/// A sample case.
struct Sample {
    name: &'static str,
    about: &'static str,
    text: &'static str,
}

macro_rules! sample {
    ($name:literal, $about:literal) => {
        Sample { name: $name, about: $about, text: include_str!(concat!("../../../examples/cases/", $name, ".toml")) }
    };
}

const SAMPLES: [Sample; 4] = [
    sample!("poisson-arc", "Poisson on a ring sector with a known solution"),
    sample!("contact-patch", "two blocks pressed together: uniform stress across meshes that do not match"),
    sample!("hertz", "a half cylinder pressed on a rigid plane, against the formula of Hertz"),
    sample!("iga-fe-arc", "a NURBS ring tied to a triangle mesh"),
];

/// The file of the sample, where one is written.
pub fn file(arguments: &NewArguments, common: &Common) -> PathBuf {
    let name = arguments.name.as_deref().unwrap_or_default().trim_end_matches(".toml");
    let file = common.out.clone().unwrap_or_else(|| PathBuf::from(".")).join(format!("{name}.toml"));
    file.strip_prefix(".").map(PathBuf::from).unwrap_or(file)
}

/// Lists, prints or writes a sample.
pub fn new(arguments: &NewArguments, common: &Common) -> Ended {
    let names: Vec<&str> = SAMPLES.iter().map(|s| s.name).collect();
    let Some(name) = arguments.name.as_deref().filter(|_| !arguments.list) else {
        let mut table = Table::new(["sample", "what it shows"]);
        for s in &SAMPLES {
            table.row([s.name, s.about]);
        }
        let samples: Vec<_> = SAMPLES.iter().map(|s| json!({"name": s.name, "about": s.about})).collect();
        return Ended::done("new", table.to_string(), json!({"samples": samples}));
    };
    let Some(sample) = SAMPLES.iter().find(|s| s.name == name.trim_end_matches(".toml")) else {
        let near = nearest(name, names.iter().copied()).map_or(String::new(), |n| format!("; did you mean `{n}`?"));
        return super::usage(&format!("there is no sample `{name}`; known: {}{near}", names.join(", ")), Some("faying new --list"));
    };
    if arguments.to.is_some() {
        return Ended::done("new", sample.text.to_owned(), json!({"name": sample.name, "text": sample.text}));
    }
    let file = file(arguments, common);
    match write_new(&file, sample.text.as_bytes()) {
        Ok(()) => {
            let shown = file.display().to_string();
            Ended::done("new", format!("{shown} written; solve it with: faying run {shown}\n"), json!({"files": [shown]}))
        }
        Err(e) if e.kind() == std::io::ErrorKind::AlreadyExists => {
            let message = format!("`{}` exists; `faying new` never writes over a file", file.display());
            Diagnostic::error("E090", message)
                .with_help(format!("remove it, choose another folder with --out, or print the sample: faying new {} -", sample.name))
                .into()
        }
        Err(e) => Diagnostic::error("E091", format!("writing `{}` failed: {e}", file.display())).into(),
    }
}
