//! Bodies in space of every kind of cells.

use faying::basis::Cell;
use faying::geometry::{ControlNet, shapes, turn_about};
use faying::linalg::{Matrix, Vector};
use faying::physics::Hooke;
use faying::problem::{BodyId, BodyMaterial, BodySpec, Problem};
use faying::space::{BasisKind, Body, Mesh, Patch, PatchSpec};
use std::sync::Arc;

/// The four kinds of bodies in space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Spline,
    Nurbs,
    Hexahedra,
    Tetrahedra,
}

pub const KINDS: [Kind; 4] = [Kind::Spline, Kind::Nurbs, Kind::Hexahedra, Kind::Tetrahedra];

pub type Solid = Arc<dyn Body<2, 3>>;

impl Kind {
    /// The body of a patch; NURBS keep the weights of its net.
    pub fn body(self, spec: &PatchSpec<3>) -> Solid {
        let spec = spec.clone();
        match self {
            Kind::Spline => Arc::new(Patch::<2, 3>::try_new(&spec.with_basis(BasisKind::BSpline)).unwrap()),
            Kind::Nurbs => Arc::new(Patch::<2, 3>::try_new(&spec.with_basis(BasisKind::Nurbs)).unwrap()),
            Kind::Hexahedra => Arc::new(Mesh::<2, 3>::from_patch(&spec).unwrap()),
            Kind::Tetrahedra => Arc::new(Mesh::<2, 3>::from_patch(&spec.with_cells(Cell::Simplex)).unwrap()),
        }
    }

    /// A box turned by `turn`; NURBS get weights that vary.
    pub fn turned_box(self, (min, max): ([f64; 3], [f64; 3]), turn: &Matrix<3, 3>, degree: usize, elements: [usize; 3]) -> Solid {
        let mut net = shapes::brick(min, max).unwrap();
        if self == Kind::Nurbs {
            net = weighted(&net);
        }
        self.body(&PatchSpec::new(net.rotate(turn)).with_degree([degree; 3]).with_elements(elements))
    }

    /// Gauss points beyond the default: rational functions are never integrated exactly.
    pub fn extra_points(self) -> usize {
        if self == Kind::Nurbs { 4 } else { 0 }
    }

    /// Adds a body with its points.
    pub fn add(self, p: &mut Problem<2, 3>, name: &str, body: Solid, material: Hooke<3>) -> BodyId {
        let spec = BodySpec { extra_points: self.extra_points(), ..BodySpec::new(name, body, BodyMaterial::of(material).unwrap()) };
        p.add(spec).unwrap()
    }
}

/// The net of a box with weights between 0.98 and 1.02: a rational map that keeps its sides flat.
pub fn weighted(net: &ControlNet<3, 3>) -> ControlNet<3, 3> {
    let weights = (0..net.points.len()).map(|i| 1.0 + 0.02 * (1.7 * i as f64 + 0.4).sin()).collect();
    ControlNet::try_new(net.axes.clone(), net.points.clone(), Some(weights)).unwrap()
}

/// Turns that bring the z axis to oblique directions, the first one none.
pub fn turns() -> [Matrix<3, 3>; 3] {
    let about = |axis: [f64; 3], degrees: f64| turn_about(&Vector::<3>::from(axis), degrees).unwrap();
    [Matrix::identity(), about([0.0, 1.0, 0.0], 35.0), about([0.3, -1.0, 0.4], 118.0)]
}

pub fn steel() -> Hooke<3> {
    Hooke::solid(1.0, 0.3).unwrap()
}
