//! `faying inspect`: contents of a mesh, a geometry, a .vtu or a case.

use super::arguments::{Common, InspectArguments};
use super::ended::Exit;
use super::folder::{write_new, write_whole};
use super::{case, geometries, place};
use crate::Registry;
use crate::case::{Case, Patch};
use crate::errors::{Diagnostic, nearest};
use crate::inspect::{Inspection, add_fields, inspect as look, mesh_of, picture};
use crate::place::Located;
use crate::plot::faces::{self, FacePlot};
use crate::run::memory_for_files;
use crate::text_format::bytes;
use faying::space::Divisions;
use faying_files::{Contents, FileError, Limits, beside, parse_with, read, read_bytes, vtu_read};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// File of the picture; `None` if no picture is requested.
pub fn svg_file(arguments: &InspectArguments) -> Option<PathBuf> {
    let given = arguments.svg.as_ref()?;
    if !given.is_empty() {
        return Some(PathBuf::from(given));
    }
    let stem = arguments.file.file_stem().map_or("stdin".to_owned(), |s| s.to_string_lossy().into_owned());
    Some(PathBuf::from(format!("{stem}.svg")))
}

/// Similar names in the folder of a missing file.
pub fn similar(path: &Path) -> Option<String> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."));
    let mut names: Vec<String> = std::fs::read_dir(folder).ok()?.flatten().filter_map(|e| e.file_name().into_string().ok()).collect();
    names.sort();
    let wanted = path.file_name()?.to_str()?;
    nearest(wanted, names.iter().map(String::as_str)).map(|n| format!("did you mean `{}`?", folder.join(n).display()))
}

/// Diagnostic of a file that cannot be used.
pub fn fault(path: &Path, error: &FileError) -> Diagnostic {
    let missing = matches!(error, FileError::System { missing: true, .. });
    let message = if missing { "there is no such file".to_owned() } else { error.to_string() };
    let mut diagnostic = Diagnostic::error(crate::codes::of_file(error), format!("`{}`: {message}", path.display()));
    let help = match error {
        FileError::System { missing: true, .. } => similar(path),
        FileError::System { .. } => Some("give a file that may be read".to_owned()),
        FileError::Memory { .. } => Some("raise --max-memory, or give a smaller file".to_owned()),
        _ => None,
    };
    if let Some(help) = help {
        diagnostic = diagnostic.with_help(help);
    }
    diagnostic.in_file(path.display().to_string())
}

/// Whether a name is that of a case: stdin, or a TOML file.
pub fn is_case(path: &Path) -> bool {
    path.as_os_str() == "-" || path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"))
}

/// Reads a file of any format, or the bodies of a case, cut into its elements.
pub fn contents(registry: &Registry, path: &Path, common: &Common) -> Result<Contents, Exit> {
    if is_case(path) {
        let loaded = case::load(path, None, common, registry)?;
        return Ok(Contents::Patches(geometries::cut(&loaded.case).map_err(Exit::failed)?));
    }
    read(path, &Limits { memory: memory_for_files(common.max_memory) }).map_err(|e| fault(path, &e).into())
}

/// Checks that `needed` bytes beside the contents, which take at least the size of the file, stay below `--max-memory`.
pub fn room(path: &Path, needed: u64, common: &Common) -> Result<(), Exit> {
    let Some(allowed) = memory_for_files(common.max_memory) else { return Ok(()) };
    let held = std::fs::metadata(path).map_or(0, |about| about.len());
    let needed = needed.saturating_add(held);
    if needed <= allowed {
        return Ok(());
    }
    let message = format!("`{}`: it takes about {} of memory; {} are allowed", path.display(), bytes(needed), bytes(allowed));
    let fault = Diagnostic::error("E081", message).with_help("raise --max-memory, or give a smaller file");
    Err(fault.in_file(path.display().to_string()).into())
}

/// Inspects a file.
pub fn inspect(registry: &Registry, arguments: &InspectArguments, common: &Common) -> Exit {
    inspected(registry, arguments, common).unwrap_or_else(|ended| ended)
}

fn inspected(registry: &Registry, arguments: &InspectArguments, common: &Common) -> Result<Exit, Exit> {
    let path = &arguments.file;
    let name = path.display().to_string();
    let mut grid = None;
    let (contents, case) = if is_case(path) {
        let loaded = case::load(path, None, common, registry)?;
        (Contents::Patches(geometries::patches(&loaded.case).map_err(Exit::failed)?), Some(loaded.case))
    } else {
        let limits = Limits { memory: memory_for_files(common.max_memory) };
        let failed = |e: FileError| Exit::from(fault(path, &e));
        let bytes = read_bytes(path, &limits).map_err(failed)?;
        if vtu_read::recognises(&bytes) {
            let file = vtu_read::parse(&bytes, &limits).map_err(failed)?;
            let mesh = mesh_of(&file).map_err(failed)?;
            grid = Some(file);
            (Contents::Mesh(mesh), None)
        } else {
            (parse_with("the file", &bytes, &limits, &mut beside(path, &limits)).map_err(failed)?, None)
        }
    };
    room(path, crate::inspect::memory(&contents), common)?;
    let pool = case::pool(common)?;
    let mut found: Inspection = pool.install(|| look(&contents)).map_err(|e| Exit::from(fault(path, &e)))?;
    if let Some(file) = &grid {
        add_fields(&mut found, file);
    }
    if let Some(case) = &case {
        found.format = "case".into();
        if found.patches.is_empty() {
            (found.kind, found.dimension) = ("meshes".into(), case.model.dimension.value);
        }
    }
    let mut fields = json!({"file": name});
    if let (Some(all), Ok(Value::Object(more))) = (fields.as_object_mut(), serde_json::to_value(&found)) {
        all.extend(more);
    }
    let mut text = found.text(&name);
    if let Some(case) = &case {
        let (lines, more) = of_case(case);
        text += &lines;
        fields["case"] = more;
    }
    if let Some(file) = svg_file(arguments) {
        let mut plot = picture(&contents, &name);
        // of a case the mesh that is solved, with the names of the geometries
        match case.as_ref().map(|case| pool.install(|| crate::run::mesh(case, registry, &name))) {
            Some(Ok(mesh)) => plot = FacePlot { labels: plot.labels, ..mesh },
            Some(Err(faults)) => {
                let first = faults.items.first().map_or("", |fault| fault.message.as_str());
                text += &format!("\nthe picture shows the geometries, for there is no mesh: {first}\n");
            }
            None => {}
        }
        let svg = faces::faces(&plot).ok_or_else(|| {
            let message = format!("there is no picture of `{name}`: it has no faces, or more than {}", faces::MOST_FACES);
            Exit::from(Diagnostic::error("E091", message))
        })?;
        write(&file, svg.as_bytes(), common.force)?;
        fields["files"] = json!([file.display().to_string()]);
        text += &format!("\npicture in {}\n", file.display());
    }
    crate::json::add_reasons(&mut fields);
    Ok(Exit::done("inspect", text, fields))
}

/// Writes a file, over another one only with `force`.
pub fn write(file: &Path, bytes: &[u8], force: bool) -> Result<(), Exit> {
    let written = if force { write_whole(file, bytes) } else { write_new(file, bytes) };
    written.map_err(|e| {
        if e.kind() == std::io::ErrorKind::AlreadyExists {
            let message = format!("`{}` exists", file.display());
            return Diagnostic::error("E090", message).with_help("write over it with --force, or give another file").into();
        }
        Diagnostic::error("E091", format!("writing `{}` failed: {e}", file.display())).into()
    })
}

/// Checks that the picture may be written to its file.
pub fn check_place(arguments: &InspectArguments, json: Option<&Path>) -> Result<(), Exit> {
    let Some(file) = svg_file(arguments) else { return Ok(()) };
    place::apart(&file, &arguments.file, "--svg")?;
    place::not_over(json, &file)
}

/// Contents of a case beside its geometry, as text and as JSON.
/// Elements per direction as the case asks for them: "4 x 3", "2 per span x 2 per span".
fn elements(patch: &Patch) -> String {
    let halved = 1_usize << patch.refine.value.min(60);
    let along = |d: &Located<Divisions>| match &d.value {
        Divisions::Total(n) => n.saturating_mul(halved).to_string(),
        Divisions::PerSpan(n) => format!("{} per span", n.saturating_mul(halved)),
        Divisions::Breakpoints(list) => list.len().saturating_sub(1).saturating_mul(halved).to_string(),
    };
    patch.elements.value.iter().map(along).collect::<Vec<_>>().join(" x ")
}

fn of_case(case: &Case) -> (String, Value) {
    let mut table = crate::table::Table::new(["patch", "geometry", "backend", "degree", "elements", "material"]);
    let mut list = Vec::new();
    for p in &case.patches {
        let d = &p.discretization;
        let degree: Vec<String> = d.degree.value.iter().map(usize::to_string).collect();
        let material = case.materials.get(p.material.value).map_or(String::new(), |m| m.name.value.clone());
        let kind = p.geometry.value.shape.value.kind().to_owned();
        table.row([p.name.value.clone(), kind.clone(), d.backend.value.clone(), degree.join(" x "), elements(p), material.clone()]);
        list.push(
            json!({"name": p.name.value, "geometry": kind, "backend": d.backend.value, "degree": d.degree.value, "material": material}),
        );
    }
    let names = |list: Vec<String>| if list.is_empty() { "none".to_owned() } else { list.join(", ") };
    let interfaces: Vec<String> = case.interfaces.iter().map(|i| i.name.value.clone()).collect();
    let contacts: Vec<String> = case.contacts.iter().map(|c| c.name.value.clone()).collect();
    let probes: Vec<String> = case.probes.iter().map(|p| p.name.value.clone()).collect();
    let text = format!(
        "\n{table}\ninterfaces: {}; contacts: {}; probes: {}; {} boundary blocks, {} checks, {} steps\n",
        names(interfaces.clone()),
        names(contacts.clone()),
        names(probes.clone()),
        case.boundaries.len(),
        case.checks.len(),
        case.steps.value.len()
    );
    let fields = json!({"patches": list, "interfaces": interfaces, "contacts": contacts, "probes": probes,
        "boundaries": case.boundaries.len(), "checks": case.checks.len(), "steps": case.steps.value});
    (text, fields)
}
