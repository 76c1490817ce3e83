//! Contacts.

use super::BodySide;
use crate::basis::Basis;
use crate::contact::{Cone, ContactMethod, ContactRows};
use crate::coupling::consistency::ConsistencyEstimate;
use crate::coupling::{Rows, Segments};
use crate::linalg::Vector;
use crate::problem::contact_fluxes::SideFluxes;
use crate::problem::data::{Data, Point};
use crate::problem::handles::ContactId;
use crate::problem::last_time::LastTime;
use crate::problem::obstacle::MovingObstacle;
use crate::problem::start::Start;
use crate::quadrature::PerElement;
use std::collections::HashSet;
use std::sync::Arc;

/// The opponent of a contact side.
pub enum Opposing<const S: usize, const N: usize> {
    /// A deformable side.
    Side(Arc<BodySide<S, N>>, Segments<S>),
    /// A rigid obstacle, points of the slave, and the rules of its elements where the obstacle does not end within them.
    Rigid(Arc<MovingObstacle<S, N>>, Segments<S>, PerElement<S>),
}

impl<const S: usize, const N: usize> std::fmt::Debug for Opposing<S, N> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Side(side, _) => f.debug_tuple("Side").field(&side.label).finish(),
            Self::Rigid(obstacle, ..) => f.debug_tuple("Rigid").field(obstacle).finish(),
        }
    }
}

/// A slave side of a contact.
#[derive(Debug)]
pub struct ContactPart<const S: usize, const N: usize> {
    /// Place of the slave side in the statement.
    pub number: usize,
    /// The side that carries the multiplier.
    pub slave: Arc<BodySide<S, N>>,
    /// Multiplier space; `None` for methods whose rows belong to points.
    pub multiplier: Option<Box<dyn Basis<S>>>,
    /// Functions by which the pressure is evaluated; `None`: those of the multiplier.
    pub reading: Option<Box<dyn Basis<S>>>,
    /// (p, k) if the multiplier is the unstable pairing p/p-k under another name.
    pub unstable: Option<(usize, usize)>,
    /// Functions of the model on the side, and on what it faces, that supports hold along the normals.
    pub held: HashSet<usize>,
    /// Whether the multiplier is the dual one of the side.
    pub is_dual: bool,
    /// Cone of admissible multipliers.
    pub cone: Cone,
    /// The opponent.
    pub against: Opposing<S, N>,
    /// Segments for the integrals over the master, for mixed integration.
    pub second: Option<Segments<S>>,
    /// Rows of a finer integration, for the consistency error: those of the multiplier, without one of a constant per element; `None` against
    /// an obstacle.
    pub finer: Option<ConsistencyEstimate>,
    /// Rows of a constant per element of the slave, which the finer ones are compared with where rows belong to points.
    pub by_elements: Option<Rows>,
    /// Deformable master sides, joined into one in `against`.
    pub masters: Vec<Arc<BodySide<S, N>>>,
    /// Rows, offsets and weights at the first time at which a point of the side faces the opponent.
    pub first: ContactRows<S, N>,
    /// Largest gap or overlap at rest that facets explain and the contact closes \[length\].
    pub closes: f64,
    /// Fluxes of the bodies, if the method needs them.
    pub fluxes: LastTime<SideFluxes<S, N>>,
    /// Whether they change with the time.
    pub changes: bool,
    /// First row in the system.
    pub first_row: usize,
    /// Number of rows.
    pub num_rows: usize,
}

impl<const S: usize, const N: usize> ContactPart<S, N> {
    /// The functions through which lambda is read at points, one per multiplier; none without multiplier.
    pub fn read_through(&self) -> Option<&dyn Basis<S>> {
        self.reading.as_deref().or(self.multiplier.as_deref())
    }

    /// Its rows in the system.
    pub fn rows(&self) -> std::ops::Range<usize> {
        self.first_row..self.first_row + self.num_rows
    }
}

/// A contact.
#[derive(Debug)]
pub struct ContactModel<const S: usize, const N: usize> {
    /// Its handle.
    pub id: ContactId,
    /// Slave sides, by their places in the statement, that face nothing while others do.
    pub idle: Vec<usize>,
    /// Its name.
    pub name: String,
    /// One part per slave side.
    pub parts: Vec<ContactPart<S, N>>,
    /// The rigid obstacle that it faces, if it is one.
    pub obstacle: Option<Arc<MovingObstacle<S, N>>>,
    /// Gap as a function of position, time and geometric gap.
    pub gap: Data,
    /// Largest distance of partners of rigid obstacles.
    pub reach: Option<f64>,
    /// Exact multiplier; none: from the model's exact solution, if any.
    pub exact: Option<Data>,
    /// Whether a zone that ends at the end of a side goes on beyond it: half models.
    pub symmetry: bool,
    /// First guess of the active set.
    pub start: Start,
    /// The method by which it is enforced.
    pub method: Arc<dyn ContactMethod<S, N>>,
}

impl<const S: usize, const N: usize> ContactModel<S, N> {
    /// The gap at `x` for the geometric gap `g` \[length\], of which up to `closes` is none.
    pub fn wanted(&self, x: &Vector<N>, t: f64, g: f64, closes: f64) -> f64 {
        let g = if g.abs() <= closes { 0.0 } else { g };
        self.gap.value(&Point::new(x.as_slice()).at_time(t).with_gap(g))
    }

    /// Whether the gap of a part depends on the geometric one, as that of `"-0.01"` does not; `size`: a length to compare by.
    pub fn follows_sides(&self, part: &ContactPart<S, N>, t: f64, size: f64) -> bool {
        let frames = &part.first.frames;
        let differs = |(x, &g): (&Vector<N>, &f64)| self.wanted(x, t, g, 0.0) != self.wanted(x, t, g + size, 0.0);
        frames.x.iter().zip(&frames.gap).any(differs)
    }
}
