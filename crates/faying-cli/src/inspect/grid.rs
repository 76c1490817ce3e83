//! Contents of a VTU beside its mesh: fields with their ranges, and cells that meshes of this program cannot have.

use super::meshes::CellsReport;
use super::{FileError, Inspection};
use crate::table::{Table, short};
use faying_files::vtu_read::{VtuField, VtuFile};
use faying_files::{Format, MeshFile};
use serde::Serialize;

/// A field of a VTU.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FieldReport {
    /// Its name.
    pub name: String,
    /// "points" or "cells".
    pub on: String,
    /// Per component the least and the largest finite value; `None` without finite values.
    pub ranges: Vec<Option<[f64; 2]>>,
}

/// The mesh of a VTU; an empty one, with a note, if its cells are of kinds that are only counted, such as Bezier cells.
///
/// # Errors
/// [`FileError::Broken`]
pub fn mesh_of(file: &VtuFile) -> Result<MeshFile, FileError> {
    match file.mesh() {
        Ok(mut mesh) => {
            // the fields are listed by `add_fields`
            mesh.notes.retain(|note| !note.starts_with("fields at points"));
            Ok(mesh)
        }
        Err(FileError::Unsupported { what, .. }) => {
            let notes = vec![format!("cells are counted, not measured: {what}")];
            Ok(MeshFile { format: Format::Vtu, points: Vec::new(), ids: Vec::new(), blocks: Vec::new(), groups: Vec::new(), notes })
        }
        Err(error) => Err(error),
    }
}

/// Adds the fields of a VTU to the inspection of its mesh, and its counted cells if there is no mesh.
pub fn add_fields(found: &mut Inspection, file: &VtuFile) {
    let report = |on: &str, field: &VtuField| FieldReport { name: field.name.clone(), on: on.into(), ranges: field.ranges() };
    found.fields =
        file.point_fields.iter().map(|f| report("points", f)).chain(file.cell_fields.iter().map(|f| report("cells", f))).collect();
    found.points = Some(file.points.len());
    if found.cells.is_empty() {
        let degrees = file.cell_fields.iter().find(|f| f.name == "HigherOrderDegrees");
        for (kind, name, count) in file.cell_types() {
            let own = file.types.iter().enumerate().filter(|(_, t)| **t == kind).map(|(k, _)| k);
            let largest =
                |d: &VtuField| own.flat_map(|k| &d.values[d.components * k..d.components * (k + 1)]).fold(1.0, |m: f64, v| m.max(*v));
            // types from 68 on are those of high order
            let order = degrees.filter(|_| kind >= 68).map_or(1, |d| largest(d) as usize);
            found.cells.push(CellsReport { shape: name.into(), order, count });
            found.dimension = found.dimension.max(dimension(kind));
        }
    }
}

/// Dimension of the cells of a VTK type.
fn dimension(kind: u8) -> usize {
    match kind {
        3 | 68 | 75 => 1,
        5 | 9 | 69 | 70 | 76 | 77 => 2,
        10 | 12 | 13 | 14 | 71..=73 | 78..=80 => 3,
        _ => 0,
    }
}

/// One row per component.
pub(super) fn table(fields: &[FieldReport]) -> Table {
    let mut table = Table::new(["field", "on", "component", "least", "largest"]);
    for field in fields {
        for (k, range) in field.ranges.iter().enumerate() {
            let [least, largest] = range.map_or(["-".to_owned(), "-".to_owned()], |r| r.map(|v| short(v, 7)));
            let component = if field.ranges.len() == 1 { String::new() } else { k.to_string() };
            table.row([field.name.clone(), field.on.clone(), component, least, largest]);
        }
    }
    table
}
