//! Contents of a file of spline patches.

use super::look::{Soundness, is_flat, look};
use super::side_place::SidePlace;
use faying::basis::BSpline;
use faying::geometry::Geometry;
use faying::space::measure;
use faying_files::{FileError, SplineFile, SplinePatch};
use serde::Serialize;
use std::collections::BTreeMap;

/// One patch.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PatchReport {
    /// Its name in the file, else its index there.
    pub name: String,
    /// Its number in the file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub id: Option<i64>,
    /// Degree per direction.
    pub degree: Vec<usize>,
    /// Knot spans per direction.
    pub elements: Vec<usize>,
    /// Knot vector per direction.
    pub knots: Vec<Vec<f64>>,
    /// Whether its weights vary.
    pub rational: bool,
    /// right, left, or mixed where the map folds over.
    pub handedness: String,
    /// Length, area or volume.
    pub measure: f64,
    /// Length or area of every side; zero where it has collapsed.
    pub sides: BTreeMap<String, f64>,
    /// Middle and outward normal of every side.
    pub places: BTreeMap<String, SidePlace>,
}

/// Sides under a name.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LabelReport {
    /// The name.
    pub name: String,
    /// Its sides: PATCH.SIDE.
    pub sides: Vec<String>,
    /// Their length or area.
    pub measure: f64,
}

/// The name of a patch: its own, else its index.
pub fn name_of(file: &SplineFile, patch: usize) -> String {
    file.patches.get(patch).and_then(|p| p.name.clone()).unwrap_or_else(|| patch.to_string())
}

/// The map of a patch of D parameters on its knot spans.
///
/// # Errors
/// [`FileError`] where knots, points and weights do not fit.
pub fn map_of<const D: usize>(patch: &SplinePatch) -> Result<Box<dyn Geometry<D, 3>>, FileError> {
    patch.map::<D>()
}

/// Knot spans of a knot vector.
pub(super) fn spans(degree: usize, knots: &[f64]) -> usize {
    BSpline::try_new(degree, knots.to_vec()).map_or(0, |b| b.breakpoints().len().saturating_sub(1))
}

/// The side of a patch: u0, u1, v0, ... of a patch with open knot vectors.
pub fn face(patch: &SplinePatch, axis: usize, end: usize) -> SplinePatch {
    let counts: Vec<usize> = (0..patch.dimension()).map(|k| (patch.knots[k].len()).saturating_sub(patch.degree[k] + 1)).collect();
    let before: usize = counts[..axis].iter().product();
    let last = if end == 0 { 0 } else { counts[axis].saturating_sub(1) };
    let on = |i: &usize| before > 0 && (i / before) % counts[axis].max(1) == last;
    let keep: Vec<usize> = (0..patch.points.len()).filter(on).collect();
    let without = |k: &usize| *k != axis;
    let axes: Vec<usize> = (0..patch.dimension()).filter(without).collect();
    SplinePatch {
        id: None,
        name: None,
        degree: axes.iter().map(|&k| patch.degree[k]).collect(),
        knots: axes.iter().map(|&k| patch.knots[k].clone()).collect(),
        points: keep.iter().map(|&i| patch.points[i]).collect(),
        weights: patch.weights.as_ref().map(|w| keep.iter().map(|&i| w[i]).collect()),
        world: patch.world,
        attribute: None,
        uses: Vec::new(),
    }
}

/// The names and faces of all sides.
pub fn faces(patch: &SplinePatch) -> Vec<(String, SplinePatch)> {
    let letters = ["u", "v", "w"];
    let all = (0..patch.dimension().min(3)).flat_map(|k| [(k, 0), (k, 1)]);
    all.map(|(k, end)| (format!("{}{end}", letters[k]), face(patch, k, end))).collect()
}

/// Length, area or volume of a patch; zero for a point.
fn size(patch: &SplinePatch) -> Result<f64, FileError> {
    Ok(match patch.dimension() {
        1 => measure::<1, 3, f64, _>(&*map_of::<1>(patch)?),
        2 => measure::<2, 3, f64, _>(&*map_of::<2>(patch)?),
        3 => measure::<3, 3, f64, _>(&*map_of::<3>(patch)?),
        _ => 0.0,
    })
}

fn soundness<const D: usize>(name: &str, patch: &SplinePatch) -> Result<Soundness, FileError> {
    let degree = patch.degree.iter().copied().max().unwrap_or(1);
    Ok(look::<D>(name, &*map_of::<D>(patch)?, degree, is_flat(&patch.points, D), &|e| e as u64))
}

/// A patch and its quality.
///
/// # Errors
/// [`FileError`] where knots, points and weights do not fit, or there are more than three parameters.
pub fn patch(name: String, patch: &SplinePatch) -> Result<(PatchReport, Soundness), FileError> {
    let quality = match patch.dimension() {
        1 => soundness::<1>(&name, patch)?,
        2 => soundness::<2>(&name, patch)?,
        3 => soundness::<3>(&name, patch)?,
        n => return Err(FileError::Dimension { what: format!("patch \"{name}\" has {n} parameters; 1 to 3 are known"), spot: None }),
    };
    let (mut sides, mut places) = (BTreeMap::new(), BTreeMap::new());
    if patch.dimension() > 1 {
        let collapsed = patch.collapsed_sides();
        for (k, (side, face)) in faces(patch).into_iter().enumerate() {
            places.insert(side.clone(), SidePlace::of(patch, k / 2, k % 2)?);
            let measure = if collapsed.contains(&side) { 0.0 } else { size(&face)? };
            sides.insert(side, measure);
        }
    }
    let varies = |w: &Vec<f64>| w.iter().any(|v| *v != w[0]);
    let report = PatchReport {
        name,
        id: patch.id,
        degree: patch.degree.clone(),
        elements: patch.degree.iter().zip(&patch.knots).map(|(p, k)| spans(*p, k)).collect(),
        knots: patch.knots.clone(),
        rational: patch.weights.as_ref().is_some_and(varies),
        handedness: if quality.inverted > 0 { "mixed".into() } else { quality.handedness().into() },
        measure: size(patch)?,
        sides,
        places,
    };
    Ok((report, quality))
}

/// The labels of a file with their sizes.
pub fn labels(file: &SplineFile, patches: &[PatchReport]) -> Vec<LabelReport> {
    file.labels
        .iter()
        .map(|label| LabelReport {
            name: label.name.clone(),
            sides: label.sides.iter().map(|s| format!("{}.{}", name_of(file, s.patch), s.side)).collect(),
            measure: label.sides.iter().filter_map(|s| patches.get(s.patch)?.sides.get(&s.side)).sum(),
        })
        .collect()
}
