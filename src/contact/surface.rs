//! A rigid obstacle with the shape of a trace, a curve, or the outline of an area.

use super::outline::{OutlinePiece, pieces};
use super::several::Several;
use super::{Hit, Location, Obstacle, opposes};
use crate::basis::Order;
use crate::coupling::interface::{MasterCurve, Partner};
use crate::geometry::{Bounds, Geometry, MapTable, Oriented, unit_normal};
use crate::linalg::{Real, Vector, lit};
use crate::space::Trace;
use std::sync::Arc;

/// Cosine of the turn between two elements above which they have no corner: 10 degrees, more than facets of meshes have.
const SMOOTH: f64 = 0.984_807_753_012_208;
/// Cosines that differ by less are the same.
const ROUNDING: f64 = 1e-9;
/// The face that opposes more may be farther than the closest one by this factor.
const FARTHER: f64 = 10.0;

/// A curve as a map of elements.
type Curve<T> = Arc<dyn Geometry<1, 2, T>>;

/// The closest point of a curved side among what opposes the slave's normal, with the outward normal of the element that owns it.
///
/// Points beyond an end of the side, or of what opposes, face nothing. At a kink between elements that both oppose, the fan of
/// points whose closest point is the vertex is halved between them, each with its own normal; points with a foot on both faces of a corner
/// (10 degrees and more) take the one that opposes more. Points inside the obstacle have a negative gap.
///
/// # Example
/// The line from (0, 0) to (1, 0) has its obstacle below: the normal is the direction of travel turned by +90 degrees.
/// ```
/// use faying::{basis::BSpline, contact::{Surface, Obstacle}, geometry::ControlPoints, linalg::Vector};
/// use std::sync::Arc;
/// let points = vec![Vector::<2>::new(0.0, 0.0), Vector::<2>::new(1.0, 0.0)];
/// let line = Surface::left_of(Arc::new(ControlPoints { basis: BSpline::uniform(1, 1, 0), points }), None);
/// let down = Vector::<2>::new(0.0, -1.0);
/// let hit = line.project(&Vector::<2>::new(0.3, 2.0), &down).expect("the line faces what is above it");
/// assert!((hit.gap - 2.0).abs() < 1e-15 && (hit.normal[1] - 1.0).abs() < 1e-15);
/// assert!(line.project(&Vector::<2>::new(1.5, 2.0), &down).is_none());
/// assert!(line.project(&Vector::<2>::new(0.3, 2.0), &-down).is_none());
/// ```
#[derive(Debug)]
pub struct Surface<T: Real = f64> {
    master: MasterCurve<Oriented<Several<Curve<T>>, T>, 2, T>,
    reach: Option<T>,
}

impl<T: Real> Surface<T> {
    /// The surface of `trace`; points farther than `reach` face nothing.
    pub fn new(trace: &Trace<1, 2, T>, reach: Option<T>) -> Self {
        Self::of_pieces(pieces(trace), reach)
    }

    /// The obstacle to the right of `curve`: its normals are the direction of travel turned by +90 degrees.
    pub fn left_of(curve: Arc<dyn Geometry<1, 2, T>>, reach: Option<T>) -> Self {
        let pieces =
            (0..curve.num_elements()).map(|element| OutlinePiece { map: Arc::clone(&curve), element, outward: -T::one() }).collect();
        Self::of_pieces(pieces, reach)
    }

    /// The obstacle with an outline of `pieces` in any order; pieces with coincident ends are joined.
    pub fn of_pieces(pieces: Vec<OutlinePiece<1, 2, T>>, reach: Option<T>) -> Self {
        let outward = pieces.iter().map(|p| p.outward).collect();
        let elements = pieces.into_iter().map(|p| (p.map, p.element)).collect();
        Self { master: MasterCurve::new(Oriented { map: Several { elements }, outward }, T::zero()), reach }
    }

    /// The closest point of all, whatever it opposes; `None` beyond an end of the side and beyond the reach.
    pub fn closest(&self, x: &Vector<2, T>) -> Option<Hit<1, 2, T>> {
        self.hit(x, self.master.place(x)?)
    }

    /// The hit on the other face of a corner next to `hit`, if that face opposes `outward` more and `x` lies on its side of the line along
    /// `outward` through the corner; the nearer face is then not the one that the body came in by.
    fn across_corner(&self, x: &Vector<2, T>, outward: &Vector<2, T>, hit: &Hit<1, 2, T>) -> Option<Hit<1, 2, T>> {
        let (chain, element) = (self.master.chain(), hit.at?.element);
        (0..2).find_map(|end| {
            let (other, at) = chain.neighbour(element, end)?;
            let (own, out) = (chain.tangents[element][end], chain.tangents[other][at]);
            let away = x - chain.vertices[chain.ends[element][end]].x;
            let across = Vector::<2, T>::new(outward[1], -outward[0]);
            let beside = away.dot(&out) >= T::zero() || away.dot(&across) * out.dot(&across) >= T::zero();
            if own.dot(&out) < lit(-SMOOTH) || beside {
                return None;
            }
            let xi = if at == 0 { T::zero() } else { T::one() };
            let found = self.hit(x, Partner { element: other, xi, distance: T::zero(), beyond: false, rim: false })?;
            let eta = found.at?.xi[0];
            let more = found.normal.dot(outward) < hit.normal.dot(outward) - lit(ROUNDING) && opposes(outward, &found.normal);
            let near = found.gap.abs() <= hit.gap.abs() * lit(FARTHER) && found.gap * hit.gap > T::zero();
            (more && near && eta >= T::zero() && eta <= T::one()).then_some(found)
        })
    }

    fn hit(&self, x: &Vector<2, T>, place: Partner<T>) -> Option<Hit<1, 2, T>> {
        if place.beyond || self.reach.is_some_and(|r| place.distance > r) {
            return None;
        }
        let (mut eta, mut table) = ([Vector::<1, T>::new(place.xi)], MapTable::new());
        self.master.feet(place.element, &[*x], &mut eta, &mut table);
        let geometry = self.master.geometry();
        geometry.map(place.element, &eta, Order::Gradients, &mut table);
        let normal = unit_normal(&table.jacobian[0], geometry.outward[place.element]);
        let foot = table.x[0];
        Some(Hit { x: foot, normal, gap: (x - foot).dot(&normal), at: Some(Location { element: place.element, xi: eta[0] }) })
    }
}

impl<T: Real> Obstacle<1, 2, T> for Surface<T> {
    fn project(&self, x: &Vector<2, T>, outward: &Vector<2, T>) -> Option<Hit<1, 2, T>> {
        let hit = self.hit(x, self.master.place_opposed(x, outward)?)?;
        let within = |other: &Hit<1, 2, T>| self.reach.is_none_or(|r| other.gap.abs() <= r);
        Some(self.across_corner(x, outward, &hit).filter(within).unwrap_or(hit))
    }
    fn extent(&self) -> Option<Bounds<2, T>> {
        let map = self.master.geometry();
        map.all_bounds().into_iter().reduce(|a, b| a.union(&b))
    }
}
