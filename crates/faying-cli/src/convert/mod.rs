//! Conversion between file formats, as far as the target can represent the data; losses are reported.

mod sample;

pub use sample::{MAX_ORDER, Sampled, sample};

use crate::table::short;
use faying_files::{Contents, FileError, Format, gismo, gmsh, mfem, write_vtu};
use std::path::Path;

/// Cells equal the spline if they are closer to it than this share of the model size.
const EXACT: f64 = 1e-12;

/// Options of a conversion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ConvertOptions {
    /// Order of cells made of splines, 1 to 4; `None`: the highest degree of the file, at most 4.
    pub order: Option<usize>,
    /// Gmsh files in binary.
    pub binary: bool,
}

/// A converted file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Converted {
    /// Its bytes.
    pub bytes: Vec<u8>,
    /// Data that were lost, one sentence each.
    pub lost: Vec<String>,
}

/// The format of an extension: .msh, .xml, .mesh, .vtu.
pub fn format_of(path: &Path) -> Option<Format> {
    match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
        "msh" => Some(Format::Gmsh),
        "xml" => Some(Format::Gismo),
        "mesh" => Some(Format::Mfem),
        "vtu" => Some(Format::Vtu),
        _ => None,
    }
}

/// Bytes per cell and node of a cell while a mesh is written, the text included: measured, tetrahedra of order 1 take 190 in all.
const PER_CELL: [u64; 2] = [200, 16];
/// Bytes per cell for the edges and faces that MFEM meshes need.
const PER_SKELETON: u64 = 500;
/// Bytes per point while it is written.
const PER_POINT: u64 = 100;
/// Bytes per node of a cell that is made of a spline.
const PER_SAMPLE: u64 = 150;

/// Estimate of the bytes that [`convert`] takes beside `contents`.
pub fn memory(contents: &Contents, to: Format, options: &ConvertOptions) -> u64 {
    match contents {
        Contents::Mesh(mesh) => {
            let of_block = |b: &faying_files::MeshBlock| {
                let skeleton = if to == Format::Mfem { PER_SKELETON } else { 0 };
                (PER_CELL[0] + skeleton) * b.ids.len() as u64 + PER_CELL[1] * b.nodes.len() as u64
            };
            mesh.blocks.iter().map(of_block).sum::<u64>() + PER_POINT * mesh.points.len() as u64
        }
        Contents::Patches(file) => {
            let sampled = matches!(to, Format::Gmsh | Format::Vtu);
            let order = options.order.unwrap_or(MAX_ORDER) as u64;
            let of_patch = |p: &faying_files::SplinePatch| {
                // no more cells than control points
                let nodes = if sampled { (order + 1).pow(p.dimension() as u32) } else { 1 };
                (p.points.len() as u64).saturating_mul(nodes * PER_SAMPLE)
            };
            file.patches.iter().map(of_patch).sum()
        }
    }
}

/// Writes `contents` in another format.
///
/// Splines become Lagrange cells on their knot spans in Gmsh and VTU files; a mesh never becomes splines.
///
/// # Errors
/// [`FileError::Unsupported`] if the format cannot hold it.
pub fn convert(contents: &Contents, to: Format, options: &ConvertOptions) -> Result<Converted, FileError> {
    match contents {
        Contents::Patches(file) => {
            let written = match to {
                Format::Gismo => gismo::write(file),
                Format::Mfem => mfem::write(file)?,
                Format::Abaqus => return Err(read_only()),
                Format::Gmsh | Format::Vtu => {
                    let degree = file.patches.iter().flat_map(|p| p.degree.iter().copied()).max().unwrap_or(1);
                    let sampled = sample(file, options.order.unwrap_or(degree.clamp(1, MAX_ORDER)))?;
                    let mut lost = file.notes.clone();
                    lost.push("knots, weights and smoothness of the splines: there is a cell per knot span".into());
                    if sampled.distance > EXACT * sampled.size {
                        let (order, far) = (sampled.order, short(sampled.distance, 3));
                        lost.push(format!("the exact shape: cells of order {order} are up to {far} away from it"));
                    }
                    let collapsed = file.patches.iter().enumerate().flat_map(|(k, patch)| {
                        let name = patch.name.clone().unwrap_or_else(|| k.to_string());
                        patch.collapsed_sides().into_iter().map(move |side| format!("{name}.{side}"))
                    });
                    let collapsed = collapsed.collect::<Vec<_>>().join(", ");
                    if !collapsed.is_empty() {
                        lost.push(format!("the common points of {collapsed}: nodes lie in one place there and belong to one cell each"));
                    }
                    return Ok(Converted { bytes: of_mesh(&sampled.mesh, to, options)?, lost });
                }
            };
            let lost = file.notes.iter().cloned().chain(written.lost).collect();
            Ok(Converted { bytes: written.text.into_bytes(), lost })
        }
        Contents::Mesh(mesh) => match to {
            Format::Gismo => {
                let what = "a Lagrange mesh in G+Smo XML (it holds spline patches; .msh, .mesh and .vtu hold meshes)".to_owned();
                Err(FileError::Unsupported { what, spot: None })
            }
            Format::Mfem => {
                let written = mfem::write_mesh(mesh)?;
                Ok(Converted { bytes: written.text.into_bytes(), lost: mesh.notes.iter().cloned().chain(written.lost).collect() })
            }
            Format::Abaqus => Err(read_only()),
            Format::Gmsh | Format::Vtu => Ok(Converted { bytes: of_mesh(mesh, to, options)?, lost: mesh.notes.clone() }),
        },
    }
}

/// Error of a format that is only read.
fn read_only() -> FileError {
    FileError::Unsupported { what: "an Abaqus input file as output".into(), spot: None }
}

fn of_mesh(mesh: &faying_files::MeshFile, to: Format, options: &ConvertOptions) -> Result<Vec<u8>, FileError> {
    if to == Format::Vtu { write_vtu(mesh) } else { gmsh::write(mesh, options.binary) }
}
