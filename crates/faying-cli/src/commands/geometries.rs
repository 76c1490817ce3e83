//! The geometries of a case as spline patches: as they are, and cut into its elements.

use crate::case::{Case, Patch, Shape};
use crate::errors::{Diagnostic, Diagnostics};
use crate::registry::Fault;
use crate::shapes::{plane_net, solid_net};
use faying::basis::Cell;
use faying::geometry::ControlNet;
use faying::space::divided;
use faying_files::{Format, SplineFile, SplinePatch};

/// The geometries of a case, with notes on those that are read from a mesh.
pub fn patches(case: &Case) -> Result<SplineFile, Diagnostics> {
    made(case, false)
}

/// These geometries, each with a knot at every border of the elements that the case asks for.
pub fn cut(case: &Case) -> Result<SplineFile, Diagnostics> {
    let file = made(case, true)?;
    if file.patches.is_empty() {
        let fault = Diagnostic::error("E043", "all bodies of the case are meshes of files").with_help("convert these files");
        let at = case.patches.first().map(|p| p.geometry.at);
        return Err(match at {
            Some(at) => fault.at(&case.source, at).into(),
            None => fault.into(),
        });
    }
    Ok(file)
}

fn made(case: &Case, cut: bool) -> Result<SplineFile, Diagnostics> {
    let mut file = SplineFile { format: Format::Gismo, patches: Vec::new(), joints: Vec::new(), labels: Vec::new(), notes: Vec::new() };
    for patch in &case.patches {
        let name = &patch.name.value;
        // mesh cells are no splines; splines of files are already scaled, rotated and moved
        if let Shape::File { file: path, .. } = &patch.geometry.value.shape.value
            && patch.geometry.shape.mesh_part().is_some()
        {
            file.notes.push(format!("patch \"{name}\" is of a mesh: faying inspect {}", path.value));
            continue;
        }
        let made = match case.model.dimension.value {
            3 => solid_net(&patch.geometry.value).map(|net| (net, cut)).and_then(|made| of_net(patch, made)),
            _ => plane_net(&patch.geometry.value).map(|net| (net, cut)).and_then(|made| of_net(patch, made)),
        };
        match made {
            Ok(cells) => {
                file.patches.push(cells);
                if cut && patch.discretization.cells.value == Cell::Simplex {
                    file.notes.push(format!("the simplices of patch \"{name}\": its cells are the boxes that they are cut from"));
                }
            }
            Err(fault) => {
                let text = format!("geometry of patch \"{name}\": {fault}");
                return Err(Diagnostic::error(fault.code, text).at(&case.source, patch.geometry.at).into());
            }
        }
    }
    Ok(file)
}

/// A control net as a patch of a file, with knots at the borders of its elements if it is cut.
fn of_net<const N: usize>(patch: &Patch, (mut net, cut): (ControlNet<N, N>, bool)) -> Result<SplinePatch, Fault> {
    for k in 0..if cut { N } else { 0 } {
        let grading = patch.grade.as_ref().and_then(|g| g.value.get(k).copied().flatten());
        let own = net.axes[k].breakpoints().to_vec();
        let all =
            divided(&own, &patch.elements.value[k].value, grading, patch.refine.value).map_err(|e| Fault::new("E015", e.to_string()))?;
        let new: Vec<f64> = all.into_iter().filter(|t| !own.contains(t)).collect();
        net = net.insert(k, &new).map_err(|e| Fault::new("E015", e.to_string()))?;
    }
    Ok(SplinePatch {
        name: Some(patch.name.value.clone()),
        degree: net.axes.iter().map(|a| a.polynomial_degree()).collect(),
        knots: net.axes.iter().map(|a| a.knots().to_vec()).collect(),
        points: net.points.iter().map(|p| std::array::from_fn(|k| if k < N { p[k] } else { 0.0 })).collect(),
        weights: net.weights,
        world: N,
        ..SplinePatch::default()
    })
}
