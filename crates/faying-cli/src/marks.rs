//! Supports, loads and rigid obstacles in pictures.

use faying::contact::Hit;
use faying::linalg::Vector;

/// A support or a load at a point of a boundary.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// The point \[length\].
    pub at: [f64; 3],
    /// Its displacement \[length\].
    pub moved: [f64; 3],
    /// The outward normal, of length 1.
    pub normal: [f64; 3],
    /// Of a load its direction, of a support the inward normal; of length 1.
    pub toward: [f64; 3],
    /// Its meaning.
    pub kind: MarkKind,
}

/// Meaning of a mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MarkKind {
    /// Prescribed displacements.
    Support,
    /// A traction, a pressure or a force.
    Load,
}

/// A rigid obstacle in a picture, where it is at the time of the output.
#[derive(Debug)]
pub struct RigidPicture {
    /// Name of its contact.
    pub name: String,
    /// Its shape.
    pub shape: RigidShape,
}

/// Closest point of an obstacle in the plane to a point, of all its faces; `None` where none is found.
pub type ClosestInPlane = Box<dyn Fn(&Vector<2>) -> Option<Hit<1, 2>> + Send + Sync>;

/// The shape of a rigid obstacle in a picture.
pub enum RigidShape {
    /// The line in the plane on which the gap is zero.
    Outline(ClosestInPlane),
    /// In space its surface where slave sides face it, found when it is asked for.
    Faces(Box<dyn Fn() -> Vec<RigidFace> + Send + Sync>),
}

impl std::fmt::Debug for RigidShape {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(if matches!(self, Self::Outline(_)) { "Outline" } else { "Faces" })
    }
}

/// A piece of the surface of a rigid obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidFace {
    /// Its corners in order \[length\].
    pub corners: [Vector<3>; 4],
    /// The normal out of the obstacle, of length 1.
    pub normal: Vector<3>,
}
