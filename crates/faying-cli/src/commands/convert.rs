//! `faying convert`: a mesh or geometry file, or the bodies of a case, in another format.

use super::arguments::{Common, ConvertArguments};
use super::case;
use super::ended::Exit;
use super::inspect::{contents, fault, room, write};
use super::place;
use crate::Registry;
use crate::convert::{ConvertOptions, convert as written, format_of, memory};
use crate::errors::{Diagnostic, Diagnostics};
use faying_files::FileError;
use serde_json::json;
use std::path::Path;

/// Checks that the output may be written to its file.
pub fn check_place(arguments: &ConvertArguments, common: &Common, json: Option<&Path>) -> Result<(), Exit> {
    place::apart(&arguments.output, &arguments.input, "convert")?;
    place::not_over(json, &arguments.output)?;
    if format_of(&arguments.output).is_none() {
        let message = format!("`{}` names no format", arguments.output.display());
        return Err(super::ended::usage(&message, Some("end it in .msh (Gmsh), .xml (G+Smo), .mesh (MFEM) or .vtu")));
    }
    if arguments.output.exists() && !common.force {
        let message = format!("`{}` exists", arguments.output.display());
        return Err(Diagnostic::error("E090", message).with_help("write over it with --force, or give another file").into());
    }
    Ok(())
}

/// Converts a file.
pub fn convert(registry: &Registry, arguments: &ConvertArguments, common: &Common) -> Exit {
    converted(registry, arguments, common).unwrap_or_else(|ended| ended)
}

fn converted(registry: &Registry, arguments: &ConvertArguments, common: &Common) -> Result<Exit, Exit> {
    let (input, output) = (&arguments.input, &arguments.output);
    let to = format_of(output).expect("its place was checked before");
    let read = contents(registry, input, common)?;
    let options = ConvertOptions { order: arguments.order.map(usize::from), binary: arguments.binary };
    room(input, memory(&read, to, &options), common)?;
    let pool = case::pool(common)?;
    let made = pool.install(|| written(&read, to, &options)).map_err(|e| {
        let of_format = matches!(e, FileError::Unsupported { .. });
        let fault = fault(output, &e);
        Exit::from(if of_format { fault.with_help("give OUT the ending of a format that holds it: .msh, .vtu or .mesh") } else { fault })
    })?;
    write(output, &made.bytes, common.force)?;
    let shown = output.display().to_string();
    let mut diagnostics = Diagnostics::new();
    for lost in &made.lost {
        diagnostics
            .push(Diagnostic::warning("E043", format!("not in `{shown}`: {lost}")).with_help(format!("`{}` has it", input.display())));
    }
    let fields = json!({"file": input.display().to_string(), "files": [shown], "bytes": made.bytes.len(), "lost": made.lost,
        "warnings": diagnostics.to_json()});
    let text = format!("{shown} written, {} bytes\n", made.bytes.len());
    Ok(Exit { diagnostics, ..Exit::done("convert", text, fields) })
}
