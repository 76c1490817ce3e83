//! `[[patch]]`: bodies, and the joints between patches of one file.

use super::{Components, Discretization, Divisions, Grading, Head};
use crate::case::part::FilePart;
use crate::formula::Formula;
use crate::place::{Located, SourceSpan};
use std::sync::Arc;

/// A built-in shape, or a net of control points.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Shape {
    /// u, v (, w) = x, y (, z).
    Box {
        /// Least coordinates.
        min: Located<Vec<f64>>,
        /// Largest coordinates.
        max: Located<Vec<f64>>,
    },
    /// u = angle, v = radius.
    AnnulusSector {
        /// Centre.
        center: Located<Vec<f64>>,
        /// Inner and outer radius.
        radius: Located<[f64; 2]>,
        /// First and last angle in degrees.
        angle_deg: Located<[f64; 2]>,
    },
    /// u = angle, v = radius; v0 is the centre and no side.
    DiscSector {
        /// Centre.
        center: Located<Vec<f64>>,
        /// Radius.
        radius: Located<f64>,
        /// First and last angle in degrees.
        angle_deg: Located<[f64; 2]>,
    },
    /// A quarter; u around the hole from the x axis to the y axis, v from the hole to the edge.
    PlateWithHole {
        /// Radius of the hole.
        radius: Located<f64>,
        /// Half the width of the whole plate.
        half_width: Located<f64>,
    },
    /// u = longitude, v = latitude, w = radius.
    SphereOctant {
        /// Centre.
        center: Located<Vec<f64>>,
        /// Inner and outer radius.
        radius: Located<[f64; 2]>,
    },
    /// Control points, u fastest. Counts, knots and weights are already checked (E031 to E034).
    Nurbs {
        /// Degree per direction.
        degree: Located<Vec<usize>>,
        /// Open knot vector per direction.
        knots: Vec<Located<Vec<f64>>>,
        /// Points, u fastest.
        points: Located<Vec<Vec<f64>>>,
        /// Weights, all 1 where `None`.
        weights: Option<Located<Vec<f64>>>,
    },
    /// A file of patches or a mesh.
    File {
        /// Path relative to the case file.
        file: Located<String>,
        /// The number of a spline patch in it.
        id: Option<Located<String>>,
        /// Name or number of the group of a mesh.
        group: Option<Located<String>>,
        /// Path of a list of knots that are added to the spline patches.
        refinement: Option<Located<String>>,
        /// Parts read from the file: one for a patch of the case.
        parts: Vec<Arc<FilePart>>,
    },
}

impl Shape {
    /// The part of its file that makes a patch; `None` for other shapes.
    pub fn part(&self) -> Option<&FilePart> {
        match self {
            Self::File { parts, .. } => parts.first().map(|p| &**p),
            _ => None,
        }
    }

    /// The part of a mesh that makes a patch; `None` for splines and other shapes.
    pub fn mesh_part(&self) -> Option<&FilePart> {
        self.part().filter(|part| part.is_mesh())
    }

    pub(in crate::case) fn part_mut(&mut self) -> Option<&mut FilePart> {
        match self {
            Self::File { parts, .. } => parts.first_mut().map(Arc::make_mut),
            _ => None,
        }
    }

    /// The word of the case file.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Box { .. } => "box",
            Self::AnnulusSector { .. } => "annulus-sector",
            Self::DiscSector { .. } => "disc-sector",
            Self::PlateWithHole { .. } => "plate-with-hole",
            Self::SphereOctant { .. } => "sphere-octant",
            Self::Nurbs { .. } => "nurbs",
            Self::File { .. } => "file",
        }
    }

    /// Whether `elements` counts in total (built-in shapes) rather than per knot span.
    pub fn is_built_in(&self) -> bool {
        !matches!(self, Self::Nurbs { .. } | Self::File { .. })
    }
}

/// `geometry`: a shape, then extrude, scale, rotate and move in this order.
#[derive(Clone, Debug, PartialEq)]
pub struct Geometry {
    /// The shape.
    pub shape: Located<Shape>,
    /// Height along z.
    pub extrude: Option<Located<f64>>,
    /// Factor about the origin.
    pub scale: Option<Located<f64>>,
    /// Angle in degrees about the origin.
    pub rotate_deg: Option<Located<f64>>,
    /// Axis of the rotation in 3D.
    pub axis: Option<Located<Vec<f64>>>,
    /// Translation (`move`).
    pub translate: Option<Located<Vec<f64>>>,
}

/// `[[patch]]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    /// The block.
    pub head: Head,
    /// Its name.
    pub name: Located<String>,
    /// Its shape.
    pub geometry: Located<Geometry>,
    /// Index into [`Case::materials`](super::Case::materials).
    pub material: Located<usize>,
    /// One entry per direction.
    pub elements: Located<Vec<Located<Divisions>>>,
    /// Halvings of every element.
    pub refine: Located<usize>,
    /// Grading.
    pub grade: Option<Located<Vec<Option<Grading>>>>,
    /// Degree, backend, ...: the patch's own or the defaults.
    pub discretization: Discretization,
    /// Manufactured solution in this patch, instead of that of the model.
    pub exact: Option<Located<Vec<Located<Formula>>>>,
    /// Body force or source of this patch, beside that of the model, one formula per component.
    pub source: Option<Located<Vec<Located<Formula>>>>,
    /// Acceleration of this patch, beside that of the model; needs a density.
    pub gravity: Option<Located<Vec<f64>>>,
    /// Springs of the volume of this patch, or its reaction term, beside that of the model.
    pub foundation: Components<Formula>,
    /// Direction that closes on itself.
    pub closed: Option<Located<String>>,
    /// Whether the patches of a file are glued.
    pub glue: Located<bool>,
}

/// Two sides with the same facets of one mesh file: their patches share the functions there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Joint {
    /// The sides.
    pub sides: [SideRef; 2],
    /// Place of the patch block.
    pub at: SourceSpan,
}

/// A point of one mesh file where patches meet without a common facet: they share the function of that point.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Meeting {
    /// The patches.
    pub patches: Vec<usize>,
    /// Index of the point in the file.
    pub point: usize,
    /// Place of the block of the last patch.
    pub at: SourceSpan,
}

/// A side of a patch by its canonical name, or the tag of a mesh.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct SideRef {
    /// Index into [`Case::patches`](super::Case::patches).
    pub patch: usize,
    /// `u0`, `u1`, `v0`, `v1`, `w0`, `w1`, or the tag of a mesh.
    pub side: String,
}
