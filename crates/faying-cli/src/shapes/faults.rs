//! Codes of the errors of nets, shapes, patches, meshes and outlines.

use crate::case::FilePart;
use crate::codes;
use crate::registry::Fault;
use faying::contact::OutlineError;
use faying::geometry::{NetError, shapes::ShapeError};
use faying::space::{MeshError, SpecError};
use faying_files::FileError;

/// Error code of an unusable net.
fn of_net(error: &NetError) -> &'static str {
    match error {
        NetError::Weights(_) => "E034",
        NetError::Counts { .. } => "E033",
        _ => "E031",
    }
}

impl From<NetError> for Fault {
    fn from(error: NetError) -> Self {
        Self::new(of_net(&error), error.to_string())
    }
}

impl From<ShapeError> for Fault {
    fn from(error: ShapeError) -> Self {
        let code = if let ShapeError::TensorField(inner) = &error { of_net(inner) } else { "E015" };
        Self::new(code, error.to_string())
    }
}

impl From<FileError> for Fault {
    fn from(error: FileError) -> Self {
        Self::new(codes::of_file(&error), error.to_string())
    }
}

impl From<SpecError> for Fault {
    fn from(error: SpecError) -> Self {
        let code = match &error {
            SpecError::Inverted(_) | SpecError::FlatCell { .. } => "E041",
            SpecError::ExactCollapsed { .. } => "E019",
            SpecError::Weights(_) => "E034",
            _ => "E015",
        };
        let of_elements = matches!(error, SpecError::BreakpointOutside { .. } | SpecError::BreakpointsFall { .. });
        Self { key: if of_elements { "elements" } else { "" }, ..Self::new(code, error.to_string()) }
    }
}

impl From<OutlineError> for Fault {
    fn from(error: OutlineError) -> Self {
        Self::new(if let OutlineError::Weights(_) = &error { "E034" } else { "E041" }, error.to_string())
    }
}

/// Error of an unusable mesh in the numbers of the file of `part`; cell k is a child of cell k >> `shift`.
pub(crate) fn mesh_fault(error: MeshError, part: Option<&FilePart>, shift: usize) -> Fault {
    let (code, key) = match &error {
        MeshError::Inverted(_) | MeshError::Folded { .. } | MeshError::Collapsed { .. } => ("E041", ""),
        MeshError::Degree { .. } => ("E015", "degree"),
        _ => ("E043", ""),
    };
    let error = match part {
        Some(part) => {
            let cell = |k: usize| part.cell_ids().get(k >> shift).map_or(k, |id| *id as usize);
            let point = |k: usize| part.point_ids().get(k).map_or(k, |id| *id as usize);
            error.renumbered(cell, point)
        }
        None => error,
    };
    Fault { key, ..Fault::new(code, error.to_string()) }
}
