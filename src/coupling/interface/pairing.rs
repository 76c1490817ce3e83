//! Pairing of slave points with master elements, and foot points on their continued curves.

use super::chain::Chain;
use crate::basis::Order;
use crate::coupling::CouplingError;
use crate::geometry::{Bounds, ClosestPoint, Geometry, MapTable, Tree, opposes, unit_tangent};
use crate::linalg::{Real, Vector, lit, to_f64};

/// Overhang beyond a master's end that counts as round-off, as a share of the size of both sides.
const RIM: f64 = 1e-8;
/// Distance of sides that carry the same curve, as a share of their size.
const EXACT: f64 = 1e-8;
/// Local coordinates closer than this to an element's end are at the end.
const AT_END: f64 = 1e-9;
/// Newton steps of a foot point; quadratic convergence needs about five.
const FOOT_STEPS: usize = 30;
/// Steps of a crossing; bisection alone needs 53 for double precision.
const CROSSING_STEPS: usize = 80;

/// Largest distance allowed between tied sides.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Tolerance<T: Real = f64> {
    /// 1e-8 of the size: both sides carry the same curve.
    Exact,
    /// A quarter of the shorter of the two local elements: sides that only approximate one curve.
    Local,
    /// A given distance \[length\].
    Given(T),
}

impl<T: Real> Tolerance<T> {
    /// The largest distance of sides of this size, between elements of these lengths \[length\].
    pub(super) fn within(self, size: T, lengths: [T; 2]) -> T {
        match self {
            Self::Exact => size * lit(EXACT),
            Self::Local => (lengths[0].min(lengths[1]) * lit(0.25)).max(size * lit(EXACT)),
            Self::Given(distance) => distance,
        }
    }
}

/// Pairing rule: which slave points have a partner on the master.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Partners<T: Real = f64> {
    /// Sides that touch: partners farther apart than the tolerance are an error.
    Touching(Tolerance<T>),
    /// Sides of which only parts touch: points farther from the other side than the tolerance, or beyond its ends, have no partner.
    Near(Tolerance<T>),
    /// Sides that may be apart: points farther than `reach` have no partner; `None`: the diagonal of the box around the slave. Where both
    /// sides have outward signs, partners are the closest among what opposes the slave's normal.
    Facing {
        /// Largest distance of partners \[length\].
        reach: Option<T>,
    },
}

impl<T: Real> Partners<T> {
    /// The largest distance of partners on elements of these lengths \[length\], and whether more is an error.
    pub(super) fn allowed(&self, size: T, slave_size: T, lengths: [T; 2]) -> (T, bool) {
        match *self {
            Self::Touching(tolerance) => (tolerance.within(size, lengths), true),
            Self::Near(tolerance) => (tolerance.within(size, lengths), false),
            Self::Facing { reach } => (reach.unwrap_or(slave_size), false),
        }
    }

    /// Whether a point with this place on a curve of this size can have a partner there.
    ///
    /// A side may continue at right angles to the end of the other; its closest point is then that end, but no foot point.
    pub(super) fn face(&self, place: &Partner<T>, size: T) -> bool {
        let past = place.rim && place.distance > size * lit(EXACT) && matches!(self, Self::Near(_));
        !(place.beyond || past)
    }

    /// The outward sign of a slave element, if its partners are to oppose it.
    pub(super) fn outward<const D: usize, const N: usize>(&self, slave: &dyn Geometry<D, N, T>, element: usize) -> Option<T> {
        if matches!(self, Self::Facing { .. }) { slave.outward(element) } else { None }
    }

    /// Whether the sides touch: their closest point then moves along with the point and does not jump.
    pub(super) fn touch(&self) -> bool {
        matches!(self, Self::Touching(_) | Self::Near(_))
    }
}

/// A master curve for many queries: closest point, element at vertices, rims (ends), foot points.
#[derive(Clone, Debug)]
pub struct MasterCurve<G, const N: usize, T: Real = f64> {
    closest: ClosestPoint<1, N, G, T>,
    chain: Chain<N, T>,
    size: T,
    vertices: Tree<N, T>,
    has_rims: bool,
}

/// Closest point of a master curve and the element paired with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Partner<T: Real = f64> {
    /// The element paired with the point.
    pub element: usize,
    /// Local coordinate of the closest point on it.
    pub xi: T,
    /// Distance to the closest point \[length\].
    pub distance: T,
    /// Whether the point lies beyond a rim of the master.
    pub beyond: bool,
    /// Whether the closest point is a rim of the master.
    pub rim: bool,
}

impl<G: Geometry<1, N, T>, const N: usize, T: Real> MasterCurve<G, N, T> {
    /// Builds trees over the elements and vertices of `geometry`; `other_size` is the size of the curve to be projected.
    pub fn new(geometry: G, other_size: T) -> Self {
        let chain = Chain::of(&geometry);
        let size = other_size.max(chain.size);
        let vertices = Tree::new(chain.vertices.iter().map(|v| Bounds { lo: v.x, hi: v.x }).collect());
        let has_rims = chain.vertices.iter().any(|v| v.at.len() == 1);
        Self { closest: ClosestPoint::new(geometry), chain, size, vertices, has_rims }
    }

    /// The curve.
    pub fn geometry(&self) -> &G {
        self.closest.geometry()
    }

    /// Connectivity of its elements.
    pub fn chain(&self) -> &Chain<N, T> {
        &self.chain
    }

    /// The larger of its size and the size of the other curve \[length\].
    pub fn size(&self) -> T {
        self.size
    }

    /// Whether the curve ends somewhere.
    pub(super) fn has_rims(&self) -> bool {
        self.has_rims
    }

    /// An upper bound of the distance of `x`, above it by no more than a sixteenth of an element.
    pub(super) fn distance_bound(&self, x: &Vector<N, T>) -> Option<T> {
        self.closest.distance_bound(x)
    }

    /// Finds the place of `x`: its closest element, and at a vertex the one on x's side of the vertex's normal plane. `None` if the
    /// curve has no elements or `x` is not finite.
    pub fn place(&self, x: &Vector<N, T>) -> Option<Partner<T>> {
        let hit = self.closest.project(x)?;
        let mut place = Partner { element: hit.element, xi: hit.xi[0], distance: hit.distance, beyond: false, rim: false };
        let end = if place.xi <= lit(AT_END) {
            0
        } else if place.xi >= T::one() - lit::<T>(AT_END) {
            1
        } else {
            return Some(place);
        };
        let vertex = &self.chain.vertices[self.chain.ends[hit.element][end]];
        if let Some(tangent) = &vertex.tangent {
            let along = (x - vertex.x).dot(tangent);
            if vertex.at.len() == 1 {
                place.rim = true;
                place.beyond = along > self.size * lit(RIM);
            } else {
                let (element, at) = vertex.at[if along > T::zero() { 1 } else { 0 }];
                place.element = element;
                place.xi = if at == 0 { T::zero() } else { T::one() };
            }
        }
        Some(place)
    }

    /// Finds the place of `x` among what opposes `normal`, the outward unit normal there ([`ClosestPoint::project_opposed`]); never
    /// beyond a rim. `None` where nothing opposes. Without outward signs it is the place of `x`.
    pub fn place_opposed(&self, x: &Vector<N, T>, normal: &Vector<N, T>) -> Option<Partner<T>> {
        if self.chain.lengths.is_empty() || self.geometry().outward(0).is_none() {
            return self.place(x);
        }
        let hit = self.closest.project_opposed(x, normal, self.size * lit(RIM))?;
        let mut place = Partner { element: hit.element, xi: hit.xi[0], distance: hit.distance, beyond: false, rim: false };
        let end = if place.xi <= lit(AT_END) {
            0
        } else if place.xi >= T::one() - lit::<T>(AT_END) {
            1
        } else {
            return Some(place);
        };
        let vertex = &self.chain.vertices[self.chain.ends[hit.element][end]];
        place.rim = vertex.at.len() == 1;
        if let (Some(tangent), false) = (&vertex.tangent, place.rim) {
            let (element, at) = vertex.at[if (x - vertex.x).dot(tangent) > T::zero() { 1 } else { 0 }];
            if self.end_normal(element, at).is_none_or(|n| opposes(normal, &n)) {
                place.element = element;
                place.xi = if at == 0 { T::zero() } else { T::one() };
            }
        }
        Some(place)
    }

    /// Finds the place of `x` on a curve with this derivative: among what opposes it if it has an outward sign.
    pub(super) fn faced_place(&self, x: &Vector<N, T>, derivative: &Vector<N, T>, outward: Option<T>) -> Option<Partner<T>> {
        match outward.and_then(|outward| normal(derivative, outward)) {
            Some(normal) => self.place_opposed(x, &normal),
            None => self.place(x),
        }
    }

    /// The outward unit normal at an end of an element; `None` without outward signs.
    pub(super) fn end_normal(&self, element: usize, end: usize) -> Option<Vector<N, T>> {
        let sign = if end == 0 { -T::one() } else { T::one() };
        normal(&(self.chain.tangents[element][end] * sign), self.geometry().outward(element)?)
    }

    /// Vertices in `bounds`, in ascending order.
    pub(super) fn vertices_in(&self, bounds: &Bounds<N, T>) -> Vec<usize> {
        let mut found = self.vertices.meeting(bounds);
        found.sort_unstable();
        found
    }

    /// Whether two elements are one or share a vertex.
    pub(super) fn are_near(&self, a: usize, b: usize) -> bool {
        a == b || (0..2).any(|end| self.chain.neighbour(a, end).is_some_and(|(e, _)| e == b))
    }

    /// Computes foot points of `x` on the continued curve of `element`: (x - x_m(eta)) . x_m'(eta) = 0, started at `eta`.
    ///
    /// Leaves the positions and derivatives at the feet in `table`.
    pub fn feet(&self, element: usize, x: &[Vector<N, T>], eta: &mut [Vector<1, T>], table: &mut MapTable<1, N, T>) {
        let (least, most) = (-T::one(), lit::<T>(2.0));
        let small = T::default_epsilon() * lit(4.0);
        let mut last = T::max_value().unwrap_or_else(T::one);
        for _ in 0..FOOT_STEPS {
            self.geometry().map(element, eta, Order::Hessians, table);
            let mut largest = T::zero();
            for (q, eta) in eta.iter_mut().enumerate() {
                let (r, j) = (x[q] - table.x[q], table.jacobian[q].column(0));
                let bend = Vector::<N, T>::from_fn(|i, _| table.hessian[q][i][(0, 0)]);
                let (f, square) = (r.dot(&j), j.norm_squared());
                let full = square - r.dot(&bend);
                // beyond the centre of curvature the second derivative has the wrong sign: Gauss-Newton there
                let slope = if full > square * lit(0.1) { full } else { square };
                let step = if slope > T::zero() { (f / slope).max(lit(-0.5)).min(lit(0.5)) } else { T::zero() };
                eta[0] = (eta[0] + step).max(least).min(most);
                largest = largest.max(step.abs());
            }
            // round-off: the steps no longer shrink
            if largest <= small || (largest < lit(1e-10) && largest >= last) {
                break;
            }
            last = largest;
        }
        self.geometry().map(element, eta, Order::Values, table);
    }
}

/// Finds the point of the continued curve of `element` in the plane through `point` at right angles to `along`:
/// (x(xi) - point) . along = 0 with xi in `bracket`, which may reach beyond the cell. Returns xi.
///
/// Newton's method kept inside the bracket; without a change of sign, the end of the bracket that is nearer to the plane: a root at an end may be
/// beyond it by rounding.
pub fn crossing<const N: usize, T: Real>(
    curve: &dyn Geometry<1, N, T>,
    element: usize,
    point: &Vector<N, T>,
    along: &Vector<N, T>,
    bracket: [T; 2],
    table: &mut MapTable<1, N, T>,
) -> T {
    let [mut lo, mut hi] = bracket;
    curve.map(element, &bracket.map(Vector::<1, T>::new), Order::Values, table);
    let [mut f_lo, f_hi] = [0, 1].map(|k: usize| (table.x[k] - point).dot(along));
    if (f_lo < T::zero()) == (f_hi < T::zero()) {
        return if f_lo.abs() <= f_hi.abs() { lo } else { hi };
    }
    let mut xi = (lo + (hi - lo) * (f_lo / (f_lo - f_hi))).max(lo).min(hi);
    for _ in 0..CROSSING_STEPS {
        curve.map(element, &[Vector::<1, T>::new(xi)], Order::Gradients, table);
        let f = (table.x[0] - point).dot(along);
        let slope = table.jacobian[0].column(0).dot(along);
        if f == T::zero() {
            break;
        }
        if (f < T::zero()) == (f_lo < T::zero()) {
            (lo, f_lo) = (xi, f);
        } else {
            hi = xi;
        }
        let newton = xi - f / slope;
        let next = if slope != T::zero() && newton >= lo && newton <= hi { newton } else { (lo + hi) * lit(0.5) };
        let step = (next - xi).abs();
        xi = next;
        if step <= T::default_epsilon() * lit(2.0) {
            break;
        }
    }
    xi
}

/// The outward unit normal of a curve in the plane with this derivative; `None` in space.
pub(super) fn normal<const N: usize, T: Real>(derivative: &Vector<N, T>, outward: T) -> Option<Vector<N, T>> {
    let t = unit_tangent(derivative);
    (N == 2).then(|| Vector::from_fn(|k, _| if k == 0 { t[1] * outward } else { -t[0] * outward }))
}

/// Diagonal of the box around a curve \[length\].
pub(super) fn size_of<const N: usize, T: Real>(curve: &dyn Geometry<1, N, T>) -> T {
    curve.extent().map_or_else(T::zero, |b| b.diagonal())
}

/// Coordinates of a point for reports, padded with zeros to three.
pub(super) fn place_of<const N: usize, T: Real>(x: &Vector<N, T>) -> [f64; 3] {
    std::array::from_fn(|k| if k < N { to_f64(x[k]) } else { 0.0 })
}

/// The pair of partners with the largest ratio of distance to allowed distance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Worst<T: Real> {
    pub distance: T,
    pub at: [f64; 3],
    pub allowed: T,
    pub ratio: T,
}

impl<T: Real> Worst<T> {
    pub fn none() -> Self {
        Self { distance: T::zero(), at: [0.0; 3], allowed: T::zero(), ratio: T::zero() }
    }

    /// Returns [`CouplingError::Apart`] if the distance exceeds the allowed one, otherwise `None`.
    pub fn error(&self) -> Option<CouplingError> {
        (self.ratio > T::one()).then(|| CouplingError::Apart {
            distance: to_f64(self.distance),
            at: self.at,
            allowed: to_f64(self.allowed),
        })
    }
}
