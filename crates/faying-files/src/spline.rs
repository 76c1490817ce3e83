//! Spline patches as stored in files.

use super::{FileError, Format};
use faying::basis::{Rational, TensorProduct};
use faying::geometry::{ControlNet, ControlPoints, Geometry, collapsed_faces};
use faying::linalg::Vector;

/// A side of a patch of a file.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct PatchSide {
    /// Index of the patch in the file, from 0.
    pub patch: usize,
    /// u0, u1, v0, v1, w0, w1.
    pub side: String,
}

/// Sides under a name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    /// The name, or the number as text.
    pub name: String,
    /// The sides.
    pub sides: Vec<PatchSide>,
}

/// The knot vector of a file that a direction of a patch uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KnotUse {
    /// Its number in the file, from 0.
    pub vector: usize,
    /// Whether the direction runs against it.
    pub reversed: bool,
}

/// A NURBS or B-spline patch.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SplinePatch {
    /// Its number in the file, if any.
    pub id: Option<i64>,
    /// Its name in the file, if any.
    pub name: Option<String>,
    /// Degree per direction.
    pub degree: Vec<usize>,
    /// Open knot vector per direction.
    pub knots: Vec<Vec<f64>>,
    /// Control points, first direction fastest; missing coordinates are zero.
    pub points: Vec<[f64; 3]>,
    /// Weights of a rational patch.
    pub weights: Option<Vec<f64>>,
    /// Coordinates per point in the file: 1 to 3.
    pub world: usize,
    /// Number of its material, if the file has one (the attribute of MFEM).
    pub attribute: Option<i64>,
    /// Knot vector of the file per direction; empty if the file does not number them.
    pub uses: Vec<KnotUse>,
}

impl SplinePatch {
    /// Number of parameters.
    pub fn dimension(&self) -> usize {
        self.degree.len()
    }

    /// Names of the sides u0, u1, v0, .. that are no lines (surfaces of solids): their points along a direction are one.
    pub fn collapsed_sides(&self) -> Vec<String> {
        let functions = self.knots.iter().zip(&self.degree).map(|(u, p)| u.len().saturating_sub(p + 1));
        let mut faces = collapsed_faces(&functions.collect::<Vec<_>>(), &self.points);
        faces.dedup_by_key(|f| (f.axis, f.end));
        faces.into_iter().map(|f| format!("{}{}", ["u", "v", "w"][f.axis.min(2)], f.end)).collect()
    }

    /// The net in N coordinates.
    ///
    /// # Errors
    /// [`FileError::Dimension`] unless the patch has D parameters and its points have no coordinate beyond N;
    /// [`FileError::Broken`] for knots, counts and weights.
    pub fn net<const D: usize, const N: usize>(&self) -> Result<ControlNet<D, N>, FileError> {
        let name = self.name.as_deref().map_or(String::new(), |n| format!(" \"{n}\""));
        if self.degree.len() != D || self.knots.len() != D {
            let what = format!("patch{name} has {} parameters, {D} are needed", self.degree.len());
            return Err(FileError::Dimension { what, spot: None });
        }
        if let Some(k) = self.points.iter().position(|p| p[N..].iter().any(|x| *x != 0.0)) {
            let what = format!("control point {k} of patch{name} is {:?}, off the space of {N} coordinates", self.points[k]);
            return Err(FileError::Dimension { what, spot: None });
        }
        let points = self.points.iter().map(|p| Vector::<N>::from_fn(|k, _| p[k])).collect();
        let degree = std::array::from_fn(|k| self.degree[k]);
        let knots = std::array::from_fn(|k| self.knots[k].clone());
        ControlNet::from_knots(degree, knots, points, self.weights.clone())
            .map_err(|e| FileError::Broken { what: format!("patch{name}: {e}"), spot: None })
    }

    /// The map of a patch of D parameters on its knot spans.
    ///
    /// # Errors
    /// As [`net`](Self::net).
    pub fn map<const D: usize>(&self) -> Result<Box<dyn Geometry<D, 3>>, FileError> {
        let net = self.net::<D, 3>()?;
        let product = TensorProduct::new(net.axes);
        Ok(match net.weights {
            None => Box::new(ControlPoints { basis: product, points: net.points }),
            Some(w) => Box::new(ControlPoints { basis: Rational::new::<D>(product, w), points: net.points }),
        })
    }
}

/// A file of spline patches.
#[derive(Clone, Debug, PartialEq)]
pub struct SplineFile {
    /// Its format.
    pub format: Format,
    /// The patches in the order of the file.
    pub patches: Vec<SplinePatch>,
    /// Sides that two patches share according to the file; actual contact is determined from the geometry.
    pub joints: Vec<[PatchSide; 2]>,
    /// Named or numbered sides.
    pub labels: Vec<Label>,
    /// Contents of the file that are not read, one sentence each.
    pub notes: Vec<String>,
}
