//! Merged integration on surfaces in space: every slave element is cut where its closest point changes the master element.
//!
//! A region is the part of a slave element S whose partners lie in a master element F. Its boundary is made of the edges of F, seen
//! in the local coordinates of S along the normals of the master (`chart.rs`): lines, or polynomials of degree 8 (`trace.rs`), which
//! neighbouring regions share, and of sides of S (`clip.rs`). Regions carry rules with positive weights (`cell_rule.rs`), whose points are
//! paired with their feet on the continued element F, never clamped: an edge wrong by δ costs O(δ²) even between kinked functions.
//! At a kink of the master the fan of points is halved by the mean normals of its edges and vertices (`skeleton.rs`).
//! Where the regions of an element overlap, those that the closest point does not confirm are dropped; what then does not tile is cut in
//! four and tried again, and reported in the end: as an error of touching sides, in [`Coverage`](super::Coverage) otherwise.
//! Cost: n log n.

mod biquadratic;
mod cell_rule;
mod chart;
mod clip;
mod covered;
mod element;
mod facets;
mod master_sums;
mod nearby;
mod numbers;
mod owner;
mod parts;
mod piece;
mod pole;
mod polygon;
mod region_maps;
mod regions;
mod skeleton;
mod slave;
mod trace;

use super::slave_pieces::{SlavePieces, join};
use super::{InterfaceQuadrature, Partners, Segments, Tolerance};
use crate::coupling::CouplingError;
use crate::geometry::Geometry;
use crate::parallel;
use element::{Scratch, Sides};

pub use master_sums::MasterSurfaceSums;
pub use slave::SlaveSurface;

/// Gauss points on the regions that elements of both sides share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MergedSurface {
    /// Gauss points per direction on rectangles along both cells, p + 1 for functions of degree p. Other straight regions of affine cells
    /// take as many as integrate products of such functions exactly: p + 1 between triangles, 2 p + 1 where a tensor cell meets one that is
    /// turned, or a triangle. All others take three more, and at least five: their sums converge fast, but are never exact.
    pub points: usize,
    /// Pairing rule.
    pub partners: Partners,
}

impl MergedSurface {
    /// Creates the rule for tied sides that carry the same surface, or approximate it within `tolerance`.
    pub fn tied(points: usize, tolerance: Tolerance) -> Self {
        Self { points, partners: Partners::Touching(tolerance) }
    }

    /// Creates the rule for sides in contact, possibly across a gap of at most `reach` (`None`: the size of the slave side).
    pub fn facing(points: usize, reach: Option<f64>) -> Self {
        Self { points, partners: Partners::Facing { reach } }
    }
}

impl InterfaceQuadrature<2, 3> for MergedSurface {
    fn segments(&self, slave: &dyn Geometry<2, 3>, master: &dyn Geometry<2, 3>) -> Result<Segments<2>, CouplingError> {
        if master.num_elements() == 0 {
            return Err(CouplingError::NothingFaces);
        }
        let sides = Sides::new(slave, master, self.partners, self.points.max(1))?;
        let parts: Vec<SlavePieces<2, f64>> =
            parallel::map_init(slave.num_elements(), Scratch::default, |scratch, e| sides.element(e, scratch));
        join(parts, master, matches!(self.partners, Partners::Touching(_)))
    }
}
