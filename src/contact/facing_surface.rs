//! The closest point of a side of a body in space, as what a contact faces.

use super::{Hit, Location, Obstacle};
use crate::basis::Order;
use crate::geometry::{ClosestPoint, Geometry, MapTable, Oriented, unit_normal};
use crate::linalg::Vector;
use crate::space::{Space, Trace};
use std::sync::Arc;

/// Overhang beyond a rim that counts as round-off, as a share of the size of the side.
const RIM: f64 = 1e-8;

/// The closest point of a side in space, with the outward normal of its element there; points beyond its rims, and those that the normal
/// there does not oppose, face nothing.
#[derive(Debug)]
pub struct FacingSurface {
    closest: ClosestPoint<2, 3, Oriented<Arc<dyn Space<2, 3>>>>,
}

impl FacingSurface {
    /// The surface of `trace`.
    pub fn new(trace: &Trace<2, 3>) -> Self {
        Self { closest: ClosestPoint::new(trace.oriented()) }
    }
}

impl Obstacle<2, 3> for FacingSurface {
    fn project(&self, x: &Vector<3>, outward: &Vector<3>) -> Option<Hit<2, 3>> {
        let foot = self.closest.project_opposed(x, outward, self.closest.size() * RIM).filter(|foot| !foot.rim)?;
        let (geometry, mut table) = (self.closest.geometry(), MapTable::new());
        geometry.map(foot.element, &[foot.xi], Order::Gradients, &mut table);
        let normal = unit_normal(&table.jacobian[0], geometry.outward[foot.element]);
        Some(Hit { x: foot.x, normal, gap: (x - foot.x).dot(&normal), at: Some(Location { element: foot.element, xi: foot.xi }) })
    }
}
